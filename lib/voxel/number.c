/* number: lines, words and numbers of files. */
#include "voxel/voxel_int.h"

#include <string.h>
#include <strings.h>

#define WORD_MAX 63 /* characters of a number */

double voxel_decode(const unsigned char *p, struct voxel_type t, bool big)
{
    uint64_t u = 0;
    for (int i = 0; i < t.size; i++) u |= (uint64_t)p[big ? t.size - 1 - i : i] << 8 * i;
    if (t.form == VOXEL_UNSIGNED) return (double)u;
    if (t.form == VOXEL_SIGNED) {
        const uint64_t sign = UINT64_C(1) << (8 * t.size - 1);
        return u & sign ? -(double)((sign - 1 - (u & (sign - 1))) + 1) : (double)u;
    }
    double d;
    float f;
    const uint32_t low = (uint32_t)u;
    memcpy(&f, &low, sizeof f);
    memcpy(&d, &u, sizeof d);
    return t.size == sizeof f ? (double)f : d;
}

static bool is_blank(unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

char *voxel_trim(char *text)
{
    size_t n = strlen(text);
    while (n && is_blank((unsigned char)text[n - 1])) text[--n] = '\0';
    while (is_blank((unsigned char)*text)) text++;
    return text;
}

char *voxel_line(struct voxel *v, size_t *at, char line[VOXEL_LINE])
{
    const unsigned char *p = v->bytes + *at;
    const size_t left = v->n_bytes - *at;
    if (!left) return NULL;
    const unsigned char *end = memchr(p, '\n', left);
    const size_t n = end ? (size_t)(end - p) : left;
    v->line++;
    if (n >= VOXEL_LINE || memchr(p, 0, n)) {
        voxel_fail(v, "no line of text, expected one of %d bytes at most", VOXEL_LINE - 1);
        return NULL;
    }
    memcpy(line, p, n);
    line[n] = '\0';
    *at += n + (end != NULL);
    return voxel_trim(line);
}

size_t voxel_word(const unsigned char *p, size_t n, bool numbers, size_t *at)
{
    size_t end;
    while (*at < n && (is_blank(p[*at]) || (numbers && p[*at] == ','))) ++*at;
    for (end = *at; end < n && !is_blank(p[end]) && !(numbers && p[end] == ','); end++) continue;
    return end - *at;
}

bool voxel_number(const unsigned char *word, size_t n, double *out)
{
    char text[WORD_MAX + 1];
    if (!n || n > WORD_MAX || memchr(word, 0, n)) return false;
    memcpy(text, word, n);
    text[n] = '\0';
    const bool minus = *text == '-';
    const char *digits = text + (minus || *text == '+');
    if (strcasecmp(digits, "nan") == 0) *out = (double)NAN;
    else if (strcasecmp(digits, "inf") == 0 || strcasecmp(digits, "infinity") == 0)
        *out = minus ? -HUGE_VAL : HUGE_VAL;
    else return parse_real(text, -HUGE_VAL, HUGE_VAL, out);
    return true;
}

bool voxel_reals(struct voxel *v, const char *what, const char *text, size_t n, double *out)
{
    const unsigned char *p = (const unsigned char *)text;
    const size_t length = strlen(text);
    size_t at = 0, k;
    for (size_t i = 0; i <= n; i++, at += k) {
        k = voxel_word(p, length, true, &at);
        if (i == n ? k != 0 : !k || !voxel_number(p + at, k, &out[i])) {
            char shown[ERR_WORD];
            return voxel_fail(v, "%s: %s, expected %zu number%s", what,
                err_word(shown, text, length), n, n == 1 ? "" : "s");
        }
    }
    return true;
}
