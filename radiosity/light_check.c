/* SPDX-License-Identifier: BSD-3-Clause */
/* Paths back from single patches, against what was found there. */
#include "radiosity/light_check.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/stochastic_internal.h"
#include "radiosity/visible.h"

/* Paths traced together. A ray that came to a seam or the inside of a solid is cast anew this
 * often, as in shooting: even where half of them do, less than one in 10^3 is left. */
enum { CHECK_WAVE = 4096, CHECK_TRIES = 10 };

/* What stands for it in seeds: rays of paths, those to lamps, judging. */
enum { KIND_PATH, KIND_LAMP, KIND_JUDGE };

typedef struct {
    Vec3     point, normal; /* where it stands */
    Rgb      share;         /* of what comes there, that the patch gets */
    double   cosine;        /* of its ray, where it leaves */
    uint32_t index;
    uint16_t depth, tries;
} Path;

typedef struct {
    double direct, reflected;
} Come;

typedef struct {
    Path    *path;     /* [CHECK_WAVE] */
    Ray     *ray, *lamp_ray;
    Hit     *hit;
    bool    *blocked;
    double  *carried;  /* of a ray to a lamp, luminance */
    bool    *first;    /* it left the patch itself */
    RowCast  judge;
    uint32_t live, lamps;
    uint64_t cast;
} Wave;

/* A chosen patch: what was found there, and by paths in each half. */
typedef struct {
    uint32_t patch;
    Come     found, half[2];
} Pick;

typedef struct {
    const Room         *room;
    const Links        *links;
    const SolveProblem *problem;
    const LightCheckOptions *options;
    LampTable lamps;
    Wave     *wave;    /* [threads] */
    Pick     *pick;    /* [options->patches] */
} Check;

/* The patch whose light is followed now. */
typedef struct {
    const Check *check;
    Wave    *wave;
    uint64_t open;
    uint32_t patch, seed;
    uint32_t told;     /* paths whose first ray told something */
    Come     sum;
} Work;

static double luminance_of(const double *v)
{
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

static double carried(Rgb share, const double *light)
{
    return rgb_luminance(rgb_mul(share, rgb(light[0], light[1], light[2])));
}

static void come(Work *w, bool first, double light)
{
    *(first ? &w->sum.direct : &w->sum.reflected) += light;
}

/* --- rays ------------------------------------------------------------------------------------- */

/* The next ray of a path; on the patch itself from a new place each time. */
static void leave(Work *w, Path *p, Ray *ray)
{
    const Room *room = w->check->room;
    const uint32_t seed = sampling_seed(w->seed, KIND_PATH, p->depth, p->tries);
    float x[4];
    Vec3 u, v;
    sampling_sobol4(p->index, seed, x);
    if (p->depth == 0) {
        PatchPoint at;
        open_cells_place(room, w->open, w->patch, x, &at);
        p->point = at.point.point;
        p->normal = at.point.normal;
        p->share = rgb(at.weight, at.weight, at.weight);
    }
    const Vec3 local = sampling_cosine(x[2], x[3]);
    vec3_frame(p->normal, &u, &v);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(p->normal, local.z), local.x, u), local.y, v);
    p->cosine = local.z;
    *ray = ray_leaving(p->point, p->normal, room->offset, d, INFINITY);
}

/* Share of a ray to a lamp beside one over the hemisphere; densities per solid angle. */
static double lamp_share(double by_lamp, double by_ray)
{
    if (isinf(by_lamp))
        return 1;
    return by_lamp + by_ray > 0 ? by_lamp / (by_lamp + by_ray) : 0;
}

/* A ray from where the path stands to a lamp: on the patch itself from a place of its own. */
static void aim(Work *w, const Path *p)
{
    const Check *check = w->check;
    const Room *room = check->room;
    Wave *wave = w->wave;
    float x[4];
    double rest;
    PatchPoint to, from;
    if (check->lamps.count == 0)
        return;
    sampling_sobol4(p->index, sampling_seed(w->seed, KIND_LAMP, p->depth, 0), x);
    Vec3 point = p->point, normal = p->normal;
    Rgb share = p->share;
    if (p->depth == 0) {
        open_cells_place(room, w->open, w->patch, x, &from);
        point = from.point.point;
        normal = from.point.normal;
        share = rgb(from.weight, from.weight, from.weight);
    }
    const uint32_t lamp = lamp_table_choose(&check->lamps, x[2], &rest);
    patches_point(room->patches, room->surfaces, lamp, rest, x[3], &to);
    visible_move(room, &to);
    const Vec3 way = vec3_sub(to.point.point, point);
    const double distance = vec3_length(way);
    const double here = vec3_dot(way, normal), there = -vec3_dot(way, to.point.normal);
    if (!(here > 0 && there > 0 && distance > 2 * room->offset && to.weight > 0))
        return;
    const double by_lamp = check->lamps.probability[lamp] /
                           (room->patches->area[lamp] * to.weight) * distance * distance *
                           distance / there;
    const double by_ray = here / distance / M_PI;
    const double *emission = &check->problem->emission[(size_t)lamp * ROOM_BANDS];
    wave->lamp_ray[wave->lamps] = ray_between(point, normal, to.point.point, to.point.normal,
                                              room->offset);
    wave->first[wave->lamps] = p->depth == 0;
    wave->carried[wave->lamps++] = carried(share, emission) * lamp_share(by_lamp, by_ray) *
                                   by_ray / by_lamp;
}

/* What arrived on a path's ray; then the path stands there. False: it ends. */
static bool arrive(Work *w, Path *p, const RayEnd *end, const Ray *ray, const Hit *hit)
{
    const Check *check = w->check;
    const Room *room = check->room;
    const size_t at = (size_t)end->patch * ROOM_BANDS;
    const double *emission = &check->problem->emission[at];
    const double *rho = &check->problem->reflectance[at];
    const Vec3 way = vec3(ray->dx, ray->dy, ray->dz);
    if (emission[0] + emission[1] + emission[2] > 0) {
        const Vec3 n = surfaces_normal(room->surfaces, hit->primitive, hit->u, hit->v);
        const double by_lamp = check->lamps.count == 0 ? 0 :
            lamp_density(room, &check->lamps, end, hit->t, fabs(vec3_dot(n, way)));
        come(w, p->depth == 0,
             carried(p->share, emission) * (1 - lamp_share(by_lamp, p->cosine / M_PI)));
    }
    p->share = rgb_mul(p->share, rgb(rho[0], rho[1], rho[2]));
    const double most = fmax(p->share.r, fmax(p->share.g, p->share.b));
    const double stay = fmin(most, 1);
    float x[2];
    sampling_sobol2(p->index, sampling_seed(w->seed, KIND_JUDGE, p->depth, 0), x);
    if (!(x[0] < stay) || p->depth == UINT16_MAX)
        return false;
    p->share = rgb_scale(p->share, 1 / stay);
    if (check->problem->received != NULL)
        come(w, false, carried(p->share, &check->problem->received[at]));
    RoomHit place;
    room_hit(room, hit, way, &place);
    p->point = place.point;
    p->normal = place.normal;
    p->depth++;
    p->tries = 0;
    aim(w, p);
    return true;
}

/* One ray's end; false: its path ends. */
static bool take(Work *w, Path *p, const Ray *ray, const Hit *hit)
{
    const Room *room = w->check->room;
    RayEnd end = { .patch = PATCH_NONE };
    const bool met = hit->primitive != RAY_MISS;
    if (met)
        end.patch = room_patch(room, hit, vec3(ray->dx, ray->dy, ray->dz), &end.surface, &end.s,
                               &end.t);
    const bool gone = !met || (end.patch == PATCH_NONE && room->sides_given);
    if (!gone && (end.patch == PATCH_NONE || !(w->check->links->area[end.patch] > 0) ||
                  visible_at_seam(room, end.surface, end.s, end.t)))
        return ++p->tries < CHECK_TRIES;
    w->told += p->depth == 0;
    return !gone && arrive(w, p, &end, ray, hit);
}

static void trace_lamps(Work *w)
{
    Wave *wave = w->wave;
    bvh_blocked_many(w->check->room->bvh, wave->lamp_ray, wave->blocked, wave->lamps);
    for (uint32_t k = 0; k < wave->lamps; k++)
        if (!wave->blocked[k])
            come(w, wave->first[k], wave->carried[k]);
    wave->cast += wave->lamps;
    wave->lamps = 0;
}

/* `count` paths from index `first` on, to their ends. */
static void run_wave(Work *w, uint32_t first, uint32_t count)
{
    Wave *wave = w->wave;
    for (uint32_t k = 0; k < count; k++) {
        wave->path[k] = (Path){ .index = first + k };
        aim(w, &wave->path[k]);
    }
    trace_lamps(w);
    for (wave->live = count; wave->live > 0;) {
        const uint32_t tried = wave->live;
        for (uint32_t k = 0; k < tried; k++)
            leave(w, &wave->path[k], &wave->ray[k]);
        bvh_nearest_many(w->check->room->bvh, wave->ray, wave->hit, tried);
        wave->cast += tried;
        wave->live = 0;
        for (uint32_t k = 0; k < tried; k++)
            if (take(w, &wave->path[k], &wave->ray[k], &wave->hit[k]))
                wave->path[wave->live++] = wave->path[k];
        trace_lamps(w);
    }
}

/* --- patches ---------------------------------------------------------------------------------- */

static void follow(const Check *check, Wave *wave, Pick *pick, uint32_t seed, unsigned half,
                   uint64_t open)
{
    const uint32_t rays = check->options->rays;
    const double *received = check->problem->received;
    Work w = { .check = check, .wave = wave, .open = open, .patch = pick->patch,
               .seed = sampling_seed(seed, half, 1, 0) };
    Come came = { 0, 0 };
    /* Sums of a wave are added to the whole, and rounding does not grow with the number of rays. */
    for (uint32_t first = 0; first < rays; first += CHECK_WAVE) {
        w.sum = (Come){ 0, 0 };
        run_wave(&w, first, rays - first < CHECK_WAVE ? rays - first : CHECK_WAVE);
        came.direct += w.sum.direct;
        came.reflected += w.sum.reflected;
    }
    const double share = w.told > 0 ? 1.0 / rays : 0;
    pick->half[half].direct = came.direct * share;
    pick->half[half].reflected = came.reflected * share;
    if (received != NULL)
        pick->half[half].direct += luminance_of(&received[(size_t)pick->patch * ROOM_BANDS]);
}

static void check_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Check *check = context;
    Wave *wave = &check->wave[worker];
    for (uint32_t k = begin; k < end; k++) {
        Pick *pick = &check->pick[k];
        const uint32_t seed = sampling_seed(check->options->seed, SEED_CHECK, k, 0);
        const uint64_t open = open_cells_judge(&wave->judge, check->room, pick->patch, seed);
        for (unsigned h = 0; h < 2; h++)
            follow(check, wave, pick, seed, h, open != 0 ? open : UINT64_MAX);
    }
}

/* By one comb over all areas. */
static void choose(Check *check)
{
    const Links *links = check->links;
    const uint32_t count = check->options->patches;
    double all = 0, before = 0;
    float x[2];
    uint32_t next = 0, last = 0;
    for (uint32_t i = 0; i < links->count; i++)
        all += links->area[i];
    sampling_sobol2(0, sampling_seed(check->options->seed, SEED_CHECK, 0, 1), x);
    for (uint32_t i = 0; i < links->count && all > 0; i++) {
        before += links->area[i];
        last = links->area[i] > 0 ? i : last;
        while (next < count && (next + (double)x[0]) / count * all < before)
            check->pick[next++].patch = i;
    }
    for (; next < count; next++) /* that rounding of the sums left */
        check->pick[next].patch = last;
}

/* What the solution says of the chosen patches; false: of direct light alone it says nothing. */
static bool look_up(Check *check, const Solution *solution, LinksScratch *scratch)
{
    const SolveProblem *p = check->problem;
    const bool rows = check->links->first[check->links->count] > 0;
    for (uint32_t k = 0; k < check->options->patches; k++) {
        Pick *pick = &check->pick[k];
        const size_t at = (size_t)pick->patch * ROOM_BANDS;
        double direct[ROOM_BANDS] = { 0 };
        if (solution->direct != NULL) {
            memcpy(direct, &solution->direct[at], sizeof direct);
        } else if (rows) {
            const LinksRow row = links_row(check->links, pick->patch, scratch);
            for (unsigned b = 0; b < ROOM_BANDS; b++)
                direct[b] = p->received != NULL ? p->received[at + b] : 0;
            for (uint64_t m = 0; m < row.count; m++)
                for (unsigned b = 0; b < ROOM_BANDS; b++)
                    direct[b] += row.form_factor[m] *
                                 p->emission[(size_t)row.source[m] * ROOM_BANDS + b];
        }
        pick->found.direct = luminance_of(direct);
        pick->found.reflected = luminance_of(&solution->irradiance[at]) - pick->found.direct;
    }
    return rows || solution->direct != NULL;
}

/* --- figures ---------------------------------------------------------------------------------- */

static LightError make_error(const double *square, uint32_t count, double mean)
{
    double sum = 0, scatter = 0;
    for (uint32_t k = 0; k < count; k++)
        sum += square[k] / count;
    for (uint32_t k = 0; k < count; k++)
        scatter += (square[k] - sum) * (square[k] - sum);
    if (!(mean > 0))
        return (LightError){ sum > 0 ? INFINITY : 0, 0 };
    const double off = count > 1 ? sqrt(scatter / count / (count - 1)) : INFINITY;
    const double least = fmax(sum, 0);
    return (LightError){ sqrt(least) / mean, (sqrt(least + off) - sqrt(least)) / mean };
}

static int by_size_down(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p < q) - (p > q);
}

/* Sorts the squares. */
static double worst_share(double *square, uint32_t count)
{
    const uint32_t few = (count + 99) / 100;
    double all = 0, some = 0;
    qsort(square, count, sizeof *square, by_size_down);
    for (uint32_t k = 0; k < count; k++) {
        all += square[k];
        some += k < few ? square[k] : 0;
    }
    return all > 0 ? fmin(some / all, 1) : 0;
}

static void sum_up(const Check *check, double *square, LightCheck *out)
{
    const uint32_t count = check->options->patches;
    for (uint32_t k = 0; k < count; k++)
        for (unsigned h = 0; h < 2; h++)
            out->mean += (check->pick[k].half[h].direct + check->pick[k].half[h].reflected) / 2 /
                         count;
    LightError *const error[] = { &out->direct, &out->reflected, &out->all };
    for (unsigned kind = 0; kind < 3; kind++) {
        const double direct = kind != 1, reflected = kind != 0;
        for (uint32_t k = 0; k < count; k++) {
            const Pick *p = &check->pick[k];
            double off[2];
            for (unsigned h = 0; h < 2; h++)
                off[h] = direct * (p->found.direct - p->half[h].direct) +
                         reflected * (p->found.reflected - p->half[h].reflected);
            square[k] = off[0] * off[1];
        }
        *error[kind] = make_error(square, count, out->mean);
    }
    out->worst = worst_share(square, count);
}

static void wave_clear(Wave *w)
{
    array_free(w->path);
    array_free(w->ray);
    array_free(w->lamp_ray);
    array_free(w->hit);
    array_free(w->blocked);
    array_free(w->carried);
    array_free(w->first);
    row_cast_clear(&w->judge);
}

static bool wave_create(Wave *w, Error *err)
{
    static const char what[] = "paths";
    w->path = array_create(CHECK_WAVE, sizeof *w->path, what, err);
    w->ray = array_create(CHECK_WAVE, sizeof *w->ray, what, err);
    w->lamp_ray = array_create(CHECK_WAVE, sizeof *w->lamp_ray, what, err);
    w->hit = array_create(CHECK_WAVE, sizeof *w->hit, what, err);
    w->blocked = array_create(CHECK_WAVE, sizeof *w->blocked, what, err);
    w->carried = array_create(CHECK_WAVE, sizeof *w->carried, what, err);
    w->first = array_create(CHECK_WAVE, sizeof *w->first, what, err);
    return !error_is_set(err) && row_cast_create(&w->judge, OPEN_RAYS, 0, err);
}

bool light_check(const Room *room, const Links *links, const SolveProblem *problem,
                 const Solution *solution, const LightCheckOptions *options, LightCheck *out,
                 const Monitor *monitor, Error *err)
{
    assert(room->patches != NULL && !room->mirrors && options->patches > 0 && options->rays > 0);
    assert(problem->bands == ROOM_BANDS && links->count == room->patches->count);
    const unsigned threads = parallel_threads(options->threads);
    const Progress progress = { .stage = "check", .energy_left = -1 };
    Check check = { .room = room, .links = links, .problem = problem, .options = options };
    LinksScratch scratch = { NULL, NULL };
    *out = (LightCheck){ .patches = options->patches, .rays = options->rays };
    check.pick = array_create(options->patches, sizeof *check.pick, "patches to check", err);
    check.wave = array_create(threads, sizeof *check.wave, "paths", err);
    double *square = array_create(options->patches, sizeof *square, "patches to check", err);
    bool done = !error_is_set(err) && links_scratch_create(links, &scratch, err) &&
                lamp_table_create(room, &check.lamps, err);
    for (unsigned k = 0; k < threads && done; k++)
        done = wave_create(&check.wave[k], err);
    if (done) {
        choose(&check);
        out->apart = look_up(&check, solution, &scratch);
        done = parallel_for(options->patches, 1, threads, check_chunk, &check, monitor,
                            &progress) ||
               error_set(err, ERROR_STOPPED, "stopped while checking light");
    }
    if (done)
        sum_up(&check, square, out);
    for (unsigned k = 0; k < threads && check.wave != NULL; k++) {
        out->cast += check.wave[k].cast + check.wave[k].judge.cast;
        wave_clear(&check.wave[k]);
    }
    links_scratch_clear(&scratch);
    lamp_table_clear(&check.lamps);
    array_free(check.pick);
    array_free(check.wave);
    array_free(square);
    return done;
}
