/*
 * fan: the router. Tasks with to=K go to slot K, others to slot ID mod N, state to all; what comes
 * back is checked, stamped and merged. Backpressure: when the reader is slow, workers are not read;
 * when a worker is slow, the input is not read. Neither can stop the other direction, so there is
 * no deadlock.
 */
#include "drive/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <unistd.h>

#define TICK_MS 500
#define LEAVING_MS 100 /* while a slot is exiting; its end is told by SIGCHLD, its staying is not */
#define STOP_MS 200    /* for workers to end when all is given up */
#define HELLO_S 10.0   /* silence allowed before the first word, */
#define LOADING_S 60.0 /* while the state is being loaded, */
#define CLOSING_S 1.0  /* and when nothing is left to say */

/* No slot has more queued than it should. */
static bool room_down(const struct fan *f)
{
    for (int k = 0; k < f->o->slots; k++)
        if (down_size(&f->slots[k].down) > DOWN_QUEUE_MOST) return false;
    return true;
}

/* So long may slot s say nothing; 0: as long as it likes. */
static double silence_allowed_s(const struct fan *f, const struct fan_slot *s)
{
    if (!f->in_open && !s->tasks.count) return CLOSING_S;
    if (!s->hello) return HELLO_S;
    /* Pixels of what is done may be held back until somebody asks. */
    bool asked = s->undone || (s->tasks.count && (s->flushed || !f->in_open));
    if (!asked) return 0;
    return s->loaded ? f->o->silence_s : LOADING_S;
}

/*
 * Slots that have work, or were told to end, and say nothing. What counts is that a slot had been
 * silent for too long before poll looked, and that poll found nothing: this process may itself have
 * been kept from running.
 */
static void find_silent(struct fan *f, int64_t looked_us, bool reading)
{
    for (int k = 0; k < f->o->slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (s->ended || s->leave_us) continue;
        double allowed_s = silence_allowed_s(f, s);
        if (!reading || allowed_s <= 0) s->heard_us = now_us();
        else if ((double)(looked_us - s->heard_us) > allowed_s * 1e6) slot_lose(f, s, "silent");
    }
}

/* The reader is gone, or the input is no good: nobody needs the rest. */
static void abandon(struct fan *f)
{
    int64_t end = now_us() + STOP_MS * INT64_C(1000);
    for (int k = 0; k < f->o->slots; k++)
        if (!f->slots[k].ended) child_stop(&f->slots[k].child);
    for (int k = 0; k < f->o->slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (s->ended) continue;
        int64_t left_us = end - now_us();
        child_end(&s->child, left_us > 0 ? (int)(left_us / 1000) : 0);
        slot_free(s);
    }
}

/* Only what is open: poll takes no more entries than descriptors may be open. Returns how many. */
static size_t fill_poll(struct fan *f, struct pollfd *p, bool reading)
{
    size_t n = 2;
    p[0] = poll_entry(STDIN_FILENO, f->in_open && f->alive && room_down(f), POLLIN);
    p[1] = outlet_poll(&f->out);
    for (int k = 0; k < f->o->slots; k++) {
        struct fan_slot *s = &f->slots[k];
        s->poll = n;
        if (s->child.to < 0 && s->child.from < 0) continue;
        p[n++] = poll_entry(s->child.to, true, down_size(&s->down) ? POLLOUT : 0);
        p[n++] = poll_entry(s->child.from, reading, POLLIN);
    }
    return n;
}

static void poll_round(struct fan *f, struct pollfd *p)
{
    bool reading = up_size(&f->out.queue) < UP_QUEUE_MOST;
    int64_t looked_us = now_us();
    size_t n = fill_poll(f, p, reading);
    if (poll_signals(p, n, f->leaving ? LEAVING_MS : TICK_MS) < 0) {
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
        for (size_t i = 0; i < n; i++) p[i].revents = 0;
        looked_us = 0; /* nobody was found silent */
    }
    outlet_polled(&f->out, &p[1]);
    if (f->out.gone) return;
    if (p[0].revents) fan_take_input(f);
    for (int k = 0; k < f->o->slots && !f->refused; k++) {
        struct fan_slot *s = &f->slots[k];
        if (s->child.to >= 0) slot_feed(f, s, &p[s->poll]);
        if (s->child.from >= 0 && p[s->poll + 1].revents) slot_listen(f, s);
        if (s->leave_us) slot_left(f, s);
    }
    find_silent(f, looked_us, reading);
    outlet_push(&f->out);
}

static void free_fan(struct fan *f)
{
    free(f->slots);
    wire_free(&f->in);
    frames_free(&f->frames);
    up_free(&f->out.queue);
    buf_free(&f->line);
}

int drive_fan(const struct fan_options *o)
{
    struct fan f = {.o = o, .start_us = now_us(), .in_open = true};
    struct pollfd *p = xcalloc((size_t)o->slots * 2 + 2, sizeof *p);
    signals_catch();
    want_descriptors(2 * o->slots + 16);
    outlet_open(&f.out);
    f.slots = xcalloc((size_t)o->slots, sizeof *f.slots);
    for (int k = 0; k < o->slots; k++) slot_start(&f, k);
    while (f.alive && !f.out.gone && !f.refused && !signals_came()) poll_round(&f, p);
    abandon(&f);
    if (!f.refused) {
        wire_plain(&f.out.queue.bulk, REC_BYE, NULL);
        up_end_record(&f.out.queue);
        outlet_drain(&f.out);
    }
    bool failed = f.out.gone || f.in_open;
    int status = f.refused ? f.refused : failed ? ST_SYSTEM : f.lost ? ST_PARTIAL : ST_OK;
    if (!f.refused && !f.out.gone && f.in_open && !signals_came()) warn("no slot left");
    if (f.stale) warn("%" PRId64 " answers to no question were dropped", f.stale);
    free(p);
    free_fan(&f);
    if (signals_came()) signals_die();
    return status;
}
