/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of defects. */
#include "mesh/defects.h"

#include <assert.h>

#include "base/array.h"

bool defects_add(Defects *list, const Defect *defect, Error *err)
{
    if (list == NULL)
        return true;
    assert(defect != NULL && defect->kind < DEFECT_KINDS);
    list->found[defect->kind]++;
    list->repaired[defect->kind] += defect->repaired;
    if (list->keep > 0 && list->found[defect->kind] > list->keep)
        return true;
    if (!array_reserve((void **)&list->item, &list->capacity, list->count + 1, sizeof *list->item,
                       "the list of defects", err))
        return false;
    list->item[list->count++] = *defect;
    return true;
}

void defects_leave(Defects *list, DefectKind kind)
{
    assert(list != NULL && kind < DEFECT_KINDS);
    list->repaired[kind] = 0;
    for (size_t i = 0; i < list->count; i++)
        if (list->item[i].kind == kind)
            list->item[i].repaired = false;
}

void defects_clear(Defects *list)
{
    array_free(list->item);
    *list = (Defects){ 0 };
}

const char *defect_name(DefectKind kind)
{
    switch (kind) {
    case DEFECT_DEGENERATE:   return "degenerate";
    case DEFECT_NONFINITE:    return "nonfinite";
    case DEFECT_DUPLICATE:    return "duplicate";
    case DEFECT_BACK_TO_BACK: return "back-to-back";
    case DEFECT_NONPLANAR:    return "nonplanar";
    case DEFECT_CROSSING:     return "outline-crossing";
    case DEFECT_NONMANIFOLD:  return "nonmanifold";
    case DEFECT_T_JUNCTION:   return "t-junction";
    case DEFECT_WINDING:      return "winding";
    case DEFECT_UNORIENTABLE: return "unorientable";
    case DEFECT_REFUSED:      return "refused";
    case DEFECT_OPEN_EDGE:    return "open-edge";
    case DEFECT_INTERSECTION: return "intersection";
    case DEFECT_OVERLAP:      return "overlap";
    case DEFECT_INSIDE_SOLID: return "inside-solid";
    case DEFECT_MATERIAL:     return "other-material";
    case DEFECT_CUT:          return "cut";
    case DEFECT_COVERED:      return "covered";
    case DEFECT_COVERED_PART: return "covered-part";
    case DEFECT_CONTACT_LEFT: return "contact-left";
    case DEFECT_KINDS:        break;
    }
    return "";
}
