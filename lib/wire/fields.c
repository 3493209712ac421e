/* Reading the fields of a decoded record. */
#include "wire/wire.h"

#include <inttypes.h>
#include <string.h>

const char *rec_key(const struct record *r, const char *key, size_t *len)
{
    size_t n = strlen(key);
    const char *at = r->line, *end = r->line + r->line_len;
    while ((at = memchr(at, ' ', (size_t)(end - at))) != NULL) {
        at++;
        if ((size_t)(end - at) <= n || memcmp(at, key, n) != 0 || at[n] != '=') continue;
        const char *value = at + n + 1;
        const char *stop = memchr(value, ' ', (size_t)(end - value));
        *len = (size_t)((stop ? stop : end) - value);
        return value;
    }
    return NULL;
}

bool rec_str(const struct record *r, const char *key, char *out, size_t size)
{
    size_t n;
    const char *v = rec_key(r, key, &n);
    if (!v || n >= size) return false;
    memcpy(out, v, n);
    out[n] = '\0';
    return true;
}

static int digit(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

void rec_said(const struct record *r, char said[WIRE_SAID])
{
    size_t n = 0, m = 0;
    const char *v = rec_key(r, "said", &n);
    for (size_t i = 0; v && i < n && m < WIRE_SAID - 1; i++) {
        bool coded = v[i] == '%' && i + 2 < n && digit(v[i + 1]) >= 0 && digit(v[i + 2]) >= 0;
        said[m++] = coded ? (char)(digit(v[i + 1]) << 4 | digit(v[i + 2])) : v[i];
        if (coded) i += 2;
    }
    said[m] = '\0';
}

int32_t rec_slot(const struct record *r)
{
    char name[32];
    int64_t slot = -1;
    if (!rec_str(r, "w", name, sizeof name)) return -1;
    name[strcspn(name, ".")] = '\0';
    return parse_int(name, 0, WIRE_SLOTS_MAX - 1, &slot) ? (int32_t)slot : -1;
}

bool rec_is(const struct record *r, const char *key, const char *value)
{
    size_t n;
    const char *v = rec_key(r, key, &n);
    return v && n == strlen(value) && memcmp(v, value, n) == 0;
}

bool rec_sealed(const struct record *r)
{
    return r->line_len > WIRE_SEAL_BYTES &&
           memcmp(r->line + r->line_len - WIRE_SEAL_BYTES, " sum=", 5) == 0;
}

bool rec_ours(const struct record *r, char why[160])
{
    int64_t format = 1; /* no key: format 1 */
    if (r->kind != REC_HELLO) return true;
    rec_int(r, "format", 0, INT64_MAX, &format);
    if (format == WIRE_FORMAT) return true;
    snprintf(why, 160,
        "is of format %" PRId64 ", expected %d: use programs of one version, or begin a new log",
        format, WIRE_FORMAT);
    return false;
}

bool rec_int(const struct record *r, const char *key, int64_t min, int64_t max, int64_t *out)
{
    char text[24];
    return rec_str(r, key, text, sizeof text) && parse_int(text, min, max, out);
}

bool rec_real(const struct record *r, const char *key, double min, double max, double *out)
{
    char text[40];
    return rec_str(r, key, text, sizeof text) && parse_real(text, min, max, out);
}

void wire_pixels(const unsigned char *body, size_t n, float *rgba)
{
    for (size_t i = 0; i < 4 * n; i++) {
        const unsigned char *b = body + 4 * i;
        uint32_t bits =
            (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
        memcpy(rgba + i, &bits, 4);
    }
}

void rec_pixels(const struct record *r, float *rgba)
{
    wire_pixels(r->body, r->body_len / WIRE_PIXEL_BYTES, rgba);
}
