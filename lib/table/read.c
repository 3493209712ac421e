/* Reading a table and checking its rules: stormring-tsv(5). */
#include "table/table.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum column { EXPERIMENT, KIND, METHOD, X, X_UNIT, Y, Y_UNIT, SAMPLE, SEED, UNTIL, COLUMNS };
static const char *const column_name[COLUMNS] = {
    "experiment", "kind", "method", "x", "x_unit", "y", "y_unit", "sample", "seed", "until"};
#define ALL_COLUMNS "experiment kind method x x_unit y y_unit sample seed"
#define LANES_MAX 10000

struct reader {
    struct table *t;
    size_t line;
    size_t columns; /* 0: no line of names so far */
    char *err;
};

static bool bad(struct reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
static bool bad(struct reader *r, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    err_at(r->err, r->t->name, r->line ? r->line : 1, fmt, ap);
    va_end(ap);
    return false;
}

/* Interns a name. Linear search is fast enough for a few dozen names. */
static const char *name_of(struct table *t, const char *s)
{
    for (size_t i = t->n_names; i-- > 0;)
        if (strcmp(t->names[i], s) == 0) return t->names[i];
    if (!(t->n_names & (t->n_names + 1)))
        t->names = xrealloc(t->names, 2 * (t->n_names + 1), sizeof *t->names);
    return t->names[t->n_names++] = s;
}

/* Splits the line at its tabs. Returns the number of fields; keeps COLUMNS of them, or empty
 * ones. */
static size_t cut(char *line, char *field[COLUMNS])
{
    size_t n = 0;
    for (size_t c = 0; c < COLUMNS; c++) field[c] = line + strlen(line);
    for (char *tab; line; line = tab) {
        tab = strchr(line, '\t');
        if (tab) *tab++ = '\0';
        if (n < COLUMNS) field[n] = line;
        n++;
    }
    return n;
}

static bool take_names(struct reader *r, char **f, size_t n)
{
    for (size_t c = 0; c < UNTIL; c++) {
        const char *is = c < n ? f[c] : "";
        if (strcmp(is, column_name[c]) != 0)
            return bad(r, "column %zu is \"%.40s\", expected \"%s\" of the columns " ALL_COLUMNS,
                c + 1, is, column_name[c]);
    }
    r->t->intervals = n == COLUMNS && strcmp(f[UNTIL], column_name[UNTIL]) == 0;
    r->columns = r->t->intervals ? COLUMNS : UNTIL;
    r->t->head = r->line;
    return n == r->columns || bad(r, "%zu columns, expected the %d columns " ALL_COLUMNS, n, UNTIL);
}

static bool take_numbers(struct reader *r, char **f, struct table_row *row)
{
    int64_t lane;
    if (!parse_real(f[X], -1e300, 1e300, &row->x))
        return bad(r, "x is \"%.40s\", expected a number from -1e300 to 1e300", f[X]);
    if (!parse_real(f[Y], -1e300, 1e300, &row->y))
        return bad(r, "y is \"%.40s\", expected a number from -1e300 to 1e300", f[Y]);
    if (!parse_int(f[SAMPLE], 0, INT64_MAX, &row->sample))
        return bad(r, "sample is \"%.40s\", expected a whole number", f[SAMPLE]);
    if (!parse_int(f[SEED], 0, INT64_MAX, &row->seed))
        return bad(
            r, "seed is \"%.40s\", expected a whole number, 0 if nothing is random", f[SEED]);
    if (!r->t->intervals) return true;
    if (!parse_real(f[UNTIL], row->x, 1e300, &row->until))
        return bad(r, "until is \"%.40s\", expected a number of x or more", f[UNTIL]);
    if (!parse_int(f[Y], 0, LANES_MAX - 1, &lane))
        return bad(r, "y is %.40s, expected the number of a lane, 0 to %d", f[Y], LANES_MAX - 1);
    return true;
}

/* All rows have the same units. */
static bool take_unit(struct reader *r, enum column c, const char *is, const char **unit)
{
    if (!r->t->n_rows) *unit = is;
    return strcmp(is, *unit) == 0 ||
           bad(r, "%s is \"%.40s\", expected \"%.40s\" as in the first row", column_name[c], is,
               *unit);
}

static bool known_kind(const char *s)
{
    return strcmp(s, "real") == 0 || strcmp(s, "replayed") == 0 || strcmp(s, "simulated") == 0;
}

static bool take_row(struct reader *r, char **f, size_t n)
{
    struct table *t = r->t;
    struct table_row row = {.line = r->line};
    if (n != r->columns)
        return bad(r, "%zu fields, expected %zu columns separated by tabs", n, r->columns);
    for (size_t c = 0; c < n; c++)
        if (!*f[c]) return bad(r, "%s is empty, expected a value", column_name[c]);
    if (!known_kind(f[KIND]))
        return bad(r, "kind is \"%.40s\", expected real, replayed or simulated", f[KIND]);
    if (!take_numbers(r, f, &row)) return false;
    if (!take_unit(r, X_UNIT, f[X_UNIT], &t->x_unit)) return false;
    if (!take_unit(r, Y_UNIT, f[Y_UNIT], &t->y_unit)) return false;
    row.experiment = name_of(t, f[EXPERIMENT]);
    row.kind = name_of(t, f[KIND]);
    row.method = name_of(t, f[METHOD]);
    const char *at = t->intervals ? NULL : strchr(row.method, '@');
    row.setting = at && at[1] ? at + 1 : NULL;
    if (!(t->n_rows & (t->n_rows + 1)))
        t->rows = xrealloc(t->rows, 2 * (t->n_rows + 1), sizeof *t->rows);
    t->rows[t->n_rows++] = row;
    return true;
}

static void take_comment(struct reader *r, const char *text)
{
    struct table *t = r->t;
    t->comments = xrealloc(t->comments, t->n_comments + 1, sizeof *t->comments);
    t->comments[t->n_comments++] = (struct table_comment){r->line, text};
}

static bool take_line(struct reader *r, char *line)
{
    char *f[COLUMNS];
    size_t length = strlen(line);
    if (length && line[length - 1] == '\r')
        return bad(r, "the line ends in a carriage return, expected a line feed alone");
    if (*line == '#') {
        take_comment(r, line);
        return true;
    }
    bool blank = !*line;
    size_t n = cut(line, f);
    if (blank) n = 0;
    return r->columns ? take_row(r, f, n) : take_names(r, f, n);
}

static bool take_lines(struct reader *r)
{
    struct buf *b = &r->t->file;
    if (memchr(buf_data(b), '\0', buf_size(b)))
        return err_set(r->err, "%.128s: a zero byte, expected text", r->t->name);
    buf_append(b, "", 1);
    for (char *line = (char *)b->data + b->off, *next; line && *line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = '\0';
        r->line++;
        if (!take_line(r, line)) return false;
    }
    if (!r->columns) return bad(r, "no column line, expected the columns " ALL_COLUMNS);
    return r->t->n_rows || bad(r, "no measurements, expected rows after the column line");
}

bool table_load(struct table *t, const char *path, char err[ERR_BYTES])
{
    bool std = strcmp(path, "-") == 0;
    struct reader r = {.t = t, .err = err};
    *t = (struct table){.name = xstrdup(std ? "standard input" : path)};
    bool good = read_file(path, &t->file) == 0;
    if (!good) err_set(err, "%.128s: %s", t->name, strerror(errno));
    if (good) good = take_lines(&r);
    if (!good) table_free(t);
    return good;
}

void table_free(struct table *t)
{
    free(t->rows);
    free(t->points);
    free(t->comments);
    free(t->names);
    free(t->name);
    buf_free(&t->file);
    *t = (struct table){0};
}

/* The text behind "# key:", or NULL. */
static const char *keyed(const char *comment, const char *key)
{
    size_t n = strlen(key);
    comment += 1 + strspn(comment + 1, " ");
    if (strncmp(comment, key, n) != 0 || comment[n] != ':') return NULL;
    return comment + n + 1 + strspn(comment + n + 1, " ");
}

const char *table_said(const struct table *t, const char *key, size_t *line)
{
    for (size_t i = 0; i < t->n_comments; i++) {
        const char *text = keyed(t->comments[i].text, key);
        if (!text) continue;
        if (line) *line = t->comments[i].line;
        return *text ? text : NULL;
    }
    return NULL;
}

bool table_positive(const struct table *t, const char *axes, char err[ERR_BYTES])
{
    if (*axes && t->intervals)
        return err_set(
            err, "%.100s:%zu: intervals, expected no logarithmic axis with them", t->name, t->head);
    for (size_t i = 0; i < t->n_rows; i++)
        for (const char *axis = axes; *axis; axis++) {
            double v = *axis == 'x' ? t->rows[i].x : t->rows[i].y;
            if (v <= 0)
                return err_set(err,
                    "%.100s:%zu: %c is %g, expected more than 0 on a logarithmic axis", t->name,
                    t->rows[i].line, *axis, v);
        }
    return true;
}
