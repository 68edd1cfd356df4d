/* SPDX-License-Identifier: BSD-3-Clause */
/* glTF and GLB: materials, lights, cameras and nodes against values worked out by hand. */
#include "tests/import_tools.h"

#include <math.h>

#include "scenes/gltf.h"

/* One triangle (0,0,0) (1,0,0) (0,1,0), or a quad of four corners by index. */
static const float corners[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } };
static const uint16_t indices[6] = { 0, 1, 2, 2, 1, 3 };

static const char buffers[] =
    "\"buffers\":[{\"uri\":\"mesh%20data.bin\",\"byteLength\":60}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},"
    "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
    "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"
    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
    "\"asset\":{\"version\":\"2.0\"}";

static void mesh_data(const Bench *bench, const char *name)
{
    char bytes[60];
    memcpy(bytes, corners, 48);
    memcpy(bytes + 48, indices, 12);
    bench_bytes(bench, name, bytes, sizeof bytes);
}

/* Writes t.gltf with the usual buffers and `rest`. */
static void gltf_write(const Bench *bench, const char *rest)
{
    char text[6000];
    const int length = snprintf(text, sizeof text, "{%s,%s}", buffers, rest);
    assert_true(length > 0 && (size_t)length < sizeof text);
    mesh_data(bench, "mesh data.bin");
    bench_text(bench, "t.gltf", text);
}

static Scene *gltf_scene(Bench *bench, const char *rest)
{
    gltf_write(bench, rest);
    return bench_scene(bench, "t.gltf");
}

static void gltf_refused(Bench *bench, const char *rest, const char *part)
{
    gltf_write(bench, rest);
    bench_refused(bench, "t.gltf", part);
}

#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]"
#define NODE "\"nodes\":[{\"mesh\":0}]"

/* --- geometry -------------------------------------------------------------------------------- */

static void triangles_come_in_all_modes(void **state)
{
    Bench *bench = *state;
    static const struct { const char *primitive; size_t faces; } cases[] = {
        { "\"attributes\":{\"POSITION\":0},\"indices\":1", 2 },
        { "\"attributes\":{\"POSITION\":2}", 1 },
        { "\"attributes\":{\"POSITION\":0},\"mode\":5", 2 },
        { "\"attributes\":{\"POSITION\":0},\"mode\":6", 2 },
    };
    char text[400];

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, NODE ",\"meshes\":[{\"primitives\":[{%s}]}]",
                 cases[i].primitive);
        Scene *scene = gltf_scene(bench, text);
        assert_int_equal(scene->polygons.polygon_count, cases[i].faces);
        assert_vec3(bench_normal(scene, 0), 0, 0, 1, 0, cases[i].primitive);
        assert_rgb(bench_material(scene, 0)->reflectance, 0.5, 0.5, 0.5, 0, "grey");
        assert_string_equal(bench_group(scene, 0), "nodes[0]");
        assert_int_equal(scene->light_count + scene->camera_count, 0);
        scene_destroy(scene);
    }
    gltf_refused(bench, NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                 "\"mode\":1}]}]", "has no faces, only points or lines");
}

/* Parent: turned by 90 degrees about z and moved by (10,0,0); child: twice the size, moved by
 * (0,1,0). (1,0,0) -> (2,1,0) -> turned (-1,2,0) -> (9,2,0). */
static void nodes_place_their_meshes(void **state)
{
    Bench *bench = *state;
    Scene *scene = gltf_scene(bench, MESH ",\"nodes\":["
        "{\"rotation\":[0,0,0.70710678118654752,0.70710678118654752],\"translation\":[10,0,0],"
        "\"children\":[1]},{\"name\":\"child\",\"mesh\":0,\"scale\":[2,2,2],"
        "\"translation\":[0,1,0]},{\"name\":\"not shown\",\"mesh\":0}],"
        "\"scenes\":[{\"nodes\":[2]},{\"nodes\":[0]}],\"scene\":1");
    const double e = 1e-14;
    assert_int_equal(scene->polygons.polygon_count, 2);
    assert_vec3(bench_corner(scene, 0, 0), 9, 0, 0, e, "origin");
    assert_vec3(bench_corner(scene, 0, 1), 9, 2, 0, e, "x");
    assert_vec3(bench_corner(scene, 0, 2), 7, 0, 0, e, "y");
    assert_string_equal(bench_group(scene, 0), "child");
    scene_destroy(scene);
}

/* A mirroring map turns the winding round, the front must stay where the map takes it: the normal
 * (0,0,1) of a face mirrored in x is still (0,0,1); mirrored in z it is (0,0,-1). */
static void mirrored_nodes_keep_their_fronts(void **state)
{
    Bench *bench = *state;
    static const struct { const char *scale; double z; } cases[] = {
        { "[-1,1,1]", 1 }, { "[1,1,-1]", -1 }, { "[-1,-1,1]", 1 }, { "[-1,-1,-1]", -1 } };
    char text[300];

    for (size_t i = 0; i < 4; i++) {
        snprintf(text, sizeof text, MESH ",\"nodes\":[{\"mesh\":0,\"scale\":%s}]",
                 cases[i].scale);
        Scene *scene = gltf_scene(bench, text);
        assert_vec3(bench_normal(scene, 0), 0, 0, cases[i].z, 0, cases[i].scale);
        scene_destroy(scene);
    }
    Scene *scene = gltf_scene(bench, MESH ",\"nodes\":[{\"mesh\":0,\"matrix\":"
                              "[0,0,-3,0, 0,3,0,0, 3,0,0,0, 1,2,3,1]}]");
    assert_vec3(bench_corner(scene, 0, 1), 1, 2, 0, 0, "columns of a matrix");
    assert_vec3(bench_normal(scene, 0), 9, 0, 0, 0, "normal of a matrix");
    scene_destroy(scene);
}

/* The binary container, its sizes written by hand. */
/* The file's places serve as normals. Under a map that doubles x and turns it round they become
 * shorter in x by half; what cannot be normals is told and left out. */
static void normals_turn_with_their_nodes(void **state)
{
    Bench *bench = *state;
    Scene *scene = gltf_scene(bench, "\"nodes\":[{\"mesh\":0,\"scale\":[-2,1,1]}],\"meshes\":"
                              "[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":0},"
                              "\"indices\":1}]}]");
    const double half = 1 / sqrt(5); /* (1/2, 1) of length 1 */
    for (size_t i = 0; i < 2; i++)
        for (size_t k = 0; k < 3; k++) {
            const Vec3 p = bench_corner(scene, i, k), n = bench_shading(scene, i, k);
            if (p.x != 0 && p.y != 0)
                assert_vec3(n, -half, 2 * half, 0, 1e-6, "both");
            else
                assert_vec3(n, p.x / 2, p.y, 0, 0, "one or none");
        }
    assert_int_equal(bench->warnings, 0);
    scene_destroy(scene);
    static const char *const wrong[] = { "1", "2" }; /* single numbers, too few */
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char text[300];
        snprintf(text, sizeof text, NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":"
                 "{\"POSITION\":0,\"NORMAL\":%s},\"indices\":1}]}]", wrong[i]);
        scene = gltf_scene(bench, text);
        assert_int_equal(scene->polygons.normal_count, 0);
        assert_string_equal(bench->code, "normals-ignored");
        scene_destroy(scene);
    }
}

/* Red, yellow: the mean is (1, 1/2, 0). An image that is missing or broken changes nothing. */
static void images_of_emission_are_evened(void **state)
{
    Bench *bench = *state;
    static const char *const rest =
        NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"
        "\"material\":0}]}],\"materials\":[{\"emissiveFactor\":[1,0.5,1],\"emissiveTexture\":"
        "{\"index\":0}}],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"glow.%s\"}]";
    static const struct { const char *ending, *code; double g, b; } cases[] = {
        { "ppm", "emission-evened", 0.25, 0 }, { "png", "image-unreadable", 0.5, 1 },
        { "jpg", "image-missing", 0.5, 1 } };
    char text[600];
    bench_bytes(bench, "glow.ppm", "P6 2 1 255\n\xff\0\0\xff\xff\0", 17);
    bench_bytes(bench, "glow.png", "\x89PNG not really", 15);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, rest, cases[i].ending);
        Scene *scene = gltf_scene(bench, text);
        assert_string_equal(bench->code, cases[i].code);
        assert_rgb(bench_material(scene, 0)->emission, 1, cases[i].g, cases[i].b, 1e-12, "mean");
        scene_destroy(scene);
    }
}

static void glb_is_the_same(void **state)
{
    Bench *bench = *state;
    char json[2000];
    const char *rest = strstr(buffers, "\"bufferViews\"");
    int length = snprintf(json, sizeof json, "{\"buffers\":[{\"byteLength\":60}],%s,%s,%s}", rest,
                          NODE, MESH);
    while (length % 4 != 0)
        json[length++] = ' ';
    uint8_t glb[4000];
    const uint32_t head[] = { 0x46546C67, 2, (uint32_t)(12 + 8 + length + 8 + 60),
                              (uint32_t)length, 0x4E4F534A };
    const uint32_t chunk[] = { 60, 0x004E4942 };
    memcpy(glb, head, 20);
    memcpy(glb + 20, json, (size_t)length);
    memcpy(glb + 20 + length, chunk, 8);
    memcpy(glb + 28 + length, corners, 48);
    memcpy(glb + 76 + length, indices, 12);
    bench_bytes(bench, "t.glb", glb, head[2]);
    Scene *scene = bench_scene(bench, "t.glb");
    assert_int_equal(scene->polygons.polygon_count, 2);
    assert_vec3(bench_normal(scene, 0), 0, 0, 1, 0, "normal");
    scene_destroy(scene);
    bench_bytes(bench, "cut.glb", glb, head[2] - 4);
    bench_refused(bench, "cut.glb", "it is cut off or damaged");
    const uint32_t huge = 0xFFFFFFF0u;
    memcpy(glb + 12, &huge, 4);
    bench_bytes(bench, "huge.glb", glb, head[2]);
    bench_refused(bench, "huge.glb", "a chunk of 4294967280 bytes");
    bench_bytes(bench, "short.glb", glb, 8);
    bench_refused(bench, "short.glb", "ends within its header");
}

/* --- materials ------------------------------------------------------------------------------- */

/* The mesh's two primitives are given material 1 and 0: order in the file must not matter. */
#define TWO "\"meshes\":[{\"name\":\"two\",\"primitives\":[" \
            "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":1}," \
            "{\"attributes\":{\"POSITION\":2},\"material\":0}]}]"

static void materials_mean_light(void **state)
{
    Bench *bench = *state;
    Scene *scene = gltf_scene(bench, NODE "," TWO ",\"materials\":["
        "{\"name\":\"lamp\",\"emissiveFactor\":[1,0.5,0.25],\"extensions\":"
        "{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":1000}},"
        "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.4,0.2,0.5],\"metallicFactor\":0}},"
        "{\"name\":\"alloy\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.4,0.2,1],"
        "\"metallicFactor\":0.75,\"roughnessFactor\":0.5,\"baseColorTexture\":{\"index\":0}}},"
        "{\"name\":\"rough\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.4,0.2,1]}},"
        "{\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.4,0.2,0.25],"
        "\"metallicFactor\":0}},"
        "{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":0.5},"
        "\"KHR_materials_ior\":{\"ior\":1.33}},\"pbrMetallicRoughness\":"
        "{\"baseColorFactor\":[0.8,0.4,0.2,1],\"metallicFactor\":0}}]");
    const Material *m = scene->polygons.materials;
    const double e = 1e-15;
    assert_int_equal(scene->polygons.material_count, 5);
    assert_string_equal(bench_material(scene, 0)->name, "alloy");
    assert_string_equal(bench_material(scene, 2)->name, "lamp");
    assert_string_equal(bench_group(scene, 2), "two");
    assert_rgb(m[0].emission, 1000, 500, 250, 0, "emission with strength");
    assert_rgb(m[0].reflectance, 0.8, 0.4, 0.2, 0, "an opaque material has no alpha");
    assert_rgb(m[1].reflectance, 0.2, 0.1, 0.05, e, "what is no metal");
    assert_rgb(m[1].specular, 0.6, 0.3, 0.15, e, "what is metal");
    assert_close(m[1].exponent, 2 / pow(0.5, 4) - 2, 0, "2 / alpha^2 - 2, alpha = roughness^2");
    assert_rgb(m[2].reflectance, 0.8, 0.4, 0.2, 0, "metal as rough as can be is diffuse");
    assert_rgb(m[3].reflectance, 0.2, 0.1, 0.05, e, "blended");
    assert_rgb(m[3].transmittance, 0.75, 0.75, 0.75, 0, "the rest passes");
    assert_rgb(m[4].transmittance, 0.4, 0.2, 0.1, e, "glass");
    assert_rgb(m[4].reflectance, 0.4, 0.2, 0.1, e, "what does not pass");
    assert_close(m[4].ior, 1.33, 0, "ior");
    assert_int_equal(bench->named[1], 1);
    scene_destroy(scene);
}

/* --- lights and cameras ---------------------------------------------------------------------- */

/* The node is turned by -90 degrees about x: -z becomes -y, straight down. */
static void lights_hang_on_their_nodes(void **state)
{
    Bench *bench = *state;
    Scene *scene = gltf_scene(bench, MESH ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":["
        "{\"type\":\"spot\",\"intensity\":200,\"color\":[1,0.5,0.25],\"spot\":"
        "{\"innerConeAngle\":0.5,\"outerConeAngle\":1}},"
        "{\"type\":\"point\",\"intensity\":64},{\"type\":\"spot\",\"spot\":{}},"
        "{\"type\":\"directional\"}]}},\"nodes\":["
        "{\"mesh\":0,\"children\":[1],\"translation\":[0,3,0],\"scale\":[2,2,2]},"
        "{\"name\":\"down\",\"translation\":[1,0,0],"
        "\"rotation\":[-0.70710678118654752,0,0,0.70710678118654752],"
        "\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":3}}}]");
    const Light *l = scene->lights;
    assert_int_equal(scene->light_count, 3);
    assert_int_equal(l[0].kind, LIGHT_SPOT);
    assert_string_equal(l[0].name, "down");
    assert_vec3(l[0].position, 2, 3, 0, 0, "position");
    assert_vec3(l[0].direction, 0, -1, 0, 1e-15, "direction");
    assert_rgb(l[0].intensity, 200, 100, 50, 0, "candela, whatever the node's scale");
    assert_close(l[0].cos_inner, cos(0.5), 1e-15, "inner cone");
    assert_close(l[0].cos_outer, cos(1), 1e-15, "outer cone");
    assert_int_equal(l[1].kind, LIGHT_POINT);
    assert_rgb(l[1].intensity, 64, 64, 64, 0, "white");
    assert_close(l[2].cos_outer, sqrt(0.5), 1e-15, "the default cone is 45 degrees");
    assert_close(l[2].cos_inner, 1, 0, "from the axis on");
    assert_vec3(l[2].direction, 0, 0, -1, 0, "along -z");
    assert_string_equal(bench->code, "light-ignored");
    assert_true(scene_has_light(scene));
    scene_destroy(scene);
}

static void cameras_have_a_vertical_angle(void **state)
{
    Bench *bench = *state;
    Scene *scene = gltf_scene(bench, MESH ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":"
        "{\"yfov\":1.0471975511965976,\"aspectRatio\":1.7777777777777777,\"znear\":0.1}},"
        "{\"type\":\"orthographic\",\"orthographic\":{\"xmag\":1,\"ymag\":1,\"zfar\":1,"
        "\"znear\":0}}],\"nodes\":[{\"mesh\":0},{\"name\":\"eye\",\"camera\":0,"
        "\"translation\":[1,2,3],"
        "\"rotation\":[0,0.70710678118654752,0,0.70710678118654752]},{\"camera\":1}]");
    const Camera *c = scene->cameras;
    assert_int_equal(scene->camera_count, 1);
    assert_string_equal(c->name, "eye");
    assert_close(c->vertical_fov, 60, 1e-13, "angle");
    assert_close(c->aspect, 16.0 / 9, 1e-15, "aspect");
    assert_vec3(c->eye, 1, 2, 3, 0, "eye");
    assert_vec3(vec3_sub(c->target, c->eye), -1, 0, 0, 1e-15, "turned left, -z becomes -x");
    assert_vec3(c->up, 0, 1, 0, 1e-15, "up");
    assert_string_equal(bench->code, "camera-ignored");
    scene_destroy(scene);
}

/* --- what is refused ------------------------------------------------------------------------- */

static void faults_are_named(void **state)
{
    Bench *bench = *state;
    static const struct { const char *rest, *part; } cases[] = {
        { MESH ",\"nodes\":[{\"mesh\":1}]", "nodes[0]: \"mesh\" is 1" },
        { MESH ",\"nodes\":[{\"mesh\":-1}]", "nodes[0]: \"mesh\" is not an index" },
        { MESH ",\"nodes\":[{\"mesh\":0.5}]", "nodes[0]: \"mesh\" is not an index" },
        { MESH ",\"nodes\":[{\"mesh\":\"0\"}]", "nodes[0]: \"mesh\" is not an index" },
        { MESH ",\"nodes\":[{\"children\":[1]},{\"children\":[1],\"mesh\":0}]",
          "nodes[1]: has two" },
        { MESH ",\"nodes\":[{\"mesh\":0,\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]",
          "nodes[0]: has two parents or is its own ancestor" },
        { MESH ",\"nodes\":[{\"mesh\":0,\"scale\":[1,2]}]",
          "\"scale\" has 2 numbers instead of 3" },
        { MESH ",\"nodes\":[{\"mesh\":0,\"scale\":[1,2,\"3\"]}]", "\"scale\"[2] is not a number" },
        { MESH ",\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,0]}]", "is not a rotation" },
        { MESH ",\"nodes\":[{\"mesh\":0,\"scale\":[1e200,1,1],\"children\":[1]},"
          "{\"scale\":[1e200,1,1]}]", "nodes[1]: its place in the world is not finite" },
        { MESH ",\"nodes\":7", "\"nodes\" is not an array" },
        { MESH ",\"nodes\":[7]", "nodes[0]: is not an object" },
        { NODE, "nodes[0]: \"mesh\" is 0, but must be below 0" },
        { NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]",
          "accessors[1]: positions must be three floats each" },
        { NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":0}]}]",
          "accessors[0]: indices must be single whole numbers" },
        { NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":{}}]}]", "has no POSITION" },
        { NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2},\"indices\":1}]}]",
          "has indices out of range (1 of 2 triangles are good)" },
        { NODE "," MESH ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
          "KHR_draco_mesh_compression is not supported" },
        { NODE "," MESH ",\"materials\":[7]", "materials[0]: is not an object" },
        { NODE "," MESH ",\"materials\":[{\"emissiveFactor\":[1,1]}]", "materials[0]" },
        { MESH ",\"nodes\":[{\"mesh\":0}],\"scenes\":[],\"scene\":0", "\"scene\" is 0" },
        { "\"nodes\":[{}]", "has no faces" },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        gltf_refused(bench, cases[i].rest, cases[i].part);
    gltf_write(bench, NODE "," MESH);
    assert_int_equal(unlink(bench_path(bench, "mesh data.bin")), 0);
    bench_refused(bench, "t.gltf", "could not open referenced file \"mesh%20data.bin\"");
    bench_text(bench, "t.gltf", "{\n\"asset\":{\"version\":\"2.0\"},\n\"nodes\":[,]}");
    bench_refused(bench, "t.gltf", "t.gltf:3: is not valid JSON");
    bench_text(bench, "t.gltf", "{\"asset\":{\"version\":\"1.0\"}}");
    bench_refused(bench, "t.gltf", "glTF of version \"1.0\"");
    bench_text(bench, "t.gltf", "[]");
    bench_refused(bench, "t.gltf", "its JSON is not an object");
}

/* Deep chains of nodes are walked without recursion. */
static void deep_trees_are_walked(void **state)
{
    Bench *bench = *state;
    enum { DEPTH = 100000 };
    char *text = malloc(DEPTH * 40 + 4000);
    int used = sprintf(text, "{%s,%s,\"nodes\":[{\"mesh\":0}", buffers, MESH);

    for (int i = 1; i < DEPTH; i++)
        used += sprintf(text + used, ",{\"children\":[%d]}", i - 1);
    sprintf(text + used, "]}");
    mesh_data(bench, "mesh data.bin");
    bench_text(bench, "t.gltf", text);
    free(text);
    Scene *scene = bench_scene(bench, "t.gltf");
    assert_int_equal(scene->polygons.polygon_count, 2);
    scene_destroy(scene);
}

/* --- by reference ---------------------------------------------------------------------------- */

/* A mesh of two triangles in three places: by itself, twice as large, and mirrored beneath a parent
 * that moves; another of one triangle alone. */
#define SHARED \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1," \
    "\"material\":1}]},{\"primitives\":[{\"attributes\":{\"POSITION\":2}}]}]," \
    "\"materials\":[{\"name\":\"a\"},{\"name\":\"b\"}]," \
    "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"scale\":[2,2,2],\"name\":\"large\"}," \
    "{\"translation\":[5,6,7],\"children\":[3]},{\"mesh\":0,\"scale\":[-1,1,1]}"

static Scene *shared_scene(Bench *bench, const char *rest, SceneInstances instances, uint64_t most)
{
    const Monitor monitor = { .user = bench, .warn = bench_warn };
    const SceneReadOptions options = { .monitor = &monitor, .instances = instances,
                                       .instances_most = most };
    Error err = { 0 };
    gltf_write(bench, rest);
    Scene *scene = scene_read(bench_path(bench, "t.gltf"), &options, &err);
    if (scene == NULL)
        fail_msg("%s", err.text);
    assert_true(scene_check(scene));
    return scene;
}

static void shared_meshes_are_placed(void **state)
{
    Bench *bench = *state;
    static const char with_another[] = SHARED ",{\"mesh\":1}]";
    /* Two faces come again twice: four. */
    Scene *flat = shared_scene(bench, with_another, INSTANCES_AUTO, 4);
    assert_int_equal(flat->placement_count, 0);
    assert_int_equal(flat->polygons.polygon_count, 7);
    for (int i = 0; i < 2; i++) {
        Scene *kept = shared_scene(bench, with_another,
                                   i == 0 ? INSTANCES_AUTO : INSTANCES_KEEP, 3);
        assert_int_equal(kept->prototype_count, 1);
        assert_int_equal(kept->placement_count, 3);
        assert_int_equal(kept->polygons.polygon_count, 1);
        assert_int_equal(scene_triangles(kept), 7);
        for (size_t k = 0; k < 3; k++) {
            const Placement *place = &kept->placements[k];
            const Polygons  *mesh = &kept->prototypes[place->prototype];
            assert_string_equal(kept->polygons.materials[place->material].name, "b");
            assert_int_equal(mesh->polygon_count, 2);
            const Vec3 middle = vec3_lerp(mesh->position[1], mesh->position[2], 0.5);
            const Vec3 want = k == 0 ? vec3(0.5, 0.5, 0)
                              : k == 1 ? vec3(1, 1, 0) : vec3(4.5, 6.5, 7);
            const Vec3 got = affine_point(&place->to_world, middle);
            assert_vec3(got, want.x, want.y, want.z, 0, "middle of the square");
        }
        scene_destroy(kept);
    }
    scene_destroy(flat);
    assert_int_equal(array_live(), 0);
}

/* What looks at the scene's own faces finds some; what is pressed flat is no copy. */
static void some_faces_stay(void **state)
{
    Bench *bench = *state;
    Scene *scene = shared_scene(bench, SHARED "]", INSTANCES_KEEP, 0);
    assert_int_equal(scene->polygons.polygon_count, 2);
    assert_int_equal(scene->placement_count, 2);
    assert_int_equal(scene_triangles(scene), 6);
    scene_destroy(scene);
    scene = shared_scene(bench, SHARED ",{\"mesh\":1},{\"mesh\":0,\"scale\":[1,1,0]}]",
                         INSTANCES_KEEP, 0);
    assert_int_equal(scene->polygons.polygon_count, 3);
    assert_int_equal(scene->placement_count, 3);
    scene_destroy(scene);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    static const char json[] = "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"count\":3,"
        "\"type\":\"VEC3\",\"componentType\":5126}],\"meshes\":[{\"primitives\":[{\"attributes\":"
        "{\"POSITION\":0},\"material\":0}]}],\"materials\":[{\"name\":\"a\"}],"
        "\"nodes\":[{\"mesh\":0,\"children\":[1]},{}]}";
    bool done = false;

    for (long n = 0; !done && n < 200; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Gltf *gltf = gltf_read("t.gltf", json, strlen(json), NULL, &err);
        array_fail_after(-1);
        done = gltf != NULL;
        assert_int_equal(err.code, done ? ERROR_NONE : ERROR_MEMORY);
        gltf_destroy(gltf);
        assert_int_equal(array_live(), 0);
    }
    assert_true(done);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(triangles_come_in_all_modes, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(nodes_place_their_meshes, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(mirrored_nodes_keep_their_fronts, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(normals_turn_with_their_nodes, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(images_of_emission_are_evened, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(glb_is_the_same, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(materials_mean_light, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(lights_hang_on_their_nodes, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(cameras_have_a_vertical_angle, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(faults_are_named, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(deep_trees_are_walked, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(shared_meshes_are_placed, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(some_faces_stay, bench_open, bench_close),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
