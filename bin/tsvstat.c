/* tsvstat: summarises or compares the samples of a table: one line per point or comparison. */
#include "base/base.h"
#include "inference/inference.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char text[] = "[-hr] [-c LEVEL] [FILE.tsv]\n"
                           "       tsvstat [-hr] [-c LEVEL] -t less|more|same:MARGIN|steadier A B "
                           "[FILE.tsv]";

/* The claim to test about two methods. */
enum relation { NONE, LESS, MORE, SAME, STEADIER };

struct options {
    double level;           /* -c: the confidence of intervals */
    bool drop;              /* -r: exclude outliers */
    enum relation relation; /* -t */
    double margin;          /* SAME: permitted difference, as a fraction of B's mean */
    const char *a, *b;
    const char *path;
};

enum column { EXPERIMENT, KIND, METHOD, X, X_UNIT, Y, Y_UNIT, SAMPLE, SEED, COLUMNS };
static const char *const column_name[COLUMNS] = {
    "experiment", "kind", "method", "x", "x_unit", "y", "y_unit", "sample", "seed"};

struct row {
    const char *experiment, *kind, *method, *at; /* interned: equal names have equal pointers */
    double x, y;
    int64_t sample, seed;
    bool outlier;
};

/* The rows of one point start at `from`. */
struct point {
    size_t from, n;
};

struct table {
    struct buf file; /* rows point into it */
    struct row *rows;
    struct point *points;
    const char **names;
    size_t n, n_points, n_names;
};

/* ---- the command line ------------------------------------------------------------------------ */

static void parse_relation(struct options *o, const char *arg)
{
    static const char *const word[] = {
        [LESS] = "less", [MORE] = "more", [SAME] = "same:", [STEADIER] = "steadier"};
    for (enum relation r = LESS; r <= STEADIER; r++) {
        if (r != SAME && strcmp(arg, word[r]) == 0) o->relation = r;
        if (r == SAME && strncmp(arg, word[r], 5) == 0) {
            o->relation = r;
            o->margin = opt_real('t', arg + 5, 0, 1);
        }
    }
    if (!o->relation) die(ST_USAGE, "-t %s: expected less, more, same:MARGIN or steadier", arg);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.level = .95, .path = "-"};
    for (int c; (c = prog_getopt(argc, argv, "c:hrt:")) != -1;) switch (c) {
        case 'c': o.level = opt_real(c, optarg, .5, .999999); break;
        case 'h': usage(ST_OK, text);
        case 'r': o.drop = true; break;
        case 't': parse_relation(&o, optarg); break;
        default: usage(ST_USAGE, text);
        }
    int methods = o.relation ? 2 : 0;
    if (argc - optind < methods || argc - optind > methods + 1) usage(ST_USAGE, text);
    if (methods) o.a = argv[optind], o.b = argv[optind + 1];
    if (argc - optind > methods) o.path = argv[optind + methods];
    return o;
}

/* ---- reading (stormring-tsv(5)) -------------------------------------------------------------- */

static const char *shown(const struct options *o)
{
    return strcmp(o->path, "-") == 0 ? "standard input" : o->path;
}

/* Interns a name. Linear search suffices for a few dozen names. */
static const char *name_of(struct table *t, const char *s)
{
    for (size_t i = t->n_names; i-- > 0;)
        if (strcmp(t->names[i], s) == 0) return t->names[i];
    if (!(t->n_names & (t->n_names + 1)))
        t->names = xrealloc(t->names, 2 * (t->n_names + 1), sizeof *t->names);
    return t->names[t->n_names++] = s;
}

/* Splits the line at its tabs. Returns the number of fields; keeps COLUMNS of them. */
static size_t cut(char *line, char **field)
{
    size_t n = 0;
    for (char *tab; line; line = tab) {
        tab = strchr(line, '\t');
        if (tab) *tab++ = '\0';
        if (n < COLUMNS) field[n] = line;
        n++;
    }
    return n;
}

static void take(struct table *t, const struct options *o, size_t number, char **f)
{
    struct row r = {.at = strchr(f[METHOD], '@')};
    static const struct {
        enum column column;
        const char *expected;
    } numbers[] = {
        {X, "a number"}, {Y, "a number"}, {SAMPLE, "a whole number"}, {SEED, "a whole number"}};
    bool good[] = {parse_real(f[X], -1e300, 1e300, &r.x), parse_real(f[Y], -1e300, 1e300, &r.y),
        parse_int(f[SAMPLE], 0, INT64_MAX, &r.sample), parse_int(f[SEED], 0, INT64_MAX, &r.seed)};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        if (!good[i])
            die(ST_USAGE, "%s:%zu: %s is \"%s\", expected %s", shown(o), number,
                column_name[numbers[i].column], f[numbers[i].column], numbers[i].expected);
    r.experiment = name_of(t, f[EXPERIMENT]);
    r.kind = name_of(t, f[KIND]);
    r.method = name_of(t, f[METHOD]);
    if (!(t->n & (t->n + 1))) t->rows = xrealloc(t->rows, 2 * (t->n + 1), sizeof *t->rows);
    t->rows[t->n++] = r;
}

static void read_table(struct table *t, const struct options *o)
{
    if (read_file(o->path, &t->file) != 0) die(ST_USAGE, "%s:", shown(o));
    if (memchr(buf_data(&t->file), '\0', buf_size(&t->file)))
        die(ST_USAGE, "%s: a zero byte, expected text", shown(o));
    buf_append(&t->file, "", 1);
    bool headed = false;
    size_t number = 0;
    for (char *line = (char *)t->file.data + t->file.off, *next; line && *line; line = next) {
        char *f[COLUMNS];
        next = strchr(line, '\n');
        if (next) *next++ = '\0';
        number++;
        if (*line == '#') continue;
        size_t n = cut(line, f);
        for (size_t c = 0; c < COLUMNS && n >= COLUMNS && !headed; c++)
            if (strcmp(f[c], column_name[c]) != 0) n = 0;
        if (n != COLUMNS)
            die(ST_USAGE, "%s:%zu: expected the %d columns %s ... %s%s", shown(o), number, COLUMNS,
                *column_name, column_name[SEED],
                headed ? ", separated by tabs" : " by their names");
        if (headed) take(t, o, number, f);
        headed = true;
    }
    if (!t->n) die(ST_USAGE, "%s:%zu: no samples, expected rows", shown(o), number);
}

/* ---- points ---------------------------------------------------------------------------------- */

static int apart(const char *a, const char *b) { return a == b ? 0 : strcmp(a, b); }

/* Orders by setting or, if there is none, by x. */
static int by_point(const struct row *a, const struct row *b)
{
    int d = apart(a->experiment, b->experiment);
    if (!d) d = apart(a->kind, b->kind);
    if (!d) d = apart(a->method, b->method);
    if (!d && !a->at) d = (a->x > b->x) - (a->x < b->x);
    return d;
}

static int by_sample(const struct row *a, const struct row *b)
{
    int d = (a->sample > b->sample) - (a->sample < b->sample);
    return d ? d : (a->seed > b->seed) - (a->seed < b->seed);
}

static int in_order(const void *a, const void *b)
{
    int d = by_point(a, b);
    return d ? d : by_sample(a, b);
}

/* Copies the y of at least one row, without marked outliers. Returns their number. */
static size_t samples(const struct row *r, size_t n, double *y)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (!r[i].outlier) y[kept++] = r[i].y;
    return kept;
}

static void mark_outliers(struct row *r, size_t n)
{
    double low, high, *y = xmalloc(n, sizeof *y);
    inference_fences(y, samples(r, n, y), &low, &high);
    for (size_t i = 0; i < n; i++) r[i].outlier = r[i].y < low || r[i].y > high;
    free(y);
}

static void find_points(struct table *t, const struct options *o)
{
    qsort(t->rows, t->n, sizeof *t->rows, in_order);
    t->points = xmalloc(t->n, sizeof *t->points);
    for (size_t i = 0; i < t->n; i++) {
        if (!i || by_point(&t->rows[i - 1], &t->rows[i]) != 0)
            t->points[t->n_points++] = (struct point){.from = i};
        else if (by_sample(&t->rows[i - 1], &t->rows[i]) == 0)
            die(ST_USAGE, "%s: two rows of %s, %s, %s with sample %lld and seed %lld, expected one",
                shown(o), t->rows[i].experiment, t->rows[i].kind, t->rows[i].method,
                (long long)t->rows[i].sample, (long long)t->rows[i].seed);
        t->points[t->n_points - 1].n++;
    }
    for (size_t i = 0; i < t->n_points && o->drop; i++)
        mark_outliers(&t->rows[t->points[i].from], t->points[i].n);
}

/* ---- summary -------------------------------------------------------------------------------- */

static void summarise(const struct table *t, const struct options *o)
{
    puts("experiment\tkind\tmethod\tx\tsamples\toutliers\tmean\tvariance\tlow\thigh");
    for (size_t i = 0; i < t->n_points; i++) {
        const struct point *p = &t->points[i];
        const struct row *r = &t->rows[p->from];
        double *y = xmalloc(p->n, sizeof *y), x = 0;
        size_t n = samples(r, p->n, y);
        struct interval of = inference_mean(y, n, o->level);
        for (size_t k = 0; k < p->n; k++) x += r[k].x / (double)p->n;
        printf("%s\t%s\t%s\t%.9g\t%zu\t%zu\t%.9g\t%.9g\t%.9g\t%.9g\n", r->experiment, r->kind,
            r->method, x, n, p->n - n, of.estimate, stats_variance(y, n), of.low, of.high);
        free(y);
    }
}

/* ---- comparison ----------------------------------------------------------------------------- */

static const char *verdict(const struct options *o, struct interval of)
{
    switch (o->relation) {
    case LESS:
    case STEADIER: return of.high < 0 ? "holds" : of.low > 0 ? "fails" : "open";
    case MORE: return of.low > 0 ? "holds" : of.high < 0 ? "fails" : "open";
    default:
        if (of.low >= -o->margin && of.high <= o->margin) return "holds";
        return of.low > o->margin || of.high < -o->margin ? "fails" : "open";
    }
}

/* Differences of the samples that both methods have. */
static size_t pair(const struct row *a, size_t n, const struct row *b, size_t m, double *y)
{
    size_t pairs = 0;
    for (size_t i = 0, k = 0; i < n && k < m;) {
        int d = by_sample(&a[i], &b[k]);
        if (d == 0 && !a[i].outlier && !b[k].outlier) y[pairs++] = a[i].y - b[k].y;
        if (d <= 0) i++;
        if (d >= 0) k++;
    }
    return pairs;
}

/* Means are compared by pairs, spreads by all samples. SAME is relative to B's mean. */
static struct interval compared(const struct options *o, const struct row *a, size_t n,
    const struct row *b, size_t m, size_t *used)
{
    double *x = xmalloc(n + m, sizeof *x), *y = x + n;
    struct interval of;
    if (o->relation == STEADIER) {
        size_t p = samples(a, n, x), q = samples(b, m, y);
        of = inference_spread(x, p, y, q, o->level);
        *used = p < q ? p : q;
    } else {
        *used = pair(a, n, b, m, x);
        of = inference_mean(x, *used, o->level);
    }
    if (o->relation == SAME) {
        /* If the mean is 0, only 0 counts as the same. */
        double whole = fmax(fabs(stats_mean(y, samples(b, m, y))), DBL_MIN);
        of = (struct interval){of.estimate / whole, of.low / whole, of.high / whole};
    }
    free(x);
    return of;
}

/* The point of B with the same experiment, kind and x as a; NULL if there is none. */
static const struct point *beside(const struct table *t, const struct row *a, const char *b)
{
    for (size_t i = 0; i < t->n_points; i++) {
        const struct row *r = &t->rows[t->points[i].from];
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
    for (size_t i = 0; i < t->n_points; i++) {
        const struct point *p = &t->points[i];
        const struct row *a = &t->rows[p->from];
        const struct point *q = strcmp(a->method, o->a) == 0 ? beside(t, a, o->b) : NULL;
        size_t n;
        if (!q) continue;
        struct interval of = compared(o, a, p->n, &t->rows[q->from], q->n, &n);
        const char *word = n > 1 ? verdict(o, of) : "open";
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

int main(int argc, char **argv)
{
    struct table t = {0};
    int status = ST_OK;
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    read_table(&t, &o);
    find_points(&t, &o);
    if (o.relation) status = compare(&t, &o);
    else summarise(&t, &o);
    free(t.rows);
    free(t.points);
    free(t.names);
    buf_free(&t.file);
    close_stdout();
    return status;
}
