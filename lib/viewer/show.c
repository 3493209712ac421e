/* What is on the screen: the picture, what is behind it, and the status. */
#include "patience/patience.h"
#include "viewer/viewer_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define SAID_US 4000000   /* the status is over the picture */
#define EVERY_US 12000    /* between two refinements on the screen */
#define PARTIAL_US 250000 /* a coarse picture that takes longer is shown before it is whole */

void viewer_say(struct viewer *v, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(v->said, sizeof v->said, fmt, ap);
    va_end(ap);
    v->said_us = now_us();
    v->stale = true;
    show_status(v);
}

void viewer_saved(struct viewer *v, const char *name, bool good)
{
    if (good) {
        viewer_say(v, "saved %s", name);
        return;
    }
    const int why = errno;
    viewer_say(v, "%s: %s", name, strerror(why));
    if (v->window) return;
    warn("%s: %s", name, strerror(why));
    v->status = ST_SYSTEM;
}

void show_status(struct viewer *v)
{
    char title[2 * ERR_BYTES];
    const struct subject *s = &v->subject;
    const double quiet = (double)(now_us() - v->heard_us) * 1e-6;
    const bool waits = !look_whole(&v->look) && quiet > PATIENCE_SILENCE_US * 1e-6;
    if (!v->window) return;
    int n = snprintf(title, sizeof title, "%.100s - stormview", s->job.path[s->at]);
    if (waits) snprintf(title + n, sizeof title - (size_t)n, ": no pixels for %.0f s", quiet);
    else if (*v->said) snprintf(title + n, sizeof title - (size_t)n, ": %.200s", v->said);
    window_title(v->window, title);
}

/* ---- behind and over the picture ------------------------------------------------------------- */

void show_keep(struct viewer *v)
{
    struct buf b = {0};
    char err[ERR_BYTES];
    if (v->subject.scene) return;
    subject_text(&v->subject, &b);
    spec_free(&v->viewed);
    spec_read("view", (const char *)buf_data(&b), buf_size(&b), &v->viewed, err);
    buf_free(&b);
    v->backdated = true;
}

/* The names in the grid's title are in n, and its time in `time`. */
static struct backdrop describe(
    const struct viewer *v, struct backdrop_names *n, char time[BACKDROP_TIME])
{
    struct backdrop b = {.grid = &v->subject.grid,
        .spec = &v->viewed,
        .w = v->viewed.w,
        .h = v->viewed.h,
        .time = time,
        .lines_name = v->o->lines,
        .lines = v->o->lines ? (const char *)buf_data(&v->lines) : NULL};
    backdrop_time(b.grid->title, time);
    backdrop_name(&b, NULL, NULL, n);
    return b;
}

bool show_open(struct viewer *v, char err[ERR_BYTES])
{
    struct backdrop_names names;
    char time[BACKDROP_TIME];
    if (v->o->lines && !load_file(v->o->lines, &v->lines, err)) return false;
    if (memchr(buf_data(&v->lines), '\0', buf_size(&v->lines)))
        return err_set(err, "%.100s: has a byte 0, expected text", v->o->lines);
    buf_append(&v->lines, "", 1);
    v->screen = image_screen_new();
    if (v->subject.scene) return true;
    struct backdrop b = describe(v, &names, time);
    return (v->paint = paint_open(&b, err)) != NULL;
}

static unsigned parts(const struct viewer *v)
{
    return (v->mapped ? PAINT_MAP : 0) | (v->framed ? PAINT_AXES | PAINT_STRIP : 0);
}

uint32_t show_strip(const struct viewer *v, uint32_t w, uint32_t h)
{
    struct backdrop b = {.grid = &v->subject.grid, .spec = &v->subject.spec, .w = w, .h = h};
    return v->framed && !v->subject.scene ? backdrop_strip(&b) : 0;
}

/* Of the view that is shown: what is behind it, and lines at heights. */
static void paint_back(struct viewer *v)
{
    struct backdrop_names names;
    char time[BACKDROP_TIME];
    if (!parts(v) || v->subject.scene) {
        free(v->back);
        free(v->front);
        v->back = v->front = NULL;
        return;
    }
    const struct backdrop b = describe(v, &names, time);
    const size_t n = (size_t)v->w * (v->h + backdrop_strip(&b)); /* also without axes */
    v->back = xrealloc(v->back, n, sizeof *v->back);
    if (!paint_backdrop(v->paint, &b, parts(v), v->back)) memset(v->back, 0, n * sizeof *v->back);
    free(v->front);
    v->front = NULL;
    if (!v->mapped || !paint_has_raised(v->paint)) return;
    v->front = xcalloc(n, sizeof *v->front);
    paint_raised(v->paint, &b, v->front);
}

/* The status for a while after it changed, or the help. True if there is some. */
static bool text_of(const struct viewer *v, struct buf *text)
{
    if (v->helps) buf_append(text, buf_data(&v->help), buf_size(&v->help));
    else if (*v->said && now_us() - v->said_us < SAID_US) buf_printf(text, "%s", v->said);
    const bool some = buf_size(text) > 0;
    buf_append(text, "", 1);
    return some;
}

/* ---- the screen ------------------------------------------------------------------------------ */

/* Of this size. */
static void make_screen(struct viewer *v)
{
    const uint32_t strip = show_strip(v, v->look.w, v->look.h);
    if (v->argb && v->w == v->look.w && v->h == v->look.h && v->strip == strip) return;
    v->w = v->look.w, v->h = v->look.h, v->strip = strip;
    v->argb = xrealloc(v->argb, (size_t)v->w * (v->h + strip), sizeof *v->argb);
    v->stale = v->backdated = true;
}

/* Puts premultiplied pixels over opaque ones. */
static void put_over(const uint32_t *over, uint32_t n, uint32_t *argb)
{
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t clear = 255 - (over[i] >> 24), under = argb[i];
        if (clear == 255) continue;
        argb[i] = 0;
        for (int shift = 0; shift < 32; shift += 8) {
            const uint32_t sum =
                (over[i] >> shift & 255) + ((under >> shift & 255) * clear + 127) / 255;
            argb[i] |= (sum < 255 ? sum : 255) << shift;
        }
    }
}

static void draw_rows(struct viewer *v, uint32_t first, uint32_t end)
{
    for (uint32_t y = first; y < end; y++) {
        const size_t at = (size_t)y * v->w;
        image_screen_row(
            v->screen, v->look.rgba + 4 * at, v->back ? v->back + at : NULL, v->w, v->argb + at);
        if (v->front) put_over(v->front + at, v->w, v->argb + at);
    }
}

/* Text lies over the picture, so all of that is drawn with it, and once more when it goes. */
static void draw(struct viewer *v)
{
    struct buf text = {0};
    const bool over = text_of(v, &text), all = over || v->stale || v->texted;
    uint32_t first = v->look.first, end = v->look.end;
    if (v->backdated) paint_back(v);
    if (all || v->backdated) first = 0, end = v->h;
    draw_rows(v, first, end);
    if (end == v->h && v->strip) {
        const size_t at = (size_t)v->w * v->h;
        memcpy(v->argb + at, v->back + at, (size_t)v->w * v->strip * sizeof *v->argb);
        end += v->strip;
    }
    if (over)
        paint_text(v->argb, v->w, v->h, (const char *)buf_data(&text),
            v->helps ? PAINT_TOP_LEFT : PAINT_BOTTOM_LEFT);
    if (v->window) window_put(v->window, v->argb, v->w, v->h + v->strip, first, end);
    v->texted = over;
    v->stale = v->backdated = false;
    buf_free(&text);
}

/* A new view replaces the old one when it is there coarsely: the screen is never of two views. */
static bool due(const struct viewer *v, int64_t now)
{
    const struct look *l = &v->look;
    const bool left = v->texted && !v->helps && now - v->said_us >= SAID_US;
    if (!l->w) return false;
    if (!look_coarse(l) && now - l->begun_us < PARTIAL_US) return false;
    if (v->stale || left || (v->helps && !v->texted)) return true;
    if (l->first >= l->end) return false;
    return look_whole(l) || v->backdated || now - v->shown_us >= EVERY_US;
}

void show_picture(struct viewer *v)
{
    struct look *l = &v->look;
    if (!due(v, now_us())) return;
    make_screen(v);
    draw(v);
    look_seen(l);
    v->shown_us = now_us();
    if (look_coarse(l)) times_coarse(&v->times, v->shown_us);
    if (look_whole(l)) times_whole(&v->times, v->shown_us);
}

bool show_save(struct viewer *v, const char *path)
{
    const struct image im = {v->look.w, v->look.h, v->look.rgba};
    return image_save(path, &im, IMAGE_PNG, 8, v->job) == 0;
}

bool show_shot(struct viewer *v, const char *path)
{
    struct image im;
    image_init(&im, v->w, v->h + v->strip);
    for (size_t i = 0; i < (size_t)im.w * im.h; i++)
        for (int c = 0; c < 4; c++)
            im.rgba[4 * i + (size_t)c] =
                c == 3 ? 1 : srgb_decode8((uint8_t)(v->argb[i] >> (16 - 8 * c) & 255));
    const bool good = image_save(path, &im, IMAGE_PNG, 8, NULL) == 0;
    image_free(&im);
    return good;
}

void show_free(struct viewer *v)
{
    if (v->screen) image_screen_free(v->screen);
    paint_free(v->paint);
    spec_free(&v->viewed);
    buf_free(&v->lines);
    buf_free(&v->help);
    free(v->argb);
    free(v->back);
    free(v->front);
}
