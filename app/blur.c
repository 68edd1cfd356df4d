/* SPDX-License-Identifier: BSD-3-Clause */
/* Moments of a shutter, pictures of each, their means. */
#include "app/blur.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/picture_files.h"
#include "app/pipeline_accuracy.h"
#include "app/pipeline_picture.h"
#include "app/shutter.h"
#include "app/views.h"
#include "base/array.h"
#include "math/sampling.h"

enum { SEED_MOMENT = 600 };

/* Of one view: the sum of its pictures so far. */
typedef struct {
    Image   *image;
    uint32_t moments;
    double   error;   /* sum of the squares of the pictures' errors */
    Camera   camera;  /* of the moment nearest to the shutter's middle */
} Sum;

typedef struct {
    Pipeline *pipeline;
    Shutter   shutter;
    Settings  settings; /* of the whole */
    Sum      *sum;      /* [views] */
    uint32_t  views;
    Camera    own;      /* chosen at the first moment for a file without any */
    Vec3     *eye;
    bool      stopped;
} Blur;

/* --- one moment ------------------------------------------------------------------------------- */

/* A moment's share of the samples; of N means with the error e each the mean has e / sqrt(N). */
static void share_settings(const Blur *b, uint32_t k, Settings *s)
{
    const uint32_t count = b->shutter.count;
    s->spp = (s->spp + count - 1) / count;
    s->error *= sqrt(count);
    s->accuracy *= sqrt(count);
    /* Other numbers for each: the same noise would not average out. */
    s->seed = k == 0 ? s->seed : sampling_seed(s->seed, k, 0, SEED_MOMENT);
}

static void tell_moment(const Blur *b, uint32_t k)
{
    Pipeline *p = b->pipeline;
    char part[sizeof p->session->printer.part];
    snprintf(part, sizeof part, "moment %u of %u%s%.40s", k + 1, b->shutter.count,
             b->views > 1 ? ", " : "", b->views > 1 ? p->camera.name : "");
    progress_part(&p->session->printer, part);
}

/* Takes the picture over into the view's sum. */
static bool add_picture(Blur *b, uint32_t k, Sum *sum, Image *image, PictureReport *report,
                        Error *err)
{
    const Pipeline *p = b->pipeline;
    PictureReport now = { 0 };
    views_note(p, &now);
    if (sum->image != NULL && sum->image->group_count != image->group_count) {
        image_destroy(image);
        return error_set(err, ERROR_INPUT, "%s: the lamps of --light-groups are not the same at "
                         "all times", p->session->options.scene);
    }
    if (sum->image == NULL || k == b->shutter.middle)
        sum->camera = p->camera;
    if (sum->image == NULL) {
        sum->image = image;
    } else {
        if (k == b->shutter.middle)
            image_take_places(sum->image, image);
        image_add(sum->image, image);
        image_destroy(image);
    }
    sum->moments++;
    sum->error += now.error * now.error;
    report->samples += now.samples;
    report->rays += now.rays;
    report->seconds += now.seconds;
    report->width = now.width;
    report->height = now.height;
    report->made = true;
    return true;
}

static bool take_view(Blur *b, PictureMaker *maker, uint32_t k, uint32_t view, Error *err)
{
    Pipeline *p = b->pipeline;
    Session *session = p->session;
    Sum *sum = &b->sum[view];
    PictureReport *report = &p->picture[view];
    views_begin(p, view);
    tell_moment(b, k);
    if (sum->image != NULL) { /* whatever the camera's shape is now */
        p->width = report->width;
        p->height = report->height;
    }
    const Settings before = session->settings;
    share_settings(b, k, &session->settings);
    Image *image = picture_make(maker, p, err);
    session->settings = before;
    if (err->code == ERROR_STOPPED && image != NULL && !session->broken) {
        b->stopped = true;
        *err = (Error){ 0 };
        if (sum->image != NULL) { /* the moments before are whole */
            image_destroy(image);
            return true;
        }
    }
    if (error_is_set(err) || image == NULL) {
        image_destroy(image);
        return false;
    }
    return add_picture(b, k, sum, image, report, err);
}

/* The cameras of a moment, in a scene that is the same but for them. */
static bool move_cameras(Blur *b, uint32_t k, Error *err)
{
    Pipeline *p = b->pipeline;
    const Moment *m = &b->shutter.moment[k];
    assert(m->cameras == p->scene->camera_count);
    if (m->cameras > 0)
        memcpy(p->scene->cameras, m->camera, m->cameras * sizeof *m->camera);
    if (!pipeline_views(p, err))
        return false;
    if (m->cameras == 0 && b->views > 0 && !options_given(&p->session->options, OPTION_EYE))
        p->camera = p->view[0] = b->own;
    return true;
}

/* --- one solution ----------------------------------------------------------------------------- */

/* Forgets all but what is told of the run as a whole. */
static void renew(Pipeline *p)
{
    const Pipeline kept = *p;
    p->picture = NULL;
    pipeline_clear(p);
    p->picture = kept.picture;
    p->picture_count = kept.picture_count;
    p->moments = kept.moments;
    p->solutions = kept.solutions;
    memcpy(p->seconds, kept.seconds, sizeof p->seconds);
    memcpy(p->peak, kept.peak, sizeof p->peak);
}

/* What is seen at any of the moments takes part in the solution. */
static bool collect_eyes(Blur *b, uint32_t begin, uint32_t end, Error *err)
{
    Pipeline *p = b->pipeline;
    const size_t cameras = b->shutter.moment[begin].cameras;
    b->eye = array_free(b->eye);
    b->eye = array_create(cameras * (end - begin), sizeof *b->eye, "eyes", err);
    if (b->eye == NULL)
        return false;
    p->more_eyes = 0;
    for (uint32_t k = begin; k < end; k++)
        for (size_t i = 0; i < cameras; i++)
            b->eye[p->more_eyes++] = b->shutter.moment[k].camera[i].eye;
    p->more_eye = b->eye;
    return true;
}

/* Names, reports and sums, once the views are known. */
static bool begin_sums(Blur *b, Error *err)
{
    Pipeline *p = b->pipeline;
    if (b->views > 0)
        return p->view_count == b->views;
    b->own = p->view[0];
    b->sum = array_create(p->view_count, sizeof *b->sum, "pictures", err);
    if (b->sum == NULL || !picture_files_name(p, err))
        return false;
    b->views = p->view_count;
    return views_fit(p, b->views, err);
}

/* From the file to what pictures need, for moments begin..end-1. */
static bool solve_moments(Blur *b, uint32_t begin, uint32_t end, Error *err)
{
    Pipeline *p = b->pipeline;
    p->time = &b->shutter.moment[begin].time;
    if (!pipeline_read(p, err) || !pipeline_mesh(p, err) || !collect_eyes(b, begin, end, err) ||
        !move_cameras(b, begin, err) || !begin_sums(b, err))
        return false;
    views_begin(p, 0);
    return p->session->options.renderer != RENDERER_GATHER ||
           (pipeline_patches(p, err) && pipeline_accurate(p, err));
}

/* Asked to stop, the moments that there are will do. */
static bool enough(Blur *b)
{
    const Session *session = b->pipeline->session;
    const bool any = b->views > 0 && b->sum[b->views - 1].moments > 0;
    b->stopped = b->stopped || (any && (session->hurry || session_stopped(session)));
    return b->stopped;
}

static bool take_solution(Blur *b, uint32_t begin, uint32_t end, Error *err)
{
    PictureMaker maker = { 0 };
    bool good = solve_moments(b, begin, end, err);
    if (!good && err->code == ERROR_STOPPED && enough(b)) {
        *err = (Error){ 0 };
        return true;
    }
    if (!good || enough(b))
        return good;
    good = picture_maker_begin(&maker, b->pipeline, err);
    for (uint32_t k = begin; good && k < end && !enough(b); k++) {
        good = k == begin || move_cameras(b, k, err);
        for (uint32_t view = 0; good && view < b->views && !b->stopped; view++)
            good = take_view(b, &maker, k, view, err);
    }
    picture_maker_end(&maker);
    return good;
}

/* --- all -------------------------------------------------------------------------------------- */

static bool write_means(Blur *b, Error *err)
{
    Pipeline *p = b->pipeline;
    Session *session = p->session;
    bool good = true;
    for (uint32_t view = 0; good && view < b->views; view++) {
        Sum *sum = &b->sum[view];
        PictureReport *report = &p->picture[view];
        if (sum->moments < b->shutter.count)
            monitor_warn(&session->monitor, "stopped", report->exr,
                         "%s: the mean of %u of %u moments", session_stop_reason(), sum->moments,
                         b->shutter.count);
        if (sum->image == NULL)
            continue;
        image_scale(sum->image, 1.0 / sum->moments);
        p->camera = sum->camera;
        good = picture_files_write(p, sum->image, report, err);
        report->exposure = p->exposure;
        report->error = sqrt(sum->error) / sum->moments;
        if (good)
            session_say(session, "isolux: %s -> %s, %s%s%s", session->options.scene, report->exr,
                        report->png, report->values[0] != '\0' ? ", " : "", report->values);
        if (good && b->settings.accuracy > 0 && p->links == NULL) /* of paths */
            p->accuracy = (LightAccuracy){ .asked = b->settings.accuracy,
                                           .reached = fmax(p->accuracy.reached, report->error) };
    }
    return good;
}

bool blur_render(Pipeline *pipeline, bool *stopped, Error *err)
{
    Blur b = { .pipeline = pipeline, .settings = pipeline->session->settings };
    bool good = shutter_read(&b.shutter, pipeline->session, err);
    pipeline->moments = b.shutter.count;
    pipeline->solutions = b.shutter.solutions;
    for (uint32_t k = 0, end; good && k < b.shutter.count && !b.stopped; k = end) {
        for (end = k + 1; end < b.shutter.count &&
                          b.shutter.moment[end].solution == b.shutter.moment[k].solution; end++)
            ;
        if (k > 0)
            renew(pipeline);
        good = take_solution(&b, k, end, err);
    }
    pipeline->accuracy.reached = pipeline->links == NULL ? 0 : pipeline->accuracy.reached;
    good = good && write_means(&b, err);
    for (uint32_t view = 0; view < b.views; view++)
        image_destroy(b.sum[view].image);
    array_free(b.sum);
    array_free(b.eye);
    pipeline->more_eye = NULL;
    pipeline->more_eyes = 0;
    pipeline->time = NULL;
    shutter_clear(&b.shutter);
    *stopped = b.stopped;
    return good;
}
