/* memory: allocators that never return NULL, and byte buffers. */
#include "base/base.h"

#include <stdlib.h>
#include <string.h>

#define BUF_KEEP (8 << 20) /* bytes; an empty buffer with more capacity is freed */

static size_t product(size_t n, size_t size)
{
    size_t bytes;
    if (__builtin_mul_overflow(n, size, &bytes) || bytes > PTRDIFF_MAX)
        die(ST_SYSTEM, "out of memory: %zu items of %zu bytes", n, size);
    return bytes ? bytes : 1;
}

static void *checked(void *p, size_t bytes)
{
    if (!p) die(ST_SYSTEM, "out of memory: %zu bytes", bytes);
    return p;
}

void *xmalloc(size_t n, size_t size)
{
    size_t bytes = product(n, size);
    return checked(malloc(bytes), bytes);
}

void *xcalloc(size_t n, size_t size)
{
    size_t bytes = product(n, size);
    return checked(calloc(bytes, 1), bytes);
}

void *xrealloc(void *p, size_t n, size_t size)
{
    size_t bytes = product(n, size);
    return checked(realloc(p, bytes), bytes);
}

void *xgrown(void *p, size_t n, size_t size)
{
    if (n & (n - 1)) return p; /* it is full at powers of two */
    return xrealloc(p, n ? product(n, 2) : 1, size);
}

void *xaligned(size_t n, size_t size)
{
    size_t bytes = (product(n, size) + 63) & ~(size_t)63;
    return checked(aligned_alloc(64, bytes), bytes);
}

char *xstrdup(const char *s)
{
    size_t n = strlen(s) + 1;
    return memcpy(xmalloc(n, 1), s, n);
}

void buf_free(struct buf *b)
{
    free(b->data);
    *b = (struct buf){0};
}

unsigned char *buf_reserve(struct buf *b, size_t n)
{
    if (b->cap - b->len >= n) return b->data + b->len;
    /* Drops consumed bytes before growing, so a long stream through a short queue stays small. */
    if (b->off && b->off >= b->len - b->off) {
        memmove(b->data, b->data + b->off, b->len - b->off);
        b->len -= b->off;
        b->off = 0;
        if (b->cap - b->len >= n) return b->data + b->len;
    }
    size_t cap = b->cap ? b->cap : 256;
    while (cap - b->len < n) {
        if (cap > PTRDIFF_MAX / 2) die(ST_SYSTEM, "out of memory: a buffer of %zu bytes", cap);
        cap *= 2;
    }
    b->data = xrealloc(b->data, cap, 1);
    b->cap = cap;
    return b->data + b->len;
}

void buf_append(struct buf *b, const void *p, size_t n)
{
    if (!n) return;
    memcpy(buf_reserve(b, n), p, n);
    b->len += n;
}

void buf_printf(struct buf *b, const char *fmt, ...)
{
    for (size_t room = 128;; room *= 2) {
        char *to = (char *)buf_reserve(b, room);
        va_list ap;
        va_start(ap, fmt);
        int n = vsnprintf(to, room, fmt, ap);
        va_end(ap);
        if (n < 0) die(ST_SYSTEM, "vsnprintf:");
        if ((size_t)n < room) {
            b->len += (size_t)n;
            return;
        }
    }
}

void buf_consume(struct buf *b, size_t n)
{
    b->off += n;
    if (b->off < b->len) return;
    b->off = b->len = 0;
    if (b->cap > BUF_KEEP) buf_free(b);
}

void buf_word(struct buf *b, const char *s)
{
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./,:=@%+-";
    /* zsh would look up a program for a word that begins with `=`. */
    if (*s && *s != '=' && strspn(s, plain) == strlen(s)) {
        buf_append(b, s, strlen(s));
        return;
    }
    buf_append(b, "'", 1);
    for (; *s; s++) {
        if (*s == '\'') buf_append(b, "'\\'", 3);
        buf_append(b, s, 1);
    }
    buf_append(b, "'", 1);
}
