/* SPDX-License-Identifier: BSD-3-Clause */
/* Two triangles that form a parallelogram become one quad again: exporters cut every wall. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/edges.h"
#include "mesh/internal.h"

static double largest_coordinate(Vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

/* Grades are told apart in steps of this share of a right angle, so that rounding does not choose
 * between equally good pairs: the order of the file does. */
static const double GRADE_STEPS = 1024;

/* Whether the triangles at both sides of `use` are a flat parallelogram, and how far from a
 * rectangle it is: the order of joining, best first. */
static bool parallelogram(const Pieces *pieces, const Vec3 *position, uint32_t use, uint32_t other,
                          uint64_t *grade)
{
    const Vec3 p = position[pieces->corner[use]], q = position[pieces->corner[use_next(use)]];
    const Vec3 r = position[pieces->corner[use_next(use_next(use))]];
    const Vec3 w = position[pieces->corner[use_next(use_next(other))]];
    const double largest = fmax(fmax(largest_coordinate(p), largest_coordinate(q)),
                                fmax(largest_coordinate(r), largest_coordinate(w)));
    /* p + q = r + w makes it flat as well; four points are off by a tolerance each. */
    const Vec3 gap = vec3_sub(vec3_add(p, q), vec3_add(r, w));
    if (!(vec3_length(gap) <= 4 * position_tolerance(largest)))
        return false;
    const double cosine = vec3_dot(vec3_unit(vec3_sub(p, r)), vec3_unit(vec3_sub(q, r)));
    *grade = (uint64_t)(fmin(fabs(cosine), 1) * GRADE_STEPS + 0.5);
    return true;
}

bool soup_contact(const Polygons *soup, uint32_t face, Vec3 p, Vec3 q)
{
    if (soup->contact == NULL)
        return false;
    const uint32_t first = soup->first[face], last = soup->first[face + 1] - 1;
    const double tolerance = polygons_tolerance(soup, fmax(largest_coordinate(p),
                                                           largest_coordinate(q)));
    for (uint32_t k = first; k <= last; k++) {
        const Vec3 a = soup->position[soup->corner[k]];
        const Vec3 b = soup->position[soup->corner[k == last ? first : k + 1]];
        const double same = vec3_length(vec3_sub(p, a)) + vec3_length(vec3_sub(q, b));
        const double turned = vec3_length(vec3_sub(p, b)) + vec3_length(vec3_sub(q, a));
        /* Both ends may have moved when they were welded. */
        if (soup->contact[k] && fmin(same, turned) <= 2 * tolerance)
            return true;
    }
    return false;
}

static bool is_contact(const Pieces *pieces, const Polygons *soup, const Vec3 *position,
                       uint32_t use)
{
    return soup_contact(soup, pieces->face[use / 3], position[pieces->corner[use]],
                        position[pieces->corner[use_next(use)]]);
}

static bool may_join(const Pieces *pieces, const Connection *connection, const Polygons *soup,
                     uint32_t use, uint32_t other)
{
    const uint32_t i = use / 3, j = other / 3;
    return i < j && pieces->other[i] == PIECE_NONE && pieces->other[j] == PIECE_NONE
        && connection->reversed[i] == connection->reversed[j]
        && pieces_alike(pieces, soup, i, j);
}

/* The use of the same edge in the triangle on the other side when neither has stitches. */
static uint32_t whole_across(const Connection *connection, uint32_t use)
{
    const Stitches *s = connection->stitches;
    if (s->first != NULL && s->first[use] != s->first[use + 1])
        return PIECE_NONE;
    const uint32_t other = connection_across(connection, stitches_link(s, use));
    if (other == PIECE_NONE)
        return PIECE_NONE;
    const uint32_t there = connection_use(connection, other);
    return s->first != NULL && s->first[there] != s->first[there + 1] ? PIECE_NONE : there;
}

bool pieces_join(Pieces *pieces, const Connection *connection, const Polygons *soup,
                 const Vec3 *position, Error *err)
{
    assert(pieces != NULL && connection != NULL && soup != NULL && position != NULL);
    const uint32_t uses = 3 * pieces->count;
    uint64_t *key = array_create(uses / 2 + 1, sizeof *key, "quads", err);
    if (key == NULL)
        return false;
    uint32_t count = 0;
    for (uint32_t use = 0; use < uses; use++) {
        const uint32_t other = whole_across(connection, use);
        uint64_t grade = 0;
        if (other != PIECE_NONE && may_join(pieces, connection, soup, use, other)
            && parallelogram(pieces, position, use, other, &grade)
            && !is_contact(pieces, soup, position, use)
            && !is_contact(pieces, soup, position, other))
            key[count++] = grade << 32 | use;
    }
    edges_sort_keys(key, count);
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t use = (uint32_t)key[k], other = whole_across(connection, use);
        if (!may_join(pieces, connection, soup, use, other))
            continue;
        pieces->diagonal[use / 3] = use;
        pieces->diagonal[other / 3] = other;
        pieces->other[use / 3] = other / 3;
        pieces->other[other / 3] = use / 3;
    }
    array_free(key);
    return true;
}
