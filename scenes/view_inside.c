/* SPDX-License-Identifier: BSD-3-Clause */
/* A place to stand in a room: candidates all over the box, judged by how much and how far one sees.
 *
 * A candidate stands between a floor and a ceiling at eye height, in free air, and nearly all
 * directions from it end at something. Of the best enclosed ones the view is taken that sees
 * furthest on the average of its picture.
 */
#include <assert.h>
#include <math.h>

#include "scenes/view_rays.h"

/* Candidates along each level axis, and upward: storeys are found by starting at many heights. */
#define LEVEL_GRID 20
#define HEIGHT_GRID 7
/* Directions all round that judge a place; level directions of view; rays per edge of a picture. */
#define AROUND 48
#define VIEWS 24
#define PICTURE_GRID 14
/* Places whose views are tried. */
#define BEST 48

/* Eyes are at 1.5 of 2.7 m. */
static const double eye_share = 0.55;
/* Whole angle: what a wide lens for rooms sees. */
static const double inside_fov = 60;
/* Nothing may be nearer to the eye than this share of the room's height. */
static const double free_share = 0.12;
/* Share of directions that must end at something: windows and doors may be open. */
static const double enclosed_share = 0.85;

/* A bend of 1 / depth by this share of it is an edge: walls are flat to rounding, and a corner of
 * 90 degrees bends it by about the angle between pixels, 60 / PICTURE_GRID degrees. */
static const double bend_share = 0.01;
/* Hollows behind walls show nearly nothing but backs; files that wind their faces either way show
 * as many fronts as backs, give or take: from this share of fronts on nothing is held against a
 * place, below it falls to the other. */
static const double mixed_fronts = 0.35, hollow_worth = 0.1;
/* What is further than so many heights of the room counts as no further. */
static const double far_share = 3;
/* An empty room is worth this share of one full of things. */
static const double plain_worth = 0.1;

typedef struct {
    Vec3   eye;
    double height;       /* of the room here */
    double fronts;       /* factor for what seeing backs takes off */
    double worth;        /* mean sight all round, times `fronts` */
} Place;

/* Even directions on the sphere by the golden angle [saff97]. */
static Vec3 around(int i)
{
    const double z = 1 - (2 * i + 1.0) / AROUND;
    const double turn = i * M_PI * (3 - sqrt(5.0));
    const double r = sqrt(fmax(0, 1 - z * z));
    return vec3(r * cos(turn), r * sin(turn), z);
}

/* What it is worth to see so far. A window that shows a distant hill makes no great room. */
static double sight_worth(const Place *place, double sight)
{
    return isfinite(sight) ? fmin(sight, far_share * place->height) : 0;
}

/* What a place is worth of whose sights the share `fronts` ends at fronts. */
static double fronts_worth(double fronts)
{
    return fmin(fmax(fronts / mixed_fronts, hollow_worth), 1);
}

/* Judges the place above the floor under p; false when nobody can stand there. */
static bool place_judge(const ViewBox *box, Vec3 p, Place *place)
{
    const Vec3 up = viewbox_axis(box->up, box->sense), down = vec3_scale(up, -1);
    const double below = viewbox_sight(box, p, down), above = viewbox_sight(box, p, up);
    double met = 0, fronts = 0, nearest = INFINITY;

    if (!isfinite(below) || !isfinite(above))
        return false;
    place->height = below + above;
    place->eye = vec3_mad(p, eye_share * place->height - below, up);
    place->worth = 0;
    for (int i = 0; i < AROUND; i++) {
        bool front;
        const double sight = viewbox_look(box, place->eye, around(i), &front);
        met += isfinite(sight) ? 1.0 / AROUND : 0;
        fronts += isfinite(sight) && front ? 1.0 / AROUND : 0;
        nearest = fmin(nearest, sight);
        place->worth += sight_worth(place, sight) / AROUND;
    }
    place->fronts = met > 0 ? fronts_worth(fronts / met) : 0;
    place->worth *= place->fronts;
    return place->height > 0 && met >= enclosed_share && nearest >= free_share * place->height;
}

/* Keeps the BEST places of greatest worth, in order; equal ones as they came. */
static void place_keep(Place *best, int *count, const Place *place)
{
    int at = *count;

    while (at > 0 && best[at - 1].worth < place->worth)
        at--;
    if (at >= BEST)
        return;
    if (*count < BEST)
        (*count)++;
    for (int i = *count - 1; i > at; i--)
        best[i] = best[i - 1];
    best[at] = *place;
}

static int places_find(const ViewBox *box, Place best[BEST])
{
    int count = 0;

    for (int k = 0; k < HEIGHT_GRID; k++)
        for (int j = 0; j < LEVEL_GRID; j++)
            for (int i = 0; i < LEVEL_GRID; i++) {
                Place place;
                const Vec3 p = viewbox_point(box, (i + 0.5) / LEVEL_GRID, (j + 0.5) / LEVEL_GRID,
                                             (k + 0.5) / HEIGHT_GRID);
                if (place_judge(box, p, &place))
                    place_keep(best, &count, &place);
            }
    return count;
}

/* Whether three depths in a row of a picture do not lie on one plane: there 1 / depth would run
 * straight. Furniture, corners and openings bend it, however finely a wall is cut. */
static bool bent(const double *inverse, int step)
{
    const double middle = inverse[0];
    return fabs(inverse[-step] - 2 * middle + inverse[step]) > bend_share * middle;
}

/* Share of the inner pixels at which something bends, along the rows or the columns. */
static double picture_detail(double inverse[PICTURE_GRID][PICTURE_GRID])
{
    const int inner = PICTURE_GRID - 2;
    int found = 0;

    for (int j = 1; j <= inner; j++)
        for (int i = 1; i <= inner; i++)
            found += bent(&inverse[j][i], 1) || bent(&inverse[j][i], PICTURE_GRID);
    return (double)found / (inner * inner);
}

/* What a square picture along the level direction d is worth: how far it sees on the average,
 * times how much there is to see. Things right before the eye hide the room: they count against. */
static double view_worth(const ViewBox *box, const Place *place, Vec3 d)
{
    const Vec3 up = viewbox_axis(box->up, box->sense), right = vec3_cross(d, up);
    const double half = tan(inside_fov / 2 * M_PI / 180);
    double inverse[PICTURE_GRID][PICTURE_GRID], worth = 0;

    for (int j = 0; j < PICTURE_GRID; j++)
        for (int i = 0; i < PICTURE_GRID; i++) {
            const double x = half * ((2 * i + 1.0) / PICTURE_GRID - 1);
            const double y = half * ((2 * j + 1.0) / PICTURE_GRID - 1);
            const Vec3 ray = vec3_mad(vec3_mad(d, x, right), y, up); /* its t is the depth */
            const double depth = viewbox_sight(box, place->eye, ray);
            inverse[j][i] = 1 / fmax(depth, box->offset);
            worth += depth < place->height / 2 ? -place->height
                                               : sight_worth(place, depth);
        }
    worth *= place->fronts / (PICTURE_GRID * PICTURE_GRID);
    return worth * (plain_worth + picture_detail(inverse));
}

bool view_inside(const ViewBox *box, Camera *camera)
{
    assert(box != NULL && camera != NULL);
    Place best[BEST];
    const int count = places_find(box, best);
    double greatest = -INFINITY;

    for (int i = 0; i < count; i++)
        for (int k = 0; k < VIEWS; k++) {
            const double turn = 2 * M_PI * k / VIEWS;
            const Vec3 d = vec3_add(viewbox_axis(box->a, cos(turn)),
                                    viewbox_axis(box->b, sin(turn)));
            const double worth = view_worth(box, &best[i], d);
            if (!(worth > greatest))
                continue;
            greatest = worth;
            camera->eye = best[i].eye;
            camera->target = vec3_mad(best[i].eye, fmax(best[i].worth, box->offset), d);
        }
    camera->vertical_fov = inside_fov;
    return count > 0;
}
