/*
 * fan: records from workers. They are checked against what the workers were sent, stamped, and
 * passed on.
 */
#include "fan/fan_int.h"

#include <inttypes.h>
#include <string.h>

#define CHATTER_MOST 65536 /* bytes before hello, which start-up files may print */
/* Limit of unsolicited answers per connection, and of messages. An inner policy sends some for each
 * late copy, so STALE_TIMES more are allowed for each solicited answer. */
#define STALE_MOST 1000
#define STALE_TIMES 4
#define NEWS_TIMES 4 /* a worker may announce each frame again after it was lost */
#define SAID_MAX (WIRE_LINE_MAX - HOST_NAME_MOST - 128) /* bytes of a line without its stamps */

static const char *const stamped[] = {"w", "host", "from", "sent_us", "recv_us", NULL};

/* The number of the slot that sent r: the entry's first one, or with fan -1 that of w=I. -1: it has
 * no such slot. */
static int number_of(const struct fan_slot *s, const struct record *r)
{
    int32_t i = s->width > 1 ? rec_slot(r) : 0;
    return i >= 0 && i < s->width ? s->number + i : -1;
}

/* The tasks of that slot, or NULL. */
static struct task_table *tasks_of(const struct fan_slot *s, const struct record *r)
{
    int k = number_of(s, r);
    return k < 0 ? NULL : &s->tasks[k - s->number];
}

/* " w=K", or "w=K.I" if an inner fan had stamped w=I. */
static void stamp(const struct fan_slot *s, const struct record *r, char *text, size_t size)
{
    size_t n = 0;
    int k = number_of(s, r);
    const char *inner = rec_key(r, "w", &n);
    if (s->width > 1 && inner) { /* the first number is in K */
        const char *dot = memchr(inner, '.', n);
        n -= dot ? (size_t)(dot + 1 - inner) : 0;
        inner = dot ? dot + 1 : NULL;
    }
    if (k < 0) k = s->number;
    if (inner) snprintf(text, size, "w=%d.%.*s", k, (int)n, inner);
    else snprintf(text, size, "w=%d", k);
}

/* Appends " recv_us=T": now, in the time of the run. */
static void stamp_time(const struct fan *f, char *text, size_t size)
{
    size_t n = strlen(text);
    snprintf(text + n, size - n, " recv_us=%" PRId64, now_us() - f->start_us);
}

/* More beats carry no more information: a slot that sends many does not fill a log. */
static void pass_beat(struct fan *f, struct fan_slot *s, const struct record *r)
{
    char text[96];
    int64_t now = now_us();
    if (now - s->conn.beat_us < PATIENCE_BEAT_PASSED_US) return;
    s->conn.beat_us = now;
    stamp(s, r, text, sizeof text);
    wire_forward(&f->out.queue.control, r, stamped, text);
}

/* The number of slots, except slot s that is about to be lost, that may still announce the
 * frame. */
static int may_announce(const struct fan *f, const struct fan_job *known)
{
    int n = 0;
    for (int k = 0; k < f->n_slots; k++) n += fan_slot_comes(&f->slots[k]);
    return n - 1 - known->agree;
}

/*
 * Slot s reports another job for a frame than the first slot did. If most slots disagree with the
 * first, or as many as agree and none is left to report, the first may be the wrong one. Then the
 * pixels so far are useless, and the run ends.
 */
static const char *dispute(
    struct fan *f, const struct fan_slot *s, const struct frame_size *frame, const char *job)
{
    struct fan_job *known = fan_job(f, frame);
    char name[SLOT_NAME], first[SLOT_NAME];
    fan_slot_name(s, name);
    if (known->by < 0) {
        warn("%s: frame %" PRIu32 " has job %s there, expected %s: the same scene, with the same "
             "options",
            name, frame->frame, job, known->hash);
        return "other-job";
    }
    known->differ++;
    warn("%s: frame %" PRIu32 " has job %s there, expected %s as on %s, which sent it first", name,
        frame->frame, job, known->hash, fan_slot_name(fan_slot_of(f, known->by), first));
    int to_come = may_announce(f, known);
    if (known->differ > known->agree || (known->differ == known->agree && to_come <= 0)) {
        f->disputed = true;
        warn("frame %" PRIu32 ": %" PRId32 " with job %s, %" PRId32
             " with another: the run ends, expected "
             "one scene, with the same options, on all",
            frame->frame, known->agree, known->hash, known->differ);
    }
    return "other-job";
}

/* Checks that all slots report the same job for a frame. The first to report it is believed. */
static const char *take_job(
    struct fan *f, struct fan_slot *s, const struct frame_size *frame, const struct record *r)
{
    struct fan_job *known = fan_job(f, frame);
    char job[sizeof known->hash];
    if (!rec_str(r, "job", job, sizeof job)) return "wrong-frame";
    if (!known->stated) {
        memcpy(known->hash, job, sizeof job);
        known->by = s->number;
        known->agree = known->differ = 0;
        known->vote = ++f->n_votes;
    }
    known->stated = true;
    if (strcmp(known->hash, job) != 0) return dispute(f, s, frame, job);
    /* A tree reports it for each of its workers, and for those of other frames in between. */
    if (s->agreed < known->vote) {
        known->agree++;
        s->agreed = known->vote;
    }
    return NULL;
}

/* A slot that announces more than it can have to is lost, because all of it goes to the log. */
static const char *take_news(const struct fan *f, struct fan_slot *s)
{
    int64_t most = STALE_MOST + NEWS_TIMES * s->width * s->inner * f->n_frames;
    return ++s->conn.news > most ? "unasked" : NULL;
}

/*
 * A requested frame is announced: the slot has loaded the state. The record keeps its place among
 * the pixels, because those before it may belong to another job. A worker with several slots has
 * announced it for all of them.
 */
static const char *take_frame(struct fan *f, struct fan_slot *s, const struct record *r)
{
    char text[HOST_NAME_MOST + 96];
    const struct frame_size *asked = frames_find(&f->input.frames, r->task.frame);
    if (!asked || asked->w != r->frame_w || asked->h != r->frame_h) return "wrong-frame";
    const char *why = take_job(f, s, asked, r);
    if (!why) why = take_news(f, s);
    if (why) return why;
    s->conn.announced_frame = true;
    s->feed.loading = false;
    for (int i = 0; i < s->width; i++) {
        if (s->width == 1) stamp(s, r, text, sizeof text);
        else snprintf(text, sizeof text, "w=%d", s->number + i);
        size_t n = strlen(text);
        snprintf(text + n, sizeof text - n, " host=%s", s->host->host->name);
        stamp_time(f, text, sizeof text);
        up_forward(&f->out.queue, r, stamped, text);
    }
    return NULL;
}

static void remove_task(struct fan_slot *s, struct task_table *tasks, int32_t i)
{
    tasks_remove(tasks, i);
    if (!--s->n_tasks) s->feed.flushed = false;
}

/* Removes the task if it is both computed and delivered. */
static void complete_task(struct fan_slot *s, struct task_table *tasks, int32_t i)
{
    if (!fan_task(tasks, i)->computed || !tasks_whole(tasks, i)) return;
    remove_task(s, tasks, i);
    s->conn.completed_task = true;
}

/* Counts an answer to no question, or pixels that came before. A slot that sends too many is lost,
 * so that others get its tasks. */
static const char *count_stale(struct fan_slot *s)
{
    return ++s->conn.stale > STALE_MOST + STALE_TIMES * s->conn.answers ? "unasked" : NULL;
}

/* Drops an answer to no question. */
static const char *take_stale(struct fan *f, struct fan_slot *s)
{
    f->stale++;
    return count_stale(s);
}

static const char *take_done(struct fan *f, struct fan_slot *s, const struct record *r)
{
    struct task_table *tasks = tasks_of(s, r);
    int32_t i = tasks ? tasks_find(tasks, r->task.frame, r->task.id) : -1;
    if (i < 0 || fan_task(tasks, i)->computed) return take_stale(f, s);
    struct fan_task *task = fan_task(tasks, i);
    char w[96], from[24] = "", text[184];
    stamp(s, r, w, sizeof w);
    if (task->from >= 0) snprintf(from, sizeof from, " from=%" PRId32, task->from);
    snprintf(text, sizeof text, "%s%s sent_us=%" PRId64, w, from, task->sent_us);
    stamp_time(f, text, sizeof text);
    wire_forward(&f->out.queue.control, r, stamped, text);
    task->computed = true;
    fan_job(f, frames_find(&f->input.frames, r->task.frame))->well = true;
    s->undone--;
    s->conn.answers++;
    complete_task(s, tasks, i);
    return NULL;
}

/* The slot cannot compute the task, and goes on with others. */
static const char *take_fail(struct fan *f, struct fan_slot *s, const struct record *r)
{
    struct task_table *tasks = tasks_of(s, r);
    int32_t i = tasks ? tasks_find(tasks, r->task.frame, r->task.id) : -1;
    char text[HOST_NAME_MOST + 184];
    if (i < 0) return take_stale(f, s);
    stamp(s, r, text, sizeof text);
    size_t n = strlen(text);
    snprintf(text + n, sizeof text - n, " host=%s", s->host->host->name);
    stamp_time(f, text, sizeof text);
    wire_forward(&f->out.queue.control, r, stamped, text);
    f->failed++;
    s->undone -= !fan_task(tasks, i)->computed;
    s->conn.answers++;
    s->conn.completed_task = true; /* it is well */
    remove_task(s, tasks, i);
    return NULL;
}

static const char *take_frag(struct fan *f, struct fan_slot *s, const struct record *r)
{
    struct task_table *tasks = tasks_of(s, r);
    int32_t i = tasks ? tasks_find(tasks, r->task.frame, r->task.id) : -1;
    if (i < 0) return take_stale(f, s);
    const struct fan_job *known = fan_job(f, frames_find(&f->input.frames, r->task.frame));
    if (!s->conn.announced_frame || !known->stated) return "frag-before-frame";
    if (!rec_is(r, "job", known->hash)) return "other-job";
    const uint64_t before = tasks->at[i].delivered;
    if (!tasks_deliver(tasks, i, &r->task.at)) return "wrong-pixels";
    if (tasks->at[i].delivered > before) s->conn.answers++;
    else if (count_stale(s)) return "unasked";
    char text[96];
    stamp(s, r, text, sizeof text);
    up_forward(&f->out.queue, r, stamped, text);
    complete_task(s, tasks, i);
    return NULL;
}

/*
 * A node's message to the hub: allowed only if the node was told its place. A node asks for tasks
 * that it was not sent, and answers messages that it was sent, so it cannot send many more. A task
 * that it gives away is no longer its own.
 */
static const char *take_ring(struct fan *f, struct fan_slot *s, const struct record *r)
{
    struct rec_ring m;
    char text[96];
    if (!s->conn.placed) return "wrong-record";
    if (!rec_ring(r, &m) || m.peer >= f->n_numbers || m.next >= f->n_numbers) return "wrong-peer";
    if (r->kind == REC_GIVE) {
        int32_t i = tasks_find(s->tasks, r->task.frame, r->task.id);
        if (i < 0 || fan_task(s->tasks, i)->computed) return take_stale(f, s);
        remove_task(s, s->tasks, i);
        s->undone--;
    }
    if (r->kind != REC_GIVE && ++s->conn.ahead > STALE_MOST) return "unasked";
    stamp(s, r, text, sizeof text);
    wire_forward(&f->out.queue.control, r, stamped, text);
    return NULL;
}

/* True if the line would grow too long with the stamps of this fan, and of a few more around it. */
static bool too_long(const struct record *r)
{
    size_t said = r->line_len, n;
    if (said <= SAID_MAX) return false;
    for (const char *const *key = stamped; *key; key++)
        if (rec_key(r, *key, &n)) said -= strlen(*key) + n + 2;
    return said > SAID_MAX;
}

/*
 * An inner fan has lost a slot. If there is a policy between, it has kept the slot's tasks, and the
 * report is for the log. Without one, tasks sent to that slot will not come back.
 */
static const char *take_inner_gone(struct fan *f, struct fan_slot *s, const struct record *r)
{
    char text[144];
    if (rec_is(r, "kept", "1")) {
        const char *why = take_news(f, s);
        if (why) return why;
        stamp(s, r, text, sizeof text);
        stamp_time(f, text, sizeof text);
        up_forward(&f->out.queue, r, stamped, text);
        return NULL;
    }
    return f->in_open || s->n_tasks ? "inner-gone" : NULL;
}

/* Returns NULL, or the reason why the slot cannot be trusted any more. */
static const char *take_record(struct fan *f, struct fan_slot *s, const struct record *r)
{
    if (too_long(r)) return "long-line";
    if (s->state != FAN_UP && !fan_code_waits(s) && r->kind != REC_HELLO) return "no-hello";
    switch (r->kind) {
    case REC_HELLO: return fan_take_hello(f, s, r);
    case REC_FRAME: return take_frame(f, s, r);
    case REC_DONE: return take_done(f, s, r);
    case REC_FAIL: return take_fail(f, s, r);
    case REC_FRAG: return take_frag(f, s, r);
    case REC_BEAT: pass_beat(f, s, r); return NULL;
    case REC_GONE: return take_inner_gone(f, s, r);
    case REC_CODE: return fan_take_code(f, s, r);
    case REC_ASK:
    case REC_GIVE:
    case REC_NONE:
    case REC_CRASHED: return take_ring(f, s, r);
    case REC_UP: /* of an inner fan: its own affair */ return NULL;
    case REC_BYE:
        if (s->conn.closed_us) s->trip_us = now_us() - s->conn.closed_us;
        return NULL;
    default: return "wrong-record";
    }
}

/*
 * Start-up files of a host may print anything before the worker runs. It is skipped until a line
 * looks like a hello, or until CHATTER_MOST bytes.
 */
static bool is_chatter(const struct fan_slot *s, enum wire_result result, const struct record *r)
{
    size_t n;
    if (s->state == FAN_UP || fan_code_waits(s) || s->host->here) return false;
    return result == WIRE_BAD || r->kind != REC_HELLO || !rec_key(r, "selftest", &n);
}

void fan_slot_listen(struct fan *f, struct fan_slot *s)
{
    size_t before = buf_size(&s->conn.from.in), n;
    /* It was told to end and owes nothing: its beats are no reason to wait. */
    bool over = fan_slot_over(f, s) && !s->n_tasks && s->conn.child.to < 0;
    int more = stream_read(&s->conn.from, s->conn.child.from);
    n = buf_size(&s->conn.from.in) - before;
    const unsigned char *said = buf_data(&s->conn.from.in) + before;
    const char *why = s->state != FAN_UP ? fan_take_chatter(s, said, n) : NULL;
    struct record r;
    enum wire_result result;
    if (!why) why = fan_take_requests(s, said, n);
    bool at_work = false; /* a node that answers others may have an idle worker */
    while (!why && (result = wire_next(&s->conn.from, &r)) != WIRE_MORE) {
        if (is_chatter(s, result, &r)) continue;
        if (result == WIRE_RECORD) {
            at_work |= r.kind < REC_RING;
            why = take_record(f, s, &r);
        } else if (!s->conn.from.ended) {
            char name[SLOT_NAME];
            warn("%s: its stream: %s", fan_slot_name(s, name), s->conn.from.why);
            why = "garbage";
        }
    }
    if (s->state == FAN_UP && !over && (at_work || buf_size(&s->conn.from.in)))
        s->conn.heard_us = now_us();
    bool waits = s->state != FAN_UP && !fan_code_waits(s);
    if (waits && !why && (s->conn.before_hello += n) > CHATTER_MOST) why = "no-hello";
    if (why) fan_slot_lose(f, s, why, false);
    else if (more <= 0) fan_slot_leave(f, s);
}
