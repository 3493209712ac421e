/*
 * fan: slow links. Records of slots on other machines are packed if that saves time: if the link
 * is slower than the coder. The link is measured before the slot is up, while nothing else is on
 * its way: the worker answers a probe, a code record, with the number of bytes that the probe asks
 * for. If the answer comes fast, a longer one is asked for. A round trip counts as transfer, so a
 * link can seem slower than it is, but not faster. The answer also names the state that the host
 * has kept: its hash is sent instead.
 */
#include "coder/coder.h"
#include "fan/fan_int.h"
#include "keep/keep.h"

#include <stdlib.h>

#define PROBE_FIRST (16 << 10)
#define PROBE_GROWS 8 /* times */
#define PROBE_LAST (PROBE_FIRST * PROBE_GROWS * PROBE_GROWS)
#define FAST 16 /* bytes per microsecond, 128 Mbit/s: then a longer answer says more */

_Static_assert(PROBE_LAST <= WIRE_PROBE_MAX, "the answer to a probe is one record");

/* The pipe of the slot is empty, so this is written whole; or the slot is gone, which the end of
 * its stream will tell. */
static void ask(struct fan_slot *s, size_t bytes)
{
    char text[32];
    snprintf(text, sizeof text, "probe=%zu", bytes);
    fan_slot_tell(s, REC_CODE, text);
    s->conn.probe_bytes = bytes;
    s->conn.probe_us = s->conn.heard_us = now_us();
}

/* Both ends pack from the first record on. */
static void pack(struct fan_slot *s)
{
    struct buf line = {0};
    wire_plain(&line, REC_CODE, "zstd=1");
    down_begin(&s->feed.queue, buf_data(&line), buf_size(&line));
    buf_free(&line);
    s->feed.queue.packs = true;
}

void fan_code_begin(struct fan *f, struct fan_slot *s, const struct record *hello)
{
    bool apart = !s->host->here && f->o->pack != FAN_PACK_OFF && !f->listing;
    s->conn.from.coded = apart && coder_there() && rec_is(hello, "zstd", "1");
    if (s->conn.from.coded && f->o->pack == FAN_PACK_AUTO) {
        ask(s, PROBE_FIRST);
        return;
    }
    if (s->conn.from.coded) pack(s);
    else if (apart && f->o->pack == FAN_PACK_ON && !s->host->told_plain) {
        warn("%s: sends plain pixels: its worker was built without libzstd", s->host->host->name);
        s->host->told_plain = true;
    }
    fan_slot_up(f, s);
}

bool fan_code_waits(const struct fan_slot *s)
{
    return fan_slot_has_stream(s) && s->state != FAN_UP && s->conn.probe_us;
}

void fan_code_late(struct fan *f, struct fan_slot *s, int64_t looked_us)
{
    if (!fan_code_waits(s) || looked_us - s->conn.probe_us < PATIENCE_PROBE_US) return;
    pack(s);
    fan_slot_up(f, s);
}

const char *fan_take_code(struct fan *f, struct fan_slot *s, const struct record *r)
{
    char has[KEEP_LIST];
    if (!s->conn.probe_bytes || r->body_len != s->conn.probe_bytes) return "wrong-record";
    s->conn.probe_bytes = 0;
    free(s->feed.queue.keeps);
    s->feed.queue.keeps = rec_str(r, "has", has, sizeof has) ? xstrdup(has) : NULL;
    if (!fan_code_waits(s)) return NULL; /* late */
    int64_t us = now_us() - s->conn.probe_us;
    double link = (double)r->body_len / (double)(us > 0 ? us : 1);
    if (link > FAST && r->body_len < PROBE_LAST) {
        ask(s, r->body_len * PROBE_GROWS);
        return NULL;
    }
    if (f->coder_speed <= 0) f->coder_speed = coder_speed();
    if (coder_pays(link, f->coder_speed)) pack(s);
    fan_slot_up(f, s);
    return NULL;
}
