#!/bin/sh
# What `make reach` tries again (reach, check) has all that a change can break, by the compiler's files of dependencies and
# by the modules that programs are linked with. `make nightly` writes tests/PASSED only for a commit that passes.
. "$(dirname "$0")/lib.sh"
needs git nm /usr/include/cmocka.h
# shellcheck disable=SC2154  # lib.sh sets them
cd "$root" || exit 3
unset BUILD BIN TAP FIRST NIGHT CI CHANGED

# reached KIND FILE ...: for a change of these files, in a line
reached() {
	kind=$1
	shift
	printf '%s\n' "$@" >"$tmp/changed"
	CHANGED=$tmp/changed tests/reach "$kind" | sort
}
all() { tests/reach "$1" | sort; }
line() { tr '\n' ' '; }

# ---- what a change of a module can break: "KIND NAME MODULE" -------------------------------------------------------
# shellcheck disable=SC2046  # a word each
{
	awk 'FNR == 1 {
		target = $1; sub(/:$/, "", target); n = split(target, part, "/")
		name = target ~ /^build\/unit\// ? "units " part[3] : target ~ /^bin\// ? "analyzed " target ".c" : "analyzed lib/" part[2] "/" part[3]
		sub(/[.]o$/, ".c", name)
	}
	{ for (i = 1; i <= NF; i++) if ($i ~ /^lib\/[a-z0-9_]+\/.*[.]h$/) { split($i, part, "/"); print name, part[2] } }' \
		build/dep/*.d $(for source in lib/*/*.c; do d=build/${source#lib/} && d=${d%.c}.d; [ ! -e "$d" ] || echo "$d"; done) \
		$(for unit in $(all units); do [ ! -e "build/unit/$unit" ] || echo "build/unit/$unit.d"; done)
	for source in lib/*/*.c; do object=build/${source#lib/} && object=${object%.c}.o; [ ! -e "$object" ] || echo "$object"; done |
		xargs nm -g -A --defined-only | awk '{ split($1, part, "/"); print $NF, part[2] }' >"$tmp/of"
	for unit in $(all units); do [ ! -e "build/unit/$unit" ] || echo "build/unit/$unit"; done | xargs nm -g -A --defined-only |
		awk 'FNR == NR { module[$1] = $2; next } $NF in module { sub(/:.*/, "", $1); sub(/.*\//, "", $1); print "units", $1, module[$NF] }' "$tmp/of" -
} | sort -u >"$tmp/breaks"
is 'both kinds are compared' "$(cut -d ' ' -f 1 "$tmp/breaks" | uniq | line)" 'analyzed units '
for module in $(cut -d ' ' -f 3 "$tmp/breaks" | sort -u); do
	for kind in analyzed units; do
		awk -v kind=$kind -v module="$module" '$1 == kind && $3 == module { print $2 }' "$tmp/breaks" | sort >"$tmp/expected"
		reached $kind "lib/$module/$module.h" | comm -13 - "$tmp/expected"
	done >"$tmp/left"
	is "a change of $module reaches all that it can break" "$(line <"$tmp/left")" ''
done
is 'a module reaches none of those below it' "$(reached units lib/drive/drive.h | line)" "$(grep -l '"drive/' tests/unit/*.c | sed 's/.*\///; s/[.]c$//' | line)"
is 'a C file of a module is analyzed alone' "$(reached analyzed lib/base/clock.c)" lib/base/clock.c

# ---- files of no module ----------------------------------------------------------------------------------------------
is 'a unit test reaches itself and its mutants' "$(for kind in units families fuzzers; do reached $kind tests/unit/test_tree.c; done | line)" 'test_tree tree '
is 'a header of unit tests reaches those that include it' "$(reached units tests/unit/seeds.h | line)" \
	"$(grep -l '"seeds.h"' tests/unit/test_*.c | sed 's/.*\///; s/[.]c$//' | line)"
is 'a list of mutants reaches its family' "$(for kind in units families; do reached $kind tests/mutants/gdc; done)" gdc
is 'a file of the corpus reaches its target' "$(reached fuzzers tests/fuzz/corpus/nff/new)" nff
is 'a model reaches models' "$(for kind in models units; do reached $kind tests/models/ring.pml; done)" ring
is 'a script reaches itself' "$(reached scripts bin/album tests/61_idle.t bin/balance-dc README.md | line)" 'bin/balance-dc tests/61_idle.t '
echo tests/peaks.sh >"$tmp/peaks"
is 'a script that others read reaches them' "$(reached scripts tests/peaks.sh | line)" "$(grep -lr 'peaks[.]sh' bin tests | cat - "$tmp/peaks" | sort | line)"
for kind in units fuzzers families pipeline compiled; do
	is "the Makefile reaches $kind" "$(reached $kind Makefile)" "$(all $kind)"
	[ $kind = compiled ] || is "a module that is in no table reaches $kind" "$(reached $kind lib/unheard/of.h)" "$(all $kind)"
done
for kind in units fuzzers families pipeline analyzed scripts models compiled; do
	ok "there are $kind" [ -n "$(all $kind)" ]
	is "pages reach no $kind" "$(reached $kind README.md man/fan.1 tests/README tests/PASSED scenes/boat.nff)" ''
	is "the functions of tests reach all $kind" "$(reached $kind tests/lib.sh)" "$(all $kind)"
done
run tests/reach everything
like 'an unknown kind is refused' "$status $err" '^2 usage: reach units'

# ---- check reach, check nightly, in a clone with small tests ------------------------------------------------------------
cd "$tmp" || exit 3
mkdir -p small/tests/unit small/tests/soak small/tests/mutants small/lib/base && cd small || exit 3
cp "$root/tests/check" "$root/tests/tap" "$root/tests/reach" "$root/tests/01_house.t" tests
for test in 01_reach.t 02_sanitized.t 02_analyzers.t 02_compilers.t 50_mutants.t 55_models.t 60_faults.t 72_ssh_faults.t 29_povworker.t \
	soak/damage.sh soak/kills.sh soak/restart.sh soak/come.sh soak/seeds.sh soak/load_ssh.sh soak/send_link.sh; do
	printf '#!/bin/sh\necho "ok 1 - $FIRST"\necho 1..1\n' >tests/$test
done
printf '#!/bin/sh\necho 1..1\n[ ! -e broken ] || printf "not "\necho "ok 1"\n' >tests/01_house.t.new
sed -n '/^cat >"$tmp\/arrows"/,/^END/p' tests/01_house.t >>tests/01_house.t.new && mv tests/01_house.t.new tests/01_house.t
sed -i '/^cat >/s/.*/exit\n&/' tests/01_house.t
: >lib/base/clock.c
chmod +x tests/*.t tests/soak/*
echo build >.gitignore
git() { command git -c user.name=a -c user.email=a@example.org "$@" >"$tmp/git.said" 2>&1; }
# tries MODE FILES NAME: runs the tests of these files, and exits with 0
tries() {
	run tests/check "$1"
	is "$3" "$status $(cd build/tap && ls -- *.t *.sh 2>/dev/null | sed 's/[.].*//' | line)" "0 $2 "
}
reaching='01_reach 02_analyzers 02_compilers 02_sanitized 50_mutants 55_models' behaviour='01_house 29_povworker 60_faults 72_ssh_faults'
# Each kind has a name there.
mkdir -p tests/fuzz tests/models bin build/unit && cp tests/55_models.t build/unit/test_a && echo '#include "base/base.h"' >tests/unit/test_a.c && : >tests/mutants/a && : >tests/models/ring.pml
tries check "$behaviour" 'check: the tests of behaviour, and no others'
tries reach "$reaching" 'reach, where there is no clone: everything'
like 'reach: it says why' "$out" '^reach: everything, because tests/PASSED is not there'
run tests/check nightly
like 'nightly, where there is no clone, is refused' "$status $err" '^2 nightly: .* no clone'
commit() { git add -A && git commit -q -m "$1"; }
git init -q && commit one
echo 'int a;' >lib/base/clock.c
run tests/check nightly
like 'nightly: what is not committed is refused' "$status $err" '^2 nightly: something is not committed'
commit two
: >broken && echo broken >>.git/info/exclude
run tests/check nightly
is 'nightly: a test that fails fails it, and tests/PASSED is not written' "$status $([ ! -e tests/PASSED ] || cat tests/PASSED)" '1 '
rm broken
tries nightly "$(printf '%s\n' $reaching $behaviour damage kills restart come seeds load_ssh send_link | sort | tr '\n' ' ' | sed 's/ $//')" 'nightly: all, and soaks'
is 'nightly: a pass is written' "$(cat tests/PASSED)" "$(command git rev-parse HEAD)"
like 'nightly: the first seed is of the date' "$(grep -h ok build/tap/60_faults.t) $out" "^ok 1 - $(date +%y)[0-9]{4}000 .*FIRST=[0-9]+ make nightly"
FIRST=7 run tests/check nightly
is 'nightly: a given seed, and after a pass that is not committed' "$status $(grep -h ok build/tap/60_faults.t)" '0 ok 1 - 7'
run tests/check reach
is 'reach: after a pass there is nothing to do' "$status $(printf '%s\n' "$out" | tail -n 1)" '0 reach: these files reach no test'
commit three
printf '#!/bin/sh\n' >tests/new.sh
tries reach '01_reach 02_analyzers' 'reach: a new script reaches the test of this tool, and is analyzed'
rm tests/new.sh && echo >>lib/base/clock.c && commit four
tries reach '02_analyzers 02_compilers 02_sanitized 50_mutants' 'reach: a module'
echo 0123456789012345678901234567890123456789 >tests/PASSED
tries reach "$reaching" 'reach, where the commit is unknown: everything'
like 'reach: it says that the commit is unknown' "$out" '^reach: everything, because tests/PASSED names no commit that is here'
finish
