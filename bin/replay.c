/* replay: stands in for a worker. It takes the time that a log states, and returns the log's
 * pixels. */
#include "base/base.h"
#include "history/history.h"
#include "worker/worker.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Limit of the time made up for: a process that was stopped does not race. */
#define OVERSLEPT_MOST_US 10000.0

#define POWER_LEAST 1e-3
#define POWER_MOST 1e3

struct options {
    struct worker_options worker;
    double power; /* -p: 1 is the machine of the log */
    double load;  /* -l: mean load by other users, relative to a task's time */
    double scale; /* -x: of all times */
    uint64_t seed;
    const char *path;
};

struct replay {
    const struct options *o;
    unsigned char *bytes; /* of the log */
    size_t n_bytes;
    bool loaded;        /* the log was read */
    uint64_t first_job; /* hash of the first job */
    struct history log;
    const struct history_frame *frame;
    const struct history_frag
        *whole;      /* the frag with exactly the requested pixels; NULL: they are spread */
    uint64_t pieces; /* done so far: counter of the random load */
    double used_us;  /* CPU time that the original worker would have used so far */
    double owed_us;  /* waiting time still owed; < 0: the system woke this process late */
    int64_t own_us;  /* CPU time of this process already counted as part of the wait */
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

static _Noreturn void refuse(const struct replay *r, uint64_t p, const char *why)
{
    const struct history_frame *f = r->frame;
    die(ST_USAGE,
        "%s: frame %u: pixel %" PRIu64 ",%" PRIu64 " %s, expected a log that has every "
        "pixel of the tasks",
        r->o->path, f->number, p % f->w, p / f->w, why);
}

/* The cost of pixel p of this frag: its share of its task's time. */
static double pixel_us(const struct replay *r, struct history_frag *frag, uint64_t p)
{
    if (frag->done < 0) refuse(r, p, "has no CPU time");
    if (!history_sound(frag)) refuse(r, p, "is damaged");
    const struct history_done *d = &r->log.dones[frag->done];
    return (double)d->cpu_us / (double)d->sent;
}

/* The cost of these pixels: that of the task if the log has them as one frag, else the sum of
 * their shares. */
static double cost_us(struct replay *r, const struct lattice *at)
{
    const struct history_frame *f = r->frame;
    uint64_t n = lattice_count(at);
    double us = 0;
    struct history_frag *whole = history_frag_at(&r->log, f, at);
    r->whole = whole;
    if (whole) us = pixel_us(r, whole, lattice_pixel(at, f->w, 0)) * (double)n;
    for (uint64_t i = 0; !whole && i < n; i++) {
        uint64_t p = lattice_pixel(at, f->w, i);
        struct history_place place = history_place_of(&r->log, f, p);
        if (place.frag < 0) refuse(r, p, "is missing");
        us += pixel_us(r, &r->log.frags[place.frag], p);
    }
    return us * r->o->scale / r->o->power;
}

static void render(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    struct replay *r = ctx;
    if (n0 == 0) last(r, cost_us(r, at));
    if (r->whole) {
        wire_pixels(r->whole->body + n0 * WIRE_PIXEL_BYTES, n, rgba);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint64_t p = lattice_pixel(at, r->frame->w, n0 + i);
        struct history_place place = history_place_of(&r->log, r->frame, p);
        const unsigned char *body = r->log.frags[place.frag].body;
        wire_pixels(body + (size_t)place.n * WIRE_PIXEL_BYTES, 1, rgba + 4 * (size_t)i);
    }
}

/* The log is in memory shared by all its replays; if it is no regular file, in this process's
 * own. */
static void map_log(struct replay *r)
{
    struct stat st;
    struct buf b = {0};
    ptrdiff_t n;
    int fd = open(r->o->path, O_RDONLY | O_CLOEXEC);
    if (fd < 0 || fstat(fd, &st) != 0) die(ST_USAGE, "%s:", r->o->path);
    r->n_bytes = (size_t)st.st_size;
    r->bytes = S_ISREG(st.st_mode) && st.st_size
                   ? mmap(NULL, r->n_bytes, PROT_READ, MAP_SHARED, fd, 0)
                   : MAP_FAILED;
    if (r->bytes == MAP_FAILED) {
        while ((n = read_some(fd, &b, 1 << 16)) > 0)
            ;
        if (n < 0) die(errno == EISDIR ? ST_USAGE : ST_SYSTEM, "%s:", r->o->path);
        r->bytes = b.data;
        r->n_bytes = b.len;
    }
    close(fd);
}

/* Maps the log, and reads only enough of it to see that it is one. */
static void open_log(struct replay *r)
{
    map_log(r);
    struct decoder d = wire_over(r->bytes, r->n_bytes);
    struct record rec;
    const char *job = NULL;
    size_t n = 0;
    enum wire_result got;
    d.upward = d.unsummed = true;
    while (!job && (got = wire_next(&d, &rec)) != WIRE_MORE) {
        if (got != WIRE_RECORD) continue;
        if (!rec_ours(&rec, d.why)) die(ST_USAGE, "%s: %s", r->o->path, d.why);
        if (rec.kind == REC_FRAME) job = rec_key(&rec, "job", &n);
    }
    if (!job) die(ST_USAGE, "%s: no task with pixels, expected the log of a run", r->o->path);
    r->first_job = hash64(HASH64_INIT, job, n);
}

static void load_log(struct replay *r)
{
    const char *path = r->o->path;
    struct history *l = &r->log;
    history_over(l, r->bytes, r->n_bytes);
    if (l->refused) die(ST_USAGE, "%s: %s", path, l->why);
    if (l->bad) warn("%s: %" PRIu64 " damaged places skipped; the last: %s", path, l->bad, l->why);
    if (!l->n_frags || !l->n_dones)
        die(ST_USAGE, "%s: no task with pixels, expected the log of a run", path);
    for (size_t i = 0; i < l->n_frames; i++) {
        const struct history_frame *f = &l->frames[i];
        if (strlen(f->job) != 16 || f->job[strspn(f->job, "0123456789abcdef")])
            die(ST_USAGE, "%s: frame %u: job=%s, expected 16 hexadecimal digits", path, f->number,
                f->job);
    }
}

/* Scenes and other state are for renderers: ignored. */
static int take_state(void *ctx, uint32_t generation, enum rec_kind kind,
    unsigned char *body, // NOLINT(readability-non-const-parameter)
    size_t n, char err[WORKER_ERR])
{
    (void)ctx, (void)generation, (void)kind, (void)body, (void)n;
    *err = '\0';
    return 0;
}

static int ready(void *ctx, const struct frame_size *wanted, char err[WORKER_ERR])
{
    struct replay *r = ctx;
    int64_t begin = now_us();
    if (!r->loaded) load_log(r);
    /* The original worker has no log to read, so the time for it is part of the next wait. */
    if (!r->loaded) r->owed_us -= (double)(now_us() - begin);
    r->loaded = true;
    const struct history_frame *f = history_frame_of(&r->log, wanted->frame);
    if (!f || f->w != wanted->w || f->h != wanted->h) {
        snprintf(err, WORKER_ERR, "%s: no frame %u of %ux%u, expected a frame of the log",
            r->o->path, wanted->frame, wanted->w, wanted->h);
        return -1;
    }
    if (f != r->frame) r->own_us = cpu_us();
    r->frame = f;
    return 0;
}

static uint64_t job(void *ctx)
{
    const struct history_frame *f = ((struct replay *)ctx)->frame;
    uint64_t v = 0;
    for (const char *c = f->job; *c; c++)
        v = v << 4 | (uint64_t)(*c <= '9' ? *c - '0' : *c - 'a' + 10);
    return v;
}

static const char *with(void *ctx) { return ((struct replay *)ctx)->frame->with; }

static int64_t used_us(void *ctx) { return llrint(((struct replay *)ctx)->used_us); }

/*
 * Takes the reference's time, so that hello states the power. The pixel encodes the log's job:
 * slots that replay different jobs are told apart like machines with different arithmetic.
 */
static void selftest(void *ctx, float *rgba, uint32_t *n)
{
    const struct replay *r = ctx;
    *n = 1;
    for (int k = 0; k < 4; k++) rgba[k] = (float)(r->first_job >> (16 * k) & 0xffff);
    sleep_us(WORKER_SELFTEST_REFERENCE_US / r->o->power);
}

static const struct worker_ops ops = {
    .program = "replay",
    .state = take_state,
    .ready = ready,
    .job = job,
    .with = with,
    .render = render,
    .selftest = selftest,
    .cpu_us = used_us,
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
    static const char text[] = "[-ch] [-f PIXELS] [-l LOAD] [-p POWER] [-s SEED] [-x SCALE] LOG";
    struct options o = {.power = usual_power(), .scale = 1};
    int opt;
    /* Options may follow the log: methods append theirs to the command line. */
    while ((opt = prog_getopt(argc, argv, "hl:p:s:x:" WORKER_OPTIONS)) != -1) {
        switch (opt) {
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
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL); /* ns: sleeps end on time */
    open_log(&r);
    int status = worker_run(&ops, &o.worker, &r);
    history_free(&r.log);
    return status;
}
