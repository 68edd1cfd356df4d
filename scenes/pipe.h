/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/pipe.h -- what the importing child tells its parent: records through a pipe.
 *
 * The child may be damaged by what it reads, so the parent believes nothing: reading never goes
 * past what came, counts are checked against limits before room is made, and after a failure all
 * further values are 0.
 * Numbers travel in the machine's own form: both ends are the same program.
 */
#ifndef SCENES_PIPE_H
#define SCENES_PIPE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "base/monitor.h"
#include "math/light.h"
#include "mesh/polygons.h"
#include "scenes/scene.h"

/* First byte of a record. */
typedef enum {
    RECORD_MATERIAL = 'M', /* PipeMaterial fields */
    RECORD_IMAGE = 'I',    /* material, number of the texture, wrap, whether it is cut out */
    RECORD_GLOW = 'G',     /* material, what its emission is multiplied by: an image's mean */
    RECORD_PART = 'P',     /* group name, material, vertices, faces, whether with (u, v),
                              with normals */
    RECORD_MESH = 'B',     /* vertices, faces, whether with normals, in its own space: to be
                              placed */
    RECORD_PLACE = 'A',    /* group name, number of the mesh, material, map */
    RECORD_LIGHT = 'L',
    RECORD_CAMERA = 'C',
    RECORD_UP = 'U',       /* the file's own up */
    RECORD_WARNING = 'W',  /* code, where, text */
    RECORD_LOOSE = 'O',    /* points and lines that were ignored */
    RECORD_TEXTURE = 'T',  /* name, width, height, whether floats, texels */
    RECORD_ERROR = 'E',    /* code, text; the last record */
    RECORD_END = 'Z'       /* hash; the last record */
} RecordKind;

/* Material of a part without one. */
#define PIPE_NO_MATERIAL UINT32_MAX
/* Number of a mesh that was not sent. */
#define PIPE_NO_MESH UINT32_MAX

/* --- writing: the child ----------------------------------------------------------------------- */

/* What the parent wants of meshes that stand in several places. */
typedef struct {
    SceneInstances instances;
    uint64_t       most; /* faces that come again, with INSTANCES_AUTO */
} PipeWish;

typedef struct {
    int     fd;
    PipeWish wish;
    bool    broken;      /* the parent is gone: writing does nothing any more */
    size_t  used;
    uint8_t buffer[1 << 16];
} PipeWriter;

void pipe_write(PipeWriter *out, const void *bytes, size_t size);
void pipe_flush(PipeWriter *out);
void pipe_put_u32(PipeWriter *out, uint32_t value);
void pipe_put_u64(PipeWriter *out, uint64_t value);
void pipe_put_rgb(PipeWriter *out, Rgb value);
void pipe_put_double(PipeWriter *out, double value);
void pipe_put_vec3(PipeWriter *out, Vec3 value);
void pipe_put_text(PipeWriter *out, const char *text);

/* Whole records. */
void pipe_put_kind(PipeWriter *out, RecordKind kind);
void pipe_put_warning(PipeWriter *out, const char *code, const char *where, const char *format,
                      ...) __attribute__((format(printf, 4, 5)));
void pipe_put_material(PipeWriter *out, const Material *material);
void pipe_put_light(PipeWriter *out, const Light *light);
void pipe_put_camera(PipeWriter *out, const Camera *camera);

/* --- reading: the parent ---------------------------------------------------------------------- */

typedef enum { PIPE_GOOD, PIPE_ENDED, PIPE_TIMEOUT, PIPE_STOPPED, PIPE_NONSENSE } PipeState;

typedef struct {
    int            fd;
    double         deadline;   /* on the clock of pipe_clock, seconds */
    const Monitor *monitor;
    PipeState      state;      /* why reading ended, when it did */
    size_t         begin, end; /* bytes not taken yet */
    uint8_t        buffer[1 << 16];
} PipeReader;

double pipe_clock(void);
/* false, and zeros in *bytes, when there are no `size` bytes in time. */
bool     pipe_read(PipeReader *in, void *bytes, size_t size);
uint32_t pipe_get_u32(PipeReader *in);
uint64_t pipe_get_u64(PipeReader *in);
double   pipe_get_double(PipeReader *in);
Rgb      pipe_get_rgb(PipeReader *in);
Vec3     pipe_get_vec3(PipeReader *in);
/* Up to size - 1 bytes; what is longer is cut at `size` (whole UTF-8 characters not minded). */
void pipe_get_text(PipeReader *in, char *text, size_t size);
/* What was read cannot be: nothing more is read. */
bool pipe_nonsense(PipeReader *in);

#endif
