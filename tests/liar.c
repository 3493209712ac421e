/* liar SHARE [SEED] <FRAGMENTS: passes on what a worker says, but changes a bit of red in the first
 * pixel of this share of its fragments, with a good crc. Writes where each of these begins to
 * ./lies. */
#include "base/base.h"
#include "wire/wire.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void pass(struct buf *b, const struct record *r, bool lie, FILE *lies)
{
    static float rgba[WIRE_FRAG_PIXELS_MAX * 4];
    uint32_t bits;
    if (!lie) {
        wire_forward(b, r, NULL, NULL);
        return;
    }
    rec_pixels(r, rgba);
    memcpy(&bits, rgba, sizeof bits);
    bits ^= 1;
    memcpy(rgba, &bits, sizeof bits);
    char job[WIRE_JOB];
    if (!rec_str(r, "job", job, sizeof job)) *job = '\0';
    wire_frag(b, &r->task, &r->task.at, job, rgba);
    fprintf(lies, "%u %u\n", r->task.at.x, r->task.at.y);
    fflush(lies);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    double share = argc > 1 ? opt_real('p', argv[1], 0, 1) : 1;
    uint64_t seed = argc > 2 ? (uint64_t)opt_int('s', argv[2], 0, INT64_MAX) : 0, n = 0;
    struct decoder in = {.upward = true, .coded = true};
    struct record r;
    struct buf b = {0};
    FILE *lies = fopen("lies", "ae");
    if (!lies) die(ST_SYSTEM, "lies:");
    while (read_some(STDIN_FILENO, &in.in, 65536) > 0) {
        while (wire_next(&in, &r) == WIRE_RECORD)
            pass(&b, &r, r.kind == REC_FRAG && rng_unit(seed, n++) < share, lies);
        if (write_full(STDOUT_FILENO, buf_data(&b), buf_size(&b)) != 0) return ST_SYSTEM;
        buf_consume(&b, buf_size(&b));
    }
    buf_free(&b);
    wire_free(&in);
    fclose(lies);
    return ST_OK;
}
