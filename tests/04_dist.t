#!/bin/sh
# make dist: the tarball has every file of the commit. NIGHT=true: from it alone, in a directory that is no clone and where
# git fails, make builds every program, make install copies them, and every unit test passes. It does not try what is not
# committed. It says nothing of packages that this machine has and another one lacks: make fresh does.
. "$(dirname "$0")/lib.sh"
needs git tar
cd "$tmp" || exit 3
git -C "$root" rev-parse -q --verify HEAD >.head 2>&1 || { echo '1..0 # SKIP this is no clone'; exit 0; }
unset MAKEFLAGS MFLAGS MAKELEVEL BIN BUILD TAP DESTDIR PREFIX CFLAGS

# In a clone, so that no tarball of the user is replaced.
ok 'a clone of the last commit' git clone -q "$root" clone
ok 'make dist' make -s -C clone dist
is 'one tarball' "$(cd clone && git status --porcelain --ignored | wc -l)" 1
tarball=$(echo clone/stormring-*.tar.gz) name=$(basename "$tarball" .tar.gz)
ok 'it unpacks' tar -x -f "$tarball"
is 'it has every file of the commit' "$(cd "$name" && find . ! -type d | sed 's,^\./,,' | sort)" \
	"$(git -C clone -c core.quotePath=false ls-files | sort)"

[ "${NIGHT-}" = true ] || finish

mkdir without
printf '#!/bin/sh\necho "git $*" >>"%s"\nexit 127\n' "$tmp/asked" >without/git
chmod +x without/git
PATH=$tmp/without:${PATH#"$root/bin:"}
ok 'make' make -s -j2 -C "$name" all unit
ok 'make install' make -s -C "$name" install DESTDIR="$tmp/stage" PREFIX=/usr
is 'every program is installed' "$(LC_ALL=C ls stage/usr/bin)" "$(for f in "$name"/bin/*; do basename "$f" .c; done | sort -u)"
for unit in "$name"/build/unit/test_*; do case $unit in *.d) ;; *) ok "${unit##*/} passes there" "$unit" ;; esac; done
is 'git was not asked' "$(cat asked 2>/dev/null)" ''
finish
