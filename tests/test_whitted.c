/* SPDX-License-Identifier: BSD-3-Clause */
/* Plain ray tracing against closed forms: lights, shadows, highlights, mirrors, glass, depth. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "render/whitted.h"
#include "tests/room_maker.h"

static uint32_t material(TestRoom *r, double diffuse, double specular, double exponent,
                         double transmittance)
{
    Error    err = { 0 };
    uint32_t index = 0;
    Material m = material_default();
    m.reflectance = rgb(diffuse, diffuse, diffuse);
    m.specular = rgb(specular, specular, specular);
    m.exponent = exponent;
    m.transmittance = rgb(transmittance, transmittance, transmittance);
    m.ior = 1.5;
    assert_true(polygons_add_material(&r->soup, &m, &index, &err));
    return index;
}

static void finish(TestRoom *r, const Light *light, size_t lights)
{
    room_connect(r);
    for (uint32_t i = 0; i < r->surfaces->count; i++)
        r->emitting[i] =
            rgb_max(r->soup.materials[r->surfaces->surface[i].material].emission) > 0;
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh, .materials = r->soup.materials,
                      .material_count = r->soup.material_count, .lights = light,
                      .light_count = lights, .sides = r->sides, .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
}

static double look(const TestRoom *r, Vec3 eye, Vec3 at, uint32_t depth)
{
    const Camera camera = { .eye = eye, .target = at, .up = { 0.1, 0.9, 0.3 },
                            .projection = CAMERA_ORTHOGRAPHIC, .view_height = 1e-6 };
    const WhittedOptions o = { .width = 1, .height = 1, .depth = depth, .threads = 1,
                               .background = { 3, 3, 3 }, .ambient = { 0.1, 0.1, 0.1 } };
    Error  err = { 0 };
    Image *image = render_whitted(&r->room, &camera, &o, NULL, NULL, &err);
    assert_non_null(image);
    const double seen = image->radiance[1];
    image_destroy(image);
    return seen;
}

/* Rays are floats: coordinates of a few units are off by some ulps, and what they show as well. */
static void assert_near(double seen, double exact)
{
    if (!(fabs(seen - exact) <= 64 * FLT_EPSILON * exact))
        fail_msg("%.9g is not %.9g", seen, exact);
}

static const Light light = { .kind = LIGHT_POINT, .position = { 0, 0, 2 },
                             .intensity = { 8, 8, 8 } };

/* rho / pi I / d^2 under the light, ambient light alone in the shadow; an area that emits is a
 * small flat source in its middle. */
static void lights_and_shadows(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0), room_material(&r, 0.5, 0),
              "floor");
    room_quad(&r, vec3(1, -1, 1), vec3(1, 0, 0), vec3(0, 2, 0), room_material(&r, 0.5, 0),
              "screen");
    room_quad(&r, vec3(-6.1, -0.1, 1), vec3(0, 0.2, 0), vec3(0.2, 0, 0),
              room_material(&r, 0, 50 * M_PI), "lamp");
    finish(&r, &light, 1);
    /* The lamp of intensity 50 * 0.04 = 2 stands 6 away and 1 up: 2 (1/sqrt 37)^2 / 37. */
    const double far = 2 / 37.0 / 37;
    assert_near(look(&r, vec3(0, 0.2, 0.5), vec3(0, 0, 0), 5), 0.05 + 0.5 / M_PI * (2 + far));
    const double from = 2 / (1 + 81.0) / (1 + 81.0); /* at x = 3, 9 from the lamp */
    assert_near(look(&r, vec3(3, 0.2, 0.5), vec3(3, 0, 0), 5), 0.05 + 0.5 / M_PI * from);
    room_clear(&r);
}

/* A highlight in the mirror direction is (e + 2) / (2 pi) of the specular share; the rest as above.
 */
static void highlight(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0),
              material(&r, 0.4, 0.3, 50, 0), "floor");
    const Light beside = { .kind = LIGHT_POINT, .position = { 2, 0, 2 }, .intensity = { 8, 8, 8 } };
    finish(&r, &beside, 1);
    const double e = 8 / 8.0 * sqrt(0.5); /* 45 degrees, seen from 45 degrees */
    assert_near(look(&r, vec3(-1, 0, 1), vec3(0, 0, 0), 5),
                0.04 + e * (0.4 / M_PI + 0.3 * 52 / (2 * M_PI)));
    room_clear(&r);
}

/* Two mirrors of 0.5 facing each other, one open to the background: each reflection halves it, and
 * the depth ends it. Clear panes without rim of colour show the background by both their ways. */
static void mirrors_and_depth(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t mirror = material(&r, 0, 0.5, INFINITY, 0);
    room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0), mirror, "below");
    room_quad(&r, vec3(-9, -9, 1), vec3(18, 0, 0), vec3(0, 10, 0), mirror, "above");
    finish(&r, NULL, 0);
    /* Seen along 45 degrees: below at y = -0.2, above at 0.8, below at 1.8, and out. */
    assert_near(look(&r, vec3(0, -0.7, 0.5), vec3(0, -0.2, 0), 5), 3 * pow(0.5, 3));
    assert_true(look(&r, vec3(0, -5.5, 0.5), vec3(0, -5, 0), 3) == 0); /* 3 are not enough */
    assert_near(look(&r, vec3(0, -5.5, 0.5), vec3(0, -5, 0), 64), 3 * pow(0.5, 7));
    room_clear(&r);
    room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0), material(&r, 0, 0, 1, 0.8),
              "pane");
    finish(&r, NULL, 0);
    const double back = 0.08 / 1.04; /* both faces at right angles, index 1.5 */
    assert_near(look(&r, vec3(0, 0, 1), vec3(0, 0, 0), 5), 3 * (back + 0.8 * (1 - back)));
    room_clear(&r);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error    err = { 0 };
    room_box(&r, vec3(-1, -1, 0), vec3(1, 1, 1), BOX_ALL, false, material(&r, 0, 0, 1, 0.9), "");
    room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0), material(&r, 0.5, 0.2, 20, 0),
              "floor");
    finish(&r, &light, 1);
    const Camera camera = { .eye = { 3, 2, 3 }, .target = { 0, 0, 0.4 }, .up = { 0, 0, 1 },
                            .vertical_fov = 40 };
    WhittedOptions o = { .width = 50, .height = 37, .threads = 1, .samples = 2 };
    Image *one = render_whitted(&r.room, &camera, &o, NULL, NULL, &err);
    o.threads = 3;
    Image *three = render_whitted(&r.room, &camera, &o, NULL, NULL, &err);
    assert_non_null(one);
    assert_non_null(three);
    assert_memory_equal(one->radiance, three->radiance, 3 * 50 * 37 * sizeof(float));
    image_destroy(one);
    image_destroy(three);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* A plate whose image is clear where x > 0: a light straight above the floor there lights it as if
 * nothing stood between, 0.5 / pi / 4^2 of its intensity and half the ambient light; elsewhere only
 * the latter is left. */
static void light_passes_holes(void **state)
{
    (void)state;
    static const uint8_t pixels[8] = { 255, 255, 255, 255, 255, 255, 255, 0 };
    const Vec3   corner[3] = { { -2, 2, 2 }, { 2, 2, 2 }, { -2, 2, -2 } };
    const double uv[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
    Textures textures = { 0 };
    Texture  texture;
    FaceMap  map;
    uint32_t index;
    double   misfit;
    Error    err = { 0 };
    TestRoom r = { 0 };
    const Light lamp[2] = {
        { .kind = LIGHT_POINT, .position = { 1, 4, 0 }, .intensity = { 16, 16, 16 } },
        { .kind = LIGHT_POINT, .position = { -1, 4, 0 }, .intensity = { 16, 16, 16 } } };
    uint8_t *copy = array_create(8, 1, "texture", &err);
    memcpy(copy, pixels, 8);
    assert_true(texture_make(&texture, "half", 2, 1, copy, NULL, &err));
    texture.wrap = WRAP_CLAMP;
    assert_true(textures_add(&textures, &texture, &index, &err));
    const uint32_t floor = material(&r, 0.5, 0, 0, 0), plate = material(&r, 0.5, 0, 0, 0);
    r.soup.materials[plate].texture = index + 1;
    r.soup.materials[plate].cut_out = true;
    room_quad(&r, vec3(-2, 2, 2), vec3(4, 0, 0), vec3(0, 0, -4), plate, "plate");
    room_quad(&r, vec3(-9, 0, 9), vec3(18, 0, 0), vec3(0, 0, -18), floor, "floor");
    assert_true(face_map_fit(&map, corner, uv, 3, &misfit));
    assert_true(textures_set_map(&textures, 0, &map, &err));
    finish(&r, lamp, 1);
    r.room.textures = &textures;
    for (int k = 0; k < 2; k++) {
        const double x = lamp[k].position.x;
        r.room.lights = &lamp[k];
        assert_near(look(&r, vec3(x, 1, 0), vec3(x, 0, 0), 5), 0.05 + (k == 0 ? 0.5 / M_PI : 0));
    }
    textures_clear(&textures);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lights_and_shadows),
        cmocka_unit_test(highlight),
        cmocka_unit_test(mirrors_and_depth),
        cmocka_unit_test(light_passes_holes),
        cmocka_unit_test(threads_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
