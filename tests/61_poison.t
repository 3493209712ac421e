#!/bin/sh
# Pieces of work that cost each worker that computes them: everything else is done, and they are named.
. "$(dirname "$0")/lib.sh"
spdgen -s 2 gears >g.nff

# A command that dies in one pixel of 200x150, and what the messages say.
cat >paint <<'END'
[ "$1" -le "$BX" ] && [ "$BX" -lt $(($1 + $3)) ] && [ "$2" -le "$BY" ] && [ "$BY" -lt $(($2 + $4)) ] && echo 'no memory here' >&2 && kill -9 $$
printf 'P5 %d %d 255\n' "$3" "$4"
head -c $(($3 * $4)) /dev/zero | tr '\0' '@'
END
for at in 10,10 110,80 199,149; do
	export BX=${at%,*} BY=${at#*,}
	rm -f log
	status=$(partition -u tile:40x30 200x150 | { deal -e fan -j 4 cropworker sh paint '{x}' '{y}' '{w}' '{h}' 2>said; echo $? >status; } | gather -r log -o a.png 2>said.gather; echo $?)
	is "a bad pixel at $at: all others are there" "$status $(cat status) $(tail -n 2 said.gather | grep -o 'frame 0.* of 30000 pixels.*missing')" "1 1 frame 0: 1 of 30000 pixels missing"
	like "a bad pixel at $at: it is named" "$(grep '^deal:' said)" "^deal: frame 0: 1x1\+$BX\+$BY: given up, .*this machine [(]failed[)], it says: frame 0, rectangle $BX,$BY 1x1: sh: ended by signal 9"
done
is 'the log says so' "$(grep -a -c '^fail 0 .* why=task said=' log)" 1
status=0
partition -r log -u tile:40x30 200x150 | { deal fan -j 2 cropworker sh paint '{x}' '{y}' '{w}' '{h}' 2>said; echo $? >status; } | gather -r log -o a.png 2>/dev/null || status=$?
is 'a rerun tries only what is missing' "$status $(cat status) $(grep -c '^deal: frame 0: 1x1+199+149: given up' said)" '1 1 1'
# In a tree the input of the inner policy stays open until the outer one has all pixels.
for tree in 'deal fan' 'ringctl fan'; do
	node=${tree%deal*} && node=${node:+ringctl -n}
	# shellcheck disable=SC2086
	partition -u tile:40x30 200x150 | { deal -e fan -j 1 $tree -j 2 $node cropworker sh paint '{x}' '{y}' '{w}' '{h}' 2>said; echo $? >status; } | gather -o a.png 2>said.gather
	is "a bad pixel in a tree of $tree: no slot is silent" "$(cat status) $(grep -c silent said) $(grep -o 'frame 0.* missing' said.gather)" "1 0 frame 0: 1 of 30000 pixels missing"
done

# Workers that die, on this machine and on another.
printf 'a slots=2 via="sh -c %%c"\nb slots=2 via="sh -c %%c"\n' >hosts
# It dies when it is given the pixel 20,20, and has done what it was given before.
cat >frail <<'END'
#!/bin/sh
while IFS= read -r line; do
	# shellcheck disable=SC2086  # its words
	set -- $line
	if [ "$1" = task ] && [ "$4" -le 20 ] && [ 20 -lt $(($4 + $6)) ] && [ "$5" -le 20 ] && [ 20 -lt $(($5 + $7)) ]; then
		echo 'no memory here' >&2
		kill -9 $$ && exit
	fi
	printf '%s\n' "$line"
done | rtworker g.nff
END
chmod +x frail
for where in '-j 3' '-S hosts'; do
	# shellcheck disable=SC2086
	partition -u tile:16x16 64x48 | { deal -q 0 fan $where ./frail 2>said; echo $? >status; } | gather -o b.png 2>/dev/null
	is "workers that die $where: one pixel is given up" "$(cat status) $(grep '^deal: .* given up' said | cut -d, -f1)" '1 deal: frame 0: 1x1+20+20: given up'
	[ "$where" = '-j 3' ] || like 'their last words are named' "$(grep '^deal: ' said)" '[ab] [(](exit-137|signal-9; killed [(]signal 9[)], as the kernel does when memory is short)[)], it says: no memory here'
	ok "workers that die $where: no slot is given up" [ "$(grep -c 'no slot left' said)" = 0 ]
done
# A worker of two slots dies with both: one half of a bad piece is tried after the other.
printf '%s\n' '#!/bin/sh' "$(sed -n '2,/^done/p' frail | sed 's/| rtworker g.nff/| rtworker "$@" g.nff/')" >wide && chmod +x wide
partition -u tile:16x16 64x48 | { deal -e -q auto fan -1 -j 2 ./wide 2>said; echo $? >status; } | gather -o b.png 2>/dev/null
is 'a worker of two slots that dies: one pixel is given up' "$(cat status) $(grep '^deal: .* given up' said | cut -d, -f1)" '1 deal: frame 0: 1x1+20+20: given up'
# While none of its workers is up, a fan sends beats itself: a fan around it, in a tree, would lose it as silent.
echo '[ ! -e once ] || { sleep 1.2; exec rtworker g.nff; }; : >once; rtworker g.nff </dev/null | head -n 1; sed /^task/q >/dev/null; exit 1' >late
partition -u tile:16x16 64x48 | deal fan -j 1 sh late 2>/dev/null | LC_ALL=C grep -ac '^beat' >beats
ok 'a fan whose workers are away sends beats' [ "$(cat beats)" -ge 2 ]
# With balance gdc each worker is behind a node, which ends as its worker did.
for where in '-j 3' '-S hosts'; do
	# shellcheck disable=SC2086
	partition -u tile:16x16 64x48 | { ringctl -e fan $where ringctl -n ./frail 2>said; echo $? >status; } | gather -o b.png 2>/dev/null
	like "gdc $where: signal 9 is named" "$(cat status) $(grep '^ringctl: .* given up' said)" \
		'^1 ringctl: frame 0: 1x1\+20\+20: given up, .* [(]signal-9; killed [(]signal 9[)], as the kernel does when memory is short[)]'
	is "gdc $where: only fan says that a node was lost" "$(grep -c 'tasks unfinished' said)" 0
done
# As an uncaught exception of Python ends: with status 1. With 2 a worker refuses its input, and is not started again.
cat >raises <<'END'
while IFS= read -r line; do
	# shellcheck disable=SC2086  # its words
	set -- $line
	[ "$1" != task ] || [ "$5" -gt 10 ] || [ $(($5 + $7)) -le 10 ] || break
	printf '%s\n' "$line"
done | rtworker g.nff
END
for code in 1 2; do
	{ cat raises; echo "exit $code"; } >"raises$code"
	partition -u tile:16x4 16x16 | { deal -q 0 fan -j 2 sh "raises$code" 2>said; echo $? >status; } | gather -o b.png 2>/dev/null
	grep -q 'starting again' said && again=again || again=''
	echo "$(cat status) $again$(grep '^deal: .* given up' said | cut -d, -f1)" >>raised
done
is 'workers that end with a status here: one row is given up; not with 2' "$(paste -sd '|' raised)" '1 againdeal: frame 0: 16x1+0+10: given up|3 '
finish
