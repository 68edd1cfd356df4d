/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: point sources, after CIE 171 [cie171], values recomputed in closed form. */
#include <math.h>

#include "app/model.h"
#include "app/validate.h"

static const double PI = 3.14159265358979323846;

/* --- CIE 5.2: a source 3 m above a black floor ------------------------------------------------ */

typedef struct {
    double x, y, lambertian, isotropic; /* m, lux for 1000 cd */
} FloorPoint;

static const FloorPoint floor_points[] = {
    { 0, 0, 111.111111111, 111.111111111 },   { 0.5, 0, 105.186267348, 106.637180955 },
    { 1, 0, 90, 94.8683298051 },              { 1.5, 0, 71.1111111111, 79.5046392 },
    { 0.5, 0.5, 99.7229916898, 102.455634398 }, { 1, 0.5, 85.6632956573, 91.418787447 },
    { 1.5, 0.5, 68.0529300567, 76.9262379939 }, { 1, 1, 74.3801652893, 82.230366703 },
    { 1.5, 1, 59.9750104123, 69.970845481 },  { 1.5, 1.5, 49.3827160494, 60.4812282169 },
};
enum { FLOOR_POINTS = sizeof floor_points / sizeof *floor_points };
static const double CIE_52_SHARE = 0.005;

static bool run_floor(Validation *validation, LightKind kind, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH, .patches = 64,
                              .rays = 64 };
    Session session;
    Pipeline pipeline;
    Scene *scene = scene_create("floor", err);
    if (scene != NULL) {
        const uint32_t m = model_grey(scene, "floor", 0, 0, err);
        model_rectangle(scene, vec3(-2, -2, 0), vec3(4, 0, 0), vec3(0, 4, 0), m, "floor", err);
        model_point_light(scene, kind, vec3(0, 0, 3), 1000, err);
    }
    const bool done = validation_run(validation, scene, &setup, &session, &pipeline, err);
    for (int i = 0; done && i < FLOOR_POINTS; i++) {
        const FloorPoint *p = &floor_points[i];
        const double expected = kind == LIGHT_POINT ? p->isotropic : p->lambertian;
        char quantity[40];
        double error = NAN;
        const double value = validation_measure(&pipeline, vec3(p->x, p->y, 0), vec3(0, 0, 1),
                                                &error, err);
        snprintf(quantity, sizeof quantity, "%s at %.1f, %.1f",
                 kind == LIGHT_POINT ? "isotropic" : "lambertian", p->x, p->y);
        validation_check(validation, quantity, expected, value, CIE_52_SHARE * expected, error,
                         err);
    }
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

static bool run_floors(Validation *validation, Error *err)
{
    return run_floor(validation, LIGHT_COSINE, err) && run_floor(validation, LIGHT_POINT, err);
}

/* --- CIE 5.4: flux of a source in a black room ------------------------------------------------ */

static const double CIE_54_FACE_SHARE = 0.01, CIE_54_TOTAL_SHARE = 0.005;

static Scene *lit_room(Vec3 size, double reflectance, double flux, Error *err)
{
    Scene *scene = scene_create("room", err);
    if (scene == NULL)
        return NULL;
    const uint32_t m = model_grey(scene, "wall", reflectance, 0, err);
    model_box(scene, size, (uint32_t[]){ m, m, m, m, m, m }, err);
    model_point_light(scene, LIGHT_POINT, vec3_scale(size, 0.5), flux / (4 * PI), err);
    return scene;
}

static bool run_flux(Validation *validation, Error *err)
{
    static const struct {
        const char *group;
        double      area, flux;
    } faces[] = { { "x0", 12, 1394.67168057 }, { "x1", 12, 1394.67168057 },
                  { "y0", 12, 1394.67168057 }, { "y1", 12, 1394.67168057 },
                  { "z0", 16, 2210.65663886 }, { "z1", 16, 2210.65663886 } };
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_NONE, .patches = 1000,
                              .rays = 64 };
    Session session;
    Pipeline pipeline;
    if (validation_run(validation, lit_room(vec3(4, 4, 3), 0, 10000, err), &setup, &session,
                       &pipeline, err)) {
        double total = 0;
        for (size_t i = 0; i < sizeof faces / sizeof *faces; i++) {
            const double h = validation_mean(&pipeline, pipeline.direct.irradiance,
                                             faces[i].group, ANY_SIDE);
            char quantity[40];
            snprintf(quantity, sizeof quantity, "flux on %s", faces[i].group);
            total += h * faces[i].area;
            validation_check(validation, quantity, faces[i].flux, h * faces[i].area,
                             CIE_54_FACE_SHARE * faces[i].flux, NAN, err);
        }
        validation_check(validation, "flux on all", 10000, total, CIE_54_TOTAL_SHARE * 10000, NAN,
                         err);
    }
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

/* --- CIE 5.8: a source in a diffuse cube ------------------------------------------------------ */

/* What is left at high reflectance is the mesh's: with 1500 patches all points of the floor are
 * 0.015 % low at rho 0.95 and the rim is high, with 6000 a quarter of that. A patch at an edge
 * lights its neighbour round the edge by its mean, though it is darker there.
 *
 * The mean over all walls is phi / (A (1 - rho)) by flux balance; face centres come from the
 * integral equation (estimated error below 3e-3 lux). */
typedef struct {
    double reflectance, mean, centre;
} Cube58;

static const double CIE_58_MEAN_SHARE = 0.001, CIE_58_POINT_SHARE = 0.001;

/* Other points of the floor, at three reflectances, of the same source as the centres. */
enum { FLOOR_58 = 4 };
static const Vec3 floor58_points[FLOOR_58] = { { 0.4, 0.4, 0 }, { 0.4, 2, 0 }, { 1.2, 1.2, 0 },
                                               { 1.2, 2, 0 } };
static const struct {
    double reflectance, total[FLOOR_58];
} floors58[] = {
    { 0.05, { 62.3746325, 100.443365, 137.137246, 165.329913 } },
    { 0.5, { 151.002985, 202.093349, 240.984777, 270.574225 } },
    { 0.95, { 2009.67927, 2082.82117, 2123.8232, 2155.27244 } },
};

static void check_floor58(Validation *validation, const Pipeline *pipeline, double reflectance,
                          Error *err)
{
    for (size_t i = 0; i < sizeof floors58 / sizeof *floors58; i++)
        for (int k = 0; k < FLOOR_58 && floors58[i].reflectance == reflectance; k++) {
            const Vec3   p = floor58_points[k];
            const double expected = floors58[i].total[k];
            char quantity[40];
            double error = NAN;
            const double value = validation_measure(pipeline, p, vec3(0, 0, 1), &error, err);
            snprintf(quantity, sizeof quantity, "rho %.2f, floor at %.1f, %.1f", reflectance, p.x,
                     p.y);
            validation_check(validation, quantity, expected, value, CIE_58_POINT_SHARE * expected,
                             error, err);
        }
}

static bool run_cube58(Validation *validation, const Cube58 *cube, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH, .patches = 4000,
                              .rays = 128 };
    static const char *const faces[] = { "x0", "x1", "y0", "y1", "z0", "z1" };
    Session session;
    Pipeline pipeline;
    if (validation_run(validation, lit_room(vec3(4, 4, 4), cube->reflectance, 10000, err), &setup,
                       &session, &pipeline, err)) {
        char quantity[40];
        double mean = 0, error = NAN;
        for (int i = 0; i < 6; i++) /* equal areas */
            mean += validation_mean(&pipeline, pipeline.solution->irradiance, faces[i],
                                    ANY_SIDE) / 6;
        snprintf(quantity, sizeof quantity, "rho %.2f, mean", cube->reflectance);
        validation_check(validation, quantity, cube->mean, mean, CIE_58_MEAN_SHARE * cube->mean,
                         NAN, err);
        const double value = validation_measure(&pipeline, vec3(2, 2, 0), vec3(0, 0, 1), &error,
                                                err);
        snprintf(quantity, sizeof quantity, "rho %.2f, floor's centre", cube->reflectance);
        validation_check(validation, quantity, cube->centre, value,
                         CIE_58_POINT_SHARE * cube->centre, error, err);
        check_floor58(validation, &pipeline, cube->reflectance, err);
    }
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

static const Cube58 cubes58[] = {
    { 0.05, 109.649123, 205.102721 },
    { 0.1, 115.740741, 211.891596 },
    { 0.2, 130.208333, 227.820748 },
    { 0.3, 148.809524, 247.9825 },
    { 0.4, 173.611111, 274.457286 },
    { 0.5, 208.333333, 310.982038 },
    { 0.6, 260.416667, 365.017995 },
    { 0.7, 347.222222, 453.952573 },
    { 0.8, 520.833333, 629.903205 },
    { 0.9, 1041.66667, 1153.3322 },
    { 0.95, 2083.33333, 2196.41241 },
};

static bool run_cubes58(Validation *validation, Error *err)
{
    for (size_t i = 0; i < sizeof cubes58 / sizeof *cubes58; i++)
        if (!run_cube58(validation, &cubes58[i], err))
            return false;
    return true;
}

const Case *validate_light_cases(size_t *count)
{
    static const Case cases[] = {
        { "cie-5.2", "point source above a floor", run_floors },
        { "cie-5.4", "flux of a source in a black room", run_flux },
        { "cie-5.8", "diffuse cube with a point source", run_cubes58 },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
