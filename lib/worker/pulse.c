/*
 * pulse: beats of a process that renders. A callback may load a scene for minutes, or take as long
 * for one pixel. Meanwhile a timer checks that the reader is still there and the run is not over,
 * and sends beats. It writes only while `busy`, when no record is half written. It stops itself
 * when the worker is idle.
 */
#include "patience/patience.h"
#include "worker/worker_int.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#define LOOK_US 100000

static volatile sig_atomic_t busy, ticking;
static volatile sig_atomic_t reading; /* the loop reads standard input itself */
static bool pulsing;                  /* worker_pulse_open was called */
static int64_t beat_us;               /* time of the latest; a slow process misses checks */

/* The last bytes of standard input, which are read here once its end is known. */
static unsigned char last[65536];
static volatile size_t n_last;
static struct buf over;            /* a `bye` */
static volatile sig_atomic_t said; /* what the loop has read ends with it */

static void set_timer(suseconds_t us)
{
    setitimer(ITIMER_REAL, &(struct itimerval){{0, us}, {0, us}}, NULL);
    ticking = us != 0;
}

/* Its sum is optional, as in every record from above. */
static bool ends_with_bye(const unsigned char *at, size_t n)
{
    static const char plain[] = "\nbye\n";
    size_t k = buf_size(&over), m = sizeof plain - 1;
    return (n >= k && memcmp(at + n - k, buf_data(&over), k) == 0) ||
           (n >= m && memcmp(at + n - m, plain, m) == 0) ||
           (n == m - 1 && memcmp(at, plain + 1, n) == 0);
}

/* Ends this process if its input ends with `bye`: the run is over, and needs no more pixels. */
static void look_ahead(void)
{
    struct pollfd p = {STDIN_FILENO, POLLIN, 0};
    ptrdiff_t n;
    if (poll(&p, 1, 0) <= 0 || !(p.revents & POLLHUP)) return;
    while (
        n_last < sizeof last && (n = read(STDIN_FILENO, last + n_last, sizeof last - n_last)) > 0)
        n_last += (size_t)n;
    if (n_last ? ends_with_bye(last, n_last) : said) _exit(ST_OK);
}

static void look(int sig)
{
    static const char beat[] = "beat\n";
    struct pollfd p = {STDOUT_FILENO, 0, 0};
    int err = errno;
    (void)sig;
    if (poll(&p, 1, 0) > 0 && p.revents & POLL_GONE) _exit(ST_SYSTEM);
    if (busy && !reading) look_ahead();
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
    wire_plain(&over, REC_BYE, NULL);
    pulsing = true;
}

bool worker_pulse_last(struct buf *to)
{
    reading = 1;
    if (!n_last) return false;
    buf_append(to, last, n_last);
    n_last = 0;
    return true;
}

void worker_pulse_heard(const struct buf *in) { said = ends_with_bye(buf_data(in), buf_size(in)); }

void worker_pulse_begin(void)
{
    if (!pulsing) return;
    busy = 1;
    if (ticking) return;
    beat_us = now_us();
    set_timer(LOOK_US);
}

void worker_pulse_end(void) { busy = reading = 0; }
