/* Reading a log: records to tables. See history.h. */
#include "history/history.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define READ_BYTES (1 << 18)

/* Payload of a task. */
struct history_task {
    int32_t last;  /* index of its last done, -1: none */
    int32_t early; /* index of its latest pixels without a done; valid if these are of this task */
};

/* Pixels of a task of slot `slot` that came before its done. */
struct history_early {
    int32_t task, slot;    /* -1: they have got a done */
    int32_t next;          /* earlier ones of the task, -1: none */
    int64_t frag;          /* index, -1: none is kept */
    uint64_t sent, pixels; /* as in struct history_done */
};

static struct history_task *task_at(const struct history *l, int32_t i)
{
    return tasks_extra(&l->tasks, i);
}

/* Makes the task if it is new. */
static int32_t task_of(struct history *l, const struct task *t)
{
    int32_t i = tasks_find(&l->tasks, t->frame, t->id);
    if (i >= 0) return i;
    i = tasks_add(&l->tasks, t, 0);
    *task_at(l, i) = (struct history_task){-1, -1};
    return i;
}

/* The latest early pixels of task i, -1: none. */
static int32_t early_of(const struct history *l, int32_t i)
{
    int32_t at = task_at(l, i)->early;
    return at >= 0 && at < l->n_early && l->early[at].task == i ? at : -1;
}

/* The place of a slot name in the hash table, or where it belongs. */
static int32_t *slot_place(const struct history *l, const char *name)
{
    size_t at = hash64(HASH64_INIT, name, strlen(name));
    for (;; at++) {
        int32_t *place = &l->slot_at[at & (l->slots_room - 1)];
        if (*place < 0 || strcmp(l->slots[*place].name, name) == 0) return place;
    }
}

/* Doubles the room for slots, with twice that many hash places. */
static void grow_slots(struct history *l)
{
    l->slots_room = l->slots_room ? 2 * l->slots_room : 16;
    l->slots = xrealloc(l->slots, l->slots_room / 2, sizeof *l->slots);
    free(l->slot_at);
    l->slot_at = xmalloc(l->slots_room, sizeof *l->slot_at);
    for (size_t i = 0; i < l->slots_room; i++) l->slot_at[i] = -1;
    for (size_t i = 0; i < l->n_slots; i++) *slot_place(l, l->slots[i].name) = (int32_t)i;
}

/* The slot of this record, by its stamp. */
static int32_t slot_of(struct history *l, const struct record *r)
{
    char name[HISTORY_NAME];
    if (!rec_str(r, "w", name, sizeof name)) snprintf(name, sizeof name, "-");
    if (l->n_slots == l->slots_room / 2) grow_slots(l);
    int32_t *place = slot_place(l, name);
    if (*place >= 0) return *place;
    *place = (int32_t)l->n_slots;
    l->slots[l->n_slots] = (struct history_slot){0};
    memcpy(l->slots[l->n_slots].name, name, strlen(name) + 1);
    return (int32_t)l->n_slots++;
}

/* True if no task was done in the last run. */
static bool run_idle(const struct history *l)
{
    return l->n_runs && (!l->n_dones || l->dones[l->n_dones - 1].run + 1 < (int32_t)l->n_runs);
}

/* Forgets the events of the last run, in which nothing was done. */
static void drop_events(struct history *l)
{
    while (l->n_events && l->events[l->n_events - 1].run + 1 == (int32_t)l->n_runs) l->n_events--;
    for (size_t i = 0; i < l->n_slots; i++)
        if (l->slots[i].ready == l->n_runs) l->slots[i].ready = 0;
}

/* A hello begins a run, and so does any record before the first hello. A run without a task is
 * dropped. */
static void begin_run(struct history *l)
{
    l->running = true;
    l->n_early = 0;
    if (!l->runs) tasks_init(&l->tasks, sizeof(struct history_task));
    if (!l->runs || !run_idle(l)) {
        l->runs = xgrown(l->runs, l->n_runs, sizeof *l->runs);
        l->n_runs++;
    } else {
        drop_events(l);
    }
    l->runs[l->n_runs - 1].slots = 1;
}

static void take_hello(struct history *l, const struct record *r)
{
    int64_t n;
    begin_run(l);
    l->lone_us = 0;
    l->ended = false;
    *l->bye = '\0';
    if (rec_int(r, "slots", 1, HISTORY_SLOTS_MAX, &n)) l->runs[l->n_runs - 1].slots = (int32_t)n;
}

/* The pixels of task i that its slot sent before done di belong to it. */
static void claim_early(struct history *l, int32_t i, int32_t di)
{
    struct history_done *d = &l->dones[di];
    for (int32_t at = early_of(l, i); at >= 0; at = l->early[at].next) {
        struct history_early *e = &l->early[at];
        if (e->slot != d->slot) continue;
        e->slot = -1;
        d->sent += e->sent;
        d->pixels += e->pixels;
        if (e->frag >= 0) l->frags[e->frag].done = di;
    }
}

static void keep_early(struct history *l, const struct task *t, struct history_early early)
{
    early.task = task_of(l, t);
    early.next = early_of(l, early.task);
    l->early = xgrown(l->early, (size_t)l->n_early, sizeof *l->early);
    task_at(l, early.task)->early = l->n_early;
    l->early[l->n_early++] = early;
}

static void take_done(struct history *l, const struct record *r)
{
    if (!l->running) begin_run(l);
    l->dones = xgrown(l->dones, l->n_dones, sizeof *l->dones);
    struct history_done *d = &l->dones[l->n_dones];
    int64_t from;
    *d = (struct history_done){.frame = r->task.frame, .id = r->task.id, .recv_us = -1, .try = 1};
    d->run = (int32_t)l->n_runs - 1;
    d->slot = slot_of(l, r);
    rec_int(r, "cpu_us", 0, INT64_MAX, &d->cpu_us);
    if (!rec_int(r, "wall_us", 0, INT64_MAX, &d->wall_us)) d->wall_us = d->cpu_us;
    rec_int(r, "recv_us", 0, INT64_MAX, &d->recv_us);
    rec_int(r, "try", 1, INT64_MAX, &d->try);
    d->stolen = rec_int(r, "from", 0, WIRE_SLOTS_MAX - 1, &from);
    int32_t i = task_of(l, &r->task);
    d->before = task_at(l, i)->last;
    task_at(l, i)->last = (int32_t)l->n_dones++;
    claim_early(l, i, task_at(l, i)->last);
}

static struct history_frame *find_frame(const struct history *l, uint32_t number)
{
    for (size_t i = l->n_frames; i-- > 0;)
        if (l->frames[i].number == number) return &l->frames[i];
    return NULL;
}

const struct history_frame *history_frame_of(const struct history *l, uint32_t number)
{
    return find_frame(l, number);
}

static struct history_frame *add_frame(struct history *l, const struct record *r)
{
    l->frames = xgrown(l->frames, l->n_frames, sizeof *l->frames);
    struct history_frame *f = &l->frames[l->n_frames++];
    *f = (struct history_frame){.number = r->task.frame, .w = r->frame_w, .h = r->frame_h};
    if (!rec_str(r, "with", f->with, sizeof f->with)) *f->with = '\0';
    size_t n;
    const char *kind = rec_key(r, "kind", &n);
    f->replayed = kind && n == 8 && memcmp(kind, "replayed", n) == 0;
    coverage_init(&f->have, f->w, f->h);
    return f;
}

static void add_event(struct history *l, const struct record *r, const char *why)
{
    if (!l->running) begin_run(l);
    l->events = xgrown(l->events, l->n_events, sizeof *l->events);
    struct history_event *e = &l->events[l->n_events++];
    *e =
        (struct history_event){.run = (int32_t)l->n_runs - 1, .slot = slot_of(l, r), .recv_us = -1};
    rec_int(r, "recv_us", 0, INT64_MAX, &e->recv_us);
    rec_int(r, "lost", 0, INT64_MAX, &e->tasks);
    snprintf(e->why, sizeof e->why, "%s", why);
    e->lost = *why && (e->tasks > 0 || strcmp(why, "left") != 0);
}

static void take_gone(struct history *l, const struct record *r)
{
    char why[HISTORY_WORD];
    if (!rec_str(r, "why", why, sizeof why)) snprintf(why, sizeof why, "lost");
    add_event(l, r, why);
    l->slots[l->events[l->n_events - 1].slot].ready = 0;
}

/* The first announcement sets a frame's job. Pixels of another job belong to no frame. */
static void take_frame(struct history *l, const struct record *r)
{
    char job[WIRE_JOB];
    if (!rec_str(r, "job", job, sizeof job)) return;
    int32_t slot = slot_of(l, r);
    if (!rec_str(r, "host", l->slots[slot].host, HISTORY_HOST)) *l->slots[slot].host = '\0';
    if (!l->running) begin_run(l);
    if (l->slots[slot].ready != l->n_runs) add_event(l, r, ""); /* not for a second frame */
    l->slots[slot].ready = l->n_runs;
    if (!find_frame(l, r->task.frame)) memcpy(add_frame(l, r)->job, job, sizeof job);
}

/* The done of these pixels: the last one of that slot, in this run, for that task. */
static int32_t done_of(const struct history *l, const struct task *t, int32_t slot)
{
    int32_t i = tasks_find(&l->tasks, t->frame, t->id);
    if (i < 0) return HISTORY_UNKNOWN;
    int32_t at = task_at(l, i)->last;
    for (; at >= 0; at = l->dones[at].before)
        if (l->dones[at].slot == slot && l->dones[at].run == (int32_t)l->n_runs - 1) return at;
    return HISTORY_UNKNOWN;
}

/* Returns the number of pixels that were not there. */
static uint64_t take_pixels(struct history_frame *f, const struct lattice *at)
{
    uint64_t before = f->have.done;
    for (uint32_t j = 0; j < at->h; j++) {
        uint64_t p = lattice_pixel(at, f->w, (uint64_t)j * at->w);
        for (uint32_t i = 0; i < at->w; i++, p += at->sx) coverage_set(&f->have, p);
    }
    return f->have.done - before;
}

static void keep_frag(struct history *l, const struct record *r, int32_t di)
{
    int64_t crc = 0;
    l->frags = xgrown(l->frags, l->n_frags, sizeof *l->frags);
    rec_int(r, "crc", 0, UINT32_MAX, &crc);
    l->frags[l->n_frags] = (struct history_frag){.frame = r->task.frame,
        .done = di,
        .at = r->task.at,
        .body = r->body,
        .bytes = r->body_len,
        .crc = (uint32_t)crc};
}

static void take_frag(struct history *l, const struct record *r)
{
    if (!l->running) begin_run(l);
    struct history_frame *f = find_frame(l, r->task.frame);
    const struct lattice *at = &r->task.at;
    int32_t slot = slot_of(l, r);
    if (!f || !rec_is(r, "job", f->job) || !lattice_valid(at, f->w, f->h)) return;
    int32_t di = done_of(l, &r->task, slot);
    if (l->keep) keep_frag(l, r, di);
    l->n_frags++;
    uint64_t sent = lattice_count(at), pixels = take_pixels(f, at);
    if (di < 0) {
        keep_early(l, &r->task,
            (struct history_early){.slot = slot,
                .frag = l->keep ? (int64_t)l->n_frags - 1 : -1,
                .sent = sent,
                .pixels = pixels});
    } else {
        l->dones[di].sent += sent;
        l->dones[di].pixels += pixels;
    }
}

static void take_bye(struct history *l, const struct record *r)
{
    l->ended = true;
    if (!rec_str(r, "why", l->bye, sizeof l->bye)) *l->bye = '\0';
}

/* An earlier run of this log is the past of the last one. */
static void note_cost(struct history *l, const struct record *r)
{
    const struct history_frame *f = r->kind == REC_FRAG ? find_frame(l, r->task.frame) : NULL;
    int64_t us = 0;
    bool lone = r->kind == REC_DONE && !rec_int(r, "recv_us", 0, INT64_MAX, &us);
    if (lone) l->lone_us += (double)l->dones[l->n_dones - 1].wall_us;
    eta_record(l->eta, r, f ? f->h : 0, (lone ? l->lone_us : (double)us) * 1e-6);
}

static void take_record(struct history *l, const struct record *r)
{
    switch (r->kind) {
    case REC_HELLO: take_hello(l, r); break;
    case REC_FRAME: take_frame(l, r); break;
    case REC_DONE: take_done(l, r); break;
    case REC_FRAG: take_frag(l, r); break;
    case REC_GONE: take_gone(l, r); break;
    case REC_BYE: take_bye(l, r); break;
    default: break;
    }
    if (l->eta) note_cost(l, r);
}

void history_feed(struct history *l, struct decoder *d)
{
    struct record r;
    for (enum wire_result got; !l->refused && (got = wire_next(d, &r)) != WIRE_MORE;) {
        if (got != WIRE_RECORD) continue;
        l->refused = !rec_ours(&r, l->why);
        if (!l->refused) take_record(l, &r);
    }
}

/* Drops a run without records, and adds the file's damage to the history's. */
static void end_file(struct history *l, const struct decoder *d)
{
    l->running = false;
    if (run_idle(l)) {
        drop_events(l);
        l->n_runs--;
    }
    l->bad += d->bad;
    l->skipped += d->skipped;
    if (d->bad && !l->refused) memcpy(l->why, d->why, sizeof l->why);
}

int history_read(struct history *l, int fd)
{
    struct decoder d = {.upward = true};
    ptrdiff_t n;
    do {
        n = read_some(fd, &d.in, READ_BYTES);
        if (n <= 0) wire_end(&d);
        history_feed(l, &d);
    } while (n > 0 && !l->refused);
    int err = errno;
    end_file(l, &d);
    wire_free(&d);
    errno = err;
    return n < 0 ? -1 : 0;
}

void history_read_bytes(struct history *l, unsigned char *p, size_t n)
{
    for (bool summed = false;; summed = true) {
        struct decoder d = wire_over(p, n);
        d.upward = true;
        d.unsummed = !summed;
        history_free(l);
        l->keep = true;
        history_feed(l, &d);
        end_file(l, &d);
        if (summed || l->refused || !d.bad) return;
    }
}

void history_free(struct history *l)
{
    for (size_t i = 0; i < l->n_frames; i++) {
        coverage_free(&l->frames[i].have);
        free(l->frames[i].places);
    }
    free(l->dones);
    free(l->frames);
    free(l->slots);
    free(l->slot_at);
    free(l->runs);
    free(l->events);
    free(l->frags);
    free(l->sorted);
    free(l->early);
    tasks_free(&l->tasks);
    *l = (struct history){0};
}
