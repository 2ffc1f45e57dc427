#!/bin/bash
# test_verilog.sh BUILD - a PLL in Verilog against the microscope of libcontactplant.a, by Verilator.
# Prints one line a check and `N passed, N failed` at the end.
set -u
out=$1/verilog
mkdir -p "$out"
lines=$(verilator -Wall -Wno-fatal -Wno-WIDTH -Wno-DECLFILENAME -Wno-UNUSED --cc --exe --build --Mdir "$out" -O3 -CFLAGS "-O2 -I$PWD/host_sim/library" \
    -LDFLAGS "$PWD/$1/libcontactplant.a -lm" tests/verilog/afm_pll.v "$PWD/tests/verilog/afm_pll.cpp" 2>&1)
if [ $? = 0 ]; then
    lines="ok    verilator builds it
$("$out/Vafm_pll")"
else
    lines="$(echo "$lines" | tail -n 5)
FAIL  verilator does not build it"
fi
echo "$lines"
failed=$(echo "$lines" | grep -c '^FAIL')
echo "$(echo "$lines" | grep -c '^ok') passed, $failed failed"
[ "$failed" = 0 ]
