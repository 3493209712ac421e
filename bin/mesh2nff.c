/* mesh2nff: converts a mesh that libassimp reads to an NFF scene. */
#include "base/base.h"
#include "mesh/mesh.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage_text[] = "[-hz] [-s WxH] FILE|-";

static struct mesh_options parse(int argc, char **argv)
{
    struct mesh_options o = {.z_up = false};
    int w = 0, h = 0;
    for (int c; (c = prog_getopt(argc, argv, "hs:z")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 's': opt_size(c, optarg, 65535, &w, &h); break;
        case 'z': o.z_up = true; break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 1) usage(ST_USAGE, usage_text);
    o.width = (uint32_t)w, o.height = (uint32_t)h;
    return o;
}

/* ---- faults of libassimp, which aborts on some damaged files ---------------------------------- */

static const int fatal[] = {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV};
#define FATALS (sizeof fatal / sizeof *fatal)
#define STACK_BYTES 65536
static char complaint[512];

static void complain(int signal)
{
    (void)signal;
    (void)!write(STDERR_FILENO, complaint, strlen(complaint));
    _exit(ST_USAGE);
}

/* While the file is read, such a fault is a file that is refused. */
static void guard(const char *name, bool on)
{
    struct sigaction act = {.sa_flags = (int)(SA_ONSTACK | SA_RESETHAND)};
    act.sa_handler = on ? complain : SIG_DFL;
    snprintf(complaint, sizeof complaint,
        "%s: %.300s: libassimp failed, expected a file without damage\n", prog_name(), name);
    for (size_t i = 0; i < FATALS; i++) sigaction(fatal[i], &act, NULL);
}

int main(int argc, char **argv)
{
    char err[ERR_BYTES];
    prog_init(argv[0]);
    struct mesh_options o = parse(argc, argv);
    const char *path = argv[optind], *name = strcmp(path, "-") == 0 ? "stdin" : path;
    /* A stack of its own, because a deep tree may use up the other. */
    stack_t stack = {.ss_sp = xmalloc(1, STACK_BYTES), .ss_size = STACK_BYTES};
    sigaltstack(&stack, NULL);
    guard(name, true);
    struct mesh *m = mesh_open(path, &o, err);
    guard(name, false);
    if (!m) die(ST_USAGE, "%s: %s", name, err);
    for (const struct mesh_loss *l = mesh_losses(m); l->what; l++)
        if (l->n) warn("%s: %s: %llu, %s", name, l->what, (unsigned long long)l->n, l->outcome);
    mesh_write(m, stdout);
    mesh_close(m);
    sigaltstack(&(stack_t){.ss_flags = SS_DISABLE}, NULL);
    free(stack.ss_sp);
    close_stdout();
    return ST_OK;
}
