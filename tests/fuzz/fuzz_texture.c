/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as what the child hands over of an image, and as the lines of a material library that
 * name one: a sound texture, or none; nothing left over.
 *
 * The first byte picks: even, a record of pixels as the parent takes it from a child that may be
 * damaged; odd, a line of text. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/array.h"
#include "scenes/import.h"
#include "scenes/texture_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void demand(bool condition)
{
    if (!condition)
        abort();
}

static bool rgb_sound(Rgb c)
{
    return c.r >= 0 && c.g >= 0 && c.b >= 0 && isfinite(c.r + c.g + c.b);
}

static void texture_demand(const Texture *t)
{
    static const double places[] = { 0, 0.5, -1e30, 1e300, NAN };
    enum { PLACES = sizeof places / sizeof *places };
    demand(t->width >= 1 && t->height >= 1 && t->name != NULL);
    for (int k = 0; k < 3 * PLACES * PLACES; k++) {
        Texture here = *t;
        double  alpha;
        here.wrap = (TextureWrap)(k % 3);
        const double u = places[k / 3 % PLACES], v = places[k / 3 / PLACES];
        const Rgb near = texture_at(&here, u, v, &alpha);
        const bool placed = isfinite(u) && isfinite(v);
        demand(!placed || rgb_sound(near));
        const Rgb mean = texture_mean_at(&here, u, v, 1, &alpha);
        demand(!placed || rgb_sound(mean));
    }
}

static void record_read(const uint8_t *data, size_t size)
{
    const int   file = memfd_create("fuzz", MFD_CLOEXEC);
    Error       err = { 0 };
    Texture     texture = { 0 };
    demand(file >= 0 && write(file, data, size) == (ssize_t)size && lseek(file, 0, SEEK_SET) == 0);
    PipeReader *in = array_create(1, sizeof *in, "pipe", &err);
    demand(in != NULL);
    *in = (PipeReader){ .fd = file, .deadline = INFINITY };
    if (texture_take(in, &texture, &err)) {
        texture_demand(&texture);
        texture_clear(&texture);
    } else {
        demand(in->state != PIPE_GOOD || error_is_set(&err));
    }
    array_free(in);
    close(file);
}

static void line_read(const uint8_t *data, size_t size)
{
    Error    err = { 0 };
    MapImage image = { 0 };
    TextFile text;
    uint64_t hash = 0;
    char     path[32];
    const int file = memfd_create("fuzz", MFD_CLOEXEC);
    demand(file >= 0 && write(file, data, size) == (ssize_t)size);
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (text_open(&text, path, import_file_limit, &hash, &err))
        for (const char *line; (line = text_line(&text)) != NULL;) {
            demand(map_image_read(&text, line, &image, &err));
            for (int k = 0; k < 2; k++)
                demand(isfinite(image.scale[k]) && isfinite(image.offset[k]));
            demand(image.file == NULL || image.file[0] != 0);
        }
    else
        demand(err.text[0] != 0 && strchr(err.text, '\n') == NULL);
    text_close(&text);
    array_free(image.file);
    close(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    if (data[0] % 2 == 0)
        record_read(data + 1, size - 1);
    else
        line_read(data + 1, size - 1);
    demand(array_live() == 0);
    return 0;
}
