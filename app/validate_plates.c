/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: light of surfaces that shine alone, at points, after CIE 171 [cie171], values
 * recomputed in closed form; and open or curved pairs of surfaces whose light varies over them,
 * against solutions of the continuous equation (Nystroem and product integration on two meshes,
 * uncertainties 1e-8 and below). */
#include <math.h>

#include "app/model.h"
#include "app/validate.h"

static const double PI = 3.14159265358979323846;

typedef struct {
    const char *label;
    Vec3        point;
    double      value;
} PointValue;

/* Points of one case over a scene whose one shining surface is a rectangle. */
typedef struct {
    const char       *name;    /* said before each label */
    Vec3              origin, u, v;
    double            exitance, share; /* share: what is asked, relative */
    const PointValue *point;
    int               points;
    bool              box;     /* a black box stands between */
} Shining;

static Scene *shining_scene(const Shining *s, Error *err)
{
    Scene *scene = scene_create(s->name, err);
    if (scene == NULL)
        return NULL;
    const uint32_t lamp = model_grey(scene, "lamp", 0, s->exitance, err);
    const uint32_t black = model_grey(scene, "black", 0, 0, err);
    model_rectangle(scene, s->origin, s->u, s->v, lamp, "lamp", err);
    if (s->box) {
        const Vec3 x = vec3(4, 0, 0), z = vec3(0, 0, 1), thick = vec3(0, 0.2, 0);
        model_rectangle(scene, vec3(0, 2.5, 0), x, z, black, "box", err);
        model_rectangle(scene, vec3(0, 2.7, 0), z, x, black, "box", err);
        model_rectangle(scene, vec3(0, 2.5, 1), x, thick, black, "box", err);
        model_rectangle(scene, vec3(0, 2.5, 0), z, thick, black, "box", err);
        model_rectangle(scene, vec3(4, 2.5, 0), thick, z, black, "box", err);
    }
    return scene;
}

/* Which way a point looks: walls are y = 0, floors z = 0, all else ceilings. */
static Vec3 look(Vec3 point)
{
    return point.y == 0 ? vec3(0, 1, 0) : point.z == 0 ? vec3(0, 0, 1) : vec3(0, 0, -1);
}

/* A point that sees nothing at all gets exactly nothing. */
static bool run_shining(Validation *validation, const Shining *s, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_SOLVE, .closure = CLOSURE_NONE, .patches = 200,
                              .rays = 64 };
    Session session;
    Pipeline pipeline;
    const bool done = validation_run(validation, shining_scene(s, err), &setup, &session,
                                     &pipeline, err);
    for (int i = 0; done && i < s->points; i++) {
        const PointValue *p = &s->point[i];
        char quantity[40];
        double error = NAN;
        const double value = validation_measure(&pipeline, p->point, look(p->point), &error, err);
        snprintf(quantity, sizeof quantity, "%s%s", s->name, p->label);
        validation_check(validation, quantity, p->value, value, s->share * p->value, error, err);
    }
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

/* --- CIE 5.3: a square of 1000 cd/m2 in a black ceiling --------------------------------------- */

static bool run_ceiling(Validation *validation, Error *err)
{
    static const PointValue points[] = {
        { "A", { 2, 0, 2.75 }, 32.6768980144 }, { "B", { 2, 0, 2.25 }, 75.1939245663 },
        { "C", { 2, 0, 1.75 }, 81.3231721249 }, { "D", { 2, 0, 1.25 }, 69.060627013 },
        { "E", { 2, 0, 0.75 }, 53.4035311082 }, { "F", { 2, 0, 0.25 }, 40.0018520199 },
        { "G", { 2, 0.25, 0 }, 61.4240985385 }, { "H", { 2, 0.75, 0 }, 79.2551573162 },
        { "I", { 2, 1.25, 0 }, 95.6672763333 }, { "J", { 2, 1.75, 0 }, 105.778242176 },
    };
    const Shining s = { .name = "lux at ", .origin = { 1.5, 1.5, 3 }, .u = { 0, 1, 0 },
                        .v = { 1, 0, 0 }, .exitance = 1000 * PI, .share = 0.005, .point = points,
                        .points = sizeof points / sizeof *points };
    return run_shining(validation, &s, err);
}

/* --- CIE 5.6: a lit ground; per cent of what it sends ----------------------------------------- */

static bool run_ground(Validation *validation, Error *err)
{
    static const PointValue small[] = {
        { "B", { 2, 0, 0.75 }, 0.57993570311 },  { "C", { 2, 0, 1.25 }, 0.644365549649 },
        { "D", { 2, 0, 1.75 }, 0.556353901134 }, { "E", { 2, 0, 2.25 }, 0.433296277742 },
        { "F", { 2, 0, 2.75 }, 0.32510907916 },  { "G", { 2, 0.25, 3 }, 0.49139644149 },
        { "H", { 2, 0.75, 3 }, 0.639130355712 }, { "I", { 2, 1.25, 3 }, 0.777644524366 },
        { "J", { 2, 1.75, 3 }, 0.86426002938 },
    };
    static const PointValue medium[] = {
        { "B", { 2, 0, 0.75 }, 35.900504809 },   { "C", { 2, 0, 1.25 }, 27.9916238682 },
        { "D", { 2, 0, 1.75 }, 21.6385110745 },  { "E", { 2, 0, 2.25 }, 16.7163145193 },
        { "F", { 2, 0, 2.75 }, 12.9673724008 },  { "G", { 2, 0.25, 3 }, 26.7951875063 },
        { "H", { 2, 0.75, 3 }, 30.938710785 },   { "I", { 2, 1.25, 3 }, 33.9757187745 },
        { "J", { 2, 1.75, 3 }, 35.5665924545 },
    };
    static const PointValue large[] = {
        { "B", { 2, 0, 0.75 }, 49.830480525 },  { "D", { 2, 0, 1.75 }, 49.6044631042 },
        { "F", { 2, 0, 2.75 }, 49.3784661918 }, { "G", { 2, 0.25, 3 }, 99.988216797 },
        { "J", { 2, 1.75, 3 }, 99.9882177551 },
    };
    const Shining grounds[] = {
        { .name = "0.5 m, ", .origin = { 1.75, 1.75, 0 }, .u = { 0.5, 0, 0 }, .v = { 0, 0.5, 0 },
          .exitance = 100, .share = 0.005, .point = small,
          .points = sizeof small / sizeof *small },
        { .name = "4 m, ", .origin = { 0, 0, 0 }, .u = { 4, 0, 0 }, .v = { 0, 4, 0 },
          .exitance = 100, .share = 0.005, .point = medium,
          .points = sizeof medium / sizeof *medium },
        { .name = "500 m, ", .origin = { -248, -248, 0 }, .u = { 500, 0, 0 }, .v = { 0, 500, 0 },
          .exitance = 100, .share = 0.005, .point = large,
          .points = sizeof large / sizeof *large },
    };
    for (size_t i = 0; i < sizeof grounds / sizeof *grounds; i++)
        if (!run_shining(validation, &grounds[i], err))
            return false;
    return true;
}

/* --- CIE 5.7: a wall behind a box; per cent of what it sends ---------------------------------- */

static bool run_behind(Validation *validation, Error *err)
{
    static const PointValue points[] = {
        { "A", { 2, 0, 2.75 }, 16.0706422446 }, { "B", { 2, 0, 2.25 }, 16.3296765728 },
        { "C", { 2, 0, 1.75 }, 15.3988099169 }, { "D", { 2, 0, 1.25 }, 13.3220178489 },
        { "E", { 2, 0, 0.75 }, 10.3169243604 }, { "F", { 2, 0, 0.25 }, 7.07896899049 },
        { "G", { 2, 0.25, 0 }, 3.38233519298 }, { "H", { 2, 0.75, 0 }, 3.62898563553 },
        { "I", { 2, 1.25, 0 }, 3.01295124496 }, { "J", { 2, 1.75, 0 }, 0 },
        { "K", { 2, 2.25, 0 }, 0 },
    };
    const Shining s = { .name = "per cent at ", .origin = { 0, 4, 0 }, .u = { 4, 0, 0 },
                        .v = { 0, 0, 3 }, .exitance = 100, .share = 0.01, .point = points,
                        .points = sizeof points / sizeof *points, .box = true };
    return run_shining(validation, &s, err);
}

/* --- pairs whose light varies over them ------------------------------------------------------- */

enum { PATCHES = 6000, RAYS = 1024 };

/* What a fine mesh is asked for, absolute at an exitance of 1. */
static const double FINE_MESH = 2e-4;

static const PointRadiosity plates_points[] = {
    { "lit plate at 0.5, 0.5", { 0.5, 0.5, 0 }, { 0, 0, 1 }, 1, 0.5, 1.012326763 },
    { "lit plate at 0.25, 0.5", { 0.25, 0.5, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0114428372 },
    { "lit plate at 0.25, 0.25", { 0.25, 0.25, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0106362477 },
    { "lit plate at 0, 0.5", { 0, 0.5, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0091912158 },
    { "lit plate at 0, 0", { 0, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0070063484 },
    { "other plate at 0.5, 0.5", { 0.5, 0.5, 1 }, { 0, 0, -1 }, 0, 0.5, 0.120976802 },
    { "other plate at 0.25, 0.5", { 0.25, 0.5, 1 }, { 0, 0, -1 }, 0, 0.5, 0.1126420114 },
    { "other plate at 0.25, 0.25", { 0.25, 0.25, 1 }, { 0, 0, -1 }, 0, 0.5, 0.1049984097 },
    { "other plate at 0, 0.5", { 0, 0.5, 1 }, { 0, 0, -1 }, 0, 0.5, 0.0911150167 },
    { "other plate at 0, 0", { 0, 0, 1 }, { 0, 0, -1 }, 0, 0.5, 0.0699750448 },
};

static bool run_open_plates(Validation *validation, Error *err)
{
    static const WallMean means[] = { { "lit plate", "a", FRONT_SIDE, 1.01021805506 },
                                      { "other plate", "b", FRONT_SIDE, 0.100947189239 } };
    const Vec3 x = vec3(1, 0, 0), y = vec3(0, 1, 0);
    Scene *scene = scene_create("plates", err);
    if (scene == NULL)
        return false;
    model_rectangle(scene, vec3(0, 0, 0), x, y, model_grey(scene, "lit", 0.5, 1, err), "a", err);
    model_rectangle(scene, vec3(0, 0, 1), y, x, model_grey(scene, "grey", 0.5, 0, err), "b", err);
    const MeanSetup setup = { .patches = PATCHES, .rays = RAYS, .tolerance = FINE_MESH,
                              .point = plates_points,
                              .points = sizeof plates_points / sizeof *plates_points };
    return validation_means(validation, scene, &setup, means, 2, err);
}

static const PointRadiosity discs_points[] = {
    { "lit disc, radius 0", { 0, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0530602895 },
    { "lit disc, radius 0.2", { 0.2, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0517741529 },
    { "lit disc, radius 0.4", { 0.4, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0480324526 },
    { "lit disc, radius 0.6", { 0.6, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0422118516 },
    { "lit disc, radius 0.8", { 0.8, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0350006985 },
    { "lit disc, radius 1", { 1, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.0273704765 },
    { "other disc, radius 0", { 0, 0, 1 }, { 0, 0, -1 }, 0, 0.5, 0.2605083583 },
    { "other disc, radius 0.2", { 0.2, 0, 1 }, { 0, 0, -1 }, 0, 0.5, 0.2552492396 },
    { "other disc, radius 0.4", { 0.4, 0, 1 }, { 0, 0, -1 }, 0, 0.5, 0.2395575022 },
    { "other disc, radius 0.6", { 0.6, 0, 1 }, { 0, 0, -1 }, 0, 0.5, 0.2140382045 },
    { "other disc, radius 0.8", { 0.8, 0, 1 }, { 0, 0, -1 }, 0, 0.5, 0.1806953376 },
    { "other disc, radius 1", { 1, 0, 1 }, { 0, 0, -1 }, 0, 0.5, 0.1435740954 },
};

static bool run_open_discs(Validation *validation, Error *err)
{
    static const WallMean means[] = { { "lit disc", "a", FRONT_SIDE, 1.03905469759 },
                                      { "other disc", "b", FRONT_SIDE, 0.198684128339 } };
    Scene *scene = scene_create("discs", err);
    if (scene == NULL)
        return false;
    model_shape(scene, SHAPE_DISC, 0, vec3(0, 0, 0), vec3(1, 1, 1),
                model_grey(scene, "lit", 0.5, 1, err), "a", err);
    model_shape(scene, SHAPE_DISC, 0, vec3(0, 0, 1), vec3(1, 1, -1),
                model_grey(scene, "grey", 0.5, 0, err), "b", err);
    const MeanSetup setup = { .patches = PATCHES, .rays = RAYS, .tolerance = FINE_MESH,
                              .point = discs_points,
                              .points = sizeof discs_points / sizeof *discs_points };
    return validation_means(validation, scene, &setup, means, 2, err);
}

static const PointRadiosity can_points[] = {
    { "bottom, radius 0", { 0, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.092672302 },
    { "bottom, radius 0.2375", { 0.2375, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.093686799 },
    { "bottom, radius 0.475", { 0.475, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.097083826 },
    { "bottom, radius 0.7125", { 0.7125, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.104314002 },
    { "bottom, radius 0.95", { 0.95, 0, 0 }, { 0, 0, 1 }, 1, 0.5, 1.121485865 },
    { "coat, height 0.1", { 1, 0, 0.1 }, { -1, 0, 0 }, 0, 0.5, 0.3097811106 },
    { "coat, height 0.5", { 1, 0, 0.5 }, { -1, 0, 0 }, 0, 0.5, 0.2331112407 },
    { "coat, height 1", { 1, 0, 1 }, { -1, 0, 0 }, 0, 0.5, 0.1672589507 },
    { "coat, height 1.5", { 1, 0, 1.5 }, { -1, 0, 0 }, 0, 0.5, 0.1270967597 },
    { "coat, height 1.9", { 1, 0, 1.9 }, { -1, 0, 0 }, 0, 0.5, 0.1068725698 },
    { "top, radius 0", { 0, 0, 2 }, { 0, 0, -1 }, 0, 0.5, 0.1774348603 },
    { "top, radius 0.2375", { 0.2375, 0, 2 }, { 0, 0, -1 }, 0, 0.5, 0.1750587866 },
    { "top, radius 0.475", { 0.475, 0, 2 }, { 0, 0, -1 }, 0, 0.5, 0.1680330153 },
    { "top, radius 0.7125", { 0.7125, 0, 2 }, { 0, 0, -1 }, 0, 0.5, 0.1565887917 },
    { "top, radius 0.95", { 0.95, 0, 2 }, { 0, 0, -1 }, 0, 0.5, 0.1403807033 },
};

static bool run_can(Validation *validation, Error *err)
{
    static const WallMean means[] = { { "bottom, lit", "bottom", FRONT_SIDE, 1.106108584 },
                                      { "coat", "coat", BACK_SIDE, 0.1842554499 },
                                      { "top", "top", FRONT_SIDE, 0.156869606 } };
    Scene *scene = scene_create("can", err);
    if (scene == NULL)
        return false;
    const uint32_t lit = model_grey(scene, "lit", 0.5, 1, err);
    const uint32_t grey = model_grey(scene, "grey", 0.5, 0, err);
    model_shape(scene, SHAPE_DISC, 0, vec3(0, 0, 0), vec3(1, 1, 1), lit, "bottom", err);
    model_shape(scene, SHAPE_DISC, 0, vec3(0, 0, 2), vec3(1, 1, -1), grey, "top", err);
    model_shape(scene, SHAPE_FRUSTUM, 1, vec3(0, 0, 0), vec3(1, 1, 2), grey, "coat", err);
    const MeanSetup setup = { .patches = PATCHES, .rays = RAYS, .tolerance = FINE_MESH,
                              .point = can_points,
                              .points = sizeof can_points / sizeof *can_points };
    return validation_means(validation, scene, &setup, means, 3, err);
}

const Case *validate_plate_cases(size_t *count)
{
    static const Case cases[] = {
        { "cie-5.3", "a square lamp in a black room", run_ceiling },
        { "cie-5.6", "light from a lit ground", run_ground },
        { "cie-5.7", "a wall seen over a box", run_behind },
        { "open-plates", "two plates, light escapes", run_open_plates },
        { "open-discs", "two discs, light escapes", run_open_discs },
        { "can", "a closed cylinder, its bottom shines", run_can },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
