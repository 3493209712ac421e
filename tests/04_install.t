#!/bin/sh
# make install and make uninstall with blanks and quotes in directory names. The installed programs work alone, and
# uninstall removes nothing else.
. "$(dirname "$0")/lib.sh"
unset MAKEFLAGS
# tree: every name in the user's home and the staging directory, with what it holds
tree() { find home stage -type d | sort; find home stage ! -type d -exec cksum {} + | sort -k 3; }
programs=$(for f in "$root"/bin/*; do basename "$f" .c; done | sort -u)

mkdir -p stage home/my "home/my prefix/bin" "home/my prefix/share/man/man1" "home/my prefix/share/empty" home/prefix/share/stormring
for file in home/my/thesis home/prefix/share/stormring/wind.nc "home/my prefix/bin/mine" "home/my prefix/share/man/man1/mine.1"; do
	echo "$file" >"$file"
done
before=$(tree)

# ---- into an ordinary user's home ------------------------------------------------------------------------------------
prefix="$tmp/home/my prefix"
mkdir -p elsewhere/tests
ok 'make install, where CDPATH leads elsewhere' env CDPATH="$tmp/elsewhere" make -s -C "$root" install PREFIX="$prefix"
is 'every program and script is installed' "$(LC_ALL=C ls "$prefix/bin")" "$(printf '%s\n' mine $programs | sort)"
is 'every page is installed' "$(cd "$prefix/share/man" && ls man*/* | wc -l)" "$(($(ls "$root"/man/*.[1-9] | wc -l) + 1))"
is 'every scene is installed' "$(ls "$prefix/share/stormring")" "$({ ls "$root/scenes"; printf 'chart\nexperiments\nmanifest\n'; } | sort)"
is 'every static program is installed' "$(ls "$prefix/lib/stormring")" "$(ls "$root/build/static")"
is 'nothing is written outside the prefix' "$(tree | grep -v "home/my prefix")" "$(echo "$before" | grep -v "home/my prefix")"
cat >installed <<END
PATH='$prefix/bin:/usr/bin:/bin'
cd home
spdgen -s 2 tetra >tetra.nff
balance masterslave -j 2 -s 16x16 -o tetra.png tetra.nff
imgcmp tetra.png tetra.png
rm tetra.*
END
ok 'the installed programs render alone' sh -e installed
if there gnuplot tsvstat; then
	printf 'experiment kind method x x_unit y y_unit sample seed\na real m 1 s 2 s 1 0\n' | tr ' ' '\t' >one.tsv
	ok 'an installed chart finds its parts' env -i PATH=/usr/bin:/bin "$prefix/bin/chart" -o one.svg one.tsv
else
	skip 'an installed chart finds its parts' "$missing is not there"
fi
echo older >"$prefix/bin/older"
echo bin/older >>"$prefix/share/stormring/manifest"
ok 'make install over an earlier version' make -s -C "$root" install PREFIX="$prefix"
ok 'make uninstall, without a compiler' make -s -C "$root" uninstall PREFIX="$prefix" CC=false
is 'all installed files are gone, also of the earlier version, and all other files are unchanged' "$(tree)" "$before"

# ---- for a package: DESTDIR and PREFIX are made and removed ----------------------------------------------------
stage="$tmp/stage/it's \\ a \"new\" *"
ok 'make install into a directory with quotes in its name' make -s -C "$root" install DESTDIR="$stage" PREFIX=/usr
is 'every program and script is in the staging directory' "$(LC_ALL=C ls "$stage/usr/bin")" "$programs"
is 'nothing is installed elsewhere' "$(ls stage)" "${stage##*/}"
ok 'make uninstall' make -s -C "$root" uninstall DESTDIR="$stage" PREFIX=/usr
is 'uninstall leaves nothing in the staging directory' "$(tree)" "$before"

# ---- where nothing was installed ----------------------------------------------------------------------------
run make -s -C "$root" uninstall PREFIX="$tmp/home/prefix"
is 'make uninstall: without a manifest it fails' "$status" 2
like 'make uninstall: a message says that the manifest is missing' "$err" 'home/prefix/share/stormring/manifest: not found, expected'
printf 'bin/fan\n../my/thesis\n' >home/prefix/share/stormring/manifest
run make -s -C "$root" uninstall PREFIX="$tmp/home/prefix"
like 'make uninstall: a manifest that names a file elsewhere is refused' "$status $err" '^2 .*manifest:2: is "../my/thesis", expected'
rm home/prefix/share/stormring/manifest
is 'uninstall without a valid manifest removes nothing' "$(tree)" "$before"
finish
