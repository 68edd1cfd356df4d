/* SPDX-License-Identifier: BSD-3-Clause */
/* The final gather against closed forms: lamps, lights, shadows, furnaces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/gather_place.h"

static const double PI = 3.14159265358979323846;

/* --- lamps ----------------------------------------------------------------------------------- */

/* Irradiance under the corner of a rectangle a x b at height c, per radiance; [howell, C-4], times
 * pi. */
static double under_corner(double a, double b, double c)
{
    const double p = sqrt(a * a + c * c), q = sqrt(b * b + c * c);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / 2;
}

/* Lamp [-1,1]^2 at height 1, radiance 3, shining down: seen from (x, y, 0) by signed corners. */
static double under_square(double x, double y, double c)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        const double a = i & 1 ? x + 1 : 1 - x, b = i & 2 ? y + 1 : 1 - y;
        sum += copysign(1, a) * copysign(1, b) * under_corner(fabs(a), fabs(b), c);
    }
    return sum;
}

static void square_lamp(Place *p, double radiance)
{
    add_quad(p, vec3(-1, -1, 1), vec3(0, 2, 0), vec3(2, 0, 0), grey(p, 0, radiance));
}

/* Without shadows the formula itself answers: nothing but rounding is left, and float positions
 * of the lamp, which are exact here. */
static void unshadowed_lamp_is_exact(void **state)
{
    (void)state;
    static const double at[][3] = { { 0, 0, 0 },  { 0.5, -0.3, 0 },  { 3, 2, 0 }, { 50, 20, 0 },
                                    { 0, 0, 0.9 }, { 0.99, 0.99, 0.999 }, { 2, 0, 0.999 } };
    Place p = { 0 };
    square_lamp(&p, 3);
    place_finish(&p, 3, 10);
    for (size_t i = 0; i < sizeof at / sizeof at[0]; i++) {
        const Irradiance e = measure(&p, vec3(at[i][0], at[i][1], at[i][2]), vec3(0, 0, 1), 64);
        const double     exact = 3 * under_square(at[i][0], at[i][1], 1 - at[i][2]);
        assert_true(fabs(e.direct.g - exact) < 1e-8 * (exact + 1e-6));
        assert_true(e.indirect.g == 0);
        assert_true(e.standard_error <= 1e-8 * exact);
    }
    /* From behind and edge on: dark. */
    assert_true(measure(&p, vec3(0, 0, 2), vec3(0, 0, -1), 64).direct.g == 0);
    assert_true(measure(&p, vec3(5, 0, 1), vec3(-1, 0, 0), 64).direct.g == 0);
    place_clear(&p);
}

/* A screen hides the half x < 0 of the lamp from the origin exactly; what is left is two quarters,
 * each seen under its corner. */
static void half_a_lamp_in_shadow(void **state)
{
    (void)state;
    Place p = { 0 };
    square_lamp(&p, 3);
    add_quad(&p, vec3(-2, -2, 0.5), vec3(2, 0, 0), vec3(0, 4, 0), grey(&p, 0, 0));
    place_finish(&p, 3, 10);
    const Irradiance e = measure(&p, vec3(0, 0, 0), vec3(0, 0, 1), 4096);
    const double     exact = 3 * 2 * under_corner(1, 1, 1);
    /* 1024 lamp samples in 8 nets of 128: one edge through a net misplaces at most some
     * sqrt(128) / 2 of its points, 4 % of each net, at random: below 2 % of the mean. */
    assert_true(fabs(e.direct.g - exact) < 4 * e.standard_error + 1e-3 * exact);
    assert_true(e.standard_error < 0.01 * exact);
    /* Deep in the shadow nothing comes, with certainty. */
    assert_true(measure(&p, vec3(-1, 0, 0.45), vec3(0, 0, 1), 64).direct.g == 0);
    place_clear(&p);
}

/* Disc of radius R at height h over the middle: pi L R^2/(R^2 + h^2). Ball of radius R at distance
 * d: pi L (R/d)^2. Curved lamps are sampled, so within four standard errors. */
static void curved_lamps(void **state)
{
    (void)state;
    static const struct {
        ShapeKind kind;
        double    size, height;
    } lamps[] = { { SHAPE_DISC, 1, 1 },      { SHAPE_DISC, 1, 0.1 }, { SHAPE_DISC, 0.1, 3 },
                  { SHAPE_SPHERE, 0.5, 1 },  { SHAPE_SPHERE, 0.9, 1 }, { SHAPE_SPHERE, 0.1, 5 } };
    for (size_t i = 0; i < sizeof lamps / sizeof lamps[0]; i++) {
        Place        p = { 0 };
        const double r = lamps[i].size, h = lamps[i].height;
        add_shape(&p, lamps[i].kind, vec3(0, 0, 0), r, grey(&p, 0, 2));
        place_finish(&p, 3, 40);
        const Irradiance e = measure(&p, vec3(0, 0, h), vec3(0, 0, -1), 8192);
        const double exact = 2 * PI * r * r / (lamps[i].kind == SHAPE_DISC ? r * r + h * h : h * h);
        assert_true(fabs(e.direct.g - exact) < 4 * e.standard_error + 1e-4 * exact);
        assert_true(e.standard_error < 0.01 * exact);
        place_clear(&p);
    }
}

/* The same square cut into 100 lamps of three colours each of which falls to the next: more than
 * are weighed one by one, so a tree chooses and rays that hit lamps count. */
static void many_lamps(void **state)
{
    (void)state;
    Place    p = { 0 };
    uint32_t material[2] = { grey(&p, 0, 2), grey(&p, 0, 4) };
    for (int i = 0; i < 10; i++)
        for (int k = 0; k < 10; k++)
            add_quad(&p, vec3(-1 + 0.2 * i, -1 + 0.2 * k, 1), vec3(0, 0.2, 0), vec3(0.2, 0, 0),
                     material[i >= 5]);
    place_finish(&p, 3, 100);
    const double points[][3] = { { 0, 0, 0 }, { 0, 0, 0.95 } };
    for (int i = 0; i < 2; i++) {
        const double     c = 1 - points[i][2];
        const double     exact = (2 + 4) * 2 * under_corner(1, 1, c);
        const Irradiance e = measure(&p, vec3(0, 0, points[i][2]), vec3(0, 0, 1), 8192);
        assert_true(fabs(e.direct.g - exact) < 4 * e.standard_error + 1e-4 * exact);
        assert_true(e.standard_error < 0.01 * exact);
    }
    place_clear(&p);
}

/* Two lamps of different colour, both weighed: each band by the formula. */
static void coloured_lamps(void **state)
{
    (void)state;
    Place p = { 0 };
    add_quad(&p, vec3(-1, -1, 1), vec3(0, 2, 0), vec3(1, 0, 0),
             add_material(&p, rgb(0, 0, 0), rgb(5, 0, 0)));
    add_quad(&p, vec3(0, -1, 1), vec3(0, 2, 0), vec3(1, 0, 0),
             add_material(&p, rgb(0, 0, 0), rgb(0, 1, 7)));
    place_finish(&p, 3, 10);
    const Irradiance e = measure(&p, vec3(0, 0, 0), vec3(0, 0, 1), 64);
    const double     half = 2 * under_corner(1, 1, 1);
    assert_true(fabs(e.direct.r - 5 * half) < 1e-8);
    assert_true(fabs(e.direct.g - half) < 1e-8);
    assert_true(fabs(e.direct.b - 7 * half) < 1e-8);
    place_clear(&p);
}

/* H = I cos / d^2, and 0 behind a screen; a spot's ramp as in math/light.h. */
static void point_lights(void **state)
{
    (void)state;
    Place p = { 0 };
    p.light[0] = (Light){ .kind = LIGHT_POINT, .position = { 0, 0, 2 }, .intensity = { 8, 4, 2 } };
    p.light[1] = (Light){ .kind = LIGHT_COSINE, .position = { 3, 0, 4 }, .direction = { 0, 0, -1 },
                          .intensity = { 1, 1, 1 } };
    p.light_count = 2;
    add_quad(&p, vec3(1, -1, 1), vec3(1, 0, 0), vec3(0, 2, 0), grey(&p, 0, 0));
    place_finish(&p, 3, 10);
    Irradiance e = measure(&p, vec3(0, 0, 0), vec3(0, 0, 1), 64);
    /* 8 / 2^2, and cos^2 / d^2 = (4/5)^2 / 25; the ray to the second passes x = 0.75 at z = 1 */
    assert_true(fabs(e.direct.r - (2 + 0.0256)) < 1e-12);
    assert_true(fabs(e.direct.b - (0.5 + 0.0256)) < 1e-12);
    assert_true(e.standard_error == 0);
    e = measure(&p, vec3(3, 0, 0), vec3(0, 0, 1), 64); /* the first is behind the screen */
    assert_true(fabs(e.direct.r - 1.0 / 16) < 1e-12);
    place_clear(&p);
}

/* --- closed spaces --------------------------------------------------------------------------- */

/* All walls alike: B = E / (1 - rho) everywhere, and so is the irradiance at each point inside,
 * however it is turned. E of it comes straight from the walls. */
static void furnace_is_constant(void **state)
{
    (void)state;
    static const double rho[] = { 0, 0.5, 0.9 };
    static const Vec3   at[] = { { 0.5, 0.5, 0.5 }, { 0.5, 0.5, 0 }, { 0.01, 0.02, 0 },
                                 { 0.999, 0.3, 0 } };
    for (size_t i = 0; i < sizeof rho / sizeof rho[0]; i++) {
        Place p = { 0 };
        add_room(&p, grey(&p, rho[i], 1));
        place_finish(&p, 1, 150);
        for (size_t k = 0; k < sizeof at / sizeof at[0]; k++) {
            const Irradiance e = measure(&p, at[k], vec3(0, 0, 1), 2048);
            assert_true(fabs(e.direct.g - PI) < 4 * e.standard_error + 1e-5 * PI);
            assert_true(fabs(e.direct.g + e.indirect.g - PI / (1 - rho[i])) <
                        4 * e.standard_error + 1e-5 * PI / (1 - rho[i]));
            assert_true(e.standard_error < 0.01 * PI / (1 - rho[i]));
        }
        place_clear(&p);
    }
}

/* The same in a ball whose inside shines: an integrating sphere. */
static void sphere_is_constant(void **state)
{
    (void)state;
    Place p = { 0 };
    add_shape(&p, SHAPE_SPHERE, vec3(0, 0, 0), 1, grey(&p, 0.8, 1));
    place_finish(&p, 2, 200);
    static const Vec3 at[] = { { 0, 0, 0 }, { 0.3, 0.2, -0.1 }, { 0, 0, -0.999 } };
    for (size_t k = 0; k < sizeof at / sizeof at[0]; k++) {
        const Irradiance e = measure(&p, at[k], vec3(0.1, 0.2, 1), 8192);
        assert_true(fabs(e.direct.g + e.indirect.g - 5 * PI) < 4 * e.standard_error + 5e-3 * PI);
        assert_true(e.standard_error < 0.01 * 5 * PI);
    }
    place_clear(&p);
}

static const Camera inside = { .eye = { 0.3, 0.4, 0.9 }, .target = { 0.6, 0.5, 0 },
                               .up = { 0, 1, 0 }, .vertical_fov = 70 };

/* Each pixel of a furnace shows B / pi: no edge, corner or mesh can be seen. */
static void furnace_looks_empty(void **state)
{
    (void)state;
    Place p = { 0 };
    add_room(&p, grey(&p, 0.7, 1));
    place_finish(&p, 1, 150);
    Image *image =
        picture(&p, &inside, (RenderOptions){ .width = 32, .height = 24, .samples = 16 });
    for (int i = 0; i < 32 * 24; i++) {
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(image->radiance[3 * i + k] * 0.3 - 1) < 1e-3);
            assert_true(fabs(image->irradiance[3 * i + k] * 0.3 / PI - 1) < 1e-3);
            assert_true(fabs(image->albedo[3 * i + k] - 0.7) < 1e-6);
            assert_true(fabs(image->direct[3 * i + k] - 0.7) < 1e-3);
            assert_true(fabs(image->indirect[3 * i + k] - 0.7 * 0.7 / 0.3) < 2e-3);
        }
        assert_true(image->depth[i] > 0.1F && image->depth[i] < 1.8F);
        assert_true(image->patch[i] < p.patches->count);
    }
    image_destroy(image);
    place_clear(&p);
}

static void lamp_room(Place *p)
{
    add_room(p, grey(p, 0.6, 0));
    add_quad(p, vec3(0.3, 0.95, 0.3), vec3(0.4, 0, 0), vec3(0, 0, 0.4), grey(p, 0.2, 5));
    add_shape(p, SHAPE_SPHERE, vec3(0.6, 0.3, 0.3), 0.2, grey(p, 0.5, 0));
    place_finish(p, 3, 200);
}

/* The same bytes from one thread and from two; others from another seed. */
static void threads_change_nothing(void **state)
{
    (void)state;
    Place p = { 0 };
    lamp_room(&p);
    RenderOptions o = { .width = 40, .height = 35, .samples = 4, .threads = 1 };
    Image *a = picture(&p, &inside, o);
    o.threads = 2;
    Image       *b = picture(&p, &inside, o);
    const size_t n = 40 * 35;
    assert_memory_equal(a->radiance, b->radiance, 3 * n * sizeof(float));
    assert_memory_equal(a->direct, b->direct, 3 * n * sizeof(float));
    assert_memory_equal(a->irradiance, b->irradiance, 3 * n * sizeof(float));
    assert_memory_equal(a->depth, b->depth, n * sizeof(float));
    assert_memory_equal(a->patch, b->patch, n * sizeof(uint32_t));
    image_destroy(a);
    image_destroy(b);
    place_clear(&p);
}

/* --- records and as many samples as noise asks for -------------------------------------------- */

static Image *refined(const Place *p, RenderOptions options, double error, RenderReport *report)
{
    Error    err = { 0 };
    Records *records = records_create(&err);
    options.records = records;
    options.error = error;
    Image *image = render_gather(p->gatherer, &inside, &options, report, NULL, &err);
    assert_non_null(image);
    assert_non_null(image->deviation);
    assert_true(records_count(records) > 0);
    records_destroy(records);
    return image;
}

/* A furnace is as flat from records; and four samples a pixel are enough where there is no noise.
 * Planes fitted to equal values are level: only their noise is left. */
static void furnace_from_records(void **state)
{
    (void)state;
    Place p = { 0 };
    RenderReport report;
    add_room(&p, grey(&p, 0.7, 1));
    place_finish(&p, 1, 150);
    Image *image = refined(&p, (RenderOptions){ .width = 32, .height = 24, .samples = 64 }, 0.01,
                           &report);
    for (int i = 0; i < 3 * 32 * 24; i++)
        assert_true(fabs(image->radiance[i] * 0.3 - 1) < 2e-3);
    assert_true(report.error < 2e-3 && report.samples == 4);
    assert_true(report.records_error >= 0 && report.records_error < 2e-3);
    image_destroy(image);
    place_clear(&p);
}

/* Records of a furnace are read in one that is brighter by a tenth: emission 1.1 and reflectance
 * 0.7 give 1.1 / 0.3 in all, 1.1 of it emitted and 0.7 * 1.1 reflected straight from the walls that
 * emit. The rest is read a share 1 / 11 too low, and that is what is told, over the mean of what is
 * shown. Gathers in a furnace are nearly without noise: a twentieth is left to them. */
static void wrong_records_are_told(void **state)
{
    (void)state;
    const double rest = 1.1 / 0.3 - 1.1 - 0.7 * 1.1, lost = rest / 11, shown = 1.1 / 0.3 - lost;
    Error         err = { 0 };
    Records      *records = records_create(&err);
    RenderOptions options = { .width = 32, .height = 24, .samples = 64, .error = 0.01,
                              .records = records };
    RenderReport  report = { 0 };
    Place         one = { 0 }, two = { 0 }, *place[2] = { &one, &two };
    for (int k = 0; k < 2; k++) {
        Place *p = place[k];
        add_room(p, grey(p, 0.7, k == 0 ? 1 : 1.1));
        place_finish(p, 1, 150);
        image_destroy(render_gather(p->gatherer, &inside, &options, &report, NULL, &err));
        assert_false(error_is_set(&err));
    }
    assert_true(fabs(report.records_error / (lost / shown) - 1) < 0.05);
    records_destroy(records);
    place_free(&one);
    place_clear(&two);
}

/* The same bytes from one thread and from two; the error asked for is reached, and the mean is that
 * of a picture gathered pixel by pixel: of 1400 pixels' errors little is left in a mean. */
static void refined_pictures(void **state)
{
    (void)state;
    enum { N = 40 * 35 };
    const double error = 0.02;
    Place        p = { 0 };
    RenderReport report, again;
    lamp_room(&p);
    RenderOptions o = { .width = 40, .height = 35, .samples = 1024, .threads = 1 };
    Image *a = refined(&p, o, error, &report);
    o.threads = 2;
    Image *b = refined(&p, o, error, &again);
    assert_memory_equal(a->radiance, b->radiance, 3 * N * sizeof(float));
    assert_memory_equal(a->indirect, b->indirect, 3 * N * sizeof(float));
    assert_memory_equal(a->deviation, b->deviation, N * sizeof(float));
    assert_true(report.error > 0 && report.error < error && report.error == again.error);
    assert_true(report.samples > 4 && report.samples <= 1024 && report.rays == again.rays);
    image_destroy(b);
    b = picture(&p, &inside, (RenderOptions){ .width = 40, .height = 35, .samples = 64 });
    double one = 0, two = 0;
    for (int i = 0; i < N; i++) {
        one += a->direct[3 * i + 1] + a->indirect[3 * i + 1];
        two += b->direct[3 * i + 1] + b->indirect[3 * i + 1];
    }
    /* Errors of pixels are independent; a record's is shared by about a dozen of them. */
    assert_true(fabs(one / two - 1) < 3 * error / 4);
    image_destroy(a);
    image_destroy(b);
    place_clear(&p);
}

/* Pixels and points tell the same of the same place: a pixel's irradiance layer against
 * gather_irradiance where its centre lies, within what 256 samples may miss. */
static void pixels_agree_with_points(void **state)
{
    (void)state;
    Place p = { 0 };
    lamp_room(&p);
    const Camera narrow = { .eye = { 0.2, 0.5, 0.9 }, .target = { 0.2, 0, 0.6 }, .up = { 0, 0, 1 },
                            .vertical_fov = 0.1 };
    Image *image = picture(&p, &narrow, (RenderOptions){ .width = 3, .height = 3, .samples = 256 });
    const Irradiance e = measure(&p, vec3(0.2, 0, 0.6), vec3(0, 1, 0), 8192);
    const double     exact = e.direct.g + e.indirect.g;
    assert_true(e.standard_error < 0.005 * exact);
    for (int i = 0; i < 9; i++)
        assert_true(fabs(image->irradiance[3 * i] - exact) < 0.02 * exact);
    image_destroy(image);
    place_clear(&p);
}

/* --- failures -------------------------------------------------------------------------------- */

static bool stop_at_once(void *user)
{
    (void)user;
    return true;
}

static void stop_and_lack_of_memory(void **state)
{
    (void)state;
    Place p = { 0 };
    lamp_room(&p);
    const RenderOptions o = { .width = 8, .height = 8, .samples = 1, .threads = 1 };
    const long          live = array_live();
    Error               err = { 0 };
    Image *image = render_gather(p.gatherer, &inside, &o, NULL, &(Monitor){ .stop = stop_at_once },
                                 &err);
    assert_non_null(image);
    assert_int_equal(err.code, ERROR_STOPPED);
    image_destroy(image);
    for (long n = 0;; n++) {
        err = (Error){ 0 };
        array_fail_after(n);
        Gatherer *g = gatherer_create(&p.room, p.solution, p.links, &err);
        image = g != NULL ? render_gather(g, &inside, &o, NULL, NULL, &err) : NULL;
        array_fail_after(-1);
        gatherer_destroy(g);
        if (image != NULL)
            break;
        assert_int_equal(err.code, ERROR_MEMORY);
        assert_int_equal(array_live(), live);
    }
    image_destroy(image);
    place_clear(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unshadowed_lamp_is_exact), cmocka_unit_test(half_a_lamp_in_shadow),
        cmocka_unit_test(curved_lamps),             cmocka_unit_test(many_lamps),
        cmocka_unit_test(coloured_lamps),           cmocka_unit_test(point_lights),
        cmocka_unit_test(furnace_is_constant),      cmocka_unit_test(sphere_is_constant),
        cmocka_unit_test(furnace_looks_empty),      cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(furnace_from_records),     cmocka_unit_test(wrong_records_are_told),
        cmocka_unit_test(refined_pictures),
        cmocka_unit_test(pixels_agree_with_points),
        cmocka_unit_test(stop_and_lack_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
