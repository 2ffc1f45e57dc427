#!/bin/sh
# bench_lockstep.sh [PROGRAM] [BENCH] [EXCHANGES] - words a second over UDP on loopback beside run --lockstep, from C, from Python
# and by contactplant control, all on one processor. Prints numbers; fails only where a controller or the plant does.
program=${1:-build/contactplant}
bench=${2:-build/bench_lockstep}
n=${3:-200000}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
port=$((23000 + $$ % 20000))
failed=0
cpu=$(taskset -cp $$ | sed 's/.*: *\([0-9]*\).*/\1/') # the first that is allowed
taskset -cp "$cpu" $$ >"$dir/cpu" || exit 1
beside() { # NAME COMMAND..: the command beside a plant that is begun anew
    echo "--- $1"
    shift
    "$program" run --lockstep --bus udp:$port --peer 127.0.0.1:$((port + 1)) >"$dir/run" 2>"$dir/err" &
    plant=$!
    "$@" || { failed=1; echo "FAIL  its exit status is not 0"; }
    kill -INT $plant
    wait $plant || { failed=1; echo "FAIL  the plant: $(cat "$dir/err")"; }
    grep -E '^(frames|compute per)' "$dir/run"
}
beside "C, plain sockets" "$bench" $((port + 1)) $port $n
beside "Python, plain sockets" /usr/bin/python3 tests/cli/lockstep_client.py $((port + 1)) $port $((n / 4))
beside "contactplant control --lockstep" "$program" control --lockstep --bus udp:$((port + 1)) --peer 127.0.0.1:$port \
    --duration $((n / 1000))
exit $failed
