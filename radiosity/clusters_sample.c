/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters_sample.c -- factors between nodes by rays between points of both. */
#include <assert.h>
#include <math.h>

#include "math/sampling.h"
#include "radiosity/clusters_internal.h"
#include "radiosity/visible.h"

/* A leaf nearer to a point than this many of its areas' roots, squared, is integrated in closed
 * form: farther off cosines and distance differ by less than visibility rays can tell. */
static const double NEAR_AREAS = 16;

/* Centres of patches in one plane are off it by rounding of single precision, of a node's size. */
static const double HEIGHT_SHARE = 1e-5;

/* Share of the most that may come that the first rays leave unknown, however much they agree:
 * something small may be in the way, or seen by none of them. Found by trying on the Cornell box:
 * with a third of it light is missed, with three times as much links are refined for nothing. */
static const double DOUBT = 0.03;

/* Most corners of a patch's face that are integrated; others, with many T-vertices, are not. */
enum { FACE_CORNERS = 16 };

/* --- a point and a leaf ----------------------------------------------------------------------- */

/* Corners of the face of a patch that is flat and open as a whole; 0: it is not. */
static uint32_t flat_face(const ClusterLinks *links, uint32_t patch, Vec3 corner[FACE_CORNERS])
{
    const Room *room = links->shooter.room;
    const Patches *p = room->patches;
    const uint32_t face = p->face_of[patch], first = p->first_corner[face];
    const uint32_t count = p->first_corner[face + 1] - first;
    if (room->surfaces->surface[p->surface[patch]].kind == SURFACE_SHAPE ||
        p->first_piece[patch + 1] > p->first_piece[patch] || count > FACE_CORNERS ||
        links->shooter.places->open[patch] != UINT64_MAX)
        return 0;
    for (uint32_t k = 0; k < count; k++)
        corner[k] = p->position[p->corner[first + k]];
    return count;
}

/* Cuts away what lies behind the plane through p with normal n. */
static uint32_t clip(const Vec3 *in, uint32_t count, Vec3 p, Vec3 n, Vec3 *out)
{
    uint32_t kept = 0;
    for (uint32_t k = 0; k < count; k++) {
        const Vec3 a = in[k], b = in[(k + 1) % count];
        const double here = vec3_dot(n, vec3_sub(a, p)), there = vec3_dot(n, vec3_sub(b, p));
        if (here >= 0)
            out[kept++] = a;
        if ((here > 0 && there < 0) || (here < 0 && there > 0))
            out[kept++] = vec3_mad(a, here / (here - there), vec3_sub(b, a));
    }
    return kept;
}

/* Share of the cosine-weighted hemisphere over p that the face takes up: Lambert's formula
 * [lambert1760]. */
static double point_factor(const Vec3 *corner, uint32_t count, Vec3 p, Vec3 n)
{
    Vec3 seen[2 * FACE_CORNERS];
    double sum = 0;
    const uint32_t left = clip(corner, count, p, n, seen);
    for (uint32_t k = 0; k < left; k++) {
        const Vec3 a = vec3_sub(seen[k], p), b = vec3_sub(seen[(k + 1) % left], p);
        const Vec3 across = vec3_cross(a, b);
        const double sine = vec3_length(across);
        if (sine > 0)
            sum += atan2(sine, vec3_dot(a, b)) / sine * vec3_dot(across, n);
    }
    return fabs(sum) / (2 * M_PI);
}

/* --- one ray ---------------------------------------------------------------------------------- */

/* Factor from a place to a patch over its area; `flat` is cos cos / d^2 for a point of it. */
static double value_of(const ClusterLinks *links, uint32_t patch, const PatchPoint *to,
                       const PatchPoint *from, double flat)
{
    const double area = links->shooter.places->links->area[patch];
    const Vec3 way = vec3_sub(from->point.point, to->point.point);
    const double square = vec3_dot(way, way);
    Vec3 corner[FACE_CORNERS];
    if (square >= NEAR_AREAS * area)
        return to->weight * from->weight * flat / M_PI;
    const uint32_t corners = flat_face(links, patch, corner);
    if (corners > 0)
        return to->weight / area * point_factor(corner, corners, to->point.point,
                                                to->point.normal);
    /* A disc that stands for the patch takes up no more than the hemisphere. */
    return to->weight * from->weight * flat * square / (M_PI * square + area);
}

/* False: nothing can come that way, and no ray is needed. */
static bool aim(const ClusterLinks *links, const Candidate *c, uint32_t index, uint32_t seed,
                ClusterSample *sample, Ray *ray)
{
    const ClusterTree *tree = links->tree;
    const Room *room = links->shooter.room;
    PatchPoint to, from;
    float x[4];
    double rest;
    sampling_sobol4(index, seed, x);
    sample->to = cluster_tree_choose(tree, c->to, x[0], &rest);
    shooter_place(&links->shooter, tree->patch[sample->to], (float[2]){ (float)rest, x[1] }, &to);
    sample->from = cluster_tree_choose(tree, c->from, x[2], &rest);
    const uint32_t patch = tree->patch[sample->from];
    shooter_place(&links->shooter, patch, (float[2]){ (float)rest, x[3] }, &from);
    const Vec3 way = vec3_sub(from.point.point, to.point.point);
    const double square = fmax(vec3_dot(way, way), 4 * room->offset * room->offset);
    const double distance = sqrt(square);
    const double here = vec3_dot(way, to.point.normal) / distance;
    const double there = -vec3_dot(way, from.point.normal) / distance;
    sample->value = 0;
    if (!(here > 0 && there > 0 && distance > 2 * room->offset))
        return false;
    sample->value = (float)value_of(links, patch, &to, &from, here * there / square);
    *ray = ray_between(to.point.point, to.point.normal, from.point.point, from.point.normal,
                       room->offset);
    return sample->value > 0;
}

uint64_t candidates_sample(const ClusterLinks *links, CandidateScratch *scratch,
                           Candidate *candidate, uint32_t count)
{
    uint32_t rays = 0;
    assert(count <= CANDIDATE_CHUNK);
    for (uint32_t k = 0; k < count; k++) {
        Candidate *c = &candidate[k];
        const uint32_t seed = sampling_seed(links->seed, c->to, c->from,
                                            c->error > 0 ? SEED_CLUSTERS_AGAIN : SEED_CLUSTERS);
        for (; c->count < CANDIDATE_SAMPLES; c->count++) {
            ClusterSample *sample = &c->sample[c->count];
            if (aim(links, c, c->taken + c->count, seed, sample, &scratch->ray[rays]))
                scratch->sample[rays++] = sample;
        }
    }
    bvh_blocked_many(links->shooter.room->bvh, scratch->ray, scratch->blocked, rays);
    for (uint32_t k = 0; k < rays; k++)
        if (scratch->blocked[k])
            scratch->sample[k]->value = -scratch->sample[k]->value;
    return rays;
}

/* --- what they tell --------------------------------------------------------------------------- */

static Vec3 vector(const float v[3])
{
    return vec3(v[0], v[1], v[2]);
}

/* Most that the cosine at one node can be towards points of the other one, `gap` or more away. */
static double most_cosine(const ClusterNode *node, const ClusterNode *other, double gap)
{
    const Vec3 normal = vector(node->normal);
    const Vec3 way = vec3_sub(vector(other->centre), vector(node->centre));
    const double along = vec3_dot(normal, vector(other->normal));
    const double wide = other->radius * sqrt(fmax(0, 1 - along * along)) + other->thickness;
    const double height = vec3_dot(way, normal) + wide + node->thickness;
    if (!(height > HEIGHT_SHARE * (other->radius + node->radius)))
        return fmin(1, node->bend);
    return fmin(1, node->bend + height / fmax(gap, height));
}

/* About the most that the factor between points of two nodes can be. */
static double most_factor(const ClusterNode *to, const ClusterNode *from)
{
    const double distance = vec3_length(vec3_sub(vector(to->centre), vector(from->centre)));
    const double gap = fmax(0, distance - to->radius - from->radius);
    return most_cosine(to, from, gap) * most_cosine(from, to, gap) * from->area /
           (M_PI * gap * gap + from->area);
}

/* Standard error. Leaves below `to` get the mean, which is off for them by about as much as points
 * there differ; half of that is taken to be the other end's doing. */
static double spread(const Candidate *c, double number, bool inner, double most)
{
    const double mean = c->sum / number;
    const double variance = fmax(0, (c->square / number - mean * mean) * number / (number - 1));
    const double doubt = DOUBT * CANDIDATE_SAMPLES / number * most;
    return sqrt(variance * ((inner ? 0.5 : 0) + 1 / number) + doubt * doubt);
}

void candidate_sum(const ClusterLinks *links, Candidate *c)
{
    const double area = links->tree->node[c->from].area;
    for (uint32_t k = 0; k < c->count; k++) {
        const double value = area * fmax(0, (double)c->sample[k].value);
        c->sum += value;
        c->square += value * value;
    }
    c->taken += c->count;
    c->count = 0;
}

ClusterLink candidate_link(const ClusterLinks *links, const Candidate *candidate)
{
    const bool inner = links->tree->node[candidate->to].child != 0;
    Candidate c = *candidate;
    candidate_sum(links, &c);
    const double factor = fmin(1, c.sum / c.taken);
    const double most = most_factor(&links->tree->node[c.to], &links->tree->node[c.from]);
    const double error = c.error > 0 ? c.error : spread(&c, c.taken, inner, most);
    return (ClusterLink){ .to = c.to, .from = c.from, .factor = (float)factor,
                          .error = (float)error };
}
