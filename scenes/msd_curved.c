/* SPDX-License-Identifier: BSD-3-Clause */
/* Round objects of MSD: they stay exact shapes. */
#include <assert.h>
#include <math.h>

#include "scenes/msd.h"

/* A shape of the unit form `kind`, put into the object's space by `local`. */
typedef struct {
    ShapeKind kind;
    double    ratio;
    Affine    local;
} Part;

enum { PARTS_MAX = 3 };

static bool parts_add(MsdReader *r, const MsdThing *thing, const Part *part, int count)
{
    uint32_t group = 0;

    if (r->dry > 0)
        return true;
    if (!msd_count(r, thing->place, (uint64_t)count) || !msd_group(r, thing, &group))
        return false;
    for (int i = 0; i < count; i++) {
        const Affine to_world = affine_then(&part[i].local, &r->map);
        Shape        shape;
        Vec3         lo, hi;
        Error        cause = { 0 };
        if (!shape_init(&shape, part[i].kind, part[i].ratio, &to_world, &cause))
            return msd_error_from(r, thing->place, &cause);
        shape_bounds(&shape, &lo, &hi);
        if (!msd_reachable(r, thing->place, lo) || !msd_reachable(r, thing->place, hi) ||
            !polygons_add_shape(&r->scene->polygons, &shape, thing->material, group, r->err))
            return false;
    }
    return true;
}

static Affine scaled(Vec3 centre, double a, double b, double c)
{
    return (Affine){ { a, 0, 0 }, { 0, b, 0 }, { 0, 0, c }, centre };
}

/* z along the unit vector n, x and y across it, `radius` long; right-handed, so nothing turns. */
static Affine upright(Vec3 centre, Vec3 n, double radius, Vec3 z)
{
    Vec3 s, t;

    vec3_frame(n, &s, &t);
    return (Affine){ vec3_scale(s, radius), vec3_scale(t, radius), z, centre };
}

static Part lid(Vec3 centre, Vec3 outward, double radius)
{
    return (Part){ SHAPE_DISC, 0,
                   upright(centre, outward, radius, vec3_scale(outward, radius)) };
}

/* The coat between two circles, of which one may be a point. */
static Part coat(Vec3 bottom, Vec3 top, double r_bottom, double r_top)
{
    assert(r_bottom > 0 || r_top > 0);
    if (r_bottom > 0) {
        const Vec3 axis = vec3_sub(top, bottom);
        return (Part){ SHAPE_FRUSTUM, r_top / r_bottom,
                       upright(bottom, vec3_unit(axis), r_bottom, axis) };
    }
    return coat(top, bottom, r_top, r_bottom); /* the form has its tip at the top */
}

/* Two end points that differ. */
static bool axis_read(MsdReader *r, Vec3 *bottom, Vec3 *top, Vec3 *unit)
{
    if (!msd_vector(r, bottom))
        return false;
    const MsdPlace place = r->token.place;
    if (!msd_vector(r, top))
        return false;
    const double length = vec3_length(vec3_sub(*top, *bottom));
    if (!(length > 0 && isfinite(length)))
        return msd_error(r, place, "found the same point twice, expected a bottom and a top");
    *unit = vec3_unit(vec3_sub(*top, *bottom));
    return true;
}

static bool sphere_read(MsdReader *r, const MsdThing *thing)
{
    Vec3   centre = { 0 };
    double radius = 0;

    if (!msd_vector(r, &centre) || !msd_length(r, "a radius", &radius))
        return false;
    const Part part = { SHAPE_SPHERE, 0, scaled(centre, radius, radius, radius) };
    return parts_add(r, thing, &part, 1);
}

static bool ellipsoid_read(MsdReader *r, const MsdThing *thing)
{
    Vec3   centre = { 0 };
    double half[3] = { 0 };
    int    count = 0;

    if (!msd_vector(r, &centre) || !msd_sizes(r, 3, 3, false, half, &count))
        return false;
    const Part part = { SHAPE_SPHERE, 0, scaled(centre, half[0], half[1], half[2]) };
    return parts_add(r, thing, &part, 1);
}

static bool disc_read(MsdReader *r, const MsdThing *thing)
{
    Vec3   centre = { 0 }, normal = { 0 };
    double radius = 0;

    if (!msd_vector(r, &centre) || !msd_direction(r, "the disc's normal", &normal) ||
        !msd_length(r, "a radius", &radius))
        return false;
    const Part part = lid(centre, normal, radius);
    return parts_add(r, thing, &part, 1);
}

/* A solid: with its base. */
static bool cone_read(MsdReader *r, const MsdThing *thing)
{
    Vec3   base = { 0 }, top = { 0 }, up = { 0 };
    double radius = 0;

    if (!axis_read(r, &base, &top, &up) || !msd_length(r, "a radius", &radius))
        return false;
    const Part part[2] = { coat(base, top, radius, 0), lid(base, vec3_scale(up, -1), radius) };
    return parts_add(r, thing, part, 2);
}

/* CYLINDER_COAT has no lids, GEN_CYLINDER one at each end that is no point. Either takes one radius
 * for both ends or two. */
static bool cylinder_read(MsdReader *r, const MsdThing *thing)
{
    Vec3   bottom = { 0 }, top = { 0 }, up = { 0 };
    double radius[3] = { 0 };
    int    count = 0, parts = 0;
    Part   part[PARTS_MAX];

    if (!axis_read(r, &bottom, &top, &up))
        return false;
    const MsdPlace place = r->token.place;
    if (!msd_sizes(r, 1, 2, true, radius, &count))
        return false;
    if (count == 1)
        radius[1] = radius[0];
    if (!(radius[0] > 0 || radius[1] > 0))
        return msd_error(r, place, "found no radius above 0, expected one");
    part[parts++] = coat(bottom, top, radius[0], radius[1]);
    if (thing->word == WORD_GEN_CYLINDER && radius[0] > 0)
        part[parts++] = lid(bottom, vec3_scale(up, -1), radius[0]);
    if (thing->word == WORD_GEN_CYLINDER && radius[1] > 0)
        part[parts++] = lid(top, up, radius[1]);
    return parts_add(r, thing, part, parts);
}

/* About the z axis of its space. */
static bool torus_read(MsdReader *r, const MsdThing *thing)
{
    Vec3   centre = { 0 };
    double radius[3] = { 0 };
    int    count = 0;

    if (!msd_vector(r, &centre))
        return false;
    const MsdPlace place = r->token.place;
    if (!msd_sizes(r, 2, 2, false, radius, &count))
        return false;
    if (radius[1] >= radius[0])
        return msd_error(r, place, "found a torus of ring %g and tube %g, expected a tube thinner "
                                   "than the ring", radius[0], radius[1]);
    const Part part = { SHAPE_TORUS, radius[1] / radius[0],
                        scaled(centre, radius[0], radius[0], radius[0]) };
    return parts_add(r, thing, &part, 1);
}

bool msd_curved(MsdReader *r, const MsdThing *thing)
{
    switch (thing->word) {
    case WORD_SPHERE: return sphere_read(r, thing);
    case WORD_ELLIPSOID: return ellipsoid_read(r, thing);
    case WORD_DISC: return disc_read(r, thing);
    case WORD_CONE: return cone_read(r, thing);
    case WORD_TORUS: return torus_read(r, thing);
    default:
        assert(thing->word == WORD_CYLINDER_COAT || thing->word == WORD_GEN_CYLINDER);
        return cylinder_read(r, thing);
    }
}
