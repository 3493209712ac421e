/* io: checked reading and writing. */
#include "base/base.h"
#include "os/os.h"

#include <errno.h>
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
    int fd = input_open(*name);
    if (fd < 0) die(ST_USAGE, "%s:", *name);
    if (strcmp(*name, "-") == 0) *name = "standard input";
    return fd;
}

/* Room for the whole of a regular file, and a byte in which the end is found. */
static void reserve_file(int fd, struct buf *b)
{
    struct stat st;
    if (b->data || fstat(fd, &st) != 0 || !S_ISREG(st.st_mode) || st.st_size <= 0) return;
    b->cap = (size_t)st.st_size + 1;
    b->data = xmalloc(b->cap, 1);
    os_populate(b->data, b->cap);
}

int read_file(const char *path, struct buf *b)
{
    int fd = input_open(path);
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
    char shown[ERR_PATH];
    return err_set(err, "%s: %s", err_path(shown, path), strerror(why));
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
