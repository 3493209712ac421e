/*
 * Hosts of a job. Slurm describes the job's nodes in two variables of the environment, PBS in a
 * file that a variable names; stormring-engines(7) has their forms. Any other text is refused.
 */
#include "hosts/hosts_int.h"

#include <stdlib.h>
#include <string.h>

#define NODE_BYTES "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-"
#define NODES_VARIABLE "SLURM_JOB_NODELIST"
#define CPUS_VARIABLE "SLURM_JOB_CPUS_PER_NODE"
#define PARTS_VARIABLE "SLURM_HET_SIZE"
#define FILE_VARIABLE "PBS_NODEFILE"
#define PARTS_MOST 1000 /* of a heterogeneous job, more than Slurm allows */
#define DIGITS_MOST 18  /* of a number in a node's name */
#define WORD_MOST 64    /* bytes of a range or a count, more than any that is valid */
#define VARIABLE_MOST 64

/*
 * One step of the job for each connection. -u: records are forwarded when they come, not when a
 * line is full. --overlap: the job's script and other steps may use the same processors. A node of
 * a heterogeneous job is reached through its part of the job.
 */
#define STEP_VIA "srun -Qu%s -N 1 -n 1 -c %d --overlap -w %%h sh -c %%c"

/* Sets r to the variable's text. */
static bool find_variable(struct hosts_reader *r, const char *variable)
{
    const char *text = getenv(variable);
    r->name = variable;
    if (!text) return hosts_refuse(r, "not set, expected a job around this command");
    if (!*text) return hosts_refuse(r, "empty, expected the text that the job was given");
    r->at = text;
    r->end = text + strlen(text);
    return true;
}

/* Refuses the n bytes at `word`. */
static bool wrong(const struct hosts_reader *r, const char *word, size_t n, const char *expected)
{
    char shown[ERR_WORD];
    return hosts_refuse(r, "%s: expected %s", err_word(shown, word, n), expected);
}

static const char *first_of(const char *at, const char *end, char byte)
{
    const char *found = memchr(at, byte, (size_t)(end - at));
    return found ? found : end;
}

static bool node_valid(const char *name, size_t n)
{
    if (!n || n > HOST_NAME_MOST || *name == '-') return false;
    for (size_t i = 0; i < n; i++)
        if (!name[i] || !strchr(NODE_BYTES, name[i])) return false;
    return true;
}

/* Where the index of the host with this name is, or would be. */
static int32_t *place_of(
    const struct hosts_names *names, const struct hosts *h, const char *name, size_t n)
{
    size_t i = (size_t)hash64(HASH64_INIT, name, n);
    for (;; i++) {
        int32_t *at = &names->at[i & (names->room - 1)];
        const char *known = *at < 0 ? NULL : h->at[*at].name;
        if (!known || (strlen(known) == n && memcmp(known, name, n) == 0)) return at;
    }
}

/* Makes room for the name of one more host. */
static void make_room(struct hosts_names *names, const struct hosts *h)
{
    if (2 * (h->n + 1) <= names->room) return;
    names->room = names->room ? 2 * names->room : 64;
    free(names->at);
    names->at = xmalloc(names->room, sizeof *names->at);
    for (size_t i = 0; i < names->room; i++) names->at[i] = -1;
    for (size_t i = 0; i < h->n; i++)
        *place_of(names, h, h->at[i].name, strlen(h->at[i].name)) = (int32_t)i;
}

/* The host of this name, or a new one without slots; NULL if the name is refused. */
static struct host *node_of(
    const struct hosts_reader *r, struct hosts *h, const char *name, size_t n)
{
    make_room(r->names, h);
    int32_t *known = place_of(r->names, h, name, n);
    if (*known >= (int32_t)r->done) return &h->at[*known];
    if (!node_valid(name, n)) {
        wrong(r, name, n, "a node's name, of at most 255 letters, digits and ._-");
        return NULL;
    }
    struct host *host = hosts_add(h);
    *known = (int32_t)h->n - 1;
    host->name = xcalloc(n + 1, 1);
    memcpy(host->name, name, n);
    host->slots = 0;
    return host;
}

/* ---- Slurm ---- */

/* A name while it is expanded. */
struct name {
    char text[HOST_NAME_MOST + 1];
    size_t n;
};

static bool expand(const struct hosts_reader *r, struct hosts *h, const struct name *before,
    const char *at, const char *end);

/* Appends a number of at least this many digits to the name, and expands the rest. */
static bool expand_number(const struct hosts_reader *r, struct hosts *h, const struct name *before,
    int64_t number, int digits, const char *rest, const char *end)
{
    struct name name = *before;
    size_t room = sizeof name.text - name.n;
    int n = snprintf(name.text + name.n, room, "%0*lld", digits, (long long)number);
    if (n < 0 || (size_t)n >= room)
        return wrong(r, name.text, sizeof name.text - 1, "a name of at most 255 bytes");
    name.n += (size_t)n;
    return expand(r, h, &name, rest, end);
}

/* Expands `3`, `8-11` or `08-11`, and the rest of the name after the bracket. */
static bool expand_range(const struct hosts_reader *r, struct hosts *h, const struct name *before,
    const char *at, const char *stop, const char *rest, const char *end)
{
    static const char expected[] = "a number or LOW-HIGH between [ and ]";
    char text[WORD_MOST];
    int64_t low, high;
    size_t n = (size_t)(stop - at);
    if (n >= sizeof text) return wrong(r, at, n, expected);
    memcpy(text, at, n);
    text[n] = '\0';
    char *dash = strchr(text, '-'), *last = dash ? dash + 1 : text;
    if (dash) *dash = '\0';
    size_t low_n = strlen(text), high_n = strlen(last);
    /* Zeros in front make all numbers as long as the first one. */
    bool longer = high_n > low_n && *last != '0' && (*text != '0' || low_n == 1);
    if (low_n > DIGITS_MOST || high_n > DIGITS_MOST || (high_n != low_n && !longer) ||
        !parse_int(text, 0, INT64_MAX, &low) || !parse_int(last, low, INT64_MAX, &high))
        return wrong(r, at, n, expected);
    for (int64_t v = low; v <= high; v++)
        if (!expand_number(r, h, before, v, (int)low_n, rest, end)) return false;
    return true;
}

/* Adds the nodes of one name with brackets, such as `rack[1-2]n[01-12]`. */
static bool expand(const struct hosts_reader *r, struct hosts *h, const struct name *before,
    const char *at, const char *end)
{
    const char *open = first_of(at, end, '['), *close = first_of(open, end, ']');
    struct name name = *before;
    size_t n = (size_t)(open - at);
    if (n >= sizeof name.text - name.n) return wrong(r, at, n, "a name of at most 255 bytes");
    memcpy(name.text + name.n, at, n);
    name.n += n;
    if (open == end) {
        size_t known = h->n;
        if (known == HOSTS_MOST)
            return hosts_refuse(r, "more nodes, expected at most %d", HOSTS_MOST);
        if (!node_of(r, h, name.text, name.n)) return false;
        return h->n > known || wrong(r, name.text, name.n, "each node once");
    }
    if (close == end) return wrong(r, open, (size_t)(end - open), "] after [");
    for (const char *word = open + 1, *stop; word <= close; word = stop + 1) {
        stop = first_of(word, close, ',');
        if (!expand_range(r, h, &name, word, stop, close + 1, end)) return false;
    }
    return true;
}

/* The comma after the name at `at`, or the end: commas within brackets belong to the name. */
static const char *name_end(const char *at, const char *end)
{
    for (bool within = false; at < end && (within || *at != ','); at++)
        if (*at == '[' || *at == ']') within = *at == '[';
    return at;
}

static bool read_nodes(struct hosts_reader *r, struct hosts *h, const char *variable)
{
    const struct name none = {0};
    if (!find_variable(r, variable)) return false;
    for (const char *at = r->at, *stop; at <= r->end; at = stop + 1) {
        stop = name_end(at, r->end);
        if (!expand(r, h, &none, at, stop)) return false;
    }
    return true;
}

/* Reads `8` or `8(x3)`: 8 processors on each of 3 nodes. */
static bool read_count(
    const struct hosts_reader *r, const char *at, size_t n, int64_t *cpus, int64_t *nodes)
{
    char text[WORD_MOST], *times;
    *nodes = 1;
    if (n < sizeof text) {
        memcpy(text, at, n);
        text[n] = '\0';
        times = strstr(text, "(x");
        bool closed = times && text[n - 1] == ')';
        if (closed) text[n - 1] = *times = '\0';
        if (parse_int(text, 1, HOST_SLOTS_MAX, cpus) &&
            (!closed || parse_int(times + 2, 1, HOSTS_MOST, nodes)))
            return true;
    }
    return wrong(r, at, n, "processors of a node, 1 to 4096, as 8, or 8(x3) for three nodes");
}

static bool read_cpus(
    struct hosts_reader *r, struct hosts *h, const char *variable, const char *nodes_variable)
{
    size_t known = r->done;
    int64_t cpus, nodes;
    if (!find_variable(r, variable)) return false;
    for (const char *at = r->at, *stop; at <= r->end; at = stop + 1) {
        stop = first_of(at, r->end, ',');
        if (!read_count(r, at, (size_t)(stop - at), &cpus, &nodes)) return false;
        for (; nodes > 0 && known < h->n; nodes--, known++) h->at[known].slots = (int)cpus;
        if (nodes) break;
        if (stop == r->end && known == h->n) return true;
    }
    return hosts_refuse(r, "%s nodes, expected %zu, as in %s", known < h->n ? "fewer" : "more",
        h->n - r->done, nodes_variable);
}

/* The variable of part k of a heterogeneous job. Without one of its own, the first part has that of
 * the job; so has a job without parts (-1). */
static const char *part_variable(const char *variable, int k, char name[VARIABLE_MOST])
{
    snprintf(name, VARIABLE_MOST, "%s_HET_GROUP_%d", variable, k);
    return k < 0 || (k == 0 && !getenv(name)) ? variable : name;
}

static bool read_part(struct hosts_reader *r, struct hosts *h, int k)
{
    char nodes_name[VARIABLE_MOST], cpus_name[VARIABLE_MOST], group[32] = "";
    const char *nodes = part_variable(NODES_VARIABLE, k, nodes_name);
    const char *cpus = part_variable(CPUS_VARIABLE, k, cpus_name);
    r->done = h->n;
    if (!read_nodes(r, h, nodes) || !read_cpus(r, h, cpus, nodes)) return false;
    if (k >= 0) snprintf(group, sizeof group, " --het-group=%d", k);
    for (size_t i = r->done; i < h->n; i++) {
        struct buf via = {0};
        buf_printf(&via, STEP_VIA, group, h->at[i].slots);
        buf_append(&via, "", 1);
        h->at[i].via = (char *)via.data;
        if (!hosts_count(r, h, &h->at[i])) return false;
    }
    return true;
}

static bool read_slurm(struct hosts_reader *r, struct hosts *h)
{
    const char *parts = getenv(PARTS_VARIABLE);
    int64_t n;
    if (!parts) return read_part(r, h, -1);
    r->name = PARTS_VARIABLE;
    if (!parse_int(parts, 1, PARTS_MOST, &n))
        return wrong(r, parts, strlen(parts), "the number of parts of the job, 1 to 1000");
    for (int k = 0; k < n; k++)
        if (!read_part(r, h, k)) return false;
    return true;
}

/* ---- PBS ---- */

/* A name for each slot, one a line. */
static bool read_names(struct hosts_reader *r, struct hosts *h, const struct buf *text)
{
    const char *at = (const char *)buf_data(text), *end = at + buf_size(text), *stop;
    for (; at < end; at = stop + 1) {
        r->line++;
        stop = first_of(at, end, '\n');
        struct host *host = node_of(r, h, at, (size_t)(stop - at));
        if (!host) return false;
        if (host->slots++ == HOST_SLOTS_MAX)
            return hosts_refuse(r, "one slot more, expected at most %d of a node", HOST_SLOTS_MAX);
        if (h->slots++ == HOSTS_SLOTS_MAX)
            return hosts_refuse(r, "one slot more, expected at most %d", HOSTS_SLOTS_MAX);
    }
    return h->n || hosts_refuse(r, "empty, expected the name of a node in each line");
}

static bool read_pbs(struct hosts_reader *r, struct hosts *h)
{
    struct buf text = {0};
    if (!find_variable(r, FILE_VARIABLE)) return false;
    r->name = r->at;
    bool good = hosts_read_file(r, &text) && read_names(r, h, &text);
    buf_free(&text);
    return good;
}

bool hosts_of_job(struct hosts_reader *r, struct hosts *h, const char *arg, bool *good)
{
    bool slurm = strcmp(arg, "slurm:") == 0;
    if (!slurm && strcmp(arg, "pbs:") != 0) return false;
    r->names = xcalloc(1, sizeof *r->names);
    *good = slurm ? read_slurm(r, h) : read_pbs(r, h);
    free(r->names->at);
    free(r->names);
    return true;
}
