/*
 * view: a run in view, from its log, while it goes on or later: a table for a terminal, the events
 * of a trace viewer, and a page for a browser.
 *
 * Logs are not trusted: names of slots and hosts are escaped. Nothing here ends a run or changes
 * its log. Only functions that say so print or die.
 */
#ifndef STORMRING_VIEW_H
#define STORMRING_VIEW_H

#include "account/account.h"
#include "eta/eta.h"
#include "history/history.h"

/* ---- a log that grows ------------------------------------------------------------------------ */

struct view_log {
    const char *path;
    int fd; /* -1: the file does not exist yet */
    uint64_t at, inode;
    struct decoder d;
    struct history log;
    struct eta eta;
    int64_t heard_us; /* now_us when the file last grew */
};
void view_open(struct view_log *v, const char *path);
/*
 * Reads what the log has got since the last call. If the file was truncated or replaced, begins
 * again. False if it does not exist. Dies with status 3 if it cannot be read, with 2 if it is a
 * directory, or of another format.
 */
bool view_read(struct view_log *v);
void view_close(struct view_log *v);
/* True if the last run has said bye. */
bool view_ended(const struct view_log *v);
/* True if a run holds the log: one that has just begun may have written nothing yet. */
bool view_held(const struct view_log *v);
/* True if every pixel of every frame is there, and there is at least one frame. */
bool view_whole(const struct view_log *v);

/* ---- its state ------------------------------------------------------------------------------- */

struct view_slot {
    double busy_s;                     /* in the last run */
    double last_s;                     /* end of its last task there; < 0: none */
    double px_per_s;                   /* in the last VIEW_RATE_S */
    size_t tasks, losses;              /* of the last run */
    const struct history_done *done;   /* its last task, or NULL */
    const struct history_event *event; /* its last one, or NULL: it was ready, or is lost */
};
#define VIEW_RATE_S 30

struct view_state {
    uint64_t done_px, total_px;
    double now_s;  /* in the last run */
    double left_s; /* < 0: not known */
    size_t n_up;
    struct view_slot *slots; /* as in the history */
};
/* The caller frees s->slots. */
void view_state(const struct view_log *v, struct view_state *s);
/* The host of slot i, as people know it: its own, or that of a slot that holds it; `unknown` if the
 * log does not state it. */
const char *view_host(const struct history *l, size_t i, const char *unknown);

/*
 * Appends the table of the run in state s: a line for each slot, and the latest losses. columns,
 * lines: size of the terminal, to which all is cut; 0: no limit. Lines end in `eol`.
 */
void view_table(const struct view_log *v, const struct view_state *s, int columns, int lines,
    const char *eol, struct buf *out);

/* ---- a timeline, a trace, and a page --------------------------------------------------------- */

/* Appends the intervals of stormring-tsv(5): a bar per `done`. name: of the experiment. */
void view_gantt(const struct account *a, double bound_s, const char *name, struct buf *out);

/* Appends the log as JSON of the Trace Event Format (Google, "Trace Event Format", 2016): a process
 * for each host, a thread for each slot. */
void view_trace(const struct account *a, struct buf *out);

/*
 * Appends a page of HTML that needs no other file: the picture in `png`, which may be incomplete or
 * empty, the timeline, and the table. reload_s: the page reloads itself after this; 0: never.
 */
void view_page(const struct view_log *v, const struct account *a, const struct buf *png,
    double reload_s, struct buf *out);
/* Appends a PNG of the first frame's pixels in the log at `path`, at most 1024 pixels wide and
 * high; nothing if there are none. */
void view_picture(const char *path, struct buf *png);

#endif
