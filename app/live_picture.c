/* SPDX-License-Identifier: BSD-3-Clause */
/* Gathering for the window. */
#include "app/live_picture.h"

#include <assert.h>
#include <string.h>

#include "render/gather.h"
#include "render/records.h"

typedef struct {
    Live    *live;
    Easel   *easel;
    unsigned number;     /* of the wish */
} Painting;

static bool painting_stop(void *user)
{
    const Painting *painting = user;
    return live_must_end(painting->live) || !easel_wanted(painting->easel, painting->number);
}

static void painting_progress(void *user, const Progress *progress)
{
    const Painting *painting = user;
    Live *live = painting->live;
    easel_progress(painting->easel, painting->number, progress->done);
    live->report.done = progress->done;
    live_report(live);
}

static void painting_tile(void *user, const Image *image, const int part[4])
{
    const Painting *painting = user;
    easel_tile(painting->easel, painting->number, image, part);
}

static RenderOptions picture_options(const Live *live, const EaselWish *wish)
{
    const Session *session = live->pipeline->session;
    const Settings *settings = &session->settings;
    return (RenderOptions){ .width = wish->width, .height = wish->height,
                            .samples = settings->spp, .gather_rays = settings->gather_rays,
                            .filter = (PixelFilter)session->options.pixel_filter,
                            .diffuse_only = session->options.diffuse,
                            .background = live->pipeline->scene->background,
                            .seed = settings->seed, .threads = settings->threads,
                            .record_rays = settings->record_rays, .error = settings->error };
}

static Image *gather(Live *live, Painting *painting, const EaselWish *wish, const Links *links,
                     Error *err)
{
    const Solution solution = { .count = live->lit->count, .bands = ROOM_BANDS,
                                .radiosity = live->lit_radiosity };
    const Monitor monitor = { .user = painting, .progress = painting_progress,
                              .stop = painting_stop };
    RenderOptions options = picture_options(live, wish);
    options.tile = painting_tile;
    options.tile_user = painting;
    Image *image = NULL;
    Gatherer *gatherer = gatherer_create(&live->pipeline->room, &solution, links, err);
    if (gatherer != NULL && options.record_rays > 0)
        options.records = records_create(err);
    if (!error_is_set(err))
        image = render_gather(gatherer, &wish->camera, &options, NULL, &monitor, err);
    records_destroy(options.records);
    gatherer_destroy(gatherer);
    return image;
}

/* Areas of patches are all that a gatherer takes from links; the solver's may be half done. */
static Links *links_of_areas(const Live *live, Error *err)
{
    Links *links = links_empty(live->lit->count, 0, err);
    if (links != NULL)
        memcpy(links->area, live->lit_area, live->lit->count * sizeof *links->area);
    return links;
}

static void paint(Live *live, const EaselWish *wish)
{
    Easel *easel = &live->control->easel;
    Painting painting = { live, easel, wish->number };
    Error err = { 0 };
    Links *links = links_of_areas(live, &err);
    Image *image = links != NULL ? gather(live, &painting, wish, links, &err) : NULL;
    links_destroy(links);
    if (!error_is_set(&err)) {
        easel_finish(easel, wish->number, image);
        return;
    }
    image_destroy(image);
    easel_fail(easel, wish->number, err.text);
}

bool live_picture(Live *live)
{
    EaselWish wish;
    /* Divided patches have other light, which is published next. */
    if (live->lit == NULL || live->lit != live->pipeline->patches ||
        !easel_take(&live->control->easel, &wish))
        return false;
    assert(live->lit_radiosity != NULL && live->pipeline->room.patches == live->lit);
    atomic_store(&live->painting, true);
    const Report before = live->report;
    const char *const doing = live->doing;
    const double begin = progress_now();
    live->doing = "picture";
    live->report.done = 0;
    live_report(live);
    paint(live, &wish);
    live->doing = doing;
    live->report = before;
    live->stage_begin += progress_now() - begin;
    atomic_store(&live->painting, false);
    live_report(live);
    return true;
}
