/*
 * The silence of the program at the other end of standard input. If its host was cut off, or its
 * sshd is stopped, no read and no write of this process may ever fail. So that program sends beats,
 * and this process counts on a timer how long nothing has come: also while it computes, and while a
 * write blocks. It counts its own ticks, so that time in which it was stopped does not count.
 */
#include "os/os.h"
#include "pipe/pipe.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define TICKS 8     /* in the time allowed */
#define UNREAD 1024 /* bytes; if these wait here, the pipe may be full, and nothing can come */

static volatile sig_atomic_t heard; /* something was read since the last tick */
static int silent;                  /* ticks without that */
static int unread;                  /* bytes that waited at the last tick */
static bool counting;
static timer_t timer;
static char text[160]; /* the last words */

/* True if something has come, or could not have come. */
static bool came(void)
{
    struct pollfd in = {STDIN_FILENO, POLLIN, 0};
    int before = unread;
    unread = os_unread(STDIN_FILENO);
    if (unread < 0) return true;
    if (heard || unread != before || unread >= UNREAD) return true;
    return !unread && poll(&in, 1, 0) > 0; /* its end waits */
}

static void tick(int sig)
{
    int err = errno;
    struct pollfd out = {STDERR_FILENO, POLLOUT, 0};
    (void)sig;
    silent = came() ? 0 : silent + 1;
    heard = 0;
    errno = err;
    if (silent < TICKS) return;
    if (poll(&out, 1, 0) > 0 && write(STDERR_FILENO, text, strlen(text)) < 0) _exit(ST_SYSTEM);
    _exit(ST_SYSTEM);
}

void silence_heard(void) { heard = 1; }

static void count(const struct record *r)
{
    struct sigaction act = {.sa_handler = tick, .sa_flags = SA_RESTART};
    struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGRTMIN};
    double within_s;
    if (!rec_real(r, "within", WIRE_WITHIN_LEAST, WIRE_WITHIN_MOST, &within_s)) return;
    snprintf(text, sizeof text, "%s: nothing came on standard input for %g s: it ends\n",
        prog_name(), within_s);
    heard = 1;
    sigemptyset(&act.sa_mask);
    sigaction(SIGRTMIN, &act, NULL);
    if (!counting && timer_create(CLOCK_MONOTONIC, &event, &timer) != 0) return;
    counting = true;
    int64_t ns = (int64_t)(within_s / TICKS * 1e9);
    struct timespec t = {.tv_sec = (time_t)(ns / 1000000000), .tv_nsec = (long)(ns % 1000000000)};
    timer_settime(timer, 0, &(struct itimerspec){t, t}, NULL);
}

bool silence_take(const struct record *r)
{
    if (r->kind == REC_ALIVE) count(r);
    return r->kind == REC_ALIVE || r->kind == REC_BEAT;
}

void silence_forget(void)
{
    if (counting) timer_delete(timer);
    counting = false;
}
