#!/bin/sh
# balance -v: another host finds the pixels of a lying worker; honest runs pass. Hosts are commands on this machine.
# shellcheck disable=SC2154,SC2016  # lib.sh and marked.sh set them; scripts for others
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
compile liar
spdgen -s 1 balls >balls.nff
sed 's/^from .*/from 2 3 1/' balls.nff >other.nff
balance interleaved -j 2 -s 32x32 -o true.png balls.nff

# three B: writes hosts a, b and c with one slot each; the command of b is B
three() { printf '%s\n' 'a via="sh -c %c"' "b via=\"$1\"" 'c via="sh -c %c"' >hosts; head -n 2 hosts >two; }
# counts: prints the numbers of pieces, of different ones, and of unchecked ones in the message of verify
counts() { printf '%s\n' "$err" | sed -nE 's/^verify: ([0-9]+) of [0-9]+ pieces were .*: ([0-9]+) differ, ([0-9]+) could not be computed$/\1 \2 \3/p'; }

# ---- honest ------------------------------------------------------------------------------------------------------
three 'sh -c %c'
for method in interleaved masterslave adaptive hybrid gdc ss sc ds dc; do
	rm -f out.png
	run balance $method -v 1 -S hosts -s 32x32 -o out.png balls.nff
	is "$method: honest hosts pass" "$status:$(counts | cut -d ' ' -f 2-):$(cmp out.png true.png && echo same)" '0:0 0:same'
done
run balance masterslave -v 1 -j 2 -s 32x32 -o out.png balls.nff
like 'one host: another slot computes the pieces again, and a message says so' "$status $(echo "$err" | tail -n 1)" \
	'^0 verify: 32 of 32 pieces were computed again on another slot of the only host: 0 differ'
# The checks do not fit on the disk.
mkdir full && cat >full/mktemp <<END
#!/bin/sh
made=\$($(command -v mktemp) "\$@") || exit
[ ! -d "\$made" ] || ln -s /dev/full "\$made/1"
echo "\$made"
END
chmod +x full/mktemp
PATH=$tmp/full:$PATH run balance masterslave -v 1 -j 2 -s 32x32 -o out.png balls.nff
like 'a full disk: exit 3, and no host is blamed' "$status:$err" '^3:balance: .*: the checks cannot be written, expected TMPDIR to name'
run balance masterslave -v 1 -j 1 -s 32x32 -o out.png balls.nff
is 'one slot is refused' "$status:$err" '2:balance: -v: one slot, expected two at least, and two hosts to check hosts'
for bad in 0 1.5 x -1; do
	run balance masterslave -v $bad -j 2 -s 32x32 -o out.png balls.nff
	like "-v $bad is refused" "$status:$err" "^2:balance: -v $bad: expected a fraction above 0, up to 1$"
done
run balance masterslave -v 1 -S hosts -s 32x32 balls.nff
cmp -s "$tmp/.out" true.png
is 'a picture on standard output' "$?:$status" 0:0

# ---- a liar --------------------------------------------------------------------------------------------------------
# The honest hosts begin when b has lied. Otherwise they may compute every row before b has started.
cat >after <<'END'
n=0
until [ -s lies ] || [ $((n += 1)) -gt 100 ]; do sleep .1; done
exec sh -c "$1"
END
printf '%s\n' 'a via="sh ./after %c"' 'b via="sh -c %c | ./liar .5"' 'c via="sh ./after %c"' >hosts
for method in interleaved masterslave adaptive gdc ss dc; do
	rm -f lies
	run balance $method -v 1 -S hosts -s 32x32 -r $method.log -o out.png balls.nff
	is "$method: status 1" "$status" 1
	like "$method: the liar is named" "$err" '^verify: frame 0 at [0-9]+,[0-9]+: slot 1 \(host b\) computed other pixels than two other hosts'
	like "$method: no other slot is named" "$(echo "$err" | grep -c '^verify.*slot [02]')" '^0$'
done
# Idle slots may have computed copies, so that gather sees the difference; that does not replace the checks.
{ pack scene balls.nff; partition 32x32; } >all.task
{ fan -j 1 rtworker | tee honest | ./liar 1; cat honest; } <all.task >both.log
run balance adaptive -v 1 -j 3 -s 32x32 -r both.log -o out.png balls.nff
like 'pixels of the log differ: status 1, and the rest is checked' "$status $(echo "$err" | tail -n 1)" \
	'^1 verify: [0-9]+ of [0-9]+ pieces were computed again'
three 'sh -c %c | ./liar .5'
rm -f lies
run balance interleaved -v 1 -S two -s 32x32 -o out.png balls.nff
is 'two hosts: status 1' "$status" 1
like 'two hosts: both are named' "$err" '^verify: frame 0 at 0,[0-9]+: slot [01] \(host [ab]\) and slot [01] \(host [ab]\) computed different pixels'

# A share of .2 finds at least one of n lies with probability 1 - .8^n.
three 'sh -c %c | ./liar .3 7'
rm -f lies
balance interleaved -S hosts -s 32x64 -r few.log -o out.png balls.nff
sort -u lies >lied
lied=$(wc -l <lied) found=0 seed=0
while [ $((seed += 1)) -le 100 ]; do
	verify -S hosts -s $seed .2 few.log </dev/null | awk '/^task/ { print $4, $5 }' | sort >chosen
	[ -z "$(comm -12 lied chosen)" ] || found=$((found + 1))
done
expected=$(awk -v n="$lied" 'BEGIN { print 100 * (1 - .8 ^ n) }')
# Four standard deviations; the seeds are always the same ones.
ok "-v .2: of 100 draws $found find one of $lied lies, expected some $expected" \
	awk -v found=$found -v e="$expected" 'BEGIN { exit !((found - e) ^ 2 <= 16 * e * (1 - e / 100) + 1) }'

# ---- many pictures, an existing log ------------------------------------------------------------------------------
three 'sh -c %c'
{
	printf '%s\n' '# vtk DataFile Version 3.0' t ASCII 'DATASET RECTILINEAR_GRID' 'DIMENSIONS 2 2 2'
	for axis in X Y Z; do printf '%s\n' "${axis}_COORDINATES 2 float" '0 1'; done
	printf '%s\n' 'POINT_DATA 8' 'SCALARS s float' 'LOOKUP_TABLE default' '1 2 1 2 1 2 1 2'
} >g.vtk
sed 's/1 2 1 2 1 2 1 2/2 1 1 2 2 2 1 1/' g.vtk >h.vtk
printf '%s\n' 'from 3 2 4' 'at .5 .5 .5' 'up 0 0 1' 'angle 30' 'resolution 16 12' 'map 1 1 0 0 1' 'map 2 0 0 1 1' >a.spec
sed 's/^from.*/from -3 2 4/' a.spec >b.spec
run balance ds -v 1 -S hosts -o p%d.png g.vtk h.vtk a.spec b.spec
is 'four pictures of two grids are verified' "$status:$(counts | cut -d ' ' -f 2-):$(echo p?.png)" '0:0 0:p0.png p1.png p2.png p3.png'
balance interleaved -S hosts -s 32x32 -r there.log -o out.png balls.nff
run balance interleaved -v 1 -S hosts -s 32x32 -r there.log -o out.png balls.nff
is 'a log of an earlier run' "$status:$(counts)" '0:32 0 0'
printf 'a via="sh -c %%c"\nb via="exit 127; : %%c"\n' >alone
for v in '' '-v 1'; do
	# shellcheck disable=SC2086
	run balance masterslave $v -S alone -s 16x12 -r alone.log -o out.png balls.nff
done
is 'a log of an earlier run: a host does not check itself' "$status:$(counts)" '1:0 0 12'

# ---- hosts that join and leave -------------------------------------------------------------------------------------
# Of each slot of a, four rows come before b has begun. Then the hosts file is replaced by `file`.
cat >first4 <<'END'
#!/bin/sh
exec perl -e '$| = 1; while (<STDIN>) {
	if (/^task/ && ++$n == 5 && !-e "replaced") { system "touch replaced; mv file hosts" }
	if ($n >= 5) { for (1 .. 600) { last if -s $ENV{UNTIL}; select undef, undef, undef, .1 } }
	print; if (/bytes=(\d+)/) { read STDIN, $b, $1; print $b }
}' | sh -c "$1"
END
chmod +x first4
printf '#!/bin/sh\necho >>begun\nexec sh -c "$1"\n' >begins
# joining B ...: a run that begins on two slots of a; then `file` has lines of this script
joining() {
	rm -f replaced begun lies joins.log out.png
	echo 'a slots=2 via="./first4 %c"' >hosts
	printf '%s\n' "$@" >file
	run balance masterslave -v 1 -S hosts -s 32x32 -r joins.log -o out.png balls.nff
}
export UNTIL=begun
joining 'b via="sh ./begins %c"' 'c via="sh ./begins %c"'
is 'a host leaves, two join: all pieces are checked' "$status:$(counts):$(cmp out.png true.png && echo same)" '0:32 0 0:same'
like 'a host leaves, two join: hosts check each other' "$(echo "$err" | tail -n 1)" 'computed again on another host:'
verify -S hosts 1 joins.log </dev/null >joins.task
is 'a host that has joined does not check itself' "$(awk '
	FNR == NR { if ($1 == "frag") { w = $0; sub(/.* w=/, "", w); slot[$5] = w + 0 } next }
	/^task/ { to = $0; sub(/.*to=/, "", to); if (slot[$5] < 2) old++; else if (slot[$5] == to + 2) self++; else other++ }
	END { print (old >= 8 ? "old" : ""), self + 0, (other ? "other" : "") }' joins.log joins.task)" 'old 0 other'
export UNTIL=lies
joining 'a slots=2 via="./first4 %c"' 'b via="sh -c %c | ./liar 1"' 'c via="sh ./after %c"'
is 'a host that joins and lies: status 1' "$status" 1
like 'a host that joins and lies is named' "$err" '^verify: .*: slot 2 \(host b\) computed other pixels than two other hosts$'
is 'a host that joins and lies: no other is named' "$(echo "$err" | grep '^verify: frame' | grep -vc ': slot 2 (host b) computed other')" 0
echo >ready
export UNTIL=ready
joining 'b via="sh ./begins %c"' 'c via="sh ./begins %c"' 'd slots=none'
is 'a hosts file that becomes wrong: the first one counts' "$status:$(echo "$err" | grep '^balance')" \
	'0:balance: -v: hosts has become unusable: the hosts of the beginning verify'
unset UNTIL

# ---- faults while it verifies ----------------------------------------------------------------------------------------
# Its second start is cut off in the middle.
cat >torn <<'END'
#!/bin/sh
echo >>starts
[ "$(wc -l <starts)" -ne 2 ] || { sh -c "$1" | ./first 2500; exit 9; }
exec sh -c "$1"
END
cat >first <<'END'
#!/usr/bin/perl
$left = shift; # bytes to pass on, at once, unlike head -c
while ($left > 0 && ($n = sysread STDIN, $b, $left)) { syswrite STDOUT, $b; $left -= $n }
END
chmod +x torn first
three './torn %c'
run balance interleaved -v 1 -S hosts -s 32x32 -o out.png balls.nff
is 'a worker that is lost leaves its share to others' "$status:$(counts):$(cmp out.png true.png && echo same)" '0:32 0 0:same'
printf '#!/bin/sh\nsleep 1\nexec sh -c "$1"\n' >late && chmod +x late
three './late %c'
run balance interleaved -v 1 -S hosts -s 32x32 -o out.png balls.nff
is 'a slow host' "$status:$(counts)" '0:32 0 0'

# ---- a host that hangs while it verifies -----------------------------------------------------------------------------
# The first FIRST starts of all hosts are good. A later one sends its hello when COUNT have started; then it hangs, by KIND,
# or it is good.
cat >later <<'END'
#!/bin/sh
# later KIND FIRST COUNT COMMAND
echo >>starts
[ "$(wc -l <starts)" -gt "$2" ] || exec sh -c "$4"
until [ "$(wc -l <starts)" -ge "$3" ]; do sleep .02; done
case $1 in
good) # a task takes a while, so that no slot has done all before another one is up
	perl -e '$| = 1; while (<STDIN>) { select undef, undef, undef, .05 if /^task/; print; if (/bytes=(\d+)/) { read STDIN, $b, $1; print $b } }' |
		sh -c "$4" ;;
beats) # reads all, and is always at work
	sh -c "$4" </dev/null | head -n 1
	while echo beat; do sleep .5; done &
	exec cat >/dev/null ;;
deaf) # the same, but reads nothing
	sh -c "$4" </dev/null | head -n 1
	while echo beat; do sleep .5; done ;;
trickle) # a byte of its answer at a time
	sh -c "$4" | { dd bs=4096 count=1 2>/dev/null; while b=$(dd bs=1 count=1 2>/dev/null | od -An -to1) && [ "$b" ]; do
		printf "\\${b# }" && sleep 1
	done; } ;;
hold) sh -c "$4" | { dd bs=4096 count=1 2>/dev/null; while echo beat; do sleep .5; done; } ;;
esac
END
chmod +x later
printf '%s\n' 'a via="./later good 5 10 %c"' 'b via="./later beats 5 10 %c"' 'c via="./later deaf 5 10 %c"' \
	'd via="./later trickle 5 10 %c"' 'e via="./later good 5 10 %c"' >hosts
rm -f starts out.png
run env MARK="$mark" timeout 1200 balance interleaved -v 1 -S hosts -s 32x32 -o out.png balls.nff
is 'beats, deaf, trickle: the two others check all' "$status:$(counts):$(cmp out.png true.png && echo same)" '0:32 0 0:same'
is 'beats, deaf, trickle: one wait' "$(echo "$err" | grep -c '^verify: no fragment came for [0-9]* s: the missing ones are not waited for$')" 1
ok 'beats, deaf, trickle: no process remains' await 10 none_alive
# The pixels of b are wrong both in the picture and in its checks.
printf '%s\n' 'a via="./later good 3 6 %c"' 'b via="./later beats 3 6 %c"' 'c via="./later good 3 6 %c | ./liar 1"' \
	'd via="sh -c %c"' >hosts
rm -f starts lies
run env MARK="$mark" timeout 1200 balance interleaved -v 1 -S hosts -s 32x32 -o out.png balls.nff
is 'beats, and a liar: status, and pieces that could not be checked' "$status:$(counts | cut -d ' ' -f 3)" 1:0
like 'beats, and a liar: the liar is named' "$err" ': slot 2 \(host c\) computed other pixels than two other hosts$'
like 'beats, and a liar: no other slot is named' "$(echo "$err" | grep -c 'slot [013]')" '^0$'
ok '... no process remains' await 10 none_alive

# verify -t passes its input on, and does not wait for ever for more.
balance interleaved -j 2 -s 32x32 -r long.log -o out.png balls.nff
run sh -c '{ cat long.log; until [ -e over ]; do echo beat; sleep .1; done; } | { verify -t 1 long.log; s=$?; echo >over; exit $s; }'
like 'verify -t: beats do not count as fragments' "$status:$err" \
	'^1:verify: no fragment came for [0-9]+ s: the missing ones are not waited for$' # 1 s, and some of its longest task
grep -av '^beat$' "$tmp/.out" | cmp -s - long.log
is 'verify -t: all records are passed on' $? 0
run verify -t 1000 long.log <long.log
cmp -s "$tmp/.out" long.log
is 'verify -t: it waits for the end of the input' "$?:$status:$err" 0:0:
for odd in missing /; do
	run verify -t 1 $odd </dev/null
	like "verify -t: a log that cannot be read: $odd" "$status:$err" "^[23]:verify: $odd: (No such file|Is a directory)"
done
run verify -t 1 long.log </
like 'verify -t: an input that cannot be read' "$status:$err" '^3:verify: standard input: Is a directory'

# ---- files and processes that remain -----------------------------------------------------------------------------------------------
mkdir temporary
# The output of two starts is cut off; later ones send nothing.
cat >part <<'END'
#!/bin/sh
echo >>parted
[ "$(wc -l <parted)" -gt 2 ] || sh -c "$1" | ./first 3500
exit 9
END
chmod +x part
printf '%s\n' 'a via="./part %c"' 'b via="./part %c"' >parts
run env TMPDIR="$tmp/temporary" balance interleaved -z off -v 1 -S parts -s 32x32 -o out.png balls.nff
log=$(ls temporary/*/log)
like 'an incomplete picture: the log stays, and a message says so' "$status:$err" "^balance: .*/$log is kept: .* -r .*/$log "
run balance interleaved -v 1 -j 2 -r "$log" -s 32x32 -o out.png balls.nff
is 'an incomplete picture: a run resumes from the log' "$status:$(counts | cut -d ' ' -f 2-):$(cmp out.png true.png && echo same)" '0:0 0:same'
rm -r temporary/*
printf '%s\n' 'a via="sh -c %c"' 'b via="sh -c %c"' >two
for refused in '-k 9' '-r balls.nff'; do
	# shellcheck disable=SC2086
	run env TMPDIR="$tmp/temporary" balance interleaved -v 1 -S two -s 32x32 $refused -o out.png balls.nff
	is "$refused: status, and nothing stays" "$status:$(ls temporary)" 2:
done
# signalled PASS SIGNAL HOLD [-]: no file and no process remains after a signal in this pass, to balance or to its group. In
# the group gather may see first that the workers have ended, and says so; but it does not name the log, which is removed.
first_pass() { [ -s "$(echo temporary/*/log)" ]; }
second_pass() { [ -e "$(echo temporary/*/1)" ] && [ "$(wc -l <starts)" -eq 4 ]; }
signalled() {
	printf '%s\n' "a via=\"./later hold $3 0 %c\"" "b via=\"./later hold $3 0 %c\"" >two
	rm -f starts
	MARK="$mark" TMPDIR="$tmp/temporary" perl -e '$SIG{INT} = "DEFAULT"; setpgrp; exec @ARGV' \
		balance interleaved -v 1 -S two -s 32x32 -o out.png balls.nff 2>said &
	of=$!
	ok "$2 in the $1 pass${4:+, to all}: the pass has begun" await 10 "$1_pass"
	kill -"$2" "${4-}$of"
	wait $of
	is "$2 in the $1 pass${4:+, to all}: status, messages and files" "$?:$(grep -v '^fan: ' said | grep "${4:+temporary}"):$(ls temporary)" 130::
	ok "$2 in the $1 pass${4:+, to all}: no process remains" await 10 none_alive
}
for signal in INT TERM; do
	signalled first $signal 0
	signalled second $signal 2
	signalled first $signal 0 -
done
finish
