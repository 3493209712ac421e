/* vtk_text: words and numbers of untrusted VTK legacy files. */
#include "grid/vtk_text.h"

#include <float.h>
#include <string.h>
#include <strings.h>

#define NUMBER_LEN_MAX 63 /* characters */
#define RANGE 128

/* ---- messages ------------------------------------------------------------------------------ */

size_t vtk_lines(const unsigned char *p, const unsigned char *end)
{
    size_t n = 0;
    for (; p < end; p++) n += *p == '\n';
    return n;
}

bool vtk_fail(struct vtk_reader *r, const char *fmt, ...)
{
    size_t line = r->line + vtk_lines(r->kept ? r->kept : r->bytes, r->at);
    va_list ap;
    va_start(ap, fmt);
    err_at(r->err, r->name, line + 1, fmt, ap);
    va_end(ap);
    return false;
}

/* ---- words --------------------------------------------------------------------------------- */

static inline bool is_blank(unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

size_t vtk_peek(struct vtk_reader *r)
{
    while (r->at < r->end && is_blank(*r->at)) r->at++;
    const unsigned char *p = r->at;
    while (p < r->end && !is_blank(*p)) p++;
    return (size_t)(p - r->at);
}

bool vtk_fail_word(struct vtk_reader *r, const char *what, const char *expected)
{
    char shown[ERR_WORD];
    size_t n = vtk_peek(r);
    if (!n) return vtk_fail(r, "the file ends before %s, expected %s", what, expected);
    return vtk_fail(r, "%s is %s, expected %s", what, err_word(shown, r->at, n), expected);
}

bool vtk_next_is(struct vtk_reader *r, const char *word)
{
    size_t n = vtk_peek(r);
    return n == strlen(word) && strncasecmp((const char *)r->at, word, n) == 0;
}

bool vtk_take(struct vtk_reader *r, const char *word)
{
    if (!vtk_next_is(r, word)) return false;
    r->at += strlen(word);
    return true;
}

bool vtk_expect(struct vtk_reader *r, const char *what, const char *word)
{
    return vtk_take(r, word) || vtk_fail_word(r, what, word);
}

bool vtk_count(struct vtk_reader *r, const char *what, uint64_t min, uint64_t max, uint64_t *v)
{
    char text[NUMBER_LEN_MAX + 1], range[80];
    int64_t value;
    size_t n = vtk_peek(r);
    if (min == max) snprintf(range, sizeof range, "%llu", (unsigned long long)min);
    else
        snprintf(range, sizeof range, "an integer from %llu to %llu", (unsigned long long)min,
            (unsigned long long)max);
    if (!n || n > NUMBER_LEN_MAX) return vtk_fail_word(r, what, range);
    memcpy(text, r->at, n);
    text[n] = '\0';
    if (strlen(text) != n || !parse_int(text, (int64_t)min, (int64_t)max, &value))
        return vtk_fail_word(r, what, range);
    r->at += n;
    *v = (uint64_t)value;
    return true;
}

bool vtk_type(struct vtk_reader *r, struct vtk_type *t)
{
    for (size_t i = 0; i < VTK_TYPES; i++)
        if (vtk_take(r, vtk_types[i].name)) {
            *t = vtk_types[i];
            return true;
        }
    return vtk_fail_word(r, "type of numbers", "float, double or an integer type of VTK");
}

static int hex(unsigned char c)
{
    static const char digits[] = "0123456789abcdef";
    const char *at = c ? strchr(digits, c | 0x20) : NULL;
    return at && !(c < '0') ? (int)(at - digits) : -1;
}

bool vtk_name(struct vtk_reader *r, char name[GRID_NAME])
{
    size_t n = vtk_peek(r), k = 0;
    if (!n) return vtk_fail_word(r, "name of an array", "a word");
    for (size_t i = 0; i < n && k + 1 < GRID_NAME; i++) {
        unsigned char c = r->at[i];
        if (c == '%' && n - i > 2 && hex(r->at[i + 1]) >= 0 && hex(r->at[i + 2]) >= 0) {
            c = (unsigned char)(hex(r->at[i + 1]) * 16 + hex(r->at[i + 2]));
            i += 2;
        }
        name[k++] = c < ' ' || c == 0x7f ? '?' : (char)c;
    }
    name[k] = '\0';
    r->at += n;
    return true;
}

/* ---- numbers ------------------------------------------------------------------------------- */

bool vtk_begin_numbers(struct vtk_reader *r, const char *what, struct vtk_type t, uint64_t count)
{
    uint64_t room;
    if (r->binary) {
        while (r->at < r->end && (*r->at == ' ' || *r->at == '\t' || *r->at == '\r')) r->at++;
        if (r->at == r->end || *r->at != '\n')
            return vtk_fail_word(r, what, "a line end before them");
        r->at++;
        room = (uint64_t)(r->end - r->at) / t.size;
    } else {
        room = ((uint64_t)(r->end - r->at) + 1) / 2; /* one digit and one blank */
    }
    if (count <= room) return true;
    return vtk_fail(r, "%s: %llu announced, but the file has bytes for %llu, expected all", what,
        (unsigned long long)count, (unsigned long long)room);
}

/* The range of a type, also in words if range is not NULL. */
static void type_range(struct vtk_type t, double *min, double *max, char *range)
{
    const char *name = t.name;
    if (t.form == FORM_REAL) {
        *max = t.size == sizeof(float) ? (double)FLT_MAX : DBL_MAX;
        *min = -*max;
        if (range)
            snprintf(range, RANGE, "a number from %g to %g: it is of type %s", *min, *max, name);
        return;
    }
    uint64_t most = UINT64_MAX >> (64 - 8 * t.size + (t.form == FORM_SIGNED));
    int64_t least = t.form == FORM_SIGNED ? -(int64_t)most - 1 : 0;
    *max = (double)most; /* 64-bit limits are rounded */
    *min = (double)least;
    if (range)
        snprintf(range, RANGE, "an integer from %lld to %llu: it is of type %s", (long long)least,
            (unsigned long long)most, name);
}

bool vtk_text(struct vtk_reader *r, const char *what, struct vtk_type t, double *v)
{
    char text[NUMBER_LEN_MAX + 1], range[RANGE];
    double min, max;
    size_t n = vtk_peek(r), sign = n && (*r->at == '-' || *r->at == '+');
    bool real = t.form == FORM_REAL, good = n && n <= NUMBER_LEN_MAX && !memchr(r->at, 0, n);
    type_range(t, &min, &max, NULL);
    memcpy(text, r->at, good ? n : 0);
    text[good ? n : 0] = '\0';
    if (good && real && strcasecmp(text + sign, "nan") == 0) *v = (double)NAN;
    else if (!good || !parse_real(text, min, max, v) || (!real && trunc(*v) != *v)) {
        type_range(t, &min, &max, range);
        return vtk_fail_word(r, what, range);
    }
    r->at += n;
    return true;
}

bool vtk_number(struct vtk_reader *r, const char *what, struct vtk_type t, double *v)
{
    if (r->binary) {
        *v = vtk_decode(r->at, t);
        r->at += t.size;
    } else if (!vtk_text(r, what, t, v)) return false;
    if (isnan(*v) || fabs(*v) <= GRID_MAX) return true;
    return vtk_fail(r, "%s: %g, expected numbers from %g to %g, and nan for missing ones", what, *v,
        -GRID_MAX, GRID_MAX);
}

void vtk_skip_metadata(struct vtk_reader *r)
{
    if (!vtk_take(r, "METADATA")) return;
    size_t line = 1;
    while (r->at < r->end && line) {
        const unsigned char *nl = memchr(r->at, '\n', (size_t)(r->end - r->at));
        const unsigned char *next = nl ? nl + 1 : r->end, *p = r->at;
        if (p > r->bytes && p[-1] == '\n')
            for (line = 0; p < next; p++) line += !is_blank(*p);
        r->at = next;
    }
}

bool vtk_skip_strings(struct vtk_reader *r, uint64_t count)
{
    for (uint64_t i = 0; i <= count; i++) { /* first the end of the line of their type */
        const size_t left = (size_t)(r->end - r->at);
        const unsigned char *nl = i && r->binary ? NULL : memchr(r->at, '\n', left);
        if (nl) r->at = nl + 1;
        if (nl) continue;
        const size_t head = left && i && r->binary ? (size_t)8 >> (*r->at >> 6) : left + 1;
        if (head > left) return vtk_fail(r, "ends within the strings of a field, expected all");
        uint64_t n = *r->at & 0x3f;
        for (size_t k = 1; k < head; k++) n = n << 8 | r->at[k];
        if (n > left - head) return vtk_fail(r, "ends within the strings of a field, expected all");
        r->at += head + n;
    }
    return true;
}
