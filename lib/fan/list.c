/* fan -l: one line per slot. Hosts are known; their speed may have to be measured. */
#include "fan/fan_int.h"

static bool same_host(const struct fan *f, int i, int k)
{
    return i < f->n_slots && f->slots[i].host == f->slots[k].host;
}

/* Starts a worker on the first slots of each host without a stated power, and reads its hello. */
static void measure(struct fan *f)
{
    for (int k = FAN_ASKED; k < f->n_slots; k++)
        f->slots[k].measured |= same_host(f, k - FAN_ASKED, k);
    while (fan_working(f)) {
        fan_round(f);
        up_free(&f->out.queue); /* no reader for records here */
    }
}

/*
 * The slots of a host are on one machine. The best of their self-tests, and the shortest of their
 * round trips, was disturbed least. A slot that was asked and did not answer has neither.
 */
static void level(struct fan *f)
{
    for (int k = 0, end; k < f->n_slots; k = end) {
        double best = 0, least = (double)INFINITY;
        int64_t trip_us = INT64_MAX;
        for (end = k; same_host(f, end, k); end++) {
            const struct fan_slot *s = &f->slots[end];
            best = fmax(best, s->power);
            if (s->least > 0) least = fmin(least, s->least);
            if (s->trip_us) trip_us = s->trip_us < trip_us ? s->trip_us : trip_us;
        }
        for (int i = k; i < end; i++) {
            struct fan_slot *s = &f->slots[i];
            const bool asked = i < k + FAN_ASKED;
            if (!asked || s->power > 0) s->power = best;
            if (s->power > 0 && isfinite(least)) s->least = fmin(least, best);
            if ((!asked || s->trip_us) && trip_us < INT64_MAX) s->trip_us = trip_us;
        }
    }
}

/* A slot's round trip in milliseconds, if it ended when told to; and the least of its power. */
static void print_trip(const struct fan_slot *s)
{
    if (s->trip_us > 0) printf("\t%.3f", (double)s->trip_us / 1e3);
    else printf("\t-");
    if (s->least > 0) printf("\t%.6g", s->least);
    else printf("\t-");
}

/* Returns the number of unknown powers. */
static int print(const struct fan *f)
{
    int unknown = 0;
    for (int k = 0; k < f->n_numbers; k++) {
        const struct fan_slot *s = fan_slot_of(f, k);
        const char *host = s->host->host->name;
        if (s->power > 0) printf("%d\t%s\t%.6g", k, host, s->power);
        else printf("%d\t%s\t-", k, host);
        if (f->o->trips) print_trip(s);
        printf("\n");
        unknown += !(s->power > 0);
    }
    return unknown;
}

int fan_list(const struct fan_options *o)
{
    struct fan f;
    signals_catch();
    fan_open(&f, o, true);
    if (*o->command) measure(&f);
    level(&f);
    int unknown = print(&f);
    fan_close(&f);
    if (signals_came()) signals_die();
    close_stdout();
    return unknown && *o->command ? ST_PARTIAL : ST_OK;
}
