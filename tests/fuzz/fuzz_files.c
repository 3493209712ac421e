/* Whatever the bytes: files_unpack returns a message, or files below its directory, no more bytes
 * than it was given. */
#include "files/files.h"

#include <ftw.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

static size_t bytes;

static int look(const char *path, const struct stat *st, int kind, struct FTW *at)
{
    (void)at;
    MUST(kind == FTW_F || kind == FTW_DP);
    if (kind == FTW_F) bytes += (size_t)st->st_size;
    return remove(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char err[ERR_BYTES] = "", *first, directory[] = "/tmp/fuzz_files.XXXXXX", out[64];
    MUST(mkdtemp(directory));
    snprintf(out, sizeof out, "%s/out", directory);
    MUST(mkdir(out, 0700) == 0);
    unsigned char *copy = xmalloc(size, 1);
    if (size) memcpy(copy, data, size);
    bool good = files_unpack(copy, size, out, &first, err);
    MUST(good == (first != NULL) && (good || *err));
    if (good) MUST(files_name_check(first, err));
    bytes = 0;
    MUST(nftw(out, look, 8, FTW_PHYS | FTW_DEPTH) == 0);
    MUST(bytes <= size);
    MUST(rmdir(directory) == 0); /* nothing beside it */
    free(first);
    free(copy);
    return 0;
}
