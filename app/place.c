/* SPDX-License-Identifier: BSD-3-Clause */
/* Places as text. */
#include "app/place.h"

#include <assert.h>
#include <stdio.h>

void place_text(const Scene *scene, Vec3 p, int digits, char out[PLACE_TEXT])
{
    assert(digits > 0 && digits + PLACE_FAR_DIGITS <= 17);
    const Vec3 q = scene_to_file(scene, p);
    const int n = place_is_far(scene) ? digits + PLACE_FAR_DIGITS : digits;
    snprintf(out, PLACE_TEXT, "%.*g,%.*g,%.*g", n, q.x, n, q.y, n, q.z);
}
