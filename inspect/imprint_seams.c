/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_seams.c -- pieces made to meet edge to edge, and edges below others marked. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"

static const char what[] = "pieces of faces";

typedef struct {
    uint32_t point;
    double   along;
} Insert;

typedef struct {
    const Vec3        *position;
    const ImprintLine *line;
    uint32_t           lines;
    double             tolerance;
    int                axis;      /* the one along which the pieces reach furthest */
    uint32_t          *order;     /* [lines]  barriers, by their lower ends along the axis */
    uint32_t           barriers;
    double             longest;   /* of them, along the axis */
    uint32_t          *point;     /* [points]  corners of all pieces, each once, along the axis */
    uint32_t           points;
    Insert            *insert;    /* [points] */
    uint32_t          *corner;    /* of the piece being made */
    uint8_t           *contact;
    size_t             corner_capacity, contact_capacity;
} Seams;

static double distance_to(Vec3 p, Vec3 a, Vec3 b, double *along)
{
    const Vec3 way = vec3_sub(b, a);
    const double square = vec3_dot(way, way);
    *along = square > 0 ? vec3_dot(vec3_sub(p, a), way) / square : 0;
    const double t = fmin(fmax(*along, 0), 1);
    return vec3_length(vec3_sub(p, vec3_mad(a, t, way)));
}

static double along_axis(const Seams *s, Vec3 p)
{
    return s->axis == 0 ? p.x : s->axis == 1 ? p.y : p.z;
}

static double line_begin(const Seams *s, uint32_t line)
{
    return fmin(along_axis(s, s->line[line].end[0]), along_axis(s, s->line[line].end[1]));
}

/* The first point, or barrier, at `from` or beyond. */
static uint32_t first_beyond(const Seams *s, bool barriers, double from)
{
    uint32_t low = 0, high = barriers ? s->barriers : s->points;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        const double at = barriers ? line_begin(s, s->order[middle])
                                   : along_axis(s, s->position[s->point[middle]]);
        if (at < from)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Points strictly inside an edge, in order from a to b. */
static uint32_t find_inserts(Seams *s, uint32_t a, uint32_t b)
{
    uint32_t n = 0;
    const Vec3 p = s->position[a], q = s->position[b];
    const Vec3 rim = vec3(s->tolerance, s->tolerance, s->tolerance);
    const Vec3 lo = vec3_sub(vec3_min(p, q), rim), hi = vec3_add(vec3_max(p, q), rim);
    const double begin = along_axis(s, lo), end = along_axis(s, hi);
    for (uint32_t k = first_beyond(s, false, begin); k < s->points; k++) {
        const Vec3 x = s->position[s->point[k]];
        if (along_axis(s, x) > end)
            break;
        if (x.x < lo.x || x.y < lo.y || x.z < lo.z || x.x > hi.x || x.y > hi.y || x.z > hi.z)
            continue;
        double along;
        if (s->point[k] == a || s->point[k] == b || distance_to(x, p, q, &along) > s->tolerance
            || vec3_length(vec3_sub(x, p)) <= s->tolerance
            || vec3_length(vec3_sub(x, q)) <= s->tolerance)
            continue;
        uint32_t at = n++;
        for (; at > 0 && s->insert[at - 1].along > along; at--)
            s->insert[at] = s->insert[at - 1];
        s->insert[at] = (Insert){ s->point[k], along };
    }
    return n;
}

static bool lies_under(const Seams *s, uint32_t a, uint32_t b)
{
    const Vec3 middle = vec3_lerp(s->position[a], s->position[b], 0.5);
    double along;
    const double at = along_axis(s, middle);
    uint32_t k = first_beyond(s, true, at - s->longest - s->tolerance);
    for (; k < s->barriers && line_begin(s, s->order[k]) <= at + s->tolerance; k++) {
        const ImprintLine *line = &s->line[s->order[k]];
        if (distance_to(middle, line->end[0], line->end[1], &along) <= s->tolerance)
            return true;
    }
    return false;
}

static bool push(Seams *s, uint32_t *count, uint32_t point, Error *err)
{
    if (!array_reserve((void **)&s->corner, &s->corner_capacity, (size_t)*count + 1,
                       sizeof *s->corner, what, err)
        || !array_reserve((void **)&s->contact, &s->contact_capacity, (size_t)*count + 1,
                          sizeof *s->contact, what, err))
        return false;
    s->corner[(*count)++] = point;
    return true;
}

static bool seam_piece(Seams *s, const uint32_t *corner, uint32_t count, ImprintPieces *out,
                       Error *err)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t inserts = find_inserts(s, corner[k], corner[(k + 1) % count]);
        if (!push(s, &n, corner[k], err))
            return false;
        for (uint32_t i = 0; i < inserts; i++)
            if (!push(s, &n, s->insert[i].point, err))
                return false;
    }
    for (uint32_t k = 0; k < n; k++)
        s->contact[k] = lies_under(s, s->corner[k], s->corner[(k + 1) % n]);
    return imprint_pieces_add(out, s->corner, s->contact, n, err);
}

typedef struct {
    double   along;
    uint32_t item;
} Place;

static int by_place(const void *a, const void *b)
{
    const Place *x = a, *y = b;
    if (x->along != y->along)
        return x->along < y->along ? -1 : 1;
    return (x->item > y->item) - (x->item < y->item);
}

/* Sorts the items along the axis; returns how many there are, each once. */
static uint32_t sort_places(Place *place, uint32_t count, uint32_t *item)
{
    uint32_t n = 0;
    qsort(place, count, sizeof *place, by_place);
    for (uint32_t k = 0; k < count; k++)
        if (k == 0 || place[k].item != place[k - 1].item)
            item[n++] = place[k].item;
    return n;
}

static int longest_axis(const ImprintPieces *pieces, uint32_t corners, const Vec3 *position)
{
    Vec3 lo = { INFINITY, INFINITY, INFINITY }, hi = { -INFINITY, -INFINITY, -INFINITY };
    for (uint32_t k = 0; k < corners; k++) {
        lo = vec3_min(lo, position[pieces->corner[k]]);
        hi = vec3_max(hi, position[pieces->corner[k]]);
    }
    const Vec3 size = vec3_sub(hi, lo);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

static bool gather(Seams *s, const ImprintPieces *pieces, Error *err)
{
    const uint32_t corners = pieces->count > 0 ? pieces->first[pieces->count] : 0;
    Place *place = array_create((size_t)corners + s->lines, sizeof *place, what, err);
    s->point = array_create(corners, sizeof *s->point, what, err);
    s->insert = array_create(corners, sizeof *s->insert, what, err);
    s->order = array_create(s->lines, sizeof *s->order, what, err);
    if (!error_is_set(err)) {
        s->axis = longest_axis(pieces, corners, s->position);
        for (uint32_t k = 0; k < corners; k++)
            place[k] = (Place){ along_axis(s, s->position[pieces->corner[k]]), pieces->corner[k] };
        s->points = sort_places(place, corners, s->point);
        uint32_t barriers = 0;
        for (uint32_t k = 0; k < s->lines; k++) {
            const Vec3 *end = s->line[k].end;
            if (!s->line[k].barrier)
                continue;
            place[barriers++] = (Place){ line_begin(s, k), k };
            s->longest = fmax(s->longest, fabs(along_axis(s, end[0]) - along_axis(s, end[1])));
        }
        s->barriers = sort_places(place, barriers, s->order);
    }
    array_free(place);
    return !error_is_set(err);
}

bool imprint_seams(const ImprintPieces *pieces, const Vec3 *position, const ImprintLine *line,
                   uint32_t lines, double tolerance, ImprintPieces *out, Error *err)
{
    assert(pieces != NULL && position != NULL && out != NULL);
    Seams s = { .position = position, .line = line, .lines = lines, .tolerance = tolerance };
    bool ok = gather(&s, pieces, err);
    for (uint32_t k = 0; ok && k < pieces->count; k++)
        ok = seam_piece(&s, pieces->corner + pieces->first[k],
                        pieces->first[k + 1] - pieces->first[k], out, err);
    array_free(s.point);
    array_free(s.order);
    array_free(s.insert);
    array_free(s.corner);
    array_free(s.contact);
    return ok;
}
