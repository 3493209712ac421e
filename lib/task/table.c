/* Tables of frames and of tasks, with the payloads of their owners. */
#include "task/task.h"

#include <stdlib.h>
#include <string.h>

/* ---- payloads -------------------------------------------------------------------------------- */

/* Makes room for the payloads of n entries. */
static void make_room(struct payloads *p, size_t n)
{
    if (p->size) p->at = xrealloc(p->at, n, p->size);
}

static void clear(struct payloads *p, size_t i)
{
    if (p->size) memset(p->at + i * p->size, 0, p->size);
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* The place of the frame, or where it would be. Numbers mostly ascend, and most queries are for
 * the latest. */
static size_t frame_place(const struct frames *f, uint32_t frame)
{
    size_t low = 0, high = f->n;
    if (high && f->at[high - 1].frame <= frame) return high - (f->at[high - 1].frame == frame);
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (f->at[middle].frame < frame) low = middle + 1;
        else high = middle;
    }
    return low;
}

void frames_init(struct frames *f, size_t payload) { *f = (struct frames){.extra.size = payload}; }

struct frame_size *frames_find(const struct frames *f, uint32_t frame)
{
    size_t i = frame_place(f, frame);
    return i < f->n && f->at[i].frame == frame ? &f->at[i] : NULL;
}

/* Makes a gap at place i. */
static void open_gap(struct frames *f, size_t i)
{
    struct payloads *p = &f->extra;
    size_t moved = f->n - i;
    if ((f->n & (f->n - 1)) == 0) { /* full: a power of two */
        size_t room = f->n ? 2 * f->n : 1;
        f->at = xrealloc(f->at, room, sizeof *f->at);
        make_room(p, room);
    }
    memmove(f->at + i + 1, f->at + i, moved * sizeof *f->at);
    if (p->size) memmove(p->at + (i + 1) * p->size, p->at + i * p->size, moved * p->size);
    f->n++;
}

struct frame_size *frames_set(struct frames *f, uint32_t frame, uint32_t w, uint32_t h)
{
    size_t i = frame_place(f, frame);
    if (i == f->n || f->at[i].frame != frame) open_gap(f, i);
    f->at[i] = (struct frame_size){.frame = frame, .w = w, .h = h};
    clear(&f->extra, i);
    return &f->at[i];
}

void frames_free(struct frames *f)
{
    free(f->at);
    free(f->extra.at);
    frames_init(f, f->extra.size);
}

/* ---- tasks ----------------------------------------------------------------------------------- */

static int32_t *head_of(const struct task_table *t, uint32_t frame, uint32_t id)
{
    return &t->heads[rng_u64(frame, id) & (uint32_t)(t->n_heads - 1)];
}

static void chain(struct task_table *t, int32_t i)
{
    int32_t *head = head_of(t, t->at[i].task.frame, t->at[i].task.id);
    t->at[i].chain = *head;
    *head = i;
}

void tasks_init(struct task_table *t, size_t payload)
{
    *t = (struct task_table){.extra.size = payload};
}

void tasks_init_slot(struct task_table *t, size_t payload)
{
    *t = (struct task_table){.extra.size = payload, .of_slot = true};
}

/* Doubles the entries, their payloads and the hash chains. */
static void grow(struct task_table *t)
{
    int32_t cap = t->cap ? t->cap * 2 : t->of_slot ? 4 : 64;
    if (t->cap > INT32_MAX / 4) die(ST_SYSTEM, "more than %d tasks at once", t->cap);
    t->at = xrealloc(t->at, (size_t)cap, sizeof *t->at);
    make_room(&t->extra, (size_t)cap);
    free(t->heads);
    t->heads = xmalloc((size_t)cap, sizeof *t->heads);
    if (!t->by_generation && !t->of_slot)
        t->by_generation = xcalloc(GENERATIONS, sizeof *t->by_generation);
    for (int32_t i = 0; i < cap; i++) t->heads[i] = -1;
    t->n_heads = cap;
    t->free_list = -1;
    for (int32_t i = cap - 1; i >= t->cap; i--) {
        t->at[i] = (struct task_entry){.chain = t->free_list};
        t->free_list = i;
    }
    for (int32_t i = 0; i < t->cap; i++) chain(t, i); /* it grows only if all are live */
    t->cap = cap;
}

void tasks_free(struct task_table *t)
{
    free(t->at);
    free(t->heads);
    free(t->extra.at);
    free(t->by_generation);
    *t = (struct task_table){.extra.size = t->extra.size, .of_slot = t->of_slot};
}

int32_t tasks_find(const struct task_table *t, uint32_t frame, uint32_t id)
{
    if (!t->count) return -1;
    int32_t i = *head_of(t, frame, id);
    while (i >= 0 && (t->at[i].task.frame != frame || t->at[i].task.id != id)) i = t->at[i].chain;
    return i;
}

int32_t tasks_add(struct task_table *t, const struct task *task, uint32_t frame_w)
{
    if (t->count == t->cap) grow(t);
    int32_t i = t->free_list;
    t->free_list = t->at[i].chain;
    t->at[i] = (struct task_entry){
        .task = *task, .frame_w = frame_w, .live = true, .prev = -1, .next = -1};
    clear(&t->extra, (size_t)i);
    chain(t, i);
    t->count++;
    if (t->by_generation) t->by_generation[task->generation % GENERATIONS]++;
    return i;
}

void tasks_remove(struct task_table *t, int32_t i)
{
    struct task_entry *e = &t->at[i];
    int32_t *link = head_of(t, e->task.frame, e->task.id);
    while (*link != i) link = &t->at[*link].chain;
    *link = e->chain;
    e->live = false;
    e->chain = t->free_list;
    t->free_list = i;
    t->count--;
    if (t->by_generation) t->by_generation[e->task.generation % GENERATIONS]--;
}

bool tasks_deliver(struct task_table *t, int32_t i, const struct lattice *at)
{
    struct task_entry *e = &t->at[i];
    const struct lattice next =
        lattice_cut(&e->task.at, e->frame_w, e->delivered, lattice_count(at));
    /* A task with rows that overlap has several places for one piece. */
    bool goes_on = memcmp(&next, at, sizeof next) == 0 &&
                   lattice_count(at) <= lattice_count(&e->task.at) - e->delivered;
    int64_t n0 = goes_on ? (int64_t)e->delivered : lattice_offset(&e->task.at, e->frame_w, at);
    if (n0 < 0 || (uint64_t)n0 > e->delivered) return false;
    uint64_t n1 = (uint64_t)n0 + lattice_count(at);
    if (n1 > e->delivered) e->delivered = n1;
    return true;
}

void list_push_back(struct task_table *t, struct task_list *l, int32_t i)
{
    t->at[i].prev = l->tail;
    t->at[i].next = -1;
    *(l->tail >= 0 ? &t->at[l->tail].next : &l->head) = i;
    l->tail = i;
    l->count++;
}

void list_push_front(struct task_table *t, struct task_list *l, int32_t i)
{
    t->at[i].next = l->head;
    t->at[i].prev = -1;
    *(l->head >= 0 ? &t->at[l->head].prev : &l->tail) = i;
    l->head = i;
    l->count++;
}

void list_remove(struct task_table *t, struct task_list *l, int32_t i)
{
    struct task_entry *e = &t->at[i];
    *(e->prev >= 0 ? &t->at[e->prev].next : &l->head) = e->next;
    *(e->next >= 0 ? &t->at[e->next].prev : &l->tail) = e->prev;
    e->prev = e->next = -1;
    l->count--;
}
