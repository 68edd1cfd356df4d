/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/measuring.h -- what the window measures and shows in false colours: its state.
 *
 * Threads  the window's.
 */
#ifndef VIEWER_MEASURING_H
#define VIEWER_MEASURING_H

#include "viewer/false_map.h"
#include "viewer/layers.h"
#include "viewer/measure_plane.h"

struct Viewer;

typedef enum { GRIP_NONE, GRIP_LOW, GRIP_HIGH, GRIP_BOTH, GRIP_REGION } Grip;

/* A rectangle of pixels. */
typedef struct {
    double x0, y0, x1, y1;
} Frame;

typedef struct Measuring {
    bool       on;              /* false colours in place of the picture */
    ShownLayer layer;
    FalseMap   map;
    float     *value;           /* [patches]  of the layer */
    float     *vertex;          /* [vertices]  the same, carried to vertices */
    float     *factors;         /* [patches]  of factors_of, or NULL */
    uint32_t   factors_of;
    bool       stale;           /* the card does not hold them yet */
    Grip       grip;            /* what the button holds */
    Frame      legend;          /* where its bar was drawn last */
    bool       marking;         /* the next drag marks a region */
    bool       has_region;
    Frame      region;
    Statistics in_region;
    double     region_area;     /* m2 of what is seen there */
    bool       plane_on, plane_fits, over_group;
    double     height, margin;  /* metres */
    Plane     *plane;
    PlaneReport report;
    float     *sight;           /* [2 * plane->count]  pixels, NAN: hidden; as from sight_camera */
    bool       sighted;         /* it is of this plane and mesh */
    Camera     sight_camera;
    int        sight_width, sight_height;
    Probes     probes;
    double     panel_bottom;    /* pixels: where the panel ends */
} Measuring;

void measuring_init(Measuring *m);
void measuring_clear(Measuring *m);

/* A new snapshot, or another patch picked: values are found again. */
void measuring_renew(struct Viewer *viewer);
/* Once a frame, before it is drawn: rays for the work plane, values to the card. */
void measuring_work(struct Viewer *viewer);
/* A patch was picked, at (u, v) of a triangle; probe: keep it in the list. */
void measuring_pick(struct Viewer *viewer, uint32_t triangle, double u, double v, bool probe);

/* Keys that are meant for measuring. */
void measuring_act(struct Viewer *viewer, int action);
/* The mouse: true when the movement belongs to the legend or a region. */
bool measuring_button(struct Viewer *viewer, bool down, double x, double y);
bool measuring_move(struct Viewer *viewer, double x, double y, double dx, double dy);
/* What regions are statistics of: the layer, or irradiance as soon as it is known. */
ShownLayer measuring_layer(const struct Viewer *viewer);
/* Statistics of what is seen in the region, weighed by area. */
void measuring_region(struct Viewer *viewer);

/* The panel at the right, and marks over the picture. */
void measuring_panel(struct Viewer *viewer);
void measuring_marks(struct Viewer *viewer, double scale);

#endif
