/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: rooms whose light varies over each wall, against independent solutions of the
 * continuous radiosity equation (Galerkin with exact visibility on three meshes, extrapolated;
 * uncertainties near 1e-5 and below). A solution that is constant per wall misses them by far. */
#include <math.h>

#include "app/model.h"
#include "app/validate.h"

enum { PATCHES = 6000, RAYS = 2048 };

/* What a fine mesh is asked for, absolute at an exitance of 1. */
static const double FINE_MESH = 2e-4;

static bool check_means(Validation *validation, Scene *scene, const WallMean *walls, size_t count,
                        const PointRadiosity *point, size_t points, Error *err)
{
    const MeanSetup setup = { .patches = PATCHES, .rays = RAYS, .tolerance = FINE_MESH,
                              .point = point, .points = points };
    return validation_means(validation, scene, &setup, walls, count, err);
}

/* --- unit cube, ceiling emits ----------------------------------------------------------------- */

static Scene *lit_cube(double reflectance, uint32_t *wall, Error *err)
{
    Scene *scene = scene_create("cube", err);
    if (scene == NULL)
        return NULL;
    const uint32_t m = model_grey(scene, "wall", reflectance, 0, err);
    const uint32_t lamp = model_grey(scene, "lamp", reflectance, 1, err);
    model_box(scene, vec3(1, 1, 1), (uint32_t[]){ m, m, m, m, m, lamp }, err);
    if (wall != NULL)
        *wall = m;
    return scene;
}

enum { CUBES = 3, CUBE_POINTS = 10 };

static const PointRadiosity cube_points[CUBES][CUBE_POINTS] = { {
    { "floor at 0.5, 0.5", { 0.5, 0.5, 0 }, { 0, 0, 1 }, 0, 0.2, 0.0552114593 },
    { "floor at 0.1, 0.5", { 0.1, 0.5, 0 }, { 0, 0, 1 }, 0, 0.2, 0.0463775014 },
    { "floor at 0.1, 0.1", { 0.1, 0.1, 0 }, { 0, 0, 1 }, 0, 0.2, 0.0390603851 },
    { "ceiling at 0.5, 0.5", { 0.5, 0.5, 1 }, { 0, 0, -1 }, 1, 0.2, 1.0098676146 },
    { "ceiling at 0.1, 0.1", { 0.1, 0.1, 1 }, { 0, 0, -1 }, 1, 0.2, 1.0125174923 },
    { "wall at 0.5, 0.5", { 0, 0.5, 0.5 }, { 1, 0, 0 }, 0, 0.2, 0.0462302315 },
    { "wall at 0.5, 0.1", { 0, 0.5, 0.1 }, { 1, 0, 0 }, 0, 0.2, 0.0251591399 },
    { "wall at 0.1, 0.1", { 0, 0.1, 0.1 }, { 1, 0, 0 }, 0, 0.2, 0.0211945276 },
    { "wall at 0.5, 0.9", { 0, 0.5, 0.9 }, { 1, 0, 0 }, 0, 0.2, 0.0921156797 },
    { "wall at 0.1, 0.9", { 0, 0.1, 0.9 }, { 1, 0, 0 }, 0, 0.2, 0.0780165337 },
}, {
    { "floor at 0.5, 0.5", { 0.5, 0.5, 0 }, { 0, 0, 1 }, 0, 0.5, 0.1976044045 },
    { "floor at 0.1, 0.5", { 0.1, 0.5, 0 }, { 0, 0, 1 }, 0, 0.5, 0.1717908201 },
    { "floor at 0.1, 0.1", { 0.1, 0.1, 0 }, { 0, 0, 1 }, 0, 0.5, 0.1484061667 },
    { "ceiling at 0.5, 0.5", { 0.5, 0.5, 1 }, { 0, 0, -1 }, 1, 0.5, 1.0918051598 },
    { "ceiling at 0.1, 0.1", { 0.1, 0.1, 1 }, { 0, 0, -1 }, 1, 0.5, 1.1100013474 },
    { "wall at 0.5, 0.5", { 0, 0.5, 0.5 }, { 1, 0, 0 }, 0, 0.5, 0.1776476089 },
    { "wall at 0.5, 0.1", { 0, 0.5, 0.1 }, { 1, 0, 0 }, 0, 0.5, 0.1227901218 },
    { "wall at 0.1, 0.1", { 0, 0.1, 0.1 }, { 1, 0, 0 }, 0, 0.5, 0.1070493569 },
    { "wall at 0.5, 0.9", { 0, 0.5, 0.9 }, { 1, 0, 0 }, 0, 0.5, 0.2923371755 },
    { "wall at 0.1, 0.9", { 0, 0.1, 0.9 }, { 1, 0, 0 }, 0, 0.5, 0.2637468861 },
}, {
    { "floor at 0.5, 0.5", { 0.5, 0.5, 0 }, { 0, 0, 1 }, 0, 0.8, 0.7130824162 },
    { "floor at 0.1, 0.5", { 0.1, 0.5, 0 }, { 0, 0, 1 }, 0, 0.8, 0.6639537605 },
    { "floor at 0.1, 0.1", { 0.1, 0.1, 0 }, { 0, 0, 1 }, 0, 0.8, 0.6129185362 },
    { "ceiling at 0.5, 0.5", { 0.5, 0.5, 1 }, { 0, 0, -1 }, 1, 0.8, 1.5522623493 },
    { "ceiling at 0.1, 0.1", { 0.1, 0.1, 1 }, { 0, 0, -1 }, 1, 0.8, 1.6064140153 },
    { "wall at 0.5, 0.5", { 0, 0.5, 0.5 }, { 1, 0, 0 }, 0, 0.8, 0.6836638085 },
    { "wall at 0.5, 0.1", { 0, 0.5, 0.1 }, { 1, 0, 0 }, 0, 0.8, 0.5886625706 },
    { "wall at 0.1, 0.1", { 0, 0.1, 0.1 }, { 1, 0, 0 }, 0, 0.8, 0.5493638521 },
    { "wall at 0.5, 0.9", { 0, 0.5, 0.9 }, { 1, 0, 0 }, 0, 0.8, 0.872136252 },
    { "wall at 0.1, 0.9", { 0, 0.1, 0.9 }, { 1, 0, 0 }, 0, 0.8, 0.8409698721 },
} };

static bool run_cube(Validation *validation, Error *err)
{
    static const struct {
        double   reflectance;
        WallMean walls[3];
    } cubes[CUBES] = {
        { 0.2, { { "rho 0.2, wall", "x0", ANY_SIDE, 0.04796085341 },
                 { "rho 0.2, floor", "z0", ANY_SIDE, 0.04637051048 },
                 { "rho 0.2, ceiling", "z1", ANY_SIDE, 1.011786076 } } },
        { 0.5, { { "rho 0.5, wall", "x0", ANY_SIDE, 0.1811055969 },
                 { "rho 0.5, floor", "z0", ANY_SIDE, 0.1712160573 },
                 { "rho 0.5, ceiling", "z1", ANY_SIDE, 1.104361555 } } },
        { 0.8, { { "rho 0.8, wall", "x0", ANY_SIDE, 0.6878787909 },
                 { "rho 0.8, floor", "z0", ANY_SIDE, 0.6609791219 },
                 { "rho 0.8, ceiling", "z1", ANY_SIDE, 1.587505715 } } },
    };
    for (int i = 0; i < CUBES; i++)
        if (!check_means(validation, lit_cube(cubes[i].reflectance, NULL, err), cubes[i].walls, 3,
                         cube_points[i], CUBE_POINTS, err))
            return false;
    return true;
}

/* --- the same with a plate half way up -------------------------------------------------------- */

static const PointRadiosity plate_points[] = {
    { "floor at 0.5, 0.5", { 0.5, 0.5, 0 }, { 0, 0, 1 }, 0, 0.5, 0.066443154 },
    { "floor at 0.25, 0.25", { 0.25, 0.25, 0 }, { 0, 0, 1 }, 0, 0.5, 0.11260897 },
    { "floor at 0.1, 0.1", { 0.1, 0.1, 0 }, { 0, 0, 1 }, 0, 0.5, 0.11659518 },
    { "plate, top at 0.5, 0.5", { 0.5, 0.5, 0.5 }, { 0, 0, 1 }, 0, 0.5, 0.36411824 },
    { "plate, bottom at 0.5, 0.5", { 0.5, 0.5, 0.5 }, { 0, 0, -1 }, 0, 0.5, 0.050228708 },
    { "wall at 0.5, 0.5", { 0, 0.5, 0.5 }, { 1, 0, 0 }, 0, 0.5, 0.16818878 },
    { "wall at 0.5, 0.25", { 0, 0.5, 0.25 }, { 1, 0, 0 }, 0, 0.5, 0.10021684 },
    { "wall at 0.5, 0.75", { 0, 0.5, 0.75 }, { 1, 0, 0 }, 0, 0.5, 0.25062435 },
    { "ceiling at 0.5, 0.5", { 0.5, 0.5, 1 }, { 0, 0, -1 }, 1, 0.5, 1.1097792 },
    { "floor at 0.5, 0.1", { 0.5, 0.1, 0 }, { 0, 0, 1 }, 0, 0.5, 0.11056389 },
};

static bool run_plate(Validation *validation, Error *err)
{
    static const WallMean walls[] = {
        { "wall", "x0", ANY_SIDE, 0.17005594 },
        { "floor", "z0", ANY_SIDE, 0.10754288 },
        { "ceiling", "z1", ANY_SIDE, 1.1126046 },
        { "plate, top", "plate", FRONT_SIDE, 0.34737086 },
        { "plate, bottom", "plate", BACK_SIDE, 0.051120198 },
    };
    uint32_t wall = 0;
    Scene *scene = lit_cube(0.5, &wall, err);
    if (scene != NULL)
        model_rectangle(scene, vec3(0.25, 0.25, 0.5), vec3(0.5, 0, 0), vec3(0, 0.5, 0), wall,
                        "plate", err);
    return check_means(validation, scene, walls, sizeof walls / sizeof *walls, plate_points,
                       sizeof plate_points / sizeof *plate_points, err);
}

/* --- L-shaped room, the end wall of one arm emits --------------------------------------------- */

static Scene *lit_l_room(Error *err)
{
    const Vec3 x = vec3(1, 0, 0), y = vec3(0, 1, 0), z = vec3(0, 0, 1);
    static const char *const floors[] = { "floor0", "floor1", "floor2" };
    static const char *const ceilings[] = { "ceiling0", "ceiling1", "ceiling2" };
    static const Vec3 corner[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
    Scene *scene = scene_create("L-shaped room", err);
    if (scene == NULL)
        return NULL;
    const uint32_t m = model_grey(scene, "wall", 0.6, 0, err);
    const uint32_t lamp = model_grey(scene, "lamp", 0.6, 1, err);
    for (int i = 0; i < 3; i++) {
        model_rectangle(scene, corner[i], x, y, m, floors[i], err);
        model_rectangle(scene, vec3_add(corner[i], z), y, x, m, ceilings[i], err);
    }
    model_rectangle(scene, vec3(0, 0, 0), z, x, m, "south0", err);
    model_rectangle(scene, vec3(1, 0, 0), z, x, m, "south1", err);
    model_rectangle(scene, vec3(0, 0, 0), y, z, m, "west0", err);
    model_rectangle(scene, vec3(0, 1, 0), y, z, m, "west1", err);
    model_rectangle(scene, vec3(2, 0, 0), z, y, lamp, "east", err);
    model_rectangle(scene, vec3(0, 2, 0), x, z, m, "north", err);
    model_rectangle(scene, vec3(1, 1, 0), x, z, m, "inner_y", err);
    model_rectangle(scene, vec3(1, 1, 0), z, y, m, "inner_x", err);
    return scene;
}

static const PointRadiosity l_room_points[] = {
    { "floor at 0.5, 0.5", { 0.5, 0.5, 0 }, { 0, 0, 1 }, 0, 0.6, 0.071632283 },
    { "floor at 0.5, 1.5", { 0.5, 1.5, 0 }, { 0, 0, 1 }, 0, 0.6, 0.024835036 },
    { "floor at 1.5, 0.5", { 1.5, 0.5, 0 }, { 0, 0, 1 }, 0, 0.6, 0.22247308 },
    { "west at 0.5, 0.5", { 0, 0.5, 0.5 }, { 1, 0, 0 }, 0, 0.6, 0.096753858 },
    { "west at 1.5, 0.5", { 0, 1.5, 0.5 }, { 1, 0, 0 }, 0, 0.6, 0.038457871 },
    { "north at 0.5, 0.5", { 0.5, 2, 0.5 }, { 0, -1, 0 }, 0, 0.6, 0.025440898 },
    { "dark inner wall at 1.5, 0.5", { 1, 1.5, 0.5 }, { -1, 0, 0 }, 0, 0.6, 0.023346346 },
    { "lit inner wall at 1.5, 0.5", { 1.5, 1, 0.5 }, { 0, -1, 0 }, 0, 0.6, 0.22333344 },
    { "south at 0.5, 0.5", { 0.5, 0, 0.5 }, { 0, 1, 0 }, 0, 0.6, 0.070295733 },
    { "lamp at 0.5, 0.5", { 2, 0.5, 0.5 }, { -1, 0, 0 }, 1, 0.6, 1.1185365 },
    { "ceiling at 0.9, 1.9", { 0.9, 1.9, 1 }, { 0, 0, -1 }, 0, 0.6, 0.014967981 },
};

static bool run_l_room(Validation *validation, Error *err)
{
    static const WallMean walls[] = {
        { "floor, corner", "floor0", ANY_SIDE, 0.073110203 },
        { "floor, lit arm", "floor1", ANY_SIDE, 0.22681361 },
        { "floor, dark arm", "floor2", ANY_SIDE, 0.027707826 },
        { "ceiling, dark arm", "ceiling2", ANY_SIDE, 0.027707826 },
        { "south, corner", "south0", ANY_SIDE, 0.07300569 },
        { "south, lit arm", "south1", ANY_SIDE, 0.22564093 },
        { "west, corner", "west0", ANY_SIDE, 0.089386548 },
        { "west, dark arm", "west1", ANY_SIDE, 0.041173221 },
        { "lamp", "east", ANY_SIDE, 1.1422817 },
        { "north", "north", ANY_SIDE, 0.022418168 },
        { "inner wall, lit arm", "inner_y", ANY_SIDE, 0.22786935 },
        { "inner wall, dark arm", "inner_x", ANY_SIDE, 0.022949085 },
    };
    return check_means(validation, lit_l_room(err), walls, sizeof walls / sizeof *walls,
                       l_room_points, sizeof l_room_points / sizeof *l_room_points, err);
}

const Case *validate_room_cases(size_t *count)
{
    static const Case cases[] = {
        { "cube", "cube with a shining ceiling", run_cube },
        { "cube-plate", "the same, a plate in the middle", run_plate },
        { "l-room", "light round a corner", run_l_room },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
