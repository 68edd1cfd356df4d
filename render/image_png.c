/* SPDX-License-Identifier: BSD-3-Clause */
/* 8-bit sRGB PNG with text chunks, by libpng, the only file that includes it; no time chunk, so the
 * same picture is the same file. */
#include <assert.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "base/parallel.h"
#include "render/internal.h"

/* libpng's error: keep its sentence, then leave by its jump. */
static void on_error(png_structp png, png_const_charp text)
{
    error_set(png_get_error_ptr(png), ERROR_FAILED, "PNG: %s", text);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text)
{
    (void)png; /* libpng warns of nothing that we could change here */
    (void)text;
}

enum { TEXTS_MAX = 8 };
typedef struct {
    png_text text[TEXTS_MAX];
    char     exposure[32], software[64];
    int      count;
} Texts;

static void texts_add(Texts *texts, const char *key, const char *value)
{
    assert(texts->count < TEXTS_MAX);
    if (value == NULL || value[0] == '\0')
        return;
    png_text *t = &texts->text[texts->count++];
    t->compression = PNG_TEXT_COMPRESSION_NONE;
    /* libpng's own struct is not const, but it only reads them. */
    t->key = (png_charp)(size_t)key;
    t->text = (png_charp)(size_t)value;
    t->text_length = strlen(value);
}

static void texts_fill(Texts *texts, double exposure, const ImageInfo *info)
{
    memset(texts, 0, sizeof *texts);
    if (!isnan(exposure))
        snprintf(texts->exposure, sizeof texts->exposure, "%.6g EV", exposure);
    snprintf(texts->software, sizeof texts->software, "isolux%s%.40s",
             info != NULL && info->version != NULL ? " " : "",
             info != NULL && info->version != NULL ? info->version : "");
    texts_add(texts, "Software", texts->software);
    texts_add(texts, "Exposure", texts->exposure);
    if (info != NULL) {
        texts_add(texts, "Units", info->units);
        texts_add(texts, "Source", info->scene);
        texts_add(texts, "Command", info->command);
    }
}

enum { LEVEL = 3 }; /* of deflate: 6, the usual, takes twice as long for 2 % less */

/* What is written. */
typedef struct {
    int            width, height;
    const uint8_t *pixels; /* [3 * width * height] */
} Rows;

/* Everything between the jump's landing place and the end; false when libpng jumped. */
static bool write_rows(png_structp png, png_infop info, FILE *stream, const Rows *rows,
                       Texts *texts)
{
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_init_io(png, stream);
    png_set_IHDR(png, info, (png_uint_32)rows->width, (png_uint_32)rows->height, 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, LEVEL);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_text(png, info, texts->text, texts->count);
    png_write_info(png, info);
    for (int y = 0; y < rows->height; y++)
        png_write_row(png, rows->pixels + 3 * (size_t)y * (size_t)rows->width);
    png_write_end(png, info);
    return true;
}

static bool write_file(const Rows *rows, double exposure, const ImageInfo *info, const char *path,
                       Error *err)
{
    OutFile *out = outfile_open(path, err);
    if (out == NULL)
        return false;
    Texts texts;
    texts_fill(&texts, exposure, info);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, err, on_error, on_warning);
    png_infop   header = png != NULL ? png_create_info_struct(png) : NULL;
    bool        ok = header != NULL;
    if (!ok)
        error_set(err, ERROR_MEMORY, "out of memory writing %s", path);
    ok = ok && write_rows(png, header, outfile_stream(out), rows, &texts);
    png_destroy_write_struct(&png, &header);
    if (!ok) {
        outfile_discard(out);
        return false;
    }
    return outfile_commit(out, err);
}

bool png_write_pixels(const uint8_t *pixels, int width, int height, double exposure,
                      const ImageInfo *info, const char *path, Error *err)
{
    assert(pixels != NULL && width > 0 && height > 0 && path != NULL && err != NULL);
    const Rows rows = { .width = width, .height = height, .pixels = pixels };
    return !error_is_set(err) && write_file(&rows, exposure, info, path, err);
}

typedef struct {
    const Image     *image;
    const ImageTone *tone;
    uint8_t         *pixels;
} Toning;

static void tone_rows(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Toning *t = context;
    (void)worker;
    for (uint32_t y = begin; y < end; y++) {
        const size_t at = 3 * (size_t)y * (size_t)t->image->width;
        tonemap_row(t->image->radiance + at, t->image->width, (int)y, t->tone, t->pixels + at);
    }
}

bool image_write_png(const Image *image, const ImageTone *tone, const ImageInfo *info,
                     const char *path, Error *err)
{
    enum { ROWS = 16 }; /* a thread takes at a time */
    assert(image != NULL && tone != NULL && path != NULL && err != NULL);
    const size_t n = 3 * (size_t)image->width * (size_t)image->height;
    Toning       t = { image, tone, array_create(n, 1, "pixels of a PNG", err) };
    if (t.pixels == NULL)
        return false;
    parallel_for((uint32_t)image->height, ROWS, info != NULL ? info->threads : 1, tone_rows, &t,
                 NULL, NULL);
    const bool ok = png_write_pixels(t.pixels, image->width, image->height, tone->exposure, info,
                                     path, err);
    array_free(t.pixels);
    return ok;
}
