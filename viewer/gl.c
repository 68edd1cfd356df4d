/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenGL, by libepoxy: the only file that knows it, for an outside library has one. */
#include "viewer/gl.h"

#include <assert.h>
#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "viewer/matrix.h"
#include "viewer/shaders.h"

static const double PI = 3.14159265358979323846;

/* Lines lie this far before the faces they outline, of the depth's whole range: more than a depth
 * of 24 bits can mistake at grazing faces, less than is seen. */
static const float LINE_NEARER = 1.0f / (1 << 11);

typedef enum { PATCH_PROGRAM, LINE_PROGRAM, PICTURE_PROGRAM, PROGRAM_COUNT } ProgramId;
typedef enum {
    POSITIONS, LIGHT, CORNERS, EDGES, PATCH_OF, PATCH_LIGHT, RAYS, PATCH_VALUE,
    VERTEX_VALUE, BUFFER_COUNT
} BufferId;

struct Gl {
    GLuint program[PROGRAM_COUNT];
    GLuint buffer[BUFFER_COUNT];
    GLuint patch_of, patch_light, patch_value; /* textures over buffers */
    GLuint colours;                 /* texture: the scale of false colours */
    GLuint picture;                 /* texture: of gl_take_picture */
    GLuint faces, lines, rays, none; /* vertex arrays */
    ShownMesh *mesh;                /* a reference to what the buffers hold */
    Vec3   middle;                  /* places are kept from here: floats are short */
    uint32_t ray_count;
    bool   robust;                  /* the card tells when it has lost the context */
    bool   smooth;                  /* vertices hold the layer shown */
    float *scratch;
    size_t capacity;
};

/* --- programs --------------------------------------------------------------------------------- */

static GLuint compile(GLenum kind, const char *text, Error *err)
{
    char log[300] = "";
    GLint good = 0;
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &text, NULL);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (!good) {
        glGetShaderInfoLog(shader, sizeof log, NULL, log);
        error_set(err, ERROR_FAILED, "OpenGL does not take a shader: %s", log);
    }
    return shader;
}

static GLuint link_program(const char *vertex, const char *fragment, Error *err)
{
    GLint good = 0;
    const GLuint v = compile(GL_VERTEX_SHADER, vertex, err);
    const GLuint f = compile(GL_FRAGMENT_SHADER, fragment, err);
    const GLuint program = glCreateProgram();
    glAttachShader(program, v);
    glAttachShader(program, f);
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    glDeleteShader(v);
    glDeleteShader(f);
    if (!good)
        error_set(err, ERROR_FAILED, "OpenGL does not link its shaders");
    return program;
}

static GLint uniform(const Gl *gl, ProgramId id, const char *name)
{
    return glGetUniformLocation(gl->program[id], name);
}

Gl *gl_create(Error *err)
{
    Gl *gl = array_create(1, sizeof *gl, "window", err);
    if (gl == NULL)
        return NULL;
    gl->program[PATCH_PROGRAM] = link_program(shader_patch_vertex, shader_patch_fragment, err);
    gl->program[LINE_PROGRAM] = link_program(shader_line_vertex, shader_line_fragment, err);
    gl->program[PICTURE_PROGRAM] = link_program(shader_picture_vertex, shader_picture_fragment,
                                                err);
    gl->robust = epoxy_has_gl_extension("GL_ARB_robustness");
    glGenBuffers(BUFFER_COUNT, gl->buffer);
    glGenVertexArrays(1, &gl->faces);
    glGenVertexArrays(1, &gl->lines);
    glGenVertexArrays(1, &gl->rays);
    glGenTextures(1, &gl->patch_of);
    glGenTextures(1, &gl->patch_light);
    glGenTextures(1, &gl->patch_value);
    glGenTextures(1, &gl->colours);
    glGenTextures(1, &gl->picture);
    glGenVertexArrays(1, &gl->none);
    return error_is_set(err) ? gl_destroy(gl) : gl;
}

Gl *gl_destroy(Gl *gl)
{
    if (gl == NULL)
        return NULL;
    for (unsigned k = 0; k < PROGRAM_COUNT; k++)
        glDeleteProgram(gl->program[k]);
    glDeleteBuffers(BUFFER_COUNT, gl->buffer);
    glDeleteVertexArrays(1, &gl->faces);
    glDeleteVertexArrays(1, &gl->lines);
    glDeleteVertexArrays(1, &gl->rays);
    glDeleteTextures(1, &gl->patch_of);
    glDeleteTextures(1, &gl->patch_light);
    glDeleteTextures(1, &gl->patch_value);
    glDeleteTextures(1, &gl->colours);
    glDeleteTextures(1, &gl->picture);
    glDeleteVertexArrays(1, &gl->none);
    shown_mesh_leave(gl->mesh);
    array_free(gl->scratch);
    return array_free(gl);
}

/* Drivers tell in one of two ways: by asking, or by the error of whatever was called. */
bool gl_is_lost(const Gl *gl)
{
    static const GLenum LOST = 0x0507; /* GL_CONTEXT_LOST */
    assert(gl != NULL);
    if (gl->robust && glGetGraphicsResetStatusARB() != GL_NO_ERROR)
        return true;
    bool lost = false;
    GLenum error = glGetError();
    for (int k = 0; k < 16 && error != GL_NO_ERROR; k++) {
        lost = lost || error == LOST;
        error = glGetError();
    }
    return lost;
}

/* --- buffers ---------------------------------------------------------------------------------- */

static void fill(const Gl *gl, BufferId id, GLenum target, size_t bytes, const void *data)
{
    glBindBuffer(target, gl->buffer[id]);
    glBufferData(target, (GLsizeiptr)bytes, data, GL_DYNAMIC_DRAW);
}

static void attribute(const Gl *gl, GLuint array, GLuint index, GLint numbers, BufferId id)
{
    glBindVertexArray(array);
    glBindBuffer(GL_ARRAY_BUFFER, gl->buffer[id]);
    glVertexAttribPointer(index, numbers, GL_FLOAT, GL_FALSE, 0, NULL);
    glEnableVertexAttribArray(index);
}

static void over_buffer(const Gl *gl, GLuint texture, GLenum format, BufferId id)
{
    glBindTexture(GL_TEXTURE_BUFFER, texture);
    glTexBuffer(GL_TEXTURE_BUFFER, format, gl->buffer[id]);
}

static bool reserve(Gl *gl, size_t floats, Error *err)
{
    return array_reserve((void **)&gl->scratch, &gl->capacity, floats, sizeof *gl->scratch,
                         "picture", err);
}

static void put_place(const Gl *gl, Vec3 p, float *out)
{
    const Vec3 from = vec3_sub(p, gl->middle);
    out[0] = (float)from.x;
    out[1] = (float)from.y;
    out[2] = (float)from.z;
}

static bool take_mesh(Gl *gl, ShownMesh *mesh, Error *err)
{
    assert(mesh->vertex_count >= mesh->plain_count);
    const size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    if (!reserve(gl, 3 * vertices, err))
        return false;
    shown_mesh_leave(gl->mesh);
    gl->mesh = shown_mesh_share(mesh);
    gl->middle = vec3_lerp(mesh->lo, mesh->hi, 0.5);
    for (size_t i = 0; i < vertices; i++)
        put_place(gl, mesh->position[i], gl->scratch + 3 * i);
    fill(gl, POSITIONS, GL_ARRAY_BUFFER, 3 * vertices * sizeof(float), gl->scratch);
    attribute(gl, gl->faces, 0, 3, POSITIONS);
    fill(gl, CORNERS, GL_ELEMENT_ARRAY_BUFFER, 3 * triangles * sizeof(uint32_t), mesh->corner);
    attribute(gl, gl->lines, 0, 3, POSITIONS);
    fill(gl, EDGES, GL_ELEMENT_ARRAY_BUFFER, 2 * (size_t)mesh->edge_count * sizeof(uint32_t),
         mesh->edge);
    fill(gl, PATCH_OF, GL_TEXTURE_BUFFER, triangles * sizeof(uint32_t), mesh->triangle_patch);
    over_buffer(gl, gl->patch_of, GL_R32UI, PATCH_OF);
    return true;
}

static bool take_rays(Gl *gl, const Snapshot *snapshot, Error *err)
{
    const size_t ends = 2 * (size_t)snapshot->ray_count;
    if (!reserve(gl, 3 * ends, err))
        return false;
    for (size_t i = 0; i < ends; i++)
        put_place(gl, snapshot->ray[i], gl->scratch + 3 * i);
    fill(gl, RAYS, GL_ARRAY_BUFFER, 3 * ends * sizeof(float), gl->scratch);
    attribute(gl, gl->rays, 0, 3, RAYS);
    gl->ray_count = snapshot->ray_count;
    return true;
}

bool gl_take(Gl *gl, const Snapshot *snapshot, Layer layer, Error *err)
{
    assert(gl != NULL && (unsigned)layer < LAYER_COUNT);
    const size_t patches = snapshot->mesh->patch_count;
    const float *value = snapshot->layer[layer];
    if (snapshot->mesh != gl->mesh && !take_mesh(gl, snapshot->mesh, err))
        return false;
    if (!take_rays(gl, snapshot, err) || !reserve(gl, 4 * patches, err))
        return false;
    for (size_t i = 0; i < patches; i++)
        for (size_t k = 0; k < 3; k++)
            gl->scratch[4 * i + k] = value != NULL ? value[3 * i + k] : 0;
    fill(gl, PATCH_LIGHT, GL_TEXTURE_BUFFER, 4 * patches * sizeof(float), gl->scratch);
    over_buffer(gl, gl->patch_light, GL_RGBA32F, PATCH_LIGHT);
    fill(gl, LIGHT, GL_ARRAY_BUFFER, 3 * (size_t)gl->mesh->vertex_count * sizeof(float),
         snapshot->vertex);
    attribute(gl, gl->faces, 1, 3, LIGHT);
    gl->smooth = layer == LAYER_RADIOSITY;
    glBindVertexArray(0);
    return true;
}

/* NAN does not come through every card: what is not there is below all numbers. */
static const float NOTHING = -3e38f;

static void copy_values(const float *value, size_t count, float *out)
{
    for (size_t i = 0; i < count; i++)
        out[i] = isnan(value[i]) ? NOTHING : value[i];
}

bool gl_take_values(Gl *gl, const float *patch, const float *vertex, Error *err)
{
    assert(gl->mesh != NULL);
    const size_t patches = gl->mesh->patch_count, vertices = gl->mesh->vertex_count;
    if (!reserve(gl, patches > vertices ? patches : vertices, err))
        return false;
    copy_values(patch, patches, gl->scratch);
    fill(gl, PATCH_VALUE, GL_TEXTURE_BUFFER, patches * sizeof(float), gl->scratch);
    over_buffer(gl, gl->patch_value, GL_R32F, PATCH_VALUE);
    copy_values(vertex, vertices, gl->scratch);
    fill(gl, VERTEX_VALUE, GL_ARRAY_BUFFER, vertices * sizeof(float), gl->scratch);
    attribute(gl, gl->faces, 2, 1, VERTEX_VALUE);
    glBindVertexArray(0);
    return true;
}

void gl_take_picture(Gl *gl, const float *pixel, int width, int height)
{
    assert(pixel != NULL && width > 0 && height > 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, gl->picture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, pixel);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glBindTexture(GL_TEXTURE_2D, 0);
}

/* --- drawing ---------------------------------------------------------------------------------- */

static void draw_faces(const Gl *gl, const GlView *view, bool back)
{
    const ProgramId p = PATCH_PROGRAM;
    const bool flat = view->shading == SHADING_PATCHES || (!gl->smooth && view->map == NULL);
    glUniform1i(uniform(gl, p, "back"), back ? (int)view->backs : 0);
    glUniform1i(uniform(gl, p, "flat_light"), flat);
    glEnable(GL_CULL_FACE);
    glCullFace(back ? GL_FRONT : GL_BACK);
    glBindVertexArray(gl->faces);
    glDrawElements(GL_TRIANGLES, (GLsizei)(3 * gl->mesh->triangle_count), GL_UNSIGNED_INT, NULL);
}

static void set_scale(const Gl *gl, const FalseMap *map)
{
    const ProgramId p = PATCH_PROGRAM;
    uint8_t rgb[3 * FALSE_TEXELS];
    double  tick[FALSE_TICKS];
    float   place[FALSE_TICKS];
    glUniform1i(uniform(gl, p, "falsely"), map != NULL);
    glUniform1i(uniform(gl, p, "patch_value"), 2);
    glUniform1i(uniform(gl, p, "colours"), 3);
    if (map == NULL)
        return;
    false_map_texels(map, rgb);
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_BUFFER, gl->patch_value);
    glActiveTexture(GL_TEXTURE3);
    glBindTexture(GL_TEXTURE_1D, gl->colours);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage1D(GL_TEXTURE_1D, 0, GL_RGB8, FALSE_TEXELS, 0, GL_RGB, GL_UNSIGNED_BYTE, rgb);
    glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    const FalseColour *scale = &map->scale;
    const int count = scale->isolines ? false_colour_ticks(scale, FALSE_TICKS, tick) : 0;
    for (int k = 0; k < count; k++)
        place[k] = (float)false_colour_place(scale, tick[k]);
    glUniform1i(uniform(gl, p, "ticks"), count);
    glUniform1fv(uniform(gl, p, "tick"), count, place);
    glUniform2f(uniform(gl, p, "range"), (float)scale->low, (float)scale->high);
    glUniform1i(uniform(gl, p, "logarithmic"), scale->logarithmic);
}

/* Faces go a little back, the more the steeper they are seen: their outlines stay before them. */
static void draw_patches(const Gl *gl, const GlView *view, const float *matrix)
{
    const ProgramId p = PATCH_PROGRAM;
    glUseProgram(gl->program[p]);
    glUniformMatrix4fv(uniform(gl, p, "matrix"), 1, GL_FALSE, matrix);
    /* Radiosity over pi is the radiance that a picture shows. */
    glUniform1f(uniform(gl, p, "scale"), (float)(exp2(view->exposure) / PI));
    glUniform1i(uniform(gl, p, "tone"), (int)view->tone);
    glUniform1i(uniform(gl, p, "picked"),
                view->picked == PATCH_NONE ? -1 : (int)view->picked);
    glUniform1i(uniform(gl, p, "patch_light"), 0);
    glUniform1i(uniform(gl, p, "patch_of"), 1);
    set_scale(gl, view->map);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_BUFFER, gl->patch_of);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_BUFFER, gl->patch_light);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1, 1);
    draw_faces(gl, view, false);
    if (view->backs != BACKS_HIDDEN)
        draw_faces(gl, view, true);
    glDisable(GL_POLYGON_OFFSET_FILL);
}

/* Over the patches, whose depth stays: outlines and rays are still before it. */
static void draw_picture(const Gl *gl, const GlView *view)
{
    const ProgramId p = PICTURE_PROGRAM;
    glUseProgram(gl->program[p]);
    glUniform1f(uniform(gl, p, "scale"), (float)exp2(view->exposure));
    glUniform1i(uniform(gl, p, "tone"), (int)view->tone);
    glUniform1i(uniform(gl, p, "picture"), 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, gl->picture);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(gl->none);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindTexture(GL_TEXTURE_2D, 0);
    glEnable(GL_DEPTH_TEST);
}

static void line_colour(const Gl *gl, float r, float g, float b, float a)
{
    glUniform4f(uniform(gl, LINE_PROGRAM, "paint"), r, g, b, a);
}

static void draw_lines(const Gl *gl, const GlView *view, const float *matrix)
{
    const ProgramId p = LINE_PROGRAM;
    glUseProgram(gl->program[p]);
    glUniformMatrix4fv(uniform(gl, p, "matrix"), 1, GL_FALSE, matrix);
    glUniform1f(uniform(gl, p, "nearer"), LINE_NEARER);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    if (view->outlines || view->shading == SHADING_WIRES) {
        const bool wires = view->shading == SHADING_WIRES;
        const float grey = wires ? 0.75f : 0;
        line_colour(gl, grey, grey, grey, wires ? 0.8f : 0.5f);
        glBindVertexArray(gl->lines);
        glDrawElements(GL_LINES, (GLsizei)(2 * gl->mesh->edge_count), GL_UNSIGNED_INT, NULL);
    }
    if (view->rays && gl->ray_count > 0) {
        line_colour(gl, 1.0f, 0.8f, 0.25f, 0.35f);
        glBindVertexArray(gl->rays);
        glDrawArrays(GL_LINES, 0, (GLsizei)(2 * gl->ray_count));
    }
    glDisable(GL_BLEND);
}

void gl_draw(Gl *gl, const GlView *view)
{
    float matrix[16];
    assert(view->width > 0 && view->height > 0);
    glViewport(0, 0, view->width, view->height);
    glClearColor(0.11f, 0.12f, 0.13f, 1);
    glDepthMask(GL_TRUE);
    glDisable(GL_SCISSOR_TEST);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (gl->mesh == NULL)
        return;
    matrix_of_camera(&view->camera, (double)view->width / view->height, gl->middle,
                     gl->mesh->lo, gl->mesh->hi, matrix);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    if (view->shading != SHADING_WIRES)
        draw_patches(gl, view, matrix);
    if (view->gathered)
        draw_picture(gl, view);
    draw_lines(gl, view, matrix);
    glBindVertexArray(0);
    glUseProgram(0);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
}

void gl_read(int width, int height, uint8_t *rgb)
{
    const size_t row = 3 * (size_t)width;
    assert(width > 0 && height > 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < height; y++)
        glReadPixels(0, height - 1 - y, width, 1, GL_RGB, GL_UNSIGNED_BYTE, rgb + row * (size_t)y);
}
