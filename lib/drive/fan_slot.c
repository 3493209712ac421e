/* fan: starting, feeding and losing slots. */
#include "drive/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <sys/wait.h>

#define GRACE_US 500000 /* for a worker to exit once its stream has ended */

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

int slot_send(struct fan *f, int k, const struct record *r, const struct frame_size *frame)
{
    static const char *const drop[] = {"to", NULL};
    struct fan_slot *s = &f->slots[k];
    if (s->ended) {
        f->lost++;
        return 0;
    }
    int32_t i = tasks_find(&s->tasks, r->task.frame, r->task.id);
    if (i >= 0) { /* it is on its way */
        if (memcmp(&s->tasks.at[i].task.at, &r->task.at, sizeof r->task.at) == 0) return 0;
        warn("task %u %u: comes twice, expected another number for other pixels", r->task.frame,
            r->task.id);
        return ST_USAGE;
    }
    i = tasks_add(&s->tasks, &r->task, frame->w);
    s->tasks.at[i].since_us = now_us() - f->start_us;
    s->undone++;
    if (s->child.to >= 0) wire_forward(&s->down.bytes, r, drop, NULL);
    return 0;
}

void slot_feed(struct fan *f, struct fan_slot *s, const struct pollfd *p)
{
    bool full = p->events & POLLOUT && !(p->revents & POLLOUT);
    if (p->revents & POLLERR || (!full && down_write(&s->down, s->child.to) != 0)) {
        /* It reads no more: its output tells why, and what it still does. */
        child_close(&s->child.to);
        down_free(&s->down);
    }
    if (!f->in_open && !down_size(&s->down)) child_close(&s->child.to);
}

void slot_free(struct fan_slot *s)
{
    down_free(&s->down);
    wire_free(&s->from);
    tasks_free(&s->tasks);
}

static void close_slot(struct fan *f, struct fan_slot *s)
{
    f->leaving -= s->leave_us != 0;
    f->alive--;
    s->leave_us = 0;
    s->ended = true;
    slot_free(s);
}

void slot_lose(struct fan *f, struct fan_slot *s, const char *why)
{
    char extra[96];
    child_end(&s->child, 0);
    snprintf(extra, sizeof extra, "w=%d why=%s lost=%" PRId32, s->number, why, s->tasks.count);
    wire_plain(&f->out.queue.bulk, REC_GONE, extra);
    up_end_record(&f->out.queue);
    if (s->tasks.count || f->in_open)
        warn("slot %d: lost (%s) with %" PRId32 " tasks", s->number, why, s->tasks.count);
    f->lost += s->tasks.count;
    close_slot(f, s);
}

void slot_leave(struct fan *f, struct fan_slot *s)
{
    s->asked = s->child.to < 0; /* its input was closed: it was to end */
    s->leave_us = now_us() + GRACE_US;
    f->leaving++;
}

void slot_left(struct fan *f, struct fan_slot *s)
{
    char why[24];
    int status;
    if (!child_ended(&s->child, &status)) {
        if (now_us() < s->leave_us) return;
        status = child_end(&s->child, 0);
    }
    bool well = s->asked && !s->tasks.count && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (well) close_slot(f, s);
    else slot_lose(f, s, status_text(status, why));
}
