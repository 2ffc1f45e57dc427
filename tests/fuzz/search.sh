#!/bin/sh
# search.sh BUILD SECONDS merge|keep TARGET... - each fuzz target for so long, beginning from the committed corpus, which is
# unpacked to build/fuzz. What reached something new is merged into it and packed, or the corpus is kept as it is. Prints
# executions and the size of the corpus; a broken property ends it with the input's file.
set -eu
build=$1
seconds=$2
merge=$3
shift 3
mkdir -p build/fuzz
for target in "$@"; do
    packed=tests/fuzz/corpus/$target.hex corpus=build/fuzz/corpus_$target found=build/fuzz/found_$target
    mkdir -p "$found"
    rm -rf "$corpus"
    tests/fuzz/pack.py unpack "$packed" "$corpus"
    log=build/fuzz/$target.log
    if ! "$build/fuzz_$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
        -artifact_prefix="build/fuzz/$target-" "$found" "$corpus" >"$log" 2>&1; then
        tail -30 "$log"
        echo "FAIL  fuzz $target: the input is build/fuzz/$target-*"
        exit 1
    fi
    if [ "$merge" = merge ]; then
        "$build/fuzz_$target" -merge=1 -max_len=4096 "$corpus" "$found" >build/fuzz/merge.log 2>&1
        tests/fuzz/pack.py pack "$corpus" "$packed"
    fi
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    echo "ok    fuzz $target: $executions executions in $seconds s, no property broken, corpus $(ls "$corpus" | wc -l) inputs"
done
