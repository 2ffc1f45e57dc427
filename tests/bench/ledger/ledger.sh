#!/bin/bash
# ledger.sh - the rows of docs/img/ledger.csv: rules for the energy ledger, their error (build/ledger_rules) and
# their instructions a tick, counted by callgrind. LENGTHS=0: ticks of one length only. Needs valgrind. The rule
# all_forms has no instructions, for it computes its tables on the way.
program=${BUILD:-build}/ledger_rules
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
strip -g -o "$out/program" "$program" || exit 1 # valgrind 3.19 cannot read clang's debug information
"$program" >"$out/errors" || exit 1

# count SCENE LENGTH: lines "scene rule ticks instructions".
count() {
    LD_BIND_NOW=1 valgrind --tool=callgrind --callgrind-out-file="$out/calls" "$out/program" "$1" "$2" \
        >"$out/names" 2>"$out/valgrind.log" || { tail -n 1 "$out/valgrind.log" >&2 && return 1; }
    callgrind_annotate --inclusive=yes --threshold=100 "$out/calls" |
        awk 'NR == FNR { row[$1] = $2 " " $3 " " $4; ticks[$1] = $5; next }
             match($0, /:rule_[a-z0-9_]+/) && !/=>/ {
                 count = $1
                 gsub(",", "", count)
                 name = substr($0, RSTART + 1, RLENGTH - 1)
                 if (name in row) printf "%s %.0f\n", row[name], count / ticks[name] }' "$out/names" -
}

for scene in 0 1 2 3; do
    for length in ${LENGTHS:-0 1 2 3 4}; do
        count $scene "$length" || exit 1
    done
done >"$out/counts"
echo "scene,rule,ticks,error,instructions"
awk 'NR == FNR { count[$1, $2, $3] = $4; next }
     ($1, $2, $3) in count || $2 == "all_forms" {
         print $1 "," $2 "," $3 "," $4 "," count[$1, $2, $3] }' "$out/counts" "$out/errors"
