#!/bin/sh
# Limits of the system, one clear line each: a file that must not grow (SIGXFSZ), few open files, no directory for
# temporary files; and an option in the place of an argument.
. "$(dirname "$0")/lib.sh"
# shellcheck disable=SC2154,SC3045  # lib.sh sets them; dash and bash both know ulimit -n

spdgen -s 2 gears >gears.nff
partition 64x64 >plain.task
{ pack scene gears.nff; cat plain.task; } >job.task
rtworker gears.nff <plain.task >gears.frags
view=$root/scenes/stormview.spec

# Files of 512 bytes: messages are shorter.
while IFS='|' read -r command line; do
	run sh -c "ulimit -f 1; $command"
	is "$command: exit 3, and a line" "$status:$err" "3:$line"
	rm -f big*
done <<END
spdgen gears >big|spdgen: standard output: File too large
pack scene gears.nff >big|pack: standard output: File too large
partition 64x64 >big|partition: standard output: File too large
rtworker gears.nff <plain.task >big|rtworker: standard output: File too large
fan -j 2 rtworker - <job.task >big|fan: standard output: File too large
deal fan -j 2 rtworker - <job.task >big|deal: standard output: File too large
gather -o big.png <gears.frags|gather: big.png: File too large
gather -r big.log <gears.frags >/dev/null|gather: big.log: File too large
gather <gears.frags >big|gather: standard output: File too large
gather -m gears.frags >big; nff2pov gears.nff >big|nff2pov: standard output: File too large
balance interleaved -j 2 -o big.png gears.nff|gather: big.png: File too large
balance calibrate -n 1 -s 16x16 gears.nff|pack: standard output: File too large
END
run prlimit --fsize=20 gather -r cut.log -o cut.png gears.frags
is 'a log whose first write failed is empty, not a part of a line' "$status:$(wc -c <cut.log)" 3:0
ok 'so the same command goes on' gather -r cut.log -o cut.png gears.frags
run sh -c "ulimit -f 1; views -n 9 -o big-%d.spec '$view' '$view'"
like 'views: exit 3, and why' "$status:$err" '^3:.*File too large'
run sh -c 'ulimit -f 1; balance interleaved -j 1 -o big.png - <gears.nff'
like 'balance, a scene from a pipe: exit 3, and why' "$status:$err" '^3:.*File too large'

# A stack of 64 KiB, less than a run's estimate of the time left takes.
while IFS='|' read -r command; do
	run sh -c "ulimit -s 64; $command"
	is "a small stack, $command: exit 0" "$status:$err" 0:
done <<END
rtworker gears.nff <plain.task
fan -j 2 rtworker - <job.task
deal -q auto -e fan -j 2 rtworker -c - <job.task
ringctl fan -j 2 ringctl -n rtworker - <job.task
gather -r small.log -o small.png gears.frags
fragstat -f gears.frags
fragstat -H gears.frags
verify -j 2 1 gears.frags </dev/null
replay gears.frags <plain.task
simulate -j 3 -m 100 ring <plain.task
partition -r gears.frags 64x64
END

# few N PROGRAM: runs it with a limit of N open files. It inherits only the standard three.
few() { run perl -MPOSIX -e 'POSIX::close($_) for 3 .. 1023; exec @ARGV' sh -c "ulimit -n $1; exec $2"; }
for program in 'balance interleaved -j 1 -o o.png gears.nff' 'balance calibrate gears.nff' 'protocol -l' 'chart gears.tsv' coastlines; do
	for n in 12 20; do
		few $n "$program"
		like "$n open files, $program: exit 3, and a line" "$status:$err" \
			'^3:[a-z]+(-calibrate)?: expected a limit of 30 open files or more \(ulimit -n\)$'
	done
done
# Six slots and files for two or three children: the tasks of the others are done too, under their slots' numbers. The
# input stays open until all tasks are done, so waiting for its end would take forever.
cat >poor <<'END'
#!/bin/sh
ulimit -n $FILES
exec perl -MPOSIX -e 'POSIX::close($_) for 3 .. 1023; exec @ARGV' rtworker "$@"
END
chmod +x poor
gather -o good.pfm <gears.frags
for chain in 'fan -1 -j 6 ./poor -' 'deal fan -1 -j 6 ./poor -' 'deal -q 2 -e fan -1 -j 6 ./poor -c -' 'deal -q auto -e fan -1 -j 6 ./poor -c -f 9 -'; do
	for cut in 'scatter -n 6' row; do
		# shellcheck disable=SC2086
		{ pack scene gears.nff; partition -u $cut 64x64; } >poor.task
		FILES=13 run sh -c "timeout 1200 $chain <poor.task >poor.frags"
		like "13 open files, -u $cut | $chain: exit 0, and a line" "$status:$err" '^0:.*slot [1-5]: Too many open files; other slots take its tasks$'
		gather -o poor.pfm <poor.frags
		ok "13 open files, -u $cut | $chain: the same picture" cmp poor.pfm good.pfm
		case $cut,$chain in *-e*) ;; scatter*)
			is "13 open files, -u $cut | $chain: a task under each slot" \
				"$(grep -ao '^done .* w=[0-9]' poor.frags | sed 's/.*w=//' | sort -u | tr -d '\n')" 012345 ;;
		esac
	done
done
FILES=8 run sh -c "timeout 1200 fan -1 -j 6 ./poor - <poor.task >poor.frags"
like '8 open files: no slot, exit 1, and a line' "$status:$err" '^1:rtworker: fork: Too many open files'
echo x >gears.tsv
for program in 'balance interleaved -j 1 -o o.png gears.nff' 'balance calibrate gears.nff' 'protocol master' 'chart gears.tsv' "'$root/tests/demo'"; do
	run env TMPDIR="$tmp/none" sh -c "$program"
	like "no TMPDIR, $program: exit 3, and a line" "$status:$err" \
		"^3:[a-z]+(-calibrate)?: $tmp/none: cannot make a directory there, expected TMPDIR to name a writable directory(, no line end in its name)?$"
done
run env PATH="$tmp/none" /bin/sh "$BIN/balance" adaptive gears.nff
is 'a PATH without tools: exit 2, and a line' "$status:$err" '2:balance: dirname is not there, expected it and other tools of the system on the PATH'
mkdir "$(printf 'a\nb')"
run env TMPDIR="$(printf 'a\nb')" balance adaptive -v 1 -S :,: -s 8x8 -o o.png gears.nff
like 'a line end in TMPDIR, whose hosts file would be lines: exit 3, and a line' "$status:$err" '^3:balance: a[?]b: cannot make'
mkdir ./-t
run env TMPDIR=-t balance interleaved -j 1 -s 8x8 -o o.png gears.nff
is 'a relative TMPDIR that begins with -: exit 0, and nothing remains' "$status:$err:$(ls ./-t)" 0::
for program in 'balance interleaved -j 1' 'balance calibrate'; do
	run sh -c "$program -s -h gears.nff"
	like "$program -s -h: exit 2, and a line" "$status:$err" '^2:[a-z-]+: -s -h: expected WxH'
done
finish
