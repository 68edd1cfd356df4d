/* SPDX-License-Identifier: BSD-3-Clause */
/* First light: straight from lamps and lights by a few rays per patch, what follows estimated; then
 * shot on from patch to patch, the brightest first [cohen88]. */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "app/live.h"
#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/mirrors.h"

enum {
    LAMP_SAMPLES = 16,   /* rays of a patch to lamps */
    GLANCE_SAMPLES = 4,  /* the same at a glance */
    GLANCE_PATCHES = 40000, /* wanted; triangles smaller than these stay as they are */
    GLANCE_SURFACES = 50000, /* with fewer a glance saves no time worth speaking of */
    LIGHT_SAMPLES = 4,   /* and to each point light */
    CHUNK = 128,         /* patches whose rays go together */
    SHOT_RAYS = 1024,
    SHOWN_RAYS = 200     /* of a shot */
};

/* A place in a lamp lies in [0, 1). */
static const double BELOW_ONE = 1 - DBL_EPSILON;

/* Links bring the rest: shooting stops when so little is left, or after so long. */
static const double UNSHOT_ENOUGH = 0.02, SHOOTING_SECONDS = 1.5;

typedef struct {
    Live      *live;
    const Room *room;
    uint32_t   count;
    double    *emission, *reflectance;   /* [3 * count] */
    double    *direct;                   /* irradiance straight from lamps and lights */
    double    *received;                 /* irradiance by all that was shot, direct included */
    double    *unshot;                   /* exitance not yet passed on */
    double    *shown;                    /* radiosity with the estimate */
    uint32_t  *lamp;                     /* [lamps] */
    double    *upto;                     /* [lamps]  share of all power up to and with it */
    uint32_t   lamps, samples;
    double     power, at_first;          /* of lamps; luminance: all that was sent out */
    Ray       *ray;                      /* [SHOT_RAYS] */
    Hit       *hit;
    Vec3       ends[2 * SHOWN_RAYS];
    uint32_t   ray_count, shooter, shots;
} Shooting;

static double luminance_at(const double *value, uint32_t i)
{
    return rgb_luminance(rgb(value[3 * (size_t)i], value[3 * (size_t)i + 1],
                             value[3 * (size_t)i + 2]));
}

/* --- room ------------------------------------------------------------------------------------- */

static void clear(Shooting *s)
{
    array_free(s->emission);
    array_free(s->reflectance);
    array_free(s->direct);
    array_free(s->received);
    array_free(s->unshot);
    array_free(s->shown);
    array_free(s->lamp);
    array_free(s->upto);
    array_free(s->ray);
    array_free(s->hit);
    array_free(s);
}

static Shooting *create(Live *live, Error *err)
{
    Shooting *s = array_create(1, sizeof *s, "first light", err);
    if (s == NULL)
        return NULL;
    s->live = live;
    s->room = &live->pipeline->room;
    s->count = s->room->patches->count;
    s->shooter = PATCH_NONE;
    s->samples = LAMP_SAMPLES;
    const size_t n = 3 * (size_t)s->count;
    s->emission = array_create(n, sizeof(double), "first light", err);
    s->reflectance = array_create(n, sizeof(double), "first light", err);
    s->direct = array_create(n, sizeof(double), "first light", err);
    s->received = array_create(n, sizeof(double), "first light", err);
    s->unshot = array_create(n, sizeof(double), "first light", err);
    s->shown = array_create(n, sizeof(double), "first light", err);
    s->lamp = array_create(s->count, sizeof *s->lamp, "first light", err);
    s->upto = array_create(s->count, sizeof *s->upto, "first light", err);
    s->ray = array_create(SHOT_RAYS, sizeof *s->ray, "first light", err);
    s->hit = array_create(SHOT_RAYS, sizeof *s->hit, "first light", err);
    if (error_is_set(err)) {
        clear(s);
        return NULL;
    }
    return s;
}

static void list_lamps(Shooting *s)
{
    const Patches *patches = s->room->patches;
    for (uint32_t i = 0; i < s->count; i++) {
        Rgb e, rho;
        mirrors_problem(s->room, i, &e, &rho);
        memcpy(s->emission + 3 * (size_t)i, (double[]){ e.r, e.g, e.b }, sizeof(double[3]));
        memcpy(s->reflectance + 3 * (size_t)i, (double[]){ rho.r, rho.g, rho.b },
               sizeof(double[3]));
        const double power = rgb_luminance(e) * patches->area[i];
        if (!(power > 0))
            continue;
        s->power += power;
        s->lamp[s->lamps] = i;
        s->upto[s->lamps++] = s->power;
    }
}

/* --- direct light ----------------------------------------------------------------------------- */

/* The lamp that a number in 0..1 chooses, by power; *u gets what the choice leaves of it. */
static uint32_t choose_lamp(const Shooting *s, double *u)
{
    assert(s->lamps > 0 && s->power > 0);
    const double at = *u * s->power;
    uint32_t lo = 0, hi = s->lamps - 1;
    while (lo < hi) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (s->upto[middle] > at)
            hi = middle;
        else
            lo = middle + 1;
    }
    const double before = lo > 0 ? s->upto[lo - 1] : 0;
    *u = fmin(fmax((at - before) / (s->upto[lo] - before), 0), BELOW_ONE);
    return lo;
}

/* A ray from patch i to a lamp, and the irradiance it stands for when nothing is in its way. */
static Ray lamp_ray(const Shooting *s, uint32_t i, uint32_t sample, Rgb *light)
{
    static const double PI = 3.14159265358979323846;
    const Patches *patches = s->room->patches;
    float here[4], there[2];
    PatchPoint from, to;
    sampling_sobol4(sample, sampling_seed(i, 1, 0, 0), here);
    sampling_sobol2(sample, sampling_seed(i, 2, 0, 0), there);
    double u = (double)here[2];
    const uint32_t k = choose_lamp(s, &u), lamp = s->lamp[k];
    patches_point(patches, s->room->surfaces, i, (double)here[0], (double)here[1], &from);
    patches_point(patches, s->room->surfaces, lamp, u, (double)there[0], &to);
    const Vec3 way = vec3_sub(to.point.point, from.point.point);
    const double d2 = vec3_dot(way, way);
    const double a = vec3_dot(from.point.normal, way), b = -vec3_dot(to.point.normal, way);
    const double share = (s->upto[k] - (k > 0 ? s->upto[k - 1] : 0)) / s->power;
    const double *e = s->emission + 3 * (size_t)lamp;
    *light = rgb(0, 0, 0);
    if (a > 0 && b > 0 && lamp != i) {
        /* No factor is above 1: without that limit one near point would outshine a room. */
        const double factor = fmin(1, a * b * patches->area[lamp] / (PI * d2 * d2));
        *light = rgb_scale(rgb(e[0], e[1], e[2]), factor / (share * s->samples));
    }
    return ray_between(from.point.point, from.point.normal, to.point.point, to.point.normal,
                       s->room->offset);
}

static void light_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Shooting *s = context;
    Ray ray[CHUNK * LAMP_SAMPLES] = { 0 };
    Rgb light[CHUNK * LAMP_SAMPLES];
    bool blocked[CHUNK * LAMP_SAMPLES];
    const uint32_t n = (end - begin) * s->samples;
    (void)worker;
    assert(n > 0 && n <= CHUNK * LAMP_SAMPLES);
    for (uint32_t k = 0; k < n; k++)
        ray[k] = lamp_ray(s, begin + k / s->samples, k % s->samples, &light[k]);
    bvh_blocked_many(s->room->bvh, ray, blocked, n);
    for (uint32_t k = 0; k < n; k++) {
        double *out = s->direct + 3 * (size_t)(begin + k / s->samples);
        if (blocked[k])
            continue;
        out[0] += light[k].r;
        out[1] += light[k].g;
        out[2] += light[k].b;
    }
}

/* Point lights, by the same code as later; it asks links for visible areas. */
static bool add_lights(Shooting *s, Error *err)
{
    const Settings *settings = &s->live->pipeline->session->settings;
    const DirectOptions options = { .samples = LIGHT_SAMPLES, .seed = settings->seed,
                                    .threads = settings->threads };
    Direct direct = { 0 };
    if (s->room->light_count == 0)
        return true;
    Links *links = links_empty(s->count, 0, err);
    if (links == NULL)
        return false;
    memcpy(links->area, s->room->patches->area, s->count * sizeof *links->area);
    const bool done = direct_create(s->room, links, &options, &direct,
                                    &s->live->pipeline->session->monitor, err);
    for (size_t i = 0; done && i < 3 * (size_t)s->count; i++)
        s->direct[i] += direct.irradiance[i];
    array_free(direct.irradiance);
    links_destroy(links);
    return done;
}

static bool find_direct(Shooting *s, Error *err)
{
    const Session *session = s->live->pipeline->session;
    list_lamps(s);
    if (s->lamps > 0 && !parallel_for(s->count, CHUNK, session->settings.threads, light_chunk, s,
                                      &session->monitor, NULL))
        return error_set(err, ERROR_STOPPED, "stopped");
    if (!add_lights(s, err))
        return false;
    for (uint32_t i = 0; i < s->count; i++) {
        for (size_t k = 3 * (size_t)i; k < 3 * (size_t)i + 3; k++) {
            s->received[k] = s->direct[k];
            s->unshot[k] = s->reflectance[k] * s->direct[k];
        }
        s->at_first += luminance_at(s->unshot, i) * s->room->patches->area[i];
    }
    return true;
}

/* --- publishing ------------------------------------------------------------------------------- */

/* What is not yet shot, as if it came to all patches alike: its mean, and what that becomes by
 * being reflected again and again. Returns the share of power that is unshot. */
static double estimate(Shooting *s)
{
    const double *area = s->room->patches->area;
    double waiting[3] = { 0 }, back[3] = { 0 }, all = 0, left = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        all += area[i];
        left += luminance_at(s->unshot, i) * area[i];
        for (unsigned k = 0; k < 3; k++) {
            waiting[k] += s->unshot[3 * (size_t)i + k] * area[i];
            back[k] += s->reflectance[3 * (size_t)i + k] * area[i];
        }
    }
    for (unsigned k = 0; k < 3; k++)
        waiting[k] = waiting[k] / all / (1 - fmin(back[k] / all, 0.95));
    for (uint32_t i = 0; i < s->count; i++)
        for (size_t k = 0; k < 3; k++) {
            const size_t at = 3 * (size_t)i + k;
            s->shown[at] = s->emission[at] +
                           s->reflectance[at] * (s->received[at] + waiting[k]);
        }
    return s->at_first > 0 ? left / s->at_first : 0;
}

static bool publish(Shooting *s, Error *err)
{
    const LiveLight light = { .radiosity = s->shown, .irradiance = s->received,
                              .direct = s->direct, .unshot = s->unshot,
                              .visible_area = s->room->patches->area, .shooter = s->shooter,
                              .ray = s->ends, .ray_count = s->ray_count };
    s->live->report.unshot = estimate(s);
    s->live->report.steps = s->shots;
    live_report(s->live);
    return live_publish(s->live, &light, err);
}

/* --- shooting --------------------------------------------------------------------------------- */

static uint32_t brightest(const Shooting *s)
{
    uint32_t best = 0;
    double most = -1;
    for (uint32_t i = 0; i < s->count; i++) {
        const double power = luminance_at(s->unshot, i) * s->room->patches->area[i];
        if (power > most) {
            most = power;
            best = i;
        }
    }
    return best;
}

static void cast(Shooting *s, uint32_t shooter)
{
    for (uint32_t k = 0; k < SHOT_RAYS; k++) {
        float u[4];
        PatchPoint at;
        Vec3 a, b;
        sampling_sobol4(k, sampling_seed(shooter, s->shots, 3, 0), u);
        patches_point(s->room->patches, s->room->surfaces, shooter, (double)u[0], (double)u[1],
                      &at);
        const Vec3 local = sampling_cosine((double)u[2], (double)u[3]), n = at.point.normal;
        vec3_frame(n, &a, &b);
        const Vec3 d = vec3_mad(vec3_mad(vec3_scale(n, local.z), local.x, a), local.y, b);
        s->ray[k] = ray_leaving(at.point.point, n, s->room->offset, d, INFINITY);
    }
    bvh_nearest_many(s->room->bvh, s->ray, s->hit, SHOT_RAYS);
    s->live->report.rays += SHOT_RAYS;
}

static void shoot(Shooting *s)
{
    const Patches *patches = s->room->patches;
    const uint32_t from = brightest(s);
    assert(from < s->count);
    double power[3];
    for (unsigned k = 0; k < 3; k++) {
        power[k] = s->unshot[3 * (size_t)from + k] * patches->area[from] / SHOT_RAYS;
        s->unshot[3 * (size_t)from + k] = 0;
    }
    s->shooter = from;
    s->ray_count = 0;
    cast(s, from);
    for (uint32_t r = 0; r < SHOT_RAYS; r++) {
        RoomHit to;
        if (s->hit[r].primitive == RAY_MISS)
            continue;
        const Vec3 d = vec3((double)s->ray[r].dx, (double)s->ray[r].dy, (double)s->ray[r].dz);
        room_hit(s->room, &s->hit[r], d, &to);
        if (to.patch == PATCH_NONE)
            continue;
        for (size_t k = 0; k < 3; k++) {
            const size_t at = 3 * (size_t)to.patch + k;
            s->received[at] += power[k] / patches->area[to.patch];
            s->unshot[at] += s->reflectance[at] * power[k] / patches->area[to.patch];
        }
        if (r < SHOWN_RAYS) {
            s->ends[2 * s->ray_count] = vec3((double)s->ray[r].ox, (double)s->ray[r].oy,
                                             (double)s->ray[r].oz);
            s->ends[2 * s->ray_count++ + 1] = to.point;
        }
    }
    s->shots++;
}

static bool shoot_on(Shooting *s, Error *err)
{
    double worked = 0;
    while (worked < SHOOTING_SECONDS && (s->shots == 0 || s->live->report.unshot > UNSHOT_ENOUGH)) {
        if (!live_step(s->live))
            return error_set(err, ERROR_STOPPED, "stopped");
        const double begin = progress_now();
        s->live->report.done = worked / SHOOTING_SECONDS;
        shoot(s);
        if (live_due(s->live) && !publish(s, err))
            return false;
        worked += progress_now() - begin;
    }
    s->live->step = STEP_SHOT;
    s->ray_count = 0;
    s->shooter = PATCH_NONE;
    return publish(s, err);
}

bool live_shoot(Live *live, Error *err)
{
    Shooting *s = create(live, err);
    if (s == NULL)
        return false;
    live_begin(live, "first light", STEP_LIT);
    bool done = find_direct(s, err) && publish(s, err);
    if (done && s->at_first > 0) {
        live_begin(live, "shooting", STEP_LIT);
        done = shoot_on(s, err);
    }
    clear(s);
    return done;
}

/* --- a glance --------------------------------------------------------------------------------- */

/* Sides that the eye is before, and both of what is large: whoever walks about sees walls. */
static void face_eye(const Pipeline *p, uint8_t *sides)
{
    static const double LARGE = 1e-5; /* of all area */
    const Surfaces *surfaces = p->surfaces;
    double all = 0;
    for (uint32_t i = 0; i < surfaces->count; i++)
        all += surfaces->surface[i].area;
    for (uint32_t i = 0; i < surfaces->count; i++) {
        SurfacePoint at;
        surfaces_point(surfaces, i, 1.0 / 3, 1.0 / 3, &at);
        const bool flat = surfaces->surface[i].kind != SURFACE_SHAPE;
        const bool front = vec3_dot(at.normal, vec3_sub(p->camera.eye, at.point)) > 0;
        sides[i] = !flat || surfaces->surface[i].area > LARGE * all ? 3 : front ? 1 : 2;
    }
}

static bool glance(Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    const PatchOptions po = { .wanted = GLANCE_PATCHES, .sides = p->sides,
                              .emitting = p->emitting, .separate = true };
    p->patches = patches_create(p->surfaces, &po, &p->session->monitor, err);
    if (p->patches == NULL)
        return false;
    pipeline_room(p);
    Shooting *s = create(live, err);
    if (s == NULL)
        return false;
    s->samples = GLANCE_SAMPLES;
    live_begin(live, "first light", STEP_LIT);
    const bool done = find_direct(s, err) && publish(s, err);
    clear(s);
    return done;
}

bool live_glance(Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    const uint32_t count = p->surfaces->count;
    if (count < GLANCE_SURFACES)
        return true;
    p->sides = array_create(count, 1, "sides", err);
    p->emitting = array_create(count, 1, "sides", err);
    p->skin = mirrors_skins(p->surfaces, p->scene->polygons.materials, err);
    bool done = !error_is_set(err);
    if (done) {
        face_eye(p, p->sides);
        memset(p->emitting, 3, count); /* which way lamps shine is found with the sides */
        done = glance(live, err);
    }
    live->mesh = shown_mesh_leave(live->mesh);
    live->carry = vertex_carry_destroy(live->carry);
    live->patches = NULL;
    live_forget(live);
    p->patches = patches_destroy(p->patches);
    p->sides = array_free(p->sides);
    p->emitting = array_free(p->emitting);
    p->skin = array_free(p->skin);
    p->room = (Room){ 0 };
    return done;
}
