/* SPDX-License-Identifier: BSD-3-Clause */
/* 8-bit sRGB PNG with text chunks, by libpng, the only file that includes it; no time chunk, so the
 * same picture is the same file. */
#include <assert.h>
#include <png.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
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

/* Everything between the jump's landing place and the end; false when libpng jumped. */
static bool write_rows(png_structp png, png_infop info, FILE *stream, const Image *image,
                       double exposure, Texts *texts, uint8_t *row)
{
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_init_io(png, stream);
    png_set_IHDR(png, info, (png_uint_32)image->width, (png_uint_32)image->height, 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_text(png, info, texts->text, texts->count);
    png_write_info(png, info);
    for (int y = 0; y < image->height; y++) {
        tonemap_row(image->radiance + 3 * (size_t)y * (size_t)image->width, image->width, y,
                    exposure, row);
        png_write_row(png, row);
    }
    png_write_end(png, info);
    return true;
}

bool image_write_png(const Image *image, double exposure, const ImageInfo *info, const char *path,
                     Error *err)
{
    assert(image != NULL && path != NULL && err != NULL);
    uint8_t *row = array_create(3 * (size_t)image->width, 1, "row of a PNG", err);
    OutFile *out = error_is_set(err) ? NULL : outfile_open(path, err);
    if (out == NULL) {
        array_free(row);
        return false;
    }
    Texts texts;
    texts_fill(&texts, exposure, info);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, err, on_error, on_warning);
    png_infop   header = png != NULL ? png_create_info_struct(png) : NULL;
    bool        ok = header != NULL;
    if (!ok)
        error_set(err, ERROR_MEMORY, "out of memory writing %s", path);
    ok = ok && write_rows(png, header, outfile_stream(out), image, exposure, &texts, row);
    png_destroy_write_struct(&png, &header);
    array_free(row);
    if (!ok) {
        outfile_discard(out);
        return false;
    }
    return outfile_commit(out, err);
}
