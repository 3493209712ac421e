/* proc, shared by its files: child.c (children); groups.c (those that stop with this process);
 * signals.c; limits.c. */
#ifndef STORMRING_PROC_INT_H
#define STORMRING_PROC_INT_H

#include "proc/proc.h"

/* The child that leads this process group stops with this process, until it is removed. */
void groups_add(pid_t pid);
void groups_remove(pid_t pid);
/* Removes all. */
void groups_forget(void);
/* Sends the signal to all groups. */
void groups_signal(int signal);
/* True if all leaders are stopped, or have ended. */
bool groups_stopped(void);

#endif
