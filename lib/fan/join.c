/*
 * fan: the tables of hosts and slots, and a hosts file that changes during the run. Lines that are
 * new join it, with new numbers; slots of lines that are no longer there drain:
 *
 *   the slot is   then
 *   up            `drain` goes to the policy, which gives it nothing more; once the policy sends
 *                 `leave`, its input ends, and so does its worker, which is stopped if it has
 *                 tasks that the policy gave to others; `gone why=left` is reported
 *   not up        it is given up at once, with `gone why=left`
 *
 * Another power= of a line is told to the policy by another `up`. Only a policy can do all this; it
 * sends `joins` before its first task.
 */
#include "fan/fan_int.h"

#include <stdlib.h>
#include <string.h>

#define FAN_POLL(n) (3 * (size_t)(n) + 2) /* entries of poll for n slots */

int fan_staff(const struct fan *f)
{
    int n = 0;
    for (int k = 0; k < f->n_slots; k++) n += f->slots[k].drains ? 0 : f->slots[k].width;
    return n;
}

/* ---- the tables ---- */

int fan_workers(const struct fan *f, const struct hosts *h)
{
    return f->o->one_each ? (int)h->n : h->slots;
}

void fan_add_host(struct fan *f, struct host *line)
{
    if (f->n_hosts == f->room_hosts) {
        struct fan_host *before = f->hosts;
        f->room_hosts = f->room_hosts ? 2 * f->room_hosts : 16;
        f->hosts = xmalloc((size_t)f->room_hosts, sizeof *f->hosts);
        if (before) memcpy(f->hosts, before, (size_t)f->n_hosts * sizeof *before);
        for (int k = 0; k < f->n_slots; k++)
            f->slots[k].host = f->hosts + (f->slots[k].host - before);
        free(before);
    }
    f->hosts[f->n_hosts++] = (struct fan_host){.host = line,
        .argv = fan_command_line(line, f->o->command, f->o->one_each ? line->slots : 1),
        .here = host_is_here(line),
        .by_ssh = host_by_ssh(line)};
    f->n_by_ssh += host_by_ssh(line);
}

static void add_slot(struct fan *f, int h, int width)
{
    if (f->n_slots == f->room_slots) {
        f->room_slots = f->room_slots ? 2 * f->room_slots : 16;
        f->slots = xrealloc(f->slots, (size_t)f->room_slots, sizeof *f->slots);
        f->poll = xrealloc(f->poll, FAN_POLL(f->room_slots), sizeof *f->poll);
    }
    f->n[FAN_WAITING]++;
    fan_slot_init(f, f->n_slots++, f->n_numbers, width, &f->hosts[h]);
    f->n_numbers += width;
}

void fan_add_slots(struct fan *f, int h, int n)
{
    int width = f->o->one_each ? n : 1, more = n / width;
    if (f->listing && more > FAN_ASKED) more = FAN_ASKED;
    for (int k = 0; k < more; k++) add_slot(f, h, width);
    if (more * width < n) add_slot(f, h, n - more * width); /* never started */
    fan_connect_limit(f);
}

/* ---- slots that leave ---- */

static void drain(struct fan *f, struct fan_slot *s)
{
    char text[24];
    s->drains = true;
    switch (s->state) {
    case FAN_WAITING: fan_slot_give_up(f, s, "left"); break;
    case FAN_OPENING:
    case FAN_QUEUED: fan_slot_lose(f, s, "left", false); break;
    case FAN_UP:
        for (int i = 0; i < s->width; i++) {
            snprintf(text, sizeof text, "w=%d", s->number + i);
            wire_plain(&f->out.queue.bulk, REC_DRAIN, text);
            up_end_record(&f->out.queue);
        }
        break;
    default: break; /* it ends anyway, and is not connected again */
    }
}

void fan_dismiss(struct fan *f, int k)
{
    struct fan_slot *s = fan_slot_of(f, k);
    if (!s->drains || s->state != FAN_UP || s->dismissed == s->width) return;
    if (++s->dismissed < s->width || !s->n_tasks) return;
    fan_slot_forget(s); /* others have these tasks */
    fan_slot_lose(f, s, "left", false);
}

/* The last n slots of host h that do not drain yet. */
static int drain_some(struct fan *f, const struct fan_host *h, int n)
{
    int left = n;
    for (int k = f->n_slots - 1; k >= 0 && left > 0; k--) {
        struct fan_slot *s = &f->slots[k];
        if (s->host != h || s->drains) continue;
        drain(f, s);
        left -= s->width;
    }
    return n - left;
}

/* ---- a new version ---- */

struct changes {
    int joined, drained; /* slots */
};

static int slots_of(const struct fan *f, const struct fan_host *h)
{
    int n = 0;
    for (int k = 0; k < f->n_slots; k++)
        if (f->slots[k].host == h && !f->slots[k].drains) n += f->slots[k].width;
    return n;
}

/* The host that this line keeps, or -1. A worker cannot change its number of slots. */
static int kept_by(const struct fan *f, const struct host *line)
{
    for (int i = 0; i < f->n_hosts; i++) {
        const struct fan_host *h = &f->hosts[i];
        if (h->kept || h->removed || !host_same(h->host, line)) continue;
        if (!f->o->one_each || h->host->slots == line->slots) return i;
    }
    return -1;
}

/* Power and number of slots may have changed. */
static void keep(struct fan *f, int i, struct host *line, struct changes *c)
{
    struct fan_host *h = &f->hosts[i];
    h->kept = true;
    h->host = line;
    int more = fan_numbers(f->o, line) - slots_of(f, h);
    if (more > 0) {
        fan_add_slots(f, i, more);
        c->joined += more;
    } else {
        c->drained += drain_some(f, h, -more);
    }
    for (int k = 0; line->power > 0 && k < f->n_slots; k++)
        if (f->slots[k].host == h) fan_slot_set_power(f, &f->slots[k], line->power);
}

static void take_version(struct fan *f, struct hosts *new)
{
    struct changes c = {0};
    for (int i = 0; i < f->n_hosts; i++) f->hosts[i].kept = false;
    for (size_t i = 0; i < new->n; i++) {
        struct host *line = &new->at[i];
        int kept = kept_by(f, line);
        if (kept >= 0) {
            keep(f, kept, line, &c);
            continue;
        }
        fan_add_host(f, line);
        fan_add_slots(f, f->n_hosts - 1, fan_numbers(f->o, line));
        f->hosts[f->n_hosts - 1].kept = true;
        c.joined += fan_numbers(f->o, line);
    }
    for (int i = 0; i < f->n_hosts; i++) {
        struct fan_host *h = &f->hosts[i];
        if (h->kept || h->removed) continue;
        h->removed = true;
        c.drained += drain_some(f, h, HOSTS_SLOTS_MAX);
    }
    if (c.joined || c.drained)
        warn("%s: %d slots join the run, %d leave it", f->watch.file, c.joined, c.drained);
}

void fan_join(struct fan *f)
{
    struct hosts new;
    char err[HOSTS_ERR];
    if (f->joins ? !f->in_open : !f->asked) return;
    enum hosts_news news = hosts_watch(&f->watch, now_us(), &new, err);
    if (news == HOSTS_BAD) warn("%s; the hosts stay as they were", err);
    if (news != HOSTS_NEW) return;
    if (!hosts_send(&new, f->o->sent, f->o->command, err)) {
        warn("%s: %s; the hosts stay as they were", f->watch.file, err);
        hosts_free(&new);
        return;
    }
    bool room =
        f->n_numbers <= WIRE_SLOTS_MAX - new.slots &&fan_workers(f, &new) <= FAN_MOST - f->n_slots;
    if (f->joins && room) {
        f->versions = xrealloc(f->versions, (size_t)f->n_versions + 1, sizeof *f->versions);
        f->versions[f->n_versions++] = new;
        take_version(f, &new);
        return;
    }
    if (!f->joins)
        warn("%s has changed: the hosts stay as they were, because %s; expected a method whose "
             "slots may join and leave, such as adaptive",
            f->watch.file,
            f->ring ? "the published ring has a fixed number of nodes"
                    : "each task has its slot in advance");
    else
        warn("%s has changed too often: the hosts stay as they were, expected at most %d slots "
             "and %d workers over the run",
            f->watch.file, WIRE_SLOTS_MAX, FAN_MOST);
    hosts_free(&new);
}
