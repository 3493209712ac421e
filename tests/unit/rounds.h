/*
 * How often a test repeats: rounds(n) is n, and an eighth where sanitizers are built in. These make a
 * test up to ten times as slow, and find in a few rounds what they can find. nightly(DAY, NIGHT) is
 * for rounds that take seconds: `make nightly`, which sets NIGHT, repeats them more often.
 */
#ifndef STORMRING_TESTS_ROUNDS_H
#define STORMRING_TESTS_ROUNDS_H

#include <stdlib.h>

#ifndef __has_feature /* clang's name; gcc defines __SANITIZE_ADDRESS__ */
#define __has_feature(name) 0
#endif

static inline int rounds(int n)
{
#if defined __SANITIZE_ADDRESS__ || __has_feature(address_sanitizer)
    return (n + 7) / 8;
#else
    return n;
#endif
}

static inline int nightly(int day, int night) { return rounds(getenv("NIGHT") ? night : day); }

#endif
