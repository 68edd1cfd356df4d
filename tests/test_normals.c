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

/* A ball of radius 1 around 0; corners lie on it. */
static void add_ball(TestRoom *r, uint32_t material)
{
    enum { ROWS = 12, COLUMNS = 24 };
    Error    err = { 0 };
    uint32_t vertex[ROWS + 1][COLUMNS], group;
    assert_true(polygons_add_group(&r->soup, "ball", &group, &err));
    for (int j = 0; j <= ROWS; j++)
        for (int i = 0; i < COLUMNS; i++) {
            const double t = STEP * j, p = STEP * i;
            const Vec3   n = vec3(sin(t) * cos(p), sin(t) * sin(p), cos(t));
            assert_true(polygons_add_vertex(&r->soup, n, &vertex[j][i], &err));
        }
    for (int j = 0; j < ROWS; j++)
        for (int i = 0; i < COLUMNS; i++) {
            const int      k = (i + 1) % COLUMNS;
            const uint32_t c[4] = { vertex[j][i], vertex[j + 1][i], vertex[j + 1][k],
                                    vertex[j][k] };
            const uint32_t cap[2][3] = { { c[0], c[1], c[2] }, { c[0], c[1], c[3] } };
            const bool     ends = j == 0 || j == ROWS - 1;
            assert_true(polygons_add_polygon(&r->soup, ends ? cap[j > 0] : c, ends ? 3 : 4,
                                             material, group, &err));
        }
}

/* No patches: both sides in use, fronts of what emits emit. */
static void finish(TestRoom *r, const Light *light, size_t lights)
{
    room_connect(r);
    for (uint32_t i = 0; i < r->surfaces->count; i++) {
        r->sides[i] = 3;
        r->emitting[i] = rgb_max(r->soup.materials[r->surfaces->surface[i].material].emission) > 0;
    }
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh, .materials = r->soup.materials,
                      .material_count = r->soup.material_count, .lights = light,
                      .light_count = lights, .sides = r->sides, .emitting = r->emitting,
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

/* In a room that shines everywhere alike a ball sends back its albedo: nothing is lost at edges of
 * triangles, nothing won. */
static void furnace_shows_the_albedo(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    add_ball(&r, room_material(&r, 0.5, 0));
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
    const double mean = sum / count, error = sqrt((square / count - mean * mean) / count);
    assert_true(fabs(mean - 0.5) <= 4 * error);
    assert_true(error < 0.002);
    image_destroy(image);
    room_clear(&r);
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
    smooth = normals_create(r.surfaces, &err);
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
    assert_null(normals_create(r.surfaces, &err));
    assert_false(error_is_set(&err));
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brightness_is_that_of_the_ball),
        cmocka_unit_test(furnace_shows_the_albedo),
        cmocka_unit_test(nothing_is_passed_on_the_way_out),
        cmocka_unit_test(shares_of_light),
        cmocka_unit_test(a_box_is_flat),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
