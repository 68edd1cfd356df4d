/* SPDX-License-Identifier: BSD-3-Clause */
/* render/gather.h -- the final gather: light once more, per pixel or at points, by rays.
 *
 * At a point, light comes from lamps (areas that emit: sampled directly and by the hemisphere rays,
 * combined by multiple importance sampling), from point lights, and from all else: hemisphere rays
 * read the solution, interpolated, where they end. Rays shorter than a patch are followed a bounce
 * further, so that the mesh never shows near corners. Hemisphere rays are guided to where most
 * light comes from, as learnt per tile.
 * Method   two-pass radiosity [wallace87], final gather [reichert92]; MIS [veach95].
 * Threads  same bytes for any number.
 */
#ifndef RENDER_GATHER_H
#define RENDER_GATHER_H

#include "base/monitor.h"
#include "radiosity/room.h"
#include "radiosity/solve.h"
#include "render/image.h"
#include "scenes/scene.h"

/* All a gather reads; made once per solution, shared by pictures and points. */
typedef struct Gatherer Gatherer;

/* solution: bands = ROOM_BANDS. Everything passed must outlive the Gatherer. */
Gatherer *gatherer_create(const Room *room, const Solution *solution, const Links *links,
                          Error *err);
Gatherer *gatherer_destroy(Gatherer *gatherer);

/* Groups of lamps whose light pictures shall have in layers of their own, beside all of it. */
typedef struct {
    uint32_t      count;
    uint32_t      first_light; /* light k of the room is in group first_light + k; count - lights */
    const double *radiosity;   /* [count * patches->count * ROOM_BANDS]  with that group alone */
    const double *dimmer;      /* [count * ROOM_BANDS]  times that; NULL: 1 */
    const uint32_t *of_group;  /* [groups of the scene]  in which its emission is; else >= count */
    const char *const *name;   /* [count + 1]  of layers; the last: of light that is in none */
} GatherGroups;
/* For pictures to come. Then the light that is gathered is the sum of the groups', and records must
 * tell count + 1 groups apart (records_split). groups->name must outlive the Gatherer.
 * fails  false; ERROR_MEMORY. */
bool gatherer_split(Gatherer *gatherer, const GatherGroups *groups, const Links *links,
                    Error *err);

typedef struct {
    int      width, height; /* of the whole picture */
    uint32_t samples;       /* camera rays per pixel; 0: 64 */
    uint32_t gather_rays;   /* hemisphere rays per camera ray; 0: 4 */
    uint32_t light_rays;    /* lamp samples per camera ray; 0: 1 */
    bool     diffuse_only;  /* leave mirrors, glass and gloss out */
    Rgb      background;
    uint32_t seed;
    unsigned threads;
    PixelFilter filter;
    int      crop[4];       /* left, top, right, bottom of the part to make; all 0: the whole */
    struct KeptTiles *kept; /* tiles of an earlier run, and where finished ones can be saved from
                               (render/kept_tiles.h); NULL: none */
    struct Records *records; /* indirect light kept from picture to picture (render/records.h),
                                filled for this view first; NULL: rays for every sample */
    uint32_t record_rays;    /* hemisphere rays of a record; 0: 1024 */
    bool     whole;          /* asked to stop, makes what is missing with a sample for each pixel or
                                a few of them, in about a second, before it returns */
    double   error;          /* > 0: samples go on until the standard error of pixels is about this
                                share of the picture's mean luminance, up to `samples` each */
    /* Called with each finished tile, from any thread: pixels from left, top to before right,
     * bottom. NULL: not. */
    void   (*tile)(void *user, const Image *image, const int part[4]);
    void    *tile_user;
} RenderOptions;

typedef struct {
    uint64_t rays;
    double   seconds;
    double   samples; /* camera rays per pixel, on the mean */
    double   rough;   /* share of the pixels that options.whole has made so */
    double   error;   /* standard error of pixels that was reached, root mean square, relative to
                         the mean luminance or a brighter pixel's own; 0: not known */
    double   records_error; /* of light read from records, bias and all, as records_check finds it
                               (render/records_fill.h), relative to the mean luminance; with
                               options.error; 0: not known, or too small to tell */
} RenderReport;

/* fails  NULL; ERROR_MEMORY. Stopped by the monitor: the image with what was finished (whole rows
 *        of tiles) and *err ERROR_STOPPED. */
Image *render_gather(const Gatherer *gatherer, const Camera *camera, const RenderOptions *options,
                     RenderReport *report, const Monitor *monitor, Error *err);

/* What render_gather does first, alone: fills options->records for a view, if there are any. Later
 * views with the same records come out as if this one's picture had been made.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool render_records(const Gatherer *gatherer, const Camera *camera, const RenderOptions *options,
                    const Monitor *monitor, Error *err);

/* Irradiance at a free point with a unit normal: direct from lamps and lights, and indirect; and
 * the standard error of their sum (luminance) from 16 independent scramblings; a shadow so narrow
 * that no ray to a lamp meets it is not in it. rays: hemisphere rays in all; a quarter as many, 32
 * at least, go to lamps, and one to each point light. Mirrors and glass
 * pass light on where they do so for the solver (room->mirrors). */
typedef struct {
    Rgb    direct, indirect;
    double standard_error;
} Irradiance;
void gather_irradiance(const Gatherer *gatherer, Vec3 point, Vec3 normal, uint32_t rays,
                       uint32_t seed, Irradiance *out);

#endif
