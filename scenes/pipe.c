/* SPDX-License-Identifier: BSD-3-Clause */
/* Values through a pipe: buffered writing in the child, guarded reading in the parent. */
#include "scenes/pipe.h"

#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Longest text in a record: names and messages; what is longer is cut. */
#define PIPE_TEXT_MAX 4096

/* How often a waiting parent asks whether it shall stop. */
static const int poll_milliseconds = 50;

/* --- writing ---------------------------------------------------------------------------------- */

static void bytes_send(PipeWriter *out, const uint8_t *bytes, size_t size)
{
    while (size > 0 && !out->broken) {
        const ssize_t sent = write(out->fd, bytes, size);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0) {
            out->broken = true;
            return;
        }
        bytes += sent;
        size -= (size_t)sent;
    }
}

void pipe_flush(PipeWriter *out)
{
    assert(out != NULL && out->used <= sizeof out->buffer);
    bytes_send(out, out->buffer, out->used);
    out->used = 0;
}

void pipe_write(PipeWriter *out, const void *bytes, size_t size)
{
    assert(out != NULL && (bytes != NULL || size == 0));
    if (size > sizeof out->buffer - out->used)
        pipe_flush(out);
    if (size > sizeof out->buffer) {
        bytes_send(out, bytes, size);
    } else if (size > 0) {
        memcpy(out->buffer + out->used, bytes, size);
        out->used += size;
    }
}

void pipe_put_u32(PipeWriter *out, uint32_t value) { pipe_write(out, &value, sizeof value); }
void pipe_put_u64(PipeWriter *out, uint64_t value) { pipe_write(out, &value, sizeof value); }
void pipe_put_double(PipeWriter *out, double value) { pipe_write(out, &value, sizeof value); }
void pipe_put_rgb(PipeWriter *out, Rgb value) { pipe_write(out, &value, sizeof value); }
void pipe_put_vec3(PipeWriter *out, Vec3 value) { pipe_write(out, &value, sizeof value); }

void pipe_put_text(PipeWriter *out, const char *text)
{
    assert(text != NULL);
    const size_t length = strnlen(text, PIPE_TEXT_MAX);

    pipe_put_u32(out, (uint32_t)length);
    pipe_write(out, text, length);
}

void pipe_put_kind(PipeWriter *out, RecordKind kind)
{
    const uint8_t byte = (uint8_t)kind;
    pipe_write(out, &byte, 1);
}

void pipe_put_warning(PipeWriter *out, const char *code, const char *where, const char *format,
                      ...)
{
    char text[512];
    va_list list;

    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    pipe_put_kind(out, RECORD_WARNING);
    pipe_put_text(out, code);
    pipe_put_text(out, where);
    pipe_put_text(out, text);
}

void pipe_put_material(PipeWriter *out, const Material *material)
{
    pipe_put_kind(out, RECORD_MATERIAL);
    pipe_put_text(out, material->name != NULL ? material->name : "");
    pipe_put_rgb(out, material->reflectance);
    pipe_put_rgb(out, material->emission);
    pipe_put_rgb(out, material->specular);
    pipe_put_double(out, material->exponent);
    pipe_put_rgb(out, material->transmittance);
    pipe_put_double(out, material->ior);
    pipe_put_double(out, material->roughness);
}

void pipe_put_light(PipeWriter *out, const Light *light)
{
    pipe_put_kind(out, RECORD_LIGHT);
    pipe_put_text(out, light->name);
    pipe_put_u32(out, (uint32_t)light->kind);
    pipe_put_vec3(out, light->position);
    pipe_put_vec3(out, light->direction);
    pipe_put_rgb(out, light->intensity);
    pipe_put_double(out, light->cos_inner);
    pipe_put_double(out, light->cos_outer);
}

void pipe_put_camera(PipeWriter *out, const Camera *camera)
{
    pipe_put_kind(out, RECORD_CAMERA);
    pipe_put_text(out, camera->name);
    pipe_put_vec3(out, camera->eye);
    pipe_put_vec3(out, camera->target);
    pipe_put_vec3(out, camera->up);
    pipe_put_double(out, camera->vertical_fov);
    pipe_put_double(out, camera->aspect);
}

/* --- reading ---------------------------------------------------------------------------------- */

double pipe_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Waits for bytes; false when there will be none. */
static bool reader_wait(PipeReader *in)
{
    struct pollfd wish = { .fd = in->fd, .events = POLLIN };

    for (;;) {
        if (monitor_stop(in->monitor)) {
            in->state = PIPE_STOPPED;
            return false;
        }
        if (pipe_clock() > in->deadline) {
            in->state = PIPE_TIMEOUT;
            return false;
        }
        const int ready = poll(&wish, 1, poll_milliseconds);
        if (ready > 0)
            return true;
        if (ready < 0 && errno != EINTR) {
            in->state = PIPE_ENDED;
            return false;
        }
    }
}

static bool reader_fill(PipeReader *in)
{
    assert(in->begin == in->end);
    if (in->state != PIPE_GOOD)
        return false;
    for (;;) {
        if (!reader_wait(in))
            return false;
        const ssize_t got = read(in->fd, in->buffer, sizeof in->buffer);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0) {
            in->state = PIPE_ENDED;
            return false;
        }
        in->begin = 0;
        in->end = (size_t)got;
        return true;
    }
}

bool pipe_read(PipeReader *in, void *bytes, size_t size)
{
    assert(in != NULL && (bytes != NULL || size == 0));
    uint8_t *to = bytes;
    size_t done = 0;

    while (done < size && in->state == PIPE_GOOD) {
        if (in->begin == in->end && !reader_fill(in))
            break;
        const size_t here = in->end - in->begin;
        const size_t take = here < size - done ? here : size - done;
        memcpy(to + done, in->buffer + in->begin, take);
        in->begin += take;
        done += take;
    }
    if (done == size)
        return true;
    memset(to, 0, size);
    return false;
}

uint32_t pipe_get_u32(PipeReader *in)
{
    uint32_t value;
    pipe_read(in, &value, sizeof value);
    return value;
}

uint64_t pipe_get_u64(PipeReader *in)
{
    uint64_t value;
    pipe_read(in, &value, sizeof value);
    return value;
}

double pipe_get_double(PipeReader *in)
{
    double value;
    pipe_read(in, &value, sizeof value);
    return value;
}

Rgb pipe_get_rgb(PipeReader *in)
{
    Rgb value;
    pipe_read(in, &value, sizeof value);
    return value;
}

Vec3 pipe_get_vec3(PipeReader *in)
{
    Vec3 value;
    pipe_read(in, &value, sizeof value);
    return value;
}

void pipe_get_text(PipeReader *in, char *text, size_t size)
{
    assert(text != NULL && size > 0);
    char all[PIPE_TEXT_MAX + 1];
    const uint32_t length = pipe_get_u32(in);

    if (length > PIPE_TEXT_MAX || !pipe_read(in, all, length)) {
        text[0] = 0;
        pipe_nonsense(in);
        return;
    }
    all[length] = 0;
    snprintf(text, size, "%s", all);
}

bool pipe_nonsense(PipeReader *in)
{
    if (in->state == PIPE_GOOD)
        in->state = PIPE_NONSENSE;
    return false;
}
