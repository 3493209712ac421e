/*
 * The live driver of a policy: records to events, actions to records, around one command. It holds
 * no scheduling decision. What the command says of slots (hello, up, gone) ends here; outwards this
 * is one worker.
 */
#include "drive/drive.h"
#include "drive/tags.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define POOL_MOST 65536 /* tasks waiting: more are left in the pipe */
#define GRACE_MS 1000   /* for the command to exit once its stream has ended */

struct driver {
    const struct policy *policy;
    void *state;
    struct sched_actions acts;
    struct child child;
    struct down_queue down;
    struct up_queue up;
    struct decoder in, from;
    struct frames frames;
    struct tags tags;
    bool in_open, closing;
};

/* "2.1" is slot 2 of the fan inside: deeper levels are its own affair. */
static int32_t slot_of(const struct record *r)
{
    char text[24];
    size_t n;
    int64_t k;
    const char *w = rec_key(r, "w", &n);
    const char *dot = w ? memchr(w, '.', n) : NULL;
    if (dot) n = (size_t)(dot - w);
    if (!w || n >= sizeof text) return -1;
    memcpy(text, w, n);
    text[n] = '\0';
    return parse_int(text, 0, INT32_MAX, &k) ? (int32_t)k : -1;
}

static void give(struct driver *d, struct buf *line, struct task t)
{
    const char *keys = tags_find(&d->tags, &t);
    wire_task(line, &t);
    if (!keys) return;
    line->len--; /* the newline */
    buf_printf(line, " %s\n", keys);
}

static void perform(struct driver *d)
{
    struct buf line = {0};
    for (size_t i = 0; i < d->acts.n; i++) {
        const struct sched_action *a = &d->acts.at[i];
        struct task t = a->task;
        t.to = a->slot;
        if (a->kind == SCHED_GIVE) give(d, &line, t);
        if (a->kind == SCHED_COMMIT) tags_drop(&d->tags, &t);
        if (a->kind == SCHED_ASK_FLUSH) buf_printf(&line, "flush to=%" PRId32 "\n", a->slot);
        if (a->kind == SCHED_END) d->closing = true;
    }
    down_append(&d->down, buf_data(&line), buf_size(&line));
    buf_free(&line);
    d->acts.n = 0;
}

static void tell(struct driver *d, struct sched_event e)
{
    d->policy->step(d->state, &e, now_us(), &d->acts);
    perform(d);
}

static void pass_down(struct driver *d, const struct record *r)
{
    struct buf bytes = {0};
    wire_forward(&bytes, r, NULL, NULL);
    down_append(&d->down, buf_data(&bytes), buf_size(&bytes));
    buf_free(&bytes);
}

static void take_task(struct driver *d, const struct record *r)
{
    const struct frame_size *f = frames_find(&d->frames, r->task.frame);
    if (!f)
        die(ST_USAGE, "task %u %u: expected `frame` before its tasks", r->task.frame, r->task.id);
    tags_keep(&d->tags, r);
    tell(d, (struct sched_event){.kind = SCHED_TASK, .task = r->task, .frame_w = f->w});
}

static void take_down(struct driver *d, const struct record *r)
{
    switch (r->kind) {
    case REC_FRAME:
        frames_set(&d->frames, r->task.frame, r->frame_w, r->frame_h);
        pass_down(d, r);
        break;
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC: pass_down(d, r); break;
    case REC_TASK: take_task(d, r); break;
    case REC_FLUSH: tell(d, (struct sched_event){.kind = SCHED_FLUSH}); break;
    default:
        die(ST_USAGE, "standard input: record `%s`, expected state, frame, task or flush",
            rec_name(r->kind));
    }
}

static void take_input(struct driver *d)
{
    struct record r;
    enum wire_result result;
    d->in_open = stream_read(&d->in, STDIN_FILENO);
    while ((result = wire_next(&d->in, &r)) == WIRE_RECORD) take_down(d, &r);
    if (result == WIRE_BAD) die(ST_USAGE, "standard input: %s", d->in.why);
    if (!d->in_open) tell(d, (struct sched_event){.kind = SCHED_INPUT_END});
}

static void take_hello(struct driver *d, const struct record *r)
{
    char selftest[24] = "", text[96];
    int64_t n = 1;
    rec_int(r, "slots", 1, 1 << 20, &n);
    rec_str(r, "selftest", selftest, sizeof selftest);
    snprintf(text, sizeof text, "%s %s selftest=%s slots=%" PRId64, d->policy->name,
        STORMRING_VERSION, selftest, n);
    wire_plain(&d->up.control, REC_HELLO, text);
    tell(d, (struct sched_event){.kind = SCHED_SLOTS, .n = (int32_t)n});
}

static void take_up(struct driver *d, const struct record *r)
{
    struct sched_event e = {.slot = slot_of(r), .task = r->task};
    switch (r->kind) {
    case REC_HELLO: take_hello(d, r); return;
    case REC_FRAME:
    case REC_BEAT: wire_forward(&d->up.control, r, NULL, NULL); return;
    case REC_DONE:
        wire_forward(&d->up.control, r, NULL, NULL);
        e.kind = SCHED_DONE;
        break;
    case REC_FRAG:
        up_forward(&d->up, r, NULL, NULL);
        e.kind = SCHED_PIXELS;
        break;
    case REC_UP: e.kind = SCHED_UP; break;
    case REC_GONE: e.kind = SCHED_GONE; break;
    default: return;
    }
    if (e.slot >= 0) tell(d, e);
}

/* What the command says. False when its stream has ended. */
static bool listen_up(struct driver *d)
{
    struct record r;
    enum wire_result result;
    bool more = stream_read(&d->from, d->child.from);
    while ((result = wire_next(&d->from, &r)) != WIRE_MORE) {
        if (result == WIRE_RECORD) take_up(d, &r);
        else if (!d->from.ended) die(ST_SYSTEM, "from the command: %s", d->from.why);
    }
    return more;
}

/* What has just been queued goes out at once, unless the pipe was found full. */
static void feed(struct driver *d, const struct pollfd *p)
{
    bool full = p->events & POLLOUT && !(p->revents & POLLOUT);
    if (p->revents & POLLERR || (!full && down_write(&d->down, d->child.to) != 0))
        child_close(&d->child.to); /* it reads no more: its output tells why */
    if (d->closing && down_empty(&d->down)) child_close(&d->child.to);
}

/* One round. *gone: the reader has gone. Returns false when the command's stream has ended. */
static bool poll_round(struct driver *d, bool *gone)
{
    bool reading = up_size(&d->up) < UP_QUEUE_MOST;
    bool want = d->in_open && d->policy->waiting(d->state) < POOL_MOST &&
                buf_size(&d->down.bytes) < DOWN_QUEUE_MOST;
    struct pollfd p[4] = {
        poll_entry(STDIN_FILENO, want, POLLIN),
        poll_entry(STDOUT_FILENO, true, up_size(&d->up) ? POLLOUT : 0),
        poll_entry(d->child.to, true, down_empty(&d->down) ? 0 : POLLOUT),
        poll_entry(d->child.from, reading, POLLIN),
    };
    if (poll(p, 4, -1) < 0) {
        if (errno == EINTR) return true;
        die(ST_SYSTEM, "poll:");
    }
    if (p[1].revents & (POLLERR | POLLNVAL)) *gone = true;
    if (p[1].revents & POLLOUT && up_write(&d->up, STDOUT_FILENO) != 0) {
        if (errno != EPIPE) warn("standard output:");
        *gone = true;
    }
    if (*gone) return true;
    if (p[0].revents) take_input(d);
    bool more = p[3].revents ? listen_up(d) : true;
    if (d->child.to >= 0) feed(d, &p[2]);
    return more;
}

/* The rest goes to the reader, who may be slow. */
static void drain(struct driver *d)
{
    wire_plain(&d->up.bulk, REC_BYE, NULL);
    up_end_record(&d->up);
    while (up_size(&d->up)) {
        struct pollfd p = {STDOUT_FILENO, POLLOUT, 0};
        if (poll(&p, 1, -1) < 0 && errno != EINTR) return;
        if (p.revents & POLLERR) return;
        if (p.revents & POLLOUT && up_write(&d->up, STDOUT_FILENO) != 0) return;
    }
}

int drive_policy(
    const struct policy *policy, const struct sched_params *params, char *const *command)
{
    struct driver d = {.policy = policy, .in_open = true, .from.upward = true};
    bool gone = false;
    signal(SIGPIPE, SIG_IGN);
    d.state = policy->create(params);
    if (child_start(&d.child, command) != 0) die(ST_SYSTEM, "%s:", command[0]);
    while (!gone && poll_round(&d, &gone))
        ;
    child_end(&d.child, gone ? 0 : GRACE_MS);
    int64_t left = policy->uncommitted(d.state);
    if (!gone) drain(&d);
    int status = gone || left || d.in_open ? ST_SYSTEM : ST_OK;
    if (!gone && status) warn("%s ended with %" PRId64 " tasks unfinished", command[0], left);
    policy->destroy(d.state);
    free(d.acts.at);
    down_free(&d.down);
    up_free(&d.up);
    wire_free(&d.in);
    wire_free(&d.from);
    frames_free(&d.frames);
    tags_free(&d.tags);
    return status;
}
