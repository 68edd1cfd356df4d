/* SPDX-License-Identifier: BSD-3-Clause */
/* Scenes far from the origin are moved to it: rays are floats, and tolerances grow with
 * coordinates. Models of buildings often stand where a map's grid has them. */
#include "scenes/scene.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "math/tolerance.h"

/* Far is a middle of the box this many box lengths away. Floats there are off by 2^-24 x 64 of the
 * length, 4 micrometres in a metre; up to there nothing shows. */
static const double FAR_SIZES = 64;

/* Floats whose steps are larger than this share of the scene cannot hold its shape: a millimetre in
 * a room of ten metres. */
static const double COARSE_SHARE = 1e-4;

/* How far apart positions may be that mean one, in steps of a coordinate: position_tolerance allows
 * floats as much, 8 halves. */
static const double GRAIN_STEPS = 4;

/* What one axis is moved by: on a grid of a power of two no finer than the scene is long, so that
 * few bits of it are used and the difference with a number near it is exact. */
static double axis_shift(double lo, double hi, double size)
{
    const double middle = lo + (hi - lo) / 2;
    int exponent = 0;
    (void)frexp(size, &exponent);
    const double grid = ldexp(1, exponent);
    return fabs(middle) > FAR_SIZES * size ? grid * nearbyint(middle / grid) : 0;
}

/* Distance between neighbouring floats at x. */
static double float_step(double x)
{
    int exponent = 0;
    (void)frexp(x, &exponent);
    return ldexp(1, exponent - FLT_MANT_DIG);
}

/* The step between floats along an axis, when all coordinates lie on it and not on a coarser one:
 * then they were floats, and what lay between is lost. Else 0. */
static double axis_grain(const Polygons *soup, int axis, double lo, double hi)
{
    const double step = float_step(fmin(fabs(lo), fabs(hi)));
    bool odd = false;
    for (size_t i = 0; i < soup->vertex_count; i++) {
        const double at = vec3_axis(soup->position[i], axis) / step;
        if (at != floor(at))
            return 0;
        odd = odd || fmod(at, 2) != 0;
    }
    return odd ? step : 0;
}

/* --- decimals --------------------------------------------------------------------------------- */

/* Digits that a coordinate may have: with more, nothing is lost that a double would keep. Powers of
 * ten up to the other number are doubles. */
enum { DIGITS_LEAST = 5, DIGITS_MOST = 12, POWER_MOST = 22 };

/* So much smaller coordinates have steps a hundred times as fine, when all have as many digits. */
enum { FINER = 2 };

static int decimal_exponent(double x) { return (int)floor(log10(fabs(x))); }

/* Whether x is the double next to a number of so many decimal digits. */
static bool has_digits(double x, int digits)
{
    const int places = x == 0 ? 0 : digits - 1 - decimal_exponent(x);
    if (places > POWER_MOST)
        return true;
    const double scale = pow(10, places > 0 ? places : 0);
    return nearbyint(x * scale) / scale == x;
}

/* How many digits the coordinates have been written with; more than DIGITS_MOST: what a double
 * needs. */
static int count_digits(const Polygons *soup)
{
    int digits = 1;
    for (size_t i = 0; i < soup->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            while (digits <= DIGITS_MOST && !has_digits(vec3_axis(soup->position[i], axis), digits))
                digits++;
    return digits;
}

/* The step of the farthest coordinates in a text with a fixed number of digits, and 0 for other
 * texts. It has one when both the farthest and far smaller coordinates need as many: on whole
 * millimetres, or written as short as can be, those near the origin need fewer. */
static double digits_grain(const Polygons *soup, double farthest)
{
    const int digits = count_digits(soup), most = decimal_exponent(farthest);
    bool far = false, near = false;
    if (digits < DIGITS_LEAST || digits > DIGITS_MOST)
        return 0;
    for (size_t i = 0; i < soup->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double x = vec3_axis(soup->position[i], axis);
            if (has_digits(x, digits - 1))
                continue;
            far = far || decimal_exponent(x) == most;
            near = near || decimal_exponent(x) <= most - FINER;
        }
    return far && near ? pow(10, most - digits + 1) : 0;
}

/* --- moving ----------------------------------------------------------------------------------- */

static bool move_shapes(Polygons *soup, Vec3 by, Error *err)
{
    for (size_t i = 0; i < soup->shape_count; i++) {
        Shape *shape = &soup->shape[i].shape;
        Affine map = shape->to_world;
        map.t = vec3_sub(map.t, by);
        if (!shape_init(shape, shape->kind, shape->ratio, &map, err))
            return false;
    }
    return true;
}

static bool move_all(Scene *scene, Vec3 by, Error *err)
{
    Polygons *soup = &scene->polygons;
    for (size_t i = 0; i < soup->vertex_count; i++)
        soup->position[i] = vec3_sub(soup->position[i], by);
    for (size_t i = 0; i < scene->textures.map_count; i++)
        face_map_move(&scene->textures.map[i], by);
    for (size_t i = 0; i < scene->placement_count; i++)
        scene->placements[i].to_world.t = vec3_sub(scene->placements[i].to_world.t, by);
    for (size_t i = 0; i < scene->light_count; i++)
        scene->lights[i].position = vec3_sub(scene->lights[i].position, by);
    for (size_t i = 0; i < scene->camera_count; i++) {
        scene->cameras[i].eye = vec3_sub(scene->cameras[i].eye, by);
        scene->cameras[i].target = vec3_sub(scene->cameras[i].target, by);
    }
    scene->origin = vec3_add(scene->origin, by);
    return move_shapes(soup, by, err);
}

bool scene_recentre(Scene *scene, const Monitor *monitor, Error *err)
{
    assert(scene != NULL && err != NULL);
    Polygons *soup = &scene->polygons;
    Vec3 lo, hi;
    double grain = 0, far = 0, farthest = 0, by[3];
    if (!polygons_bounds(soup, &lo, &hi))
        return true;
    const Vec3 extent = vec3_sub(hi, lo);
    const double size = fmax(extent.x, fmax(extent.y, extent.z));
    if (!(size > 0) || !isfinite(size))
        return true;
    for (int axis = 0; axis < 3; axis++) {
        const double low = vec3_axis(lo, axis), high = vec3_axis(hi, axis);
        by[axis] = axis_shift(low, high, size);
        if (by[axis] != 0)
            farthest = fmax(farthest, fmax(fabs(low), fabs(high)));
        if (by[axis] == 0 || float_step(by[axis]) <= COARSE_SHARE * size)
            continue;
        const double step = axis_grain(soup, axis, low, high);
        grain = fmax(grain, step);
        far = step > 0 ? fmax(far, fmax(fabs(low), fabs(high))) : far;
    }
    double apart = grain > 0 ? position_tolerance(far) : 0;
    if (grain == 0 && farthest > 0) {
        const double step = digits_grain(soup, farthest);
        grain = step > COARSE_SHARE * size ? step : 0;
        apart = GRAIN_STEPS * grain;
    }
    if (grain > 0) {
        soup->grain = apart;
        monitor_warn(monitor, "coordinates-coarse", scene->file,
                     "coordinates so far from the origin are rounded to steps of %g in a scene of "
                     "%.3g: its shape has suffered already; export it nearer to the origin", grain,
                     size);
    }
    const Vec3 shift = vec3(by[0], by[1], by[2]);
    return vec3_length(shift) > 0 ? move_all(scene, shift, err) : true;
}
