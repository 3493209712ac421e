/* fan: what a slot is sent: the state that it lacks, with its frames, and single records. */
#include "fan/fan_int.h"

bool fan_takes(const struct fan_slot *s)
{
    return s->feed.primed && (!fan_slot_fed(s) || s->conn.child.to >= 0);
}

void fan_forget(struct fan_state_of *state)
{
    for (int i = 0; i < WIRE_STATE_KINDS; i++)
        if (state->kind[i]) blob_drop(state->kind[i]);
    buf_free(&state->frame_lines);
    *state = (struct fan_state_of){0};
}

/* Sends slot s the parts of this state that it lacks. */
static void send_state(struct fan_slot *s, const struct fan_state_of *state)
{
    for (int i = 0; i < WIRE_STATE_KINDS; i++) {
        if (!state->kind[i] || s->feed.sent[i] == state->number[i]) continue;
        down_share(&s->feed.queue, state->kind[i]);
        s->feed.sent[i] = state->number[i];
    }
    down_append(&s->feed.queue, buf_data(&state->frame_lines), buf_size(&state->frame_lines));
}

/*
 * A task of an earlier state, for a slot that was not sent that state: the slot gets the state and
 * all later ones in order, so that the worker's latest state is the latest again.
 */
void fan_prime(struct fan *f, struct fan_slot *s, uint32_t generation)
{
    for (uint32_t g = generation; g != f->input.generations.now + 1; g++)
        send_state(s, &f->states[g % GENERATIONS]);
    s->feed.since = generation;
    s->feed.primed = s->feed.loading = true;
    s->feed.behind = false;
}

/* Once the latest state has tasks, all tasks of the one before have been given to slots. They
 * come again only if they are lost. */
void fan_prime_early(struct fan *f, struct fan_slot *s)
{
    const struct generations *g = &f->input.generations;
    fan_prime(f, s, f->begun || g->now == g->oldest ? g->now : g->now - 1);
}

void fan_pass_down(struct buf *to, const struct record *r, const struct fan_slot *s, int k)
{
    static const char *const drop[] = {"to", NULL};
    char text[24];
    snprintf(text, sizeof text, "to=%d", k - s->number);
    wire_forward(to, r, drop, k >= 0 && s->width > 1 ? text : NULL);
}

bool fan_slot_tell(const struct fan_slot *s, enum rec_kind kind, const char *extra)
{
    struct down_queue q = {0};
    wire_plain(&q.bytes, kind, extra);
    bool told = down_write(&q, s->conn.child.to) == 0 && !down_size(&q);
    down_free(&q);
    return told;
}
