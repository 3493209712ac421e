/*
 * The table of hosts: its rows, and reading the text of a file.
 */
#include "hosts/hosts_int.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILE_MOST (16 << 20) /* bytes */

bool host_is_here(const struct host *h) { return strcmp(h->name, ":") == 0; }

bool hosts_refuse(const struct hosts_reader *r, const char *fmt, ...)
{
    int n = r->line ? snprintf(r->err, HOSTS_ERR, "%s:%d: ", r->name, r->line)
                    : snprintf(r->err, HOSTS_ERR, "%s: ", r->name);
    va_list ap;
    va_start(ap, fmt);
    if (n >= 0 && n < HOSTS_ERR) vsnprintf(r->err + n, HOSTS_ERR - (size_t)n, fmt, ap);
    va_end(ap);
    return false;
}

struct host *hosts_add(struct hosts *h)
{
    h->at = xgrown(h->at, h->n, sizeof *h->at);
    h->at[h->n] = (struct host){.slots = 1, .latency_ms = -1};
    return &h->at[h->n++];
}

bool hosts_count(const struct hosts_reader *r, struct hosts *h, const struct host *host)
{
    if (host_is_here(host) && (host->via || host->bin || host->send || host->wait_s > 0))
        return hosts_refuse(r, "`:` is this machine, expected no via=, bin=, send= or wait=");
    if (host->bin && host->send)
        return hosts_refuse(r, "bin= and send= together, expected one of them");
    if (h->n > HOSTS_MOST) return hosts_refuse(r, "more than %d hosts, expected fewer", HOSTS_MOST);
    h->slots += host->slots;
    if (h->slots <= HOSTS_SLOTS_MAX) return true;
    return hosts_refuse(r, "%d slots, expected at most %d in all", h->slots, HOSTS_SLOTS_MAX);
}

bool hosts_read_file(const struct hosts_reader *r, struct buf *text)
{
    struct stat st;
    ptrdiff_t n = 0;
    int fd = open(r->name, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0) return hosts_refuse(r, "%s, expected a file that can be read", strerror(errno));
    bool regular = fstat(fd, &st) == 0 && S_ISREG(st.st_mode);
    while (regular && buf_size(text) <= FILE_MOST && (n = read_some(fd, text, 1 << 16)) > 0)
        ;
    int err = errno;
    close(fd);
    if (!regular) return hosts_refuse(r, "no regular file, expected one with a line for each host");
    if (n < 0) return hosts_refuse(r, "%s, expected a file that can be read", strerror(err));
    if (buf_size(text) <= FILE_MOST) return true;
    return hosts_refuse(r, "larger than %d bytes, expected a line for each host", FILE_MOST);
}

void hosts_here(struct hosts *h, int slots)
{
    *h = (struct hosts){.slots = slots};
    struct host *host = hosts_add(h);
    host->name = xstrdup(":");
    host->slots = slots;
}

static int64_t ns(struct timespec t) { return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec; }

struct hosts_version hosts_version(const char *file)
{
    struct stat st;
    if (stat(file, &st) != 0) return (struct hosts_version){0};
    return (struct hosts_version){.device = (int64_t)st.st_dev,
        .number = (int64_t)st.st_ino,
        .bytes = (int64_t)st.st_size,
        .written_ns = ns(st.st_mtim),
        .changed_ns = ns(st.st_ctim)};
}

void host_free(struct host *host)
{
    for (size_t i = 0; i < host->n_members; i++) host_free(&host->members[i]);
    if (host->members) { /* the row has what the head has */
        free(host->members);
        free(host->rack);
        return;
    }
    free(host->name);
    free(host->via);
    free(host->bin);
    buf_free(&host->offer);
    buf_free(&host->way);
}

void hosts_free(struct hosts *h)
{
    for (size_t i = 0; i < h->n; i++) host_free(&h->at[i]);
    free(h->at);
    free(h->file);
    *h = (struct hosts){0};
}

double *hosts_powers(const struct hosts *h, const char **without)
{
    double *power = xmalloc((size_t)h->slots, sizeof *power), *at = power;
    for (size_t i = 0; i < h->n; i++) {
        for (int k = 0; k < h->at[i].slots; k++) *at++ = h->at[i].power;
        if (h->at[i].power > 0) continue;
        *without = h->at[i].name;
        free(power);
        return NULL;
    }
    return power;
}
