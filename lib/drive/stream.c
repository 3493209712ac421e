/* What both drivers do to their streams. */
#include "drive/drive.h"

#include <poll.h>

#define READ_BYTES 65536

struct pollfd poll_entry(int fd, bool wanted, short events)
{
    return (struct pollfd){.fd = wanted ? fd : -1, .events = events};
}

bool stream_read(struct decoder *d, int fd)
{
    if (read_some(fd, &d->in, READ_BYTES) > 0) return true;
    wire_end(d);
    return false;
}

void up_forward(
    struct up_queue *q, const struct record *r, const char *const *drop, const char *extra)
{
    wire_forward(&q->bulk, r, drop, extra);
    up_end_record(q);
}
