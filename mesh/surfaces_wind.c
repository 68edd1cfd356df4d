/* SPDX-License-Identifier: BSD-3-Clause */
/* Windings made to agree over the pairs of triangles that certainly belong together.
 *
 * Each connected part is walked through once. Where all its windings can agree, the ones that most
 * of its area has stay; where neither has a clear majority and the part is closed, it is turned
 * inside in. A part that agrees already is left as it is: rooms are modelled from inside. Plates of
 * two faces have no say, as they show a front to both sides. A lamp in a ceiling shines to its
 * front whichever way the ceiling is wound: where most of what emits in a part is against the rest,
 * that is meant.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/internal.h"

/* What becomes of a triangle. */
enum { STAYS, TURNS, DISAGREES };

/* A share of the area above which nobody asks where the outside is: faces wound by chance come out
 * near one half; a good model with a few faces astray is far above two thirds. */
static const double CLEAR_MAJORITY = 2.0 / 3;

typedef struct {
    uint32_t count;       /* triangles, in pairing->queue */
    bool     orientable, closed;
    double   area[2];     /* wound as the first one; the other way */
    double   emitting[2]; /* of that, what emits */
    double   volume;      /* signed, with all wound as the first */
    uint32_t at;          /* a link where windings cannot agree, or PIECE_NONE */
} Part;

typedef struct {
    Pairing *pairing;
    uint8_t *against;     /* [pieces]  wound against the first of its part */
    uint8_t *fate;        /* [pieces] */
} Winder;

static bool is_plate(const Pairing *p, uint32_t piece)
{
    return p->pieces->back[piece] != PIECE_NONE;
}

/* Whether it matters for the light where its front is. */
static bool is_lamp(const Pairing *p, uint32_t piece)
{
    const Polygons *soup = p->repair->soup;
    const Material *material = &soup->materials[soup->material[p->pieces->face[piece]]];
    return !is_plate(p, piece) && !material->emits_both && rgb_max(material->emission) > 0;
}

static void measure_piece(const Winder *w, uint32_t piece, Vec3 origin, Part *part)
{
    const uint32_t *corner = w->pairing->pieces->corner + 3 * (size_t)piece;
    const Vec3 *position = w->pairing->weld->position;
    const Vec3 a = vec3_sub(position[corner[0]], origin);
    const Vec3 b = vec3_sub(position[corner[1]], origin);
    const Vec3 c = vec3_sub(position[corner[2]], origin);
    const double volume = vec3_dot(a, vec3_cross(b, c)) / 6;
    const double area = vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / 2;
    if (!is_plate(w->pairing, piece))
        part->area[w->against[piece]] += area;
    if (is_lamp(w->pairing, piece))
        part->emitting[w->against[piece]] += area;
    part->volume += w->against[piece] ? -volume : volume;
}

/* Walks through the part of `seed`. Its pieces' state becomes 1. */
static Part walk_part(const Winder *w, uint32_t seed)
{
    const Pairing *p = w->pairing;
    const Vec3 origin = p->weld->position[p->pieces->corner[3 * (size_t)seed]];
    Part part = { .orientable = true, .closed = true, .at = PIECE_NONE };
    p->queue[part.count++] = seed;
    p->state[seed] = 1;
    for (uint32_t head = 0; head < part.count; head++) {
        const uint32_t i = p->queue[head];
        measure_piece(w, i, origin, &part);
        for (uint32_t link = pairing_begin(p, i); link < pairing_begin(p, i + 1); link++) {
            const uint32_t other = p->partner[link];
            part.closed = part.closed && other != PIECE_NONE;
            if (other == PIECE_NONE)
                continue;
            const uint32_t j = pairing_piece(p, other);
            const uint8_t wanted = w->against[i] ^ (p->from[link] == p->from[other]);
            if (p->state[j] == 0) {
                p->state[j] = 1;
                w->against[j] = wanted;
                p->queue[part.count++] = j;
            } else if (w->against[j] != wanted) {
                part.orientable = false;
                part.at = part.at == PIECE_NONE ? link : part.at;
            }
        }
    }
    return part;
}

/* Which of the two windings of a part is kept: as its first triangle, or against it. */
static uint8_t choose_winding(const Part *part)
{
    const double most = fmax(part->area[0], part->area[1]);
    const double all = part->area[0] + part->area[1];
    if (part->orientable && part->closed && most < CLEAR_MAJORITY * all)
        return part->volume < 0;
    return part->area[1] > part->area[0];
}

static bool judge_part(Winder *w, const Part *part)
{
    const Pairing *p = w->pairing;
    const bool repairs = part->orientable && !p->repair->options->keep_winding;
    const uint8_t kept = choose_winding(part);
    const bool lamps_stay = part->emitting[!kept] > part->emitting[kept];
    for (uint32_t k = 0; k < part->count; k++) {
        const uint32_t i = p->queue[k];
        if (w->against[i] != kept)
            w->fate[i] = repairs && !(lamps_stay && is_lamp(p, i)) ? TURNS : DISAGREES;
    }
    if (part->orientable)
        return true;
    const uint32_t link = part->at, other = p->partner[link];
    return repair_report(p->repair, &(Defect){
        .kind = DEFECT_UNORIENTABLE, .face = p->pieces->face[pairing_piece(p, link)],
        .other = p->pieces->face[pairing_piece(p, other)],
        .at = p->weld->position[p->from[link]] });
}

/* One entry a polygon: its triangles stand in a row. */
static bool list_windings(const Winder *w)
{
    const Pairing *p = w->pairing;
    uint32_t told = PIECE_NONE;
    for (uint32_t i = 0; i < p->pieces->count; i++) {
        const uint32_t face = p->pieces->face[i];
        if (w->fate[i] == STAYS || is_plate(p, i) || face == told)
            continue;
        told = face;
        p->repair->repairs.flipped += w->fate[i] == TURNS;
        if (!repair_report(p->repair, &(Defect){
                .kind = DEFECT_WINDING, .repaired = w->fate[i] == TURNS, .face = face,
                .other = DEFECT_NO_FACE,
                .at = p->weld->position[p->pieces->corner[3 * (size_t)i]] }))
            return false;
    }
    return true;
}

/* --- turning ---------------------------------------------------------------------------------- */

/* The number that a link gets when those triangles are turned whose fate it is. */
static uint32_t turned_link(const Winder *w, uint32_t link)
{
    const Pairing *p = w->pairing;
    const uint32_t piece = link == PIECE_NONE ? 0 : pairing_piece(p, link);
    if (link == PIECE_NONE || w->fate[piece] != TURNS)
        return link;
    return pairing_begin(p, piece) + pairing_begin(p, piece + 1) - 1 - link;
}

static void swap_u32(uint32_t *a, uint32_t *b)
{
    const uint32_t t = *a;
    *a = *b;
    *b = t;
}

/* Reverses the stitches of a triangle: edge k becomes edge 2 - k. */
static void turn_stitches(Stitches *stitches, uint32_t piece)
{
    uint32_t *first = stitches->first + 3 * (size_t)piece;
    const uint32_t begin = first[0], end = first[3], before = first[1];
    for (uint32_t i = begin, j = end; i < j--; i++) {
        const Stitch t = stitches->stitch[i];
        stitches->stitch[i] = stitches->stitch[j];
        stitches->stitch[j] = t;
    }
    for (uint32_t i = begin; i < end; i++)
        stitches->stitch[i].fraction = 1 - stitches->stitch[i].fraction;
    first[1] = begin + end - first[2];
    first[2] = begin + end - before;
}

/* Corners 0 2 1; what lies on its back becomes its front. */
static void turn_piece(Pairing *p, uint32_t i)
{
    Pieces *pieces = p->pieces;
    swap_u32(&pieces->corner[3 * (size_t)i + 1], &pieces->corner[3 * (size_t)i + 2]);
    if (pieces->back[i] != PIECE_NONE)
        swap_u32(&pieces->face[i], &pieces->back[i]);
    if (pieces->diagonal[i] != PIECE_NONE)
        pieces->diagonal[i] = 3 * i + 2 - pieces->diagonal[i] % 3;
    const uint32_t begin = pairing_begin(p, i), end = pairing_begin(p, i + 1);
    for (uint32_t a = begin, b = end; a < b--; a++) {
        swap_u32(&p->partner[a], &p->partner[b]);
        swap_u32(&p->edges.edge[a], &p->edges.edge[b]);
        swap_u32(&p->from[a], &p->to[b]);
        if (a != b)
            swap_u32(&p->to[a], &p->from[b]);
    }
}

static void turn_pieces(const Winder *w)
{
    Pairing *p = w->pairing;
    for (uint32_t i = 0; i < p->pieces->count; i++)
        if (p->pieces->other[i] != PIECE_NONE && w->fate[i] != w->fate[p->pieces->other[i]])
            pieces_split_quad(p->pieces, i); /* its halves are not connected */
    for (uint32_t link = 0; link < p->links; link++)
        p->partner[link] = turned_link(w, p->partner[link]);
    for (uint32_t k = 0; k < p->edges.first[p->edges.count]; k++)
        p->edges.use[k] = turned_link(w, p->edges.use[k]);
    for (uint32_t i = 0; i < p->pieces->count; i++)
        if (w->fate[i] == TURNS)
            turn_piece(p, i);
    /* The number of links of a use changes with its stitches: last. */
    for (uint32_t i = 0; p->stitches->first != NULL && i < p->pieces->count; i++)
        if (w->fate[i] == TURNS)
            turn_stitches(p->stitches, i);
}

bool pairing_wind(Pairing *p)
{
    assert(p != NULL);
    Error *err = p->repair->err;
    Winder w = { .pairing = p };
    w.against = array_create(p->pieces->count, sizeof *w.against, "windings", err);
    w.fate = array_create(p->pieces->count, sizeof *w.fate, "windings", err);
    bool ok = !error_is_set(err);
    for (uint32_t i = 0; ok && i < p->pieces->count; i++)
        p->state[i] = 0;
    for (uint32_t i = 0; ok && i < p->pieces->count; i++)
        if (p->state[i] == 0) {
            const Part part = walk_part(&w, i);
            ok = judge_part(&w, &part);
        }
    ok = ok && list_windings(&w);
    if (ok)
        turn_pieces(&w);
    array_free(w.against);
    array_free(w.fate);
    return ok;
}
