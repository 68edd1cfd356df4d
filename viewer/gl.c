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

typedef enum {
    SMOOTH_PROGRAM, FLAT_PROGRAM, FALSE_SMOOTH_PROGRAM, FALSE_FLAT_PROGRAM, BACK_PROGRAM,
    RESOLVE_PROGRAM, RESOLVE_LIGHT_PROGRAM, LINE_PROGRAM, PICTURE_PROGRAM, PROGRAM_COUNT
} ProgramId;
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
    GLuint canvas;                  /* frame buffer for linear light, with its two textures: */
    GLuint canvas_light, canvas_depth;
    int    canvas_width, canvas_height;
    GLuint still, still_colour;     /* frame buffer with the last frame, and its texture */
    int    still_width, still_height;
    bool   still_good;              /* it shows what was drawn last: */
    bool   seen_good;               /* what is held now, as `seen` says */
    GlView seen;
    FalseMap seen_map;
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

static void create_programs(Gl *gl, Error *err)
{
    const char *const face = shader_patch_vertex, *const whole = shader_picture_vertex;
    gl->program[SMOOTH_PROGRAM] = link_program(face, shader_smooth_fragment, err);
    gl->program[FLAT_PROGRAM] = link_program(face, shader_flat_fragment, err);
    gl->program[FALSE_SMOOTH_PROGRAM] = link_program(face, shader_false_smooth_fragment, err);
    gl->program[FALSE_FLAT_PROGRAM] = link_program(face, shader_false_flat_fragment, err);
    gl->program[BACK_PROGRAM] = link_program(face, shader_back_fragment, err);
    gl->program[RESOLVE_PROGRAM] = link_program(whole, shader_resolve_fragment, err);
    gl->program[RESOLVE_LIGHT_PROGRAM] = link_program(whole, shader_resolve_light_fragment, err);
    gl->program[LINE_PROGRAM] = link_program(shader_line_vertex, shader_line_fragment, err);
    gl->program[PICTURE_PROGRAM] = link_program(whole, shader_picture_fragment, err);
}

Gl *gl_create(Error *err)
{
    Gl *gl = array_create(1, sizeof *gl, "window", err);
    if (gl == NULL)
        return NULL;
    create_programs(gl, err);
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
    glGenFramebuffers(1, &gl->canvas);
    glGenTextures(1, &gl->canvas_light);
    glGenTextures(1, &gl->canvas_depth);
    glGenFramebuffers(1, &gl->still);
    glGenTextures(1, &gl->still_colour);
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
    glDeleteFramebuffers(1, &gl->canvas);
    glDeleteTextures(1, &gl->canvas_light);
    glDeleteTextures(1, &gl->canvas_depth);
    glDeleteFramebuffers(1, &gl->still);
    glDeleteTextures(1, &gl->still_colour);
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
    gl->seen_good = false;
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
    gl->seen_good = false;
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
    gl->seen_good = false;
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, gl->picture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, pixel);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glBindTexture(GL_TEXTURE_2D, 0);
}

/* --- drawing ---------------------------------------------------------------------------------- */

static void draw_faces(const Gl *gl, GLenum culled)
{
    glEnable(GL_CULL_FACE);
    glCullFace(culled);
    glBindVertexArray(gl->faces);
    glDrawElements(GL_TRIANGLES, (GLsizei)(3 * gl->mesh->triangle_count), GL_UNSIGNED_INT, NULL);
}

/* A texture at a place of the card, and the program's name for it. */
static void give_texture(const Gl *gl, ProgramId p, const char *name, GLint place, GLenum target,
                         GLuint texture)
{
    glUniform1i(uniform(gl, p, name), place);
    glActiveTexture(GL_TEXTURE0 + (GLenum)place);
    glBindTexture(target, texture);
    glActiveTexture(GL_TEXTURE0);
}

static void texture_texels(GLuint texture, GLint format, int width, int height, GLenum kind,
                           GLenum number)
{
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, kind, number, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

/* Linear light goes into a canvas of the window's size. */
static void begin_canvas(Gl *gl, const GlView *view)
{
    glBindFramebuffer(GL_FRAMEBUFFER, gl->canvas);
    if (gl->canvas_width != view->width || gl->canvas_height != view->height) {
        gl->canvas_width = view->width;
        gl->canvas_height = view->height;
        texture_texels(gl->canvas_light, GL_RGBA16F, view->width, view->height, GL_RGBA,
                       GL_HALF_FLOAT);
        texture_texels(gl->canvas_depth, GL_DEPTH_COMPONENT24, view->width, view->height,
                       GL_DEPTH_COMPONENT, GL_UNSIGNED_INT);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                               gl->canvas_light, 0);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D,
                               gl->canvas_depth, 0);
    }
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

/* Whether anything is drawn behind or before the patches after them. */
static bool needs_depth(const Gl *gl, const GlView *view)
{
    return view->backs != BACKS_HIDDEN || view->outlines || view->gathered ||
           view->picked != PATCH_NONE || (view->rays && gl->ray_count > 0);
}

/* And from there into the window, with its depth where that is asked for. */
static void show_canvas(const Gl *gl, const GlView *view)
{
    const bool deep = needs_depth(gl, view);
    const ProgramId p = deep ? RESOLVE_PROGRAM : RESOLVE_LIGHT_PROGRAM;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glUseProgram(gl->program[p]);
    glUniform1f(uniform(gl, p, "scale"), 1);
    glUniform1i(uniform(gl, p, "tone"), (int)view->tone);
    give_texture(gl, p, "picture", 0, GL_TEXTURE_2D, gl->canvas_light);
    if (deep)
        give_texture(gl, p, "depth", 1, GL_TEXTURE_2D, gl->canvas_depth);
    else
        glDisable(GL_DEPTH_TEST); /* nor is it written then */
    glDisable(GL_CULL_FACE);
    glDepthFunc(GL_ALWAYS);
    glBindVertexArray(gl->none);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_LEQUAL);
    glEnable(GL_DEPTH_TEST);
}

static void set_scale(const Gl *gl, ProgramId p, const FalseMap *map)
{
    uint8_t rgb[3 * FALSE_TEXELS];
    double  tick[FALSE_TICKS];
    float   place[FALSE_TICKS];
    false_map_texels(map, rgb);
    give_texture(gl, p, "patch_value", 2, GL_TEXTURE_BUFFER, gl->patch_value);
    give_texture(gl, p, "colours", 3, GL_TEXTURE_1D, gl->colours);
    glActiveTexture(GL_TEXTURE3);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage1D(GL_TEXTURE_1D, 0, GL_RGB8, FALSE_TEXELS, 0, GL_RGB, GL_UNSIGNED_BYTE, rgb);
    glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glActiveTexture(GL_TEXTURE0);
    const FalseColour *scale = &map->scale;
    const int count = scale->isolines ? false_colour_ticks(scale, FALSE_TICKS, tick) : 0;
    for (int k = 0; k < count; k++)
        place[k] = (float)false_colour_place(scale, tick[k]);
    glUniform1i(uniform(gl, p, "ticks"), count);
    glUniform1fv(uniform(gl, p, "tick"), count, place);
    glUniform2f(uniform(gl, p, "range"), (float)scale->low, (float)scale->high);
    glUniform1i(uniform(gl, p, "logarithmic"), scale->logarithmic);
}

static void use_faces(const Gl *gl, ProgramId p, const float *matrix)
{
    glUseProgram(gl->program[p]);
    glUniformMatrix4fv(uniform(gl, p, "matrix"), 1, GL_FALSE, matrix);
    give_texture(gl, p, "patch_of", 1, GL_TEXTURE_BUFFER, gl->patch_of);
}

static void draw_fronts(Gl *gl, const GlView *view, const float *matrix)
{
    const bool flat = view->shading == SHADING_PATCHES || !gl->smooth;
    const ProgramId p = flat ? FLAT_PROGRAM : SMOOTH_PROGRAM;
    begin_canvas(gl, view);
    use_faces(gl, p, matrix);
    /* Radiosity over pi is the radiance that a picture shows. */
    glUniform1f(uniform(gl, p, "scale"), (float)(exp2(view->exposure) / PI));
    give_texture(gl, p, "patch_light", 0, GL_TEXTURE_BUFFER, gl->patch_light);
    draw_faces(gl, GL_BACK);
    show_canvas(gl, view);
}

static void draw_falsely(const Gl *gl, const GlView *view, const float *matrix)
{
    const ProgramId p = view->shading == SHADING_PATCHES ? FALSE_FLAT_PROGRAM
                                                         : FALSE_SMOOTH_PROGRAM;
    use_faces(gl, p, matrix);
    set_scale(gl, p, view->map);
    draw_faces(gl, GL_BACK);
}

/* Faces go a little back, the more the steeper they are seen: their outlines stay before them. */
static void draw_patches(Gl *gl, const GlView *view, const float *matrix)
{
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1, 1);
    if (view->map != NULL)
        draw_falsely(gl, view, matrix);
    else
        draw_fronts(gl, view, matrix);
    if (view->backs != BACKS_HIDDEN) {
        glDepthFunc(GL_LESS); /* the other side of a plate lies in the same place */
        use_faces(gl, BACK_PROGRAM, matrix);
        glUniform1i(uniform(gl, BACK_PROGRAM, "back"), (int)view->backs);
        draw_faces(gl, GL_FRONT);
        glDepthFunc(GL_LEQUAL);
    }
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

/* A coat of paint over the picked patch, whose triangles follow each other. */
static void draw_picked(const Gl *gl, uint32_t picked)
{
    const ShownMesh *mesh = gl->mesh;
    uint32_t begin = 0, end;
    while (begin < mesh->triangle_count && mesh->triangle_patch[begin] != picked)
        begin++;
    for (end = begin; end < mesh->triangle_count && mesh->triangle_patch[end] == picked;)
        end++;
    glUniform1f(uniform(gl, LINE_PROGRAM, "nearer"), 0);
    line_colour(gl, 1.0f, 0.65f, 0.1f, 0.35f);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glBindVertexArray(gl->faces);
    glDrawElements(GL_TRIANGLES, (GLsizei)(3 * (end - begin)), GL_UNSIGNED_INT,
                   (const void *)(3 * (size_t)begin * sizeof(uint32_t)));
}

static void draw_lines(const Gl *gl, const GlView *view, const float *matrix)
{
    const ProgramId p = LINE_PROGRAM;
    glUseProgram(gl->program[p]);
    glUniformMatrix4fv(uniform(gl, p, "matrix"), 1, GL_FALSE, matrix);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    if (view->picked != PATCH_NONE && view->shading != SHADING_WIRES && !view->gathered)
        draw_picked(gl, view->picked);
    glUniform1f(uniform(gl, p, "nearer"), LINE_NEARER);
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

static void draw_scene(Gl *gl, const GlView *view)
{
    float matrix[16];
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

/* --- the last frame again --------------------------------------------------------------------- */

/* Bytes that pad may differ: then it is drawn once more, which is no harm. */
static bool is_same(const Gl *gl, const GlView *view)
{
    const GlView a = gl->seen, b = *view;
    if (!gl->seen_good || (a.map == NULL) != (b.map == NULL) ||
        memcmp(&a.camera, &b.camera, sizeof a.camera) != 0 ||
        (b.map != NULL && memcmp(&gl->seen_map, b.map, sizeof *b.map) != 0))
        return false;
    return a.width == b.width && a.height == b.height && a.exposure == b.exposure &&
           a.tone == b.tone && a.shading == b.shading && a.backs == b.backs &&
           a.outlines == b.outlines && a.rays == b.rays && a.picked == b.picked &&
           a.gathered == b.gathered;
}

static void copy_colours(const GlView *view, GLuint from, GLuint to)
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
    glBlitFramebuffer(0, 0, view->width, view->height, 0, 0, view->width, view->height,
                      GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

/* A copy of what was drawn: while the view moves it would be for nothing. */
static void keep_still(Gl *gl, const GlView *view)
{
    if (gl->still_width != view->width || gl->still_height != view->height) {
        texture_texels(gl->still_colour, GL_RGBA8, view->width, view->height, GL_RGBA,
                       GL_UNSIGNED_BYTE);
        glBindFramebuffer(GL_FRAMEBUFFER, gl->still);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                               gl->still_colour, 0);
        gl->still_width = view->width;
        gl->still_height = view->height;
    }
    copy_colours(view, 0, gl->still);
    gl->still_good = true;
}

static void note_seen(Gl *gl, const GlView *view)
{
    gl->seen = *view;
    if (view->map != NULL)
        gl->seen_map = *view->map;
    gl->seen_good = true;
    gl->still_good = false;
}

void gl_draw(Gl *gl, const GlView *view)
{
    assert(view->width > 0 && view->height > 0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, view->width, view->height);
    glDisable(GL_SCISSOR_TEST);
    const bool same = gl->mesh != NULL && is_same(gl, view);
    if (same && gl->still_good) {
        copy_colours(view, gl->still, 0);
        return;
    }
    glClearColor(0.11f, 0.12f, 0.13f, 1);
    glDepthMask(GL_TRUE);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (gl->mesh == NULL)
        return;
    draw_scene(gl, view);
    if (same)
        keep_still(gl, view);
    else
        note_seen(gl, view);
}

void gl_read(int width, int height, uint8_t *rgb)
{
    const size_t row = 3 * (size_t)width;
    assert(width > 0 && height > 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < height; y++)
        glReadPixels(0, height - 1 - y, width, 1, GL_RGB, GL_UNSIGNED_BYTE, rgb + row * (size_t)y);
}
