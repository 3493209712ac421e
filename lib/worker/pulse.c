/*
 * pulse: beats of a process that renders. A callback may load a scene for minutes, or take as long
 * for one pixel. Meanwhile a timer checks that the reader is still there, and sends beats. It
 * writes only while `busy`, when no record is half written. It stops itself when the worker is
 * idle.
 */
#include "patience/patience.h"
#include "worker/worker_int.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#define LOOK_US 100000

static volatile sig_atomic_t busy, ticking;
static bool pulsing;    /* worker_pulse_open was called */
static int64_t beat_us; /* time of the latest; a slow process misses checks */

static void set_timer(suseconds_t us)
{
    setitimer(ITIMER_REAL, &(struct itimerval){{0, us}, {0, us}}, NULL);
    ticking = us != 0;
}

static void look(int sig)
{
    static const char beat[] = "beat\n";
    struct pollfd p = {STDOUT_FILENO, 0, 0};
    int err = errno;
    (void)sig;
    if (poll(&p, 1, 0) > 0 && p.revents & POLL_GONE) _exit(ST_SYSTEM);
    if (now_us() - beat_us >= PATIENCE_BEAT_US) {
        beat_us = now_us();
        if (!busy) set_timer(0);
        else if (write(STDOUT_FILENO, beat, sizeof beat - 1) < 0) _exit(ST_SYSTEM);
    }
    errno = err;
}

void worker_pulse_open(void)
{
    struct sigaction act = {.sa_handler = look, .sa_flags = SA_RESTART};
    sigset_t own;
    sigemptyset(&act.sa_mask);
    sigemptyset(&own);
    sigaddset(&own, SIGALRM);
    sigaction(SIGALRM, &act, NULL);
    sigprocmask(SIG_UNBLOCK, &own, NULL);
    pulsing = true;
}

void worker_pulse_begin(void)
{
    if (!pulsing) return;
    busy = 1;
    if (ticking) return;
    beat_us = now_us();
    set_timer(LOOK_US);
}

void worker_pulse_end(void) { busy = 0; }
