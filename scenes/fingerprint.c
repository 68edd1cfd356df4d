/* SPDX-License-Identifier: BSD-3-Clause */
/* One number for all of a scene that light depends on. */
#include <assert.h>
#include <string.h>

#include "base/file.h"
#include "scenes/scene.h"

/* Fields one by one, never structs: what pads them is anything. */
static uint64_t add_numbers(const double *v, size_t count, uint64_t hash)
{
    return file_hash(v, count * sizeof *v, hash);
}

static uint64_t add_text(const char *text, uint64_t hash)
{
    return file_hash(text, strlen(text) + 1, hash);
}

static uint64_t add_polygons(const Polygons *p, uint64_t hash)
{
    const size_t corners = p->polygon_count > 0 ? p->first[p->polygon_count] : 0;
    hash = add_numbers((double[]){ (double)p->vertex_count, (double)p->polygon_count,
                                   (double)corners, p->grain }, 4, hash);
    hash = file_hash(p->position, p->vertex_count * sizeof *p->position, hash);
    hash = file_hash(p->first, p->polygon_count * sizeof *p->first, hash);
    hash = file_hash(p->corner, corners * sizeof *p->corner, hash);
    hash = file_hash(p->normal, 3 * p->normal_count * sizeof *p->normal, hash);
    hash = file_hash(p->material, p->polygon_count * sizeof *p->material, hash);
    hash = file_hash(p->group, p->polygon_count * sizeof *p->group, hash);
    for (size_t i = 0; i < p->shape_count; i++) {
        const ShapeFace *s = &p->shape[i];
        hash = add_numbers((double[]){ s->material, s->group, s->shape.kind, s->shape.ratio }, 4,
                           hash);
        hash = file_hash(&s->shape.to_world, sizeof s->shape.to_world, hash);
    }
    for (size_t i = 0; i < p->group_count; i++)
        hash = add_text(p->group_name[i], hash);
    return hash;
}

static uint64_t add_material(const Material *m, uint64_t hash)
{
    const Rgb colours[] = { m->reflectance, m->emission, m->specular, m->transmittance,
                            m->scattered };
    hash = add_text(m->name, hash);
    hash = file_hash(colours, sizeof colours, hash);
    return add_numbers((double[]){ m->exponent, m->ior, m->importance, m->emits_both, m->texture,
                                   m->cut_out, m->roughness }, 7, hash);
}

static uint64_t add_light(const Light *l, uint64_t hash)
{
    const Vec3 places[] = { l->position, l->direction };
    hash = add_text(l->name, hash);
    hash = file_hash(places, sizeof places, hash);
    hash = file_hash(&l->intensity, sizeof l->intensity, hash);
    return add_numbers((double[]){ l->kind, l->cos_inner, l->cos_outer }, 3, hash);
}

static uint64_t add_map(const FaceMap *m, uint64_t hash)
{
    return add_numbers((double[]){ m->du.x, m->du.y, m->du.z, m->dv.x, m->dv.y, m->dv.z, m->u0,
                                   m->v0, m->used }, 9, hash);
}

uint64_t scene_fingerprint(const Scene *scene)
{
    const Polygons *soup = &scene->polygons;
    uint64_t hash = add_polygons(soup, 0);
    assert(scene_check(scene));
    for (size_t i = 0; i < soup->material_count; i++)
        hash = add_material(&soup->materials[i], hash);
    for (size_t i = 0; i < scene->prototype_count; i++)
        hash = add_polygons(&scene->prototypes[i], hash);
    for (size_t i = 0; i < scene->placement_count; i++) {
        const Placement *p = &scene->placements[i];
        hash = add_numbers((double[]){ p->prototype, p->material }, 2, hash);
        hash = file_hash(&p->to_world, sizeof p->to_world, hash);
    }
    for (size_t i = 0; i < scene->textures.count; i++)
        hash = add_text(scene->textures.texture[i].name, hash);
    for (size_t i = 0; i < scene->textures.map_count; i++)
        hash = add_map(&scene->textures.map[i], hash);
    for (size_t i = 0; i < scene->light_count; i++)
        hash = add_light(&scene->lights[i], hash);
    const Rgb around[] = { scene->background, scene->ambient };
    const Vec3 frame[] = { scene->origin, scene->up };
    return file_hash(frame, sizeof frame, file_hash(around, sizeof around, hash));
}
