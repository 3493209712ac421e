/* partition: cuts frames into tasks, optionally preassigned to slots. */
#include "base/base.h"
#include "history/history.h"
#include "log/log.h"
#include "task/task.h"
#include "wire/wire.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define WRITE_BYTES 65536 /* at once */

#define SLOTS_MOST 1000000

struct options {
    struct cut cut; /* -u */
    int slots;      /* -n: preassign round robin; 0: no */
    double *powers; /* -w: preassign by weighted interleave */
    int n_powers;
    bool shares; /* -c: preassign only this share */
    struct cut_share share;
    uint32_t frame;  /* -F: number of the frame */
    const char *log; /* -r: leave out pixels that it has */
    struct intake *have;
    enum { ORDER_NONE, ORDER_COST, ORDER_SAMPLE } order; /* -o */
    const char *cost_log;                                /* -o cost: */
    int w, h;
    const char *pictures; /* source of state and frames; NULL: one frame of this size */
};

/* POWER, or POWER*SLOTS for a number of slots. */
static void parse_powers(struct options *o, const char *list)
{
    char *copy = xstrdup(list), *rest = copy, *word;
    while ((word = text_part(&rest, ',')) != NULL) {
        char *times = strchr(word, '*');
        int64_t slots = 1;
        double power;
        if (times) *times = '\0';
        bool good = !times || parse_int(times + 1, 1, SLOTS_MOST - o->n_powers, &slots);
        if (!good || !parse_real(word, 1e-6, 1e6, &power))
            die(ST_USAGE,
                "-w %s: `%s`, expected powers from 1e-6 to 1e6 with commas between, or POWER*SLOTS",
                list, word);
        o->powers = xrealloc(o->powers, (size_t)(o->n_powers + slots), sizeof *o->powers);
        for (; slots; slots--) o->powers[o->n_powers++] = power;
    }
    free(copy);
}

static void parse_order(struct options *o, const char *order)
{
    static const char cost[] = "cost:";
    if (strncmp(order, cost, sizeof cost - 1) == 0 && order[sizeof cost - 1]) {
        o->order = ORDER_COST;
        o->cost_log = order + sizeof cost - 1;
        return;
    }
    if (strcmp(order, "sample") != 0) die(ST_USAGE, "-o %s: expected sample or cost:LOG", order);
    o->order = ORDER_SAMPLE;
}

/* Chunks are given in order, on demand. They, and runs, depend on the number of slots. */
static void check_slots(const struct options *o)
{
    if (cut_follows_slots(&o->cut) && !o->slots && !o->powers)
        die(ST_USAGE, "-u fine, coarse or tile:WxH:TASKS: expected -n SLOTS or -w POWER,...");
    if (!cut_in_chunks(&o->cut)) return;
    if (o->cut.unit == CUT_GUIDED && !o->slots) die(ST_USAGE, "-u guided: expected -n SLOTS");
    if (!o->slots && !o->powers) die(ST_USAGE, "-u factoring: expected -n SLOTS or -w POWER,...");
    if (o->shares) die(ST_USAGE, "-c: expected another -u than guided and factoring");
    if (o->order) die(ST_USAGE, "-o: expected another -u than guided and factoring");
}

/* A size; `@`: the size of the first picture, and the source of all pictures. */
static void parse_operand(struct options *o, const char *s, bool numbered)
{
    char size[32];
    const char *file = strchr(s, '@');
    size_t n = file ? (size_t)(file - s) : strlen(s);
    snprintf(size, sizeof size, "%.*s", n < sizeof size ? (int)n : 0, s);
    if (!parse_size(size, FRAME_SIDE_MAX, &o->w, &o->h) || (file && !file[1]))
        die(ST_USAGE, "%s: expected a size such as 512x512, sides up to %d, or SIZE@FILE", s,
            FRAME_SIDE_MAX);
    if (file && numbered) die(ST_USAGE, "-F: frames of %s have numbers, expected a size", file + 1);
    if (file) o->pictures = file + 1;
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-h] [-c COUNT[/OF]] [-F FRAME] [-n SLOTS | -w POWER,...]\n"
        "           [-o sample|cost:LOG] [-r LOG] [-u UNIT] WxH[@FILE]\n"
        "UNIT: row, tile:WxH[:TASKS], run:N, scatter, fine[:TASKS], coarse:N, guided[:N],\n"
        "      factoring[:N]";
    bool numbered = false;
    struct options o = {.cut = {.unit = CUT_ROW}};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+c:F:hn:o:r:u:w:")) != -1) {
        switch (opt) {
        case 'c':
            o.shares = cut_share_parse(optarg, &o.share);
            if (!o.shares)
                die(ST_USAGE, "-c %s: expected an integer from 0 to %u, or N/M, N of each M",
                    optarg, UINT32_MAX);
            break;
        case 'F':
            o.frame = (uint32_t)opt_int(opt, optarg, 0, UINT32_MAX);
            numbered = true;
            break;
        case 'h': usage(ST_OK, text);
        case 'n': o.slots = (int)opt_int(opt, optarg, 1, SLOTS_MOST); break;
        case 'o': parse_order(&o, optarg); break;
        case 'r': o.log = opt_text(opt, optarg); break;
        case 'u':
            if (!cut_parse(optarg, &o.cut))
                die(ST_USAGE,
                    "-u %s: expected row, tile:WxH[:TASKS], run:N, scatter, fine[:TASKS], "
                    "coarse:N, guided[:N] or factoring[:N]",
                    optarg);
            break;
        case 'w': parse_powers(&o, optarg); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (argc - optind != 1) usage(ST_USAGE, text);
    parse_operand(&o, argv[optind], numbered);
    if (o.slots && o.powers) die(ST_USAGE, "-n and -w: expected one of them");
    if (o.shares && !o.slots && !o.powers) die(ST_USAGE, "-c: expected -n or -w with it");
    if (o.cut.unit == CUT_SCATTER) {
        if (!o.slots) die(ST_USAGE, "-u scatter: expected -n SLOTS, the number of sets");
        o.cut.w = (uint32_t)o.slots;
    }
    check_slots(&o);
    return o;
}

/* ---- a picture ------------------------------------------------------------------------------- */

/* -r: once for all frames, because a log may be long. */
static void read_log(const struct options *o)
{
    char why[LOG_WHY];
    int odd = log_survey_path(o->log, o->have, why);
    if (odd < 0) die(ST_USAGE, "%s:", o->log);
    if (odd) die(ST_USAGE, "%s: %s", o->log, why);
}

/* Pixels that need no task; none if there is no log, or if it has none of this frame. */
static struct coverage had(const struct options *o)
{
    struct coverage have = {0};
    const struct assembly_frame *f = o->have ? assembly_find(&o->have->parts, o->frame) : NULL;
    if (f) assembly_coverage(f, &have);
    if (have.bits && (have.w != (uint32_t)o->w || have.h != (uint32_t)o->h))
        die(ST_USAGE, "%s: has another size: frame %u of %ux%u pixels, expected %dx%d", o->log,
            o->frame, have.w, have.h, o->w, o->h);
    return have;
}

/* -o cost: the log may be of a picture of another size. */
static void order_by_cost(const struct options *o, struct cut_tasks *tasks)
{
    struct history_costs costs;
    uint32_t w = tasks->frame_w, h = tasks->frame_h;
    char err[HISTORY_ERR];
    if (!history_costs_read(o->cost_log, &costs, err)) die(ST_USAGE, "%s: %s", o->cost_log, err);
    if (!costs.us)
        die(ST_USAGE, "%s: has no costs, expected a log of a picture of the same scene",
            o->cost_log);
    double *cost = xmalloc((size_t)tasks->n + 1, sizeof *cost);
    for (uint32_t id = 0; id < tasks->n; id++) {
        struct task t = cut_task(&tasks->cut, w, h, id);
        cost[id] = history_cost_of(&costs, &t.at, w, h);
    }
    cut_tasks_sort(tasks, cost);
    free(cost);
    history_costs_free(&costs);
}

/* Slots get their shares of the work to be done: with a log, of the rest. job: of the frame, or
 * empty. */
static void write_tasks(const struct options *o, const char *job)
{
    struct buf out = {0};
    struct cut_tasks tasks;
    struct task t;
    struct coverage have = had(o);
    cut_tasks_begin(&tasks, &o->cut, (uint32_t)o->w, (uint32_t)o->h,
        o->powers ? o->n_powers : o->slots, o->powers);
    if (o->shares) tasks.assigned = cut_share_of(&o->share, tasks.n);
    tasks.have = have.bits ? &have : NULL;
    if (o->order == ORDER_COST) order_by_cost(o, &tasks);
    if (o->order == ORDER_SAMPLE) cut_tasks_sample(&tasks);
    wire_frame(&out, o->frame, (uint32_t)o->w, (uint32_t)o->h, job);
    while (cut_tasks_next(&tasks, &t)) {
        t.frame = o->frame;
        wire_task(&out, &t);
        if (buf_size(&out) >= WRITE_BYTES) put_stdout_buf(&out);
    }
    put_stdout_buf(&out);
    cut_tasks_end(&tasks);
    coverage_free(&have);
    buf_free(&out);
}

/* ---- many pictures --------------------------------------------------------------------------- */

/* State is passed on unchanged; each frame is cut. */
static void take(void *ctx, const struct record *r)
{
    struct options one = *(const struct options *)ctx;
    struct buf state = {0};
    char job[64], key[80] = "";
    switch (r->kind) {
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC:
    case REC_VIEW:
    case REC_FILES:
        wire_copy(&state, r);
        put_stdout(buf_data(&state), buf_size(&state));
        buf_free(&state);
        break;
    case REC_FRAME:
        one.frame = r->task.frame;
        one.w = (int)r->frame_w;
        one.h = (int)r->frame_h;
        if (rec_str(r, "job", job, sizeof job)) snprintf(key, sizeof key, "job=%s", job);
        write_tasks(&one, key);
        break;
    default:
        die(ST_USAGE, "%s: record `%s`, expected state and frames", one.pictures,
            rec_name(r->kind));
    }
}

static void write_pictures(struct options *o)
{
    char why[WIRE_WHY];
    bool piped = strcmp(o->pictures, "-") == 0;
    int fd = input_open(o->pictures);
    if (fd < 0) die(ST_USAGE, "%s:", o->pictures);
    int bad = wire_read(fd, take, o, why);
    if (bad < 0) die(ST_SYSTEM, "%s:", o->pictures);
    if (bad) die(ST_USAGE, "%s: %s", o->pictures, why);
    if (!piped) close(fd);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct intake have;
    if (o.log) {
        o.have = &have;
        read_log(&o);
    }
    if (o.pictures) write_pictures(&o);
    else write_tasks(&o, "");
    if (o.have) intake_free(o.have);
    free(o.powers);
    close_stdout();
    return ST_OK;
}
