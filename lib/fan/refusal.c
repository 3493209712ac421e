/*
 * fan: the reason of a failed connection, and advice. ssh has one exit status, 255, for all of its
 * own failures. Its messages (OpenSSH 7 to 10) tell permanent failures from passing ones. 126 and
 * 127 come from the remote shell (POSIX, 2.8.2).
 */
#include "fan/fan_int.h"

#include <string.h>

#define HELD_MOST 16384 /* bytes of a host's messages held until a connection ends */

/* If several match, the first row is the reason. */
static const struct refusal {
    const char *words;  /* in a line of ssh */
    bool final;         /* a retry cannot help */
    const char *said;   /* NULL: the line only begins a longer message, or precedes another */
    const char *advice; /* % is the host; NULL: print ssh's line; "": no advice */
} refusals[] = {
    {"REVOKED HOST KEY", true, "host key revoked", "the host needs a new one"},
    {"REMOTE HOST IDENTIFICATION HAS CHANGED", true, "host key has changed",
        "if that is expected, remove the old key with: ssh-keygen -R %"},
    {"Host key verification failed", true, "host key unknown", "accept it once with: ssh % true"},
    {"Too many authentication failures", true, "too many keys were offered",
        "name one in ~/.ssh/config, with IdentitiesOnly yes"},
    {"Permission denied (", true, "key refused", "install your key with: ssh-copy-id %"},
    {"Temporary failure in name resolution", false, "its name cannot be resolved now", ""},
    {"Could not resolve hostname", true, "unknown host name", "check the hosts file, or -S"},
    {"Unable to negotiate with", true, "ssh and sshd do not agree", NULL},
    {"Bad owner or permissions on", true, "ssh does not start", NULL},
    {"Bad configuration option", true, "ssh does not start", NULL},
    {"Bad port", true, "ssh does not start", NULL},
    {"Cannot execute command-line and remote command", true,
        "ssh_config has a RemoteCommand for it", "add -oRemoteCommand=none to its command"},
    {"Could not request local forwarding", true, "a port of ssh_config cannot be forwarded",
        "add -oClearAllForwardings=yes to its command"},
    {"Error: remote port forwarding failed", true, "a port of ssh_config cannot be forwarded",
        "add -oClearAllForwardings=yes to its command"},
    {"usage: ssh", true, "ssh does not start", NULL},
    {"Connection refused", false, "connection refused", ""},
    {"Connection timed out", false, "no answer", ""},
    {"No route to host", false, "no route to it", ""},
    {"Network is unreachable", false, "no network", ""},
    {"Connection reset by", false, "connection reset", ""},
    {"Connection closed by", false, "connection closed", ""},
    {" host key is known for ", false, NULL, NULL},
    {"@@@@@@@@@@", false, NULL, NULL},
};
#define N_REFUSALS (sizeof refusals / sizeof *refusals)

static bool has(const char *line, size_t n, const char *words)
{
    return text_find(line, n, words, strlen(words)) != NULL;
}

/* The last component of the worker's path: a shell, or env(1), names it if it is missing. */
static const char *worker_of(const struct fan *f, const struct host *h)
{
    const char *first = fan_first_word(h, f->o->command), *slash = strrchr(first, '/');
    return slash ? slash + 1 : first;
}

/* A shell says that there is no such worker, or here no such launcher. */
static bool names_worker(const struct fan *f, const struct fan_slot *s, const char *line, size_t n)
{
    static const char *const says[] = {"not found", "No such file or directory", "annot execute",
        "Permission denied", "Exec format error", NULL};
    char launcher[HOST_LAUNCHER_MOST];
    int i = 0;
    while (says[i] && !has(line, n, says[i])) i++;
    if (!says[i]) return false;
    return has(
        line, n, host_launcher(s->host->host, launcher) ? worker_of(f, s->host->host) : launcher);
}

void fan_refusal_forget(struct fan_slot *s)
{
    buf_consume(&s->conn.held, buf_size(&s->conn.held));
    s->conn.refusal = NULL;
    *s->conn.detail = '\0';
}

bool fan_refusal_holds(const struct fan *f, struct fan_slot *s, const char *line, size_t n)
{
    const struct refusal *r = refusals, *end = refusals + N_REFUSALS;
    while (r < end && !has(line, n, r->words)) r++;
    if (r < (s->conn.refusal ? s->conn.refusal : end)) {
        s->conn.refusal = r;
        fan_printable(s->conn.detail, sizeof s->conn.detail, line, n);
    } else if (!buf_size(&s->conn.held) && !names_worker(f, s, line, n)) {
        return false;
    }
    if (buf_size(&s->conn.held) + n > HELD_MOST) return false;
    buf_append(&s->conn.held, line, n);
    buf_append(&s->conn.held, "\n", 1);
    return true;
}

bool fan_refusal_ends(const char *line, size_t n)
{
    static const char *const says[] = {"onnection", "disconnect", "not responding", "roken pipe",
        "ssh", "packet", "imed out", NULL};
    int i = 0;
    while (says[i] && !has(line, n, says[i])) i++;
    return says[i] != NULL;
}

bool fan_refusal_is_final(const struct fan_slot *s)
{
    return !s->host->reached && s->conn.refusal && s->conn.refusal->final;
}

/* Explains the exit status of the shell here, or of the remote one. */
static void explain_command(const struct fan *f, const struct host *h, bool found, struct buf *text)
{
    const char *worker = worker_of(f, h);
    char launcher[HOST_LAUNCHER_MOST];
    buf_printf(text, "%s: ", h->name);
    if (!host_launcher(h, launcher))
        buf_printf(text, "no %s on this machine; install it here, or %s via= in a hosts file",
            launcher, h->via ? "change" : "state another way with");
    else if (found)
        buf_printf(text, "%s cannot be run there; install one for that machine", worker);
    else if (h->bin)
        buf_printf(text, "no %s in %s, nor on its PATH; install it there", worker, h->bin);
    else
        buf_printf(text,
            "no %s on its PATH; install it there, or say bin=DIRECTORY in a hosts "
            "file",
            worker);
}

static void explain_connection(const struct fan *f, const struct fan_slot *s, struct buf *text)
{
    const struct refusal *r = s->conn.refusal;
    const struct host *h = s->host->host;
    bool no_file = f->o->hosts->no_file && strstr(s->conn.detail, "resol");
    if (no_file && r->final) {
        buf_printf(text, "-S %s: no such file, and no host of that name", h->name);
        return;
    }
    buf_printf(text, "%s: %s%s", h->name, r->said, no_file ? ", and there is no such file" : "");
    if (!r->advice) buf_printf(text, ": %s", s->conn.detail);
    if (!r->advice || !*r->advice) return;
    size_t n = strcspn(r->advice, "%");
    bool by_ssh = !r->advice[n] || !h->via; /* a via= command other than ssh NAME reaches it */
    if (!by_ssh) buf_printf(text, "; connect to it once by hand, as its via= does");
    else
        buf_printf(text, "; %.*s%s%s", (int)n, r->advice, r->advice[n] ? h->name : "",
            r->advice[n] ? r->advice + n + 1 : "");
}

bool fan_refusal_explain(const struct fan *f, struct fan_slot *s, const char *why, struct buf *text)
{
    bool failed = strcmp(why, "exit-255") == 0 && s->conn.refusal && s->conn.refusal->said;
    bool unsent = strcmp(why, "not-sent") == 0;
    bool missing = strcmp(why, "exit-127") == 0, barred = strcmp(why, "exit-126") == 0;
    if (!failed && !missing && !barred && !unsent) return false;
    if (unsent)
        buf_printf(text, "%s: no program can be sent: %s", s->host->host->name, s->conn.detail);
    else if (failed) explain_connection(f, s, text);
    else explain_command(f, s->host->host, barred, text);
    fan_refusal_forget(s);
    return true;
}
