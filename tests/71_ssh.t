#!/bin/sh
# Three hosts of unequal power, reached by ssh, without the clone and the scene: the same pixels by every method,
# however the hosts are named and whatever their start-up files print. A host that would spoil the picture is refused by
# name.
want_hosts=3
. "$(dirname "$0")/hosts.sh"
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for hosts
spdgen -s 2 gears >gears.nff
for samples in 9 64; do partition 96x96 | rtworker -a $samples gears.nff | gather -o good$samples.pfm; done
file=$TEST_HOSTS/hosts bin=/home/render/bin
unequal
patient

# render NAME METHOD HOSTS [SAMPLES]: exit 0 and the same picture; `said` has the messages. With 64 samples every host
# connects before the run ends.
render() {
	rm -f out.pfm job.log
	run balance "$2" -S "$3" -s 96x96 -W "-a ${4:-9}" -o out.pfm -r job.log gears.nff
	printf '%s\n' "$err" >said
	is "$1: exit 0" "$status" 0
	[ "$status" = 0 ] || diag "$err"
	ok "$1: the same picture" cmp out.pfm "good${4:-9}.pfm"
}
# heard NAME HOSTS ERE: the same with deal, whose input stays open until fan has printed this message
heard() {
	rm -f out.pfm job.log
	: >said
	{ pack scene gears.nff; partition 96x96; await 10 grep -Eq "$3" said; } |
		deal fan -S "$2" rtworker -a 64 - 2>>said | gather -o out.pfm -r job.log 2>>said
	is "$1: exit 0" $? 0
	ok "$1: the same picture" cmp out.pfm good64.pfm
}
slots_in() { fragstat "$1" | awk 'NR > 1 && $2 > 0 { printf "%s ", $1 }'; } # that have done something

# ---- every method, on hosts that have only the programs -----------------------------------------------------
for h in host1 host2 host3; do
	is "$h is another host" "$(ssh $h 'hostname; echo $SSH_CONNECTION' | tr '\n' ' ' | cut -d ' ' -f 1,2)" "$h 198.18.0.254"
	is "$h has neither the clone nor the scene" "$(ls -d "$root/bin/fan" "$tmp/gears.nff" | wc -l
		ssh $h ls -d "$root/*" "$tmp" 2>/dev/null | wc -l)" "2
0"
done
run fan -l -S "$file" rtworker -
is 'fan -l names the hosts in the order of the file' "$(echo "$out" | cut -f 1,2 | tr '\t\n' '  ')" \
	'0 host1 1 host2 2 host3 '
is 'fan -l measures the power of the hosts' "$(echo "$out" | awk '$3 > 0' | wc -l)" 3
methods=$(balance -h | sed -n 's/^methods: *//p')
for method in $methods; do
	render "$method on three hosts" "$method" "$file"
	is "$method: no message" "$(unexpected said | grep -v '^balance auto: ')" ''
done

# ---- nothing is installed on the hosts --------------------------------------------------------------------------------
if there "$root/build/static/rtworker"; then
	sed 's/ bin=.*/ send=auto/' "$file" >send.hosts
	is 'no host has a worker on its PATH' "$(for h in host1 host2 host3; do ssh $h command -v rtworker; done)" ''
	render 'programs are sent' masterslave send.hosts 64
	is 'programs are sent: each host gets the worker once' "$(grep 'is sent' said | sed 's/ is sent.*//' | sort)" 'fan: host1: rtworker
fan: host2: rtworker
fan: host3: rtworker'
	render 'programs were sent before' gdc send.hosts 64
	is 'programs were sent before: the worker is not sent again' "$(grep -c 'rtworker is sent' said)" 0
else
	skip 'programs are sent' "$missing is not there"
fi

# ---- how hosts are named and reached -------------------------------------------------------------------------------
for h in host1 host2; do hosts run $h sh -c "ln -s $bin/* /usr/local/bin"; done
render 'a comma list with slots, a user and this machine' interleaved 2/host1,root@host2,:
is 'every slot did its part' "$(slots_in job.log)" '0 1 2 3 '
cat >via.hosts <<END
# by a name that only we know, and by hand
other-user slots=2 via="ssh -T host1 %c # %h" bin=$bin   # a comment
198.18.0.2 via="ssh -l root -o HostKeyAlias=host2 -i $TEST_HOSTS/user %h %c" bin=$bin power=.3
END
render 'a hosts file with via' interleaved via.hosts
is 'a hosts file with via: every slot did tasks' "$(slots_in job.log)" '0 1 2 '

# ---- a tree: one connection and one scene per host -------------------------------------------------------------------
accepted() { for h in host1 host2; do hosts run $h grep -c Accepted /run/sshd.log; done; }
# both_up: waits until both hosts are up, so that neither can do all tasks before the other has come
both_up() { await 60 sh -c '[ "$(grep -ac "^up w=[01] " up)" -ge 2 ]'; }
before=$(accepted)
# connected NAME N: since then each host was connected to N times. No host is lost because load makes it silent for long.
connected() { is "$1" "$(accepted | tr '\n' ' ')" "$(echo "$before" | awk -v n="$2" '{ printf "%d ", $1 + n }')"; }
: >up
{ pack scene gears.nff; both_up; partition 96x96; } |
	deal -q 4 sh -c 'fan -t 1e5 -S host1,host2 deal fan -j 2 rtworker -a 64 - | tee up' 2>said | gather -o tree.pfm -r tree.log
ok 'deal fan -S host1,host2 deal fan -j 2: the same picture' cmp tree.pfm good64.pfm
is 'a tree: no message' "$(unexpected said)" ''
connected 'a tree: one connection per host' 1
like 'a tree: two leaves per host' "$(slots_in tree.log)" '([01]\.[01] ){3}'

: >up
{ pack scene gears.nff; both_up; partition -n 2 96x96; } |
	ringctl sh -c 'fan -t 1e5 -S host1,host2 ringctl -n deal fan -j 2 rtworker -a 64 - | tee up' 2>said | gather -o ring.pfm -r ring.log
ok 'ringctl fan -S host1,host2 ringctl -n deal fan -j 2: the same picture' cmp ring.pfm good64.pfm
is 'a ring: no message' "$(unexpected said)" ''
connected 'a ring: one connection per host' 2
like 'a ring: two leaves per host' "$(slots_in ring.log)" '([01]\.[01] ){3}'

# ---- an ssh_config for a person's sessions -----------------------------------------------------------------------------
cp "$TEST_HOSTS/config" config.kept
cat - config.kept >"$TEST_HOSTS/config" <<END
Host *
	LocalForward 7777 localhost:22
	RemoteForward 7778 localhost:22
	DynamicForward 7779
	ExitOnForwardFailure yes
	Tunnel yes
	ForwardAgent yes
	ForwardX11 yes
	RemoteCommand touch /tmp/remote
	PermitLocalCommand yes
	LocalCommand touch $tmp/local
	RequestTTY force
	ControlMaster auto
	ControlPath $tmp/%C
END
listening() { awk 'NR > 1 && $4 == "0A" && $2 ~ /:1E6[123]$/ { print $2 }'; } # on 7777 to 7779
: >up
rm -f looked out.pfm
{ pack scene gears.nff; partition 96x96; until [ -e looked ]; do sleep .05; done; } |
	deal sh -c 'fan -t 1e5 -S host1,host2 rtworker -a 9 - | tee up' 2>said | gather -o out.pfm &
pid=$!
ok "a person's ssh_config: two hosts are up" both_up
is "a person's ssh_config: no port is open here" "$(cat /proc/net/tcp /proc/net/tcp6 | listening)" ''
is "a person's ssh_config: no port is open on the host" "$(hosts run host1 cat /proc/net/tcp /proc/net/tcp6 | listening)" ''
: >looked
wait $pid
ok "a person's ssh_config: the same picture" cmp out.pfm good9.pfm
is "a person's ssh_config: no message" "$(unexpected said)" ''
is "a person's ssh_config: none of its commands runs" "$(ls local 2>/dev/null; hosts run host1 find /tmp -name remote; find . -type s)" ''
cp config.kept "$TEST_HOSTS/config"

# ---- output of start-up files, and workers' standard error -----------------------------------------
hosts run host2 sh -c 'cat >/root/.bashrc' <<'END'
echo "Welcome to host2.  Today: hello, frames and tasks"
echo "task 0 0 0 0 1 1 1 1"; head -c 20000 /dev/zero | tr '\0' '#'
echo "the disk is nearly full" >&2
END
render 'a host that talks first' interleaved "$file"
is "lines of a host's standard error begin with its name" "$(grep -v 'never connected$' said)" 'host2: the disk is nearly full'
echo 'while echo more; do :; done' | hosts run host2 sh -c 'cat >>/root/.bashrc'
render 'a host that talks for ever' masterslave "$file" 64
like 'a host that talks for ever: it is named, and its output is shown' "$(cat said)" \
	'^fan: host2: cannot be used \(no-hello\), it says: Welcome to host2\.'
hosts run host2 rm /root/.bashrc
put host3 $bin/loud <<'END'
#!/bin/sh
printf 'one line,\r\n\033]0;title\007 no new line' >&2
exec rtworker "$@"
END
# It cannot run here and on hosts that lack it; messages say so.
{ pack scene gears.nff; partition 96x96; } |
	deal fan -S "$file" loud -a 9 - 2>said | gather -o loud.pfm
ok 'a worker that is only on one host: the same picture' cmp loud.pfm good9.pfm
like "each line of a worker's messages begins with its host" "$(cat said)" '^host3: one line,$'
like "a worker's messages cannot control the terminal" "$(cat said)" '^host3: \\x1b]0;title\\x07 no new line$'
like 'a worker that is only on one host: a message names the other hosts' "$(cat said)" '^fan: host1: no loud in /home/render/bin, nor on its PATH; install it there$'

# ---- hosts that are refused, or not reached --------------------------------------------------------------------------------
# other HOST SCRIPT: rtworker there is filtered by sed
other() {
	hosts run "$1" mv $bin/rtworker $bin/rtworker.good
	printf '#!/bin/sh\n%s/rtworker.good "$@" | sed -u "1s/ sum=.*//; %s"\n' $bin "$2" | put "$1" $bin/rtworker
}
as_before() { hosts run "$1" mv $bin/rtworker.good $bin/rtworker; }
other host2 '1s/selftest=./selftest=x/'
heard 'a host of other arithmetic' "$file" 'host2: refused'
like 'a host of other arithmetic: refused by name and reason' "$(cat said)" '^fan: host2: refused: its arithmetic differs'
ok 'a host of other arithmetic: it did no task' [ "$(slots_in job.log | grep -c 1)" = 0 ]
as_before host2
other host2 '1s/rtworker [^ ]*/rtworker 99/'
heard 'a host of another version' "$file" 'host2: refused'
like 'a host of another version: refused by name and reason' "$(cat said)" \
	'^fan: host2: refused: it runs rtworker 99, expected rtworker '
as_before host2
cat "$file" - >more.hosts <<END
nowhere bin=$bin
nobody.invalid bin=$bin
host3 bin=/home/nothing
END
heard 'an address without answer, an unknown name, and no programs' more.hosts 'host3: no rtworker'
like 'slots that did not answer are counted' "$(cat said)" '^fan: [3-5] of 6 slots never connected$'
like 'a name, and no resolver' "$(cat said)" '^fan: nobody\.invalid: its name cannot be resolved now; trying again'
like 'the message says that the programs are missing' "$(cat said)" '^fan: host3: no rtworker in /home/nothing, nor on its PATH; install it there$'
cp "$TEST_HOSTS/known_hosts" known
sed "s,^host2 .*,$(sed -n 's/^host1 /host2 /p' known)," known >"$TEST_HOSTS/known_hosts"
render 'a host that shows another key' masterslave "$file" 64
is 'a host that shows another key is not trusted' "$(grep host2 said)" \
	'fan: host2: host key has changed; if that is expected, remove the old key with: ssh-keygen -R host2'
ok 'a host that shows another key gets no task' [ "$(slots_in job.log | grep -c 1)" = 0 ]
cp known "$TEST_HOSTS/known_hosts"

# ---- failures that no second try can mend: one line and one try; without another host the run ends ------------------------
cat >ssh <<END
#!/bin/sh
echo try >>$tmp/tries
exec $TEST_HOSTS/bin/ssh "\$@"
END
chmod +x ssh
echo 'hosts: files' >nsswitch # the resolver answers, and knows no such name
# final NAME HOSTS LINE
final() {
	rm -f tries
	PATH=$tmp:$PATH run unshare -m sh -c 'mount --bind nsswitch /etc/nsswitch.conf; exec "$@"' sh \
		balance masterslave -S "$2" -s 96x96 -o none.pfm gears.nff
	is "$1: exit 3" "$status" 3
	is "$1: one line" "$(printf '%s\n' "$err" | grep -v '^gather: \|^deal: ')" "fan: $3
fan: no slot left"
	is "$1: one try" "$(wc -l <tries)" 1
}
grep -v '^host1 ' known >"$TEST_HOSTS/known_hosts"
final 'an unknown host key' 4/host1 'host1: host key unknown; accept it once with: ssh host1 true'
cp known "$TEST_HOSTS/known_hosts"
hosts run host1 mv /home/sshd/user.pub /home/sshd/user.away
final 'a refused key' 4/me@host1 'me@host1: key refused; install your key with: ssh-copy-id me@host1'
hosts run host1 mv /home/sshd/user.away /home/sshd/user.pub
final 'a name that is none' 4/rendr1 'rendr1: unknown host name; check the hosts file, or -S'
final 'a file that is none' rendr1 '-S rendr1: no such file, and no host of that name'
echo 'host3 slots=4 bin=/home/nothing' >nothing
final 'no worker' nothing 'host3: no rtworker in /home/nothing, nor on its PATH; install it there'
final 'no worker, nor bin=' 4/host3 \
	'host3: no rtworker on its PATH; install it there, or say bin=DIRECTORY in a hosts file'
hosts run host3 sh -c 'mkdir /home/odd && echo data >/home/odd/rtworker'
echo 'host3 slots=4 bin=/home/odd' >odd
final 'a worker that is no program' odd 'host3: rtworker cannot be run there; install one for that machine'
printf 'Host *\n Nosuch yes\n' >bad_config
echo "host1 slots=4 via=\"$tmp/ssh -F bad_config %h %c\"" >bad
final 'a bad configuration' bad 'host1: ssh does not start: bad_config: line 2: Bad configuration option: nosuch'

# ---- a slow link, and a scene that takes long on it ------------------------------------------------------------
spdgen -s 3 gears >large.nff # 600 kB: more than a second at this rate
partition 64x64 | rtworker large.nff | gather -o large.pfm
hosts link host3 4mbit
for method in masterslave interleaved; do
	rm -f out.pfm job.log
	run balance $method -S "$file" -s 64x64 -o out.pfm -r job.log large.nff
	is "$method, one link slow: exit 0" "$status" 0
	ok "$method, one link slow: the same picture" cmp out.pfm large.pfm
	is "$method, one link slow: no message" "$(printf '%s\n' "$err" | sed '/^$/d' | unexpected -)" ''
	diag "$method: $(fragstat job.log | awk '$1 == 2 { print $2 }') of 64 rows by the host behind it"
done
hosts link host3 up
for h in host1 host2 host3; do
	is "$h: no worker is left" "$(for p in rtworker loud fan deal; do hosts pids $h $p; done)" ''
done
finish
