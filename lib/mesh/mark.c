/* mark: files through libassimp without what it does not read: the byte order mark that some
 * programs write first; in an OBJ numbers such as .5, whose corner it leaves out, blanks before
 * a word, comments behind numbers, blanks behind the name of a material library, quotes around
 * it, a second name, or a use before it, vertices with an alpha, or with a colour behind others
 * without; lines of an MTL (mtl.c); comments in an OFF; capitals in an STL in text;
 * a byte 10 that the numbers of a PLY begin with, which it takes for a second end of the line. */
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

/* ---- lines ----------------------------------------------------------------------------------- */

/* True of the point of a number such as .5, in a line that begins with v. */
static bool is_bare(const char *line, size_t i)
{
    return *line == 'v' && i > 1 && line[i] == '.' && (line[i - 1] == ' ' || line[i - 1] == '\t') &&
           line[i + 1] >= '0' && line[i + 1] <= '9';
}

/* What the lines of a file so far say of all. */
struct lines {
    bool begun, off, ply, stl; /* there was a word; the first one is that of an OFF, PLY or STL */
    bool plain, coloured;      /* OBJ: there are vertices without a colour, and with one */
    bool uses, late;           /* OBJ: there is a usemtl, and before a mtllib */
};

static size_t words_of(const char *line, size_t n)
{
    size_t at = 0, words = 0;
    for (; at < n && line[at] != '#'; words++) {
        while (at < n && strchr(" \t\r\n", line[at])) at++;
        if (at == n || line[at] == '#') break;
        while (at < n && !strchr(" \t\r\n#", line[at])) at++;
    }
    return words;
}

static void note_line(struct lines *l, const char *line, size_t n)
{
    const char *word = line + mesh_bytes_marked((const unsigned char *)line, n);
    word += strspn(word, " \t\r\n");
    if (!l->begun && *word && *word != '#') {
        l->begun = true;
        l->off = strncmp(word + strspn(word, "STCN4n"), "OFF", 3) == 0;
        l->ply = strncasecmp(word, "ply", 3) == 0;
        l->stl = strncasecmp(word, "solid", 5) == 0;
    }
    l->late |= l->uses && strncmp(word, "mtllib", 6) == 0;
    l->uses |= strncmp(word, "usemtl", 6) == 0;
    if (*word != 'v' || !strchr(" \t", word[1])) return;
    const size_t words = words_of(line, n);
    l->plain |= words == 4;
    l->coloured |= words == 7 || words == 8;
}

/* The bytes of a line that libassimp reads: without blanks before the words below, a comment behind
 * numbers, or blanks behind the name of a material library. The line's end follows them. */
struct span {
    size_t from, to, end;
    char lead[MESH_LEAD]; /* stands before them, in the place of others; "": nothing */
    bool lower;           /* an STL in capitals */
    bool mtllib;          /* the line names files of materials */
    bool white;           /* the vertex needs a colour, because others have one */
};

/* The end of the seventh word of a line; n: it has no more than seven. */
static size_t behind_seven(const char *line, size_t n)
{
    size_t at = 0;
    for (int i = 0; i < 7 && at < n; i++) {
        while (at < n && strchr(" \t", line[at])) at++;
        while (at < n && !strchr(" \t\r\n#", line[at])) at++;
    }
    return at;
}

static struct span span_of(const char *line, size_t n, const struct lines *l)
{
    static const struct {
        const char *word;
        bool numbers;
    } words[] = {{"v", true}, {"vn", true}, {"vt", true}, {"f", true}, {"usemtl", false},
        {"mtllib", false}, {"newmtl", false}};
    struct span s = {.to = n, .end = n};
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
        s.white = i == 0 && l->plain && l->coloured && words_of(line, n) == 4;
        if (i == 0 && words_of(line, n) == 8) s.to = behind_seven(line, s.to); /* its alpha */
    }
    const size_t from = mesh_mtl_line(line, lead, word, s.lead);
    if (from) s.from = from;
    s.lower = l->stl && word && line[lead] >= 'A' && line[lead] <= 'Z';
    const char *comment = l->off ? memchr(line, '#', s.end) : NULL;
    if (comment) s.to = (size_t)(comment - line);
    if (comment && !words_of(line, n)) s.to = 0, s.end = n; /* libassimp counts such lines */
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

static bool is_odd(const char *line, size_t n, const struct lines *l)
{
    const struct span s = span_of(line, n, l);
    bool odd = s.from > 0 || s.to < s.end || s.white || s.lower;
    for (size_t i = s.from; i < s.to; i++)
        odd = odd || before(line, i, &s) || is_quote(line, i, &s);
    return odd;
}

/* True of the last line before the numbers of a PLY. */
static bool ends_header(const struct lines *l, const char *line)
{
    return l->ply && strncmp(line, "end_header", 10) == 0;
}

/* Has a file lines that are mended? */
static bool has_odd(FILE *f)
{
    char *line = NULL;
    size_t room = 0;
    ptrdiff_t n;
    bool found = false;
    struct lines l = {.begun = false};
    while (!found && (n = getline(&line, &room, f)) > 0 && !memchr(line, '\0', (size_t)n)) {
        note_line(&l, line, (size_t)n);
        if (ends_header(&l, line)) {
            found = getc(f) == '\n';
            break;
        }
        found = (l.plain && l.coloured) || l.late || is_odd(line, (size_t)n, &l);
    }
    free(line);
    return found;
}

/* Copies the rest of a PLY. The header ends in \r\n, which libassimp takes for one line end. */
static void copy_numbers(FILE *from, FILE *to)
{
    char part[BUFSIZ];
    size_t n;
    fputs("end_header\r\n", to);
    while ((n = fread(part, 1, sizeof part, from)) > 0) fwrite(part, 1, n, to);
}

static int lower(char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; }

/* Writes a line without what libassimp reads wrong. */
static void write_line(const char *line, size_t n, const struct lines *l, FILE *to)
{
    const struct span s = span_of(line, n, l);
    fputs(s.lead, to);
    for (size_t i = s.from; i < s.to; i++) {
        const char *more = before(line, i, &s);
        if (more) fputs(more, to);
        if (!is_quote(line, i, &s)) putc(s.lower ? lower(line[i]) : line[i], to);
    }
    if (s.white) fputs(" nan nan nan", to);
    fwrite(line + s.end, 1, n - s.end, to);
}

/* Copies a file with such lines mended. Libraries that an OBJ names behind a use come first. */
static void copy_mended(FILE *from, FILE *to)
{
    char *line = NULL;
    size_t room = 0;
    ptrdiff_t n;
    struct lines l = {.begun = false};
    while ((n = getline(&line, &room, from)) > 0 && !l.ply) note_line(&l, line, (size_t)n);
    rewind(from);
    while (l.late && (n = getline(&line, &room, from)) > 0)
        if (span_of(line, (size_t)n, &l).mtllib) write_line(line, (size_t)n, &l, to);
    rewind(from);
    while ((n = getline(&line, &room, from)) > 0) {
        if (ends_header(&l, line)) {
            copy_numbers(from, to);
            break;
        }
        write_line(line, (size_t)n, &l, to);
    }
    free(line);
}

typedef void mender(FILE *from, FILE *to);

/* What copies the file without what libassimp reads wrong; NULL: nothing has to. */
static mender *mender_of(const struct mesh *m, FILE *f)
{
    char first[4];
    rewind(f);
    if (m->stl) return m->stl == MESH_STL_ODD ? mesh_stl_copy : NULL;
    const size_t n = fread(first, 1, sizeof first, f);
    if (m->skins && (memchr(first, '{', n) || (n == 4 && memcmp(first, "glTF", 4) == 0)))
        return mesh_gltf_copy;
    rewind(f);
    return has_odd(f) ? copy_mended : NULL;
}

char *mesh_bytes_mended(const struct mesh *m, const unsigned char *data, size_t *n)
{
    char *copy = NULL;
    FILE *from = *n ? fmemopen((void *)(uintptr_t)data, *n, "rb") : NULL;
    if (*n && !from) die(ST_SYSTEM, "memory:");
    mender *copy_to = from ? mender_of(m, from) : NULL;
    if (copy_to) {
        rewind(from);
        FILE *to = open_memstream(&copy, n);
        if (!to) die(ST_SYSTEM, "memory:");
        copy_to(from, to);
        if (fclose(to) != 0) die(ST_SYSTEM, "memory:");
    }
    if (from) fclose(from);
    return copy;
}

/* In the place of f, which is closed. */
static FILE *mended_file(FILE *f, mender *copy_to)
{
    FILE *copy = tmpfile();
    if (!copy) die(ST_SYSTEM, "a temporary file:");
    copy_to(f, copy);
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

static FILE *open_named(const char *path)
{
    FILE *f = fopen(path, "rb");
    if (f) return f;
    char *there = mesh_neighbour(path);
    f = there ? fopen(there, "rb") : NULL;
    free(there);
    return f;
}

/* What libassimp asks for by the name that it was given for bytes. */
static bool is_bytes(const struct mesh *m, const char *path)
{
    return m->bytes && strcmp(path, m->name) == 0;
}

static struct aiFile *open_source(struct aiFileIO *io, const char *path, const char *mode)
{
    const struct mesh *m = (const void *)io->UserData;
    const bool whole = is_bytes(m, path);
    FILE *f = NULL;
    if (whole) f = fmemopen((void *)(uintptr_t)m->bytes, m->n_bytes, "rb");
    else if (!strchr(mode, 'w')) f = open_named(path);
    if (!f) return NULL;
    struct source *s = xcalloc(1, sizeof *s);
    mender *copy_to = whole ? NULL : mender_of(m, f); /* bytes are mended already, once */
    rewind(f);
    if (copy_to) f = mended_file(f, copy_to);
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

const struct aiScene *mesh_import(const struct mesh *m)
{
    struct aiFileIO io = {open_source, close_source, (void *)(uintptr_t)m};
    return aiImportFileEx(m->bytes ? m->name : m->path, 0, &io);
}
