#!/bin/sh
# test_bits.sh - the same bits from every compiler, level and vector width: tests/hash_print.c, compared byte for byte
# with the first build's and, its last tick and hash, with the golden one in tests/data/hash.txt. The golden changes
# only with a commit that says why and by how much the numbers moved. Run from the project's top folder; ends with
# `N passed, N failed`.
set -u
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
flags="-std=c99 -ffp-contract=off -fno-math-errno -fno-tree-vectorize -fno-tree-slp-vectorize -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes
    -Wmissing-prototypes -Wdouble-promotion -Wvla -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -Wno-psabi -I."
source="tests/hash_print.c tests/hash_run.c tests/arithmetic.c tests/hash_batch.c $(ls models/*.c firmware/*.c host_sim/batch*.c hal/check_host.c | grep -v firmware/main.c)"
methods=$(cut -d' ' -f1 tests/data/hash.txt tests/data/hash_batch.txt 2>/dev/null) # lines of: method tick hash
passed=0
failed=0
n=0

verdict() { # ok|FAIL, text
    printf '%-4s  %s\n' "$1" "$2"
    if [ "$1" = ok ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

build() { # compiler and options; two at a time
    if ! command -v "$1" >/dev/null; then
        verdict FAIL "$1 is not installed (apt-get install $1)"
        return
    fi
    n=$((n + 1))
    echo "$*" >"$out/$n.name"
    # shellcheck disable=SC2086
    "$@" $flags $source -lm -o "$out/$n.print" 2>"$out/$n.errors" &
    if [ $((n % 2)) -eq 0 ]; then wait; fi
}

judge() { # number of a build, method
    name="$(cat "$out/$1.name"), $2"
    golden=$(grep -h "^$2 " tests/data/hash.txt tests/data/hash_batch.txt | cut -d' ' -f2-)
    if [ ! -x "$out/$1.print" ]; then
        verdict FAIL "$name does not build: $(grep -m 1 error "$out/$1.errors")"
    elif ! "$out/$1.print" "$2" >"$out/$1.$2" 2>"$out/$1.errors"; then
        verdict FAIL "$name stopped: $(tail -n 1 "$out/$1.$2") $(head -n 1 "$out/$1.errors")"
    elif ! cmp -s "$out/1.$2" "$out/$1.$2"; then
        verdict FAIL "$name differs from the first build: $(diff "$out/1.$2" "$out/$1.$2" | sed -n 2p)"
    else
        last=$(grep -v switches "$out/$1.$2" | tail -n 1)
        if [ "$last" = "$golden" ]; then
            verdict ok "$name: tick and hash $last"
        else
            verdict FAIL "$name: tick and hash $last, golden $golden"
        fi
    fi
}

for level in -O0 -O1 -O2 -O3; do
    build gcc $level
    build clang $level
done
build gcc -O1 -fsanitize=undefined -fno-sanitize-recover=all
if grep -qw avx2 /proc/cpuinfo && grep -qw fma /proc/cpuinfo; then
    build gcc -O3 -march=x86-64-v3
    build clang -O2 -march=x86-64-v3
else
    echo "note  -march=x86-64-v3: this processor has no avx2 and fma"
fi
wait
i=0
while [ $i -lt $n ]; do
    i=$((i + 1))
    for method in $methods; do
        judge $i "$method"
    done
done
[ -n "$methods" ] || verdict FAIL "tests/data/hash.txt is missing"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
