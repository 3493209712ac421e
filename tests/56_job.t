#!/bin/sh
# balance tells the stages which jobs its pictures have: a slot that announces another job is ended, even if it reports
# first, and a picture without any fragment is missing.
. "$(dirname "$0")/lib.sh"
patient
spdgen -s 1 tetra >a.nff
spdgen -s 1 balls >b.nff
balance interleaved -j 2 -s 24x16 -o true.pfm a.nff
# sed writes to the file first, because fan may end the liar as soon as it reads the line.
cat >liar <<'END'
sed -u 's/^\(frame [0-9 ]*\) job=.*/\1/' | sh -c "$(echo "$1" | sed 's/rtworker/& -d 4/')" | LC_ALL=C sed -u 'w said'
END
cat >honest <<'END'
until grep -aq ' job=' said; do sleep .02; done
exec sh -c "$1"
END
echo 'liar via="sh ./liar %c"' >hosts
for host in a b c d e f; do echo "$host via=\"sh ./honest %c\""; done >>hosts
for method in masterslave adaptive gdc; do
	rm -f out.pfm said && : >said
	run timeout 1200 balance $method -S hosts -s 24x16 -o out.pfm a.nff
	is "$method, the first of seven slots is on another job: the same picture" "$status$(cmp out.pfm true.pfm)" 0
	[ "$status" = 0 ] || diag "$err"
	is "$method: the slot is named" "$(echo "$err" | grep -c 'slot 0 on liar: frame 0 has job [0-9a-f]* there, expected')" 1
	is "$method: no other slot is named" "$(echo "$err" | grep -c 'slot [1-6]')" 0
done

# ---- gather -e ----------------------------------------------------------------------------------------------
job() { rtworker -i -s 24x16 "$1" | grep job=; }
{ pack scene a.nff; partition 24x16; } | rtworker - >first.frags
echo "frame 0 24 16 $(job a.nff)" >one
{ cat one; echo "frame 1 24 16 $(job b.nff)"; } >two
echo "frame 0 24 16 $(job b.nff)" >other
run gather -e one -o f%d.pfm first.frags
is 'gather -e: the picture' "$status$err$(cmp f0.pfm true.pfm)" 0
run gather -e two -o f%d.pfm first.frags
like 'gather -e: nothing of the second has come' "$status $err" '^1 gather: frame 1: 384 of 384 pixels missing'
run gather -e other -o f%d.pfm first.frags
like 'gather -e: another job' "$status $err" '^2 gather: other: .frame 0 24 16 job=.*, expected .frame F W H job=HASH. as it was rendered'
run gather -e first.frags -o f%d.pfm first.frags
like 'gather -e: of another kind' "$status $err" '^2 gather: first.frags: .*expected'
run gather -e none -o f%d.pfm first.frags
like 'gather -e: no such file' "$status $err" '^2 gather: none: No such file'

# ---- -s of rtworker -i -----------------------------------------------------------------------------------------------
run rtworker -i -s 24x16 a.nff
is 'rtworker -i -s: the job of that size' "$(echo "$out" | tail -n 1)" "$(grep -aom 1 'job=[0-9a-f]*' first.frags)"
run rtworker -s 24x16 a.nff
is '-s alone' "$status $err" '2 rtworker: -s: expected -i or -n with it'
run balance masterslave -W '-s 8x8' a.nff
is 'balance -W -s' "$status $err" '2 job: -W -s 8x8: expected the size with -s before -W'
run balance adaptive -W '-j 3' a.nff
is 'balance -W -j' "$status $err" '2 job: -W -j 3: expected the slots with -j before -W'
finish
