/* SPDX-License-Identifier: BSD-3-Clause */
/* math/shape: rays against curved shapes, checked by points on them and dense sampling. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "math/sampling.h"
#include "math/shape.h"

/* -1 .. 1 */
static double random_signed(uint32_t seed, uint32_t i)
{
    return sampling_seed(seed, i, 78, 0) * 0x1p-31 - 1;
}

static Vec3 random_vec3(uint32_t seed, uint32_t i)
{
    return vec3(random_signed(seed, i), random_signed(seed, i + 1), random_signed(seed, i + 2));
}

static Shape shape_make(ShapeKind kind, double ratio, const Affine *map)
{
    Shape shape;
    Error err = { 0 };
    assert_true(shape_init(&shape, kind, ratio, map, &err));
    return shape;
}

static Shape shape_unit(ShapeKind kind, double ratio)
{
    const Affine map = affine_identity();
    return shape_make(kind, ratio, &map);
}

/* Any of the forms under a map with noise, stretched up to 20 times one way, half of them
 * mirrored. */
static Shape shape_random(uint32_t seed)
{
    static const double ratios[] = { 0, 0.5, 1, 1.7 };
    static const double tubes[] = { 0.01, 0.2, 0.7, 0.99 };
    const ShapeKind kind = (ShapeKind)(seed % 4);
    const double ratio = (kind == SHAPE_TORUS ? tubes : ratios)[seed / 4 % 4];
    const double stretch = exp2(4.3 * random_signed(seed, 30));
    Affine map = affine_identity();
    map.x = vec3_mad(map.x, 0.5, random_vec3(seed, 0));
    map.y = vec3_mad(map.y, 0.5, random_vec3(seed, 3));
    map.z = vec3_mad(vec3(0, 0, stretch), 0.4, random_vec3(seed, 6));
    if (seed & 16)
        map.x = vec3_scale(map.x, -1);
    map.t = vec3_scale(random_vec3(seed, 9), 3);
    return shape_make(kind, ratio, &map);
}

/* Signed side of a local point, by the definitions in the header; 0 never matters. */
static double side(const Shape *shape, Vec3 p)
{
    const double r = sqrt(p.x * p.x + p.y * p.y);
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return vec3_length(p) - 1;
    case SHAPE_DISC:
        return p.z;
    case SHAPE_FRUSTUM:
        return r - (1 + (shape->ratio - 1) * p.z);
    case SHAPE_TORUS:
        break;
    }
    return hypot(r - 1, p.z) - shape->ratio;
}

/* Whether a change of side between two local points is on the shape's own part of the surface. */
static bool within(const Shape *shape, Vec3 a, Vec3 b)
{
    if (shape->kind == SHAPE_DISC)
        return fmax(vec3_dot(a, a), vec3_dot(b, b)) < 1;
    if (shape->kind == SHAPE_FRUSTUM)
        return fmin(a.z, b.z) > 0 && fmax(a.z, b.z) < 1;
    return true;
}

/* End of the first of `steps` equal steps over t = 0..t_end in which the side changes; infinite
 * when there is none. */
static double first_change(const Shape *shape, Vec3 origin, Vec3 direction, double t_end, int steps)
{
    const Vec3 o = affine_point(&shape->to_local, origin);
    const Vec3 d = affine_vector(&shape->to_local, direction);
    Vec3 last = o;
    double before = side(shape, o);
    for (int i = 1; i <= steps; i++) {
        const double t = t_end * i / steps;
        const Vec3 p = vec3_mad(o, t, d);
        const double now = side(shape, p);
        if ((now < 0) != (before < 0) && within(shape, last, p))
            return t;
        last = p;
        before = now;
    }
    return INFINITY;
}

/* A hit lies on the surface, where its parameters say, and within the range. */
static void expect_on_surface(const Shape *shape, Vec3 origin, Vec3 direction, const ShapeHit *hit)
{
    const Vec3 at = vec3_mad(origin, hit->t, direction);
    const Vec3 named = shape_point(shape, hit->u, hit->v);
    /* Rounding of coordinates up to the largest on the way, seen through map and inverse (norm
     * times norm), over the angle at which a thin tube or a cone's tip magnifies it (100). */
    const double norm = vec3_length(shape->to_world.x) + vec3_length(shape->to_world.y) +
                        vec3_length(shape->to_world.z);
    const double back = vec3_length(shape->to_local.x) + vec3_length(shape->to_local.y) +
                        vec3_length(shape->to_local.z);
    const double size = vec3_length(origin) + vec3_length(vec3_sub(at, origin)) + norm;
    const double tolerance = 100 * norm * back * size * 0x1p-53;
    assert_true(hit->u >= 0 && hit->u <= 1 && hit->v >= 0 && hit->v <= 1);
    if (!(vec3_length(vec3_sub(at, named)) <= tolerance))
        fail_msg("kind %d ratio %g: off by %g, allowed %g", (int)shape->kind, shape->ratio,
                 vec3_length(vec3_sub(at, named)), tolerance);
}

/* Which side was met, but where the ray grazes: there roundings decide. */
static void expect_side(const Shape *shape, Vec3 direction, const ShapeHit *hit)
{
    const Vec3   n = shape_normal(shape, hit->u, hit->v);
    const double rise = vec3_dot(n, vec3_unit(direction));
    if (fabs(rise) > 1e-6)
        assert_true(hit->front == (rise < 0));
}

static void hits_agree_with_parameters(void **state)
{
    (void)state;
    unsigned hits = 0;
    for (uint32_t seed = 0; seed < 100000; seed++) {
        const Shape shape = shape_random(seed >> 4 << 2 | (seed & 3));
        const Vec3 origin = vec3_scale(random_vec3(seed, 40), 8);
        const Vec3 target = shape_point(&shape, 0.5 + random_signed(seed, 50) / 2,
                                        0.5 + random_signed(seed, 51) / 2);
        const Vec3 aim = vec3_mad(target, 0.2, random_vec3(seed, 60));
        const Vec3 direction = vec3_scale(vec3_sub(aim, origin), exp2(random_signed(seed, 70)));
        ShapeHit hit;
        if (shape_intersect(&shape, origin, direction, 0, INFINITY, &hit)) {
            assert_true(hit.t > 0);
            expect_on_surface(&shape, origin, direction, &hit);
            expect_side(&shape, direction, &hit);
            hits++;
        }
    }
    assert_true(hits > 40000);
}

/* A ray aimed at a point of the surface hits there or before. */
static void hits_are_not_missed(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 100000; seed++) {
        const Shape shape = shape_random(seed >> 4 << 2 | (seed & 3));
        const Vec3 origin = vec3_scale(random_vec3(seed, 40), 8);
        const double u = 0.5 + random_signed(seed, 50) / 2;
        const double v = 0.5 + 0.499 * random_signed(seed, 51); /* rims may be missed by rounding */
        const Vec3 direction = vec3_sub(shape_point(&shape, u, v), origin);
        const Vec3 n = shape_normal(&shape, u, v);
        ShapeHit hit;
        /* At a grazing hit a rounding of the aim decides; 1e-6 is far above it. */
        if (fabs(vec3_dot(n, direction)) < 1e-6 * vec3_length(direction))
            continue;
        assert_true(shape_intersect(&shape, origin, direction, 0, INFINITY, &hit));
        assert_true(hit.t < 1 + 1e-6);
    }
}

/* What dense sampling finds, the solver finds there or earlier; that what it finds earlier is
 * real, the tests above show. */
static void hits_come_before_sampled_changes(void **state)
{
    (void)state;
    unsigned changes = 0;
    for (uint32_t seed = 0; seed < 12000; seed++) {
        const uint32_t form = seed % 3 == 0 ? seed >> 4 << 2 | (seed & 3) : seed | 3;
        const Shape shape = shape_random(form);
        const Vec3 origin = vec3_mad(shape.to_world.t, 3, random_vec3(seed, 40));
        const Vec3 aim = vec3_add(shape.to_world.t, random_vec3(seed, 60));
        const Vec3 direction = vec3_unit(vec3_sub(aim, origin));
        const double t_end = 12;
        const int steps = 1500;
        const double change = first_change(&shape, origin, direction, t_end, steps);
        ShapeHit hit;
        if (!isfinite(change))
            continue;
        changes++;
        assert_true(shape_intersect(&shape, origin, direction, 0, t_end * 2, &hit));
        assert_true(hit.t <= change * (1 + 1e-9));
    }
    assert_true(changes > 3000);
}

/* All crossings in turn, each search starting at the last, against all sampled changes. */
static void torus_crossings_are_complete(void **state)
{
    (void)state;
    unsigned fours = 0;
    for (uint32_t seed = 0; seed < 3000; seed++) {
        const double tubes[] = { 0.003, 0.1, 0.5, 0.95, 0.9999 };
        const Shape torus = shape_unit(SHAPE_TORUS, tubes[seed % 5]);
        Vec3 direction = vec3_unit(random_vec3(seed, 1));
        const Vec3 through = vec3_scale(random_vec3(seed, 5), 0.9);
        if (seed % 2 == 0) /* flat rays meet the tube four times */
            direction = vec3_unit(vec3(direction.x, direction.y, 0.05 * direction.z));
        const Vec3 flat = vec3(through.x, through.y, torus.ratio * through.z);
        const Vec3 origin = vec3_mad(flat, -4, direction);
        int found = 0, sampled = 0;
        ShapeHit hit;
        double from = 0;
        bool grazing = false;
        while (found < 6 && shape_intersect(&torus, origin, direction, from, 8, &hit)) {
            expect_on_surface(&torus, origin, direction, &hit);
            /* Roundings of the surface, 1e-15, over the slope are how far t may be off; where that
             * nears the step past the crossing, the same one may be found twice. */
            grazing |= fabs(vec3_dot(shape_normal(&torus, hit.u, hit.v), direction)) < 1e-3;
            from = hit.t + 1e-11;
            found++;
        }
        if (grazing)
            continue;
        double before = side(&torus, origin);
        for (int i = 1; i <= 4000; i++) {
            const double now = side(&torus, vec3_mad(origin, 8.0 * i / 4000, direction));
            sampled += (now < 0) != (before < 0);
            before = now;
        }
        assert_true(found % 2 == 0 && found <= 4);
        assert_true(found >= sampled); /* sampling may step over a short chord */
        fours += found == 4;
    }
    assert_true(fours > 200);
}

/* --- known answers --------------------------------------------------------------------------- */

typedef struct {
    ShapeKind kind;
    double    ratio;
    Vec3      origin, direction;
    double    t_min, t_max;
    double    t; /* < 0: no hit */
} Case;

static void hits_of_known_rays(void **state)
{
    (void)state;
    const double far = INFINITY;
    const Case table[] = {
        { SHAPE_SPHERE, 0, { -5, 0, 0 }, { 1, 0, 0 }, 0, far, 4 },
        { SHAPE_SPHERE, 0, { -5, 0, 0 }, { 2, 0, 0 }, 2, far, 3 },
        { SHAPE_SPHERE, 0, { -5, 0, 0 }, { 1, 0, 0 }, 0, 4, -1 }, /* ranges are open */
        { SHAPE_SPHERE, 0, { -5, 0, 0 }, { 1, 0, 0 }, 4, 6, -1 },
        { SHAPE_SPHERE, 0, { -5, 0, 0 }, { -1, 0, 0 }, 0, far, -1 },
        { SHAPE_SPHERE, 0, { 0, 0, 0 }, { 0, 0, -4 }, 0, far, 0.25 }, /* from inside */
        { SHAPE_SPHERE, 0, { 0, 2, 0 }, { 1, 0, 0 }, 0, far, -1 },
        { SHAPE_SPHERE, 0, { -1e9, 0, 0 }, { 1, 0, 0 }, 0, far, 1e9 - 1 },
        { SHAPE_DISC, 0, { 0.5, 0, 3 }, { 0, 0, -1 }, 0, far, 3 },
        { SHAPE_DISC, 0, { 0.5, 0, -3 }, { 0, 0, 1 }, 0, far, 3 }, /* both sides */
        { SHAPE_DISC, 0, { 1.5, 0, 3 }, { 0, 0, -1 }, 0, far, -1 },
        { SHAPE_DISC, 0, { -3, 0, 0 }, { 1, 0, 0 }, 0, far, -1 }, /* in its plane */
        { SHAPE_DISC, 0, { -3, 0, 1 }, { 1, 0, 0 }, 0, far, -1 },
        { SHAPE_FRUSTUM, 1, { -3, 0, 0.5 }, { 1, 0, 0 }, 0, far, 2 },
        { SHAPE_FRUSTUM, 1, { 0, 0, 0.5 }, { 1, 0, 0 }, 0, far, 1 },
        { SHAPE_FRUSTUM, 1, { 0, 0, -3 }, { 0, 0, 1 }, 0, far, -1 }, /* no lids */
        { SHAPE_FRUSTUM, 1, { -3, 0, 1.5 }, { 1, 0, 0 }, 0, far, -1 },
        { SHAPE_FRUSTUM, 1, { -2, 0, 2 }, { 1, 0, -0.5 }, 0, far, 3 }, /* past the rim, inside */
        { SHAPE_FRUSTUM, 0, { -3, 0, 0.5 }, { 1, 0, 0 }, 0, far, 2.5 },
        { SHAPE_FRUSTUM, 0, { -3, 0, 1.5 }, { 1, 0, 0 }, 0, far, -1 }, /* not the mirror cone */
        { SHAPE_FRUSTUM, 0, { 0.5, 0, 3 }, { 0, 0, -1 }, 0, far, 2.5 },
        { SHAPE_FRUSTUM, 0, { -1, 0, 1 }, { 1, 0, -1 }, 0, far, 0.5 }, /* along a generator */
        { SHAPE_FRUSTUM, 3, { -4, 0, 1 }, { 1, 0, -0.5 }, 0, far, -1 }, /* parallel to its side */
        { SHAPE_FRUSTUM, 3, { -4, 0, 0.5 }, { 1, 0, 0 }, 0, far, 2 },
        { SHAPE_TORUS, 0.25, { -5, 0, 0 }, { 1, 0, 0 }, 0, far, 3.75 },
        { SHAPE_TORUS, 0.25, { -5, 0, 0 }, { 1, 0, 0 }, 3.75, far, 4.25 },
        { SHAPE_TORUS, 0.25, { -5, 0, 0 }, { 1, 0, 0 }, 4.5, far, 5.75 },
        { SHAPE_TORUS, 0.25, { -5, 0, 0 }, { 1, 0, 0 }, 6, far, 6.25 },
        { SHAPE_TORUS, 0.25, { -5, 0, 0 }, { 1, 0, 0 }, 6.5, far, -1 },
        { SHAPE_TORUS, 0.25, { 0, 0, -5 }, { 0, 0, 1 }, 0, far, -1 }, /* through the hole */
        { SHAPE_TORUS, 0.25, { 1, 0, 5 }, { 0, 0, -2 }, 0, far, 2.375 },
        { SHAPE_TORUS, 0.25, { 0, 0, 0 }, { 0, 1, 0 }, 0, far, 0.75 },
        { SHAPE_TORUS, 0.25, { 0, 0, 0.3 }, { 0, 1, 0 }, 0, far, -1 },
        { SHAPE_TORUS, 0.25, { 1, -5, 0 }, { 0, 1, 0 }, 0, far, 4.25 }, /* along the ring; 1.25 */
        { SHAPE_TORUS, 0.25, { 5, 5, 5 }, { 1, 1, 1 }, 0, far, -1 },
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const Case *c = &table[i];
        const Shape shape = shape_unit(c->kind, c->ratio);
        ShapeHit hit = { .t = -7, .u = -7, .v = -7 };
        const bool got = shape_intersect(&shape, c->origin, c->direction, c->t_min, c->t_max, &hit);
        if (got != (c->t >= 0) || (got && !(fabs(hit.t - c->t) <= 1e-14 * (1 + c->t))))
            fail_msg("case %zu: t %.17g, expected %.17g", i, hit.t, c->t);
        if (!got)
            assert_true(hit.t == -7);
    }
}

/* The silhouette seen from far: rays just inside hit, rays just outside miss. */
static void hits_at_silhouettes(void **state)
{
    (void)state;
    const Shape sphere = shape_unit(SHAPE_SPHERE, 0), torus = shape_unit(SHAPE_TORUS, 0.25);
    ShapeHit hit;
    for (int k = 1; k <= 12; k++) {
        const double e = pow(10, -k);
        const Vec3 d = { 1, 0, 0 };
        assert_true(shape_intersect(&sphere, vec3(-50, 1 - e, 0), d, 0, 100, &hit));
        assert_false(shape_intersect(&sphere, vec3(-50, 1 + e, 0), d, 0, 100, &hit));
        assert_true(shape_intersect(&torus, vec3(-50, 1.25 - e, 0), d, 0, 100, &hit));
        assert_false(shape_intersect(&torus, vec3(-50, 1.25 + e, 0), d, 0, 100, &hit));
        assert_true(shape_intersect(&torus, vec3(-50, 1, 0.25 - e), d, 0, 100, &hit));
        assert_false(shape_intersect(&torus, vec3(-50, 1, 0.25 + e), d, 0, 100, &hit));
        assert_true(shape_intersect(&torus, vec3(0, 0.75 + e, -9), vec3(0, 0, 1), 0, 100, &hit));
        assert_false(shape_intersect(&torus, vec3(0, 0.75 - e, -9), vec3(0, 0, 1), 0, 100, &hit));
    }
}

/* A ray that leaves a surface point does not meet it again at once, and meets the far side. */
static void hits_from_the_surface(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 20000; seed++) {
        const double ratio = seed % 2 ? 0.3 : 0.9;
        const Shape shape = shape_unit(seed % 3 ? SHAPE_TORUS : SHAPE_SPHERE, ratio);
        const double u = 0.5 + random_signed(seed, 1) / 2, v = 0.5 + random_signed(seed, 2) / 2;
        const Vec3 at = shape_point(&shape, u, v), n = shape_normal(&shape, u, v);
        const Vec3 direction = vec3_unit(vec3_mad(random_vec3(seed, 3), -1.5, n));
        ShapeHit hit;
        if (!(vec3_dot(direction, n) < -0.1))
            continue;
        assert_true(shape_intersect(&shape, at, direction, 1e-9, 100, &hit)); /* inwards */
        const double shortest = 2 * 0.1 * ratio * (shape.kind == SHAPE_TORUS ? 1 - ratio : 1);
        assert_true(hit.t > shortest / 4);
        expect_on_surface(&shape, at, direction, &hit);
    }
}

static void hits_survive_nonsense(void **state)
{
    (void)state;
    const double odd[] = { NAN, INFINITY, -INFINITY, 0, 1e308, -1e308, 5e-324, 1 };
    for (uint32_t form = 0; form < 16; form++) {
        const Shape shape = shape_random(form);
        for (uint32_t i = 0; i < 20000; i++) {
            double e[8];
            for (uint32_t k = 0; k < 8; k++)
                e[k] = odd[sampling_seed(i, k, 3, form) % 8];
            ShapeHit hit = { .t = -7, .u = -7, .v = -7 };
            if (shape_intersect(&shape, vec3(e[0], e[1], e[2]), vec3(e[3], e[4], e[5]), e[6], e[7],
                                &hit)) {
                assert_true(hit.t > e[6] && hit.t < e[7]);
                assert_true(hit.u >= 0 && hit.u <= 1 && hit.v >= 0 && hit.v <= 1);
            }
        }
    }
    const Shape sphere = shape_unit(SHAPE_SPHERE, 0);
    ShapeHit hit;
    assert_false(shape_intersect(&sphere, vec3(0, 0, 0), vec3(0, 0, 0), 0, 9, &hit));
    assert_false(shape_intersect(&sphere, vec3(0, 0, 0), vec3(1, 0, 0), NAN, 9, &hit));
    assert_false(shape_intersect(&sphere, vec3(0, 0, 0), vec3(1, 0, 0), 0, NAN, &hit));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_agree_with_parameters),
        cmocka_unit_test(hits_are_not_missed),
        cmocka_unit_test(hits_come_before_sampled_changes),
        cmocka_unit_test(torus_crossings_are_complete),
        cmocka_unit_test(hits_of_known_rays),
        cmocka_unit_test(hits_at_silhouettes),
        cmocka_unit_test(hits_from_the_surface),
        cmocka_unit_test(hits_survive_nonsense),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
