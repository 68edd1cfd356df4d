/* SPDX-License-Identifier: BSD-3-Clause */
/* A run over links between clusters that is broken off, kept as bytes and taken up again. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/clusters_internal.h"
#include "tests/room_maker.h"

typedef struct {
    TestRoom     room;
    OpenPlaces   places;
    double      *emission, *reflectance, *seen;
    SolveProblem problem;
} Lighting;

/* A lit box that is open below; the camera, where there is one, sees one wall. */
static void scene_make(Lighting *s)
{
    const Vec3 eye = { 0.5, 1, 0.75 };
    Error err = { 0 };
    *s = (Lighting){ .seen = NULL };
    room_box(&s->room, vec3(0, 0, 0), vec3(1, 2, 1.5), BOX_ALL & ~(BOX_Z0 | BOX_Z1), true,
             room_material(&s->room, 0.7, 0), "");
    room_box(&s->room, vec3(0, 0, 0), vec3(1, 2, 1.5), BOX_Z1, true,
             room_material(&s->room, 0.7, 1), "");
    room_finish(&s->room, 0.2, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    assert_true(open_places_find(&s->room.room, 1, 2, &s->places, NULL, &err));
    room_problem(&s->room, &s->emission, &s->reflectance);
    s->problem = (SolveProblem){ ROOM_BANDS, s->emission, s->reflectance, NULL };
    s->seen = array_create(s->room.patches->count, sizeof *s->seen, "test", &err);
    for (uint32_t i = 0; i < s->room.patches->count; i++)
        s->seen[i] = s->room.patches->normal[i].x > 0.5 ? 0.01 : 0;
}

static void scene_clear(Lighting *s)
{
    array_free(s->emission);
    array_free(s->reflectance);
    array_free(s->seen);
    open_places_clear(&s->places);
    room_clear(&s->room);
}

/* Stops after that many reports of progress. */
typedef struct {
    int left;
} Break;

static void count_down(void *user, const Progress *progress)
{
    Break *at = user;
    (void)progress;
    at->left--;
}

static bool must_stop(void *user)
{
    return ((const Break *)user)->left <= 0;
}

static Solution *run(const Lighting *s, const ClustersOptions *options, ClustersReport *report,
                     const Monitor *monitor)
{
    Error err = { 0 };
    Solution *solution = clusters_solve(&s->room.room, &s->places, &s->problem, options, report,
                                        monitor, &err);
    assert_non_null(solution);
    return solution;
}

/* What a run that stops after so many reports has kept, in another one's hands; NULL: nothing. */
static ClustersKept *broken(const Lighting *s, ClustersOptions o, int reports)
{
    Error err = { 0 };
    size_t size;
    ClustersReport report;
    Break at = { .left = reports };
    const Monitor monitor = { .user = &at, .progress = count_down, .stop = must_stop };
    ClustersKept *on = clusters_kept_create(&err);
    o.kept = clusters_kept_create(&err);
    assert_null(clusters_kept_bytes(o.kept, &size));
    solution_destroy(run(s, &o, &report, &monitor));
    const void *saved = clusters_kept_bytes(o.kept, &size);
    if (saved != NULL) {
        void *copy = array_create(size, 1, "test", &err);
        memcpy(copy, saved, size);
        assert_true(clusters_kept_load(on, copy, size, s->room.patches->count));
    }
    clusters_kept_destroy(o.kept);
    return saved != NULL ? on : clusters_kept_destroy(on);
}

/* The same bytes and figures as an unbroken run, wherever it is broken off. */
static void check_kept(const Lighting *s, const ClustersOptions *options)
{
    enum { BREAKS = 8 };
    ClustersReport report, whole_report;
    Solution *whole = run(s, options, &whole_report, NULL);
    const size_t bytes = sizeof(double) * ROOM_BANDS * whole->count;
    int resumed = 0;
    for (int k = 1; k <= BREAKS; k++) {
        ClustersOptions o = *options;
        o.kept = broken(s, o, k);
        if (o.kept == NULL)
            continue;
        o.threads = 1;
        Solution *rest = run(s, &o, &report, NULL);
        assert_memory_equal(rest->irradiance, whole->irradiance, bytes);
        assert_memory_equal(rest->radiosity, whole->radiosity, bytes);
        assert_int_equal(report.rays, whole_report.rays);
        assert_int_equal(report.gather_rays, whole_report.gather_rays);
        assert_int_equal(report.rounds, whole_report.rounds);
        assert_memory_equal(&report.error, &whole_report.error, sizeof report.error);
        assert_int_equal(rest->iterations, whole->iterations);
        resumed++;
        solution_destroy(rest);
        clusters_kept_destroy(o.kept);
    }
    assert_true(resumed > BREAKS / 2);
    solution_destroy(whole);
}

static void test_kept(void **state)
{
    (void)state;
    Lighting s;
    scene_make(&s);
    const ClustersOptions plain = { .rays = 512, .gather = 64, .sights = 16, .threads = 2,
                                    .tolerance = 0.01, .seed = 3 };
    ClustersOptions guided = plain;
    guided.seen = s.seen;
    check_kept(&s, &plain);
    check_kept(&s, &guided);
    scene_clear(&s);
    assert_int_equal(array_live(), 0);
}

/* Bytes that are none of such a run are refused. */
static void test_damaged(void **state)
{
    (void)state;
    Lighting s;
    Error err = { 0 };
    size_t size;
    scene_make(&s);
    const uint32_t patches = s.room.patches->count;
    const ClustersOptions o = { .rays = 64, .gather = 16, .tolerance = 0.01 };
    ClustersKept *good = broken(&s, o, 3);
    assert_non_null(good);
    const unsigned char *from = clusters_kept_bytes(good, &size);
    ClustersHead head;
    memcpy(&head, from, sizeof head);
    for (int k = 0; k < 7; k++) {
        unsigned char *copy = array_create(size, 1, "test", &err);
        ClustersHead other = head;
        const ClusterLink link = { .to = k == 4 ? head.nodes : 0, .from = k == 5 ? UINT32_MAX : 0,
                                   .factor = k == 6 ? 2 : 0 };
        const double bad = k == 3 ? NAN : 0;
        other.patches = k == 1 ? patches + 1 : patches;
        other.links = k == 2 ? UINT64_MAX / 2 : head.links;
        memcpy(copy, from, size);
        memcpy(copy, &other, sizeof other);
        memcpy(copy + sizeof other, &bad, sizeof bad);
        memcpy(copy + sizeof other + (size_t)patches * ROOM_BANDS * sizeof bad, &link,
               sizeof link);
        ClustersKept *kept = clusters_kept_create(&err);
        assert_true(clusters_kept_load(kept, copy, size, patches) == (k == 0));
        clusters_kept_destroy(kept);
    }
    for (size_t cut = 0; cut < size; cut += 1 + size / 50) {
        unsigned char *copy = array_create(cut, 1, "test", &err);
        memcpy(copy, from, cut);
        ClustersKept *kept = clusters_kept_create(&err);
        assert_false(clusters_kept_load(kept, copy, cut, patches));
        clusters_kept_destroy(kept);
    }
    clusters_kept_destroy(good);
    scene_clear(&s);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kept),
        cmocka_unit_test(test_damaged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
