/* Stream handling that both drivers share. */
#include "keep/keep.h"
#include "patience/patience.h"
#include "pipe/pipe.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <unistd.h>

#define READ_BYTES 65536

struct pollfd pipe_poll_entry(int fd, bool wanted, short events)
{
    return (struct pollfd){.fd = wanted ? fd : -1, .events = events};
}

int stream_read(struct decoder *d, int fd)
{
    ptrdiff_t n = read_some(fd, &d->in, READ_BYTES);
    if (fd == STDIN_FILENO && n > 0) silence_heard();
    if (fd == STDIN_FILENO && n <= 0) silence_forget();
    if (n > 0) return 1;
    wire_end(d);
    return (int)n;
}

int stream_take(struct decoder *d, stream_taker *take, void *ctx)
{
    struct record r;
    enum wire_result result;
    int status;
    while ((result = wire_next(d, &r)) == WIRE_RECORD) {
        stream_keep(&r);
        if (!silence_take(&r) && (status = take(ctx, &r)) != 0)
            return status == STREAM_HOLD ? 0 : status;
    }
    if (result != WIRE_BAD) return 0;
    warn("standard input: %s", d->why);
    return ST_USAGE;
}

int stream_input(struct decoder *d, bool *open, stream_taker *take, void *ctx)
{
    int more = stream_read(d, STDIN_FILENO);
    *open = more > 0;
    if (more >= 0) return stream_take(d, take, ctx);
    warn("standard input:");
    return ST_SYSTEM;
}

struct frame_size *stream_frame(struct stream_state *f, const struct record *r)
{
    struct frame_size *frame = frames_set(&f->frames, r->task.frame, r->frame_w, r->frame_h);
    generation_frame(&f->generations, frame);
    return frame;
}

const struct frame_size *stream_frame_of(const struct stream_state *f, const struct record *r)
{
    const struct task *t = &r->task;
    const struct frame_size *frame = frames_find(&f->frames, t->frame);
    bool inside = frame && lattice_valid(&t->at, frame->w, frame->h);
    if (inside && generation_lives(&f->generations, frame)) return frame;
    if (inside)
        warn("task %u %u: its state was replaced too often, expected it earlier", t->frame, t->id);
    else if (frame)
        warn("task %u %u: expected pixels inside %ux%u", t->frame, t->id, frame->w, frame->h);
    else warn("task %u %u: expected `frame` before its tasks", t->frame, t->id);
    return NULL;
}

void up_forward(
    struct up_queue *q, const struct record *r, const char *const *drop, const char *extra)
{
    wire_forward(&q->bulk, r, drop, extra);
    up_end_record(q);
}

void outlet_open(struct outlet *o) { o->most = stdout_private(); }

struct pollfd outlet_poll(const struct outlet *o)
{
    return (struct pollfd){STDOUT_FILENO, up_size(&o->queue) ? POLLOUT : 0, 0};
}

static void outlet_write(struct outlet *o)
{
    if (up_write(&o->queue, STDOUT_FILENO, o->most) == 0) return;
    if (errno != EPIPE) warn("standard output:");
    o->gone = true;
}

void outlet_polled(struct outlet *o, const struct pollfd *p)
{
    if (p->revents & POLL_GONE) o->gone = true;
    o->full = p->events & POLLOUT && !(p->revents & POLLOUT);
    if (!o->gone && p->revents & POLLOUT) outlet_write(o);
}

void outlet_push(struct outlet *o)
{
    if (o->most > PIPE_BUF && !o->full && !o->gone && up_size(&o->queue)) outlet_write(o);
}

void outlet_beat(struct outlet *o)
{
    int64_t now = now_us();
    if (!o->greeted || now - o->beat_us < PATIENCE_BEAT_US) return;
    o->beat_us = now;
    wire_plain(&o->queue.control, REC_BEAT, NULL);
}

void outlet_beat_within(struct outlet *o, const struct decoder *input)
{
    if (buf_size(&input->in) > WIRE_LINE_MAX && !input->ended) outlet_beat(o);
}

void outlet_answer(struct outlet *o)
{
    if (o->greeted) wire_plain(&o->queue.control, REC_BEAT, NULL);
}

/* The sender has probed the link: it is on another machine. */
static bool probed;

bool stream_kept(const char *hash, size_t n, struct buf *to)
{
    if (keep_read(hash, n, to)) return true;
    die(ST_SYSTEM, "standard input: state %.16s... is not kept here any more, or was damaged",
        hash);
}

void stream_keep(const struct record *r)
{
    bool state = r->kind >= REC_SCENE && r->kind <= REC_FILES;
    /* Without a body it was dropped, because it does not fit in memory. */
    if (probed && state && r->body && !rec_kept(r)) keep_write(r->body, r->body_len);
}

void stream_code(const struct record *r, struct buf *to, bool *packs)
{
    int64_t n;
    char has[KEEP_LIST + 8] = "has=";
    if (rec_int(r, "probe", 0, WIRE_PROBE_MAX, &n)) {
        keep_list(has + strlen(has));
        wire_probe(to, (size_t)n, has[4] ? has : NULL);
        probed = true;
    }
    *packs |= rec_int(r, "zstd", 1, 1, &n);
}

void outlet_code(struct outlet *o, const struct record *r)
{
    stream_code(r, &o->queue.control, &o->queue.packs);
}

void outlet_drain(struct outlet *o)
{
    while (up_size(&o->queue) && !o->gone && !signals_came()) {
        struct pollfd p = outlet_poll(o);
        if (signals_poll(&p, 1, -1) >= 0) outlet_polled(o, &p);
        else if (errno != EINTR) die(ST_SYSTEM, "poll:");
    }
}
