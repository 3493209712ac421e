/*
 * oracles: what a policy must do, checked after each event and action of a simulated run. A plan
 * names one (plan.checks); sim_fail reports what is violated. They look at all tasks at each event.
 *
 * oracle_deal, for at most SIM_SLOTS_MOST slots:
 *
 *   give      only to a slot that is up, only an open task, from the pool only up to the depth;
 *             a copy only to an idle slot, after the end of the input, with an empty pool, and at
 *             most SIM_COPIES_MOST at once; in an endgame earlier, or more, of a late task
 *   turn      tasks without an owner go in order of arrival, after lost tasks
 *   least     with equal depths, the slot with the least load is given the task
 *   withheld  a computed task only in an endgame, if its slot is busy or was asked to flush, and
 *             only to a slot that owes no pixels
 *   pieces    of tasks only in an endgame; under new ids, inside one task, disjoint
 *   idle      in an endgame no slot is idle while a task may still be copied
 *   revoked   if the depth follows the link and the input has ended, no slot holds more than twice
 *             its share of the pool
 *   end       stops the slots if one is still busy
 *
 * oracle_gdc, for the ring as published, whose nodes run policy_node:
 *
 *   rows      in the first phase each to its node, once; then a row moves only from a node that
 *             gives it to the node it names; all rows that started at a dead node go to the node
 *             that reports it
 *   messages  reach their receivers unchanged
 *   asking    only an idle node asks: the next node up the ring in its search; no other one before
 *             an answer; again at the timeout, and the fifth time with a report
 *   answers   one per request, between rows: a row if there is one, else whether the node is idle,
 *             and then the node that it found
 *
 * oracle_ring, for rings with a hub: the model is in ring_model.h.
 */
#ifndef STORMRING_TESTS_ORACLES_H
#define STORMRING_TESTS_ORACLES_H

#include "sim/sim.h"

#define SIM_SLOTS_MOST 64
#define SIM_COPIES_MOST 3

extern const struct sim_checks oracle_deal, oracle_ring, oracle_gdc;

#endif
