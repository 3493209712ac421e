/* The live driver, shared by its files: policy.c (the loop, and its input), up.c (what the
 * command sends), tell.c (events, and what the policy does) and losses.c (tasks that cost
 * slots). */
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
/* Handles records from the command. False at the end of its stream. */
bool drive_listen(struct driver *d);

#endif
