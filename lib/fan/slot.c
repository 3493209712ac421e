/*
 * fan: the life of a slot. `transitions` has the state that follows each event; `change` alone sets
 * states. Their meanings are in fan_int.h.
 *
 *   event       happens when                                      then
 *   ON_START    it is the slot's turn                             a process is started
 *   ON_QUEUE    it has been silent, and its host has wait=        `gone` is reported
 *   ON_HELLO    its hello agrees with the first                   `up` is reported; it gets records
 *   ON_EOF      its stream ends                                   its process may end by itself
 *   ON_RETRY    its connection has failed                         `gone` is reported; its process
 *   ON_LOSS     likewise, or it is wrong, and no try will follow  is stopped; its tasks are lost
 *   ON_EXIT     its process has exited, or was killed             the connection is reset
 *   ON_GIVE_UP  its host cannot be used                           `gone` is reported; its tasks are
 *                                                                 lost
 *
 * A connection has failed if ssh exits with 255 or is killed, or if a slot on another machine is
 * silent. It has failed as well if the slot reports by its status that it has lost its own worker.
 * Once a slot of the host was sent tasks, and while more may come, any status but 126 and 127
 * means that: a launcher whose job was ended chooses its own. On this machine it means that
 * after the hello, unless a worker refuses its input (status 2). Of a launcher other than ssh, any
 * such status but 0 also means that before the first hello: a container may start later.
 * After ON_EOF, ON_RETRY and ON_LOSS nothing is read from it. ON_RETRY loses only tasks that were
 * sent. Tasks for a slot that was never up wait for it; therefore nothing is sent to another
 * machine before the slot's hello.
 */
#include "fan/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#define VIA_FAILED 255 /* ssh's status for its own failures */
#define NOT_RUN 126    /* a shell's status for a command that it cannot run */
#define NOT_FOUND 127  /* and for one that it does not find */
#define DEATHS_MOST 5  /* connections in a row that lost tasks and did none: no accident */

/* An event that a row does not name cannot happen in that state: FAN_NEVER. */
static const enum fan_slot_state transitions[FAN_SLOT_STATES][FAN_SLOT_EVENTS] = {
    [FAN_WAITING] = {[ON_START] = FAN_OPENING, [ON_GIVE_UP] = FAN_GONE},
    [FAN_OPENING] = {[ON_QUEUE] = FAN_QUEUED,
        [ON_HELLO] = FAN_UP,
        [ON_EOF] = FAN_CLOSED,
        [ON_RETRY] = FAN_LOST,
        [ON_LOSS] = FAN_ENDING},
    [FAN_QUEUED] =
        {[ON_HELLO] = FAN_UP, [ON_EOF] = FAN_CLOSED, [ON_RETRY] = FAN_LOST, [ON_LOSS] = FAN_ENDING},
    [FAN_UP] = {[ON_EOF] = FAN_CLOSED, [ON_RETRY] = FAN_LOST, [ON_LOSS] = FAN_ENDING},
    [FAN_CLOSED] = {[ON_RETRY] = FAN_LOST, [ON_LOSS] = FAN_ENDING, [ON_EXIT] = FAN_GONE},
    [FAN_LOST] = {[ON_EXIT] = FAN_WAITING},
    [FAN_ENDING] = {[ON_EXIT] = FAN_GONE},
};

static const char *const state_names[FAN_SLOT_STATES] = {
    "never", "waiting", "opening", "queued", "up", "closed", "lost", "ending", "gone"};
static const char *const event_names[FAN_SLOT_EVENTS] = {
    "start", "queue", "hello", "end of stream", "retry", "loss", "exit", "giving up"};

enum fan_slot_state fan_slot_next(enum fan_slot_state state, enum fan_slot_event event)
{
    return transitions[state][event];
}

static bool leaves(enum fan_slot_state state)
{
    return state == FAN_CLOSED || state == FAN_LOST || state == FAN_ENDING;
}

/* It is being connected, or failed to connect and its process has not ended. */
static bool connects(const struct fan_slot *s, enum fan_slot_state state)
{
    return state == FAN_OPENING || (leaves(state) && !s->conn.connected);
}

static void change(struct fan *f, struct fan_slot *s, enum fan_slot_event event)
{
    enum fan_slot_state state = fan_slot_next(s->state, event);
    if (state == FAN_NEVER)
        die(ST_SYSTEM, "slot %d: internal error: %s in state %s", s->number, event_names[event],
            state_names[s->state]);
    int opening = connects(s, state) - connects(s, s->state);
    f->n[s->state]--;
    f->n[state]++;
    if (fan_host_limited(s->host)) f->connecting += opening;
    if (s->host->jump) f->jumps[s->host->jump - 1].opening += opening;
    s->host->opening += opening;
    s->state = state;
}

bool fan_slot_leaves(const struct fan_slot *s) { return leaves(s->state); }

void fan_slot_forget(struct fan_slot *s)
{
    down_free(&s->feed.queue);
    s->feed = (struct feed){0};
    for (int i = 0; i < s->width; i++) tasks_free(&s->tasks[i]);
    s->n_tasks = s->undone = 0;
}

void fan_slot_init(struct fan *f, int at, int number, int width, struct fan_host *h)
{
    struct fan_slot *s = &f->slots[at];
    *s = (struct fan_slot){.number = number,
        .width = width,
        .host = h,
        .state = FAN_WAITING,
        .conn = CONNECTION_NONE,
        .power = h->host->power,
        .measured = h->host->power > 0 && !f->o->trips,
        .missing_us = now_us()};
    s->tasks = xcalloc((size_t)width, sizeof *s->tasks);
    for (int i = 0; i < width; i++) tasks_init_slot(&s->tasks[i], sizeof(struct fan_task));
}

void fan_slot_free(struct fan_slot *s) { free(s->tasks); }

void fan_slot_disconnect(const struct fan *f, struct fan_slot *s)
{
    fan_slot_end_err(f, s);
    fan_slot_show_held(s);
    child_end(&s->conn.child, 0);
    wire_free(&s->conn.from);
    buf_free(&s->conn.held);
    down_free(&s->conn.sending.queue);
    s->conn = CONNECTION_NONE;
}

/* The process has ended. */
static void settle(struct fan *f, struct fan_slot *s)
{
    change(f, s, ON_EXIT);
    fan_slot_disconnect(f, s);
    if (s->state == FAN_WAITING && s->drains) fan_slot_give_up(f, s, "left");
    else if (s->state == FAN_GONE) fan_slot_forget(s);
    else s->retry_us = now_us() + fan_retry_wait_us(s->host, s->failures);
    if (s->state != FAN_WAITING) return;
    f->n_by_ssh -= s->host->by_ssh;
    fan_succeed(f->o, s->host);
    f->n_by_ssh += s->host->by_ssh;
}

void fan_slot_open(struct fan *f, struct fan_slot *s)
{
    change(f, s, ON_START);
    s->conn.opened_us = s->conn.heard_us = now_us();
    if (s->host->here && !s->feed.primed) fan_prime_early(f, s);
    struct child *c = &s->conn.child;
    char *const *argv = s->host->argv;
    int failed = s->host->here ? child_start(c, argv) : child_start_apart(c, argv);
    if (!failed) return;
    if (s->host->said == FAN_QUIET)
        warn("%s: %s%s", argv[0], strerror(errno), s->host->here ? "" : "; trying again");
    s->host->said = FAN_RETRIED;
    fan_slot_lose(f, s, "not-started", !s->host->here || s->host->reached);
}

void fan_slot_queue(struct fan *f, struct fan_slot *s)
{
    struct fan_host *h = s->host;
    change(f, s, ON_QUEUE);
    if (!h->told_queued)
        warn("%s: queued by its launcher; waiting for up to %g s", h->host->name, h->host->wait_s);
    h->told_queued = true;
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *other = &f->slots[k];
        if (other == s || (other->host == h && other->state == FAN_WAITING))
            fan_say_gone(f, other, "queued", false);
    }
}

static void say_up(struct fan *f, const struct fan_slot *s)
{
    char text[HOST_NAME_MOST + 64];
    for (int i = 0; i < s->width; i++) {
        snprintf(text, sizeof text, "w=%d host=%s power=%.6g slots=%d%s", s->number + i,
            s->host->host->name, s->power, s->inner, s->host->host->power > 0 ? " stated=1" : "");
        wire_plain(&f->out.queue.bulk, REC_UP, text);
        up_end_record(&f->out.queue);
    }
}

void fan_slot_set_power(struct fan *f, struct fan_slot *s, double power)
{
    if (!(power < s->power) && !(power > s->power)) return;
    s->power = power;
    if (s->state == FAN_UP && !s->drains) say_up(f, s);
}

void fan_slot_up(struct fan *f, struct fan_slot *s)
{
    char name[SLOT_NAME];
    if (s->told_gone && !s->repeats)
        warn("%s: %s up", fan_slot_name(s, name), s->width > 1 ? "are" : "is");
    fan_slot_show_held(s);
    change(f, s, ON_HELLO);
    s->conn.connected = s->was_up = s->host->reached = true;
    s->told_gone = s->host->told_queued = false;
    s->host->given |= s->n_tasks > 0;
    if (!s->host->here) s->host->said = FAN_QUIET;
    s->host->failures = 0;
    s->host->retry_us = 0;
    s->conn.heard_us = now_us();
    if (s->conn.closed_us) s->conn.closed_us = s->conn.heard_us;
    if (!s->feed.primed && fan_slot_wanted(f, s)) fan_prime_early(f, s);
    say_up(f, s);
}

int fan_slot_send(struct fan *f, int k, const struct record *r, const struct frame_size *frame)
{
    struct fan_slot *s = fan_slot_of(f, k);
    struct task_table *tasks = &s->tasks[k - s->number];
    int64_t from;
    bool left = s->drains && (s->state != FAN_UP || fan_slot_over(f, s));
    if (!fan_slot_comes(s) || left || (s->was_up && s->state != FAN_UP)) {
        f->lost++;
        return 0;
    }
    int32_t i = tasks_find(tasks, r->task.frame, r->task.id);
    if (i >= 0 && memcmp(&tasks->at[i].task.at, &r->task.at, sizeof r->task.at) != 0) {
        warn("task %u %u: number used twice, expected another for other pixels", r->task.frame,
            r->task.id);
        return ST_USAGE;
    }
    if (i >= 0 && !fan_task(tasks, i)->computed) return 0; /* the same task is under way */
    if (!s->feed.primed || s->feed.behind || (int32_t)(frame->generation - s->feed.since) < 0)
        fan_prime(f, s, frame->generation);
    s->n_tasks += i < 0;
    if (i < 0) i = tasks_add(tasks, &r->task, frame->w); /* else its pixels are held back */
    bool stolen = rec_int(r, "peer", 0, WIRE_SLOTS_MAX - 1, &from);
    *fan_task(tasks, i) =
        (struct fan_task){.sent_us = now_us() - f->start_us, .from = stolen ? (int32_t)from : -1};
    s->undone++;
    s->feed.flushed = false; /* it may hold back the pixels of this one */
    if (fan_slot_has_stream(s)) s->conn.ahead--;
    s->host->given |= s->state == FAN_UP;
    if (fan_takes(s)) fan_pass_down(&s->feed.queue.bytes, r, s, k);
    return 0;
}

void fan_slot_feed(struct fan *f, struct fan_slot *s, const struct pollfd *p)
{
    bool full = p->events & POLLOUT && !(p->revents & POLLOUT);
    size_t before = down_size(&s->feed.queue);
    if (p->revents & POLLERR || (!full && down_write(&s->feed.queue, s->conn.child.to) != 0)) {
        /* It reads no more. Its output explains why, or has pixels to come. */
        child_close(&s->conn.child.to);
        down_free(&s->feed.queue);
        return;
    }
    /* A pipe that was empty takes a little even if its reader does not read. */
    if (p->events & POLLOUT && down_size(&s->feed.queue) != before) s->conn.heard_us = now_us();
    if (fan_slot_over(f, s) && !down_size(&s->feed.queue)) {
        if (s->conn.child.to >= 0) s->conn.closed_us = now_us();
        child_close(&s->conn.child.to);
    }
}

void fan_slot_give_up(struct fan *f, struct fan_slot *s, const char *why)
{
    change(f, s, ON_GIVE_UP);
    fan_say_gone(f, s, why, true);
    f->lost += s->n_tasks;
    s->measured = true;
    fan_slot_forget(s);
}

/*
 * Slot s could not be connected: prints the reason once per host, with advice. Other waiting slots
 * of the host are reported as gone; without a retry (`again`) they are given up.
 */
static void host_failed(struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    struct fan_host *h = s->host;
    s->repeats = false;
    bool ends = !again && (!h->reached || fan_host_exhausted(h));
    if (h->said == FAN_QUIET || (h->said == FAN_RETRIED && ends)) fan_complain(f, s, why, again);
    else fan_refusal_forget(s);
    h->said = again ? FAN_RETRIED : FAN_ENDED;
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *other = &f->slots[k];
        if (other->host != h || other->state != FAN_WAITING) continue;
        other->measured |= s->measured;
        if (again) fan_say_gone(f, other, why, false);
        else if (ends) fan_slot_give_up(f, other, why);
    }
}

/* ssh has no status for a worker that a signal has ended: it ends with 255, and prints nothing. */
static bool killed(const struct fan_slot *s, const char *why)
{
    const char *via = s->host->host->via;
    return !s->host->here && s->conn.connected && !s->conn.told_end &&
           strcmp(why, "exit-255") == 0 && (!via || strstr(via, "ssh"));
}

/* The host cannot be used. That is no reason to give up its rack, if another one may lead that. */
static bool leaves_an_heir(struct fan_slot *s)
{
    struct host *rack = s->host->host;
    if (!host_heir(rack)) return false;
    rack->members[rack->head].unusable = true;
    return true;
}

/* Reports the loss of the slot, and decides whether to connect it again. */
static void lose(struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    s->failures = s->conn.completed_task ? 1 : s->failures + 1;
    if (s->conn.completed_task) s->deaths = 0;
    else if (s->conn.connected && s->n_tasks && !fan_excuse(f, s)) s->deaths++;
    int most = s->host->host->tries ? s->host->host->tries : DEATHS_MOST;
    const int heads = fan_host_heads(s->host);
    bool first = s->failures <= heads && s->host->failures < heads;
    /* Only policies whose slots may come back start workers of this machine again. */
    again &= !s->host->here || s->width > 1 || (s->conn.connected && f->joins);
    again &= s->deaths < most && !s->drains;
    if (!again && !s->drains) again = leaves_an_heir(s);
    if (again && !s->conn.connected && !s->host->here) again = fan_host_retries(s);
    change(f, s, again ? ON_RETRY : ON_LOSS);
    bool more = again && first;
    bool slow = now_us() - s->conn.opened_us > PATIENCE_ASK_AGAIN_US;
    s->measured |= !more || (slow && !host_heir(s->host->host));
    int32_t lost = s->conn.connected || !again ? s->n_tasks : 0;
    fan_say_gone(f, s, why, lost);
    if (s->drains && !s->conn.connected) fan_refusal_forget(s);
    else if (!s->conn.connected && !s->host->here) host_failed(f, s, why, again);
    else if (strcmp(why, "not-started") != 0 && (lost || (f->in_open && !s->drains)))
        fan_say_lost(s, why, lost, again,
            killed(s, why)
                ? "; ssh says no reason: killed there, as the kernel does when memory is short"
                : status_hint(why));
    f->lost += lost;
    if (s->conn.connected) {
        s->missing_us = now_us();
        if (!s->repeats) memset(s->host->told, 0, sizeof s->host->told);
    }
    if (s->conn.connected || !again) fan_slot_forget(s);
}

void fan_slot_lose(struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    lose(f, s, why, again);
    child_stop(&s->conn.child);
    s->conn.leave_us = now_us() + (s->host->here ? PATIENCE_STOP_US : PATIENCE_LAUNCHER_US);
    if (!s->conn.child.pid) settle(f, s);
}

void fan_slot_leave(struct fan *f, struct fan_slot *s)
{
    change(f, s, ON_EOF);
    s->conn.input_closed_first = s->conn.child.to < 0 && fan_slot_over(f, s); /* it was to end */
    s->conn.leave_us = now_us() + PATIENCE_EXIT_US;
}

/* Decides by the exit status of its process whether the slot has ended as it was told to, or is
 * lost. */
static void judge(struct fan *f, struct fan_slot *s, int status)
{
    char why[24];
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    bool done = code == ST_OK || (code == ST_PARTIAL && s->conn.connected); /* some may fail */
    bool well = s->conn.input_closed_first && !s->n_tasks && done;
    bool here = s->host->here, ssh = s->host->by_ssh, runs = code != NOT_RUN && code != NOT_FOUND;
    bool used = here ? s->conn.connected && code != ST_USAGE : s->host->given || !ssh;
    bool worked = runs && f->in_open && used;
    bool unready = runs && code && !here && !ssh && !s->conn.connected;
    bool connection = WIFSIGNALED(status) || worked || unready ||
                      (code == VIA_FAILED && !fan_refusal_is_final(s)) ||
                      (s->conn.connected && code == ST_SYSTEM);
    if (well && s->drains) fan_say_gone(f, s, "left", false);
    else if (well) f->well++;
    else lose(f, s, status_text(status, why), connection);
}

void fan_slot_left(struct fan *f, struct fan_slot *s)
{
    int status;
    if (!child_ended(&s->conn.child, &status)) {
        if (now_us() < s->conn.leave_us) return;
        fan_slot_end_err(f, s);
        status = child_end(&s->conn.child, 0);
    }
    fan_slot_end_err(f, s); /* before it is judged by that */
    if (s->state == FAN_CLOSED) judge(f, s, status);
    settle(f, s);
}
