/* fragstat: who did what, when, and how well the work was balanced, from a log of fragments. */
#include "base/base.h"
#include "stats/stats.h"
#include "wire/wire.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SLOTS_MAX (1 << 20)

struct slot {
    char name[64];
    int64_t tasks;
    double cpu_s, busy_s;
    double first_s, last_s; /* begin of its first task, end of its last */
};

struct run {
    struct slot *slots;
    size_t n_slots;
    double *costs_s; /* CPU time of each task, the first answer of each */
    size_t n_tasks;
    struct task_table seen;
    int64_t duplicates, lost_records;
    int64_t said_slots; /* the most that a hello claims: those that were never given work count */
};

static struct slot *slot_named(struct run *run, const char *name)
{
    for (size_t i = 0; i < run->n_slots; i++)
        if (strcmp(run->slots[i].name, name) == 0) return &run->slots[i];
    run->slots = xrealloc(run->slots, run->n_slots + 1, sizeof *run->slots);
    struct slot *s = &run->slots[run->n_slots++];
    *s = (struct slot){.first_s = HUGE_VAL};
    snprintf(s->name, sizeof s->name, "%s", name);
    return s;
}

/* Logs of a lone worker have no stamps: then busy times are all there is, one after the other. */
static void take_done(struct run *run, const struct record *r)
{
    char name[64];
    int64_t cpu, wall, recv;
    if (!rec_str(r, "w", name, sizeof name)) snprintf(name, sizeof name, "-");
    if (!rec_int(r, "cpu_us", 0, INT64_MAX, &cpu)) cpu = 0;
    if (!rec_int(r, "wall_us", 0, INT64_MAX, &wall)) wall = cpu;
    struct slot *s = slot_named(run, name);
    double busy_s = (double)wall * 1e-6;
    double end_s =
        rec_int(r, "recv_us", 0, INT64_MAX, &recv) ? (double)recv * 1e-6 : s->last_s + busy_s;
    s->tasks++;
    s->cpu_s += (double)cpu * 1e-6;
    s->busy_s += busy_s;
    if (end_s - busy_s < s->first_s) s->first_s = end_s > busy_s ? end_s - busy_s : 0;
    if (end_s > s->last_s) s->last_s = end_s;
    if (tasks_find(&run->seen, r->task.frame, r->task.id) >= 0) {
        run->duplicates++;
        return;
    }
    tasks_add(&run->seen, &r->task, 1);
    run->costs_s = xrealloc(run->costs_s, run->n_tasks + 1, sizeof *run->costs_s);
    run->costs_s[run->n_tasks++] = (double)cpu * 1e-6;
}

static void take_hello(struct run *run, const struct record *r)
{
    int64_t n;
    if (rec_int(r, "slots", 1, SLOTS_MAX, &n) && n > run->said_slots) run->said_slots = n;
}

static void read_log(struct run *run, const char *path)
{
    struct decoder d = {.upward = true};
    int fd = strcmp(path, "-") == 0 ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) die(ST_USAGE, "%s:", path);
    for (bool more = true; more;) {
        ptrdiff_t n = read_some(fd, &d.in, 1 << 16);
        if (n < 0) die(ST_SYSTEM, "%s:", path);
        more = n > 0;
        if (!more) wire_end(&d);
        struct record r;
        enum wire_result result;
        while ((result = wire_next(&d, &r)) != WIRE_MORE) {
            if (result == WIRE_RECORD && r.kind == REC_DONE) take_done(run, &r);
            if (result == WIRE_RECORD && r.kind == REC_HELLO) take_hello(run, &r);
        }
    }
    run->lost_records += (int64_t)d.bad;
    wire_free(&d);
    if (fd != STDIN_FILENO) close(fd);
}

static int by_name(const void *a, const void *b)
{
    return strverscmp(((const struct slot *)a)->name, ((const struct slot *)b)->name);
}

static double makespan(const struct run *run)
{
    double t = 0;
    for (size_t i = 0; i < run->n_slots; i++)
        if (run->slots[i].last_s > t) t = run->slots[i].last_s;
    return t;
}

/* Idle time split: before the first task, between tasks, after the last one until all were done. */
static void print_slots(const struct run *run)
{
    double end_s = makespan(run);
    printf("slot\ttasks\tcpu_s\tbusy_s\tstartup_s\twaiting_s\ttail_s\n");
    for (size_t i = 0; i < run->n_slots; i++) {
        const struct slot *s = &run->slots[i];
        double waiting_s = s->last_s - s->first_s - s->busy_s;
        printf("%s\t%lld\t%.6f\t%.6f\t%.6f\t%.6f\t%.6f\n", s->name, (long long)s->tasks, s->cpu_s,
            s->busy_s, s->first_s, waiting_s > 0 ? waiting_s : 0, end_s - s->last_s);
    }
}

static void print_summary(struct run *run)
{
    size_t n = run->n_slots;
    if (run->said_slots > (int64_t)n) n = (size_t)run->said_slots;
    double *power = xmalloc(n, sizeof *power), cpu_s = 0, wall_s = makespan(run);
    for (size_t i = 0; i < n; i++) power[i] = 1;
    for (size_t i = 0; i < run->n_slots; i++) cpu_s += run->slots[i].cpu_s;
    double bound_s = lower_bound(run->costs_s, run->n_tasks, power, n);
    printf("slots\t%zu\ntasks\t%zu\nduplicates\t%lld\nlost_records\t%lld\n", n, run->n_tasks,
        (long long)run->duplicates, (long long)run->lost_records);
    printf("makespan_s\t%.6f\ncpu_s\t%.6f\nbound_s\t%.6f\nefficiency\t%.4f\n", wall_s, cpu_s,
        bound_s, wall_s > 0 ? bound_s / wall_s : 0);
    free(power);
}

int main(int argc, char **argv)
{
    static const char text[] = "[-s] [FRAGS ...]";
    bool summary = false;
    struct run run = {0};
    prog_init(argv[0]);
    int opt;
    while ((opt = getopt(argc, argv, "+hs")) != -1) {
        switch (opt) {
        case 'h': usage(ST_OK, text);
        case 's': summary = true; break;
        default: usage(ST_USAGE, text);
        }
    }
    if (optind == argc) read_log(&run, "-");
    for (int i = optind; i < argc; i++) read_log(&run, argv[i]);
    if (!run.n_tasks) die(ST_PARTIAL, "no task was done in this log, expected `done` records");
    qsort(run.slots, run.n_slots, sizeof *run.slots, by_name);
    if (summary) print_summary(&run);
    else print_slots(&run);
    tasks_free(&run.seen);
    free(run.slots);
    free(run.costs_s);
    close_stdout();
    return ST_OK;
}
