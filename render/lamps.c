/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of lamps, and the choice among them. */
#include "render/lamps.h"

#include <assert.h>
#include <float.h>

#include "base/array.h"
#include "render/lamp_faces.h"

static const double PI = 3.14159265358979323846;

/* --- the list -------------------------------------------------------------------------------- */

static double strength_of(Rgb radiance)
{
    const double y = rgb_luminance(radiance);
    return y > 0 ? y : rgb_max(radiance);
}

static bool lamps_add(Lamps *lamps, const Lamp *lamp, Error *err)
{
    void  *array = lamps->lamp;
    size_t capacity = lamps->capacity;
    if (lamp->facet.count > 0 && !(lamp->area > 0))
        return true;
    if (lamps->count == UINT32_MAX / 2)
        return error_set(err, ERROR_INPUT, "more than %u lamps", lamps->count);
    if (!array_reserve(&array, &capacity, (size_t)lamps->count + 1, sizeof *lamp, "lamps", err))
        return false;
    lamps->lamp = array;
    lamps->capacity = capacity > UINT32_MAX ? UINT32_MAX : (uint32_t)capacity;
    lamps->lamp[lamps->count++] = *lamp;
    return true;
}

/* A facet over corners given counter-clockwise from the front; turned for the back. */
static bool add_facet(Lamps *lamps, Lamp lamp, const Vec3 *corner, int count, Error *err)
{
    Vec3 turned[4];
    for (int i = 0; i < count; i++)
        turned[i] = corner[lamp.side == 0 ? i : count - 1 - i];
    facet_init(&lamp.facet, turned, count);
    lamp.area = lamp.facet.area;
    lamp.centre = vec3(0, 0, 0);
    for (int i = 0; i < count; i++)
        lamp.centre = vec3_mad(lamp.centre, 1.0 / count, corner[i]);
    for (int i = 0; i < count; i++)
        lamp.radius = fmax(lamp.radius, vec3_length(vec3_sub(corner[i], lamp.centre)));
    return lamps_add(lamps, &lamp, err);
}

static bool add_curved(Lamps *lamps, Lamp lamp, const Surface *surface, const Surfaces *surfaces,
                       Error *err)
{
    Vec3 lo, hi;
    shape_bounds(&surfaces->shape[surface->primitive - surfaces->triangle_count], &lo, &hi);
    lamp.area = surface->area;
    lamp.centre = vec3_lerp(lo, hi, 0.5);
    lamp.radius = vec3_length(vec3_sub(hi, lo)) / 2;
    return lamps_add(lamps, &lamp, err);
}

static Vec3 corner_of(const Surfaces *surfaces, uint32_t triangle, unsigned k)
{
    return surfaces->position[surfaces->corner[3 * (size_t)triangle + k]];
}

static Lamp lamp_on(const Lamps *lamps, uint32_t surface, unsigned side)
{
    const Rgb radiance = lamps_material(lamps->room, surface, side)->emission;
    return (Lamp){ .surface = surface, .side = side, .radiance = radiance,
                   .strength = strength_of(radiance) };
}

/* All pieces of a face. */
static bool add_face(Lamps *lamps, const LampFaces *faces, const LampFace *face, Error *err)
{
    const LampPiece *piece = &faces->piece[face->begin];
    const Lamp       lamp = lamp_on(lamps, piece->surface, piece->side);
    const size_t     n = lamps->room->surfaces->count;
    if (!(lamp.strength > 0))
        return true;
    for (uint32_t i = face->begin; i < face->end; i++)
        lamps->first[piece->side * n + faces->piece[i].surface] = lamps->count;
    if (face->whole)
        return add_facet(lamps, lamp, face->corner, (int)face->corners, err);
    const uint32_t first = lamps->count;
    for (uint32_t i = 1; i + 1 < face->corners; i++) {
        const Vec3 corner[3] = { face->corner[0], face->corner[i], face->corner[i + 1] };
        if (!add_facet(lamps, lamp, corner, 3, err))
            return false;
    }
    lamps->lamp[first].fan = lamps->count - first;
    return true;
}

static bool add_surface(Lamps *lamps, uint32_t index, unsigned side, Error *err)
{
    const Surfaces *surfaces = lamps->room->surfaces;
    const Surface  *surface = &surfaces->surface[index];
    const Lamp      lamp = lamp_on(lamps, index, side);
    if (!(lamp.strength > 0))
        return true;
    if (surface->kind == SURFACE_SHAPE)
        return add_curved(lamps, lamp, surface, surfaces, err);
    const uint32_t t = surface->primitive;
    Vec3 v[4] = { corner_of(surfaces, t, 0), corner_of(surfaces, t, 1),
                  corner_of(surfaces, t, 2) };
    if (surface->kind == SURFACE_TRIANGLE)
        return add_facet(lamps, lamp, v, 3, err);
    v[3] = corner_of(surfaces, t + 1, 2);
    /* A parallelogram up to what float coordinates can say of one; else its two triangles. */
    const Vec3   gap = vec3_sub(vec3_add(v[0], v[2]), vec3_add(v[1], v[3]));
    const double size = vec3_length(vec3_sub(v[2], v[0])) + surfaces->largest_coordinate;
    if (vec3_length(gap) <= 4 * FLT_EPSILON * size)
        return add_facet(lamps, lamp, v, 4, err);
    const Vec3 second[3] = { v[0], v[2], v[3] };
    return add_facet(lamps, lamp, v, 3, err) && add_facet(lamps, lamp, second, 3, err);
}

/* A lamp with less of all power than this is not worth being weighed at each point. */
static const double STRONG_SHARE = 1.0 / 128;

/* Which lamps are weighed: all, or the strongest. A tree knows large lamps near by badly, as it
 * takes all of a lamp to lie at its centre. */
static void choose_weighed(Lamps *lamps)
{
    double all = 0;
    for (uint32_t i = 0; i < lamps->count; i++)
        all += lamps->lamp[i].strength * lamps->lamp[i].area;
    double least = lamps->many ? STRONG_SHARE * all : -1;
    for (;;) { /* raised until they are few enough: lamps of one strength stay together */
        double next = INFINITY;
        lamps->weighed_count = 0;
        uint32_t count = 0;
        for (uint32_t i = 0; i < lamps->count; i++) {
            const double own = lamps->lamp[i].strength * lamps->lamp[i].area;
            if (!(own > least))
                continue;
            next = fmin(next, own);
            if (count++ < LAMPS_WEIGHED)
                lamps->weighed[lamps->weighed_count++] = i;
        }
        if (!lamps->many || count <= LAMPS_STRONGEST)
            break;
        least = next;
    }
}

static bool make_tree(Lamps *lamps, Error *err)
{
    TreeLamp *item = array_create(lamps->count, sizeof *item, "lamps", err);
    if (item == NULL)
        return false;
    for (uint32_t i = 0; i < lamps->count; i++) {
        const Lamp *lamp = &lamps->lamp[i];
        item[i] = (TreeLamp){ .centre = lamp->centre, .radius = lamp->radius,
                              .axis = lamp->facet.normal, .around = lamp->facet.count == 0,
                              .strength = lamp->strength * lamp->area };
    }
    for (uint32_t i = 0; i < lamps->weighed_count; i++)
        item[lamps->weighed[i]].strength = 0;
    const bool ok = lamp_tree_init(&lamps->tree, item, lamps->count, err);
    array_free(item);
    return ok;
}

/* Faces that were cut into pieces are one lamp, in place of their first piece. */
static bool add_all(Lamps *lamps, Error *err)
{
    const Room  *room = lamps->room;
    const size_t n = room->surfaces->count;
    LampFaces    faces;
    uint32_t    *whole = array_create(2 * n, sizeof *whole, "lamps", err); /* face + 1 */
    bool         good = whole != NULL && lamp_faces_find(&faces, room, err);
    for (uint32_t f = 0; good && f < faces.face_count; f++)
        for (uint32_t i = faces.face[f].begin; i < faces.face[f].end; i++)
            whole[faces.piece[i].side * n + faces.piece[i].surface] = f + 1;
    for (uint32_t i = 0; good && i < n; i++)
        for (unsigned side = 0; good && side < 2; side++) {
            const size_t at = side * n + i;
            const uint32_t before = lamps->count;
            if ((room->emitting[i] >> side & 1) == 0 || lamps->first[at] != UINT32_MAX)
                continue;
            good = whole[at] == 0 ? add_surface(lamps, i, side, err)
                                  : add_face(lamps, &faces, &faces.face[whole[at] - 1], err);
            if (lamps->count > before && whole[at] == 0)
                lamps->first[at] = before;
        }
    if (whole != NULL)
        lamp_faces_clear(&faces);
    array_free(whole);
    return good;
}

static bool index_create(Lamps *lamps, Error *err)
{
    const size_t n = lamps->room->surfaces->count;
    lamps->first = array_create(2 * n, sizeof *lamps->first, "lamps", err);
    for (size_t i = 0; lamps->first != NULL && i < 2 * n; i++)
        lamps->first[i] = UINT32_MAX;
    return lamps->first != NULL;
}

bool lamps_init(Lamps *lamps, const Room *room, Error *err)
{
    *lamps = (Lamps){ .room = room, .flat = true };
    if (!index_create(lamps, err) || !add_all(lamps, err))
        return false;
    for (uint32_t i = 0; i < lamps->count; i++)
        lamps->flat = lamps->flat && lamps->lamp[i].facet.count > 0;
    lamps->many = lamps->count > LAMPS_WEIGHED;
    lamps->shared = lamps->many || !lamps->flat;
    lamps->flat = lamps->flat && !lamps->many;
    choose_weighed(lamps);
    return !lamps->many || make_tree(lamps, err);
}

void lamps_clear(Lamps *lamps)
{
    array_free(lamps->lamp);
    lamp_tree_clear(&lamps->tree);
    array_free(lamps->first);
    *lamps = (Lamps){ 0 };
}

/* --- weights --------------------------------------------------------------------------------- */

/* What a lamp sends to the receiver, roughly: 0 only when it certainly sends nothing. */
static double rough_weight(const Lamp *lamp, const Receiver *at)
{
    const Vec3   d = vec3_sub(lamp->centre, at->point);
    const double distance = vec3_length(d);
    const double above = vec3_dot(d, at->normal) + lamp->radius; /* highest point of its ball */
    if (above <= 0)
        return 0;
    const double reach = fmax(distance, lamp->radius);
    return lamp->strength * lamp->area * fmin(above / reach, 1) / (reach * reach);
}

/* A receiver nearer to a facet's plane than rays' origins are moved sees nothing of it. */
static double lamp_weight(const Lamps *lamps, const Lamp *lamp, const Receiver *at)
{
    if (lamp->facet.count == 0)
        return rough_weight(lamp, at);
    if (facet_height(&lamp->facet, at->point) <= lamps->room->offset)
        return 0;
    return lamp->strength * facet_irradiance(&lamp->facet, at->point, at->normal);
}

/* What lamps send to a receiver, to choose among them. */
typedef struct {
    double below[LAMPS_WEIGHED + 1]; /* running sums of those that are weighed */
    double all;                      /* with what the others may send */
} Weights;

static void weigh(const Lamps *lamps, const Receiver *at, Weights *w)
{
    const uint32_t n = lamps->weighed_count;
    w->below[0] = 0;
    for (uint32_t i = 0; i < n; i++)
        w->below[i + 1] = w->below[i] +
                          lamp_weight(lamps, &lamps->lamp[lamps->weighed[i]], at);
    w->all = w->below[n];
    if (lamps->many)
        w->all += lamp_tree_most(&lamps->tree, at->point, at->normal);
}

/* Finds i with below[i] <= x < below[i + 1] and moves x to its place between them, 0..1. */
static uint32_t pick(const double *below, uint32_t count, double *x)
{
    uint32_t lo = 0, hi = count;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (below[middle] <= *x)
            lo = middle;
        else
            hi = middle;
    }
    /* x may round up to the total: back to the last that has a width. */
    while (lo > 0 && !(below[lo + 1] > below[lo]))
        lo--;
    const double width = below[lo + 1] - below[lo];
    *x = width > 0 ? fmin(fmax((*x - below[lo]) / width, 0), 1 - DBL_EPSILON) : 0;
    return lo;
}

/* Chooses a lamp by *x, as lamp_tree_choose does. */
static uint32_t choose(const Lamps *lamps, const Receiver *at, const Weights *w, double *x,
                       double *chance)
{
    const uint32_t n = lamps->weighed_count;
    const double   known = w->below[n], place = *x * w->all;
    if (!lamps->many || (n > 0 && place < known)) {
        *x = place;
        const uint32_t i = pick(w->below, n, x);
        *chance = (w->below[i + 1] - w->below[i]) / w->all;
        return lamps->weighed[i];
    }
    *x = fmin(fmax((place - known) / (w->all - known), 0), 1 - DBL_EPSILON);
    const uint32_t k = lamp_tree_choose(&lamps->tree, at->point, at->normal, x, chance);
    *chance *= (w->all - known) / w->all;
    return k;
}

/* --- samples --------------------------------------------------------------------------------- */

/* A point of the lamp; returns 1 / density per solid angle, 0 when it shows its dark side. */
static double lamp_point(const Lamps *lamps, const Lamp *lamp, const Receiver *at, double a,
                         double b, LampSample *out)
{
    if (lamp->facet.count > 0) {
        if (facet_height(&lamp->facet, at->point) <= lamps->room->offset)
            return 0;
        out->normal = lamp->facet.normal;
        return facet_sample(&lamp->facet, at->point, a, b, &out->point);
    }
    SurfacePoint p;
    surfaces_point(lamps->room->surfaces, lamp->surface, a, b, &p);
    out->point = p.point;
    out->normal = lamp->side == 0 ? p.normal : vec3_scale(p.normal, -1);
    const Vec3   d = vec3_sub(at->point, p.point);
    const double dd = vec3_dot(d, d), height = vec3_dot(d, out->normal);
    return height > lamps->room->offset ? p.density * height / (dd * sqrt(dd)) : 0;
}

/* Hemisphere rays that would find a lamp so much more seldom than lamp samples do are left out
 * (cutoff heuristic [veach95]): a hit now and then would be noise, and none at all a loss that no
 * standard error knows of. */
static const double CUTOFF = 0.1;

/* Share of the lamp sample against a hemisphere ray in the same direction: the balance heuristic.
 * spread: 1 / density of the lamp sample, choice of the lamp included. That rays may be guided is
 * left out: any two shares that add up to 1 give the right mean. */
static double balance(const LampPlan *plan, double spread, double cosine)
{
    const double ratio = plan->gather_rays * cosine / PI * spread / plan->lamp_rays;
    return ratio < CUTOFF ? 1 : 1 / (1 + ratio);
}

bool lamps_sample(const Lamps *lamps, const Receiver *at, const LampPlan *plan, double a, double b,
                  LampSample *out)
{
    Weights w;
    double  x = a, chance = 0;
    weigh(lamps, at, &w);
    if (!(w.all > 0))
        return false;
    const uint32_t k = choose(lamps, at, &w, &x, &chance);
    *out = (LampSample){ .point = at->point, .normal = at->normal, /* a lamp seen from behind */
                         .lamp = k == LAMP_TREE_NONE ? LAMP_NONE : k };
    out->value = out->control = rgb(0, 0, 0);
    if (k == LAMP_TREE_NONE)
        return true;
    const Lamp    *lamp = &lamps->lamp[k];
    const double   spread = lamp_point(lamps, lamp, at, x, b, out);
    const double   cosine = spread > 0 ? vec3_dot(vec3_unit(vec3_sub(out->point, at->point)),
                                                  at->normal)
                                       : 0;
    if (cosine > 0) {
        double value = cosine * spread / chance;
        if (lamps->many || lamp->facet.count == 0)
            value *= balance(plan, spread / chance, cosine);
        out->value = rgb_scale(lamp->radiance, value);
    }
    out->control = out->value;
    if (lamps->flat) { /* the weights are the irradiances: their sum is what all samples' mean is */
        out->control = rgb(0, 0, 0);
        for (uint32_t i = 0; i < lamps->count; i++)
            out->control =
                rgb_mad(out->control, (w.below[i + 1] - w.below[i]) / lamps->lamp[i].strength,
                        lamps->lamp[i].radiance);
    } else if (!lamps->many && lamp->facet.count > 0) {
        out->control = rgb_scale(lamp->radiance, w.all / lamp->strength);
    }
    return true;
}

Rgb lamps_control(const Lamps *lamps, uint32_t k, const Receiver *at)
{
    const Lamp *lamp = &lamps->lamp[k];
    assert(lamps->flat && k < lamps->count);
    return rgb_scale(lamp->radiance, lamp_weight(lamps, lamp, at) / lamp->strength);
}

/* How far a point lies inside a triangle: the least of its three heights over the edges, each
 * relative to the edge's length. */
static double depth_in(const Facet *facet, Vec3 p)
{
    double least = INFINITY;
    for (int i = 0; i < 3; i++) {
        const Vec3 a = facet->corner[i], e = vec3_sub(facet->corner[(i + 1) % 3], a);
        const Vec3 across = vec3_cross(facet->normal, vec3_unit(e));
        least = fmin(least, vec3_dot(across, vec3_sub(p, a)));
    }
    return least;
}

static uint32_t lamp_of_fan(const Lamps *lamps, uint32_t first, Vec3 p)
{
    uint32_t deepest = first;
    double   most = -INFINITY;
    for (uint32_t k = first; k < first + lamps->lamp[first].fan; k++) {
        const double depth = depth_in(&lamps->lamp[k].facet, p);
        if (depth > most) {
            most = depth;
            deepest = k;
        }
    }
    return deepest;
}

/* The lamp a hit belongs to: a bent quad has two, told apart by the primitive, a face of many
 * corners a fan of them. */
static uint32_t lamp_of(const Lamps *lamps, const RoomHit *hit)
{
    const Surfaces *surfaces = lamps->room->surfaces;
    const uint32_t  k = lamps->first[hit->side * (size_t)surfaces->count + hit->surface];
    if (k == UINT32_MAX || lamps->lamp[k].facet.count != 3)
        return k;
    if (lamps->lamp[k].fan > 0)
        return lamp_of_fan(lamps, k, hit->point);
    const bool second = hit->primitive != surfaces->surface[hit->surface].primitive;
    const bool follows = k + 1 < lamps->count && lamps->lamp[k + 1].surface == hit->surface &&
                         lamps->lamp[k + 1].side == hit->side;
    return second && follows ? k + 1 : k;
}

/* Chance that a lamp sample at the receiver goes to lamp k. */
static double chance_of(const Lamps *lamps, const Receiver *at, uint32_t k)
{
    Weights  w;
    uint32_t i = 0;
    weigh(lamps, at, &w);
    if (!(w.all > 0))
        return 0;
    while (i < lamps->weighed_count && lamps->weighed[i] < k)
        i++;
    if (i < lamps->weighed_count && lamps->weighed[i] == k)
        return (w.below[i + 1] - w.below[i]) / w.all;
    const double rest = w.all - w.below[lamps->weighed_count];
    return rest / w.all * lamp_tree_chance(&lamps->tree, at->point, at->normal, k);
}

/* 1 / density with which lamp_point would have found the hit; 0: never. */
static double spread_of(const Lamps *lamps, const Lamp *lamp, const Receiver *at,
                        const RoomHit *hit)
{
    if (lamp->facet.count > 0)
        return facet_height(&lamp->facet, at->point) > lamps->room->offset
                   ? facet_spread(&lamp->facet, at->point, hit->point) : 0;
    SurfacePoint p;
    surfaces_point(lamps->room->surfaces, hit->surface, hit->s, hit->t, &p);
    const Vec3   d = vec3_sub(at->point, hit->point);
    const double dd = vec3_dot(d, d), height = vec3_dot(d, hit->normal);
    return height > lamps->room->offset ? p.density * height / (dd * sqrt(dd)) : 0;
}

double lamps_share(const Lamps *lamps, const Receiver *at, const LampPlan *plan,
                   const RoomHit *hit)
{
    const uint32_t k = lamps->shared ? lamp_of(lamps, hit) : UINT32_MAX;
    if (k == UINT32_MAX || (lamps->lamp[k].facet.count > 0 && !lamps->many))
        return 0;
    const double chance = chance_of(lamps, at, k);
    const double spread = spread_of(lamps, &lamps->lamp[k], at, hit);
    const double cosine = vec3_dot(vec3_unit(vec3_sub(hit->point, at->point)), at->normal);
    if (!(chance > 0) || !(spread > 0) || !(cosine > 0))
        return 1; /* lamp samples leave this out */
    return 1 - balance(plan, spread / chance, cosine);
}

/* --- any scattering -------------------------------------------------------------------------- */

bool lamps_aim(const Lamps *lamps, const Receiver *at, double a, double b, LampSample *out,
               Rgb *radiance, double *density)
{
    Weights w;
    double  x = a, chance = 0;
    assert(lamps->count > 0);
    weigh(lamps, at, &w);
    if (!(w.all > 0))
        return false;
    const uint32_t k = choose(lamps, at, &w, &x, &chance);
    if (k == LAMP_TREE_NONE)
        return false;
    *out = (LampSample){ .lamp = k };
    const double spread = lamp_point(lamps, &lamps->lamp[k], at, x, b, out);
    *radiance = lamps->lamp[k].radiance;
    *density = spread > 0 ? chance / spread : 0;
    return *density > 0;
}

double lamps_density(const Lamps *lamps, const Receiver *at, const RoomHit *hit)
{
    const uint32_t k = lamp_of(lamps, hit);
    if (k == UINT32_MAX)
        return 0;
    const double spread = spread_of(lamps, &lamps->lamp[k], at, hit);
    return spread > 0 ? chance_of(lamps, at, k) / spread : 0;
}

/* --- point lights ---------------------------------------------------------------------------- */

Rgb lamps_light(const Light *light, const Receiver *at)
{
    const Vec3   d = vec3_sub(light->position, at->point);
    const double dd = vec3_dot(d, d), height = vec3_dot(d, at->normal);
    if (!(height > 0))
        return rgb(0, 0, 0);
    const double distance = sqrt(dd);
    const double share = light_share(light, vec3_scale(d, -1 / distance));
    return rgb_scale(light->intensity, share * height / (dd * distance));
}

bool lamps_sample_light(const Lamps *lamps, const Receiver *at, double a, LampSample *out)
{
    const Room *room = lamps->room;
    double      total = 0;
    Rgb         all = { 0, 0, 0 };
    for (size_t i = 0; i < room->light_count; i++) {
        const Rgb e = lamps_light(&room->lights[i], at);
        total += strength_of(e);
        all = rgb_add(all, e);
    }
    if (!(total > 0))
        return false;
    double below = 0;
    for (size_t i = 0; i < room->light_count; i++) {
        const Rgb    e = lamps_light(&room->lights[i], at);
        const double strength = strength_of(e);
        below += strength;
        /* The second part of the test: a total that rounding kept above the sum. */
        if (strength > 0 && (a * total < below || below >= total * (1 - DBL_EPSILON))) {
            out->point = room->lights[i].position;
            out->normal = vec3(0, 0, 0);
            out->value = rgb_scale(e, total / strength);
            out->control = all;
            out->lamp = (uint32_t)i;
            return true;
        }
    }
    return false;
}
