/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of one cell: its square is quartered wherever something that parts it runs through, and
 * what is left undecided is sampled. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "math/sampling.h"
#include "mesh/slicers.h"
#include "mesh/patches_internal.h"

/* Quarterings until the rest is sampled: 64 x 64 squares. Areas are off by about 1e-4 of the
 * cell's: a curve crosses some 100 squares, each off by some 3 % at random. Thin things are
 * followed further, up to DEPTH_MOST. */
enum { DEPTH = 6, DEPTH_MOST = 11, SAMPLES = 16 };

/* Quarterings until something is taken to run through. */
enum { CROSS_DEPTH = 7, EDGE_DEPTH = 10 };

/* Something that lies in a cell, at most of GRID x GRID places, does not part it. */
enum { GRID = 3, LIES_MOST = 4 };

/* Of the square; a part that has no share of its own takes up so much when it is sampled. */
static const double LEAST_SHARE = 0x1p-20;

typedef struct {
    PartedCell  *out;
    bool         triangle;
    const Shape *shape;      /* NULL: flat */
    Vec3         way[2][2];  /* flat: change of place over a and over b, in both halves */
    double       finest[PART_SLICERS]; /* a ball smaller than this sees all of a slicer */
} Cell;

typedef struct {
    Vec3   centre;
    double radius;
} Ball;

/* Of the cell's square. */
typedef struct {
    double a, b, wide;
} Square;

void patches_cell_place(bool triangle, PatchCell cell, double nu, double nv, double a, double b,
                        double *s, double *t)
{
    double u = a, v = b;
    if (triangle)
        sampling_triangle(a, b, &u, &v);
    *s = (triangle && cell.upper ? cell.i + 1 - u : cell.i + u) / nu;
    *t = (triangle && cell.upper ? cell.j + 1 - v : cell.j + v) / nv;
}

static SurfacePoint cell_point(const Cell *c, double a, double b)
{
    const PartedCell *out = c->out;
    SurfacePoint at;
    double s, t;
    patches_cell_place(c->triangle, out->cell, out->nu, out->nv, a, b, &s, &t);
    surfaces_point(out->surfaces, out->surface, s, t, &at);
    return at;
}

static void flat_ways(Cell *c)
{
    const Surfaces *s = c->out->surfaces;
    const Surface *f = &s->surface[c->out->surface];
    const uint32_t *corner = s->corner + 3 * (size_t)f->primitive;
    const double u = 1 / c->out->nu, v = 1 / c->out->nv;
    const Vec3 p = s->position[corner[0]], q = s->position[corner[1]], r = s->position[corner[2]];
    if (!c->triangle) {
        const Vec3 d = s->position[corner[5]];
        c->way[0][0] = vec3_scale(vec3_sub(q, p), u);
        c->way[0][1] = vec3_scale(vec3_sub(r, q), v);
        c->way[1][0] = vec3_scale(vec3_sub(r, d), u);
        c->way[1][1] = vec3_scale(vec3_sub(d, p), v);
        return;
    }
    /* How sampling_triangle shears either half of the square. */
    const Vec3 du = vec3_scale(vec3_sub(q, p), u), dv = vec3_scale(vec3_sub(r, p), v);
    c->way[0][0] = vec3_mad(vec3_scale(du, 0.5), -0.5, dv);
    c->way[0][1] = dv;
    c->way[1][0] = du;
    c->way[1][1] = vec3_mad(vec3_scale(dv, 0.5), -0.5, du);
}

/* A ball that holds a0..a1, b0..b1. */
static Ball ball_around(const Cell *c, double a0, double a1, double b0, double b1)
{
    const PartedCell *out = c->out;
    Ball ball = { cell_point(c, (a0 + a1) / 2, (b0 + b1) / 2).point, 0 };
    if (c->shape != NULL) {
        const PatchCell cell = out->cell;
        ball.radius = shape_reach(c->shape, (cell.i + a0) / out->nu, (cell.i + a1) / out->nu,
                                  (cell.j + b0) / out->nv, (cell.j + b1) / out->nv);
        return ball;
    }
    for (int k = 0; k < 2; k++) {
        const Vec3 a = vec3_scale(c->way[k][0], (a1 - a0) / 2);
        const Vec3 b = vec3_scale(c->way[k][1], (b1 - b0) / 2);
        ball.radius = fmax(ball.radius, vec3_length(vec3_add(a, b)));
        ball.radius = fmax(ball.radius, vec3_length(vec3_sub(a, b)));
    }
    return ball;
}

/* --- what parts it ---------------------------------------------------------------------------- */

static bool is_near_box(const Slicer *c, Ball ball, double margin)
{
    const double reach = ball.radius + margin;
    const Vec3 p = ball.centre;
    return p.x + reach >= c->lo.x && p.x - reach <= c->hi.x && p.y + reach >= c->lo.y
        && p.y - reach <= c->hi.y && p.z + reach >= c->lo.z && p.z - reach <= c->hi.z;
}

/* Whether a slicer may run through a square; `all` of it, or the surface that it stands for. */
static bool crosses(const Cell *c, const Slicer *slicer, bool all, Square square, unsigned depth)
{
    const double a = square.a, b = square.b, wide = square.wide;
    const Ball ball = ball_around(c, a, a + wide, b, b + wide);
    const double margin = slicer_margin(c->out->surfaces, slicer);
    if (fabs(slicer_side(c->out->surfaces, slicer, ball.centre)) > ball.radius + margin
        || !(all || is_near_box(slicer, ball, margin)))
        return false;
    if (depth == CROSS_DEPTH)
        return true;
    for (unsigned q = 0; q < 4; q++)
        if (crosses(c, slicer, all,
                    (Square){ a + wide / 2 * (q & 1), b + wide / 2 * (q >> 1), wide / 2 },
                    depth + 1))
            return true;
    return false;
}

/* Whether a slicer lies in the cell rather than crossing it: a disc in a floor. */
static bool lies_in(const Cell *c, const Slicer *slicer)
{
    const double margin = slicer_margin(c->out->surfaces, slicer);
    unsigned in = 0;
    for (unsigned k = 0; k < GRID * GRID; k++) {
        const double a = (k % GRID + 0.5) / GRID, b = (k / GRID + 0.5) / GRID;
        const Vec3 p = cell_point(c, a, b).point;
        in += fabs(slicer_side(c->out->surfaces, slicer, p)) <= margin;
    }
    return in > LIES_MOST;
}

typedef struct {
    double side;      /* sign of what came last; 0: nothing yet */
    unsigned changes;
} Walk;

static void walk_edge(const Cell *c, const Slicer *slicer, const double from[2],
                      const double to[2], unsigned depth, Walk *walk)
{
    const double middle[2] = { (from[0] + to[0]) / 2, (from[1] + to[1]) / 2 };
    const Ball ball = ball_around(c, fmin(from[0], to[0]), fmax(from[0], to[0]),
                                  fmin(from[1], to[1]), fmax(from[1], to[1]));
    const double side = slicer_side(c->out->surfaces, slicer, ball.centre);
    if (fabs(side) <= ball.radius && depth < EDGE_DEPTH) {
        walk_edge(c, slicer, from, middle, depth + 1, walk);
        walk_edge(c, slicer, middle, to, depth + 1, walk);
        return;
    }
    walk->changes += walk->side != 0 && (side > 0) != (walk->side > 0);
    walk->side = side;
}

/* Whether a curve crosses the cell's outline more than twice: then the places on one side of it may
 * not be connected. */
static bool comes_again(const Cell *c, const Slicer *slicer)
{
    static const double corner[5][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 0, 0 } };
    Walk walk = { 0 };
    for (unsigned k = 0; k < 4; k++)
        walk_edge(c, slicer, corner[k], corner[k + 1], 0, &walk);
    return walk.changes > 2;
}

static bool is_kept(uint32_t slicer, const uint32_t *kept, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++)
        if (kept[k] == slicer)
            return true;
    return false;
}

static void take(Cell *c, uint32_t slicer)
{
    PartedCell *out = c->out;
    const Slicer *what = &out->surfaces->slicer[slicer];
    if (out->slicers == PART_SLICERS)
        return;
    /* Seen by balls of a quarter of what is thinnest, no thing slips through. */
    c->finest[out->slicers] = what->kind == SLICER_SHAPE ? what->size / 4 : INFINITY;
    out->slicer[out->slicers++] = slicer;
}

static const Square WHOLE = { 0, 0, 1 };

static void choose_slicers(Cell *c, const uint32_t *kept, uint32_t kept_count)
{
    const Surfaces *s = c->out->surfaces;
    const uint32_t surface = c->out->surface;
    for (uint32_t i = s->cut_first[surface]; i < s->cut_first[surface + 1]; i++) {
        const uint32_t own = s->cut[i];
        const Slicer *slicer = &s->slicer[own];
        const bool known = is_kept(own, kept, kept_count);
        const bool met = crosses(c, slicer, known, WHOLE, 0) && (known || !lies_in(c, slicer));
        const bool again = met && slicer->splits > 0 && comes_again(c, slicer);
        if (met)
            take(c, own);
        for (uint32_t k = own + 1; k <= own + slicer->splits; k++)
            if (is_kept(k, kept, kept_count)
                    ? crosses(c, &s->slicer[k], true, WHOLE, 0)
                    : again || (met && s->slicer[k].kind == SLICER_SPLIT_RING))
                take(c, k);
    }
}

/* --- parts ------------------------------------------------------------------------------------ */

static PatchPart *part_with(PartedCell *out, uint32_t signs)
{
    for (uint32_t k = 0; k < out->parts; k++)
        if (out->part[k].signs == signs)
            return &out->part[k];
    return NULL;
}

static PatchPart *new_part(PartedCell *out, uint32_t signs, uint32_t most)
{
    if (out->parts >= most)
        return NULL;
    const uint32_t k = out->parts++;
    out->part[k] = (PatchPart){ .signs = signs, .a0 = 1, .b0 = 1 };
    out->area[k] = out->widest[k] = out->mean[k][0] = out->mean[k][1] = 0;
    return &out->part[k];
}

/* `share` of a square belongs to the part with these signs, about (a, b) of it. */
static void add_share(Cell *c, uint32_t signs, const Square *square, double share, double a,
                      double b)
{
    PartedCell *out = c->out;
    PatchPart *part = part_with(out, signs);
    if (part == NULL)
        part = new_part(out, signs, PARTS_MOST);
    if (part == NULL)
        return;
    const size_t k = (size_t)(part - out->part);
    part->a0 = fminf(part->a0, (float)square->a);
    part->a1 = fmaxf(part->a1, (float)(square->a + square->wide));
    part->b0 = fminf(part->b0, (float)square->b);
    part->b1 = fmaxf(part->b1, (float)(square->b + square->wide));
    part->share += share;
    out->area[k] += share * cell_point(c, a, b).density;
    out->mean[k][0] += share * a;
    out->mean[k][1] += share * b;
    if (share > out->widest[k]) {
        out->widest[k] = share;
        patches_cell_place(c->triangle, out->cell, out->nu, out->nv, a, b, &part->s, &part->t);
    }
}

/* Each square has a net of its own, lest what runs along squares be off by the same in all. */
static void add_samples(Cell *c, const Square *square)
{
    const uint32_t seed = sampling_seed((uint32_t)ldexp(square->a, DEPTH_MOST),
                                        (uint32_t)ldexp(square->b, DEPTH_MOST), 0, 0);
    for (uint32_t k = 0; k < SAMPLES; k++) {
        float x[2];
        uint32_t signs;
        sampling_sobol2(k, seed, x);
        const double a = square->a + square->wide * (double)x[0];
        const double b = square->b + square->wide * (double)x[1];
        if (slicer_signs(c->out->surfaces, c->out->slicer, c->out->slicers,
                         cell_point(c, a, b).point, &signs))
            add_share(c, signs, square, square->wide * square->wide / SAMPLES, a, b);
    }
}

typedef struct {
    uint32_t known, signs; /* of slicers that do not come near the square */
} Known;

static void add_square(Cell *c, Square square, unsigned depth, Known known)
{
    const PartedCell *out = c->out;
    const double wide = square.wide, half = wide / 2;
    const Ball ball = ball_around(c, square.a, square.a + wide, square.b, square.b + wide);
    const uint32_t all = (UINT32_C(1) << out->slicers) - 1;
    bool fine = true;
    for (uint32_t k = 0; k < out->slicers; k++) {
        const Slicer *slicer = &out->surfaces->slicer[out->slicer[k]];
        if (known.known >> k & 1)
            continue;
        const double side = slicer_side(out->surfaces, slicer, ball.centre);
        if (fabs(side) > ball.radius + slicer_margin(out->surfaces, slicer)) {
            known.known |= UINT32_C(1) << k;
            known.signs |= (uint32_t)(side > 0) << k;
        } else {
            fine = fine && ball.radius <= c->finest[k];
        }
    }
    if (known.known == all) {
        add_share(c, known.signs, &square, wide * wide, square.a + half, square.b + half);
        return;
    }
    if (depth == DEPTH_MOST || (depth >= DEPTH && fine)) {
        add_samples(c, &square);
        return;
    }
    for (unsigned q = 0; q < 4; q++)
        add_square(c, (Square){ square.a + half * (q & 1), square.b + half * (q >> 1), half },
                   depth + 1, known);
}

/* The place of a part is the middle of it where that belongs to it. */
static void centre_parts(Cell *c)
{
    PartedCell *out = c->out;
    for (uint32_t k = 0; k < out->parts; k++) {
        PatchPart *part = &out->part[k];
        const double a = out->mean[k][0] / part->share, b = out->mean[k][1] / part->share;
        uint32_t signs;
        if (slicer_signs(out->surfaces, out->slicer, out->slicers, cell_point(c, a, b).point,
                         &signs)
            && signs == part->signs)
            patches_cell_place(c->triangle, out->cell, out->nu, out->nv, a, b, &part->s, &part->t);
    }
}

void patches_part_cell(PartedCell *out, const uint32_t *kept, uint32_t kept_count)
{
    const Surfaces *s = out->surfaces;
    const Surface *f = &s->surface[out->surface];
    Cell c = { .out = out, .triangle = f->kind == SURFACE_TRIANGLE,
               .shape = patches_shape(s, f) };
    assert(s->cut_first != NULL);
    out->slicers = out->parts = 0;
    if (c.shape == NULL)
        flat_ways(&c);
    choose_slicers(&c, kept, kept_count);
    if (out->slicers == 0)
        return;
    add_square(&c, (Square){ 0, 0, 1 }, 0, (Known){ 0 });
    centre_parts(&c);
}

bool patches_part_add(PartedCell *out, double s, double t)
{
    static const uint32_t NO_SIGNS = UINT32_MAX; /* there are less than 32 slicers */
    SurfacePoint at;
    uint32_t signs;
    surfaces_point(out->surfaces, out->surface, s, t, &at);
    if (!slicer_signs(out->surfaces, out->slicer, out->slicers, at.point, &signs)
        || part_with(out, signs) != NULL)
        signs = NO_SIGNS;
    PatchPart *part = new_part(out, signs, PARTS_ROOM);
    if (part == NULL)
        return false;
    part->a0 = part->b0 = 0;
    part->a1 = part->b1 = 1;
    part->s = s;
    part->t = t;
    part->share = LEAST_SHARE;
    out->area[out->parts - 1] = LEAST_SHARE * at.density;
    return true;
}
