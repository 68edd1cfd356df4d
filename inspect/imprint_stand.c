/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_stand.c -- which of two faces in one plane that look opposite ways lies on the
 * other: by what stands at their edges and by what is enclosed, not by their winding. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"

/* Sides of a part's plane on which the parts at its edges stand. */
enum { STANDS_FRONT = 1, STANDS_BACK = 2 };

/* In ImprintContacts.body. */
enum { BODY_UNKNOWN, BODY_OPEN, BODY_CLOSED };

/* A plate has as much lit area as dark; of a ceiling of two tiles, one of them lit from below, the
 * two differ by half of the dark. */
static const double TWIN_SHARE = 1.0 / 4;

static uint32_t meet(const ImprintParts *parts, const ImprintPart *part, ImprintContacts *c)
{
    const Vec3 rim = vec3(part->tolerance, part->tolerance, part->tolerance);
    const Box box = box_around(vec3_sub(part->lo, rim), vec3_add(part->hi, rim));
    return box_tree_meet(&parts->tree, &box, 0, c->beside, parts->count);
}

static uint32_t met_part(const ImprintParts *parts, const ImprintContacts *c, uint32_t k)
{
    return parts->tree.entry[c->beside[k]].item;
}

static unsigned side_of(const ImprintParts *parts, const ImprintPart *part,
                        const ImprintPart *other)
{
    const double tolerance = fmax(part->tolerance, other->tolerance);
    unsigned sides = 0;
    for (uint32_t k = 0; k < other->count; k++) {
        const double h = vec3_dot(part->normal, imprint_corner(parts, other, k)) - part->level;
        sides |= h > tolerance ? STANDS_FRONT : h < -tolerance ? STANDS_BACK : 0;
    }
    return sides;
}

static unsigned standing(const ImprintParts *parts, const ImprintPart *part, ImprintContacts *c)
{
    const uint32_t met = meet(parts, part, c);
    unsigned sides = 0;
    for (uint32_t k = 0; k < met; k++) {
        const ImprintPart *other = &parts->part[met_part(parts, c, k)];
        if (other != part && imprint_share_edge(parts, part, other))
            sides |= side_of(parts, part, other);
    }
    return sides;
}

/* Whether edge k of a part is an edge of the other too. */
static bool is_edge_of(const ImprintParts *parts, const ImprintPart *part, uint32_t k,
                       const ImprintPart *other)
{
    const double tolerance = fmax(part->tolerance, other->tolerance);
    const Vec3 p = imprint_corner(parts, part, k), q = imprint_corner(parts, part, k + 1);
    bool begins = false, ends = false;
    for (uint32_t i = 0; i < other->count; i++) {
        const Vec3 r = imprint_corner(parts, other, i), s = imprint_corner(parts, other, i + 1);
        begins = vec3_length(vec3_sub(p, r)) <= tolerance
              && vec3_length(vec3_sub(q, s)) <= tolerance;
        ends = vec3_length(vec3_sub(p, s)) <= tolerance && vec3_length(vec3_sub(q, r)) <= tolerance;
        if (begins || ends)
            return true;
    }
    return false;
}

/* Adds the parts at the edges of one to the row; whether each edge has one. */
static bool add_beside(const ImprintParts *parts, uint32_t index, ImprintContacts *c,
                       uint32_t *count)
{
    const ImprintPart *part = &parts->part[index];
    const uint32_t met = meet(parts, part, c);
    bool closed = true;
    for (uint32_t e = 0; e < part->count; e++) {
        bool found = false;
        for (uint32_t k = 0; k < met; k++) {
            const uint32_t i = met_part(parts, c, k);
            if (i == index || !is_edge_of(parts, part, e, &parts->part[i]))
                continue;
            found = true;
            if (c->body[i] != BODY_UNKNOWN)
                continue;
            c->body[i] = BODY_OPEN;
            c->row[(*count)++] = i;
        }
        closed = closed && found;
    }
    return closed;
}

/* Whether all edges of the body that a part belongs to have two faces; each body is looked at
 * once. */
static bool is_closed(const ImprintParts *parts, uint32_t index, ImprintContacts *c)
{
    if (c->body[index] == BODY_UNKNOWN) {
        uint32_t count = 1;
        bool closed = true;
        c->row[0] = index;
        c->body[index] = BODY_OPEN;
        for (uint32_t k = 0; k < count; k++)
            closed = add_beside(parts, c->row[k], c, &count) && closed;
        for (uint32_t k = 0; k < count && closed; k++)
            c->body[c->row[k]] = BODY_CLOSED;
    }
    return c->body[index] == BODY_CLOSED;
}

static bool make_room(const ImprintParts *parts, ImprintContacts *c, Error *err)
{
    static const char what[] = "face contacts";
    if (c->row == NULL)
        c->row = array_create(parts->count, sizeof *c->row, what, err);
    if (c->beside == NULL)
        c->beside = array_create(parts->count, sizeof *c->beside, what, err);
    if (c->body == NULL)
        c->body = array_create(parts->count, sizeof *c->body, what, err);
    return !error_is_set(err);
}

bool imprint_carries(const ImprintParts *parts, uint32_t large, uint32_t small,
                     ImprintContacts *c, bool *carries, Error *err)
{
    assert(large < parts->count && small < parts->count && carries != NULL);
    const ImprintPart *wall = &parts->part[large];
    *carries = false;
    if (!make_room(parts, c, err))
        return false;
    /* The small one looks to the back of the wall. */
    const unsigned sides = standing(parts, &parts->part[small], c);
    if (sides == STANDS_BACK) {
        /* Below something solid nobody sees either. */
        *carries = !is_closed(parts, small, c);
        return true;
    }
    if (sides != 0)
        return true;
    bool here = true, there = true;
    *carries = is_closed(parts, large, c);
    if (!*carries) {
        const Vec3 back = vec3_scale(wall->normal, -1);
        if (!imprint_enclosed(parts, c, &parts->part[small], wall->normal, &here, err)
            || !imprint_enclosed(parts, c, &parts->part[small], back, &there, err))
            return false;
        *carries = here && !there;
    }
    return true;
}

bool imprint_is_plate(const ImprintParts *parts, uint32_t lamp, uint32_t dark, ImprintContacts *c,
                      bool *plate, Error *err)
{
    assert(lamp < parts->count && dark < parts->count && plate != NULL);
    const ImprintPart *face = &parts->part[dark];
    *plate = false;
    if (!imprint_same_outline(parts, &parts->part[lamp], face))
        return true;
    if (!make_room(parts, c, err))
        return false;
    double lit = 0, unlit = face->area;
    const uint32_t met = meet(parts, face, c);
    *plate = true;
    for (uint32_t k = 0; k < met && *plate; k++) {
        const ImprintPart *other = &parts->part[met_part(parts, c, k)];
        if (other == face || !imprint_share_edge(parts, face, other))
            continue;
        if (imprint_emits(parts->soup, other->face))
            lit += other->area;
        else
            unlit += other->area;
        *plate = side_of(parts, face, other) == 0;
    }
    *plate = *plate && fabs(lit - unlit) <= TWIN_SHARE * unlit;
    return true;
}
