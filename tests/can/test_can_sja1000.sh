#!/bin/sh
# test_can_sja1000.sh [PROGRAM] [FLOOD] [CLIENT] - a plant and its controller over two SJA1000 and Linux's own driver.
#
# Needs can0 and can1 on one wire, vcan0, and the right to set them up: tests/can/can_pc.sh -- tests/can/test_can_sja1000.sh
# The plant, of PROGRAM, is on can0. Who speaks with it on can1 is of CLIENT: it starts often, so it may be without sanitizers.
# Prints a line a check with its numbers and `N passed, N failed`; lines that begin with `note` are the machine's and its load's, no verdict.
program=${1:-build/contactplant}
flood=${2:-build/flood}
client=${3:-$program}
here=$(dirname "$0")
. "$here/can_checks.sh"

details() { ip -details link show "$1"; }
has() { # INTERFACE WORDS
    details "$1" | grep -q -- "$2"
    verdict "$1 says: $2" $? "$(details "$1" | tail -n +3 | head -n 3 | tr -s ' \n\t' ' ')"
}
# Slow enough for an emulator with sanitizers on a machine with other work: 20 ms a frame, steps as at 200 frames/s.
pace="--rate 50 --substeps 256"
plant() { # OUTPUT OPTIONS..: it is $plant
    output=$1
    shift
    "$program" run $pace "$@" >"$dir/$output" 2>&1 &
    plant=$!; keep
}
ends() { # OUTPUT: Ctrl-C; a sanitizer's finding or a leak would be another status
    kill -INT $plant
    wait $plant
    is "the plant ends in order: status" $? 0 "$dir/$1"
}
send() { # WHAT WANTED COMMANDS..: the lines of the answer in one
    name=$1 wanted=$2
    shift 2
    "$client" send --bus can:can1 $pace "$@" >"$dir/send" 2>&1
    is "$name" "$(tr '\n' ' ' <"$dir/send")" "${wanted:+$wanted }"
}
monitor() { # MESSAGES COUNT
    "$client" monitor --bus can:can1 $pace --only "$1" --count "$2" --duration 100
}
status() { # WANTED
    monitor STATUS 1 >"$dir/status" 2>&1
    is "STATUS" "$(sed 's/.*SESSION=\([0-9]*\) .*STATE=\([a-z]*\) .*FAULTS=\([0-9]*\) .*/session \1 \2 faults \3/' "$dir/status")" "$1"
}
tick() { awk '{ print $2 }' "$dir/status"; } # of the last status
refused() { # OUTPUT: commands that were refused, all causes
    for cause in repeated range late stale session state full incomplete unknown; do counter "$dir/$1" $cause; done |
        awk '{ n += $1 } END { print n }'
}

echo "--- the interfaces"
ip link set can0 up 2>"$dir/err"
is "up without a bitrate is refused" "$(cat "$dir/err")" "RTNETLINK answers: Invalid argument"
for i in 0 1; do
    ip link set can$i txqueuelen 1000 type can bitrate 500000 restart-ms $((i * 100)) && ip link set can$i up
    verdict "can$i set to 500 kbit/s and up" $?
    has can$i "bitrate 500000 sample-point 0.875"
    has can$i "state ERROR-ACTIVE (berr-counter tx 0 rx 0) restart-ms $((i * 100))"
    has can$i "sja1000: tseg1 1..16"
done

for wire in "can:can0 can:can1" can:vcan0; do
    echo "--- flood check $wire"
    "$flood" check $wire >"$dir/flood" 2>&1
    status=$?
    grep -v ' passed, ' "$dir/flood"
    passed=$((passed + $(grep -c '^ok' "$dir/flood")))
    failed=$((failed + $(grep -c '^FAIL' "$dir/flood")))
    is "status" $status 0
done

echo "--- a session from can1, candump on can1 from before the plant's start"
candump -L -d -r 4000000 can1 >"$dir/bus.log" 2>"$dir/candump.err" &
dump=$!; keep
until_true 60 grep -q '^ *can1 ' /proc/net/can/rcvlist_all
# Frames that were missed are not made up: a burst of them would leave the bus after commands that the plant took later.
lasting="--setting timeout_frames=10000 --setting age_limit_frames=10000 --setting overrun_policy=1"
plant a.out --bus can:can0 $lasting --log "$dir/a.log"
until_true 60 grep -q ' 210#' "$dir/bus.log"
verdict "the plant is heard on can1" $? "$(cat "$dir/a.out")"
send "enable, start" "ENABLE: session 1 CONTROL: ok" enable + start
send "a drive, fired" "FIRE: ok" arm force amplitude=150 frequency=200 ramp=0.1 + fire --in 50
send "a parameter set, read back" "PARAM_COMMIT: ok preload_N = 40 N" set preload_N=40 contact_every=2 + read preload_N
send "a sample streamed" "CONTROL: ok CONTROL: ok" pause + stream force 1.5 + start # it names a frame close by: time stands
monitor EVENT_TIME,HEALTH 120 >"$dir/heard" 2>&1
above "contact events told" "$(grep -c EVENT_TIME "$dir/heard")" 10
above "health told" "$(grep -c HEALTH "$dir/heard")" 3
status "session 1 running faults 0"
send "disable" "ENABLE: off" disable
ends a.out
bring_up_to_date "$dir/bus.log" can0
kill -INT $dump
wait $dump
is "frames that candump lost" "$(cat "$dir/candump.err")" ""
is "commands refused: repeated, behind the session's end" "$(counter "$dir/a.out" repeated) $(counter "$dir/a.out" session)" \
    "$(repeats_in "$dir/bus.log" 20)"
is "and for other causes" "$(refused a.out)" "$(($(counter "$dir/a.out" repeated) + $(counter "$dir/a.out" session)))"
is "fires, samples applied" "$(counter "$dir/a.out" fire_applied) $(counter "$dir/a.out" stream_applied)" "1 1"
above "contact switches" "$(counter "$dir/a.out" switches)" 20
is "frames addressed to the plant, of those on the bus" "$(counter "$dir/a.out" frames_received)" \
    "$(grep -cE ' 20[0-9A-F]#' "$dir/bus.log")"
frames() { sed 's/.* \(2[0-3][0-9A-F]#[0-9A-F]*\).*/\1/' "$1" | grep "^$2"; } # LOG HEAD: what went one way, in order
for way in 20 '2[123]'; do
    frames "$dir/bus.log" "$way" >"$dir/way.bus"
    frames "$dir/a.log" "$way" >"$dir/way.own"
    is "frames on the bus from $(head -c 2 "$dir/way.own")0 on, in the order of the plant's own log: $(wc -l <"$dir/way.own")" \
        "$(cmp "$dir/way.bus" "$dir/way.own")" ""
done
# A heartbeat passes telemetry that waits for the wire in the plant's own queue: it then stands frames too early on the
# bus. Replay knows of one frame; beyond, it must tell a difference where there is one.
place() { sed 's/.* \(2[0-3][0-9A-F]#[0-9A-F]*\).*/\1/' "$1" | awk '/^216/ {n++} /^20/ {print n + 0}'; } # LOG: frames before each command
place "$dir/bus.log" >"$dir/place.bus"
place "$dir/a.log" >"$dir/place.own"
early=$(paste "$dir/place.bus" "$dir/place.own" | awk '$2 - $1 > most {most = $2 - $1} END {print most + 0}')
echo "note  commands on the bus stand at most $early frames before the plant took them"
for log in bus a; do
    "$client" replay "$dir/$log.log" $pace $lasting >"$dir/replay" 2>&1
    status=$?
    sed 's/^/      /' "$dir/replay"
    if [ $log = bus ] && [ "$early" -gt 1 ]; then
        # A heartbeat alone may be early without a difference: then it is the plant's own motion.
        [ $status = 1 ] || [ "$(hash_of "$dir/replay")" = "$(hash_of "$dir/a.out")" ]
        verdict "$log.log is refused as another motion, or gives the plant's own: status $status" $? "$(tail -n 3 "$dir/replay")"
        continue
    fi
    is "$log.log replays to the same telemetry: status" $status 0 "$dir/replay"
    is "and the same plant" "$(hash_of "$dir/replay")" "$(hash_of "$dir/a.out")"
done

echo "--- can0 goes down and up under a session with a command that waits"
grep -E ' 20[0-9A-F]#' "$dir/bus.log" >"$dir/old.log"
plant b.out --bus can:can0 --setting timeout_frames=60 --setting reaction=3 --status
"$client" send --bus can:can1 $pace start + arm force amplitude=3 frequency=200 + fire --in 500 --hold 600 >"$dir/hold" 2>&1 &
hold=$!; keep
until_true 60 grep -q 'FIRE: ok' "$dir/hold"
verdict "a fire waits, heartbeats come" $? "$(cat "$dir/hold")"
ip link set can0 down
until_true 60 grep -q ' frozen ' "$dir/b.out"
ip link set can0 up
status "session 1 frozen faults 48"
tick=$(tick)
wait $hold
is "who kept the session hears of its end: status" $? 1
canplayer -t -I "$dir/old.log"
status "session 1 frozen faults 48"
is "after a whole session of stale commands, plant tick" "$(tick)" "$tick"
send "a new session" "CONTROL: ok CONTROL: ok CONTROL: ok PARAM_COMMIT: ok" pause + reset + start + set timeout_frames=10000
status "session 2 running faults 0"
while [ "$(tick)" -lt $((tick + 500 * 256)) ]; do monitor STATUS 1 >"$dir/status"; done # beyond what the fire named

echo "--- error frames as after bus-off and a restart, by the driver's echo"
ip link set can0 type can restart 2>"$dir/err"
is "a restart by hand is refused on an active bus" "$(cat "$dir/err")" "RTNETLINK answers: Device or resource busy"
cansend can0 20000040#0000000000000000
cansend can0 20000100#0000000000000000
status "session 2 running faults 16"
send "after that" "CONTROL: ok CONTROL: ok CONTROL: ok FIRE: ok" pause + reset + start + arm force amplitude=3 frequency=200 + fire --in 50 --hold 2
status "session 2 running faults 0"
ends b.out
is "counted: outages, bus-offs, time-outs" \
    "$(counter "$dir/b.out" bus_down) $(counter "$dir/b.out" bus_off) $(counter "$dir/b.out" timeouts)" "1 1 1"
above "stale commands refused" "$(refused b.out)" "$(grep -vc ' 208#' "$dir/old.log")"
is "fires applied: the last one, neither that which waited nor the stale one" "$(counter "$dir/b.out" fire_applied)" 1

# None of these floods may overflow a queue: the plant's socket, which asks for 1 MB, and that of each processor before the sockets,
# which is short and of whose drops only the interface tells.
echo 4194304 >/proc/sys/net/core/rmem_max
echo 100000 >/proc/sys/net/core/netdev_max_backlog
unheard() { cat "/sys/class/net/$1/statistics/rx_dropped"; }
flood_once() { # PLANT'S INTERFACE, OTHERS', RATE
    before=$(unheard "$1")
    plant f.out --bus "can:$1" $lasting
    until_true 60 grep -q ' on can:' "$dir/f.out"
    "$flood" send "can:$2" "$3" 3 >"$dir/flooded" 2>&1 &
    flooder=$!; keep
    "$client" send --bus "can:$2" $pace start + arm force amplitude=3 frequency=200 + fire --in 50 >"$dir/send" 2>&1
    is "start, arm, fire" "$(tr '\n' ' ' <"$dir/send")" "CONTROL: ok FIRE: ok "
    wait $flooder
    # behind the last of it; what was fired has its time meanwhile
    until_true 60 "$client" send --bus "can:$2" $pace read preload_N --hold 2
    ends f.out
    is "applied" "$(counter "$dir/f.out" fire_applied)" 1
    drops="$(counter "$dir/f.out" rx_dropped) $(($(unheard "$1") - before))"
}
under_flood() { # as flood_once; once more where queues ran over while the plant had no processor for frames on end
    for try in 1 2 3 4 5; do
        flood_once "$@"
        missed=$(counter "$dir/f.out" frames_missed)
        if [ "$drops" = "0 0" ] || [ "$missed" -lt 25 ]; then break; fi
        echo "note  try $try: drops reported, before the socket: $drops, frames missed: $missed"
    done
    # Where the plant or the sender was behind, more comes at once than two plant frames may take; the rest is dropped and counted.
    sent=$(sed -n 's/^flood: \([0-9]*\) .*/\1/p' "$dir/flooded")
    dropped=$(counter "$dir/f.out" rx_flood)
    if [ "$dropped" = 0 ]; then
        is "frames of flood refused for their checksum, of those sent" "$(counter "$dir/f.out" crc)" "$sent"
    else
        above "frames of flood refused for their checksum or dropped in a burst ($dropped)" \
            $(($(counter "$dir/f.out" crc) + dropped)) "$sent"
        [ "$missed" != 0 ] || above "a tenth of those sent, over those dropped though the plant missed no frame" $((sent / 10)) "$dropped"
    fi
    is "drops reported, before the socket" "$drops" "0 0"
    grep -hE '^(flood|frames [0-9]|wake-up|compute per)' "$dir/flooded" "$dir/f.out" | sed 's/^/note  /'
}
echo "--- plant on can0, in real time of the emulation, 3000 frames/s of flood"
under_flood can0 can1 3000
is "can0 and can1 at the end" "$(details can0 | grep -c ERROR-ACTIVE) $(details can1 | grep -c ERROR-ACTIVE)" "1 1"

echo "$passed passed, $failed failed"
[ $failed = 0 ]
