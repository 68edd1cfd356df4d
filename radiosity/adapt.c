/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/adapt.c -- what the picture on the patches leaves out of the light on them. */
#include "radiosity/adapt.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/adapt_internal.h"
#include "radiosity/internal.h"

static const uint32_t DEFAULT_RAYS = 64, DEFAULT_ROW_RAYS = 256;

/* Share of the variance of independent rays that is left with points of a net: rows of a Cornell
 * box, 64 to 1024 rays. */
static const double NET_VARIANCE = 0.5;

/* Standard errors that count as chance: better an edge found one pass later than all half shade
 * divided. */
static const double SURE = 1;

/* Rays to lamps for one of a row's. */
static const double LAMP_SHARE = 0.25;

/* Values that go to the vertices: both halves of the direct light, the indirect one, and that with
 * what the row says of the direct one. */
enum { DIRECT_A, DIRECT_B, INDIRECT, TOTAL, VALUES };

/* Where single rays to the lamps differ by more than this share of their mean (squared), the lamps
 * are so near or so large that few rays say little of how light changes over the patch; its row may
 * say more. */
static const double NEAR_SPREAD = 0.25;

/* What tells of the direct light: rays to lamps; the row, too; the row alone, nothing being in the
 * way. */
typedef enum { BY_RAYS, BY_BOTH, BY_ROW } Telling;

typedef struct {
    const Room         *room;
    const Links        *links;
    const double       *irradiance;
    const AdaptOptions *options;
    uint32_t            row_rays;
    AdaptSampler       *sampler;  /* [threads] */
    AdaptPoint         *point;    /* [patches * ADAPT_POINTS] */
    uint8_t            *points;   /* [patches]  how many of them */
    double             *mean;     /* [patches * VALUES] */
    double             *noise;    /* [patches * 2]  variance of the indirect value, the total one */
    uint8_t            *telling;  /* [patches]  Telling */
    double             *vertex;   /* [vertices * VALUES] */
    float              *radius;   /* [patches]  greatest distance of a corner from the centre */
    AdaptPiece         *piece;    /* [patches * ADAPT_PIECES] */
    double             *sent;     /* [patches]  luminance of B - E */
    double             *reflected;/* [vertices]  the same */
    double             *error;    /* [patches] */
} Adapting;

/* Light of patches that is not their own, luminance. */
static bool find_reflected(Adapting *a, Error *err)
{
    const Patches *patches = a->room->patches;
    for (uint32_t i = 0; i < patches->count; i++) {
        const double *h = &a->irradiance[(size_t)i * ROOM_BANDS];
        const Rgb rho = a->room->materials[patches->material[i]].reflectance;
        a->sent[i] = rgb_luminance(rgb(rho.r * h[0], rho.g * h[1], rho.b * h[2]));
    }
    return vertex_radiosity(patches, a->links->area, 1, a->sent, a->reflected, err);
}

/* Light that a row brings, spread over the points of the patch, and how much chance there is in the
 * indirect part: a ray that comes to j brings what j reflects. */
static void gather_row(Adapting *a, AdaptSampler *sampler, uint32_t patch, double *mean)
{
    const Links *links = a->links;
    double sum = 0, squares = 0, direct = 0, direct_squares = 0;
    for (uint64_t k = links->first[patch]; k < links->first[patch + 1]; k++) {
        const uint32_t j = links->source[k];
        const double f = links->form_factor[k], b = a->sent[j];
        const double own = rgb_luminance(room_emission(a->room, j));
        sum += f * b;
        squares += f * b * b;
        direct += f * own;
        direct_squares += f * own * own;
        adapt_spread(sampler, patch, j, f, b, own);
    }
    mean[INDIRECT] = sum;
    mean[TOTAL] = sum + direct;
    /* Lamps are found both by rays of the hemisphere and by their own: the better one counts. */
    const double by_row = fmax(direct_squares - direct * direct, 0) / a->row_rays;
    const double by_lamps = sampler->spread * direct * direct / (LAMP_SHARE * a->row_rays);
    double *noise = &a->noise[2 * (size_t)patch];
    noise[0] = NET_VARIANCE * fmax(squares - sum * sum, 0) / a->row_rays;
    noise[1] = noise[0] + NET_VARIANCE * fmin(by_row, by_lamps);
}

static void sample_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Adapting *a = context;
    AdaptSampler *sampler = &a->sampler[worker];
    for (uint32_t i = begin; i < end; i++) {
        AdaptPoint *point = &a->point[(size_t)i * ADAPT_POINTS];
        double *mean = &a->mean[(size_t)i * VALUES], weights = 0;
        if (!(a->links->area[i] > 0))
            continue;
        const uint32_t n = adapt_sample(sampler, i, point);
        a->points[i] = (uint8_t)n;
        for (uint32_t k = 0; k < n; k++) {
            mean[DIRECT_A] += (double)point[k].weight * (double)point[k].direct[0];
            mean[DIRECT_B] += (double)point[k].weight * (double)point[k].direct[1];
            weights += (double)point[k].weight;
        }
        mean[DIRECT_A] /= weights > 0 ? weights : 1;
        mean[DIRECT_B] /= weights > 0 ? weights : 1;
        const bool near = sampler->spread > NEAR_SPREAD;
        a->telling[i] = near ? sampler->open ? BY_ROW : BY_BOTH : BY_RAYS;
        gather_row(a, sampler, i, mean);
        adapt_collect(sampler, (double)a->links->escape[i], mean[INDIRECT], mean[TOTAL], n, point);
    }
}

/* What the vertices say at a point. */
static void interpolate(const Adapting *a, const AdaptPoint *at, unsigned side,
                        double value[VALUES])
{
    uint32_t vertex[PATCH_WEIGHTS];
    double weight[PATCH_WEIGHTS];
    const int n = patches_interpolate(a->room->patches, a->room->surfaces, at->surface, side,
                                      (double)at->s, (double)at->t, vertex, weight);
    for (int v = 0; v < VALUES; v++)
        value[v] = 0;
    for (int k = 0; k < n; k++)
        for (int v = 0; v < VALUES; v++)
            value[v] += weight[k] * a->vertex[(size_t)vertex[k] * VALUES + (size_t)v];
}

/* Square of the error, by two ways that each miss something. One: what the mesh misses of the
 * indirect light is the same in both halves; of the direct light, both are off by the same error of
 * the mesh and by noise that knows nothing of the other's: so the product of both halves is off by
 * nothing in the mean, but by much where few rays to near lamps make it. Two: all light as the row
 * says, which knows no shadows inside the patch. */
static double squared_error(const Adapting *a, uint32_t i)
{
    const AdaptPoint *point = &a->point[(size_t)i * ADAPT_POINTS];
    const double *noise = &a->noise[2 * (size_t)i];
    double products = 0, chances = 0, squares = 0, weights = 0;
    for (uint32_t k = 0; k < a->points[i]; k++) {
        double value[VALUES];
        const double w = (double)point[k].weight;
        interpolate(a, &point[k], a->room->patches->side[i], value);
        const double indirect = (double)point[k].indirect - value[INDIRECT];
        const double total = (double)point[k].total - value[TOTAL];
        const double first = (double)point[k].direct[0] - value[DIRECT_A] + indirect;
        const double second = (double)point[k].direct[1] - value[DIRECT_B] + indirect;
        const double both = (first + second) * (first - second) / 2;
        products += w * first * second;
        chances += w * both * both; /* variance of the product, the difference being chance */
        squares += w * total * total;
        weights += w;
    }
    if (!(weights > 0))
        return 0;
    const double by_row = fmax(squares / weights - noise[1], 0);
    const double chance = sqrt(chances / weights / a->points[i]);
    const double by_rays = fmax(products / weights - SURE * chance - noise[0], 0);
    return a->telling[i] == BY_RAYS ? by_rays
                                    : a->telling[i] == BY_ROW ? by_row : fmax(by_row, by_rays);
}

static bool can_divide(const Adapting *a, uint32_t i)
{
    const Patches *p = a->room->patches;
    const bool merged = p->first_piece[i + 1] > p->first_piece[i];
    return a->points[i] > 0 && (merged || p->cell[i].level < PATCH_LEVELS) &&
           patches_extent(p, a->room->surfaces, i) >= 2 * a->options->least_size;
}

static void error_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Adapting *a = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        const double share = a->links->area[i] / a->room->patches->area[i];
        a->error[i] = can_divide(a, i) ? sqrt(squared_error(a, i) * fmin(share, 1)) : 0;
    }
}

/* What a patch is as a source: its reach and its pieces. */
static void source_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Adapting *a = context;
    const Patches *p = a->room->patches;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        const uint32_t pieces = p->first_piece[i + 1] - p->first_piece[i];
        const uint32_t last = p->first_corner[p->face_of[i] + (pieces > 0 ? pieces : 1)];
        double most = 0;
        for (uint32_t k = p->first_corner[p->face_of[i]]; k < last; k++) {
            const Vec3 way = vec3_sub(p->position[p->corner[k]], p->centre[i]);
            most = fmax(most, vec3_dot(way, way));
        }
        a->radius[i] = (float)sqrt(most);
        adapt_pieces(a->room, a->reflected, i, &a->piece[(size_t)i * ADAPT_PIECES]);
    }
}

static bool adapting_create(Adapting *a, unsigned threads, Error *err)
{
    static const char what[] = "the errors of patches";
    const AdaptOptions *o = a->options;
    const Patches *patches = a->room->patches;
    const size_t n = patches->count;
    a->row_rays = o->row_rays > 0 ? o->row_rays : DEFAULT_ROW_RAYS;
    a->sampler = array_create(threads, sizeof *a->sampler, what, err);
    a->point = array_create(n * ADAPT_POINTS, sizeof *a->point, what, err);
    a->points = array_create(n, sizeof *a->points, what, err);
    a->mean = array_create(n * VALUES, sizeof *a->mean, what, err);
    a->noise = array_create(2 * n, sizeof *a->noise, what, err);
    a->telling = array_create(n, sizeof *a->telling, what, err);
    a->vertex = array_create((size_t)patches->vertex_count * VALUES, sizeof *a->vertex, what, err);
    a->radius = array_create(n, sizeof *a->radius, what, err);
    a->piece = array_create(n * ADAPT_PIECES, sizeof *a->piece, what, err);
    a->sent = array_create(n, sizeof *a->sent, what, err);
    a->reflected = array_create(patches->vertex_count, sizeof *a->reflected, what, err);
    for (unsigned k = 0; k < threads && a->sampler != NULL; k++)
        adapt_sampler_create(&a->sampler[k], a->room, a->links, a->radius, a->piece,
                             o->rays > 0 ? o->rays : DEFAULT_RAYS, o->seed, err);
    return !error_is_set(err);
}

static void adapting_clear(Adapting *a, unsigned threads)
{
    for (unsigned k = 0; k < threads && a->sampler != NULL; k++)
        adapt_sampler_clear(&a->sampler[k]);
    array_free(a->sampler);
    array_free(a->point);
    array_free(a->points);
    array_free(a->mean);
    array_free(a->noise);
    array_free(a->telling);
    array_free(a->vertex);
    array_free(a->radius);
    array_free(a->piece);
    array_free(a->sent);
    array_free(a->reflected);
}

static bool run(Adapting *a, unsigned threads, const Monitor *monitor, Error *err)
{
    const Patches *patches = a->room->patches;
    if (!find_reflected(a, err))
        return false;
    if (!parallel_for(patches->count, MAKER_CHUNK, threads, source_chunk, a, monitor, NULL) ||
        !parallel_for(patches->count, MAKER_CHUNK, threads, sample_chunk, a, monitor, NULL))
        return error_set(err, ERROR_STOPPED, "stopped while looking for errors");
    for (unsigned k = 0; k < threads; k++)
        if (error_is_set(&a->sampler[k].error)) {
            *err = a->sampler[k].error;
            return false;
        }
    if (!vertex_radiosity(patches, a->links->area, VALUES, a->mean, a->vertex, err))
        return false;
    parallel_for(patches->count, MAKER_CHUNK, threads, error_chunk, a, NULL, NULL);
    return true;
}

bool adapt_errors(const Room *room, const Links *links, const double *irradiance,
                  const AdaptOptions *options, double *error, const Monitor *monitor, Error *err)
{
    if (error_is_set(err))
        return false;
    assert(room != NULL && links != NULL && irradiance != NULL && options != NULL);
    assert(links->count == room->patches->count && error != NULL);
    const unsigned threads = parallel_threads(options->threads);
    Adapting a = { .room = room, .links = links, .irradiance = irradiance, .options = options,
                   .error = error };
    const bool done = adapting_create(&a, threads, err) && run(&a, threads, monitor, err);
    adapting_clear(&a, threads);
    return done;
}
