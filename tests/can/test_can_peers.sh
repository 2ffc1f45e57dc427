#!/bin/sh
# test_can_peers.sh [PROGRAM] - plants on SocketCAN with peers of other hands: can-utils and python-can.
#
# Needs vcan0 .. vcan2 and the right to take one down: tests/can/can_vm.sh -n 3 -- tests/can/test_can_peers.sh
#   vcan0  two plants at 125 frames/s, 0x200 for can-utils and contactplant send, 0x240 for python-can; candump takes it all
#          and its log replays, for both
#   vcan1  canplayer gives the log to contactplant monitor
#   vcan2  a plant whose interface goes down and up, and the scope
# Prints a line a check with its numbers and `N passed, N failed`.
program=${1:-build/contactplant}
here=$(dirname "$0")
. "$here/can_checks.sh"

/usr/bin/python3 -c 'import importlib.util as i; raise SystemExit(not i.find_spec("can"))' ||
    { echo "FAIL  python-can is missing: apt-get install python3-can"; exit 1; }

# A machine that stood still has a burst of frames to hear.
if [ "${CAN_VM:-}" = inside ]; then for i in max default; do echo 4194304 >/proc/sys/net/core/rmem_$i; done; fi

settings="--rate 125 --setting timeout_frames=10000 --setting age_limit_frames=10000"

echo "--- the interface goes down and up under a plant on vcan2"
"$program" run --bus can:vcan2 --status $settings >"$dir/c.out" 2>&1 &
plant_c=$!; keep
"$program" send --bus can:vcan2 --rate 125 start + arm force amplitude=3 frequency=200 ramp=0.1 + fire --in 4000 >"$dir/send" 2>&1
is "a drive sounds" "$(grep -c 'FIRE: ok' "$dir/send")" 1 "$dir/send"
frames_pass() { # of the plant on vcan2: it tells something every second
    lines=$(wc -l <"$dir/c.out")
    until_true 60 sh -c "[ \$(wc -l <'$dir/c.out') -ge $((lines + 2)) ]"
}
for i in 1 2; do
    ip link set vcan2 down
    frames_pass
    ip link set vcan2 up
    frames_pass
done
"$program" send --bus can:vcan2 --rate 125 read preload_N >"$dir/send" 2>&1
is "and is heard again" "$(cat "$dir/send")" "preload_N = 64 N"
"$program" monitor --bus can:vcan2 --rate 125 --only STATUS --count 1 >"$dir/status" 2>&1
is "STATUS: fault bit 4, running" "$(grep -c 'STATE=running.*FAULTS=16' "$dir/status")" 1 "$dir/status"
"$program" send --bus can:vcan2 --rate 125 pause + reset + start >"$dir/send" 2>&1
is "pause, reset, start" "$(grep -c 'CONTROL: ok' "$dir/send")" 3 "$dir/send"
"$program" monitor --bus can:vcan2 --rate 125 --only STATUS --count 1 >"$dir/status" 2>&1
is "STATUS: no fault, running" "$(grep -c 'STATE=running.*FAULTS=0' "$dir/status")" 1 "$dir/status"

echo "--- the scope on vcan2: two scenes, one of them there, and commands of others"
ip link set lo up
"$program" scope tip@0x280 hertz_rig --bus can:vcan2 --rate 125 --http 127.0.0.1:0 2>"$dir/scope.err" &
scope=$!; keep
until_true 60 grep -q 'the scope is at' "$dir/scope.err"
/usr/bin/python3 -uc 'import sys, urllib.request
for line in urllib.request.urlopen(sys.argv[1] + "events"):
    print(line.decode(), end="")' "$(sed -n 's/.* is at //p' "$dir/scope.err")" >"$dir/events" 2>&1 &
reader=$!; keep
until_true 60 grep -q '^data: {"plant":1,"rows":' "$dir/events"
verdict "rows of the second scene's plant" $? "$(tail -c 300 "$dir/events")"
"$program" send --bus can:vcan2 --rate 125 read preload_N >"$dir/send" 2>&1
until_true 60 grep -q '"PARAM_READ",{"SESSION":[0-9]*,"INDEX":"preload_N"}' "$dir/events"
verdict "a command of send is heard" $? "$(tail -c 300 "$dir/events")"
kill -INT $scope
wait $scope
is "scope: status" $? 0 "$dir/scope.err"
wait $reader
is "no row of the first one's" "$(grep -c '"plant":0,"rows"' "$dir/events")" 0
kill -INT $plant_c
wait $plant_c
is "outages counted" "$(counter "$dir/c.out" bus_down)" 2

echo "--- two plants on vcan0, candump from before their start"
candump -L -d -r 4000000 vcan0 >"$dir/bus.log" 2>"$dir/candump.err" &
dump=$!; keep
until_true 60 grep -q '^ *vcan0 ' /proc/net/can/rcvlist_all
"$program" run --bus can:vcan0 $settings --log "$dir/a.log" >"$dir/a.out" 2>&1 &
plant_a=$!; keep
"$program" run --bus can:vcan0 --base-id 0x240 $settings --log "$dir/b.log" >"$dir/b.out" 2>&1 &
plant_b=$!; keep
until_true 60 grep -q ' 210#' "$dir/bus.log"
verdict "the first plant is heard" $? "$(cat "$dir/a.out")"

echo "--- contactplant send at the first, python-can at the second"
"$program" send --bus can:vcan0 --rate 125 enable + start + pause + run-until 79232 >"$dir/send" 2>&1
is "send: enable, start, pause, run-until 79232" "$(grep -c 'CONTROL: ok' "$dir/send")" 3 "$dir/send"
/usr/bin/python3 "$here/can_peer.py" vcan0 0x240 >"$dir/peer" 2>&1 &
peer=$!; keep

wait $peer
grep -v '^ok\|^FAIL' "$dir/peer"
grep '^ok\|^FAIL' "$dir/peer"
passed=$((passed + $(grep -c '^ok' "$dir/peer")))
failed=$((failed + $(grep -c '^FAIL' "$dir/peer")))
is "python-can: checks made" "$(grep -c '^ok\|^FAIL' "$dir/peer")" 12
kill -INT $plant_b # the machine is for cansend now
wait $plant_b

echo "--- cansend and canplayer with the bytes of docs/reference/protocol.md, section 4"
awk '/^    can0  2/ { print $2, $3 }' "$here/../../docs/reference/protocol.md" >"$dir/bytes"
is "frames there" "$(wc -l <"$dir/bytes")" 13
"$program" monitor --bus can:vcan0 --rate 125 --only SYNC,STATUS --csv >"$dir/said.csv" 2>&1 &
watch=$!; keep
until_true 60 grep -q ^[0-9]*,79232, "$dir/said.csv"
verdict "the plant stands at tick 79232" $?
"$program" send --bus can:vcan0 --rate 125 disable >"$dir/send" 2>&1
is "that session ends" $? 0 "$dir/send"
for i in 2 3 4; do "$program" send --bus can:vcan0 --rate 125 enable + disable >"$dir/send" 2>&1; done
# The bytes are of session 5, which is next now. FRAME must be this plant's: in ENABLE and CONTROL start it is put in, with its CRC.
frame=$(tail -n 1 "$dir/said.csv" | cut -d, -f1)
/usr/bin/python3 - "$frame" "$dir/bytes" <<'END'
import sys
def crc(identifier, data):
    c = 0
    for byte in [identifier & 0xFF, identifier >> 8] + data[1:]:
        c ^= byte
        for _ in range(8):
            c = (c << 1 ^ 0x1D) & 0xFF if c & 0x80 else c << 1
    return c
lines = []
for line in open(sys.argv[2]):
    frame, name = line.split(None, 1)
    identifier, data = int(frame[:3], 16), list(bytes.fromhex(frame[4:]))
    assert crc(identifier, data) == data[0]
    if identifier == 0x201 or identifier == 0x202 and data[2] == 1:
        data[4:] = int(sys.argv[1]).to_bytes(4, "little")
        data[0] = crc(identifier, data)
    lines.append("%03X#%s %s" % (identifier, bytes(data).hex().upper(), name))
open(sys.argv[2], "w").writelines(lines)
END
# What must be there in time goes by canplayer at once, FIRE 12 frames ahead and STREAM 62; a process for each frame may be too slow.
sed -n '2,8p' "$dir/bytes" | awk '{ print "(1.000000) vcan0 " $1 }' >"$dir/in_time.log"
cansend vcan0 "$(sed -n 1p "$dir/bytes" | cut -d' ' -f1)"
canplayer -I "$dir/in_time.log"
# the sample is of frame 1300, a stop before that would forget it
until_true 60 sh -c "tail -n 1 '$dir/said.csv' | awk -F, '{ exit !(\$2 > 1301 * 64) }'"
sed -n '9,13p' "$dir/bytes" | while read -r frame name; do cansend vcan0 "$frame"; done
until_true 60 sh -c "tail -n 5 '$dir/said.csv' | grep -q STATE,off"
kill -INT $watch $plant_a
wait $plant_a
is "the last of them, ENABLE off, was taken: state" "$(sed -n 's/.*, state //p' "$dir/a.out")" off
bring_up_to_date "$dir/bus.log" vcan0
kill -INT $dump
wait $dump
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
grep -n " $(sed -n 1p "$dir/bytes" | cut -d' ' -f1)" "$dir/bus.log" | cut -d: -f1 >"$dir/line"
tail -n "+$(cat "$dir/line")" "$dir/bus.log" | grep -E ' 2([01]|21)' >"$dir/part.log"
timeout 120 "$program" monitor --bus can:vcan1 --rate 125 --count "$(wc -l <"$dir/part.log")" >"$dir/heard" 2>&1 &
watch=$!; keep
until_true 60 grep -q '^ *vcan1 ' /proc/net/can/rcvlist_fil
canplayer -I "$dir/part.log" vcan1=vcan0
wait $watch
above "lines played" "$(wc -l <"$dir/part.log")" 300
is "messages printed" "$(grep -c '=' "$dir/heard")" "$(wc -l <"$dir/part.log")"
is "the fire's LATENCY among them" "$(grep -c 'LATENCY.*MESSAGE=FIRE' "$dir/heard")" 1

echo "$passed passed, $failed failed"
[ $failed = 0 ]
