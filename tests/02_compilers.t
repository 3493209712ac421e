#!/bin/sh
# gcc and clang warn of nothing, clang's programs are hardened, and render the same picture. For gcc's: 02_builds.t.
. "$(dirname "$0")/lib.sh"
needs gcc clang /usr/include/cmocka.h
. "$root/tests/builds.sh"

# make may have compiled all by gcc without a warning.
strict() {
	cc -v 2>&1 | grep -q '^gcc version' && [ -e build/strict ] && [ -z "$(find lib bin tests/unit -newer build/strict)" ] && return
	build gcc gcc '-O2 -Werror' all unit
}
ok 'gcc warns of nothing' strict
ok 'clang warns of nothing' build clang clang '-O2 -Werror' all unit
ok 'programs built by clang are hardened' hardened clang build/clang/bin build/clang
ok 'the pipeline built by clang renders the same bits' same build/clang/bin
finish
