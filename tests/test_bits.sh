#!/bin/sh
# test_bits.sh - the same bits from every compiler, level and vector width: tests/hash_print.c, compared byte for byte
# and with the golden hash in tests/data/hash.txt. The golden changes only with a commit that says why and by how much
# the numbers moved. Run from the project's top folder; ends with `N passed, N failed`.
set -u
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
flags="-std=c99 -ffp-contract=off -fno-math-errno -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes
    -Wmissing-prototypes -Wdouble-promotion -Wvla -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -I."
core="models/elementary.c models/hertz_rig.c firmware/drive.c firmware/excitation.c firmware/switch.c
    firmware/rk4.c firmware/ledger.c firmware/plant.c"
golden=$(cat tests/data/hash.txt 2>/dev/null || echo "none: tests/data/hash.txt is missing")
passed=0
failed=0

verdict() { # ok|FAIL, text
    echo "$1  $2"
    if [ "$1" = ok ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

# compiler and options; the first build that works is what the others are compared with
build() {
    if ! command -v "$1" >/dev/null; then
        echo "skip  $1 is not installed"
        return
    fi
    # shellcheck disable=SC2086
    if ! "$@" $flags tests/hash_print.c $core -lm -o "$out/print" 2>"$out/errors"; then
        verdict FAIL "$* does not build: $(head -n 1 "$out/errors")"
        return
    fi
    if ! "$out/print" >"$out/now" 2>"$out/errors"; then
        verdict FAIL "$* stopped: $(tail -n 1 "$out/now") $(head -n 1 "$out/errors")"
        return
    fi
    [ -f "$out/first" ] || cp "$out/now" "$out/first"
    last=$(grep ' ' "$out/now" | grep -v switches | tail -n 1)
    if ! cmp -s "$out/first" "$out/now"; then
        verdict FAIL "$*: tick and hash $last differ from the first build's, first at $(diff "$out/first" "$out/now" | sed -n 2p)"
    elif [ "$last" != "$golden" ]; then
        verdict FAIL "$*: tick and hash $last, golden $golden"
    else
        verdict ok "$*: tick and hash $last"
    fi
}

for compiler in gcc clang; do
    for level in -O0 -O1 -O2 -O3; do
        build $compiler $level
    done
done
if grep -qw avx2 /proc/cpuinfo 2>/dev/null && grep -qw fma /proc/cpuinfo; then
    build gcc -O3 -march=x86-64-v3
else
    echo "skip  gcc -O3 -march=x86-64-v3: this processor has no avx2 and fma"
fi
build gcc -O1 -fsanitize=undefined -fno-sanitize-recover=all
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
