/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/sides_shells.c -- parts that no sight passes: closed, and wound alike all over.
 *
 * All fronts of such a part look into one half of the world and all backs into the other, whatever
 * else there is. Once sight has come to the one half and, from lamps and eyes within, not to the
 * other, no ray from the other half will ever meet it: it need not look for any. */
#include <assert.h>

#include "base/array.h"
#include "radiosity/internal.h"

static unsigned edges_of(const Surface *f)
{
    return f->kind == SURFACE_TRIANGLE ? 3 : f->kind == SURFACE_QUAD ? 4 : 0;
}

static Vec3 edge_way(const Surfaces *s, uint32_t surface, unsigned k)
{
    const Surface *f = &s->surface[surface];
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    const unsigned next = (k + 1) % edges_of(f);
    return vec3_sub(s->position[next == 3 ? c[5] : c[next]], s->position[k == 3 ? c[5] : c[k]]);
}

/* Neighbour over piece n of an edge, counted from its corner; false when it has fewer. */
static bool edge_neighbour(const Surfaces *s, uint32_t surface, unsigned k, uint32_t n,
                           uint32_t *neighbour)
{
    *neighbour = s->surface[surface].neighbour[k];
    if (n == 0)
        return true;
    const uint32_t use = 4 * surface + k;
    if (s->stitch_first == NULL || s->stitch_first[use] + n > s->stitch_first[use + 1])
        return false;
    *neighbour = s->stitch[s->stitch_first[use] + n - 1].neighbour;
    return true;
}

bool shells_alike(const Surfaces *s, uint32_t surface, unsigned k, uint32_t other)
{
    const Vec3 way = edge_way(s, surface, k);
    bool found = false;
    for (unsigned i = 0; i < edges_of(&s->surface[other]); i++) {
        uint32_t back = SURFACE_NONE;
        bool shared = false;
        for (uint32_t n = 0; !shared && edge_neighbour(s, other, i, n, &back); n++)
            shared = back == surface;
        if (!shared)
            continue;
        const Vec3 there = edge_way(s, other, i);
        const double cosine = vec3_dot(vec3_unit(way), vec3_unit(there));
        static const double ALONG = 0.999; /* of another edge that they share: looked at later */
        if (fabs(cosine) < ALONG)
            continue;
        if (cosine > 0)
            return false;
        found = true;
    }
    return found;
}

static bool is_sound(const Surfaces *s, uint32_t surface)
{
    const Surface *f = &s->surface[surface];
    if (f->back != SURFACE_NONE)
        return false;
    for (unsigned k = 0; k < edges_of(f); k++) {
        uint32_t other;
        for (uint32_t n = 0; edge_neighbour(s, surface, k, n, &other); n++)
            if (other == SURFACE_NONE || !shells_alike(s, surface, k, other))
                return false;
    }
    return true;
}

bool shells_find(const Surfaces *surfaces, uint8_t **shell, Error *err)
{
    assert(surfaces != NULL && shell != NULL);
    *shell = array_create(surfaces->part_count, sizeof **shell, "parts", err);
    if (*shell == NULL)
        return false;
    for (uint32_t k = 0; k < surfaces->part_count; k++)
        (*shell)[k] = surfaces->part_closed[k];
    for (uint32_t i = 0; i < surfaces->count; i++)
        if ((*shell)[surfaces->part[i]] && !is_sound(surfaces, i))
            (*shell)[surfaces->part[i]] = 0;
    return true;
}
