/*
 * Hosts, as in stormring-hosts(5): a comma list or a file, read into one table.
 *
 * The comma list is that of GNU parallel (Ole Tange, "GNU Parallel: the command-line power tool",
 * ;login: 36(1), 2011), without commands in it. Differs in that a host without a number offers one
 * slot, not one per core.
 */
#include "hosts/hosts_int.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define LINE_MOST 4096

/* ---- a file ---- */

static bool set_slots(struct host *host, const char *value)
{
    int64_t n;
    if (!parse_int(value, 1, HOST_SLOTS_MAX, &n)) return false;
    host->slots = (int)n;
    return true;
}

static bool set_power(struct host *host, const char *value)
{
    return parse_real(value, 1e-6, 1e6, &host->power);
}

static bool set_latency(struct host *host, const char *value)
{
    return parse_real(value, 0, 1e7, &host->latency_ms);
}

static bool set_bytes(struct host *host, const char *value)
{
    return parse_real(value, 1, 1e15, &host->bytes_per_s);
}

/* %c becomes a word in quotes, which inner quotes would end. */
static bool set_via(struct host *host, const char *value)
{
    bool command = false;
    char quote = '\0';
    for (const char *p = value; *p; p++) {
        if (*p == quote) quote = '\0';
        else if (!quote && (*p == '\'' || *p == '"')) quote = *p;
        else if (*p == '\\' && quote != '\'' && p[1]) p++;
        if (*p != '%') continue;
        p++;
        if (!*p || !strchr("hc%", *p) || (*p == 'c' && quote)) return false;
        command |= *p == 'c';
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

static bool set_wait(struct host *host, const char *value)
{
    return parse_real(value, 1, 1e6, &host->wait_s);
}

static bool set_tries(struct host *host, const char *value)
{
    int64_t n;
    if (!parse_int(value, 1, 1000, &n)) return false;
    host->tries = (int)n;
    return true;
}

static bool set_nice(struct host *host, const char *value)
{
    int64_t n;
    if (!parse_int(value, 0, 19, &n)) return false;
    host->nice = (int)n;
    return true;
}

/* Bytes, with or without a suffix. */
static bool set_memory(struct host *host, const char *value)
{
    static const char units[] = "KMG";
    char text[24];
    int64_t n;
    if (strlen(value) >= sizeof text) return false;
    const size_t digits = strspn(value, "0123456789");
    const char *unit = value[digits] ? strchr(units, value[digits]) : NULL;
    if (value[digits] && (!unit || value[digits + 1])) return false;
    snprintf(text, sizeof text, "%.*s", (int)digits, value);
    if (!parse_int(text, 1, INT64_C(1) << 50, &n)) return false;
    for (int times = unit ? (int)(unit - units) + 1 : 0; times; times--)
        if ((n *= 1024) > INT64_C(1) << 50) return false;
    host->memory = n;
    return n >= 1 << 20;
}

static bool set_send(struct host *host, const char *value)
{
    host->send = true;
    return strcmp(value, "auto") == 0;
}

static const struct key {
    const char *name;
    bool (*set)(struct host *host, const char *value);
    const char *expected;
} keys[] = {
    {"slots", set_slots, "an integer from 1 to 4096"},
    {"power", set_power, "a number from 1e-6 to 1e6"},
    {"via", set_via,
        "a command in quotes with %c, outside of inner quotes, and %h for the host, "
        "%% for a percent sign"},
    {"bin", set_bin, "a directory from / or ~/, without a colon"},
    {"wait", set_wait, "seconds from 1 to 1e6"},
    {"tries", set_tries, "an integer from 1 to 1000"},
    {"latency_ms", set_latency, "a number from 0 to 1e7"},
    {"bytes_per_s", set_bytes, "a number from 1 to 1e15"},
    {"send", set_send, "auto"},
    {"nice", set_nice, "an integer from 0 to 19"},
    {"mem", set_memory, "bytes, at least 1M, with or without K, M or G"},
};
#define N_KEYS (sizeof keys / sizeof *keys)

/* Does the key say how the host is reached, not what it offers? */
static bool is_way(const struct key *k)
{
    return k->set == set_via || k->set == set_bin || k->set == set_wait || k->set == set_send;
}

/* "slots=, power= or bin=": all keys. */
static const char *key_names(char *to, size_t room)
{
    size_t n = 0;
    for (size_t i = 0; i < N_KEYS && n < room; i++)
        n += (size_t)snprintf(to + n, room - n, "%s%s=",
            !i               ? ""
            : i + 1 < N_KEYS ? ", "
                             : " or ",
            keys[i].name);
    return to;
}

static bool set_key(const struct hosts_reader *r, struct host *host, char *word, unsigned *seen)
{
    char shown[ERR_WORD], names[200], *value = strchr(word, '=');
    if (value) *value++ = '\0';
    for (unsigned i = 0; i < N_KEYS && value; i++) {
        if (strcmp(word, keys[i].name) != 0) continue;
        if (*seen & 1U << i) return hosts_refuse(r, "%s comes twice, expected it once", word);
        *seen |= 1U << i;
        hosts_put_key(is_way(&keys[i]) ? &host->way : &host->offer, keys[i].name, value);
        if (keys[i].set(host, value)) return true;
        return hosts_refuse(
            r, "%s=%s: expected %s", word, err_word(shown, value, strlen(value)), keys[i].expected);
    }
    for (unsigned i = 0; i < N_KEYS && !value; i++)
        if (strcmp(word, keys[i].name) == 0)
            return hosts_refuse(
                r, "%s without a value, expected %s=VALUE, without blanks around =", word, word);
    return hosts_refuse(r, "%s: unknown, expected %s", err_word(shown, word, strlen(word)),
        key_names(names, sizeof names));
}

/*
 * Reads the next word of the line into `word`. Within double quotes blanks and # are letters, and a
 * backslash quotes the next byte. Returns 1; 0 at the end of the line; -1 if a quote is open.
 */
static int next_word(struct hosts_reader *r, struct buf *word)
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

static bool read_line(struct hosts_reader *r, struct hosts *h, struct buf *word)
{
    unsigned seen = 0;
    if (r->end - r->at > LINE_MOST)
        return hosts_refuse(r, "a line of more than %d bytes, expected one host a line", LINE_MOST);
    if (memchr(r->at, '\0', (size_t)(r->end - r->at)))
        return hosts_refuse(r, "a NUL byte, expected text");
    int more = next_word(r, word);
    if (!more) return true;
    struct host *host = hosts_add(h);
    if (more > 0 && !hosts_set_name(r, host, (char *)word->data)) return false;
    while (more > 0 && (more = next_word(r, word)) > 0)
        if (!set_key(r, host, (char *)word->data, &seen)) return false;
    if (more < 0)
        return hosts_refuse(r, "a quote is not closed, expected \" before the end of the line");
    return hosts_count(r, h, host);
}

static bool read_lines(struct hosts_reader *r, struct hosts *h, const struct buf *text)
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
    return good &&
           (h->n || hosts_refuse(r, "no host, expected a line `NAME slots=N ...` for each"));
}

/* ---- a comma list ---- */

static bool read_entry(struct hosts_reader *r, struct hosts *h, char *entry)
{
    struct host *host = hosts_add(h);
    char *slash = strstr(entry, "://") ? NULL : strchr(entry, '/');
    if (slash) *slash = '\0';
    if (slash && !set_slots(host, entry))
        return hosts_refuse(r,
            "%s/%s: no such file, expected one, or a host's number of slots before `/`, 1 to 4096",
            entry, slash + 1);
    return hosts_set_name(r, host, slash ? slash + 1 : entry) && hosts_count(r, h, host);
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
static bool doubt(const struct hosts_reader *r, struct hosts *h, const char *name)
{
    h->no_file = strcmp(name, ":") != 0 && !strchr(name, '@');
    if (strcmp(name, "slurm") == 0 || strcmp(name, "pbs") == 0)
        return hosts_refuse(r,
            "%s: no such file, expected `%s:` for the nodes of a job, or 1/%s for a host", name,
            name, name);
    if (!named_as_file(name)) return true;
    return hosts_refuse(r, "%s: no such file, expected one, or 1/%s for a host", name, name);
}

static bool read_list(struct hosts_reader *r, struct hosts *h, const char *list)
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

/* Skips a byte order mark, which editors on Windows write. */
static bool skip_mark(const struct hosts_reader *r, struct buf *text)
{
    const unsigned char *at = buf_data(text);
    if (buf_size(text) >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0) buf_consume(text, 3);
    if (buf_size(text) < 2 || (memcmp(at, "\xff\xfe", 2) != 0 && memcmp(at, "\xfe\xff", 2) != 0))
        return true;
    return hosts_refuse(r, "text of UTF-16, expected UTF-8");
}

bool hosts_of_file(struct hosts *h, const char *name, char err[HOSTS_ERR])
{
    struct buf text = {0};
    struct hosts_reader r = {.name = name, .err = err};
    *err = '\0';
    *h = (struct hosts){.file = xstrdup(name), .version = hosts_version(name)};
    bool good = hosts_read_file(&r, &text) && skip_mark(&r, &text) && read_lines(&r, h, &text);
    buf_free(&text);
    if (!good) hosts_free(h);
    return good;
}

bool hosts_read(struct hosts *h, const char *arg, char err[HOSTS_ERR])
{
    struct stat st;
    struct hosts_reader r = {.name = arg, .err = err};
    bool good;
    *h = (struct hosts){0};
    *err = '\0';
    if (hosts_of_job(&r, h, arg, &good)) {
        if (!good) hosts_free(h);
        return good;
    }
    /* A directory with results of a host may have its name. */
    if (!strchr(arg, '\n') && stat(arg, &st) == 0 && (!S_ISDIR(st.st_mode) || strchr(arg, '/')))
        return hosts_of_file(h, arg, err);
    r.name = "-S";
    struct buf text = {.data = (unsigned char *)(uintptr_t)arg, .len = strlen(arg)};
    good = strchr(arg, '\n') ? read_lines(&r, h, &text) : read_list(&r, h, arg);
    if (!good) hosts_free(h);
    return good;
}
