/*
 * The live driver of a node: state that does not fit in its memory is dropped as it arrives, with
 * its frames. Their tasks have failed, and the worker never hears of them.
 */
#include "drive/driver.h"

#include <inttypes.h>
#include <string.h>

/* The record is there twice: as it came, and as it is sent to the worker. */
static bool room(void *ctx, size_t bytes)
{
    struct driver *d = ctx;
    return bytes < STREAM_LONG ||
           stream_fits(2. * (double)bytes, 2 * stream_buffer(bytes), d->lacks.why);
}

void drive_room_init(struct driver *d)
{
    d->in.room = room;
    d->in.room_ctx = d;
}

void drive_consider(struct driver *d)
{
    size_t bytes;
    if (!d->node || buf_size(&d->held)) return;
    if (stream_arrives(&d->in, &bytes) != REC_KINDS && !room(d, bytes)) wire_drop(&d->in);
}

void drive_room_state(struct driver *d, const struct record *r, uint32_t before)
{
    const unsigned char kind = (unsigned char)(1U << (r->kind - REC_SCENE));
    unsigned char *now = &d->lacks.kinds[d->input.generations.now % GENERATIONS];
    *now = d->lacks.kinds[before % GENERATIONS];
    if (r->body) {
        *now &= (unsigned char)~kind;
        return;
    }
    *now |= kind;
    d->lacks.latest = r->kind;
    d->lacks.said = false;
}

bool drive_lacks(const struct driver *d, uint32_t generation)
{
    return d->lacks.kinds[generation % GENERATIONS];
}

void drive_refuse(struct driver *d, const struct task *t)
{
    char why[ERR_BYTES];
    err_set(why, "%s: %s", rec_name(d->lacks.latest), d->lacks.why);
    if (!d->lacks.said) warn("frame %" PRIu32 ": %s", t->frame, why);
    d->lacks.said = true;
    d->losses.some = true;
    wire_failed(&d->out.queue.control, t, WIRE_REFUSED, why, NULL);
    buf_append(&d->lacks.tasks, t, sizeof *t);
}

bool drive_refused(struct driver *d, struct sched_event *e)
{
    struct buf *tasks = &d->lacks.tasks;
    if (!buf_size(tasks)) return false;
    *e = (struct sched_event){.kind = SCHED_FAIL, .from = -1, .refused = true};
    memcpy(&e->task, buf_data(tasks), sizeof e->task);
    buf_consume(tasks, sizeof e->task);
    return true;
}
