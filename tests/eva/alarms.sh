#!/bin/sh
# alarms.sh NAME LOG - what Eva said about one harness: its alarms, and `ok` when there is none and it came to its end.
functions=$(sed -n 's/^ *\([0-9]*\) functions analyzed.*/\1/p' "$2")
if [ -z "$functions" ]; then
    tail -5 "$2"
    echo "FAIL  eva $1: the analysis did not end"
    exit 1
fi
if ! grep -q '0 alarms generated' "$2" || grep -q 'got status \(invalid\|unknown\)' "$2"; then
    grep -A 2 -E ':alarm\]|got status (invalid|unknown)' "$2"
    echo "FAIL  eva $1: alarms"
    exit 1
fi
echo "ok    eva $1: no alarm in $functions functions"
