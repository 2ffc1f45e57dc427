#!/bin/bash
# run.sh - every test. Installs what is missing (Debian 12, as root). Last line: `N passed, N failed`.
#
# Each step prints its own `ok` and `FAIL` lines with numbers; they are counted here. A step that cannot run fails
# with the reason.
cd "$(dirname "$0")/.." || exit 2
log=build/test.log
mkdir -p build
: >$log

need() { # command-or-file package
    command -v "$1" >/dev/null || [ -e "$1" ] || missing="$missing $2"
}
missing=
need gcc gcc
need clang clang
need clang-format clang-format
need /usr/bin/python3 python3
need linux.uml user-mode-linux
need ip iproute2
need candump can-utils
need /usr/lib/python3/dist-packages/can python3-can
need valgrind valgrind
need cppcheck cppcheck
need frama-c frama-c-base
need arm-none-eabi-gcc gcc-arm-none-eabi
need qemu-system-arm qemu-system-arm
need qemu-system-x86_64 qemu-system-x86
need cpio cpio
need riscv64-unknown-elf-gcc gcc-riscv64-unknown-elf
need qemu-system-riscv64 qemu-system-misc
need /usr/lib/python3/dist-packages/canmatrix python3-canmatrix
ls /usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.asan-x86_64.a >/dev/null 2>&1 || missing="$missing libclang-rt-14-dev"
if [ -n "$missing" ]; then
    echo "installing:$missing"
    if [ "$(id -u)" = 0 ]; then
        (apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing) \
            >build/install.log 2>&1 || echo "FAIL  installing$missing: see build/install.log" | tee -a $log
    else
        echo "FAIL  not installed:$missing - run as root, or apt-get install them" | tee -a $log
    fi
fi

# One step: its name, then a command. Sub-totals of the command are not counted twice.
step() {
    local name=$1
    shift
    echo "=== $name"
    "$@" 2>&1 | grep -vE '^[0-9]+ passed, [0-9]+ failed$' | tee -a $log
    local status=${PIPESTATUS[0]}
    [ "$status" = 0 ] || echo "FAIL  $name: exit status $status" | tee -a $log
}
quiet_make() { # a build prints only when it fails
    local out
    if out=$(make -j2 "$@" 2>&1); then
        echo "ok    make $*"
    else
        echo "$out" | tail -30
        echo "FAIL  make $*"
    fi
}

whole() { # a unit test program as one check: its failures, and whether it came to its end
    local out=build/whole.log
    "$2" >$out 2>&1
    grep FAIL $out
    if grep -qE '^[0-9]+ passed, 0 failed$' $out; then
        echo "ok    $1: $(tail -1 $out)"
    else
        tail -5 $out
        echo "FAIL  $1: did not end with 0 failed"
    fi
}

step "build with gcc" quiet_make all build/unit build/sizes build/dbc_vectors build/example_embed build/test_socketcan build/flood \
    build/worst build/choose_scenes build/choose_grid build/choose_one
step "build with clang" quiet_make CC=clang BUILD=build/clang all build/clang/unit
step "house" make -s check
step "MISRA rules" make -s misra
step "proofs by Eva" make -s -k -j2 eva-quick
step "unit tests" build/unit
step "unit tests built by clang" whole "clang -O2" build/clang/unit
step "build with clang, address and undefined sanitizers" quiet_make CC=clang OPT=-O1 BUILD=build/asan \
    "EXTRA=-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all" build/asan/unit build/asan/contactplant build/asan/flood build/asan/test_socketcan
step "unit tests under the sanitizers" whole "sanitizers" build/asan/unit
step "fuzz corpus under the sanitizers" make -s fuzz-corpus
step "a user's own unit test" build/example_embed
step "the same bits from every compiler and level" tests/test_bits.sh
step "instructions within their budgets" tests/test_instructions.sh
step "the hardest ticks, far from every bound" build/worst
step "the .dbc read by canmatrix" /usr/bin/python3 tests/test_dbc.py build/dbc_vectors docs/contactplant.dbc docs/PROTOCOL.md
step "the committed .dbc is what the program prints" sh -c '
    build/contactplant dbc | cmp - docs/contactplant.dbc && echo "ok    docs/contactplant.dbc"'
step "command line, processes, bad input" tests/test_cli.sh build/contactplant
step "certificates of 363 scenes" build/choose_scenes 360 2 motion
step "cheaper combinations that choose missed, by brute force" build/choose_grid 30 5 motion
step "costs that choose states, against whole runs" tests/test_choose_cost.sh build/contactplant build/choose_one
step "a flood on loopback UDP" build/flood check udp
step "boards in QEMU" make -s test-boards
step "SocketCAN on a real kernel" make -s test-can
step "two SJA1000 under Linux's driver, with sanitizers" make -s test-can-vm

passed=$(grep -c '^ok  ' $log)
failed=$(grep -c '^FAIL' $log)
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
