/* SPDX-License-Identifier: BSD-3-Clause */
/* The report of `isolux check` for people: what is in the file, the verdict, defects, places. */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "app/check.h"
#include "app/place.h"

/* The worst first: what lets light through or shows, then what was mended, then remarks. */
static const DefectKind order[DEFECT_KINDS] = {
    DEFECT_OPEN_EDGE,  DEFECT_INTERSECTION, DEFECT_OVERLAP,    DEFECT_INSIDE_SOLID,
    DEFECT_NONFINITE,  DEFECT_CROSSING,     DEFECT_NONPLANAR,  DEFECT_UNORIENTABLE,
    DEFECT_MATERIAL,   DEFECT_CONTACT_LEFT, DEFECT_WINDING,    DEFECT_NONMANIFOLD,
    DEFECT_T_JUNCTION, DEFECT_REFUSED,      DEFECT_DEGENERATE, DEFECT_DUPLICATE,
    DEFECT_COVERED,    DEFECT_COVERED_PART, DEFECT_CUT,        DEFECT_BACK_TO_BACK,
};

/* The report is the command's result: standard output has it, unless JSON or mesh go there. */
static FILE *report_stream(const Session *session)
{
    const char *json = session->options.json, *output = session->options.output;
    const bool  taken = (json != NULL && strcmp(json, "-") == 0) ||
                       (output != NULL && strcmp(output, "-") == 0);
    if (!taken)
        return stdout;
    return session->options.progress == PROGRESS_NONE ? NULL : stderr;
}

void check_say(const Check *check, const char *format, ...)
{
    Session *session = check->pipeline->session;
    FILE    *out = report_stream(session);
    va_list  arguments;
    if (out == NULL)
        return;
    progress_clear(&session->printer);
    va_start(arguments, format);
    vfprintf(out, format, arguments);
    va_end(arguments);
    fputc('\n', out);
}

/* --- what is in it ---------------------------------------------------------------------------- */

static void say_scene(const Check *check)
{
    const Scene    *scene = check->pipeline->scene;
    const Polygons *soup = &scene->polygons;
    Vec3   lo = { 0 }, hi = { 0 };
    char   low[PLACE_TEXT], high[PLACE_TEXT];
    size_t emitters = 0;
    for (size_t i = 0; i < soup->material_count; i++)
        emitters += rgb_max(soup->materials[i].emission) > 0;
    check_say(check, "isolux: %s", scene->file);
    check_say(check, "  polygons    %zu with %zu vertices; %zu curved faces", soup->polygon_count,
              soup->vertex_count, soup->shape_count);
    if (scene->placement_count > 0)
        check_say(check, "  placed      %zu times one of %zu meshes, not looked into: %.6g "
                  "triangles in all", scene->placement_count, scene->prototype_count,
                  (double)scene_triangles(scene));
    check_say(check, "  groups      %zu", soup->group_count);
    check_say(check, "  materials   %zu, %zu of them emit", soup->material_count, emitters);
    check_say(check, "  lights      %zu", scene->light_count);
    check_say(check, "  cameras     %zu", scene->camera_count);
    for (size_t i = 0; i < scene->camera_count; i++) {
        place_text(scene, scene->cameras[i].eye, CHECK_DIGITS, low);
        check_say(check, "              '%s' at %s", scene->cameras[i].name, low);
    }
    if (polygons_bounds(soup, &lo, &hi)) {
        place_text(scene, lo, CHECK_DIGITS, low);
        place_text(scene, hi, CHECK_DIGITS, high);
        check_say(check, "  bounds      %s to %s: %.5g x %.5g x %.5g", low, high, hi.x - lo.x,
                  hi.y - lo.y, hi.z - lo.z);
    }
}

/* --- verdict ---------------------------------------------------------------------------------- */

static void say_verdict(const Check *check)
{
    const Inspection *i = &check->inspection;
    char curved[80] = "";
    if (i->bordered > 0)
        snprintf(curved, sizeof curved, "%s%" PRIu64 " curved face%s with a border",
                 i->rims > 0 ? ", " : "", i->bordered, check_plural(i->bordered));
    if (i->rims > 0)
        check_say(check, "  open: %" PRIu64 " rim%s of %" PRIu64 " open edge%s%s", i->rims,
                  check_plural(i->rims), i->open_edges, check_plural(i->open_edges), curved);
    else if (i->bordered > 0)
        check_say(check, "  open: %s", curved);
    else
        check_say(check, "  closed: no edge is open");
}

static void say_winding(const Check *check)
{
    const Defects *d = &check->pipeline->defects;
    const uint64_t found = d->found[DEFECT_WINDING], turned = d->repaired[DEFECT_WINDING];
    const uint64_t bent = d->found[DEFECT_UNORIENTABLE];
    if (found == 0 && bent == 0)
        check_say(check, "  winding     consistent");
    else
        check_say(check, "  winding     %" PRIu64 " face%s against their neighbours, %" PRIu64
                  " turned to agree%s", found, check_plural(found), turned,
                  bent > 0 ? "; somewhere no winding agrees" : "");
}

/* Where all faces went, as a sum. */
static void say_faces(const Check *check)
{
    const FaceAccount *f = &check->faces;
    char   reasons[200] = "";
    size_t used = 0;
    for (int kind = 0; kind < DEFECT_KINDS; kind++)
        if (f->left[kind] > 0 && used < sizeof reasons)
            used += (size_t)snprintf(reasons + used, sizeof reasons - used, "%s%" PRIu64 " %s",
                                     used > 0 ? ", " : " (", f->left[kind],
                                     defect_name((DefectKind)kind));
    check_say(check, "  faces       %" PRIu64 " = %" PRIu64 " with patches + %" PRIu64
              " out of reach + %" PRIu64 " left out%s%s", f->input, f->patches, f->hidden,
              check_left_out(f), reasons, used > 0 ? ")" : "");
    if (f->lost > 0)
        check_say(check, "              and %" PRIu64 " LOST without a reason: please report this",
                  f->lost);
}

static void say_mesh(const Check *check)
{
    const Pipeline    *pipeline = check->pipeline;
    const Surfaces    *s = pipeline->surfaces;
    const SidesReport *sides = &pipeline->sides_report;
    const Inspection  *i = &check->inspection;
    say_verdict(check);
    say_winding(check);
    say_faces(check);
    check_say(check, "  parts       %u, %u of them closed", i->parts, i->closed_parts);
    check_say(check, "  surfaces    %u; %u vertices fell together with others", s->count,
              s->repairs.welded);
    check_say(check, "  sides used  front %u, back %u, both %u, none %u", sides->front, sides->back,
              sides->both, sides->none);
    if (sides->lamps_turned > 0)
        check_say(check, "  turned      %u", sides->lamps_turned);
}

static void say_units(const Check *check)
{
    const UnitGuess *u = &check->units;
    const double     unit = check->pipeline->session->options.unit_m;
    if (!u->suspicious)
        return;
    check_say(check, "  units       suspicious: in units of %g m the scene's box is %.3g to %.3g m",
              unit, u->least, u->largest);
    if (!isnan(u->eye))
        check_say(check, "              and its camera %.3g m above the lowest point", u->eye);
    if (u->guess > 0)
        check_say(check, "              looks like %s: --unit-m %g", u->name, u->guess);
}

/* --- defects ---------------------------------------------------------------------------------- */

static void say_table(const Check *check)
{
    const Defects *d = &check->pipeline->defects;
    bool any = false;
    for (int k = 0; k < DEFECT_KINDS; k++) {
        const DefectKind kind = order[k];
        if (d->found[kind] == 0)
            continue;
        if (!any)
            check_say(check, "\n  %-18s %9s %9s %9s", "defect", "found", "repaired", "left");
        any = true;
        check_say(check, "  %-18s %9" PRIu64 " %9" PRIu64 " %9" PRIu64, defect_name(kind),
                  d->found[kind], d->repaired[kind], d->found[kind] - d->repaired[kind]);
    }
    if (!any)
        check_say(check, "\n  no defects");
    if (check->inspection.hurried > 0)
        check_say(check, "  crossings: %u triangles meet too many others; not all are counted",
                  check->inspection.hurried);
    if (check->inspection.unplaced > 0)
        check_say(check, "  inside-solid: %u parts have too much around them to tell",
                  check->inspection.unplaced);
}

static bool any_defect(const Check *check)
{
    for (int k = 0; k < DEFECT_KINDS; k++)
        if (check->pipeline->defects.found[k] > 0)
            return true;
    return false;
}

void check_print(const Check *check)
{
    say_scene(check);
    say_mesh(check);
    say_units(check);
    say_table(check);
    if (any_defect(check))
        check_say(check, "\nfirst places, faces counted from 1 as in the file");
    for (int k = 0; k < DEFECT_KINDS; k++)
        if (order[k] == DEFECT_OPEN_EDGE)
            check_say_rims(check);
        else
            check_say_places(check, order[k]);
    check_say_materials(check);
    check_say(check, "  warnings    %zu", check->pipeline->session->warning_count);
}
