/* SPDX-License-Identifier: BSD-3-Clause */
/* Comment lines of solved meshes. */
#include "app/ply_notes.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

static const char *const LIGHT_KINDS[] = { "point", "spot", "cosine" };

/* --- writing ---------------------------------------------------------------------------------- */

/* Digits that give the very number back. */
static void put_three(FILE *out, double x, double y, double z)
{
    fprintf(out, " %.17g %.17g %.17g", x, y, z);
}

static void put_place(FILE *out, const Scene *scene, Vec3 place)
{
    const Vec3 p = scene_to_file(scene, place);
    put_three(out, p.x, p.y, p.z);
}

static void end_with_name(FILE *out, const char *name)
{
    fputc(' ', out);
    for (; *name != '\0'; name++)
        fputc((unsigned char)*name < ' ' ? ' ' : *name, out);
    fputc('\n', out);
}

void ply_notes_put(FILE *out, const Scene *scene)
{
    fputs("comment up", out);
    put_three(out, scene->up.x, scene->up.y, scene->up.z);
    fputc('\n', out);
    for (size_t i = 0; i < scene->camera_count; i++) {
        const Camera *c = &scene->cameras[i];
        if (c->projection != CAMERA_PERSPECTIVE)
            continue;
        fputs("comment camera", out);
        put_place(out, scene, c->eye);
        put_place(out, scene, c->target);
        put_three(out, c->up.x, c->up.y, c->up.z);
        fprintf(out, " %.17g", c->vertical_fov);
        end_with_name(out, c->name);
    }
    for (size_t i = 0; i < scene->light_count; i++) {
        const Light *l = &scene->lights[i];
        fprintf(out, "comment light %s", LIGHT_KINDS[l->kind]);
        put_place(out, scene, l->position);
        put_three(out, l->direction.x, l->direction.y, l->direction.z);
        put_three(out, l->intensity.r, l->intensity.g, l->intensity.b);
        fprintf(out, " %.17g %.17g", l->cos_inner, l->cos_outer);
        end_with_name(out, l->name);
    }
}

/* --- reading ---------------------------------------------------------------------------------- */

static bool take_word(const char **at, const char *word)
{
    const size_t n = strlen(word);
    if (strncmp(*at, word, n) != 0)
        return false;
    *at += n;
    return true;
}

static bool take_numbers(const char **at, double *value, int count)
{
    for (int i = 0; i < count; i++) {
        char *end;
        value[i] = strtod(*at, &end);
        if (end == *at || !isfinite(value[i]))
            return false;
        *at = end;
    }
    return true;
}

/* The rest of the line, as much as there is room for. */
static void take_name(const char *at, char name[64])
{
    snprintf(name, 64, "%s", *at == ' ' ? at + 1 : at);
}

static Vec3 three(const double *v) { return vec3(v[0], v[1], v[2]); }

static bool add_camera(PlyNotes *notes, const char *at, Error *err)
{
    double v[10];
    if (!take_numbers(&at, v, 10) || !(v[9] > 0 && v[9] < 180) ||
        !(vec3_length(vec3_sub(three(v + 3), three(v))) > 0) || !(vec3_length(three(v + 6)) > 0))
        return true;
    if (!array_reserve((void **)&notes->camera, &notes->camera_capacity,
                       (size_t)notes->camera_count + 1, sizeof *notes->camera, "cameras", err))
        return false;
    Camera *c = &notes->camera[notes->camera_count++];
    *c = (Camera){ .eye = three(v), .target = three(v + 3), .up = three(v + 6),
                   .vertical_fov = v[9] };
    take_name(at, c->name);
    return true;
}

static bool add_light(PlyNotes *notes, const char *at, Error *err)
{
    double v[11];
    unsigned kind = 0;
    while (kind < 3 && !take_word(&at, LIGHT_KINDS[kind]))
        kind++;
    if (kind == 3 || !take_numbers(&at, v, 11) ||
        !(fmin(v[6], fmin(v[7], v[8])) >= 0) || v[10] > v[9] ||
        (kind != LIGHT_POINT && !(vec3_length(three(v + 3)) > 0)))
        return true;
    if (!array_reserve((void **)&notes->light, &notes->light_capacity,
                       (size_t)notes->light_count + 1, sizeof *notes->light, "lights", err))
        return false;
    Light *l = &notes->light[notes->light_count++];
    *l = (Light){ .kind = (LightKind)kind, .position = three(v), .direction = three(v + 3),
                  .intensity = rgb(v[6], v[7], v[8]), .cos_inner = v[9], .cos_outer = v[10] };
    if (kind != LIGHT_POINT)
        l->direction = vec3_unit(l->direction);
    take_name(at, l->name);
    return true;
}

static bool add_material(PlyNotes *notes, const char *at, Error *err)
{
    char *end;
    const unsigned long number = strtoul(at, &end, 10);
    if (end == at || number != notes->material_count || *end != ' ')
        return true;
    if (!array_reserve((void **)&notes->material_name, &notes->material_capacity,
                       (size_t)notes->material_count + 1, sizeof *notes->material_name,
                       "material names", err))
        return false;
    char *copy = array_string(end + 1, err);
    if (copy != NULL)
        notes->material_name[notes->material_count++] = copy;
    return copy != NULL;
}

bool ply_notes_take(PlyNotes *notes, const char *line, Error *err)
{
    double v[3];
    assert(notes != NULL && line != NULL);
    if (take_word(&line, "x y z: scene units of "))
        notes->unit_m = take_numbers(&line, v, 1) && v[0] > 0 ? v[0] : 0;
    else if (take_word(&line, "radiosity: "))
        notes->watts = strstr(line, "W/m2") != NULL;
    else if (take_word(&line, "material "))
        return add_material(notes, line, err);
    else if (take_word(&line, "camera "))
        return add_camera(notes, line, err);
    else if (take_word(&line, "light "))
        return add_light(notes, line, err);
    else if (take_word(&line, "up ") && take_numbers(&line, v, 3) && vec3_length(three(v)) > 0) {
        notes->has_up = true;
        notes->up = vec3_unit(three(v));
    }
    return true;
}

void ply_notes_clear(PlyNotes *notes)
{
    for (uint32_t i = 0; i < notes->material_count; i++)
        array_free(notes->material_name[i]);
    array_free(notes->material_name);
    array_free(notes->camera);
    array_free(notes->light);
    *notes = (PlyNotes){ 0 };
}
