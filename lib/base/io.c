/* io: checked reading and writing, and files that appear only when complete. */
#include "base/base.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int write_full(int fd, const void *p, size_t n)
{
    const char *at = p;
    while (n) {
        ssize_t k = write(fd, at, n);
        if (k < 0 && errno == EINTR) continue;
        if (k < 0) return -1;
        at += k;
        n -= (size_t)k;
    }
    return 0;
}

ptrdiff_t read_some(int fd, struct buf *b, size_t most)
{
    unsigned char *to = buf_reserve(b, most);
    ssize_t k;
    do k = read(fd, to, most);
    while (k < 0 && errno == EINTR);
    if (k > 0) b->len += (size_t)k;
    return k;
}

int read_open(const char **name)
{
    if (strcmp(*name, "-") == 0) {
        *name = "standard input";
        return STDIN_FILENO;
    }
    int fd = open(*name, O_RDONLY | O_CLOEXEC);
    if (fd < 0) die(ST_USAGE, "%s:", *name);
    return fd;
}

/* Room for the whole of a regular file, and a byte in which the end is found. */
static void reserve_file(int fd, struct buf *b)
{
    struct stat st;
    if (b->data || fstat(fd, &st) != 0 || !S_ISREG(st.st_mode) || st.st_size <= 0) return;
    b->cap = (size_t)st.st_size + 1;
    b->data = xmalloc(b->cap, 1);
    base_populate(b->data, b->cap);
}

int read_file(const char *path, struct buf *b)
{
    int fd = strcmp(path, "-") == 0 ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return -1;
    reserve_file(fd, b);
    ptrdiff_t k;
    while ((k = read_some(fd, b, b->cap > b->len ? b->cap - b->len : 1 << 16)) > 0)
        ;
    int err = errno;
    if (fd != STDIN_FILENO) close(fd);
    errno = err;
    return k < 0 ? -1 : 0;
}

bool load_file(const char *path, struct buf *b, char err[ERR_BYTES])
{
    *b = (struct buf){0};
    if (read_file(path, b) == 0) return true;
    int why = errno;
    buf_free(b);
    return err_set(err, "%.128s: %s", path, strerror(why));
}

void put_stdout(const void *p, size_t n)
{
    if (fwrite(p, 1, n, stdout) != n) die(ST_SYSTEM, "standard output:");
}

void put_stdout_buf(struct buf *b)
{
    put_stdout(buf_data(b), buf_size(b));
    buf_consume(b, buf_size(b));
}

int outfile_open(struct outfile *o, const char *path)
{
    struct stat st;
    *o = (struct outfile){0};
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode)) {
        o->f = fopen(path, "we");
        if (!o->f) return -1;
    } else {
        size_t n = strlen(path) + sizeof ".XXXXXX";
        o->temporary = xmalloc(n, 1);
        snprintf(o->temporary, n, "%s.XXXXXX", path);
        int fd = mkostemp(o->temporary, O_CLOEXEC);
        o->f = fd < 0 ? NULL : fdopen(fd, "w");
        if (!o->f) {
            int err = errno;
            if (fd >= 0) close(fd), unlink(o->temporary);
            free(o->temporary);
            errno = err;
            return -1;
        }
        mode_t mask = umask(0); /* mkostemp used 0600; set the mode that open(2) sets */
        umask(mask);
        fchmod(fd, 0666 & ~mask);
    }
    o->path = xstrdup(path);
    return 0;
}

static void outfile_end(struct outfile *o, bool keep)
{
    if (o->temporary && !keep) unlink(o->temporary);
    free(o->temporary);
    free(o->path);
    *o = (struct outfile){0};
}

int outfile_commit(struct outfile *o)
{
    int err = 0;
    if (fflush(o->f) != 0 || ferror(o->f)) err = errno ? errno : EIO;
    if (fclose(o->f) != 0 && !err) err = errno;
    if (!err && o->temporary && rename(o->temporary, o->path) != 0) err = errno;
    outfile_end(o, !err);
    errno = err;
    return err ? -1 : 0;
}

void outfile_discard(struct outfile *o)
{
    fclose(o->f);
    outfile_end(o, false);
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

bool outfile_is(const char *a, const char *b)
{
    struct stat x, y;
    return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

int outfile_check(const char *path)
{
    char *dir = xstrdup(path), *slash = strrchr(dir, '/');
    if (slash) slash[slash == dir] = '\0';
    const char *at = slash ? dir : ".";
    int failed = strchr(at, '%') ? 0 : access(at, W_OK | X_OK);
    int err = errno;
    free(dir);
    errno = err;
    return failed;
}
