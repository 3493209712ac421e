/* fan's router, shared by its files: fan.c (the loop), fan_slot.c (slots), fan_up.c (what
 * workers say). */
#ifndef STORMRING_FAN_INT_H
#define STORMRING_FAN_INT_H

#include "drive/drive.h"

struct fan_slot {
    int number;
    struct child child;
    struct down_queue down;
    struct decoder from;
    struct task_table tasks; /* sent, and not yet both done and delivered */
    bool hello, loaded;      /* it has said hello; it has announced a frame */
    bool ended;              /* its stream has ended, or it was given up */
    int64_t heard_us;
};

struct fan {
    const struct fan_options *o;
    struct fan_slot *slots;
    int alive;
    struct decoder in;
    struct frames frames;
    struct up_queue up;
    char selftest[24];   /* of the first slot that said hello */
    int64_t start_us;    /* the zero of sent_us and recv_us */
    int64_t lost, stale; /* tasks lost with their slots; answers to questions not asked */
    bool in_open;
};

/* Starts slot k's worker; a slot that cannot be started is gone. */
void slot_start(struct fan *f, int k);
/* Sends one task record to slot k, and keeps account of it. */
void slot_send(struct fan *f, int k, const struct record *r);
/* Kills what is left of the slot and says `gone`, with the number of tasks that went with it. */
void slot_lose(struct fan *f, struct fan_slot *s, const char *why);
/* The stream of slot s has ended: in good order, or not. */
void slot_finish(struct fan *f, struct fan_slot *s);
/* Everything that can be decoded from slot s. */
void slot_listen(struct fan *f, struct fan_slot *s);

#endif
