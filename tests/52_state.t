#!/bin/sh
# State that changes in a stream: two scenes and their frames, one after the other. Every task is rendered with the
# scene before it, in every slot, however late the slot comes up and however often the task is given.
. "$(dirname "$0")/lib.sh"
patient
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others

spdgen -s 2 gears >gears.nff
spdgen -s 2 tetra >tetra.nff
partition 64x48 | rtworker -a 9 gears.nff | gather -o good0.pfm
partition 48x64 | rtworker -a 9 tetra.nff | gather -o good1.pfm
# film [PARTITION-OPTION ...]
film() { pack scene gears.nff; partition -F 0 "$@" 64x48; pack scene tetra.nff; partition -F 1 "$@" 48x64; }
film >film.task
# both NAME [COMMAND ...]: the two pictures are right, and no program prints a message
both() {
	ok "$1: the first picture" cmp f0.pfm good0.pfm
	ok "$1: the second picture" cmp f1.pfm good1.pfm
	is "$1: no message" "$(grep -v 'never connected$' said)" ''
	rm -f f?.pfm
}
for command in 'rtworker -a 9 -' 'fan -j 3 rtworker -a 9 -' 'fan -j 3 rtworker -c -a 9 -' 'deal fan -j 3 rtworker -a 9 -' \
	'deal -q 4 fan -j 3 rtworker -c -a 9 -' 'deal -e -q auto fan -j 3 rtworker -f 20 -a 9 -' 'deal rtworker -a 9 -' \
	'deal fan -j 2 deal fan -j 2 rtworker -a 9 -' 'fan -j 2 deal -q 1 fan -j 2 rtworker -c -a 9 -' \
	'deal -q 3 deal fan -j 2 rtworker -a 9 -' 'ringctl fan -j 3 ringctl -n rtworker -c -a 9 -' \
	'ringctl -p fan -j 3 ringctl -n rtworker -a 9 -' \
	'ringctl fan -j 2 ringctl -n deal fan -j 2 rtworker -a 9 -'; do
	# shellcheck disable=SC2086
	timeout 1200 $command <film.task 2>said | gather -o f%d.pfm 2>>said
	both "$command"
done
film -n 3 | deal fan -j 3 rtworker -a 9 - 2>said | gather -o f%d.pfm 2>>said
both 'deal, preassigned'

# Grid and specs come as several records, and more than two states.
{ film; pack scene gears.nff gears.nff; partition -F 2 64x48; } | deal fan -j 2 rtworker -a 9 - 2>said | gather -o f%d.pfm 2>>said
ok 'a third state, said twice: its picture' cmp f2.pfm good0.pfm
both 'a third state, said twice'

# ---- a slot dies on the first frame, when the second scene has been read ------------------------------------
cat >mortal <<'END'
mkdir dead 2>/dev/null || exec rtworker -a 9 -
rtworker -a 9 - | dd bs=1 count=3000 2>/dev/null
END
film -n 3 | deal fan -j 3 sh mortal 2>said | tee log | gather -o f%d.pfm 2>>said
like 'a slot dies: a message says so' "$(cat said)" 'lost \(exit-0\)'
ok 'a slot dies: its tasks are given again' grep -aq 'done 0 .* try=2' log
: >said
both 'a slot dies'

# ---- a slot comes late ----------------------------------------------------------------------------------------
printf '#!/bin/sh\nuntil [ -e "$1" ]; do sleep .05; [ -e hosts ] || exit; done; exec sh -c "$2"\n' >late
chmod +x late
printf ': slots=1\nlate via="./late f0.pfm %%c"\n' >hosts
# after the first picture, and before any task of the second: the slot comes up
up() { timeout 800 sh -c 'until grep -aq "up w=1 " "$1"; do sleep .05; done' up "$1"; }
mkdir seen
: >seen/frags
{
	pack scene gears.nff
	partition -F 0 64x48
	pack scene tetra.nff
	up seen/frags
	partition -F 1 48x64
} 2>/dev/null | deal sh -c 'fan -S hosts rtworker -a 9 - | tee seen/frags' 2>said | gather -o f%d.pfm 2>>said
count() { grep -ao "$1" seen/frags | wc -l; }
ok 'a slot comes late: it does its part of the second frame' [ "$(count 'done 1 [0-9]* cpu_us=[0-9]* wall_us=[0-9]* w=1 ')" -gt 0 ]
is 'a slot comes late: it gets both frames' "$(count 'frame [01] [0-9 ]*job=[^ ]* with=[^ ]* w=1')" 2
both 'a slot comes late'
printf '#!/bin/sh\nsleep 1; exec sh -c "$1"\n' >slow
chmod +x slow
printf ': slots=1\nlate via="./slow %%c"\n' >hosts
film | fan -S hosts rtworker -a 9 - 2>said | gather -o f%d.pfm 2>>said
both 'a slot comes late, and has tasks of both'

# ---- resumed by slots that come up after all tasks of the first frame ------------------------------------
film | fan -j 2 rtworker -a 9 - | gather -r whole -o f%d.pfm
rm -f f?.pfm
printf 'late slots=2 via="./slow %%c"\n' >hosts
for percent in 10 60 90; do
	head -c $(($(wc -c <whole) * percent / 100)) whole >log
	{ pack scene gears.nff; partition -F 0 -r log 64x48; pack scene tetra.nff; partition -F 1 -r log 48x64; } >rest.task
	deal fan -S hosts rtworker -a 9 - <rest.task 2>said | gather -r log -o f%d.pfm 2>>said
	sed -i '/damaged record/d; /never connected/d' said # where the log was cut; what is left may be little
	both "a log cut at $percent %, gone on with by slots that come late"
done

# ---- impossible runs ----------------------------------------------------------------------------------------------
run sh -c '{ pack scene gears.nff; partition 16x12; pack scene tetra.nff; echo nonsense; } | deal fan -j 2 rtworker - >/dev/null'
is 'nonsense behind state that waits: exit 2' "$status" 2
printf 'gone tries=1 via="exit 9; %%c"\n' >none
run sh -c 'timeout 800 deal fan -S none rtworker - <film.task | gather -o f%d.pfm'
is 'state that waits while no slot is left: exit 3' "$status" 3
finish
