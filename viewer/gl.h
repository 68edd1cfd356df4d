/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/gl.h -- patches drawn by OpenGL, in a few large buffers that stay on the card.
 *
 * Threads  the one whose window is current.
 */
#ifndef VIEWER_GL_H
#define VIEWER_GL_H

#include "render/image.h"
#include "viewer/false_map.h"
#include "viewer/snapshot.h"

typedef enum { SHADING_SMOOTH, SHADING_PATCHES, SHADING_WIRES, SHADING_COUNT } Shading;
typedef enum { BACKS_HIDDEN, BACKS_RED, BACKS_GREY, BACKS_COUNT } Backs;

typedef struct {
    int       width, height;  /* pixels */
    Camera    camera;
    double    exposure;       /* EV */
    ToneCurve tone;
    Shading   shading;
    Backs     backs;
    bool      outlines, rays; /* of patches; of the last shot */
    uint32_t  picked;         /* patch, or PATCH_NONE */
    Layer     layer;
    const FalseMap *map;      /* false colours of gl_take_values; NULL: light */
    bool      gathered;       /* the picture of gl_take_picture lies over it */
} GlView;

typedef struct Gl Gl;

/* fails  NULL; ERROR_FAILED when a shader does not compile, ERROR_MEMORY. */
Gl *gl_create(Error *err);
Gl *gl_destroy(Gl *gl);
/* Whether the context is lost, with all that it held: only destroying is of use then. */
bool gl_is_lost(const Gl *gl);
/* Takes what is to be shown: the mesh's buffers only when it is another mesh than before. */
bool gl_take(Gl *gl, const Snapshot *snapshot, Layer layer, Error *err);
/* Numbers for false colours, of patches and of vertices of the mesh taken; NAN: grey. */
bool gl_take_values(Gl *gl, const float *patch, const float *vertex, Error *err);
/* A picture of the view: radiance, and 1 where there is any [4 * width * height], from the top. */
void gl_take_picture(Gl *gl, const float *pixel, int width, int height);
/* Clears and draws; nothing taken yet: only clears. */
void gl_draw(Gl *gl, const GlView *view);
/* The picture as it is now, rows from the top [3 * width * height]. */
void gl_read(int width, int height, uint8_t *rgb);

#endif
