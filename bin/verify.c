/*
 * verify: which pieces of a log are computed a second time, on another host, and what came of it.
 *
 * The pieces are chosen when the pixels are there, by a number that was drawn after them: no worker
 * can know, while it computes a piece, that the piece will be checked. What two hosts made of a
 * piece is compared by sums over all its bits under two secret keys, linear in the words (J. L.
 * Carter, M. N. Wegman, "Universal classes of hash functions", JCSS 18, 1979): pieces of pieces add
 * up, in any order.
 */
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/base.h"
#include "log/log.h"
#include "proc/proc.h"
#include "wire/wire.h"

#define OPINIONS 8 /* of a piece: the log's, and one of each slot that has computed it again */
#define ENOUGH 3   /* hosts: two that agree tell which is wrong */
#define READ_BYTES 65536
#define LINES_MOST 16 /* of the report */

struct opinion {
    int32_t slot;
    int32_t place;   /* its host; of one host alone its slot; -1: of an earlier run, not known */
    uint64_t pixels; /* so far */
    uint64_t sum[2];
};
struct piece {
    struct task task;
    uint32_t run; /* of those in the log */
    uint32_t n;
    struct opinion by[OPINIONS];
};
struct size {
    uint32_t frame, w, h;
    bool written;
    char job[80]; /* "job=HASH" */
};

struct verify {
    double fraction;
    uint64_t seed; /* -s */
    bool report;   /* -r */
    struct hosts hosts;
    int *host_of; /* by slot */
    struct piece *piece;
    uint32_t n, runs;
    uint64_t seen; /* fragments in the log */
    struct size *size;
    uint32_t n_sizes;
    bool again;      /* a file of second opinions is read */
    uint32_t rounds; /* of these */
    float *pixels;
};

/* ---- reading --------------------------------------------------------------------------------- */

static struct size *size_of(struct verify *v, uint32_t frame)
{
    for (uint32_t i = v->n_sizes; i-- > 0;)
        if (v->size[i].frame == frame) return &v->size[i];
    return NULL;
}

static void take_frame(struct verify *v, const struct record *r)
{
    if (v->again || size_of(v, r->task.frame)) return;
    v->size = xrealloc(v->size, (size_t)v->n_sizes + 1, sizeof *v->size);
    struct size *s = &v->size[v->n_sizes++];
    *s = (struct size){.frame = r->task.frame, .w = r->frame_w, .h = r->frame_h};
    char job[64];
    if (rec_str(r, "job", job, sizeof job)) snprintf(s->job, sizeof s->job, "job=%s", job);
}

static void add_up(struct verify *v, struct opinion *o, const struct record *r, uint32_t frame_w)
{
    const struct lattice *at = &r->task.at;
    uint64_t count = lattice_count(at);
    rec_pixels(r, v->pixels);
    for (uint64_t k = 0; k < count; k++) {
        uint32_t word[4];
        uint64_t p = lattice_pixel(at, frame_w, k);
        memcpy(word, v->pixels + 4 * k, sizeof word);
        for (uint64_t c = 0; c < 4; c++)
            for (uint64_t key = 0; key < 2; key++)
                o->sum[key] += rng_u64(v->seed + 1 + key, 4 * p + c) * word[c];
    }
    o->pixels += count;
}

/* The slot's opinion of the piece, new or begun; NULL where there is no room. */
static struct opinion *opinion_of(struct verify *v, struct piece *p, int32_t slot)
{
    uint32_t i = v->again ? 1 : 0;
    while (i < p->n && p->by[i].slot != slot) i++;
    if (i == OPINIONS) return NULL;
    if (i == p->n) {
        int place = slot < 0 || slot >= v->hosts.slots ? -1 : v->host_of[slot];
        p->by[p->n++] = (struct opinion){.slot = slot, .place = place};
    }
    return &p->by[i];
}

static void take_frag(struct verify *v, const struct record *r)
{
    char name[32];
    const struct size *s = size_of(v, r->task.frame);
    struct piece *p = NULL;
    int64_t slot = -1;
    if (!s || !lattice_valid(&r->task.at, s->w, s->h)) return;
    if (rec_str(r, "w", name, sizeof name)) {
        name[strcspn(name, ".")] = '\0'; /* of the outermost fan */
        (void)parse_int(name, 0, HOSTS_SLOTS_MAX - 1, &slot);
    }
    if (v->again) {
        if (r->task.id < v->n) p = &v->piece[r->task.id];
        if (!p || p->task.frame != r->task.frame) return;
        if (lattice_offset(&p->task.at, s->w, &r->task.at) < 0) return;
    } else {
        if (rng_unit(v->seed, v->seen++) >= v->fraction) return;
        if ((v->n & (v->n - 1)) == 0)
            v->piece = xrealloc(v->piece, v->n ? (size_t)v->n * 2 : 1, sizeof *p);
        p = &v->piece[v->n];
        *p = (struct piece){.task = r->task, .run = v->runs};
        p->task.id = v->n++;
    }
    struct opinion *o = opinion_of(v, p, (int32_t)slot);
    if (o && o->pixels < lattice_count(&p->task.at)) add_up(v, o, r, s->w);
}

static void take(void *ctx, const struct record *r)
{
    struct verify *v = ctx;
    if (r->kind == REC_HELLO && !v->again) v->runs++;
    if (r->kind == REC_FRAME) take_frame(v, r);
    if (r->kind == REC_FRAG) take_frag(v, r);
}

static void read_one(struct verify *v, const char *name)
{
    struct intake in;
    const struct log_reader reader = {take, NULL, v};
    int fd = open(name, O_RDONLY | O_CLOEXEC);
    if (fd < 0) die(ST_USAGE, "%s:", name);
    intake_init(&in, false);
    int failed = log_read(&in, fd, name, &reader);
    if (failed < 0) die(ST_SYSTEM, "%s:", name);
    if (failed) die(ST_USAGE, "%s: %s", name, in.why);
    intake_free(&in);
    close(fd);
}

/* Slots of an earlier run may have been other hosts. */
static void forget_earlier(struct verify *v)
{
    for (uint32_t i = 0; i < v->n; i++)
        if (v->piece[i].run != v->runs) v->piece[i].by[0].place = v->piece[i].by[0].slot = -1;
}

/* ---- the verdict on a piece ------------------------------------------------------------------ */

static bool whole(const struct piece *p, const struct opinion *o)
{
    return o->pixels == lattice_count(&p->task.at);
}

static bool same(const struct opinion *a, const struct opinion *b)
{
    return a->sum[0] == b->sum[0] && a->sum[1] == b->sum[1];
}

static bool used(const struct piece *p, int place)
{
    for (uint32_t i = 0; i < p->n; i++)
        if (whole(p, &p->by[i]) && p->by[i].place == place) return true;
    return false;
}

/* How many hosts made the same of it as opinion o, that one included. */
static uint32_t votes(const struct piece *p, const struct opinion *o)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        bool counts = whole(p, &p->by[i]) && same(&p->by[i], o);
        for (uint32_t k = 0; counts && k < i; k++)
            counts =
                !(whole(p, &p->by[k]) && same(&p->by[k], o) && p->by[k].place == p->by[i].place);
        n += counts;
    }
    return n;
}

enum verdict { UNCHECKED, AGREED, DIFFERENT };
static enum verdict judge(const struct piece *p)
{
    bool checked = false;
    for (uint32_t i = 1; i < p->n; i++) {
        if (!whole(p, &p->by[i])) continue;
        if (!same(&p->by[i], &p->by[0])) return DIFFERENT;
        checked = checked || p->by[i].place != p->by[0].place;
    }
    return checked ? AGREED : UNCHECKED;
}

/* Hosts that have computed it. */
static uint32_t places(const struct piece *p)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        bool first = whole(p, &p->by[i]);
        for (uint32_t k = 0; first && k < i; k++)
            first = !(whole(p, &p->by[k]) && p->by[k].place == p->by[i].place);
        n += first;
    }
    return n;
}

/* The slot that shall compute it next, on a host that has not; -1: it is not needed, or none is. */
static int32_t next_slot(const struct verify *v, const struct piece *p)
{
    enum verdict verdict = judge(p);
    if (verdict == AGREED || (verdict == DIFFERENT && places(p) >= ENOUGH)) return -1;
    int from = (int)(rng_unit(v->seed + 3 + v->rounds, p->task.id) * v->hosts.slots);
    for (int i = 0; i < v->hosts.slots; i++) {
        int slot = (from + i) % v->hosts.slots;
        if (!used(p, v->host_of[slot])) return slot;
    }
    return -1;
}

/* ---- tasks ----------------------------------------------------------------------------------- */

static void flush(struct buf *b)
{
    put_stdout(buf_data(b), buf_size(b));
    buf_consume(b, buf_size(b));
}

static void write_tasks(struct verify *v, struct size *s)
{
    struct buf b = {0};
    for (uint32_t i = 0; i < v->n; i++) {
        struct task t = v->piece[i].task;
        if (t.frame != s->frame || (t.to = next_slot(v, &v->piece[i])) < 0) continue;
        if (!s->written) wire_frame(&b, s->frame, s->w, s->h, s->job);
        s->written = true;
        wire_task(&b, &t);
        if (buf_size(&b) >= READ_BYTES) flush(&b);
    }
    flush(&b);
    buf_free(&b);
}

/* State goes on as it is; each frame's tasks follow it, and at the end those of all others. */
static void pass_state(struct verify *v)
{
    struct decoder in = {0};
    struct record r;
    enum wire_result result;
    struct buf b = {0};
    ptrdiff_t n = 1;
    while (n > 0) {
        n = read_some(STDIN_FILENO, &in.in, READ_BYTES);
        if (n < 0) die(ST_SYSTEM, "standard input:");
        if (!n) wire_end(&in);
        while ((result = wire_next(&in, &r)) == WIRE_RECORD) {
            struct size *s = r.kind == REC_FRAME ? size_of(v, r.task.frame) : NULL;
            if (s) write_tasks(v, s);
            if (r.kind == REC_FRAME) continue;
            wire_forward(&b, &r, NULL, NULL);
            flush(&b);
        }
        if (result == WIRE_BAD) die(ST_USAGE, "standard input: %s", in.why);
    }
    for (uint32_t i = 0; i < v->n_sizes; i++)
        if (!v->size[i].written) write_tasks(v, &v->size[i]);
    buf_free(&b);
    wire_free(&in);
}

/* ---- the report ------------------------------------------------------------------------------ */

static void name_of(const struct verify *v, const struct opinion *o, struct buf *b)
{
    if (o->place < 0) buf_printf(b, "a slot of an earlier run");
    else {
        size_t h = 0;
        for (int slot = o->slot; slot >= v->hosts.at[h].slots; h++) slot -= v->hosts.at[h].slots;
        buf_printf(b, "slot %d (host %s)", o->slot, v->hosts.at[h].name);
    }
}

/* One that two hosts and more contradict, and no other agrees with, is wrong; else nobody knows. */
static void report_piece(const struct verify *v, const struct piece *p)
{
    struct buf b = {0};
    const char *between = "";
    uint32_t most = 0, second = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        uint32_t n = whole(p, &p->by[i]) ? votes(p, &p->by[i]) : 0;
        if (n > most) most = n;
    }
    for (uint32_t i = 0; i < p->n; i++)
        if (whole(p, &p->by[i]) && votes(p, &p->by[i]) < most) second++;
    bool known = most > 1 && second;
    for (uint32_t i = 0; i < p->n; i++) {
        if (!whole(p, &p->by[i]) || (known && votes(p, &p->by[i]) == most)) continue;
        buf_printf(&b, "%s", between);
        name_of(v, &p->by[i], &b);
        between = known ? ", " : " and ";
    }
    warn("frame %" PRIu32 " at %" PRIu32 ",%" PRIu32 ": %.*s %s", p->task.frame, p->task.at.x,
        p->task.at.y, (int)buf_size(&b), (const char *)buf_data(&b),
        known ? "computed other pixels than two other hosts" : "computed different pixels");
    buf_free(&b);
}

static int report(const struct verify *v)
{
    uint32_t count[3] = {0};
    for (uint32_t i = 0; i < v->n; i++) {
        enum verdict verdict = judge(&v->piece[i]);
        if (verdict == DIFFERENT && count[DIFFERENT] < LINES_MOST) report_piece(v, &v->piece[i]);
        count[verdict]++;
    }
    warn("%" PRIu32 " of %" PRIu64 " pieces were computed again on another %s: %" PRIu32
         " differ, %" PRIu32 " could not be",
        v->n, v->seen, v->hosts.n > 1 ? "host" : "slot of the only host", count[DIFFERENT],
        count[UNCHECKED]);
    return count[DIFFERENT] || count[UNCHECKED] ? ST_PARTIAL : ST_OK;
}

/* ---------------------------------------------------------------------------------------------- */

static void find_slots(struct verify *v, const char *list, int slots)
{
    char err[HOSTS_ERR];
    if (!list == !slots) die(ST_USAGE, "expected either -S or -j");
    if (!list) hosts_here(&v->hosts, slots);
    else if (!hosts_read(&v->hosts, list, err)) die(ST_USAGE, "%s", err);
    v->host_of = xmalloc((size_t)v->hosts.slots, sizeof *v->host_of);
    int slot = 0;
    for (size_t h = 0; h < v->hosts.n; h++)
        for (int i = 0; i < v->hosts.at[h].slots; i++, slot++)
            v->host_of[slot] = v->hosts.n > 1 ? (int)h : slot;
}

int main(int argc, char **argv)
{
    static const char text[] = "[-hr] [-s SEED] -j SLOTS | -S HOSTS FRACTION LOG [CHECK ...]";
    struct verify v = {0};
    const char *list = NULL;
    int opt, slots = 0;
    prog_init(argv[0]);
    while ((opt = prog_getopt(argc, argv, "+hj:rs:S:")) != -1) {
        switch (opt) {
        case 'h': usage(ST_OK, text);
        case 'j': slots = (int)opt_int(opt, optarg, 1, HOSTS_SLOTS_MAX); break;
        case 'r': v.report = true; break;
        case 's': v.seed = (uint64_t)opt_int(opt, optarg, 0, INT64_MAX); break;
        case 'S': list = opt_text(opt, optarg); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (argc - optind < 2) usage(ST_USAGE, text);
    if (!parse_real(argv[optind], 0, 1, &v.fraction) || v.fraction <= 0)
        die(ST_USAGE, "%s: expected a fraction above 0, up to 1", argv[optind]);
    find_slots(&v, list, slots);
    v.pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *v.pixels);
    read_one(&v, argv[++optind]);
    forget_earlier(&v);
    for (v.again = true; ++optind < argc; v.rounds++) read_one(&v, argv[optind]);
    int status = ST_OK;
    if (v.report) status = report(&v);
    else pass_state(&v);
    free(v.piece);
    free(v.size);
    free(v.pixels);
    free(v.host_of);
    hosts_free(&v.hosts);
    close_stdout();
    return status;
}
