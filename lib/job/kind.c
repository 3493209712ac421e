/* What a file is, by its first bytes. */
#include "job/job.h"

#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define TO_VTK "vol2vtk makes a grid of it"
#define TO_NFF "mesh2nff makes a scene of it"
#define BLENDER "of Blender export glTF, and mesh2nff makes a scene of it"

#define BOM "\357\273\277" /* the byte order mark of UTF-8 */

/* What it is, and what to do. */
struct foreign {
    const char *is, *remedy;
};
static const struct foreign obj = {"an OBJ mesh", TO_NFF}, stl = {"an STL mesh", TO_NFF},
                            vtk = {"a VTK XML file",
                                "vol2vtk makes a grid of an image or a rectilinear grid"},
                            collada = {"a Collada scene", TO_NFF},
                            xml = {"an XML file", "no program here reads it"};

static const struct row {
    const char *bytes;
    size_t n;
    struct foreign of;
} rows[] = {
#define BYTES(s) (s), sizeof(s) - 1
    {BYTES("CDF\1"), {"a NetCDF file", "nc2vtk makes a grid of a variable"}},
    {BYTES("CDF\2"), {"a NetCDF file", "nc2vtk makes a grid of a variable"}},
    {BYTES("CDF\5"), {"a NetCDF file", "nc2vtk makes a grid of a variable"}},
    {BYTES("\211HDF\r\n\032\n"), {"an HDF5 file", "nc2vtk makes a grid of a variable of NetCDF 4"}},
    {BYTES("GRIB"), {"a GRIB file", "grib2vtk makes a grid of a field"}},
    {BYTES("NRRD000"), {"a NRRD volume", TO_VTK}},
    {BYTES("\0\0\1\134"), {"a NIfTI volume", TO_VTK}},
    {BYTES("\134\1\0\0"), {"a NIfTI volume", TO_VTK}},
    {BYTES("ObjectType"), {"a MetaImage volume", TO_VTK}},
    {BYTES("NDims"), {"a MetaImage volume", TO_VTK}},
    {BYTES("\211PNG\r\n\032\n"), {"a PNG picture", "blend and album read pictures"}},
    {BYTES("glTF"), {"a glTF scene", TO_NFF}},
    {BYTES("{"), {"a JSON file", "if it is glTF, " TO_NFF}},
    {BYTES("ply\n"), {"a PLY mesh", TO_NFF}},
    {BYTES("ply\r"), {"a PLY mesh", TO_NFF}},
    {BYTES("BLENDER"), {"a file of Blender", BLENDER}},
    {BYTES("\037\213"), {"a file that gzip has packed",
                            "vol2vtk makes a grid of NIfTI; unpack others by gunzip; " BLENDER}},
    {BYTES("\050\265\057\375"), {"a file that zstd has packed", "unpack it by unzstd; " BLENDER}},
#undef BYTES
};

size_t job_first(const char *path, unsigned char first[JOB_FIRST], uint64_t *size)
{
    struct stat st;
    struct buf b = {0};
    *size = 0;
    int fd = input_open(path);
    if (fd < 0) return 0;
    if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode)) *size = (uint64_t)st.st_size;
    while (buf_size(&b) < JOB_FIRST && read_some(fd, &b, JOB_FIRST - buf_size(&b)) > 0) continue;
    if (fd != STDIN_FILENO) close(fd);
    const size_t n = buf_size(&b);
    if (n) memcpy(first, buf_data(&b), n);
    buf_free(&b);
    return n;
}

static bool begins(const unsigned char *p, size_t n, const char *bytes)
{
    return n >= strlen(bytes) && memcmp(p, bytes, strlen(bytes)) == 0;
}

bool job_is_grid(const unsigned char *first, size_t n)
{
    static const char head[] = "# vtk DataFile";
    return n >= sizeof head - 1 && strncasecmp((const char *)first, head, sizeof head - 1) == 0;
}

/* The text after blanks and comments, up to a line that has only been read in part. */
static size_t skip_comments(const unsigned char *p, size_t n)
{
    size_t at = 0;
    while (at < n) {
        if (p[at] == '#')
            while (at < n && p[at] != '\n') at++;
        else if (!strchr(" \t\r\n", p[at]) || !p[at]) break;
        else at++;
    }
    return at;
}

bool job_is_view(const unsigned char *first, size_t n)
{
    static const char *const words[] = {"from", "at", "up", "angle", "hither", "resolution"};
    const size_t bom = begins(first, n, BOM) ? sizeof BOM - 1 : 0;
    const size_t at = bom + skip_comments(first + bom, n - bom);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const size_t end = at + strlen(words[i]);
        if (begins(first + at, n - at, words[i]) && end < n && strchr(" \t\r\n#", first[end]))
            return first[end] != '\0';
    }
    return false;
}

bool job_is_scene(const unsigned char *first, size_t n)
{
    const size_t at = skip_comments(first, n);
    return at + 1 < n && first[at] == 'v' && strchr("\r\n", first[at + 1]) && first[at + 1];
}

/* OBJ has no magic number. Its first line names a library, an object or a group, or is a vertex
 * with its numbers; NFF's line `v` has a word behind it, or none. */
static bool is_obj(const unsigned char *p, size_t n)
{
    static const char *const words[] = {"mtllib ", "usemtl ", "o ", "vn ", "vt "};
    const size_t at = skip_comments(p, n);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (begins(p + at, n - at, words[i])) return true;
    if (!begins(p + at, n - at, "v ")) return false;
    size_t digit = at + 2;
    while (digit < n && p[digit] && strchr(" \t+-.", p[digit])) digit++;
    return digit < n && p[digit] >= '0' && p[digit] <= '9';
}

/* Binary: 80 bytes of any kind, the number of triangles, and 50 bytes for each. */
static bool is_stl(const unsigned char *p, size_t n, uint64_t size)
{
    if (begins(p, n, "solid ") || begins(p, n, "solid\n")) return true;
    if (n < 84 || size < 84) return false;
    const uint64_t faces =
        p[80] | (uint64_t)p[81] << 8 | (uint64_t)p[82] << 16 | (uint64_t)p[83] << 24;
    return size == 84 + 50 * faces && memchr(p, '\0', 84);
}

static const struct foreign *xml_of(const unsigned char *p, size_t n)
{
    if (!begins(p, n, "<")) return NULL;
    if (text_find(p, n, "<VTKFile", 8)) return &vtk;
    return text_find(p, n, "<COLLADA", 8) ? &collada : &xml;
}

static const struct foreign *foreign_of(const unsigned char *p, size_t n, uint64_t size)
{
    const size_t blank = begins(p, n, BOM) ? sizeof BOM - 1 : 0;
    const struct foreign *f = xml_of(p + blank, n - blank);
    if (f) return f;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (n >= rows[i].n && memcmp(p, rows[i].bytes, rows[i].n) == 0) return &rows[i].of;
    return is_stl(p, n, size) ? &stl : is_obj(p, n) ? &obj : NULL;
}

bool job_readable(const unsigned char *first, size_t n, uint64_t size, char err[ERR_BYTES])
{
    const struct foreign *f = foreign_of(first, n, size);
    return !f ||
           err_set(err, "is %s, expected a scene, a grid or a specification: %s", f->is, f->remedy);
}
