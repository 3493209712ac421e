#!/bin/sh
# What `make` built warned of nothing, is hardened, and renders the same picture as its worker alone. For other compilers:
# 02_compilers.t.
. "$(dirname "$0")/lib.sh"
needs gcc valgrind /usr/include/cmocka.h
. "$root/tests/builds.sh"

# In a new clone, make check compiled all.
is 'the build warned of nothing' "$(grep warning: build/said 2>/dev/null)" ''
ok 'its programs are hardened' hardened cc bin build
# Static programs have no table of symbols.
pie() { readelf -W -h -l -d "$1" | awk '/Type: +DYN/ { dyn = 1 } /FLAGS_1.* NOW.* PIE/ { now = 1 } /GNU_RELRO/ { relro = 1 } END { exit !(dyn && now && relro) }'; }
for program in build/static/*; do
	if there "$program"; then ok "$program is position independent" pie "$program"
	else skip 'static programs are position independent' "$missing is not there"
	fi
done
if there build/static/rtworker musl-gcc; then
	is 'static programs have musl' "$(grep -l 'GNU C Library' build/static/*)" ''
else skip 'static programs have musl' "$missing is not there"
fi
# In a subshell, because of its PATH.
# shellcheck disable=SC2329  # run by ok
same_static() (same build/static)
if there build/static/rtworker; then ok 'static programs render the same bits' same_static
else skip 'static programs render the same bits' "$missing is not there"
fi
ok 'it builds without optimisation' build plain gcc '-O0 -Werror' build/plain/base/clock.o
is 'CFLAGS and LDFLAGS come last, so they win' "$(make -n -B BUILD=build/plain CC=gcc CFLAGS='-O0 -fno-pie -fno-stack-protector' \
	LDFLAGS=-no-pie build/plain/bin/imgcmp 2>&1 | grep -e '-o build/plain/bin/imgcmp' |
	grep -Ec 'stack-protector-strong .*-fno-stack-protector .*-pie .*-no-pie ')" 1

ok 'the pipeline renders the same bits' same bin

memcheck='valgrind -q --error-exitcode=9 --leak-check=full --trace-children=no'
# shellcheck disable=SC2086
{
	ok 'valgrind finds nothing in a unit test' $memcheck build/unit/test_task
	partition 4x4 >"$tmp/tasks"
	spdgen -s 1 balls >"$tmp/balls.nff"
	ok 'valgrind finds nothing in a worker' sh -c "$memcheck bin/rtworker '$tmp/balls.nff' <'$tmp/tasks'"
}
finish
