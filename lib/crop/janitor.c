/*
 * janitor: a directory for the files of a run, and the process that removes it. The process reads a
 * pipe whose other end only this process has: the pipe ends when this process does. It is in a
 * process group of its own, so that a kill of this one's group leaves it alive.
 */
#include "crop/crop.h"
#include "os/os.h"
#include "proc/proc.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define DEPTH_MOST 400 /* directories within directories: each is open meanwhile */
#define TRIES 50
#define PAUSE_NS 100000000

/*
 * Removes the entry `name` of the directory `in`, with all that is in it. A command that is still
 * there may exchange a directory for a link meanwhile, so each step goes from an open directory and
 * follows no link. Returns 0, or -1 with errno.
 */
static int remove_entry(int in, const char *name, int depth)
{
    const int flags = O_RDONLY | O_NOFOLLOW | O_DIRECTORY | O_CLOEXEC;
    int fd = openat(in, name, flags);
    /* It may have been made unreadable, or unwritable. */
    if (fd < 0 && errno == EACCES && fchmodat(in, name, 0700, AT_SYMLINK_NOFOLLOW) == 0)
        fd = openat(in, name, flags);
    if (fd < 0) return errno == ENOTDIR || errno == ELOOP ? unlinkat(in, name, 0) : -1;
    (void)!fchmod(fd, 0700);
    DIR *d = fdopendir(fd);
    if (!d) close(fd);
    for (const struct dirent *e; d && depth < DEPTH_MOST && (e = readdir(d)) != NULL;)
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0)
            remove_entry(dirfd(d), e->d_name, depth + 1);
    if (d) closedir(d);
    return unlinkat(in, name, AT_REMOVEDIR);
}

int crop_remove(const char *path) { return remove_entry(AT_FDCWD, path, 0); }

/* Makes the directory, prints its name or an errno, and waits for the end of standard input. */
static int clean_up(void *ctx)
{
    static const int ignored[] = {SIGHUP, SIGINT, SIGTERM, SIGPIPE};
    const char *base = ctx;
    char name[PATH_MAX], c;
    struct buf none = {0};
    /* A kill of this process before it has made the directory does no harm. */
    for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++) signal(ignored[i], SIG_IGN);
    os_die_with_parent(0);
    os_rename("cropclean");
    if (snprintf(name, sizeof name, "%s/stormring-XXXXXX", base) >= (int)sizeof name) return 1;
    if (!mkdtemp(name)) return errno < 126 ? errno : 1;
    if (write_full(STDOUT_FILENO, name, strlen(name)) != 0) return crop_remove(name);
    close(STDOUT_FILENO);
    while (read_some(STDIN_FILENO, &none, sizeof c) > 0) continue;
    /* A command that its keeper is about to kill may still write here. */
    for (int i = 0; i < TRIES && crop_remove(name) != 0 && errno != ENOENT; i++)
        nanosleep(&(struct timespec){0, PAUSE_NS}, NULL);
    buf_free(&none);
    return 0;
}

const char *crop_directory(void)
{
    static char name[PATH_MAX], usual[] = "/tmp";
    /* Its end of the pipe must stay open, and the process is never waited for. */
    static struct child janitor;
    struct buf b = {0};
    char *base = getenv("TMPDIR");
    if (!base || *base != '/') base = usual;
    if (child_fork(&janitor, clean_up, base) != 0) die(ST_SYSTEM, "fork:");
    while (read_some(janitor.from, &b, PATH_MAX) > 0) continue;
    child_close(&janitor.from);
    if (!buf_size(&b) || buf_size(&b) >= sizeof name)
        die(ST_SYSTEM, "%s: cannot make a directory there, expected TMPDIR to name a writable one",
            base);
    memcpy(name, buf_data(&b), buf_size(&b));
    buf_free(&b);
    return name;
}
