/* SPDX-License-Identifier: BSD-3-Clause */
/* Paths against closed forms: lamps, lights, furnaces, mirrors, panes, bodies of glass. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "render/path.h"
#include "tests/room_maker.h"

static uint32_t add_material(TestRoom *r, const Material *material)
{
    Error    err = { 0 };
    uint32_t index = 0;
    assert_true(polygons_add_material(&r->soup, material, &index, &err));
    return index;
}

static uint32_t mirror(TestRoom *r, double share, double exponent)
{
    Material m = material_default();
    m.reflectance = rgb(0, 0, 0);
    m.specular = rgb(share, share, share);
    m.exponent = exponent;
    return add_material(r, &m);
}

static uint32_t glass(TestRoom *r, double transmittance, double ior)
{
    Material m = material_default();
    m.reflectance = rgb(0, 0, 0);
    m.transmittance = rgb(transmittance, transmittance, transmittance);
    m.ior = ior;
    return add_material(r, &m);
}

static void add_shape(TestRoom *r, ShapeKind kind, Vec3 at, double size, uint32_t material)
{
    const Affine map = { { size, 0, 0 }, { 0, size, 0 }, { 0, 0, size }, at };
    Shape        shape;
    Error        err = { 0 };
    uint32_t     group;
    assert_true(shape_init(&shape, kind, 1, &map, &err));
    assert_true(polygons_add_group(&r->soup, "", &group, &err));
    assert_true(polygons_add_shape(&r->soup, &shape, material, group, &err));
}

/* No patches: sides as given, fronts of what emits emit. */
static void finish(TestRoom *r, const Light *light, size_t lights)
{
    room_connect(r);
    for (uint32_t i = 0; i < r->surfaces->count; i++) {
        const Material *m = &r->soup.materials[r->surfaces->surface[i].material];
        r->sides[i] = 3;
        r->emitting[i] = rgb_max(m->emission) > 0;
    }
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh, .materials = r->soup.materials,
                      .material_count = r->soup.material_count, .lights = light,
                      .light_count = lights, .sides = r->sides, .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
}

typedef struct {
    double value, error;
} Seen;

/* Radiance at a point seen from `eye`, by parallel rays: one spot, not a field. */
static Seen look(const TestRoom *r, Vec3 eye, Vec3 at, uint32_t samples)
{
    const Camera camera = { .eye = eye, .target = at, .up = { 0.1, 0.9, 0.3 },
                            .projection = CAMERA_ORTHOGRAPHIC, .view_height = 1e-4 };
    const PathOptions options = { .width = 1, .height = 1, .samples = samples, .threads = 1,
                                  .seed = 5 };
    Error  err = { 0 };
    Image *image = render_path(&r->room, &camera, &options, NULL, NULL, &err);
    assert_non_null(image);
    const Seen seen = { image->radiance[1], image->deviation[0] };
    image_destroy(image);
    return seen;
}

/* Within four standard errors; the view covers 1e-4, over which light changes by about as much. */
static void assert_seen(Seen seen, double exact, double error_most)
{
    const double slack = 4 * seen.error + 2e-4 * exact;
    if (!(fabs(seen.value - exact) <= slack) || !(seen.error <= error_most * exact))
        fail_msg("%.8g +- %.2g is not %.8g", seen.value, seen.error, exact);
}

/* --- lamps and lights ------------------------------------------------------------------------ */

/* Irradiance under the corner of a rectangle a x b at height c, per radiance; [howell, C-4], times
 * pi. */
static double under_corner(double a, double b, double c)
{
    const double p = sqrt(a * a + c * c), q = sqrt(b * b + c * c);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / 2;
}

/* A floor of 0.5 under a lamp [-1,1]^2 at height c: radiance 0.5 / pi E. Very near the lamp nearly
 * all samples of its area fail, and the rays that meet it do it. Whole, and cut into 100. */
static void square_lamps(void **state)
{
    (void)state;
    static const double height[] = { 1, 0.05, 4 };
    for (int cut = 1; cut <= 10; cut += 9)
        for (int k = 0; k < 3; k++) {
            TestRoom     r = { 0 };
            const double c = height[k], d = 2.0 / cut;
            const uint32_t lamp = room_material(&r, 0, 3 * M_PI);
            room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0),
                      room_material(&r, 0.5, 0), "floor");
            for (int i = 0; i < cut * cut; i++)
                room_quad(&r, vec3(-1 + d * (i % cut), -1 + d * (i / cut), c), vec3(0, d, 0),
                          vec3(d, 0, 0), lamp, "lamp");
            finish(&r, NULL, 0);
            assert_seen(look(&r, vec3(0.02 * c, 0, 0.04 * c), vec3(0, 0, 0), 8192),
                        0.5 / M_PI * 3 * 4 * under_corner(1, 1, c), 0.02);
            room_clear(&r);
        }
}

/* Ball of radius R at distance d: E = pi L (R/d)^2; disc over the middle: pi L R^2/(R^2 + h^2). */
static void curved_lamps(void **state)
{
    (void)state;
    for (int disc = 0; disc < 2; disc++) {
        TestRoom r = { 0 };
        room_quad(&r, vec3(-9, -9, 0), vec3(0, 18, 0), vec3(18, 0, 0), room_material(&r, 0.5, 0),
                  "ceiling"); /* fronts down, where the disc's front lights it from below */
        add_shape(&r, disc ? SHAPE_DISC : SHAPE_SPHERE, vec3(0, 0, -1), 0.8,
                  room_material(&r, 0, 2 * M_PI));
        finish(&r, NULL, 0);
        const double e = 2 * M_PI * 0.64 / (disc ? 1.64 : 1);
        assert_seen(look(&r, vec3(0.05, 0.01, -0.1), vec3(0, 0, 0), 8192), 0.5 / M_PI * e, 0.01);
        room_clear(&r);
    }
}

/* H = I cos / d^2, behind a pane what it lets through; several by chance. */
static void lights_without_size(void **state)
{
    (void)state;
    const Light light[2] = {
        { .kind = LIGHT_POINT, .position = { 0, 0, 2 }, .intensity = { 8, 8, 8 } },
        { .kind = LIGHT_COSINE, .position = { 3, 0, 4 }, .direction = { 0, 0, -1 },
          .intensity = { 1, 1, 1 } } };
    for (int pane = 0; pane < 2; pane++) {
        TestRoom r = { 0 };
        room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0), room_material(&r, 0.5, 0),
                  "floor");
        if (pane)
            room_quad(&r, vec3(-9, -9, 1), vec3(18, 0, 0), vec3(0, 18, 0), glass(&r, 0.8, 1.5),
                      "pane");
        finish(&r, light, 2);
        /* Fresnel at right angles: f = 0.04; both faces: 2 f / (1 + f). */
        const double through = pane ? 0.8 * (1 - 0.08 / 1.04) : 1;
        Seen seen = look(&r, vec3(0, 0.01, 0.5), vec3(0, 0, 0), 4096);
        if (!pane) /* 8 / 2^2, and cos^2 / d^2 = (4/5)^2 / 25 */
            assert_seen(seen, 0.5 / M_PI * (2 + 0.0256), 0.01);
        /* With the pane, the floor also sees itself in it: only the light's part is known. */
        assert_true(seen.value > 0.5 / M_PI * through * 2);
        room_clear(&r);
        if (!pane)
            continue;
        TestRoom black = { 0 };
        room_quad(&black, vec3(-0.01, -0.01, 0), vec3(0.02, 0, 0), vec3(0, 0.02, 0),
                  room_material(&black, 0.5, 0), "floor"); /* too small to see itself */
        room_quad(&black, vec3(-9, -9, 1), vec3(18, 0, 0), vec3(0, 18, 0), glass(&black, 0.8, 1.5),
                  "pane");
        finish(&black, light, 1);
        seen = look(&black, vec3(0, 0.01, 0.5), vec3(0, 0, 0), 4096);
        assert_seen(seen, 0.5 / M_PI * 2 * through, 0.01);
        room_clear(&black);
    }
}

/* --- furnaces -------------------------------------------------------------------------------- */

/* All walls alike, L = E / pi / (1 - rho): diffuse, or a mirror. */
static void furnaces(void **state)
{
    (void)state;
    static const double rho[] = { 0, 0.5, 0.9 };
    for (int specular = 0; specular < 2; specular++)
        for (int i = 0; i < 3; i++) {
            TestRoom r = { 0 };
            Material m = material_default();
            m.reflectance = rgb(0, 0, 0);
            *(specular ? &m.specular : &m.reflectance) = rgb(rho[i], rho[i], rho[i]);
            m.exponent = INFINITY;
            m.emission = rgb(1, 1, 1);
            room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, add_material(&r, &m), "");
            finish(&r, NULL, 0);
            assert_seen(look(&r, vec3(0.5, 0.4, 0.6), vec3(0.1, 0.2, 0), 4096), 1 / (1 - rho[i]),
                        0.03);
            room_clear(&r);
        }
}

/* In a black room whose walls shine with 1 all round, glass that takes nothing away shows 1 from
 * everywhere: a pane, a ball, a cube of water; a pane that keeps 30 % of what crosses it shows
 * R + 0.7 (1 - R); gloss seen at right angles shows its share, for its lobe integrates to it
 * there; mirror directions at 45 degrees, too. */
static void glass_in_a_furnace(void **state)
{
    (void)state;
    const double f45 = pow((cos(M_PI / 4) - 1.5 * sqrt(1 - 0.5 / 2.25)) /
                           (cos(M_PI / 4) + 1.5 * sqrt(1 - 0.5 / 2.25)), 2);
    const double p45 = (f45 + f45 * f45) / 2; /* at 45 degrees the other polarisation is f^2 */
    const double pane45 = 2 * p45 / (1 + p45);
    const struct {
        int    what; /* 0 pane, 1 ball, 2 box, 3 gloss */
        double share, index;
        Vec3   eye;
        double exact;
    } cases[] = {
        { 0, 1, 1.5, { 0, 0, 1 }, 1 },       { 0, 1, 1.5, { 1, 0, 1 }, 1 },
        { 0, 0.7, 1.5, { 1, 0, 1 }, pane45 + 0.7 * (1 - pane45) },
        { 1, 1, 1.5, { 0.3, 0.2, 2 }, 1 },   { 2, 1, 1.33, { 0.9, 0.8, 2 }, 1 },
        { 3, 0.6, 5, { 0, 0, 1 }, 0.6 },     { 3, 0.6, 200, { 0, 0, 1 }, 0.6 },
        { 3, 0.6, INFINITY, { 1, 0, 1 }, 0.6 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TestRoom       r = { 0 };
        const uint32_t m = cases[i].what == 3 ? mirror(&r, cases[i].share, cases[i].index)
                                              : glass(&r, cases[i].share, cases[i].index);
        room_box(&r, vec3(-5, -5, -5), vec3(5, 5, 5), BOX_ALL, true, room_material(&r, 0, M_PI),
                 "");
        if (cases[i].what == 1)
            add_shape(&r, SHAPE_SPHERE, vec3(0, 0, 0), 1, m);
        else if (cases[i].what == 2)
            room_box(&r, vec3(-1, -1, -1), vec3(1, 1, 1), BOX_ALL, false, m, "body");
        else
            room_quad(&r, vec3(-2, -2, 0), vec3(4, 0, 0), vec3(0, 4, 0), m, "plate");
        finish(&r, NULL, 0);
        assert_seen(look(&r, cases[i].eye, vec3(0, 0, 0), 8192), cases[i].exact, 0.02);
        room_clear(&r);
    }
}

/* Light that a mirror throws: a lamp at height 1 beside a perfect mirror lights the floor as two
 * lamps would. By way of the mirror it is met by rays alone. */
static void mirror_doubles_a_lamp(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    /* The lamp [0,1] x [-1,1] touches the mirror x = 0, which is large. */
    room_quad(&r, vec3(0, -1, 1), vec3(0, 2, 0), vec3(1, 0, 0), room_material(&r, 0, 3 * M_PI),
              "lamp");
    room_quad(&r, vec3(0, -50, 0), vec3(0, 100, 0), vec3(0, 0, 50), mirror(&r, 1, INFINITY),
              "mirror");
    room_quad(&r, vec3(0, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), room_material(&r, 0.5, 0),
              "floor");
    finish(&r, NULL, 0);
    /* Under the middle of the doubled lamp, in the mirror's foot: 4 corners. */
    assert_seen(look(&r, vec3(0.3, 0.02, 0.2), vec3(1e-3, 0, 0), 16384),
                0.5 / M_PI * 3 * 4 * under_corner(1, 1, 1), 0.02);
    room_clear(&r);
}

/* --- the program's side ---------------------------------------------------------------------- */

static void small_scene(TestRoom *r)
{
    room_box(r, vec3(0, 0, 0), vec3(2, 2, 2), BOX_ALL & ~BOX_Z1, true, room_material(r, 0.7, 0),
             "");
    room_quad(r, vec3(0.5, 0.5, 2), vec3(0, 1, 0), vec3(1, 0, 0), room_material(r, 0, 20), "lamp");
    room_quad(r, vec3(0, 0, 2.1), vec3(0, 2, 0), vec3(2, 0, 0), mirror(r, 0.5, 30), "top");
    add_shape(r, SHAPE_SPHERE, vec3(1, 1, 0.5), 0.4, glass(r, 0.9, 1.5));
    finish(r, NULL, 0);
}

static Image *shoot(const TestRoom *r, const PathOptions *options, PathReport *report,
                    const Monitor *monitor, Error *err)
{
    const Camera camera = { .eye = { 1, 0.1, 1 }, .target = { 1, 2, 0.8 }, .up = { 0, 0, 1 },
                            .vertical_fov = 70 };
    return render_path(&r->room, &camera, options, report, monitor, err);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error    err = { 0 };
    Image   *first = NULL;
    small_scene(&r);
    for (unsigned threads = 1; threads <= 3; threads++) {
        PathReport report;
        Image *image = shoot(&r, &(PathOptions){ .width = 21, .height = 13, .samples = 20,
                                                 .threads = threads }, &report, NULL, &err);
        assert_non_null(image);
        assert_true(report.samples == 20 && report.rays > 21 * 13 * 20 && report.error > 0);
        if (first == NULL) {
            first = image;
            continue;
        }
        assert_memory_equal(image->radiance, first->radiance, 3 * 21 * 13 * sizeof(float));
        assert_memory_equal(image->deviation, first->deviation, 21 * 13 * sizeof(float));
        image_destroy(image);
    }
    image_destroy(first);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* The deviation is what pictures of other seeds deviate by. The mean of 48 variances of a pixel of
 * 16 batches or so against their scatter: both known to some 20 % of a sigma in 31 and more
 * degrees; summed over pixels, far better. Within a quarter. */
static void deviation_is_honest(void **state)
{
    (void)state;
    enum { SEEDS = 32, SIDE = 8, PIXELS = SIDE * SIDE };
    TestRoom r = { 0 };
    Error    err = { 0 };
    double   sum[PIXELS] = { 0 }, square[PIXELS] = { 0 }, told = 0, found = 0;
    small_scene(&r);
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Image *image = shoot(&r, &(PathOptions){ .width = SIDE, .height = SIDE, .samples = 64,
                                                 .seed = seed, .threads = 1 }, NULL, NULL, &err);
        for (int i = 0; i < PIXELS; i++) {
            const float *p = image->radiance + 3 * i;
            const double y = rgb_luminance(rgb(p[0], p[1], p[2]));
            sum[i] += y;
            square[i] += y * y;
            told += (double)image->deviation[i] * image->deviation[i] / SEEDS;
        }
        image_destroy(image);
    }
    for (int i = 0; i < PIXELS; i++)
        found += (square[i] - sum[i] * sum[i] / SEEDS) / (SEEDS - 1);
    if (!(told > 0.75 * found && told < 1.33 * found))
        fail_msg("variance %g told, %g found", told, found);
    room_clear(&r);
}

static void error_ends_it(void **state)
{
    (void)state;
    TestRoom   r = { 0 };
    Error      err = { 0 };
    PathReport report;
    small_scene(&r);
    Image *image = shoot(&r, &(PathOptions){ .width = 16, .height = 16, .samples = 1 << 16,
                                             .error = 0.2, .threads = 1 }, &report, NULL, &err);
    assert_non_null(image);
    assert_true(report.error > 0 && report.error <= 0.2 && report.samples < 1 << 14);
    image_destroy(image);
    room_clear(&r);
}

static bool stop_soon(void *user) { return ++*(int *)user > 3; }

static void stopping_keeps_what_there_is(void **state)
{
    (void)state;
    TestRoom      r = { 0 };
    Error         err = { 0 };
    int           asked = 0;
    PathReport    report;
    const Monitor monitor = { .user = &asked, .stop = stop_soon };
    small_scene(&r);
    Image *image = shoot(&r, &(PathOptions){ .width = 64, .height = 64, .samples = 4096,
                                             .threads = 1 }, &report, &monitor, &err);
    assert_non_null(image);
    assert_int_equal(err.code, ERROR_STOPPED);
    assert_true(report.samples < 4096);
    assert_true(image->radiance[0] > 0);
    image_destroy(image);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(square_lamps),
        cmocka_unit_test(curved_lamps),
        cmocka_unit_test(lights_without_size),
        cmocka_unit_test(furnaces),
        cmocka_unit_test(glass_in_a_furnace),
        cmocka_unit_test(mirror_doubles_a_lamp),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(deviation_is_honest),
        cmocka_unit_test(error_ends_it),
        cmocka_unit_test(stopping_keeps_what_there_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
