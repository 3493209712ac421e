/*
 * The hub of the ring, shared by its files. Each calls only those below it:
 *
 *     hub.c        events
 *     hub_aside.c  tasks that cost nodes
 *     hub_match.c  pairs nodes that want work with nodes that have some
 *     hub_end.c    the last tasks
 *     hub_hung.c   nodes that make no progress
 *     hub_join.c   nodes that join and leave
 *     hub_owner.c  which node has a task
 *     hub_asks.c   asks and their answers
 *     hub_mark.c   what nodes want and have
 *     hub_cost.c   expected times
 *     hub_ledger.c tasks
 */
#ifndef STORMRING_SCHED_HUB_INT_H
#define STORMRING_SCHED_HUB_INT_H

#include "sched/blame.h"
#include "sched/cost.h"
#include "sched/pace.h"
#include "sched/pieces.h"
#include "sched/slot_set.h"
#include "sched/tournament.h"

/* Classes of work: class c lasts at least 2^c microseconds, and less than twice that. */
#define LOADS 48

enum node_state { NODE_NEW, NODE_UP, NODE_DRAINS, NODE_GONE };

/* The hub's record of the node on a slot. */
struct hub_node {
    enum node_state state;
    int32_t width;             /* tasks that it computes at once */
    struct task_list held;     /* its tasks: entries of the ledger */
    struct task_list computed; /* likewise; computed, but pixels are missing */
    double held_px;            /* pixels of `held` */
    int32_t cut;               /* entries of `held` that have pieces, */
    double cut_px;             /* and their pixels */
    struct pace pace;          /* of its worker, from its DONE messages */
    struct speed speed;        /* hub_cost.c */
    int32_t load;              /* class of its work if it may be asked for some; else -1 */
    bool flushed;              /* asked to flush `computed` since it was last given a task */
    bool asking;               /* wants work, and was given none since it asked */
    bool passed_on, told;      /* its ask went on to another victim; it was told to wait */
    bool dry;                  /* had nothing to give, and no task came or went since */
    uint64_t given;            /* number of tasks given to it */
    int32_t thief, thieves;    /* the list of nodes that wait for its answer; their number */
    int32_t victim;            /* the node asked on its behalf that has not answered; -1: none */
    int32_t before, after;     /* its neighbours in the victim's list of thieves */
    uint64_t given_before;     /* the victim's `given` at that time */
    int64_t since_us;          /* the time of that ask */
    int32_t older, newer;      /* its neighbours in the list of outstanding asks, by time */
    bool silent;               /* did not answer in time, and has sent nothing since */
    bool busy;                 /* has to make progress: hub_mark.c */
    int32_t staler, fresher;   /* its neighbours in the list of busy nodes, by latest progress */
    int64_t progress_us;       /* the time of its latest progress */
};

/* Payload of an entry of the ledger. */
struct hub_task {
    struct piece piece; /* first: pieces.h */
    int32_t owner;      /* the node whose task it is; -1: in the pool */
    int32_t from;       /* its previous owner, if it was stolen; else -1 */
    int32_t tries;      /* attempts so far; 0: no node was sent it */
    bool computed;      /* its owner has computed it; pixels are missing */
    int32_t alone;      /* not 0: it was put aside, only one node at a time gets it; blame_step */
    bool aside;         /* it is aside, and no node has it */
    int64_t sent_us;    /* when its owner was sent it */
};

struct hub {
    struct sched_params p;
    struct task_table ledger; /* uncommitted tasks */
    struct task_list pool;    /* no known node could own them */
    struct task_list rest;    /* pieces that no node has: hub_end.c */
    struct task_list cut;     /* tasks of no node whose pieces are missing */
    struct task_list aside;   /* tasks that cost nodes */
    struct blame blame;
    struct hub_node *nodes;
    int32_t n_nodes;  /* 0: not known yet */
    int32_t n_places; /* nodes that the sets have room for */
    int32_t *early;   /* nodes lost before n_nodes was known */
    size_t n_early;
    int64_t n_computed;                    /* entries of the ledger */
    double left_px;                        /* pixels that nodes have to compute */
    struct slot_set up;                    /* nodes that are up */
    struct slot_set leaving;               /* nodes that drain, and owe nothing */
    struct slot_set hungry, late, delayed; /* hub_mark.c */
    struct slot_set rich[LOADS];           /* likewise, by class of work */
    uint64_t loads;                        /* bit c: rich[c] is not empty */
    /* At the end (hub_cost.c): nodes that want work, by when they would be done with some; nodes
     * whose tasks can be cut, those that end last first, and those that should have ended first. */
    struct tournament wanting, latest, most_late;
    int32_t reviewed; /* the node whose expected times were computed again last */
    int32_t turn;     /* the node that was looked at last in the endgame */
    int64_t end_us;   /* when a task will be late; INT64_MAX: none */
    struct pace pace; /* the mean of all nodes */
    struct costs costs;
    double mean_us;            /* recent time of nodes for work 1; 0: not known */
    double task_work;          /* recent work of tasks */
    int32_t oldest, newest;    /* the ends of the list of outstanding asks */
    int64_t answer_us;         /* the longest recent time to an answer; 0: none yet */
    int64_t now_us;            /* the time of this step */
    struct slot_set idle;      /* nodes that want work and have none, with no victim */
    struct slot_set freed;     /* nodes of which a task has left the ledger in this step */
    int32_t stalest, freshest; /* the ends of the list of busy nodes, by latest progress */
    int64_t hung_us;           /* when a task will be late; INT64_MAX: none */
    int64_t return_us;         /* when tasks that all refuse are given up; INT64_MAX: not now */
    bool taken_over;           /* a node may still compute a task that was taken from it */
    bool ended, flush, closed;
};

static inline struct hub_task *hub_task(const struct hub *h, int32_t i)
{
    return tasks_extra(&h->ledger, i);
}
static inline bool hub_is_up(const struct hub *h, int32_t k)
{
    return k >= 0 && k < h->n_nodes && h->nodes[k].state == NODE_UP;
}
/* It is up, or it drains: what it says of its tasks counts. */
static inline bool hub_works(const struct hub *h, int32_t k)
{
    return hub_is_up(h, k) || (k >= 0 && k < h->n_nodes && h->nodes[k].state == NODE_DRAINS);
}
/* Does node k refuse entry i? */
static inline bool hub_refuses(const struct hub *h, int32_t k, int32_t i)
{
    return h->blame.refusals.n && refuse_is(&h->blame.refusals, h->ledger.at[i].task.generation, k);
}
/* ---- hub_owner.c ----------------------------------------------------------------------------- */

/* Sends entry i to its owner, node k, which is up. */
void hub_send(struct hub *h, int32_t k, int32_t i, struct sched_actions *out);
/* Moves the next n tasks of node k to node peer, which is up. */
void hub_give(struct hub *h, int32_t k, int32_t peer, int32_t n, struct sched_actions *out);
/* Entry i, of node k, which cannot compute it and goes on, goes to another node. */
void hub_pass_on(struct hub *h, int32_t i, int32_t k, struct sched_actions *out);
/* The last pixels of entry i have come, or are given up. It may be the last piece of another. */
void hub_commit(struct hub *h, int32_t i, struct sched_actions *out);
/* Moves entry i, whose node does not finish it, to node thief, which is up. */
void hub_take_over(struct hub *h, int32_t i, int32_t thief, struct sched_actions *out);
/* An entry without owner goes to the node of its slot, or to that of its number. */
void hub_start(struct hub *h, int32_t i, struct sched_actions *out);
/* Entry i, on no list, goes to node k, or to the nearest node before it that is up and takes it. */
void hub_assign(struct hub *h, int32_t i, int32_t k, struct sched_actions *out);
/* Entry i, of node k, which is gone or drains, goes to another node as a task without owner; or
 * aside. */
void hub_hand_on(struct hub *h, int32_t i, int32_t k, struct sched_actions *out);
/* Asks node k to flush once it has computed all of its tasks and pixels are missing. */
void hub_ask_flush(struct hub *h, int32_t k, struct sched_actions *out);

/* ---- hub_aside.c ---------------------------------------------------------------------------- */

/* Node k, which is lost, was computing these: blames the tasks. */
void hub_aside_blame(struct hub *h, int32_t k, struct sched_actions *out);
/* Node k cannot compute its entry i: blames the task, unless the node refuses the state, and gives
 * it to another node. */
void hub_aside_fail(struct hub *h, int32_t k, int32_t i, bool refused, struct sched_actions *out);
/* After refusals, or other nodes that are up: puts tasks aside that all refuse, or back. */
void hub_aside_settle(struct hub *h, struct sched_actions *out);
/* Entry i was done: if its frame was put aside, its tasks go to nodes. */
void hub_aside_well(struct hub *h, int32_t i, struct sched_actions *out);
/* If nodes have nothing else to do, tries what was put aside, or gives it up. */
void hub_aside_try(struct hub *h, struct sched_actions *out);

/* ---- hub_join.c ----------------------------------------------------------------------------- */

/* Node k is lost; perhaps the number of nodes is not known yet. */
void hub_note_early(struct hub *h, int32_t k);
/* There are n nodes at first. False: that was known. */
bool hub_set_nodes(struct hub *h, int32_t n);
/* Adds node k to the table if it is new. False: it cannot be added. */
bool hub_join(struct hub *h, int32_t k);
/* Node k is to leave the ring: it keeps what it computes. */
void hub_drain(struct hub *h, int32_t k, struct sched_actions *out);
/* Nodes that drain and owe nothing leave. */
void hub_let_go(struct hub *h, struct sched_actions *out);

/* ---- hub_ledger.c --------------------------------------------------------------------------- */

/* Puts entry i, on no list, aside. */
void hub_put_aside(struct hub *h, int32_t i);
/* Takes entry i off its list. */
void hub_unlist(struct hub *h, int32_t i);
/* Puts entry i, on no list, on a list of node k; or on one of those of no node (-1). */
void hub_enlist(struct hub *h, int32_t i, int32_t k, bool computed);
/* Adds a task of the input, on no list. */
int32_t hub_enter(struct hub *h, const struct task *t, uint32_t frame_w);
/* Makes a piece of all missing pixels of entry i, which a node has. */
int32_t hub_open_task(struct hub *h, int32_t i);
/* Cuts n pixels off entry i, a piece that no node has, as another one. */
int32_t hub_cut_off(struct hub *h, int32_t i, uint64_t n);
/* True if entry i seems to cost nodes. */
bool hub_bad(const struct hub *h, int32_t i);
/* Removes entry i, which has no pieces. */
void hub_remove(struct hub *h, int32_t i);

/* ---- hub_match.c ----------------------------------------------------------------------------- */

/* Pairs each node that wants work with a victim while victims remain. */
void hub_match(struct hub *h, struct sched_actions *out);

/* ---- hub_asks.c ----------------------------------------------------------------------------- */

/* Node k is asked on behalf of node thief. */
void hub_pair(struct hub *h, int32_t k, int32_t thief);
/* Node k was given a task: this ends its ask. */
void hub_served(struct hub *h, int32_t k);
/* Node k says ASK; or NONE, to node peer. */
void hub_asks(struct hub *h, int32_t k);
void hub_has_none(struct hub *h, int32_t k, int32_t peer);
/* Node k answers the ask of node peer. */
void hub_answers(struct hub *h, int32_t k, int32_t peer);
/* Node k is lost. */
void hub_lost(struct hub *h, int32_t k);
/* Ends asks that were not answered in time. The second function returns when there will be one;
 * INT64_MAX: none is outstanding. */
void hub_late(struct hub *h);
int64_t hub_late_us(const struct hub *h);

/* ---- hub_hung.c ----------------------------------------------------------------------------- */

/* Gives late tasks to idle nodes. hung_us is then the time when another will be late. */
void hub_hung(struct hub *h, struct sched_actions *out);

/* ---- hub_mark.c ----------------------------------------------------------------------------- */

/* The sets of slots of the hub, once the number of nodes is known. */
void hub_sets_init(struct hub *h);
void hub_sets_free(struct hub *h);
/* Node k has changed: notes whether it wants work, whether it has some, whether it has to make
 * progress, and whether it is idle. */
void hub_mark(struct hub *h, int32_t k);
/* Node k has made progress. */
void hub_progress(struct hub *h, int32_t k);

/* ---- hub_cost.c ----------------------------------------------------------------------------- */

/* Entry i, of px pixels, is done by its owner in this time. */
void hub_cost_note(struct hub *h, int32_t i, double px, double us);
/* Expected times. That which node k needs for a pixel of entry i; */
double hub_pixel_us(const struct hub *h, int32_t k, int32_t i);
/* the same for its own entry i; if that is its current task, at least what it has taken so far; */
double hub_own_pixel_us(const struct hub *h, int32_t k, int32_t i);
/* the time that node k needs for work 1; */
double hub_time_us(const struct hub *h, int32_t k);
/* the time until node k ends its current task, and those that have no pieces. *late: the current
 * task should be done. It is then expected to take as long again as it is late. */
double hub_left_us(const struct hub *h, int32_t k, bool *late);
/* Has the endgame begun? */
bool hub_is_ending(const struct hub *h);
/* Node k has changed: notes in the endgame what it wants, and when it ends. */
void hub_cost_mark(struct hub *h, int32_t k);

/* ---- hub_end.c ------------------------------------------------------------------------------ */

/* Gives node k, which wants work, a part of a task of another node; false: there is none. */
bool hub_end(struct hub *h, int32_t k, struct sched_actions *out);

#endif
