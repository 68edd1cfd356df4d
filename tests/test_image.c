/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures: EXR out and in, PNG bytes of known greys, tone curve, exposure, camera rays. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "base/file.h"
#include "render/internal.h"

typedef struct {
    char folder[64], path[128];
} Scratch;

static const char *scratch_path(Scratch *s, const char *name)
{
    snprintf(s->path, sizeof s->path, "%s/%s", s->folder, name);
    return s->path;
}

static int setup(void **state)
{
    Scratch    *s = calloc(1, sizeof *s);
    const char *base = getenv("TMPDIR");
    snprintf(s->folder, sizeof s->folder, "%s/test_image.XXXXXX",
             base != NULL && strlen(base) < 32 ? base : P_tmpdir);
    if (mkdtemp(s->folder) == NULL)
        return -1;
    *state = s;
    return 0;
}

static int teardown(void **state)
{
    static const char *const names[] = { "a.exr", "b.exr", "c.exr", "a.png", "b.png" };
    Scratch *s = *state;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        unlink(scratch_path(s, names[i]));
    rmdir(s->folder);
    free(s);
    return 0;
}

static const ImageInfo info = { .eye = { 1, 2, 3 }, .target = { 4, 5, 6 }, .up = { 0, 1, 0 },
                                .vertical_fov = 40, .exposure = -1.5, .units = "photometric",
                                .version = "0.1.0", .scene = "box.obj",
                                .command = "isolux render box.obj", .scene_hash = 0xabcdef };

/* A picture in which each value is different and tells where it belongs. */
static Image *numbered(int width, int height)
{
    Error  err = { 0 };
    Image *image = image_create(width, height, &err);
    assert_non_null(image);
    for (int i = 0; i < 3 * width * height; i++) {
        image->radiance[i] = 0.5F + (float)i;
        image->direct[i] = 1000.25F + (float)i;
        image->normal[i] = -(float)i;
    }
    for (int i = 0; i < width * height; i++)
        image->patch[i] = 0x80000000U + (uint32_t)i;
    image->depth[0] = NAN;
    return image;
}

/* Sizes around the 16 lines of a ZIP chunk, and what only floats can say. */
static void exr_comes_back(void **state)
{
    static const int sizes[][2] = { { 1, 1 }, { 3, 5 }, { 17, 16 }, { 5, 33 }, { 64, 1 } };
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        Error  err = { 0 };
        Image *image = numbered(sizes[i][0], sizes[i][1]);
        image->radiance[0] = INFINITY;
        image->radiance[1] = NAN;
        image->radiance[2] = -0.0F;
        const char *path = scratch_path(*state, "a.exr");
        assert_true(image_write_exr(image, &info, path, &err));
        int    w = 0, h = 0;
        float *back = image_read_exr(path, &w, &h, &err);
        assert_non_null(back);
        assert_int_equal(w, sizes[i][0]);
        assert_int_equal(h, sizes[i][1]);
        assert_memory_equal(back, image->radiance, 3 * sizeof(float) * (size_t)(w * h));
        array_free(back);
        image_destroy(image);
        assert_int_equal(array_live(), 0);
    }
}

static int find_bytes(const char *bytes, size_t size, const void *wanted, size_t length)
{
    for (size_t i = 0; i + length <= size; i++)
        if (memcmp(bytes + i, wanted, length) == 0)
            return (int)i;
    return -1;
}

/* The layer of errors is there when it was asked for, and not otherwise. */
static void exr_holds_the_deviation(void **state)
{
    Error  err = { 0 };
    size_t size = 0;
    Image *image = numbered(7, 4);
    assert_null(image->deviation);
    assert_true(image_write_exr(image, &info, scratch_path(*state, "a.exr"), &err));
    char *plain = file_read(scratch_path(*state, "a.exr"), 1 << 20, &size, &err);
    assert_true(find_bytes(plain, size, "deviation.Y", 12) < 0);
    array_free(plain);
    assert_true(image_add_deviation(image, &err) && image_add_deviation(image, &err));
    assert_true(image->deviation[7 * 4 - 1] == 0);
    image->deviation[5] = 3;
    assert_true(image_write_exr(image, &info, scratch_path(*state, "a.exr"), &err));
    char *with = file_read(scratch_path(*state, "a.exr"), 1 << 20, &size, &err);
    /* After depth.Z, of floats. */
    assert_true(find_bytes(with, size, "deviation.Y\0\x02", 13) > 0);
    array_free(with);
    image_destroy(image);
    assert_false(error_is_set(&err));
}

/* The header, byte for byte where the format's own description fixes it: magic number, version 2,
 * the names of the channels in alphabetical order, the attributes; and the same file twice. */
static void exr_header_is_the_formats(void **state)
{
    static const char *const order[] = {
        "B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "depth.Z", "direct.B", "direct.G",
        "direct.R", "indirect.B", "indirect.G", "indirect.R", "irradiance.B", "irradiance.G",
        "irradiance.R", "normal.X", "normal.Y", "normal.Z", "patch.ID" };
    Error  err = { 0 };
    Image *image = numbered(7, 4);
    assert_true(image_write_exr(image, &info, scratch_path(*state, "a.exr"), &err));
    size_t size = 0, size2 = 0;
    char  *a = file_read(scratch_path(*state, "a.exr"), 1 << 20, &size, &err);
    assert_true(image_write_exr(image, &info, scratch_path(*state, "b.exr"), &err));
    char *b = file_read(scratch_path(*state, "b.exr"), 1 << 20, &size2, &err);
    assert_non_null(a);
    assert_non_null(b);
    assert_int_equal(size, size2);
    assert_memory_equal(a, b, size);
    assert_memory_equal(a, "\x76\x2f\x31\x01\x02\0\0\0", 8);
    int last = find_bytes(a, size, "channels\0chlist", 16);
    assert_true(last > 0);
    last += 16 + 4 - 1; /* size of the attribute; then the first name */
    for (size_t i = 0; i < sizeof order / sizeof order[0]; i++) {
        /* a channel: name, type (0 uint, 2 float), linear flag and 3 reserved, samplings 1, 1 */
        assert_string_equal(a + last + 1, order[i]);
        const size_t length = strlen(order[i]) + 1;
        assert_int_equal(a[last + 1 + (int)length], strcmp(order[i], "patch.ID") == 0 ? 0 : 2);
        last += (int)length + 16;
    }
    assert_true(find_bytes(a, size, "isolux.cameraEye\0v3f\0\x0c\0\0\0\0\0\x80\x3f", 29) > 0);
    assert_true(find_bytes(a, size, "isolux.sceneHash\0string\0\x10\0\0\0" "0000000000abcdef", 44) >
                0);
    assert_true(find_bytes(a, size, "photometric", 11) > 0);
    array_free(a);
    array_free(b);
    image_destroy(image);
}

static void put(FILE *f, const void *bytes, size_t size)
{
    assert_int_equal(fwrite(bytes, 1, size, f), size);
}

static void put_int(FILE *f, uint32_t v)
{
    const uint8_t bytes[4] = { (uint8_t)v, (uint8_t)(v >> 8), (uint8_t)(v >> 16),
                               (uint8_t)(v >> 24) };
    put(f, bytes, 4);
}

static void put_attribute(FILE *f, const char *name, const char *type, uint32_t size)
{
    put(f, name, strlen(name) + 1);
    put(f, type, strlen(type) + 1);
    put_int(f, size);
}

/* A file put together by hand from the format's description: 2 x 1 pixels, half, uncompressed,
 * tiled or not, data window away from the origin. Half 0x3c00 is 1, 0x4000 is 2 ... */
static void write_half_file(const char *path, bool tiled)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    put_int(f, 20000630);
    put_int(f, tiled ? 0x202 : 2);
    put_attribute(f, "channels", "chlist", 3 * 18 + 1);
    for (int k = 0; k < 3; k++) {
        const char name[2] = { "BGR"[k], '\0' };
        put(f, name, 2);
        put_int(f, 1);
        put_int(f, 0);
        put_int(f, 1);
        put_int(f, 1);
    }
    put(f, "", 1);
    put_attribute(f, "compression", "compression", 1);
    put(f, "", 1);
    for (int k = 0; k < 2; k++) {
        put_attribute(f, k ? "displayWindow" : "dataWindow", "box2i", 16);
        put_int(f, 10);
        put_int(f, 20);
        put_int(f, 11);
        put_int(f, 20);
    }
    put_attribute(f, "lineOrder", "lineOrder", 1);
    put(f, "", 1);
    put_attribute(f, "pixelAspectRatio", "float", 4);
    put_int(f, 0x3f800000);
    put_attribute(f, "screenWindowCenter", "v2f", 8);
    put_int(f, 0);
    put_int(f, 0);
    put_attribute(f, "screenWindowWidth", "float", 4);
    put_int(f, 0x3f800000);
    if (tiled) {
        put_attribute(f, "tiles", "tiledesc", 9);
        put_int(f, 2);
        put_int(f, 2);
        put(f, "", 1);
    }
    put(f, "", 1);
    put_int(f, (uint32_t)ftell(f) + 8);
    put_int(f, 0);
    if (tiled) {
        put_int(f, 0); /* tile x, y, level x, y */
        put_int(f, 0);
        put_int(f, 0);
        put_int(f, 0);
    } else {
        put_int(f, 20); /* y */
    }
    put_int(f, 12);
    put_int(f, 0x40003c00); /* B 1 2, G 3 4, R 0.5 -1 */
    put_int(f, 0x44004200);
    put_int(f, 0xbc003800);
    assert_int_equal(fclose(f), 0);
}

static void exr_half_files_are_read(void **state)
{
    static const float expected[6] = { 0.5F, 3, 1, -1, 4, 2 };
    for (int tiled = 0; tiled < 2; tiled++) {
        const char *path = scratch_path(*state, "c.exr");
        write_half_file(path, tiled);
        Error  err = { 0 };
        int    w = 0, h = 0;
        float *rgb = image_read_exr(path, &w, &h, &err);
        assert_string_equal(err.text, "");
        assert_int_equal(w, 2);
        assert_int_equal(h, 1);
        assert_memory_equal(rgb, expected, sizeof expected);
        array_free(rgb);
    }
}

/* Every file cut short and every byte damaged: an error or a picture, and nothing leaks. */
static void exr_damage_is_an_error(void **state)
{
    const char *path = scratch_path(*state, "c.exr");
    Error       err = { 0 };
    size_t      size = 0;
    write_half_file(path, false);
    char *good = file_read(path, 1 << 20, &size, &err);
    assert_non_null(good);
    for (size_t cut = 0; cut < 2 * size; cut++) {
        FILE *f = fopen(path, "wb");
        assert_non_null(f);
        if (cut < size) {
            put(f, good, cut);
        } else {
            good[cut - size] ^= (char)0xff;
            put(f, good, size);
            good[cut - size] ^= (char)0xff;
        }
        fclose(f);
        err = (Error){ 0 };
        int    w, h;
        float *rgb = image_read_exr(path, &w, &h, &err);
        if (cut < size)
            assert_null(rgb);
        if (rgb == NULL) {
            assert_int_equal(err.code, ERROR_INPUT);
            assert_non_null(strstr(err.text, "c.exr"));
        }
        array_free(rgb);
    }
    array_free(good);
    err = (Error){ 0 };
    int w, h;
    assert_null(image_read_exr("/nonexistent/x.exr", &w, &h, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_int_equal(array_live(), 0);
}

/* sRGB bytes of linear greys below the curve's knee, from IEC 61966-2-1; dither moves them by at
 * most one step. */
static void png_holds_known_greys(void **state)
{
    static const struct {
        float  linear;
        double byte;
    } greys[] = { { 0, 0 }, { 0.002F, 6.5892 }, { 0.0331F, 50.99610 }, { 0.18F, 117.64581 },
                  { 0.25F, 136.96018 } };
    for (size_t i = 0; i < sizeof greys / sizeof greys[0]; i++) {
        Error  err = { 0 };
        Image *image = image_create(16, 8, &err);
        for (int k = 0; k < 3 * 16 * 8; k++)
            image->radiance[k] = greys[i].linear / 4; /* and exposed by 2 EV */
        assert_true(image_write_png(image, &(ImageTone){ .exposure = 2 }, &info,
                                    scratch_path(*state, "a.png"), &err));
        image_destroy(image);
        png_image png = { .version = PNG_IMAGE_VERSION };
        assert_true(png_image_begin_read_from_file(&png, scratch_path(*state, "a.png")));
        assert_int_equal(png.width, 16);
        assert_int_equal(png.height, 8);
        png.format = PNG_FORMAT_RGB;
        uint8_t pixels[3 * 16 * 8];
        assert_true(png_image_finish_read(&png, NULL, pixels, 0, NULL));
        double mean = 0;
        for (size_t k = 0; k < sizeof pixels; k++) {
            assert_true(fabs(pixels[k] - greys[i].byte) < 1.01);
            mean += pixels[k] / (double)sizeof pixels;
        }
        /* 64 thresholds: the mean is within half a threshold's step, 1/128, of the value. */
        assert_true(fabs(mean - greys[i].byte) < 1.0 / 128 + 1e-3);
    }
}

static void png_says_how_it_was_made(void **state)
{
    Error  err = { 0 };
    size_t size = 0, size2 = 0;
    Image *image = numbered(3, 5);
    const ImageTone tone = { .exposure = -1.5 };
    assert_true(image_write_png(image, &tone, &info, scratch_path(*state, "a.png"), &err));
    assert_true(image_write_png(image, &tone, &info, scratch_path(*state, "b.png"), &err));
    char *a = file_read(scratch_path(*state, "a.png"), 1 << 20, &size, &err);
    char *b = file_read(scratch_path(*state, "b.png"), 1 << 20, &size2, &err);
    assert_non_null(a);
    assert_non_null(b);
    assert_int_equal(size, size2);
    assert_memory_equal(a, b, size);
    assert_memory_equal(a, "\x89PNG\r\n\x1a\n", 8);
    assert_true(find_bytes(a, size, "tEXtSoftware\0isolux 0.1.0", 25) > 0);
    assert_true(find_bytes(a, size, "tEXtExposure\0-1.5 EV", 20) > 0);
    assert_true(find_bytes(a, size, "tEXtUnits\0photometric", 21) > 0);
    assert_true(find_bytes(a, size, "sRGB", 4) > 0);
    assert_true(find_bytes(a, size, "tIME", 4) < 0);
    array_free(a);
    array_free(b);
    image_destroy(image);
}

/* Straight to 0.25, then rising, below 1, without a kink: the slope on both sides of the knee. */
static void curve_has_a_soft_shoulder(void **state)
{
    (void)state;
    assert_true(tonemap_curve(0.18) == 0.18);
    assert_true(tonemap_curve(0.25) == 0.25);
    assert_true(tonemap_curve(NAN) == 0);
    assert_true(tonemap_curve(-1) == 0);
    assert_true(tonemap_curve(INFINITY) == 1);
    /* 0.25 + 0.75 (1 - e^-1) */
    assert_true(fabs(tonemap_curve(1) - 0.724090419) < 1e-9);
    const double h = 1e-6;
    assert_true(fabs((tonemap_curve(0.25 + h) - 0.25) / h - 1) < h);
    for (double v = 0; v < 5; v += 0.01)
        assert_true(tonemap_curve(v + 0.01) > tonemap_curve(v) && tonemap_curve(v) < 1);
}

/* Values worked out by hand from the published formulas; and what each curve must do with greys,
 * whites and garbage. */
static void curves_are_those_published(void **state)
{
    (void)state;
    static const ToneCurve all[] = { TONE_SHOULDER, TONE_LINEAR, TONE_REINHARD, TONE_FILMIC };
    assert_true(tonemap_by(TONE_LINEAR, 0.6) == 0.6 && tonemap_by(TONE_LINEAR, 1.5) == 1);
    assert_true(fabs(tonemap_by(TONE_REINHARD, 1) - 17.0 / 32) < 1e-12);
    assert_true(fabs(tonemap_by(TONE_REINHARD, 4) - 1) < 1e-12);
    assert_true(fabs(tonemap_by(TONE_FILMIC, 0.18) - 0.18) < 1e-12);
    for (size_t c = 0; c < sizeof all / sizeof *all; c++) {
        double before = 0;
        assert_true(tonemap_by(all[c], NAN) == 0 && tonemap_by(all[c], -1) == 0);
        assert_true(tonemap_by(all[c], INFINITY) == 1);
        for (double v = 0.001; v < 100; v *= 1.1) {
            const double y = tonemap_by(all[c], v);
            assert_true(y >= before && y <= 1);
            before = y;
        }
    }
}

/* Half the picture 0.09, half 0.36, one lamp: the log-average is 0.18, so 0 EV. */
static void exposure_leaves_lamps_out(void **state)
{
    (void)state;
    static const struct {
        float  dark, bright, lamp;
        double ev;
    } cases[] = {
        { 0.09F, 0.36F, 0, 0 },        { 0.09F, 0.36F, 1e6F, 0 }, { 0.09F, 0.36F, 0.5F, 0 },
        { 0.045F, 0.18F, 1e6F, 1 },    { 90, 360, 1e9F, -9.965784284662087 }, { 0, 0, 0, 0 },
        { 0, 0, 0.36F, -1 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        Error  err = { 0 };
        Image *image = image_create(21, 1, &err);
        for (int k = 0; k < 60; k++)
            image->radiance[k] = image->direct[k] = k < 30 ? cases[i].dark : cases[i].bright;
        for (int k = 60; k < 63; k++)
            image->radiance[k] = cases[i].lamp;
        /* float input, a log and an exp in double: well below a thousandth of a stop */
        assert_true(fabs(image_auto_exposure(image) - cases[i].ev) < 1e-5);
        image_destroy(image);
    }
}

static Vec3 direction_at(const CameraRays *rays, double x, double y)
{
    Vec3 origin, direction;
    assert_true(camera_rays_at(rays, x, y, NULL, &origin, &direction));
    return direction;
}

static double apart(Vec3 a, Vec3 b) { return vec3_length(vec3_sub(a, b)); }

/* A field of view of 90 degrees upright: the picture's upper edge is 45 degrees up, and the sides
 * follow the number of pixels. */
static void camera_sees_its_field(void **state)
{
    (void)state;
    const Camera camera = { .eye = { 1, 2, 3 }, .target = { 1, 2, -7 }, .up = { 0, 5, 1 },
                            .vertical_fov = 90 };
    CameraRays rays;
    camera_rays_init(&rays, &camera, 200, 100);
    assert_true(apart(direction_at(&rays, 100, 50), vec3(0, 0, -1)) < 1e-12);
    assert_true(apart(direction_at(&rays, 100, 0), vec3(0, sqrt(0.5), -sqrt(0.5))) < 1e-12);
    assert_true(apart(direction_at(&rays, 200, 50), vec3_unit(vec3(2, 0, -1))) < 1e-12);
    /* Looking along `up`: some frame, but a valid one. */
    const Camera down = { .eye = { 0, 0, 0 }, .target = { 0, -1, 0 }, .up = { 0, 1, 0 },
                          .vertical_fov = 60 };
    camera_rays_init(&rays, &down, 10, 10);
    assert_true(apart(direction_at(&rays, 5, 5), vec3(0, -1, 0)) < 1e-12);
    assert_true(fabs(vec3_length(direction_at(&rays, 0, 0)) - 1) < 1e-12);
}

/* Looks along -z with y up; one case for each projection but the plain one. */
static void camera_projections_are_where_they_should_be(void **state)
{
    (void)state;
    Camera camera = { .eye = { 1, 2, 3 }, .target = { 1, 2, -7 }, .up = { 0, 1, 0 },
                      .vertical_fov = 180 };
    CameraRays rays;
    Vec3 origin, direction;
    /* 180 degrees over 100 rows: half way out is 45 degrees off the axis, the rim 90. */
    camera.projection = CAMERA_FISHEYE;
    camera_rays_init(&rays, &camera, 200, 100);
    assert_true(apart(direction_at(&rays, 125, 50), vec3(sqrt(0.5), 0, -sqrt(0.5))) < 1e-12);
    assert_true(apart(direction_at(&rays, 100, 0), vec3(0, 1, 0)) < 1e-12);
    assert_false(camera_rays_at(&rays, 160, 50, NULL, &origin, &direction));
    /* All directions: a quarter from the left edge is the left, the edges are behind. */
    camera.projection = CAMERA_PANORAMA;
    camera_rays_init(&rays, &camera, 200, 100);
    assert_true(apart(direction_at(&rays, 50, 50), vec3(-1, 0, 0)) < 1e-12);
    assert_true(apart(direction_at(&rays, 0, 50), vec3(0, 0, 1)) < 1e-12);
    assert_true(apart(direction_at(&rays, 77, 0), vec3(0, 1, 0)) < 1e-12);
    /* 4 units high: the corner is 4 to the left and 2 up. */
    camera.projection = CAMERA_ORTHOGRAPHIC;
    camera.view_height = 4;
    camera_rays_init(&rays, &camera, 200, 100);
    assert_true(camera_rays_at(&rays, 0, 0, NULL, &origin, &direction));
    assert_true(apart(origin, vec3(-3, 4, 3)) < 1e-12);
    assert_true(apart(direction, vec3(0, 0, -1)) < 1e-12);
}

/* Rays through any two points of the lens meet on the plane in focus, and start on the lens. */
static void lens_is_sharp_where_it_focuses(void **state)
{
    (void)state;
    const Camera camera = { .eye = { 0, 0, 0 }, .target = { 0, 0, -10 }, .up = { 0, 1, 0 },
                            .vertical_fov = 60, .aperture = 0.25, .focus = 4 };
    CameraRays rays;
    camera_rays_init(&rays, &camera, 64, 64);
    assert_true(camera_rays_blur(&rays));
    for (int k = 0; k < 16; k++) {
        const float lens[2] = { ((float)k + 0.5f) / 16, (float)(k % 5) / 5 };
        Vec3 o, d, middle, straight;
        assert_true(camera_rays_at(&rays, 10, 50, lens, &o, &d));
        assert_true(camera_rays_at(&rays, 10, 50, NULL, &middle, &straight));
        assert_true(fabs(o.z) < 1e-12);
        assert_true(fabs(vec3_length(o) - 0.25 * sqrt((double)lens[0])) < 1e-7);
        const Vec3 sharp = vec3_scale(straight, -4 / straight.z);
        assert_true(apart(vec3_mad(o, (-4 - o.z) / d.z, d), sharp) < 1e-12);
    }
}

static void sizes_are_checked_and_memory_is_given_back(void **state)
{
    (void)state;
    static const int bad[][2] = { { 0, 5 }, { 5, 0 }, { -1, 5 }, { 100000, 1 } };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        Error err = { 0 };
        assert_null(image_create(bad[i][0], bad[i][1], &err));
        assert_int_equal(err.code, ERROR_USAGE);
    }
    for (long n = 0;; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Image *image = image_create(4, 4, &err);
        array_fail_after(-1);
        if (image != NULL) {
            image_destroy(image);
            break;
        }
        assert_int_equal(err.code, ERROR_MEMORY);
        assert_int_equal(array_live(), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(exr_comes_back, setup, teardown),
        cmocka_unit_test_setup_teardown(exr_header_is_the_formats, setup, teardown),
        cmocka_unit_test_setup_teardown(exr_holds_the_deviation, setup, teardown),
        cmocka_unit_test_setup_teardown(exr_half_files_are_read, setup, teardown),
        cmocka_unit_test_setup_teardown(exr_damage_is_an_error, setup, teardown),
        cmocka_unit_test_setup_teardown(png_holds_known_greys, setup, teardown),
        cmocka_unit_test_setup_teardown(png_says_how_it_was_made, setup, teardown),
        cmocka_unit_test(curve_has_a_soft_shoulder),
        cmocka_unit_test(curves_are_those_published),
        cmocka_unit_test(exposure_leaves_lamps_out),
        cmocka_unit_test(camera_sees_its_field),
        cmocka_unit_test(camera_projections_are_where_they_should_be),
        cmocka_unit_test(lens_is_sharp_where_it_focuses),
        cmocka_unit_test(sizes_are_checked_and_memory_is_given_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
