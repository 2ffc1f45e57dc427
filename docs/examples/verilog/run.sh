#!/bin/sh
# run.sh [FOLDER] - builds the PLL of afm_pll.v with the microscope of libcontactplant by Verilator, in FOLDER (build_verilog here), and
# runs it. It needs verilator, a C++ compiler, and an installed contactplant: `make install`, or the Debian package
# libcontactplant-dev. Elsewhere say where it is: CONTACTPLANT_CFLAGS=-I.. CONTACTPLANT_LIBS=".. -lm" ./run.sh
here=$(cd "$(dirname "$0")" && pwd)
out=${1:-build_verilog}
need() { # COMMAND PACKAGE
    command -v "$1" >/dev/null && return
    echo "run.sh: $1 is missing; on Debian: apt-get install $2" >&2
    exit 2
}
need verilator verilator
need c++ g++
if [ -z "$CONTACTPLANT_LIBS" ]; then
    need pkg-config pkg-config
    if ! pkg-config --exists contactplant; then
        echo "run.sh: pkg-config knows no contactplant; install it (make install), or set PKG_CONFIG_PATH to the folder of contactplant.pc" >&2
        exit 2
    fi
    CONTACTPLANT_CFLAGS=$(pkg-config --cflags contactplant)
    CONTACTPLANT_LIBS=$(pkg-config --libs contactplant)
fi
mkdir -p "$out" || exit 2
if ! verilator -Wall -Wno-fatal -Wno-WIDTH -Wno-DECLFILENAME -Wno-UNUSED --cc --exe --build --Mdir "$out" -O3 \
    -CFLAGS "-O2 $CONTACTPLANT_CFLAGS" -LDFLAGS "$CONTACTPLANT_LIBS" "$here/afm_pll.v" "$here/afm_pll.cpp" >"$out/build.log" 2>&1; then
    tail -n 5 "$out/build.log" >&2
    echo "run.sh: the build failed; all its lines are in $out/build.log" >&2
    exit 1
fi
"$out/Vafm_pll"
