/* fan's router, shared by its files: fan.c (the loop), fan_down.c (what comes from the input),
 * fan_slot.c (slots), fan_up.c (what workers say). */
#ifndef STORMRING_FAN_INT_H
#define STORMRING_FAN_INT_H

#include "drive/drive.h"

struct fan_slot {
    int number;
    struct child child;
    size_t poll; /* the place of child.to in the last poll, .from behind it */
    struct down_queue down;
    struct decoder from;
    struct task_table tasks; /* sent, and not yet both done and delivered */
    int32_t undone;          /* of these, not done */
    bool flushed;            /* it was asked for what it holds back */
    bool hello, loaded;      /* it has said hello; it has announced a frame */
    bool ended;              /* its stream has ended, or it was given up */
    bool asked;              /* its input had been closed when its stream ended */
    int64_t heard_us;
    int64_t leave_us; /* its stream has ended: it has until then to exit; else 0 */
};

struct fan {
    const struct fan_options *o;
    struct fan_slot *slots;
    int alive, leaving;
    struct decoder in;
    struct frames frames;
    struct outlet out;
    struct buf line;     /* a record on its way down */
    char selftest[24];   /* of the first slot that said hello */
    int64_t start_us;    /* the zero of sent_us and recv_us */
    int64_t lost, stale; /* tasks lost with their slots; answers to questions not asked */
    bool in_open;
    int refused; /* the status to end with at once: the input is bad, or cannot be read */
};

/* One read of the input, and everything that can be decoded from it, to the slots. */
void fan_take_input(struct fan *f);

/* Starts slot k's worker; a slot that cannot be started is gone. */
void slot_start(struct fan *f, int k);
/* Sends one task record to slot k, and keeps account of it. 0, or the status to end with. */
int slot_send(struct fan *f, int k, const struct record *r, const struct frame_size *frame);
/* Writes to the slot what its pipe takes. */
void slot_feed(struct fan *f, struct fan_slot *s, const struct pollfd *p);
/* Frees what the slot holds besides its process. */
void slot_free(struct fan_slot *s);
/* Kills what is left of the slot and says `gone`, with the number of tasks that went with it. */
void slot_lose(struct fan *f, struct fan_slot *s, const char *why);
/* The stream of slot s has ended: it is given a moment to exit. */
void slot_leave(struct fan *f, struct fan_slot *s);
/* Has a slot that is leaving exited, in good order or not? Or must it be killed? */
void slot_left(struct fan *f, struct fan_slot *s);
/* Everything that can be decoded from slot s. */
void slot_listen(struct fan *f, struct fan_slot *s);

#endif
