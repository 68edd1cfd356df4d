/* SPDX-License-Identifier: BSD-3-Clause */
/* The report of `isolux check` for people: where defects are. */
#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "app/check.h"
#include "app/place.h"
#include "base/array.h"

/* What a kind's measure is; NULL: not worth telling. */
static const char *measure_word(DefectKind kind)
{
    switch (kind) {
    case DEFECT_OPEN_EDGE:    return "long";
    case DEFECT_INTERSECTION: return "deep";
    case DEFECT_OVERLAP:      return "wide";
    case DEFECT_INSIDE_SOLID: return "across";
    case DEFECT_NONPLANAR:    return "off its plane";
    case DEFECT_NONMANIFOLD:  return "faces";
    case DEFECT_COVERED:
    case DEFECT_COVERED_PART: return "left out";
    case DEFECT_CUT:          return "pieces";
    default:                  return NULL;
    }
}

static void name_face(const Polygons *soup, uint32_t face, char *out, size_t size)
{
    const bool   curved = face >= soup->polygon_count;
    const size_t number = curved ? face - soup->polygon_count + 1 : (size_t)face + 1;
    snprintf(out, size, "group '%.100s', %sface %zu", check_group(soup, face),
             curved ? "curved " : "", number);
}

static void say_place(const Check *check, const Defect *d)
{
    const Polygons *soup = &check->pipeline->scene->polygons;
    char first[160], other[180] = "", measure[64] = "", at[PLACE_TEXT];
    name_face(soup, d->face, first, sizeof first);
    if (d->other != DEFECT_NO_FACE) {
        memcpy(other, " and ", 6);
        name_face(soup, d->other, other + 5, sizeof other - 5);
    }
    if (d->measure > 0 && measure_word(d->kind) != NULL)
        snprintf(measure, sizeof measure, " (%.3g %s)", d->measure, measure_word(d->kind));
    place_text(check->pipeline->scene, d->at, CHECK_DIGITS, at);
    check_say(check, "    %s%s, at %s%s%s", first, other, at, measure,
              d->repaired ? ", repaired" : "");
}

/* --- which groups meet ------------------------------------------------------------------------ */

static int falling(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x < y) - (x > y);
}

typedef struct {
    uint64_t count, pair; /* groups: one above, one below */
} GroupPair;

static int most_first(const void *a, const void *b)
{
    const GroupPair *p = a, *q = b;
    const int        order = falling(&p->count, &q->count);
    return order != 0 ? order : -falling(&p->pair, &q->pair);
}

static uint32_t group_of(const Polygons *soup, uint32_t face)
{
    return face < soup->polygon_count ? soup->group[face]
                                      : soup->shape[face - soup->polygon_count].group;
}

/* One key per defect of the kind, equal ones side by side; NULL: no memory. */
static uint64_t *group_keys(const Check *check, DefectKind kind, size_t *count)
{
    const Defects  *list = &check->pipeline->defects;
    const Polygons *soup = &check->pipeline->scene->polygons;
    Error           err = { 0 };
    uint64_t       *key = array_create(list->count, sizeof *key, "groups", &err);
    *count = 0;
    for (size_t i = 0; key != NULL && i < list->count; i++) {
        const Defect *d = &list->item[i];
        if (d->kind != kind || d->other == DEFECT_NO_FACE)
            continue;
        const uint64_t a = group_of(soup, d->face), b = group_of(soup, d->other);
        key[(*count)++] = a < b ? a << 32 | b : b << 32 | a;
    }
    if (*count > 0)
        qsort(key, *count, sizeof *key, falling);
    return key;
}

/* The pairs of groups with most defects: places alone tell little when there are thousands. */
static void say_groups(const Check *check, DefectKind kind)
{
    const Polygons *soup = &check->pipeline->scene->polygons;
    size_t    count, pairs = 0;
    uint64_t *key = group_keys(check, kind, &count);
    Error     err = { 0 };
    GroupPair *pair = array_create(count, sizeof *pair, "groups", &err);
    for (size_t i = 0; key != NULL && pair != NULL && i < count; i++) {
        if (i == 0 || key[i] != key[i - 1])
            pair[pairs++].pair = key[i];
        pair[pairs - 1].count++;
    }
    if (pairs > 0)
        qsort(pair, pairs, sizeof *pair, most_first);
    for (size_t i = 0; count > CHECK_PLACES && i < pairs && i < CHECK_PLACES; i++)
        check_say(check, "    %" PRIu64 " time%s group '%.100s' and '%.100s'", pair[i].count,
                  check_plural(pair[i].count), soup->group_name[pair[i].pair >> 32],
                  soup->group_name[pair[i].pair & UINT32_MAX]);
    if (count > CHECK_PLACES && pairs > CHECK_PLACES)
        check_say(check, "    and %zu more pairs of groups; the first places:",
                  pairs - CHECK_PLACES);
    array_free(key);
    array_free(pair);
}

/* --- places ----------------------------------------------------------------------------------- */

/* The first few places of a kind; where something is left, of what is left. */
void check_say_places(const Check *check, DefectKind kind)
{
    const Defects *list = &check->pipeline->defects;
    const bool     left = list->found[kind] > list->repaired[kind];
    const uint64_t count = left ? list->found[kind] - list->repaired[kind] : list->found[kind];
    uint64_t       told = 0;
    if (count == 0)
        return;
    check_say(check, "  %s", defect_name(kind));
    if (kind == DEFECT_INTERSECTION || kind == DEFECT_OVERLAP)
        say_groups(check, kind);
    for (size_t i = 0; i < list->count && told < CHECK_PLACES; i++) {
        const Defect *d = &list->item[i];
        if (d->kind != kind || (left && d->repaired))
            continue;
        say_place(check, d);
        told++;
    }
    if (count > told)
        check_say(check, "    and %" PRIu64 " more", count - told);
}

void check_say_rims(const Check *check)
{
    const Inspection *found = &check->inspection;
    const Polygons   *soup = &check->pipeline->scene->polygons;
    if (found->rims == 0)
        return;
    check_say(check, "  rims");
    for (size_t i = 0; i < found->rim_count && i < CHECK_PLACES; i++) {
        const Rim *r = &found->rim[i];
        char       face[160], lo[PLACE_TEXT], hi[PLACE_TEXT];
        place_text(check->pipeline->scene, r->lo, CHECK_DIGITS, lo);
        place_text(check->pipeline->scene, r->hi, CHECK_DIGITS, hi);
        name_face(soup, r->face, face, sizeof face);
        check_say(check, "    %u edge%s, %.4g long, %s, %s to %s, at %s", r->edges,
                  check_plural(r->edges), r->length, r->flat ? "flat" : "bent", lo, hi, face);
    }
    if (found->rims > CHECK_PLACES)
        check_say(check, "    and %" PRIu64 " more", found->rims - CHECK_PLACES);
}

void check_say_materials(const Check *check)
{
    const Session *session = check->pipeline->session;
    if (check->faces.plain > 0)
        check_say(check, "  %" PRIu64 " face%s have no material in the file; grey 0.5 is used",
                  check->faces.plain, check_plural(check->faces.plain));
    if (check->missing > 0)
        check_say(check, "  missing materials");
    for (size_t i = 0, told = 0; i < session->warning_count && told < CHECK_PLACES; i++)
        if (strcmp(session->warnings[i].code, "material-missing") == 0) {
            check_say(check, "    %s: %s", session->warnings[i].where, session->warnings[i].text);
            told++;
        }
    if (check->missing > CHECK_PLACES)
        check_say(check, "    and %" PRIu64 " more", check->missing - CHECK_PLACES);
}
