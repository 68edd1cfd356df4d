/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline.h -- the way of the data, from a file to light on patches, a stage at a time. */
#ifndef APP_PIPELINE_H
#define APP_PIPELINE_H

#include "app/adapt_report.h"
#include "app/changes.h"
#include "app/picture_report.h"
#include "app/relit.h"
#include "app/session.h"
#include "inspect/imprint.h"
#include "radiosity/clusters.h"
#include "radiosity/direct.h"
#include "radiosity/group_factors.h"
#include "radiosity/light_check.h"
#include "radiosity/links.h"
#include "radiosity/room.h"
#include "radiosity/sides.h"
#include "radiosity/solve.h"
#include "radiosity/stochastic.h"
#include "render/gather.h"
#include "render/path.h"
#include "scenes/scene.h"

typedef enum {
    STAGE_READ,
    STAGE_MESH,    /* surfaces; later sides and patches */
    STAGE_BVH,
    STAGE_FACTORS,
    STAGE_SOLVE,   /* direct light and solver */
    STAGE_GATHER,
    STAGE_WRITE,
    STAGE_COUNT
} Stage;

/* Faces that were cut where others touch them, that gave way to others in their plane, that would
 * have become too many pieces; area that gave way. */
typedef struct {
    uint32_t cut, covered, left;
    double   area;
} CutCount;

/* What --accuracy came to: standard errors of irradiance, relative. */
typedef struct {
    double   asked;          /* 0: it was not */
    double   reached;        /* of patches */
    double   points;         /* of measuring points; 0: there are none */
    uint32_t rays, most;     /* per patch in the last round, and at most */
    uint32_t point_rays;
} LightAccuracy;

typedef struct Pipeline {
    Session     *session;
    const double *time;        /* that the scene is read for; NULL: --time */
    Scene       *scene;
    Defects      defects;      /* found and repaired while connecting; for check alone */
    CutCount     cuts;
    Surfaces    *surfaces;
    Bvh         *bvh;
    uint8_t     *sides, *emitting;  /* [surfaces->count] */
    uint8_t     *skin;         /* [surfaces->count]  of mirrors_skins */
    bool         sides_given;  /* by --sides, or all fronts: not found by sight */
    SidesReport  sides_report;
    Camera      *view;              /* [view_count]  chosen for pictures; only when has_camera */
    uint32_t     view_count;
    Camera       camera;            /* of the picture under way; at first view[0] */
    bool         has_camera;
    const Vec3  *more_eye;          /* [more_eyes]  of other moments that share the solution */
    size_t       more_eyes;
    const Vec3  *point, *normal;    /* [point_count]  measuring points, the caller's */
    size_t       point_count;
    Patches     *patches;
    Room         room;
    GroupFactors *groups;           /* factors between groups or materials; else NULL */
    uint32_t    *group_class;       /* [groups->count]  the scene's group or material of each */
    Links       *links;             /* between patches, or with a row for each of groups' */
    LinksReport  raw, report;       /* of the links as cast, and as enforced */
    LinksChange  change;            /* of factors, by enforcing */
    double       closure_seconds;   /* of enforcing alone */
    double       rounding;          /* largest, relative, of factors in 16 bits */
    bool         factors_loaded;    /* from --factors */
    Links       *raw_links;         /* as cast; factors alone keeps them, else NULL */
    OpenPlaces   places;            /* of the stochastic solver: its links are those above */
    StochasticReport stochastic;    /* of its solution */
    ClustersReport clusters;        /* of that of the hierarchical solver, which has places too */
    AdaptReport  adapt;
    double       factors_seconds;   /* casting alone, without closure */
    Direct       direct;
    double      *emission, *reflectance; /* [patches->count * ROOM_BANDS] */
    SolveProblem problem;
    Solution    *solution;
    Energy       energy[ROOM_BANDS];
    LightAccuracy accuracy;
    LightCheck   check;             /* of the solution; patches 0: none was made */
    Changes      changes;           /* after it is solved */
    Relit        relit;
    /* called after each pass of adaption; NULL: not. error: [patches] of adapt_errors */
    void (*watch)(void *user, const Links *links, const Solution *solution, const double *error);
    /* what the solver without links is to come to, asked again as it goes, and each of its steps;
     * NULL: --tolerance, and nobody looks on */
    double     (*tolerance)(void *user);
    void       (*step)(void *user, const SolveStep *step);
    void        *watch_user;    /* of all three */
    struct Saving *saving;          /* the caller's; NULL: nothing is saved */
    RenderReport render;            /* of the picture under way; then of all: rays and seconds
                                       added, samples the mean, the largest error */
    PathReport   path;              /* likewise, of --renderer path */
    int          width, height;     /* of the picture; 0: none was made */
    double       exposure;          /* EV that the picture was shown with */
    uint32_t     moments, solutions; /* of --shutter, and how many were solved for; 0: none */
    PictureReport *picture;         /* [picture_count]  one for each view, in that order */
    uint32_t     picture_count;
    double       seconds[STAGE_COUNT];
    uint64_t     peak[STAGE_COUNT]; /* bytes, most used up to the end of the stage */
} Pipeline;

/* Each does its stage and notes the time; false and *err when it failed. They build on each other
 * in this order. */
bool pipeline_read(Pipeline *pipeline, Error *err);
bool pipeline_mesh(Pipeline *pipeline, Error *err);   /* surfaces and BVH */
bool pipeline_sides(Pipeline *pipeline, Error *err);  /* sides in use; part of the next */
/* Fills pipeline->room from what is there; part of the next. */
void pipeline_room(Pipeline *pipeline);
bool pipeline_patches(Pipeline *pipeline, Error *err);
bool pipeline_factors(Pipeline *pipeline, Error *err); /* pipeline_factors.c */
bool pipeline_solve(Pipeline *pipeline, Error *err);
/* The first part of it: direct light, and the problem to solve. */
bool pipeline_light(Pipeline *pipeline, Error *err);
/* And its last: the balance of energy, from solution and links. */
void pipeline_energy(Pipeline *pipeline);
/* The problem alone: emission and reflectance of the patches as the scene has them now. */
bool pipeline_problem(Pipeline *pipeline, Error *err);

/* Chooses the cameras: --camera, which may name several, --eye, the file's first, else one that
 * shows the room. Between pipeline_mesh and pipeline_patches, for what is seen takes part. */
bool pipeline_camera(Pipeline *pipeline, Error *err);
/* The same again, of the scene's cameras as they are now; whenever the surfaces are there. */
bool pipeline_views(Pipeline *pipeline, Error *err);

/* Fails with ERROR_MEMORY when `more` bytes on top of what is in use pass --max-memory. */
bool pipeline_fits(const Pipeline *pipeline, uint64_t more, const char *what, Error *err);
/* Tells that a stage begins. */
void pipeline_begin(Pipeline *pipeline, Stage stage);
/* Whether a stage that failed was only asked to stop: then it may run once more, roughly. */
bool pipeline_hurry(Pipeline *pipeline, Error *err);
/* Rays per patch of solvers that cast their own: what was asked for, or few in a hurry. */
uint32_t pipeline_solver_rays(const Pipeline *pipeline);
/* Adds the time since `begin` to a stage and notes the memory. */
void pipeline_note(Pipeline *pipeline, Stage stage, double begin);
const char *pipeline_stage_name(Stage stage);

/* app/pipeline_imprint.c: cuts the scene's faces for the next stage; `tell`: and warns. False when
 * there is nothing to take over: it failed, is switched off, or check has only listed what is. */
bool pipeline_imprint(Pipeline *pipeline, bool tell, Imprint *imprint, Error *err);

/* 0 when all was reached, 4 when a tolerance was missed, 5 when stopped before. */
int pipeline_exit_code(const Pipeline *pipeline);

void pipeline_clear(Pipeline *pipeline);

#endif
