/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of pictures. */
#include "app/picture_files.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/commands.h"
#include "app/film.h"
#include "app/name_mark.h"
#include "app/output.h"
#include "base/array.h"

static const char MARK[] = "{camera}";

/* room.exr and room.png, whichever of the two the path names. */
static bool picture_name(const char *path, const Options *options, PictureReport *p, Error *err)
{
    p->values[0] = '\0';
    return output_name(path, ".exr", p->exr, sizeof p->exr, err) &&
           output_name(path, ".png", p->png, sizeof p->png, err) &&
           output_probe(p->exr, options, err) && output_probe(p->png, options, err) &&
           (options->false_colour == FILM_NONE ||
            (film_name(path, (FilmQuantity)options->false_colour, p->values, sizeof p->values,
                       err) && output_probe(p->values, options, err)));
}

bool picture_files_allowed(const Options *options, Error *err)
{
    PictureReport scratch;
    const char *path = options->output;
    if (path == NULL || strstr(path, MARK) != NULL)
        path = output_base(options->scene);
    if (options->output != NULL && strcmp(options->output, "-") == 0)
        return error_set(err, ERROR_USAGE, "render writes two files; -o needs a name");
    if (options->output != NULL && !output_ends(options->output, ".exr") &&
        !output_ends(options->output, ".png"))
        return error_set(err, ERROR_USAGE, "-o %s: a picture's name ends in .exr or .png",
                         options->output);
    /* Names with a mark are probed when the cameras are known. */
    return path != options->output || picture_name(path, options, &scratch, err);
}

/* What -o says, else after the scene, here: scene.exr, or scene-{camera}.exr. */
static bool find_pattern(const Pipeline *pipeline, char *pattern, size_t size, Error *err)
{
    const Options *options = &pipeline->session->options;
    char several[32];
    snprintf(several, sizeof several, "-%s.exr", MARK);
    if (options->output == NULL)
        return output_name(output_base(options->scene), pipeline->view_count > 1 ? several : ".exr",
                           pattern, size, err);
    if (pipeline->view_count > 1 && strstr(options->output, MARK) == NULL)
        return error_set(err, ERROR_USAGE, "-o %s: %u cameras need a name with %s in it",
                         options->output, pipeline->view_count, MARK);
    if ((size_t)snprintf(pattern, size, "%s", options->output) >= size)
        return error_set(err, ERROR_USAGE, "the file name '%.100s...' is too long",
                         options->output);
    return true;
}

bool picture_files_name(Pipeline *pipeline, Error *err)
{
    const Options *options = &pipeline->session->options;
    const uint32_t count = pipeline->view_count;
    char pattern[4096], path[4096];
    assert(count > 0 && pipeline->picture == NULL);
    if (!find_pattern(pipeline, pattern, sizeof pattern, err))
        return false;
    pipeline->picture = array_create(count, sizeof *pipeline->picture, "pictures", err);
    const char **name = array_create(count, sizeof *name, "pictures", err);
    const bool marked = strstr(pattern, MARK) != NULL;
    for (uint32_t k = 0; name != NULL && k < count; k++)
        name[k] = pipeline->view[k].name;
    snprintf(path, sizeof path, "%s", pattern);
    for (uint32_t k = 0; k < count && !error_is_set(err); k++) {
        PictureReport *p = &pipeline->picture[k];
        snprintf(p->camera, sizeof p->camera, "%s", name[k]);
        if (!marked || name_mark_fill(pattern, MARK, name, count, k, path, sizeof path, err))
            picture_name(path, options, p, err);
    }
    pipeline->picture_count = pipeline->picture != NULL ? count : 0;
    array_free(name);
    return !error_is_set(err);
}

bool picture_files_exist(const PictureReport *picture)
{
    return access(picture->exr, R_OK) == 0 && access(picture->png, R_OK) == 0 &&
           (picture->values[0] == '\0' || access(picture->values, R_OK) == 0);
}

void picture_files_command(const Options *options, char *out, size_t size)
{
    static const char *const left_out[] = { "--threads", "--json", "--progress", "--max-memory",
                                            "--time-limit", "--checkpoint", "--resume", "-o" };
    size_t used = (size_t)snprintf(out, size, "isolux %s", options->argv[0]);
    for (int i = 1; i < options->argc && used < size; i++) {
        bool skip = strncmp(options->argv[i], "-o", 2) == 0;
        bool two = strcmp(options->argv[i], "-o") == 0;
        for (size_t k = 0; k < sizeof left_out / sizeof *left_out; k++) {
            const size_t n = strlen(left_out[k]);
            if (strncmp(options->argv[i], left_out[k], n) == 0) {
                skip = true;
                two = options->argv[i][n] == '\0';
            }
        }
        if (!skip)
            used += (size_t)snprintf(out + used, size - used, " %s", options->argv[i]);
        i += skip && two;
    }
}

bool picture_files_write(Pipeline *pipeline, const Image *image, const PictureReport *picture,
                         Error *err)
{
    const Options *options = &pipeline->session->options;
    const Camera *c = &pipeline->camera;
    const Vec3 eye = scene_to_file(pipeline->scene, c->eye);
    const Vec3 target = scene_to_file(pipeline->scene, c->target);
    const double begin = progress_now();
    char command[1024];
    picture_files_command(options, command, sizeof command);
    pipeline->exposure = options->exposure_set ? options->exposure : image_auto_exposure(image);
    const ImageTone tone = { pipeline->exposure, (ToneCurve)options->tone };
    const ImageInfo info = {
        .eye = { eye.x, eye.y, eye.z },
        .target = { target.x, target.y, target.z },
        .up = { c->up.x, c->up.y, c->up.z },
        .vertical_fov = c->vertical_fov,
        .exposure = pipeline->exposure,
        .units = options->units == UNITS_PHOTOMETRIC ? "photometric" : "radiometric",
        .version = ISOLUX_VERSION,
        .scene = options->scene,
        .command = command,
        .scene_hash = pipeline->scene->hash,
        .threads = pipeline->session->settings.threads,
    };
    const bool written =
        image_write_exr(image, &info, picture->exr, err) &&
        image_write_png(image, &tone, &info, picture->png, err) &&
        (picture->values[0] == '\0' ||
         film_false_colour(pipeline->session, image, (FilmQuantity)options->false_colour, &info,
                           picture->values, err));
    pipeline_note(pipeline, STAGE_WRITE, begin);
    return written;
}
