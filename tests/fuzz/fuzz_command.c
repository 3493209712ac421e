/*
 * Whatever a command sends to stormview: what is kept of it stays within the view, and a stream
 * that is none of a worker ends the run with a status. The first byte of an input says how many
 * bytes come at a time, and the second after how many of these the user turns the view.
 */
#include "mend.h"
#include "viewer/viewer_int.h"

#include <fcntl.h>
#include <unistd.h>

#define SIDE 16

static void check(const struct viewer *v)
{
    const struct look *l = &v->look;
    MUST(v->lost >= 0 && v->lost <= v->slots && v->slots <= WIRE_SLOTS_MAX);
    MUST(l->have.done + l->failed <= (uint64_t)l->w * l->h);
    MUST(l->have.done <= l->counts.px && l->first <= l->h && l->end <= l->h);
    MUST(strlen(v->why) < sizeof v->why && strlen(v->job) < sizeof v->job);
    MUST(!v->status || v->ended);
}

/* The next bytes come. Complaints about each input would fill the log of findings. */
static void hear(struct viewer *v, const uint8_t *data, size_t n, bool last)
{
    static FILE *nothing;
    FILE *log = stderr;
    int ends[2];
    if (!nothing) nothing = fopen("/dev/null", "w");
    MUST(nothing && pipe(ends) == 0 && write(ends[1], data, n) == (ssize_t)n);
    if (last) close(ends[1]);
    struct pollfd p = {v->child.from = ends[0], POLLIN, 0};
    stderr = nothing;
    while (!v->ended && poll(&p, 1, 0) > 0) command_hear(v);
    stderr = log;
    close(ends[0]);
    if (!last) close(ends[1]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct viewer_options none;
    static float rgba[(size_t)4 * WIRE_FRAG_PIXELS_MAX];
    if (size < 2) return 0;
    struct viewer v = {.o = &none, .child = CHILD_NONE, .from = {.upward = true}};
    v.subject.scene = true;
    v.subject.spec.w = v.subject.spec.h = SIDE;
    v.rgba = rgba;
    v.child.to = open("/dev/null", O_WRONLY | O_CLOEXEC | O_NONBLOCK);
    look_init(&v.look);
    command_view(&v);
    const size_t most = 16 * ((size_t)1 + data[0]), turn = (size_t)1 + data[1];
    size_t at = 2;
    for (size_t k = 1; at < size && !v.ended; k++) {
        const size_t n = size - at < most ? size - at : most;
        command_feed(&v);
        hear(&v, data + at, n, at + n == size);
        check(&v);
        at += n;
        if (k % turn == 0) command_view(&v);
    }
    close(v.child.to);
    look_free(&v.look);
    wire_free(&v.from);
    down_free(&v.down);
    return 0;
}
