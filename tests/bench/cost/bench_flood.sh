#!/bin/sh
# bench_flood.sh udp|can:IFACE [PROGRAM] [FLOOD] [SECONDS] [RATES] - how a plant in real time keeps its frames without and under a
# flood, beside a controller at work. Prints numbers, no verdict: they are the machine's and its load's. tests/can/flood.c checks what is exact.
bus=$1
program=${2:-build/contactplant}
flood=${3:-build/flood}
seconds=${4:-6}
rates=${5:-0 20000 50000} # frames/s
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
port=$((23000 + $$ % 20000))
if [ "$bus" = udp ]; then
    at_plant="--bus udp:$port --peer 127.0.0.1:$((port + 1)) --peer 127.0.0.1:$((port + 2))"
    at_control="--bus udp:$((port + 1)) --peer 127.0.0.1:$port"
    at_flood="udp:$((port + 2)) 127.0.0.1:$port"
else
    at_plant="--bus $bus" at_control="--bus $bus" at_flood=$bus
fi
for rate in $rates; do
    echo "--- $bus, $rate frames/s of flood beside a controller, $seconds s"
    "$program" run $at_plant --realtime --duration $seconds >"$dir/run" 2>"$dir/run.err" &
    plant=$!
    sleep 0.3
    "$program" control $at_control --duration $((seconds - 2)) >"$dir/control" 2>&1 &
    control=$!
    [ $rate = 0 ] || "$flood" send $at_flood $rate $((seconds - 2))
    wait $control
    echo "controller: exit status $?"
    wait $plant
    grep -E '^(frames [0-9]|wake-up|compute per|frames_received|crc|rx_|frames_missed|timeouts|late|stale|tx_)' "$dir/run" || { cat "$dir/run.err"; exit 1; } # it did not come to its end
done
