/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/texture.h -- image textures: what colour a place of a face has.
 *
 * An image is kept as it came, eight bits a channel in sRGB or linear floats (HDR), and smaller
 * copies of it, each half as wide and high, for means over areas. Values are linear light.
 * A face has no coordinates of its own: (u, v) is a linear function of the place, which stays the
 * same when the face is cut into pieces.
 * Threads  never changes once made.
 */
#ifndef SCENES_TEXTURE_H
#define SCENES_TEXTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "math/rgb.h"
#include "math/vec3.h"

enum { TEXTURE_LEVELS = 16, TEXTURE_SIDE_MOST = 1 << 14 };

typedef enum { WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR } TextureWrap;

typedef struct {
    char       *name;        /* where it came from; owned */
    int         width, height;
    TextureWrap wrap;
    bool        clear;       /* some of it is not opaque */
    uint8_t    *bytes;       /* [4 * width * height]  sRGB and alpha, row 0 on top; NULL: floats */
    float       linear_of[256]; /* of a byte */
    float      *linear;      /* [4 * width * height]  when bytes is NULL */
    int         levels;      /* smaller copies */
    /* [4 * w * h]  linear, colours times their alpha: of floats; or of bytes, 65535 being 1 */
    float      *level[TEXTURE_LEVELS];
    uint16_t   *short_level[TEXTURE_LEVELS];
} Texture;

/* u = du . p + u0, v likewise; v = 0 is the image's lower edge. texture is in the material. */
typedef struct {
    Vec3   du, dv;
    double u0, v0;
    bool   used;
} FaceMap;

/* Of a byte in sRGB. */
float texture_linear(uint8_t byte);

/* Takes over pixels [4 * width * height], of 8 bits in sRGB, or floats (either is NULL), freed by
 * texture_clear, also on failure; makes the smaller copies. name is copied.
 * fails  false; ERROR_MEMORY. */
bool texture_make(Texture *texture, const char *name, int width, int height, uint8_t *bytes,
                  float *linear, Error *err);
void texture_clear(Texture *texture);

/* Between the four nearest texels; *alpha 0..1, NULL: not wanted. */
Rgb texture_at(const Texture *texture, double u, double v, double *alpha);
/* The same in a copy whose texels are about `size` wide in (u, v); colours are means over what is
 * opaque. */
Rgb texture_mean_at(const Texture *texture, double u, double v, double size, double *alpha);

/* All images of a scene, and how faces show them. */
typedef struct {
    Texture *texture;        /* [count] */
    size_t   count, capacity;
    FaceMap *map;            /* [map_count]  by polygon; those beyond have none */
    size_t   map_count, map_capacity;
} Textures;

/* Takes over *texture, also on failure. */
bool textures_add(Textures *textures, Texture *texture, uint32_t *index, Error *err);
bool textures_set_map(Textures *textures, uint32_t polygon, const FaceMap *map, Error *err);
/* NULL: the polygon has no coordinates. */
static inline const FaceMap *textures_map(const Textures *textures, uint32_t polygon)
{
    return polygon < textures->map_count && textures->map[polygon].used ? &textures->map[polygon]
                                                                        : NULL;
}
void textures_clear(Textures *textures);

/* The map under which points p[count] have (u, v) uv[count], count >= 3; exact for three of them
 * that make a triangle. false: they lie on a line. *misfit: largest distance in (u, v) of a point
 * that does not fit. */
bool face_map_fit(FaceMap *map, const Vec3 *p, const double (*uv)[2], size_t count,
                  double *misfit);
static inline double face_map_u(const FaceMap *m, Vec3 p) { return vec3_dot(m->du, p) + m->u0; }
static inline double face_map_v(const FaceMap *m, Vec3 p) { return vec3_dot(m->dv, p) + m->v0; }
/* The map of the same face after all positions were moved by -origin. */
void face_map_move(FaceMap *map, Vec3 origin);

#endif
