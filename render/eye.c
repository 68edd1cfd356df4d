/* SPDX-License-Identifier: BSD-3-Clause */
/* Samples of pixels: eye's rays, mirrors and glass on the way, light where they end. */
#include "render/eye.h"

#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "math/sampling.h"
#include "radiosity/places.h"
#include "render/normals.h"
#include "render/specular.h"
#include "render/split.h"

/* Bounces before roulette begins, and those after which a ray is given up: few of a million come so
 * far even between perfect mirrors. */
enum { BOUNCES_FREE = 8, BOUNCES_MOST = 256 };
/* Chance to go on then, even where nothing is lost. */
static const double SURVIVAL_MOST = 7.0 / 8;
/* Both ways at glass are followed where each counts at least so much; else chance takes one. What a
 * sample's rays count comes to 1 at most, so there are not more of them than 1 over this. */
static const double FORK_LEAST = 1.0 / EYE_FORKS;
/* Ends seen by way of mirrors and glass that count less than this gather by chance. A sample's
 * noise from it is at most this share of a white place in the same light. */
static const double WORTH_LEAST = 1.0 / 256;

/* + bounce for the last; other ways of a sample's rays are FORK_STRIDE apart. */
enum { SEED_PIXEL = 100, SEED_SPECULAR, SEED_LENS, SEED_ROULETTE, SEED_WORTH,
       SEED_WAVE = 200 };
enum { FORK_STRIDE = 2 * BOUNCES_MOST };

static const double PI = 3.14159265358979323846;

bool eye_ray(const CameraRays *camera, double x, double y, const float *lens, Ray *ray)
{
    Vec3 o, d;
    if (!camera_rays_at(camera, x, y, lens, &o, &d))
        return false;
    *ray = (Ray){ .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = 0,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY };
    return true;
}

static bool emits(const Room *room, const RoomHit *hit)
{
    return room->emitting[hit->surface] >> hit->side & 1;
}

/* The point where light is received, and what is known of it already. */
static void receive_point(const Eye *eye, const EyeSample *sample, const EyeRay *ray,
                          const RoomHit *hit, Rgb albedo, EyePoint *out)
{
    const float   *smooth = ray->blurred ? NULL : eye->gatherer->smooth;
    const Receiver at = normals_receive(smooth, eye->gatherer->room, hit);
    *out = (EyePoint){
        .point = { .at = at, .index = sample->index, .group = sample->group,
                   .seed = sampling_mix(sample->seed + SEED_WAVE + ray->bounce +
                                        FORK_STRIDE * ray->fork),
                   .guide = guides_find(&eye->guides, &at) },
        .albedo = albedo, .sample = ray->sample, .bounce = ray->bounce,
        .throughput = rgb_scale(rgb_mul(ray->weight, albedo), 1 / PI)
    };
}

/* A number in [0, 1) for a ray of a sample. */
static double luck(const EyeSample *sample, const EyeRay *ray, uint32_t purpose)
{
    const uint32_t key = sampling_seed(sample->seed, purpose, ray->bounce, ray->fork);
    return sampling_mix(key ^ sampling_mix(sample->index)) * 0x1p-32;
}

/* Whether light is gathered at an end that counts `albedo` of it: dim ends, seen by way of glass
 * or mirrors, are by chance alone, and *weight is what those count for the rest. */
static bool is_worth(const EyeSample *sample, const EyeRay *ray, Rgb albedo, double *weight)
{
    const double chance = rgb_max(rgb_mul(ray->weight, albedo)) / WORTH_LEAST;
    *weight = 1;
    if (ray->bounce == 0 || chance >= 1)
        return true;
    *weight = 1 / chance;
    return luck(sample, ray, SEED_WORTH) < chance;
}

/* Whether two points are seen through one pixel on one plane. */
static bool same_place(const EyeSample *sample, const EyePoint *a, const EyePoint *b)
{
    static const double one_way = 1 - 1e-6; /* normals within 0.1 degrees */
    const EyeSample *one = &sample[a->sample], *two = &sample[b->sample];
    return one->x == two->x && one->y == two->y &&
           vec3_dot(a->point.at.normal, b->point.at.normal) > one_way;
}

/* Reads the records. Points side by side in a pixel share what their mean point gets: light is
 * linear there. */
static void read_records(Eye *eye, const EyeSample *sample, uint32_t points)
{
    for (uint32_t k = 0, end; k < points; k = end) {
        EyePoint *first = &eye->point[k];
        Receiver  at = first->point.at;
        for (end = k + 1; end < points && first->bounce == 0 && eye->split == NULL &&
                          same_place(sample, first, &eye->point[end]); end++)
            at.point = vec3_add(at.point, eye->point[end].point.at.point);
        at.point = vec3_scale(at.point, 1.0 / (end - k));
        first->known = records_find(eye->options->records, &at, &first->recorded);
        for (uint32_t i = k + 1; i < end; i++) {
            eye->point[i].known = first->known;
            eye->point[i].recorded = first->recorded;
        }
    }
}

/* Light of a group that the eye sees by itself. */
static void add_seen(Pixel *pixel, uint32_t group, Rgb light)
{
    if (pixel->split != NULL)
        pixel->split[group] = rgb_add(pixel->split[group], light);
}

/* A sharp way on. */
static bool sharp_way(const Eye *eye, const EyeRay *ray, const RoomHit *hit, const Material *m,
                      Rgb weight, EyeRay *on)
{
    if (specular_is_straight(eye->gatherer->room, hit, m, &on->ray)) {
        on->density = ray->density;
        on->from = ray->from;
    }
    on->blurred = ray->blurred;
    on->weight = rgb_mul(ray->weight, weight);
    return rgb_max(on->weight) > 0;
}

/* Follows both ways of glass, or the only one, if that is worth it; returns how many. */
static uint32_t both_ways(const Eye *eye, const EyeRay *ray, const RoomHit *hit, const Material *m,
                          Vec3 normal, Vec3 way, EyeRay on[2])
{
    Ray out[2];
    Rgb weight[2];
    if (ray->by_chance || !(rgb_max(m->transmittance) > 0))
        return 0;
    const unsigned n = specular_ways(eye->gatherer->room, m, hit, normal, way, out, weight);
    for (unsigned i = 0; i < n; i++)
        if (rgb_max(rgb_mul(ray->weight, weight[i])) < FORK_LEAST)
            return 0;
    for (unsigned i = 0; i < n; i++) {
        on[i].ray = out[i];
        on[i].fork = n > 1 ? 2 * ray->fork + 1 + i : ray->fork;
        sharp_way(eye, ray, hit, m, weight[i], &on[i]);
    }
    return n;
}

/* The rays on from a mirror, glass or gloss; returns how many. */
static uint32_t ways_on(Eye *eye, const EyeSample *sample, const EyeRay *ray, const RoomHit *hit,
                        const Material *m, EyeRay on[2])
{
    const Room  *room = eye->gatherer->room;
    const float *smooth = eye->gatherer->smooth;
    const Vec3   way = vec3_unit(vec3(ray->ray.dx, ray->ray.dy, ray->ray.dz));
    const Vec3   normal = normals_at(smooth, room, hit, way);
    float        u[4], v[4];
    Rgb          weight;
    on[0] = on[1] = (EyeRay){ .sample = ray->sample, .bounce = ray->bounce + 1,
                              .fork = ray->fork, .by_chance = ray->by_chance };
    const uint32_t both = specular_is_sharp(m)
                              ? both_ways(eye, ray, hit, m, normal, way, on) : 0;
    if (both > 0)
        return both;
    sampling_sobol4(sample->index, sampling_seed(sample->seed, SEED_SPECULAR, ray->bounce,
                                                 2 * ray->fork), u);
    if (!specular_is_sharp(m)) {
        /* Gloss is light received, too. */
        EyeGloss place = { .at = normals_receive(ray->blurred ? NULL : smooth, room, hit),
                           .weight = rgb_mul(ray->weight, m->specular), .pixel = sample->pixel };
        gloss_init(&place.gloss, m, place.at.face, normal, way);
        sampling_sobol4(sample->index, sampling_seed(sample->seed, SEED_SPECULAR, ray->bounce,
                                                     2 * ray->fork + 1), v);
        on->blurred = true;
        return eye_gloss(eye, &place, u, v, on);
    }
    on->by_chance = on->by_chance || rgb_max(m->transmittance) > 0;
    return specular_continue(room, hit, normal, way, u[2], &on->ray, &weight) &&
           sharp_way(eye, ray, hit, m, weight, on);
}

/* Whether chance lets a ray that has come far go on; then it counts for those that do not. */
static bool survives(const EyeSample *sample, EyeRay *ray)
{
    if (ray->bounce <= BOUNCES_FREE)
        return true;
    const double chance = fmin(rgb_max(ray->weight), SURVIVAL_MOST);
    const bool   lucky = luck(sample, ray, SEED_ROULETTE) < chance;
    ray->weight = rgb_scale(ray->weight, 1 / chance);
    ray->by_chance = true;
    return ray->bounce < BOUNCES_MOST && lucky;
}

/* Handles one end of an eye's ray: what it shows by itself, a receiving point, rays further on.
 * Returns how many of these. */
static uint32_t end_of_ray(Eye *eye, const EyeSample *samples, uint32_t i, uint32_t *points,
                           EyeRay on[2])
{
    const Room      *room = eye->gatherer->room;
    const EyeRay    *ray = &eye->eye[i];
    const EyeSample *sample = &samples[ray->sample];
    Pixel           *pixel = sample->pixel;
    const Split     *split = eye->gatherer->split;
    if (eye->hit[i].primitive == RAY_MISS) {
        const Rgb light = rgb_mul(ray->weight, eye->options->background);
        pixel->radiance = rgb_add(pixel->radiance, light);
        add_seen(pixel, split != NULL ? split->count : 0, light);
        return 0;
    }
    const Vec3 in = vec3(ray->ray.dx, ray->ray.dy, ray->ray.dz);
    RoomHit    hit;
    room_hit(room, &eye->hit[i], in, &hit);
    Material        scratch;
    const Material *m = places_hit(room, &hit, &scratch);
    if (emits(room, &hit)) {
        const double own = ray->density;
        const double share = own > 0 ? own / (own + lamps_density(&eye->gatherer->lamps,
                                                                  &ray->from, &hit)) : 1;
        const Rgb light = rgb_scale(rgb_mul(ray->weight, m->emission), share);
        pixel->radiance = rgb_add(pixel->radiance, light);
        add_seen(pixel, split != NULL ? split_emission(split, hit.surface, hit.side) : 0, light);
    }
    double worth;
    if ((ray->bounce == 0 || rgb_max(m->reflectance) > 0) &&
        is_worth(sample, ray, m->reflectance, &worth)) {
        EyePoint *point = &eye->point[(*points)++];
        receive_point(eye, sample, ray, &hit, m->reflectance, point);
        point->throughput = rgb_scale(point->throughput, worth);
    }
    if (eye->options->diffuse_only || !specular_exists(m))
        return 0;
    const uint32_t ways = ways_on(eye, sample, ray, &hit, m, on);
    uint32_t       n = 0;
    for (uint32_t k = 0; k < ways; k++)
        if (survives(sample, &on[k]))
            on[n++] = on[k];
    return n;
}

/* Adds what a receiving point of some bounce found. */
static void add_point(const EyePoint *point, Rgb direct, Rgb indirect, Pixel *pixel)
{
    const Rgb e = rgb_add(direct, indirect);
    pixel->radiance = rgb_add(pixel->radiance, rgb_mul(point->throughput, e));
    if (point->known)
        pixel->deviation += rgb_luminance(point->throughput) * point->recorded.deviation;
    if (point->bounce > 0)
        return;
    pixel->direct = rgb_add(pixel->direct, rgb_mul(point->throughput, direct));
    pixel->indirect = rgb_add(pixel->indirect, rgb_mul(point->throughput, indirect));
    pixel->albedo = rgb_add(pixel->albedo, point->albedo);
    pixel->irradiance = rgb_add(pixel->irradiance, e);
}

/* The same by groups: light [groups + 1]. */
static void add_groups(const EyePoint *point, const Rgb *light, uint32_t groups, Pixel *pixel)
{
    for (uint32_t k = 0; pixel->split != NULL && k <= groups; k++)
        pixel->split[k] = rgb_add(pixel->split[k], rgb_mul(point->throughput, light[k]));
}

/* Light at the receiving points; those without a record come first and gather. */
static void gather_points(Eye *eye, const EyeSample *sample, uint32_t points)
{
    const RenderOptions *o = eye->options;
    uint32_t order[WAVE_POINTS], n = 0;
    for (int known = 0; known < 2; known++)
        for (uint32_t k = 0; k < points; k++)
            if (eye->point[k].known == (known > 0))
                order[n++] = k;
    uint32_t gathered = 0;
    for (uint32_t k = 0; k < points; k++) {
        eye->wave.point[0][k] = eye->point[order[k]].point;
        gathered += !eye->point[k].known;
    }
    const WaveOptions wave = { .gather_rays = o->gather_rays, .lamp_rays = o->light_rays,
                               .lights = true, .clear = !o->diffuse_only,
                               .guides = &eye->guides, .split = eye->split };
    wave_gather(&eye->wave, points, gathered, &wave);
    const uint32_t groups = eye->split != NULL ? eye->gatherer->split->count : 0;
    for (uint32_t k = 0; k < points; k++) {
        const EyePoint *p = &eye->point[order[k]];
        Rgb indirect = p->known ? p->recorded.irradiance : eye->wave.indirect[k];
        if (eye->split != NULL) {
            Rgb *light = eye->split + (size_t)k * (groups + 1);
            if (p->known) /* their sum, so that layers add up */
                indirect = records_find_apart(o->records, &p->point.at, light);
            add_groups(p, light, groups, sample[p->sample].pixel);
        }
        add_point(p, eye->wave.direct[k], indirect, sample[p->sample].pixel);
    }
}

/* Rays from the eye; returns how many show something. */
static uint32_t start_rays(Eye *eye, const EyeSample *sample, uint32_t count)
{
    const bool blur = camera_rays_blur(eye->camera);
    uint32_t   seen = 0;
    for (uint32_t i = 0; i < count; i++) {
        const EyeSample *s = &sample[i];
        EyeRay          *ray = &eye->eye[seen];
        float            u[2], lens[2];
        double           at[2];
        sampling_sobol2(s->index, sampling_mix(s->seed + SEED_PIXEL), u);
        if (blur)
            sampling_sobol2(s->index, sampling_mix(s->seed + SEED_LENS), lens);
        *ray = (EyeRay){ .weight = { 1, 1, 1 }, .sample = i };
        filter_table_offset(eye->filter, u, at);
        seen += eye_ray(eye->camera, s->x + at[0], s->y + at[1], blur ? lens : NULL, &ray->ray);
    }
    return seen;
}

/* --- light groups ----------------------------------------------------------------------------- */

bool eye_split_create(Eye *eye, Error *err)
{
    const Split *split = eye->gatherer->split;
    if (split == NULL)
        return true;
    const size_t each = (size_t)split->count + 1;
    eye->split = array_create(WAVE_POINTS * each, sizeof(Rgb), "light groups", err);
    eye->sums = array_create(EYE_SUMS * each, sizeof(Rgb), "light groups", err);
    return !error_is_set(err);
}

void eye_split_destroy(Eye *eye)
{
    array_free(eye->split);
    array_free(eye->sums);
}

Rgb *eye_sums(const Eye *eye, uint32_t slot)
{
    assert(slot < EYE_SUMS);
    if (eye->sums == NULL)
        return NULL;
    const size_t each = (size_t)eye->gatherer->split->count + 1;
    Rgb *sums = eye->sums + slot * each;
    memset(sums, 0, each * sizeof *sums);
    return sums;
}

/* --- samples ---------------------------------------------------------------------------------- */

/* The last of the rays that wait become those under way; returns how many. Last in, first out: so
 * few wait. */
static uint32_t take_waiting(Eye *eye, uint32_t *waiting)
{
    const uint32_t n = *waiting < WAVE_POINTS ? *waiting : WAVE_POINTS;
    *waiting -= n;
    memcpy(eye->eye, eye->waiting + *waiting, n * sizeof *eye->eye);
    return n;
}

void eye_gather(Eye *eye, const EyeSample *sample, uint32_t count)
{
    assert(count <= WAVE_POINTS);
    uint32_t waiting = 0;
    count = start_rays(eye, sample, count);
    while (count > 0) {
        uint32_t points = 0;
        for (uint32_t i = 0; i < count; i++)
            eye->ray[i] = eye->eye[i].ray;
        bvh_nearest_many(eye->gatherer->room->bvh, eye->ray, eye->hit, count);
        eye->wave.rays += count;
        for (uint32_t i = 0; i < count; i++) {
            EyeRay on[2];
            const uint32_t n = end_of_ray(eye, sample, i, &points, on);
            assert(waiting + n <= EYE_FORKS * WAVE_POINTS);
            for (uint32_t k = 0; k < n; k++)
                eye->waiting[waiting++] = on[k];
        }
        if (eye->options->records != NULL)
            read_records(eye, sample, points);
        gather_points(eye, sample, points);
        count = take_waiting(eye, &waiting);
    }
}
