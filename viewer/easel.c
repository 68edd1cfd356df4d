/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture between the window that wants it and the thread that makes it. */
#include "viewer/easel.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"

void easel_init(Easel *easel)
{
    assert(easel != NULL);
    *easel = (Easel){ .state = EASEL_EMPTY };
    atomic_init(&easel->number, 0);
    atomic_init(&easel->waiting, false);
    pthread_mutex_init(&easel->lock, NULL);
}

/* With the lock held, or nobody else there. */
static void take_down(Easel *easel)
{
    easel->pixel = array_free(easel->pixel);
    easel->image = image_destroy(easel->image);
    easel->state = EASEL_EMPTY;
    easel->done = 0;
    atomic_store(&easel->waiting, false);
    atomic_fetch_add(&easel->number, 1);
}

void easel_clear(Easel *easel)
{
    take_down(easel);
    pthread_mutex_destroy(&easel->lock);
}

/* --- the window ------------------------------------------------------------------------------- */

bool easel_ask(Easel *easel, const Camera *camera, int width, int height, Error *err)
{
    assert(width > 0 && height > 0);
    pthread_mutex_lock(&easel->lock);
    take_down(easel);
    easel->pixel = array_create(4 * (size_t)width, (size_t)height * sizeof(float), "picture", err);
    if (easel->pixel != NULL) {
        easel->wish = (EaselWish){ .camera = *camera, .width = width, .height = height,
                                   .number = atomic_load(&easel->number) };
        easel->state = EASEL_WAITING;
        easel->changes++;
        atomic_store(&easel->waiting, true);
    }
    pthread_mutex_unlock(&easel->lock);
    return !error_is_set(err);
}

void easel_drop(Easel *easel)
{
    pthread_mutex_lock(&easel->lock);
    take_down(easel);
    pthread_mutex_unlock(&easel->lock);
}

EaselState easel_state(Easel *easel, EaselWish *wish, double *done)
{
    pthread_mutex_lock(&easel->lock);
    const EaselState state = easel->state;
    if (wish != NULL)
        *wish = easel->wish;
    if (done != NULL)
        *done = easel->done;
    pthread_mutex_unlock(&easel->lock);
    return state;
}

void easel_why(Easel *easel, char *why, size_t size)
{
    pthread_mutex_lock(&easel->lock);
    snprintf(why, size, "%s", easel->why);
    pthread_mutex_unlock(&easel->lock);
}

const float *easel_open(Easel *easel, unsigned *seen)
{
    pthread_mutex_lock(&easel->lock);
    if (easel->pixel != NULL && easel->changes != *seen) {
        *seen = easel->changes;
        return easel->pixel;
    }
    pthread_mutex_unlock(&easel->lock);
    return NULL;
}

const Image *easel_image(Easel *easel)
{
    pthread_mutex_lock(&easel->lock);
    if (easel->state == EASEL_DONE)
        return easel->image;
    pthread_mutex_unlock(&easel->lock);
    return NULL;
}

void easel_shut(Easel *easel) { pthread_mutex_unlock(&easel->lock); }

/* --- the painter ------------------------------------------------------------------------------ */

bool easel_take(Easel *easel, EaselWish *wish)
{
    if (!atomic_load(&easel->waiting))
        return false;
    pthread_mutex_lock(&easel->lock);
    const bool there = atomic_exchange(&easel->waiting, false);
    if (there) {
        assert(easel->state == EASEL_WAITING);
        easel->state = EASEL_PAINTING;
        *wish = easel->wish;
    }
    pthread_mutex_unlock(&easel->lock);
    return there;
}

bool easel_wanted(const Easel *easel, unsigned number)
{
    return atomic_load(&easel->number) == number;
}

void easel_tile(Easel *easel, unsigned number, const Image *image, const int part[4])
{
    pthread_mutex_lock(&easel->lock);
    if (easel_wanted(easel, number)) {
        assert(easel->wish.width == image->width && easel->wish.height == image->height);
        for (int y = part[1]; y < part[3]; y++)
            for (int x = part[0]; x < part[2]; x++) {
                const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
                memcpy(easel->pixel + 4 * at, image->radiance + 3 * at, 3 * sizeof(float));
                easel->pixel[4 * at + 3] = 1;
            }
        easel->changes++;
    }
    pthread_mutex_unlock(&easel->lock);
}

void easel_progress(Easel *easel, unsigned number, double done)
{
    pthread_mutex_lock(&easel->lock);
    if (easel_wanted(easel, number))
        easel->done = done;
    pthread_mutex_unlock(&easel->lock);
}

void easel_finish(Easel *easel, unsigned number, Image *image)
{
    pthread_mutex_lock(&easel->lock);
    if (easel_wanted(easel, number)) {
        easel->state = EASEL_DONE;
        easel->done = 1;
        easel->image = image;
        image = NULL;
    }
    pthread_mutex_unlock(&easel->lock);
    image_destroy(image);
}

void easel_fail(Easel *easel, unsigned number, const char *why)
{
    pthread_mutex_lock(&easel->lock);
    if (easel_wanted(easel, number)) {
        easel->state = EASEL_FAILED;
        snprintf(easel->why, sizeof easel->why, "%s", why);
    }
    pthread_mutex_unlock(&easel->lock);
}
