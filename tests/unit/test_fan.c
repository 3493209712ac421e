/*
 * fan: the table of the states of a slot; that its functions follow it; what a connection leaves to
 * the next one; and which tasks are lost. The worker of these slots is cat(1): a test sends what a
 * worker might send, and reads it back.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "coder/coder.h"
#include "fan/fan_int.h"
#include "os/os.h"

#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* ---- the table ---- */

/* One letter for each state, in the order of the enum; a dot: the event cannot happen. */
#define LETTERS ".WOQUCLEG"
static const char *const expected[FAN_SLOT_STATES] = {
    /* start, queue, hello, end of stream, retry, loss, exit, giving up */
    [FAN_NEVER] = "........",
    [FAN_WAITING] = "O......G",
    [FAN_OPENING] = ".QUCLE..",
    [FAN_QUEUED] = "..UCLE..",
    [FAN_UP] = "...CLE..",
    [FAN_CLOSED] = "....LEG.",
    [FAN_LOST] = "......W.",
    [FAN_ENDING] = "......G.",
    [FAN_GONE] = "........",
};

static void each_state_and_event_leads_where_it_should(void **state)
{
    (void)state;
    for (int s = 0; s < FAN_SLOT_STATES; s++) {
        char row[FAN_SLOT_EVENTS + 1] = "";
        for (int e = 0; e < FAN_SLOT_EVENTS; e++)
            row[e] = LETTERS[fan_slot_next((enum fan_slot_state)s, (enum fan_slot_event)e)];
        assert_string_equal(row, expected[s]);
    }
}

/* Marks the states that events lead to, from `from` on. */
static void reach(int from, bool reached[FAN_SLOT_STATES])
{
    if (reached[from]) return;
    reached[from] = true;
    for (int e = 0; e < FAN_SLOT_EVENTS; e++) {
        int to = (int)fan_slot_next((enum fan_slot_state)from, (enum fan_slot_event)e);
        if (to != FAN_NEVER) reach(to, reached);
    }
}

static void every_state_is_reached_and_can_end(void **state)
{
    (void)state;
    bool reached[FAN_SLOT_STATES] = {0};
    reach(FAN_WAITING, reached);
    assert_false(reached[FAN_NEVER]);
    for (int s = FAN_WAITING; s < FAN_SLOT_STATES; s++) {
        bool from[FAN_SLOT_STATES] = {0};
        assert_true(reached[s]);
        reach(s, from);
        assert_true(from[FAN_GONE]);
    }
}

/* ---- a fan of slots on one host ---- */

#define SLOTS 3
static struct fan f;
static struct fan_host host;
static struct fan_slot slots[SLOTS];
static struct host of_file = {.name = (char[]){"far"}, .slots = SLOTS};
static struct hosts hosts = {.at = &of_file, .n = 1, .slots = SLOTS};
static char *worker[] = {(char[]){"cat"}, NULL};
static struct fan_options options = {
    .hosts = &hosts, .command = worker, .pack = FAN_PACK_OFF, .silence_s = 1};
static int messages = -1; /* standard error, while it is not shown */

static void make_slot(struct fan_slot *s, int number)
{
    fan_slot_init(&f, number, number, 1, &host);
    assert_ptr_equal(s, fan_slot_of(&f, number));
}

static int begin(void **state)
{
    (void)state;
    f = (struct fan){.o = &options,
        .n_slots = SLOTS,
        .n_hosts = 1,
        .slots = slots,
        .hosts = &host,
        .n_numbers = SLOTS};
    f.in_open = f.out.greeted = true;
    f.n[FAN_WAITING] = SLOTS;
    f.connecting_most = 100;
    host = (struct fan_host){.host = &of_file, .argv = worker, .by_ssh = true};
    for (int k = 0; k < SLOTS; k++) make_slot(&slots[k], k);
    frames_init(&f.input.frames, sizeof(struct fan_job));
    frames_set(&f.input.frames, 0, 4, 4);
    messages = dup(STDERR_FILENO);
    int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(null, STDERR_FILENO);
    close(null);
    return 0;
}

static int end(void **state)
{
    (void)state;
    dup2(messages, STDERR_FILENO);
    close(messages);
    for (int k = 0; k < SLOTS; k++) {
        fan_slot_disconnect(&f, &slots[k]);
        fan_slot_forget(&slots[k]);
        fan_slot_free(&slots[k]);
    }
    frames_free(&f.input.frames);
    up_free(&f.out.queue);
    return 0;
}

/* What was reported to the reader, as text; and forgets it. */
static const char *reported(void)
{
    static char text[4096];
    size_t n = buf_size(&f.out.queue.bulk);
    assert_true(n < sizeof text);
    if (n) memcpy(text, buf_data(&f.out.queue.bulk), n);
    text[n] = '\0';
    up_free(&f.out.queue);
    return text;
}

/* The worker sends these bytes. */
static void say(struct fan_slot *s, const void *p, size_t n)
{
    assert_int_equal(write_full(s->conn.child.to, p, n), 0);
    struct pollfd ready = {.fd = s->conn.child.from, .events = POLLIN};
    assert_int_equal(poll(&ready, 1, -1), 1);
    fan_slot_listen(&f, s);
}

/* Without alive=1: cat would send back what it is told. */
static void say_hello(struct fan_slot *s)
{
    static const char hello[] = "hello cat 1 format=4 selftest=0123 power=1 slots=1 zstd=1\n";
    say(s, hello, sizeof hello - 1);
}

/* The stream of the worker ends. */
static void hang_up(struct fan_slot *s)
{
    child_close(&s->conn.child.to);
    struct pollfd ready = {.fd = s->conn.child.from, .events = POLLIN};
    assert_int_equal(poll(&ready, 1, -1), 1);
    fan_slot_listen(&f, s);
}

/* Waits until its process has ended. */
static void let_end(struct fan_slot *s)
{
    while (fan_slot_leaves(s)) {
        fan_slot_left(&f, s);
        nanosleep(&(struct timespec){0, 200000}, NULL);
    }
}

/* A task of the input for slot k. */
static void give_task(int k, uint32_t id)
{
    struct record r;
    struct decoder d = {0};
    struct buf b = {0};
    wire_task(&b, &(struct task){.id = id, .at = {0, 0, 4, 1, 1, 1}, .to = k});
    wire_feed(&d, buf_data(&b), buf_size(&b));
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_int_equal(fan_slot_send(&f, k, &r, frames_find(&f.input.frames, 0)), 0);
    wire_free(&d);
    buf_free(&b);
}

/* ---- events that cannot happen ---- */

static void happen(struct fan_slot *s, enum fan_slot_event event)
{
    switch (event) {
    case ON_START: fan_slot_open(&f, s); return;
    case ON_QUEUE: fan_slot_queue(&f, s); return;
    case ON_HELLO: fan_slot_up(&f, s); return;
    case ON_EOF: fan_slot_leave(&f, s); return;
    case ON_RETRY: fan_slot_lose(&f, s, "silent", true); return;
    case ON_LOSS: fan_slot_lose(&f, s, "garbage", false); return;
    case ON_EXIT: fan_slot_left(&f, s); return;
    default: fan_slot_give_up(&f, s, "exit-127"); return;
    }
}

/* Makes the event happen in a process of its own: an internal error must end that. */
static void must_be_refused(struct fan_slot *s, enum fan_slot_event event)
{
    int status;
    char said[256];
    int ends[2];
    assert_int_equal(os_pipe(ends), 0);
    pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        dup2(ends[1], STDERR_FILENO);
        happen(s, event);
        _exit(0);
    }
    close(ends[1]);
    ssize_t n = read(ends[0], said, sizeof said - 1);
    close(ends[0]);
    said[n > 0 ? n : 0] = '\0';
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), ST_SYSTEM);
    assert_non_null(strstr(said, "slot 0: internal error: "));
}

static void what_cannot_happen_is_an_internal_error(void **state)
{
    (void)state;
    for (int s = FAN_WAITING; s < FAN_SLOT_STATES; s++)
        for (int e = 0; e < FAN_SLOT_EVENTS; e++) {
            if (expected[s][e] != '.') continue;
            slots[0].state = (enum fan_slot_state)s;
            must_be_refused(&slots[0], (enum fan_slot_event)e);
        }
    slots[0].state = FAN_WAITING;
}

/* ---- lives of slots ---- */

static void a_second_hello_is_refused(void **state)
{
    (void)state;
    struct fan_slot *s = &slots[0];
    fan_slot_open(&f, s);
    assert_int_equal(s->state, FAN_OPENING);
    say_hello(s);
    assert_int_equal(s->state, FAN_UP);
    assert_non_null(strstr(reported(), "up w=0 host=far power=1 slots=1 "));
    say_hello(s);
    assert_int_equal(s->state, FAN_ENDING);
    assert_non_null(strstr(reported(), "gone w=0 why=second-hello lost=0"));
    let_end(s);
    assert_int_equal(s->state, FAN_GONE);
}

/* ---- slow links ---- */

/* What fan sent comes back, because the worker is cat(1); here it is lost. */
static void drop_echo(struct fan_slot *s)
{
    char text[128];
    struct pollfd ready = {.fd = s->conn.child.from, .events = POLLIN};
    assert_true(s->conn.probe_bytes > 0);
    assert_int_equal(poll(&ready, 1, -1), 1);
    assert_true(read(s->conn.child.from, text, sizeof text) > 0);
}

/* The worker answers with this number of bytes, after this time on the clock of fan. */
static void answer(struct fan_slot *s, size_t bytes, int64_t us)
{
    struct buf b = {0};
    wire_probe(&b, bytes, NULL);
    const unsigned char *at = buf_data(&b);
    size_t left = buf_size(&b), before = s->conn.probe_bytes;
    while (left) {
        size_t some = left < 4096 ? left : 4096;
        s->conn.probe_us = now_us() - us;
        say(s, at, some);
        at += some;
        left -= some;
    }
    struct pollfd ready = {.fd = s->conn.child.from, .events = POLLIN};
    while (before == bytes && s->conn.probe_bytes == before) {
        assert_int_equal(poll(&ready, 1, -1), 1);
        fan_slot_listen(&f, s);
    }
    buf_free(&b);
}

static bool packs(const struct fan_slot *s)
{
    static const char line[] = "code zstd=1 ";
    bool told = buf_size(&s->feed.queue.bytes) > sizeof line &&
                memcmp(buf_data(&s->feed.queue.bytes), line, sizeof line - 1) == 0;
    assert_int_equal(told, s->feed.queue.packs);
    return told;
}

static struct fan_slot *connected(enum fan_pack pack)
{
    struct fan_slot *s = &slots[0];
    options.pack = pack;
    fan_slot_open(&f, s);
    say_hello(s);
    options.pack = FAN_PACK_OFF;
    return s;
}

#define HOUR_US INT64_C(3600000000)

static void a_slow_link_is_packed(void **state)
{
    (void)state;
    if (!coder_there()) skip();
    struct fan_slot *s = connected(FAN_PACK_AUTO);
    assert_int_equal(s->state, FAN_OPENING);
    assert_int_equal(s->conn.probe_bytes, 16384);
    drop_echo(s);
    answer(s, 16384, HOUR_US);
    assert_int_equal(s->state, FAN_UP);
    assert_true(packs(s));
}

static void a_fast_link_is_probed_further_and_stays_plain(void **state)
{
    (void)state;
    if (!coder_there()) skip();
    struct fan_slot *s = connected(FAN_PACK_AUTO);
    for (size_t bytes = 16384; bytes <= 1 << 20; bytes *= 8) {
        assert_int_equal(s->state, FAN_OPENING);
        assert_int_equal(s->conn.probe_bytes, bytes);
        drop_echo(s);
        answer(s, bytes, -HOUR_US); /* it takes no time at all */
    }
    assert_int_equal(s->state, FAN_UP);
    assert_false(packs(s));
}

static void a_link_without_an_answer_is_slow(void **state)
{
    (void)state;
    if (!coder_there()) skip();
    struct fan_slot *s = connected(FAN_PACK_AUTO);
    drop_echo(s);
    fan_code_late(&f, s, s->conn.probe_us + 1000000);
    assert_int_equal(s->state, FAN_OPENING);
    fan_code_late(&f, s, s->conn.probe_us + 3000000);
    assert_int_equal(s->state, FAN_UP);
    assert_true(packs(s));
    answer(s, 16384, 0);
    assert_int_equal(s->state, FAN_UP);
    answer(s, 16384, 0); /* a second one */
    assert_non_null(strstr(reported(), "gone w=0 why=wrong-record lost=0"));
}

static void an_answer_of_another_length_is_refused(void **state)
{
    (void)state;
    if (!coder_there()) skip();
    struct fan_slot *s = connected(FAN_PACK_AUTO);
    drop_echo(s);
    answer(s, 1024, 0);
    assert_int_equal(s->state, FAN_ENDING);
    assert_non_null(strstr(reported(), "gone w=0 why=wrong-record lost=0"));
}

static void records_are_packed_on_demand_without_a_probe(void **state)
{
    (void)state;
    if (!coder_there()) skip();
    struct fan_slot *s = connected(FAN_PACK_ON);
    assert_int_equal(s->state, FAN_UP);
    assert_int_equal(s->conn.probe_bytes, 0);
    assert_true(packs(s));
}

static void nothing_is_packed_for_a_worker_that_cannot(void **state)
{
    static const char hello[] = "hello cat 1 format=4 selftest=0123 power=1 slots=1\n";
    (void)state;
    struct fan_slot *s = &slots[0];
    options.pack = FAN_PACK_ON;
    fan_slot_open(&f, s);
    say(s, hello, sizeof hello - 1);
    options.pack = FAN_PACK_OFF;
    assert_int_equal(s->state, FAN_UP);
    assert_false(packs(s));
}

static void nothing_is_packed_on_this_machine(void **state)
{
    (void)state;
    host.here = true;
    struct fan_slot *s = connected(FAN_PACK_ON);
    assert_int_equal(s->state, FAN_UP);
    assert_false(packs(s));
}

static void nothing_is_packed_without_leave(void **state)
{
    (void)state;
    struct fan_slot *s = connected(FAN_PACK_OFF);
    assert_int_equal(s->state, FAN_UP);
    assert_false(packs(s));
    answer(s, 8, 0);
    assert_non_null(strstr(reported(), "gone w=0 why=garbage lost=0"));
}

static void assert_no_connection(const struct connection *c)
{
    assert_int_equal(c->child.pid, 0);
    assert_int_equal(c->child.to, -1);
    assert_int_equal(c->child.from, -1);
    assert_int_equal(c->child.err, -1);
    assert_null(c->from.in.data);
    assert_true(c->from.upward);
    assert_false(c->from.ended);
    assert_null(c->err.data);
    assert_null(c->held.data);
    assert_null(c->refusal);
    assert_string_equal(c->detail, "");
    assert_string_equal(c->chatter, "");
    assert_int_equal((int64_t)c->before_hello | (int64_t)c->poll | c->opened_us | c->heard_us, 0);
    assert_int_equal(c->leave_us | c->beat_us | c->closed_us | c->ahead | c->stale, 0);
    assert_int_equal(c->news | c->answers, 0);
    assert_false(c->connected || c->announced_frame || c->completed_task);
    assert_false(c->placed || c->input_closed_first);
}

static void a_connection_leaves_nothing_to_the_next(void **state)
{
    (void)state;
    static const char words[] = "ssh: connect to host far port 22: Connection refused";
    struct fan_slot *s = &slots[0];
    fan_slot_open(&f, s);
    say(s, "welcome to far\n", 15);
    assert_string_equal(s->conn.chatter, "welcome to far");
    assert_true(fan_refusal_holds(&f, s, words, sizeof words - 1));
    assert_non_null(s->conn.refusal);
    say_hello(s);
    assert_int_equal(s->state, FAN_UP);
    buf_append(&s->conn.held, words, sizeof words - 1);
    say(s, "frag", 4); /* an incomplete record */
    buf_append(&s->conn.err, "an incomplete line", 18);
    struct connection *c = &s->conn;
    c->announced_frame = c->completed_task = c->placed = c->input_closed_first = true;
    c->poll = c->before_hello = 2;
    c->ahead = c->stale = c->answers = 3;
    c->news = 3;
    c->beat_us = c->closed_us = c->leave_us = 4;
    fan_slot_lose(&f, s, "silent", true);
    assert_int_equal(s->state, FAN_LOST);
    let_end(s);
    assert_int_equal(s->state, FAN_WAITING);
    assert_no_connection(&s->conn);
    assert_int_equal(s->failures, 1);
    assert_true(s->was_up && s->told_gone);
    fan_slot_open(&f, s);
    assert_true(s->conn.opened_us && s->conn.heard_us == s->conn.opened_us);
    assert_int_equal(s->conn.ahead, 0);
    say_hello(s);
    assert_int_equal(s->state, FAN_UP);
    assert_false(s->told_gone);
}

static void tasks_wait_for_a_slot_that_was_never_up(void **state)
{
    (void)state;
    struct fan_slot *s = &slots[0];
    give_task(0, 1);
    give_task(0, 2);
    assert_no_connection(&s->conn);
    fan_slot_open(&f, s);
    fan_slot_lose(&f, s, "no-hello", true);
    give_task(0, 3);
    let_end(s);
    assert_int_equal(s->state, FAN_WAITING);
    assert_true(s->feed.primed);
    assert_int_equal(s->n_tasks, 3);
    assert_int_equal(f.lost, 0);
    fan_slot_open(&f, s);
    assert_int_equal(s->conn.ahead, 0);
    fan_slot_lose(&f, s, "garbage", false);
    assert_int_equal(f.lost, 3);
    assert_int_equal(s->n_tasks, 0);
    assert_false(s->feed.primed);
    assert_int_equal(s->state, FAN_ENDING);
    give_task(0, 4); /* was under way when the slot was lost */
    assert_int_equal(f.lost, 4);
    let_end(s);
    assert_int_equal(s->state, FAN_GONE);
    give_task(0, 5);
    assert_int_equal(f.lost, 5);
    assert_int_equal(f.n[FAN_GONE], SLOTS); /* its host cannot be used */
}

static void a_worker_that_ends_as_told_ends_well(void **state)
{
    (void)state;
    f.in_open = false;
    for (int tasks = 0; tasks <= 1; tasks++) {
        struct fan_slot *s = &slots[tasks];
        fan_slot_open(&f, s);
        say_hello(s);
        for (int i = 0; i < tasks; i++) give_task(1, (uint32_t)i);
        hang_up(s);
        assert_int_equal(s->state, FAN_CLOSED);
        assert_true(fan_slot_comes(s));
        s->conn.leave_us = INT64_MAX; /* however long this machine takes */
        let_end(s);
        assert_int_equal(s->state, FAN_GONE);
        assert_int_equal(f.well, 1); /* the one without tasks */
        assert_int_equal(f.lost, tasks);
    }
}

static void assert_no_connection_waits(const enum fan_slot_state states[SLOTS])
{
    fan_connect(&f);
    for (int k = 0; k < SLOTS; k++) assert_int_equal(slots[k].state, states[k]);
}

/* Its other slots have their turn; they were reported, so that no policy waits for them. */
static void a_queued_slot_delays_no_other(void **state)
{
    (void)state;
    of_file.wait_s = 3600;
    f.connecting = 100; /* on hosts without wait= */
    assert_no_connection_waits((enum fan_slot_state[SLOTS]){FAN_OPENING, FAN_WAITING, FAN_WAITING});
    fan_slot_queue(&f, &slots[0]);
    const char *said = reported();
    for (int k = 0; k < SLOTS; k++) {
        char gone[40];
        snprintf(gone, sizeof gone, "gone w=%d why=queued lost=0", k);
        assert_non_null(strstr(said, gone));
    }
    assert_no_connection_waits((enum fan_slot_state[SLOTS]){FAN_QUEUED, FAN_OPENING, FAN_WAITING});
    say_hello(&slots[0]);
    assert_non_null(strstr(reported(), "up w=0"));
    assert_no_connection_waits((enum fan_slot_state[SLOTS]){FAN_UP, FAN_OPENING, FAN_OPENING});
    fan_slot_queue(&f, &slots[1]);
    assert_string_equal(reported(), ""); /* it was reported before */
    assert_int_equal(f.connecting, 100);
    of_file.wait_s = 0;
}

/* One connection of slot 0: it is sent a task or not, and its process ends with this status. */
static enum fan_slot_state state_after(int tasks, const char *command)
{
    struct fan_slot *s = &slots[0];
    char *argv[] = {(char[]){"sh"}, (char[]){"-c"}, NULL, NULL};
    argv[2] = xstrdup(command);
    host.argv = argv;
    fan_slot_open(&f, s);
    say_hello(s);
    assert_int_equal(s->state, FAN_UP);
    for (int i = 0; i < tasks; i++) give_task(0, (uint32_t)i);
    hang_up(s);
    s->conn.leave_us = INT64_MAX;
    let_end(s);
    free(argv[2]);
    host.argv = worker;
    return s->state;
}

/* `cat` echoes the hello; at the end of its input the shell exits. */
static void a_status_tells_whether_another_try_may_help(void **state)
{
    (void)state;
    assert_int_equal(state_after(0, "cat; exit 255"), FAN_WAITING);
    assert_int_equal(state_after(1, "cat; exit 1"), FAN_WAITING);
    assert_int_equal(f.lost, 1);
    assert_int_equal(state_after(0, "cat; exit 9"), FAN_WAITING); /* its host was sent tasks */
    assert_int_equal(state_after(0, "cat"), FAN_WAITING);
    assert_int_equal(state_after(1, "cat; kill -9 $$"), FAN_WAITING);
    assert_int_equal(state_after(1, "cat; exit 127"), FAN_GONE);
}

static void before_it_has_tasks_most_statuses_are_final(void **state)
{
    (void)state;
    assert_int_equal(state_after(0, "cat; exit 1"), FAN_GONE);
}

/* Another launcher than ssh has no status for its own failures. */
static void a_container_may_start_late(void **state)
{
    (void)state;
    static const struct row {
        bool by_ssh;
        const char *command;
        enum fan_slot_state then;
    } rows[] = {{false, "exit 1", FAN_WAITING}, {false, "exit 125", FAN_WAITING},
        {true, "exit 255", FAN_WAITING}, {true, "exit 1", FAN_GONE}};
    f.in_open = false; /* its tasks wait for it */
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct fan_slot *s = &slots[0];
        char *argv[] = {(char[]){"sh"}, (char[]){"-c"}, NULL, NULL};
        argv[2] = xstrdup(rows[i].command);
        host.argv = argv;
        host.by_ssh = rows[i].by_ssh;
        fan_slot_open(&f, s);
        hang_up(s);
        s->conn.leave_us = INT64_MAX;
        let_end(s);
        assert_int_equal(s->state, rows[i].then);
        free(argv[2]);
        host.argv = worker;
    }
}

static void a_container_may_restart_before_it_has_tasks(void **state)
{
    (void)state;
    host.by_ssh = false;
    assert_int_equal(state_after(0, "cat; exit 137"), FAN_WAITING);
    assert_int_equal(state_after(0, "cat; exit 126"), FAN_GONE);
}

#define ROOM 20 /* hosts */

static void hosts_wait_for_each_other_only_behind_one_jump_host(void **state)
{
    (void)state;
    static struct fan_host many[ROOM];
    static struct fan_slot each[ROOM];
    struct fan_jump jump = {.name = (char[]){"bastion"}};
    f.slots = each;
    f.hosts = many;
    f.jumps = &jump;
    f.n_jumps = 1;
    f.n_slots = f.n_hosts = f.n_numbers = ROOM;
    for (int through = 0; through <= 1; through++) {
        memset(f.n, 0, sizeof f.n);
        f.n[FAN_WAITING] = ROOM;
        f.connecting = 0;
        for (int k = 0; k < ROOM; k++) {
            many[k] = (struct fan_host){
                .host = &of_file, .argv = worker, .by_ssh = true, .asked = true, .jump = through};
            fan_slot_init(&f, k, k, 1, &many[k]);
        }
        for (int i = 0; i < ROOM; i++) fan_connect(&f);
        assert_int_equal(f.n[FAN_OPENING], through ? 8 : ROOM);
        for (int k = 0; k < ROOM; k++) {
            fan_slot_disconnect(&f, &each[k]);
            fan_slot_free(&each[k]);
        }
    }
    f.jumps = NULL;
}

/* Ten minutes, for a switch that restarts. */
static void hosts_that_were_all_up_are_waited_for(void **state)
{
    (void)state;
    assert_int_equal(fan_patience_us(&f), PATIENCE_UNREACHED_US);
    fan_slot_open(&f, &slots[0]);
    say_hello(&slots[0]);
    assert_int_equal(fan_patience_us(&f), PATIENCE_RETURN_US);
    struct fan_host other = {.host = &of_file, .argv = worker};
    slots[1].host = &other; /* it was never up */
    assert_int_equal(fan_patience_us(&f), PATIENCE_UNREACHED_US);
    fan_slot_give_up(&f, &slots[1], "exit-127");
    assert_int_equal(fan_patience_us(&f), PATIENCE_RETURN_US);
    slots[1].host = &host;
}

static void the_last_try_is_the_last(void **state)
{
    (void)state;
    of_file.tries = 3;
    for (int i = 1; i < 3; i++) assert_int_equal(state_after(1, "cat; exit 1"), FAN_WAITING);
    assert_int_equal(state_after(1, "cat; exit 1"), FAN_GONE);
    for (int i = 1; i <= 3; i++) {
        assert_int_equal(slots[1].state, FAN_WAITING);
        fan_slot_open(&f, &slots[1]);
        fan_slot_lose(&f, &slots[1], "no-hello", true);
        let_end(&slots[1]);
    }
    assert_int_equal(slots[1].state, FAN_GONE);
    assert_int_equal(slots[2].state, FAN_GONE); /* with its host */
    of_file.tries = 0;
}

/* ---- a hosts file that changes ---- */

/* Makes this text the new version of the hosts file, and lets the fan look twice. */
static void change_file(const char *text)
{
    char path[] = "/tmp/hosts.XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write_full(fd, text, strlen(text)), 0);
    close(fd);
    f.watch.file = path;
    for (int look = 0; look < 2; look++) {
        f.watch.look_us = 0;
        fan_join(&f);
    }
    unlink(path);
}

static void slots_without_a_line_drain(void **state)
{
    (void)state;
    fan_slot_open(&f, &slots[0]);
    say_hello(&slots[0]);
    fan_slot_open(&f, &slots[1]);
    say_hello(&slots[1]);
    give_task(1, 7);
    fan_slot_open(&f, &slots[2]);
    reported();
    change_file("far slots=1\n");
    assert_string_equal(reported(), ""); /* no policy has said that slots may leave */
    f.joins = true;
    change_file("far slots=0\n");
    assert_string_equal(reported(), "");
    change_file("far slots=1 power=3\n");
    const char *said = reported();
    assert_non_null(strstr(said, "drain w=1 "));
    assert_non_null(strstr(said, "gone w=2 why=left lost=0"));
    assert_non_null(strstr(said, "up w=0 host=far power=3 "));
    assert_null(strstr(said, "gone w=0"));
    assert_null(strstr(said, "drain w=0"));
    assert_int_equal(slots[2].state, FAN_ENDING);
    assert_int_equal(fan_staff(&f), 1);
    assert_true(slots[0].power == 3);
    let_end(&slots[2]);
    fan_dismiss(&f, 0); /* it does not drain */
    assert_false(fan_slot_over(&f, &slots[0]));
    assert_false(fan_slot_over(&f, &slots[1]));
    give_task(1, 8); /* the policy had not read `drain` */
    assert_int_equal(f.lost, 0);
    assert_int_equal(slots[1].n_tasks, 2);
    change_file("far slots=1 power=3\n");
    change_file("far slots=1 power=4\n");
    said = reported();
    assert_non_null(strstr(said, "up w=0 host=far power=4 "));
    assert_null(strstr(said, "up w=0 host=far power=3 "));
    assert_null(strstr(said, "up w=1 "));
    fan_dismiss(&f, 1); /* its task was given to another slot */
    assert_int_equal(slots[1].state, FAN_ENDING);
    assert_non_null(strstr(reported(), "gone w=1 why=left lost=0"));
    assert_int_equal(f.lost, 0);
    give_task(1, 9); /* too late */
    assert_int_equal(f.lost, 1);
    let_end(&slots[1]);
    for (int i = 0; i < f.n_versions; i++) hosts_free(&f.versions[i]);
    free(f.versions);
}

static void a_slot_that_was_lost_and_drains_is_given_up(void **state)
{
    (void)state;
    f.joins = true;
    fan_slot_open(&f, &slots[2]);
    say_hello(&slots[2]);
    fan_slot_lose(&f, &slots[2], "silent", true);
    fan_slot_open(&f, &slots[1]);
    say_hello(&slots[1]);
    change_file("far slots=1\n");
    assert_int_equal(slots[1].state, FAN_UP);
    fan_slot_lose(&f, &slots[1], "silent", true); /* it is not connected again */
    assert_int_equal(slots[1].state, FAN_ENDING);
    let_end(&slots[1]);
    fan_slot_open(&f, &slots[0]);
    say_hello(&slots[0]);
    assert_int_equal(slots[2].state, FAN_LOST);
    let_end(&slots[2]);
    assert_int_equal(slots[2].state, FAN_GONE);
    for (int i = 0; i < f.n_versions; i++) hosts_free(&f.versions[i]);
    free(f.versions);
}

/* ---- anything that a worker may send ---- */

static const char *const bits[] = {"hello cat 1 format=4 selftest=0123 power=1\n", "bye\n",
    "beat\n", "frame 0 4 4 job=1\n", "done 0 1 cpu_us=1 wall_us=1\n", "gone w=0\n", "up w=0\n",
    "ask to=1\n", "task 0 1 0 0 4 1 1 1\n", "scene bytes=3\nabc\n", "flush\n", "none\n", "\n",
    "drain w=0\n", "joins\n", "leave to=0\n", "alive within=1\n", "\377\0", "frag 0 1"};

/* The counts of states and of connections agree with the slots. */
static void assert_counted(void)
{
    int n[FAN_SLOT_STATES] = {0}, opening = 0;
    for (int k = 0; k < SLOTS; k++) {
        const struct fan_slot *s = &slots[k];
        n[s->state]++;
        opening += s->state == FAN_OPENING || (fan_slot_leaves(s) && !s->conn.connected);
        if (s->state == FAN_UP) assert_true(s->conn.connected);
        if (s->state == FAN_WAITING || s->state == FAN_GONE) assert_no_connection(&s->conn);
    }
    assert_memory_equal(n, f.n, sizeof n);
    assert_int_equal(host.opening, opening);
    assert_int_equal(f.connecting, opening);
}

static void one_step(struct fan_slot *s, uint64_t dice)
{
    const char *text = bits[dice / 16 % (sizeof bits / sizeof *bits)];
    struct buf b = {0};
    switch (dice % 16) {
    case 0: give_task(s->number, (uint32_t)(dice / 16 % 9)); break;
    case 1:
        if (fan_slot_has_stream(s)) hang_up(s);
        break;
    case 2:
        if (fan_slot_has_stream(s)) fan_slot_lose(&f, s, "silent", true);
        break;
    case 3:
        if (s->state == FAN_OPENING) fan_slot_queue(&f, s);
        break;
    case 4:
    case 5:
    case 6:
        if (s->state == FAN_OPENING || s->state == FAN_QUEUED) say_hello(s);
        break;
    default:
        buf_append(&b, text, strlen(text));
        if (dice / 4096 % 2) wire_seal(&b, 0);
        if (fan_slot_has_stream(s)) say(s, buf_data(&b), buf_size(&b));
        buf_free(&b);
    }
}

/* Most of what it sends is wrong, and ends the slot; then another begins. */
static void no_worker_breaks_the_table(void **state)
{
    (void)state;
    bool seen[FAN_SLOT_STATES] = {0};
    for (uint64_t i = 0; i < 1500; i++) {
        uint64_t dice = rng_u64(7, i);
        struct fan_slot *s = &slots[dice % SLOTS];
        seen[s->state] = true;
        if (s->state == FAN_WAITING) {
            fan_slot_open(&f, s);
        } else if (s->state == FAN_GONE) {
            f.n[FAN_GONE]--, f.n[FAN_WAITING]++;
            fan_slot_free(s);
            make_slot(s, s->number);
        } else if (fan_slot_leaves(s) && dice / 8 % 2) {
            let_end(s);
        } else {
            one_step(s, dice / 8);
        }
        assert_counted();
        up_free(&f.out.queue);
    }
    for (int s = FAN_WAITING; s < FAN_SLOT_STATES; s++) assert_true(seen[s]);
}

/* ---- programs for a host that has none ---- */

static const char *request(struct fan_slot *s, const char *text)
{
    return fan_take_requests(s, (const unsigned char *)text, strlen(text));
}

static void a_host_gets_each_program_once(void **state)
{
    (void)state;
    struct hosts_program programs[] = {
        {.name = (char[]){"one"}, .sha256 = "aa"}, {.name = (char[]){"two"}, .sha256 = "bb"}};
    const struct hosts_sent sent = {programs, 2};
    struct fan_slot *s = &slots[0];
    buf_append(&programs[0].bytes, "11111", 5);
    buf_append(&programs[1].bytes, "22", 2);
    fan_slot_open(&f, s);
    assert_null(request(s, "stormring-send need aa\n"));
    assert_false(fan_slot_has_asked(s)); /* it has programs of its own */
    of_file.sent = &sent;
    assert_null(request(s, "Welcome\nno stormring-send need aa\nstormring-se"));
    assert_false(fan_slot_has_asked(s));
    assert_null(request(s, "nd need bb\nand more\n"));
    assert_true(fan_slot_is_sent(s));
    assert_int_equal(down_size(&s->conn.sending.queue), 2);
    assert_null(request(s, "stormring-send need aa\n"));
    assert_int_equal(down_size(&s->conn.sending.queue), 7);
    assert_string_equal(request(s, "stormring-send need bb\n"), "wrong-request");
    assert_string_equal(request(s, "stormring-send need b\n"), "wrong-request");
    assert_string_equal(request(s, "stormring-send give aa\n"), "wrong-request");
    assert_string_equal(request(s, "stormring-send no \033disk\nstormring-send no\n"), "not-sent");
    assert_string_equal(s->conn.detail, "?disk");
    fan_slot_lose(&f, s, "not-sent", true);
    let_end(s);
    assert_false(fan_slot_has_asked(s));
    assert_int_equal(down_size(&s->conn.sending.queue), 0);
    fan_slot_open(&f, s);
    assert_null(request(s, "stormring-send need bb\n")); /* for each connection */
    fan_slot_up(&f, s);
    assert_null(request(s, "stormring-send need aa\n")); /* these are records now */
    assert_false(fan_slot_is_sent(s));
    of_file.sent = NULL;
    buf_free(&programs[0].bytes);
    buf_free(&programs[1].bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_state_and_event_leads_where_it_should),
        cmocka_unit_test(every_state_is_reached_and_can_end),
        cmocka_unit_test_setup_teardown(what_cannot_happen_is_an_internal_error, begin, end),
        cmocka_unit_test_setup_teardown(a_second_hello_is_refused, begin, end),
        cmocka_unit_test_setup_teardown(a_slow_link_is_packed, begin, end),
        cmocka_unit_test_setup_teardown(a_fast_link_is_probed_further_and_stays_plain, begin, end),
        cmocka_unit_test_setup_teardown(a_link_without_an_answer_is_slow, begin, end),
        cmocka_unit_test_setup_teardown(an_answer_of_another_length_is_refused, begin, end),
        cmocka_unit_test_setup_teardown(records_are_packed_on_demand_without_a_probe, begin, end),
        cmocka_unit_test_setup_teardown(nothing_is_packed_for_a_worker_that_cannot, begin, end),
        cmocka_unit_test_setup_teardown(nothing_is_packed_on_this_machine, begin, end),
        cmocka_unit_test_setup_teardown(nothing_is_packed_without_leave, begin, end),
        cmocka_unit_test_setup_teardown(a_connection_leaves_nothing_to_the_next, begin, end),
        cmocka_unit_test_setup_teardown(tasks_wait_for_a_slot_that_was_never_up, begin, end),
        cmocka_unit_test_setup_teardown(a_worker_that_ends_as_told_ends_well, begin, end),
        cmocka_unit_test_setup_teardown(a_queued_slot_delays_no_other, begin, end),
        cmocka_unit_test_setup_teardown(a_status_tells_whether_another_try_may_help, begin, end),
        cmocka_unit_test_setup_teardown(before_it_has_tasks_most_statuses_are_final, begin, end),
        cmocka_unit_test_setup_teardown(a_container_may_start_late, begin, end),
        cmocka_unit_test_setup_teardown(a_container_may_restart_before_it_has_tasks, begin, end),
        cmocka_unit_test_setup_teardown(
            hosts_wait_for_each_other_only_behind_one_jump_host, begin, end),
        cmocka_unit_test_setup_teardown(hosts_that_were_all_up_are_waited_for, begin, end),
        cmocka_unit_test_setup_teardown(the_last_try_is_the_last, begin, end),
        cmocka_unit_test_setup_teardown(slots_without_a_line_drain, begin, end),
        cmocka_unit_test_setup_teardown(a_slot_that_was_lost_and_drains_is_given_up, begin, end),
        cmocka_unit_test_setup_teardown(a_host_gets_each_program_once, begin, end),
        cmocka_unit_test_setup_teardown(no_worker_breaks_the_table, begin, end),
    };
    signals_catch();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
