/* lines: areas are kept in the order of the text. A block ends where the kind of area changes. */
#include "backdrop/lines.h"

#include <stdlib.h>
#include <string.h>

#define LINE 256

enum kind { OPEN, LAND_AREA, WATER_AREA, GLOBE };

struct reader {
    const struct drawing *s;
    struct lines *l;
    struct outline now; /* the line or area being read */
    enum kind kind;     /* its kind */
};

/* Reads the two numbers of a line. False if there are not exactly two. */
static bool numbers(char *line, double v[2])
{
    char *rest = line, *a = strtok_r(rest, " \t\r", &rest), *b = strtok_r(NULL, " \t\r", &rest);
    return a && b && !strtok_r(NULL, " \t\r", &rest) && parse_real(a, -GRID_MAX, GRID_MAX, &v[0]) &&
           parse_real(b, -GRID_MAX, GRID_MAX, &v[1]);
}

/* Copies the next line, cut to LINE bytes: two numbers always fit. Returns the rest, or NULL. */
static const char *next_line(const char *text, char line[LINE])
{
    size_t n = strcspn(text, "\n"), kept = n < LINE - 1 ? n : LINE - 1;
    memcpy(line, text, kept);
    line[kept] = '\0';
    return text[n] ? text + n + 1 : NULL;
}

/* Parses "> land", "> water" or "> globe". */
static enum kind kind_of(char *line)
{
    char *rest = line, *mark = strtok_r(rest, " \t\r", &rest);
    char *word = strtok_r(NULL, " \t\r", &rest);
    if (!mark || !word || strcmp(mark, ">") != 0 || strtok_r(NULL, " \t\r", &rest)) return OPEN;
    static const char *const words[] = {
        [LAND_AREA] = "land", [WATER_AREA] = "water", [GLOBE] = "globe"};
    for (int k = LAND_AREA; k <= GLOBE; k++)
        if (strcmp(word, words[k]) == 0) return (enum kind)k;
    return OPEN;
}

/* The block for an area of this kind. Starts a new block if the last one has the other kind. */
static struct buf *block(struct lines *l, bool is_water)
{
    if (l->n_areas && l->is_water[l->n_areas - 1] == is_water) return &l->areas;
    if (l->n_areas) buf_printf(&l->areas, "EOD\n");
    if (l->n_areas == l->room) {
        l->room = l->room ? 2 * l->room : 8;
        l->is_water = xrealloc(l->is_water, (size_t)l->room, sizeof *l->is_water);
    }
    l->is_water[l->n_areas] = is_water;
    buf_printf(&l->areas, "$area%d << EOD\n", l->n_areas++);
    return &l->areas;
}

static void flush(struct reader *r)
{
    struct buf filled = {0};
    struct outline *o = &r->now;
    bool seen = true;
    if ((r->kind == LAND_AREA || r->kind == WATER_AREA) && o->n) {
        outline_add(o, o->at[0]);
        seen = outline_fill(r->s, o, &filled);
        if (seen)
            buf_append(block(r->l, r->kind == WATER_AREA), buf_data(&filled), buf_size(&filled));
    }
    if (seen) outline_stroke(r->s, o, &r->l->strokes);
    buf_free(&filled);
    o->n = 0;
}

static bool read_line(struct reader *r, char *line)
{
    double v[2];
    if (strchr("#>", line[0])) { /* also true for an empty line: strchr finds the terminator */
        flush(r);
        r->kind = kind_of(line);
        return r->kind != GLOBE || !r->now.flat;
    }
    if (!numbers(line, v)) return false;
    outline_add(&r->now, (struct outline_point){v[0], v[1]});
    return true;
}

bool lines_read(const struct drawing *s, struct lines *l, char err[BACKDROP_ERR])
{
    struct reader r = {.s = s, .l = l, .now.flat = s->b->flat};
    char line[LINE];
    int number = 1;
    bool good = true;
    for (const char *rest = s->b->lines; rest && good; number++) {
        rest = next_line(rest, line);
        good = read_line(&r, line);
    }
    if (good) flush(&r);
    else if (r.kind == GLOBE && r.now.flat)
        err_set(err,
            "%.128s:%d: longitudes and latitudes, which x and y of the grid are not, expected "
            "lines in its coordinates, or none",
            s->b->lines_name, number - 1);
    else err_set(err, "%.128s:%d: expected longitude and latitude", s->b->lines_name, number - 1);
    if (l->n_areas) buf_printf(&l->areas, "EOD\n");
    outline_free(&r.now);
    return good;
}

void lines_free(struct lines *l)
{
    buf_free(&l->strokes);
    buf_free(&l->areas);
    free(l->is_water);
}
