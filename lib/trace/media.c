/*
 * media: the media that contain a ray, in a list. Rays share lists, and a list that a ray extends
 * or leaves stays as it is. So a ray takes no more memory within many media than within one.
 */
#include "trace/trace_int.h"

#include <stdlib.h>

#define LINKS_MIN 64

void media_free(struct media *m) { free(m->link); }

uint32_t media_add(struct media *m, uint32_t id, uint32_t outer)
{
    uint32_t i = m->unused;
    if (i) {
        m->unused = m->link[i].outer;
    } else if ((i = ++m->n) >= m->cap) {
        if (m->cap > INT32_MAX) die(ST_SYSTEM, "too many media around rays");
        m->cap = m->cap ? 2 * m->cap : LINKS_MIN;
        m->link = xrealloc(m->link, m->cap, sizeof *m->link);
    }
    m->link[i] = (struct medium){id, outer, 1};
    return i;
}

uint32_t media_keep(struct media *m, uint32_t list)
{
    if (list) m->link[list].users++;
    return list;
}

void media_drop(struct media *m, uint32_t list)
{
    while (list && --m->link[list].users == 0) {
        uint32_t outer = m->link[list].outer;
        m->link[list].outer = m->unused;
        m->unused = list;
        list = outer;
    }
}

uint32_t media_cross(struct media *m, uint32_t list, uint32_t id)
{
    uint32_t at = list, last = 0;
    while (at && m->link[at].id != id) at = m->link[at].outer;
    if (!at) return media_add(m, id, media_keep(m, list));
    /* Other rays may share what is inside the medium that is left, so it is copied, behind
     * link[0]. */
    for (uint32_t i = list; i != at; i = m->link[i].outer) {
        uint32_t copy = media_add(m, m->link[i].id, 0);
        m->link[last].outer = copy;
        last = copy;
    }
    m->link[last].outer = media_keep(m, m->link[at].outer);
    return m->link[0].outer;
}
