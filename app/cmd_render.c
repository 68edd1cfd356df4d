/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux render: solve, gather, EXR and PNG. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "app/film.h"
#include "app/output.h"
#include "app/pipeline_accuracy.h"
#include "app/pipeline_path.h"
#include "app/saving.h"
#include "app/summary.h"
#include "base/array.h"
#include "render/records.h"

typedef struct {
    char exr[4096], png[4096], values[4096]; /* the last: in false colours; "": none */
} Names;

/* room.exr and room.png, whichever of the two -o names; without -o named after the scene, here. */
static bool picture_names(const Options *options, Names *names, Error *err)
{
    const char *path = options->output != NULL ? options->output : output_base(options->scene);
    if (strcmp(path, "-") == 0)
        return error_set(err, ERROR_USAGE, "render writes two files; -o needs a name");
    if (options->output != NULL && !output_ends(path, ".exr") && !output_ends(path, ".png"))
        return error_set(err, ERROR_USAGE, "-o %s: a picture's name ends in .exr or .png", path);
    return output_name(path, ".exr", names->exr, sizeof names->exr, err) &&
           output_name(path, ".png", names->png, sizeof names->png, err) &&
           output_probe(names->exr, options, err) &&
           output_probe(names->png, options, err) &&
           (options->false_colour == FILM_NONE ||
            (film_name(path, (FilmQuantity)options->false_colour, names->values,
                       sizeof names->values, err) && output_probe(names->values, options, err)));
}

/* Bytes of all layers, and as much again while they are packed for the file. */
static bool image_fits(const Pipeline *pipeline, Error *err)
{
    const uint64_t pixels = (uint64_t)pipeline->width * (uint64_t)pipeline->height;
    const uint64_t layers = (3 * 6 + 1) * sizeof(float) + sizeof(uint32_t);
    return pipeline_fits(pipeline, 2 * layers * pixels, "picture", err);
}

/* A picture that was asked to stop before it began is made with one ray per pixel: something to
 * look at, in about a second. */
static void hurry_picture(Pipeline *pipeline)
{
    Session *session = pipeline->session;
    if (!session->hurry && session_stopped(session)) {
        session->hurry = true;
        monitor_warn(&session->monitor, "hurried", session->options.scene,
                     "%s: finishing roughly", session_stop_reason());
    }
    if (session->hurry) {
        session->settings.spp = session->settings.gather_rays = 1;
        session->settings.record_rays = 0;
        session->settings.error = 0;
    }
}

static Image *gather(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const double begin = progress_now();
    const double *crop = session->options.crop;
    Gatherer *gatherer = gatherer_create(&pipeline->room, pipeline->solution, pipeline->links,
                                         err);
    hurry_picture(pipeline);
    Records *records = session->settings.record_rays > 0 ? records_create(err) : NULL;
    const RenderOptions ro = { .width = pipeline->width, .height = pipeline->height,
                               .samples = session->settings.spp,
                               .gather_rays = session->settings.gather_rays,
                               .filter = (PixelFilter)session->options.pixel_filter,
                               .crop = { (int)crop[0], (int)crop[1], (int)crop[2], (int)crop[3] },
                               .diffuse_only = session->options.diffuse,
                               .background = pipeline->scene->background,
                               .seed = session->settings.seed,
                               .threads = session->settings.threads,
                               .kept = saving_tiles(pipeline->saving),
                               .records = records,
                               .record_rays = session->settings.record_rays,
                               .error = session->settings.error };
    Image *image = NULL;
    if (gatherer != NULL)
        image = render_gather(gatherer, &pipeline->camera, &ro, &pipeline->render,
                              &session->monitor, err);
    records_destroy(records);
    gatherer_destroy(gatherer);
    pipeline_note(pipeline, STAGE_GATHER, begin);
    return image;
}

/* The command line without what must not change the bytes of a picture: threads, names of results,
 * limits. */
static void record_command(const Options *options, char *out, size_t size)
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

static bool write_picture(Pipeline *pipeline, const Image *image, const Names *names, Error *err)
{
    const Options *options = &pipeline->session->options;
    const Camera *c = &pipeline->camera;
    const Vec3 eye = scene_to_file(pipeline->scene, c->eye);
    const Vec3 target = scene_to_file(pipeline->scene, c->target);
    const double begin = progress_now();
    char command[1024];
    record_command(options, command, sizeof command);
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
        image_write_exr(image, &info, names->exr, err) &&
        image_write_png(image, &tone, &info, names->png, err) &&
        (names->values[0] == '\0' ||
         film_false_colour(pipeline->session, image, (FilmQuantity)options->false_colour, &info,
                           names->values, err));
    pipeline_note(pipeline, STAGE_WRITE, begin);
    return written;
}

bool cmd_render(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    Names names = { .values = "" };
    assert(session->options.scene != NULL);
    const bool solved = session->options.renderer == RENDERER_GATHER;
    if (solved && !pipeline_accuracy_allowed(&session->options, err))
        return false;
    if (!picture_names(&session->options, &names, err) || !pipeline_read(pipeline, err) ||
        !pipeline_mesh(pipeline, err) || !pipeline_camera(pipeline, err))
        return false;
    view_size(pipeline);
    if (!image_fits(pipeline, err))
        return false;
    if (solved && (!pipeline_patches(pipeline, err) || !pipeline_accurate(pipeline, err)))
        return false;
    Image *image = solved ? gather(pipeline, err) : pipeline_path(pipeline, err);
    *exit_code = pipeline_exit_code(pipeline);
    if (image != NULL && err->code == ERROR_STOPPED && session->broken)
        image = image_destroy(image);
    if (image != NULL && err->code == ERROR_STOPPED) {
        *exit_code = ERROR_STOPPED;
        *err = (Error){ 0 };
        monitor_warn(&session->monitor, "stopped", names.exr,
                     "%s: the picture is not whole", session_stop_reason());
    }
    if (image == NULL)
        return false;
    const bool written = write_picture(pipeline, image, &names, err);
    image_destroy(image);
    if (!written)
        return false;
    session_say(session, "isolux: %s -> %s, %s%s%s", session->options.scene, names.exr, names.png,
                names.values[0] != '\0' ? ", " : "", names.values);
    summary_print(pipeline);
    return true;
}
