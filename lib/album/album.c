/* Pictures in a table of views and times: see album.h. */
#include "album/album.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_joint(char c) { return c && strchr("-_. /", c); }

/* Bytes of the directory, with its slash, that all paths have in common. */
static size_t common_directory(char *const *paths, size_t n)
{
    const char *slash = strrchr(paths[0], '/');
    size_t most = slash ? (size_t)(slash - paths[0]) + 1 : 0;
    for (size_t i = 1; i < n; i++) {
        size_t same = 0;
        while (same < most && paths[i][same] == paths[0][same]) same++;
        while (same > 0 && paths[0][same - 1] != '/') same--;
        most = same;
    }
    return most;
}

/* Appends s to the view, without what joins words at its ends, and a minus sign between. */
static void add_part(struct buf *view, const char *s, const char *end)
{
    while (s < end && is_joint(*s)) s++;
    while (s < end && is_joint(end[-1])) end--;
    if (s == end) return;
    if (buf_size(view)) buf_append(view, "-", 1);
    buf_append(view, s, (size_t)(end - s));
}

/* name: a path without the directory that all have. */
static void split_name(struct album_picture *p, const char *name)
{
    enum image_format format;
    const char *slash = strrchr(name, '/'), *base = slash ? slash + 1 : name;
    const char *end = name + strlen(name);
    if (image_format_of(name, &format)) end -= 4;
    const char *last = end, *first;
    while (last > base && !is_digit(last[-1])) last--;
    for (first = last; first > base && is_digit(first[-1]);) first--;
    struct buf view = {0}, time = {0};
    if (first < last) add_part(&view, name, first);
    add_part(&view, first < last ? last : name, end);
    buf_append(&view, "", 1);
    buf_append(&time, first, (size_t)(last - first));
    buf_append(&time, "", 1);
    p->view = xstrdup((const char *)buf_data(&view));
    p->time = xstrdup((const char *)buf_data(&time));
    buf_free(&view);
    buf_free(&time);
}

static int by_path(const void *a, const void *b)
{
    const struct album_picture *p = a, *q = b;
    return text_order(p->path, q->path);
}

static int by_time(const void *a, const void *b)
{
    const struct album_picture *p = a, *q = b;
    return text_order(p->time, q->time);
}

static int by_cell(const void *a, const void *b)
{
    const struct album_picture *p = a, *q = b;
    int order = text_order(p->view, q->view);
    if (!order) order = by_time(a, b);
    return order ? order : by_path(a, b);
}

static void take_paths(struct album *a, char *const *paths, size_t n)
{
    *a = (struct album){.pictures = xcalloc(n, sizeof *a->pictures), .n_pictures = n, .n_views = 1};
    for (size_t i = 0; i < n; i++) a->pictures[i].path = paths[i];
}

/* p: n pictures in order of cells; times: the different times in order. */
static bool table_full(const struct album_picture *p, size_t n, const struct album *a,
    const struct album_picture *times, char err[ERR_BYTES])
{
    for (size_t i = 1; i < n; i++)
        if (strcmp(p[i].view, p[i - 1].view) == 0 && by_time(p + i, p + i - 1) == 0)
            return err_set(err, "%s and %s: both show view \"%s\" at time \"%s\", expected one",
                p[i - 1].path, p[i].path, p[i].view, p[i].time);
    for (size_t i = 0; i < n; i += a->n_times)
        for (size_t k = 0; k < a->n_times; k++)
            if (i + k == n || strcmp(p[i + k].view, p[i].view) != 0 ||
                by_time(p + i + k, times + k) != 0)
                return err_set(err,
                    "no picture of view \"%s\" at time \"%s\", expected each of %zu views at each "
                    "of %zu times, or -v",
                    p[i].view, times[k].time, a->n_views, a->n_times);
    return true;
}

bool album_by_name(struct album *a, char *const *paths, size_t n, char err[ERR_BYTES])
{
    size_t common = common_directory(paths, n);
    take_paths(a, paths, n);
    for (size_t i = 0; i < n; i++) split_name(&a->pictures[i], paths[i] + common);
    struct album_picture *p = a->pictures, *times = xmalloc(n, sizeof *times);
    memcpy(times, p, n * sizeof *times);
    qsort(times, n, sizeof *times, by_time);
    a->n_times = 1;
    for (size_t i = 1; i < n; i++)
        if (by_time(times + i, times + a->n_times - 1) != 0) times[a->n_times++] = times[i];
    qsort(p, n, sizeof *p, by_cell);
    for (size_t i = 1; i < n; i++) a->n_views += strcmp(p[i].view, p[i - 1].view) != 0;
    bool full = table_full(p, n, a, times, err);
    free(times);
    return full;
}

/* The number of views that `views` says, and in *names the first of their names, or NULL. */
static size_t count_views(const char *views, const char **names)
{
    int64_t number;
    *names = parse_int(views, 0, INT32_MAX, &number) ? NULL : views;
    if (!*names) return (size_t)number;
    size_t n = 1;
    for (const char *s = views; *s; s++) n += *s == ',';
    return n;
}

bool album_in_turn(
    struct album *a, char *const *paths, size_t n, const char *views, char err[ERR_BYTES])
{
    const char *names;
    take_paths(a, paths, n);
    a->n_views = count_views(views, &names);
    if (a->n_views == 0 || a->n_views > n || n % a->n_views != 0)
        return err_set(err, "-v %s: %zu pictures, expected each of %zu views at each time", views,
            n, a->n_views);
    a->n_times = n / a->n_views;
    qsort(a->pictures, n, sizeof *a->pictures, by_path);
    struct album_picture *in = a->pictures, *out = xcalloc(n, sizeof *out);
    for (size_t v = 0; v < a->n_views; v++) {
        size_t length = names ? strcspn(names, ",") : 0;
        for (size_t t = 0; t < a->n_times; t++) {
            struct album_picture *p = out + v * a->n_times + t;
            struct buf view = {0}, time = {0};
            p->path = in[t * a->n_views + v].path;
            if (names) buf_append(&view, names, length);
            else buf_printf(&view, "%zu", v);
            buf_append(&view, "", 1);
            buf_printf(&time, "%zu", t);
            p->view = xstrdup((const char *)buf_data(&view));
            p->time = xstrdup((const char *)buf_data(&time));
            buf_free(&view);
            buf_free(&time);
        }
        if (names) names += length + 1;
    }
    a->pictures = out;
    free(in);
    return true;
}

bool album_name_times(struct album *a, char *const *names, size_t n, char err[ERR_BYTES])
{
    if (n != a->n_times)
        return err_set(
            err, "%zu grids and %zu times, expected a grid for each time", n, a->n_times);
    for (size_t i = 0; i < a->n_pictures; i++) {
        free(a->pictures[i].time);
        a->pictures[i].time = xstrdup(names[i % n]);
    }
    return true;
}

bool album_load(struct album *a, char err[ERR_BYTES])
{
    size_t left = ALBUM_BYTES_MAX;
    for (size_t i = 0; i < a->n_pictures; i++) {
        struct album_picture *p = a->pictures + i;
        char why[IMAGE_ERR];
        uint32_t w, h;
        if (image_load_png(p->path, left, &p->png, &w, &h, why) != 0)
            return err_set(err, "%s: %s", p->path, why);
        left -= buf_size(&p->png);
        if (i == 0) a->w = w, a->h = h;
        if (w != a->w || h != a->h)
            return err_set(err,
                "%s has %" PRIu32 "x%" PRIu32 " pixels, expected %" PRIu32 "x%" PRIu32 " as %s",
                p->path, w, h, a->w, a->h, a->pictures[0].path);
    }
    return true;
}

void album_free(struct album *a)
{
    for (size_t i = 0; i < a->n_pictures; i++) {
        free(a->pictures[i].view);
        free(a->pictures[i].time);
        buf_free(&a->pictures[i].png);
    }
    free(a->pictures);
}
