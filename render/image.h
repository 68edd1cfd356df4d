/* SPDX-License-Identifier: BSD-3-Clause */
/* render/image.h -- a picture as layers of floats; row 0 on top. */
#ifndef RENDER_IMAGE_H
#define RENDER_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

/* How samples around a pixel's middle count; box: its square alone; the others reach 1, 1.5 and 1.5
 * pixels far. */
typedef enum { FILTER_BOX, FILTER_TENT, FILTER_GAUSS, FILTER_BLACKMAN_HARRIS } PixelFilter;

enum { IMAGE_NAME = 64 };

/* Layers that some renderers leave empty. */
enum {
    IMAGE_DIRECT = 1, IMAGE_INDIRECT = 2, IMAGE_ALBEDO = 4, IMAGE_IRRADIANCE = 8, IMAGE_NORMAL = 16,
    IMAGE_PATCH = 32
};

typedef struct {
    int    width, height;
    int    left, top;           /* of a part: its place in the whole picture; else 0 */
    int    whole_width, whole_height; /* of the whole picture; 0: this is it */
    float *radiance;    /* [3 * width * height]  all light towards the eye */
    float *direct;      /* [3 * ..]  part of it reflected once from lamps and lights */
    float *indirect;    /* [3 * ..]  part of it reflected more often; emitted = radiance - both */
    float *albedo;      /* [3 * ..]  diffuse reflectance */
    float *irradiance;  /* [3 * ..]  lux or W/m2 at what is seen */
    float *normal;      /* [3 * ..]  unit, world, towards the eye; 0: background */
    float *depth;       /* [..]  distance from the eye, INFINITY: background */
    uint32_t *patch;    /* [..]  patch seen at the pixel's centre, UINT32_MAX: none */
    unsigned empty;     /* IMAGE_...: nobody filled these; files leave them out */
    float *deviation;   /* [..]  standard error of the radiance's luminance; NULL: not estimated */
    uint32_t group_count; /* layers of light by groups of lamps, whose sum is the radiance */
    char  (*group_name)[IMAGE_NAME]; /* [group_count]  letters, digits, '-', '_' */
    float *group;       /* [group_count * 3 * width * height]  one layer after the other */
} Image;

/* Black, depth INFINITY, patch UINT32_MAX. fails  NULL; ERROR_MEMORY, ERROR_USAGE for a size out of
 * 1..32768. */
Image *image_create(int width, int height, Error *err);
/* The same for a part of a picture: left, top, right, bottom in pixels; all 0: the whole. fails too
 * when it reaches beyond the picture. */
Image *image_create_part(int width, int height, const int part[4], Error *err);
/* Adds the layer `deviation`, zeros, unless it is there. fails  false and ERROR_MEMORY. */
bool image_add_deviation(Image *image, Error *err);
/* Adds layers of light groups, zeros. fails  false and ERROR_MEMORY. */
bool image_add_groups(Image *image, const char *const *name, uint32_t count, Error *err);
/* Layer k of those. */
static inline float *image_group(const Image *image, uint32_t k)
{
    return image->group + 3 * (size_t)image->width * (size_t)image->height * k;
}
/* Frees; NULL is allowed. Always returns NULL. */
Image *image_destroy(Image *image);

/* Adds a picture of the same size and layers, made by other random numbers: light, albedo and
 * groups are summed, deviations like those of a sum; normal, depth and patch stay. */
void image_add(Image *sum, const Image *image);
/* All that image_add adds, times a share. */
void image_scale(Image *image, double share);
/* What the pixels' centres show, from another picture: normal, depth, patch. */
void image_take_places(Image *image, const Image *from);

/* What a picture file says of itself. Strings may be NULL. */
typedef struct {
    double      eye[3], target[3], up[3], vertical_fov;
    double      exposure;       /* EV the PNG was made with */
    const char *units;          /* "photometric" or "radiometric" */
    const char *version, *scene, *command;
    uint64_t    scene_hash;
    unsigned    threads;        /* that may pack it; 0: as many as there are cores */
} ImageInfo;

/* OpenEXR, 32-bit float, ZIP: channels R G B; direct.R ...; indirect.R ...; albedo.R ...;
 * irradiance.R ...; normal.X Y Z; depth.Z; patch.ID (uint); deviation.Y when there is one;
 * lightgroup.NAME.R ... of each light group. Attributes from info. */
bool image_write_exr(const Image *image, const ImageInfo *info, const char *path, Error *err);
/* R G B of an EXR (any of half, float), for comparing; width and height are set.
 * owns   the caller frees with array_free. */
float *image_read_exr(const char *path, int *width, int *height, Error *err);
/* The same of a layer: "irradiance"; NULL: R G B. */
float *image_read_layer(const char *path, const char *layer, int *width, int *height, Error *err);

/* How light is put on a screen: times 2^exposure, then a curve (render/tonemap.c), then sRGB. */
typedef enum { TONE_SHOULDER, TONE_LINEAR, TONE_REINHARD, TONE_FILMIC } ToneCurve;
typedef struct {
    double    exposure; /* EV */
    ToneCurve curve;
} ImageTone;

/* 8-bit sRGB PNG of the radiance; text chunks from info. */
bool image_write_png(const Image *image, const ImageTone *tone, const ImageInfo *info,
                     const char *path, Error *err);
/* The exposure (EV) that puts the picture's log-average luminance, lamps left out, at mid grey. */
double image_auto_exposure(const Image *image);

#endif
