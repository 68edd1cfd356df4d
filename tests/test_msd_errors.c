/* SPDX-License-Identifier: BSD-3-Clause */
/* What MSD text that is wrong is told: file, line, column, what was found, what was expected. */
#include "tests/msd_tools.h"

#include <stdlib.h>

#include "base/array.h"

typedef struct {
    const char *text, *place, *message;
} Wrong;

/* Places counted by hand: lines and columns from 1, columns in characters. */
static const Wrong wrong[] = {
    { "SURFACE 1 0 ; (1,1,1) 1 ; (0,0,0) 0, 1 ; (0,0)", "1:46", "found ')', expected ','" },
    { "SPHERE 1 (0,0,0) 1", "1:8", "found surface 1, which is not defined, expected one that is" },
    { WHITE "SPHERE 2 (0,0,0) 1", "2:8",
      "found surface 2, which is not defined, expected one that is" },
    { WHITE "SPHERE 1.5 (0,0,0) 1", "2:8",
      "found 1.5, expected a surface's number, whole and above 0" },
    { WHITE "SPHERE 0 (0,0,0) 1", "2:8",
      "found 0, expected a surface's number, whole and above 0" },
    { WHITE "SPHERE 1 (0,0) 1", "2:14", "found ')', expected ','" },
    { WHITE "SPHERE 1 0 1", "2:10", "found '0', expected a vector (x, y, z)" },
    { WHITE "SPHERE 1 (0,0,0) 0", "2:18", "found 0, expected a radius above 0" },
    { WHITE "SPHERE 1 (0,0,0) -2", "2:18", "found -2, expected a radius above 0" },
    { WHITE "SPHERE 1 (0,0,0)", "2:17", "found the end of the file, expected a number" },
    { WHITE "BOX 1 (0,0,0) <1,2>", "2:19", "found '>', expected ',' and one more size" },
    { WHITE "BOX 1 (0,0,0) <1,2,3,4>", "2:21", "found ',', expected '>'" },
    { WHITE "BOX 1 (0,0,0) <1,0,3>", "2:18", "found 0, expected a size above 0" },
    { WHITE "BOX 1 (0,0,0) 1", "2:15", "found '1', expected sizes <a, b, c>" },
    { WHITE "TORUS 1 (0,0,0) <1,2>", "2:17",
      "found a torus of ring 1 and tube 2, expected a tube thinner than the ring" },
    { WHITE "CONE 1 (1,1,1) (1,1,1) 2", "2:16",
      "found the same point twice, expected a bottom and a top" },
    { WHITE "DISC 1 (0,0,0) (0,0,0) 2", "2:16", "found (0, 0, 0), expected the disc's normal" },
    { WHITE "GEN_CYLINDER 1 (0,0,0) (0,0,1) <0,0>", "2:32",
      "found no radius above 0, expected one" },
    { WHITE "TRIANGLE 1 (0,0,0) (1,0,0)", "2:27",
      "found the end of the file, expected a vector (x, y, z)" },
    { WHITE "TRIANGLE 1 (0,0,0) (1,0,0) (1e30,0,0)", "2:1",
      "a point lies at (1e+30, 0, 0), expected coordinates up to 9.2e+18" },
    { WHITE "SCALE(1e200,1,1) SPHERE 1 (0,0,0) 1e200", "2:18",
      "sphere: flattened to nothing, or not finite, by its transformation" },
    { WHITE "SUPERQ 1 (0,0,0) <1,1,1> <1,1,1>", "2:1",
      "found SUPERQ, which is not built yet, expected a declaration, a surface or an object" },
    { WHITE "csg_union 1", "2:1",
      "found csg_union, which is not built yet, expected a declaration, a surface or an object" },
    { "POS_LIGHT (1,1,1) (0,0,0)", "1:1",
      "found POS_LIGHT, which is not built yet, expected a declaration, a surface or an object" },
    { "DIST_LIGHT (1,1,1) (0,0,0) ; 1, 2 3", "1:1",
      "found DIST_LIGHT, which is not built yet, expected a declaration, a surface or an object" },
    { "SURFACE 1 TEXTURE_2D 0 ; (1,1,1) 1", "1:11",
      "found TEXTURE_2D, which is not built yet, expected PHONG or an ambient coefficient" },
    { "SURFACE 1 WOOD", "1:11",
      "found WOOD, which is not built yet, expected PHONG or an ambient coefficient" },
    { "SURFACE 0 0 ; (1,1,1) 1", "1:9",
      "found '0', expected a surface's number, a whole number from 1 to 2147483647" },
    { "SURFACE 1.5 0 ; (1,1,1) 1", "1:9",
      "found '1.5', expected a surface's number, a whole number from 1 to 2147483647" },
    { "SURFACE 1 0 , (1,1,1) 1", "1:13", "found ',', expected ';'" },
    { "SURFACE 1 0 ; (1,-1,1) 1 ; (0,0,0) 0, 1", "1:15",
      "found (1, -1, 1), expected a colour without negative parts" },
    { "SURFACE 1 0 ; (1,1,1) 1 ; (0,0,0) 0 1", "1:37", "found '1', expected ','" },
    { "Sphere 1 (0,0,0) 1", "1:1",
      "found 'Sphere', a word in mixed case, expected a declaration, a surface or an object" },
    { "FLOAT a = b;", "1:11", "found 'b', which is not declared, expected the name of a FLOAT" },
    { "FLOAT a = 1", "1:12", "found the end of the file, expected ',' or ';'" },
    { "FLOAT box = 1;", "1:7", "found 'box', expected a name that is no word of the language" },
    { "FLOAT a = 1 / 0;", "1:13", "the value is not a finite number, expected one that is" },
    { "FLOAT a = 1 / (1 / 0);", "1:18", "the value is not a finite number, expected one that is" },
    { "FLOAT a = SQRT(-1);", "1:11", "the value is not a finite number, expected one that is" },
    { "FLOAT a = EXP(1000);", "1:11", "the value is not a finite number, expected one that is" },
    { "FLOAT a = 1e999;", "1:11", "the number 1e999 is too large" },
    { "FLOAT a = 12abc;", "1:11", "found '12abc', which is neither number nor name" },
    { "FLOAT a = 1.2.3;", "1:11", "found '1.2.3', which is neither number nor name" },
    { "FLOAT a = .;", "1:11", "found '.', expected a number or a word" },
    { "FLOAT a = POW(2);", "1:16", "found ')', expected ','" },
    { "FLOAT a = 2 $ 3;", "1:13", "found '$', which is no part of the language" },
    { "VECTOR p = (1,2,3); FLOAT a = p;", "1:31",
      "found 'p', which is a VECTOR, expected the name of a FLOAT" },
    { "FLOAT a = 1; VECTOR p = a;", "1:25",
      "found 'a', which is a FLOAT, expected the name of a VECTOR" },
    { "VECTOR p = (1,2,3,4);", "1:18", "found ',', expected ')'" },
    { "MATRIX m = SCALE(1, 0, 1);", "1:12",
      "found a matrix that flattens or overflows space, expected one that has an inverse" },
    { "MATRIX m = MATRIX4X3(1,2,3);", "1:27", "found ')', expected ','" },
    { "MATRIX m = TRANS(1,2,3) * 5;", "1:27", "found '5', expected a matrix" },
    { "MATRIX m = TRANS(1,2,3); m 5", "1:28",
      "found '5', expected a declaration, a surface or an object" },
    { "BEGIN SURFACE 1 0 ; (1,1,1) 1 ; (0,0,0) 0, 1", "1:45",
      "found the end of the file, expected END or an object" },
    { WHITE "END", "2:1", "found 'END', expected a declaration, a surface or an object" },
    { "OBJECT o = REF o;", "1:16",
      "found 'o', which is not declared, expected the name of an OBJECT" },
    { "REF nothing", "1:5",
      "found 'nothing', which is not declared, expected the name of an OBJECT" },
    { "DEF d SPHERE 1 (0,0,0) 1", "1:25",
      "found the end of the file, expected ENDDEF or an object" },
    { "OBJECT o = SPHERE 1 (0,0) 1;", "1:25", "found ')', expected ','" },
    { "/* no end", "1:1", "found a comment without end, expected */" },
    { "BEGIN GROUP \"no end", "1:13", "found a string without end, expected \"" },
    { "GROUP \"\"", "1:7", "found '\"\"', expected the group's name in quotes" },
    { "GROUP \"a\\nb\"", "1:7", "found a control character in a group's name, expected none" },
    { "GROUP \"\\q\"", "1:8",
      "found an escape that stands for nothing, expected one of C's (\\n \\t \\\\ \\\" "
      "\\x41 ...)" },
    { "GROUP \"\\377\"", "1:7", "found a string that is not UTF-8" },
    { "GROUP 5", "1:7", "found '5', expected the group's name in quotes" },
    { "SCREEN <512> EYEP (0,0,0)", "1:12", "found '>', expected ',' and one more size" },
    { "SCREEN <512.5, 512> EYEP (0,0,0) LOOKP (1,0,0) UP (0,0,1) FOV <50>", "1:8",
      "found a picture of 512.5 by 512, expected whole numbers from 1 to 65535" },
    { "SCREEN <8, 8> EYEP (1,2,3) LOOKP (1,2,3) UP (0,0,1) FOV <50>", "1:15",
      "the view's eye and look point are the same, expected two points" },
    { "SCREEN <8, 8> EYEP (0,0,0) LOOKP (0,0,4) UP (0,0,1) FOV <50>", "1:15",
      "the view looks along its up direction, expected another one" },
    { "SCREEN <8, 8> EYEP (0,0,0) LOOKP (1,0,0) UP (0,0,1) FOV <180>", "1:58",
      "found 180, expected a field of view in degrees between 0 and 180" },
    { "SCREEN <8, 8> LOOKP (0,0,0)", "1:15", "found 'LOOKP', expected EYEP or CAMERA" },
    { "SCREEN <8, 8> CAMERA c", "1:22",
      "found 'c', which is not declared, expected the name of a CAMERA" },
    { "ATT_SPOT_LIGHT (1,1,1) (0,0,0) (0,0,0) 40", "1:32",
      "found (0, 0, 0), expected the spot's direction" },
    { "ATT_SPOT_LIGHT (1,1,1) (0,0,0) (0,0,1) 400", "1:40",
      "found 400, expected an aperture in degrees above 0 to 360" },
    { "ATT_POS_LIGHT (-1,1,1) (0,0,0)", "1:15",
      "found (-1, 1, 1), expected a colour without negative parts" },
    { "ATT_POS_LIGHT (1e308, 1e308, 1e308) (0,0,0)", "1:15",
      "found (1e+308, 1e+308, 1e+308), expected a colour of at most 1e+100" },
    { "BEGIN BACKGROUND (1,1,1) END", "1:7",
      "found 'BACKGROUND', expected a declaration, a surface or an object" },
    { "COLORRANGE 0", "1:12", "found 0, expected a colour range above 0" },
    { "INCLUDE \"x.msd\" ;", "1:1", "found the name of a file, which may not be opened here" },
    { "INCLUDE ;", "1:9", "found ';', expected a file name" },
    { WHITE "BREPOBJ 1 \"x.obj\"", "2:11",
      "found the name of a file, which may not be opened here" },
    { WHITE "BREPOBJ 1 x.obj", "2:11", "found 'x', expected a file name in quotes" },
    { "ENDFILE SPHERE", "1:9", "found 'SPHERE', expected nothing behind ENDFILE" },
    { "END", "1:1", "found 'END', expected a declaration, a surface or an object" },
    { "\xc3\xa4", "1:1", "found the byte 0xC3, which is no part of the language" },
    { WHITE "\n\n   /* \xc3\xa4\xc3\xb6 */\tSPHERE ?", "4:20",
      "found '?', which is no part of the language" },
};

static void wrong_text_is_told(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char  expected[400];
        Error err = { 0 };
        Scene *scene = scene_parse_msd("t.msd", wrong[i].text, strlen(wrong[i].text), NULL, &err);
        assert_null(scene);
        snprintf(expected, sizeof expected, "t.msd:%s: %s", wrong[i].place, wrong[i].message);
        if (strcmp(err.text, expected) != 0)
            fail_msg("%s\n told:     %s\n expected: %s", wrong[i].text, err.text, expected);
        assert_int_equal(err.code, ERROR_INPUT);
        assert_int_equal(array_live(), 0);
    }
}

/* All words of the language that no part of the reader knows yet name themselves. */
static void words_not_built_name_themselves(void **state)
{
    (void)state;
    static const char *const objects[] = {
        "SR_TORUS", "SUPERQ", "BEZIER", "SR_BEZIER", "SR_POLYLINE", "METABALL", "HEIGHTFIELD",
        "SCANNEROBJECT", "STRING_TTF3D", "CSG_UNION", "CSG_DIFF", "CSG_INTER", "ISOSURFACE",
        "BLINN_VOLUME", "LEVOY_VOLUME", "VOLDATA", "EXT", "POS_LIGHT", "SPOT_LIGHT", "DIST_LIGHT",
        "ATT_DIST_LIGHT", "DIST_SPOT_LIGHT", "ATT_DIST_SPOT_LIGHT", "OUTFORMAT", "TRIANGLESTRIP",
    };
    static const char *const surfaces[] = {
        "TEXTURE_2D", "TEXTURE_2D_TRANS", "TEXTURE_2D24BIT", "TEXTURE_2D24BIT_TRANS", "STEXTURE",
        "BUMP", "IBUMP", "RAND_BUMP", "RAND_IBUMP", "SINE_BUMP", "PNM_BUMP", "PNM_IBUMP",
    };
    enum { OBJECTS = sizeof objects / sizeof objects[0],
           SURFACES = sizeof surfaces / sizeof surfaces[0] };

    for (size_t i = 0; i < OBJECTS + SURFACES; i++) {
        char        text[100], expected[100];
        Error       err = { 0 };
        const char *word = i < OBJECTS ? objects[i] : surfaces[i - OBJECTS];
        snprintf(text, sizeof text, "%s%s 1 2 3", i < OBJECTS ? "" : "SURFACE 1 ", word);
        snprintf(expected, sizeof expected, "t.msd:1:%d: found %s, which is not built yet",
                 i < OBJECTS ? 1 : 11, word);
        assert_null(scene_parse_msd("t.msd", text, strlen(text), NULL, &err));
        if (strncmp(err.text, expected, strlen(expected)) != 0)
            fail_msg("told: %s\nexpected: %s", err.text, expected);
    }
}

/* Text that only repeats: 200 levels are allowed, a million are not, and none breaks the stack. */
static void nesting_is_limited(void **state)
{
    (void)state;
    static const char *const openings[] = { "BEGIN ",      "FLOAT a = (((",     "FLOAT a = -",
                                            "MATRIX m = (", "OBJECT o = BEGIN ", "DEF d " };
    static const char *const repeats[] = { "BEGIN ", "(", "-", "(", "OBJECT o = BEGIN ", "DEF d " };
    enum { MANY = 1000000 };

    for (size_t i = 0; i < sizeof openings / sizeof openings[0]; i++) {
        const size_t unit = strlen(repeats[i]), start = strlen(openings[i]);
        char        *text = malloc(start + MANY);
        Error        err = { 0 };
        assert_non_null(text);
        memcpy(text, openings[i], start);
        for (size_t k = 0; k < MANY; k++)
            text[start + k] = repeats[i][k % unit];
        assert_null(scene_parse_msd("t.msd", text, start + MANY, NULL, &err));
        assert_non_null(strstr(err.text, "nested more than 200 deep"));
        free(text);
    }
}

/* 10 ^ 9 spheres or as many empty blocks out of a few lines. */
static void repetition_is_limited(void **state)
{
    (void)state;
    static const char *const bodies[] = { "SPHERE 1 (0,0,0) 1", "" };
    static const char *const messages[] = { "faces; REF or INCLUDE may repeat too much",
                                            "REF and INCLUDE repeat more than" };
    for (int kind = 0; kind < 2; kind++) {
        char   text[4000];
        Error  err = { 0 };
        size_t n = (size_t)snprintf(text, sizeof text, WHITE "OBJECT a0 = BEGIN %s END;\n",
                                    bodies[kind]);
        for (int i = 1; i < 10; i++) {
            n += (size_t)snprintf(text + n, sizeof text - n, "OBJECT a%d = BEGIN", i);
            for (int k = 0; k < 10; k++)
                n += (size_t)snprintf(text + n, sizeof text - n, " REF a%d", i - 1);
            n += (size_t)snprintf(text + n, sizeof text - n, " END;\n");
        }
        n += (size_t)snprintf(text + n, sizeof text - n, "REF a9");
        assert_null(scene_parse_msd("t.msd", text, n, NULL, &err));
        if (strstr(err.text, messages[kind]) == NULL)
            fail_msg("%s", err.text);
        assert_int_equal(array_live(), 0);
    }
}

/* An object that is declared again around itself, and so would contain itself. */
static void an_object_cannot_contain_itself(void **state)
{
    (void)state;
    Error err = { 0 };
    static const char text[] = WHITE "OBJECT o = SPHERE 1 (0,0,0) 1;\n"
                                     "OBJECT o = BEGIN REF o END;\nREF o";
    assert_null(scene_parse_msd("t.msd", text, strlen(text), NULL, &err));
    assert_string_equal(err.text, "t.msd:3:22: OBJECT o contains itself");
}

static void bytes_of_any_kind_end_in_a_line(void **state)
{
    (void)state;
    static const char text[] = "FLOAT a\0 = 1;", quoted[] = "GROUP \"\xff\xfe\"";
    Error err = { 0 }, other = { 0 };

    assert_null(scene_parse_msd("t.msd", text, sizeof text - 1, NULL, &err));
    assert_string_equal(err.text,
                        "t.msd:1:8: found the byte 0x00, which is no part of the language");
    assert_null(scene_parse_msd("t.msd", quoted, sizeof quoted - 1, NULL, &other));
    assert_string_equal(other.text, "t.msd:1:7: found a string that is not UTF-8");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_text_is_told),
        cmocka_unit_test(words_not_built_name_themselves),
        cmocka_unit_test(nesting_is_limited),
        cmocka_unit_test(repetition_is_limited),
        cmocka_unit_test(an_object_cannot_contain_itself),
        cmocka_unit_test(bytes_of_any_kind_end_in_a_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
