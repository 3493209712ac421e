#!/bin/sh
# AddressSanitizer and UBSan find nothing in the unit tests and in a pipeline.
. "$(dirname "$0")/lib.sh"
needs gcc /usr/include/cmocka.h
. "$root/tests/builds.sh"
sanitize='-O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all'
ok 'it builds with sanitizers' build sanitized gcc "$sanitize -Werror" all unit

# test_base tries to run out of memory.
for unit in tests/unit/test_*.c; do
	name=$(basename "$unit" .c)
	ok "$name is clean under ASan and UBSan" env ASAN_OPTIONS=allocator_may_return_null=1 "build/sanitized/unit/$name"
done
ok 'the pipeline built with sanitizers renders the same bits' same sanitized
finish
