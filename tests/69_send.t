#!/bin/sh
# Hosts without programs (send=auto): static programs travel over the connection once, and give the same pixels by every
# method. Hosts that cannot take or run them end with one line, and the others go on. The hosts are commands on this
# machine; one has nothing but busybox.
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
static=${BIN%/bin}/static
[ "$BIN" != "$root/bin" ] || static=$root/build/static
needs "$static/rtworker" busybox

spdgen -s 2 gears >gears.nff
size=48x40
partition $size | rtworker gears.nff | gather -o good.pfm
{ pack scene gears.nff; partition $size; } >job.task

# host NAME COMMAND: a host with two slots, at which COMMAND runs its argument; the hosts file is NAME.hosts
host() {
	printf '#!/bin/sh\n%s\n' "$2" >"$1"
	chmod +x "$1"
	echo "$1 slots=2 send=auto via=\"./$1 %c\"" >"$1.hosts"
}
# bare NAME [ENVIRONMENT]: a host with an environment of its own; bytes.NAME has what it was sent
bare() { host "$1" "tee bytes.$1 | env -i XDG_CACHE_HOME='$tmp/cache.$1' ${2-} /bin/sh -c \"\$1\""; }
cached() { echo "cache.$1/stormring"/*/"$2"; }
# works NAME HOST [FAN-OPTION]: the same picture; `said` has the messages
works() {
	rm -f out.pfm
	deal -q 1 fan ${3-} -S "$2.hosts" rtworker - <job.task 2>said | gather -o out.pfm 2>>said
	ok "$1: the same picture" cmp out.pfm good.pfm
	grep -v 'never connected$' said >messages
}
bytes=$(wc -c <"$static/rtworker")
sent="fan: %s: rtworker is sent, $bytes bytes"

# ---- once ---------------------------------------------------------------------------------------------------------
bare far
fan -S 1/: rtworker - <job.task >/dev/null
sed 's/slots=2/slots=1/' far.hosts >one.hosts
fan -z off -S one.hosts rtworker - <job.task 2>said >/dev/null
is 'the first run says that the worker is sent' "$(cat said)" "$(printf "$sent" far)"
first=$(wc -c <bytes.far)
fan -z off -S one.hosts rtworker - <job.task 2>said >/dev/null
is 'the second run says nothing' "$(cat said)" ''
is 'the second run sends the stream only' "$((first - $(wc -c <bytes.far)))" "$bytes"
hash=$(sha256sum <"$static/rtworker" | cut -d ' ' -f 1)
is 'the worker has its hash as a name' "$(cached far rtworker)" "cache.far/stormring/$hash/rtworker"
is 'nothing else is left there' "$(find cache.far ! -type d)" "$(cached far rtworker)"
is 'only the user can read it' "$(find cache.far -perm 700 | wc -l)" 4
works 'two slots' far
is 'two slots: nothing is sent' "$(cat messages)" ''
works 'one worker for two slots' far -1
is 'one worker for two slots: nothing is sent' "$(cat messages)" ''

# The way to the directory is exchanged once the script has looked at it: the directory is used that was looked at.
mkdir mine theirs swap
ln -s mine way
printf '#!/bin/sh\nln -sfn theirs "%s/way"\nexec /bin/chmod "$@"\n' "$tmp" >swap/chmod
chmod +x swap/chmod
host swapped "env -i PATH='$tmp/swap:$PATH' XDG_CACHE_HOME='$tmp/way' /bin/sh -c \"\$1\""
sed -i 's/slots=2/slots=1/' swapped.hosts
works 'a link that is exchanged on the way' swapped
is 'a link that is exchanged on the way: the worker is where it led at first' "$(find mine theirs -name rtworker | cut -d / -f 1)" mine

echo x | dd of="$(cached far rtworker)" bs=1 seek=70000 conv=notrunc 2>/dev/null
works 'a damaged worker there' far
is 'a damaged worker there is replaced' "$(cat messages)" "$(printf "$sent" far)"
truncate -s 70000 "$(cached far rtworker)"
works 'a truncated worker there' far
is 'a truncated worker there is replaced' "$(cat messages)" "$(printf "$sent" far)"
works 'after that' far
is 'after that nothing is sent' "$(cat messages)" ''
is 'and nothing else is left there' "$(find cache.far -name state -prune -o ! -type d -print)" "$(cached far rtworker)"

# Something else has the place of the worker.
for kind in 'mkdir' 'mkfifo'; do
	bare "$kind"
	mkdir -p "cache.$kind/stormring/$hash" && $kind "cache.$kind/stormring/$hash/rtworker"
	run timeout 800 fan -S "$kind.hosts" rtworker - <job.task
	like "a $kind in the place of the worker" "$status $err" "^3 .*/$hash/rtworker: is no file"
	is "a $kind there: nothing is left" "$(ls "cache.$kind/stormring/$hash")" rtworker
done

# Programs of earlier versions: the time of a file is that of its last use.
mkdir cache.far/stormring/old cache.far/stormring/young
for place in old young; do cp "$static/deal" "cache.far/stormring/$place/deal"; done
touch -d '40 days ago' cache.far/stormring/old/deal "$(cached far rtworker)"
touch -d '20 days ago' cache.far/stormring/young/deal
works 'a worker that was not used for 40 days' far
is 'a worker that was not used for 40 days: it is used, and nothing is removed' "$(cat messages)$(cd cache.far/stormring && ls -d old/* young/*)" \
	'old/deal
young/deal'
is '... and it counts as used now' "$(find cache.far -name rtworker -mtime -1 | wc -l)" 1
truncate -s 70000 "$(cached far rtworker)"
works 'another worker is sent' far
is 'another worker is sent: programs that were not used for 30 days are removed' "$(cd cache.far/stormring && ls -d old* young/*)" \
	'old
young/deal'
touch -d '40 days ago' cache.far/stormring/old
truncate -s 70000 "$(cached far rtworker)"
works 'another worker is sent later' far
is 'another worker is sent later: an empty directory is removed as well' "$(cd cache.far/stormring && ls -d old* young/* 2>/dev/null)" young/deal
rm -r cache.far/stormring/young

# ---- every method, both workers, trees ---------------------------------------------------------------------------------
bare near
cat far.hosts near.hosts >both.hosts
for method in $(balance -h | sed -n 's/^methods: *//p'); do
	rm -f out.pfm
	run balance "$method" -S both.hosts -s $size -o out.pfm gears.nff
	ok "$method: the same picture" cmp out.pfm good.pfm
done
like 'by gdc both programs of a node are sent' "$(cd cache.far/stormring && echo [0-9a-f]*/*)" '^[0-9a-f]+/r[a-z]+ [0-9a-f]+/r[a-z]+$'
rm -f out.pfm
fan -S one.hosts deal fan -j 2 rtworker - <job.task 2>said | gather -o out.pfm
ok 'a tree: the same picture' cmp out.pfm good.pfm
is 'a tree: what the host lacked is sent' "$(sed 's/ is sent.*//' said | sort)" 'fan: far: deal
fan: far: fan'
awk 'BEGIN {
	print "# vtk DataFile Version 3.0\nsum\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 6 6 6"
	for (k = 0; k < 3; k++) print substr("XYZ", k + 1, 1) "_COORDINATES 6 float\n0 1 2 3 4 5"
	print "POINT_DATA 216\nSCALARS sum float 1\nLOOKUP_TABLE default"
	for (i = 0; i < 216; i++) print i % 6 + i % 36 / 6
}' >sum.vtk
printf '%s\n' 'from 12 -9 8' 'at 2.5 2.5 2.5' 'up 0 0 1' 'angle 40' 'resolution 30 20' 'map 2 1 0 0 .1' 'map 9 0 0 1 .9' >sum.spec
balance interleaved -j 1 -o volume.pfm sum.vtk sum.spec
run balance interleaved -1 -S one.hosts -o out.pfm sum.vtk sum.spec
ok 'vcworker -j: the same picture' cmp out.pfm volume.pfm
is 'vcworker is sent' "$err" "fan: far: vcworker is sent, $(wc -c <"$static/vcworker") bytes"

# ---- shells, start-up files, odd paths ------------------------------------------------------------------------------
# Each of them has an empty cache, and a PATH that is of no use.
for shell in dash bash 'busybox sh' 'zsh -f' tcsh fish mksh; do
	there "${shell%% *}" || continue
	name=by-${shell%% *}
	host "$name" "echo 'Welcome!'; printf 'no new line'
		exec env -i PATH=/nothing HOME='$tmp/home $name' $(command -v ${shell%% *})${shell#"${shell%% *}"} -c \"\$1\""
	mkdir "home $name"
	works "$shell, a start-up file that prints" "$name"
	is "$shell: the worker is sent" "$(cat messages)" "$(printf "$sent" "$name")"
	is "$shell: it is in the home directory" "$(find "home $name" -name state -prune -o -type f -print | sed 's,[^/]*/rtworker,HASH/rtworker,')" \
		"home $name/.cache/stormring/HASH/rtworker"
done

# ---- hosts that are queued, hosts that join -------------------------------------------------------------------------
host late 'until grep -q queued said; do sleep .1; done; exec ./by-dash "$1"'
sed 's/slots=2/wait=1000/' late.hosts >queue.hosts
rm -r 'home by-dash/.cache' out.pfm
fan -S queue.hosts rtworker - <job.task 2>said | gather -o out.pfm
ok 'a host that is queued: the same picture' cmp out.pfm good.pfm
is 'a host that is queued: the worker is sent after that' "$(grep -o '^fan: late: .*queued\|^fan: late: .* is sent' said)" \
	'fan: late: queued
fan: late: rtworker is sent'
# joins COMMAND ...: a host with send=auto joins while the run waits for this message
joins() {
	message=$1
	shift
	echo : >now.hosts
	cat now.hosts by-bash.hosts >later.hosts
	rm -rf 'home by-bash/.cache' out.pfm
	: >said
	: >came
	{
		cat job.task
		await 60 test -s came # fan has read the file
		mv later.hosts now.hosts
		await 60 grep -q "$message" said
	} | deal -q 1 fan -S now.hosts "$@" 2>said | tee came | gather -o out.pfm
}
joins 'by-bash: rtworker is sent' rtworker -
ok 'a host that joins: the worker is sent, the same picture' cmp out.pfm good.pfm
joins 'hosts stay as they were' sh -c 'exec rtworker -'
ok 'a host that joins, without a static program for it: the same picture' cmp out.pfm good.pfm
like 'a host that joins, without a static program for it: one line' "$(cat said)" \
	'^fan: now.hosts: send=auto: no word of .*; the hosts stay as they were$'

# ---- hosts that cannot take it ----------------------------------------------------------------------------------------
# ends NAME HOST REASON: a host that is refused with one line, without a second try, while this machine goes on; without
# another host the run ends
ends() {
	echo : | cat - "$2.hosts" >with.hosts
	rm -f out.pfm
	: >said
	{ cat job.task; await 30 grep -q "^fan: $2: no program" said; } |
		deal -q 1 fan -S with.hosts rtworker - 2>said | gather -o out.pfm 2>>said
	is "$1: one line" "$(grep -v ' is sent, \|never connected$' said)" "fan: $2: no program can be sent: $3"
	ok "$1: the others go on" cmp out.pfm good.pfm
	run fan -S "$2.hosts" rtworker - <job.task
	is "$1: no other host: exit 3" "$status:$(printf '%s\n' "$err" | grep -v ' is sent, ')" \
		"3:fan: $2: no program can be sent: $3
fan: no slot left"
}
machine=$(uname -sm)
mkdir other
printf '#!/bin/sh\necho Linux pdp11\n' >other/uname
chmod +x other/uname
bare pdp "PATH='$tmp/other'"
ends 'another architecture' pdp "it is Linux pdp11, expected $machine"
host colon "exec env -i XDG_CACHE_HOME='$tmp/a:b' sh -c \"\$1\""
ends 'a colon in the directory' colon "$tmp/a:b/stormring: expected a directory without a colon"
touch file
host nodir "exec env -i XDG_CACHE_HOME='$tmp/file' LC_ALL=de_DE.UTF-8 sh -c \"\$1\""
ends 'a file in the place of the directory' nodir "mkdir: cannot create directory '$tmp/file': Not a directory"
# The connection loses a byte.
host lossy 'perl -e '"'"'while (sysread STDIN, $b, 65536) { $b =~ tr/a/b/; syswrite STDOUT, $b }'"'"' | env -i XDG_CACHE_HOME="$PWD/cache.lossy" sh -c "$1"'
ends 'a worker that arrives damaged' lossy "$tmp/cache.lossy/stormring: rtworker is damaged on arrival, or the disk is full"
is 'a worker that arrives damaged: it is not left there' "$(find cache.lossy ! -type d)" ''

# lies NAME LINE: a host that says this, again and again, is refused
lies() {
	host liar "while echo 'stormring-send $2'; do sleep .1; done"
	run fan -S liar.hosts rtworker - <job.task
	is "$1: it is refused" "$status:$(printf '%s\n' "$err" | grep -v ' is sent, ')" \
		"3:fan: liar: cannot be used (wrong-request), it says: stormring-send $2
fan: no slot left"
}
hash=$(sha256sum <"$static/rtworker")
lies 'a host that asks for what there is not' 'need 0'
lies 'a host that asks with other words' nonsense
lies 'a host that asks twice' "need ${hash%% *}"

# ---- what is refused before a host is asked -----------------------------------------------------------------------------
run fan -S one.hosts sh -c 'exec rtworker -'
is 'a command without a static program: exit 2' "$status" 2
like 'a command without a static program: one line' "$err" '^fan: send=auto: no word of `sh [.]{3}` is a static program in .*, expected one, built by `make`'

# ---- file systems of their own ---------------------------------------------------------------------------------------------
apart='unshare -m'
[ "$(id -u)" = 0 ] || apart='unshare -rm'
if $apart mount -t tmpfs none "$tmp/other" 2>/dev/null; then
	# within OPTIONS: a home directory on a file system of its own
	within() { host "$1" "exec $apart sh -c 'mount -t tmpfs -o \"\$1\" none \"$tmp/home\" && exec env -i HOME=\"$tmp/home\" sh -c \"\$2\"' sh '$2' \"\$1\""; }
	mkdir home
	within noexec noexec
	ends 'a home directory without exec' noexec \
		"$tmp/home/.cache/stormring: programs cannot be run there, as in a file system that is mounted noexec"
	within readonly ro
	ends 'a read-only home directory' readonly "mkdir: cannot create directory '$tmp/home/.cache': Read-only file system"
	within full size=600k
	ends 'a full disk' full "$tmp/home/.cache/stormring: head: error writing 'standard output': No space left on device"

	# Nothing but busybox, and no home directory; the user is root there.
	mkdir -p room/bin room/dev room/tmp
	touch room/dev/null
	for tool in $(busybox --list); do ln -s busybox "room/bin/$tool"; done
	cp --remove-destination "$(command -v busybox)" room/bin/busybox
	host busy "exec $apart sh -c 'mount --bind /dev/null \"$tmp/room/dev/null\" && exec chroot \"$tmp/room\" /bin/env -i HOME=/ /bin/sh -c \"\$1\"' sh \"\$1\""
	works 'a host with nothing but busybox' busy
	is 'a host with nothing but busybox: the worker is sent' "$(cat messages)" "$(printf "$sent" busy)"
	is 'a host with nothing but busybox: it is in /tmp' "$(echo room/tmp/stormring-*/*/*)" \
		"room/tmp/stormring-0/$(basename "$(dirname "$(cached far rtworker)")")/rtworker"
	works 'a host with nothing but busybox, again' busy -1
	is 'a host with nothing but busybox, again: nothing is sent' "$(cat messages)" ''
	mv "room/tmp/stormring-0" room/tmp/mine
	ln -s mine "room/tmp/stormring-0"
	ends 'a link in /tmp' busy "/tmp/stormring-0: is a link"
	if [ "$(id -u)" = 0 ]; then
		rm room/tmp/stormring-0
		mv room/tmp/mine room/tmp/stormring-0
		chown 1 room/tmp/stormring-0
		ends 'a directory of another user in /tmp' busy '/tmp/stormring-0: belongs to another user'
	else
		skip 'a directory of another user in /tmp' 'it needs root'
	fi
else
	skip 'file systems of their own' 'mount namespaces are impossible'
fi
finish
