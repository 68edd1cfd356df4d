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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mirror_and_pane),
        cmocka_unit_test(gloss_of_lights_and_lamps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
