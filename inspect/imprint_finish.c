/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces of an imprinted soup: faces by their old numbers, parted where others stand on them. */
#include <assert.h>
#include <math.h>

#include "inspect/imprint.h"
#include "inspect/internal.h"
#include "math/tolerance.h"

static double largest_coordinate(Vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

static bool is_on(Vec3 p, Vec3 a, Vec3 b, double tolerance)
{
    const Vec3 way = vec3_sub(b, a);
    const double square = vec3_dot(way, way);
    const double t = square > 0 ? vec3_dot(vec3_sub(p, a), way) / square : 0;
    const Vec3 near = vec3_mad(a, fmin(fmax(t, 0), 1), way);
    return vec3_length(vec3_sub(p, near)) <= tolerance;
}

/* Whether p to q runs along an edge of the polygon on which another face stands. */
static bool is_contact(const Imprint *im, uint32_t polygon, Vec3 p, Vec3 q)
{
    const Polygons *soup = &im->soup;
    const uint32_t first = soup->first[polygon], last = soup->first[polygon + 1] - 1;
    /* Twice: welding has moved both the ends of the one and of the other. */
    const double tolerance = 2 * polygons_tolerance(soup, fmax(largest_coordinate(p),
                                                               largest_coordinate(q)));
    for (uint32_t k = first; k <= last; k++) {
        if (!soup->contact[k])
            continue;
        const Vec3 a = soup->position[soup->corner[k]];
        const Vec3 b = soup->position[soup->corner[k == last ? first : k + 1]];
        if (is_on(p, a, b, tolerance) && is_on(q, a, b, tolerance))
            return true;
    }
    return false;
}

static unsigned edges_of(const Surface *f)
{
    return f->kind == SURFACE_TRIANGLE ? 3 : f->kind == SURFACE_QUAD ? 4 : 0;
}

static Vec3 edge_normal(const Surfaces *s, uint32_t surface, unsigned k)
{
    const Surface *f = &s->surface[surface];
    return surfaces_normal(s, f->primitive + (f->kind == SURFACE_QUAD && k >= 2), 0, 0);
}

static void edge_ends(const Surfaces *s, uint32_t surface, unsigned k, Vec3 end[2])
{
    const Surface *f = &s->surface[surface];
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    const unsigned n = edges_of(f);
    for (unsigned i = 0; i < 2; i++) {
        const unsigned corner = (k + i) % n;
        end[i] = s->position[corner == 3 ? c[5] : c[corner]];
    }
}

typedef struct {
    const Imprint *im;
    Surfaces      *s;
} Parting;

/* Whether the surface goes on smoothly into `other` and a face stands on p to q of either. */
static bool is_parted(const Parting *parting, uint32_t surface, unsigned k, uint32_t other,
                      Vec3 p, Vec3 q)
{
    const Surfaces *s = parting->s;
    if (other == SURFACE_NONE)
        return false;
    /* Over a crease nothing goes on anyway, and a box stays one box. */
    const double cosine = vec3_dot(edge_normal(s, surface, k), edge_normal(s, other, 0));
    if (fabs(cosine) < TOLERANCE_CREASE_COSINE)
        return false;
    const uint32_t both[2] = { surface, other };
    for (int i = 0; i < 2; i++) {
        const Surface *f = &s->surface[both[i]];
        for (uint32_t t = 0; t < 1u + (f->kind == SURFACE_QUAD); t++) {
            const bool known = s->triangle_face != NULL;
            const uint32_t back = known ? s->triangle_back[f->primitive + t] : f->back;
            if (is_contact(parting->im, known ? s->triangle_face[f->primitive + t] : f->face, p, q)
                || (back != SURFACE_NONE && is_contact(parting->im, back, p, q)))
                return true;
        }
    }
    return false;
}

static void part_edge(const Parting *parting, uint32_t surface, unsigned k)
{
    Surfaces *s = parting->s;
    uint32_t *other = &s->surface[surface].neighbour[k];
    Vec3 end[2];
    edge_ends(s, surface, k, end);
    Vec3 from = end[0];
    const uint32_t use = 4 * surface + k;
    const uint32_t first = s->stitch_first != NULL ? s->stitch_first[use] : 0;
    const uint32_t last = s->stitch_first != NULL ? s->stitch_first[use + 1] : 0;
    for (uint32_t i = first; i <= last; i++) {
        const Vec3 to = i < last ? s->position[s->stitch[i].vertex] : end[1];
        if (is_parted(parting, surface, k, *other, from, to))
            *other = SURFACE_NONE;
        from = to;
        if (i < last)
            other = &s->stitch[i].neighbour;
    }
}

void imprint_finish(const Imprint *im, Surfaces *s)
{
    assert(im != NULL && s != NULL);
    const uint32_t polygons = (uint32_t)im->soup.polygon_count;
    const uint32_t fewer = polygons - (uint32_t)im->original;
    const Parting parting = { im, s };
    for (uint32_t i = 0; i < s->count; i++)
        for (unsigned k = 0; k < edges_of(&s->surface[i]); k++)
            part_edge(&parting, i, k);
    for (uint32_t t = 0; s->triangle_face != NULL && t < s->triangle_count; t++) {
        s->triangle_face[t] = im->face[s->triangle_face[t]];
        if (s->triangle_back[t] != SURFACE_NONE)
            s->triangle_back[t] = im->face[s->triangle_back[t]];
    }
    for (uint32_t i = 0; i < s->count; i++) {
        Surface *f = &s->surface[i];
        assert(f->kind == SURFACE_SHAPE || f->face < polygons);
        f->face = f->face < polygons ? im->face[f->face] : f->face - fewer;
        if (f->back != SURFACE_NONE)
            f->back = im->face[f->back];
    }
}
