/*
 * A policy on measured costs in virtual time: reads tasks from standard input, prints the makespan
 * and the bound below which no schedule of pixels can be, in seconds.
 *
 *     policy_bench [-es] [-c OVERHEAD_US] [-l LATENCY_US] [-q DEPTH|auto] [-t TOTAL_S]
 *                  -w POWER,... LOG <TASKS
 *
 * LOG is of the whole picture on one worker, in small tasks. -c is what a task costs its worker
 * beside its pixels, -l the mean latency of a link one way, -t what the picture costs at power 1
 * (unless given, what the log says); with -s slot 0 falls to a twentieth of its power at half of the
 * bound.
 */
#include "../oracles/oracles.h"
#include "base/base.h"
#include "log/log.h"
#include "sim/sim.h"
#include "stats/stats.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct bench {
    struct sim_plan plan;
    struct sim_work work;
    struct sim_fault slow;
    struct log_costs costs;
    struct task *tasks;
    double *power;
    double total_s;
};

static void parse_powers(struct bench *b, char *list)
{
    for (char *word; (word = strsep(&list, ",")) != NULL; b->plan.slots++) {
        b->power = xrealloc(b->power, (size_t)b->plan.slots + 1, sizeof *b->power);
        if (!parse_real(word, 1e-3, 1e3, &b->power[b->plan.slots]))
            die(ST_USAGE, "-w %s: expected powers", word);
    }
    if (b->plan.slots > SIM_SLOTS_MOST) die(ST_USAGE, "-w: at most %d", SIM_SLOTS_MOST);
}

static void parse(struct bench *b, int argc, char **argv)
{
    int opt;
    b->plan.work = &b->work;
    b->plan.faults = &b->slow;
    b->plan.hops = 2;
    b->plan.jitter = .5;
    b->plan.width = 1;
    while ((opt = getopt(argc, argv, "ec:l:q:st:w:")) != -1) {
        switch (opt) {
        case 'e': b->plan.params.endgame = true; break;
        case 'c': b->work.task_us = opt_real(opt, optarg, 0, 1e9); break;
        case 'l': b->plan.link.latency_us = opt_int(opt, optarg, 0, 1000000000); break;
        case 'q':
            if (strcmp(optarg, "auto") == 0) b->plan.params.depth = SCHED_DEPTH_AUTO;
            else b->plan.params.depth = (int32_t)opt_int(opt, optarg, 0, 1000000);
            break;
        case 's': b->plan.n_faults = 1; break;
        case 't': b->total_s = opt_real(opt, optarg, 1e-6, 1e9); break;
        case 'w': parse_powers(b, optarg); break;
        default: die(ST_USAGE, "expected options as in the source");
        }
    }
    if (optind + 1 != argc || !b->power) die(ST_USAGE, "expected -w POWER,... LOG");
    char why[LOG_WHY];
    if (log_costs_read(argv[optind], &b->costs, why) != 0 || !b->costs.us)
        die(ST_USAGE, "%s: expected a log", argv[optind]);
}

static void read_tasks(struct bench *b)
{
    struct decoder d = {0};
    struct record r;
    while (read_some(STDIN_FILENO, &d.in, 1 << 16) > 0)
        ;
    wire_end(&d);
    while (wire_next(&d, &r) == WIRE_RECORD) {
        if (r.kind == REC_FRAME && (r.frame_w != b->costs.w || r.frame_h != b->costs.h))
            die(ST_USAGE, "tasks of another size than the log's");
        if (r.kind != REC_TASK) continue;
        b->tasks = xrealloc(b->tasks, (size_t)b->plan.tasks + 1, sizeof *b->tasks);
        b->tasks[b->plan.tasks++] = r.task;
    }
    wire_free(&d);
}

static double lower_bound_of(const struct bench *b)
{
    size_t n = (size_t)b->costs.w * b->costs.h, m = (size_t)b->plan.slots;
    double *v = xmalloc(m, sizeof *v);
    memcpy(v, b->power, m * sizeof *v);
    double bound = stats_lower_bound(b->costs.us, n, v, m);
    free(v);
    return bound;
}

int main(int argc, char **argv)
{
    struct bench b = {0};
    prog_init(argv[0]);
    parse(&b, argc, argv);
    read_tasks(&b);
    size_t n = (size_t)b.costs.w * b.costs.h;
    double sum_us = 0;
    for (size_t i = 0; i < n; i++) sum_us += b.costs.us[i];
    for (size_t i = 0; i < n && b.total_s > 0; i++) b.costs.us[i] *= b.total_s * 1e6 / sum_us;
    b.work.frame_w = b.costs.w;
    b.work.frame_h = b.costs.h;
    b.work.tasks = b.tasks;
    b.work.pixel_us = b.costs.us;
    b.work.power = b.power;
    double bound_us = lower_bound_of(&b);
    b.slow = (struct sim_fault){SIM_SLOW, 0, (int64_t)(bound_us / 2), 0, .05};
    struct sim_result result;
    sim_run(&policy_deal, &b.plan, &result);
    if (*result.failure) die(ST_PARTIAL, "%s", result.failure);
    printf("%.6f %.6f\n", (double)result.end_us * 1e-6, bound_us * 1e-6);
    log_costs_free(&b.costs);
    free(b.tasks);
    free(b.power);
    close_stdout();
    return ST_OK;
}
