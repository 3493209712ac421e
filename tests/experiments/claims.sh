# shellcheck shell=sh disable=SC2034,SC2154  # protocol sets table, level, drop and work
# Functions for judging the papers' claims by the samples of a table. protocol reads this file.

# rows [CONDITION]: selects the rows for the next tests by a condition of awk, in which the fields have names
rows() {
	where=${1:+where $1: }
	awk -F '\t' '/^#/ || !headed++ { print; next }
		{ experiment = $1; method = $3; x = $4; y = $6; sample = $8 }
		'"${1-1} { print }" "$table" >"$work/rows" || exit 3
}
# reworked PROGRAM [NAME=VALUE ...]: replaces these rows by the output of an awk program, which gets the values
reworked() {
	program=$1
	shift
	for value; do
		shift
		set -- "$@" -v "$value"
	done
	awk -F '\t' -v OFS='\t' "$@" '/^#/ || !headed++ { print; next } '"$program" "$work/rows" >"$work/reworked" &&
		mv "$work/reworked" "$work/rows" || exit 3
}
# turned [x]: swaps experiments and methods, so that experiments are compared; with x: makes every x a method
turned() {
	if [ "${1-}" = x ]; then reworked '{ $1 = $1 ", " $3; $3 = $4; $4 = 0; print }'; else reworked '{ t = $1; $1 = $3; $3 = t; print }'; fi
}
# also METHOD VALUE: adds to each row one of another method, with this y
also() { reworked '{ print; $3 = method; $6 = y; if (!seen[$1 FS $4 FS $8]++) print }' "method=$1" "y=$2"; }
# part METHOD P NAME: adds to each row of METHOD one of method NAME, with P times its y
part() { reworked '{ print } $3 == method { $3 = name; $6 *= p; print }' "method=$1" "p=$2" "name=$3"; }
# rivals METHODS OTHERS VALUE WORDS: compares each point of METHODS with its cheapest rival. METHODS and OTHERS are patterns
# of awk. The rival is the point of OTHERS that is at least as exact (within 1 %) and has the smallest mean x, which is
# measured. y becomes the rival's x divided by the point's own, sample by sample, because other load slows both. If no
# point is as exact, y is 1e9. Beside each row there is one of method WORDS with VALUE.
rivals() {
	reworked '{
			key = $1 FS $3
			if (!n[key]++) order[++points] = key
			scene[key] = $1; method[key] = $3; error[key] = $6; x[key, $8] = $4; sum[key] += $4
			line[$8] = $0; most = $8 > most ? $8 : most
		}
		END {
			for (i = 1; i <= points; i++) {
				p = order[i]; best = ""
				if (method[p] !~ methods) continue
				for (j = 1; j <= points; j++) {
					q = order[j]
					if (q == p || scene[q] != scene[p] || method[q] !~ others) continue
					if (error[q] > 1.01 * error[p]) continue
					if (best == "" || sum[q] / n[q] < sum[best] / n[best]) best = q
				}
				for (s = 1; s <= most; s++) if ((p, s) in x && (best == "" || (best, s) in x)) {
					$0 = line[s]; $1 = scene[p] ": " method[p]; $3 = "cheapest as exact"; $4 = 0
					$6 = best == "" ? 1e9 : x[best, s] / x[p, s]
					print
				}
			}
		}' "methods=$1" "others=$2"
	also "$4" "$3"
}
# claim WORDS REASON: begins a claim of a paper; REASON says why the claim fails here, if it does
claim() { words=$1 reason=$2 cells=0 hold=0 against=0 tests='' told=''; }
# put RELATION A B: tests the claim by "A RELATION B" in every cell that has both
put() {
	tests="$tests${tests:+; }$([ "$where" = "$told" ] || echo "$where")$2 $1 $3" told=$where
	[ "$level" = .999 ] || tests="$tests at $level"
	awk '!/^#/ && headed++ { exit 1 }' "$work/rows" && return # an incomplete table may have no such rows
	# shellcheck disable=SC2086
	tsvstat $drop -c "$level" -t "$1" "$2" "$3" "$work/rows" >"$work/tests"
	[ $? -le 1 ] || fail 3 'tsvstat failed'
	counts=$(awk -F '\t' 'FNR > 1 { n++; yes += $NF == "holds"; no += $NF == "fails" } END { print n + 0, yes + 0, no + 0 }' "$work/tests")
	cells=$((cells + ${counts%% *})) hold=$((hold + $(echo "$counts" | cut -d' ' -f2))) against=$((against + ${counts##* }))
}
# verdict: ends the claim and prints its line
verdict() {
	word='not decided'
	[ "$hold" -eq 0 ] || word='found in part'
	[ "$cells" -eq 0 ] || [ "$hold" -lt "$cells" ] || word=found
	[ "$against" -le "$hold" ] || word='not found'
	if [ "$cells" -eq 0 ]; then reason='the table has no samples of it'
	elif [ "$against" -eq 0 ]; then : "${reason:=these samples do not decide it$disturbed}"
	else : "${reason:=the contrary holds, for an unknown reason}"
	fi
	[ "$word" != found ] || reason=-
	printf '%s\t%s\t%d\t%d\t%d\t%s\t%s\n' "$words" "$tests" "$cells" "$hold" "$against" "$word" "$reason"
}
# lasting STATISTIC PROGRAM: prints a line for each method and stress (an experiment): the last x up to which the method
# holds. PROGRAM, lines of awk, sets good; it has the names stress, x, and y, the mean.
lasting() {
	tsvstat -c "$level" "$table" | awk -F '\t' -v OFS='\t' -v statistic="$1" 'NR > 1 {
		stress = $1; x = $4; y = $7; key = stress OFS $3; good = 0
		'"$2"'
		if (!(key in n)) order[++keys] = key
		n[key]++
		if (x >= 1e5) { x = sprintf("%.0e", x); sub(/e\+0?/, "e", x) }
		if (!(key in broken) && good) { held[key]++; last[key] = x } else broken[key]
	}
	END {
		for (i = 1; i <= keys; i++) {
			split(order[i], of, OFS)
			print "not claimed: how long " of[2] " holds when " of[1], statistic, n[order[i]], held[order[i]] + 0,
				n[order[i]] - held[order[i]], (held[order[i]] ? "holds until X = " last[order[i]] : "does not hold"),
				(order[i] in broken ? "-" : "no more was tried")
		}
	}'
}
