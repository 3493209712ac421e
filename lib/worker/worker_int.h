/*
 * worker, shared by its files: run.c (from hello to exit); power.c (the power that hello states);
 * loop.c (the loop of one process);
 * forks.c (the loop of a parent whose children render), fork_slot.c (such a child), builder.c (the
 * thread that loads and builds); session.c (frames, jobs and states of both); pulse.c (beats);
 * states.c (the state of a renderer); memory.c (whether a state fits).
 */
#ifndef STORMRING_WORKER_INT_H
#define STORMRING_WORKER_INT_H

#include "pipe/pipe.h"
#include "worker/worker.h"

#include <pthread.h>

/* Payload of a frame: its job. */
struct worker_job {
    char hash[WIRE_JOB]; /* as the input states it, then as announced; "": neither */
    bool announced;      /* the worker has said it */
    bool failed;         /* the worker has said why it is not done */
};

struct worker {
    const struct worker_ops *ops;
    const struct worker_options *options;
    void *ctx;
    struct decoder in;
    struct buf out, held; /* held: the frags that -c holds */
    bool packs;           /* the reader takes packed frags */
    uint32_t held_of;     /* the generation of `held` */
    uint32_t dropped;     /* first generation that is not dropped */
    struct frames frames;
    struct generations generations;
    float *pixels;
    int64_t cpu_us;             /* used at the latest done or other record */
    bool failed;                /* a task could not be rendered */
    char refusal[WORKER_ERR];   /* why the latest state that did not fit was refused */
    char said[WORKER_ERR];      /* and what a message said of one; without what the host may use */
    char other_job[WORKER_ERR]; /* a frame has another job than the input stated; "": none has */
};

/* ---- pulse.c ---- */

/* From now on begin and end enclose each callback, during which beats are sent. Without it they do
 * nothing. */
void worker_pulse_open(void);
void worker_pulse_begin(void);
void worker_pulse_end(void);
/* To be called before standard input is read, between these two or outside: appends what the pulse
 * has read there. True if that was anything. */
bool worker_pulse_last(struct buf *to);
/* To be called after that with what waits to be decoded. */
void worker_pulse_heard(const struct buf *in);

/* ---- session.c ---- */

/* The reader is gone (EPIPE or 0), or writing failed: this process is not needed any more. */
_Noreturn void worker_reader_gone(int err);
/* Its input says that the run is over. */
_Noreturn void worker_dismissed(void);
/* Writes w->out. */
void worker_push(struct worker *w);
/* Appends to w->out the job of the frame's pixels, unless it was announced. Returns 0, or what
 * `ready` returns: state is missing or refused, with text in err. Another job than the input stated
 * sets w->other_job; the caller sends w->out and ends the program. */
int worker_announce(struct worker *w, const struct frame_size *f, char err[WORKER_ERR]);
/* Takes a frame record. Returns the frame if its job is to be announced, or NULL if the record
 * repeats a frame that was announced. */
struct frame_size *worker_frame(struct worker *w, const struct record *r);
/* The frame of a task; a task without one, or whose state was dropped, ends the program. */
const struct frame_size *worker_frame_of(const struct worker *w, const struct task *t);
/* Says that the task, of slot "w=K" or NULL, cannot be done; and why, once for each frame. */
void worker_fail(
    struct worker *w, struct buf *to, const struct task *t, const char *slot, const char *why);
/* A record of this kind is here or on its way: drops state that is too old then. */
void worker_drop_older(struct worker *w, enum rec_kind kind, size_t bytes);
/* Refuses a record that does not belong to the input. */
_Noreturn void worker_refuse(const struct record *r);

/* ---- loop.c ---- */

/* Reads standard input to its end, renders, and says bye. */
void worker_loop(struct worker *w);

/* ---- memory.c ---- */

/* True if a state of this length, which takes `loaded` bytes more when it is loaded, fits in
 * memory; else err says what it needs. here: the record or file is in memory already. */
bool worker_fits(double loaded, size_t bytes, bool here, char err[WORKER_ERR]);
/* Call after a read of the input: a state record that does not fit is dropped as it arrives. */
void worker_consider(struct worker *w);
/* The wire_room of its input: the same of a state that this host has kept. */
wire_room worker_room;
/* True if the state record can be loaded; else w->refusal says why not. */
bool worker_loads(struct worker *w, const struct record *r);

/* ---- builder.c ---- */

struct worker_builder {
    const struct worker *w;
    pthread_t thread;
    int done[2]; /* a pipe: readable when the thread is about to end */
    bool busy;   /* from the start of the thread to worker_builder_join */
    /* its work */
    uint32_t generation;
    enum rec_kind kind;
    unsigned char *body; /* of a state record; NULL: build for `frame` */
    size_t n;
    struct frame_size frame;
    /* its result */
    int failed; /* as the operation returns it */
    char err[WORKER_ERR];
};
void worker_builder_open(struct worker_builder *b, const struct worker *w);
void worker_builder_close(struct worker_builder *b);
/* Loads the record, which is counted as the latest state. The body must stay until the join. */
void worker_builder_load(struct worker_builder *b, const struct record *r, unsigned char *body);
/* Builds for the frame. */
void worker_builder_build(struct worker_builder *b, const struct frame_size *f);
/* Waits for the thread to end. */
void worker_builder_join(struct worker_builder *b);

/* ---- forks.c ---- */

/* Children forked in a round of the loop: a fork copies page tables, a millisecond for each
 * 0.5 GB, and others wait meanwhile. */
#define FORKS_MOST 2

/* A slot: a child that renders, and the tasks for it. */
struct fork_slot {
    int number;
    struct child child;
    size_t poll; /* index of child.to in the last poll; .from follows; 0: none */
    struct decoder from;
    struct down_queue to;
    uint32_t generation;      /* the latest one when the child was forked */
    bool ends;                /* its input is to be closed, once all of it is written */
    bool flush;               /* it is to flush after its waiting tasks */
    bool flushed;             /* it was asked to, and got no task since */
    struct task_table tasks;  /* all that follow; the payload is a struct fork_task */
    struct task_list waiting; /* tasks not sent to the child */
    struct task_list sent;    /* tasks not both computed and delivered */
    int undone;               /* sent tasks that are not computed */
    int64_t silent_us;        /* its silence while this process was reading */
    bool refused;             /* the system has refused to fork a child for the waiting tasks */
    bool lent;                /* other slots have had tasks of this one */
};
struct fork_task {
    int of;        /* the slot that it is for; this one, unless it is lent */
    bool computed; /* its `done` has come, from this child or one before */
    bool again;    /* it has come from this child */
    int losses;    /* children that were lost while they computed it */
};

struct forks {
    struct worker *w;
    struct fork_slot *slots;
    int n_slots;
    struct task_table tasks; /* tasks for any slot, all of them on the list */
    struct task_list any;
    struct worker_builder builder;
    bool built[GENERATIONS];  /* by generation, modulo GENERATIONS */
    char *unfit[GENERATIONS]; /* likewise: why its tasks cannot be done; NULL: nothing is known */
    bool wants;               /* the builder is to build for this frame: */
    struct frame_size wanted;
    bool holds;         /* this record waits for the builder, or for tasks: */
    struct record held; /* in the decoder's buffer */
    bool flushed;       /* children were asked to flush for it */
    bool in_open;
    int forked;  /* children forked in this round; above FORKS_MOST: one could not be */
    int refused; /* status to end with at once */
    struct outlet out;
    int64_t beat_us;
    int64_t looked_us; /* time of the last round */
};

/* As worker_run after the hello, with options->jobs children that share this process's state. */
int worker_forks(struct worker *w);
/* True if tasks of the generation can be rendered. */
static inline bool worker_forks_built(const struct forks *p, uint32_t generation)
{
    return p->built[generation % GENERATIONS];
}

/* ---- fork_slot.c ---- */

void worker_fork_open(struct fork_slot *s, int number);
void worker_fork_free(struct fork_slot *s);
/* Adds a task of a frame of this width, which is for slot `of`. False: the slot has it already. */
bool worker_fork_add(struct fork_slot *s, const struct task *t, uint32_t frame_w, int of);
/* Adds a task to slot t->to, unless that has it already. */
void worker_fork_give(struct forks *p, const struct task *t, uint32_t frame_w);
/* Says of the waiting tasks of this generation that they cannot be done, and why. */
void worker_fork_fail(struct forks *p, struct fork_slot *s, uint32_t generation, const char *why);
/* Lends the waiting tasks of a slot that was refused a child to slots that have one. A task waits
 * on if no slot can take it now. */
void worker_fork_lend(struct forks *p, struct fork_slot *s);
/* Sends the child what it can take; forks it if it is needed. */
void worker_fork_feed(struct forks *p, struct fork_slot *s);
/* Handles all that the child has sent. */
void worker_fork_listen(struct forks *p, struct fork_slot *s);
/* Ends the slot's child if its stream has ended or it was silent for too long. */
void worker_fork_check(struct forks *p, struct fork_slot *s, int64_t elapsed_us);
/* True if a task would be computed at once, or after at most `ahead` others. */
bool worker_fork_wants(
    const struct forks *p, const struct fork_slot *s, int ahead, uint32_t generation);

#endif
