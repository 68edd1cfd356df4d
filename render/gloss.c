/* SPDX-License-Identifier: BSD-3-Clause */
/* Lobes and microfacets: values, densities, samples. */
#include "render/gloss.h"

#include <assert.h>
#include <math.h>

#include "render/specular.h"

static Vec3 mirrored(Vec3 in, Vec3 n) { return vec3_mad(in, -2 * vec3_dot(in, n), n); }

void gloss_init(Gloss *gloss, const Material *material, Vec3 face, Vec3 normal, Vec3 in)
{
    assert(material->roughness >= 0 && material->roughness <= 1);
    *gloss = (Gloss){ .face = face, .normal = normal, .view = vec3_scale(in, -1),
                      .exponent = specular_exponent(material),
                      .width = material->roughness * material->roughness };
    /* Never into the surface itself. */
    const Vec3 d = mirrored(in, normal);
    gloss->axis = vec3_unit(vec3_dot(d, face) > 0 ? d : mirrored(d, face));
}

/* --- microfacets ------------------------------------------------------------------------------ */

/* sqrt(width^2 + (1 - width^2) cos^2): what the shadowing terms are made of. */
static double shade_root(double width, double cosine)
{
    const double w2 = width * width;
    return sqrt(w2 + (1 - w2) * cosine * cosine);
}

static double facets_value(const Gloss *g, Vec3 out, double *density)
{
    const double v = vec3_dot(g->view, g->normal), l = vec3_dot(out, g->normal);
    if (!(v > 0) || !(l > 0))
        return 0;
    const Vec3   half = vec3_unit(vec3_add(g->view, out));
    const Vec3   across = vec3_cross(half, g->normal);
    const double w2 = g->width * g->width, z = vec3_dot(half, g->normal);
    /* sin^2 by the cross product: of nearly parallel vectors 1 - cos^2 would be all rounding. */
    const double spread = vec3_dot(across, across) + w2 * z * z;
    const double d = w2 / (M_PI * spread * spread);
    const double rv = shade_root(g->width, v), rl = shade_root(g->width, l);
    *density = d / (2 * (v + rv));
    return d * l / (2 * (l * rv + v * rl));
}

static bool facets_sample(const Gloss *g, const float u[2], Vec3 *out)
{
    Vec3 s, t, a, b;
    vec3_frame(g->normal, &s, &t);
    /* The view in a space where the facets are a hemisphere. */
    const Vec3 view = vec3_unit(vec3(g->width * vec3_dot(g->view, s),
                                     g->width * vec3_dot(g->view, t),
                                     fmax(vec3_dot(g->view, g->normal), 0)));
    vec3_frame(view, &a, &b);
    if (vec3_length(vec3(view.x, view.y, 0)) > 0) { /* a: level */
        a = vec3_unit(vec3(-view.y, view.x, 0));
        b = vec3_cross(view, a);
    }
    const double r = sqrt(u[0]), angle = 2 * M_PI * u[1], lift = (1 + view.z) / 2;
    const double p = r * cos(angle), rest = fmax(1 - p * p, 0);
    const double q = (1 - lift) * sqrt(rest) + lift * r * sin(angle);
    const Vec3   n = vec3_mad(vec3_mad(vec3_scale(a, p), q, b), sqrt(fmax(rest - q * q, 0)), view);
    const Vec3   m = vec3_unit(vec3(g->width * n.x, g->width * n.y, fmax(n.z, 0)));
    const Vec3   half = vec3_mad(vec3_mad(vec3_scale(s, m.x), m.y, t), m.z, g->normal);
    *out = vec3_unit(mirrored(vec3_scale(g->view, -1), half));
    return vec3_dot(*out, g->normal) > 0;
}

/* --- lobes ------------------------------------------------------------------------------------ */

static double lobe_value(const Gloss *g, Vec3 out, double *density)
{
    const double e = g->exponent;
    const double lobe = pow(fmax(vec3_dot(out, g->axis), 0), e) / (2 * M_PI);
    *density = (e + 1) * lobe;
    return (e + 2) * lobe * vec3_dot(out, g->face);
}

static void lobe_sample(const Gloss *g, const float u[2], Vec3 *out)
{
    const double z = pow(u[0], 1 / (g->exponent + 1)), r = sqrt(fmax(1 - z * z, 0));
    const double angle = 2 * M_PI * u[1];
    Vec3         s, t;
    vec3_frame(g->axis, &s, &t);
    *out = vec3_unit(vec3_mad(vec3_mad(vec3_scale(g->axis, z), r * cos(angle), s),
                              r * sin(angle), t));
}

/* --- either ----------------------------------------------------------------------------------- */

bool gloss_sample(const Gloss *gloss, const float u[2], Vec3 *out)
{
    assert(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1);
    if (gloss->width > 0) {
        if (!facets_sample(gloss, u, out))
            return false;
    } else {
        lobe_sample(gloss, u, out);
    }
    return vec3_dot(*out, gloss->face) > 0;
}

double gloss_value(const Gloss *gloss, Vec3 out, double *density)
{
    *density = 0;
    if (!(vec3_dot(out, gloss->face) > 0))
        return 0;
    return gloss->width > 0 ? facets_value(gloss, out, density) : lobe_value(gloss, out, density);
}
