/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches around a vertex, and the plane laid through their values. */
#include "radiosity/vertex_fit.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/mean_value.h"

/* Around a vertex with more patches than this (a pole), they are not all neighbours of each other:
 * the pairs would be many, and what lies opposite is no neighbour. */
enum { VALENCE_MAX = 32 };
/* Neighbours that one patch at the vertex brings in. */
enum { BRING_MAX = 24 };

/* A patch's centre is no nearer to a vertex than this share of the patch's extent, so that a vertex
 * at the middle of a merged patch does not see that one alone. */
static const double NEAREST = 0.25;
/* Patches more than eight times as long as wide (twice this) count the less the thinner they are:
 * what a sliver in a gap receives says little of what lies around it. */
static const double SLIVER = 4;
/* The plane is followed outwards up to so many times the spread of the centres in that direction:
 * less than 2.5 at the rim of any grid; further out it is bent back to level. */
static const double REACH = 3;
/* Centres surround a vertex when it is no further from their mean than their spread. */
static const double SURROUNDED = 1;

/* --- who is around ---------------------------------------------------------------------------- */

typedef void (*CornerVisit)(VertexFit *fit, uint32_t patch, uint32_t vertex, uint32_t *end);

/* All corners of all patches, in order. */
static void visit_corners(VertexFit *fit, CornerVisit visit, uint32_t *end)
{
    const Patches *p = fit->patches;
    for (uint32_t i = 0; i < p->count; i++) {
        const uint32_t face = p->face_of[i], faces = vertex_fit_faces(p, i);
        for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + faces]; k++)
            visit(fit, i, p->corner[k], end);
    }
}

static void count_corner(VertexFit *fit, uint32_t patch, uint32_t vertex, uint32_t *last)
{
    assert(vertex < fit->patches->vertex_count);
    if (last[vertex] != patch)
        fit->first_patch[vertex + 1]++;
    last[vertex] = patch;
}

static void put_corner(VertexFit *fit, uint32_t patch, uint32_t vertex, uint32_t *end)
{
    const uint32_t at = end[vertex];
    if (at == fit->first_patch[vertex] || fit->patch[at - 1] != patch)
        fit->patch[end[vertex]++] = patch;
}

static bool find_patches(VertexFit *fit, Error *err)
{
    const uint32_t n = fit->patches->vertex_count;
    uint32_t *end = array_create(n, sizeof *end, "vertex fit", err);
    fit->first_patch = array_create((size_t)n + 1, sizeof *fit->first_patch, "vertex fit", err);
    if (end == NULL || fit->first_patch == NULL) {
        array_free(end);
        return false;
    }
    for (uint32_t v = 0; v < n; v++)
        end[v] = PATCH_NONE;
    visit_corners(fit, count_corner, end);
    for (uint32_t v = 0; v < n; v++) {
        end[v] = fit->first_patch[v];
        fit->first_patch[v + 1] += end[v];
    }
    fit->patch = array_create(fit->first_patch[n], sizeof *fit->patch, "vertex fit", err);
    if (fit->patch != NULL)
        visit_corners(fit, put_corner, end);
    array_free(end);
    return fit->patch != NULL;
}

/* Visible patches that share a vertex with patch i, each once, to near[at..]; returns where they
 * end. near NULL: only counts. */
static uint32_t list_near(const VertexFit *fit, uint32_t i, uint32_t *seen, uint32_t *near,
                          uint32_t at)
{
    const Patches *p = fit->patches;
    const uint32_t face = p->face_of[i], faces = vertex_fit_faces(p, i);
    seen[i] = i;
    for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + faces]; k++) {
        const uint32_t v = p->corner[k], end = fit->first_patch[v + 1];
        if (end - fit->first_patch[v] > VALENCE_MAX)
            continue;
        for (uint32_t m = fit->first_patch[v]; m < end; m++) {
            const uint32_t j = fit->patch[m];
            if (seen[j] == i || !(fit->area[j] > 0))
                continue;
            seen[j] = i;
            if (near != NULL)
                near[at] = j;
            at++;
        }
    }
    return at;
}

static bool find_near(VertexFit *fit, Error *err)
{
    const uint32_t n = fit->patches->count;
    uint32_t *seen = array_create(n, sizeof *seen, "vertex fit", err);
    fit->first_near = array_create((size_t)n + 1, sizeof *fit->first_near, "vertex fit", err);
    if (seen != NULL && fit->first_near != NULL) {
        for (unsigned pass = 0; pass < 2 && !error_is_set(err); pass++) {
            for (uint32_t i = 0; i < n; i++)
                seen[i] = PATCH_NONE;
            for (uint32_t i = 0; i < n; i++)
                fit->first_near[i + 1] = list_near(fit, i, seen, fit->near, fit->first_near[i]);
            if (pass == 0)
                fit->near = array_create(fit->first_near[n], sizeof *fit->near, "vertex fit", err);
        }
    }
    array_free(seen);
    return !error_is_set(err);
}

/* The centre of a merged patch lies on one of its pieces; here the mean of all is wanted. */
static Vec3 merged_centre(const Patches *p, uint32_t patch)
{
    const uint32_t face = p->face_of[patch], faces = vertex_fit_faces(p, patch);
    Vec3 sum = { 0, 0, 0 };
    double area = 0;
    for (uint32_t f = face; f < face + faces; f++) {
        const uint32_t *corner = p->corner + p->first_corner[f];
        const uint32_t n = p->first_corner[f + 1] - p->first_corner[f];
        const Vec3 a = p->position[corner[0]];
        for (uint32_t k = 1; k + 1 < n; k++) {
            const Vec3 b = p->position[corner[k]], c = p->position[corner[k + 1]];
            const double part = vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a)));
            sum = vec3_mad(sum, part / 3, vec3_add(a, vec3_add(b, c)));
            area += part;
        }
    }
    return area > 0 ? vec3_scale(sum, 1 / area) : p->centre[patch];
}

/* Area of a square that reaches as far from its centre as the patch; a merged patch counts as one
 * itself. */
static double square_around(const VertexFit *fit, uint32_t patch)
{
    const Patches *p = fit->patches;
    const uint32_t face = p->face_of[patch];
    double most = 0;
    if (p->first_piece[patch] < p->first_piece[patch + 1])
        return p->area[patch];
    for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + 1]; k++) {
        const Vec3 way = vec3_sub(p->position[p->corner[k]], fit->centre[patch]);
        most = fmax(most, vec3_dot(way, way));
    }
    return 2 * most;
}

bool vertex_fit_create(VertexFit *fit, const Patches *patches, const double *area, Error *err)
{
    *fit = (VertexFit){ .patches = patches, .area = area };
    fit->centre = array_create(patches->count, sizeof *fit->centre, "vertex fit", err);
    fit->extent = array_create(patches->count, sizeof *fit->extent, "vertex fit", err);
    if (error_is_set(err) || !find_patches(fit, err) || !find_near(fit, err))
        return false;
    for (uint32_t i = 0; i < patches->count; i++) {
        fit->centre[i] = patches->first_piece[i] < patches->first_piece[i + 1]
                             ? merged_centre(patches, i) : patches->centre[i];
        fit->extent[i] = square_around(fit, i);
    }
    return true;
}

void vertex_fit_clear(VertexFit *fit)
{
    array_free(fit->centre);
    array_free(fit->extent);
    array_free(fit->first_patch);
    array_free(fit->patch);
    array_free(fit->first_near);
    array_free(fit->near);
    *fit = (VertexFit){ 0 };
}

/* --- the plane -------------------------------------------------------------------------------- */

typedef struct {
    FitRow *row;
    double  x[FIT_MAX], y[FIT_MAX];  /* centres seen from the vertex, rolled out flat */
    double  total;                   /* of row->weight */
    double  mx, my;                  /* weighted mean of the centres */
    double  xx, xy, yy;              /* and their second moments about it */
} Plane;

static void plane_add(Plane *plane, uint32_t patch)
{
    FitRow *row = plane->row;
    for (uint32_t k = 0; k < row->count; k++)
        if (row->patch[k] == patch)
            return;
    if (row->count < FIT_MAX)
        row->patch[row->count++] = patch;
}

/* Of `count` entries of list, up to `most` that lie evenly in it. */
static void plane_add_some(Plane *plane, const VertexFit *fit, const uint32_t *list, uint32_t count,
                           uint32_t most)
{
    const uint32_t taken = count < most ? count : most;
    for (uint32_t k = 0; k < taken; k++) {
        const uint32_t patch = list[(uint64_t)k * count / taken];
        if (fit->area[patch] > 0)
            plane_add(plane, patch);
    }
}

/* Neighbours of all patches at the vertex, hidden ones' as well. */
static void plane_widen(Plane *plane, const VertexFit *fit, uint32_t vertex)
{
    const uint32_t first = fit->first_patch[vertex], end = fit->first_patch[vertex + 1];
    const bool any = plane->row->count > 0;
    for (uint32_t m = first; m < end && plane->row->count < FIT_MAX; m++) {
        const uint32_t i = fit->patch[m];
        if (any && !(fit->area[i] > 0))
            continue;
        plane_add_some(plane, fit, fit->near + fit->first_near[i],
                       fit->first_near[i + 1] - fit->first_near[i], BRING_MAX);
    }
}

/* Places and weights of the patches, and their moments. */
static void plane_measure(Plane *plane, const VertexFit *fit, uint32_t vertex)
{
    const Patches *p = fit->patches;
    const Vec3 at = p->position[vertex];
    FitRow *row = plane->row;
    Vec3 normal = { 0, 0, 0 }, s, t;
    for (uint32_t k = 0; k < row->count; k++)
        normal = vec3_mad(normal, p->area[row->patch[k]], p->normal[row->patch[k]]);
    normal = vec3_unit(normal);
    vec3_frame(normal, &s, &t);
    plane->total = plane->mx = plane->my = plane->xx = plane->xy = plane->yy = 0;
    for (uint32_t k = 0; k < row->count; k++) {
        const uint32_t i = row->patch[k];
        const Vec3 d = vec3_sub(fit->centre[i], at);
        const double x = vec3_dot(d, s), y = vec3_dot(d, t), flat = sqrt(x * x + y * y);
        const double square = vec3_dot(d, d), roll = flat > 0 ? sqrt(square) / flat : 0;
        const double seen = fmin(fit->area[i] / p->area[i], 1);
        plane->x[k] = roll * x;
        plane->y[k] = roll * y;
        const double extent = fit->extent[i], broad = fmin(SLIVER * p->area[i] / extent, 1);
        row->weight[k] = seen * broad / (square + NEAREST * NEAREST * extent);
        plane->total += row->weight[k];
        plane->mx += row->weight[k] * plane->x[k];
        plane->my += row->weight[k] * plane->y[k];
    }
    plane->mx /= plane->total;
    plane->my /= plane->total;
    for (uint32_t k = 0; k < row->count; k++) {
        const double share = row->weight[k] /= plane->total;
        const double x = plane->x[k] -= plane->mx, y = plane->y[k] -= plane->my;
        plane->xx += share * x * x;
        plane->xy += share * x * y;
        plane->yy += share * y * y;
    }
}

/* A main direction of the centres: where the vertex lies along it, seen from their mean, and their
 * variance. */
typedef struct {
    double x, y, away, variance;
} Direction;

static void plane_directions(const Plane *plane, Direction direction[2])
{
    const double half = (plane->xx - plane->yy) / 2;
    const double mean = (plane->xx + plane->yy) / 2, radius = hypot(half, plane->xy);
    const double angle = atan2(plane->xy, half) / 2;
    const double x = cos(angle), y = sin(angle);
    direction[0] = (Direction){ x, y, -(x * plane->mx + y * plane->my), mean + radius };
    /* Not mean - radius, which cancels. */
    const double other = (plane->xx * plane->yy - plane->xy * plane->xy) / (mean + radius);
    direction[1] = (Direction){ -y, x, y * plane->mx - x * plane->my, fmax(other, 0) };
}

static bool plane_surrounds(const Plane *plane)
{
    Direction d[2];
    if (plane->row->count < 3 || !(plane->xx + plane->yy > 0))
        return false;
    plane_directions(plane, d);
    return d[0].away * d[0].away <= SURROUNDED * d[0].variance
        && d[1].away * d[1].away <= SURROUNDED * d[1].variance;
}

/* Weights become those of the plane's value at the vertex. */
static void plane_solve(Plane *plane)
{
    FitRow *row = plane->row;
    Direction direction[2];
    double factor[2] = { 0, 0 };
    if (!(plane->xx + plane->yy > 0))
        return;
    plane_directions(plane, direction);
    for (int e = 0; e < 2; e++) {
        const Direction *d = &direction[e];
        const double square = d->away * d->away, most = REACH * REACH * d->variance;
        if (most > 0)
            factor[e] = d->away / d->variance * (square > most ? most / square : 1);
    }
    for (uint32_t k = 0; k < row->count; k++) {
        double scale = 1;
        for (int e = 0; e < 2; e++)
            scale += factor[e] * (direction[e].x * plane->x[k] + direction[e].y * plane->y[k]);
        row->weight[k] *= scale;
    }
}

void vertex_fit_row(const VertexFit *fit, uint32_t vertex, FitRow *row)
{
    assert(vertex < fit->patches->vertex_count);
    Plane plane = { .row = row };
    const uint32_t first = fit->first_patch[vertex];
    row->count = 0;
    plane_add_some(&plane, fit, fit->patch + first, fit->first_patch[vertex + 1] - first, FIT_MAX);
    const bool own = row->count > 0;
    if (own)
        plane_measure(&plane, fit, vertex);
    row->inside = own && plane_surrounds(&plane);
    if (!row->inside) {
        plane_widen(&plane, fit, vertex);
        if (row->count > 0)
            plane_measure(&plane, fit, vertex);
    }
    /* Where all is hidden, nothing may be made up by extrapolation. */
    if (own)
        plane_solve(&plane);
}
