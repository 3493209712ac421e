/*
 * outfile: files that appear under their names only when complete. A signal that ends the program
 * removes the temporary files first, and so does exit().
 */
#include "base/base.h"
#include "os/os.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SUFFIX ".XXXXXX"
#define LINKS_MOST 40 /* as in path_resolution(7) */

/* ---- temporary files ------------------------------------------------------------------------- */

/* Those that are open, for the handler. */
struct temporary {
    struct temporary *next;
    char name[];
};
static struct temporary *open_ones;

/* The signals, and what they did before. */
static const int ending[] = {SIGHUP, SIGINT, SIGTERM};
#define ENDING (sizeof ending / sizeof *ending)
static struct sigaction before[ENDING];

static pid_t owner; /* a child that exits leaves them */

static void remove_all(void)
{
    if (getpid() != owner) return;
    for (const struct temporary *t = open_ones; t; t = t->next) unlink(t->name);
    open_ones = NULL;
}

static void remove_and_end(int sig)
{
    remove_all();
    for (size_t i = 0; i < ENDING; i++)
        if (ending[i] == sig) sigaction(sig, &before[i], NULL);
    raise(sig);
}

/* Blocks the signals while the list changes. */
static void block(sigset_t *was)
{
    sigset_t these;
    sigemptyset(&these);
    for (size_t i = 0; i < ENDING; i++) sigaddset(&these, ending[i]);
    sigprocmask(SIG_BLOCK, &these, was);
}

static void add(struct temporary *t)
{
    const struct sigaction act = {.sa_handler = remove_and_end};
    static bool registered;
    if (!registered) registered = atexit(remove_all) == 0;
    owner = getpid();
    for (size_t i = 0; i < ENDING && !open_ones; i++) {
        sigaction(ending[i], NULL, &before[i]);
        if (before[i].sa_handler != SIG_IGN) sigaction(ending[i], &act, NULL);
    }
    t->next = open_ones;
    open_ones = t;
}

static void drop(const char *name)
{
    struct temporary **at = &open_ones, *t;
    while ((t = *at) != NULL && t->name != name) at = &t->next;
    if (!t) return;
    *at = t->next;
    free(t);
    for (size_t i = 0; i < ENDING && !open_ones; i++) sigaction(ending[i], &before[i], NULL);
}

/* ---- files ----------------------------------------------------------------------------------- */

/* True if the directory has the open descriptors of this process, by any of its names. The numbers
 * of such files are sure only while they are open. */
static bool has_descriptors(const char *dir)
{
    static const char *const names[] = {"/proc/self/fd", "/proc/thread-self/fd", "/dev/fd"};
    struct stat at, own;
    bool has = false;
    for (size_t i = 0; !has && i < sizeof names / sizeof *names; i++) {
        int fd = open(names[i], O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (fd < 0) continue;
        has = fstat(fd, &own) == 0 && stat(dir, &at) == 0 && at.st_dev == own.st_dev &&
              at.st_ino == own.st_ino;
        close(fd);
    }
    return has;
}

/* The open descriptor that this is a name of, such as /proc/self/fd/1; -1: none. */
static int descriptor_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *dir = xstrdup(path);
    int64_t fd = -1;
    dir[slash ? slash + 1 - path : 0] = '\0';
    if (parse_int(slash ? slash + 1 : path, 0, INT_MAX, &fd) && !has_descriptors(*dir ? dir : "."))
        fd = -1;
    free(dir);
    return (int)fd;
}

/* What a link leads to, also if that does not exist yet, so that the link stays. If it is an open
 * descriptor, *fd is that, otherwise -1. The caller frees it. NULL with errno: it leads
 * to no end. */
static char *target_of(const char *path, int *fd)
{
    char *at = xstrdup(path), to[PATH_MAX];
    for (int links = 0;; links++) {
        if ((*fd = descriptor_of(at)) >= 0) return at;
        const ssize_t n = readlink(at, to, sizeof to - 1);
        if (n < 0) return at; /* no link */
        if (links == LINKS_MOST) break;
        to[n] = '\0';
        const char *slash = *to == '/' ? NULL : strrchr(at, '/');
        const int kept = slash ? (int)(slash + 1 - at) : 0;
        const size_t size = (size_t)kept + (size_t)n + 1;
        char *next = xmalloc(size, 1);
        snprintf(next, size, "%.*s%s", kept, at, to);
        free(at);
        at = next;
    }
    free(at);
    errno = ELOOP;
    return NULL;
}

static FILE *open_beside(const char *path, char **name)
{
    const size_t n = strlen(path) + sizeof SUFFIX;
    struct temporary *t = xmalloc(sizeof *t + n, 1);
    sigset_t was;
    snprintf(t->name, n, "%s%s", path, SUFFIX);
    block(&was);
    int fd = os_temporary(t->name), err = errno;
    FILE *f = fd < 0 ? NULL : fdopen(fd, "w");
    if (f) {
        mode_t mask = umask(0); /* mkstemp used 0600; set the mode that open(2) sets */
        umask(mask);
        fchmod(fd, 0666 & ~mask);
        add(t);
        *name = t->name;
    } else {
        if (fd >= 0) err = errno, close(fd), unlink(t->name);
        free(t);
    }
    sigprocmask(SIG_SETMASK, &was, NULL);
    errno = err;
    return f;
}

/* A stream that writes to the descriptor where that is now. */
static FILE *open_again(int fd)
{
    int other = fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    FILE *f = other < 0 ? NULL : fdopen(other, "w");
    if (fd == STDOUT_FILENO) fflush(stdout);
    if (!f && other >= 0) close(other);
    return f;
}

int outfile_open(struct outfile *o, const char *path)
{
    struct stat st;
    int fd;
    input_keep(path);
    *o = (struct outfile){.path = target_of(path, &fd)};
    if (!o->path) return -1;
    if (fd >= 0) o->f = open_again(fd);
    else if (stat(path, &st) == 0 && !S_ISREG(st.st_mode)) o->f = fopen(path, "we");
    else o->f = open_beside(o->path, &o->temporary);
    if (o->f) return 0;
    int err = errno;
    free(o->path);
    errno = err;
    return -1;
}

/* Renames or removes the temporary file. Returns 0 or an errno. */
static int end(struct outfile *o, bool keep)
{
    int err = 0;
    sigset_t was;
    if (o->temporary) {
        block(&was);
        if (keep && rename(o->temporary, o->path) != 0) err = errno;
        if (!keep || err) unlink(o->temporary);
        drop(o->temporary);
        sigprocmask(SIG_SETMASK, &was, NULL);
    }
    free(o->path);
    *o = (struct outfile){0};
    return err;
}

int outfile_commit(struct outfile *o)
{
    int err = 0;
    if (fflush(o->f) != 0 || ferror(o->f)) err = errno ? errno : EIO;
    if (fclose(o->f) != 0 && !err) err = errno;
    const int failed = end(o, !err);
    errno = err ? err : failed;
    return errno ? -1 : 0;
}

void outfile_discard(struct outfile *o)
{
    fclose(o->f);
    end(o, false);
}

int outfile_put(const char *path, const void *p, size_t n)
{
    struct outfile o;
    if (outfile_open(&o, path) != 0) return -1;
    if (fwrite(p, 1, n, o.f) == n) return outfile_commit(&o);
    int err = errno;
    outfile_discard(&o);
    errno = err;
    return -1;
}

int outfile_check(const char *path)
{
    int fd;
    input_keep(path);
    char *dir = target_of(path, &fd), *slash = dir ? strrchr(dir, '/') : NULL;
    if (!dir) return -1;
    const size_t n = strlen(slash ? slash + 1 : dir);
    struct stat st;
    int err = 0;
    if (slash) slash[slash == dir] = '\0';
    const char *at = slash ? dir : ".";
    if (stat(path, &st) == 0 && S_ISDIR(st.st_mode)) err = EISDIR;
    else if (fd >= 0) err = 0;
    else if (n + sizeof SUFFIX - 1 > NAME_MAX) err = ENAMETOOLONG;
    else if (!strchr(at, '%') && access(at, W_OK | X_OK) != 0) err = errno;
    free(dir);
    errno = err;
    return err ? -1 : 0;
}
