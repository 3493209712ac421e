/*
 * One run: schedules the plan's faults, then handles events in order of time until none is left.
 */
#include "sim/world.h"

#include <stdlib.h>

#define AT_ONCE 100   /* limit of events per slot and task, against endless loops */
#define PX_AT_ONCE 10 /* likewise, per pixel */

/* ---- the hub --------------------------------------------------------------------------------- */

/* Splits the time of all slots. */
static void account(struct world *w)
{
    w->result->end_us = w->now_us;
    for (int32_t k = 0; k < w->plan->slots; k++) {
        sim_clock_split(&w->slots[k].clock, w->now_us, w->result);
        sim_work_count(w, k);
    }
}

/* Measuring ends here; nodes end with their input. */
static void close_run(struct world *w, const struct sched_action *a)
{
    account(w);
    for (int32_t k = 0; w->plan->node && k < w->plan->slots; k++)
        if (w->slots[k].alive) sim_send_down(w, k, a);
}

static void step(struct world *w, const struct sched_event *e)
{
    struct sched_actions *acts = &w->acts;
    int64_t commits = w->result->commits;
    sim_note_event(w, e);
    w->policy->step(w->state, e, w->now_us, acts);
    for (size_t i = 0; i < acts->n; i++) {
        const struct sched_action *a = &acts->at[i];
        sim_note_action(w, a);
        if (a->kind == SCHED_END || a->kind == SCHED_STOP) close_run(w, a);
        else if (a->kind != SCHED_COMMIT && a->kind != SCHED_BLAME && a->kind != SCHED_ABANDON)
            sim_send_down(w, a->slot, a);
    }
    acts->n = 0;
    if (w->checks && w->checks->after) w->checks->after(w);
    sim_schedule_wake(w, w->policy, w->state, -1);
    if (w->result->commits > commits) sim_inject_by_commits(w, commits);
}

/* Admits the generations up to this one, each like its state in the live driver. */
static bool admitted(struct world *w, uint32_t generation)
{
    while (w->generation != generation) {
        uint32_t next = w->generation + 1;
        uint32_t window = w->plan->window > 2 ? (uint32_t)w->plan->window : 2;
        int32_t older = w->open_of[(next - window) % GENERATIONS];
        bool waits = !sched_admits(w->policy, w->state, next - window, next - window + 1);
        bool before = w->waits;
        if (waits != (older > 0))
            sim_fail(w, "a frame must wait exactly if older tasks are open", next, older);
        w->waits = waits;
        if (waits && !before) step(w, &(struct sched_event){.kind = SCHED_FLUSH});
        if (waits) return false;
        w->generation = next;
    }
    return true;
}

/* Reads tasks that have arrived while few wait, and skips committed ones. */
static void read_input(struct world *w)
{
    const int32_t n = w->plan->tasks;
    while (w->n_read < n && w->policy->waiting(w->state) < SCHED_WAITING_MOST) {
        int64_t at = w->begun_us + w->spread_us * w->n_read / n;
        if (at > w->now_us) {
            w->input_due = true;
            sim_schedule(w, at, 0, (struct sim_event){.kind = SIM_INPUT});
            return;
        }
        const struct vtask *t = &w->tasks[w->order[w->n_read]];
        if (!admitted(w, t->task.generation)) return;
        w->n_read++;
        struct sched_event e = {
            .kind = SCHED_TASK, .task = t->task, .frame_w = w->frame_w, .from = -1};
        if (!t->committed) step(w, &e);
    }
    if (w->n_read == n) step(w, &(struct sched_event){.kind = SCHED_INPUT_END});
}

static void wake_hub(struct world *w)
{
    w->wake_us = INT64_MAX;
    if (w->policy->wake_us(w->state) <= w->now_us)
        step(w, &(struct sched_event){.kind = SCHED_WAKE});
    else sim_schedule_wake(w, w->policy, w->state, -1);
}

/* True if the event is for, or from, a process that no longer exists. */
static bool is_void(const struct world *w, const struct sim_event *e)
{
    switch (e->kind) {
    case SIM_FAULT:
    case SIM_LOAD:
    case SIM_RESTART: return false;
    case SIM_SCHED:
    case SIM_AT_HUB:
    case SIM_INPUT:
    case SIM_RETURN: return e->hub != w->hub;
    default: break;
    }
    if (e->hub != w->hub) return true;
    return e->slot >= 0 && (!w->slots[e->slot].alive || e->epoch != w->slots[e->slot].epoch);
}

static void handle(struct world *w, const struct sim_event *e)
{
    switch (e->kind) {
    case SIM_SCHED:
        if (e->sched.kind == SCHED_UP && !w->slots[e->sched.slot].up) sim_prime(w, e->sched.slot);
        step(w, &e->sched);
        break;
    case SIM_AT_HUB: sim_pass_hub(w, e); break;
    case SIM_INPUT: w->input_due = false; break;
    case SIM_RETURN: sim_slot_comes_up(w, e->slot); break;
    case SIM_RESUME: sim_resume(w, e->slot); break;
    case SIM_GIVE_UP:
        w->result->silences++;
        sim_lose_slot(w, e->slot);
        break;
    case SIM_WAKE:
        if (e->slot < 0) wake_hub(w);
        else sim_deliver(w, e);
        break;
    case SIM_TO_SLOT:
    case SIM_STATE:
    case SIM_PREPARED:
    case SIM_COMPUTED: sim_deliver(w, e); break;
    case SIM_LOAD: sim_take_load(w, e); return;
    case SIM_FAULT: sim_inject_fault(w, e); return;
    case SIM_RESTART: sim_restart_hub(w); return;
    }
    if (!w->input_due && !w->input_ended && !w->down) read_input(w);
}

/* ---- a run ------------------------------------------------------------------------------ */

static void begin(struct world *w)
{
    const struct sim_plan *p = w->plan;
    for (int32_t k = 0; k < p->slots; k++) {
        w->slots[k].power = k ? .25 + 2 * sim_draw(w) : 1;
        if (p->work) w->slots[k].power = p->work->power[k];
        sim_draw_fault(w, k);
    }
    sim_plan_poison(w);
    sim_plan_faults(w);
    sim_plan_loads(w);
    /* The number of slots may be known before or after the first tasks. */
    sim_start_slots(w, sim_draw(w) < .5 || p->work ? 0 : (int64_t)(sim_draw(w) * 2e5));
    w->spread_us = sim_draw(w) < .5 || p->calm || p->work ? 0 : (int64_t)(1e6 * sim_draw(w));
    for (int32_t i = 0; i < p->assigned; i++) { /* one in eight to a slot that does not exist */
        struct vtask *t = &w->tasks[w->order[i]];
        t->to = t->task.to = (int32_t)(sim_draw(w) * 1.125 * p->slots);
    }
    w->input_due = true;
    sim_schedule(w, 0, 0, (struct sim_event){.kind = SIM_INPUT});
}

/* The least part of its power that a slot may have. Slow-downs of a slot multiply. */
static double least_part(const struct sim_plan *p)
{
    double slow = p->p_slow > 0 ? SLOWEST : 1, share = 1;
    for (size_t i = 0; i < p->n_faults; i++)
        if (p->faults[i].kind == SIM_SLOW) slow *= fmin(p->faults[i].power, 1);
    for (size_t i = 0; i < p->n_loads; i++)
        if (p->loads[i].share > 0) share = fmin(share, p->loads[i].share);
    return fmax(slow, POWER_LEAST) * share;
}

/* All of the work in sequence, at the least power that a slot may have. */
static double alone_us(const struct world *w)
{
    const struct sim_plan *p = w->plan;
    if (!p->work) return p->cost_us * exp(4) * p->rows * (p->tasks + 2);
    double us = p->work->task_us * p->tasks, least = p->work->power[0];
    for (size_t i = 0, n = (size_t)w->frame_w * w->frame_h; i < n; i++) us += p->work->pixel_us[i];
    for (int32_t k = 1; k < p->slots; k++) least = fmin(least, p->work->power[k]);
    return us / (least * least_part(p));
}

/* Until the last slot is prepared, at the least power that it may have, and the last load has
 * changed. A slot that comes back prepares once more. */
static double start_us(const struct world *w)
{
    const struct sim_plan *p = w->plan;
    double most = net_us(p->start.state_bytes * net_links(p), net_least_rate(p));
    double us = 0, part = least_part(p), times = 1 + (p->p_return > 0) + (double)p->n_faults;
    for (int32_t k = 0; k < p->slots; k++) {
        double build = sim_build_us(p, k) / (w->slots[k].power * part);
        us = fmax(us, (double)sim_connect_us(p, k) + build);
    }
    for (size_t i = 0; i < p->n_loads; i++) most = fmax(most, (double)p->loads[i].at_us);
    return times * (most + us);
}

/*
 * One slot alone could do all of it, with one round trip per task, once the faults are over; twice
 * that is enough. Pieces are more tasks, with less work each.
 */
static int64_t time_allowed_us(const struct world *w)
{
    const struct sim_plan *p = w->plan;
    double trips_us = 4 * w->latency_us * (w->n_tasks + 2) + w->bytes_us;
    double faults_us = (double)p->faults_us + 2e6 + w->start_us;
    faults_us += (double)p->silence_us * (1 + (double)p->n_faults);
    faults_us += (double)p->detect_us * p->slots;
    const double lost_us = p->concentrate ? w->alone_us : w->alone_us / (p->tasks + 1);
    faults_us += POISON_TRIES * (double)w->n_poison * (1e6 + lost_us); /* with what a slot holds */
    double us = 2 * (1 + (double)w->result->kills) * (faults_us + w->alone_us + trips_us);
    return (int64_t)fmin(us, 4e18); /* it is doubled */
}

/* Without faults, and with the link hidden: the bound, transfers at both ends, and a last task. */
static int64_t calm_us(const struct world *w)
{
    double power = 0, least = 1;
    for (int32_t k = 0; k < w->plan->slots; k++) {
        power += w->slots[k].power;
        least = fmin(least, w->slots[k].power);
    }
    double last_us = w->plan->cost_us * exp(4) / least;
    return (int64_t)(1.25 * w->cost_us / power + last_us + 10 * (double)w->plan->link.latency_us);
}

static void trace_event(struct world *w, const struct sim_event *e)
{
    char line[SIM_LINE];
    if (w->plan->trace) {
        sim_trace_line(e, is_void(w, e), line);
        w->plan->trace(line);
    }
    const struct sched_event *s = &e->sched;
    const int64_t v[8] = {
        e->at_us, e->kind, e->slot, s->kind, s->task.id, s->ring.kind, s->ring.peer, s->ring.next};
    w->result->trace_hash = hash64(w->result->trace_hash, v, sizeof v);
}

/* Tasks may overlap. */
static uint64_t count_wanted(const struct world *w)
{
    struct coverage c;
    coverage_init(&c, w->frame_w, w->frame_h);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct lattice *at = &w->tasks[i].task.at;
        for (uint64_t k = 0, n = lattice_count(at); k < n; k++)
            coverage_set(&c, lattice_pixel(at, w->frame_w, k));
    }
    uint64_t px = c.done;
    coverage_free(&c);
    return px;
}

static void open_world(struct world *w)
{
    const struct sim_plan *p = w->plan;
    w->frame_w = p->work ? p->work->frame_w : FRAME_W;
    w->frame_h = p->work ? p->work->frame_h : (uint32_t)(p->rows * p->tasks + 1);
    w->slots = xcalloc((size_t)p->slots, sizeof *w->slots);
    for (int32_t k = 0; k < p->slots; k++) {
        w->slots[k].clock = SIM_CLOCK_INIT;
        w->slots[k].wake_us = INT64_MAX;
        w->slots[k].share = 1;
    }
    w->wake_us = INT64_MAX;
    w->up = xcalloc(2 * (size_t)net_links(p), sizeof *w->up);
    w->down_to = w->up + net_links(p);
    w->primed_us = xcalloc((size_t)net_links(p), sizeof *w->primed_us);
    for (int32_t i = 0; i < net_links(p); i++) w->primed_us[i] = -1;
    w->order = xcalloc((size_t)p->tasks + 1, sizeof *w->order);
    coverage_init(&w->sent, w->frame_w, w->frame_h);
    for (int32_t i = 0; i < p->tasks; i++) {
        uint32_t id = (uint32_t)i, rows = (uint32_t)p->rows;
        struct task made = {.id = id, .at = {0, id * rows, FRAME_W, rows, 1, 1}, .to = -1};
        w->order[i] = p->work ? p->work->tasks[i].id : id;
        struct vtask *t = sim_vtask_at(w, w->order[i]);
        t->task = p->work ? p->work->tasks[i] : made;
        if (p->frames) t->task.generation = (uint32_t)((int64_t)i * p->frames / p->tasks);
        t->to = t->task.to;
    }
    w->wanted_px = count_wanted(w);
}

static void close_world(struct world *w)
{
    for (int32_t k = 0; k < w->plan->slots; k++) {
        struct vslot *s = &w->slots[k];
        if (s->node) w->plan->node->destroy(s->node);
        free(s->queue.at);
        free(s->held.at);
        free(s->inbox.at);
        free(s->note);
    }
    for (int32_t i = 0; i < w->n_tasks; i++) free(w->tasks[i].note);
    coverage_free(&w->sent);
    free(w->poison);
    free(w->note);
    free(w->up);
    free(w->primed_us);
    free(w->slots);
    free(w->order);
    free(w->tasks);
    sim_heap_free(&w->heap);
    free(w->acts.at);
    free(w->node_acts.at);
}

void sim_run(const struct policy *policy, const struct sim_plan *plan, struct sim_result *result)
{
    struct world w = {.policy = policy, .plan = plan, .checks = plan->checks, .result = result};
    struct sim_event e;
    *result = (struct sim_result){.trace_hash = HASH64_INIT};
    open_world(&w);
    w.state = policy->create(&plan->params);
    begin(&w);
    w.alone_us = alone_us(&w);
    w.start_us = start_us(&w);
    w.latency_us = (double)net_most_us(plan);
    w.bytes_us = net_us(net_all_bytes(plan), net_least_rate(plan));
    int64_t n = plan->slots, at_once = 0, most = AT_ONCE * (n + plan->tasks + 1);
    most += PX_AT_ONCE * (int64_t)w.frame_w * w.frame_h;
    if (plan->detect_us) most += AT_ONCE * n * n; /* each node asks each other */
    while (!*result->failure && !result->stops && sim_heap_pop(&w.heap, &e)) {
        if (e.at_us > 2 * time_allowed_us(&w)) break; /* some methods ask for ever */
        if (sim_work_over(&w, &e)) continue;
        at_once = e.at_us > w.now_us ? 0 : at_once + 1;
        if (at_once > most) sim_fail(&w, "time stands still", at_once, most);
        w.now_us = e.at_us;
        result->events++;
        trace_event(&w, &e);
        if (!is_void(&w, &e)) handle(&w, &e);
    }
    int64_t allowed_us = time_allowed_us(&w);
    if (!w.ended) account(&w);
    for (int32_t i = 0; i < plan->tasks; i++) result->uncommitted += !w.tasks[i].committed;
    if (!w.ended) sim_fail(&w, "the run did not end", result->commits, plan->tasks);
    else if (result->end_us > allowed_us)
        sim_fail(&w, "the end came late", result->end_us, allowed_us);
    else if (plan->calm && result->end_us > calm_us(&w))
        sim_fail(&w, "a long link was not hidden", result->end_us, calm_us(&w));
    policy->destroy(w.state);
    close_world(&w);
}

void sim_add(struct sim_result *sum, const struct sim_result *r)
{
    sum->commits += r->commits;
    sum->gives += r->gives;
    sum->flushes += r->flushes;
    sum->events += r->events;
    sum->crashes += r->crashes;
    sum->silences += r->silences;
    sum->pauses += r->pauses;
    sum->slows += r->slows;
    sum->hangs += r->hangs;
    sum->drains += r->drains;
    sum->leaves += r->leaves;
    sum->poisoned += r->poisoned;
    sum->refused += r->refused;
    sum->abandoned += r->abandoned;
    sum->kills += r->kills;
    sum->twice += r->twice;
    sum->garbage += r->garbage;
    sum->returns += r->returns;
    sum->uncommitted += r->uncommitted;
    sum->copies += r->copies;
    sum->pieces += r->pieces;
    sum->stops += r->stops;
    sum->withheld += r->withheld;
    sum->late_copies += r->late_copies;
    sum->computed += r->computed;
    sum->messages += r->messages;
    sum->steals += r->steals;
    sum->passed += r->passed;
    sum->taken_over += r->taken_over;
    sum->reports += r->reports;
    sum->lost += r->lost;
    sum->doubled += r->doubled;
    sum->late += r->late;
    sum->trace_hash = hash64(sum->trace_hash, &r->trace_hash, sizeof r->trace_hash);
}
