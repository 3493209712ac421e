/*
 * eta: the time that is left in a run: the estimate, what records tell it, and the progress line.
 * Nothing here fails.
 */
#ifndef STORMRING_ETA_H
#define STORMRING_ETA_H

#include "base/base.h"

struct assembly; /* image/image.h */
struct record;   /* wire/wire.h */

/* ---- the estimate --------------------------------------------------------------------- */

/*
 * Predicts the end of a run from the cost of the pixels that have come, by their place, and from
 * the work that is done in a second. Fixed in size; all zero at first. Times are in seconds from
 * any zero.
 */
#define ETA_BANDS 64   /* of rows */
#define ETA_TASKS 1024 /* whose pixels or cost have come, and not both */
#define ETA_MARKS 128
struct eta {
    double cost_us[ETA_BANDS], px[ETA_BANDS];
    bool known;           /* the forecast */
    double us[ETA_BANDS]; /* the cost of a pixel that it says */
    double from_s;        /* when it was made, after n_from tasks */
    uint64_t n_from;
    struct eta_task {
        bool used, done, earlier;
        uint32_t frame, id;
        uint32_t first, last; /* bands */
        double cost_us, px;   /* not yet in the bands */
    } tasks[ETA_TASKS];
    struct {
        double t_s, work_us, cost_sum_us;
    } marks[ETA_MARKS]; /* points of the recent run */
    int n_marks;
    uint64_t n_done;
    uint32_t lowest; /* band since the forecast */
    double step_s, last_s, work_us, cost_sum_us;
};
/* The cost of a task came at time t_s; negative: in an earlier run. */
void eta_done(struct eta *e, uint32_t frame, uint32_t id, double cost_us, double t_s);
/* Some of its pixels came: px of them, in rows from y0 to y1, as parts of the height. */
void eta_pixels(struct eta *e, uint32_t frame, uint32_t id, double y0, double y1, double px);
/* Another run begins: the speed is not known any more, the costs are. */
void eta_begin(struct eta *e);
/* Seconds from t_s to the end, if done of total pixels have come; -1: not known yet. */
double eta_left_s(const struct eta *e, double done, double total, double t_s);
/* Writes "1:05", "1:02:30"; "?" if left_s is negative. */
#define ETA_TEXT 32
const char *eta_text(double left_s, char out[ETA_TEXT]);
/* Tells e what r says of costs and pixels; t_s as in eta_done, frame_h is the height of a frag's
 * frame. */
void eta_record(struct eta *e, const struct record *r, uint32_t frame_h, double t_s);

/* ---- the line ------------------------------------------------------------------------- */

/* One line on stderr, updated at most five times a second: percent and estimated time left. */
struct progress {
    bool on;
    int width; /* columns now on the screen */
    int64_t next_us;
};

void progress_start(struct progress *p, bool on);
/* True if the line is to be updated now. */
bool progress_due(const struct progress *p);
/* Shows done of total units and the time left; negative: not known. */
void progress_show(struct progress *p, uint64_t done, uint64_t total, double left_s);
/* Erases the line. Call before any other message, and at the end. */
void progress_clear(struct progress *p);

/* ---- the line of a run, with its estimate ------------------------------------------------ */

/* All zero at first. */
struct eta_progress {
    struct progress line; /* start it with progress_start, erase it with progress_clear */
    struct eta eta;
};
/* Tells the estimate of r, before an intake takes it; earlier: r is of an earlier run. Does nothing
 * if the line is off. */
void eta_progress_note(
    struct eta_progress *p, const struct assembly *parts, const struct record *r, bool earlier);
/* Shows the line, if that is due. */
void eta_progress_show(struct eta_progress *p, const struct assembly *parts);

#endif
