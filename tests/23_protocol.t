#!/bin/sh
# protocol and tsvstat: interrupted tables resume, tables of other runs are refused; statistics of samples; refusals.
. "$(dirname "$0")/lib.sh"
needs gnuplot ps tsvstat
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
tab=$(printf '\t')
tsv() { printf '%s\n' 'experiment kind method x x_unit y y_unit sample seed' "$@" | tr ' ' "$tab"; }

# ---- tsvstat: means and intervals ----------------------------------------------------------------------------------
tsv 'e real m 1 s 1 s 1 0' 'e real m 1 s 2 s 2 0' 'e real m 1 s 3 s 3 0' 'e real m 1 s 4 s 4 0' 'e real m 1 s 5 s 5 0' \
	'e real m@a 1 s 7 s 1 0' 'e real m@a 2 s 9 s 2 0' 'e real m 2 s 8 s 1 0' >five.tsv
run tsvstat five.tsv
# t of .975 and 4 degrees of freedom is 2.77645
is 'a mean and its interval, by hand' "$(echo "$out" | sed -n 2p)" "e${tab}real${tab}m${tab}1${tab}5${tab}0${tab}3${tab}2.5${tab}1.03675684${tab}4.96324316"
like 'one sample gives no interval' "$out" "m${tab}2${tab}1${tab}0${tab}8${tab}0${tab}-inf${tab}inf"
like 'a setting is one point at any x' "$out" "m@a${tab}1.5${tab}2${tab}0${tab}8"
{ cat five.tsv; tsv 'e real m 1 s 99 s 6 0' | sed 1d; } >six.tsv
like 'an outlier counts' "$(tsvstat six.tsv)" "m${tab}1${tab}6${tab}0${tab}19"
tsv 'e real m@s 1 s 1 s 1 0' 'e real m@s 1 s 2 s 2 0' 'e real m@s 1 s 3 s 3 0' 'e real m@s 1 s 4 s 4 0' 'e real m@s 1000 s 99 s 5 0' >far.tsv
like '-r removes its x, too' "$(tsvstat -r far.tsv)" "m@s${tab}1${tab}4${tab}1${tab}2.5"
like '-r removes it' "$(tsvstat -r six.tsv)" "m${tab}1${tab}5${tab}1${tab}3${tab}2.5"

# ---- comparisons: a is 1 less than b in each pair, c differs from a by little, d is a with more noise ----------------
for i in 1 2 3 4 5 6; do
	echo "$i" | awk '{ i = $1
		print "e real a 1 s", 10 * i, "s", i, 0; print "e real b 1 s", 10 * i + 1 + i / 100, "s", i, 0
		print "e real c 1 s", 10 * i + .1 * (i % 2), "s", i, 0; print "e real d 1 s", (i % 2 ? -1 : 1) * 1000, "s", i, 0
		if (i > 1) print "e real f 1 s", 10 * i + 2 + i / 100, "s", i, 0 }'
done >lines
xargs -d '\n' sh -c 'printf "%s\n" "$@"' x <lines | { tsv; tr ' ' "$tab"; } | sed '/^$/d' >pairs.tsv
verdict() { tsvstat -c .999 -t "$@" pairs.tsv | awk -F '\t' -v s="$?" 'NR > 1 { print $NF }'; }
is 'less holds, by pairs' "$(verdict less a b)" holds
is 'less holds by the pairs that exist' "$(verdict less a f)$(verdict more f a)" holdsholds
is 'more fails where less holds' "$(verdict more a b)" fails
is 'an interval across 0 is open' "$(verdict less a d)" open
is 'same holds within a margin' "$(verdict same:.01 a c)" holds
is 'same fails within a smaller margin' "$(verdict same:.001 a b)" fails
is 'steadier holds, fails, and is open' "$(verdict steadier a d)$(verdict steadier d a)$(verdict steadier a a)" holdsfailsopen
tsv 'e real z 1 s 0 s 1 0' 'e real z 1 s 0 s 2 0' 'e real w 1 s .001 s 1 0' 'e real w 1 s .001 s 2 0' 'e real v 1 s 0 s 1 0' \
	'e real v 1 s 0 s 2 0' >zero.tsv
is 'same with a mean of 0 holds for 0 only' "$(tsvstat -t same:.1 v z zero.tsv | cut -f 10)$(tsvstat -t same:.1 w z zero.tsv | cut -f 10)" "$(
	printf 'verdict\nholdsverdict\nfails')"
run tsvstat -t less a b pairs.tsv
is 'exit 0 when it holds' "$status" 0
run tsvstat -t more a b pairs.tsv
is 'exit 1 when it does not' "$status" 1
# refused LINE WHY ROW: tsvstat exits 2, and prints line and reason
refused() {
	tsv "$3" >bad.tsv
	run tsvstat bad.tsv
	is "refused: $2" "$status $(echo "$err" | grep -c "^tsvstat: bad.tsv:$1: .*$2.*expected\|^tsvstat: bad.tsv:$1: expected.*$2")" '2 1'
}
refused 2 'y is "x"' 'e real m 1 s x s 1 0'
refused 2 'sample is "-1"' 'e real m 1 s 1 s -1 0'
refused 2 '8 fields' 'e real m 1 s 1 s 1'
run sh -c 'echo nonsense | tsvstat'
like 'refused: no names of columns' "$status $err" '^2 tsvstat: standard input:1: column 1 is "nonsense", expected'
run tsvstat -t less a nosuch pairs.tsv
like 'refused: no x with both methods' "$status $err" '^1 .*expected experiments with both methods'
{ cat five.tsv; sed -n 2p five.tsv; } >twice.tsv
run tsvstat twice.tsv
like 'refused: the same sample twice' "$status $err" '^2 tsvstat: twice.tsv:10: the same .* as in line 2, expected each once'

# ---- protocol: the list of experiments ---------------------------------------------------------------------------------------
run protocol -l
is 'the list names every experiment' "$(echo "$out" | cut -f 1)" "$(cd "$root/tests/experiments" && find . -type f ! -name '*.sh' | sed 's,.*/,,' | LC_ALL=C sort)"
is 'the list has six columns' "$(echo "$out" | awk -F '\t' 'NF != 6 || /\t\t|\t$/')" ''
for e in $(echo "$out" | cut -f 1); do
	grep -q "^\.It Cm $e\$" "$root/man/protocol.1" || echo "$e"
done >missing
is 'protocol(1) has all experiments' "$(cat missing)" ''
for args in '' '-n 0 faults' '-n x faults' '-s -1 faults' '-s 010 faults' '-o' 'nosuch' '../protocol' 'faults faults'; do
	# shellcheck disable=SC2086
	run protocol $args
	is "usage: protocol $args" "$status" 2
done

# ---- resuming: with the same costs, one run without a stop, and one killed at a random moment ------------
mkdir relative
ok 'an experiment to standard output, with a relative TMPDIR' sh -c 'TMPDIR=relative protocol -n 1 faults >whole.tsv'
is 'a complete table has no work directory beside it' "$(echo whole.tsv*)" 'whole.tsv'
is 'the table has all rows of the plan' "$(grep -vc '^#' whole.tsv)" 13
TMPDIR=$tmp protocol -n 1 -o a.tsv faults 2>/dev/null &
run=$!
until [ -e a.tsv ] && [ "$(grep -vc '^#' a.tsv)" -ge 3 ] || ! kill -0 $run 2>/dev/null; do sleep .02; done
kill -9 $run 2>/dev/null
wait $run
# If the run was quick enough, its table is complete.
sed '/^experiment/q' a.tsv >b.tsv
mkdir -p b.tsv.d && cp a.tsv.d/* b.tsv.d 2>/dev/null
if [ "$(grep -vc '^#' a.tsv)" -lt 12 ]; then
	printf 'balls	simulated	to' >>a.tsv
	ok 'the same command resumes after half a row' protocol -n 1 -o a.tsv faults
	ok 'an uninterrupted run with the same costs writes the same table' protocol -n 1 -o b.tsv faults
	ok 'the interrupted and the uninterrupted run give the same table' cmp a.tsv b.tsv
fi
run protocol -n 1 -o whole.tsv faults
is 'a complete table is left unchanged' "$status$out" 0
run protocol -n 1 -s 1 -o whole.tsv faults
like 'refused: another seed' "$status $err" '^2 protocol: .*whole.tsv:1: is "# command: protocol -n 1 -s 0 faults", expected'
sed 's/^# commit: .*/# commit: other/' whole.tsv >other.tsv
run protocol -n 1 -o other.tsv faults
like 'refused: another commit' "$status $err" '^2 protocol: .*other.tsv:2: is "# commit: other", expected "# commit: '
sed 's/	hybrid	/	other	/' whole.tsv >other.tsv
run protocol -n 1 -o other.tsv faults
like 'refused: another plan' "$status $err" '^2 protocol: .*other.tsv:[0-9]+: .*expected'
run protocol -n 1 -o /nowhere/x.tsv faults
is 'nowhere to write: status 3' "$status" 3
run protocol -n 1 -o /dev/full faults
is 'a full disk: status 3' "$status $(echo "$err" | grep -c '^protocol: /dev/full: cannot be written$')" '3 1'
printf 'not a table,\nnor a whole line' >notes
cp notes kept
run protocol -n 1 -o notes faults
is 'another file is refused, and left as it was' "$status$(cmp notes kept 2>&1)" 2
mkdir mine.tsv.d
run protocol -n 1 -o mine.tsv faults
is 'a directory of another run beside no table is refused' "$status $(ls -d mine.tsv*)" '2 mine.tsv.d'
mkfifo held
flock whole.tsv cat held &
until ! flock -n whole.tsv true; do sleep .02; done
run protocol -n 1 -o whole.tsv faults
like 'a second run on the same table is refused' "$status $err" '^2 protocol: .*whole.tsv: another run writes it'
: >held
wait
mkdir -p "in stalled/bin" "in stalled/share/stormring" && cp "$root"/bin/* "in stalled/bin" &&
	cp -r "$root/tests/experiments" "in stalled/share/stormring" # what is installed has no tests beside it
run "in stalled/bin/protocol" -n 1 power
like 'an experiment on test hosts needs a clone' "$status $err" '^3 protocol: power: needs a clone of the source'
run protocol -n 1 -o real.tsv rays
like 'a real experiment notes the other load of the machine' "$(tail -n 1 real.tsv)" '^# others: took [0-9]+[.][0-9]+ of [0-9]+ processors'
run protocol -n 1 -o real.tsv rays
is 'a real experiment is complete after one run' "$status$out$err" 0

# ---- verdicts: tables made so that a claim holds, fails, or is open ------------------------------------------------
# made GDC INTERLEAVED: prints a table of faults with these speed-ups after two hosts are deleted
made() {
	sed '/^#/!d' whole.tsv
	for i in 1 2 3 4 5; do echo "$i"; done | awk -v gdc="$1" -v fan="$2" 'BEGIN { OFS = "\t"
		split("experiment kind method x x_unit y y_unit sample seed", c, " "); $0 = ""; for (i = 1; i <= 9; i++) $i = c[i]; print }
		function row(method, x, y) { print "balls", "simulated", method, x, 1, y, 1, i, i }
		{ i = $1; for (x = 0; x <= 2; x += 2) { row("interleaved", x, x ? fan : 6); row("masterslave", x, 10 + i / 50); row("hybrid", x, 10 + i / 50)
			row("gdc", x, x ? gdc * (1 + i / 50) : 11); row("gdc-published", x, 7 + i / 50) } }'
}
made 9 0 >good.tsv
run protocol -v faults good.tsv
is 'verdicts: one line per claim' "$status $(echo "$out" | wc -l)" "0 $(protocol -v faults whole.tsv | wc -l)"
is 'the verdict is "found" if all cells hold' "$(echo "$out" | awk -F '\t' 'NR == 2 { print $3, $4, $5, $6, $7 }')" '2 2 0 found -'
made 0 0 >bad.tsv
is 'the verdict is "found in part" if some cells hold' "$(protocol -v faults bad.tsv | awk -F '\t' 'NR == 2 { print $3, $4, $5, $6 }')" '2 1 1 found in part'
made 9 5 >bad.tsv
is 'the verdict is "not found" if the contrary holds' "$(protocol -v faults bad.tsv | awk -F '\t' 'NR == 4 { print $3, $4, $5, $6 }')" '1 0 1 not found'
# The claims of each experiment, on a table of its plan with arbitrary numbers: seven fields per line, and only known verdicts.
grep -v '	gdc' good.tsv >bad.tsv
is 'the verdict is "not decided" without samples' \
	"$(protocol -v faults bad.tsv 2>said | awk -F '\t' 'NR == 2 { print $3, $4, $5, $6, $7 }')" \
	'0 0 0 not decided the table has no samples of it'
like 'a statistic names its rows' "$(protocol -v faults good.tsv)" '	where x == 2: gdc same:0 each one; gdc-published same:0 each one	'
for e in $(protocol -l | cut -f 1); do
	if ! protocol -p -n 4 "$e" >plan 2>said; then
		skip "the claims of $e" "$(head -n 1 said)"
		continue
	fi
	awk -F '\t' -v OFS='\t' -v e="$e" 'BEGIN { print "# command: protocol -n 4 -s 0 " e
			for (i = split("experiment kind method x x_unit y y_unit sample seed", c, " "); i; i--) $i = c[i]; print }
		{ print $1, "real", $2, ($3 == "-" ? 1 + NR * 7907 % 103 / 1000 : $3), 1, 1 + NR * 7919 % 101 / 1000, 1, $4, $5 }' plan >made.tsv
	protocol -v "$e" made.tsv >verdicts 2>said
	# steals counts messages between the nodes of a ring.
	if [ "$e" != steals ] && grep -q "${tab}gdc$tab" plan; then
		ok "$e has adaptive beside gdc" grep -q "${tab}adaptive$tab" plan
	fi
	awk -F '\t' 'NF != 7 || /\t\t|\t$/ || NR > 1 && $6 !~ /^(found|found in part|not found|not decided|does not hold|holds until X = [0-9]+(e[0-9]+)?)$/' verdicts >odd
	is "the claims of $e" "$(wc -l <verdicts | awk '{ print ($1 > 1) }')$(cat odd said)" 1
	head -n 3 made.tsv >one.tsv
	run protocol -v "$e" one.tsv
	is 'a table that has only begun has verdicts' "$status" 0
done
# The cheapest rival that is as exact as a point of POV-Ray is compared. Without such a rival the claim fails.
# traced TIME ERROR: prints a table in which POV-Ray takes 1 s for an error of .02
traced() {
	echo '# command: protocol -n 3 -s 0 tracing'
	tsv
	for i in 1 2 3; do
		echo "$i" | awk -v OFS='\t' -v time="$1" -v error="$2" 'function row(method, x, y) { print "gears", "real", method, x, "s", y, 1, i, 0 }
			{ i = $1; row("POV-Ray +RN@1", 1 + i / 100, .02); row("rtworker -a N@1", time + i / 1000, error)
				row("rtworker -a N@4", time + 9, error); row("rtworker -a 16:T@0.1", time + 2, error)
				row("rtworker -a 1 -d N@5", .001 * i, .5); row("Tachyon -aasamples N@0", 5, .4) }'
	done
}
cheapest() { # the verdicts: less, and less than half
	traced "$1" "$2" >traced.tsv
	protocol -v tracing traced.tsv | awk -F '\t' 'NR == 2 || NR == 3 { printf "%d %d %d %s%s", $3, $4, $5, $6, NR == 2 ? ", " : "" }'
}
is 'a rival at less than half of the time: both claims hold' "$(cheapest .4 .02)" '1 1 0 found, 1 1 0 found'
is 'a rival at more than half of the time: the second claim fails' "$(cheapest .6 .01)" '1 1 0 found, 1 0 1 not found'
is 'no rival is as exact: both claims fail' "$(cheapest .4 .0203)" '1 0 1 not found, 1 0 1 not found'
# Takes one sample, the last of the plan, after made-up ones. kill leaves the head of the table.
sampled() {
	# Its children may write beside the table for a while.
	protocol -n 1 -o "head.$1.tsv" "$1" 2>said &
	run=$!
	until grep -q ^experiment "head.$1.tsv" 2>/dev/null || ! kill -0 $run 2>/dev/null; do sleep .02; done
	kill -9 $run 2>/dev/null
	wait $run 2>/dev/null
	protocol -p -n 1 "$1" >plan
	{ sed '/^experiment/q' "head.$1.tsv"; awk -F '\t' -v OFS='\t' '{ print $1, "made", $2, $3, 1, 1, 1, $4, $5 }' plan | sed '$d'; } >made.tsv
	mkdir "$1.tsv.d" && mv made.tsv "$1.tsv"
	run protocol -n 1 -o "$1.tsv" "$1"
	like "a sample of $1" "$status $(grep -v '^#' "$1.tsv" | tail -n 1 | cut -f 6)" "$2"
}
for e in hierarchy latency; do sampled $e '^0 [.0-9]+$'; done
if [ -n "${NIGHT-}" ]; then
	for e in variance steals stability loads price complexity regret agreement; do sampled $e '^0 [.0-9]+$'; done
	sampled limits '^0 [0-9]([.][0-9]+)?e-0[4-9]$'
fi
# Ctrl-C while processes compute beside a sample; an interactive shell gives it a group of its own.
# shellcheck disable=SC2016  # of perl
setsid perl -e '$SIG{INT} = "DEFAULT"; exec @ARGV' env MARK=$mark "$root/bin/protocol" -n 1 -o c.tsv slaves 2>/dev/null &
run=$!
computing() { [ -n "$(program sh 'sh -c while kill -0')" ]; }
ok 'a sample runs beside processes that compute' await 60 computing
kill -INT -$run
ok 'Ctrl-C ends the sample and these processes' await 10 none_alive
run sh -c 'echo | protocol -v faults'
is 'refused: input that is not a table' "$status $err" '2 protocol: standard input: expected a table of protocol faults'
run protocol -v faults nosuch.tsv
is 'refused: a file that does not exist' "$status $err" '2 protocol: nosuch.tsv: cannot be read, expected a table of protocol faults'
run protocol -v complexity whole.tsv
is 'refused: verdicts on a table of another experiment' "$status" 2

# ---- the page that make report makes, of one experiment ------------------------------------------------------------
EXPERIMENTS='faults' SAMPLES=2 run "$root/tests/report" "$tmp/page"
like 'report writes its page' "$status $out" '^0 made .*/page/index.html in [0-9]+ s$'
is 'the page has the chart, the verdicts, and the pictures of both views' \
	"$(grep -c '<svg\|<b>The paper reports\|<table class="verdicts"\|alt="".*base64,i.*<figcaption>gears, ' page/index.html)" 5
# Last stresses: a and c are in one table, because b meets the stresses of both; z meets another one.
sed -n '/^held() {/,/^}/p' "$root/tests/report" >held.sh
held() { printf "not claimed: how long $1 holds when $2${tab}mean${tab}3${tab}2${tab}1${tab}$3${tab}${4--}\\n"; }
{ held a 'X fall' 'holds until X = 4' && held b 'X fall' 'does not hold' && held b 'X rise' 'holds until X = 1e9' 'no more was tried'
	held c 'X rise' 'holds until X = 16' && held z 'it is X' 'holds until X = 2' && printf "other${tab}t${tab}1${tab}1${tab}0${tab}found${tab}-\\n"; } >lasting
is 'the page has tables of the last stress at which methods hold' "$(sh -c '. ./held.sh; held <lasting' | tr '\t\n' ',;')" \
	'method,X fall,X rise;a,4,-;b,no,≥ 1e9;c,-,16;;method,it is X;z,2;;'
is 'the page refers to no other file' "$(grep -Eo '(src|href)="[^"]{0,5}' page/index.html | grep -v '="data:\|="#' | head -n 3)" ''
finish
