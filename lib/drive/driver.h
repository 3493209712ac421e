/* The live driver, shared by its files: policy.c (the loop, and its input), up.c (what the
 * command sends), tell.c (events, and what the policy does), losses.c (tasks that cost slots) and
 * room.c (state that does not fit in a node's memory). */
#ifndef STORMRING_DRIVER_H
#define STORMRING_DRIVER_H

#include "drive/drive.h"
#include "drive/tags.h"
#include "pipe/pipe.h"

/* Why tasks were lost, and what was given up. */
struct losses {
    struct buf reason;       /* of the event that the policy is told now */
    struct task_table tasks; /* that slots were lost over */
    bool some;               /* some were given up, */
    bool all;                /* and all of a frame: the last one was */
    uint32_t frame;
};

/* State that does not fit in memory. */
struct lacks {
    unsigned char kinds[GENERATIONS]; /* a bit for each kind of state, by generation, modulo this */
    enum rec_kind latest;             /* of the latest that did not fit, */
    char why[ERR_BYTES];              /* and why */
    bool said;                        /* that was printed */
    struct buf tasks;                 /* refused, and the policy is not told yet */
};

struct driver {
    const struct policy *policy;
    void *state;
    struct sched_actions acts;
    struct child child;
    struct down_queue down;
    struct outlet out;
    struct decoder in, from;
    struct stream_state input;
    struct tags tags;
    struct losses losses;
    struct lacks lacks;
    struct buf held;  /* state that is not admitted yet; the input waits behind it */
    uint32_t oldest;  /* the oldest live generation before `held` */
    int64_t heard_us; /* when the command last sent something or was asked to */
    bool in_open, closing;
    bool stopping;  /* nothing that the command still does is needed */
    bool dismissed; /* the input has said so, with `bye` */
    bool node;      /* of a ring */
    bool lone;      /* the command is one slot, not a fan */
    int refused;    /* status to end with at once */
    char why[24];   /* reason in the command's bye: it ended early */
};

/* An event for the policy; carries out its actions. */
void drive_tell(struct driver *d, struct sched_event e);
/* Asks slot `to`, or all (-1), to flush. */
void drive_flush(struct driver *d, int32_t to);
void drive_losses_init(struct losses *l);
void drive_losses_free(struct losses *l);
/* Notes why the slot of r, a gone or fail, is lost or has failed. */
void drive_reason(struct driver *d, const struct record *r);
/* Carries out a BLAME, COMMIT or ABANDON. */
void drive_blame(struct driver *d, const struct sched_action *a);
void drive_forgive(struct driver *d, const struct task *t);
void drive_abandon(struct driver *d, const struct sched_action *a);
/* The input of a node drops bodies that do not fit: after the first call, call the second one after
 * each read. */
void drive_room_init(struct driver *d);
void drive_consider(struct driver *d);
/* A state record has come, dropped or not; `before` was the latest generation. */
void drive_room_state(struct driver *d, const struct record *r, uint32_t before);
/* True if this generation has state that was dropped. */
bool drive_lacks(const struct driver *d, uint32_t generation);
/* Says that the task, of such a generation, cannot be computed. */
void drive_refuse(struct driver *d, const struct task *t);
/* The event of such a task, once; false: there is none. */
bool drive_refused(struct driver *d, struct sched_event *e);
/* Handles records from the command. False at the end of its stream. */
bool drive_listen(struct driver *d);

#endif
