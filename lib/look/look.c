/* The state of a view: what was asked for, what has come, what is shown. */
#include "look/look.h"

#include <stdlib.h>
#include <string.h>

/* Of a task under way. */
struct flight {
    int64_t sent_us;
    uint64_t left;   /* pixels that have not come */
    int64_t wall_us; /* of its computation; -1: not known */
    double ahead_us; /* the work before it, as it was sent */
};

static const struct {
    uint32_t x, y, sx, sy; /* its pixels */
    uint32_t w, h;         /* the block that each stands for until others come */
} passes[LOOK_PASSES] = {
    {0, 0, 4, 4, 4, 4},
    {2, 0, 4, 4, 2, 4},
    {0, 2, 2, 4, 2, 2},
    {1, 0, 2, 2, 1, 2},
    {0, 1, 1, 2, 1, 1},
};

static struct flight *flight_at(const struct look *l, int32_t i)
{
    return tasks_extra(&l->flight, i);
}

struct lattice look_pass(int pass, uint32_t w, uint32_t h)
{
    const uint32_t x = passes[pass].x, y = passes[pass].y;
    const uint32_t sx = passes[pass].sx, sy = passes[pass].sy;
    if (w <= x || h <= y) return (struct lattice){0};
    const uint32_t columns = (w - x + sx - 1) / sx, rows = (h - y + sy - 1) / sy;
    /* A step is within the frame, also where there is no second column or row. */
    return (struct lattice){x, y, columns, rows, columns > 1 ? sx : 1, rows > 1 ? sy : 1};
}

static int pass_of(uint32_t x, uint32_t y)
{
    if (y % 2) return 4;
    if (x % 2) return 3;
    if (y % 4) return 2;
    return x % 4 ? 1 : 0;
}

void look_init(struct look *l)
{
    *l = (struct look){.coarse_us = -1, .whole_us = -1, .trip_us = -1};
    tasks_init(&l->flight, sizeof(struct flight));
}

static void free_picture(struct look *l)
{
    if (l->w) coverage_free(&l->have);
    free(l->rgba);
    free(l->level);
}

void look_free(struct look *l)
{
    free_picture(l);
    tasks_free(&l->flight);
    *l = (struct look){0};
}

void look_slots(struct look *l, int32_t slots) { l->slots = slots; }

bool look_ready(const struct look *l, int64_t now_us)
{
    return !l->w || !l->coarse || look_whole(l) || now_us - l->begun_us >= LOOK_HOLD_US;
}

void look_view(struct look *l, uint32_t frame, uint32_t w, uint32_t h, int64_t now_us)
{
    const size_t n = (size_t)w * h;
    if (l->w != w || l->h != h) {
        free_picture(l);
        coverage_init(&l->have, w, h);
        l->rgba = xcalloc(4 * n, sizeof *l->rgba);
        l->level = xmalloc(n, 1);
        l->w = w, l->h = h;
    } else {
        memset(l->have.bits, 0, (n + 63) / 64 * sizeof *l->have.bits);
        l->have.done = 0;
        memset(l->rgba, 0, 4 * n * sizeof *l->rgba);
    }
    memset(l->level, 0, n);
    l->frame = frame;
    l->begun_us = now_us;
    l->coarse_us = l->whole_us = -1;
    const struct lattice coarse = look_pass(0, w, h);
    l->coarse = lattice_count(&coarse);
    l->left = n;
    l->failed = l->asked = 0;
    l->pass = l->fresh = 0;
    l->next_id = 0;
    l->first = 0, l->end = h;
    l->counts.views++;
}

/* ---- tasks ---------------------------------------------------------------------------------- */

/* The tasks that all slots may hold: enough that none waits for a round trip. */
static int64_t most_tasks(const struct look *l)
{
    double depth = LOOK_DEPTH + ceil(fmax(l->trip_us, 0) / LOOK_TASK_US);
    return (int64_t)l->slots * (int64_t)fmin(depth, LOOK_DEPTH_MOST);
}

/* The pixels of the next task: as many as a slot computes in LOOK_TASK_US, and fewer if all slots
 * could not share the rest of the pass, or of the view at its end. */
static uint64_t task_px(const struct look *l, uint64_t pass_px)
{
    const uint64_t slots = (uint64_t)l->slots;
    const uint64_t share = l->pass ? l->left / (2 * slots) : pass_px / (3 * slots);
    uint64_t most = l->px_per_us > 0 ? (uint64_t)(l->px_per_us * LOOK_TASK_US) : share;
    if (most > share) most = share;
    return most > LOOK_TASK_LEAST ? most : LOOK_TASK_LEAST;
}

bool look_next(struct look *l, int64_t now_us, struct task *t)
{
    const int64_t most = most_tasks(l);
    if (!l->left || l->fresh >= most || l->flight.count >= 2 * most) return false;
    struct lattice all = look_pass(l->pass, l->w, l->h);
    while (l->asked == lattice_count(&all)) {
        l->asked = 0;
        all = look_pass(++l->pass, l->w, l->h);
    }
    *t = (struct task){.frame = l->frame, .id = l->next_id++, .to = -1};
    t->at = lattice_cut(&all, l->w, l->asked, task_px(l, lattice_count(&all)));
    const uint64_t n = lattice_count(&t->at);
    const double ahead_us = l->px_per_us > 0 ? (double)l->flight_px / (l->px_per_us * l->slots) : 0;
    *flight_at(l, tasks_add(&l->flight, t, l->w)) = (struct flight){now_us, n, -1, ahead_us};
    l->flight_px += n;
    l->asked += n;
    l->left -= n;
    l->fresh++;
    l->counts.tasks++;
    l->counts.px += n;
    return true;
}

static void remove_task(struct look *l, int32_t i)
{
    if (l->flight.at[i].task.frame == l->frame) l->fresh--;
    l->flight_px -= flight_at(l, i)->left;
    tasks_remove(&l->flight, i);
}

/* ---- what comes ----------------------------------------------------------------------------- */

void look_done(struct look *l, uint32_t frame, uint32_t id, int64_t wall_us)
{
    int32_t i = tasks_find(&l->flight, frame, id);
    if (i < 0 || wall_us < 1) return;
    const double rate = tasks_px(&l->flight, i) / (double)wall_us;
    l->px_per_us += l->px_per_us > 0 ? (rate - l->px_per_us) / 4 : rate;
    flight_at(l, i)->wall_us = wall_us;
}

/* A task has come whole. Its time in queues is no part of the round trip: else more tasks would be
 * sent, and wait longer. The shortest trips count, and a link that became slower counts after some
 * of them. */
static void note_trip(struct look *l, const struct flight *f, int64_t now_us)
{
    if (f->wall_us < 0) return;
    const double trip = fmax(0, (double)(now_us - f->sent_us - f->wall_us) - f->ahead_us);
    l->trip_us =
        l->trip_us >= 0 && trip > l->trip_us ? l->trip_us + (trip - l->trip_us) / 64 : trip;
}

/* The task under way that this is, or that it is a piece of: a policy may cut tasks and give the
 * pieces other numbers. */
static int32_t find_task(const struct look *l, const struct task *t)
{
    int32_t i = tasks_find(&l->flight, t->frame, t->id);
    if (i >= 0 && lattice_offset(&l->flight.at[i].task.at, l->flight.at[i].frame_w, &t->at) >= 0)
        return i;
    for (i = 0; i < l->flight.cap; i++) {
        const struct task_entry *e = &l->flight.at[i];
        if (e->live && e->task.frame == t->frame &&
            lattice_offset(&e->task.at, e->frame_w, &t->at) >= 0)
            return i;
    }
    return -1;
}

/* Shows a pixel of a pass in its block, except where something finer is. */
static void show(struct look *l, uint32_t x, uint32_t y, const float *rgba)
{
    const int pass = pass_of(x, y);
    const uint32_t right = x + passes[pass].w < l->w ? x + passes[pass].w : l->w;
    const uint32_t bottom = y + passes[pass].h < l->h ? y + passes[pass].h : l->h;
    for (uint32_t j = y; j < bottom; j++)
        for (uint32_t i = x; i < right; i++) {
            const size_t p = (size_t)j * l->w + i;
            if (l->level[p] > pass + 1) continue;
            l->level[p] = (uint8_t)(pass + 1);
            memcpy(l->rgba + 4 * p, rgba, 4 * sizeof *rgba);
        }
    l->level[(size_t)y * l->w + x] = LOOK_FINAL;
    if (y < l->first) l->first = y;
    if (bottom > l->end) l->end = bottom;
    l->coarse -= pass == 0;
}

/* Returns the number of new pixels. */
static uint64_t show_all(struct look *l, const struct lattice *at, const float *rgba)
{
    uint64_t fresh = 0;
    for (uint64_t n = 0; n < lattice_count(at); n++) {
        const uint64_t p = lattice_pixel(at, l->w, n);
        if (!coverage_set(&l->have, p)) continue;
        show(l, (uint32_t)(p % l->w), (uint32_t)(p / l->w), rgba + 4 * n);
        fresh++;
    }
    return fresh;
}

static void note_times(struct look *l, int64_t now_us)
{
    if (l->coarse_us < 0 && !l->coarse) l->coarse_us = now_us;
    if (l->whole_us < 0 && look_whole(l)) l->whole_us = now_us;
}

bool look_frag(struct look *l, const struct task *t, const float *rgba, int64_t now_us)
{
    const uint64_t n = lattice_count(&t->at);
    const int32_t i = find_task(l, t);
    const bool now = t->frame == l->frame;
    uint64_t fresh = n;
    if (i < 0) return l->counts.again_px += n, t->frame <= l->frame;
    if (now) fresh = show_all(l, &t->at, rgba);
    else l->counts.stale_px += n;
    l->counts.again_px += n - fresh;
    struct flight *f = flight_at(l, i);
    if (fresh > f->left) fresh = f->left;
    f->left -= fresh;
    l->flight_px -= fresh;
    if (!f->left) {
        note_trip(l, f, now_us);
        remove_task(l, i);
    }
    note_times(l, now_us);
    return true;
}

uint64_t look_fail(struct look *l, uint32_t frame, uint32_t id, int64_t now_us)
{
    const int32_t i = tasks_find(&l->flight, frame, id);
    if (i < 0) return 0;
    const bool now = frame == l->frame;
    const uint64_t left = flight_at(l, i)->left;
    const struct lattice at = l->flight.at[i].task.at;
    remove_task(l, i);
    if (!now) return 0;
    for (uint64_t n = 0; n < lattice_count(&at); n++) {
        const uint64_t p = lattice_pixel(&at, l->w, n);
        l->coarse -=
            !coverage_has(&l->have, p) && pass_of((uint32_t)(p % l->w), (uint32_t)(p / l->w)) == 0;
    }
    l->failed += left;
    l->counts.failed_px += left;
    note_times(l, now_us);
    return left;
}
