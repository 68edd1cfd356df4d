/* SPDX-License-Identifier: BSD-3-Clause */
/* The account of faces: none of the file's vanishes without a reason. */
#include <assert.h>

#include "app/check.h"
#include "base/array.h"

/* What is known of a face. */
enum { FACE_THERE = 1, FACE_USED = 2 };

static void mark_triangles(const Pipeline *pipeline, uint8_t *face)
{
    const Surfaces *s = pipeline->surfaces;
    for (uint32_t k = 0; k < s->triangle_count; k++) {
        const uint8_t  sides = pipeline->sides[s->triangle_surface[k]];
        const uint32_t back = s->triangle_back[k];
        /* Of a plate each face has the side that it is the front of. */
        const bool front_used = back == SURFACE_NONE ? sides != 0 : (sides & 1) != 0;
        face[s->triangle_face[k]] |= front_used ? FACE_THERE | FACE_USED : FACE_THERE;
        if (back != SURFACE_NONE)
            face[back] |= (sides & 2) != 0 ? FACE_THERE | FACE_USED : FACE_THERE;
    }
    for (uint32_t k = 0; k < s->shape_count; k++) {
        const uint32_t surface = s->shape_surface[k];
        face[s->surface[surface].face] |= pipeline->sides[surface] != 0 ? FACE_THERE | FACE_USED
                                                                        : FACE_THERE;
    }
}

/* The reason why a face that is not there was left out: the last one listed for it. Surfaces here
 * are those of faces as they are in the file: what is under others is in them still. */
static void find_reasons(const Pipeline *pipeline, uint8_t *face, uint8_t *reason)
{
    const Defects *list = &pipeline->defects;
    for (size_t i = 0; i < list->count; i++) {
        const Defect *d = &list->item[i];
        const bool    covered = d->kind == DEFECT_COVERED && d->repaired;
        const bool    leaves = d->kind == DEFECT_DEGENERATE || d->kind == DEFECT_NONFINITE ||
                               d->kind == DEFECT_DUPLICATE || covered;
        if (covered)
            face[d->face] = 0;
        if (leaves && face[d->face] == 0)
            reason[d->face] = (uint8_t)(d->kind + 1);
    }
}

static void count_plain(const Polygons *soup, FaceAccount *account)
{
    for (size_t i = 0; i < soup->polygon_count; i++)
        account->plain += soup->materials[soup->material[i]].name[0] == '\0';
    for (size_t i = 0; i < soup->shape_count; i++)
        account->plain += soup->materials[soup->shape[i].material].name[0] == '\0';
}

bool check_account(const Pipeline *pipeline, FaceAccount *account, Error *err)
{
    const Polygons *soup = &pipeline->scene->polygons;
    const size_t    count = soup->polygon_count + soup->shape_count;
    assert(pipeline->surfaces != NULL && pipeline->sides != NULL);
    *account = (FaceAccount){ .input = count };
    uint8_t *face = array_create(count, 1, "faces", err);
    uint8_t *reason = array_create(count, 1, "faces", err);
    if (face != NULL && reason != NULL) {
        mark_triangles(pipeline, face);
        find_reasons(pipeline, face, reason);
        count_plain(soup, account);
        for (size_t i = 0; i < count; i++) {
            account->patches += (face[i] & FACE_USED) != 0;
            account->hidden += face[i] == FACE_THERE;
            if (face[i] == 0 && reason[i] == 0)
                account->lost++;
            else if (face[i] == 0)
                account->left[reason[i] - 1]++;
        }
    }
    array_free(face);
    array_free(reason);
    return !error_is_set(err);
}

uint64_t check_left_out(const FaceAccount *account)
{
    uint64_t sum = 0;
    for (int kind = 0; kind < DEFECT_KINDS; kind++)
        sum += account->left[kind];
    return sum;
}

const char *check_group(const Polygons *soup, uint32_t face)
{
    assert(face < soup->polygon_count + soup->shape_count);
    return soup->group_name[face < soup->polygon_count
                                ? soup->group[face]
                                : soup->shape[face - soup->polygon_count].group];
}
