/* groups: the process groups that stop with this process: proc_int.h. A signal may come at any
 * time, and its handler may read them. */
#include "proc/proc_int.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

static pid_t *groups;
static volatile size_t n_groups;
static size_t room_groups;

void groups_add(pid_t pid)
{
    if (n_groups == room_groups) {
        pid_t *more = xmalloc(2 * room_groups + 16, sizeof *more), *old = groups;
        if (n_groups) memcpy(more, old, n_groups * sizeof *more);
        groups = more;
        room_groups = 2 * room_groups + 16;
        free(old);
    }
    groups[n_groups] = pid;
    n_groups++;
}

void groups_remove(pid_t pid)
{
    for (size_t i = 0; i < n_groups; i++) {
        if (groups[i] != pid) continue;
        groups[i] = groups[n_groups - 1];
        n_groups--;
        return;
    }
}

void groups_signal(int signal)
{
    for (size_t i = 0; i < n_groups; i++) kill(-groups[i], signal);
}

bool groups_stopped(void)
{
    for (size_t i = 0; i < n_groups; i++) {
        siginfo_t info = {0};
        const int kinds = WSTOPPED | WEXITED | WNOWAIT | WNOHANG;
        if (waitid(P_PID, (id_t)groups[i], &info, kinds) == 0 && !info.si_pid) return false;
    }
    return true;
}

void groups_forget(void) { n_groups = 0; }
