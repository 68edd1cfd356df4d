/* SPDX-License-Identifier: BSD-3-Clause */
/* render/lamp_tree.h -- one lamp of very many, chosen for the place that it is to light.
 *
 * Knows    math/ only; not what a lamp is made of, but where it lies and which way it shines.
 * Method   a binary tree of lamps. Of each branch are known a ball around it, a cone of the
 *          directions its lamps face and their strength. From the root down one of two branches is
 *          taken by chance, by what they send to the receiver at most [shirley96, conty18], and
 *          once they are far for their size one of all its lamps by strength. A branch has no
 *          chance only where nothing of it can arrive: all of it lies below the receiver's horizon
 *          or faces away.
 * Cost     a choice or a chance: the depth of the tree, about log2(lamps), at most.
 * Threads  never changes once made.
 */
#ifndef RENDER_LAMP_TREE_H
#define RENDER_LAMP_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "math/vec3.h"

/* A lamp, as far as the tree needs to know. */
typedef struct {
    Vec3   centre;
    double radius;   /* of a ball around it */
    Vec3   axis;     /* unit: it shines to the front of a plane across it */
    bool   around;   /* it shines to all sides: no axis */
    double strength; /* radiance times area, or intensity; >= 0 */
} TreeLamp;

typedef struct LampBranch LampBranch;

typedef struct {
    LampBranch *branch; /* [2 * count - 1]  the root first */
    uint32_t   *lamp;   /* [count]  in the order of the branches */
    uint32_t   *place;  /* [count]  of each lamp in that order */
    double     *below;  /* [count + 1]  strengths in that order, running */
    uint32_t    count;
} LampTree;

/* 1 <= count < 2^31 lamps; they are not kept. */
bool lamp_tree_init(LampTree *tree, const TreeLamp *lamp, uint32_t count, Error *err);
void lamp_tree_clear(LampTree *tree);

enum { LAMP_TREE_NONE = UINT32_MAX >> 1 };

/* The lamp chosen for a point with a unit normal by *x in [0,1), which moves to its place among all
 * that choose the same lamp, [0,1); *chance: how likely that lamp is, > 0. LAMP_TREE_NONE: by this
 * *x no lamp that can light the point is found (a loose bound further up). */
uint32_t lamp_tree_choose(const LampTree *tree, Vec3 point, Vec3 normal, double *x,
                          double *chance);
/* The most that all its lamps together may send there, roughly: in units of irradiance. */
double lamp_tree_most(const LampTree *tree, Vec3 point, Vec3 normal);
/* How likely lamp k is for the same point: 0 only if it can send nothing there. */
double lamp_tree_chance(const LampTree *tree, Vec3 point, Vec3 normal, uint32_t k);

#endif
