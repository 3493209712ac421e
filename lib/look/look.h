/*
 * look: a picture that follows a camera. A view is one picture: a frame number and its size. Its
 * pixels are asked for as tasks, in passes from coarse to fine, and each pixel once. When the view
 * changes, nothing more of the old one is asked, and its late pixels are dropped. So a
 * picture on the screen is of one view only.
 *
 * Call order: look_init; look_slots, when the command says how many it has; look_view for each
 * view; look_next for the tasks to send, whenever something has happened; look_frag, look_done and
 * look_fail for what comes. look_free. No clock and no I/O. Only look_view allocates, when the size
 * changes, and the table of tasks, while it grows.
 *
 * The passes are those of Adam7 of PNG (A. Costello, "PNG", W3C 2003) from the fifth on: a pixel
 * of each 4x4, then those that halve the distances, by columns and rows in turns.
 */
#ifndef STORMRING_LOOK_H
#define STORMRING_LOOK_H

#include "geometry/geometry.h"
#include "task/task.h"

#define LOOK_PASSES 5
#define LOOK_FINAL (LOOK_PASSES + 1) /* the level of a pixel that has come itself */
#define LOOK_TASK_US 2000.0          /* what a task should take: a new view waits for those */
#define LOOK_DEPTH 2                 /* tasks that a slot may hold if the round trip is short, */
#define LOOK_DEPTH_MOST 12           /* and if it is long */
#define LOOK_TASK_LEAST 128          /* pixels: below, the records cost more than the rays */
#define LOOK_HOLD_US 500000          /* a coarse pass that takes longer may be given up */

struct look_counts {
    uint64_t views, tasks;
    uint64_t px;       /* pixels that were asked for, */
    uint64_t stale_px; /* came for an earlier view and were dropped, */
    uint64_t again_px; /* came once more, */
    uint64_t failed_px;
};

struct look {
    uint32_t frame, w, h;                  /* the view; w = 0: none yet */
    int64_t begun_us, coarse_us, whole_us; /* when it began, was there coarsely, was whole; -1 */
    struct coverage have;
    float *rgba;    /* what is shown: pixels, linear and premultiplied, 4 floats each; those that */
                    /* have not come have the value of a coarser neighbour, */
    uint8_t *level; /* by its pass, from 1; 0: nothing of this view */
    uint32_t first, end; /* rows that changed since look_seen: first <= y < end */
    uint64_t coarse;     /* pixels of the first pass that are missing */
    uint64_t failed;     /* pixels of this view that will not come */
    int pass;            /* that tasks are cut from, */
    uint64_t asked;      /* its pixels that were asked for, */
    uint64_t left;       /* and those of all passes that were not */
    uint32_t next_id;
    int32_t slots, fresh;     /* slots that are up; tasks of this view under way */
    struct task_table flight; /* tasks under way, of all views, */
    uint64_t flight_px;       /* and their pixels */
    double px_per_us;         /* of a slot, measured; 0: not known */
    double trip_us;           /* of a task, beyond its own time; -1: not known */
    struct look_counts counts;
};

void look_init(struct look *l);
void look_free(struct look *l);
/* The slots that are up. 0: none yet, and no task is given. */
void look_slots(struct look *l, int32_t slots);
/* True if the next view may begin: the user has seen something of this one, or it takes too
 * long. */
bool look_ready(const struct look *l, int64_t now_us);
/* Begins a view, whose frame number is above all others. */
void look_view(struct look *l, uint32_t frame, uint32_t w, uint32_t h, int64_t now_us);
/* The next task to send. False: none now. */
bool look_next(struct look *l, int64_t now_us, struct task *t);
/* A slot has computed the task in wall_us, or -1. */
void look_done(struct look *l, uint32_t frame, uint32_t id, int64_t wall_us);
/* Pixels have come, of a task or of a piece of one. False: t is no part of a task that was asked
 * for, and nothing is taken. Of an earlier view rgba does not count. */
bool look_frag(struct look *l, const struct task *t, const float *rgba, int64_t now_us);
/* The task will not be computed. Returns its missing pixels; 0: it is of no view, or an old one. */
uint64_t look_fail(struct look *l, uint32_t frame, uint32_t id, int64_t now_us);
/* True if there is a pixel for each block of 4x4. */
static inline bool look_coarse(const struct look *l) { return l->w && !l->coarse; }
/* True if nothing more will come. */
static inline bool look_whole(const struct look *l)
{
    return l->w && l->have.done + l->failed == (uint64_t)l->w * l->h;
}
/* The rows that changed were drawn. */
static inline void look_seen(struct look *l) { l->first = l->h, l->end = 0; }
/* The pixels of a pass in a frame of this size; w = 0: none. */
struct lattice look_pass(int pass, uint32_t w, uint32_t h);

/* ---- moves of a camera (move.c) ---------------------------------------------------------------
 *
 * dx and dy are parts of the frame's height, to the right and down. The subject seems to follow
 * the pointer. The caller checks that the result is a view: a number may get too large.
 */
struct look_camera {
    struct vec3 from, at, up;
    double angle_deg; /* vertical field of view */
};
/* Turns the eye round `at`, as if a ball there were turned: 1 is half a turn. */
struct look_camera look_turn(struct look_camera c, double dx, double dy);
/* Moves eye and `at` across the view, so that `at` follows the pointer. */
struct look_camera look_move(struct look_camera c, double dx, double dy);
/* The distance from the eye to `at`, times this. */
struct look_camera look_zoom(struct look_camera c, double times);
/* Moves eye and `at` so that the point at dx, dy from the frame's centre comes to its centre. */
struct look_camera look_centre(struct look_camera c, double dx, double dy);

#endif
