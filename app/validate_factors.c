/* SPDX-License-Identifier: BSD-3-Clause */
/* Cases of validate: view factors in closed form, between surfaces and from a point.
 *
 * Numbers of configurations follow Howell's catalogue [howell]; the obstructed pairs were
 * integrated numerically to 5e-6. Strips without end are made 1e5 long, which takes about their
 * distance over their length off the factor: 1e-5. Surfaces are treated pair by pair
 * (radiosity/group_factors.h): a factor passes within four of its standard errors, and not more
 * than 2e-4 off in any case. From a point the tolerance is three standard errors
 * of as many independent rays, 3 sqrt(F (1 - F) / N); scrambled nets stay far below it.
 */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "app/model.h"
#include "app/validate.h"
#include "base/array.h"

enum { PATCHES = 300, PARTS = 3, POINT_RAYS = 32768, MOST_RAYS = 1 << 23 };

static const double PI = 3.14159265358979323846;

/* What is asked of a factor at quality high; its standard error is a third of it. */
static const double MOST_OFF = 2e-4, ERRORS_OFF = 4;

/* Sums of exact pairs are off by rounding, and so are the values expected. */
static const double ROUNDING = 1e-12;

/* Length of strips that stand for endless ones, and what that takes off at most. */
static const double STRIP = 1e5, STRIP_ERROR = 1e-5;

/* What obstructed pairs, those of three parts, were integrated to. */
static const double OBSTRUCTED_ERROR = 6e-6;

typedef struct {
    char   kind;       /* R rectangle: o u v; T triangle: corners; D disc facing up, d down: at
                        * r; */
    char   group[8];   /* P, p: in the disc's place a polygon of 48 corners; F frustum standing on
                        * at: at r h ratio; S sphere: at r; 0 none */
    double number[9];
} Part;

typedef struct {
    const char *name;
    Part        part[PARTS];
    const char *from, *to;         /* groups; the sides looked at: 0 front, 1 back */
    unsigned    from_side, to_side;
    double      factor;
} FactorRow;

static const FactorRow pairs[] = {
    { "parallel C-11 1x1x1", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 1, 0 } },
      { 'R', "b", { 0, 0, 1, 0, 1, 0, 1, 0, 0 } } }, "a", "b", 0, 0, 0.199824895698387 },
    { "parallel C-11 2x3x1.5", { { 'R', "a", { 0, 0, 0, 2, 0, 0, 0, 3, 0 } },
      { 'R', "b", { 0, 0, 1.5, 0, 3, 0, 2, 0, 0 } } }, "a", "b", 0, 0, 0.341693913524763 },
    { "perpendicular C-14 1,1", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 1, 0 } },
      { 'R', "b", { 0, 0, 0, 0, 1, 0, 0, 0, 1 } } }, "a", "b", 0, 0, 0.200043776075403 },
    { "perpendicular C-14 2,0.7", { { 'R', "a", { 0, 0, 0, 2, 0, 0, 0, 1.3, 0 } },
      { 'R', "b", { 0, 0, 0, 0, 1.3, 0, 0, 0, 0.7 } } }, "a", "b", 0, 0, 0.105121380065803 },
    { "offset parallel C-13", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 1, 0 } },
      { 'R', "b", { 1.5, 0.5, 0.8, 0, 1.5, 0, 1, 0, 0 } } }, "a", "b", 0, 0, 0.0340601532237438 },
    { "offset at right angle", { { 'R', "a", { 0.2, 0, 0, 0.8, 0, 0, 0, 1, 0 } },
      { 'R', "b", { 0, 1.5, 0.5, 0, 1, 0, 0, 0, 1.5 } } }, "a", "b", 0, 0, 0.0216457376307794 },
    { "touching at a corner", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 1, 0 } },
      { 'R', "b", { 0, 1, 0, 0, 1, 0, 0, 0, 1 } } }, "a", "b", 0, 0, 0.0405922301015587 },
    { "discs 1,1,1", { { 'D', "a", { 0, 0, 0, 1 } }, { 'D', "b", { 0, 0, 1, 1 } } },
      "a", "b", 0, 1, 0.381966011250105 },
    { "discs 1,2,0.5", { { 'D', "a", { 0, 0, 0, 1 } }, { 'D', "b", { 0, 0, 0.5, 2 } } },
      "a", "b", 0, 1, 0.92481618640807 },
    { "cylinder coat to itself", { { 'F', "a", { 0, 0, 0, 1, 2, 1 } } },
      "a", "a", 1, 1, 0.585786437626905 },
    { "cylinder coat to base", { { 'F', "a", { 0, 0, 0, 1, 2, 1 } }, { 'D', "b", { 0, 0, 0, 1 } } },
      "a", "b", 1, 0, 0.207106781186548 },
    { "cylinder base to coat", { { 'F', "a", { 0, 0, 0, 1, 2, 1 } }, { 'D', "b", { 0, 0, 0, 1 } } },
      "b", "a", 0, 1, 0.82842712474619 },
    { "cylinders outer to inner", { { 'F', "a", { 0, 0, 0, 2, 3, 1 } },
      { 'F', "b", { 0, 0, 0, 1, 3, 1 } } }, "a", "b", 1, 0, 0.385759490506001 },
    { "cylinders outer to itself", { { 'F', "a", { 0, 0, 0, 2, 3, 1 } },
      { 'F', "b", { 0, 0, 0, 1, 3, 1 } } }, "a", "a", 1, 1, 0.288183992933566 },
    { "cone to base", { { 'F', "a", { 0, 0, 0, 1, 2, 0 } }, { 'D', "b", { 0, 0, 0, 1 } } },
      "a", "b", 1, 0, 0.447213595499958 },
    { "frustum to itself", { { 'F', "a", { 0, 0, 0, 1, 1, 0.5 } } },
      "a", "a", 1, 1, 0.394434368845281 },
    { "sphere to disc", { { 'S', "a", { 0, 0, 0.7, 0.4 } }, { 'D', "b", { 0, 0, 0, 1 } } },
      "a", "b", 0, 0, 0.213268827818336 },
    { "sphere to rectangle", { { 'S', "a", { 0, 0, 0.5, 0.2 } },
      { 'R', "b", { 0, 0, 0, 1, 0, 0, 0, 2, 0 } } }, "a", "b", 0, 0, 0.083604126700922 },
    { "spheres inner to outer", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 2 } } },
      "a", "b", 0, 1, 1 },
    { "spheres outer to inner", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 2 } } },
      "b", "a", 1, 0, 0.25 },
    { "squares, plate between", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 1, 0 } },
      { 'R', "b", { 0, 0, 1, 0, 1, 0, 1, 0, 0 } },
      { 'R', "plate", { 0.25, 0.25, 0.5, 0.5, 0, 0, 0, 0.5, 0 } } },
      "a", "b", 0, 0, 0.099506294598985 },
    { "squares, plate in a corner", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 1, 0 } },
      { 'R', "b", { 0, 0, 1, 0, 1, 0, 1, 0, 0 } },
      { 'R', "plate", { 0, 0, 0.5, 0.5, 0, 0, 0, 0.5, 0 } } },
      "a", "b", 0, 0, 0.14986842 },
    { "discs, disc between", { { 'D', "a", { 0, 0, 0, 1 } }, { 'D', "b", { 0, 0, 1, 1 } },
      { 'D', "plate", { 0, 0, 0.5, 0.4 } } }, "a", "b", 0, 1, 0.267086060113232 },
    { "squares, all hidden", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 1, 0 } }, { 'R', "b", { 0, 1, 1,
      1, 0, 0, 0, -1, 0 } }, { 'R', "plate", { -1, -1, 0.5, 3, 0, 0, 0, 3, 0 } } }, "a", "b", 0,
      0, 0 },
    { "cylinders 0.125, 0.25 1 to 2", { { 'F', "a", { 0, 0, 0, 0.125, 1, 1 } }, { 'F', "b", {
      0, 0, 0, 0.25, 1, 1 } } }, "a", "b", 0, 1, 0.910868433007748 },
    { "cylinders 0.125, 0.25 2 to 1", { { 'F', "a", { 0, 0, 0, 0.125, 1, 1 } }, { 'F', "b", {
      0, 0, 0, 0.25, 1, 1 } } }, "b", "a", 1, 0, 0.455434216503874 },
    { "cylinders 0.125, 0.25 2 to 2", { { 'F', "a", { 0, 0, 0, 0.125, 1, 1 } }, { 'F', "b", {
      0, 0, 0, 0.25, 1, 1 } } }, "b", "b", 1, 1, 0.40590421046054 },
    { "cylinders 0.5, 0.75 1 to 2", { { 'F', "a", { 0, 0, 0, 0.5, 1, 1 } }, { 'F', "b", { 0,
      0, 0, 0.75, 1, 1 } } }, "a", "b", 0, 1, 0.816594634814723 },
    { "cylinders 0.5, 0.75 2 to 1", { { 'F', "a", { 0, 0, 0, 0.5, 1, 1 } }, { 'F', "b", { 0,
      0, 0, 0.75, 1, 1 } } }, "b", "a", 1, 0, 0.544396423209815 },
    { "cylinders 0.5, 0.75 2 to 2", { { 'F', "a", { 0, 0, 0, 0.5, 1, 1 } }, { 'F', "b", { 0,
      0, 0, 0.75, 1, 1 } } }, "b", "b", 1, 1, 0.197784042341018 },
    { "cylinders 10, 32 1 to 2", { { 'F', "a", { 0, 0, 0, 10, 1, 1 } }, { 'F', "b", { 0, 0,
      0, 32, 1, 1 } } }, "a", "b", 0, 1, 0.0270778327587335 },
    { "cylinders 10, 32 2 to 1", { { 'F', "a", { 0, 0, 0, 10, 1, 1 } }, { 'F', "b", { 0, 0,
      0, 32, 1, 1 } } }, "b", "a", 1, 0, 0.00846182273710422 },
    { "cylinders 10, 32 2 to 2", { { 'F', "a", { 0, 0, 0, 10, 1, 1 } }, { 'F', "b", { 0, 0,
      0, 32, 1, 1 } } }, "b", "b", 1, 1, 0.0123417525594984 },
    { "cylinders 2, 3 1 to 2", { { 'F', "a", { 0, 0, 0, 2, 1, 1 } }, { 'F', "b", { 0, 0, 0,
      3, 1, 1 } } }, "a", "b", 0, 1, 0.451113669487758 },
    { "cylinders 2, 3 2 to 1", { { 'F', "a", { 0, 0, 0, 2, 1, 1 } }, { 'F', "b", { 0, 0, 0,
      3, 1, 1 } } }, "b", "a", 1, 0, 0.300742446325172 },
    { "cylinders 2, 3 2 to 2", { { 'F', "a", { 0, 0, 0, 2, 1, 1 } }, { 'F', "b", { 0, 0, 0,
      3, 1, 1 } } }, "b", "b", 1, 1, 0.0763070400222525 },
    { "discs 0.2, 10", { { 'D', "a", { 0, 0, 0, 0.2 } }, { 'D', "b", { 0, 0, 1, 10 } } }, "a",
      "b", 0, 1, 0.990095126032656 },
    { "48-gons 0.2, 10", { { 'P', "a", { 0, 0, 0, 0.2 } }, { 'p', "b", { 0, 0, 1, 10 } } }, "a",
      "b", 0, 0, 0.99006704888 },
    { "discs 10, 2", { { 'D', "a", { 0, 0, 0, 10 } }, { 'D', "b", { 0, 0, 1, 2 } } }, "a", "b", 0,
      1, 0.0395878040263101 },
    { "48-gons 10, 2", { { 'P', "a", { 0, 0, 0, 10 } }, { 'p', "b", { 0, 0, 1, 2 } } }, "a", "b",
      0, 0, 0.039586636466 },
    { "discs 2, 2", { { 'D', "a", { 0, 0, 0, 2 } }, { 'D', "b", { 0, 0, 1, 2 } } }, "a", "b", 0,
      1, 0.609611796797792 },
    { "48-gons 2, 2", { { 'P', "a", { 0, 0, 0, 2 } }, { 'p', "b", { 0, 0, 1, 2 } } }, "a", "b", 0,
      0, 0.609188437323 },
    { "discs 8, 8", { { 'D', "a", { 0, 0, 0, 8 } }, { 'D', "b", { 0, 0, 1, 8 } } }, "a", "b", 0,
      1, 0.882568597329052 },
    { "48-gons 8, 8", { { 'P', "a", { 0, 0, 0, 8 } }, { 'p', "b", { 0, 0, 1, 8 } } }, "a", "b", 0,
      0, 0.882407997087 },
    { "squares apart, side 0.2", { { 'R', "a", { 0, 0, 0, 0.2, 0, 0, 0, 0.2, 0 } }, { 'R', "b", {
      0, 0.2, 1, 0.2, 0, 0, 0, -0.2, 0 } } }, "a", "b", 0, 0, 0.0124039773132431 },
    { "squares apart, side 0.6", { { 'R', "a", { 0, 0, 0, 0.6, 0, 0, 0, 0.6, 0 } }, { 'R', "b", {
      0, 0.6, 1, 0.6, 0, 0, 0, -0.6, 0 } } }, "a", "b", 0, 0, 0.0933623378406498 },
    { "squares apart, side 10", { { 'R', "a", { 0, 0, 0, 10, 0, 0, 0, 10, 0 } }, { 'R', "b", { 0,
      10, 1, 10, 0, 0, 0, -10, 0 } } }, "a", "b", 0, 0, 0.826994522397256 },
    { "squares apart, side 4", { { 'R', "a", { 0, 0, 0, 4, 0, 0, 0, 4, 0 } }, { 'R', "b", { 0, 4,
      1, 4, 0, 0, 0, -4, 0 } } }, "a", "b", 0, 0, 0.63203643001386 },
    { "rectangles 2 by 1", { { 'R', "a", { 0, 0, 0, 2, 0, 0, 0, 1, 0 } }, { 'R', "b", { 0, 1, 1,
      2, 0, 0, 0, -1, 0 } } }, "a", "b", 0, 0, 0.285875384850715 },
    { "apart at 90, 0.1, 1", { { 'R', "a", { 0, 0.1, 0, 1, 0, 0, 0, 0.1, 0 } }, { 'R', "b", { 0,
      0, 0.1, 0, 0, 1, 1, 0, 0 } } }, "a", "b", 0, 0, 0.264776412027033 },
    { "apart at 90, 10, 1", { { 'R', "a", { 0, 0.1, 0, 1, 0, 0, 0, 10, 0 } }, { 'R', "b", { 0, 0,
      0.1, 0, 0, 1, 1, 0, 0 } } }, "a", "b", 0, 0, 0.0203394241933138 },
    { "apart at 90, 1, 1", { { 'R', "a", { 0, 0.1, 0, 1, 0, 0, 0, 1, 0 } }, { 'R', "b", { 0, 0,
      0.1, 0, 0, 1, 1, 0, 0 } } }, "a", "b", 0, 0, 0.154206868494109 },
    { "apart at 90, 4, 4", { { 'R', "a", { 0, 0.1, 0, 1, 0, 0, 0, 4, 0 } }, { 'R', "b", { 0, 0,
      0.1, 0, 0, 4, 1, 0, 0 } } }, "a", "b", 0, 0, 0.0874239131457593 },
    { "at right angle, 0.2", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 0.2, 0 } }, { 'R', "b", { 0, 0,
      0, 0, 0, 0.2, 1, 0, 0 } } }, "a", "b", 0, 0, 0.271036935697358 },
    { "at right angle, 0.6", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 0.6, 0 } }, { 'R', "b", { 0, 0,
      0, 0, 0, 0.6, 1, 0, 0 } } }, "a", "b", 0, 0, 0.231469999626555 },
    { "at right angle, 10", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 10, 0 } }, { 'R', "b", { 0, 0, 0,
      0, 0, 10, 1, 0, 0 } } }, "a", "b", 0, 0, 0.0550239795284106 },
    { "at right angle, 4", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 4, 0 } }, { 'R', "b", { 0, 0, 0,
      0, 0, 4, 1, 0, 0 } } }, "a", "b", 0, 0, 0.101358700221681 },
    { "spheres 1, 1.5 1 to 2", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 1.5 } }
      }, "a", "b", 0, 1, 1 },
    { "spheres 1, 1.5 2 to 1", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 1.5 } }
      }, "b", "a", 1, 0, 0.444444444444444 },
    { "spheres 1, 1.5 2 to 2", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 1.5 } }
      }, "b", "b", 1, 1, 0.555555555555556 },
    { "spheres 1, 3 1 to 2", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 3 } } },
      "a", "b", 0, 1, 1 },
    { "spheres 1, 3 2 to 1", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 3 } } },
      "b", "a", 1, 0, 0.111111111111111 },
    { "spheres 1, 3 2 to 2", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 3 } } },
      "b", "b", 1, 1, 0.888888888888889 },
    { "spheres outer to itself", { { 'S', "a", { 0, 0, 0, 1 } }, { 'S', "b", { 0, 0, 0, 2 } } },
      "b", "b", 1, 1, 0.75 },
    { "cylinder base to base", { { 'D', "a", { 0, 0, 0, 1 } }, { 'D', "b", { 0, 0, 2, 1 } } },
      "a", "b", 0, 1, 0.17157287525381 },
    { "strips, 0.7 apart", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 100000, 0 } }, { 'R', "b", { 1, 0,
      0.7, -1, 0, 0, 0, 100000, 0 } } }, "a", "b", 0, 0, 0.52065556157337 },
    { "strips, plate between", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 100000, 0 } }, { 'R', "b", {
      1, 0, 0.7, -1, 0, 0, 0, 100000, 0 } }, { 'R', "plate", { 0.3, 0, 0.35, 0.4, 0, 0, 0, 100000,
      0 } } }, "a", "b", 0, 0, 0.221954445729289 },
    { "wedge of 50 degrees", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 100000, 0 } }, { 'R', "b", { 0,
      0, 0, 0, 100000, 0, 0.964181414529809, 0, 1.14906666467847 } } }, "a", "b", 0, 0,
      0.675187602138667 },
    { "duct of 3, 4 and 5", { { 'R', "a", { 0, 0, 0, 3, 0, 0, 0, 100000, 0 } }, { 'R', "b", { 3,
      0, 0, -3, 0, 4, 0, 100000, 0 } }, { 'R', "plate", { 0, 0, 4, 0, 0, -4, 0, 100000, 0 } } },
      "a", "plate", 0, 0, 0.333333333333333 },
    { "crossed strings", { { 'R', "a", { 0, 0, 0, 1, 0, 0, 0, 100000, 0 } }, { 'R', "b", { 1.5, 0,
      1, -0.3, 0, 1, 0, 100000, 0 } } }, "a", "b", 0, 0, 0.181168007634078 },
};

static Vec3 vector(const double *v)
{
    return vec3(v[0], v[1], v[2]);
}

static void add_gon(Scene *scene, Vec3 at, double radius, bool up, uint32_t material,
                    const char *group, Error *err)
{
    enum { CORNERS = 48 };
    Vec3 corner[CORNERS];
    for (int k = 0; k < CORNERS; k++) {
        const double angle = 2 * PI * k / CORNERS * (up ? 1 : -1);
        corner[k] = vec3_add(at, vec3(radius * cos(angle), radius * sin(angle), 0));
    }
    model_polygon(scene, corner, CORNERS, material, group, err);
}

static void add_part(Scene *scene, const Part *part, uint32_t material, Error *err)
{
    const double *n = part->number, r = n[3];
    const Vec3 at = vector(n);
    switch (part->kind) {
    case 'R':
        model_rectangle(scene, at, vector(n + 3), vector(n + 6), material, part->group, err);
        break;
    case 'T': {
        const Vec3 corner[] = { at, vector(n + 3), vector(n + 6) };
        model_polygon(scene, corner, 3, material, part->group, err);
        break;
    }
    case 'P':
    case 'p':
        add_gon(scene, at, r, part->kind == 'P', material, part->group, err);
        break;
    case 'D':
    case 'd':
        model_shape(scene, SHAPE_DISC, 0, at, vec3(r, r, part->kind == 'D' ? 1 : -1), material,
                    part->group, err);
        break;
    case 'F':
        model_shape(scene, SHAPE_FRUSTUM, n[5], at, vec3(r, r, n[4]), material, part->group, err);
        break;
    case 'S':
        model_shape(scene, SHAPE_SPHERE, 0, at, vec3(r, r, r), material, part->group, err);
        break;
    default:
        assert(!"a part of a known kind");
    }
}

static Scene *make_scene(const char *name, const Part *parts, double exitance, Error *err)
{
    Scene *scene = scene_create(name, err);
    if (scene == NULL)
        return NULL;
    const uint32_t material = model_grey(scene, "black", 0, exitance, err);
    for (int i = 0; i < PARTS && parts[i].kind != 0; i++)
        add_part(scene, &parts[i], material, err);
    return scene;
}

/* --- from surface to surface ------------------------------------------------------------------ */

/* A class for each side of each group. */
static uint32_t side_class(const Pipeline *pipeline, const char *group, unsigned side)
{
    const Polygons *soup = &pipeline->scene->polygons;
    uint32_t g = 0;
    while (g < soup->group_count && strcmp(soup->group_name[g], group) != 0)
        g++;
    assert(g < soup->group_count);
    return 2 * g + side;
}

static GroupFactors *find_factors(const Pipeline *pipeline, Error *err)
{
    const Patches *patches = pipeline->patches;
    uint32_t *class = array_create(patches->count, sizeof *class, "sides of groups", err);
    if (class == NULL)
        return NULL;
    for (uint32_t i = 0; i < patches->count; i++)
        class[i] = 2 * patches->group[i] + patches->side[i];
    const GroupOptions options = {
        .count = 2 * (uint32_t)pipeline->scene->polygons.group_count, .patch_class = class,
        .accuracy = MOST_OFF / 3, .most_rays = MOST_RAYS,
        .seed = pipeline->session->settings.seed, .threads = pipeline->session->settings.threads };
    GroupFactors *factors = group_factors_create(&pipeline->room, &options,
                                                 &pipeline->session->monitor, err);
    array_free(class);
    return factors;
}

typedef struct {
    uint32_t from, to; /* classes */
    double   factor;
} Pair;

/* known: the standard error of the factor that is expected. */
static void check_value(Validation *validation, const char *quantity, const GroupFactors *factors,
                        Pair pair, double known, Error *err)
{
    const double error = hypot(group_factor_error(factors, pair.from, pair.to), known);
    validation_check(validation, quantity, pair.factor, group_factor(factors, pair.from, pair.to),
                     fmin(ERRORS_OFF * error, MOST_OFF), error, err);
}

/* Rows from `begin` to `end`, of the same surfaces. */
static void check_rows(Validation *validation, const Pipeline *pipeline, size_t begin, size_t end,
                       Error *err)
{
    GroupFactors *factors = find_factors(pipeline, err);
    for (size_t i = begin; factors != NULL && i < end; i++) {
        const FactorRow *row = &pairs[i];
        const uint32_t from = side_class(pipeline, row->from, row->from_side);
        const uint32_t to = side_class(pipeline, row->to, row->to_side);
        const double known = row->part[0].number[7] >= STRIP  ? STRIP_ERROR
                             : row->part[PARTS - 1].kind != 0 ? OBSTRUCTED_ERROR
                                                              : ROUNDING;
        check_value(validation, row->name, factors, (Pair){ from, to, row->factor }, known, err);
    }
    group_factors_destroy(factors);
}

static bool same_parts(const FactorRow *a, const FactorRow *b)
{
    for (int i = 0; i < PARTS; i++) {
        const Part *p = &a->part[i], *q = &b->part[i];
        if (p->kind != q->kind || strcmp(p->group, q->group) != 0 ||
            memcmp(p->number, q->number, sizeof p->number) != 0)
            return false;
    }
    return true;
}

static bool run_pairs(Validation *validation, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_FACTORS, .sides = USE_BOTH, .patches = PATCHES,
                              .patches_only = true };
    for (size_t i = 0, end; i < sizeof pairs / sizeof *pairs && !error_is_set(err); i = end) {
        for (end = i + 1; end < sizeof pairs / sizeof *pairs; end++)
            if (!same_parts(&pairs[i], &pairs[end]))
                break;
        Session session;
        Pipeline pipeline;
        Scene *scene = make_scene(pairs[i].name, pairs[i].part, 0, err);
        if (validation_run(validation, scene, &setup, &session, &pipeline, err))
            check_rows(validation, &pipeline, i, end, err);
        validation_end(&session, &pipeline);
    }
    return !error_is_set(err);
}

/* --- a cube with a plate in it ---------------------------------------------------------------- */

/* The eight surfaces that view-factor programs have been compared on since 1983 (FACET,
 * UCID-19887); values are means of independent ray casting over pairs that are alike, to 2e-5. */
static const double FACET_ERROR = 2e-5;

static const struct {
    const char *quantity, *from, *to;
    unsigned    from_side, to_side;
    double      factor;
} facet_pairs[] = {
    { "wall to next wall", "z0", "x1", 0, 0, 0.19744215 },
    { "wall to opposite wall", "z0", "z1", 0, 0, 0.17933141 },
    { "wall to wall behind plate", "z0", "y1", 0, 0, 0.17143910 },
    { "wall to wall before plate", "z0", "y0", 0, 0, 0.20004378 },
    { "wall to plate's front", "z0", "plate", 0, 0, 0.04144541 },
    { "wall to plate's back", "z0", "plate", 0, 1, 0.01284554 },
    { "past the plate", "y1", "y0", 0, 0, 0.11562759 },
    { "wall behind to plate", "y1", "plate", 0, 1, 0.19861693 },
    { "plate's back to wall behind", "plate", "y1", 1, 0, 0.79446435 },
    { "plate's front to wall", "plate", "y0", 0, 0, 0.33682334 },
    { "plate's front to floor", "plate", "z0", 0, 0, 0.16579402 },
};

static bool run_facet(Validation *validation, Error *err)
{
    const CaseSetup setup = { .command = COMMAND_FACTORS, .sides = USE_BOTH, .patches = PATCHES,
                              .patches_only = true };
    Session session;
    Pipeline pipeline;
    Scene *scene = scene_create("facet", err);
    if (scene != NULL) {
        const uint32_t m = model_grey(scene, "black", 0, 0, err);
        model_box(scene, vec3(1, 1, 1), (uint32_t[]){ m, m, m, m, m, m }, err);
        model_rectangle(scene, vec3(0.25, 0.75, 0.25), vec3(0.5, 0, 0), vec3(0, 0, 0.5), m,
                        "plate", err);
    }
    GroupFactors *factors = NULL;
    if (validation_run(validation, scene, &setup, &session, &pipeline, err))
        factors = find_factors(&pipeline, err);
    for (size_t i = 0; factors != NULL && i < sizeof facet_pairs / sizeof *facet_pairs; i++) {
        const Pair pair = {
            side_class(&pipeline, facet_pairs[i].from, facet_pairs[i].from_side),
            side_class(&pipeline, facet_pairs[i].to, facet_pairs[i].to_side),
            facet_pairs[i].factor };
        check_value(validation, facet_pairs[i].quantity, factors, pair, FACET_ERROR, err);
    }
    group_factors_destroy(factors);
    validation_end(&session, &pipeline);
    return !error_is_set(err);
}

/* --- from a point ----------------------------------------------------------------------------- */

typedef struct {
    const char *name;
    Part        part;
    double      normal[3]; /* of the element at the origin */
    double      factor;
} ElementRow;

static const ElementRow elements[] = {
    { "below a rectangle B-3", { 'R', "a", { 0, 0, 0.7, 0, 2, 0, 1, 0, 0 } }, { 0, 0, 1 },
      0.199597720423871 },
    { "before a rectangle B-4", { 'R', "a", { 0, 0.7, 0, 1.2, 0, 0, 0, 0, 0.9 } }, { 0, 0, 1 },
      0.0867143931927342 },
    { "below a triangle", { 'T', "a", { 1, 0.5, 1, -0.8, -1, 0.9, -0.5, 1.2, 1.3 } }, { 0, 0, 1 },
      0.290156869928177 },
    { "disc on the axis", { 'd', "a", { 0, 0, 1.1, 0.8 } }, { 0, 0, 1 }, 0.345945945945946 },
    { "disc off the axis", { 'd', "a", { 0.6, 0, 1.1, 0.8 } }, { 0, 0, 1 }, 0.266402432923952 },
    { "disc at right angle", { 'd', "a", { 0.9, 0, 0.6, 0.5 } }, { 1, 0, 0 }, 0.0976112490981276 },
    { "sphere, tilt 0.3", { 'S', "a", { 0, 0, 2, 1 } },
      { 0.29552020666133955, 0, 0.95533648912560598 }, 0.238834122281401 },
    { "sphere, tilt 1.3", { 'S', "a", { 0, 0, 2, 1 } },
      { 0.96355818541719296, 0, 0.26749882862458741 }, 0.072122897951005 },
};

/* A surface that emits 1 and nothing else: the irradiance at the point is the factor. */
static bool run_elements(Validation *validation, Error *err)
{
    for (size_t i = 0; i < sizeof elements / sizeof *elements && !error_is_set(err); i++) {
        const ElementRow *row = &elements[i];
        const Part parts[PARTS] = { row->part };
        const Vec3 point = vec3(0, 0, 0), normal = vector(row->normal);
        const CaseSetup setup = { .command = COMMAND_SOLVE, .patches = PATCHES, .rays = 64,
                                  .point = &point, .normal = &normal, .points = 1 };
        const double f = row->factor;
        Session session;
        Pipeline pipeline;
        Scene *scene = make_scene(row->name, parts, 1, err);
        double error = NAN;
        if (validation_run(validation, scene, &setup, &session, &pipeline, err)) {
            const double value = validation_measure(&pipeline, point, normal, &error, err);
            validation_check(validation, row->name, f, value, 3 * sqrt(f * (1 - f) / POINT_RAYS),
                             error, err);
        }
        validation_end(&session, &pipeline);
    }
    return !error_is_set(err);
}

const Case *validate_factor_cases(size_t *count)
{
    static const Case cases[] = {
        { "factors", "view factors between surfaces", run_pairs },
        { "facet", "a cube with a plate in it", run_facet },
        { "factors-point", "view factors from a point", run_elements },
    };
    *count = sizeof cases / sizeof *cases;
    return cases;
}
