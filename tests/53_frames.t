#!/bin/sh
# Frames of a stream, each with its own scene. Idle slots start the next frame; no slot waits at the end of a frame for
# the slowest one. The first worker here holds its first task of frame 0 until a condition is true that needs the
# others to render frame 1.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
. "$(dirname "$0")/lib.sh"
patient
trap 'touch "$tmp/over"; rm -rf "$tmp"' EXIT

spdgen -s 1 balls >0.nff
spdgen -s 1 tetra >1.nff
cp "$root/scenes/boat.nff" 2.nff
for f in 0 1 2; do partition 40x32 | rtworker -a 4 $f.nff | gather -o good$f.pfm; done
for f in 0 1 2; do pack scene $f.nff && partition -F $f 40x32; done >three
cat >tell <<'END'
#!/bin/sh
# until COMMAND ...: waits for it, or for the end of the test
until "$@"; do [ -e "$0" ] && [ ! -e over ] || exit 1; sleep .02; done
END
mv tell until
# held UNTIL AFTER: a worker. The first one that starts gets no task of frame 0 before the command UNTIL succeeds, and then
# runs AFTER. The others get no task before the first one holds.
cat >held <<'END'
#!/bin/sh
mkdir first 2>/dev/null && place=first || place=other
while IFS= read -r line; do
	case $place,$line in
	first,'task 0 '*) touch holds; ./until $1 && $2 || exit ;;
	other,'task '*) ./until test -e holds || exit ;;
	esac
	printf '%s\n' "$line"
done | rtworker $options -a 4 -
END
chmod +x held until
export options=''
# right NAME FRAMES: the pictures are right
right() {
	f=0
	while [ $f -lt "$2" ]; do
		ok "$1: picture $f" cmp f$f.pfm good$((f % 3)).pfm
		f=$((f + 1))
	done
}
# held_by NAME UNTIL COMMAND ...: renders three frames with these workers
held_by() {
	name=$1 until=$2
	shift 2
	rm -rf first holds f?.pfm
	: >log # commands that look into it may be there before tee is
	run timeout 1200 sh -c 'until=$1; shift; "$@" sh ./held "$until" : <three | tee log | gather -o f%d.pfm' sh "$until" "$@"
	is "$name: complete" "$status $(echo "$err" | grep -v 'never connected$')" '0 '
	right "$name" 3
}
# Conditions that are true only if the others render the second frame while a task of the first is open.
whole='test -e f1.pfm' begun='grep -aq done.1 log'

held_by 'deal' "$whole" deal fan -t 60 -j 2
held_by 'deal, three slots' "$whole" deal -q 2 fan -t 60 -j 3
held_by 'a tree' "$whole" deal fan -t 60 -j 2 deal fan -t 60 -j 2
held_by 'a tree of lone workers' "$whole" deal -q 1 fan -t 60 -j 3 deal
held_by 'ring' "$whole" ringctl fan -t 60 -j 2 ringctl -n
held_by 'ring, three nodes' "$whole" ringctl fan -t 60 -j 3 ringctl -n
held_by 'ring as published' "$begun" ringctl -p fan -t 60 -j 2 ringctl -n
held_by 'static' "$begun" fan -t 60 -j 2
options=-c
held_by 'deal, concentrated' "$begun" deal fan -t 60 -j 2
held_by 'ring, concentrated' "$begun" ringctl fan -t 60 -j 2 ringctl -n
held_by 'static, concentrated' "$begun" fan -t 60 -j 2
options=''

# ---- a 129th state waits -------------------------------------------------------------------------------------
mv three short
{
	pack scene 0.nff && partition -F 0 40x32
	for n in $(seq 10 135); do pack scene 1.nff && partition -F "$n" 8x1; done
	for f in 1 2; do pack scene $f.nff && partition -F $f 40x32; done
} >three
# order: on the way down, the tasks of frame 1, of state 128, come before the next state
order() { grep -a '^scene \|^task 1 ' down | awk '$1 == "scene" { n++ } $1 == "task" && n > 128 { exit 1 }'; }
for policy in deal ringctl; do
	node=''
	[ "$policy" = deal ] || node='ringctl -n'
	# shellcheck disable=SC2086
	held_by "$policy, a 129th state" "$whole" $policy sh -c 'tee down | fan -t 60 -j 2 '"$node"' "$@"' sh
	ok "$policy: it goes no further while there is a task of the first" order
	is "$policy: all went down" "$(grep -ac '^scene ' down)" 129
done

mv short three

# ---- a slot dies with a task of the first frame, when the others have done the second -------------------------------
for command in 'deal fan -t 60 -j 2' 'deal -e fan -t 60 -j 3' 'ringctl fan -t 60 -j 3 ringctl -n' \
	'deal fan -t 60 -j 2 deal fan -t 60 -j 2'; do
	rm -rf first holds log f?.pfm
	# shellcheck disable=SC2086
	run timeout 1200 sh -c 'until=$1; shift; "$@" sh ./held "$until" "exit 9" <three | tee log | gather -o f%d.pfm' sh "$whole" $command
	# If others take a late task over, the run may be done before the slot dies.
	case $command in
	ringctl* | *' -e '*) ;;
	*) like "$command, a slot dies: a message says so" "$err" 'lost \(exit-.\) with [1-9][0-9]* tasks' ;;
	esac
	is "$command, a slot dies: complete" "$status" 0
	right "$command, a slot dies" 3
	ok "$command, a slot dies: what it had is given again" grep -aq 'done 0 [0-9]* [a-z_=0-9 .]*try=[2-9]' log
done

# ---- it is killed, and its task goes to a slot that came up after the next state ----------------------------
# Slot 0 holds a task of frame 0; slot 1 does the rest of both and is gone; slot 2 comes, and then slot 0 dies.
cat >plan <<'END'
#!/bin/sh
case $1 in
0) exec ./held ./seen 'exit 9' ;;
1) exec 3<&0; ./until test -e holds; rtworker -a 4 - <&3 & ./until test -e f1.pfm; kill $!; exit 9 ;;
2) ./until grep -aq 'gone w=1 ' log; exec rtworker -a 4 - ;;
esac
END
printf '#!/bin/sh\ngrep -aq "^up w=2 " log && grep -aqE "^frame 1 .* w=0([.]0)? " log\n' >seen
chmod +x plan seen
for slot in 0 1 2; do echo "host$slot via=\"./plan $slot; : %c\""; done >hosts
late() {
	rm -rf first holds f?.pfm
	: >log
	run timeout 1200 sh -c '"$@" <three | gather -o f%d.pfm' sh "$@"
	is "$name: complete" "$status" 0
	right "$name" 3
	like "$name: slots up from the start get both frames in order" \
		"$(grep -aoE 'frame [0-9] 40 32 job=[^ ]* with=[^ ]* w=0(\.0)? ' log | cut -d ' ' -f 2 | tr '\n' ' ')" '0 1 '
	like "$name: it is sent first a later state, then the one that it needs, and the later ones again" \
		"$(grep -aoE 'frame [0-9] 40 32 job=[^ ]* with=[^ ]* w=2(\.0)? ' log | cut -d ' ' -f 2 | tr '\n' ' ')" '[12] 0 1 '
}
name='a late slot' && late deal sh -c 'fan -z off -t 60 -S hosts rtworker | tee log'
# The same, if each slot is a policy around other slots.
sed -i 's,exec ./held,exec deal sh ./held,; s,; rtworker,; deal rtworker,; s,exec rtworker,exec deal fan -j 1 rtworker,' plan
name='a late slot that is a tree' && late deal sh -c 'fan -z off -t 60 -S hosts deal rtworker | tee log'

# ---- held pixels are sent at the first task of another state: the input stays open until they have come --------
rm -f f?.pfm
run timeout 1200 sh -c '{ cat three; ./until test -e f0.pfm; } | fan -j 2 rtworker -c -a 4 - | gather -o f%d.pfm'
is 'concentrated: the first picture does not wait for the end' "$status $err" '0 '
right 'concentrated' 3

# ---- frames of two states, mixed ----------------------------------------------------------------------------------------
{ pack scene 0.nff; echo 'frame 0 40 32'; pack scene 1.nff; echo 'frame 1 40 32'; } >mixed
for f in 0 1; do partition -F $f 40x32 | grep task; done | sort -n -k 3 >tasks
cat tasks >>mixed
for command in 'rtworker -a 4 -' 'rtworker -c -a 4 -' 'fan -j 2 rtworker -a 4 -' 'deal fan -j 2 rtworker -a 4 -' \
	'ringctl fan -j 2 ringctl -n rtworker -a 4 -'; do
	rm -f f?.pfm
	run timeout 1200 sh -c "$command <mixed | gather -o f%d.pfm"
	is "$command, mixed: complete" "$status $err" '0 '
	right "$command, mixed" 2
done
{ cat mixed; for n in $(seq 2 129); do pack scene 2.nff; echo "frame $n 40 32"; done; head -n 1 tasks; } >often
for command in 'rtworker -' 'fan -j 1 rtworker -' 'deal fan -j 1 rtworker -'; do
	run timeout 800 sh -c "$command <often >/dev/null"
	like "$command: a task of the state before those" "$status $err" '^2 .*task 0 0: its state was replaced too often'
done
# Workers do not announce a frame that comes again.
for command in 'fan -j 2 rtworker -a 4 -' 'deal fan -1 -j 2 rtworker -a 4 -'; do
	rm -f f?.pfm
	: >log
	partition 40x32 >all
	run timeout 1200 sh -c "{ pack scene 0.nff; sed 16q all; ./until grep -aq '^frag' log; echo frame 0 40 32; sed 1,16d all; } |
		$command | tee log | gather -o f%d.pfm"
	is "$command, a frame comes again: complete" "$status $err" '0 '
	right "$command, a frame comes again" 1
done
run timeout 800 sh -c 'rtworker 0.nff <mixed >/dev/null'
like 'a scene where it is a file already' "$status $err" '^2 rtworker: record .scene., expected .view.$'
finish
