/* token: NFF text as tokens. Private to lib/scene. */
#ifndef STORMRING_SCENE_TOKEN_H
#define STORMRING_SCENE_TOKEN_H

#include "base/base.h"

/* Text from at to end is unread; line is the one that `at` is on, from 1. */
struct tokens {
    const char *at, *end;
    uint32_t line;
};

/*
 * Blanks and comments separate tokens; '#' starts a comment wherever it stands. Lines end in LF,
 * CR LF or CR. A byte order mark in front and a DOS end-of-file mark behind are not part of the
 * text.
 */
void tokens_init(struct tokens *t, const char *text, size_t n);
/* To the next token; its length, 0 at the end of the text. Does not consume it. */
size_t token_peek(struct tokens *t);
/* The token (of length n as token_peek said) is read. */
static inline void token_take(struct tokens *t, size_t n) { t->at += n; }

enum token_number { TOKEN_OK, TOKEN_END, TOKEN_BAD };

/*
 * The next token as a decimal number, correctly rounded; consumed only when TOKEN_OK. Hexadecimal,
 * NaN and infinity in words are TOKEN_BAD; a number too large for a double is TOKEN_OK and
 * infinite: the caller has a range.
 */
enum token_number token_real(struct tokens *t, double *out);

#endif
