/* The command that renders: state, frames and tasks go down to it, and fragments come up. */
#include "patience/patience.h"
#include "viewer/viewer_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define READS_MOST 16 /* in a round: then the user's turn comes */
/* For the command, which may be a fan whose launchers need their time. */
#define GRACE_MS ((PATIENCE_LAUNCHER_US + PATIENCE_EXIT_US) / 1000)

bool command_start(struct viewer *v)
{
    char *const *words = v->o->command;
    v->child = CHILD_NONE;
    v->from = (struct decoder){.upward = true};
    v->rgba = xmalloc((size_t)4 * WIRE_FRAG_PIXELS_MAX, sizeof *v->rgba);
    v->heard_us = now_us();
    if (child_start(&v->child, words) == 0) return true;
    warn("%s: %s, expected a file that is there, or a command", words[0], strerror(errno));
    v->status = errno == ENOENT ? ST_USAGE : ST_SYSTEM;
    return false;
}

/* ---- down ------------------------------------------------------------------------------------ */

void command_view(struct viewer *v)
{
    const struct spec *s = &v->subject.spec;
    subject_state(&v->subject, &v->down);
    wire_frame(&v->down.bytes, ++v->frame, s->w, s->h, NULL);
    show_keep(v);
    if (look_whole(&v->look)) v->heard_us = now_us(); /* it was silent, because it owed nothing */
    look_view(&v->look, v->frame, s->w, s->h, now_us());
    times_view(&v->times);
    v->job[0] = '\0';
    v->changed = false;
}

void command_feed(struct viewer *v)
{
    struct task t;
    if (v->child.to < 0) return;
    while (look_next(&v->look, now_us(), &t)) wire_give(&v->down.bytes, &t, NULL);
    if (down_write(&v->down, v->child.to) == 0) return;
    child_close(&v->child.to); /* it reads no more: its output tells why */
    down_free(&v->down);
}

/* ---- up -------------------------------------------------------------------------------------- */

/* The stream is none that this program can read: ends the run. */
static void refuse(struct viewer *v, const char *fmt, ...) PRINTF_LIKE(2, 3);
static void refuse(struct viewer *v, const char *fmt, ...)
{
    char text[ERR_BYTES];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    warn("from the command: %s", text);
    v->ended = true;
    v->status = ST_SYSTEM;
}

static void count_slots(struct viewer *v)
{
    const int32_t up = v->slots - v->lost;
    look_slots(&v->look, v->slots && up < 1 ? 1 : up);
}

static void take_hello(struct viewer *v, const struct record *r)
{
    char why[WIRE_WHY];
    int64_t n = 1;
    if (!rec_ours(r, why)) {
        refuse(v, "its stream %s", why);
        return;
    }
    rec_int(r, "slots", 1, WIRE_SLOTS_MAX, &n);
    v->greeted = true;
    v->slots = (int32_t)n;
    count_slots(v);
}

static void take_gone(struct viewer *v, const struct record *r)
{
    char host[64] = "", why[24] = "";
    if (v->lost < v->slots) v->lost++;
    count_slots(v);
    rec_str(r, "host", host, sizeof host);
    rec_str(r, "why", why, sizeof why);
    const bool far = *host && strcmp(host, ":") != 0;
    viewer_say(v, "lost slot %d%s%s (%s)", rec_slot(r), far ? " at " : "", far ? host : "", why);
}

static void take_up(struct viewer *v)
{
    if (v->lost) v->lost--;
    count_slots(v);
}

static void take_frame(struct viewer *v, const struct record *r)
{
    if (r->task.frame != v->look.frame) return;
    if (r->frame_w != v->look.w || r->frame_h != v->look.h)
        refuse(v, "frame %ux%u, expected %ux%u", r->frame_w, r->frame_h, v->look.w, v->look.h);
    else rec_str(r, "job", v->job, sizeof v->job);
}

static void take_frag(struct viewer *v, const struct record *r)
{
    char job[WIRE_JOB];
    const struct task *t = &r->task;
    const bool now = t->frame == v->look.frame;
    if (now && (!rec_str(r, "job", job, sizeof job) || strcmp(job, v->job) != 0)) {
        refuse(v, "pixels of another job, expected those of `frame`");
        return;
    }
    if (now) rec_pixels(r, v->rgba); /* late ones are only counted */
    if (!look_frag(&v->look, t, v->rgba, now_us()))
        refuse(v, "pixels of frame %" PRIu32 ", expected those of tasks", t->frame);
}

static void take_fail(struct viewer *v, const struct record *r)
{
    char why[24] = "", said[WIRE_SAID];
    rec_str(r, "why", why, sizeof why);
    rec_said(r, said);
    const uint64_t n = look_fail(&v->look, r->task.frame, r->task.id, now_us());
    if (n) viewer_say(v, "%" PRIu64 " pixels were given up (%s) %s", n, why, said);
}

static void take(struct viewer *v, const struct record *r)
{
    int64_t us = -1;
    if (!v->greeted && r->kind != REC_HELLO && r->kind != REC_GONE && r->kind != REC_BYE) {
        refuse(v, "record `%s`, expected `hello` first", rec_name(r->kind));
        return;
    }
    switch (r->kind) {
    case REC_HELLO: take_hello(v, r); break;
    case REC_UP: take_up(v); break;
    case REC_GONE: take_gone(v, r); break;
    case REC_FRAME: take_frame(v, r); break;
    case REC_FRAG: take_frag(v, r); break;
    case REC_FAIL: take_fail(v, r); break;
    case REC_BYE: rec_str(r, "why", v->why, sizeof v->why); break;
    case REC_DONE:
        rec_int(r, "wall_us", 0, INT64_MAX, &us);
        look_done(&v->look, r->task.frame, r->task.id, us);
        break;
    case REC_BEAT:
    case REC_DRAIN: break;
    default: refuse(v, "record `%s`, expected one that workers send", rec_name(r->kind));
    }
}

static void take_all(struct viewer *v)
{
    struct record r;
    enum wire_result result;
    while (!v->ended && (result = wire_next(&v->from, &r)) != WIRE_MORE) {
        if (result == WIRE_RECORD) take(v, &r);
        else if (!v->from.ended) refuse(v, "%s", v->from.why);
    }
}

void command_hear(struct viewer *v)
{
    struct pollfd p = {v->child.from, POLLIN, 0};
    for (int i = 0; i < READS_MOST && !v->ended && poll(&p, 1, 0) > 0; i++) {
        const bool more = stream_read(&v->from, v->child.from) > 0;
        v->heard_us = now_us();
        take_all(v);
        if (!more) v->ended = true;
    }
}

/* ---- the end --------------------------------------------------------------------------------- */

void command_end(struct viewer *v)
{
    char text[24];
    const bool early = v->ended && !v->quit && !signals_came();
    if (v->child.to >= 0 && !v->ended) {
        wire_plain(&v->down.bytes, REC_BYE, NULL);
        down_write(&v->down, v->child.to);
    }
    if (!early) child_stop(&v->child);
    const int ended = child_end(&v->child, GRACE_MS);
    if (early && v->status == ST_OK) {
        const char *how = status_text(ended, text);
        warn("%s ended (%s) before the user did%s", v->o->command[0], *v->why ? v->why : how,
            status_hint(how));
        v->status = ST_SYSTEM;
    }
    down_free(&v->down);
    wire_free(&v->from);
    free(v->rgba);
}
