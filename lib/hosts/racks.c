/*
 * Racks: a tree of hosts. The first host of a rack is its head: it runs a fan for the hosts of its
 * rack, itself among them, by the text of their lines. Seen from here, a rack is one slot. If its
 * head fails, the next host becomes the head.
 */
#include "hosts/hosts_int.h"

#include <stdlib.h>
#include <string.h>

#define TEXT_MOST 32768 /* bytes: it is a word of a command, quoted more than once */

void hosts_put_key(struct buf *b, const char *key, const char *value)
{
    buf_printf(b, " %s=\"", key);
    for (; *value; value++) {
        if (*value == '"' || *value == '\\') buf_append(b, "\\", 1);
        buf_append(b, value, 1);
    }
    buf_append(b, "\"", 1);
}

/* The line of a host, as the head of its rack reads it. */
static void put_line(struct buf *b, const struct host *h, bool head)
{
    buf_printf(b, "%s", head ? ":" : h->name);
    if (!head && buf_size(&h->way)) buf_append(b, buf_data(&h->way), buf_size(&h->way));
    else if (!head && h->via) hosts_put_key(b, "via", h->via);
    if (buf_size(&h->offer)) buf_append(b, buf_data(&h->offer), buf_size(&h->offer));
    else buf_printf(b, " slots=%d", h->slots);
    buf_append(b, "\n", 1);
}

/* Makes member `at` the head of the rack. */
static void lead(struct host *rack, size_t at)
{
    struct buf text = {0};
    const struct host old = *rack;
    for (size_t k = 0; k < old.n_members; k++) put_line(&text, &old.members[k], k == at);
    buf_append(&text, "", 1);
    free(old.rack);
    *rack = old.members[at];
    rack->rack = (char *)text.data;
    rack->members = old.members;
    rack->n_members = old.n_members;
    rack->head = at;
    rack->power = old.power;
    rack->slots = 1;
}

const struct host *host_heir(const struct host *rack)
{
    for (size_t k = 1; k < rack->n_members; k++) {
        const struct host *next = &rack->members[(rack->head + k) % rack->n_members];
        if (!next->unusable) return next;
    }
    return NULL;
}

void host_succeed(struct host *rack, const struct host *heir)
{
    lead(rack, (size_t)(heir - rack->members));
}

/* The rack of these n hosts, which it takes. */
static bool make_rack(struct host *rack, const struct host *at, size_t n, char err[HOSTS_ERR])
{
    struct buf all = {0};
    double power = 0;
    bool stated = true;
    struct host *members = xmalloc(n, sizeof *members);
    memcpy(members, at, n * sizeof *members);
    for (size_t k = 0; k < n; k++) {
        put_line(&all, &members[k], false);
        power += members[k].slots * members[k].power;
        stated = stated && members[k].power > 0;
    }
    const size_t bytes = buf_size(&all);
    buf_free(&all);
    *rack = (struct host){.members = members, .n_members = n, .power = stated ? power : 0};
    lead(rack, 0);
    if (bytes <= TEXT_MOST) return true;
    snprintf(err, HOSTS_ERR,
        "-T: the lines of the rack of %s have %zu bytes, expected at most %d: fewer hosts in it",
        rack->name, bytes, TEXT_MOST);
    return false;
}

/* This machine is no member of another one's rack. */
bool hosts_racks(struct hosts *h, size_t most, char err[HOSTS_ERR])
{
    size_t racks = 0, n;
    bool good = true;
    for (size_t i = 0; i < h->n; i += n) {
        for (n = 1; n < most && i + n < h->n; n++)
            if (host_is_here(&h->at[i]) || host_is_here(&h->at[i + n])) break;
        good = make_rack(&h->at[racks++], &h->at[i], n, err) && good;
    }
    h->n = racks;
    h->slots = (int)racks;
    free(h->file);
    h->file = NULL; /* its lines are not those of the racks */
    return good;
}
