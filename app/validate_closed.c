/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: closed rooms whose solution is known by algebra. */
#include <assert.h>
#include <math.h>

#include "app/model.h"
#include "app/validate.h"

static const double PI = 3.14159265358979323846;

enum { PATCHES = 1500, RAYS = 256 };

/* --- furnaces: B = E / (1 - rho) everywhere --------------------------------------------------- */

typedef enum { FURNACE_CUBE, FURNACE_PLATE, FURNACE_L, FURNACE_SPHERE } FurnaceShape;

typedef struct {
    const char  *name;
    FurnaceShape shape;
    double       exitance, reflectance;
} Furnace;

static const Furnace furnaces[] = {
    { "cube, rho 0.5", FURNACE_CUBE, 0.3, 0.5 },
    { "cube, rho 0.9", FURNACE_CUBE, 1, 0.9 },
    { "cube with plate, rho 0.7", FURNACE_PLATE, 1, 0.7 },
    { "L-shaped room, rho 0.8", FURNACE_L, 1, 0.8 },
    { "sphere, rho 0.5", FURNACE_SPHERE, 1, 0.5 },
};

/* Rows are closed to 1e-6, the requirement on them; a row sum that is off by e moves a uniform
 * solution by at most e rho / (1 - rho) of itself. */
static const double ROW_ERROR = 1e-6;

static void furnace_l(Scene *scene, uint32_t m, Error *err)
{
    const Vec3 x = vec3(1, 0, 0), y = vec3(0, 1, 0), z = vec3(0, 0, 1);
    const Vec3 corner[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
    for (int i = 0; i < 3; i++) {
        model_rectangle(scene, corner[i], x, y, m, "floor", err);
        model_rectangle(scene, vec3_add(corner[i], z), y, x, m, "ceiling", err);
    }
    model_rectangle(scene, vec3(0, 0, 0), z, x, m, "south", err);
    model_rectangle(scene, vec3(1, 0, 0), z, x, m, "south", err);
    model_rectangle(scene, vec3(0, 0, 0), y, z, m, "west", err);
    model_rectangle(scene, vec3(0, 1, 0), y, z, m, "west", err);
    model_rectangle(scene, vec3(2, 0, 0), z, y, m, "east", err);
    model_rectangle(scene, vec3(0, 2, 0), x, z, m, "north", err);
    model_rectangle(scene, vec3(1, 1, 0), x, z, m, "inner", err);
    model_rectangle(scene, vec3(1, 1, 0), z, y, m, "inner", err);
}

static Scene *furnace_scene(const Furnace *furnace, Error *err)
{
    Scene *scene = scene_create(furnace->name, err);
    if (scene == NULL)
        return NULL;
    const uint32_t m = model_grey(scene, "wall", furnace->reflectance, furnace->exitance, err);
    if (error_is_set(err))
        return scene;
    scene->polygons.materials[m].emits_both = true;
    if (furnace->shape == FURNACE_CUBE || furnace->shape == FURNACE_PLATE)
        model_box(scene, vec3(1, 1, 1), (uint32_t[]){ m, m, m, m, m, m }, err);
    if (furnace->shape == FURNACE_PLATE)
        model_rectangle(scene, vec3(0.25, 0.25, 0.5), vec3(0.5, 0, 0), vec3(0, 0.5, 0), m, "plate",
                        err);
    if (furnace->shape == FURNACE_L)
        furnace_l(scene, m, err);
    if (furnace->shape == FURNACE_SPHERE)
        model_shape(scene, SHAPE_SPHERE, 0, vec3(0, 0, 0), vec3(1, 1, 1), m, "wall", err);
    return scene;
}

/* The value furthest from `expected` inside; a sphere that shines on both sides also has an
 * outside, from where all escapes. */
static double furthest(const Pipeline *pipeline, double expected)
{
    double worst = expected;
    for (uint32_t i = 0; i < pipeline->links->count; i++) {
        const double b = pipeline->solution->radiosity[ROOM_BANDS * i];
        if (pipeline->links->escape[i] < 0.5 && pipeline->links->area[i] > 0 &&
            !(fabs(b - expected) <= fabs(worst - expected)))
            worst = b;
    }
    return worst;
}

static bool run_furnaces(Validation *validation, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH,
                              .patches = PATCHES, .rays = RAYS };
    for (size_t i = 0; i < sizeof furnaces / sizeof *furnaces && !error_is_set(err); i++) {
        const Furnace *f = &furnaces[i];
        const double expected = f->exitance / (1 - f->reflectance);
        Session session;
        Pipeline pipeline;
        if (validation_run(validation, furnace_scene(f, err), &setup, &session, &pipeline, err))
            validation_check(validation, f->name, expected, furthest(&pipeline, expected),
                             ROW_ERROR / (1 - f->reflectance) * expected, NAN, err);
        validation_end(&session, &pipeline);
    }
    return !error_is_set(err);
}

/* --- concentric spheres ----------------------------------------------------------------------- */

typedef struct {
    double outer;              /* radius; the inner one's is 1 */
    double exitance[2], reflectance[2], radiosity[2];
} TwoSpheres;

static const TwoSpheres two_spheres[] = {
    { 2, { 1, 0 }, { 0.5, 0.3 }, { 1.05084745763, 0.101694915254 } },
    { 1.5, { 0, 2 }, { 0.2, 0.9 }, { 0.952380952381, 4.7619047619 } },
};

static bool run_two_spheres(Validation *validation, Error *err)
{
    for (size_t i = 0; i < sizeof two_spheres / sizeof *two_spheres && !error_is_set(err); i++) {
        const TwoSpheres *t = &two_spheres[i];
        const Vec3 middle = vec3(0, 0, 0), inner = vec3(1, 1, 1);
        const Vec3 between = vec3(0, 0, (1 + t->outer) / 2), up = vec3(0, 0, 1);
        const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH,
                                  .patches = PATCHES, .rays = RAYS, .point = &between,
                                  .normal = &up, .points = 1 };
        Session session;
        Pipeline pipeline;
        Scene *scene = scene_create("spheres", err);
        if (scene != NULL) {
            const uint32_t a = model_grey(scene, "inner", t->reflectance[0], t->exitance[0], err);
            const uint32_t b = model_grey(scene, "outer", t->reflectance[1], t->exitance[1], err);
            if (!error_is_set(err))
                scene->polygons.materials[b].emits_both = true;
            model_shape(scene, SHAPE_SPHERE, 0, middle, inner, a, "inner", err);
            model_shape(scene, SHAPE_SPHERE, 0, middle, vec3_scale(inner, t->outer), b, "outer",
                        err);
        }
        if (validation_run(validation, scene, &setup, &session, &pipeline, err)) {
            const double *b = pipeline.solution->radiosity;
            const double inside = validation_mean(&pipeline, b, "inner", FRONT_SIDE);
            const double outside = validation_mean(&pipeline, b, "outer", BACK_SIDE);
            const double share = 3 / sqrt((double)RAYS * PATCHES);
            validation_check(validation, "inner radiosity", t->radiosity[0], inside,
                             share * t->radiosity[0], NAN, err);
            validation_check(validation, "outer radiosity", t->radiosity[1], outside,
                             share * t->radiosity[1], NAN, err);
        }
        validation_end(&session, &pipeline);
    }
    return !error_is_set(err);
}

/* --- integrating sphere ----------------------------------------------------------------------- */

/* A point source of 100 lm half way up inside a sphere of radius 1: what it sends directly falls
 * with distance and angle, what the wall sends is the same everywhere. */
typedef struct {
    double reflectance, total[5]; /* at polar angles 0 45 90 135 180 degrees */
} Globe;

static const Globe globes[] = {
    { 0.5, { 39.788735773, 20.8180493065, 13.6518475019, 11.8918322035, 11.4945236677 } },
    { 0.9, { 103.45071301, 84.4800265432, 77.3138247387, 75.5538094403, 75.1565009045 } },
};
/* Half a per cent is asked of a sphere of 1280 facets; ours is exact. */
static const double GLOBE_SHARE = 0.005;

static bool run_globe(Validation *validation, Error *err)
{
    static const double angles[] = { 0, 45, 90, 135, 180 };
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_BOTH,
                              .patches = PATCHES, .rays = RAYS };
    for (size_t i = 0; i < sizeof globes / sizeof *globes && !error_is_set(err); i++) {
        Session session;
        Pipeline pipeline;
        Scene *scene = scene_create("globe", err);
        if (scene != NULL) {
            const uint32_t m = model_grey(scene, "wall", globes[i].reflectance, 0, err);
            model_shape(scene, SHAPE_SPHERE, 0, vec3(0, 0, 0), vec3(1, 1, 1), m, "wall", err);
            model_point_light(scene, LIGHT_POINT, vec3(0, 0, 0.5), 100 / (4 * PI), err);
        }
        const bool done = validation_run(validation, scene, &setup, &session, &pipeline, err);
        for (int k = 0; done && k < 5; k++) {
            const double a = angles[k] * PI / 180;
            const Vec3 p = vec3(sin(a), 0, cos(a));
            char quantity[40];
            double error = NAN;
            const double value = validation_measure(&pipeline, p, vec3_scale(p, -1), &error, err);
            snprintf(quantity, sizeof quantity, "rho %.1f, %.0f degrees",
                     globes[i].reflectance, angles[k]);
            validation_check(validation, quantity, globes[i].total[k], value,
                             GLOBE_SHARE * globes[i].total[k], error, err);
        }
        validation_end(&session, &pipeline);
    }
    return !error_is_set(err);
}

const Case *validate_closed_cases(size_t *count)
{
    static const Case cases[] = {
        { "furnace", "closed rooms of one material", run_furnaces },
        { "two-spheres", "concentric spheres, two materials", run_two_spheres },
        { "integrating-sphere", "point source in a sphere", run_globe },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
