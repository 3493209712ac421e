/* Reading ring records: messages between the hub and its nodes, see ringctl(1). */
#include "wire/wire.h"

#include <inttypes.h>
#include <string.h>

/* An optional number; -1 if absent. */
static bool number(const struct record *r, const char *key, int64_t max, int32_t *out)
{
    size_t len;
    int64_t v = -1;
    if (rec_key(r, key, &len) && !rec_int(r, key, 0, max, &v)) return false;
    *out = (int32_t)v;
    return true;
}

/* A value that is one of two words. */
static bool either(
    const struct record *r, const char *key, const char *no, const char *yes, bool *out)
{
    char text[16];
    if (!rec_str(r, key, text, sizeof text)) return false;
    *out = strcmp(text, yes) == 0;
    return *out || strcmp(text, no) == 0;
}

bool rec_ring(const struct record *r, struct rec_ring *m)
{
    int32_t idle;
    *m = (struct rec_ring){0};
    if (!number(r, "peer", WIRE_SLOTS_MAX - 1, &m->peer) ||
        !number(r, "next", WIRE_SLOTS_MAX - 1, &m->next) ||
        !number(r, "me", WIRE_SLOTS_MAX - 1, &m->me) || !number(r, "n", WIRE_SLOTS_MAX, &m->n) ||
        !number(r, "takes", WIRE_TAKES_MOST, &m->takes) || !number(r, "idle", 1, &idle))
        return false;
    if (m->takes < 0) m->takes = 0;
    m->idle = idle == 1;
    switch (r->kind) {
    case REC_RING:
        return m->me >= 0 && m->me < m->n &&
               either(r, "rules", "default", "published", &m->published);
    case REC_ASK: return true;
    case REC_HEIR:
    case REC_NONE:
    case REC_GIVE:
    case REC_CRASHED: return m->peer >= 0;
    default: return false;
    }
}
