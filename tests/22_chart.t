#!/bin/sh
# chart: its drawings, its refusals with the line that is wrong, and data that looks like commands.
# shellcheck disable=SC1091,SC2154
. "$(dirname "$0")/lib.sh"
needs gnuplot tsvstat

header='experiment kind method x x_unit y y_unit sample seed'
# tsv LINE ...: prints lines, with tabs for blanks except in comments
tsv() { printf '%s\n' "$@" | awk '!/^#/ { gsub(/ /, "\t") } { print }'; }
# texts FILE.svg: prints the texts of the chart
texts() { sed -n 's/.*<text>\(.*\)<\/text>.*/\1/p' "$1" | sed 's/<[^>]*>//g'; }

tsv '# title: Time by slots' '# x: slots' '# y: elapsed time' '# commit: abc1234' '# machine: this' '# seed: 0' \
	'# command: make times' "$header" \
	'gears real S_S 1 1 4.0 s 1 0' 'gears real S_S 1 1 4.4 s 2 0' 'gears real S_S 1 1 4.1 s 3 0' \
	'gears real S_S 2 1 2.0 s 1 0' 'gears real D_C@q=1 2 1 1.9 s 1 0' 'balls real D_C@q=1 2 1 1.5 s 1 0' >times.tsv

ok 'it writes SVG' chart -o times.svg times.tsv
texts times.svg >said
said=$(cat said)
like 'the title has the kind of the samples' "$said" '^Time by slots \(real\)$'
like 'the axes have names and units' "$said" '^elapsed time \(s\)$'
like 'a unit of 1 is not printed' "$said" '^slots$'
like 'a panel has the name of its experiment' "$said" '^gears$'
like 'a line has the name of its method, underscores as they are' "$said" '^S_S$'
like 'a setting is not part of the name' "$said" '^D_C$'
like 'the footer has command, machine, commit and seed' "$said" '^make times; machine this; commit abc1234; seed 0$'
run grep -c '^q=1$' said
is 'names of points only on request' "$out" 0
chart -l -o named.svg times.tsv && texts named.svg >said
is '-l prints names of points, in both panels' "$(grep -c '^q=1$' said)" 2
chart -p times.tsv >front.svg && texts front.svg >said
like '-p marks the front' "$(cat said)" '^Pareto front$'
{ echo '# front: marked'; cat times.tsv; } | chart >marked.svg
ok '"# front: marked" in a table does the same as -p' cmp front.svg marked.svg
ok 'it writes PNG' chart -L y -o times.png times.tsv
is 'the file is a PNG' "$(head -c 4 times.png | tail -c 3)" PNG
ok 'standard input and output give the same chart' sh -c 'chart <times.tsv | cmp - times.svg'
ok '- is standard input' sh -c 'chart - <times.tsv | cmp - times.svg'
chart -t Other -x X -y Y times.tsv >other.svg && texts other.svg >said
like 'options name title and axes' "$(tr '\n' ' ' <said)" 'Y \(s\).*X .*Other \(real\)'

tsv "$header" 'a real m 1 s 2 s 1 0' 'a simulated m 1 s 3 s 1 7' >both.tsv
chart -o both.svg both.tsv && texts both.svg >said
like 'two kinds: both in the title' "$(cat said)" '^a \(real and simulated\)$'
like 'two kinds: the legend names the kind of each line' "$(cat said)" '^m \(simulated\)$'

# The line runs through the median of three samples, not through their mean.
points() { tr -d '\n' <"$1" | grep -oE "<path stroke='rgb\( +0, 114, 178\)'  d='M[0-9.]+,[0-9.]+ L[0-9.]+,[0-9.]+ " | head -n 1; }
tsv "$header" 'a real m 2 1 2 s 1 0' 'b real n 1 1 9 s 1 0' 'a real m 1 1 4.1 s 1 0' >one.tsv
{ cat one.tsv; tsv 'a real m 1 1 9 s 2 0' 'a real m 1 1 4 s 3 0'; } >three.tsv
chart -o one.svg one.tsv
chart -o three.svg three.tsv
is 'lines run through medians' "$(points three.svg)" "$(points one.svg)"

# Methods have one look in all charts, whatever else is in them; the manual has the same table.
printf '%s\n' 'BEGIN { gsub(/;/, "\n", methods); print methods }' >print.awk
awk -f "$root/lib/chart/methods.awk" -f print.awk >looks
is 'chart(1) has the table of looks' "$(sed -n '/^\.Ss Methods/,/^\.El/s/^\.It \([a-z-]*\) Ta \(.*\) Ta \(.*\) Ta \(.*\)/\1:\2:\3:\4/p' "$root/man/chart.1")" "$(cat looks)"
is 'no two methods have the same mark' "$(cut -d : -f 3 looks | sort | uniq -d)" ''
for method in "$root"/bin/balance-*; do
	case $method in *bricks | *calibrate) ;; *) cut -d : -f 1 looks | grep -qx "${method##*/balance-}" || echo "$method" ;; esac
done >missing
is 'each method of balance has a look' "$(cat missing)" ''
# look FILE N: mark and colour of entry N of the legend
look() { sed -n "/<title>[$]m$2</,/<use/s/.*#\(gpPt[0-9]*\).*color=.\(rgb([^)]*)\).*/\1 \2/p" "$1"; }
tsv "$header" 'a real other 1 1 2 s 1 0' 'a real gdc 1 1 3 s 1 0' 'a real D_S 1 1 4 s 1 0' >first.tsv
chart -o first.svg first.tsv
tsv "$header" 'a real ds 1 1 4 s 1 0' 'a real third 1 1 3 s 1 0' 'a real gdc 1 1 3 s 1 0' | chart -o second.svg
is 'a method has its mark and colour, in any order' "$(look first.svg 2), $(look second.svg 3)" 'gpPt4 rgb(  0, 114, 178), gpPt4 rgb(  0, 114, 178)'
is 'a name of the StormView paper is that of a method' "$(look first.svg 3)" "$(look second.svg 1)"
is 'lines that are no methods take free looks: from the end of the table if the chart has methods' "$(look first.svg 1), $(look second.svg 2), $(look one.svg 1)" \
	'gpPt2 rgb(170,  51, 119), gpPt2 rgb(170,  51, 119), gpPt6 rgb(  0, 114, 178)'
{ tsv "$header"; seq 20 | awk '{ print "a real m" $1 " 1 1 2 s 1 0" }' | tr ' ' '\t'; } | chart -o many.svg
is 'the looks go round' "$(look many.svg 13)" "$(look many.svg 1 | sed 's/gpPt6/gpPt1/')"

# Ticks are where the table has values, ranges may be those of each panel, and a limit is a line.
tsv '# ranges: own' '# limit: 2.5 what is possible' "$header" 'a real m 15 1 2 s 1 0' 'a real m 20 1 2 s 1 0' 'a real m 27 1 2 s 1 0' \
	'b real m 1 1 200 s 1 0' 'b real m 90 1 201 s 1 0' >own.tsv
chart -o own.svg own.tsv && texts own.svg >said
is 'ticks: the values of x' "$(tr '\n' ' ' <said | grep -o '15 20 27\|1 90' | paste -s -d ';')" '15 20 27;1 90'
is 'own ranges: each panel has numbers of its own' "$(grep -cx '2\|200' said)" 2
is 'a limit is in the legend' "$(grep -cx 'what is possible' said)" 1
is 'a limit is a line in each panel' "$(grep -c '<title>2.5</title>' own.svg)" 2
grep -v ranges own.tsv | chart | texts /dev/stdin >said
is 'the same ranges: the numbers once' "$(grep -cx 200 said)" 1
tsv "$header" 'a real m 1 1 2 s 1 0' 'a real m 1.01 1 2 s 1 0' 'a real m 3 1 2 s 1 0' | chart -o near.svg
is 'a tick without room has no name' "$(texts near.svg | grep -cx '1\|1.01\|3')" 2
tsv '# log: y' "$header" 'a real m 1 1 1e-9 s 1 0' 'a real m 2 1 1e6 s 1 0' | chart -o wide.svg
is 'names of decades' "$(texts wide.svg | grep -x '1e-9\|1e-6\|0.001\|1000\|1e6' | paste -s -d ' ')" '1e-9 1e-6 0.001 1000 1e6'
tsv "$header" 'a real m@p 1 1 2 s 1 0' 'a real m@q 1 1 2 s 1 0' 'a real n@r 1 1 2 s 1 0' 'a real m@s 9 1 2 s 1 0' | chart -l -o join.svg
is 'points of a line on one another share a name' "$(texts join.svg | grep -cx 'p, q\|r\|s')" 3

{ echo "# note: $(seq -f 'word%g' 30 | paste -s -d ' ')"; cat first.tsv; } | chart -o noted.svg
is 'a long note has several lines' "$(texts noted.svg | grep -c '^word1 .*word1[0-9] *$\|^word[12][0-9] .*word30$')" 2

# A table with a level gets means and intervals: of 4, 4, 10 and 4 the mean is not 4.
leveled() { tsv '# level: .9' "# outliers: $1" "$header" 'a real m 1 1 4 s 1 0' 'a real m 1 1 4 s 2 0' 'a real m 1 1 10 s 3 0' \
	'a real m 1 1 4 s 4 0' 'a real m 2 1 6 s 1 0'; }
{ leveled kept; echo '# others: took .50 of 2 processors'; } >level.tsv && chart -o level.svg level.tsv && texts level.svg >said
like 'the chart shows means, with the confidence level of the table' "$(cat said)" '^means, with bands of 90 % confidence, of up to 4 samples$'
like 'the footer has the other load of the machine' "$(cat said)" '^others took .50 of 2 processors$'
leveled 'left out' >drop.tsv && chart -o drop.svg drop.tsv && texts drop.svg >said
like 'the chart says that outliers are left out' "$(cat said)" '^means, .* of up to 4 samples without outliers$'
is 'without outliers the chart differs' "$(cmp -s level.svg drop.svg; echo $?)" 1
{ sed 1d drop.tsv; tsv 'a real m 1 1 4 s 5 0'; } | tsvstat -p >said
is 'a median and range without outliers, beside the least and most of all samples' "$(awk -F '\t' '$4 == 1 { print $8, $9, $10, $13, $14 }' said)" '4 4 4 4 10'
# chart itself clips bands at the axis: the interval of 1 and 9 reaches far beyond it.
tsv '# level: .99' "$header" 'a real m 1 1 4 s 1 0' 'a real m 2 1 1 s 1 0' 'a real m 2 1 9 s 2 0' >wide.tsv
# shellcheck disable=SC2016
mkdir seen && printf '#!/bin/sh\ncp "$3" "%s/script"\n' "$tmp" >seen/gnuplot && chmod +x seen/gnuplot
sh -c 'PATH=$0:$PATH; exec chart wide.tsv' "$tmp/seen" >/dev/null 2>&1
is 'a band ends at the axis, and has a point where each edge leaves it' "$(tr '[:]' '   ' <script | awk '
	/^set xrange/ && high == "" { low = $8; high = $9 }
	/^END_OF_DATA/ { band = 0 } band { n++; out += $2 < low || $3 > high } /^\$band/ { band = 1 } END { print n, out + 0 }')" '4 0'
tsv '# level: much' "$header" 'a real m 1 1 4 s 1 0' >bad.tsv
run chart bad.tsv
like 'refused: a level that is not a number' "$status $err" '^2 tsvstat: bad.tsv:1: level is "much", expected a number'

# Numbers that are close to one another, as times of day are, and those at the limits of the format.
tsv "$header" 'a real m 1732633200 1 1e11 1 1 0' 'a real m 1732633201 1 100000000001 1 1 0' >close.tsv
ok 'points whose numbers differ by 1e-11' chart close.tsv
tsv "$header" 'a real m 1e-300 1 1e-300 1 1 0' 'a real m 1e300 1 1e300 1 1 0' >far.tsv
ok 'logarithmic axes from 1e-300 to 1e300' timeout 60 chart -L xy far.tsv

# Intervals: a lane for each slot, a look for each kind of bar, and no options of points.
bars=$(printf '%s until' "$header")
tsv '# lanes: 0 1.0 1.1' '# x: time' '# y: slot' '# note: efficiency .9' "$bars" 'log real task 0 s 0 1 1 0 1.5' \
	'log real task 1.5 s 0 1 2 0 2' 'log real wasted 0.1 s 1 1 3 0 2' 'log real task_again 0 s 1 1 4 0 .1' >bars.tsv
ok 'it draws a Gantt chart' chart -o bars.svg bars.tsv
texts bars.svg >said
is 'Gantt chart: all lanes have names, also those without bars' "$(grep -cx '0\|1\.0\|1\.1' said)" 3
like 'Gantt chart: the axes have names and units' "$(tr '\n' ' ' <said)" 'slot .*time \(s\).*log \(real\)'
tsv '# lanes: fe80::1%eth0 100% 1.1' '# x: time' "$bars" 'log real task 0 s 0 1 1 0 1.5' | chart -o percent.svg
is 'Gantt chart: a lane may have a percent sign in its name' "$(texts percent.svg | grep -cx 'fe80::1%eth0\|100%\|1\.1')" 3
is 'Gantt chart: the legend has only the kinds of bars that occur' "$(grep -c 'task given again' said)$(grep -cx 'task\|wasted\|task_again' said)" 03
like 'Gantt chart: the note is below the chart' "$(cat said)" '^efficiency \.9$'
is 'Gantt chart: wasted tasks are hatched' "$(grep -c "url(#gpPat" bars.svg)" 2 # the bar, and the legend's
ok 'it writes a Gantt chart as PNG' chart -o bars.png bars.tsv
ok 'Gantt chart: of a task that takes no time' sh -c 'chart -o none.svg' <<END
$(tsv "$bars" 'log real task 0 s 0 1 1 0 0')
END
tsv "$bars" 'log real task -4 s 0 1 1 0 -2' | chart -o before.svg
is 'Gantt chart: the axis begins with the first task, if that is before 0' "$(texts before.svg | grep -cx -- '-4\|-2')" 2

# refused LINE WHY ROW ...: chart exits 2, prints line and reason, and writes no picture
refused() {
	line=$1 why=$2
	shift 2
	tsv "$@" >bad.tsv
	rm -f bad.svg
	run chart -o bad.svg bad.tsv
	is "refused: $why" "$status $(echo "$err" | head -n 1 | grep -c "^tsvstat: bad.tsv:$line: .*$why.*expected") $(ls bad.svg 2>/dev/null)" '2 1 '
}
refused 1 'no column line' '# nothing'
refused 1 'column 3 is "methods"' 'experiment kind methods x x_unit y y_unit sample seed'
refused 1 '10 columns' "$header more"
refused 2 'until is "1"' "$bars" 'a real m 2 s 2 s 1 0 1'
refused 2 'y is 1.5' "$bars" 'a real m 2 s 1.5 s 1 0 3'
refused 2 '9 fields' "$bars" 'a real m 2 s 1 s 1 0'
run chart -p bars.tsv
like 'refused: options of points' "$status $err" '^2 chart: bars.tsv:5: intervals, expected none of -L, -l and -p'
refused 2 'no measurements' '# nothing' "$header"
refused 2 '8 fields' "$header" 'a real m 1 s 2 s 1'
refused 2 'kind is "fake"' "$header" 'a fake m 1 s 2 s 1 0'
refused 3 'x is "nan"' "$header" 'a real m 1 s 2 s 1 0' 'a real m nan s 2 s 1 0'
refused 2 'y is "2x"' "$header" 'a real m 1 s 2x s 1 0'
refused 2 'sample is "x"' "$header" 'a real m 1 s 2 s x 0'
refused 2 'seed is "-1"' "$header" 'a real m 1 s 2 s 1 -1'
refused 3 'x_unit is "ms"' "$header" 'a real m 1 s 2 s 1 0' 'a real m 1 ms 2 s 2 0'
refused 3 'the same .* as in line 2' "$header" 'a real m 1 s 2 s 1 0' 'a real m 1 s 3 s 1 0'
tsv "$header" 'a real m 0 s 2 s 1 0' >zero.tsv
run chart -L x -o bad.svg zero.tsv
like 'refused: 0 on a logarithmic axis' "$status $err" '^2 tsvstat: zero.tsv:2: x is 0, expected more than 0'
for args in 'a.tsv b.tsv' '-L z times.tsv' '-o x.gif times.tsv' '-q times.tsv' 'nosuch.tsv' '.'; do
	# shellcheck disable=SC2086
	run chart $args
	is "usage: chart $args" "$status" 2
done
run chart -q times.tsv
like 'a script names an option that it does not have' "$status $err" "^2 chart: invalid option -- 'q'"
run chart -o
like 'a script names an option that lacks its argument' "$status $err" "^2 chart: option requires an argument -- 'o'"
run balance -j 2 adaptive scene.nff
like 'balance: options before the method' "$status $err" '^2 balance: -j: expected a method before the options'
status=0
chart times.tsv >/dev/full 2>err.txt || status=$?
is 'nowhere to write: status 3' "$status" 3
# A disk that fills up half way, simulated by a cat that fails.
mkdir full half && printf '#!/bin/sh\nhead -c 100 "$@"\nexit 1\n' >full/cat && chmod +x full/cat && echo before >half/x.svg
(PATH=$tmp/full:$PATH && exec chart -o half/x.svg times.tsv) 2>err.txt
is 'a disk that fills up: status 3, and the old file stays' "$? $(cat half/*)" '3 before'

# shellcheck disable=SC2016  # for gnuplot and the shell to leave alone
tsv '# title: `touch pwned` $(touch pwned) "%d" '"'"'; system("touch pwned"); #' "$header" \
	'`touch_pwned` real '"'"';system("touch_pwned")# 1 s 2 s 1 0' 'END_OF_DATA real @m@`touch_pwned` 2 s 2 s 1 0' >evil.tsv
ok 'quotes and backquotes in the data are text' chart -lp -o evil.svg evil.tsv
ok 'quotes and backquotes in the data run no command' [ ! -e pwned -a ! -e touch_pwned ]
{
	printf '# note: \377 \355\240\200 \302\233 %s\n' "$(printf '\303\251%.0s' $(seq 200))"
	tsv "$header"
	printf 'a\treal\tm\303\t1\ts\t2\ts\t1\t0\n'
} >odd.tsv
chart -t "$(printf 'T\377')" -o odd.svg odd.tsv
is 'text that is no UTF-8, or is cut within a character, is replaced' "$(iconv -f UTF-8 -t UTF-8 odd.svg | grep -ac "$(printf '\357\277\275')")" 3
mkdir "it's"
ok 'a quote in TMPDIR, and a line end in a title' env TMPDIR="it's" chart -t "$(printf 'a\nb')" -o lines.svg times.tsv
echo before >aim.svg && ln -s aim.svg link.svg
ok 'a link stays, and the file that it leads to is replaced' sh -c 'chart -o link.svg times.tsv && [ -L link.svg ] && grep -q "<svg" aim.svg'

finish
