/* fragstat: the work of each slot over time, and the balance of the work, from a log of fragments;
 * and views of a run that goes on. */
#include "account/account.h"
#include "base/base.h"
#include "history/history.h"
#include "hosts/hosts.h"
#include "os/os.h"
#include "view/view.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct options {
    enum what { SLOTS, SUMMARY, GANTT, TRACE, PAGE } what; /* -s, -g, -t, -H */
    bool follow;                                           /* -f */
    double every_s;                                        /* -i */
    const char *page;                                      /* -o; NULL: standard output */
    const char *costs;                                     /* -c: the log of a run by one worker */
    const char *hosts;                                     /* -S */
    double *powers;                                        /* -w */
    size_t n_powers;
    char **inputs; /* NULL-ended; none: standard input */
};

/* What is reported of a log. */
struct report {
    struct history log;
    struct account of;
    double bound_s;
};

/* ---- reading ---------------------------------------------------------------------------- */

static void read_log(struct history *l, const char *path)
{
    uint64_t bad = l->bad;
    int fd = read_open(&path);
    if (history_read(l, fd) != 0) die(errno == EISDIR ? ST_USAGE : ST_SYSTEM, "%s:", path);
    if (l->refused) die(ST_USAGE, "%s: %s", path, l->why);
    if (l->bad > bad)
        warn("%s: %" PRIu64 " damaged place%s skipped; the last: %s", path, l->bad - bad,
            l->bad - bad == 1 ? "" : "s", l->why);
    if (fd != STDIN_FILENO) close(fd);
}

/* -S: the power of each slot of the outermost fan, by number. */
static void powers_of_hosts(struct account *a, const char *arg)
{
    struct hosts h;
    char err[HOSTS_ERR];
    if (!hosts_read(&h, arg, err)) die(ST_USAGE, "%s", err);
    const char *without;
    double *power = hosts_powers(&h, &without);
    if (!power) die(ST_USAGE, "-S %s: host %s has no power, expected power=P", arg, without);
    for (size_t i = 0; i < a->n_slots; i++) {
        int64_t k = account_outermost(a->slots[i].name);
        if (k >= h.slots)
            die(ST_USAGE, "-S %s: %d slots, expected slot %s among them", arg, h.slots,
                a->slots[i].name);
        a->slots[i].power = power[k < 0 ? 0 : k];
    }
    free(power);
    hosts_free(&h);
}

static void set_powers(struct account *a, const struct options *o)
{
    if (o->hosts) powers_of_hosts(a, o->hosts);
    if (!o->powers) return;
    if (o->n_powers != a->n_slots)
        die(ST_USAGE, "-w: %zu powers, expected %zu, one for each slot", o->n_powers, a->n_slots);
    for (size_t k = 0; k < a->n_slots; k++) a->slots[k].power = o->powers[k];
}

/* -c: costs come from that log. */
static void find_bound(struct report *r, const char *path)
{
    struct history one = {0};
    char why[HISTORY_ERR];
    if (path) read_log(&one, path);
    if (path && !history_same(&one, &r->log, why)) die(ST_USAGE, "%s: %s", path, why);
    r->bound_s = account_bound(&r->of, path ? &one : NULL);
    history_free(&one);
}

/* ---- writing ---------------------------------------------------------------------------- */

static void print_slots(const struct account *a)
{
    printf(
        "slot\ttasks\tcpu_s\tbusy_s\tstartup_s\twaiting_s\ttail_s\twasted_s\tduplicates\tretries\t"
        "power\tsteals\n");
    for (const struct account_slot *s = a->slots; s < a->slots + a->n_slots; s++) {
        const struct times *t = &s->times;
        printf("%s\t%" PRId64 "\t%.6f\t%.6f\t%.6f\t%.6f\t%.6f\t%.6f\t%" PRId64 "\t%" PRId64
               "\t%g\t%" PRId64 "\n",
            s->name, s->tasks, s->cpu_s, t->busy_s, t->startup_s, t->waiting_s, t->tail_s,
            t->wasted_s, s->duplicates, s->retries, s->power, s->steals);
    }
}

static void print_summary(const struct report *r)
{
    const struct account *a = &r->of;
    const struct account_slot all = account_total(a);
    const struct times *t = &all.times;
    printf("slots\t%zu\ntasks\t%" PRId64 "\nduplicates\t%" PRId64 "\nretries\t%" PRId64
           "\nsteals\t%" PRId64 "\nlost_records\t%" PRIu64 "\nruns\t%zu\n",
        a->n_slots, a->tasks, all.duplicates, all.retries, all.steals, r->log.bad, r->log.n_runs);
    printf("makespan_s\t%.6f\ncpu_s\t%.6f\nbusy_s\t%.6f\nstartup_s\t%.6f\nwaiting_s\t%.6f\n"
           "tail_s\t%.6f\nwasted_s\t%.6f\n",
        a->makespan_s, all.cpu_s, t->busy_s, t->startup_s, t->waiting_s, t->tail_s, t->wasted_s);
    printf("bound_s\t%.6f\nefficiency\t%.4f\n", r->bound_s, account_efficiency(a, r->bound_s));
}

/* The file name for the chart's title, without what would end a field, begin a comment, or not
 * be drawn. */
static char *title_of(const struct options *o)
{
    const char *path = *o->inputs ? *o->inputs : "-", *slash = strrchr(path, '/');
    char *name = xstrdup(strcmp(path, "-") == 0 ? "log" : slash && slash[1] ? slash + 1 : path);
    if (*name == '#') *name = '?';
    for (size_t i = 0, left = strlen(name), k; left; i += k, left -= k) {
        k = utf8_shown(name + i, left);
        if (!k) name[i] = '?', k = 1;
    }
    return name;
}

static void print_view(const struct report *r, const struct options *o)
{
    struct buf out = {0};
    char *title = title_of(o);
    if (o->what == GANTT) view_gantt(&r->of, r->bound_s, title, &out);
    else view_trace(&r->of, &out);
    put_stdout_buf(&out);
    free(title);
    buf_free(&out);
}

static void print_report(const struct report *r, const struct options *o)
{
    switch (o->what) {
    case SLOTS: print_slots(&r->of); break;
    case SUMMARY: print_summary(r); break;
    case GANTT:
    case TRACE: print_view(r, o); break;
    case PAGE: break; /* see follow */
    }
}

static void choose(struct options *o, enum what what)
{
    if (o->what && o->what != what) die(ST_USAGE, "-g, -H, -s and -t: expected one of them");
    o->what = what;
}

/* Views are of one file. Powers and costs are for the figures only. */
static void check_view(const struct options *o)
{
    if (o->follow && o->what && o->what != PAGE) die(ST_USAGE, "-f: expected only -H with it");
    if (o->page && o->what != PAGE) die(ST_USAGE, "-o: expected -H with it");
    if (o->follow && o->what == PAGE && !o->page) die(ST_USAGE, "-f and -H: expected -o PAGE.html");
    if (!o->follow && o->what != PAGE) return;
    if (o->costs || o->hosts || o->powers) die(ST_USAGE, "-f and -H: expected none of -c, -S, -w");
    if (!*o->inputs || o->inputs[1] || strcmp(*o->inputs, "-") == 0)
        die(ST_USAGE, "-f and -H: expected one log, which is a file");
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-h] [-g | -s | -t] [-c ONE.frags] [-S HOSTS | -w POWER,...] [FRAGS ...]\n"
        "       fragstat -f [-i SECONDS] LOG\n"
        "       fragstat -H [-f] [-i SECONDS] [-o PAGE.html] LOG";
    struct options o = {.every_s = 1};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+c:fghHi:o:sS:tw:")) != -1) {
        switch (opt) {
        case 'c': o.costs = opt_text(opt, optarg); break;
        case 'f': o.follow = true; break;
        case 'g': choose(&o, GANTT); break;
        case 'h': usage(ST_OK, text);
        case 'H': choose(&o, PAGE); break;
        case 'i': o.every_s = opt_real(opt, optarg, 0.1, 3600); break;
        case 'o': o.page = opt_text(opt, optarg); break;
        case 's': choose(&o, SUMMARY); break;
        case 'S': o.hosts = opt_text(opt, optarg); break;
        case 't': choose(&o, TRACE); break;
        case 'w': o.powers = opt_reals(opt, optarg, 1e-3, 1e3, &o.n_powers); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (o.hosts && o.powers) die(ST_USAGE, "-S and -w: expected one of them");
    o.inputs = argv + optind;
    check_view(&o);
    if (!o.page) return o;
    input_add(*o.inputs, "the log");
    input_keep(o.page);
    return o;
}

/* ---- a run in view ----------------------------------------------------------------------- */

static void put_page(const struct view_log *v, const struct options *o, bool goes_on)
{
    struct buf page = {0}, png = {0};
    struct account a;
    input_add(*o->inputs, "the log"); /* it exists only now, perhaps */
    account_make(&a, &v->log);
    view_picture(v->path, &png);
    view_page(v, &a, &png, view_ended(v) && !goes_on ? 0 : o->every_s, &page);
    if (!o->page) put_stdout_buf(&page);
    else if (outfile_put(o->page, buf_data(&page), buf_size(&page)) != 0)
        die(ST_SYSTEM, "%s:", o->page);
    account_free(&a);
    buf_free(&png);
    buf_free(&page);
}

/* On a terminal the table replaces the one before; elsewhere a blank line follows each. */
static void put_table(const struct view_log *v, bool found)
{
    static const char home[] = "\033[H", line[] = "\033[K\n", rest[] = "\033[J";
    struct buf out = {0};
    bool screen = isatty(STDOUT_FILENO);
    int columns = 0, rows = 0;
    if (screen) os_terminal(STDOUT_FILENO, &columns, &rows);
    if (screen) buf_printf(&out, "%s", home);
    if (found) {
        int lines = rows > 1 ? rows - 1 : 0;
        struct view_state s;
        view_state(v, &s);
        view_table(v, &s, columns, lines, screen ? line : "\n", &out);
        free(s.slots);
    } else {
        char path[4096];
        text_shown(path, sizeof path, v->path);
        buf_printf(&out, "waiting for %s%s", path, screen ? line : "\n");
    }
    buf_printf(&out, "%s", screen ? rest : "\n");
    put_stdout_buf(&out);
    if (fflush(stdout) != 0) die(ST_SYSTEM, "standard output:");
    buf_free(&out);
}

/* A signal, such as that of a resized terminal, ends the wait as well. */
static void nothing(int sig) { (void)sig; }

static int follow(const struct options *o)
{
    static struct view_log v; /* 60 KB, and a stack may be small */
    bool found, over;
    if (o->follow && o->what != PAGE) signal(SIGWINCH, nothing);
    if (o->follow && o->what != PAGE && isatty(STDOUT_FILENO)) printf("\033[2J");
    view_open(&v, *o->inputs);
    do {
        found = view_read(&v);
        /* What a run has written that holds the log no more is read first. */
        bool held = found && view_held(&v);
        if (found && !held) found = view_read(&v);
        if (!found && !o->follow) die(ST_USAGE, "%s: no such file", v.path);
        if (o->what != PAGE) put_table(&v, found);
        else if (found) put_page(&v, o, o->follow && held);
        over = !o->follow || (view_ended(&v) && !held);
        if (!over) poll(NULL, 0, (int)(o->every_s * 1000));
    } while (!over);
    bool whole = view_whole(&v);
    view_close(&v);
    close_stdout();
    return whole || !o->follow ? ST_OK : ST_PARTIAL;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (o.follow || o.what == PAGE) return follow(&o);
    struct report r = {0};
    if (!*o.inputs) read_log(&r.log, "-");
    for (char **name = o.inputs; *name; name++) read_log(&r.log, *name);
    if (!r.log.n_dones) die(ST_PARTIAL, "no task was done in this log, expected `done` records");
    account_make(&r.of, &r.log);
    set_powers(&r.of, &o);
    find_bound(&r, o.costs);
    print_report(&r, &o);
    account_free(&r.of);
    history_free(&r.log);
    free(o.powers);
    close_stdout();
    return ST_OK;
}
