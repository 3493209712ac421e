/* The file that keeps a stream. */
#include "log/log.h"
#include "os/os.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LOCK_TRIES 10 /* of 10 ms */

static void close_keeping_errno(int *fd)
{
    int err = errno;
    if (*fd >= 0) close(*fd);
    *fd = -1;
    errno = err;
}

/* fragstat(1) holds the lock for a moment, to see whether a run does. */
static bool lock(int fd)
{
    for (int again = 0; os_lock(fd) != 0; again++) {
        if (errno != EWOULDBLOCK || again == LOCK_TRIES) return false;
        poll(NULL, 0, 10);
    }
    return true;
}

int log_open(struct log_file *l, const char *path)
{
    struct stat st;
    *l = (struct log_file){.path = path};
    bool regular = stat(path, &st) != 0 || S_ISREG(st.st_mode);
    l->fd = open(path, (regular ? O_RDWR : O_WRONLY) | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (l->fd < 0 || !regular) return l->fd < 0 ? -1 : 0;
    /* Check the size under the lock, when no other process can change it. */
    if (!lock(l->fd) || fstat(l->fd, &st) != 0) {
        close_keeping_errno(&l->fd);
        return -1;
    }
    l->holds = st.st_size > 0;
    return 0;
}

void log_append(struct log_file *l, const struct record *r)
{
    if (l->fd < 0) return;
    wire_copy(&l->pending, r);
}

int log_flush(struct log_file *l)
{
    if (l->fd < 0) return 0;
    const bool first = lseek(l->fd, 0, SEEK_END) == 0;
    int failed = write_full(l->fd, buf_data(&l->pending), buf_size(&l->pending));
    const int err = errno;
    if (failed && first) (void)!ftruncate(l->fd, 0); /* a part of a line is no log */
    errno = err;
    buf_consume(&l->pending, buf_size(&l->pending));
    if (failed) close_keeping_errno(&l->fd);
    return failed;
}

void log_close(struct log_file *l)
{
    close_keeping_errno(&l->fd);
    buf_free(&l->pending);
}

int log_reread(const struct log_file *l, struct intake *in, const struct log_reader *reader)
{
    return lseek(l->fd, 0, SEEK_SET) < 0 ? -1 : log_read(in, l->fd, l->path, reader);
}

static void survey(void *ctx, const struct record *r)
{
    struct intake *in = ctx;
    if (r->kind == REC_FRAME) {
        intake_frame(in, r);
        return;
    }
    struct assembly_frame *whole = intake_record(in, r);
    if (whole) assembly_release(&in->parts, whole);
}

/* The first line is a record with its sum: a hello, or a loss before the first one. Otherwise a
 * text with a record in it, such as a letter about logs, would be a log and get pixels. */
static bool begins_as_log(int fd)
{
    char text[WIRE_LINE_MAX];
    ssize_t n = pread(fd, text, sizeof text, 0);
    struct decoder d = {.upward = true};
    struct record r;
    if (n > 0) wire_feed(&d, text, (size_t)n);
    bool is = n == 0 || (wire_next(&d, &r) == WIRE_RECORD && rec_sealed(&r));
    wire_free(&d);
    return is;
}

int log_survey(const struct log_file *l, struct intake *in)
{
    const struct log_reader reader = {.record = survey, .ctx = in};
    intake_init(in, false);
    int odd = log_reread(l, in, &reader);
    if (odd || begins_as_log(l->fd)) return odd;
    snprintf(
        in->why, sizeof in->why, "is not a log, expected a whole record first, or an empty file");
    return 1;
}

int log_survey_path(const char *path, struct intake *in, char why[LOG_WHY])
{
    struct log_file l = {.path = path};
    struct stat st;
    intake_init(in, false);
    if (stat(path, &st) != 0) return errno == ENOENT ? 0 : -1;
    if (!S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode)) return 0;
    l.fd = input_open(path);
    if (l.fd < 0) return -1;
    intake_free(in);
    int failed = log_survey(&l, in);
    if (failed > 0) snprintf(why, LOG_WHY, "%s", in->why);
    log_close(&l);
    return failed;
}
