#!/bin/sh
# test_can_peers.sh [PROGRAM] - plants on SocketCAN with peers of other hands: can-utils and python-can.
#
# tests/can/can_peers.sh runs them where SocketCAN is, and leaves files; they are judged here. Both logs replay: candump's
# and each plant's own. Prints a line a check with its numbers and `N passed, N failed`.
program=${1:-build/contactplant}
here=$(dirname "$0")
. "$here/can_checks.sh"

/usr/bin/python3 -c 'import importlib.util as i; raise SystemExit(not i.find_spec("can"))' ||
    { echo "FAIL  python-can is missing: apt-get install python3-can"; exit 1; }

settings="--rate 125 --setting timeout_frames=10000 --setting age_limit_frames=10000"
awk '/^    can0  2/ { print $2, $3 }' "$here/../../docs/reference/protocol.md" >"$dir/bytes"
is "frames in docs/reference/protocol.md, section 4" "$(wc -l <"$dir/bytes")" 13
"$here/can_vm.sh" -n 3 -- "$here/can_peers.sh" "$program" "$dir" || { echo "FAIL  the peers did not run to their end"; exit 1; }
said() { # NAME of a line in `said`, TEXT, [FILE]
    is "$2: status" "$(sed -n "s/^$1 //p" "$dir/said")" 0 "$3"
}

echo "--- the interface goes down and up under a plant on vcan2"
is "a drive sounds" "$(grep -c 'FIRE: ok' "$dir/c.fire")" 1 "$dir/c.fire"
is "and is heard again" "$(cat "$dir/c.read")" "preload_N = 64 N"
is "STATUS: fault bit 4, running" "$(grep -c 'STATE=running.*FAULTS=16' "$dir/c.faulty")" 1 "$dir/c.faulty"
said fd "400 CAN FD frames of random identifiers and lengths beside it"
is "  it warns once of the frames under its identifiers" "$(grep -c 'others use identifiers' "$dir/c.out")" 1 "$dir/c.out"
is "  and counts no other" "$(counter "$dir/c.out" crc) $(counter "$dir/c.out" length) $(counter "$dir/c.out" unknown_id)" "1 1 0"
is "pause, reset, start" "$(grep -c 'CONTROL: ok' "$dir/c.reset")" 3 "$dir/c.reset"
is "STATUS: no fault, running" "$(grep -c 'STATE=running.*FAULTS=0' "$dir/c.good")" 1 "$dir/c.good"

echo "--- the scope on vcan2: two scenes, one of them there, and commands of others"
said rows "rows of the second scene's plant" "$dir/events"
said command "a command of send is heard" "$dir/events"
said scope "scope" "$dir/scope.err"
is "no row of the first one's" "$(grep -c '"plant":0,"rows"' "$dir/events")" 0
is "outages counted" "$(counter "$dir/c.out" bus_down)" 2

echo "--- two plants on vcan0: contactplant send at the first, python-can at the second"
said heard "the first plant is heard" "$dir/a.out"
is "send: enable, start, pause, run-until 79232" "$(grep -c 'CONTROL: ok' "$dir/a.until")" 3 "$dir/a.until"
grep -v '^ok\|^FAIL' "$dir/peer"
grep '^ok\|^FAIL' "$dir/peer"
passed=$((passed + $(grep -c '^ok' "$dir/peer")))
failed=$((failed + $(grep -c '^FAIL' "$dir/peer")))
is "python-can: checks made" "$(grep -c '^ok\|^FAIL' "$dir/peer")" 12

echo "--- cansend and canplayer with the bytes of docs/reference/protocol.md, section 4"
said stands "the plant stands at tick 79232"
said ends "that session ends" "$dir/a.disable"
is "the last of them, ENABLE off, was taken: state" "$(sed -n 's/.*, state //p' "$dir/a.out")" off
said dumped "candump has heard everything"
is "refused by the first plant" "$(grep -cE '^(crc|length|unknown_id|counter_invalid|range|late|stale|state|incomplete|unknown) ' "$dir/a.out")" 0
is "but what is repeated, and behind the session's end" "$(counter "$dir/a.out" repeated) $(counter "$dir/a.out" session)" \
    "$(repeats_in "$dir/bus.log" 20)"
is "fires applied" "$(counter "$dir/a.out" fire_applied)" 1
is "samples applied" "$(counter "$dir/a.out" stream_applied)" 1
is "frames addressed to it" "$(counter "$dir/a.out" frames_received)" \
    "$(grep -cE ' 20[0-9A-F]#' "$dir/bus.log")"
is "fires applied by the second plant" "$(counter "$dir/b.out" fire_applied)" 1
is "frames that candump lost" "$(cat "$dir/candump.err")" ""

echo "--- candump's log replays"
for plant in "a 200 $settings" "b 240 --base-id 0x240 $settings"; do
    set -- $plant
    name=$1 base=$2
    shift 2
    "$program" replay "$dir/bus.log" "$@" >"$dir/replay" 2>&1
    is "to the same telemetry, base 0x$base, status" $? 0 "$dir/replay"
    sed 's/^/      /' "$dir/replay"
    is "and the same plant" "$(hash_of "$dir/replay")" "$(hash_of "$dir/$name.out")"
    "$program" replay "$dir/$name.log" "$@" >"$dir/own" 2>&1
    is "as its own log does" "$(hash_of "$dir/own")" "$(hash_of "$dir/$name.out")"
done

echo "--- canplayer plays it to a monitor"
above "lines played" "$(wc -l <"$dir/part.log")" 300
is "messages printed" "$(grep -c '=' "$dir/played")" "$(wc -l <"$dir/part.log")"
is "the fire's LATENCY among them" "$(grep -c 'LATENCY.*MESSAGE=FIRE' "$dir/played")" 1

echo "$passed passed, $failed failed"
[ $failed = 0 ]
