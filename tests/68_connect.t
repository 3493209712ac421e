#!/bin/sh
# Connections that fail. A failure that no retry can mend ends the host at once, with one line that says what to do.
# After other failures fan tries again and says so. Scripts print the messages of ssh; 71_ssh.t uses ssh itself.
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others

spdgen -s 2 gears >gears.nff
size=32x24
partition $size | rtworker gears.nff | gather -o good.pfm
{ pack scene gears.nff; partition $size; } >job.task

# A script in the place of ssh: says/NAME has its messages, status/NAME its status; each try adds a line to tries.
cat >ssh <<'END'
#!/bin/sh
for name; do [ ! -e "says/$name" ] || break; done
echo "$name" >>tries
cat "says/$name" >&2
exit "$(cat "status/$name")"
END
chmod +x ssh
mkdir says status
PATH=$tmp:$PATH
# says NAME STATUS: standard input has the messages
says() { cat >"says/$1"; echo "$2" >"status/$1"; }

# ---- failures without a second try ----------------------------------------------------------------------------------------------
complained() { [ -s tries ] && grep -q '^fan: far' .err; }
# ends NAME STATUS LINE: beside this machine's slot, a host of three slots ends with one line
ends() {
	says far "$2"
	rm -f tries
	run eval '{ cat job.task; await 5 complained; } | in_time deal fan -S :,3/far rtworker - | gather -o out.pfm'
	is "$1: one line, and how many are missing" "$err" "fan: far: $3
fan: 3 of 4 slots never connected"
	ok "$1: the same picture" cmp out.pfm good.pfm
	is "$1: one try" "$(cat tries)" far
	rm -f tries
	run in_time sh -c 'fan -S 3/far rtworker - <job.task >frags'
	is "$1: no other host: exit 3, at once" "$status:$err" "3:fan: far: $3
fan: no slot left"
	is "$1: no other host: one try" "$(cat tries)" far
}
ends 'an unknown host key' 255 'host key unknown; accept it once with: ssh far true' <<'END'
No ED25519 host key is known for far and you have requested strict checking.
Host key verification failed.
END
ends 'another host key' 255 'host key has changed; if that is expected, remove the old key with: ssh-keygen -R far' <<'END'
@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@
@    WARNING: REMOTE HOST IDENTIFICATION HAS CHANGED!     @
@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@
IT IS POSSIBLE THAT SOMEONE IS DOING SOMETHING NASTY!
Offending ED25519 key in /root/.ssh/known_hosts:2
Host key for far has changed and you have requested strict checking.
Host key verification failed.
END
ends 'a refused key' 255 'key refused; install your key with: ssh-copy-id far' <<'END'
me@far: Permission denied (publickey,password).
END
ends 'too many keys' 255 'too many keys were offered; name one in ~/.ssh/config, with IdentitiesOnly yes' <<'END'
Received disconnect from 198.18.0.1 port 22:2: Too many authentication failures
Connection closed by 198.18.0.1 port 22
END
ends 'an unknown name' 255 'unknown host name; check the hosts file, or -S' <<'END'
ssh: Could not resolve hostname far: Name or service not known
END
ends 'no common algorithm' 255 'ssh and sshd do not agree: Unable to negotiate with far port 22: no matching host key type found.' <<'END'
Unable to negotiate with far port 22: no matching host key type found.
END
ends 'a bad ssh_config' 255 'ssh does not start: /root/.ssh/config: line 3: Bad configuration option: nosuch' <<'END'
/root/.ssh/config: line 3: Bad configuration option: nosuch
END
ends 'no worker there' 127 'no rtworker on its PATH; install it there, or say bin=DIRECTORY in a hosts file' <<'END'
bash: line 1: exec: rtworker: not found
END
ends 'a worker of another machine' 126 'rtworker cannot be run there; install one for that machine' <<'END'
bash: line 1: /usr/local/bin/rtworker: cannot execute binary file: Exec format error
END
ends 'a worker that ends' 3 'cannot be used (exit-3)' </dev/null

# In a hosts file: where the programs are, and another way, for which advice about ssh would be wrong.
says far 127 </dev/null
echo 'far bin=/opt/bin' >binned
run in_time sh -c 'fan -S binned rtworker - <job.task >frags'
is 'bin= without a worker' "$err" 'fan: far: no rtworker in /opt/bin, nor on its PATH; install it there
fan: no slot left'
echo 'Host key verification failed.' | says far 255
echo 'far via="ssh -p 2222 %h %c"' >by-via
run in_time sh -c 'fan -S by-via rtworker - <job.task >frags'
like 'via=, and an unknown key' "$err" '^fan: far: host key unknown; connect to it once by hand, as its via= does$'
# A launcher that this machine lacks.
mkdir few
for program in sh env rtworker fan; do ln -s "$(command -v $program)" few; done
echo 'far via="nosuchlauncher -N 1 %h %c"' >launched
echo 'far via="./nosuchlauncher %h %c"' >local
while IFS='|' read -r hosts line; do
	run in_time env PATH="$tmp/few" fan -S "$hosts" rtworker - <job.task
	is "-S $hosts, no such launcher here: exit 3, and one line" "$status:$err" "3:fan: far: no $line
fan: no slot left"
done <<'END'
1/far|ssh on this machine; install it here, or state another way with via= in a hosts file
launched|nosuchlauncher on this machine; install it here, or change via= in a hosts file
local|./nosuchlauncher on this machine; install it here, or change via= in a hosts file
END

rm tries
printf 'far slots=2\nalso slots=2\n' >two
echo 'ssh: Could not resolve hostname also: Name or service not known' | says also 255
run in_time balance calibrate -n 2 -s 16x16 -S two gears.nff
is 'calibrate: exit 3' "$status" 3
is 'calibrate: one line per host, with the result' "$(printf '%s\n' "$err" | sort)" 'balance calibrate: also: not measured
balance calibrate: far: not measured
fan: also: unknown host name; check the hosts file, or -S
fan: far: host key unknown; accept it once with: ssh far true'
is 'calibrate: one try each' "$(sort tries | tr '\n' ' ')" 'also far '

# A single name may be meant as a file.
cp says/also says/nosuch; cp status/also status/nosuch
run in_time sh -c 'fan -S nosuch rtworker - <job.task >frags'
is 'a single name that is neither file nor host: exit 3, and a message' "$status:$err" '3:fan: -S nosuch: no such file, and no host of that name
fan: no slot left'

# ---- failures with another try ------------------------------------------------------------------------------------------------
cat >later <<'END'
#!/bin/sh
[ -s tries ] || { echo later >>tries; cat says/later >&2; exit 255; }
exec sh -c "$1"
END
chmod +x later
echo 'later via="./later %c"' >later.hosts
# again NAME LINE: a host that fails once with LINE, and then does tasks
again() {
	cat >says/later
	rm -f tries
	run in_time sh -c 'fan -S later.hosts rtworker - <job.task | gather -o out.pfm'
	is "$1: messages say that fan tries again, and that the host is up" "$err" "fan: later: $2
fan: slot 0 on later: is up"
	ok "$1: the same picture" cmp out.pfm good.pfm
}
again 'no sshd listens' 'connection refused; trying again for up to 30 s' <<'END'
ssh: connect to host later port 22: Connection refused
END
again 'a host that is down' 'no route to it; trying again for up to 30 s' <<'END'
ssh: connect to host later port 22: No route to host
END
again 'a host that hangs' 'no answer; trying again for up to 30 s' <<'END'
Connection timed out during banner exchange
Connection to 198.18.0.1 port 22 timed out
END
again 'a resolver that is down' 'its name cannot be resolved now; trying again for up to 30 s' <<'END'
ssh: Could not resolve hostname later: Temporary failure in name resolution
END
again 'no reason' 'cannot be reached (exit-255); trying again for up to 30 s' </dev/null

# fan -l asks a host once more, not once for each slot.
echo 'ssh: connect to host down port 22: Connection refused' | says down 255
rm -f tries
run in_time fan -l -S 5/down rtworker
is 'fan -l: exit 1, and one line' "$status:$err" '1:fan: down: connection refused; trying again'
is 'fan -l: two tries' "$(tr '\n' ' ' <tries)" 'down down '

# Lines that look like a failure are shown if there is none.
cat >warned <<'END'
#!/bin/sh
printf '@@@@@@@@@@@@ WARNING\nmore of it\n' >&2
exec sh -c "$1"
END
chmod +x warned
echo 'warned via="./warned %c"' >warned.hosts
run in_time sh -c 'fan -S warned.hosts rtworker - <job.task | gather -o out.pfm'
is 'a warning without a failure is shown' "$err" 'warned: @@@@@@@@@@@@ WARNING
warned: more of it'
ok 'a warning, and no failure: the same picture' cmp out.pfm good.pfm

# A host that was up is tried again after any message.
cat >once <<'END'
#!/bin/sh
echo try >>tries
case $(wc -l <tries) in
1) sh -c "$1" | dd bs=1 count=300 2>/dev/null; exit 255 ;;
2) echo 'me@once: Permission denied (publickey).' >&2; exit 255 ;;
esac
exec sh -c "$1"
END
chmod +x once
echo 'once via="./once %c"' >once.hosts
rm -f tries
run in_time sh -c 'deal fan -z off -S once.hosts rtworker - <job.task | gather -o out.pfm'
ok 'a host that was up, then refuses: the same picture' cmp out.pfm good.pfm
like 'a host that was up, then refuses: it is tried again' "$err" \
	'^fan: once: key refused; connect to it once by hand, as its via= does; trying again for up to 10 minutes$'

# ---- containers and queues that are not ready, and lines of several tries ----------------------------------------------
# starting NAME STATUS: a launcher other than ssh, which fails twice with two lines
cat >starting <<'END'
#!/bin/sh
echo try >>tries
[ "$(wc -l <tries)" -gt 2 ] || { printf 'Error: no such container\nIt may start later.\n' >&2; exit "$(cat code)"; }
exec sh -c "$1"
END
chmod +x starting
echo 'starting via="./starting %c"' >starting.hosts
for code in 1 125 255; do
	echo $code >code
	rm -f tries
	run in_time sh -c 'fan -S starting.hosts rtworker - <job.task | gather -o out.pfm'
	is "a launcher that is not ready, exit $code: each line once, and that fan tries again" "$err" "starting: Error: no such container
starting: It may start later.
fan: starting: cannot be reached (exit-$code); trying again for up to 30 s
fan: slot 0 on starting: is up"
	ok "a launcher that is not ready, exit $code: the same picture" cmp out.pfm good.pfm
done

# A connection that breaks while its link is measured: what fan has sent for that is not shown as words of the host.
cat >broken <<'END'
#!/bin/sh
mkdir broken.once 2>/dev/null || exec sh -c "$1"
sh -c "$1" | dd bs=1 count=9000 2>/dev/null
exit 255
END
chmod +x broken
echo 'broken via="./broken %c"' >broken.hosts
run in_time sh -c 'deal fan -S broken.hosts rtworker - <job.task | gather -o out.pfm'
is 'a connection that breaks while its link is measured: a message says so' "$err" \
	'fan: broken: cannot be reached (exit-255), while its link was measured; trying again for up to 30 s
fan: slot 0 on broken: is up'

# ---- many hosts ------------------------------------------------------------------------------------------------------
# Those that are silent are so for longer than a test may take.
printf '#!/bin/sh\nexec sleep 7200\n' >silent
chmod +x silent
{ seq -f 'silent%g via="./silent %%c"' 40; echo 'live via="sh -c %c"'; seq -f 'more%g via="./silent %%c"' 9; } >room
run in_time sh -c 'deal fan -t 1e5 -S room rtworker - <job.task | gather -o out.pfm'
is 'a host behind many silent ones waits for none of them' "$status$err" '0fan: 49 of 50 slots never connected'
ok 'a host behind many silent ones: the same picture' cmp out.pfm good.pfm

# An ssh whose configuration has a jump host. Each connection counts those that are being opened.
mkdir jumps now
cat >jumps/ssh <<'END'
#!/bin/sh
case "$1 $2" in '-v -G') printf 'user me\nproxyjump bastion\n'; echo "debug1: Reading configuration data $PWD/jumps/config" >&2; exit ;; esac
mkdir "now/$$"; ls now | wc -l >>most; sleep .1; rmdir "now/$$"
for command; do :; done
exec sh -c "$command"
END
chmod +x jumps/ssh
printf '# ProxyJump none\nHost *\n\tProxyJump = bastion\n' >jumps/config
all_up() { [ "$(grep -ac '^up ' jumps.frags)" -ge 20 ]; }
: >jumps.frags
{ cat job.task; await 60 all_up; } | PATH=$tmp/jumps:$PATH fan -S "$(seq -f far%g -s , 20)" rtworker - >jumps.frags
ok 'one jump host: all hosts are up' all_up
ok 'one jump host: at most 8 connections are opened at a time' [ "$(sort -n most | tail -n 1)" -le 8 ]

# ---- output of hosts ---------------------------------------------------------------------------------------------
printf '#!/bin/sh\nseq 20000 >&2; exec sh -c "$1"\n' >flood
chmod +x flood
echo 'flood via="./flood %c"' >flood.hosts
run in_time sh -c 'fan -S flood.hosts rtworker - <job.task | gather -o out.pfm'
ok 'a flood of messages: the same picture' cmp out.pfm good.pfm
is 'a flood of messages: each is shown or counted' "$(printf '%s\n' "$err" | awk '/^flood: / { n++ }
	/^fan: flood: [0-9]+ more lines of messages dropped$/ { n += $3 } END { print n }')" 20000
ok 'a flood of messages: most are not shown' [ "$(printf '%s\n' "$err" | wc -l)" -lt 5000 ]

# ---- no host left --------------------------------------------------------------------------------------------
for input in /dev/null job.task; do for chain in fan 'fan -1' 'deal fan' 'deal fan -1' 'ringctl fan'; do
	run in_time sh -c "$chain -j 3 nosuchprogram <$input"
	is "$chain, a worker that is not here, input $input: exit 3, and why" \
		"$status:$(printf '%s\n' "$err" | grep -v '^[dr][a-z]*: fan ended with [0-9]* tasks unfinished')" \
		'3:fan: nosuchprogram: No such file or directory
fan: no slot left'
done; done
# shellcheck disable=SC3045  # dash and bash both know -n
run in_time sh -c '(ulimit -n 40; exec deal fan -j 30 rtworker -) <job.task | gather -o out.pfm'
is 'more slots than files may be open: why, and how many' "$(printf '%s\n' "$err" | sed 's/[0-9]* of/N of/')" \
	'fan: rtworker: Too many open files
fan: N of 30 slots never connected'
ok 'more slots than files may be open: the same picture' cmp out.pfm good.pfm
finish
