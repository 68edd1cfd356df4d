/* SPDX-License-Identifier: BSD-3-Clause */
/* app/validate_views.h -- shapes whose factors between all surfaces are known, as data.
 *
 * row[i] tells F from face i to the faces after it, in order, apart by spaces:
 *   123      un-occluded: 123 * 1e-8, by the integral along the outlines
 *   123~4    partly hidden: 123 * 1e-7 with a standard error of 4 * 1e-7, by ray casting that
 *            shares no code with this program, both directions of the pair put together
 *   . or .5  one face, or five, that are not seen at all
 */
#ifndef APP_VALIDATE_VIEWS_H
#define APP_VALIDATE_VIEWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef double  ViewPoint[3];
typedef uint8_t ViewFace[4]; /* counter-clockwise from the front; a triangle's last one twice */

typedef struct {
    const char        *name;
    bool               closed;  /* every row sums to 1 */
    const ViewPoint   *point;   /* [points] */
    const ViewFace    *face;    /* [faces] */
    const char *const *row;     /* [faces] */
    size_t             points, faces;
} ViewCase;

extern const ViewCase validate_view_plates, validate_view_cube, validate_view_facet,
    validate_view_obstruction, validate_view_l_room, validate_view_gunter1, validate_view_box345;

#endif
