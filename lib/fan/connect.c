/*
 * fan: the order of connecting. A server limits connections that have not
 * authenticated yet (sshd's MaxStartups), so only a few are opened at a time. First tries go before
 * retries. A host that was not up yet, or whose last connection failed, is tried by one slot at a
 * time: it refuses only once, and dead hosts do not delay live ones.
 */
#include "fan/fan_int.h"

#define OPENING_MOST 8
#define STARTING_MOST 2 /* on this machine, per round of the loop */
#define TURN_MS 500     /* the longest wait between two looks */

static bool may_open(const struct fan *f, const struct fan_slot *s, int64_t now)
{
    if (s->state != FAN_WAITING || s->retry_us > now || !fan_slot_wanted(f, s)) return false;
    const struct fan_host *h = s->host;
    if (h->here) return true;
    bool alone = !h->reached || h->failures;
    bool room = f->connecting < OPENING_MOST || !fan_host_limited(h);
    return room && !(alone && h->opening) && h->retry_us <= now;
}

int fan_connect(struct fan *f)
{
    int64_t now = now_us(), first_us = now + TURN_MS * INT64_C(1000);
    int here = 0; /* slots started on this machine */
    if (!f->n[FAN_WAITING]) return TURN_MS;
    for (int further = 0; further <= 1; further++)
        for (int k = 0; k < f->n_slots; k++) {
            struct fan_slot *s = &f->slots[k];
            bool first = !s->failures && !s->host->failures;
            if (first == further || !may_open(f, s, now)) continue;
            if (s->host->here && here++ >= STARTING_MOST) continue;
            fan_slot_open(f, s);
        }
    if (here > STARTING_MOST) return 0;
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        int64_t turn_us = s->retry_us > s->host->retry_us ? s->retry_us : s->host->retry_us;
        if (s->state == FAN_WAITING && turn_us > now && turn_us < first_us) first_us = turn_us;
    }
    return (int)((first_us - now + 999) / 1000);
}
