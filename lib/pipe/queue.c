/* Queues of bytes that never block their writer: see pipe.h. */
#include "keep/keep.h"
#include "pipe/pipe.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define WRITE_MOST 65536 /* bytes at a time: what a pipe holds */

struct blob *blob_new(struct buf *bytes)
{
    struct blob *b = xmalloc(1, sizeof *b);
    *b = (struct blob){.bytes = *bytes, .users = 1};
    *bytes = (struct buf){0};
    return b;
}

void blob_drop(struct blob *b)
{
    if (--b->users > 0) return;
    buf_free(&b->bytes);
    buf_free(&b->packed);
    buf_free(&b->kept);
    free(b);
}

void down_append(struct down_queue *q, const void *p, size_t n) { buf_append(&q->bytes, p, n); }

void down_begin(struct down_queue *q, const void *p, size_t n)
{
    struct buf bytes = {0};
    buf_append(&bytes, p, n);
    buf_append(&bytes, buf_data(&q->bytes), buf_size(&q->bytes));
    buf_free(&q->bytes);
    q->bytes = bytes;
    for (size_t i = q->first_blob; i < q->n_blobs; i++) q->blobs[i].at += n;
}

void down_share(struct down_queue *q, struct blob *b)
{
    if (q->first_blob == q->n_blobs) q->first_blob = q->n_blobs = 0;
    q->blobs = xgrown(q->blobs, q->n_blobs, sizeof *q->blobs);
    q->blobs[q->n_blobs++] = (struct down_blob){.blob = b, .at = q->written + buf_size(&q->bytes)};
    q->blob_bytes += buf_size(&b->bytes);
    b->users++;
}

/* Returns the bytes written, 0 if the pipe is full, or -1. */
static ptrdiff_t write_now(int fd, const void *p, size_t n)
{
    ssize_t k;
    do k = n ? write(fd, p, n) : 0;
    while (k < 0 && errno == EINTR);
    return k < 0 && (errno == EAGAIN || errno == EWOULDBLOCK) ? 0 : k;
}

/* True if the blob has a packed form; makes it. */
static bool is_packed(struct blob *b)
{
    struct decoder d = wire_over(b->bytes.data + b->bytes.off, buf_size(&b->bytes));
    struct record r;
    d.unsummed = true;
    if (!b->tried && wire_next(&d, &r) == WIRE_RECORD) wire_pack(&b->packed, &r);
    b->tried = true;
    return buf_size(&b->packed) > 0;
}

/* True if the reader of the queue has the body of the blob. */
static bool is_kept(const struct down_queue *q, struct blob *b)
{
    struct decoder d = wire_over(b->bytes.data + b->bytes.off, buf_size(&b->bytes));
    struct record r;
    d.unsummed = true;
    if (!q->keeps) return false;
    if (!b->hashed && wire_next(&d, &r) == WIRE_RECORD && r.body_len >= KEEP_LEAST) {
        sha256(r.body, r.body_len, b->hash);
        wire_keep(&b->kept, &r, b->hash);
    }
    b->hashed = true;
    return *b->hash && keep_names(q->keeps, b->hash);
}

static const struct buf *form_of(const struct down_queue *q, struct blob *b)
{
    if (is_kept(q, b)) return &b->kept;
    return q->packs && is_packed(b) ? &b->packed : &b->bytes;
}

static ptrdiff_t write_blob(struct down_queue *q, struct down_blob *b, int fd)
{
    if (!b->form) {
        b->form = form_of(q, b->blob);
        q->blob_bytes -= buf_size(&b->blob->bytes) - buf_size(b->form);
    }
    const struct buf *bytes = b->form;
    ptrdiff_t k = write_now(fd, buf_data(bytes) + b->sent, buf_size(bytes) - b->sent);
    if (k < 0) return k;
    b->sent += (size_t)k;
    q->blob_bytes -= (size_t)k;
    if (b->sent == buf_size(bytes)) {
        blob_drop(b->blob);
        q->first_blob++;
    }
    return k;
}

static ptrdiff_t write_bytes(struct down_queue *q, size_t n, int fd)
{
    ptrdiff_t k = write_now(fd, buf_data(&q->bytes), n);
    if (k <= 0) return k;
    buf_consume(&q->bytes, (size_t)k);
    q->written += (uint64_t)k;
    return k;
}

int down_write(struct down_queue *q, int fd)
{
    while (q->first_blob < q->n_blobs || buf_size(&q->bytes)) {
        struct down_blob *b = q->first_blob < q->n_blobs ? &q->blobs[q->first_blob] : NULL;
        size_t before = b ? (size_t)(b->at - q->written) : buf_size(&q->bytes);
        ptrdiff_t k = b && !before ? write_blob(q, b, fd) : write_bytes(q, before, fd);
        if (k <= 0) return (int)k;
    }
    return 0;
}

void down_free(struct down_queue *q)
{
    for (; q->first_blob < q->n_blobs; q->first_blob++) blob_drop(q->blobs[q->first_blob].blob);
    free(q->blobs);
    free(q->keeps);
    buf_free(&q->bytes);
    *q = (struct down_queue){0};
}

void up_end_record(struct up_queue *q)
{
    if (q->packs && buf_size(&q->bulk) > q->marked) wire_pack_last(&q->bulk, q->marked);
    size_t n = buf_size(&q->bulk) - q->marked;
    if (!n) return;
    buf_append(&q->sizes, &n, sizeof n);
    q->marked += n;
}

/* k bytes of bulk were written: updates the rest of the record under way. */
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

int up_write(struct up_queue *q, int fd, size_t most)
{
    /* The rest of a record under way, then control, then other records. */
    size_t part[3] = {q->left, buf_size(&q->control), q->marked - q->left};
    struct iovec v[3];
    for (int i = 0; i < 3; i++) {
        const unsigned char *at = i == 1 ? buf_data(&q->control) : buf_data(&q->bulk);
        if (part[i] > most) part[i] = most; /* then nothing follows */
        most -= part[i];
        v[i] = (struct iovec){(void *)(uintptr_t)(i == 2 ? at + q->left : at), part[i]};
    }
    ssize_t k = writev(fd, v, 3);
    if (k < 0) return errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK ? 0 : -1;
    size_t n = (size_t)k, first = n < part[0] ? n : part[0];
    advance_bulk(q, first);
    n -= first;
    size_t second = n < part[1] ? n : part[1];
    buf_consume(&q->control, second);
    advance_bulk(q, n - second);
    return 0;
}

void up_free(struct up_queue *q)
{
    buf_free(&q->control);
    buf_free(&q->bulk);
    buf_free(&q->sizes);
    *q = (struct up_queue){0};
}

size_t stdout_private(void)
{
    struct stat st;
    if (fstat(STDOUT_FILENO, &st) != 0 || !S_ISFIFO(st.st_mode)) return PIPE_BUF;
    int fd = open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) return PIPE_BUF;
    bool done = dup2(fd, STDOUT_FILENO) == STDOUT_FILENO;
    close(fd);
    return done ? WRITE_MOST : PIPE_BUF;
}
