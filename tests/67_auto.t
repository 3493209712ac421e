#!/bin/sh
# balance auto: the method that it chooses by powers, round trips and costs; and it renders with that method.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
. "$(dirname "$0")/lib.sh"

spdgen -s 2 gears >gears.nff
size=96x80
partition $size | rtworker gears.nff | gather -o good.pfm
# chosen NAME ERE HOSTS [SIZE]: balance auto chooses NAME, with this line on standard error
chosen() {
	run sh -c 'pack scene gears.nff | balance-auto "$2" "$(fan -l -S "$1" | wc -l)" /dev/null fan -S "$1" rtworker -a 16' - "$3" "${4:-256x256}"
	is "$1: exit 0" "$status" 0
	like "$1: the name" "$out" "^($2)$"
	like "$1: why" "$err" "^balance auto: ($2): [0-9.e-]+ s on [34] slots at [0-9.e-]+ ms, as simulated;( [a-z]+ [0-9.e-]+)+"
}
printf ': slots=4 power=3\n' >equal
chosen 'four equal slots' 'interleaved|masterslave|ds|adaptive|hybrid|gdc' equal
printf ': slots=2 power=3\n: power=.4\n: power=.2\n' >unequal
chosen 'unequal ones' 'masterslave|adaptive|hybrid|ds|gdc' unequal
# Its answers come late, so the method must not wait for them.
printf '#!/bin/sh\n{ cat; sleep .2; } | sh -c "$1"\n' >far && chmod +x far
printf 'far slots=3 power=3 via="./far %%c"\nfar2 power=2 via="./far %%c"\n' >away
chosen 'far away' 'interleaved|adaptive|hybrid|gdc' away
# The hosts are so far away that all tasks would be given in advance, if all were up.
printf 'far slots=3 power=3 via="./far %%c"\nnone via="false %%c"\n' >none
chosen 'one of four does not answer: nothing is given to it in advance' 'masterslave|ds|adaptive|gdc' none
like 'balance auto: the host without answer is named' "$err" 'no answer: none$'

# A table in the place of that of fan -l -l. What cannot be chosen is not simulated further, and at most 2 % are given away.
mkdir many && ln -s "$root"/bin/* many/ && rm many/fan many/balance-auto && cp "$root/bin/balance-auto" many/
printf '#!/bin/sh\n[ "$1 $2" != "-l -l" ] || exec cat table\nexec "%s/bin/fan" "$@"\n' "$root" >many/fan && chmod +x many/fan
pack scene gears.nff >state
for n in 9 401; do
	seq $n | awk -v OFS='\t' '{ p = 1 + $1 * .618 % 1; print NR - 1, "host" NR, p, 40, p * .7 }' >table
	run sh -c 'many/balance-auto 256x256 "$1" /dev/null fan rtworker <state' - $n
	is "$n slots: 2 % and no more are given away" "$(echo "$err" | awk -v name="$out" '{
		s[name] = $4
		sub(/.*simulated; /, "")
		for (i = 1; i < NF && $i !~ /^(none|simpler)$/; i += 2) { s[$i] = $(i + 1) + 0; left[$i] = $(i + 1) ~ /[+]/ }
		best = $i == "none" ? name : $(i + 2)
		if (!best) print "no reason"
		for (m in s) if (s[m] < .995 * s[best]) print m " is faster than " best
		for (m in left) if (left[m] && s[m] < 1.01 * s[best]) print m " was left out"
		if (s[name] > 1.03 * s[best]) print name " takes longer than " best
	}')" ''
done
is 'more than 400 slots: no ring' "$(echo "$err" | grep -c gdc)" 0

same() { ok "$1: the same picture" cmp out.pfm good.pfm; rm -f out.pfm; }
run balance auto -j 3 -s $size -o out.pfm gears.nff
is 'balance auto: exit 0' "$status" 0
is 'balance auto: one line says why' "$(echo "$err" | grep -c '^balance auto: ')$(echo "$err" | grep -cv 'never connected$')" 11
same 'balance auto'
balance auto -S unequal -s $size -r log -o out.pfm gears.nff 2>said
same 'balance auto -S -r'
run balance auto -S unequal -s $size -r log -o out.pfm gears.nff
is 'a complete log: no method is chosen' "$err" ''
same 'a complete log'
head -c 60000 log >part
run balance auto -j 2 -s $size -r part -o out.pfm gears.nff
same 'an incomplete log'
balance auto -j 2 -s $size -o out.pfm - <gears.nff 2>said
same 'the scene from a pipe'
for size in 1x1 3x200 200x2; do
	balance auto -j 2 -s $size -o out.pfm gears.nff 2>said
	is "a picture of $size" "$(head -n 2 out.pfm | tail -n 1)" "$(echo $size | tr x ' ')"
done
for bad in "-W -q" '-s 0x1' '-j 0'; do
	# shellcheck disable=SC2086
	run balance auto $bad -o out.png gears.nff
	is "balance auto $bad: exit 2" "$status" 2
	is "balance auto $bad: nothing is chosen" "$(echo "$err" | grep -c 'as simulated')" 0
done
run sh -c 'pack scene gears.nff | balance-auto 64x64 2 /dev/null fan -j 2 false'
is 'a worker that does not work: exit 3' "$status" 3

cat >box.vtk <<'END'
# vtk DataFile Version 3.0
box
ASCII
DATASET RECTILINEAR_GRID
DIMENSIONS 2 2 2
X_COORDINATES 2 float
0 1
Y_COORDINATES 2 float
0 1
Z_COORDINATES 2 float
0 1
POINT_DATA 8
SCALARS s float 1
LOOKUP_TABLE default
1 2 3 4 5 6 7 8
END
printf 'from %s\nat .5 .5 .5\nup 0 0 1\nangle 30\nresolution 48 32\nmap 1 0 0 1 .1\nmap 8 1 0 0 3\n' '-3 -2 2' >a.spec
sed 's/^from.*/from 3 -2 2/' a.spec >b.spec
for m in auto masterslave; do
	run balance $m -j 2 -o "$m-%d.pfm" box.vtk a.spec b.spec
	is "two views by $m: exit 0" "$status" 0
done
ok 'two views: the first' cmp auto-0.pfm masterslave-0.pfm
ok 'two views: the second' cmp auto-1.pfm masterslave-1.pfm
mkdir a:b
run env TMPDIR=a:b balance auto -j 2 -s 8x8 -o x.png gears.nff
like 'a colon in TMPDIR: refused' "$status:$err:$(ls a:b)" '^2:balance auto: a:b: has a colon, which PATH cannot hold, expected another TMPDIR:$'
is 'no file remains in TMPDIR' "$(mkdir t && TMPDIR=$PWD/t balance auto -j 2 -s 8x8 -o x.png gears.nff 2>said; ls t)" ''
finish
