/* A log that grows: see view.h. */
#include "os/os.h"
#include "view/view.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#define READ_BYTES (1 << 18)

void view_open(struct view_log *v, const char *path)
{
    *v = (struct view_log){.path = path, .fd = -1, .d.upward = true};
    v->log.eta = &v->eta;
    v->heard_us = now_us();
}

static void forget(struct view_log *v)
{
    const char *path = v->path;
    view_close(v);
    view_open(v, path);
}

void view_close(struct view_log *v)
{
    if (v->fd >= 0) close(v->fd);
    wire_free(&v->d);
    history_free(&v->log);
    v->fd = -1;
}

/* Another file has the name, or this one has lost bytes that were read. */
static bool changed(const struct view_log *v)
{
    struct stat named, held;
    if (fstat(v->fd, &held) != 0) die(ST_SYSTEM, "%s:", v->path);
    if (S_ISREG(held.st_mode) && (uint64_t)held.st_size < v->at) return true;
    return stat(v->path, &named) == 0 && named.st_ino != v->inode;
}

static bool find(struct view_log *v)
{
    struct stat st;
    v->fd = open(v->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (v->fd < 0 && errno == ENOENT) return false;
    if (v->fd < 0) die(ST_USAGE, "%s:", v->path);
    if (fstat(v->fd, &st) != 0) die(ST_SYSTEM, "%s:", v->path);
    if (!S_ISREG(st.st_mode)) die(ST_USAGE, "%s: is no regular file, expected a log", v->path);
    v->inode = st.st_ino;
    return true;
}

bool view_read(struct view_log *v)
{
    if (v->fd >= 0 && changed(v)) forget(v);
    if (v->fd < 0 && !find(v)) return false;
    ptrdiff_t n;
    while ((n = read_some(v->fd, &v->d.in, READ_BYTES)) > 0) {
        v->at += (uint64_t)n;
        v->heard_us = now_us();
        history_feed(&v->log, &v->d);
        if (v->log.refused) die(ST_USAGE, "%s: %s", v->path, v->log.why);
    }
    if (n < 0) die(ST_SYSTEM, "%s:", v->path);
    return true;
}

bool view_ended(const struct view_log *v) { return v->log.ended; }

bool view_held(const struct view_log *v) { return v->fd >= 0 && os_locked(v->fd); }

bool view_whole(const struct view_log *v)
{
    const struct history *l = &v->log;
    for (size_t i = 0; i < l->n_frames; i++)
        if (!coverage_full(&l->frames[i].have)) return false;
    return l->n_frames > 0;
}
