/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux check: what is in a file, what is wrong with it, what was repaired. */
#include <stdarg.h>
#include <string.h>

#include "app/commands.h"

/* The report is the command's result: standard output has it, unless the JSON goes there. */
static void say(Session *session, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(Session *session, const char *format, ...)
{
    const bool taken = session->options.json != NULL && strcmp(session->options.json, "-") == 0;
    va_list arguments;
    if (taken && session->options.progress == PROGRESS_NONE)
        return;
    progress_clear(&session->printer);
    va_start(arguments, format);
    vfprintf(taken ? stderr : stdout, format, arguments);
    va_end(arguments);
    fputc('\n', taken ? stderr : stdout);
}

static void say_scene(Pipeline *pipeline)
{
    Session *session = pipeline->session;
    const Scene *scene = pipeline->scene;
    const Polygons *soup = &scene->polygons;
    Vec3 lo = { 0 }, hi = { 0 };
    size_t emitters = 0;
    for (size_t i = 0; i < soup->material_count; i++)
        emitters += rgb_max(soup->materials[i].emission) > 0;
    say(session, "isolux: %s", scene->file);
    say(session, "  polygons    %zu with %zu vertices; %zu curved faces",
                soup->polygon_count, soup->vertex_count, soup->shape_count);
    say(session, "  groups      %zu", soup->group_count);
    say(session, "  materials   %zu, %zu of them emit", soup->material_count, emitters);
    say(session, "  lights      %zu", scene->light_count);
    say(session, "  cameras     %zu", scene->camera_count);
    for (size_t i = 0; i < scene->camera_count; i++)
        say(session, "              '%s' at %.5g,%.5g,%.5g", scene->cameras[i].name,
                    scene->cameras[i].eye.x, scene->cameras[i].eye.y, scene->cameras[i].eye.z);
    if (polygons_bounds(soup, &lo, &hi))
        say(session, "  bounds      %.5g,%.5g,%.5g to %.5g,%.5g,%.5g: %.5g x %.5g x %.5g",
                    lo.x, lo.y, lo.z, hi.x, hi.y, hi.z, hi.x - lo.x, hi.y - lo.y, hi.z - lo.z);
}

static void say_count(Session *session, const char *what, uint32_t count)
{
    if (count > 0)
        say(session, "  %-11s %u", what, count);
}

static void say_mesh(Pipeline *pipeline)
{
    Session *session = pipeline->session;
    const Surfaces *s = pipeline->surfaces;
    const SidesReport *sides = &pipeline->sides_report;
    say(session, "  surfaces    %u, %s", s->count, s->closed ? "closed" : "open");
    say_count(session, "welded", s->repairs.welded);
    say_count(session, "duplicate", s->repairs.duplicate);
    say_count(session, "degenerate", s->repairs.degenerate);
    say_count(session, "nonmanifold", s->repairs.nonmanifold);
    say_count(session, "flipped", s->repairs.flipped);
    say_count(session, "refused", s->repairs.refused);
    say(session, "  sides used  front %u, back %u, both %u, none %u", sides->front,
                sides->back, sides->both, sides->none);
    say_count(session, "turned", sides->lamps_turned);
    say(session, "  warnings    %zu", session->warning_count);
}

bool cmd_check(Pipeline *pipeline, int *exit_code, Error *err)
{
    *exit_code = 0;
    if (!pipeline_read(pipeline, err) || !pipeline_mesh(pipeline, err) ||
        !pipeline_sides(pipeline, err))
        return false;
    if (!scene_has_light(pipeline->scene))
        monitor_warn(&pipeline->session->monitor, "no-emitter", pipeline->scene->file,
                     "nothing in the scene gives light");
    say_scene(pipeline);
    say_mesh(pipeline);
    return true;
}
