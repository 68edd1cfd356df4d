/* SPDX-License-Identifier: BSD-3-Clause */
/* Names of result files. */
#include "app/output.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/file.h"

static bool same_file(const struct stat *a, const char *path)
{
    struct stat b;
    return path != NULL && stat(path, &b) == 0 && a->st_dev == b.st_dev && a->st_ino == b.st_ino;
}

bool output_probe(const char *path, const Options *options, Error *err)
{
    struct stat info;
    assert(options != NULL);
    if (error_is_set(err))
        return false;
    if (path == NULL || strcmp(path, "-") == 0)
        return true;
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
        return error_at(err, ERROR_FAILED, path, 0, "is a folder, not a file to write");
    if (stat(path, &info) == 0 && S_ISREG(info.st_mode) &&
        (same_file(&info, options->scene) || same_file(&info, options->other) ||
         same_file(&info, options->points)))
        return error_at(err, ERROR_USAGE, path, 0, "is read by this command; write elsewhere");
    OutFile *out = outfile_open(path, err);
    outfile_discard(out);
    return out != NULL;
}

const char *output_base(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

bool output_name(const char *path, const char *ending, char *out, size_t size, Error *err)
{
    assert(path != NULL && ending != NULL && out != NULL);
    const char *base = output_base(path), *dot = strrchr(base, '.');
    const size_t stem = dot != NULL && dot != base ? (size_t)(dot - path) : strlen(path);
    if (stem + strlen(ending) + 1 > size)
        return error_set(err, ERROR_USAGE, "the file name '%.100s...' is too long", path);
    memcpy(out, path, stem);
    memcpy(out + stem, ending, strlen(ending) + 1);
    return true;
}

bool output_ends(const char *path, const char *ending)
{
    const size_t n = strlen(path), m = strlen(ending);
    return n > m && strcasecmp(path + n - m, ending) == 0;
}
