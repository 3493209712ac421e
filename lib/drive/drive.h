/*
 * drive: the poll loop of a policy around one command. It turns records into scheduling events, and
 * actions into records. When its reader is gone it ends quietly, and ends all processes that it
 * started.
 */
#ifndef STORMRING_DRIVE_H
#define STORMRING_DRIVE_H

#include "sched/sched.h"

/* Runs the policy around command (NULL-ended), which is a fan or contains one. Returns the exit
 * status. Blocks. */
int drive_policy(const struct policy *p, const struct sched_params *params, char *const *command);

#endif
