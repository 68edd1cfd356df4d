/* SPDX-License-Identifier: BSD-3-Clause */
/* The solved mesh as PLY, binary little endian: faces with all that their patches know. */
#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "app/place.h"
#include "app/ply_read.h"
#include "base/array.h"
#include "base/file.h"
#include "radiosity/mirrors.h"

/* Exitance over this is the radiance of a diffuse surface. */
static const double PI = 3.14159265358979323846;
/* Reflectance of a photographer's grey card: where the usual brightness is put. */
static const double MID_GREY = 0.18;

typedef struct {
    const Pipeline *pipeline;
    FILE           *out;
    double         *radiosity, *irradiance; /* [vertices * ROOM_BANDS] */
    double         *sent;                   /* [patches * ROOM_BANDS]  radiosity */
    double          scale;                  /* radiosity to display */
    bool            wide;                   /* some face has more than 255 corners */
} Ply;

/* --- bytes, whatever the machine's own order -------------------------------------------------- */

typedef struct {
    unsigned char byte[256];
    size_t        size;
} Record;

static void put_bytes(Record *record, uint32_t value, int bytes)
{
    assert(record->size + (size_t)bytes <= sizeof record->byte);
    for (int i = 0; i < bytes; i++)
        record->byte[record->size++] = (unsigned char)(value >> 8 * i);
}

static void put_float(Record *record, double value)
{
    const float f = (float)value;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    put_bytes(record, bits, 4);
}

static void put_double(Record *record, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_bytes(record, (uint32_t)bits, 4);
    put_bytes(record, (uint32_t)(bits >> 32), 4);
}

static void put_bands(Record *record, const double *value)
{
    for (int band = 0; band < ROOM_BANDS; band++)
        put_float(record, value[band]);
}

static void put_scaled(Record *record, const double *value, double scale)
{
    for (int band = 0; band < ROOM_BANDS; band++)
        put_float(record, scale * value[band]);
}

static void write_record(FILE *out, Record *record)
{
    fwrite(record->byte, 1, record->size, out);
    record->size = 0;
}

/* --- colours to look at ----------------------------------------------------------------------- */

static double auto_scale(const Pipeline *pipeline)
{
    const Solution *solution = pipeline->solution;
    double sum = 0, weight = 0;
    for (uint32_t i = 0; i < solution->count; i++) {
        const double *b = solution->radiosity + ROOM_BANDS * i;
        const double *e = pipeline->emission + ROOM_BANDS * i;
        const double y = rgb_luminance(rgb(b[0], b[1], b[2]));
        if (y > 0 && rgb_max(rgb(e[0], e[1], e[2])) <= 0) {
            sum += pipeline->patches->area[i] * log(y);
            weight += pipeline->patches->area[i];
        }
    }
    return weight > 0 ? MID_GREY / exp(sum / weight) : 1;
}

/* sRGB of IEC 61966-2-1 after a film-like shoulder. */
static uint32_t display_byte(double v)
{
    const double y = -expm1(-fmax(v, 0));
    const double srgb = y <= 0.0031308 ? 12.92 * y : 1.055 * pow(y, 1 / 2.4) - 0.055;
    return (uint32_t)lround(255 * srgb);
}

/* --- header ----------------------------------------------------------------------------------- */

/* Names may hold anything; a comment ends with its line. */
static void put_name(FILE *out, const char *kind, size_t number, const char *name)
{
    fprintf(out, "comment %s %zu ", kind, number);
    for (; *name != '\0'; name++)
        fputc((unsigned char)*name < ' ' ? ' ' : *name, out);
    fputc('\n', out);
}

static void put_header(const Ply *ply)
{
    const Pipeline *pipeline = ply->pipeline;
    const Polygons *soup = &pipeline->scene->polygons;
    const bool lux = pipeline->session->options.units == UNITS_PHOTOMETRIC;
    FILE *out = ply->out;
    fprintf(out, "ply\nformat binary_little_endian 1.0\n"
                 "comment made by isolux " ISOLUX_VERSION "\n"
                 "comment x y z: scene units of %.9g m\n"
                 "comment radiosity: all that leaves, %s\n"
                 "comment irradiance: all that arrives, %s\n"
                 "comment reflectance: share of arriving light sent back, 1\n"
                 "comment area: square scene units, visible_area: without what lies inside solids\n"
                 "comment side: 0 front, 1 back; several faces of a patch have its values\n"
                 "comment red green blue: radiosity / pi * 2^%.4f, shown as sRGB\n",
            pipeline->session->options.unit_m, lux ? "lm/m2" : "W/m2", lux ? "lux" : "W/m2",
            log2(ply->scale * PI));
    ply_notes_put(out, pipeline->scene);
    for (size_t i = 0; i < soup->group_count; i++)
        put_name(out, "group", i, soup->group_name[i]);
    for (size_t i = 0; i < soup->material_count; i++)
        put_name(out, "material", i, soup->materials[i].name);
    fprintf(out, "element vertex %" PRIu32 "\n", pipeline->patches->vertex_count);
    fputs(place_is_far(pipeline->scene) ? PLY_DOUBLES : PLY_FLOATS, out);
    fputs(PLY_VERTEX_LAYOUT, out);
    fprintf(out, "element face %" PRIu32 "\nproperty list %s int vertex_indices\n",
            pipeline->patches->face_count, ply->wide ? "ushort" : "uchar");
    fputs(PLY_FACE_LAYOUT "end_header\n", out);
}

/* --- body ------------------------------------------------------------------------------------- */

static void put_vertices(const Ply *ply)
{
    const Patches *patches = ply->pipeline->patches;
    const Scene *scene = ply->pipeline->scene;
    Record record = { .size = 0 };
    for (uint32_t i = 0; i < patches->vertex_count; i++) {
        const double *b = ply->radiosity + (size_t)ROOM_BANDS * i;
        const Vec3 p = scene_to_file(scene, patches->position[i]);
        const double place[3] = { p.x, p.y, p.z };
        for (int k = 0; k < 3; k++)
            place_is_far(scene) ? put_double(&record, place[k]) : put_float(&record, place[k]);
        for (int band = 0; band < ROOM_BANDS; band++)
            put_bytes(&record, display_byte(ply->scale * b[band]), 1);
        put_bands(&record, b);
        put_bands(&record, ply->irradiance + (size_t)ROOM_BANDS * i);
        write_record(ply->out, &record);
    }
}

/* Piece k of patch i, or the whole patch: its surface and its share of the patch's area. */
static double face_share(const Patches *p, uint32_t i, uint32_t k, uint32_t *surface)
{
    const uint32_t first = p->first_piece[i], piece = first + k;
    if (first == p->first_piece[i + 1]) {
        *surface = p->surface[i];
        return 1;
    }
    *surface = p->piece[piece];
    return p->piece_end[piece] - (k > 0 ? p->piece_end[piece - 1] : 0);
}

static void put_face(const Ply *ply, Record *record, uint32_t face)
{
    const Pipeline *pipeline = ply->pipeline;
    const Patches *p = pipeline->patches;
    const uint32_t i = p->face_patch[face];
    const size_t at = (size_t)ROOM_BANDS * i;
    uint32_t surface;
    const double share = face_share(p, i, face - p->face_of[i], &surface);
    put_bytes(record, p->first_corner[face + 1] - p->first_corner[face], ply->wide ? 2 : 1);
    for (uint32_t k = p->first_corner[face]; k < p->first_corner[face + 1]; k++) {
        put_bytes(record, p->corner[k], 4);
        write_record(ply->out, record);
    }
    const uint32_t numbers[] = { i, surface, p->side[i], p->group[i], p->material[i] };
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        put_bytes(record, numbers[k], 4);
    /* Of a mirror's share that does not go on, the solver knows more per area (mirrors.h). */
    const double kept = mirrors_kept(&pipeline->room, i);
    put_float(record, share * p->area[i]);
    put_float(record, share * (kept > 0 ? pipeline->links->area[i] / kept : p->area[i]));
    put_bands(record, ply->sent + at);
    put_bands(record, pipeline->solution->irradiance + at);
    put_scaled(record, pipeline->reflectance + at, kept);
    write_record(ply->out, record);
}

static void put_faces(const Ply *ply)
{
    const Patches *p = ply->pipeline->patches;
    Record record = { .size = 0 };
    for (uint32_t face = 0; face < p->face_count; face++)
        put_face(ply, &record, face);
}

/* Values at vertices, and whether a face needs a longer count. */
static bool ply_prepare(Ply *ply, Error *err)
{
    const Pipeline *pipeline = ply->pipeline;
    const Patches *p = pipeline->patches;
    const Options *options = &pipeline->session->options;
    const size_t n = (size_t)p->vertex_count * ROOM_BANDS;
    ply->radiosity = array_create(n, sizeof(double), "vertex values", err);
    ply->irradiance = array_create(n, sizeof(double), "vertex values", err);
    ply->sent = array_create((size_t)p->count * ROOM_BANDS, sizeof(double), "radiosity", err);
    if (error_is_set(err))
        return false;
    for (size_t i = 0; i < (size_t)p->count * ROOM_BANDS; i++)
        ply->sent[i] = pipeline->solution->radiosity[i] *
                       mirrors_kept(&pipeline->room, (uint32_t)(i / ROOM_BANDS));
    if (!vertex_radiosity(p, pipeline->links->area, ROOM_BANDS, ply->sent, ply->radiosity, err) ||
        !vertex_radiosity(p, pipeline->links->area, ROOM_BANDS, pipeline->solution->irradiance,
                          ply->irradiance, err))
        return false;
    for (uint32_t i = 0; i < p->face_count; i++) {
        const uint32_t corners = p->first_corner[i + 1] - p->first_corner[i];
        if (corners > UINT16_MAX)
            return error_set(err, ERROR_FAILED, "face %u has %u corners", i, corners);
        ply->wide = ply->wide || corners > UINT8_MAX;
    }
    ply->scale = options->exposure_set ? exp2(options->exposure) / PI : auto_scale(pipeline);
    return true;
}

bool ply_write(Pipeline *pipeline, const char *path, Error *err)
{
    assert(pipeline->solution != NULL && pipeline->solution->bands == ROOM_BANDS);
    assert(pipeline->solution->count == pipeline->patches->count);
    const double begin = progress_now();
    Ply ply = { .pipeline = pipeline };
    OutFile *file = NULL;
    if (ply_prepare(&ply, err))
        file = outfile_open(path, err);
    if (file != NULL) {
        ply.out = outfile_stream(file);
        put_header(&ply);
        put_vertices(&ply);
        put_faces(&ply);
    }
    array_free(ply.radiosity);
    array_free(ply.sent);
    array_free(ply.irradiance);
    const bool written = file != NULL && outfile_commit(file, err);
    pipeline_note(pipeline, STAGE_WRITE, begin);
    return written;
}
