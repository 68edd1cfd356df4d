/* SPDX-License-Identifier: BSD-3-Clause */
/* Checkpoints: a cast that was broken off ends in the same bits; damage is found. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "radiosity/checkpoint.h"
#include "tests/room_maker.h"

static char folder[] = "/tmp/isolux-checkpoint-XXXXXX";
static char path[64];

static int open_folder(void **state)
{
    (void)state;
    if (mkdtemp(folder) == NULL)
        return 1;
    snprintf(path, sizeof path, "%s/run.checkpoint", folder);
    return 0;
}

static int close_folder(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder);
}

/* The unit cube, grey, with a box and a lamp in it. */
static void furnished(TestRoom *r, double size)
{
    const uint32_t wall = room_material(r, 0.5, 0);
    room_box(r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, wall, "");
    room_box(r, vec3(0.3, 0.4, 0), vec3(0.6, 0.6, 0.4), BOX_ALL, false, wall, "box-");
    room_quad(r, vec3(0.4, 0.4, 0.95), vec3(0, 0.2, 0), vec3(0.2, 0, 0),
              room_material(r, 0, 20), "lamp");
    room_finish(r, size, &(SidesOptions){ 0 }, NULL, 0, NULL);
}

/* Saves from within a cast, and stops it, once that often has been asked to stop. */
typedef struct {
    Checkpoint checkpoint;
    int        left, saves;
} Watch;

static bool stop_after(void *user)
{
    Watch *w = user;
    return w->left-- <= 0;
}

static void save_then(void *user, const Progress *progress)
{
    Watch *w = user;
    Error err = { 0 };
    (void)progress;
    assert_true(checkpoint_save(&w->checkpoint, path, &err));
    w->saves++;
}

static void same_links(const Links *a, const Links *b)
{
    assert_int_equal(a->count, b->count);
    const size_t n = a->count, links = a->first[n];
    assert_memory_equal(a->first, b->first, (n + 1) * sizeof *a->first);
    assert_memory_equal(a->source, b->source, links * sizeof *a->source);
    assert_memory_equal(a->form_factor, b->form_factor, links * sizeof *a->form_factor);
    assert_memory_equal(a->escape, b->escape, n * sizeof *a->escape);
    assert_memory_equal(a->area, b->area, n * sizeof *a->area);
    assert_memory_equal(a->lamp, b->lamp, n);
    assert_int_equal(a->rays, b->rays);
    assert_int_equal(a->clamped, b->clamped);
}

/* Goes on from one checkpoint to the next, a few chunks more each time: finished ones count too.
 * *rounds of them. */
static Links *cast_in_pieces(const Room *room, const Links *old, const uint32_t *parent,
                             int *rounds)
{
    Links *links = NULL;
    KeptRows *rows = NULL;
    for (*rounds = 0; links == NULL; ++*rounds) {
        assert_true(*rounds < 100);
        Error err = { 0 };
        if (rows == NULL)
            rows = kept_rows_create(&err);
        Watch w = { .left = 5 + 5 * *rounds, .checkpoint = { .key = 7, .rows = rows } };
        const Monitor monitor = { .user = &w, .stop = stop_after, .progress = save_then };
        const LinksOptions o = { .rays = 64, .threads = 2, .kept = rows };
        links = old == NULL ? links_create(room, &o, &monitor, &err)
                            : links_refine(old, room, parent, &o, &monitor, &err);
        rows = kept_rows_destroy(rows);
        if (links != NULL)
            break;
        assert_int_equal(err.code, ERROR_STOPPED);
        err = (Error){ 0 };
        Checkpoint read;
        assert_true(checkpoint_load(&read, path, &err));
        assert_int_equal(read.key, 7);
        assert_int_equal(kept_rows_count(read.rows), room->patches->count);
        rows = read.rows;
        read.rows = NULL;
        checkpoint_clear(&read);
    }
    return links;
}

static void test_broken_cast(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error err = { 0 };
    int rounds = 0;
    furnished(&r, 0.05);
    Links *whole = links_create(&r.room, &(LinksOptions){ .rays = 64 }, NULL, &err);
    Links *pieces = cast_in_pieces(&r.room, NULL, NULL, &rounds);
    assert_true(rounds > 2);
    same_links(whole, pieces);
    links_destroy(pieces);
    /* The same when some patches were divided. */
    uint8_t *split = array_create(r.patches->count, 1, "marks", &err);
    uint32_t *parent = NULL;
    for (uint32_t i = 0; i < r.patches->count; i += 3)
        split[i] = 1;
    Patches *finer = patches_split(r.patches, r.surfaces, split, &parent, &err);
    Room room = r.room;
    room.patches = finer;
    Links *refined = links_refine(whole, &room, parent, &(LinksOptions){ .rays = 64 }, NULL, &err);
    assert_non_null(refined);
    /* Stops come in the second step as well, which is not kept: it is short. Enough tries end. */
    KeptRows *rows = kept_rows_create(&err);
    Watch w = { .left = 9, .checkpoint = { .rows = rows } };
    const Monitor monitor = { .user = &w, .stop = stop_after, .progress = save_then };
    LinksOptions o = { .rays = 64, .threads = 2, .kept = rows };
    assert_null(links_refine(whole, &room, parent, &o, &monitor, &err));
    err = (Error){ 0 };
    Checkpoint read;
    assert_true(checkpoint_load(&read, path, &err));
    o.kept = read.rows;
    Links *again = links_refine(whole, &room, parent, &o, NULL, &err);
    assert_non_null(again);
    same_links(refined, again);
    links_destroy(again);
    checkpoint_clear(&read);
    kept_rows_destroy(rows);
    links_destroy(refined);
    links_destroy(whole);
    patches_destroy(finer);
    array_free(parent);
    array_free(split);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* Everything a checkpoint can hold, and back. */
static void fill(Checkpoint *c, Links *links, Solution *solution, uint8_t *split, char *part)
{
    *c = (Checkpoint){ .key = 99, .passes = 2, .count = { 3, 5 }, .split = { split, split },
                       .links = links, .solution = solution, .part = { part, part + 2 },
                       .size = { 2, 5 } };
}

static void test_pieces(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error err = { 0 };
    furnished(&r, 0.5);
    Links *links = links_create(&r.room, &(LinksOptions){ .rays = 16 }, NULL, &err);
    const size_t n = links->count;
    double *e = array_create(n, sizeof *e, "test", &err), *rho = array_create(n, 8, "test", &err);
    e[0] = 1;
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    Solution *solution = solve(links, &p, &(SolveOptions){ 0 }, NULL, &err);
    uint8_t split[5] = { 0, 1, 0, 1, 1 };
    char part[] = "abcdefg";
    Checkpoint c, back;
    fill(&c, links, solution, split, part);
    assert_true(checkpoint_save(&c, path, &err));
    assert_true(checkpoint_load(&back, path, &err));
    assert_int_equal(back.key, 99);
    assert_int_equal(back.passes, 2);
    assert_int_equal(back.count[1], 5);
    assert_memory_equal(back.split[1], split, 5);
    same_links(links, back.links);
    assert_null(back.rows);
    assert_memory_equal(solution->radiosity, back.solution->radiosity, n * sizeof(double));
    assert_memory_equal(solution->irradiance, back.solution->irradiance, n * sizeof(double));
    assert_true(back.solution->residual == solution->residual && back.solution->converged);
    assert_int_equal(back.size[1], 5);
    assert_memory_equal(back.part[1], "cdefg", 5);
    checkpoint_clear(&back);
    links_destroy(links);
    solution_destroy(solution);
    array_free(e);
    array_free(rho);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

static void write_file(const unsigned char *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* Each byte changed in turn, and each length: one line each time, nothing left behind. */
static void test_damage(void **state)
{
    (void)state;
    uint64_t first[] = { 0, 1, 2 };
    uint32_t source[] = { 1, 0 };
    float factor[] = { 0.5f, 0.5f }, escape[] = { 0.5f, 0.5f };
    double area[] = { 1, 1 }, values[] = { 1, 2 };
    uint8_t split[5] = { 0, 1, 0, 1, 1 }, lamp[] = { 0, 1 };
    char part[] = "abcdefg";
    Links links = { .count = 2, .first = first, .source = source, .form_factor = factor,
                    .escape = escape, .area = area, .lamp = lamp };
    Solution solution = { .count = 2, .bands = 1, .radiosity = values, .irradiance = values };
    Checkpoint c;
    Error err = { 0 };
    unsigned char bytes[2000];
    fill(&c, &links, &solution, split, part);
    assert_true(checkpoint_save(&c, path, &err));
    FILE *file = fopen(path, "rb");
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_in_range(size, 100, sizeof bytes - 1);
    for (size_t k = 0; k < 2 * size; k++) {
        if (k >= size)
            bytes[k - size] ^= 0x20;
        write_file(bytes, k < size ? k : size);
        if (k >= size)
            bytes[k - size] ^= 0x20;
        err = (Error){ 0 };
        assert_false(checkpoint_load(&c, path, &err));
        assert_int_equal(err.code, ERROR_INPUT);
        assert_null(strchr(err.text, '\n'));
        checkpoint_clear(&c);
        assert_int_equal(array_live(), 0);
    }
    unlink(path);
    err = (Error){ 0 };
    assert_false(checkpoint_load(&c, path, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    err = (Error){ 0 };
    assert_false(checkpoint_load(&c, folder, &err));
    assert_int_equal(err.code, ERROR_INPUT);
}

/* Where nothing can be written, what was there stays. */
static void test_old_one_stays(void **state)
{
    (void)state;
    Checkpoint c = { .key = 5 }, back;
    Error err = { 0 };
    assert_true(checkpoint_save(&c, path, &err));
    c.key = 6;
    assert_false(checkpoint_save(&c, "/dev/full", &err));
    assert_int_equal(err.code, ERROR_FAILED);
    err = (Error){ 0 };
    assert_true(checkpoint_load(&back, path, &err));
    assert_int_equal(back.key, 5);
    checkpoint_clear(&back);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_broken_cast),
        cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_old_one_stays),
    };
    return cmocka_run_group_tests(tests, open_folder, close_folder);
}
