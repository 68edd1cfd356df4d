/* SPDX-License-Identifier: BSD-3-Clause */
/* The summary: keys as the documentation lists them. */
#include "app/summary.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "app/pipeline_check.h"
#include "app/pipeline_clusters.h"
#include "base/file.h"

/* --- JSON ------------------------------------------------------------------------------------- */

static void put_scene(Json *json, const Pipeline *pipeline)
{
    const Scene *scene = pipeline->scene;
    const Polygons *soup = &scene->polygons;
    uint64_t triangles = 0, emitters = scene->light_count;
    Vec3 lo = { 0 }, hi = { 0 };
    for (size_t i = 0; i < soup->polygon_count; i++)
        triangles += soup->first[i + 1] - soup->first[i] - 2;
    for (size_t i = 0; i < soup->material_count; i++)
        emitters += rgb_max(soup->materials[i].emission) > 0;
    json_open(json, "scene", '{');
    json_text(json, "file", scene->file);
    json_count(json, "triangles", triangles);
    json_count(json, "placed_meshes", scene->placement_count);
    json_count(json, "triangles_in_all", scene_triangles(scene));
    json_count(json, "polygons", soup->polygon_count);
    json_count(json, "shapes", soup->shape_count);
    json_count(json, "groups", soup->group_count);
    json_count(json, "materials", soup->material_count);
    json_count(json, "emitters", emitters);
    json_count(json, "lights", scene->light_count);
    json_count(json, "cameras", scene->camera_count);
    if (polygons_bounds(soup, &lo, &hi)) {
        lo = scene_to_file(scene, lo);
        hi = scene_to_file(scene, hi);
        json_open(json, "bounds", '[');
        json_numbers(json, NULL, (double[]){ lo.x, lo.y, lo.z }, 3);
        json_numbers(json, NULL, (double[]){ hi.x, hi.y, hi.z }, 3);
        json_close(json, ']');
    }
    json_close(json, '}');
}

static void put_adapt(Json *json, const AdaptReport *adapt)
{
    json_open(json, "adapt", '{');
    json_count(json, "passes", adapt->passes);
    json_open(json, "patches", '[');
    for (unsigned k = 0; k <= adapt->passes; k++)
        json_count(json, NULL, adapt->patches[k]);
    json_close(json, ']');
    json_numbers(json, "error", adapt->error, adapt->passes);
    json_number(json, "seconds", adapt->seconds);
    json_bool(json, "stopped", adapt->stopped);
    json_close(json, '}');
}

static void put_mesh(Json *json, const Pipeline *pipeline)
{
    const Surfaces *s = pipeline->surfaces;
    const Patches *patches = pipeline->patches;
    double area = 0;
    for (uint32_t i = 0; i < s->count; i++)
        area += s->surface[i].area;
    json_open(json, "mesh", '{');
    json_count(json, "surfaces", s->count);
    if (patches != NULL)
        json_count(json, "patches", patches->count);
    json_count(json, "vertices", patches != NULL ? patches->vertex_count : s->vertex_count);
    json_number(json, "area", area);
    json_bool(json, "closed", s->closed);
    if (patches != NULL)
        json_number(json, "patch_size", patches->size);
    if (pipeline->adapt.patches[0] > 0)
        put_adapt(json, &pipeline->adapt);
    json_open(json, "repaired", '{');
    json_count(json, "welded", s->repairs.welded);
    json_count(json, "duplicate", s->repairs.duplicate);
    json_count(json, "degenerate", s->repairs.degenerate);
    json_count(json, "nonmanifold", s->repairs.nonmanifold);
    json_count(json, "flipped", s->repairs.flipped);
    json_count(json, "stitched", s->repairs.stitched);
    json_count(json, "cut", pipeline->cuts.cut);
    json_count(json, "covered", pipeline->cuts.covered);
    json_number(json, "covered_area", pipeline->cuts.area);
    json_count(json, "refused", s->repairs.refused);
    json_close(json, '}');
    if (pipeline->sides != NULL) {
        const SidesReport *sides = &pipeline->sides_report;
        json_open(json, "sides", '{');
        json_count(json, "front", sides->front);
        json_count(json, "back", sides->back);
        json_count(json, "both", sides->both);
        json_count(json, "none", sides->none);
        json_count(json, "lamps_turned", sides->lamps_turned);
        json_close(json, '}');
    }
    json_close(json, '}');
}

static void put_bvh(Json *json, const Pipeline *pipeline)
{
    BvhStats stats;
    bvh_stats(pipeline->bvh, &stats);
    json_open(json, "bvh", '{');
    json_count(json, "triangles", stats.triangles);
    json_count(json, "shapes", stats.shapes);
    json_count(json, "nodes", stats.nodes);
    json_count(json, "bytes", stats.bytes);
    json_number(json, "seconds", stats.seconds);
    json_close(json, '}');
}

static void put_errors(Json *json, const LinksReport *report)
{
    json_number(json, "row_sum_error_max", report->row_sum_error_max);
    json_number(json, "row_sum_error_rms", report->row_sum_error_rms);
    json_number(json, "reciprocity_error_max", report->reciprocity_error_max);
    json_number(json, "reciprocity_error_rms", report->reciprocity_error_rms);
}

/* How pairs of sides were estimated, and what was reached. */
static void put_groups(Json *json, const GroupFactors *groups)
{
    static const char *const kinds[GROUP_KINDS] = { "away", "exact", "clipped", "rays" };
    json_open(json, "estimators", '{');
    for (int k = 0; k < GROUP_KINDS; k++)
        json_count(json, kinds[k], groups->pairs[k]);
    json_close(json, '}');
    json_count(json, "points", groups->points);
    json_number(json, "accuracy_asked", groups->asked);
    json_number(json, "accuracy_reached", groups->reached);
    json_open(json, "standard_errors", '[');
    for (uint32_t i = 0; i < groups->count; i++) {
        if (!(groups->area[i] > 0))
            continue; /* has no row in the matrix either */
        json_open(json, NULL, '[');
        for (uint32_t j = 0; j < groups->count; j++)
            if (groups->area[j] > 0)
                json_number(json, NULL, group_factor_error(groups, i, j));
        json_close(json, ']');
    }
    json_close(json, ']');
}

/* What enforcing changed, and how the factors are stored. */
static void put_enforced(Json *json, const Pipeline *pipeline)
{
    const LinksChange *change = &pipeline->change;
    json_number(json, "cast_seconds", pipeline->factors_seconds);
    json_number(json, "closure_seconds", pipeline->closure_seconds);
    json_open(json, "change", '{');
    json_number(json, "largest", change->largest);
    json_number(json, "before", change->before);
    json_number(json, "after", change->after);
    json_count(json, "row", change->row);
    json_count(json, "column", change->column);
    json_number(json, "escaped", change->escape);
    json_close(json, '}');
    json_open(json, "storage", '{');
    json_count(json, "bits", pipeline->links->packed != NULL ? 16 : 32);
    json_number(json, "rounding", pipeline->rounding);
    json_count(json, "file_bytes", pipeline->links->mapped);
    json_close(json, '}');
    if (pipeline->session->options.factors != NULL) {
        json_open(json, "file", '{');
        json_text(json, "name", pipeline->session->options.factors);
        json_bool(json, "read", pipeline->factors_loaded);
        json_close(json, '}');
    }
}

static void put_factors(Json *json, const Pipeline *pipeline)
{
    static const char *const closures[] = { "none", "rows", "reciprocity", "both" };
    const LinksReport *report = &pipeline->report;
    const double seconds = pipeline->factors_seconds;
    json_open(json, "factors", '{');
    json_count(json, "rays", pipeline->links->rays);
    json_count(json, "nonzeros", report->nonzeros);
    json_count(json, "bytes", report->bytes);
    json_number(json, "seconds", pipeline->seconds[STAGE_FACTORS]);
    json_number(json, "rays_per_second",
                seconds > 0 ? (double)pipeline->links->rays / seconds : NAN);
    json_text(json, "closure", closures[pipeline->session->settings.closure]);
    put_errors(json, report);
    json_number(json, "escaped", report->escaped);
    json_open(json, "raw", '{');
    put_errors(json, &pipeline->raw);
    json_number(json, "escaped", pipeline->raw.escaped);
    json_count(json, "nonzeros", pipeline->raw.nonzeros);
    json_close(json, '}');
    put_enforced(json, pipeline);
    if (pipeline->groups != NULL)
        put_groups(json, pipeline->groups);
    json_close(json, '}');
}

static void put_clusters(Json *json, const ClustersReport *r)
{
    json_number(json, "estimated_error", r->error);
    json_count(json, "rays", r->rays);
    json_count(json, "links", r->links);
    json_count(json, "nodes", r->nodes);
    json_count(json, "rounds", r->rounds);
    json_count(json, "bytes", r->bytes);
    json_number(json, "rows_lacked", r->rows);
    if (r->gathered) {
        json_count(json, "gather_rays", r->gather_rays);
        json_count(json, "gathered_patches", r->gathered_patches);
        json_number(json, "noise", r->noise);
        json_numbers(json, "balance_scale", r->scale, ROOM_BANDS);
        json_count(json, "groups", r->groups);
    }
    if (r->guided) {
        json_numbers(json, "camera_by_light", r->response, ROOM_BANDS);
        json_numbers(json, "camera_by_importance", r->adjoint, ROOM_BANDS);
    }
}

static void put_solve(Json *json, const Pipeline *pipeline)
{
    const Solution *solution = pipeline->solution;
    double v[4][ROOM_BANDS];
    json_open(json, "solve", '{');
    const bool stochastic = pipeline->session->settings.stochastic;
    const bool clusters = pipeline->session->settings.clusters;
    json_text(json, "solver", stochastic && !clusters
                                  ? "stochastic" : solver_name(pipeline->session->settings.solver));
    json_count(json, "iterations", solution->iterations);
    json_number(json, "residual", solution->residual);
    json_number(json, "unshot", solution->unshot);
    json_number(json, "error_bound", solution->error_bound);
    if (clusters)
        put_clusters(json, &pipeline->clusters);
    else if (stochastic) {
        json_number(json, "estimated_error", pipeline->stochastic.error);
        json_numbers(json, "balance_scale", pipeline->stochastic.scale, ROOM_BANDS);
        json_count(json, "rays", pipeline->stochastic.rays);
        json_count(json, "groups", pipeline->stochastic.groups);
    }
    json_bool(json, "converged", solution->converged);
    json_number(json, "seconds", pipeline->seconds[STAGE_SOLVE]);
    json_close(json, '}');
    for (int band = 0; band < ROOM_BANDS; band++) {
        v[0][band] = pipeline->energy[band].emitted;
        v[1][band] = pipeline->energy[band].absorbed;
        v[2][band] = pipeline->energy[band].escaped;
        v[3][band] = pipeline->energy[band].error;
    }
    json_open(json, "energy", '{');
    json_numbers(json, "emitted", v[0], ROOM_BANDS);
    json_numbers(json, "absorbed", v[1], ROOM_BANDS);
    json_numbers(json, "escaped", v[2], ROOM_BANDS);
    json_numbers(json, "balance_error", v[3], ROOM_BANDS);
    json_text(json, "unit", pipeline->session->options.units == UNITS_PHOTOMETRIC ? "lm" : "W");
    json_close(json, '}');
}

static void put_accuracy(Json *json, const LightAccuracy *a)
{
    if (!(a->asked > 0))
        return;
    json_open(json, "accuracy", '{');
    json_number(json, "asked", a->asked);
    json_number(json, "reached", a->reached);
    if (a->rays > 0)
        json_count(json, "rays", a->rays);
    if (a->point_rays > 0) {
        json_number(json, "points_reached", a->points);
        json_count(json, "point_rays", a->point_rays);
    }
    json_close(json, '}');
}

static void put_relit(Json *json, const Pipeline *pipeline)
{
    const Relit *relit = &pipeline->relit;
    if (relit->groups != NULL) {
        json_open(json, "light_groups", '{');
        json_open(json, "names", '[');
        for (uint32_t k = 0; k < relit->group_count; k++)
            json_text(json, NULL, relit->name[k]);
        json_close(json, ']');
        json_count(json, "iterations", relit->groups->iterations);
        json_number(json, "seconds", relit->groups_seconds);
        json_close(json, '}');
    }
    if (pipeline->changes.count == 0)
        return;
    json_open(json, "relight", '{');
    json_count(json, "changes", pipeline->changes.count);
    json_text(json, "way", relit->mixed ? "mixed" : "solved");
    json_count(json, "iterations", relit->mixed ? 0 : pipeline->solution->iterations);
    json_number(json, "seconds", relit->seconds);
    json_number(json, "cpu_seconds", relit->cpu_seconds);
    json_close(json, '}');
}

static void put_pictures(Json *json, const Pipeline *pipeline)
{
    json_open(json, "pictures", '[');
    for (uint32_t k = 0; k < pipeline->picture_count; k++) {
        const PictureReport *p = &pipeline->picture[k];
        json_open(json, NULL, '{');
        json_text(json, "camera", p->camera);
        json_text(json, "exr", p->exr);
        json_text(json, "png", p->png);
        if (p->values[0] != '\0')
            json_text(json, "false_colour", p->values);
        json_bool(json, "made", p->made);
        if (p->made) {
            json_count(json, "width", (uint64_t)p->width);
            json_count(json, "height", (uint64_t)p->height);
            json_number(json, "samples_per_pixel", p->samples);
            if (p->error != 0)
                json_number(json, "standard_error", p->error);
            json_count(json, "rays", p->rays);
            json_number(json, "seconds", p->seconds);
            json_number(json, "exposure", p->exposure);
        }
        json_close(json, '}');
    }
    json_close(json, ']');
}

static void put_render(Json *json, const Pipeline *pipeline)
{
    const Settings *settings = &pipeline->session->settings;
    json_open(json, "render", '{');
    json_count(json, "width", (uint64_t)pipeline->width);
    json_count(json, "height", (uint64_t)pipeline->height);
    if (pipeline->session->options.renderer == RENDERER_PATH) {
        json_text(json, "renderer", "path");
        json_number(json, "samples_per_pixel", pipeline->path.samples);
        json_number(json, "standard_error", pipeline->path.error);
    } else {
        const bool plain = pipeline->session->options.renderer == RENDERER_WHITTED;
        json_text(json, "renderer", plain ? "whitted" : "gather");
        json_number(json, "samples_per_pixel", pipeline->render.samples);
        json_count(json, "gather_rays", settings->gather_rays);
        json_count(json, "record_rays", settings->record_rays);
        if (settings->error > 0) {
            json_number(json, "error_asked", settings->error);
            json_number(json, "standard_error", pipeline->render.error);
            json_number(json, "records_error", pipeline->render.records_error);
        }
    }
    json_count(json, "rays", pipeline->render.rays);
    json_number(json, "seconds", pipeline->render.seconds);
    json_number(json, "exposure", pipeline->exposure);
    if (pipeline->moments > 0) {
        json_numbers(json, "shutter", pipeline->session->options.shutter, 2);
        json_count(json, "time_samples", pipeline->moments);
        json_count(json, "solutions", pipeline->solutions);
    }
    if (pipeline->picture_count > 0)
        put_pictures(json, pipeline);
    json_close(json, '}');
}

static void put_seconds(Json *json, const Pipeline *pipeline)
{
    json_open(json, "seconds", '{');
    json_number(json, "total", progress_now() - pipeline->session->printer.start);
    for (Stage stage = 0; stage < STAGE_COUNT; stage++)
        json_number(json, pipeline_stage_name(stage), pipeline->seconds[stage]);
    json_close(json, '}');
}

void summary_pipeline(Json *json, const Pipeline *pipeline)
{
    assert(json->depth == 1);
    if (pipeline->scene != NULL)
        put_scene(json, pipeline);
    if (pipeline->surfaces != NULL)
        put_mesh(json, pipeline);
    if (pipeline->bvh != NULL)
        put_bvh(json, pipeline);
    if (pipeline->links != NULL && !pipeline->session->settings.stochastic)
        put_factors(json, pipeline);
    if (pipeline->solution != NULL)
        put_solve(json, pipeline);
    if (pipeline->solution != NULL)
        put_relit(json, pipeline);
    put_accuracy(json, &pipeline->accuracy);
    pipeline_check_put(json, &pipeline->check);
    if (pipeline->width > 0)
        put_render(json, pipeline);
    put_seconds(json, pipeline);
}

bool summary_begin(Summary *summary, const Session *session, int exit_code, const Error *failure,
                   Error *err)
{
    *summary = (Summary){ 0 };
    if (session->options.json == NULL)
        return true;
    summary->file = outfile_open(session->options.json, err);
    if (summary->file == NULL)
        return false;
    summary->json = (Json){ .out = outfile_stream(summary->file) };
    Json *json = &summary->json;
    json_open(json, NULL, '{');
    json_count(json, "schema", 1);
    json_text(json, "program", "isolux");
    json_text(json, "version", ISOLUX_VERSION);
    json_text(json, "command", command_name(session->options.command));
    json_count(json, "exit", (uint64_t)exit_code);
    if (failure != NULL && error_is_set(failure))
        json_text(json, "error", failure->text);
    return true;
}

bool summary_finish(Summary *summary, const Session *session, Error *err)
{
    if (summary->file == NULL)
        return true;
    Json *json = &summary->json;
    json_open(json, "memory", '{');
    json_count(json, "peak_bytes", progress_peak_bytes());
    json_close(json, '}');
    json_open(json, "warnings", '[');
    for (size_t i = 0; i < session->warning_count; i++) {
        json_open(json, NULL, '{');
        json_text(json, "code", session->warnings[i].code);
        json_text(json, "where", session->warnings[i].where);
        json_text(json, "text", session->warnings[i].text);
        json_close(json, '}');
    }
    json_close(json, ']');
    json_close(json, '}');
    if (json->failed)
        error_set(err, ERROR_MEMORY, "%s: the summary does not fit into memory",
                  session->options.json);
    return outfile_commit(summary->file, err);
}

bool summary_write(const Pipeline *pipeline, int exit_code, const Error *failure, Error *err)
{
    Summary summary;
    if (!summary_begin(&summary, pipeline->session, exit_code, failure, err))
        return false;
    if (summary.file != NULL)
        summary_pipeline(&summary.json, pipeline);
    return summary_finish(&summary, pipeline->session, err);
}

/* --- for people ------------------------------------------------------------------------------- */

static void print_stochastic(const Pipeline *pipeline)
{
    const StochasticReport *r = &pipeline->stochastic;
    session_say(pipeline->session, "  solve    stochastic, %u batches, %.3g rays, %.2g unshot, "
                "irradiance off by %.2g %% (rms, estimated)%s, %.2f s",
                pipeline->solution->iterations, (double)r->rays, pipeline->solution->unshot,
                100 * r->error, pipeline->solution->converged ? "" : ": more --rays are needed",
                pipeline->seconds[STAGE_SOLVE]);
    session_say(pipeline->session, "           reflected light evened out over %u groups",
                r->groups);
}

static void print_accuracy(const Pipeline *pipeline)
{
    const LightAccuracy *a = &pipeline->accuracy;
    if (!(a->asked > 0) || a->rays == 0)
        return;
    session_say(pipeline->session, "  accuracy irradiance of patches known to %.3g (rms, relative) "
                "by %u rays each, %.3g was asked for%s", a->reached, a->rays, a->asked,
                a->reached <= a->asked ? "" : ": more --rays are needed");
    if (a->point_rays > 0)
        session_say(pipeline->session, "           that of points to %.3g by %u rays each%s",
                    a->points, a->point_rays,
                    a->points <= a->asked ? "" : ": more --gather-rays are needed");
}

static void print_light(const Pipeline *pipeline)
{
    const Energy *e = pipeline->energy;
    const char *unit = pipeline->session->options.units == UNITS_PHOTOMETRIC ? "lm" : "W";
    const Solution *solution = pipeline->solution;
    const Rgb emitted = rgb(e[0].emitted, e[1].emitted, e[2].emitted);
    const Rgb absorbed = rgb(e[0].absorbed, e[1].absorbed, e[2].absorbed);
    const Rgb escaped = rgb(e[0].escaped, e[1].escaped, e[2].escaped);
    char bound[48] = "";
    if (isfinite(solution->error_bound))
        snprintf(bound, sizeof bound, ", error below %.2g", solution->error_bound);
    if (pipeline->session->settings.clusters)
        pipeline_clusters_print(pipeline);
    else if (pipeline->session->settings.stochastic)
        print_stochastic(pipeline);
    else
        session_say(pipeline->session, "  solve    %s, %u iterations, residual %.2g%s%s, %.2f s",
                    solver_name(pipeline->session->settings.solver), solution->iterations,
                    solution->residual, solution->converged ? "" : " (tolerance missed)", bound,
                    pipeline->seconds[STAGE_SOLVE]);
    const Relit *relit = &pipeline->relit;
    if (relit->groups != NULL)
        session_say(pipeline->session, "  groups   %u solved apart, %.3f s", relit->group_count,
                    relit->groups_seconds);
    if (pipeline->changes.count > 0)
        session_say(pipeline->session, "  relight  %zu changes, %s, %.4f s",
                    pipeline->changes.count, relit->mixed ? "mixed from light groups"
                                                          : "solved again", relit->seconds);
    session_say(pipeline->session,
                "  energy   emitted %.5g %s, absorbed %.5g, escaped %.5g, balance error %.2g",
                rgb_luminance(emitted), unit, rgb_luminance(absorbed), rgb_luminance(escaped),
                fmax(e[0].error, fmax(e[1].error, e[2].error)));
    print_accuracy(pipeline);
    pipeline_check_print(pipeline);
}

static void print_groups(const Pipeline *pipeline)
{
    const GroupFactors *g = pipeline->groups;
    if (g == NULL)
        return;
    session_say(pipeline->session,
                "           pairs of faces: %" PRIu64 " exact, %" PRIu64 " clipped (%.3g points), %"
                PRIu64 " by rays", g->pairs[GROUP_EXACT], g->pairs[GROUP_CLIPPED],
                (double)g->points, g->pairs[GROUP_RAYS]);
    session_say(pipeline->session, "           largest standard error %.2g, %.2g was asked for%s",
                g->reached, g->asked, g->reached <= g->asked ? "" : ": more --rays are needed");
}

static void print_enforced(const Pipeline *pipeline)
{
    if (pipeline->session->settings.closure != CLOSURE_NONE)
        session_say(pipeline->session,
                    "           closure took %.2f s and changed factors by %.2g at most",
                    pipeline->closure_seconds, pipeline->change.largest);
    if (pipeline->links->packed != NULL)
        session_say(pipeline->session,
                    "           in 16 bits, rounded by %.2g of themselves at most",
                    pipeline->rounding);
}

static void print_pictures(const Pipeline *pipeline)
{
    for (uint32_t k = 0; k < pipeline->picture_count; k++) {
        const PictureReport *p = &pipeline->picture[k];
        if (p->made)
            session_say(pipeline->session, "  picture  %s: %d x %d, %.6g samples, %.3g rays, "
                        "exposure %+.2f, %.2f s", p->camera, p->width, p->height, p->samples,
                        (double)p->rays, p->exposure, p->seconds);
    }
}

void summary_print(const Pipeline *pipeline)
{
    Session *session = pipeline->session;
    if (pipeline->patches != NULL)
        session_say(session, "  mesh     %u surfaces, %u patches of at most %.4g, %.2f s",
                    pipeline->surfaces->count, pipeline->patches->count, pipeline->patches->size,
                    pipeline->seconds[STAGE_MESH] + pipeline->seconds[STAGE_BVH]);
    if (pipeline->links != NULL && session->settings.stochastic)
        session_say(session, "  places   judged by %.3g rays, %.2f s",
                    (double)pipeline->links->rays, pipeline->seconds[STAGE_FACTORS]);
    else if (pipeline->links != NULL) {
        const double seconds = pipeline->factors_seconds;
        const double rate = seconds > 0 ? 1e-6 * (double)pipeline->links->rays / seconds : 0;
        session_say(session, "  factors  %.3g rays%s, %.2f Mray/s, %.3g MB%s, %.2f s",
                    (double)pipeline->links->rays,
                    pipeline->factors_loaded ? " read from the file" : "", rate,
                    1e-6 * (double)pipeline->report.bytes,
                    pipeline->links->mapped > 0 ? " in a file" : "",
                    pipeline->seconds[STAGE_FACTORS]);
        session_say(session,
                    "           row sums off by %.2g at most (%.2g before closure), reciprocity "
                    "%.2g (%.2g), escaped %.3g",
                    pipeline->report.row_sum_error_max, pipeline->raw.row_sum_error_max,
                    pipeline->report.reciprocity_error_max, pipeline->raw.reciprocity_error_max,
                    pipeline->report.escaped);
        print_groups(pipeline);
        print_enforced(pipeline);
    }
    if (pipeline->solution != NULL)
        print_light(pipeline);
    if (pipeline->scene->placement_count > 0)
        session_say(session, "  placed   %zu times one of %zu meshes: %.6g triangles in all",
                    pipeline->scene->placement_count, pipeline->scene->prototype_count,
                    (double)scene_triangles(pipeline->scene));
    if (session->options.renderer == RENDERER_WHITTED && pipeline->width > 0)
        session_say(session, "  frame    %.1f ms, %.1f ms with reading, tree and sides",
                    1e3 * pipeline->render.seconds,
                    1e3 * (pipeline->seconds[STAGE_READ] + pipeline->seconds[STAGE_MESH] +
                           pipeline->seconds[STAGE_BVH] + pipeline->seconds[STAGE_GATHER]));
    if (pipeline->path.samples > 0 && isnan(pipeline->path.error))
        session_say(session, "  paths    %.6g per pixel: too few to tell their error",
                    pipeline->path.samples);
    else if (pipeline->path.samples > 0)
        session_say(session, "  paths    %.6g per pixel, standard error %.3g %% (rms of pixels)",
                    pipeline->path.samples, 100 * pipeline->path.error);
    if (pipeline->moments > 0)
        session_say(session, "  shutter  %u moments, %u different in more than cameras",
                    pipeline->moments, pipeline->solutions);
    if (pipeline->picture_count > 1)
        print_pictures(pipeline);
    else if (pipeline->width > 0)
        session_say(session, "  picture  %d x %d, %.6g samples, %.3g rays, exposure %+.2f, %.2f s",
                    pipeline->width, pipeline->height,
                    pipeline->path.samples > 0 ? pipeline->path.samples : pipeline->render.samples,
                    (double)pipeline->render.rays, pipeline->exposure,
                    pipeline->seconds[STAGE_GATHER]);
    if (pipeline->render.error > 0)
        session_say(session, "  error    %.3g %% (standard error of pixels, root mean square)",
                    100 * pipeline->render.error);
    if (pipeline->render.records_error > 0)
        session_say(session, "           %.2g %% (light read from records, checked at some pixels)",
                    100 * pipeline->render.records_error);
    session_say(session, "  in all   %.2f s, %.0f MB",
                progress_now() - session->printer.start, 1e-6 * (double)progress_peak_bytes());
}
