/* SPDX-License-Identifier: BSD-3-Clause */
/* Files without a name, mapped. */
#include "base/spill.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* Not all file systems know files that never had a name. */
static int open_nameless(const char *folder, Error *err)
{
    char path[4096];
    int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0 && strlen(folder) < sizeof path / 2) {
        snprintf(path, sizeof path, "%s/.isolux-XXXXXX", folder);
        file = mkostemp(path, O_CLOEXEC);
        if (file >= 0)
            unlink(path);
    }
    if (file < 0)
        error_at(err, ERROR_FAILED, folder, 0, "no file can be made there: %s", strerror(errno));
    return file;
}

void *spill_map(const char *folder, uint64_t bytes, const char *what, Error *err)
{
    assert(folder != NULL && what != NULL);
    if (error_is_set(err))
        return NULL;
    const uint64_t whole = bytes > 0 ? bytes : 1;
    const int file = open_nameless(folder, err);
    if (file < 0)
        return NULL;
    /* Pages of a file that turn out to have no room end the program: all of it is asked for now. */
    const int full = posix_fallocate(file, 0, (off_t)whole);
    void *array = full == 0 ? mmap(NULL, whole, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                            : MAP_FAILED;
    close(file);
    if (array == MAP_FAILED) {
        error_at(err, ERROR_MEMORY, folder, 0, "no room there for %.0f MB of %s: %s",
                 1e-6 * (double)whole, what, strerror(full != 0 ? full : errno));
        return NULL;
    }
    return array;
}

void *spill_unmap(void *array, uint64_t bytes)
{
    if (array != NULL)
        munmap(array, bytes > 0 ? bytes : 1);
    return NULL;
}

void spill_leave(const void *array, uint64_t begin, uint64_t end)
{
    const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), at = (uintptr_t)array;
    const uintptr_t low = (at + begin) / page * page, high = (at + end + page - 1) / page * page;
    if (begin < end)
        madvise((void *)low, high - low, MADV_DONTNEED);
}

uint64_t spill_free_bytes(const char *folder)
{
    struct statvfs info;
    if (statvfs(folder, &info) != 0)
        return UINT64_MAX;
    return (uint64_t)info.f_bavail * info.f_frsize;
}
