#!/bin/sh
# Real faults on three hosts reached by ssh. Methods on deal finish with the same pixels and report each lost slot.
# Static methods list the missing pixels and the command that renders them. No process remains on any host. The time
# until a fault is noticed is printed and not judged, because it depends on the load of the machine.
# shellcheck disable=SC2154,SC2016,SC2046  # lib.sh sets them; scripts for hosts; a pid each
want_hosts=3
. "$(dirname "$0")/hosts.sh"
spdgen -s 2 gears >gears.nff
partition 192x192 | rtworker -a 36 gears.nff | gather -o good.pfm
file=$TEST_HOSTS/hosts
unequal

# ---- no host left: this takes long, so it runs beside the rest, on its own hosts ----------------------------------------
cat >nobody <<'END'
hosts=$1 name=$2 list=$3 && mkdir "$name" && cd "$name" || exit
{ balance masterslave -S "$list" -s 192x192 -W '-a 64' -r log -o out.pfm ../gears.nff 2>said; echo $? >status; } &
if [ "$name" = lost ]; then
	until grep -aq 'done 0 ' log; do sleep .05; done 2>/dev/null
	kill -9 $("$hosts" pids host1 sshd)
fi
date +%s%N >since
wait
date +%s%N >until
END
"$tests/hosts" with 2 sh -c 'kill -STOP $("$1" pids host2 sshd)
	sh nobody "$1" lost "$TEST_HOSTS/hosts" & sh nobody "$1" never host2,nowhere & wait' nobody "$tests/hosts" &
nobody=$!

# ---- processes here and on hosts ---------------------------------------------------------------------------------------
here() { # NAME [ERE]: processes of this test, by name and command line
	for p in $(program "$1"); do tr '\0' ' ' <"/proc/$p/cmdline" | grep -Eq -e "${2-.}" && echo "$p"; done
}
there() { # except the processes that make a host
	ps -o comm= -p "$(for h in host1 host2 host3; do hosts pids $h; done | paste -sd ,)" | grep -vxE 'hosts|sleep|sshd(-session|-auth)?'
}
none_there() { [ -z "$(there)" ]; }
none_left() { none_alive && none_there; }
stamp() { perl -MTime::HiRes=time -ne 'BEGIN { $| = 1 } printf "%d %s", 1000 * time, $_'; }

# begin METHOD [OPTION ...]: starts a run in the background; `said` gets its messages, each after the time
begin() {
	rm -f out.pfm job.log said go
	begun=$(now_ms)
	{
		env MARK="$mark" sh -c 'echo $$ >pid; exec "$@"' run \
			balance "$@" -S "$file" -s 192x192 -W '-a 36' -r job.log -o out.pfm gears.nff
		echo $? >status
	} 2>&1 | stamp >said &
	job=$!
}
end() { wait "$job"; ended=$(now_ms); status=$(cat status); }
at_work='(done|frag) 0 [0-9]+ .* w=1'
# feed: passes tasks on, six in a second until host2 is at work, so that it gets some however late it is up, then all but the
# last one, which it passes on when the file go is there. So the run lasts until then.
cat >feed <<END
#!/bin/sh
tasks=\$(cat) sent=0
n=\$(echo "\$tasks" | wc -l)
while [ \$sent -lt \$((n - 1)) ]; do
	echo "\$tasks" | sed '\$d' | sed -n "\$((sent + 1)),\$((sent + 6))p"
	sent=\$((sent + 6)) polls=0
	until grep -aqE '$at_work' '$tmp/job.log' 2>/dev/null || [ -e '$tmp/go' ] || [ \$((polls += 1)) -gt 20 ]; do sleep .05; done
done
until [ -e '$tmp/go' ]; do sleep .05; done
echo "\$tasks" | tail -n 1
END
# lasting METHOD: begins a run that is fed so. balance also calls partition before the run, to count the tasks that are left.
# That call must not wait.
all_in late
rm late/partition
cat >late/partition <<END
#!/bin/sh
case \$* in *@- | *1x1@*) exec '$root/bin/partition' "\$@" ;; esac
'$root/bin/partition' "\$@" | '$tmp/feed'
END
chmod +x feed late/partition
lasting() { PATH=$tmp/late:$PATH begin "$@"; }
at_work() { grep -aqE "$at_work" job.log 2>/dev/null; } # host2 is
says() { grep -Eq "^[0-9]+ $1" said; }
# noticed NAME ERE: a message after the fault matches
noticed() {
	noticed_ms=$(awk -v since="$since" -v what="$2" '$1 >= since && $0 ~ what { print $1 - since; exit }' said)
	if [ -n "$noticed_ms" ]; then pass "$1: noticed"
	else fail "$1: noticed" "fault at $since, said: $(echo; cat said)"
	fi
}
same_picture() { # NAME
	is "$1: exit 0" "$status" 0
	[ "$status" -eq 0 ] || diag "it said: $(tr -cd '\n -~' <said)"
	ok "$1: the same picture" cmp out.pfm good.pfm
	ok "$1: no worker is left" await 2 none_there
}
# report NAME POWER: prints the time of the run, and the least time of these hosts if they lose POWER at the fault. The time
# is not judged, because it includes start-up and other load of this machine.
report() {
	diag "$(awk -v name="$1" -v cpu="$cpu_ms" -v before="$((since - begun))" -v took="$((ended - begun))" -v lost="$2" \
		-v after="${noticed_ms:--}" 'BEGIN { all = .75; rest = cpu - before * all
		bound = rest > 0 ? before + rest / (all - lost) : cpu / all
		printf "%s: noticed after %s ms; took %d ms, the hosts that were left need %d: efficiency %.2f", name, after,
			took, bound, bound / took }')"
}

begin masterslave
end
same_picture 'no fault'
cpu_ms=$(fragstat -s job.log | awk '$1 == "cpu_s" { print 1000 * $2 }')
since=$begun noticed_ms=''
report 'no fault' 0

# ---- faults: each hits host2 -----------------------------------------------------------------------------------------
listener() { ps -o pid=,comm= --ppid "$(cat "$TEST_HOSTS/host2/init")" | awk '$2 == "sshd" { print $1 }'; }
fault_worker() { kill -9 "$(hosts pids host2 rtworker)"; }
fault_node() { stopped=$(hosts pids host2 ringctl) && kill -STOP "$stopped"; }
fault_ssh() { kill -9 "$(here ssh ' host2 ')"; }
fault_session() { kill -9 $(hosts pids host2 sshd | grep -vx "$(listener)"); }
fault_sshd() { kill -9 $(hosts pids host2 sshd); }
fault_stop() { stopped=$(hosts pids host2 rtworker) && kill -STOP "$stopped"; }
fault_link() { hosts link host2 down; }
fault_power() { hosts power host2 .05; }
reach_work() { await 20 at_work || fail "$name: host2 is at work" "$(cat said)"; }
inflict() { # FAULT
	reach_work
	since=$(now_ms)
	"fault_$1"
}
silent='silent|exit-255' # ssh notices the silence of an idle worker, and fan that of one with tasks
lost() { echo "fan: slot 1 on host2: lost [(]$1[)] with [0-9]+ tasks, connecting again"; } # an ERE
while read -r method fault why; do
	# By day not each fault by each method: fan sees the end of a worker and of a session alike.
	[ -n "${NIGHT-}" ] || case "$method $fault" in 'ds worker' | 'gdc session') continue ;; esac
	name="$method, kill -9 of the $fault"
	lasting "$method"
	inflict "$fault"
	await 20 says "$(lost "$why")"
	: >go
	end
	same_picture "$name"
	noticed "$name" "$(lost "$why")"
	report "$name" 0
done <<'END'
masterslave worker exit-255
hybrid ssh signal-9
dc session exit-255
ds worker exit-255
gdc worker signal-9
gdc ssh signal-9
gdc session exit-255
END

for method in masterslave gdc; do
	name="$method, kill -9 of sshd, which comes back"
	lasting $method
	inflict sshd
	await 5 says "$(lost exit-255)"
	hosts sshd host2
	ok "$name: connected again" await 20 says 'fan: slot 1 on host2: is up'
	: >go
	end
	same_picture "$name"
	noticed "$name" "$(lost exit-255)"

	name="$method, a link that is down for long"
	lasting $method
	inflict link
	await 10 says "$(lost "$silent")"
	hosts link host2 up
	ok "$name: connected again" await 20 says 'fan: slot 1 on host2: is up'
	: >go
	end
	same_picture "$name"
	noticed "$name" "$(lost "$silent")"

	name="$method, a link that is down for a second"
	patiently begin $method
	inflict link
	sleep 1
	hosts link host2 up
	end
	same_picture "$name"
	is "$name: it is not lost" "$(grep host2 said)" ''
	noticed_ms=''
	report "$name" 0

	name="$method, a worker that stops"
	lasting $method
	inflict stop
	: >go # an idle worker need not say anything, so its silence is noticed when it has a task
	end
	is "$name: exit 0" "$status" 0
	ok "$name: the same picture" cmp out.pfm good.pfm
	# An idle node takes the late row over, so a ring need not wait until silence is noticed.
	[ $method = gdc ] || noticed "$name" "$(lost silent)"
	report "$name" .25
	if [ $method = gdc ]; then
		ok "$name: its node has killed it" await 2 none_there
	else
		is "$name: it is still there, because no signal can reach it" "$(there)" rtworker
		kill -CONT "$stopped"
		ok "$name: it ends as soon as it runs again" await 2 none_there
	fi

	name="$method, a host at 5 % of a processor"
	patiently begin $method
	inflict power
	end
	same_picture "$name"
	is "$name: it is not lost" "$(grep host2 said)" ''
	noticed_ms=''
	report "$name" .2
	hosts power host2 .25

	name="$method, a host that accepts and never answers"
	kill -STOP "$(listener)"
	begin $method
	end
	same_picture "$name"
	ok "$name: when all is done, the run does not wait until ssh gives up" never_waits 'no answer' job.log # after 10 s
	since=$begun
	report "$name" .25
	kill -CONT "$(listener)"
done

name='gdc, a node that stops'
begin gdc
inflict node
end
is "$name: exit 0" "$status" 0
ok "$name: the same picture" cmp out.pfm good.pfm
report "$name" .25
kill -CONT "$stopped"
ok "$name: it ends as soon as it runs again" await 2 none_there

name='gdc, a host that joins late'
kill -STOP "$(listener)"
lasting gdc
await 20 grep -aq 'done 0 .* w=0' job.log
kill -CONT "$(listener)"
there_too() { [ -n "$(hosts pids host2 rtworker)" ]; }
await 20 there_too
: >go
end
same_picture "$name"
ok "$name: the host does tasks" at_work

# A worker that sends nonsense: in its answer to the first probe of the link, and after some tasks.
bin=/home/render/bin
hosts run host2 mv $bin/rtworker $bin/rtworker.good
while read -r bytes pack where; do
	put host2 $bin/rtworker <<END
#!/bin/sh
$bin/rtworker.good "\$@" | { dd bs=1 count=$bytes; cat /dev/urandom; } 2>/dev/null
END
	name="masterslave, garbage $where"
	begin masterslave -z "$pack"
	end
	same_picture "$name"
	like "$name: a message says so" "$(cat said)" 'fan: (slot 1 on host2: lost|host2: cannot be used) \(garbage\)'
done <<'END'
4000 auto in an answer
40000 off between pixels
END

# ---- static methods: the missing pixels, and the same command again --------------------------------------------------------------
# incomplete NAME METHOD: the picture is incomplete, and the same command finishes it
incomplete() {
	is "$1: exit 1" "$status" 1
	is "$1: no picture" "$(ls out.pfm* 2>/dev/null)" ''
	like "$1: the missing pixels are listed" "$(cat said)" 'gather: .*[0-9]+ of 36864 pixels missing: rows? [0-9]'
	run balance "$2" -S "$file" -s 192x192 -W '-a 36' -r job.log -o out.pfm gears.nff
	is "$1: the same command exits 0" "$status" 0
	ok "$1: it finishes the picture" cmp out.pfm good.pfm
}
# host2 is slow; the others do not wait for it when it is lost.
for p in 'host1 .4' 'host2 .1' 'host3 .4'; do hosts power ${p% *} ${p#* } 2>/dev/null; done
begin interleaved
end
hosts run host2 mv $bin/rtworker.good $bin/rtworker
incomplete 'interleaved, garbage' interleaved
while read -r method fault why; do
	[ -n "${NIGHT-}" ] || [ "$fault" != stop ] || continue # silent, as behind a link
	name="$method, $fault"
	lost="fan: slot 1 on host2: lost [(]${why}[)]"
	# A scattered slot has one task, which cannot be held back.
	if [ "$method" = ss ]; then
		begin ss
		inflict "$fault"
	else
		lasting "$method"
		inflict "$fault"
		: >go
	fi
	end
	case $fault in
	stop) kill -CONT "$stopped" ;;
	link) hosts link host2 up ;;
	esac
	noticed "$name" "$lost"
	incomplete "$name" "$method"
done <<'END'
interleaved worker exit-255
ss session exit-255
interleaved stop silent
interleaved link silent
END
if [ -n "${NIGHT-}" ]; then
	name='interleaved, ssh'
	lasting interleaved
	inflict ssh
	: >go
	end
	incomplete "$name" interleaved
fi

# ---- no orphans, whichever process is killed -----------------------------------------------------------------------------------
for method in masterslave interleaved; do
	for victim in gather fan; do # gather is what balance has become
		name="$method, kill -9 of $victim"
		lasting $method
		reach_work
		kill -9 $(here $victim)
		: >go
		ok "$name: no process remains on any host" await 2 none_left
		end
	done
done
# tree: two workers on each host, under a deal there; the pid is that of the shell that waits for it.
tree() {
	rm -f out.pfm job.log go
	env MARK="$mark" sh -c '{ pack scene gears.nff; partition 192x192 | ./feed; } |
		deal -q 2 fan -S "$1" deal fan -j 2 rtworker -a 36 - | gather -r job.log -o out.pfm' tree "$file" 2>said &
	job=$!
	reach_work
}
hosts power host2 .4 # it has to start five processes
name='a tree, kill -9 of gather'
tree
kill -9 $(here gather)
: >go
ok "$name: no process remains on any host" await 2 none_left
wait $job
name='a tree, kill -9 of a worker'
tree
kill -9 "$(hosts pids host2 rtworker | head -n 1)"
remote='^host2: fan: slot [01]: lost (signal-9) with [01] tasks'
await 20 grep -q "$remote" said
: >go
wait $job
is "$name: exit 0" $? 0
ok "$name: the same picture" cmp out.pfm good.pfm
# a worker may have been between two tasks
is "$name: a message of the remote fan is shown here" "$(grep -c "$remote" said)" 1
ok "$name: no more than that" [ "$(grep -vc '^host2: ' said)" = 0 ]

# ---- the runs on their own hosts ------------------------------------------------------------------------------
wait $nobody
for name in lost never; do
	is "no host left, $name: exit 3" "$(cat $name/status)" 3
	like "no host left, $name: a message says so" "$(cat $name/said)" '^fan: no slot left'
	like "no host left, $name: the missing pixels are listed" "$(cat $name/said)" \
		'[0-9]+ of 36864 pixels missing|nothing was rendered'
	diag "no host left, $name: after $((($(cat $name/until) - $(cat $name/since)) / 1000000)) ms"
done
finish
