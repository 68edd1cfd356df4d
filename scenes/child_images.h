/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/child_images.h -- images that a foreign file names, sent by the child; this
 * folder only. */
#ifndef SCENES_CHILD_IMAGES_H
#define SCENES_CHILD_IMAGES_H

#include "scenes/import_files.h"
#include "scenes/pipe.h"
#include "scenes/texture.h"

/* Those sent so far. Nothing is given back: the process ends. */
typedef struct {
    const char  *path;        /* of the file that names them */
    PipeWriter  *out;
    ImportFiles *files;
    Error       *err;
    char       **name;        /* [count] */
    size_t       capacity;
    uint32_t     count;
} ChildImages;

/* How a material's image lies: which coordinates, scaled, turned about the middle, moved. */
typedef struct {
    unsigned set;             /* 1 + number of the coordinates; 0: no image */
    double   scale[2], offset[2], rotation;
} ImagePlace;

/* Sends the image once: from `bytes`, or the file of that name when NULL. Returns its number;
 * UINT32_MAX: there is none that can be read, which is told. */
uint32_t child_image_send(ChildImages *images, const char *name, const void *bytes, size_t size);
/* A material that was sent shows it. */
void child_image_use(const ChildImages *images, uint32_t material, uint32_t image,
                     TextureWrap wrap, bool cut_out);
/* A material that was sent emits by an image: on the average. Takes the bytes likewise. */
void child_image_glow(ChildImages *images, uint32_t material, const char *name, const void *bytes,
                      size_t size);
/* (u, v) of a vertex. */
void child_place_send(PipeWriter *out, const ImagePlace *place, double u, double v);

#endif
