/* The places of an entry of slots: with fan -1, place i of s is slot s->number + i. */
#ifndef STORMRING_FAN_PLACE_H
#define STORMRING_FAN_PLACE_H

#include "wire/wire.h"

struct fan;
struct fan_slot;

/* One of the slots that have one worker. */
struct fan_place {
    int32_t undone;   /* tasks not computed */
    int64_t heard_us; /* last record of this slot, or of no certain one */
    bool out;         /* the worker has said `gone` of it, and not `up` since */
};

/* Report it: `gone` with this number of tasks; `up`, unless the worker has lost it. */
void fan_place_gone(struct fan *f, const struct fan_slot *s, int i, const char *why, int32_t lost);
void fan_place_up(struct fan *f, const struct fan_slot *s, int i);
/* The worker has lost it, with its tasks; and has it back. */
void fan_place_lose(struct fan *f, struct fan_slot *s, int i, const char *why);
void fan_place_back(struct fan *f, struct fan_slot *s, int i);
void fan_place_hear(struct fan_slot *s, const struct record *r);
/* True if a slot with these tasks must say something. */
bool fan_slot_owes(const struct fan *f, const struct fan_slot *s, int32_t undone, int32_t n_tasks);
/* Makes s as silent as its most silent place. `reading`: its records are read. */
void fan_places_silence(const struct fan *f, struct fan_slot *s, bool reading);

#endif
