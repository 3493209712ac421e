/*
 * verify: chooses fragments of a log, has other hosts compute them again, and judges the results.
 *
 * A chosen fragment is a piece. Its task has exactly its pixels, and the piece's number as id, so
 * a worker returns it as one fragment. A result is a sum over all bits of the pixels. The seed must
 * be unknown to workers while they compute: they could choose pixels of the same sum.
 *
 *     verify_init, verify_read
 *     verify_next for each piece: the tasks of the next check; or verify_judge: the report
 *     verify_free
 *
 * The tasks of earlier checks are not stored: they follow from the seed and the checks.
 */
#ifndef STORMRING_VERIFY_H
#define STORMRING_VERIFY_H

#include "log/log.h"
#include "task/task.h"

/*
 * The result of one slot. A place checks another place: a host or, if all slots are on one host, a
 * slot. -1: not known, as the slot of an earlier run in the log.
 */
struct verify_result {
    int32_t slot, place;
    uint32_t run; /* private: of the log */
    uint64_t sum;
};
struct verify_piece {
    struct lattice at;
    uint32_t frame;
    uint32_t next; /* 1 + the number of the frame's next piece; 0: none */
    uint32_t n;    /* results; the first is the log's */
    struct verify_result *by;
    int32_t asked, failed; /* slot asked in this check; place that did not deliver; -1: none */
};
/* Payload of a frame. */
struct verify_frame {
    char job[WIRE_JOB];   /* "": not known */
    uint32_t first, last; /* pieces, as `next` */
    bool tasks_written;   /* the caller's: false at first */
};
struct verify {
    uint64_t seed;
    double fraction;
    int32_t slots;
    int32_t *host_of; /* by slot, as the hosts are now */
    char **host;      /* names; first those of now */
    int32_t hosts;
    bool several; /* hosts check hosts, not slots slots */
    struct verify_place {
        uint32_t asked, made; /* fragments of this check */
        bool mute;            /* it delivered nothing in a check: it is not asked again */
    } * place;
    struct frames frames; /* of the log */
    struct verify_piece *piece;
    uint32_t n, cap;
    uint64_t seen; /* fragments of the log */
};

/* name: the host of each of `slots` slots, as they are now. Two slots with one name are on one
 * host. verify_free frees v. */
void verify_init(
    struct verify *v, uint64_t seed, double fraction, const char *const *name, int32_t slots);
void verify_free(struct verify *v);
/*
 * Reads files[0], the log, and the others, the checks in their order; NULL ends them. *name is the
 * file that was read last, for a message. Returns as log_read_path does; v is of use only after 0.
 */
int verify_read(struct verify *v, char *const *files, const char **name, char why[LOG_WHY]);

/* The place of a slot as the hosts are now; true if the place computed p. */
static inline int32_t verify_place(const struct verify *v, int32_t slot)
{
    return v->several ? v->host_of[slot] : slot;
}
bool verify_computed(const struct verify_piece *p, int32_t place);
/*
 * The slot that should compute the piece next, of a place that has not computed it: drawn by the
 * seed, each with the share that it has in the log. The place that failed to deliver it last comes
 * after all others. -1: two places agree, or there is no such slot.
 */
int32_t verify_next(const struct verify *v, const struct verify_piece *p);

enum verify_verdict { VERIFY_AGREED, VERIFY_UNCHECKED, VERIFY_DIFFERENT };
/* Agreed: at least two places computed it, all with the same result. */
enum verify_verdict verify_judge(const struct verify_piece *p);
/*
 * True if result i of a piece with different results is to be named. *known: it is wrong, because
 * two places contradict it and fewer agree with it. If not known, any of the named ones may be
 * wrong.
 */
bool verify_named(const struct verify_piece *p, uint32_t i, bool *known);
/* Appends a line on a piece with different results: its place in the picture, the slots to be
 * named, and whether they are wrong or one of them is. */
void verify_describe(const struct verify *v, const struct verify_piece *p, struct buf *out);

#endif
