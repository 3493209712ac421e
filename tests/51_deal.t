#!/bin/sh
# Rules of deal that the papers do not have, live: the endgame does not wait for late slots, leaves no task behind, and
# changes no pixel; the queue depth follows the round trip; `done` has the number of the attempt.
# shellcheck disable=SC2154  # lib.sh sets them
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"

# Rows of some milliseconds.
spdgen -s 2 gears >gears.nff
{ pack scene gears.nff; partition 64x64; } >job.task
rtworker -a 64 - <job.task | gather -o good.pfm
same() { imgcmp good.pfm "$1"; }

# One slot sends hello and two rows, then nothing for hours; its fan would wait for it. Each slot has four rows in advance,
# so other slots must do two of its rows.
{ pack scene gears.nff; partition -n 3 -c 12 64x64; } >late.task
# Rows are short; these 16 tasks are long enough to be cut, also on a loaded machine.
{ pack scene gears.nff; partition -u tile:64x32 64x512; } >long.task
rtworker -a 64 - <long.task | gather -o long.pfm
cat >late <<'END'
mkdir slow 2>/dev/null || exec rtworker -a 64 -
rtworker -a 64 - | { dd bs=1 count=3000 2>/dev/null; sleep 7200; }
END
late() { # DEAL-OPTIONS
	rm -rf slow out.pfm log
	# shellcheck disable=SC2086
	env MARK=$mark timeout 1200 deal $1 fan -t 7200 -j 3 sh late <late.task | tee log | gather -o out.pfm
}
for options in -e '-e -q 4' '-e -q auto'; do
	ok "deal $options: it does not wait for late slots" late "$options"
	ok "deal $options: the same picture" same out.pfm
	ok "deal $options: no process remains after 2 s" await 2 none_alive
	ok "deal $options: the last record is bye" sh -c 'tail -n 1 log | grep -aq "bye$"'
	ok "deal $options: a task, or a piece of a task, was given again" sh -c 'grep -aq "done .* try=[23]" log'
done
# deal cuts tasks that are long against round trips, and load makes round trips long, so there are several runs.
divided() {
	for try in 1 2 3 4 5; do
		deal -e fan -j 3 rtworker -a 64 - <long.task | tee log | gather -o out.pfm && imgcmp long.pfm out.pfm || return 1
		[ "$(grep -ao 'frag 0 [0-9]* ' log | cut -d' ' -f3 | sort -n | tail -1)" -lt 16 ] || return 0
		echo "# try $try: nothing was cut"
	done
	return 1
}
ok "long tasks are cut: the same picture, pieces have numbers above those that came" divided
whole() {
	deal -e -t 86400 fan -t 600 -j 3 rtworker -a 64 - <long.task | tee log | gather -o out.pfm && imgcmp long.pfm out.pfm || return 1
	[ "$(grep -ao 'done 0 [0-9]* ' log | sort -u | wc -l)" -eq 16 ] && ! grep -aq 'done .* try=' log
}
ok "-t: no task is cut or given twice that a slot does in less" whole

# Without -e the run waits for the late slot. The others have done all the rest when the log has 62 of the 64 tasks.
rm -rf slow
: >log
env MARK=$mark deal fan -t 7200 -j 3 sh late <late.task >log &
rest_is_done() { [ "$(grep -ac '^done ' log)" -ge 62 ]; }
await 20 rest_is_done
sleep .5
is "without -e nothing is given twice" "$(grep -a 'done .* try=' log | wc -l)" 0
end_all
wait

cat >noted <<'END'
tee -a down.$$ | rtworker -a 64 -
END
sed 's/^task.*/& note=x/' long.task >noted.task
noted() {
	for _ in 1 2 3 4 5; do
		rm -f down.*
		deal -e fan -j 3 sh noted <noted.task | gather -o noted.pfm && imgcmp long.pfm noted.pfm || return 1
		grep -a "^task" down.* >given && ! grep -v "note=x" given || return 1
		[ "$(cut -d" " -f3 given | sort -n | tail -1)" -lt 16 ] || return 0
	done
	return 1
}
ok "pieces and copies keep the unknown keys of their task" noted

for command in 'deal -e rtworker -a 64 -' 'deal -q auto rtworker -a 64 -' 'deal -e -q auto fan -j 2 deal -e -q auto fan -j 2 rtworker -a 64 -' \
	'deal -e deal -e fan -j 2 rtworker -c -a 64 -'; do
	# shellcheck disable=SC2086
	ok "$command: the same picture" sh -c "$command <job.task | gather -o other.pfm && imgcmp good.pfm other.pfm"
done
ok "-e with tasks that are preassigned: the idle take from the busy" sh -c '
	{ pack scene gears.nff; partition -n 1 64x64; } | deal -e fan -j 2 rtworker -a 64 - | tee taken | gather -o other.pfm &&
	imgcmp good.pfm other.pfm && grep -aq "done 0 .* w=1 .* try=2" taken'
ok "-e with tiles, and fragments in parts" sh -c '
	{ pack scene gears.nff; partition -u tile:32x16 64x64; } | deal -e fan -j 3 rtworker -f 100 -a 64 - | gather -o other.pfm &&
	imgcmp good.pfm other.pfm'

# A worker dies: its tasks are given for the second time, with all options.
cat >mortal <<'END'
mkdir dead 2>/dev/null || exec rtworker -a 64 -
rtworker -a 64 - | dd bs=1 count=3000 2>/dev/null
END
{ pack scene gears.nff; partition -n 2 -c 8 64x64; } >mortal.task
ok "a slot is lost: its tasks are done, and say try=2" sh -c '
	deal fan -j 2 sh mortal <mortal.task | tee log | gather -o other.pfm && imgcmp good.pfm other.pfm &&
	grep -a "done 0 .* try=2" log'

for option in '-q aut' '-q auto1' '-q -1' '-q 1000001' '-t -1' '-t 86401' '-t x'; do
	# shellcheck disable=SC2086  # two words
	run deal $option true
	is "refused: $option" "$status" 2
done
finish
