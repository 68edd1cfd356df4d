/* SPDX-License-Identifier: BSD-3-Clause */
/* Paths from the eye, a bounce of many at a time: rays in company, shadow rays behind them. */
#include <assert.h>
#include <float.h>

#include "base/array.h"
#include "math/sampling.h"
#include "render/path_internal.h"

enum { SEED_LAMP = 11, SEED_WAY = 12 };

/* Roulette begins after so many bounces; before, most paths carry what the picture is made of. */
enum { BOUNCES_FREE = 3 };
/* No path is sure to go on: else light between perfect mirrors would never end. */
static const double SURVIVAL_MOST = 0.95;
/* Panes that a shadow ray crosses at most; then it counts as blocked. Each takes away 8 % at least
 * where its index is that of glass, and behind so many nothing is left. */
enum { PANES_MOST = 256 };

typedef struct {
    Ray       ray;
    Rgb       throughput;
    Rgb       seen;     /* share of it that mirrors, glass and gloss alone brought to the eye */
    Rgb       share;    /* share of it that the first place seen sends back diffusely */
    uint32_t  pixel, seed, index;
    bool      blurred;  /* it turned at a diffuse or glossy place */
    uint32_t  bounces, turns; /* of them, those that are not straight through a pane */
    double    density;  /* of the direction, at `from`; 0: a mirror, glass or the eye */
    PathPlace from;
} Path;

typedef struct {
    Rgb      light, direct, indirect; /* that it brings to the pixel if nothing is in the way */
    uint32_t pixel;
} Shadow;

struct PathWave {
    uint32_t count;
    Path     path[PATH_WAVE];
    Ray      ray[PATH_WAVE];
    Hit      hit[PATH_WAVE];
    InstanceHit met[PATH_WAVE];   /* the same where copies stand */
    Shadow   shadow[PATH_WAVE];
    Ray      shadow_ray[PATH_WAVE];
    bool     blocked[PATH_WAVE];
};

PathWave *path_wave_create(Error *err)
{
    return array_create(1, sizeof(PathWave), "paths", err);
}

PathWave *path_wave_destroy(PathWave *wave) { return array_free(wave); }

bool path_nearest(const PathScene *scene, const Ray *ray, InstanceHit *found)
{
    if (scene->copies != NULL)
        return instances_nearest(copies_instances(scene->copies), ray, found);
    found->instance = 0;
    return bvh_nearest(scene->room->bvh, ray, &found->hit);
}

const Room *path_place(const PathScene *scene, const InstanceHit *found, Vec3 direction,
                       RoomHit *hit)
{
    if (scene->copies != NULL)
        return copies_hit(scene->copies, found, direction, hit);
    path_hit(scene->room, &found->hit, direction, hit);
    return scene->room;
}

void path_wave_add(PathWave *wave, const Ray *ray, uint32_t pixel, uint32_t seed, uint32_t index)
{
    assert(wave->count < PATH_WAVE && pixel < PATH_PIXELS);
    wave->path[wave->count++] = (Path){ .ray = *ray, .throughput = { 1, 1, 1 },
                                        .seen = { 1, 1, 1 }, .pixel = pixel, .seed = seed,
                                        .index = index };
}

static void add_light(PathSum *sum, const Shadow *light, Rgb pass)
{
    sum->radiance = rgb_add(sum->radiance, rgb_mul(pass, light->light));
    sum->direct = rgb_add(sum->direct, rgb_mul(pass, light->direct));
    sum->indirect = rgb_add(sum->indirect, rgb_mul(pass, light->indirect));
}

/* Splits light that came to the eye after `turns` more turns than the first. */
static Shadow split(const Path *path, Rgb light, Rgb share, uint32_t turns)
{
    Shadow out = { .light = light, .pixel = path->pixel };
    *(turns == 0 ? &out.direct : &out.indirect) = rgb_mul(light, share);
    return out;
}

/* Light of a lamp that the path ran into. */
static void add_emission(const PathScene *scene, const Room *room, const Path *path,
                         const RoomHit *hit, PathSum *sum)
{
    if ((room->emitting[hit->surface] >> hit->side & 1) == 0)
        return;
    const Rgb emission = room->materials[surfaces_material(room->surfaces, hit->surface,
                                                           hit->side)].emission;
    double weight = 1;
    if (path->density > 0 && room == scene->room) /* no ray is aimed at copies */
        weight = path->density / (path->density + path_lamps_density(&scene->lamps, &path->from,
                                                                     hit));
    const Shadow light = split(path, rgb_scale(rgb_mul(path->throughput, emission), weight),
                               path->share, path->turns > 0 ? path->turns - 1 : 0);
    add_light(&sum[path->pixel], &light, rgb(1, 1, 1));
}

static double ratio(double part, double all) { return all > 0 ? part / all : 0; }

/* Diffuse share of what a place sends from `out` back along the path. */
static Rgb diffuse_share(const PathSurface *surface, Vec3 out, Rgb value)
{
    const Rgb part = path_surface_diffuse(surface, out);
    return rgb(ratio(part.r, value.r), ratio(part.g, value.g), ratio(part.b, value.b));
}

/* A shadow ray towards a lamp. false: none is needed. */
static bool aim_shadow(const PathScene *scene, const Path *path, const PathSurface *surface,
                       Shadow *shadow, Ray *ray)
{
    const PathPlace at = { surface->at.point, surface->at.face };
    float   u[4];
    double  density;
    PathAim aim;
    if (surface->diffuse + surface->gloss <= 0)
        return false;
    sampling_sobol4(path->index, sampling_seed(path->seed, path->bounces, SEED_LAMP, 0), u);
    if (!path_lamps_aim(&scene->lamps, &at, u, &aim))
        return false;
    const Rgb value = path_surface_value(surface, aim.way, &density);
    if (!(rgb_max(value) > 0))
        return false;
    const double weight = aim.density > 0 ? aim.density / (aim.density + density) : 1;
    const Rgb    light = rgb_scale(rgb_mul(rgb_mul(path->throughput, value), aim.light), weight);
    const Rgb    share = path->bounces == 0 ? diffuse_share(surface, aim.way, value)
                                            : path->share;
    *shadow = split(path, light, share, path->turns);
    *ray = ray_between(at.point, at.normal, aim.point, aim.normal, scene->offset);
    return true;
}

/* Goes on in a new direction. false: the path ends. */
static bool move_on(const PathScene *scene, Path *path, const PathSurface *surface)
{
    float       u[4];
    PathNext    next;
    sampling_sobol4(path->index, sampling_seed(path->seed, path->bounces, SEED_WAY, 0), u);
    if (!path_surface_next(surface, u, &next))
        return false;
    if (next.density > 0) {
        const Rgb share = diffuse_share(surface, next.out, next.weight);
        /* next.weight is f cos over the density; so is the share's numerator. */
        const Rgb diffuse = rgb_scale(share, 1 / next.density);
        if (path->bounces == 0)
            path->share = diffuse;
        path->seen = rgb_mul(path->seen, rgb(fmax(1 - diffuse.r, 0), fmax(1 - diffuse.g, 0),
                                             fmax(1 - diffuse.b, 0)));
    }
    assert(isfinite(rgb_max(next.weight)) && next.density >= 0);
    path->blurred = path->blurred || next.density > 0;
    path->throughput = rgb_mul(path->throughput, next.weight);
    path->bounces++;
    if (!next.straight) {
        path->turns++;
        path->density = next.density;
        path->from = (PathPlace){ surface->at.point, surface->at.face };
    }
    if (next.density > 0)
        path->ray = ray_leaving(surface->at.point, surface->at.face, scene->offset, next.out,
                                INFINITY);
    else
        path->ray = ray_leaving(surface->hit.point, surface->hit.normal,
                                next.across ? -scene->offset : scene->offset, next.out, INFINITY);
    const double carried = rgb_max(path->throughput);
    if (path->bounces <= BOUNCES_FREE)
        return carried > 0;
    const double survival = fmin(carried, SURVIVAL_MOST);
    if (!(u[3] < survival))
        return false;
    path->throughput = rgb_scale(path->throughput, 1 / survival);
    return true;
}

/* What a path's ray met. Returns whether the path goes on; *shadows counts up when it left a shadow
 * ray. */
static bool path_step(PathWave *wave, const PathScene *scene, const InstanceHit *found,
                      Path *path, uint32_t *shadows, PathSum *sum)
{
    const Vec3  in = vec3_unit(vec3(path->ray.dx, path->ray.dy, path->ray.dz));
    PathSurface surface;
    RoomHit     at;
    if (found->hit.primitive == RAY_MISS) {
        const Rgb light = rgb_mul(rgb_mul(path->throughput, path->seen),
                                  scene->options->background);
        sum[path->pixel].radiance = rgb_add(sum[path->pixel].radiance, light);
        return false;
    }
    const Room *room = path_place(scene, found, in, &at);
    add_emission(scene, room, path, &at, sum);
    /* Sides chosen by hand that are not in use take light for lost, but for the eye's sight. */
    if (room->sides_given && path->bounces > 0 && (room->sides[at.surface] >> at.side & 1) == 0)
        return false;
    path_surface_init(&surface, scene, room, found, &at, in, !path->blurred);
    if (aim_shadow(scene, path, &surface, &wave->shadow[*shadows], &wave->shadow_ray[*shadows]))
        (*shadows)++;
    return move_on(scene, path, &surface);
}

/* Share of light that a blocked ray's way lets pass: panes do. */
static Rgb pass_of(const PathScene *scene, Ray ray, uint64_t *rays)
{
    const Vec3  way = vec3(ray.dx, ray.dy, ray.dz), unit = vec3_unit(way);
    const Vec3  start = vec3(ray.ox, ray.oy, ray.oz);
    const double length = vec3_length(way);
    Rgb         pass = { 1, 1, 1 };
    for (int k = 0; k < PANES_MOST; k++) {
        InstanceHit found;
        RoomHit     at;
        (*rays)++;
        if (!path_nearest(scene, &ray, &found))
            return pass;
        const Room *room = path_place(scene, &found, unit, &at);
        pass = rgb_mul(pass, path_surface_pane(room, &at, unit));
        if (!(rgb_max(pass) > 0))
            return pass;
        /* On from behind the pane, along the same line to the same end. */
        const double done = vec3_dot(vec3_sub(at.point, start), unit) / length;
        const double slack = scene->offset / (length * fmax(-vec3_dot(unit, at.normal), 0.01));
        ray.t_min = fmaxf(nextafterf(found.hit.t, INFINITY), (float)(done + slack));
        if (!(ray.t_min < ray.t_max))
            return pass;
    }
    return rgb(0, 0, 0);
}

static uint64_t cast_shadows(PathWave *wave, const PathScene *scene, uint32_t count, PathSum *sum,
                             Error *err)
{
    uint64_t rays = count;
    assert(count <= PATH_WAVE);
    if (scene->copies == NULL)
        bvh_blocked_many(scene->room->bvh, wave->shadow_ray, wave->blocked, count);
    else if (!instances_blocked_many(copies_instances(scene->copies), wave->shadow_ray,
                                     wave->blocked, count, false, err))
        return 0;
    for (uint32_t i = 0; i < count; i++) {
        const Shadow *shadow = &wave->shadow[i];
        Rgb           pass = { 1, 1, 1 };
        if (wave->blocked[i] && !scene->panes)
            continue;
        if (wave->blocked[i])
            pass = pass_of(scene, wave->shadow_ray[i], &rays);
        add_light(&sum[shadow->pixel], shadow, pass);
    }
    return rays;
}

static bool cast_rays(PathWave *wave, const PathScene *scene, Error *err)
{
    for (uint32_t i = 0; i < wave->count; i++)
        wave->ray[i] = wave->path[i].ray;
    if (scene->copies != NULL)
        return instances_nearest_many(copies_instances(scene->copies), wave->ray, wave->met,
                                      wave->count, false, err);
    bvh_nearest_many(scene->room->bvh, wave->ray, wave->hit, wave->count);
    for (uint32_t i = 0; i < wave->count; i++)
        wave->met[i] = (InstanceHit){ wave->hit[i], 0 };
    return true;
}

uint64_t path_wave_run(PathWave *wave, const PathScene *scene, PathSum *sum, Error *err)
{
    uint64_t rays = 0;
    assert(sum != NULL && scene->room != NULL && scene->options != NULL);
    while (wave->count > 0) {
        uint32_t next = 0, shadows = 0;
        if (!cast_rays(wave, scene, err))
            break;
        rays += wave->count;
        for (uint32_t i = 0; i < wave->count; i++) {
            Path path = wave->path[i];
            if (path_step(wave, scene, &wave->met[i], &path, &shadows, sum))
                wave->path[next++] = path;
        }
        rays += cast_shadows(wave, scene, shadows, sum, err);
        wave->count = next;
    }
    wave->count = 0;
    return rays;
}
