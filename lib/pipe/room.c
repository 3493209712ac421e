/*
 * Long state records, and the memory that this process may still take. Estimates are from below, so
 * that no state is refused that fits.
 */
#include "pipe/pipe.h"

#define HEAD_BYTES (1 << 18) /* of a state decide, because its head is in them */
#define MIB 1048576.0

enum rec_kind stream_arrives(struct decoder *d, size_t *bytes)
{
    if (d->drops || buf_size(&d->in) > HEAD_BYTES) return REC_KINDS;
    const enum rec_kind kind = wire_awaited(d, bytes);
    return *bytes < STREAM_LONG ? REC_KINDS : kind;
}

double stream_buffer(size_t bytes)
{
    double buffer = HEAD_BYTES; /* it is doubled until it has room */
    while (buffer < (double)bytes) buffer *= 2;
    return buffer;
}

static bool refuse(double needs, double may, char err[ERR_BYTES])
{
    return err_set(err, "out of memory: needs about %.0f MiB, this host may use %.0f MiB",
        ceil(needs / MIB), floor(may / MIB));
}

bool stream_fits(double memory, double addresses, char err[ERR_BYTES])
{
    const struct proc_memory may = proc_memory("");
    if (memory > may.bytes) return refuse(memory, may.bytes, err);
    if (addresses > may.addresses) return refuse(addresses, may.addresses, err);
    return true;
}
