/* SPDX-License-Identifier: BSD-3-Clause */
/* What was done to faces that touch: counted, listed, told. */
#include <assert.h>
#include <math.h>

#include "inspect/imprint_internal.h"

static uint32_t material_of(const ImprintParts *parts, uint32_t face)
{
    return parts->soup->material[face];
}

/* Whether a face that is gone lies exactly on the one it is under. */
static bool is_exact(const ImprintParts *parts, uint32_t face, uint32_t under)
{
    const uint32_t first = parts->first[face];
    const ImprintPart *other = &parts->part[under];
    return parts->first[face + 1] == first + 1
        && parts->first[other->face + 1] == parts->first[other->face] + 1
        && imprint_same_outline(parts, &parts->part[first], other);
}

static bool report_covered(ImprintReport *report, const ImprintParts *parts, uint32_t face,
                           const ImprintFate *fate, bool whole, Imprint *out, Error *err)
{
    const uint32_t cover = parts->part[fate->cover].face;
    const bool exact = whole && is_exact(parts, face, fate->cover);
    const bool other = material_of(parts, face) != material_of(parts, cover);
    if (exact && other && out->replaced++ == 0) {
        report->first_exact = face;
        report->other_exact = cover;
    }
    if (!(exact && other) && fate->overlapped && out->overlapped++ == 0) {
        report->first = face;
        report->other = cover;
    }
    out->covered++;
    out->covered_area += fate->covered_area;
    return exact || defects_add(report->defects, &(Defect){
        .kind = whole ? DEFECT_COVERED : DEFECT_COVERED_PART, .repaired = true, .face = face,
        .other = cover, .at = fate->covered_at, .measure = fate->covered_area }, err);
}

bool imprint_report(ImprintReport *report, const ImprintParts *parts, uint32_t face,
                    const ImprintFate *fate, uint32_t pieces, Imprint *out, Error *err)
{
    assert(report != NULL && fate != NULL && face < parts->soup->polygon_count);
    out->cut += pieces > 1;
    if (fate->covered)
        return report_covered(report, parts, face, fate, pieces == 0, out, err);
    return !fate->cut || defects_add(report->defects, &(Defect){
        .kind = DEFECT_CUT, .repaired = true, .face = face, .other = fate->by, .at = fate->cut_at,
        .measure = pieces }, err);
}

bool imprint_report_left(ImprintReport *report, const ImprintParts *parts, uint32_t part,
                         const ImprintContacts *contacts, Imprint *out, Error *err)
{
    const ImprintLine *line = contacts->inner > 0 ? &contacts->line[0] : NULL;
    assert(report != NULL && (line != NULL || contacts->cover_count > 0));
    out->left++;
    return defects_add(report->defects, &(Defect){
        .kind = DEFECT_CONTACT_LEFT, .face = parts->part[part].face,
        .other = line != NULL ? line->face : parts->part[contacts->cover[0]].face,
        .at = line != NULL ? vec3_lerp(line->end[0], line->end[1], 0.5)
                           : imprint_corner(parts, &parts->part[part], 0) }, err);
}

static const char *material_name(const Polygons *soup, uint32_t face)
{
    return soup->materials[soup->material[face]].name;
}

void imprint_tell(const ImprintReport *report, const Polygons *soup, const Imprint *out,
                  const Monitor *monitor)
{
    const char *group;
    if (out->overlapped > 0) {
        group = soup->group_name[soup->group[report->first]];
        monitor_warn(monitor, "covered", group,
                     "%u faces lie under others in their own plane; that part of them was left "
                     "out; the first is face %u of the file, in group \"%s\": \"%s\" under \"%s\"",
                     out->overlapped, report->first + 1, group,
                     material_name(soup, report->first), material_name(soup, report->other));
    }
    if (out->replaced > 0) {
        group = soup->group_name[soup->group[report->first_exact]];
        monitor_warn(monitor, "material-dropped", group,
                     "%u faces lie exactly on others of another material and were left out; what "
                     "gives light stays, else the first of the file: of face %u, in group \"%s\", "
                     "\"%s\" goes and \"%s\" stays", out->replaced, report->first_exact + 1, group,
                     material_name(soup, report->first_exact),
                     material_name(soup, report->other_exact));
    }
    if (out->left > 0)
        monitor_warn(monitor, "contacts-left", "",
                     "so many faces touch that %u of them were not cut where others stand on them; "
                     "their patches may let light through", out->left);
}
