/*
 * sim: policies in virtual time. It runs the shipped object code of a policy in a model of its
 * environment: a fan, links with latency and bandwidth, slots of unequal power, and seeded faults.
 * If the plan names a policy for nodes, each slot also runs that one, between its link and its
 * worker, which the node sees as slot 0 without delay. A seed gives exactly one run: the same seed
 * gives the same event trace, whose hash is returned.
 *
 * A link keeps the order of control records, and that of pixels. Control may overtake pixels, as in
 * the queues of fan; `gone` and `up` of a slot do not overtake its pixels. Messages under way to a
 * slot that dies are lost; messages that it had sent are not. The input is read while fewer than
 * SCHED_WAITING_MOST tasks wait, as in the live driver. If the hub is killed all slots die with it;
 * a new hub gets the tasks of which a pixel had not been passed on.
 *
 * A slot may need preparation: it connects, its state goes down its link before its tasks, and the
 * worker builds. Meanwhile tasks queue at the worker, as in the live one, and none of that is in
 * the time of its first task. Other users may leave it a share of its power that changes in time;
 * tasks under way go on at the new speed.
 *
 * If a plan has several frames, each has its own state. The input waits at a frame until the policy
 * admits it, as in the live driver; meanwhile slots are flushed.
 *
 * Checks of every run, after every event: a task commits once, and only after all of its pixels
 * were passed on, or given up because it has cost enough slots; a frame waits exactly while a task
 * older than the previous frame's is
 * uncommitted; the end comes once, when everything is committed and no pixel is missing; time
 * advances. A test gives the plan the checks of a policy (tests/oracles), which look at all tasks
 * at each event.
 *
 * For plans made up from a seed: the end comes within the time that the work, the faults and the
 * slowest slot allow.
 */
#ifndef STORMRING_SIM_H
#define STORMRING_SIM_H

#include "sched/sched.h"

#define SIM_PIXEL_BYTES 16 /* four floats */

/* Work to render if the plan does not make it up: for measurements. */
struct sim_work {
    uint32_t frame_w, frame_h;
    const struct task *tasks; /* ids 0 .. n-1 of frame 0, in any order */
    const double *pixel_us;   /* cost of a pixel at power 1, row by row */
    const double *power;      /* of the slots */
    double task_us;           /* cost of a task besides its pixels, at power 1 */
};

enum sim_fault_kind {
    SIM_CRASH,   /* the slot dies; the fan sees EOF */
    SIM_SILENCE, /* its connection is half open: the fan gives it up after silence_us */
    SIM_PAUSE,   /* it is silent for less than that, and continues */
    SIM_SLOW,    /* it has only a part of its power from now on */
    SIM_HANG,    /* it never finishes its task, but sends beats: no fan gives it up */
    SIM_DRAIN,   /* it is told to leave the run */
    SIM_KILL,    /* the hub is killed, and restarted later */
    SIM_POISON,  /* a slot that has computed this pixel dies, and comes back */
    SIM_REFUSE   /* the slot has not the memory for the state of frame y */
};
/* A fault that is not random. */
struct sim_fault {
    enum sim_fault_kind kind;
    int32_t slot;
    int64_t at_us;   /* time; or, if < 0: */
    int64_t commits; /* number of committed tasks */
    double power;    /* SLOW: factor of the slot's power; POISON: 1: it says so and lives */
    uint32_t x, y;   /* POISON; REFUSE */
};

struct sim_checks; /* of a policy: world.h */

/* A link: of one slot, or of a host, whose slots share it. */
struct sim_link {
    int64_t latency_us; /* one way */
    double bytes_per_s; /* each way; 0: no limit */
};

/*
 * What a host does before its first task. Connecting and building take a time of their own on each
 * host: the one stated here times `spread` to a power in [-1, 1), drawn by the seed.
 */
struct sim_start {
    double connect_s;   /* until a slot comes up */
    double state_bytes; /* sent once over each link, when the hub knows of its first slot */
    double build_s;     /* at power 1, from when the state has arrived */
    double spread;      /* up to 1: all hosts take the same time */
};

/* From at_us on other users leave the slot this share of its power. */
struct sim_load {
    int32_t slot;
    int64_t at_us;
    double share; /* above 0; or 0 at time 0: it joins the run at its next load */
};

/* Chances are per slot, or per answer. Times are microseconds of virtual time. */
struct sim_plan {
    uint64_t seed;
    const struct policy *node;       /* of each slot; NULL: a worker without a node */
    const struct sim_checks *checks; /* NULL: only those of every run */
    struct sched_params params;      /* the policy's */
    int32_t slots, tasks;
    int32_t frames;   /* frames, one after the other, each of another state; 0 means 1 */
    int32_t window;   /* frames with live tasks at once, up to GENERATIONS; 0 means 2 */
    int32_t rows;     /* tasks: rows of FRAME_W pixels */
    int32_t width;    /* tasks that a slot computes at once, by its hello */
    int32_t assigned; /* number of tasks with to=K */
    bool concentrate; /* slots send pixels only on a flush */
    bool unstated;    /* the powers that slots come up with were measured, not stated */
    double cost_us;   /* the least cost of a row at power 1; the most is exp(4) times that */
    double p_crash, p_silence, p_pause, p_slow, p_hang, p_drain; /* at most one per slot */
    bool tells_power; /* the policy is told the power of a slot that becomes slow */
    int32_t joins;    /* the last slots come later, and are not counted at first */
    double p_kill;    /* of the hub */
    int32_t poison;   /* pixels, drawn by the seed, that are as by SIM_POISON */
    double p_refuse;  /* a slot, but not slot 0, has not the memory for the state of a frame */
    double p_return;  /* a lost slot comes back */
    double p_twice;   /* an answer is sent twice */
    /* an answer names a task that was not asked for */
    double p_garbage;
    double p_false; /* a node sends its hub a false message */
    double p_lose, p_double,
        p_late;               /* a ring message is, on each of its links: a datagram's fate */
    int64_t faults_us;        /* random faults come before this */
    struct sim_fault *faults; /* the caller's */
    size_t n_faults;
    int64_t detect_us; /* time until a lost or hung slot is noticed, by which the end may be late */
    /* no faults and enough work: the run must take little longer than the bound */
    bool calm;
    int64_t silence_us;
    struct sim_start start;
    struct sim_load *loads; /* of all slots, by slot and then by time; the caller's */
    size_t n_loads;
    struct sim_link link;   /* of each slot, and between the hubs of a tree */
    double jitter;          /* latency varies up to this part, both ways */
    double hops;            /* latencies of a ring message between nodes; 2: through the hub */
    double hub_bytes_per_s; /* of a hub, upwards; 0: no limit */
    /* Links of hosts, for their slots instead of `link`; NULL: none. The caller's. */
    const struct sim_link *links;
    const int32_t *link_of; /* of each slot: an index of links */
    int32_t n_links;
    const int32_t *groups;           /* of a tree, sim_tree_run; the caller's */
    size_t levels;                   /* entries of groups */
    double message_us;               /* likewise: the time that a hub takes for a record */
    const struct sim_work *work;     /* NULL: rows of random cost */
    void (*trace)(const char *line); /* each event in words; NULL: no trace */
};
/* Slots that a task may cost before it is put aside. */
static inline int32_t sim_losses(const struct sim_plan *p)
{
    return p->params.losses ? p->params.losses : SCHED_LOSSES;
}
/* Makes up a plan from the seed: from small to large, with few or many faults. Slot 0 is never
 * lost. */
struct sim_plan sim_plan_of(uint64_t seed);
/* The same for a ring by its default rules; up to 64 slots. */
struct sim_plan sim_ring_plan_of(uint64_t seed);
/*
 * Reads faults, words separated by commas (simulate(1), -f). Adds to the plan's chances and to its
 * faults, which the caller must free. False if a word is no fault.
 */
bool sim_parse_faults(struct sim_plan *plan, const char *list);

/*
 * Reads a file of loads (simulate(1), -L), which become the plan's; the caller frees plan->loads.
 * False with text in err: the file cannot be read, or is none.
 */
bool sim_read_loads(struct sim_plan *plan, const char *path, char err[ERR_BYTES]);

struct sim_result {
    char failure[200]; /* empty: every check held */
    int64_t end_us;
    uint64_t trace_hash;
    int64_t events, gives, commits, flushes;
    int64_t crashes, silences, pauses, slows, hangs, drains, kills, twice, garbage, returns;
    int64_t leaves;      /* slots that left as they were told to */
    int64_t poisoned;    /* slots that died of a task */
    int64_t refused;     /* tasks refused */
    uint64_t abandoned;  /* pixels given up */
    int64_t uncommitted; /* tasks, if the run did not end */
    /* gives of tasks that others have; pieces given; ends that stop slots */
    int64_t copies, pieces, stops;
    int64_t withheld;            /* gives of computed tasks */
    int64_t late_copies;         /* copies before the input had ended */
    int64_t computed;            /* tasks computed, repeated ones included */
    int64_t messages;            /* ring messages from and to nodes, without PLACE */
    int64_t steals;              /* asks of a node that brought it another node's work */
    int64_t taken_over;          /* tasks that the hub took from nodes without progress */
    int64_t passed;              /* tasks that a node gave to another one */
    int64_t reports;             /* reports of nodes that do not answer */
    int64_t lost, doubled, late; /* ring messages, if they are datagrams */
    int64_t records;             /* that left for a link, without those that fan adds */
    double bytes;                /* of these, with the state */
    double work_us;              /* computed at power 1, repeated and unfinished tasks included */
    /* Of the first hub of a tree: records and bytes that it passed; most tasks it had at once. */
    int64_t hub_records, hub_tasks;
    double hub_bytes;
    int64_t hubs, hub_slots; /* number of hubs; most slots of a hub */
    /* sums over all slots: together slots x end_us */
    double busy_us, startup_us, waiting_us, tail_us;
};

/*
 * Runs the policy by the plan. A run that does not end is a failure of a policy. For a method that
 * does not recover lost tasks it is a result, and `uncommitted` has their number.
 */
void sim_run(const struct policy *policy, const struct sim_plan *plan, struct sim_result *result);

/*
 * The same for a tree: deals within deals. A hub has groups[0] hubs below it, each of these has
 * groups[1], and so on for `levels`; the slots are below the last ones, as evenly as possible. With
 * levels 0 there is one hub. Each hub runs the policy, as deal does around a fan of deals: it
 * passes down the tasks that it gives, and passes up all records of its slots. Every record takes
 * message_us of the hub that passes it, one after the other, and pixels take its bandwidth. Links
 * between hubs are `link`. plan->work must be set; there are no nodes and no faults.
 */
void sim_tree_run(
    const struct policy *policy, const struct sim_plan *plan, struct sim_result *result);

/* Adds the counts of a run to those of others. The hash becomes a hash of all. */
void sim_add(struct sim_result *sum, const struct sim_result *r);

/*
 * The least time of any schedule of this work (stats.h). Pieces are pixels, whatever the tasks, so
 * that one bound serves all methods. It is at least the time of all pixels through the hub.
 */
double sim_bound_s(const struct sim_plan *plan);
/*
 * The same for this model: a slot begins when it has its state and its first message, and has what
 * the loads leave of its power, and its last pixels must come back. At least the bound and three
 * latencies. Infinite if no slot ever begins.
 */
double sim_least_s(const struct sim_plan *plan);

/*
 * The best schedule found with all costs known: longest processing time first, each task to the
 * slot that finishes it first; then moves and swaps that relieve the slot that ends last, while
 * there are any (R. L. Graham, "Bounds on multiprocessing timing anomalies", SIAM J. Appl. Math.
 * 17, 1969; for unequal slots Gonzalez, Ibarra, Sahni, see stats.h). to[i]: the slot of task i.
 * Takes time tasks x slots, and more.
 */
void sim_best(const struct sim_work *work, int32_t tasks, int32_t slots, int32_t *to);

/*
 * The fan alone, for the static methods: a task goes to its slot, or to slot ID mod N. Tasks of a
 * lost slot are lost.
 */
extern const struct policy sim_fan;

/* ---- experiments ----------------------------------------------------------------------------- */

/* A method by its name in simulate(1). */
struct sim_method {
    const char *name;
    const struct policy *policy, *node; /* node: of each slot; NULL: none */
    struct sched_params params;         /* defaults */
    const char *options;                /* letters of the options that it takes */
    bool best;                          /* each task goes where sim_best puts it */
    bool tuned;                         /* its params are part of it: no seed changes them */
    const struct sim_checks *checks;    /* as in the plan */
};
/* NULL if there is no such method. */
const struct sim_method *sim_method_named(const char *name);

/*
 * Runs the method, which must recover lost tasks, by the plans of `seeds` seeds from `first` on.
 * Stops at the first run that fails. *sum adds up the runs, and has the failure of that one.
 * Returns the number of seeds that hold. trace: as in the plan.
 */
int64_t sim_run_seeds(const struct sim_method *m, uint64_t first, int64_t seeds,
    void (*trace)(const char *line), struct sim_result *sum);

/*
 * Work that is put together: sim_workload_frame; sim_workload_task for each task; sim_workload_end,
 * which checks their numbers and makes pixel_us, all 0; then the costs and the powers; then
 * sim_workload_scale and sim_workload_plan. False with text in err: the input is refused.
 */
struct sim_workload {
    uint32_t frame_w, frame_h;
    struct task *tasks; /* owned, as all pointers here; ids in any order, frame 0 */
    int32_t n;
    double *pixel_us; /* row by row; cost at power 1, 0 for pixels without a task */
    double *power;    /* of the slots; allocated by the caller */
    int32_t slots;
    struct sim_link *links; /* of hosts; NULL: all are alike; both allocated by the caller */
    int32_t *link_of;       /* of the slots */
    int32_t n_links;
    struct sim_work work; /* the same, for the plan */
};
bool sim_workload_frame(
    struct sim_workload *l, uint32_t frame_w, uint32_t frame_h, char err[ERR_BYTES]);
bool sim_workload_task(struct sim_workload *l, const struct task *t, char err[ERR_BYTES]);
bool sim_workload_end(struct sim_workload *l, char err[ERR_BYTES]);
/* The pixels of a task cost the same: us times spread to a power in [-1, 1), drawn by the id. */
void sim_draw_costs(struct sim_workload *l, uint64_t seed, double us, double spread);
/* Powers from 1 / spread to spread, drawn evenly by their logarithm. The caller frees them. */
double *sim_draw_powers(uint64_t seed, int32_t slots, double spread);
/* Multiplies all costs. Refuses work that could take too long for the clock. */
bool sim_workload_scale(struct sim_workload *l, double factor, char err[ERR_BYTES]);
/*
 * Completes the plan of a run: all but seed, faults, links, params, checks and trace, which are
 * the caller's. The workload must stay valid. Its tasks get slots if the method is `best`. Refuses
 * a fault of a slot that is not there.
 */
bool sim_workload_plan(
    struct sim_workload *l, const struct sim_method *m, struct sim_plan *p, char err[ERR_BYTES]);
void sim_workload_free(struct sim_workload *l);

/* Appends the figures of a run of a workload, lines "KEY<tab>VALUE" (simulate(1)). */
void sim_report(const struct sim_plan *p, const struct sim_result *r, struct buf *out);
/* The last lines of these: the faults that happened, and the trace's hash. */
void sim_report_faults(const struct sim_result *r, struct buf *out);

#endif
