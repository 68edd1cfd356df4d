/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes kept by reference: what the reader hands on, where rays meet them, light among them. */
#include "tests/msd_tools.h"

#include "base/array.h"
#include "render/normals.h"
#include "render/path.h"
#include "tests/room_maker.h"

#define PLACED "tests/data/msd/placed.msd"
enum { PRISMS = 6, PRISM_FACES = 6, PRISM_TRIANGLES = 8, PRISM_VERTICES = 6 };
enum { OTHER_FACES = 2, OTHER_TRIANGLES = 3 }; /* a square and a triangle; and a sphere */

static Scene *placed_read(SceneInstances instances, uint64_t most)
{
    Warnings               warnings = { 0 };
    const Monitor          monitor = { .user = &warnings, .warn = warnings_take };
    const SceneReadOptions options = { .monitor = &monitor, .instances = instances,
                                       .instances_most = most };
    Error  err = { 0 };
    Scene *scene = scene_read(PLACED, &options, &err);
    if (scene == NULL)
        fail_msg("%s", err.text);
    assert_int_equal(warnings.count, 0);
    assert_int_equal(scene_triangles(scene), PRISMS * PRISM_TRIANGLES + OTHER_TRIANGLES);
    return scene;
}

/* --- reading --------------------------------------------------------------------------------- */

/* The base of five corners has the normals of the file, all other faces have none. */
static void normals_check(const Polygons *p)
{
    for (uint32_t f = 0; f < p->polygon_count; f++) {
        const uint32_t corners = p->first[f + 1] - p->first[f];
        for (uint32_t k = p->first[f]; k < p->first[f + 1]; k++)
            assert_true(k < p->normal_count ? p->normal[3 * k + 2] == (corners == 5 ? -1 : 0)
                                            : corners != 5);
    }
}

static void flattened_or_kept(void **state)
{
    (void)state;
    /* The sixth prism is the fifth that comes again, with 30 faces by then. */
    static const struct {
        SceneInstances instances;
        uint64_t       most;
        size_t         kept;
    } cases[] = { { INSTANCES_FLATTEN, 1, 0 }, { INSTANCES_AUTO, 0, 0 },
                  { INSTANCES_AUTO, 5 * PRISM_FACES, 0 }, { INSTANCES_KEEP, 0, PRISMS },
                  { INSTANCES_AUTO, 5 * PRISM_FACES - 1, PRISMS },
                  { INSTANCES_AUTO, 1, PRISMS } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Scene          *scene = placed_read(cases[i].instances, cases[i].most);
        const Polygons *p = &scene->polygons;
        const size_t    flat = PRISMS - cases[i].kept;
        assert_int_equal(scene->placement_count, cases[i].kept);
        assert_int_equal(scene->prototype_count, cases[i].kept > 0 ? 1 : 0);
        assert_int_equal(p->polygon_count, flat * PRISM_FACES + OTHER_FACES);
        assert_int_equal(p->vertex_count, flat * PRISM_VERTICES + 4 + 3);
        assert_int_equal(p->shape_count, 1);
        normals_check(p);
        for (size_t k = 0; k < scene->prototype_count; k++)
            normals_check(&scene->prototypes[k]);
        scene_destroy(scene);
    }
    assert_int_equal(array_live(), 0);
}

/* Faces between the meshes are where they were, of the same materials and groups. */
static void others_stay(void **state)
{
    (void)state;
    static const uint64_t most[] = { 1, 2 * PRISM_FACES, 5 * PRISM_FACES - 1 };
    Scene *flat = placed_read(INSTANCES_FLATTEN, 0);
    const uint32_t of[OTHER_FACES] = { 2 * PRISM_FACES, 4 * PRISM_FACES + 1 };
    for (size_t i = 0; i < 3; i++) {
        Scene          *kept = placed_read(INSTANCES_AUTO, most[i]);
        const Polygons *a = &flat->polygons, *b = &kept->polygons;
        for (uint32_t f = 0; f < OTHER_FACES; f++) {
            const uint32_t corners = b->first[f + 1] - b->first[f];
            assert_int_equal(a->first[of[f] + 1] - a->first[of[f]], corners);
            assert_int_equal(a->material[of[f]], b->material[f]);
            assert_string_equal(a->group_name[a->group[of[f]]], b->group_name[b->group[f]]);
            for (uint32_t k = 0; k < corners; k++) {
                const Vec3 p = a->position[a->corner[a->first[of[f]] + k]];
                const Vec3 q = b->position[b->corner[b->first[f] + k]];
                assert_true(vec3_length(vec3_sub(p, q)) == 0);
            }
        }
        scene_destroy(kept);
    }
    scene_destroy(flat);
    assert_int_equal(array_live(), 0);
}

/* Maps and materials of the places, in the order of the file. */
static void places_are_those_of_the_file(void **state)
{
    (void)state;
    Scene *scene = placed_read(INSTANCES_KEEP, 0);
    static const double x[PRISMS] = { 0, 10, 20, 30, 40, 50 };
    static const double size[PRISMS] = { 1, 1, 24, -1, 1, 1 };
    static const double red[PRISMS] = { 0.5, 0.2, 0.2, 0.2, 0.2, 0.5 };
    for (size_t i = 0; i < PRISMS; i++) {
        const Placement *p = &scene->placements[i];
        assert_near(p->to_world.t.x, x[i], 0, "x");
        assert_near(affine_determinant(&p->to_world), size[i], 1e-13, "size");
        assert_near(scene->polygons.materials[p->material].reflectance.r, red[i], 1e-15, "red");
    }
    assert_near(scene->placements[3].to_world.t.z, 1, 0, "z");
    scene_destroy(scene);
}

/* --- rays ------------------------------------------------------------------------------------ */

/* The room of a scene's own faces, as path.h wants it. */
static void room_of(TestRoom *r, const Scene *scene)
{
    Error err = { 0 };
    r->surfaces = surfaces_create(&scene->polygons, NULL, &err);
    assert_non_null(r->surfaces);
    room_trace(r);
    for (uint32_t i = 0; i < r->surfaces->count; i++) {
        const Surface *s = &r->surfaces->surface[i];
        r->sides[i] = 3;
        r->emitting[i] = rgb_max(scene->polygons.materials[s->material].emission) > 0;
    }
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh,
                      .materials = scene->polygons.materials,
                      .material_count = scene->polygons.material_count,
                      .lights = scene->lights, .light_count = scene->light_count,
                      .sides = r->sides, .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
}

/* Rays at the same places of the scene flattened and kept find the same point, normal, side and
 * material: the two differ by rounding to float in different spaces. */
static void hits_are_those_of_flat_faces(void **state)
{
    (void)state;
    Scene   *flat = placed_read(INSTANCES_FLATTEN, 0), *kept = placed_read(INSTANCES_KEEP, 0);
    TestRoom a = { 0 }, b = { 0 };
    Error    err = { 0 };
    unsigned hits = 0, copies_hits = 0;
    room_of(&a, flat);
    room_of(&b, kept);
    RoomCopies *copies = copies_create(&b.room, kept, NULL, 1, NULL, &err);
    assert_non_null(copies);
    const Instances *all = copies_instances(copies);
    const double     near = 4 * copies_offset(copies);
    for (int i = 0; i < 2000; i++) {
        const double s = (i / 6 % 18 + 0.21) / 18, t = (i / 108 + 0.37) / 19;
        const Vec3   from = vec3(10 * (i % 6) + 5 * s - 2, 5 * t - 1, 30);
        const Vec3   way = vec3(0.02 * t, 0.02 - 0.01 * s, -1);
        const Ray    ray = { .ox = (float)from.x, .oy = (float)from.y, .oz = (float)from.z,
                             .dx = (float)way.x, .dy = (float)way.y, .dz = (float)way.z,
                             .t_max = INFINITY };
        Hit          hit;
        InstanceHit  found;
        RoomHit      p, q;
        const bool   there = bvh_nearest(a.bvh, &ray, &hit);
        assert_int_equal(there, instances_nearest(all, &ray, &found));
        if (!there)
            continue;
        room_hit(&a.room, &hit, way, &p);
        const Room *room = copies_hit(copies, &found, way, &q);
        hits++;
        copies_hits += found.instance > 0;
        assert_true(vec3_length(vec3_sub(p.point, q.point)) <= near);
        assert_true(vec3_length(vec3_sub(p.normal, q.normal)) <= 1e-6);
        assert_int_equal(p.side, q.side);
        const Material *m = &a.room.materials[surfaces_material(a.surfaces, p.surface, p.side)];
        const Material *n = &room->materials[surfaces_material(room->surfaces, q.surface,
                                                               q.side)];
        assert_near(m->reflectance.b, n->reflectance.b, 0, "blue");
    }
    assert_true(hits > 100 && copies_hits > 80 && hits > copies_hits);
    copies_destroy(copies);
    room_clear(&a);
    room_clear(&b);
    scene_destroy(flat);
    scene_destroy(kept);
    assert_int_equal(array_live(), 0);
}

/* A ball of triangles, radius 1, without its poles. */
static void add_ball(Polygons *soup, uint32_t material)
{
    enum { RINGS = 12, SIDES = 24 };
    Error    err = { 0 };
    uint32_t first = (uint32_t)soup->vertex_count, group = 0, index;
    assert_true(polygons_add_group(soup, "ball", &group, &err));
    for (int i = 1; i < RINGS; i++)
        for (int k = 0; k < SIDES; k++) {
            const double a = M_PI * i / RINGS, b = 2 * M_PI * k / SIDES;
            const Vec3   p = vec3(sin(a) * cos(b), sin(a) * sin(b), cos(a));
            assert_true(polygons_add_vertex(soup, p, &index, &err));
        }
    for (uint32_t i = 0; i + 2 < RINGS; i++)
        for (uint32_t k = 0; k < SIDES; k++) {
            const uint32_t j = (k + 1) % SIDES, a = first + i * SIDES, b = a + SIDES;
            const uint32_t corners[2][3] = { { a + k, b + k, b + j }, { a + k, b + j, a + j } };
            for (int half = 0; half < 2; half++)
                assert_true(polygons_add_polygon(soup, corners[half], 3, material, group, &err));
        }
}

/* Turned, mirrored and evenly scaled, smooth normals are those of the flat faces. */
static void smooth_normals_are_those_of_flat_faces(void **state)
{
    (void)state;
    const Affine turn = affine_rotation(1, 37), size = { { -3, 0, 0 }, { 0, 3, 0 }, { 0, 0, 3 },
                                                         { 5, 0, 0 } };
    const Affine map = affine_then(&turn, &size);
    Error    err = { 0 };
    Scene   *scene = scene_create("t", &err);
    Material mirror = material_default();
    Polygons ball = { 0 }, flat = { 0 };
    uint32_t index = 0;
    TestRoom a = { 0 }, b = { 0 };
    mirror.specular = rgb(1, 1, 1);
    mirror.reflectance = rgb(0, 0, 0);
    mirror.exponent = INFINITY;
    assert_true(polygons_add_material(&scene->polygons, &mirror, &index, &err));
    assert_true(polygons_add_material(&ball, &mirror, &index, &err));
    assert_true(polygons_add_material(&flat, &mirror, &index, &err));
    add_ball(&scene->polygons, 0);
    add_ball(&ball, 0);
    assert_true(polygons_add_group(&flat, "ball", &index, &err));
    assert_true(polygons_append(&flat, &ball, &map, 0, 0, &err));
    assert_true(scene_add_prototype(scene, &ball, &index, &err));
    assert_true(scene_add_placement(scene, &(Placement){ .to_world = map }, &err));
    room_of(&b, scene);
    Scene other = { .polygons = flat };
    room_of(&a, &other);
    float      *smooth = normals_create(&a.room, &err);
    RoomCopies *copies = copies_create(&b.room, scene, NULL, 1, NULL, &err);
    assert_non_null(smooth);
    assert_non_null(copies);
    unsigned bent = 0;
    for (int i = 0; i < 400; i++) {
        const Vec3  way = vec3(0.1, -0.2, -1);
        const Ray   ray = { .ox = 3.2f + 0.131f * (float)(i % 20), .oy = 0.13f * (float)(i / 20),
                            .oz = 9, .dx = (float)way.x, .dy = (float)way.y, .dz = (float)way.z,
                            .t_max = INFINITY };
        Hit         hit;
        InstanceHit found;
        RoomHit     p, q;
        if (!bvh_nearest(a.bvh, &ray, &hit) ||
            !instances_nearest(copies_instances(copies), &ray, &found))
            continue;
        room_hit(&a.room, &hit, way, &p);
        copies_hit(copies, &found, way, &q);
        assert_int_equal(found.instance, 1);
        const Vec3 m = normals_at(smooth, &a.room, &p, way);
        const Vec3 n = copies_normal(copies, &found, &q, way);
        /* Places are off by rounding to float, over faces of about 0.4. */
        assert_true(vec3_length(vec3_sub(m, n)) <= 1e-5);
        bent += vec3_length(vec3_sub(n, q.normal)) > 0.01;
    }
    assert_true(bent > 200);
    array_free(smooth);
    copies_destroy(copies);
    room_clear(&a);
    room_clear(&b);
    polygons_clear(&flat);
    scene_destroy(scene);
    assert_int_equal(array_live(), 0);
}

/* --- light ----------------------------------------------------------------------------------- */

/* In a closed room everything has exitance pi (1 - reflectance): radiance is 1 wherever one looks,
 * whatever stands there. Copies that are stretched and mirrored must lose no light and add none. */
static void furnace_with_copies(void **state)
{
    (void)state;
    Scene   *scene = placed_read(INSTANCES_KEEP, 0);
    TestRoom r = { 0 };
    Error    err = { 0 };
    Polygons *soup = &scene->polygons;
    for (size_t i = 0; i < soup->material_count; i++)
        soup->materials[i].emission = rgb_mad(rgb(1, 1, 1), -1, soup->materials[i].reflectance);
    TestRoom hall = { .soup = *soup };
    room_box(&hall, vec3(-10, -30, -30), vec3(70, 30, 30), BOX_ALL, true, 0, "hall");
    *soup = hall.soup;
    room_of(&r, scene);
    RoomCopies *copies = copies_create(&r.room, scene, NULL, 1, NULL, &err);
    assert_non_null(copies);
    const Camera camera = { .eye = { 20, -20, 4 }, .target = { 21, 0, 1 }, .up = { 0, 0, 1 },
                            .vertical_fov = 60 };
    PathOptions  options = { .width = 24, .height = 12, .samples = 16, .threads = 1,
                             .copies = copies };
    PathReport   report;
    Image *image = render_path(&r.room, &camera, &options, &report, NULL, &err);
    assert_non_null(image);
    double sum = 0;
    const int n = image->width * image->height;
    for (int i = 0; i < n; i++)
        sum += (double)image->radiance[3 * i + 1] / n;
    assert_near(sum, 1, 4 * report.error / sqrt(n) + 1e-6, "furnace");
    assert_true(report.error < 0.2);
    /* And the same bytes from two threads. */
    options.threads = 2;
    Image *again = render_path(&r.room, &camera, &options, NULL, NULL, &err);
    assert_non_null(again);
    assert_memory_equal(image->radiance, again->radiance, 3 * (size_t)n * sizeof(float));
    image_destroy(image);
    image_destroy(again);
    copies_destroy(copies);
    room_clear(&r);
    scene_destroy(scene);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flattened_or_kept),
        cmocka_unit_test(others_stay),
        cmocka_unit_test(places_are_those_of_the_file),
        cmocka_unit_test(hits_are_those_of_flat_faces),
        cmocka_unit_test(smooth_normals_are_those_of_flat_faces),
        cmocka_unit_test(furnace_with_copies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
