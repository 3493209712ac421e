/* fragstat: the work of each slot over time, and the balance of the work, from a log of
 * fragments. */
#include "base/base.h"
#include "history/history.h"
#include "hosts/hosts.h"
#include "stats/stats.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct options {
    enum what { SLOTS, SUMMARY, GANTT } what; /* -s, -g */
    const char *costs;                        /* -c: the log of a run by one worker */
    const char *hosts;                        /* -S */
    double *powers;                           /* -w */
    size_t n_powers;
    char **inputs; /* NULL-ended; none: standard input */
};

/* A row of the table: a slot that did something, or that a hello counts. */
struct row {
    char name[HISTORY_NAME];
    double power;
    struct times times;
    double cpu_s;
    int64_t tasks, duplicates, retries, steals;
};

/* The analysis of a log. */
struct report {
    struct history log;
    struct row *rows;
    size_t n_rows;
    uint32_t *row_of;   /* row of a slot of the log */
    struct span *spans; /* span of a done */
    double *run_s, makespan_s, bound_s;
    int64_t tasks; /* different ones */
};

/* ---- reading ---------------------------------------------------------------------------- */

static void read_log(struct history *l, const char *path)
{
    bool std = strcmp(path, "-") == 0;
    uint64_t bad = l->bad;
    int fd = std ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) die(ST_USAGE, "%s:", path);
    if (std) path = "standard input";
    if (history_read(l, fd) != 0) die(errno == EISDIR ? ST_USAGE : ST_SYSTEM, "%s:", path);
    if (l->refused) die(ST_USAGE, "%s: %s", path, l->why);
    if (l->bad > bad)
        warn("%s: damaged in %" PRIu64 " place%s, skipped there; the last: %s", path, l->bad - bad,
            l->bad - bad == 1 ? "" : "s", l->why);
    if (!std) close(fd);
}

/* ---- slots ------------------------------------------------------------------------------ */

static void add_row(struct report *r, const char *name)
{
    r->rows = xrealloc(r->rows, r->n_rows + 1, sizeof *r->rows);
    struct row *row = &r->rows[r->n_rows++];
    *row = (struct row){.power = 1};
    snprintf(row->name, sizeof row->name, "%s", name);
}

static int by_name(const void *a, const void *b)
{
    return strverscmp(((const struct row *)a)->name, ((const struct row *)b)->name);
}

/* The number before the first point of a slot's name, or -1. */
static int64_t outermost(const char *name)
{
    char text[HISTORY_NAME];
    int64_t k;
    snprintf(text, sizeof text, "%s", name);
    text[strcspn(text, ".")] = '\0';
    return parse_int(text, 0, HISTORY_SLOTS_MAX - 1, &k) ? k : -1;
}

/* Slots counted in a hello but without any record were idle. */
static void add_idle(struct report *r)
{
    int32_t claimed = 0;
    for (size_t i = 0; i < r->log.n_runs; i++)
        if (r->log.runs[i].slots > claimed) claimed = r->log.runs[i].slots;
    bool *known = xcalloc((size_t)claimed + 1, sizeof *known);
    for (size_t i = 0; i < r->log.n_slots; i++) {
        int64_t k = outermost(r->log.slots[i].name);
        if (k >= 0 && k < claimed) known[k] = true;
    }
    if (claimed == 1) known[0] = true; /* a lone worker */
    for (int32_t k = 0; k < claimed; k++) {
        char name[HISTORY_NAME];
        snprintf(name, sizeof name, "%" PRId32, k);
        if (!known[k]) add_row(r, name);
    }
    free(known);
}

static void make_rows(struct report *r)
{
    for (size_t i = 0; i < r->log.n_slots; i++) add_row(r, r->log.slots[i].name);
    add_idle(r);
    qsort(r->rows, r->n_rows, sizeof *r->rows, by_name);
    r->row_of = xcalloc(r->log.n_slots, sizeof *r->row_of);
    for (size_t i = 0; i < r->log.n_slots; i++) {
        struct row key = {0};
        memcpy(key.name, r->log.slots[i].name, sizeof key.name);
        const struct row *row = bsearch(&key, r->rows, r->n_rows, sizeof key, by_name);
        r->row_of[i] = (uint32_t)(row - r->rows);
    }
}

/* -S: the power of each slot of the outermost fan, by number. */
static void powers_of_hosts(struct report *r, const char *arg)
{
    struct hosts h;
    char err[HOSTS_ERR];
    if (!hosts_read(&h, arg, err)) die(ST_USAGE, "%s", err);
    double *power = xmalloc((size_t)h.slots, sizeof *power), *at = power;
    for (size_t i = 0; i < h.n; i++) {
        if (h.at[i].power <= 0)
            die(ST_USAGE, "-S %s: host %s has no power, expected power=P", arg, h.at[i].name);
        for (int k = 0; k < h.at[i].slots; k++) *at++ = h.at[i].power;
    }
    for (size_t i = 0; i < r->n_rows; i++) {
        int64_t k = outermost(r->rows[i].name);
        if (k >= h.slots)
            die(ST_USAGE, "-S %s: %d slots, expected slot %s among them", arg, h.slots,
                r->rows[i].name);
        r->rows[i].power = power[k < 0 ? 0 : k];
    }
    free(power);
    hosts_free(&h);
}

static void set_powers(struct report *r, const struct options *o)
{
    if (o->hosts) powers_of_hosts(r, o->hosts);
    if (!o->powers) return;
    if (o->n_powers != r->n_rows)
        die(ST_USAGE, "-w: %zu powers, expected %zu, one for each slot", o->n_powers, r->n_rows);
    for (size_t k = 0; k < r->n_rows; k++) r->rows[k].power = o->powers[k];
}

/* ---- times and costs -------------------------------------------------------------------- */

/*
 * The time of a slot on a task is the worker's wall time, but at least the CPU time since the
 * previous task. The latter includes reading and writing, which the wall time does not.
 */
static void make_spans(struct report *r)
{
    const struct history *l = &r->log;
    r->spans = xcalloc(l->n_dones, sizeof *r->spans);
    for (size_t i = 0; i < l->n_dones; i++) {
        const struct history_done *d = &l->dones[i];
        struct row *row = &r->rows[r->row_of[d->slot]];
        struct span *s = &r->spans[i];
        s->run = (uint32_t)d->run;
        s->slot = r->row_of[d->slot];
        s->end_s = d->recv_us < 0 ? -1 : (double)d->recv_us * 1e-6;
        s->took_s = (double)(d->wall_us > d->cpu_us ? d->wall_us : d->cpu_us) * 1e-6;
        s->wasted = history_wasted(l, d);
        row->tasks++;
        row->duplicates += s->wasted;
        row->retries += d->try > 1;
        row->steals += d->stolen;
        row->cpu_s += (double)d->cpu_us * 1e-6;
        r->tasks += !s->wasted;
    }
    r->run_s = xcalloc(l->n_runs, sizeof *r->run_s);
    struct times *of = xcalloc(r->n_rows, sizeof *of);
    stats_timeline(r->spans, l->n_dones, of, r->n_rows, r->run_s, l->n_runs);
    for (size_t k = 0; k < r->n_rows; k++) r->rows[k].times = of[k];
    for (size_t i = 0; i < l->n_runs; i++) r->makespan_s += r->run_s[i];
    free(of);
}

/* Costs are measured on the slots of this log, or on one of power 1. */
static double cost_s(const struct report *r, const struct history_done *d)
{
    double power = r->rows ? r->rows[r->row_of[d->slot]].power : 1;
    return (double)d->cpu_us * 1e-6 * power;
}

/*
 * The lower bound (stats.h). Pieces are rows if no row of this log was split, else pixels. So the
 * bound is the same for all methods that never split a row.
 */
static void find_bound(struct report *r, const char *path)
{
    struct report one = {0};
    const struct report *from = r;
    if (path) {
        read_log(&one.log, path);
        char why[HISTORY_ERR];
        if (!history_same(&one.log, &r->log, why)) die(ST_USAGE, "%s: %s", path, why);
        from = &one;
    }
    const struct history *l = &from->log;
    bool split = history_split(&r->log) || history_split(l);
    struct pieces *p = xcalloc(l->n_dones, sizeof *p);
    for (size_t i = 0; i < l->n_dones; i++) {
        const struct history_done *d = &l->dones[i];
        if (history_wasted(l, d)) continue;
        double used = l->n_frags ? (double)d->pixels / (double)d->sent : 1;
        p[i].n = !l->n_frags ? 1 : split ? d->pixels : d->rows;
        p[i].c = p[i].n ? cost_s(from, d) * used / (double)p[i].n : 0;
    }
    double *v = xcalloc(r->n_rows, sizeof *v);
    for (size_t k = 0; k < r->n_rows; k++) v[k] = r->rows[k].power;
    r->bound_s = stats_lower_bound_pieces(p, l->n_dones, v, r->n_rows);
    free(v);
    free(p);
    history_free(&one.log);
}

/* ---- writing ---------------------------------------------------------------------------- */

static double efficiency(const struct report *r)
{
    return r->makespan_s > 0 ? r->bound_s / r->makespan_s : 0;
}

static void print_slots(const struct report *r)
{
    printf(
        "slot\ttasks\tcpu_s\tbusy_s\tstartup_s\twaiting_s\ttail_s\twasted_s\tduplicates\tretries\t"
        "power\tsteals\n");
    for (size_t k = 0; k < r->n_rows; k++) {
        const struct row *s = &r->rows[k];
        const struct times *t = &s->times;
        printf("%s\t%" PRId64 "\t%.6f\t%.6f\t%.6f\t%.6f\t%.6f\t%.6f\t%" PRId64 "\t%" PRId64
               "\t%g\t%" PRId64 "\n",
            s->name, s->tasks, s->cpu_s, t->busy_s, t->startup_s, t->waiting_s, t->tail_s,
            t->wasted_s, s->duplicates, s->retries, s->power, s->steals);
    }
}

static void print_summary(const struct report *r)
{
    struct row all = {0};
    for (size_t k = 0; k < r->n_rows; k++) {
        const struct row *s = &r->rows[k];
        all.cpu_s += s->cpu_s;
        all.duplicates += s->duplicates;
        all.retries += s->retries;
        all.steals += s->steals;
        all.times.busy_s += s->times.busy_s;
        all.times.startup_s += s->times.startup_s;
        all.times.waiting_s += s->times.waiting_s;
        all.times.tail_s += s->times.tail_s;
        all.times.wasted_s += s->times.wasted_s;
    }
    printf("slots\t%zu\ntasks\t%" PRId64 "\nduplicates\t%" PRId64 "\nretries\t%" PRId64
           "\nsteals\t%" PRId64 "\nlost_records\t%" PRIu64 "\nruns\t%zu\n",
        r->n_rows, r->tasks, all.duplicates, all.retries, all.steals, r->log.bad, r->log.n_runs);
    printf("makespan_s\t%.6f\ncpu_s\t%.6f\nbusy_s\t%.6f\nstartup_s\t%.6f\nwaiting_s\t%.6f\n"
           "tail_s\t%.6f\nwasted_s\t%.6f\n",
        r->makespan_s, all.cpu_s, all.times.busy_s, all.times.startup_s, all.times.waiting_s,
        all.times.tail_s, all.times.wasted_s);
    printf("bound_s\t%.6f\nefficiency\t%.4f\n", r->bound_s, efficiency(r));
}

/* The intervals of stormring-tsv(5): a bar per `done`. */
static void print_gantt(const struct report *r, const char *name)
{
    const struct history *l = &r->log;
    const char *kind = l->n_frames && l->frames[0].replayed ? "replayed" : "real";
    /* start of each run: they follow each other */
    double *zero_s = xcalloc(l->n_runs + 1, sizeof *zero_s);
    for (size_t i = 0; i < l->n_runs; i++) zero_s[i + 1] = zero_s[i] + r->run_s[i];
    printf("# x: time\n# y: slot\n# note: efficiency %.3f: at least %.3g s, and it took %.3g s%s\n",
        efficiency(r), r->bound_s, r->makespan_s, l->n_runs > 1 ? ", all runs together" : "");
    printf("# lanes:");
    for (size_t k = 0; k < r->n_rows; k++) printf(" %s", r->rows[k].name);
    printf("\nexperiment\tkind\tmethod\tx\tx_unit\ty\ty_unit\tsample\tseed\tuntil\n");
    for (size_t i = 0; i < l->n_dones; i++) {
        const struct span *s = &r->spans[i];
        const char *what = s->wasted ? "wasted" : l->dones[i].try > 1 ? "task given again" : "task";
        printf("%s\t%s\t%s\t%.6f\ts\t%" PRIu32 "\t1\t%zu\t0\t%.6f\n", name, kind, what,
            zero_s[s->run] + s->begin_s, s->slot, i + 1, zero_s[s->run] + s->end_s);
    }
    free(zero_s);
}

/* The file name for the chart's title, without bytes that would end a field. */
static char *title_of(const struct options *o)
{
    const char *path = *o->inputs ? *o->inputs : "-", *slash = strrchr(path, '/');
    char *name = xstrdup(strcmp(path, "-") == 0 ? "log" : slash && slash[1] ? slash + 1 : path);
    for (char *c = name; *c; c++)
        if ((unsigned char)*c < ' ') *c = '?';
    return name;
}

static void print_report(const struct report *r, const struct options *o)
{
    char *title;
    switch (o->what) {
    case SLOTS: print_slots(r); break;
    case SUMMARY: print_summary(r); break;
    case GANTT:
        title = title_of(o);
        print_gantt(r, title);
        free(title);
        break;
    }
}

static void report_free(struct report *r)
{
    history_free(&r->log);
    free(r->rows);
    free(r->row_of);
    free(r->spans);
    free(r->run_s);
}

static void choose(struct options *o, enum what what)
{
    if (o->what && o->what != what) die(ST_USAGE, "-g and -s: expected one of them");
    o->what = what;
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-h] [-g | -s] [-c ONE.frags] [-S HOSTS | -w POWER,...] [FRAGS ...]";
    struct options o = {0};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+c:ghsS:w:")) != -1) {
        switch (opt) {
        case 'c': o.costs = opt_text(opt, optarg); break;
        case 'g': choose(&o, GANTT); break;
        case 'h': usage(ST_OK, text);
        case 's': choose(&o, SUMMARY); break;
        case 'S': o.hosts = opt_text(opt, optarg); break;
        case 'w': o.powers = opt_reals(opt, optarg, 1e-3, 1e3, &o.n_powers); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (o.hosts && o.powers) die(ST_USAGE, "-S and -w: expected one of them");
    o.inputs = argv + optind;
    return o;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct report r = {0};
    if (!*o.inputs) read_log(&r.log, "-");
    for (char **name = o.inputs; *name; name++) read_log(&r.log, *name);
    if (!r.log.n_dones) die(ST_PARTIAL, "no task was done in this log, expected `done` records");
    make_rows(&r);
    set_powers(&r, &o);
    make_spans(&r);
    find_bound(&r, o.costs);
    print_report(&r, &o);
    report_free(&r);
    free(o.powers);
    close_stdout();
    return ST_OK;
}
