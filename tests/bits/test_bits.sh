#!/bin/sh
# test_bits.sh [--print|--made] - the same bits from every compiler, level and vector width: the trajectories of tests/bits/hash_run.h,
# against tests/data/hash.txt. A difference is told by model, method and block of 1000 ticks.
# The file changes only with a commit that says why and by how much the numbers moved; --print prints it anew; --made compares
# only the builds of the Makefile, by gcc and by clang. Run from the project's top folder; ends with `N passed, N failed`.
set -u
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
top=$PWD
golden=$top/tests/data/hash.txt
flags="-std=c99 -ffp-contract=off -fno-math-errno -fno-tree-vectorize -fno-tree-slp-vectorize -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes
    -Wmissing-prototypes -Wdouble-promotion -Wvla -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -Wno-psabi -I$top"
source=$(find "$top"/models "$top"/firmware "$top"/host_sim/batch "$top"/tests/bits "$top"/hal/posix/check_host.c -name '*.c' ! -path '*/firmware/main.c')
passed=0
failed=0
n=0

verdict() { # ok|FAIL, text
    printf '%-4s  %s\n' "$1" "$2"
    if [ "$1" = ok ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

compiled() { # folder, compiler and options
    mkdir "$1" && cd "$1" || return
    shift
    # shellcheck disable=SC2086
    "$@" $flags -c $source && "$@" $flags ./*.o -lm -o print && ./print >hashes
}

made() { # folder, compiler, build: the same from the objects of a build by the Makefile, at its -O2
    make -s CC="$2" BUILD="$3" "$3/hash_print" && mkdir "$1" && cp "$3/hash_print" "$1/print" && cd "$1" && ./print >hashes
}

sanitized() { # folder: from the objects of the sanitizers, clang -O1
    make -s sanitized-targets TARGETS=build/asan/hash_print && mkdir "$1" && cp build/asan/hash_print "$1/print" &&
        cd "$1" && ./print >hashes
}

run() { # made|compiled|sanitized, compiler and the rest
    how=$1
    shift
    if ! command -v "$1" >/dev/null; then
        verdict FAIL "$1 is not installed (apt-get install $1)"
        return
    fi
    n=$((n + 1))
    ($how "$out/$n" "$@") 2>"$out/$n.errors"
    if [ ! -x "$out/$n/print" ]; then
        verdict FAIL "$* does not build: $(grep -m 1 error "$out/$n.errors")"
    elif text=$(awk -v blocks=100 -f tests/bits/hash_compare.awk "$golden" "$out/$n/hashes"); then
        verdict ok "$*: $text"
    else
        verdict FAIL "$*: $text $(head -n 1 "$out/$n.errors")"
    fi
}

if [ "${1:-}" = --print ]; then
    (made "$out/1" gcc build) && cat "$out/1/hashes"
    exit
fi
run made gcc build
run made clang build/clang
if [ "${1:-}" = --made ]; then
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ]
    exit
fi
# Where the processor has fused operations, the highest level may use them, and must not.
if grep -qw avx2 /proc/cpuinfo && grep -qw fma /proc/cpuinfo; then
    highest="-O3 -march=x86-64-v3"
else
    highest=-O3
    echo "note  -march=x86-64-v3: this processor has no avx2 and fma"
fi
# Without optimisation tests/library/clean_room.sh asks the same of gcc.
for compiler in gcc clang; do
    # shellcheck disable=SC2086
    run compiled $compiler $highest
done
run sanitized clang -O1 with sanitizers
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
