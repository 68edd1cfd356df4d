/* SPDX-License-Identifier: BSD-3-Clause */
/* Whole files in and out, and the hash of bytes. The only file that includes xxHash. */
#include "base/file.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/array.h"

struct OutFile {
    FILE *stream;
    bool  standard;        /* standard output: nothing to rename or close */
    bool  direct;          /* a device or pipe: written in place */
    char  target[PATH_MAX]; /* after following symbolic links */
    char  part[PATH_MAX];   /* where the bytes go until commit */
};

/* --- reading --------------------------------------------------------------------------------- */

static bool read_error(Error *err, const char *path, const char *why)
{
    return error_at(err, ERROR_INPUT, path, 0, "cannot be read: %s", why);
}

/* Opens a regular file. Without blocking: a pipe nobody writes to must not hang the program. */
static int regular_open(const char *path, struct stat *info, Error *err)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);

    if (fd < 0 || fstat(fd, info) != 0) {
        read_error(err, path, strerror(errno));
    } else if (S_ISDIR(info->st_mode)) {
        read_error(err, path, "it is a directory");
    } else if (!S_ISREG(info->st_mode)) {
        read_error(err, path, "it is not a regular file");
    } else {
        return fd;
    }
    if (fd >= 0)
        close(fd);
    return -1;
}

/* Reads to the end, which may be before or after the size the file had when it was opened. */
static char *bytes_read(int fd, const char *path, size_t limit, size_t expected, size_t *size,
                        Error *err)
{
    void *bytes = NULL;
    size_t capacity = 0, used = 0;

    while (array_reserve(&bytes, &capacity, (used > expected ? used : expected) + 2, 1,
                         "file contents", err)) {
        const ssize_t got = read(fd, (char *)bytes + used, capacity - used - 1);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0) {
            read_error(err, path, strerror(errno));
            break;
        }
        used += (size_t)got;
        if (used > limit) {
            error_at(err, ERROR_INPUT, path, 0, "is larger than the limit of %zu bytes", limit);
            break;
        }
        if (got == 0) {
            ((char *)bytes)[used] = 0;
            *size = used;
            return bytes;
        }
    }
    return array_free(bytes);
}

char *file_read(const char *path, size_t limit, size_t *size, Error *err)
{
    assert(path != NULL && size != NULL && err != NULL);
    if (error_is_set(err))
        return NULL;
    struct stat info;
    const int fd = regular_open(path, &info, err);
    char *bytes = NULL;

    if (fd < 0)
        return NULL;
    if ((uintmax_t)info.st_size > limit)
        error_at(err, ERROR_INPUT, path, 0, "is larger than the limit of %zu bytes", limit);
    else
        bytes = bytes_read(fd, path, limit, (size_t)info.st_size, size, err);
    close(fd);
    return bytes;
}

/* --- writing --------------------------------------------------------------------------------- */

static bool write_error(Error *err, const char *path, const char *why)
{
    return error_at(err, ERROR_FAILED, path, 0, "cannot be written: %s", why);
}

bool file_beside(const char *path, const char *name, char *buffer, size_t size)
{
    assert(path != NULL && name != NULL && buffer != NULL);
    const char *slash = strrchr(path, '/');
    const int folder = slash == NULL || name[0] == '/' ? 0 : (int)(slash - path) + 1;
    const int length = snprintf(buffer, size, "%.*s%s", folder, path, name);
    return length >= 0 && (size_t)length < size;
}

/* Where the file will stand. A symbolic link is followed, so that the link survives; a device or
 * pipe is written in place, since a rename would put a plain file where it was. */
static bool target_find(OutFile *out, const char *path, mode_t *mode, Error *err)
{
    struct stat info;
    const bool exists = stat(path, &info) == 0;

    if (path[0] == 0)
        return write_error(err, "\"\"", "the path is empty");
    if (exists && S_ISDIR(info.st_mode))
        return write_error(err, path, "it is a directory");
    if (strlen(path) >= sizeof out->target)
        return write_error(err, path, "the path is too long");
    strcpy(out->target, path);
    out->direct = exists && !S_ISREG(info.st_mode);
    *mode = 0;
    if (exists && !out->direct) {
        char real[PATH_MAX];
        if (realpath(path, real) != NULL)
            strcpy(out->target, real);
        *mode = info.st_mode & 0777;
        if (access(out->target, W_OK) != 0) /* a rename would not respect a read-only file */
            return write_error(err, path, strerror(errno));
    }
    return true;
}

/* Creates the temporary file beside the target: only there is a rename certain to be one step. The
 * name is short, as the target's own may be as long as the file system allows. */
static int part_create(OutFile *out, const char *path, Error *err)
{
    if (out->direct) {
        strcpy(out->part, out->target);
        return open(out->part, O_WRONLY | O_CLOEXEC);
    }
    for (unsigned i = 0; i < 10000; i++) {
        char name[48];
        snprintf(name, sizeof name, ".isolux-%ld-%u.part", (long)getpid(), i);
        if (!file_beside(out->target, name, out->part, sizeof out->part)) {
            write_error(err, path, "the path is too long");
            return -1;
        }
        const int fd = open(out->part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    return -1;
}

static OutFile *outfile_start(OutFile *out, const char *path, Error *err)
{
    mode_t mode;

    if (!target_find(out, path, &mode, err))
        return array_free(out);
    const int fd = part_create(out, path, err);
    if (fd >= 0)
        out->stream = fdopen(fd, "wb");
    if (out->stream == NULL) {
        write_error(err, path, strerror(errno));
        if (fd >= 0) {
            close(fd);
            if (!out->direct)
                unlink(out->part);
        }
        return array_free(out);
    }
    /* A file that is replaced keeps its permissions; when it cannot, the usual ones do. */
    if (mode != 0 && fchmod(fd, mode) != 0)
        errno = 0;
    return out;
}

OutFile *outfile_open(const char *path, Error *err)
{
    assert(path != NULL && err != NULL);
    OutFile *out = array_create(1, sizeof *out, "output file", err);

    if (out == NULL)
        return NULL;
    if (strcmp(path, "-") != 0)
        return outfile_start(out, path, err);
    out->standard = true;
    out->stream = stdout;
    strcpy(out->target, "standard output");
    return out;
}

FILE *outfile_stream(OutFile *out)
{
    assert(out != NULL && out->stream != NULL);
    return out->stream;
}

const char *outfile_path(const OutFile *out)
{
    assert(out != NULL);
    return out->standard ? NULL : out->part;
}

/* To disk before the rename: otherwise a power failure may leave the new name with old or no
 * bytes. By path, since a library may have replaced the file behind the stream. */
static bool path_sync(const char *path)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    const bool good = fd >= 0 && fsync(fd) == 0;
    const int why = errno;

    if (fd >= 0)
        close(fd);
    errno = why;
    return good;
}

/* The new name itself. Some file systems cannot; nothing is lost but the certainty. */
static void folder_sync(const char *path)
{
    char folder[PATH_MAX];

    if (!file_beside(path, ".", folder, sizeof folder))
        return;
    const int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0) {
        (void)fsync(fd);
        close(fd);
    }
}

static bool disk_is_full(const OutFile *out)
{
    struct statvfs disk;
    return !out->standard && fstatvfs(fileno(out->stream), &disk) == 0 && disk.f_bavail == 0;
}

static bool stream_finish(OutFile *out)
{
    bool good = !ferror(out->stream);
    /* A library's or an earlier write failed, and only the stream remembers: a full disk shows in
     * that there still is no room. */
    int why = good ? 0 : disk_is_full(out) ? ENOSPC : EIO;

    if (fflush(out->stream) != 0 && good) {
        good = false;
        why = errno;
    }
    if (!out->standard && fclose(out->stream) != 0 && good) {
        good = false;
        why = errno;
    }
    out->stream = NULL;
    errno = why;
    return good;
}

bool outfile_commit(OutFile *out, Error *err)
{
    assert(err != NULL);
    if (out == NULL)
        return !error_is_set(err);
    if (error_is_set(err)) {
        outfile_discard(out);
        return false;
    }
    bool good = stream_finish(out);
    const bool in_place = out->standard || out->direct;

    if (good && !in_place)
        good = path_sync(out->part) && rename(out->part, out->target) == 0;
    if (!good) {
        write_error(err, out->target, strerror(errno));
        if (!in_place)
            unlink(out->part);
    } else if (!in_place) {
        folder_sync(out->target);
    }
    array_free(out);
    return good;
}

void outfile_discard(OutFile *out)
{
    if (out == NULL)
        return;
    assert(out->stream != NULL);
    if (!out->standard) {
        fclose(out->stream);
        if (!out->direct)
            unlink(out->part);
    }
    array_free(out);
}

uint64_t file_hash(const void *bytes, size_t size, uint64_t seed)
{
    assert(bytes != NULL || size == 0);
    return XXH3_64bits_withSeed(bytes, size, seed);
}
