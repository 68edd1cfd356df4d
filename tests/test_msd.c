/* SPDX-License-Identifier: BSD-3-Clause */
/* MSD: values, matrices, names, surfaces, the world. */
#include "tests/msd_tools.h"

#include "base/array.h"

/* --- expressions ----------------------------------------------------------------------------- */

typedef struct {
    const char *text;
    double      value;
} Value;

/* Values by hand or by definition of the function; all are within one rounding of exact. */
static const Value values[] = {
    { "12", 12 },
    { "1.5", 1.5 },
    { ".5", 0.5 },
    { "2.", 2 },
    { "1e-3", 0.001 },
    { "1E+3", 1000 },
    { "2.5e1", 25 },
    { "1 + 2 * 3", 7 },
    { "(1 + 2) * 3", 9 },
    { "10 - 4 - 3", 3 },
    { "12 / 4 / 3", 1 },
    { "2 * 3 / 4", 1.5 },
    { "-3", -3 },
    { "+3", 3 },
    { "--3", 3 },
    { "2 - -3", 5 },
    { "2*-3", -6 },
    { "-(1+1)*2", -4 },
    { "SQR(3)", 9 },
    { "sqrt(16)", 4 },
    { "EXP(0)", 1 },
    { "EXP(1)", 2.718281828459045 },
    { "POW(2, 10)", 1024 },
    { "pow(9, 0.5)", 3 },
    { "COS(0)", 1 },
    { "SIN(3.14159265358979324 / 2)", 1 },
    { "TAN(0.78539816339744831)", 1 },
    { "COS(3.14159265358979324)", -1 },
    { "TIME", 0 },
    { "time + 1", 1 },
    { "a", 4 },
    { "a * b2 + c_3", 4 * 0.25 + 8 },
    { "SQR(SQR(a))", 256 },
    { "1 /* one */ + // and\n 1", 2 },
    { "1\r\n+\r\n1", 2 },
    { "a/b2", 16 },
};

static void expressions_have_values(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        char text[400];
        snprintf(text, sizeof text,
                 "FLOAT a = 4, b2 = 1 / a, c_3 = 2 * a;\n" WHITE "SPHERE 1 (%s, 0, 0) 1",
                 values[i].text);
        Scene *scene = msd_scene(text);
        assert_int_equal(scene->polygons.shape_count, 1);
        assert_near(scene->polygons.shape[0].shape.to_world.t.x, values[i].value,
                    4e-16 * fmax(1, fabs(values[i].value)), values[i].text);
        scene_destroy(scene);
    }
}

/* --- moments --------------------------------------------------------------------------------- */

static Scene *scene_at(const char *text, double time)
{
    const SceneReadOptions options = { .time = time };
    Error  err = { 0 };
    Scene *scene = scene_parse_msd("t.msd", text, strlen(text), &options, &err);
    assert_string_equal(err.text, "");
    return scene;
}

/* What differs between two moments of a scene: an eye alone changes no light. */
static void scenes_have_moments(void **state)
{
    static const struct {
        const char *text;
        bool        timed, moves, light;
    } cases[] = {
        { WHITE "SPHERE 1 (1, 0, 0) 1", false, false, false },
        { WHITE "CAMERA c = ( (3 * TIME, 5, 5) (0, 0, 0) (0, 0, 1) 50 50 ); SPHERE 1 (1, 0, 0) 1",
          true, false, false },
        { WHITE "SPHERE 1 (2 * TIME, 0, 0) 1", true, true, true },
        { WHITE "ROT_Z(90 * TIME) TRIANGLE 1 (0,0,0) (1,0,0) (0,1,0)", true, false, true },
        { WHITE "ATT_POS_LIGHT (1, 1, 1) (0, 0, TIME) SPHERE 1 (1, 0, 0) 1", true, false, true },
        { "SURFACE 1 0 ; (1,1,1) TIME / 2 ; (0,0,0) 0, 1 SPHERE 1 (1, 0, 0) 1", true, false, true },
        { WHITE "BACKGROUND (TIME, 0, 0) SPHERE 1 (1, 0, 0) 1", true, false, true },
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Scene *a = scene_at(cases[i].text, 0.25), *b = scene_at(cases[i].text, 0.5);
        Scene *again = scene_at(cases[i].text, 0.25);
        assert_int_equal(a->timed, cases[i].timed);
        assert_true((a->hash != b->hash) == cases[i].timed);
        assert_true((scene_fingerprint(a) != scene_fingerprint(b)) == cases[i].light);
        assert_true(scene_fingerprint(a) == scene_fingerprint(again));
        if (cases[i].moves) {
            assert_true(a->polygons.shape[0].shape.to_world.t.x == 0.5);
            assert_true(b->polygons.shape[0].shape.to_world.t.x == 1);
        }
        scene_destroy(a);
        scene_destroy(b);
        scene_destroy(again);
    }
}

/* --- matrices -------------------------------------------------------------------------------- */

typedef struct {
    const char *text;  /* in front of TRIANGLE 1 (1,2,3) ... */
    double      x, y, z;
} Mapped;

/* Where the point (1, 2, 3) comes to. Rotations are right-handed: about z by 90 degrees x goes to
 * y, about x y goes to z, about y z goes to x. */
static const Mapped mapped[] = {
    { "", 1, 2, 3 },
    { "TRANS(10, 20, 30)", 11, 22, 33 },
    { "SCALE(2, 3, 4)", 2, 6, 12 },
    { "ROT_X(90)", 1, -3, 2 },
    { "ROT_Y(90)", 3, 2, -1 },
    { "ROT_Z(90)", -2, 1, 3 },
    { "rot_z(-90)", 2, -1, 3 },
    { "TRANS(10, 0, 0) * SCALE(2, 2, 2)", 22, 4, 6 },       /* moved, then scaled */
    { "SCALE(2, 2, 2) * TRANS(10, 0, 0)", 12, 4, 6 },
    { "ROT_Z(90) * TRANS(10, 0, 0) * SCALE(1, 2, 1)", 8, 2, 3 },
    { "(TRANS(10, 0, 0) * SCALE(2, 2, 2)) * ROT_Z(90)", -4, 22, 6 },
    { "TRANS(10, 0, 0) * (SCALE(2, 2, 2) * ROT_Z(90))", -4, 22, 6 },
    { "m", 11, 2, 3 },
    { "m * n", 22, 4, 6 },
    { "mn", 22, 4, 6 },
    /* p' = x row0 + y row1 + z row2 + row3 */
    { "MATRIX4X3(0,1,0, 0,0,1, 1,0,0, 10,20,30)", 13, 21, 32 },
    { "MATRIX4X3(1,1,0, 0,1,0, 0,0,1, 0,0,0)", 1, 3, 3 },
};

static void matrices_apply_leftmost_first(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof mapped / sizeof mapped[0]; i++) {
        char text[500];
        snprintf(text, sizeof text,
                 "MATRIX m = TRANS(10,0,0), n = SCALE(2,2,2), mn = m * n;\n" WHITE
                 "%s TRIANGLE 1 (1,2,3) (5,0,0) (0,7,0)", mapped[i].text);
        Scene *scene = msd_scene(text);
        assert_point(corner_of(scene, 0, 0), mapped[i].x, mapped[i].y, mapped[i].z, 1e-14,
                     mapped[i].text);
        scene_destroy(scene);
    }
}

/* The innermost of nested blocks is applied first: (1,0,0) is scaled to 2, moved to 3, turned to
 * (0, 3, 0). The other order of the last two would give (1, 2, 0). */
static void blocks_apply_innermost_first(void **state)
{
    (void)state;
    Scene *scene = msd_scene(WHITE
        "ROT_Z(90) BEGIN\n"
        "  TRANS(1,0,0) BEGIN\n"
        "    SCALE(2,2,2) TRIANGLE 1 (1,0,0) (0,1,0) (0,0,1)\n"
        "  END\n"
        "  TRIANGLE 1 (1,0,0) (0,1,0) (0,0,1)\n"
        "END\n"
        "TRIANGLE 1 (1,0,0) (0,1,0) (0,0,1)\n");
    assert_point(corner_of(scene, 0, 0), 0, 3, 0, 1e-14, "innermost");
    assert_point(corner_of(scene, 1, 0), 0, 1, 0, 1e-14, "middle");
    assert_point(corner_of(scene, 2, 0), 1, 0, 0, 1e-14, "outside");
    scene_destroy(scene);
}

/* --- names and scopes ------------------------------------------------------------------------ */

static double sphere_x(const Scene *scene, size_t i)
{
    assert_true(i < scene->polygons.shape_count);
    return scene->polygons.shape[i].shape.to_world.t.x;
}

static void inner_names_hide_outer_ones(void **state)
{
    (void)state;
    Scene *scene = msd_scene(WHITE
        "FLOAT x = 1; VECTOR p = (5, 0, 0);\n"
        "BEGIN FLOAT x = 2; VECTOR p = (x + 4, 0, 0);\n"
        "  SPHERE 1 (x,0,0) 1\n"
        "  BEGIN FLOAT x = x + 1; SPHERE 1 (x,0,0) 1 END\n"
        "  SPHERE 1 p 1\n"
        "END\n"
        "SPHERE 1 (x,0,0) 1 SPHERE 1 p 1\n"
        "FLOAT x = 9; SPHERE 1 (x,0,0) 1\n");
    const double expected[] = { 2, 3, 6, 1, 5, 9 };
    for (size_t i = 0; i < 6; i++)
        assert_near(sphere_x(scene, i), expected[i], 0, "x");
    scene_destroy(scene);
}

static double red_of(const Scene *scene, size_t i)
{
    const Polygons *p = &scene->polygons;
    return p->materials[p->shape[i].material].reflectance.r;
}

static void surfaces_are_scoped(void **state)
{
    (void)state;
    Warnings warnings = { 0 };
    Error    err = { 0 };
    Scene   *scene = msd_scene_warned(
        "SURFACE 1 0 ; (1,1,1) 0.125 ; (0,0,0) 0, 1\n"
        "BEGIN SURFACE 1 0 ; (1,1,1) 0.25 ; (0,0,0) 0, 1 SPHERE 1 (0,0,0) 1 END\n"
        "SPHERE 1 (0,0,0) 1\n"
        "SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1\n"
        "SPHERE 1 (0,0,0) 1\n", &warnings, &err);
    assert_non_null(scene);
    assert_near(red_of(scene, 0), 0.25, 0, "inner");
    assert_near(red_of(scene, 1), 0.125, 0, "outer again");
    assert_near(red_of(scene, 2), 0.5, 0, "the last one");
    assert_int_equal(scene->polygons.material_count, 3);
    assert_string_equal(scene->polygons.materials[0].name, "surface-1");
    assert_string_equal(scene->polygons.materials[1].name, "surface-1-2");
    assert_int_equal(warnings.count, 1);
    assert_string_equal(warnings.code, "surface-again");
    assert_string_equal(warnings.where, "t.msd:4:1");
    scene_destroy(scene);
}

/* An OBJECT is read with the names of where it was declared and the transform of the REF. */
static void references_keep_their_names(void **state)
{
    (void)state;
    Scene *scene = msd_scene(
        "FLOAT x = 1;\n"
        "OBJECT ball = SPHERE 1 (x, 0, 0) 1, pair = BEGIN REF ball TRANS(10,0,0) REF ball END;\n"
        "DEF three REF pair SPHERE 1 (7,0,0) 1 ENDDEF\n"
        WHITE
        "TRANS(100,0,0) REF ball\n"
        "BEGIN FLOAT x = 50; use pair END\n"
        "TRANS(200,0,0) BEGIN TRANS(3,0,0) REF three END\n");
    const double expected[] = { 101, 1, 11, 204, 214, 210 };
    assert_int_equal(scene->polygons.shape_count, 6);
    for (size_t i = 0; i < 6; i++)
        assert_near(sphere_x(scene, i), expected[i], 0, "x");
    assert_string_equal(scene->polygons.group_name[scene->polygons.shape[0].group], "ball");
    assert_string_equal(scene->polygons.group_name[scene->polygons.shape[1].group], "pair");
    assert_string_equal(scene->polygons.group_name[scene->polygons.shape[5].group], "three");
    scene_destroy(scene);
}

/* Surfaces defined inside an OBJECT are made once for all its REFs. */
static void references_share_materials(void **state)
{
    (void)state;
    Scene *scene = msd_scene(
        "OBJECT lamp = BEGIN SURFACE 1 0 ; (0,0,0) 1 ; (0,0,0) 0,1 EMISSIVE (1,2,3) "
        "SPHERE 1 (0,0,0) 1 END;\n"
        "REF lamp TRANS(3,0,0) REF lamp TRANS(6,0,0) REF lamp");
    assert_int_equal(scene->polygons.shape_count, 3);
    assert_int_equal(scene->polygons.material_count, 1);
    assert_true(scene_has_light(scene));
    scene_destroy(scene);
}

static void groups_have_names(void **state)
{
    (void)state;
    Scene *scene = msd_scene(WHITE
        "OBJECT leg = BOX 1 (0,0,0) <1,1,1>;\n"
        "SPHERE 1 (0,0,0) 1 sphere 1 (1,0,0) 1 CYLINDER_COAT 1 (0,0,0) (0,0,1) <1>\n"
        "BEGIN group \"T\\303\\251 \\x41\" SPHERE 1 (0,0,0) 1 BEGIN GROUP \"in\" "
        "SPHERE 1 (0,0,0) 1 END SPHERE 1 (0,0,0) 1 REF leg END\n"
        "SPHERE 1 (0,0,0) 1 REF leg");
    static const char *const expected[] = { "sphere-1", "sphere-2", "cylinder_coat-1",
                                            "T\xc3\xa9 A", "in", "T\xc3\xa9 A", "sphere-3" };
    const Polygons *p = &scene->polygons;
    for (size_t i = 0; i < 7; i++)
        assert_string_equal(p->group_name[p->shape[i].group], expected[i]);
    assert_string_equal(p->group_name[p->group[0]], "T\xc3\xa9 A");
    assert_string_equal(p->group_name[p->group[6]], "leg");
    scene_destroy(scene);
}

/* Short forms and our own word are names where a matrix of that name exists. */
static void soft_words_may_be_names(void **state)
{
    (void)state;
    Scene *scene = msd_scene(
        "FLOAT F = 2; MATRIX em = TRANS(1,0,0), group = TRANS(2,0,0);\n"
        "SURFACE 1 0 ; (0,0,0) 1 ; (0,0,0) 0, 1 em SPHERE 1 (0,0,0) F group SPHERE 1 (0,0,0) 1");
    assert_near(sphere_x(scene, 0), 1, 0, "em");
    assert_near(sphere_x(scene, 1), 2, 0, "group");
    scene_destroy(scene);
}

/* --- surfaces -------------------------------------------------------------------------------- */

static void assert_rgb(Rgb found, double r, double g, double b, const char *what)
{
    assert_near(found.r, r, 1e-15, what);
    assert_near(found.g, g, 1e-15, what);
    assert_near(found.b, b, 1e-15, what);
}

static void surfaces_have_all_their_parts(void **state)
{
    (void)state;
    Scene *scene = msd_scene(
        "SURFACE 1 PHONG 0.2 ; (0.5, 0.25, 1) 0.5 ; (1, 0.5, 0) 0.5, 20 ; (0.5, 0.4, 0.3) 1.5\n"
        "srfshader 2 0 ; (1,1,1) 0 ; (0,0,0) 0, 1 EMISSIVE (17, 12, 4) IMPORTANCE 3\n"
        "SURFACE 3 0 ; (0,0,0) 0 ; (0,0,0) 0, 1 REFRACTION 1.3 SPECULAR_TRANS (0.1,0.2,0.3)\n"
        "SURFACE 4 0 ; (0,0,0) 0 ; (0,0,0) 0, 1 F 1.4 ST (0.4,0.5,0.6) EM (1,2,3) imp 2\n"
        "SURFACE 5 0 ; (0,0,0) 0 ; (0,0,0) 0, 1 ; 0.25 0 ; EMISSIVE (1,1,1);\n"
        "COLORRANGE 255\n"
        "SURFACE 6 0 ; (255, 51, 0) 0.5 ; (255,0,0) 1, 1 EMISSIVE (510, 255, 0)\n");
    const Material *m = scene->polygons.materials;
    assert_int_equal(scene->polygons.material_count, 6);
    assert_rgb(m[0].reflectance, 0.25, 0.125, 0.5, "rho = diffuse kd");
    assert_rgb(m[0].specular, 0.5, 0.25, 0, "specular ks");
    assert_rgb(m[0].transmittance, 0.5, 0.4, 0.3, "kt");
    assert_near(m[0].exponent, 20, 0, "exponent");
    assert_near(m[0].ior, 1.5, 0, "index");
    assert_near(m[0].importance, 1, 0, "importance unless given");
    assert_rgb(m[1].emission, 17, 12, 4, "emission");
    assert_near(m[1].importance, 3, 0, "importance");
    assert_near(m[1].ior, 1, 0, "index unless given");
    assert_near(m[2].ior, 1.3, 0, "REFRACTION");
    assert_rgb(m[2].transmittance, 0.1, 0.2, 0.3, "SPECULAR_TRANS");
    assert_near(m[3].ior, 1.4, 0, "F");
    assert_rgb(m[3].transmittance, 0.4, 0.5, 0.6, "ST");
    assert_rgb(m[3].emission, 1, 2, 3, "EM");
    assert_near(m[3].importance, 2, 0, "IMP");
    assert_rgb(m[4].transmittance, 0.25, 0.25, 0.25, "kt as one number");
    assert_near(m[4].ior, 1, 0, "index 0 is none");
    assert_rgb(m[4].emission, 1, 1, 1, "EMISSIVE behind kt");
    assert_rgb(m[5].reflectance, 0.5, 0.1, 0, "COLORRANGE");
    assert_rgb(m[5].emission, 2, 1, 0, "COLORRANGE, emission");
    scene_destroy(scene);
}

/* A surface that reflects all light is limited, and this is said once. */
static void reflectance_is_limited(void **state)
{
    (void)state;
    Warnings warnings = { 0 };
    Error    err = { 0 };
    Scene   *scene = msd_scene_warned("\n  SURFACE 7 0 ; (1, 0.5, 2) 1 ; (0,0,0) 0, 1\n",
                                      &warnings, &err);
    assert_non_null(scene);
    assert_rgb(scene->polygons.materials[0].reflectance, 0.99, 0.5, 0.99, "limited");
    assert_int_equal(warnings.count, 1);
    assert_string_equal(warnings.code, "reflectance-limited");
    assert_string_equal(warnings.where, "t.msd:2:3");
    scene_destroy(scene);
}

/* --- the world ------------------------------------------------------------------------------- */

/* tan(v/2) = tan(h/2) height / width: for 90 degrees across 800 x 400, v = 2 atan(1/2). */
static void screen_gives_the_first_camera(void **state)
{
    (void)state;
    Scene *scene = msd_scene(
        "CAMERA side = ( (1,0,0) (0,0,0) (0,0,1) 90 60 );\n"
        "BACKGROUND (0.1, 0.2, 0.3)\n"
        "SCREEN <800, 400> EYEP (0,-5,1) LOOKP (0,0,1) UP (0,0,2) FOV <90>\n");
    assert_true(scene->has_screen);
    assert_int_equal(scene->width, 800);
    assert_int_equal(scene->height, 400);
    assert_int_equal(scene->camera_count, 2);
    const Camera *c = scene->cameras;
    assert_string_equal(c[0].name, "SCREEN");
    assert_point(c[0].eye, 0, -5, 1, 0, "eye");
    assert_point(c[0].target, 0, 0, 1, 0, "target");
    assert_near(c[0].vertical_fov, 53.13010235415598, 1e-12, "vertical from horizontal");
    assert_near(c[0].aspect, 2, 0, "aspect");
    assert_string_equal(c[1].name, "side");
    assert_near(c[1].vertical_fov, 60, 0, "vertical");
    assert_near(c[1].aspect, 1.7320508075688772, 1e-15, "tan 45 / tan 30");
    assert_point(scene->up, 0, 0, 1, 0, "up");
    assert_rgb(scene->background, 0.1, 0.2, 0.3, "background");
    scene_destroy(scene);

    scene = msd_scene("CAMERA side = ( (1,0,0) (0,0,0) (0,1,0) 90 60 )\n"
                      "OBJECT ball = SPHERE 1 (0,0,0) 1\n" WHITE "REF ball\n"
                      "SCREEN <80, 60> CAMERA side");
    assert_int_equal(scene->polygons.shape_count, 1); /* both without a sign behind */
    assert_string_equal(scene->cameras[0].name, "SCREEN");
    assert_near(scene->cameras[0].vertical_fov, 60, 0, "vertical");
    assert_point(scene->up, 0, 1, 0, 0, "up of SCREEN");
    scene_destroy(scene);

    scene = msd_scene("SCREEN <80, 60> EYEP (0,0,0) LOOKP (1,0,0) UP (0,0,1) FOV <80, 50>");
    assert_near(scene->cameras[0].vertical_fov, 50, 0, "both given");
    scene_destroy(scene);

    scene = msd_scene(WHITE);
    assert_false(scene->has_screen);
    assert_int_equal(scene->camera_count, 0);
    assert_point(scene->up, 0, 0, 1, 0, "up without SCREEN");
    scene_destroy(scene);
}

static void lights_have_intensities(void **state)
{
    (void)state;
    Scene *scene = msd_scene("AMB_LIGHT (0.1, 0.2, 0.3) ATT_POS_LIGHT (100, 50, 25) (1, 2, 3)\n"
                             "ATT_SPOT_LIGHT (10, 20, 30) (0,0,5) (0, 0, -2) 120\n");
    assert_int_equal(scene->light_count, 2);
    const Light *l = scene->lights;
    assert_int_equal(l[0].kind, LIGHT_POINT);
    assert_rgb(l[0].intensity, 100, 50, 25, "intensity");
    assert_point(l[0].position, 1, 2, 3, 0, "position");
    assert_int_equal(l[1].kind, LIGHT_SPOT);
    assert_point(l[1].direction, 0, 0, -1, 0, "unit direction");
    assert_near(l[1].cos_inner, 0.5, 1e-15, "half of 120 degrees");
    assert_near(l[1].cos_outer, l[1].cos_inner, 0, "sharp edge");
    assert_rgb(scene->ambient, 0.1, 0.2, 0.3, "ambient");
    assert_true(scene_has_light(scene));
    scene_destroy(scene);
}

static void globals_without_effect_are_told(void **state)
{
    (void)state;
    static const char *const words[] = { "MAXLEVEL 5", "MAXEYELEVEL 3", "MAXLIGHTLEVEL 2",
                                         "GAMMACOLOR 2.2", "gamma 1.8", "OUTFILE \"x.ppm\"",
                                         "AEPS 0.1", "FEPS 1e-3", "BFEPS 1" };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        Warnings warnings = { 0 };
        Error    err = { 0 };
        Scene   *scene = msd_scene_warned(words[i], &warnings, &err);
        assert_non_null(scene);
        assert_int_equal(warnings.count, 1);
        assert_string_equal(warnings.code, "no-effect");
        scene_destroy(scene);
    }
}

/* Every allocation of a scene that uses all parts of the reader fails once; nothing leaks. */
static void allocations_may_fail(void **state)
{
    (void)state;
    static const char text[] =
        "FLOAT a = 1;\n"
        "OBJECT o = BEGIN SURFACE 2 0;(1,1,1) .5;(0,0,0) 0,1 BOX 2 (a,0,0) <1,1,1> END;\n"
        "CAMERA c = ( (1,0,0) (0,0,0) (0,0,1) 90 60 ); SCREEN <8,8> CAMERA c\n"
        "ATT_POS_LIGHT (1,1,1) (0,0,0)\n" WHITE
        "BEGIN GROUP \"g\" CONE 1 (0,0,0) (0,0,1) 1 REF o END\n"
        "TORUS 1 (0,0,0) <2,1>";
    bool done = false;

    for (long n = 0; !done; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Scene *scene = scene_parse_msd("t.msd", text, strlen(text), NULL, &err);
        array_fail_after(-1);
        done = scene != NULL;
        assert_true(done || err.code == ERROR_MEMORY);
        scene_destroy(scene);
        assert_int_equal(array_live(), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(expressions_have_values),
        cmocka_unit_test(scenes_have_moments),
        cmocka_unit_test(matrices_apply_leftmost_first),
        cmocka_unit_test(blocks_apply_innermost_first),
        cmocka_unit_test(inner_names_hide_outer_ones),
        cmocka_unit_test(surfaces_are_scoped),
        cmocka_unit_test(references_keep_their_names),
        cmocka_unit_test(references_share_materials),
        cmocka_unit_test(groups_have_names),
        cmocka_unit_test(soft_words_may_be_names),
        cmocka_unit_test(surfaces_have_all_their_parts),
        cmocka_unit_test(reflectance_is_limited),
        cmocka_unit_test(screen_gives_the_first_camera),
        cmocka_unit_test(lights_have_intensities),
        cmocka_unit_test(globals_without_effect_are_told),
        cmocka_unit_test(allocations_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
