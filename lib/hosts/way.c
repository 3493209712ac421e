/*
 * Whether ssh goes through another host. `ssh -G` tells for one host, and takes 5 ms; with -v it
 * also names the files of its configuration. If none of them has such a line, there is no need to
 * ask for each host.
 */
#include "hosts/hosts_int.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

char **host_settings_argv(const struct host *h)
{
    const char *via = hosts_via(h);
    size_t n = strcspn(via, " \t");
    if (!host_by_ssh(h) || strpbrk(via, "|&;<>()`$\n")) return NULL;
    struct buf asks = {0};
    buf_printf(&asks, "%.*s -v -G%s", (int)n, via, via + n);
    buf_append(&asks, "", 1);
    char **argv = hosts_by_sh("timeout 1 ", (const char *)asks.data, h->name, "true");
    buf_free(&asks);
    return argv;
}

/* True if a line of the text begins with one of the two keys. */
static bool has_key(const char *at, const char *end)
{
    for (const char *stop; at < end; at = stop + 1) {
        stop = memchr(at, '\n', (size_t)(end - at));
        if (!stop) stop = end;
        while (at < stop && strchr(" \t", *at)) at++;
        if (stop - at > 9 && strncasecmp(at, "proxyjump", 9) == 0) return true;
        if (stop - at > 12 && strncasecmp(at, "proxycommand", 12) == 0) return true;
    }
    return false;
}

/* The file of this name, of n bytes, has such a line. */
static bool file_has_key(const char *name, size_t n)
{
    struct buf text = {0};
    char *path = xcalloc(n + 1, 1);
    memcpy(path, name, n);
    bool has = read_file(path, &text) == 0 && has_key((const char *)buf_data(&text),
                                                  (const char *)buf_data(&text) + buf_size(&text));
    buf_free(&text);
    free(path);
    return has;
}

bool host_config_jumps(const char *said, size_t n)
{
    static const char reads[] = "Reading configuration data ";
    const char *end = said + n, *at, *stop;
    while ((at = text_find(said, (size_t)(end - said), reads, sizeof reads - 1)) != NULL) {
        at += sizeof reads - 1;
        said = stop = at + strcspn(at, "\r\n");
        if (file_has_key(at, (size_t)(stop - at))) return true;
    }
    return false;
}

bool host_via_jumps(const struct host *h)
{
    const char *via = hosts_via(h);
    return strstr(via, " -J") || text_has(via, "proxyjump") || text_has(via, "proxycommand");
}

char *host_jump(const char *settings, size_t n)
{
    static const char *const keys[] = {"proxyjump ", "proxycommand "};
    const char *end = settings + n;
    for (const char *at = settings, *stop; at < end; at = stop + 1) {
        stop = memchr(at, '\n', (size_t)(end - at));
        if (!stop) stop = end;
        for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
            size_t k = strlen(keys[i]), most = (size_t)(stop - at);
            if (most <= k || memcmp(at, keys[i], k) != 0) continue;
            if (most - k == 4 && memcmp(at + k, "none", 4) == 0) continue;
            char *jump = xcalloc(most - k + 1, 1);
            return memcpy(jump, at + k, most - k);
        }
    }
    return NULL;
}
