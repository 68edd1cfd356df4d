/* SPDX-License-Identifier: BSD-3-Clause */
/* The scale of false colours, its range and its round values. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "render/false_colour.h"
#include "render/internal.h"

static const double PI = 3.14159265358979323846;

/* Linear BT.709 of a lightness, chroma and hue (degrees) [ottosson20]. */
static void from_oklch(double lightness, double chroma, double hue, double rgb[3])
{
    const double a = chroma * cos(hue * PI / 180), b = chroma * sin(hue * PI / 180);
    const double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
    const double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
    const double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
    const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
    rgb[0] = 4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3;
    rgb[1] = -1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3;
    rgb[2] = -0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3;
}

static bool in_gamut(const double rgb[3])
{
    for (int k = 0; k < 3; k++)
        if (rgb[k] < 0 || rgb[k] > 1)
            return false;
    return true;
}

void false_colour_at(double place, uint8_t rgb[3])
{
    /* Lightness rises evenly; the hue turns from violet to yellow; the chroma is as much as a
     * screen can show, up to a limit, found by halving. */
    static const double DARK = 0.2, LIGHT = 0.96, VIOLET = 300, YELLOW = 100, CHROMA = 0.19;
    const double t = place > 0 ? fmin(place, 1) : 0;
    const double lightness = DARK + (LIGHT - DARK) * t, hue = VIOLET + (YELLOW - VIOLET) * t;
    double linear[3], low = 0, high = CHROMA;
    enum { HALVINGS = 12 }; /* 0.19 / 4096: far below a byte's step */
    for (int k = 0; k < HALVINGS; k++) {
        const double chroma = 0.5 * (low + high);
        from_oklch(lightness, chroma, hue, linear);
        if (in_gamut(linear))
            low = chroma;
        else
            high = chroma;
    }
    from_oklch(lightness, low, hue, linear);
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)lround(255 * tonemap_srgb(fmin(1, fmax(0, linear[k]))));
}

void false_colour_of(const FalseColour *scale, double place, uint8_t rgb[3])
{
    /* Lightness grows with the amount on both sides alike. */
    static const double DARK = 0.12, LIGHT = 0.75, RED = 29, BLUE = 245, CHROMA = 0.12;
    if (!scale->signs) {
        false_colour_at(place, rgb);
        return;
    }
    const double v = 2 * (place > 0 ? fmin(place, 1) : 0) - 1, t = fabs(v);
    double linear[3];
    from_oklch(DARK + (LIGHT - DARK) * t, CHROMA * t, v > 0 ? RED : BLUE, linear);
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)lround(255 * tonemap_srgb(fmin(1, fmax(0, linear[k]))));
}

double false_colour_place(const FalseColour *scale, double value)
{
    if (scale->logarithmic)
        return value > 0 ? log(value / scale->low) / log(scale->high / scale->low) : -INFINITY;
    return (value - scale->low) / (scale->high - scale->low);
}

/* The least of 1, 1.5, 2, 3, 5, 7 times a power of ten that is not below v > 0. */
static double round_up(double v)
{
    static const double steps[] = { 1, 1.5, 2, 3, 5, 7, 10 };
    static const double ROUNDING = 1e-9; /* relative: 10 found as 10.0000000001 stays 10 */
    const double power = pow(10, floor(log10(v)));
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        if (steps[i] * power >= v * (1 - ROUNDING))
            return steps[i] * power;
    return 10 * power;
}

/* Bins of a histogram over the exponents of a float: sixteen an octave, so ranks are found within
 * 5 %, less than rounding up does. */
enum { OCTAVES = 256, PER_OCTAVE = 16, BINS = OCTAVES * PER_OCTAVE };

static int bin_of(double v)
{
    const double at = (log2(v) + OCTAVES / 2) * PER_OCTAVE;
    return at < 0 ? 0 : at >= BINS ? BINS - 1 : (int)at;
}

static double bin_value(int bin) { return exp2((double)bin / PER_OCTAVE - OCTAVES / 2); }

void false_colour_range(const float *values, size_t count, FalseColour *scale)
{
    static const double OUTLIERS = 0.002;
    uint32_t bins[BINS];
    size_t   n = 0;
    memset(bins, 0, sizeof bins);
    for (size_t i = 0; i < count; i++)
        if (values[i] > 0 && isfinite(values[i])) {
            bins[bin_of(values[i])]++;
            n++;
        }
    const size_t out = (size_t)(OUTLIERS * (double)n);
    int    top = BINS, bottom = -1;
    size_t above = 0, below = 0;
    scale->low = scale->logarithmic ? 0.1 : 0;
    scale->high = 1;
    if (n == 0)
        return;
    while (above <= out)
        above += bins[--top];
    while (below <= out)
        below += bins[++bottom];
    scale->high = round_up(bin_value(top + 1));
    if (scale->logarithmic)
        scale->low = fmin(1 / round_up(1 / bin_value(bottom)), scale->high / 10);
}

int false_colour_ticks(const FalseColour *scale, int most, double *ticks)
{
    static const double ROUNDING = 1e-9; /* of the range: its ends count */
    int n = 0;
    assert(most >= 2 && scale->high > scale->low);
    if (scale->logarithmic) {
        static const int kept[3][3] = { { 1, 2, 5 }, { 1, 3, 0 }, { 1, 0, 0 } };
        const double first = floor(log10(scale->low)), last = ceil(log10(scale->high));
        const double decades = log10(scale->high / scale->low);
        const int form = 3 * decades <= most - 1 ? 0 : 2 * decades <= most - 1 ? 1 : 2;
        const double stride = ceil(fmax(1, decades / (most - 1)));
        for (double e = first; e <= last; e += stride)
            for (int k = 0; k < 3 && kept[form][k] > 0 && n < most; k++) {
                const double v = kept[form][k] * pow(10, e);
                if (v >= scale->low * (1 - ROUNDING) && v <= scale->high * (1 + ROUNDING))
                    ticks[n++] = v;
            }
        return n;
    }
    const double span = scale->high - scale->low;
    double step = pow(10, floor(log10(span)));
    step = span / step >= most ? 2 * step : span / step >= 0.5 * most ? step
         : span / step >= 0.2 * most ? step / 2 : step / 5;
    for (double k = ceil(scale->low / step - ROUNDING); n < most; k++) {
        if (k * step > scale->high + ROUNDING * span)
            break;
        ticks[n++] = k * step + 0.0; /* no -0 */
    }
    return n;
}
