#!/bin/sh
# AddressSanitizer and UBSan find nothing in the unit tests, in a pipeline, and in a short run of the fuzz targets. `make
# reach` tries those that a change can reach. FUZZ_SECONDS=60 FIRST=SEED is a longer run of each target.
. "$(dirname "$0")/lib.sh"
needs clang /usr/include/cmocka.h
. "$root/tests/builds.sh"
units=$(tests/reach units) fuzzers=$(tests/reach fuzzers) programs=''
# If a change reaches one stage of the pipeline, every stage is built.
[ -z "$(tests/reach pipeline)" ] || programs=$(CHANGED='' tests/reach pipeline)
targets=$(for name in $units; do echo "build/fuzz/unit/$name"; done
	for name in $fuzzers; do echo "build/fuzz/fuzz_$name"; done
	for name in $programs; do echo "build/fuzz/bin/$name"; done)
# Without numbers of lines, which `make fuzz` has, it compiles in less time; a report still names the functions.
# shellcheck disable=SC2086
ok 'it builds with sanitizers, and clang warns of nothing' \
	make -s -j2 sanitized OF="$(echo $targets)" STRICT='-Werror -Wreserved-identifier -g0'

# test_base tries to run out of memory.
export ASAN_OPTIONS=allocator_may_return_null=1
# shellcheck disable=SC2016  # the inner shell expands them
printf '%s\n' $units | xargs -r -n 1 -P "$(nproc)" sh -c '"build/fuzz/unit/$1" >"$0/$1.said" 2>&1; echo $? >"$0/$1.status"' "$tmp"
unset ASAN_OPTIONS
clean() { cat "$tmp/$1.said"; return "$(cat "$tmp/$1.status")"; }
for name in $units; do ok "$name is clean under ASan and UBSan" clean "$name"; done
[ -z "$programs" ] || ok 'the pipeline built with sanitizers renders the same bits' same build/fuzz/bin
# shellcheck disable=SC2086
[ -z "$fuzzers" ] || ONLY=$(echo $fuzzers) ok 'the fuzz targets find nothing in a short run' tests/fuzz/run "${FUZZ_SECONDS:-1}" "${FIRST:-1}"
finish
