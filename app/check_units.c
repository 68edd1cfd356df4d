/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether a scene's lengths are plausible in metres, and which unit would make them so. */
#include <assert.h>
#include <math.h>

#include "app/check.h"

/* Metres. No hall is higher than LOW_MOST, and few scenes reach a kilometre; what is smaller than a
 * matchbox is no room. A person's eye is neither at the ankle nor on a mast, but cameras hang under
 * the ceilings of halls. */
static const double LOW_MOST = 100, LONG_MOST = 1000, LONG_LEAST = 0.05;
static const double EYE_LEAST = 0.02, EYE_MOST = 200;
/* What a guess is measured by: the height of a room, and of the eye of somebody who stands. */
static const double ROOM_HEIGHT = 3, EYE_HEIGHT = 1.6;
/* A guess must bring the room within this factor of that height. */
static const double NEAR_ENOUGH = 10;

static const struct {
    double      metres;
    const char *name;
} known_units[] = { { 1, "metres" }, { 0.01, "centimetres" }, { 0.001, "millimetres" } };

static double eye_height(const Scene *scene, Vec3 lo, Vec3 hi)
{
    if (scene->camera_count == 0)
        return NAN;
    double least = INFINITY;
    for (int k = 0; k < 8; k++)
        least = fmin(least, vec3_dot(scene->up, vec3(k & 1 ? lo.x : hi.x, k & 2 ? lo.y : hi.y,
                                                     k & 4 ? lo.z : hi.z)));
    return vec3_dot(scene->up, scene->cameras[0].eye) - least;
}

/* The unit that comes nearest to `usual` metres for a length of so many units. */
static void guess_unit(UnitGuess *units, double length, double usual)
{
    double best = log(NEAR_ENOUGH);
    for (size_t k = 0; k < sizeof known_units / sizeof *known_units; k++) {
        const double off = fabs(log(length * known_units[k].metres / usual));
        if (off < best) {
            best = off;
            units->guess = known_units[k].metres;
            units->name = known_units[k].name;
        }
    }
}

void check_units(const Pipeline *pipeline, UnitGuess *units)
{
    const double unit = pipeline->session->options.unit_m;
    Vec3         lo, hi;
    *units = (UnitGuess){ .eye = NAN };
    if (!polygons_bounds(&pipeline->scene->polygons, &lo, &hi))
        return;
    const Vec3   size = vec3_sub(hi, lo);
    const double extent[3] = { size.x, size.y, size.z };
    assert(unit > 0);
    units->largest = unit * fmax(size.x, fmax(size.y, size.z));
    units->least = units->largest;
    for (int k = 0; k < 3; k++)
        if (extent[k] > 0)
            units->least = fmin(units->least, unit * extent[k]);
    const double eye = eye_height(pipeline->scene, lo, hi);
    units->eye = unit * eye;
    const bool eye_wrong = eye > 0 && (units->eye > EYE_MOST || units->eye < EYE_LEAST);
    units->suspicious = units->least > LOW_MOST || units->largest > LONG_MOST ||
                        (units->largest > 0 && units->largest < LONG_LEAST) || eye_wrong;
    if (!units->suspicious)
        return;
    if (eye_wrong)
        guess_unit(units, eye, EYE_HEIGHT);
    else
        guess_unit(units, units->least / unit, ROOM_HEIGHT);
    if (units->guess == unit)
        units->guess = 0;
}
