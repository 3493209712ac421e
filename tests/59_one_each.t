#!/bin/sh
# fan -1: one worker for each host, with all of its slots; and balance adaptive, which runs it. Slots have the same numbers,
# and the picture the same bits, as with a worker for each slot. fan -T: a tree of racks. Hosts are commands on this machine.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
patient

spdgen -s 2 balls >0.nff
spdgen -s 2 tetra >1.nff
cp "$root/scenes/boat.nff" 2.nff
for f in 0 1 2; do
	partition 60x44 | rtworker $f.nff | gather -o good$f.pfm
	pack scene $f.nff && partition -F $f 60x44
done >film
printf '%s\n' '#!/bin/sh' 'echo "$1" >>started; exec sh -c "$2"' >via && chmod +x via
cat >hosts <<'END'
: slots=2
far slots=3 via="./via %h %c"
near via="./via %h %c"
END

# ---- the picture -----------------------------------------------------------------------------------------------
# renders NAME PARTITION COMMAND ...
renders() {
	name=$1 cut=$2
	shift 2
	# shellcheck disable=SC2086
	{ pack scene 0.nff; partition $cut 60x44; } >tasks
	run timeout 300 "$@" - <tasks
	cp .out frags
	is "$name" "$status $(unexpected .err) $(gather -o a.pfm frags 2>&1) $(cmp a.pfm good0.pfm 2>&1)" '0   '
}
renders 'slots of this machine' '' fan -1 -j 3 rtworker
renders 'one slot' '' fan -1 -j 1 rtworker
renders 'hosts' '' fan -1 -S hosts rtworker
is 'hosts: one connection for each' "$(sort started | tr '\n' ' ')" 'far near '
slots_of() { grep -aoE "$1 .*" frags | sed -nE 's/.* w=([0-9.]+) .*/\1/p' | sort | uniq -c | awk '{ printf "%s:%s ", $2, $1 }'; }
is 'hosts: each slot has its tasks' "$(slots_of 'done [0-9]+ [0-9]+')" '0:8 1:8 2:7 3:7 4:7 5:7 '
is 'hosts: each slot announces the frame' "$(slots_of 'frame 0 60 44')" '0:1 1:1 2:1 3:1 4:1 5:1 '
is 'hosts: each slot is up' "$(grep -aoE 'up w=.*' frags | awk '{ print $2, $3, $5 }' | sort | tr '\n' ',')" \
	'w=0 host=: slots=1,w=1 host=: slots=1,w=2 host=far slots=1,w=3 host=far slots=1,w=4 host=far slots=1,w=5 host=near slots=1,'
like 'hosts: hello' "$(grep -ao '^hello .*' frags)" '^hello fan .* slots=6 '
renders 'hosts, preassigned tasks' '-u scatter -n 6' fan -1 -S hosts rtworker
is 'preassigned tasks go to their slots' "$(slots_of 'done [0-9]+ [0-9]+')" '0:1 1:1 2:1 3:1 4:1 5:1 '
renders 'hosts, pixels at the end' '' fan -1 -S hosts rtworker -c -f 11
renders 'hosts, a policy' '' deal fan -1 -S hosts rtworker
renders 'hosts, pixels at a flush' '' deal -q auto -e fan -1 -S hosts rtworker -c
renders 'a tree' '' fan -j 2 fan -1 -j 2 rtworker
is 'a tree: the slots have two numbers' "$(slots_of 'frame 0 60 44')" '0.0:1 0.1:1 1.0:1 1.1:1 '
for options in '' -c; do
	rm -f f?.pfm
	# shellcheck disable=SC2086
	run sh -c 'deal fan -1 -S hosts rtworker "$@" - <film | gather -o f%d.pfm' sh $options
	is "three scenes $options" "$status $(unexpected .err)" '0 '
	for f in 0 1 2; do ok "three scenes $options: picture $f" cmp f$f.pfm good$f.pfm; done
done
is 'fan -l -1: a line for each slot' "$(fan -l -1 -S hosts rtworker | cut -f 1,2 | tr '\t\n' ': ')" '0:: 1:: 2:far 3:far 4:far 5:near '

# No task is done before both hosts have come.
printf '%s\n' '#!/bin/sh' 'echo "$1" >>started' \
	'until [ "$(sort -u started | wc -l)" = 2 ]; do sleep .05; done' 'exec sh -c "$2"' >both && chmod +x both
sed -n 's,/via,/both,p' hosts >both.hosts
for method in adaptive auto dc ds hybrid interleaved masterslave sc ss; do
	rm -f started a.pfm
	run balance $method -1 -S both.hosts -s 60x44 -o a.pfm 0.nff
	is "balance $method -1" "$status $(unexpected .err | grep -v '^balance auto: ') $(cmp a.pfm good0.pfm 2>&1)" '0  '
	[ $method = hybrid ] || [ $method = auto ] || is "balance $method -1: one connection for each host" "$(sort started | tr '\n' ' ')" 'far near '
done
for method in gdc gdc-published; do
	rm -f started a.pfm
	run balance $method -1 -S both.hosts -s 60x44 -o a.pfm 0.nff
	is "balance $method -1: a node on each host" "$status $(unexpected .err) $(cmp a.pfm good0.pfm 2>&1) $(sort started | tr '\n' ' ')" '0   far near '
done
run balance gdc -1 -v 1 -j 2 -s 60x44 -o a.pfm 0.nff
is 'such a ring cannot be verified' "$status $err" '2 balance: -v: slots of a ring with -1 are hosts, expected no -1'

# ---- more slots than a fan can have connections -----------------------------------------------------------------
SLURM_JOB_NODELIST='n[1-100]' SLURM_JOB_CPUS_PER_NODE='128(x100)' run fan -l -S slurm:
is 'a job of 12800 processors' "$status $(wc -l <.out) $(tail -n 1 .out)" "0 12800 $(printf '12799\tn100\t-')"
awk 'BEGIN { for (k = 1; k <= 2; k++) print "h" k " slots=2049 via=\"sh -c %c\"" }' >wide.hosts
run fan -S wide.hosts rtworker - <tasks
is 'a fan has 4096 workers' "$status $err" '2 fan: 4098 workers, expected at most 4096: one for each host (-1), or in racks (-T)'
# With 50 descriptors 6 connections are possible; with 41, 3.
printf '%s slots=4 via="./via %%h %%c"\n' far near >wide.hosts
rm -f started a.pfm
run sh -c 'ulimit -n 50; exec balance interleaved -S wide.hosts -s 60x44 -o a.pfm 0.nff'
is 'too many slots: a connection for each host' "$status $(cat .err) $(cmp a.pfm good0.pfm 2>&1) $(sort started | tr '\n' ' ')" \
	'0 balance: 8 slots, of at most 6 connections: one for each host (-1)  far near '
cat >four.hosts <<'END'
a slots=2 power=1 via="./via %h %c"
b via="./via %h %c"
c slots=2 via="./via %h %c"
d via="./via \"%h\" %c"
END
run sh -c 'ulimit -n 41; exec balance masterslave -S four.hosts -s 60x44 -o a.pfm 0.nff'
is 'too many hosts: a tree' "$status $(unexpected .err) $(cmp a.pfm good0.pfm 2>&1)" '0 balance: 4 hosts: a tree of 2 racks of up to 2 hosts (-T 2) '

# ---- racks -----------------------------------------------------------------------------------------------------
is 'fan -l -T: a line for each rack' "$(fan -l -T 3 -S four.hosts | tr '\t\n' ': ')" '0:a:- 1:d:- '
renders 'racks' '' fan -T 2 -S four.hosts rtworker
is 'a rack is a slot' "$(grep -aoE 'up w=.*' frags | awk '{ print $2, $3, $5 }' | sort | tr '\n' ',')" 'w=0 host=a slots=3,w=1 host=c slots=3,'
for method in adaptive auto dc gdc hybrid interleaved sc; do
	rm -f a.pfm
	run balance $method -T 2 -S four.hosts -s 60x44 -o a.pfm 0.nff
	is "balance $method -T 2" "$status $(unexpected .err) $(cmp a.pfm good0.pfm 2>&1)" '0 balance: 4 hosts: a tree of 2 racks of up to 2 hosts (-T 2) '
done
# A host that cannot be used, one that is not ready, and one that is lost after its first pixels leave the head to the next.
printf '%s\n' '#!/bin/sh' 'exit $1' >./ends
printf '%s\n' '#!/bin/sh' '[ ! -e once ] || exec sh -c "$1"' ': >once; sh -c "$1" | dd bs=1 count=4000 2>/dev/null' >./cut && chmod +x ends cut
for head in 'ends 127' 'ends 1' cut; do
	rm -f once a.pfm
	{ echo "lame via=\"./$head %c\""; sed -n '2,4p' four.hosts; } >lame.hosts
	run balance adaptive -T 4 -S lame.hosts -s 60x44 -o a.pfm 0.nff
	is "its head has: $head" "$status $(cmp a.pfm good0.pfm 2>&1)" '0 '
	like "its head has: $head: the next is named" "$err" '^fan: (slot 0 on )?lame: .*; its rack is led by b$'
done
printf '%s\n' '#!/bin/sh' '[ -z "$BELOW" ] || exec sh -c "$1"' 'export BELOW=1; sh -c "$1" | { dd bs=1 count=9000 2>/dev/null; echo; echo; cat; }' >garbles && chmod +x garbles
printf 'lame%d via="./garbles %%c"\n' 1 2 >lame.hosts
sed -n 2p four.hosts >>lame.hosts
run balance adaptive -z off -T 4 -S lame.hosts -s 60x44 -o a.pfm 0.nff
is 'heads whose streams are damaged: each is named, and the last host leads' \
	"$status $(cmp a.pfm good0.pfm 2>&1) $(sed -nE 's/^fan: slot 0 on (lame.): lost \(garbage\).* is (led by .*)$/\1 \2/p' .err | paste -sd , -)" '0  lame1 led by lame2,lame2 led by b'
for code in 1 127; do
	printf 'lame%d via="./ends %d %%c"\n' 1 $code 2 1 >lame.hosts
	sed -n 2p four.hosts >>lame.hosts
	like "fan -l -T asks each host that may lead, $code" "$(fan -l -T 4 -S lame.hosts rtworker 2>&1)" "^0	b	[0-9.]+$"
done
printf 'lame%d tries=1 via="./ends 1 %%c"\n' 1 2 >lame.hosts
run fan -T 2 -S lame.hosts rtworker - <tasks
like 'tries= is of each host of a rack' "$status $(paste -sd ' ' .err)" '^3 .*led by lame2 fan: lame2: .* [(]exit-1[)]; no try is left [(]tries=1[)] '
printf 'lame%d via="./ends 127 %%c"\n' 1 2 >lame.hosts
run balance adaptive -T 2 -S lame.hosts -s 60x44 -o a.pfm 0.nff
is 'a rack of which no host can be used is given up' "$status $(grep -c 'no deal on its PATH.* led by' .err) $(grep -c 'no slot left' .err)" '3 1 1'
run balance adaptive -T 2 -v 1 -S four.hosts -s 60x44 -o a.pfm 0.nff
like 'a tree cannot be verified' "$status $(tail -n 1 .err)" '^2 balance: -v: a tree of racks, expected at most [0-9]+ hosts$'
run balance adaptive -T 2 -j 2 -s 60x44 -o a.pfm 0.nff
is 'racks need hosts' "$status $err" '2 balance: -T: expected -S with it'
awk 'BEGIN { for (k = 0; k < 10; k++) printf "h%d via=\"%4000s %%c\"\n", k, "x" }' >long.hosts
run fan -l -T 10 -S long.hosts
like 'a rack of too many lines is refused' "$status $err" '^2 fan: -T: the lines of the rack of h0 have [0-9]+ bytes, expected at most 32768: fewer hosts in it$'

# ---- what is refused -------------------------------------------------------------------------------------------
printf '%s\n' '#!/bin/sh' 'shift 2; exec rtworker "$@"' >plain && chmod +x plain
run fan -1 -j 2 ./plain - <tasks
like 'a worker with another number of slots is refused' "$status $err" '^3 fan: slots 0 to 1: refused: it has 1 slots, expected 2, by its option -j$'
echo 'ring me=0 n=2 rules=default to=0' >ring
run fan -1 -j 2 rtworker - <ring
is 'a ring is refused' "$status $err" '2 fan: record `ring`: expected a worker for each slot, without -1'

# ---- losses ----------------------------------------------------------------------------------------------------
# A worker with several slots is the parent of those that render.
kin() { ps -o pid=,ppid= -p "$(program rtworker | paste -s -d , -)" 2>/dev/null | awk -v child="$1" '{ of[$1] = $2 } END { for (p in of) if ((of[p] in of) == child) print p }'; }
parents() { kin 0; }
renderers() { kin 1; }
rendering() { [ "$(renderers | wc -l)" -ge "$1" ] || ! kill -0 "$pid"; }
# The last task is held back until the file go is there, so whatever the load, workers are killed before the end.
all_in holding
rm holding/partition
cat >holding/partition <<END
#!/bin/sh
case \$* in *@-) exec '$root/bin/partition' "\$@" ;; esac # by which balance counts tasks
'$root/bin/partition' "\$@" >'$tmp/held.tasks'
sed '\$d' '$tmp/held.tasks'
until [ -e '$tmp/go' ]; do sleep .05; done
tail -n 1 '$tmp/held.tasks'
END
chmod +x holding/partition
partition 128x128 | rtworker -a 400 2.nff | gather -o good.pfm
# begun COMMAND ...: starts a run in the background
begun() {
	rm -f out.pfm log go
	env MARK=$mark PATH="$tmp/holding:$PATH" balance adaptive "$@" -s 128x128 -W '-a 400' -r log -o out.pfm 2.nff 2>said &
	pid=$!
}
# ended NAME: the run ends well
ended() {
	: >go
	status=0
	wait "$pid" || status=$?
	is "$1: exit 0" "$status" 0
	ok "$1: the picture" cmp out.pfm good.pfm
	ok "$1: no process remains" await 10 none_alive
}
begun -j 3
await 120 rendering 3
# shellcheck disable=SC2046
kill -KILL $(renderers | head -n 1)
ended 'a killed process of a slot'
is 'a killed process of a slot: only its tasks were lost' "$(unexpected said | grep -c lost) $(grep -cE '^rtworker: slot [0-2]: lost \(signal-9\) with [0-9]+ tasks, forked again; killed [(]signal 9[)], as the kernel does when memory is short$' said) $(grep -ac '^gone' log)" '1 1 0'
begun -j 3
await 120 rendering 3
# shellcheck disable=SC2046
kill -KILL $(parents)
ended 'a killed worker of this machine'
like 'a killed worker of this machine is started again' "$(cat said)" '^fan: slots 0 to 2: lost \(signal-9\) with [0-9]+ tasks, starting again; killed [(]signal 9[)], as the kernel does when memory is short$'
# Near begins when far is lost, so that far cannot be idle at that time.
printf '%s\n' '#!/bin/sh' 'until [ -e go ]; do sleep .05; done' 'exec sh -c "$1"' >after && chmod +x after
cat >two <<'END'
near slots=2 via="./after %c"
far slots=2 via="sh -c %c"
END
begun -S two
await 120 rendering 2
# shellcheck disable=SC2046
kill -KILL $(parents)
ended 'a killed worker of a host'
like 'the other host takes over' "$(cat said)" '^fan: slots 2 to 3 on far: lost \((signal-9|exit-137)\) with [0-9]+ tasks'
partition 128x128 >tasks
mkfifo in
env MARK=$mark fan -1 -j 3 rtworker -a 400 - <in >frags 2>said &
pid=$!
exec 9>in
{ pack scene 2.nff; head -n 65 tasks; } >&9
await 120 rendering 3
# shellcheck disable=SC2046
kill -STOP $(renderers) # so the tasks that follow are not done
tail -n +66 tasks >&9
# shellcheck disable=SC2046
kill -KILL $(parents)
reports() { grep -aoE '(up|gone) w=[0-2] ' frags | sort | uniq -c | awk '{ printf "%s%s%s ", $1, $2, $3 }'; }
again='1gonew=0 1gonew=1 1gonew=2 2upw=0 2upw=1 2upw=2 '
up_again() { [ "$(reports)" = "$again" ]; }
await 20 up_again
exec 9>&-
status=0
wait "$pid" || status=$?
is 'its slots are gone once, and up again; without a policy its tasks are lost' "$status $(reports)" "1 $again"
printf '%s\n' '#!/bin/sh' 'rtworker "$@" </dev/null | head -n 1; sed /^task/q >&2; kill -KILL $$' >dies && chmod +x dies
{ pack scene 0.nff; partition 60x44; } >tasks
run sh -c 'deal fan -1 -j 2 ./dies - <tasks 2>said >log'
is 'all that a worker always dies of is given up' "$status $(grep -ac '^deal: frame 0: given up' said)" '1 1'
is 'losses for the same reason are said once and counted' "$(grep -ac 'starting again' said) $(grep -ao 'this machine: losses.*' said)" \
	'1 this machine: losses for the same reason that were not shown: 2'
finish
