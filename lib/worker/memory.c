/*
 * memory: whether a state fits the memory that this process may still take. It is asked before a
 * record arrives, and again before it is loaded. What a state takes is an estimate from below, so
 * that no state is refused that fits.
 */
#include "proc/proc.h"
#include "worker/worker_int.h"

#include <string.h>

#define SMALL_BYTES (1 << 20) /* a shorter state always fits */
#define HEAD_BYTES (1 << 18)  /* of a state decide, because its head is in them */
#define MIB 1048576.0

static bool refuse(double needs, double may, char err[WORKER_ERR])
{
    return err_set(err, "out of memory: needs about %.0f MiB, this host may use %.0f MiB",
        ceil(needs / MIB), floor(may / MIB));
}

bool worker_fits(double loaded, size_t bytes, bool here, char err[WORKER_ERR])
{
    double buffer = HEAD_BYTES; /* the record's, which is doubled until it has room */
    if (bytes < SMALL_BYTES) return true;
    while (!here && buffer < (double)bytes) buffer *= 2;
    const struct proc_memory may = proc_memory("");
    /* The record is freed, or returned page by page, before all of the state is there. */
    const double memory = fmax((double)bytes, loaded) - (here ? (double)bytes : 0),
                 addresses = loaded + (here ? 0 : buffer);
    if (memory > may.bytes) return refuse(memory, may.bytes, err);
    if (addresses > may.addresses) return refuse(addresses, may.addresses, err);
    return true;
}

void worker_consider(struct worker *w)
{
    size_t bytes, n = 0;
    if (!w->ops->needs || w->in.drops || buf_size(&w->in.in) > HEAD_BYTES) return;
    const enum rec_kind kind = wire_awaited(&w->in, &bytes);
    if (kind == REC_KINDS || bytes < SMALL_BYTES) return;
    const size_t have = buf_size(&w->in.in);
    const unsigned char *line = buf_data(&w->in.in), *end = memchr(line, '\n', have),
                        *start = end ? end + 1 : NULL;
    if (start) n = have - (size_t)(start - line);
    if (!worker_fits(w->ops->needs(w->ctx, kind, start, n, bytes), bytes, false, w->refusal))
        wire_drop(&w->in);
}

bool worker_room(void *ctx, size_t bytes)
{
    struct worker *w = ctx;
    return !w->ops->needs || worker_fits(0, bytes, false, w->refusal);
}

bool worker_loads(struct worker *w, const struct record *r)
{
    if (!r->body) return false;
    if (!w->ops->needs) return true;
    const double loaded = w->ops->needs(w->ctx, r->kind, r->body, r->body_len, r->body_len);
    return worker_fits(loaded, r->body_len, true, w->refusal);
}
