/* partition: cuts a frame into tasks, optionally preassigned to slots. */
#include "base/base.h"
#include "log/log.h"
#include "task/task.h"
#include "wire/wire.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct options {
    struct cut cut; /* -u */
    int slots;      /* -n: preassign round robin; 0: not */
    double *powers; /* -w: preassign by weighted interleave */
    int n_powers;
    int64_t assigned; /* -c: only the first so many tasks are preassigned; -1: all */
    uint32_t frame;   /* -F: the frame's number */
    const char *log;  /* -r: leave out what it holds */
    int w, h;
};

static void parse_powers(struct options *o, const char *list)
{
    char *copy = xstrdup(list), *rest = copy, *word;
    while ((word = strsep(&rest, ",")) != NULL) {
        o->powers = xrealloc(o->powers, (size_t)o->n_powers + 1, sizeof *o->powers);
        if (!parse_real(word, 1e-3, 1e3, &o->powers[o->n_powers]))
            die(ST_USAGE, "-w %s: `%s`, expected powers from .001 to 1000 with commas between",
                list, word);
        o->n_powers++;
    }
    free(copy);
}

static struct options parse(int argc, char **argv)
{
    static const char text[] = "[-h] [-c COUNT] [-F FRAME] [-n SLOTS | -w POWER,...] [-r LOG] "
                               "[-u row|tile:WxH|run:N|scatter] WxH";
    struct options o = {.cut = {CUT_ROW, 0, 1}, .assigned = -1};
    int opt;
    while ((opt = getopt(argc, argv, "+c:F:hn:r:u:w:")) != -1) {
        switch (opt) {
        case 'c': o.assigned = opt_int(opt, optarg, 0, UINT32_MAX); break;
        case 'F': o.frame = (uint32_t)opt_int(opt, optarg, 0, UINT32_MAX); break;
        case 'h': usage(ST_OK, text);
        case 'n': o.slots = (int)opt_int(opt, optarg, 1, 1000000); break;
        case 'r': o.log = optarg; break;
        case 'u':
            if (!cut_parse(optarg, &o.cut))
                die(ST_USAGE, "-u %s: expected row, tile:WxH, run:N or scatter", optarg);
            break;
        case 'w': parse_powers(&o, optarg); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (argc - optind != 1) usage(ST_USAGE, text);
    if (!parse_size(argv[optind], FRAME_SIDE_MAX, &o.w, &o.h))
        die(ST_USAGE, "%s: expected a size such as 512x512, sides up to %d", argv[optind],
            FRAME_SIDE_MAX);
    if (o.slots && o.powers) die(ST_USAGE, "-n and -w: expected one of them");
    if (o.assigned >= 0 && !o.slots && !o.powers) die(ST_USAGE, "-c: expected -n or -w with it");
    if (o.cut.unit == CUT_SCATTER) {
        if (!o.slots) die(ST_USAGE, "-u scatter: expected -n SLOTS, the number of sets");
        o.cut.w = (uint32_t)o.slots;
    }
    return o;
}

/*
 * Weighted interleave (the hybrid's first phase): slots with credit >= 1 get a task each, in order,
 * and pay 1; only when none has, every credit grows by its slot's relative power. 1,2,1 gives 0 1
 * 2 1.
 */
struct interleave {
    const double *power;
    double *credit;
    int n, at; /* at: the next slot to look at in this round */
};

static int interleave_next(struct interleave *v)
{
    for (;;) {
        for (; v->at < v->n; v->at++) {
            /* A hair below 1 counts: powers such as .1 are not exact, and ten of them shall be
             * 1. */
            if (v->credit[v->at] < 1 - 1e-9) continue;
            v->credit[v->at] -= 1;
            return v->at++;
        }
        v->at = 0;
        bool any = false;
        for (int k = 0; k < v->n; k++) any = any || v->credit[k] >= 1 - 1e-9;
        for (int k = 0; !any && k < v->n; k++) v->credit[k] += v->power[k];
    }
}

/* -r: the pixels that need no task; none where the log has nothing of this frame. */
static struct coverage read_log(const struct options *o)
{
    struct coverage have = {0};
    if (!o->log) return have;
    if (log_coverage(o->log, o->frame, &have) != 0) die(ST_USAGE, "%s:", o->log);
    if (have.bits && (have.w != (uint32_t)o->w || have.h != (uint32_t)o->h))
        die(ST_USAGE, "%s: has another size: frame %u of %ux%u pixels, expected %dx%d", o->log,
            o->frame, have.w, have.h, o->w, o->h);
    return have;
}

/* Slots get their shares of what is to be done: with a log, of what is left. */
static void write_tasks(const struct options *o)
{
    struct buf out = {0};
    struct coverage have = read_log(o);
    struct interleave v = {
        o->powers, xcalloc((size_t)o->n_powers + 1, sizeof(double)), o->n_powers, 0};
    uint32_t w = (uint32_t)o->w, h = (uint32_t)o->h, count = cut_count(&o->cut, w, h);
    uint32_t left = 0; /* tasks so far, those left out not counted */
    wire_frame(&out, o->frame, w, h, NULL);
    for (uint32_t id = 0; id < count; id++) {
        struct task t = cut_task(&o->cut, w, h, id);
        t.frame = o->frame;
        bool assign = o->assigned < 0 || id < o->assigned;
        if (have.bits && !coverage_trim(&have, &t.at)) continue;
        if (assign && o->powers) t.to = interleave_next(&v);
        else if (assign && o->slots) t.to = (int32_t)(left % (uint32_t)o->slots);
        left++;
        wire_task(&out, &t);
        if (buf_size(&out) < 1 << 16) continue;
        put_stdout(buf_data(&out), buf_size(&out));
        buf_consume(&out, buf_size(&out));
    }
    put_stdout(buf_data(&out), buf_size(&out));
    free(v.credit);
    coverage_free(&have);
    buf_free(&out);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    write_tasks(&o);
    free(o.powers);
    close_stdout();
    return ST_OK;
}
