/*
 * builder: a thread that loads a state record, or builds what a frame needs, while the loop of the
 * parent (forks.c) goes on with the tasks of earlier state. There is one thread at a time, and the
 * parent forks no child meanwhile. Until builder_join, only the thread uses the state.
 */
#include "os/os.h"
#include "worker/worker_int.h"

#include <errno.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>

static void *run(void *builder)
{
    struct worker_builder *b = builder;
    const struct worker *w = b->w;
    if (b->body) b->failed = w->ops->state(w->ctx, b->generation, b->kind, b->body, b->n, b->err);
    else b->failed = w->ops->ready(w->ctx, &b->frame, b->err);
    while (write(b->done[1], "", 1) < 0 && errno == EINTR)
        ;
    return NULL;
}

void worker_builder_open(struct worker_builder *b, const struct worker *w)
{
    *b = (struct worker_builder){.w = w};
    if (os_pipe(b->done) != 0) die(ST_SYSTEM, "pipe:");
}

void worker_builder_close(struct worker_builder *b)
{
    close(b->done[0]);
    close(b->done[1]);
}

static void start(struct worker_builder *b)
{
    b->busy = true;
    b->failed = 0;
    errno = pthread_create(&b->thread, NULL, run, b);
    if (errno) die(ST_SYSTEM, "a thread to build:");
}

void worker_builder_load(struct worker_builder *b, const struct record *r, unsigned char *body)
{
    b->kind = r->kind;
    b->body = body;
    b->n = r->body_len;
    b->generation = b->w->generations.now;
    start(b);
}

void worker_builder_build(struct worker_builder *b, const struct frame_size *f)
{
    b->body = NULL;
    b->frame = *f;
    b->generation = f->generation;
    start(b);
}

void worker_builder_join(struct worker_builder *b)
{
    char said;
    while (read(b->done[0], &said, 1) < 0 && errno == EINTR)
        ;
    errno = pthread_join(b->thread, NULL);
    if (errno) die(ST_SYSTEM, "the thread that builds:");
    b->busy = false;
}
