#!/bin/sh
# stormring-security(7): each test that the page names exists, with that assertion; and facts that no other test asserts.
. "$(dirname "$0")/lib.sh"
page=$root/man/stormring-security.7

# ---- the page's tests ----------------------------------------------------------------------------------------------
# named PAGE: prints FILE, a tab and ASSERTION for each .Ql below a .Pa of a test
named() {
	awk -v OFS='\t' '
	/^\.Pa tests\// { file = $2; next }
	/^\.Ql / && file { s = substr($0, 5); sub(/ [.,;:]$/, "", s); gsub(/^"|"$/, "", s); print file, s; next }
	{ file = "" }' "$1"
}
# unfounded PAGE: prints what is named there, and does not exist
unfounded() {
	named "$1" | while IFS='	' read -r file assertion; do
		[ -e "$root/$file" ] || { echo "$file: no such file"; continue; }
		case $file in
		*.c) grep -qF "cmocka_unit_test($assertion)" "$root/$file" ;;
		# the first argument of a function, in either kind of quotes
		*) A=$assertion awk '{ line = $0; gsub("\047\"\047\"\047", "\047", line)
				for (q = 1; q <= 2; q++) if (index(line, " " substr("\"\047", q, 1) ENVIRON["A"] substr("\"\047", q, 1) " ")) found = 1 }
			END { exit !found }' "$root/$file" ;;
		esac || echo "$file: has no assertion \"$assertion\""
	done
}
is 'the page names tests' "$(named "$page" | awk 'END { print (NR > 40 ? "many" : NR) }')" many
is 'each test that the page names exists, and has that assertion' "$(unfounded "$page")" ''
printf '.Pa tests/06_security.t ,\n.Ql "the page names tests" ;\n.Pa tests/nosuch.t ,\n.Ql "x" .\n.Pa tests/62_hosts.t ,\n.Ql "no such assertion" .\n' >made
is 'a test or an assertion that is not there is found' "$(unfounded made)" 'tests/nosuch.t: no such file
tests/62_hosts.t: has no assertion "no such assertion"'
awk '/^\.It Sy / { if (open) print open; open = $0 } /^Shown by|Not prevented|without a password|umask|apt-get/ { open = "" } /^\.Ss/ { if (open) print open; open = "" }' "$page" >open
is 'each threat has a test, or says what is not prevented' "$(cat open)" ''

# ---- messages ----------------------------------------------------------------------------------------------------
# Names and words of files may have what a terminal obeys, and what echo of some shells makes into that.
# obeyed FILE: it has a control character, also one of C1 in UTF-8, that is no line end
obeyed() { tr -d '\n' <"$1" | LC_ALL=C grep -aqE "[[:cntrl:]]|$(printf '\302[\200-\237]')"; }
odd=$(printf 'n\033]0;x\007\302\233\nq\\033\\c.') lines=0
for program in "$root"/bin/*; do
	program=${program##*/}
	[ -x "$root/bin/$program" ] || continue
	case $program in
	balance) words='adaptive -j 1' ends='nff pov blend vtk' ;;
	balance-bricks) words='-o o.png k.vtk' ends='spec' ;;
	balance-calibrate) words='-n 1' ends='nff' ;;
	balance-*) continue ;;
	backdrop) words='-o o.png' ends='vtk' ;;
	blend | grid2pov) words='-o o.png' ends='png' ;;
	cropworker) words='-i -s 8x8' ends='x' ;;
	fan | ringctl | deal | protocol | spdgen) words='' ends='x' ;;
	grib2vtk | nc2vtk | vol2vtk) words='-l' ends='nc' ;;
	gridcut) words='-n 2,1,1 -o b%d.vtk' ends='vtk' ;;
	imgcmp) words='x.png' ends='png' ;;
	job) words='-i -k kept' ends='nff pov blend vtk' ;;
	pack) words='scene' ends='nff' ;;
	blendworker) words='-i -s 8x8' ends='blend' ;;
	povworker | rtworker) words='-i' ends='nff pov' ;;
	partition) words='-r' ends='x' ;;
	simulate) words='-t' ends='x' ;;
	vcworker) words='-i k.vtk' ends='spec' ;;
	verify) words='-j 2 1' ends='x' ;;
	views) words='-n 2 -o v%d k.spec' ends='spec' ;;
	*) words='' ends='x' ;;
	esac
	for end in $ends; do
		for state in missing malformed; do
			rm -f "$odd$end"
			[ $state = missing ] || printf '\033[31m \\033[31m\\c\007 \302\233 1\n#version 3.7;\n' >"$odd$end"
			# shellcheck disable=SC2086  # words
			timeout 60 "$program" $words "$odd$end" </dev/null 2>"$tmp/out" >/dev/null
			case $words in -r | -t) timeout 60 "$program" $words "$odd$end" 8x8 </dev/null 2>>"$tmp/out" >/dev/null ;; esac
			"$program" "-$odd" </dev/null 2>>"$tmp/out" >/dev/null
			lines=$((lines + $(wc -l <"$tmp/out")))
			! obeyed "$tmp/out" || { echo "$program $words, $state:"; cat -v "$tmp/out"; }
		done
	done
done >said
printf 'a\033b\n' >obeyed.txt
is 'a control character in a file is found' "$(obeyed obeyed.txt; echo $?)" 0
is 'no message has a control character of a name or a file' "$(cat said)" ''
ok 'there were messages' [ $lines -gt 60 ]
rm -f "$odd"*

# ---- facts -----------------------------------------------------------------------------------------------------------
# calls NAME ...: prints the programs that call one of these functions
calls() {
	for program in "$root"/bin/*.c; do
		program=${program%.c}
		[ ! -x "$program" ] || nm -u "$program" | sed 's/@.*//' | awk -v p="${program##*/}" -v names=" $* " '
			index(names, " " $NF " ") { print p ": " $NF }'
	done
}
if command -v nm >/dev/null; then
	is 'no program opens a socket' "$(calls socket socketpair connect bind listen accept accept4 getaddrinfo)" ''
	is 'no program starts a shell by a function of the C library' "$(calls system popen wordexp)" ''
	is 'only programs that start others can start one' "$(calls execvp execv execve execl execlp posix_spawn posix_spawnp |
		sed 's/:.*//' | sort -u | tr '\n' ' ')" 'backdrop cropworker deal fan job replay ringctl rtworker stormview vcworker '
else
	skip 'what programs call' 'nm is not there'
fi

# ssh's options, by an ssh that only notes them
mkdir fake
# shellcheck disable=SC2016  # of the script
printf '#!/bin/sh\nprintf "%%s\\n" "$@" >"%s/words"\nexit 126\n' "$tmp" >fake/ssh
chmod +x fake/ssh
echo far >far
PATH=$tmp/fake:$PATH run fan -l -l -S far rtworker -
is 'ssh forwards no agent and no X11, and does not ask' "$(grep -cx -e -a -e -x -e -T -e -oBatchMode=yes words)" 4
is 'ssh forwards no port, runs no other command, and shares no connection' "$(grep -cx -e -oClearAllForwardings=yes \
	-e -oRemoteCommand=none -e -oPermitLocalCommand=no -e -oControlMaster=no words)" 4
is 'ssh is told nothing about the keys of hosts' "$(grep -ci 'StrictHost\|KnownHosts' words)" 0

spdgen -s 2 tetra >tetra.nff
cat >watch <<'END'
#!/bin/sh
cat /proc/[0-9]*/cmdline 2>/dev/null | tr '\0' '\n' >>"$WATCHED"
exec rtworker "$@"
#!/bin/sh
cat /proc/[0-9]*/cmdline 2>/dev/null | tr '\0' '\n' >>"$WATCHED"
exec rtworker "$@"
END
chmod +x watch
{ pack scene tetra.nff; partition 16x16; } | WATCHED=$tmp/watched deal fan -j 2 ./watch - | gather -o t.png
is 'the watched run is complete' "$?" 0
is 'the scene is on no command line' "$(grep -cx 'from [-0-9.]* [-0-9. ]*\|resolution [0-9 ]*' watched)" 0

# shellcheck disable=SC2016  # of the shell
is 'a temporary directory is for its user only' "$(umask 0; here=$root/bin sh -c '. "$here/stormring.sh" && d=$(directory) && stat -c %a "$d" && rmdir "$d"')" 700

printf '%s\n' '# vtk DataFile Version 3.0' t BINARY 'DATASET RECTILINEAR_GRID' 'DIMENSIONS 2000000000 2000000000 2' \
	'X_COORDINATES 2000000000 float' >vast.vtk
printf '%s\n' 'from 3 2 4' 'at .5 .5 .5' 'up 0 0 1' 'angle 30' 'resolution 16 12' 'map 1 1 0 0 1' 'map 2 0 0 1 1' >a.spec
run prlimit --as=1000000000 vcworker -i vast.vtk a.spec
like 'a grid that states more nodes than memory has is refused' "$status $err" '^2 vcworker: vast.vtk:.*expected'
sed 's/^resolution .*/resolution 999999999 999999999/' tetra.nff >vast.nff
run prlimit --as=1000000000 rtworker -i vast.nff
like 'a picture that no memory has is refused' "$status $err" '^2 rtworker: vast.nff:.*expected'

printf '%s\n' '# vtk DataFile Version 3.0' TITLE ASCII 'DATASET RECTILINEAR_GRID' 'DIMENSIONS 2 2 2' 'X_COORDINATES 2 float' '0 1' \
	'Y_COORDINATES 2 float' '0 1' 'Z_COORDINATES 2 float' '0 1' 'POINT_DATA 8' 'SCALARS s float' 'LOOKUP_TABLE default' '1 2 1 2 1 2 1 2' >grid
# drawn TITLE: a map of a grid with this title is drawn, and its command has not run
drawn() {
	title=$1 awk 'NR == 2 { $0 = ENVIRON["title"] } { print }' grid >titled.vtk
	rm -f map.png && backdrop -s 900x300 -o map.png titled.vtk a.spec && [ -s map.png ] && [ ! -e ran ]
}
# shellcheck disable=SC2016  # commands that must not run
titles() {
	drawn "s'.system('touch ran').' [m]" && drawn 's`touch ran` [m]' && drawn "s\\'.system('touch ran').' [m]" &&
		drawn "s [m'.system('touch ran').']; x a ['\`touch ran\`]; y b [m]; z c [%'.system('touch ran').']; t time 0 [d'\`touch ran\`]"
}
if command -v gnuplot >/dev/null; then ok "a grid's title is no command of gnuplot" titles
else skip "a grid's title is no command of gnuplot" 'gnuplot is not there'
fi
finish
