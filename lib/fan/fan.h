/*
 * fan: a poll loop that runs a worker on each slot, and routes tasks and fragments. It knows slots,
 * but no policy. When its reader is gone it ends quietly, and ends all processes that it started.
 */
#ifndef STORMRING_FAN_H
#define STORMRING_FAN_H

#include "hosts/hosts.h"

#define FAN_MOST 4096 /* workers, and so connections, of one fan */
#define FAN_ASKED 4   /* fan -l: slots of a host that are measured: all are on one machine */

enum fan_pack { FAN_PACK_AUTO, FAN_PACK_ON, FAN_PACK_OFF };

struct fan_options {
    struct hosts *hosts;     /* racks change their heads */
    char *const *command;    /* NULL-ended: the worker, one for each slot */
    struct hosts_sent *sent; /* programs for hosts without any, by hosts_send */
    bool trips;              /* fan -l: round trips as well */
    bool one_each;      /* one worker for each host, with -j SLOTS, instead of one for each slot */
    bool racks;         /* the hosts are racks (hosts_racks) */
    enum fan_pack pack; /* records of other machines */
    double silence_s;   /* a slot that has work is lost after this silence */
};

/* Runs until the input has ended and every slot is done. Returns the exit status. Blocks. */
int fan_run(const struct fan_options *o);
/*
 * Writes a line for each slot: number, host, power; with `trips` also the time from the end of a
 * worker's input to its bye, in milliseconds, and the least power. If there is a command, starts it
 * on hosts that do not state these values, on four slots at most, and measures them. Returns the
 * exit status.
 */
int fan_list(const struct fan_options *o);

#endif
