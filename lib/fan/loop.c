/*
 * fan: the router. A task with to=K goes to slot K, others to slot ID mod N, state to all slots.
 * Records from workers are checked, stamped and merged. Backpressure: if the reader is slow,
 * workers are not read; if a worker is slow, the input is not read. Neither stops the other
 * direction, so there is no deadlock. A slot that is not up stops no other slot.
 */
#include "fan/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define HEAR_MS 10
#define HEAR_BYTES 65536
#define LEAVING_MS 100 /* poll while a slot is exiting: SIGCHLD reports its end, not its staying */

/*
 * The silence allowed to slot s, in microseconds; 0: no limit. Others on its machine may keep a
 * worker with nice= from running; -t is meant for one without.
 */
static double silence_allowed_us(const struct fan *f, const struct fan_slot *s)
{
    const bool opening = s->state == FAN_OPENING, here = s->host->here;
    const double stated_us = f->o->silence_s * 1e6 * pow(PATIENCE_NICE_TIMES, s->host->host->nice);
    if (fan_slot_over(f, s) && !s->n_tasks && here && !opening) return PATIENCE_CLOSING_US;
    if (fan_slot_has_asked(s)) return PATIENCE_REACH_US + fan_send_time_s(s) * 1e6;
    if (fan_slot_in_queue(s))
        return s->state == FAN_QUEUED ? s->host->host->wait_s * 1e6 : PATIENCE_QUEUED_US;
    if (opening) return fmax(here ? PATIENCE_HELLO_US : PATIENCE_REACH_US, stated_us);
    if (fan_slot_over(f, s) && !s->n_tasks) return stated_us;
    /* Pixels of computed tasks may be held back until a flush. */
    bool asked = s->undone || (s->n_tasks && (s->feed.flushed || !f->in_open));
    if (!asked) return 0;
    return s->feed.loading ? fmax(PATIENCE_LOADING_US, stated_us) : stated_us;
}

/* A list of powers does not wait for a queue. */
static void went_silent(struct fan *f, struct fan_slot *s)
{
    bool queued = s->state == FAN_OPENING && fan_slot_in_queue(s);
    if (queued && f->listing) fan_slot_lose(f, s, "queued", false);
    else if (queued) fan_slot_queue(f, s);
    else fan_slot_lose(f, s, s->state == FAN_UP ? "silent" : "no-hello", true);
}

/*
 * Finds slots that have work, or were told to end, and are silent. A slot is lost only if its
 * silence was too long before poll looked, and poll found nothing: this process itself may have
 * been kept from running.
 */
static void find_silent(struct fan *f, int64_t looked_us, bool reading)
{
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (!fan_slot_has_stream(s)) continue;
        fan_code_late(f, s, looked_us);
        double allowed_us = silence_allowed_us(f, s);
        if (!reading || allowed_us <= 0) s->conn.heard_us = now_us();
        else if ((double)(looked_us - s->conn.heard_us) > allowed_us) went_silent(f, s);
    }
}

/*
 * While this process was kept from running it read nothing. Workers on the same machine may have
 * been kept from running for longer. This time does not count as their silence.
 */
static void credit_own_delay(struct fan *f, int64_t looked_us)
{
    int64_t late_us = looked_us - f->awake_us - PATIENCE_ROUND_US;
    for (int k = 0; f->awake_us && late_us > 0 && k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (!fan_slot_has_stream(s)) continue;
        int64_t heard_us = s->conn.heard_us + late_us;
        s->conn.heard_us = heard_us < looked_us ? heard_us : looked_us;
    }
}

/* Milliseconds until a slot may have been silent for too long, at most wait_ms. */
static int next_silence_ms(const struct fan *f, int64_t now, int wait_ms)
{
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        if (!fan_slot_has_stream(s)) continue;
        double allowed_us = silence_allowed_us(f, s);
        if (allowed_us <= 0) continue;
        double left_ms = (allowed_us - (double)(now - s->conn.heard_us)) / 1e3;
        if (left_ms < wait_ms) wait_ms = left_ms > 0 ? (int)left_ms + 1 : 0;
    }
    return wait_ms;
}

/* Fills p with open descriptors only: poll allows no more entries than the descriptor limit.
 * Returns their number. */
static size_t fill_poll(struct fan *f, struct pollfd *p, bool reading)
{
    size_t n = 2;
    p[0] = pipe_poll_entry(STDIN_FILENO, f->in_open && fan_room_down(f), POLLIN);
    p[1] = outlet_poll(&f->out);
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        const struct child *c = &s->conn.child;
        s->conn.poll = 0;
        if (c->to < 0 && c->from < 0 && c->err < 0) continue;
        s->conn.poll = n;
        bool sent = fan_slot_is_sent(s);
        /* A slot whose input is to end as soon as it is up has nothing to wait for. */
        bool due = sent || down_size(&s->feed.queue) || fan_slot_over(f, s);
        p[n++] = pipe_poll_entry(c->to, fan_slot_fed(s) || sent, due ? POLLOUT : 0);
        p[n++] = pipe_poll_entry(c->from, reading, POLLIN);
        if (c->err >= 0) p[n++] = pipe_poll_entry(c->err, true, POLLIN);
    }
    return n;
}

static void tend_slot(struct fan *f, struct fan_slot *s, const struct pollfd *p)
{
    if (s->conn.child.err >= 0 && p[s->conn.poll + 2].revents) fan_slot_show_err(f, s);
    fan_alive_beat(f, s);
    if (fan_slot_fed(s) && s->conn.child.to >= 0) fan_slot_feed(f, s, &p[s->conn.poll]);
    else if (fan_slot_is_sent(s)) fan_slot_send_more(s, &p[s->conn.poll]);
    if (s->conn.child.from >= 0 && p[s->conn.poll + 1].revents) fan_slot_listen(f, s);
    if (fan_slot_leaves(s)) fan_slot_left(f, s);
}

/* No slot is up whose beats would tell a fan around this one that it goes on: it says so itself. */
static bool beats(struct fan *f)
{
    if (f->n[FAN_UP] || !f->asked || f->listing) return false;
    outlet_beat(&f->out);
    return true;
}

void fan_round(struct fan *f)
{
    struct pollfd *p = f->poll;
    int wait_ms = fan_connect(f);
    bool reading = up_size(&f->out.queue) < UP_QUEUE_MOST;
    int64_t looked_us = now_us();
    size_t n = fill_poll(f, p, reading);
    credit_own_delay(f, looked_us);
    if (beats(f) && wait_ms > PATIENCE_BEAT_US / 1000) wait_ms = PATIENCE_BEAT_US / 1000;
    if (f->n[FAN_CLOSED] + f->n[FAN_LOST] + f->n[FAN_ENDING] && wait_ms > LEAVING_MS)
        wait_ms = LEAVING_MS;
    if (reading) wait_ms = next_silence_ms(f, looked_us, wait_ms);
    f->awake_us = looked_us + wait_ms * INT64_C(1000);
    if (signals_poll(p, n, wait_ms) < 0) {
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
        for (size_t i = 0; i < n; i++) p[i].revents = 0;
        looked_us = 0; /* no slot was found silent */
    }
    outlet_polled(&f->out, &p[1]);
    if (f->out.gone) return;
    if (p[0].revents) fan_take_input(f);
    for (int k = 0; k < f->n_slots && !f->refused; k++) {
        struct fan_slot *s = &f->slots[k];
        if (s->conn.poll || fan_slot_leaves(s)) tend_slot(f, s, p);
    }
    find_silent(f, looked_us, reading);
    outlet_push(&f->out);
}

/* The slot works, or its end is being judged. */
static bool at_work(const struct fan_slot *s)
{
    return s->state == FAN_UP || s->state == FAN_CLOSED ||
           (s->state == FAN_OPENING && s->host->here);
}

/*
 * The slot's host, or one of its rack, has not had its first try, or is having it. Silent hosts may
 * delay that, because only a few are tried at a time.
 */
static bool untried(const struct fan_slot *s)
{
    const int heads = fan_host_heads(s->host);
    return s->host->failures < heads && s->failures < heads;
}

bool fan_working(const struct fan *f)
{
    int64_t now = now_us(), patience_us = fan_patience_us(f);
    if (f->out.gone || f->refused || f->disputed || f->dismissed || signals_came()) return false;
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        if (at_work(s)) return true;
        bool early = now < s->missing_us + patience_us;
        bool hope = early || untried(s) || fan_slot_in_queue(s) || s->host->host->tries;
        if (fan_slot_comes(s) && fan_slot_wanted(f, s) && hope) return true;
    }
    return false;
}

void fan_open(struct fan *f, const struct fan_options *o, bool listing)
{
    *f = (struct fan){.o = o, .start_us = now_us()};
    f->listing = listing;
    f->in_open = !listing;
    f->in = STREAM_INPUT;
    f->input.generations.keeps = true;
    frames_init(&f->input.frames, sizeof(struct fan_job));
    for (size_t i = 0; i < o->hosts->n; i++) fan_add_host(f, &o->hosts->at[i]);
    if (!listing && fan_workers(f, o->hosts) > FAN_MOST)
        die(ST_USAGE, "%d workers, expected at most %d: one for each host (-1), or in racks (-T)",
            fan_workers(f, o->hosts), FAN_MOST);
    for (int i = 0; i < f->n_hosts; i++) fan_add_slots(f, i, fan_numbers(f->o, &o->hosts->at[i]));
    hosts_watch_open(&f->watch, o->hosts);
    if (*o->command) fan_ask_reference(f);
}

/* Shows its last messages: they may explain why it ends. */
static void await_exit(const struct fan *f, struct fan_slot *s, int64_t end_us)
{
    int status;
    while (!child_ended(&s->conn.child, &status) && now_us() < end_us) {
        if (s->conn.child.err >= 0) fan_slot_show_err(f, s);
        nanosleep(&(struct timespec){0, 500000}, NULL);
    }
}

/* Reads what a worker says that was told to end, and drops it, until its stream ends. */
static void hear_out(const struct fan *f, struct fan_slot *s, int64_t end_us)
{
    struct buf said = {0};
    for (ptrdiff_t n = 1; n > 0 && now_us() < end_us; buf_free(&said)) {
        struct pollfd p = pipe_poll_entry(s->conn.child.from, true, POLLIN);
        if (poll(&p, 1, HEAR_MS) > 0) n = read_some(s->conn.child.from, &said, HEAR_BYTES);
        if (s->conn.child.err >= 0) fan_slot_show_err(f, s);
    }
    await_exit(f, s, end_us);
    child_stop(&s->conn.child);
}

/*
 * Launchers end without a word if their workers end by themselves, as their slots are told to. A
 * connection that is still being opened has nothing to say: its launcher would report its own end.
 */
static void dismiss(struct fan *f, int64_t end_us)
{
    bool *told = xcalloc((size_t)f->n_slots, sizeof *told);
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        told[k] = !f->refused && fan_alive_end(s);
        if (told[k]) continue;
        if (!s->host->here && s->state != FAN_UP && fan_slot_has_stream(s)) fan_slot_end_err(f, s);
        child_stop(&s->conn.child);
    }
    for (int k = 0; k < f->n_slots; k++)
        if (told[k]) hear_out(f, &f->slots[k], end_us);
    free(told);
}

/* Ends the run: the rest is not needed, or no slot is left. */
static void stop(struct fan *f)
{
    int64_t end_us = now_us() + PATIENCE_LAUNCHER_US;
    dismiss(f, now_us() + PATIENCE_BYE_US);
    int64_t here_us = now_us() + PATIENCE_STOP_US;
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        f->lost += s->n_tasks;
        f->unreached |= s->n_tasks > 0;
        await_exit(f, s, s->host->here ? here_us : end_us);
        fan_slot_disconnect(f, s);
        fan_slot_forget(s);
    }
    fan_end_err(f);
}

void fan_close(struct fan *f)
{
    stop(f);
    for (int i = 0; i < f->n_hosts; i++) host_argv_free(f->hosts[i].argv);
    for (int i = 0; i < GENERATIONS; i++) fan_forget(&f->states[i]);
    for (int k = 0; k < f->n_slots; k++) fan_slot_free(&f->slots[k]);
    for (int i = 0; i < f->n_versions; i++) hosts_free(&f->versions[i]);
    for (int i = 0; i < f->n_jumps; i++) free(f->jumps[i].name);
    free(f->jumps);
    free(f->versions);
    free(f->hosts);
    free(f->slots);
    free(f->poll);
    wire_free(&f->in);
    frames_free(&f->input.frames);
    up_free(&f->out.queue);
}

/* All slots have been given up. */
static bool all_gone(const struct fan *f)
{
    for (int k = 0; k < f->n_slots; k++)
        if (fan_slot_comes(&f->slots[k])) return false;
    return true;
}

/* The number of slots that never were up, without those that leave, and those on this machine that
 * did not fail. */
static int never_up(const struct fan *f)
{
    int n = 0;
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        if (!s->was_up && !s->drains && (!s->host->here || s->failures)) n += s->width;
    }
    return n;
}

/* True if work remains, or would have remained, without a slot to do it. */
static bool deserted(const struct fan *f)
{
    bool lost = f->lost || never_up(f) == fan_staff(f);
    bool nobody = !f->well && (f->unreached || (lost && all_gone(f)));
    return !f->refused && !f->out.gone && !signals_came() && (f->in_open || nobody);
}

/* Sends bye to the reader. */
static void say_bye(struct fan *f)
{
    char text[FAN_PATIENCE_TEXT];
    bool none = !f->disputed && deserted(f);
    wire_bye(&f->out.queue.bulk, f->disputed ? "other-jobs" : none ? "no-slot-left" : "");
    up_end_record(&f->out.queue);
    outlet_drain(&f->out);
    if (none && all_gone(f)) warn("no slot left");
    else if (none) warn("no slot left: none could be reached for %s", fan_patience_text(f, text));
    int missing = never_up(f), queued = 0;
    for (int k = 0; k < f->n_slots; k++)
        if (f->slots[k].state == FAN_QUEUED && !f->slots[k].was_up) queued += f->slots[k].width;
    if (none || !f->asked || !missing) return;
    if (queued) warn("%d of %d slots never connected; %d queued", missing, fan_staff(f), queued);
    else warn("%d of %d slots never connected", missing, fan_staff(f));
}

static int status_of(const struct fan *f)
{
    if (f->refused) return f->refused;
    if (f->dismissed) return ST_OK;
    if (f->out.gone || f->disputed || deserted(f)) return ST_SYSTEM;
    return f->lost || f->failed ? ST_PARTIAL : ST_OK;
}

int fan_run(const struct fan_options *o)
{
    struct fan f;
    signals_catch();
    fan_open(&f, o, false);
    outlet_open(&f.out);
    while (fan_working(&f)) {
        fan_round(&f);
        fan_join(&f);
    }
    stop(&f);
    if (!f.refused && !f.dismissed) say_bye(&f);
    int status = status_of(&f);
    if (f.stale)
        warn("%" PRId64 " answers were dropped, because nothing had asked for them", f.stale);
    fan_close(&f);
    if (signals_came()) signals_die();
    return status;
}
