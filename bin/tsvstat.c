/*
 * tsvstat: summarises or compares the samples of a table, a line for each point or comparison; or
 * prints the points as chart draws them.
 */
#include "base/base.h"
#include "inference/inference.h"
#include "table/table.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LEVEL_LEAST .5
#define LEVEL_MOST .999999

struct options {
    struct claim claim; /* -t, and -c for its level; 0: the default, or as the table says */
    bool drop;          /* -r: exclude outliers */
    bool points;        /* -p */
    const char *axes;   /* -L: logarithmic ones; NULL: as the table says */
    const char *a, *b;  /* methods to compare */
    const char *path;
};

static const char text[] =
    "[-hr] [-c LEVEL] [FILE.tsv]\n"
    "       tsvstat [-r] [-c LEVEL] -t less|more|same:MARGIN|steadier A B [FILE.tsv]\n"
    "       tsvstat [-r] [-c LEVEL] [-L x|y|xy] -p [FILE.tsv]";

static void parse_relation(struct claim *c, const char *arg)
{
    static const char *const word[] = {[INFERENCE_LESS] = "less",
        [INFERENCE_MORE] = "more",
        [INFERENCE_SAME] = "same:",
        [INFERENCE_STEADIER] = "steadier"};
    for (enum relation r = INFERENCE_LESS; r <= INFERENCE_STEADIER; r++) {
        if (r != INFERENCE_SAME && strcmp(arg, word[r]) == 0) c->relation = r;
        if (r == INFERENCE_SAME && strncmp(arg, word[r], 5) == 0) {
            c->relation = r;
            c->margin = opt_real('t', arg + 5, 0, 1);
        }
    }
    if (!c->relation) die(ST_USAGE, "-t %s: expected less, more, same:MARGIN or steadier", arg);
}

static bool are_axes(const char *s)
{
    return strcmp(s, "x") == 0 || strcmp(s, "y") == 0 || strcmp(s, "xy") == 0;
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.path = "-"};
    for (int c; (c = prog_getopt(argc, argv, "c:hL:prt:")) != -1;) switch (c) {
        case 'c': o.claim.level = opt_real(c, optarg, LEVEL_LEAST, LEVEL_MOST); break;
        case 'h': usage(ST_OK, text);
        case 'L': o.axes = optarg; break;
        case 'p': o.points = true; break;
        case 'r': o.drop = true; break;
        case 't': parse_relation(&o.claim, optarg); break;
        default: usage(ST_USAGE, text);
        }
    if (o.axes && !are_axes(o.axes)) die(ST_USAGE, "-L %s: expected x, y or xy", o.axes);
    if (o.points ? o.claim.relation != INFERENCE_NONE : o.axes != NULL) usage(ST_USAGE, text);
    int methods = o.claim.relation ? 2 : 0;
    if (argc - optind < methods || argc - optind > methods + 1) usage(ST_USAGE, text);
    if (methods) o.a = argv[optind], o.b = argv[optind + 1];
    if (argc - optind > methods) o.path = argv[optind + methods];
    return o;
}

static const char *shown(const struct options *o)
{
    return strcmp(o->path, "-") == 0 ? "standard input" : o->path;
}

/* -p: the level, outliers and logarithmic axes that the table states, unless options do. */
static void take_from_table(struct options *o, const struct table *t)
{
    size_t line;
    double *level = &o->claim.level;
    const char *axes = table_said(t, "log", NULL), *outliers = table_said(t, "outliers", NULL);
    const char *said = table_said(t, "level", &line);
    if (!o->axes) o->axes = axes && are_axes(axes) ? axes : "";
    if (outliers && strcmp(outliers, "left out") == 0) o->drop = true;
    if (said && *level <= 0 && !parse_real(said, LEVEL_LEAST, LEVEL_MOST, level))
        die(ST_USAGE, "%s:%zu: level is \"%s\", expected a number from %g to %g", shown(o), line,
            said, LEVEL_LEAST, LEVEL_MOST);
}

static void read_table(struct table *t, struct options *o)
{
    char err[ERR_BYTES];
    if (!table_load(t, o->path, err)) die(ST_USAGE, "%s", err);
    if (t->intervals && !o->points)
        die(ST_USAGE, "%s:%zu: intervals, expected samples", shown(o), t->head);
    if (o->points) take_from_table(o, t);
    else if (o->claim.level <= 0) o->claim.level = .95;
    if (o->points && !table_positive(t, o->axes, err)) die(ST_USAGE, "%s", err);
    if (!table_points(t, err)) die(ST_USAGE, "%s", err);
    if (o->drop) inference_mark_outliers(t);
}

static void summarise(const struct table *t, double level)
{
    puts("experiment\tkind\tmethod\tx\tsamples\toutliers\tmean\tvariance\tlow\thigh");
    for (const struct table_point *p = t->points; p < t->points + t->n_points; p++) {
        const struct table_row *r = &t->rows[p->from];
        double variance, x = 0;
        size_t n;
        struct interval of = inference_point(t, p, level, &n, &variance);
        for (size_t k = 0; k < p->n; k++)
            if (!r[k].outlier) x += r[k].x / (double)n;
        printf("%s\t%s\t%s\t%.9g\t%zu\t%zu\t%.9g\t%.9g\t%.9g\t%.9g\n", r->experiment, r->kind,
            r->method, x, n, p->n - n, of.estimate, variance, of.low, of.high);
    }
}

/* ---- comparison ------------------------------------------------------------------------------ */

/* The point of B with the same experiment, kind and x as a; NULL if there is none. */
static const struct table_point *beside(
    const struct table *t, const struct table_row *a, const char *b)
{
    for (size_t i = 0; i < t->n_points; i++) {
        const struct table_row *r = &t->rows[t->points[i].from];
        if (r->experiment == a->experiment && r->kind == a->kind && r->x == a->x &&
            strcmp(r->method, b) == 0)
            return &t->points[i];
    }
    return NULL;
}

static int compare(const struct table *t, const struct options *o)
{
    size_t cells = 0, hold = 0;
    puts("experiment\tkind\tx\ta\tb\tsamples\tdifference\tlow\thigh\tverdict");
    for (const struct table_point *p = t->points; p < t->points + t->n_points; p++) {
        const struct table_row *a = &t->rows[p->from];
        const struct table_point *q = strcmp(a->method, o->a) == 0 ? beside(t, a, o->b) : NULL;
        size_t n;
        if (!q) continue;
        struct interval of = inference_compare(&o->claim, t, p, q, &n);
        const char *word = inference_verdict(&o->claim, of, n);
        printf("%s\t%s\t%.9g\t%s\t%s\t%zu\t%.9g\t%.9g\t%.9g\t%s\n", a->experiment, a->kind, a->x,
            o->a, o->b, n, of.estimate, of.low, of.high, word);
        cells++;
        hold += strcmp(word, "holds") == 0;
    }
    if (!cells)
        warn("%s: expected experiments with both methods, %s and %s, at the same x", shown(o), o->a,
            o->b);
    return cells && hold == cells ? ST_OK : ST_PARTIAL;
}

/* ---- points for chart ------------------------------------------------------------------------ */

static void print_numbers(const double *v, size_t n)
{
    char shown[32];
    for (size_t i = 0; i < n; i++) {
        print_real(shown, v[i], 6);
        printf("\t%s", shown);
    }
}

static void print_intervals(const struct table *t)
{
    puts("experiment\tkind\tmethod\tx\tx_unit\ty\ty_unit\tsample\tseed\tuntil");
    for (const struct table_row *r = t->rows; r < t->rows + t->n_rows; r++) {
        printf("%s\t%s\t%s", r->experiment, r->kind, r->method);
        print_numbers(&r->x, 1);
        printf("\t%s\t%.0f\t%s\t%" PRId64 "\t%" PRId64, t->x_unit, r->y, t->y_unit, r->sample,
            r->seed);
        print_numbers(&r->until, 1);
        putchar('\n');
    }
}

static void print_points(const struct table *t)
{
    puts("experiment\tkind\tmethod\tx\tx_low\tx_high\tx_unit\ty\ty_low\ty_high\ty_unit\tsamples\t"
         "least\tmost\tfront");
    for (const struct table_point *p = t->points; p < t->points + t->n_points; p++) {
        const struct table_row *r = &t->rows[p->from];
        printf("%s\t%s\t%s", r->experiment, r->kind, r->method);
        print_numbers((double[]){p->x.at, p->x.low, p->x.high}, 3);
        printf("\t%s", t->x_unit);
        print_numbers((double[]){p->shown.at, p->shown.low, p->shown.high}, 3);
        printf("\t%s\t%zu", t->y_unit, p->n);
        print_numbers((double[]){p->y.low, p->y.high}, 2);
        printf("\t%d\n", p->front);
    }
}

/* Comments stay, and those above the column names keep their lines. */
static void print_drawn(struct table *t, double level)
{
    size_t i = 0;
    for (; i < t->n_comments && t->comments[i].line < t->head; i++) puts(t->comments[i].text);
    table_as_read(t);
    if (t->intervals) {
        print_intervals(t);
    } else {
        table_medians(t);
        if (level > 0) inference_means(t, level);
        table_front(t);
        print_points(t);
    }
    for (; i < t->n_comments; i++) puts(t->comments[i].text);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct table t;
    int status = ST_OK;
    read_table(&t, &o);
    if (o.claim.relation) status = compare(&t, &o);
    else if (o.points) print_drawn(&t, o.claim.level);
    else summarise(&t, o.claim.level);
    table_free(&t);
    close_stdout();
    return status;
}
