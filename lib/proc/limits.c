/*
 * limits: the processors and the memory that the system allows this process: proc.h. The files are
 * those of Linux: proc(5), cgroups(7), cgroup_namespaces(7); in its Documentation,
 * admin-guide/cgroup-v2.rst (cpu.max, memory.max), scheduler/sched-bwc.rst (cpu.cfs_*) and
 * admin-guide/cgroup-v1/memory.rst.
 *
 * A group's files are where its hierarchy is mounted. The mount may show only a part of the
 * hierarchy, such as the group of a container. Version 2, and each controller of version 1, is a
 * hierarchy of its own, and all of them may be mounted at once.
 */
#include "os/os.h"
#include "proc/proc.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define NONE ((double)INFINITY)
#define NAME_BYTES 8192 /* more than the name of a group's file has */

/* ---- files ----------------------------------------------------------------------------------- */

/* root/name as text, which the caller frees; empty if it cannot be read. */
static char *text_of(const char *root, const char *name)
{
    char path[NAME_BYTES];
    struct buf text = {0};
    int n = snprintf(path, sizeof path, "%s%s", root, name);
    int fd = n < 0 || (size_t)n >= sizeof path ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    while (fd >= 0 && read_some(fd, &text, 4096) > 0) continue;
    if (fd >= 0) close(fd);
    buf_append(&text, "", 1);
    return (char *)text.data;
}

/* The whole number at the beginning of a file of a group; `otherwise` if there is none. */
static double number_of(const char *dir, const char *name, double otherwise)
{
    char *text = text_of(dir, name);
    int64_t n;
    text[strcspn(text, " \n")] = '\0';
    double v = parse_int(text, 0, INT64_MAX, &n) ? (double)n : otherwise;
    free(text);
    return v;
}

/* The number after this word at the beginning of a line. */
static double entry(const char *text, const char *word, double otherwise)
{
    size_t n = strlen(word);
    for (const char *at = text; at; at = (at = strchr(at, '\n')) ? at + 1 : NULL) {
        if (strncmp(at, word, n) != 0) continue;
        char digits[24];
        int64_t v;
        at += n + strspn(at + n, " ");
        snprintf(digits, sizeof digits, "%.*s", (int)strspn(at, "0123456789"), at);
        return parse_int(digits, 0, INT64_MAX, &v) ? (double)v : otherwise;
    }
    return otherwise;
}

/* ---- groups ---------------------------------------------------------------------------------- */

/* A limit of one group, whose files are in dir. */
typedef double group_limit(const char *dir, bool first_version);

/* A control group, and where it may be mounted. */
struct group {
    const char *root;
    const char *controller; /* NULL: version 2 */
    char *name;             /* from the top of the hierarchy: "/job/part" */
    char *mounts;           /* /proc/self/mountinfo */
};

/* A comma list has the word. */
static bool lists(const char *list, const char *word)
{
    const size_t n = strlen(word);
    for (const char *at = list; at; at = (at = strchr(at, ',')) ? at + 1 : NULL)
        if (strncmp(at, word, n) == 0 && (at[n] == ',' || at[n] == '\0')) return true;
    return false;
}

/* Bytes that would end a word are written as \ooo there. */
static void decode(char *s)
{
    char *to = s;
    for (; *s; s++) {
        bool octal = s[0] == '\\' && strspn(s + 1, "01234567") >= 3;
        *to++ = (char)(octal ? (s[1] - '0') << 6 | (s[2] - '0') << 3 | (s[3] - '0') : *s);
        s += octal ? 3 : 0;
    }
    *to = '\0';
}

/* A line of mountinfo: ID PARENT DEVICE TOP AT OPTIONS [...] - TYPE SOURCE OPTIONS. True if the
 * group's hierarchy is mounted there, from the group `top` on. */
static bool mounted(char *line, const char *controller, char **top, char **at)
{
    char *tail = strstr(line, " - "), *rest = line, *word = NULL;
    if (!tail) return false;
    *tail = '\0';
    for (int i = 0; i < 5 && (word = strtok_r(rest, " ", &rest)) != NULL; i++)
        if (i == 3) *top = word;
    if (!word) return false;
    *at = word;
    decode(*top);
    decode(*at);
    rest = tail + 3;
    const char *type = strtok_r(rest, " ", &rest), *source = strtok_r(rest, " ", &rest),
               *options = strtok_r(rest, " ", &rest);
    if (!type || !source || !options) return false;
    if (!controller) return strcmp(type, "cgroup2") == 0;
    return strcmp(type, "cgroup") == 0 && lists(options, controller);
}

/* The part of the group's name below `top`, or NULL: the mount does not show the group. */
static const char *below(const char *name, const char *top)
{
    const size_t n = strcmp(top, "/") == 0 ? 0 : strlen(top);
    const bool inside = strncmp(name, top, n) == 0 && (name[n] == '/' || name[n] == '\0');
    return inside && !strstr(name + n, "/..") ? name + n : NULL;
}

/* The least limit of the group `name` below the directory `at`, and of those around it. */
static double least_at(const struct group *g, const char *at, const char *name, group_limit *limit)
{
    char dir[NAME_BYTES];
    int n = snprintf(dir, sizeof dir, "%s%s%s", g->root, at, name);
    if (n < 0 || (size_t)n >= sizeof dir) return NONE;
    char *top = dir + strlen(g->root) + strlen(at);
    double least = limit(dir, g->controller != NULL);
    for (char *slash; (slash = strrchr(top, '/')) != NULL;) {
        *slash = '\0';
        least = fmin(least, limit(dir, g->controller != NULL));
    }
    return least;
}

/*
 * The least limit of the group and of those around it that can be seen. If no mount shows the
 * group, as in a container with a view of its own, the top of a mount is a group around it.
 */
static double least_of(const struct group *g, group_limit *limit)
{
    double inside = NONE, outside = NONE;
    bool shown = false;
    char *rest = g->mounts, *top = NULL, *at = NULL;
    for (char *line; (line = strtok_r(rest, "\n", &rest)) != NULL;) {
        if (!mounted(line, g->controller, &top, &at)) continue;
        const char *name = below(g->name, top);
        if (name) inside = fmin(inside, least_at(g, at, name, limit));
        else outside = fmin(outside, least_at(g, at, "", limit));
        shown |= name != NULL;
    }
    return shown ? inside : outside;
}

/* The least limit of all groups of this process, of version 2 and of the controller. */
static double least(const char *root, const char *controller, group_limit *limit)
{
    double all = NONE;
    char *groups = text_of(root, "/proc/self/cgroup"),
         *mounts = text_of(root, "/proc/self/mountinfo");
    char *rest = groups;
    for (char *line; (line = strtok_r(rest, "\n", &rest)) != NULL;) { /* ID:CONTROLLERS:/NAME */
        char *controllers = strchr(line, ':'), *name = strstr(line, ":/");
        if (!controllers || !name) continue;
        const bool second = name == ++controllers;
        *name++ = '\0';
        if (!second && !lists(controllers, controller)) continue;
        struct group g = {root, second ? NULL : controller, name, xstrdup(mounts)};
        all = fmin(all, least_of(&g, limit));
        free(g.mounts);
    }
    free(groups);
    free(mounts);
    return all;
}

/* ---- processors ------------------------------------------------------------------------------ */

/* The quota of one group: "max" and -1 are none. */
static double quota(const char *dir, bool first_version)
{
    double time_us, period_us;
    if (first_version) {
        time_us = number_of(dir, "/cpu.cfs_quota_us", NONE);
        period_us = number_of(dir, "/cpu.cfs_period_us", 0);
    } else {
        char *text = text_of(dir, "/cpu.max"), *space = strchr(text, ' ');
        int64_t q, p;
        if (space) *space = '\0', space[1 + strcspn(space + 1, "\n")] = '\0';
        bool limited =
            space && parse_int(text, 0, INT64_MAX, &q) && parse_int(space + 1, 0, INT64_MAX, &p);
        time_us = limited ? (double)q : NONE;
        period_us = limited ? (double)p : 0;
        free(text);
    }
    return time_us > 0 && period_us > 0 ? time_us / period_us : NONE;
}

double proc_quota(const char *root) { return least(root, "cpu", quota); }

int cores_available(void)
{
    const int n = os_processors();
    const double most = ceil(proc_quota(""));
    return most < n ? (int)fmax(most, 1) : n;
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* What one group may still take. The kernel takes pages of files back. */
static double room(const char *dir, bool first_version)
{
    const double most =
        number_of(dir, first_version ? "/memory.limit_in_bytes" : "/memory.max", NONE);
    if (isinf(most)) return NONE;
    char *stat = text_of(dir, "/memory.stat");
    const double files =
        first_version
            ? entry(stat, "total_inactive_file ", 0) + entry(stat, "total_active_file ", 0)
            : entry(stat, "inactive_file ", 0) + entry(stat, "active_file ", 0);
    const double used =
        number_of(dir, first_version ? "/memory.usage_in_bytes" : "/memory.current", 0);
    free(stat);
    return fmax(most - fmax(used - files, 0), 0);
}

/* The limit of addresses, less those that are used. */
static double addresses_left(double used)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return NONE;
    return fmax((double)limit.rlim_cur - used, 0);
}

struct proc_memory proc_memory(const char *root)
{
    char *text = text_of(root, "/proc/meminfo");
    const double kib =
        entry(text, "MemAvailable:", entry(text, "MemTotal:", NONE)) + entry(text, "SwapFree:", 0);
    free(text);
    const double page = (double)sysconf(_SC_PAGESIZE), all = number_of(root, "/proc/self/statm", 0);
    return (struct proc_memory){
        .bytes = fmin(kib * 1024, least(root, "memory", room)),
        .addresses = addresses_left(all * page),
    };
}
