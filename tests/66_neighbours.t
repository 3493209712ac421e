#!/bin/sh
# Good neighbours: the processors that a control group allows, nice= and mem= of a host, and Ctrl-Z.
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
# shellcheck disable=SC2154  # lib.sh sets them

# ---- processors ----------------------------------------------------------------------------------
# A group of version 1 with a quota, and a group in it without one.
group=/sys/fs/cgroup/cpu/stormring.$$
leave() { # the groups are empty then
	[ ! -d "$group" ] || { rmdir "$group/in"; rmdir "$group"; } 2>/dev/null
	end_all
	rm -rf "$tmp"
}
trap leave EXIT
# within PERIOD QUOTA GROUP COMMAND ...: runs the command in the group
within() {
	echo "$1" >$group/cpu.cfs_period_us && echo "$2" >$group/cpu.cfs_quota_us || return
	group_of=$3 && shift 3
	# shellcheck disable=SC2016  # the inner shell expands them
	sh -c 'echo $$ >"$0/cgroup.procs" && exec "$@"' "$group_of" "$@"
}
is 'tests/processors counts as fan does' "$("$root/tests/processors")" "$(fan -l | wc -l)"
all=$(fan -l | wc -l)
if ! mkdir $group $group/in 2>/dev/null || [ ! -e $group/in/cpu.cfs_quota_us ]; then
	skip 'a quota' 'expected root, and control groups of version 1 at /sys/fs/cgroup/cpu'
elif ! within 100000 -1 $group true; then
	skip 'a quota' 'a group takes no process'
else
	is 'no quota: all processors' "$(within 100000 -1 $group fan -l | wc -l)" "$all"
	is 'a fifth of a processor is one slot' "$(within 100000 20000 $group fan -l | wc -l)" 1
	is 'a quota of the group around counts' "$(within 100000 20000 $group/in fan -l | wc -l)" 1
	is 'one and a half are two slots' "$(within 100000 150000 $group/in fan -l | wc -l)" \
		"$((all < 2 ? all : 2))"
	is 'a quota above all processors' "$(within 100000 99900000 $group fan -l | wc -l)" "$all"
	if there unshare; then
		# shellcheck disable=SC2016  # the inner shell expands it
		is 'in a view of its own, mounted elsewhere' \
			"$(within 100000 20000 $group unshare -Cm sh -c '
			mkdir "$1" && mount -t cgroup -o cpu cgroup "$1" && umount /sys/fs/cgroup/cpu &&
			fan -l' sh "$tmp/at" | wc -l)" 1
	fi
fi

# ---- nice= and mem= ------------------------------------------------------------------------------
# shellcheck disable=SC2016  # tells expands it
printf '%s\n' '#!/bin/sh' 'nice >&2; ulimit -v >&2; exec rtworker "$@"' >tells && chmod +x tells
# shellcheck disable=SC3045  # dash and bash both know it
now=$(nice) bound=$(ulimit -v)
# told NAME LINE WORDS: what the worker of this line says
told() {
	printf '%s\n' "$2" >hosts
	run fan -l -S hosts ./tells -
	# If the host is another one, a worker here is asked first.
	is "$1" "$status:$(printf '%s\n' "$err" | tail -n 2 | tr '\n' ,)" "0:$3"
}
told 'here' ': nice=3 mem=2G' "$((now + 3)),2097152,"
told 'here, one of them' ': mem=3000000K' "$now,3000000,"
told 'elsewhere' 'a mem=4096M nice=2 via="sh -c %c"' "a: $((now + 2)),a: 4194304,"
told 'elsewhere, in a directory' "a nice=1 bin=$root/bin via=\"sh -c %c\"" \
	"a: $((now + 1)),a: $bound,"
told 'neither' 'a nice=0 via="sh -c %c"' "a: $now,a: $bound,"
# A worker that is kept from running for 1 s, between hello and the last task: 41 s are allowed.
printf '%s\n' '#!/bin/sh' 'rtworker "$@" | { dd bs=1 count=500 2>&-; sleep 1; exec cat; }' >tardy && chmod +x tardy
echo ': nice=19' >hosts && spdgen -s 1 tetra >tetra.nff
run sh -c '{ pack scene tetra.nff; partition 8x8; } | deal fan -t .6 -S hosts ./tardy - | gather -o tetra.png'
is 'a niced worker has longer' "$status:$err" 0:
# bad LINE MESSAGE
bad() {
	printf '%s\n' "$1" >bad
	run fan -l -S bad
	is "refused: $1" "$status:$err" "2:fan: bad:1: $2"
}
bad 'a nice=20' "nice='20': expected an integer from 0 to 19"
bad 'a nice=-1' "nice='-1': expected an integer from 0 to 19"
for size in 0 1023K 4X 4GB G -1 1e9 99999999999999999999 9999999999G ''; do
	bad "a mem=$size" "mem='$size': expected bytes, at least 1M, with or without K, M or G"
done

# ---- Ctrl-Z --------------------------------------------------------------------------------------
spdgen -s 2 gears >gears.nff
{ pack scene gears.nff; partition 160x160; } >job.task
rtworker -a 100 - <job.task | gather -o good.pfm
mkfifo in
# begun COMMAND ...: a run in a process group of its own, as a shell's job is. Its input stays open,
# so that it does not end before the test goes on.
begun() {
	rm -f out.pfm log
	MARK=$mark perl -e 'setpgrp; exec @ARGV' \
		sh -c "$* <in 2>said | gather -r log -o out.pfm" 9>&- &
	job=$!
	exec 9>in
	cat job.task >&9
}
rendering() { grep -aqs '^done ' log; }
states() { for p in $(alive); do ps -o stat= -p "$p"; done | cut -c 1 | sort -u | tr -d '\n'; }
all_in_state() { [ "$(states)" = "$1" ]; }
for chain in 'deal -q auto -e fan -1 -j 2 rtworker -a 100 -' 'deal fan -j 2 rtworker -a 100 -' \
	'ringctl fan -j 2 ringctl -n rtworker -a 100 -'; do
	begun "$chain"
	await 60 rendering
	kill -TSTP "-$job"
	ok "$chain: Ctrl-Z stops all processes" await 10 all_in_state T
	sleep 4 # longer than a slot may be silent
	is "$chain: and none goes on" "$(states)" T
	kill -CONT "-$job"
	exec 9>&-
	status=0
	wait $job || status=$?
	is "$chain: it goes on, and loses no slot" "$status:$(cat said)" 0:
	ok "$chain: the same picture" cmp out.pfm good.pfm
done
# A command of cropworker: its group stops, too.
# Both wait for a pipe, without a child: a shell whose child stops before exec is in state D.
mkfifo go
exec 8<>go
echo 'echo frame 0 1 1; echo task 0 0 0 0 1 1 1 1; read -r _ <go' >one
printf '%s\n' "echo >up; read -r _ <go; printf 'P6 1 1 255\\nabc'" >draw
MARK=$mark perl -e 'setpgrp; exec @ARGV' \
	sh -c 'sh one | cropworker -w sh ./draw >crop.frags' 2>said 8>&- &
job=$!
await 20 there ./up
kill -TSTP "-$job"
ok 'cropworker: its command stops' await 10 all_in_state T
printf '\n\n' >&8 # a line each
kill -CONT "-$job"
status=0
wait $job || status=$?
is 'cropworker: it goes on' "$status:$(grep -ac '^done ' crop.frags):$(cat said)" 0:1:
finish
