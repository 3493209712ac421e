/* mesh2nff: converts a mesh that libassimp reads to an NFF scene. */
#include "base/base.h"
#include "mesh/mesh.h"
#include "os/os.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

static const char usage_text[] = "[-htz] [-s WxH] FILE|-";

static struct mesh_options parse(int argc, char **argv, bool *textures)
{
    struct mesh_options o = {.z_up = false};
    int w = 0, h = 0;
    *textures = false;
    for (int c; (c = prog_getopt(argc, argv, "hs:tz")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 's': opt_size(c, optarg, 65535, &w, &h); break;
        case 't': *textures = true; break;
        case 'z': o.z_up = true; break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 1) usage(ST_USAGE, usage_text);
    o.width = (uint32_t)w, o.height = (uint32_t)h;
    return o;
}

/* ---- faults of libassimp -------------------------------------------------------------------- */

/*
 * On damaged files libassimp may abort, use up the stack, or run forever. While it reads, any of
 * these means that the file is refused.
 */
static const int fatal[] = {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGPROF, SIGSEGV};
#define STACK_BYTES 65536 /* of the handler's own stack */
#define SECONDS 5         /* of CPU time for any file, many times what the slowest format needs, */
#define SECONDS_PER_MB 2  /* and for its size */
#define SECONDS_OF_PIPE 600
static char complaint[2][512]; /* of failing, of not ending */

static void complain(int signal)
{
    const char *text = complaint[signal == SIGPROF];
    (void)!write(STDERR_FILENO, text, strlen(text));
    _exit(ST_USAGE);
}

static int seconds_for(const char *path)
{
    struct stat st;
    if (stat(path, &st) != 0 || !S_ISREG(st.st_mode)) return SECONDS_OF_PIPE;
    return SECONDS + (int)fmin((double)st.st_size / 1e6 * SECONDS_PER_MB, 1e6);
}

/* flags: of the handler. */
static void guard(const char *path, const char *name, bool on, int flags)
{
    struct sigaction act = {.sa_flags = flags | (int)SA_RESETHAND};
    struct itimerval limit = {.it_value.tv_sec = on ? seconds_for(path) : 0};
    char file[301];
    text_shown(file, sizeof file, name);
    act.sa_handler = on ? complain : SIG_DFL;
    snprintf(complaint[0], sizeof complaint[0],
        "%s: %s: libassimp failed, expected a file without damage\n", prog_name(), file);
    snprintf(complaint[1], sizeof complaint[1],
        "%s: %s: libassimp did not end within %ld s, expected a file without damage\n", prog_name(),
        file, (long)limit.it_value.tv_sec);
    if (!on) setitimer(ITIMER_PROF, &limit, NULL);
    for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++) sigaction(fatal[i], &act, NULL);
    if (on) setitimer(ITIMER_PROF, &limit, NULL);
}

int main(int argc, char **argv)
{
    char err[ERR_BYTES];
    prog_init(argv[0]);
    bool textures;
    struct mesh_options o = parse(argc, argv, &textures);
    const char *path = argv[optind], *name = strcmp(path, "-") == 0 ? "stdin" : path;
    /* A stack of its own, because a deep tree may use up the other. */
    void *stack = xmalloc(1, STACK_BYTES);
    guard(path, name, true, os_signal_stack(stack, STACK_BYTES));
    struct mesh *m = mesh_open(path, &o, err);
    guard(path, name, false, 0);
    if (!m) die(ST_USAGE, "%s: %s", name, err);
    if (textures) mesh_take_textures(m);
    for (const struct mesh_loss *l = mesh_losses(m); l->what; l++)
        if (l->n) warn("%s: %s: %llu, %s", name, l->what, (unsigned long long)l->n, l->outcome);
    if (*mesh_turned(m)) warn("%s: %s", name, mesh_turned(m));
    const uint32_t colours = mesh_write(m, stdout);
    if (textures) warn("%s: colours of textures: %u, at most 2.5/255 of sRGB off", name, colours);
    mesh_close(m);
    os_signal_stack(NULL, 0);
    free(stack);
    close_stdout();
    return ST_OK;
}
