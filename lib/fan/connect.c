/*
 * fan: the order of connecting, and messages about hosts. A server limits connections that have not
 * authenticated yet (sshd's MaxStartups), so only a few are opened at a time. First tries go before
 * retries. A host that was not up yet, or whose last connection failed, is tried by one slot at a
 * time: it refuses only once, and dead hosts do not delay live ones.
 * One machine with down.c, err.c, hello.c, join.c, refusal.c, slot.c and up.c.
 */
#include "fan/fan_int.h"

#include <inttypes.h>
#include <string.h>

#define OPENING_MOST 8
#define STARTING_MOST 2       /* on this machine, per round of the loop */
#define TURN_MS 500           /* the longest wait between two looks */
#define RETRY_FIRST_US 500000 /* before a slot is connected again; doubled each time */
#define RETRY_MOST_US 10000000

static bool may_open(const struct fan *f, const struct fan_slot *s, int64_t now)
{
    if (s->state != FAN_WAITING || s->retry_us > now || !fan_slot_wanted(f, s)) return false;
    const struct fan_host *h = s->host;
    if (h->here) return true;
    bool alone = !h->reached || h->failures;
    bool room = f->connecting < OPENING_MOST || !fan_host_limited(h);
    return room && !(alone && h->opening) && h->retry_us <= now;
}

bool fan_host_limited(const struct fan_host *h) { return !h->here && h->host->wait_s <= 0; }

bool fan_slot_in_queue(const struct fan_slot *s)
{
    return s->state == FAN_QUEUED || (s->state == FAN_OPENING && s->host->host->wait_s > 0);
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

int64_t fan_retry_wait_us(int failures)
{
    int64_t wait_us = RETRY_FIRST_US;
    for (int i = 1; i < failures && wait_us < RETRY_MOST_US; i++) wait_us *= 2;
    return wait_us < RETRY_MOST_US ? wait_us : RETRY_MOST_US;
}

const char *fan_slot_name(const struct fan_slot *s, char text[SLOT_NAME])
{
    char numbers[32];
    if (s->width == 1) snprintf(numbers, sizeof numbers, "slot %d", s->number);
    else snprintf(numbers, sizeof numbers, "slots %d to %d", s->number, s->number + s->width - 1);
    if (s->host->here) snprintf(text, SLOT_NAME, "%s", numbers);
    else snprintf(text, SLOT_NAME, "%s on %s", numbers, s->host->host->name);
    return text;
}

void fan_say_gone(struct fan *f, struct fan_slot *s, const char *why, bool lost)
{
    if (s->told_gone && !(lost && s->n_tasks)) return;
    for (int i = 0; i < s->width; i++) fan_place_gone(f, s, i, why, lost ? s->tasks[i].count : 0);
    s->told_gone = true;
}

/* True if a slot of the host is needed. *last: no other host has slots that may come. */
static bool host_wanted(const struct fan *f, const struct fan_host *h, bool *last)
{
    bool wanted = false;
    *last = true;
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        if (s->host == h) wanted |= fan_slot_wanted(f, s);
        else if (fan_slot_comes(s)) *last = false;
    }
    return wanted;
}

/* tries= allows no other connection. */
static bool exhausted(const struct fan_host *h)
{
    return h->host->tries && h->failures >= h->host->tries;
}

bool fan_host_retries(struct fan_slot *s)
{
    struct fan_host *h = s->host;
    if (s->conn.opened_us >= h->failed_us) { /* slots opened at one time fail as one */
        h->failed_us = now_us();
        h->retry_us = h->failed_us + fan_retry_wait_us(++h->failures);
    }
    return !exhausted(h);
}

/* Prints the failure. `why` is the reason if neither ssh nor the remote shell gave a better one. */
static void complain(const struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    struct buf text = {0};
    bool last;
    if (!fan_refusal_explain(f, s, why, &text))
        buf_printf(&text, "%s: cannot be %s (%s)%s%s", s->host->host->name,
            again ? "reached" : "used", why, *s->conn.chatter ? ", it says: " : "",
            s->conn.chatter);
    if (again && host_wanted(f, s->host, &last)) {
        buf_printf(&text, "; trying again");
        if (s->host->host->tries) buf_printf(&text, ", %d times in all", s->host->host->tries);
        else if (last && !f->listing) buf_printf(&text, " for up to %g s", UNREACHED_S);
    }
    if (exhausted(s->host)) buf_printf(&text, "; no try is left (tries=%d)", s->host->failures);
    buf_append(&text, "", 1);
    warn("%s", (const char *)buf_data(&text));
    buf_free(&text);
}

void fan_host_failed(struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    struct fan_host *h = s->host;
    bool ends = !again && (!h->reached || exhausted(h));
    if (h->said == FAN_QUIET || (h->said == FAN_RETRIED && ends)) complain(f, s, why, again);
    else fan_refusal_forget(s);
    h->said = again ? FAN_RETRIED : FAN_ENDED;
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *other = &f->slots[k];
        if (other->host != h || other->state != FAN_WAITING) continue;
        other->measured |= s->measured;
        if (again) fan_say_gone(f, other, why, false);
        else if (ends) fan_slot_give_up(f, other, why);
    }
}
