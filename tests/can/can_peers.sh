#!/bin/bash
# can_peers.sh PROGRAM DIR - what test_can_peers.sh judges: plants on SocketCAN with can-utils and python-can. Run where SocketCAN is.
#
# A process is dear on the virtual machine: what can be found in files later is not looked for here, and waiting starts none but sleep.
# DIR gets the files, and in `said` a line `NAME STATUS` for each command whose status counts.
#   vcan0  two plants at 125 frames/s, 0x200 for can-utils and contactplant send, 0x240 for python-can; candump takes it all
#   vcan1  canplayer gives the log to contactplant monitor
#   vcan2  a plant whose interface goes down and up, and the scope
program=$1 dir=$2
here=$(dirname "$0")
trap 'kill $(jobs -p) 2>/dev/null' EXIT

# A machine that stood still has a burst of frames to hear.
if [ "${CAN_VM:-}" = inside ]; then for i in max default; do echo 4194304 >/proc/sys/net/core/rmem_$i; done; fi

pace="--rate 125"
settings="--setting timeout_frames=10000 --setting age_limit_frames=10000"

said() { # NAME: the status of the command before
    echo "$1 $?" >>"$dir/said"
}
has() { # FILE, pattern of its text
    local lines
    mapfile -t lines 2>/dev/null <"$1" && [[ "${lines[*]}" == *$2* ]]
}
lines_in() { # FILE, at least how many
    local lines
    mapfile -t lines <"$1" && [ ${#lines[@]} -ge "$2" ]
}
# said.csv has what the first plant tells, a row a value: frame,tick,message,item,field,value,unit.
last_tick() { # at least; the last row may be half a one
    local rows
    rows=$(tail -n 2 "$dir/said.csv")
    rows=${rows#*,}
    [ "${rows%%,*}" -ge "$1" ]
}
last_state() {
    [[ $(tail -n 5 "$dir/said.csv") == *"STATE,$1"* ]]
}
until_true() { # SECONDS COMMAND..
    local left=$(($1 * 4))
    shift
    until "$@" 2>/dev/null; do
        [ $((left -= 1)) -gt 0 ] || return 1
        sleep 0.25
    done
}
send() { # OUTPUT BUS COMMANDS..
    local output=$dir/$1 bus=$2
    shift 2
    "$program" send --bus "can:$bus" $pace "$@" >"$output" 2>&1
}

# The interface goes down and up under a plant, which tells something every second.
"$program" run --bus can:vcan2 --status $pace $settings >"$dir/c.out" 2>&1 &
plant_c=$!
send c.fire vcan2 start + arm force amplitude=3 frequency=200 ramp=0.1 + fire --in 4000
frames_pass() {
    local told
    mapfile -t told <"$dir/c.out"
    until_true 60 lines_in "$dir/c.out" $((${#told[@]} + 2))
}
c_status() {
    "$program" monitor --bus can:vcan2 $pace --only STATUS --count 1 >"$dir/$1" 2>&1
}
for i in 1 2; do
    ip link set vcan2 down
    frames_pass
    ip link set vcan2 up
    frames_pass
done
# CAN FD frames of all lengths beside it, and then two classic ones under its identifiers.
cangen vcan2 -f -g 1 -n 400
said fd
for frame in 210#0011223344556677 201#01; do cansend vcan2 $frame; done
send c.read vcan2 read preload_N
c_status c.faulty
send c.reset vcan2 pause + reset + start
c_status c.good

# The scope: two scenes, one of them there, and commands of others.
ip link set lo up
"$program" scope tip@0x280 hertz_rig --bus can:vcan2 $pace --http 127.0.0.1:0 2>"$dir/scope.err" &
scope=$!
until_true 60 has "$dir/scope.err" 'the scope is at'
url=$(sed -n 's/.* is at //p' "$dir/scope.err")
at=${url#http://} at=${at%/}
exec 3<>"/dev/tcp/${at%:*}/${at#*:}"
printf 'GET /events HTTP/1.1\r\nHost: %s\r\n\r\n' "$at" >&3
cat <&3 >"$dir/events" &
reader=$!
exec 3<&-
until_true 60 has "$dir/events" 'data: {"plant":1,"rows":'
said rows
send c.read2 vcan2 read preload_N
until_true 60 has "$dir/events" '"PARAM_READ",{"SESSION":*"INDEX":"preload_N"}'
said command
kill -INT $scope
wait $scope
said scope
wait $reader
kill -INT $plant_c
wait $plant_c

# python-can is there before its plant: what it loads takes seconds.
/usr/bin/python3 "$here/can_peer.py" vcan0 0x240 >"$dir/peer" 2>&1 &
peer=$!
until_true 60 has /proc/net/can/rcvlist_fil ' vcan0 '
# candump is there before both.
candump -L -d -r 4000000 vcan0 >"$dir/bus.log" 2>"$dir/candump.err" &
dump=$!
until_true 60 has /proc/net/can/rcvlist_all ' vcan0 '
"$program" run --bus can:vcan0 $pace $settings --log "$dir/a.log" >"$dir/a.out" 2>&1 &
plant_a=$!
"$program" run --bus can:vcan0 --base-id 0x240 $pace $settings --log "$dir/b.log" >"$dir/b.out" 2>&1 &
plant_b=$!
until_true 60 has "$dir/bus.log" ' 210#'
said heard
send a.until vcan0 enable + start + pause + run-until 79232
wait $peer
kill -INT $plant_b # the machine is for cansend now
wait $plant_b

# Then the bytes of docs/reference/protocol.md, section 4, by cansend and canplayer.
"$program" monitor --bus can:vcan0 $pace --only SYNC,STATUS --csv >"$dir/said.csv" 2>&1 &
watch=$!
until_true 60 last_tick 79232
said stands
send a.disable vcan0 disable
said ends
for i in 2 3 4; do send a.next vcan0 enable + disable; done
# The bytes are of session 5, which is next now. FRAME must be this plant's: in ENABLE and CONTROL start it is put in, with its CRC.
frame=$(tail -n 1 "$dir/said.csv" | cut -d, -f1)
/usr/bin/python3 -IS - "$frame" "$dir/bytes" <<'END'
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
mapfile -t bytes <"$dir/bytes"
for i in 1 2 3 4 5 6 7; do echo "(1.000000) vcan0 ${bytes[i]%% *}"; done >"$dir/in_time.log"
cansend vcan0 "${bytes[0]%% *}"
canplayer -I "$dir/in_time.log"
# the sample is of frame 1300, a stop before that would forget it
until_true 60 last_tick $((1302 * 64))
for i in 8 9 10 11 12; do cansend vcan0 "${bytes[i]%% *}"; done
until_true 60 last_state off
kill -INT $watch $plant_a
wait $plant_a
cansend vcan0 7FF#00 # of nobody's: until candump has written what was on its way
until_true 60 grep -q ' 7FF#00' "$dir/bus.log"
said dumped
kill -INT $dump
wait $dump

# canplayer plays it to a monitor, as slowly as it was: no longer than to the fire, and 300 lines.
awk -v first=" ${bytes[0]%% *}" 'index($0, first) { on = 1 } / 200#/ && on { since++ }
    on && since < 300 && / 2([01]|21)/ { print; since += since > 0 }' "$dir/bus.log" >"$dir/part.log"
mapfile -t part <"$dir/part.log"
timeout 120 "$program" monitor --bus can:vcan1 $pace --count ${#part[@]} >"$dir/played" 2>&1 &
watch=$!
until_true 60 has /proc/net/can/rcvlist_fil ' vcan1 '
canplayer -I "$dir/part.log" vcan1=vcan0
wait $watch
exit 0
