/*
 * fan: the router. Tasks with to=K go to slot K, others to slot ID mod N, state to all; what comes
 * back is checked, stamped and merged. Backpressure: when the reader is slow, workers are not read;
 * when a worker is slow, the input is not read. Neither can stop the other direction, so there is
 * no deadlock.
 */
#include "drive/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#define TICK_MS 500
#define HELLO_S 10.0   /* silence allowed before the first word, */
#define LOADING_S 60.0 /* while the state is being loaded, */
#define CLOSING_S 1.0  /* and when nothing is left to say */

static void route_state(struct fan *f, const struct record *r)
{
    struct buf bytes = {0};
    wire_forward(&bytes, r, NULL, NULL);
    struct blob *b = blob_new(buf_data(&bytes), buf_size(&bytes));
    b->users = 1; /* this function's, so that it outlives an empty round */
    buf_free(&bytes);
    for (int k = 0; k < f->o->slots; k++)
        if (!f->slots[k].ended) down_share(&f->slots[k].down, b);
    if (--b->users == 0) {
        buf_free(&b->bytes);
        free(b);
    }
}

static void route_small(struct fan *f, const struct record *r)
{
    struct buf line = {0};
    static const char *const drop[] = {"to", NULL};
    wire_forward(&line, r, drop, NULL);
    for (int k = 0; k < f->o->slots; k++)
        if (!f->slots[k].ended && (r->task.to < 0 || r->task.to == k))
            down_append(&f->slots[k].down, buf_data(&line), buf_size(&line));
    buf_free(&line);
}

static void route(struct fan *f, const struct record *r)
{
    switch (r->kind) {
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC: route_state(f, r); break;
    case REC_FRAME:
        frames_set(&f->frames, r->task.frame, r->frame_w, r->frame_h);
        route_small(f, r);
        break;
    case REC_FLUSH: route_small(f, r); break;
    case REC_TASK:
        if (r->task.to >= f->o->slots)
            die(ST_USAGE, "task %u %u: to=%d, expected a slot below %d", r->task.frame, r->task.id,
                r->task.to, f->o->slots);
        slot_send(f, r->task.to >= 0 ? r->task.to : (int)(r->task.id % (uint32_t)f->o->slots), r);
        break;
    default:
        die(ST_USAGE, "standard input: record `%s`, expected state, frame, task or flush",
            rec_name(r->kind));
    }
}

static void take_input(struct fan *f)
{
    struct record r;
    enum wire_result result;
    f->in_open = stream_read(&f->in, STDIN_FILENO);
    while ((result = wire_next(&f->in, &r)) == WIRE_RECORD) route(f, &r);
    if (result == WIRE_BAD) die(ST_USAGE, "standard input: %s", f->in.why);
}

/* No slot has more queued than it should. */
static bool room_down(const struct fan *f)
{
    for (int k = 0; k < f->o->slots; k++)
        if (buf_size(&f->slots[k].down.bytes) > DOWN_QUEUE_MOST) return false;
    return true;
}

/* Writes to slots whose pipe was not found full: what has just been queued goes out at once. */
static void feed(struct fan *f, struct fan_slot *s, const struct pollfd *p)
{
    bool full = p->events & POLLOUT && !(p->revents & POLLOUT);
    if (p->revents & POLLERR || (!full && down_write(&s->down, s->child.to) != 0))
        child_close(&s->child.to); /* it reads no more: its output tells why */
    if (!f->in_open && down_empty(&s->down)) child_close(&s->child.to);
}

/* Slots that have work, or were told to end, and say nothing. */
static void find_silent(struct fan *f, bool reading)
{
    int64_t now = now_us();
    for (int k = 0; k < f->o->slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (s->ended) continue;
        bool closing = !f->in_open && !s->tasks.count;
        double limit_s = closing     ? CLOSING_S
                         : !s->hello ? HELLO_S
                         : s->loaded ? f->o->silence_s
                                     : LOADING_S;
        if (!reading || (s->hello && !s->tasks.count && !closing)) s->heard_us = now;
        else if ((double)(now - s->heard_us) > limit_s * 1e6) slot_lose(f, s, "silent");
    }
}

/* The reader is gone: nobody needs the rest. */
static int abandon(struct fan *f)
{
    for (int k = 0; k < f->o->slots; k++)
        if (!f->slots[k].ended) child_end(&f->slots[k].child, 0);
    return ST_SYSTEM;
}

static void poll_round(struct fan *f, struct pollfd *p, bool *gone)
{
    int n = f->o->slots;
    bool reading = up_size(&f->up) < UP_QUEUE_MOST;
    p[0] = poll_entry(STDIN_FILENO, f->in_open && f->alive && room_down(f), POLLIN);
    p[1] = poll_entry(STDOUT_FILENO, true, up_size(&f->up) ? POLLOUT : 0);
    for (int k = 0; k < n; k++) {
        struct fan_slot *s = &f->slots[k];
        p[2 + 2 * k] = poll_entry(s->child.to, !s->ended, down_empty(&s->down) ? 0 : POLLOUT);
        p[3 + 2 * k] = poll_entry(s->child.from, !s->ended && reading, POLLIN);
    }
    if (poll(p, 2 + 2 * (nfds_t)n, TICK_MS) < 0) {
        if (errno == EINTR) return;
        die(ST_SYSTEM, "poll:");
    }
    if (p[1].revents & (POLLERR | POLLNVAL)) *gone = true;
    if (p[1].revents & POLLOUT && up_write(&f->up, STDOUT_FILENO) != 0) {
        if (errno != EPIPE) warn("standard output:");
        *gone = true;
    }
    if (*gone) return;
    if (p[0].revents) take_input(f);
    for (int k = 0; k < n; k++) {
        struct fan_slot *s = &f->slots[k];
        if (s->ended) continue;
        if (s->child.to >= 0) feed(f, s, &p[2 + 2 * k]);
        if (p[3 + 2 * k].revents) slot_listen(f, s);
    }
    find_silent(f, reading);
}

static void free_fan(struct fan *f)
{
    free(f->slots);
    wire_free(&f->in);
    frames_free(&f->frames);
    up_free(&f->up);
}

int drive_fan(const struct fan_options *o)
{
    struct fan f = {.o = o, .start_us = now_us(), .in_open = true};
    struct pollfd *p = xcalloc((size_t)o->slots * 2 + 2, sizeof *p);
    bool gone = false, bye = false;
    signal(SIGPIPE, SIG_IGN);
    f.slots = xcalloc((size_t)o->slots, sizeof *f.slots);
    for (int k = 0; k < o->slots; k++) slot_start(&f, k);
    while (!gone && (f.alive || up_size(&f.up))) {
        poll_round(&f, p, &gone);
        if (f.alive || bye) continue;
        bye = true;
        wire_plain(&f.up.bulk, REC_BYE, NULL);
        up_end_record(&f.up);
    }
    int status = gone ? abandon(&f) : f.in_open ? ST_SYSTEM : f.lost ? ST_PARTIAL : ST_OK;
    if (!gone && f.in_open) warn("no slot left");
    if (f.stale) warn("%" PRId64 " answers to no question were dropped", f.stale);
    free(p);
    free_fan(&f);
    return status;
}
