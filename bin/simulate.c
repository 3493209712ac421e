/* simulate: policies in virtual time, with faults. Tasks, costs and hosts go in, figures come
 * out. */
#include "base/base.h"
#include "log/log.h"
#include "hosts/hosts.h"
#include "sim/sim.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SLOTS_MOST 100000
#define DETECT_US 20000000 /* for nodes to detect a dead one, by the rules as published */
#define MOST_US 1e14       /* all tasks on the weakest slot: sums of times must fit int64_t */
#define CHECKED_TASKS 4096 /* limit for a policy's checks: they look at all tasks at each event */

static const char text[] =
    "[-chv] [-b LINK[,HUB]] [-f FAULT,...] [-H HOPS] [-j SLOTS[,SPREAD] | -S HOSTS | -w "
    "POWER,...]\n"
    "           [-l MS] [-m US[,SPREAD] | -t LOG] [-s SEED] [-x SCALE] METHOD\n"
    "       simulate [-v] -n SEEDS [-s SEED] METHOD\n"
    "METHOD: fan, best, adaptive, deal [-e] [-q DEPTH|auto], ring [-p] [-k half|one]";

struct options {
    struct sim_plan plan;
    struct sim_work work;
    const struct policy *policy;
    bool best;         /* METHOD */
    bool adaptive;     /* METHOD: deal with all options of adaptive */
    int64_t seeds;     /* -n; 0: one run of the tasks on standard input */
    const char *log;   /* -t */
    double us, spread; /* -m: cost of a pixel, drawn per task from us / spread up */
    double scale;      /* -x */
    double *power;     /* per slot */
    size_t n_power;
    struct task *tasks;
    double *pixel_us;
};

/* ---- hosts ----------------------------------------------------------------------------------- */

/* A number in [-1, 1), the same for the same seed and index. */
static double drawn(const struct options *o, uint64_t i)
{
    return 2 * rng_unit(o->plan.seed, i) - 1;
}

/* SLOTS[,SPREAD]: powers spread evenly by their logarithm, from 1 / SPREAD to SPREAD. */
static void draw_powers(struct options *o, const char *arg)
{
    size_t n;
    double *v = opt_reals('j', arg, 1, SLOTS_MOST, &n);
    if (n > 2 || v[0] != floor(v[0])) die(ST_USAGE, "-j %s: expected SLOTS[,SPREAD]", arg);
    double spread = n > 1 ? v[1] : 1;
    o->n_power = (size_t)v[0];
    o->power = xmalloc(o->n_power, sizeof *o->power);
    for (size_t k = 0; k < o->n_power; k++) o->power[k] = pow(spread, drawn(o, 2 * k + 1));
    free(v);
}

static void read_hosts(struct options *o, const char *arg)
{
    struct hosts h;
    char err[HOSTS_ERR];
    if (!hosts_read(&h, arg, err)) die(ST_USAGE, "%s", err);
    o->power = xmalloc((size_t)h.slots, sizeof *o->power);
    for (size_t i = 0; i < h.n; i++) {
        if (h.at[i].power <= 0)
            die(ST_USAGE, "-S %s: host %s has no power, expected power=P", arg, h.at[i].name);
        for (int k = 0; k < h.at[i].slots; k++) o->power[o->n_power++] = h.at[i].power;
    }
    hosts_free(&h);
}

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

/* METHOD and its options, as in the program of that name. */
static void parse_method(struct options *o, int argc, char **argv)
{
    static const struct {
        const char *name;
        const struct policy *policy;
    } table[] = {{"fan", &sim_fan}, {"best", &sim_fan}, {"adaptive", &policy_deal},
        {"deal", &policy_deal}, {"ring", &policy_ring}};
    struct sched_params *p = &o->plan.params;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (strcmp(argv[0], table[i].name) == 0) o->policy = table[i].policy;
    if (!o->policy) die(ST_USAGE, "%s: expected fan, best, adaptive, deal or ring", argv[0]);
    o->best = strcmp(argv[0], "best") == 0;
    o->adaptive = strcmp(argv[0], "adaptive") == 0;
    if (o->adaptive) *p = (struct sched_params){.depth = SCHED_DEPTH_AUTO, .endgame = true};
    bool deal = o->policy == &policy_deal && !o->adaptive, ring = o->policy == &policy_ring;
    int opt;
    optind = 0; /* restart getopt */
    while ((opt = prog_getopt(argc, argv, "+ehk:pq:")) != -1) {
        if (opt == 'h') usage(ST_OK, text);
        if (opt == 'e' && deal) p->endgame = true;
        else if (opt == 'q' && deal && strcmp(optarg, "auto") == 0) p->depth = SCHED_DEPTH_AUTO;
        else if (opt == 'q' && deal) p->depth = (int32_t)opt_int(opt, optarg, 0, 1000000);
        else if (opt == 'k' && ring && strcmp(optarg, "one") == 0) p->one = true;
        else if (opt == 'k' && ring && strcmp(optarg, "half") == 0) p->one = false;
        else if (opt == 'p' && ring) o->policy = &policy_published;
        else usage(ST_USAGE, text);
    }
    if (optind != argc) usage(ST_USAGE, text);
    if (ring) o->plan.node = &policy_node;
    if (o->policy == &policy_published) o->plan.detect_us = DETECT_US;
}

static bool crawls(double bytes_per_s) { return bytes_per_s > 0 && bytes_per_s < 1; }

static void print_event(const char *line) { printf("# %s\n", line); }

static void parse(struct options *o, int argc, char **argv)
{
    struct sim_plan *p = &o->plan;
    const char *slots = NULL, *hosts = NULL, *faults = NULL;
    int64_t seed = 0;
    bool made = false, more = false;
    int opt, ways = 0;
    while ((opt = prog_getopt(argc, argv, "+b:cf:hH:j:l:m:n:s:S:t:vw:x:")) != -1) {
        more = more || !strchr("nsv", opt);
        switch (opt) {
        case 'b':
            parse_pair(opt, optarg, 0, 1e15, &p->link_bytes_per_s, &p->hub_bytes_per_s);
            if (crawls(p->link_bytes_per_s) || crawls(p->hub_bytes_per_s))
                die(ST_USAGE, "-b %s: expected 0, or a byte per second and more", optarg);
            break;
        case 'c': p->concentrate = true; break;
        case 'f': faults = opt_text(opt, optarg); break;
        case 'h': usage(ST_OK, text);
        case 'H': p->hops = opt_real(opt, optarg, 0, 100); break;
        case 'j': slots = opt_text(opt, optarg), ways++; break;
        case 'l': p->latency_us = llround(opt_real(opt, optarg, 0, 1e7) * 1e3); break;
        case 'm':
            made = true;
            parse_pair(opt, optarg, 1e-3, 1e9, &o->us, &o->spread);
            break;
        case 'n': o->seeds = opt_int(opt, optarg, 1, INT32_MAX); break;
        case 's': seed = opt_int(opt, optarg, 0, INT64_MAX); break;
        case 'S': hosts = opt_text(opt, optarg), ways++; break;
        case 't': o->log = opt_text(opt, optarg); break;
        case 'v': p->trace = print_event; break;
        case 'w': o->power = opt_reals(opt, optarg, 1e-3, 1e3, &o->n_power), ways++; break;
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
    if (p->concentrate && o->policy == &sim_fan)
        die(ST_USAGE, "-c: expected deal or ring, which ask for pixels held back");
    if (hosts) read_hosts(o, hosts);
    else if (!o->power) draw_powers(o, slots ? slots : "1");
    if (faults && !sim_parse_faults(p, faults))
        die(ST_USAGE,
            "-f %s: expected KIND=CHANCE or KIND@WHEN[:SLOT[:POWER]], with commas between", faults);
    if ((p->p_lose > 0 || p->p_double > 0 || p->p_late > 0) && o->policy != &policy_published)
        die(ST_USAGE, "-f %s: expected ring -p, whose links lose messages", faults);
}

/* ---- tasks and costs ------------------------------------------------------------------------- */

static void take(struct options *o, const struct record *r)
{
    struct sim_work *w = &o->work;
    if (r->kind == REC_FRAME) {
        if (w->frame_w) die(ST_USAGE, "standard input: a second frame, expected one");
        w->frame_w = r->frame_w;
        w->frame_h = r->frame_h;
    }
    if (r->kind != REC_TASK) return;
    if (!lattice_valid(&r->task.at, w->frame_w, w->frame_h))
        die(ST_USAGE, "standard input: task %u, expected one inside the frame", r->task.id);
    int32_t n = o->plan.tasks++;
    if (n == 0 || (n >= 1024 && !(n & (n - 1))))
        o->tasks = xrealloc(o->tasks, n ? 2 * (size_t)n : 1024, sizeof *o->tasks);
    o->tasks[n] = r->task;
    o->tasks[n].frame = 0;
}

/* Renumbers the tasks by their position. */
static void check_ids(const struct options *o)
{
    int32_t n = o->plan.tasks;
    bool *seen = xcalloc((size_t)n + 1, sizeof *seen);
    if (!n) die(ST_USAGE, "standard input: no task, expected those of one frame");
    for (int32_t i = 0; i < n; i++) {
        uint32_t id = o->tasks[i].id;
        if (id >= (uint32_t)n || seen[id])
            die(ST_USAGE, "standard input: task %u of %d, expected each number from 0 on, once", id,
                n);
        seen[id] = true;
    }
    free(seen);
}

static void read_tasks(struct options *o)
{
    struct decoder d = {0};
    struct record r;
    enum wire_result result;
    ptrdiff_t n;
    do {
        n = read_some(STDIN_FILENO, &d.in, 1 << 16);
        if (n < 0) die(ST_SYSTEM, "standard input:");
        if (n == 0) wire_end(&d);
        while ((result = wire_next(&d, &r)) != WIRE_MORE) {
            if (result != WIRE_RECORD) die(ST_USAGE, "standard input: %s", d.why);
            take(o, &r);
        }
    } while (n > 0);
    wire_free(&d);
    check_ids(o);
}

/* The cost of each pixel at power 1: from the log; or the same for all pixels of a task, drawn. */
static double *costs_of(const struct options *o)
{
    const struct sim_work *w = &o->work;
    struct log_costs c = {0};
    char why[LOG_WHY];
    if (o->log && log_costs_read(o->log, &c, why) != 0) die(ST_USAGE, "%s: %s", o->log, why);
    if (o->log && !c.us) die(ST_USAGE, "%s: expected the log of a picture", o->log);
    double *us = xcalloc((size_t)w->frame_w * w->frame_h, sizeof *us);
    for (int32_t i = 0; i < o->plan.tasks; i++) {
        const struct task *t = &o->tasks[i];
        double made_us = o->us * pow(o->spread, drawn(o, 2 * (uint64_t)t->id));
        for (uint64_t k = 0, n = lattice_count(&t->at); k < n; k++) {
            uint64_t p = lattice_pixel(&t->at, w->frame_w, k);
            us[p] = o->scale * (c.us ? log_cost_at(&c, p, w->frame_w, w->frame_h) : made_us);
        }
    }
    log_costs_free(&c);
    return us;
}

static void check_costs(const struct options *o)
{
    double us = 0, least = 1;
    for (uint64_t p = 0, n = (uint64_t)o->work.frame_w * o->work.frame_h; p < n; p++)
        us += o->pixel_us[p];
    for (size_t k = 0; k < o->n_power; k++) least = fmin(least, o->power[k]);
    if (!(us / least <= MOST_US))
        die(ST_USAGE, "tasks of %g s on the weakest slot, expected at most %g s", us / least * 1e-6,
            MOST_US * 1e-6);
}

/* ---- a run ----------------------------------------------------------------------------------- */

static void print(const char *key, double value) { printf("%s\t%.6f\n", key, value); }
static void count(const char *key, int64_t n) { printf("%s\t%" PRId64 "\n", key, n); }

static void print_faults(const struct sim_result *r)
{
    count("crashes", r->crashes);
    count("silences", r->silences);
    count("pauses", r->pauses);
    count("slows", r->slows);
    count("hangs", r->hangs);
    count("kills", r->kills);
    count("returns", r->returns);
    count("twice", r->twice);
    count("garbage", r->garbage);
    count("lost", r->lost);
    count("doubled", r->doubled);
    count("late", r->late);
    count("events", r->events);
    printf("trace\t%016" PRIx64 "\n", r->trace_hash);
}

static void print_result(const struct options *o, const struct sim_result *r)
{
    double bound = sim_bound_s(&o->plan, r), makespan = (double)r->end_us * 1e-6;
    bool there = !r->uncommitted;
    count("slots", o->plan.slots);
    count("tasks", o->plan.tasks);
    count("uncommitted", r->uncommitted);
    count("computed", r->computed);
    print("makespan_s", makespan);
    print("busy_s", r->busy_us * 1e-6);
    print("startup_s", r->startup_us * 1e-6);
    print("waiting_s", r->waiting_us * 1e-6);
    print("tail_s", r->tail_us * 1e-6);
    print("bound_s", bound);
    print("least_s", bound + 3e-6 * (double)o->plan.latency_us);
    printf("efficiency\t%.4f\n", there && makespan > 0 ? bound / makespan : 0);
    count("messages", r->messages);
    count("steals", r->steals);
    count("passed", r->passed);
    count("reports", r->reports);
    printf("messages_per_steal\t%.3f\n", r->steals ? (double)r->messages / (double)r->steals : 0);
    print_faults(r);
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

static int simulate(struct options *o, int argc, char **argv)
{
    struct sim_plan *p = &o->plan;
    struct sim_result r;
    read_tasks(o);
    o->work.pixel_us = o->pixel_us = costs_of(o);
    check_costs(o);
    p->slots = (int32_t)o->n_power;
    p->width = 1;
    p->work = &o->work;
    o->work.tasks = o->tasks;
    o->work.power = o->power;
    for (size_t i = 0; i < p->n_faults; i++)
        if (p->faults[i].slot >= p->slots)
            die(ST_USAGE, "-f: slot %d of %d, expected one from 0 on", p->faults[i].slot, p->slots);
    if (o->best) {
        int32_t *to = xcalloc((size_t)p->tasks, sizeof *to);
        sim_best(&o->work, p->tasks, p->slots, to);
        for (int32_t i = 0; i < p->tasks; i++) o->tasks[i].to = to[i];
        free(to);
    }
    p->faults_us = (int64_t)(1e6 * sim_bound_s(p, &(struct sim_result){0}));
    p->silence_us = 3000000;
    bool checked = p->slots <= SIM_SLOTS_MOST && p->tasks <= CHECKED_TASKS;
    if (checked && o->policy == &policy_deal) p->checks = &sim_checks_deal;
    if (checked && o->policy == &policy_ring) p->checks = &sim_checks_ring;
    if (checked && o->policy == &policy_published) p->checks = &sim_checks_gdc;
    sim_run(o->policy, p, &r);
    print_result(o, &r);
    if (*r.failure) say_again(argc, argv, r.failure);
    return *r.failure ? ST_PARTIAL : ST_OK;
}

/* ---- seeds ----------------------------------------------------------------------------------- */

/* The plan is made up from the seed. */
static int run_seeds(const struct options *o)
{
    struct sim_result sum = {.trace_hash = HASH64_INIT}, r;
    bool ring = o->plan.node;
    if (o->policy == &sim_fan || o->policy == &policy_published)
        die(ST_USAGE, "-n: expected deal or ring, which must lose no task");
    for (int64_t i = 0; i < o->seeds; i++) {
        uint64_t seed = o->plan.seed + (uint64_t)i;
        struct sim_plan plan = ring ? sim_ring_plan_of(seed) : sim_plan_of(seed);
        if (o->adaptive) plan.params = o->plan.params, plan.width = 1;
        plan.trace = o->plan.trace;
        sim_run(o->policy, &plan, &r);
        sim_add(&sum, &r);
        if (!*r.failure) continue;
        warn("%s; to repeat: simulate -n 1 -s %" PRIu64 " %s", r.failure, seed,
            ring          ? "ring"
            : o->adaptive ? "adaptive"
                          : "deal");
        return ST_PARTIAL;
    }
    count("seeds", o->seeds);
    count("commits", sum.commits);
    print_faults(&sum);
    return ST_OK;
}

int main(int argc, char **argv)
{
    struct options o = {.plan = {.hops = 2}, .us = 1000, .spread = 1, .scale = 1};
    prog_init(argv[0]);
    parse(&o, argc, argv);
    int status = o.seeds ? run_seeds(&o) : simulate(&o, argc, argv);
    free(o.tasks);
    free(o.power);
    free(o.pixel_us);
    free(o.plan.faults);
    close_stdout();
    return status;
}
