#!/bin/sh
# check_built.sh BUILD - after make build-all: each C and C++ source of the tree was compiled, for this machine, a board or as a
# fuzz target. Those of the emulated machines are compiled by the scripts that boot them, a clock for one test by that test, the client of a Verilog PLL by its own.
build=$1
missing=
n=0
together=$(find "$build" "$build"/asan -path "$build"/alone -prune -o \( -name room.d -o -name lib.d \) -exec cat {} + |
    tr -d '\\' | tr '\n' ' ')
for source in $(find models firmware hal host_sim linker tests -name '*.c' -o -name '*.cpp' | sort); do
    object=${source%.c*}.o
    n=$((n + 1))
    case $source in tests/eva/* | tests/can/uml_shim.c | tests/cli/clock_shim.c | tests/can/vm_init.c) continue ;; esac
    case " $together " in *" $source "*) continue ;; esac
    for room in "$build" "$build"/firmware/* build/asan; do [ -e "$room/$object" ] && continue 2; done
    missing="$missing $source"
done
[ -z "$missing" ] && echo "ok    make build-all: each of $n sources is part of a program" && exit 0
echo "FAIL  make build-all leaves out:$missing"
exit 1
