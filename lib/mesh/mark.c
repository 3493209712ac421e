/* mark: files through libassimp without the byte order mark that some programs write first. */
#include "mesh/mesh_int.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <stdlib.h>
#include <string.h>

#define MARK 3 /* bytes */

size_t mesh_bytes_marked(const unsigned char *data, size_t n)
{
    return n >= MARK && memcmp(data, "\357\273\277", MARK) == 0 ? MARK : 0;
}

/* Stays behind the mark, or at the beginning. */
static size_t pass_mark(FILE *f)
{
    unsigned char first[MARK];
    const size_t marked = mesh_bytes_marked(first, fread(first, 1, MARK, f));
    if (!marked) rewind(f);
    return marked;
}

bool mesh_file_marked(const char *path)
{
    FILE *f = fopen(path, "rb");
    const bool marked = f && pass_mark(f);
    if (f) fclose(f);
    return marked;
}

/* ---- files as libassimp asks for them -------------------------------------------------------- */

struct source {
    struct aiFile file;
    FILE *f;
    size_t mark, size; /* bytes */
};
static struct source *of(struct aiFile *file) { return (void *)file->UserData; }

static size_t take(struct aiFile *file, char *to, size_t size, size_t n)
{
    return fread(to, size, n, of(file)->f);
}
static size_t refuse(struct aiFile *file, const char *from, size_t size, size_t n)
{
    (void)file, (void)from, (void)size, (void)n;
    return 0;
}
static size_t tell(struct aiFile *file) { return (size_t)ftell(of(file)->f) - of(file)->mark; }
static size_t size_of(struct aiFile *file) { return of(file)->size; }
static void flush(struct aiFile *file) { (void)file; }

static enum aiReturn seek(struct aiFile *file, size_t at, enum aiOrigin from)
{
    const struct source *s = of(file);
    if (from == aiOrigin_CUR) at += tell(file);
    if (from == aiOrigin_END) at = s->size - at;
    const bool ok = at <= s->size && fseek(s->f, (long)(at + s->mark), SEEK_SET) == 0;
    return ok ? aiReturn_SUCCESS : aiReturn_FAILURE;
}

static struct aiFile *open_source(struct aiFileIO *io, const char *path, const char *mode)
{
    (void)io;
    FILE *f = strchr(mode, 'w') ? NULL : fopen(path, "rb");
    if (!f) return NULL;
    struct source *s = xcalloc(1, sizeof *s);
    const long end = fseek(f, 0, SEEK_END) == 0 ? ftell(f) : 0;
    rewind(f);
    s->f = f;
    s->mark = pass_mark(f);
    s->size = (size_t)(end < 0 ? 0 : end) - s->mark;
    s->file = (struct aiFile){take, refuse, tell, size_of, seek, flush, (void *)s};
    return &s->file;
}

static void close_source(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    struct source *s = of(file);
    fclose(s->f);
    free(s);
}

const struct aiScene *mesh_import_unmarked(const char *path)
{
    struct aiFileIO io = {open_source, close_source, NULL};
    return aiImportFileEx(path, 0, &io);
}
