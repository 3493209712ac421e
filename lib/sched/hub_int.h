/*
 * The hub of the ring, shared by its files: hub.c (events, the ledger), hub_match.c (who is asked
 * for whom), hub_hung.c (nodes that make no progress).
 */
#ifndef STORMRING_SCHED_RING_INT_H
#define STORMRING_SCHED_RING_INT_H

#include "sched/pace.h"
#include "sched/slot_set.h"

/* ---- hub.c ----------------------------------------------------------------------------------- */

#define LOADS 48 /* classes of work: class c lasts for 2^c microseconds, and not for twice that */

enum node_state { NODE_NEW, NODE_UP, NODE_GONE };

/* What the hub knows of the node on a slot. */
struct hub_node {
    enum node_state state;
    int32_t width;                   /* tasks that it is on at once */
    struct task_list held, computed; /* entries of the ledger: its tasks; `computed`: pixels miss */
    double held_px;                  /* of `held` */
    struct pace pace;                /* of its worker, by what it says of that */
    int32_t load;                    /* the class of its work, where it may be asked for some; -1 */
    bool flushed;                    /* it was asked for these, since it was last given a task */
    bool asking;                     /* it wants work, and was given none since it said so */
    bool passed_on, told;            /* its ask was, to another one; that it has to wait */
    bool dry;                        /* it had nothing to give, and no task came or went since */
    uint64_t given;                  /* tasks */
    int32_t thief, thieves;  /* the first of the nodes for which it was asked; how many they are */
    int32_t victim;          /* the node that was asked for it, and has not answered; -1: */
    int32_t before, after;   /* the others for which that one was */
    uint64_t given_before;   /* the victim's `given` then */
    int64_t since_us;        /* and when that was */
    int32_t older, newer;    /* those for whom somebody was asked just before, and after that */
    bool silent;             /* it did not answer in time, and has said nothing since */
    bool busy;               /* it has to make progress: hub_hung.c */
    int32_t staler, fresher; /* of those, who made progress just before, and after it */
    int64_t progress_us;     /* when that was */
};

struct hub {
    struct sched_params p;
    struct task_table ledger; /* tasks that are not committed; slot: whose, -1 in the pool */
    int32_t *from;            /* by entry: whose it was before, where it was stolen, -1 */
    int32_t n_from;
    struct task_list pool; /* no node is known that could have them */
    struct hub_node *nodes;
    int32_t n_nodes; /* 0: not known yet */
    int32_t *early;  /* nodes that were lost before that */
    size_t n_early;
    int64_t n_computed;                    /* entries */
    struct slot_set up;                    /* nodes that are */
    struct slot_set hungry, late, delayed; /* hub_match.c */
    struct slot_set rich[LOADS];           /* likewise: by the class of their work */
    uint64_t loads;                        /* bit c: rich[c] is not empty */
    struct pace pace;                      /* of all */
    int32_t oldest, newest;                /* those for whom somebody was asked, in that order */
    int64_t answer_us;                     /* the longest that an answer took, of late; 0: none */
    int64_t now_us;                        /* of this step */
    struct slot_set idle;                  /* they want work, have none, and nobody was asked */
    int32_t stalest, freshest;             /* busy nodes, by their latest progress */
    int64_t hung_us;                       /* when one is late, INT64_MAX */
    bool taken_over;                       /* a task of a node that is still on it, maybe */
    bool ended, flush, closed;
};

static inline bool hub_is_up(const struct hub *h, int32_t k)
{
    return k >= 0 && k < h->n_nodes && h->nodes[k].state == NODE_UP;
}
/* The next n tasks that node k has are peer's, which is up. */
void hub_give(struct hub *h, int32_t k, int32_t peer, int32_t n, struct sched_actions *out);
/* Entry i, which its node does not get done, is node thief's, which is up. */
void hub_take_over(struct hub *h, int32_t i, int32_t thief, struct sched_actions *out);
/* Something about node k has changed: notes whether it wants work, and whether it has some. */
void hub_mark(struct hub *h, int32_t k);

/* ---- hub_match.c ----------------------------------------------------------------------------- */

/* Whoever wants work has somebody asked for it, as far as there is somebody. */
void ring_match(struct hub *h, struct sched_actions *out);
/* Node k was given a task: whatever it had asked for, it has. */
void ring_served(struct hub *h, int32_t k);
/* Node k says ASK; or NONE, to node peer. */
void ring_asks(struct hub *h, int32_t k);
void ring_has_none(struct hub *h, int32_t k, int32_t peer);
/* Node k, which was asked for node peer, answers. */
void ring_answers(struct hub *h, int32_t k, int32_t peer);
/* Node k is lost. */
void ring_lost(struct hub *h, int32_t k);
/* Who was not answered in time waits for that one no more; when that will be so, INT64_MAX. */
void ring_late(struct hub *h);
int64_t ring_late_us(const struct hub *h);

/* ---- hub_hung.c ----------------------------------------------------------------------------- */

/* Something about node k has changed: notes whether it has to make progress, and whether it has
 * nothing to do. */
void ring_busy(struct hub *h, int32_t k);
/* It has made some. */
void ring_progress(struct hub *h, int32_t k);
/* Who has nothing to do is given what is late; hung_us says when something will be. */
void ring_hung(struct hub *h, struct sched_actions *out);

#endif
