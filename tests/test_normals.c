/* SPDX-License-Identifier: BSD-3-Clause */
/* Smooth shading: balls of triangles against the exact ball, and that no light leaks. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "render/normals.h"
#include "render/path.h"
#include "render/whitted.h"
#include "tests/room_maker.h"

/* Angle between rows and between columns of a ball's corners. */
static const double STEP = M_PI / 12;

typedef struct {
    int  rows, columns;
    bool shaded;   /* corners come with the ball's normals */
} Globe;

static Vec3 globe_corner(const Globe *globe, int row, int column)
{
    const double t = M_PI * row / globe->rows, p = 2 * M_PI * column / globe->columns;
    return vec3(sin(t) * cos(p), sin(t) * sin(p), cos(t));
}

/* A ball of radius 1 around 0; corners lie on it. */
static void add_globe(TestRoom *r, const Globe *globe, uint32_t material)
{
    enum { MOST = 24 };
    Error    err = { 0 };
    uint32_t vertex[MOST + 1][MOST], group;
    assert_true(globe->rows <= MOST && globe->columns <= MOST);
    assert_true(polygons_add_group(&r->soup, "ball", &group, &err));
    for (int j = 0; j <= globe->rows; j++)
        for (int i = 0; i < globe->columns; i++)
            assert_true(polygons_add_vertex(&r->soup, globe_corner(globe, j, i), &vertex[j][i],
                                            &err));
    for (int j = 0; j < globe->rows; j++)
        for (int i = 0; i < globe->columns; i++) {
            const int      k = (i + 1) % globe->columns;
            const uint32_t c[4] = { vertex[j][i], vertex[j + 1][i], vertex[j + 1][k],
                                    vertex[j][k] };
            const uint32_t cap[2][3] = { { c[0], c[1], c[2] }, { c[0], c[1], c[3] } };
            const bool     ends = j == 0 || j == globe->rows - 1;
            const uint32_t *own = ends ? cap[j > 0] : c;
            Vec3           normal[4];
            for (int n = 0; n < (ends ? 3 : 4); n++)
                normal[n] = r->soup.position[own[n]];
            assert_true(polygons_add_polygon(&r->soup, own, ends ? 3 : 4, material, group, &err));
            if (globe->shaded)
                assert_true(polygons_set_normals(&r->soup, (uint32_t)r->soup.polygon_count - 1,
                                                 normal, &err));
        }
}

static void add_ball(TestRoom *r, uint32_t material)
{
    add_globe(r, &(Globe){ 12, 24, false }, material);
}

/* No patches: both sides in use, fronts of what emits emit. */
static void finish(TestRoom *r, const Light *light, size_t lights)
{
    room_connect(r);
    for (uint32_t i = 0; i < r->surfaces->count; i++) {
        r->sides[i] = 3;
        r->emitting[i] = rgb_max(r->soup.materials[r->surfaces->surface[i].material].emission) > 0;
    }
    r->room = (Room){ .surfaces = r->surfaces, .soup = &r->soup, .bvh = r->bvh,
                      .materials = r->soup.materials, .material_count = r->soup.material_count,
                      .lights = light, .light_count = lights, .sides = r->sides,
                      .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
}

enum { SIDE = 32 };

/* The ball and a little around it, seen along -y. */
static Camera view(void)
{
    return (Camera){ .eye = { 0, 3, 0 }, .up = { 0, 0, 1 }, .projection = CAMERA_ORTHOGRAPHIC,
                     .view_height = 2.2 };
}

static Image *paths(const TestRoom *r, uint32_t samples)
{
    const PathOptions options = { .width = SIDE, .height = SIDE, .samples = samples, .threads = 1,
                                  .seed = 3 };
    const Camera camera = view();
    Error  err = { 0 };
    Image *image = render_path(&r->room, &camera, &options, NULL, NULL, &err);
    assert_non_null(image);
    return image;
}

/* Normal of the exact ball behind the middle of a pixel; false: past its rim, or so near it that
 * edges of triangles decide. */
static bool ball_normal(int x, int y, Vec3 *n)
{
    const double step = 2.2 / SIDE, a = (x + 0.5) * step - 1.1, b = 1.1 - (y + 0.5) * step;
    if (a * a + b * b > 0.8)
        return false;
    /* From y = 3 down, z up: right is -x. */
    *n = vec3(-a, sqrt(1 - a * a - b * b), b);
    return true;
}

/* Lit from the side by a far light, brightness follows the exact ball's cosine to the shadow's edge
 * and no light comes beyond it. Corners' normals are those of the ball by symmetry but for the
 * direction along a meridian; between them a blend of normals turns evenly to O(STEP^2), and a ray
 * meets the ball elsewhere than its triangle by half the sagitta, STEP^2 / 8 each way. */
static void brightness_is_that_of_the_ball(void **state)
{
    (void)state;
    enum { FAR = 1000 };
    const double albedo = 0.5, slack = STEP * STEP / 2;
    const Vec3   to = vec3_unit(vec3(-1, 0.2, 0.3));
    const Light  light = { .kind = LIGHT_POINT, .position = vec3_scale(to, FAR),
                           .intensity = { FAR * FAR, FAR * FAR, FAR * FAR } };
    TestRoom     r = { 0 };
    add_ball(&r, room_material(&r, albedo, 0));
    finish(&r, &light, 1);
    const Camera         camera = view();
    const WhittedOptions options = { .width = SIDE, .height = SIDE, .threads = 1 };
    Error  err = { 0 };
    Image *one = paths(&r, 16), *two = render_whitted(&r.room, &camera, &options, NULL, NULL, &err);
    assert_non_null(two);
    int dark = 0, lit = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            Vec3 n;
            if (!ball_normal(x, y, &n))
                continue;
            const double cosine = vec3_dot(n, to), scale = M_PI / albedo;
            const double a = one->radiance[3 * (y * SIDE + x)] * scale;
            const double b = two->radiance[3 * (y * SIDE + x)] * scale;
            assert_true(fabs(b - fmax(cosine, 0)) <= slack);
            /* A pixel's 1/16 is wide: light changes less than evenly over it. */
            assert_true(fabs(a - fmax(cosine, 0)) <= slack + 2.2 / SIDE);
            if (cosine < -slack - 2.2 / SIDE) {
                assert_true(a == 0 && b == 0);
                dark++;
            }
            lit += cosine > slack;
        }
    assert_true(dark > 100 && lit > 100);
    image_destroy(one);
    image_destroy(two);
    room_clear(&r);
}

/* RMS difference of the ball's brightness from the exact ball's cosine, and *most. */
static double error_of_ball(bool shaded, double *most)
{
    enum { FAR = 1000 };
    const Vec3  to = vec3_unit(vec3(-1, 0.2, 0.3));
    const Light light = { .kind = LIGHT_POINT, .position = vec3_scale(to, FAR),
                          .intensity = { FAR * FAR, FAR * FAR, FAR * FAR } };
    TestRoom    r = { 0 };
    add_globe(&r, &(Globe){ 10, 11, shaded }, room_material(&r, 0.5, 0));
    assert_int_equal(r.soup.polygon_count, 110); /* 198 triangles */
    finish(&r, &light, 1);
    const Camera         camera = view();
    const WhittedOptions options = { .width = SIDE, .height = SIDE, .threads = 1 };
    Error  err = { 0 };
    Image *image = render_whitted(&r.room, &camera, &options, NULL, NULL, &err);
    assert_non_null(image);
    double square = 0;
    int    count = 0;
    *most = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            Vec3 n;
            if (!ball_normal(x, y, &n))
                continue;
            const double value = image->radiance[3 * (y * SIDE + x)] * 2 * M_PI;
            const double off = value - fmax(vec3_dot(n, to), 0);
            square += off * off;
            *most = fmax(*most, fabs(off));
            count++;
        }
    image_destroy(image);
    room_clear(&r);
    return sqrt(square / count);
}

/* A ball of 200 facets whose columns are creases, 33 degrees apart, by its facets alone: with the
 * normals of the file it is the exact ball up to what their blends are off, as above. By facets'
 * own normals it is off by up to half a column, evenly spread: by a column over sqrt(12) across it
 * where light comes from the side, which is in one of the two directions. */
static void normals_of_the_file_make_a_ball(void **state)
{
    (void)state;
    const double step = 2 * M_PI / 11;
    double       most, facets;
    const double given = error_of_ball(true, &most), own = error_of_ball(false, &facets);
    print_message("RMS with the file's normals %.4f, without %.4f\n", given, own);
    assert_true(most <= step * step / 2);
    assert_true(given < step * step / 8);
    assert_true(own > 2 * given);
}

typedef enum { AS_THEY_ARE, TURNED_ROUND, WILD } Spoilt;

static void spoil(TestRoom *r, Spoilt how)
{
    uint32_t word = 1;
    for (size_t i = 0; i < r->soup.polygon_count && how != AS_THEY_ARE; i++) {
        const uint32_t first = r->soup.first[i];
        Vec3  n[4];
        Error err = { 0 };
        for (uint32_t k = 0; k < r->soup.first[i + 1] - first; k++) {
            double v[3];
            for (int axis = 0; axis < 3; axis++) {
                word = word * 1664525u + 1013904223u;
                v[axis] = (word >> 8) / 8388608.0 - 1;
            }
            n[k] = how == WILD ? vec3(v[0], v[1], v[2])
                               : vec3_scale(r->soup.position[r->soup.corner[first + k]], -7);
        }
        assert_true(polygons_set_normals(&r->soup, (uint32_t)i, n, &err));
    }
}

/* Mean brightness of the ball in a room that shines everywhere alike with radiance 1, and its
 * standard error. */
static Image *furnace(const Globe *globe, Spoilt how, double *mean, double *error)
{
    TestRoom r = { 0 };
    add_globe(&r, globe, room_material(&r, 0.5, 0));
    spoil(&r, how);
    room_box(&r, vec3(-4, -4, -4), vec3(4, 4, 4), BOX_ALL, true, room_material(&r, 0, M_PI), "");
    finish(&r, NULL, 0);
    Image *image = paths(&r, 64);
    double sum = 0, square = 0;
    int    count = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            Vec3 n;
            if (!ball_normal(x, y, &n))
                continue;
            const double value = image->radiance[3 * (y * SIDE + x)];
            sum += value;
            square += value * value;
            count++;
        }
    *mean = sum / count;
    *error = sqrt((square / count - *mean * *mean) / count);
    room_clear(&r);
    return image;
}

/* In a room that shines everywhere alike a ball sends back its albedo: nothing is lost at edges of
 * triangles, nothing won; nor with the file's normals. Wild ones may lose light, and win none. */
static void furnace_shows_the_albedo(void **state)
{
    (void)state;
    static const Globe fine = { 12, 24, false }, coarse = { 10, 11, true };
    double mean, error;
    image_destroy(furnace(&fine, AS_THEY_ARE, &mean, &error));
    assert_true(fabs(mean - 0.5) <= 4 * error);
    assert_true(error < 0.002);
    Image *one = furnace(&coarse, AS_THEY_ARE, &mean, &error);
    assert_true(fabs(mean - 0.5) <= 4 * error);
    assert_true(error < 0.002);
    /* Which side normals are on does not matter. */
    Image *two = furnace(&coarse, TURNED_ROUND, &mean, &error);
    assert_memory_equal(one->radiance, two->radiance, 3 * SIDE * SIDE * sizeof *one->radiance);
    image_destroy(one);
    image_destroy(two);
    image_destroy(furnace(&coarse, WILD, &mean, &error));
    assert_true(mean <= 0.5 + 4 * error);
}

/* Something close over the ball: light is received under it, not beyond. */
static void nothing_is_passed_on_the_way_out(void **state)
{
    (void)state;
    const Light light = { .kind = LIGHT_POINT, .position = { 0, 100, 0 },
                          .intensity = { 1e4, 1e4, 1e4 } };
    TestRoom r = { 0 };
    add_ball(&r, room_material(&r, 0.5, 0));
    const uint32_t plate = room_material(&r, 0.5, 0);
    /* A corner reaches y = 1; the blend of tangent planes there as far beyond the ball as triangles
     * lie within, STEP^2 / 4 at most. */
    room_quad(&r, vec3(-2, 1.005, -2), vec3(0, 0, 4), vec3(4, 0, 0), plate, "plate");
    finish(&r, &light, 1);
    float *smooth;
    Error  err = { 0 };
    smooth = normals_create(&r.room, &err);
    assert_non_null(smooth);
    int lifted = 0, kept = 0;
    for (int i = 0; i < 400; i++) {
        const double x = 0.01 * (i % 20) - 0.1, z = 0.01 * (i / 20.0) - 0.1;
        const Ray    ray = { .ox = (float)x, .oy = 1.004F, .oz = (float)z, .dy = -1,
                             .t_max = INFINITY };
        Hit          h;
        RoomHit      hit;
        if (!bvh_nearest(r.bvh, &ray, &h))
            continue;
        room_hit(&r.room, &h, vec3(0, -1, 0), &hit);
        const Receiver at = normals_receive(smooth, &r.room, &hit);
        assert_true(at.point.y < 1.005);
        lifted += at.point.y > hit.point.y;
        kept += at.point.y == hit.point.y;
    }
    assert_true(lifted > 20 && kept > 20);
    array_free(smooth);
    room_clear(&r);
}

static void shares_of_light(void **state)
{
    (void)state;
    const Vec3 face = { 0, 0, 1 }, normal = { sin(0.2), 0, cos(0.2) };
    assert_true(normals_share(vec3(1, 0, 0), face, face) == 1);
    for (int i = 0; i < 360; i++) {
        const double a = i * M_PI / 180, b = a + M_PI / 180;
        const double share = normals_share(vec3(sin(a), 0, cos(a)), normal, face);
        const double next = normals_share(vec3(sin(b), 0, cos(b)), normal, face);
        assert_true(share >= 0 && share <= 1);
        if (cos(a) <= 0)
            assert_true(share == 0);
        /* Seen with the cosine it counts with it has no jump: below 3 times the step. */
        const double one = share * fmax(sin(a + M_PI / 2 - 0.2), 0);
        const double two = next * fmax(sin(b + M_PI / 2 - 0.2), 0);
        assert_true(fabs(one - two) <= 3 * M_PI / 180 / cos(0.2));
    }
}

static void a_box_is_flat(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error    err = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(1, 2, 3), BOX_ALL, false, room_material(&r, 0.5, 0), "");
    finish(&r, NULL, 0);
    assert_null(normals_create(&r.room, &err));
    assert_false(error_is_set(&err));
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brightness_is_that_of_the_ball),
        cmocka_unit_test(normals_of_the_file_make_a_ball),
        cmocka_unit_test(furnace_shows_the_albedo),
        cmocka_unit_test(nothing_is_passed_on_the_way_out),
        cmocka_unit_test(shares_of_light),
        cmocka_unit_test(a_box_is_flat),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
