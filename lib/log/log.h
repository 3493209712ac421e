/*
 * log: reads streams of fragments (stormring-frag(5)) into an assembly of pictures, and keeps such
 * a stream in a file, so that an interrupted run can be resumed.
 *
 * An intake turns records into calls of image's assembly, which holds the rules of committing. It
 * also remembers what the stream states about its maker. A log file is locked while a run appends
 * to it. Reading blocks as its descriptor does. Nothing here exits; only the functions
 * intake_report print.
 */
#ifndef STORMRING_LOG_H
#define STORMRING_LOG_H

#include "image/image.h"
#include "wire/wire.h"

#define LOG_WHY 512

/* The maker of a stream, from its first records; empty strings if not stated. */
struct log_origin {
    char with[160];    /* worker and options that change pixels, as shell words */
    char version[64];  /* of the program in hello */
    char selftest[24]; /* the hash of its arithmetic */
};

/* Slots that sent pixels. A worker without a fan has no name and no known host. */
#define LOG_NAME 256
struct log_source {
    char slot[LOG_NAME], host[LOG_NAME];
    const char *input; /* the file of the pixels */
    uint32_t run;
};
struct log_sources {
    struct log_source *at;
    uint32_t n;
    uint32_t run;      /* current one; slots of different runs are distinct */
    const char *input; /* current one */
    uint16_t *places;  /* by hash of the name */
};
/* Begins another run or input. `input` is the caller's and must stay valid. */
void log_sources_begin(struct log_sources *s, const char *input);
/* The number of r's slot for assembly_commit; a frame record states the slot's host. */
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
    struct frames orphans; /* frames with fragments but no declaration */
    bool more_orphans;     /* than fit there */
    struct log_origin origin;
    uint64_t good;         /* records read */
    uint64_t bad, skipped; /* records and bytes lost */
    char why[160];         /* the last loss, or why log_read stopped */
    uint64_t unexpected;   /* records that do not belong in a stream of fragments */
    float *pixels;         /* of one frag; NULL: only coverage is kept */
};

void intake_init(struct intake *in, bool keep_pixels);
void intake_free(struct intake *in);
/* Notes the maker's data in a hello or frame record; ignores others. */
void intake_note(struct intake *in, const struct record *r);
/* Handles a frame record like assembly_declare. UNDECLARED if it has no job; it is counted as
 * unexpected. */
enum assembly_verdict intake_frame(struct intake *in, const struct record *r);
/* Why intake_frame refused r: "frame 0: slot 1 on render1 (a.log) has job X of 8x8, ..." */
const char *intake_refused_text(
    struct intake *in, const struct record *r, char out[LOG_DISPUTE_TEXT]);
/* Handles any other record. Returns the frame that it completes, which the caller must write and
 * release; else NULL. */
struct assembly_frame *intake_record(struct intake *in, const struct record *r);

/* Print to standard error: what was skipped or ignored; the pixels that differ (true: there are
 * some), and with `all` how many came twice; what the first incomplete frames lack. */
void intake_report(const struct intake *in);
bool intake_report_twice(const struct intake *in, bool all);
void intake_report_missing(const struct intake *in);
/* Prints how to finish the pictures from `log`; NULL: from `inputs`. Tells the commands of
 * log_remedy unless `more` says that they would not make all pictures. */
void intake_report_remedy(const struct intake *in, const char *log, char *const *inputs,
    const struct image_out *to, bool more);
/* True if one of these names, up to NULL, is "-". */
bool intake_piped(char *const *inputs);
/* Prints why there is no frame. `why` is that of the run's bye, "" if it has none. Returns true,
 * and prints that, if a run that was `piped` here had slots of different jobs. */
bool intake_report_bye(const struct intake *in, const char *why, bool piped);
/*
 * The file `name`, with these bytes, has a record `frame F W H job=HASH` for each picture that is
 * expected. Declares those without any record so far. Returns 0; else why names the error: in the
 * file, or a picture of another job or size.
 */
int intake_expect(struct intake *in, const char *name, const struct buf *frames, char why[LOG_WHY]);

/* True if fragments of a frame without a declaration remain: its frame record was lost. */
bool intake_orphaned(const struct intake *in);

/* Passes to `put` a frame record and the tasks that f lacks, with new ids; nothing if f is
 * whole. */
void intake_missing(const struct assembly_frame *f, void (*put)(const void *p, size_t n));

/* Callbacks while a stream is read. */
struct log_reader {
    void (*record)(void *ctx, const struct record *r); /* for each good record */
    /* before each read, which may block; or NULL */
    void (*before)(void *ctx, int fd);
    void *ctx;
};
/* Reads fd to its end and counts losses in `in`. Messages call it `name`. Returns 0; 1 at a
 * hello of another format, with text in in->why; or -1 with errno. */
int log_read(struct intake *in, int fd, const char *name, const struct log_reader *reader);

/* The same for the file at `path`, which counts no losses; 1: the text is in why. -1 with errno: it
 * cannot be opened; -2 with errno: it cannot be read. */
int log_read_path(const char *path, const struct log_reader *reader, char why[LOG_WHY]);

/*
 * Sets *us to the longest time in the log at `path`: from the begin of a run to the end of its
 * first task, or of a later task; 0: it has none. Ignores times above most_us. Returns as
 * log_read_path does.
 */
int log_longest_us(const char *path, int64_t most_us, int64_t *us, char why[LOG_WHY]);
/*
 * Passes the good records of the stream at fd on to `put`, until its end or until no fragment has
 * come for patience_us: a sender that hangs may still send beats, or a byte now and then. Returns 1
 * at the end; 0 if it stalled; or -1 with errno.
 */
int log_pass(int fd, int64_t patience_us, void (*put)(const void *p, size_t n));

/*
 * Which pixels the log at `path` has: in->parts, without pixels. There are no frames if the log is
 * empty, missing, a device or a pipe. The caller frees *in with intake_free, whatever is returned:
 * 0; 1 if the log cannot be resumed, with the reason in why; or -1 with errno.
 */
int log_survey_path(const char *path, struct intake *in, char why[LOG_WHY]);

/* The cost of each pixel of a picture, from the CPU times of the tasks in a log. */
struct log_costs {
    uint32_t w, h; /* 0: no task was both done and delivered */
    double *us;    /* row by row; microseconds */
};
/* Reads the log's first frame. Missing pixels get the mean. Returns 0; else the reason in why. */
int log_costs_read(const char *path, struct log_costs *c, char why[LOG_WHY]);
void log_costs_free(struct log_costs *c);
/* The cost of pixel p of a picture of any size of the same scene. */
double log_cost_at(const struct log_costs *c, uint64_t p, uint32_t frame_w, uint32_t frame_h);
/* The cost of each pixel of a task, put at its place in us, which has frame_w x frame_h pixels. */
void log_costs_put(const struct log_costs *c, const struct lattice *at, uint32_t frame_w,
    uint32_t frame_h, double *us);
/* The sum over the pixels of a task. */
double log_cost_of(
    const struct log_costs *c, const struct lattice *at, uint32_t frame_w, uint32_t frame_h);

/* ---- the file ------------------------------------------------------------------------ */

struct log_file {
    const char *path; /* the caller's */
    int fd;           /* -1: none, or writing failed */
    bool holds;       /* it was not empty when opened */
    struct buf pending;
};

/*
 * Opens the log for reading and appending, and creates it if missing. It is locked until closed.
 * Returns 0, or -1 with errno; EWOULDBLOCK: another process has locked it. A file that is not
 * regular is opened only for writing.
 */
int log_open(struct log_file *l, const char *path);
/* log_append queues a record, log_flush writes. 0, or -1 with errno; the log is closed then. */
void log_append(struct log_file *l, const struct record *r);
int log_flush(struct log_file *l);
void log_close(struct log_file *l);
/* Reads the log from its beginning, as log_read does. */
int log_reread(const struct log_file *l, struct intake *in, const struct log_reader *reader);
/* The same into a new intake, for coverage only. Returns 1 if nothing may be appended to the
 * file, with text in in->why: it is of another format, or does not begin with a whole record. */
int log_survey(const struct log_file *l, struct intake *in);

/* The log's content before a run, and the frames of the run that belong to it; all zero at
 * first. */
struct log_past {
    bool known;
    struct intake held;
    struct frames confirmed;
};
/*
 * Checks that the stream of origin `now`, which announces r (a frame record with a job), may be
 * appended. A frame that the log does not know may be appended. A frame once confirmed is not
 * checked again. Make the first call before anything is appended. Returns 0; 1 if the stream must
 * not be appended, and why names the difference: size, options, arithmetic, version or scene, or
 * that the file is no log; or -1 with errno.
 */
int log_confirm(struct log_past *past, const struct log_file *l, const struct log_origin *now,
    const struct record *r, char why[LOG_WHY]);
void log_past_free(struct log_past *past);
/*
 * A run that is appended to a log, or to none. If the log holds something, it is not trusted before
 * a worker has announced a frame that belongs there: then its content is read, and counts before
 * the run's. For each record r of the run: log_keep_ignores; if r is a frame record with a job,
 * log_keep_confirm; log_keep_record; then intake_frame or intake_record.
 */
struct log_keep {
    struct log_file file;
    struct log_past past;
    bool trusted;   /* the log is empty, or of the same origin as this run */
    bool rereading; /* records come from the log */
    char why[24];   /* of the run's bye: it ended early; else "" */
};
/* log_open of `path`; NULL: no log. */
int log_keep_open(struct log_keep *k, const char *path);
/* True for fragments and beats before the log is trusted: only the origin and the frames of the
 * workers count until then. */
bool log_keep_ignores(const struct log_keep *k, const struct record *r);
/*
 * Checks r as log_confirm does, and notes it in `in`. When the log is trusted for the first time,
 * its records go to `reader`, while `rereading` is true. Returns 0; 1 if r does not belong to the
 * log, with the reason in why; or -1 with errno. Does nothing for records from the log, or if it
 * was empty.
 */
int log_keep_confirm(struct log_keep *k, struct intake *in, const struct record *r,
    const struct log_reader *reader, char why[LOG_WHY]);
/* Queues r, unless it comes from the log or is a beat. Notes the reason of the run's bye. */
void log_keep_record(struct log_keep *k, const struct record *r);
/* log_flush, once the log is trusted. */
int log_keep_flush(struct log_keep *k);
void log_keep_close(struct log_keep *k);

/*
 * Appends to `out` the shell commands, in one line, that finish the pictures of these logs
 * (NULL-ended): tasks, to the worker of that origin, to the last log; then `gather -o TO LOGS`,
 * where PICTURE.png stands for standard output. False if there is no log, if one is standard
 * input, which cannot be read again, or has a name that cannot be printed, and if the commands
 * would make another picture: with backdrops, or by a worker whose command they do not know.
 */
bool log_remedy(const char *const *logs, const struct log_origin *origin,
    const struct image_out *to, struct buf *out);

#endif
