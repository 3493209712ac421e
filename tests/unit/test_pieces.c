/* sched: pieces of tasks: their pixels, numbers and lists; and the hub of a ring without numbers
 * for them. */
#include "sched/pieces.h"
#include "sched/sched.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define FRAME_W 16

struct entry {
    struct piece piece;
    int32_t more;
};
static struct task_table ledger;
static struct frames ids;

static int begin(void **state)
{
    (void)state;
    tasks_init(&ledger, sizeof(struct entry));
    frames_init(&ids, PIECES_ID);
    return 0;
}

static int end(void **state)
{
    (void)state;
    tasks_free(&ledger);
    frames_free(&ids);
    return 0;
}

static int32_t enter(uint32_t id, struct lattice at)
{
    const struct task t = {.id = id, .at = at, .to = -1};
    int32_t i = tasks_add(&ledger, &t, FRAME_W);
    *pieces_at(&ledger, i) = PIECE_OF_NONE;
    pieces_note_id(&ids, &t);
    return i;
}

static void assert_lattice(const struct lattice *at, struct lattice expected)
{
    assert_memory_equal(at, &expected, sizeof expected);
}

static void pieces_cover_what_is_missing(void **state)
{
    (void)state;
    int32_t row = enter(3, (struct lattice){2, 5, 10, 1, 1, 1});
    int32_t rows = enter(7, (struct lattice){0, 6, 4, 6, 1, 1});
    ledger.at[row].delivered = 3;
    ledger.at[rows].delivered = 8;
    struct lattice at = pieces_missing(&ledger.at[row]);
    assert_lattice(&at, (struct lattice){5, 5, 7, 1, 1, 1});
    int32_t rest = pieces_add(&ledger, &ids, row, &at), first = pieces_cut(&ledger, &ids, rest, 4);
    assert_lattice(&ledger.at[first].task.at, (struct lattice){5, 5, 4, 1, 1, 1});
    assert_lattice(&ledger.at[rest].task.at, (struct lattice){9, 5, 3, 1, 1, 1});
    at = pieces_missing(&ledger.at[rows]);
    assert_lattice(&at, ledger.at[rows].task.at);
    rest = pieces_add(&ledger, &ids, rows, &at);
    first = pieces_cut(&ledger, &ids, rest, pieces_rows(&at, 11));
    assert_lattice(&ledger.at[first].task.at, (struct lattice){0, 6, 4, 2, 1, 1});
    assert_lattice(&ledger.at[rest].task.at, (struct lattice){0, 8, 4, 4, 1, 1});
    assert_int_equal(pieces_rows(&at, 1), 4);
}

static void numbers_are_above_those_of_the_input(void **state)
{
    (void)state;
    const struct lattice at = {0, 0, 8, 1, 1, 1};
    int32_t low = enter(2, at), high = enter(9, at);
    int32_t a = pieces_add(&ledger, &ids, low, &at), b = pieces_cut(&ledger, &ids, a, 3);
    int32_t c = pieces_add(&ledger, &ids, b, &at);
    assert_int_equal(ledger.at[a].task.id, 10);
    assert_int_equal(ledger.at[b].task.id, 11);
    assert_int_equal(ledger.at[c].task.id, 12);
    assert_int_equal(pieces_came_as(&ledger, c), 2);
    assert_int_equal(pieces_came_as(&ledger, high), 9);
    assert_true(pieces_id_left(&ids, &ledger.at[high].task));
    enter(UINT32_MAX - 1, at);
    assert_false(pieces_id_left(&ids, &ledger.at[low].task));
}

static void pieces_leave_before_their_task(void **state)
{
    (void)state;
    const struct lattice at = {0, 0, 8, 1, 1, 1};
    int32_t i = enter(0, at), left = 0, j;
    int32_t a = pieces_add(&ledger, &ids, i, &at), b = pieces_cut(&ledger, &ids, a, 5);
    int32_t c = pieces_cut(&ledger, &ids, a, 1);
    pieces_add(&ledger, &ids, b, &at);
    pieces_remove(&ledger, c); /* the first of the list; then one within */
    assert_true(pieces_exist(&ledger, i));
    for (; (j = pieces_leaf(&ledger, i)) >= 0; left++) {
        assert_false(pieces_exist(&ledger, j));
        pieces_remove(&ledger, j);
    }
    assert_int_equal(left, 3);
    assert_int_equal(ledger.count, 1);
    assert_false(pieces_exist(&ledger, i));
}

static void a_share_is_a_number_of_pixels(void **state)
{
    (void)state;
    assert_int_equal(pieces_px(5000, 1000, 10, 1e6), 500);
    assert_int_equal(pieces_px(-5000, 1000, 10, 1e6), 100); /* at least the least time, */
    assert_int_equal(pieces_px(5, 1, 10, 1e6), 1);          /* and a pixel */
    assert_int_equal(pieces_px((double)INFINITY, 1000, 10, 70), 70);
    assert_int_equal(pieces_px(5000, 1000, 0, 70), 70); /* not known */
}

/* Node 1 has one long row, of this id, since 1 s; node 0 asks at the end. The piece that it gets;
 * -1: none. */
static int64_t piece_of(uint32_t id)
{
    struct sched_actions acts = {0};
    int64_t piece = -1;
    struct sched_event rows[2] = {{.kind = SCHED_TASK, .frame_w = 6000}, {0}};
    void *hub = policy_ring.create(&(struct sched_params){.endgame = true});
    rows[0].task = (struct task){.id = 0, .at = {0, 0, 6000, 1, 1, 1}, .to = 1};
    rows[1] = rows[0];
    rows[1].task.id = id;
    const struct sched_event done = {
        .kind = SCHED_DONE, .slot = 1, .task = rows[0].task, .wall_us = 1000000};
    const struct sched_event events[] = {{.kind = SCHED_SLOTS, .n = 2},
        {.kind = SCHED_UP, .slot = 0}, {.kind = SCHED_UP, .slot = 1}, rows[0], rows[1], done,
        {.kind = SCHED_INPUT_END},
        {.kind = SCHED_RING, .slot = 0, .ring = {.kind = RING_ASK, .peer = -1}}};
    for (size_t i = 0; i < sizeof events / sizeof *events; i++) {
        acts.n = 0;
        policy_ring.step(hub, &events[i], 1000000 * (int64_t)i, &acts);
    }
    for (size_t i = 0; i < acts.n; i++)
        if (acts.at[i].kind == SCHED_GIVE && acts.at[i].slot == 0) piece = acts.at[i].task.id;
    policy_ring.destroy(hub);
    free(acts.at);
    return piece;
}

static void the_hub_cuts_no_task_without_a_number_for_its_piece(void **state)
{
    (void)state;
    assert_in_range(piece_of(5), 6, 9);
    assert_int_equal(piece_of(UINT32_MAX), -1);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, begin, end)
int main(void)
{
    const struct CMUnitTest tests[] = {TEST(pieces_cover_what_is_missing),
        TEST(numbers_are_above_those_of_the_input), TEST(pieces_leave_before_their_task),
        TEST(a_share_is_a_number_of_pixels),
        TEST(the_hub_cuts_no_task_without_a_number_for_its_piece)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
