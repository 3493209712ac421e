/*
 * eta: the time that is left, predicted from the cost of the pixels that have come. See eta.h.
 *
 * Pixels of one picture differ in cost by a factor of 100 and more, so the share of pixels that is
 * done says little about the share of the work. But costs depend on the place: the mean cost of a
 * pixel is kept for each band of rows; a band without any pixel gets a value between those of the
 * bands that have some. This is good when a few tasks from all over the picture come early
 * (partition(1), -o sample).
 *
 * A row may take half as long again at one time as at another, because virtual machines share
 * processors. So times that are measured early and late do not compare. After each pass over the
 * picture the costs of the bands become the forecast. From then on the work of a task is what the
 * forecast says, whatever time it took, and the slots' speed is such work per second, over a recent
 * part of the run.
 */
#include "eta/eta.h"

#include <string.h>

#define SLOT_OF(frame, id) (((frame)*UINT32_C(2654435761) + (id)) % ETA_TASKS)
/* Speed is measured over this part of the time so far, and over this time at least. */
#define RECENT 0.5
#define RECENT_LEAST_S 10
#define TASKS_LEAST 4
#define GAP_MOST 4 /* bands in a row without pixels, for a forecast */

/* The entry of a task. Takes the place of another one if the table is full: that one is lost. */
static struct eta_task *task_of(struct eta *e, uint32_t frame, uint32_t id)
{
    struct eta_task *t = &e->tasks[SLOT_OF(frame, id)];
    if (!t->used || t->frame != frame || t->id != id)
        *t = (struct eta_task){.used = true, .frame = frame, .id = id};
    return t;
}

/* Mean cost of a pixel in each band. Returns the most bands in a row without pixels: all of them if
 * none has any. */
static int densities(const struct eta *e, double us[ETA_BANDS])
{
    int before = -1, gap = 0;
    for (int b = 0; b < ETA_BANDS; b++) {
        if (e->px[b] <= 0) continue;
        us[b] = e->cost_us[b] / e->px[b];
        for (int k = before + 1; k < b; k++) {
            double share = before < 0 ? 1 : (double)(k - before) / (b - before);
            us[k] = before < 0 ? us[b] : us[before] + (us[b] - us[before]) * share;
        }
        if (b - before - 1 > gap) gap = b - before - 1;
        before = b;
    }
    for (int k = before + 1; before >= 0 && k < ETA_BANDS; k++) us[k] = us[before];
    return ETA_BANDS - 1 - before > gap ? ETA_BANDS - 1 - before : gap;
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
    e->marks[e->n_marks].cost_sum_us = e->cost_sum_us;
    e->marks[e->n_marks++].work_us = e->work_us;
}

/*
 * The passes of a sample go down the picture. When tasks begin again in an upper part, the costs so
 * far become the forecast. It says the same work for the tasks before it as their costs do.
 */
static void forecast(struct eta *e, uint32_t first)
{
    if (first + ETA_BANDS / 2 >= e->lowest) return;
    e->lowest = 0;
    if (densities(e, e->us) > GAP_MOST) return;
    e->known = true;
    e->from_s = e->last_s;
    e->n_from = e->n_done;
    e->work_us = e->cost_sum_us;
    for (int i = 0; i < e->n_marks; i++) e->marks[i].work_us = e->marks[i].cost_sum_us;
}

/* The cost of a task and the pixels that it brought so far go to their bands. */
static void settle(struct eta *e, struct eta_task *t)
{
    if (!t->done || t->px <= 0) return;
    double rows = t->last - t->first + 1, work_us = 0;
    forecast(e, t->first);
    if (t->last > e->lowest) e->lowest = t->last;
    for (int b = (int)t->first; b <= (int)t->last; b++) {
        work_us += (e->known ? e->us[b] * t->px : t->cost_us) / rows;
        e->cost_us[b] += t->cost_us / rows;
        e->px[b] += t->px / rows;
    }
    if (!t->earlier) {
        e->cost_sum_us += t->cost_us;
        e->work_us += work_us;
        mark(e, e->last_s);
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

void eta_done(struct eta *e, uint32_t frame, uint32_t id, double cost_us, double t_s)
{
    struct eta_task *t = task_of(e, frame, id);
    t->done = true;
    t->earlier = t_s < 0;
    t->cost_us += cost_us;
    if (!t->earlier) {
        e->last_s = t_s;
        e->n_done++;
    }
    settle(e, t);
}

void eta_begin(struct eta *e)
{
    e->n_marks = 0;
    e->n_done = e->n_from = 0;
    e->work_us = e->cost_sum_us = e->step_s = 0;
    e->from_s = -HUGE_VAL;
}

/* Work in microseconds that the missing pixels will cost. */
static double work_left(const struct eta *e, double done, double total)
{
    double now[ETA_BANDS], work = 0, missing = 0;
    const double *us = e->known ? e->us : now;
    if (!e->known && densities(e, now) == ETA_BANDS) return -1;
    for (int b = 0; b < ETA_BANDS; b++) {
        double px = fmax(total / ETA_BANDS - e->px[b], 0);
        work += px * us[b];
        missing += px;
    }
    return missing > 0 ? work * (total - done) / missing : 0;
}

/* Speed is measured from then on: since the forecast if as many tasks came after it as before. */
static double since_s(const struct eta *e)
{
    double past_s = fmax(RECENT * (e->last_s - e->marks[0].t_s), RECENT_LEAST_S);
    double from_s = e->last_s - past_s;
    return e->known && e->n_done >= 2 * e->n_from ? fmax(from_s, e->from_s) : from_s;
}

double eta_left_s(const struct eta *e, double done, double total, double t_s)
{
    if (done >= total) return total > 0 ? 0 : -1;
    double work = work_left(e, done, total);
    if (work < 0 || e->n_done < TASKS_LEAST || !e->n_marks) return -1;
    double from_s = since_s(e);
    int i = 0;
    while (i + 1 < e->n_marks && e->marks[i + 1].t_s <= from_s) i++;
    double took_s = e->last_s - e->marks[i].t_s, did = e->work_us - e->marks[i].work_us;
    if (took_s <= 0 || did <= 0) return -1;
    double left_s = work * took_s / did - (t_s - e->last_s);
    return left_s > 0 ? left_s : 0;
}
