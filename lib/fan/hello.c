/*
 * fan: accepts or refuses workers. The pictures of all slots must have the same bits. So each hello
 * must agree with the first in program, version and self-test. If a slot is on another machine, the
 * first hello is that of a worker on this machine, before any other is read.
 */
#include "fan/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#define POWER_LEAST 1e-6
#define POWER_MOST 1e9 /* an inner fan: the sum of its slots */

/* "PROGRAM VERSION" of a hello, which has both. */
static void program_of(const struct record *r, char text[64])
{
    const char *at = r->line + strlen(rec_name(REC_HELLO)) + 1, *end = r->line + r->line_len;
    const char *space = memchr(at, ' ', (size_t)(end - at));
    const char *stop = space ? memchr(space + 1, ' ', (size_t)(end - space - 1)) : NULL;
    snprintf(text, 64, "%.*s", (int)((stop ? stop : end) - at), at);
}

static bool set_reference(struct fan *f, const struct record *r, const char *of)
{
    struct fan_reference *ref = &f->reference;
    if (!rec_str(r, "selftest", ref->selftest, sizeof ref->selftest)) return false;
    program_of(r, ref->program);
    snprintf(ref->of, sizeof ref->of, "%s", of);
    return true;
}

static void listen_here(struct fan *f, struct child *c)
{
    struct decoder d = {.upward = true};
    struct record r;
    int64_t end_us = now_us() + PATIENCE_HELLO_US, left_us;
    bool more = true;
    while (more && !*f->reference.of && !signals_came() && (left_us = end_us - now_us()) > 0) {
        struct pollfd p = pipe_poll_entry(c->from, true, POLLIN);
        if (signals_poll(&p, 1, (int)(left_us / 1000) + 1) < 0) {
            if (errno != EINTR) die(ST_SYSTEM, "poll:");
            continue;
        }
        if (!p.revents) continue;
        more = stream_read(&d, c->from) > 0;
        if (wire_next(&d, &r) == WIRE_RECORD && r.kind == REC_HELLO) set_reference(f, &r, "here");
    }
    wire_free(&d);
}

void fan_ask_reference(struct fan *f)
{
    struct child c;
    bool elsewhere = false;
    for (int i = 0; i < f->n_hosts; i++) elsewhere |= !f->hosts[i].here;
    if (!elsewhere) return;
    char **argv = fan_reference_line(f->o);
    if (child_start(&c, argv) != 0) {
        warn("%s:", argv[0]);
    } else {
        child_close(&c.to);
        fan_connect(f); /* slots start meanwhile; they are read later */
        listen_here(f, &c);
        child_end(&c, PATIENCE_STOP_US / 1000);
    }
    host_argv_free(argv);
    if (!*f->reference.of && !signals_came())
        warn("%s sends no hello here: the hello of the first slot sets the arithmetic",
            f->o->command[0]);
}

static const char *refuse(struct fan_slot *s, const char *why, const char *fmt, ...)
    PRINTF_LIKE(3, 4);

/* Prints the reason, once per host. */
static const char *refuse(struct fan_slot *s, const char *why, const char *fmt, ...)
{
    char text[512], name[SLOT_NAME];
    const struct host *heir = host_heir(s->host->host);
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    if (s->host->here) warn("%s: refused: %s", fan_slot_name(s, name), text);
    else if (s->host->said != FAN_ENDED)
        warn("%s: refused: %s%s%s", s->host->host->name, text, heir ? FAN_LED_BY : "",
            heir ? heir->name : "");
    s->host->said = FAN_ENDED;
    return why;
}

const char *fan_take_chatter(struct fan_slot *s, const unsigned char *said, size_t n)
{
    const char *hello, *end;
    if (!n) return NULL;
    if (!s->conn.before_hello)
        fan_printable(s->conn.chatter, sizeof s->conn.chatter, (const char *)said, n);
    hello = text_find(said, n, "hello ", 6);
    if (!hello) return NULL;
    end = memchr(hello, '\n', n - (size_t)(hello - (const char *)said));
    if (!end || end[-1] != '\r') return NULL;
    return refuse(s, "no-hello",
        "its lines end in CR LF, as those of a terminal: expected LF (ssh -T, srun without --pty)");
}

/*
 * fan is itself a worker: it sends its hello with the first hello of a slot. A slot without
 * measurements counts as fast as that one.
 */
static void say_hello(struct fan *f, double power)
{
    double sum = 0;
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        sum += s->width * (s->power > 0 ? s->power : power);
    }
    wire_hello(&f->out.queue.control, "fan", f->reference.selftest, sum, 0, f->n_numbers);
    f->out.greeted = true;
}

const char *fan_take_hello(struct fan *f, struct fan_slot *s, const struct record *r)
{
    const struct fan_reference *ref = &f->reference;
    char selftest[24], program[64], format[160];
    int64_t inner;
    if (!rec_ours(r, format)) return refuse(s, "other-version", "its stream %s", format);
    if (fan_slot_next(s->state, ON_HELLO) == FAN_NEVER || fan_code_waits(s)) return "second-hello";
    if (!rec_str(r, "selftest", selftest, sizeof selftest)) return "no-selftest";
    program_of(r, program);
    if (!*ref->of) {
        char of[sizeof ref->of];
        snprintf(of, sizeof of, "on %s", s->host->host->name);
        set_reference(f, r, s->host->here ? "here" : of);
    }
    if (strcmp(program, ref->program) != 0)
        return refuse(
            s, "other-version", "it runs %s, expected %s as %s", program, ref->program, ref->of);
    if (strcmp(selftest, ref->selftest) != 0)
        return refuse(s, "other-arithmetic", "its arithmetic differs (selftest=%s, %s %s)",
            selftest, ref->of, ref->selftest);
    if (!rec_int(r, "slots", 1, HOSTS_SLOTS_MAX, &inner)) inner = 1;
    if (s->width > 1 && inner != s->width)
        return refuse(s, "other-slots", "it has %d slots, expected %d, by its option -j",
            (int)inner, s->width);
    s->inner = s->width > 1 ? 1 : (int)inner;
    double power, least;
    if (!rec_real(r, "power", POWER_LEAST, POWER_MOST, &power)) power = s->width;
    if (!rec_real(r, "least", POWER_LEAST, POWER_MOST, &least)) least = 0;
    if (!(s->power > 0)) s->power = power / s->width, s->least = least / s->width;
    if (!f->out.greeted) say_hello(f, s->power);
    s->measured = true;
    *s->conn.chatter = '\0';
    fan_alive_begin(f, s, r);
    fan_code_begin(f, s, r);
    return NULL;
}
