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

static bool no_run(char err[HISTORY_ERR])
{
    snprintf(err, HISTORY_ERR, "no task with pixels, expected the log of a run");
    return false;
}

bool history_first_job(const struct history_file *file, uint64_t *hash, char err[HISTORY_ERR])
{
    struct decoder d = wire_over(file->bytes, file->n);
    struct record r;
    const char *job = NULL;
    size_t n = 0;
    enum wire_result got;
    d.upward = d.unsummed = true;
    while (!job && (got = wire_next(&d, &r)) != WIRE_MORE) {
        if (got != WIRE_RECORD) continue;
        if (!rec_ours(&r, d.why)) {
            snprintf(err, HISTORY_ERR, "%s", d.why);
            return false;
        }
        if (r.kind == REC_FRAME) job = rec_key(&r, "job", &n);
    }
    if (!job) return no_run(err);
    *hash = hash64(HASH64_INIT, job, n);
    return true;
}

bool history_replayable(const struct history *l, char err[HISTORY_ERR])
{
    return (l->n_frags && l->n_dones) || no_run(err);
}
