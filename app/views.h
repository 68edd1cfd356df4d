/* SPDX-License-Identifier: BSD-3-Clause */
/* app/views.h -- the pictures of a run, one for each view: whose turn it is, and what they came
 * to. */
#ifndef APP_VIEWS_H
#define APP_VIEWS_H

#include "app/pipeline.h"

/* Whether the layers of `pictures` pictures of the largest size fit into memory, each as much again
 * while it is packed for its file; the first view is the chosen one afterwards. */
bool views_fit(Pipeline *pipeline, uint32_t pictures, Error *err);
/* Makes view k the camera of the next picture, and tells so where there are several. */
void views_begin(Pipeline *pipeline, uint32_t k);
/* What the picture under way came to, into its report. */
void views_note(const Pipeline *pipeline, PictureReport *picture);
/* All pictures together, for the summary and the exit code. */
void views_add_up(Pipeline *pipeline);

#endif
