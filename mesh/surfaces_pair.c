/* SPDX-License-Identifier: BSD-3-Clause */
/* Which triangles continue each other: the links of each edge in pairs. */
#include <assert.h>

#include "mesh/internal.h"

/* An edge of more triangles than this belongs to nobody: all of them end there. */
enum { MOST_AT_EDGE = 32 };

static uint32_t link_face(const Pairing *p, uint32_t link)
{
    return p->pieces->face[pairing_piece(p, link)];
}

static void pair(Pairing *p, uint32_t link, uint32_t other)
{
    p->partner[link] = other;
    p->partner[other] = link;
}

/* How much two triangles at an edge look like one surface, in bits of rising weight. */
enum { SAME_MATERIAL = 1, SAME_GROUP = 2, SAME_WINDING = 4, SAME_POLYGON = 8, SAME_ALL = 15 };

static int pair_grade(const Pairing *p, uint32_t link, uint32_t other)
{
    const Polygons *soup = p->repair->soup;
    const uint32_t f = link_face(p, link), g = link_face(p, other);
    const int polygon = f == g ? SAME_POLYGON : 0;
    const int winding = p->from[link] != p->from[other] ? SAME_WINDING : 0;
    const int group = soup->group[f] == soup->group[g] ? SAME_GROUP : 0;
    const int material = soup->material[f] == soup->material[g] ? SAME_MATERIAL : 0;
    return polygon + winding + group + material;
}

/* Pairs the links of an edge with more than two, most alike first, that have all of `needed`. */
static void pair_many(Pairing *p, const uint32_t *link, uint32_t n, int needed)
{
    for (int grade = SAME_ALL; grade >= needed; grade--)
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = i + 1; j < n && p->partner[link[i]] == PIECE_NONE; j++)
                if ((grade & needed) == needed && p->partner[link[j]] == PIECE_NONE
                    && pairing_piece(p, link[i]) != pairing_piece(p, link[j])
                    && pair_grade(p, link[i], link[j]) == grade)
                    pair(p, link[i], link[j]);
}

void pairing_certain(Pairing *p)
{
    for (uint32_t e = 0; e < p->edges.count; e++) {
        const uint32_t *link = p->edges.use + p->edges.first[e];
        const uint32_t n = p->edges.first[e + 1] - p->edges.first[e];
        if (n == 2 && pairing_piece(p, link[0]) != pairing_piece(p, link[1]))
            pair(p, link[0], link[1]);
        else if (n > 2 && n <= MOST_AT_EDGE)
            pair_many(p, link, n, SAME_POLYGON | SAME_WINDING);
    }
}

static bool report_many(Pairing *p, const uint32_t *link, uint32_t n)
{
    enum { COUNTED = 2 };
    const Vec3 *position = p->weld->position;
    /* A face that was cut where others stand on it has such edges by our own doing. */
    for (uint32_t k = 0; k < n; k++)
        if (soup_contact(p->repair->soup, link_face(p, link[k]), position[p->from[link[k]]],
                         position[p->to[link[k]]]))
            return true;
    for (uint32_t k = 2; k < n; k++) {
        const uint32_t piece = pairing_piece(p, link[k]);
        p->repair->repairs.nonmanifold += p->state[piece] != COUNTED;
        p->state[piece] = COUNTED;
    }
    const Vec3 a = position[p->from[link[0]]], b = position[p->to[link[0]]];
    return repair_report(p->repair, &(Defect){
        .kind = DEFECT_NONMANIFOLD, .repaired = !p->repair->options->keep_nonmanifold,
        .face = link_face(p, link[2]), .other = link_face(p, link[0]),
        .at = vec3_mad(a, 0.5, vec3_sub(b, a)), .measure = n });
}

bool pairing_likely(Pairing *p)
{
    for (uint32_t i = 0; i < p->pieces->count; i++)
        p->state[i] = 0;
    for (uint32_t e = 0; e < p->edges.count; e++) {
        const uint32_t *link = p->edges.use + p->edges.first[e];
        const uint32_t n = p->edges.first[e + 1] - p->edges.first[e];
        if (n <= 2)
            continue;
        if (!p->repair->options->keep_nonmanifold && n <= MOST_AT_EDGE)
            pair_many(p, link, n, SAME_WINDING);
        if (!report_many(p, link, n))
            return false;
    }
    return true;
}
