/* SPDX-License-Identifier: BSD-3-Clause */
/* Two solved meshes, compared at points of the first. */
#include "app/compare_ply.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "app/nearest_face.h"
#include "base/array.h"
#include "math/mean_value.h"
#include "math/rgb.h"
#include "math/sampling.h"
#include "math/tolerance.h"

static const uint32_t SAMPLES_DEFAULT = 100000;
/* A chord over an eighth of a turn, the coarsest cell of a curved face, lies up to 0.099 of its
 * length off the arc. */
static const double CHORD = 0.1;

typedef struct {
    const SolvedMesh *reference, *mesh;
    NearestFaces *faces;      /* of mesh */
    uint32_t *group;          /* [reference->group_count]  of the same name in mesh, or NO_GROUP */
    double   *cumulative;     /* [triangles]  of the reference's faces, by visible area */
    uint32_t *face;           /* [triangles] */
    uint32_t *corner;         /* [triangles]  second of its corners within the face */
    size_t    triangles;
    double   *weight;         /* [most corners of a face] */
    double    largest;        /* root of the largest face of mesh */
    double    rounding;       /* of positions */
    bool      constant;
} Compare;
#define NO_GROUP UINT32_MAX

static IndexPolygon face_polygon(const SolvedMesh *mesh, uint32_t face)
{
    const uint32_t first = mesh->first_corner[face];
    return (IndexPolygon){ mesh->position, mesh->corner + first,
                           mesh->first_corner[face + 1] - first };
}

/* --- getting ready ---------------------------------------------------------------------------- */

typedef struct {
    const char *name;
    uint32_t    number;
} Name;

static int compare_names(const void *a, const void *b)
{
    const Name *s = a, *t = b;
    const int order = strcmp(s->name, t->name);
    return order != 0 ? order : s->number < t->number ? -1 : s->number > t->number;
}

/* Names are unique in files that isolux writes, but for control characters; of equals the first. */
static bool match_groups(Compare *c, Error *err)
{
    const uint32_t n = c->mesh->group_count;
    Name *name = array_create(n, sizeof *name, "group names", err);
    c->group = array_create(c->reference->group_count, sizeof *c->group, "group names", err);
    if (!error_is_set(err)) {
        for (uint32_t i = 0; i < n; i++)
            name[i] = (Name){ c->mesh->group_name[i], i };
        qsort(name, n, sizeof *name, compare_names);
        for (uint32_t i = 0; i < c->reference->group_count; i++) {
            const Name wanted = { c->reference->group_name[i], 0 };
            uint32_t low = 0, high = n;
            while (low < high) {
                const uint32_t middle = low + (high - low) / 2;
                if (compare_names(&name[middle], &wanted) < 0)
                    low = middle + 1;
                else
                    high = middle;
            }
            const bool found = low < n && strcmp(name[low].name, wanted.name) == 0;
            c->group[i] = found ? name[low].number : NO_GROUP;
        }
    }
    array_free(name);
    return !error_is_set(err);
}

/* Visible area, shared out to the triangles of a face by their size. */
static void list_triangles(Compare *c)
{
    const SolvedMesh *m = c->reference;
    double sum = 0;
    for (uint32_t f = 0; f < m->face_count; f++) {
        const IndexPolygon polygon = face_polygon(m, f);
        const Vec3 *p = m->position;
        const Vec3 area = polygon_area(&polygon), first = p[polygon.corner[0]];
        const double whole = vec3_dot(area, area);
        for (uint32_t k = 1; k + 1 < polygon.count; k++) {
            const Vec3 part = vec3_cross(vec3_sub(p[polygon.corner[k]], first),
                                         vec3_sub(p[polygon.corner[k + 1]], first));
            const double share = whole > 0 ? fmax(vec3_dot(part, area) / (2 * whole), 0) : 0;
            sum += share * m->area[f];
            c->face[c->triangles] = f;
            c->corner[c->triangles] = k;
            c->cumulative[c->triangles++] = sum;
        }
    }
}

static void measure(Compare *c)
{
    double largest = 0;
    for (uint32_t f = 0; f < c->mesh->face_count; f++) {
        const IndexPolygon polygon = face_polygon(c->mesh, f);
        largest = fmax(largest, vec3_length(polygon_area(&polygon)));
    }
    c->largest = sqrt(largest);
    const SolvedMesh *both[2] = { c->reference, c->mesh };
    double coordinate = 0;
    for (int k = 0; k < 2; k++)
        for (uint32_t v = 0; v < both[k]->vertex_count; v++) {
            const Vec3 p = both[k]->position[v];
            coordinate = fmax(coordinate, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
        }
    c->rounding = position_tolerance(coordinate);
}

static uint32_t most_corners(const SolvedMesh *mesh)
{
    uint32_t most = 3;
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const uint32_t corners = mesh->first_corner[f + 1] - mesh->first_corner[f];
        most = corners > most ? corners : most;
    }
    return most;
}

static bool compare_start(Compare *c, Error *err)
{
    const SolvedMesh *m = c->reference;
    const size_t triangles = m->first_corner[m->face_count] - 2 * (size_t)m->face_count;
    const uint32_t a = most_corners(m), b = most_corners(c->mesh);
    c->cumulative = array_create(triangles, sizeof *c->cumulative, "compare", err);
    c->face = array_create(triangles, sizeof *c->face, "compare", err);
    c->corner = array_create(triangles, sizeof *c->corner, "compare", err);
    c->weight = array_create(a > b ? a : b, sizeof *c->weight, "compare", err);
    c->faces = error_is_set(err) ? NULL : nearest_faces_create(c->mesh, err);
    if (c->faces == NULL || !match_groups(c, err))
        return false;
    list_triangles(c);
    measure(c);
    if (triangles == 0 || !(c->cumulative[triangles - 1] > 0))
        return error_set(err, ERROR_INPUT, "nothing to compare: the reference has no visible face");
    return true;
}

static void compare_clear(Compare *c)
{
    nearest_faces_destroy(c->faces);
    array_free(c->cumulative);
    array_free(c->face);
    array_free(c->corner);
    array_free(c->weight);
    array_free(c->group);
}

/* --- points ----------------------------------------------------------------------------------- */

/* Luminance of irradiance at a point of a face. */
static double face_value(const Compare *c, const SolvedMesh *mesh, uint32_t face, Vec3 point)
{
    if (c->constant) {
        const double *h = mesh->face_irradiance + 3 * (size_t)face;
        return rgb_luminance(rgb(h[0], h[1], h[2]));
    }
    const IndexPolygon polygon = face_polygon(mesh, face);
    double sum = 0;
    mean_value_weights(&polygon, vec3_unit(polygon_area(&polygon)), point, c->weight);
    for (uint32_t k = 0; k < polygon.count; k++) {
        const double *h = mesh->irradiance + 3 * (size_t)polygon.corner[k];
        sum += c->weight[k] * rgb_luminance(rgb(h[0], h[1], h[2]));
    }
    return sum;
}

/* A point of the reference: sample `index`. */
static uint32_t sample_point(const Compare *c, uint32_t index, uint32_t seed, Vec3 *point)
{
    const SolvedMesh *m = c->reference;
    float  u[4];
    double s, t;
    size_t low = 0, high = c->triangles - 1;
    sampling_sobol4(index, seed, u);
    const double wanted = (double)u[0] * c->cumulative[c->triangles - 1];
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (c->cumulative[middle] > wanted)
            high = middle;
        else
            low = middle + 1;
    }
    const uint32_t face = c->face[low];
    const uint32_t *corner = m->corner + m->first_corner[face];
    const uint32_t k = c->corner[low];
    const Vec3 a = m->position[corner[0]];
    sampling_triangle((double)u[1], (double)u[2], &s, &t);
    *point = vec3_mad(vec3_mad(a, s, vec3_sub(m->position[corner[k]], a)), t,
                      vec3_sub(m->position[corner[k + 1]], a));
    return face;
}

/* The face of the other mesh where the point is. */
static bool find_other(const Compare *c, uint32_t face, Vec3 point, NearestFace *other)
{
    const SolvedMesh *m = c->reference;
    const uint32_t group = c->group[m->group[face]];
    const IndexPolygon polygon = face_polygon(m, face);
    const Vec3 area = polygon_area(&polygon);
    const double own = sqrt(vec3_length(area));
    if (group == NO_GROUP ||
        !nearest_face_find(c->faces, point, vec3_unit(area), group,
                           CHORD * (own + c->largest) + c->rounding, other))
        return false;
    const IndexPolygon found = face_polygon(c->mesh, other->face);
    const double its = sqrt(vec3_length(polygon_area(&found)));
    return other->distance <= CHORD * (own + its) + c->rounding;
}

static void row_add(CompareRow *row, bool found, double reference, double other)
{
    row->share += 1;
    if (!found)
        return;
    row->matched += 1;
    row->mean += reference;
    row->other += other;
    row->error += (other - reference) * (other - reference);
}

/* Sums become means; `scale`: mean of the reference, over which errors are told. */
static void row_finish(CompareRow *row, uint32_t samples, double scale)
{
    const double matched = row->matched;
    row->matched = row->share > 0 ? matched / row->share : 0;
    row->share /= samples;
    row->mean = matched > 0 ? row->mean / matched : 0;
    row->other = matched > 0 ? row->other / matched : 0;
    row->error = matched > 0 ? sqrt(row->error / matched) / scale : 0;
}

static bool compare_points(const Compare *c, uint32_t seed, MeshComparison *out, Error *err)
{
    for (uint32_t i = 0; i < out->samples; i++) {
        NearestFace other;
        Vec3 point;
        const uint32_t face = sample_point(c, i, seed, &point);
        const bool found = find_other(c, face, point, &other);
        const double a = found ? face_value(c, c->reference, face, point) : 0;
        const double b = found ? face_value(c, c->mesh, other.face, other.point) : 0;
        row_add(&out->all, found, a, b);
        row_add(&out->group[c->reference->group[face]], found, a, b);
    }
    if (!(out->all.matched > 0))
        return error_set(err, ERROR_INPUT, "nothing to compare: no point of the reference lies on "
                         "a face of the same group that looks the same way");
    const double scale = out->all.mean / out->all.matched;
    if (!(scale > 0))
        return error_set(err, ERROR_INPUT, "nothing to compare: the reference is dark");
    row_finish(&out->all, out->samples, scale);
    for (uint32_t g = 0; g < c->reference->group_count; g++)
        row_finish(&out->group[g], out->samples, scale);
    return true;
}

bool mesh_compare(const SolvedMesh *reference, const SolvedMesh *mesh,
                  const CompareOptions *options, MeshComparison *out, Error *err)
{
    assert(reference != NULL && mesh != NULL && options != NULL && out != NULL);
    Compare c = { .reference = reference, .mesh = mesh, .constant = options->constant };
    *out = (MeshComparison){ .samples = options->samples ? options->samples : SAMPLES_DEFAULT };
    out->group = array_create(reference->group_count, sizeof *out->group, "compare", err);
    const bool good = out->group != NULL && compare_start(&c, err) &&
                      compare_points(&c, options->seed, out, err);
    compare_clear(&c);
    return good;
}

void mesh_comparison_clear(MeshComparison *comparison)
{
    array_free(comparison->group);
    *comparison = (MeshComparison){ 0 };
}
