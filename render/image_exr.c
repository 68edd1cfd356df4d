/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenEXR files, by OpenEXR's own C library; the only file that includes it.
 *
 * The library writes into memory and reads from memory: then standard output is a target like any
 * other, a full disk is noticed by base/file.h, and a device or a pipe cannot make a reader hang.
 * Nothing that depends on the day or the machine is stored, so the same picture is the same file.
 */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <openexr.h>

#include "base/array.h"
#include "base/file.h"
#include "base/parallel.h"
#include "render/internal.h"

/* --- the library's view of memory ------------------------------------------------------------ */

typedef struct {
    void    *bytes;
    size_t   size, capacity; /* size: written or readable so far */
    char     message[256];   /* the library's last complaint */
    Error   *err;            /* for memory that runs out while writing */
} Memory;

static void on_error(exr_const_context_t context, exr_result_t code, const char *text)
{
    void *user = NULL;
    (void)code;
    if (exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user != NULL)
        snprintf(((Memory *)user)->message, sizeof ((Memory *)user)->message, "%s",
                 text != NULL ? text : "");
}

static int64_t memory_read(exr_const_context_t context, void *user, void *buffer, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t error)
{
    const Memory *m = user;
    (void)context;
    (void)error;
    if (offset >= m->size)
        return 0;
    const size_t count = size < m->size - offset ? (size_t)size : m->size - (size_t)offset;
    memcpy(buffer, (const char *)m->bytes + offset, count);
    return (int64_t)count;
}

static int64_t memory_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const Memory *)user)->size;
}

static int64_t memory_write(exr_const_context_t context, void *user, const void *buffer,
                            uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t error)
{
    Memory *m = user;
    (void)context;
    (void)error;
    assert(offset <= SIZE_MAX / 2 && size <= SIZE_MAX / 2);
    const size_t end = (size_t)(offset + size);
    if (!array_reserve(&m->bytes, &m->capacity, end, 1, "EXR file", m->err))
        return -1;
    if (end > m->size) { /* a seek past the end leaves zeros, as on a disk */
        memset((char *)m->bytes + m->size, 0, end - m->size);
        m->size = end;
    }
    memcpy((char *)m->bytes + offset, buffer, (size_t)size);
    return (int64_t)size;
}

static exr_context_initializer_t initializer(Memory *memory)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_error;
    init.user_data = memory;
    init.max_image_width = IMAGE_SIDE_MAX;
    init.max_image_height = IMAGE_SIDE_MAX;
    init.max_tile_width = IMAGE_SIDE_MAX;
    init.max_tile_height = IMAGE_SIDE_MAX;
    return init;
}

/* --- writing --------------------------------------------------------------------------------- */

enum { CHANNELS_USUAL = 24, CHANNEL_NAME = IMAGE_NAME + 16 };

/* A channel and where its first value lies; values are stride elements of 4 bytes apart. */
typedef struct {
    const char *name;
    const void *values;
    int         stride;
    bool        whole; /* unsigned integers instead of floats */
} Channel;

typedef struct {
    Channel *channel;                 /* [count] */
    char   (*name)[CHANNEL_NAME];     /* [3 * group_count]  those made for light groups */
    int      count;
} Channels;

static int list_groups(const Image *image, Channels *list, int n)
{
    for (uint32_t g = 0; g < image->group_count; g++)
        for (uint32_t k = 0; k < 3; k++) {
            char *name = list->name[3 * g + k];
            snprintf(name, CHANNEL_NAME, "lightgroup.%s.%c", image->group_name[g], "RGB"[k]);
            list->channel[n++] = (Channel){ name, image_group(image, g) + k, 3, false };
        }
    return n;
}

static void channels_clear(Channels *list)
{
    array_free(list->channel);
    array_free(list->name);
}

static bool channels_list(const Image *image, Channels *list, Error *err)
{
    static const char *const names[6][3] = {
        { "R", "G", "B" },
        { "direct.R", "direct.G", "direct.B" },
        { "indirect.R", "indirect.G", "indirect.B" },
        { "albedo.R", "albedo.G", "albedo.B" },
        { "irradiance.R", "irradiance.G", "irradiance.B" },
        { "normal.X", "normal.Y", "normal.Z" },
    };
    const float *const layers[6] = { image->radiance, image->direct,     image->indirect,
                                     image->albedo,   image->irradiance, image->normal };
    static const unsigned bits[6] = { 0, IMAGE_DIRECT, IMAGE_INDIRECT, IMAGE_ALBEDO,
                                      IMAGE_IRRADIANCE, IMAGE_NORMAL };
    const size_t most = CHANNELS_USUAL + 3 * (size_t)image->group_count;
    *list = (Channels){ 0 };
    list->channel = array_create(most, sizeof *list->channel, "EXR", err);
    list->name = array_create(3 * (size_t)image->group_count, sizeof *list->name, "EXR", err);
    if (error_is_set(err))
        return false;
    int n = 0;
    for (int layer = 0; layer < 6; layer++)
        for (int k = 0; k < 3 && (image->empty & bits[layer]) == 0; k++)
            list->channel[n++] = (Channel){ names[layer][k], layers[layer] + k, 3, false };
    list->channel[n++] = (Channel){ "depth.Z", image->depth, 1, false };
    if ((image->empty & IMAGE_PATCH) == 0)
        list->channel[n++] = (Channel){ "patch.ID", image->patch, 1, true };
    if (image->deviation != NULL)
        list->channel[n++] = (Channel){ "deviation.Y", image->deviation, 1, false };
    assert(n <= CHANNELS_USUAL);
    list->count = list_groups(image, list, n);
    return true;
}

static exr_result_t write_vector(exr_context_t file, const char *name, const double v[3])
{
    const exr_attr_v3f_t value = { .x = (float)v[0], .y = (float)v[1], .z = (float)v[2] };
    return exr_attr_set_v3f(file, 0, name, &value);
}

static exr_result_t write_string(exr_context_t file, const char *name, const char *text)
{
    return text != NULL && text[0] != '\0' ? exr_attr_set_string(file, 0, name, text)
                                           : EXR_ERR_SUCCESS;
}

static exr_result_t write_attributes(exr_context_t file, const ImageInfo *info)
{
    char hash[20];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)info->scene_hash);
    exr_result_t r = write_vector(file, "isolux.cameraEye", info->eye);
    r = r ? r : write_vector(file, "isolux.cameraTarget", info->target);
    r = r ? r : write_vector(file, "isolux.cameraUp", info->up);
    r = r ? r : exr_attr_set_float(file, 0, "isolux.cameraVerticalFov", (float)info->vertical_fov);
    r = r ? r : exr_attr_set_float(file, 0, "isolux.exposure", (float)info->exposure);
    r = r ? r : write_string(file, "isolux.units", info->units);
    r = r ? r : write_string(file, "isolux.version", info->version);
    r = r ? r : write_string(file, "isolux.scene", info->scene);
    r = r ? r : write_string(file, "isolux.sceneHash", hash);
    r = r ? r : write_string(file, "isolux.command", info->command);
    return r;
}

/* A part says where in the whole it belongs. */
static exr_result_t write_windows(exr_context_t file, const Image *image)
{
    const exr_attr_box2i_t data = {
        .min = { { .x = image->left, .y = image->top } },
        .max = { { .x = image->left + image->width - 1, .y = image->top + image->height - 1 } },
    };
    const exr_attr_box2i_t whole = {
        .max = { { .x = image->whole_width - 1, .y = image->whole_height - 1 } },
    };
    if (image->whole_width == 0)
        return EXR_ERR_SUCCESS;
    const exr_result_t r = exr_set_data_window(file, 0, &data);
    return r ? r : exr_set_display_window(file, 0, &whole);
}

/* Noise does not get smaller: level 9 takes twice the time of 2 for 1 % less. */
enum { ZIP_LEVEL = 2 };

static exr_result_t write_head(exr_context_t file, const Image *image, const ImageInfo *info,
                               const Channel *list, int count)
{
    exr_result_t r = exr_add_part(file, "isolux", EXR_STORAGE_SCANLINE, NULL);
    r = r ? r : exr_initialize_required_attr_simple(file, 0, image->width, image->height,
                                                    EXR_COMPRESSION_ZIP);
    r = r ? r : exr_set_zip_compression_level(file, 0, ZIP_LEVEL);
    r = r ? r : write_windows(file, image);
    r = r ? r : exr_set_longname_support(file, image->group_count > 0);
    for (int i = 0; i < count && r == EXR_ERR_SUCCESS; i++)
        r = exr_add_channel(file, 0, list[i].name, list[i].whole ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT,
                            EXR_PERCEPTUALLY_LINEAR, 1, 1);
    if (r == EXR_ERR_SUCCESS && info != NULL)
        r = write_attributes(file, info);
    return r ? r : exr_write_header(file);
}

/* Points the encoder's channels, which the library keeps in alphabetical order, at rows from y. */
static void aim_encoder(exr_encode_pipeline_t *encoder, const Image *image, const Channel *list,
                        int count, int y)
{
    for (int c = 0; c < encoder->channel_count; c++) {
        exr_coding_channel_info_t *channel = &encoder->channels[c];
        int i = 0;
        while (i < count && strcmp(list[i].name, channel->channel_name) != 0)
            i++;
        assert(i < count);
        const size_t row = (size_t)y * (size_t)image->width * (size_t)list[i].stride;
        channel->encode_from_ptr = (const uint8_t *)list[i].values + 4 * row;
        channel->user_pixel_stride = 4 * list[i].stride;
        channel->user_line_stride = 4 * list[i].stride * image->width;
    }
}

/* Chunks are packed by all threads and written in order: the file is the same for any number. */
typedef struct {
    exr_context_t  file;
    const Image   *image;
    const Channel *list;
    int            count, lines; /* channels; rows a chunk */
    uint8_t      **bytes;        /* [chunks]  packed */
    uint64_t      *size;
    exr_result_t  *result;
} Packing;

/* The encoder's last step, which would write at once: keeps the bytes instead. */
static exr_result_t keep_bytes(exr_encode_pipeline_t *encoder)
{
    Packing     *p = encoder->encoding_user_data;
    Error        err = { 0 };
    const size_t k = (size_t)((encoder->chunk.start_y - p->image->top) / p->lines);
    p->bytes[k] = array_create(encoder->compressed_bytes, 1, "chunk of an EXR", &err);
    if (p->bytes[k] == NULL)
        return EXR_ERR_OUT_OF_MEMORY;
    memcpy(p->bytes[k], encoder->compressed_buffer, encoder->compressed_bytes);
    p->size[k] = encoder->compressed_bytes;
    return EXR_ERR_SUCCESS;
}

/* Nothing is waited for before it. */
static exr_result_t ready(exr_encode_pipeline_t *encoder)
{
    (void)encoder;
    return EXR_ERR_SUCCESS;
}

static exr_result_t pack_chunk(Packing *p, uint32_t k)
{
    const int             y = (int)k * p->lines;
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_chunk_info_t      chunk;
    exr_result_t r = exr_write_scanline_chunk_info(p->file, 0, p->image->top + y, &chunk);
    r = r ? r : exr_encoding_initialize(p->file, 0, &chunk, &encoder);
    if (r != EXR_ERR_SUCCESS)
        return r;
    aim_encoder(&encoder, p->image, p->list, p->count, y);
    r = exr_encoding_choose_default_routines(p->file, 0, &encoder);
    encoder.encoding_user_data = p;
    encoder.yield_until_ready_fn = ready;
    encoder.write_fn = keep_bytes;
    r = r ? r : exr_encoding_run(p->file, 0, &encoder);
    exr_encoding_destroy(p->file, &encoder);
    return r;
}

static void pack_chunks(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Packing *p = context;
    (void)worker;
    for (uint32_t k = begin; k < end; k++)
        p->result[k] = pack_chunk(p, k);
}

static exr_result_t write_packed(const Packing *p, uint32_t chunks)
{
    exr_result_t r = EXR_ERR_SUCCESS;
    for (uint32_t k = 0; k < chunks && r == EXR_ERR_SUCCESS; k++) {
        r = p->result[k];
        r = r ? r : exr_write_scanline_chunk(p->file, 0, p->image->top + (int)k * p->lines,
                                             p->bytes[k], p->size[k]);
    }
    return r;
}

static exr_result_t write_chunks(exr_context_t file, const Image *image, const Channel *list,
                                 int count, unsigned threads)
{
    int32_t      lines = 0;
    Error        err = { 0 };
    Packing      p = { .file = file, .image = image, .list = list, .count = count };
    exr_result_t r = exr_get_scanlines_per_chunk(file, 0, &lines);
    if (r != EXR_ERR_SUCCESS)
        return r;
    const uint32_t chunks = (uint32_t)((image->height + lines - 1) / lines);
    p.lines = lines;
    p.bytes = array_create(chunks, sizeof *p.bytes, "EXR", &err);
    p.size = array_create(chunks, sizeof *p.size, "EXR", &err);
    p.result = array_create(chunks, sizeof *p.result, "EXR", &err);
    if (error_is_set(&err)) {
        r = EXR_ERR_OUT_OF_MEMORY;
    } else {
        parallel_for(chunks, 1, threads, pack_chunks, &p, NULL, NULL);
        r = write_packed(&p, chunks);
    }
    for (uint32_t k = 0; p.bytes != NULL && k < chunks; k++)
        array_free(p.bytes[k]);
    array_free(p.bytes);
    array_free(p.size);
    array_free(p.result);
    return r;
}

/* The whole file in memory. */
static bool encode(const Image *image, const ImageInfo *info, const char *path, Memory *memory,
                   Error *err)
{
    Channels list;
    if (!channels_list(image, &list, err)) {
        channels_clear(&list);
        return false;
    }
    exr_context_initializer_t init = initializer(memory);
    init.write_fn = memory_write;
    exr_context_t file = NULL;
    exr_result_t  r = exr_start_write(&file, path, EXR_WRITE_FILE_DIRECTLY, &init);
    r = r ? r : write_head(file, image, info, list.channel, list.count);
    r = r ? r : write_chunks(file, image, list.channel, list.count,
                             info != NULL ? info->threads : 1);
    if (file != NULL) {
        const exr_result_t end = exr_finish(&file); /* writes the table of chunks */
        r = r ? r : end;
    }
    channels_clear(&list);
    if (r != EXR_ERR_SUCCESS && !error_is_set(err))
        error_set(err, r == EXR_ERR_OUT_OF_MEMORY ? ERROR_MEMORY : ERROR_FAILED,
                  "%s: OpenEXR: %s", path,
                  memory->message[0] ? memory->message : exr_get_default_error_message(r));
    return r == EXR_ERR_SUCCESS;
}

bool image_write_exr(const Image *image, const ImageInfo *info, const char *path, Error *err)
{
    assert(image != NULL && path != NULL && err != NULL);
    if (error_is_set(err))
        return false;
    Memory memory = { .err = err };
    if (!encode(image, info, path, &memory, err)) {
        array_free(memory.bytes);
        return false;
    }
    OutFile *out = outfile_open(path, err);
    if (out != NULL)
        fwrite(memory.bytes, 1, memory.size, outfile_stream(out)); /* commit sees a failure */
    array_free(memory.bytes);
    return out != NULL && outfile_commit(out, err);
}

/* --- reading --------------------------------------------------------------------------------- */

/* A file of this size in memory is refused: far above what any 32768-pixel comparison needs. */
static const size_t READ_LIMIT = (size_t)4 << 30;

/* No compression of the format makes pixels smaller than deflate's limit of 1032 to 1: a header
 * that claims more is damaged, and must not cost its memory. */
static const double RATIO_LIMIT = 1032;

typedef struct {
    exr_context_t file;
    int           left, top, width, height; /* data window */
    char          name[3][64];              /* of the three channels */
    float        *rgb;                      /* [3 * width * height] */
} Picture;

/* Points the decoder's three channels at pixel (x, y) of the picture; the others are skipped.
 * Whatever their type in the file, they come as floats. */
static void aim_decoder(exr_decode_pipeline_t *decoder, const Picture *picture, int x, int y)
{
    const int width = picture->width;
    for (int c = 0; c < decoder->channel_count; c++) {
        exr_coding_channel_info_t *channel = &decoder->channels[c];
        channel->decode_to_ptr = NULL;
        for (int k = 0; k < 3; k++) {
            if (strcmp(channel->channel_name, picture->name[k]) != 0)
                continue;
            const size_t at = 3 * ((size_t)y * (size_t)width + (size_t)x) + (size_t)k;
            channel->decode_to_ptr = (uint8_t *)(picture->rgb + at);
            channel->user_pixel_stride = 3 * (int)sizeof(float);
            channel->user_line_stride = 3 * (int)sizeof(float) * width;
            channel->user_bytes_per_element = sizeof(float);
            channel->user_data_type = EXR_PIXEL_FLOAT;
        }
    }
}

/* Decodes one chunk so that its corner lands on (x, y) of the picture. */
static exr_result_t read_chunk(const Picture *picture, const exr_chunk_info_t *chunk,
                               exr_decode_pipeline_t *decoder, bool *started, int x, int y)
{
    /* What a damaged file says of a chunk must not reach outside the picture. */
    if (x < 0 || y < 0 || chunk->width < 1 || chunk->height < 1 ||
        chunk->width > picture->width - x || chunk->height > picture->height - y)
        return EXR_ERR_CORRUPT_CHUNK;
    const bool   first = !*started;
    exr_result_t r = first ? exr_decoding_initialize(picture->file, 0, chunk, decoder)
                           : exr_decoding_update(picture->file, 0, chunk, decoder);
    if (r != EXR_ERR_SUCCESS)
        return r;
    *started = true;
    aim_decoder(decoder, picture, x, y);
    /* The unpacking routine depends on sizes that differ at the rim: chosen each time. */
    r = exr_decoding_choose_default_routines(picture->file, 0, decoder);
    return r ? r : exr_decoding_run(picture->file, 0, decoder);
}

static exr_result_t read_lines(const Picture *picture)
{
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    int32_t               lines = 0;
    bool                  started = false;
    exr_result_t          r = exr_get_scanlines_per_chunk(picture->file, 0, &lines);
    if (r == EXR_ERR_SUCCESS && lines < 1)
        r = EXR_ERR_CORRUPT_CHUNK;
    for (int y = 0; y < picture->height && r == EXR_ERR_SUCCESS; y += lines) {
        exr_chunk_info_t chunk;
        r = exr_read_scanline_chunk_info(picture->file, 0, picture->top + y, &chunk);
        r = r ? r : read_chunk(picture, &chunk, &decoder, &started, 0, y);
    }
    exr_decoding_destroy(picture->file, &decoder);
    return r;
}

static exr_result_t read_tiles(const Picture *picture)
{
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    int32_t               w = 0, h = 0;
    bool                  started = false;
    exr_result_t          r = exr_get_tile_sizes(picture->file, 0, 0, 0, &w, &h);
    if (r == EXR_ERR_SUCCESS && (w < 1 || h < 1))
        r = EXR_ERR_CORRUPT_CHUNK;
    for (int y = 0; r == EXR_ERR_SUCCESS && y < picture->height; y += h)
        for (int x = 0; r == EXR_ERR_SUCCESS && x < picture->width; x += w) {
            exr_chunk_info_t chunk;
            r = exr_read_tile_chunk_info(picture->file, 0, x / w, y / h, 0, 0, &chunk);
            r = r ? r : read_chunk(picture, &chunk, &decoder, &started, x, y);
        }
    exr_decoding_destroy(picture->file, &decoder);
    return r;
}

/* Whether the three channels are there, half or float, one value a pixel. */
static bool check_channels(const Picture *picture, const char *path, Error *err)
{
    const exr_attr_chlist_t *list = NULL;
    if (exr_get_channels(picture->file, 0, &list) != EXR_ERR_SUCCESS || list == NULL)
        return error_at(err, ERROR_INPUT, path, 0, "has no list of channels");
    for (int k = 0; k < 3; k++) {
        const exr_attr_chlist_entry_t *found = NULL;
        for (int i = 0; i < list->num_channels; i++)
            if (strcmp(list->entries[i].name.str, picture->name[k]) == 0)
                found = &list->entries[i];
        if (found == NULL)
            return error_at(err, ERROR_INPUT, path, 0, "has no channel %s", picture->name[k]);
        if (found->x_sampling != 1 || found->y_sampling != 1)
            return error_at(err, ERROR_INPUT, path, 0, "channel %s is subsampled",
                            picture->name[k]);
        if (found->pixel_type != EXR_PIXEL_HALF && found->pixel_type != EXR_PIXEL_FLOAT)
            return error_at(err, ERROR_INPUT, path, 0, "channel %s is not half or float",
                            picture->name[k]);
    }
    return true;
}

static bool read_picture(Picture *picture, const char *path, const Memory *memory, Error *err)
{
    exr_attr_box2i_t window;
    exr_storage_t    storage;
    if (exr_get_data_window(picture->file, 0, &window) != EXR_ERR_SUCCESS ||
        exr_get_storage(picture->file, 0, &storage) != EXR_ERR_SUCCESS)
        return error_at(err, ERROR_INPUT, path, 0, "is not a complete EXR file");
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return error_at(err, ERROR_INPUT, path, 0, "holds deep pixels, which are not read");
    const int64_t w = (int64_t)window.max.x - window.min.x + 1;
    const int64_t h = (int64_t)window.max.y - window.min.y + 1;
    if (w < 1 || h < 1 || w > IMAGE_SIDE_MAX || h > IMAGE_SIDE_MAX)
        return error_at(err, ERROR_INPUT, path, 0, "has %lld x %lld pixels; sides must be 1 to %d",
                        (long long)w, (long long)h, (int)IMAGE_SIDE_MAX);
    if (!check_channels(picture, path, err))
        return false;
    if (3.0 * 2.0 * (double)w * (double)h > RATIO_LIMIT * (double)memory->size)
        return error_at(err, ERROR_INPUT, path, 0, "is too short for %lld x %lld pixels",
                        (long long)w, (long long)h);
    picture->left = window.min.x;
    picture->top = window.min.y;
    picture->width = (int)w;
    picture->height = (int)h;
    picture->rgb = array_create(3 * (size_t)w * (size_t)h, sizeof(float), "picture", err);
    if (picture->rgb == NULL)
        return false;
    const exr_result_t r = storage == EXR_STORAGE_TILED ? read_tiles(picture) : read_lines(picture);
    if (r != EXR_ERR_SUCCESS)
        return error_at(err, ERROR_INPUT, path, 0, "OpenEXR: %s",
                        memory->message[0] ? memory->message : exr_get_default_error_message(r));
    return true;
}

float *image_read_exr(const char *path, int *width, int *height, Error *err)
{
    return image_read_layer(path, NULL, width, height, err);
}

float *image_read_layer(const char *path, const char *layer, int *width, int *height, Error *err)
{
    assert(path != NULL && width != NULL && height != NULL && err != NULL);
    if (error_is_set(err))
        return NULL;
    Memory memory = { .err = err };
    memory.bytes = file_read(path, READ_LIMIT, &memory.size, err);
    if (memory.bytes == NULL)
        return NULL;
    exr_context_initializer_t init = initializer(&memory);
    init.read_fn = memory_read;
    init.size_fn = memory_size;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    Picture            picture = { 0 };
    for (int k = 0; k < 3; k++)
        snprintf(picture.name[k], sizeof picture.name[k], "%.60s%s%c", layer != NULL ? layer : "",
                 layer != NULL ? "." : "", "RGB"[k]);
    const exr_result_t r = exr_start_read(&picture.file, path, &init);
    bool               ok = r == EXR_ERR_SUCCESS;
    if (!ok)
        error_at(err, ERROR_INPUT, path, 0, "OpenEXR: %s",
                 memory.message[0] ? memory.message : exr_get_default_error_message(r));
    ok = ok && read_picture(&picture, path, &memory, err);
    if (picture.file != NULL)
        exr_finish(&picture.file);
    array_free(memory.bytes);
    if (!ok) {
        array_free(picture.rgb);
        return NULL;
    }
    *width = picture.width;
    *height = picture.height;
    return picture.rgb;
}
