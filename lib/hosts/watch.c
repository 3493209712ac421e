/* A hosts file that may change while it is in use. Its status is read on a timer, because the
 * kernel does not report changes that another machine makes to a shared file. */
#include "hosts/hosts_int.h"

#include <string.h>

#define LOOK_US 1000000

static bool same(const struct hosts_version *a, const struct hosts_version *b)
{
    return a->device == b->device && a->number == b->number && a->bytes == b->bytes &&
           a->written_ns == b->written_ns && a->changed_ns == b->changed_ns;
}

void hosts_watch_open(struct hosts_watch *w, const struct hosts *h)
{
    *w = (struct hosts_watch){.file = h->file, .known = h->version, .last = h->version};
}

enum hosts_news hosts_watch(
    struct hosts_watch *w, int64_t now_us, struct hosts *h, char err[HOSTS_ERR])
{
    if (!w->file || now_us < w->look_us) return HOSTS_SAME;
    w->look_us = now_us + LOOK_US;
    struct hosts_version now = hosts_version(w->file);
    bool settled = same(&now, &w->last);
    w->last = now;
    if (!settled || same(&now, &w->known)) return HOSTS_SAME;
    bool good = hosts_of_file(h, w->file, err);
    struct hosts_version read = hosts_version(w->file);
    if (!same(&read, &now)) { /* it has changed again */
        if (good) hosts_free(h);
        return HOSTS_SAME;
    }
    w->known = now;
    return good ? HOSTS_NEW : HOSTS_BAD;
}

static bool same_text(const char *a, const char *b) { return a && b ? strcmp(a, b) == 0 : a == b; }

bool host_same(const struct host *a, const struct host *b)
{
    bool way = same_text(a->via, b->via) && same_text(a->bin, b->bin) && a->send == b->send;
    bool limits = a->nice == b->nice && a->memory == b->memory;
    return way && limits && same_text(a->name, b->name) && !(a->wait_s < b->wait_s) &&
           !(a->wait_s > b->wait_s);
}
