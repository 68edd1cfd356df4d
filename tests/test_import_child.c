/* SPDX-License-Identifier: BSD-3-Clause */
/* The importing child: whatever it does, the parent says one line; and what PLY and STL give. */
#include "tests/import_tools.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/wait.h>

#include "scenes/import.h"

#if defined(__SANITIZE_ADDRESS__)
#define WITH_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WITH_ASAN 1
#endif
#endif

/* --- children that go wrong ------------------------------------------------------------------ */

static bool child_segfault(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)out, (void)err;
    raise(SIGSEGV);
    return true;
}

static bool child_abort(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)err;
    pipe_put_warning(out, "light-ignored", "here", "%s", "before the end");
    pipe_flush(out);
    abort();
}

static bool child_hang(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)out, (void)err;
    while (pause() != 0) { }
    return false;
}

static bool child_exit(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)out, (void)err;
    _exit(7);
}

static bool child_silent(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)out, (void)err;
    return true;
}

static bool child_error(const char *path, PipeWriter *out, Error *err)
{
    (void)out;
    return error_at(err, ERROR_INPUT, path, 12, "is all wrong");
}

static bool child_no_memory(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)out;
    return error_set(err, ERROR_MEMORY, "no room");
}

/* Takes more than it may; what it cannot get, it ends for. */
static bool child_greedy(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)out, (void)err;
    for (size_t i = 0; i < 1024; i++) {
        volatile char *room = malloc((size_t)1 << 20);
        if (room == NULL)
            abort();
        room[0] = 1;
    }
    pipe_put_kind(out, RECORD_END);
    pipe_put_u64(out, 0);
    return true;
}

static bool child_noise(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)err;
    uint32_t word = 1;
    for (int i = 0; i < 10000; i++) {
        word = word * 1664525u + 1013904223u;
        pipe_put_u32(out, word);
    }
    return true;
}

/* --- records that are wrong in one thing ----------------------------------------------------- */

typedef struct {
    uint32_t material, vertices, faces, size, corner;
    double   x;
} Part;

static void part_put(PipeWriter *out, Part p)
{
    pipe_put_kind(out, RECORD_PART);
    pipe_put_text(out, "thing");
    pipe_put_u32(out, p.material);
    pipe_put_u32(out, p.vertices);
    pipe_put_u32(out, p.faces);
    pipe_put_u32(out, 0); /* no places in an image */
    pipe_put_u32(out, 0); /* no normals */
    for (uint32_t i = 0; i < p.vertices && i < 3; i++)
        pipe_put_vec3(out, vec3(p.x + i, i * i, 0));
    pipe_put_u32(out, p.size);
    for (uint32_t i = 0; i < 2; i++)
        pipe_put_u32(out, i);
    pipe_put_u32(out, p.corner);
    pipe_put_kind(out, RECORD_END);
    pipe_put_u64(out, 5);
}

#define CHILD(name, ...)                                                                           \
    static bool name(const char *path, PipeWriter *out, Error *err)                                \
    {                                                                                              \
        (void)path, (void)err;                                                                     \
        part_put(out, (Part){ __VA_ARGS__ });                                                      \
        return true;                                                                               \
    }
CHILD(child_good, PIPE_NO_MATERIAL, 3, 1, 3, 2, 0)
CHILD(child_wrong_corner, PIPE_NO_MATERIAL, 3, 1, 3, 3, 0)
CHILD(child_wrong_material, 0, 3, 1, 3, 2, 0)
CHILD(child_wrong_size, PIPE_NO_MATERIAL, 3, 1, 2, 2, 0)
CHILD(child_huge_counts, PIPE_NO_MATERIAL, 4000000000u, 4000000000u, 3, 2, 0)
CHILD(child_nan, PIPE_NO_MATERIAL, 3, 1, 3, 2, NAN)

static bool child_wrong_light(const char *path, PipeWriter *out, Error *err)
{
    const Light light = { .kind = LIGHT_SPOT, .intensity = { -1, 0, 0 } };
    (void)path, (void)err;
    pipe_put_light(out, &light);
    return true;
}

static bool child_wrong_camera(const char *path, PipeWriter *out, Error *err)
{
    const Camera camera = { .vertical_fov = 180 };
    (void)path, (void)err;
    pipe_put_camera(out, &camera);
    return true;
}

static bool child_long_text(const char *path, PipeWriter *out, Error *err)
{
    (void)path, (void)err;
    pipe_put_kind(out, RECORD_WARNING);
    pipe_put_u32(out, UINT32_MAX);
    return true;
}

/* --- the parent ------------------------------------------------------------------------------ */

static int files_open(void)
{
    DIR *folder = opendir("/proc/self/fd");
    int count = 0;
    while (folder != NULL && readdir(folder) != NULL)
        count++;
    closedir(folder);
    return count;
}

static bool always(void *user)
{
    (void)user;
    return true;
}

typedef struct {
    ImportWork  work;
    const char *part;       /* of the message; NULL: all goes well */
    ErrorCode   code;
} Case;

static void case_run(const Case *c, const SceneReadOptions *options)
{
    Polygons soup = { 0 };
    Error err = { 0 };
    ImportTarget target = { .soup = &soup, .path = "scene.ply", .options = options,
                            .map = affine_identity(), .plain = UINT32_MAX };
    const int before = files_open();
    const bool good = import_from_child(&target, c->work, &err);

    assert_int_equal(good, c->part == NULL);
    assert_int_equal(err.code, c->code);
    if (c->part != NULL && strstr(err.text, c->part) == NULL)
        fail_msg("says \"%s\", but should say: %s", err.text, c->part);
    if (c->part == NULL)
        assert_int_equal(soup.polygon_count, 1);
    polygons_clear(&soup);
    assert_int_equal(array_live(), 0);
    assert_int_equal(files_open(), before);
    /* No child is left behind. */
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
}

static void every_end_is_told(void **state)
{
    (void)state;
    static const char *const nonsense =
        "scene.ply: the importer handed back data that make no sense";
    const Case cases[] = {
        { child_good, NULL, ERROR_NONE },
        { child_segfault, "scene.ply: the importer crashed (segmentation fault)", ERROR_INPUT },
        { child_abort, "scene.ply: the importer crashed (abort)", ERROR_INPUT },
        { child_exit, "scene.ply: the importer gave up (exit 7)", ERROR_INPUT },
        { child_silent, "scene.ply: the importer ended before it was done", ERROR_INPUT },
        { child_error, "scene.ply:12: is all wrong", ERROR_INPUT },
        { child_no_memory, "no room", ERROR_MEMORY },
        { child_noise, nonsense, ERROR_INPUT },
        { child_wrong_corner, nonsense, ERROR_INPUT },
        { child_wrong_material, nonsense, ERROR_INPUT },
        { child_wrong_size, nonsense, ERROR_INPUT },
        { child_huge_counts, "scene.ply: ", ERROR_INPUT },
        { child_nan, "scene.ply: object \"thing\" has a vertex that is not finite", ERROR_INPUT },
        { child_wrong_light, nonsense, ERROR_INPUT },
        { child_wrong_camera, nonsense, ERROR_INPUT },
        { child_long_text, nonsense, ERROR_INPUT },
    };
    const SceneReadOptions options = { .import_seconds = 30 };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        case_run(&cases[i], &options);
}

static void limits_end_the_child(void **state)
{
    (void)state;
    const SceneReadOptions soon = { .import_seconds = 0.2 };
    const Case hang = { child_hang, "scene.ply: the importer needed more than 0.2 seconds",
                        ERROR_INPUT };
    case_run(&hang, &soon);
#ifndef WITH_ASAN
    const SceneReadOptions small = { .import_seconds = 30, .import_memory = (uint64_t)64 << 20 };
    const Case greedy = { child_greedy, "scene.ply: the importer crashed (abort)", ERROR_INPUT };
    case_run(&greedy, &small);
#else
    (void)child_greedy;
#endif
}

static void user_may_stop(void **state)
{
    (void)state;
    const Monitor monitor = { .stop = always };
    const SceneReadOptions options = { .monitor = &monitor };
    const Case hang = { child_hang, "stopped", ERROR_STOPPED };
    case_run(&hang, &options);
}

/* --- formats --------------------------------------------------------------------------------- */

static void fuzzed_file_is_an_error(void **state)
{
    (void)state;
    Error err = { 0 };
    static const char *const name = "tests/data/third-party/assimp/"
                                    "crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply";
    assert_null(scene_read(name, NULL, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_non_null(strstr(err.text, name));
    assert_null(strchr(err.text, '\n'));
}

static const char ply[] =
    "ply\r\nformat ascii 1.0\r\ncomment an L and a square\r\nelement vertex 6\r\n"
    "property float x\r\nproperty float y\r\nproperty float z\r\nelement face 2\r\n"
    "property list uchar int vertex_indices\r\nend_header\r\n"
    "0 0 0\r\n2 0 0\r\n2 1 0\r\n1 1 0\r\n1 2 0\r\n0 2 0\r\n6 0 1 2 3 4 5\r\n4 0 1 2 3\r\n";

static void ply_keeps_polygons(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "ell.ply", ply);
    Scene *scene = bench_scene(bench, "ell.ply");
    assert_int_equal(scene->polygons.polygon_count, 2);
    assert_int_equal(bench_corners(scene, 0), 6);
    assert_vec3(bench_normal(scene, 0), 0, 0, 6, 0, "twice the area");
    assert_rgb(bench_material(scene, 0)->reflectance, 0.5, 0.5, 0.5, 0, "no material is grey");
    assert_vec3(scene->up, 0, 1, 0, 0, "up");
    assert_int_equal(bench->warnings, 0);
    scene_destroy(scene);
    char cut[sizeof ply];
    strcpy(cut, ply);
    strcpy(strstr(cut, "4 0 1 2 3"), "4 0 1 2 9\r\n");
    bench_text(bench, "bad.ply", cut);
    bench_refused(bench, "bad.ply", "element \"face\" 2 names vertex 9, but there are 6");
    bench_text(bench, "not.ply", "v 0 0 0\n");
    bench_refused(bench, "not.ply", "not.ply: its content is not what its name says");
}

static void stl_has_z_up_and_solids(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "two.stl",
               "solid floor\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
               "vertex 0 1 0\nendloop\nendfacet\nendsolid floor\n"
               "solid roof\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 2\nvertex 0 1 2\n"
               "vertex 1 0 2\nendloop\nendfacet\nendsolid roof\n");
    Scene *scene = bench_scene(bench, "two.stl");
    assert_int_equal(scene->polygons.polygon_count, 2);
    assert_vec3(scene->up, 0, 0, 1, 0, "up");
    assert_vec3(bench_normal(scene, 0), 0, 0, 1, 0, "floor");
    assert_vec3(bench_normal(scene, 1), 0, 0, -1, 0, "roof");
    assert_string_equal(bench_group(scene, 0), "floor");
    assert_string_equal(bench_group(scene, 1), "roof");
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_end_is_told),
        cmocka_unit_test(limits_end_the_child),
        cmocka_unit_test(user_may_stop),
        cmocka_unit_test(fuzzed_file_is_an_error),
        cmocka_unit_test_setup_teardown(ply_keeps_polygons, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(stl_has_z_up_and_solids, bench_open, bench_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
