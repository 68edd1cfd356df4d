/* SPDX-License-Identifier: BSD-3-Clause */
/* Light at many points: lamp samples with controls, cosine rays, a step further near corners. */
#include "render/wave.h"

#include <assert.h>
#include <float.h>
#include <string.h>

#include "math/sampling.h"
#include "math/tolerance.h"
#include "radiosity/mirrors.h"
#include "radiosity/places.h"
#include "radiosity/visible.h"
#include "render/clear.h"
#include "render/normals.h"
#include "render/records.h"
#include "render/specular.h"
#include "render/split.h"

/* Purposes of the sequences drawn from one seed. */
enum { SEED_LAMP = 1, SEED_LIGHT, SEED_DIRECTION, SEED_RAMP, SEED_IMAGE };

static uint32_t seed_of(uint32_t seed, uint32_t purpose, unsigned level)
{
    return sampling_mix(seed ^ (purpose + 16 * level) * 0x9e3779b9U);
}

/* The room's offset covers points inside its bounds; a free point or a camera's may lie far off,
 * where float is coarser. */
double wave_offset(const Room *room, Vec3 p)
{
    const double x = fabs(p.x), y = fabs(p.y), z = fabs(p.z), xy = x > y ? x : y;
    const double offset = ray_offset(xy > z ? xy : z);
    return offset > room->offset ? offset : room->offset;
}

static void add_to(Wave *wave, const WavePoint *point, unsigned level, Rgb irradiance)
{
    Rgb *sum = level == 0 ? &wave->direct[point->root] : &wave->indirect[point->root];
    *sum = rgb_add(*sum, rgb_mul(point->weight, irradiance));
}

/* Where light of a point's root goes, group by group. */
static Rgb *split_sums(const Wave *wave, const WavePoint *point, const WaveOptions *options)
{
    return options->split + (size_t)point->root * (wave->gatherer->split->count + 1);
}

/* Share of the light along ray k that its point's smooth normal keeps. */
static double share_of(const Wave *wave, unsigned level, uint32_t k)
{
    const Receiver *at = &wave->point[level][wave->owner[k]].at;
    const Ray      *ray = &wave->ray[k];
    if (at->normal.x == at->face.x && at->normal.y == at->face.y && at->normal.z == at->face.z)
        return 1;
    return normals_share(vec3_unit(vec3(ray->dx, ray->dy, ray->dz)), at->normal, at->face);
}

/* --- lamps ----------------------------------------------------------------------------------- */

/* A sum of WAVE_RAYS numbers in double less one of them is off by less than this share of it. */
static const double SUM_RESIDUE = WAVE_RAYS * DBL_EPSILON;

static LampPlan plan_of(const Wave *wave, unsigned level, uint32_t point,
                        const WaveOptions *options)
{
    const uint32_t rays = point < wave->gathered ? options->gather_rays : 0;
    return (LampPlan){ .lamp_rays = level == 0 ? options->lamp_rays : 1,
                       .gather_rays = level == 0 ? rays : 1 };
}

/* Fills wave->sample and wave->ray from `begin` lamp rays on; returns how many; entry e belongs to
 * point e / rays. */
static uint32_t aim_block(Wave *wave, unsigned level, uint32_t begin, uint32_t end, uint32_t rays,
                          const WaveOptions *options, bool lights)
{
    const Gatherer *g = wave->gatherer;
    const uint32_t  seed = seed_of(options->seed, lights ? SEED_LIGHT : SEED_LAMP, level);
    uint32_t        n = 0;
    for (uint32_t e = begin; e < end; e++) {
        const WavePoint *p = &wave->point[level][e / rays];
        const LampPlan   plan = plan_of(wave, level, e / rays, options);
        float            u[2];
        sampling_sobol2(p->index * rays + e % rays, seed ^ p->seed, u);
        LampSample *s = &wave->sample[n];
        const bool  any = lights ? lamps_sample_light(&g->lamps, &p->at, u[0], s)
                                 : lamps_sample(&g->lamps, &p->at, &plan, u[0], u[1], s);
        if (!any)
            continue;
        wave->owner[n] = e / rays;
        wave->ray[n] = ray_between(p->at.point, p->at.face, s->point, s->normal,
                                   wave_offset(g->room, p->at.point));
        n++;
    }
    return n;
}

/* What of each lamp sample arrives; nearly always all or nothing. */
static void cast_shadows(Wave *wave, unsigned level, uint32_t n, const WaveOptions *options)
{
    const Gatherer *g = wave->gatherer;
    const bool      clear = options->clear && g->clear;
    bvh_blocked_many(g->room->bvh, wave->ray, wave->blocked, n);
    wave->rays += n;
    for (uint32_t i = 0; i < n; i++)
        wave->pass[i] = !wave->blocked[i] ? rgb(1, 1, 1)
                        : clear           ? clear_between(g->room, &wave->ray[i])
                                          : rgb(0, 0, 0);
    for (uint32_t i = 0; i < n && level == 0; i++)
        wave->pass[i] = rgb_scale(wave->pass[i], share_of(wave, level, i));
}

/* Sums of luminance over lamp samples: what would arrive at most, and what does. */
typedef struct {
    double   all, lit;
    uint32_t count;
} LampSum;

/* Of fewer samples than this the share that arrives is that of all, the corrected one included:
 * one that is 0 by chance, most of the lamp being below the horizon, would else spoil the other.
 * The sum is then the closed form times that share, off by at most about 1/n of the covariance of
 * light and shadow too. */
enum { CONTROL_FEW = 16 };

static void sum_groups(const Wave *wave, unsigned level, uint32_t n, LampSum *sum)
{
    for (uint32_t i = 0; i < n; i++) {
        LampSum *s = &sum[level == 0 ? wave->point[0][wave->owner[i]].group : 0];
        s->count++;
        s->all += rgb_luminance(wave->sample[i].value);
        s->lit += rgb_luminance(rgb_mul(wave->pass[i], wave->sample[i].value));
    }
}

/* Sums a block of lamp samples. Of sample i, of which the share v arrives, worth u, expected a:
 * v u + b (a - u), b the share of all other samples of its group that arrives; deeper levels, where
 * a block may be a single sample, count the share of level 0 as one sample more. */
static void add_block(Wave *wave, unsigned level, uint32_t n, uint32_t rays,
                      const WaveOptions *options)
{
    LampSum sum[WAVE_POINTS] = { { 0 } }, whole = { 0 };
    sum_groups(wave, level, n, sum);
    for (uint32_t k = 0; k < (level == 0 ? WAVE_POINTS : 1); k++) {
        whole.all += sum[k].all;
        whole.lit += sum[k].lit;
    }
    const double prior = level > 0 && wave->lit_known ? whole.all / n : 0;
    for (uint32_t i = 0; i < n; i++) {
        const LampSample *s = &wave->sample[i];
        const WavePoint  *p = &wave->point[level][wave->owner[i]];
        const LampSum    *all = &sum[level == 0 ? p->group : 0];
        const Rgb    arrives = rgb_mul(wave->pass[i], s->value);
        const bool   few = level == 0 && all->count < CONTROL_FEW;
        const double others = all->all + prior - (few ? 0 : rgb_luminance(s->value));
        const double others_lit = all->lit + prior * wave->lit_share -
                                  (few ? 0 : rgb_luminance(arrives));
        /* Rounding of the sums leaves a residue where the others are nothing. */
        const double b = others > whole.all * SUM_RESIDUE
                             ? fmin(fmax(others_lit / others, 0), 1)
                             : few && whole.all > 0 ? whole.lit / whole.all : 0;
        const Rgb    e = rgb_mad(arrives, b, rgb_mad(s->control, -1, s->value));
        add_to(wave, p, level, rgb_scale(e, 1.0 / rays));
        if (options->split != NULL)
            split_sample(wave->gatherer, &p->at, s, arrives, b, rgb_scale(p->weight, 1.0 / rays),
                         split_sums(wave, p, options));
    }
    if (level == 0 && whole.all > 0) {
        wave->lit_share = whole.lit / whole.all;
        wave->lit_known = true;
    }
}

static void receive_lamps(Wave *wave, unsigned level, uint32_t count, const WaveOptions *options,
                          bool lights)
{
    const uint32_t rays = level == 0 ? options->lamp_rays : 1;
    for (uint32_t begin = 0; begin < count * rays; begin += WAVE_RAYS) {
        const uint32_t left = count * rays - begin;
        const uint32_t n =
            aim_block(wave, level, begin, begin + (left < WAVE_RAYS ? left : WAVE_RAYS), rays,
                      options, lights);
        if (n == 0)
            continue;
        cast_shadows(wave, level, n, options);
        add_block(wave, level, n, rays, options);
    }
}

/* One sample of lamps, or of lights, for a point's image in a plane: the e-th of the level. */
static void add_image(Wave *wave, unsigned level, uint32_t e, uint32_t rays, uint32_t plane,
                      const WaveOptions *options, bool lights)
{
    const Gatherer  *g = wave->gatherer;
    const WavePoint *p = &wave->point[level][e / rays];
    const LampPlan   plan = plan_of(wave, level, e / rays, options);
    const uint32_t   seed = seed_of(options->seed, SEED_IMAGE + plane, level);
    Receiver         image;
    LampSample       s;
    float            u[2];
    if (!images_receiver(g->room, &g->images.plane[plane], &p->at, &image))
        return;
    sampling_sobol2(p->index * rays + e % rays, seed ^ p->seed, u);
    if (lights ? !lamps_sample_light(&g->lamps, &image, u[0], &s)
               : !lamps_sample(&g->lamps, &image, &plan, u[0], u[1], &s))
        return;
    Rgb pass = images_pass(&g->images, g->room, plane, &p->at, &s, g->clear, &wave->rays);
    if (!(rgb_max(pass) > 0))
        return;
    if (level == 0)
        pass = rgb_scale(pass, normals_share(vec3_unit(vec3_sub(s.point, image.point)),
                                             image.normal, image.face));
    const Rgb arrives = rgb_mul(pass, s.value);
    add_to(wave, p, level, rgb_scale(arrives, 1.0 / rays));
    s.value = rgb(0, 0, 0); /* no control */
    if (options->split != NULL)
        split_sample(g, &p->at, &s, arrives, 0, rgb_scale(p->weight, 1.0 / rays),
                     split_sums(wave, p, options));
}

/* Light of lamps, or of point lights, by way of flat mirrors. */
static void receive_images(Wave *wave, unsigned level, uint32_t count, const WaveOptions *options,
                           bool lights)
{
    const uint32_t rays = level == 0 ? options->lamp_rays : 1;
    for (uint32_t plane = 0; options->clear && plane < wave->gatherer->images.count; plane++)
        for (uint32_t e = 0; e < count * rays; e++)
            add_image(wave, level, e, rays, plane, options, lights);
}

/* Points so near to one that was read, in shares of the circle that its photons lie in, get the
 * same light: a shift by that much is far less than the circle blurs. */
static const double SAME_SHARE = 1.0 / 8;

static bool is_same(const Receiver *a, const Receiver *b, double within)
{
    const Vec3 d = vec3_sub(a->point, b->point);
    return vec3_dot(d, d) < within * within && a->face.x == b->face.x && a->face.y == b->face.y &&
           a->face.z == b->face.z;
}

/* Light that photons bring. */
static void receive_caustics(Wave *wave, unsigned level, uint32_t count,
                             const WaveOptions *options)
{
    CausticsLight light = { .radius = 0 };
    Receiver      read = { .face = { 0, 0, 0 } };
    Rgb           groups[RECORDS_GROUPS_MOST];
    for (uint32_t k = 0; k < count; k++) {
        const WavePoint *p = &wave->point[level][k];
        const uint32_t   each = options->split != NULL ? wave->gatherer->split->count + 1 : 0;
        if (k == 0 || !is_same(&read, &p->at, SAME_SHARE * light.radius)) {
            memset(groups, 0, sizeof groups);
            light = caustics_find(wave->caustics, &p->at, each > 0 ? groups : NULL);
            read = p->at;
        }
        add_to(wave, p, level, light.irradiance);
        for (uint32_t g = 0; g < each; g++) {
            Rgb *sum = split_sums(wave, p, options) + g;
            *sum = rgb_add(*sum, rgb_mul(p->weight, groups[g]));
        }
    }
}

/* --- the hemisphere -------------------------------------------------------------------------- */

WaveEnd wave_end(const Gatherer *gatherer, const Ray *ray, const Hit *hit)
{
    const Surfaces *surfaces = gatherer->room->surfaces;
    WaveEnd end = { .surface = surfaces_of_primitive(surfaces, hit->primitive) };
    double  along;
    if (hit->primitive < surfaces->triangle_count) {
        const float *n = gatherer->normal + 3 * (size_t)hit->primitive;
        along = n[0] * ray->dx + n[1] * ray->dy + n[2] * ray->dz;
    } else {
        along = vec3_dot(surfaces_normal(surfaces, hit->primitive, hit->u, hit->v),
                         vec3(ray->dx, ray->dy, ray->dz));
    }
    end.side = along > 0 ? 1 : 0;
    surfaces_parameters(surfaces, hit->primitive, hit->u, hit->v, &end.s, &end.t);
    return end;
}

Rgb wave_radiosity(const Gatherer *gatherer, const WaveEnd *end)
{
    const Room *room = gatherer->room;
    uint32_t    vertex[PATCH_WEIGHTS];
    double      weight[PATCH_WEIGHTS];
    const int   n = patches_interpolate(room->patches, room->surfaces, end->surface, end->side,
                                        end->s, end->t, vertex, weight);
    Rgb b = { 0, 0, 0 };
    for (int i = 0; i < n; i++) {
        const float *v = gatherer->vertex + 3 * (size_t)vertex[i];
        b = rgb_mad(b, weight[i], rgb(v[0], v[1], v[2]));
    }
    return b;
}

double wave_nearness(const Gatherer *gatherer, const WaveEnd *end, const Hit *hit)
{
    /* Most rays end too far off for any patch of the surface: which one it is, is not asked. */
    if (!(hit->t < 2 * gatherer->widest[end->side][end->surface]))
        return 0;
    const Room    *room = gatherer->room;
    const uint32_t patch = patches_at(room->patches, room->surfaces, end->surface, end->side,
                                      end->s, end->t);
    if (patch == PATCH_NONE)
        return 0;
    const float x = 2 - hit->t / gatherer->extent[patch];
    return x <= 0 ? 0 : x >= 1 ? 1 : (double)(x * x * (3 - 2 * x));
}

/* The cosine map of math/sampling.h once more in float, which is all a ray keeps of it, and without
 * a branch to mispredict: these two lines of polynomials are met by every ray. */
static void cosine_direction(const float u[2], float *x, float *y, float *z)
{
    const float p = 2 * u[0] - 1, q = 2 * u[1] - 1;
    const bool  wide = fabsf(p) > fabsf(q);
    const float r = wide ? p : q, o = wide ? q : p;
    const float angle = r != 0 ? (float)M_PI_4 * (o / r) : 0, a = angle * angle;
    /* Taylor series up to |angle| = pi / 4: the first terms left out are below 3e-8. */
    const float c = 1 + a * (-1.0F / 2 + a * (1.0F / 24 + a * (-1.0F / 720 + a * (1.0F / 40320))));
    const float s = angle * (1 + a * (-1.0F / 6 + a * (1.0F / 120 + a * (-1.0F / 5040 +
                    a * (1.0F / 362880)))));
    const float lowest = 1e-4F; /* as in sampling_cosine */
    const float square = 1 - r * r;
    *x = r * (wide ? c : s);
    *y = r * (wide ? s : c);
    *z = square > lowest * lowest ? sqrtf(square) : lowest;
}

WaveFrame wave_frame(const Room *room, const Receiver *at)
{
    WaveFrame f = { .normal = at->normal };
    vec3_frame(at->normal, &f.s, &f.t);
    f.origin = vec3_mad(at->point, wave_offset(room, at->point), at->face);
    return f;
}

Ray wave_hemisphere(const WaveFrame *frame, const float u[2])
{
    float x, y, z;
    cosine_direction(u, &x, &y, &z);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(frame->normal, z), x, frame->s), y, frame->t);
    return (Ray){ .ox = (float)frame->origin.x, .oy = (float)frame->origin.y,
                  .oz = (float)frame->origin.z, .t_min = 0, .dx = (float)d.x, .dy = (float)d.y,
                  .dz = (float)d.z, .t_max = INFINITY };
}

/* Ray k's direction for the point of the square with its index, moved on by `turn`. */
static void aim_ray(Wave *wave, unsigned level, uint32_t k, uint32_t seed, float turn,
                    const WaveFrame *frame)
{
    const WavePoint *p = &wave->point[level][wave->owner[k]];
    float u[2];
    sampling_sobol2(wave->index[k], seed ^ p->seed, u);
    for (int i = 0; i < 2; i++)
        u[i] = u[i] + turn < 1 ? u[i] + turn : u[i] + turn - 1;
    wave->worth[k] = p->guide != NULL ? (float)guide_map(p->guide, u) : 1;
    wave->ray[k] = wave_hemisphere(frame, u);
}

static bool is_at_seam(const Room *room, const Hit *hit)
{
    double s, t;
    if (hit->primitive == RAY_MISS)
        return false;
    surfaces_parameters(room->surfaces, hit->primitive, hit->u, hit->v, &s, &t);
    return visible_at_seam(room, surfaces_of_primitive(room->surfaces, hit->primitive), s, t);
}

/* Ray k from its first hit on, if clear through mirrors and glass. */
static void follow(Wave *wave, unsigned level, uint32_t k, uint32_t seed, bool clear)
{
    const Gatherer *g = wave->gatherer;
    const double    share = share_of(wave, level, k);
    if (!(share > 0)) /* into the triangle */
        wave->hit[k].primitive = RAY_MISS;
    wave->pass[k] = rgb(1, 1, 1);
    if (clear)
        wave->pass[k] = specular_follow(g->room, g->smooth, sampling_mix(seed ^ wave->index[k]),
                                        &wave->ray[k], &wave->hit[k], &wave->way[k],
                                        &wave->rays);
    wave->pass[k] = rgb_scale(wave->pass[k], share);
}

/* A ray that ended where rounding decides in which room that is gives way to one close by. From a
 * point that lies at a seam itself most rays end there: then it stays. */
static void leave_seam(Wave *wave, unsigned level, uint32_t k, uint32_t seed, bool clear)
{
    enum { TRIES = 4 };
    static const float step = 0x1p-9F; /* about 1/4 degree: hundreds of times as wide as a seam */
    const Room     *room = wave->gatherer->room;
    const WaveFrame frame = wave_frame(room, &wave->point[level][wave->owner[k]].at);
    for (int i = 1; i <= TRIES && is_at_seam(room, &wave->hit[k]); i++) {
        aim_ray(wave, level, k, seed, (float)i * step, &frame);
        bvh_nearest(room->bvh, &wave->ray[k], &wave->hit[k]);
        wave->rays++;
        if (clear || level == 0)
            follow(wave, level, k, seed, clear);
    }
}

/* Directions for rays begin..begin+n-1 of the level's points, and whose they are. */
static void cast_block(Wave *wave, unsigned level, uint32_t begin, uint32_t n, uint32_t rays,
                       const WaveOptions *options)
{
    const Room    *room = wave->gatherer->room;
    const bool     clear = options->clear && wave->gatherer->clear;
    const uint32_t seed = seed_of(options->seed, SEED_DIRECTION, level);
    uint32_t       owner = begin / rays, turn = begin % rays;
    WaveFrame      frame = wave_frame(room, &wave->point[level][owner].at);
    for (uint32_t k = 0; k < n; k++, turn++) {
        if (turn == rays) {
            turn = 0;
            owner++;
            frame = wave_frame(room, &wave->point[level][owner].at);
        }
        wave->owner[k] = owner;
        wave->index[k] = wave->point[level][owner].index * rays + turn;
        aim_ray(wave, level, k, seed, 0, &frame);
    }
    bvh_nearest_many(room->bvh, wave->ray, wave->hit, n);
    wave->rays += n;
    for (uint32_t k = 0; k < n; k++) {
        wave->pass[k] = rgb(1, 1, 1);
        wave->way[k] = (SpecularWay){ .turned = false };
        if (clear || level == 0)
            follow(wave, level, k, seed, clear);
    }
    for (uint32_t k = 0; k < n; k++)
        if (is_at_seam(room, &wave->hit[k]))
            leave_seam(wave, level, k, seed, clear);
}

/* Makes the ray's end a receiving point of the next level. */
static void receive_at(Wave *wave, unsigned level, const WavePoint *from, uint32_t k, double worth,
                       uint32_t index, const Guides *guides, uint32_t next)
{
    const Room *room = wave->gatherer->room;
    const Ray  *ray = &wave->ray[k];
    RoomHit     hit;
    room_hit(room, &wave->hit[k], vec3(ray->dx, ray->dy, ray->dz), &hit);
    Material        scratch;
    const Material *m = places_hit(room, &hit, &scratch);
    const Receiver  at = { hit.point, hit.normal, hit.normal };
    wave->point[level + 1][next] = (WavePoint){
        .at = at, .root = from->root, .index = index, .seed = from->seed,
        .guide = guides != NULL ? guides_find(guides, &at) : NULL,
        .weight = rgb_scale(rgb_mul(rgb_mul(from->weight, wave->pass[k]),
                                    mirrors_scattered(m, m->reflectance)), worth) };
}

/* Whether ray k came by a flat mirror for which lamps are sampled, `seen` from there. */
static bool is_image(const Wave *wave, const Receiver *at, uint32_t k, Receiver *seen)
{
    const Gatherer    *g = wave->gatherer;
    const SpecularWay *way = &wave->way[k];
    if (!way->by_mirror)
        return false;
    const uint32_t plane = images_of(&g->images, way->surface, way->side);
    return plane < IMAGES_MOST &&
           images_receiver(g->room, &g->images.plane[plane], at, seen);
}

bool wave_lamp_unaimed(const Wave *wave, const Receiver *at, uint32_t k)
{
    Receiver seen;
    assert(k < WAVE_RAYS);
    return wave->caustics == NULL && wave->way[k].turned && !is_image(wave, at, k, &seen);
}

/* What a lamp that the ray met adds. */
static void add_lamp(Wave *wave, unsigned level, const WavePoint *from, uint32_t k, uint32_t rays,
                     const WaveOptions *options)
{
    const Gatherer *g = wave->gatherer;
    const Ray      *ray = &wave->ray[k];
    RoomHit         hit;
    room_hit(g->room, &wave->hit[k], vec3(ray->dx, ray->dy, ray->dz), &hit);
    const Material *m = lamps_material(g->room, hit.surface, hit.side);
    const LampPlan  plan = plan_of(wave, level, wave->owner[k], options);
    Receiver        seen = from->at;
    const bool      aimed = !wave->way[k].turned || is_image(wave, &from->at, k, &seen);
    const double    share = aimed ? lamps_share(&g->lamps, &seen, &plan, &hit)
                                  : wave->caustics == NULL;
    const Rgb e = rgb_scale(rgb_mul(m->emission, wave->pass[k]),
                            M_PI * share * wave->worth[k] / rays);
    add_to(wave, from, level, e);
    if (options->split != NULL) {
        Rgb *sum = split_sums(wave, from, options) +
                   split_emission(g->split, hit.surface, hit.side);
        *sum = rgb_add(*sum, rgb_mul(from->weight, e));
    }
}

/* Takes note of where a ray of a point of level 0 ended. */
static void add_view(Wave *wave, uint32_t k, const WaveEnd *end)
{
    WaveView    *view = &wave->view[wave->owner[k]];
    const double t = wave->hit[k].t;
    const double bright = wave->worth[k] * rgb_luminance(wave_radiosity(wave->gatherer, end));
    view->nearest = fmin(view->nearest, t);
    view->bright += bright;
    view->closeness += bright / fmax(t * t, DBL_MIN);
}

/* A ray's end: a lamp's share, then the solution, or one more receiving point. Returns how many
 * points the next level has now. */
static uint32_t read_end(Wave *wave, unsigned level, uint32_t k, uint32_t rays,
                         const WaveOptions *options, uint32_t next)
{
    const Gatherer  *g = wave->gatherer;
    const Room      *room = g->room;
    const WavePoint *p = &wave->point[level][wave->owner[k]];
    const WaveEnd    end = wave_end(g, &wave->ray[k], &wave->hit[k]);
    if (room->patches->first[end.side][end.surface] == PATCH_NONE)
        return next;
    const double worth = wave->worth[k] / rays;
    const bool   view_only = level == 0 && options->indirect_only;
    if (view_only)
        add_view(wave, k, &end);
    if (((g->lamps.shared && !view_only) || wave_lamp_unaimed(wave, &p->at, k)) &&
        room->emitting[end.surface] >> end.side & 1)
        add_lamp(wave, level, p, k, rays, options);
    const double chance = level + 1 < WAVE_LEVELS ? wave_nearness(g, &end, &wave->hit[k]) : 0;
    if (chance > 0) {
        const uint32_t index = wave->index[k];
        const double luck =
            sampling_mix(index ^ p->seed ^ seed_of(options->seed, SEED_RAMP, level)) * 0x1p-32;
        if (luck < chance) {
            receive_at(wave, level, p, k, worth, index, options->guides, next);
            return next + 1;
        }
    }
    const Rgb b = rgb_mul(wave->pass[k], wave_radiosity(g, &end));
    Rgb      *sum = &wave->indirect[p->root];
    *sum = rgb_add(*sum, rgb_scale(rgb_mul(p->weight, b), worth));
    if (options->split != NULL)
        split_radiosity(g, &end, rgb_scale(rgb_mul(p->weight, wave->pass[k]), worth),
                        split_sums(wave, p, options));
    return next;
}

static void receive(Wave *wave, unsigned level, uint32_t count, const WaveOptions *options)
{
    assert(level < WAVE_LEVELS && count <= WAVE_RAYS);
    const bool lamps = level > 0 || !options->indirect_only;
    if (lamps) {
        receive_lamps(wave, level, count, options, false);
        receive_images(wave, level, count, options, false);
        if (wave->caustics != NULL)
            receive_caustics(wave, level, count, options);
    }
    /* Who sees to the point lights at the points themselves does not where rays end. */
    if (lamps && (options->lights || level > 0) && wave->gatherer->room->light_count > 0) {
        receive_lamps(wave, level, count, options, true);
        receive_images(wave, level, count, options, true);
    }
    const uint32_t rays = level == 0 ? options->gather_rays : 1;
    if (level == 0)
        count = wave->gathered;
    for (uint32_t begin = 0; begin < count * rays; begin += WAVE_RAYS) {
        const uint32_t left = count * rays - begin;
        const uint32_t n = left < WAVE_RAYS ? left : WAVE_RAYS;
        uint32_t       next = 0;
        cast_block(wave, level, begin, n, rays, options);
        for (uint32_t k = 0; k < n; k++)
            if (wave->hit[k].primitive != RAY_MISS)
                next = read_end(wave, level, k, rays, options, next);
        if (next > 0)
            receive(wave, level + 1, next, options);
    }
}

void wave_gather(Wave *wave, uint32_t count, uint32_t gathered, const WaveOptions *options)
{
    assert(count <= WAVE_POINTS && gathered <= count);
    wave->gathered = gathered;
    assert(options->gather_rays > 0 && options->lamp_rays > 0);
    wave->lit_known = false;
    wave->lit_share = 0; /* 0 times what memory held before could be NaN */
    for (uint32_t i = 0; i < count; i++) {
        wave->point[0][i].root = i;
        wave->point[0][i].weight = rgb(1, 1, 1);
        wave->direct[i] = wave->indirect[i] = rgb(0, 0, 0);
        wave->view[i] = (WaveView){ .nearest = INFINITY };
    }
    if (options->split != NULL)
        memset(options->split, 0,
               count * ((size_t)wave->gatherer->split->count + 1) * sizeof *options->split);
    if (count > 0)
        receive(wave, 0, count, options);
}
