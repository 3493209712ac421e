/* files, where libarchive is missing: nothing can be packed. */
#include "files/files.h"

static bool lacking(char err[ERR_BYTES])
{
    return err_set(err, "files: this program was built without libarchive");
}

bool files_pack(char *const paths[], size_t n, struct buf *archive, char err[ERR_BYTES])
{
    (void)paths, (void)n, (void)archive;
    return lacking(err);
}

bool files_unpack(const unsigned char *archive, size_t n, const char *directory, char **first,
    char err[ERR_BYTES])
{
    (void)archive, (void)n, (void)directory, (void)first;
    return lacking(err);
}
