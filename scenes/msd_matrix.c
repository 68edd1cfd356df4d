/* SPDX-License-Identifier: BSD-3-Clause */
/* Transformations of MSD: the leftmost of a product is applied first. */
#include <assert.h>
#include <math.h>

#include "scenes/msd.h"

bool msd_starts_matrix(MsdReader *r)
{
    if (msd_is(r, '(') || msd_is_word(r, WORD_TRANS) || msd_is_word(r, WORD_SCALE) ||
        msd_is_word(r, WORD_MATRIX4X3) || msd_is_word(r, WORD_ROT_X) ||
        msd_is_word(r, WORD_ROT_Y) || msd_is_word(r, WORD_ROT_Z))
        return true;
    const MsdBinding *b =
        r->token.kind == TOKEN_NAME ? msd_lookup(r, r->token.symbol) : NULL;
    return b != NULL && b->kind == NAME_MATRIX;
}

/* count numbers in brackets. */
static bool numbers_read(MsdReader *r, int count, double *value)
{
    if (!msd_take(r, '('))
        return false;
    for (int i = 0; i < count; i++)
        if ((i > 0 && !msd_take(r, ',')) || !msd_number(r, &value[i]))
            return false;
    return msd_take(r, ')');
}

static bool matrix4x3_read(MsdReader *r, Affine *m)
{
    double v[12] = { 0 };

    if (!msd_next(r) || !numbers_read(r, 12, v))
        return false;
    /* Four rows for row vectors: p' = x row0 + y row1 + z row2 + row3. */
    *m = (Affine){ vec3(v[0], v[1], v[2]), vec3(v[3], v[4], v[5]), vec3(v[6], v[7], v[8]),
                   vec3(v[9], v[10], v[11]) };
    return true;
}

static bool moved_read(MsdReader *r, bool scale, Affine *m)
{
    double v[3] = { 0 };

    if (!msd_next(r) || !numbers_read(r, 3, v))
        return false;
    *m = affine_identity();
    if (scale) {
        m->x.x = v[0];
        m->y.y = v[1];
        m->z.z = v[2];
    } else {
        m->t = vec3(v[0], v[1], v[2]);
    }
    return true;
}

static bool rotation_read(MsdReader *r, Affine *m)
{
    const int axis = r->token.word == WORD_ROT_X ? 0 : r->token.word == WORD_ROT_Y ? 1 : 2;
    double    degrees = 0;

    if (!msd_next(r) || !numbers_read(r, 1, &degrees))
        return false;
    *m = affine_rotation(axis, degrees);
    return true;
}

static bool bracket_read(MsdReader *r, Affine *m)
{
    if (!msd_deeper(r) || !msd_next(r) || !msd_matrix(r, m) || !msd_take(r, ')'))
        return false;
    r->depth--;
    return true;
}

static bool named_read(MsdReader *r, Affine *m)
{
    uint32_t name = 0;

    if (!msd_named(r, NAME_MATRIX, &name))
        return false;
    *m = r->bindings[name].as.matrix;
    return true;
}

static bool factor_read(MsdReader *r, Affine *m)
{
    if (msd_is(r, '('))
        return bracket_read(r, m);
    if (r->token.kind == TOKEN_NAME)
        return named_read(r, m);
    if (r->token.kind != TOKEN_WORD)
        return msd_expected(r, "a matrix");
    switch (r->token.word) {
    case WORD_TRANS: return moved_read(r, false, m);
    case WORD_SCALE: return moved_read(r, true, m);
    case WORD_MATRIX4X3: return matrix4x3_read(r, m);
    case WORD_ROT_X:
    case WORD_ROT_Y:
    case WORD_ROT_Z: return rotation_read(r, m);
    default: return msd_expected(r, "a matrix");
    }
}

bool msd_matrix(MsdReader *r, Affine *value)
{
    const MsdPlace place = r->token.place;
    Affine         other = affine_identity(), inverse;

    if (!factor_read(r, value))
        return false;
    while (msd_is(r, '*')) {
        if (!msd_next(r) || !factor_read(r, &other))
            return false;
        *value = affine_then(value, &other);
    }
    if (!affine_invert(value, &inverse))
        return msd_error(r, place, "found a matrix that flattens or overflows space, expected one "
                                   "that has an inverse");
    return true;
}
