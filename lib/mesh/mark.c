/* mark: files through libassimp without what it does not read: the byte order mark that some
 * programs write first, and in an OBJ numbers such as .5, whose corner it leaves out, blanks before
 * a word, comments behind numbers, and blanks behind the name of a material library, quotes around
 * it, or a second name. */
#include "mesh/mesh_int.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

/* ---- lines of an OBJ ------------------------------------------------------------------------- */

/* True of the point of a number such as .5, in a line that begins with v. */
static bool is_bare(const char *line, size_t i)
{
    return *line == 'v' && i > 1 && line[i] == '.' && (line[i - 1] == ' ' || line[i - 1] == '\t') &&
           line[i + 1] >= '0' && line[i + 1] <= '9';
}

/* The bytes of a line that libassimp reads: without blanks before the words below, a comment behind
 * numbers, or blanks behind the name of a material library. The line's end follows them. */
struct span {
    size_t from, to, end;
    bool mtllib; /* the line names files of materials */
};

static struct span span_of(const char *line, size_t n)
{
    static const struct {
        const char *word;
        bool numbers;
    } words[] = {
        {"v", true}, {"vn", true}, {"vt", true}, {"f", true}, {"usemtl", false}, {"mtllib", false}};
    struct span s = {0, n, n, false};
    const size_t lead = strspn(line, " \t"), word = strcspn(line + lead, " \t\r\n");
    while (s.end > 0 && (line[s.end - 1] == '\n' || line[s.end - 1] == '\r')) s.end--;
    s.to = s.end;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (word != strlen(words[i].word) || memcmp(line + lead, words[i].word, word) != 0)
            continue;
        const char *comment = words[i].numbers ? memchr(line, '#', s.end) : NULL;
        s.from = lead;
        s.mtllib = strcmp(words[i].word, "mtllib") == 0;
        if (comment) s.to = (size_t)(comment - line);
        while (!words[i].numbers && strchr(" \t", line[s.to - 1])) s.to--;
    }
    return s;
}

/* True of the blank between two names of libraries. A name may have blanks itself. */
static bool parts_names(const char *line, size_t i, const struct span *s)
{
    if (!s->mtllib || i < s->from + sizeof "mtllib x.mtl" - 1 || !strchr(" \t", line[i]))
        return false;
    return strncasecmp(line + i - 4 - (line[i - 1] == '"'), ".mtl", 4) == 0;
}

/* What has to stand before byte i of a span; NULL: nothing. */
static const char *before(const char *line, size_t i, const struct span *s)
{
    if (is_bare(line + s->from, i - s->from)) return "0";
    return parts_names(line, i, s) ? "\nmtllib" : NULL;
}

static bool is_quote(const char *line, size_t i, const struct span *s)
{
    return s->mtllib && line[i] == '"';
}

static bool is_odd(const char *line, size_t n)
{
    const struct span s = span_of(line, n);
    bool odd = s.from > 0 || s.to < s.end;
    for (size_t i = s.from; i < s.to; i++)
        odd = odd || before(line, i, &s) || is_quote(line, i, &s);
    return odd;
}

bool mesh_odd_lines(FILE *f)
{
    char *line = NULL;
    size_t room = 0;
    ptrdiff_t n;
    bool found = false;
    while (!found && (n = getline(&line, &room, f)) > 0 && !memchr(line, '\0', (size_t)n))
        found = is_odd(line, (size_t)n);
    free(line);
    return found;
}

/* Copies all that is left, with such lines mended. */
static void copy_mended(FILE *from, FILE *to)
{
    char *line = NULL;
    size_t room = 0;
    ptrdiff_t n;
    while ((n = getline(&line, &room, from)) > 0) {
        const struct span s = span_of(line, (size_t)n);
        for (size_t i = s.from; i < s.to; i++) {
            const char *more = before(line, i, &s);
            if (more) fputs(more, to);
            if (!is_quote(line, i, &s)) putc(line[i], to);
        }
        fwrite(line + s.end, 1, (size_t)n - s.end, to);
    }
    free(line);
}

char *mesh_lines_mended(const unsigned char *data, size_t *n)
{
    char *copy = NULL;
    FILE *from = fmemopen((void *)(uintptr_t)data, *n, "rb"), *to = open_memstream(&copy, n);
    if (!from || !to) die(ST_SYSTEM, "memory:");
    copy_mended(from, to);
    fclose(from);
    if (fclose(to) != 0) die(ST_SYSTEM, "memory:");
    return copy;
}

/* In the place of f, which is closed. */
static FILE *mended_file(FILE *f)
{
    FILE *copy = tmpfile();
    if (!copy) die(ST_SYSTEM, "a temporary file:");
    copy_mended(f, copy);
    fclose(f);
    if (fflush(copy) != 0) die(ST_SYSTEM, "a temporary file:");
    return copy;
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

/* In any case of letters. */
static FILE *open_named(const char *path)
{
    FILE *f = fopen(path, "rb");
    if (f) return f;
    char *there = mesh_any_case(path);
    f = there ? fopen(there, "rb") : NULL;
    free(there);
    return f;
}

static struct aiFile *open_source(struct aiFileIO *io, const char *path, const char *mode)
{
    (void)io;
    FILE *f = strchr(mode, 'w') ? NULL : open_named(path);
    if (!f) return NULL;
    struct source *s = xcalloc(1, sizeof *s);
    const bool odd = mesh_odd_lines(f);
    rewind(f);
    if (odd) f = mended_file(f);
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

const struct aiScene *mesh_import_mended(const char *path)
{
    struct aiFileIO io = {open_source, close_source, NULL};
    return aiImportFileEx(path, 0, &io);
}
