/* token: splits NFF text into tokens. Private to lib/scene. */
#ifndef STORMRING_SCENE_TOKEN_H
#define STORMRING_SCENE_TOKEN_H

#include "base/base.h"

/* at .. end is unread. line is the line of `at`, from 1. */
struct tokens {
    const char *at, *end;
    uint32_t line;
};

/*
 * Blanks and comments separate tokens. '#' starts a comment anywhere. Lines end in LF, CR LF or CR.
 * Skips a byte order mark at the start and a DOS end-of-file mark at the end.
 */
void tokens_init(struct tokens *t, const char *text, size_t n);
/* Advances to the next token and returns its length; 0 at the end of the text. Does not consume the
 * token. */
size_t token_peek(struct tokens *t);
/* Consumes the token; n is its length from token_peek. */
static inline void token_take(struct tokens *t, size_t n) { t->at += n; }

enum token_number { TOKEN_OK, TOKEN_END, TOKEN_BAD };

/*
 * Reads the next token as a decimal number, correctly rounded. Consumes it only if TOKEN_OK.
 * Hexadecimal, "nan" and "inf" are TOKEN_BAD. A number too large for a double is TOKEN_OK and
 * infinite: the caller checks the range.
 */
enum token_number token_real(struct tokens *t, double *out);

#endif
