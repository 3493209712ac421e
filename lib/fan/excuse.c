/*
 * fan: losses that are no fault of a slot. If other slots are lost over the same task, the task is
 * the reason, and so is its frame if no task of it was done. A slot that was lost over such a task
 * first was counted, and is excused when the next one is lost. Policies find out which task it is
 * (blame.h in lib/sched); fan only has to keep its slots.
 */
#include "fan/fan_int.h"

/* The task that it was computing: the first that it was sent and has not done. -1: none. */
static int32_t current(const struct task_table *tasks)
{
    int32_t first = -1;
    for (int32_t i = 0; i < tasks->cap; i++) {
        if (!tasks->at[i].live || fan_task(tasks, i)->computed) continue;
        if (first < 0 || fan_task(tasks, i)->sent_us < fan_task(tasks, first)->sent_us) first = i;
    }
    return first;
}

static bool excused_by(struct fan *f, struct fan_death *before, const struct fan_death *now)
{
    const struct frame_size *frame = frames_find(&f->input.frames, now->frame);
    bool bad = before->id == now->id || (frame && !fan_job(f, frame)->well);
    if (before->slot == now->slot || before->frame != now->frame || !bad) return false;
    struct fan_slot *other = fan_slot_of(f, before->slot);
    if (!before->excused && other->deaths > 0) other->deaths--;
    before->excused = true;
    return true;
}

bool fan_excuse(struct fan *f, const struct fan_slot *s)
{
    bool excused = false;
    for (int k = 0; k < s->width; k++) {
        int32_t i = current(&s->tasks[k]);
        if (i < 0) continue;
        const struct task *t = &s->tasks[k].at[i].task;
        struct fan_death now = {t->frame, t->id, s->number, false};
        int64_t n = f->n_deaths < FAN_DEATHS ? f->n_deaths : FAN_DEATHS;
        for (int64_t d = 0; d < n; d++) now.excused |= excused_by(f, &f->deaths[d], &now);
        f->deaths[f->n_deaths++ % FAN_DEATHS] = now;
        excused |= now.excused;
    }
    return excused;
}
