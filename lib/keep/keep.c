/* Kept state: see keep.h. */
#include "keep/keep.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#define READ_BYTES (1 << 20)
#define FREE_PART 100  /* one of this number of parts of the file system stays free */
#define PARTIAL_S 3600 /* a file that a process was killed at is removed after this time */
#define PARTIAL "new-" /* its name begins so */
#define PARTIAL_ROOM 64

/* ---- the directory --------------------------------------------------------------------------- */

/*
 * Opens the directory `name` in `at`, or makes it: of this user, and closed to others. A symbolic
 * link is refused. Closes `at`. -1: it cannot be used.
 */
static int enter(int at, const char *name, bool make)
{
    struct stat st;
    if (at < 0) return -1;
    if (make && mkdirat(at, name, 0700) != 0 && errno != EEXIST) {
        close(at);
        return -1;
    }
    int fd = openat(at, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    close(at);
    if (fd < 0) return -1;
    bool good = fstat(fd, &st) == 0 && st.st_uid == geteuid() &&
                (!(st.st_mode & 077) || fchmod(fd, 0700) == 0);
    if (good) return fd;
    close(fd);
    return -1;
}

/* The directory of the files; -1: there is none. */
static int open_directory(bool make)
{
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    struct buf path = {0};
    if (cache && *cache == '/') buf_printf(&path, "%s", cache);
    else if (home && *home == '/') buf_printf(&path, "%s/.cache", home);
    else return -1;
    buf_append(&path, "", 1);
    if (make) mkdir((char *)path.data, 0700);
    int fd = open((char *)path.data, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    buf_free(&path);
    return enter(enter(fd, "stormring", make), "state", make);
}

static bool is_hash(const char *name)
{
    return strspn(name, "0123456789abcdef") == SHA256_TEXT - 1 && !name[SHA256_TEXT - 1];
}

/* ---- its files ------------------------------------------------------------------------------- */

struct kept {
    char name[SHA256_TEXT];
    int64_t bytes, used_ns;
};
struct files {
    struct kept *at;
    size_t n;
    int64_t bytes; /* of all */
};

static int64_t ns(struct timespec t) { return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec; }

/* Notes a file by its name; removes what was left half written. */
static void note(struct files *f, int fd, const char *name, int64_t now_ns)
{
    struct stat st;
    if (fstatat(fd, name, &st, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(st.st_mode)) return;
    bool partial = strncmp(name, PARTIAL, sizeof PARTIAL - 1) == 0;
    if (partial && now_ns - ns(st.st_mtim) > PARTIAL_S * INT64_C(1000000000)) unlinkat(fd, name, 0);
    if (!is_hash(name)) return;
    if ((f->n & (f->n - 1)) == 0) f->at = xrealloc(f->at, f->n ? 2 * f->n : 1, sizeof *f->at);
    struct kept *k = &f->at[f->n++];
    *k = (struct kept){.bytes = (int64_t)st.st_size, .used_ns = ns(st.st_mtim)};
    memcpy(k->name, name, SHA256_TEXT);
    f->bytes += k->bytes;
}

/* The one used last comes first. */
static int by_use(const void *a, const void *b)
{
    const struct kept *x = a, *y = b;
    if (x->used_ns != y->used_ns) return x->used_ns < y->used_ns ? 1 : -1;
    return strcmp(x->name, y->name);
}

static struct files list_files(int fd)
{
    struct files f = {0};
    struct timespec now;
    int own = dup(fd);
    DIR *d = own < 0 ? NULL : fdopendir(own);
    if (!d) {
        if (own >= 0) close(own);
        return f;
    }
    clock_gettime(CLOCK_REALTIME, &now);
    rewinddir(d);
    for (const struct dirent *e; (e = readdir(d)) != NULL;) note(&f, fd, e->d_name, ns(now));
    closedir(d);
    if (f.n) qsort(f.at, f.n, sizeof *f.at, by_use);
    return f;
}

/* Removes files until n bytes more are allowed. */
static void make_room(int fd, int64_t n)
{
    struct files f = list_files(fd);
    while (f.n && f.bytes > KEEP_MOST - n) {
        const struct kept *last = &f.at[--f.n];
        if (unlinkat(fd, last->name, 0) == 0) f.bytes -= last->bytes;
    }
    free(f.at);
}

/* ---- names ----------------------------------------------------------------------------------- */

void keep_list(char text[KEEP_LIST])
{
    int fd = open_directory(false);
    size_t length = 0;
    *text = '\0';
    if (fd < 0) return;
    struct files f = list_files(fd);
    close(fd);
    for (size_t i = 0; i < f.n && i < KEEP_LISTED; i++)
        length += (size_t)snprintf(
            text + length, KEEP_LIST - length, "%s%.*s", i ? "," : "", KEEP_DIGITS, f.at[i].name);
    free(f.at);
}

bool keep_names(const char *text, const char *sha256)
{
    while (text && *text) {
        size_t n = strcspn(text, ",");
        if (n == KEEP_DIGITS && strncmp(text, sha256, n) == 0) return true;
        text += n + (text[n] == ',');
    }
    return false;
}

/* ---- contents -------------------------------------------------------------------------------- */

/* Appends the contents of an open file of n bytes. False: it has other ones than the hash says. */
static bool read_contents(int fd, const char *name, size_t n, struct buf *to)
{
    char hash[SHA256_TEXT];
    size_t begin = buf_size(to);
    ptrdiff_t got = 1;
    while (buf_size(to) - begin < n && got > 0) {
        size_t left = n - (buf_size(to) - begin);
        got = read_some(fd, to, left < READ_BYTES ? left : READ_BYTES);
    }
    bool whole = buf_size(to) - begin == n;
    if (whole) sha256(buf_data(to) + begin, n, hash);
    if (whole && memcmp(hash, name, sizeof hash) == 0) return true;
    to->len = to->off + begin;
    return false;
}

bool keep_read(const char *name, size_t n, struct buf *to)
{
    struct stat st;
    int at = is_hash(name) ? open_directory(false) : -1, fd = -1;
    if (at >= 0) fd = openat(at, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    bool good = fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_size == (off_t)n &&
                read_contents(fd, name, n, to);
    if (good) futimens(fd, NULL); /* the time of its last use */
    else if (fd >= 0) unlinkat(at, name, 0);
    if (fd >= 0) close(fd);
    if (at >= 0) close(at);
    return good;
}

/* True if a file of n bytes leaves enough of the file system to others. */
static bool has_space(int fd, size_t n)
{
    struct statvfs v;
    if (fstatvfs(fd, &v) != 0) return false;
    const double unit = (double)v.f_frsize;
    return (double)v.f_bavail * unit - (double)n > (double)v.f_blocks * unit / FREE_PART;
}

void keep_write(const void *p, size_t n)
{
    char name[SHA256_TEXT], partial[PARTIAL_ROOM];
    struct stat st;
    if (n < KEEP_LEAST || (int64_t)n > KEEP_MOST) return;
    int at = open_directory(true);
    if (at < 0) return;
    sha256(p, n, name);
    bool there = fstatat(at, name, &st, AT_SYMLINK_NOFOLLOW) == 0;
    if (there) utimensat(at, name, NULL, AT_SYMLINK_NOFOLLOW);
    if (!there) make_room(at, (int64_t)n);
    if (!there && has_space(at, n)) {
        snprintf(partial, sizeof partial, PARTIAL "%ld-%" PRId64, (long)getpid(), now_us());
        int fd = openat(at, partial, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
        bool written = fd >= 0 && write_full(fd, p, n) == 0;
        if (fd >= 0) written = close(fd) == 0 && written;
        if (fd >= 0 && (!written || renameat(at, partial, at, name) != 0)) unlinkat(at, partial, 0);
    }
    close(at);
}
