#!/bin/bash
# first_rows.sh PROGRAM CSV - a program that prints a chart's CSV, for a second of processor time or more: its rows must have the
# header and the number of columns of CSV, the committed one, of which a fifth goes to build/short to draw the chart from. Where none is
# committed the chart is drawn from the rows themselves; CSV `-`: the program prints numbers to standard error.
program=$1
csv=$2
name=$(basename "$program")
new=build/short/$name.csv
printed=$new
[ "$csv" != - ] || printed=build/short/$name.txt
mkdir -p build/short "build/short/$(dirname "$csv")"
begin() { # seconds; a slow machine needs more of them for the first rows
    (
        ulimit -S -t "$1"
        exec stdbuf -oL -eL "$program" >"$new" 2>"build/short/$name.txt"
    )
    status=$?
}
for seconds in 1 4 20; do
    begin $seconds 2>/dev/null # where bash itself tells of the limit
    [ $status = 0 ] || [ "$(wc -l <"$printed")" -gt 4 ] && break
done
[ $status = 0 ] || [ $status = 152 ] || # 128 and SIGXCPU
    { tail -3 "build/short/$name.txt"; echo "FAIL  $name: exit status $status"; exit 1; }
if [ "$csv" = - ]; then
    rows=$(grep -cE ' -?[0-9.]+(e[-+]?[0-9]+)?$' "build/short/$name.txt")
    [ "$rows" -ge 3 ] && echo "ok    $name: $rows numbers" && exit 0
    echo "FAIL  $name: $rows numbers"
    exit 1
fi
[ $status = 0 ] || sed -i '$d' "$new" # cut off
if [ -e "$csv" ]; then
    awk 'NF == 0 || NR % 5 == 1' "$csv" >"build/short/$csv"
    header=$(head -n 1 "$csv")
else
    cp "$new" "build/short/$csv"
    header=$(head -n 1 "$new")
fi
awk -F , -v name="$name" -v header="$header" '
    NR == 1 { columns = NF; if ($0 != header) wrong = "its header is " $0 ", not " header; next }
    NF == 0 { next }
    { rows++ }
    NF < columns || $NF !~ /^(-?(inf|[0-9.]+(e[-+]?[0-9]+)?)|)$/ { wrong = "row " NR ": " $0 }
    END {
        if (rows < 3) wrong = rows + 0 " rows"
        print (wrong ? "FAIL  " name ": " wrong : "ok    " name ": " rows " rows")
        exit wrong != ""
    }' "$new"
