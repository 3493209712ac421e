/* progress: the progress line: percent done and estimated time left. */
#include "base/base.h"

#include <string.h>

#define INTERVAL_US 200000

void progress_start(struct progress *p, bool on)
{
    *p = (struct progress){.on = on, .start_us = now_us()};
}

void progress_resume(struct progress *p, uint64_t done)
{
    p->before = done;
    p->start_us = now_us();
}

static void put_duration(char *out, size_t size, double s)
{
    int64_t t = (int64_t)(s + 0.5);
    if (t < 3600) snprintf(out, size, "%d:%02d", (int)(t / 60), (int)(t % 60));
    else snprintf(out, size, "%d:%02d:%02d", (int)(t / 3600), (int)(t / 60 % 60), (int)(t % 60));
}

void progress_show(struct progress *p, uint64_t done, uint64_t total)
{
    int64_t now = now_us();
    if (!p->on || !total || now < p->next_us) return;
    p->next_us = now + INTERVAL_US;
    char eta[32] = "?", text[80];
    double elapsed_s = (double)(now - p->start_us) * 1e-6, here = (double)(done - p->before);
    if (done > p->before && elapsed_s < 1e9)
        put_duration(eta, sizeof eta, elapsed_s * (double)(total - done) / here);
    int width = snprintf(text, sizeof text, "%s: %5.1f %%, ETA %s", prog_name(),
        100 * (double)done / (double)total, eta);
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
