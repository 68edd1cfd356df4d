/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/easel.h -- the picture that is gathered for a view: asked for by the window, made by the
 * solver's thread, seen tile by tile.
 *
 * A wish stands until it is dropped, or until another takes its place; each has a number, by which
 * whoever paints learns that nobody wants it any more.
 * Threads  all under a lock that is held to copy tiles and to hand pixels to the card.
 */
#ifndef VIEWER_EASEL_H
#define VIEWER_EASEL_H

#include <pthread.h>
#include <stdatomic.h>

#include "render/image.h"
#include "scenes/scene.h"

typedef enum {
    EASEL_EMPTY,
    EASEL_WAITING,   /* asked for; light is not known yet */
    EASEL_PAINTING,
    EASEL_DONE,
    EASEL_FAILED
} EaselState;

typedef struct {
    Camera   camera;
    int      width, height;   /* pixels */
    unsigned number;
} EaselWish;

typedef struct {
    atomic_uint number;       /* of the wish that stands, or of one that was dropped */
    atomic_bool waiting;      /* it was not taken up yet */
    pthread_mutex_t lock;
    /* under the lock */
    EaselState  state;
    EaselWish   wish;
    float      *pixel;        /* [4 * width * height]  radiance, and 1 where a tile is finished */
    unsigned    changes;      /* grows with each of them */
    double      done;         /* 0..1 */
    Image      *image;        /* EASEL_DONE */
    char        why[200];     /* EASEL_FAILED */
} Easel;

void easel_init(Easel *easel);
void easel_clear(Easel *easel);

/* --- the window ------------------------------------------------------------------------------- */

/* Wishes for a picture. fails  false; ERROR_MEMORY: there is no wish. */
bool easel_ask(Easel *easel, const Camera *camera, int width, int height, Error *err);
/* It is not wanted any more. */
void easel_drop(Easel *easel);
/* The state, with a copy of the wish and of what is done; any may be NULL. */
EaselState easel_state(Easel *easel, EaselWish *wish, double *done);
/* Why it failed [200]. */
void easel_why(Easel *easel, char *why, size_t size);
/* Pixels, with the lock held until easel_shut, when there are others than *seen, which is set;
 * else NULL and no lock. */
const float *easel_open(Easel *easel, unsigned *seen);
void easel_shut(Easel *easel);
/* The finished picture, with the lock held until easel_shut; NULL and no lock: there is none. */
const Image *easel_image(Easel *easel);

/* --- the painter ------------------------------------------------------------------------------ */

/* Takes up a wish that waits; false: none does. */
bool easel_take(Easel *easel, EaselWish *wish);
/* Whether that wish still stands. */
bool easel_wanted(const Easel *easel, unsigned number);
/* A tile is finished: pixels from left, top to before right, bottom. From any thread. */
void easel_tile(Easel *easel, unsigned number, const Image *image, const int part[4]);
void easel_progress(Easel *easel, unsigned number, double done);
/* The whole is; takes the image over. */
void easel_finish(Easel *easel, unsigned number, Image *image);
void easel_fail(Easel *easel, unsigned number, const char *why);

#endif
