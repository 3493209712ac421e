/*
 * file: opens a file through libassimp, and finds all that the scene needs, before any is written.
 */
#include "mesh/mesh_int.h"

#include <assimp/cimport.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define BYTES_MAX UINT32_MAX /* of a file; libassimp's lengths have 32 bits */
#define EXTENT_MIN 1e-12     /* NFF's view needs some */
#define CORNERS_IN_ALL 0x7fffffffU

static bool too_large(char err[ERR_BYTES])
{
    return err_set(err, "larger than %u bytes, expected at most as many", (unsigned)BYTES_MAX);
}

/* The first line of libassimp's reason. */
static bool refused(char err[ERR_BYTES])
{
    const char *why = aiGetErrorString();
    int n = (int)strcspn(why, "\n");
    if (n && why[n - 1] == '.') n--;
    if (strstr(why, "OBJ-file is too small"))
        return err_set(err, "an OBJ without faces, expected one at least");
    if (strstr(why, "STL storage representation"))
        return err_set(err, "neither STL in text nor an STL whose length is that of its facets");
    const char *word = strstr(why, "parse string \"");
    if (word && (word[14] == '"' || word[14] == '?')) /* its ? is no printable character */
        return err_set(err, "ends too early, or lacks a number, expected a whole file");
    if (strstr(why, "BlendDNA"))
        return err_set(err, "of a Blender that libassimp does not read, expected glTF exported by "
                            "Blender; balance renders the file as it is");
    return err_set(err, "libassimp: %.*s, expected a mesh in one of its formats", n < 150 ? n : 150,
        n ? why : "no reason is given");
}

#define LINE_BYTES 64 /* of a line in the header of a PLY; what follows says no more */

/* Reads a line with text, without blanks before it; libassimp takes either line end. */
static bool next_line(FILE *f, char line[LINE_BYTES])
{
    size_t n = 0;
    int c = getc(f);
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n') c = getc(f);
    for (; c != EOF && c != '\r' && c != '\n'; c = getc(f))
        if (n + 1 < LINE_BYTES) line[n++] = (char)c;
    line[n] = '\0';
    return n > 0;
}

/* True of `element tristrips` with a count that is not 0. */
static bool declares_strips(const char *line)
{
    if (strncmp(line, "element", 7) != 0) return false;
    line += 7 + strspn(line + 7, " \t");
    if (strncmp(line, "tristrips", 9) != 0) return false;
    line += 9 + strspn(line + 9, " \t0");
    return *line >= '1' && *line <= '9';
}

/* True of a colour whose type libassimp takes for a share of its range, and not of 255. */
static bool is_bad_colour(const char *line, const char *name)
{
    static const char *const bad[] = {
        "char ", "int8 ", "short ", "int16 ", "int ", "int32 ", "uint ", "uint32 "};
    line += 8 + strspn(line + 8, " \t");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (strncmp(line, bad[i], strlen(bad[i])) == 0)
            return strcmp(name, " red") == 0 || strcmp(name, " r") == 0;
    return false;
}

/* Of the line that declares an element: it has some. */
static bool has_some(const char *line)
{
    const char *n = strrchr(line, ' ');
    return n && n[strspn(n, " 0")] != '\0';
}

/* Of the line that declares an element: libassimp does not know it, and would not find its end. */
static bool is_unknown(const char *line)
{
    static const char *const known[] = {
        "vertex ", "face ", "tristrips ", "edge ", "material ", "TextureFile "};
    line += 7 + strspn(line + 7, " \t");
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strncmp(line, known[i], strlen(known[i])) == 0) return false;
    return true;
}

/*
 * What libassimp cannot read: elements that it does not know before the faces, triangle strips, of
 * which it keeps the last triangle alone, and lists before the vertices. Notes colours that it
 * passes over or reads wrong, and edges.
 */
static const char *ply_fault(FILE *f, struct mesh *m)
{
    char line[LINE_BYTES];
    bool faces = false, any_faces = false, some = false, vertices = false;
    if (!next_line(f, line) || strncasecmp(line, "ply", 3) != 0) return NULL;
    while (next_line(f, line) && strncmp(line, "end_header", 10) != 0) {
        if (declares_strips(line)) return "element tristrips, expected element face";
        if (strncmp(line, "element", 7) == 0) {
            faces = strncmp(line, "element face", 12) == 0, some = has_some(line);
            if (some && !any_faces && is_unknown(line))
                return "an element before its faces that is neither vertex, edge nor material, "
                       "expected it behind them";
            any_faces |= faces;
            if (strncmp(line, "element edge ", 13) == 0)
                parse_int(line + 13, 0, UINT32_MAX, &m->lost_edges);
            vertices |= strncmp(line, "element vertex", 14) == 0;
        }
        if (some && !vertices && strncmp(line, "property list", 13) == 0)
            return "a list before its vertices, expected element vertex first";
        const char *name = strrchr(line, ' ');
        if (!name || strncmp(line, "property", 8) != 0) continue;
        m->lost_colours |=
            (faces && strcmp(name, " red") == 0) || strcmp(name, " diffuse_red") == 0;
        m->bad_colours |= !faces && is_bad_colour(line, name);
    }
    return NULL;
}

/* Counts the lines of an OBJ that stand for surfaces, which libassimp passes over. */
static void count_surfaces(struct mesh *m, FILE *f)
{
    static const char *const words[] = {"curv ", "surf ", "call "};
    char *line = NULL;
    size_t room = 0;
    const char *suffix = strrchr(m->path, '.');
    if (!suffix || strcasecmp(suffix, ".obj") == 0)
        while (getline(&line, &room, f) > 0)
            for (size_t i = 0; i < sizeof words / sizeof *words; i++)
                m->lost_surfaces += strncmp(line, words[i], 5) == 0;
    free(line);
}

/* UTF-16 and archives, which only some readers of libassimp take. */
static void find_wrapping(struct mesh *m, FILE *f)
{
    unsigned char b[4] = {0};
    const size_t n = fread(b, 1, sizeof b, f);
    const bool wide =
        (b[0] == 0xff && b[1] == 0xfe && !b[3]) || (b[0] == 0xfe && b[1] == 0xff && !b[2]);
    if (n == sizeof b && wide) m->wrapping = "text in UTF-16, expected UTF-8";
    if (n == sizeof b && memcmp(b, "PK\3\4", 4) == 0)
        m->wrapping = "a ZIP archive that libassimp does not read, expected the file in it";
}

/* Counts the cameras of an X3D, which libassimp passes over. */
static void count_viewpoints(struct mesh *m, FILE *f)
{
    char *part = NULL;
    size_t room = 0;
    const char *suffix = strrchr(m->path, '.');
    if (suffix && strcasecmp(suffix, ".x3d") == 0)
        while (getdelim(&part, &room, '<', f) > 0)
            m->viewpoints += strncmp(part, "Viewpoint", 9) == 0;
    free(part);
}

/* Closes the file; NULL: it could not be opened. */
static bool is_readable(struct mesh *m, FILE *f, char err[ERR_BYTES])
{
    if (!f) return err_set(err, "%s", strerror(errno));
    char extension[ERR_WORD];
    const char *ply = ply_fault(f, m);
    rewind(f);
    mesh_gltf_read(m, f, extension);
    mesh_stl_find(m, f);
    rewind(f);
    m->lost_colours |= mesh_off_paints(f);
    rewind(f);
    count_viewpoints(m, f);
    rewind(f);
    count_surfaces(m, f);
    rewind(f);
    find_wrapping(m, f);
    fclose(f);
    if (*extension)
        return err_set(
            err, "requires %s, which libassimp does not read, expected a glTF without", extension);
    return !ply || err_set(err, "PLY with %s", ply);
}

/* The suffix of a format that libassimp does not tell by its content; "": none of these. */
static const char *hint(const struct mesh *m, const unsigned char *data, size_t n)
{
    size_t lead = 0; /* of OFF: what its corners have */
    while (lead < n && data[lead] && strchr("STCN4n", data[lead])) lead++;
    if (n - lead >= 3 && memcmp(data + lead, "OFF", 3) == 0) return "off";
    if (n >= 4 && memcmp(data, "glTF", 4) == 0) return "glb";
    return m->stl ? "stl" : "";
}

static bool import_bytes(const struct buf *b, struct mesh *m, char err[ERR_BYTES])
{
    size_t n = buf_size(b);
    if (!n) return err_set(err, "is empty, expected a mesh");
    if (n > BYTES_MAX) return too_large(err);
    if (!is_readable(m, fmemopen(b->data + b->off, n, "rb"), err)) return false;
    const unsigned char *data = buf_data(b);
    const size_t marked = mesh_bytes_marked(data, n);
    data += marked, n -= marked;
    char *mended = mesh_bytes_mended(m, data, &n);
    m->bytes = mended ? (const unsigned char *)mended : data;
    m->n_bytes = n;
    snprintf(m->name, sizeof m->name, "-.%s", hint(m, m->bytes, n));
    m->scene = mesh_import(m);
    m->bytes = NULL;
    free(mended);
    return m->scene || refused(err);
}

/* Whole: of a pipe the format can only be told by its content, and neighbours are not found. */
static bool import_stream(const char *path, struct mesh *m, char err[ERR_BYTES])
{
    struct buf b = {0};
    bool ok =
        read_file(path, &b) == 0 ? import_bytes(&b, m, err) : err_set(err, "%s", strerror(errno));
    buf_free(&b);
    return ok;
}

static bool import(const char *path, struct mesh *m, char err[ERR_BYTES])
{
    struct stat st;
    bool is_stdin = strcmp(path, "-") == 0;
    if (!is_stdin && stat(path, &st) != 0) return err_set(err, "%s", strerror(errno));
    if (is_stdin || !(S_ISREG(st.st_mode) || S_ISDIR(st.st_mode)))
        return import_stream(path, m, err);
    if (S_ISDIR(st.st_mode)) return err_set(err, "%s", strerror(EISDIR));
    if (!st.st_size) return err_set(err, "is empty, expected a mesh");
    if (st.st_size > (off_t)BYTES_MAX) return too_large(err);
    if (!is_readable(m, fopen(path, "rb"), err)) return false;
    m->scene = mesh_import(m);
    return m->scene || refused(err);
}

/* ---- the first pass over the faces ----------------------------------------------------------- */

struct extent {
    struct vec3 lo, hi;
    uint64_t faces, corners;
};

static void include(void *ctx, const struct mesh_face *face)
{
    struct extent *e = ctx;
    e->faces++;
    e->corners += face->n;
    for (uint32_t i = 0; i < face->n; i++) {
        struct vec3 v = face->v[i];
        e->lo = v3(fmin(e->lo.x, v.x), fmin(e->lo.y, v.y), fmin(e->lo.z, v.z));
        e->hi = v3(fmax(e->hi.x, v.x), fmax(e->hi.y, v.y), fmax(e->hi.z, v.z));
    }
}

static bool measure(struct mesh *m, char err[ERR_BYTES])
{
    struct extent e = {v3(HUGE_VAL, HUGE_VAL, HUGE_VAL), v3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL), 0, 0};
    mesh_faces_each(m, m->loss, include, &e);
    m->lo = e.lo, m->hi = e.hi;
    uint64_t points = m->loss[LOSS_POINTS].n, lines = m->loss[LOSS_LINES].n;
    for (unsigned i = 0; i < m->scene->mNumMeshes; i++)
        if (!m->scene->mMeshes[i]->mNumFaces) points += m->scene->mMeshes[i]->mNumVertices;
    if (!e.faces && m->wrapping) return err_set(err, "is %s", m->wrapping);
    if (!e.faces && m->lost_surfaces)
        return err_set(err, "has free-form curves and surfaces but no face with an area, expected "
                            "one: export them as polygons");
    if (!e.faces && points + lines)
        return err_set(err,
            "has %llu points and %llu lines but no face with an area, expected one: "
            "points and lines are not rendered",
            (unsigned long long)points, (unsigned long long)lines);
    if (!e.faces) return err_set(err, "has no usable face with an area, expected one at least");
    if (e.corners > CORNERS_IN_ALL)
        return err_set(err, "%llu corners of faces, expected at most %u",
            (unsigned long long)e.corners, CORNERS_IN_ALL);
    double extent = v3_len(v3_sub(e.hi, e.lo));
    return extent >= EXTENT_MIN ||
           err_set(err, "extends over %g, expected at least %g", extent, EXTENT_MIN);
}

/* libassimp goes on without what is not there, and only its log says so. */
static void note(const char *said, char *user)
{
    struct mesh *m = (void *)user;
    if (strstr(said, "Unable to locate material file")) m->lost_libraries++;
    if (strstr(said, "OBJ: failed to locate material")) m->lost_materials++;
    if (strstr(said, "index is out of range")) m->lost_vertex = true;
    if (strstr(said, "with more than 3 vertices")) m->lost_corners++;
    if (strstr(said, "in the header is incorrect")) m->lost_end = true; /* OFF */
    if (strstr(said, "unexpected EOF")) m->lost_end = true;             /* STL in text */
}

static bool import_noted(const char *path, struct mesh *m, char err[ERR_BYTES])
{
    const struct aiLogStream log = {note, (char *)m};
    aiAttachLogStream(&log);
    bool ok = import(path, m, err);
    aiDetachLogStream(&log);
    if (!ok && m->wrapping) return err_set(err, "is %s", m->wrapping);
    if (ok && m->lost_end) return err_set(err, "ends too early, expected a whole file");
    if (ok && m->lost_vertex)
        return err_set(err, "a face has a corner that is not there, expected all corners");
    return ok;
}

struct mesh *mesh_open(const char *path, const struct mesh_options *o, char err[ERR_BYTES])
{
    struct mesh *m = xcalloc(1, sizeof *m);
    m->o = *o;
    m->path = path;
    m->picture_room_px = MESH_PICTURES_PX_MAX;
    bool ok = import_noted(path, m, err);
    if (ok) mesh_losses_find(m);
    ok = ok && mesh_parts_find(m, err) && measure(m, err);
    if (ok) {
        mesh_find_far(m);
        mesh_materials_find(m);
        mesh_view_find(m);
        mesh_lights_find(m);
        return m;
    }
    mesh_close(m);
    return NULL;
}

void mesh_close(struct mesh *m)
{
    if (m->scene) aiReleaseImport(m->scene);
    mesh_textures_free(m);
    free(m->sets);
    free(m->parts);
    free(m->light_places);
    free(m->camera_places);
    free(m->materials);
    free(m->lights);
    free(m);
}

const char *mesh_turned(const struct mesh *m) { return m->turned; }
const struct mesh_loss *mesh_losses(const struct mesh *m) { return m->loss; }
