/* lines: areas and lines are kept in the order of the text. */
#include "backdrop/lines.h"

#include <stdlib.h>
#include <string.h>

#define LINE 256

enum kind { OPEN, LAND_AREA, WATER_AREA, GLOBE };

struct part {
    struct outline o;
    enum kind kind;
    bool seen; /* an area, in the last picture; a line always */
    bool bare; /* an area without its outline, which other parts are */
};
struct backdrop_lines {
    struct part *part; /* grown by xgrown */
    size_t n;
    struct part now;     /* being read */
    bool flat, globe;    /* on a plane; all lines from here on are on the globe */
    struct plane *plane; /* NULL: not known, or not flat */
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

static bool is_area(enum kind kind) { return kind == LAND_AREA || kind == WATER_AREA; }

static void keep(struct backdrop_lines *l, const struct part *p)
{
    l->part = xgrown(l->part, l->n, sizeof *l->part);
    l->part[l->n] = *p;
    outline_bound(&l->part[l->n++].o);
}

static void take_piece(void *lines, struct outline *piece, enum outline_piece kind)
{
    struct backdrop_lines *l = lines;
    keep(l, &(struct part){.o = *piece,
                .kind = kind == OUTLINE_LINE ? OPEN : l->now.kind,
                .seen = true,
                .bare = kind == OUTLINE_AREA});
}

/* Keeps the part that was read; or, from the globe, what is on the plane. */
static void flush(struct backdrop_lines *l)
{
    struct part *p = &l->now;
    if (p->o.n && is_area(p->kind)) outline_add(&p->o, p->o.at[0]);
    if (l->plane && l->globe) {
        outline_spread(l->plane, &p->o, is_area(p->kind), take_piece, l);
        outline_free(&p->o);
    } else if (p->o.n) keep(l, p);
    l->now = (struct part){.o.flat = l->flat && !l->globe, .seen = true};
}

static bool read_line(struct backdrop_lines *l, char *line)
{
    double v[2];
    if (strchr("#>", line[0])) { /* also true for an empty line: strchr finds the terminator */
        flush(l);
        l->now.kind = kind_of(line);
        if (l->now.kind == GLOBE) l->globe = true;
        l->now.o.flat = l->flat && !l->globe;
        return !l->globe || !l->flat || l->plane;
    }
    if (!numbers(line, v)) return false;
    outline_add(&l->now.o, (struct outline_point){v[0], v[1]});
    return true;
}

/* Why there is no plane for lines on the globe: of the grid's title, or "". */
static struct plane *open_plane(const struct backdrop *b, char why[ERR_BYTES])
{
    const struct grid *g = b->grid;
    const bool rotated = b->flat && strcmp(b->flat, BACKDROP_DEGREE) == 0;
    *why = '\0';
    if (!b->proj) return NULL;
    return plane_open(b->proj, rotated ? "degrees" : b->flat,
        (struct plane_at){g->at[0][0], g->at[1][0]},
        (struct plane_at){g->at[0][g->n[0] - 1], g->at[1][g->n[1] - 1]}, why);
}

static void refuse(
    const struct backdrop *b, int line, bool globe, const char *why, char err[BACKDROP_ERR])
{
    if (!globe) err_set(err, "%.128s:%d: expected longitude and latitude", b->lines_name, line);
    else if (*why)
        err_set(err,
            "%.128s:%d: longitudes and latitudes, but the plane in the grid's title cannot be "
            "used: %.300s",
            b->lines_name, line, why);
    else
        err_set(err,
            "%.128s:%d: longitudes and latitudes, which x and y of the grid are not, expected "
            "lines in its coordinates, or none",
            b->lines_name, line);
}

struct backdrop_lines *backdrop_lines_read(const struct backdrop *b, char err[BACKDROP_ERR])
{
    struct backdrop_lines *l = xcalloc(1, sizeof *l);
    char line[LINE], why[ERR_BYTES];
    int number = 1;
    bool good = true;
    l->flat = b->flat;
    l->plane = open_plane(b, why);
    l->now = (struct part){.o.flat = b->flat, .seen = true};
    for (const char *rest = b->lines; rest && good; number++) {
        rest = next_line(rest, line);
        good = read_line(l, line);
    }
    if (good) {
        flush(l);
        return l;
    }
    refuse(b, number - 1, l->globe && l->flat && !l->plane, why, err);
    outline_free(&l->now.o);
    backdrop_lines_free(l);
    return NULL;
}

void backdrop_lines_free(struct backdrop_lines *l)
{
    if (!l) return;
    for (size_t i = 0; i < l->n; i++) outline_free(&l->part[i].o);
    plane_free(l->plane);
    free(l->part);
    free(l);
}

const struct plane *lines_plane(const struct backdrop_lines *l) { return l->plane; }

void lines_fill(const struct drawing *s, struct backdrop_lines *l)
{
    for (struct part *p = l->part; p < l->part + l->n; p++)
        if (is_area(p->kind))
            p->seen = outline_fill(s, &p->o, BACKDROP_AREA, p->kind == WATER_AREA ? SEA : LAND);
}

void lines_stroke(const struct drawing *s, const struct backdrop_lines *l)
{
    for (const struct part *p = l->part; p < l->part + l->n; p++)
        if (p->seen && !p->bare) outline_stroke(s, &p->o);
}
