/* SPDX-License-Identifier: BSD-3-Clause */
/* A piecewise constant density on the square: rows by their sums, cells within the row. */
#include "render/guide.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

static int clamp_cell(int i) { return i < 0 ? 0 : i >= GUIDE_SIDE ? GUIDE_SIDE - 1 : i; }

/* Mean over 3 x 3 cells, weights 1 2 1: edges move between the points that share a guide. */
static double blurred(const double light[GUIDE_SIDE][GUIDE_SIDE], int y, int x)
{
    double sum = 0;
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++)
            sum += (2 - abs(j)) * (2 - abs(i)) * light[clamp_cell(y + j)][clamp_cell(x + i)];
    return sum / 16;
}

/* Running sums of densities, ending at exactly 1; returns the sum. */
static double axis_init(GuideAxis *axis, const double *density)
{
    double sum = 0, all = 0;
    for (int i = 0; i < GUIDE_SIDE; i++)
        all += density[i];
    axis->below[0] = 0;
    for (int i = 0; i < GUIDE_SIDE; i++) {
        sum += density[i];
        axis->below[i + 1] = i + 1 < GUIDE_SIDE ? (float)(sum / all) : 1;
        axis->scale[i] = 1 / ((axis->below[i + 1] - axis->below[i]) * GUIDE_SIDE);
        axis->shift[i] = (float)i / GUIDE_SIDE - axis->below[i] * axis->scale[i];
    }
    return all;
}

bool guide_init(Guide *guide, const double light[GUIDE_SIDE][GUIDE_SIDE])
{
    double density[GUIDE_SIDE][GUIDE_SIDE], rows[GUIDE_SIDE], mean = 0;
    for (int y = 0; y < GUIDE_SIDE; y++)
        for (int x = 0; x < GUIDE_SIDE; x++) {
            assert(light[y][x] >= 0);
            density[y][x] = blurred(light, y, x);
            mean += density[y][x] / (GUIDE_SIDE * GUIDE_SIDE);
        }
    if (!(mean > 0) || !isfinite(mean))
        return false;
    for (int y = 0; y < GUIDE_SIDE; y++) {
        for (int x = 0; x < GUIDE_SIDE; x++)
            density[y][x] = GUIDE_PLAIN + (1 - GUIDE_PLAIN) * density[y][x] / mean;
        rows[y] = axis_init(&guide->column[y], density[y]);
    }
    axis_init(&guide->row, rows);
    /* From the sums as stored, so that what is drawn and what it weighs agree. */
    for (int y = 0; y < GUIDE_SIDE; y++)
        for (int x = 0; x < GUIDE_SIDE; x++)
            guide->worth[y][x] = guide->row.scale[y] * guide->column[y].scale[x];
    return true;
}

/* The cell that holds u; *u becomes its place in the whole, cell by cell. */
static int axis_map(const GuideAxis *axis, float *u)
{
    int cell = 0;
    for (int i = 1; i < GUIDE_SIDE; i++) /* all at once in vector registers: faster than halving */
        cell += axis->below[i] <= *u;
    const float place = axis->shift[cell] + axis->scale[cell] * *u;
    *u = place < 0 ? 0 : place < 1 ? place : 1 - 0x1p-24F;
    return cell;
}

double guide_map(const Guide *guide, float u[2])
{
    assert(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1);
    const int y = axis_map(&guide->row, &u[0]);
    const int x = axis_map(&guide->column[y], &u[1]);
    return guide->worth[y][x];
}
