#!/bin/sh
# gather: the pictures that it assembles, the input that it refuses or reports, and how it ends.
# shellcheck disable=SC1091,SC2059,SC2154
. "$(dirname "$0")/lib.sh"

# The 4 bytes of an RGBA pixel's floats 1/2, 0, 1/4, 1, and of another with 1 for 1/2.
half='\000\000\000\077\000\000\000\000\000\000\200\076\000\000\200\077'
full='\000\000\200\077\000\000\000\000\000\000\200\076\000\000\200\077'

PATH=$PATH:$root/tests
# frag FRAME ID "X Y W H SX SY" PIXEL COUNT [KEYS [JOB]]: prints one record without its sum
frag() {
	rm -f body
	i=0
	while [ $i -lt "$5" ]; do
		printf "$4"
		i=$((i + 1))
	done >body
	crc=$(gzip -c <body | tail -c 8 | od -An -tu1 -N4 |
		awk '{ printf "%.0f", $1 + 256 * ($2 + 256 * ($3 + 256 * $4)) }')
	printf 'frag %s %s %s job=%s ch=4 crc=%s bytes=%d%s\n' "$1" "$2" "$3" "${7-cafe}" "$crc" $((16 * $5)) "${6-}"
	cat body
	echo
}
# picture FRAME [JOB]: prints a complete stream of 3 rows of 4 pixels
picture() {
	{
		echo 'hello rtworker 0.1 selftest=0'
		echo "frame $1 4 3 job=${2-cafe}"
		for y in 0 1 2; do
			echo "done $1 $y cpu_us=1 wall_us=1"
			frag "$1" "$y" "0 $y 4 1 1 1" "$half" 4 '' "${2-cafe}"
		done
		echo bye
	} | seal
}
picture 0 >whole
{
	printf 'P7\nWIDTH 4\nHEIGHT 3\nDEPTH 3\nMAXVAL 255\nTUPLTYPE RGB\nENDHDR\n'
	i=0
	while [ $i -lt 12 ]; do printf '\274\000\211'; i=$((i + 1)); done
} >want.pam

# ---- whole pictures
run gather -o a.pam whole
is 'a whole picture: status 0, silent' "$status$out$err" 0
ok 'the picture has the pixels that were sent' cmp a.pam want.pam
gather <whole >a.png
ok 'the default is a PNG on standard output' imgcmp a.png want.pam
ok 'the PNG holds the job' grep -aq 'tEXtJob.cafe' a.png
gather -o b.png <whole
ok 'the PNG has the same bytes every time' cmp a.png b.png
gather -k 16 -o c.png whole
gather -o c.pfm whole
ok '-k 16: the PNG has linear light to 1/65535' imgcmp -t 0.000008 c.png c.pfm
{
	echo 'frame 0 4 3 job=cafe w=0'
	frag 0 7 '1 0 6 1 2 1' "$half" 6 ' w=0'
	frag 0 8 '0 0 6 1 2 1' "$half" 6 ' w=1.2'
} | seal >scattered
gather -o e.png scattered
ok 'scattered fragments made by hand: the picture'"'"'s declaration: the same picture' cmp a.png e.png

# ---- twice, and differently
{
	echo 'hello fan 0.1 selftest=0'
	echo 'frame 0 4 3 job=cafe w=2.1 host=render1'
	frag 0 9 '0 1 4 1 1 1' "$full" 4 ' w=2.1'
	echo bye
} | seal >other
{ cat whole other; } >twice
run gather -o t.pam twice
is 'differing duplicates: status 1' "$status" 1
is 'differing duplicates: the message has the slots, the place and the difference' "$err" 'gather: frame 0: 4 pixels of a worker (twice) and of slot 2.1 on render1 (twice) differ, most at 0,1, by 0.5: one of the two is wrong; those of the first were kept'
ok 'differing duplicates: the first stands' cmp t.pam want.pam
cat whole whole >same
run gather -o t.pam same
is 'equal duplicates: silent' "$status$err" 0
gather <same >s.png
ok 'a whole picture is written once' cmp a.png s.png
{ echo 'frame 0 4 3 job=cafe'; frag 0 9 '0 0 4 2 1 1' "$full" 8; cat whole; } | seal | gather -o t.pam 2>err.txt
like 'overlapping fragments: only the overlap is counted' "$(cat err.txt)" '^gather: frame 0: 8 pixels of a worker \(standard input\) and'
{ echo 'frame 0 4 3 job=cafe'; frag 0 9 '0 0 4 2 1 1' "$full" 8; frag 0 2 '0 2 4 1 1 1' "$half" 4; } | seal |
	gather -o u.pam
ok 'duplicates in an incomplete frame: the first stands' cmp t.pam u.pam

# 70 pictures, of each another slot sends other pixels: not all are listed.
for n in $(seq 70); do
	printf 'frame %d 1 1 job=cafe w=0\n' "$n"
	frag "$n" 0 '0 0 1 1 1 1' "$full" 1 ' w=0'
	frag "$n" 1 '0 0 1 1 1 1' "$half" 1 ' w=1'
done >many.unsealed
seal <many.unsealed >many
run gather -o m%d.pam many
is 'differing duplicates in 70 pictures: 64 are listed, and the rest is counted' \
	"$status $(printf '%s\n' "$err" | grep -c 'one of the two') $(printf '%s\n' "$err" | tail -n 1)" '1 64 gather: ... and 6 differing pixels more'
rm m*.pam

# Pictures that come again after the next one is complete.
for n in 0 1 2; do picture $n; done >three
{ cat three; frag 0 2 '0 2 4 1 1 1' "$full" 4 | seal; } >again
run gather -o a%d.pam again
is 'a part that comes again, later: silent' "$status$err" 0
run gather -P -o a%d.pam again
like 'a part that comes again, later, with -P' "$status $err" \
	'^0 .*gather: 4 pixels came again too late to be compared: after the next picture was complete$'
is '-m compares nothing' "$(gather -m again 2>&1)" ''

# ---- refused
{
	echo 'frame 0 4 3 job=cafe w=0'
	echo 'frame 0 4 3 job=beef w=1'
	frag 0 0 '0 0 4 3 1 1' "$full" 12 ' w=1' beef
	cat whole
} | seal >foreign
run gather -o f.pam foreign
is 'another job: status 0 when the rest has come' "$status" 0
like 'another job: named' "$err" 'frame 0: slot 1 \(foreign\) has job beef of 4x3, expected cafe of 4x3'
like 'another job: counted' "$err" '1 fragment ignored: of another job'
ok 'another job: not in the picture' cmp f.pam want.pam
{
	frag 0 0 '0 0 4 1 1 1' "$full" 4
	cat whole
	frag 0 0 '0 3 4 1 1 1' "$full" 4
	echo 'task 0 9 0 0 1 1 1 1'
	echo 'frame 0 4 3'
} | seal >odd
run gather -o f.pam odd
is 'garbage: status 0' "$status" 0
like 'a fragment before its frame' "$err" '1 fragment ignored: of no declared frame'
like 'a fragment outside' "$err" '1 fragment ignored: outside'
like 'tasks, and frames without a job' "$err" '2 records ignored, expected fragments'
ok 'garbage: not in the picture' cmp f.pam want.pam
frag 0 0 '0 0 1 1 1 1' "$half" 1 >one
for n in $(seq 0 64); do sed "s/^frag 0/frag $n/" one; done | seal >early
for n in $(seq 0 63); do
	echo "frame $n 1 1 job=cafe"
	sed "s/^frag 0/frag $n/" one
done | seal >most
run gather -o 'early%d.pam' early most
is 'the 65th of many frames with fragments before them is never declared: status 1' "$status $(ls early*.pam | wc -l)" '1 64'
rm early*.pam
{
	echo 'frame 0 4 3 job=cafe'
	frag 3 0 '0 0 4 1 1 1' "$full" 4
	cat whole
} | seal >odd
run gather -o f.pam odd
is 'an undeclared frame: status 1, and the picture' "$status$(cmp f.pam want.pam)" 1
nan='\000\000\300\177\000\000\000\000\000\000\200\076\000\000\200\077'
{ cat whole; frag 0 9 '0 1 4 1 1 1' "$nan" 4 | seal; } >odd
run gather -o f.pam odd
is 'bad pixels: not in the picture' "$status$(cmp f.pam want.pam)" 0
is 'bad pixels: a message says so' "$err" \
	"gather: 1 damaged record ($(($(wc -c <odd) - $(wc -c <whole))) bytes) skipped; the last: bad pixels, expected finite numbers >= 0, and alpha of at most 1"
for change in 's/ 0 1 0 1 4 / 0 1 0 2 4 /' 's/^(frag 0 2 .*)cafe/$1cafd/' 's/^frame 0/frame 1/'; do
	perl -pe "$change" whole >odd
	run gather -o f.pam odd
	is "$change: status 1" "$status" 1
	like "$change: a message says so" "$err" 'damaged record.*: sum differs, expected the line that was sent'
done

# ---- a log of another format
sed -e 's/ sum=........$//; s/ format=4//' -e 's/ job=cafe ch/ ch/' whole >format1
perl -e 'while (<>) { s/ format=4/ format=2/; print; next unless / bytes=(\d+)/; read ARGV, $_, $1 + 1; chop; print }' whole | seal >format2
for format in 3 5; do sed "s/ format=4/ format=$format/" whole | seal >format$format; done
remedy='expected 4: use programs of one version, or begin a new log'
for args in 'gather -o f.pam' 'gather -m' 'gather -o f.pam whole' fragstat 'replay -x 0' 'partition -o cost:'; do
	for log in format1 format2 format3 format5; do
		case $args in *:) set -- "$args$log" 4x3 ;; *) set -- "$args" "$log" ;; esac
		# shellcheck disable=SC2086
		run $1 $2 <whole
		is "$args $log: status 2" "$status" 2
		like "$args $log: by name" "$err" ": $log: is of format ${log#format}, $remedy\$"
	done
done
for log in format1 format2 format3 format5; do
	cp $log before
	run gather -r $log -o f.pam whole
	is "gather -r $log: status 2, and nothing is appended" "$status$(cmp $log before)" 2
	like "gather -r $log: by name" "$err" "$log: is of format ${log#format}, $remedy\$"
	run partition -r $log 4x3
	like "partition -r $log: by name" "$status$err" "^2.*$log: is of format ${log#format}, $remedy\$"
	run gather -o f.pam <$log
	like "gather <$log: by name" "$status$err" "^2.*standard input: is of format ${log#format}, $remedy\$"
done
{ cat whole; frag 0 1 '0 1 4 1 1 1' "$full" 4 | seal | head -c -1; echo bye; } >joined
run gather -o f.pam joined
is 'no newline after a body: the record is lost, and no other' "$status$(cmp f.pam want.pam)" 0
like 'no newline after a body: a message says so' "$err" 'damaged record.*: no newline after the body, expected'

printf 'Linux render1 6.1.0\nLast login: today\n' | cat - whole >chatty
run gather -o f.pam chatty
is 'bytes between records: status 0' "$status" 0
like 'bytes between records: counted' "$err" 'damaged record.*\(38 bytes\) skipped'

# ---- incomplete
head -c 320 whole >torn
run gather -o n.png torn
is 'incomplete: status 1' "$status" 1
like 'incomplete: a message lists the missing pixels' "$err" '^gather: frame 0: 8 of 12 pixels missing: rows 1-2$'
like 'incomplete: what to do' "$err" '^gather: to resume, rerun the command of a log with -r LOG$'
is 'incomplete: no file' "$(find . -name 'n.png*')" ''
run gather -k 16 -r 'the log' -o n.png torn
like 'incomplete, with a log: what to do' "$err" '^gather: to resume from the log, rerun the command$'
ln -s round.png round.png
run gather -o round.png whole
is 'a link to itself is not replaced' "$status:$err:$(readlink round.png)" '3:gather: round.png: Too many levels of symbolic links:round.png'
run sh -c 'gather -o n.png <torn'
like 'without a log' "$err" 'no log was kept'
run gather -o n.png /dev/null
# "-" is standard input, as if nothing were named.
{ picture 0 | sed '$d'; echo 'bye why=other-jobs'; } 2>/dev/null | seal >odd.jobs
is '-: the end of the run counts' "$(gather -o a.pam - <odd.jobs 2>err.txt; echo $?) $(grep -c 'did not agree' err.txt)" '3 1'
is 'a log beside - is no end of this run' "$(gather -o a.pam odd.jobs - </dev/null 2>&1; echo $?)" 0
is '-: no log was kept' "$(gather -o n.png - <torn 2>&1 | grep -c 'no log was kept')" 1
is 'empty input: status 1' "$status" 1
like 'empty input: a message says so' "$err" 'no frame was declared'

# ---- missing pixels as tasks
run gather -m whole
is '-m: nothing is missing' "$status$out$err" 0
run gather -m torn
is '-m: frame and tasks, new ids' "$out" 'frame 0 4 3 job=cafe
task 0 2 0 1 4 1 1 1
task 0 3 0 2 4 1 1 1'
spdgen -s 2 tetra >tetra.nff
partition 16x12 | rtworker tetra.nff >good.frags
head -c 1700 good.frags >job.frags
run gather -o tetra.png job.frags
is 'a torn log of rtworker: status 1' "$status" 1
ok 'the tasks that are missing are rendered' sh -c 'gather -m job.frags | rtworker tetra.nff >>job.frags && gather -o tetra.png job.frags'
gather -o all.png good.frags
ok 'they give the same bytes' cmp tetra.png all.png

# At every byte the stream may end, or one record may be torn and others follow.
# offsets: "kind row from to" of each record of `whole`
offsets() {
	at=0
	while read -r kind row size; do
		echo "$kind $row $at $((at + size))"
		at=$((at + size))
	done <<LIST
hello - $(sed -n 1p whole | wc -c)
frame - $(sed -n 2p whole | wc -c)
$(for y in 0 1 2; do
		echo "done - $(printf 'done 0 %d cpu_us=1 wall_us=1\n' $y | seal | wc -c)"
		echo "frag $y $(frag 0 $y "0 $y 4 1 1 1" "$half" 4 | seal | wc -c)"
	done)
bye - 4
LIST
}
offsets >offsets.txt
is 'the offsets of the records end at the end of the stream' "$(tail -n 1 offsets.txt | cut -d ' ' -f 4)" "$(wc -c <whole | tr -d ' ')"
# rows: the rows of the tasks that gather -m lists
rows() { awk '$1 == "task" { if ($4 != 0 || $6 != 4 || $7 != 1) print "odd"; print $5 }' listed | tr '\n' ' '; }
bad='' checked=0 missing='0 1 2 '
while read -r kind row from to; do
	at=$from
	while [ "$at" -lt "$to" ]; do
		expected=1
		[ "$kind" = hello ] || [ "$kind" = frame ] || expected=0
		head -c "$at" whole >ended
		gather -m ended >listed 2>/dev/null
		got="$? $(rows)"
		want="$expected $([ $expected -eq 1 ] || printf %s "$missing")"
		[ "$got" = "$want" ] || bad="$bad
end at $at: got $got, expected $want"
		if [ "$at" -gt "$from" ]; then
			tail -c +$((to + 1)) whole | cat ended - >hole
			gather -m hole >listed 2>/dev/null
			got="$? $(rows)"
			want='0 '
			[ "$kind" = frame ] && want='1 '
			[ "$kind" = frag ] && want="0 $row "
			[ "$got" = "$want" ] || bad="$bad
torn at $at: got $got, expected $want"
		fi
		checked=$((checked + 1))
		at=$((at + 5))
	done
	[ "$kind" = frag ] && missing=${missing#* }
done <offsets.txt
is "cut at each of $checked bytes: exactly the lost pixels are listed" "$bad" ''
bad=''
at=0
while [ $at -lt "$checked" ]; do
	head -c $at whole | cat - whole | gather -o r.pam 2>/dev/null || bad="$bad $at:status"
	cmp -s r.pam want.pam || bad="$bad $at:pixels"
	rm -f r.pam
	at=$((at + 7))
done
is 'a torn run, then a good one: the picture' "$bad" ''

# ---- the log
rm -f log
gather -r log -o l.png <whole
ok '-r: every record as it was' cmp log whole
gather -r log -o l.png <whole
ok '-r: appends' cmp log same
run gather -r log -o l.png log
is 'the log as input: status 2' "$status" 2
rm -f l.pam
run gather -r /dev/full -o l.pam whole
is 'log on a full disk: status 3' "$status" 3
like 'log on a full disk: a message says so' "$err" '/dev/full: No space left'
ok 'log on a full disk: the same picture' cmp l.pam want.pam

# ---- large: a frame of more than 2^24 pixels is kept in a file without a name
run sh -c "echo 'frame 0 65535 65535 job=cafe' | seal | gather -o big.pam"
is '65535x65535, declared: status 1' "$status" 1
like '65535x65535, declared: what is missing' "$err" '4294836225 of 4294836225 pixels missing: rows 0-65534'
{
	echo 'hello rtworker 0.1 selftest=0'
	echo 'frame 0 8192 8192 job=cafe'
	frag 0 0 '8190 8191 2 1 1 1' "$half" 2 ' w=0'
	frag 0 1 '8190 8191 2 1 1 1' "$full" 2 ' w=1'
} | seal >large
mkdir here
TMPDIR=here run gather -o big.pam large
is 'large: status 1' "$status" 1
like 'large: differing duplicates are found' "$err" 'frame 0: 2 pixels of slot 0 [(]large[)] and of slot 1 [(]large[)] differ, most at 8190,8191, by 0.5'
like 'large: what is missing' "$err" '67108862 of 67108864 pixels missing: rows 0-8191'
is 'large: no file is left' "$(ls here)$(ls big.pam 2>&-)" ''
for dir in here none; do
	for o in '-o big.pam' ''; do
		rm -f log
		[ $dir = none ] && why='No such file or directory' || why='File too large'
		TMPDIR=$dir run sh -c "ulimit -f 100; gather $o -r log <large"
		is "large, no room in $dir ($o): status 3, and a line" "$status:$err" \
			"3:gather: $dir: cannot keep the pixels of frame 0, expected TMPDIR to name a directory with 1.2 GB: $why"
		is "large, no room in $dir ($o): the log has the pixels" "$(head -c "$(wc -c <log)" large | cmp - log && grep -ac '^frag 0 0 ' log)" 1
		is "large, no room in $dir ($o): nothing is left" "$(ls here)$(ls big.pam 2>&-)" ''
	done
done
unset TMPDIR
run sh -c 'ulimit -f 100; gather -o here/big.pam large'
like 'large, without TMPDIR: beside the picture' "$err" '^gather: here: cannot keep the pixels'
run sh -c 'cd here; ulimit -f 100; gather -o big.pam ../large'
like 'large, without TMPDIR: in the current directory' "$err" '^gather: [.]: cannot keep the pixels'
run sh -c 'ulimit -f 100; gather large'
like 'large, without TMPDIR, to standard output: in /var/tmp' "$err" '^gather: /var/tmp: cannot keep the pixels'
{ echo 'frame 0 4 3 job=cafe w=0'; echo 'frame 0 65535 65535 job=cafe w=1'; cat whole; } | seal >foreign
run gather -o f.pam foreign
is 'another size, large: one worker'"'"'s mistake' "$status" 0

# ---- several frames
{ picture 0; picture 7; } >film
run gather -o 'f%03d.pam' film
is 'two frames: status 0' "$status" 0
is 'two frames: their names' "$(echo f0*)" 'f000.pam f007.pam'
for o in '-o x.png' ''; do
	# shellcheck disable=SC2086
	run gather $o film
	is "two frames, one name ($o): status 2" "$status" 2
	like "two frames, one name ($o): a message says so" "$err" 'a second picture for .*, expected -o with %d'
done
{ picture 0; picture 7 | head -c 100; } >film
run gather -o 'g%d.pam' film
is 'one of two frames: status 1, and the missing pixels' "$status $(echo g*.pam)" '1 g0.pam'
like 'one of two frames: a message says so' "$err" 'frame 7: 12 of 12 pixels missing: rows 0-2'
mkfifo slow
gather -o 'p%d.pam' <slow &
pid=$!
exec 3>slow
echo 'frame 7 4 3 job=cafe' | seal >&3
picture 0 >&3
i=0
while [ ! -e p0.pam ] && [ $i -lt 1000 ]; do sleep 0.1; i=$((i + 1)); done
ok 'a frame is written before the stream ends' cmp p0.pam want.pam
picture 7 >&3
exec 3>&-
ok 'end of a stalled stream' wait $pid

# ---- bad usage
for args in '-k 9' '-k 7' '-k x' '-o x.jpg' '-o png' '-o %s.png' '-o %d%d.png' '-m -o x.png' '-m -r x' '-z' \
	'nosuch.frags'; do
	# shellcheck disable=SC2086
	run gather $args </dev/null
	is "usage: gather $args" "$status" 2
done
run gather -h
is '-h: usage and status 0' "$status $(printf '%s' "$out" | head -n 1 | cut -c 1-14)" '0 usage: gather '
run gather -o nosuch/x.png whole
is 'no such directory: status 3 at once' "$status" 3

# ---- ends
status=0
gather whole >/dev/full 2>err.txt || status=$?
is 'full disk: status 3' "$status" 3
like 'full disk: a message says so' "$(cat err.txt)" '^gather: standard output: No space left'
status=0
gather -m torn >/dev/full 2>err.txt || status=$?
is '-m on a full disk: status 3' "$status" 3
# left COMMAND ...: runs it with a pipe whose reader is gone
mkfifo shut
left() {
	: <shut & exec 4>shut
	wait $!
	"$@" >&4 2>err.txt
	echo $? >status
	exec 4>&-
}
left gather whole
is 'reader gone before: quiet, status 3' "$(cat status err.txt)" 3
left gather -m torn
like '-m, reader gone: status 3' "$(cat status)" '^3$'
mkfifo held
sleep 20 >held &
holder=$!
{ gather <held 2>err.txt; echo $? >status; } | :
kill $holder
is 'reader gone while waiting for input: quiet, status 3' "$(cat status err.txt)" 3

# ---- progress
run gather -P -o a.pam whole
like '-P: percent and ETA' "$err" 'gather: 100.0 %, ETA 0:00'
run gather -o a.pam whole
is 'no progress is shown if stderr is a file' "$err" ''
finish
