/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_pack.h -- links in four bytes each; this folder only.
 *
 * A link is two 16-bit numbers: how far its source is from that of the link before it in the row
 * (gaps over 65,535 are bridged by links with factor 0), and the factor as a share of the row's
 * largest in a floating-point form of its own: 5 bits of exponent, 11 of fraction, no sign; 0 is 0.
 * Each factor is rounded by at most 2^-12 of itself, or to 2^-31 of the row's largest when it is
 * less. The row is then scaled so that its sum is what it was.
 */
#ifndef RADIOSITY_LINKS_PACK_H
#define RADIOSITY_LINKS_PACK_H

#include "radiosity/links.h"

enum { LINKS_PACKED_BYTES = 4 };

void links_packed_free(Links *links);

#endif
