/*
 * log: streams of fragments (stormring-frag(5)) read into an assembly of pictures, and the file
 * that keeps such a stream, so that what was cut off can be gone on with.
 *
 * An intake turns records into calls of image's assembly, which holds the rules of committing; it
 * also remembers what the stream says of those who made it. A log file is locked while a run
 * appends to it. Reading blocks as its descriptor does; nothing here exits or prints.
 */
#ifndef STORMRING_LOG_H
#define STORMRING_LOG_H

#include "image/image.h"
#include "wire/wire.h"

#define LOG_WHY 512

/* Who made a stream, as it first says; empty strings where it does not. */
struct log_origin {
    char with[160];    /* the worker and its options that change pixels: words for a shell */
    char version[64];  /* of the program that said hello */
    char selftest[24]; /* the hash of its arithmetic */
};

/* Slots that sent pixels. A worker without a fan has no name, and its host is not known. */
#define LOG_NAME 256
struct log_source {
    char slot[LOG_NAME], host[LOG_NAME];
    const char *input; /* the file that they came from */
    uint32_t run;
};
struct log_sources {
    struct log_source *at;
    uint32_t n;
    uint32_t run;      /* now; slots of another run are other ones */
    const char *input; /* now */
    uint16_t *places;  /* by the hash of their names */
};
/* Another run, or input, begins; its name is the caller's, and has to stay. */
void log_sources_begin(struct log_sources *s, const char *input);
/* The number of r's slot for assembly_commit; a frame record says where that is. */
uint16_t log_source_of(struct log_sources *s, const struct record *r);
/* "slot 2 on render1 (job.log)" */
#define LOG_SOURCE_TEXT 1024
void log_source_text(const struct log_sources *s, uint16_t source, char out[LOG_SOURCE_TEXT]);
/* "frame 0: 4 pixels of slot 2 on render1 (a.log) and of slot 0 (b.log) differ, ..." */
#define LOG_DISPUTE_TEXT (2 * LOG_SOURCE_TEXT + 256)
const char *log_dispute_text(
    const struct log_sources *s, const struct assembly_dispute *d, char out[LOG_DISPUTE_TEXT]);
void log_sources_free(struct log_sources *s);

struct intake {
    struct assembly parts;
    struct log_sources sources;
    struct frames orphans; /* whose fragments came where nobody had declared them */
    struct log_origin origin;
    uint64_t good;         /* records read */
    uint64_t bad, skipped; /* records and bytes lost */
    char why[160];         /* about the last of them, or why log_read stopped */
    uint64_t unexpected;   /* records that do not belong in a stream of fragments */
    float *pixels;         /* of one frag; NULL: pixels are not kept, only which are there */
};

void intake_init(struct intake *in, bool keep_pixels);
void intake_free(struct intake *in);
/* Notes what a hello or frame record says of its maker; others say nothing. */
void intake_note(struct intake *in, const struct record *r);
/* A frame record, as assembly_declare takes it; UNDECLARED where it has no job, which is counted
 * as unexpected. */
enum assembly_verdict intake_frame(struct intake *in, const struct record *r);
/* Any other record. Returns the frame that is whole by it, which is the caller's to write and to
 * release, else NULL. */
struct assembly_frame *intake_record(struct intake *in, const struct record *r);

/* Says on standard error what was skipped or ignored. */
void intake_report(const struct intake *in);
/*
 * The file at `path` has a record `frame F W H job=HASH` for each picture that is to come: those of
 * which nothing came are declared. 0, or else why says what is wrong: the file, or that a picture
 * that came is another.
 */
int intake_expect(struct intake *in, const char *path, char why[LOG_WHY]);

/* Are there fragments of a frame that nobody declared, before or after? Its record was lost. */
bool intake_orphaned(const struct intake *in);

/* A frame record and the tasks of what f lacks, with new ids, to put; nothing where it is whole. */
void intake_missing(const struct assembly_frame *f, void (*put)(const void *p, size_t n));

/* What to do while a stream is read. */
struct log_reader {
    void (*record)(void *ctx, const struct record *r); /* each good record */
    void (*before)(void *ctx, int fd);                 /* each read, which may block; or NULL */
    void *ctx;
};
/* Reads fd, which messages call `name`, to its end; what is lost on the way is counted in `in`. 0;
 * 1 at a hello of another format, and in->why says so; or -1 with errno. */
int log_read(struct intake *in, int fd, const char *name, const struct log_reader *reader);

/*
 * What the log at `path` holds of frame number `frame`: *have has its size and pixels (the caller's
 * to free); of size 0x0 where the log has nothing of it, is empty, missing, or a device or a pipe.
 * 0; 1 where it cannot be gone on with, and why says what it is; or -1 with errno.
 */
int log_coverage(const char *path, uint32_t frame, struct coverage *have, char why[LOG_WHY]);

/* What each pixel of a picture cost, by the CPU time of the tasks in a log of it. */
struct log_costs {
    uint32_t w, h; /* 0: the log has no task that was both done and delivered */
    double *us;    /* row by row */
};
/* Reads the log's first frame; what is missing of it gets the mean. 0, or else why says why not. */
int log_costs_read(const char *path, struct log_costs *c, char why[LOG_WHY]);
void log_costs_free(struct log_costs *c);
/* The same for pixel p of a picture of any size of the same scene. */
double log_cost_at(const struct log_costs *c, uint64_t p, uint32_t frame_w, uint32_t frame_h);

/* ---- the file ------------------------------------------------------------------------ */

struct log_file {
    const char *path; /* the caller's */
    int fd;           /* -1: none, or writing to it failed */
    bool holds;       /* it had something when it was opened */
    struct buf pending;
};

/*
 * Opens the log for reading and appending; it is made where it is missing. Until it is closed
 * nobody else can open it so. 0, or -1 with errno: EWOULDBLOCK says that somebody has. What is no
 * regular file is opened for writing alone.
 */
int log_open(struct log_file *l, const char *path);
/* Queues a record; log_flush writes: 0, or -1 with errno, and then the log is closed. */
void log_append(struct log_file *l, const struct record *r);
int log_flush(struct log_file *l);
void log_close(struct log_file *l);
/* Reads it from its beginning, as log_read. */
int log_reread(const struct log_file *l, struct intake *in, const struct log_reader *reader);
/* The same into a new intake, for what is there alone. 1 where the file is of another format, or
 * holds neither a record nor the beginning of one: it is not to be appended to, as in->why says.
 */
int log_survey(const struct log_file *l, struct intake *in);

/* What a log held before a run, and which frames of the run belong there; all zero at first. */
struct log_past {
    bool known;
    struct intake held;
    struct frames confirmed;
};
/*
 * May the stream of origin `now`, which announces r (a frame record with a job), be appended? Also
 * where the log knows nothing of that frame; once it may, a frame is not asked about again. The
 * first call comes before anything is appended. 0; 1 where it may not, and why says by name what
 * differs: size, options, arithmetic, version, the scene, or that it is no log; or -1 with errno.
 */
int log_confirm(struct log_past *past, const struct log_file *l, const struct log_origin *now,
    const struct record *r, char why[LOG_WHY]);
void log_past_free(struct log_past *past);
/*
 * The shell commands that finish the pictures of these logs (NULL-ended), one line for `out`:
 * tasks, to the worker of that origin, to the last log; then `gather options LOGS`. False where
 * there is no log, or one is standard input, which cannot be read again.
 */
bool log_remedy(
    const char *const *logs, const struct log_origin *origin, const char *options, struct buf *out);

#endif
