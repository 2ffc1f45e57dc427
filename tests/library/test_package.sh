#!/bin/bash
# test_package.sh BUILD - the tarball and the Debian packages: equal bytes from equal commits, lintian's errors, and a user's first hour with
# each of them in a root of nothing but a Debian with compilers. Prints one line a check and `N passed, N failed` at the end.
set -u
build=$1
unset MAKEFLAGS MFLAGS MAKELEVEL
here=$(mktemp -d) || exit 1
trap 'rm -rf "$here"' EXIT
trap 'exit 1' INT TERM
. "$(dirname "$0")/../house/verdict.sh"

twice() { # TARGET FILES: what make writes, two times, is the same
    local first
    make -s BUILD="$build" "$1" >"$here/log" 2>&1
    verdict $? "make $1" "$(tail -n 2 "$here/log")"
    first=$(cat $2 | sha256sum)
    touch "$build/contactplant"
    make -s BUILD="$build" "$1" >"$here/log" 2>&1
    [ "$(cat $2 | sha256sum)" = "$first" ]
    verdict $? "a second time gives the same bytes"
}

version=$(sed -n 's/^#define CONTACTPLANT_VERSION *"\(.*\)"/\1/p' host_sim/library/contactplant.h)
tarball=$build/contactplant-$version.tar.gz
echo "--- tarball"
if [ -e .git ]; then
    twice dist "$tarball"
    tar tzf "$tarball" | sed -n "s|^contactplant-$version/\(.*[^/]\)\$|\1|p" | LC_ALL=C sort | cmp -s - <(git ls-tree -r --name-only HEAD | LC_ALL=C sort)
    verdict $? "it has every file of the commit, $(tar tzf "$tarball" | grep -vc '/$'), and no other"
else
    make -s BUILD="$build" dist >"$here/log" 2>&1
    [ $? != 0 ] && grep -q "no git repository" "$here/log"
    verdict $? "make dist outside of a repository says why not" "$(cat "$here/log")"
    tar czf "$tarball" --exclude="./build" --transform "s|^\.|contactplant-$version|" .
fi
echo "--- Debian packages"
export DPKG_DEB_COMPRESSOR_LEVEL=1 # what is packed and unpacked is the question, not how small it gets
twice deb "$build/deb/*.deb"
errors=$(lintian --fail-on error "$build"/deb/*.deb 2>&1)
verdict $? "lintian finds no error" "$(echo "$errors" | head -n 5 | tr '\n' ' ')"

echo "--- a Debian with compilers and nothing else"
root=$here/root
packages=$(tests/library/clean_root.py "$root" gcc g++ make pkg-config man-db 2>"$here/log")
verdict $? "a root of $packages packages" "$(tail -n 1 "$here/log")"
cp "$tarball" "$build"/deb/*.deb tests/library/clean_room.sh "$root/root"
unshare -rm sh -c 'mount --rbind /dev "$0/dev" && mount --rbind /proc "$0/proc" && cd / &&
    exec env -i PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin HOME=/root chroot "$0" sh /root/clean_room.sh "$1"' "$root" "$version" >"$here/room" 2>&1
cat "$here/room"
passed=$((passed + $(grep -c '^ok' "$here/room")))
failed=$((failed + $(grep -c '^FAIL' "$here/room")))
tail -n 1 "$here/room" | grep -q "nothing is left of them"
verdict $? "the room came to its end" "$(tail -n 1 "$here/room")"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
