/* What is on the screen: the picture, what is behind it, and the status. */
#include "patience/patience.h"
#include "viewer/viewer_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>

#define EVERY_US 12000    /* between two refinements on the screen */
#define PARTIAL_US 250000 /* a coarse picture that takes longer is shown before it is whole */

void viewer_say(struct viewer *v, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(v->said, sizeof v->said, fmt, ap);
    va_end(ap);
    show_status(v);
}

void show_status(struct viewer *v)
{
    char title[2 * ERR_BYTES];
    const struct subject *s = &v->subject;
    const double quiet = (double)(now_us() - v->heard_us) * 1e-6;
    const bool waits = v->look.flight.count && quiet > PATIENCE_SILENCE_US * 1e-6;
    if (!v->window) return;
    int n = snprintf(title, sizeof title, "%.100s - stormview", s->job.path[s->at]);
    if (waits) snprintf(title + n, sizeof title - (size_t)n, ": no pixels for %.0f s", quiet);
    else if (*v->said) snprintf(title + n, sizeof title - (size_t)n, ": %.200s", v->said);
    window_title(v->window, title);
}

/* Of this size. */
static void make_screen(struct viewer *v)
{
    if (!v->screen) v->screen = image_screen_new();
    if (v->argb && v->w == v->look.w && v->h == v->look.h) return;
    free(v->argb);
    v->w = v->look.w, v->h = v->look.h;
    v->argb = xcalloc((size_t)v->w * v->h, sizeof *v->argb);
}

static void draw(struct viewer *v, uint32_t first, uint32_t end)
{
    for (uint32_t y = first; y < end; y++)
        image_screen_row(
            v->screen, v->look.rgba + (size_t)4 * y * v->w, NULL, v->w, v->argb + (size_t)y * v->w);
    if (v->window) window_put(v->window, v->argb, v->w, v->h, first, end);
}

/* A new view replaces the old one when it is there coarsely: the screen is never of two views. */
static bool due(const struct viewer *v, int64_t now)
{
    const struct look *l = &v->look;
    if (!l->w) return false;
    if (!look_coarse(l) && now - l->begun_us < PARTIAL_US) return false;
    if (v->stale) return true;
    if (l->first >= l->end) return false;
    return look_whole(l) || l->first == 0 || now - v->shown_us >= EVERY_US;
}

void show_picture(struct viewer *v)
{
    const int64_t now = now_us();
    struct look *l = &v->look;
    if (!due(v, now)) return;
    make_screen(v);
    draw(v, v->stale ? 0 : l->first, v->stale ? l->h : l->end);
    look_seen(l);
    v->stale = false;
    v->shown_us = now_us();
    if (look_coarse(l)) times_coarse(&v->times, v->shown_us);
    if (look_whole(l)) times_whole(&v->times, v->shown_us);
}

bool show_save(struct viewer *v, const char *path)
{
    const struct image im = {v->look.w, v->look.h, v->look.rgba};
    return image_save(path, &im, IMAGE_PNG, 8, v->job) == 0;
}

void show_free(struct viewer *v)
{
    if (v->screen) image_screen_free(v->screen);
    free(v->argb);
}
