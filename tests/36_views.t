#!/bin/sh
# fragstat -f, -t and -H: a run in view, from logs made by hand and of real runs, in tmux and in Chromium.
# shellcheck disable=SC1091,SC2016
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"

seal() { "$root/tests/seal"; }
# Slot 1 is lost with two tasks; a host has a name that no hosts file would take.
{
	echo 'hello deal 0.2 format=4 selftest=0 slots=3'
	echo 'frame 0 8 8 job=cafe w=0 host=: recv_us=10000'
	echo 'frame 0 8 8 job=cafe w=1 host=<script>alert(1)</script>"&\ recv_us=11000'
	echo 'done 0 0 cpu_us=90000 wall_us=100000 w=0 sent_us=0 recv_us=120000'
	echo 'done 0 1 cpu_us=80000 wall_us=80000 w=1 sent_us=0 recv_us=150000'
	echo 'gone w=1 why=silent lost=2 recv_us=500000 kept=1'
	echo 'done 0 2 cpu_us=100000 wall_us=100000 w=0 sent_us=0 recv_us=230000 try=2'
	echo 'gone w=2 why=left lost=0 recv_us=600000 kept=1'
} | seal >begun.log
{ cat begun.log; echo bye; } >ended.log

# ---- the table ---------------------------------------------------------------------------------------------------
run fragstat -f ended.log
is 'a run that has ended: one table; status 1, because pixels are missing' "$status$err$(printf '%s\n' "$out" | grep -c '^slot')" 11
is 'the table of a run' "$out" '0.0 % of 64 pixels, ended after 0:01
slot   host                             tasks    last task     px/s     idle
0      localhost                            2          0 2        0   13.0 %  up
1      <script>alert(1)</script>"&\         1          0 1        0   46.7 %  silent
2      -                                    0            -        -        -  left
lost at 0:01: slot 1 on <script>alert(1)</script>"&\ (silent) with 2 tasks'
spdgen -s 2 tetra >tetra.nff
partition 32x32 | rtworker tetra.nff >all.frags
run fragstat -f all.frags
is 'a whole picture: status 0' "$status$err" 0
like 'a worker without a fan has a slot without a name' "$out" '^- +- +32 +0 31 '
# The second run has no slot 1, and has only begun. Slot 0 holds 0.0, which does its tasks; it is lost after them.
{
	cat begun.log
	echo 'bye why=no-slot-left'
	echo 'hello deal 0.2 format=4 selftest=0 slots=2'
	echo 'frame 0 8 8 job=cafe w=0 host=: recv_us=10000'
	echo 'done 0 3 cpu_us=100000 wall_us=100000 w=0.0 sent_us=0 recv_us=150000'
} | seal >second.log
is 'a run that resumes another one: only its slots and losses' "$(timeout 60 fragstat -f -i .1 second.log | sed '/^$/q; s/, 0:[0-9]*, ETA/, T, ETA/' | cut -c 1-46)" \
	'0.0 % of 64 pixels, T, ETA ?, 1 slots up
slot   host                 tasks    last task
0.0    localhost                1          0 3'
{ cat second.log; echo 'gone w=0 why=silent lost=2 recv_us=200000 kept=1'; echo 'bye why=no-slot-left'; } | seal >third.log
run fragstat -f third.log
like 'the loss of a slot is that of the slots that it holds' "$out" '^0[.]0 .*silent$'
fragstat -t third.log >third.json
like 'a trace: their host as well' "$(cat third.json)" '"ts":[0-9]+,"dur":100000,"pid":2'
fragstat -H third.log >third.html
is 'a page: losses at the end are in sight' "$(grep -o 'class="l" x="[0-9.]*' third.html | sed 's/.*"//' | sort -n | tail -n 1)" 997.0
: >empty.log
is 'nothing so far: no estimate' "$(timeout 60 fragstat -f -i .1 empty.log | sed 's/, 0:[0-9]*, ETA/, T, ETA/; q')" '0.0 % of 0 pixels, T, ETA ?, 0 slots up'
# A run that goes on with a log that has ended: it holds the log, and has written nothing yet.
mkfifo begins
cp ended.log held.log
flock held.log sh -c 'echo >begins; cat begins; cat all.frags >>held.log' &
read -r _ <begins
MARK=$mark fragstat -f -i .1 held.log >held.said &
pid=$!
ok 'a run that holds the log and has written nothing: it waits' await 1 sh -c '[ "$(grep -c "^slot" held.said)" -gt 3 ]'
echo >begins
wait $pid
like 'and follows it' "$(tail -n 4 held.said)" '^- +- +32 +0 31 '
run fragstat -f /
is 'a directory: status 2' "$status" 2
echo 'hello fan 0.1 selftest=0' >old.log
run fragstat -f old.log
is 'a log of another format: status 2' "$status" 2

# A log that does not exist yet, comes in parts, is torn, truncated, and ends. -i .1: a table ten times a second.
MARK=$mark fragstat -f -i .1 grows.log >said 2>err &
pid=$!
ok 'a log that does not exist: it waits' await 1 grep -q '^waiting for grows.log' said
half=$(($(wc -c <all.frags) / 2))
head -c $half all.frags >grows.log
ok 'half of a log' await 1 grep -qE '^(4[0-9]|50)[.0-9]* % of 1024 pixels, .*, ETA' said
tail -c +$((half + 1)) all.frags | grep -av '^bye' | head -c -5 >>grows.log
ok 'a torn end' await 1 grep -q '^96.9 % of 1024 pixels' said
cp begun.log grows.log
ok 'a log that was truncated' await 1 grep -q '^0.0 % of 64 pixels' said
cat ended.log >new.log
mv new.log grows.log
wait $pid
is 'a log that was replaced, and ends; pixels are missing' $? 1
is 'a log that grows: no message' "$(cat err)" ''
ok 'tables are separated by blank lines' grep -q '^$' said
status=0
MARK=$mark timeout 60 fragstat -f -i .1 begun.log >/dev/full 2>err || status=$?
is 'a full disk: status 3' "$status" 3

# ---- on a terminal -----------------------------------------------------------------------------------------------
if there tmux; then
	screen() { TMUX='' SHELL=/bin/sh tmux -S "$tmp/socket" "$@"; }
	end_screen() { screen kill-server 2>/dev/null; end_all; rm -rf "$tmp"; }
	trap end_screen EXIT
	shown() { screen capture-pane -p; }
	shows() { shown | grep -qE -e "$1"; }
	cp begun.log live.log
	screen -f /dev/null new-session -d -x 100 -y 20 "PATH='$PATH' fragstat -f -i .2 live.log; echo status \$?; cat"
	ok 'a terminal: the table' await 1 shows '^1 .*silent$'
	ok 'a terminal: the time goes on' await 2 shows ' pixels, (0:0[3-9]|0:[1-5]|[1-9])'
	is 'a terminal: the table is replaced' "$(shown | grep -c '^slot ')" 1
	screen resize-window -x 30 -y 6
	ok 'a narrow terminal: lines are cut, not wrapped' await 1 shows '^slot   host                 ta$'
	ok 'a low terminal: slots are counted' await 1 shows '^... and [12] more slots'
	screen resize-window -x 100 -y 20
	ok 'a terminal that has grown again' await 1 shows '^lost at 0:0[01]: slot 1 .* [(]silent[)] with 2 tasks$'
	screen send-keys C-c
	ok 'Ctrl-C ends it' await 1 sh -c "! pgrep -f 'fragstat -f -i .2 live.log' -P \$(TMUX= tmux -S '$tmp/socket' display-message -p '#{pane_pid}')"
	screen kill-server 2>/dev/null
	screen -f /dev/null new-session -d -x 100 -y 20 "PATH='$PATH' fragstat -f -i .2 live.log; echo status \$?; cat"
	await 1 shows '^slot '
	echo bye >>live.log
	ok 'a run that ends' await 1 shows '^status 1$'
	ok 'a run that ends: the last table stays' shows ' pixels, ended after '
	screen kill-server
else skip 'a terminal' 'tmux is not there'
fi

# ---- the trace ---------------------------------------------------------------------------------------------------
fragstat -t ended.log >trace.json
if there jq; then
	ok 'the trace is JSON' jq -e . trace.json
	is 'the trace: a process for each host, and one for the run' \
		"$(jq -r '.traceEvents[] | select(.name == "process_name") | .args.name' trace.json)" 'the run
<script>alert(1)</script>"&\
localhost
unknown host'
	is 'the trace: a bar for each task' "$(jq -c '.traceEvents[] | select(.ph == "X") | [.ts, .dur, .args.kind]' trace.json | tr '\n' ' ')" \
		'[20000,100000,"task"] [70000,80000,"task"] [130000,100000,"given again"] '
	is 'the trace: marks of slots' "$(jq -c '.traceEvents[] | select(.ph == "i") | [.name, .ts, .args.tasks_lost]' trace.json | tr '\n' ' ')" \
		'["ready",10000,0] ["ready",11000,0] ["lost: silent",500000,2] ["gone: left",600000,0] '
	is 'the trace: each bar is in a thread of a process that has a name' "$(jq -c '
		[.traceEvents[] | select(.ph == "M" and .name == "thread_name") | [.pid, .tid]] as $named |
		[.traceEvents[] | select(.ph == "X" or .ph == "i") | [.pid, .tid]] - $named' trace.json)" '[]'
	balance adaptive -j 2 -s 64x64 -r real.log -o real.png tetra.nff
	is 'the trace of a run: its bars bring every pixel' "$(fragstat -t real.log | jq '[.traceEvents[] | select(.ph == "X") | .args.pixels] | add')" 4096
	is 'the trace of a run: the curve ends with every pixel' "$(fragstat -t real.log | jq '[.traceEvents[] | select(.ph == "C") | .args.done] | last')" 4096
else skip 'the trace' 'jq is not there'
fi

# ---- the page ----------------------------------------------------------------------------------------------------
head -c $half all.frags >half.log
fragstat -H -i 7 half.log >half.html
fragstat -H all.frags >all.html
fragstat -H begun.log >begun.html
ok 'a page of a run that goes on reloads itself' grep -q '<meta http-equiv="refresh" content="7">' half.html
ok 'a page of a run that has ended does not' sh -c '! grep -q refresh all.html'
is 'names are escaped' "$(grep -c '<script' begun.html) $(grep -c '&lt;script&gt;alert(1)&lt;/script&gt;&quot;&amp;' begun.html)" '0 3'
is 'a page needs no other file' "$(grep -oE '(src|href)="[^"]{0,22}' half.html)" 'src="data:image/png;base64,'
sed 's/.*base64,\([^"]*\)".*/\1/; t; d' all.html | base64 -d >page.png
gather -o all.png all.frags
ok 'the picture of the page' cmp page.png all.png
ok 'the page is valid XML where a parser would trip: all elements are closed' awk '
	{ while (match($0, /<\/?(div|svg|path|pre|p|span|rect|title|h1|h2|i|head|body|html|style)[ >]/)) {
		tag = substr($0, RSTART + 1, RLENGTH - 2); $0 = substr($0, RSTART + RLENGTH)
		if (tag == "path") continue
		if (sub(/^\//, "", tag)) n[tag]--; else n[tag]++ } }
	END { for (t in n) if (n[t]) { print t, n[t]; exit 1 } }' begun.html
cp begun.log grows.log
MARK=$mark fragstat -f -H -i .1 -o grows.html grows.log 2>err &
pid=$!
ok '-f -H: the page comes' await 1 test -s grows.html
ln grows.html first.html
cp grows.html copy.html
echo bye >>grows.log
wait $pid
is '-f -H: at the end the status tells that pixels are missing' $? 1
is '-f -H: the last page does not reload' "$(grep -c refresh grows.html)" 0
ok '-f -H: a page is never written in place' cmp first.html copy.html
if there chromium; then
	# browse WIDTH FILE: prints the page as the browser has built it
	browse() {
		timeout 120 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$tmp/chromium" --window-size="$1",900 \
			--virtual-time-budget=1000 --dump-dom "file://$tmp/$2" 2>/dev/null
	}
	# What the page is as wide as, and how wide its picture is on the screen, by a script that the test adds.
	measure='<script>window.onload = () => { const i = document.images[0]; document.title = [document.documentElement.scrollWidth <= innerWidth, i ? i.naturalWidth : 0, document.querySelectorAll(".lane svg").length].join(" ") }</script>'
	for width in 1200 500; do
		sed "s|</body>|$measure</body>|; /Content-Security-Policy/d; /style-src/d" all.html >measured.html
		browse $width measured.html >dom
		like "Chromium, $width pixels wide: nothing is wider than the window; the picture and a lane are there" "$(cat dom)" '<title>true 32 1</title>'
	done
	fragstat -H ended.log >ended.html # a page that reloads itself never comes to rest
	browse 1200 ended.html >dom
	like 'Chromium: a name is text' "$(cat dom)" '1 &lt;script&gt;alert'
	# The size of the screenshot, without words that a browser prints.
	timeout 120 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$tmp/chromium" --window-size=600,400 --screenshot="$tmp/shot.png" \
		"file://$tmp/all.html" >/dev/null 2>&1
	ok 'Chromium draws the page' imgcmp -q shot.png shot.png
else skip 'the page in a browser' 'chromium is not there'
fi

# ---- a loss in the log of a run with a policy ------------------------------------------------------------------------
cat >dies <<'END'
#!/bin/sh
# The other slot begins after the loss.
if mkdir once 2>/dev/null; then
	rtworker - | dd bs=1 count=2000 2>/dev/null
	: >once/lost
	exit 9
fi
until [ -e once/lost ]; do sleep .02; done
exec "$@"
END
chmod +x dies
{ pack scene tetra.nff; partition 64x64; } | deal fan -j 2 ./dies rtworker - >lossy.log 2>err
like 'deal passes a loss on, for the log' "$(grep -a '^gone' lossy.log)" '^gone w=[01] why=[a-z0-9-]+ lost=[0-9]+ recv_us=[0-9]+ host=: (said=[^ ]* )?kept=1 sum='
like 'the loss is shown' "$(fragstat -f lossy.log)" '^lost at .*: slot [01] on localhost [(]'
{ pack scene tetra.nff; partition 64x64; } | deal fan -j 1 deal fan -j 2 ./dies rtworker - >deep.log 2>err
rm -r once
{ pack scene tetra.nff; partition 64x64; } | deal fan -j 1 deal fan -j 2 ./dies rtworker - >deep.log 2>err
is 'a loss within a tree: the run goes on' $? 0
gather -o deep.png deep.log
ok 'a loss within a tree: the same picture' cmp deep.png real.png
like 'a loss within a tree is passed on, with its place' "$(grep -a '^gone' deep.log)" '^gone why=[a-z0-9-]+ lost=[0-9]+ kept=1 w=0[.][01] recv_us='

# ---- refused -----------------------------------------------------------------------------------------------------
# A picture larger than the memory: 18 bytes a pixel, of which most are missing.
rtworker tetra.nff >large.log <<END
frame 0 8000 8000
task 0 0 0 0 1 1 1 1
END
# shellcheck disable=SC2016  # the last number: pages of 4 KiB that the program got
run sh -c 'prlimit --as=409600000 fragstat -H large.log >large.html; echo $? $(cut -d " " -f 11 /proc/$$/stat)'
like 'a page of a picture that exceeds the memory: exit 0, and only the pixels that are there are read' "$out" '^0 1?[0-9]{1,4}$'
like 'a page of a picture that exceeds the memory: it has the picture' "$(cat large.html)" 'data:image/png'
run env TMPDIR="$tmp/none" fragstat -H large.log
is 'a page of a picture that cannot be kept: status 3' "$status" 3
like 'and a message says why' "$err" '^fragstat: .*/none: cannot keep the pixels, expected TMPDIR'
# A host with two slots is lost: the marks are in its lanes, not in those of the first one.
"$root/tests/seal" >lost.log <<'END'
hello deal 0.1 selftest=0 slots=2
up w=0 host=good power=1 slots=1
up w=1 host=bad power=1 slots=2
done 0 0 cpu_us=90000 wall_us=100000 w=0 sent_us=0 recv_us=120000
done 0 1 cpu_us=90000 wall_us=100000 w=1.0 sent_us=0 recv_us=120000
done 0 2 cpu_us=90000 wall_us=100000 w=1.1 sent_us=0 recv_us=120000
gone w=1 why=silent tasks=1 recv_us=200000
done 0 3 cpu_us=90000 wall_us=100000 w=0 sent_us=0 recv_us=320000
END
is 'a lost host of several slots is marked in their lanes' "$(fragstat -H lost.log | grep -o 'class="lane"><span>[^<]*\|<title>lost: silent' | tr '\n' ' ')" \
	'class="lane"><span>0  class="lane"><span>1.0  <title>lost: silent class="lane"><span>1.1  <title>lost: silent '
ok 'its events have a line of their own' sh -c "fragstat -t lost.log | grep -q '\"tid\":7,\"args\":{\"name\":\"slot 1\"'"
for args in '-f' '-f -' '-H' '-f all.frags half.log' '-f -s all.frags' '-f -t all.frags' '-f -H all.frags' '-H -w 1 all.frags' \
	'-o x.html all.frags' '-g -t all.frags' '-t -H all.frags' '-f -i 0 all.frags' '-H nosuch.log' '-H -c all.frags all.frags'; do
	# shellcheck disable=SC2086
	run fragstat $args </dev/null
	is "usage: fragstat $args" "$status$(echo x.*)" '2x.*'
done
odd=$(printf 'odd\377\302\233\033.log') && cp all.frags "$odd"
is 'a name that is no UTF-8 makes a page that is' "$(fragstat -H "$odd" | iconv -f UTF-8 -t UTF-8 | grep -ao '<title>.*</title>')" \
	"$(printf '<title>odd\357\277\275\357\277\275\357\277\275\357\277\275.log</title>')"
cp ended.log kept.log
run fragstat -H -o ./kept.log kept.log
is 'refused: a page under the name of its log' "$status:$err" '2:fragstat: ./kept.log: is also the log, expected another file'
ok 'which stays as it is' cmp kept.log ended.log
finish
