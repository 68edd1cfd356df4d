/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/scene.h -- a whole scene: geometry, materials, lights, cameras; and how to read one.
 *
 * Owns everything it points to. Readers validate: what they return passes scene_check.
 */
#ifndef SCENES_SCENE_H
#define SCENES_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/monitor.h"
#include "math/light.h"
#include "mesh/polygons.h"
#include "scenes/texture.h"

typedef enum {
    CAMERA_PERSPECTIVE,          /* straight lines stay straight */
    CAMERA_ORTHOGRAPHIC,         /* parallel rays: plans and elevations */
    CAMERA_FISHEYE,              /* equidistant: angle from the axis = distance from the middle */
    CAMERA_PANORAMA              /* equirectangular: longitude across, latitude up */
} Projection;

typedef struct {
    char   name[64];
    Vec3   eye, target, up;      /* up need not be perpendicular to the view */
    double vertical_fov;         /* degrees, whole angle: (0, 180), fisheye and panorama up to 360
                                    and 180; unused by orthographic */
    double aspect;               /* width / height wanted; 0: follows the picture's size */
    Projection projection;
    double view_height;          /* orthographic: scene units that the picture's height shows */
    double aperture;             /* radius of the lens in scene units; 0: all is sharp */
    double focus;                /* distance along the axis that is sharp; 0: the target's */
} Camera;

/* One more copy of a prototype, by reference. */
typedef struct {
    uint32_t prototype;          /* index into Scene.prototypes */
    uint32_t material;           /* of all its faces: index into Scene.polygons.materials */
    Affine   to_world;           /* has an inverse */
} Placement;

typedef struct {
    char      *file;             /* path as given */
    Polygons   polygons;
    Polygons  *prototypes;       /* [prototype_count]  in their own space; materials unused */
    size_t     prototype_count;
    Placement *placements;       /* [placement_count]  not among `polygons` */
    size_t     placement_count;
    Textures   textures;         /* what Material.texture counts */
    Light     *lights;           /* [light_count] */
    size_t     light_count;
    Camera    *cameras;          /* [camera_count]; the first is the default */
    size_t     camera_count;
    int        width, height;    /* SCREEN's size; 0: not given */
    Rgb        background;       /* radiance of what no surface hides; lights nothing */
    Rgb        ambient;          /* AMB_LIGHT, kept for the Whitted renderer */
    Vec3       origin;           /* of the positions in here, in the file's coordinates: 0, or where
                                    a scene far from the origin was moved from (scene_recentre) */
    Vec3       up;               /* of the file's format: y for OBJ, glTF, z for MSD without SCREEN,
                                    STL ...; from SCREEN's UP when there is one; unit */
    bool       has_screen;       /* the file names a view */
    bool       timed;            /* the file's text asks for TIME: other times, other scenes */
    uint64_t   hash;             /* xxHash of the bytes of all files read, and of the time if that
                                    matters */
} Scene;

/* What becomes of meshes that a scene places again and again. */
typedef enum {
    INSTANCES_FLATTEN,           /* each copy's faces are among Scene.polygons */
    INSTANCES_AUTO,              /* the same until those placed before have come again with
                                    INSTANCES_MOST faces, else as the next */
    INSTANCES_KEEP               /* Scene.prototypes and Scene.placements */
} SceneInstances;
#define INSTANCES_MOST 4000000u

typedef struct {
    double    import_seconds;    /* limit for a foreign file; 0: 120 */
    uint64_t  import_memory;     /* bytes the importing child may use; 0: 8 GiB */
    const Monitor *monitor;      /* warnings; may be NULL */
    SceneInstances instances;    /* of BREPOBJ in MSD, of meshes that several nodes of glTF,
                                    COLLADA and the like show */
    uint64_t  instances_most;    /* 0: INSTANCES_MOST */
    double    time;              /* what TIME is in MSD */
} SceneReadOptions;

/* Reads by the file name's ending: .msd is the own language, all else goes through the importer in
 * a child process. Values that cannot be (reflectance >= 1, negative emission, coordinates that are
 * not finite) are limited or refused and told through monitor's warn.
 * owns   the caller frees with scene_destroy.
 * fails  NULL; ERROR_INPUT with file (and line), ERROR_MEMORY. */
Scene *scene_read(const char *path, const SceneReadOptions *options, Error *err);

Scene *scene_destroy(Scene *scene);

/* Moves a scene that is far from the origin, compared with its size, next to it; scene_read has
 * done so. Exact: the way is a multiple of a power of two about as large as the scene. Warns when
 * the coordinates are floats, or have too few digits, too coarse for it ("coordinates-coarse").
 * fails  false and ERROR_INPUT when a shape cannot be moved. */
bool scene_recentre(Scene *scene, const Monitor *monitor, Error *err);
/* Between the file's coordinates and those in here. */
static inline Vec3 scene_to_file(const Scene *scene, Vec3 p) { return vec3_add(p, scene->origin); }
static inline Vec3 scene_from_file(const Scene *scene, Vec3 p)
{
    return vec3_sub(p, scene->origin);
}

/* An empty scene for readers and tests. */
Scene *scene_create(const char *file, Error *err);
bool   scene_add_light(Scene *scene, const Light *light, Error *err);
bool   scene_add_camera(Scene *scene, const Camera *camera, Error *err);

/* Takes the polygons over: leaves { 0 } in *polygons, failing or not. */
bool scene_add_prototype(Scene *scene, Polygons *polygons, uint32_t *index, Error *err);
bool scene_add_placement(Scene *scene, const Placement *placement, Error *err);
/* Triangles of all there is, copies and all; a curved face counts as none. */
uint64_t scene_triangles(const Scene *scene);

/* Invariants of a Scene, polygons included. */
bool scene_check(const Scene *scene);

/* xxHash of all that light depends on, which is all but cameras: two moments of a scene with the
 * same differ at most in these. */
uint64_t scene_fingerprint(const Scene *scene);

/* True when a material in use emits, or a light exists. */
bool scene_has_light(const Scene *scene);

#endif
