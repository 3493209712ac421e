/* Whatever the bytes: spec_read returns a specification in range, or a message. */
#include "spec/spec.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

static void check_colour(const double rgb[3])
{
    for (int i = 0; i < 3; i++) MUST(rgb[i] >= 0 && rgb[i] <= 1e6);
}

static void check_colours(const struct spec_knot *k, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        check_colour(k[i].rgb);
        MUST(fabs(k[i].s) <= GRID_MAX && k[i].k == 0);
        MUST(!i || k[i].s >= k[i - 1].s);
        MUST(i < 2 || k[i].s > k[i - 2].s);
    }
}

static void check_spec(const struct spec *s)
{
    MUST(s->w >= 1 && s->w <= 65535 && s->h >= 1 && s->h <= 65535);
    MUST(s->angle > 0 && s->angle < 180);
    MUST(s->opacity_limit > 0 && s->opacity_limit <= 1 && s->attenuation >= 0);
    for (int a = 0; a < 3; a++) MUST(isfinite(s->scale[a]) && fabs(s->scale[a]) > 0);
    check_colour(s->background);
    MUST(s->n_knots != 1 && s->n_knots + s->n_isos + s->n_grounds > 0);
    MUST(!s->n_colours || s->n_knots);
    check_colours(s->colour, s->n_colours);
    check_colours(s->ground, s->n_grounds);
    for (size_t i = 0; i < s->n_knots; i++) {
        check_colour(s->knot[i].rgb);
        MUST(fabs(s->knot[i].s) <= GRID_MAX && s->knot[i].k >= 0 && s->knot[i].k <= GRID_MAX);
        MUST(!i || s->knot[i].s >= s->knot[i - 1].s);
        MUST(i < 2 || s->knot[i].s > s->knot[i - 2].s);
    }
    for (size_t i = 0; i < s->n_isos; i++) {
        check_colour(s->iso[i].rgb);
        MUST(fabs(s->iso[i].s) <= GRID_MAX && s->iso[i].opacity >= 0 && s->iso[i].opacity <= 1);
        MUST(!i || s->iso[i].s > s->iso[i - 1].s);
    }
    MUST(s->n_slices == 0 || s->n_knots > 0);
    for (size_t i = 0; i < s->n_slices; i++) {
        const struct spec_slice *p = &s->slice[i];
        MUST(p->axis >= 0 && p->axis < 3 && fabs(p->at) <= GRID_MAX);
        MUST(p->opacity >= 0 && p->opacity <= 1);
        MUST(!i || p->axis > p[-1].axis || (p->axis == p[-1].axis && p->at > p[-1].at));
    }
    for (int a = 0; s->clipped && a < 3; a++) MUST(s->clip[a][0] < s->clip[a][1]);
}

/* What is written reads back, and is written again with the same bytes. */
static void check_written(const struct spec *s)
{
    struct spec back;
    struct buf once = {0}, twice = {0};
    char err[ERR_BYTES];
    spec_write(s, &once);
    MUST(spec_read("fuzz", (const char *)buf_data(&once), buf_size(&once), &back, err) == 0);
    spec_write(&back, &twice);
    MUST(buf_size(&once) == buf_size(&twice));
    MUST(memcmp(buf_data(&once), buf_data(&twice), buf_size(&once)) == 0);
    spec_free(&back);
    buf_free(&once);
    buf_free(&twice);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct spec s;
    char err[ERR_BYTES];
    /* Exactly as long as the bytes, so that a read past them is seen. */
    char *text = xmalloc(size, 1);
    if (size) memcpy(text, data, size);
    int rc = spec_read("fuzz", text, size, &s, err);
    free(text);
    if (rc != 0) {
        MUST(strncmp(err, "fuzz:", 5) == 0 && strlen(err) > 8);
        MUST(!s.knot && !s.iso && !s.slice && !s.colour && !s.ground);
        return 0;
    }
    check_spec(&s);
    check_written(&s);
    spec_free(&s);
    return 0;
}
