/* Recorded events: a file in the place of a user. */
#include "viewer/viewer_int.h"

#include <stdlib.h>
#include <string.h>

#define NUMBERS_MAX 2
#define MS_MOST 86400e3
#define PIXELS_MOST 65535

static const struct word {
    const char *name, *expected;
    enum recorded_what what;
    enum window_what event;
    int numbers; /* after the word; -1: a name */
} words[] = {
    {"drag", "DX DY", RECORDED_INPUT, WINDOW_DRAG, 2},
    {"move", "DX DY", RECORDED_INPUT, WINDOW_MOVE, 2},
    {"wheel", "NOTCHES", RECORDED_INPUT, WINDOW_WHEEL, 1},
    {"double", "X Y", RECORDED_INPUT, WINDOW_DOUBLE, 2},
    {"size", "W H", RECORDED_INPUT, WINDOW_SIZE, 2},
    {"close", "the line's end", RECORDED_INPUT, WINDOW_CLOSE, 0},
    {"key", "KEY", RECORDED_INPUT, WINDOW_KEY, -1},
    {"png", "FILE", RECORDED_PNG, WINDOW_CLOSE, -1},
    {"shot", "FILE", RECORDED_SHOT, WINDOW_CLOSE, -1},
    {"rest", "the line's end", RECORDED_REST, WINDOW_CLOSE, 0},
};
#define WORDS (sizeof words / sizeof *words)

static bool wrong(const char *path, size_t line, char err[ERR_BYTES], const char *fmt, ...)
    PRINTF_LIKE(4, 5);
static bool wrong(const char *path, size_t line, char err[ERR_BYTES], const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    err_at(err, path, line, fmt, ap);
    va_end(ap);
    return false;
}

static void set_numbers(struct window_event *e, const double v[NUMBERS_MAX])
{
    switch (e->what) {
    case WINDOW_WHEEL: e->dy = v[0]; break;
    case WINDOW_DOUBLE: e->x = v[0], e->y = v[1]; break;
    case WINDOW_SIZE: e->w = (uint32_t)fmax(v[0], 1), e->h = (uint32_t)fmax(v[1], 1); break;
    default: e->dx = v[0], e->dy = v[1];
    }
}

/* What comes after the word: all of `rest` must be used. */
static bool take_rest(struct recorded *r, const struct word *w, char *rest)
{
    double v[NUMBERS_MAX] = {0};
    if (w->numbers < 0) {
        if (!rest || !*rest) return false;
        if (w->what != RECORDED_INPUT) r->name = xstrdup(rest);
        else r->event.key = controls_key(rest);
        return r->name || r->event.key;
    }
    for (int i = 0; i < w->numbers; i++) {
        const char *number = text_part(&rest, ' ');
        if (!number || !parse_real(number, -PIXELS_MOST, PIXELS_MOST, &v[i])) return false;
    }
    set_numbers(&r->event, v);
    return !rest;
}

static bool take_line(
    struct events *e, const char *path, size_t line, char *text, char err[ERR_BYTES])
{
    struct recorded r = {0};
    char shown[ERR_WORD];
    const char *ms = text_part(&text, ' '), *name = text_part(&text, ' ');
    size_t w = 0;
    if (!parse_real(ms, 0, MS_MOST, &r.ms))
        return wrong(path, line, err, "%s, expected a time in milliseconds",
            err_word(shown, ms, strlen(ms)));
    const struct recorded *last = e->n ? &e->at[e->n - 1] : NULL;
    if (last && last->what != RECORDED_REST && r.ms < last->ms)
        return wrong(path, line, err, "%g ms after %g, expected times that ascend", r.ms, last->ms);
    while (w < WORDS && (!name || strcmp(words[w].name, name) != 0)) w++;
    if (w == WORDS)
        return wrong(path, line, err,
            "no event, expected drag, move, wheel, double, size, close, key, png, shot or rest");
    r.what = words[w].what;
    r.event.what = words[w].event;
    if (!take_rest(&r, &words[w], text))
        return wrong(path, line, err, "%s: expected %s", name, words[w].expected);
    e->at = xgrown(e->at, e->n, sizeof *e->at);
    e->at[e->n++] = r;
    return true;
}

bool events_load(struct events *e, const char *path, char err[ERR_BYTES])
{
    struct buf b;
    if (!load_file(path, &b, err)) return false;
    buf_append(&b, "", 1);
    char *text = (char *)b.data;
    bool good = true;
    for (size_t line = 1; good && text; line++) {
        char *one = text_part(&text, '\n');
        if (*one && *one != '#') good = take_line(e, path, line, one, err);
    }
    buf_free(&b);
    return good;
}

void events_free(struct events *e)
{
    for (size_t i = 0; i < e->n; i++) free(e->at[i].name);
    free(e->at);
}
