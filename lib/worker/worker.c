/* The worker's loop: see worker.h. One machine with fork_slot.c and forks.c. */
#include "worker/worker_int.h"

#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#define LOOK_US 100000
#define BEAT_US 450000 /* time after which a check is also a beat: every fifth */
#define GONE (POLLERR | POLLHUP | POLLNVAL)
#define SELFTEST_PIXELS 4096 /* room */
#define READ_BYTES 65536
#define WITH_MAX 160

/*
 * The pulse. A callback may load a scene for minutes, or take as long for one pixel. Meanwhile a
 * timer checks that the reader is still there, and sends beats. It writes only while `busy`, when
 * no record is half written. It stops itself when the worker is idle.
 */
static volatile sig_atomic_t busy, ticking;
static bool pulsing;    /* pulse_open was called */
static int64_t beat_us; /* time of the latest; a slow process misses checks */

static void set_timer(suseconds_t us)
{
    setitimer(ITIMER_REAL, &(struct itimerval){{0, us}, {0, us}}, NULL);
    ticking = us != 0;
}

static void look(int sig)
{
    static const char beat[] = "beat\n";
    struct pollfd p = {STDOUT_FILENO, 0, 0};
    int err = errno;
    (void)sig;
    if (poll(&p, 1, 0) > 0 && p.revents & GONE) _exit(ST_SYSTEM);
    if (now_us() - beat_us >= BEAT_US) {
        beat_us = now_us();
        if (!busy) set_timer(0);
        else if (write(STDOUT_FILENO, beat, sizeof beat - 1) < 0) _exit(ST_SYSTEM);
    }
    errno = err;
}

static void pulse_open(void)
{
    struct sigaction act = {.sa_handler = look, .sa_flags = SA_RESTART};
    sigset_t own;
    sigemptyset(&act.sa_mask);
    sigemptyset(&own);
    sigaddset(&own, SIGALRM);
    sigaction(SIGALRM, &act, NULL);
    sigprocmask(SIG_UNBLOCK, &own, NULL);
    pulsing = true;
}

/* begin and end enclose each callback. */
static void begin(void)
{
    if (!pulsing) return;
    busy = 1;
    if (ticking) return;
    beat_us = now_us();
    set_timer(LOOK_US);
}

static void end(void) { busy = 0; }

/* The reader is gone, or writing failed: this process is not needed any more. */
static _Noreturn void reader_gone(int err)
{
    if (err == EPIPE || !err) exit(ST_SYSTEM);
    errno = err;
    die(ST_SYSTEM, "standard output:");
}

static void push(struct worker *w)
{
    if (!buf_size(&w->out)) return;
    if (write_full(STDOUT_FILENO, buf_data(&w->out), buf_size(&w->out)) != 0) reader_gone(errno);
    buf_consume(&w->out, buf_size(&w->out));
}

void worker_hello(struct worker *w, int slots)
{
    static float rgba[4 * SELFTEST_PIXELS];
    uint32_t n = SELFTEST_PIXELS;
    int64_t start = now_us();
    w->ops->selftest(w->ctx, rgba, &n);
    int64_t took = now_us() - start;
    uint64_t hash = hash64_u32(HASH64_INIT, rgba, (size_t)n * 4);
    char selftest[24];
    snprintf(selftest, sizeof selftest, "%016" PRIx64, hash);
    wire_hello(&w->out, w->ops->program, selftest,
        slots * WORKER_SELFTEST_REFERENCE_US / (double)(took > 0 ? took : 1), slots);
    push(w);
}

bool worker_announce(struct worker *w, const struct frame_size *f, char err[WORKER_ERR])
{
    struct worker_job *known = frames_extra(&w->frames, f);
    if (known->announced) return true;
    begin();
    int failed = w->ops->ready(w->ctx, f, err);
    end();
    if (failed) return false;
    char extra[WITH_MAX + 32], job[sizeof known->hash];
    w->ops->job(w->ctx, job);
    snprintf(extra, sizeof extra, "with=%.*s%s", WITH_MAX, w->ops->with(w->ctx),
        w->ops->replayed ? " kind=replayed" : "");
    wire_job(&w->out, f, job, extra);
    if (*known->hash && strcmp(known->hash, job) != 0)
        snprintf(w->other_job, sizeof w->other_job,
            "frame %u: has job %s here, expected %s: the same scene or grid and specification, "
            "with the same options",
            f->frame, job, known->hash);
    memcpy(known->hash, job, sizeof job);
    known->announced = true;
    return true;
}

struct frame_size *worker_frame(struct worker *w, const struct record *r)
{
    struct frame_size *f = frames_find(&w->frames, r->task.frame);
    struct worker_job *known = f ? frames_extra(&w->frames, f) : NULL;
    char job[sizeof known->hash] = "";
    bool same = f && f->w == r->frame_w && f->h == r->frame_h && known->announced;
    if (rec_str(r, "job", job, sizeof job)) same = same && strcmp(job, known->hash) == 0;
    if (same && f->generation == w->generations.now) return NULL;
    f = frames_set(&w->frames, r->task.frame, r->frame_w, r->frame_h);
    generation_frame(&w->generations, f);
    known = frames_extra(&w->frames, f);
    memcpy(known->hash, job, sizeof job);
    return f;
}

/* Another job is announced too, so that the reader can say which slot has it. */
static void announce(struct worker *w)
{
    push(w);
    if (*w->other_job) die(ST_USAGE, "%s", w->other_job);
}

static void take_frame(struct worker *w, const struct record *r)
{
    char err[WORKER_ERR];
    const struct frame_size *f = worker_frame(w, r);
    if (f) worker_announce(w, f, err); /* state may be missing: then the first task tries again */
    announce(w);
}

static void release_held(struct worker *w)
{
    push(w);
    if (write_full(STDOUT_FILENO, buf_data(&w->held), buf_size(&w->held)) != 0) reader_gone(errno);
    buf_consume(&w->held, buf_size(&w->held));
}

static void emit_frag(
    struct worker *w, const struct task *t, const struct lattice *at, const char *job)
{
    struct buf *to = w->options->concentrate ? &w->held : &w->out;
    size_t begin = buf_size(to);
    wire_frag(to, t, at, job, w->pixels);
    if (w->packs) wire_pack_last(to, begin);
}

/* Absurd but valid scenes, such as mirrors of Ks 1e6, exceed the range of float. Values beyond
 * it become its limit, and NaN becomes 0: the same on all machines, and valid light for all
 * readers. */
static inline float limited(float a, float most) { return a >= 0 ? a < most ? a : most : 0; }

static void limit(float *rgba, uint64_t n)
{
    for (float *end = rgba + 4 * n; rgba < end; rgba += 4) {
        for (int c = 0; c < 3; c++) rgba[c] = limited(rgba[c], FLT_MAX);
        rgba[3] = limited(rgba[3], 1);
    }
}

static int64_t used_us(const struct worker *w)
{
    return w->ops->cpu_us ? w->ops->cpu_us(w->ctx) : cpu_us();
}

/* The CPU time of a task includes all since the previous one: reading and writing are work too. */
static void say_done(struct worker *w, const struct task *t, int64_t wall_us)
{
    int64_t cpu = used_us(w);
    wire_done(&w->out, t, cpu - w->cpu_us, wall_us);
    w->cpu_us = cpu;
}

const struct frame_size *worker_frame_of(const struct worker *w, const struct task *t)
{
    const struct frame_size *f = frames_find(&w->frames, t->frame);
    if (!f)
        die(ST_USAGE, "task %u %u: no such frame, expected `frame` before its tasks", t->frame,
            t->id);
    if (!lattice_valid(&t->at, f->w, f->h))
        die(ST_USAGE, "task %u %u: expected pixels inside %ux%u", t->frame, t->id, f->w, f->h);
    if (!generation_lives(&w->generations, f))
        die(ST_USAGE, "task %u %u: its state was replaced too often, expected it earlier", t->frame,
            t->id);
    return f;
}

static void take_task(struct worker *w, const struct task *t)
{
    char err[WORKER_ERR];
    const struct frame_size *f = worker_frame_of(w, t);
    if (!worker_announce(w, f, err)) die(ST_USAGE, "%s", err);
    announce(w);
    if (w->ops->ready(w->ctx, f, err) != 0) die(ST_USAGE, "%s", err);
    const struct worker_job *known = frames_extra(&w->frames, f);
    if (w->held_of != f->generation) release_held(w);
    w->held_of = f->generation;
    int64_t wall = now_us();
    begin();
    if (w->ops->task) w->ops->task(w->ctx, f, &t->at);
    end();
    uint64_t total = lattice_count(&t->at), most = w->options->frag_pixels;
    if (!most || most > WIRE_FRAG_PIXELS_MAX) most = WIRE_FRAG_PIXELS_MAX;
    for (uint64_t n0 = 0; n0 < total;) {
        struct lattice piece = lattice_cut(&t->at, f->w, n0, most);
        uint32_t count = (uint32_t)lattice_count(&piece);
        begin();
        w->ops->render(w->ctx, &piece, 0, count, w->pixels);
        limit(w->pixels, count);
        end();
        n0 += count;
        /* `done` is the scheduling event: it is sent before the last pixels. */
        if (n0 == total) say_done(w, t, now_us() - wall);
        emit_frag(w, t, &piece, known->hash);
        push(w);
    }
}

void worker_drop_older(struct worker *w, enum rec_kind kind, size_t bytes)
{
    uint32_t oldest = generation_oldest(&w->generations, kind, bytes);
    for (; w->dropped != oldest; w->dropped++)
        if (w->ops->drop) w->ops->drop(w->ctx, w->dropped);
}

static void take_state(struct worker *w, const struct record *r)
{
    char err[WORKER_ERR];
    unsigned char *body = wire_body(&w->in, r);
    worker_drop_older(w, r->kind, r->body_len);
    generation_state(&w->generations, r->kind, r->body_len);
    begin();
    if (w->ops->state(w->ctx, w->generations.now, r->kind, body, r->body_len, err) != 0)
        die(ST_USAGE, "%s", err);
    end();
}

_Noreturn void worker_refuse(const struct record *r)
{
    die(ST_USAGE,
        "standard input: record `%s`, expected scene, grid, spec, files, frame, task or "
        "flush",
        rec_name(r->kind));
}

static void take_record(struct worker *w, const struct record *r)
{
    if (r->kind == REC_TASK) {
        take_task(w, &r->task);
        return;
    }
    switch (r->kind) {
    case REC_FRAME: take_frame(w, r); break;
    case REC_CODE:
        stream_code(r, &w->out, &w->packs);
        push(w);
        break;
    case REC_FLUSH:
        release_held(w);
        wire_plain(&w->out, REC_BEAT, NULL); /* an answer even if nothing was held */
        push(w);
        break;
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC:
    case REC_FILES: take_state(w, r); break;
    default:
        if (!silence_take(r)) worker_refuse(r);
    }
    w->cpu_us = used_us(w);
}

/* Waits for input while watching the reader, then reads once. False at the end of input. */
static bool fill(struct worker *w)
{
    struct pollfd p[2] = {{STDIN_FILENO, POLLIN, 0}, {STDOUT_FILENO, 0, 0}};
    while (poll(p, 2, -1) < 0)
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
    if (p[1].revents & GONE) reader_gone(0);
    ptrdiff_t n = read_some(STDIN_FILENO, &w->in.in, READ_BYTES);
    if (n < 0) die(ST_SYSTEM, "standard input:");
    if (n > 0) silence_heard();
    else silence_forget();
    return n > 0;
}

bool worker_option(struct worker_options *o, int opt, const char *arg)
{
    if (opt == 'c') o->concentrate = true;
    else if (opt == 'f') o->frag_pixels = (uint32_t)opt_int(opt, arg, 1, WIRE_FRAG_PIXELS_MAX);
    else if (opt == 'j') o->jobs = (int)opt_int(opt, arg, 1, WORKER_JOBS_MOST);
    else return false;
    return true;
}

void worker_loop(struct worker *w)
{
    w->pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *w->pixels);
    pulse_open();
    for (bool more = true; more;) {
        /* While a long state record arrives, beats go on: a program that waits for this worker
         * does not see how much of the record has arrived. */
        size_t bytes;
        enum rec_kind kind = wire_awaited(&w->in, &bytes);
        if (kind != REC_KINDS) worker_drop_older(w, kind, bytes);
        if (buf_size(&w->in.in) > WIRE_LINE_MAX) begin();
        more = fill(w);
        end();
        if (!more) wire_end(&w->in);
        struct record r;
        enum wire_result result;
        while ((result = wire_next(&w->in, &r)) == WIRE_RECORD) take_record(w, &r);
        if (result == WIRE_BAD) die(ST_USAGE, "standard input: %s", w->in.why);
    }
    release_held(w);
    wire_plain(&w->out, REC_BYE, NULL);
    push(w);
}

void worker_free(struct worker *w)
{
    wire_free(&w->in);
    buf_free(&w->out);
    buf_free(&w->held);
    frames_free(&w->frames);
    free(w->pixels);
}

int worker_run(const struct worker_ops *ops, const struct worker_options *o, void *ctx)
{
    struct worker w = {
        .ops = ops, .options = o, .ctx = ctx, .in.coded = true, .generations.keeps = true};
    int status = ST_OK;
    frames_init(&w.frames, sizeof(struct worker_job));
    signal(SIGPIPE, SIG_IGN); /* so the status is the same whenever the reader goes */
    worker_hello(&w, o->jobs > 1 ? o->jobs : 1);
    if (o->jobs > 1) status = worker_forks(&w);
    else worker_loop(&w);
    worker_free(&w);
    return status;
}
