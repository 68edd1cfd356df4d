/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures in false colours, as the options ask. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "app/film.h"
#include "app/output.h"
#include "base/array.h"
#include "math/rgb.h"
#include "render/false_colour.h"

static const char *film_word(FilmQuantity quantity)
{
    return quantity == FILM_ILLUMINANCE ? "illuminance" : "luminance";
}

bool film_name(const char *path, FilmQuantity quantity, char *out, size_t size, Error *err)
{
    char ending[32];
    snprintf(ending, sizeof ending, ".%s.png", film_word(quantity));
    return output_name(path, ending, out, size, err);
}

/* As the legend names it. */
static const char *film_label(FilmQuantity quantity, int units)
{
    if (units == UNITS_RADIOMETRIC)
        return quantity == FILM_ILLUMINANCE ? "W/m2" : "W/m2/sr";
    return quantity == FILM_ILLUMINANCE ? "lux" : "cd/m2";
}

static float *film_values(const Image *image, FilmQuantity quantity, Error *err)
{
    const size_t n = (size_t)image->width * (size_t)image->height;
    const float *layer = quantity == FILM_ILLUMINANCE ? image->irradiance : image->radiance;
    float       *values = array_create(n, sizeof *values, "false colours", err);
    assert(layer != NULL);
    for (size_t i = 0; values != NULL && i < n; i++) {
        const float *p = layer + 3 * i;
        const bool   shown = image->depth == NULL || isfinite(image->depth[i]);
        values[i] = shown ? (float)rgb_luminance(rgb(p[0], p[1], p[2])) : NAN;
    }
    return values;
}

bool film_false_colour(const Session *session, const Image *image, FilmQuantity quantity,
                       const ImageInfo *info, const char *path, Error *err)
{
    const Options *options = &session->options;
    assert(quantity != FILM_NONE);
    FalseColour scale = { .low = options->range[0], .high = options->range[1],
                          .logarithmic = options->logarithmic, .isolines = options->isolines };
    float *values = film_values(image, quantity, err);
    if (values == NULL)
        return false;
    if (!options_given(options, OPTION_RANGE))
        false_colour_range(values, (size_t)image->width * (size_t)image->height, &scale);
    const bool written = false_colour_write(values, image->width, image->height, &scale,
                                            film_label(quantity, options->units), info, path, err);
    array_free(values);
    return written;
}
