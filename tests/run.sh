#!/bin/bash
# run.sh [push|all] - what a push needs (make test), or every test (make test-all). Installs what is missing (Debian 12, as root).
# Last line: `N passed, N failed`. What a push needs does not depend on how busy the machine is: whatever keeps time on sockets is
# in `all`. The last line of `all` is kept in tests/data/test_all.txt, with commit and date.
#
# Each stage prints its own `ok` and `FAIL` lines with numbers; they are counted here. A stage that cannot run fails
# with the reason. Four run side by side, each into a file; the lines are printed in the stages' order. When nothing was
# printed for 15 seconds, a line says what runs.
cd "$(dirname "$0")/.." || exit 2
# Under nohup a test of SIGHUP would wait for ever: a signal that is ignored stays so in whatever is started.
[ -n "$hangup_set" ] || hangup_set=1 exec env --default-signal=HUP tests/run.sh "$@"
unset MAKEFLAGS MFLAGS MAKELEVEL # what it builds is no part of the make that called it
export WERROR=-Werror
wanted=${1:-push}
case $wanted in
    push) usual="3 to 6 minutes" seconds=build/test.seconds ;;
    all) usual="30 to 60 minutes" seconds=build/test-all.seconds ;;
    *) echo "usage: tests/run.sh [push|all]" && exit 2 ;;
esac
all() { [ "$wanted" = all ]; }
! all || export BLOCKS=30 # of 1000 ticks, of each trajectory on a board
kept=tests/data/test_all.txt
log=build/test.log
mkdir -p build
: >$log
stages=build/stages
rm -rf $stages
mkdir $stages

begun=$(date +%s)
spent() { # seconds in words
    echo "$(($1 / 60)) min $(($1 % 60)) s"
}
now() {
    spent $(($(date +%s) - begun))
}
last=$(cat $seconds 2>/dev/null)
what="what a push needs (make test-all: every test)"
all && what="every test"
if [ -n "$last" ]; then
    echo "$what: $(spent "$last") the last time here; the lines stand in $log, too"
else
    echo "$what: $usual on two cores; the lines stand in $log, too"
fi
echo "the last make test-all: $(cat $kept)"

# The stages that have begun and are not over; before the first one only packages are asked for.
running() {
    local i text=
    for i in $stages/*/; do
        [ -s "$i/name" ] && ! [ -s "$i/status" ] && text="$text, $(cat "$i/name")"
    done
    text=${text:-, apt-get update}
    echo "running: ${text#, }"
}
heartbeat() { # until the script is over: whenever nothing was printed for a while
    while sleep 5 && kill -0 $$ 2>/dev/null; do
        [ $(($(date +%s) - $(stat -c %Y $log))) -lt 15 ] && continue
        echo "      ... $(now); $(running)"
        touch $log
    done
}
set -m # a group of its own, so that its sleep ends with it
heartbeat &
heart=$!
set +m

need() { # command-or-file package
    command -v "$1" >/dev/null || [ -e "$1" ] || missing="$missing $2"
}
missing=
need gcc gcc
need clang clang
need clang-format clang-format
need /usr/bin/python3 python3
need /usr/lib/python3/dist-packages/can python3-can
need /usr/lib/python3/dist-packages/pytest python3-pytest
need arm-none-eabi-gcc gcc-arm-none-eabi
need qemu-system-arm qemu-system-arm
need g++ g++
need pkg-config pkg-config
need groff groff-base
need man man-db
need /usr/share/i18n/locales/de_DE locales
if all; then
    need linux.uml user-mode-linux
    need ip iproute2
    need candump can-utils
    need tshark tshark
    need valgrind valgrind
    need cppcheck cppcheck
    need frama-c frama-c-base
    need qemu-system-x86_64 qemu-system-x86
    need cpio cpio
    need riscv64-unknown-elf-gcc gcc-riscv64-unknown-elf
    need qemu-system-riscv64 qemu-system-misc
    need /usr/lib/python3/dist-packages/canmatrix python3-canmatrix
    need dpkg-shlibdeps dpkg-dev
    need lintian lintian
    need xmllint libxml2-utils
    need unzip unzip
    need cmake cmake
    need mandoc mandoc
    need /usr/lib/python3.11/ensurepip python3-venv
    need /usr/include/cvode/cvode.h libsundials-dev
    need /usr/include/gsl/gsl_odeiv2.h libgsl-dev
    need /usr/include/boost/numeric/odeint.hpp libboost-dev
    need gnuplot gnuplot-nox
    need chromium chromium
    need verilator verilator
    need gwyddion gwyddion
    need /usr/sbin/slurmctld slurm-wlm
    need /usr/sbin/munged munge
    need parallel parallel
    need /usr/lib/python3/dist-packages/scipy python3-scipy
    need /usr/lib/python3/dist-packages/lmfit python3-lmfit
    ls /usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.asan-x86_64.a >/dev/null 2>&1 || missing="$missing libclang-rt-14-dev"
fi
install=
if [ -n "$missing" ]; then
    echo "to be installed:$missing"
    if [ "$(id -u)" = 0 ]; then
        apt-get update -qq >build/install.log 2>&1
        apt-get install --assume-no --no-install-recommends $missing 2>/dev/null | grep -E '^(Need to get|After this)' | sed 's/^/      /'
        install=yes
    else
        echo "FAIL  not installed:$missing - run as root, or apt-get install them" | tee -a $log
    fi
fi
install_missing() {
    if DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >>build/install.log 2>&1; then
        echo "ok    installed:$missing"
    else
        tail -3 build/install.log
        echo "FAIL  installing$missing: see build/install.log"
    fi
}

# A stage: in which lane it runs, its name, a command; `more` ones are no part of a push. First gcc builds the program, while what is missing is installed. Then come
# all builds, both cores on one of them. Then four lanes: what keeps time on sockets, one stage after the other; nicer than that,
# what mostly waits for processes and browsers; and nicest, two lanes that compute. These two take the next stage that nobody has,
# so the long ones stand first.
name=()
command=()
first=()
build=()
speak=()
waits=()
compute=()
stage() { # first|build|speak|waits|compute, name, command
    local -n lane=$1
    lane+=(${#name[@]})
    name+=("$2")
    shift 2
    command+=("$(printf '%q ' "$@")")
}

more() {
    ! all || stage "$@"
}

# The stages of these numbers that nobody has begun, into files of their own.
work() {
    local i
    for i; do
        mkdir $stages/$i 2>/dev/null || continue
        echo "${name[i]}" >$stages/$i/name
        (
            exec >$stages/$i/out 2>&1 </dev/null
            echo $BASHPID >$stages/$i/pid
            time eval "${command[i]}"
            echo $? >$stages/$i/status
        )
    done
}

# One stage's lines, while it runs or when its turn has come. Sub-totals of the command are not counted twice.
show() { # stage, which one that is
    local pid status verdict
    echo "=== stage $2 of ${#name[@]}, $((${#name[@]} - $2)) left, $(now): ${name[$1]}"
    touch $log
    while ! [ -s $stages/$1/pid ] && kill -0 $lanes 2>/dev/null; do sleep 0.2; done
    pid=$(cat $stages/$1/pid 2>/dev/null) && tail -n +1 -f -s 0.2 --pid="$pid" $stages/$1/out |
        grep --line-buffered -vE '^[0-9]+ passed, [0-9]+ failed$' | tee -a $log
    status=$(cat $stages/$1/status 2>/dev/null)
    [ "$status" = 0 ] && return
    grep -q '^FAIL' $stages/$1/out 2>/dev/null && verdict="      " || verdict="FAIL  " # which its own line has said
    echo "$verdict${name[$1]}: exit status ${status:-none, it did not come to its end}" | tee -a $log
}

quiet_make() { # a build prints only when it fails
    local out
    if out=$(make "$@" 2>&1); then
        echo "ok    make $*"
    else
        echo "$out" | tail -30
        echo "FAIL  make $*"
    fi
}

whole() { # name, a unit test program and its options as one check: its failures, and whether it came to its end
    local out=$2.log
    "${@:2}" >$out 2>&1
    grep -A 3 '^FAIL' $out
    if grep -qE '^[0-9]+ passed, 0 failed$' $out; then
        echo "ok    $1: $(tail -1 $out)"
    else
        tail -5 $out
        echo "FAIL  $1: did not end with 0 failed"
    fi
}

judge_choose() { # scenes, seed
    quiet_make build/choose_scenes
    build/choose_scenes "$1" "$2" motion --random
}

judge_tolerance() { # scenes, seed
    quiet_make build/tolerance_scenes
    build/tolerance_scenes "$1" "$2" loose
}

judge_runner() {
    quiet_make build/runner_cases
    tests/house/test_runner.sh build/runner_cases
}

[ -z "$install" ] || stage first "installation" install_missing
stage first "build with gcc: the program and its unit tests" quiet_make all build/unit
more build "build with gcc: everything" quiet_make build-all
more build "build with clang, address and undefined sanitizers" quiet_make sanitized-targets \
    "TARGETS=build/asan/unit build/asan/contactplant build/asan/libcontactplant.a build/asan/flood build/asan/test_socketcan build/asan/hash_print"
stage compute "house" make -s check
stage waits "command line, processes, bad input" tests/cli/test_cli.sh build/contactplant
stage waits "Python: contactplant.py, with pytest and python-can" /usr/bin/python3 tests/library/test_python.py build
stage waits "lockstep between processes" /usr/bin/python3 tests/cli/test_lockstep.py build/contactplant
stage waits "blocks of converter codes over UDP" /usr/bin/python3 tests/cli/test_blocks.py build/contactplant
more speak "blocks of converter codes in real time" /usr/bin/python3 tests/cli/test_blocks.py build/contactplant --realtime
stage waits "many plants on one bus" /usr/bin/python3 tests/cli/test_plants.py build/contactplant
stage waits "names and texts in JSON, XML and reports" /usr/bin/python3 tests/cli/test_texts.py build
stage waits "numbers from one command to the next, times, tolerances" /usr/bin/python3 tests/cli/test_numbers.py build/contactplant
stage waits "logs of the world outside, and ours in other tools" /usr/bin/python3 tests/cli/test_logs.py build/contactplant
more speak "rows of a plant: monitor, decode, run --json" /usr/bin/python3 tests/cli/test_rows.py build/contactplant
stage waits "no internal value in what any subcommand prints or writes" /usr/bin/python3 tests/cli/test_outputs.py build/contactplant
stage waits "numbers of a scene from measured curves" /usr/bin/python3 tests/cli/test_fit.py build/contactplant $(all && echo --all)
stage waits "help: pages, searches, what to do about errors" /usr/bin/python3 tests/cli/test_help.py build/contactplant
stage waits "outputs and inputs of every command" /usr/bin/python3 tests/cli/test_files.py build/contactplant
stage waits "recorded logs in the scope: rows, gaps, events, bad input" /usr/bin/python3 tests/scope/test_view.py build/contactplant
more speak "the scope under the sanitizers: rows, bad requests, slow browsers" /usr/bin/python3 tests/scope/test_scope.py build/asan/contactplant
more waits "the scope's page in Chromium" /usr/bin/python3 tests/scope/test_page.py build/contactplant
more compute "a recorded log of 1 GB: memory, and values equal to those of decode" /usr/bin/python3 tests/scope/test_view_long.py build/contactplant
more waits "recorded logs in Chromium" /usr/bin/python3 tests/scope/test_view_page.py build/contactplant
more waits "reports in Chromium" /usr/bin/python3 tests/scope/test_report.py build/contactplant
stage waits "tests of controllers" /usr/bin/python3 tests/trial/test_trial.py build
stage waits "requirements of tests, shares of a scheduler" tests/trial/test_requirements.py build/contactplant
stage waits "shares of maps and tests, merged" /usr/bin/python3 tests/cli/test_merge.py build/contactplant
stage waits "tests of controllers that harm their bench" /usr/bin/python3 tests/trial/test_bench.py build
stage waits "tests of a microscope's loops" /usr/bin/python3 tests/trial/test_afm.py build
more waits "example controllers: bad links, two compilers, a stop" /usr/bin/python3 tests/trial/test_seeds.py build build/asan 4 2
more speak "tests of controllers in real time" /usr/bin/python3 tests/trial/test_realtime.py build
more speak "what only has to run: benchmarks, charts, papers, maps, fuzz and soak, in short" make -s short
more speak "a flood on loopback UDP" build/flood check udp
more speak "SocketCAN on a real kernel" make -s test-can
more speak "board riscv-virt in QEMU" tests/boards/boards.sh riscv-virt
# By clang, too: that clang's other levels compute the same is what the bits say.
more compute "unit tests under the sanitizers" whole "sanitizers" build/asan/unit
stage compute "unit tests" build/unit --jobs 1
stage compute "the code is that of the proofs by Eva" make -s -k eva-checksums
more compute "proofs by Eva: the short ones" make -s eva-drive eva-elementary
more compute "tarball and Debian packages, in a root with compilers alone" tests/library/test_package.sh build
if all; then
    stage compute "the same bits from every compiler and level" tests/bits/test_bits.sh
else
    stage compute "the same bits from gcc and clang" tests/bits/test_bits.sh --made
fi
more compute "MISRA rules" make -s misra
more compute "jumps of every preset by three grids" make -s sweep-grids
more compute "two SJA1000 under Linux's driver, with sanitizers" make -s test-can-vm
more compute "FMUs of every scene, their sources, an importer" tests/fmi/test_fmi.sh build
if all; then
    stage compute "certificates of 363 scenes" build/choose_scenes 360 2 motion
    stage compute "certificates of 100 scenes of this day" build/choose_scenes 100 "$(date +%Y%m%d)" motion --random
else
    stage compute "certificates of 20 scenes" judge_choose 20 2
fi
more compute "tolerances of 546 scenes by auto" build/tolerance_scenes 546 1
if all; then
    stage compute "loose tolerances of 1000 scenes by auto" build/tolerance_scenes 1000 1 loose
else
    stage compute "loose tolerances of 65 scenes by auto" judge_tolerance 65 1
fi
more compute "certificates of 30 random levers, judged by another integrator" build/choose_levers 30 1
more compute "board mps2-an386 in QEMU" tests/boards/boards.sh mps2-an386
more compute "board mps2-an500 in QEMU" tests/boards/boards.sh mps2-an500
stage compute "the library: installed, a user's own programs, an older client" tests/library/test_library.sh build
stage compute "board xlnx-zcu102-r5 in QEMU" tests/boards/boards.sh xlnx-zcu102-r5
stage compute "the Makefile: flags, warnings, help" tests/house/test_make.sh
stage compute "the test runner, with tests that fail" judge_runner
more compute "fuzz corpus under the sanitizers" make -s fuzz-corpus
more compute "a wheel, in a virtual environment" tests/library/test_wheel.sh build
more compute "the library by find_package of CMake" tests/library/test_cmake.sh build
more compute "a PLL in Verilog on the microscope" tests/verilog/test_verilog.sh build
more compute "instructions within their budgets" tests/bench/cost/test_instructions.sh
more compute "a new model in a file pair and a row" tests/new_model/new_model.sh
more compute "the hardest ticks, far from every bound" build/worst
more compute "shares on a real Slurm, and by GNU parallel" /usr/bin/python3 tests/cli/test_slurm.py build/contactplant
more compute "logs and messages in Wireshark" /usr/bin/python3 tests/cli/test_wireshark.py build/contactplant
more compute "images of the microscope in Gwyddion" /usr/bin/python3 tests/cli/test_gwyddion.py build/contactplant
more compute "the .dbc read by canmatrix" /usr/bin/python3 tests/cli/test_dbc.py build/dbc_vectors docs/reference/contactplant.dbc \
    docs/reference/protocol.md docs/reference/message_tables.md docs/reference/numbers.md docs/reference/settings.md
stage compute "the committed .dbc is what the program prints" sh -c '
    build/contactplant dbc | cmp - docs/reference/contactplant.dbc && echo "ok    docs/reference/contactplant.dbc"'
more compute "cheaper combinations that choose missed, by brute force" build/choose_grid 30 5 motion
more compute "fits of 200 noises and 100 random rigs" /usr/bin/python3 tests/fit/judge_fits.py build/contactplant build/rig_curves 200 100 0 build/asan/contactplant
more compute "fits of 30 random levers" /usr/bin/python3 tests/fit/judge_levers.py build/contactplant 30
more compute "fits beside scipy's and lmfit's" /usr/bin/python3 tests/fit/other_fits.py build/contactplant docs/examples/fit
more compute "costs that choose states, against whole runs" tests/choose/test_choose_cost.sh build/contactplant build/choose_one
more compute "mutants that are listed as equivalent are mutants" sh -c 'tests/house/mutate.py --list >build/mutants.txt || { cat build/mutants.txt; exit 1; }'

TIMEFORMAT='      %R s, of processor time %U s and %S s'
lanes=
trap 'for lane in $lanes; do kill -- -$lane 2>/dev/null; done; kill $! -- -$heart 2>/dev/null; exit 130' INT TERM
work_nicely() { # how nice, stages
    renice -n "$1" $BASHPID >/dev/null 2>&1 # where this whole run is nicer than that, it stays so
    work "${@:2}"
}
begin() { # work or work_nicely, stages: a lane, in a group of its own: an interrupt ends whatever runs in it
    set -m
    "$@" &
    lanes="$lanes $!"
    set +m
}
print() {
    local i
    for i; do
        shown=$((shown + 1))
        show "$i" $shown &
        wait $!
    done
}
shown=0
begin work "${first[@]}"
! command -v gcc >/dev/null || begin work "${first[@]}"
print "${first[@]}"
begin work "${build[@]}"
print "${build[@]}"
begin work "${speak[@]}"
begin work_nicely 5 "${waits[@]}"
begin work_nicely 10 "${compute[@]}"
begin work_nicely 10 "${compute[@]}"
print $(printf '%s\n' "${speak[@]}" "${waits[@]}" "${compute[@]}" | sort -n)

kill -- -$heart
echo $(($(date +%s) - begun)) >$seconds
echo "      all stages: $(now)"
passed=$(grep -c '^ok  ' $log)
failed=$(grep -c '^FAIL' $log)
if all; then
    commit=$(git describe --always --dirty 2>/dev/null || echo "no git repository")
    echo "$passed passed, $failed failed; $commit, $(date -u +%F), $(now)" >$kept
fi
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
