/* message: messages, exit, and the final check of stdout. */
#include "base/base.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *name = "stormring";

/*
 * A program may be started with a standard descriptor closed. The next file or pipe that it opens
 * would become its standard input or output. So each gap is filled with a descriptor that cannot be
 * used the expected way: reading or writing fails as on a closed one. Messages are discarded.
 */
static void fill_standard_descriptors(void)
{
    static const int mode[] = {O_WRONLY, O_RDONLY, O_RDWR};
    for (int fd = 0; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", mode[fd]) != fd) _exit(ST_SYSTEM);
}

void prog_init(const char *argv0)
{
    fill_standard_descriptors();
    signal(SIGXFSZ, SIG_IGN); /* write then fails with EFBIG, like other errors */
    if (!argv0) return;
    const char *slash = strrchr(argv0, '/');
    name = slash ? slash + 1 : argv0;
}

const char *prog_name(void) { return name; }

static PRINTF_LIKE(1, 0) void message(const char *fmt, va_list ap)
{
    int err = errno;
    char text[1024], line[4 * sizeof text]; /* no memory is asked for: there may be none */
    int said = snprintf(text, sizeof text, "%s: ", name);
    if (said > 0 && (size_t)said < sizeof text)
        vsnprintf(text + said, sizeof text - (size_t)said, fmt, ap);
    text_shown(line, sizeof line, text);
    size_t n = strlen(fmt);
    /* One write, so that lines of several processes do not mix. */
    if (n && fmt[n - 1] == ':') fprintf(stderr, "%s %s\n", line, strerror(err));
    else fprintf(stderr, "%s\n", line);
}

void warn(const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    message(fmt, ap);
    va_end(ap);
}

void die(int status, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    message(fmt, ap);
    va_end(ap);
    exit(status);
}

bool err_set(char err[ERR_BYTES], const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(err, ERR_BYTES, fmt, ap);
    va_end(ap);
    return false;
}

const char *err_path(char out[ERR_PATH], const char *path)
{
    const size_t n = strlen(path), most = ERR_PATH - 1;
    if (n <= most) snprintf(out, ERR_PATH, "%s", path);
    else snprintf(out, ERR_PATH, "...%s", path + n - (most - 3));
    return out;
}

bool err_at(char err[ERR_BYTES], const char *file, size_t line, const char *fmt, va_list ap)
{
    char path[ERR_PATH];
    int n = snprintf(err, ERR_BYTES, "%s:%zu: ", err_path(path, file), line);
    if (n < 0 || n >= ERR_BYTES) n = 0;
    vsnprintf(err + n, ERR_BYTES - (size_t)n, fmt, ap);
    return false;
}

const char *err_word(char out[ERR_WORD], const void *word, size_t n)
{
    char shown[32];
    size_t k = 0;
    for (const char *c = word; k < n && k + 1 < sizeof shown; k++)
        shown[k] = c[k] >= ' ' && c[k] < 0x7f ? c[k] : '?';
    snprintf(out, ERR_WORD, "'%.*s%s'", (int)k, shown, k < n ? "..." : "");
    return out;
}

void usage(int status, const char *text)
{
    fprintf(status ? stderr : stdout, "usage: %s %s\n", name, text);
    if (!status) close_stdout();
    exit(status);
}

void version(void)
{
    printf("%s %s\n", name, STORMRING_VERSION);
    close_stdout();
    exit(ST_OK);
}

void close_stdout(void)
{
    bool failed = ferror(stdout) != 0; /* errno of that failure is lost */
    int err = fclose(stdout) != 0 ? errno : failed ? EIO : 0;
    if (err == EPIPE) exit(ST_SYSTEM); /* the reader has gone; no message */
    errno = err;
    if (err) die(ST_SYSTEM, "standard output:");
}
