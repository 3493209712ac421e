/*
 * cpu LINE: runs the line of shell, and writes the CPU seconds that it took, with all processes
 * that it waited for, and those that it left behind, when they have ended: to the microsecond,
 * where the shell's own times counts in hundredths.
 */
#include "base/base.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>

static double seconds(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    if (argc != 2) die(ST_USAGE, "expected a line of shell");
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    int status = system(argv[1]);
    if (status == -1) die(ST_SYSTEM, "sh:");
    while (wait(NULL) > 0) continue;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        die(ST_SYSTEM, "%s: failed, expected exit 0", argv[1]);
    struct rusage used;
    if (getrusage(RUSAGE_CHILDREN, &used) != 0) die(ST_SYSTEM, "getrusage:");
    printf("%.6f\n", seconds(used.ru_utime) + seconds(used.ru_stime));
    close_stdout();
    return ST_OK;
}
