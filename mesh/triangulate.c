/* SPDX-License-Identifier: BSD-3-Clause */
/* Ear clipping for polygons as they come from files. */
#include "mesh/triangulate.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/triangulate_internal.h"

/* Outlines of more corners are cut with a search tree. */
enum { FEW = 256 };

/* Tests spent per ear on looking for a fatter one. */
enum { CHOICE_TESTS = 4096 };

/* Corner-in-ear tests per polygon; an outline that crosses itself in a hundred places must not take
 * a second. */
static const uint64_t TEST_LIMIT = UINT64_C(20000000);

static double largest3(double a, double b, double c) { return fmax(a, fmax(b, c)); }

static double largest_of(Vec3 p) { return largest3(fabs(p.x), fabs(p.y), fabs(p.z)); }

Vec3 triangulate_normal(const Vec3 *position, const uint32_t *corner, uint32_t count)
{
    assert(count >= 3);
    const Vec3 origin = position[corner[0]];
    Vec3 sum = { 0 };
    for (uint32_t i = 1; i + 1 < count; i++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(position[corner[i]], origin),
                                       vec3_sub(position[corner[i + 1]], origin)));
    return sum;
}

bool triangulate_is_sliver(Vec3 a, Vec3 b, Vec3 c)
{
    const Vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), bc = vec3_sub(c, b);
    const double doubled = vec3_length(vec3_cross(ab, ac));
    const double longest = largest3(vec3_length(ab), vec3_length(ac), vec3_length(bc));
    const double largest = largest3(largest_of(a), largest_of(b), largest_of(c));
    return !(doubled > longest * position_tolerance(largest)) || !isfinite(doubled);
}

static bool same_place(const CutCorner *a, const CutCorner *b)
{
    return a->vertex == b->vertex || (a->x == b->x && a->y == b->y);
}

double ear_distance(const CutCorner *a, const CutCorner *b)
{
    return hypot(a->x - b->x, a->y - b->y);
}

static double ear_longest(const CutCorner *a, const CutCorner *b, const CutCorner *c)
{
    return largest3(ear_distance(a, b), ear_distance(b, c), ear_distance(c, a));
}

static bool in_cone(const CutCorner *apex, const CutCorner *right, const CutCorner *left,
                    const CutCorner *p)
{
    return ear_turn(apex, right, p) > 0 && ear_turn(apex, p, left) > 0;
}

bool ear_blocked(const Clipper *clip, const CutCorner *const ear[3], const CutCorner *w,
                 EarDemand demand)
{
    for (int k = 0; k < 3; k++)
        if (same_place(w, ear[k])) {
            const CutCorner *right = ear[(k + 1) % 3], *left = ear[(k + 2) % 3];
            return in_cone(ear[k], right, left, &clip->ring[w->previous])
                || in_cone(ear[k], right, left, &clip->ring[w->next]);
        }
    for (int k = 0; k < 3; k++) {
        const CutCorner *from = ear[k], *to = ear[(k + 1) % 3];
        const double inside = ear_turn(from, to, w);
        if (demand == EAR_CLEAN ? inside < -clip->tolerance * ear_distance(from, to) : inside <= 0)
            return false;
    }
    return true;
}

/* Walks round the ring. */
static bool ear_is_free(Clipper *clip, uint32_t i, EarDemand demand)
{
    const CutCorner *b = &clip->ring[i];
    const CutCorner *const ear[3] = { &clip->ring[b->previous], b, &clip->ring[b->next] };
    const double x0 = fmin(ear[0]->x, fmin(b->x, ear[2]->x)) - clip->tolerance;
    const double x1 = largest3(ear[0]->x, b->x, ear[2]->x) + clip->tolerance;
    const double y0 = fmin(ear[0]->y, fmin(b->y, ear[2]->y)) - clip->tolerance;
    const double y1 = largest3(ear[0]->y, b->y, ear[2]->y) + clip->tolerance;
    for (uint32_t j = ear[2]->next; j != b->previous; j = clip->ring[j].next) {
        const CutCorner *w = &clip->ring[j];
        clip->tests++;
        if (w->x >= x0 && w->x <= x1 && w->y >= y0 && w->y <= y1
            && ear_blocked(clip, ear, w, demand))
            return false;
    }
    return true;
}

double ear_grade(Clipper *clip, uint32_t i, EarDemand demand)
{
    const CutCorner *b = &clip->ring[i];
    const CutCorner *a = &clip->ring[b->previous], *c = &clip->ring[b->next];
    const double doubled = ear_turn(a, b, c);
    const double longest = ear_longest(a, b, c);
    const double height = longest > 0 ? doubled / longest : 0;
    if (demand == EAR_FLAT)
        return fabs(height) <= clip->tolerance ? 1 : -1;
    if (demand == EAR_FORCED)
        return doubled > 0 ? height / longest : -1;
    if (!(height > clip->tolerance) || !clip->is_free(clip, i, demand))
        return -1;
    return height / longest;
}

/* Finds the corner to cut next, from *start on round the ring. */
static bool ear_find(Clipper *clip, EarDemand demand, uint32_t start, uint32_t *ear)
{
    const uint32_t choice = 1 + CHOICE_TESTS / clip->left;
    double best = -1;
    uint32_t i = start, found = 0;
    for (uint32_t k = 0; k < clip->left && found < choice; k++, i = clip->ring[i].next) {
        if (demand < EAR_FLAT && clip->tests > clip->most)
            break;
        const double grade = ear_grade(clip, i, demand);
        found += grade >= 0;
        if (grade > best) {
            best = grade;
            *ear = i;
        }
    }
    return best >= 0;
}

static void ear_emit(Triangulation *cut, const CutCorner *a, const CutCorner *b, const CutCorner *c)
{
    uint32_t *out = cut->triangle + 3 * cut->count++;
    out[0] = a->vertex;
    out[1] = b->vertex;
    out[2] = c->vertex;
}

uint32_t ear_cut(Triangulation *cut, Clipper *clip, uint32_t i, bool keep)
{
    CutCorner *b = &clip->ring[i], *a = &clip->ring[b->previous], *c = &clip->ring[b->next];
    if (keep)
        ear_emit(cut, a, b, c);
    else if (!same_place(a, c) && !same_place(a, b) && !same_place(b, c))
        cut->dropped++;
    a->next = b->next;
    c->previous = b->previous;
    clip->left--;
    return b->next;
}

static uint32_t clip_few(Triangulation *cut, Clipper *clip)
{
    uint32_t at = 0;
    while (clip->left > 3) {
        uint32_t ear = at;
        EarDemand demand = EAR_CLEAN;
        while (demand <= EAR_FORCED && !ear_find(clip, demand, at, &ear))
            demand++;
        cut->crossing |= demand >= EAR_FORCED;
        at = ear_cut(cut, clip, ear, demand != EAR_FLAT && demand <= EAR_FORCED);
    }
    return at;
}

static bool clip_ears(Triangulation *cut, Clipper *clip, Error *err)
{
    uint32_t at = 0;
    if (clip->left <= FEW)
        at = clip_few(cut, clip);
    else if (!ears_clip_many(cut, clip, &at, err))
        return false;
    const CutCorner *b = &clip->ring[at];
    const CutCorner *a = &clip->ring[b->previous], *c = &clip->ring[b->next];
    if (ear_turn(a, b, c) > ear_longest(a, b, c) * clip->tolerance)
        ear_emit(cut, a, b, c);
    else if (!same_place(a, c) && !same_place(a, b) && !same_place(b, c))
        cut->dropped++;
    return true;
}

/* Drops the largest axis of the normal, which leaves coordinates as exact as they were. */
static void ring_project(CutCorner *ring, uint32_t count, const Vec3 *position, Vec3 normal)
{
    const double x = fabs(normal.x), y = fabs(normal.y), z = fabs(normal.z);
    const int axis = z >= x && z >= y ? 2 : y >= x ? 1 : 0;
    const bool turned = vec3_axis(normal, axis) < 0;
    const int first = (axis + (turned ? 2 : 1)) % 3, second = (axis + (turned ? 1 : 2)) % 3;
    for (uint32_t i = 0; i < count; i++) {
        ring[i].x = vec3_axis(position[ring[i].vertex], first);
        ring[i].y = vec3_axis(position[ring[i].vertex], second);
        ring[i].previous = i == 0 ? count - 1 : i - 1;
        ring[i].next = i + 1 == count ? 0 : i + 1;
    }
}

/* Whether the quad splits at corner k (0 or 1) into two halves that lie like one smooth surface. */
static bool quad_splits(const CutCorner *q, const Vec3 *position, int k)
{
    const CutCorner *a = &q[k], *b = &q[k + 1], *c = &q[k + 2], *d = &q[(k + 3) % 4];
    const Vec3 pa = position[a->vertex], pb = position[b->vertex];
    const Vec3 pc = position[c->vertex], pd = position[d->vertex];
    if (!(ear_turn(a, b, c) > 0 && ear_turn(a, c, d) > 0) || triangulate_is_sliver(pa, pb, pc)
        || triangulate_is_sliver(pa, pc, pd))
        return false;
    const Vec3 ac = vec3_sub(pc, pa);
    const Vec3 n1 = vec3_unit(vec3_cross(vec3_sub(pb, pa), ac));
    const Vec3 n2 = vec3_unit(vec3_cross(ac, vec3_sub(pd, pa)));
    return vec3_dot(n1, n2) >= TOLERANCE_CREASE_COSINE;
}

/* A convex quad stays whole, cut along its shorter diagonal; of equal ones the one with the least
 * vertex, so that the same quad is cut alike from whatever corner it is told. */
static bool cut_quad(Triangulation *cut, const CutCorner *q, const Vec3 *position,
                     double tolerance)
{
    for (int k = 0; k < 4; k++) {
        const CutCorner *a = &q[k], *b = &q[(k + 1) % 4], *c = &q[(k + 2) % 4];
        if (ear_turn(a, b, c) < -tolerance * ear_longest(a, b, c))
            return false;
    }
    const bool splits[2] = { quad_splits(q, position, 0), quad_splits(q, position, 1) };
    const Vec3 ac = vec3_sub(position[q[2].vertex], position[q[0].vertex]);
    const Vec3 bd = vec3_sub(position[q[3].vertex], position[q[1].vertex]);
    const double length_ac = vec3_dot(ac, ac), length_bd = vec3_dot(bd, bd);
    const uint32_t least_ac = q[0].vertex < q[2].vertex ? q[0].vertex : q[2].vertex;
    const uint32_t least_bd = q[1].vertex < q[3].vertex ? q[1].vertex : q[3].vertex;
    if (!splits[0] && !splits[1])
        return false;
    const bool prefer_ac = length_ac < length_bd || (length_ac == length_bd && least_ac < least_bd);
    const int k = splits[0] && (prefer_ac || !splits[1]) ? 0 : 1;
    ear_emit(cut, &q[k], &q[k + 1], &q[k + 2]);
    ear_emit(cut, &q[k], &q[k + 2], &q[(k + 3) % 4]);
    cut->quad = true;
    return true;
}

/* Copies the corners without repeats in a row. */
static uint32_t ring_fill(CutCorner *ring, const uint32_t *corner, uint32_t count)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++)
        if (n == 0 || ring[n - 1].vertex != corner[i])
            ring[n++].vertex = corner[i];
    while (n > 1 && ring[n - 1].vertex == ring[0].vertex)
        n--;
    return n;
}

static Vec3 ring_normal(const CutCorner *ring, uint32_t count, const Vec3 *position,
                        double *largest, double *extent)
{
    const Vec3 origin = position[ring[0].vertex];
    Vec3 sum = { 0 };
    *largest = largest_of(origin);
    *extent = 0;
    for (uint32_t i = 1; i < count; i++) {
        const Vec3 p = vec3_sub(position[ring[i].vertex], origin);
        *largest = fmax(*largest, largest_of(position[ring[i].vertex]));
        *extent = fmax(*extent, vec3_length(p));
        if (i + 1 < count)
            sum = vec3_add(sum, vec3_cross(p, vec3_sub(position[ring[i + 1].vertex], origin)));
    }
    return sum;
}

/* An outline whose parts cancel, like an hourglass, has no plane: corner 0 sees all others. */
static void cut_fan(Triangulation *cut, const CutCorner *ring, uint32_t count,
                    const Vec3 *position)
{
    for (uint32_t i = 1; i + 1 < count; i++) {
        if (triangulate_is_sliver(position[ring[0].vertex], position[ring[i].vertex],
                                  position[ring[i + 1].vertex]))
            continue;
        ear_emit(cut, &ring[0], &ring[i], &ring[i + 1]);
        cut->crossing = count > 3;
    }
    if (cut->count == 0)
        cut->dropped = 1;
}

bool triangulate(Triangulation *cut, const Vec3 *position, const uint32_t *corner, uint32_t count,
                 Error *err)
{
    assert(cut != NULL && position != NULL && corner != NULL && err != NULL);
    cut->count = 0;
    cut->dropped = 0;
    cut->quad = cut->crossing = false;
    if (!array_reserve((void **)&cut->ring, &cut->ring_capacity, count, sizeof *cut->ring,
                       "polygon corners", err)
        || !array_reserve((void **)&cut->triangle, &cut->capacity, 3 * (size_t)count,
                          sizeof *cut->triangle, "polygon corners", err))
        return false;
    const uint32_t n = ring_fill(cut->ring, corner, count);
    if (n < 3) {
        cut->dropped = 1;
        return true;
    }
    double largest, extent;
    const Vec3 normal = ring_normal(cut->ring, n, position, &largest, &extent);
    const double tolerance = position_tolerance(largest);
    if (n == 3 || !(vec3_length(normal) > tolerance * extent)) {
        cut_fan(cut, cut->ring, n, position);
        return true;
    }
    ring_project(cut->ring, n, position, normal);
    if (n == 4 && cut_quad(cut, cut->ring, position, tolerance))
        return true;
    Clipper clip = { .ring = cut->ring, .left = n, .tolerance = tolerance, .most = TEST_LIMIT,
                     .is_free = ear_is_free };
    if (!clip_ears(cut, &clip, err))
        return false;
    if (cut->count == 0 && cut->dropped == 0)
        cut->dropped = 1;
    return true;
}

void triangulation_clear(Triangulation *cut)
{
    array_free(cut->triangle);
    array_free(cut->ring);
    *cut = (Triangulation){ 0 };
}
