/* SPDX-License-Identifier: BSD-3-Clause */
/* Light that comes by two mirrors, off photons, against the closed form; what is not theirs. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/caustics.h"
#include "render/wave.h"
#include "tests/gather_place.h"

static const double INTENSITY = 10;

/* A floor, a light over it, and mirrors of reflectance 0.8 along the y axis and, when there are
 * two, along the x axis as well. */
static void corner_of_mirrors(Place *p, int mirrors)
{
    Material m = material_default();
    uint32_t mirror;
    m.reflectance = rgb(0, 0, 0);
    m.specular = rgb(0.8, 0.8, 0.8);
    m.exponent = INFINITY;
    assert_true(polygons_add_material(&p->soup, &m, &mirror, &p->err));
    add_quad(p, vec3(0, 0, 0), vec3(4, 0, 0), vec3(0, 4, 0), grey(p, 0.5, 0));
    add_quad(p, vec3(0, 0, 0), vec3(0, 4, 0), vec3(0, 0, 4), mirror);
    if (mirrors > 1)
        add_quad(p, vec3(0, 0, 0), vec3(0, 0, 4), vec3(4, 0, 0), mirror);
    p->light[0] = (Light){ .kind = LIGHT_POINT, .position = { 1, 1, 1 },
                           .intensity = { INTENSITY, INTENSITY, INTENSITY } };
    p->light_count = 1;
    place_finish(p, 1, 10);
    gatherer_destroy(p->gatherer);
    p->room.mirrors = true;
    p->gatherer = gatherer_create(&p->room, p->solution, p->links, &p->err);
    assert_non_null(p->gatherer);
}

static Caustics *photons_of(Place *p, unsigned threads)
{
    uint64_t           rays = 0;
    const CausticsWish wish = { .photons = 1 << 18, .seed = 7, .threads = threads };
    Caustics *caustics = caustics_create(p->gatherer, &wish, &rays, NULL, &p->err);
    assert_false(error_is_set(&p->err));
    assert_true(rays >= wish.photons);
    return caustics;
}

/* By both mirrors in either order light comes from the image (-1,-1,1): I 0.8^2 h / d^3. Images in
 * one mirror are aimed at by lamp rays, and no photons. Of so many points each a mean over some 60
 * photons, most of them its own: 2 % or less is noise, and curvature over the circle far less. */
static void light_by_two_mirrors(void **state)
{
    (void)state;
    Place     p = { 0 };
    corner_of_mirrors(&p, 2);
    Caustics *caustics = photons_of(&p, 1);
    double    found = 0, exact = 0;
    assert_non_null(caustics);
    for (int i = 0; i < 12; i++)
        for (int k = 0; k < 12; k++) {
            const Receiver at = { .point = { 0.5 + 0.25 * i, 0.5 + 0.25 * k, 0 },
                                  .normal = { 0, 0, 1 }, .face = { 0, 0, 1 } };
            const double   x = at.point.x + 1, y = at.point.y + 1, dd = x * x + y * y + 1;
            const CausticsLight light = caustics_find(caustics, &at, NULL);
            assert_true(light.radius > 0 && light.radius < 0.25);
            found += light.irradiance.g;
            exact += INTENSITY * 0.64 / (dd * sqrt(dd));
        }
    assert_true(fabs(found - exact) < 0.04 * exact);
    caustics_destroy(caustics);
    place_clear(&p);
}

/* The same light at the same place for any number of threads. */
static void threads_change_no_photon(void **state)
{
    (void)state;
    Place          p = { 0 };
    const Receiver at = { .point = { 1.3, 0.7, 0 }, .normal = { 0, 0, 1 }, .face = { 0, 0, 1 } };
    corner_of_mirrors(&p, 2);
    Caustics *one = photons_of(&p, 1), *three = photons_of(&p, 3);
    const CausticsLight a = caustics_find(one, &at, NULL), b = caustics_find(three, &at, NULL);
    assert_memory_equal(&a, &b, sizeof a);
    caustics_destroy(one);
    caustics_destroy(three);
    place_clear(&p);
}

/* What one flat mirror throws is found by lamp rays: there is nothing for photons to do. */
static void one_mirror_needs_none(void **state)
{
    (void)state;
    Place p = { 0 };
    corner_of_mirrors(&p, 1);
    assert_null(photons_of(&p, 1));
    place_clear(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_by_two_mirrors),
        cmocka_unit_test(threads_change_no_photon),
        cmocka_unit_test(one_mirror_needs_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
