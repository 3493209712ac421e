/* replay: stands in for a worker. It takes the time that a log states, and returns the log's
 * pixels. */
#include "base/base.h"
#include "history/history.h"
#include "os/os.h"
#include "worker/worker.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Limit of the time made up for: a process that was stopped does not race. */
#define OVERSLEPT_MOST_US 10000.0

#define POWER_LEAST 1e-3
#define POWER_MOST 1e3

struct options {
    struct worker_options worker;
    double build_s; /* -b: of each state, at power 1 */
    double power;   /* -p: 1 is the machine of the log */
    double load;    /* -l: mean load by other users, relative to a task's time */
    double scale;   /* -x: of all times */
    uint64_t seed;
    const char *path;
};

struct replay {
    const struct options *o;
    struct history_file file;
    struct history log;
    bool built; /* it has waited as long as the original worker builds its state */
    const struct history_frame *frame;
    struct history_found found; /* the pixels of the task */
    uint64_t pieces;            /* done so far: counter of the random load */
    double used_us;             /* CPU time that the original worker would have used so far */
    double owed_us; /* waiting time still owed; < 0: the system woke this process late */
    int64_t own_us; /* CPU time of this process already counted as part of the wait */
};

static void sleep_us(double us)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    int64_t ns = t.tv_nsec + (int64_t)(us * 1e3);
    t.tv_sec += (time_t)(ns / 1000000000);
    t.tv_nsec = (long)(ns % 1000000000);
    /* The pulse of the worker's loop may interrupt the sleep. */
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL) == EINTR)
        ;
}

/*
 * Takes the time of a task of this cost. The CPU time that this process used for decoding and
 * writing since the last task is part of it, as in a worker. Time that the system overslept then is
 * made up for now.
 */
static void last(struct replay *r, double us)
{
    double e = r->o->load > 0 ? -log1p(-rng_unit(r->o->seed, r->pieces)) : 0; /* mean 1 */
    int64_t own = cpu_us();
    r->pieces++;
    r->used_us += us;
    r->owed_us += us * (1 + r->o->load * e) - (double)(own - r->own_us);
    if (r->owed_us > 0) {
        int64_t begin = now_us();
        sleep_us(r->owed_us);
        r->owed_us -= (double)(now_us() - begin);
    }
    if (r->owed_us < -OVERSLEPT_MOST_US) r->owed_us = -OVERSLEPT_MOST_US;
    r->own_us = own;
}

static void render(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    struct replay *r = ctx;
    char err[HISTORY_ERR];
    if (n0 == 0) {
        if (!history_find(&r->log, r->frame, at, &r->found, err))
            die(ST_USAGE, "%s: %s", r->o->path, err);
        last(r, r->found.cpu_us * r->o->scale / r->o->power);
    }
    history_pixels(&r->log, r->frame, &r->found, n0, n, rgba);
}

/* Before hello: the original worker has no log to read, so no task may wait for that. */
static void load_log(struct replay *r)
{
    const char *path = r->o->path;
    struct history *l = &r->log;
    char err[HISTORY_ERR];
    int failed = history_open(&r->file, path);
    if (failed) die(failed == -1 || errno == EISDIR ? ST_USAGE : ST_SYSTEM, "%s:", path);
    history_read_bytes(l, r->file.bytes, r->file.n);
    if (l->refused) die(ST_USAGE, "%s: %s", path, l->why);
    if (l->bad) warn("%s: %" PRIu64 " damaged places skipped; the last: %s", path, l->bad, l->why);
    if (!history_replayable(l, err)) die(ST_USAGE, "%s: %s", path, err);
}

/* Scenes and other state are for renderers: only the time to build it counts. */
static int take_state(void *ctx, uint32_t generation, enum rec_kind kind,
    unsigned char *body, // NOLINT(readability-non-const-parameter)
    size_t n, char err[WORKER_ERR])
{
    (void)generation, (void)kind, (void)body, (void)n;
    ((struct replay *)ctx)->built = false;
    *err = '\0';
    return 0;
}

static int ready(void *ctx, const struct frame_size *wanted, char err[WORKER_ERR])
{
    struct replay *r = ctx;
    const struct history_frame *f = history_frame_of(&r->log, wanted->frame);
    if (!f || f->w != wanted->w || f->h != wanted->h) {
        snprintf(err, WORKER_ERR, "%s: no frame %u of %ux%u, expected a frame of the log",
            r->o->path, wanted->frame, wanted->w, wanted->h);
        return -1;
    }
    if (!r->built) sleep_us(1e6 * r->o->build_s / r->o->power);
    if (f != r->frame || !r->built) r->own_us = cpu_us();
    r->built = true;
    r->frame = f;
    return 0;
}

static void job(void *ctx, char text[WIRE_JOB])
{
    memcpy(text, ((struct replay *)ctx)->frame->job, WIRE_JOB);
}

static const char *with(void *ctx) { return ((struct replay *)ctx)->frame->with; }

static int64_t used_us(void *ctx) { return llrint(((struct replay *)ctx)->used_us); }

/* The pixel encodes the log's job: slots that replay different jobs are told apart like machines
 * with different arithmetic. */
static void selftest(void *ctx, float *rgba, uint32_t *n)
{
    const struct replay *r = ctx;
    const char *first = r->log.frames[0].job;
    uint64_t hash = hash64(HASH64_INIT, first, strlen(first));
    *n = 1;
    for (int k = 0; k < 4; k++) rgba[k] = (float)(hash >> (16 * k) & 0xffff);
}

static double power(void *ctx) { return ((struct replay *)ctx)->o->power; }

static const struct worker_ops ops = {
    .program = "replay",
    .state = take_state,
    .ready = ready,
    .job = job,
    .with = with,
    .render = render,
    .selftest = selftest,
    .power = power,
    .cpu_us = used_us,
    .replayed = true,
};

/* If all hosts run the same command, the environment of a host can state its speed. */
static double usual_power(void)
{
    const char *s = getenv("REPLAY_POWER");
    double power = 1;
    if (s && !parse_real(s, POWER_LEAST, POWER_MOST, &power))
        die(ST_USAGE, "REPLAY_POWER=%s: expected a number from %g to %g", s, POWER_LEAST,
            POWER_MOST);
    return power;
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-ch] [-b SECONDS] [-f PIXELS] [-l LOAD] [-p POWER] [-s SEED] [-x SCALE]\n"
        "           LOG";
    struct options o = {.power = usual_power(), .scale = 1};
    int opt;
    /* Options may follow the log: methods append theirs to the command line. */
    while ((opt = prog_getopt(argc, argv, "b:hl:p:s:x:" WORKER_OPTIONS)) != -1) {
        switch (opt) {
        case 'b': o.build_s = opt_real(opt, optarg, 0, 86400); break;
        case 'h': usage(ST_OK, text);
        case 'l': o.load = opt_real(opt, optarg, 0, 1e3); break;
        case 'p': o.power = opt_real(opt, optarg, POWER_LEAST, POWER_MOST); break;
        case 's': o.seed = (uint64_t)opt_int(opt, optarg, 0, INT64_MAX); break;
        case 'x': o.scale = opt_real(opt, optarg, 0, 1e6); break;
        default:
            if (!worker_option(&o.worker, opt, optarg)) usage(ST_USAGE, text);
        }
    }
    if (argc - optind != 1) usage(ST_USAGE, text);
    o.path = argv[optind];
    return o;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct replay r = {.o = &o};
    os_sleep_exactly();
    load_log(&r);
    int status = worker_run(&ops, &o.worker, &r);
    history_free(&r.log);
    history_close(&r.file);
    return status;
}
