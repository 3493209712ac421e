/* lines: areas and lines are kept in the order of the text. */
#include "backdrop/lines.h"

#include <stdlib.h>
#include <string.h>

#define LINE 256

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

#define NAME_MAX_BYTES 100

/* Keeps a name. Returns NULL, or what was expected. */
static const char *take_text(struct backdrop_lines *l, const char *s, bool required)
{
    static const char expected[] =
        "expected a name of 1 to 100 bytes without control characters, in UTF-8";
    size_t n = strlen(s), k;
    if (n > NAME_MAX_BYTES || (required && !n)) return expected;
    for (size_t i = 0; i < n; i += k)
        if (!(k = utf8_shown(s + i, n - i))) return expected;
    l->now.text = buf_size(&l->text);
    buf_append(&l->text, s, n);
    buf_append(&l->text, "", 1);
    return NULL;
}

/* Returns NULL, or what was expected. */
static const char *take_height(struct backdrop_lines *l, const char *s)
{
    double z;
    if (!parse_real(s, -GRID_MAX, GRID_MAX, &z)) return l->no_height;
    z = grid_within(z, l->z[0], l->z[1]);
    if (!(z >= l->z[0] && z <= l->z[1])) return l->no_height;
    for (l->level = 1; l->level <= l->n_heights && l->height[l->level - 1] != z;) l->level++;
    if (l->level > LINES_HEIGHTS) return "expected at most 100 heights";
    if (l->level > l->n_heights) l->height[l->n_heights++] = z;
    return NULL;
}

/* Parses "> land", "> water", "> globe", "> plane", "> height Z", "> line TEXT" or "> mark NAME";
 * any other header is that of a line. Returns NULL, or what was expected. */
static const char *take_head(struct backdrop_lines *l, char *line)
{
    static const char *const words[] = {[LINES_LAND] = "land",
        [LINES_WATER] = "water",
        [LINES_GLOBE] = "globe",
        [LINES_PLANE] = "plane",
        [LINES_HEIGHT] = "height",
        [LINES_TEXT] = "line",
        [LINES_MARK] = "mark"};
    char *rest = line, *sign = strtok_r(rest, " \t\r", &rest);
    char *word = strtok_r(NULL, " \t\r", &rest);
    if (!sign || !word || strcmp(sign, ">") != 0) return NULL;
    int kind = LINES_MARK;
    while (kind > LINES_OPEN && strcmp(word, words[kind]) != 0) kind--;
    rest += strspn(rest, " \t\r");
    for (size_t n = strlen(rest); n && strchr(" \t\r", rest[n - 1]);) rest[--n] = '\0';
    if (kind < LINES_HEIGHT && *rest) return NULL;
    l->now.kind = (enum lines_kind)kind;
    if (kind == LINES_GLOBE || kind == LINES_PLANE) {
        l->globe = kind == LINES_GLOBE;
        l->level = 0;
    }
    return kind < LINES_HEIGHT    ? NULL
           : kind == LINES_HEIGHT ? take_height(l, rest)
                                  : take_text(l, rest, kind == LINES_MARK);
}

static bool is_area(enum lines_kind kind) { return kind == LINES_LAND || kind == LINES_WATER; }

static void keep(struct backdrop_lines *l, const struct lines_part *p)
{
    l->part = xgrown(l->part, l->n, sizeof *l->part);
    l->part[l->n] = *p;
    outline_bound(&l->part[l->n++].o);
}

static void take_piece(void *lines, struct outline *piece, enum outline_piece kind)
{
    struct backdrop_lines *l = lines;
    const bool side = kind == OUTLINE_LINE && is_area(l->now.kind);
    keep(l, &(struct lines_part){.o = *piece,
                .kind = side ? LINES_OPEN : l->now.kind,
                .text = l->now.text,
                .seen = true,
                .level = l->now.level,
                .bare = kind == OUTLINE_AREA});
}

/* Puts places from the globe on the plane, where they are on it. */
static void spread_places(struct backdrop_lines *l, const struct outline *o)
{
    struct lines_part p = l->now;
    p.o = (struct outline){.flat = true};
    struct plane_at at;
    for (size_t i = 0; i < o->n; i++)
        if (plane_forward(l->plane, (struct plane_at){o->at[i].x, o->at[i].y}, &at))
            outline_add(&p.o, (struct outline_point){at.x, at.y});
    if (p.o.n) keep(l, &p);
}

/* Keeps the part that was read; or, from the globe, what is on the plane. */
static void flush(struct backdrop_lines *l)
{
    struct lines_part *p = &l->now;
    if (p->o.n && is_area(p->kind)) outline_add(&p->o, p->o.at[0]);
    if (l->plane && l->globe) {
        if (p->kind == LINES_MARK) spread_places(l, &p->o);
        else outline_spread(l->plane, &p->o, is_area(p->kind), take_piece, l);
        outline_free(&p->o);
    } else if (p->o.n) keep(l, p);
}

/* Returns NULL, or what was expected. */
static const char *read_line(struct backdrop_lines *l, char *line)
{
    double v[2];
    if (strchr("#>", line[0])) { /* also true for an empty line: strchr finds the terminator */
        flush(l);
        l->now = (struct lines_part){.seen = true};
        const char *fault = take_head(l, line);
        if (fault) return fault;
        if (l->now.kind == LINES_PLANE && !l->flat)
            return "coordinates of a plane, expected longitudes and latitudes, as the grid has";
        l->now.o.flat = l->flat && !l->globe;
        l->now.level = l->level;
        return l->globe && l->flat && !l->plane ? l->no_plane : NULL;
    }
    if (!numbers(line, v)) return "expected longitude and latitude";
    outline_add(&l->now.o, (struct outline_point){v[0], v[1]});
    return NULL;
}

/* Opens the plane of the grid's title; else no_plane says what is wrong with lines on the globe. */
static void open_plane(const struct backdrop *b, struct backdrop_lines *l)
{
    const struct grid *g = b->grid;
    const bool rotated = b->flat && strcmp(b->flat, BACKDROP_DEGREE) == 0;
    char why[ERR_BYTES];
    err_set(l->no_plane, "longitudes and latitudes, which x and y of the grid are not, expected "
                         "lines in its coordinates, or none");
    if (!b->proj) return;
    l->plane = plane_open(b->proj, rotated ? "degrees" : b->flat,
        (struct plane_at){g->at[0][0], g->at[1][0]},
        (struct plane_at){g->at[0][g->n[0] - 1], g->at[1][g->n[1] - 1]}, why);
    if (!l->plane)
        err_set(l->no_plane,
            "longitudes and latitudes, but the plane in the grid's title cannot be used: %.160s",
            why);
}

struct backdrop_lines *backdrop_lines_read(const struct backdrop *b, char err[BACKDROP_ERR])
{
    struct backdrop_lines *l = xcalloc(1, sizeof *l);
    char line[LINE];
    int number = 1;
    const char *fault = NULL;
    l->flat = b->flat;
    open_plane(b, l);
    l->z[0] = b->grid->at[2][0];
    l->z[1] = b->grid->at[2][b->grid->n[2] - 1];
    err_set(l->no_height, "expected a height of the grid, from %g to %g", l->z[0], l->z[1]);
    l->now = (struct lines_part){.o.flat = b->flat, .seen = true};
    for (const char *rest = b->lines; rest && !fault; number++) {
        rest = next_line(rest, line);
        fault = read_line(l, line);
    }
    if (!fault) {
        flush(l);
        return l;
    }
    err_set(err, "%.128s:%d: %s", b->lines_name, number - 1, fault);
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
    buf_free(&l->text);
    free(l);
}

bool backdrop_lines_raised(const struct backdrop_lines *l) { return l->n_heights > 0; }

const struct plane *lines_plane(const struct backdrop_lines *l) { return l->plane; }

void lines_fill(const struct drawing *s, struct backdrop_lines *l)
{
    for (struct lines_part *p = l->part; p < l->part + l->n; p++)
        if (is_area(p->kind) && p->level == s->level)
            p->seen = outline_fill(s, &p->o, BACKDROP_AREA, p->kind == LINES_WATER ? SEA : LAND);
}

void lines_stroke(const struct drawing *s, const struct backdrop_lines *l)
{
    for (const struct lines_part *p = l->part; p < l->part + l->n; p++)
        if (p->seen && !p->bare && p->kind < LINES_TEXT && p->level == s->level)
            outline_stroke(s, &p->o);
}
