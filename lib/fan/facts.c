/* fan: what is true of a slot, its name in messages, and what its host may print there. */
#include "fan/fan_int.h"

bool fan_slot_has_stream(const struct fan_slot *s)
{
    return s->state == FAN_OPENING || s->state == FAN_QUEUED || s->state == FAN_UP;
}

bool fan_slot_comes(const struct fan_slot *s)
{
    return s->state != FAN_GONE && s->state != FAN_ENDING;
}

bool fan_slot_wanted(const struct fan *f, const struct fan_slot *s)
{
    if (s->drains) return false;
    if (f->listing) return !s->measured;
    return f->in_open || s->n_tasks || (s->host->here && !s->was_up);
}

bool fan_slot_over(const struct fan *f, const struct fan_slot *s)
{
    return !f->in_open || s->dismissed == s->width;
}

bool fan_slot_fed(const struct fan_slot *s)
{
    /* Before its hello only if it is not started again: what was written would be lost. */
    return s->state == FAN_UP || (s->state == FAN_OPENING && s->host->here && s->width == 1);
}

int64_t fan_patience_us(const struct fan *f)
{
    bool any = false;
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        if (s->host->here || s->drains || !fan_slot_comes(s)) continue;
        if (!s->host->reached) return PATIENCE_UNREACHED_US;
        any = true;
    }
    return any ? PATIENCE_RETURN_US : PATIENCE_UNREACHED_US;
}

bool fan_host_limited(const struct fan_host *h) { return !h->here && h->host->wait_s <= 0; }

bool fan_slot_in_queue(const struct fan_slot *s)
{
    return s->state == FAN_QUEUED || (s->state == FAN_OPENING && s->host->host->wait_s > 0);
}

struct fan_slot *fan_slot_of(const struct fan *f, int k)
{
    int low = 0, high = f->n_slots; /* it is one of low .. high - 1 */
    if (f->n_numbers == f->n_slots) return &f->slots[k];
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (f->slots[middle].number <= k) low = middle;
        else high = middle;
    }
    return &f->slots[low];
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

void fan_printable(char *to, size_t room, const char *line, size_t n)
{
    size_t i = 0;
    for (; i < n && i + 1 < room && line[i] != '\n'; i++)
        to[i] = (char)(line[i] >= ' ' && line[i] <= '~' ? line[i] : '?');
    to[i] = '\0';
}
