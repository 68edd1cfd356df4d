/* SPDX-License-Identifier: BSD-3-Clause */
/* base/: errors, arrays, monitors, parallel loops, files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/error.h"
#include "base/file.h"
#include "base/monitor.h"
#include "base/parallel.h"

/* --- error ----------------------------------------------------------------------------------- */

static void error_first_is_kept(void **state)
{
    (void)state;
    Error err = { 0 };
    assert_false(error_is_set(&err));
    assert_false(error_at(&err, ERROR_INPUT, "room.msd", 12, "unknown word \"%s\"", "SPHERO"));
    assert_false(error_set(&err, ERROR_MEMORY, "later"));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_string_equal(err.text, "room.msd:12: unknown word \"SPHERO\"");
    Error other = { 0 };
    error_at(&other, ERROR_FAILED, "a.exr", 0, "no room");
    assert_string_equal(other.text, "a.exr: no room");
}

static void error_is_one_line_that_fits(void **state)
{
    (void)state;
    Error err = { 0 };
    error_set(&err, ERROR_INPUT, "word \"%s\"", "a\nb\x1b[2J\r\tc\x7f" "d");
    assert_string_equal(err.text, "word \"a b [2J  c d\"");

    char path[2000];
    memset(path, 'x', sizeof path - 1);
    path[sizeof path - 1] = 0;
    Error cut = { 0 };
    error_at(&cut, ERROR_INPUT, path, 3, "%s", path);
    assert_int_equal(strlen(cut.text), sizeof cut.text - 1);
}

/* --- array ----------------------------------------------------------------------------------- */

static void array_counts_and_clears(void **state)
{
    (void)state;
    Error err = { 0 };
    const long before = array_live();
    uint32_t *a = array_create(1000, sizeof *a, "numbers", &err);
    void *none = array_create(0, 8, "nothing", &err);
    char *text = array_string("wall", &err), *empty = array_string(NULL, &err);
    assert_non_null(a);
    assert_non_null(none);
    assert_string_equal(text, "wall");
    assert_string_equal(empty, "");
    for (int i = 0; i < 1000; i++)
        assert_int_equal(a[i], 0);
    assert_int_equal(array_live(), before + 4);
    assert_null(array_free(a));
    array_free(none);
    array_free(text);
    array_free(empty);
    assert_null(array_free(NULL));
    assert_int_equal(array_live(), before);
}

static void array_refuses_what_overflows(void **state)
{
    (void)state;
    const size_t counts[] = { SIZE_MAX, SIZE_MAX / 8 + 2, SIZE_MAX / 2 / 8 + 1 };
    for (int i = 0; i < 3; i++) {
        Error err = { 0 };
        assert_null(array_create(counts[i], 8, "links", &err));
        assert_int_equal(err.code, ERROR_MEMORY);
        assert_non_null(strstr(err.text, "links"));
        Error again = { 0 };
        void *array = NULL;
        size_t capacity = 0;
        assert_false(array_reserve(&array, &capacity, counts[i], 8, "links", &again));
        assert_int_equal(again.code, ERROR_MEMORY);
        assert_null(array);
    }
}

static void array_grows_and_keeps(void **state)
{
    (void)state;
    Error err = { 0 };
    void *array = NULL;
    size_t capacity = 0;
    unsigned moves = 0;
    for (uint32_t i = 0; i < 100000; i++) {
        const size_t old = capacity;
        assert_true(array_reserve(&array, &capacity, i + 1, sizeof i, "numbers", &err));
        assert_true(capacity >= i + 1);
        assert_true(old == 0 || capacity == old || capacity >= 2 * old);
        moves += capacity != old;
        ((uint32_t *)array)[i] = i;
    }
    assert_true(moves < 20);
    for (uint32_t i = 0; i < 100000; i++)
        assert_int_equal(((uint32_t *)array)[i], i);
    array_free(array);
}

static void array_fails_on_demand(void **state)
{
    (void)state;
    const long before = array_live();
    Error err = { 0 };
    array_fail_after(1);
    void *first = array_create(1, 1, "first", &err);
    assert_non_null(first);
    assert_null(array_create(1, 1, "second", &err));
    assert_int_equal(err.code, ERROR_MEMORY);
    assert_null(array_string("third", &err));
    array_fail_after(-1);
    assert_null(array_create(1, 1, "an earlier stage failed", &err));
    assert_non_null(strstr(err.text, "second"));
    array_free(first);
    assert_int_equal(array_live(), before);
}

/* --- monitor --------------------------------------------------------------------------------- */

typedef struct {
    char     text[64];
    double   done[4096];
    uint64_t rays;
    unsigned reports;
    atomic_uint asked;
    unsigned    stop_after;
} Watch;

static void watch_warn(void *user, const char *code, const char *where, const char *text)
{
    Watch *watch = user;
    snprintf(watch->text, sizeof watch->text, "%s|%s|%s", code, where, text);
}

static void watch_progress(void *user, const Progress *progress)
{
    Watch *watch = user;
    if (watch->reports < 4096)
        watch->done[watch->reports++] = progress->done;
    watch->rays = progress->rays;
}

static bool watch_stop(void *user)
{
    Watch *watch = user;
    return atomic_fetch_add(&watch->asked, 1) >= watch->stop_after;
}

static void monitor_calls_or_is_silent(void **state)
{
    (void)state;
    static Watch watch;
    const Monitor silent = { 0 };
    const Progress progress = { .stage = "solve", .done = 0.5 };
    const Monitor *quiet[] = { NULL, &silent };
    for (int i = 0; i < 2; i++) {
        monitor_warn(quiet[i], "no-emitter", "", "nothing shines");
        monitor_progress(quiet[i], &progress);
        assert_false(monitor_stop(quiet[i]));
    }
    const Monitor monitor = { .user = &watch, .warn = watch_warn };
    monitor_warn(&monitor, "no-emitter", "room", "%d of %s", 0, "3");
    assert_string_equal(watch.text, "no-emitter|room|0 of 3");
}

/* --- parallel -------------------------------------------------------------------------------- */

typedef struct {
    atomic_uint  seen[10007];
    unsigned     threads;
    uint32_t     chunk;
    atomic_bool  wrong;
} Visits;

static void visit(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Visits *visits = context;
    if (worker >= visits->threads || begin % visits->chunk != 0 || end - begin > visits->chunk ||
        begin >= end)
        atomic_store(&visits->wrong, true);
    for (uint32_t i = begin; i < end; i++)
        atomic_fetch_add(&visits->seen[i], 1);
}

static void parallel_visits_each_once(void **state)
{
    (void)state;
    const uint32_t counts[] = { 0, 1, 63, 64, 65, 10007 };
    const unsigned threads[] = { 1, 2, 7, 0 };
    const uint32_t chunks[] = { 1, 64, 20000 };
    static Visits visits;
    for (int c = 0; c < 6; c++)
        for (int t = 0; t < 4; t++)
            for (int k = 0; k < 3; k++) {
                memset(&visits, 0, sizeof visits);
                visits.threads = parallel_threads(threads[t]);
                visits.chunk = chunks[k];
                assert_true(parallel_for(counts[c], chunks[k], threads[t], visit, &visits, NULL,
                                         NULL));
                assert_false(visits.wrong);
                for (uint32_t i = 0; i < 10007; i++)
                    assert_int_equal(visits.seen[i], i < counts[c] ? 1 : 0);
            }
}

static void parallel_threads_are_counted(void **state)
{
    (void)state;
    assert_true(parallel_threads(0) >= 1);
    assert_int_equal(parallel_threads(5), 5);
    assert_int_equal(parallel_threads(UINT32_MAX), 1024);
}

static void add_length(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    atomic_ullong *sum = context;
    (void)worker;
    atomic_fetch_add(sum, end - begin);
}

static void parallel_handles_the_largest_range(void **state)
{
    (void)state;
    atomic_ullong sum = 0;
    assert_true(parallel_for(UINT32_MAX, UINT32_MAX / 2 + 7, 3, add_length, &sum, NULL, NULL));
    assert_true(sum == UINT32_MAX);
    sum = 0;
    assert_true(parallel_for(UINT32_MAX, 1u << 20, 2, add_length, &sum, NULL, NULL));
    assert_true(sum == UINT32_MAX);
}

static void parallel_stops_when_told(void **state)
{
    (void)state;
    static Visits visits;
    for (unsigned threads = 1; threads <= 4; threads++) {
        static Watch watch;
        memset(&visits, 0, sizeof visits);
        memset(&watch, 0, sizeof watch);
        watch.stop_after = 10;
        visits.threads = threads;
        visits.chunk = 10;
        const Monitor monitor = { .user = &watch, .stop = watch_stop };
        assert_false(parallel_for(10007, 10, threads, visit, &visits, &monitor, NULL));
        uint32_t done = 0;
        for (uint32_t i = 0; i < 10007; i++) {
            done += visits.seen[i];
            assert_int_equal(visits.seen[i], visits.seen[i / 10 * 10]); /* chunks are whole */
        }
        assert_int_equal(done, 100);
    }
}

static void parallel_reports_upwards(void **state)
{
    (void)state;
    static Watch watch;
    static Visits visits;
    const Monitor monitor = { .user = &watch, .progress = watch_progress };
    const Progress base = { .stage = "factors", .done = 0.5, .rays = 12345 };
    visits.threads = 2;
    visits.chunk = 64;
    assert_true(parallel_for(10007, 64, 2, visit, &visits, &monitor, &base));
    assert_true(watch.reports >= 1);
    for (unsigned i = 1; i < watch.reports; i++)
        assert_true(watch.done[i] >= watch.done[i - 1]);
    assert_true(watch.done[watch.reports - 1] == 0.5);
    assert_int_equal(watch.rays, 12345);
}

/* --- files ----------------------------------------------------------------------------------- */

typedef struct {
    char folder[64];
    char path[128];
} Place;

static int place_create(void **state)
{
    Place *place = calloc(1, sizeof *place);
    if (place == NULL)
        return -1;
    strcpy(place->folder, P_tmpdir "/isolux-test-XXXXXX");
    *state = place;
    if (mkdtemp(place->folder) == NULL)
        return -1;
    snprintf(place->path, sizeof place->path, "%s/result.bin", place->folder);
    return 0;
}

static int place_entries(const Place *place)
{
    DIR *folder = opendir(place->folder);
    int count = 0;
    if (folder == NULL)
        return -1;
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder))
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(folder);
    return count;
}

static int place_destroy(void **state)
{
    Place *place = *state;
    char path[400];
    DIR *folder = opendir(place->folder);
    if (folder != NULL) {
        for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
            snprintf(path, sizeof path, "%s/%s", place->folder, entry->d_name);
            unlink(path);
        }
        closedir(folder);
    }
    rmdir(place->folder);
    free(place);
    return 0;
}

static void write_text(const char *path, const char *text)
{
    Error err = { 0 };
    OutFile *out = outfile_open(path, &err);
    assert_non_null(out);
    fputs(text, outfile_stream(out));
    assert_true(outfile_commit(out, &err));
}

static void expect_text(const char *path, const char *text)
{
    Error err = { 0 };
    size_t size = 0;
    char *bytes = file_read(path, 1 << 20, &size, &err);
    assert_non_null(bytes);
    assert_int_equal(size, strlen(text));
    assert_string_equal(bytes, text);
    array_free(bytes);
}

static void file_comes_back_whole(void **state)
{
    const Place *place = *state;
    Error err = { 0 };
    OutFile *out = outfile_open(place->path, &err);
    assert_non_null(out);
    for (int i = 0; i < 300000; i++)
        fputc(i * 7 & 255, outfile_stream(out));
    assert_int_not_equal(access(place->path, F_OK), 0); /* not there before it is whole */
    assert_true(outfile_commit(out, &err));
    assert_int_equal(place_entries(place), 1);

    size_t size = 0;
    unsigned char *bytes = (unsigned char *)file_read(place->path, 300000, &size, &err);
    assert_non_null(bytes);
    assert_int_equal(size, 300000);
    for (int i = 0; i < 300000; i++)
        assert_int_equal(bytes[i], i * 7 & 255);
    assert_int_equal(bytes[300000], 0);
    array_free(bytes);
    assert_null(file_read(place->path, 299999, &size, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_non_null(strstr(err.text, "larger than the limit of 299999 bytes"));
}

static void file_refuses_what_is_no_file(void **state)
{
    const Place *place = *state;
    char fifo[160], missing[160];
    snprintf(fifo, sizeof fifo, "%s/pipe", place->folder);
    snprintf(missing, sizeof missing, "%s/missing", place->folder);
    assert_int_equal(mkfifo(fifo, 0600), 0);
    const char *paths[] = { missing, place->folder, "/dev/zero", fifo, "" };
    for (int i = 0; i < 5; i++) {
        Error err = { 0 };
        size_t size;
        assert_null(file_read(paths[i], SIZE_MAX, &size, &err));
        assert_int_equal(err.code, ERROR_INPUT);
        assert_memory_equal(err.text, paths[i], strlen(paths[i]));
    }
}

static void outfile_is_all_or_nothing(void **state)
{
    const Place *place = *state;
    Error err = { 0 };
    write_text(place->path, "old");
    assert_int_equal(chmod(place->path, 0640), 0);

    OutFile *out = outfile_open(place->path, &err);
    assert_non_null(out);
    fputs("half", outfile_stream(out));
    expect_text(place->path, "old");
    outfile_discard(out);
    outfile_discard(NULL);
    expect_text(place->path, "old");
    assert_int_equal(place_entries(place), 1);

    write_text(place->path, "new");
    expect_text(place->path, "new");
    struct stat info;
    assert_int_equal(stat(place->path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);

    out = outfile_open(place->path, &err);
    assert_non_null(out);
    error_set(&err, ERROR_STOPPED, "stopped");
    assert_false(outfile_commit(out, &err)); /* an error of the caller: nothing is replaced */
    expect_text(place->path, "new");
    assert_int_equal(place_entries(place), 1);
}

static void outfile_lets_libraries_write(void **state)
{
    const Place *place = *state;
    Error err = { 0 };
    OutFile *out = outfile_open(place->path, &err);
    assert_non_null(out);
    assert_int_equal(unlink(outfile_path(out)), 0); /* some replace the file by their own */
    FILE *theirs = fopen(outfile_path(out), "wb");
    assert_non_null(theirs);
    fputs("theirs", theirs);
    fclose(theirs);
    assert_true(outfile_commit(out, &err));
    expect_text(place->path, "theirs");
}

static void outfile_tells_failures(void **state)
{
    const Place *place = *state;
    char nowhere[160];
    snprintf(nowhere, sizeof nowhere, "%s/no/such", place->folder);
    const char *paths[] = { nowhere, place->folder, "" };
    for (int i = 0; i < 3; i++) {
        Error err = { 0 };
        assert_null(outfile_open(paths[i], &err));
        assert_int_equal(err.code, ERROR_FAILED);
        assert_non_null(strstr(err.text, "cannot be written"));
    }
    Error err = { 0 };
    OutFile *out = outfile_open("/dev/full", &err); /* every write: no space left */
    assert_non_null(out);
    fputs("text", outfile_stream(out));
    assert_false(outfile_commit(out, &err));
    assert_int_equal(err.code, ERROR_FAILED);
    assert_non_null(strstr(err.text, "No space left"));
    struct stat info;
    assert_int_equal(stat("/dev/full", &info), 0);
    assert_true(S_ISCHR(info.st_mode)); /* still the device */
}

static void outfile_follows_links(void **state)
{
    const Place *place = *state;
    char link_path[160];
    snprintf(link_path, sizeof link_path, "%s/link", place->folder);
    write_text(place->path, "old");
    assert_int_equal(symlink("result.bin", link_path), 0);
    write_text(link_path, "new");
    expect_text(place->path, "new");
    struct stat info;
    assert_int_equal(lstat(link_path, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
}

static void file_beside_joins(void **state)
{
    (void)state;
    static const struct { const char *path, *name, *joined; } table[] = {
        { "rooms/a.msd", "b.msd", "rooms/b.msd" }, { "a.msd", "b.msd", "b.msd" },
        { "/a.msd", "b.msd", "/b.msd" },           { "rooms/a.msd", "/x/b.msd", "/x/b.msd" },
        { "rooms/", "b", "rooms/b" },
    };
    char buffer[64];
    for (int i = 0; i < 5; i++) {
        assert_true(file_beside(table[i].path, table[i].name, buffer, sizeof buffer));
        assert_string_equal(buffer, table[i].joined);
    }
    assert_true(file_beside("ab/c", "d", buffer, 5));
    assert_false(file_beside("ab/c", "d", buffer, 4));
}

static void file_hash_is_xxh3(void **state)
{
    (void)state;
    /* The published value of the empty input, seed 0. */
    assert_true(file_hash(NULL, 0, 0) == 0x2d06800538d394c2u);
    const uint64_t chained = file_hash("b", 1, file_hash("a", 1, 0));
    assert_true(chained != file_hash("a", 1, file_hash("b", 1, 0)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(error_first_is_kept),
        cmocka_unit_test(error_is_one_line_that_fits),
        cmocka_unit_test(array_counts_and_clears),
        cmocka_unit_test(array_refuses_what_overflows),
        cmocka_unit_test(array_grows_and_keeps),
        cmocka_unit_test(array_fails_on_demand),
        cmocka_unit_test(monitor_calls_or_is_silent),
        cmocka_unit_test(parallel_visits_each_once),
        cmocka_unit_test(parallel_threads_are_counted),
        cmocka_unit_test(parallel_handles_the_largest_range),
        cmocka_unit_test(parallel_stops_when_told),
        cmocka_unit_test(parallel_reports_upwards),
        cmocka_unit_test_setup_teardown(file_comes_back_whole, place_create, place_destroy),
        cmocka_unit_test_setup_teardown(file_refuses_what_is_no_file, place_create, place_destroy),
        cmocka_unit_test_setup_teardown(outfile_is_all_or_nothing, place_create, place_destroy),
        cmocka_unit_test_setup_teardown(outfile_lets_libraries_write, place_create, place_destroy),
        cmocka_unit_test_setup_teardown(outfile_tells_failures, place_create, place_destroy),
        cmocka_unit_test_setup_teardown(outfile_follows_links, place_create, place_destroy),
        cmocka_unit_test(file_beside_joins),
        cmocka_unit_test(file_hash_is_xxh3),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
