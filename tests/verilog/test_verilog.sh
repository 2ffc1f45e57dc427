#!/bin/bash
# test_verilog.sh BUILD - the installed example of a PLL in Verilog: it locks as closed forms say, and says what it needs.
# Prints one line a check and `N passed, N failed` at the end.
set -u
example=docs/examples/verilog/run.sh
lines=$(CONTACTPLANT_CFLAGS=-I$PWD/host_sim/library CONTACTPLANT_LIBS="$PWD/$1/libcontactplant.a -lm" $example "$1/verilog" 2>&1) ||
    lines="$lines
FAIL  $example ended with status $?"
bare=$(mktemp -d)
ln -s "$(command -v sh)" "$(command -v dirname)" "$bare"
said=$(PATH=$bare $example "$1/verilog" 2>&1)
status=$?
case $status:$said in
    2:*"verilator is missing"*"apt-get install verilator"*) lines="$lines
ok    without verilator: $said" ;;
    *) lines="$lines
FAIL  without verilator: status $status, $said" ;;
esac
rm -r "$bare"
echo "$lines"
failed=$(echo "$lines" | grep -c '^FAIL')
echo "$(echo "$lines" | grep -c '^ok') passed, $failed failed"
[ "$failed" = 0 ]
