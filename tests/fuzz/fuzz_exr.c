/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as an EXR file: a picture or one clear line, never a crash, hang or leak. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/array.h"
#include "render/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    Error err = { 0 };
    char  path[64];
    int   width, height;
    const int file = memfd_create("fuzz.exr", MFD_CLOEXEC);
    if (file < 0 || write(file, bytes, size) != (ssize_t)size)
        abort();
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    float *rgb = image_read_exr(path, &width, &height, &err);
    close(file);
    if ((rgb == NULL) != error_is_set(&err))
        abort();
    array_free(rgb);
    if (array_live() != 0)
        abort();
    return 0;
}
