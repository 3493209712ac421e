/*
 * job: says what the files of a run mean, and writes their state records.
 *
 * lib/job has the rules. This program asks the renderer for the frames, which knows what a picture
 * depends on. For a scene of POV-Ray or Blender, its worker says which files these are.
 */
#include "job/job.h"
#include "base/base.h"
#include "proc/proc.h"
#include "spec/spec.h"
#include "task/task.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct options {
    bool inspect;       /* -i: what the files mean; else their state */
    bool one;           /* -1: one picture is expected */
    bool map;           /* -m: the pictures will be put over maps */
    bool transparent;   /* with -m: some specification has a background */
    const char *frames; /* -e: a file, as -i prints them */
    char *kept;         /* -k: a file for what -i reads only once, or makes */
    char *size;         /* -s; NULL: that of the file */
    const char *worker; /* -W, and its words */
    char **words;
    size_t n_words;
    struct job job;
    char *program;     /* the worker */
    struct buf inputs; /* the lines `input` of it */
};

static const char usage_text[] = "[-h] [-e FRAMES] FILE ...\n"
                                 "       job -i [-1m] [-k FILE] [-s WxH] [-W OPTIONS] SCENE.nff|-\n"
                                 "       job -i ... SCENE.nff ... VIEW ...\n"
                                 "       job -i ... GRID.vtk ... SPEC ...\n"
                                 "       job -i ... GRID.vtk\n"
                                 "       job -i ... SCENE.pov|SCENE.blend [FILE ...]";

static struct options parse(int argc, char **argv)
{
    struct options o = {.worker = ""};
    char err[ERR_BYTES];
    int w, h;
    for (int c; (c = prog_getopt(argc, argv, "+1e:hik:ms:W:")) != -1;) switch (c) {
        case '1': o.one = true; break;
        case 'e': o.frames = opt_text(c, optarg); break;
        case 'h': usage(ST_OK, usage_text);
        case 'i': o.inspect = true; break;
        case 'k': opt_text(c, optarg), o.kept = optarg; break;
        case 'm': o.map = true; break;
        case 's': opt_size(c, optarg, FRAME_SIDE_MAX, &w, &h), o.size = optarg; break;
        case 'W': o.worker = optarg; break; /* checked by words */
        default: usage(ST_USAGE, usage_text);
        }
    if (optind == argc) usage(ST_USAGE, usage_text);
    if (!o.inspect && (o.one || o.kept || o.map || o.size || *o.worker))
        die(ST_USAGE, "-1, -k, -m, -s and -W: expected -i with them");
    if (o.inspect && o.frames) die(ST_USAGE, "-e: expected no -i with it");
    if (!job_of(&o.job, argv + optind, (size_t)(argc - optind), err)) die(ST_USAGE, "%s", err);
    o.program = xstrdup(job_worker(&o.job));
    o.words = job_words(o.worker, &o.n_words);
    if (!job_words_check(&o.job, o.worker, o.words, err)) die(ST_USAGE, "-W %s", err);
    return o;
}

static void put_starter(const struct options *o, struct buf *text)
{
    char err[ERR_BYTES];
    int w = 0, h = 0;
    if (o->size) parse_size(o->size, FRAME_SIDE_MAX, &w, &h);
    if (!job_starter(*o->job.path, (uint32_t)w, (uint32_t)h, text, err)) die(ST_USAGE, "%s", err);
}

/* ---- state ---------------------------------------------------------------------------------- */

/* Reads the frames, a line each. */
static char *load_frames(const char *path, struct buf *b)
{
    char err[ERR_BYTES];
    *b = (struct buf){0};
    if (path && !load_file(path, b, err)) die(ST_USAGE, "%s", err);
    buf_append(b, "", 1);
    return (char *)b->data;
}

/* Without frames, the state of the first picture only. */
static void write_pairs(const struct options *o)
{
    const struct job *j = &o->job;
    const bool scenes = j->what == JOB_SCENE;
    const size_t n = o->frames ? job_states(j) : 1;
    struct buf frames, starter = {0};
    char *frame = load_frames(o->frames, &frames);
    for (size_t at = 0; at < n; at++) {
        const struct job_state s = job_state(j, at);
        if (s.new_subject) job_put_file(scenes ? REC_SCENE : REC_GRID, j->path[s.subject]);
        if (j->starter) put_starter(o, &starter), job_put(REC_SPEC, "spec", &starter);
        else if (s.new_look) job_put_file(scenes ? REC_VIEW : REC_SPEC, j->path[s.look]);
        if (n == 1) break;
        char *end = strchr(frame, '\n');
        if (!end) die(ST_USAGE, "%s: %zu frames, expected %zu", o->frames, at, n);
        put_stdout(frame, (size_t)(end + 1 - frame));
        fflush(stdout); /* its tasks need not wait for the next state */
        frame = end + 1;
    }
    buf_free(&frames);
}

/* The files of a scene of another renderer: those that are given, as -i has named them. */
static void write_files(const struct job *j)
{
    static char pack[] = "pack", files[] = "files";
    char **words = xcalloc(j->n + 3, sizeof *words);
    words[0] = pack, words[1] = files;
    memcpy(words + 2, j->path, j->n * sizeof *words);
    execvp(pack, words);
    die(ST_SYSTEM, "%s:", pack);
}

/* ---- -i ------------------------------------------------------------------------------------- */

/* A map under a picture with a background is not seen: the worker leaves it out. It says later if a
 * specification is wrong. */
static void check_map(struct options *o)
{
    const struct job *j = &o->job;
    char err[ERR_BYTES];
    struct spec s;
    if (j->what != JOB_GRIDS) die(ST_USAGE, "-m: expected grids, whose title says where they are");
    o->transparent = j->starter;
    for (size_t i = j->subjects; i < j->n; i++) {
        if (spec_load(j->path[i], &s, err) != 0) continue;
        o->transparent = o->transparent || s.backed;
        spec_free(&s);
    }
}

static void check_one(const struct options *o, size_t pictures)
{
    if (o->one && pictures > 1)
        die(ST_USAGE, "%zu pictures, expected -o with %%d in the name", pictures);
}

/* Copies standard input. */
static void keep_input(const struct options *o)
{
    unsigned char first[JOB_FIRST];
    char err[ERR_BYTES];
    uint64_t size;
    struct buf b = {0};
    struct outfile to;
    ptrdiff_t n;
    if (outfile_open(&to, o->kept) != 0) die(ST_SYSTEM, "%s:", o->kept);
    while ((n = read_some(STDIN_FILENO, &b, 1 << 16)) > 0) {
        if (fwrite(buf_data(&b), 1, buf_size(&b), to.f) != buf_size(&b))
            die(ST_SYSTEM, "%s:", o->kept);
        buf_consume(&b, buf_size(&b));
    }
    if (n < 0) die(ST_SYSTEM, "standard input:");
    if (outfile_commit(&to) != 0) die(ST_SYSTEM, "%s:", o->kept);
    buf_free(&b);
    size_t had = job_first(o->kept, first, &size);
    if (job_is_grid(first, had)) die(ST_USAGE, "standard input: is a grid, expected it as a file");
    if (!job_readable(first, had, size, err)) die(ST_USAGE, "standard input: %s", err);
}

/* What the worker reads as standard input. */
static int keep(const struct options *o)
{
    const struct job *j = &o->job;
    const bool input = strcmp(*j->path, "-") == 0;
    struct buf starter = {0};
    if ((input || j->starter) && !o->kept)
        die(ST_USAGE, "-i: expected -k FILE with it, for %s",
            input ? "standard input" : "a grid alone");
    for (size_t i = 0; i < j->n; i++) input_add(j->path[i], "an input");
    if (input) keep_input(o);
    if (j->starter) {
        put_starter(o, &starter);
        if (outfile_put(o->kept, buf_data(&starter), buf_size(&starter)) != 0)
            die(ST_SYSTEM, "%s:", o->kept);
        buf_free(&starter);
    }
    int fd = open(input ? o->kept : "/dev/null", O_RDONLY | O_CLOEXEC);
    if (fd < 0) die(ST_SYSTEM, "%s:", o->kept);
    return fd;
}

/* The next line of text, or NULL. */
static char *next_line(char **text)
{
    char *line = *text, *end = strchr(line, '\n');
    if (!*line) return NULL;
    *text = end ? end + 1 : line + strlen(line);
    if (end) *end = '\0';
    return line;
}

/* Takes frames and inputs, and prints other lines; the usage is left out, because the user of -W
 * does not call the worker. Returns the number of lines printed. */
static int take_lines(struct job_frames *f, struct buf *inputs, struct buf *said)
{
    int others = 0;
    buf_append(said, "", 1);
    for (char *text = (char *)said->data, *line; (line = next_line(&text)) != NULL;) {
        if (job_frames_take(f, line)) continue;
        if (strncmp(line, "input ", 6) == 0) {
            buf_printf(inputs, "%s\n", line);
            continue;
        }
        if (strncmp(line, "usage:", 6) == 0) break; /* the rest is usage as well */
        relay_line(line);
        others++;
    }
    return others;
}

/* The words of a command: the worker, `first` ones, and these files; NULL. The caller frees the
 * array. The views or specifications follow scene or grid `at`. */
static char **command(const struct options *o, char *const first[], size_t n_first, size_t at)
{
    static char end[] = "--";
    const struct job *j = &o->job;
    size_t n = 0;
    char **words = xcalloc(n_first + j->n + 4, sizeof *words);
    words[n++] = o->program;
    for (size_t i = 0; i < n_first; i++) words[n++] = first[i];
    words[n++] = end;
    words[n++] = j->path[at];
    for (size_t i = job_foreign(j) ? 1 : j->subjects; i < j->n; i++) words[n++] = j->path[i];
    if (j->starter) words[n++] = o->kept;
    return words;
}

/* Asks the worker for the frames of scene or grid `at`; of a foreign scene, for all. */
static void ask(struct options *o, int in, size_t at, struct job_frames *f)
{
    static char inspect[] = "-i", transparent[] = "-t", size[] = "-s";
    char **first = xcalloc(o->n_words + 4, sizeof *first);
    size_t n = 0;
    struct buf said = {0};
    first[n++] = inspect;
    if (o->transparent) first[n++] = transparent;
    for (size_t i = 0; i < o->n_words; i++) first[n++] = o->words[i];
    if (o->size) first[n++] = size, first[n++] = o->size;
    char **words = command(o, first, n, at);
    int status = child_run(words, in, -1, &said);
    if (status < 0) die(ST_SYSTEM, "%s:", o->program);
    if (status == 127 && !buf_size(&said))
        die(ST_USAGE,
            "%s is not there, expected it beside job or on the PATH: built by make, or "
            "installed",
            o->program);
    const uint32_t before = f->n;
    int others = take_lines(f, &o->inputs, &said);
    if (status && !others) warn("-W %s: expected options of %s", o->worker, o->program);
    if (status) exit(status == ST_SYSTEM ? ST_SYSTEM : ST_USAGE);
    if (f->n == before)
        die(ST_USAGE, "-W %s: expected options that change the picture or its transfer", o->worker);
    buf_free(&said);
    free(first);
    free(words);
}

/* A list has a name in each line. */
static void print_input(const char *name)
{
    char shown[ERR_PATH];
    if (strchr(name, '\n'))
        die(ST_USAGE, "%s: has a line end in its name, expected none", err_path(shown, name));
    printf("input %s\n", name);
}

static void print_inputs(struct options *o)
{
    char name[4096];
    put_stdout_buf(&o->inputs);
    for (size_t i = 0; i < o->job.n && !job_foreign(&o->job); i++)
        if (strcmp(o->job.path[i], "-") != 0) print_input(o->job.path[i]);
        else {
            ssize_t n = readlink("/proc/self/fd/0", name, sizeof name - 1);
            name[n < 0 ? 0 : n] = '\0';
            print_input(name);
        }
}

static void inspect(struct options *o)
{
    const struct job *j = &o->job;
    struct job_frames f = {.n = 0};
    if (o->map) check_map(o);
    check_one(o, job_states(j));
    int in = keep(o);
    for (size_t at = 0; at < j->subjects || !at; at++) ask(o, in, at, &f);
    check_one(o, f.n);
    printf("worker %s%s\nstates %zu\n", o->program, o->transparent ? " -t" : "", job_states(j));
    put_stdout_buf(&f.text);
    print_inputs(o);
    buf_free(&f.text);
    buf_free(&o->inputs);
    close(in);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (o.inspect) inspect(&o);
    else if (job_foreign(&o.job)) write_files(&o.job);
    else write_pairs(&o);
    free(o.program);
    free(o.words);
    close_stdout();
    return ST_OK;
}
