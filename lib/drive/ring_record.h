/* Ring messages of policies (sched.h) to records and back. */
#ifndef STORMRING_DRIVE_RING_H
#define STORMRING_DRIVE_RING_H

#include "sched/sched.h"
#include "wire/wire.h"

/* Reads r, a valid record of its direction, into m; false if it is no ring message. */
bool drive_ring_of(const struct record *r, struct ring *m);
/* Appends the message of a, a SCHED_SAY, for slot `to`; -1: for the hub. */
void drive_ring_say(struct buf *b, const struct sched_action *a, int32_t to);

#endif
