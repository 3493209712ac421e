/* copy: a copy of a directory for one process, so that what a command writes is not seen by another
 * one. */
#include "crop/crop.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int copy_bytes(int from, int to)
{
    ptrdiff_t n;
    struct buf b = {0};
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

/* What is copied, and where to: names that grow and shrink, because the directories may be deep. */
static char source[PATH_MAX], target[PATH_MAX];

static int copy_all(void);

/* Links are left out. */
static int copy_one(void)
{
    struct stat st;
    if (lstat(source, &st) != 0) return -1;
    if (S_ISDIR(st.st_mode)) return mkdir(target, 0700) == 0 ? copy_all() : -1;
    return S_ISLNK(st.st_mode) ? 0 : copy_file(source, target, st.st_mode);
}

static int append(char name[PATH_MAX], size_t n, const char *entry)
{
    if (snprintf(name + n, PATH_MAX - n, "/%s", entry) < (int)(PATH_MAX - n)) return 0;
    errno = ENAMETOOLONG;
    return -1;
}

/* What is in the directory. */
static int copy_all(void)
{
    const size_t n = strlen(source), k = strlen(target);
    int failed = 0;
    DIR *d = opendir(source);
    if (!d) return -1;
    for (const struct dirent *e; !failed && (e = readdir(d)) != NULL;) {
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0) continue;
        failed = append(source, n, e->d_name);
        if (!failed) failed = append(target, k, e->d_name);
        if (!failed) failed = copy_one();
        source[n] = target[k] = '\0';
    }
    int err = errno;
    closedir(d);
    errno = err;
    return failed;
}

char *crop_copy(const char *path)
{
    snprintf(source, PATH_MAX, "%s", path);
    snprintf(target, PATH_MAX, "%s-%ld", path, (long)getpid());
    if (copy_one() != 0) die(ST_SYSTEM, "%s: cannot be made:", target);
    return xstrdup(target);
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
