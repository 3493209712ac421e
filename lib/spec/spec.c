/*
 * spec: reads a rendering specification: lines of one word and its numbers. stormring-spec(5) is
 * the manual.
 *
 * One table lists the words, their numbers and the ranges. Constraints between lines are checked
 * when the line comes (the map ascends) or at the end (the view is complete).
 */
#include "spec/spec.h"

#include <stdlib.h>
#include <string.h>

#define NUMBERS_MAX 5
#define NUMBER_LEN_MAX 63 /* characters */
#define RESOLUTION_MAX 65535
#define COLOUR_MAX 1e6
#define LIMIT_MIN 1e-3
#define LENGTH_MIN 1e-18 /* its square is a normal number */
#define SCALE_MIN 1e-9
#define SCALE_MAX 1e9
#define ANGLE_MIN 1e-6 /* degrees; its tangent still has full precision */
/* Minimum sine of the angle between `up` and the viewing direction, as in NFF scenes. */
#define UP_SINE_MIN 1e-9

enum word {
    FROM,
    AT,
    UP,
    ANGLE,
    RESOLUTION,
    LIGHT,
    ATTENUATION,
    SCALE,
    LIMIT,
    BACKGROUND,
    MAP,
    ISO
};
struct range {
    const char *what;
    double min, max;
};
#define COORDINATE(what)                                                                           \
    {                                                                                              \
        what, -GRID_MAX, GRID_MAX                                                                  \
    }
#define COORDINATES COORDINATE("x"), COORDINATE("y"), COORDINATE("z")
#define COLOUR                                                                                     \
    {"red", 0, COLOUR_MAX}, {"green", 0, COLOUR_MAX}, { "blue", 0, COLOUR_MAX }
static const struct {
    const char *name;
    struct range number[NUMBERS_MAX]; /* ends at the first entry without a name */
    bool many;
} words[] = {
    [FROM] = {"from", {COORDINATES}, false},
    [AT] = {"at", {COORDINATES}, false},
    [UP] = {"up", {COORDINATES}, false},
    [ANGLE] = {"angle", {{"degrees", ANGLE_MIN, 180 - ANGLE_MIN}}, false},
    [RESOLUTION] = {"resolution", {{"width", 1, RESOLUTION_MAX}, {"height", 1, RESOLUTION_MAX}},
        false},
    [LIGHT] = {"light", {COORDINATES}, false},
    [ATTENUATION] = {"attenuation", {{"a", 0, GRID_MAX}}, false},
    [SCALE] = {"scale", {COORDINATE("x"), COORDINATE("y"), COORDINATE("z")}, false},
    [LIMIT] = {"limit", {{"opacity", LIMIT_MIN, 1}}, false},
    [BACKGROUND] = {"background", {COLOUR}, false},
    [MAP] = {"map", {COORDINATE("value"), COLOUR, {"extinction", 0, GRID_MAX}}, true},
    [ISO] = {"iso", {COORDINATE("value"), COLOUR, {"opacity", 0, 1}}, true},
};
#define WORDS (sizeof words / sizeof *words)
#define NEEDED (1U << FROM | 1U << AT | 1U << UP | 1U << ANGLE | 1U << RESOLUTION)

struct reader {
    const char *at, *end; /* the unread part of the line */
    const char *name;     /* for messages */
    char *err;            /* ERR_BYTES bytes */
    size_t line;          /* from 1 */
    unsigned seen;        /* one bit per word */
    struct spec *s;
    size_t room_knots, room_isos;
};

static bool fail(struct reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
static bool fail(struct reader *r, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    err_at(r->err, r->name, r->line, fmt, ap);
    va_end(ap);
    return false;
}

static inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Advances to the next word of the line and returns its length; 0 at the end or before a
 * comment. */
static size_t peek(struct reader *r)
{
    while (r->at < r->end && is_blank(*r->at)) r->at++;
    const char *p = r->at;
    while (p < r->end && !is_blank(*p) && *p != '#') p++;
    return (size_t)(p - r->at);
}

static bool fail_word(struct reader *r, const char *word, const char *what, const char *expected)
{
    char shown[ERR_WORD];
    size_t n = peek(r);
    if (!n) return fail(r, "%s: no %s, expected %s", word, what, expected);
    return fail(r, "%s: %s is %s, expected %s", word, what, err_word(shown, r->at, n), expected);
}

static bool read_number(struct reader *r, const char *word, const struct range *range, double *v)
{
    char text[NUMBER_LEN_MAX + 1], expected[80];
    size_t n = peek(r), k = n <= NUMBER_LEN_MAX ? n : 0;
    memcpy(text, r->at, k);
    text[k] = '\0';
    if (strlen(text) == n && parse_real(text, range->min, range->max, v)) {
        r->at += n;
        return true;
    }
    snprintf(expected, sizeof expected, "a number from %g to %g", range->min, range->max);
    return fail_word(r, word, range->what, expected);
}

/* ---- words of more than numbers ------------------------------------------------------------ */

static void copy(double to[3], const double from[3]) { memcpy(to, from, 3 * sizeof *to); }

static bool add_knot(struct reader *r, const double v[5])
{
    struct spec *s = r->s;
    size_t n = s->n_knots;
    if (n && v[0] < s->knot[n - 1].s)
        return fail(r, "map: %g after %g, expected values that ascend", v[0], s->knot[n - 1].s);
    if (n > 1 && v[0] <= s->knot[n - 2].s)
        return fail(r, "map: %g for the third time, expected a value twice at most", v[0]);
    if (n == r->room_knots) {
        r->room_knots = n ? 2 * n : 16;
        s->knot = xrealloc(s->knot, r->room_knots, sizeof *s->knot);
    }
    s->knot[n] = (struct spec_knot){.s = v[0], .k = v[4]};
    copy(s->knot[n].rgb, v + 1);
    s->n_knots++;
    return true;
}

static bool add_iso(struct reader *r, const double v[5])
{
    struct spec *s = r->s;
    if (s->n_isos == r->room_isos) {
        r->room_isos = s->n_isos ? 2 * s->n_isos : 16;
        s->iso = xrealloc(s->iso, r->room_isos, sizeof *s->iso);
    }
    s->iso[s->n_isos] = (struct spec_iso){.s = v[0], .opacity = v[4]};
    copy(s->iso[s->n_isos++].rgb, v + 1);
    return true;
}

static bool take_scale(struct reader *r, const double v[3])
{
    for (int a = 0; a < 3; a++)
        if (!(fabs(v[a]) >= SCALE_MIN && fabs(v[a]) <= SCALE_MAX))
            return fail(r, "scale: %c is %g, expected %g to %g, or the same below 0", "xyz"[a],
                v[a], SCALE_MIN, SCALE_MAX);
    copy(r->s->scale, v);
    return true;
}

static bool take_resolution(struct reader *r, const double v[2])
{
    if (v[0] != floor(v[0]) || v[1] != floor(v[1]))
        return fail(r, "resolution: %g %g, expected whole pixels", v[0], v[1]);
    r->s->w = (uint32_t)v[0];
    r->s->h = (uint32_t)v[1];
    return true;
}

static bool take_line(struct reader *r, enum word word, const double *v)
{
    struct spec *s = r->s;
    switch (word) {
    case FROM: copy(s->from, v); break;
    case AT: copy(s->at, v); break;
    case UP: copy(s->up, v); break;
    case ANGLE: s->angle = v[0]; break;
    case RESOLUTION: return take_resolution(r, v);
    case LIGHT:
        s->lit = true;
        copy(s->light, v);
        break;
    case ATTENUATION: s->attenuation = v[0]; break;
    case SCALE: return take_scale(r, v);
    case LIMIT: s->opacity_limit = v[0]; break;
    case BACKGROUND:
        s->backed = true;
        copy(s->background, v);
        break;
    case MAP: return add_knot(r, v);
    case ISO: return add_iso(r, v);
    }
    return true;
}

/* ---- lines --------------------------------------------------------------------------------- */

static bool read_line(struct reader *r)
{
    double v[NUMBERS_MAX] = {0};
    size_t n = peek(r), w = 0;
    if (!n) return true;
    while (w < WORDS && (strlen(words[w].name) != n || memcmp(words[w].name, r->at, n) != 0)) w++;
    if (w == WORDS)
        return fail_word(r, "line", "first word",
            "from, at, up, angle, resolution, light, attenuation, scale, limit, background, map "
            "or iso");
    const char *name = words[w].name;
    if (r->seen >> w & 1 && !words[w].many) return fail(r, "%s: twice, expected it once", name);
    r->seen |= 1U << w;
    r->at += n;
    if (w == LIGHT && peek(r) == 3 && memcmp(r->at, "off", 3) == 0) r->at += 3;
    else {
        for (int i = 0; i < NUMBERS_MAX && words[w].number[i].what; i++)
            if (!read_number(r, name, &words[w].number[i], &v[i])) return false;
        if (!take_line(r, (enum word)w, v)) return false;
    }
    return !peek(r) || fail_word(r, name, "next word", "the line's end");
}

static struct vec3 vec(const double v[3]) { return v3(v[0], v[1], v[2]); }

static bool check_view(struct reader *r)
{
    for (size_t w = 0; w < WORDS; w++)
        if (NEEDED >> w & 1 && !(r->seen >> w & 1))
            return fail(r, "no '%s', expected from, at, up, angle and resolution", words[w].name);
    struct vec3 dir = v3_sub(vec(r->s->at), vec(r->s->from)), up = vec(r->s->up);
    if (v3_len(dir) < LENGTH_MIN) return fail(r, "from and at are one point, expected two");
    if (v3_len(up) < LENGTH_MIN) return fail(r, "up is zero, expected a direction");
    if (v3_len(v3_cross(v3_unit(dir), v3_unit(up))) < UP_SINE_MIN)
        return fail(r, "up is along the viewing direction, expected another");
    return true;
}

static int by_value(const void *a, const void *b)
{
    double x = ((const struct spec_iso *)a)->s, y = ((const struct spec_iso *)b)->s;
    return (x > y) - (x < y);
}

static bool check_field(struct reader *r)
{
    struct spec *s = r->s;
    if (!s->n_knots && !s->n_isos) return fail(r, "nothing is visible, expected map or iso lines");
    if (s->n_knots == 1) return fail(r, "one map line, expected two or more");
    if (s->n_isos) qsort(s->iso, s->n_isos, sizeof *s->iso, by_value);
    for (size_t i = 1; i < s->n_isos; i++)
        if (s->iso[i].s <= s->iso[i - 1].s)
            return fail(r, "iso: %g twice, expected a value once", s->iso[i].s);
    return true;
}

/* Lines end in LF, CR LF or CR. */
static bool read_lines(struct reader *r, const char *text, const char *end)
{
    while (text < end) {
        const char *stop = text;
        while (stop < end && *stop != '\n' && *stop != '\r') stop++;
        r->line++;
        r->at = text;
        r->end = stop;
        if (!read_line(r)) return false;
        text = stop + (end - stop > 1 && stop[0] == '\r' && stop[1] == '\n') + (stop < end);
    }
    return check_view(r) && check_field(r);
}

int spec_read(const char *name, const char *text, size_t n, struct spec *s, char err[ERR_BYTES])
{
    struct reader r = {.name = name, .err = err, .s = s};
    *s = (struct spec){.scale = {1, 1, 1}, .opacity_limit = SPEC_LIMIT};
    err[0] = '\0';
    if (read_lines(&r, text, text + n)) return 0;
    spec_free(s);
    return -1;
}

void spec_free(struct spec *s)
{
    free(s->knot);
    free(s->iso);
    *s = (struct spec){0};
}

int spec_load(const char *path, struct spec *s, char err[ERR_BYTES])
{
    struct buf b;
    *s = (struct spec){.knot = NULL};
    if (!load_file(path, &b, err)) return -1;
    int failed = spec_read(path, (const char *)buf_data(&b), buf_size(&b), s, err);
    buf_free(&b);
    return failed;
}
