/* SPDX-License-Identifier: BSD-3-Clause */
/* app/film.h -- pictures for the eye as the options ask: tone curve, false colours. */
#ifndef APP_FILM_H
#define APP_FILM_H

#include "app/session.h"
#include "render/image.h"

/* The words of --false-colour. */
typedef enum { FILM_NONE, FILM_LUMINANCE, FILM_ILLUMINANCE } FilmQuantity;

/* PNG of a quantity of the picture in false colours. Only the layer of the quantity is read, and
 * the depth, which tells pixels that show nothing (NULL: there are none). */
bool film_false_colour(const Session *session, const Image *image, FilmQuantity quantity,
                       const ImageInfo *info, const char *path, Error *err);

/* "room.png" -> "room.illuminance.png". */
bool film_name(const char *path, FilmQuantity quantity, char *out, size_t size, Error *err);

#endif
