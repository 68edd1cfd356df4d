/* SPDX-License-Identifier: BSD-3-Clause */
/* Values from patches to vertices: linear functions up to the rim, second order, within bounds. */
#include "radiosity/solve.h"
#include "soup_tools.h"

#include "math/sampling.h"
#include "math/tolerance.h"

typedef double (*Field)(Vec3 p);

/* Light everywhere above 0, and different along every axis. */
static double linear(Vec3 p) { return 20 + 3 * p.x - 2 * p.y + 1.5 * p.z; }
static double wavy(Vec3 p) { return 2 + sin(2 * p.x + 0.3) * cos(1.5 * p.y) + 0.5 * p.z; }

/* A plane fitted to a few dozen values near 20: moments, their quotients, sums. */
static const double EXACT = 20 * 1e3 * DBL_EPSILON;

/* --- meshes made by hand ---------------------------------------------------------------------- */

enum { HAND_FACES = 4096, HAND_CORNERS = 8 * HAND_FACES, HAND_VERTICES = 8192 };

/* Squares of the plane z = 0 on a raster of whole numbers, T-vertices built in by hand_finish. */
typedef struct {
    Patches  p;
    uint32_t x[HAND_FACES], y[HAND_FACES], edge[HAND_FACES], merged[HAND_FACES];
    uint32_t faces;
    double   scale;
    uint32_t vertex_at[65][65];
} Hand;

static Hand *hand_create(double scale)
{
    Hand *h = calloc(1, sizeof *h);
    assert_non_null(h);
    h->scale = scale;
    for (int i = 0; i < 65; i++)
        for (int j = 0; j < 65; j++)
            h->vertex_at[i][j] = PATCH_NONE;
    return h;
}

static void hand_square(Hand *h, uint32_t x, uint32_t y, uint32_t edge, uint32_t merged)
{
    assert_true(h->faces < HAND_FACES);
    h->x[h->faces] = x;
    h->y[h->faces] = y;
    h->edge[h->faces] = edge;
    h->merged[h->faces++] = merged;
}

static void hand_walk(Hand *h, uint32_t f, uint32_t *corners)
{
    static const int dx[4] = { 1, 0, -1, 0 }, dy[4] = { 0, 1, 0, -1 };
    uint32_t x = h->x[f], y = h->y[f];
    for (int side = 0; side < 4; side++)
        for (uint32_t k = 0; k < h->edge[f]; k++) {
            if (h->vertex_at[x][y] != PATCH_NONE)
                h->p.corner[(*corners)++] = h->vertex_at[x][y];
            x += (uint32_t)dx[side];
            y += (uint32_t)dy[side];
        }
}

/* Faces with the same `merged` != PATCH_NONE follow each other and make one patch. */
static void hand_finish(Hand *h)
{
    Patches *p = &h->p;
    p->count = 0;
    p->face_count = h->faces;
    p->position = calloc(HAND_VERTICES, sizeof *p->position);
    p->corner = calloc(HAND_CORNERS, sizeof *p->corner);
    p->first_corner = calloc(h->faces + 1, sizeof *p->first_corner);
    p->face_patch = calloc(h->faces, sizeof *p->face_patch);
    p->face_of = calloc(h->faces, sizeof *p->face_of);
    p->first_piece = calloc(h->faces + 1, sizeof *p->first_piece);
    p->piece_end = calloc(h->faces, sizeof *p->piece_end);
    p->area = calloc(h->faces, sizeof *p->area);
    p->centre = calloc(h->faces, sizeof *p->centre);
    p->normal = calloc(h->faces, sizeof *p->normal);
    for (uint32_t f = 0; f < h->faces; f++)
        for (uint32_t k = 0; k < 4; k++) {
            const uint32_t x = h->x[f] + (k % 2) * h->edge[f];
            const uint32_t y = h->y[f] + k / 2 * h->edge[f];
            if (h->vertex_at[x][y] == PATCH_NONE) {
                h->vertex_at[x][y] = p->vertex_count;
                p->position[p->vertex_count++] = vec3(h->scale * x, h->scale * y, 0);
            }
        }
    uint32_t corners = 0, pieces = 0;
    for (uint32_t f = 0; f < h->faces; f++) {
        const double edge = h->scale * h->edge[f], area = edge * edge;
        const bool piece = h->merged[f] != PATCH_NONE;
        const bool more = piece && f > 0 && h->merged[f] == h->merged[f - 1];
        const uint32_t i = more ? p->count - 1 : p->count++;
        if (!more) {
            p->face_of[i] = f;
            p->normal[i] = vec3(0, 0, 1);
            p->centre[i] = vec3(h->scale * h->x[f] + edge / 2, h->scale * h->y[f] + edge / 2, 0);
        }
        p->area[i] += area;
        if (piece)
            p->piece_end[pieces++] = p->area[i];
        p->first_piece[i + 1] = pieces;
        p->face_patch[f] = i;
        hand_walk(h, f, &corners);
        p->first_corner[f + 1] = corners;
    }
    for (uint32_t i = 0; i < p->count; i++)
        for (uint32_t k = p->first_piece[i]; k < p->first_piece[i + 1]; k++)
            p->piece_end[k] /= p->area[i];
}

static void hand_destroy(Hand *h)
{
    free(h->p.position);
    free(h->p.corner);
    free(h->p.first_corner);
    free(h->p.face_patch);
    free(h->p.face_of);
    free(h->p.first_piece);
    free(h->p.piece_end);
    free(h->p.area);
    free(h->p.centre);
    free(h->p.normal);
    free(h);
}

/* 2 n x 2 n squares, those of one quarter halved twice with a step between, as adapting does. */
static Hand *hand_graded(uint32_t n)
{
    const uint32_t cell = 64 / (2 * n);
    Hand *h = hand_create(1.0 / 64);
    for (uint32_t j = 0; j < 2 * n; j++)
        for (uint32_t i = 0; i < 2 * n; i++) {
            const uint32_t parts = i >= n && j >= n ? 4 : i + 1 >= n && j + 1 >= n ? 2 : 1;
            for (uint32_t k = 0; k < parts * parts; k++)
                hand_square(h, i * cell + k % parts * (cell / parts),
                            j * cell + k / parts * (cell / parts), cell / parts, PATCH_NONE);
        }
    hand_finish(h);
    return h;
}

/* 64 x 64 squares in patches of all that is nearest to one of sites * sites jittered points. */
static Hand *hand_merged(uint32_t sites)
{
    static uint32_t owner[64][64];
    Hand *h = hand_create(1.0 / 64);
    for (uint32_t j = 0; j < 64; j++)
        for (uint32_t i = 0; i < 64; i++) {
            double best = INFINITY;
            for (uint32_t s = 0; s < sites * sites; s++) {
                float u[2];
                sampling_sobol2(s, 7, u);
                const double x = (s % sites + 0.25 + 0.5 * (double)u[0]) / sites - (i + 0.5) / 64;
                const double y = (s / sites + 0.25 + 0.5 * (double)u[1]) / sites - (j + 0.5) / 64;
                if (x * x + y * y < best) {
                    best = x * x + y * y;
                    owner[j][i] = s;
                }
            }
        }
    for (uint32_t s = 0; s < sites * sites; s++)
        for (uint32_t j = 0; j < 64; j++)
            for (uint32_t i = 0; i < 64; i++)
                if (owner[j][i] == s)
                    hand_square(h, i, j, 1, s);
    hand_finish(h);
    return h;
}

/* --- errors ----------------------------------------------------------------------------------- */

/* Mean of a field over the faces of a patch: Gauss' four points on each square. */
static void fill_hand(const Hand *h, Field field, double *value)
{
    static const double gauss = 0.28867513459481287; /* half of 1 / sqrt(3) */
    const Patches *p = &h->p;
    for (uint32_t i = 0; i < p->count; i++)
        value[i] = 0;
    for (uint32_t f = 0; f < h->faces; f++) {
        const double edge = h->scale * h->edge[f];
        const double share = edge * edge / p->area[p->face_patch[f]];
        for (int k = 0; k < 4; k++)
            value[p->face_patch[f]] +=
                share / 4 *
                field(vec3(h->scale * h->x[f] + edge * (0.5 + (k % 2 ? gauss : -gauss)),
                           h->scale * h->y[f] + edge * (0.5 + (k / 2 ? gauss : -gauss)), 0));
    }
}

/* The same bits from planes that are kept. */
static void check_kept(const Patches *p, const double *area, const double *value,
                       const double *out)
{
    Error err = { 0 };
    VertexCarry *carry = vertex_carry_create(p, area, &err);
    double *kept = array_create(p->vertex_count, sizeof *kept, "test", &err);
    assert_true(carry != NULL && kept != NULL && vertex_carry_fits(carry, p, area));
    for (int turn = 0; turn < 2; turn++) {
        assert_true(vertex_carry_values(carry, 1, value, kept, &err));
        assert_memory_equal(kept, out, p->vertex_count * sizeof *kept);
    }
    array_free(kept);
    vertex_carry_destroy(carry);
}

static void carry(const Patches *p, const double *area, const double *value, double *out)
{
    Error err = { 0 };
    assert_true(vertex_radiosity(p, area != NULL ? area : p->area, 1, value, out, &err));
    check_kept(p, area != NULL ? area : p->area, value, out);
}

static double largest_error(const Patches *p, Field field, const double *out)
{
    double largest = 0;
    /* Cells at the poles of a unit sphere do not halve: those of the first row reach down to
     * acos(1 - h). */
    for (uint32_t v = 0; v < p->vertex_count; v++)
        if (fabs(p->position[v].z) < 0.6 || field == linear)
            largest = fmax(largest, fabs(out[v] - field(p->position[v])));
    return largest;
}

static double hand_error(Hand *h, Field field)
{
    double *value = calloc(h->p.count, sizeof *value), *out = calloc(HAND_VERTICES, sizeof *out);
    fill_hand(h, field, value);
    carry(&h->p, NULL, value, out);
    const double error = largest_error(&h->p, field, out);
    free(value);
    free(out);
    hand_destroy(h);
    return error;
}

/* Values at the centres of a real mesh's patches. */
static double mesh_error(Mesh *m, Field field)
{
    const Patches *p = m->patches;
    double *value = calloc(p->count, sizeof *value), *out = calloc(p->vertex_count, sizeof *out);
    for (uint32_t i = 0; i < p->count; i++)
        value[i] = field(p->centre[i]);
    carry(p, NULL, value, out);
    const double error = largest_error(p, field, out);
    free(value);
    free(out);
    mesh_clear(m);
    return error;
}

/* --- tests ------------------------------------------------------------------------------------ */

static void linear_on_plane_surfaces(void **state)
{
    (void)state;
    const Vec3 rectangle[4] = { { 0, 0, 0 }, { 3, 0, 0 }, { 3, 2, 1 }, { 0, 2, 1 } };
    const Vec3 slanted[4] = { { 0, 0, 0 }, { 3, 1, 0 }, { 4, 3, 1 }, { 1, 2, 1 } };
    for (int kind = 0; kind < 3; kind++)
        for (int n = 2; n <= 12; n += 5) {
            Mesh m;
            soup_start(&m.soup);
            if (kind == 2)
                soup_polygon(&m.soup, slanted, 3, 0, 0);
            else
                soup_polygon(&m.soup, kind == 0 ? rectangle : slanted, 4, 0, 0);
            mesh_make(&m, &(PatchOptions){ .size = 3.2 / n });
            assert_true(mesh_error(&m, linear) < EXACT);
        }
}

static void linear_past_t_vertices(void **state)
{
    (void)state;
    assert_true(hand_error(hand_graded(2), linear) < EXACT);
    assert_true(hand_error(hand_graded(8), linear) < EXACT);
    /* An L of three rectangles that are cut differently. */
    Mesh m;
    soup_start(&m.soup);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, 0, 0);
    soup_polygon(&m.soup, (Vec3[]){ { 1, 0, 0 }, { 4, 0, 0 }, { 4, 1, 0 }, { 1, 1, 0 } }, 4, 0, 0);
    soup_polygon(&m.soup, (Vec3[]){ { 0, 1, 0 }, { 1, 1, 0 }, { 1, 3.1, 0 }, { 0, 3.1, 0 } }, 4, 0,
                 0);
    mesh_make(&m, &(PatchOptions){ .size = 0.3 });
    assert_true(mesh_error(&m, linear) < EXACT);
}

/* Halving patches quarters the error; a third is what is asked for, and half of it where patches
 * have no shape in common. */
static void second_order(void **state)
{
    (void)state;
    const Affine ball = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } };
    double plane[3], graded[3], merged[3], sphere[3];
    for (uint32_t k = 0; k < 3; k++) {
        Hand *h = hand_create(1.0 / 64);
        const uint32_t n = 8u << k, cell = 64 / n;
        for (uint32_t i = 0; i < n * n; i++)
            hand_square(h, i % n * cell, i / n * cell, cell, PATCH_NONE);
        hand_finish(h);
        plane[k] = hand_error(h, wavy);
        graded[k] = hand_error(hand_graded(2u << k), wavy);
        merged[k] = hand_error(hand_merged(4u << k), wavy);
        Mesh m;
        soup_start(&m.soup);
        soup_shape(&m.soup, SHAPE_SPHERE, 1, &ball);
        mesh_make(&m, &(PatchOptions){ .size = 0.4 / (1u << k) });
        sphere[k] = mesh_error(&m, wavy);
    }
    for (int k = 1; k < 3; k++) {
        assert_true(plane[k] < plane[k - 1] / 3 && graded[k] < graded[k - 1] / 3);
        assert_true(merged[k] < merged[k - 1] / 2 && sphere[k] < sphere[k - 1] / 3);
    }
}

/* Any values from 0 to 2: inside within those of the patches around; at rims not below 0, and above
 * by no more than their range. */
static void within_bounds(void **state)
{
    (void)state;
    Hand *h = hand_graded(8);
    const Patches *p = &h->p;
    double *value = calloc(p->count, sizeof *value), *out = calloc(HAND_VERTICES, sizeof *out);
    for (uint32_t i = 0; i < p->count; i++)
        value[i] = sampling_mix(i) % 3 == 0 ? 0 : 1 + sampling_mix(i) % 100 / 100.0;
    carry(p, NULL, value, out);
    for (uint32_t v = 0; v < p->vertex_count; v++) {
        const Vec3 at = p->position[v];
        const bool rim = at.x * at.y * (1 - at.x) * (1 - at.y) <= 0;
        double low = INFINITY, high = 0;
        for (uint32_t f = 0; f < p->face_count; f++)
            for (uint32_t k = p->first_corner[f]; k < p->first_corner[f + 1]; k++)
                if (p->corner[k] == v) {
                    low = fmin(low, value[p->face_patch[f]]);
                    high = fmax(high, value[p->face_patch[f]]);
                }
        assert_true(rim ? out[v] >= 0 && out[v] < 4 : out[v] >= low && out[v] <= high);
    }
    /* One value everywhere stays what it is. */
    for (uint32_t i = 0; i < p->count; i++)
        value[i] = 5;
    carry(p, NULL, value, out);
    for (uint32_t v = 0; v < p->vertex_count; v++)
        assert_true(fabs(out[v] - 5) < EXACT);
    free(value);
    free(out);
    hand_destroy(h);
}

/* The mean that the vertices make is that of the patches, to second order at least: a field that
 * bends, cell means known, trapezium rule over squares. */
static double bowl(Vec3 p) { return 1 + 4 * p.x * p.x + 4 * p.y * p.y; }

static void means_are_kept(void **state)
{
    (void)state;
    Hand *h = hand_create(1.0 / 64);
    for (uint32_t i = 0; i < 64; i++)
        hand_square(h, i % 8 * 8, i / 8 * 8, 8, PATCH_NONE);
    hand_finish(h);
    const Patches *p = &h->p;
    double value[64], out[81], mean = 0;
    fill_hand(h, bowl, value);
    carry(p, NULL, value, out);
    for (uint32_t i = 0; i < 64; i++)
        for (uint32_t k = 0; k < 4; k++)
            mean += out[p->corner[p->first_corner[i] + k]] / 4 / 64;
    /* 1 + 8 / 3. Planes alone fill hollows: 0.049 too much. */
    assert_true(fabs(mean - (1 + 8.0 / 3)) < 0.005);
    hand_destroy(h);
}

/* A strip a thousand times narrower than the squares beside it is ten times as bright: the light on
 * the squares stays nearer to their own, to the rim. */
static void slivers_count_little(void **state)
{
    (void)state;
    Polygons soup;
    Error err = { 0 };
    soup_start(&soup);
    soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 4, 0, 0 }, { 4, 4, 0 }, { 0, 4, 0 } }, 4, 0, 0);
    soup_polygon(&soup, (Vec3[]){ { 4, 0, 0 }, { 4.001, 0, 0 }, { 4.001, 4, 0 }, { 4, 4, 0 } }, 4,
                 0, 0);
    Surfaces *surfaces = surfaces_create(&soup, NULL, &err);
    Patches *p = patches_create(surfaces, &(PatchOptions){ .size = 1, .separate = true }, NULL,
                                &err);
    assert_false(error_is_set(&err));
    double *value = calloc(p->count, sizeof *value), *out = calloc(p->vertex_count, sizeof *out);
    for (uint32_t i = 0; i < p->count; i++)
        value[i] = p->centre[i].x > 4 ? 10 : 1;
    assert_true(vertex_radiosity(p, p->area, 1, value, out, &err));
    for (uint32_t v = 0; v < p->vertex_count; v++)
        if (p->position[v].x <= 4)
            assert_true(out[v] >= 0 && out[v] < (1 + 10) / 2.0);
    free(value);
    free(out);
    patches_destroy(p);
    surfaces_destroy(surfaces);
    polygons_clear(&soup);
}

static void hidden_patches(void **state)
{
    (void)state;
    /* Two rows of columns 0..7 hidden, whatever they are said to have. */
    Hand *h = hand_create(1.0 / 64);
    double area[64], value[64], out[81];
    for (uint32_t i = 0; i < 64; i++)
        hand_square(h, i % 8 * 8, i / 8 * 8, 8, PATCH_NONE);
    hand_finish(h);
    fill_hand(h, linear, value);
    for (uint32_t i = 0; i < 64; i++) {
        const bool hidden = i / 8 == 3 || i / 8 == 4;
        area[i] = hidden ? 0 : h->p.area[i];
        if (hidden)
            value[i] = 1e9;
    }
    carry(&h->p, area, value, out);
    for (uint32_t v = 0; v < 81; v++) {
        const Vec3 at = h->p.position[v];
        /* In the middle of the hidden strip: what is next to it, not extrapolated. */
        const double slack = fabs(at.y - 0.5) < 0.01 ? 2 : EXACT;
        assert_true(fabs(out[v] - linear(at)) < slack);
    }
    for (uint32_t i = 0; i < 64; i++)
        area[i] = 0;
    carry(&h->p, area, value, out);
    for (uint32_t v = 0; v < 81; v++)
        assert_true(out[v] == 0);
    hand_destroy(h);
}

static void creases_keep_apart(void **state)
{
    (void)state;
    /* A lit and a dark wall of a box: no vertex of one knows of the other. */
    Mesh m;
    Error err = { 0 };
    soup_start(&m.soup);
    soup_box(&m.soup, vec3(0, 0, 0), vec3(1, 1, 1), 0, 0);
    mesh_make(&m, &(PatchOptions){ .size = 0.2 });
    const Patches *p = m.patches;
    double *value = calloc(2 * (size_t)p->count, sizeof *value);
    double *out = calloc(2 * (size_t)p->vertex_count, sizeof *out);
    for (uint32_t i = 0; i < p->count; i++) {
        value[2 * i] = p->normal[i].z > 0.5 ? 7 : 0;
        value[2 * i + 1] = p->normal[i].x > 0.5 ? 3 : 1;
    }
    assert_true(vertex_radiosity(p, p->area, 2, value, out, &err));
    for (uint32_t f = 0; f < p->face_count; f++)
        for (uint32_t k = p->first_corner[f]; k < p->first_corner[f + 1]; k++)
            for (size_t b = 0; b < 2; b++)
                assert_true(fabs(out[2 * (size_t)p->corner[k] + b]
                                 - value[2 * (size_t)p->face_patch[f] + b]) < EXACT);
    free(value);
    free(out);
    mesh_clear(&m);
}

static void without_memory(void **state)
{
    (void)state;
    Hand *h = hand_merged(4);
    double *value = calloc(h->p.count, sizeof *value), *out = calloc(HAND_VERTICES, sizeof *out);
    const long before = array_live();
    bool good = false;
    for (long n = 0; !good; n++) {
        Error err = { 0 };
        array_fail_after(n);
        good = vertex_radiosity(&h->p, h->p.area, 1, value, out, &err);
        array_fail_after(-1);
        assert_true(good || err.code == ERROR_MEMORY);
        assert_int_equal(array_live(), before);
        assert_true(n < 99);
    }
    free(value);
    free(out);
    hand_destroy(h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_on_plane_surfaces), cmocka_unit_test(linear_past_t_vertices),
        cmocka_unit_test(second_order),             cmocka_unit_test(within_bounds),
        cmocka_unit_test(means_are_kept),           cmocka_unit_test(hidden_patches),
        cmocka_unit_test(slivers_count_little),
        cmocka_unit_test(creases_keep_apart),       cmocka_unit_test(without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
