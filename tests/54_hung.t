#!/bin/sh
# The adaptive method and the ring with workers that hang: the picture is the same, the run ends without them, and no
# process remains. The silence limit of fan does not help here: it is two hours.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"

size=48x32
for n in 1 2 3; do spdgen -s $n balls >$n.nff; done
for n in 1 2 3; do partition $size | rtworker -a 4 $n.nff | gather -o good$n.pfm; done

# A worker that takes a free place and is bad, or, without a free place, is good. A bad one sends its hello as a good one
# does, and then behaves by $kind. The good ones wait until all places are taken.
cat >worker <<'END'
#!/bin/sh
for place in $bad; do
	mkdir "$dir/$place" 2>/dev/null || continue
	[ "$kind" = slow ] || rtworker -a 4 - </dev/null | head -n 1
	case $kind in
	beats) # reads all, and is always at work
		while echo beat; do sleep .5; done &
		exec cat >/dev/null ;;
	deaf) # the same, but reads nothing: not even the scene
		while echo beat; do sleep .5; done ;;
	trickle) # a byte of its answer at a time
		rtworker -a 4 - | tail -n +2 | while b=$(dd bs=1 count=1 2>/dev/null | od -An -to1) && [ "$b" ]; do
			printf "\\${b# }" && sleep 1
		done ;;
	stopped) kill -STOP $$ ;;
	withheld) # it computes and says so, but keeps its pixels
		exec 3<&0
		{ rtworker -a 4 - <&3 & while echo beat; do sleep .5; done; } |
			grep -a --line-buffered -E '^(frame|done|beat)( |$)' ;;
	slow) # each task takes hours
		perl -e '$| = 1; while (<STDIN>) { sleep 7200 if /^task/; print; if (/bytes=(\d+)/) { read STDIN, $b, $1; print $b } }' |
			rtworker -a 4 - ;;
	esac
	exit
done
until [ "$(ls "$dir" | wc -w)" = "$(echo $bad | wc -w)" ]; do sleep .02; done
exec rtworker -a 4 -
END
chmod +x worker
export dir="$tmp/places"
adaptive='deal -q auto -e fan -t 7200 -j'
# hung NAME KIND BAD SLOTS [FAN [NODE]]: three scenes one after the other
hung() {
	rm -rf places f?.pfm
	mkdir places
	export kind="$2" bad="$3"
	run timeout 1200 sh -c '{ for n in 1 2 3; do pack scene $n.nff; partition -F $n "$1"; done; } |
		env MARK="$2" $3 ./worker | gather -o f%d.pfm' sh "$size" "$mark" "${5:-$adaptive} $4 ${6-}"
	is "$1: complete" "$status $(echo "$err" | grep -v 'never connected$')" '0 '
	is "$1: the expected number of workers was bad" "$(find places -mindepth 1 | wc -l)" "$(echo "$3" | wc -w)"
	for n in 1 2 3; do ok "$1: picture $n" cmp f$n.pfm good$n.pfm; done
	ok "$1: no process remains" await 10 none_alive
}
for k in beats deaf trickle stopped slow withheld; do
	hung "one of three $k" $k 1 3
done
hung 'all but one of five beat' beats '1 2 3 4' 5
hung 'all but one of five stopped' stopped '1 2 3 4' 5
hung 'all but one of five do not read' deaf '1 2 3 4' 5
for k in beats deaf trickle stopped slow withheld; do
	hung "a ring, one of three $k" $k 1 3 'ringctl fan -t 7200 -j' 'ringctl -n'
done
hung 'a ring, all but one of five beat' beats '1 2 3 4' 5 'ringctl fan -t 7200 -j' 'ringctl -n'

# Many frames, whose states only the good workers read: deal neither keeps the states for the bad one nor waits for it.
{ cat 1.nff; yes '# so that the pipe is full soon' | head -n 300; } >long.nff
pack scene long.nff >long
partition 8x4 >frame
perl -e 'local $/; open S, "long"; open F, "frame"; ($s, $f) = (<S>, <F>);
	for $n (0 .. 199) { ($g = $f) =~ s/^(frame|task) 0 /$1 $n /mg; print $s, $g }' >many
{ pack scene 1.nff; cat frame; } | rtworker -a 4 - | gather -o good.pfm
rm -rf places f?.pfm
mkdir places
export kind=deaf bad=1
run timeout 1200 sh -c 'env MARK="$2" $1 3 ./worker <many | gather -o many%d.pfm' sh "$adaptive" "$mark"
is '200 frames, one of three does not read: complete' "$status $err" '0 '
is '... all are the same picture' "$(cat many*.pfm | cksum)" "$(for n in $(seq 200); do cat good.pfm; done | cksum)"
ok '... no process remains' await 10 none_alive
rm -f many*.pfm

# deal does not wait for the end of the input either: here it stays open until the picture is written.
rm -rf places f?.pfm
mkdir places
export kind=beats bad=1
run timeout 1200 sh -c '{ pack scene 1.nff; partition -F 1 "$1"; until [ -e f1.pfm ]; do sleep .05; done; } |
	env MARK="$2" deal -q auto -e fan -t 7200 -j 3 ./worker | gather -o f%d.pfm' sh "$size" "$mark"
is 'live input: the picture comes before the input ends' "$status $err" '0 '
ok 'live input: the same picture' cmp f1.pfm good1.pfm
ok 'live input: no process remains' await 10 none_alive

# deal does not wait for an idle slot that beats after the end of its input.
printf '#!/bin/sh\nrtworker -a 4 - </dev/null | head -n 1\n: >up\nwhile echo beat; do sleep .5; done\n' >beating && chmod +x beating
printf '%s\n' 'a via="sh -c %c"' 'b via="./beating %c"' >idle
rm -f f?.pfm
run timeout 1200 sh -c '{ pack scene 1.nff; partition -F 1 "$1" | sed "s/ sum=.*//; /^task/s/\$/ to=0/"; until [ -e up ]; do sleep .05; done; sleep .5; } |
	env MARK="$2" deal fan -S idle rtworker -a 4 - | gather -o f%d.pfm' sh "$size" "$mark"
is 'an idle slot that beats: complete' "$status" 0
ok 'an idle slot that beats: the same picture' cmp f1.pfm good1.pfm
ok 'an idle slot that beats: no process remains' await 10 none_alive
finish
