/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux factors --points: what points see of each group, as CSV. */
#include <assert.h>

#include "app/commands.h"
#include "app/csv.h"
#include "app/digits.h"
#include "app/factors_files.h"
#include "app/place.h"
#include "app/points.h"
#include "app/summary.h"
#include "base/array.h"
#include "base/file.h"
#include "radiosity/point_factors.h"

typedef struct {
    const Points   *points;
    uint32_t        classes;
    double         *factor, *error; /* [points * (classes + 2)] */
    uint8_t        *used;     /* [classes]  some side of it takes part */
} PointTable;

static const char *class_name(const Polygons *soup, FactorsBy by, uint32_t i)
{
    return by == BY_GROUP ? soup->group_name[i] : soup->materials[i].name;
}

static void put_heading(FILE *out, const Polygons *soup, FactorsBy by, const PointTable *table)
{
    fputs("x,y,z,nx,ny,nz", out);
    for (uint32_t c = 0; c < table->classes; c++)
        if (table->used[c]) {
            fputc(',', out);
            csv_text(out, class_name(soup, by, c));
        }
    fputs(",escaped,unused,standard_error\n", out);
}

static bool write_table(const Pipeline *pipeline, const PointTable *table, const char *path,
                        Error *err)
{
    const Scene *scene = pipeline->scene;
    const FactorsBy by = (FactorsBy)pipeline->session->options.by;
    const uint32_t columns = table->classes + 2;
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    Digits *d = array_create(1, sizeof *d, "a table", err);
    if (d == NULL) {
        outfile_discard(file);
        return false;
    }
    d->out = out;
    put_heading(out, &scene->polygons, by, table);
    for (size_t i = 0; i < table->points->count; i++) {
        const Vec3 n = table->points->given[i];
        const double *row = &table->factor[i * columns], *error = &table->error[i * columns];
        char place[PLACE_TEXT];
        double worst = 0;
        place_text(scene, table->points->point[i], 9, place);
        fprintf(out, "%s,%.9g,%.9g,%.9g", place, n.x, n.y, n.z);
        for (uint32_t c = 0; c < columns; c++) {
            worst = error[c] > worst ? error[c] : worst;
            if (c < table->classes && !table->used[c])
                continue;
            digits_letter(d, ',');
            digits_number(d, row[c]);
        }
        digits_letter(d, ',');
        digits_number(d, worst);
        digits_letter(d, '\n');
        digits_flush(d);
    }
    array_free(d);
    return outfile_commit(file, err);
}

static bool cast_table(Pipeline *pipeline, PointTable *table, Error *err)
{
    Session *session = pipeline->session;
    const Patches *patches = pipeline->patches;
    const Polygons *soup = &pipeline->scene->polygons;
    const bool groups = session->options.by == BY_GROUP;
    const double begin = progress_now();
    table->classes = (uint32_t)(groups ? soup->group_count : soup->material_count);
    const size_t n = table->points->count * ((size_t)table->classes + 2);
    const PointFactorsOptions options = {
        .rays = session->settings.gather_rays, .seed = session->settings.seed,
        .threads = session->settings.threads, .classes = table->classes,
        .class_of = groups ? patches->group : patches->material,
    };
    if (table->points->count > UINT32_MAX)
        return error_set(err, ERROR_INPUT, "more than 2^32 points");
    if (!pipeline_fits(pipeline, 2 * n * sizeof(double), "points", err))
        return false;
    table->factor = array_create(n, sizeof *table->factor, "points", err);
    table->error = array_create(n, sizeof *table->error, "points", err);
    table->used = array_create(table->classes, 1, "points", err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < patches->count; i++)
        table->used[options.class_of[i]] = 1;
    const bool done = point_factors(&pipeline->room, table->points->point, table->points->normal,
                                    (uint32_t)table->points->count, &options, table->factor,
                                    table->error, &session->monitor, err);
    pipeline_note(pipeline, STAGE_FACTORS, begin);
    return done;
}

/* The points go where the scene went. */
static bool run(Pipeline *pipeline, Points *points, const char *output, Error *err)
{
    PointTable table = { .points = points };
    if (!pipeline_read(pipeline, err))
        return false;
    for (size_t i = 0; i < points->count; i++)
        points->point[i] = scene_from_file(pipeline->scene, points->point[i]);
    pipeline->point = points->point;
    pipeline->normal = points->normal;
    pipeline->point_count = points->count;
    const bool done = pipeline_mesh(pipeline, err) && pipeline_patches(pipeline, err) &&
                      cast_table(pipeline, &table, err) &&
                      write_table(pipeline, &table, output, err);
    array_free(table.factor);
    array_free(table.error);
    array_free(table.used);
    return done;
}

bool factors_of_points(Pipeline *pipeline, const char *output, Error *err)
{
    const Options *options = &pipeline->session->options;
    Points points = { 0 };
    assert(options->points != NULL);
    if (options->by == BY_PATCH || options->exchange != EXCHANGE_NONE || options->rows != NULL ||
        options->factors != NULL)
        return error_set(err, ERROR_USAGE, "--points writes factors to groups or materials; "
                         "it goes with no other matrix");
    const bool done = points_read(&points, options->points, err) &&
                      run(pipeline, &points, output, err);
    if (done) {
        session_say(pipeline->session, "isolux: %s, %zu points -> %s", options->scene,
                    points.count, output);
        summary_print(pipeline);
    }
    pipeline->point = pipeline->normal = NULL;
    pipeline->point_count = 0;
    points_free(&points);
    return done;
}
