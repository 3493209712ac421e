/*
 * janitor: a directory for the files of a run, and the process that removes it. The process reads a
 * pipe whose other end only this process has: the pipe ends when this process does. It is in a
 * process group of its own, so that a kill of this one's group leaves it alive.
 */
#include "crop/crop.h"
#include "proc/proc.h"

#include <errno.h>
#include <ftw.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#define OPEN_MOST 16 /* directories open at a time */
#define TRIES 50
#define PAUSE_NS 100000000

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *at)
{
    (void)st, (void)kind, (void)at;
    return remove(path) == 0 || errno == ENOENT ? 0 : -1;
}

/* A directory may have been made unwritable. */
static int open_one(const char *path, const struct stat *st, int kind, struct FTW *at)
{
    (void)st, (void)at;
    if (kind == FTW_D || kind == FTW_DNR) (void)!chmod(path, 0700);
    return 0;
}

void crop_rename(const char *name)
{
    prctl(PR_SET_NAME, name);
    /* The first word of the command line, which cannot become longer. */
    char *word = program_invocation_name;
    const size_t room = word ? strlen(word) : 0, n = strlen(name);
    for (size_t i = 0; i < room; i++) word[i] = i < n ? name[i] : '\0';
}

int crop_remove(const char *path)
{
    nftw(path, open_one, OPEN_MOST, FTW_PHYS);
    return nftw(path, remove_one, OPEN_MOST, FTW_PHYS | FTW_DEPTH);
}

/* Makes the directory, prints its name or an errno, and waits for the end of standard input. */
static int clean_up(void *ctx)
{
    static const int ignored[] = {SIGHUP, SIGINT, SIGTERM, SIGPIPE};
    const char *base = ctx;
    char name[PATH_MAX], c;
    struct buf none = {0};
    /* A kill of this process before it has made the directory does no harm. */
    for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++) signal(ignored[i], SIG_IGN);
    prctl(PR_SET_PDEATHSIG, 0);
    crop_rename("cropclean");
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
