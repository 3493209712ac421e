# shellcheck shell=sh disable=SC2034,SC2154  # balance, which reads this, uses and sets them
# balance reads this for -v, when its workers run: gather writes the picture, then other hosts compute a share of its
# pieces once more. It uses of balance
#     $@ frames             the files, and the frame records of their pictures
#     method renderer worker pack    how they are rendered, with the function one_each METHOD
#     all_hosts all_slots   -S, empty without; the number of slots
#     share log             -v; -r, empty without
#     state FILE ...        the function that writes the state records
#     assemble              the one that becomes gather, by setsid if `alone` is set
# and the stream, which comes from descriptor 4; descriptor 5 is its other end. It sets temporary running kept alone log
# seed round number.
exec 5>&-
temporary='' running='' kept=$log
[ -n "$kept" ] || alone=y
trap '[ -z "$temporary" ] || rm -rf "$temporary"' EXIT
# A second signal must not interrupt the removal of temporary files.
# gather is silent about a log that is removed.
trap 'trap "" HUP INT TERM
	[ -n "$kept" ] || [ -z "$temporary" ] || rm -rf "$temporary"
	[ -z "$running" ] || kill "$running" 2>/dev/null
	exit 130' HUP INT TERM
temporary=$(directory) || exit
: "${log:=$temporary/log}"
# The hosts of the checks are those of the file when the picture is complete: slots keep their numbers in all rounds. Until
# then these lines count.
case $all_hosts in slurm: | pbs:) ;; *) [ ! -f "$all_hosts" ] || { cat -- "$all_hosts" >"$temporary/hosts" || exit 3; } ;; esac
{
	# A signal to the process group does not reach gather then: this script ends it, when the log is removed.
	assemble
} &
running=$!
exec 4<&-
wait $running
status=$?
running=''
# With status 1 the picture may still be complete, if hosts differed. The checks then find out which one is wrong.
all_there() {
	printf '%s\n' "$frames" >"$temporary/frames" && left=$(partition -r "$log" "1x1@$temporary/frames") &&
		! printf '%s\n' "$left" | grep -q '^task '
}
if [ $status -ne 0 ] && { [ $status -ne 1 ] || ! all_there; }; then
	# A temporary log is kept if it has a part of the picture.
	case $status,$kept in
	[13],)
		if grep -aq '^frag ' "$log"; then
			trap - EXIT
			say "balance: $log is kept: rerun the command with -r $log to resume and verify; \
to give up, remove $temporary"
		fi
		;;
	esac
	exit $status
fi

# The picture is complete. The pieces are drawn only now, so that no worker can predict them. Each goes to another host. If
# two hosts differ, a third one is asked about that piece; if a host does not deliver, another one is.
if [ -f "$temporary/hosts" ]; then
	if cat -- "$all_hosts" >"$temporary/now" && fan -l -S "$temporary/now" >/dev/null; then mv "$temporary/now" "$temporary/hosts"
	else say "balance: -v: $all_hosts has become unusable: the hosts of the beginning verify"
	fi
	all_hosts=$temporary/hosts
fi
seed=$(od -An -N7 -tu8 /dev/urandom | tr -d ' ') && [ -n "$seed" ] || exit 3
# checked [-r]: prints state and the tasks of the next round; -r: reports on all rounds
checked() {
	number=0
	set -- "$@" "$share" "$log"
	while [ $((number += 1)) -lt $round ]; do set -- "$@" "$temporary/$number"; done
	if [ -n "$all_hosts" ]; then verify -S "$all_hosts" -s "$seed" "$@"; else verify -j "$all_slots" -s "$seed" "$@"; fi
}
# computed: turns these tasks into fragments
computed() {
	# shellcheck disable=SC2046,SC2086
	if [ -n "$all_hosts" ]; then exec fan $(one_each "$method") ${pack:+-z "$pack"} -S "$all_hosts" $renderer $worker
	else exec fan $(one_each "$method") -j "$all_slots" $renderer $worker
	fi
}
round=0
while [ $((round += 1)) -le 4 ] && [ -n "$(checked </dev/null | head -c 1)" ]; do
	# A host that hangs ends the round, and its pieces go to others. cat says whether there was room.
	state "$@" | checked | computed 6<&- | verify -t 20 "$log" 6<&- | cat >"$temporary/$round" 2>/dev/null &
	running=$!
	wait $running || {
		running=''
		say "balance: $temporary: the checks cannot be written, expected TMPDIR to name a directory with more room"
		exit 3
	}
	running=''
done
checked -r && exit $status
