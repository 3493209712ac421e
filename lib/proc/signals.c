/* Signals that end a program which has children: see proc.h. */
#include "os/os.h"
#include "proc/proc.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
#define N_ENDING (sizeof ending / sizeof *ending)

static volatile sig_atomic_t came; /* the first one that came */
static sigset_t before;            /* the mask at the start of this process */
static bool catching;

static void note(int sig)
{
    if (sig != SIGCHLD && !came) came = sig;
    os_poll_end();
}

void signals_catch(void)
{
    struct sigaction act = {.sa_handler = note}, old;
    sigset_t blocked;
    sigfillset(&act.sa_mask); /* os_poll_end leaves the handler */
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGCHLD);
    sigaction(SIGCHLD, &act, NULL);
    for (size_t i = 0; i < N_ENDING; i++) {
        if (sigaction(ending[i], NULL, &old) == 0 && old.sa_handler == SIG_IGN) continue;
        sigaction(ending[i], &act, NULL);
        sigaddset(&blocked, ending[i]);
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
    if (sigaction(sig, NULL, &act) == 0 && act.sa_handler == note) signal(sig, SIG_DFL);
}

/* exec would reset caught signals, but not the mask and SIGPIPE. */
void signals_restore(void)
{
    signal(SIGPIPE, SIG_DFL);
    if (!catching) return;
    reset(SIGCHLD);
    for (size_t i = 0; i < N_ENDING; i++) reset(ending[i]);
    sigprocmask(SIG_SETMASK, &before, NULL);
    catching = false;
    came = 0;
}

int signals_poll(struct pollfd *p, size_t n, int timeout_ms)
{
    return os_poll(p, n, timeout_ms, catching ? &before : NULL);
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
