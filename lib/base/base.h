/*
 * base: what every module may use. Messages and exit statuses, ranged number parsing, memory,
 * byte buffers, checked input and output, clocks, a counter-based generator, hashing, vectors.
 *
 * Nothing here keeps state but the program's name. Functions that can fail for reasons outside
 * the program return -1 with errno set, or say otherwise; only die() and the x-allocators exit.
 */
#ifndef STORMRING_BASE_H
#define STORMRING_BASE_H

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define STORMRING_VERSION "0.2"

/* Exit statuses, the same for every program. */
enum {
    ST_OK = 0,      /* done */
    ST_PARTIAL = 1, /* the result is incomplete, or differs */
    ST_USAGE = 2,   /* bad usage or bad input */
    ST_SYSTEM = 3   /* the system failed: I/O, no host left */
};

#define PRINTF_LIKE(f, a) __attribute__((format(printf, f, a)))

/* ---- messages ------------------------------------------------------------------------- */

/* Remember argv[0]'s last component for messages, see to it that descriptors 0, 1 and 2 are taken,
 * and that a file that may grow no more is an error of write, not a signal. Call first in main. */
void prog_init(const char *argv0);
const char *prog_name(void);
/* "program: text" on stderr; a format that ends in ':' has errno's text appended. */
void warn(const char *fmt, ...) PRINTF_LIKE(1, 2);
/* The same, then exit(status). */
_Noreturn void die(int status, const char *fmt, ...) PRINTF_LIKE(2, 3);
/*
 * "who: text" on stderr: a line that another program wrote there, whose unprintable bytes are shown
 * as \x1b.
 */
void relay(const char *who, const char *text, size_t n);
/*
 * Messages that a function hands back instead. err_set's text is cut where it does not fit; err_at
 * has "file:line: " in front of it, that name cut at 100 bytes. Both return false, for their caller
 * to return.
 */
#define ERR_BYTES 256
bool err_set(char err[ERR_BYTES], const char *fmt, ...) PRINTF_LIKE(2, 3);
bool err_at(char err[ERR_BYTES], const char *file, size_t line, const char *fmt, va_list ap)
    PRINTF_LIKE(4, 0);
/* The n bytes at word as messages show them: in quotes, cut, and printable. Returns out. */
#define ERR_WORD 40
const char *err_word(char out[ERR_WORD], const void *word, size_t n);
/* Prints "usage: program TEXT": to stdout with status 0 (-h), else to stderr; exits. */
_Noreturn void usage(int status, const char *text);
/* Prints "program VERSION" to stdout, and exits with status 0. */
_Noreturn void version(void);

/*
 * getopt(3), for every program: `--help` is -h, and `--version` prints the name and the version and
 * exits. With a '+' in front of the letters neither is taken behind the first operand.
 */
int prog_getopt(int argc, char **argv, const char *letters);
/*
 * The argument of option `-opt`, such as a file's name. It dies with status 2 if that looks like
 * the next option, because the argument was left out.
 */
const char *opt_text(int opt, const char *s);

/* ---- numbers -------------------------------------------------------------------------- */

/*
 * The whole string must be a decimal number within [min, max]; anything else (empty, blanks,
 * trailing text, NaN, infinity, hexadecimal) returns false and leaves *out alone.
 */
bool parse_int(const char *s, int64_t min, int64_t max, int64_t *out);
bool parse_real(const char *s, double min, double max, double *out);
/* "512x384" with both sides in [1, max]. */
bool parse_size(const char *s, int max, int *w, int *h);
/* parse_int for the argument of option `-opt`; dies with status 2 and the range in the text. */
int64_t opt_int(int opt, const char *s, int64_t min, int64_t max);
double opt_real(int opt, const char *s, double min, double max);
/* The same for parse_size. */
void opt_size(int opt, const char *s, int max, int *w, int *h);
/* The same of a list with commas between: *n numbers, which the caller frees. */
double *opt_reals(int opt, const char *s, double min, double max, size_t *n);

/* The shortest decimal of 6 digits or more that reads back as v. */
void print_real(char text[32], double v);

/* ---- vector units --------------------------------------------------------------------- */

/* What kernels are compiled for; ISA_SSE2 stands for the least that a machine has. The width never
 * changes a result. */
enum isa { ISA_AUTO, ISA_SSE2, ISA_AVX2, ISA_AVX512 };
bool isa_available(enum isa isa);
/* "sse2", "avx2" or "avx512", as said with option `-opt`; dies with status 2 at anything else. */
enum isa opt_isa(int opt, const char *s);

/* ---- memory --------------------------------------------------------------------------- */

/* Never NULL: they die with status 3. n * size is checked for overflow. */
void *xmalloc(size_t n, size_t size);
void *xcalloc(size_t n, size_t size);
void *xrealloc(void *p, size_t n, size_t size);
char *xstrdup(const char *s);
/* As above, on 64-byte boundaries, not cleared; free() releases it. */
void *xaligned(size_t n, size_t size);

/* Bytes in [off, len) of data are unread; append at the end, consume at the front. */
struct buf {
    unsigned char *data;
    size_t off, len, cap;
};

void buf_free(struct buf *b);
/* Room for n more bytes after len (may move data and drop what was consumed). */
unsigned char *buf_reserve(struct buf *b, size_t n);
void buf_append(struct buf *b, const void *p, size_t n);
void buf_printf(struct buf *b, const char *fmt, ...) PRINTF_LIKE(2, 3);
void buf_consume(struct buf *b, size_t n);
/* s as one word of a shell command; */
void buf_word(struct buf *b, const char *s);
/* a file's name, which is then never mistaken for an option. */
void buf_quote(struct buf *b, const char *s);
static inline size_t buf_size(const struct buf *b) { return b->len - b->off; }
static inline const unsigned char *buf_data(const struct buf *b)
{
    return b->data ? b->data + b->off : (const unsigned char *)"";
}

/* ---- input and output ----------------------------------------------------------------- */

/* All of n bytes to fd, riding out EINTR. 0, or -1 with errno. */
int write_full(int fd, const void *p, size_t n);
/* Append one read(2) of at most `most` bytes to b, riding out EINTR: bytes read, 0 at the end,
 * -1. */
ptrdiff_t read_some(int fd, struct buf *b, size_t most);
/* The whole file ("-": standard input) appended to b. 0, or -1 with errno. */
int read_file(const char *path, struct buf *b);
/* The same into *b, which is set anew; false with a message in err, and *b is empty. */
bool load_file(const char *path, struct buf *b, char err[ERR_BYTES]);
/* All of n bytes to stdout; dies with status 3 where that fails. */
void put_stdout(const void *p, size_t n);
/* Flush and close stdout; dies with status 3 when anything written to it was lost. */
void close_stdout(void);

/* A file that appears under its name only when whole: written beside it, then renamed. */
struct outfile {
    FILE *f;
    char *path, *temporary; /* temporary NULL: path is written as it is (a device, a pipe) */
};

int outfile_open(struct outfile *o, const char *path);
/* Flush, close, rename. 0, or -1 with errno, and then nothing is left behind. */
int outfile_commit(struct outfile *o);
void outfile_discard(struct outfile *o);
/* All of n bytes as such a file. 0, or -1 with errno, and then nothing is left behind. */
int outfile_put(const char *path, const void *p, size_t n);
/* Could path be written? 0, or -1 with errno. A name with `%` in its directory is taken on
 * trust. */
int outfile_check(const char *path);

/* ---- clocks, in microseconds ---------------------------------------------------------- */

int64_t now_us(void); /* monotonic */
int64_t cpu_us(void); /* this process */

/* ---- progress ------------------------------------------------------------------------- */

/* One line on stderr, rewritten at most five times a second: percent and estimated time left. */
struct progress {
    bool on;
    int width; /* columns on the screen now */
    int64_t start_us, next_us;
    uint64_t before; /* done before it started */
};

void progress_start(struct progress *p, bool on);
/* So much had been done by an earlier run: the estimate begins here. */
void progress_resume(struct progress *p, uint64_t done);
void progress_show(struct progress *p, uint64_t done, uint64_t total);
/* Before any other message, and at the end. */
void progress_clear(struct progress *p);

/* ---- chance and hashes ---------------------------------------------------------------- */

/* A counter-based generator: the value is a function of (seed, counter) alone. The finaliser is
 * SplitMix64's (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014). */
static inline uint64_t rng_u64(uint64_t seed, uint64_t counter)
{
    uint64_t z = seed * UINT64_C(0xd1342543de82ef95) + counter * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}
/* in [0, 1) */
static inline double rng_unit(uint64_t seed, uint64_t counter)
{
    return (double)(rng_u64(seed, counter) >> 11) * 0x1p-53;
}

#define HASH64_INIT UINT64_C(0xcbf29ce484222325)
/* FNV-1a (Fowler, Noll, Vo), 64 bit, continued from h. Not for adversaries. */
uint64_t hash64(uint64_t h, const void *p, size_t n);
/* The same of n numbers of 32 bits, bytes from the least significant: one hash on all machines. */
uint64_t hash64_u32(uint64_t h, const void *p, size_t n);

/* ---- vectors -------------------------------------------------------------------------- */

struct vec3 {
    double x, y, z;
};

static inline struct vec3 v3(double x, double y, double z) { return (struct vec3){x, y, z}; }
static inline struct vec3 v3_of(const double a[3]) { return v3(a[0], a[1], a[2]); }
static inline struct vec3 v3_add(struct vec3 a, struct vec3 b)
{
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline struct vec3 v3_sub(struct vec3 a, struct vec3 b)
{
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline struct vec3 v3_scale(struct vec3 a, double s)
{
    return v3(a.x * s, a.y * s, a.z * s);
}
/* a + s b */
static inline struct vec3 v3_mad(struct vec3 a, struct vec3 b, double s)
{
    return v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}
static inline double v3_dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct vec3 v3_cross(struct vec3 a, struct vec3 b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double v3_len(struct vec3 a) { return sqrt(v3_dot(a, a)); }
static inline struct vec3 v3_unit(struct vec3 a) { return v3_scale(a, 1 / v3_len(a)); }

/* ---- camera --------------------------------------------------------------------------- */

/*
 * From pixels to rays, as NFF has it (E. Haines, "A Proposal for Standard Graphics Environments",
 * IEEE Computer Graphics and Applications 7, 1987): the angle spans the frame's top edge to its
 * bottom edge, pixels are square, x grows along direction x up, row 0 is on top. The same bits on
 * every host.
 */
struct camera {
    struct vec3 eye, forward, right, up; /* right, up: half the frame's height at distance 1 */
    uint32_t w, h;                       /* of the frame, in pixels: the caller's to set */
};

/* angle_deg in (0, 180); at is not where from is. Where `up` is along the view, any roll will do,
 * but it is always the same. */
struct camera camera_new(struct vec3 from, struct vec3 at, struct vec3 up, double angle_deg);
/* From the eye to the frame's point (x, y), in pixels from its top left corner: as far as that is
 * at distance 1 along forward. */
static inline struct vec3 camera_direction(const struct camera *c, double x, double y)
{
    double sx = (2 * x - c->w) / c->h, sy = (c->h - 2 * y) / c->h;
    return v3_mad(v3_mad(c->forward, c->right, sx), c->up, sy);
}

/* angle in [0, pi/2). A C library's own may differ in the last bit from host to host. */
double portable_tan(double angle);

#endif
