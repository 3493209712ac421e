/* simulate: policies in virtual time, with faults. Tasks, costs and hosts go in, figures come
 * out. */
#include "base/base.h"
#include "history/history.h"
#include "hosts/hosts.h"
#include "sim/sim.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SLOTS_MOST 100000
#define START_MOST_S 86400.
#define SPREAD_MOST 1e5

static const char text[] =
    "[-chv] [-b LINK[,HUB]] [-f FAULT,...] [-g HUBS,...] [-H HOPS]\n"
    "           [-j SLOTS[,SPREAD] | -S HOSTS | -w POWER,...] [-l MS] [-L LOADS]\n"
    "           [-m US[,SPREAD] | -t LOG] [-p CONNECT[,STATE[,BUILD[,SPREAD]]]] [-s SEED]\n"
    "           [-u US] [-x SCALE] METHOD\n"
    "       simulate [-v] -n SEEDS [-s SEED] METHOD\n"
    "METHOD: fan, best, adaptive, deal [-e] [-q DEPTH|auto] [-t SECONDS],\n"
    "        ring [-e|-p]";

struct options {
    struct sim_plan plan;
    struct sim_workload load;
    struct sim_method method;
    int64_t seeds;     /* -n; 0: one run of the tasks on standard input */
    const char *log;   /* -t */
    double us, spread; /* -m: cost of a pixel, drawn per task from us / spread up */
    double scale;      /* -x */
    int32_t *groups;   /* -g */
    bool tree;         /* -g or -u */
};

/* ---- the command line ------------------------------------------------------------------------ */

static void parse_pair(int opt, const char *arg, double least, double most, double *a, double *b)
{
    size_t n;
    double *v = opt_reals(opt, arg, least, most, &n);
    if (n > 2) die(ST_USAGE, "-%c %s: expected one number or two", opt, arg);
    *a = v[0];
    if (n > 1) *b = v[1];
    free(v);
}

/* CONNECT[,STATE[,BUILD[,SPREAD]]] */
static void parse_start(struct sim_start *s, const char *arg)
{
    s->spread = 1;
    double *const to[] = {&s->connect_s, &s->state_bytes, &s->build_s, &s->spread};
    size_t n;
    double *v = opt_reals('p', arg, 0, 1e12, &n);
    if (n > 4 || v[0] > START_MOST_S || (n > 2 && v[2] > START_MOST_S) ||
        (n > 3 && (v[3] < 1 || v[3] > SPREAD_MOST)))
        die(ST_USAGE, "-p %s: expected SECONDS[,BYTES[,SECONDS[,SPREAD]]], at most %g s and %g",
            arg, START_MOST_S, SPREAD_MOST);
    for (size_t i = 0; i < n; i++) *to[i] = v[i];
    free(v);
}

/* SLOTS[,SPREAD] */
static void draw_powers(struct options *o, const char *arg)
{
    double slots, spread = 1;
    parse_pair('j', arg, 1, SLOTS_MOST, &slots, &spread);
    if (slots != floor(slots)) die(ST_USAGE, "-j %s: expected SLOTS[,SPREAD]", arg);
    o->load.slots = (int32_t)slots;
    o->load.power = sim_draw_powers(o->plan.seed, o->load.slots, spread);
}

/* The links of hosts whose lines state them; the others have those of -l and -b. */
static void take_links(struct options *o, const struct hosts *h)
{
    struct sim_workload *l = &o->load;
    l->links = xcalloc(h->n, sizeof *l->links);
    l->link_of = xcalloc((size_t)h->slots, sizeof *l->link_of);
    l->n_links = (int32_t)h->n;
    for (int32_t i = 0, k = 0; i < l->n_links; i++) {
        const struct host *host = &h->at[i];
        l->links[i] = o->plan.link;
        if (host->latency_ms >= 0) l->links[i].latency_us = llround(host->latency_ms * 1e3);
        if (host->bytes_per_s > 0) l->links[i].bytes_per_s = host->bytes_per_s;
        for (int slot = 0; slot < host->slots; slot++) l->link_of[k++] = i;
    }
}

static void read_hosts(struct options *o, const char *arg)
{
    struct hosts h;
    char err[HOSTS_ERR];
    const char *without;
    if (!hosts_read(&h, arg, err)) die(ST_USAGE, "%s", err);
    o->load.slots = h.slots;
    o->load.power = hosts_powers(&h, &without);
    if (!o->load.power)
        die(ST_USAGE, "-S %s: host %s has no power, expected power=P", arg, without);
    take_links(o, &h);
    hosts_free(&h);
}

/* METHOD and its options, as in the program of that name. */
static void parse_method(struct options *o, int argc, char **argv)
{
    struct sched_params *p = &o->plan.params;
    const struct sim_method *m = sim_method_named(argv[0]);
    if (!m) die(ST_USAGE, "%s: expected fan, best, adaptive, deal or ring", argv[0]);
    o->method = *m;
    *p = m->params;
    int opt;
    optind = 0; /* restart getopt */
    while ((opt = prog_getopt(argc, argv, "+ehpq:t:")) != -1) {
        if (opt == 'h') usage(ST_OK, text);
        if (!strchr(m->options, opt)) usage(ST_USAGE, text);
        if (opt == 'e') p->endgame = true;
        else if (opt == 'q' && strcmp(optarg, "auto") == 0) p->depth = SCHED_DEPTH_AUTO;
        else if (opt == 'q') p->depth = (int32_t)opt_int(opt, optarg, 0, 1000000);
        else if (opt == 't') p->least_us = 1e6 * opt_real(opt, optarg, 0, 86400);
        else o->method.policy = &policy_published;
    }
    if (o->method.policy == &policy_published && p->endgame)
        die(ST_USAGE, "ring -p: expected no -e with it");
    if (optind != argc) usage(ST_USAGE, text);
}

/* -g */
static void parse_groups(struct options *o, const char *arg)
{
    size_t n;
    double *v = opt_reals('g', arg, 1, SLOTS_MOST, &n);
    o->groups = xcalloc(n, sizeof *o->groups);
    for (size_t i = 0; i < n; i++) {
        if (v[i] != floor(v[i])) die(ST_USAGE, "-g %s: expected whole numbers", arg);
        o->groups[i] = (int32_t)v[i];
    }
    free(v);
    o->plan.groups = o->groups;
    o->plan.levels = n;
    o->tree = true;
}

static bool crawls(double bytes_per_s) { return bytes_per_s > 0 && bytes_per_s < 1; }

static void print_event(const char *line) { printf("# %s\n", line); }

static void parse(struct options *o, int argc, char **argv)
{
    struct sim_plan *p = &o->plan;
    const char *slots = NULL, *hosts = NULL, *faults = NULL, *loads = NULL;
    char err[ERR_BYTES];
    int64_t seed = 0;
    bool made = false, more = false;
    size_t n;
    int opt, ways = 0;
    while ((opt = prog_getopt(argc, argv, "+b:cf:g:hH:j:l:L:m:n:p:s:S:t:u:vw:x:")) != -1) {
        more = more || !strchr("nsv", opt);
        switch (opt) {
        case 'b':
            parse_pair(opt, optarg, 0, 1e15, &p->link.bytes_per_s, &p->hub_bytes_per_s);
            if (crawls(p->link.bytes_per_s) || crawls(p->hub_bytes_per_s))
                die(ST_USAGE, "-b %s: expected 0, or a byte per second and more", optarg);
            break;
        case 'c': p->concentrate = true; break;
        case 'f': faults = opt_text(opt, optarg); break;
        case 'g': parse_groups(o, optarg); break;
        case 'h': usage(ST_OK, text);
        case 'H': p->hops = opt_real(opt, optarg, 0, 100); break;
        case 'j': slots = opt_text(opt, optarg), ways++; break;
        case 'l': p->link.latency_us = llround(opt_real(opt, optarg, 0, 1e7) * 1e3); break;
        case 'L': loads = opt_text(opt, optarg); break;
        case 'm':
            made = true;
            parse_pair(opt, optarg, 1e-3, 1e9, &o->us, &o->spread);
            break;
        case 'n': o->seeds = opt_int(opt, optarg, 1, INT32_MAX); break;
        case 'p': parse_start(&p->start, optarg); break;
        case 's': seed = opt_int(opt, optarg, 0, INT64_MAX); break;
        case 'S': hosts = opt_text(opt, optarg), ways++; break;
        case 't': o->log = opt_text(opt, optarg); break;
        case 'u': p->message_us = opt_real(opt, optarg, 0, 1e6), o->tree = true; break;
        case 'v': p->trace = print_event; break;
        case 'w':
            o->load.power = opt_reals(opt, optarg, 1e-3, 1e3, &n);
            o->load.slots = (int32_t)n;
            ways++;
            break;
        case 'x': o->scale = opt_real(opt, optarg, 1e-9, 1e9); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (optind == argc) usage(ST_USAGE, text);
    p->seed = (uint64_t)seed;
    if (o->seeds && (more || optind + 1 != argc))
        die(ST_USAGE, "-n: expected only -s, -v and METHOD with it: the seed sets the rest");
    parse_method(o, argc - optind, argv + optind);
    if (o->seeds) return;
    if (ways > 1 || (o->log && made))
        die(ST_USAGE, "expected one of -j, -S and -w, and one of -m and -t");
    if (p->concentrate && o->method.policy == &sim_fan)
        die(ST_USAGE, "-c: expected deal or ring, which ask for pixels held back");
    bool plain = !faults && !loads && !p->concentrate && !p->trace && p->start.spread <= 0;
    if (o->tree && (o->method.policy != &policy_deal || !plain))
        die(ST_USAGE, "-g and -u: expected deal or adaptive, without -c, -f, -L, -p and -v");
    if (hosts) read_hosts(o, hosts);
    else if (!o->load.power) draw_powers(o, slots ? slots : "1");
    if (faults && !sim_parse_faults(p, faults))
        die(ST_USAGE,
            "-f %s: expected KIND=CHANCE or KIND@WHEN[:SLOT[:POWER]], with commas between", faults);
    if (loads && !sim_read_loads(p, loads, err)) die(ST_USAGE, "-L %s: %s", loads, err);
    if ((p->p_lose > 0 || p->p_double > 0 || p->p_late > 0) &&
        o->method.policy != &policy_published)
        die(ST_USAGE, "-f %s: expected ring -p, whose links lose messages", faults);
}

/* ---- tasks and costs ------------------------------------------------------------------------- */

static void take(void *ctx, const struct record *r)
{
    struct sim_workload *l = ctx;
    char err[ERR_BYTES];
    bool good = true;
    if (r->kind == REC_FRAME) good = sim_workload_frame(l, r->frame_w, r->frame_h, err);
    if (r->kind == REC_TASK) good = sim_workload_task(l, &r->task, err);
    if (!good) die(ST_USAGE, "standard input: %s", err);
}

static void read_tasks(struct sim_workload *l)
{
    char why[WIRE_WHY], err[ERR_BYTES];
    int bad = wire_read(STDIN_FILENO, take, l, why);
    if (bad < 0) die(ST_SYSTEM, "standard input:");
    if (bad) die(ST_USAGE, "standard input: %s", why);
    if (!sim_workload_end(l, err)) die(ST_USAGE, "standard input: %s", err);
}

/* -t */
static void read_costs(struct sim_workload *l, const char *log)
{
    struct history_costs c;
    char err[HISTORY_ERR];
    if (!history_costs_read(log, &c, err)) die(ST_USAGE, "%s: %s", log, err);
    if (!c.us) die(ST_USAGE, "%s: expected the log of a picture", log);
    for (int32_t i = 0; i < l->n; i++)
        history_costs_put(&c, &l->tasks[i].at, l->frame_w, l->frame_h, l->pixel_us);
    history_costs_free(&c);
}

/* ---- a run ----------------------------------------------------------------------------------- */

static void print_out(struct buf *out)
{
    put_stdout_buf(out);
    buf_free(out);
}

/* Prints the command line that repeats a failure. */
static void say_again(int argc, char **argv, const char *why)
{
    struct buf line = {0};
    for (int i = 1; i < argc; i++) {
        buf_append(&line, " ", 1);
        buf_word(&line, argv[i]);
    }
    buf_append(&line, "", 1);
    warn("%s; to repeat, with the same tasks: simulate%s", why, (const char *)buf_data(&line));
    buf_free(&line);
}

static int run_tasks(struct options *o, int argc, char **argv)
{
    struct sim_workload *l = &o->load;
    struct sim_result r;
    struct buf out = {0};
    char err[ERR_BYTES];
    read_tasks(l);
    if (o->log) read_costs(l, o->log);
    else sim_draw_costs(l, o->plan.seed, o->us, o->spread);
    if (!sim_workload_scale(l, o->scale, err)) die(ST_USAGE, "%s", err);
    if (!sim_workload_plan(l, &o->method, &o->plan, err)) die(ST_USAGE, "-f or -L: %s", err);
    if (o->tree) sim_tree_run(o->method.policy, &o->plan, &r);
    else sim_run(o->method.policy, &o->plan, &r);
    sim_report(&o->plan, &r, &out);
    print_out(&out);
    if (*r.failure) say_again(argc, argv, r.failure);
    return *r.failure ? ST_PARTIAL : ST_OK;
}

/* -n: each plan is made up from its seed. */
static int run_seeds(const struct options *o)
{
    const struct sim_method *m = &o->method;
    struct sim_result sum;
    struct buf out = {0};
    if (m->policy == &sim_fan || m->policy == &policy_published)
        die(ST_USAGE, "-n: expected deal or ring, which must lose no task");
    int64_t held = sim_run_seeds(m, o->plan.seed, o->seeds, o->plan.trace, &sum);
    if (*sum.failure) {
        warn("%s; to repeat: simulate -n 1 -s %" PRIu64 " %s", sum.failure,
            o->plan.seed + (uint64_t)held, m->name);
        return ST_PARTIAL;
    }
    buf_printf(&out, "seeds\t%" PRId64 "\ncommits\t%" PRId64 "\n", held, sum.commits);
    sim_report_faults(&sum, &out);
    print_out(&out);
    return ST_OK;
}

int main(int argc, char **argv)
{
    struct options o = {.plan = {.hops = 2}, .us = 1000, .spread = 1, .scale = 1};
    prog_init(argv[0]);
    parse(&o, argc, argv);
    int status = o.seeds ? run_seeds(&o) : run_tasks(&o, argc, argv);
    sim_workload_free(&o.load);
    free(o.plan.faults);
    free(o.plan.loads);
    free(o.groups);
    close_stdout();
    return status;
}
