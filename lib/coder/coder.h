/*
 * coder: bodies of records in fewer bytes, without loss, for links that are slower than the coder.
 *
 * Bytes are first arranged, so that bytes of one meaning stand together; then libzstd packs them,
 * at level 1. The packed form does not depend on the byte order of the machine. Without libzstd
 * nothing is packed: none.c is compiled in the place of zstd.c.
 */
#ifndef STORMRING_CODER_H
#define STORMRING_CODER_H

#include "base/base.h"

/*
 * Arrangements. Each is applied to blocks of CODER_BLOCK bytes, the last of which may be shorter;
 * the bytes of a block that fill no whole word or pixel come last, as they are.
 */
enum coder_form {
    CODER_BYTES, /* as they are */
    CODER_WORDS, /* of 4 bytes: all first bytes, then all second ones, ... */
    /*
     * Of 4 words of 32 bits, least significant byte first: red, green, blue, alpha. Each word is
     * replaced by its difference from that of the pixel before, modulo 2^32, with the sign in the
     * lowest bit. Then come the lowest bytes of all reds, their second bytes, ..., the highest
     * bytes of all alphas. A channel that is constant becomes zeros, which cost next to nothing.
     */
    CODER_PIXELS
};
#define CODER_BLOCK (1 << 20)
#define CODER_PIXEL_BYTES 16
#define CODER_RATIO_MAX 1024 /* a packed byte stands for at most this number of bytes */
#define CODER_SHARE .4       /* of the bytes of pixels that remain, as coder_pays expects */

/* True if this program was built with libzstd. */
bool coder_there(void);
/*
 * Appends the packed form of p[0..n) to b. False: it would not be shorter, or too much shorter
 * (CODER_RATIO_MAX), or libzstd is not there; then nothing is appended.
 */
bool coder_pack(struct buf *b, enum coder_form form, const unsigned char *p, size_t n);
/* Unpacks p[0..n) to out[0..plain). False: it is damaged, or unpacks to another number of bytes;
 * then out is undefined. Never writes beyond it. */
bool coder_unpack(
    unsigned char *out, size_t plain, enum coder_form form, const unsigned char *p, size_t n);
/* The form in which these bytes of unknown meaning are packed best, by a sample. */
enum coder_form coder_form_of(const unsigned char *p, size_t n);
/* Measures how many bytes of pixels this machine packs in a microsecond; takes some ms. */
double coder_speed(void);
/*
 * True if packing saves time on a link of this number of bytes per microsecond: the bytes that it
 * saves take the link longer than all bytes take the coder.
 */
static inline bool coder_pays(double link, double coder)
{
    return link < coder * (1 - CODER_SHARE);
}

/* ---- arrange.c ---- */

/* The arrangement of one block, and back; p and out do not overlap. */
void coder_arrange(unsigned char *out, enum coder_form form, const unsigned char *p, size_t n);
void coder_restore(unsigned char *out, enum coder_form form, const unsigned char *p, size_t n);

#endif
