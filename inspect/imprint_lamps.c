/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_lamps.c -- whether a lit face is a lone sheet or the side of a body. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"

bool imprint_emits(const Polygons *soup, uint32_t face)
{
    return rgb_max(soup->materials[soup->material[face]].emission) > 0;
}

static bool is_at(Vec3 p, Vec3 q, double tolerance)
{
    return vec3_length(vec3_sub(p, q)) <= tolerance;
}

bool imprint_share_edge(const ImprintParts *parts, const ImprintPart *a, const ImprintPart *b)
{
    const double tolerance = fmax(a->tolerance, b->tolerance);
    for (uint32_t i = 0; i < a->count; i++) {
        const Vec3 p = imprint_corner(parts, a, i), q = imprint_corner(parts, a, i + 1);
        for (uint32_t k = 0; k < b->count; k++) {
            const Vec3 r = imprint_corner(parts, b, k), s = imprint_corner(parts, b, k + 1);
            if ((is_at(p, r, tolerance) && is_at(q, s, tolerance))
                || (is_at(p, s, tolerance) && is_at(q, r, tolerance)))
                return true;
        }
    }
    return false;
}

/* Lowest and highest corner of another part over the plane of one. */
static void heights(const ImprintParts *parts, const ImprintPart *part, const ImprintPart *other,
                    double *low, double *high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (uint32_t k = 0; k < other->count; k++) {
        const double h = vec3_dot(part->normal, imprint_corner(parts, other, k)) - part->level;
        *low = fmin(*low, h);
        *high = fmax(*high, h);
    }
}

/* What a neighbour at an edge makes of the lit part; LAMP_UNKNOWN: the two are one face. */
static LampKind kind_beside(const ImprintParts *parts, const ImprintPart *part,
                            const ImprintPart *other)
{
    const Polygons *soup = parts->soup;
    const double tolerance = fmax(part->tolerance, other->tolerance);
    const bool lit = imprint_emits(soup, other->face);
    double low, high;
    heights(parts, part, other, &low, &high);
    if (low >= -tolerance && high <= tolerance)
        return lit ? LAMP_UNKNOWN : LAMP_SHEET;
    if (lit)
        return LAMP_BODY; /* whichever way it is wound */
    if (low >= -tolerance)
        return LAMP_SHEET; /* before the face, as in a cove */
    /* Walls that a sheet of light ends at are no case of it. */
    return soup->group[other->face] == soup->group[part->face] ? LAMP_CASED : LAMP_SHEET;
}

/* Looks along the edges of one part; what belongs to the same face joins the row. */
static LampKind look_round(const ImprintParts *parts, uint32_t index, ImprintContacts *c,
                           uint32_t *row_count)
{
    const ImprintPart *part = &parts->part[index];
    const Vec3 rim = vec3(part->tolerance, part->tolerance, part->tolerance);
    const Box box = box_around(vec3_sub(part->lo, rim), vec3_add(part->hi, rim));
    const uint32_t met = box_tree_meet(&parts->tree, &box, 0, c->beside, parts->count);
    LampKind most = LAMP_SHEET;
    for (uint32_t k = 0; k < met; k++) {
        const uint32_t i = parts->tree.entry[c->beside[k]].item;
        if (i == index || !imprint_share_edge(parts, part, &parts->part[i]))
            continue;
        const LampKind kind = kind_beside(parts, part, &parts->part[i]);
        if (kind > most)
            most = kind;
        if (kind == LAMP_UNKNOWN && c->lamp[i] == LAMP_UNKNOWN) {
            c->lamp[i] = LAMP_SHEET;
            c->row[(*row_count)++] = i;
        }
    }
    return most;
}

static bool make_room(const ImprintParts *parts, ImprintContacts *c, Error *err)
{
    static const char what[] = "face contacts";
    if (c->lamp == NULL)
        c->lamp = array_create(parts->count, sizeof *c->lamp, what, err);
    if (c->row == NULL)
        c->row = array_create(parts->count, sizeof *c->row, what, err);
    if (c->beside == NULL)
        c->beside = array_create(parts->count, sizeof *c->beside, what, err);
    return !error_is_set(err);
}

bool imprint_lamp_find(const ImprintParts *parts, uint32_t index, ImprintContacts *c, Error *err)
{
    assert(index < parts->count && c != NULL);
    if (!make_room(parts, c, err))
        return false;
    if (c->lamp[index] != LAMP_UNKNOWN)
        return true;
    if (!imprint_emits(parts->soup, parts->part[index].face)) {
        c->lamp[index] = LAMP_NONE;
        return true;
    }
    LampKind most = LAMP_SHEET;
    uint32_t count = 1;
    c->row[0] = index;
    c->lamp[index] = LAMP_SHEET;
    for (uint32_t k = 0; k < count; k++) {
        const LampKind kind = look_round(parts, c->row[k], c, &count);
        if (kind > most)
            most = kind;
    }
    for (uint32_t k = 0; k < count; k++)
        c->lamp[c->row[k]] = (uint8_t)most;
    return true;
}
