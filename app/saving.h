/* SPDX-License-Identifier: BSD-3-Clause */
/* app/saving.h -- a run saved from time to time, and taken up again (--checkpoint, --resume).
 *
 * What is saved depends on how far the run is: rows of the first cast, or what the stochastic
 * solver gathered in rounds, or links between clusters; links as cast, how patches
 * were divided, rows of the parts being cast; the solution, how many pictures are finished, and
 * finished tiles of the next. All else is made again, and comes out the same. Saving happens
 * between chunks of work, in the thread that reports progress; others work on meanwhile.
 * All functions but begin and end take NULL and then do nothing.
 */
#ifndef APP_SAVING_H
#define APP_SAVING_H

#include "app/pipeline.h"
#include "radiosity/checkpoint.h"
#include "render/kept_tiles.h"

/* What there is to save. */
typedef enum { SAVING_NOTHING, SAVING_ROWS, SAVING_LINKS, SAVING_SOLUTION } SavingState;

typedef struct Saving {
    Pipeline   *pipeline;
    const char *path;         /* of the file to write; NULL: none is written */
    char        name[4096];
    double      every, last;  /* seconds; clock of progress_now */
    bool        stopped;      /* the last save, on being asked to stop, was made */
    SavingState state;
    uint64_t    key;          /* of scene and options */
    bool        resuming;     /* `loaded` waits to be taken */
    Checkpoint  loaded;
    uint32_t    passes;       /* splits kept below */
    uint32_t    count[CHECKPOINT_PASSES];
    uint8_t    *split[CHECKPOINT_PASSES];
    bool        chosen;       /* the last of them was loaded and not carried out yet */
    KeptRows   *rows;
    KeptTiles  *tiles;
    StochasticKept *light;
    ClustersKept *clusters;
    uint32_t    view;         /* picture under way: those before it are finished and written */
    uint32_t    views_before; /* the same of the run that is resumed */
    Error       error;        /* why nothing could be saved */
} Saving;

/* Reads the file of --resume, and sees whether that of --checkpoint can be written.
 * fails  false. */
bool saving_begin(Saving *saving, Pipeline *pipeline, Error *err);
/* Takes the file away when the run is through, unless it was asked to stop or failed. */
void saving_end(Saving *saving, bool finished);

/* Once patches are there: gives the pipeline what was loaded, if it was made from the same.
 * fails  false; ERROR_INPUT. */
bool saving_resume(Saving *saving, Error *err);
void saving_state(Saving *saving, SavingState state);
/* Saves when it is time to, or the run is asked to stop. On failure the session is broken. */
void saving_tick(Saving *saving);
/* Saves at once. */
void saving_now(Saving *saving);

/* For the next cast; NULL: nothing is to be kept. */
KeptRows *saving_rows(Saving *saving);
/* Picture number `view` of several begins. */
void saving_view(Saving *saving, uint32_t view);
/* How many pictures an earlier run had finished and written. */
uint32_t saving_views_before(const Saving *saving);
/* For the stochastic solver, and for that over clusters; NULL: it is not the one that runs. */
StochasticKept *saving_light(Saving *saving);
ClustersKept *saving_clusters(Saving *saving);
/* For the picture. */
KeptTiles *saving_tiles(Saving *saving);
/* Patches that the pass under way divides [patches->count]: copied. */
bool saving_pass(Saving *saving, const uint8_t *split, Error *err);
/* Those that an earlier run had chosen for the next pass; NULL: none. Gives them once. */
const uint8_t *saving_chosen(Saving *saving);

#endif
