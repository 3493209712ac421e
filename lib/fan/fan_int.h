/*
 * fan, shared by its files: loop.c; down.c (the input); slot.c (the life of a slot); connect.c
 * (which slots are connected next, and what is reported about hosts); refusal.c (why a connection
 * failed); hello.c (which workers are let in); up.c (what workers send); err.c (their standard
 * error); list.c (fan -l).
 */
#ifndef STORMRING_FAN_INT_H
#define STORMRING_FAN_INT_H

#include "fan/fan.h"
#include "pipe/pipe.h"

/* When no slot is up, and none that may come up was for so long, no host is left. */
#define UNREACHED_S 30.0

enum fan_state { FAN_WAITING, FAN_OPENING, FAN_UP, FAN_LEAVING, FAN_GONE, FAN_STATES };

struct fan_host {
    const struct host *host;
    char **argv;       /* what is run for each of its slots */
    bool here;         /* this machine: no connection that could fail */
    int opening;       /* slots that are being connected */
    int failures;      /* connections in a row that failed: one slot at a time tries again, */
    int64_t retry_us;  /* and not before */
    int64_t failed_us; /* when that was last counted */
    bool reached;      /* a slot of it was up */
    enum { FAN_QUIET, FAN_RETRIED, FAN_ENDED } said; /* why it is not up, since a slot of it was */
    uint64_t told;     /* hash of the last line of its standard error */
    int64_t window_us; /* when the count of lines shown began */
    int shown;
    int64_t dropped; /* lines not shown, and not reported yet */
};

struct fan_slot {
    int number;
    struct fan_host *host;
    enum fan_state state;

    struct child child;
    size_t poll; /* the place of child.to in the last poll, .from behind it, then .err; 0: none */
    struct decoder from;
    struct buf err;      /* of its standard error, a line that is not whole yet */
    struct buf held;     /* lines of its standard error that may tell why the connection fails */
    int reason;          /* of that, in refusal.c; */
    char detail[200];    /* the line that told it */
    char chatter[160];   /* what it said first, when that was no hello */
    size_t before_hello; /* bytes */
    int64_t opened_us;   /* when its process was started */
    int64_t heard_us;    /* when something moved last */
    int64_t leave_us;    /* leaving: it has until then to exit */

    /* of this connection */
    bool connected; /* it said hello, and was let in */
    bool loaded;    /* it has announced a frame */
    bool loading;   /* since it was last sent state, it has not */
    int64_t agreed; /* the frame about whose job it last said what the first slot did, -1 */
    bool flushed;   /* it was asked for what it holds back */
    bool asked;     /* its input had been closed when its stream ended */
    bool decided;   /* leaving: why is known, and has been said */
    bool again;     /* leaving: then it is connected again */
    bool did;       /* it has done and delivered a task */
    bool placed;    /* it was told its place in a ring: what it says to the hub is passed on */
    int stale;      /* answers to questions not asked */
    int64_t ahead;  /* messages of a node, beyond those that were sent to it */
    int64_t beat_us;
    int64_t closed_us; /* when its input was closed, and hello was said; 0: not yet */

    /* of all of them */
    bool was_up;
    bool told_gone;     /* `gone` was said, and `up` not since */
    bool measured;      /* fan -l: nothing more is to be learnt */
    int64_t trip_us;    /* from then to its bye; 0: not known */
    int failures;       /* connections in a row over which no task was done, */
    int deaths;         /* and over which tasks were lost */
    int64_t retry_us;   /* waiting: not before */
    int64_t missing_us; /* not up since then */
    double power;       /* 0: not known yet */
    int inner;          /* slots of its own that it stands for */

    struct down_queue down;
    bool primed;             /* down begins with the state, and what follows it is added */
    bool behind;             /* it lags: the latest state was not added */
    uint32_t since;          /* the first generation that it was sent then */
    uint32_t sent[3];        /* the latest record of each kind of state, by number; 0: none */
    struct task_table tasks; /* sent, and not yet both done and delivered */
    int32_t undone;          /* of these, not done */
};

/* What every hello has to agree with. */
struct fan_reference {
    char program[64], selftest[24]; /* program: its name and version */
    char of[HOST_NAME_MOST + 4];    /* who said it; "": nobody yet */
};

/* State of one generation, and the frames that are of it. */
struct fan_state_of {
    struct blob *kind[3]; /* scene, grid, spec; NULL: none */
    uint32_t number[3];   /* which of all records of state they are, from 1 on */
    struct buf frame_lines;
};

struct fan {
    const struct fan_options *o;
    int n_slots, n_hosts;
    struct fan_slot *slots;
    struct fan_host *hosts;
    int n[FAN_STATES]; /* slots in each state */
    int connecting;    /* those that are opening elsewhere */
    int well;          /* slots that have ended as they should */
    struct fan_reference reference;
    struct decoder in;
    struct stream_state input;
    struct fan_state_of states[GENERATIONS]; /* of each that may have tasks, modulo that */
    uint32_t n_states;                       /* records of state that came */
    bool begun;                              /* a task of the latest has come */
    struct outlet out;
    struct buf line;     /* a record on its way down */
    int64_t start_us;    /* the zero of sent_us and recv_us */
    int64_t awake_us;    /* by then the next round was to begin */
    int64_t lost, stale; /* tasks lost with their slots; answers to questions not asked */
    bool disputed;       /* slots have pixels of different jobs, and nobody knows who is right */
    bool unreached;      /* tasks were waiting to the end for slots that never were up */
    bool asked;          /* a task came */
    bool in_open;
    bool listing; /* fan -l: slots are asked for their hello, and that is all */
    int refused;  /* the status to end with at once: the input is bad, or cannot be read */
};

/* ---- loop.c ---- */

void fan_open(struct fan *f, const struct fan_options *o, bool listing);
/* One round of the loop; p has room for FAN_POLL(f) entries. */
void fan_round(struct fan *f, struct pollfd *p);
#define FAN_POLL(f) ((size_t)(f)->n_slots * 3 + 2)
/* Can anything still come of it? */
bool fan_working(const struct fan *f);
/* Ends what runs, and frees everything. */
void fan_close(struct fan *f);

/* ---- down.c ---- */

/* One read of the input, and everything that can be decoded from it, to the slots. */
void fan_take_input(struct fan *f);
/* What a slot needs before its first task, where that is of this generation; and where it is not
 * known of which that will be. */
void fan_prime(struct fan *f, struct fan_slot *s, uint32_t generation);
void fan_prime_early(struct fan *f, struct fan_slot *s);
/* Frees what is kept of a generation. */
void fan_forget(struct fan_state_of *state);
/* It is sent what comes, or that waits for it because there are tasks for it. */
bool fan_takes(const struct fan_slot *s);
/* No slot has more queued than it should. */
bool fan_room_down(const struct fan *f);

/* ---- slot.c ---- */

/* Starts the process of a slot that waits. */
void fan_slot_open(struct fan *f, struct fan_slot *s);
/* It has said hello, and is let in. */
void fan_slot_up(struct fan *f, struct fan_slot *s);
/* Sends one task record to slot k, and keeps account of it. 0, or the status to end with. */
int fan_slot_send(struct fan *f, int k, const struct record *r, const struct frame_size *frame);
/* It is sent what is queued for it. */
bool fan_slot_fed(const struct fan_slot *s);
/* Writes to the slot what its pipe takes. */
void fan_slot_feed(struct fan *f, struct fan_slot *s, const struct pollfd *p);
/*
 * Gives the slot's process up and says `gone`, with the number of tasks that went with it; `again`:
 * only the connection is at fault.
 */
void fan_slot_lose(struct fan *f, struct fan_slot *s, const char *why, bool again);
/* The stream of slot s has ended: it is given a moment to exit. */
void fan_slot_leave(struct fan *f, struct fan_slot *s);
/* Has a slot that is leaving exited, in good order or not? Or must it be killed? */
void fan_slot_left(struct fan *f, struct fan_slot *s);
/* A slot that waits is given up with its host. */
void fan_slot_give_up(struct fan *f, struct fan_slot *s, const char *why);
/* Is there, or may there be, work for a slot that is not up? */
bool fan_slot_wanted(const struct fan *f, const struct fan_slot *s);
/* It is up, or may come up. */
bool fan_slot_comes(const struct fan_slot *s);
/* Frees what the slot holds besides its process. */
void fan_slot_free(struct fan_slot *s);

/* ---- connect.c ---- */

/* Starts those whose turn it is. Returns in how many milliseconds another may have its turn. */
int fan_connect(struct fan *f);
/* Whom a message is about: "slot 3", "slot 3 on render1". */
#define SLOT_NAME (HOST_NAME_MOST + 32)
const char *fan_slot_name(const struct fan_slot *s, char text[SLOT_NAME]);
/* How long to wait after so many failures in a row. */
int64_t fan_retry_wait_us(int failures);
/*
 * Slot s could not be connected: that is said, once for the host, and what to do. The other slots
 * of the host need not be waited for either; unless it is tried again they are given up.
 */
void fan_host_failed(struct fan *f, struct fan_slot *s, const char *why, bool again);
/* `gone` for slot s, unless that has been said. */
void fan_say_gone(struct fan *f, struct fan_slot *s, const char *why, int32_t lost);

/* ---- hello.c ---- */

/* Asks a worker on this machine for what other hosts have to agree with. */
void fan_ask_reference(struct fan *f);
/* NULL, or why the slot is refused; it is up when it is not. */
const char *fan_take_hello(struct fan *f, struct fan_slot *s, const struct record *r);

/* ---- refusal.c ---- */

/* A connection begins: nothing was said about its failing. */
void fan_refusal_forget(struct fan_slot *s);
/* Does this line of standard error tell, or begin to tell, why it fails? Then it is held. */
bool fan_refusal_holds(const struct fan *f, struct fan_slot *s, const char *line, size_t n);
/* Was it refused in such words that no second try can help? Only where the host never was up. */
bool fan_refusal_is_final(const struct fan_slot *s);
/* Appends the reason and what to do, and drops the lines that were held; or returns false. */
bool fan_refusal_explain(
    const struct fan *f, struct fan_slot *s, const char *why, struct buf *text);

/* ---- up.c, err.c ---- */

/* Everything that can be decoded from slot s. */
void fan_slot_listen(struct fan *f, struct fan_slot *s);
/* The beginning of a line as messages show it. */
void fan_printable(char *to, size_t room, const char *line, size_t n);
/* Shows what the slot wrote to its standard error, line by line. */
void fan_slot_show_err(const struct fan *f, struct fan_slot *s);
/* The rest of it; then it is closed. */
void fan_slot_end_err(const struct fan *f, struct fan_slot *s);
/* What was held: it was not about a failure, or another one. */
void fan_slot_show_held(struct fan_slot *s);
/* Says how much of the hosts' messages was not shown. */
void fan_end_err(struct fan *f);

#endif
