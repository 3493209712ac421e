/* Queries about a whole log: see history.h. */
#include "history/history.h"

#include <inttypes.h>
#include <string.h>

bool history_wasted(const struct history *l, const struct history_done *d)
{
    return l->n_frags ? !d->pixels : d->before >= 0;
}

bool history_same(const struct history *l, const struct history *other, char err[HISTORY_ERR])
{
    if (!other->n_frags || !l->n_frags) {
        snprintf(err, HISTORY_ERR, "no pixels, expected two logs with pixels to compare");
        return false;
    }
    if (l->n_frames != other->n_frames) {
        snprintf(err, HISTORY_ERR, "%zu frames, expected %zu as in the other log", l->n_frames,
            other->n_frames);
        return false;
    }
    for (size_t i = 0; i < other->n_frames; i++) {
        const struct history_frame *f = &other->frames[i], *own = history_frame_of(l, f->number);
        if (!own || strcmp(f->job, own->job) != 0) {
            snprintf(err, HISTORY_ERR, "frame %" PRIu32 ": job %s, expected %s", f->number,
                own ? own->job : "none", f->job);
            return false;
        }
        if (f->have.done != own->have.done) {
            snprintf(err, HISTORY_ERR,
                "frame %" PRIu32 ": %" PRIu64 " pixels, expected %" PRIu64 " as in the other log",
                f->number, own->have.done, f->have.done);
            return false;
        }
        bool same = own->w == f->w && own->h == f->h;
        for (uint64_t p = 0; same && p < (uint64_t)f->w * f->h; p++)
            same = coverage_has(&f->have, p) == coverage_has(&own->have, p);
        if (!same) {
            snprintf(err, HISTORY_ERR,
                "frame %" PRIu32 ": other pixels, expected those of the other log", f->number);
            return false;
        }
    }
    return true;
}
