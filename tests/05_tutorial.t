#!/bin/sh
# The tutorial, stormring-tutorial(7): all commands of the page, in one shell and one directory. Each exits with 0 and
# prints the output that the page shows, where "..." stands for any text; then the files that the step names exist. A
# step is skipped as a whole if it needs a program that is missing.
. "$(dirname "$0")/lib.sh"
# shellcheck source=examples.sh
. "$root/tests/examples.sh"
# shellcheck disable=SC2154  # lib.sh and examples.sh set them

# Writes steps/S.title and steps/S.files for step S; for its command K S/K.run, and S/K.shows if the page shows output
mkdir steps work
examples "$root/man/stormring-tutorial.7" >script
awk '
/^#step / { step = sprintf("steps/%02d", ++n); print substr($0, 7) >(step ".title"); k = 0; next }
/^#file / { print substr($0, 7) >(step ".files"); next }
/^#run$/ { if (!k) system("mkdir " step); base = step "/" ++k; next }
/^#shows / { print substr($0, 8) >(base ".shows"); next }
!/^#end$/ { print >(base ".run") }' script
titles=$(printf '%s\n' steps/*.title | wc -l)
is 'the page has 15 steps or more, each with a command' "$((titles >= 15)) $(printf '%s\n' steps/*/ | wc -l)" "1 $titles"

for step in steps/*/; do
	step=${step%/}
	cat "$step"/*.run >commands
	if lacking commands; then echo "$missing" >"$step.lacks"; continue; fi
	for run in $(ls "$step"/*.run | sort -V); do
		said=\"\$steps/${run#steps/}
		printf '. %s" >%s" 2>%s" </dev/null\necho $? >%s"\n' "$said" "${said%run}out" "${said%run}err" "${said%run}status"
	done
done >all
(cd work && steps=$tmp/steps timeout 2300 sh "$tmp/all") >said 2>&1

# plain FILE: prints it with single blanks, because tables have tabs
plain() { sed 's/[[:blank:]][[:blank:]]*/ /g; s/ $//' "$1" 2>/dev/null; }
# as_shown COMMAND: its output, or its standard error, is what the page shows; without shown output it printed nothing
as_shown() {
	[ -e "$1.shows" ] || { [ ! -s "$1.out" ]; return; }
	shown=$(plain "$1.shows" | sed 's/[][*?\\]/\\&/g; s/[.][.][.]/*/g')
	# shellcheck disable=SC2254  # a pattern
	case $(plain "$1.out") in
	$shown) return ;;
	'') case $(plain "$1.err") in *$shown*) return ;; esac ;;
	esac
	return 1
}
for step in steps/*/; do
	step=${step%/}
	title=$(cat "$step.title")
	[ ! -e "$step.lacks" ] || { skip "$title" "$(cat "$step.lacks") is not there"; continue; }
	for run in $(ls "$step"/*.run | sort -V); do
		run=${run%.run}
		status=$(cat "$run.status" 2>/dev/null) name="$title: $(head -n 1 "$run.run")"
		if [ "$status" = 0 ] && as_shown "$run"; then pass "$name"
		else fail "$name" "exit ${status:-none}, printed:
$(cat "$run.out" "$run.err" 2>&1)
expected: ${status:+0,} $(cat "$run.shows" 2>/dev/null || echo nothing)"
		fi
	done
	[ ! -e "$step.files" ] || while read -r file; do
		ok "$title: $file exists" test -s "work/$file"
	done <"$step.files"
done
[ ! -s said ] || diag "$(cat said)"
finish
