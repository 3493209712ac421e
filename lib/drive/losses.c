/*
 * The live driver: tasks that cost slots. The policy says which; this file knows why, and says so
 * when the policy gives one up.
 */
#include "drive/driver.h"

#include <inttypes.h>
#include <string.h>

#define REASONS_MOST 400 /* bytes of the reasons that are kept for a task */

struct reasons {
    char text[REASONS_MOST]; /* separated by "; " */
};

void drive_losses_init(struct losses *l) { tasks_init(&l->tasks, sizeof(struct reasons)); }

void drive_losses_free(struct losses *l)
{
    tasks_free(&l->tasks);
    buf_free(&l->reason);
}

void drive_reason(struct driver *d, const struct record *r)
{
    char host[256], why[24], said[WIRE_SAID];
    if (!rec_str(r, "host", host, sizeof host)) snprintf(host, sizeof host, "slot %d", rec_slot(r));
    else if (strcmp(host, ":") == 0) snprintf(host, sizeof host, "this machine");
    if (!rec_str(r, "why", why, sizeof why)) *why = '\0';
    rec_said(r, said);
    buf_consume(&d->losses.reason, buf_size(&d->losses.reason));
    buf_printf(&d->losses.reason, "%s (%s%s)%s%s", host, why, status_hint(why),
        *said ? ", it says: " : "", said);
    buf_append(&d->losses.reason, "", 1);
}

static const char *latest(const struct losses *l)
{
    return buf_size(&l->reason) ? (const char *)buf_data(&l->reason) : "";
}

static struct reasons *find(const struct losses *l, uint32_t frame, uint32_t id)
{
    int32_t i = tasks_find(&l->tasks, frame, id);
    return i < 0 ? NULL : tasks_extra(&l->tasks, i);
}

void drive_blame(struct driver *d, const struct sched_action *a)
{
    struct losses *l = &d->losses;
    const char *reason = latest(l);
    struct reasons *known = find(l, a->task.frame, a->task.id);
    if (!known) known = tasks_extra(&l->tasks, tasks_add(&l->tasks, &a->task, 0));
    size_t n = strlen(known->text);
    if (strstr(known->text, reason)) return;
    snprintf(known->text + n, sizeof known->text - n, "%s%s", n ? "; " : "", reason);
}

void drive_forgive(struct driver *d, const struct task *t)
{
    int32_t i = d->losses.tasks.count ? tasks_find(&d->losses.tasks, t->frame, t->id) : -1;
    if (i >= 0) tasks_remove(&d->losses.tasks, i);
}

/* Of a frame that is bad as a whole, the first task speaks for all. */
void drive_abandon(struct driver *d, const struct sched_action *a)
{
    struct losses *l = &d->losses;
    const struct task *t = &a->task;
    const struct reasons *why = find(l, t->frame, t->id);
    if (!why) why = find(l, t->frame, a->origin_id);
    const char *text = why ? why->text : latest(l);
    bool said = l->all && l->frame == t->frame;
    char at[64];
    snprintf(at, sizeof at, "%" PRIu32 "x%" PRIu32 "+%" PRIu32 "+%" PRIu32, t->at.w, t->at.h,
        t->at.x, t->at.y);
    if (!a->all)
        warn("frame %" PRIu32 ": %s: given up, because each slot that computed it was lost or "
             "failed: %s",
            t->frame, at, text);
    else if (!said && a->refused)
        warn("frame %" PRIu32 ": given up, because it fits the memory of no slot that is up: %s",
            t->frame, text);
    else if (!said)
        warn("frame %" PRIu32 ": given up, because slots were lost or failed over all tasks of it "
             "that were tried, as over %s: %s",
            t->frame, at, text);
    l->some = true;
    l->all = a->all;
    l->frame = t->frame;
    const char *word = a->refused ? WIRE_REFUSED : a->all ? "frame" : "task";
    wire_failed(&d->out.queue.control, t, word, text, NULL);
}
