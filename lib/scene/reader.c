/* reader: reads the numbers of NFF entities with range checks and messages with line numbers. */
#include "scene/prim.h"

#include <string.h>

bool reader_fail(struct reader *r, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    err_at(r->err, r->name, r->t.line, fmt, ap);
    va_end(ap);
    return false;
}

bool reader_fail_token(struct reader *r, const char *what, const char *expected)
{
    char shown[ERR_WORD];
    size_t n = token_peek(&r->t);
    if (!n) return reader_fail(r, "the file ends before %s, expected %s", what, expected);
    return reader_fail(r, "%s is %s, expected %s", what, err_word(shown, r->t.at, n), expected);
}

bool reader_real(struct reader *r, const char *what, double min, double max, double *out)
{
    struct tokens start = r->t;
    double v;
    if (token_real(&r->t, &v) != TOKEN_OK) return reader_fail_token(r, what, "a number");
    if (!(v >= min && v <= max)) {
        char range[64];
        r->t = start;
        snprintf(range, sizeof range, "a number from %.9g to %.9g", min, max);
        return reader_fail_token(r, what, range);
    }
    *out = v;
    return true;
}

bool reader_int(struct reader *r, const char *what, uint32_t min, uint32_t max, uint32_t *out)
{
    char range[64];
    uint64_t v = 0;
    size_t n = token_peek(&r->t), k = n && r->t.at[0] == '+';
    bool digits = k < n;
    for (; k < n && digits && v <= max; k++) {
        digits = r->t.at[k] >= '0' && r->t.at[k] <= '9';
        v = v * 10 + (uint64_t)(r->t.at[k] - '0');
    }
    if (!digits || v < min || v > max) {
        snprintf(range, sizeof range, "an integer from %u to %u", min, max);
        return reader_fail_token(r, what, range);
    }
    token_take(&r->t, n);
    *out = (uint32_t)v;
    return true;
}

bool reader_vec(struct reader *r, const char *what, double min, double max, struct vec3 *out)
{
    return reader_real(r, what, min, max, &out->x) && reader_real(r, what, min, max, &out->y) &&
           reader_real(r, what, min, max, &out->z);
}

bool reader_rgb(struct reader *r, const char *what, double rgb[3])
{
    for (int i = 0; i < 3; i++)
        if (!reader_real(r, what, 0, COLOUR_MAX, &rgb[i])) return false;
    return true;
}

void *reader_grown(void *p, uint32_t n, uint32_t *room, size_t size)
{
    if (n < *room) return p;
    *room = *room ? 2 * *room : 16;
    return xrealloc(p, *room, size);
}

bool reader_point(struct reader *r, const char *what, struct vec3 *out)
{
    return reader_vec(r, what, -COORDINATE_MAX, COORDINATE_MAX, out);
}

struct prim *reader_add_prim(struct reader *r, enum prim_kind kind)
{
    struct scene *s = r->s;
    s->prims = reader_grown(s->prims, s->n_prims, &r->room_prims, sizeof *s->prims);
    struct prim *p = &s->prims[s->n_prims++];
    memset(p, 0, sizeof *p);
    p->kind = kind;
    p->material = r->material;
    return p;
}
