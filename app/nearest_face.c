/* SPDX-License-Identifier: BSD-3-Clause */
/* Boxes around the triangles of faces, halved at the median, and the nearest of them. */
#include "app/nearest_face.h"

#include <assert.h>
#include <stdlib.h>

#include "base/array.h"
#include "math/mean_value.h"

enum { LEAF = 4 };
/* A triangle of another division of the same curved face turns less than this: 60 degrees. */
static const double LIKE_COSINE = 0.5;

typedef struct {
    uint32_t face, corner[3];
    Vec3     middle;
} Triangle;

/* Children of node i are 2 i + 1 and 2 i + 2: the halves of its range. */
typedef struct {
    Vec3 lo, hi;
} Box;

struct NearestFaces {
    const SolvedMesh *mesh;
    Triangle *triangle;
    size_t    triangle_count;
    Box      *box;      /* [box_count] */
    size_t    box_count;
    Vec3     *normal;   /* [face_count]  unit, or 0 of a face without area */
};

/* --- making it -------------------------------------------------------------------------------- */

static Vec3 corner_of(const NearestFaces *n, const Triangle *t, int k)
{
    return n->mesh->position[t->corner[k]];
}

static void fill_triangles(NearestFaces *n)
{
    const SolvedMesh *m = n->mesh;
    for (uint32_t f = 0; f < m->face_count; f++) {
        const uint32_t first = m->first_corner[f], count = m->first_corner[f + 1] - first;
        const IndexPolygon polygon = { m->position, m->corner + first, count };
        n->normal[f] = vec3_unit(polygon_area(&polygon));
        for (uint32_t k = 1; k + 1 < count; k++) {
            Triangle *t = &n->triangle[n->triangle_count++];
            *t = (Triangle){ .face = f, .corner = { m->corner[first], m->corner[first + k],
                                                    m->corner[first + k + 1] } };
            t->middle = vec3_scale(vec3_add(vec3_add(corner_of(n, t, 0), corner_of(n, t, 1)),
                                            corner_of(n, t, 2)), 1.0 / 3);
        }
    }
}

static int compare_places(const Triangle *a, const Triangle *b, double x, double y)
{
    if (x != y)
        return x < y ? -1 : 1;
    if (a->face != b->face)
        return a->face < b->face ? -1 : 1;
    return a->corner[1] < b->corner[1] ? -1 : a->corner[1] > b->corner[1];
}
static int compare_x(const void *a, const void *b)
{
    const Triangle *s = a, *t = b;
    return compare_places(s, t, s->middle.x, t->middle.x);
}
static int compare_y(const void *a, const void *b)
{
    const Triangle *s = a, *t = b;
    return compare_places(s, t, s->middle.y, t->middle.y);
}
static int compare_z(const void *a, const void *b)
{
    const Triangle *s = a, *t = b;
    return compare_places(s, t, s->middle.z, t->middle.z);
}

static Box box_of(const NearestFaces *n, size_t begin, size_t end)
{
    const Vec3 any = n->mesh->position[n->triangle[begin].corner[0]];
    Box box = { any, any };
    for (size_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++) {
            box.lo = vec3_min(box.lo, corner_of(n, &n->triangle[i], k));
            box.hi = vec3_max(box.hi, corner_of(n, &n->triangle[i], k));
        }
    return box;
}

static void build(NearestFaces *n, size_t node, size_t begin, size_t end)
{
    static int (*const by_axis[3])(const void *, const void *) = { compare_x, compare_y,
                                                                   compare_z };
    assert(node < n->box_count && begin < end);
    n->box[node] = box_of(n, begin, end);
    if (end - begin <= LEAF)
        return;
    const Vec3 d = vec3_sub(n->box[node].hi, n->box[node].lo);
    const int axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
    qsort(n->triangle + begin, end - begin, sizeof *n->triangle, by_axis[axis]);
    const size_t middle = begin + (end - begin) / 2;
    build(n, 2 * node + 1, begin, middle);
    build(n, 2 * node + 2, middle, end);
}

/* Boxes of a tree whose larger halves hold (n + 1) / 2. */
static size_t boxes_for(size_t triangles)
{
    size_t boxes = 1;
    for (size_t n = triangles; n > LEAF; n = (n + 1) / 2)
        boxes = 2 * boxes + 1;
    return boxes;
}

NearestFaces *nearest_faces_create(const SolvedMesh *mesh, Error *err)
{
    NearestFaces *n = array_create(1, sizeof *n, "face search", err);
    if (n == NULL)
        return NULL;
    const size_t corners = mesh->first_corner[mesh->face_count];
    const size_t triangles = corners - 2 * (size_t)mesh->face_count;
    n->mesh = mesh;
    n->box_count = boxes_for(triangles);
    n->triangle = array_create(triangles, sizeof *n->triangle, "face search", err);
    n->box = array_create(n->box_count, sizeof *n->box, "face search", err);
    n->normal = array_create(mesh->face_count, sizeof *n->normal, "face search", err);
    if (error_is_set(err))
        return nearest_faces_destroy(n);
    fill_triangles(n);
    assert(n->triangle_count == triangles);
    if (triangles > 0)
        build(n, 0, 0, triangles);
    return n;
}

NearestFaces *nearest_faces_destroy(NearestFaces *n)
{
    if (n == NULL)
        return NULL;
    array_free(n->triangle);
    array_free(n->box);
    array_free(n->normal);
    return array_free(n);
}

/* --- asking it -------------------------------------------------------------------------------- */

typedef struct {
    const NearestFaces *n;
    Vec3         point, normal;
    uint32_t     group;
    double       best;   /* square of the distance */
    bool         found;
    NearestFace *out;
} Search;

static double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

/* The point of triangle abc next to p, by the region of its plane that p lies in [ericson05]. */
static Vec3 triangle_nearest(Vec3 p, Vec3 a, Vec3 b, Vec3 c)
{
    const Vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a);
    const Vec3 ap = vec3_sub(p, a), bp = vec3_sub(p, b), cp = vec3_sub(p, c);
    const double d1 = vec3_dot(ab, ap), d2 = vec3_dot(ac, ap);
    const double d3 = vec3_dot(ab, bp), d4 = vec3_dot(ac, bp);
    const double d5 = vec3_dot(ab, cp), d6 = vec3_dot(ac, cp);
    if (d1 <= 0 && d2 <= 0)
        return a;
    if (d3 >= 0 && d4 <= d3)
        return b;
    if (d6 >= 0 && d5 <= d6)
        return c;
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return vec3_mad(a, share(d1, d1 - d3), ab);
    if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return vec3_mad(a, share(d2, d2 - d6), ac);
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return vec3_mad(b, share(d4 - d3, (d4 - d3) + (d5 - d6)), vec3_sub(c, b));
    const double sum = va + vb + vc;
    return vec3_mad(vec3_mad(a, share(vb, sum), ab), share(vc, sum), ac);
}

static double box_distance(const Box *box, Vec3 p)
{
    const Vec3 d = vec3_max(vec3_max(vec3_sub(box->lo, p), vec3_sub(p, box->hi)), vec3(0, 0, 0));
    return vec3_dot(d, d);
}

static void look_at(Search *s, const Triangle *t)
{
    const SolvedMesh *m = s->n->mesh;
    if (m->group[t->face] != s->group ||
        !(vec3_dot(s->n->normal[t->face], s->normal) >= LIKE_COSINE))
        return;
    const Vec3 q = triangle_nearest(s->point, corner_of(s->n, t, 0), corner_of(s->n, t, 1),
                                    corner_of(s->n, t, 2));
    const Vec3 d = vec3_sub(q, s->point);
    const double square = vec3_dot(d, d);
    if (square < s->best || (square == s->best && (!s->found || t->face < s->out->face))) {
        s->best = square;
        s->found = true;
        *s->out = (NearestFace){ t->face, sqrt(square), q };
    }
}

static void descend(Search *s, size_t node, size_t begin, size_t end)
{
    if (box_distance(&s->n->box[node], s->point) > s->best)
        return;
    if (end - begin <= LEAF) {
        for (size_t i = begin; i < end; i++)
            look_at(s, &s->n->triangle[i]);
        return;
    }
    const size_t middle = begin + (end - begin) / 2, left = 2 * node + 1, right = left + 1;
    const bool left_first = box_distance(&s->n->box[left], s->point) <=
                            box_distance(&s->n->box[right], s->point);
    if (left_first)
        descend(s, left, begin, middle);
    descend(s, right, middle, end);
    if (!left_first)
        descend(s, left, begin, middle);
}

bool nearest_face_find(const NearestFaces *faces, Vec3 point, Vec3 normal, uint32_t group,
                       double reach, NearestFace *out)
{
    Search s = { .n = faces, .point = point, .normal = normal, .group = group,
                 .best = reach * reach, .out = out };
    if (faces->triangle_count > 0)
        descend(&s, 0, 0, faces->triangle_count);
    return s.found;
}
