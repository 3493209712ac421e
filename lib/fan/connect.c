/*
 * fan: the order of connecting. A server limits connections that have not authenticated yet
 * (sshd's MaxStartups), so only a few are opened at a time to one host, and through one jump host.
 * Different hosts do not wait for each other. First tries go before retries. A host that was not up
 * yet, or whose last connection failed, is tried by one slot at a time, so it refuses only once.
 *
 * What this machine has limits the connections to all hosts: descriptors, memory, and processors,
 * which a new connection keeps busy until it has its keys.
 */
#include "fan/fan_int.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define OPENING_MOST 8        /* to one host, or through one */
#define OPENING_BYTES 4194304 /* of memory, for each connection */
#define PER_S 100             /* begun in a second, for each processor */
#define STARTING_MOST 2       /* on this machine, per round of the loop */
#define APART_MOST 8          /* on others, likewise */
#define ASKED_MOST 16         /* processes that print settings of ssh */
#define SETTINGS_MOST 65536   /* bytes that one prints */
#define SETTINGS_READ 8192    /* read at a time */
#define EACH 3                /* descriptors of a slot, */
#define OTHERS 16             /* and all others */
#define TURN_MS 500           /* the longest wait between two looks */

void fan_connect_limit(struct fan *f)
{
    const int all = OTHERS + EACH * f->n_slots;
    const double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    int there = want_descriptors(all);
    /* If there are fewer, those that are up need some. */
    int most = there < all ? (there - OTHERS) / EACH / 2 : f->n_slots;
    if (bytes > 0) most = (int)fmin(most, bytes / OPENING_BYTES);
    f->connecting_most = most > OPENING_MOST ? most : OPENING_MOST;
}

/* Notes that ssh connects to the host through another one. */
static void note_jump(struct fan *f, struct fan_host *h, char *jump)
{
    int k = 0;
    while (k < f->n_jumps && strcmp(f->jumps[k].name, jump) != 0) k++;
    h->jump = k + 1;
    if (k < f->n_jumps) {
        free(jump);
        return;
    }
    f->jumps = xrealloc(f->jumps, (size_t)++f->n_jumps, sizeof *f->jumps);
    f->jumps[k] = (struct fan_jump){.name = jump};
}

/* Takes the answer of a process that prints ssh's settings for the host. */
static void take_settings(struct fan *f, struct fan_host *h, struct child *c)
{
    struct buf said = {0};
    while (read_some(c->from, &said, SETTINGS_READ) > 0 && buf_size(&said) < SETTINGS_MOST)
        continue;
    child_end(c, 0);
    char *jump = host_jump((const char *)buf_data(&said), buf_size(&said));
    if (jump) note_jump(f, h, jump);
    buf_free(&said);
}

/* Asks ssh for its way to this host and those after it, some at a time because each takes 5 ms.
 * Nothing is connected. */
static void ask_each(struct fan *f, struct fan_host *h)
{
    struct child child[ASKED_MOST];
    struct fan_host *of[ASKED_MOST];
    int n = 0;
    for (; n < ASKED_MOST && h < f->hosts + f->n_hosts; h++) {
        if (h->asked || !h->by_ssh || host_via_jumps(h->host)) continue;
        h->asked = true;
        char **argv = host_settings_argv(h->host);
        if (argv && child_start_apart(&child[n], argv) == 0) of[n++] = h;
        host_argv_free(argv);
    }
    for (int i = 0; i < n; i++) take_settings(f, of[i], &child[i]);
}

/* True if ssh's configuration, as one host has it, may lead through others. */
static bool configured(const struct fan_host *h)
{
    struct buf said = {0};
    char **argv = host_settings_argv(h->host);
    int null = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (argv && null >= 0) child_run(argv, null, -1, &said);
    child_close(&null);
    host_argv_free(argv);
    buf_append(&said, "", 1);
    bool jumps = host_config_jumps((const char *)buf_data(&said), buf_size(&said) - 1);
    buf_free(&said);
    return jumps;
}

/* Learns whether another host is between. */
static void ask(struct fan *f, struct fan_host *h)
{
    bool few = f->n_by_ssh <= OPENING_MOST; /* never too many for a host between */
    if (few || !h->by_ssh) {
        h->asked = true;
    } else if (host_via_jumps(h->host)) {
        h->asked = true;
        note_jump(f, h, xstrdup(h->host->via));
    } else {
        if (!f->configured) f->configured = configured(h) ? FAN_JUMPS : FAN_DIRECT;
        if (f->configured == FAN_JUMPS) ask_each(f, h);
        h->asked = true;
    }
}

/* The host, the way to it, and this machine have room for a connection more. */
static bool has_room(struct fan *f, struct fan_host *h, int64_t now)
{
    if (!fan_host_limited(h)) return true;
    if (h->opening >= OPENING_MOST) return false;
    if (f->connecting >= f->connecting_most || f->paced_us > now) return false;
    if (!h->asked) ask(f, h);
    return !h->jump || f->jumps[h->jump - 1].opening < OPENING_MOST;
}

static bool may_open(struct fan *f, const struct fan_slot *s, int64_t now)
{
    if (s->state != FAN_WAITING || s->retry_us > now || !fan_slot_wanted(f, s)) return false;
    struct fan_host *h = s->host;
    if (h->here) return true;
    bool alone = !h->reached || h->failures;
    return !(alone && h->opening) && h->retry_us <= now && has_room(f, h, now);
}

/* Connections may begin at once if there were none for a second, and evenly after that. */
static void pace(struct fan *f, int64_t now)
{
    int64_t idle_us = now - 1000000;
    if (f->paced_us < idle_us) f->paced_us = idle_us;
    if (!f->pace_us) f->pace_us = 1000000 / (PER_S * cores_available());
    f->paced_us += f->pace_us;
}

int fan_connect(struct fan *f)
{
    int64_t now = now_us(), first_us = now + TURN_MS * INT64_C(1000);
    int here = 0, apart = 0; /* slots started on this machine, and on others */
    if (!f->n[FAN_WAITING]) return TURN_MS;
    for (int further = 0; further <= 1; further++)
        for (int k = 0; k < f->n_slots && apart < APART_MOST; k++) {
            struct fan_slot *s = &f->slots[k];
            bool first = !s->failures && !s->host->failures;
            if (first == further || !may_open(f, s, now)) continue;
            if (s->host->here && here++ >= STARTING_MOST) continue;
            if (fan_host_limited(s->host)) pace(f, now);
            apart += !s->host->here;
            fan_slot_open(f, s);
        }
    if (here > STARTING_MOST || apart == APART_MOST) return 0;
    if (f->paced_us > now) first_us = f->paced_us;
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        int64_t turn_us = s->retry_us > s->host->retry_us ? s->retry_us : s->host->retry_us;
        if (s->state == FAN_WAITING && turn_us > now && turn_us < first_us) first_us = turn_us;
    }
    return (int)((first_us - now + 999) / 1000);
}
