/*
 * sim: policies in virtual time. The shipped object code of a policy is driven by a model of what
 * lies around it: a fan, links with latency and bandwidth, slots of unequal power, and seeded
 * faults. Where the plan names a policy for nodes, each slot runs that one, too, between its link
 * and its worker, which it sees as slot 0 without any delay. One seed is one run, exactly; the same
 * seed gives the same event trace, whose hash is returned.
 *
 * A link keeps the order of control records, and that of pixels; pixels may be overtaken, as in the
 * queues of fan, but not by the news that their slot is gone, or up again. What is on the way to a
 * slot that dies is lost, what it had sent is not. The input is read on while fewer than
 * SCHED_WAITING_MOST tasks wait, as the live driver does. When the hub is killed everything dies
 * with it; a new one gets those tasks of which some pixel had not been passed on.
 *
 * Where a plan has several frames, each has state of its own, and the input waits at a frame until
 * the policy admits it, as the live driver does; meanwhile what is held back is asked for.
 *
 * What is checked of every run, after every event: a task commits once, and only when all of its
 * pixels were passed on; a frame waits exactly while there is a task that is older than those of
 * the frame before; the end comes once, when everything is committed and no pixel is missing; time
 * goes on. The rest is the affair of a policy's own checks (plan.checks), which may be too slow for
 * large runs:
 *
 * sim_checks_deal, of at most SIM_SLOTS_MOST slots:
 *
 *   give      only to a slot that is up, only what is to do, from the pool only up to the depth;
 *             what somebody has already only to a slot that has nothing, when the input has ended
 *             and nothing waits, and only up to SIM_COPIES_MOST times at once; in an endgame also
 *             before, and more often, where it is late
 *   turn      what nobody had goes in the order in which it came, after what was lost
 *   least     where all may have as many, who has least is given to
 *   withheld  what is computed elsewhere, only in an endgame, when that slot is busy, or was asked
 *             for its pixels, and only to a slot that owes none
 *   pieces    of tasks only in an endgame; under new ids, inside one task, beside each other
 *   idle      in an endgame no slot has nothing to do while something may still be copied
 *   revoked   with the depth that follows the link, and the input ended, no slot has more in store
 *             than twice its share of what waits
 *   end       it stops the slots where one is still busy
 *
 * sim_checks_gdc, of the ring as published, whose nodes run policy_node:
 *
 *   rows      in the first phase each to its node, once; then only what a node gives, to whom it
 *             gives it, and what began at a dead node, to who reports that: all of it
 *   messages  go on to whom they are for, as they were said
 *   asking    an idle node asks, and no other does: the one whose turn it is, up the ring; nobody
 *             else before an answer; again, and the fifth time with a report, when it was due
 *   answers   one for each request, between rows: a row where there is one, else whether the node
 *             is idle, and then the one that it found
 *
 * And of runs that are made up: the end comes within the time that the work, the faults and the
 * slowest slot allow.
 */
#ifndef STORMRING_SIM_H
#define STORMRING_SIM_H

#include "sched/sched.h"

#define SIM_SLOTS_MOST 64
#define SIM_COPIES_MOST 3
#define SIM_PIXEL_BYTES 16 /* four floats */

/* What is to be rendered where a plan does not make it up: for measurements. */
struct sim_work {
    uint32_t frame_w, frame_h;
    const struct task *tasks; /* ids 0 .. n-1 of frame 0, in any order */
    const double *pixel_us;   /* what a pixel costs at power 1, row by row */
    const double *power;      /* of the slots */
    double task_us;           /* what a task costs its worker besides, at power 1 */
};

enum sim_fault_kind {
    SIM_CRASH,   /* the slot dies; EOF is seen */
    SIM_SILENCE, /* its connection is half open: the fan gives it up after silence_us */
    SIM_PAUSE,   /* it is silent for less than that, and goes on */
    SIM_SLOW,    /* what it begins from now on takes longer */
    SIM_HANG,    /* it never ends what it is on, and is not silent: no fan gives it up */
    SIM_KILL     /* the hub is killed, and started again later */
};
/* A fault that is not drawn by chance. */
struct sim_fault {
    enum sim_fault_kind kind;
    int32_t slot;
    int64_t at_us;   /* when; or, < 0: */
    int64_t commits; /* when so many tasks are committed */
    double power;    /* SLOW: the slot's power is multiplied by this */
};

struct sim_checks; /* private */
extern const struct sim_checks sim_checks_deal, sim_checks_ring, sim_checks_gdc;

/* Chances are per slot, or per answer; times in microseconds of virtual time. */
struct sim_plan {
    uint64_t seed;
    const struct policy *node;       /* of each slot; NULL: there is a worker behind the link */
    const struct sim_checks *checks; /* NULL: no more than those of every run */
    struct sched_params params;      /* the policy's */
    int32_t slots, tasks;
    int32_t frames;   /* that these are of, one after the other, each of another state; 0 is 1 */
    int32_t window;   /* frames of which tasks may be there at once, up to GENERATIONS; 0 is 2 */
    int32_t rows;     /* of FRAME_W pixels, a task */
    int32_t width;    /* tasks that a slot says it is on at once */
    int32_t assigned; /* so many tasks have to=K */
    bool concentrate; /* slots hand over pixels on a flush only */
    double cost_us;   /* the least that a row costs at power 1; the most is exp(4) times that */
    double p_crash, p_silence, p_pause, p_slow, p_hang; /* at most one of these befalls a slot */
    double p_kill;                                      /* of the hub */
    double p_return;                                    /* a lost slot comes back */
    double p_twice;                                     /* an answer is sent twice */
    double p_garbage;                                   /* an answer names what was not asked */
    double p_false; /* a node says something to its hub that is not so */
    double p_lose, p_double,
        p_late;               /* a ring message is, on each of its links: a datagram's fate */
    int64_t faults_us;        /* faults by chance come before this */
    struct sim_fault *faults; /* the caller's */
    size_t n_faults;
    int64_t detect_us; /* so long it may take that a lost or hung slot is missed, and so the end */
    bool calm;         /* no faults, and enough to do: it must take little longer than the bound */
    int64_t silence_us;
    int64_t latency_us; /* of a link, one way */
    double jitter;      /* a message takes up to this part of the latency more, or less */
    double hops; /* a ring message from node to node: so many latencies; 2: through the hub */
    double link_bytes_per_s, hub_bytes_per_s; /* for pixels: of each link; of all; 0: no limit */
    const struct sim_work *work;              /* NULL: rows of random cost */
    void (*trace)(const char *line);          /* each event in words; NULL: nobody wants them */
};
/* Everything above from the seed alone: small and large, kind and cruel. Slot 0 is never lost. */
struct sim_plan sim_plan_of(uint64_t seed);
/* The same for a ring by its default rules; up to 64 slots. */
struct sim_plan sim_ring_plan_of(uint64_t seed);
/*
 * Faults as words with commas between (simulate(1), -f): adds to the plan's chances, and to its
 * faults, which are then the caller's to free. False where one of them is none.
 */
bool sim_parse_faults(struct sim_plan *plan, const char *list);

struct sim_result {
    char failure[200]; /* empty: every check held */
    int64_t end_us;
    uint64_t trace_hash;
    int64_t events, gives, commits, flushes;
    int64_t crashes, silences, pauses, slows, hangs, kills, twice, garbage, returns;
    int64_t uncommitted;           /* tasks, where the run did not end */
    int64_t copies, pieces, stops; /* gives of what another has; pieces given; ends that stop */
    int64_t withheld;              /* gives of what is computed elsewhere */
    int64_t late_copies;           /* of the copies: before the input had ended */
    int64_t computed;              /* tasks, by whomever; more than commits: some more than once */
    int64_t messages;              /* of the ring, by each node and to it, without PLACE */
    int64_t steals;                /* asks of a node that brought it work of another one */
    int64_t taken_over;            /* tasks of nodes that made no progress, by the hub */
    int64_t passed;                /* tasks that a node gave to another one */
    int64_t reports;               /* of a node, that another one does not answer */
    int64_t lost, doubled, late;   /* ring messages, where they are datagrams */
    double busy_us, startup_us, waiting_us, tail_us; /* of all slots: slots x end_us together */
};

/*
 * Runs the policy by the plan. A run that does not end is a failure of a policy; where it is a
 * method that does not recover what is lost, it is its result: then `uncommitted` tells, too.
 */
void sim_run(const struct policy *policy, const struct sim_plan *plan, struct sim_result *result);

/* Adds the counts of a run to those of others; the hash becomes one of all their hashes. */
void sim_add(struct sim_result *sum, const struct sim_result *r);

/*
 * The least time that a measured run could have taken, whatever the schedule (stats.h): pieces are
 * rows where r split none of them, else pixels; and no less than all pixels take through the hub.
 */
double sim_bound_s(const struct sim_plan *plan, const struct sim_result *r);

/*
 * The best schedule that is found with all costs known beforehand: longest processing time first,
 * each task to the slot that is done with it first, then moves and swaps that relieve the slot that
 * ends last, until none does (R. L. Graham, "Bounds on multiprocessing timing anomalies", SIAM J.
 * Appl. Math. 17, 1969; for unequal slots Gonzalez, Ibarra, Sahni, see stats.h). to[i]: the slot of
 * task i. Takes time as tasks x slots, and more.
 */
void sim_best(const struct sim_work *work, int32_t tasks, int32_t slots, int32_t *to);

/*
 * Not a policy of its own but the fan alone, for the static methods: a task goes to its slot, or to
 * ID mod N, and what a lost slot had is lost.
 */
extern const struct policy sim_fan;

#endif
