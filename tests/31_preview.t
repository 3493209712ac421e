#!/bin/sh
# gather -w: previews of pictures that are not complete; when they come and go, and what is in them.
# shellcheck disable=SC1091
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"

spdgen -s 2 tetra >tetra.nff
partition 32x32 | rtworker tetra.nff >all.frags
gather -o want.png all.frags
{ grep -a -m1 '^hello' all.frags; partition 32x32 | head -n 17 | rtworker tetra.nff; } | grep -av '^bye' >half.frags
is 'half of the rows are there' "$(gather -m half.frags | grep -c '^task')" 16

# ---- while a run goes on: the stream is a pipe that this test holds open
mkfifo pipe
gather -w .1 -k 8 -o a.png <pipe 2>err &
pid=$!
exec 3>pipe
cat half.frags >&3
ok 'a preview comes while the input stalls' await 1 test -e a.partial.png
ok 'the picture has not its name before it is whole' test ! -e a.png
# The rows that came are those of the picture; the others are transparent.
backdrop_is() { # FILE: blends the preview over the picture, and the picture over the preview
	blend -o over.png want.png "$1" && imgcmp -q over.png want.png
}
ok 'rows that came are those of the picture' backdrop_is a.partial.png
# alpha FILE.pam: prints how many rows of 32 pixels are transparent, and how many are opaque; RGBA in 8 bits
alpha() {
	tail -c $((32 * 32 * 4)) "$1" | od -An -v -tu1 -w128 |
		awk '{ o = t = 0; for (i = 4; i <= NF; i += 4) { o += $i == 255; t += $i == 0 } opaque += o == 32; clear += t == 32 } END { print clear + 0, opaque + 0 }'
}
ln a.partial.png first.png
cp a.partial.png copy.png
cat all.frags >&3
exec 3>&-
ok 'the picture is whole: status 0' wait $pid
is 'the picture is whole: silent' "$(cat err)" ''
ok 'the picture is the same as without previews' cmp a.png want.png
ok 'the preview is gone' test ! -e a.partial.png
ok 'a preview is never written in place' cmp first.png copy.png
is 'no temporary file remains' "$(echo a.*)" a.png

# ---- when pixels are missing at the end
run gather -w 60 -o b.pam half.frags
is 'missing pixels: status 1' "$status" 1
like 'missing pixels: they are listed' "$err" 'frame 0: 512 of 1024 pixels missing: rows 16-31'
is 'missing pixels: the preview remains, with every pixel that came' "$(echo b.*) $(alpha b.partial.pam)" 'b.partial.pam 16 16'
run gather -w 60 -o b.pfm half.frags
# Its bottom row comes first.
is 'PFM: missing pixels are black' "$(tail -c $((32 * 32 * 12)) b.partial.pfm | head -c $((16 * 32 * 12)) | tr -d '\0' | wc -c)" 0
is 'PFM: the others are not' "$(tail -c $((16 * 32 * 12)) b.partial.pfm | tr -d '\0' | head -c 1 | wc -c)" 1
run gather -w 60 -o b.pam all.frags
is 'the next run removes the preview of the last one' "$status$err$(echo b.p*)" '0b.pam b.partial.pfm'

# ---- several pictures
{ cat half.frags; sed 's/^\([a-z]*\) 0 /\1 7 /; s/ sum=[0-9a-f]*$//' half.frags | "$root/tests/seal"; } >two.frags
run gather -w 60 -o 'n%02d.pam' two.frags
is 'each incomplete picture has its preview' "$(echo n*)" 'n00.partial.pam n07.partial.pam'

# ---- a run that is ended
MARK=$mark gather -w .1 -o c.png -r c.frags <pipe 2>err &
pid=$!
exec 3>pipe
cat half.frags >&3
await 1 test -e c.partial.png
kill -TERM $pid
wait $pid 2>/dev/null
exec 3>&-
is 'ended by a signal: the preview remains, nothing else' "$(echo c.*)" 'c.frags c.partial.png'
partition -r c.frags 32x32 | rtworker tetra.nff | gather -w 60 -r c.frags -o c.png
is 'resumed: the picture is whole, the preview gone' "$(cmp c.png want.png)$(echo c.*)" 'c.frags c.png'

# ---- refused
for args in '-w 1' '-w 1 -m' '-w 0 -o x.png' '-w -1 -o x.png' '-w nan -o x.png' '-w 1e9 -o x.png' '-w x -o x.png'; do
	# shellcheck disable=SC2086
	run gather $args half.frags
	is "usage: gather $args" "$status$(echo x*)" '2x*'
done
run gather -w 60 -o d.png -r d.partial.png <half.frags
is 'the preview would replace the log: status 2' "$status" 2
mkdir e.partial.png
run gather -w 60 -o e.png half.frags
is 'a preview that cannot be written: status 3' "$status" 3
like 'a preview that cannot be written: a message says so' "$err" '^gather: e[.]partial[.]png: Is a directory$'
run gather -w 60 -o e.png all.frags
is 'a complete picture needs no preview' "$status" 0
run balance adaptive -j 1 -w 60 tetra.nff
is 'balance -w without -o: status 2' "$status" 2
ok 'balance passes -w on' balance adaptive -j 1 -s 32x32 -w 60 -o f.png tetra.nff
ok 'balance -w: the same picture' cmp f.png want.png
finish
