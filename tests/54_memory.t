#!/bin/sh
# Memory: a state that does not fit is refused by name before it is loaded, and its workers go on
# with other frames; a worker that was killed by the kernel is named so.
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
# shellcheck disable=SC2154  # lib.sh sets them

# grid N FILE: a grid of N^3 zeros, which takes 4 N^3 bytes
grid() {
	{
		printf '# vtk DataFile Version 3.0\ng\nBINARY\nDATASET RECTILINEAR_GRID\n'
		printf 'DIMENSIONS %d %d %d\n' "$1" "$1" "$1"
		for axis in X Y Z; do
			printf '%s_COORDINATES %d int\n' $axis "$1"
			awk -v n="$1" 'BEGIN { for (i = 0; i < n; i++)
				printf "\\000\\000\\%03o\\%03o", int(i / 256), i % 256 }' >axis
			# shellcheck disable=SC2059  # the bytes of an axis, as octal numbers
			printf "$(cat axis)\n"
		done
		printf 'POINT_DATA %d\nSCALARS s float 1\nLOOKUP_TABLE default\n' $(($1 * $1 * $1))
		head -c $((4 * $1 * $1 * $1)) /dev/zero
		echo
	} >"$2"
}
grid 8 small.vtk
grid 320 large.vtk # 125 MiB
gridspec small.vtk >look.spec
# film GRID ...: a frame of four tasks for each grid
film() {
	f=0
	pack spec look.spec
	for g; do
		pack grid "$g"
		printf 'frame %d 16 16\n' $f
		for t in 0 1 2 3; do printf 'task %d %d 0 %d 16 4 1 1\n' $f $t $((4 * t)); done
		f=$((f + 1))
	done
}
film small.vtk large.vtk small.vtk >film.task

# Little more than programs and threads take. One process for each worker, and one with children.
kib=150000
needs='vcworker: frame 1: grid: out of memory: needs about [0-9]+ MiB, this host may use [0-9]+ MiB'
for slots in 1 2; do
	status=0
	# shellcheck disable=SC3045  # dash and bash both know it
	(ulimit -v $kib && exec vcworker -j $slots - -) <film.task >frags 2>said || status=$?
	is "-j $slots: the worker stays, exit 1" "$status $(grep -ac '^bye' frags)" '1 1'
	like "-j $slots: a message says what is missing" "$(cat said)" "^$needs\$"
	is "-j $slots: it says so once" "$(wc -l <said)" 1
	is "-j $slots: tasks of other frames are done" \
		"$(grep -ac '^done 0 [0-3] ' frags) $(grep -ac '^done ' frags)" '4 8'
	is "-j $slots: those of the large grid have failed" \
		"$(grep -ac '^fail 1 [0-3] why=out-of-memory ' frags)" 4
	is "-j $slots: the frame is not announced" \
		"$(grep -a '^frame ' frags | cut -d ' ' -f 2 | tr '\n' ,)" 0,2,
done
ok 'without the limit nothing is refused' sh -c 'vcworker - - <film.task | gather -o whole-%d.pfm'

# A worker that was given files ends, with the same words.
printf 'frame 0 16 16\ntask 0 0 0 0 16 16 1 1\n' >one.task
run sh -c "ulimit -v $kib; vcworker large.vtk look.spec <one.task"
like 'a file that does not fit: exit 3, and its name' "$status:$err" \
	'^3:vcworker: large.vtk: out of memory: needs about [0-9]+ MiB, this host may use [0-9]+ MiB$'
head -c 300000000 /dev/zero >large.nff
run sh -c "ulimit -v $kib; rtworker large.nff <one.task"
like 'a scene that does not fit: exit 3, and its name' "$status:$err" \
	'^3:rtworker: large.nff: out of memory: needs about'
{ pack scene large.nff; cat one.task; } >scene.task
run sh -c "ulimit -v $kib; rtworker - <scene.task"
like 'the same as a record' "$status:$err" \
	'^1:rtworker: frame 0: scene: out of memory: needs about [5-9][0-9][0-9] MiB'

# Hosts: the lines of the file bound the memory. Without a policy each task has its slot.
printf '%s slots=1 mem=150M via="sh -c %%c"\n' a b >hosts
run sh -c 'fan -t 600 -S hosts vcworker - - <film.task 2>said >frags'
is 'two hosts: tasks were lost' "$status" 1
gather -o x-%d.pfm frags
is 'two hosts: the small frames are whole' "$(echo x-*.pfm)" 'x-0.pfm x-2.pfm'
ok 'the pictures are those without a limit' cmp x-2.pfm whole-2.pfm
is 'each host says why' "$(grep -cE "^[ab]: $needs\$" said)" 2
fan -t 600 -1 -S hosts vcworker - - <film.task 2>said | grep -aE '^(fail|gone|up)' |
	sed 's/^fail . ./fail/' >events
is 'a slot loses only the tasks that it cannot do' \
	"$(cut -d ' ' -f 1-3 events | sed 's/ host.*//; s/said=grid.*/said=grid/' | LC_ALL=C command sort | uniq -c |
		tr -d ' ' | tr '\n' ,)" \
	'4failwhy=out-of-memorysaid=grid,1upw=0,1upw=1,'
# One host has the memory: it computes what the other ones refuse, also if it is the last to come.
printf '%s slots=1 mem=150M via="sh -c %%c"\n' a b >mixed
printf 'large slots=1 via="sh -c %%c"\n' >>mixed
for method in 'deal -q auto -e fan' 'ringctl -e fan'; do
	node='' && [ "${method#ringctl}" = "$method" ] || node='ringctl -n'
	# shellcheck disable=SC2086  # words
	run sh -c "$method -t 600 -S mixed $node sh -c '[ \"\$(ulimit -v)\" != unlimited ] || sleep 1; exec vcworker - -' \
		<film.task | gather -o mixed-%d.pfm"
	is "$method: all is computed, nothing given up, no slot lost" "$status $(echo "$err" | grep -cE 'given up|lost')" '0 0'
	ok "$method: the picture is that without a limit" cmp mixed-1.pfm whole-1.pfm
	rm -f mixed-*.pfm
done
# A node of the ring holds state on its way to the worker, and refuses it with the same words.
run sh -c 'ringctl -e fan -t 600 -S hosts ringctl -n vcworker - - <film.task | gather -o ring-%d.pfm'
is 'nodes: no slot is lost, and other frames are whole' "$(echo "$err" | grep -c lost) $(echo ring-*.pfm)" '0 ring-0.pfm ring-2.pfm'
is 'each node says why' "$(echo "$err" | grep -cE "^[ab]: ringctl: ${needs#vcworker: }\$")" 2
like 'nodes: the frame is given up' "$err" '^ringctl: frame 1: given up, because it fits the memory of no slot that is up: '
# What a host has kept from a run that had memory is refused before it is read, too.
if fan -l -z on >said 2>&1; then
	film large.vtk >large.task
	mkdir cache
	printf 'a via="env XDG_CACHE_HOME=%s sh -c %%c"\n' "$PWD/cache" >roomy
	sed 's/$/ mem=150M/' roomy >tight
	ok 'a run with memory keeps the grid' sh -c 'deal fan -t 600 -S roomy vcworker - - <large.task >frags'
	is 'it is kept' "$(find cache -type f | wc -l)" 1
	for each in '' -1; do
		# shellcheck disable=SC2086  # an option or none
		run deal fan -t 600 $each -S tight vcworker - - <large.task
		is "a kept grid that does not fit$each: exit 1, and no slot is lost" \
			"$status $(printf '%s\n' "$err" | grep -c lost)" '1 0'
		like "a kept grid that does not fit$each: by name" "$err" \
			'^a: vcworker: frame 0: grid: out of memory: needs about'
	done
	run ringctl -e fan -t 600 -S tight ringctl -n vcworker - - <large.task
	is 'a kept grid that does not fit a node: exit 1, and no slot is lost' "$status $(echo "$err" | grep -c lost)" '1 0'
	like 'a kept grid that does not fit a node: by name' "$err" '^a: ringctl: frame 0: grid: out of memory: needs about'
else
	skip 'a kept grid that does not fit' "$(cat said)"
fi
run deal sh -c "ulimit -v $kib; exec vcworker - -" <film.task
like 'deal around a worker alone: a message' "$err" \
	'^deal: frame 1: given up, because it fits the memory of no slot that is up: .* [(]out-of-memory[)], it says: grid: out of memory: needs about'

# ---- signal 9 ------------------------------------------------------------------------------------
spdgen -s 1 tetra >tetra.nff
{ pack scene tetra.nff; partition 32x32; } >job.task
hint='killed [(]signal 9[)], as the kernel does when memory is short'
# dies LINE: makes a worker that ends by this line when it has a task
dies() {
	printf '%s\n' '#!/bin/sh' 'rtworker "$@" </dev/null | head -n 1; sed /^task/q >&2' "$1" >dies
	chmod +x dies
}
# lost NAME REASON SUFFIX: what is said of such a worker, on $slot
lost() {
	# shellcheck disable=SC2086  # words
	run deal fan $hosts ./dies - <job.task
	like "$1" "$err" "^fan: $slot: lost [(]$2[)] with [1-9][0-9]* tasks(, (starting|connecting) again)?$3\$"
}
# shellcheck disable=SC2016  # dies expands it
by_itself='kill -9 $$'
dies "$by_itself"
hosts='-j 1' slot='slot 0'
lost 'a worker here' signal-9 "; $hint"
printf 'a via="sh -c %%c" tries=1\n' >a
hosts='-S a' slot='slot 0 on a'
lost 'a worker of a host' signal-9 "; $hint"
dies 'exit 137'
lost 'the status of a shell there' signal-9 "; $hint"
# shellcheck disable=SC2016  # ssh expands it
printf '%s\n' '#!/bin/sh' 'exec sh -c "$1"' >ssh && chmod +x ssh
printf 'a via="./ssh %%c" tries=1\n' >a
dies 'exit 255'
lost 'ssh, which has no such status' exit-255 \
	'; ssh says no reason: killed there, as the kernel does when memory is short'
dies 'echo "Connection to a closed by remote host." >&2; exit 255'
lost 'a connection that was cut' exit-255 ''
dies 'exit 3'
lost 'another status' exit-3 ''
finish
