/* SPDX-License-Identifier: BSD-3-Clause */
/* Measuring in the window, without one: statistics, probes, work planes, layers, scales. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "base/file.h"
#include "tests/room_maker.h"
#include "viewer/false_map.h"
#include "viewer/layers.h"
#include "viewer/measure_plane.h"

/* A room with all that a snapshot of it needs. */
typedef struct {
    TestRoom   r;
    ShownMesh *mesh;
    Snapshot  *snapshot;
    double    *radiosity;
} Shown;

/* From the room's surfaces on; every patch gets its own emission as radiosity. */
static void show(Shown *s, double size, const Light *lights, size_t light_count)
{
    Error  err = { 0 };
    double *rho = NULL;
    const Vec3 eye = vec3(0.5, 0.5, 0.25); /* so that the insides of bodies take no part */
    room_finish(&s->r, size, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, lights, light_count,
                NULL);
    room_problem(&s->r, &s->radiosity, &rho);
    Scene scene = { .polygons = s->r.soup, .up = vec3(0, 0, 1), .lights = (Light *)lights,
                    .light_count = light_count };
    s->mesh = shown_mesh_create(&scene, s->r.patches, s->r.emitting, &(Camera){ 0 }, 1, &err);
    assert_non_null(s->mesh);
    VertexCarry *carry = vertex_carry_create(s->r.patches, s->r.patches->area, &err);
    assert_non_null(carry);
    s->snapshot = snapshot_create(s->mesh, s->r.patches, carry, s->radiosity, &err);
    vertex_carry_destroy(carry);
    assert_non_null(s->snapshot);
    array_free(rho);
}

static void hide(Shown *s)
{
    snapshot_destroy(s->snapshot);
    shown_mesh_leave(s->mesh);
    array_free(s->radiosity);
    room_clear(&s->r);
}

static void statistics_with_weights(void **state)
{
    (void)state;
    Error err = { 0 };
    Statistics s;
    const double value[] = { 4, 1, NAN, 2, 100, 3 };
    const double weight[] = { 1, 2, 5, 1, 0, 4 };
    assert_true(statistics_find(value, weight, 6, &s, &err));
    /* 1 twice, 2, 3 four times, 4: sum 20 over 8 */
    assert_int_equal(s.count, 4);
    assert_true(s.weight == 8 && s.least == 1 && s.greatest == 4 && s.median == 3);
    assert_true(fabs(s.mean - 2.5) < rounding_bound(16));
    /* (2 * 1.5^2 + 0.5^2 + 4 * 0.5^2 + 1.5^2) / 8 = 1 */
    assert_true(fabs(s.deviation - 1) < rounding_bound(16));
    assert_true(statistics_find(value, NULL, 2, &s, &err));
    assert_true(s.median == 1 && s.mean == 2.5);
    assert_true(statistics_find(value + 2, NULL, 1, &s, &err));
    assert_true(s.count == 0 && isnan(s.mean) && isnan(s.median));
}

/* The standard's own table: 0.4 m gives 0.15 m, 1 m 0.2 m, 2 m 0.3 m, 10 m 1 m, 100 m 5 m. */
static void spacing_of_the_standard(void **state)
{
    (void)state;
    static const double table[][2] = { { 0.6, 0.15 }, { 1, 0.2 }, { 2, 0.3 }, { 5, 0.6 },
                                       { 10, 1 }, { 25, 2 }, { 50, 3 }, { 100, 5 } };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) /* its values are rounded */
        assert_true(fabs(plane_spacing(table[i][0], 0.9 * table[i][0]) - table[i][1]) <
                    0.1 * table[i][1]);
    assert_true(fabs(plane_spacing(10, 1) - 0.2) < rounding_bound(8)); /* long: the shorter */
    assert_true(fabs(plane_spacing(1, 10) - 0.2) < rounding_bound(8));
}

/* Walls all of radiosity 3: every point gets 3. */
static void furnace(void **state)
{
    (void)state;
    Shown s = { 0 };
    Error err = { 0 };
    PlaneReport report;
    room_box(&s.r, vec3(0, 0, 0), vec3(4, 3, 2), BOX_ALL, true, room_material(&s.r, 0, 3), "");
    show(&s, 0.5, NULL, 0);
    for (uint32_t i = 0; i < s.mesh->patch_count; i++)
        s.mesh->patch[i].lamp = false; /* through the rays, not as a lamp */
    Plane *plane = plane_create(s.mesh, &(PlaneWish){ PLANE_ALL, 0.75, 0.5, 1 }, 2, &err);
    assert_non_null(plane);
    assert_true(plane->length > 0 && fabs(plane->length * plane->width - 6) < rounding_bound(32));
    assert_true(fabs(plane->spacing - 0.2 * pow(5, log10(3))) < rounding_bound(16));
    assert_int_equal(plane->columns * plane->rows, 7 * 5); /* 3 / 0.43, 2 / 0.43 */
    assert_true(isnan(plane_value(plane, 0)));
    assert_true(plane_gather(plane, s.snapshot, 64, 2, &err));
    assert_true(plane_gather(plane, s.snapshot, 64, 1, &err));
    assert_true(plane_report(plane, &report, &err));
    assert_int_equal(report.all.count, 35);
    assert_true(fabs(report.all.mean - 3) < 3e-6 && fabs(report.uniformity - 1) < 1e-6);
    assert_true(fabs(report.diversity - 1) < 1e-6); /* vertices are floats */
    plane_destroy(plane);
    hide(&s);
}

/* A unit square of radiosity 1 straight above, at 1 m: F = 4 X/(pi sqrt(1+X2)) atan(X/sqrt(1+X2)),
 * X = 1/2, doubled in two parts; a wall hides half of it from no point of the axis. */
static void lamp_and_light(void **state)
{
    (void)state;
    Shown s = { 0 };
    Error err = { 0 };
    const Light light = { .kind = LIGHT_POINT, .position = { 0.5, 0.5, 1.5 },
                          .intensity = { 9, 9, 9 } };
    room_quad(&s.r, vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), room_material(&s.r, 0.5, 0),
              "floor");
    room_quad(&s.r, vec3(0, 0, 1), vec3(0, 1, 0), vec3(1, 0, 0), room_material(&s.r, 0, 1),
              "lamp");
    show(&s, 2, &light, 1);
    const PlaneWish wish = { room_group(&s.r, "floor"), 0.001, 0.4, 1 };
    Plane *plane = plane_create(s.mesh, &wish, 1, &err);
    assert_non_null(plane);
    assert_true(plane_gather(plane, s.snapshot, 16, 1, &err));
    const double x = 0.5 / 0.999, root = sqrt(1 + x * x);
    const double closed = 4 / M_PI * x / root * atan(x / root);
    double nearest = INFINITY, value = 0;
    for (uint32_t i = 0; i < plane->count; i++) {
        const double d = hypot(plane->point[i].x - 0.5, plane->point[i].y - 0.5);
        if (d < nearest) {
            nearest = d;
            value = plane_value(plane, i);
        }
    }
    assert_true(nearest < 1e-9); /* an odd grid has a point in the middle */
    /* the point light is behind the lamp, so hidden */
    assert_true(fabs(value - closed) < 1e-6);
    plane_destroy(plane);
    hide(&s);
}

static void light_without_walls(void **state)
{
    (void)state;
    Shown s = { 0 };
    Error err = { 0 };
    const Light light = { .kind = LIGHT_POINT, .position = { 0.5, 0.5, 2 },
                          .intensity = { 9, 9, 9 } };
    room_quad(&s.r, vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), room_material(&s.r, 0.5, 0),
              "floor");
    show(&s, 2, &light, 1);
    Plane *plane = plane_create(s.mesh, &(PlaneWish){ 0, 0.5, 0, 1 }, 1, &err);
    assert_non_null(plane);
    assert_true(plane_gather(plane, s.snapshot, 16, 1, &err));
    for (uint32_t i = 0; i < plane->count; i++) {
        const Vec3 to = vec3_sub(light.position, plane->point[i]);
        const double d = vec3_length(to), exact = 9 * 1.5 / (d * d * d);
        assert_true(fabs(plane_value(plane, i) - exact) < exact * rounding_bound(64));
    }
    plane_destroy(plane);
    hide(&s);
}

static void points_in_a_body_do_not_count(void **state)
{
    (void)state;
    Shown s = { 0 };
    Error err = { 0 };
    PlaneReport report;
    const uint32_t grey = room_material(&s.r, 0.5, 0);
    room_box(&s.r, vec3(0, 0, 0), vec3(10, 10, 3), BOX_ALL, true, grey, "");
    room_box(&s.r, vec3(2, 2, 0.5), vec3(7, 7, 1.5), BOX_ALL, false, grey, "body ");
    show(&s, 5, NULL, 0);
    Plane *plane = plane_create(s.mesh, &(PlaneWish){ PLANE_ALL, 1, 0, 1 }, 1, &err);
    assert_non_null(plane);
    assert_int_equal(plane->count, 100);
    assert_true(plane_gather(plane, s.snapshot, 1, 1, &err));
    assert_true(plane_report(plane, &report, &err));
    assert_int_equal(report.all.count, 75);
    assert_true(report.all.mean == 0 && isnan(report.uniformity) && isnan(report.diversity));
    plane_destroy(plane);
    assert_null(plane_create(s.mesh, &(PlaneWish){ PLANE_ALL, 1, 5, 1 }, 1, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    hide(&s);
}

/* From a face of a cube to the opposite one 0.19982, to each other 0.20004; all together 1. */
static void factors_in_a_cube(void **state)
{
    (void)state;
    Shown s = { 0 };
    Error err = { 0 };
    double sum = 0, share[6] = { 0 };
    room_box(&s.r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&s.r, 0.5, 0), "");
    show(&s, 2, NULL, 0);
    assert_int_equal(s.mesh->patch_count, 6);
    float *factor = array_create(6, sizeof *factor, "factors", &err);
    assert_true(layer_factors(s.mesh, 2, 1 << 14, factor, &err));
    for (uint32_t i = 0; i < 6; i++) {
        share[i] = (double)factor[i];
        sum += share[i];
    }
    assert_true(fabs(sum - 1) < 1e-5); /* 16384 sums in float */
    for (uint32_t i = 0; i < 6; i++) {
        const double cosine = vec3_dot(s.mesh->patch[i].normal, s.mesh->patch[2].normal);
        const double exact = cosine > 0.5 ? 0 : cosine < -0.5 ? 0.199825 : 0.200044;
        /* a net of 2^14 points: well below the 3 / sqrt(2^14) * 0.4 of chance */
        assert_true(fabs(share[i] - exact) < 0.003);
    }
    array_free(factor);
    hide(&s);
}

static void layers_from_a_snapshot(void **state)
{
    (void)state;
    Shown s = { 0 };
    Error err = { 0 };
    room_box(&s.r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL - BOX_Z1, true,
             room_material(&s.r, 0.5, 0), "");
    room_box(&s.r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_Z1, true, room_material(&s.r, 0.2, 7), "l");
    show(&s, 2, NULL, 0);
    const uint32_t n = s.mesh->patch_count;
    double *h = array_create(3 * (size_t)n, sizeof *h, "H", &err);
    float  *out = array_create(n, sizeof *out, "out", &err);
    assert_false(layer_known(s.snapshot, SHOWN_INDIRECT, true));
    assert_false(layer_known(s.snapshot, SHOWN_FACTORS, false));
    for (uint32_t i = 0; i < 3 * n; i++)
        h[i] = 4;
    assert_true(snapshot_layer(s.snapshot, LAYER_IRRADIANCE, h, &err));
    for (uint32_t i = 0; i < 3 * n; i++)
        h[i] = 1;
    assert_true(snapshot_layer(s.snapshot, LAYER_DIRECT, h, &err));
    static const double expected[SHOWN_COUNT] = { [SHOWN_IRRADIANCE] = 4, [SHOWN_DIRECT] = 1,
        [SHOWN_INDIRECT] = 3, [SHOWN_RESIDUAL] = 2, [SHOWN_REFLECTANCE] = 0.5 };
    for (int k = 0; k < SHOWN_COUNT; k++) {
        assert_true(layer_name((ShownLayer)k)[0] != 0);
        if (!layer_known(s.snapshot, (ShownLayer)k, false))
            continue;
        layer_fill(s.snapshot, (ShownLayer)k, NULL, out);
        for (uint32_t i = 0; i < n; i++)
            if (!s.mesh->patch[i].lamp)
                assert_true(fabs((double)out[i] - expected[k]) < 1e-6);
            else if (k == SHOWN_RESIDUAL)
                assert_true(isnan(out[i]));
    }
    assert_string_equal(layer_unit(SHOWN_DIRECT, true), "lux");
    array_free(h);
    array_free(out);
    hide(&s);
}

/* Readings at a place, kept, and a file with a name that needs quotes. */
static void probes_go_into_a_file(void **state)
{
    (void)state;
    Shown  s = { 0 };
    Error  err = { 0 };
    Probes probes = { 0 };
    Reading reading;
    Hit    hit;
    char   path[64];
    room_quad(&s.r, vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), room_material(&s.r, 0.5, 2),
              "a \"desk\", low");
    show(&s, 2, NULL, 0);
    const Ray ray = { .ox = 0.25F, .oy = 0.5F, .oz = 1, .dz = -1, .t_max = INFINITY };
    assert_true(bvh_nearest(s.mesh->bvh, &ray, &hit));
    reading_take(s.snapshot, hit.primitive, (double)hit.u, (double)hit.v, &reading);
    assert_true(fabs(reading.place.x - 0.25) < 1e-6 && fabs(reading.place.y - 0.5) < 1e-6);
    assert_true(fabs(reading.radiosity - 2) < 1e-6 && fabs(reading.here - 2) < 1e-6);
    assert_true(fabs(reading.luminance - 2 / M_PI) < 1e-6 && fabs(reading.area - 1) < 1e-6);
    assert_true(isnan(reading.irradiance) && isnan(reading.error) && isnan(reading.row_sum));
    assert_true(probes_add(&probes, s.mesh, &reading, &err));
    assert_true(probes_add(&probes, s.mesh, &reading, &err));
    probes_remove(&probes, 0);
    snprintf(path, sizeof path, "/tmp/isolux_probes_%ld.csv", (long)getpid());
    assert_true(probes_write(&probes, true, path, &err));
    size_t size = 0;
    char *text = file_read(path, 4096, &size, &err);
    assert_non_null(text);
    assert_string_equal(text, "x,y,z,nx,ny,nz,patch,group,material,area,lux,lux_error,lm/m2,"
                              "lm/m2_here,cd/m2,row_sum\n"
                              "0.25,0.5,0,0,0,1,0,\"a \"\"desk\"\", low\",\"\",1,,,2,2,"
                              "0.636619772,\n");
    unlink(path);
    array_free(text);
    probes_clear(&probes);
    hide(&s);
}

static void ranges_follow_the_hand(void **state)
{
    (void)state;
    FalseMap map;
    uint8_t  rgb[3 * FALSE_TEXELS], end[3];
    const float values[] = { 1, 50, 90, 80 };
    false_map_init(&map);
    false_map_fit(&map, values, 4);
    assert_true(map.scale.low == 0 && map.scale.high == 100);
    false_map_drag(&map, 1, 0.5);
    assert_true(map.held && map.scale.high == 150 && map.scale.low == 0);
    false_map_fit(&map, values, 4);
    assert_true(map.scale.high == 150); /* held */
    false_map_drag(&map, 0, -1);
    assert_true(map.scale.low == 0);    /* light is never less than none */
    false_map_drag(&map, 0, 5);
    assert_true(map.scale.low < map.scale.high && map.scale.low > 149);
    false_map_drag(&map, 0, -1000);
    false_map_set_log(&map, true);
    assert_true(map.scale.low > 0 && map.scale.logarithmic);
    const double ratio = map.scale.high / map.scale.low;
    false_map_shift(&map, 0.5);
    assert_true(fabs(map.scale.high / map.scale.low / ratio - 1) < rounding_bound(64));
    assert_true(fabs(map.scale.high / 150 / sqrt(ratio) - 1) < rounding_bound(64));
    false_map_texels(&map, rgb);
    false_colour_at(1 - 0.5 / FALSE_TEXELS, end);
    assert_memory_equal(rgb + 3 * (FALSE_TEXELS - 1), end, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(statistics_with_weights), cmocka_unit_test(spacing_of_the_standard),
        cmocka_unit_test(furnace), cmocka_unit_test(lamp_and_light),
        cmocka_unit_test(light_without_walls), cmocka_unit_test(points_in_a_body_do_not_count),
        cmocka_unit_test(factors_in_a_cube), cmocka_unit_test(layers_from_a_snapshot),
        cmocka_unit_test(probes_go_into_a_file), cmocka_unit_test(ranges_follow_the_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
