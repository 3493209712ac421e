/* Queues of bytes that never block their writer: see proc.h. */
#include "proc/proc.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

struct blob *blob_new(const void *p, size_t n)
{
    struct blob *b = xcalloc(1, sizeof *b);
    buf_append(&b->bytes, p, n);
    return b;
}

static void blob_drop(struct blob *b)
{
    if (--b->users > 0) return;
    buf_free(&b->bytes);
    free(b);
}

void down_append(struct down_queue *q, const void *p, size_t n)
{
    buf_append(&q->bytes, p, n);
    q->queued += n;
}

void down_share(struct down_queue *q, struct blob *b)
{
    if (q->first_blob == q->n_blobs) q->first_blob = q->n_blobs = 0;
    q->blobs = xrealloc(q->blobs, q->n_blobs + 1, sizeof *q->blobs);
    q->blobs[q->n_blobs++] = (struct down_blob){b, q->queued, 0};
    b->users++;
}

/* Bytes written, 0 when the pipe is full, -1. */
static ptrdiff_t write_now(int fd, const void *p, size_t n)
{
    ssize_t k;
    do k = n ? write(fd, p, n) : 0;
    while (k < 0 && errno == EINTR);
    return k < 0 && (errno == EAGAIN || errno == EWOULDBLOCK) ? 0 : k;
}

static ptrdiff_t write_blob(struct down_queue *q, struct down_blob *b, int fd)
{
    const struct buf *bytes = &b->blob->bytes;
    ptrdiff_t k = write_now(fd, buf_data(bytes) + b->sent, buf_size(bytes) - b->sent);
    if (k > 0) b->sent += (size_t)k;
    if (b->sent == buf_size(bytes)) {
        blob_drop(b->blob);
        q->first_blob++;
    }
    return k;
}

static ptrdiff_t write_bytes(struct down_queue *q, uint64_t end, int fd)
{
    ptrdiff_t k = write_now(fd, buf_data(&q->bytes), (size_t)(end - q->written));
    if (k <= 0) return k;
    buf_consume(&q->bytes, (size_t)k);
    q->written += (uint64_t)k;
    return k;
}

int down_write(struct down_queue *q, int fd)
{
    while (!down_empty(q)) {
        struct down_blob *b = q->first_blob < q->n_blobs ? &q->blobs[q->first_blob] : NULL;
        ptrdiff_t k = b && b->at == q->written ? write_blob(q, b, fd)
                                               : write_bytes(q, b ? b->at : q->queued, fd);
        if (k <= 0) return (int)k;
    }
    return 0;
}

void down_free(struct down_queue *q)
{
    for (; q->first_blob < q->n_blobs; q->first_blob++) blob_drop(q->blobs[q->first_blob].blob);
    free(q->blobs);
    buf_free(&q->bytes);
    *q = (struct down_queue){0};
}

void up_end_record(struct up_queue *q)
{
    size_t n = buf_size(&q->bulk) - q->marked;
    if (!n) return;
    buf_append(&q->sizes, &n, sizeof n);
    q->marked += n;
}

/* k bytes of bulk were written: how much of which record is left? */
static void advance_bulk(struct up_queue *q, size_t k)
{
    buf_consume(&q->bulk, k);
    q->marked -= k;
    while (k) {
        if (!q->left) {
            memcpy(&q->left, buf_data(&q->sizes), sizeof q->left);
            buf_consume(&q->sizes, sizeof q->left);
        }
        size_t step = k < q->left ? k : q->left;
        q->left -= step;
        k -= step;
    }
}

int up_write(struct up_queue *q, int fd)
{
    struct iovec v[2];
    size_t control = q->left ? 0 : buf_size(&q->control), bulk = q->left ? q->left : q->marked;
    if (control > PIPE_BUF) control = PIPE_BUF;
    if (control < buf_size(&q->control) && !q->left) bulk = 0; /* no control record is split */
    if (bulk > PIPE_BUF - control) bulk = PIPE_BUF - control;
    v[0] = (struct iovec){(void *)(uintptr_t)buf_data(&q->control), control};
    v[1] = (struct iovec){(void *)(uintptr_t)buf_data(&q->bulk), bulk};
    ssize_t k = writev(fd, v, 2);
    if (k < 0) return errno == EINTR ? 0 : -1;
    size_t first = (size_t)k < control ? (size_t)k : control;
    buf_consume(&q->control, first);
    advance_bulk(q, (size_t)k - first);
    return 0;
}

void up_free(struct up_queue *q)
{
    buf_free(&q->control);
    buf_free(&q->bulk);
    buf_free(&q->sizes);
    *q = (struct up_queue){0};
}
