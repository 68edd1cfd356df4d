/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: grey surfaces of one radiosity each, by the exchange of heat between groups
 * (radiosity/exchange.h). Values by the algebra of enclosures from factors in closed form; light
 * that varies over a surface is another answer, for which see the rooms. */
#include <math.h>

#include "app/model.h"
#include "app/validate.h"
#include "base/array.h"
#include "radiosity/exchange.h"

enum { FACES = 6, PATCHES = 300, MOST_RAYS = 1 << 23 };

/* What is asked, relative. Factors of a box are exact, and values are written with twelve digits. A
 * cone's come from rays: an error of its F to itself moves its radiosity by rho / (1 - rho F) times
 * as much of itself, below 1.8; so 4 standard errors of 4e-5. */
static const double BOX_OFF = 1e-9, CONE_ACCURACY = 4e-5, CONE_OFF = 3e-4;

typedef struct {
    double size[3], exitance[FACES], reflectance[FACES], radiosity[FACES];
} GreyBox;

static const GreyBox boxes[] = {
    { { 1, 1, 1 }, { 0, 0, 0, 0, 0, 1 },
      { 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 },
      { 0.181836268946, 0.181836268946, 0.181836268946, 0.181836268946,
        0.181745826108, 1.09090909811 } },
    { { 1, 1, 1 }, { 0, 0, 0, 0, 0, 1 },
      { 0.8, 0.8, 0.8, 0.8, 0.8, 0.8 },
      { 0.689681193904, 0.689681193904, 0.689681193904, 0.689681193904,
        0.689551070738, 1.55172415364 } },
    { { 2, 3, 2.5 }, { 0, 0, 0, 0, 0.2, 1 },
      { 0.3, 0.3, 0.5, 0.5, 0.2, 0.8 },
      { 0.106985249108, 0.106985249108, 0.171664648689, 0.171664648689,
        0.264553749277, 1.12638654112 } },
};

/* A cone of height 2 over a disc of radius 1: disc, cone. */
static const struct {
    double exitance[2], reflectance[2], radiosity[2];
} cones[] = {
    { { 1, 0 }, { 0.5, 0.3 }, { 1.08745093209, 0.174901864171 } },
    { { 0, 2 }, { 0.2, 0.9 }, { 0.947881250043, 4.73940625021 } },
};

/* Radiosity of n classes: temperatures that give their exitances, the net flux between them, and
 * back. */
static bool find_radiosity(const GroupFactors *f, uint32_t n, const double *exitance,
                           const double *reflectance, double *out, Error *err)
{
    double *factor = array_create((size_t)n * n + 3 * (size_t)n, sizeof *factor, "enclosure", err);
    if (factor == NULL)
        return false;
    double *emissivity = factor + (size_t)n * n, *temperature = emissivity + n;
    double *flux = temperature + n;
    for (uint32_t i = 0; i < n; i++) {
        emissivity[i] = 1 - reflectance[i];
        temperature[i] = pow(exitance[i] / (emissivity[i] * EXCHANGE_STEFAN_BOLTZMANN), 0.25);
        for (uint32_t j = 0; j < n; j++)
            factor[(size_t)i * n + j] = group_factor(f, i, j);
    }
    const ExchangeProblem problem = { .count = n, .factor = factor, .emissivity = emissivity };
    const bool done = exchange_flux(&problem, temperature, 0, flux, err);
    for (uint32_t i = 0; done && i < n; i++)
        out[i] = exitance[i] + reflectance[i] * (flux[i] + exitance[i]) / emissivity[i];
    array_free(factor);
    return done;
}

typedef struct {
    Scene        *scene;      /* which the run takes */
    const double *exitance, *reflectance, *radiosity;
    const char   *label;
    bool          curved;     /* the inside of the second group is its back */
    double        accuracy, off;
} Enclosure;

/* A class for each group's side that looks inwards, and one for all that look outwards. */
static GroupFactors *find_factors(const Pipeline *pipeline, const Enclosure *e, Error *err)
{
    const Patches *patches = pipeline->patches;
    const uint32_t n = (uint32_t)pipeline->scene->polygons.group_count;
    const Settings *settings = &pipeline->session->settings;
    uint32_t *class = array_create(patches->count, sizeof *class, "sides of groups", err);
    if (class == NULL)
        return NULL;
    for (uint32_t i = 0; i < patches->count; i++) {
        const uint32_t inside = e->curved && patches->group[i] == 1 ? 1 : 0;
        class[i] = patches->side[i] == inside ? patches->group[i] : n;
    }
    const GroupOptions options = { .count = n + 1, .patch_class = class, .accuracy = e->accuracy,
                                   .most_rays = MOST_RAYS, .seed = settings->seed,
                                   .threads = settings->threads };
    GroupFactors *factors = group_factors_create(&pipeline->room, &options,
                                                 &pipeline->session->monitor, err);
    array_free(class);
    return factors;
}

static bool run_enclosure(Validation *validation, const Enclosure *e, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_FACTORS, .patches = PATCHES,
                              .sides = e->curved ? USE_BOTH : USE_FRONT, .patches_only = true };
    Session session;
    Pipeline pipeline;
    GroupFactors *factors = NULL;
    if (validation_run(validation, e->scene, &setup, &session, &pipeline, err))
        factors = find_factors(&pipeline, e, err);
    double radiosity[FACES];
    const uint32_t n = factors != NULL ? factors->count - 1 : 0;
    if (factors != NULL &&
        find_radiosity(factors, n, e->exitance, e->reflectance, radiosity, err))
        for (uint32_t i = 0; i < n; i++) {
            char quantity[40];
            snprintf(quantity, sizeof quantity, "%s, %s", e->label,
                     pipeline.scene->polygons.group_name[i]);
            validation_check(validation, quantity, e->radiosity[i], radiosity[i],
                             e->off * e->radiosity[i], NAN, err);
        }
    group_factors_destroy(factors);
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

static bool run_boxes(Validation *validation, Error *err)
{
    for (size_t i = 0; i < sizeof boxes / sizeof *boxes && !error_is_set(err); i++) {
        const GreyBox *b = &boxes[i];
        char label[24];
        Scene *scene = scene_create("box", err);
        if (scene != NULL) {
            const uint32_t m = model_grey(scene, "black", 0, 0, err);
            model_box(scene, vec3(b->size[0], b->size[1], b->size[2]),
                      (uint32_t[]){ m, m, m, m, m, m }, err);
        }
        snprintf(label, sizeof label, "box %zu", i + 1);
        const Enclosure e = { scene, b->exitance, b->reflectance, b->radiosity, label, false,
                              BOX_OFF, BOX_OFF };
        run_enclosure(validation, &e, err);
    }
    return !error_is_set(err);
}

static bool run_cones(Validation *validation, Error *err)
{
    for (size_t i = 0; i < sizeof cones / sizeof *cones && !error_is_set(err); i++) {
        char label[24];
        Scene *scene = scene_create("cone", err);
        if (scene != NULL) {
            const uint32_t m = model_grey(scene, "black", 0, 0, err);
            model_shape(scene, SHAPE_DISC, 0, vec3(0, 0, 2), vec3(1, 1, -1), m, "disc", err);
            /* Turned over: a mirroring map keeps the normals outwards, so the inside is the back;
             * the tip is at 0. */
            model_shape(scene, SHAPE_FRUSTUM, 0, vec3(0, 0, 2), vec3(1, 1, -2), m, "cone", err);
        }
        snprintf(label, sizeof label, "%zu", i + 1);
        const Enclosure e = { scene, cones[i].exitance, cones[i].reflectance, cones[i].radiosity,
                              label, true, CONE_ACCURACY, CONE_OFF };
        run_enclosure(validation, &e, err);
    }
    return !error_is_set(err);
}

const Case *validate_enclosure_cases(size_t *count)
{
    static const Case cases[] = {
        { "grey-box", "six grey walls of one radiosity each", run_boxes },
        { "grey-cone", "a grey cone on a grey disc", run_cones },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
