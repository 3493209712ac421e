/* fan: failures of slots and hosts: when the next try may be, and what is said. */
#include "fan/fan_int.h"

#include <inttypes.h>
#include <string.h>

#define REPEATS_US 60000000 /* a slot that is lost again in this time is counted */

int64_t fan_retry_wait_us(const struct fan_host *h, int failures)
{
    int64_t wait_us = PATIENCE_RETRY_FIRST_US;
    const int heads = fan_host_heads(h);
    for (int i = heads; i < failures && wait_us < PATIENCE_RETRY_MOST_US; i += heads) wait_us *= 2;
    return wait_us < PATIENCE_RETRY_MOST_US ? wait_us : PATIENCE_RETRY_MOST_US;
}

void fan_say_gone(struct fan *f, struct fan_slot *s, const char *why, bool lost)
{
    if (s->told_gone && !(lost && s->n_tasks)) return;
    for (int i = 0; i < s->width; i++) {
        struct buf extra = {0};
        buf_printf(&extra, "w=%d why=%s lost=%" PRId32 " recv_us=%" PRId64 " host=%s",
            s->number + i, why, lost ? s->tasks[i].count : 0, now_us() - f->start_us,
            s->host->host->name);
        wire_said(&extra, lost ? s->conn.said : "");
        buf_append(&extra, "", 1);
        wire_plain(&f->out.queue.bulk, REC_GONE, (const char *)buf_data(&extra));
        up_end_record(&f->out.queue);
        buf_free(&extra);
    }
    s->told_gone = true;
}

const char *fan_patience_text(const struct fan *f, char text[FAN_PATIENCE_TEXT])
{
    double s = (double)fan_patience_us(f) / 1e6;
    if (s < 120) snprintf(text, FAN_PATIENCE_TEXT, "%g s", s);
    else snprintf(text, FAN_PATIENCE_TEXT, "%g minutes", s / 60);
    return text;
}

void fan_say_repeats(struct fan_host *h)
{
    if (h->repeats)
        warn("%s%s: losses for the same reason that were not shown: %d",
            h->here ? "this machine" : h->host->name, fan_host_heads(h) > 1 ? " and its rack" : "",
            h->repeats);
    h->repeats = 0;
}

void fan_say_lost(struct fan_slot *s, const char *why, int32_t lost, bool again, const char *hint)
{
    char name[SLOT_NAME];
    const int64_t now = now_us();
    bool same = strcmp(why, s->lost_why) == 0 && now - s->lost_us < REPEATS_US;
    s->n_told = same ? s->n_told + 1 : 1;
    s->repeats = again && s->n_told > fan_host_heads(s->host);
    s->host->repeats += s->repeats;
    if (s->repeats) return;
    if (!again || *s->lost_why) fan_say_repeats(s->host);
    snprintf(s->lost_why, sizeof s->lost_why, "%s", why);
    s->lost_us = now;
    const struct host *heir = again ? host_heir(s->host->host) : NULL;
    warn("%s: lost (%s) with %" PRId32 " tasks%s%s%s", fan_slot_name(s, name), why, lost,
        heir            ? FAN_LED_BY
        : !again        ? ""
        : s->host->here ? ", starting again"
                        : ", connecting again",
        heir ? heir->name : "", hint);
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

bool fan_host_exhausted(const struct fan_host *h)
{
    return h->host->tries && h->failures >= h->host->tries * fan_host_heads(h);
}

bool fan_host_retries(struct fan_slot *s)
{
    struct fan_host *h = s->host;
    if (s->conn.opened_us >= h->failed_us) { /* slots opened at one time fail as one */
        h->failed_us = now_us();
        h->retry_us = h->failed_us + fan_retry_wait_us(h, ++h->failures);
    }
    return !fan_host_exhausted(h);
}

void fan_complain(const struct fan *f, struct fan_slot *s, const char *why, bool again)
{
    struct buf text = {0};
    char patience[FAN_PATIENCE_TEXT];
    bool last;
    const char *says = *s->conn.chatter ? ", it says: " : "";
    if (s->conn.probe_us) says = ", while its link was measured"; /* after its hello */
    if (!fan_refusal_explain(f, s, why, &text))
        buf_printf(&text, "%s: cannot be %s (%s)%s%s", s->host->host->name,
            again ? "reached" : "used", why, says, s->conn.chatter);
    const bool next = again && s->host->failures < fan_host_heads(s->host);
    const struct host *heir = next ? host_heir(s->host->host) : NULL;
    if (heir) buf_printf(&text, FAN_LED_BY "%s", heir->name);
    else if (again && host_wanted(f, s->host, &last)) {
        buf_printf(&text, "; trying again");
        if (s->host->host->tries) buf_printf(&text, ", %d times in all", s->host->host->tries);
        else if ((last || (s->host->reached && !f->n[FAN_UP])) && !f->listing)
            buf_printf(&text, " for up to %s", fan_patience_text(f, patience));
    }
    if (fan_host_exhausted(s->host))
        buf_printf(&text, "; no try is left (tries=%d)", s->host->host->tries);
    buf_append(&text, "", 1);
    warn("%s", (const char *)buf_data(&text));
    buf_free(&text);
}
