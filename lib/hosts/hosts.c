/*
 * Hosts, as in stormring-hosts(5): a comma list or a file, read into one table.
 *
 * The comma list is that of GNU parallel (Ole Tange, "GNU Parallel: the command-line power tool",
 * ;login: 36(1), 2011), without commands in it. Differs in that a host without a number offers one
 * slot, not one per core.
 */
#include "hosts/hosts.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILE_MOST (1 << 20) /* bytes */
#define LINE_MOST 4096

/* Position in the text, and the place for errors. */
struct reader {
    const char *name; /* of the file */
    int line;
    const char *at, *end;
    char *err;
};

bool host_is_here(const struct host *h) { return strcmp(h->name, ":") == 0; }

static bool PRINTF_LIKE(2, 3) refuse(const struct reader *r, const char *fmt, ...)
{
    int n = r->line ? snprintf(r->err, HOSTS_ERR, "%s:%d: ", r->name, r->line)
                    : snprintf(r->err, HOSTS_ERR, "%s: ", r->name);
    va_list ap;
    va_start(ap, fmt);
    if (n >= 0 && n < HOSTS_ERR) vsnprintf(r->err + n, HOSTS_ERR - (size_t)n, fmt, ap);
    va_end(ap);
    return false;
}

/* ---- the table ---- */

static struct host *add(struct hosts *h)
{
    h->at = xrealloc(h->at, h->n + 1, sizeof *h->at);
    h->at[h->n] = (struct host){.slots = 1};
    return &h->at[h->n++];
}

#define NAME_BYTES "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._:@%+-"

/* The only names with a colon are IPv6 addresses, with or without %ZONE. */
static bool is_ipv6(const char *s)
{
    char address[INET6_ADDRSTRLEN];
    struct in6_addr bytes;
    size_t n = strcspn(s, "%");
    if (n >= sizeof address) return false;
    memcpy(address, s, n);
    address[n] = '\0';
    return inet_pton(AF_INET6, address, &bytes) == 1;
}

/* A valid name is one word for every shell and in every record, and no program takes it for an
 * option. */
static bool name_valid(const char *s)
{
    size_t n = strlen(s);
    if (strcmp(s, ":") == 0) return true;
    if (n > HOST_NAME_MOST || *s == '-' || *s == '@' || s[strspn(s, NAME_BYTES)]) return false;
    const char *at = strchr(s, '@'), *host = at ? at + 1 : s;
    if (!*host || *host == '-' || strchr(host, '@')) return false;
    return !strchr(s, ':') || is_ipv6(host);
}

static bool set_name(const struct reader *r, struct host *host, const char *name)
{
    char shown[ERR_WORD];
    host->name = xstrdup(name);
    if (name_valid(name)) return true;
    return refuse(r,
        "%s: no host name, expected `:`, HOST or USER@HOST first, of letters, digits and ._:@%%+-",
        err_word(shown, name, strlen(name)));
}

/* Call when the host is complete: checks it, and counts its slots. */
static bool count(const struct reader *r, struct hosts *h, const struct host *host)
{
    if (host_is_here(host) && (host->via || host->bin))
        return refuse(r, "`:` is this machine, expected no via= and no bin=");
    h->slots += host->slots;
    if (h->slots <= HOSTS_SLOTS_MAX) return true;
    return refuse(r, "%d slots, expected at most %d in all", h->slots, HOSTS_SLOTS_MAX);
}

/* ---- a file ---- */

static bool set_slots(struct host *host, const char *value)
{
    int64_t n;
    if (!parse_int(value, 1, HOSTS_SLOTS_MAX, &n)) return false;
    host->slots = (int)n;
    return true;
}

static bool set_power(struct host *host, const char *value)
{
    return parse_real(value, 1e-6, 1e6, &host->power);
}

static bool set_via(struct host *host, const char *value)
{
    bool command = false;
    for (const char *p = value; (p = strchr(p, '%')) != NULL; p += 2) {
        if (!p[1] || !strchr("hc%", p[1])) return false;
        command |= p[1] == 'c';
    }
    if (command) host->via = xstrdup(value);
    return command;
}

static bool set_bin(struct host *host, const char *value)
{
    if ((*value != '/' && strncmp(value, "~/", 2) != 0) || strchr(value, ':')) return false;
    host->bin = xstrdup(value);
    return true;
}

static const struct key {
    const char *name;
    bool (*set)(struct host *host, const char *value);
    const char *expected;
} keys[] = {
    {"slots", set_slots, "an integer from 1 to 4096"},
    {"power", set_power, "a number from 1e-6 to 1e6"},
    {"via", set_via, "a command in quotes with %c, and %h for the host, %% for a percent sign"},
    {"bin", set_bin, "a directory from / or ~/, without a colon"},
};
#define N_KEYS (sizeof keys / sizeof *keys)

static bool set_key(const struct reader *r, struct host *host, char *word, unsigned *seen)
{
    char shown[ERR_WORD], *value = strchr(word, '=');
    if (value) *value++ = '\0';
    for (unsigned i = 0; i < N_KEYS && value; i++) {
        if (strcmp(word, keys[i].name) != 0) continue;
        if (*seen & 1U << i) return refuse(r, "%s comes twice, expected it once", word);
        *seen |= 1U << i;
        if (keys[i].set(host, value)) return true;
        return refuse(
            r, "%s=%s: expected %s", word, err_word(shown, value, strlen(value)), keys[i].expected);
    }
    return refuse(r,
        "%s: unknown, expected slots=, power=, via= or bin=", err_word(shown, word, strlen(word)));
}

/*
 * Reads the next word of the line into `word`. Within double quotes blanks and # are letters, and a
 * backslash quotes the next byte. Returns 1; 0 at the end of the line; -1 if a quote is open.
 */
static int next_word(struct reader *r, struct buf *word)
{
    bool quoted = false;
    buf_consume(word, buf_size(word));
    while (r->at < r->end && strchr(" \t\r", *r->at)) r->at++;
    if (r->at < r->end && *r->at == '#') r->at = r->end;
    if (r->at == r->end) return 0;
    for (; r->at < r->end && (quoted || !strchr(" \t\r", *r->at)); r->at++) {
        if (*r->at == '"') {
            quoted = !quoted;
            continue;
        }
        if (quoted && *r->at == '\\' && r->at + 1 < r->end) r->at++;
        buf_append(word, r->at, 1);
    }
    buf_append(word, "", 1);
    return quoted ? -1 : 1;
}

static bool read_line(struct reader *r, struct hosts *h, struct buf *word)
{
    unsigned seen = 0;
    if (r->end - r->at > LINE_MOST)
        return refuse(r, "a line of more than %d bytes, expected one host a line", LINE_MOST);
    if (memchr(r->at, '\0', (size_t)(r->end - r->at)))
        return refuse(r, "a NUL byte, expected text");
    int more = next_word(r, word);
    if (!more) return true;
    struct host *host = add(h);
    if (more > 0 && !set_name(r, host, (char *)word->data)) return false;
    while (more > 0 && (more = next_word(r, word)) > 0)
        if (!set_key(r, host, (char *)word->data, &seen)) return false;
    if (more < 0) return refuse(r, "a quote is not closed, expected \" before the end of the line");
    return count(r, h, host);
}

static bool read_lines(struct reader *r, struct hosts *h, const struct buf *text)
{
    const char *at = (const char *)buf_data(text), *end = at + buf_size(text);
    struct buf word = {0};
    bool good = true;
    while (good && at < end) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        r->line++;
        r->at = at;
        r->end = newline ? newline : end;
        good = read_line(r, h, &word);
        at = newline ? newline + 1 : end;
    }
    buf_free(&word);
    r->line = 0;
    return good && (h->n || refuse(r, "no host, expected a line `NAME slots=N ...` for each"));
}

/* ---- a comma list ---- */

static bool read_entry(struct reader *r, struct hosts *h, char *entry)
{
    struct host *host = add(h);
    char *slash = strchr(entry, '/');
    if (slash) *slash = '\0';
    if (slash && !set_slots(host, entry))
        return refuse(r,
            "%s/%s: no such file, expected one, or a host's number of slots before `/`, 1 to 4096",
            entry, slash + 1);
    return set_name(r, host, slash ? slash + 1 : entry) && count(r, h, host);
}

/* Suffixes of file names that are no top-level domains. */
static bool named_as_file(const char *name)
{
    static const char *const suffix[] = {"cfg", "conf", "hosts", "lst", "tsv", "txt"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof suffix / sizeof *suffix; i++)
        if (strcasecmp(dot + 1, suffix[i]) == 0) return true;
    return false;
}

/* A single name: of a host, or of a missing file? */
static bool doubt(const struct reader *r, struct hosts *h, const char *name)
{
    h->no_file = strcmp(name, ":") != 0 && !strchr(name, '@');
    if (!named_as_file(name)) return true;
    return refuse(r, "%s: no such file, expected one, or 1/%s for a host", name, name);
}

static bool read_list(struct reader *r, struct hosts *h, const char *list)
{
    char *copy = xstrdup(list);
    bool good = true;
    for (char *at = copy; good && at;) {
        char *comma = strchr(at, ',');
        if (comma) *comma++ = '\0';
        good = read_entry(r, h, at);
        at = comma;
    }
    free(copy);
    return good && (strpbrk(list, ",/") || doubt(r, h, list));
}

/*
 * A hosts file is read more than once in a run, and anything but a regular file may have no end.
 * The size is limited because any file may be named by mistake.
 */
static bool read_hosts_file(const struct reader *r, struct buf *text)
{
    struct stat st;
    ptrdiff_t n = 0;
    int fd = open(r->name, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0) return refuse(r, "%s, expected a file that can be read", strerror(errno));
    bool regular = fstat(fd, &st) == 0 && S_ISREG(st.st_mode);
    while (regular && buf_size(text) <= FILE_MOST && (n = read_some(fd, text, 1 << 16)) > 0)
        ;
    int err = errno;
    close(fd);
    if (!regular) return refuse(r, "no regular file, expected one with a line for each host");
    if (n < 0) return refuse(r, "%s, expected a file that can be read", strerror(err));
    if (buf_size(text) <= FILE_MOST) return true;
    return refuse(r, "larger than %d bytes, expected a line for each host", FILE_MOST);
}

bool hosts_read(struct hosts *h, const char *arg, char err[HOSTS_ERR])
{
    struct stat st;
    struct buf text = {0};
    struct reader r = {.name = arg, .err = err};
    bool good;
    *h = (struct hosts){0};
    *err = '\0';
    /* A directory with results of a host may have its name. */
    if (stat(arg, &st) != 0 || (S_ISDIR(st.st_mode) && !strchr(arg, '/'))) {
        r.name = "-S";
        good = read_list(&r, h, arg);
    } else {
        good = read_hosts_file(&r, &text) && read_lines(&r, h, &text);
    }
    buf_free(&text);
    if (!good) hosts_free(h);
    return good;
}

void hosts_here(struct hosts *h, int slots)
{
    *h = (struct hosts){.slots = slots};
    struct host *host = add(h);
    host->name = xstrdup(":");
    host->slots = slots;
}

void hosts_free(struct hosts *h)
{
    for (size_t i = 0; i < h->n; i++) {
        free(h->at[i].name);
        free(h->at[i].via);
        free(h->at[i].bin);
    }
    free(h->at);
    *h = (struct hosts){0};
}

size_t hosts_of_slot(const struct hosts *h, int slot)
{
    size_t i = 0;
    for (; slot >= h->at[i].slots; i++) slot -= h->at[i].slots;
    return i;
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
