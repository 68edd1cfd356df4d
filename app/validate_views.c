/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: rooms with walls between, whose factors from each surface to each other are
 * known. One line tells the worst of many pairs. */
#include "app/validate_views.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/model.h"
#include "app/validate.h"
#include "base/array.h"

enum { PATCHES = 300, MOST_RAYS = 1 << 24 };

/* What is asked: of pairs with nothing between, of all others, and of row sums. */
static const double OPEN_OFF = 1e-7, HIDDEN_OFF = 3e-4, ROW_OFF = 1e-3;

/* So that what these rays leave open is a small part of what is asked. */
static const double ACCURACY = 3e-5;

/* Digits of the values: half of the last one is added to what is asked. */
static const double OPEN_UNIT = 1e-8, HIDDEN_UNIT = 1e-7;

static Scene *view_scene(const ViewCase *view, Error *err)
{
    Scene *scene = scene_create(view->name, err);
    if (scene == NULL)
        return NULL;
    const uint32_t material = model_grey(scene, "black", 0, 0, err);
    for (size_t i = 0; i < view->faces; i++) {
        Vec3 corner[4];
        char name[24];
        const int corners = view->face[i][2] == view->face[i][3] ? 3 : 4;
        for (int k = 0; k < corners; k++) {
            const double *p = view->point[view->face[i][k]];
            corner[k] = vec3(p[0], p[1], p[2]);
        }
        snprintf(name, sizeof name, "%zu", i + 1);
        model_polygon(scene, corner, corners, material, name, err);
    }
    return scene;
}

static GroupFactors *find_factors(const Pipeline *pipeline, Error *err)
{
    const Settings *settings = &pipeline->session->settings;
    const GroupOptions options = {
        .count = (uint32_t)pipeline->scene->polygons.group_count,
        .patch_class = pipeline->patches->group, .accuracy = ACCURACY, .most_rays = MOST_RAYS,
        .seed = settings->seed, .threads = settings->threads };
    return group_factors_create(&pipeline->room, &options, &pipeline->session->monitor, err);
}

/* A pair furthest from what is known, and how many of its kind there are. */
typedef struct {
    size_t   count;
    uint32_t i, j;
    double   expected, value, error;
} Worst;

static void compare(Worst *worst, const GroupFactors *factors, uint32_t i, uint32_t j,
                    double expected, double error)
{
    const double value = group_factor(factors, i, j);
    worst->count++;
    if (worst->count > 1 && fabs(value - expected) <= fabs(worst->value - worst->expected))
        return;
    *worst = (Worst){ worst->count, i, j, expected, value,
                      hypot(error, group_factor_error(factors, i, j)) };
}

/* One row against its text: pairs with nothing between to worst[0], all others to worst[1]. */
static void compare_row(const ViewCase *view, const GroupFactors *factors, uint32_t i,
                        Worst worst[2])
{
    uint32_t j = i + 1;
    for (const char *p = view->row[i]; *p != '\0'; p += strspn(p, " ")) {
        char *end = NULL;
        if (*p == '.') {
            const long run = p[1] >= '0' && p[1] <= '9' ? strtol(p + 1, &end, 10) : 1;
            for (long k = 0; k < run; k++)
                compare(&worst[1], factors, i, j++, 0, 0);
            p = run > 1 ? end : p + 1;
            continue;
        }
        const double digits = strtod(p, &end);
        if (*end == '~')
            compare(&worst[1], factors, i, j++, digits * HIDDEN_UNIT,
                    strtod(end + 1, &end) * HIDDEN_UNIT);
        else
            compare(&worst[0], factors, i, j++, digits * OPEN_UNIT, 0);
        assert(end > p && j <= view->faces);
        p = end;
    }
    while (j < view->faces)
        compare(&worst[1], factors, i, j++, 0, 0);
}

static void check_worst(Validation *validation, const char *kind, const Worst *worst, double most,
                        Error *err)
{
    char quantity[40];
    if (worst->count == 0)
        return;
    snprintf(quantity, sizeof quantity, "%zu %s, %u to %u", worst->count, kind, worst->i + 1,
             worst->j + 1);
    validation_check(validation, quantity, worst->expected, worst->value, most, worst->error, err);
}

static void check_rows(Validation *validation, const GroupFactors *factors, Error *err)
{
    double worst = 1, error = 0;
    for (uint32_t i = 0; i < factors->count; i++) {
        double sum = 0, squares = 0;
        for (uint32_t j = 0; j < factors->count; j++) {
            sum += group_factor(factors, i, j);
            squares += pow(group_factor_error(factors, i, j), 2);
        }
        if (fabs(sum - 1) >= fabs(worst - 1)) {
            worst = sum;
            error = sqrt(squares);
        }
    }
    validation_check(validation, "worst row sum", 1, worst, ROW_OFF, error, err);
}

static bool run_view(Validation *validation, const ViewCase *view, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_FACTORS, .sides = USE_FRONT, .patches = PATCHES,
                              .patches_only = true };
    Session session;
    Pipeline pipeline;
    GroupFactors *factors = NULL;
    if (validation_run(validation, view_scene(view, err), &setup, &session, &pipeline, err))
        factors = find_factors(&pipeline, err);
    if (factors != NULL) {
        Worst worst[2] = { { 0 } };
        assert(factors->count == view->faces);
        for (uint32_t i = 0; i < factors->count; i++)
            compare_row(view, factors, i, worst);
        check_worst(validation, "open", &worst[0], OPEN_OFF + OPEN_UNIT / 2, err);
        check_worst(validation, "hidden", &worst[1], HIDDEN_OFF, err);
        if (view->closed)
            check_rows(validation, factors, err);
    }
    group_factors_destroy(factors);
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

static bool run_plates(Validation *v, Error *err)
{
    return run_view(v, &validate_view_plates, err);
}

static bool run_cube(Validation *v, Error *err)
{
    return run_view(v, &validate_view_cube, err);
}

static bool run_facet(Validation *v, Error *err)
{
    return run_view(v, &validate_view_facet, err);
}

static bool run_obstruction(Validation *v, Error *err)
{
    return run_view(v, &validate_view_obstruction, err);
}

static bool run_l_room(Validation *v, Error *err)
{
    return run_view(v, &validate_view_l_room, err);
}

static bool run_gunter1(Validation *v, Error *err)
{
    return run_view(v, &validate_view_gunter1, err);
}

static bool run_box345(Validation *v, Error *err)
{
    return run_view(v, &validate_view_box345, err);
}

const Case *validate_view_cases(size_t *count)
{
    static const Case cases[] = {
        { "view-plates", "two parallel squares", run_plates },
        { "view-cube", "the six faces of a cube", run_cube },
        { "view-facet", "a cube with a plate in it, all pairs", run_facet },
        { "view-obstruction", "two squares, a plate in a corner between", run_obstruction },
        { "view-l-room", "an L-shaped room of twelve surfaces", run_l_room },
        { "view-gunter1", "an irregular room", run_gunter1 },
        { "view-box345", "a box of 106 squares with two cubes in it", run_box345 },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
