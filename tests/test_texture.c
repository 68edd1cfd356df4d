/* SPDX-License-Identifier: BSD-3-Clause */
/* Image textures: looking up, means over areas, maps from places to (u, v), files. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "scenes/scene.h"
#include "scenes/texture_read.h"

static Texture of_bytes(int width, int height, const uint8_t *rgba)
{
    Error    err = { 0 };
    Texture  t;
    uint8_t *copy = array_create(4 * (size_t)width * (size_t)height, 1, "texture", &err);
    memcpy(copy, rgba, 4 * (size_t)width * (size_t)height);
    assert_true(texture_make(&t, "bytes", width, height, copy, NULL, &err));
    return t;
}

/* Upper row black, white; lower row grey 188 (0.5029 linear), clear. */
static const uint8_t four[16] = { 0, 0, 0, 255,       255, 255, 255, 255,
                                  188, 188, 188, 255, 255, 0, 0, 0 };

static void texels_are_where_they_should_be(void **state)
{
    (void)state;
    Texture t = of_bytes(2, 2, four);
    double  alpha;
    assert_true(t.clear);
    assert_true(texture_at(&t, 0.25, 0.75, &alpha).g == 0 && alpha == 1);
    assert_true(fabs(texture_at(&t, 0.75, 0.75, NULL).g - 1) < 1e-6);
    assert_true(fabs(texture_at(&t, 0.25, 0.25, NULL).g - 0.502886) < 1e-5);
    texture_at(&t, 0.75, 0.25, &alpha);
    assert_true(alpha == 0);
    /* Half way between black and white, and around the edge again. */
    assert_true(fabs(texture_at(&t, 0.5, 0.75, NULL).g - 0.5) < 1e-6);
    assert_true(fabs(texture_at(&t, 3.0, -4.25, NULL).g - 0.5) < 1e-6);
    t.wrap = WRAP_CLAMP;
    assert_true(fabs(texture_at(&t, 7, 0.75, NULL).g - 1) < 1e-6);
    t.wrap = WRAP_MIRROR; /* 1.25 shows 0.75 */
    assert_true(fabs(texture_at(&t, 1.25, 0.75, NULL).g - 1) < 1e-6);
    texture_clear(&t);
}

/* Means keep the light: of any size, odd ones too, the last copy is the mean of all texels, those
 * that are clear left out. */
static void means_are_of_all_texels(void **state)
{
    (void)state;
    static const int sizes[][2] = { { 2, 2 }, { 7, 5 }, { 64, 1 }, { 13, 32 } };
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const int w = sizes[k][0], h = sizes[k][1];
        Error     err = { 0 };
        float    *values = array_create(4 * (size_t)w * (size_t)h, sizeof *values, "t", &err);
        double    sum = 0, opaque = 0, alpha;
        for (int i = 0; i < w * h; i++) {
            values[4 * i] = (float)((i * 37) % 101) / 25;
            values[4 * i + 3] = i % 3 == 0 ? 0.25F : 1;
            sum += (double)(values[4 * i] * values[4 * i + 3]);
            opaque += (double)values[4 * i + 3];
        }
        Texture t;
        assert_true(texture_make(&t, "floats", w, h, NULL, values, &err));
        const Rgb mean = texture_mean_at(&t, 0.5, 0.5, 1, &alpha);
        assert_true(fabs(mean.r - sum / opaque) < 1e-5 * mean.r);
        assert_true(fabs(alpha - opaque / (w * h)) < 1e-5);
        texture_clear(&t);
    }
}

/* A parallelogram has one map; a bent quad tells how far it is off; a line has none. */
static void maps_fit_faces(void **state)
{
    (void)state;
    const Vec3   p[4] = { { 1, 2, 3 }, { 3, 2, 4 }, { 3, 5, 5 }, { 1, 5, 4 } };
    const double uv[4][2] = { { 0, 0 }, { 2, 0 }, { 2, 3 }, { 0, 3 } };
    const double bent[4][2] = { { 0, 0 }, { 2, 0 }, { 2.5, 3 }, { 0, 3 } };
    const Vec3   line[3] = { { 0, 0, 0 }, { 1, 1, 1 }, { 2, 2, 2 } };
    FaceMap      map;
    double       misfit;
    assert_true(face_map_fit(&map, p, uv, 4, &misfit) && misfit < 1e-12);
    const Vec3 middle = { 2, 3.5, 4 };
    assert_true(fabs(face_map_u(&map, middle) - 1) < 1e-12);
    assert_true(fabs(face_map_v(&map, middle) - 1.5) < 1e-12);
    face_map_move(&map, vec3(10, 20, 30));
    assert_true(fabs(face_map_u(&map, vec3(-8, -16.5, -26)) - 1) < 1e-12);
    assert_true(face_map_fit(&map, p, bent, 4, &misfit) && misfit > 0.2);
    assert_false(face_map_fit(&map, line, uv, 3, &misfit));
}

static void write_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

static void write_file(const char *path, const char *text)
{
    write_bytes(path, text, strlen(text));
}

/* A floor with an image of two colours, a wall that is cut out, a missing and a broken image: the
 * scene has what can be had, and says what cannot. */
static void scenes_bring_their_images(void **state)
{
    (void)state;
    char folder[] = "/tmp/texture-XXXXXX", path[128];
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    write_bytes("two colours.ppm", "P6 2 1 255\n\xff\0\0\0\0\xff", 17);
    write_file("bad.png", "\x89PNG not really");
    write_bytes("hole.pgm", "P5 2 2 255\n\0\xff\xff\xff", 15);
    write_file("s.mtl", "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd -s 2 1 1 -clamp off two colours.ppm\n"
                        "newmtl b\nKd 0.4 0.4 0.4\nmap_Kd bad.png\nnewmtl c\nKd 0.3 0.3 0.3\n"
                        "map_Kd gone.png\nnewmtl d\nmap_d hole.pgm\n");
    write_file("s.obj", "mtllib s.mtl\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
                        "vt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\nusemtl b\nf 1/1 2/2 3/3\n"
                        "usemtl c\nf 1/1 2/2 3/3\nusemtl d\nf -4/-4 -3/-3 -2/-2 -1/-1\n");
    snprintf(path, sizeof path, "%s/s.obj", folder);
    Error  err = { 0 };
    Scene *scene = scene_read(path, NULL, &err);
    assert_non_null(scene);
    assert_int_equal(scene->textures.count, 2);
    const Polygons *soup = &scene->polygons;
    const Material *m = &soup->materials[soup->material[0]];
    const FaceMap  *map = textures_map(&scene->textures, 0);
    assert_non_null(map);
    const Texture *t = &scene->textures.texture[m->texture - 1];
    /* -s 2: the image stands twice along x; blue from 1 to 2, red from 2 to 3. */
    for (int k = 0; k < 4; k++) {
        const Vec3 at = { k + 0.5, 1, 0 };
        const Rgb  c = texture_at(t, face_map_u(map, at), face_map_v(map, at), NULL);
        assert_true(k % 2 == 0 ? c.r > 0.99 && c.b < 0.01 : c.b > 0.99 && c.r < 0.01);
    }
    assert_int_equal(soup->materials[soup->material[1]].texture, 0);
    assert_int_equal(soup->materials[soup->material[2]].texture, 0);
    assert_true(soup->materials[soup->material[3]].cut_out);
    assert_null(textures_map(&scene->textures, 1));
    scene_destroy(scene);
    assert_int_equal(chdir("/"), 0);
    static const char *const names[] = { "two colours.ppm", "bad.png", "hole.pgm", "s.mtl",
                                         "s.obj" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        unlink(path);
    }
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_are_where_they_should_be),
        cmocka_unit_test(means_are_of_all_texels),
        cmocka_unit_test(maps_fit_faces),
        cmocka_unit_test(scenes_bring_their_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
