/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_file.h -- links kept in a file, so that a change of light casts no ray.
 *
 * The file names what it was made from by a key (links_key) and ends with a checksum over all of
 * it; one that is cut, changed or made from something else is refused.
 * Format   the machine's own order of bytes, 8-byte aligned: the magic "isoluxF1", key, counts,
 *          then the arrays of Links as they are; values are 32-bit floats, kept bit for bit.
 */
#ifndef RADIOSITY_LINKS_FILE_H
#define RADIOSITY_LINKS_FILE_H

#include "radiosity/links.h"

/* Writes beside and renames: a reader sees the old file or the new one.
 * fails  false and ERROR_FAILED, the old file stays. */
bool links_save(const Links *links, uint64_t key, const char *path, Error *err);

/* Stands for what links are cast from: surfaces, patches, which of them emit, and the options that
 * change what is cast. Not for how strong lamps are or what walls reflect: links cast under other
 * light of the same lamps are as good. */
uint64_t links_key(const Room *room, const LinksOptions *options);

/* Reads links made for that key; they lie where options' max_bytes and folder let them.
 * owns   the caller frees with links_destroy.
 * fails  NULL; ERROR_INPUT when the file is not there, is no links file, is damaged, or was made
 *        for another key (*other, unless NULL, is then true); ERROR_MEMORY. */
Links *links_load(const char *path, uint64_t key, const LinksOptions *options, bool *other,
                  Error *err);

/* Bytes that such a file takes. */
uint64_t links_file_bytes(const Links *links);

#endif
