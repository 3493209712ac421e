/*
 * Racks: a tree of hosts. The first host of a rack is its head: it runs a fan for the hosts of its
 * rack, itself among them, by the text of their lines. Seen from here, a rack is one slot.
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

/* The rack of the n hosts from h->at[i] on. The first one becomes the row of all of them. */
static bool make_rack(struct hosts *h, size_t i, size_t n, char err[HOSTS_ERR])
{
    struct host *head = &h->at[i];
    struct buf text = {0};
    double power = 0;
    bool stated = true;
    for (size_t k = i; k < i + n; k++) {
        put_line(&text, &h->at[k], k == i);
        power += h->at[k].slots * h->at[k].power;
        stated = stated && h->at[k].power > 0;
    }
    const size_t bytes = buf_size(&text);
    buf_append(&text, "", 1);
    head->rack = (char *)text.data;
    head->power = stated ? power : 0;
    head->slots = 1;
    for (size_t k = i + 1; k < i + n; k++) host_free(&h->at[k]);
    if (bytes <= TEXT_MOST) return true;
    snprintf(err, HOSTS_ERR,
        "-T: the lines of the rack of %s have %zu bytes, expected at most %d: fewer hosts in it",
        head->name, bytes, TEXT_MOST);
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
        good = make_rack(h, i, n, err) && good;
        h->at[racks++] = h->at[i];
    }
    h->n = racks;
    h->slots = (int)racks;
    free(h->file);
    h->file = NULL; /* its lines are not those of the racks */
    return good;
}
