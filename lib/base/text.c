/* text: finding, comparing and dividing of text. */
#include "base/base.h"

#include <string.h>
#include <strings.h>

#define DIGITS "0123456789"

const void *text_find(const void *in, size_t n, const void *what, size_t k)
{
    const unsigned char *at = in, *end = at + n, first = *(const unsigned char *)what;
    for (; at && (size_t)(end - at) >= k; at++) {
        at = memchr(at, first, (size_t)(end - at) - k + 1);
        if (!at || memcmp(at, what, k) == 0) return at;
    }
    return NULL;
}

bool text_has(const char *s, const char *word)
{
    const size_t n = strlen(word);
    while (*s && strncasecmp(s, word, n) != 0) s++;
    return *s != '\0';
}

int text_order(const char *a, const char *b)
{
    const char *p = a, *q = b;
    while (*p && *q) {
        size_t n = strspn(p, DIGITS), k = strspn(q, DIGITS), zeros = strspn(p, "0");
        if (!n || !k) {
            if (*p != *q) return (unsigned char)*p < (unsigned char)*q ? -1 : 1;
            p++, q++;
            continue;
        }
        p += zeros, n -= zeros;
        zeros = strspn(q, "0");
        q += zeros, k -= zeros;
        const int order = n != k ? (n > k) - (n < k) : memcmp(p, q, n);
        if (order) return order;
        p += n, q += k;
    }
    return strcmp(a, b);
}

char *text_part(char **rest, char end)
{
    char *part = *rest, *at = part ? strchr(part, end) : NULL;
    if (at) *at++ = '\0';
    *rest = at;
    return part;
}
