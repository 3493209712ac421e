/* What files are together: a scene; grids and specifications; a scene of POV-Ray. */
#include "job/job.h"
#include "grid/grid.h"
#include "spec/spec.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static bool is_pov(const char *path)
{
    const size_t n = strlen(path);
    return n >= 4 && strcasecmp(path + n - 4, ".pov") == 0;
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

/* Says whether it is a grid. */
static bool look(const char *path, bool *grid, char err[ERR_BYTES])
{
    unsigned char first[JOB_FIRST];
    uint64_t size;
    char why[ERR_BYTES], shown[ERR_PATH];
    const size_t n = job_first(path, first, &size);
    *grid = job_is_grid(first, n);
    return job_readable(first, n, size, why) || err_set(err, "%s: %s", err_path(shown, path), why);
}

/* POV-Ray takes +WORD and NAME=VALUE for its own. The name stays in memory to the end. */
static void plain_name(char **path)
{
    if (**path == '/' || (**path != '+' && !strchr(*path, '='))) return;
    struct buf b = {0};
    buf_printf(&b, "./%s", *path);
    buf_append(&b, "", 1);
    *path = (char *)b.data;
}

bool job_of(struct job *j, char **path, size_t n, char err[ERR_BYTES])
{
    char shown[ERR_PATH];
    *j = (struct job){.path = path, .n = n};
    for (size_t i = 0; i < n; i++)
        if (!check_file(j, path[i], err)) return false;
    if (is_pov(*path)) {
        j->what = JOB_POV;
        plain_name(path);
        return true;
    }
    if (strcmp(*path, "-") == 0) return true;
    bool grids = true;
    for (size_t i = 0; i < n; i++) {
        bool grid;
        if (!look(path[i], &grid, err)) return false;
        grids = grids && grid;
        j->grids += grids;
    }
    if (n == 1 && !j->grids) return true;
    j->what = JOB_GRIDS;
    j->starter = n == 1;
    if (j->grids == n && n > 1)
        return err_set(err, "%s: is a grid, expected a specification after the grids",
            err_path(shown, path[n - 1]));
    if (!j->grids) j->grids = 1; /* the worker says what is wrong with it */
    return true;
}

const char *job_worker(const struct job *j)
{
    static const char *const name[] = {
        [JOB_SCENE] = "rtworker", [JOB_GRIDS] = "vcworker", [JOB_POV] = "povworker"};
    return name[j->what];
}

static size_t specs(const struct job *j) { return j->starter ? 1 : j->n - j->grids; }

size_t job_states(const struct job *j) { return j->what == JOB_GRIDS ? j->grids * specs(j) : 1; }

struct job_state job_state(const struct job *j, size_t at)
{
    const size_t grid = at / specs(j), spec = at % specs(j);
    /* A specification stays valid for the grids that follow. */
    return (struct job_state){grid, j->grids + spec, spec == 0, grid == 0 || specs(j) > 1};
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
