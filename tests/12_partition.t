#!/bin/sh
# partition: decreasing chunks against the numbers that their papers print; orders; no cut and no order changes the
# picture.
. "$(dirname "$0")/lib.sh"

# sizes OPTIONS: rows of each task of 100
# shellcheck disable=SC2046,SC2154
sizes() { partition "$@" 8x100 | awk '$1 == "task" { printf "%s ", $7 }'; }
is 'guided: Polychronopoulos and Kuck, 100 iterations, 5 processors' "$(sizes -u guided -n 5)" \
	'20 16 13 11 8 7 5 4 4 3 2 2 1 1 1 1 1 '
is 'factoring: Hummel, Schonberg and Flynn, 100 iterations, 4 processors' "$(sizes -u factoring -n 4)" \
	'13 13 13 13 6 6 6 6 3 3 3 3 2 2 2 2 1 1 1 1 '
is 'weighted factoring: the first batch by power, later ones for the weakest' "$(sizes -u factoring -w 1,3,1 | cut -d' ' -f1-8)" \
	'10 30 10 5 5 5 5 5'
is 'weighted factoring: only the first batch is preassigned' \
	"$(partition -u factoring -w 1,3,1 8x100 | grep -c 'to=[0-2]$')" 3
is 'POWER*SLOTS: slots of equal power' "$(partition -w '1*2,2' 8x8)" "$(partition -w 1,1,2 8x8)"
for powers in '1*0' '1*' '1*1000001' '1*2*2'; do
	run partition -w "$powers" 8x8
	like "refused: -w $powers" "$status $err" '^2 partition: -w .*expected powers .*or POWER[*]SLOTS'
done
is 'guided:N: chunks of whole runs, and the rest as the last one' \
	"$(partition -u guided:30 -n 2 10x10 | awk '$1 == "task" { printf "%s ", $6 }')" '60 30 10 '

is 'fine: 150 tasks per slot, or rows' \
	"$(for slots in 1 2; do partition -u fine -n $slots 8x200 | awk '/^task/ { print $6 $10; exit }'; done | paste -s -d ' ')" '8to=0 5to=0'
is 'coarse: 150 tasks per slot, or N; with -c 0 no task has a slot' \
	"$(for slots in 1 2; do partition -u coarse:9 -n $slots -c 0 8x200 | awk '/^task/ { print $6 $10; exit }'; done | paste -s -d ' ')" '10 9'
is 'each of several pictures is cut by its own size' \
	"$(printf 'frame 0 8 8\nframe 1 8 400\n' | partition -u coarse:2 -n 1 -c 0 8x8@- | awk '/^task/ && !n[$2]++ { printf "%s ", $6 }')" '2 21 '

spdgen -s 2 tetra >tetra.nff
partition 40x32 | rtworker tetra.nff | gather -o rows.pfm
partition 10x8 | rtworker tetra.nff >coarse.frags
same() { partition "$@" 40x32 >tasks && rtworker tetra.nff <tasks | gather -o other.pfm && imgcmp rows.pfm other.pfm; }
for cut in 'fine -n 3' 'coarse:7 -w 1,2' 'guided -n 3' 'guided:7 -n 3' 'factoring -n 3' 'factoring:50 -w .5,2' 'guided -n 100' 'factoring:1000000 -n 3'; do
	# shellcheck disable=SC2086
	ok "-u $cut: every pixel once" same -u $cut
done
for order in sample cost:coarse.frags; do
	ok "-o $order: every pixel once" same -o $order
	ok "-o $order: the same numbers for the same pixels" sh -c "partition -o $order 40x32 | sort >a; partition 40x32 | sort | cmp - a"
done

is 'sample: one task of eight first, evenly spread' "$(partition -o sample 4x40 | awk '/^task/ { printf "%s ", $3 }' | cut -c 1-34)" '4 12 20 28 36 0 1 2 3 5 6 7 8 9 10'
# Prints the number of tasks in each pass from top to bottom.
passes() { partition -o sample "$1" | awk '/^task/ { if ($3 < last) { print n; n = 0 } last = $3; n++ } END { print n }' | tr '\n' ' '; }
is 'sample: three passes' "$(passes 4x10000)" '32 64 128 9776 '
is 'sample: at most a quarter in all' "$(passes 4x384) $(passes 4x380)" '32 64 288  32 348 '
is 'sample: evenly spread' "$(partition -o sample 4x10240 | awk '/^task/ && ++n <= 224 { print $3 % 40, $3 % 320 != 0 }' | sort | uniq -c | sed 's/^ *//')" '224 0 1'
is 'sample: a frame of few tasks' "$(partition -o sample 4x7 | awk '/^task/ { printf "%s ", $3 }')" '0 1 2 3 4 5 6 '
# A log made by hand: row 1 of 2 costs more. Of 4 rows the lower two come first.
{
	echo 'frame 0 1 2 job=1'
	for y in 0 1; do
		printf 'frag 0 %d 0 %d 1 1 1 1 job=1 ch=4 crc=%s bytes=16\n' $y $y 3971697493
		head -c 16 /dev/zero
		echo
		echo "done 0 $y cpu_us=$((10 + 90 * y)) wall_us=1"
	done
} | "$root/tests/seal" >two.frags
is 'cost: the longest tasks first, equal ones in their order' \
	"$(partition -o cost:two.frags 3x4 | awk '$1 == "task" { printf "%s ", $3 }')" '2 3 0 1 '
is 'cost: slots take turns in the new order' \
	"$(partition -n 2 -o cost:two.frags 3x4 | awk '$1 == "task" { printf "%s ", $3 $10 }')" '2to=0 3to=1 0to=0 1to=1 '

refused() { run partition "$@"; [ "$status" = 2 ] && [ -z "$out" ]; }
: >empty
ok 'refused: guided without slots' refused -u guided 8x8
ok 'refused: guided with powers' refused -u guided -w 1,2 8x8
ok 'refused: fine without slots' refused -u fine 8x8
ok 'refused: coarse without slots' refused -u coarse:9 8x8
ok 'refused: factoring without slots' refused -u factoring 8x8
ok 'refused: chunks in another order' refused -u guided -n 2 -o sample 8x8
ok 'refused: chunks and a count' refused -u factoring -n 2 -c 3 8x8
ok 'refused: chunks of nothing' refused -u guided:0 -n 2 8x8
ok 'refused: an unknown order' refused -o shuffle 8x8
ok 'refused: costs without a log' refused -o cost: 8x8
ok 'refused: costs of a log that is not there' refused -o cost:none 8x8
ok 'refused: costs of a log that holds none' refused -o cost:empty 8x8

# ---- many pictures, and shares of each -----------------------------------------------------------------------
echo hello >state
{ pack spec state; echo 'frame 3 8 6'; echo 'frame 4 4 2'; pack scene state; echo 'frame 5 8 6'; } >pictures
{ pack spec state; partition -F 3 8x6; partition -F 4 4x2; pack scene state; partition -F 5 8x6; } >apart
partition 8x6@pictures >together
ok 'many pictures: the tasks are those of single pictures' cmp together apart
partition 8x6@- <pictures >together
ok 'many pictures: the same from standard input' cmp together apart
{ partition -u guided -n 2 -F 3 8x6; partition -u guided -n 2 -F 4 4x2; } >apart
grep -a '^frame [34]' pictures | partition -u guided -n 2 8x6@- >together
ok 'chunks are computed for each frame' cmp together apart
is '-c N/M assigns N of each M tasks' "$(partition -n 2 -c 1/3 8x7 | grep -c to=)" 2
refused() { run partition "$@" </dev/null; [ "$status" = 2 ]; }
ok 'refused: more than all' refused -n 2 -c 4/3 8x8
ok 'refused: of none' refused -n 2 -c 0/0 8x8
ok 'refused: a number for many pictures' refused -F 1 8x6@pictures
ok 'refused: no such file' refused 8x6@none
ok 'refused: no file' refused 8x6@
partition 8x6 >tasks
run partition 8x6@tasks
like 'refused: tasks' "$status $err" '^2 partition: tasks: record .task., expected state and frames'
finish
