/*
 * files: the input files of a command as one archive, a tar file without compression, through
 * libarchive. The same files give the same bytes on every machine: times and owners are left out.
 *
 * An archive from a stream is untrusted. It holds regular files only, with names below its
 * directory; the total is at most the archive's length.
 */
#ifndef STORMRING_FILES_H
#define STORMRING_FILES_H

#include "base/base.h"

/*
 * Appends an archive of these files, in this order. Names are relative to the directory of the
 * first one, and all must be below it. Returns true, or false with "file: what, expected what" in
 * err.
 */
bool files_pack(char *const paths[], size_t n, struct buf *archive, char err[ERR_BYTES]);
/*
 * Unpacks into a directory that exists and is empty. *first: the name of the first file, which the
 * caller frees. Returns true, or false with text in err; files may be there then.
 */
bool files_unpack(const unsigned char *archive, size_t n, const char *directory, char **first,
    char err[ERR_BYTES]);
/* False, with text in err, if the name is absolute, leads out of its directory, or is not as short
 * as can be. */
bool files_name_check(const char *name, char err[ERR_BYTES]);

#endif
