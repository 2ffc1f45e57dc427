#!/bin/sh
# The proof of "no heap, no stdio, no libm": what the core's objects need from outside, against an allow-list.
# usage: check_symbols.sh NM OBJECT...
nm=$1
shift
# _GLOBAL_OFFSET_TABLE_ is the linker's, for tables in position-independent code.
allowed='^(_GLOBAL_OFFSET_TABLE_|sqrt|fabs|memcpy|memset|memmove|check_failed|__stack_chk_fail|__aeabi_.*|__(u)?(div|mod|mul).*|__.*(di|df|sf|si))$'
defined=$($nm -g --defined-only "$@" | awk 'NF == 3 {print $3}' | sort -u)
needed=$($nm -u "$@" | awk '$1 == "U" {print $2}' | sort -u)
outside=$(printf '%s\n' "$needed" | grep -vxF "$defined")
bad=$(printf '%s\n' "$outside" | grep -vE "$allowed")
# .data.rel.ro is constant: tables of pointers, relocated before the program starts
writable=$(size -A "$@" | awk '$1 ~ /^\.(data|bss)(\.|$)/ && $1 !~ /^\.data\.rel\.ro/ {n += $2} END {print n + 0}')
status=0
if [ -n "$bad" ]; then
    echo "FAIL  the core needs: $(echo $bad)"
    status=1
else
    echo "ok    the core needs only: $(echo $outside)"
fi
if [ "$writable" != 0 ]; then
    echo "FAIL  writable data in the core, $writable bytes: state belongs to the caller"
    status=1
else
    echo "ok    the core has no writable data"
fi
exit $status
