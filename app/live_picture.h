/* SPDX-License-Identifier: BSD-3-Clause */
/* app/live_picture.h -- the picture that the window asks for, gathered by the light there is.
 *
 * Made in the solver's thread by the light that was published last, as soon as that thread tells of
 * its progress: meanwhile the solver rests, so that nothing of the room changes under the rays.
 */
#ifndef APP_LIVE_PICTURE_H
#define APP_LIVE_PICTURE_H

#include "app/live.h"

/* Makes the picture that is wished for, if one is and light is known; returns when it is made,
 * dropped by the window, or the thread is to end. True when there was one. What fails is told on
 * the easel. */
bool live_picture(Live *live);

#endif
