/* fan: starting, feeding and losing slots. */
#include "drive/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <sys/wait.h>

#define GRACE_MS 500 /* for a worker to exit once its stream has ended */

void slot_start(struct fan *f, int k)
{
    struct fan_slot *s = &f->slots[k];
    *s = (struct fan_slot){.number = k, .heard_us = now_us(), .from.upward = true};
    f->alive++;
    if (child_start(&s->child, f->o->command) == 0) return;
    int err = errno;
    warn("%s: %s", f->o->command[0], strerror(err));
    slot_lose(f, s, "not-started");
}

void slot_send(struct fan *f, int k, const struct record *r)
{
    struct fan_slot *s = &f->slots[k];
    const struct frame_size *frame = frames_find(&f->frames, r->task.frame);
    if (!frame)
        die(ST_USAGE, "task %u %u: expected `frame` before its tasks", r->task.frame, r->task.id);
    if (s->ended) {
        f->lost++;
        return;
    }
    int32_t i = tasks_find(&s->tasks, r->task.frame, r->task.id);
    if (i < 0) i = tasks_add(&s->tasks, &r->task, frame->w);
    if (s->tasks.count == 1) s->heard_us = now_us(); /* it had nothing to say before */
    s->tasks.at[i].since_us = now_us() - f->start_us;
    static const char *const drop[] = {"to", NULL};
    struct buf line = {0};
    wire_forward(&line, r, drop, NULL);
    down_append(&s->down, buf_data(&line), buf_size(&line));
    buf_free(&line);
}

static void close_slot(struct fan *f, struct fan_slot *s)
{
    s->ended = true;
    f->alive--;
    down_free(&s->down);
    wire_free(&s->from);
    tasks_free(&s->tasks);
}

void slot_lose(struct fan *f, struct fan_slot *s, const char *why)
{
    char extra[96];
    child_end(&s->child, 0);
    snprintf(extra, sizeof extra, "w=%d why=%s lost=%" PRId32, s->number, why, s->tasks.count);
    wire_plain(&f->up.bulk, REC_GONE, extra);
    up_end_record(&f->up);
    if (s->tasks.count || f->in_open)
        warn("slot %d: lost (%s) with %" PRId32 " tasks", s->number, why, s->tasks.count);
    f->lost += s->tasks.count;
    close_slot(f, s);
}

void slot_finish(struct fan *f, struct fan_slot *s)
{
    char why[24];
    bool asked = s->child.to < 0; /* its input was closed: it was to end */
    int status = child_end(&s->child, GRACE_MS);
    if (asked && !s->tasks.count && WIFEXITED(status) && WEXITSTATUS(status) == 0) close_slot(f, s);
    else slot_lose(f, s, status_text(status, why));
}
