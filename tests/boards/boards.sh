#!/bin/bash
# boards.sh - the images of every board (linker/boards.mk) in QEMU: sizes, the same bits as on the host, faults, instructions, a session
# over the network and its replay, hostile frames; over CAN a session in lockstep. boards.sh [--bits] [BOARD...] ends with `N passed, N failed`.
# --bits: only the bits, all blocks on every board (make test-boards-bits). Without a board all: make test-boards.
set -u
unset MAKEFLAGS MFLAGS MAKELEVEL # what it builds is no part of the make that called it
out=$(mktemp -d) || exit 1
bits= # the emulator that runs beside the checks
# Only here: a child that is killed before it has become its command would clear up, too.
trap 'if [ "$BASHPID" = $$ ]; then kill $bits 2>/dev/null; rm -rf "$out"; fi' EXIT
passed=0
failed=0

verdict() { # ok|FAIL, text
    printf '%-4s  %s\n' "$1" "$2"
    if [ "$1" = ok ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

fact() { # a name in the board's block of linker/boards.mk
    sed -n "s/^$1 = //p" "$out/facts"
}

emulator() { # image, seconds, more options of QEMU: fills $command
    local image=$images/$1 seconds=$2
    shift 2
    # shellcheck disable=SC2206
    command=(timeout --foreground "$seconds" ${qemu/IMAGE/$image} -serial stdio -nic none "$@")
}

boot() { # as emulator; what it prints goes to $out/console, its exit status is returned
    emulator "$@"
    "${command[@]}" </dev/null >"$out/console" 2>"$out/errors"
}

# Every model and method (tests/bits/hash_run.h): begun, and judged when other checks have run beside it.
bits_begin() {
    emulator board_hash.elf 1800
    "${command[@]}" </dev/null >"$out/hash" 2>"$out/hash.errors" &
    bits=$!
}

bits_end() { # blocks; an image has no batches
    local status text
    wait "$bits"
    status=$?
    bits=
    if text=$(awk -v blocks="$1" -v unwanted=batch -f tests/bits/hash_compare.awk tests/data/hash.txt "$out/hash") && [ $status = 0 ]; then
        verdict ok "$board has the bits of the host: $text"
    else
        verdict FAIL "$board: $text, status $status $(head -n 1 "$out/hash.errors")"
    fi
}

all_bits() {
    local blocks=100
    make -s BOARD="$board" BLOCKS=$blocks "$images/board_hash.elf" >"$out/build" 2>&1
    bits_begin
    bits_end $blocks
}

# Instructions of pieces of work (tests/boards/board_cost.c): 1.024 us each on the emulator's clock. Budgets are for the compiler
# of Debian 12; a board without any only prints its counts.
cost() {
    local name got budget
    if ! boot board_cost.elf 600 -icount shift=10; then
        verdict FAIL "$board: board_cost.elf: $(tail -n 1 "$out/console") $(head -n 1 "$out/errors")"
        return
    fi
    while read -r name got; do
        budget=$(sed -n "s/^$board $name //p" tests/data/board_instructions.txt)
        if [ -z "$budget" ]; then
            echo "note  $board $name: $got instructions, no budget"
        elif awk "BEGIN { exit !($got > $budget) }"; then
            verdict FAIL "$board $name: $got instructions, budget $budget"
        else
            verdict ok "$board $name: $got instructions, budget $budget"
            awk "BEGIN { exit !($got < 0.9 * $budget) }" && echo "note  lower the budget of $name on $board"
        fi
    done <"$out/console"
}

# The sum of the deepest calls (make firmware) refuses what has no bound: board_fault.c digs on purpose.
recursion() {
    local text
    text=$(make -s BOARD="$board" IMAGE=board_fault.elf stack-depth 2>&1)
    if [ "${text#FAIL  recursion: dig}" != "$text" ]; then
        verdict ok "$board, recursion is refused: ${text%%$'\n'*}"
    else
        verdict FAIL "$board: recursion in board_fault.elf was not seen: $text"
    fi
}

# Virtual time that stands while the processor works and jumps while it sleeps: the same run every time.
lockstep="-icount shift=3,sleep=off"

# One line a restart: of the exception its cause and the file that its address is in, of the others neither.
faults() {
    local line expected at
    line=$(grep -n ' ASSERT(' tests/boards/board_fault.c | cut -d: -f1)
    expected="no fault|assert tests/boards/board_fault.c:$line|exception in board_fault.c cause $(fact FAULT_CAUSE)|stack|stack|$(fact FAULT_CLOCK)|"
    # shellcheck disable=SC2086
    boot board_fault.elf 120 $lockstep
    local status=$? got
    at=$("${cross}addr2line" -s -e "$images/board_fault.elf" "0x$(sed -n 's/.*exception at \(.*\) cause.*/\1/p' "$out/console")")
    got=$(sed -e 's/^last run ended: //' -e "s/exception at [0-9a-f]*/exception in ${at%:*}/" -e 's/ at .*//' "$out/console" | tr '\n' '|')
    if [ $status = 0 ] && [ "$got" = "$expected" ]; then
        verdict ok "$board restarts after each fault and tells it: $got"
    else
        verdict FAIL "$board: faults $got, expected $expected, status $status $(head -n 1 "$out/errors")"
    fi
}

# tests/boards/board_main.c: the image with troubles in its frames; what it says of the run before.
troubles() {
    local expected status got
    expected="stack|stack, starts since 2|assert tests/boards/board_main.c:$(grep -n 'ASSERT(ended' tests/boards/board_main.c | cut -d: -f1)|"
    case $(fact WATCHDOG) in
        cmsdk) expected='stack|stack, starts since 2|watchdog at|' ;;
        ?*) expected='stack|stack, starts since 2|watchdog|' ;;
    esac
    # shellcheck disable=SC2086
    boot board_main.elf 120 $lockstep $(fact WATCHDOG_DEVICE)
    status=$?
    got=$(sed -n -e 's/ at .*/ at/' -e 's/^last run ended: //p' "$out/console" | tr '\n' '|')
    if [ $status = 0 ] && [ "$got" = "$expected" ]; then
        verdict ok "$board image, a broken guard, a second fault, an acknowledged one, a hung frame: $got"
    else
        verdict FAIL "$board image: troubles $got, expected $expected, status $status $(head -n 1 "$out/errors")"
    fi
}

# tests/boards/board_watchdog.c: frames feed it, a sleep without end and hung programs do not; and periods that one interrupt stands for.
watchdog() {
    local expected='no fault|clock|watchdog|' status got
    [ "$(fact WATCHDOG)" = cmsdk ] && expected='no fault|clock at|watchdog at|watchdog|periods 5|'
    # Eight times slower a processor: it hangs and waits for seconds, which are as long and cost an eighth.
    # shellcheck disable=SC2046
    boot board_watchdog.elf 300 -icount shift=6,sleep=off $(fact WATCHDOG_DEVICE)
    status=$?
    got=$(sed -e 's/^last run ended: //' -e 's/ at .*/ at/' "$out/console" | tr '\n' '|')
    if [ $status = 0 ] && [ "$got" = "$expected" ]; then
        verdict ok "$board, the watchdog ends what hangs and nothing else: $got"
    else
        verdict FAIL "$board: watchdog $got, expected $expected, status $status $(head -n 1 "$out/errors")"
    fi
}

# A session over UDP through QEMU's user network, whose 10.0.2.2 is this machine's loopback. -icount ties the board's
# clock to its instructions, so that a slow machine makes it slow, not late.
over_udp() { # session|restarted, more options of QEMU
    local what=$1
    shift
    read -r plant controller <<<"$(build/test_board ports)"
    build/test_board network "$controller" >"$out/network"
    "${cross}objcopy" --update-section .network="$out/network" "$images/contactplant.elf" "$out/image.elf"
    drive "$what" "$out/image.elf" -nic "user,hostfwd=udp:127.0.0.1:$plant-10.0.2.15:20000" "$@"
}

tally() { # what: the lines of a test program in $out/session
    grep -E '^(ok|FAIL|note)' "$out/session" | sed "s/^\(....\)  /\1  $board $1: /"
    passed=$((passed + $(grep -c '^ok' "$out/session")))
    failed=$((failed + $(grep -c '^FAIL' "$out/session")))
    grep -qE '^[0-9]+ passed' "$out/session" || verdict FAIL "$board $1 did not end: $(tail -n 1 "$out/session")"
}

drive() { # session|restarted|hostile|preset, image, more options of QEMU
    local what=$1 image=$2
    shift 2
    # shellcheck disable=SC2086
    build/test_board "$what" "$substeps" "$plant" "$controller" "$out/board.log" "$out/console" \
        ${qemu/IMAGE/$image} -icount shift=1 -serial stdio "$@" >"$out/session" 2>&1
    tally "$method $what"
    sed 's/^/      console: /' "$out/console" | grep -v qemu | tail -n 2
}

# The log of the session on the host: every byte that the board sent, its hashes among them.
replay() {
    if build/contactplant replay "$out/board.log" --method "$method" --substeps "$substeps" >"$out/replay" 2>&1; then
        verdict ok "$board $method, replayed on the host: $(cat "$out/replay")"
    else
        verdict FAIL "$board $method, replayed on the host: $(head -n 1 "$out/replay")"
    fi
}

# One digit of a recorded hash is another: the replay must name that line, its frame and what stood there, and the plant's tick.
tampered() {
    local number stamp frame id_data
    number=$(grep -n " 21C#" "$out/board.log" | sed -n '50s/:.*//p')
    sed "${number}s/\(.*\)0\$/\11/; t; ${number}s/.\$/0/" "$out/board.log" >"$out/tampered.log"
    read -r stamp _ id_data <<<"$(sed -n "${number}p" "$out/tampered.log" | tr -d '().')"
    frame=$(((10#$stamp - 1000000) / 1000))
    build/contactplant replay "$out/tampered.log" --method "$method" --substeps "$substeps" >"$out/replay" 2>&1
    if grep -q "tampered.log:$number: frame $frame: recorded $id_data, replay sent 21C#.*plant tick" "$out/replay"; then
        verdict ok "$board $method, a changed digit is named: $(sed 's/.*tampered.log/line /' "$out/replay")"
    else
        verdict FAIL "$board $method, line $number frame $frame $id_data was changed: $(head -n 1 "$out/replay")"
    fi
}

# What the board's self-test told in the session: SELF_TEST, its fourth byte the verdict.
self_test() {
    local good bad
    good=$(grep ' 222#.\{6\}01' "$out/board.log" | sed 's/.* 222#....\(..\).*/\1/' | sort -u | wc -l)
    bad=$(grep -c ' 222#.\{6\}0[02]' "$out/board.log")
    if [ "$good" = 15 ] && [ "$bad" = 0 ]; then
        verdict ok "$board $method tells a self-test of $good checks, all passed"
    else
        verdict FAIL "$board $method tells a self-test of $good checks passed, wanted 15; failed or absent: $bad"
    fi
}

# With the board's own method, which stays in the image. It spins: a sleep in an emulator lasts as long as the host likes.
sessions() {
    method=$(fact METHOD)
    make -s BOARD="$board" METHOD="$method" WAIT=spin "$images/contactplant.elf" >"$out/build" 2>&1
    over_udp session
    replay
    tampered
    self_test
}

# A record in the memory that a restart keeps (fault_record of hal/board/board.c): begin, kind and end.
last_run() { # mark, kind
    local at
    at=0x$("${cross}nm" "$images/contactplant.elf" | grep ' fault_record$' | cut -d' ' -f1)
    echo -device "loader,addr=$at,data=$1,data-len=4" -device "loader,addr=$((at + 4)),data=$2,data-len=4" \
        -device "loader,addr=$((at + 68)),data=$1,data-len=4"
}

# A failed assertion, and a run under a watchdog that left no record of its own.
failed_run() {
    last_run 0xFA017EC0 1
}

watched_run() {
    last_run 0xD06D06E5 0
}

# An image that runs a preset, beside the host's run of the same scene.
preset() {
    local substeps=shaft-fig12 method=preset text
    if ! make -s BOARD="$board" SCENE="$substeps" WAIT=spin "$images/contactplant.elf" >"$out/build" 2>&1; then
        verdict FAIL "$board does not build with $substeps: $(head -n 1 "$out/build")"
        return
    fi
    over_udp preset
    if grep -q "^contactplant $board scene $substeps" "$out/console" &&
        build/contactplant replay "$out/board.log" "$substeps" >"$out/replay" 2>&1; then
        verdict ok "$board $substeps, replayed on the host: $(cat "$out/replay")"
    else
        verdict FAIL "$board $substeps, replayed on the host: $(head -n 1 "$out/replay") $(head -n 1 "$out/console")"
    fi
    text=$(make -s BOARD="$board" SCENE=shaft-fig1 firmware 2>&1)
    if [ "${text#*no scene \"shaft-fig1\"}" != "$text" ]; then
        verdict ok "$board, an unknown scene: $text"
    else
        verdict FAIL "$board, an unknown scene: $text"
    fi
    make -s BOARD="$board" METHOD="$(fact METHOD)" WAIT=spin "$images/contactplant.elf" >"$out/build" 2>&1 # for what follows
}

restarted() {
    # shellcheck disable=SC2046
    over_udp restarted $(watched_run)
}

# A wire of our own: QEMU's Ethernet frames in UDP packets.
hostile() {
    read -r plant controller <<<"$(build/test_board ports)"
    drive hostile "$images/contactplant.elf" -nic "socket,udp=127.0.0.1:$controller,localaddr=127.0.0.1:$plant"
}

# Both controllers of a board on one bus, a program on it that is plant and bench: its own checks, then a session, whose
# lines, a hash of all traffic among them, must be those of the same session on the host.
over_can() {
    local mark text status
    # shellcheck disable=SC2086
    boot board_can.elf 300 $lockstep
    status=$?
    while read -r mark text; do
        case $mark in ok | FAIL) verdict "$mark" "$board can: $text" ;; esac
    done < <(head -n 60 "$out/console") # a board that starts again and again fails once, not for two minutes
    build/can_session >"$out/host"
    grep -vE '^(ok|FAIL|note) ' "$out/console" >"$out/session"
    if [ $status = 0 ] && text=$(diff "$out/host" "$out/session"); then
        verdict ok "$board can: a session as on the host, $(tail -n 1 "$out/session")"
    else
        verdict FAIL "$board can: status $status, differs from the host: $(echo "$text" | head -n 4 | tr '\n' ' ')"
    fi
}

# The image itself and this program's client, over this machine's SocketCAN or that of a virtual machine. Exit status 3:
# frames were lost on the way, or the client fell silent, for want of time, and the run is repeated.
over_socketcan() { # options that tie the emulator's bus to vcan0
    rm -f "$out/session" "$out/realtime"
    # shellcheck disable=SC2086,SC2016
    CAN_VM_TIMEOUT=900 tests/can/can_vm.sh -- bash -c 'out=$1
        shift
        for i in 1 2 3; do
            build/test_board_can vcan0 "$out/console" "$@" >"$out/session" 2>&1
            [ $? = 3 ] || break
        done
        tests/trial/realtime_board.sh build vcan0 "$@" >"$out/realtime" 2>&1' bash "$out" \
        ${qemu/IMAGE/$images/contactplant.elf} -icount shift=3 -serial stdio $1
    tally socketcan
    mv "$out/realtime" "$out/session"
    tally "tests of a controller"
}

# The image by itself, until its console tells of this frame.
alone() { # what, frame, pattern of the console, more options of QEMU
    local what=$1 frame=$2 pattern=$3 pid
    shift 3
    # shellcheck disable=SC2086
    emulator contactplant.elf 300 $lockstep "$@"
    rm -f "$out/console" # of the last one: its frames are not ours
    "${command[@]}" </dev/null >"$out/console" 2>"$out/errors" &
    pid=$!
    until grep -q "^frame $frame " "$out/console" 2>/dev/null || ! kill -0 $pid 2>/dev/null; do
        sleep 0.1
    done
    kill $pid 2>/dev/null
    wait $pid
    if tr '\n' '|' <"$out/console" | grep -qE "$pattern"; then
        verdict ok "$board $what: $(grep "^frame $frame " "$out/console")"
    else
        verdict FAIL "$board $what: console $(tail -n 2 "$out/console" | tr '\n' '|'), expected $pattern"
    fi
}

make -s build/contactplant build/test_board build/test_board_can build/can_session >/dev/null || exit 1 # what speaks with a board
only_bits=
[ "${1:-}" = --bits ] && only_bits=yes && shift
for board in ${*:-$(make -s boards)}; do
    images=build/firmware/$board
    if ! make -s BOARD="$board" board-images >"$out/build" 2>&1; then
        verdict FAIL "$board does not build: $(grep -m 1 -iE 'error|not installed' "$out/build")"
        continue
    fi
    make -s BOARD="$board" board-facts >"$out/facts" # once: make takes a quarter of a second to read its files
    qemu=$(fact QEMU)
    cross=$(fact CROSS)
    substeps=$(fact SUBSTEPS)
    if ! command -v "${qemu%% *}" >/dev/null; then
        verdict FAIL "${qemu%% *} is not installed (apt-get install $(fact PACKAGES))"
        continue
    fi
    if [ -n "$only_bits" ]; then
        all_bits
        continue
    fi
    make -s BOARD="$board" firmware 2>&1 | tee "$out/sizes"
    passed=$((passed + $(grep -c '^ok' "$out/sizes")))
    failed=$((failed + $(grep -c '^FAIL' "$out/sizes")))
    bits_begin
    cost
    recursion
    faults
    troubles
    if [ "$(fact BUS)" = can ]; then
        over_can
        alone "keeps its pace" 1001 'frame 1001 state 0 faults 0 tick 0 missed 0 '
    else
        sessions
        [ "$board" != mps2-an500 ] || preset
        restarted
        hostile
    fi
    if [ -n "$(fact WATCHDOG)" ]; then
        watchdog
        # shellcheck disable=SC2046
        alone "feeds its watchdog" 3001 '^contact[^|]*.frame 1 .*frame 3001 state 0 faults 0 tick 0 missed 0 ' $(fact WATCHDOG_DEVICE)
    fi
    # shellcheck disable=SC2046
    alone "after a failed run" 1001 'last run ended: assert.*frame 1001 state 6 faults 64 ' $(failed_run)
    bits_end "$(fact BLOCKS)"
    [ -z "$(fact SOCKETCAN)" ] || over_socketcan "$(fact SOCKETCAN)" # in real time: by itself
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
