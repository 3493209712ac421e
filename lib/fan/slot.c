/*
 * fan: the life of a slot.
 *
 *   state    meaning                            leaves it when
 *   WAITING  no process                         it is its turn: -> OPENING; it cannot be started:
 *                                               -> WAITING, GONE
 *   OPENING  a process that has not said hello  its hello is good: -> UP; it is refused, says no
 *                                               hello in time, its stream ends: -> LEAVING
 *   UP       a worker                           its stream ends, it is silent or wrong: -> LEAVING
 *   LEAVING  a process that is to exit          it has exited, or was killed after its deadline:
 *                                               -> WAITING to be connected again, or GONE
 *   GONE     nothing                            never
 *
 * A slot on another machine is connected again if its connection failed: ssh exits with 255 or is
 * killed, or the slot is silent. So is a slot that has lost its own worker and reports that by its
 * status. Once a slot is LEAVING, nothing more is read from its connection. Tasks sent over a
 * connection are lost with it. Tasks for a slot that was never up wait for it; therefore nothing is
 * sent over a connection before its hello.
 * One machine with connect.c, down.c, err.c, hello.c, refusal.c and up.c.
 */
#include "fan/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <sys/wait.h>

#define GRACE_US 500000      /* for a worker to exit once its stream has ended */
#define STOP_US 200000       /* for a slot that was given up and told to end */
#define VIA_FAILED 255       /* ssh's status for its own failures */
#define ASK_AGAIN_US 5000000 /* fan -l: a slot that failed within this time is asked once more */
#define DEATHS_MOST 5 /* connections in a row that lost tasks and did none: it is no accident */

/* It is being connected, or failed to connect for a reason that is not known yet. */
static bool connects(const struct fan_slot *s, enum fan_state state)
{
    return state == FAN_OPENING || (state == FAN_LEAVING && !s->connected);
}

static void enter(struct fan *f, struct fan_slot *s, enum fan_state state)
{
    int opening = connects(s, state) - connects(s, s->state);
    f->n[s->state]--;
    f->n[state]++;
    if (!s->host->here) f->connecting += opening;
    s->host->opening += opening;
    s->state = state;
}

bool fan_slot_wanted(const struct fan *f, const struct fan_slot *s)
{
    if (f->listing) return !s->measured;
    return f->in_open || s->tasks.count || s->host->here;
}

bool fan_slot_comes(const struct fan_slot *s)
{
    return s->state != FAN_GONE && !(s->state == FAN_LEAVING && s->loss_reported && !s->reconnect);
}

void fan_slot_free(struct fan_slot *s)
{
    down_free(&s->down);
    tasks_free(&s->tasks);
    s->primed = s->behind = s->loading = s->flushed = false;
    memset(s->sent, 0, sizeof s->sent);
    s->undone = 0;
}

/* The process has ended. */
static void settle(struct fan *f, struct fan_slot *s)
{
    fan_slot_end_err(f, s);
    fan_slot_show_held(s);
    wire_free(&s->from);
    if (s->reconnect) {
        s->retry_us = now_us() + fan_retry_wait_us(s->failures);
        enter(f, s, FAN_WAITING);
    } else {
        fan_slot_free(s);
        enter(f, s, FAN_GONE);
    }
}

void fan_slot_open(struct fan *f, struct fan_slot *s)
{
    wire_free(&s->from);
    s->from.upward = true;
    s->connected = s->loaded = s->input_closed_first = s->loss_reported = s->reconnect = false;
    s->completed_task = s->placed = false;
    s->agreed = -1;
    s->stale = 0;
    s->ahead = 0;
    s->before_hello = 0;
    s->closed_us = 0;
    *s->chatter = '\0';
    fan_refusal_forget(s);
    s->opened_us = s->heard_us = now_us();
    enter(f, s, FAN_OPENING);
    if (s->host->here && !s->primed) fan_prime_early(f, s);
    int failed = s->host->here ? child_start(&s->child, s->host->argv)
                               : child_start_apart(&s->child, s->host->argv);
    if (!failed) return;
    if (s->host->said == FAN_QUIET)
        warn("%s: %s%s", s->host->argv[0], strerror(errno), s->host->here ? "" : "; trying again");
    s->host->said = FAN_RETRIED;
    fan_slot_lose(f, s, "not-started", true);
}

void fan_slot_up(struct fan *f, struct fan_slot *s)
{
    char text[HOST_NAME_MOST + 64], name[SLOT_NAME];
    if (s->told_gone) warn("%s: is up", fan_slot_name(s, name));
    fan_slot_show_held(s);
    s->connected = s->was_up = s->host->reached = true;
    s->told_gone = false;
    if (!s->host->here) s->host->said = FAN_QUIET;
    s->host->failures = 0;
    s->host->retry_us = 0;
    s->heard_us = now_us();
    if (s->closed_us) s->closed_us = s->heard_us;
    enter(f, s, FAN_UP);
    if (!s->primed && fan_slot_wanted(f, s)) fan_prime_early(f, s);
    snprintf(text, sizeof text, "w=%d host=%s power=%.6g slots=%d", s->number, s->host->host->name,
        s->power, s->inner);
    wire_plain(&f->out.queue.bulk, REC_UP, text);
    up_end_record(&f->out.queue);
}

int fan_slot_send(struct fan *f, int k, const struct record *r, const struct frame_size *frame)
{
    static const char *const drop[] = {"to", NULL};
    struct fan_slot *s = &f->slots[k];
    int64_t from;
    if (s->state == FAN_GONE || (s->was_up && s->state != FAN_UP)) {
        f->lost++;
        return 0;
    }
    int32_t i = tasks_find(&s->tasks, r->task.frame, r->task.id);
    if (i >= 0) { /* the same task is under way */
        if (memcmp(&s->tasks.at[i].task.at, &r->task.at, sizeof r->task.at) == 0) return 0;
        warn("task %u %u: comes twice, expected another number for other pixels", r->task.frame,
            r->task.id);
        return ST_USAGE;
    }
    if (!s->primed || s->behind || (int32_t)(frame->generation - s->since) < 0)
        fan_prime(f, s, frame->generation);
    i = tasks_add(&s->tasks, &r->task, frame->w);
    s->tasks.at[i].since_us = now_us() - f->start_us;
    if (rec_int(r, "peer", 0, WIRE_SLOTS_MAX - 1, &from)) s->tasks.at[i].slot = (int32_t)from;
    s->undone++;
    s->ahead--;
    if (fan_takes(s)) wire_forward(&s->down.bytes, r, drop, NULL);
    return 0;
}

bool fan_slot_fed(const struct fan_slot *s)
{
    return s->state == FAN_UP || (s->state == FAN_OPENING && s->host->here);
}

void fan_slot_feed(struct fan *f, struct fan_slot *s, const struct pollfd *p)
{
    bool full = p->events & POLLOUT && !(p->revents & POLLOUT);
    size_t before = down_size(&s->down);
    if (p->revents & POLLERR || (!full && down_write(&s->down, s->child.to) != 0)) {
        /* It reads no more. Its output explains why, or has pixels to come. */
        child_close(&s->child.to);
        down_free(&s->down);
        return;
    }
    /* A pipe that was empty takes a little even if its reader does not read. */
    if (p->events & POLLOUT && down_size(&s->down) != before) s->heard_us = now_us();
    if (!f->in_open && !down_size(&s->down)) {
        if (s->child.to >= 0) s->closed_us = now_us();
        child_close(&s->child.to);
    }
}

/* Reports the loss of the slot, and decides whether to connect it again. */
static void decide(struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    char name[SLOT_NAME];
    s->failures = s->completed_task ? 1 : s->failures + 1;
    if (s->completed_task) s->deaths = 0;
    else if (s->connected && s->tasks.count) s->deaths++;
    s->reconnect = again && !s->host->here && s->deaths < DEATHS_MOST;
    s->loss_reported = true;
    bool more = s->reconnect && s->failures <= 1 && !s->host->failures;
    s->measured |= !more || now_us() - s->opened_us > ASK_AGAIN_US;
    int32_t lost = s->connected || !s->reconnect ? s->tasks.count : 0;
    fan_say_gone(f, s, why, lost);
    if (!s->connected && !s->host->here) fan_host_failed(f, s, why, s->reconnect);
    else if (strcmp(why, "not-started") != 0 && (lost || f->in_open))
        warn("%s: lost (%s) with %" PRId32 " tasks%s", fan_slot_name(s, name), why, lost,
            s->reconnect ? ", connecting again" : "");
    f->lost += lost;
    if (s->connected) s->missing_us = now_us();
    if (s->connected || !s->reconnect) fan_slot_free(s);
}

void fan_slot_give_up(struct fan *f, struct fan_slot *s, const char *why)
{
    fan_say_gone(f, s, why, s->tasks.count);
    f->lost += s->tasks.count;
    s->measured = true;
    fan_slot_free(s);
    enter(f, s, FAN_GONE);
}

void fan_slot_lose(struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    decide(f, s, why, again);
    child_stop(&s->child);
    s->leave_us = now_us() + STOP_US;
    enter(f, s, FAN_LEAVING);
    if (!s->child.pid) settle(f, s);
}

void fan_slot_leave(struct fan *f, struct fan_slot *s)
{
    s->input_closed_first = s->child.to < 0 && !f->in_open; /* then it was to end */
    s->leave_us = now_us() + GRACE_US;
    enter(f, s, FAN_LEAVING);
}

void fan_slot_left(struct fan *f, struct fan_slot *s)
{
    char why[24];
    int status;
    if (!child_ended(&s->child, &status)) {
        if (now_us() < s->leave_us) return;
        fan_slot_end_err(f, s);
        status = child_end(&s->child, 0);
    }
    fan_slot_end_err(f, s); /* before it is judged by that */
    bool well =
        s->input_closed_first && !s->tasks.count && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    bool connection = WIFSIGNALED(status) ||
                      (WEXITSTATUS(status) == VIA_FAILED && !fan_refusal_is_final(s)) ||
                      (s->connected && WEXITSTATUS(status) == ST_SYSTEM);
    if (!s->loss_reported && well) f->well++;
    else if (!s->loss_reported) decide(f, s, status_text(status, why), connection);
    settle(f, s);
}
