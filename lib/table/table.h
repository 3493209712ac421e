/*
 * table: a table of measurements (stormring-tsv(5)) in memory: its rows, and the points that they
 * are samples of. The rules of the format are checked here, for every program.
 *
 * Call order: table_load; then table_points, if points are needed; table_free. Rows hold the values
 * of the file: x in x_unit, y in y_unit. A table of intervals has no points. Nothing here exits or
 * prints.
 */
#ifndef STORMRING_TABLE_H
#define STORMRING_TABLE_H

#include "base/base.h"

struct table_row {
    const char *experiment, *kind, *method; /* interned: equal names have equal pointers */
    const char *setting;                    /* in method, after its first '@'; NULL: none */
    double x, y, until;                     /* until: of an interval */
    int64_t sample, seed;
    size_t line;  /* in the file, from 1 */
    bool outlier; /* for the caller: leave this sample out */
};

/* A value with the range around it. */
struct table_range {
    double low, at, high;
};

/* Samples of one experiment, kind and method, with the same setting or, without one, the same x. */
struct table_point {
    size_t from, n;                 /* its rows: n of them, by sample and seed */
    size_t line;                    /* of the first of its rows in the file */
    struct table_range x, y, shown; /* shown: y, or its mean and interval (inference_means) */
    bool front;                     /* on the Pareto front of its experiment */
};

/* A line that begins with '#'. */
struct table_comment {
    size_t line;
    const char *text;
};

struct table {
    struct table_row *rows;
    struct table_point *points;
    struct table_comment *comments;
    const char *x_unit, *y_unit;
    bool intervals;
    size_t n_rows, n_points, n_comments;
    size_t head; /* line of the column names */
    /* private */
    char *name; /* of the file, for messages */
    struct buf file;
    const char **names;
    size_t n_names;
};

/*
 * Reads the table at `path`; "-": standard input. False if it cannot be read or breaks a rule, with
 * "file:line: what, expected what" in err; *t is empty then.
 */
bool table_load(struct table *t, const char *path, char err[ERR_BYTES]);
void table_free(struct table *t);
/* The text of the first comment "# key: text", and its line if that is not NULL; NULL if there is
 * none, or no text. */
const char *table_said(const struct table *t, const char *key, size_t *line);
/* True if every row has values above 0 on these axes: "x", "y", "xy" or "". Else text in err. */
bool table_positive(const struct table *t, const char *axes, char err[ERR_BYTES]);

/*
 * Sorts the rows by experiment, kind, method, then setting or x, then sample and seed, and makes
 * the points in this order. False, with text in err, if a sample occurs twice. Of a table of
 * intervals it finds those that occur twice, and makes no points.
 */
bool table_points(struct table *t, char err[ERR_BYTES]);
/* Copies the y of the n rows at r, without outliers, to y, which has room for n. Returns their
 * number. */
size_t table_samples(const struct table_row *r, size_t n, double *y);
/* Orders by sample and seed: < 0, 0 or > 0. Equal ones of two methods are a pair. */
int table_by_sample(const struct table_row *a, const struct table_row *b);
/* Sets x, y and shown of each point: the median and the range of its samples; those of shown
 * without marked outliers. */
void table_medians(struct table *t);
/* Puts the points, or the rows of a table of intervals, in the order of the file. */
void table_as_read(struct table *t);
/*
 * Sets `front` of each point, from x and shown: no other point of its experiment has both an x and
 * a y that are as small or smaller. Of equal points, the first in the file is on the front.
 */
void table_front(struct table *t);

#endif
