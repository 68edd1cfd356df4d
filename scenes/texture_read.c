/* SPDX-License-Identifier: BSD-3-Clause */
/* Images decoded by stb_image, which only this file includes, in a process of its own: files of
 * images come from anywhere, and the decoder is not made for hostile ones. */
#include "scenes/texture_read.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_MAX_DIMENSIONS (1 << 14)
#define STBI_NO_STDIO
#define STBI_NO_GIF
#define STBI_NO_PIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include "base/array.h"
#include "base/file.h"
#include "scenes/import_child.h"

static_assert(STBI_MAX_DIMENSIONS == TEXTURE_SIDE_MOST, "one limit");

static const size_t   FILE_MOST = (size_t)256 << 20;
static const uint64_t CHILD_MEMORY = (uint64_t)6 << 30; /* 2^28 texels as floats, and their file */
static const double   CHILD_SECONDS = 60;

/* Sizes that fit the memory of an ordinary machine: a quarter of the largest square. */
static const size_t TEXELS_MOST = (size_t)1 << 26;

/* So much that 2^26 texels add up to less than the greatest float. */
static const float LIGHT_MOST = 1e30F;

/* Floats that cannot be light become 0. */
static float sound(float v) { return v >= 0 && v <= LIGHT_MOST ? v : 0; }

/* --- in the child ----------------------------------------------------------------------------- */

/* Pixels [4 * width * height] of 8 bits in sRGB, or of floats; NULL and an error. */
static void *decode(const void *bytes, size_t size, const char *name, int extent[2], bool *hdr,
                    Error *err)
{
    int channels = 0;
    if (size > INT_MAX ||
        !stbi_info_from_memory(bytes, (int)size, &extent[0], &extent[1], &channels)) {
        error_at(err, ERROR_INPUT, name, 0, "is not an image that can be read: PNG, JPEG, HDR, "
                 "TGA, BMP, PSD, PNM");
        return NULL;
    }
    if ((size_t)extent[0] * (size_t)extent[1] > TEXELS_MOST) {
        error_at(err, ERROR_INPUT, name, 0, "has %d x %d pixels: too many", extent[0], extent[1]);
        return NULL;
    }
    *hdr = stbi_is_hdr_from_memory(bytes, (int)size) != 0;
    void *pixels = *hdr ? (void *)stbi_loadf_from_memory(bytes, (int)size, &extent[0], &extent[1],
                                                         &channels, 4)
                        : (void *)stbi_load_from_memory(bytes, (int)size, &extent[0], &extent[1],
                                                        &channels, 4);
    if (pixels == NULL)
        error_at(err, ERROR_INPUT, name, 0, "is damaged: %s", stbi_failure_reason());
    return pixels;
}

bool texture_put(PipeWriter *out, const void *bytes, size_t size, const char *name, Error *err)
{
    int  extent[2] = { 0, 0 };
    bool hdr = false;
    assert(bytes != NULL && out != NULL);
    void *pixels = decode(bytes, size, name, extent, &hdr, err);
    if (pixels == NULL)
        return false;
    pipe_put_kind(out, RECORD_TEXTURE);
    pipe_put_text(out, name);
    pipe_put_u32(out, (uint32_t)extent[0]);
    pipe_put_u32(out, (uint32_t)extent[1]);
    pipe_put_u32(out, hdr);
    pipe_write(out, pixels, (size_t)extent[0] * (size_t)extent[1] * (hdr ? 16 : 4));
    stbi_image_free(pixels);
    return true;
}

bool texture_mean(const void *bytes, size_t size, const char *name, Rgb *mean, Error *err)
{
    int  extent[2] = { 0, 0 };
    bool hdr = false;
    assert(bytes != NULL && mean != NULL);
    void *pixels = decode(bytes, size, name, extent, &hdr, err);
    if (pixels == NULL)
        return false;
    const size_t width = (size_t)extent[0], height = (size_t)extent[1];
    Rgb sum = { 0, 0, 0 };
    for (size_t y = 0; y < height; y++) {
        Rgb row = { 0, 0, 0 };
        for (size_t i = y * width; i < (y + 1) * width; i++) {
            const float   *f = (const float *)pixels + 4 * i;
            const uint8_t *b = (const uint8_t *)pixels + 4 * i;
            row = rgb_add(row, hdr ? rgb(sound(f[0]), sound(f[1]), sound(f[2]))
                                   : rgb(texture_linear(b[0]), texture_linear(b[1]),
                                         texture_linear(b[2])));
        }
        sum = rgb_mad(sum, 1.0 / (double)(width * height), row);
    }
    stbi_image_free(pixels);
    *mean = sum;
    return true;
}

static bool read_work(const char *path, PipeWriter *out, Error *err)
{
    size_t size = 0;
    void  *bytes = file_read(path, FILE_MOST, &size, err);
    const bool good = bytes != NULL && texture_put(out, bytes, size, path, err);
    array_free(bytes);
    return good;
}

/* --- in the parent ---------------------------------------------------------------------------- */

static void make_sound(float *linear, size_t count)
{
    for (size_t i = 0; i < count; i++)
        linear[i] = i % 4 == 3 ? fminf(sound(linear[i]), 1) : sound(linear[i]);
}

bool texture_take(PipeReader *in, Texture *texture, Error *err)
{
    char name[256];
    pipe_get_text(in, name, sizeof name);
    const uint32_t width = pipe_get_u32(in), height = pipe_get_u32(in), hdr = pipe_get_u32(in);
    if (in->state != PIPE_GOOD)
        return false;
    if (width < 1 || height < 1 || width > TEXTURE_SIDE_MOST || height > TEXTURE_SIDE_MOST ||
        (size_t)width * height > TEXELS_MOST || hdr > 1)
        return pipe_nonsense(in);
    const size_t values = 4 * (size_t)width * height, size = hdr ? sizeof(float) : 1;
    void *pixels = array_create(values, size, "texture", err);
    if (pixels == NULL || !pipe_read(in, pixels, values * size)) {
        array_free(pixels);
        return false;
    }
    if (hdr)
        make_sound(pixels, values);
    return texture_make(texture, name, (int)width, (int)height, hdr ? NULL : pixels,
                        hdr ? pixels : NULL, err);
}

/* The record of one image, or of why there is none. */
static bool record_take(PipeReader *in, Texture *texture, Error *err)
{
    char    text[512];
    uint8_t kind = 0;
    if (!pipe_read(in, &kind, 1))
        return false;
    if (kind == RECORD_TEXTURE)
        return texture_take(in, texture, err);
    if (kind != RECORD_ERROR)
        return pipe_nonsense(in);
    (void)pipe_get_u32(in);
    pipe_get_text(in, text, sizeof text);
    return error_set(err, ERROR_INPUT, "%s", text);
}

bool texture_read(const char *path, const Monitor *monitor, Texture *texture, Error *err)
{
    const ChildLimits limits = { .seconds = CHILD_SECONDS, .memory = CHILD_MEMORY };
    ImportChild child;
    assert(path != NULL && texture != NULL && err != NULL);
    *texture = (Texture){ 0 };
    if (error_is_set(err) || !child_start(&child, &limits, read_work, path, err))
        return false;
    PipeReader in = { .fd = child.fd, .deadline = pipe_clock() + limits.seconds,
                      .monitor = monitor };
    const bool good = record_take(&in, texture, err);
    if (!good && in.state == PIPE_STOPPED)
        error_set(err, ERROR_STOPPED, "%s: stopped while it was being read", path);
    else if (!good && in.state != PIPE_ENDED)
        error_at(err, ERROR_INPUT, path, 0, "the image cannot be read");
    if (!good)
        child_kill(&child);
    child_finish(&child, path, err);
    if (good && error_is_set(err))
        texture_clear(texture);
    return good && !error_is_set(err);
}
