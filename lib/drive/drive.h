/*
 * drive: the live drivers. They run poll loops over pipes: fan's router, which knows slots and no
 * policy; and the driver of a policy around one command, which turns records into scheduling events
 * and actions into records. Both end quietly when their reader is gone, and then nothing they
 * started is left.
 */
#ifndef STORMRING_DRIVE_H
#define STORMRING_DRIVE_H

#include "proc/proc.h"
#include "sched/sched.h"
#include "wire/wire.h"

struct fan_options {
    int slots;
    char *const *command; /* NULL-ended: the worker, one for each slot */
    double silence_s;     /* a slot that has work and says nothing for so long is lost */
};

/* Runs until the input has ended and every slot is done. Returns the exit status. */
int drive_fan(const struct fan_options *o);

/* Runs the policy around command (NULL-ended), which is or contains a fan. Returns the exit
 * status. */
int drive_policy(const struct policy *p, const struct sched_params *params, char *const *command);

/* ---- shared by the two ----------------------------------------------------------------------- */

#define UP_QUEUE_MOST (4 << 20)   /* bytes for the reader, then workers have to wait */
#define DOWN_QUEUE_MOST (1 << 20) /* bytes for one child, then the input has to wait */

/* fd with events, or a place that poll ignores. */
struct pollfd;
struct pollfd poll_entry(int fd, bool wanted, short events);
/* One read(2) of fd into d; at the end of the stream d is ended. False then, or on an error. */
bool stream_read(struct decoder *d, int fd);
/* Forwards r as one record of the bulk queue. */
void up_forward(
    struct up_queue *q, const struct record *r, const char *const *drop, const char *extra);

#endif
