/* wire, shared by its files: encode.c and pack.c append records; decode.c, seal.c and
 * unpack.c read. */
#ifndef STORMRING_WIRE_INT_H
#define STORMRING_WIRE_INT_H

#include "wire/wire.h"

/* ---- encode.c ---- */

/* Appends a body and the newline after it, which lets whole records through a launcher that
 * forwards whole lines. */
void wire_put_body(struct buf *b, const void *body, size_t n);

/* ---- seal.c ---- */

/*
 * A line that ends in its sum must have the right one. Workers are not trusted: each of their lines
 * must have one, unless it is one word. A hello without one is of format 1. False: it is bad, with
 * the error in why.
 */
bool wire_check_seal(const struct record *r, bool upward, char why[WIRE_WHY]);

/* ---- unpack.c ---- */

/* Writes the error to why, and returns false. */
bool wire_fail(char why[WIRE_WHY], const char *what, const char *expected);
/* Appends r's line with this text in the place of bytes=N and of the keys of packed records. */
void wire_put_line(struct buf *b, const struct record *r, const char *text);
/*
 * The lengths of r's body, on the wire and unpacked. A packed one is shorter, but not by more than
 * a coder may gain: this bounds the memory that a small record takes. False: they are bad, with the
 * error in why.
 */
bool wire_lengths(struct record *r, const struct decoder *d, char why[WIRE_WHY]);
/* Replaces a packed record, whose body is whole, or one that has a hash, by the plain one, in
 * d->plain. False: it is damaged, or there is no such body. */
bool wire_unpack(struct decoder *d, struct record *r);

#endif
