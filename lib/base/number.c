/* number: ranged number parsing. All conversion of text to numbers goes through here. */
#include "base/base.h"

#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

bool parse_int(const char *s, int64_t min, int64_t max, int64_t *out)
{
    const char *digits = s + (*s == '-');
    if (!*digits || strspn(digits, "0123456789") != strlen(digits)) return false;
    errno = 0;
    long long v = strtoll(s, NULL, 10);
    if (errno || v < min || v > max) return false;
    *out = v;
    return true;
}

bool parse_real(const char *s, double min, double max, double *out)
{
    if (!*s || strspn(s, "0123456789+-.eE") != strlen(s)) return false;
    char *end;
    double v = strtod(s, &end);
    if (end == s || *end || !(v >= min && v <= max) || !isfinite(v)) return false;
    *out = v;
    return true;
}

bool parse_size(const char *s, int max, int *w, int *h)
{
    char text[32];
    size_t n = strlen(s);
    if (n >= sizeof text) return false;
    memcpy(text, s, n + 1);
    char *x = strchr(text, 'x');
    if (!x) return false;
    *x = '\0';
    int64_t a, b;
    if (!parse_int(text, 1, max, &a) || !parse_int(x + 1, 1, max, &b)) return false;
    *w = (int)a;
    *h = (int)b;
    return true;
}

int64_t opt_int(int opt, const char *s, int64_t min, int64_t max)
{
    int64_t v;
    if (!parse_int(s, min, max, &v))
        die(ST_USAGE, "-%c %s: expected an integer from %lld to %lld", opt, s, (long long)min,
            (long long)max);
    return v;
}

void opt_size(int opt, const char *s, int max, int *w, int *h)
{
    if (!parse_size(s, max, w, h))
        die(ST_USAGE, "-%c %s: expected a size such as 512x512, sides up to %d", opt, s, max);
}

double opt_real(int opt, const char *s, double min, double max)
{
    double v;
    if (!parse_real(s, min, max, &v))
        die(ST_USAGE, "-%c %s: expected a number from %g to %g", opt, s, min, max);
    return v;
}

double *opt_reals(int opt, const char *s, double min, double max, size_t *n)
{
    char *copy = xstrdup(s), *rest = copy, *word;
    double *v = NULL;
    for (*n = 0; (word = text_part(&rest, ',')) != NULL; (*n)++) {
        v = xrealloc(v, *n + 1, sizeof *v);
        if (!parse_real(word, min, max, &v[*n]))
            die(ST_USAGE, "-%c %s: `%s`, expected numbers from %g to %g with commas between", opt,
                s, word, min, max);
    }
    free(copy);
    return v;
}

void print_real(char text[32], double v, int digits)
{
    do snprintf(text, 32, "%.*g", digits, v);
    while (strtod(text, NULL) != v && digits++ < DBL_DECIMAL_DIG);
}

void print_float(char text[32], float v, int digits)
{
    do snprintf(text, 32, "%.*g", digits, (double)v);
    while (strtof(text, NULL) != v && digits++ < FLT_DECIMAL_DIG);
}
