/*
 * fan: a poll loop that runs a worker on each slot, and routes tasks and fragments. It knows slots,
 * and no policy. It ends quietly when its reader is gone, and then nothing it started is left.
 */
#ifndef STORMRING_FAN_H
#define STORMRING_FAN_H

#include "hosts/hosts.h"

struct fan_options {
    const struct hosts *hosts;
    char *const *command; /* NULL-ended: the worker, one for each slot */
    bool trips;           /* fan -l: round trips as well */
    double silence_s;     /* a slot that has work and says nothing for so long is lost */
};

/* Runs until the input has ended and every slot is done. Returns the exit status. */
int fan_run(const struct fan_options *o);
/*
 * Writes a line for each slot: number, host, power; with trips how long it takes from the end of a
 * worker's input to its bye, in milliseconds. What the hosts do not state is asked for, where there
 * is a command, by starting it on every such slot. Returns the exit status.
 */
int fan_list(const struct fan_options *o);

#endif
