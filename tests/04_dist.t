#!/bin/sh
# make dist: from the tarball alone, in a directory that is no clone and where git fails, make builds every program, make
# install copies them, and three files of quick tests pass. "04_dist.t all" runs `make test` there as well
# (tests/soak/dist.sh). It builds by clang, which warns of nothing; its programs are hardened, and render the same picture.
# It does not try what is not committed. It says nothing of packages that this machine has and another one lacks: make
# fresh does.
. "$(dirname "$0")/lib.sh"
needs git tar clang
# shellcheck source=builds.sh
. "$root/tests/builds.sh"
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

mkdir without
printf '#!/bin/sh\necho "git $*" >>"%s"\nexit 127\n' "$tmp/asked" >without/git
chmod +x without/git
PATH=$tmp/without:${PATH#"$root/bin:"}
ok 'make, and clang warns of nothing' make -s -j2 -C "$name" CC=clang CFLAGS='-O2 -Werror'
ok 'make install' make -s -C "$name" CC=clang CFLAGS='-O2 -Werror' install DESTDIR="$tmp/stage" PREFIX=/usr
is 'every program is installed' "$(LC_ALL=C ls stage/usr/bin)" "$(for f in "$name"/bin/*; do basename "$f" .c; done | sort -u)"
for test in 11_spdgen 12_partition 30_gather; do ok "tests/$test.t passes there" "$name/tests/$test.t"; done
[ "${1-}" != all ] || ok 'make test passes there' make -C "$name" CC=clang CFLAGS='-O2 -Werror' test
is 'git was not asked' "$(cat asked 2>/dev/null)" ''
dist=$tmp/$name
cd "$root" || exit 3
ok 'programs built by clang are hardened' hardened clang "$dist/bin" "$dist/build"
ok 'the pipeline built by clang renders the same bits' same "$dist/bin"
finish
