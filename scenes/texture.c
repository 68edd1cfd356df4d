/* SPDX-License-Identifier: BSD-3-Clause */
/* Looking colours up in images, and means of them over areas; maps from places to (u, v). */
#include "scenes/texture.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"

/* IEC 61966-2-1, backwards. */
float texture_linear(uint8_t byte)
{
    const double v = byte / 255.0;
    return (float)(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
}

/* A level of either kind. */
static void level_put(Texture *t, int level, size_t at, const float c[4])
{
    for (size_t k = 0; k < 4; k++)
        if (t->bytes == NULL)
            t->level[level][4 * at + k] = c[k];
        else
            t->short_level[level][4 * at + k] = (uint16_t)(fminf(fmaxf(c[k], 0), 1) * 65535 + 0.5F);
}

static void level_get(const Texture *t, int level, size_t at, float out[4])
{
    for (size_t k = 0; k < 4; k++)
        out[k] = t->bytes == NULL ? t->level[level][4 * at + k]
                                  : (float)t->short_level[level][4 * at + k] / 65535;
}

/* --- texels ----------------------------------------------------------------------------------- */

/* Texel number i of n, however far i is off. */
static int wrapped(double i, int n, TextureWrap wrap)
{
    if (wrap == WRAP_CLAMP)
        return !(i >= 0) ? 0 : i >= n ? n - 1 : (int)i; /* 0 for what is no number, too */
    const double period = wrap == WRAP_MIRROR ? 2.0 * n : n;
    const double at = i - period * floor(i / period);
    const int    k = at < period ? (int)at : 0;
    return k < n ? k : 2 * n - 1 - k;
}

/* Colours and alpha of a texel of the image itself; colours not times alpha. */
static void texel(const Texture *t, int x, int y, float out[4])
{
    const size_t at = 4 * ((size_t)y * (size_t)t->width + (size_t)x);
    if (t->bytes == NULL) {
        memcpy(out, t->linear + at, 4 * sizeof *out);
        return;
    }
    for (int k = 0; k < 3; k++)
        out[k] = t->linear_of[t->bytes[at + (size_t)k]];
    out[3] = t->bytes[at + 3] / 255.0F;
}

/* --- smaller copies --------------------------------------------------------------------------- */

static int half(int n) { return n > 1 ? n / 2 : 1; }

/* Mean of those of n texels that a texel of half as many covers: odd sizes overlap by shares. */
static void shares(int i, int n, int first[1], double share[3], int *count)
{
    const int    smaller = half(n);
    const double width = (double)n / smaller, from = i * width, to = from + width;
    *first = (int)floor(from);
    *count = 0;
    for (int k = *first; k < n && k < to && *count < 3; k++)
        share[(*count)++] = (fmin(to, k + 1) - fmax(from, k)) / width;
}

/* One texel of the next level: from the image when before is -1. */
static void shrink_texel(const Texture *t, int before, int w, int h, int x, int y, float out[4])
{
    double sum[4] = { 0 }, sx[3], sy[3];
    int    fx, fy, nx, ny;
    shares(x, w, &fx, sx, &nx);
    shares(y, h, &fy, sy, &ny);
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) {
            float c[4];
            if (before >= 0)
                level_get(t, before, (size_t)(fy + j) * (size_t)w + (size_t)(fx + i), c);
            else
                texel(t, fx + i, fy + j, c);
            for (int k = 0; k < 3; k++)
                sum[k] += sx[i] * sy[j] * (double)(before >= 0 ? c[k] : c[k] * c[3]);
            sum[3] += sx[i] * sy[j] * (double)c[3];
        }
    for (int k = 0; k < 4; k++)
        out[k] = (float)sum[k];
}

static bool level_create(Texture *t, int level, size_t texels, Error *err)
{
    if (t->bytes == NULL)
        t->level[level] = array_create(4 * texels, sizeof(float), "texture", err);
    else
        t->short_level[level] = array_create(4 * texels, sizeof(uint16_t), "texture", err);
    return !error_is_set(err);
}

static bool make_levels(Texture *t, Error *err)
{
    int w = t->width, h = t->height;
    while ((w > 1 || h > 1) && t->levels < TEXTURE_LEVELS) {
        const int sw = half(w), sh = half(h);
        const int next = t->levels;
        if (!level_create(t, next, (size_t)sw * (size_t)sh, err))
            return false;
        for (int y = 0; y < sh; y++)
            for (int x = 0; x < sw; x++) {
                float c[4];
                shrink_texel(t, next - 1, w, h, x, y, c);
                level_put(t, next, (size_t)y * (size_t)sw + (size_t)x, c);
            }
        t->levels++;
        w = sw;
        h = sh;
    }
    return true;
}

static bool find_clear(const Texture *t)
{
    const size_t n = (size_t)t->width * (size_t)t->height;
    for (size_t i = 0; i < n; i++)
        if (t->bytes != NULL ? t->bytes[4 * i + 3] < 255 : t->linear[4 * i + 3] < 1)
            return true;
    return false;
}

bool texture_make(Texture *texture, const char *name, int width, int height, uint8_t *bytes,
                  float *linear, Error *err)
{
    assert(width > 0 && height > 0 && (bytes != NULL) != (linear != NULL));
    *texture = (Texture){ .width = width, .height = height, .bytes = bytes, .linear = linear,
                          .name = array_string(name, err) };
    for (int i = 0; i < 256; i++)
        texture->linear_of[i] = texture_linear((uint8_t)i);
    texture->clear = find_clear(texture);
    if (texture->name != NULL && make_levels(texture, err))
        return true;
    texture_clear(texture);
    return false;
}

void texture_clear(Texture *texture)
{
    for (int i = 0; i < TEXTURE_LEVELS; i++) {
        array_free(texture->level[i]);
        array_free(texture->short_level[i]);
    }
    array_free(texture->bytes);
    array_free(texture->linear);
    array_free(texture->name);
    *texture = (Texture){ 0 };
}

/* --- looking up ------------------------------------------------------------------------------- */

/* Bilinear; level -1: the image itself. Colours come times alpha. */
static void look_up(const Texture *t, int level, double u, double v, double out[4])
{
    int w = t->width, h = t->height;
    for (int i = 0; i <= level; i++) {
        w = half(w);
        h = half(h);
    }
    const double x = u * w - 0.5, y = (1 - v) * h - 0.5;
    const double x0 = floor(x), y0 = floor(y);
    memset(out, 0, 4 * sizeof *out);
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 2; i++) {
            const int tx = wrapped(x0 + i, w, t->wrap), ty = wrapped(y0 + j, h, t->wrap);
            const double share = (i == 0 ? 1 - (x - x0) : x - x0) *
                                 (j == 0 ? 1 - (y - y0) : y - y0);
            float c[4];
            if (level < 0) {
                texel(t, tx, ty, c);
                for (int k = 0; k < 3; k++)
                    c[k] *= c[3];
            } else
                level_get(t, level, (size_t)ty * (size_t)w + (size_t)tx, c);
            for (int k = 0; k < 4; k++)
                out[k] += share * (double)c[k];
        }
}

/* Colours without their alpha. Where nothing is opaque the colour does not matter. */
static Rgb colour_of(const double c[4], double *alpha)
{
    if (alpha != NULL)
        *alpha = c[3];
    return c[3] > 0 ? rgb(c[0] / c[3], c[1] / c[3], c[2] / c[3]) : rgb(0, 0, 0);
}

Rgb texture_at(const Texture *texture, double u, double v, double *alpha)
{
    double c[4];
    assert(texture->width > 0);
    look_up(texture, -1, u, v, c);
    return colour_of(c, alpha);
}

Rgb texture_mean_at(const Texture *texture, double u, double v, double size, double *alpha)
{
    const double texels = size * fmax(texture->width, texture->height);
    const int    level = texels >= 2 ? (int)fmin(log2(fmin(texels, 1e9)), TEXTURE_LEVELS) - 1 : -1;
    double c[4];
    assert(texture->levels <= TEXTURE_LEVELS);
    look_up(texture, level < texture->levels ? level : texture->levels - 1, u, v, c);
    return colour_of(c, alpha);
}

/* --- maps ------------------------------------------------------------------------------------- */

/* The corner that with the first two makes the largest triangle; SIZE_MAX: none does. */
static size_t third_corner(const Vec3 *p, size_t count, size_t second)
{
    static const double THIN = 1e-10; /* sine of the angle: rounding of coordinates, not a shape */
    const Vec3 a = vec3_sub(p[second], p[0]);
    size_t best = SIZE_MAX;
    double most = 0;
    for (size_t i = 1; i < count; i++) {
        const Vec3   b = vec3_sub(p[i], p[0]);
        const double area = vec3_length(vec3_cross(a, b));
        if (area > most && area > THIN * vec3_length(a) * vec3_length(b)) {
            most = area;
            best = i;
        }
    }
    return best;
}

bool face_map_fit(FaceMap *map, const Vec3 *p, const double (*uv)[2], size_t count,
                  double *misfit)
{
    size_t second = 1;
    assert(count >= 3);
    for (size_t i = 2; i < count; i++)
        if (vec3_length(vec3_sub(p[i], p[0])) > vec3_length(vec3_sub(p[second], p[0])))
            second = i;
    const size_t third = third_corner(p, count, second);
    *map = (FaceMap){ .used = false };
    *misfit = 0;
    if (third == SIZE_MAX)
        return false;
    /* In the triangle's plane: the reciprocal basis of its two edges. */
    const Vec3 a = vec3_sub(p[second], p[0]), b = vec3_sub(p[third], p[0]);
    const Vec3 n = vec3_cross(a, b);
    const double n2 = vec3_dot(n, n);
    const Vec3 ra = vec3_scale(vec3_cross(b, n), 1 / n2), rb = vec3_scale(vec3_cross(n, a), 1 / n2);
    map->du = vec3_mad(vec3_scale(ra, uv[second][0] - uv[0][0]), uv[third][0] - uv[0][0], rb);
    map->dv = vec3_mad(vec3_scale(ra, uv[second][1] - uv[0][1]), uv[third][1] - uv[0][1], rb);
    map->u0 = uv[0][0] - vec3_dot(map->du, p[0]);
    map->v0 = uv[0][1] - vec3_dot(map->dv, p[0]);
    map->used = isfinite(map->u0 + map->v0);
    for (size_t i = 0; i < count; i++)
        *misfit = fmax(*misfit, fmax(fabs(face_map_u(map, p[i]) - uv[i][0]),
                                     fabs(face_map_v(map, p[i]) - uv[i][1])));
    return map->used;
}

void face_map_move(FaceMap *map, Vec3 origin)
{
    assert(vec3_finite(origin));
    map->u0 += vec3_dot(map->du, origin);
    map->v0 += vec3_dot(map->dv, origin);
}

/* --- all of a scene --------------------------------------------------------------------------- */

bool textures_add(Textures *textures, Texture *texture, uint32_t *index, Error *err)
{
    assert(texture->width > 0 && index != NULL);
    if (!array_reserve((void **)&textures->texture, &textures->capacity, textures->count + 1,
                       sizeof *texture, "textures", err)) {
        texture_clear(texture);
        return false;
    }
    *index = (uint32_t)textures->count;
    textures->texture[textures->count++] = *texture;
    *texture = (Texture){ 0 };
    return true;
}

bool textures_set_map(Textures *textures, uint32_t polygon, const FaceMap *map, Error *err)
{
    const size_t needed = (size_t)polygon + 1;
    if (needed > textures->map_count) {
        if (!array_reserve((void **)&textures->map, &textures->map_capacity, needed, sizeof *map,
                           "places in images", err))
            return false;
        memset(textures->map + textures->map_count, 0,
               (needed - textures->map_count) * sizeof *map);
        textures->map_count = needed;
    }
    textures->map[polygon] = *map;
    return true;
}

void textures_clear(Textures *textures)
{
    for (size_t i = 0; i < textures->count; i++)
        texture_clear(&textures->texture[i]);
    array_free(textures->texture);
    array_free(textures->map);
    *textures = (Textures){ 0 };
}
