/*
 * eta: the time that is left, predicted from the cost of the pixels that have come. See base.h.
 *
 * Pixels of one picture differ in cost by a factor of 100 and more, so the share of pixels that is
 * done says little about the share of the work. But costs depend on the place: the mean cost of a
 * pixel is kept for each band of rows; a band without any pixel gets a value between those of the
 * bands that have some. This is good when a few tasks from all over the picture come early
 * (partition(1), -o sample). The slots' speed is work per second, over a recent part of the run.
 */
#include "base/base.h"

#include <string.h>

#define SLOT_OF(frame, id) (((frame)*UINT32_C(2654435761) + (id)) % ETA_TASKS)
/* Speed is measured over this part of the time so far, and over this time at least. */
#define RECENT 0.5
#define RECENT_LEAST_S 10
#define TASKS_LEAST 4

/* The entry of a task. Takes the place of another one if the table is full: that one is lost. */
static struct eta_task *task_of(struct eta *e, uint32_t frame, uint32_t id)
{
    struct eta_task *t = &e->tasks[SLOT_OF(frame, id)];
    if (!t->used || t->frame != frame || t->id != id)
        *t = (struct eta_task){.used = true, .frame = frame, .id = id};
    return t;
}

/* The cost of a task and the pixels that it brought so far go to their bands. */
static void settle(struct eta *e, struct eta_task *t)
{
    if (!t->done || t->px <= 0) return;
    double rows = t->last - t->first + 1;
    for (int b = (int)t->first; b <= (int)t->last; b++) {
        e->cost_us[b] += t->cost_us / rows;
        e->px[b] += t->px / rows;
    }
    t->cost_us = t->px = 0;
}

void eta_pixels(struct eta *e, uint32_t frame, uint32_t id, double y0, double y1, double px)
{
    struct eta_task *t = task_of(e, frame, id);
    uint32_t first = (uint32_t)fmin(fmax(y0, 0) * ETA_BANDS, ETA_BANDS - 1);
    uint32_t last = (uint32_t)fmin(fmax(y1, 0) * ETA_BANDS, ETA_BANDS - 1);
    if (t->px <= 0) t->first = first, t->last = last;
    if (first < t->first) t->first = first;
    if (last > t->last) t->last = last;
    t->px += px;
    settle(e, t);
}

/* Every second mark is dropped when all are used: they stay evenly spread over the run. */
static void mark(struct eta *e, double t_s)
{
    if (e->n_marks && t_s < e->marks[e->n_marks - 1].t_s + e->step_s) return;
    if (e->n_marks == ETA_MARKS) {
        for (int i = 0; i < ETA_MARKS / 2; i++) e->marks[i] = e->marks[2 * i];
        e->n_marks = ETA_MARKS / 2;
        e->step_s = (t_s - e->marks[0].t_s) / (ETA_MARKS / 2);
    }
    e->marks[e->n_marks].t_s = t_s;
    e->marks[e->n_marks++].work_us = e->work_us;
}

void eta_done(struct eta *e, uint32_t frame, uint32_t id, double cost_us, double t_s)
{
    struct eta_task *t = task_of(e, frame, id);
    t->done = true;
    t->cost_us += cost_us;
    settle(e, t);
    if (t_s < 0) return;
    e->work_us += cost_us;
    e->last_s = t_s;
    e->n_done++;
    mark(e, t_s);
}

void eta_begin(struct eta *e)
{
    e->n_marks = 0;
    e->n_done = 0;
    e->work_us = e->step_s = 0;
}

/* Mean cost of a pixel in each band. False if no cost is known. */
static bool densities(const struct eta *e, double us[ETA_BANDS])
{
    int before = -1;
    for (int b = 0; b < ETA_BANDS; b++) {
        if (e->px[b] <= 0) continue;
        us[b] = e->cost_us[b] / e->px[b];
        for (int k = before + 1; k < b; k++) {
            double share = before < 0 ? 1 : (double)(k - before) / (b - before);
            us[k] = before < 0 ? us[b] : us[before] + (us[b] - us[before]) * share;
        }
        before = b;
    }
    for (int k = before + 1; before >= 0 && k < ETA_BANDS; k++) us[k] = us[before];
    return before >= 0;
}

/* Work in microseconds that the missing pixels will cost. */
static double work_left(const struct eta *e, double done, double total)
{
    double us[ETA_BANDS], work = 0, missing = 0;
    if (!densities(e, us)) return -1;
    for (int b = 0; b < ETA_BANDS; b++) {
        double px = fmax(total / ETA_BANDS - e->px[b], 0);
        work += px * us[b];
        missing += px;
    }
    return missing > 0 ? work * (total - done) / missing : 0;
}

double eta_left_s(const struct eta *e, double done, double total, double t_s)
{
    if (done >= total) return 0;
    double work = work_left(e, done, total);
    if (work < 0 || e->n_done < TASKS_LEAST) return -1;
    double past_s = fmax(RECENT * (e->last_s - e->marks[0].t_s), RECENT_LEAST_S);
    double from_s = e->last_s - past_s;
    int i = 0;
    while (i + 1 < e->n_marks && e->marks[i + 1].t_s <= from_s) i++;
    double took_s = e->last_s - e->marks[i].t_s, did = e->work_us - e->marks[i].work_us;
    if (took_s <= 0 || did <= 0) return -1;
    double left_s = work * took_s / did - (t_s - e->last_s);
    return left_s > 0 ? left_s : 0;
}
