/*
 * spec: reads a rendering specification: lines of one word and its numbers. stormring-spec(5) is
 * the manual.
 *
 * One table lists the words, their numbers and the ranges. Constraints between lines are checked
 * when the line comes (the map ascends) or at the end (the view is complete).
 */
#include "geometry/geometry.h"
#include "spec/spec_int.h"

#include <stdlib.h>

#define NUMBERS_MAX 6
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
    CLIP,
    MAP,
    ISO,
    SLICE,
    TINT,
    GROUND,
    FLAT,
    PROFILE
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
    [CLIP] = {"clip",
        {COORDINATE("x0"), COORDINATE("y0"), COORDINATE("z0"), COORDINATE("x1"), COORDINATE("y1"),
            COORDINATE("z1")},
        false},
    [MAP] = {"map", {COORDINATE("value"), COLOUR, {"extinction", 0, GRID_MAX}}, true},
    [ISO] = {"iso", {COORDINATE("value"), COLOUR, {"opacity", 0, 1}}, true},
    [SLICE] = {"slice", {COORDINATE("place"), {"opacity", 0, 1}}, true}, /* after its axis */
    [TINT] = {"colour", {COORDINATE("value"), COLOUR}, true},
    [GROUND] = {"ground", {COORDINATE("height"), COLOUR}, true},
    [FLAT] = {"flat", {COORDINATE("z"), {"opacity", 0, 1}}, false},
    [PROFILE] = {"profile", {COORDINATE("z"), COORDINATE("value")}, true},
};
/* Lines whose colour is a place in the palette. */
#define PLACE                                                                                      \
    {                                                                                              \
        "place", 0, 1                                                                              \
    }
static const struct range map_by_place[] = {
    COORDINATE("value"), PLACE, {"extinction", 0, GRID_MAX}, {NULL, 0, 0}};
static const struct range tint_by_place[] = {COORDINATE("value"), PLACE, {NULL, 0, 0}};
static const struct range ground_by_place[] = {COORDINATE("height"), PLACE, {NULL, 0, 0}};
static const struct range iso_by_place[] = {
    COORDINATE("value"), PLACE, {"opacity", 0, 1}, {NULL, 0, 0}};
#define WORDS (sizeof words / sizeof *words)
#define NEEDED (1U << FROM | 1U << AT | 1U << UP | 1U << ANGLE | 1U << RESOLUTION)

static inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Advances to the next word of the line and returns its length; 0 at the end or before a
 * comment. */
static size_t peek(struct spec_reader *r)
{
    while (r->at < r->end && is_blank(*r->at)) r->at++;
    const char *p = r->at;
    while (p < r->end && !is_blank(*p) && *p != '#') p++;
    return (size_t)(p - r->at);
}

static bool fail_word(
    struct spec_reader *r, const char *word, const char *what, const char *expected)
{
    char shown[ERR_WORD];
    size_t n = peek(r);
    if (!n) return spec_fail(r, "%s: no %s, expected %s", word, what, expected);
    return spec_fail(
        r, "%s: %s is %s, expected %s", word, what, err_word(shown, r->at, n), expected);
}

static bool read_number(
    struct spec_reader *r, const char *word, const struct range *range, double *v)
{
    char text[NUMBER_LEN_MAX + 1], expected[80];
    size_t n = peek(r), k = n <= NUMBER_LEN_MAX ? n : 0;
    memcpy(text, r->at, k);
    text[k] = '\0';
    if (strlen(text) == n && parse_real(text, range->min, range->max, v)) {
        r->at += n;
        return true;
    }
    snprintf(expected, sizeof expected, "a number from %.9g to %.9g", range->min, range->max);
    return fail_word(r, word, range->what, expected);
}

static bool take_scale(struct spec_reader *r, const double v[3])
{
    for (int a = 0; a < 3; a++)
        if (!(fabs(v[a]) >= SCALE_MIN && fabs(v[a]) <= SCALE_MAX))
            return spec_fail(r, "scale: %c is %g, expected %g to %g, or the same below 0", "xyz"[a],
                v[a], SCALE_MIN, SCALE_MAX);
    spec_copy(r->s->scale, v);
    return true;
}

static bool take_resolution(struct spec_reader *r, const double v[2])
{
    if (v[0] != floor(v[0]) || v[1] != floor(v[1]))
        return spec_fail(r, "resolution: %g %g, expected whole pixels", v[0], v[1]);
    r->s->w = (uint32_t)v[0];
    r->s->h = (uint32_t)v[1];
    return true;
}

/* place: of a colour in the palette, or -1; of a slice: its axis. */
static bool take_line(struct spec_reader *r, enum word word, const double *v, double place)
{
    struct spec *s = r->s;
    switch (word) {
    case FROM: spec_copy(s->from, v); break;
    case AT: spec_copy(s->at, v); break;
    case UP: spec_copy(s->up, v); break;
    case ANGLE: s->angle = v[0]; break;
    case RESOLUTION: return take_resolution(r, v);
    case LIGHT:
        s->lit = true;
        spec_copy(s->light, v);
        break;
    case ATTENUATION: s->attenuation = v[0]; break;
    case SCALE: return take_scale(r, v);
    case LIMIT: s->opacity_limit = v[0]; break;
    case BACKGROUND:
        s->backed = true;
        spec_copy(s->background, v);
        break;
    case PALETTE: break; /* read_palette */
    case CLIP: return spec_take_clip(r, v);
    case MAP: return spec_add_knot(r, SPEC_MAP, v, place);
    case ISO: return spec_add_iso(r, v);
    case SLICE: return spec_add_slice(r, (int)place, v);
    case TINT: return spec_add_knot(r, SPEC_COLOURS, v, place);
    case GROUND: return spec_add_knot(r, SPEC_GROUND, v, place);
    case FLAT:
        s->flat = true;
        s->flat_at = v[0], s->flat_opacity = v[1];
        break;
    case PROFILE: return spec_add_level(r, v);
    }
    return true;
}

/* ---- lines --------------------------------------------------------------------------------- */

static size_t count_words(struct spec_reader *r)
{
    const char *begin = r->at;
    size_t count = 0;
    for (size_t n; (n = peek(r)) > 0; r->at += n) count++;
    r->at = begin;
    return count;
}

static bool read_palette(struct spec_reader *r)
{
    size_t n = peek(r);
    if (!spec_palette(r->at, n, r->palette)) return fail_word(r, "palette", "name", SPEC_PALETTES);
    r->at += n;
    return true;
}

static bool read_axis(struct spec_reader *r, double *axis)
{
    if (peek(r) != 1 || *r->at < 'x' || *r->at > 'z')
        return fail_word(r, "slice", "axis", "x, y or z");
    *axis = *r->at++ - 'x';
    return true;
}

/* The numbers of a line whose colour is a place in the palette: one number of colour, not three.
 * NULL if this line is none. */
static const struct range *range_by_place(struct spec_reader *r, enum word w)
{
    const size_t n = count_words(r);
    switch (w) {
    case MAP: return n == 3 ? map_by_place : NULL;
    case ISO: return n == 3 ? iso_by_place : NULL;
    case TINT: return n == 2 ? tint_by_place : NULL;
    case GROUND: return n == 2 ? ground_by_place : NULL;
    default: return NULL;
    }
}

/* Reads the numbers of a word and takes them. */
static bool read_numbers(struct spec_reader *r, enum word w)
{
    double v[NUMBERS_MAX] = {0}, place = -1;
    const char *name = words[w].name;
    if (w == SLICE && !read_axis(r, &place)) return false;
    const struct range *placed = range_by_place(r, w), *range = placed ? placed : words[w].number;
    if (placed && !(r->seen >> PALETTE & 1)) {
        const int n = w == MAP || w == ISO ? 3 : 2;
        return spec_fail(r,
            "%s: %d numbers and no palette, expected a palette line above, or %d numbers", name, n,
            n + 2);
    }
    for (int i = 0; i < NUMBERS_MAX && range[i].what; i++)
        if (!read_number(r, name, &range[i], &v[i])) return false;
    if (placed) {
        v[4] = v[2];
        place = v[1];
        spec_palette_at((const double(*)[3])r->palette, place, v + 1);
    }
    return take_line(r, w, v, place);
}

static bool read_line(struct spec_reader *r)
{
    size_t n = peek(r), w = 0;
    if (!n) return true;
    while (w < WORDS && (strlen(words[w].name) != n || memcmp(words[w].name, r->at, n) != 0)) w++;
    if (w == WORDS)
        return fail_word(r, "line", "first word",
            "from, at, up, angle, resolution, light, attenuation, scale, limit, background, "
            "palette, clip, map, iso, slice, colour, ground, flat or profile");
    const char *name = words[w].name;
    if (r->seen >> w & 1 && !words[w].many)
        return spec_fail(r, "%s: twice, expected it once", name);
    r->seen |= 1U << w;
    r->at += n;
    if (w == LIGHT && peek(r) == 3 && memcmp(r->at, "off", 3) == 0) r->at += 3;
    else if (w == PALETTE ? !read_palette(r) : !read_numbers(r, (enum word)w)) return false;
    return !peek(r) || fail_word(r, name, "next word", "the line's end");
}

static struct vec3 vec(const double v[3]) { return v3(v[0], v[1], v[2]); }

static bool check_view(struct spec_reader *r)
{
    for (size_t w = 0; w < WORDS; w++)
        if (NEEDED >> w & 1 && !(r->seen >> w & 1))
            return spec_fail(
                r, "no '%s', expected from, at, up, angle and resolution", words[w].name);
    struct vec3 dir = v3_sub(vec(r->s->at), vec(r->s->from)), up = vec(r->s->up);
    if (v3_len(dir) < LENGTH_MIN) return spec_fail(r, "from and at are one point, expected two");
    if (v3_len(up) < LENGTH_MIN) return spec_fail(r, "up is zero, expected a direction");
    if (v3_len(v3_cross(v3_unit(dir), v3_unit(up))) < UP_SINE_MIN)
        return spec_fail(r, "up is along the viewing direction, expected another");
    return true;
}

/* Lines end in LF, CR LF or CR. */
static bool read_lines(struct spec_reader *r, const char *text, const char *end)
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
    return check_view(r) && spec_check_field(r);
}

int spec_read(const char *name, const char *text, size_t n, struct spec *s, char err[ERR_BYTES])
{
    struct spec_reader r = {.name = name, .err = err, .s = s};
    *s = (struct spec){.scale = {1, 1, 1}, .opacity_limit = SPEC_LIMIT};
    err[0] = '\0';
    if (read_lines(&r, text, text + n)) return 0;
    for (int i = 0; i < SPEC_LISTS; i++) free(r.list[i].knot);
    s->knot = s->colour = s->ground = NULL;
    spec_free(s);
    return -1;
}

void spec_free(struct spec *s)
{
    free(s->knot);
    free(s->iso);
    free(s->slice);
    free(s->colour);
    free(s->ground);
    free(s->profile);
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
