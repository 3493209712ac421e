/*
 * fan, shared by its files: loop.c; facts.c (what is true of a slot); state.c (what a slot is
 * sent); report.c (failures); excuse.c (those without fault of a slot); down.c (the input); slot.c
 * (the life of a slot); connect.c (the order of connections); join.c (a hosts file that changes);
 * refusal.c (why a connection failed); hello.c (which workers are let in); alive.c (silence of this
 * end); code.c (packed records); up.c (what workers send); err.c (their standard error); send.c
 * (programs for hosts that have none); list.c (fan -l). command.h has command lines.
 */
#ifndef STORMRING_FAN_INT_H
#define STORMRING_FAN_INT_H

#include "fan/command.h"
#include "fan/fan_host.h"
#include "patience/patience.h"
#include "pipe/pipe.h"

/* The life of a slot; the table is at the head of slot.c. */
enum fan_slot_state {
    FAN_NEVER,   /* of no slot: the event cannot happen in the state */
    FAN_WAITING, /* no process; the slot waits for its turn */
    FAN_OPENING, /* a process whose hello has not come */
    FAN_QUEUED,  /* likewise; its launcher may queue it, and others do not wait for it */
    FAN_UP,      /* a worker */
    FAN_CLOSED,  /* its stream has ended; the exit status of its process will tell why */
    FAN_LOST,    /* lost; it will be connected again when its process has ended */
    FAN_ENDING,  /* lost for good; its process has not ended */
    FAN_GONE,    /* no process, and never again */
    FAN_SLOT_STATES
};
enum fan_slot_event {
    ON_START,   /* its turn: a process is started */
    ON_QUEUE,   /* its launcher seems to have queued it */
    ON_HELLO,   /* its hello is accepted */
    ON_EOF,     /* its stream ends */
    ON_RETRY,   /* it is lost, and may be connected again */
    ON_LOSS,    /* it is lost for good */
    ON_EXIT,    /* its process has ended */
    ON_GIVE_UP, /* its host cannot be used */
    FAN_SLOT_EVENTS
};

/* Programs under way to the host, before its hello. */
struct sending {
    struct down_queue queue;
    size_t bytes;   /* all that it asked for */
    unsigned asked; /* bit I: program I was asked for */
    char line[256]; /* what was read of the line that the host prints now: */
    size_t length;
};

/* One process of a slot, and the facts learned from it; CONNECTION_NONE if there is none. */
struct connection {
    struct child child;
    size_t poll; /* index of child.to in the last poll; .from and .err follow; 0: none */
    struct decoder from;
    struct buf err;                /* an incomplete line of its standard error */
    struct buf held;               /* lines of its standard error that may explain a failure */
    const struct refusal *refusal; /* the row of refusal.c that explains it; NULL: none */
    char detail[200];              /* the line that matched this row; or why nothing can be sent */
    struct sending sending;        /* to a host that has no programs */
    char chatter[160];             /* its first output, if that was no hello */
    char said[WIRE_SAID];          /* its last line of standard error since its hello */
    size_t before_hello;           /* bytes before hello */
    int64_t opened_us;             /* start of the process */
    int64_t heard_us;              /* last activity */
    int64_t leave_us;              /* deadline for its exit, once it leaves */
    int64_t beat_us;               /* its last beat that was passed on */
    int64_t closed_us;             /* when its input was closed, at or after hello; 0: not yet */
    int64_t told_us;         /* when it was last told that this end lives; 0: it need not know */
    int64_t ahead;           /* messages of a node, less those sent to it */
    int64_t stale;           /* answers to no question, and pixels that came before */
    int64_t answers;         /* others */
    int64_t news;            /* frames and losses that it announced */
    int64_t probe_us;        /* when the latest probe was sent; 0: none was */
    size_t probe_bytes;      /* the length of the answer that is to come; 0: none is */
    bool connected;          /* it said hello and was accepted */
    bool announced_frame;    /* it has announced a frame */
    bool told_end;           /* ssh has said why the connection ended */
    bool completed_task;     /* it has computed and delivered a task */
    bool placed;             /* it was told its place in a ring: its messages to the hub pass */
    bool input_closed_first; /* the stream ended after its input was closed */
};
#define CONNECTION_NONE ((struct connection){.child = CHILD_NONE, .from = {.upward = true}})

/* Records for a slot. Those of a slot that was not up yet outlive a connection that fails. */
struct feed {
    struct down_queue queue;
    bool primed;    /* the queue begins with the state; later records are added */
    bool behind;    /* the slot lags: the latest state was not added */
    bool loading;   /* it was sent state and has announced no frame since */
    bool flushed;   /* it was asked to flush */
    uint32_t since; /* the first generation sent to it */
    uint32_t
        sent[WIRE_STATE_KINDS]; /* number of the latest record of each kind of state; 0: none */
};

/* A slot; or, with fan -1, all slots of a host that have one worker. */
struct fan_slot {
    int number; /* of the first one */
    int width;  /* number of slots */
    struct fan_host *host;
    enum fan_slot_state state; /* only slot.c changes it */
    struct connection conn;
    struct feed feed;
    struct task_table *tasks; /* of each slot: sent, and not yet both computed and delivered */
    int32_t n_tasks;          /* in all of them */
    int32_t undone;           /* tasks not computed */

    /* Over all connections: */
    bool was_up;
    bool told_gone;     /* `gone` was reported, and `up` not since */
    char lost_why[24];  /* the latest loss that was printed: its reason, */
    int64_t lost_us;    /* and when */
    int n_told;         /* losses for this reason since then: a rack prints one for each head */
    bool repeats;       /* the latest loss was counted instead */
    bool measured;      /* fan -l: nothing is left to measure */
    int64_t trip_us;    /* time from the end of its input to its bye; 0: not known */
    int failures;       /* connections in a row without a completed task */
    int deaths;         /* likewise, if tasks were lost */
    int64_t retry_us;   /* waiting: not before this time */
    int64_t missing_us; /* not up since this time */
    bool drains;        /* it is to leave the run */
    int dismissed;      /* its slots that the policy has dismissed; all: its input ends */
    double power;       /* of each slot; 0: not known */
    double least;       /* its least by the self-test; 0: not known, or a file states the power */
    int inner;          /* number of slots that each stands for */
    int64_t agreed;     /* the latest vote in which it was counted */
};

/* Every hello must agree with this. */
struct fan_reference {
    char program[64], selftest[24]; /* program name and version */
    char of[HOST_NAME_MOST + 4];    /* its source; "": no hello yet */
};

/* State of one generation, and its frames. */
struct fan_state_of {
    struct blob *kind[WIRE_STATE_KINDS]; /* NULL: none */
    uint32_t number[WIRE_STATE_KINDS];   /* number of each record of state, counted from 1 */
    struct buf frame_lines;
};

struct fan {
    const struct fan_options *o;
    int n_slots, n_hosts, room_slots, room_hosts; /* entries of these: */
    struct fan_slot *slots;
    struct fan_host *hosts;
    int n_numbers;          /* slots are numbered 0 .. n_numbers - 1 */
    int n[FAN_SLOT_STATES]; /* slots in each state */
    int connecting;         /* slots that are opening on hosts that are limited */
    int connecting_most;    /* of these at a time */
    int64_t paced_us;       /* no other one before this time */
    int64_t pace_us;        /* from one to the next; 0: not known yet */
    int n_by_ssh;           /* hosts */
    enum { FAN_UNKNOWN, FAN_DIRECT, FAN_JUMPS } configured; /* ssh, to go through others */
    struct fan_jump *jumps;
    int n_jumps;
    int well; /* slots that ended with success */
    struct fan_reference reference;
    struct decoder in;
    struct stream_state input;
    struct fan_state_of states[GENERATIONS]; /* live generations, modulo GENERATIONS */
    uint32_t n_states;                       /* records of state so far, */
    int64_t n_frames;                        /* and of frames */
    int64_t n_votes;                         /* on jobs */
    bool begun;                              /* a task of the latest generation has come */
    struct outlet out;
    int64_t start_us;                    /* zero of sent_us and recv_us */
    int64_t awake_us;                    /* when the next round was due to begin */
    int64_t lost, stale;                 /* tasks lost with their slots; answers to no question */
    int64_t failed;                      /* tasks that a slot could not compute */
    struct fan_death deaths[FAN_DEATHS]; /* the latest, */
    int64_t n_deaths;                    /* of this number: excuse.c */
    bool disputed;                       /* slots disagree on a job, and no majority decides */
    bool unreached;                      /* tasks waited to the end for slots that never were up */
    bool dismissed;                      /* a fan around this one has said that the run is over */
    bool asked;                          /* a task has come */
    double coder_speed; /* bytes that are packed in a microsecond; 0: not measured */
    bool in_open;
    bool listing; /* fan -l: only asks slots for their hello */
    bool joins;   /* the input is from a policy whose slots may join and leave */
    bool ring;    /* it is from the hub of a ring */
    struct hosts_watch watch;
    struct hosts *versions; /* of the hosts file, after the first one */
    int n_versions;
    struct pollfd *poll; /* entries of a round, room for all slots */
    int refused;         /* status to end with at once: the input is bad or unreadable */
};

static inline struct fan_task *fan_task(const struct task_table *tasks, int32_t i)
{
    return tasks_extra(tasks, i);
}
static inline struct fan_job *fan_job(const struct fan *f, const struct frame_size *frame)
{
    return frames_extra(&f->input.frames, frame);
}

/* ---- loop.c ---- */
void fan_open(struct fan *f, const struct fan_options *o, bool listing);
/* One round of the loop. */
void fan_round(struct fan *f);
/* True while a slot works or may still come up. */
bool fan_working(const struct fan *f);
/* Ends all processes, and frees everything. */
void fan_close(struct fan *f);

/* ---- facts.c ---- */
/* The entry of f->slots that has slot k, from 0 to n_numbers - 1. */
struct fan_slot *fan_slot_of(const struct fan *f, int k);
/* True if the slot has a process whose stream has not ended. */
bool fan_slot_has_stream(const struct fan_slot *s);
/* True if the slot is sent what is queued for it. */
bool fan_slot_fed(const struct fan_slot *s);
/* True if there is, or may be, work for a slot that is not up. */
bool fan_slot_wanted(const struct fan *f, const struct fan_slot *s);
/* True if the slot gets no more records than those that are queued for it. */
bool fan_slot_over(const struct fan *f, const struct fan_slot *s);
/* True if the slot is up or may come up. */
bool fan_slot_comes(const struct fan_slot *s);
/* For how long no slot may be up while there is work: longer if every host has been up. */
int64_t fan_patience_us(const struct fan *f);
/* True if few of its connections are opened at a time. Launchers with a queue limit themselves. */
bool fan_host_limited(const struct fan_host *h);
/* The slot's process is being connected by a launcher that may queue it. */
bool fan_slot_in_queue(const struct fan_slot *s);
/* The slot's name in messages: "slot 3", "slot 3 on render1". */
#define SLOT_NAME (HOST_NAME_MOST + 32)
const char *fan_slot_name(const struct fan_slot *s, char text[SLOT_NAME]);
/* Copies a line for use in messages: `room` bytes at most, unprintable bytes as `?`. */
void fan_printable(char *to, size_t room, const char *line, size_t n);

/* ---- state.c ---- */
/* Sends slot s the state that it needs before its first task. The task is of this generation;
 * or, early, of an unknown one. */
void fan_prime(struct fan *f, struct fan_slot *s, uint32_t generation);
void fan_prime_early(struct fan *f, struct fan_slot *s);
/* Frees the state kept for a generation. */
void fan_forget(struct fan_state_of *state);
/* Appends a record of the input for slot k of s, or all (-1), without the key that only this
 * process needs, `to`. A worker with several slots gets its own number of slot k. */
void fan_pass_down(struct buf *to, const struct record *r, const struct fan_slot *s, int k);
/* True if records for the slot are queued: it is fed, or tasks wait for it. */
bool fan_takes(const struct fan_slot *s);
/* Writes a record without numbers to a slot for which nothing is queued, if its pipe takes it:
 * false if not. */
bool fan_slot_tell(const struct fan_slot *s, enum rec_kind kind, const char *extra);

/* ---- excuse.c ---- */
/* Slot s, which has tasks, is lost. True if other slots were lost over what it computed. */
bool fan_excuse(struct fan *f, const struct fan_slot *s);

/* ---- report.c ---- */
#define FAN_LED_BY "; its rack is led by " /* in messages: the next head */
/* The wait before the next try after this number of failures in a row. */
int64_t fan_retry_wait_us(const struct fan_host *h, int failures);
/* True if tries= allows the host no other connection. */
bool fan_host_exhausted(const struct fan_host *h);
/* Counts the failed connection, which sets the time of the next. False if tries= allows none. */
bool fan_host_retries(struct fan_slot *s);
/* Reports `gone` for slot s, unless that was reported. `lost`: with its tasks. */
void fan_say_gone(struct fan *f, struct fan_slot *s, const char *why, bool lost);
/* Prints that slot s was lost; or counts that, if it repeats. The other one prints the number. */
void fan_say_lost(struct fan_slot *s, const char *why, int32_t lost, bool again, const char *hint);
void fan_say_repeats(struct fan_host *h);
/* The time of fan_patience_us. */
#define FAN_PATIENCE_TEXT 32
const char *fan_patience_text(const struct fan *f, char text[FAN_PATIENCE_TEXT]);
/* Prints why slot s could not be connected, with advice. `why` is the reason if neither ssh nor the
 * remote shell gave a better one. */
void fan_complain(const struct fan *f, struct fan_slot *s, const char *why, bool again);

/* ---- down.c ---- */
/* Reads the input once, and routes all records that can be decoded. */
void fan_take_input(struct fan *f);
/* True if no slot's queue is too long. */
bool fan_room_down(const struct fan *f);

/* ---- slot.c ---- */
/* The state after the event; FAN_NEVER: it cannot happen in this state. */
enum fan_slot_state fan_slot_next(enum fan_slot_state state, enum fan_slot_event event);
/* Sets up entry `at` of f->slots: slots from `number` on, on host h. */
void fan_slot_init(struct fan *f, int at, int number, int width, struct fan_host *h);
/* Starts the process of a waiting slot. */
void fan_slot_open(struct fan *f, struct fan_slot *s);
/* The slot's hello was accepted: it is up. */
void fan_slot_up(struct fan *f, struct fan_slot *s);
/* Its power has changed: this is reported if it is up and does not drain. */
void fan_slot_set_power(struct fan *f, struct fan_slot *s, double power);
/* Sends a task record to slot k, and records it. Returns 0, or the status to end with. */
int fan_slot_send(struct fan *f, int k, const struct record *r, const struct frame_size *frame);
/* Writes as much to the slot as its pipe takes. */
void fan_slot_feed(struct fan *f, struct fan_slot *s, const struct pollfd *p);
/*
 * Stops the slot's process and reports `gone`, with the number of tasks lost. `again`: only the
 * connection failed, so the slot may be connected again.
 */
void fan_slot_lose(struct fan *f, struct fan_slot *s, const char *why, bool again);
/* The stream of slot s has ended: gives the process a moment to exit. */
void fan_slot_leave(struct fan *f, struct fan_slot *s);
/* The slot has not said hello for as long as a connection takes: its launcher has queued it. */
void fan_slot_queue(struct fan *f, struct fan_slot *s);
/* True if the stream of the slot has ended, and its process perhaps not. */
bool fan_slot_leaves(const struct fan_slot *s);
/* For such a slot: checks its exit status, if it has exited; kills it after its deadline. */
void fan_slot_left(struct fan *f, struct fan_slot *s);
/* Gives up a waiting slot together with its host. */
void fan_slot_give_up(struct fan *f, struct fan_slot *s, const char *why);
/* Drops its tasks and all records for it. */
void fan_slot_forget(struct fan_slot *s);
/* The same at the end of the run. */
void fan_slot_free(struct fan_slot *s);
/* Ends its process, shows the rest of its messages, and resets the connection. */
void fan_slot_disconnect(const struct fan *f, struct fan_slot *s);

/* ---- connect.c ---- */
/* Starts slots whose turn it is. Returns the milliseconds until another may have its turn. */
int fan_connect(struct fan *f);
/* Sets the number of connections that may be opened at a time, after slots were added. */
void fan_connect_limit(struct fan *f);

/* ---- join.c ---- */
/* Adds a host of this line, without slots; n slots of host h of f->hosts, with the next numbers.
 * Pointers to hosts; and to slots change. */
void fan_add_host(struct fan *f, struct host *line);
void fan_add_slots(struct fan *f, int h, int n);
/* The number of workers of these hosts. */
int fan_workers(const struct fan *f, const struct hosts *h);
/* Takes a new version of the hosts file, if there is one. */
void fan_join(struct fan *f);
/* The policy dismisses slot k. */
void fan_dismiss(struct fan *f, int k);
/* The number of slots that are not to leave. */
int fan_staff(const struct fan *f);

/* ---- hello.c ---- */
/* Asks a worker on this machine for the values that other hosts must agree with. */
void fan_ask_reference(struct fan *f);
/* What a slot says before its hello, and that. NULL, or the reason of refusal. */
const char *fan_take_chatter(struct fan_slot *s, const unsigned char *said, size_t n);
const char *fan_take_hello(struct fan *f, struct fan_slot *s, const struct record *r);

/* ---- alive.c ---- */
/* Slot s was accepted, and sent this hello: elsewhere, it is to end when this end is silent. */
void fan_alive_begin(struct fan *f, struct fan_slot *s, const struct record *r);
/* Writes a beat to the slot, if it is time, and nothing else is on its way. */
void fan_alive_beat(struct fan *f, struct fan_slot *s);
/* Tells a worker behind a launcher that the run is over, and ends its input. False if it cannot be
 * told, or need not be. */
bool fan_alive_end(struct fan_slot *s);

/* ---- code.c ---- */
/* Slot s was accepted, and sent this hello: it is up at once, or once its link is measured. */
void fan_code_begin(struct fan *f, struct fan_slot *s, const struct record *hello);
/* True if the slot waits for the answer to a probe. */
bool fan_code_waits(const struct fan_slot *s);
/* The slot is up if it has waited for too long, and its link is slow. */
void fan_code_late(struct fan *f, struct fan_slot *s, int64_t looked_us);
/* Takes the answer to a probe. Returns NULL, or why the slot cannot be trusted. */
const char *fan_take_code(struct fan *f, struct fan_slot *s, const struct record *r);

/* ---- refusal.c ---- */
/* Drops the held lines and the reason. */
void fan_refusal_forget(struct fan_slot *s);
/* True if this line of standard error may explain a failed connection. The line is held then. */
bool fan_refusal_holds(const struct fan *f, struct fan_slot *s, const char *line, size_t n);
/* True if this line is ssh's on a connection that has ended. */
bool fan_refusal_ends(const char *line, size_t n);
/* True if ssh's message shows that a retry cannot help. Only if the host never was up. */
bool fan_refusal_is_final(const struct fan_slot *s);
/* Appends the reason and advice, and drops the held lines; or returns false. */
bool fan_refusal_explain(
    const struct fan *f, struct fan_slot *s, const char *why, struct buf *text);

/* ---- send.c ---- */
/* Takes the requests for programs that come before hello. NULL, or why the host cannot be used. */
const char *fan_take_requests(struct fan_slot *s, const unsigned char *said, size_t n);
/* True if programs wait to be written to the slot. */
bool fan_slot_is_sent(const struct fan_slot *s);
/* Writes as much of them as its pipe takes. */
void fan_slot_send_more(struct fan_slot *s, const struct pollfd *p);
/* True if it has asked for programs and has not said hello. */
bool fan_slot_has_asked(const struct fan_slot *s);
/* The time that a slow link takes for them, in seconds. */
double fan_send_time_s(const struct fan_slot *s);

/* ---- up.c, err.c ---- */
/* Decodes and handles everything that slot s has sent. */
void fan_slot_listen(struct fan *f, struct fan_slot *s);
/* Shows new lines of the slot's standard error. */
void fan_slot_show_err(const struct fan *f, struct fan_slot *s);
/* Shows the rest of it, and closes it. */
void fan_slot_end_err(const struct fan *f, struct fan_slot *s);
/* Shows the held lines: they did not explain a failed connection. */
void fan_slot_show_held(struct fan_slot *s);
/* Reports the number of lines that were not shown, per host. */
void fan_end_err(struct fan *f);

#endif
