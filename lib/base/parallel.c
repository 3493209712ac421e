/* parallel: a few threads that run the same function for many numbers. */
#include "base/base.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

struct parallel {
    pthread_mutex_t lock; /* guards all below */
    pthread_cond_t begun, done;
    parallel_job job;
    void *ctx;
    uint32_t next, n; /* the next number to take, and their number */
    uint32_t busy;    /* numbers that threads work at */
    bool stop;
    int n_threads; /* besides the caller's */
    pthread_t thread[];
};

/* Takes numbers until none is left. Called and left with the lock. */
static void take(struct parallel *p)
{
    while (p->next < p->n) {
        uint32_t i = p->next++;
        p->busy++;
        pthread_mutex_unlock(&p->lock);
        p->job(p->ctx, i);
        pthread_mutex_lock(&p->lock);
        p->busy--;
    }
    if (!p->busy) pthread_cond_signal(&p->done);
}

static void *thread(void *arg)
{
    struct parallel *p = arg;
    pthread_mutex_lock(&p->lock);
    while (!p->stop) {
        take(p);
        pthread_cond_wait(&p->begun, &p->lock);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

struct parallel *parallel_new(int threads)
{
    struct parallel *p = xcalloc(1, sizeof *p + (size_t)threads * sizeof *p->thread);
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->begun, NULL);
    pthread_cond_init(&p->done, NULL);
    /* Signals go to the caller's thread, where they went before. */
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    while (p->n_threads < threads - 1 &&
           pthread_create(&p->thread[p->n_threads], NULL, thread, p) == 0)
        p->n_threads++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return p;
}

void parallel_run(struct parallel *p, uint32_t n, parallel_job job, void *ctx)
{
    if (!p->n_threads || n == 1) {
        for (uint32_t i = 0; i < n; i++) job(ctx, i);
        return;
    }
    pthread_mutex_lock(&p->lock);
    p->job = job;
    p->ctx = ctx;
    p->next = 0;
    p->n = n;
    pthread_cond_broadcast(&p->begun);
    take(p);
    while (p->busy) pthread_cond_wait(&p->done, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

void parallel_free(struct parallel *p)
{
    pthread_mutex_lock(&p->lock);
    p->stop = true;
    pthread_cond_broadcast(&p->begun);
    pthread_mutex_unlock(&p->lock);
    for (int i = 0; i < p->n_threads; i++) pthread_join(p->thread[i], NULL);
    pthread_cond_destroy(&p->begun);
    pthread_cond_destroy(&p->done);
    pthread_mutex_destroy(&p->lock);
    free(p);
}
