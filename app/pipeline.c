/* SPDX-License-Identifier: BSD-3-Clause */
/* Scene -> surfaces -> BVH -> sides -> patches -> links -> light. */
#include "app/pipeline.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/pipeline_adapt.h"
#include "app/pipeline_copies.h"
#include "app/pipeline_relight.h"
#include "app/pipeline_clusters.h"
#include "app/pipeline_stochastic.h"
#include "app/pipeline_groups.h"
#include "app/saving.h"
#include "app/trace.h"
#include "base/array.h"
#include "math/tolerance.h"
#include "radiosity/mirrors.h"
#include "scenes/ceiling_light.h"

/* What is asked of closed factors: row sums, reciprocity and balance to 1e-6. */
static const double CLOSURE_TOLERANCE = 1e-6;

/* Rays per side in a hurry. */
enum { HURRY_SIDE_RAYS = 8 };

const char *pipeline_stage_name(Stage stage)
{
    static const char *const names[] = { "read", "mesh", "bvh", "factors",
                                         "solve", "gather", "write" };
    assert((unsigned)stage < STAGE_COUNT);
    return names[stage];
}

void pipeline_note(Pipeline *pipeline, Stage stage, double begin)
{
    pipeline->seconds[stage] += progress_now() - begin;
    pipeline->peak[stage] = progress_peak_bytes();
}

void pipeline_begin(Pipeline *pipeline, Stage stage)
{
    const Progress progress = { .stage = pipeline_stage_name(stage), .energy_left = -1 };
    monitor_progress(&pipeline->session->monitor, &progress);
}

bool pipeline_fits(const Pipeline *pipeline, uint64_t more, const char *what, Error *err)
{
    const uint64_t limit = pipeline->session->options.max_memory, used = progress_peak_bytes();
    if (limit == 0 || (used <= limit && more <= limit - used))
        return true;
    return error_set(err, ERROR_MEMORY,
                     "%s: needs %.0f MB on top of %.0f MB in use, --max-memory is %.0f MB", what,
                     1e-6 * (double)more, 1e-6 * (double)used, 1e-6 * (double)limit);
}

bool pipeline_hurry(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    if (err->code != ERROR_STOPPED || session->hurry || session->broken || session->abrupt)
        return false;
    saving_tick(pipeline->saving);
    session->hurry = true;
    *err = (Error){ 0 };
    monitor_warn(&session->monitor, "hurried", session->options.scene, "%s: finishing roughly",
                 session_stop_reason());
    return true;
}

/* In a hurry nothing stops it again: so many rays in all, about a second's work. */
enum { HURRY_RAYS = 1 << 20, HURRY_RAYS_LEAST = 8 };

uint32_t pipeline_solver_rays(const Pipeline *pipeline)
{
    const uint32_t all = pipeline->session->settings.rays;
    const uint32_t few = HURRY_RAYS / pipeline->patches->count;
    const uint32_t hurried = few > HURRY_RAYS_LEAST ? few : HURRY_RAYS_LEAST;
    return pipeline->session->hurry && hurried < all ? hurried : all;
}

/* --- read ------------------------------------------------------------------------------------- */

/* Distances are in scene units, so cd over squared units is lux only after division by what a
 * squared unit is in square metres. */
static void scale_lights(Scene *scene, double unit_m)
{
    assert(unit_m > 0);
    for (size_t i = 0; i < scene->light_count; i++)
        scene->lights[i].intensity =
            rgb_scale(scene->lights[i].intensity, 1 / (unit_m * unit_m));
}

/* The stochastic solver takes glass for a black wall: who lights a room through a window must
 * know. */
static void warn_glass(const Pipeline *pipeline)
{
    const Polygons *soup = &pipeline->scene->polygons;
    const Session *session = pipeline->session;
    if (!session->settings.stochastic || session->options.command == COMMAND_FACTORS)
        return;
    for (size_t i = 0; i < soup->material_count; i++)
        if (rgb_max(soup->materials[i].transmittance) > 0) {
            monitor_warn(&session->monitor, "glass-opaque", soup->materials[i].name,
                         "is clear to the eye, but the light that is solved for does not pass it");
            return;
        }
}

/* Mirrors, glass and gloss give nothing back but their diffuse share, to whom ever: a solution that
 * had gloss in it would be brighter than the paths of the same picture. */
static void leave_diffuse(Polygons *soup)
{
    for (size_t i = 0; i < soup->material_count; i++) {
        Material *m = &soup->materials[i];
        m->specular = m->transmittance = (Rgb){ 0, 0, 0 };
        m->exponent = m->roughness = 0;
    }
}

bool pipeline_read(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const double begin = progress_now();
    pipeline_begin(pipeline, STAGE_READ);
    static const SceneInstances kept[] = { [KEEP_AUTO] = INSTANCES_AUTO,
                                           [KEEP_FLAT] = INSTANCES_FLATTEN,
                                           [KEEP_REFERENCES] = INSTANCES_KEEP };
    const SceneReadOptions so = { .monitor = &session->monitor,
                                  .instances = kept[session->options.instances],
                                  .time = pipeline->time != NULL ? *pipeline->time
                                                                 : session->options.time };
    pipeline->scene = scene_read(session->options.scene, &so, err);
    if (pipeline->scene != NULL) {
        assert(scene_check(pipeline->scene));
        if (options_given(&session->options, OPTION_TIME) && !pipeline->scene->timed)
            monitor_warn(&session->monitor, "time-unused", session->options.scene,
                         "nothing in the file depends on TIME");
        scale_lights(pipeline->scene, session->options.unit_m);
        if (session->options.diffuse)
            leave_diffuse(&pipeline->scene->polygons);
        if (options_given(&session->options, OPTION_UP))
            pipeline->scene->up = vec3_unit(session->options.up);
        changes_read(&pipeline->changes, &session->options, pipeline->scene, err);
    }
    pipeline_note(pipeline, STAGE_READ, begin);
    if (error_is_set(err))
        return false;
    return pipeline->scene != NULL && pipeline_fits(pipeline, 0, session->options.scene, err);
}

/* --- mesh and BVH ----------------------------------------------------------------------------- */

/* `last`: unless a lamp is to be hung up and all made anew, when the same would be told twice. */
static bool build_surfaces(Pipeline *pipeline, bool last, Error *err)
{
    const double begin = progress_now();
    pipeline_begin(pipeline, STAGE_MESH);
    Error found = *err;
    const Session *session = pipeline->session;
    const Polygons *soup = &pipeline->scene->polygons;
    const bool check = session->options.command == COMMAND_CHECK;
    Imprint imprint = { 0 };
    defects_clear(&pipeline->defects);
    /* What is wrong with a file is looked for in its faces as they are. */
    const bool cut = pipeline_imprint(pipeline, last, &imprint, &found);
    if (!error_is_set(&found) || pipeline_hurry(pipeline, &found))
        pipeline->surfaces = surfaces_repair(cut ? &imprint.soup : soup,
                                             &session->settings.repair,
                                             check ? &pipeline->defects : NULL,
                                             &session->monitor, &found);
    if (cut && pipeline->surfaces != NULL)
        imprint_finish(&imprint, pipeline->surfaces);
    if (cut && pipeline->surfaces != NULL
        && !imprint_curved(pipeline->surfaces, last ? &session->monitor : NULL, &found))
        pipeline->surfaces = surfaces_destroy(pipeline->surfaces);
    imprint_clear(&imprint);
    /* The mesh knows no file; whoever reads the message needs its name. */
    if (found.code == ERROR_INPUT && !error_is_set(err))
        error_at(err, ERROR_INPUT, pipeline->scene->file, 0, "%.400s", found.text);
    else
        *err = found;
    pipeline_note(pipeline, STAGE_MESH, begin);
    return pipeline->surfaces != NULL;
}

static bool build_bvh(Pipeline *pipeline, Error *err)
{
    const Surfaces *s = pipeline->surfaces;
    const double begin = progress_now();
    pipeline_begin(pipeline, STAGE_BVH);
    const Primitives primitives = { .position = s->position, .corner = s->corner,
                                    .shape = s->shape, .vertex_count = s->vertex_count,
                                    .triangle_count = s->triangle_count,
                                    .shape_count = s->shape_count };
    const Settings *settings = &pipeline->session->settings;
    pipeline->bvh = bvh_create_as(&primitives, settings->tree, settings->threads, err);
    pipeline_note(pipeline, STAGE_BVH, begin);
    return pipeline->bvh != NULL;
}

/* Adds a lamp when asked to and needed; then the surfaces are made anew with it. */
static bool add_light(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    if (scene_has_light(pipeline->scene))
        return true;
    if (session->options.light == 0) {
        if ((options_table()[OPTION_LIGHT].commands & (unsigned)session->options.command) != 0)
            monitor_warn(&session->monitor, "no-emitter", session->options.scene,
                         "nothing in the scene gives light; --light ceiling hangs up a lamp");
        return true;
    }
    if (!ceiling_light_hang(pipeline->scene, pipeline->surfaces, pipeline->bvh, err))
        return false;
    pipeline->bvh = bvh_destroy(pipeline->bvh);
    pipeline->surfaces = surfaces_destroy(pipeline->surfaces);
    return build_surfaces(pipeline, true, err) && build_bvh(pipeline, err);
}

bool pipeline_mesh(Pipeline *pipeline, Error *err)
{
    assert(pipeline->scene != NULL);
    const bool last = scene_has_light(pipeline->scene) || pipeline->session->options.light == 0;
    if (!pipeline_copies_allowed(pipeline, err) || !build_surfaces(pipeline, last, err)
        || !build_bvh(pipeline, err) || !add_light(pipeline, err))
        return false;
    session_release(pipeline->session);
    return pipeline_fits(pipeline, 0, pipeline->session->options.scene, err);
}

/* --- sides and patches ------------------------------------------------------------------------ */

/* Eyes that what they see takes part: all cameras, and measuring points just off their surfaces. */
static Vec3 *collect_eyes(const Pipeline *pipeline, size_t *count, Error *err)
{
    const Scene *scene = pipeline->scene;
    const double offset = ray_offset(pipeline->surfaces->largest_coordinate);
    Vec3 *eyes = array_create(scene->camera_count + pipeline->point_count + 1 +
                                  pipeline->more_eyes, sizeof *eyes, "eyes", err);
    size_t n = 0;
    if (eyes == NULL)
        return NULL;
    for (size_t i = 0; i < scene->camera_count; i++)
        eyes[n++] = scene->cameras[i].eye;
    if (pipeline->has_camera)
        eyes[n++] = pipeline->camera.eye;
    for (size_t i = 0; i < pipeline->more_eyes; i++)
        eyes[n++] = pipeline->more_eye[i];
    for (size_t i = 0; i < pipeline->point_count; i++)
        eyes[n++] = vec3_mad(pipeline->point[i], offset, pipeline->normal[i]);
    *count = n;
    return eyes;
}

/* Fixed choice of sides: those given take part, and of them those whose material emits. */
static void set_sides(Pipeline *pipeline, uint8_t bits)
{
    const Surfaces *s = pipeline->surfaces;
    const EmitSide emit = (EmitSide)pipeline->session->options.emit;
    const uint8_t lit = emit == EMIT_BOTH ? 3 : emit == EMIT_BACK ? 2 : 1;
    const Material *materials = pipeline->scene->polygons.materials;
    pipeline->sides_given = true;
    for (uint32_t i = 0; i < s->count; i++) {
        const Surface *f = &s->surface[i];
        const Material *m = &materials[f->material];
        /* Of two faces back to back both sides are fronts. */
        const bool plate = f->back != SURFACE_NONE;
        pipeline->sides[i] = plate ? 3 : bits;
        if (rgb_max(m->emission) > 0)
            pipeline->emitting[i] = (uint8_t)(bits & (plate ? 1 : m->emits_both ? 3 : lit));
        if (plate && rgb_max(materials[f->back_material].emission) > 0)
            pipeline->emitting[i] |= 2;
    }
    *(bits == 1 ? &pipeline->sides_report.front : &pipeline->sides_report.both) = s->count;
}

static bool find_sides(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Scene *scene = pipeline->scene;
    const Options *options = &session->options;
    size_t eye_count = 0;
    const bool plain = options->command == COMMAND_FACTORS && options->sides == USE_AUTO &&
                       !scene_has_light(scene) && scene->camera_count == 0;
    if (options->sides != USE_AUTO || plain) {
        set_sides(pipeline, options->sides == USE_BOTH ? 3 : 1);
        return true;
    }
    Vec3 *eyes = collect_eyes(pipeline, &eye_count, err);
    if (eyes == NULL)
        return false;
    SidesOptions so = { .emit = (EmitSide)options->emit, .eye = eyes, .eye_count = eye_count,
                        .seed = session->settings.seed, .threads = session->settings.threads };
    bool done;
    do {
        done = sides_find(pipeline->surfaces, pipeline->bvh, scene->polygons.materials,
                          scene->lights, scene->light_count, &so, pipeline->sides,
                          pipeline->emitting, &pipeline->sides_report, &session->monitor, err);
        so.rays = HURRY_SIDE_RAYS;
    } while (!done && pipeline_hurry(pipeline, err));
    array_free(eyes);
    return done;
}

/* Factors are asked for as geometry alone; rays that light is shot by do not follow mirrors. */
static bool light_goes_on(const Pipeline *pipeline)
{
    const Polygons *soup = &pipeline->scene->polygons;
    const Session *session = pipeline->session;
    return session->options.command != COMMAND_FACTORS && !session->settings.stochastic &&
           mirrors_exist(soup->materials, soup->material_count);
}

/* A last gather looks after gaps itself. They are narrower than this share of the scene: were
 * patches as large as rooms, whole rooms would count as gaps. */
static const double POCKET_SHARE = 1.0 / 8;

/* Room.pocket: for pictures alone; factors that are kept are for solutions as well. */
static double widest_pocket(const Pipeline *pipeline)
{
    const Session  *session = pipeline->session;
    const Surfaces *surfaces = pipeline->surfaces;
    if (session->options.command != COMMAND_RENDER || session->options.factors != NULL ||
        session->settings.stochastic)
        return 0;
    return POCKET_SHARE * vec3_length(vec3_sub(surfaces->hi, surfaces->lo));
}

void pipeline_room(Pipeline *pipeline)
{
    pipeline->room = (Room){
        .surfaces = pipeline->surfaces,
        .bvh = pipeline->bvh,
        .patches = pipeline->patches,
        .materials = pipeline->scene->polygons.materials,
        .material_count = pipeline->scene->polygons.material_count,
        .soup = &pipeline->scene->polygons,
        .textures = &pipeline->scene->textures,
        .lights = pipeline->scene->lights,
        .light_count = pipeline->scene->light_count,
        .sides = pipeline->sides,
        .emitting = pipeline->emitting,
        .sides_given = pipeline->sides_given,
        .mirrors = light_goes_on(pipeline),
        .skin = pipeline->skin,
        .offset = ray_offset(pipeline->surfaces->largest_coordinate),
        .pocket = widest_pocket(pipeline),
    };
}

bool pipeline_sides(Pipeline *pipeline, Error *err)
{
    const double begin = progress_now();
    const uint32_t count = pipeline->surfaces->count;
    assert(pipeline->bvh != NULL && pipeline->sides == NULL);
    pipeline_begin(pipeline, STAGE_MESH);
    pipeline->sides = array_create(count, 1, "sides", err);
    pipeline->emitting = array_create(count, 1, "sides", err);
    pipeline->skin = mirrors_skins(pipeline->surfaces, pipeline->scene->polygons.materials, err);
    if (error_is_set(err) || !find_sides(pipeline, err))
        return false;
    pipeline_note(pipeline, STAGE_MESH, begin);
    return true;
}

bool pipeline_patches(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    if (!pipeline_sides(pipeline, err))
        return false;
    const double begin = progress_now();
    const Settings *settings = &session->settings;
    pipeline_stochastic_choose(pipeline, settings->patches);
    const bool coarse = settings->adapt && !(settings->patch_size > 0);
    const SidesJoined joined = { pipeline->bvh,
                                 ray_offset(pipeline->surfaces->largest_coordinate) };
    const PatchOptions po = { .size = settings->patch_size,
                              .wanted = coarse ? pipeline_adapt_start(settings)
                                               : pipeline_groups_patches(pipeline),
                              .sides = pipeline->sides, .emitting = pipeline->emitting,
                              .joined = sides_joined, .joined_context = &joined };
    do {
        pipeline->patches = patches_create(pipeline->surfaces, &po, &session->monitor, err);
    } while (pipeline->patches == NULL && pipeline_hurry(pipeline, err));
    if (pipeline->patches == NULL)
        return false;
    pipeline_room(pipeline);
    pipeline_stochastic_choose(pipeline, pipeline->patches->count);
    pipeline->room.mirrors = light_goes_on(pipeline);
    warn_glass(pipeline);
    pipeline_note(pipeline, STAGE_MESH, begin);
    if (pipeline->patches->count == 0)
        return error_set(err, ERROR_INPUT, "%s: no side of any surface can be reached by light "
                         "or eye; try --sides front", session->options.scene);
    return pipeline_fits(pipeline, 0, session->options.scene, err);
}

/* --- solve ------------------------------------------------------------------------------------ */

bool pipeline_problem(Pipeline *pipeline, Error *err)
{
    const Patches *patches = pipeline->patches;
    const size_t n = (size_t)patches->count * ROOM_BANDS;
    pipeline->emission = array_create(n, sizeof(double), "emission", err);
    pipeline->reflectance = array_create(n, sizeof(double), "reflectance", err);
    if (pipeline->emission == NULL || pipeline->reflectance == NULL)
        return false;
    for (uint32_t i = 0; i < patches->count; i++) {
        Rgb e, rho;
        mirrors_problem(&pipeline->room, i, &e, &rho);
        memcpy(pipeline->emission + ROOM_BANDS * i, (double[]){ e.r, e.g, e.b },
               sizeof(double[ROOM_BANDS]));
        memcpy(pipeline->reflectance + ROOM_BANDS * i, (double[]){ rho.r, rho.g, rho.b },
               sizeof(double[ROOM_BANDS]));
    }
    pipeline->problem = (SolveProblem){ .bands = ROOM_BANDS, .emission = pipeline->emission,
                                        .reflectance = pipeline->reflectance,
                                        .received = pipeline->direct.irradiance };
    return true;
}

void pipeline_energy(Pipeline *pipeline)
{
    const Rgb flux = pipeline->direct.flux, away = pipeline->direct.escaped;
    const double sent[ROOM_BANDS] = { flux.r, flux.g, flux.b };
    const double gone[ROOM_BANDS] = { away.r, away.g, away.b };
    const double square = pipeline->session->options.unit_m * pipeline->session->options.unit_m;
    for (unsigned band = 0; band < ROOM_BANDS; band++) {
        Energy *e = &pipeline->energy[band];
        solution_energy(pipeline->solution, pipeline->links, &pipeline->problem, band, sent[band],
                        gone[band], e);
        if (pipeline->session->settings.stochastic) {
            /* What rays counted, not what the escaped shares of patches say. */
            e->escaped = gone[band] + (pipeline->session->settings.clusters
                                           ? pipeline->clusters.escaped[band]
                                           : pipeline->stochastic.escaped[band]);
            e->error = e->emitted > 0
                           ? fabs(e->emitted - e->absorbed - e->escaped) / e->emitted : 0;
        }
        e->emitted *= square;
        e->absorbed *= square;
        e->escaped *= square;
    }
}

static bool run_solver(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    Trace trace;
    if (!trace_begin(&trace, session->options.trace, pipeline->links->rays, err))
        return false;
    const SolveOptions so = { .solver = settings->solver, .tolerance = settings->tolerance,
                              .max_iterations = settings->max_iterations,
                              .threads = settings->threads, .trace_user = &trace,
                              .centre = pipeline->patches->centre,
                              .normal = pipeline->patches->normal,
                              .bound = true, .relaxation = session->options.relaxation,
                              .overshoot = session->options.overshoot,
                              .no_ambient = session->options.no_ambient,
                              .trace = trace.file != NULL ? trace_step : NULL };
    pipeline->solution = solve(pipeline->links, &pipeline->problem, &so, &session->monitor, err);
    return trace_finish(&trace, err) && pipeline->solution != NULL && !session->broken;
}

bool pipeline_light(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    assert(pipeline->links != NULL);
    pipeline_begin(pipeline, STAGE_SOLVE);
    const DirectOptions direct = { .seed = settings->seed, .threads = settings->threads,
                                   .samples = settings->stochastic ? STOCHASTIC_LIGHT_SAMPLES : 0,
                                   .balance = settings->closure != CLOSURE_NONE };
    bool lit;
    do {
        lit = direct_create(&pipeline->room, pipeline->links, &direct, &pipeline->direct,
                            &session->monitor, err);
    } while (!lit && pipeline_hurry(pipeline, err));
    return lit && pipeline_problem(pipeline, err);
}

bool pipeline_solve(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const double begin = progress_now();
    const bool solved = pipeline->solution != NULL; /* by an earlier run */
    if (!pipeline_light(pipeline, err))
        return false;
    /* Of a change that is no dimmer an earlier run has kept the groups after it. */
    const bool groups = session->options.light_groups && !(solved && !changes_dim(pipeline));
    if (groups && !pipeline_light_groups(pipeline, err))
        return false;
    if (!solved && !(session->settings.clusters     ? pipeline_clusters_solve(pipeline, err)
                     : session->settings.stochastic ? pipeline_stochastic_solve(pipeline, err)
                                                    : run_solver(pipeline, err)))
        return false;
    if (pipeline->changes.count > 0 && !pipeline_relight(pipeline, solved, err))
        return false;
    saving_state(pipeline->saving, SAVING_SOLUTION);
    pipeline_energy(pipeline);
    pipeline_note(pipeline, STAGE_SOLVE, begin);
    return pipeline_fits(pipeline, 0, session->options.scene, err);
}

int pipeline_exit_code(const Pipeline *pipeline)
{
    const Closure closure = pipeline->session->settings.closure;
    /* Closing by default is a help, and warns when it fails; asked for, it is a promise. */
    const bool promised = options_given(&pipeline->session->options, OPTION_CLOSURE);
    const bool rows = closure == CLOSURE_ROWS || closure == CLOSURE_BOTH;
    const bool pairs = closure == CLOSURE_RECIPROCITY || closure == CLOSURE_BOTH;
    const bool unsolved = pipeline->solution != NULL && !pipeline->solution->converged;
    if (pipeline->session->hurry || (unsolved && session_stopped(pipeline->session)))
        return ERROR_STOPPED;
    const bool open = (rows && pipeline->report.row_sum_error_max > CLOSURE_TOLERANCE) ||
                      (pairs && pipeline->report.reciprocity_error_max > CLOSURE_TOLERANCE);
    const GroupFactors *groups = pipeline->groups;
    const bool rough = groups != NULL && groups->reached > groups->asked &&
                       options_given(&pipeline->session->options, OPTION_ACCURACY);
    const LightAccuracy *light = &pipeline->accuracy;
    const bool dim = light->asked > 0 && (light->reached > light->asked ||
                                          light->points > light->asked);
    const bool noisy = options_given(&pipeline->session->options, OPTION_ERROR) &&
                       pipeline->render.error > pipeline->session->options.error;
    return unsolved || rough || noisy || dim || (promised && open) ? 4 : 0;
}

void pipeline_clear(Pipeline *pipeline)
{
    array_free(pipeline->view);
    array_free(pipeline->picture);
    solution_destroy(pipeline->solution);
    changes_clear(&pipeline->changes);
    relit_clear(&pipeline->relit);
    array_free(pipeline->emission);
    array_free(pipeline->reflectance);
    array_free(pipeline->direct.irradiance);
    if (pipeline->places.links == NULL)
        links_destroy(pipeline->links);
    open_places_clear(&pipeline->places);
    links_destroy(pipeline->raw_links);
    group_factors_destroy(pipeline->groups);
    array_free(pipeline->group_class);
    patches_destroy(pipeline->patches);
    array_free(pipeline->sides);
    array_free(pipeline->emitting);
    array_free(pipeline->skin);
    bvh_destroy(pipeline->bvh);
    surfaces_destroy(pipeline->surfaces);
    scene_destroy(pipeline->scene);
    defects_clear(&pipeline->defects);
    *pipeline = (Pipeline){ .session = pipeline->session };
}
