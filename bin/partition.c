/* partition: cuts frames into tasks, optionally preassigned to slots. */
#include "base/base.h"
#include "log/log.h"
#include "task/task.h"
#include "wire/wire.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define READ_BYTES 65536

struct options {
    struct cut cut; /* -u */
    int slots;      /* -n: preassign round robin; 0: no */
    double *powers; /* -w: preassign by weighted interleave */
    int n_powers;
    int64_t assigned; /* -c: number of tasks to preassign; -1: all */
    int64_t of;       /* -c: out of this number of tasks; 0: of all */
    uint32_t frame;   /* -F: number of the frame */
    const char *log;  /* -r: leave out pixels that it has */
    enum { ORDER_NONE, ORDER_SHUFFLE, ORDER_COST } order; /* -o */
    int64_t seed;                                         /* -o shuffle: */
    const char *cost_log;                                 /* -o cost: */
    int w, h;
    const char *pictures; /* source of state and frames; NULL: one frame of this size */
    char job[80];         /* "job=HASH", if a frame from there has one */
};

static void parse_powers(struct options *o, const char *list)
{
    char *copy = xstrdup(list), *rest = copy, *word;
    while ((word = strsep(&rest, ",")) != NULL) {
        o->powers = xrealloc(o->powers, (size_t)o->n_powers + 1, sizeof *o->powers);
        if (!parse_real(word, 1e-6, 1e6, &o->powers[o->n_powers]))
            die(ST_USAGE, "-w %s: `%s`, expected powers from 1e-6 to 1e6 with commas between", list,
                word);
        o->n_powers++;
    }
    free(copy);
}

static void parse_order(struct options *o, const char *order)
{
    static const char shuffle[] = "shuffle", cost[] = "cost:";
    if (strncmp(order, cost, sizeof cost - 1) == 0 && order[sizeof cost - 1]) {
        o->order = ORDER_COST;
        o->cost_log = order + sizeof cost - 1;
        return;
    }
    const char *seed = order + sizeof shuffle - 1;
    if (strncmp(order, shuffle, sizeof shuffle - 1) != 0 ||
        (*seed && (*seed != ':' || !parse_int(seed + 1, 0, INT64_MAX, &o->seed))))
        die(ST_USAGE, "-o %s: expected shuffle, shuffle:SEED or cost:LOG", order);
    o->order = ORDER_SHUFFLE;
}

static void parse_assigned(struct options *o, const char *s)
{
    char count[24];
    const char *slash = strchr(s, '/');
    size_t n = slash ? (size_t)(slash - s) : strlen(s);
    bool good = n < sizeof count;
    if (good) {
        memcpy(count, s, n);
        count[n] = '\0';
        good = parse_int(count, 0, UINT32_MAX, &o->assigned);
    }
    if (slash) good = good && parse_int(slash + 1, 1, UINT32_MAX, &o->of) && o->assigned <= o->of;
    if (!good)
        die(ST_USAGE, "-c %s: expected an integer from 0 to %u, or N/M, N of each M", s,
            UINT32_MAX);
}

static bool in_runs(const struct options *o)
{
    return o->cut.unit == CUT_FINE || o->cut.unit == CUT_COARSE;
}

static bool in_chunks(const struct options *o)
{
    return o->cut.unit == CUT_GUIDED || o->cut.unit == CUT_FACTORING;
}

/* Chunks are given in order, on demand. They, and runs, depend on the number of slots. */
static void check_slots(const struct options *o)
{
    if (in_runs(o) && !o->slots && !o->powers)
        die(ST_USAGE, "-u fine or coarse: expected -n SLOTS or -w POWER,...");
    if (!in_chunks(o)) return;
    if (o->cut.unit == CUT_GUIDED && !o->slots) die(ST_USAGE, "-u guided: expected -n SLOTS");
    if (!o->slots && !o->powers) die(ST_USAGE, "-u factoring: expected -n SLOTS or -w POWER,...");
    if (o->assigned >= 0) die(ST_USAGE, "-c: expected another -u than guided and factoring");
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
        "           [-o shuffle[:SEED]|cost:LOG] [-r LOG] [-u UNIT] WxH[@FILE]\n"
        "UNIT: row, tile:WxH, run:N, scatter, fine, coarse:N, guided[:N], factoring[:N]";
    bool numbered = false;
    struct options o = {.cut = {.unit = CUT_ROW}, .assigned = -1};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+c:F:hn:o:r:u:w:")) != -1) {
        switch (opt) {
        case 'c': parse_assigned(&o, optarg); break;
        case 'F':
            o.frame = (uint32_t)opt_int(opt, optarg, 0, UINT32_MAX);
            numbered = true;
            break;
        case 'h': usage(ST_OK, text);
        case 'n': o.slots = (int)opt_int(opt, optarg, 1, 1000000); break;
        case 'o': parse_order(&o, optarg); break;
        case 'r': o.log = opt_text(opt, optarg); break;
        case 'u':
            if (!cut_parse(optarg, &o.cut))
                die(ST_USAGE,
                    "-u %s: expected row, tile:WxH, run:N, scatter, fine, coarse:N, guided, "
                    "guided:N, factoring or factoring:N",
                    optarg);
            break;
        case 'w': parse_powers(&o, optarg); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (argc - optind != 1) usage(ST_USAGE, text);
    parse_operand(&o, argv[optind], numbered);
    if (o.slots && o.powers) die(ST_USAGE, "-n and -w: expected one of them");
    if (o.assigned >= 0 && !o.slots && !o.powers) die(ST_USAGE, "-c: expected -n or -w with it");
    if (o.cut.unit == CUT_SCATTER) {
        if (!o.slots) die(ST_USAGE, "-u scatter: expected -n SLOTS, the number of sets");
        o.cut.w = (uint32_t)o.slots;
    }
    check_slots(&o);
    return o;
}

/*
 * Weighted interleave (the hybrid's first phase): slots with credit >= 1 get a task each, in order,
 * and pay 1. When no slot has that, every credit grows by its slot's relative power. 1,2,1 gives 0
 * 1 2 1.
 */
struct interleave {
    const double *power;
    double *credit;
    int n, at; /* at: the next slot of this round */
};

static int interleave_next(struct interleave *v)
{
    for (;;) {
        for (; v->at < v->n; v->at++) {
            /* Slightly less than 1 is enough: powers such as .1 are not exact, and ten of them
             * should be 1. */
            if (v->credit[v->at] < 1 - 1e-9) continue;
            v->credit[v->at] -= 1;
            return v->at++;
        }
        v->at = 0;
        /* The number of rounds until a slot has enough credit; small powers need many. */
        double rounds = HUGE_VAL;
        for (int k = 0; k < v->n; k++)
            rounds = fmin(rounds, ceil((1 - 1e-9 - v->credit[k]) / v->power[k]));
        for (int k = 0; rounds > 0 && k < v->n; k++) v->credit[k] += rounds * v->power[k];
    }
}

/* -r: pixels that need no task; none if the log has none of this frame. */
static struct coverage read_log(const struct options *o)
{
    struct coverage have = {0};
    if (!o->log) return have;
    char why[LOG_WHY];
    int odd = log_coverage(o->log, o->frame, &have, why);
    if (odd < 0) die(ST_USAGE, "%s:", o->log);
    if (odd) die(ST_USAGE, "%s: %s", o->log, why);
    if (have.bits && (have.w != (uint32_t)o->w || have.h != (uint32_t)o->h))
        die(ST_USAGE, "%s: has another size: frame %u of %ux%u pixels, expected %dx%d", o->log,
            o->frame, have.w, have.h, o->w, o->h);
    return have;
}

/* ---- the order ------------------------------------------------------------------------------- */

struct place {
    double cost;
    uint32_t id;
};

static int dearest_first(const void *a, const void *b)
{
    const struct place *p = a, *q = b;
    if (p->cost != q->cost) return p->cost > q->cost ? -1 : 1;
    return p->id < q->id ? -1 : 1;
}

/* Longest processing time first (R. L. Graham, "Bounds on multiprocessing timing anomalies", SIAM
 * J. Appl. Math. 17, 1969). */
static void order_by_cost(const struct options *o, struct place *at, uint32_t n)
{
    struct log_costs costs;
    uint32_t w = (uint32_t)o->w, h = (uint32_t)o->h;
    char why[LOG_WHY];
    if (log_costs_read(o->cost_log, &costs, why) != 0) die(ST_USAGE, "%s: %s", o->cost_log, why);
    if (!costs.us)
        die(ST_USAGE, "%s: has no costs, expected a log of a picture of the same scene",
            o->cost_log);
    for (uint32_t i = 0; i < n; i++) {
        struct task t = cut_task(&o->cut, w, h, i);
        for (uint64_t k = 0, pixels = lattice_count(&t.at); k < pixels; k++)
            at[i].cost += log_cost_at(&costs, lattice_pixel(&t.at, w, k), w, h);
    }
    qsort(at, n, sizeof *at, dearest_first);
    log_costs_free(&costs);
}

/* R. Durstenfeld, "Algorithm 235: random permutation", Comm. ACM 7(7), 1964. */
static void shuffle(const struct options *o, struct place *at, uint32_t n)
{
    for (uint32_t i = n; i > 1; i--) {
        uint32_t k = (uint32_t)(rng_unit((uint64_t)o->seed, i) * i);
        struct place kept = at[i - 1];
        at[i - 1] = at[k];
        at[k] = kept;
    }
}

/* The ids in the order of writing; NULL if that is ascending. */
static struct place *order_of(const struct options *o, uint32_t n)
{
    if (!o->order) return NULL;
    struct place *at = xmalloc(n, sizeof *at);
    for (uint32_t i = 0; i < n; i++) at[i] = (struct place){0, i};
    if (o->order == ORDER_COST) order_by_cost(o, at, n);
    else shuffle(o, at, n);
    return at;
}

/* ---- the tasks ------------------------------------------------------------------------------- */

/* The slot of the n-th task to be done, or -1. The task is number `place` of those written. */
static int32_t slot_for(const struct options *o, struct interleave *v, uint32_t place, uint32_t n)
{
    if (in_chunks(o)) return o->powers && place < (uint32_t)o->n_powers ? (int32_t)place : -1;
    if (o->powers) return interleave_next(v);
    return o->slots ? (int32_t)(n % (uint32_t)o->slots) : -1;
}

/* Slots get their shares of the work to be done: with a log, of the rest. Uses up o->cut. */
static void write_tasks(struct options *o)
{
    uint32_t w = (uint32_t)o->w, h = (uint32_t)o->h;
    int slots = o->powers ? o->n_powers : o->slots;
    if (in_runs(o)) cut_runs(&o->cut, w, h, slots);
    if (in_chunks(o)) cut_chunks(&o->cut, w, h, o->powers, slots);
    struct buf out = {0};
    struct coverage have = read_log(o);
    struct interleave v = {
        o->powers, xcalloc((size_t)o->n_powers + 1, sizeof(double)), o->n_powers, 0};
    uint32_t count = cut_count(&o->cut, w, h);
    uint32_t left = 0; /* tasks so far, except those left out */
    int64_t assigned = o->assigned;
    if (o->of) assigned = (int64_t)((uint64_t)count * (uint64_t)assigned / (uint64_t)o->of);
    wire_frame(&out, o->frame, w, h, o->job);
    struct place *order = order_of(o, count);
    for (uint32_t i = 0; i < count; i++) {
        struct task t = cut_task(&o->cut, w, h, order ? order[i].id : i);
        t.frame = o->frame;
        if (have.bits && !coverage_trim(&have, &t.at)) continue;
        bool anybodys = assigned >= 0 && i >= assigned;
        t.to = anybodys ? -1 : slot_for(o, &v, i, left++);
        wire_task(&out, &t);
        if (buf_size(&out) < 1 << 16) continue;
        put_stdout(buf_data(&out), buf_size(&out));
        buf_consume(&out, buf_size(&out));
    }
    put_stdout(buf_data(&out), buf_size(&out));
    free(v.credit);
    free(order);
    coverage_free(&have);
    buf_free(&out);
    cut_free(&o->cut);
}

/* ---- many pictures --------------------------------------------------------------------------- */

static void take(const struct options *o, const struct record *r)
{
    struct options one = *o;
    char job[64];
    switch (r->kind) {
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC:
        put_stdout(r->line, r->line_len);
        put_stdout("\n", 1);
        put_stdout(r->body, r->body_len);
        break;
    case REC_FRAME:
        one.frame = r->task.frame;
        one.w = (int)r->frame_w;
        one.h = (int)r->frame_h;
        if (rec_str(r, "job", job, sizeof job)) snprintf(one.job, sizeof one.job, "job=%s", job);
        write_tasks(&one);
        break;
    default:
        die(ST_USAGE, "%s: record `%s`, expected state and frames", o->pictures, rec_name(r->kind));
    }
}

/* State is passed on unchanged; each frame is cut. */
static void write_pictures(const struct options *o)
{
    struct decoder in = {0};
    struct record r;
    enum wire_result result;
    ptrdiff_t n = 1;
    bool piped = strcmp(o->pictures, "-") == 0;
    int fd = piped ? STDIN_FILENO : open(o->pictures, O_RDONLY | O_CLOEXEC);
    if (fd < 0) die(ST_USAGE, "%s:", o->pictures);
    while (n > 0) {
        n = read_some(fd, &in.in, READ_BYTES);
        if (n < 0) die(ST_SYSTEM, "%s:", o->pictures);
        if (!n) wire_end(&in);
        while ((result = wire_next(&in, &r)) == WIRE_RECORD) take(o, &r);
        if (result == WIRE_BAD) die(ST_USAGE, "%s: %s", o->pictures, in.why);
    }
    if (!piped) close(fd);
    wire_free(&in);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (o.pictures) write_pictures(&o);
    else write_tasks(&o);
    free(o.powers);
    close_stdout();
    return ST_OK;
}
