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

#include <poll.h>

struct fan_options {
    const struct hosts *hosts;
    char *const *command; /* NULL-ended: the worker, one for each slot */
    bool trips;           /* fan -l: round trips as well */
    double silence_s;     /* a slot that has work and says nothing for so long is lost */
};

/* Runs until the input has ended and every slot is done. Returns the exit status. */
int drive_fan(const struct fan_options *o);
/*
 * Writes a line for each slot: number, host, power; with trips how long it takes from the end of a
 * worker's input to its bye, in milliseconds. What the hosts do not state is asked for, where there
 * is a command, by starting it on every such slot. Returns the exit status.
 */
int drive_list(const struct fan_options *o);

/* Runs the policy around command (NULL-ended), which is or contains a fan. Returns the exit
 * status. */
int drive_policy(const struct policy *p, const struct sched_params *params, char *const *command);

/* ---- shared by the two ----------------------------------------------------------------------- */

#define UP_QUEUE_MOST (4 << 20)   /* bytes for the reader, then workers have to wait */
#define DOWN_QUEUE_MOST (1 << 20) /* bytes for one child, then the input has to wait */

/* fd with events, or a place that poll ignores. */
struct pollfd poll_entry(int fd, bool wanted, short events);
#define POLL_GONE (POLLERR | POLLHUP | POLLNVAL) /* of a writing end: nobody reads there any more */

/*
 * One read(2) of fd into d; at the end of the stream d is ended. 1, 0 at the end, or -1 with errno,
 * which ends it as well.
 */
int stream_read(struct decoder *d, int fd);

/* The standard output of a driver. */
struct outlet {
    struct up_queue queue;
    size_t most;     /* bytes a write may have */
    bool full;       /* it took less than it was given */
    bool gone;       /* its reader is, or writing fails, which has been said */
    bool greeted;    /* hello has been said */
    int64_t beat_us; /* when outlet_beat last did */
};
void outlet_open(struct outlet *o);
struct pollfd outlet_poll(const struct outlet *o);
/* What poll said of it. */
void outlet_polled(struct outlet *o, const struct pollfd *p);
/* What has just been queued goes out at once, where that cannot block. */
void outlet_push(struct outlet *o);
/*
 * After a read of the input: a body that is long on its way is life as well. Says `beat` now and
 * then, since nobody behind this process knows of it yet.
 */
void outlet_beat(struct outlet *o, const struct decoder *input);
/* A flush came: says `beat`, so that who asked hears something even where nothing was held back. */
void outlet_answer(struct outlet *o);
/* The rest goes to the reader, who may be slow; or until a signal comes. */
void outlet_drain(struct outlet *o);

/*
 * One read(2) of standard input; every record in it goes to take until that returns other than 0:
 * the status to end with at once, or STREAM_HOLD, after which nothing is to be read before
 * stream_take has gone on with what is there. Returns the status to end with, the reason having
 * been said, or 0. *open: more may come.
 */
#define STREAM_HOLD (-1)
typedef int stream_taker(void *ctx, const struct record *r);
int stream_input(struct decoder *d, bool *open, stream_taker *take, void *ctx);
/* The same without reading. */
int stream_take(struct decoder *d, stream_taker *take, void *ctx);
/* The frames of the input, and which state they are of. */
struct stream_state {
    struct frames frames;
    struct generations generations;
};
/* Takes a frame record. */
void stream_frame(struct stream_state *f, const struct record *r);
/* The frame of a task record whose pixels lie in it, and whose state is there; else says what is
 * wrong: NULL. */
const struct frame_size *stream_frame_of(const struct stream_state *f, const struct record *r);
/* Forwards r as one record of the bulk queue. */
void up_forward(
    struct up_queue *q, const struct record *r, const char *const *drop, const char *extra);

#endif
