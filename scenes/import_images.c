/* SPDX-License-Identifier: BSD-3-Clause */
/* Images that a material library names: the line that names one, the file, what it does to the
 * material. */
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/import.h"
#include "scenes/texture_read.h"

/* --- the line: [-option values ...] file ------------------------------------------------------ */

/* Numbers that may follow an option, as far as there are any; those not finite change nothing. */
static void option_numbers(const TextFile *text, const char **line, double *value, int most)
{
    for (int k = 0; k < most; k++) {
        const char *peek = *line;
        double v;
        if (!text_number(text, &peek, &v))
            return;
        if (isfinite(v))
            value[k] = v;
        *line = peek;
    }
}

/* Takes one option with what belongs to it; false: there is none left. */
static bool option_read(const TextFile *text, const char **line, MapImage *image)
{
    double unused[3] = { 0, 0, 0 };
    const char *peek = *line;
    const Word key = text_word(&peek);
    if (key.length < 2 || key.begin[0] != '-')
        return false;
    if (word_is(key, "-s"))
        option_numbers(text, &peek, image->scale, 2);
    else if (word_is(key, "-o"))
        option_numbers(text, &peek, image->offset, 2);
    if (word_is(key, "-s") || word_is(key, "-o") || word_is(key, "-t")) {
        option_numbers(text, &peek, unused, word_is(key, "-t") ? 3 : 1);
    } else if (word_is(key, "-mm")) {
        option_numbers(text, &peek, unused, 2);
    } else if (word_is(key, "-bm") || word_is(key, "-boost") || word_is(key, "-texres")) {
        option_numbers(text, &peek, unused, 1);
    } else { /* -blendu, -blendv, -cc, -clamp, -imfchan, -type, -colorspace: one word */
        const Word value = text_word(&peek);
        if (word_is(key, "-clamp"))
            image->clamp = word_is(value, "on");
    }
    *line = peek;
    return true;
}

bool map_image_read(const TextFile *text, const char *line, MapImage *image, Error *err)
{
    char name[1024];
    assert(line != NULL && image != NULL);
    array_free(image->file);
    *image = (MapImage){ .scale = { 1, 1 } };
    while (option_read(text, &line, image)) { }
    text_rest(line, name, sizeof name);
    if (name[0] == '\0')
        return true; /* "map_Kd" alone: no image */
    image->file = array_string(name, err);
    return image->file != NULL;
}

void material_images_clear(MaterialImages *images)
{
    array_free(images->colour.file);
    array_free(images->emission.file);
    array_free(images->cut.file);
    array_free(images->path);
    *images = (MaterialImages){ 0 };
}

/* --- the file --------------------------------------------------------------------------------- */

/* As named, or by its bare name beside the library: paths of another machine are common. */
static bool image_path(const char *library, const char *name, char *path, size_t size)
{
    char clean[PATH_MAX];
    struct stat info;
    snprintf(clean, sizeof clean, "%s", name);
    for (char *c = clean; *c != 0; c++)
        if (*c == '\\')
            *c = '/';
    const char *slash = strrchr(clean, '/');
    const char *tries[2] = { clean, slash != NULL ? slash + 1 : clean };
    for (int i = 0; i < 2; i++)
        if (tries[i][0] != 0 && file_beside(library, tries[i], path, size) &&
            stat(path, &info) == 0 && S_ISREG(info.st_mode) && access(path, R_OK) == 0)
            return true;
    return false;
}

/* false without an error: there is no such image, which is told. */
static bool image_open(ImportTarget *target, const MaterialImages *images, const MapImage *image,
                       Texture *texture, Error *err)
{
    const Monitor *monitor = target->options->monitor;
    char  path[PATH_MAX];
    Error damaged = { 0 };
    if (!image_path(images->path, image->file, path, sizeof path)) {
        monitor_warn(monitor, "image-missing", images->path, "image \"%.200s\" is not there; its "
                     "material has one colour", image->file);
        return false;
    }
    if (!texture_read(path, monitor, texture, &damaged)) {
        if (damaged.code != ERROR_INPUT)
            *err = damaged;
        else
            monitor_warn(monitor, "image-unreadable", images->path,
                         "%s; its material has one colour", damaged.text);
        return false;
    }
    texture->wrap = image->clamp ? WRAP_CLAMP : WRAP_REPEAT;
    target->hash = file_hash(path, strlen(path), target->hash);
    return true;
}

/* One of the scene's images, read once; UINT32_MAX: none. */
static uint32_t image_number(ImportTarget *target, const MaterialImages *images,
                             const MapImage *image, Error *err)
{
    Textures *all = &target->scene->textures;
    Texture   texture;
    assert(image->file != NULL && images->path != NULL);
    char      path[PATH_MAX];
    uint32_t  index = UINT32_MAX;
    const TextureWrap wrap = image->clamp ? WRAP_CLAMP : WRAP_REPEAT;
    if (image_path(images->path, image->file, path, sizeof path))
        for (size_t i = 0; i < all->count; i++)
            if (strcmp(all->texture[i].name, path) == 0 && all->texture[i].wrap == wrap)
                return (uint32_t)i;
    if (!image_open(target, images, image, &texture, err) ||
        !textures_add(all, &texture, &index, err))
        return UINT32_MAX;
    return index;
}

/* --- what it does ----------------------------------------------------------------------------- */

/* An image of its own for where there is something: its brightness becomes the alpha of a copy of
 * the colours, or of white. */
static bool cut_make(ImportTarget *target, const MaterialImages *images, Material *m, Error *err)
{
    Textures *all = &target->scene->textures;
    Texture   cut, both;
    uint32_t  index;
    if (!image_open(target, images, &images->cut, &cut, err))
        return !error_is_set(err);
    const Texture *colour = m->texture > 0 ? &all->texture[m->texture - 1] : NULL;
    const int w = colour != NULL ? colour->width : cut.width;
    const int h = colour != NULL ? colour->height : cut.height;
    float *linear = array_create(4 * (size_t)w * (size_t)h, sizeof *linear, "texture", err);
    for (int y = 0; y < h && linear != NULL; y++)
        for (int x = 0; x < w; x++) {
            const double u = (x + 0.5) / w, v = 1 - (y + 0.5) / h;
            const Rgb c = colour != NULL ? texture_at(colour, u, v, NULL) : rgb(1, 1, 1);
            double alpha;
            const double bright = rgb_luminance(texture_at(&cut, u, v, &alpha));
            float *out = linear + 4 * ((size_t)y * (size_t)w + (size_t)x);
            out[0] = (float)c.r;
            out[1] = (float)c.g;
            out[2] = (float)c.b;
            out[3] = (float)(cut.clear ? alpha : bright);
        }
    /* A name that no file has: image_number must not take it for the image alone. */
    const bool made = linear != NULL && texture_make(&both, "cut-out", w, h, NULL, linear, err);
    if (made)
        both.wrap = colour != NULL ? colour->wrap : cut.wrap;
    texture_clear(&cut);
    if (!made || !textures_add(all, &both, &index, err))
        return false;
    m->texture = index + 1;
    return true;
}

/* Mean over the whole image. */
static Rgb image_mean(const Texture *t)
{
    return texture_mean_at(t, 0.5, 0.5, 1, NULL);
}

bool import_images(ImportTarget *target, const MaterialImages *images, Material *m, Error *err)
{
    const Monitor *monitor = target->options->monitor;
    Texture glow;
    assert(target->scene != NULL && m->texture == 0);
    if (images->colour.file != NULL) {
        const uint32_t index = image_number(target, images, &images->colour, err);
        m->texture = index != UINT32_MAX ? index + 1 : 0;
    }
    if (images->cut.file != NULL && !error_is_set(err) && !cut_make(target, images, m, err))
        return false;
    m->cut_out = m->texture > 0 && target->scene->textures.texture[m->texture - 1].clear;
    if (images->emission.file != NULL && rgb_max(m->emission) > 0 && !error_is_set(err) &&
        image_open(target, images, &images->emission, &glow, err)) {
        m->emission = rgb_mul(m->emission, image_mean(&glow));
        texture_clear(&glow);
        monitor_warn(monitor, "emission-evened", images->path, "material \"%s\" emits the mean of "
                     "its image everywhere", m->name != NULL ? m->name : "");
    }
    return !error_is_set(err);
}
