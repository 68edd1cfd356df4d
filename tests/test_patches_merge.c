/* SPDX-License-Identifier: BSD-3-Clause */
/* Small surfaces put together: what agrees in a cluster, how large, how compact, how many. */
#include "mesh/patches_internal.h"
#include "tests/soup_tools.h"

/* What merge_small promises, as a reader of its headers would say it. Normals lie in a box with a
 * diagonal of 1, so that no two are more than 60 degrees apart. */
static const double AREA_MOST = 1.5, DIAGONAL_MOST = 2, CHORD_MOST = 1;

typedef struct {
    Surfaces *surfaces;
    uint32_t *cluster, count;
    double    size;
} Clusters;

typedef struct {
    uint32_t first, pieces;
    double   area;
    Vec3     lo, hi, normal_lo, normal_hi;
} Cluster;

static uint32_t corners_of(const Surfaces *s, uint32_t surface, Vec3 p[4])
{
    const Surface *f = &s->surface[surface];
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    for (int k = 0; k < 3; k++)
        p[k] = s->position[c[k]];
    if (f->kind == SURFACE_QUAD)
        p[3] = s->position[c[5]];
    return f->kind == SURFACE_QUAD ? 4 : 3;
}

static Vec3 normal_of(const Surfaces *s, uint32_t surface, unsigned side)
{
    SurfacePoint at;
    surfaces_point(s, surface, 0.3, 0.3, &at);
    return vec3_scale(at.normal, side == 0 ? 1 : -1);
}

static Clusters merge(Surfaces *surfaces, const PatchOptions *options, double size)
{
    Error err = { 0 };
    Clusters c = { .surfaces = surfaces, .size = size };
    c.cluster = malloc(2 * (size_t)surfaces->count * sizeof *c.cluster);
    assert_non_null(c.cluster);
    assert_true(merge_small(surfaces, options, size, c.cluster, &c.count, &err));
    assert_int_equal(err.code, ERROR_NONE);
    return c;
}

/* Sums up each cluster; checks numbers, sides, material, group and that there are two pieces. */
static Cluster *sum_up(const Clusters *c, const PatchOptions *options)
{
    const Surfaces *s = c->surfaces;
    Cluster *out = calloc(c->count + 1, sizeof *out);
    assert_non_null(out);
    uint32_t numbered = 0;
    for (uint32_t node = 0; node < 2 * s->count; node++) {
        const uint32_t surface = node / 2, side = node % 2, number = c->cluster[node];
        if (number == PATCH_NONE)
            continue;
        assert_true(options->sides == NULL || (options->sides[surface] >> side & 1) != 0);
        assert_true(s->surface[surface].kind != SURFACE_SHAPE);
        assert_true(number <= numbered);
        Cluster *k = &out[number];
        const Vec3 n = normal_of(s, surface, side);
        if (number == numbered) {
            *k = (Cluster){ .first = node, .lo = s->hi, .hi = s->lo, .normal_lo = n,
                            .normal_hi = n };
            numbered++;
        }
        const uint32_t other = k->first / 2;
        assert_int_equal(k->first % 2, side);
        assert_int_equal(surfaces_material(s, surface, side), surfaces_material(s, other, side));
        assert_int_equal(surfaces_group(s, surface, side), surfaces_group(s, other, side));
        if (options->emitting != NULL)
            assert_int_equal(options->emitting[surface] >> side & 1,
                             options->emitting[other] >> side & 1);
        k->pieces++;
        k->area += s->surface[surface].area;
        k->normal_lo = vec3_min(k->normal_lo, n);
        k->normal_hi = vec3_max(k->normal_hi, n);
        Vec3 p[4];
        for (uint32_t i = corners_of(s, surface, p); i-- > 0;) {
            k->lo = vec3_min(k->lo, p[i]);
            k->hi = vec3_max(k->hi, p[i]);
        }
    }
    assert_int_equal(numbered, c->count);
    for (uint32_t k = 0; k < c->count; k++) {
        assert_true(out[k].pieces >= 2);
        /* Positions in units of the size are floats: a few of their ulps. */
        const double slack = 1 + 1e-5;
        assert_true(out[k].area <= AREA_MOST * c->size * c->size * slack);
        assert_true(vec3_length(vec3_sub(out[k].hi, out[k].lo)) <= DIAGONAL_MOST * c->size * slack);
        const Vec3 normals = vec3_sub(out[k].normal_hi, out[k].normal_lo);
        assert_true(vec3_length(normals) <= CHORD_MOST * slack);
    }
    return out;
}

/* Surfaces in no cluster. */
static uint32_t left_alone(const Clusters *c, unsigned side)
{
    uint32_t alone = 0;
    for (uint32_t i = 0; i < c->surfaces->count; i++)
        alone += c->cluster[2 * i + side] == PATCH_NONE;
    return alone;
}

static void clusters_clear(Clusters *c)
{
    free(c->cluster);
    surfaces_destroy(c->surfaces);
}

/* A unit sphere of 2 n (m - 1) triangles: no pairs of them are parallelograms. */
static Surfaces *ball(uint32_t n, uint32_t m)
{
    Polygons soup;
    soup_start(&soup);
    for (uint32_t j = 0; j < m; j++)
        for (uint32_t i = 0; i < n; i++) {
            Vec3 p[4];
            for (uint32_t k = 0; k < 4; k++) {
                const double u = 2 * M_PI * (i + (k == 1 || k == 2)) / n;
                const double v = M_PI * (j + (k >= 2)) / m;
                p[k] = vec3(sin(v) * cos(u), sin(v) * sin(u), cos(v));
            }
            if (j + 1 < m)
                soup_polygon(&soup, (Vec3[]){ p[0], p[3], p[2] }, 3, 0, 0);
            if (j > 0)
                soup_polygon(&soup, (Vec3[]){ p[0], p[2], p[1] }, 3, 0, 0);
        }
    Surfaces *s = connect(&soup);
    polygons_clear(&soup);
    return s;
}

/* Square quads of edge 1 in a plane; those left of the middle are of material 0, others 1. */
static void floor_of(Polygons *soup, int n)
{
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            soup_polygon(soup, (Vec3[]){ { i, j, 0 }, { i + 1, j, 0 }, { i + 1, j + 1, 0 },
                                         { i, j + 1, 0 } }, 4, i < n / 2 ? 0 : 1, 0);
}

static void test_ball(void **state)
{
    (void)state;
    const uint8_t front = 1;
    Surfaces *s = ball(80, 126);
    assert_int_equal(s->count, 20000);
    uint8_t *sides = malloc(s->count);
    assert_non_null(sides);
    memset(sides, front, s->count);
    const PatchOptions options = { .sides = sides };
    Clusters c = merge(s, &options, 0.2);
    Cluster *sum = sum_up(&c, &options);
    assert_int_equal(left_alone(&c, 0), 0);
    assert_int_equal(left_alone(&c, 1), s->count);
    const double wanted = 4 * M_PI / (0.2 * 0.2);
    assert_true(fabs(c.count - wanted) < 0.2 * wanted);
    uint32_t middling = 0;
    for (uint32_t k = 0; k < c.count; k++) {
        assert_true(sum[k].area >= 0.25 * 0.04); /* a smooth surface leaves no fragments */
        middling += sum[k].area > 0.7 * 0.04 && sum[k].area < 1.3 * 0.04;
    }
    assert_true(middling > 0.8 * c.count);
    free(sum);
    free(sides);
    clusters_clear(&c);
}

/* 100 x 100 squares at sizes from 3 to 12 edges: the count is that of the area. */
static void test_floor(void **state)
{
    (void)state;
    Polygons soup;
    soup_start(&soup);
    floor_of(&soup, 100);
    const PatchOptions options = { 0 };
    for (double size = 3; size <= 12; size *= 1.189207) {
        Clusters c = merge(connect(&soup), &options, size);
        Cluster *sum = sum_up(&c, &options);
        const double wanted = 2 * 100 * 100 / (size * size); /* both sides */
        assert_int_equal(left_alone(&c, 0) + left_alone(&c, 1), 0);
        assert_true(fabs(c.count - wanted) < 0.2 * wanted);
        free(sum);
        clusters_clear(&c);
    }
    polygons_clear(&soup);
}

static void test_large_stay(void **state)
{
    (void)state;
    Polygons soup;
    soup_start(&soup);
    floor_of(&soup, 10);
    soup_shape(&soup, SHAPE_DISC, 1, &(Affine){ { 0.1, 0, 0 }, { 0, 0.1, 0 }, { 0, 0, 0.1 },
                                                { 50, 0, 0 } });
    const PatchOptions options = { 0 };
    Clusters c = merge(connect(&soup), &options, 1.2);
    assert_int_equal(c.count, 0);
    assert_int_equal(left_alone(&c, 0), 101);
    clusters_clear(&c);
    c = merge(connect(&soup), &options, 1.5); /* 1 < 2.25 / 2 */
    assert_int_equal(left_alone(&c, 0), 1);
    assert_true(c.count > 0);
    clusters_clear(&c);
    polygons_clear(&soup);
}

/* Whether some cluster has pieces on both sides of the plane through 0 across an axis. */
static bool straddles(const Clusters *c, int axis)
{
    const Surfaces *s = c->surfaces;
    for (uint32_t a = 0; a < 2 * s->count; a++)
        for (uint32_t b = 0; b < a; b++) {
            if (c->cluster[a] == PATCH_NONE || c->cluster[a] != c->cluster[b])
                continue;
            SurfacePoint p, q;
            surfaces_point(s, a / 2, 0.3, 0.3, &p);
            surfaces_point(s, b / 2, 0.3, 0.3, &q);
            if (vec3_axis(p.point, axis) * vec3_axis(q.point, axis) < 0)
                return true;
        }
    return false;
}

/* Small triangles in rows at both sides of a wall x = 0, alike in all but their place: with and
 * without the wall nothing goes together across the gap. */
static void test_both_sides_of_wall(void **state)
{
    (void)state;
    const PatchOptions options = { 0 };
    for (int box = 0; box < 2; box++) {
        Polygons soup;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, -50, -50 }, { 0, 50, -50 }, { 0, 50, 50 },
                                      { 0, -50, 50 } }, 4, 0, 0);
        for (int i = 0; i < 10; i++)
            for (int k = -1; k <= 1; k += 2) {
                const Vec3 lo = vec3(k * 0.1 - 0.05, i * 0.2, 0);
                if (box)
                    soup_box(&soup, lo, vec3_add(lo, vec3(0.1, 0.1, 0.1)), 0, 0);
                else
                    soup_polygon(&soup, (Vec3[]){ lo, vec3_add(lo, vec3(0.1, 0, 0)),
                                                  vec3_add(lo, vec3(0, 0.1, 0)) }, 3, 0, 0);
            }
        for (double size = 0.5; size <= 8; size *= 2) {
            Clusters c = merge(connect(&soup), &options, size);
            free(sum_up(&c, &options));
            assert_false(straddles(&c, 0));
            clusters_clear(&c);
        }
        polygons_clear(&soup);
    }
}

/* A box on a slab: its bottom is seen from below the slab, the rest of it from above. `cut`: the
 * slab has the bottom's outline, else it goes on below. Beside the bottom nothing of the box looks
 * down, so that no cluster may have both it and others. */
static void test_box_on_slab(void **state)
{
    (void)state;
    const PatchOptions options = { 0 };
    for (int cut = 0; cut < 2; cut++) {
        Polygons soup;
        soup_start(&soup);
        soup_box(&soup, vec3(0, 0, 0), vec3(1, 1, 1), 0, 0);
        for (int j = -1; j <= 1; j++)
            for (int i = -1; i <= 1; i++)
                if (cut && (i != 0 || j != 0))
                    soup_polygon(&soup, (Vec3[]){ { i, j, 0 }, { i + 1, j, 0 },
                                                  { i + 1, j + 1, 0 }, { i, j + 1, 0 } }, 4, 0, 0);
        if (!cut)
            soup_polygon(&soup, (Vec3[]){ { -40, -40, 0 }, { 40, -40, 0 }, { 40, 40, 0 },
                                          { -40, 40, 0 } }, 4, 0, 0);
        for (double size = 2; size <= 32; size *= 2) {
            Clusters c = merge(connect(&soup), &options, size);
            free(sum_up(&c, &options));
            const Surfaces *s = c.surfaces;
            for (uint32_t a = 0; a < 2 * s->count; a++)
                for (uint32_t b = 0; b < a; b++)
                    if (c.cluster[a] != PATCH_NONE && c.cluster[a] == c.cluster[b])
                        assert_int_equal(fabs(normal_of(s, a / 2, 0).z) > 0.5,
                                         fabs(normal_of(s, b / 2, 0).z) > 0.5);
            clusters_clear(&c);
        }
        polygons_clear(&soup);
    }
}

/* A bevelled foot on a slab that is cut along it: at 45 degrees growing would go over the edge, but
 * a third surface has it. */
static void test_foot_on_slab(void **state)
{
    (void)state;
    const PatchOptions options = { 0 };
    for (int slab = 0; slab < 2; slab++) {
        Polygons soup;
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 }, { 1, 0, 0 } },
                     4, 0, 0);
        soup_polygon(&soup, (Vec3[]){ { 1, 0, 0 }, { 1, 1, 0 }, { 2, 1, 1 }, { 2, 0, 1 } },
                     4, 0, 0);
        if (slab)
            soup_polygon(&soup, (Vec3[]){ { 1, 0, 0 }, { 1, 1, 0 }, { 40, 1, 0 }, { 40, 0, 0 } },
                         4, 0, 0);
        Clusters c = merge(connect(&soup), &options, 3);
        free(sum_up(&c, &options));
        assert_int_equal(c.count, slab ? 0 : 2);
        clusters_clear(&c);
        polygons_clear(&soup);
    }
}

/* Where a wall stands on a floor the halves are no neighbours, though of one part; small as they
 * are, they stay two patches. */
static void test_below_wall(void **state)
{
    (void)state;
    const PatchOptions options = { 0 };
    for (int wall = 0; wall < 2; wall++) {
        Polygons soup;
        soup_start(&soup);
        for (int i = 0; i < 10; i++)
            soup_polygon(&soup, (Vec3[]){ { i, 0, 0 }, { i + 1, 0, 0 }, { i + 1, 1, 0 },
                                          { i, 1, 0 } }, 4, 0, 0);
        Surfaces *s = connect(&soup);
        for (uint32_t i = 0; i < 10; i++)
            for (int k = 0; wall && k < 4; k++) {
                const uint32_t j = s->surface[i].neighbour[k];
                if (j != SURFACE_NONE && (i < 5) != (j < 5))
                    s->surface[i].neighbour[k] = SURFACE_NONE;
            }
        Clusters c = merge(s, &options, 10);
        free(sum_up(&c, &options));
        assert_int_equal(left_alone(&c, 0) + left_alone(&c, 1), 0);
        assert_int_equal(c.count, wall ? 4 : 2);
        for (uint32_t i = 0; wall && i < 5; i++)
            for (uint32_t j = 5; j < 10; j++)
                assert_int_not_equal(c.cluster[2 * i], c.cluster[2 * j]);
        clusters_clear(&c);
        polygons_clear(&soup);
    }
}

/* A floor cut in checks of emitting and dark squares, with two groups: sum_up checks agreement. */
static void test_agreement(void **state)
{
    (void)state;
    Polygons soup;
    soup_start(&soup);
    for (uint32_t j = 0; j < 40; j++)
        for (uint32_t i = 0; i < 40; i++)
            soup_polygon(&soup, (Vec3[]){ { i, j, 0 }, { i + 1, j, 0 }, { i + 1, j + 1, 0 },
                                          { i, j + 1, 0 } }, 4, i / 10 % 2, j / 5 % 2);
    Surfaces *s = connect(&soup);
    uint8_t *sides = malloc(s->count), *emitting = malloc(s->count);
    assert_true(sides != NULL && emitting != NULL);
    for (uint32_t i = 0; i < s->count; i++) {
        sides[i] = (uint8_t)(i % 7 == 0 ? 2 : i % 5 == 0 ? 0 : 3);
        emitting[i] = (uint8_t)(i / 3 % 4);
    }
    const PatchOptions options = { .sides = sides, .emitting = emitting };
    Clusters c = merge(s, &options, 4);
    Cluster *sum = sum_up(&c, &options);
    assert_true(c.count > 0);
    free(sum);
    free(sides);
    free(emitting);
    clusters_clear(&c);
    polygons_clear(&soup);
}

/* The same clusters again. */
static void test_same_again(void **state)
{
    (void)state;
    const PatchOptions options = { 0 };
    Clusters a = merge(ball(40, 41), &options, 0.4), b = merge(ball(40, 41), &options, 0.4);
    assert_int_equal(a.count, b.count);
    for (uint32_t i = 0; i < 2 * a.surfaces->count; i++)
        assert_int_equal(a.cluster[i], b.cluster[i]);
    clusters_clear(&a);
    clusters_clear(&b);
}

/* All of a plane in two: half of the area each, and each part in one piece. */
static void test_split(void **state)
{
    (void)state;
    Error err = { 0 };
    Polygons soup;
    soup_start(&soup);
    for (int i = 0; i < 30; i++) /* a strip, its order in the file mixed up */
        soup_polygon(&soup, (Vec3[]){ { i * 7 % 30, 0, 0 }, { i * 7 % 30 + 1, 0, 0 },
                                      { i * 7 % 30 + 1, 1, 0 }, { i * 7 % 30, 1, 0 } }, 4, 0, 0);
    Surfaces *s = connect(&soup);
    uint32_t piece[30], part[30], parts = 0;
    for (uint32_t i = 0; i < 30; i++)
        piece[i] = i;
    assert_true(merge_split(s, 0, piece, 30, part, &parts, &err));
    assert_int_equal(parts, 2);
    for (uint32_t i = 0; i < 30; i++)
        assert_int_equal(part[i], i * 7 % 30 < 15 ? 0 : 1);
    assert_true(merge_split(s, 1, piece, 2, part, &parts, &err));
    assert_int_equal(parts, 2);
    assert_int_equal(part[0] + part[1], 1);
    surfaces_destroy(s);
    polygons_clear(&soup);
}

static void test_out_of_memory(void **state)
{
    (void)state;
    Surfaces *s = ball(12, 12);
    uint32_t *cluster = malloc(2 * (size_t)s->count * sizeof *cluster), count = 0;
    assert_non_null(cluster);
    const PatchOptions options = { 0 };
    const long live = array_live();
    bool done = false;
    for (long n = 0; !done; n++) {
        Error err = { 0 };
        array_fail_after(n);
        done = merge_small(s, &options, 0.8, cluster, &count, &err);
        array_fail_after(-1);
        assert_int_equal(err.code, done ? ERROR_NONE : ERROR_MEMORY);
        assert_int_equal(array_live(), live);
    }
    free(cluster);
    surfaces_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball),       cmocka_unit_test(test_floor),
        cmocka_unit_test(test_large_stay), cmocka_unit_test(test_both_sides_of_wall),
        cmocka_unit_test(test_box_on_slab), cmocka_unit_test(test_foot_on_slab),
        cmocka_unit_test(test_below_wall),
        cmocka_unit_test(test_agreement),  cmocka_unit_test(test_same_again),
        cmocka_unit_test(test_split),      cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
