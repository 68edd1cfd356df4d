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
    uint32_t          *point;     /* [points]  corners of all pieces, each once */
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

/* Points strictly inside an edge, in order from a to b. */
static uint32_t find_inserts(Seams *s, uint32_t a, uint32_t b)
{
    uint32_t n = 0;
    const Vec3 p = s->position[a], q = s->position[b];
    const Vec3 rim = vec3(s->tolerance, s->tolerance, s->tolerance);
    const Vec3 lo = vec3_sub(vec3_min(p, q), rim), hi = vec3_add(vec3_max(p, q), rim);
    for (uint32_t k = 0; k < s->points; k++) {
        const Vec3 x = s->position[s->point[k]];
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
    for (uint32_t k = 0; k < s->lines; k++)
        if (s->line[k].barrier
            && distance_to(middle, s->line[k].end[0], s->line[k].end[1], &along) <= s->tolerance)
            return true;
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

static int by_number(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static bool gather_points(Seams *s, const ImprintPieces *pieces, Error *err)
{
    const uint32_t corners = pieces->count > 0 ? pieces->first[pieces->count] : 0;
    s->point = array_create(corners, sizeof *s->point, what, err);
    s->insert = array_create(corners, sizeof *s->insert, what, err);
    if (error_is_set(err))
        return false;
    for (uint32_t k = 0; k < corners; k++)
        s->point[k] = pieces->corner[k];
    qsort(s->point, corners, sizeof *s->point, by_number);
    for (uint32_t k = 0; k < corners; k++)
        if (k == 0 || s->point[k] != s->point[s->points - 1])
            s->point[s->points++] = s->point[k];
    return true;
}

bool imprint_seams(const ImprintPieces *pieces, const Vec3 *position, const ImprintLine *line,
                   uint32_t lines, double tolerance, ImprintPieces *out, Error *err)
{
    assert(pieces != NULL && position != NULL && out != NULL);
    Seams s = { .position = position, .line = line, .lines = lines, .tolerance = tolerance };
    bool ok = gather_points(&s, pieces, err);
    for (uint32_t k = 0; ok && k < pieces->count; k++)
        ok = seam_piece(&s, pieces->corner + pieces->first[k],
                        pieces->first[k + 1] - pieces->first[k], out, err);
    array_free(s.point);
    array_free(s.insert);
    array_free(s.corner);
    array_free(s.contact);
    return ok;
}
