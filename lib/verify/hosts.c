/* Places and the names of their hosts. */
#include "verify/verify.h"

#include <stdlib.h>
#include <string.h>

static int32_t add(struct verify_hosts *h, const char *name)
{
    if (h->places == h->cap) {
        h->cap = h->cap ? h->cap * 2 : 16;
        h->host = xrealloc(h->host, (size_t)h->cap, sizeof *h->host);
    }
    h->host[h->places] = xstrdup(name);
    return h->places++;
}

int32_t verify_hosts_place(struct verify_hosts *h, const char *name)
{
    for (int32_t i = 0; i < h->places; i++)
        if (strcmp(h->host[i], name) == 0) return i;
    return add(h, name);
}

void verify_hosts_several(struct verify_hosts *h)
{
    h->several = true;
    for (int32_t k = 0; k < h->places; k++) free(h->host[k]);
    h->places = 0;
    for (int32_t k = 0; k < h->slots; k++) h->place_of[k] = verify_hosts_place(h, h->name[k]);
}

void verify_hosts_init(struct verify_hosts *h, const char *const *name, int32_t slots)
{
    *h = (struct verify_hosts){.slots = slots, .name = name};
    h->place_of = xmalloc((size_t)slots, sizeof *h->place_of);
    verify_hosts_several(h);
    if (h->places > 1) return;
    h->several = false;
    for (int32_t k = 0; k < slots; k++) h->place_of[k] = k ? add(h, name[k]) : 0;
}

void verify_hosts_free(struct verify_hosts *h)
{
    for (int32_t k = 0; k < h->places; k++) free(h->host[k]);
    free(h->host);
    free(h->place_of);
    *h = (struct verify_hosts){0};
}

const char *verify_hosts_name(const struct verify_hosts *h, int32_t place)
{
    return place >= 0 && place < h->places ? h->host[place] : "?";
}
