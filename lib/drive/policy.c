/*
 * The live driver of a policy: turns records into events, and actions into records, around one
 * command. It takes no scheduling decision. Records about the command's slots (hello, up, gone) end
 * here; outwards the driver is one worker. A node of a ring reads its hub's messages from standard
 * input; the hub reads its nodes' messages from the command.
 */
#include "drive/driver.h"
#include "drive/ring_record.h"
#include "patience/patience.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* For the command, which may be a fan whose launchers need their time. */
#define GRACE_MS ((PATIENCE_LAUNCHER_US + PATIENCE_EXIT_US) / 1000)

static int take_task(struct driver *d, const struct record *r)
{
    const struct frame_size *f = stream_frame_of(&d->input, r);
    struct sched_event e = {.kind = SCHED_TASK, .task = r->task, .from = -1};
    int64_t from;
    if (!f) return ST_USAGE;
    e.frame_w = f->w;
    e.task.generation = f->generation;
    if (d->node && rec_int(r, "peer", 0, WIRE_SLOTS_MAX - 1, &from)) e.from = (int32_t)from;
    tags_keep(&d->tags, r);
    drive_tell(d, e);
    return 0;
}

/* Handles a message from the hub to this node. */
static int take_ring(struct driver *d, const struct record *r)
{
    struct sched_event e = {.kind = SCHED_RING, .from = -1};
    if (drive_ring_of(r, &e.ring)) drive_tell(d, e);
    return 0;
}

/*
 * A task belongs to the state before its frame, whichever slot gets it and however often. Workers
 * keep only the latest states (wire.h). So new state waits while tasks of the oldest generation are
 * uncommitted; their pixels that are held back are flushed.
 */
static bool admitted(const struct driver *d)
{
    return sched_admits(d->policy, d->state, d->oldest, d->input.generations.oldest);
}

static int take_state(struct driver *d, const struct record *r)
{
    const uint32_t before = d->input.generations.now;
    d->oldest = d->input.generations.oldest;
    generation_state(&d->input.generations, r->kind, r->body_len);
    drive_room_state(d, r, before);
    bool waits = !admitted(d);
    struct buf *to = waits ? &d->held : &d->down.bytes;
    if (r->body) wire_forward(to, r, NULL, NULL);
    else wire_plain(to, REC_FLUSH, NULL); /* dropped: something that does no harm */
    if (!waits) return 0;
    drive_tell(d, (struct sched_event){.kind = SCHED_FLUSH});
    return STREAM_HOLD;
}

static int take_down(void *ctx, const struct record *r)
{
    struct driver *d = ctx;
    switch (r->kind) {
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC:
    case REC_VIEW:
    case REC_FILES: return take_state(d, r);
    case REC_FRAME:
        if (!drive_lacks(d, stream_frame(&d->input, r)->generation))
            wire_forward(&d->down.bytes, r, NULL, NULL);
        return 0;
    case REC_TASK: return take_task(d, r);
    case REC_FLUSH:
        drive_tell(d, (struct sched_event){.kind = SCHED_FLUSH});
        outlet_answer(&d->out);
        return 0;
    case REC_CODE: outlet_code(&d->out, r); return 0;
    case REC_BYE: d->dismissed = d->stopping = true; return 0;
    case REC_RING:
    case REC_HEIR:
    case REC_ASK:
    case REC_NONE:
        if (d->node) return take_ring(d, r); /* fallthrough */
    default:
        warn(
            "standard input: record `%s`, expected state, frame, task or flush", rec_name(r->kind));
        return ST_USAGE;
    }
}

static void take_input(struct driver *d)
{
    d->refused = stream_input(&d->in, &d->in_open, take_down, d);
    drive_consider(d);
    outlet_beat_within(&d->out, &d->in);
    if (!d->in_open && !d->refused) drive_tell(d, (struct sched_event){.kind = SCHED_INPUT_END});
}

/* Continues the input behind state once the state is admitted. */
static void release(struct driver *d)
{
    while (buf_size(&d->held) && !d->refused && admitted(d)) {
        buf_append(&d->down.bytes, buf_data(&d->held), buf_size(&d->held));
        buf_free(&d->held);
        d->refused = stream_take(&d->in, take_down, d);
    }
}

/* Writes new records at once, unless the pipe was found full. */
static void feed(struct driver *d, const struct pollfd *p)
{
    bool full = p->events & POLLOUT && !(p->revents & POLLOUT);
    if (p->revents & POLLERR || (!full && down_write(&d->down, d->child.to) != 0)) {
        child_close(&d->child.to); /* it reads no more: its output tells why */
        down_free(&d->down);
    }
    if (d->closing && !down_size(&d->down)) child_close(&d->child.to);
}

/* The time at which the policy wants SCHED_WAKE. */
static int64_t wake_us(const struct driver *d)
{
    return d->policy->wake_us ? d->policy->wake_us(d->state) : INT64_MAX;
}

/*
 * Busy workers send beats. If none come, the end of a line may have been damaged, in either
 * direction, and its reader waits for the rest. A flush, and its answer, end such a line.
 */
static void ask_quiet(struct driver *d)
{
    if (now_us() < d->heard_us + PATIENCE_SILENCE_US) return;
    d->heard_us = now_us();
    if (sched_uncommitted(d->policy, d->state)) drive_flush(d, -1);
}

/* The time that poll may wait. */
static int wait_ms(const struct driver *d)
{
    int64_t wake = wake_us(d), quiet = d->heard_us + PATIENCE_SILENCE_US;
    int64_t left_us = (wake < quiet ? wake : quiet) - now_us();
    if (left_us <= 0) return 0;
    return (int)((left_us + 999) / 1000);
}

/* One round. Returns false when the command's stream has ended. */
static bool poll_round(struct driver *d)
{
    bool reading = up_size(&d->out.queue) < UP_QUEUE_MOST;
    bool want = d->in_open && !buf_size(&d->held) &&
                d->policy->waiting(d->state) < SCHED_WAITING_MOST &&
                down_size(&d->down) < DOWN_QUEUE_MOST;
    struct pollfd p[4] = {
        pipe_poll_entry(STDIN_FILENO, want, POLLIN),
        outlet_poll(&d->out),
        pipe_poll_entry(d->child.to, true, down_size(&d->down) ? POLLOUT : 0),
        pipe_poll_entry(d->child.from, reading, POLLIN),
    };
    if (signals_poll(p, 4, wait_ms(d)) < 0) {
        if (errno == EINTR) return true;
        die(ST_SYSTEM, "poll:");
    }
    outlet_polled(&d->out, &p[1]);
    if (d->out.gone) return true;
    if (p[0].revents) take_input(d);
    bool more = p[3].revents ? drive_listen(d) : true;
    if (now_us() >= wake_us(d)) drive_tell(d, (struct sched_event){.kind = SCHED_WAKE});
    release(d);
    ask_quiet(d);
    if (d->child.to >= 0) feed(d, &p[2]);
    outlet_push(&d->out);
    return more;
}

/* A node ends as its worker did, so that `fan` and the ring know why. `status` is as of wait; 0: it
 * did not end by itself. */
static int finish(struct driver *d, char *const *command, int status)
{
    char text[24];
    const char *end = status ? status_hint(status_text(status, text)) : "";
    if (d->refused) return d->refused;
    if (d->dismissed) return ST_OK;
    int64_t left = sched_uncommitted(d->policy, d->state);
    bool unfinished = left || d->in_open;
    bool nobody = !d->out.greeted && strcmp(d->why, "no-slot-left") == 0; /* it said why */
    if (!d->out.gone) {
        wire_bye(&d->out.queue.bulk, d->why);
        up_end_record(&d->out.queue);
        outlet_drain(&d->out);
        if (d->node && unfinished && status && !d->out.gone) return status_code(status);
        if (left && !signals_came())
            warn("%s ended with %" PRId64 " tasks unfinished%s", command[0], left, end);
        else if (unfinished && !nobody && !signals_came())
            warn("%s ended before the end of its input%s", command[0], end);
    }
    if (d->out.gone || unfinished || nobody) return ST_SYSTEM;
    return d->losses.some ? ST_PARTIAL : ST_OK;
}

int drive_policy(
    const struct policy *policy, const struct sched_params *params, char *const *command)
{
    struct driver d = {.policy = policy,
        .node = policy == &policy_node,
        .in_open = true,
        .in = STREAM_INPUT,
        .from.upward = true};
    signals_catch();
    outlet_open(&d.out);
    tags_init(&d.tags);
    drive_losses_init(&d.losses);
    if (d.node) drive_room_init(&d);
    d.state = policy->create(params);
    d.heard_us = now_us();
    if (child_start(&d.child, command) != 0) die(ST_SYSTEM, "%s:", command[0]);
    bool more = true;
    while (more && !d.out.gone && !d.refused && !d.stopping && !signals_came())
        more = poll_round(&d);
    if (more) child_stop(&d.child);
    const int ended = child_end(&d.child, GRACE_MS);
    int status = finish(&d, command, more ? 0 : ended);
    policy->destroy(d.state);
    free(d.acts.at);
    down_free(&d.down);
    up_free(&d.out.queue);
    wire_free(&d.in);
    wire_free(&d.from);
    frames_free(&d.input.frames);
    tags_free(&d.tags);
    drive_losses_free(&d.losses);
    buf_free(&d.held);
    buf_free(&d.lacks.tasks);
    if (signals_came()) signals_die();
    return status;
}
