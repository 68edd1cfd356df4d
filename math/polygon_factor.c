/* SPDX-License-Identifier: BSD-3-Clause */
/* Exact form factors between flat polygons, by the integral along their outlines. */
#include "math/polygon_factor.h"

#include <assert.h>
#include <math.h>

#include "math/tolerance.h"

/* Steps of the double exponential rule: t runs to +-3.4, where the weight has fallen below 1e-20;
 * with a step of 1/12 the rule's error on ln is below 1e-14. */
enum { RULE_HALF = 41, RULE_POINTS = 2 * RULE_HALF + 1, GAUSS_POINTS = 10, MOST_CUTS = 6 };
static const double RULE_STEP = 1.0 / 12;

/* Ten points of Gauss-Legendre on an edge of length L leave an error of about rho^-20, where the
 * nearest singularity, d away, lies on the ellipse rho = (d + sqrt(d^2 + L^2/4)) / (L/2); at
 * d = 1.1 L that is 4e-14. */
static const double GAUSS_APART = 1.1;
static const double gauss_node[GAUSS_POINTS / 2] = {
    0.14887433898163122, 0.43339539412924719, 0.67940956829902440, 0.86506336668898451,
    0.97390652851717172 };
static const double gauss_weight[GAUSS_POINTS / 2] = {
    0.29552422471475287, 0.26926671930999635, 0.21908636251598204, 0.14945134915058059,
    0.06667134430868814 };

typedef struct {
    double place[RULE_POINTS], weight[RULE_POINTS]; /* on 0..1 */
} Rule;

static void rule_create(Rule *rule)
{
    for (int k = 0; k < RULE_POINTS; k++) {
        const double t = (k - RULE_HALF) * RULE_STEP, u = M_PI_2 * sinh(t);
        const double c = cosh(u);
        rule->place[k] = 1 / (1 + exp(-2 * u));
        rule->weight[k] = RULE_STEP * M_PI_4 * cosh(t) / (c * c);
    }
}

/* --- polygons --------------------------------------------------------------------------------- */

double flat_polygon_area(const FlatPolygon *p, Vec3 *normal)
{
    assert(p != NULL && normal != NULL && p->count <= POLYGON_FACTOR_CORNERS);
    Vec3 sum = vec3(0, 0, 0);
    for (size_t i = 1; i + 1 < p->count; i++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(p->corner[i], p->corner[0]),
                                       vec3_sub(p->corner[i + 1], p->corner[0])));
    const double twice = vec3_length(sum);
    *normal = twice > 0 ? vec3_scale(sum, 1 / twice) : vec3(0, 0, 0);
    return twice / 2;
}

static double largest_coordinate(const FlatPolygon *p)
{
    double largest = 0;
    for (size_t i = 0; i < p->count; i++)
        largest = fmax(largest, fmax(fabs(p->corner[i].x),
                                     fmax(fabs(p->corner[i].y), fabs(p->corner[i].z))));
    return largest;
}

/* What of p lies before the plane of q [sutherland74]. Corners nearer to the plane than positions
 * are known lie on it. Bridges that a concave polygon is left with are walked both ways: along an
 * outline they cancel. */
static void cut_behind(const FlatPolygon *p, const FlatPolygon *q, Vec3 normal, FlatPolygon *out)
{
    const double near = position_tolerance(fmax(largest_coordinate(p), largest_coordinate(q)));
    const Vec3 origin = q->corner[0];
    double before = 0;
    size_t last = p->count - 1;
    out->count = 0;
    bool ahead = false;
    for (size_t k = 0; k <= p->count; k++) {
        const size_t i = k % p->count;
        double height = vec3_dot(normal, vec3_sub(p->corner[i], origin));
        height = fabs(height) <= near ? 0 : height;
        if (k > 0 && height * before < 0 && out->count < POLYGON_FACTOR_CORNERS)
            out->corner[out->count++] = vec3_lerp(p->corner[last], p->corner[i],
                                                  before / (before - height));
        if (k < p->count && height >= 0 && out->count < POLYGON_FACTOR_CORNERS) {
            out->corner[out->count++] = p->corner[i];
            ahead = ahead || height > 0;
        }
        before = height;
        last = i;
    }
    if (!ahead)
        out->count = 0; /* nothing, or all of it in the plane */
}

/* --- one pair of edges ------------------------------------------------------------------------ */

typedef struct {
    Vec3   from, along; /* unit direction */
    double length;
} Edge;

/* The integral of ln sqrt(h^2 + s^2) over s, from 0. */
static double log_integral(double s, double h2, double h)
{
    const double r2 = h2 + s * s;
    if (!(r2 > 0))
        return 0;
    return s * (0.5 * log(r2) - 1) + (h > 0 ? h * atan(s / h) : 0);
}

/* The integral of ln r along the edge, from a point. */
static double log_along(Vec3 point, const Edge *e)
{
    const Vec3 way = vec3_sub(point, e->from);
    const double s = vec3_dot(way, e->along);
    const Vec3 across = vec3_mad(way, -s, e->along);
    const double h2 = vec3_dot(across, across), h = sqrt(h2);
    return log_integral(e->length - s, h2, h) - log_integral(-s, h2, h);
}

static double by_gauss(const Edge *p, const Edge *q)
{
    double sum = 0;
    for (int k = 0; k < GAUSS_POINTS / 2; k++) {
        const double u = 0.5 * p->length * (1 - gauss_node[k]);
        sum += gauss_weight[k] * (log_along(vec3_mad(p->from, u, p->along), q) +
                                  log_along(vec3_mad(p->from, p->length - u, p->along), q));
    }
    return 0.5 * p->length * sum;
}

/* Where along p the integrand may have a kink: next to q's ends and where the lines are nearest. */
static int kinks(const Edge *p, const Edge *q, double cut[MOST_CUTS])
{
    const Vec3 way = vec3_sub(q->from, p->from);
    const double c = vec3_dot(p->along, q->along), sine2 = 1 - c * c;
    const double a = vec3_dot(way, p->along), b = vec3_dot(way, q->along);
    double at[3] = { a, a + c * q->length, sine2 > 0 ? (a - c * b) / sine2 : -1 };
    int count = 0;
    cut[count++] = 0;
    for (int round = 0; round < 3; round++) {
        int least = 0;
        for (int k = 1; k < 3; k++)
            if (at[k] < at[least])
                least = k;
        if (at[least] > cut[count - 1] && at[least] < p->length)
            cut[count++] = at[least];
        at[least] = INFINITY;
    }
    cut[count++] = p->length;
    return count;
}

static double by_rule(const Rule *rule, const Edge *p, const Edge *q)
{
    double cut[MOST_CUTS], sum = 0;
    const int cuts = kinks(p, q, cut);
    for (int k = 0; k + 1 < cuts; k++) {
        const double size = cut[k + 1] - cut[k];
        double part = 0;
        for (int i = 0; i < RULE_POINTS; i++)
            part += rule->weight[i] *
                    log_along(vec3_mad(p->from, cut[k] + size * rule->place[i], p->along), q);
        sum += size * part;
    }
    return sum;
}

static Edge edge_of(const FlatPolygon *p, size_t i)
{
    const Vec3 from = p->corner[i], way = vec3_sub(p->corner[(i + 1) % p->count], from);
    const double length = vec3_length(way);
    return (Edge){ .from = from, .length = length,
                   .along = length > 0 ? vec3_scale(way, 1 / length) : way };
}

static double edge_pair(const Rule *rule, const Edge *p, const Edge *q)
{
    const double cosine = vec3_dot(p->along, q->along);
    /* Below what a cosine of two unit vectors is known to, edges are at right angles. */
    if (!(p->length > 0 && q->length > 0) || fabs(cosine) <= rounding_bound(16))
        return 0;
    const Vec3 middle = vec3_sub(vec3_mad(p->from, p->length / 2, p->along),
                                 vec3_mad(q->from, q->length / 2, q->along));
    const double apart = vec3_length(middle) - (p->length + q->length) / 2;
    return cosine * (apart > GAUSS_APART * p->length ? by_gauss(p, q) : by_rule(rule, p, q));
}

double polygon_factor_area(const FlatPolygon *p, const FlatPolygon *q)
{
    assert(p != NULL && q != NULL && p->count >= 3 && q->count >= 3);
    assert(p->count < POLYGON_FACTOR_CORNERS / 2 && q->count < POLYGON_FACTOR_CORNERS / 2);
    Vec3 np, nq;
    const double area_p = flat_polygon_area(p, &np), area_q = flat_polygon_area(q, &nq);
    if (!(area_p > 0 && area_q > 0))
        return 0;
    FlatPolygon a, b;
    cut_behind(p, q, nq, &a);
    cut_behind(q, p, np, &b);
    if (a.count < 3 || b.count < 3)
        return 0;
    Rule rule;
    rule_create(&rule);
    double sum = 0;
    for (size_t i = 0; i < a.count; i++) {
        const Edge e = edge_of(&a, i);
        for (size_t k = 0; k < b.count; k++) {
            const Edge f = edge_of(&b, k);
            sum += edge_pair(&rule, &e, &f);
        }
    }
    /* Between the outlines of two polygons that face each other the sum is negative or positive by
     * their senses: counter-clockwise on both makes F positive with this sign. */
    return fmin(fmax(sum / (2 * M_PI), 0), fmin(area_p, area_q));
}
