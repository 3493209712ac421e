/* A log in memory, and whether it can be replayed. */
#include "history/history.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define READ_BYTES (1 << 16)

static int load(struct history_file *file, int fd)
{
    struct buf b = {0};
    ptrdiff_t n;
    while ((n = read_some(fd, &b, READ_BYTES)) > 0)
        ;
    *file = (struct history_file){b.data, b.len, false};
    return n < 0 ? -2 : 0;
}

int history_open(struct history_file *file, const char *path)
{
    struct stat st;
    int result = -1, fd = input_open(path);
    *file = (struct history_file){0};
    if (fd < 0) return -1;
    if (fstat(fd, &st) == 0) {
        size_t n = S_ISREG(st.st_mode) ? (size_t)st.st_size : 0;
        void *p = n ? mmap(NULL, n, PROT_READ, MAP_SHARED, fd, 0) : MAP_FAILED;
        if (p == MAP_FAILED) result = load(file, fd);
        else {
            *file = (struct history_file){p, n, true};
            result = 0;
        }
    }
    int err = errno;
    if (result) history_close(file);
    close(fd);
    errno = err;
    return result;
}

void history_close(struct history_file *file)
{
    if (file->mapped) munmap(file->bytes, file->n);
    else free(file->bytes);
    *file = (struct history_file){0};
}

bool history_replayable(const struct history *l, char err[HISTORY_ERR])
{
    if (l->n_frags && l->n_dones) return true;
    snprintf(err, HISTORY_ERR, "no task with pixels, expected the log of a run");
    return false;
}
