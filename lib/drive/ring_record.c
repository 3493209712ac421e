/* Ring messages to records and back: see ring_record.h. */
#include "drive/ring_record.h"

static const enum rec_kind record_of[] = {
    [RING_PLACE] = REC_RING,
    [RING_ASK] = REC_ASK,
    [RING_GIVE] = REC_GIVE,
    [RING_NONE] = REC_NONE,
    [RING_CRASHED] = REC_CRASHED,
    [RING_HEIR] = REC_HEIR,
};
#define KINDS (sizeof record_of / sizeof *record_of)

bool drive_ring_of(const struct record *r, struct ring *m)
{
    struct rec_ring said;
    size_t kind = 0;
    while (kind < KINDS && record_of[kind] != r->kind) kind++;
    if (kind == KINDS || !rec_ring(r, &said)) return false;
    *m = (struct ring){.kind = (enum ring_kind)kind,
        .peer = said.peer,
        .next = said.next,
        .takes = said.takes,
        .idle = said.idle,
        .me = said.me,
        .n = said.n,
        .published = said.published};
    return true;
}

void drive_ring_say(struct buf *b, const struct sched_action *a, int32_t to)
{
    const struct ring *m = &a->ring;
    struct task t = a->task;
    t.to = to;
    wire_ring(b, record_of[m->kind], &t,
        &(struct rec_ring){.peer = m->peer,
            .next = m->next,
            .takes = m->takes,
            .me = m->me,
            .n = m->n,
            .idle = m->idle,
            .published = m->published});
}
