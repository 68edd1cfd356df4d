/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons to triangles: each polygon once, nothing without area. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/internal.h"
#include "mesh/triangulate.h"

/* In Cutter.back: the polygon has no area. */
#define FACE_EMPTY (PIECE_NONE - 1)

typedef struct {
    const Weld   *weld;
    Repair       *repair;
    Triangulation cut;
    VertexSets    sets;
    uint32_t     *corner;  /* welded corners of one polygon */
    uint32_t     *earlier; /* and of another */
    uint64_t     *sorted;  /* room for sorting as many */
    uint32_t     *back;    /* [polygons]  polygon that is its other side, or PIECE_NONE */
    uint32_t     *front;   /* [polygons]  itself, or what lies on it and takes its place */
} Cutter;

static bool pieces_reserve(Pieces *pieces, size_t count, Error *err)
{
    return array_reserve((void **)&pieces->corner, &pieces->corner_capacity, 3 * count,
                         sizeof *pieces->corner, "triangles", err)
        && array_reserve((void **)&pieces->face, &pieces->face_capacity, count,
                         sizeof *pieces->face, "triangles", err)
        && array_reserve((void **)&pieces->back, &pieces->back_capacity, count,
                         sizeof *pieces->back, "triangles", err)
        && array_reserve((void **)&pieces->diagonal, &pieces->diagonal_capacity, count,
                         sizeof *pieces->diagonal, "triangles", err)
        && array_reserve((void **)&pieces->other, &pieces->other_capacity, count,
                         sizeof *pieces->other, "triangles", err);
}

static bool pieces_append(Pieces *pieces, const Triangulation *cut, uint32_t face, Error *err)
{
    if (!pieces_reserve(pieces, (size_t)pieces->count + cut->count, err))
        return false;
    for (uint32_t k = 0; k < cut->count; k++) {
        const uint32_t i = pieces->count++;
        memcpy(pieces->corner + 3 * (size_t)i, cut->triangle + 3 * (size_t)k,
               3 * sizeof *pieces->corner);
        pieces->face[i] = face;
        pieces->back[i] = PIECE_NONE;
        /* (a,b,c) meets (a,c,d) at its last edge, (a,c,d) at its first */
        pieces->diagonal[i] = cut->quad ? 3 * i + (k == 0 ? 2 : 0) : PIECE_NONE;
        pieces->other[i] = !cut->quad ? PIECE_NONE : k == 0 ? i + 1 : i - 1;
    }
    return true;
}

/* Welded corners of a polygon; false when one is not a finite point. */
static bool face_corners(const Cutter *cutter, uint32_t face, uint32_t *corner, uint32_t *count)
{
    const Polygons *soup = cutter->repair->soup;
    *count = soup->first[face + 1] - soup->first[face];
    bool finite = true;
    for (uint32_t i = 0; i < *count; i++) {
        corner[i] = cutter->weld->vertex[soup->corner[soup->first[face] + i]];
        finite = finite && corner[i] != WELD_NONE;
    }
    return finite;
}

/* A defect of one face alone, at its first corner that is a point. */
static bool report_face(const Cutter *cutter, DefectKind kind, bool repaired, uint32_t face,
                        double measure)
{
    const Polygons *soup = cutter->repair->soup;
    Vec3 at = { 0 };
    for (uint32_t i = soup->first[face + 1]; i-- > soup->first[face];)
        if (vec3_finite(soup->position[soup->corner[i]]))
            at = soup->position[soup->corner[i]];
    return repair_report(cutter->repair, &(Defect){
        .kind = kind, .repaired = repaired, .face = face, .other = DEFECT_NO_FACE, .at = at,
        .measure = measure });
}

/* A polygon that may have the outline of an earlier one: its other side, or one too many. True when
 * nothing is left to be done about it. */
static bool lay_face(Cutter *cutter, uint32_t face, uint32_t earlier)
{
    uint32_t count;
    face_corners(cutter, earlier, cutter->earlier, &count);
    const bool reverse = outline_is_same(cutter->corner, cutter->earlier, count, true);
    if (!reverse && !outline_is_same(cutter->corner, cutter->earlier, count, false))
        return false; /* the same corners in another order */
    if (cutter->back[earlier] == FACE_EMPTY) {
        cutter->repair->repairs.degenerate++;
        report_face(cutter, DEFECT_DEGENERATE, true, face, 0);
        return true;
    }
    const bool merge = !cutter->repair->options->keep_duplicates;
    const bool back = reverse && cutter->back[earlier] == PIECE_NONE;
    const Vec3 at = cutter->weld->position[cutter->corner[0]];
    uint32_t *below = reverse ? &cutter->back[earlier] : &cutter->front[earlier];
    if (back)
        repair_report(cutter->repair, &(Defect){ .kind = DEFECT_BACK_TO_BACK, .repaired = merge,
                                                 .face = face, .other = earlier, .at = at });
    const bool takes = back || repair_report_double(cutter->repair, face, *below, merge, at);
    if (takes && merge)
        *below = face;
    cutter->repair->repairs.duplicate += merge && !back;
    return merge;
}

/* How far corners are off the plane through their middle; 0 when no more than by rounding: corners
 * and plane, which comes from them, are known to a tolerance each. */
static double off_plane(const Vec3 *position, const uint32_t *corner, uint32_t count)
{
    Vec3 middle = { 0 };
    double largest = 0, farthest = 0;
    for (uint32_t i = 0; i < count; i++) {
        const Vec3 p = position[corner[i]];
        middle = vec3_mad(middle, 1.0 / count, p);
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    const Vec3 normal = vec3_unit(triangulate_normal(position, corner, count));
    for (uint32_t i = 0; i < count; i++)
        farthest = fmax(farthest, fabs(vec3_dot(normal, vec3_sub(position[corner[i]], middle))));
    return farthest > 2 * position_tolerance(largest) ? farthest : 0;
}

static bool report_cut(const Cutter *cutter, uint32_t face, uint32_t count)
{
    const Triangulation *cut = &cutter->cut;
    Repair *repair = cutter->repair;
    repair->repairs.degenerate += cut->dropped;
    if (cut->count == 0) {
        cutter->back[face] = FACE_EMPTY;
        return report_face(cutter, DEFECT_DEGENERATE, true, face, 0);
    }
    if (cut->crossing)
        return report_face(cutter, DEFECT_CROSSING, false, face, 0);
    const double off = count <= 3 ? 0 : off_plane(cutter->weld->position, cutter->corner, count);
    return off == 0 || report_face(cutter, DEFECT_NONPLANAR, true, face, off);
}

static bool cut_face(Cutter *cutter, uint32_t face, Pieces *pieces)
{
    Error *err = cutter->repair->err;
    uint32_t count;
    if (!face_corners(cutter, face, cutter->corner, &count)) {
        cutter->repair->repairs.degenerate++;
        return report_face(cutter, DEFECT_NONFINITE, false, face, 0);
    }
    /* Triangles are compared when all is cut, with those that polygons were cut into. */
    const uint32_t earlier = count <= 3 ? PIECE_NONE
                                        : sets_add(&cutter->sets, cutter->corner, count, face,
                                                   cutter->sorted);
    if (earlier != PIECE_NONE && lay_face(cutter, face, earlier))
        return !error_is_set(err);
    return triangulate(&cutter->cut, cutter->weld->position, cutter->corner, count, err)
        && report_cut(cutter, face, count) && pieces_append(pieces, &cutter->cut, face, err);
}

static void cutter_clear(Cutter *cutter)
{
    triangulation_clear(&cutter->cut);
    sets_clear(&cutter->sets);
    array_free(cutter->corner);
    array_free(cutter->earlier);
    array_free(cutter->sorted);
    array_free(cutter->back);
    array_free(cutter->front);
}

static bool cutter_create(Cutter *cutter)
{
    const Polygons *soup = cutter->repair->soup;
    Error *err = cutter->repair->err;
    const uint32_t faces = (uint32_t)soup->polygon_count;
    uint32_t most = 3;
    for (uint32_t i = 0; i < faces; i++)
        if (soup->first[i + 1] - soup->first[i] > most)
            most = soup->first[i + 1] - soup->first[i];
    cutter->corner = array_create(most, sizeof *cutter->corner, "polygon corners", err);
    cutter->earlier = array_create(most, sizeof *cutter->earlier, "polygon corners", err);
    cutter->sorted = array_create(most, sizeof *cutter->sorted, "polygon corners", err);
    cutter->back = array_create(faces, sizeof *cutter->back, "polygon backs", err);
    cutter->front = array_create(faces, sizeof *cutter->front, "polygon backs", err);
    if (!sets_create(&cutter->sets, faces, faces > 0 ? soup->first[faces] : 0, err))
        return false;
    for (uint32_t i = 0; i < faces; i++) {
        cutter->back[i] = PIECE_NONE;
        cutter->front[i] = i;
    }
    return true;
}

bool pieces_create(Pieces *pieces, const Weld *weld, Repair *repair)
{
    assert(pieces != NULL && weld != NULL && repair != NULL);
    const Polygons *soup = repair->soup;
    assert(soup->polygon_count < UINT32_MAX / 3);
    *pieces = (Pieces){ 0 };
    Cutter cutter = { .weld = weld, .repair = repair };
    bool ok = cutter_create(&cutter);
    for (uint32_t i = 0; ok && i < soup->polygon_count; i++)
        ok = cut_face(&cutter, i, pieces);
    for (uint32_t i = 0; ok && i < pieces->count; i++) {
        pieces->back[i] = cutter.back[pieces->face[i]];
        pieces->face[i] = cutter.front[pieces->face[i]];
    }
    cutter_clear(&cutter);
    ok = ok && pieces_merge_triangles(pieces, weld->position, repair);
    if (!ok)
        pieces_clear(pieces);
    return ok;
}

void pieces_clear(Pieces *pieces)
{
    array_free(pieces->corner);
    array_free(pieces->face);
    array_free(pieces->back);
    array_free(pieces->diagonal);
    array_free(pieces->other);
    *pieces = (Pieces){ 0 };
}
