/*
 * verify: chooses fragments of a log, has them computed a second time on another slot, and judges
 * the results.
 *
 * The chosen fragments are pieces. A second computation may come in smaller fragments than it was
 * asked for, because deal cuts tasks (sched/deal_end.c). So pieces are divided into parts, wherever
 * a fragment of a check begins or ends. Each fragment has a part as a whole or not at all, and an
 * opinion of a part is one sum over all of its pixels. A sum over several fragments could count a
 * pixel twice, and accuse an honest host.
 *
 * The sums are linear in the bits, under two secret keys (J. L. Carter, M. N. Wegman, "Universal
 * classes of hash functions", JCSS 18, 1979). A slot that sends the same part again adds nothing.
 *
 * Call order; verify_read has the part from verify_frame to verify_end. All files are read twice,
 * first for the places of their fragments, then for pixels:
 *
 *     verify_hosts_init, verify_init
 *     verify_frame, verify_choose    the log, in order
 *     verify_cut                     all checks
 *     verify_split                   once
 *     verify_first                   the log again, in the same order
 *     for each check: verify_begin, verify_again for its fragments, verify_end
 *     verify_request for each frame: the tasks of the next round; or verify_judge: the report
 *
 * The requests of earlier rounds are not stored: they follow from the seed and the checks.
 */
#ifndef STORMRING_VERIFY_H
#define STORMRING_VERIFY_H

#include "log/log.h"
#include "task/task.h"

/* The result of one slot for a part. -1: not known, as the slot of an earlier run in the log. */
struct verify_opinion {
    int32_t slot, place;
    uint64_t sum[2];
};
static inline bool verify_same(const struct verify_opinion *a, const struct verify_opinion *b)
{
    return a->sum[0] == b->sum[0] && a->sum[1] == b->sum[1];
}

/* Offsets to the seed: each kind of random number has its own. */
enum { VERIFY_SEED_CHOICE = 0, VERIFY_SEED_KEYS = 1 /* and 2 */, VERIFY_SEED_NEXT = 3 };

#define VERIFY_INLINE 2
struct verify_part {
    struct lattice at;
    uint32_t frame;
    uint32_t piece;    /* number of its fragment in the log */
    uint32_t n;        /* opinions; the first is the log's */
    int32_t asked;     /* slot asked in this round, -1: none */
    int32_t failed[2]; /* places that did not deliver, first and last; -1: none */
    struct verify_opinion by[VERIFY_INLINE];
    struct verify_opinion *more; /* the third and later opinions */
};

/*
 * A place checks another place: a host or, if all slots are on one host, a slot. Places are
 * numbered from 0. Those of hosts that have left the run come last; they are not asked.
 */
struct verify_place {
    uint64_t asked_px, made_px; /* pixels asked for and delivered, in all rounds so far */
};
/*
 * Names of places. Hosts joined and left, so in each file a slot may be on another host than now:
 * the frame records of fan say on which. Lines of a hosts file with one name are one host.
 */
struct verify_hosts {
    int32_t slots;
    int32_t *place_of;       /* by slot, as the hosts are now */
    const char *const *name; /* by slot, the same; the caller's, must stay valid */
    bool several;            /* a place is a host; otherwise a slot of the only host */
    char **host;             /* by place */
    int32_t places, cap;
};
void verify_hosts_init(struct verify_hosts *h, const char *const *name, int32_t slots);
void verify_hosts_free(struct verify_hosts *h);
/* The place of a host. A new name gets the next place. */
int32_t verify_hosts_place(struct verify_hosts *h, const char *name);
/* From now on places are hosts: another host than the only one had a part in the run. */
void verify_hosts_several(struct verify_hosts *h);
/* The host's name, for messages. */
const char *verify_hosts_name(const struct verify_hosts *h, int32_t place);

/* Payload of a frame. */
struct verify_frame {
    char job[WIRE_JOB]; /* "": not known */
    bool tasks_written; /* the caller's: false at first */
};
struct verify_cut {
    uint32_t part;
    uint64_t offset;
};
struct verify {
    uint64_t seed;
    double fraction;
    int32_t slots;
    const int32_t *place_of; /* by slot; the caller's, must stay valid */
    struct verify_place *place;
    struct frames frames; /* of the log */
    struct verify_part *part;
    uint32_t n, cap;
    uint32_t pieces;  /* chosen fragments */
    uint32_t seen;    /* fragments of the log */
    uint32_t again;   /* the same in the second reading */
    uint32_t rounds;  /* checks begun */
    uint64_t span_px; /* most pixels from the first to the last pixel of a part */
    struct verify_cut *cut;
    size_t n_cuts, cap_cuts;
};

/* place_of has a number from 0 to places - 1 for each of `slots` slots. verify_free frees v. */
void verify_init(struct verify *v, uint64_t seed, double fraction, const int32_t *place_of,
    int32_t slots, int32_t places);
void verify_free(struct verify *v);

/* Handles a frame record of the log. The first one of a number counts. job may be NULL. */
void verify_frame(
    struct verify *v, uint32_t frame, uint32_t frame_w, uint32_t frame_h, const char *job);
/* Handles the next fragment of the log: chooses it or not. Only fragments inside a known frame
 * are chosen. */
void verify_choose(struct verify *v, const struct task *t);
/* Handles a fragment of a check. */
void verify_cut(struct verify *v, const struct task *t);
/* Makes the parts, in the order of frames and of first pixels. */
void verify_split(struct verify *v);
/* Handles the next fragment of the log with its pixels, four floats each. -1: not known. */
void verify_first(
    struct verify *v, const struct task *t, int32_t slot, int32_t place, const float *pixels);
/* Begins the next check: recomputes its requests. */
void verify_begin(struct verify *v);
/* Handles a fragment of the check. Ignored if its place is not known. */
void verify_again(
    struct verify *v, const struct task *t, int32_t slot, int32_t place, const float *pixels);
/* Ends the check: notes requests that were not delivered. */
void verify_end(struct verify *v);

/*
 * All of that from files: files[0] is the log, the others are the checks; NULL ends them. *name is
 * the file that was read last, for a message. Returns as log_read_path does; v is of use only
 * after 0.
 */
int verify_read(struct verify *v, struct verify_hosts *h, char *const *files, const char **name,
    char why[LOG_WHY]);

static inline const struct verify_opinion *verify_opinion(const struct verify_part *p, uint32_t i)
{
    return i < VERIFY_INLINE ? &p->by[i] : &p->more[i - VERIFY_INLINE];
}
/* The parts of a frame are number *first to the result - 1. */
uint32_t verify_of_frame(const struct verify *v, uint32_t frame, uint32_t *first);

/* ---- the verdict ----------------------------------------------------------------------------- */

enum verify_verdict { VERIFY_AGREED, VERIFY_UNCHECKED, VERIFY_DIFFERENT };
/* Agreed: at least two places computed it, all with the same result. */
enum verify_verdict verify_judge(const struct verify_part *p);
/* The number of places with the same result as opinion i. An unknown slot is no place. */
uint32_t verify_votes(const struct verify_part *p, uint32_t i);
/*
 * True if opinion i of a part with different results is to be named. *known: it is wrong, because
 * two places contradict it and fewer agree with it. If not known, any of the named ones may be
 * wrong.
 */
bool verify_named(const struct verify_part *p, uint32_t i, bool *known);
/*
 * The slot that should compute the part next, of a place that has not computed it. Places come last
 * if they delivered nothing of their requests in all rounds; before these if they delivered less
 * than half; before these if they failed to deliver this part. -1: enough is known, or there is no
 * such slot, or each has failed twice.
 */
int32_t verify_next(const struct verify *v, const struct verify_part *p);
/*
 * The next request for a frame: a part that is to be computed, with its number as id, and the slot
 * that verify_next names. Looks at parts from number *from on, which is 0 at first, and sets it
 * behind that part. False: there is no other.
 */
bool verify_request(const struct verify *v, uint32_t frame, uint32_t *from, struct task *t);
/* Pieces with a part of different results; pieces without one but with an unchecked part. */
struct verify_count {
    uint32_t different, unchecked;
};
struct verify_count verify_counted(const struct verify *v);
/*
 * Appends a line on a part with different results: its place, the slots to be named, and whether
 * they are wrong or one of them is.
 */
void verify_describe(const struct verify_part *p, const struct verify_hosts *h, struct buf *out);

#endif
