/* unconfined: POSIX has no Landlock. */
#include "crop/crop.h"

#include <errno.h>

int crop_landlock(void) { return 0; }

int crop_confine(const char *const own[], int version)
{
    (void)own, (void)version;
    errno = ENOSYS;
    return -1;
}
