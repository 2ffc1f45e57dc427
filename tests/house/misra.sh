#!/bin/bash
# misra.sh BUILD - the MISRA C:2012 rules that cppcheck's addon reports for the core, hal.h, the network and the CAN drivers, counted, against the table of
# docs/why/deviations.md: a rule outside it is a failure. With --where also file and line of each report. The addon knows the rules
# by number only; their texts are not free.
build=$1
where=$2
cd "$(dirname "$0")/../.." || exit 2
top=$PWD
out=$(realpath -m "$build/misra/reports")
rm -rf "$build/misra"
mkdir -p "$build/misra"
# In a copy: cppcheck writes what it has read beside each source.
cp -r models firmware hal "$build/misra"
(cd "$build/misra" && cppcheck -q --std=c99 --platform=unix64 -I. --dump firmware models hal/hal.h \
    hal/ethernet/{net,ipv4,lan9118}.c hal/link/cannelloni.c hal/device/registers.c hal/can/{can,sja1000,kvaser_pci,xilinx_can}.c >/dev/null 2>&1 &&
    /usr/bin/python3 "$top/tests/house/misra_reports.py" $(find . -name '*.dump' -printf '%P\n' | LC_ALL=C sort) | sort -u -V >"$out")
[ -s "$out" ] || { echo "FAIL  cppcheck reports nothing at all: is its addon misra.py installed?"; exit 1; }
[ -z "$where" ] || cat "$out"
rules=$(awk '{print $1}' "$out" | uniq -c | awk '{printf "%s (%d) ", $2, $1}')
echo "      rule (places): $rules"
outside=$(awk '{print $1}' "$out" | uniq | while read -r rule; do grep -qE "^\| $rule \|" docs/why/deviations.md || echo "$rule"; done)
if [ -n "$outside" ]; then
    for rule in $outside; do echo "FAIL  MISRA C:2012 rule $rule is not in docs/why/deviations.md: $(grep -m 3 "^$rule " "$out" | cut -d' ' -f2 | tr '\n' ' ')"; done
    exit 1
fi
echo "ok    $(awk '{print $1}' "$out" | uniq | wc -l) MISRA C:2012 rules are reported, each is in docs/why/deviations.md"
