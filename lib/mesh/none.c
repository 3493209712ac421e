/* none: JPEG where libjpeg is missing. */
#include "mesh/picture.h"

bool mesh_jpeg_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR])
{
    (void)p, (void)n, (void)im;
    snprintf(err, IMAGE_ERR, "JPEG, which this build cannot read, expected PNG");
    return false;
}
