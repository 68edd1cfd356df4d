/* SPDX-License-Identifier: BSD-3-Clause */
/* View3D's input (.vs3): triangles and convex quadrilaterals with emissivities, F = 3 and 3a.
 *
 * A surface becomes a polygon in a group of its name, one combined with another goes into that
 * one's group. Subsurfaces (windows in a wall) are cut out of their base, so that nothing lies
 * twice; so are null surfaces and masks, which cover their base: a mask and what it covers see
 * only each other, and neither is kept. An obstruction (O) may end after its corners, for View3D
 * reads no more of it: it is black then. Control lines are View3D's own affair and are passed over,
 * and so are, as there, lines of transformations (X).
 */
#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "scenes/import.h"
#include "scenes/text.h"

/* A convex quadrilateral cut by k half-planes has at most 4 + k corners; a subsurface has 4 edges,
 * and a piece is cut by one subsurface after the other. */
enum { PIECE_CORNERS = 24, SURFACE_NUMBERS = 13, LINE_MOST = 1024 };

/* Parts of a surface further apart in area than this, relative, were not inside it. */
static const double AREA_SLACK = 1e-6; /* files give six digits */

/* What lies on a base is in its plane, but for digits that a file does not give: of its size. */
static const double PLANE_SLACK = 1e-3;

typedef struct {
    Vec3     corner[PIECE_CORNERS];
    unsigned count;
} Piece;

typedef struct {
    char     type;          /* S M N O */
    char     name[64];
    Piece    whole;
    uint32_t base, combined; /* numbers from 1, 0: none */
    double   emissivity;
    uint32_t on_first, on_last; /* numbers of what lies on it, in order; 0: nothing does */
    uint32_t on_next;       /* the next on the same base; 0: none */
    unsigned line;
} Vs3Surface;

typedef struct {
    ImportTarget *target;
    TextFile      text;
    int           format;   /* 0: no F line yet, 3, or 33 for 3a */
    Vec3         *vertex;   /* [vertex_count]  number i + 1 */
    size_t        vertex_count, vertex_capacity;
    Vs3Surface   *surface;  /* [surface_count] */
    size_t        surface_count, surface_capacity;
    uint32_t     *group;    /* [surface_count]  in the soup */
    Piece        *piece;    /* of the surface being cut */
    size_t        piece_capacity;
    double        number[SURFACE_NUMBERS]; /* of a 3a surface, as far as read */
    unsigned      numbers, wanted;
    char          shape;    /* R Q T */
    unsigned      masks;
    double        emissivity; /* of the last material, 0: none yet */
    uint32_t      material;
    bool          ended;
} Vs3Reader;

/* --- words ------------------------------------------------------------------------------------ */

static bool whole_number(const Vs3Reader *r, const char **line, const char *what, uint32_t *value,
                         Error *err)
{
    double number = 0;
    if (!text_number(&r->text, line, &number) || !(number >= 0 && number <= 1e9) ||
        number != floor(number))
        return text_error(&r->text, err, "%s must be a number from 0 up", what);
    *value = (uint32_t)number;
    return true;
}

/* Subsurfaces come after their base, combined ones after the first; what is not there itself has no
 * group to share, and is in none. */
static bool check_others(const Vs3Reader *r, const Vs3Surface *s, Error *err)
{
    const size_t number = r->surface_count + 1;
    if (s->base >= number || s->combined >= number)
        return text_error(&r->text, err, "surface %zu names surface %u, which is not there yet",
                          number, s->base >= number ? s->base : s->combined);
    if (s->base > 0 && strchr("SO", r->surface[s->base - 1].type) == NULL)
        return text_error(&r->text, err, "surface %zu lies on surface %u, a mask", number, s->base);
    if (s->type == 'O' && s->base > 0)
        return text_error(&r->text, err, "surface %zu, an obstruction, lies on another", number);
    if (s->combined > 0 && s->type != 'S')
        return text_error(&r->text, err, "surface %zu is no radiating one (S): it cannot be "
                          "combined with another", number);
    if (s->combined > 0 && r->surface[s->combined - 1].type != 'S')
        return text_error(&r->text, err, "surface %zu is combined with surface %u, which is no "
                          "radiating one (S)", number, s->combined);
    return true;
}

/* base, combined, emissivity and name, which end the first line of a surface in both formats. */
static bool read_ending(Vs3Reader *r, const char *line, Vs3Surface *s, Error *err)
{
    const char *rest = line;
    const bool short_one = s->type == 'O' && text_word(&rest).length == 0;
    s->emissivity = 1;
    if (!short_one && (!whole_number(r, &line, "the base surface", &s->base, err) ||
                       !whole_number(r, &line, "the surface to combine with", &s->combined, err)))
        return false;
    if (!short_one && (!text_number(&r->text, &line, &s->emissivity) ||
                       !(s->emissivity > 0 && s->emissivity <= 1)))
        return text_error(&r->text, err, "the emissivity of surface %zu must be above 0, at most 1",
                          r->surface_count + 1);
    text_rest(line, s->name, sizeof s->name);
    if (s->name[0] == '\0')
        snprintf(s->name, sizeof s->name, "surface-%zu", r->surface_count + 1);
    return check_others(r, s, err);
}

static bool store_surface(Vs3Reader *r, const Vs3Surface *s, Error *err)
{
    if (!array_reserve((void **)&r->surface, &r->surface_capacity, r->surface_count + 1,
                       sizeof *r->surface, "surfaces", err))
        return false;
    r->surface[r->surface_count++] = *s;
    if (s->base > 0) {
        Vs3Surface *base = &r->surface[s->base - 1];
        const uint32_t number = (uint32_t)r->surface_count;
        *(base->on_first == 0 ? &base->on_first : &r->surface[base->on_last - 1].on_next) = number;
        base->on_last = number;
    }
    return true;
}

/* --- lines ------------------------------------------------------------------------------------ */

static bool read_format(Vs3Reader *r, const char *line, Error *err)
{
    const Word word = text_word(&line);
    const bool a = word.length == 2 && (word.begin[1] == 'a' || word.begin[1] == 'A');
    if (word.length < 1 || word.begin[0] != '3' || (word.length > 1 && !a))
        return text_error(&r->text, err, "geometry '%.*s' is not read: F 3 and F 3a are",
                          (int)(word.length < 20 ? word.length : 20), word.begin);
    r->format = a ? 33 : 3;
    return true;
}

static bool read_vertex(Vs3Reader *r, const char *line, Error *err)
{
    uint32_t number = 0;
    Vec3 p;
    if (!whole_number(r, &line, "the number of a vertex", &number, err))
        return false;
    if (number != r->vertex_count + 1)
        return text_error(&r->text, err, "vertex %u comes where vertex %zu should be", number,
                          r->vertex_count + 1);
    if (!text_number(&r->text, &line, &p.x) || !text_number(&r->text, &line, &p.y) ||
        !text_number(&r->text, &line, &p.z) || !vec3_finite(p))
        return text_error(&r->text, err, "vertex %u needs three coordinates", number);
    if (!array_reserve((void **)&r->vertex, &r->vertex_capacity, r->vertex_count + 1,
                       sizeof *r->vertex, "vertices", err))
        return false;
    r->vertex[r->vertex_count++] = p;
    return true;
}

/* F 3: the numbers of four vertices, the last 0 in a triangle. */
static bool read_corners(Vs3Reader *r, const char *line, Vs3Surface *s, Error *err)
{
    for (unsigned k = 0; k < 4; k++) {
        uint32_t number = 0;
        if (!whole_number(r, &line, "the corner of a surface", &number, err))
            return false;
        if (number == 0 && k == 3)
            continue;
        if (number == 0 || number > r->vertex_count)
            return text_error(&r->text, err, "surface %zu names vertex %u, but there are %zu",
                              r->surface_count + 1, number, r->vertex_count);
        s->whole.corner[s->whole.count++] = r->vertex[number - 1];
    }
    return read_ending(r, line, s, err) && store_surface(r, s, err);
}

/* F 3a: shape first; the numbers that place it follow, on as many lines as they like. */
static bool read_shape(Vs3Reader *r, const char *line, Vs3Surface *s, Error *err)
{
    const Word word = text_word(&line);
    r->shape = word.length == 1 ? (char)toupper((unsigned char)word.begin[0]) : '?';
    if (strchr("RQT", r->shape) == NULL)
        return text_error(&r->text, err, "the shape of surface %zu must be R, Q or T",
                          r->surface_count + 1);
    r->numbers = 0;
    r->wanted = 5 + (r->shape == 'R' ? 2 : r->shape == 'Q' ? 8 : 6);
    assert(r->wanted <= SURFACE_NUMBERS);
    return read_ending(r, line, s, err) && store_surface(r, s, err);
}

/* Azimuth is clockwise from +y, where the front looks; tilt is 0 for a floor, 180 for a ceiling.
 * Seen from the front, the plane's own x runs to the right and its y up. */
static void place_shape(Vs3Reader *r)
{
    Vs3Surface *s = &r->surface[r->surface_count - 1];
    const double *v = r->number;
    const double azimuth = v[3] * M_PI / 180, tilt = v[4] * M_PI / 180;
    const Vec3 normal = vec3(sin(azimuth) * sin(tilt), cos(azimuth) * sin(tilt), cos(tilt));
    const Vec3 x = vec3(-cos(azimuth), sin(azimuth), 0), y = vec3_cross(normal, x);
    const double box[8] = { 0, 0, v[5], 0, v[5], v[6], 0, v[6] };
    const double *at = r->shape == 'R' ? box : v + 5;
    s->whole.count = r->shape == 'T' ? 3 : 4;
    for (unsigned k = 0; k < s->whole.count; k++)
        s->whole.corner[k] = vec3_mad(vec3_mad(vec3(v[0], v[1], v[2]), at[2 * k], x),
                                      at[2 * k + 1], y);
    r->wanted = 0;
}

static bool read_numbers(Vs3Reader *r, const char *line, Error *err)
{
    while (r->numbers < r->wanted) {
        const char *rest = line;
        if (text_word(&rest).length == 0)
            return true;
        if (!text_number(&r->text, &line, &r->number[r->numbers]) ||
            !isfinite(r->number[r->numbers]))
            return text_error(&r->text, err, "surface %zu needs %u numbers that place it",
                              r->surface_count, r->wanted);
        r->numbers++;
    }
    place_shape(r);
    return true;
}

static bool read_surface(Vs3Reader *r, char type, const char *line, Error *err)
{
    uint32_t number = 0;
    Vs3Surface s = { .type = type, .line = r->text.line };
    if (r->format == 0)
        return text_error(&r->text, err, "a surface before the F line");
    if (!whole_number(r, &line, "the number of a surface", &number, err))
        return false;
    if (number != r->surface_count + 1)
        return text_error(&r->text, err, "surface %u comes where surface %zu should be", number,
                          r->surface_count + 1);
    return r->format == 3 ? read_corners(r, line, &s, err) : read_shape(r, line, &s, err);
}

static bool read_line(Vs3Reader *r, const char *line, Error *err)
{
    const char key = (char)toupper((unsigned char)*line);
    if (r->wanted > 0 && (isdigit((unsigned char)*line) || strchr("+-.", *line) != NULL))
        return read_numbers(r, line, err);
    switch (key) {
    case '\0':
    case '/':
    case 'T':
    case 'C':
    case 'X':
        return true;
    case '*':
    case 'E':
        r->ended = true;
        break;
    case 'F':
        return read_format(r, line + 1, err);
    case 'V':
        return read_vertex(r, line + 1, err);
    case 'S':
    case 'M':
    case 'N':
    case 'O':
        break;
    default:
        return text_error(&r->text, err, "a line begins with '%.20s': T C F V S M N O X E and ! "
                          "are known", line);
    }
    if (r->wanted > 0)
        return text_error(&r->text, err, "surface %zu has %u of the %u numbers that place it",
                          r->surface_count, r->numbers, r->wanted);
    return r->ended || read_surface(r, key, line + 1, err);
}

/* Letters before a comment: from a ! on, or from a / that begins a word. */
static size_t data_length(const char *line)
{
    size_t n = 0;
    while (line[n] != '\0' && line[n] != '!' &&
           !(line[n] == '/' && n > 0 && isspace((unsigned char)line[n - 1])))
        n++;
    return n;
}

static bool read_lines(Vs3Reader *r, Error *err)
{
    char line[LINE_MOST];
    for (const char *next; !r->ended && (next = text_line(&r->text)) != NULL;) {
        const size_t length = data_length(next);
        if (length >= sizeof line)
            return text_error(&r->text, err, "the line is longer than %d letters", LINE_MOST - 1);
        memcpy(line, next, length);
        line[length] = '\0';
        if (!read_line(r, line, err))
            return false;
    }
    if (r->wanted > 0)
        return text_error(&r->text, err, "the file ends within surface %zu", r->surface_count);
    if (r->surface_count == 0)
        return text_error(&r->text, err, "there is no surface");
    return true;
}

/* --- cutting ---------------------------------------------------------------------------------- */

static Vec3 piece_normal(const Piece *p)
{
    Vec3 sum = vec3(0, 0, 0);
    for (unsigned k = 1; k + 1 < p->count; k++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(p->corner[k], p->corner[0]),
                                       vec3_sub(p->corner[k + 1], p->corner[0])));
    return sum; /* twice the area long */
}

static double piece_area(const Piece *p) { return vec3_length(piece_normal(p)) / 2; }

/* The part of p on the side of the plane that `away` points to. */
static Piece piece_clip(const Piece *p, Vec3 point, Vec3 away)
{
    Piece out = { .count = 0 };
    for (unsigned k = 0; k < p->count; k++) {
        const Vec3 a = p->corner[k], b = p->corner[(k + 1) % p->count];
        const double ha = vec3_dot(vec3_sub(a, point), away);
        const double hb = vec3_dot(vec3_sub(b, point), away);
        if (ha >= 0 && out.count < PIECE_CORNERS)
            out.corner[out.count++] = a;
        if (ha * hb < 0 && out.count < PIECE_CORNERS)
            out.corner[out.count++] = vec3_lerp(a, b, ha / (ha - hb));
    }
    return out;
}

static bool add_piece(Vs3Reader *r, size_t *count, const Piece *piece, double least, Error *err)
{
    if (piece->count < 3 || !(piece_area(piece) > least))
        return true;
    if (!array_reserve((void **)&r->piece, &r->piece_capacity, *count + 1, sizeof *r->piece,
                       "parts of a surface", err))
        return false;
    r->piece[(*count)++] = *piece;
    return true;
}

/* Takes `cover` out of all pieces: what lies beyond its first edge, then of the rest what lies
 * beyond its second, ... each a convex piece again. */
static bool cut_out(Vs3Reader *r, size_t *count, const Piece *cover, double least, Error *err)
{
    const size_t before = *count;
    const Vec3 normal = piece_normal(cover);
    for (size_t i = 0; i < before; i++) {
        Piece rest = r->piece[i];
        for (unsigned k = 0; k < cover->count; k++) {
            const Vec3 a = cover->corner[k], b = cover->corner[(k + 1) % cover->count];
            const Vec3 inwards = vec3_cross(normal, vec3_sub(b, a));
            const Piece beyond = piece_clip(&rest, a, vec3_scale(inwards, -1));
            if (!add_piece(r, count, &beyond, least, err))
                return false;
            rest = piece_clip(&rest, a, inwards);
        }
        r->piece[i].count = 0;
    }
    return true;
}

static bool lies_in_plane(const Piece *base, const Piece *cover)
{
    const Vec3 normal = piece_normal(base); /* the length of twice an area: of size squared */
    const double length = vec3_length(normal);
    for (unsigned k = 0; k < cover->count; k++) {
        const Vec3 way = vec3_sub(cover->corner[k], base->corner[0]);
        if (!(fabs(vec3_dot(way, normal)) <= PLANE_SLACK * length * sqrt(length)))
            return false;
    }
    return true;
}

/* Pieces of surface i less all that lies on it: the first *count entries of r->piece, some
 * empty. */
static bool cut_surface(Vs3Reader *r, size_t i, size_t *count, Error *err)
{
    const Vs3Surface *s = &r->surface[i];
    const double area = piece_area(&s->whole), least = area * AREA_SLACK * AREA_SLACK;
    double covered = 0, left = 0;
    *count = 0;
    r->text.line = s->line;
    if (!(area > 0))
        return text_error(&r->text, err, "surface %zu has no area", i + 1);
    if (!add_piece(r, count, &s->whole, 0, err))
        return false;
    for (uint32_t k = s->on_first; k > 0; k = r->surface[k - 1].on_next) {
        const Piece *cover = &r->surface[k - 1].whole;
        if (!lies_in_plane(&s->whole, cover))
            return text_error(&r->text, err, "surface %u, which lies on surface %zu, is not in its "
                              "plane", k, i + 1);
        covered += piece_area(cover);
        if (!cut_out(r, count, cover, least, err))
            return false;
    }
    for (size_t k = 0; k < *count; k++)
        left += r->piece[k].count > 0 ? piece_area(&r->piece[k]) : 0;
    if (!(fabs(area - covered - left) <= AREA_SLACK * area))
        return text_error(&r->text, err, "what lies on surface %zu is not wholly inside it",
                          i + 1);
    return true;
}

/* --- into the soup ---------------------------------------------------------------------------- */

/* A group for surface i: that of the surface it is combined with, else one of its own, numbered
 * when another surface has the name already. */
static bool find_group(Vs3Reader *r, size_t i, Error *err)
{
    const Vs3Surface *s = &r->surface[i];
    const Polygons *soup = r->target->soup;
    char name[96];
    if (s->combined > 0) {
        r->group[i] = r->group[s->combined - 1];
        return true;
    }
    const size_t before = soup->group_count;
    if (!import_add_group(r->target, s->name, &r->group[i], err))
        return false;
    if (soup->group_count > before)
        return true;
    snprintf(name, sizeof name, "%s#%zu", s->name, i + 1);
    return import_add_group(r->target, name, &r->group[i], err);
}

/* Surfaces of one emissivity mostly follow each other. */
static bool find_material(Vs3Reader *r, double emissivity, Error *err)
{
    char name[32];
    const double rho = 1 - emissivity;
    Material material = material_default();
    if (r->emissivity == emissivity)
        return true;
    snprintf(name, sizeof name, "emissivity %g", emissivity);
    material.name = name;
    material.reflectance = rgb(rho, rho, rho);
    r->emissivity = emissivity;
    return import_add_material(r->target, &material, &r->material, err);
}

static bool emit_pieces(Vs3Reader *r, size_t i, size_t count, Error *err)
{
    uint32_t index[PIECE_CORNERS];
    for (size_t k = 0; k < count; k++) {
        const Piece *p = &r->piece[k];
        for (unsigned c = 0; c < p->count; c++)
            if (!import_add_vertex(r->target, p->corner[c], &index[c], err))
                return false;
        if (p->count > 0 &&
            !import_add_face(r->target, index, p->count, r->material, r->group[i], err))
            return false;
    }
    return true;
}

static bool emit_surface(Vs3Reader *r, size_t i, Error *err)
{
    const Vs3Surface *s = &r->surface[i];
    size_t count;
    if (s->type == 'M' || s->type == 'N') {
        r->masks += s->type == 'M';
        return s->base > 0 || text_error(&r->text, err, "surface %zu covers no base", i + 1);
    }
    return find_group(r, i, err) && cut_surface(r, i, &count, err) &&
           find_material(r, s->emissivity, err) && emit_pieces(r, i, count, err);
}

bool import_vs3(ImportTarget *target, Error *err)
{
    assert(target != NULL && err != NULL);
    Vs3Reader r = { .target = target };
    bool good = text_open(&r.text, target->path, import_file_limit, &target->hash, err) &&
                read_lines(&r, err);
    r.group = array_create(r.surface_count, sizeof *r.group, "surfaces", err);
    good = good && r.group != NULL;
    for (size_t i = 0; good && i < r.surface_count; i++)
        good = emit_surface(&r, i, err);
    if (good && r.masks > 0)
        monitor_warn(target->options->monitor, "mask", target->path,
                     "%u masks and what they cover see only each other and are left out", r.masks);
    array_free(r.vertex);
    array_free(r.surface);
    array_free(r.group);
    array_free(r.piece);
    text_close(&r.text);
    return good;
}
