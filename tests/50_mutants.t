#!/bin/sh
# The seeds of `make check` find every mutant of a policy, and unit tests those of records, slots, workers and scenes
# (mutants/). The shipped code passes them. `make reach` tries the families that a change can reach.
. "$(dirname "$0")/lib.sh"
needs /usr/include/cmocka.h
mutants=$root/tests/mutants work=$PWD
reached=$("$root/tests/reach" families) && reached=$(printf '%s\n' "$reached" | tr '\n' ' ') || exit 3

# Only the file with the mutant is compiled: the linker takes the others from the library of the clone, and this one not,
# because all that it defines is there already. The tests of crop wait until patience ends, so they get less.
flags="-std=c11 -D_GNU_SOURCE -DPATIENCE_S=10 -O0"
library="$root/build/liboracles.a $root/build/libstormring.a"
libs="-Wl,-S -lcmocka $(cat "$root/build/libs")"
# shellcheck disable=SC2086
compile() { cc $flags "-I$root/lib" -c -o "$1" "$2"; }
unset FIRST SEEDS CMOCKA_MESSAGE_OUTPUT # tests say in words which one failed
sign='to repeat:' # what a test says that has found a mutant
# found TEST LIST NAME: row NAME of LIST makes a mutant, and a seed of test_TEST fails with it. In a directory of its own,
# so that several can run at a time.
# shellcheck disable=SC2086
found() (
	mkdir "in.$3" && cd "in.$3" || return
	"$mutants/apply" "$3" "$2" >mutant.c || return
	# A program that hosts run is a string.
	! head -n 1 mutant.c | grep -q '^#!' || { mv mutant.c mutant.sh && sed -f "$root/lib/hosts/bootstrap.sed" mutant.sh >mutant.c; } || return
	compile mutant.o mutant.c || { echo "$3: does not compile"; return 1; }
	cc -o mutant mutant.o "$work/$1.o" $library $libs || { echo "$3: does not link"; return 1; }
	# The first sign is enough: it ends the test, and the shell must survive to keep the status.
	{ trap : PIPE; TMPDIR=$PWD timeout 300 prlimit --cpu=60 ./mutant 2>&1; echo $? >status; } | grep -q "$sign" && [ "$(cat status)" -ne 0 ] ||
		{ echo "$3: survives: test_$1 exits with $(cat status), and no seed fails"; return 1; }
)
was_found() { [ -e "$1.found" ] || { cat "$1.why"; return 1; }; }
# listed LIST: it has rows, and no other lines
listed() { grep -q '^@' "$1" && ! grep -nvE '^(#.*|@ [a-z0-9-]+  lib/[a-z0-9_/]+[.](c|sh)|[-+]( .*)?|)$' "$1"; }
names() { awk '$1 == "@" { print $2 }' "$@"; }
# family TEST: the mutants of its list, if a change can reach them
# shellcheck disable=SC2046,SC2086
family() {
	case " $reached " in *" $1 "*) ;; *) return ;; esac
	ok "mutants/$1 is a list of mutants" listed "$mutants/$1"
	ok "test_$1 compiles" compile "$1.o" "$root/tests/unit/test_$1.c"
	cc -o shipped "$1.o" $library $libs
	ok "the shipped code passes test_$1" ./shipped
	number=0
	for name in $(names "$mutants/$1"); do
		{ found "$1" "$mutants/$1" "$name" >"$name.why" 2>&1 && : >"$name.found"; } &
		[ $((number = (number + 1) % 4)) -ne 0 ] || wait
	done
	wait
	for name in $(names "$mutants/$1"); do ok "test_$1 finds: $name" was_found "$name"; done
}

is 'each mutant has its own name' "$(names "$mutants"/[!a]* "$mutants"/a[!p]* | sort | uniq -d)" ''
family sim
family ring
family gdc
family tree
family balance

# A wrong row fails with the reason.
cat >wrong <<'END'
@ text-missing  lib/sched/gdc_master.c
- no such text
+
@ text-twice  lib/sched/gdc_master.c
- struct member
+
@ replacement-missing  lib/sched/gdc_master.c
- struct member {
@ no-program  lib/sched/gdc_master.c
- struct member {
+
@ no-change  lib/sched/gdc_master.c
- struct member {
+ struct member {
@ name-twice  lib/sched/gdc_master.c
- struct member {
+
@ name-twice  lib/sched/gdc_master.c
- struct master {
+
@ no-bug  lib/sched/gdc_master.c
- struct member {
+ struct  member {
END
# refused NAME ERE: for this reason
refused() {
	run found gdc ../wrong "$1"
	like "a row fails: $1" "$status $out$err" "$2"
}
refused text-missing '^1 text-missing: lib/sched/gdc_master.c does not have the text: no such text'
refused text-twice '^1 text-twice: lib/sched/gdc_master.c has the text more than once: struct member'
refused replacement-missing '^1 replacement-missing: no line with "[+]" follows: struct member'
refused no-program '^1 no-program: does not compile'
refused no-change '^1 no-change: changes nothing in lib/sched/gdc_master.c'
refused name-twice '^1 name-twice: this name is in [.][.]/wrong 2 times, expected once'
compile gdc.o "$root/tests/unit/test_gdc.c"
refused no-bug '^1 no-bug: survives: test_gdc exits with 0, and no seed fails'
printf '%s\n' '@name lib/sched/gdc_master.c' '- text' '+' '@ other  lib/sched/gdc_master.c' '- text' '+' >wrong
run listed wrong
is 'a line that is not part of a row is found' "$status $out" '1 1:@name lib/sched/gdc_master.c'
# Tests of single functions, which say it in cmocka's words.
sign='[[]  FAILED  []]'
for test in clock loads wire eta fan pace powers drain worker forks store crop view look nff_parts image png assembly hosts hosts_job keep send verify job poison; do family $test; done
if there /usr/include/zstd.h; then family packing
else skip 'test_packing finds its mutants' 'libzstd is not there'
fi
if there /usr/include/archive.h; then
	libs="$libs -larchive"
	family files
else skip 'test_files finds its mutants' 'libarchive is not there'
fi
finish
