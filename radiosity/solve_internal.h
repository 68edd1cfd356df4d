/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve_internal.h -- solvers on stored links beside the plain sweeps; this folder
 * only. */
#ifndef RADIOSITY_SOLVE_INTERNAL_H
#define RADIOSITY_SOLVE_INTERNAL_H

#include "radiosity/internal.h"

/* Each leaves radiosity, iterations and unshot in *solution. */
bool solve_conjugate_gradients(const SolveSystem *system, Solution *solution, Error *err);
bool solve_gmres(const SolveSystem *system, Solution *solution, Error *err);
/* Corrections from a small system of patches taken together. Leaves drift as well. */
bool solve_two_level(const SolveSystem *system, Solution *solution, Error *err);
/* Light between nodes of a tree over the patches, along links that are refined where they carry
 * much. Leaves the irradiance and its own residual as well: patches get what nodes they are part of
 * see in the mean, so it solves no system that the links as they are would give. */
bool solve_hierarchical(const SolveSystem *system, Solution *solution, Error *err);
/* Successive over-relaxation [young54]; relaxation 0: chosen after a few plain sweeps. */
bool solve_sor(const SolveSystem *system, double relaxation, Solution *solution, Error *err);

#endif
