#!/bin/sh
# test_choose_cost.sh CONTACTPLANT CHOOSE_ONE - what contactplant choose says that a step costs against what whole runs of the
# choice execute, counted by callgrind: within 30 %. Run from the project's top folder; ends with `N passed, N failed`.
set -u
program=$1
one=$2
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
passed=0
failed=0
strip -g -o "$out/one" "$one" || exit 1

for preset in rig tip shaft bbp-fig2-force bbp-fig8-stiff kb-fig16 nayak-fig6 nayak-fig12 nayak-random shaft-fig13-18 shaft-fig16-687; do
    "$program" choose $preset --json "$out/json" >/dev/null 2>&1
    set -- $(/usr/bin/python3 -c '
import json, sys
c = json.load(open(sys.argv[1]))
k = c["choice"]
print(c["model"], k["method"], k["substeps"], k["tolerance"], c["cost"][0]["instructions_a_step"])' "$out/json")
    wanted=$5
    steps=$(LD_BIND_NOW=1 valgrind --tool=callgrind --callgrind-out-file="$out/calls" --toggle-collect='choose_one_steps*' \
        "$out/one" $preset "$1" "$2" "$3" "$4" 2>"$out/err")
    total=$(awk '/^(totals|summary):/ { print $2; exit }' "$out/calls")
    if awk -v t="${total:-0}" -v n="${steps:-1}" -v w="$wanted" 'BEGIN { r = t / n / w; exit !(r > 0.7 && r < 1.3) }'; then
        passed=$((passed + 1))
        word=ok
    else
        failed=$((failed + 1))
        word=FAIL
    fi
    awk -v t="${total:-0}" -v n="${steps:-1}" -v w="$wanted" -v s="$word" -v p="$preset $1 $2" \
        'BEGIN { printf "%-4s  %s: %.0f instructions a step, said %.0f, ratio %.2f\n", s, p, t / n, w, t / n / w }'
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
