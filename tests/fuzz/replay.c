/* SPDX-License-Identifier: BSD-3-Clause */
/* Gives every file of a folder to a fuzz target once, without the fuzzer, and tells it as TAP. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int is_file(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

/* The bytes lie in an allocation of just their size, so that a sanitizer sees a read past them. */
static int replay(const char *folder, const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0)
        return -1;
    const long size = ftell(file);
    rewind(file);
    uint8_t *data = size >= 0 ? malloc((size_t)size + (size == 0)) : NULL;
    const int good = data != NULL && fread(data, 1, (size_t)size, file) == (size_t)size;
    fclose(file);
    const int result = good ? LLVMFuzzerTestOneInput(data, (size_t)size) : -1;
    free(data);
    return result;
}

int main(int count, char **arguments)
{
    struct dirent **entries = NULL;
    if (count != 2)
        return 2;
    const int files = scandir(arguments[1], &entries, is_file, alphasort);
    const int known = files > 0 ? files : 0;
    int failed = 0;

    printf("1..%d\n", known + 1);
    fflush(stdout);
    failed += LLVMFuzzerTestOneInput((const uint8_t *)"", 0) != 0;
    printf("%s 1 - empty input\n", failed ? "not ok" : "ok");
    for (int i = 0; i < known; i++) {
        printf("# %s\n", entries[i]->d_name); /* said before it may crash */
        fflush(stdout);
        const int wrong = replay(arguments[1], entries[i]->d_name) != 0;
        printf("%s %d - %s\n", wrong ? "not ok" : "ok", i + 2, entries[i]->d_name);
        failed += wrong;
        free(entries[i]);
    }
    free(entries);
    return failed > 0;
}
