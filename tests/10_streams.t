#!/bin/sh
# partition, pack, rtworker, fan, deal and balance one by one: input, output, refusals.
. "$(dirname "$0")/lib.sh"

# shellcheck disable=SC2154  # lib.sh sets out, err, status
tasks() { partition "$@" | sed -n 's/^task //p'; }
slots() { partition "$@" | sed -n 's/.*to=//p' | tr '\n' ' '; }
# pixels WIDTH: prints each pixel of the tasks on standard input, by the formula of stormring-task(5)
pixels() {
	awk -v fw="$1" '$1 == "task" { for (j = 0; j < $7; j++) for (i = 0; i < $6; i++)
		print $5 * fw + $4 + i * $8 + j * $9 * fw }' | sort -n
}

# ---- partition ---------------------------------------------------------------------------------------
is "the frame comes first" "$(partition 7x3 | head -1)" "frame 0 7 3"
is "-u row: one task per row" "$(tasks 7x3 | tr '\n' ';')" "0 0 0 0 7 1 1 1;0 1 0 1 7 1 1 1;0 2 0 2 7 1 1 1;"
is "-u tile: tiles are cut at the edges" "$(tasks -u tile:4x2 7x3 | tr '\n' ';')" \
	"0 0 0 0 4 2 1 1;0 1 4 0 3 2 1 1;0 2 0 2 4 1 1 1;0 3 4 2 3 1 1 1;"
is "-u run: runs wrap at the end of the row" "$(tasks -u run:10 7x3 | tr '\n' ';')" \
	"0 0 0 0 10 1 1 1;0 1 3 1 10 1 1 1;0 2 6 2 1 1 1 1;"
is "-u scatter: set I has each pixel whose number modulo N is I" "$(tasks -u scatter -n 2 3x3 | tr '\n' ';')" "0 0 0 0 5 1 2 1 to=0;0 1 1 0 4 1 2 1 to=1;"
is "-n: slots take turns" "$(slots -n 3 1x7)" "0 1 2 0 1 2 0 "
is "-w: weighted interleave, the paper's w1 w2 w3 w2" "$(slots -w 1,2,1 1x8)" "0 1 2 1 0 1 2 1 "
is "-w: a weight below 1 skips turns" "$(slots -w 1,.5 1x6)" "0 0 1 0 0 1 "
is "-c: only the first tasks are assigned" "$(slots -n 2 -c 3 1x6)" "0 1 0 "
for cut in row tile:3x2 tile:100x1 run:1 run:5 run:1000 'scatter -n 4' 'scatter -n 500'; do
	# shellcheck disable=SC2086
	is "-u $cut names each pixel once" "$(partition -u $cut 11x7 | pixels 11)" "$(seq 0 76)"
done
is "-F sets the number of the frame" "$(partition -F 5 2x1 | tr '\n' ';')" "frame 5 2 1;task 5 0 0 0 2 1 1 1;"
for bad in '' 0x5 5 5x 70000x1 '-u row' '-u scatter 4x4' '-u tile:0x1 4x4' '-u run:0 4x4' '-u column 4x4' \
	'-n 0 4x4' '-w 1,x 4x4' '-w 0 4x4' '-n 2 -w 1 4x4' '-c 3 4x4' '4x4 4x4' '-z 4x4'; do
	# shellcheck disable=SC2086
	run partition $bad
	is "partition $bad: exit 2" "$status$out" 2
done

# ---- pack --------------------------------------------------------------------------------------------
printf 'abc' >three
is "pack writes size and crc before the file" "$(pack scene three)" "scene crc=891568578 bytes=3
abc"
is "pack ends the body with a newline that bytes= does not count" "$(pack scene three | tail -n 1 | od -An -c | tr -d ' ')" 'abc\n'
is "pack of two files writes two records" "$(pack spec three three | grep -c bytes=3)" 2
for bad in '' scene 'picture three' 'scene no-such-file'; do
	# shellcheck disable=SC2086
	run pack $bad
	is "pack $bad: exit 2" "$status" 2
done

# ---- rtworker ----------------------------------------------------------------------------------------
spdgen -s 1 tetra >tetra.nff
# lines FILE: prints the records of a stream without their bodies; records: the same, shortened
lines() { perl -e 'while (<>) { print; read(ARGV, $_, $1 + 1) if / bytes=(\d+)/ }' "$@"; }
records() { lines - | sed 's/ crc=.*//; s/ sum=.*//; s/_us=[0-9]*//g; s/selftest=.*//; s/ job=[^ ]*//'; }
partition -u run:6 4x3 | rtworker tetra.nff >frags
is "the worker sends hello first" "$(lines frags | head -1 | cut -d ' ' -f 1-2)" "hello rtworker"
is "the frame with its job comes next" "$(lines frags | sed -n 2p | sed 's/job=[0-9a-f]*/job=/; s/ sum=.*//')" \
	"frame 0 4 3 job= with=rtworker"
is "the job is the one that -i prints" "$(partition 512x512 | rtworker tetra.nff | head -2 | lines - | grep -o 'job=[^ ]*')" \
	"$(rtworker -i tetra.nff | grep -o 'job=.*')"
is "then come done, the pixels, and bye" "$(records <frags | sed -n '3,$p' | tr '\n' ';')" \
	"done 0 0 cpu wall;frag 0 0 0 0 6 1 1 1 ch=4;done 0 1 cpu wall;frag 0 1 2 1 6 1 1 1 ch=4;bye;"
# no_reader COMMAND ...: prints the status of a command whose reader has left
no_reader() {
	{ until [ -e left ]; do sleep .1; done; "$@"; echo $? >status; } | { exec <&-; : >left; }
	rm left
	cat status
}
partition 4x3 >tasks
is "no reader: status, without and with -j" "$(no_reader rtworker tetra.nff <tasks) $(no_reader rtworker -j 2 tetra.nff <tasks)" '3 3'
is "-f 4 cuts fragments" "$(partition -u run:6 4x3 | rtworker -f 4 tetra.nff | records | grep -c '^frag')" 4
is "-c keeps fragments to the end" "$(partition 4x3 | rtworker -c tetra.nff | records | cut -c 1-4 | tr '\n' ' ')" \
	"hell fram done done done frag frag frag bye "
{ partition 4x2; echo flush; echo 'task 0 9 0 0 1 1 1 1'; } | rtworker -c tetra.nff >held
is "-c keeps fragments until a flush" "$(records <held | cut -c 1-4 | tr '\n' ' ')" "hell fram done done frag frag beat done frag bye "
is "the frame record has the worker's options" \
	"$(partition 1x1 | rtworker -d 3 -a 16:.1 -w .5 -x sse2 tetra.nff | lines - | grep -o 'with=[^ ]*')" \
	"with=rtworker,-a16:0.1,-d3,-w0.5"
sed 's/^l /# /' tetra.nff >top.nff
away() { sed 's/^at .*/at 99 99 99/; s/^resolution .*/resolution 10 10/'; }
away <tetra.nff >away.nff
spdgen -s 2 tetra | away >away2.nff
a=$(rtworker -i tetra.nff) b=$(rtworker -i -d 4 tetra.nff) c=$(rtworker -i -x sse2 tetra.nff)
is "the job does not depend on the vector width" "$c" "$a"
is "the job does not depend on the hierarchy" "$(rtworker -i -b slabs tetra.nff)" "$a"
run test "$a" = "$b"
is "the job depends on the depth" "$status" 1
run test "$a" = "$(rtworker -i -w 0 tetra.nff)"
is "the job knows the error budget" "$status" 1
is "the default budget is 2^-17" "$(rtworker -i -w 0.00000762939453125 tetra.nff)" "$a"
# counted OPTION ...: rays, tests of volumes and of primitives, and bytes by -n, in one line
counted() { rtworker -n "$@" | awk '$1 ~ /^(rays|.*_tests|.*_bytes)$/ { printf "%s ", $2 }'; }
is "-n counts without a hierarchy: each ray of a corner is tested with 4 triangles" "$(counted -b none -s 4x3 -d 1 top.nff)" '20 0 80 0 '
is "-n counts slabs: each ray is tested with one volume that bounds all, and misses it" "$(counted -b slabs -s 4x3 away.nff | cut -d ' ' -f 1-3)" '20 20 0'
is "-n counts the BVH: each ray is tested with the four children of its root" "$(counted -s 4x3 away2.nff | cut -d ' ' -f 1-3)" '20 80 0'
is "-n takes the scene's size" "$(rtworker -n away.nff | sed -n 2p)" "rays	121"
for bad in '-i -i tetra.nff' '-i -n tetra.nff' '-b tree tetra.nff' '-s 4x3 tetra.nff' '-d 0 tetra.nff' '-a 3 tetra.nff' '-a 4:-1 tetra.nff' '-w -1 tetra.nff' '-w 2 tetra.nff' \
	'-x mmx tetra.nff' no-such-file 'a b'; do
	# shellcheck disable=SC2086
	run rtworker $bad
	is "rtworker $bad: exit 2" "$status" 2
done
refused() { # NAME TEXT ERE: what a worker says of this input
	run sh -c 'printf "%b" "$1" | rtworker tetra.nff >/dev/null' sh "$2"
	is "$1: exit 2" "$status" 2
	like "$1: a message says so" "$err" "$3"
}
refused "a task before its frame" 'task 0 0 0 0 1 1 1 1\n' 'no such frame, expected'
refused "a task outside its frame" 'frame 0 4 4\ntask 0 0 0 3 5 1 1 1\n' 'expected pixels inside 4x4'
refused "an unknown record" 'frame 0 4 4\nwork 1 2\n' 'unknown record, expected'
refused "a record cut off" 'frame 0 4' 'no end of line, expected a whole record'
refused "a number out of range" 'frame 0 4 99999\n' 'expected its numbers in range'
refused "a fragment" 'frame 0 4 4\ngone w=1\n' 'expected scene'
run sh -c 'printf "v\n" >bad.nff; rtworker -i bad.nff'
is "a bad scene: exit 2" "$status" 2
like "a bad scene: file and line" "$err" 'bad\.nff:[0-9]+: .*expected'

# ---- fan and deal ------------------------------------------------------------------------------------
state() { pack scene tetra.nff; partition "$@" 8x8; }
is "fan -l" "$(fan -l -j 2 | tr '\t\n' ' ;')" "0 : -;1 : -;"
state | fan -j 3 rtworker - >frags
is "fan: task ID goes to slot ID mod N" \
	"$(lines frags | grep '^done' | awk '{ split($0, w, "w="); print $3 % 3 - substr(w[2], 1, 1) }' | sort -u)" 0
is "fan: its hello has the number of slots" "$(lines frags | grep '^hello' | sed 's/selftest=[0-9a-f]*/S/; s/power=[0-9.e+]*/P/; s/ alive=1//; s/ zstd=1//; s/ sum=.*//')" \
	"hello fan 0.2 format=4 S P slots=3"
is "fan: it sends up for each slot" "$(lines frags | grep '^up' | cut -c 1-11 | sort | tr '\n' ';')" \
	"up w=0 host;up w=1 host;up w=2 host;"
is "fan: it adds slot and times to done" "$(lines frags | grep '^done 0 4 ' | sed 's/ sum=.*//; s/=[0-9]*/=/g')" "done 0 4 cpu_us= wall_us= w= sent_us= recv_us="
is "fan: it obeys to=K" "$(state -w 1,2 | fan -j 2 rtworker - | lines - | grep '^done' | grep -c w=1)" 5
run sh -c 'partition -n 3 8x8 | fan -j 2 rtworker tetra.nff >/dev/null'
is "fan: a slot that does not exist: exit 2" "$status" 2
run sh -c 'printf "frame 0 4 4\ntask 0 0 0 0 4 1 1 1\ntask 0 0 0 1 4 1 1 1\n" | fan -j 1 rtworker tetra.nff >/dev/null'
is "fan: one number for two tasks: exit 2" "$status" 2
state | deal fan -j 2 fan -j 2 rtworker - >frags
is "nested fans: stamps are paths" "$(lines frags | grep '^frag' | grep -o ' w=[0-9.]*' | grep -vc ' w=[01]\.[01]$')" 0
is "deal sends hello as one worker, without up and gone" "$(lines frags | grep '^hello\|^up\|^gone' | cut -d ' ' -f 1-2)" "hello deal"
is "fan passes unknown keys on" \
	"$(state | sed 's/^task.*/& tag=7/' | fan -j 1 sh -c 'tee seen | rtworker -' >/dev/null; grep -c tag=7 seen)" 8
is "deal passes unknown keys on" "$(state | sed 's/^task.*/& tag=7 more=8/' |
	deal fan -j 1 sh -c 'tee seen | rtworker -' >/dev/null; grep -c 'tag=7 more=8 sum=........$' seen)" 8
for bad in '' '-q' '-q -1 fan' '-x'; do
	# shellcheck disable=SC2086
	run deal $bad </dev/null
	is "deal $bad: exit 2" "$status" 2
done
for bad in '' '-j 0 rtworker -' '-l -j 0 rtworker' '-t 0 rtworker' '-j 99999 x'; do
	# shellcheck disable=SC2086
	run fan $bad </dev/null
	is "fan $bad: exit 2" "$status" 2
done
run sh -c 'echo nonsense | deal fan -j 2 rtworker tetra.nff >/dev/null'
is "nonsense into deal: exit 2" "$status" 2
run sh -c 'fan -j 2 rtworker tetra.nff </dev/null >/dev/null'
is "fan without any task: exit 0" "$status" 0

# ---- balance -----------------------------------------------------------------------------------------
balance interleaved -j 2 -s 8x6 tetra.nff >out.png
is "a picture on stdout" "$(head -c 4 out.png | tail -c 3)" PNG
spdgen -s 1 tetra | balance masterslave -j 2 -s 8x6 -o piped.png -
ok "the scene from a pipe" cmp out.png piped.png
for bad in '' nomethod 'masterslave' 'masterslave no-such-file' 'masterslave bad.nff' 'masterslave -s 0x0 tetra.nff' \
	'masterslave -j 0 tetra.nff' 'masterslave -o x.jpg tetra.nff' 'masterslave -z tetra.nff' \
	'masterslave -W -d0 tetra.nff'; do
	# shellcheck disable=SC2086
	run timeout 1200 balance $bad
	is "balance $bad: exit 2" "$status" 2
done
like "balance nomethod lists the methods" "$(balance nomethod 2>&1)" 'expected one of: adaptive auto dc ds gdc gdc-published hybrid interleaved masterslave sc ss$'
run timeout 1200 balance masterslave -W -i tetra.nff
like "balance -W -i: refused at once" "$status $err" '^2 rtworker: -i: expected one of -i and -n, once'
for method in masterslave auto calibrate; do
	run balance $method -W foo tetra.nff
	like "balance $method -W foo: says what is expected" "$status $err" '^2 (job|balance: calibrate): -W foo: expected options of rtworker$'
done
run sh -c 'cat tetra.nff | balance masterslave -o x.png /dev/stdin'
like "balance: a pipe as a file is refused" "$status $err" '^2 job: /dev/stdin: is a pipe, which can be read only once, expected '
run sh -c 'balance masterslave -j 2 -s 8x6 -o closed.png tetra.nff <&- >&- 2>&-'
is "balance: closed standard streams: the same picture" "$status $(cmp closed.png piped.png && echo same)" '0 same'
run sh -c 'printf "v\nfrom x\n" | balance masterslave -o x.png -'
like "balance: the message on a bad scene from a pipe names the record" "$status $err" '^2 rtworker: scene:2: '
mkdir unbuilt
cp "$root"/bin/balance* "$root/bin/stormring.sh" unbuilt
for c in 'masterslave -o x.png' calibrate; do
	# shellcheck disable=SC2086
	run env PATH=/usr/bin:/bin unbuilt/balance $c tetra.nff
	like "balance $c, not built: says so" "$status $err" '^2 balance.*: [a-z]+ is not there, expected it .*built by make'
done
mkdir own
cp "$root/bin/balance" "$root/bin/stormring.sh" own
echo 'cat >/dev/null; partition 8by6' >own/balance-wrong
echo 'exec no-such-program' >own/balance-lost
echo 'cat >/dev/null' >own/balance-idle
for method in 'wrong 2' 'lost 2' 'idle 1'; do
	sed -i '1i#!/bin/sh' "own/balance-${method% *}" && chmod +x "own/balance-${method% *}"
	run own/balance "${method% *}" -j 1 -s 8x6 -o x.png tetra.nff
	is "a method of one's own, ${method% *}: status" "$status" "${method#* }"
done
like "a method that fails: gather says so" "$(own/balance lost -j 1 -s 8x6 -o x.png tetra.nff 2>&1)" 'nothing was rendered: method-failed'
partition -u tile:8x4 8x8 | deal fan -j 4 rtworker tetra.nff >two.frags
is "fragstat -s counts slots without tasks" "$(fragstat -s two.frags | head -n 2 | tr '\n\t' '  ')" "slots 4 tasks 2 "
# ---- light beyond a float's range ---------------------------------------------------------------------------------
{ printf '%s\n' 'b 1 1 1' v 'from 0 -3 1' 'at 0 0 0' 'up 0 0 1' 'angle 40' 'hither 0' 'resolution 8 8'
	printf '%s\n' 'l 0 -1 0 1000000 1000000 1000000' 'f 1 .5 0 1000000 1000000 3 0 0' 's 0 0 0 5'; } >mirror.nff
for depth in 8 64; do
	run sh -c "partition 8x8 | fan -j 1 rtworker -d $depth mirror.nff | gather -o mirror.pfm"
	is "mirrors of Ks 1e6, $depth levels: light is at the range's end, and no slot is lost" \
		"$status $err $(od -An -tf4 -j 12 mirror.pfm | grep -c 'inf\|nan\|-[0-9]')" '0  0'
done

finish
