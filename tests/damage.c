/* damage SEED: passes a stream on, record by record as they come, with one fault of this seed: a flipped bit, a cut, a
 * record that comes again, or two that change places. What it did goes to ./damaged. */
#include "base/base.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define AMONG 24  /* the fault is in one of the first records */
#define PAUSE 100 /* ms: a record that was to change places with the next waits for it so long */

static struct buf in, held; /* held: it waits for the next */
static const char *const kinds[] = {"flip", "flip in the line", "flip of its end", "cut", "cut within", "again", "places"};

/* The whole record at the front; 0: it has not come yet. */
static size_t record(void)
{
    const char *line = (const char *)buf_data(&in), *key = " bytes=";
    const char *end = buf_size(&in) ? memchr(line, '\n', buf_size(&in)) : NULL;
    if (!end) return 0;
    size_t n = (size_t)(end - line) + 1;
    const char *bytes = memmem(line, n, key, strlen(key));
    if (bytes) n += strtoul(bytes + strlen(key), NULL, 10) + 1;
    return n <= buf_size(&in) ? n : 0;
}

static void put(const void *p, size_t n)
{
    if (write_full(STDOUT_FILENO, p, n) != 0) exit(ST_SYSTEM);
}

static void hurt(uint64_t seed, unsigned char *p, size_t n)
{
    enum { FLIP, FLIP_LINE, FLIP_END, CUT, CUT_WITHIN, AGAIN, PLACES, KINDS };
    uint64_t kind = rng_u64(seed, 1) % KINDS, at = rng_u64(seed, 2) % n;
    FILE *said = fopen("damaged", "ae");
    if (!said) die(ST_SYSTEM, "damaged:");
    const unsigned char *end = memchr(p, '\n', n);
    size_t line = end ? (size_t)(end - p) : n - 1;
    if (kind == FLIP_LINE) at %= line + 1;
    if (kind == FLIP_END) at = line;
    fprintf(said, "%s at byte %zu of `%.*s`\n", kinds[kind], (size_t)at, (int)line, (char *)p);
    fclose(said);
    if (kind <= FLIP_END) p[at] ^= (unsigned char)(1 << rng_u64(seed, 3) % 8);
    if (kind == CUT_WITHIN) put(p, at);
    if (kind == CUT || kind == CUT_WITHIN) exit(ST_OK);
    if (kind <= AGAIN) put(p, n);
    if (kind == AGAIN) put(p, n);
    if (kind == PLACES) buf_append(&held, p, n);
}

static void release(void)
{
    put(buf_data(&held), buf_size(&held));
    buf_consume(&held, buf_size(&held));
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    uint64_t seed = argc > 1 ? (uint64_t)opt_int('s', argv[1], 0, INT64_MAX) : 0;
    uint64_t at = rng_u64(seed, 0) % AMONG, k = 0;
    for (;;) {
        struct pollfd p[2] = {{STDIN_FILENO, POLLIN, 0}, {STDOUT_FILENO, 0, 0}};
        if (poll(p, 2, buf_size(&held) ? PAUSE : -1) == 0) release();
        else if (p[1].revents || read_some(STDIN_FILENO, &in, 65536) <= 0) break;
        for (size_t n; (n = record()) != 0; buf_consume(&in, n)) {
            if (k++ == at) {
                hurt(seed, in.data + (buf_data(&in) - in.data), n);
            } else {
                put(buf_data(&in), n);
                release();
            }
        }
    }
    release();
    put(buf_data(&in), buf_size(&in));
    return ST_OK;
}
