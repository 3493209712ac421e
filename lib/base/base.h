/*
 * base: what every module may use. Messages and exit statuses, ranged number parsing, memory, byte
 * buffers, checked input and output, clocks, a counter-based random generator, hashing.
 *
 * The program's name is the only state. Functions that can fail for outside reasons return -1 with
 * errno set, unless stated otherwise. Only die(), functions that call it as stated, and the
 * x-allocators exit.
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

/* Call first in main. Stores the last component of argv[0] for messages, fills closed descriptors
 * 0, 1 and 2, and makes a file size limit an error of write instead of a signal. */
void prog_init(const char *argv0);
const char *prog_name(void);
/* Prints "program: text" on stderr, in one line: what text_shown does not show, such as an escape
 * in a file's name, appears as \x1b. If the format ends in ':', errno's text is appended. */
void warn(const char *fmt, ...) PRINTF_LIKE(1, 2);
/* The same, then exit(status). */
_Noreturn void die(int status, const char *fmt, ...) PRINTF_LIKE(2, 3);
/*
 * Prints "NAME: text" on stderr: a line from another program. Unprintable bytes appear as \x1b.
 */
void relay(const char *who, const char *text, size_t n);
/* The same for a line that begins with that name: what text_shown does not show appears as \x1b. */
void relay_line(const char *line);
/*
 * Messages that a function returns to its caller. err_set cuts the text to ERR_BYTES. err_at puts
 * "file:line: " in front, with the name cut to 100 bytes. Both return false, so that their caller
 * can return that.
 */
#define ERR_BYTES 256
bool err_set(char err[ERR_BYTES], const char *fmt, ...) PRINTF_LIKE(2, 3);
bool err_at(char err[ERR_BYTES], const char *file, size_t line, const char *fmt, va_list ap)
    PRINTF_LIKE(4, 0);
/* Formats n bytes at word for a message: in quotes, cut, and printable. Returns out. */
#define ERR_WORD 40
#define ERR_PATH 101
/* A path for messages: a long one without its beginning. */
const char *err_path(char out[ERR_PATH], const char *path);
const char *err_word(char out[ERR_WORD], const void *word, size_t n);
/* The bytes of the character at text, where n bytes are; 0: it is a control character, which a
 * terminal would obey, or no UTF-8. XML has neither. (printable.c) */
size_t utf8_shown(const void *text, size_t n);
/* Copies s to out, of `room` bytes, where bytes for which that is 0 become \x1b. What has no room
 * is left out. Returns the length. */
size_t text_shown(char *out, size_t room, const char *s);
/* The first place of the k bytes at what, at least one, in the n bytes; NULL: none. (text.c) */
const void *text_find(const void *in, size_t n, const void *what, size_t k);
/* True if the word, which is not empty, is in s, in large or small letters. */
bool text_has(const char *s, const char *word);
/* As strcmp, but numbers within the texts come by value: frame9 before frame10. */
int text_order(const char *a, const char *b);
/* Cuts the text at the first `end`, moves *rest behind it, and returns the part before. With none,
 * that is all, and *rest becomes NULL. NULL: *rest is. */
char *text_part(char **rest, char end);
/* Prints "usage: program TEXT" and exits: to stdout if status is 0 (-h), otherwise to stderr. */
_Noreturn void usage(int status, const char *text);
/* Prints "program VERSION" to stdout, and exits with status 0. */
_Noreturn void version(void);

/*
 * getopt(3) for every program. `--help` counts as -h. `--version` prints the name and the version
 * and exits. If the letters begin with '+', parsing stops at the first operand.
 */
int prog_getopt(int argc, char **argv, const char *letters);
/*
 * Returns the argument of option `-opt`, such as a file name. Dies with status 2 if it is empty or
 * looks like the next option, because the argument was probably left out.
 */
const char *opt_text(int opt, const char *s);

/* ---- numbers -------------------------------------------------------------------------- */

/*
 * Accept only a whole string that is a decimal number within [min, max]. Anything else (empty,
 * blanks, trailing text, NaN, infinity, hexadecimal) returns false and leaves *out unchanged.
 */
bool parse_int(const char *s, int64_t min, int64_t max, int64_t *out);
bool parse_real(const char *s, double min, double max, double *out);
/* Parses "512x384" with both sides in [1, max]. */
bool parse_size(const char *s, int max, int *w, int *h);
/* parse_int for the argument of option `-opt`. Dies with status 2 and prints the range if that
 * fails. */
int64_t opt_int(int opt, const char *s, int64_t min, int64_t max);
double opt_real(int opt, const char *s, double min, double max);
/* The same with parse_size. */
void opt_size(int opt, const char *s, int max, int *w, int *h);
/* The same for a comma-separated list. Returns *n numbers, which the caller frees. */
double *opt_reals(int opt, const char *s, double min, double max, size_t *n);

/* Writes v with `digits` significant digits, or as many more as it needs to read back as v. */
void print_real(char text[32], double v, int digits);
void print_float(char text[32], float v, int digits);

/* ---- vector units --------------------------------------------------------------------- */

/* Instruction sets that kernels are compiled for. ISA_SSE2 stands for the baseline of any machine.
 * The width never changes a result. */
enum isa { ISA_AUTO, ISA_SSE2, ISA_AVX2, ISA_AVX512 };
bool isa_available(enum isa isa);
/* Parses "sse2", "avx2" or "avx512" for option `-opt`. Dies with status 2 on other text, or if this
 * machine lacks it. */
enum isa opt_isa(int opt, const char *s);

/* ---- threads -------------------------------------------------------------------------- */

/* The caller's thread and `threads` - 1 more, or fewer if the system refuses them. Those block all
 * signals. */
struct parallel;
struct parallel *parallel_new(int threads);
/* Calls job(ctx, i) for each i < n, in any order and at the same time. Returns when all calls have
 * returned. A job must not call it again. */
typedef void (*parallel_job)(void *ctx, uint32_t i);
void parallel_run(struct parallel *p, uint32_t n, parallel_job job, void *ctx);
/* Ends the threads. */
void parallel_free(struct parallel *p);

/* ---- memory --------------------------------------------------------------------------- */

/* Never NULL: they die with status 3. n * size is checked for overflow. */
void *xmalloc(size_t n, size_t size);
void *xcalloc(size_t n, size_t size);
void *xrealloc(void *p, size_t n, size_t size);
/* Room for item n, the next, in an array that grows by this only. n may begin at 0 again. */
void *xgrown(void *p, size_t n, size_t size);
char *xstrdup(const char *s);
/* The same, aligned to 64 bytes, not cleared. Release with free(). */
void *xaligned(size_t n, size_t size);

/* Bytes [off, len) of data are unread. Append at the end, consume at the front. */
struct buf {
    unsigned char *data;
    size_t off, len, cap;
};

void buf_free(struct buf *b);
/* Makes room for n more bytes after len. May move data and drop consumed bytes. */
unsigned char *buf_reserve(struct buf *b, size_t n);
void buf_append(struct buf *b, const void *p, size_t n);
void buf_printf(struct buf *b, const char *fmt, ...) PRINTF_LIKE(2, 3);
void buf_consume(struct buf *b, size_t n);
/* Appends s as one word of a shell command. */
void buf_word(struct buf *b, const char *s);
static inline size_t buf_size(const struct buf *b) { return b->len - b->off; }
static inline const unsigned char *buf_data(const struct buf *b)
{
    return b->data ? b->data + b->off : (const unsigned char *)"";
}

/* ---- input and output ----------------------------------------------------------------- */

/* Writes all n bytes to fd; repeats on EINTR. Returns 0, or -1 with errno. */
int write_full(int fd, const void *p, size_t n);
/* Appends one read(2) of at most `most` bytes to b; repeats on EINTR. Returns the bytes read, 0 at
 * the end, or -1 with errno. */
ptrdiff_t read_some(int fd, struct buf *b, size_t most);
/*
 * What a run reads, no output of it replaces: outfile_open dies with status 2 if it is told to.
 * input_open, read_open, read_file and load_file note what they open. For files that are read
 * otherwise, or later, or by another program, call input_add before the first output is opened.
 * Two names, or links, may lead to one file. "-" is standard input. (input.c)
 */
/* what: for the message, such as "an input" or "the log"; it must stay. If the file was noted
 * before, what it was then counts. Only regular files are noted. */
void input_add(const char *path, const char *what);
/* What the file was noted as; NULL: it is no input. */
const char *input_is(const char *path);
/* Dies with status 2 if the file is an input. */
void input_keep(const char *path);
/* Opens a file for reading and notes it. Returns a descriptor, or -1 with errno. */
int input_open(const char *path);
/* Opens the file *name for reading; "-" is standard input, and *name becomes that. Dies with status
 * 2 on failure. */
int read_open(const char **name);
/* Appends the whole file to b; "-": standard input. Returns 0, or -1 with errno. */
int read_file(const char *path, struct buf *b);
/* The same into *b, which is initialized. On failure returns false with a message in err and *b
 * empty. */
bool load_file(const char *path, struct buf *b, char err[ERR_BYTES]);
/* Writes all n bytes to stdout. Dies with status 3 on failure. */
void put_stdout(const void *p, size_t n);
/* The same for all unread bytes of b, which are then consumed. */
void put_stdout_buf(struct buf *b);
/* Flushes and closes stdout. Dies with status 3 if any output was lost. */
void close_stdout(void);

/* A file that appears under its name only when complete: written beside it, then renamed. A link
 * stays, and the file that it leads to is replaced. A name of an open descriptor, such as
 * /dev/stdout, or a link to one, is that descriptor: what was written there stays. SIGHUP, SIGINT
 * and SIGTERM, unless ignored, remove what is not complete. (outfile.c) */
struct outfile {
    FILE *f;
    char *path, *temporary; /* temporary NULL: it is written directly (a device, a pipe) */
};

/* Returns 0, or -1 with errno. Dies with status 2 if the file is an input. */
int outfile_open(struct outfile *o, const char *path);
/* Flushes, closes, renames. Returns 0, or -1 with errno and no file left. */
int outfile_commit(struct outfile *o);
void outfile_discard(struct outfile *o);
/* Writes n bytes as such a file. Returns 0, or -1 with errno and no file left. */
int outfile_put(const char *path, const void *p, size_t n);
/* Tests whether the path can be written: it is no directory, its name is not too long, and its
 * directory is writable. Returns 0, or -1 with errno. A directory name with `%` is not tested. Dies
 * with status 2 if the file is an input. */
int outfile_check(const char *path);

/* ---- clocks, in microseconds ---------------------------------------------------------- */

int64_t now_us(void); /* monotonic, without the time that was forgotten */
/* This process was stopped for this time, which is to count nowhere. */
void clock_forget(int64_t us);
int64_t cpu_us(void); /* this process */

/* ---- chance and hashes ---------------------------------------------------------------- */

/* A counter-based generator: the value depends only on (seed, counter). The finaliser is
 * SplitMix64's (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014). */
static inline uint64_t rng_u64(uint64_t seed, uint64_t counter)
{
    uint64_t z = seed * UINT64_C(0xd1342543de82ef95) + counter * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}
/* In [0, 1). */
static inline double rng_unit(uint64_t seed, uint64_t counter)
{
    return (double)(rng_u64(seed, counter) >> 11) * 0x1p-53;
}

#define HASH64_INIT 0
/* XXH64 of n bytes, with a seed: HASH64_INIT, or the hash of what came before. For accidents: two
 * inputs of one hash are easily made. */
uint64_t hash64(uint64_t seed, const void *p, size_t n);
/* The same for n 32-bit numbers, least significant byte first: the same hash on all machines. */
uint64_t hash64_u32(uint64_t seed, const void *p, size_t n);
#define SHA256_TEXT 65 /* bytes of a SHA-256 in hexadecimal, with NUL */
/* SHA-256 of n bytes: two inputs of one hash, or of its first 32 digits, cannot be made. */
void sha256(const void *p, size_t n, char text[SHA256_TEXT]);
/* The same without special instructions, for comparison. */
void sha256_plain(const void *p, size_t n, char text[SHA256_TEXT]);

#endif
