#!/bin/sh
# bench_lockstep.sh [PROGRAM] [BENCH] [EXCHANGES] - words a second beside run --lockstep: through memory and over UDP on loopback,
# from C, from Python and by contactplant control, on one processor; through memory on all of them, too. Prints numbers; fails only where a controller or the plant does.
program=${1:-build/contactplant}
bench=${2:-build/bench_lockstep}
n=${3:-200000}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
port=$((23000 + $$ % 20000))
failed=0
all=$(taskset -cp $$ | sed 's/.*: *//')
cpu=$(taskset -cp $$ | sed 's/.*: *\([0-9]*\).*/\1/') # the first that is allowed
taskset -cp "$cpu" $$ >"$dir/cpu" || exit 1
bus="--bus udp:$port --peer 127.0.0.1:$((port + 1))"
beside() { # NAME COMMAND..: the command beside a plant that is begun anew
    echo "--- $1"
    shift
    "$program" run --lockstep $bus >"$dir/run" 2>"$dir/err" &
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
bus="--bus memory:$dir/rig"
beside "C, memory" "$bench" "$dir/rig" $n
taskset -cp "$all" $$ >"$dir/cpu" || exit 1
beside "C, memory, processors $all" "$bench" "$dir/rig" $n
exit $failed
