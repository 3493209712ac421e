/* fan: a host and its connections, and payloads of tasks and frames. */
#ifndef STORMRING_FAN_HOST_H
#define STORMRING_FAN_HOST_H

#include "hosts/hosts.h"
#include "pipe/pipe.h"

#define FAN_TOLD 32 /* lines that a host is not shown to repeat */

/* A host, or a command, through which ssh connects to others. */
struct fan_jump {
    char *name;
    int opening; /* slots being connected through it */
};

struct fan_host {
    struct host *host;
    char **argv;       /* command line of each of its slots */
    bool here;         /* this machine: no connection can fail */
    bool by_ssh;       /* its launcher is ssh */
    bool asked;        /* it is known how ssh connects to it: */
    int jump;          /* number in f->jumps, counted from 1; 0: directly, or not known */
    bool kept;         /* join.c: the new version of the file has it */
    bool removed;      /* it is no longer in the file: all of its slots drain */
    int opening;       /* slots being connected */
    int failures;      /* failed connections in a row: one slot at a time retries */
    int64_t retry_us;  /* not before this time */
    int64_t failed_us; /* when `failures` was last counted */
    bool reached;      /* a slot of it was up */
    bool given;        /* and was sent tasks */
    bool told_queued;  /* a message said that it is queued, and no slot of it was up since */
    enum { FAN_QUIET, FAN_RETRIED, FAN_ENDED } said; /* message printed since a slot of it was up */
    bool told_plain;         /* it was reported that its worker cannot pack */
    uint64_t told[FAN_TOLD]; /* hashes of lines of failed connections since a slot was lost; */
    unsigned n_told;         /* the next one replaces number n_told % FAN_TOLD */
    int repeats;       /* losses of its slots that were not printed, and not yet counted out */
    int64_t window_us; /* start of the count of lines shown */
    int shown;
    int64_t dropped; /* lines not shown, and not yet reported */
};

/* The hosts that can be connected for a slot of this one: several for a rack. */
static inline int fan_host_heads(const struct fan_host *h)
{
    return h->host->n_members ? (int)h->host->n_members : 1;
}

/* A slot was lost while it computed this task. */
#define FAN_DEATHS 64
struct fan_death {
    uint32_t frame, id;
    int32_t slot;
    bool excused; /* others were lost over it too */
};

/* Payload of a task of a slot. */
struct fan_task {
    int64_t sent_us; /* when the slot was sent it, since the fan's start */
    int32_t from;    /* the node that it was stolen from; -1: none */
    bool computed;   /* the slot has sent its `done` */
};

/* Payload of a frame: its job. */
struct fan_job {
    bool stated; /* the input or a slot has stated this hash: */
    char hash[WIRE_JOB];
    int32_t by;            /* the slot that stated it first; -1: the input */
    int32_t agree, differ; /* slots that stated this job; another one */
    bool well;             /* a task of it was done */
    int64_t vote;          /* number of this count of them, ascending */
};

#endif
