/* SPDX-License-Identifier: BSD-3-Clause */
/* The grid of a work plane, and what is said of it. */
#include "viewer/measure_plane.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/file.h"
#include "base/parallel.h"
#include "math/tolerance.h"

/* More are more than anyone can read, and minutes of work. */
enum { MOST_POINTS = 1000000 };

double plane_spacing(double length, double width)
{
    const double longer = fmax(length, width), shorter = fmin(length, width);
    assert(shorter > 0);
    return 0.2 * pow(5, log10(longer >= 2 * shorter ? shorter : longer));
}

/* Across `up`, as near to the axes of the world as can be. */
static void set_axes(Plane *plane, Vec3 up)
{
    const Vec3 axis = fabs(up.x) < 0.5 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    plane->up = up;
    plane->across = vec3_unit(vec3_cross(up, axis));
    plane->along = vec3_cross(plane->across, up);
}

/* Extent of the scene or a group along the three axes; lo > hi where there is nothing. */
static void find_extent(const ShownMesh *mesh, const Plane *plane, uint32_t group, double lo[3],
                        double hi[3])
{
    const Vec3 axis[3] = { plane->along, plane->across, plane->up };
    for (unsigned k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (group != PLANE_ALL && mesh->patch[mesh->triangle_patch[t]].group != group)
            continue;
        for (unsigned c = 0; c < 3; c++)
            for (unsigned k = 0; k < 3; k++) {
                const double x = vec3_dot(mesh->position[mesh->corner[3 * (size_t)t + c]], axis[k]);
                lo[k] = fmin(lo[k], x);
                hi[k] = fmax(hi[k], x);
            }
    }
}

static uint32_t cells(double side, double spacing)
{
    return (uint32_t)fmin(fmax(1, round(side / spacing)), MOST_POINTS + 1.0);
}

static bool lay_out(Plane *plane, const ShownMesh *mesh, const PlaneWish *wish, Error *err)
{
    double lo[3], hi[3];
    find_extent(mesh, plane, wish->group, lo, hi);
    const double margin = wish->margin / wish->metres;
    plane->length = hi[0] - lo[0] - 2 * margin;
    plane->width = hi[1] - lo[1] - 2 * margin;
    if (!(plane->length > 0 && plane->width > 0))
        return error_set(err, ERROR_INPUT, "nothing is left within a margin of %g m",
                         wish->margin);
    const double height = (wish->group == PLANE_ALL ? lo[2] : hi[2]) + wish->height / wish->metres;
    plane->origin = vec3_mad(vec3_mad(vec3_scale(plane->along, lo[0] + margin), lo[1] + margin,
                                      plane->across), height, plane->up);
    plane->spacing = plane_spacing(plane->length * wish->metres, plane->width * wish->metres);
    plane->columns = cells(plane->length * wish->metres, plane->spacing);
    plane->rows = cells(plane->width * wish->metres, plane->spacing);
    if ((uint64_t)plane->columns * plane->rows > MOST_POINTS)
        return error_set(err, ERROR_INPUT, "a grid of more than %d points", MOST_POINTS);
    plane->count = plane->columns * plane->rows;
    return true;
}

typedef struct {
    const ShownMesh *mesh;
    Plane           *plane;
} Placing;

static bool is_inside(const ShownMesh *mesh, Vec3 p)
{
    unsigned backs = 0, fronts = 0;
    for (unsigned k = 0; k < 6; k++) {
        const double way = k & 1 ? -1 : 1;
        const Vec3 d = vec3(k / 2 == 0 ? way : 0, k / 2 == 1 ? way : 0, k / 2 == 2 ? way : 0);
        const Ray ray = ray_leaving(p, d, 0, d, INFINITY);
        Hit hit;
        if (!bvh_nearest(mesh->bvh, &ray, &hit))
            fronts++;
        else if (vec3_dot(mesh->patch[mesh->triangle_patch[hit.primitive]].normal, d) > 0)
            backs++;
        else
            fronts++;
    }
    return backs > fronts;
}

static void place_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Placing *placing = context;
    Plane *plane = placing->plane;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        const double a = (i % plane->columns + 0.5) * plane->length / plane->columns;
        const double b = (i / plane->columns + 0.5) * plane->width / plane->rows;
        plane->point[i] = vec3_mad(vec3_mad(plane->origin, a, plane->along), b, plane->across);
        plane->inside[i] = is_inside(placing->mesh, plane->point[i]);
    }
}

Plane *plane_create(const ShownMesh *mesh, const PlaneWish *wish, unsigned threads, Error *err)
{
    assert(wish->metres > 0 && (wish->group == PLANE_ALL || wish->group < mesh->group_count));
    Plane *plane = array_create(1, sizeof *plane, "work plane", err);
    if (plane == NULL)
        return NULL;
    set_axes(plane, vec3_unit(mesh->up));
    if (!lay_out(plane, mesh, wish, err))
        return plane_destroy(plane);
    plane->point = array_create(plane->count, sizeof *plane->point, "work plane", err);
    plane->inside = array_create(plane->count, sizeof *plane->inside, "work plane", err);
    plane->direct = array_create(plane->count, sizeof *plane->direct, "work plane", err);
    plane->sum = array_create(plane->count, sizeof *plane->sum, "work plane", err);
    if (error_is_set(err))
        return plane_destroy(plane);
    Placing placing = { mesh, plane };
    parallel_for(plane->count, 64, threads, place_chunk, &placing, NULL, NULL);
    return plane;
}

Plane *plane_destroy(Plane *plane)
{
    if (plane == NULL)
        return NULL;
    array_free(plane->point);
    array_free(plane->inside);
    array_free(plane->direct);
    array_free(plane->sum);
    return array_free(plane);
}

void plane_restart(Plane *plane)
{
    plane->rays = 0;
    for (uint32_t i = 0; i < plane->count; i++)
        plane->direct[i] = plane->sum[i] = rgb(0, 0, 0);
}

double plane_value(const Plane *plane, uint32_t i)
{
    assert(i < plane->count);
    if (plane->rays == 0 || plane->inside[i])
        return NAN;
    return rgb_luminance(rgb_mad(plane->direct[i], 1.0 / plane->rays, plane->sum[i]));
}

bool plane_report(const Plane *plane, PlaneReport *report, Error *err)
{
    double *value = array_create(plane->count, sizeof *value, "work plane", err);
    if (value == NULL)
        return false;
    for (uint32_t i = 0; i < plane->count; i++)
        value[i] = plane_value(plane, i);
    const bool done = statistics_find(value, NULL, plane->count, &report->all, err);
    report->uniformity = report->all.mean > 0 ? report->all.least / report->all.mean : NAN;
    report->diversity = report->all.greatest > 0 ? report->all.least / report->all.greatest : NAN;
    array_free(value);
    return done;
}

bool plane_write(const Plane *plane, bool lux, const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fprintf(out, "x,y,z,%s\n", lux ? "lux" : "W/m2");
    for (uint32_t i = 0; i < plane->count; i++) {
        const double value = plane_value(plane, i);
        if (!isnan(value))
            fprintf(out, "%.9g,%.9g,%.9g,%.6g\n", plane->point[i].x, plane->point[i].y,
                    plane->point[i].z, value);
    }
    return outfile_commit(file, err);
}
