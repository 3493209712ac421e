#!/bin/sh
# album: names become views and times; what is refused; the page in Chromium at two widths, by its sliders, keys and buttons.
# shellcheck disable=SC1091,SC2016
. "$(dirname "$0")/lib.sh"

# picture FILE GREY [WIDTH]: a PNG of one grey, 0 to 255
picture() {
	width=${3:-40}
	{
		printf 'P5\n%d 30\n255\n' "$width"
		head -c $((width * 30)) /dev/zero | tr '\0' "\\$(printf %03o "$2")"
	} >grey.pgm
	blend -o "$1" grey.pgm grey.pgm
}
# cells FILE: the view, the time and the file of each picture of a page, in order
cells() { sed -n 's/^<script type="image.png" data-file="\([^"]*\)" data-view="\([^"]*\)" data-time="\([^"]*\)".*/\2 \3 \1/p' "$1"; }

# ---- views and times -----------------------------------------------------------------------------------------------
mkdir a b
for i in 9 10; do picture a/east-$i.png $i; picture a/top-$i.png $((i + 10)); done
run album a/top-10.png a/east-10.png a/top-9.png a/east-9.png
is 'the page is written' "$status$err" 0
printf '%s\n' "$out" >named.html
is 'names: views, and times in natural order' "$(cells named.html)" 'east 9 a/east-9.png
east 10 a/east-10.png
top 9 a/top-9.png
top 10 a/top-10.png'
mkdir a/east a/top
cp a/east-9.png a/east/1.png; cp a/top-9.png a/top/1.png; cp a/east-10.png a/east/2.png; cp a/top-10.png a/top/2.png
album a/*/?.png >directories.html
is 'directories are views' "$(cells directories.html | cut -d ' ' -f 1,2 | tr '\n' ,)" 'east 1,east 2,top 1,top 2,'
cp a/east-9.png b/t1-low.png; cp a/top-9.png b/t2-low.png
album b/*.png >between.html
is 'a time between two words' "$(cells between.html | tr '\n' ,)" 't-low 1 b/t1-low.png,t-low 2 b/t2-low.png,'
cp a/east-9.png b/east.png; cp a/top-9.png b/top.png
album b/east.png b/top.png >none.html
is 'names without numbers are views' "$(cells none.html | tr '\n' ,)" 'east  b/east.png,top  b/top.png,'
is 'there is no slider with one position' "$(grep -c 'id="time"' none.html) $(grep -c 'id="view"' none.html)" '0 1'
for i in 0 1 2 3 4 5; do picture s$i.png $((40 * i)); done
album -v low,high s?.png >turn.html
is '-v NAMES: all views of a time, then those of the next' "$(cells turn.html | tr '\n' ,)" \
	'low 0 s0.png,low 1 s2.png,low 2 s4.png,high 0 s1.png,high 1 s3.png,high 2 s5.png,'
album -v 3 s?.png >turn.html
is '-v NUMBER' "$(cells turn.html | cut -d ' ' -f 1,2 | tr '\n' ,)" '0 0,0 1,1 0,1 1,2 0,2 1,'
album -v 1 a/top-10.png a/top-9.png s0.png >series.html
is '-v 1: a series of any names' "$(cells series.html | tr '\n' ,)" '0 0 a/top-9.png,0 1 a/top-10.png,0 2 s0.png,'
for hour in 9 10; do printf '# vtk DataFile Version 3.0\nT [K]; t validity 20261123%02d00 [YYYYMMDDhhmm]\nASCII
DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\nX_COORDINATES 2 float\n0 1\nY_COORDINATES 2 float\n0 1
Z_COORDINATES 2 float\n0 1\nPOINT_DATA 8\nSCALARS s float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n' $hour >g$hour.vtk; done
album g10.vtk a/*.png g9.vtk >dates.html
is 'with grids, times are their dates' "$(cells dates.html | tr '\n' ,)" 'east 2026-11-23 09:00 UTC a/east-9.png,east 2026-11-23 10:00 UTC a/east-10.png,top 2026-11-23 09:00 UTC a/top-9.png,top 2026-11-23 10:00 UTC a/top-10.png,'
n=1
for file in a/east-9.png a/east-10.png a/top-9.png a/top-10.png; do
	if [ $n = 1 ]; then sed -n 's/.*src="data:image.png;base64,\([^"]*\)".*/\1/p' named.html
	else grep '^<script type="image' named.html | sed -n "${n}s/.*>\(.*\)<.script>/\1/p"
	fi | base64 -d >back.png
	ok "the page holds $file" cmp back.png $file
	n=$((n + 1))
done

# ---- what is not trusted -------------------------------------------------------------------------------------------
name='"><script>alert(1)
&'
cp s0.png "$name"
album -v 1 -t '</title><script>alert(2)</script>' "./$name" s1.png >names.html
is 'names are escaped' "$(grep -c '<script>alert' names.html) $(grep -c 'data-file="./&quot;&gt;&lt;script&gt;alert(1)$' names.html)" '0 1'
is 'a title is escaped' "$(grep -c '<title>&lt;/title&gt;&lt;script&gt;alert(2)' names.html)" 1
is 'a page needs no other file' "$(grep -oE '(src|href|url)[=(]"?[^"]{0,22}' named.html)" 'src="data:image/png;base64,'
rm "$name"
# refused NAME ERE ARGUMENT ...
refused() { name=$1 ere=$2; shift 2; run album "$@"; like "$name" "$status $out$err" "^2 album: $ere"; }
head -c 60 s0.png >short.png
{ head -c 50 s0.png; printf x; tail -c +52 s0.png; } >flipped.png
{ head -c 16 s0.png; printf '\0\0\0\0'; tail -c +21 s0.png; } >nowidth.png
perl -MCompress::Zlib -e '
	undef $/; my $png = <STDIN>;
	substr($png, 16, 4) = pack "N", 0; substr($png, 29, 4) = pack "N", crc32(substr $png, 12, 17); print $png' <s0.png >zero.png
{ cat s0.png; echo more; } >trailing.png
echo hello >text.png
: >empty.png
picture wide.png 9 50
refused 'no PNG' 'text.png: not a PNG, expected one' text.png
refused 'an empty file' 'empty.png: not a PNG, expected one' empty.png
refused 'a picture of another format' 'grey.pgm: not a PNG, expected one' grey.pgm
refused 'a cut file' 'short.png: damaged PNG: it ends within a chunk, expected' short.png
refused 'a flipped byte' 'flipped.png: damaged PNG: the sum of a chunk is wrong, expected' flipped.png
refused 'a header with another sum' 'nowidth.png: damaged PNG: the sum' nowidth.png
refused 'a width of 0' 'zero.png: damaged PNG: .*, expected' zero.png
refused 'a directory' 'a: .*irectory' a
refused 'no file' 'none.png: No such file' none.png
refused 'a device without an end' '/dev/zero: more than 1073741824 bytes, expected' /dev/zero
refused 'another size' 'wide.png has 50x30 pixels, expected 40x30 as s0.png' -v 1 s0.png wide.png
refused 'a missing picture' 'no picture of view "top" at time "10", expected each of 2 views at each of 2 times, or -v' \
	a/east-9.png a/east-10.png a/top-9.png
refused 'a missing first picture' 'no picture of view "east" at time "9", expected' a/east-10.png a/top-9.png a/top-10.png
refused 'a picture that comes twice' 'a/top-9.png and a/top-9.png: both show view "top" at time "9", expected one' \
	a/top-9.png a/top-10.png a/top-9.png a/east-10.png
refused 'a grid for one of two times' '1 grids and 2 times, expected a grid for each time' g9.vtk a/*.png
sed '2s/;.*//' g9.vtk >timeless.vtk
refused 'a grid without time' 'timeless.vtk: its title has no time, expected one' g10.vtk timeless.vtk a/*.png
refused 'a remainder' '-v 4: 6 pictures, expected each of 4 views at each time' -v 4 s?.png
for n in 0 7 12; do refused "$n views of 6 pictures" "-v $n: 6 pictures, expected each of $n views" -v $n s?.png; done
refused 'more names than pictures' '-v a,b: 1 pictures, expected each of 2' -v a,b s0.png
run album
is 'no pictures: usage' "$status$out" 2
album trailing.png >whole.html
sed -n 's/.*src="data:image.png;base64,\([^"]*\)".*/\1/p' whole.html | base64 -d >back.png
ok 'bytes after the end of a PNG are left out' cmp back.png s0.png
album s0.png >/dev/full 2>err
is 'a full disk: status 3' $? 3

# ---- the page in a browser -----------------------------------------------------------------------------------------
if there openssl; then
	is 'the policy of the page has the hash of its script' "$(awk '
		/^<script>$/ { on = 1; printf "\n"; next } on && /^<.script>$/ { exit } on' named.html | openssl dgst -sha256 -binary | base64)" \
		"$(sed -n "s/.*script-src 'sha256-\([^']*\)'.*/\1/p" named.html)"
else skip 'the hash of the script' 'openssl is not there'
fi
if there chromium; then
	# browse WIDTH FILE: prints the page as the browser has built it
	browse() {
		timeout 300 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$tmp/chromium" --window-size="$1",900 \
			--virtual-time-budget=60000 --dump-dom "file://$tmp/$2" 2>/dev/null
	}
	# drive PAGE WIDTH STEPS: its title becomes what STEPS, a script, pushes to `said`. `set` moves a slider, `seen` returns
	# the grey of the picture.
	drive() {
		{
			sed '/Content-Security-Policy/d; /<\/body>/,$d' "$1"
			cat <<-'END'
				<script>
				const said = [];
				const wait = ms => new Promise(go => setTimeout(go, ms));
				// Messages take none of the virtual time, which runs while the browser waits for a timer only.
				const turn = () => new Promise(go => {
				  const channel = new MessageChannel();
				  channel.port1.onmessage = go;
				  channel.port2.postMessage(0);
				});
				const rest = async () => { do await turn(); while (busy); };
				const seen = () => {
				  const context = document.createElement('canvas').getContext('2d');
				  context.drawImage(document.images[0], 0, 0);
				  return context.getImageData(5, 5, 1, 1).data[0];
				};
				const set = async (id, value) => {
				  find(id).value = value;
				  find(id).dispatchEvent(new Event('input', { bubbles: true }));
				  await rest();
				};
				const press = async key => {
				  document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
				  await rest();
				};
				const fits = () => document.documentElement.scrollWidth <= innerWidth;
				onload = async () => {
				  try {
			END
			echo "$3"
			echo "} catch (e) { said.push(e); } document.title = said.join(' '); }</script></body></html>"
		} >driven.html
		browse "$2" driven.html | sed -n 's/.*<title>\(.*\)<\/title>.*/\1/p'
	}
	browse 1200 named.html >dom
	ok 'the page runs its script by its own policy' sh -c '! grep -q "<fieldset disabled" dom && grep -q aria-valuetext dom'
	# A start of the browser takes two seconds, so a page is driven once at a width.
	for width in 1200 ${NIGHT:+500}; do
		is "$width pixels wide: labels, sliders, zoom" "$(drive named.html $width '
			said.push([...document.querySelectorAll("input")].every(i => i.labels.length === 1), document.images[0].alt);
			said.push(fits(), seen());
			await set("time", 1); said.push(seen(), document.images[0].alt);
			await set("view", 1); said.push(seen(), find("view").getAttribute("aria-valuetext"));
			await set("time", 0); said.push(seen(), find("time").nextSibling.value, document.images.length);
			said.push(document.querySelector("figcaption").textContent);
			await set("view", 0);
			const size = () => [frame.clientWidth, picture.width, picture.height];
			said.push(size()); await set("zoom", 8); said.push(size().slice(1), frame.clientWidth >= 300, fits());
			await set("view", 1); said.push(picture.width, find("zoom").nextSibling.value);
		')" 'true east, time 9 true 9 10 east, time 10 20 top 19 9 1 a/top-9.png 40,40,30 320,240 true true 320 800 %'
	done
	is 'a large picture fits, and its middle stays in the middle' "$(
		for i in 1 2; do picture large$i.png $i 3000; done
		album large1.png large2.png >large.html
		drive large.html 500 '
			said.push(fits(), frame.scrollWidth <= frame.clientWidth, frame.scrollHeight <= frame.clientHeight);
			await set("zoom", 4); said.push(fits(), Math.round(frame.scrollWidth / frame.clientWidth));
			said.push(Math.abs(frame.scrollLeft + frame.clientWidth / 2 - frame.scrollWidth / 2) < 2);
		'
	)" 'true true true true 4 true'
	is 'keys' "$(drive named.html 1200 '
		await press("ArrowRight"); said.push(seen()); await press("ArrowUp"); said.push(seen());
		await press("ArrowLeft"); said.push(seen()); await press("ArrowLeft"); said.push(seen());
		await press("ArrowDown"); said.push(seen()); await press("+"); said.push(zoom.value); await press("-"); said.push(zoom.value);
	')" '10 20 19 19 9 1.25 1'
	album -v 1 s?.png >series.html
	is 'play shows each picture, and begins again; pause' "$(drive series.html 1200 '
		const order = [];
		new MutationObserver(() => order.push(seen())).observe(frame, { childList: true });
		await set("rate", 25);
		document.querySelector("button").click();
		said.push(document.querySelector("button").textContent);
		while (order.length < 8) { await wait(5); await rest(); }
		document.querySelector("button").click();
		await rest(); said.push(document.querySelector("button").textContent, order.slice(0, 8));
		const n = order.length; await wait(1000); said.push(order.length - n);
	')" 'Pause times Play times 40,80,120,160,200,0,40,80 0'
	is 'views play as well' "$(drive none.html 1200 '
		document.querySelector("button").click(); await wait(300); await rest(); document.querySelector("button").click();
		said.push(view.value, !time, seen());
	')" '1 true 19'
	album s3.png >one.html
	is 'one picture: only the zoom' "$(drive one.html 500 '
		said.push([...document.querySelectorAll("input")].map(i => i.id), document.images[0].alt, seen(), fits());
		await set("zoom", 2); said.push(picture.width);
	')" 'zoom s3.png 120 true 80'
	mkdir many
	for i in $(seq 0 59); do picture many/$i.png "$i"; done
	album many/*.png >many.html
	is '60 pictures: one at a time is decoded, and any is found' "$(drive many.html 1200 '
		said.push(document.images.length, find("time").max);
		for (const t of [59, 7, 30]) { await set("time", t); said.push(seen()); }
		for (let t = 0; t < 60; t++) { find("time").value = t; update(); }
		await rest(); said.push(seen(), document.images.length);
	')" '1 59 59 7 30 59 1'
	browse 1200 names.html >dom
	is 'a name is text in the browser' "$(grep -c '<script>alert' dom) $(grep -c '&lt;script&gt;alert(2)' dom)" '0 2'
else skip 'the page in a browser' 'chromium is not there'
fi
finish
