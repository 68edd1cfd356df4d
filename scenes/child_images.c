/* SPDX-License-Identifier: BSD-3-Clause */
/* Images of foreign files: found, unpacked and sent to the parent. */
#include "scenes/child_images.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/texture_read.h"

/* The bytes, or else those of the file of that name; NULL: it is missing, which is told. */
static const void *image_bytes(ChildImages *images, const char *name, const void *bytes,
                               size_t *size)
{
    char   path[PATH_MAX];
    size_t at;

    if (bytes != NULL)
        return bytes;
    if (file_beside(images->path, name, path, sizeof path) &&
        import_files_get(images->files, path, &at)) {
        *size = images->files->file[at].size;
        return images->files->file[at].bytes;
    }
    pipe_put_warning(images->out, "image-missing", images->path,
                     "image \"%.200s\" is not there; its material has one colour", name);
    return NULL;
}

void child_image_glow(ChildImages *images, uint32_t material, const char *name, const void *bytes,
                      size_t size)
{
    Error damaged = { 0 };
    Rgb   mean;

    bytes = image_bytes(images, name, bytes, &size);
    if (bytes == NULL)
        return;
    if (!texture_mean(bytes, size, name, &mean, &damaged)) {
        pipe_put_warning(images->out, "image-unreadable", images->path,
                         "%s; its material emits everywhere alike", damaged.text);
        return;
    }
    pipe_put_kind(images->out, RECORD_GLOW);
    pipe_put_u32(images->out, material);
    pipe_put_rgb(images->out, mean);
}

uint32_t child_image_send(ChildImages *images, const char *name, const void *bytes, size_t size)
{
    Error damaged = { 0 };

    assert(name != NULL && images->files != NULL);
    for (uint32_t i = 0; i < images->count; i++)
        if (strcmp(images->name[i], name) == 0)
            return i;
    bytes = image_bytes(images, name, bytes, &size);
    if (bytes == NULL)
        return UINT32_MAX;
    if (!texture_put(images->out, bytes, size, name, &damaged)) {
        pipe_put_warning(images->out, "image-unreadable", images->path,
                         "%s; its material has one colour", damaged.text);
        return UINT32_MAX;
    }
    if (!array_reserve((void **)&images->name, &images->capacity, (size_t)images->count + 1,
                       sizeof *images->name, "images", images->err))
        return UINT32_MAX;
    images->name[images->count] = array_string(name, images->err);
    return images->name[images->count] != NULL ? images->count++ : UINT32_MAX;
}

void child_image_use(const ChildImages *images, uint32_t material, uint32_t image,
                     TextureWrap wrap, bool cut_out)
{
    assert(image < images->count);
    pipe_put_kind(images->out, RECORD_IMAGE);
    pipe_put_u32(images->out, material);
    pipe_put_u32(images->out, image);
    pipe_put_u32(images->out, (uint32_t)wrap);
    pipe_put_u32(images->out, cut_out);
}

void child_place_send(PipeWriter *out, const ImagePlace *place, double u, double v)
{
    const double c = cos(place->rotation), s = sin(place->rotation);
    const double x = u * place->scale[0] - 0.5, y = v * place->scale[1] - 0.5;

    pipe_put_double(out, c * x - s * y + 0.5 + place->offset[0]);
    pipe_put_double(out, s * x + c * y + 0.5 + place->offset[1]);
}
