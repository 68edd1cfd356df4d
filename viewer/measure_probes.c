/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of probes, and its file. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "viewer/measure.h"

bool probes_add(Probes *probes, const ShownMesh *mesh, const Reading *reading, Error *err)
{
    assert(reading->group < mesh->group_count && reading->material < mesh->material_count);
    void *room = probes->probe;
    if (!array_reserve(&room, &probes->capacity, probes->count + 1, sizeof *probes->probe,
                       "probes", err))
        return false;
    probes->probe = room;
    Probe probe = { .reading = *reading,
                    .group = array_string(mesh->group_name[reading->group], err),
                    .material = array_string(mesh->material_name[reading->material], err) };
    if (error_is_set(err)) {
        array_free(probe.group);
        array_free(probe.material);
        return false;
    }
    probes->probe[probes->count++] = probe;
    return true;
}

void probes_remove(Probes *probes, size_t index)
{
    assert(index < probes->count);
    Probe *p = probes->probe + index;
    array_free(p->group);
    array_free(p->material);
    memmove(p, p + 1, (probes->count - index - 1) * sizeof *p);
    probes->count--;
}

void probes_clear(Probes *probes)
{
    while (probes->count > 0)
        probes_remove(probes, probes->count - 1);
    array_free(probes->probe);
    *probes = (Probes){ 0 };
}

static void put_name(const char *name, FILE *out)
{
    fputc('"', out);
    for (; *name != 0; name++) {
        if (*name == '"')
            fputc('"', out);
        fputc(*name, out);
    }
    fputc('"', out);
}

static void put_value(double value, FILE *out)
{
    if (isnan(value))
        fputc(',', out);
    else
        fprintf(out, ",%.9g", value);
}

bool probes_write(const Probes *probes, bool lux, const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fprintf(out, "x,y,z,nx,ny,nz,patch,group,material,area,%s,row_sum\n",
            lux ? "lux,lux_error,lm/m2,lm/m2_here,cd/m2"
                : "W/m2_in,W/m2_error,W/m2_out,W/m2_here,W/m2sr");
    for (size_t i = 0; i < probes->count; i++) {
        const Probe *p = &probes->probe[i];
        const Reading *r = &p->reading;
        fprintf(out, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%u,", r->place.x, r->place.y, r->place.z,
                r->normal.x, r->normal.y, r->normal.z, r->patch);
        put_name(p->group, out);
        fputc(',', out);
        put_name(p->material, out);
        const double value[] = { r->area, r->irradiance, r->error, r->radiosity, r->here,
                                 r->luminance, r->row_sum };
        for (size_t k = 0; k < sizeof value / sizeof *value; k++)
            put_value(value[k], out);
        fputc('\n', out);
    }
    return outfile_commit(file, err);
}
