/*
 * A view that follows a camera, in virtual time. Each seed is a run of random views, slots, times
 * of tasks, pieces, losses and late copies. What must hold: no pixel is asked for twice for one
 * view, what is shown is of the view, what is under way is bounded, and a view that rests becomes
 * whole. Then the moves of a camera.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "look/look.h"
#include "rounds.h"

#define UNDER_WAY_MOST 4096
#define SIDE_MOST 70

struct sent {
    struct task task;
    int64_t due_us, wall_us;
    bool fails;
};
struct run {
    struct look look;
    uint64_t seed, drawn;
    int64_t now_us;
    uint32_t frame, w, h;
    int32_t slots;
    struct sent way[UNDER_WAY_MOST];
    size_t n;
    uint8_t asked[SIDE_MOST * SIDE_MOST]; /* of this view */
    bool failed[SIDE_MOST * SIDE_MOST];
    float rgba[4 * SIDE_MOST * SIDE_MOST];
    char why[200];
};

static uint64_t draw(struct run *r, uint64_t below) { return rng_u64(r->seed, r->drawn++) % below; }

static bool wrong(struct run *r, const char *why)
{
    if (!*r->why) snprintf(r->why, sizeof r->why, "%s at %lld us", why, (long long)r->now_us);
    return false;
}

/* The value of a pixel of a frame, which no other one has. */
static float value(uint32_t frame, uint64_t p) { return (float)(frame * 8192 + p + 1); }

/* ---- what is sent ---------------------------------------------------------------------------- */

static bool send_task(struct run *r, const struct task *t)
{
    if (t->frame != r->frame) return wrong(r, "a task of an old view");
    if (!lattice_valid(&t->at, r->w, r->h)) return wrong(r, "a task outside");
    for (uint64_t i = 0; i < lattice_count(&t->at); i++)
        if (r->asked[lattice_pixel(&t->at, r->w, i)]++) return wrong(r, "a pixel is asked twice");
    if (r->n == UNDER_WAY_MOST) return wrong(r, "too many tasks");
    const int64_t wall = 200 + (int64_t)draw(r, 30000);
    r->way[r->n++] =
        (struct sent){*t, r->now_us + wall + (int64_t)draw(r, 20000), wall, draw(r, 50) == 0};
    return true;
}

static size_t fresh(const struct run *r)
{
    size_t n = 0;
    for (size_t i = 0; i < r->n; i++) n += r->way[i].task.frame == r->frame;
    return n;
}

static bool send_all(struct run *r)
{
    struct task t;
    while (look_next(&r->look, r->now_us, &t))
        if (!send_task(r, &t)) return false;
    const size_t most = (size_t)r->slots * LOOK_DEPTH_MOST;
    if (fresh(r) > most) return wrong(r, "more tasks under way than the slots may hold");
    return true;
}

/* ---- what comes ------------------------------------------------------------------------------ */

static bool shown_is_right(struct run *r)
{
    const struct look *l = &r->look;
    for (uint32_t y = 0; y < r->h; y++)
        for (uint32_t x = 0; x < r->w; x++) {
            const uint64_t p = (uint64_t)y * r->w + x;
            const float *v = l->rgba + 4 * p;
            if (!l->level[p] && v[0] != 0) return wrong(r, "a stale pixel is shown");
            if (!l->level[p]) continue;
            const uint64_t of = (uint64_t)v[0] - r->frame * 8192 - 1;
            const uint32_t fx = (uint32_t)(of % r->w), fy = (uint32_t)(of / r->w);
            if (of >= (uint64_t)r->w * r->h) return wrong(r, "a pixel of another view is shown");
            if (fx > x || fy > y || x - fx > 3 || y - fy > 3) return wrong(r, "a far pixel");
            if (l->level[p] == LOOK_FINAL && of != p) return wrong(r, "a wrong pixel");
            if (coverage_has(&l->have, p) != (l->level[p] == LOOK_FINAL))
                return wrong(r, "a pixel that has come is not final");
        }
    return true;
}

static bool come(struct run *r, uint32_t id, const struct task *t, const struct lattice *at)
{
    const struct task piece = {.frame = t->frame, .id = id, .at = *at};
    const uint32_t w = r->w;
    for (uint64_t i = 0; i < lattice_count(at); i++)
        for (int c = 0; c < 4; c++)
            r->rgba[4 * i + (uint64_t)c] =
                value(t->frame, t->frame == r->frame ? lattice_pixel(at, w, i) : 0);
    if (!look_frag(&r->look, &piece, r->rgba, r->now_us)) return wrong(r, "pixels are refused");
    return true;
}

/* In pieces, which a policy may have given other numbers; some come again. */
static bool deliver(struct run *r, const struct sent *s, uint32_t frame_w)
{
    const uint64_t n = lattice_count(&s->task.at);
    const bool other = draw(r, 8) == 0;
    for (uint64_t n0 = 0; n0 < n;) {
        const struct lattice at = lattice_cut(&s->task.at, frame_w, n0, 1 + draw(r, n));
        const uint32_t id = other ? 1000000 + s->task.id : s->task.id;
        if (!come(r, id, &s->task, &at)) return false;
        if (draw(r, 20) == 0 && !come(r, id, &s->task, &at)) return false;
        n0 += lattice_count(&at);
    }
    return true;
}

static void fail_task(struct run *r, const struct task *t)
{
    const uint64_t n = look_fail(&r->look, t->frame, t->id, r->now_us);
    if (t->frame != r->frame) {
        if (n) wrong(r, "a failure of an old view counts");
        return;
    }
    if (n != lattice_count(&t->at)) wrong(r, "a failure loses its pixels");
    for (uint64_t i = 0; i < lattice_count(&t->at); i++)
        r->failed[lattice_pixel(&t->at, r->w, i)] = true;
}

static uint32_t widths[1 << 16]; /* of frames */

static bool take_due(struct run *r)
{
    for (size_t i = 0; i < r->n;) {
        const struct sent s = r->way[i];
        if (s.due_us > r->now_us) {
            i++;
            continue;
        }
        r->way[i] = r->way[--r->n];
        if (s.fails) {
            fail_task(r, &s.task);
            continue;
        }
        look_done(&r->look, s.task.frame, s.task.id, s.wall_us);
        if (!deliver(r, &s, widths[s.task.frame])) return false;
    }
    return !*r->why && shown_is_right(r);
}

/* ---- a run ----------------------------------------------------------------------------------- */

static void view(struct run *r)
{
    if (draw(r, 6) == 0 || !r->w)
        r->w = 1 + (uint32_t)draw(r, SIDE_MOST), r->h = 1 + (uint32_t)draw(r, SIDE_MOST);
    look_view(&r->look, ++r->frame, r->w, r->h, r->now_us);
    widths[r->frame] = r->w;
    memset(r->asked, 0, sizeof r->asked);
    memset(r->failed, 0, sizeof r->failed);
}

static bool rest(struct run *r)
{
    for (int i = 0; i < 20000 && !look_whole(&r->look); i++) {
        r->now_us += 2000;
        if (!take_due(r) || !send_all(r)) return false;
    }
    if (!look_whole(&r->look)) return wrong(r, "a view that rests is not whole");
    if (!look_coarse(&r->look)) return wrong(r, "a whole view is not coarse");
    if (r->look.coarse_us < 0 || r->look.whole_us < r->look.coarse_us)
        return wrong(r, "the times of a view are wrong");
    for (uint64_t p = 0; p < (uint64_t)r->w * r->h; p++)
        if (r->asked[p] != 1 || coverage_has(&r->look.have, p) == r->failed[p])
            return wrong(r, "a pixel is missing");
    return true;
}

static bool run_one(uint64_t seed, struct run *r)
{
    *r = (struct run){.seed = seed, .slots = 1 + (int32_t)(seed % 5)};
    look_init(&r->look);
    bool good = true;
    for (int round = 0; good && round < 12; round++) {
        for (int i = 0; good && i < 1 + (int)(seed % 40); i++) {
            r->now_us += (int64_t)draw(r, 6000);
            if (round == 1 && i == 0) look_slots(&r->look, r->slots);
            if (look_ready(&r->look, r->now_us) || draw(r, seed % 7 ? 30 : 2) == 0) view(r);
            good = take_due(r) && send_all(r);
            if (good && round == 0 && r->n) good = wrong(r, "a task before there are slots");
        }
        look_slots(&r->look, r->slots);
        good = good && rest(r);
    }
    look_free(&r->look);
    return good;
}

static bool hold(uint64_t seed)
{
    static struct run r;
    if (run_one(seed, &r)) return true;
    print_error("%s\nto repeat: build/unit/test_look %llu\n", r.why, (unsigned long long)seed);
    return false;
}

static void every_seed_holds(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (uint64_t)rounds(150); seed++) assert_true(hold(seed));
}

/* ---- single rules ---------------------------------------------------------------------------- */

/* Renders all tasks that are there, of constant cost. */
static uint64_t work(struct look *l, int64_t *now_us, int64_t us)
{
    static float rgba[4 * 262144];
    struct task t, held[256];
    size_t n = 0;
    uint64_t longest = 0;
    while (n < 256 && look_next(l, *now_us, &t)) held[n++] = t;
    *now_us += us;
    for (size_t i = 0; i < n; i++) {
        if (lattice_count(&held[i].at) > longest) longest = lattice_count(&held[i].at);
        look_done(l, held[i].frame, held[i].id, (int64_t)lattice_count(&held[i].at));
        look_frag(l, &held[i], rgba, *now_us);
    }
    return longest;
}

static void tasks_have_the_measured_length(void **state)
{
    (void)state;
    struct look l;
    int64_t now = 0;
    look_init(&l);
    look_slots(&l, 2);
    look_view(&l, 1, 512, 512, now);
    /* Before anything is measured, both slots share the coarse pass. */
    assert_in_range(work(&l, &now, 10000), LOOK_TASK_LEAST, 16384 / 4);
    while (!look_whole(&l)) work(&l, &now, 10000);
    look_view(&l, 2, 512, 512, now);
    uint64_t most = 0; /* a pixel takes 1 us */
    for (int i = 0; i < 20; i++) {
        const uint64_t longest = work(&l, &now, 10000);
        if (longest > most) most = longest;
    }
    assert_in_range(most, (uint64_t)(.8 * LOOK_TASK_US), (uint64_t)(1.05 * LOOK_TASK_US));
    look_free(&l);
}

/* What is under way of views that were left holds up the next one. */
static void old_tasks_count(void **state)
{
    (void)state;
    struct look l;
    struct task t;
    int sent = 0;
    look_init(&l);
    look_slots(&l, 3);
    for (uint32_t frame = 1; frame < 9; frame++) {
        look_view(&l, frame, 512, 512, frame);
        while (look_next(&l, frame, &t)) sent++;
    }
    assert_int_equal(sent, 2 * 3 * LOOK_DEPTH);
    look_free(&l);
}

/* A trip that took no time is the shortest, and later ones do not replace it at once: many tasks
 * under way would hold up the next view. */
static void a_slow_task_is_no_far_host(void **state)
{
    (void)state;
    struct look l;
    int64_t now = 0;
    look_init(&l);
    look_slots(&l, 2);
    look_view(&l, 1, 512, 512, now);
    while (!look_whole(&l)) work(&l, &now, 0);
    assert_true(l.trip_us <= 0);
    look_view(&l, 2, 512, 512, now);
    work(&l, &now, 100000);
    assert_true(l.trip_us < LOOK_TASK_US * LOOK_DEPTH_MOST);
    look_free(&l);
}

static void a_view_waits_for_the_coarse_picture(void **state)
{
    (void)state;
    struct look l;
    int64_t now = 1000;
    look_init(&l);
    assert_true(look_ready(&l, now));
    look_view(&l, 1, 64, 64, now);
    look_slots(&l, 1);
    assert_false(look_ready(&l, now + 1));
    assert_true(look_ready(&l, now + LOOK_HOLD_US));
    while (!look_coarse(&l)) work(&l, &now, 100);
    assert_false(look_whole(&l));
    assert_true(look_ready(&l, now));
    look_free(&l);
}

static void a_long_trip_needs_more_tasks(void **state)
{
    (void)state;
    struct look l;
    struct task t;
    int64_t now = 0;
    int near = 0, far = 0;
    look_init(&l);
    look_slots(&l, 1);
    look_view(&l, 1, 512, 512, now);
    while (!look_whole(&l)) work(&l, &now, 1);
    look_view(&l, 2, 512, 512, now);
    while (look_next(&l, now, &t)) near++;
    look_free(&l);
    look_init(&l);
    look_slots(&l, 1);
    look_view(&l, 1, 512, 512, now);
    while (!look_whole(&l)) work(&l, &now, 100000);
    look_view(&l, 2, 2048, 2048, now);
    while (look_next(&l, now, &t)) far++;
    look_free(&l);
    assert_int_equal(near, LOOK_DEPTH);
    assert_in_range(far, LOOK_DEPTH + 4, LOOK_DEPTH_MOST);
}

/* ---- moves ----------------------------------------------------------------------------------- */

static const struct look_camera eye = {{0, -10, 0}, {0, 0, 0}, {0, 0, 1}, 90};

static void near_to(struct vec3 a, double x, double y, double z)
{
    const double off = v3_len(v3_sub(a, v3(x, y, z)));
    if (!(off < 1e-9)) fail_msg("%g %g %g, expected %g %g %g", a.x, a.y, a.z, x, y, z);
}

static void the_camera_follows_the_pointer(void **state)
{
    (void)state;
    /* A quarter turn to the right: what was at the left is now in front. */
    struct look_camera c = look_turn(eye, .5, 0);
    near_to(c.from, -10, 0, 0);
    near_to(c.up, 0, 0, 1);
    c = look_turn(eye, 0, .5); /* down: from above */
    near_to(c.from, 0, 0, 10);
    near_to(c.up, 0, 1, 0);
    c = look_turn(look_turn(eye, .3, .2), 0, 0);
    assert_true(fabs(v3_len(c.from) - 10) < 1e-9);
    /* The frame is 20 high at the point: 90 degrees at distance 10. */
    c = look_move(eye, .1, .2);
    near_to(c.at, -2, 0, 4);
    near_to(c.from, -2, -10, 4);
    c = look_centre(eye, .1, .2);
    near_to(c.at, 2, 0, -4);
    c = look_zoom(eye, .5);
    near_to(c.from, 0, -5, 0);
}

int main(int argc, char **argv)
{
    int64_t seed;
    if (argc == 2) return parse_int(argv[1], 0, INT64_MAX, &seed) ? !hold((uint64_t)seed) : 2;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_seed_holds),
        cmocka_unit_test(tasks_have_the_measured_length),
        cmocka_unit_test(old_tasks_count),
        cmocka_unit_test(a_slow_task_is_no_far_host),
        cmocka_unit_test(a_view_waits_for_the_coarse_picture),
        cmocka_unit_test(a_long_trip_needs_more_tasks),
        cmocka_unit_test(the_camera_follows_the_pointer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
