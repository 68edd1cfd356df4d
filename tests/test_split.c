/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures by light groups: against closed forms, against their sum, and against the other lamps
 * being off. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "radiosity/relight.h"
#include "render/gather.h"
#include "render/records.h"
#include "room_maker.h"

enum { A, B, LIGHT, GROUPS };
static const char *const names[] = { "a", "b", "light", "background" };

/* Lamp groups "a" and "b" of a room. */
static uint32_t *lamp_groups(const TestRoom *r)
{
    Error err = { 0 };
    uint32_t *of = array_create(r->soup.group_count, sizeof *of, "groups", &err);
    assert_non_null(of);
    memset(of, 0xff, r->soup.group_count * sizeof *of);
    of[room_group(r, "a")] = A;
    of[room_group(r, "b")] = B;
    return of;
}

/* Front sides alone take part. */
static void use_fronts(TestRoom *r, double size, const Light *lights, size_t light_count)
{
    room_connect(r);
    memset(r->sides, 1, r->surfaces->count);
    for (uint32_t i = 0; i < r->surfaces->count; i++)
        r->emitting[i] = rgb_max(r->soup.materials[r->surfaces->surface[i].material].emission) > 0;
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh, .materials = r->soup.materials,
                      .material_count = r->soup.material_count, .lights = lights,
                      .light_count = light_count, .sides = r->sides, .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
    room_divide(r, size);
}

/* --- closed forms ----------------------------------------------------------------------------- */

/* Irradiance under the corner of a rectangle a x b at height c, per radiance; [howell, C-4], times
 * pi. */
static double under_corner(double a, double b, double c)
{
    const double p = sqrt(a * a + c * c), q = sqrt(b * b + c * c);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / 2;
}

/* Two square lamps over a floor and a point light aside, nothing in between: each layer has its own
 * formula, and no noise. */
static void layers_are_exact(void **state)
{
    (void)state;
    Error    err = { 0 };
    TestRoom r = { 0 };
    const Light light = { .position = { -5, 0, 2 }, .intensity = { 7, 5, 3 } };
    const uint32_t floor = room_material(&r, 0.5, 0), one = room_material(&r, 0, 2 * M_PI),
                   two = room_material(&r, 0, 3 * M_PI);
    room_quad(&r, vec3(-9, -9, 0), vec3(18, 0, 0), vec3(0, 18, 0), floor, "floor");
    room_quad(&r, vec3(-1, -1, 1), vec3(0, 2, 0), vec3(2, 0, 0), one, "a");
    room_quad(&r, vec3(2, 0, 1), vec3(0, 2, 0), vec3(2, 0, 0), two, "b");
    use_fronts(&r, 5, &light, 1);
    Links *links = room_links(&r, 16, CLOSURE_NONE);
    double *emission, *reflectance;
    room_problem(&r, &emission, &reflectance);
    const size_t values = (size_t)r.patches->count * ROOM_BANDS;
    uint32_t *of = lamp_groups(&r);
    double *apart = array_create(GROUPS * values, sizeof *apart, "groups", &err);
    for (size_t i = 0; i < values; i++)
        for (int k = 0; k < LIGHT; k++)
            if (of[r.patches->group[i / ROOM_BANDS]] == (uint32_t)k)
                apart[k * values + i] = emission[i];
    const Solution solution = { .count = r.patches->count, .bands = ROOM_BANDS,
                                .radiosity = emission, .irradiance = emission };
    Gatherer *g = gatherer_create(&r.room, &solution, links, &err);
    const GatherGroups groups = { .count = GROUPS, .first_light = LIGHT, .radiosity = apart,
                                  .of_group = of, .name = names };
    assert_true(gatherer_split(g, &groups, links, &err));
    const Camera camera = { .eye = { 0, 0, 0.5 }, .target = { 0, 0, 0 }, .up = { 0, 1, 0 },
                            .projection = CAMERA_ORTHOGRAPHIC, .view_height = 1e-5 };
    const RenderOptions ro = { .width = 4, .height = 4, .samples = 4, .threads = 1 };
    Image *image = render_gather(g, &camera, &ro, NULL, NULL, &err);
    assert_non_null(image);
    assert_int_equal(image->group_count, GROUPS);
    const double away = 29; /* square of the light's distance */
    const double exact[GROUPS] = {
        2 * 4 * under_corner(1, 1, 1),
        3 * (under_corner(4, 2, 1) - under_corner(2, 2, 1)),
        7 * 2 / (away * sqrt(away)),
    };
    for (uint32_t k = 0; k < GROUPS; k++) {
        assert_string_equal(image->group_name[k], names[k]);
        for (int i = 0; i < 16; i++)
            assert_true(fabs(image_group(image, k)[3 * i] / (0.5 / M_PI * exact[k]) - 1) < 2e-5);
    }
    assert_true(fabs(image_group(image, LIGHT)[2] / image_group(image, LIGHT)[0] - 3.0 / 7) < 1e-6);
    image_destroy(image);
    gatherer_destroy(g);
    array_free(apart);
    array_free(of);
    array_free(emission);
    array_free(reflectance);
    links_destroy(links);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* --- a room ----------------------------------------------------------------------------------- */

typedef struct {
    TestRoom  room;
    Links    *links;
    uint32_t *of;
} Hall;

static const Camera inside = { .eye = { 0.3, 0.2, 1.4 }, .target = { 2.4, 3, 0.8 },
                               .up = { 0, 0, 1 }, .vertical_fov = 75 };

/* A closed room with a screen, a lamp on either side of it, open to a bright background through a
 * missing wall. */
static void hall_make(Hall *h, bool open)
{
    TestRoom *r = &h->room;
    *h = (Hall){ 0 };
    const uint32_t wall = room_material(r, 0.6, 0);
    room_box(r, vec3(0, 0, 0), vec3(3, 4, 2.5), open ? BOX_ALL & ~BOX_Y1 : BOX_ALL, true, wall,
             "wall");
    room_box(r, vec3(1.4, 1, 0), vec3(1.6, 3, 1.5), BOX_ALL & ~BOX_Z0, false, wall, "screen");
    room_quad(r, vec3(0.4, 1.8, 2.4), vec3(0, 0.5, 0), vec3(0.5, 0, 0),
              room_material(r, 0.3, 30), "a");
    room_quad(r, vec3(2.2, 1.8, 2), vec3(0, 0.3, 0), vec3(0.3, 0, 0), room_material(r, 0.3, 50),
              "b");
    use_fronts(r, 0.5, NULL, 0);
    h->links = room_links(r, 64, open ? CLOSURE_NONE : CLOSURE_ROWS);
    h->of = lamp_groups(r);
}

static void hall_clear(Hall *h)
{
    links_destroy(h->links);
    array_free(h->of);
    room_clear(&h->room);
    assert_int_equal(array_live(), 0);
}

static const SolveOptions solving = { .tolerance = 1e-6, .threads = 1 };

/* The picture by groups, each `dimmer` times as bright as its material says. */
static Image *hall_picture(Hall *h, const double *dimmer, const RenderOptions *ro)
{
    Error err = { 0 };
    double *emission, *reflectance;
    room_problem(&h->room, &emission, &reflectance);
    const size_t values = (size_t)h->room.patches->count * ROOM_BANDS;
    double *apart = array_create(LIGHT * values, sizeof *apart, "groups", &err);
    LightGroup group[LIGHT];
    for (int k = 0; k < LIGHT; k++) {
        for (size_t i = 0; i < values; i++)
            if (h->of[h->room.patches->group[i / ROOM_BANDS]] == (uint32_t)k)
                apart[k * values + i] = emission[i] / (dimmer != NULL ? dimmer[3 * k] : 1);
        group[k] = (LightGroup){ .emission = apart + k * values };
    }
    LightGroups *solved = light_groups_solve(h->links, ROOM_BANDS, reflectance, group, LIGHT,
                                             &solving, NULL, &err);
    assert_non_null(solved);
    Solution *all = solve(h->links, &(SolveProblem){ ROOM_BANDS, emission, reflectance, NULL },
                          &solving, NULL, &err);
    Gatherer *g = gatherer_create(&h->room.room, all, h->links, &err);
    const char *const name[] = { "a", "b", "background" };
    const GatherGroups groups = { .count = LIGHT, .first_light = LIGHT, .dimmer = dimmer,
                                  .radiosity = solved->radiosity, .of_group = h->of,
                                  .name = name };
    assert_true(gatherer_split(g, &groups, h->links, &err));
    Image *image = render_gather(g, &inside, ro, NULL, NULL, &err);
    assert_non_null(image);
    gatherer_destroy(g);
    light_groups_destroy(solved);
    solution_destroy(all);
    array_free(apart);
    array_free(emission);
    array_free(reflectance);
    return image;
}

/* All layers add up to the picture, each sample of it being told apart; `layers` there are. */
static void check_sum(const Image *image, uint32_t layers)
{
    assert_int_equal(image->group_count, layers);
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < layers; k++)
            sum += image_group(image, k)[i];
        assert_true(fabs(sum - image->radiance[i]) <= 1e-5 * image->radiance[i] + 1e-9);
    }
}

static double mean_of(const Image *image, const float *layer)
{
    const int n = image->width * image->height;
    double    sum = 0;
    for (int i = 0; i < n; i++)
        sum += layer[3 * i];
    return sum / n;
}

static void layers_add_up(void **state)
{
    (void)state;
    const RenderOptions plain = { .width = 24, .height = 18, .samples = 8, .threads = 1 };
    const RenderOptions sparing = { .width = 24, .height = 18, .samples = 64, .threads = 1,
                                    .error = 0.05 };
    const double dimmer[] = { 0.5, 0.5, 0.5, 2, 2, 2 };
    for (int open = 0; open < 2; open++) {
        Hall h;
        hall_make(&h, open != 0);
        RenderOptions o = plain;
        o.background = open != 0 ? rgb(3, 2, 1) : rgb(0, 0, 0);
        Image *image = hall_picture(&h, NULL, &o);
        check_sum(image, open != 0 ? 3 : 2);
        if (open != 0) /* only seen, and by the same in red as in blue but for its colour */
            assert_true(fabs(mean_of(image, image_group(image, 2)) /
                             mean_of(image, image_group(image, 2) + 2) - 3) < 1e-5);
        image_destroy(image);
        image = hall_picture(&h, dimmer, &sparing);
        check_sum(image, 2);
        image_destroy(image);
        Error err = { 0 };
        o = sparing;
        o.records = records_create(&err); /* they tell the groups apart, too */
        o.record_rays = 64;
        records_split(o.records, LIGHT + 1);
        image = hall_picture(&h, dimmer, &o);
        check_sum(image, 2);
        assert_true(records_count(o.records) > 10);
        image_destroy(image);
        records_destroy(o.records);
        hall_clear(&h);
    }
}

/* Standard error of the picture's mean. */
static double error_of(const Image *image)
{
    const int n = image->width * image->height;
    double    sum = 0;
    for (int i = 0; i < n; i++)
        sum += (double)image->deviation[i] * image->deviation[i];
    return sqrt(sum) / n;
}

/* A layer is what is seen with the other lamp off; that other picture knows nothing of groups, nor
 * do its rays go the same ways. */
static void a_layer_is_a_lamp_alone(void **state)
{
    (void)state;
    const RenderOptions ro = { .width = 32, .height = 24, .samples = 1024, .threads = 1,
                               .error = 0.006 };
    Hall h;
    Error none = { 0 };
    hall_make(&h, false);
    Image *both = hall_picture(&h, NULL, &ro);
    RenderOptions recorded = ro;
    recorded.records = records_create(&none);
    recorded.record_rays = 1024;
    recorded.error = 0.01;
    recorded.width = 96; /* records lie pixels apart: more of them, for the same view */
    recorded.height = 72;
    records_split(recorded.records, LIGHT + 1);
    Image *read = hall_picture(&h, NULL, &recorded);
    for (int k = 0; k < LIGHT; k++) {
        Error err = { 0 };
        double *emission, *reflectance;
        const uint32_t other = room_surface(&h.room, names[1 - k]);
        Material *m = &h.room.soup.materials[h.room.surfaces->surface[other].material];
        const Rgb light = m->emission;
        m->emission = rgb(0, 0, 0);
        h.room.emitting[other] = 0;
        room_problem(&h.room, &emission, &reflectance);
        Solution *alone = solve(h.links, &(SolveProblem){ ROOM_BANDS, emission, reflectance, NULL },
                                &solving, NULL, &err);
        Gatherer *g = gatherer_create(&h.room.room, alone, h.links, &err);
        Image *image = render_gather(g, &inside, &ro, NULL, NULL, &err);
        assert_non_null(image);
        const double layer = mean_of(both, image_group(both, (uint32_t)k));
        const double mean = mean_of(image, image->radiance);
        /* Noise of a layer is at most about that of all light. */
        assert_true(fabs(layer - mean) < 4 * hypot(error_of(both), error_of(image)));
        assert_true(4 * hypot(error_of(both), error_of(image)) < 0.02 * mean);
        /* Records are smooth where light is not: they are allowed 1 % for it. */
        assert_true(fabs(mean_of(read, image_group(read, (uint32_t)k)) - mean) <
                    4 * hypot(error_of(read), error_of(image)) + 0.01 * mean);
        m->emission = light;
        h.room.emitting[other] = 1;
        image_destroy(image);
        gatherer_destroy(g);
        solution_destroy(alone);
        array_free(emission);
        array_free(reflectance);
    }
    image_destroy(both);
    image_destroy(read);
    records_destroy(recorded.records);
    hall_clear(&h);
}

/* --- files ------------------------------------------------------------------------------------ */

/* Layers come back from a file by their names, long ones too. */
static void layers_in_files(void **state)
{
    (void)state;
    static const char *const long_names[] = { "lamp", "a-name-that-is-longer-than-thirty-one" };
    const char *const folder = getenv("TMPDIR");
    char path[256], layer[96];
    Error err = { 0 };
    snprintf(path, sizeof path, "%s/split.exr", folder != NULL ? folder : "/tmp");
    Image *image = image_create(5, 3, &err);
    assert_true(image_add_groups(image, long_names, 2, &err));
    for (uint32_t k = 0; k < 2; k++)
        for (int i = 0; i < 45; i++)
            image_group(image, k)[i] = (float)(i + 100 * (int)k);
    assert_true(image_write_exr(image, NULL, path, &err));
    for (uint32_t k = 0; k < 2; k++) {
        int width, height;
        snprintf(layer, sizeof layer, "lightgroup.%s", long_names[k]);
        float *back = image_read_layer(path, layer, &width, &height, &err);
        assert_non_null(back);
        assert_memory_equal(back, image_group(image, k), 45 * sizeof *back);
        array_free(back);
    }
    remove(path);
    image_destroy(image);
    assert_int_equal(array_live(), 0);
}

/* Groups as bytes come back the same, and nothing else is taken for them. */
static void groups_as_bytes(void **state)
{
    (void)state;
    Error  err = { 0 };
    double radiosity[12], irradiance[12];
    for (int i = 0; i < 12; i++) {
        radiosity[i] = i;
        irradiance[i] = -i;
    }
    const LightGroups groups = { .count = 2, .groups = 2, .bands = 3, .radiosity = radiosity,
                                 .irradiance = irradiance, .iterations = 7, .converged = true };
    void  *bytes;
    size_t size;
    assert_true(light_groups_pack(&groups, &bytes, &size, &err));
    LightGroups *back = light_groups_unpack(bytes, size, 2, &err);
    assert_non_null(back);
    assert_memory_equal(back->radiosity, radiosity, sizeof radiosity);
    assert_memory_equal(back->irradiance, irradiance, sizeof irradiance);
    assert_int_equal(back->iterations, 7);
    light_groups_destroy(back);
    assert_null(light_groups_unpack(bytes, size, 3, &err));
    for (size_t cut = 0; cut < size; cut++)
        assert_null(light_groups_unpack(bytes, cut, 2, &err));
    assert_false(error_is_set(&err));
    array_free(bytes);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_are_exact), cmocka_unit_test(layers_add_up),
        cmocka_unit_test(a_layer_is_a_lamp_alone), cmocka_unit_test(layers_in_files),
        cmocka_unit_test(groups_as_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
