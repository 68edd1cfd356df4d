/* SPDX-License-Identifier: BSD-3-Clause */
/* Primitives to references: each one's box in float, never smaller than the thing itself. */
#include <string.h>

#include "base/array.h"
#include "raycast/build.h"
#include "raycast/probe.h"

#define REFS_CHUNK 16384u
/* Marks the reference of a triangle without area. */
#define REF_FLAT UINT32_MAX

typedef struct {
    const Primitives *in;
    Ref              *ref;
    Error            *error; /* [chunks] */
    uint32_t         *flat;  /* [chunks]  triangles without area */
} RefsContext;

static float float_below(double x)
{
    const float f = (float)x;
    return f > x ? nextafterf(f, -INFINITY) : f;
}

static float float_above(double x)
{
    const float f = (float)x;
    return f < x ? nextafterf(f, INFINITY) : f;
}

static bool triangle_ref(const Primitives *in, uint32_t i, Ref *ref, Error *err)
{
    float corner[3][3];
    Box box = box_empty();
    for (uint32_t c = 0; c < 3; c++) {
        const uint32_t vertex = in->corner[3 * (size_t)i + c];
        if (vertex >= in->vertex_count)
            return error_set(err, ERROR_INPUT, "triangle %u names vertex %u of %u", i, vertex,
                             in->vertex_count);
        const Vec3 p = in->position[vertex];
        /* NaN fails this too. */
        if (!(fabs(p.x) <= (double)PROBE_COORDINATE_MAX && fabs(p.y) <= (double)PROBE_COORDINATE_MAX
              && fabs(p.z) <= (double)PROBE_COORDINATE_MAX))
            return error_set(err, ERROR_INPUT,
                             "vertex %u of triangle %u is not finite or beyond %g: %g %g %g",
                             vertex, i, (double)PROBE_COORDINATE_MAX, p.x, p.y, p.z);
    }
    const bool area = probe_corners(in, i, corner);
    for (int c = 0; c < 3; c++)
        box = box_point(box, (Float4){ corner[c][0], corner[c][1], corner[c][2], 0 });
    memcpy(ref->lo, &box.lo, sizeof ref->lo);
    memcpy(ref->hi, &box.hi, sizeof ref->hi);
    ref->primitive = area ? i : REF_FLAT;
    return true;
}

bool shape_box(const Shape *shape, float lo[3], float hi[3])
{
    Vec3 from, to;
    shape_bounds(shape, &from, &to);
    for (int k = 0; k < 3; k++) {
        const double a = vec3_axis(from, k), b = vec3_axis(to, k);
        if (!(fabs(a) <= (double)PROBE_COORDINATE_MAX && fabs(b) <= (double)PROBE_COORDINATE_MAX))
            return false;
        /* The bounds and the hits are computed in double; a float's ulp is far more than both
         * can be off. */
        const double margin = (fabs(a) + fabs(b)) * (double)PROBE_ROUNDING;
        lo[k] = float_below(a - margin);
        hi[k] = float_above(b + margin);
    }
    return true;
}

static bool shape_ref(const Primitives *in, uint32_t i, Ref *ref, Error *err)
{
    ref->primitive = in->triangle_count + i;
    return shape_box(&in->shape[i], ref->lo, ref->hi)
           || error_set(err, ERROR_INPUT, "shape %u is not finite or reaches beyond %g", i,
                        (double)PROBE_COORDINATE_MAX);
}

static void refs_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    RefsContext *c = context;
    const uint32_t chunk = begin / REFS_CHUNK;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        const bool is_triangle = i < c->in->triangle_count;
        if (is_triangle ? !triangle_ref(c->in, i, &c->ref[i], &c->error[chunk])
                        : !shape_ref(c->in, i - c->in->triangle_count, &c->ref[i],
                                     &c->error[chunk]))
            return;
        c->flat[chunk] += c->ref[i].primitive == REF_FLAT;
    }
}

/* The first chunk's error, whatever thread found one first. Closes the gaps of flat triangles. */
static bool refs_finish(RefsContext *c, uint32_t total, uint32_t chunks, uint32_t *count,
                        Error *err)
{
    uint32_t flat = 0;
    for (uint32_t i = 0; i < chunks; i++) {
        if (error_is_set(&c->error[i])) {
            *err = c->error[i];
            return false;
        }
        flat += c->flat[i];
    }
    *count = total - flat;
    for (uint32_t from = 0, to = 0; flat > 0 && from < total; from++)
        if (c->ref[from].primitive != REF_FLAT)
            c->ref[to++] = c->ref[from];
    return true;
}

Ref *refs_create(const Primitives *in, unsigned threads, uint32_t *count, Error *err)
{
    assert(in != NULL && count != NULL && err != NULL);
    if ((uint64_t)in->triangle_count + in->shape_count >= PRIMITIVES_MAX
        || in->shape_count > CHILD_INDEX_MAX) {
        error_set(err, ERROR_INPUT, "%u triangles and %u shapes are too many for one tree",
                  in->triangle_count, in->shape_count);
        return NULL;
    }
    const uint32_t total = in->triangle_count + in->shape_count;
    const uint32_t chunks = total / REFS_CHUNK + 1;
    RefsContext c = { .in = in };
    c.ref = array_create(total, sizeof *c.ref, "references to primitives", err);
    c.error = array_create(chunks, sizeof *c.error, "errors of chunks", err);
    c.flat = array_create(chunks, sizeof *c.flat, "counts of chunks", err);
    bool good = !error_is_set(err);
    if (good) {
        parallel_for(total, REFS_CHUNK, threads, refs_chunk, &c, NULL, NULL);
        good = refs_finish(&c, total, chunks, count, err);
    }
    array_free(c.error);
    array_free(c.flat);
    return good ? c.ref : array_free(c.ref);
}
