/* SPDX-License-Identifier: BSD-3-Clause */
/* The outline of a face's pieces, where they fill it. */
#include "render/lamp_faces.h"

#include <assert.h>
#include <float.h>
#include <stdlib.h>

#include "base/array.h"

/* Corners come from float coordinates: a place is known to this share of the largest. */
static const double PLACE_ROUNDING = 4 * (double)FLT_EPSILON;
/* Cutting may lose slivers: of a face that has so much of its area all is taken to shine. What does
 * not is dark by shadow rays where another face covers it. */
static const double AREA_LEFT = 0.99;

typedef struct {
    double x, y;
    Vec3   point;
} Flat;

static int compare_pieces(const void *a, const void *b)
{
    const LampPiece *p = a, *q = b;
    if (p->face != q->face)
        return p->face < q->face ? -1 : 1;
    if (p->side != q->side)
        return p->side < q->side ? -1 : 1;
    return p->surface < q->surface ? -1 : p->surface > q->surface;
}

static int compare_flat(const void *a, const void *b)
{
    const Flat *p = a, *q = b;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return p->y < q->y ? -1 : p->y > q->y;
}

/* Corners of a surface; returns how many. */
static int corners_of(const Surfaces *s, uint32_t surface, Vec3 corner[4])
{
    const uint32_t *v = &s->corner[3 * (size_t)s->surface[surface].primitive];
    for (int i = 0; i < 3; i++)
        corner[i] = s->position[v[i]];
    if (s->surface[surface].kind == SURFACE_TRIANGLE)
        return 3;
    corner[3] = s->position[v[5]];
    return 4;
}

/* Twice the area of the triangle a, b, c; > 0 when it is wound counter-clockwise. */
static double turn(const Flat *a, const Flat *b, const Flat *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* The points' hull, counter-clockwise, without corners that bend by less than `slack` (a length);
 * by its lower and its upper half [andrew79]. `at` is in order; hull has room for count + 1. */
static uint32_t hull_of(const Flat *at, uint32_t count, double slack, Flat *hull)
{
    uint32_t n = 0;
    for (int half = 0; half < 2; half++) {
        const uint32_t kept = n + 1;
        for (uint32_t i = 0; i < count; i++) {
            const Flat *p = &at[half == 0 ? i : count - 1 - i];
            while (n >= kept + 1 && turn(&hull[n - 2], &hull[n - 1], p) <=
                   slack * hypot(p->x - hull[n - 2].x, p->y - hull[n - 2].y))
                n--;
            hull[n++] = *p;
        }
        n--; /* the other half begins with it */
    }
    return n;
}

/* The face's outline, from its pieces' corners, flat and in order. */
static bool outline(const Flat *at, uint32_t count, double area, double slack, Flat *hull,
                    LampFace *face)
{
    const uint32_t n = hull_of(at, count, slack, hull);
    double twice = 0;
    if (n < 3 || n > LAMP_CORNERS)
        return false;
    for (uint32_t i = 0; i < n; i++) {
        const Flat *a = &hull[i], *b = &hull[(i + 1) % n];
        face->corner[i] = a->point;
        twice += a->x * b->y - a->y * b->x;
    }
    face->corners = n;
    const double gap = n != 4 ? INFINITY : hypot(hull[0].x + hull[2].x - hull[1].x - hull[3].x,
                                                 hull[0].y + hull[2].y - hull[1].y - hull[3].y);
    face->whole = n == 3 || gap <= 2 * slack;
    return area >= AREA_LEFT * twice / 2 && area <= twice / 2 / AREA_LEFT;
}

/* Whether pieces begin..end-1, of one face, fill what a lamp can be. */
static bool fill_face(const Surfaces *s, const LampPiece *piece, uint32_t begin, uint32_t end,
                      Flat *flat, LampFace *face)
{
    Vec3     v[4], x, y;
    uint32_t count = 0;
    double   area = 0;
    corners_of(s, piece[begin].surface, v);
    const Vec3   origin = v[0];
    const Vec3   normal = vec3_unit(vec3_cross(vec3_sub(v[1], v[0]), vec3_sub(v[2], v[0])));
    const double slack = PLACE_ROUNDING * s->largest_coordinate;
    vec3_frame(normal, &x, &y);
    for (uint32_t i = begin; i < end; i++) {
        const Surface *surface = &s->surface[piece[i].surface];
        const Surface *first = &s->surface[piece[begin].surface];
        const int      corners = corners_of(s, piece[i].surface, v);
        if (surface->material != first->material || surface->back_material != first->back_material)
            return false;
        area += surface->area;
        for (int k = 0; k < corners; k++) {
            const Vec3 d = vec3_sub(v[k], origin);
            if (fabs(vec3_dot(d, normal)) > slack)
                return false;
            flat[count++] = (Flat){ vec3_dot(d, x), vec3_dot(d, y), v[k] };
        }
    }
    qsort(flat, count, sizeof *flat, compare_flat);
    *face = (LampFace){ .begin = begin, .end = end };
    return outline(flat, count, area, slack, flat + count, face);
}

static bool shines(const Room *room, uint32_t surface, unsigned side)
{
    return room->surfaces->surface[surface].kind != SURFACE_SHAPE &&
           (room->emitting[surface] >> side & 1) != 0;
}

static bool list_pieces(LampFaces *faces, const Room *room, Error *err)
{
    const Surfaces *s = room->surfaces;
    for (uint32_t i = 0; i < s->count; i++)
        faces->piece_count += shines(room, i, 0) + shines(room, i, 1);
    faces->piece = array_create(faces->piece_count, sizeof *faces->piece, "lamps", err);
    faces->face = array_create(faces->piece_count / 2, sizeof *faces->face, "lamps", err);
    if (error_is_set(err))
        return false;
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->count; i++)
        for (unsigned side = 0; side < 2; side++)
            if (shines(room, i, side))
                faces->piece[count++] = (LampPiece){ s->surface[i].face, side, i };
    qsort(faces->piece, count, sizeof *faces->piece, compare_pieces);
    return true;
}

bool lamp_faces_find(LampFaces *faces, const Room *room, Error *err)
{
    assert(faces != NULL && room != NULL);
    *faces = (LampFaces){ 0 };
    if (!list_pieces(faces, room, err))
        return false;
    const LampPiece *piece = faces->piece;
    /* Corners, and their hull. */
    Flat *flat = array_create(8 * (size_t)faces->piece_count + 2, sizeof *flat, "lamps", err);
    for (uint32_t i = 0, end; flat != NULL && i < faces->piece_count; i = end) {
        for (end = i + 1; end < faces->piece_count && piece[end].face == piece[i].face &&
                          piece[end].side == piece[i].side; end++)
            ;
        if (end - i > 1 && fill_face(room->surfaces, piece, i, end, flat,
                                     &faces->face[faces->face_count]))
            faces->face_count++;
    }
    array_free(flat);
    return !error_is_set(err);
}

void lamp_faces_clear(LampFaces *faces)
{
    array_free(faces->piece);
    array_free(faces->face);
    *faces = (LampFaces){ 0 };
}
