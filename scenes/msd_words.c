/* SPDX-License-Identifier: BSD-3-Clause */
/* The reserved words of MSD. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "scenes/msd.h"

typedef struct {
    const char *text;
    MsdWord     word;
} Entry;

/* Sorted by text. */
static const Entry entries[] = {
    { "AEPS", WORD_EPSILON },
    { "AMBIENT", WORD_UNBUILT },
    { "AMB_LIGHT", WORD_AMB_LIGHT },
    { "ATTENUATION", WORD_UNBUILT },
    { "ATT_DIST_LIGHT", WORD_UNBUILT },
    { "ATT_DIST_SPOT_LIGHT", WORD_UNBUILT },
    { "ATT_POS_LIGHT", WORD_ATT_POS_LIGHT },
    { "ATT_SPOT_LIGHT", WORD_ATT_SPOT_LIGHT },
    { "BACKGROUND", WORD_BACKGROUND },
    { "BEGIN", WORD_BEGIN },
    { "BEZIER", WORD_UNBUILT },
    { "BFEPS", WORD_EPSILON },
    { "BLINN_VOLUME", WORD_UNBUILT },
    { "BOX", WORD_BOX },
    { "BREPOBJ", WORD_BREPOBJ },
    { "BUMP", WORD_UNBUILT },
    { "CAMERA", WORD_CAMERA },
    { "COLORRANGE", WORD_COLORRANGE },
    { "CONE", WORD_CONE },
    { "CORONA", WORD_UNBUILT },
    { "COS", WORD_COS },
    { "CSG_DIFF", WORD_UNBUILT },
    { "CSG_INTER", WORD_UNBUILT },
    { "CSG_UNION", WORD_UNBUILT },
    { "CSPHERE", WORD_UNBUILT },
    { "CUTREGION", WORD_UNBUILT },
    { "CYLINDER_COAT", WORD_CYLINDER_COAT },
    { "DEF", WORD_DEF },
    { "DIFFUSE", WORD_UNBUILT },
    { "DIFFUSE_TRANS", WORD_DIFFUSE_TRANS },
    { "DISC", WORD_DISC },
    { "DIST_LIGHT", WORD_UNBUILT },
    { "DIST_SPOT_LIGHT", WORD_UNBUILT },
    { "ELLIPSOID", WORD_ELLIPSOID },
    { "EMBALL", WORD_UNBUILT },
    { "EMISSIVE", WORD_EMISSIVE },
    { "END", WORD_END },
    { "ENDDEF", WORD_ENDDEF },
    { "ENDFILE", WORD_ENDFILE },
    { "EXP", WORD_EXP },
    { "EXT", WORD_UNBUILT },
    { "EYEP", WORD_EYEP },
    { "FEPS", WORD_EPSILON },
    { "FLOAT", WORD_FLOAT },
    { "FOV", WORD_FOV },
    { "GAMMA", WORD_GAMMACOLOR },
    { "GAMMACOLOR", WORD_GAMMACOLOR },
    { "GEN_CYLINDER", WORD_GEN_CYLINDER },
    { "GRADMAG_OPACITY_RAMP", WORD_UNBUILT },
    { "HEIGHTFIELD", WORD_UNBUILT },
    { "IBUMP", WORD_UNBUILT },
    { "IMPORTANCE", WORD_IMPORTANCE },
    { "INCLUDE", WORD_INCLUDE },
    { "ISOSURFACE", WORD_UNBUILT },
    { "LEVOY_VOLUME", WORD_UNBUILT },
    { "LOOKP", WORD_LOOKP },
    { "MARBLE", WORD_UNBUILT },
    { "MATRIX", WORD_MATRIX },
    { "MATRIX4X3", WORD_MATRIX4X3 },
    { "MAXEYELEVEL", WORD_MAXLEVEL },
    { "MAXLEVEL", WORD_MAXLEVEL },
    { "MAXLIGHTLEVEL", WORD_MAXLEVEL },
    { "METABALL", WORD_UNBUILT },
    { "NOISE", WORD_UNBUILT },
    { "OBJECT", WORD_OBJECT },
    { "OPTICAL_DEPTH", WORD_UNBUILT },
    { "OUTFILE", WORD_OUTFILE },
    { "OUTFORMAT", WORD_UNBUILT },
    { "PARALLEL", WORD_PARALLEL },
    { "PHASE_FUNCTION", WORD_UNBUILT },
    { "PHONG", WORD_PHONG },
    { "PNM_BUMP", WORD_UNBUILT },
    { "PNM_IBUMP", WORD_UNBUILT },
    { "POS_LIGHT", WORD_UNBUILT },
    { "POW", WORD_POW },
    { "QUADRANGLE", WORD_QUADRANGLE },
    { "RAND_BUMP", WORD_UNBUILT },
    { "RAND_IBUMP", WORD_UNBUILT },
    { "REF", WORD_REF },
    { "REFRACTION", WORD_REFRACTION },
    { "REGULAR_GRID", WORD_UNBUILT },
    { "ROT_X", WORD_ROT_X },
    { "ROT_Y", WORD_ROT_Y },
    { "ROT_Z", WORD_ROT_Z },
    { "SAMPLE_EXACT", WORD_UNBUILT },
    { "SCALAR_COLOR_RAMP", WORD_UNBUILT },
    { "SCALAR_OPACITY_RAMP", WORD_UNBUILT },
    { "SCALE", WORD_SCALE },
    { "SCANNEROBJECT", WORD_UNBUILT },
    { "SCREEN", WORD_SCREEN },
    { "SIN", WORD_SIN },
    { "SINE_BUMP", WORD_UNBUILT },
    { "SMBALL", WORD_UNBUILT },
    { "SPECULAR_TRANS", WORD_SPECULAR_TRANS },
    { "SPHERE", WORD_SPHERE },
    { "SPOT_LIGHT", WORD_UNBUILT },
    { "SQR", WORD_SQR },
    { "SQRT", WORD_SQRT },
    { "SRFSHADER", WORD_SURFACE },
    { "SR_BEZIER", WORD_UNBUILT },
    { "SR_POLYLINE", WORD_UNBUILT },
    { "SR_TORUS", WORD_UNBUILT },
    { "STEPSIZE", WORD_UNBUILT },
    { "STEXTURE", WORD_UNBUILT },
    { "STRING_TTF3D", WORD_UNBUILT },
    { "SUPERQ", WORD_UNBUILT },
    { "SURFACE", WORD_SURFACE },
    { "TAN", WORD_TAN },
    { "TETRAHEDRON", WORD_TETRAHEDRON },
    { "TEXTURE_2D", WORD_UNBUILT },
    { "TEXTURE_2D24BIT", WORD_UNBUILT },
    { "TEXTURE_2D24BIT_TRANS", WORD_UNBUILT },
    { "TEXTURE_2D_TRANS", WORD_UNBUILT },
    { "TIME", WORD_TIME },
    { "TORUS", WORD_TORUS },
    { "TRANS", WORD_TRANS },
    { "TRIANGLE", WORD_TRIANGLE },
    { "TRIANGLESTRIP", WORD_UNBUILT },
    { "TURBULENCE", WORD_UNBUILT },
    { "UP", WORD_UP },
    { "USE", WORD_REF },
    { "VECTOR", WORD_VECTOR },
    { "VOLDATA", WORD_UNBUILT },
    { "VOLDATA_NO", WORD_UNBUILT },
    { "WOOD", WORD_UNBUILT },
};

enum { ENTRY_COUNT = sizeof entries / sizeof entries[0], LENGTH_MAX = 24 };

static int compare(const void *key, const void *entry)
{
    return strcmp(key, ((const Entry *)entry)->text);
}

/* Copies in upper case; false when the letters are of both cases. ASCII only: toupper would ask the
 * locale. */
static bool upper_copy(const char *text, size_t length, char *copy)
{
    bool upper = false, lower = false;

    for (size_t i = 0; i < length; i++) {
        const char c = text[i];
        upper = upper || (c >= 'A' && c <= 'Z');
        lower = lower || (c >= 'a' && c <= 'z');
        copy[i] = c >= 'a' && c <= 'z' ? (char)(c - 'a' + 'A') : c;
    }
    copy[length] = 0;
    return !(upper && lower);
}

MsdWord msd_word(const char *text, size_t length)
{
    assert(text != NULL && length > 0);
    char copy[LENGTH_MAX];

    if (length >= sizeof copy || !upper_copy(text, length, copy))
        return WORD_NONE;
    const Entry *found = bsearch(copy, entries, ENTRY_COUNT, sizeof entries[0], compare);
    return found != NULL ? found->word : WORD_NONE;
}
