/* copy: a copy of a directory for one process, so that what a command writes is not seen by another
 * one. */
#include "crop/crop.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define OPEN_MOST 16 /* directories open at a time */

static size_t prefix; /* bytes of the name to copy */
static const char *target;

static int copy_bytes(int from, int to)
{
    ssize_t n;
    while ((n = copy_file_range(from, NULL, to, NULL, SSIZE_MAX, 0)) > 0) continue;
    if (n == 0) return 0;
    struct buf b = {0}; /* a file system that cannot */
    if (lseek(from, 0, SEEK_SET) != 0 || lseek(to, 0, SEEK_SET) != 0) return -1;
    while (
        (n = read_some(from, &b, 1 << 18)) > 0 && write_full(to, buf_data(&b), buf_size(&b)) == 0)
        buf_consume(&b, buf_size(&b));
    buf_free(&b);
    return n == 0 ? 0 : -1;
}

static int copy_file(const char *path, const char *to, mode_t mode)
{
    int in = open(path, O_RDONLY | O_CLOEXEC), out = -1, failed = -1;
    if (in >= 0) out = open(to, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, (mode & 0700) | 0600);
    if (out >= 0) failed = copy_bytes(in, out);
    int err = errno;
    if (in >= 0) close(in);
    if (out >= 0 && close(out) != 0 && !failed) return -1;
    errno = err;
    return failed;
}

static int copy_one(const char *path, const struct stat *st, int kind, struct FTW *at)
{
    char to[PATH_MAX];
    (void)at;
    if (snprintf(to, sizeof to, "%s%s", target, path + prefix) >= (int)sizeof to) {
        errno = ENAMETOOLONG;
        return -1;
    }
    if (kind == FTW_D) return mkdir(to, 0700);
    return kind == FTW_F ? copy_file(path, to, st->st_mode) : 0;
}

char *crop_copy(const char *path)
{
    static char to[PATH_MAX];
    snprintf(to, sizeof to, "%s-%ld", path, (long)getpid());
    prefix = strlen(path);
    target = to;
    if (nftw(path, copy_one, OPEN_MOST, FTW_PHYS) != 0) die(ST_SYSTEM, "%s: cannot be made:", to);
    return xstrdup(to);
}

void crop_remove_copies(const char *path)
{
    char *parent = xstrdup(path), *slash = strrchr(parent, '/');
    if (slash) *slash = '\0';
    const char *name = path + (slash ? slash + 1 - parent : 0);
    const size_t n = strlen(name);
    DIR *d = slash ? opendir(parent) : NULL;
    for (const struct dirent *e; d && (e = readdir(d));) {
        char copy[PATH_MAX];
        if (strncmp(e->d_name, name, n) != 0 || e->d_name[n] != '-') continue;
        if (snprintf(copy, sizeof copy, "%s/%s", parent, e->d_name) < (int)sizeof copy)
            crop_remove(copy);
    }
    if (d) closedir(d);
    free(parent);
}
