/* SPDX-License-Identifier: BSD-3-Clause */
/* Checked allocation, with a count of what is alive and a way to make allocations fail. */
#include "base/array.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The only state of the library, and no result depends on it: it exists for tests. */
typedef struct {
    atomic_long live;
    atomic_long left; /* allocations that still succeed; < 0: no limit */
} Ledger;

static Ledger *ledger(void)
{
    static Ledger the_ledger = { 0, -1 };
    return &the_ledger;
}

/* Whether the next allocation may be tried; counts it off. */
static bool allocation_allowed(void)
{
    Ledger *book = ledger();
    long left = atomic_load(&book->left);

    while (left > 0)
        if (atomic_compare_exchange_weak(&book->left, &left, left - 1))
            return true;
    return left < 0;
}

static bool memory_error(Error *err, size_t count, size_t size, const char *what)
{
    return error_set(err, ERROR_MEMORY, "out of memory: %s, %zu x %zu bytes", what, count, size);
}

/* Objects larger than PTRDIFF_MAX cannot be indexed safely. */
static bool size_fits(size_t count, size_t size)
{
    return count <= (size_t)PTRDIFF_MAX / size;
}

void *array_create(size_t count, size_t size, const char *what, Error *err)
{
    assert(size > 0 && what != NULL && err != NULL);
    if (error_is_set(err))
        return NULL;
    void *array = NULL;
    if (size_fits(count, size) && allocation_allowed())
        array = calloc(count > 0 ? count : 1, size);
    if (array == NULL) {
        memory_error(err, count, size, what);
        return NULL;
    }
    atomic_fetch_add(&ledger()->live, 1);
    return array;
}

bool array_reserve(void **array, size_t *capacity, size_t needed, size_t size, const char *what,
                   Error *err)
{
    assert(array != NULL && capacity != NULL && err != NULL);
    assert(size > 0 && what != NULL);
    assert(*array != NULL || *capacity == 0);
    if (error_is_set(err))
        return false;
    if (*array != NULL && needed <= *capacity)
        return true;
    size_t wanted = *capacity < 8 ? 8 : size_fits(*capacity, 2 * size) ? 2 * *capacity : needed;
    if (wanted < needed)
        wanted = needed;
    void *grown = NULL;
    if (size_fits(wanted, size) && allocation_allowed())
        grown = realloc(*array, wanted * size);
    if (grown == NULL)
        return memory_error(err, wanted, size, what);
    if (*array == NULL)
        atomic_fetch_add(&ledger()->live, 1);
    *array = grown;
    *capacity = wanted;
    return true;
}

char *array_string(const char *text, Error *err)
{
    assert(err != NULL);
    const size_t length = text != NULL ? strlen(text) : 0;
    char *copy = array_create(length + 1, 1, "text", err);

    if (copy != NULL && length > 0)
        memcpy(copy, text, length);
    return copy;
}

void *array_free(void *array)
{
    if (array != NULL) {
        const long before = atomic_fetch_sub(&ledger()->live, 1);
        assert(before > 0);
        (void)before;
        free(array);
    }
    return NULL;
}

void array_fail_after(long n)
{
    atomic_store(&ledger()->left, n < 0 ? -1 : n);
}

long array_live(void)
{
    return atomic_load(&ledger()->live);
}
