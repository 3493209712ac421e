/* The loop: the user, the command and the screen take turns. Nothing blocks but poll. */
#include "viewer/viewer_int.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ROUND_MS 4    /* between two looks for events, which come by no descriptor, */
#define RESTING_MS 15 /* and when nothing has happened for */
#define RESTING_US 2000000
#define STATUS_US 500000
#define DOWN_MOST 65536 /* bytes that wait for the pipe: then a view waits as well */

/* ---- inputs ---------------------------------------------------------------------------------- */

static bool is_input(const char *word)
{
    unsigned char first[JOB_FIRST];
    uint64_t size;
    struct stat st;
    if (stat(word, &st) != 0 || !S_ISREG(st.st_mode)) return false;
    const size_t n = job_first(word, first, &size);
    return !(n >= 4 && memcmp(first, "\177ELF", 4) == 0) &&
           !(n >= 2 && memcmp(first, "#!", 2) == 0);
}

size_t viewer_inputs(char *const *words)
{
    size_t n = 0;
    while (words[n] && is_input(words[n])) n++;
    return n;
}

/* ---- events ---------------------------------------------------------------------------------- */

static void take_event(struct viewer *v, const struct window_event *e, int64_t at_us)
{
    const bool before = v->changed;
    v->changed = false;
    controls_take(v, e);
    if (v->changed) times_input(&v->times, at_us);
    v->changed = v->changed || before;
}

static void take_window(struct viewer *v)
{
    struct window_event e;
    while (!v->quit && window_next(v->window, &e)) take_event(v, &e, now_us());
}

static bool resting(const struct viewer *v)
{
    const bool drawn = !v->stale && v->look.first >= v->look.end;
    return look_whole(&v->look) && drawn && !v->changed && !v->png;
}

/* A picture that lacks pixels would pass for a whole one. */
static void save_png(struct viewer *v, const char *name)
{
    if (!v->look.failed) viewer_saved(v, name, show_save(v, name));
    else viewer_say(v, "%s: not saved: pixels were given up", name);
}

/* Takes the recorded events that are due. */
static void take_recorded(struct viewer *v)
{
    struct events *e = &v->events;
    while (!v->quit && e->next < e->n) {
        const struct recorded *r = &e->at[e->next];
        const int64_t due = e->from_us + (int64_t)(r->ms * 1e3);
        if (now_us() < due || (r->what != RECORDED_INPUT && !resting(v))) return;
        if (r->what == RECORDED_INPUT) take_event(v, &r->event, due);
        else if (r->what == RECORDED_PNG) save_png(v, r->name);
        else if (r->what == RECORDED_SHOT) viewer_saved(v, r->name, show_shot(v, r->name));
        else e->from_us = now_us();
        e->next++;
    }
    if (e->next == e->n && resting(v)) v->quit = true;
}

static void take_events(struct viewer *v)
{
    if (v->window) take_window(v);
    else take_recorded(v);
}

/* ---- rounds ---------------------------------------------------------------------------------- */

static int wait_ms(const struct viewer *v)
{
    const int64_t now = now_us();
    if (v->window) return now - v->shown_us < RESTING_US ? ROUND_MS : RESTING_MS;
    if (v->events.next == v->events.n) return ROUND_MS;
    const double left = v->events.at[v->events.next].ms - (double)(now - v->events.from_us) / 1e3;
    return left <= 0 || left > ROUND_MS ? ROUND_MS : (int)left + 1;
}

static void ask(struct viewer *v)
{
    const struct spec *s = &v->subject.spec;
    const bool resized = s->w != v->look.w || s->h != v->look.h;
    if (!v->changed || down_size(&v->down) > DOWN_MOST) return;
    if (resized || look_ready(&v->look, now_us())) command_view(v);
}

static void poll_round(struct viewer *v)
{
    struct pollfd p[] = {
        pipe_poll_entry(v->child.to, true, down_size(&v->down) ? POLLOUT : 0),
        pipe_poll_entry(v->child.from, true, POLLIN),
    };
    if (signals_poll(p, 2, wait_ms(v)) < 0 && errno != EINTR) die(ST_SYSTEM, "poll:");
    command_hear(v);
}

static void round_of(struct viewer *v)
{
    take_events(v);
    ask(v);
    command_feed(v);
    poll_round(v);
    show_picture(v);
    if (v->png && look_whole(&v->look) && !v->changed) {
        char *name = v->png;
        v->png = NULL;
        save_png(v, name);
        free(name);
    }
}

static void loop(struct viewer *v)
{
    int64_t status_us = 0;
    v->changed = true;
    v->events.from_us = now_us();
    while (!v->quit && !v->ended && !signals_came()) {
        round_of(v);
        if (now_us() - status_us < STATUS_US) continue;
        status_us = now_us();
        show_status(v);
    }
}

/* ---- beginning and end ----------------------------------------------------------------------- */

static bool open_window(struct viewer *v)
{
    char err[ERR_BYTES];
    const struct spec *s = &v->subject.spec;
    if (v->o->events) return true;
    v->window = window_open("stormview", s->w, s->h + show_strip(v, s->w, s->h), err);
    if (v->window) return true;
    warn("cannot open a display; use balance (%s)", err);
    v->status = ST_SYSTEM;
    return false;
}

static const struct subject *shown; /* not printed yet */

static void print_shown(void)
{
    struct buf b = {0};
    subject_text(shown, &b);
    shown = NULL;
    put_stdout_buf(&b);
    buf_free(&b);
}

/* Xlib ends a program whose display is lost by exit(1). */
static void print_lost(void)
{
    if (!shown) return;
    print_shown();
    fflush(stdout);
    _exit(ST_SYSTEM);
}

static void finish(struct viewer *v)
{
    print_shown();
    if (v->o->times) {
        struct buf b = {0};
        times_write(&v->times, &v->look.counts, &b);
        if (outfile_put(v->o->times, buf_data(&b), buf_size(&b)) != 0)
            die(ST_SYSTEM, "%s:", v->o->times);
        buf_free(&b);
    }
    if (v->status == ST_OK && v->look.failed) v->status = ST_PARTIAL;
}

int viewer_run(const struct viewer_options *o)
{
    struct viewer v = {.o = o, .palette = -1};
    char err[ERR_BYTES];
    if (o->events && !events_load(&v.events, o->events, err)) die(ST_USAGE, "%s", err);
    if (!subject_open(&v.subject, o, err) || !show_open(&v, err)) die(ST_USAGE, "%s", err);
    if (o->lines) controls_take(&v, &(struct window_event){.what = WINDOW_KEY, .key = 'm'});
    if (o->lines) controls_take(&v, &(struct window_event){.what = WINDOW_KEY, .key = 'a'});
    viewer_controls(&v.help);
    signals_catch();
    look_init(&v.look);
    if (open_window(&v) && command_start(&v)) {
        shown = &v.subject;
        atexit(print_lost);
        loop(&v);
        command_end(&v);
        finish(&v);
    }
    window_close(v.window);
    show_free(&v);
    look_free(&v.look);
    times_free(&v.times);
    events_free(&v.events);
    subject_free(&v.subject);
    free(v.png);
    fflush(stdout);
    if (signals_came()) signals_die();
    return v.status;
}
