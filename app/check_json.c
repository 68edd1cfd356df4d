/* SPDX-License-Identifier: BSD-3-Clause */
/* The report of `isolux check` for scripts. */
#include <assert.h>
#include <string.h>

#include "app/check.h"

static void put_position(Json *json, const char *key, const Scene *scene, Vec3 p)
{
    const Vec3 q = scene_to_file(scene, p);
    json_numbers(json, key, (double[]){ q.x, q.y, q.z }, 3);
}

static void put_place(Json *json, const Scene *scene, const Defect *d)
{
    const Polygons *soup = &scene->polygons;
    json_open(json, NULL, '{');
    json_text(json, "group", check_group(soup, d->face));
    json_count(json, "face", (uint64_t)d->face + 1);
    put_position(json, "position", scene, d->at);
    if (d->other != DEFECT_NO_FACE) {
        json_text(json, "other_group", check_group(soup, d->other));
        json_count(json, "other", (uint64_t)d->other + 1);
    }
    json_number(json, "measure", d->measure);
    json_bool(json, "repaired", d->repaired);
    json_close(json, '}');
}

static void put_defects(Json *json, const Check *check)
{
    const Defects *list = &check->pipeline->defects;
    json_open(json, "defects", '{');
    for (int kind = 0; kind < DEFECT_KINDS; kind++) {
        json_open(json, defect_name((DefectKind)kind), '{');
        json_count(json, "found", list->found[kind]);
        json_count(json, "repaired", list->repaired[kind]);
        json_count(json, "left", list->found[kind] - list->repaired[kind]);
        json_open(json, "first", '[');
        for (size_t i = 0, told = 0; i < list->count && told < CHECK_PLACES_JSON; i++)
            if ((int)list->item[i].kind == kind) {
                put_place(json, check->pipeline->scene, &list->item[i]);
                told++;
            }
        json_close(json, ']');
        json_close(json, '}');
    }
    json_close(json, '}');
}

static void put_rims(Json *json, const Check *check)
{
    const Inspection *found = &check->inspection;
    const Polygons   *soup = &check->pipeline->scene->polygons;
    json_open(json, "rims", '{');
    json_count(json, "found", found->rims);
    json_count(json, "open_edges", found->open_edges);
    json_count(json, "curved_borders", found->bordered);
    json_open(json, "longest", '[');
    for (size_t i = 0; i < found->rim_count && i < CHECK_PLACES_JSON; i++) {
        const Rim *r = &found->rim[i];
        json_open(json, NULL, '{');
        json_text(json, "group", check_group(soup, r->face));
        json_count(json, "face", (uint64_t)r->face + 1);
        json_count(json, "edges", r->edges);
        json_number(json, "length", r->length);
        json_bool(json, "flat", r->flat);
        json_open(json, "bounds", '[');
        put_position(json, NULL, check->pipeline->scene, r->lo);
        put_position(json, NULL, check->pipeline->scene, r->hi);
        json_close(json, ']');
        json_close(json, '}');
    }
    json_close(json, ']');
    json_close(json, '}');
}

/* Surfaces of a part with that side in use. */
static uint64_t side_count(const Check *check, const Part *part, unsigned bit)
{
    const Surfaces *s = check->pipeline->surfaces;
    const uint32_t  number = s->part[part->first];
    uint64_t        count = 0;
    for (uint32_t i = 0; i < s->count; i++)
        count += s->part[i] == number && (check->pipeline->sides[i] & bit) != 0;
    return count;
}

static void put_part(Json *json, const Check *check, const Part *part)
{
    const Surfaces *s = check->pipeline->surfaces;
    const uint32_t  face = s->surface[part->first].face;
    json_open(json, NULL, '{');
    json_text(json, "group", check_group(&check->pipeline->scene->polygons, face));
    json_count(json, "face", (uint64_t)face + 1);
    json_count(json, "surfaces", part->surfaces);
    json_number(json, "area", part->area);
    json_bool(json, "closed", part->closed);
    json_bool(json, "reached", part->seen);
    json_number(json, "volume", part->volume);
    json_count(json, "fronts", side_count(check, part, 1));
    json_count(json, "backs", side_count(check, part, 2));
    json_open(json, "bounds", '[');
    put_position(json, NULL, check->pipeline->scene, part->lo);
    put_position(json, NULL, check->pipeline->scene, part->hi);
    json_close(json, ']');
    json_close(json, '}');
}

/* The parts of most area: each time the largest that is smaller than the last one told. */
static void put_parts(Json *json, const Check *check)
{
    const Inspection *found = &check->inspection;
    const Part       *last = NULL;
    json_open(json, "parts", '{');
    json_count(json, "found", found->parts);
    json_count(json, "closed", found->closed_parts);
    json_open(json, "largest", '[');
    for (int n = 0; n < CHECK_PLACES_JSON; n++) {
        const Part *best = NULL;
        for (uint32_t p = 0; p < found->parts; p++) {
            const Part *part = &found->part[p];
            const bool  after = last == NULL || part->area < last->area ||
                               (part->area <= last->area && part > last);
            if (after && (best == NULL || part->area > best->area))
                best = part;
        }
        if (best == NULL)
            break;
        put_part(json, check, best);
        last = best;
    }
    json_close(json, ']');
    json_close(json, '}');
}

static void put_faces(Json *json, const Check *check)
{
    const FaceAccount *f = &check->faces;
    json_open(json, "faces", '{');
    json_count(json, "input", f->input);
    json_count(json, "patches", f->patches);
    json_count(json, "out_of_reach", f->hidden);
    json_open(json, "left_out", '{');
    for (int kind = 0; kind < DEFECT_KINDS; kind++)
        if (f->left[kind] > 0)
            json_count(json, defect_name((DefectKind)kind), f->left[kind]);
    json_close(json, '}');
    json_count(json, "lost", f->lost);
    json_count(json, "without_material", f->plain);
    json_close(json, '}');
}

static void put_units(Json *json, const Check *check)
{
    const UnitGuess *u = &check->units;
    json_open(json, "units", '{');
    json_number(json, "unit_m", check->pipeline->session->options.unit_m);
    json_number(json, "least_m", u->least);
    json_number(json, "largest_m", u->largest);
    json_number(json, "eye_m", u->eye);
    json_bool(json, "suspicious", u->suspicious);
    if (u->guess > 0)
        json_number(json, "guess_m", u->guess);
    json_close(json, '}');
}

void check_json(Json *json, const Check *check)
{
    const Session *session = check->pipeline->session;
    assert(json->depth == 1);
    json_open(json, "check", '{');
    json_bool(json, "closed", check->inspection.rims == 0 && check->inspection.bordered == 0);
    json_number(json, "seconds", check->inspection.seconds);
    json_count(json, "triangles_cut_short", check->inspection.hurried);
    json_count(json, "parts_not_placed", check->inspection.unplaced);
    json_open(json, "missing_materials", '[');
    for (size_t i = 0; i < session->warning_count; i++)
        if (strcmp(session->warnings[i].code, "material-missing") == 0)
            json_text(json, NULL, session->warnings[i].text);
    json_close(json, ']');
    json_close(json, '}');
    put_faces(json, check);
    put_defects(json, check);
    put_rims(json, check);
    put_parts(json, check);
    put_units(json, check);
}
