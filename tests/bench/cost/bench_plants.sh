#!/bin/sh
# bench_plants.sh [PROGRAM] [BENCH] [SECONDS] [PLANTS..] - contactplant run --plants with so many rigs at 1 kHz, on one
# processor, each with a controller; these share another one. A row of CSV for each number of plants. Fails only where a
# plant does not run.
program=${1:-build/contactplant}
bench=${2:-build/bench_plants}
seconds=${3:-5}
[ $# -gt 3 ] && shift 3 || set -- 1 2 5 10 20 50 100 150 200
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
port=$((23000 + $$ % 20000))
failed=0
cpus=$(taskset -cp $$ | sed 's/.*: *//; s/[,-]/ /g')
ours=${cpus##* } # the last that is allowed; the controllers get the first
echo "plants,frame p50 us,frame p99 us,frame max us,late p50 us,late p99 us,late max us,missed,frames heard"
for n; do
    yes rig | head -n "$n" >"$dir/list"
    "$program" run --plants "$dir/list" --extended --realtime --cpu "$ours" --bus udp:$port --peer 127.0.0.1:$((port + 1)) \
        >"$dir/run" 2>"$dir/err" &
    plant=$!
    heard=$(taskset -c "${cpus%% *}" "$bench" $((port + 1)) $port "$n" "$seconds") || { failed=1; echo "FAIL  $n plants: $heard"; }
    kill -INT $plant
    wait $plant || { failed=1; echo "FAIL  $n plants: $(cat "$dir/err")"; }
    awk -v n="$n" -v heard="${heard#*run, }" '
        /^frames / { sub(",", "", $6); sub(",", "", $7); missed = $7 }
        / p50 / { gsub(",", ""); for (i = 1; i < NF; i++) if ($i ~ /^(p50|p99|max)$/) v[/^compute/ ? "c" $i : "l" $i] = $(i + 1) }
        END { split(heard, h, " "); printf "%d,%s,%s,%s,%s,%s,%s,%d,%s\n", n, v["cp50"], v["cp99"], v["cmax"], v["lp50"], v["lp99"], v["lmax"], missed, h[1] }' "$dir/run"
    port=$((port + 2))
done
exit $failed
