/*
 * fan: the slots that have one worker (fan -1), each with a process of its own. One may be lost,
 * and come back, while the others work; and one may hang.
 */
#include "fan/fan_int.h"

#include <inttypes.h>

void fan_place_gone(struct fan *f, const struct fan_slot *s, int i, const char *why, int32_t lost)
{
    char extra[128];
    snprintf(extra, sizeof extra, "w=%d why=%s lost=%" PRId32 " recv_us=%" PRId64, s->number + i,
        why, lost, now_us() - f->start_us);
    wire_plain(&f->out.queue.bulk, REC_GONE, extra);
    up_end_record(&f->out.queue);
}

void fan_place_up(struct fan *f, const struct fan_slot *s, int i)
{
    char text[HOST_NAME_MOST + 64];
    if (s->places[i].out) return;
    snprintf(text, sizeof text, "w=%d host=%s power=%.6g slots=%d", s->number + i,
        s->host->host->name, s->power, s->inner);
    wire_plain(&f->out.queue.bulk, REC_UP, text);
    up_end_record(&f->out.queue);
}

void fan_place_lose(struct fan *f, struct fan_slot *s, int i, const char *why)
{
    struct fan_place *place = &s->places[i];
    int32_t lost = s->tasks[i].count;
    fan_place_gone(f, s, i, why, lost);
    f->lost += lost;
    s->n_tasks -= lost;
    s->undone -= place->undone;
    tasks_free(&s->tasks[i]);
    *place = (struct fan_place){.out = true};
    s->dismissed += s->drains; /* the policy will not do that */
}

void fan_place_back(struct fan *f, struct fan_slot *s, int i)
{
    if (!s->places[i].out || s->drains) return;
    s->places[i].out = false;
    fan_place_up(f, s, i);
}

/* A record without w= is about the worker as a whole. */
void fan_place_hear(struct fan_slot *s, const struct record *r)
{
    int32_t place = s->width > 1 ? rec_slot(r) : -1;
    for (int i = 0; i < s->width; i++)
        if (place < 0 || place == i) s->places[i].heard_us = now_us();
}

/* A slot with these tasks must say something. Pixels of computed ones may be held back until a
 * flush. */
bool fan_slot_owes(const struct fan *f, const struct fan_slot *s, int32_t undone, int32_t n_tasks)
{
    return undone || (n_tasks && (s->feed.flushed || !f->in_open));
}

/*
 * One process of a worker may hang while the others work. So the worker is as silent as the most
 * silent of its slots that must say something, once it was written all that is for them.
 */
void fan_places_silence(const struct fan *f, struct fan_slot *s, bool reading)
{
    for (int i = 0; s->width > 1 && i < s->width; i++) {
        struct fan_place *p = &s->places[i];
        bool must = reading && fan_slot_owes(f, s, p->undone, s->tasks[i].count);
        if (!must || down_size(&s->feed.queue)) p->heard_us = now_us();
        else if (p->heard_us < s->conn.heard_us) s->conn.heard_us = p->heard_us;
    }
}
