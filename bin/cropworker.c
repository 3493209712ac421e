/* cropworker: runs a command for the rectangle of each task it reads. */
#include "base/base.h"
#include "crop/crop.h"
#include "files/files.h"
#include "os/os.h"
#include "worker/worker.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/resource.h>
#include <unistd.h>

#define FORMAT_VERSION 2 /* raise it when a pixel of any picture changes */

struct options {
    struct worker_options worker;
    struct worker_words words; /* for job hashes and `with=` */
    int w, h;                  /* -i -s: size of the frame; 0: render tasks */
    int64_t frame;             /* -F: its number */
    enum image_deep deep;      /* -g: what 16 bits that do not state their curve hold */
    bool anywhere;             /* -w: the command may write anywhere */
    char **command;
    const char *scratch; /* directory of this process */
    pid_t pid;           /* this process, and not one of its slots */
};

/* ---- its files ------------------------------------------------------------------------------ */

/* A `files` record, unpacked. */
struct unpacked {
    char *directory, *first;
};

static int unpack(const void *options, const char *name, unsigned char *bytes, size_t n,
    void *value, char err[WORKER_ERR])
{
    static unsigned count;
    const struct options *o = options;
    struct unpacked *u = value;
    struct buf path = {0};
    (void)name;
    buf_printf(&path, "%s/%u", o->scratch, ++count);
    buf_append(&path, "", 1);
    u->directory = xstrdup((const char *)buf_data(&path));
    buf_free(&path);
    errno = 0;
    bool good =
        mkdir(u->directory, 0700) == 0 || err_set(err, "%s: %s", u->directory, strerror(errno));
    char *first = NULL;
    if (good && files_unpack(bytes, n, u->directory, &first, err)) {
        struct buf plain = {0}; /* a name that no command takes for an option */
        buf_printf(&plain, "./%s", first);
        buf_append(&plain, "", 1);
        u->first = xstrdup((const char *)buf_data(&plain));
        buf_free(&plain);
        free(first);
        return 0;
    }
    int err_no = errno;
    crop_remove(u->directory);
    if (err_no == ENOSPC || err_no == EDQUOT || err_no == EIO) die(ST_SYSTEM, "%s", err);
    free(u->directory);
    return -1;
}

static void remove_files(void *value)
{
    struct unpacked *u = value;
    crop_remove(u->directory);
    crop_remove_copies(u->directory);
    free(u->directory);
    free(u->first);
}

/* ---- the command ---------------------------------------------------------------------------- */

/* What is drawn for the current task. */
struct drawing {
    struct crop_command command;
    pid_t pid; /* of the process that the files are of; others make copies */
    char *own; /* such a copy, or NULL */
    struct crop_rect at;
    struct image picture;
};

static void *build(const void *options, void *const value[])
{
    const struct options *o = options;
    struct drawing *d = xcalloc(1, sizeof *d);
    const struct unpacked *u = value[0];
    d->command = (struct crop_command){
        .words = o->command, .scratch = o->scratch, .deep = o->deep, .confined = !o->anywhere};
    d->pid = o->pid;
    if (u) d->command.files = u->directory, d->command.first = u->first;
    return d;
}

static void free_drawing(void *built)
{
    struct drawing *d = built;
    image_free(&d->picture);
    free(d->own);
    free(d);
}

/* A slot of several has its own copy of the files: commands may write files and read them again. */
static void own_files(struct drawing *d)
{
    if (!d->command.files || d->own || d->pid == getpid()) return;
    d->command.files = d->own = crop_copy(d->command.files);
}

/* A task that cannot be drawn fails, and another worker, perhaps on another host, may get it. */
static bool task(
    void *built, const struct frame_size *f, const struct lattice *whole, char why[WORKER_ERR])
{
    struct drawing *d = built;
    char err[CROP_ERR];
    own_files(d);
    image_free(&d->picture);
    d->at = crop_around(whole, f->w, f->h);
    d->at.frame = f->frame;
    if (crop_draw(&d->command, &d->at, &d->picture, err) == 0) return true;
    return err_set(why, "frame %u, rectangle %u,%u %ux%u: %s", d->at.frame, d->at.x, d->at.y,
        d->at.w, d->at.h, err);
}

static void render(void *built, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    const struct drawing *d = built;
    crop_pixels(&d->picture, &d->at, at, n0, n, rgba);
}

/* The values of 8 bits in linear light, as often as takes about as long as that of rtworker. */
static void selftest(float *rgba, uint32_t *n)
{
    *n = 64;
    for (int again = 0; again < 128; again++)
        for (int v = 0; v < 256; v++) rgba[v] = srgb_decode8((uint8_t)v);
}

static int64_t used_us(void *states)
{
    struct rusage ended;
    (void)states;
    getrusage(RUSAGE_CHILDREN, &ended);
    return cpu_us() + (int64_t)(ended.ru_utime.tv_sec + ended.ru_stime.tv_sec) * 1000000 +
           ended.ru_utime.tv_usec + ended.ru_stime.tv_usec;
}

static struct worker_renderer renderer = {
    .program = "cropworker",
    .part = {{REC_FILES, false, sizeof(struct unpacked), unpack, remove_files, NULL}},
    .build = build,
    .free = free_drawing,
    .task = task,
    .render = render,
    .selftest = selftest,
    .cpu_us = used_us,
};

/* ---- options -------------------------------------------------------------------------------- */

static enum image_deep take_curve(const char *s)
{
    if (strcmp(s, "srgb") == 0) return IMAGE_DEEP_SRGB;
    if (strcmp(s, "linear") == 0) return IMAGE_DEEP_LINEAR;
    die(ST_USAGE, "-g %s: expected srgb or linear", s);
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-chw] [-f PIXELS] [-g srgb|linear] [-j SLOTS] COMMAND [ARGUMENT ...]\n"
        "       cropworker -i [-w] [-F FRAME] [-g srgb|linear] -s WxH COMMAND "
        "[ARGUMENT ...]";
    bool inspect = false;
    struct options o = {.deep = IMAGE_DEEP_REFUSED};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+F:g:hij:s:w" WORKER_OPTIONS)) != -1) {
        switch (opt) {
        case 'F': o.frame = opt_int(opt, optarg, 0, UINT32_MAX); break;
        case 'g': o.deep = take_curve(optarg); break;
        case 'h': usage(ST_OK, text);
        case 'i': inspect = true; break;
        case 's': opt_size(opt, optarg, FRAME_SIDE_MAX, &o.w, &o.h); break;
        case 'w': o.anywhere = true; break;
        default:
            if (!worker_option(&o.worker, opt, optarg)) usage(ST_USAGE, text);
        }
    }
    if (optind == argc) usage(ST_USAGE, text);
    if (!inspect && o.frame) die(ST_USAGE, "-F: expected -i with it");
    if (inspect != (o.w > 0)) die(ST_USAGE, "-i and -s: expected both or neither");
    o.command = argv + optind;
    char hash[SHA256_TEXT];
    crop_words_hash(o.command, hash);
    snprintf(o.words.job, sizeof o.words.job, "crop %d deep=%d words=%s", FORMAT_VERSION,
        (int)o.deep, hash);
    snprintf(o.words.with, sizeof o.words.with, "cropworker");
    return o;
}

/* Takes the files from standard input. */
static void take(void *states, const struct record *r)
{
    const struct worker_ops ops = worker_states_ops(states);
    char err[WORKER_ERR];
    struct buf body = {0};
    buf_append(&body, r->body, r->body_len);
    if (r->kind != REC_FILES) die(ST_USAGE, "record `%s`, expected `files`", rec_name(r->kind));
    if (ops.state(states, 0, r->kind, body.data, r->body_len, err) != 0) die(ST_USAGE, "%s", err);
    buf_free(&body);
}

/* Draws the pixel in the middle, so that a wrong command is found before the run. */
static void inspect(struct worker_states *s, const struct options *o)
{
    const uint32_t w = (uint32_t)o->w, h = (uint32_t)o->h;
    char why[WIRE_WHY], err[CROP_ERR];
    if (renderer.n_parts && wire_read(STDIN_FILENO, take, s, why) != 0)
        die(ST_USAGE, "standard input: %s", why);
    struct drawing *d = worker_states_built(s, w, h);
    d->at = (struct crop_rect){(uint32_t)o->frame, w, h, w / 2, h / 2, 1, 1};
    int failed = crop_draw(&d->command, &d->at, &d->picture, err);
    if (failed == CROP_NOT_FOUND) warn("%s; it was not tried here", err);
    else if (failed) die(ST_USAGE, "%s", err);
    char job[WIRE_JOB];
    worker_states_job(s, w, h, job);
    printf("frame %u %u\njob=%s\n", w, h, job);
    close_stdout();
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    /* The memory of a picture is new each time: then rows that are not decoded cost nothing. */
    os_allocate_afresh(1 << 18);
    struct options o = parse(argc, argv);
    /* A command without {i} has no state. */
    renderer.n_parts = crop_uses(o.command, "i") ? 1 : 0;
    if (!o.anywhere && !crop_landlock()) {
        warn("no Landlock in this kernel: the command can write all files of this account");
        o.anywhere = true;
    }
    o.scratch = crop_directory();
    o.pid = getpid();
    struct worker_states *s = worker_states_new(&renderer, &o, &o.words);
    int status = ST_OK;
    if (o.w) inspect(s, &o);
    else status = worker_render(s, &o.worker);
    worker_states_free(s);
    return status;
}
