#!/bin/sh
# AddressSanitizer and UBSan find nothing in the unit tests, in a pipeline, and in a short run of the fuzz targets. `make
# reach` tries those that a change can reach. FUZZ_SECONDS=60 FIRST=SEED is a longer run of each target.
. "$(dirname "$0")/lib.sh"
needs clang /usr/include/cmocka.h
. "$root/tests/builds.sh"
units=$(tests/reach units) && fuzzers=$(tests/reach fuzzers) || exit 3
programs=''
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
printf '%s\n' $units | xargs -r -n 1 -P "$("$root/tests/processors")" sh -c '"build/fuzz/unit/$1" >"$0/$1.said" 2>&1; echo $? >"$0/$1.status"' "$tmp"
unset ASAN_OPTIONS
clean() { cat "$tmp/$1.said"; return "$(cat "$tmp/$1.status")"; }
for name in $units; do ok "$name is clean under ASan and UBSan" clean "$name"; done
[ -z "$programs" ] || ok 'the pipeline built with sanitizers renders the same bits' same build/fuzz/bin
# shellcheck disable=SC2086
[ -z "$fuzzers" ] || ONLY=$(echo $fuzzers) ok 'the fuzz targets find nothing in a short run' tests/fuzz/run "${FUZZ_SECONDS:-1}" "${FIRST:-1}"

# Targets a and c find something, b does not.
mkdir -p "$tmp/tests/fuzz" "$tmp/build/fuzz"
cp tests/fuzz/run "$tmp/tests/fuzz"
cp tests/processors "$tmp/tests"
for name in a b c; do
	: >"$tmp/tests/fuzz/fuzz_$name.c"
	printf '#!/bin/sh\necho stat::number_of_executed_units: 7\nexit %s\n' "$([ $name = b ]; echo $?)" >"$tmp/build/fuzz/fuzz_$name"
	chmod +x "$tmp/build/fuzz/fuzz_$name"
done
run "$tmp/tests/fuzz/run" 1 1
is 'after a finding the other targets go on, and all findings are listed' "$status $(printf '%s\n' "$out" | grep inputs) $(printf '%s\n' "$err" | cut -d ';' -f 1)" \
	'1 b: 7 inputs, no finding fuzz: a: a finding
fuzz: c: a finding'
finish
