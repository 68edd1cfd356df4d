/* SPDX-License-Identifier: BSD-3-Clause */
/* Files for the importing library: each read once, whole, and hashed. */
#include "scenes/import_files.h"

#include <assert.h>
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/import.h"

/* "a%20b" -> "a b", in place; false when nothing was there to decode. */
static bool percent_decode(char *path)
{
    char *to = path;
    bool changed = false;

    for (const char *from = path; *from != 0;) {
        if (from[0] == '%' && isxdigit((unsigned char)from[1]) &&
            isxdigit((unsigned char)from[2])) {
            const char digits[3] = { from[1], from[2], 0 };
            const char c = (char)strtol(digits, NULL, 16);
            if (c != 0) {
                *to++ = c;
                from += 3;
                changed = true;
                continue;
            }
        }
        *to++ = *from++;
    }
    *to = 0;
    return changed;
}

static char *bytes_read(ImportFiles *files, const char *path, size_t *size)
{
    files->err = (Error){ 0 };
    char *bytes = file_read(path, import_file_limit, size, &files->err);
    if (bytes != NULL)
        return bytes;
    Error ignored = { 0 };
    char *decoded = array_string(path, &ignored);
    if (decoded != NULL && percent_decode(decoded))
        bytes = file_read(decoded, import_file_limit, size, &ignored);
    array_free(decoded);
    return bytes;
}

bool import_files_get(ImportFiles *files, const char *path, size_t *at)
{
    assert(files != NULL && path != NULL && at != NULL);
    for (size_t i = 0; i < files->count; i++)
        if (strcmp(files->file[i].path, path) == 0) {
            *at = i;
            return files->file[i].bytes != NULL;
        }
    Error err = { 0 };
    if (!array_reserve((void **)&files->file, &files->capacity, files->count + 1,
                       sizeof *files->file, "files", &err))
        return false;
    ImportFile file = { .path = array_string(path, &err) };
    if (file.path == NULL)
        return false;
    file.bytes = bytes_read(files, path, &file.size);
    if (file.bytes != NULL)
        files->hash = file_hash(file.bytes, file.size, files->hash);
    *at = files->count;
    files->file[files->count++] = file;
    return file.bytes != NULL;
}

void import_files_replace(ImportFiles *files, size_t at, char *bytes, size_t size)
{
    assert(files != NULL && at < files->count && bytes != NULL);
    array_free(files->file[at].bytes);
    files->file[at].bytes = bytes;
    files->file[at].size = size;
}

void import_files_clear(ImportFiles *files)
{
    for (size_t i = 0; i < files->count; i++) {
        array_free(files->file[i].path);
        array_free(files->file[i].bytes);
    }
    array_free(files->file);
    *files = (ImportFiles){ 0 };
}
