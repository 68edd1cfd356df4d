/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/msd.h -- the parts of the MSD reader; for scenes/msd_*.c only.
 *
 * One pass over the text: what is read is done at once, there is no tree. An OBJECT is remembered
 * as the place of its text and read again at every REF, under the transform of that REF and with
 * the names of the place where it stands.
 *
 *   msd_words.c       the reserved words
 *   msd_lexer.c       text -> tokens                         msd_messages.c  errors, warnings
 *   msd_names.c       names, scopes, what a name stands for
 *   msd_values.c      numbers, vectors, colours, sizes        msd_matrix.c  transformations
 *   msd_statements.c  files and blocks; declarations, OBJECT, REF
 *   msd_files.c       INCLUDE and BREPOBJ: other files, each read once
 *   msd_placed.c      what BREPOBJ places: faces, or references
 *   msd_world.c       globals, screen, cameras, lights        msd_surface.c materials
 *   msd_things.c      flat objects                            msd_curved.c  round ones
 *   msd_read.c        the reader's beginning and end
 *
 * All functions that read return false once r->err is set. On entry the current token is the first
 * of what they read, on return the first behind it.
 */
#ifndef SCENES_MSD_H
#define SCENES_MSD_H

#include <locale.h>

#include "scenes/internal.h"

typedef enum {
    WORD_NONE,
    WORD_UNBUILT, /* a word of the language that no part of the reader knows yet */
    WORD_AMB_LIGHT, WORD_ATT_POS_LIGHT, WORD_ATT_SPOT_LIGHT, WORD_BACKGROUND, WORD_BEGIN, WORD_BOX,
    WORD_BREPOBJ, WORD_CAMERA, WORD_COLORRANGE, WORD_CONE, WORD_COS, WORD_CYLINDER_COAT, WORD_DEF,
    WORD_DIFFUSE_TRANS, WORD_DISC, WORD_ELLIPSOID, WORD_EMISSIVE, WORD_END, WORD_ENDDEF,
    WORD_ENDFILE, WORD_EPSILON, WORD_EXP, WORD_EYEP, WORD_FLOAT, WORD_FOV, WORD_GAMMACOLOR,
    WORD_GEN_CYLINDER, WORD_IMPORTANCE, WORD_INCLUDE, WORD_LOOKP, WORD_MATRIX,
    WORD_MATRIX4X3, WORD_MAXLEVEL, WORD_OBJECT, WORD_OUTFILE, WORD_PARALLEL, WORD_PHONG, WORD_POW,
    WORD_QUADRANGLE, WORD_REF, WORD_REFRACTION, WORD_ROT_X, WORD_ROT_Y, WORD_ROT_Z, WORD_SCALE,
    WORD_SCREEN, WORD_SIN, WORD_SPECULAR_TRANS, WORD_SPHERE, WORD_SQR, WORD_SQRT, WORD_SURFACE,
    WORD_TAN, WORD_TETRAHEDRON, WORD_TIME, WORD_TORUS, WORD_TRANS, WORD_TRIANGLE, WORD_UP,
    WORD_VECTOR,
    WORD_COUNT
} MsdWord;

typedef enum { TOKEN_END, TOKEN_NUMBER, TOKEN_NAME, TOKEN_WORD, TOKEN_STRING, TOKEN_SIGN } MsdKind;

/* A point in the text of one of the reader's sources. */
typedef struct {
    uint32_t source;
    unsigned line;
    size_t   offset, line_start;
} MsdPlace;

typedef struct {
    MsdKind  kind;
    MsdWord  word;    /* TOKEN_WORD */
    char     sign;    /* TOKEN_SIGN: ( ) < > , ; = + - * / */
    bool     whole;   /* TOKEN_NUMBER: digits only */
    double   number;
    uint32_t symbol;  /* TOKEN_NAME */
    MsdPlace place;   /* of its first byte */
    size_t   end;     /* offset behind its last byte */
} MsdToken;

typedef struct {
    char  *path;      /* as messages call it */
    char  *real;      /* canonical path: tells whether two names are one file */
    char  *text;      /* size bytes and a 0 */
    size_t size;
    bool   active;    /* being read by a file or INCLUDE that has not ended */
} MsdSource;

typedef enum {
    NAME_FLOAT, NAME_VECTOR, NAME_MATRIX, NAME_OBJECT, NAME_CAMERA, NAME_SURFACE
} NameKind;

typedef struct {
    MsdPlace place;   /* where its text begins */
    double   range;   /* COLORRANGE there */
    bool     busy;    /* being read: a REF to it would never end */
    bool     body;    /* its text is statements up to ENDDEF, not one object */
} MsdObject;

/* What a name stands for, in one scope. */
typedef struct {
    uint32_t symbol, scope, hidden; /* hidden: the binding of the same symbol further out */
    NameKind kind;
    union {
        double    number;
        Vec3      vector;
        Affine    matrix;
        MsdObject object;
        Camera    camera;
        uint32_t  surface;          /* material, or MSD_NONE while only checking */
    } as;
} MsdBinding;

#define MSD_NONE UINT32_MAX

typedef struct {
    char    *text;
    MsdWord  word;      /* of the language, or WORD_NONE: a name */
    uint32_t binding;   /* innermost, or MSD_NONE */
    uint32_t group;     /* of the soup that has this name, or MSD_NONE: not asked for yet */
    unsigned materials; /* of a SURFACE's number: how many different ones were made */
} MsdSymbol;

typedef struct {
    size_t   bindings; /* how many there were when the scope began */
    unsigned hidden;   /* how many REFs are reading text from outside this scope */
} MsdScope;

/* A material's values, for finding one that is there already. */
typedef struct {
    double value[22];
} MsdMaterialKey;

typedef struct {
    char    *real;
    Polygons polygons; /* as in the file, untransformed */
    Vec3     lo, hi;   /* around them */
    bool     used;     /* placed once already */
    bool     moved;    /* polygons are now the scene's prototype of this number: */
    uint32_t prototype;
} MsdImport;

/* A mesh in its place. Its faces among the soup's: none when it is kept by reference. */
typedef struct {
    size_t   import;
    uint32_t material, group; /* group: MSD_NONE: those of the file */
    Affine   map;
    size_t   polygon, polygons, vertex, vertices, shape, shapes; /* first, how many */
} MsdPlaced;

typedef struct {
    Scene                  *scene;
    const SceneReadOptions *options;
    Error                  *err;
    locale_t                locale; /* a decimal point is a point, whatever the user's locale */
    /* limits and what was used of them */
    uint64_t objects_max, objects, text_max, text_used;
    unsigned depth;
    bool     files_allowed;
    /* text */
    MsdSource *sources;
    size_t     source_count, source_capacity;
    MsdPlace   cursor; /* behind the current token */
    MsdToken   token;
    char      *string; /* value of the last TOKEN_STRING */
    size_t     string_capacity;
    /* names */
    MsdSymbol  *symbols;
    size_t      symbol_count, symbol_capacity;
    uint32_t   *symbol_slot; /* [symbol_slots]  hash table: symbol + 1, 0: free */
    size_t      symbol_slots;
    MsdBinding *bindings;
    size_t      binding_count, binding_capacity;
    MsdScope   *scopes;
    size_t      scope_count, scope_capacity;
    /* materials */
    MsdMaterialKey *keys; /* [key_count]  of the scene's materials, in their order */
    size_t          key_count, key_capacity;
    uint32_t       *key_slot;
    size_t          key_slots;
    MsdImport      *imports;
    size_t          import_count, import_capacity;
    MsdPlaced      *placed;   /* [placed_count]  none with INSTANCES_FLATTEN */
    size_t          placed_count, placed_capacity;
    uint64_t        repeated; /* faces of meshes that were placed before */
    bool            kept;     /* meshes are no longer put among the soup's faces */
    /* what holds for the next object */
    Affine   map;
    uint32_t group;        /* symbol of the group's name; MSD_NONE: each object its own */
    uint32_t override;     /* material of all objects, or MSD_NONE: their own surfaces */
    double   colour_range;
    unsigned dry;          /* > 0: a declaration is checked, nothing is made */
    unsigned includes;     /* depth of INCLUDE */
    unsigned made[WORD_COUNT]; /* objects of each kind, for names */
} MsdReader;

/* Paths, and what is quoted from a file, are cut to this in messages. */
enum { MSD_PATH_MAX = 4096 };

/* --- words and text -------------------------------------------------------------------------- */

/* WORD_NONE when it is a name: not in the table, or in mixed case. */
MsdWord msd_word(const char *text, size_t length);

/* Reads the next token. */
bool msd_next(MsdReader *r);
/* Makes the token at a place the current one. */
bool msd_jump(MsdReader *r, MsdPlace place);
/* Reads a file name, quoted or bare, behind the current token into buffer, and the token behind. */
bool msd_file_name(MsdReader *r, char *buffer, size_t size);
/* Error at a place; always false. */
bool msd_error(MsdReader *r, MsdPlace place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* "found the current token, expected ..."; always false. */
bool msd_expected(MsdReader *r, const char *what);
void msd_warn(MsdReader *r, MsdPlace place, const char *code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* "file:line:column" of a place. */
enum { MSD_WHERE_MAX = 320 };
void msd_where(const MsdReader *r, MsdPlace place, char where[MSD_WHERE_MAX]);
/* An error of another part, with the place put before it; always false. */
bool msd_error_from(MsdReader *r, MsdPlace place, const Error *cause);

static inline bool msd_is(const MsdReader *r, char sign)
{
    return r->token.kind == TOKEN_SIGN && r->token.sign == sign;
}
static inline bool msd_is_word(const MsdReader *r, MsdWord word)
{
    return r->token.kind == TOKEN_WORD && r->token.word == word;
}
/* Reads over a sign or word that must stand here. */
bool msd_take(MsdReader *r, char sign);
bool msd_take_word(MsdReader *r, MsdWord word, const char *what);
/* Counts one level of nesting, refused when there are too many; undone by r->depth--. */
bool msd_deeper(MsdReader *r);

/* --- names ----------------------------------------------------------------------------------- */

bool msd_symbol(MsdReader *r, const char *text, size_t length, uint32_t *symbol);
/* Innermost visible binding of a symbol, or NULL. Valid until the next definition. */
MsdBinding *msd_lookup(MsdReader *r, uint32_t symbol);
/* The same for SURFACE nr, kept among the names as "#nr". */
bool msd_surface_symbol(MsdReader *r, uint32_t number, uint32_t *symbol);
/* Defines in the present scope, over what stood there. */
bool msd_define(MsdReader *r, const MsdBinding *binding);
bool msd_scope_begin(MsdReader *r);
void msd_scope_end(MsdReader *r);
/* "a FLOAT", "a VECTOR", ... */
const char *msd_kind_name(NameKind kind);
/* The current token must name something of that kind: *index into bindings; reads over it. */
bool msd_named(MsdReader *r, NameKind kind, uint32_t *index);

/* --- values ---------------------------------------------------------------------------------- */

bool msd_number(MsdReader *r, double *value);
/* A number in [least, most] and, when `open`, not `least` itself. */
bool msd_number_in(MsdReader *r, const char *what, double least, bool open, double most,
                   double *value);
bool msd_length(MsdReader *r, const char *what, double *value); /* > 0 */
/* Digits only. */
bool msd_integer(MsdReader *r, const char *what, uint32_t least, uint32_t most, uint32_t *value);
bool msd_vector(MsdReader *r, Vec3 *value);
bool msd_direction(MsdReader *r, const char *what, Vec3 *unit); /* not zero */
bool msd_colour(MsdReader *r, Rgb *value); /* >= 0, divided by COLORRANGE */
/* <a>, <a, b> or <a, b, c>, each > 0 unless zero is allowed; *count says how many. */
bool msd_sizes(MsdReader *r, int least, int most, bool zero, double value[3], int *count);
bool msd_string(MsdReader *r, const char *what, char *buffer, size_t size);
bool msd_starts_matrix(MsdReader *r);
bool msd_matrix(MsdReader *r, Affine *value);

/* --- statements ------------------------------------------------------------------------------ */

typedef enum { IN_FILE, IN_INCLUDE, IN_BLOCK } MsdWhere;

/* What an object's word has settled before its data are read. */
typedef struct {
    MsdWord  word;
    MsdPlace place;
    uint32_t material; /* MSD_NONE while only checking */
    char     name[24]; /* the word in lower case */
} MsdThing;

/* All statements of a source. */
bool msd_file(MsdReader *r, uint32_t source, MsdWhere where);
/* Statements up to the word `end`, in a scope of their own. */
bool msd_block(MsdReader *r, MsdWord end);
/* [matrix] object. */
bool msd_object(MsdReader *r);
/* FLOAT, VECTOR, MATRIX, OBJECT, CAMERA; DEF name ... ENDDEF. */
bool msd_declaration(MsdReader *r);
bool msd_definition(MsdReader *r);
bool msd_reference(MsdReader *r);
bool msd_include(MsdReader *r);
/* Makes text (taken over) a source; real may be NULL. */
bool msd_source_add(MsdReader *r, const char *path, const char *real, char *text, size_t size,
                    uint32_t *index);
/* The same from a file, read once however often it is asked for; `from` is where it is named, or
 * NULL for the scene file itself. */
bool msd_source_open(MsdReader *r, const char *path, const MsdPlace *from, uint32_t *index);
bool msd_brep(MsdReader *r, const MsdThing *thing);
/* Places a mesh read before; group MSD_NONE: those of its file. */
bool msd_place(MsdReader *r, const MsdThing *thing, size_t import, uint32_t group);
/* Hands what is kept by reference to the scene. */
bool msd_placed_finish(MsdReader *r);
bool msd_surface(MsdReader *r);
/* The current token's number is a SURFACE: *material, MSD_NONE while only checking. */
bool msd_surface_use(MsdReader *r, uint32_t *material);
/* The current token's word is a global, SCREEN or a light. */
bool msd_is_global(const MsdReader *r);
bool msd_global(MsdReader *r, bool included);
bool msd_camera(MsdReader *r, uint32_t symbol, Camera *camera);
/* An object of one word and its data, SPHERE to BREPOBJ. */
bool msd_thing(MsdReader *r);
bool msd_curved(MsdReader *r, const MsdThing *thing);
/* No ray can be cast to where coordinates overflow: false and an error. */
bool msd_reachable(MsdReader *r, MsdPlace place, Vec3 p);
/* Counts objects about to be made, refused when there are too many. */
bool msd_count(MsdReader *r, MsdPlace place, uint64_t more);
/* Group of an object that is about to be made: called once for each. */
bool msd_group(MsdReader *r, const MsdThing *thing, uint32_t *group);

#endif
