#!/bin/bash
# boards.sh - the images of every board (linker/boards.mk) in QEMU: sizes, the same bits as on the host, faults. Run from
# the project's top folder after make; ends with `N passed, N failed`.
set -u
out=$(mktemp -d) || exit 1
emulator=
trap 'stop; rm -rf "$out"' EXIT
passed=0
failed=0

verdict() { # ok|FAIL, text
    printf '%-4s  %s\n' "$1" "$2"
    if [ "$1" = ok ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

stop() {
    [ -n "$emulator" ] && kill "$emulator" 2>/dev/null && wait "$emulator" 2>/dev/null
    emulator=
}

boot() { # image, seconds; what it prints goes to $out/console, its exit status is returned
    # shellcheck disable=SC2086
    timeout "$2" $qemu -serial stdio -nic none -kernel "$images/$1" </dev/null >"$out/console" 2>"$out/errors"
}

bits() {
    boot board_hash.elf 120
    local status=$?
    while read -r line; do
        if grep -qxF "$line" "$out/console"; then
            verdict ok "$board has the bits of the host: $line"
        else
            verdict FAIL "$board: golden $line, board $(grep "^${line%% *} " "$out/console"), status $status $(head -n 1 "$out/errors")"
        fi
    done <tests/data/hash.txt
}

# One line a restart, the address and cause of the exception left out.
faults() {
    local expected="no fault|assert tests/board_fault.c:$(grep -n ' ASSERT(' tests/board_fault.c | cut -d: -f1)|exception|stack|stack|"
    boot board_fault.elf 20
    local status=$? got
    got=$(sed -e 's/^last run ended: //' -e 's/ at .*//' "$out/console" | tr '\n' '|')
    if [ $status = 0 ] && [ "$got" = "$expected" ]; then
        verdict ok "$board restarts after each fault and tells it: $got"
    else
        verdict FAIL "$board: faults $got, expected $expected, status $status $(head -n 1 "$out/errors")"
    fi
}

for board in $(make -s boards); do
    images=build/firmware/$board
    if ! make -s -j2 BOARD="$board" board-images >"$out/build" 2>&1; then
        verdict FAIL "$board does not build: $(grep -m 1 -iE 'error|not found' "$out/build")"
        continue
    fi
    qemu=$(make -s BOARD="$board" board-qemu)
    if ! command -v "${qemu%% *}" >/dev/null; then
        verdict FAIL "${qemu%% *} is not installed (apt-get install qemu-system-arm)"
        continue
    fi
    make -s BOARD="$board" firmware | tee "$out/sizes"
    passed=$((passed + $(grep -c '^ok' "$out/sizes")))
    failed=$((failed + $(grep -c '^FAIL' "$out/sizes")))
    bits
    faults
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
