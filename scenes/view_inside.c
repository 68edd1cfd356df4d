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
/* Directions all round for judging a place; level directions of view; rays per edge of a picture. */
#define AROUND 48
#define VIEWS 24
#define PICTURE_GRID 8
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

typedef struct {
    Vec3   eye;
    double height;       /* of the room here */
    double worth;        /* mean sight all round */
} Place;

/* Even directions on the sphere by the golden angle [saff97]. */
static Vec3 around(int i)
{
    const double z = 1 - (2 * i + 1.0) / AROUND;
    const double turn = i * M_PI * (3 - sqrt(5.0));
    const double r = sqrt(fmax(0, 1 - z * z));
    return vec3(r * cos(turn), r * sin(turn), z);
}

/* Far sights count less and less: a hole in a wall that shows a distant hill is no great room. */
static double sight_worth(const ViewBox *box, double sight)
{
    return isfinite(sight) ? fmin(sight, box->diagonal) : 0;
}

/* Judges the place above the floor under p; false when nobody can stand there. */
static bool place_judge(const ViewBox *box, Vec3 p, Place *place)
{
    const Vec3 up = viewbox_axis(box->up, box->sense), down = vec3_scale(up, -1);
    const double below = viewbox_sight(box, p, down), above = viewbox_sight(box, p, up);
    double met = 0, nearest = INFINITY;

    if (!isfinite(below) || !isfinite(above))
        return false;
    place->height = below + above;
    place->eye = vec3_mad(p, eye_share * place->height - below, up);
    place->worth = 0;
    for (int i = 0; i < AROUND; i++) {
        const double sight = viewbox_sight(box, place->eye, around(i));
        met += isfinite(sight) ? 1.0 / AROUND : 0;
        nearest = fmin(nearest, sight);
        place->worth += sight_worth(box, sight) / AROUND;
    }
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

/* Mean worth of what a square picture along the level direction d shows; things right before the
 * eye hide the room, so they count against the view. */
static double view_worth(const ViewBox *box, const Place *place, Vec3 d)
{
    const Vec3 up = viewbox_axis(box->up, box->sense), right = vec3_cross(d, up);
    const double half = tan(inside_fov / 2 * M_PI / 180);
    double worth = 0;

    for (int j = 0; j < PICTURE_GRID; j++)
        for (int i = 0; i < PICTURE_GRID; i++) {
            const double x = half * ((2 * i + 1.0) / PICTURE_GRID - 1);
            const double y = half * ((2 * j + 1.0) / PICTURE_GRID - 1);
            const Vec3 ray = vec3_unit(vec3_mad(vec3_mad(d, x, right), y, up));
            const double sight = viewbox_sight(box, place->eye, ray);
            worth += sight < place->height / 2 ? -place->height : sight_worth(box, sight);
        }
    return worth / (PICTURE_GRID * PICTURE_GRID);
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
