/* SPDX-License-Identifier: BSD-3-Clause */
/* The gather through mirrors, panes and gloss, against closed forms. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/gather_place.h"

static const double PI = 3.14159265358979323846;

/* --- mirrors and glass ----------------------------------------------------------------------- */

/* A mirror of reflectance 0.8 shows a lamp of radiance 2 as 1.6; a pane of transmittance 0.9
 * without index lets 1.8 through; diffuse_only leaves both black; background by itself. */
static void mirror_and_pane(void **state)
{
    (void)state;
    Place    p = { 0 };
    Material mirror = material_default(), pane = material_default();
    uint32_t m, g;
    mirror.reflectance = pane.reflectance = rgb(0, 0, 0);
    mirror.specular = rgb(0.8, 0.8, 0.8);
    mirror.exponent = INFINITY;
    pane.transmittance = rgb(0.9, 0.9, 0.9);
    pane.ior = 1;
    assert_true(polygons_add_material(&p.soup, &mirror, &m, &p.err));
    assert_true(polygons_add_material(&p.soup, &pane, &g, &p.err));
    add_quad(&p, vec3(-5, -5, 0), vec3(10, 0, 0), vec3(0, 10, 0), m);  /* below, faces up */
    add_quad(&p, vec3(-5, -5, 9), vec3(0, 10, 0), vec3(10, 0, 0), grey(&p, 0, 2)); /* faces down */
    add_quad(&p, vec3(-1, -1, 7), vec3(0, 2, 0), vec3(2, 0, 0), g);
    place_finish(&p, 3, 30);
    const Camera down = { .eye = { 0, 0, 5 }, .target = { 1, 0, 0 }, .up = { 0, 1, 0 },
                          .vertical_fov = 1 };
    const Camera up = { .eye = { 0, 0, 5 }, .target = { 0, 0, 9 }, .up = { 0, 1, 0 },
                        .vertical_fov = 1 };
    const Camera away = { .eye = { 0, 0, 5 }, .target = { 50, 0, 5 }, .up = { 0, 0, 1 },
                          .vertical_fov = 1 };
    RenderOptions o = { .width = 2, .height = 2, .samples = 4, .background = { 0.25, 0.5, 1 } };
    Image *a = picture(&p, &down, o), *b = picture(&p, &up, o), *c = picture(&p, &away, o);
    assert_true(fabs(a->radiance[0] - 1.6) < 1e-6);
    assert_true(fabs(b->radiance[0] - 1.8) < 1e-6);
    assert_true(c->radiance[0] == 0.25F && c->radiance[2] == 1 && isinf(c->depth[0]));
    assert_true(c->patch[0] == PATCH_NONE && c->irradiance[0] == 0);
    image_destroy(a);
    image_destroy(b);
    image_destroy(c);
    o.diffuse_only = true;
    a = picture(&p, &down, o);
    assert_true(a->radiance[0] == 0);
    image_destroy(a);
    place_clear(&p);
}

/* A lobe of exponent e and colour s, seen where it mirrors a light of intensity I at distance d at
 * cosine c: s (e + 2) / 2 pi c I / d^2. Seen straight from above in a room of lamps of radiance L:
 * s L, for (e + 2) / 2 pi times cos^(e + 1) over the hemisphere is 1. */
static void gloss_of_lights_and_lamps(void **state)
{
    (void)state;
    Place    p = { 0 }, q = { 0 };
    Material gloss = material_default();
    uint32_t m;
    gloss.reflectance = rgb(0, 0, 0);
    gloss.specular = rgb(0.5, 0.25, 0.5);
    gloss.exponent = 20;
    assert_true(polygons_add_material(&p.soup, &gloss, &m, &p.err));
    p.light[0] = (Light){ .kind = LIGHT_POINT, .position = { -2, 0, 2 }, .intensity = { 8, 8, 8 } };
    p.light_count = 1;
    add_quad(&p, vec3(-5, -5, 0), vec3(10, 0, 0), vec3(0, 10, 0), m);
    place_finish(&p, 3, 30);
    const Camera  slant = { .eye = { 2, 0, 2 }, .up = { 0, 0, 1 }, .vertical_fov = 0.01 };
    const Camera  down = { .eye = { 0.5, 0.5, 0.9 }, .target = { 0.5, 0.5, 0 }, .up = { 0, 1, 0 },
                           .vertical_fov = 0.01 };
    RenderOptions o = { .width = 1, .height = 1, .samples = 4096 };
    Image        *image = picture(&p, &slant, o);
    const double  seen = 0.5 * 22 / (2 * PI) * sqrt(0.5);
    assert_true(fabs(image->radiance[0] - seen) < 1e-4 * seen);
    assert_true(fabs(image->radiance[1] - seen / 2) < 1e-4 * seen);
    image_destroy(image);
    place_clear(&p);

    assert_true(polygons_add_material(&q.soup, &gloss, &m, &q.err));
    add_room(&q, grey(&q, 0, 2));
    add_quad(&q, vec3(0.1, 0.1, 0.1), vec3(0.8, 0, 0), vec3(0, 0.8, 0), m);
    place_finish(&q, 3, 60);
    image = picture(&q, &down, o);
    /* Balanced by both ways to a lamp no sample counts more than about twice the mean. */
    assert_true(fabs(image->radiance[0] - 1) < 4 * 1 / sqrt(4096));
    image_destroy(image);
    place_clear(&q);
}

/* A room of mirrors that reflect r and shine with L shows L / (1 - r) everywhere, by any number of
 * bounces. A ray's worth is at most that plus L per bounce before roulette. */
static void room_of_mirrors(void **state)
{
    (void)state;
    enum { SAMPLES = 1024 };
    static const double r = 0.9;
    Place    p = { 0 };
    Material mirror = material_default();
    uint32_t m;
    mirror.reflectance = rgb(0, 0, 0);
    mirror.specular = rgb(r, r, r);
    mirror.exponent = INFINITY;
    mirror.emission = rgb(1, 1, 1);
    assert_true(polygons_add_material(&p.soup, &mirror, &m, &p.err));
    add_room(&p, m);
    place_finish(&p, 3, 30);
    const Camera  camera = { .eye = { 0.4, 0.5, 0.6 }, .target = { 1, 0.7, 0.1 },
                             .up = { 0, 0, 1 }, .vertical_fov = 1 };
    const double  seen = 1 / (1 - r);
    RenderOptions o = { .width = 2, .height = 2, .samples = SAMPLES };
    Image        *image = picture(&p, &camera, o);
    double        mean = 0;
    for (int i = 0; i < 4; i++)
        mean += image->radiance[3 * i] / 4;
    assert_true(fabs(mean - seen) < 4 * seen / sqrt(4 * SAMPLES));
    image_destroy(image);
    place_clear(&p);
}

/* Glass that absorbs nothing, in light that is the same from everywhere, cannot be seen: both ways
 * at its skin, and all that go on inside by chance, come to 1. */
static void clear_ball_in_even_light(void **state)
{
    (void)state;
    enum { SAMPLES = 64, SIDE = 8 };
    Place    p = { 0 };
    Material glass = material_default();
    uint32_t m;
    glass.reflectance = rgb(0, 0, 0);
    glass.transmittance = rgb(1, 1, 1);
    glass.ior = 1.5;
    assert_true(polygons_add_material(&p.soup, &glass, &m, &p.err));
    add_shape(&p, SHAPE_SPHERE, vec3(0, 0, 0), 1, m);
    add_quad(&p, vec3(40, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), grey(&p, 0, 1)); /* as bright */
    place_finish(&p, 1, 30);
    const Camera  camera = { .eye = { 0, 0, 3 }, .up = { 0, 1, 0 }, .vertical_fov = 0.6 };
    RenderOptions o = { .width = SIDE, .height = SIDE, .samples = SAMPLES,
                        .background = { 1, 1, 1 } };
    Image        *image = picture(&p, &camera, o);
    double        mean = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        mean += image->radiance[3 * i] / (SIDE * SIDE);
        /* What is left to chance is less than what each fork keeps back, 1/16. */
        assert_true(fabs(image->radiance[3 * i] - 1) < 0.25);
    }
    assert_true(fabs(mean - 1) < 4 * 0.25 / sqrt(SAMPLES * SIDE * SIDE));
    image_destroy(image);
    place_clear(&p);
}

/* --- lamps seen in flat mirrors --------------------------------------------------------------- */

/* Factor from a point to the rectangle (0,0)..(x,y) at height h over it, parallel; odd in x and y
 * (the closed form of every handbook). */
static double corner_factor(double x, double y, double h)
{
    const double a = x / h, b = y / h, p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * PI);
}

static double rectangle_factor(double x0, double x1, double y0, double y1, double h)
{
    return corner_factor(x1, y1, h) - corner_factor(x0, y1, h) - corner_factor(x1, y0, h) +
           corner_factor(x0, y0, h);
}

static const Rgb mirror_colour = { 0.9, 0.6, 0.3 };

/* A mirror in the plane x = 0, y from y0 on, that looks to +x; all else is black. */
static void add_mirror(Place *p, double y0)
{
    Material mirror = material_default();
    uint32_t m;
    mirror.reflectance = rgb(0, 0, 0);
    mirror.specular = mirror_colour;
    mirror.exponent = INFINITY;
    assert_true(polygons_add_material(&p->soup, &mirror, &m, &p->err));
    add_quad(p, vec3(0, y0, 0), vec3(0, 40, 0), vec3(0, 0, 40), m);
}

static void pass_mirrors(Place *p)
{
    gatherer_destroy(p->gatherer);
    p->room.mirrors = true;
    p->gatherer = gatherer_create(&p->room, p->solution, p->links, &p->err);
    assert_non_null(p->gatherer);
}

static void near_colour(Rgb e, double straight, double mirrored, double within)
{
    assert_true(fabs(e.r - straight - mirror_colour.r * mirrored) <= within);
    assert_true(fabs(e.g - straight - mirror_colour.g * mirrored) <= within);
    assert_true(fabs(e.b - straight - mirror_colour.b * mirrored) <= within);
}

/* At (1,0,0) a lamp of radiance 1 at height 2 arrives straight, and once more from its image, in
 * the mirror's colour: all of it, or just its half if the mirror begins at y = 0. Nets of N points
 * are off by about 1/N of what varies; a quarter of the rays go to lamps, in 16 nets. */
static void lamp_in_flat_mirror(void **state)
{
    (void)state;
    const double straight = PI * rectangle_factor(-0.5, 0.5, -0.5, 0.5, 2);
    const double mirrored = PI * rectangle_factor(1.5, 2.5, -0.5, 0.5, 2);
    for (int half = 0; half < 2; half++) {
        Place p = { 0 };
        add_mirror(&p, half > 0 ? 0 : -20);
        add_quad(&p, vec3(0.5, -0.5, 2), vec3(0, 1, 0), vec3(1, 0, 0), grey(&p, 0, 1));
        place_finish(&p, 1, 10);
        pass_mirrors(&p);
        const Irradiance e = measure(&p, vec3(1, 0, 0), vec3(0, 0, 1), 65536);
        assert_true(e.standard_error < 0.01 * straight);
        near_colour(e.direct, straight, half > 0 ? mirrored / 2 : mirrored,
                    4 * e.standard_error + mirrored / 1024);
        assert_true(rgb_max(e.indirect) == 0);
        place_clear(&p);
    }
}

/* A ball of radius R at distance d in the direction c over the horizon: pi (R/d)^2 c. Hemisphere
 * rays that find it, straight or by the mirror, share with lamp rays; none counts twice. */
static void ball_in_flat_mirror(void **state)
{
    (void)state;
    Place p = { 0 };
    add_mirror(&p, -20);
    add_shape(&p, SHAPE_SPHERE, vec3(1, 0, 2), 0.5, grey(&p, 0, 1));
    place_finish(&p, 1, 10);
    pass_mirrors(&p);
    const double     straight = PI * 0.25 / 4;
    const double     mirrored = PI * 0.25 / 8 * sqrt(0.5);
    const Irradiance e = measure(&p, vec3(1, 0, 0), vec3(0, 0, 1), 16384);
    assert_true(e.standard_error < 0.01 * straight);
    near_colour(e.direct, straight, mirrored, 4 * e.standard_error);
    place_clear(&p);
}

/* A point light of intensity I at height 2 over (1,0,0): I / 4 straight, and by the mirror from
 * (-1,0,2) I cos / 8 in its colour; where the mirror begins beyond y = 0.1, none. Measured, and as
 * a floor of reflectance 1/2 shows it over 2 pi, a pixel of 1e-4 wide. */
static void light_in_flat_mirror(void **state)
{
    (void)state;
    static const double intensity = 8, straight = 8 / 4.0;
    for (int beside = 0; beside < 2; beside++) {
        Place        p = { 0 };
        const double mirrored = beside > 0 ? 0 : intensity / 8 * sqrt(0.5);
        p.light[0] = (Light){ .kind = LIGHT_POINT, .position = { 1, 0, 2 },
                              .intensity = { intensity, intensity, intensity } };
        p.light_count = 1;
        add_mirror(&p, beside > 0 ? 0.1 : -20);
        add_quad(&p, vec3(0, -5, 0), vec3(9, 0, 0), vec3(0, 10, 0), grey(&p, 0.5, 0));
        place_finish(&p, 1, 10);
        pass_mirrors(&p);
        near_colour(measure(&p, vec3(1, 0, 0), vec3(0, 0, 1), 1024).direct, straight, mirrored,
                    1e-5);
        const Camera  down = { .eye = { 1, 0, 1 }, .target = { 1, 0, 0 }, .up = { 0, 1, 0 },
                               .vertical_fov = 1e-4 };
        RenderOptions o = { .width = 1, .height = 1, .samples = 4 };
        Image        *image = picture(&p, &down, o);
        const float  *seen = image->direct;
        near_colour(rgb_scale(rgb(seen[0], seen[1], seen[2]), 2 * PI), straight, mirrored, 1e-3);
        o.diffuse_only = true;
        Image *plain = picture(&p, &down, o);
        assert_true(fabs(2 * PI * plain->direct[0] - straight) < 1e-3);
        image_destroy(image);
        image_destroy(plain);
        place_clear(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mirror_and_pane),
        cmocka_unit_test(gloss_of_lights_and_lamps),
        cmocka_unit_test(room_of_mirrors),
        cmocka_unit_test(clear_ball_in_even_light),
        cmocka_unit_test(lamp_in_flat_mirror),
        cmocka_unit_test(ball_in_flat_mirror),
        cmocka_unit_test(light_in_flat_mirror),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
