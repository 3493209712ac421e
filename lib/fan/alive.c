/*
 * fan: the silence of this end. A worker on a host that was cut off, or under a stopped sshd, sees
 * no end of its input. It is told for how long this end may be silent, and gets beats more often.
 * At the end of the run it is told that, too.
 */
#include "fan/fan_int.h"

#define BEATS 4 /* in this time */

static double within_s(const struct fan *f) { return PATIENCE_ALIVE_TIMES * f->o->silence_s; }

/* The launcher of a worker that is killed reports a failure, as srun does; one that ends by itself
 * is quiet. ssh is quiet in both cases, and faster. */
bool fan_alive_end(struct fan_slot *s)
{
    bool hears = s->state == FAN_UP && s->conn.told_us && s->conn.child.to >= 0;
    if (!hears || s->host->by_ssh || down_size(&s->feed.queue)) return false;
    bool told = fan_slot_tell(s, REC_BYE, NULL);
    if (told) child_close(&s->conn.child.to);
    return told;
}

/* It is written whole, or the pipe is full, and then it need not be. */
static void tell(struct fan_slot *s, enum rec_kind kind, const char *extra)
{
    fan_slot_tell(s, kind, extra);
    s->conn.told_us = now_us();
}

void fan_alive_begin(struct fan *f, struct fan_slot *s, const struct record *r)
{
    char text[40];
    int64_t reads;
    if (s->host->here || s->conn.child.to < 0 || !rec_int(r, "alive", 1, 1, &reads)) return;
    snprintf(text, sizeof text, "within=%g", within_s(f));
    tell(s, REC_ALIVE, text);
}

void fan_alive_beat(struct fan *f, struct fan_slot *s)
{
    if (!s->conn.told_us || s->conn.child.to < 0) return;
    if (fan_slot_fed(s) && down_size(&s->feed.queue)) return; /* that tells it as well */
    if ((double)(now_us() - s->conn.told_us) >= within_s(f) / BEATS * 1e6) tell(s, REC_BEAT, NULL);
}
