/*
 * Programs for hosts that have none (send=auto): static executables, and the script that runs there
 * before the worker. stormring-hosts(5) says what it does. Before the worker's hello it prints
 *
 *   stormring-send need HASH     then it reads this program, and no more, from standard input
 *   stormring-send no REASON     this host cannot be used
 *
 * Both begin a line, whatever start-up files have printed before. fan/send.c answers.
 */
#include "hosts/hosts_int.h"

#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

/*
 * For any shell that is like the Bourne shell, and with the tools that busybox has. It has no
 * newline, apostrophe, backslash or exclamation mark, because the login shell may be a csh.
 * Arguments: the machine; HASH SIZE NAME for each program; --; the worker's command.
 */
static const char script[] =
    "t=; clean() { if [ \"$t\" ]; then rm -f \"$t\"; fi; }; "
    "no() { clean; trap - EXIT; echo; echo \"stormring-send no $*\"; exit 1; }; "
    /* If the system's own directories are missing in PATH, they are added. */
    "m=$1 u=$(umask) c=; shift; umask 077; PATH=${PATH:+$PATH:}/usr/bin:/bin; export PATH; "
    "w=$(uname -sm); [ \"$w\" = \"$m\" ] || no \"it is $w, expected $m\"; "
    "for p in chmod head id mkdir mktemp mv rm sha256sum; do "
    "command -v $p >/dev/null || no \"it has no $p\"; done; "
    "case $XDG_CACHE_HOME in /*) c=$XDG_CACHE_HOME;; "
    "*) case $HOME in /?*) if [ -d \"$HOME\" ]; then c=$HOME/.cache; fi;; esac;; esac; "
    "d=${c:+$c/stormring}; d=${d:-/tmp/stormring-$(id -u)}; "
    "w=$(LC_ALL=C mkdir -p \"$d\" 2>&1) || no \"$w\"; "
    /* In /tmp another user may have been faster. */
    "if [ -h \"$d\" -a -z \"$c\" ]; then no \"$d: is a link\"; fi; "
    /* From here on the directory has the name that no link leads to: it may be exchanged. */
    "w=$(cd -P \"$d\" && [ -O . ] && pwd -P) || no \"$d: belongs to another user\"; d=$w; "
    "case $d in *:*) no \"$d: expected a directory without a colon\";; esac; "
    "w=$(LC_ALL=C chmod 700 \"$d\" 2>&1) || no \"$w\"; "
    "good() { [ -f \"$2\" ] && "
    "case $({ sha256sum <\"$2\"; } 2>/dev/null) in \"$1 \"*) ;; *) false;; esac; }; "
    "until [ \"$1\" = -- ]; do f=$d/$1/$3; "
    /* The time of the file is that of its last use. */
    "if good \"$1\" \"$f\"; then touch \"$f\" 2>/dev/null; else "
    "if [ -e \"$f\" -a ! -f \"$f\" ]; then no \"$f: is no file\"; fi; "
    "w=$(LC_ALL=C mkdir -p \"$d/$1\" 2>&1) || no \"$w\"; "
    "w=$(LC_ALL=C mktemp \"$d/$1/new.XXXXXX\" 2>&1) || no \"$w\"; "
    "t=$w; trap clean EXIT; trap \"exit 1\" HUP INT TERM PIPE; "
    "echo; echo \"stormring-send need $1\"; "
    /* If the link is cut, no end of input comes. Old versions of busybox have another timeout. */
    "w=; if timeout 9 true 2>/dev/null; then w=\"timeout $(($2 / 16384 + 60))\"; fi; "
    "w=$({ LC_ALL=C $w head -c \"$2\" >\"$t\"; } 2>&1) || no \"$d: $w\"; "
    "good \"$1\" \"$t\" || no \"$d: $3 is damaged on arrival, or the disk is full\"; "
    "w=$(LC_ALL=C chmod 700 \"$t\" 2>&1 && LC_ALL=C mv -f \"$t\" \"$f\" 2>&1) || no \"$w\"; "
    "trap - EXIT HUP INT TERM PIPE; "
    /* Parts from connections that were cut off a day ago or more, and programs not used for
     * a month. Running programs do not need their files. An empty directory goes a month later. */
    "find \"$d/$1\" -name \"new.*\" -mtime +0 -exec rm -f {} + 2>/dev/null; "
    "find \"$d\"/*/* -prune -type f -mtime +30 -exec rm -f {} + 2>/dev/null; "
    "find \"$d\"/* -prune -type d -mtime +30 -exec rmdir {} + 2>/dev/null; fi; "
    "w=$(\"$f\" --version 2>&1 </dev/null) || case $? in "
    "126) no \"$d: programs cannot be run there, as in a file system that is mounted noexec\";; "
    "*) no \"$f cannot be run: $w\";; esac; "
    "PATH=$d/$1:$PATH; shift 3; done; "
    "shift; umask \"$u\"; exec \"$@\"";

void hosts_add_bootstrap(struct buf *b, const struct hosts_sent *sent, char *const worker[])
{
    struct utsname here = {0};
    char machine[sizeof here.sysname + sizeof here.machine];
    uname(&here);
    snprintf(machine, sizeof machine, "%s %s", here.sysname, here.machine);
    buf_printf(b, "exec /bin/sh -c ");
    buf_word(b, script);
    buf_printf(b, " stormring ");
    buf_word(b, machine);
    for (size_t i = 0; i < sent->n; i++)
        buf_printf(
            b, " %s %zu %s", sent->at[i].sha256, buf_size(&sent->at[i].bytes), sent->at[i].name);
    buf_printf(b, " --");
    for (; *worker; worker++) {
        buf_append(b, " ", 1);
        buf_word(b, *worker);
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
    if (!found) {
        buf_free(&bytes);
        return;
    }
    sent->at = xrealloc(sent->at, sent->n + 1, sizeof *sent->at);
    struct hosts_program *p = &sent->at[sent->n++];
    *p = (struct hosts_program){.name = xstrdup(name), .bytes = bytes};
    sha256(buf_data(&bytes), buf_size(&bytes), p->sha256);
}

bool hosts_send(struct hosts *h, struct hosts_sent *sent, char *const worker[], char err[HOSTS_ERR])
{
    char directory[4096];
    bool wanted = false;
    for (size_t i = 0; i < h->n; i++) {
        if (!h->at[i].send) continue;
        h->at[i].sent = sent;
        wanted = true;
    }
    if (!wanted || !*worker || sent->n) return true;
    if (own_directory(directory, sizeof directory))
        for (size_t i = 0; worker[i]; i++) add(sent, directory, worker[i]);
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
