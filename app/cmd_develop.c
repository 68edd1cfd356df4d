/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux develop: from the light in an EXR to a PNG, with another exposure, curve or quantity. */
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "app/film.h"
#include "app/output.h"
#include "base/array.h"

/* A layer that need not be there: zeros then, and no error. */
static float *optional_layer(const char *path, const char *layer, const Image *image, Error *err)
{
    Error missing = { 0 };
    int   width = 0, height = 0;
    float *values = image_read_layer(path, layer, &width, &height, &missing);
    if (values != NULL && width == image->width && height == image->height)
        return values;
    array_free(values);
    return array_create(3 * (size_t)image->width * (size_t)image->height, sizeof(float),
                        "picture layer", err);
}

/* Pictures of other programs have no layers: then all their light counts as reflected, and only
 * its brightness tells a lamp. */
static void fill_reflected(Image *image)
{
    const size_t n = 3 * (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < n; i++)
        if (image->direct[i] != 0 || image->indirect[i] != 0)
            return;
    memcpy(image->direct, image->radiance, n * sizeof(float));
}

/* --- light groups ----------------------------------------------------------------------------- */

/* "lamp=0.5" or "lamp=1,0.8,0.6" into the layer's name and factors. */
static bool read_factor(const char *text, char *layer, size_t size, double factor[3], Error *err)
{
    const char *equals = strrchr(text, '=');
    const bool grey = equals != NULL && value_number(equals + 1, &factor[0]);
    if (grey)
        factor[1] = factor[2] = factor[0];
    if (equals == NULL || equals == text || !(grey || value_numbers(equals + 1, factor, 3)) ||
        !(fmin(factor[0], fmin(factor[1], factor[2])) >= 0))
        return error_set(err, ERROR_USAGE, "--mix %.100s: wants NAME=FACTOR or NAME=R,G,B, none "
                         "below 0", text);
    const int length = snprintf(layer, size, "lightgroup.%.*s", (int)(equals - text), text);
    return (length > 0 && (size_t)length < size) ||
           error_set(err, ERROR_USAGE, "--mix %.100s: the name is too long", text);
}

/* The picture's light is the sum of the groups': each counts a factor times instead of once. */
static bool mix_group(Image *image, const char *path, const char *text, Error *err)
{
    const size_t n = (size_t)image->width * (size_t)image->height;
    double factor[3];
    char   layer[128];
    int    width, height; /* of the same file, so the same */
    if (!read_factor(text, layer, sizeof layer, factor, err))
        return false;
    float *light = image_read_layer(path, layer, &width, &height, err);
    for (size_t i = 0; light != NULL && i < 3 * n; i++)
        image->radiance[i] = (float)(image->radiance[i] + (factor[i % 3] - 1) * light[i]);
    array_free(light);
    return !error_is_set(err);
}

static bool mix_groups(Image *image, const Options *options, Error *err)
{
    const TextList *mix = &options->mix;
    const size_t values = 3 * (size_t)image->width * (size_t)image->height;
    for (uint32_t k = 0; k < mix->count; k++) {
        const size_t length = strcspn(mix->text[k], "=") + 1;
        for (uint32_t j = 0; j < k; j++)
            if (strncmp(mix->text[j], mix->text[k], length) == 0)
                return error_set(err, ERROR_USAGE, "--mix: '%.*s' is there twice",
                                 (int)length - 1, mix->text[k]);
        if (!mix_group(image, options->scene, mix->text[k], err))
            return false;
    }
    for (size_t i = 0; mix->count > 0 && i < values; i++)
        image->radiance[i] = fmaxf(image->radiance[i], 0); /* a group's noise may be below 0 */
    return true;
}

/* --- reading ---------------------------------------------------------------------------------- */

static bool read_image(Image *image, const Options *options, Error *err)
{
    const char *path = options->scene;
    image->radiance = image_read_layer(path, options->layer, &image->width, &image->height, err);
    if (image->radiance == NULL)
        return false;
    if (options->false_colour == FILM_ILLUMINANCE) {
        int width, height; /* of the same file, so the same */
        image->irradiance = image_read_layer(path, "irradiance", &width, &height, err);
    }
    image->direct = optional_layer(path, "direct", image, err);
    image->indirect = optional_layer(path, "indirect", image, err);
    if (error_is_set(err))
        return false;
    fill_reflected(image);
    return mix_groups(image, options, err);
}

static bool picture_name(const Options *options, char *out, size_t size, Error *err)
{
    if (options->output == NULL)
        return options->false_colour != FILM_NONE
                   ? film_name(options->scene, (FilmQuantity)options->false_colour, out, size, err)
                   : output_name(options->scene, ".png", out, size, err);
    if (!output_ends(options->output, ".png"))
        return error_set(err, ERROR_USAGE, "-o %s: the picture's name ends in .png",
                         options->output);
    snprintf(out, size, "%s", options->output);
    return true;
}

bool cmd_develop(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session       *session = pipeline->session;
    const Options *options = &session->options;
    Image image = { 0 };
    char  png[4096];
    *exit_code = 0;
    if (!picture_name(options, png, sizeof png, err) || !output_probe(png, options, err))
        return false;
    const ImageInfo info = { .units = options->units == UNITS_PHOTOMETRIC ? "photometric"
                                                                         : "radiometric",
                             .version = ISOLUX_VERSION, .scene = options->scene };
    bool good = read_image(&image, options, err);
    if (good && options->false_colour != FILM_NONE)
        good = film_false_colour(session, &image, (FilmQuantity)options->false_colour, &info, png,
                                 err);
    else if (good) {
        const ImageTone tone = {
            .exposure = options->exposure_set ? options->exposure : image_auto_exposure(&image),
            .curve = (ToneCurve)options->tone,
        };
        pipeline->exposure = tone.exposure;
        good = image_write_png(&image, &tone, &info, png, err);
    }
    if (good)
        session_say(session, "isolux: %s -> %s, %d x %d", options->scene, png, image.width,
                    image.height);
    array_free(image.radiance);
    array_free(image.direct);
    array_free(image.indirect);
    array_free(image.irradiance);
    return good;
}
