/* Programs for hosts that have none (send=auto): static executables, and the command that runs
 * bootstrap.sh there before the worker. stormring-hosts(5) says what it does. */
#include "hosts/hosts_int.h"

#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

void hosts_add_bootstrap(struct buf *b, const struct hosts_sent *sent, char *const worker[])
{
    struct utsname here = {0};
    char machine[sizeof here.sysname + sizeof here.machine];
    uname(&here);
    snprintf(machine, sizeof machine, "%s %s", here.sysname, here.machine);
    buf_printf(b, "exec /bin/sh -c ");
    buf_word(b, hosts_bootstrap);
    buf_printf(b, " stormring ");
    buf_word(b, machine);
    for (size_t i = 0; i < sent->n; i++)
        buf_printf(
            b, " %s %zu %s", sent->at[i].sha256, buf_size(&sent->at[i].bytes), sent->at[i].name);
    buf_printf(b, " --");
    for (; *worker; worker++) {
        buf_append(b, " ", 1);
        hosts_add_word(b, *worker);
    }
}

/* ---- the programs that are sent ---- */

/* Where static programs are, seen from the directory of this one: built by `make`, with another
 * BUILD, or installed. */
static const char *const places[] = {"../build/static", "../static", "../lib/stormring"};

/* The directory of this program, with a slash at its end. */
static bool own_directory(char *path, size_t size)
{
    ssize_t n = readlink("/proc/self/exe", path, size);
    if (n <= 0 || (size_t)n >= size) return false;
    path[n] = '\0';
    strrchr(path, '/')[1] = '\0';
    return true;
}

static bool known(const struct hosts_sent *sent, const char *name)
{
    for (size_t i = 0; i < sent->n; i++)
        if (strcmp(sent->at[i].name, name) == 0) return true;
    return false;
}

/* The number of bytes of DIRECTORY/HASH if `path` begins with that; else 0. */
static size_t kept_in(const char *path, const char *directory, size_t n)
{
    bool begins = strncmp(path, directory, n) == 0;
    bool hash = begins && strspn(path + n, "0123456789abcdef") == SHA256_TEXT - 1;
    return hash ? n + SHA256_TEXT - 1 : 0;
}

/* If this program was sent here itself, others that were sent with it are on the PATH, each in a
 * directory beside this one. */
static bool read_sent(const char *own, const char *name, struct buf *bytes)
{
    size_t n = strlen(own), beside = n < SHA256_TEXT ? 0 : n - SHA256_TEXT;
    const char *at = getenv("PATH");
    bool found = false;
    if (!at || !beside || !kept_in(own, own, beside)) return false;
    for (; *at && !found; at += strcspn(at, ":"), at += *at == ':') {
        struct buf path = {0};
        size_t length = kept_in(at, own, beside);
        if (!length || (at[length] && at[length] != ':')) continue;
        buf_printf(&path, "%.*s/%s", (int)length, at, name);
        buf_append(&path, "", 1);
        found = read_file((char *)path.data, bytes) == 0;
        buf_free(&path);
    }
    return found;
}

/* Adds the program of this name, if there is a static one. */
static void add(struct hosts_sent *sent, const char *directory, const char *name)
{
    struct buf bytes = {0};
    bool found = false;
    /* A name with a slash is that of a file on the host. */
    if (!*name || strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_-") != strlen(name)) return;
    if (known(sent, name) || sent->n == HOSTS_SENT_MOST) return;
    for (size_t i = 0; i < sizeof places / sizeof *places && !found; i++) {
        struct buf path = {0};
        buf_printf(&path, "%s%s/%s", directory, places[i], name);
        buf_append(&path, "", 1);
        found = read_file((char *)path.data, &bytes) == 0;
        buf_free(&path);
    }
    if (!found && !read_sent(directory, name, &bytes)) {
        buf_free(&bytes);
        return;
    }
    sent->at = xrealloc(sent->at, sent->n + 1, sizeof *sent->at);
    struct hosts_program *p = &sent->at[sent->n++];
    *p = (struct hosts_program){.name = xstrdup(name), .bytes = bytes};
    sha256(buf_data(&bytes), buf_size(&bytes), p->sha256);
}

/* The host gets these programs if it has none; so do the hosts of a rack. True if one of them does.
 */
static bool is_sent(struct host *h, const struct hosts_sent *sent)
{
    bool any = h->send;
    if (h->send) h->sent = sent;
    for (size_t k = 0; k < h->n_members; k++) any |= is_sent(&h->members[k], sent);
    return any;
}

bool hosts_send(struct hosts *h, struct hosts_sent *sent, char *const worker[], char err[HOSTS_ERR])
{
    char directory[4096];
    bool wanted = false, racks = false;
    for (size_t i = 0; i < h->n; i++) {
        if (!is_sent(&h->at[i], sent)) continue;
        wanted = true;
        racks = racks || h->at[i].rack;
    }
    if (!wanted || !*worker || sent->n) return true;
    if (own_directory(directory, sizeof directory)) {
        for (size_t i = 0; worker[i]; i++) add(sent, directory, worker[i]);
        if (racks) add(sent, directory, "deal");
        if (racks) add(sent, directory, "fan");
    }
    if (sent->n) return true;
    snprintf(err, HOSTS_ERR,
        "send=auto: no word of `%.64s ...` is a static program in %.200s%s, expected one, "
        "built by `make` or `make install`",
        worker[0], directory, places[2]);
    return false;
}

const struct hosts_program *hosts_program(const struct hosts_sent *sent, const char *sha256)
{
    for (size_t i = 0; sent && i < sent->n; i++)
        if (strcmp(sent->at[i].sha256, sha256) == 0) return &sent->at[i];
    return NULL;
}

void hosts_sent_free(struct hosts_sent *sent)
{
    for (size_t i = 0; i < sent->n; i++) {
        free(sent->at[i].name);
        buf_free(&sent->at[i].bytes);
    }
    free(sent->at);
    *sent = (struct hosts_sent){0};
}
