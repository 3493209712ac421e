#!/bin/sh
# balance -S and balance calibrate with hosts that are commands on this machine; 7*.t test ssh.
. "$(dirname "$0")/lib.sh"
patient

# shellcheck disable=SC2154  # lib.sh sets them
spdgen -s 2 gears >gears.nff
size=96x80
partition $size | rtworker gears.nff | gather -o good.pfm
printf '# name\n:\tslots=2\t# here\n\nother  slots=2 power=7 via="sh -c %%c" bin="%s"\n' "$BIN" >hosts

for m in adaptive interleaved masterslave hybrid ss sc ds dc; do
	rm -f log out.pfm
	balance $m -S hosts -s $size -r log -o out.pfm gears.nff
	ok "$m -S FILE: the same picture" cmp out.pfm good.pfm
	is "$m -S FILE: all slots of the file did tasks" "$(grep -a -o 'up w=[0-9]* host=[a-z:]*' log | sort -u | wc -l)" \
		"$(case $m in interleaved | ss | sc) echo 4 ;; *) echo 0 ;; esac)"
done
balance masterslave -S 2/:,: -s $size -r list -o out.pfm gears.nff
ok '-S LIST: the same picture' cmp out.pfm good.pfm
is '-S LIST: three slots' "$(grep -a -o 'hello deal .*slots=[0-9]*' list | grep -o 'slots=.*')" slots=3

is 'fan -l WORKER: one power for the slots of a host' "$(fan -l -j 6 rtworker | cut -f 3 | sort -u | wc -l)" 1
# The log is complete, and connecting to the host takes longer than the run.
printf '#!/bin/sh\nsleep 1; exec sh -c "$1"\n' >slowly
chmod +x slowly
printf 'far via="./slowly %%c"\n' >far
rm -f out.pfm
ok '-S, a whole log, a host that is slow to come: exit 0' balance masterslave -S far -s $size -r list -o out.pfm gears.nff
ok '-S, a whole log, a host that is slow to come: the same picture' cmp out.pfm good.pfm

# hybrid gives the first 62 of 80 rows by the powers of the file, even if another host is faster.
printf ': power=1\n: power=1\n: power=7\n' >three
balance hybrid -S three -s $size -r log3 -o out.pfm gears.nff
ok 'hybrid, powers stated: the same picture' cmp out.pfm good.pfm
grep -a -o 'done 0 [0-9]* cpu_us.*' log3 | sed 's/^done 0 \([0-9]*\) .*w=\([0-9]*\).*/\1 to=\2/' | sort -n | head -n 62 >got
partition -w 1,1,7 -c 62 $size | sed -n '2,63p' | cut -d ' ' -f 3,10 >expected
ok 'hybrid, powers stated: the shares of the first phase' cmp got expected

cat >boast <<'END'
#!/bin/sh
sh -c "$1" | { read -r hello && echo "$hello" | sed 's/power=[^ ]*/power=1e9/; s/ sum=.*//'; exec cat; }
END
chmod +x boast
printf 'faint power=1e-6 via="sh -c %%c"\nstrong via="./boast %%c"\n' >apart
rm -f out.pfm
balance hybrid -S apart -s 0096x080 -o out.pfm gears.nff
ok 'hybrid, powers far apart, and a size with zeros: the same picture' cmp out.pfm good.pfm

cp gears.nff ./-scene.nff
run balance masterslave -j 1 -s $size -r -log -o -out.pfm -- -scene.nff
is 'names that begin with a minus: exit 0' "$status$err" 0
ok 'names that begin with a minus: the same picture' cmp ./-out.pfm good.pfm

# ---- no host, and an unchanged log ---------------------------------------------------------------
printf 'gone tries=1 via="exit 9; %%c"\n' >none
head -c 50000 log3 >before
cp before log4
rm -f out.pfm
run balance masterslave -S none -s $size -r log4 -o out.pfm gears.nff
is 'no host is left: exit 3' "$status" 3
ok 'no host is left: the log is unchanged' cmp log4 before
balance masterslave -S hosts -s $size -r log4 -o out.pfm gears.nff 2>said
ok 'with other hosts the same command finishes the picture' cmp out.pfm good.pfm

# A device or a pipe is written, not replaced.
mkfifo pipe
cat pipe >piped &
ok 'calibrate -o: a pipe' timeout 100 balance calibrate -n 1 -s 16x16 -S hosts -o pipe gears.nff
wait $!
ok 'calibrate -o: the pipe stays, and gets the hosts' sh -c 'test -p pipe && fan -l -S piped'
# ---- calibrate ------------------------------------------------------------------------------------------------
run balance calibrate -n 3 -s 64x48 -S hosts -o measured gears.nff
is 'calibrate: exit 0' "$status" 0
tab=$(printf '\t')
is 'calibrate: a line of names, and a line a host' "$(printf '%s\n' "$out" | cut -f 1 | tr '\n' ' ')" 'host : other '
is 'calibrate: the first has power 1' "$(printf '%s\n' "$out" | sed -n '2s/.*\t//p')" 1
is 'calibrate: max, min, mean and power are computed right' "$(printf '%s\n' "$out" | awk -F "$tab" '
	NR == 1 { next }
	NR == 2 { first = $4 }
	{ r = first / $4 / $5; print ($2 >= $4 && $4 >= $3 && $3 > 0 && r > .7 && r < 1.4) }' | tr '\n' ' ')" '1 1 '
is 'calibrate -o: the hosts are unchanged, with the measured powers' \
	"$(grep -v '^#' measured | sed 's/power=[0-9.]*/power=/')" "$(printf ': power=\tslots=2\t# here\nother power=  slots=2 via="sh -c %%c" bin="%s"' "$BIN")"
is 'calibrate -o: the powers of the table' "$(fan -l -S measured | cut -f 3 | uniq | tr '\n' ' ')" \
	"$(printf '%s\n' "$out" | tail -n 2 | awk -F "$tab" '{ printf "%g ", $5 }')"
odd=$(printf -- '-a scene\nevil via="x %%c')
cp gears.nff "./$odd"
printf '%s\n' 'odd via="./said '"'a\\\\cb'"' %c"' >-odd
printf '#!/bin/sh\nprintf "%%s\\n" "$1" >odd.said; exec sh -c "$2"\n' >said
chmod +x said
cp hosts aim && ln -s aim link && balance calibrate -n 1 -s 16x16 -S link -o link gears.nff >/dev/null 2>&1
is 'calibrate -o: a link stays, and the file that it leads to is replaced' "$(ls -l link | sed 's/.*-> //'):$(head -n 1 aim | cut -c 1-35)" 'aim:# measured by balance calibrate: 16'
run balance calibrate -n 1 -s 32x32 -S -odd -o -measured -- "$odd"
is 'calibrate: odd names, and backslashes in a via: exit 0' "$status$err" 0
is 'calibrate: odd names and backslashes are kept' "$(cat odd.said; grep -v '^#' ./-measured | sed 's/ power=[0-9.]*//')" "a\\cb
$(cat ./-odd)"
# A host whose rtworker takes 256 samples for one has about a 256th of the power; less than half of it on any machine.
mkdir slow
printf '#!/bin/sh\nexec "%s/rtworker" -a 256 "$@"\n' "$BIN" >slow/rtworker
chmod +x slow/rtworker
printf ':\nslow bin="%s/slow" via="sh -c %%c"\n' "$tmp" >unequal
run balance calibrate -n 3 -s 64x48 -S unequal gears.nff
is 'calibrate: a slow host has less power than a fast one' "$(printf '%s\n' "$out" | awk 'NR == 3 { print $5 < .5 }')" 1
run balance calibrate -n 1 -s 64x48 -S 2/:,: -o measured gears.nff
is 'calibrate -S LIST: its hosts file' "$(grep -v '^#' measured | sed 's/power=[0-9.]*/power=/' | tr '\n' ';')" ': power= slots=2;: power=;'
run balance calibrate -n 2 -s 32x32 gears.nff
is 'calibrate: this machine alone' "$status$(printf '%s\n' "$out" | wc -l)" 02
printf 'gone slots=3 power=7 tries=1 via="exit 9; %%c"\n: # here\n"again" via="sh -c %%c"\n' >bad
run balance calibrate -n 2 -s 32x32 -S bad -o partly gears.nff
is 'calibrate: a host that renders nothing: exit 1' "$status" 1
is 'calibrate: a host that renders nothing: named once' "$(printf '%s\n' "$err" | grep '^balance')" 'balance calibrate: gone: not measured'
is 'calibrate: a host that renders nothing: the others are measured' "$(printf '%s\n' "$out" | cut -f 1 | tr '\n' ' ')" 'host : again '
is 'calibrate: a host that renders nothing: power 1 is the first of the others' "$(printf '%s\n' "$out" | sed -n '2s/.*\t//p')" 1
is 'calibrate: a host that renders nothing: its line stays, the others have powers' \
	"$(grep -v '^#' partly | sed '2,$s/power=[0-9.]*/power=/')" "$(sed 's/^: /: power= /; s/^"again"/& power=/' bad)"
head -n 1 bad >none-left
run balance calibrate -n 1 -s 32x32 -S none-left -o unwritten gears.nff
is 'calibrate: no host is measured: exit 3' "$status$out" 3
# The words of via= and of comments are not keys.
printf '#!/bin/sh\necho "$power $slots" >tricky.said; exec sh -c "$1"\n' >tricky
chmod +x tricky
printf '  tricky  "slots=2" via="env power=7 slots=9 ./tricky %%c" po"wer"=5\t# a "power=6 slots=1\n' >tricky.hosts
run balance calibrate -n 1 -s 32x32 -S tricky.hosts -o tricky.measured gears.nff
is 'calibrate: quotes and comments: exit 0' "$status$err" 0
is 'calibrate: quotes and comments are kept' "$(cat tricky.said; grep -v '^# measured' tricky.measured)" \
	"$(printf '7 9\ntricky power=1  "slots=2" via="env power=7 slots=9 ./tricky %%c"\t# a "power=6 slots=1\n')"
run balance calibrate -n 9999 -s 32x32 -o nosuch/hosts gears.nff
is 'calibrate -o in no directory: it fails before it measures' "$status $err" '3 balance calibrate: nosuch/hosts: cannot be written'
is 'calibrate: no host is measured: no hosts file' "$(ls unwritten* 2>/dev/null)" ''
for bad in '' '-n 0 gears.nff' '-n x gears.nff' '-S nosuch:file/x gears.nff' '-s 0x0 gears.nff' 'nosuch.nff' '-W -d0 gears.nff' -; do
	# shellcheck disable=SC2086
	run balance calibrate $bad
	is "balance calibrate $bad: exit 2" "$status" 2
done

# ---- refused ----------------------------------------------------------------------------------------------------
for bad in '-S nosuch:file/x' '-j 2 -S :' '-S ,'; do
	# shellcheck disable=SC2086
	run balance masterslave $bad -s $size -o bad.pfm gears.nff
	is "balance $bad: exit 2" "$status" 2
done
finish
