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
    PALETTE,
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
    [RESOLUTION] = {"resolution",
        {{"width", 1, SPEC_RESOLUTION_MAX}, {"height", 1, SPEC_RESOLUTION_MAX}}, false},
    [LIGHT] = {"light", {COORDINATES}, false},
    [ATTENUATION] = {"attenuation", {{"a", 0, GRID_MAX}}, false},
    [SCALE] = {"scale", {COORDINATE("x"), COORDINATE("y"), COORDINATE("z")}, false},
    [LIMIT] = {"limit", {{"opacity", LIMIT_MIN, 1}}, false},
    [BACKGROUND] = {"background", {COLOUR}, false},
    [PALETTE] = {"palette", {{NULL, 0, 0}}, false},
    [MAP] = {"map", {COORDINATE("value"), COLOUR, {"extinction", 0, GRID_MAX}}, true},
    [ISO] = {"iso", {COORDINATE("value"), COLOUR, {"opacity", 0, 1}}, true},
};
/* Lines whose colour is a place in the palette. */
#define PLACE                                                                                      \
    {                                                                                              \
        "place", 0, 1                                                                              \
    }
static const struct range map_by_place[] = {
    COORDINATE("value"), PLACE, {"extinction", 0, GRID_MAX}, {NULL, 0, 0}};
static const struct range iso_by_place[] = {
    COORDINATE("value"), PLACE, {"opacity", 0, 1}, {NULL, 0, 0}};
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
    double palette[SPEC_PALETTE_POINTS][3]; /* if seen */
    double place;                           /* of the last knot; negative: it has its own colour */
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

static void push_knot(struct reader *r, double value, const double rgb[3], double k)
{
    struct spec *s = r->s;
    if (s->n_knots == r->room_knots) {
        r->room_knots = s->n_knots ? 2 * s->n_knots : 16;
        s->knot = xrealloc(s->knot, r->room_knots, sizeof *s->knot);
    }
    s->knot[s->n_knots] = (struct spec_knot){.s = value, .k = k};
    copy(s->knot[s->n_knots++].rgb, rgb);
}

/* Adds a knot for each colour of the palette between the last knot and one of this value, place and
 * extinction, because linear light from one end to the other has other colours. */
static void push_palette(struct reader *r, double value, double place, double k)
{
    const struct spec_knot a = r->s->knot[r->s->n_knots - 1];
    const double steps = SPEC_PALETTE_POINTS - 1, way = place - r->place;
    for (int i = 1; i < SPEC_PALETTE_POINTS - 1; i++) {
        int colour = way > 0 ? i : SPEC_PALETTE_POINTS - 1 - i;
        double f = (colour / steps - r->place) / way; /* way 0: no number, or infinite */
        double s = a.s + (value - a.s) * f;
        if (f > 0 && f < 1 && s > r->s->knot[r->s->n_knots - 1].s && s < value)
            push_knot(r, s, r->palette[colour], a.k + (k - a.k) * f);
    }
}

/* place: in the palette; negative: v has the colour. */
static bool add_knot(struct reader *r, const double v[5], double place)
{
    const struct spec *s = r->s;
    size_t n = s->n_knots;
    if (n && v[0] < s->knot[n - 1].s)
        return fail(r, "map: %g after %g, expected values that ascend", v[0], s->knot[n - 1].s);
    if (n > 1 && v[0] <= s->knot[n - 2].s)
        return fail(r, "map: %g for the third time, expected a value twice at most", v[0]);
    if (n && place >= 0 && r->place >= 0) push_palette(r, v[0], place, v[4]);
    push_knot(r, v[0], v + 1, v[4]);
    r->place = place;
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

static bool take_line(struct reader *r, enum word word, const double *v, double place)
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
    case PALETTE: break; /* read_palette */
    case MAP: return add_knot(r, v, place);
    case ISO: return add_iso(r, v);
    }
    return true;
}

/* ---- lines --------------------------------------------------------------------------------- */

static size_t count_words(struct reader *r)
{
    const char *begin = r->at;
    size_t count = 0;
    for (size_t n; (n = peek(r)) > 0; r->at += n) count++;
    r->at = begin;
    return count;
}

static bool read_palette(struct reader *r)
{
    size_t n = peek(r);
    if (!spec_palette(r->at, n, r->palette)) return fail_word(r, "palette", "name", SPEC_PALETTES);
    r->at += n;
    return true;
}

/* Reads the numbers of a word and takes them. Three of map and iso are a value, a place in the
 * palette, and extinction or opacity. */
static bool read_numbers(struct reader *r, enum word w)
{
    double v[NUMBERS_MAX] = {0}, place = -1;
    const char *name = words[w].name;
    const struct range *range = words[w].number;
    bool placed = (w == MAP || w == ISO) && count_words(r) == 3;
    if (placed && !(r->seen >> PALETTE & 1))
        return fail(
            r, "%s: 3 numbers and no palette, expected a palette line above, or 5 numbers", name);
    if (placed) range = w == MAP ? map_by_place : iso_by_place;
    for (int i = 0; i < NUMBERS_MAX && range[i].what; i++)
        if (!read_number(r, name, &range[i], &v[i])) return false;
    if (placed) {
        v[4] = v[2];
        place = v[1];
        spec_palette_at((const double(*)[3])r->palette, place, v + 1);
    }
    return take_line(r, w, v, place);
}

static bool read_line(struct reader *r)
{
    size_t n = peek(r), w = 0;
    if (!n) return true;
    while (w < WORDS && (strlen(words[w].name) != n || memcmp(words[w].name, r->at, n) != 0)) w++;
    if (w == WORDS)
        return fail_word(r, "line", "first word",
            "from, at, up, angle, resolution, light, attenuation, scale, limit, background, "
            "palette, map or iso");
    const char *name = words[w].name;
    if (r->seen >> w & 1 && !words[w].many) return fail(r, "%s: twice, expected it once", name);
    r->seen |= 1U << w;
    r->at += n;
    if (w == LIGHT && peek(r) == 3 && memcmp(r->at, "off", 3) == 0) r->at += 3;
    else if (w == PALETTE ? !read_palette(r) : !read_numbers(r, (enum word)w)) return false;
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
