/*
 * nff_view: the view of an NFF scene: a `v`, then words with their numbers, in any order; and a
 * view in a file of its own, without the `v`.
 */
#include "scene/reader.h"

#include <string.h>

#define RESOLUTION_MAX 65535
#define ANGLE_MIN 1e-6 /* degrees; its tangent still has full precision */
/*
 * Minimum sine of the angle between `up` and the viewing direction. The cross product then still
 * has more digits than the six that NFF files are written with.
 */
#define UP_SINE_MIN 1e-9

enum { FROM, AT, UP, ANGLE, HITHER, RESOLUTION, WORDS };
static const char *const words[WORDS] = {"from", "at", "up", "angle", "hither", "resolution"};

static int word_peek(struct reader *r)
{
    size_t n = token_peek(&r->t);
    for (int i = 0; n && i < WORDS; i++)
        if (strlen(words[i]) == n && memcmp(words[i], r->t.at, n) == 0) return i;
    return WORDS;
}

static bool word_value(struct reader *r, int word)
{
    struct view *v = &r->s->view;
    switch (word) {
    case FROM: return reader_vec(r, "view from", -COORDINATE_MAX, COORDINATE_MAX, &v->from);
    case AT: return reader_vec(r, "view at", -COORDINATE_MAX, COORDINATE_MAX, &v->at);
    case UP: return reader_vec(r, "view up", -COORDINATE_MAX, COORDINATE_MAX, &v->up);
    case ANGLE: return reader_real(r, "view angle", ANGLE_MIN, 180 - ANGLE_MIN, &v->angle_deg);
    case HITHER: return reader_real(r, "view hither", 0, COORDINATE_MAX, &v->hither);
    default:
        return reader_int(r, "view resolution", 1, RESOLUTION_MAX, &v->res_x) &&
               reader_int(r, "view resolution", 1, RESOLUTION_MAX, &v->res_y);
    }
}

/* Checks that from, at and up define a view. */
static bool check_frame(struct reader *r)
{
    const struct view *v = &r->s->view;
    struct vec3 dir = v3_sub(v->at, v->from);
    if (v3_len(dir) < LENGTH_MIN)
        return reader_fail(r, "view: from and at are the same point, expected two");
    if (v3_len(v->up) < LENGTH_MIN) return reader_fail(r, "view: up is zero, expected a direction");
    if (v3_len(v3_cross(v3_unit(dir), v3_unit(v->up))) < UP_SINE_MIN)
        return reader_fail(r, "view: up is parallel to the viewing direction, expected another");
    return true;
}

/* Reads words up to another token. */
static bool read_words(struct reader *r, unsigned *seen)
{
    for (int w; (w = word_peek(r)) < WORDS;) {
        if (*seen >> w & 1) return reader_fail(r, "view: a second '%s', expected one", words[w]);
        *seen |= 1U << w;
        token_take(&r->t, strlen(words[w]));
        if (!word_value(r, w)) return false;
    }
    return true;
}

/* alone: not within a scene, whose view has a resolution. */
static bool check_words(struct reader *r, unsigned seen, bool alone)
{
    for (int w = 0; w < WORDS; w++)
        if (!(seen >> w & 1) && w != HITHER && !(alone && w == RESOLUTION))
            return reader_fail(r, "view without '%s', expected from at up angle%s", words[w],
                alone ? "" : " resolution");
    return check_frame(r);
}

bool reader_view(struct reader *r)
{
    unsigned seen = 0;
    uint32_t line = r->t.line;
    if (r->view_line)
        return reader_fail(r, "a second view, expected only the one at line %u", r->view_line);
    r->view_line = line;
    return read_words(r, &seen) && check_words(r, seen, false);
}

int nff_read_view(const char *name, const char *text, size_t n, struct view *v, char err[SCENE_ERR])
{
    struct scene s = {.n_prims = 0};
    struct reader r = {.name = name, .err = err, .s = &s};
    unsigned seen = 0;
    tokens_init(&r.t, text, n);
    if (!read_words(&r, &seen)) return -1;
    if (token_peek(&r.t)) {
        reader_fail_token(&r, "word", "one of from at up angle hither resolution");
        return -1;
    }
    if (!check_words(&r, seen, true)) return -1;
    *v = s.view;
    return 0;
}
