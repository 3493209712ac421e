#!/bin/sh
# The commands that a newcomer types: make demo (its verdict can be no, too), make install, and what is said where
# packages are missing and cannot be had.
. "$(dirname "$0")/lib.sh"
unset MAKEFLAGS

# ---- need --------------------------------------------------------------------------------------------------
run env CC=no-such-compiler "$root/tests/need" -n build
is 'need -n: exit 3 where something is missing' "$status" 3
like 'need -n: says what' "$err" 'missing: gcc.*make need'
mkdir few
for name in id grep uname sh cat; do ln -s "$(command -v $name)" few/$name; done
run env PATH="$tmp/few" CC=no-such-compiler "$root/tests/need" build
is 'need: exit 3 where it cannot install' "$status" 3
is 'need: one line says so' "$(printf '%s\n' "$out$err" | wc -l)" 1
like 'need: and what would have to be typed' "$err" 'as root: apt-get install gcc'
run env PATH="$tmp/few:$PATH" "$root/tests/need" build demo check chart
is 'need: nothing to do, nothing said' "$status$out$err" 0
run "$root/tests/need" nonsense
is 'need: an unknown role is refused' "$status" 2

# ---- make without a header: a compiler that finds four others, and puts nothing into its outputs --------------------
mkdir include
for header in stdio png zlib eccodes; do : >include/$header.h; done
cat >cc <<END
#!/bin/sh
output='' before=''
for word; do
	[ "\$before" != -o ] || output=\$word
	before=\$word
done
case " \$* " in *' -E '*) exec cc -nostdinc '-I$tmp/include' "\$@" ;; esac
case \$output in *nc2vtk* | */cf/*) exit 1 ;; esac
[ -z "\$output" ] || : >"\$output"
END
chmod +x cc
run make -s -C "$root" BUILD="$tmp/lacking" CC="$tmp/cc"
is 'make: without a header it builds the other programs' "$status" 0
is 'make: all of them' "$(cd lacking/bin && ls)" "$(cd "$root/bin" && ls ./*.c | sed 's/.*\///; s/[.]c$//' | grep -vx nc2vtk)"
is 'make: one line says which is not built, and which package is missing' "$err" \
	'make: nc2vtk is not built: libnetcdf-dev is missing'

# ---- demo --------------------------------------------------------------------------------------------------
run "$root/tests/demo"
is 'demo: exit 0' "$status" 0
like 'demo: names the picture' "$out" 'gears\.png'
like 'demo: states the efficiency' "$out" 'efficiency +[0-9.]+ %'
like 'demo: POV-Ray agrees' "$out" 'POV-Ray agrees'
is 'demo: fits on one screen of 24 lines and 120 columns' "$(printf '%s\n' "$out" | awk 'NR > 24 || length > 120')" ''
like 'demo: the picture is 512x512' "$(imgcmp "$root/gears.png" "$root/gears.png")" 'size	512x512'

mkdir other
cat >other/povray <<'END'
#!/bin/sh
{ printf 'P6\n512 512\n65535\n'; head -c $((512 * 512 * 6)) /dev/zero; } >pov.ppm
END
chmod +x other/povray
run env PATH="$tmp/other:$PATH" "$root/tests/demo"
is 'demo: exit 1 where the pictures differ' "$status" 1
like 'demo: and says so' "$out" 'DISAGREES'

# ---- install -----------------------------------------------------------------------------------------------
ok 'make install' make -s -C "$root" install DESTDIR="$tmp/root" PREFIX=/usr
is 'every program and script is installed' "$(ls "$tmp/root/usr/bin")" \
	"$(for f in "$root"/bin/*; do basename "$f" .c; done | sort -u)"
is 'every page is installed' "$(cd "$tmp/root/usr/share/man" && ls man*/* | wc -l)" "$(ls "$root"/man/*.[1-9] | wc -l)"
cat >installed <<END
PATH=$tmp/root/usr/bin:/usr/bin:/bin
spdgen -s 2 tetra >tetra.nff && balance masterslave -j 2 -s 16x16 -o tetra.png tetra.nff && imgcmp tetra.png tetra.png
END
ok 'what is installed renders by itself' sh -e installed
ok 'make uninstall' make -s -C "$root" uninstall DESTDIR="$tmp/root" PREFIX=/usr
is 'and nothing is left' "$(find "$tmp/root" -type f)" ''
finish
