#!/bin/sh
# AddressSanitizer and UBSan find nothing in the unit tests, in a pipeline, and in a short run of the fuzz targets.
. "$(dirname "$0")/lib.sh"
needs clang /usr/include/cmocka.h
. "$root/tests/builds.sh"
ok 'it builds with sanitizers' make -s -j2 sanitized OF='all unit fuzzers' STRICT=-Werror

# test_base tries to run out of memory.
for unit in tests/unit/test_*.c; do
	name=$(basename "$unit" .c)
	ok "$name is clean under ASan and UBSan" env ASAN_OPTIONS=allocator_may_return_null=1 "build/fuzz/unit/$name"
done
ok 'the pipeline built with sanitizers renders the same bits' same build/fuzz/bin
ok 'the fuzz targets find nothing in a short run' tests/fuzz/run 2 1
finish
