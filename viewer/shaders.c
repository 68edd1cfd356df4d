/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches and lines. Light is linear; exposure, curve and sRGB are those of render/tonemap.c. */
#include "viewer/shaders.h"

#define TONE                                                                                       \
    "uniform float scale; uniform int tone;\n"                                                     \
    "vec3 curved(vec3 v) {\n"                                                                      \
    "    const float knee = 0.25;\n"                                                               \
    "    if (tone == 1) return min(v, vec3(1));\n"                                                 \
    "    if (tone == 2) return min(v * (1 + v / 16) / (1 + v), vec3(1));\n"                        \
    "    if (tone == 3) {\n"                                                                       \
    "        const float a = 2.51 - 0.18 * 2.43, b = 0.03 - 0.18 * 0.59, c = -0.18 * 0.14;\n"      \
    "        float grey = (-b + sqrt(b * b - 4 * a * c)) / (2 * a);\n"                             \
    "        vec3 x = min(v, vec3(1e6)) * grey / 0.18;\n"                                          \
    "        return min(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), vec3(1));\n"       \
    "    }\n"                                                                                      \
    "    vec3 bent = vec3(knee) + (1 - knee) * (1 - exp(-(v - knee) / (1 - knee)));\n"             \
    "    return mix(v, bent, vec3(greaterThan(v, vec3(knee))));\n"                                 \
    "}\n"                                                                                          \
    "vec3 shown(vec3 light) {\n"                                                                   \
    "    vec3 v = curved(max(light * scale, vec3(0)));\n"                                          \
    "    vec3 high = 1.055 * pow(max(v, vec3(0.0031308)), vec3(1 / 2.4)) - 0.055;\n"               \
    "    return mix(high, 12.92 * v, vec3(lessThanEqual(v, vec3(0.0031308))));\n"                  \
    "}\n"

/* Places on the scale, and colours for them; isolines a pixel and a half wide, none where values
 * are all alike, nor at the scale's lower end. */
#define FALSE_COLOUR                                                                               \
    "uniform int logarithmic; uniform vec2 range; uniform sampler1D colours;\n"                    \
    "uniform int ticks; uniform float tick[8];\n"                                                  \
    "vec3 false_colour(float v) {\n"                                                               \
    "    float t = logarithmic != 0 ? log(max(v, 1e-30) / range.x) / log(range.y / range.x)\n"     \
    "                               : (v - range.x) / (range.y - range.x);\n"                      \
    "    float wide = fwidth(t), line = 0;\n"                                                      \
    "    vec3 c = texture(colours, clamp(t, 0, 1)).rgb;\n"                                         \
    "    for (int k = 0; wide > 1e-7 && k < ticks; k++)\n"                                         \
    "        if (tick[k] > 0.0)\n"                                                                 \
    "        line = max(line, 1 - smoothstep(0.5, 1.3, abs(t - tick[k]) / wide));\n"               \
    "    if (v < -1e38) return vec3(0.3);\n"                                                       \
    "    return mix(c, vec3(t < 0.55 ? 1.0 : 0.0), 0.65 * line);\n"                                \
    "}\n"

const char *const shader_patch_vertex =
    "#version 330 core\n"
    "layout(location = 0) in vec3 place;\n"
    "layout(location = 1) in vec3 light;\n"
    "layout(location = 2) in float value;\n"
    "uniform mat4 matrix;\n"
    "out vec3 smooth_light; out vec3 way; out float smooth_value;\n"
    "void main() {\n"
    "    smooth_light = light;\n"
    "    way = place;\n"
    "    smooth_value = value;\n"
    "    gl_Position = matrix * vec4(place, 1);\n"
    "}\n";

/* Small patches are shaded in whole blocks of pixels, most of which are thrown away: faces only
 * write linear light, scaled to the range of half floats, and shader_resolve_fragment bends it,
 * once a pixel. One program for each kind of face: a card without branches computes all of them. */
#define LINEAR                                                                                     \
    "uniform float scale; out vec4 colour;\n"                                                      \
    "vec4 linear_light(vec3 light) { return vec4(clamp(light * scale, 0.0, 60000.0), 1); }\n"

#define PATCH_NUMBER                                                                               \
    "uniform usamplerBuffer patch_of;\n"                                                           \
    "int patch_number() { return int(texelFetch(patch_of, gl_PrimitiveID).r); }\n"

const char *const shader_smooth_fragment =
    "#version 330 core\n"
    LINEAR
    "in vec3 smooth_light;\n"
    "void main() { colour = linear_light(smooth_light); }\n";

const char *const shader_flat_fragment =
    "#version 330 core\n"
    LINEAR
    PATCH_NUMBER
    "uniform samplerBuffer patch_light;\n"
    "void main() { colour = linear_light(texelFetch(patch_light, patch_number()).rgb); }\n";

const char *const shader_false_smooth_fragment =
    "#version 330 core\n"
    FALSE_COLOUR
    "in float smooth_value; out vec4 colour;\n"
    "void main() { colour = vec4(false_colour(smooth_value), 1); }\n";

const char *const shader_false_flat_fragment =
    "#version 330 core\n"
    FALSE_COLOUR
    PATCH_NUMBER
    "uniform samplerBuffer patch_value; out vec4 colour;\n"
    "void main() {\n"
    "    colour = vec4(false_colour(texelFetch(patch_value, patch_number()).r), 1);\n"
    "}\n";

const char *const shader_back_fragment =
    "#version 330 core\n"
    "uniform int back; in vec3 way; out vec4 colour;\n"
    "void main() {\n"
    "    vec3 n = normalize(cross(dFdx(way), dFdy(way)));\n"
    "    float lit = 0.35 + 0.4 * abs(n.z) + 0.15 * abs(n.y) + 0.05 * abs(n.x);\n"
    "    vec3 paint = back == 1 ? vec3(0.80, 0.10, 0.08) : vec3(0.32, 0.33, 0.35);\n"
    "    bool stripe = back == 1 && mod(gl_FragCoord.x + gl_FragCoord.y, 12.0) < 3.0;\n"
    "    colour = vec4(paint * lit * (stripe ? 0.7 : 1.0), 1);\n"
    "}\n";

/* Linear light and depth of the faces into the window; nothing where there was no face. */
const char *const shader_resolve_fragment =
    "#version 330 core\n"
    TONE
    "uniform sampler2D picture, depth; out vec4 colour;\n"
    "void main() {\n"
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
    "    vec4 v = texelFetch(picture, at, 0);\n"
    "    if (v.a < 0.5) discard;\n"
    "    gl_FragDepth = texelFetch(depth, at, 0).r;\n"
    "    colour = vec4(shown(v.rgb), 1);\n"
    "}\n";

/* The same where no line comes after it that faces could hide. */
const char *const shader_resolve_light_fragment =
    "#version 330 core\n"
    TONE
    "uniform sampler2D picture; out vec4 colour;\n"
    "void main() {\n"
    "    vec4 v = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);\n"
    "    if (v.a < 0.5) discard;\n"
    "    colour = vec4(shown(v.rgb), 1);\n"
    "}\n";

const char *const shader_line_vertex =
    "#version 330 core\n"
    "layout(location = 0) in vec3 place;\n"
    "uniform mat4 matrix; uniform float nearer;\n"
    "void main() {\n"
    "    gl_Position = matrix * vec4(place, 1);\n"
    "    gl_Position.z -= nearer * gl_Position.w;\n"
    "}\n";

const char *const shader_line_fragment =
    "#version 330 core\n"
    "uniform vec4 paint; out vec4 colour;\n"
    "void main() { colour = paint; }\n";

/* One triangle over the whole window; rows of the picture come from the top. */
const char *const shader_picture_vertex =
    "#version 330 core\n"
    "void main() {\n"
    "    vec2 p = vec2(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1);\n"
    "    gl_Position = vec4(p, 0, 1);\n"
    "}\n";

const char *const shader_picture_fragment =
    "#version 330 core\n"
    TONE
    "uniform sampler2D picture; out vec4 colour;\n"
    "void main() {\n"
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
    "    vec4 v = texelFetch(picture, ivec2(at.x, textureSize(picture, 0).y - 1 - at.y), 0);\n"
    "    if (v.a < 0.5) discard;\n"
    "    colour = vec4(shown(v.rgb), 1);\n"
    "}\n";
