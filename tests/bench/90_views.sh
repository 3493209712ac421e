#!/bin/sh
# 90_views: computes the views of spdgen -V imbalanced, which lib/spd has. In balls, gears and tetra of size 2, 512x512,
# the camera turns about its place, up or down, by whole degrees, until the costs of rows vary twice as much as in SPD's
# own view, or, if no view does, until they vary most; of several such views the smallest turn. Cost is CPU time of
# rtworker, for each row the least of several runs; variation is standard deviation / mean. Takes some minutes.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
runs=${RUNS:-9} factor=2 most=40

partition 512x512 >rows.task || stop 'partition failed'
# variation SCENE: prints the variation of the costs of its rows
variation() {
	i=0
	while [ $((i += 1)) -le "$runs" ]; do
		$pin rtworker "$1" <rows.task | grep -ao 'done 0 [0-9]* cpu_us=[0-9]*' || stop "no rows of $1"
	done | awk '{ split($4, cost, "="); if (!($3 in least) || cost[2] < least[$3]) least[$3] = cost[2] }
		END { for (row in least) { n++; sum += least[row] }
			for (row in least) squares += (least[row] - sum / n) ^ 2
			printf "%.3f\n", sqrt(squares / n) / (sum / n) }'
}
# turned DEGREES <SCENE: prints the scene with the camera turned up by DEGREES
turned() {
	awk -v degrees="$1" '
	$1 == "from" { for (i = 1; i <= 3; i++) from[i] = $(i + 1) }
	$1 == "at" && !seen++ { for (i = 1; i <= 3; i++) ahead[i] = $(i + 1) - from[i]; next }
	$1 == "up" {
		for (i = 1; i <= 3; i++) { length2 += ahead[i] ^ 2; dot += ahead[i] * $(i + 1) }
		for (i = 1; i <= 3; i++) { up[i] = $(i + 1) - dot / length2 * ahead[i]; up2 += up[i] ^ 2 }
		turn = degrees * atan2(0, -1) / 180; printf "at"
		for (i = 1; i <= 3; i++) printf " %.9g", from[i] + cos(turn) * ahead[i] + sin(turn) * up[i] * sqrt(length2 / up2)
		print ""
	}
	{ print }'
}
# reaches A FACTOR B: A >= FACTOR B
reaches() { awk -v a="$1" -v factor="$2" -v b="$3" 'BEGIN { exit !(a >= factor * b) }'; }

echo 'scene  view       turned  variation of row cost'
for scene in balls gears tetra; do
	spdgen -s 2 $scene >$scene.nff || stop 'spdgen failed'
	own=$(variation $scene.nff)
	printf '%-6s balanced   %6d  %.2f\n' $scene 0 "$own"
	degrees=0 best=$own at=0
	while ! reaches "$best" $factor "$own" && [ $((degrees += 1)) -le $most ]; do
		for way in '' -; do
			turned $way$degrees <$scene.nff >turned.nff
			got=$(variation turned.nff)
			! reaches "$best" 1 "$got" || continue
			best=$got at=$way$degrees
		done
	done
	printf '%-6s imbalanced %6d  %.2f\n' $scene $at "$best"
done
