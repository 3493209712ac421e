/* The messages of a ring, as policies know them (sched.h), to records and back. */
#ifndef STORMRING_DRIVE_RING_H
#define STORMRING_DRIVE_RING_H

#include "sched/sched.h"
#include "wire/wire.h"

/* What r, which came as it should in its direction, says; false where it is no record of a ring. */
bool ring_of(const struct record *r, struct ring *m);
/* a, a SCHED_SAY, for slot `to`; -1: for the hub. */
void ring_say(struct buf *b, const struct sched_action *a, int32_t to);

#endif
