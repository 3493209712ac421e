#!/bin/sh
# The first commands of a newcomer: make demo, also when POV-Ray disagrees; make and tests/need when packages are
# missing and cannot be installed.
. "$(dirname "$0")/lib.sh"
needs povray
unset MAKEFLAGS

# ---- need --------------------------------------------------------------------------------------------------
run env CC=no-such-compiler "$root/tests/need" -n build
is 'need -n: exit 3 if a package is missing' "$status" 3
like 'need -n: a message names it' "$err" 'missing: gcc.*make need'
mkdir few
for name in id grep uname sh cat; do ln -s "$(command -v $name)" few/$name; done
run env PATH="$tmp/few" CC=no-such-compiler "$root/tests/need" build
is 'need: exit 3 if it cannot install' "$status" 3
is 'need: it prints one line' "$(printf '%s\n' "$out$err" | wc -l)" 1
like 'need: the line has the command to type' "$err" 'as root: apt-get install gcc'
run env PATH="$tmp/few:$PATH" "$root/tests/need" build demo check chart
is 'need: it prints nothing if no package is missing' "$status$out$err" 0
run "$root/tests/need" nonsense
is 'need: an unknown role is refused' "$status" 2

# ---- fresh -------------------------------------------------------------------------------------------------
mkdir user
printf '#!/bin/sh\necho 1000\n' >user/id
chmod +x user/id
run env PATH="$tmp/user:$PATH" make -s -C "$root" fresh
like 'make fresh: an ordinary user reads that only root can try it' "$status $err" '^2 fresh: SKIP: only root'

# ---- make, with a compiler that finds all headers except one and installs the programs of the clone -----------------
# make takes no CC or BUILD with blanks in its name, and the temporary directory may have some.
plain=$(mktemp -d /tmp/commands.XXXXXX) && other=$plain/other || exit 3
trap 'rm -rf "$tmp" "$plain"' EXIT
mkdir include
mkdir include/gsl include/assimp include/pango include/SDL2
for header in stdio png zlib zstd archive jpeglib udunits2 proj eccodes expat gsl/gsl_cdf assimp/cimport pango/pangocairo SDL2/SDL; do : >include/$header.h; done
cat >"$plain/cc" <<END
#!/bin/sh
output='' before=''
for word; do
	[ "\$before" != -o ] || output=\$word
	before=\$word
done
case " \$* " in *' -E '*) exec cc -nostdinc '-I$tmp/include' "\$@" ;; esac
case \$output in
'' | -) exit 0 ;;
*nc2vtk* | */cf/*) exit 1 ;;
*.o) : >"\$output" ;;
*) printf '#!/bin/sh\necho %s >>"$tmp/used"\nexec "$BIN/%s" "\$@"\n' "\${output##*/}" "\${output##*/}" '\$@' >"\$output" && chmod +x "\$output" ;;
esac
END
chmod +x "$plain/cc"
: >"$tmp/script.sh"
run env LC_ALL=C make -n -C "$root" "$tmp/script"
like 'make: makes no script from another one' "$status $err" "^2 .*No rule to make target '[^']*script'"
run make -s -C "$root" BUILD="$other" CC="$plain/cc"
is 'make: without a header it builds the other programs' "$status" 0
is 'make: all other programs and copies of the scripts are there' "$(cd "$other/bin" && LC_ALL=C ls)" \
	"$(cd "$root/bin" && for f in *; do basename "$f" .c; done | sort -u | grep -vx nc2vtk)"
is 'make: one line names the program that is not built and the missing package' "$err" \
	'make: nc2vtk is not built: libnetcdf-dev is missing'
run make -s -C "$root" BUILD='two words'
like 'make: a BUILD with blanks is refused' "$status $err" '^2 .*BUILD is "two words", expected'
for where in . ./ build/.. "$root"; do
	run make -n -C "$root" clean BUILD="$where"
	like "make: BUILD=$(echo "$where" | sed 's|^/.*|/...|') would be the sources, and is refused" "$status $err" '^2 .*(, the sources, expected another|without blanks in its name)'
done

# ---- check: what a skipped test does ------------------------------------------------------------------------
mkdir -p small/tests/unit small/build/unit
cp "$root/tests/check" "$root/tests/tap" small/tests
: >small/tests/unit/test_a.c
for file in build/unit/test_a tests/29_povworker.t tests/3.t tests/60_faults.t tests/72_ssh_faults.t; do
	printf '#!/bin/sh\necho "ok 1 # SKIP %s"\necho 1..1\n' 'vectors of x: this processor has none' >small/$file
	chmod +x small/$file
done
run env -u BUILD CI=true small/tests/check
is 'check, CI=true: a test skipped for want of instructions is no failure' "$status" 0
like '... and is named' "$out" '^skipped: 60_faults.t: vectors of x: this processor has none'
sed -i 's/vectors.*none/hosts: only root can make hosts/' small/tests/3.t
run env -u BUILD CI=true small/tests/check
is 'check, CI=true: any other skipped test is a failure' "$status" 1
run env -u BUILD -u CI small/tests/check
is 'check: without CI=true it is none' "$status" 0
usual=$(sed -n 's/^usual=\([0-9]*\).*/\1/p' "$root/tests/check")
run env -u BUILD -u CI BEGUN=$(($(date +%s) - 2 * usual)) small/tests/check
like 'check: more than 1.5 times the usual time is said before the summary, and is no failure' \
	"$status $(printf '%s\n' "$out" | grep -A 1 '^check:' | tr '\n' ' ')" "^0 check: it took [0-9]+ s, .* $usual s .* Files="
run env -u BUILD -u CI BEGUN=$(($(date +%s) - usual)) small/tests/check
is 'check: the usual time is not said' "$(printf '%s\n' "$out" | grep -c '^check:')" 0
for page in README.md Makefile tests/README; do grep -q "$((usual / 60)) minutes" "$root/$page" || echo $page; done >missing
is 'pages say the usual time' "$(cat missing)" ''

# ---- demo --------------------------------------------------------------------------------------------------
run make -s -C "$root" demo BUILD="$other" CC="$plain/cc"
is 'demo: exit 0' "$status" 0
is 'demo: it runs the programs of its BUILD' "$(sort -u used | tr '\n' ' ')" \
	'deal fan fragstat gather imgcmp job nff2pov partition rtworker spdgen '
like 'demo: names the picture' "$out" 'gears\.png'
like 'demo: states the efficiency' "$out" 'efficiency +[0-9.]+ %'
like 'demo: POV-Ray agrees' "$out" 'POV-Ray agrees'
is 'demo: fits on one screen of 24 lines and 120 columns' "$(printf '%s\n' "$out" | awk 'NR > 24 || length > 120')" ''
like 'demo: the picture is 512x512' "$(imgcmp "$root/gears.png" "$root/gears.png")" 'size	512x512'
touch "$other/mine"
ok 'make clean' make -s -C "$root" clean BUILD="$other"
is 'make clean: removes all that was built, with any set of headers, and nothing else' \
	"$(find "$other")" "$(printf '%s\n' "$other" "$other/mine")"

mkdir wrong
cat >wrong/povray <<'END'
#!/bin/sh
{ printf 'P6\n512 512\n65535\n'; head -c $((512 * 512 * 6)) /dev/zero; } >pov.ppm
END
chmod +x wrong/povray
run env PATH="$tmp/wrong:$PATH" "$root/tests/demo"
is 'demo: exit 1 if the pictures differ' "$status" 1
like 'demo: it says that they differ' "$out" 'DISAGREES'
finish
