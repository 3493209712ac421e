/*
 * quota: the processors that control groups allow this process: proc.h. The files are those of
 * Linux (Documentation/admin-guide/cgroup-v2.rst, cpu.max; scheduler/sched-bwc.rst, cpu.cfs_*).
 */
#include "proc/proc.h"

#include <limits.h>
#include <string.h>

/* The first line of root/dir/name, without its end. False: there is none. */
static bool first_line(const char *root, const char *dir, const char *name, char text[64])
{
    char path[PATH_MAX];
    if (snprintf(path, sizeof path, "%s%s/%s", root, dir, name) >= (int)sizeof path) return false;
    FILE *f = fopen(path, "re");
    if (!f) return false;
    const bool good = fgets(text, 64, f) != NULL;
    fclose(f);
    if (good) text[strcspn(text, "\n")] = '\0';
    return good;
}

/* Times of a period, in microseconds. No quota: "max" or -1. */
static double part(const char *quota, const char *period)
{
    int64_t q, p;
    if (!parse_int(quota, 1, INT64_MAX, &q) || !parse_int(period, 1, INT64_MAX, &p))
        return (double)INFINITY;
    return (double)q / (double)p;
}

static double of_group(const char *root, bool first_version, const char *dir)
{
    char quota[64], period[64];
    if (first_version) {
        bool both = first_line(root, dir, "cpu.cfs_quota_us", quota) &&
                    first_line(root, dir, "cpu.cfs_period_us", period);
        return both ? part(quota, period) : (double)INFINITY;
    }
    if (!first_line(root, dir, "cpu.max", quota)) return (double)INFINITY;
    char *space = strchr(quota, ' ');
    if (!space) return (double)INFINITY;
    *space = '\0';
    return part(quota, space + 1);
}

/* The least of a group and those around it. In a container the root may be the group itself. */
static double of_all(const char *root, bool first_version, char *dir)
{
    double least = (double)INFINITY;
    while (*dir) {
        if (strcmp(dir, "/") != 0) least = fmin(least, of_group(root, first_version, dir));
        *strrchr(dir, '/') = '\0';
    }
    return fmin(least, of_group(root, first_version, ""));
}

double proc_quota(const char *groups, const char *root)
{
    char line[PATH_MAX + 64], first[PATH_MAX];
    double least = (double)INFINITY;
    FILE *f = fopen(groups, "re");
    if (!f) return least;
    snprintf(first, sizeof first, "%s/cpu", root);
    while (fgets(line, sizeof line, f)) { /* ID:CONTROLLERS:/DIR */
        char *kind = strchr(line, ':'), *dir = strstr(line, ":/");
        if (!kind || !dir) continue;
        *dir++ = '\0';
        dir[strcspn(dir, "\n")] = '\0';
        if (dir == kind + 2) least = fmin(least, of_all(root, false, dir));
        char *rest = kind + 1;
        for (char *word; (word = strtok_r(rest, ",", &rest));)
            if (strcmp(word, "cpu") == 0) least = fmin(least, of_all(first, true, dir));
    }
    fclose(f);
    return least;
}
