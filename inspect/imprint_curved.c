/* SPDX-License-Identifier: BSD-3-Clause */
/* Which surfaces curved shapes meet: those and the shapes are parted there, cell by cell, when they
 * are divided into patches (mesh/slicers.h). */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "inspect/imprint.h"
#include "inspect/internal.h"
#include "mesh/slicers.h"

static const char what[] = "face contacts";

/* A shape is parted by no more planes than this: what a statue that stands in a ball leaves on it
 * is left to the sampling of patches. */
enum { PLANES_MOST = 256 };

/* Unit normals and levels of faces in one plane differ by rounding; by this share of the scene they
 * are one still, as positions are. */
static const double LIKE = 0x1p-20;

typedef struct {
    uint32_t surface, slicer;
} Meeting;

typedef struct {
    Surfaces *s;
    BoxTree   tree;
    uint32_t *met;         /* [surfaces] */
    Meeting  *meeting;     /* [count] */
    size_t    count, capacity, slicer_capacity;
    uint32_t  first_plane; /* slicer that is the first of the shape at hand */
    bool      by_ring;     /* the torus at hand is parted by its ring */
    uint32_t  left;
    Error    *err;
} Meetings;

static void surface_box(const Surfaces *s, uint32_t surface, Vec3 *lo, Vec3 *hi)
{
    const Surface *f = &s->surface[surface];
    if (f->kind == SURFACE_SHAPE) {
        shape_bounds(&s->shape[f->primitive - s->triangle_count], lo, hi);
        return;
    }
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    *lo = *hi = s->position[c[0]];
    for (uint32_t k = 1; k < (f->kind == SURFACE_QUAD ? 6 : 3); k++) {
        *lo = vec3_min(*lo, s->position[c[k]]);
        *hi = vec3_max(*hi, s->position[c[k]]);
    }
}

static bool build_tree(Meetings *m)
{
    const Surfaces *s = m->s;
    BoxEntry *entry = array_create(s->count, sizeof *entry, what, m->err);
    for (uint32_t i = 0; entry != NULL && i < s->count; i++) {
        const double rim = slicer_margin(s, &(Slicer){ .kind = SLICER_PLANE });
        Vec3 lo, hi;
        surface_box(s, i, &lo, &hi);
        entry[i].box = box_around(vec3_sub(lo, vec3(rim, rim, rim)),
                                  vec3_add(hi, vec3(rim, rim, rim)));
    }
    return entry != NULL && box_tree_create(&m->tree, entry, s->count, m->err);
}

/* Whether the slicer comes near the box. */
static bool comes_near(const Surfaces *s, const Slicer *c, Vec3 lo, Vec3 hi)
{
    const double radius = vec3_length(vec3_sub(hi, lo)) / 2;
    return fabs(slicer_side(s, c, vec3_lerp(lo, hi, 0.5))) <= radius + slicer_margin(s, c);
}

static bool add_meeting(Meetings *m, uint32_t surface, uint32_t slicer)
{
    if (!array_reserve((void **)&m->meeting, &m->capacity, m->count + 1, sizeof *m->meeting, what,
                       m->err))
        return false;
    m->meeting[m->count++] = (Meeting){ surface, slicer };
    return true;
}

static bool add_slicer(Meetings *m, const Slicer *slicer)
{
    Surfaces *s = m->s;
    if (!array_reserve((void **)&s->slicer, &m->slicer_capacity, (size_t)s->slicer_count + 1,
                       sizeof *s->slicer, what, m->err))
        return false;
    s->slicer[s->slicer_count++] = *slicer;
    return true;
}

/* A plane that parts the shape at hand; in a plane that does so already, that one grows. *slicer:
 * it, or SURFACE_NONE where there are too many. */
static bool add_plane(Meetings *m, uint32_t shape_surface, const Slicer *plane, uint32_t *slicer)
{
    const Vec3 normal = plane->normal;
    Surfaces *s = m->s;
    for (uint32_t k = m->first_plane; k < s->slicer_count; k++) {
        Slicer *c = &s->slicer[k];
        const double way = vec3_dot(c->normal, normal) < 0 ? -1 : 1;
        const Vec3 off = vec3_sub(vec3_scale(normal, way), c->normal);
        if (vec3_length(off) > LIKE
            || fabs(way * plane->level - c->level) > LIKE * s->largest_coordinate)
            continue;
        c->lo = vec3_min(c->lo, plane->lo);
        c->hi = vec3_max(c->hi, plane->hi);
        *slicer = k;
        return true;
    }
    *slicer = SURFACE_NONE;
    if (s->slicer_count - m->first_plane == PLANES_MOST) {
        m->left++;
        return true;
    }
    *slicer = s->slicer_count;
    return add_slicer(m, plane) && add_meeting(m, shape_surface, s->slicer_count - 1);
}

/* --- what only touches ------------------------------------------------------------------------ */

/* The line, in the world, along which a coat touches a plane that does not cut it. The plane is
 * n . q = level in the space of the unit form, both sides of that lengths in the world. */
static bool touching_line(const Shape *shape, Vec3 n, double level, double margin, Vec3 line[2])
{
    const double flat = sqrt(n.x * n.x + n.y * n.y);
    for (int way = 1; way >= -1 && flat > 0; way -= 2) {
        const double x = way * n.x / flat, y = way * n.y / flat, r = shape->ratio;
        if (fabs(way * flat - level) > margin || fabs(way * flat * r + n.z - level) > margin)
            continue;
        line[0] = affine_point(&shape->to_world, vec3(x, y, 0));
        line[1] = affine_point(&shape->to_world, vec3(r * x, r * y, 1));
        return true;
    }
    return false;
}

/* A coat that lies on a face and a torus that does so have the face's places on their one side
 * alone: these are parted along the line or circle of contact, as the shape is. A ball touches in a
 * point, which parts nothing. */
static bool add_touch(Meetings *m, uint32_t first, uint32_t own, uint32_t flat, const Slicer *plane)
{
    Surfaces *s = m->s;
    const Shape *shape = &s->shape[s->slicer[first].shape];
    const Affine *to = &shape->to_world;
    const double margin = slicer_margin(s, plane), level = plane->level
                                                         - vec3_dot(plane->normal, to->t);
    const Vec3 n = vec3(vec3_dot(plane->normal, to->x), vec3_dot(plane->normal, to->y),
                        vec3_dot(plane->normal, to->z));
    Vec3 line[2];
    uint32_t slicer = SURFACE_NONE;
    if (shape->kind == SHAPE_TORUS) {
        const bool touches = sqrt(n.x * n.x + n.y * n.y) <= margin
                          && fabs(fabs(n.z) * shape->ratio - fabs(level)) <= margin;
        assert(s->slicer[first + 1].kind == SLICER_SPLIT_RING);
        /* The face has the ring already, with the splits of the torus. */
        if (!touches || m->by_ring)
            return true;
        m->by_ring = true;
        return add_meeting(m, own, first + 1);
    }
    if (shape->kind != SHAPE_FRUSTUM || !touching_line(shape, n, level, margin, line))
        return true;
    const Vec3 across = vec3_cross(vec3_sub(line[1], line[0]), plane->normal);
    const Vec3 normal = vec3_scale(across, 1 / vec3_length(across));
    const Slicer along = slicer_plane(normal, vec3_dot(normal, line[0]),
                                      vec3_min(line[0], line[1]), vec3_max(line[0], line[1]));
    if (!add_plane(m, own, &along, &slicer))
        return false;
    /* Both halves of a flat quad say so. */
    const Meeting last = m->meeting[m->count - 1];
    return slicer == SURFACE_NONE || (last.surface == flat && last.slicer == slicer)
        || add_meeting(m, flat, slicer);
}

/* The planes of a flat surface: two for a quad that is bent. */
static bool add_planes(Meetings *m, uint32_t first, uint32_t shape_surface, uint32_t flat)
{
    const Surfaces *s = m->s;
    const Vec3 shape_lo = s->slicer[first].lo, shape_hi = s->slicer[first].hi;
    uint32_t slicer;
    const Surface *f = &s->surface[flat];
    Vec3 lo, hi;
    surface_box(s, flat, &lo, &hi);
    for (uint32_t k = 0; k < (f->kind == SURFACE_QUAD ? 2u : 1u); k++) {
        const Vec3 normal = surfaces_normal(s, f->primitive + k, 0, 0);
        const Vec3 p = s->position[s->corner[3 * (size_t)(f->primitive + k)]];
        const Slicer plane = slicer_plane(normal, vec3_dot(normal, p), lo, hi);
        if (comes_near(s, &plane, shape_lo, shape_hi)
            && !(add_plane(m, shape_surface, &plane, &slicer)
                 && add_touch(m, first, shape_surface, flat, &plane)))
            return false;
    }
    return true;
}

static bool meet_shape(Meetings *m, uint32_t shape)
{
    Surfaces *s = m->s;
    const uint32_t own = s->shape_surface[shape];
    Slicer slicer[1 + SLICER_SPLITS];
    const uint32_t first = s->slicer_count, slicers = slicer_shape(s, shape, slicer);
    for (uint32_t k = 0; k < slicers; k++)
        if (!add_slicer(m, &slicer[k]))
            return false;
    m->first_plane = s->slicer_count;
    m->by_ring = false;
    const double rim = slicer_margin(s, &slicer[0]);
    const Box box = box_around(vec3_sub(slicer[0].lo, vec3(rim, rim, rim)),
                               vec3_add(slicer[0].hi, vec3(rim, rim, rim)));
    const uint32_t met = box_tree_meet(&m->tree, &box, 0, m->met, s->count);
    for (uint32_t k = 0; k < met; k++) {
        const uint32_t other = m->tree.entry[m->met[k]].item;
        Vec3 lo, hi;
        surface_box(s, other, &lo, &hi);
        if (other == own)
            continue;
        if (comes_near(s, &slicer[0], lo, hi) && !add_meeting(m, other, first))
            return false;
        if (s->surface[other].kind != SURFACE_SHAPE && !add_planes(m, first, own, other))
            return false;
    }
    return true;
}

/* The meetings, surface by surface, in the order in which they were found. */
static bool emit(Meetings *m)
{
    Surfaces *s = m->s;
    uint32_t *first = array_create((size_t)s->count + 1, sizeof *first, what, m->err);
    uint32_t *cut = array_create(m->count, sizeof *cut, what, m->err);
    if (m->count >= UINT32_MAX)
        error_set(m->err, ERROR_INPUT, "more than 2^32 contacts of faces");
    if (error_is_set(m->err)) {
        array_free(first);
        array_free(cut);
        return false;
    }
    for (size_t k = 0; k < m->count; k++)
        first[m->meeting[k].surface]++;
    /* Filling from the back moves the end of each row to its start. */
    for (uint32_t i = 1; i <= s->count; i++)
        first[i] += first[i - 1];
    for (size_t k = m->count; k > 0; k--)
        cut[--first[m->meeting[k - 1].surface]] = m->meeting[k - 1].slicer;
    s->cut_first = first;
    s->cut = cut;
    return true;
}

bool imprint_curved(Surfaces *surfaces, const Monitor *monitor, Error *err)
{
    assert(surfaces != NULL && err != NULL && surfaces->cut_first == NULL);
    if (error_is_set(err))
        return false;
    if (surfaces->shape_count == 0 || surfaces->count < 2)
        return true;
    Meetings m = { .s = surfaces, .err = err };
    m.met = array_create(surfaces->count, sizeof *m.met, what, err);
    bool ok = m.met != NULL && build_tree(&m);
    for (uint32_t k = 0; ok && k < surfaces->shape_count; k++)
        ok = meet_shape(&m, k);
    ok = ok && (m.count == 0 || emit(&m));
    if (ok && m.left > 0)
        monitor_warn(monitor, "contacts-left", "",
                     "so many faces meet curved ones that %u of them do not part their patches, "
                     "which may let light through", m.left);
    box_tree_clear(&m.tree);
    array_free(m.met);
    array_free(m.meeting);
    return ok;
}
