/*
 * Names of hosts: which ones are accepted, and what to write instead of forms that people know from
 * other programs: GNU parallel, mpirun, rsync, URLs.
 */
#include "hosts/hosts_int.h"

#include <arpa/inet.h>
#include <string.h>

#define NAME_BYTES "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._:@%+-"
#define DIGITS "0123456789"

/* The only names with a colon are IPv6 addresses, with or without %ZONE. */
static bool is_ipv6(const char *s, size_t all)
{
    char address[INET6_ADDRSTRLEN];
    struct in6_addr bytes;
    const char *zone = memchr(s, '%', all);
    size_t n = zone ? (size_t)(zone - s) : all;
    if (n >= sizeof address) return false;
    memcpy(address, s, n);
    address[n] = '\0';
    return inet_pton(AF_INET6, address, &bytes) == 1;
}

static const char *without_user(const char *s)
{
    const char *at = strchr(s, '@');
    return at ? at + 1 : s;
}

/* A valid name is one word for every shell and in every record, and no program takes it for an
 * option, nor a person for a directory: `.` and `..` are no hosts. */
static bool name_valid(const char *s)
{
    size_t n = strlen(s);
    if (strcmp(s, ":") == 0) return true;
    if (n > HOST_NAME_MOST || *s == '-' || *s == '@' || s[strspn(s, NAME_BYTES)]) return false;
    const char *host = without_user(s);
    if (!host[strspn(host, ".")] || *host == '-' || strchr(host, '@')) return false;
    return !strchr(s, ':') || is_ipv6(host, strlen(host));
}

/* Has s the form of digits, this byte, and a name? */
static bool counted(const char *s, char by)
{
    size_t n = strspn(s, DIGITS);
    return n && s[n] == by && s[n + 1];
}

/* What the number after a colon may have been meant for. */
static void advise_number(char *to, const char *s, const char *colon, bool file)
{
    char shown[ERR_WORD];
    int n = (int)(colon - s) < HOST_NAME_MOST ? (int)(colon - s) : HOST_NAME_MOST;
    err_word(shown, s, (size_t)n);
    snprintf(to, HOSTS_ERR,
        "%s without a colon: a port goes into ~/.ssh/config, or a hosts file has "
        "via=\"ssh -p %.8s %%h %%c\"; slots are written %s",
        shown, colon + 1, file ? "slots=4" : "4/host");
}

/* What is expected in the place of this name, in the form of a file or of a list. */
static void advise(char *to, const char *s, bool file)
{
    const char *host = without_user(s), *colon = strchr(host, ':'), *open = strchr(host, '['),
               *close = open ? strchr(open, ']') : NULL;
    const char *slots = file ? "a line `host slots=4`" : "`4/host`";
    if (!*s && !file)
        snprintf(to, HOSTS_ERR, "a name before and after each comma, and after `4/`; `:` is here");
    else if (strstr(s, "://"))
        snprintf(
            to, HOSTS_ERR, "HOST or USER@HOST, without `ssh://`; a port goes into ~/.ssh/config");
    else if (strcmp(s, "slurm:") == 0 || strcmp(s, "pbs:") == 0)
        snprintf(to, HOSTS_ERR, "`%s` alone, as the argument of -S", s);
    else if (open == host && close && is_ipv6(open + 1, (size_t)(close - open - 1)))
        snprintf(to, HOSTS_ERR, "an IPv6 address without brackets%s", close[1] ? " and port" : "");
    else if (file && *s == '[' && s[strlen(s) - 1] == ']')
        snprintf(to, HOSTS_ERR, "a host in each line: a hosts file has no groups");
    else if (strpbrk(s, "[]{}") && !strchr(s, '\033'))
        snprintf(to, HOSTS_ERR, "each host by its name: only `slurm:` expands brackets");
    else if (file && strchr(s, ',')) snprintf(to, HOSTS_ERR, "one host a line, without a comma");
    else if (counted(s, '*') || counted(s, '/'))
        snprintf(to, HOSTS_ERR, "%s for four slots", slots);
    else if (strchr(s, '*') || strchr(s, '/'))
        snprintf(to, HOSTS_ERR, "HOST or USER@HOST; four slots are written %s", slots);
    else if (!file && strpbrk(s, " \t\n;"))
        snprintf(to, HOSTS_ERR, "commas between names, and no blanks");
    else if (colon && colon > host && colon[1] && !colon[1 + strspn(colon + 1, DIGITS)])
        advise_number(to, s, colon, file);
    else
        snprintf(to, HOSTS_ERR,
            "`:`, HOST or USER@HOST first, of letters, digits and ._@%%+-, or an IPv6 address");
}

bool hosts_set_name(const struct hosts_reader *r, struct host *host, const char *name)
{
    char shown[ERR_WORD], instead[HOSTS_ERR];
    host->name = xstrdup(name);
    if (name_valid(name)) return true;
    advise(instead, name, r->line > 0);
    return hosts_refuse(
        r, "%s: no host name, expected %s", err_word(shown, name, strlen(name)), instead);
}
