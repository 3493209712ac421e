/* The progress line: percent done and estimated time left. */
#include "eta/eta.h"

#include <string.h>

#define INTERVAL_US 200000

void progress_start(struct progress *p, bool on) { *p = (struct progress){.on = on}; }

const char *eta_text(double left_s, char out[ETA_TEXT])
{
    int64_t t = left_s < 1e9 ? (int64_t)(left_s + 0.5) : 0;
    if (left_s < 0 || left_s >= 1e9) snprintf(out, ETA_TEXT, "?");
    else if (t < 3600) snprintf(out, ETA_TEXT, "%d:%02d", (int)(t / 60), (int)(t % 60));
    else
        snprintf(out, ETA_TEXT, "%d:%02d:%02d", (int)(t / 3600), (int)(t / 60 % 60), (int)(t % 60));
    return out;
}

bool progress_due(const struct progress *p) { return p->on && now_us() >= p->next_us; }

void progress_show(struct progress *p, uint64_t done, uint64_t total, double left_s)
{
    char eta[ETA_TEXT], text[80];
    if (!progress_due(p) || !total) return;
    p->next_us = now_us() + INTERVAL_US;
    int width = snprintf(text, sizeof text, "%s: %5.1f %%, ETA %s", prog_name(),
        100 * (double)done / (double)total, eta_text(left_s, eta));
    /* Overwrites the rest of a longer previous line with blanks. */
    fprintf(stderr, "\r%s%*s", text, p->width > width ? p->width - width : 0, "");
    fflush(stderr);
    p->width = width > p->width ? width : p->width;
}

void progress_clear(struct progress *p)
{
    if (p->width) fprintf(stderr, "\r%*s\r", p->width, "");
    p->width = 0;
}
