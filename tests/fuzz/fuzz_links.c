/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a file of form factors: refused in one clear line, or links that hold together. The
 * checksum lets hardly anything through, so bytes that end in none get theirs here. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/array.h"
#include "base/file.h"
#include "radiosity/links_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { LINKS_FILE = 102 };

static void demand(bool condition)
{
    if (!condition)
        abort();
}

static void offer(const uint8_t *bytes, size_t size, uint64_t hash)
{
    const int file = memfd_create("fuzz", MFD_CLOEXEC);
    demand(file >= 0 && write(file, bytes, size) == (ssize_t)size);
    demand(write(file, &hash, sizeof hash) == sizeof hash);
    demand(dup3(file, LINKS_FILE, O_CLOEXEC) == LINKS_FILE);
    close(file);
}

/* The checksum of a file runs over its parts one after the other. */
static uint64_t chained_hash(const uint8_t *bytes, size_t size)
{
    uint64_t count = 0, nonzeros = 0, hash = 0;
    size_t at = 0, part[7] = { 56 };
    if (size >= 56) {
        memcpy(&nonzeros, bytes + 16, sizeof nonzeros);
        memcpy(&count, bytes + 48, sizeof(uint32_t));
    }
    if (nonzeros > size || count > size)
        return 0;
    const size_t n = (size_t)count, links = (size_t)nonzeros;
    const size_t sizes[6] = { (n + 1) * 8, links * 4, links * 4, n * 4, n * 8, n };
    memcpy(part + 1, sizes, sizeof sizes);
    for (int k = 0; k < 7 && at < size; k++) {
        const size_t take = part[k] < size - at ? part[k] : size - at;
        hash = file_hash(bytes + at, take, hash);
        at += take;
    }
    return hash;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const LinksOptions options = { .max_bytes = 64 << 20 };
    Error err = { 0 };
    uint64_t key = 0;
    char path[32];

    if (size >= 16)
        memcpy(&key, data + 8, sizeof key);
    offer(data, size, chained_hash(data, size));
    snprintf(path, sizeof path, "/proc/self/fd/%d", LINKS_FILE);
    Links *links = links_load(path, key, &options, NULL, &err);
    demand((links == NULL) == error_is_set(&err));
    if (links != NULL)
        demand(links_check(links));
    else
        demand((err.code == ERROR_INPUT || err.code == ERROR_MEMORY) && err.text[0] != 0 &&
               strchr(err.text, '\n') == NULL);
    links_destroy(links);
    close(LINKS_FILE);
    demand(array_live() == 0);
    return 0;
}
