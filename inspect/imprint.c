/* SPDX-License-Identifier: BSD-3-Clause */
/* Largest faces first, each cut by what meets it; then all pieces as one soup again. */
#include "inspect/imprint.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"
#include "math/tolerance.h"

/* One face may take this share of the pieces: things of many small faces that stand on a large one
 * must leave some for the walls. */
enum { PIECES_MOST = 20000, FACE_PIECES_LEAST = 64, FACE_SHARE = 4, A_STEP = 256 };

/* Faces smaller than this share of the whole area are left to the sampling of patches: they are
 * smaller than any patch, and there are millions of them. */
static const double LEAST_SHARE = 1e-6;

/* In Imprinter.first: nothing is left of the face. */
static const uint32_t GONE = UINT32_MAX;

typedef struct {
    uint32_t face;
    double   area;
} FaceRank;

typedef struct {
    ImprintParts    parts;
    ImprintContacts contacts;
    ImprintKnife    knife;
    ImprintPoints   points;
    ImprintPieces   raw;          /* of the face being cut, before they are made to meet */
    ImprintPieces   done;         /* of all faces that were cut */
    uint32_t       *first, *count;/* [polygons]  pieces of a face in `done`; count 0: as it was */
    ImprintLine    *line;         /* barriers of the face being cut */
    uint32_t        lines;
    size_t          line_capacity;
    FaceRank       *rank;         /* [ranked]  largest first */
    uint32_t        ranked, left; /* left: pieces that may still be added */
    uint32_t        face_most;    /* to one face */
    uint32_t        pieces;       /* added so far */
    ImprintFate     fate;         /* of the face being cut */
    ImprintReport   report;
    const Monitor  *monitor;
    Imprint        *out;
    Error          *err;
} Imprinter;

/* --- cutting ---------------------------------------------------------------------------------- */

static int larger_first(const void *a, const void *b)
{
    const FaceRank *x = a, *y = b;
    if (x->area != y->area)
        return x->area > y->area ? -1 : 1;
    return (x->face > y->face) - (x->face < y->face);
}

static bool rank_faces(Imprinter *im)
{
    const ImprintParts *parts = &im->parts;
    const size_t faces = parts->soup->polygon_count;
    double total = 0;
    im->rank = array_create(faces, sizeof *im->rank, "face contacts", im->err);
    if (im->rank == NULL)
        return false;
    for (uint32_t k = 0; k < parts->count; k++)
        total += parts->part[k].area;
    for (uint32_t i = 0; i < faces; i++) {
        double area = 0;
        for (uint32_t k = parts->first[i]; k < parts->first[i + 1]; k++)
            area += parts->part[k].area;
        if (area > 0 && area >= LEAST_SHARE * total)
            im->rank[im->ranked++] = (FaceRank){ i, area };
    }
    qsort(im->rank, im->ranked, sizeof *im->rank, larger_first);
    return true;
}

static bool keep_barriers(Imprinter *im)
{
    const ImprintContacts *c = &im->contacts;
    if (!array_reserve((void **)&im->line, &im->line_capacity, (size_t)im->lines + c->count,
                       sizeof *im->line, "face contacts", im->err))
        return false;
    for (uint32_t k = 0; k < c->count; k++)
        if (c->line[k].barrier)
            im->line[im->lines++] = c->line[k];
    return true;
}

static bool go_on(const Imprinter *im, uint32_t step)
{
    if (step % A_STEP == 0 && monitor_stop(im->monitor))
        return error_set(im->err, ERROR_STOPPED, "stopped while looking for faces that touch");
    return true;
}

/* Counts the face among those left when others touch it within its border. */
static bool leave(Imprinter *im, uint32_t face)
{
    const ImprintParts *parts = &im->parts;
    for (uint32_t k = parts->first[face]; k < parts->first[face + 1]; k++) {
        if (!go_on(im, k) || !imprint_contacts_find(parts, k, &im->contacts, im->err))
            return false;
        if (im->contacts.inner > 0 || im->contacts.cover_count > 0)
            return imprint_report_left(&im->report, parts, k, &im->contacts, im->out, im->err);
    }
    return true;
}

/* What the knife and the lines say of a part that was cut. */
static void note_fate(Imprinter *im)
{
    const ImprintKnife *knife = &im->knife;
    ImprintFate *fate = &im->fate;
    if (!fate->cut && im->contacts.inner > 0 && knife->now.count > 1) {
        fate->cut = true;
        fate->by = im->contacts.line[0].face;
        fate->cut_at = vec3_lerp(im->contacts.line[0].end[0], im->contacts.line[0].end[1], 0.5);
    }
    if (!fate->covered && knife->covered) {
        fate->covered = true;
        fate->cover = knife->cover;
        fate->covered_at = knife->covered_at;
    }
    fate->overlapped = fate->overlapped || knife->overlapped;
    fate->covered_area += knife->covered_area;
}

/* Whether a point lies on the outline of a face. */
static bool on_outline(const Polygons *soup, uint32_t face, Vec3 p, double tolerance)
{
    const uint32_t first = soup->first[face], count = soup->first[face + 1] - first;
    for (uint32_t k = 0; k < count; k++) {
        const Vec3 a = soup->position[soup->corner[first + k]];
        const Vec3 way = vec3_sub(soup->position[soup->corner[first + (k + 1) % count]], a);
        const double square = vec3_dot(way, way);
        const double t = square > 0 ? vec3_dot(vec3_sub(p, a), way) / square : 0;
        if (vec3_length(vec3_sub(p, vec3_mad(a, fmin(fmax(t, 0), 1), way))) <= tolerance)
            return true;
    }
    return false;
}

/* Whether the parts of a face must part though none was cut: another stands on the line between
 * two, or lies on one of a face that is bent there, and so closes one part's back alone. */
static bool must_part(const Imprinter *im, uint32_t face)
{
    const ImprintParts *parts = &im->parts;
    const uint32_t first = parts->first[face], last = parts->first[face + 1];
    if (last - first < 2)
        return false;
    for (uint32_t k = first + 1; k < last && im->fate.flush; k++)
        for (uint32_t i = 0; i < parts->part[k].count; i++) {
            const Vec3 p = imprint_corner(parts, &parts->part[k], i);
            const ImprintPart *part = &parts->part[first];
            if (fabs(vec3_dot(part->normal, p) - part->level) > 2 * part->tolerance)
                return true;
        }
    for (uint32_t k = 0; k < im->lines; k++) {
        const Vec3 middle = vec3_lerp(im->line[k].end[0], im->line[k].end[1], 0.5);
        if (!on_outline(parts->soup, face, middle, 2 * parts->part[first].tolerance))
            return true;
    }
    return false;
}

/* Cuts the parts of one face into im->raw, `most` pieces or a few more in all; *changed when there
 * is anything to tell of it. */
static bool cut_parts(Imprinter *im, uint32_t face, uint32_t most, bool *changed)
{
    const ImprintParts *parts = &im->parts;
    const uint32_t last = parts->first[face + 1];
    *changed = false;
    im->fate = (ImprintFate){ 0 };
    im->raw.count = im->lines = 0;
    for (uint32_t k = parts->first[face]; k < last; k++) {
        const uint32_t taken = im->raw.count + (last - k - 1);
        if (!go_on(im, k) || !imprint_contacts_find(parts, k, &im->contacts, im->err)
            || !keep_barriers(im)
            || !imprint_cut(&im->knife, k, &im->contacts, taken < most ? most - taken : 1))
            return false;
        const ImprintPieces *now = &im->knife.now;
        *changed = *changed || now->count != 1 || im->knife.covered;
        note_fate(im);
        im->fate.flush = im->fate.flush || im->contacts.flush;
        for (uint32_t i = 0; i < now->count; i++)
            if (!imprint_pieces_add(&im->raw, now->corner + now->first[i], NULL,
                                    now->first[i + 1] - now->first[i], im->err))
                return false;
    }
    *changed = *changed || must_part(im, face);
    return true;
}

/* The face as it was, with its edges marked. */
static bool take_whole(Imprinter *im, uint32_t face)
{
    const Polygons *soup = im->parts.soup;
    im->raw.count = 0;
    return imprint_pieces_add(&im->raw, soup->corner + soup->first[face], NULL,
                              soup->first[face + 1] - soup->first[face], im->err);
}

static bool cut_face(Imprinter *im, uint32_t face)
{
    bool changed;
    const uint32_t parts = im->parts.first[face + 1] - im->parts.first[face];
    const uint32_t most = 1 + (im->left < im->face_most ? im->left : im->face_most);
    /* A cut face comes in its parts, at the least. */
    if (im->left == 0 || parts > most)
        return leave(im, face);
    if (!cut_parts(im, face, most, &changed))
        return false;
    if (changed && parts > 0 && im->raw.count == 0) {
        im->first[face] = GONE; /* others cover it altogether */
        return imprint_report(&im->report, &im->parts, face, &im->fate, 0, im->out, im->err);
    }
    const bool cut = changed;
    if (!cut && im->lines == 0)
        return true;
    if (!cut && !take_whole(im, face))
        return false;
    im->first[face] = im->done.count;
    const ImprintPart *part = &im->parts.part[im->parts.first[face]];
    if (!imprint_seams(&im->raw, im->points.position, im->line, im->lines, part->tolerance,
                       &im->done, im->err))
        return false;
    const uint32_t count = im->done.count - im->first[face];
    im->count[face] = count;
    im->pieces += count - 1;
    im->left -= count - 1 < im->left ? count - 1 : im->left;
    return !cut
        || imprint_report(&im->report, &im->parts, face, &im->fate, count, im->out, im->err);
}

static bool cut_all(Imprinter *im)
{
    const size_t faces = im->parts.soup->polygon_count;
    im->first = array_create(faces, sizeof *im->first, "face contacts", im->err);
    im->count = array_create(faces, sizeof *im->count, "face contacts", im->err);
    if (error_is_set(im->err) || !rank_faces(im))
        return false;
    for (uint32_t k = 0; k < im->ranked; k++)
        if (!go_on(im, k) || !cut_face(im, im->rank[k].face))
            return false;
    return true;
}

/* --- as one soup ------------------------------------------------------------------------------ */

static void add_polygon(Imprint *out, const Polygons *from, uint32_t face, const uint32_t *corner,
                        const uint8_t *contact, uint32_t count)
{
    Polygons *soup = &out->soup;
    const size_t i = soup->polygon_count++;
    const uint32_t at = soup->first[i];
    memcpy(soup->corner + at, corner, count * sizeof *corner);
    if (contact != NULL)
        memcpy(soup->contact + at, contact, count);
    soup->material[i] = from->material[face];
    soup->group[i] = from->group[face];
    out->face[i] = face;
    soup->first[i + 1] = at + count;
}

static void add_piece(Imprinter *im, uint32_t face, uint32_t piece)
{
    const ImprintPieces *done = &im->done;
    const uint32_t at = done->first[piece];
    add_polygon(im->out, im->parts.soup, face, done->corner + at, done->contact + at,
                done->first[piece + 1] - at);
}

static bool assemble(Imprinter *im)
{
    static const char what[] = "pieces of faces";
    const Polygons *from = im->parts.soup;
    Imprint *out = im->out;
    const size_t polygons = from->polygon_count + im->done.count;
    const size_t corners = (from->polygon_count > 0 ? from->first[from->polygon_count] : 0)
                         + (im->done.count > 0 ? im->done.first[im->done.count] : 0);
    out->soup = *from;
    out->soup.first = array_create(polygons + 1, sizeof *out->soup.first, what, im->err);
    out->soup.corner = array_create(corners, sizeof *out->soup.corner, what, im->err);
    out->soup.material = array_create(polygons, sizeof *out->soup.material, what, im->err);
    out->soup.group = array_create(polygons, sizeof *out->soup.group, what, im->err);
    out->soup.position = im->points.position;
    out->soup.vertex_count = im->points.count;
    im->points.position = NULL;
    out->soup.normal = NULL; /* asked of the original, face by face */
    out->soup.normal_count = out->soup.normal_capacity = 0;
    out->soup.polygon_count = 0;
    out->original = from->polygon_count;
    out->face = array_create(polygons, sizeof *out->face, what, im->err);
    out->soup.contact = array_create(corners, sizeof *out->soup.contact, what, im->err);
    if (error_is_set(im->err))
        return false;
    for (uint32_t i = 0; i < from->polygon_count; i++)
        if (im->count[i] > 0)
            add_piece(im, i, im->first[i]);
        else if (im->first[i] != GONE)
            add_polygon(out, from, i, from->corner + from->first[i], NULL,
                        from->first[i + 1] - from->first[i]);
    out->soup.origin_first = out->soup.polygon_count;
    for (uint32_t i = 0; i < from->polygon_count; i++)
        for (uint32_t k = 1; k < im->count[i]; k++)
            add_piece(im, i, im->first[i] + k);
    out->pieces = im->pieces;
    return true;
}

bool imprint_create(const Polygons *soup, const ImprintOptions *options, Imprint *out,
                    const Monitor *monitor, Error *err)
{
    assert(soup != NULL && out != NULL && err != NULL);
    *out = (Imprint){ 0 };
    if (error_is_set(err))
        return false;
    const uint32_t most = options != NULL && options->most > 0 ? options->most : PIECES_MOST;
    const uint32_t share = most / FACE_SHARE;
    Imprinter im = { .out = out, .err = err, .left = most, .monitor = monitor,
                     .face_most = share > FACE_PIECES_LEAST ? share : FACE_PIECES_LEAST };
    if (options != NULL) {
        im.contacts.keep_whole = options->keep_whole;
        im.contacts.keep_covered = options->keep_covered;
        im.report.defects = options->defects;
    }
    im.knife = (ImprintKnife){ .parts = &im.parts, .points = &im.points, .err = err };
    bool ok = imprint_parts_create(&im.parts, soup, err)
           && array_reserve((void **)&im.points.position, &im.points.capacity,
                            soup->vertex_count + 1, sizeof *im.points.position, "vertices", err);
    if (ok && soup->vertex_count > 0)
        memcpy(im.points.position, soup->position, soup->vertex_count * sizeof *soup->position);
    im.points.count = soup->vertex_count;
    ok = ok && cut_all(&im) && assemble(&im);
    if (ok)
        imprint_tell(&im.report, soup, out, monitor);
    imprint_parts_clear(&im.parts);
    imprint_contacts_clear(&im.contacts);
    imprint_knife_clear(&im.knife);
    imprint_pieces_clear(&im.raw);
    imprint_pieces_clear(&im.done);
    array_free(im.points.position);
    array_free(im.first);
    array_free(im.count);
    array_free(im.line);
    array_free(im.rank);
    if (!ok)
        imprint_clear(out);
    return ok;
}

void imprint_clear(Imprint *imprint)
{
    array_free(imprint->soup.position);
    array_free(imprint->soup.first);
    array_free(imprint->soup.corner);
    array_free(imprint->soup.material);
    array_free(imprint->soup.group);
    array_free(imprint->face);
    array_free(imprint->soup.contact);
    *imprint = (Imprint){ 0 };
}
