#include "sched/blame.h"

#include <stdlib.h>

/* Payload of a task. */
struct blamed {
    int32_t n;               /* lost attempts */
    int32_t by[BLAME_SLOTS]; /* the latest slots: that of attempt I at I modulo BLAME_SLOTS */
};

static struct blamed *find(const struct blame *b, const struct task *t)
{
    int32_t i = b->tasks.count ? tasks_find(&b->tasks, t->frame, t->id) : -1;
    return i < 0 ? NULL : tasks_extra(&b->tasks, i);
}

void blame_init(struct blame *b, int32_t most)
{
    b->most = most ? most : SCHED_LOSSES;
    frames_init(&b->frames, sizeof(struct blame_frame));
    tasks_init(&b->tasks, sizeof(struct blamed));
}

void blame_free(struct blame *b)
{
    frames_free(&b->frames);
    tasks_free(&b->tasks);
    free(b->lost);
    refuse_free(&b->refusals);
}

void blame_note(struct blame *b, const struct task *t)
{
    pieces_note_id(&b->frames, t);
    refuse_begin(&b->refusals, t->generation);
}

struct blame_frame *blame_frame(const struct blame *b, const struct task *t)
{
    return frames_extra(&b->frames, frames_find(&b->frames, t->frame));
}

static void count_lost(struct blame *b, int32_t k)
{
    if (k >= b->n_lost) {
        b->lost = xrealloc(b->lost, (size_t)k + 1, sizeof *b->lost);
        while (b->n_lost <= k) b->lost[b->n_lost++] = 0;
    }
    b->lost[k]++;
}

bool blame_add(struct blame *b, const struct task *t, int32_t k)
{
    struct blame_frame *f = blame_frame(b, t);
    struct blamed *task = find(b, t);
    if (!task) task = tasks_extra(&b->tasks, tasks_add(&b->tasks, t, 0));
    task->by[task->n++ % BLAME_SLOTS] = k;
    count_lost(b, k);
    if (f->well || ++f->lost < b->most || f->aside) return false;
    f->aside = true;
    f->tried = 0;
    return true;
}

bool blame_well(struct blame *b, const struct task *t)
{
    struct blame_frame *f = blame_frame(b, t);
    bool was = f->aside;
    f->well = true;
    f->aside = false;
    return was;
}

int32_t blame_count(const struct blame *b, const struct task *t)
{
    const struct blamed *task = find(b, t);
    return task ? task->n : 0;
}

bool blame_is(const struct blame *b, const struct task *t, int32_t k)
{
    const struct blamed *task = find(b, t);
    for (int32_t i = 0; task && i < task->n && i < BLAME_SLOTS; i++)
        if (task->by[i] == k) return true;
    return false;
}

void blame_forget(struct blame *b, const struct task *t)
{
    int32_t i = b->tasks.count ? tasks_find(&b->tasks, t->frame, t->id) : -1;
    if (i >= 0) tasks_remove(&b->tasks, i);
}

int32_t blame_sum(const struct blame *b, const struct task_table *ledger, int32_t i)
{
    int32_t n = 0;
    for (; b->tasks.count && i >= 0; i = pieces_parent(ledger, i))
        n += blame_count(b, &ledger->at[i].task);
    return n;
}

bool blame_bad(const struct blame *b, const struct task_table *ledger, int32_t i, int32_t alone)
{
    const struct task *t = &ledger->at[i].task;
    bool aside = blame_frame(b, t)->aside || refuse_all(&b->refusals, t->generation);
    return alone || aside || blame_sum(b, ledger, i) >= b->most;
}

/* Entry i is a half that was not tried: is the other one to be tried, or being tried, first? */
static bool is_second(const struct blame *b, const struct task_table *ledger, int32_t i)
{
    int32_t parent = pieces_parent(ledger, i);
    if (parent < 0) return false;
    int32_t j = pieces_at(ledger, parent)->first;
    return j != i && !blame_count(b, &ledger->at[j].task);
}

/* The other pieces of the parent of entry i, which is a half and was lost. */
static enum blame_step by_others(const struct blame *b, const struct task_table *ledger, int32_t i)
{
    int32_t parent = pieces_parent(ledger, i);
    if (parent < 0) return BLAME_ABANDON;
    int32_t j = pieces_at(ledger, parent)->first;
    if (j == i) j = pieces_at(ledger, j)->after;
    if (j < 0) return BLAME_HALVE;
    return blame_count(b, &ledger->at[j].task) ? BLAME_ABANDON_PARENT : BLAME_WAIT;
}

/* Is the frame of entry i to be treated as a whole? */
static bool is_whole(const struct blame *b, const struct task_table *ledger,
    const struct task_list *aside, int32_t i)
{
    const uint32_t frame = ledger->at[i].task.frame;
    const struct blame_frame *f = blame_frame(b, &ledger->at[i].task);
    if (!f->aside || f->tried) return f->aside;
    int32_t j = aside->head;
    while (j >= 0 && (j == i || ledger->at[j].task.frame != frame)) j = ledger->at[j].next;
    return j >= 0;
}

enum blame_step blame_step(const struct blame *b, const struct task_table *ledger,
    const struct task_list *aside, int32_t i, int32_t alone, bool ended)
{
    const struct lattice at = pieces_missing(&ledger->at[i]);
    const struct task *t = &ledger->at[i].task;
    if (is_whole(b, ledger, aside, i)) {
        const struct blame_frame *f = blame_frame(b, t);
        return f->tried && f->lost >= f->tried ? BLAME_ABANDON_FRAME : BLAME_GIVE_FRAME;
    }
    bool may_cut = ended && lattice_count(&at) > 1 && pieces_id_left(&b->frames, t);
    if (alone && blame_count(b, t) < alone)
        return is_second(b, ledger, i) ? BLAME_WAIT : BLAME_GIVE;
    if (!alone && blame_sum(b, ledger, i) < b->most) return BLAME_GIVE;
    if (!alone) return may_cut ? BLAME_HALVE : BLAME_GIVE_ALONE;
    enum blame_step step = by_others(b, ledger, i);
    return step == BLAME_HALVE && !may_cut ? BLAME_ABANDON : step;
}

void blame_tried(struct blame *b, const struct task *t)
{
    struct blame_frame *f = blame_frame(b, t);
    f->tried = f->lost + 1;
}

bool blame_due(struct blame *b, bool quiet, bool ended, int64_t now)
{
    if (!quiet) b->due_us = 0;
    else if (!b->due_us) b->due_us = now + BLAME_PAUSE_US;
    return quiet && now >= b->calm_us && (ended || now >= b->due_us);
}

int64_t blame_wake_us(const struct blame *b, int64_t now)
{
    if (b->calm_us > now) return b->calm_us;
    return b->due_us > now ? b->due_us : INT64_MAX;
}

static int32_t lost_of(const struct blame *b, int32_t k) { return k < b->n_lost ? b->lost[k] : 0; }

int32_t blame_pick(const struct blame *b, const struct task *t, const struct slot_set *of,
    bool (*may)(const void *context, int32_t k), const void *context)
{
    int32_t best = -1;
    bool best_was = true;
    for (int32_t k = -1, n = of->count; n > 0; n--) {
        k = set_after(of, k);
        if ((may && !may(context, k)) || refuse_is(&b->refusals, t->generation, k)) continue;
        bool was = blame_is(b, t, k);
        bool better = was != best_was ? best_was : lost_of(b, k) < lost_of(b, best < 0 ? k : best);
        if (best < 0 || better) best = k, best_was = was;
    }
    return best;
}

void blame_abandon(const struct blame *b, const struct task_table *ledger, int32_t i, bool all,
    struct sched_actions *out)
{
    struct task t = ledger->at[i].task;
    t.at = pieces_missing(&ledger->at[i]);
    sched_act(out, SCHED_ABANDON, -1, &t);
    out->at[out->n - 1].origin_id = pieces_came_as(ledger, i);
    out->at[out->n - 1].all = all;
    out->at[out->n - 1].refused = refuse_all(&b->refusals, t.generation);
}
