/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_contacts.c -- the lines along which other faces meet one. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"
#include "math/tolerance.h"

/* A part with more lines than this keeps the longest: what a statue leaves on the floor it has sunk
 * into is left to the sampling of patches. */
enum { LINES_MOST = 2048 };

typedef struct {
    const ImprintParts *parts;
    const ImprintPart  *part;
    const ImprintPart  *other;
    double              tolerance;
} Pairing;

static bool add_line(ImprintContacts *c, const Pairing *pair, Vec3 a, Vec3 b, bool barrier,
                     Error *err)
{
    if (barrier && c->keep_whole)
        return true;
    Vec3 end[2] = { a, b };
    bool border;
    if (!imprint_clip(pair->parts->soup->position, pair->parts->corner + pair->part->first,
                      pair->part->count, pair->part->normal, pair->tolerance, end, &border))
        return true;
    /* Along the border only what stands there matters: whether faces that go on smoothly into each
     * other are parted by it. */
    const double cosine = fabs(vec3_dot(pair->part->normal, pair->other->normal));
    if (border && (!barrier || cosine >= TOLERANCE_CREASE_COSINE))
        return true;
    if (!array_reserve((void **)&c->line, &c->capacity, (size_t)c->count + 1, sizeof *c->line,
                       "face contacts", err))
        return false;
    c->line[c->count++] = (ImprintLine){ .end = { end[0], end[1] }, .barrier = barrier,
                                         .inner = !border, .face = pair->other->face,
                                         .length = vec3_length(vec3_sub(end[1], end[0])) };
    c->inner += !border;
    return true;
}

bool imprint_same_outline(const ImprintParts *parts, const ImprintPart *a, const ImprintPart *b)
{
    const double tolerance = fmax(a->tolerance, b->tolerance);
    if (a->count != b->count)
        return false;
    for (uint32_t i = 0; i < a->count; i++) {
        bool found = false;
        for (uint32_t k = 0; k < b->count && !found; k++)
            found = vec3_length(vec3_sub(imprint_corner(parts, a, i),
                                         imprint_corner(parts, b, k))) <= tolerance;
        if (!found)
            return false;
    }
    return true;
}

/* Whether an unlit part in the plane of a lit one gives way to it. A sheet of light in a ceiling is
 * to shine whichever way it is wound; but the back of a box that hangs on a wall must neither open
 * the wall nor shine into the room behind it. */
static bool yields_to_lamp(ImprintContacts *c, const Pairing *pair, bool same_way, bool *yields,
                           Error *err)
{
    const uint32_t me = (uint32_t)(pair->part - pair->parts->part);
    const uint32_t other = (uint32_t)(pair->other - pair->parts->part);
    const uint32_t lamp = c->lamp[me] == LAMP_NONE ? other : me;
    const LampKind kind = (LampKind)c->lamp[lamp];
    if (kind == LAMP_BODY)
        return imprint_body_opens(pair->parts, lamp, c, yields, err);
    *yields = kind == LAMP_SHEET || (kind == LAMP_CASED && same_way)
           || (same_way && imprint_same_outline(pair->parts, pair->part, pair->other));
    return true;
}

static bool has_middle(const ImprintParts *parts, const ImprintPart *part, const ImprintPart *of)
{
    Vec3 middle = { 0 };
    for (uint32_t k = 0; k < of->count; k++)
        middle = vec3_mad(middle, 1.0 / of->count, imprint_corner(parts, of, k));
    return imprint_inside(parts->soup->position, parts->corner + part->first, part->count,
                          part->normal, 0, middle);
}

/* Whether two parts in one plane have a piece in common rather than an edge: the middle of one. */
static bool lie_on(const Pairing *pair)
{
    return has_middle(pair->parts, pair->part, pair->other)
        || has_middle(pair->parts, pair->other, pair->part);
}

/* Two unlit parts, or two lit ones, that look opposite ways: the larger one gives way when the
 * other lies on it. */
static bool opposite_gives_way(ImprintContacts *c, const Pairing *pair, bool *way, Error *err)
{
    const ImprintPart *part = pair->part, *other = pair->other;
    const uint32_t me = (uint32_t)(part - pair->parts->part);
    const uint32_t it = (uint32_t)(other - pair->parts->part);
    *way = false;
    if (c->lamp[me] != LAMP_NONE || !(part->area > other->area)
        || imprint_same_outline(pair->parts, part, other) || !lie_on(pair))
        return true;
    return imprint_carries(pair->parts, me, it, c, way, err);
}

/* Whether the part gives way to another in its plane: a lamp goes first; then the smaller face: it
 * is the one that someone put there; of equals the one that gives light stays, else the earlier.
 * Sides of one plate both stay. Never both, and never in a ring, so that something stays
 * everywhere. */
static bool gives_way(ImprintContacts *c, const Pairing *pair, bool *way, Error *err)
{
    const ImprintPart *part = pair->part, *other = pair->other;
    const LampKind lamp = (LampKind)c->lamp[part - pair->parts->part];
    const LampKind other_lamp = (LampKind)c->lamp[other - pair->parts->part];
    const bool same_way = vec3_dot(part->normal, other->normal) > 0;
    if ((lamp == LAMP_NONE) != (other_lamp == LAMP_NONE)) {
        bool yields, plate = false;
        const bool lit = lamp != LAMP_NONE;
        const uint32_t me = (uint32_t)(part - pair->parts->part);
        const uint32_t it = (uint32_t)(other - pair->parts->part);
        *way = false;
        if (!same_way && (lit ? lamp : other_lamp) == LAMP_SHEET
            && !imprint_is_plate(pair->parts, lit ? me : it, lit ? it : me, c, &plate, err))
            return false;
        if (plate)
            return true;
        if (!yields_to_lamp(c, pair, same_way, &yields, err))
            return false;
        *way = yields == (lamp == LAMP_NONE);
    } else if (!same_way) {
        return opposite_gives_way(c, pair, way, err);
    } else if (lamp != other_lamp) {
        *way = other_lamp < lamp;
    } else {
        *way = other->area != part->area ? other->area < part->area : other < part;
    }
    return true;
}

/* Two parts in one plane: the other's outline. */
static bool add_outline(ImprintContacts *c, const Pairing *pair, Error *err)
{
    const uint32_t me = (uint32_t)(pair->part - pair->parts->part);
    const uint32_t other = (uint32_t)(pair->other - pair->parts->part);
    if (!imprint_lamp_find(pair->parts, me, c, err)
        || !imprint_lamp_find(pair->parts, other, c, err))
        return false;
    c->flush = c->flush || lie_on(pair);
    bool covered = false;
    if (!c->keep_covered && !gives_way(c, pair, &covered, err))
        return false;
    if (!covered && c->keep_whole)
        return true;
    for (uint32_t k = 0; k < pair->other->count; k++)
        if (!add_line(c, pair, imprint_corner(pair->parts, pair->other, k),
                      imprint_corner(pair->parts, pair->other, k + 1), false, err))
            return false;
    if (!covered)
        return true;
    if (!array_reserve((void **)&c->cover, &c->cover_capacity, (size_t)c->cover_count + 1,
                       sizeof *c->cover, "face contacts", err))
        return false;
    c->cover[c->cover_count++] = other;
    return true;
}

static bool add_pair(ImprintContacts *c, const Pairing *pair, Error *err)
{
    const ImprintPart *part = pair->part, *other = pair->other;
    Vec3 end[2];
    uint32_t ends = 0, on = 0, above = 0, below = 0;
    Vec3 last = imprint_corner(pair->parts, other, other->count - 1);
    double h0 = vec3_dot(part->normal, last) - part->level;
    for (uint32_t k = 0; k < other->count; k++) {
        const Vec3 p = imprint_corner(pair->parts, other, k);
        const double h = vec3_dot(part->normal, p) - part->level;
        const bool level0 = fabs(h0) <= pair->tolerance, level = fabs(h) <= pair->tolerance;
        if (!level && !level0 && (h > 0) != (h0 > 0) && ends < 2)
            end[ends++] = vec3_lerp(last, p, h0 / (h0 - h));
        if (level && ends < 2)
            end[ends++] = p;
        else if (level && ends == 2)
            end[1] = p; /* corners in line */
        on += level;
        above += !level && h > 0;
        below += !level && h < 0;
        last = p;
        h0 = h;
    }
    if (on == other->count)
        return add_outline(c, pair, err);
    /* One corner that touches is no line. */
    if (ends < 2 || (above == 0 && below == 0))
        return true;
    return add_line(c, pair, end[0], end[1], true, err);
}

static int longer_first(const void *a, const void *b)
{
    const ImprintLine *x = a, *y = b;
    if (x->inner != y->inner)
        return x->inner ? -1 : 1;
    if (x->length != y->length)
        return x->length > y->length ? -1 : 1;
    const double px[6] = { x->end[0].x, x->end[0].y, x->end[0].z,
                           x->end[1].x, x->end[1].y, x->end[1].z };
    const double py[6] = { y->end[0].x, y->end[0].y, y->end[0].z,
                           y->end[1].x, y->end[1].y, y->end[1].z };
    for (int k = 0; k < 6; k++)
        if (px[k] != py[k])
            return px[k] < py[k] ? -1 : 1;
    return 0;
}

bool imprint_contacts_find(const ImprintParts *parts, uint32_t index, ImprintContacts *c,
                           Error *err)
{
    assert(index < parts->count && c != NULL);
    const ImprintPart *part = &parts->part[index];
    c->count = c->inner = c->cover_count = 0;
    c->flush = false;
    if (c->met == NULL)
        c->met = array_create(parts->count, sizeof *c->met, "face contacts", err);
    if (c->met == NULL)
        return false;
    const Vec3 rim = vec3(part->tolerance, part->tolerance, part->tolerance);
    const Box box = box_around(vec3_sub(part->lo, rim), vec3_add(part->hi, rim));
    const uint32_t met = box_tree_meet(&parts->tree, &box, 0, c->met, parts->count);
    for (uint32_t k = 0; k < met; k++) {
        const ImprintPart *other = &parts->part[parts->tree.entry[c->met[k]].item];
        const Pairing pair = { parts, part, other, fmax(part->tolerance, other->tolerance) };
        if (other->face != part->face && !add_pair(c, &pair, err))
            return false;
    }
    if (c->count > 0)
        qsort(c->line, c->count, sizeof *c->line, longer_first);
    if (c->count > LINES_MOST)
        c->count = LINES_MOST;
    if (c->inner > c->count)
        c->inner = c->count;
    return true;
}

void imprint_contacts_clear(ImprintContacts *c)
{
    array_free(c->line);
    array_free(c->cover);
    array_free(c->met);
    array_free(c->lamp);
    array_free(c->row);
    array_free(c->beside);
    array_free(c->body);
    bvh_destroy(c->bvh);
    *c = (ImprintContacts){ 0 };
}
