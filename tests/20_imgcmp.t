#!/bin/sh
# imgcmp: its figures and exit statuses; pictures of other programs are read with the right transfer curve.
# shellcheck disable=SC1091,SC2059,SC2154
. "$(dirname "$0")/lib.sh"

# grey WIDTH HEIGHT BYTE(octal) ...: a PGM with these samples, the last one repeated
grey() {
	w=$1 h=$2
	shift 2
	printf 'P5\n%d %d\n255\n' "$w" "$h"
	i=0
	while [ $i -lt $((w * h)) ]; do
		printf "\\$1"
		[ $# -eq 1 ] || shift
		i=$((i + 1))
	done
}
# figure NAME: prints its value in the last output of imgcmp
figure() { printf '%s\n' "$out" | awk -F '\t' -v k="$1" '$1 == k { print $2 }'; }

grey 20 10 000 >black.pgm
grey 20 10 000 000 377 000 >dot.pgm
grey 10 20 000 >tall.pgm

run imgcmp black.pgm black.pgm
is 'equal pictures: status 0' "$status" 0
is 'equal pictures: the figures' "$out" "$(printf '%s\t%s\n' size 20x10 rmse 0 rmse_kept 0 dropped 0 \
	psnr_db inf worst 0 worst_at 0,0 tolerance 0.00392156863 over 0 over_percent 0.000000 differing 0)"

run imgcmp black.pgm dot.pgm
is 'a pixel differs: status 1' "$status" 1
is 'worst_at is the position of the worst pixel' "$(figure worst_at) $(figure worst)" '2,0 1'
is 'rmse of one white pixel in 200' "$(figure rmse)" 0.0707106781
is 'psnr of one white pixel in 200' "$(figure psnr_db)" 23.0103
is 'over counts the pixels over the tolerance' "$(figure over) $(figure over_percent) $(figure differing)" '1 0.500000 1'
is 'the output is eleven lines of name TAB value' "$(printf '%s\n' "$out" | grep -c '^[a-z_]*	[^	]*$')" 11

# .29 of 100 pixels is 29, though .29 as a double is a little less.
{ printf 'P5\n10 10\n255\n'; head -c 29 /dev/zero | tr '\0' '\377'; head -c 71 /dev/zero; } >some.pgm
grey 10 10 000 >none.pgm
run imgcmp -f .29 none.pgm some.pgm
is '-f and -d are not off by rounding' "$status $(figure over) $(imgcmp -d .29 none.pgm some.pgm | sed -n 's/^dropped	//p')" '0 29 29'
run imgcmp -f .28 none.pgm some.pgm
is '-f: a pixel too many' "$status" 1

run imgcmp -d 0.005 black.pgm dot.pgm
is '-d leaves the worst pixels out' "$(figure rmse_kept) $(figure dropped)" '0 1'
is '-d sets no limit' "$status" 1

ok '-f: status 0 if few enough pixels are over the tolerance' imgcmp -f 0.005 black.pgm dot.pgm
run imgcmp -f 0.0049 black.pgm dot.pgm
is '-f: status 1 if too many are' "$status" 1
run imgcmp -t 0.5 black.pgm dot.pgm
is '-t alone allows no pixel over the tolerance' "$status" 1
ok '-t 1 allows everything' imgcmp -t 1 black.pgm dot.pgm
ok '-r: the limit is for rmse without the worst pixels' imgcmp -d 0.005 -r 0 black.pgm dot.pgm
run imgcmp -d 0 -r 0.07 black.pgm dot.pgm
is '-r: status 1 over the limit' "$status" 1
run imgcmp -d 0.005 -r 0 -f 0 black.pgm dot.pgm
is '-f and -r: both limits must hold' "$status" 1

run imgcmp black.pgm tall.pgm
is 'another size: status 1' "$status" 1
like 'another size: a message says so' "$err" 'black.pgm has 20x10 pixels, tall.pgm 10x20: expected the same size'
run imgcmp -q black.pgm tall.pgm
is '-q: silent' "$status$out$err" 1
run imgcmp -q black.pgm dot.pgm
is '-q: silent on differences' "$status$out$err" 1

ok '- as A is standard input' sh -c 'imgcmp - black.pgm <black.pgm'
ok '- as B is standard input' sh -c 'imgcmp black.pgm - <black.pgm'
run imgcmp - -
is 'both from standard input: status 2' "$status" 2
run imgcmp black.pgm nosuch.png
is 'no such file: status 2' "$status" 2
like 'no such file: a message says so' "$err" 'imgcmp: nosuch.png: No such file or directory'
head -c 50 black.pgm >cut.pgm
run imgcmp cut.pgm black.pgm
is 'a damaged file: status 2' "$status" 2
like 'a damaged file: a message says so' "$err" 'cut.pgm: 37 bytes of pixels, expected 200'
for args in '' 'a' 'a b c' '-t x a b' '-t -1 a b' '-f 2 a b' '-z a b' '-r nan a b'; do
	# shellcheck disable=SC2086
	run imgcmp $args
	is "usage: imgcmp $args" "$status" 2
done
run imgcmp -h
is '-h: usage and status 0' "$status $(printf '%s' "$out" | cut -c 1-14)" '0 usage: imgcmp '
status=0
imgcmp black.pgm dot.pgm >/dev/full 2>err.txt || status=$?
is 'nowhere to write: status 3' "$status" 3
like 'nowhere to write: a message says so' "$(cat err.txt)" 'imgcmp: standard output: No space left'

# POV-Ray: its linear 16-bit PPM, linear and sRGB PNG are one picture.
cat >ball.pov <<'POV'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0,0,-3> direction <0,0,1> right x up y }
light_source { <5,5,-5> rgb 1 }
sphere { 0, 1 pigment { rgb <.5,.7,.2> } finish { ambient .2 } }
POV
pov() { pov_ray ball.pov "$@" -A -D +W48 +H48 >/dev/null 2>&1; }
if command -v povray >/dev/null; then
	pov File_Gamma=1 +FP16 +Olinear.ppm
	pov File_Gamma=1 +FN16 +Olinear.png
	pov +FN16 +Osrgb16.png
	pov +FN +Osrgb8.png
	ok "POV-Ray's linear PPM is its linear PNG" imgcmp linear.ppm linear.png
	ok "POV-Ray's 16-bit sRGB PNG, to its rounding" imgcmp -t 0.00005 linear.ppm srgb16.png
	ok "POV-Ray's 8-bit sRGB PNG, to its rounding" imgcmp -t 0.005 linear.ppm srgb8.png
else
	skip "POV-Ray's pictures" 'no povray'
fi
finish
