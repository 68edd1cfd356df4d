/* SPDX-License-Identifier: BSD-3-Clause */
/* Open edges, and the rims that they form.
 *
 * An edge is cut at the corners of others that lie on it. A face and its back count as two: a plate
 * is a body without thickness, not a hole.
 */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "inspect/internal.h"

/* Open edges at a vertex that are paired by the angle between them; beyond, in their order. */
enum { TURN_MOST = 64 };

static const double PI = 3.14159265358979323846;

/* Edges that turn back by less, in radians, run along each other: a slit, whose sign is rounding's
 * choice. Float corners are off by 2^-24 of the scene; edges are rarely shorter than a tenth. */
static const double SLIT_ANGLE = 0x1p-20;

uint32_t inspect_corner(const Surfaces *s, uint32_t surface, unsigned k)
{
    const uint32_t *corner = s->corner + 3 * (size_t)s->surface[surface].primitive;
    assert(k < 4 && s->surface[surface].kind != SURFACE_SHAPE);
    return k < 3 ? corner[k] : corner[5]; /* a quad's second triangle is (a,c,d) */
}

/* The triangle that edge k of a surface belongs to. */
static uint32_t edge_triangle(const Surfaces *s, uint32_t surface, unsigned k)
{
    return s->surface[surface].primitive + (k >= 2 && s->surface[surface].kind == SURFACE_QUAD);
}

static unsigned corners_of(const Surface *f)
{
    return f->kind == SURFACE_TRIANGLE ? 3 : f->kind == SURFACE_QUAD ? 4 : 0;
}

/* --- how many faces an edge has --------------------------------------------------------------- */

typedef struct {
    uint64_t *key;    /* [mask + 1]  smaller vertex above, larger below, plus one; 0: free */
    uint8_t  *faces;  /* [mask + 1]  at most 3 are counted */
    size_t    mask;
} EdgeTable;

static bool table_create(EdgeTable *table, size_t most, Error *err)
{
    size_t slots = 16;
    while (slots < 2 * most)
        slots *= 2;
    table->mask = slots - 1;
    table->key = array_create(slots, sizeof *table->key, "edges", err);
    table->faces = array_create(slots, sizeof *table->faces, "edges", err);
    return !error_is_set(err);
}

static size_t table_slot(const EdgeTable *table, uint32_t a, uint32_t b)
{
    const uint64_t key = ((uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a)) + 1;
    uint64_t hash = key * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
    size_t slot = (size_t)(hash * 0x9E3779B97F4A7C15u >> 20) & table->mask;
    while (table->key[slot] != 0 && table->key[slot] != key)
        slot = (slot + 1) & table->mask;
    table->key[slot] = key;
    return slot;
}

/* Calls for each piece of each edge, in the order of the surfaces; false when a call was. */
typedef bool (*EdgeVisit)(void *context, uint32_t triangle, uint32_t from, uint32_t to);

static bool visit_edges(const Surfaces *s, EdgeVisit visit, void *context)
{
    for (uint32_t i = 0; i < s->count; i++) {
        const unsigned corners = corners_of(&s->surface[i]);
        for (unsigned k = 0; k < corners; k++) {
            uint32_t from = inspect_corner(s, i, k);
            const uint32_t last = inspect_corner(s, i, (k + 1) % corners);
            uint32_t at = s->stitch_first != NULL ? s->stitch_first[4 * (size_t)i + k] : 0;
            const uint32_t end = s->stitch_first != NULL ? s->stitch_first[4 * (size_t)i + k + 1]
                                                         : 0;
            const uint32_t triangle = edge_triangle(s, i, k);
            for (; at < end; at++) {
                if (!visit(context, triangle, from, s->stitch[at].vertex))
                    return false;
                from = s->stitch[at].vertex;
            }
            if (!visit(context, triangle, from, last))
                return false;
        }
    }
    return true;
}

typedef struct {
    Inspector *in;
    EdgeTable  table;
    size_t     capacity;  /* of in->out->edge */
} Counter;

static bool count_edge(void *context, uint32_t triangle, uint32_t from, uint32_t to)
{
    Counter *counter = context;
    if (from == to)
        return true;
    uint8_t *faces = &counter->table.faces[table_slot(&counter->table, from, to)];
    *faces = (uint8_t)(*faces + (*faces < 3));
    if (counter->in->surfaces->triangle_back[triangle] != SURFACE_NONE)
        *faces = (uint8_t)(*faces + (*faces < 3));
    return true;
}

static bool keep_open(void *context, uint32_t triangle, uint32_t from, uint32_t to)
{
    Counter    *counter = context;
    Inspector  *in = counter->in;
    Inspection *out = in->out;
    if (from == to || counter->table.faces[table_slot(&counter->table, from, to)] != 1)
        return true;
    if (!array_reserve((void **)&out->edge, &counter->capacity, out->open_edges + 1,
                       sizeof *out->edge, "open edges", in->err))
        return false;
    out->edge[out->open_edges++] = (OpenEdge){ from, to, triangle };
    const Vec3   a = in->surfaces->position[from], b = in->surfaces->position[to];
    const Defect defect = { .kind = DEFECT_OPEN_EDGE, .other = DEFECT_NO_FACE,
                            .face = in->surfaces->triangle_face[triangle],
                            .at = vec3_lerp(a, b, 0.5),
                            .measure = vec3_length(vec3_sub(a, b)) };
    return defects_add(in->defects, &defect, in->err);
}

static bool find_open(Inspector *in)
{
    const Surfaces *s = in->surfaces;
    const size_t    stitches = s->stitch_first != NULL ? s->stitch_first[4 * (size_t)s->count] : 0;
    Counter         counter = { .in = in };
    const bool ok = table_create(&counter.table, 4 * (size_t)s->count + stitches, in->err) &&
                    visit_edges(s, count_edge, &counter) && visit_edges(s, keep_open, &counter);
    array_free(counter.table.key);
    array_free(counter.table.faces);
    return ok;
}

/* --- chains ----------------------------------------------------------------------------------- */

/* End 2 e is where open edge e begins, 2 e + 1 where it ends. */
typedef struct {
    const Inspector *in;
    uint32_t *first;   /* [vertices + 1]  ends at a vertex in `end` */
    uint32_t *end;     /* [2 * open edges] */
    uint32_t *mate;    /* [2 * open edges]  end that goes on from it, or itself */
    uint8_t  *used;    /* [open edges] */
    uint32_t *chain;   /* [open edges + 1]  vertices of the rim being followed */
} Chains;

static uint32_t end_vertex(const Inspector *in, uint32_t end)
{
    const OpenEdge *e = &in->out->edge[end / 2];
    return end % 2 == 0 ? e->from : e->to;
}

static Vec3 end_direction(const Inspector *in, uint32_t end)
{
    const Vec3 *p = in->surfaces->position;
    return vec3_sub(p[end_vertex(in, end ^ 1)], p[end_vertex(in, end)]);
}

static Vec3 triangle_normal(const Surfaces *s, uint32_t triangle)
{
    const uint32_t *corner = s->corner + 3 * (size_t)triangle;
    const Vec3      a = s->position[corner[0]];
    return vec3_unit(vec3_cross(vec3_sub(s->position[corner[1]], a),
                                vec3_sub(s->position[corner[2]], a)));
}

/* Angle from the edge that arrives back round over the hole to the one that leaves, 0..2 pi: faces
 * lie to the left of their edges, so the hole is met turning counter-clockwise. */
static double turn_angle(const Inspector *in, uint32_t arriving, uint32_t leaving)
{
    const Vec3 n = triangle_normal(in->surfaces, in->out->edge[arriving / 2].triangle);
    const Vec3 d = end_direction(in, arriving), o = end_direction(in, leaving);
    const double angle = atan2(vec3_dot(n, vec3_cross(d, o)), vec3_dot(d, o));
    return angle > -SLIT_ANGLE ? angle : angle + 2 * PI;
}

static void pair_by_turn(Chains *c, const uint32_t *end, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        uint32_t best = end[i];
        double   least = INFINITY;
        for (uint32_t k = 0; end[i] % 2 == 1 && k < n; k++) {
            if (end[k] % 2 == 1 || c->mate[end[k]] != end[k])
                continue;
            const double angle = turn_angle(c->in, end[i], end[k]);
            if (angle < least) {
                least = angle;
                best = end[k];
            }
        }
        c->mate[end[i]] = best == end[i] ? c->mate[end[i]] : best;
        c->mate[best] = best == end[i] ? c->mate[best] : end[i];
    }
}

/* What goes on where, at each vertex; ends left over in odd numbers go nowhere. */
static void pair_ends(Chains *c, uint32_t vertex)
{
    const uint32_t *end = c->end + c->first[vertex];
    const uint32_t  n = c->first[vertex + 1] - c->first[vertex];
    uint32_t        alone = UINT32_MAX;
    if (n > 2 && n <= TURN_MOST)
        pair_by_turn(c, end, n);
    for (uint32_t i = 0; i < n; i++) {
        if (c->mate[end[i]] != end[i])
            continue;
        if (alone == UINT32_MAX) {
            alone = end[i];
        } else {
            c->mate[alone] = end[i];
            c->mate[end[i]] = alone;
            alone = UINT32_MAX;
        }
    }
}

static bool chains_create(Chains *c, Error *err)
{
    const Inspector *in = c->in;
    const uint32_t   vertices = in->surfaces->vertex_count;
    const uint32_t   ends = (uint32_t)(2 * in->out->open_edges);
    c->first = array_create((size_t)vertices + 2, sizeof *c->first, "rims", err);
    c->end = array_create(ends, sizeof *c->end, "rims", err);
    c->mate = array_create(ends, sizeof *c->mate, "rims", err);
    c->used = array_create(ends / 2, sizeof *c->used, "rims", err);
    c->chain = array_create((size_t)ends / 2 + 1, sizeof *c->chain, "rims", err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < ends; i++)
        c->first[end_vertex(in, i) + 2]++;
    for (uint32_t v = 2; v < vertices + 2; v++)
        c->first[v] += c->first[v - 1];
    for (uint32_t i = 0; i < ends; i++) {
        c->end[c->first[end_vertex(in, i) + 1]++] = i;
        c->mate[i] = i;
    }
    for (uint32_t v = 0; v < vertices; v++)
        pair_ends(c, v);
    return true;
}

static void chains_clear(Chains *c)
{
    array_free(c->first);
    array_free(c->end);
    array_free(c->mate);
    array_free(c->used);
    array_free(c->chain);
}

/* Whether n points lie in a plane: their own, with the normal of the area that they enclose. */
static bool chain_flat(const Surfaces *s, const uint32_t *chain, uint32_t n)
{
    const Vec3 origin = s->position[chain[0]];
    Vec3       normal = vec3(0, 0, 0), middle = normal;
    double     largest = 0;
    for (uint32_t i = 0; i < n; i++) {
        const Vec3 p = s->position[chain[i]], q = s->position[chain[(i + 1) % n]];
        normal = vec3_add(normal, vec3_cross(vec3_sub(p, origin), vec3_sub(q, origin)));
        middle = vec3_mad(middle, 1.0 / n, vec3_sub(p, origin));
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    normal = vec3_unit(normal);
    middle = vec3_add(middle, origin);
    double off = 0;
    for (uint32_t i = 0; i < n; i++)
        off = fmax(off, fabs(vec3_dot(normal, vec3_sub(s->position[chain[i]], middle))));
    return off <= inspect_tolerance(largest);
}

/* Follows the rim that holds open edge `seed`; in the direction of its face. */
static Rim follow_rim(Chains *c, uint32_t seed)
{
    const Inspector *in = c->in;
    const Surfaces  *s = in->surfaces;
    Rim rim = { .face = s->triangle_face[in->out->edge[seed].triangle],
                .lo = { INFINITY, INFINITY, INFINITY }, .hi = { -INFINITY, -INFINITY, -INFINITY } };
    uint32_t begin = 2 * seed, at = begin;
    /* A chain that ends is followed from its end; one that closes may begin anywhere. */
    while (c->mate[at] != at && (c->mate[at] ^ 1) != begin)
        at = c->mate[at] ^ 1;
    begin = c->mate[at] == at ? at : begin;
    at = begin;
    do {
        const Vec3 p = s->position[end_vertex(in, at)], q = s->position[end_vertex(in, at ^ 1)];
        c->used[at / 2] = 1;
        c->chain[rim.edges++] = end_vertex(in, at);
        rim.length += vec3_length(vec3_sub(p, q));
        rim.lo = vec3_min(rim.lo, vec3_min(p, q));
        rim.hi = vec3_max(rim.hi, vec3_max(p, q));
        c->chain[rim.edges] = end_vertex(in, at ^ 1);
        at = c->mate[at ^ 1] == (at ^ 1) ? begin : c->mate[at ^ 1];
    } while (at != begin);
    const bool closes = c->chain[rim.edges] == c->chain[0];
    rim.flat = chain_flat(s, c->chain, rim.edges + !closes);
    return rim;
}

static int longest_first(const void *a, const void *b)
{
    const Rim *p = a, *q = b;
    if (p->length != q->length)
        return p->length < q->length ? 1 : -1;
    return (p->face > q->face) - (p->face < q->face);
}

static bool collect_rims(Chains *c, Error *err)
{
    Inspection *out = c->in->out;
    size_t      capacity = 0;
    const size_t keep = c->in->options->keep;
    for (uint32_t e = 0; e < out->open_edges; e++) {
        if (c->used[e])
            continue;
        const Rim rim = follow_rim(c, e);
        if (!array_reserve((void **)&out->rim, &capacity, out->rim_count + 1, sizeof *out->rim,
                           "rims", err))
            return false;
        out->rim[out->rim_count++] = rim;
    }
    out->rims = out->rim_count;
    if (out->rim_count > 0)
        qsort(out->rim, out->rim_count, sizeof *out->rim, longest_first);
    if (keep > 0 && out->rim_count > keep)
        out->rim_count = keep;
    return true;
}

bool inspect_rims(Inspector *in)
{
    const Surfaces *s = in->surfaces;
    if (!find_open(in))
        return false;
    for (uint32_t i = 0; i < s->shape_count; i++)
        in->out->bordered += s->shape[i].kind == SHAPE_DISC || s->shape[i].kind == SHAPE_FRUSTUM;
    Chains     chains = { .in = in };
    const bool ok = chains_create(&chains, in->err) && collect_rims(&chains, in->err);
    chains_clear(&chains);
    return ok;
}
