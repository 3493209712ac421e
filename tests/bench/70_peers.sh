#!/bin/sh
# 70_peers [SIDE]: the same picture of SPD's gears, SIDE x SIDE pixels (a multiple of 8; default 512 and 1536), by the
# tools that people use on one machine of two cores. Each is a script, as short as possible, which gets W workers and
# the side S. Columns: its lines; times with one worker and with two (medians of 3 interleaved runs); and the result, at
# the longer side, when one of its two workers is killed half way (kill -9): picture, differences, exit status. A line
# names each tool that is not installed.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
# The mark in the environment finds the processes that a killed run leaves.
# shellcheck source=../marked.sh
. "$root/tests/marked.sh"
rounds=3
unset MARK

# Debian's tachyon runs with whichever build of its library is there; mpirun wants the one for Open MPI.
mpi=$(ls /usr/lib/*/libtachyon-openmpi.so.0 2>/dev/null) && mkdir mpi && ln -s "$mpi" mpi/libtachyon.so.0
mpi() { [ -e mpi/libtachyon.so.0 ] && command -v tachyon && command -v mpirun; }

# peer NAME WORKER PICTURE TEST: standard input is its script. TEST fails if the peer is missing.
peers=''
peer() {
	cat >"$1.sh"
	if $4 >/dev/null 2>&1; then peers="$peers $1:$2:$3"; else echo "$1: not installed"; fi
}
installed() { for p in $needs; do command -v "$p" || return; done; }
needs=''
peer balance rtworker out.pfm true <<'END'
balance masterslave -j $W -s ${S}x$S -o out.pfm gears.nff
END
needs=parallel
peer parallel-rtworker rtworker out.pfm installed <<'END'
partition -u tile:${S}x$((S / 8)) ${S}x$S |
	parallel -j $W --pipe -N 1 --header '^frame.*\n' rtworker gears.nff | gather -o out.pfm
END
peer parallel-rtworker-retries rtworker out.pfm installed <<'END'
partition -u tile:${S}x$((S / 8)) ${S}x$S |
	parallel -j $W --pipe -N 1 --retries 3 --header '^frame.*\n' rtworker gears.nff | gather -o out.pfm
END
needs='parallel povray'
peer parallel-povray-retries povray out.ppm installed <<'END'
seq 1 $((S / 8)) $S | parallel -j $W --retries 3 povray -GA -V +Igears.pov +W$S +H$S \
	+SR{} +ER'{= $_ += '$((S / 8 - 1))' =}' +O{}.ppm +FP16 File_Gamma=1 -A -D +WT1 || exit
{ head -c -$((6 * S * S)) 1.ppm; for y in $(seq 1 $((S / 8)) $S); do
	tail -c $((6 * S * (S - y + 1))) $y.ppm | head -c $((6 * S * (S / 8))) || exit; done; } >out.ppm
END
needs=povray
peer povray-threads povray out.ppm installed <<'END'
povray -GA -V +Igears.pov +W$S +H$S +Oout.ppm +FP16 File_Gamma=1 -A -D +WT$W
END
peer tachyon-mpirun tachyon tachyon.ppm mpi <<'END'
mpirun --allow-run-as-root -x LD_LIBRARY_PATH=mpi -np $W tachyon gears.nff -res $S $S -numthreads 1 \
	-raydepth 5 -shade_phong -format PPM48 -o tachyon.ppm
END
needs=tachyon
peer tachyon-threads tachyon tachyon.ppm installed <<'END'
tachyon gears.nff -res $S $S -numthreads $W -raydepth 5 -shade_phong -format PPM48 -o tachyon.ppm
END

with() { echo "S=$side W=$1 OMPI_MCA_rmaps_base_oversubscribe=1 PARALLEL=--will-cite sh $2.sh >said 2>&1"; }
same() { # PICTURE NAME: the picture is the first one of that peer, pixel by pixel
	[ -e "$1" ] || { echo none; return; }
	if imgcmp -q "$1" "$2.first" 2>/dev/null; then echo same; else echo WRONG; fi
}
# strike PID WORKER: kills one WORKER of the run that PID has started, as soon as one runs
strike() {
	while kill -0 "$1" 2>/dev/null; do
		for p in $(program "$2"); do kill -9 "$p" 2>/dev/null && return; done
	done
	return 1
}
# killed NAME WORKER PICTURE SECONDS: " STATUS | PICTURE | SECONDS |" of a run that loses a worker after SECONDS,
# or sooner if that was too late
killed() {
	later=$4
	for _ in 1 2 3 4 5; do
		rm -f "$3"
		begin=$(date +%s.%N)
		MARK=$mark timeout 300 sh -c "$(with 2 "$1")" 2>/dev/null &
		pid=$!
		sleep "$later"
		strike $pid "$2" && hit=true || hit=false
		wait $pid 2>/dev/null
		status=$?
		$hit && break
		later=$(echo "$later" | awk '{ print $1 * 0.7 }')
	done
	$hit || status=missed
	echo "$begin $(date +%s.%N) $status $(same "$3" "$1")" | awk '{ printf " %s | %s | %.2f |", $3, $4, $2 - $1 }'
	end_all
}

measure() { # all peers at this side
	i=0
	while [ $i -lt $rounds ]; do
		for peer in $peers; do
			name=${peer%%:*} picture=${peer##*:}
			for w in 1 2; do
				rm -f "$picture"
				wall_s "$(with $w "$name")" >>"$name.$side.$w" || { tail -n 5 said >&2; stop "$name failed"; }
				[ -e "$name.first" ] || mv "$picture" "$name.first"
				[ ! -e "$picture" ] || [ "$(same "$picture" "$name")" = same ] ||
					echo "$name: two runs, two pictures"
			done
		done
		i=$((i + 1))
	done
}

# timed NAME: "| NAME | LINES | ONE | TWO |"
timed() {
	two=$(median 1 <"$1.$side.2")
	echo "$1 $(wc -l <"$1.sh") $(median 1 <"$1.$side.1") $two" |
		awk '{ printf "| %s | %d | %.2f | %.2f |", $1, $2, $3, $4 }'
}
table() { # the last side has the columns of the kill: its runs are long enough to be killed half way
	echo
	echo "gears, ${side}x$side, medians of $rounds runs on $("$root/tests/processors") cores:"
	echo
	kills='' rule=''
	[ "$side" != "$last" ] || kills=' one of two killed: exit | picture | s |' rule=' --- | --- | ---: |'
	echo "| by | lines | one worker s | two workers s |$kills"
	echo "| --- | ---: | ---: | ---: |$rule"
	for peer in $peers; do
		name=${peer%%:*} worker=${peer#*:} picture=${peer##*:}
		timed "$name"
		[ -z "$kills" ] || killed "$name" "${worker%%:*}" "$picture" "$(awk -v t="$two" 'BEGIN { print t / 2 }')"
		echo
	done
}

spdgen gears >gears.nff || stop 'spdgen failed'
nff2pov -x 100 gears.nff >gears.pov || stop 'nff2pov failed'
sides=${1:-512 1536}
last=${sides##* }
for side in $sides; do
	rm -f ./*.first
	measure
	table
	echo
	partition "${side}x$side" | rtworker gears.nff | gather -k 16 -o linear.png
	for peer in $peers; do
		name=${peer%%:*}
		case $name in
		balance | parallel-rtworker*)
			imgcmp -q balance.first "$name.first" || stop "$name: another picture than balance's" ;;
		*) imgcmp -t 0.004 linear.png "$name.first" | awk -v name="$name" -F '\t' '
			{ v[$1] = $2 } END { printf "%s: %.3f %% of the pixels are off ours by more than 1/255\n", name, v["over_percent"] }' ;;
		esac
	done
done
echo
for peer in $peers; do
	echo "${peer%%:*}:"
	sed 's/^/    /' "${peer%%:*}.sh"
done
