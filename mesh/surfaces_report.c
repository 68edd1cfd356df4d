/* SPDX-License-Identifier: BSD-3-Clause */
/* What was found wrong while connecting: listed, counted, told. */
#include <assert.h>
#include <math.h>

#include "math/tolerance.h"
#include "mesh/internal.h"

static bool emits(const Polygons *soup, uint32_t face)
{
    const size_t shape = face - soup->polygon_count;
    const uint32_t material = face < soup->polygon_count ? soup->material[face]
                                                         : soup->shape[shape].material;
    return rgb_max(soup->materials[material].emission) > 0;
}

/* A face that was cut counts once, by its first piece. */
static void take_note(const Polygons *soup, Note *note, const Defect *defect)
{
    const bool known = soup->origin != NULL && defect->face < soup->polygon_count;
    const bool piece = known && defect->face >= soup->origin_first;
    if (piece || note->count++ > 0)
        return;
    note->first = known ? soup->origin[defect->face] : defect->face;
    note->face = defect->face;
    note->other = defect->other;
}

bool repair_report(Repair *repair, const Defect *defect)
{
    assert(repair != NULL && defect != NULL && defect->kind < DEFECT_KINDS);
    take_note(repair->soup, &repair->note[defect->kind][defect->repaired], defect);
    if ((defect->kind == DEFECT_DEGENERATE || defect->kind == DEFECT_NONFINITE)
        && emits(repair->soup, defect->face))
        take_note(repair->soup, &repair->lamp, defect);
    return defects_add(repair->defects, defect, repair->err);
}

bool repair_report_double(Repair *repair, uint32_t later, uint32_t first, bool merged, Vec3 at)
{
    const Polygons *soup = repair->soup;
    const bool swapped = emits(soup, later) && !emits(soup, first);
    Defect defect = { .kind = DEFECT_DUPLICATE, .repaired = merged,
                      .face = swapped ? first : later, .other = swapped ? later : first,
                      .at = at };
    repair_report(repair, &defect);
    defect.kind = DEFECT_MATERIAL;
    if (soup->material[later] != soup->material[first])
        repair_report(repair, &defect);
    return swapped;
}

double repair_reach(const Repair *repair, Vec3 p, Vec3 q)
{
    if (repair->options->weld > 0)
        return repair->options->weld;
    const Vec3 most = vec3_max(vec3_max(p, q), vec3_scale(vec3_min(p, q), -1));
    return polygons_tolerance(repair->soup, fmax(most.x, fmax(most.y, most.z)));
}

/* Which material went, and for which. */
static void tell_material(const Repair *repair, const Monitor *monitor)
{
    const Note *note = &repair->note[DEFECT_MATERIAL][true];
    const Polygons *soup = repair->soup;
    if (note->count == 0)
        return;
    const char *group = soup->group_name[soup->group[note->face]];
    monitor_warn(monitor, "material-dropped", group,
                 "%u faces lie exactly on others of another material and were left out; what gives "
                 "light stays, else the first of the file: of face %u, in group \"%s\", \"%s\" "
                 "goes and \"%s\" stays", note->count, note->first + 1, group,
                 soup->materials[soup->material[note->face]].name,
                 soup->materials[soup->material[note->other]].name);
}

/* Light that is lost, most often because the welding distance is larger than the lamp. */
static void tell_lamps(const Repair *repair, const Monitor *monitor)
{
    const Note *note = &repair->lamp;
    const Polygons *soup = repair->soup;
    if (note->count == 0)
        return;
    const bool polygon = note->face < soup->polygon_count;
    const size_t shape = polygon ? 0 : note->face - soup->polygon_count;
    const uint32_t group = polygon ? soup->group[note->face] : soup->shape[shape].group;
    monitor_warn(monitor, "lamp-lost", soup->group_name[group],
                 "%u faces that give light were left out: they have no area%s; the first is %s %zu "
                 "of the file, in group \"%s\"", note->count,
                 repair->options->weld > 0 ? " once corners nearer than --weld are one" : "",
                 polygon ? "face" : "curved face", polygon ? (size_t)note->first + 1 : shape + 1,
                 soup->group_name[group]);
}

void repair_tell(const Repair *repair, const Monitor *monitor)
{
    static const struct {
        DefectKind  kind;
        bool        repaired;
        const char *code, *text;
    } told[] = {
        { DEFECT_NONFINITE, false, "nonfinite",
          "faces have a corner that is not a finite number and were left out" },
        { DEFECT_DEGENERATE, true, "degenerate", "faces without area were left out" },
        { DEFECT_DUPLICATE, true, "duplicate",
          "faces lie exactly on another face and were left out" },
        { DEFECT_DUPLICATE, false, "duplicate", "faces lie exactly on another face" },
        { DEFECT_CROSSING, false, "polygon-crossing",
          "polygons have an outline that crosses itself; their filling is a guess" },
        /* Bodies that touch along an edge are common and come out right: listed, not told. */
        { DEFECT_NONMANIFOLD, false, "nonmanifold",
          "edges have more than two faces; these were not linked there" },
        { DEFECT_WINDING, true, "winding-repaired",
          "faces were wound against their neighbours and were turned round" },
        { DEFECT_WINDING, false, "winding-inconsistent",
          "faces are wound against their neighbours; fronts and backs are as in the file" },
        { DEFECT_REFUSED, false, "refused",
          "triangles did not fit into the half-edge mesh; they are kept, apart from it" },
    };
    const Polygons *soup = repair->soup;
    if (repair->many_junctions)
        monitor_warn(monitor, "junctions", "",
                     "too many edges lie on each other in one line: not all were stitched");
    tell_material(repair, monitor);
    tell_lamps(repair, monitor);
    for (size_t i = 0; i < sizeof told / sizeof *told; i++) {
        const Note *note = &repair->note[told[i].kind][told[i].repaired];
        if (note->count == 0)
            continue;
        const bool polygon = note->face < soup->polygon_count;
        const size_t shape = polygon ? 0 : note->face - soup->polygon_count;
        const uint32_t group = polygon ? soup->group[note->face] : soup->shape[shape].group;
        monitor_warn(monitor, told[i].code, soup->group_name[group],
                     "%u %s; the first is %s %zu of the file, in group \"%s\"", note->count,
                     told[i].text, polygon ? "face" : "curved face",
                     polygon ? (size_t)note->first + 1 : shape + 1, soup->group_name[group]);
    }
}
