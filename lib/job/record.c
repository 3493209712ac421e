/* State records of files, on standard output. */
#include "job/job.h"

#include <string.h>

void job_put(enum rec_kind kind, const char *name, struct buf *body)
{
    struct buf record = {0};
    if (buf_size(body) > (size_t)WIRE_STATE_MAX)
        die(ST_USAGE, "%s: %zu bytes, expected at most %lld", name, buf_size(body),
            (long long)WIRE_STATE_MAX);
    wire_state(&record, kind, buf_data(body), buf_size(body));
    put_stdout(buf_data(&record), buf_size(&record));
    buf_free(body);
    buf_free(&record);
}

void job_put_file(enum rec_kind kind, const char *path)
{
    struct buf body = {0};
    if (read_file(path, &body) != 0) die(ST_USAGE, "%s:", path);
    job_put(kind, path, &body);
}
