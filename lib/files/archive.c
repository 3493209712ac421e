/* archive: packs and unpacks through libarchive. */
#include "files/files.h"

#include <archive.h>
#include <archive_entry.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BLOCK 65536

/* ---- packing -------------------------------------------------------------------------------- */

/* libarchive's message, or that of the system. */
static bool fail(char err[ERR_BYTES], const char *name, struct archive *a)
{
    const char *why = archive_error_string(a);
    return err_set(err, "%s: %s", name, why ? why : "libarchive failed");
}

/* Appends the parts of a path without "." and empty ones, each with '/' in front; the first without
 * it if the path is relative. */
static void plain_path(struct buf *to, const char *path)
{
    bool slash = *path == '/';
    for (size_t n; *path; path += n) {
        n = strcspn(path, "/");
        if (n && !(n == 1 && *path == '.')) {
            if (slash) buf_append(to, "/", 1);
            buf_append(to, path, n);
            slash = true;
        }
        n += path[n] == '/';
    }
    buf_append(to, "", 1);
}

static ptrdiff_t take_bytes(struct archive *a, void *ctx, const void *p, size_t n)
{
    (void)a;
    buf_append(ctx, p, n);
    return (ptrdiff_t)n;
}

static bool put_file(struct archive *a, const char *path, const char *name, char err[ERR_BYTES])
{
    struct buf bytes = {0};
    struct stat st;
    if (stat(path, &st) != 0) return err_set(err, "%s: %s", path, strerror(errno));
    if (!S_ISREG(st.st_mode)) return err_set(err, "%s: is no regular file, expected files", path);
    if (st.st_size > INT_MAX) /* libarchive takes no more at once */
        return err_set(
            err, "%s: %lld bytes, expected at most %d", path, (long long)st.st_size, INT_MAX);
    if (!load_file(path, &bytes, err)) return false;
    struct archive_entry *e = archive_entry_new();
    archive_entry_set_pathname(e, name);
    archive_entry_set_filetype(e, AE_IFREG);
    archive_entry_set_perm(e, st.st_mode & S_IXUSR ? 0755 : 0644);
    archive_entry_set_size(e, (la_int64_t)buf_size(&bytes));
    bool put =
        archive_write_header(a, e) == ARCHIVE_OK &&
        archive_write_data(a, buf_data(&bytes), buf_size(&bytes)) == (la_ssize_t)buf_size(&bytes);
    if (!put) fail(err, path, a);
    archive_entry_free(e);
    buf_free(&bytes);
    return put;
}

/* The path below this directory ("dir/" or ""), or NULL with text in err. */
static const char *below(const char *path, const char *directory, char err[ERR_BYTES])
{
    size_t n = strlen(directory);
    char why[ERR_BYTES] = "";
    if (strncmp(path, directory, n) == 0 && files_name_check(path + n, why)) return path + n;
    err_set(err, "%s: expected a file below %s, the directory of the first file%s%s", path,
        n ? directory : "./", *why ? "; " : "", why);
    return NULL;
}

/* Is one of the first n paths the same one? */
static bool has_path(char *const paths[], size_t n, const char *plain)
{
    struct buf other = {0};
    bool found = false;
    for (size_t i = 0; i < n && !found; i++) {
        other.off = other.len = 0;
        plain_path(&other, paths[i]);
        found = strcmp((const char *)other.data, plain) == 0;
    }
    buf_free(&other);
    return found;
}

bool files_pack(char *const paths[], size_t n, struct buf *archive, char err[ERR_BYTES])
{
    struct archive *a = archive_write_new();
    struct buf directory = {0}, path = {0};
    archive_write_set_format_pax_restricted(a);
    archive_write_set_bytes_per_block(a, 512);
    archive_write_set_bytes_in_last_block(a, 512);
    /* Names are bytes, whatever the locale. */
    archive_write_set_options(a, "hdrcharset=BINARY");
    bool good = archive_write_open(a, archive, NULL, take_bytes, NULL) == ARCHIVE_OK;
    if (!good) fail(err, "archive", a);
    plain_path(&directory, paths[0]);
    char *last = strrchr((char *)directory.data, '/');
    *(last ? last + 1 : (char *)directory.data) = '\0';
    for (size_t i = 0; i < n && good; i++) {
        path.off = path.len = 0;
        plain_path(&path, paths[i]);
        if (has_path(paths, i, (const char *)path.data)) continue;
        const char *name = below((const char *)path.data, (const char *)directory.data, err);
        good = name && put_file(a, paths[i], name, err);
    }
    if (good && archive_write_close(a) != ARCHIVE_OK) good = fail(err, "archive", a);
    archive_write_free(a);
    buf_free(&directory);
    buf_free(&path);
    return good;
}

/* ---- unpacking ------------------------------------------------------------------------------ */

/* Makes the directories of a checked name. */
static bool make_directories(char *path, size_t below_n, char err[ERR_BYTES])
{
    for (char *p = path + below_n; (p = strchr(p, '/')) != NULL; p++) {
        *p = '\0';
        bool made = mkdir(path, 0700) == 0 || errno == EEXIST;
        if (!made) err_set(err, "%s: %s", path, strerror(errno));
        *p = '/';
        if (!made) return false;
    }
    return true;
}

/* Writes the data of the current entry, at most `most` bytes. */
static bool write_data(
    struct archive *a, const char *path, mode_t mode, size_t *most, char err[ERR_BYTES])
{
    static unsigned char block[BLOCK];
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (fd < 0) return err_set(err, "%s: %s", path, strerror(errno));
    la_ssize_t n;
    bool good = true;
    while (good && (n = archive_read_data(a, block, sizeof block)) != 0) {
        if (n < 0) good = fail(err, "archive", a);
        else if ((size_t)n > *most)
            good = err_set(err, "archive: its files are longer than itself");
        else if (write_full(fd, block, (size_t)n) != 0)
            good = err_set(err, "%s: %s", path, strerror(errno));
        else *most -= (size_t)n;
    }
    if (close(fd) != 0 && good) good = err_set(err, "%s: %s", path, strerror(errno));
    return good;
}

/* Unpacks an entry. */
static bool take_entry(struct archive *a, struct archive_entry *e, const char *directory,
    size_t *most, char **first, char err[ERR_BYTES])
{
    const char *name = archive_entry_pathname(e);
    char path[PATH_MAX], shown[ERR_WORD];
    if (!name) return err_set(err, "archive: a file without a name");
    if (!files_name_check(name, err)) return false;
    if (archive_entry_filetype(e) != AE_IFREG || archive_entry_hardlink(e))
        return err_set(err, "archive: %s is no regular file", err_word(shown, name, strlen(name)));
    if (snprintf(path, sizeof path, "%s/%s", directory, name) >= (int)sizeof path)
        return err_set(err, "%s: the names in the archive are too long", directory);
    if (!make_directories(path, strlen(directory) + 1, err)) return false;
    mode_t mode = archive_entry_perm(e) & S_IXUSR ? 0700 : 0600;
    if (!write_data(a, path, mode, most, err)) return false;
    if (!*first) *first = xstrdup(name);
    return true;
}

bool files_unpack(const unsigned char *archive, size_t n, const char *directory, char **first,
    char err[ERR_BYTES])
{
    struct archive *a = archive_read_new();
    struct archive_entry *e;
    size_t most = n;
    int result = ARCHIVE_FATAL;
    bool good = true;
    *first = NULL;
    archive_read_support_format_tar(a);
    archive_read_set_options(a, "hdrcharset=BINARY");
    if (archive_read_open_memory(a, archive, n) != ARCHIVE_OK) good = fail(err, "archive", a);
    while (good && (result = archive_read_next_header(a, &e)) == ARCHIVE_OK)
        good = take_entry(a, e, directory, &most, first, err);
    if (good && result != ARCHIVE_EOF) good = fail(err, "archive", a);
    if (good && !*first) good = err_set(err, "archive: has no file, expected one at least");
    archive_read_free(a);
    if (!good) {
        free(*first);
        *first = NULL;
    }
    return good;
}
