/*
 * session: what a worker has said and taken so far: frames, their jobs, and the states that it
 * keeps.
 */
#include "worker/worker_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define WITH_MAX 160

_Noreturn void worker_reader_gone(int err)
{
    if (err == EPIPE || !err) exit(ST_SYSTEM);
    errno = err;
    die(ST_SYSTEM, "standard output:");
}

_Noreturn void worker_dismissed(void) { exit(ST_OK); }

void worker_push(struct worker *w)
{
    if (!buf_size(&w->out)) return;
    if (write_full(STDOUT_FILENO, buf_data(&w->out), buf_size(&w->out)) != 0)
        worker_reader_gone(errno);
    buf_consume(&w->out, buf_size(&w->out));
}

int worker_announce(struct worker *w, const struct frame_size *f, char err[WORKER_ERR])
{
    struct worker_job *known = frames_extra(&w->frames, f);
    if (known->announced) return 0;
    worker_pulse_begin();
    int failed = w->ops->ready(w->ctx, f, err);
    worker_pulse_end();
    if (failed) return failed;
    char extra[WITH_MAX + 32], job[sizeof known->hash];
    w->ops->job(w->ctx, job);
    snprintf(extra, sizeof extra, "with=%.*s%s", WITH_MAX, w->ops->with(w->ctx),
        w->ops->replayed ? " kind=replayed" : "");
    wire_job(&w->out, f, job, extra);
    if (*known->hash && strcmp(known->hash, job) != 0)
        snprintf(w->other_job, sizeof w->other_job,
            "frame %u: has job %s here, expected %s: the same scene or grid and specification, "
            "with the same options",
            f->frame, job, known->hash);
    memcpy(known->hash, job, sizeof job);
    known->announced = true;
    return 0;
}

/* A film has many frames of a state that does not fit: one message is enough. */
void worker_fail(
    struct worker *w, struct buf *to, const struct task *t, const char *slot, const char *why)
{
    struct worker_job *known = frames_extra(&w->frames, frames_find(&w->frames, t->frame));
    char said[WORKER_ERR];
    snprintf(said, sizeof said, "%.*s", (int)strcspn(why, ","), why);
    if (!known->failed && strcmp(said, w->said) != 0) warn("frame %" PRIu32 ": %s", t->frame, why);
    known->failed = true;
    memcpy(w->said, said, sizeof said);
    wire_failed(to, t, WIRE_REFUSED, why, slot);
    w->failed = true;
}

struct frame_size *worker_frame(struct worker *w, const struct record *r)
{
    struct frame_size *f = frames_find(&w->frames, r->task.frame);
    struct worker_job *known = f ? frames_extra(&w->frames, f) : NULL;
    char job[sizeof known->hash] = "";
    bool same = f && f->w == r->frame_w && f->h == r->frame_h && known->announced;
    if (rec_str(r, "job", job, sizeof job)) same = same && strcmp(job, known->hash) == 0;
    if (same && f->generation == w->generations.now) return NULL;
    f = frames_set(&w->frames, r->task.frame, r->frame_w, r->frame_h);
    generation_frame(&w->generations, f);
    known = frames_extra(&w->frames, f);
    memcpy(known->hash, job, sizeof job);
    return f;
}

const struct frame_size *worker_frame_of(const struct worker *w, const struct task *t)
{
    const struct frame_size *f = frames_find(&w->frames, t->frame);
    if (!f)
        die(ST_USAGE, "task %u %u: no such frame, expected `frame` before its tasks", t->frame,
            t->id);
    if (!lattice_valid(&t->at, f->w, f->h))
        die(ST_USAGE, "task %u %u: expected pixels inside %ux%u", t->frame, t->id, f->w, f->h);
    if (!generation_lives(&w->generations, f))
        die(ST_USAGE, "task %u %u: its state was replaced too often, expected it earlier", t->frame,
            t->id);
    return f;
}

void worker_drop_older(struct worker *w, enum rec_kind kind, size_t bytes)
{
    uint32_t oldest = generation_oldest(&w->generations, kind, bytes);
    for (; w->dropped != oldest; w->dropped++)
        if (w->ops->drop) w->ops->drop(w->ctx, w->dropped);
}

_Noreturn void worker_refuse(const struct record *r)
{
    die(ST_USAGE,
        "standard input: record `%s`, expected scene, grid, spec, files, frame, task or "
        "flush",
        rec_name(r->kind));
}
