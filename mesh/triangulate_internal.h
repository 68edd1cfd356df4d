/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/triangulate_internal.h -- ear clipping: what its two ways through an outline share. */
#ifndef MESH_TRIANGULATE_INTERNAL_H
#define MESH_TRIANGULATE_INTERNAL_H

#include "mesh/triangulate.h"

struct CutCorner {
    double   x, y;         /* in the plane, counter-clockwise */
    uint32_t vertex;
    uint32_t previous, next;
};

/* How much is asked of an ear, from all to nothing. */
typedef enum {
    EAR_CLEAN,   /* has area, no other corner in it or on its rim */
    EAR_TOUCHED, /* has area, other corners on its rim at most */
    EAR_FLAT,    /* no area: a spike or a corner in line, dropped */
    EAR_FORCED,  /* the outline crosses itself */
    EAR_NONE
} EarDemand;

typedef struct Clipper Clipper;
struct Clipper {
    CutCorner *ring;
    uint32_t   left;        /* corners left */
    double     tolerance;   /* height below which a triangle has no area */
    uint64_t   tests, most; /* corner-in-ear tests made; allowed: afterwards ears are cut unseen */
    bool     (*is_free)(Clipper *clip, uint32_t i, EarDemand demand);
    void      *search;      /* of is_free */
};

/* Twice the signed area of (a, b, c). */
static inline double ear_turn(const CutCorner *a, const CutCorner *b, const CutCorner *c)
{
    return (b->x - a->x) * (c->y - a->y) - (c->x - a->x) * (b->y - a->y);
}

double ear_distance(const CutCorner *a, const CutCorner *b);
/* Whether corner w keeps the ear (a, b, c) from being cut. A corner at the place of one of the
 * ear's own (bridges, outlines that touch themselves) does when its edges run into the ear. */
bool ear_blocked(const Clipper *clip, const CutCorner *const ear[3], const CutCorner *w,
                 EarDemand demand);
/* Fatness of the ear at corner i, 0..1 or so, or -1 when it may not be cut on these terms. */
double ear_grade(Clipper *clip, uint32_t i, EarDemand demand);
/* Cuts corner i off; its triangle is kept unless it is flat. Returns the corner after it. */
uint32_t ear_cut(Triangulation *cut, Clipper *clip, uint32_t i, bool keep);

/* triangulate_many.c: cuts all but three corners of an outline of very many.
 * fails  false and ERROR_MEMORY. */
bool ears_clip_many(Triangulation *cut, Clipper *clip, uint32_t *last, Error *err);

#endif
