#!/bin/sh
# One scene from several sides, by view records: each picture has the bits of the scene whose own view is that one,
# whatever the chain, and the hierarchy is built once.
# shellcheck disable=SC2154  # lib.sh sets them
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
patient
w=40 h=30
spdgen -s 2 gears >scene.nff
spdgen -s 2 balls >other.nff
printf '%s\n' 'from 4 -3 2' 'at 0 0 0' 'up 0 0 1' 'angle 30' 'hither 3.5' "resolution $w $h" >0.view
printf '%s\n' '# far away' 'from -4000 -3000 2500' 'at .1 0 0' 'up 0 1 1' 'angle .03' >1.view
printf '%s\n' 'up 0 0 1 angle 80 from .3 .2 .1 at 0 0 0' >2.view
# replaced SCENE VIEW: the scene with that view in the place of its own
replaced() {
	awk '/^(from|at|up|angle|hither|resolution) / { next } { print }
		/^v$/ { while ((getline line <view) > 0) print line; print wide }' view="$2" \
		wide="$(grep -q resolution "$2" || echo "resolution $w $h")" "$1"
}
for f in 0 1 2; do
	replaced scene.nff $f.view >scene$f.nff
	replaced other.nff $f.view >other$f.nff
	for scene in scene other; do partition ${w}x$h | rtworker $scene$f.nff | gather -o $scene$f.pfm; done
done
ok 'the sides differ' sh -c '! cmp scene0.pfm scene1.pfm && ! cmp scene1.pfm scene2.pfm && ! cmp scene2.pfm scene0.pfm'
cut=''
# films FRAME:SCENE:VIEW ...: a stream; a scene or view - is that of the frame before. $cut: options of partition
films() {
	for film; do
		f=${film%%:*} view=${film##*:} scene=${film#*:} && scene=${scene%:*}
		[ "$scene" = - ] || pack scene "$scene.nff"
		[ "$view" = - ] || pack view "$view.view"
		# shellcheck disable=SC2086
		partition -F "$f" $cut ${w}x$h
	done
}
# right NAME PICTURE ...: frames 0, 1 ... have these bits
right() {
	name=$1 f=0 wrong=''
	shift
	for picture; do cmp f$f.pfm "$picture.pfm" >>said 2>&1 || wrong="$wrong $f"; f=$((f + 1)); done
	is "$name" "$wrong$(grep -v 'never connected$' said)" ''
	rm -f f?.pfm
}
films 0:scene:0 1:-:1 2:-:2 3:other:- 4:-:0 >film.task
for command in 'rtworker' 'rtworker -j 2' 'rtworker -c' 'fan -j 3 rtworker -b slabs' 'fan -1 -j 2 rtworker' 'deal fan -j 3 rtworker' \
	'deal -e -q auto fan -1 -j 2 rtworker -f 20' 'ringctl fan -j 3 ringctl -n rtworker' 'deal fan -j 2 deal fan -j 2 rtworker'; do
	# shellcheck disable=SC2086
	timeout 600 $command <film.task 2>said | gather -o f%d.pfm 2>>said
	right "$command" scene0 scene1 scene2 other2 other0
done

# Tasks of an earlier view come after later views: the eye goes to and fro between near and far.
{ pack scene scene.nff; for f in 0 1 2; do pack view $f.view; echo "frame $f $w $h"; done; } >mixed.task
for f in 0 1 2; do partition -F $f ${w}x$h | grep '^task'; done | sort -n -k 3 >>mixed.task
for command in rtworker 'rtworker -j 2'; do
	$command <mixed.task 2>said | gather -o f%d.pfm 2>>said
	right "$command, mixed" scene0 scene1 scene2
done

# ---- a slot is lost, and one comes late ------------------------------------------------------------------------
cat >mortal <<'END'
mkdir dead 2>/dev/null || exec rtworker
rtworker | dd bs=1 count=3000 2>/dev/null
END
cut='-n 3'
films 0:scene:0 1:-:1 2:-:2 3:other:- 4:-:0 | deal fan -j 3 sh mortal 2>said | gather -o f%d.pfm 2>>said
like 'a lost slot: a message says so' "$(cat said)" 'lost \(exit-0\)'
: >said
right 'a lost slot' scene0 scene1 scene2 other2 other0
cut=''
printf '#!/bin/sh\nuntil [ -e f1.pfm ]; do sleep .05; [ -e late ] || exit; done; exec sh -c "$1"\n' >late
chmod +x late
printf ': slots=1\nlate via="./late %%c"\n' >hosts
{
	films 0:scene:0 1:-:1 2:-:2
	until [ -e f2.pfm ]; do sleep .05; done
	films 3:other:- 4:-:0
} | deal fan -S hosts rtworker 2>said | gather -o f%d.pfm 2>>said
right 'a late slot' scene0 scene1 scene2 other2 other0

# ---- balance ---------------------------------------------------------------------------------------------------
for method in adaptive gdc interleaved; do
	run timeout 600 balance $method -j 2 -s ${w}x$h -o f%d.pfm scene.nff other.nff ?.view
	echo "$err" >said
	right "balance $method: two scenes, three views" scene0 scene1 scene2 other0 other1 other2
done
balance adaptive -j 2 -v .5 -s ${w}x$h -r log -o f%d.pfm scene.nff ?.view 2>said
is 'balance -v: no pixel differs' "$(grep -c '^verify: .*: 0 differ, 0 could not' said)" 1
: >said
right 'balance -v' scene0 scene1 scene2
head -c $(($(wc -c <log) / 2)) log >half
balance adaptive -j 2 -s ${w}x$h -r half -o f%d.pfm scene.nff ?.view 2>said
sed -i '/damaged record/d' said
right 'balance -r, half done' scene0 scene1 scene2
run balance adaptive -j 2 -o f%d.png scene.nff 0.view 1.view
is 'the size is that of the view, or else that of the scene' "$status$err $(for f in 0 1; do
	od -An -tu1 -j16 -N8 f$f.png | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }'
done | tr '\n' ' ')" "0 ${w}x$h 512x512 "
run balance adaptive -j 2 -o one.png scene.nff 0.view 1.view
like 'several views: one name' "$status $err" '^2 job: 2 pictures, expected -o with %d'
printf 'from 1 2 3\nat 1 2 3\nup 0 0 1\nangle 20\n' >bad.view
run balance adaptive -j 2 -o f%d.png scene.nff 0.view bad.view
is 'a bad view' "$status $err" '2 rtworker: bad.view:5: view: from and at are the same point, expected two'
run balance adaptive -j 2 -o f.png 0.view
like 'a view alone' "$status $err" '^2 job: 0.view: is a view or a specification, expected a scene or a grid before it'

# ---- rtworker --------------------------------------------------------------------------------------------------
rtworker -i scene.nff >own
rtworker -i scene.nff ?.view >all
is 'rtworker -i: a line for each view' "$(grep '^frame' all | tr '\n' ' ')" "frame $w $h frame 512 512 frame 512 512 "
is 'rtworker -i: each has a job of its own' "$(cat own all | grep '^job=' | sort -u | wc -l)" 4
partition ${w}x$h | rtworker scene.nff 1.view 2>said | gather -o f0.pfm 2>>said
right 'scene and view as files' scene1
films 0:-:0 1:-:2 | rtworker scene.nff 2>said | gather -o f%d.pfm 2>>said
right 'the scene as a file, views as records' scene0 scene2
is 'rtworker -n: the rays of the view' "$(rtworker -n -s ${w}x$h scene.nff 2.view)" "$(rtworker -n -s ${w}x$h scene2.nff)"
run sh -c '{ pack view 0.view; partition 4x4; } | rtworker >/dev/null'
is 'a view without a scene' "$status $err" '2 rtworker: no scene, expected a `scene` record before the first task'
run sh -c 'pack view 0.view | rtworker scene.nff 1.view >/dev/null'
like 'a view where it is a file already' "$status $err" '^2 rtworker: record .view., expected no state records'
run sh -c '{ pack scene scene.nff; pack view bad.view; partition 4x4; } | rtworker >/dev/null'
is 'a bad view in a record' "$status $err" '2 rtworker: view:5: view: from and at are the same point, expected two'

# ---- it is built once: three states alive take little more memory than one --------------------------------------
spdgen -s 6 gears >scene.nff
for n in 1 3; do
	rm -f in && mkfifo in && : >frags
	MARK=$mark rtworker <in >frags &
	exec 9>in
	{ pack scene scene.nff; for f in $(seq $n); do pack view $((f % 3)).view; partition -F "$f" 8x8; done; } >&9
	await 20 grep -aq "^done $n 7 " frags
	awk '/^VmHWM/ { print $2 }' /proc/$!/status >kib$n
	exec 9>&-
	wait $!
done
ok "views share what was built: $(cat kib1) and $(cat kib3) KiB" [ "$(cat kib3)" -lt $(($(cat kib1) * 5 / 4)) ]
finish
