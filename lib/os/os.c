/* Short forms of POSIX: see os.h. */
#include "os/os.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

static int kept_from_exec(int fd) { return fd < 0 ? -1 : fcntl(fd, F_SETFD, FD_CLOEXEC); }

int os_pipe(int ends[2])
{
    if (pipe(ends) != 0) return -1;
    kept_from_exec(ends[0]);
    kept_from_exec(ends[1]);
    return 0;
}

int os_temporary(char *name)
{
    int fd = mkstemp(name);
    kept_from_exec(fd);
    return fd;
}
