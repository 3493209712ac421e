/*
 * keep: state that this host has had, in files of the user's cache, each named by its SHA-256. A
 * later run sends the hash instead. Only the user can read them. The contents are compared with the
 * hash before use. If they take too many bytes, those that no run has used for the longest time go.
 */
#ifndef STORMRING_KEEP_H
#define STORMRING_KEEP_H

#include "base/base.h"

#define KEEP_LEAST 65536             /* bytes: less is sent as fast as it is found */
#define KEEP_MOST (INT64_C(4) << 30) /* bytes of all files */

/*
 * The latest files in short: the first digits of their hashes, with commas between; "" if there is
 * none. keep_names tells whether such a text has this hash.
 */
#define KEEP_DIGITS 16
#define KEEP_LISTED 32 /* most hashes in a text */
#define KEEP_LIST (KEEP_LISTED * (KEEP_DIGITS + 1))
void keep_list(char text[KEEP_LIST]);
bool keep_names(const char *text, const char *sha256);
/*
 * Appends the n bytes with this hash, whatever it is: false, and nothing is appended, if it is no
 * hash, or there is no such file. A file with other contents is removed.
 */
bool keep_read(const char *sha256, size_t n, struct buf *to);
/* Keeps these bytes, KEEP_LEAST at least, if there is room. Failures do not matter. */
void keep_write(const void *p, size_t n);

#endif
