/* The senders of pixels: slots by name, with their hosts, run by run. */
#include "log/log.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define SOURCES_MAX UINT16_MAX /* the first entry stands for all beyond the limit */
#define PLACES 131072          /* more than twice that many, a power of two */

void log_sources_begin(struct log_sources *s, const char *input)
{
    s->input = input;
    s->run++;
}

/* The place of this run's slot in the hash table, or where it belongs. */
static uint16_t *place_of(struct log_sources *s, const char *slot)
{
    uint64_t at = hash64(s->run, slot, strlen(slot));
    for (;; at++) {
        uint16_t *place = &s->places[at & (PLACES - 1)];
        const struct log_source *known = &s->at[*place];
        if (!*place || (known->run == s->run && strcmp(known->slot, slot) == 0)) return place;
    }
}

static uint16_t add(struct log_sources *s, const char *slot)
{
    s->at = xgrown(s->at, (size_t)s->n, sizeof *s->at);
    s->at[s->n] = (struct log_source){.run = s->run, .input = s->input};
    snprintf(s->at[s->n].slot, LOG_NAME, "%s", slot);
    return (uint16_t)s->n++;
}

uint16_t log_source_of(struct log_sources *s, const struct record *r)
{
    char slot[LOG_NAME];
    if (!rec_str(r, "w", slot, sizeof slot)) *slot = '\0';
    if (!s->places) {
        s->places = xcalloc(PLACES, sizeof *s->places);
        s->at = xcalloc(1, sizeof *s->at);
        s->n = 1;
    }
    uint16_t *place = place_of(s, slot);
    if (!*place && s->n < SOURCES_MAX) *place = add(s, slot);
    if (*place && r->kind == REC_FRAME && !rec_str(r, "host", s->at[*place].host, LOG_NAME))
        *s->at[*place].host = '\0';
    return *place;
}

void log_source_text(const struct log_sources *s, uint16_t source, char out[LOG_SOURCE_TEXT])
{
    const struct log_source *from = s->n ? &s->at[source] : NULL;
    if (!source || !from) {
        snprintf(out, LOG_SOURCE_TEXT, "another slot");
        return;
    }
    const char *host = strcmp(from->host, ":") == 0 ? "localhost" : from->host;
    snprintf(out, LOG_SOURCE_TEXT, "%s%s%s%s (%s)", *from->slot ? "slot " : "a worker", from->slot,
        *host ? " on " : "", host, from->input ? from->input : "standard input");
}

const char *log_dispute_text(
    const struct log_sources *s, const struct assembly_dispute *d, char out[LOG_DISPUTE_TEXT])
{
    char first[LOG_SOURCE_TEXT], second[LOG_SOURCE_TEXT];
    log_source_text(s, d->first, first);
    log_source_text(s, d->second, second);
    snprintf(out, LOG_DISPUTE_TEXT,
        "frame %" PRIu32 ": %" PRIu64 " pixels of %s and of %s differ, most at %" PRIu32 ",%" PRIu32
        ", by %.3g: one of the two is wrong; those of the first were kept",
        d->frame, d->pixels, first, second, d->x, d->y, d->worst);
    return out;
}

void log_sources_free(struct log_sources *s)
{
    free(s->at);
    free(s->places);
    *s = (struct log_sources){0};
}
