/* What files are together: scenes and views; grids and specifications; a scene of POV-Ray or
 * Blender. */
#include "job/job.h"
#include "grid/grid.h"
#include "spec/spec.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static bool ends(const char *path, const char *end)
{
    const size_t n = strlen(path), n_end = strlen(end);
    return n >= n_end && strcasecmp(path + n - n_end, end) == 0;
}

/* What no file may be. */
static bool check_file(const struct job *j, const char *path, char err[ERR_BYTES])
{
    struct stat st;
    char shown[ERR_PATH];
    if (strcmp(path, "-") == 0)
        return j->n == 1 || err_set(err, "-: is one of %zu files, expected it alone", j->n);
    const bool there = stat(path, &st) == 0;
    if (!there && *path == '-')
        return err_set(
            err, "%s: no such file; options are before the files", err_path(shown, path));
    return !there || !S_ISFIFO(st.st_mode) ||
           err_set(err,
               "%s: is a pipe, which can be read only once, expected a file, or - for standard "
               "input",
               err_path(shown, path));
}

enum kind { GRID, VIEW, SCENE, OTHER }; /* a specification is VIEW or OTHER */

static bool look(const char *path, enum kind *kind, char err[ERR_BYTES])
{
    unsigned char first[JOB_FIRST];
    uint64_t size;
    char why[ERR_BYTES], shown[ERR_PATH];
    const size_t n = job_first(path, first, &size);
    *kind = job_is_grid(first, n)    ? GRID
            : job_is_view(first, n)  ? VIEW
            : job_is_scene(first, n) ? SCENE
                                     : OTHER;
    return job_readable(first, n, size, why) || err_set(err, "%s: %s", err_path(shown, path), why);
}

/* povworker takes +WORD and NAME=VALUE for its own, and blendworker NAME=VALUE. The name stays in
 * memory to the end. */
static void plain_name(char **path)
{
    if (**path == '/' || (**path != '+' && !strchr(*path, '='))) return;
    struct buf b = {0};
    buf_printf(&b, "./%s", *path);
    buf_append(&b, "", 1);
    *path = (char *)b.data;
}

/* Says what the files are by the kinds of those in front. */
static bool sort(struct job *j, char err[ERR_BYTES])
{
    char shown[ERR_PATH];
    size_t grids = 0, before = 0; /* the first view */
    enum kind kind = OTHER;
    for (size_t i = 0; i < j->n; i++) {
        if (!look(j->path[i], &kind, err)) return false;
        grids += kind == GRID && grids == i;
        before += kind != VIEW && before == i;
    }
    if (!before)
        return err_set(err,
            "%s: is a view or a specification, expected a scene or a grid before it",
            err_path(shown, *j->path));
    j->subjects = grids;
    if (!grids && (j->n == 1 || before < j->n)) {
        j->subjects = before;
        return true;
    }
    if (!grids && kind == SCENE)
        return err_set(err,
            "%s: begins with `v` as a scene does, expected a view or a specification: the lines "
            "behind `v`, without it",
            err_path(shown, j->path[j->n - 1]));
    j->what = JOB_GRIDS;
    j->starter = j->n == 1;
    if (grids == j->n && j->n > 1)
        return err_set(err, "%s: is a grid, expected a specification after the grids",
            err_path(shown, j->path[j->n - 1]));
    if (!grids) j->subjects = 1; /* the worker says what is wrong with it */
    return true;
}

bool job_of(struct job *j, char **path, size_t n, char err[ERR_BYTES])
{
    *j = (struct job){.path = path, .n = n};
    for (size_t i = 0; i < n; i++)
        if (!check_file(j, path[i], err)) return false;
    if (ends(*path, ".pov") || ends(*path, ".blend")) {
        j->what = ends(*path, ".pov") ? JOB_POV : JOB_BLEND;
        plain_name(path);
        return true;
    }
    if (strcmp(*path, "-") != 0) return sort(j, err);
    j->subjects = 1;
    return true;
}

const char *job_worker(const struct job *j)
{
    static const char *const name[] = {[JOB_SCENE] = "rtworker",
        [JOB_GRIDS] = "vcworker",
        [JOB_POV] = "povworker",
        [JOB_BLEND] = "blendworker"};
    return name[j->what];
}

bool job_foreign(const struct job *j) { return j->what == JOB_POV || j->what == JOB_BLEND; }

static size_t looks(const struct job *j)
{
    return j->n == j->subjects ? 1 : j->n - j->subjects; /* the starter, or the scene's view */
}

size_t job_states(const struct job *j) { return job_foreign(j) ? 1 : j->subjects * looks(j); }

struct job_state job_state(const struct job *j, size_t at)
{
    const size_t subject = at / looks(j), look = at % looks(j);
    const bool other = j->starter || j->n > j->subjects;
    /* A view or specification stays valid for the scenes or grids that follow. */
    return (struct job_state){
        subject, j->subjects + look, look == 0, other && (subject == 0 || looks(j) > 1)};
}

bool job_starter(const char *path, uint32_t w, uint32_t h, struct buf *out, char err[ERR_BYTES])
{
    struct grid g;
    char why[ERR_BYTES], shown[ERR_PATH];
    if (grid_load(path, &g, err) != 0) return false;
    struct spec_wish wish = SPEC_WISH_DEFAULT;
    if (w) wish.w = w, wish.h = h;
    bool good = spec_starter(&g, &wish, out, why);
    grid_free(&g);
    if (!good) return err_set(err, "%s: %s", err_path(shown, path), why);
    return true;
}
