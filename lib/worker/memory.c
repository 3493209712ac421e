/*
 * memory: whether a state fits the memory that this process may still take. It is asked before a
 * record arrives, and again before it is loaded.
 */
#include "worker/worker_int.h"

#include <string.h>

bool worker_fits(double loaded, size_t bytes, bool here, char err[WORKER_ERR])
{
    if (bytes < STREAM_LONG) return true;
    /* The record is freed, or returned page by page, before all of the state is there. */
    return stream_fits(fmax((double)bytes, loaded) - (here ? (double)bytes : 0),
        loaded + (here ? 0 : stream_buffer(bytes)), err);
}

void worker_consider(struct worker *w)
{
    size_t bytes, n = 0;
    const enum rec_kind kind = w->ops->needs ? stream_arrives(&w->in, &bytes) : REC_KINDS;
    if (kind == REC_KINDS) return;
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
