/* SPDX-License-Identifier: BSD-3-Clause */
/* app/digits.h -- numbers as text, tens of millions a second: for matrices, whose writing would
 * otherwise take longer than making them.
 */
#ifndef APP_DIGITS_H
#define APP_DIGITS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Room that any number takes. */
enum { DIGITS_MOST = 32, DIGITS_BUFFER = 1 << 16 };

/* Text on its way to a stream. */
typedef struct {
    FILE    *out;
    uint32_t used;
    char     text[DIGITS_BUFFER];
} Digits;

/* A number >= 0 as printf's %.9g writes it, but for a last digit that is one off where the tenth is
 * a 5 to within 1e-7: read back it is right to 1e-9 all the same. Negative, infinite and odd ones
 * go the slow way. */
void digits_number(Digits *digits, double value);
void digits_count(Digits *digits, uint64_t value);
void digits_letter(Digits *digits, char letter);
/* Hands all to the stream, whose own state tells whether that went well. */
void digits_flush(Digits *digits);

#endif
