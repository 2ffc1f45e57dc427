#!/bin/sh
# test_instructions.sh [--print] - instructions that small pieces of work take (tests/bench/cost/instructions.c, counted by callgrind),
# against the budgets in tests/data/instructions.txt: above one fails, a tenth below one says so. Unlike times the counts
# do not depend on what else the machine does, nor the machine, but on the compiler: budgets are for gcc 12 and clang 14
# at -O2. --print measures and prints the file anew, 3 % above what was counted. Run from the project's top folder; ends
# with `N passed, N failed`.
set -u
budgets=tests/data/instructions.txt
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
passed=0
failed=0

verdict() { # ok|FAIL, text
    printf '%-4s  %s\n' "$1" "$2"
    if [ "$1" = ok ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

if ! command -v valgrind >/dev/null && [ "$(id -u)" = 0 ]; then
    (apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends valgrind) \
        >"$out/install.log" 2>&1
fi

# measure COMPILER VERSION DIR: lines of "name instructions" in $out/COMPILER; what went wrong on stdout.
measure() {
    major=$("$1" -dumpversion 2>/dev/null | cut -d. -f1)
    if [ "$major" != "$2" ]; then
        echo "needs $1 $2, here it is ${major:-missing}"
    elif ! make -s CC="$1" BUILD="$3" "$3/instructions" >"$out/make.log" 2>&1; then
        echo "tests/bench/cost/instructions.c does not build: $(grep -m 1 error "$out/make.log")"
    elif ! strip -g -o "$out/program" "$3/instructions"; then # valgrind 3.19 cannot read clang's debug information
        echo "no strip (apt-get install binutils)"
    elif ! LD_BIND_NOW=1 valgrind --tool=callgrind --callgrind-out-file="$out/calls" "$out/program" \
        >"$out/names" 2>"$out/valgrind.log"; then
        echo "valgrind: $(tail -n 1 "$out/valgrind.log") (apt-get install valgrind)"
    else
        callgrind_annotate --inclusive=yes --threshold=100 "$out/calls" |
            awk 'NR == FNR { name[NR] = $1; calls[$1] = $2; next }
                 match($0, /:once_[a-z0-9_]+/) && !/=>/ {
                     count = $1
                     gsub(",", "", count)
                     total[substr($0, RSTART + 6, RLENGTH - 6)] = count }
                 END { for (i = 1; i in name; i++)
                     if (name[i] in total) printf "%s %.1f\n", name[i], total[name[i]] / calls[name[i]] }' \
                "$out/names" - >"$out/$1"
        [ "$(wc -l <"$out/$1")" = "$(wc -l <"$out/names")" ] || echo "pieces of work were not found in the counts"
    fi
}

# compare COMPILER COLUMN
compare() {
    grep -v '^#' $budgets | cut -d' ' -f1,"$2" >"$out/wanted"
    while read -r name budget; do
        got=$(sed -n "s/^$name //p" "$out/$1")
        if [ -z "$got" ]; then
            verdict FAIL "$1, $name: has a budget but is not counted"
        elif awk "BEGIN { exit !($got > $budget) }"; then
            verdict FAIL "$1, $name: $got instructions, budget $budget"
        else
            verdict ok "$1, $name: $got instructions, budget $budget"
            awk "BEGIN { exit !($got < 0.9 * $budget) }" && echo "note  lower the budget of $name with $1"
        fi
    done <"$out/wanted"
    for name in $(cut -d' ' -f1 "$out/$1"); do
        grep -q "^$name " $budgets || verdict FAIL "$1, $name: has no budget (tests/bench/cost/test_instructions.sh --print)"
    done
}

why_gcc=$(measure gcc 12 build)
why_clang=$(measure clang 14 build/clang)
if [ "${1:-}" = --print ]; then
    [ -z "$why_gcc$why_clang" ] || { echo "$why_gcc $why_clang" >&2 && exit 1; }
    echo "# instructions a call, at most: name gcc-12 clang-14, -O2, x86-64 (tests/bench/cost/test_instructions.sh --print)"
    awk 'NR == FNR { gcc[$1] = $2; next }
         { printf "%s %.0f %.0f\n", $1, 1.03 * gcc[$1] + 0.5, 1.03 * $2 + 0.5 }' "$out/gcc" "$out/clang"
    exit
fi
if [ -n "$why_gcc" ]; then verdict FAIL "gcc: $why_gcc"; else compare gcc 2; fi
if [ -n "$why_clang" ]; then verdict FAIL "clang: $why_clang"; else compare clang 3; fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
