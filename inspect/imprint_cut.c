/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_cut.c -- a flat convex polygon cut by lines into convex pieces. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"
#include "mesh/triangulate.h"

/* Lines go on across the whole part when no more than this many pieces come of it: some, and some
 * for each line. Four table legs in line make 8 lines and 25 pieces. */
enum { WHOLE_PIECES = 32, WHOLE_PER_LINE = 4 };

static const char what[] = "pieces of faces";

typedef struct {
    Vec3 p, across; /* a point of the line; unit, in the part's plane */
} Line;

static Line line_through(const ImprintKnife *knife, const ImprintLine *l)
{
    const Vec3 way = vec3_sub(l->end[1], l->end[0]);
    return (Line){ l->end[0], vec3_unit(vec3_cross(knife->part->normal, way)) };
}

/* --- points ----------------------------------------------------------------------------------- */

static bool know(ImprintKnife *knife, uint32_t point)
{
    if (!array_reserve((void **)&knife->known, &knife->known_capacity, knife->known_count + 1,
                       sizeof *knife->known, what, knife->err))
        return false;
    knife->known[knife->known_count++] = point;
    return true;
}

/* The known point at p, or a new one. */
static bool point_at(ImprintKnife *knife, Vec3 p, uint32_t *point)
{
    const double tolerance = knife->part->tolerance;
    ImprintPoints *points = knife->points;
    for (size_t k = 0; k < knife->known_count; k++)
        if (vec3_length(vec3_sub(points->position[knife->known[k]], p)) <= tolerance) {
            *point = knife->known[k];
            return true;
        }
    if (points->count >= UINT32_MAX - 1)
        return error_set(knife->err, ERROR_INPUT, "more than 2^32 vertices");
    if (!array_reserve((void **)&points->position, &points->capacity, points->count + 1,
                       sizeof *points->position, what, knife->err))
        return false;
    points->position[points->count] = p;
    *point = (uint32_t)points->count++;
    return know(knife, *point);
}

/* Where the edge from point a to point b, at heights ha and hb, meets height 0; the same from both
 * pieces that have the edge. */
static bool crossing(ImprintKnife *knife, uint32_t a, uint32_t b, double ha, double hb,
                     uint32_t *point)
{
    const Vec3 *position = knife->points->position;
    const Vec3 p = a < b ? vec3_lerp(position[a], position[b], ha / (ha - hb))
                         : vec3_lerp(position[b], position[a], hb / (hb - ha));
    return point_at(knife, p, point);
}

/* --- splitting -------------------------------------------------------------------------------- */

static bool reserve_ring(ImprintKnife *knife, uint32_t count)
{
    /* A line adds two corners to a half at most. */
    return array_reserve((void **)&knife->height, &knife->height_capacity, count,
                         sizeof *knife->height, what, knife->err)
        && array_reserve((void **)&knife->half[0], &knife->half_capacity[0], count + 2,
                         sizeof *knife->half[0], what, knife->err)
        && array_reserve((void **)&knife->half[1], &knife->half_capacity[1], count + 2,
                         sizeof *knife->half[1], what, knife->err);
}

/* Puts both halves of a piece of `now` into `next`, or the whole of it. */
static bool split_piece(ImprintKnife *knife, uint32_t piece, Line line)
{
    const uint32_t *corner = knife->now.corner + knife->now.first[piece];
    const uint32_t count = knife->now.first[piece + 1] - knife->now.first[piece];
    const double tolerance = knife->part->tolerance;
    if (!reserve_ring(knife, count))
        return false;
    bool above = false, below = false;
    for (uint32_t k = 0; k < count; k++) {
        const Vec3 p = knife->points->position[corner[k]];
        const double h = vec3_dot(line.across, vec3_sub(p, line.p));
        knife->height[k] = fabs(h) <= tolerance ? 0 : h;
        above = above || knife->height[k] > 0;
        below = below || knife->height[k] < 0;
    }
    if (!above || !below)
        return imprint_pieces_add(&knife->next, corner, NULL, count, knife->err);
    uint32_t n[2] = { 0, 0 };
    for (uint32_t k = 0; k < count; k++) {
        const double h = knife->height[k], h1 = knife->height[(k + 1) % count];
        if (h >= 0)
            knife->half[0][n[0]++] = corner[k];
        if (h <= 0)
            knife->half[1][n[1]++] = corner[k];
        if (!((h > 0 && h1 < 0) || (h < 0 && h1 > 0)))
            continue;
        uint32_t point;
        if (!crossing(knife, corner[k], corner[(k + 1) % count], h, h1, &point))
            return false;
        /* Drawn to a corner that is there, it comes once. */
        for (int side = 0; side < 2; side++)
            if (n[side] == 0 || knife->half[side][n[side] - 1] != point)
                knife->half[side][n[side]++] = point;
    }
    for (int side = 0; side < 2; side++) {
        while (n[side] > 1 && knife->half[side][0] == knife->half[side][n[side] - 1])
            n[side]--;
        if (n[side] >= 3
            && !imprint_pieces_add(&knife->next, knife->half[side], NULL, n[side], knife->err))
            return false;
    }
    return true;
}

static void swap_pieces(ImprintKnife *knife)
{
    const ImprintPieces other = knife->now;
    knife->now = knife->next;
    knife->next = other;
    knife->next.count = 0;
}

/* Whether a line runs through the inside of a piece, or a point (both ends equal) lies in it. */
static bool reaches(const ImprintKnife *knife, uint32_t piece, const ImprintLine *line)
{
    const uint32_t *corner = knife->now.corner + knife->now.first[piece];
    const uint32_t count = knife->now.first[piece + 1] - knife->now.first[piece];
    const double tolerance = knife->part->tolerance;
    if (!(line->length > 0))
        return imprint_inside(knife->points->position, corner, count, knife->part->normal,
                              tolerance, line->end[0]);
    Vec3 end[2] = { line->end[0], line->end[1] };
    bool border;
    return imprint_clip(knife->points->position, corner, count, knife->part->normal, tolerance,
                        end, &border) && !border;
}

/* Splits all pieces, or those that the stretch `reach` reaches. */
static bool split_all(ImprintKnife *knife, Line line, const ImprintLine *reach)
{
    for (uint32_t k = 0; k < knife->now.count; k++) {
        const uint32_t *corner = knife->now.corner + knife->now.first[k];
        const uint32_t count = knife->now.first[k + 1] - knife->now.first[k];
        const bool done = reach == NULL || reaches(knife, k, reach)
                        ? split_piece(knife, k, line)
                        : imprint_pieces_add(&knife->next, corner, NULL, count, knife->err);
        if (!done)
            return false;
    }
    swap_pieces(knife);
    return true;
}

/* --- parts ------------------------------------------------------------------------------------ */

static bool is_corner(const ImprintKnife *knife, uint32_t point)
{
    const uint32_t corners = knife->now.first[knife->now.count];
    for (uint32_t k = 0; k < corners; k++)
        if (knife->now.corner[k] == point)
            return true;
    return false;
}

/* Where a wall ends in the middle of a floor, the floor is cut across, so that an edge lies either
 * below the wall or beyond it. */
static bool split_ends(ImprintKnife *knife, const ImprintContacts *c, bool whole, uint32_t most)
{
    for (uint32_t k = 0; k < c->inner && knife->now.count < most; k++)
        for (int i = 0; i < 2 && c->line[k].barrier; i++) {
            const Vec3 p = c->line[k].end[i];
            uint32_t point;
            if (!point_at(knife, p, &point))
                return false;
            const ImprintLine at = { .end = { p, p } };
            const Vec3 way = vec3_sub(c->line[k].end[1], c->line[k].end[0]);
            if (!is_corner(knife, point)
                && !split_all(knife, (Line){ p, vec3_unit(way) }, whole ? NULL : &at))
                return false;
        }
    return true;
}

static bool begin(ImprintKnife *knife, const ImprintContacts *c)
{
    const ImprintPart *part = knife->part;
    const uint32_t *corner = knife->parts->corner + part->first;
    knife->now.count = knife->next.count = 0;
    knife->known_count = 0;
    for (uint32_t k = 0; k < part->count; k++)
        if (!know(knife, corner[k]))
            return false;
    for (uint32_t k = 0; k < c->inner; k++)
        for (int i = 0; i < 2; i++)
            if (!point_at(knife, c->line[k].end[i], &(uint32_t){ 0 }))
                return false;
    return imprint_pieces_add(&knife->now, corner, NULL, part->count, knife->err);
}

/* Whether some face in the same plane lies on the whole of a piece: where cuts were left out for
 * their number, a piece may be covered in part only, and stays. */
static bool is_covered(const ImprintKnife *knife, const ImprintContacts *c, uint32_t piece,
                       uint32_t *cover, Vec3 *at)
{
    const uint32_t *corner = knife->now.corner + knife->now.first[piece];
    const uint32_t count = knife->now.first[piece + 1] - knife->now.first[piece];
    Vec3 middle = { 0 };
    for (uint32_t k = 0; k < count; k++)
        middle = vec3_mad(middle, 1.0 / count, knife->points->position[corner[k]]);
    for (uint32_t k = 0; k < c->cover_count; k++) {
        const ImprintPart *other = &knife->parts->part[c->cover[k]];
        const uint32_t *outline = knife->parts->corner + other->first;
        const double tolerance = fmax(knife->part->tolerance, other->tolerance);
        const Vec3 *position = knife->points->position;
        bool in = imprint_inside(position, outline, other->count, other->normal, 0, middle);
        for (uint32_t i = 0; i < count && in; i++)
            in = imprint_inside(position, outline, other->count, other->normal, tolerance,
                                position[corner[i]]);
        *cover = c->cover[k];
        *at = middle;
        if (in)
            return true;
    }
    return false;
}

static double piece_area(const ImprintKnife *knife, uint32_t piece)
{
    const uint32_t *corner = knife->now.corner + knife->now.first[piece];
    const uint32_t count = knife->now.first[piece + 1] - knife->now.first[piece];
    return vec3_length(triangulate_normal(knife->points->position, corner, count)) / 2;
}

static bool drop_covered(ImprintKnife *knife, const ImprintContacts *c)
{
    for (uint32_t k = 0; k < knife->now.count; k++) {
        uint32_t cover;
        Vec3 at;
        if (is_covered(knife, c, k, &cover, &at)) {
            if (!knife->covered) {
                knife->cover = cover;
                knife->covered_at = at;
            }
            knife->covered = true;
            knife->overlapped = knife->overlapped || c->lamp[cover] == LAMP_NONE;
            knife->covered_area += piece_area(knife, k);
            continue;
        }
        const uint32_t *corner = knife->now.corner + knife->now.first[k];
        const uint32_t count = knife->now.first[k + 1] - knife->now.first[k];
        if (!imprint_pieces_add(&knife->next, corner, NULL, count, knife->err))
            return false;
    }
    swap_pieces(knife);
    return true;
}

bool imprint_cut(ImprintKnife *knife, uint32_t part, const ImprintContacts *c, uint32_t most)
{
    assert(part < knife->parts->count && most > 0);
    knife->part = &knife->parts->part[part];
    knife->covered = knife->overlapped = false;
    knife->covered_area = 0;
    bool whole = true;
    const uint32_t few = WHOLE_PIECES + WHOLE_PER_LINE * c->inner;
    if (!begin(knife, c))
        return false;
    for (uint32_t k = 0; k < c->inner && whole; k++) {
        if (!split_all(knife, line_through(knife, &c->line[k]), NULL))
            return false;
        whole = knife->now.count <= few && knife->now.count <= most;
    }
    if (!whole && !begin(knife, c))
        return false;
    for (uint32_t k = 0; k < c->inner && !whole && knife->now.count < most; k++)
        if (!split_all(knife, line_through(knife, &c->line[k]), &c->line[k]))
            return false;
    return split_ends(knife, c, whole, most) && (c->cover_count == 0 || drop_covered(knife, c));
}

void imprint_knife_clear(ImprintKnife *knife)
{
    imprint_pieces_clear(&knife->now);
    imprint_pieces_clear(&knife->next);
    array_free(knife->known);
    array_free(knife->height);
    array_free(knife->half[0]);
    array_free(knife->half[1]);
}
