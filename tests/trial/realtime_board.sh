#!/bin/bash
# realtime_board.sh BUILD INTERFACE EMULATOR... - test_realtime.py against the board's image in an emulator on this CAN interface.
#
# Run where SocketCAN is: tests/can/can_vm.sh -- tests/trial/realtime_board.sh build vcan0 qemu-system-riscv64 ...
build=$1 interface=$2
shift 2
"$@" </dev/null >"${TMPDIR:-/tmp}/board_console.$$" 2>&1 &
board=$!
trap 'kill $board 2>/dev/null; rm -f "${TMPDIR:-/tmp}/board_console.$$"' EXIT
/usr/bin/python3 tests/trial/test_realtime.py "$build" "can:$interface" 1000 64
