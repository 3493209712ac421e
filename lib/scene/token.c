/*
 * token: tokens of NFF text, and decimal to double.
 *
 * A number with at most 15 significant digits and a power of ten within 10^22 is one exact integer
 * times or divided by one exact power. So a single rounding gives the correct double (W. D.
 * Clinger, "How to read floating point numbers accurately", PLDI 1990). Nearly all numbers are of
 * this kind; strtod reads the others.
 */
#include "scene/token.h"

#include <stdlib.h>
#include <string.h>

#define NUMBER_LEN_MAX 511 /* characters; %f of the largest double has 317 */
#define PLAIN_DIGITS 15    /* an integer of that many is exact in a double */
#define EXPONENT_MAX 99999 /* beyond this the value is 0 or infinite for any digits */

static const double power_of_ten[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
static inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
static inline bool ends_token(const char *p, const char *end)
{
    return p == end || is_blank(*p) || *p == '#';
}

void tokens_init(struct tokens *t, const char *text, size_t n)
{
    if (n >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) text += 3, n -= 3;
    if (n && text[n - 1] == 0x1a) n--;
    *t = (struct tokens){text, text + n, 1};
}

/* Advances to the next byte that is neither blank nor comment. */
static inline void skip_blanks(struct tokens *t)
{
    const char *p = t->at, *end = t->end;
    for (; p < end && *p <= '#'; p++) { /* most bytes are above # and all blanks */
        if (*p == ' ') continue;
        if (*p == '#')
            while (p < end && *p != '\n' && *p != '\r') p++;
        if (p == end || !is_blank(*p)) break;
        if (*p == '\n' || (*p == '\r' && (p + 1 == end || p[1] != '\n'))) t->line++;
    }
    t->at = p;
}

size_t token_peek(struct tokens *t)
{
    skip_blanks(t);
    const char *p = t->at;
    while (!ends_token(p, t->end)) p++;
    return (size_t)(p - t->at);
}

/* The value of a token: (-1)^negative * digits * 10^power. */
struct decimal {
    bool negative;
    uint64_t digits; /* the first 19 significant digits */
    int n_digits;    /* number of significant digits, without leading zeros */
    int power;
};

static const char *scan_digits(const char *p, const char *end, struct decimal *d, bool *any)
{
    for (; p < end && is_digit(*p); p++) {
        *any = true;
        if (d->n_digits < 19) d->digits = d->digits * 10 + (uint64_t)(*p - '0');
        if ((d->n_digits || *p != '0') && d->n_digits <= NUMBER_LEN_MAX) d->n_digits++;
    }
    return p;
}

/* Returns the end of the number that starts at p; NULL if no number ends with the token. */
static const char *scan_decimal(const char *p, const char *end, struct decimal *d)
{
    bool any = false;
    *d = (struct decimal){0};
    if (p < end && (*p == '-' || *p == '+')) d->negative = *p++ == '-';
    p = scan_digits(p, end, d, &any);
    if (p < end && *p == '.') {
        const char *point = ++p;
        p = scan_digits(p, end, d, &any);
        if (p - point > NUMBER_LEN_MAX) return NULL;
        d->power = -(int)(p - point);
    }
    if (!any) return NULL;
    if (p < end && (*p == 'e' || *p == 'E')) {
        bool minus = ++p < end && *p == '-';
        if (p < end && (*p == '-' || *p == '+')) p++;
        const char *first = p;
        int e = 0;
        for (; p < end && is_digit(*p); p++)
            if (e <= EXPONENT_MAX) e = e * 10 + (*p - '0');
        if (p == first) return NULL;
        d->power += minus ? -e : e;
    }
    return ends_token(p, end) ? p : NULL;
}

/*
 * Returns the end of a number of at most PLAIN_DIGITS digits, with or without sign and point, and
 * its value; NULL if the token is anything else, or is near the end of the text.
 */
static inline const char *plain_number(const char *p, const char *end, double *out)
{
    uint64_t digits = 0, digit;
    if (end - p < PLAIN_DIGITS + 4) return NULL;
    bool negative = *p == '-';
    p += negative;
    const char *first = p, *last = p + PLAIN_DIGITS;
    for (; p < last && (digit = (uint64_t)(*p - '0')) < 10; p++) digits = digits * 10 + digit;
    long whole = p - first, fraction = 0;
    if (*p == '.') {
        const char *point = ++p;
        for (last++; p < last && (digit = (uint64_t)(*p - '0')) < 10; p++)
            digits = digits * 10 + digit;
        fraction = p - point;
    }
    if (!(whole + fraction) || !(is_blank(*p) || *p == '#')) return NULL;
    double v = (double)digits / power_of_ten[fraction];
    *out = negative ? -v : v;
    return p;
}

enum token_number token_real(struct tokens *t, double *out)
{
    struct decimal d;
    skip_blanks(t);
    if (t->at == t->end) return TOKEN_END;
    const char *p = plain_number(t->at, t->end, out);
    if (p) {
        t->at = p;
        return TOKEN_OK;
    }
    p = scan_decimal(t->at, t->end, &d);
    if (!p || p - t->at > NUMBER_LEN_MAX) return TOKEN_BAD;
    if (d.n_digits <= 15 && d.power >= -22 && d.power <= 22) {
        double v = (double)d.digits;
        v = d.power < 0 ? v / power_of_ten[-d.power] : v * power_of_ten[d.power];
        *out = d.negative ? -v : v;
    } else {
        char text[NUMBER_LEN_MAX + 1];
        memcpy(text, t->at, (size_t)(p - t->at));
        text[p - t->at] = '\0';
        *out = strtod(text, NULL);
    }
    t->at = p;
    return TOKEN_OK;
}
