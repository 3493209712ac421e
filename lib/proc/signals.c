/* Signals that end a program which has children: see proc.h. */
#include "os/os.h"
#include "proc/proc_int.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define STOPPED_TRIES 200 /* a millisecond each, until children have stopped */

static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
#define N_ENDING (sizeof ending / sizeof *ending)

static volatile sig_atomic_t came; /* the first one that came */
static sigset_t before;            /* the mask at the start of this process */
static bool catching;

static volatile sig_atomic_t stops; /* SIGTSTP has come */

/*
 * Children stop first, and their children before them. So none of them can be told to go on before
 * it has stopped. A SIGCONT that has come meanwhile is pending, because it is blocked: it takes the
 * stop back.
 */
static void stop(void)
{
    sigset_t pending;
    const int64_t since_us = now_us();
    stops = 0;
    groups_signal(SIGTSTP);
    for (int i = 0; i < STOPPED_TRIES && !groups_stopped(); i++)
        nanosleep(&(struct timespec){0, 1000000}, NULL);
    if (sigpending(&pending) != 0 || !sigismember(&pending, SIGCONT)) raise(SIGSTOP);
    groups_signal(SIGCONT);
    clock_forget(now_us() - since_us);
}

static void note(int sig)
{
    if (sig == SIGTSTP) stops = 1;
    else if (sig != SIGCHLD && !came) came = sig;
    os_poll_end();
}

static void stop_now(int sig)
{
    (void)sig;
    const int err = errno;
    stop();
    errno = err;
}

/* Has this process, or the one that started it, set the signal aside? */
static bool ignored(int sig)
{
    struct sigaction act;
    return sigaction(sig, NULL, &act) == 0 && act.sa_handler == SIG_IGN;
}

void signals_catch_stop(void)
{
    const struct sigaction act = {.sa_handler = stop_now, .sa_flags = SA_RESTART};
    if (!ignored(SIGTSTP)) sigaction(SIGTSTP, &act, NULL);
}

void signals_catch(void)
{
    struct sigaction act = {.sa_handler = note};
    sigset_t blocked;
    sigfillset(&act.sa_mask); /* os_poll_end leaves the handler */
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGCHLD);
    sigaction(SIGCHLD, &act, NULL);
    for (size_t i = 0; i < N_ENDING; i++) {
        if (ignored(ending[i])) continue;
        sigaction(ending[i], &act, NULL);
        sigaddset(&blocked, ending[i]);
    }
    if (!ignored(SIGTSTP)) {
        sigaction(SIGTSTP, &act, NULL);
        sigaddset(&blocked, SIGTSTP);
        sigaddset(&blocked, SIGCONT);
    }
    signal(SIGPIPE, SIG_IGN);
    /* If this process is to be killed when its parent dies, changes that to SIGTERM: it has
     * children of its own to end. */
    if (os_dies_with_parent()) os_die_with_parent(SIGTERM);
    sigprocmask(SIG_BLOCK, &blocked, &before);
    catching = true;
}

static const char *last_words, *about;

static void say(int sig)
{
    if (access(about, F_OK) == 0) {
        ssize_t said = write(STDERR_FILENO, last_words, strlen(last_words));
        (void)said;
    }
    signal(sig, SIG_DFL);
    raise(sig);
}

void signals_say(const char *text, const char *file)
{
    last_words = text;
    about = file;
    for (size_t i = 0; i < N_ENDING; i++)
        if (signal(ending[i], say) == SIG_IGN) signal(ending[i], SIG_IGN);
}

static void reset(int sig)
{
    struct sigaction act;
    const bool own =
        sigaction(sig, NULL, &act) == 0 && (act.sa_handler == note || act.sa_handler == stop_now);
    if (own) signal(sig, SIG_DFL);
}

/* exec would reset caught signals, but not the mask and SIGPIPE. */
void signals_restore(void)
{
    signal(SIGPIPE, SIG_DFL);
    reset(SIGTSTP);
    stops = 0;
    if (!catching) return;
    reset(SIGCHLD);
    for (size_t i = 0; i < N_ENDING; i++) reset(ending[i]);
    sigprocmask(SIG_SETMASK, &before, NULL);
    catching = false;
    came = 0;
}

int signals_poll(struct pollfd *p, size_t n, int timeout_ms)
{
    int ready = os_poll(p, n, timeout_ms, catching ? &before : NULL);
    const int err = errno;
    if (stops) stop();
    errno = err;
    return ready;
}

bool signals_came(void) { return came != 0; }

void signals_die(void)
{
    sigset_t own;
    sigemptyset(&own);
    sigaddset(&own, came);
    signal(came, SIG_DFL);
    raise(came);
    sigprocmask(SIG_UNBLOCK, &own, NULL);
    _Exit(ST_SYSTEM);
}
