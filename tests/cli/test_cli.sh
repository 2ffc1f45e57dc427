#!/bin/sh
# test_cli.sh [PROGRAM] - the command line as a user meets it: help, every bad input, Ctrl-C, two processes over UDP.
# Prints one line a check and `N passed, N failed` at the end. Speaks on loopback only.
program=${1:-build/contactplant}
dir=$(mktemp -d) || exit 1
passed=0
failed=0
children=

cleanup() {
    for pid in $children; do kill "$pid" 2>/dev/null; done
    rm -rf "$dir"
}
trap cleanup EXIT
trap 'exit 1' INT TERM

# The first of ten ports in a row that nobody has, below those that the kernel gives away.
free_ports() {
    first=$((10000 + $$ % 900 * 10))
    while cat /proc/net/udp /proc/net/udp6 2>/dev/null |
        awk -v first=$first '{ split($2, at, ":"); used = used " " toupper(at[2]) " " }
            END { for (i = 0; i < 10; i++) if (index(used, sprintf(" %04X ", first + i))) exit 0; exit 1 }'; do
        first=$((first + 10))
    done
    echo $first
}
port=$(free_ports)

# verdict NAME STATUS [WHY]: 0 is good.
verdict() {
    if [ "$2" -eq 0 ]; then
        passed=$((passed + 1))
        echo "ok    $1"
    else
        failed=$((failed + 1))
        echo "FAIL  $1${3:+: $3}"
    fi
}

# is NAME GOT WANTED
is() {
    [ "$2" = "$3" ]
    verdict "$1: $2" $? "wanted $3"
}

# near NAME GOT WANTED TOLERANCE
near() {
    awk -v a="$2" -v b="$3" -v t="$4" 'BEGIN { d = a - b; exit !(a != "" && d <= t && -d <= t) }'
    verdict "$1: $2 (wanted $3 within $4)" $?
}

# has NAME FILE PATTERN
has() {
    grep -q -- "$3" "$2"
    verdict "$1" $? "no \"$3\" in: $(tail -n 3 "$2")"
}

# runs STATUS NAME ARGUMENTS...: the exit status; what it says is in $dir/out and $dir/err.
runs() {
    wanted=$1
    name=$2
    shift 2
    "$program" "$@" >"$dir/out" 2>"$dir/err"
    is "$name" $? "$wanted"
}

# replays NAME LOG ARGUMENTS...: the log replays to the hash that the plant NAME has printed.
replays() {
    name=$1
    shift
    "$program" replay "$@" >"$dir/out" 2>&1
    is "the log of $name replays, status" $? 0
    is "to the run's hash" "$(sed -n 's/.*hash //p' "$dir/out")" "$(sed -n 's/.*hash \([0-9a-f]*\).*/\1/p' "$dir/$name.out")"
}

# Ends what should be refused and runs instead: whatever is in $dir/refusing for a minute.
watch_refusals() {
    trap 'kill $!; exit' TERM
    seen=
    while
        sleep 60 &
        wait $!
        read -r running <"$dir/refusing"
    do
        [ "$running" = none ] || [ "$running" != "$seen" ] || kill "$running"
        seen=$running
    done
}
echo none >"$dir/refusing"
watch_refusals >/dev/null 2>&1 &
children=$!

# refuses STATUS PATTERN ARGUMENTS...: exit status, one line on stderr that matches, nothing on stdout. Hundreds of refusals:
# the shell itself reads the line, and a pattern that stands there as it is needs no grep.
refuses() {
    wanted=$1
    pattern=$2
    shift 2
    "$program" "$@" >"$dir/out" 2>"$dir/err" &
    echo $! >"$dir/refusing"
    wait $!
    status=$?
    echo none >"$dir/refusing"
    why=
    [ $status -eq "$wanted" ] || why="status $status, wanted $wanted"
    { IFS= read -r line && ! read -r _; } <"$dir/err" || why="$why, not one line"
    case $line in
    *"$pattern"*) ;;
    *) grep -q -- "$pattern" "$dir/err" || why="$why, no \"$pattern\"" ;;
    esac
    [ ! -s "$dir/out" ] || why="$why, something on stdout"
    [ -z "$why" ]
    verdict "refused: $*" $? "$why: $line"
}

# until_true COMMAND...: waits for it, a minute at most.
until_true() {
    left=600
    while ! "$@" >/dev/null 2>&1; do
        left=$((left - 1))
        [ $left -gt 0 ] || return 1
        sleep 0.1
    done
}
share_rows() { grep -hv '^#' "$@"; } # FILE...: the rows of shares
rows() { [ "$(wc -l <"$1" 2>/dev/null || echo 0)" -gt "$2" ]; } # FILE N: more than N lines

# interrupted LINES FILE ARGUMENTS...: the program with --out FILE, Ctrl-C when that has more lines; begun anew where this
# script was away until the run had ended. Its status.
interrupted() {
    lines=$1
    file=$2
    shift 2
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        rm -f "$file"
        "$program" "$@" --out "$file" >"$dir/out" 2>"$dir/err" &
        child=$!
        children="$children $child"
        until_true rows "$file" "$lines"
        (while kill -INT $child; do sleep 0.1; done) 2>/dev/null & # it may not yet listen to the first
        wait $child
        status=$?
        [ $status -eq 0 ] || break
    done
    return $status
}

# Commands may be old and heartbeats late for want of time: what a plant on a busy machine gets.
patient="--setting timeout_frames=10000 --setting age_limit_frames=10000"

# plant NAME PORT ARGUMENTS...: a plant in the background, ready, with peers at the next three ports; output in NAME.out/.err.
plant() {
    name=$1
    at=$2
    shift 2
    rm -f "$dir/$name.err" # that of a plant before is not taken for this one's
    "$program" run --bus udp:"$at" --peer 127.0.0.1:$((at + 1)) --peer 127.0.0.1:$((at + 2)) \
        --peer 127.0.0.1:$((at + 3)) "$@" >"$dir/$name.out" 2>"$dir/$name.err" &
    pid=$!
    children="$children $pid"
    until_true grep -q "Ctrl-C ends it" "$dir/$name.err"
}

# ends PID: Ctrl-C; its status.
ends() {
    kill -INT "$1"
    wait "$1"
}

# listen FILE PORT ARGUMENTS...: a monitor as second peer of the plant at PORT in the background; it is $listener.
listen() {
    heard=$1
    at=$2
    shift 2
    rm -f "$heard" # nor what another one heard
    "$program" monitor "$@" --bus udp:$((at + 2)) --peer 127.0.0.1:"$at" >"$heard" 2>"$dir/err" &
    listener=$!
    children="$children $listener"
    until_true rows "$heard" 0
}

# speak OFFSET PORT SUBCOMMAND ARGUMENTS...: a subcommand as peer number OFFSET of the plant at PORT.
speak() {
    offset=$1
    at=$2
    shift 2
    timeout --foreground 300 "$program" "$@" --bus udp:$((at + offset)) --peer 127.0.0.1:"$at"
}

echo "--- help"
for command in "" run demo send monitor scope control test simulate approach scan thermal basin sweep stability random choose replay decode compare selftest list scene dbc man completion version; do
    "$program" $command --help >"$dir/out" 2>"$dir/err"
    is "$command --help, status" $? 0
    has "$command --help, examples" "$dir/out" "^examples:"
    has "$command --help, usage" "$dir/out" "^usage: contactplant $command"
done

echo "--- misuse: status 2"
refuses 2 "subcommand is missing"
refuses 2 "did you mean simulate" simulat
refuses 2 "did you mean --duration" run --duratoin 3
refuses 2 "unknown option -d" run -d 3
refuses 2 "not a finite number" run --rate 1e3x
refuses 2 "not a finite number" run --rate nan
refuses 2 "not a finite number" run --rate inf
refuses 2 "not a finite number" run --rate=
refuses 2 "out of range" run --rate 0
refuses 2 "whole number" run --substeps 1.5
refuses 2 "given twice" run --rate 1000 --rate 1000
refuses 2 "needs a value" run --rate
refuses 2 "takes no value" run --realtime=1
refuses 2 "one word too many" run hertz_rig hertz_rig
refuses 2 "did you mean hertz_rig" run hertz_rigg
refuses 2 "did you mean mass_kg" run --set mass_kgg=1
refuses 2 "mass_kg: -1 is out of range" run --set mass_kg=-1
refuses 2 "not a finite number" run --set mass_kg=nan
refuses 2 "the unit is missing; it is kg" run --set mass=5
refuses 2 "did you mean kg?" run --set "mass=5 KG"
refuses 2 "write the decimal comma as a point" run --set "mass=5,5 kg"
refuses 2 "with a point for the comma" run --rate 0,5
refuses 2 "NAME=VALUE" run --set mass_kg
refuses 2 "did you mean timeout_frames" run --setting timeout_frame=10
refuses 2 "whole number" run --setting timeout_frames=10.5
refuses 2 "no such method" run --method euler
refuses 2 "did you mean rk4?" run --method RK4
refuses 2 "did you mean rk4?" simulate rig --method RK4
refuses 2 "did you mean batch_taylor?" basin rig --method Batch_Taylor
refuses 2 "did you mean contact_force?" choose rig --observable force
refuses 2 "did you mean host?" choose rig --on Host
refuses 2 "did you mean drop?" run --faults DROP=0.1
refuses 2 "did you mean missed?" run --fail-on Missed
refuses 2 "did you mean force?" simulate --drive forc=1,2,3
refuses 2 "did you mean force?" send stream FORCE 1
refuses 2 "did you mean stop?" send stpo
refuses 2 "did you mean surface?" scan --set surfac=2
refuses 2 "did you mean models?" list model
refuses 2 "did you mean rig?" run RIG
refuses 2 "0x200 is" run --base-id 0x210
refuses 2 "add --extended" run --base-id 0x800
refuses 2 "catch_up, skip, freeze or stop" run --overrun never
refuses 2 "cannot run" run --substeps 1 --rate 50
refuses 2 "a bus is" run --bus tcp:1
refuses 2 "PORT 0 to 65535" run --bus udp:70000
refuses 2 "a peer is HOST:PORT" run --peer nobody
refuses 2 "go" run --bus can:can0 --peer 127.0.0.1:1
refuses 2 "at most 4 peers" run --peer 127.0.0.1:1 --peer 127.0.0.1:2 --peer 127.0.0.1:3 --peer 127.0.0.1:4 --peer 127.0.0.1:5
refuses 2 "something is missing" send
refuses 2 "did you mean start" send strat
refuses 2 "a scene is given by --model" send rig start
refuses 2 "a scene is given by --model" send nosuch.ini start
refuses 2 "a scene is given by --model" compare a.log b.log rig
refuses 2 "write arm INPUT amplitude=5 N" send arm
refuses 2 "start: write start alone" send start now
refuses 2 "no input" send arm forse amplitude=1
refuses 2 "did you mean amplitude?" send arm force amplitud=1
refuses 2 "did you mean kN?" send arm force amplitude=1 KN
refuses 2 "does not fit" send arm force amplitude=1e
refuses 2 "out of range" send arm force noise=-1
refuses 2 "not a finite number" send stream force nan
refuses 2 "the unit is missing; it is N" send set preload=1
refuses 2 "did you mean preload_N" send set preload_M=1 N
refuses 2 "number of frames" send step -1
refuses 2 "beside +" send start + + stop
refuses 2 "no message" monitor --only MOTOIN
refuses 2 "did you mean xi" simulate --set xj=0.1
refuses 2 "out of range" simulate --set xi=2
refuses 2 "2 states" simulate --state 1,2,3
refuses 2 "ascend" simulate --at 1,3,2
refuses 2 "finite numbers" simulate --at 1,,2
refuses 2 "there are model, si" simulate --units metric
refuses 2 "did you mean si?" simulate --units SI
refuses 2 "did you mean MOTION?" monitor --only motion
refuses 2 "did you mean udp:?" run --bus UDP:20000
refuses 2 "did you mean trigger?" send capture tirgger
refuses 2 "did you mean force?" choose rig --sweep frce=20,30,3
refuses 2 "three finite numbers" simulate --units si --drive force=1,nan,0
refuses 2 "three finite numbers" simulate --noise force=1,1
refuses 2 "no such input" simulate --noise forse=1,1,1
refuses 2 "DEVIATION is 0 or more" simulate --noise force=-1,1,1
refuses 2 "STEPS is a whole number" simulate --noise force=1,0,1
refuses 2 "SEED 0 to 4294967295" simulate --noise force=1,1,4294967296
refuses 2 "needs --units si" simulate rolling_contact --set zeta=0.1 --noise waviness=1,1,1
refuses 2 "cannot be done" simulate --set xi=0.01 --step 100 --until 100 --every 100 --out "$dir/x.csv"
refuses 2 "no such model" simulate hertz_rigg
refuses 2 "no such input" simulate --units si --drive farce=1,2,3
refuses 2 "begin nearer" simulate --set xi=0.01 --state 1e13,0 --at 1
refuses 2 "begin nearer" simulate --units si --state 1e308,1e308 --at 1
refuses 2 "finite numbers" simulate --state nan,0
refuses 2 "Kirrou & Belhaq 2013 leave their range .*below 1 with the published sign" simulate afm_tip --set beta=1 --set sign=1
refuses 2 "sign must be" simulate afm_tip --set sign=0
refuses 2 "mass_kg: 0 is out of range" simulate --set mass_kg=0
refuses 2 "preload_N: 0 is out of range" simulate --set preload_N=0
refuses 2 "stiffness_N_per_m1_5: -1 is out of range" simulate --set stiffness_N_per_m1_5=-1
refuses 2 "g1: 0 is out of range" simulate shaft_bearing --set g1=0
refuses 2 "g3: -1e-4 is out of range" simulate shaft_bearing --set g3=-1e-4
refuses 2 "kg3: -1 is out of range" simulate shaft_bearing --set kg3=-1
refuses 2 "m2: 0 is out of range" simulate shaft_bearing --set m2=0
refuses 2 "mode: 4 is out of range" simulate shaft_bearing_mode --set mode=4
refuses 2 "--tol: 0.5 is out of range; give a number from 1e-13 to 0.1" run --method taylor --tol 0.5
refuses 2 "taylor has no series" run --method taylor shaft_bearing
refuses 2 "exact is for piecewise linear" run --method exact
refuses 2 "out of range" run --tol 0
refuses 2 "not a finite number" simulate --tol nan
refuses 2 "begin at 0" simulate --at -1
refuses 2 "something is missing" replay
refuses 2 "nothing called" list everything

cat >"$dir/rig.ini" <<'EOF'
[plant]
model = hertz_rig
[paper]
xi = 0.05
sigma = 0.04
omega = 0.9
[deadline]
dilation = 0.001
EOF
refuses 2 "nothing drives it" basin hertz_rig
refuses 2 "share no period" basin bbp-fig2-force
refuses 2 "a random input has no attractors" basin nayak-random
refuses 2 "no such method" basin "$dir/rig.ini" --method euler
refuses 2 "no single Hertzian contact" basin shaft-fig16-705 --method batch_taylor
refuses 2 "with 3 steps a period: fewer than 4 steps" basin "$dir/rig.ini" --steps 3
refuses 2 "did you mean q_dot" basin "$dir/rig.ini" --box q_dto=0:1
refuses 2 "no such state; there are q, q_dot" basin "$dir/rig.ini" --box position=0:1
refuses 2 "write NAME=FROM:TO" basin "$dir/rig.ini" --box q=1
refuses 2 "q is given twice" basin "$dir/rig.ini" --box q=0:1 --box q=0:2
refuses 2 "give a number from 0 to 4294967295" basin "$dir/rig.ini" --seed -1
refuses 2 "smaller end first" basin "$dir/rig.ini" --box q=1:0
refuses 2 "does not fit" basin shaft-fig16-705 --box x1=0:1N
refuses 2 "give --out too" basin "$dir/rig.ini" --svg "$dir/x.svg"
refuses 2 "is the scene itself" basin "$dir/rig.ini" --out "$dir/x.csv" --svg "$dir/rig.ini"
refuses 2 "choose two files" basin "$dir/rig.ini" --out "$dir/x.csv" --svg "$dir/x.csv"
refuses 2 "scene itself" basin "$dir/rig.ini" --out "$dir/rig.ini"
refuses 2 "nosuch" basin "$dir/rig.ini" --out "$dir/nosuch/x.csv"
refuses 2 "nosuch" basin "$dir/rig.ini" --out "$dir/x.csv" --svg "$dir/nosuch/x.svg"
refuses 2 "take --out and --shard away" basin "$dir/rig.ini" --rows "$dir/x.csv" --out "$dir/y.csv"
refuses 2 "nosuch" basin "$dir/rig.ini" --rows "$dir/nosuch.csv"
refuses 2 "give --out too" basin "$dir/rig.ini" --report "$dir/x.csv"
refuses 2 "is read by this command" basin "$dir/rig.ini" --rows "$dir/x.csv" --report "$dir/x.csv"
refuses 2 "not the header" basin "$dir/rig.ini" --rows "$dir/rig.ini"

echo "--- failures: status 1"
refuses 1 "no such plant\|no plant answers" send --bus udp:$port --peer 127.0.0.1:$((port + 9)) start
refuses 1 "heard nothing" monitor --bus udp:$port --peer 127.0.0.1:$((port + 9)) --duration 0.2
refuses 1 "nosuch0" run --bus can:nosuch0
refuses 2 "nosuch" run --bus udp:$port --log "$dir/nosuch/run.log"
refuses 1 "nosuch" replay "$dir/nosuch.log"
refuses 2 "nosuch" simulate --out "$dir/nosuch/x.csv"
refuses 1 "out is not complete" simulate --set xi=0 --until 1000 --every 0.1 --out /dev/full
refuses 1 "events is not complete" simulate --set xi=0 --state 2,0 --at 20 --out "$dir/x.csv" --events /dev/full
plant first $port
runs 1 "a port in use, status" run --bus udp:$port --duration 1
has "a port in use, said" "$dir/err" "in use"
runs 1 "a full disk for the log, status" run --bus udp:$((port + 4)) --duration 0.3 --log /dev/full
has "a full disk for the log, said" "$dir/err" "No space left"
has "a full disk for the log, the report still comes" "$dir/out" "wake-up lateness"
echo '(0000000000.000000) udp 210#00' | tr -d '\n' >"$dir/cut.log"
refuses 1 "cut.log: no line of it is one of candump" replay "$dir/cut.log"
echo '(0000000000.000000) udp 210#0' >"$dir/half.log"
refuses 1 "half.log: no line of it.*line 1, column 30: half a data byte" replay "$dir/half.log"
: >"$dir/empty.log"
refuses 1 "empty.log: no line of it is one of candump" replay "$dir/empty.log"
echo '(0000000001.000000) udp 300#00' >"$dir/empty.log"
refuses 1 "nothing in the log" replay "$dir/empty.log"
ends "$pid"

echo "--- what the link and its log tell"
"$program" run --bus udp:$((port + 4)) --log /dev/full >"$dir/out" 2>"$dir/full.err" &
pid=$!
children="$children $pid"
until_true grep -q "No space left" "$dir/full.err"
verdict "a disk that is full is told while the plant runs" $?
kill -0 "$pid"
verdict "which goes on" $?
ends "$pid"
is "and ends with status" $? 1
"$program" run --bus udp:$((port + 4)) --log "$dir/limited.log" --log-limit 0.05 --duration 2 >"$dir/limited.out" 2>"$dir/err"
is "a log at its limit, status" $? 0
has "a log at its limit, said" "$dir/err" "its limit is reached; recorded [0-9]* lines"
has "and on the bus" "$dir/limited.out" "^log_ended  *1 reports"
[ "$(wc -c <"$dir/limited.log")" -le 50000 ] && [ "$(wc -c <"$dir/limited.log")" -gt 40000 ]
verdict "a log at its limit, bytes" $? "$(wc -c <"$dir/limited.log")"
"$program" replay "$dir/limited.log" >"$dir/out" 2>&1
is "it replays, status" $? 0
refuses 2 "--log-limit needs --log" run --log-limit 1
plant lonely $port --log "$dir/lonely.log"
/usr/bin/python3 -c '
import socket, sys
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("127.0.0.1", int(sys.argv[1]) + 5))
for i in range(3):
    s.sendto(b"\2\0\0\0\0", ("127.0.0.1", int(sys.argv[1])))' $port
until_true grep -q "127.0.0.1:$((port + 5)) sent packets that were dropped.*--peer 127.0.0.1:$((port + 5)) " "$dir/lonely.err"
verdict "a sender that is not listed is told with the option that lists it" $? "$(cat "$dir/lonely.err")"
is "once" "$(grep -c "packets that were dropped" "$dir/lonely.err")" 1
kill -HUP "$pid"
wait "$pid"
is "SIGHUP ends it as Ctrl-C does: status" $? 0
has "the report comes" "$dir/lonely.out" "hash"
"$program" replay "$dir/lonely.log" >"$dir/out" 2>&1
is "and its log replays, status" $? 0
runs 0 "a peer without a route, status" run --bus udp:$((port + 4)) --peer 192.0.2.1:9 --duration 0.3
has "is told with the reason" "$dir/err" "cannot send to the peer 192.0.2.1:9"
is "once" "$(grep -c "cannot send to the peer" "$dir/err")" 1
has "and counted" "$dir/out" "^tx_unsent  *[1-9]"
"$program" run --bus udp:$((port + 4)) --log "$dir/closed.log" --duration 0.3 --status <&- >&- 2>&-
is "without standard streams, status" $? 0
is "lines of its log that are none" "$(grep -cv "^([0-9.]*) udp [0-9A-F]*#[0-9A-F]*$" "$dir/closed.log")" 0
plant spoken $port
{
    "$program" monitor --bus udp:$((port + 2)) --peer 127.0.0.1:$port --only SYNC 2>"$dir/err"
    echo $? >"$dir/status"
} | head -n 1 >"$dir/out"
is "monitor | head: status" "$(cat "$dir/status")" 0
is "nothing on stderr" "$(wc -c <"$dir/err")" 0
has "a line" "$dir/out" "SYNC"
ends "$pid"

echo "--- standard output that nobody reads any more, and a full disk"
# printed ARGUMENTS...: quiet and 0 into a pipe whose reader is gone; a failure that is told where the disk is full.
printed() {
    {
        sleep 0.1
        "$program" "$@" 2>"$dir/err"
        echo $? >"$dir/status"
    } | :
    is "$1 into a closed pipe, status" "$(cat "$dir/status")" 0
    is "and nothing on stderr" "$(grep -vc "warning: " "$dir/err")" 0
    "$program" "$@" >/dev/full 2>"$dir/err"
    is "$1 onto a full disk, status" $? 1
    has "and it is told" "$dir/err" "cannot write the output: No space left on device; make room and run again"
}
printed --help
printed list --help
printed list
printed scene rig
printed dbc
printed selftest
printed replay "$dir/closed.log"
printed simulate --set xi=0 --until 1000 --every 0.1
printed simulate rig --method auto
printed choose rig
printed sweep rig --sweep force.amplitude=1:2:3
printed basin rig --starts 2
printed stability hertz_rig
printed random nayak-random --seeds 4 --over 150
{
    timeout 20 "$program" simulate --set xi=0 --until 9e6 --every 0.1 2>"$dir/err"
    echo $? >"$dir/status"
} | head -n 1 >"$dir/out"
is "a run of 9e7 rows ends with its reader, status" "$(cat "$dir/status")" 0
(
    ulimit -f 1
    "$program" simulate --set xi=0 --until 100 >"$dir/limited.csv" 2>"$dir/err"
)
is "an output beyond the limit of a file's size, status" $? 1
has "and it is told" "$dir/err" "cannot write the output: File too large; raise the limit (ulimit -f)"
"$program" list >&- 2>"$dir/err"
is "an output that is closed, status" $? 1
has "and it is told" "$dir/err" "cannot write the output: it is closed"
"$program" simulate --set xi=0 --state 2,0 --until 100 --events "$dir/pipe.csv" 2>"$dir/err" | :
"$program" simulate --set xi=0 --state 2,0 --until 100 --events "$dir/whole_events.csv" >"$dir/out" 2>"$dir/err"
cmp -s "$dir/pipe.csv" "$dir/whole_events.csv"
verdict "its file of events is written to the end" $?
for list in refuse=0.3 refuse=1@0:0.5 bus-off@0.2:0.4 refuse=0.2,bus-off@0.1:0.2,drop=0.1,in.delay=0.2:20,flip=0.1 out.freeze@0.1:0.3; do
    plant bad $port --faults $list --log "$dir/bad.log"
    speak 1 $port send start --hold 0.3 >"$dir/out" 2>&1
    ends "$pid"
    replays bad "$dir/bad.log"
done
if setpriv --reuid=65534 --clear-groups "$program" list methods >/dev/null 2>&1; then
    setpriv --reuid=65534 --clear-groups sh -c "ulimit -r 0; ulimit -l 0; exec \"$program\" run --realtime --duration 0.2 \
        --bus udp:$((port + 4))" >"$dir/out" 2>"$dir/err"
    is "real time not granted, goes on" $? 0
    has "SCHED_FIFO not granted, said" "$dir/err" "SCHED_FIFO was not granted"
    # the address sanitizer makes mlockall a dummy that always succeeds
    grep -q __asan_init "$program" || has "locked memory not granted, said" "$dir/err" "locked memory was not granted"
else
    verdict "real time not granted" 1 "needs root and setpriv (util-linux) to try it without privileges"
fi

echo "--- basin"
map() { # MAP ARGUMENTS...: rows of 120 starts into MAP.csv
    name=$1
    shift
    "$program" basin "$dir/rig.ini" --starts 120 --out "$dir/$name.csv" "$@" >"$dir/$name.out" 2>"$dir/$name.err"
}
map whole --cores 1 --svg "$dir/map.svg"
is "a map, status" $? 0
is "rows" "$(wc -l <"$dir/whole.csv")" 121
has "one attractor at this damping" "$dir/whole.out" "^1  *120  *100.000 %"
has "its picture" "$dir/map.svg" "start q_dot"
head -c 15000 "$dir/whole.csv" >"$dir/cut.csv"
map cut --cores 2
cmp -s "$dir/whole.csv" "$dir/cut.csv"
verdict "an interrupted map, gone on with, has the same bytes" $?
for i in 1 2 3; do map part$i --shard $i/3; done
"$program" merge "$dir/joined.csv" "$dir/part3.csv" "$dir/part1.csv" "$dir/part2.csv" >"$dir/out"
cmp -s "$dir/joined.csv" "$dir/whole.csv"
verdict "three shards, merged, have the same bytes" $?
refuses 2 "not of this run and shard, and left as it is" basin "$dir/rig.ini" --starts 121 --out "$dir/whole.csv"
refuses 2 "not of this run and shard, and left as it is" basin "$dir/rig.ini" --starts 120 --shard 2/3 --out "$dir/part3.csv"
refuses 2 "not of this run and shard, and left as it is" basin "$dir/rig.ini" --starts 120 --method taylor --out "$dir/whole.csv"
map named --method batch_taylor
cmp -s "$dir/whole.csv" "$dir/named.csv"
verdict "batch_taylor is what one Hertzian contact takes without --method" $?
map plain --method taylor
has "taylor, one start at a time, finds the same attractor" "$dir/plain.out" "^1  *120  *100.000 %"
cat >"$dir/three.ini" <<'EOF'
[plant]
model = hertz_rig
[drive force]
amplitude = 10 N
frequency = 150 Hz
[drive fast_force]
amplitude = 2 N
frequency = 300 Hz
[drive base]
amplitude = 10 nm
frequency = 450 Hz
EOF
runs 0 "three frequencies of force, status" basin "$dir/three.ini" --starts 20 --out "$dir/three.csv"
has "three frequencies of force, both attractors" "$dir/out" "^20 starts, 2 attractors"
"$program" basin shaft --starts 6 --method rk4 --out "$dir/shaft.csv" >"$dir/out" 2>"$dir/err"
has "a symmetric shaft closes two contacts at once, and rk4 locates both" "$dir/out" "^1 *6 *100.000 %.* symmetric$"
"$program" basin "$dir/three.ini" --starts 20 --method taylor --out "$dir/three_taylor.csv" >"$dir/out" 2>"$dir/err"
cmp -s "$dir/three.csv" "$dir/three_taylor.csv"
verdict "three frequencies of force take taylor without --method" $?
refuses 2 "more than two frequencies; give --method taylor" basin "$dir/three.ini" --method batch_taylor
cat >"$dir/moved.ini" <<'EOS'
[plant]
model = hertz_rig
[drive force]
amplitude = 15 N
frequency = 128 Hz
phase = 0.3 rad
[drive base]
amplitude = 20 nm
frequency = 512 Hz
EOS
cat >"$dir/bearings.ini" <<'EOS'
[plant]
model = shaft_bearing
[drive force2]
amplitude = 25 N
frequency = 16 Hz
EOS
# Periods that are whole in binary, so that both commands have the same steps.
end_of() { # SCENE HZ STEPS METHOD STATES: the end of row 3, and where simulate is then that goes from its start
    "$program" basin "$dir/$1.ini" --starts 3 --method $4 --steps $3 --periods 200 2>/dev/null | tail -1 >"$dir/row"
    at=$(cut -d, -f$((6 + $5)) "$dir/row" | awk -v hz=$2 '{ printf "%.17g", $1 / hz }')
    step=$(awk -v hz=$2 -v n=$3 'BEGIN { printf "%.17g", 1 / (hz * n) }')
    start=$(cut -d, -f4-$((3 + $5)) "$dir/row")
    end=$(cut -d, -f$((10 + 3 * $5))-$((9 + 4 * $5)) "$dir/row")
    went=$("$program" simulate "$dir/$1.ini" --state="$start" --at $at --step $step --method $4 --tol 1e-10 2>/dev/null |
        tail -1 | cut -d, -f2-$((1 + $5)))
}
for method in rk4 rk4_unlocated taylor; do
    end_of moved 128 256 $method 2
    is "simulate goes from a start to its row's end, every digit: $method" "$went" "$end"
done
end_of bearings 16 512 exact 6
is "and a shaft that keeps hitting its bearings" "$went" "$end"
"$program" basin "$dir/rig.ini" --rows "$dir/whole.csv" | cmp -s - "$dir/whole.out"
verdict "--rows says the same" $?
share_rows "$dir/part1.csv" "$dir/part3.csv" >"$dir/torn.csv"
refuses 2 "torn.csv:52: not the next start" basin "$dir/rig.ini" --rows "$dir/torn.csv"
sed '60s/,settled/,settld/' "$dir/whole.csv" >"$dir/torn.csv"
refuses 2 "torn.csv:60: no row of this map" basin "$dir/rig.ini" --rows "$dir/torn.csv"
sed '60s/^......../00000000/' "$dir/whole.csv" >"$dir/torn.csv"
refuses 2 "torn.csv:60: a row of another map" basin "$dir/rig.ini" --rows "$dir/torn.csv"
"$program" basin "$dir/rig.ini" --starts 1 >/dev/full 2>"$dir/err"
is "a full disk for the rows, status" $? 1
has "a full disk for the rows, said" "$dir/err" "cannot be written"
runs 1 "a full disk for the picture, status" basin "$dir/rig.ini" --rows "$dir/whole.csv" --svg /dev/full
has "a full disk for the picture, said" "$dir/err" "the rows are complete"
interrupted 0 "$dir/long.csv" basin shaft-fig9 --starts 100000
is "Ctrl-C, status" $? 1
has "Ctrl-C, said" "$dir/err" "interrupted; .* the same command goes on from there"

echo "--- simulate"
"$program" simulate --set xi=0 --state 2,0.5 --at 0,0.1,3.7,20 --out "$dir/free.csv"
is "times exactly as asked" "$(cut -d, -f1 "$dir/free.csv" | tr '\n' ' ')" \
    "t 0 0.10000000000000001 3.7000000000000002 20 "
# E = v^2/2 + (4/15) eta^(5/2) - (2/3) eta is constant without drives and damping; eta = 1 + 2q/3, v = 2 q_dot/3
near "energy kept, free flights included" "$(awk -F, 'NR > 1 { e = 1 + 2 * $2 / 3; v = 2 * $3 / 3;
    E = v * v / 2 - 2 * e / 3 + (e > 0 ? 4 / 15 * e ^ 2.5 : 0); if (NR == 2) E0 = E; d = E - E0;
    if (d < 0) d = -d; if (d > m) m = d } END { print m + 0 }' "$dir/free.csv")" 0 1e-9
# 100 rows restart the drives' phases 100 times; one row does not
set -- --set xi=0.05 --set sigma=0.3 --set omega=0.9 --set phi=1 --set a_base=0.2 --step 0.002
near "rows in between change nothing" "$("$program" simulate "$@" --until 10 --every 0.1 | tail -n 1 | cut -d, -f2)" \
    "$("$program" simulate "$@" --at 10 | tail -n 1 | cut -d, -f2)" 1e-10
is "of a scene not a digit" "$("$program" simulate rig --at 0.0123457,0.03,0.05 2>/dev/null | tail -n 1)" \
    "$("$program" simulate rig --until 0.05 2>/dev/null | tail -n 1)"
# q = cos t; 7.7 is no multiple of the step
near "a row between two steps is exact" "$("$program" simulate hertz_rig_linear --set xi=0 --state 1,0 --step 0.3 --at 0.1,1.2,7.7 \
    2>/dev/null | tail -n 1 | cut -d, -f2)" 0.153373862037864 1e-14
"$program" simulate hertz_rig --set xi=0 --state 2,0 --step 0.25 --at 0.1,3.3,5.62 --events "$dir/events.csv" >"$dir/out" 2>&1
is "a touchdown at 5.604 in the part of a step before the last row" "$(grep -c touchdown "$dir/events.csv")" 1
set -- rolling_contact --units si --noise force=20,3,4294967295 --noise waviness=1e-7,25,1 --step 1e-5
refuses 2 "noise of a length goes from step to step" simulate "$@" --at 0.01,0.012345
near "nor with noise" "$("$program" simulate "$@" --until 0.02 --every 0.001 | tail -n 1 | cut -d, -f2)" \
    "$("$program" simulate "$@" --at 0.02 | tail -n 1 | cut -d, -f2)" 1e-15
# pi Phi/(2 zeta) with Phi = sigma^2 T/(2 pi) of f = (2/3) u: 0.0313, standard error 3 %
near "variance of the linear plant" "$("$program" simulate rolling_contact_linear --set zeta=0.25 \
    --noise force=0.839,1,7 --step 0.1 --every 0.5 --until 4000 |
    awk -F, 'NR > 40 { n++; s += $2; q += $2 * $2 } END { print q / n - s * s / n / n }')" 0.0313 0.003
interrupted 3 "$dir/long.csv" simulate --set xi=0 --until 1e6 --every 1
is "Ctrl-C: status" $? 1
has "Ctrl-C: said" "$dir/err" "interrupted at t"
is "Ctrl-C: the last row is whole" "$(tail -n 1 "$dir/long.csv" | tr -cd ',\n' | wc -c)" 3
is "SI header" "$("$program" simulate --units si --at 0 | head -n 1)" "t,position,velocity"

echo "--- sweep"
refuses 2 "no drive sounds" sweep hertz_rig
refuses 2 "base is silent, and its base.frequency_Hz changes nothing" sweep rig --sweep base.frequency=100:200:3
refuses 2 "did you mean damping" sweep rig --sweep dampin=1:2:3
refuses 2 "write NAME=FROM:TO:N" sweep rig --sweep force.frequency=100
refuses 2 "write NAME=FROM:TO:N" sweep rig --sweep force.frequency=100:200:3:cubic
refuses 2 "smaller end first" sweep rig --sweep force.frequency=300:100:10
refuses 2 "whole number of values" sweep rig --sweep force.frequency=100:200:1
refuses 2 "begins above 0" sweep rig --sweep force.amplitude=0:10:5:log
refuses 2 "did you mean force.frequency" sweep rig --sweep frequency=100:200:3
refuses 2 "there are mass, stiffness, .*stiffness.noise_hold" sweep rig --sweep zzz=100:200:3
refuses 2 "mass is given twice" sweep rig --set "mass=3 kg" --set "mass=4 kg"
refuses 2 "there twice" sweep rig --harmonics 1,2,2/2
refuses 2 "n/m above 0" sweep rig --harmonics 1,-2
refuses 2 "does not fit" sweep rig --sweep "force.frequency=100 N:200 N:3"
refuses 2 "out of range" sweep rig --sweep mass=0:1:3
refuses 2 "has no frequency there" sweep rig --sweep force.frequency=0:10:3
refuses 2 "take two different" sweep rig --sweep damping=1:2:3 --family damping_N_s_per_m=1:2:2
refuses 2 "contradicts its range" sweep rig --sweep damping=1:2:3 --set damping=2
refuses 2 "did you mean force.amplitude" sweep rig --set force.amplitud=2
refuses 2 "never settles" sweep nayak-random
refuses 2 "n/m above 0" sweep rig --harmonics 0
# 14841f25: what a program that measured by 256 samples made of the same command
"$program" sweep rig --sweep "force.frequency=150 Hz:151 Hz:2" --out "$dir/old.csv" 2>/dev/null
{ head -1 "$dir/old.csv"; sed -n '2s/^[0-9a-f]*/14841f25/p' "$dir/old.csv"; } >"$dir/older.csv"
refuses 2 "not of this run" sweep rig --sweep "force.frequency=150 Hz:151 Hz:2" --out "$dir/older.csv"
runs 0 "a chaotic sweep: status" sweep shaft-fig9 --sweep freq_hz=24:26:3
has "what did not settle is said" "$dir/err" "not settled: 6 points; no jump looked for between freq_hz = 24 and 26"
is "and stands in the rows" "$(grep -c ",unsettled," "$dir/out")" 6
"$program" sweep rig --set damping=0 --sweep force.frequency=200:230:2 --settle 3 --out "$dir/unsettled.csv" --svg "$dir/unsettled.svg" >"$dir/out" 2>/dev/null
has "the summary knows no jump where nothing settled" "$dir/out" "no jump was found where points settled"
has "  and says that its largest amplitude did not settle" "$dir/out" "largest .* at 230 Hz, which did not settle"
has "  and what to do about points that did not" "$dir/out" "4 points did not settle: give more --settle, .* basin and random"
has "the picture tells how many" "$dir/unsettled.svg" "2 points up and down, to settle over 3 periods; 4 did not settle; dashed: jumps<"
is "  and has an entry for their dots" "$(grep -c ">did not settle<" "$dir/unsettled.svg")" 1
is "  which no line joins" "$(grep -c 'class="line".* d="[^"]*L' "$dir/unsettled.svg")" 0
for n in 2 7; do
    "$program" sweep rig --sweep force.frequency=215:219:2 --family force.amplitude=1.00003:4.5454545:$n --settle 20 --out "$dir/family.$n.csv" \
        --svg "$dir/family.$n.svg" >"$dir/out" 2>/dev/null
    has "a jump of a family of $n has name and unit" "$dir/out" "  amplitude of force 4.54545 N, up at 217.*Hz: amplitude"
    has "  its legend, too" "$dir/family.$n.svg" ">amplitude of force 1 N<"
done
has "two curves have a colour each" "$dir/family.2.svg" "; a colour for each amplitude of force<"
has "seven have not" "$dir/family.7.svg" "; 6 colours in turn for the values of amplitude of force<"
refuses 2 "write for instance" sweep rig --harmonics 1x
refuses 2 "times the reference" sweep rig --harmonics 17
refuses 2 "multiple of 4" sweep rig --harmonics 1/2 --measure 6
refuses 2 "no such method" sweep rig --method euler
for command in run simulate sweep random stability; do
    refuses 2 "--tol: 1e-14 is out of range; give a number from 1e-13 to 0.1" $command rig --method taylor --tol 1e-14
done
refuses 2 "give --out too" sweep rig --svg "$dir/x.svg"
refuses 2 "without --shard" sweep rig --out "$dir/x.csv" --svg "$dir/x.svg" --shard 1/1
refuses 2 "choose two files" sweep rig --out "$dir/x.csv" --svg "$dir/x.csv"
refuses 2 "give I/N with 1 <= I <= N" sweep rig --shard 3/2
"$program" sweep rig --shard 2/3 --out "$dir/empty.csv" 2>"$dir/err"
is "a share beyond the jobs, status" $? 0
is "is complete without a row" "$(tail -n 1 "$dir/empty.csv")" "# complete: 0 rows"
refuses 2 "cannot write --out" sweep rig --out "$dir/nosuch/x.csv"
"$program" scene rig >"$dir/swept.ini"
refuses 2 "scene itself" sweep "$dir/swept.ini" --out "$dir/swept.ini"
set -- sweep rig --sweep force.frequency=150:160:2 --settle 10
"$program" "$@" --out "$dir/swept.csv"
cp "$dir/swept.csv" "$dir/copy.csv"
refuses 2 "not of this run" "$@" --harmonics 1 --out "$dir/swept.csv"
refuses 2 "cannot write --svg" "$@" --out "$dir/swept.csv" --svg "$dir/nosuch/x.svg"
refuses 1 "rows are complete" "$@" --out "$dir/swept.csv" --svg /dev/full
cmp -s "$dir/swept.csv" "$dir/copy.csv"
verdict "what is refused changes no row" $?
"$program" "$@" --out "$dir/swept.csv" --svg "$dir/swept.svg"
has "a complete file is only drawn" "$dir/swept.svg" "</svg>"
set -- sweep rig --sweep force.frequency=150:160:2 --settle 10 --family force.amplitude=1:3:3
for i in 1 2 3; do "$program" "$@" --shard $i/3 --out "$dir/chain$i.csv"; done

(share_rows "$dir/chain1.csv" && share_rows "$dir/chain2.csv" | head -n 3 && share_rows "$dir/chain3.csv") >"$dir/torn.csv"
refuses 2 "torn.csv:9: rows are missing before this one" "$@" --out "$dir/torn.csv"
share_rows "$dir/chain1.csv" "$dir/chain2.csv" "$dir/chain3.csv" >"$dir/joined.csv"
"$program" "$@" | cmp -s - "$dir/joined.csv"
verdict "the rows of shares are one run's file" $?
refuses 2 "chain1.csv:1: a line of a share.*contactplant merge" "$@" --out "$dir/chain1.csv"
for damage in 'NR == 7 { sub(/160/, "168") }' 'NR == 6 { next }' 'NR == 7 { print }' 'NR == 6 { held = $0; next } NR == 7 { $0 = $0 "\n" held }' \
    'NR == 7 { $0 = substr($0, 1, 60) }'; do
    awk "$damage { print }" "$dir/joined.csv" >"$dir/torn.csv"
    cp "$dir/torn.csv" "$dir/copy.csv"
    refuses 2 "torn.csv:[678]: this row, or one before it, was changed or lost, and left as it is; cut the file" "$@" --out "$dir/torn.csv"
    cmp -s "$dir/torn.csv" "$dir/copy.csv"
    verdict "a damaged file is left as it is" $?
done
head -n 5 "$dir/copy.csv" >"$dir/torn.csv"
"$program" "$@" --out "$dir/torn.csv"
cmp -s "$dir/torn.csv" "$dir/joined.csv"
verdict "cut off before the damage, it is gone on with" $?
share_rows "$dir/chain2.csv" "$dir/chain1.csv" "$dir/chain3.csv" >"$dir/torn.csv"
refuses 2 "torn.csv:1: not of this run and shard" "$@" --out "$dir/torn.csv"
mkfifo "$dir/pipe"
refuses 1 "no file on a disk" "$@" --out "$dir/pipe"
refuses 1 "no file on a disk" "$@" --out /dev/full
ln -s joined.csv "$dir/link.csv"
refuses 2 "choose two files" "$@" --out "$dir/joined.csv" --svg "$dir/link.csv"
refuses 2 "choose two files" "$@" --out "$dir/new.csv" --svg "$dir/./new.csv"
ln -s new.csv "$dir/ahead.csv" # a link to what is not there yet
refuses 2 "choose two files" "$@" --out "$dir/new.csv" --svg "$dir/ahead.csv"
[ ! -e "$dir/new.csv" ]
verdict "and nothing is made" $?
set -- sweep rig --sweep force.frequency=150:200:10 --settle 5000
"$program" "$@" >"$dir/whole.csv"
"$program" "$@" --out "$dir/shared.csv" 2>"$dir/shared.err" &
child=$!
children="$children $child"
until_true rows "$dir/shared.csv" 0
kill -STOP $child # it holds its file however slow this shell is
refuses 1 "shared.csv: another process writes it" "$@" --out "$dir/shared.csv"
kill -KILL $child
wait $child 2>/dev/null
"$program" "$@" --out "$dir/shared.csv"
cmp "$dir/whole.csv" "$dir/shared.csv"
verdict "killed, its file is free, and gone on with" $?
interrupted 3 "$dir/swept2.csv" "$@"
is "interrupted sweep: status" $? 1
has "and how to go on" "$dir/err" "interrupted.*the same command goes on from there"
"$program" "$@" --out "$dir/swept2.csv"
cmp "$dir/whole.csv" "$dir/swept2.csv"
verdict "gone on with, it is the whole file" $?

echo "--- stability and random"
refuses 2 "there are floquet, contact" stability --map tongue
refuses 2 "is for --map contact" stability --periods 9
refuses 2 "write NAME=FROM:TO:N" stability --x step
refuses 2 "did you mean stiffness" stability --y stifness=1:2:3
refuses 2 "take two different" stability --map contact --x step=1e-6:1e-5:3 --y step=1e-6:1e-4:3
refuses 2 "no input modulates" stability rolling_contact
refuses 2 "single Hertzian contact" stability shaft_bearing
refuses 2 "fewer than 2 steps" stability --step 3
refuses 2 "has no frequency there" stability --x stiffness.frequency=0:10:3
refuses 2 "piecewise linear" stability --method exact
refuses 2 "noise is held" stability nayak-random --map contact --y zeta=0.1:0.2:3
refuses 2 "give --out too" stability --svg "$dir/x.svg"
refuses 2 "scene itself" stability "$dir/swept.ini" --out "$dir/swept.ini"
refuses 2 "cannot write --out" stability --out "$dir/nosuch/x.csv"
refuses 2 "give I/N with 1 <= I <= N" stability --shard 102/101
refuses 2 "something is missing" random
refuses 2 "no input of this scene has noise" random rig
refuses 2 "shorter than three steps" random nayak-random --over 0.05
refuses 2 "more than 1e8 frames; give at most" random nayak-random --over 1e9
refuses 2 "write FROM:TO" random nayak-random --range 3
refuses 2 "smaller end first" random nayak-random --range 3:2
refuses 2 "did you mean penetration" random nayak-random --observable penetraton
refuses 2 "more than a plant takes; give at most" random nayak-random --set force.noise=1e9
refuses 2 "not a whole number of steps" random nayak-random --set force.noise_hold=0.11
refuses 2 "piecewise linear" random nayak-random --method exact
refuses 2 "choose two files" random nayak-random --out "$dir/x.csv" --svg "$dir/x.csv"
refuses 2 "cannot write --out" random nayak-random --out "$dir/nosuch/x.csv"
# resumes LINES COMMAND...: interrupted, gone on with, cut off and in shards it is the same file; another run's is left.
resumes() {
    n_lines=$1
    shift
    rm -f "$dir"/m_*.csv
    "$program" "$@" --shard 1/1 --out "$dir/m_whole.csv" 2>"$dir/err"
    is "$1: rows" "$(wc -l <"$dir/m_whole.csv")" "$n_lines"
    interrupted 3 "$dir/m_part.csv" "$@" --shard 1/1 --cores 1
    is "$1 interrupted: status" $? 1
    has "and how to go on" "$dir/err" "interrupted.*the same command goes on from there"
    "$program" "$@" --shard 1/1 --out "$dir/m_part.csv" 2>"$dir/err"
    cmp "$dir/m_whole.csv" "$dir/m_part.csv"
    verdict "gone on with, it is the whole file" $?
    head -c 30000 "$dir/m_whole.csv" >"$dir/m_part.csv"
    "$program" "$@" --shard 1/1 --out "$dir/m_part.csv" 2>"$dir/err"
    cmp "$dir/m_whole.csv" "$dir/m_part.csv"
    verdict "cut off inside a row, too" $?
    for i in 1 2 3; do "$program" "$@" --shard $i/3 --out "$dir/m_shard$i.csv" 2>"$dir/err"; done
    "$program" merge "$dir/m_joined.csv" "$dir"/m_shard?.csv >"$dir/out" && cmp "$dir/m_joined.csv" "$dir/m_whole.csv"
    verdict "three shares merge to it" $?
    share_rows "$dir/m_shard1.csv" "$dir/m_shard3.csv" >"$dir/m_part.csv"
    refuses 2 "rows are missing before this one, and left as it is" "$@" --out "$dir/m_part.csv"
    (share_rows "$dir/m_shard1.csv" | head -c 9000 && share_rows "$dir/m_shard2.csv") >"$dir/m_part.csv"
    refuses 2 "this row, or one before it, was changed or lost, and left as it is" "$@" --out "$dir/m_part.csv"
    rm "$dir/m_part.csv"
    (
        ulimit -f 2
        "$program" "$@" --shard 1/1 --out "$dir/m_part.csv" 2>"$dir/err"
    )
    is "$1 at a limit of file size, status" $? 1
    has "and what happened" "$dir/err" "cannot be written (File too large).*the same command goes on from there"
    cp "$dir/m_shard2.csv" "$dir/m_copy.csv"
    refuses 2 "not of this run and shard, and left as it is" "$@" --shard 3/3 --out "$dir/m_shard2.csv"
    refuses 2 "not of this run and shard, and left as it is" "$@" --shard 2/3 --set "$damping" --out "$dir/m_shard2.csv"
    cmp -s "$dir/m_shard2.csv" "$dir/m_copy.csv"
    verdict "a file of something else is not touched" $?
}
damping="damping=100"
resumes 6001 stability hertz_rig --method rk4 --x stiffness.frequency=100:400:60
damping="zeta=0.06"
resumes 41 random nayak-random --seeds 40 --over 1500
"$program" random nayak-random --seeds 40 --over 1500 --out "$dir/m_whole.csv" --svg "$dir/m.svg" --statistics "$dir/m_stat.csv" >"$dir/out" 2>"$dir/err"
is "a complete file is summed up" "$(grep -c ^density "$dir/m_stat.csv")" 60
has "and in words" "$dir/out" "^standard deviation: 0\\.4.* +- .*; closed form 0\\.4"
is "levels that nothing crosses have no mean stay" "$(grep -c '^exceedance,[^,]*,,,' "$dir/m_stat.csv") $(grep -c -- nan "$dir/m_stat.csv")" \
    "$(grep -c '^crossing_rate,.*,0,0,' "$dir/m_stat.csv") 0"
has "with standard errors and the closed form" "$dir/m_stat.csv" "^kind,at,value,standard_error,closed_form"
has "and drawn" "$dir/m.svg" "closed form"
runs 1 "a full disk for the sums, status" random nayak-random --seeds 40 --over 1500 --out "$dir/m_whole.csv" --statistics /dev/full
has "a full disk for the sums, said" "$dir/err" "the rows are complete"
runs 1 "no place for the picture, status" random nayak-random --seeds 40 --over 1500 --out "$dir/m_whole.csv" --svg /dev/full
has "no place for the picture, said" "$dir/err" "the rows are complete, give the same command"
"$program" stability hertz_rig >/dev/full 2>"$dir/err"
is "a full disk for rows, status" $? 1
has "a full disk for rows, said" "$dir/err" "cannot be written"

echo "--- simulate chooses the method"
# chosen WANTED TIME ARGUMENTS...: the method that a run up to TIME names on stderr.
chosen() {
    wanted=$1
    at=$2
    shift 2
    "$program" simulate "$@" --at "$at" >"$dir/out" 2>"$dir/err"
    is "method of simulate $*" "$(sed 's/.*done by method //' "$dir/err")" "$wanted"
}
chosen taylor 1 hertz_rig --set xi=0.1
chosen taylor 1 hertz_rig --set xi=0.1 --method auto --tol 1e-6 --step 0.01
chosen rk4 1 hertz_rig --set xi=0.1 --tol 1e-4 --step 0.01
chosen taylor 1 hertz_rig --set xi=0.1 --tol 1e-4 --step 0.1
chosen rk4 0.02 hertz_rig --set xi=0.1 --tol 1e-4 --step 0.1 # the rows are nearer than the step
chosen taylor 1 hertz_rig_cubic --tol 1e-2
chosen exact 1 hertz_rig_linear --tol 1e-2
chosen exact 1 shaft_bearing
"$program" simulate hertz_rig --set xi=0.1 --method rk4 --at 1 >"$dir/out" 2>"$dir/err"
is "a method that was named needs no word" "$(wc -c <"$dir/err")" 0
set -- hertz_rig --set xi=0.01 --set sigma=0.5 --set omega=0.9 --until 50 --every 1
"$program" simulate "$@" >"$dir/chosen.csv" 2>/dev/null
"$program" simulate "$@" --method taylor --tol 1e-12 >"$dir/named.csv"
cmp -s "$dir/chosen.csv" "$dir/named.csv"
verdict "a run by choice is that of the method named" $?
"$program" simulate hertz_rig_averaged --units si --set fast_frequency_Hz=60 --set fast_stiffness=0.2 --until 0.01 >"$dir/out" 2>"$dir/err"
has "a bare averaged model whose drive is not fast is warned of" "$dir/err" "warning: .*averaging needs a fast frequency of at least 3 times every slow one"
"$program" simulate hertz_rig_averaged --units si --set fast_frequency_Hz=2000 --set fast_stiffness=0.2 --until 0.01 >"$dir/out" 2>"$dir/err"
is "one whose drive is fast is not" "$(grep -c warning "$dir/err")" 0
refuses 2 "coarse for exact.*--step .* would do" simulate shaft_bearing --units si --step 0.01 --at 1
refuses 2 "no such method" simulate --method automatic

echo "--- scenes"
"$program" list scenes >"$dir/out"
is "list scenes, status" $? 0
is "it names those to begin with" "$(sed -n 's/^    \([^ ]*\) .*/\1/p' "$dir/out" | xargs)" "rig tip shaft soft seed tapping stiff"
"$program" list papers >"$dir/out"
is "list papers, status" $? 0
for preset in bbp-fig5-base kb-fig16 nayak-fig10 shaft-fig9; do
    has "list names $preset" "$dir/out" "^ *$preset "
done
for preset in $("$program" list | sed -n '/^scenes /,/^settings/p' | sed -n 's/^    \([a-z][^ ]*\).*/\1/p'); do
    grep -q "^| \`$preset\` " docs/reference/presets.md
    verdict "docs/reference/presets.md has $preset" $?
done
# The command lines of the figures, for two values side by side where their ranges end: there is no jump to look for.
grep -o '^| [^|]*| `sweep [^`]*`' docs/reference/presets.md | sed -e 's/.*`\(.*\)`/\1/' | perl -pe '
    $number = qr/[-+]?[0-9.]+(?:e[-+]?[0-9]+)?/; s/=($number)([^:\s]*):($number)([^:\s]*):\d+/"=" . ($3 - 1e-6 * ($3 - $1)) . "$2:$3$4:2"/ge' >"$dir/figures"
is "figures of docs/reference/presets.md that are sweeps" "$(wc -l <"$dir/figures")" 31
while read -r line; do
    # shellcheck disable=SC2086
    "$program" $line --settle 1 --measure 4 --out "$dir/figure.csv" >"$dir/out" 2>"$dir/err" </dev/null
    is "$line, status" $? 0
    rm -f "$dir/figure.csv"
done <"$dir/figures"
"$program" scene rig >"$dir/rig.ini"
is "scene prints a file, status" $? 0
"$program" simulate rig --until 0.1 >"$dir/preset.csv" 2>"$dir/err"
"$program" simulate "$dir/rig.ini" --until 0.1 >"$dir/file.csv" 2>>"$dir/err"
cmp -s "$dir/preset.csv" "$dir/file.csv"
verdict "which simulates to the same bytes as the preset" $?
is "the observable is the last column" "$(head -n 1 "$dir/preset.csv")" "t,position,velocity,penetration"
is "rows are frames, as far as asked" "$("$program" simulate rig 2>"$dir/err" | wc -l)" 2002
is "a sound scene gets no warning" "$(grep -c warning "$dir/err")" 0
# (N/k)^(2/3)
near "penetration at rest, m" "$(sed -n 2p "$dir/preset.csv" | cut -d, -f4)" 7.0762098645e-6 1e-14
"$program" simulate rig --set preload_N=100 --drive force=0,0,0 --at 0,0.01 >"$dir/out" 2>"$dir/err"
near "options stand above the scene" "$(tail -n 1 "$dir/out" | cut -d, -f4)" 9.5282700038e-6 1e-14
runs 3 "a scene that escapes, status" simulate kb-fig7
has "and was warned of, with paper and reason" "$dir/err" "warning: Kirrou & Belhaq 2013 .*escapes"
is "a paper's scene has the paper's states" "$(head -n 1 "$dir/out")" "t,q,q_dot,penetration"
# q at the first times of an independent reference trajectory of the same equation and parameters, from 0.05
"$program" simulate kb-fig16 --state 0.05,0 --at 5,10 --method taylor --tol 1e-12 >"$dir/out" 2>"$dir/err"
near "kb-fig16 at t = 5" "$(sed -n 2p "$dir/out" | cut -d, -f2)" 7.47410094265714061e-3 1e-11
near "kb-fig16 at t = 10" "$(sed -n 3p "$dir/out" | cut -d, -f2)" -7.96195363421808284e-2 1e-11
"$program" simulate nayak-random --until 100 >"$dir/out" 2>/dev/null
"$program" simulate nayak-random --at 100 2>/dev/null | tail -n 1 >"$dir/last"
near "noise of a scene does not depend on the rows" "$(tail -n 1 "$dir/out" | cut -d, -f4)" "$(cut -d, -f4 "$dir/last")" 1e-9
sed -n '/^```ini/,/^```$/p' docs/guide/scenes.md | sed '1d;$d' >"$dir/manual.ini"
runs 0 "the manual's example runs" simulate "$dir/manual.ini" --until 0.1
cp "$program" "$dir/binary.ini"
mkdir "$dir/folder.ini"
printf '[plant]\nmodel = hertz_rig\nmas = 3 kg\n' >"$dir/key.ini"
printf '[plant]\nmodel = hertz_rig\nmass = 3 s\n' >"$dir/unit.ini"
printf '[plant]\nmodel = hertz_rig\nmass = 0 kg\n' >"$dir/range.ini"
printf '[plant]\nmodel = hertz_rig\nmass = 3 kg\nmass = 4 kg\n' >"$dir/twice.ini"
printf '[plant]\nmodel = hertz_rig\n[deadline]\ncost = 1 ms\n' >"$dir/late.ini"
printf '[plant]\nmodel = hertz_rig\nmethod = exact\n' >"$dir/method.ini"
printf '[plant]\nmodel = hertz_rig\000\n' >"$dir/null.ini"
printf '[plant]\nModel = hertz_rig\n' >"$dir/case.ini"
printf '[plant] model = hertz_rig\n' >"$dir/alone.ini"
printf '[plant]\nmodel = hertz_rig\n[ask]\ntolerance = 1e-14\n' >"$dir/sharp.ini"
printf '[plant]\nmodel = hertz_rig\n[drive force]\namplitude = 1 N\nfrequency = 3 MHz\n' >"$dir/fast.ini"
printf '[plant]\nmodel = hertz_rig\n[drive force]\nnoise_seed = -1\n' >"$dir/seed.ini"
printf '[plant]\nmodel = hertz_rig\nmass = 0.%060d1 kg\n' 0 >"$dir/digits.ini"
printf '\357\273\277[plant]\nmodel = hertz_rig\n' >"$dir/mark.ini"
head -c 70000 /dev/zero | tr '\000' '\n' >"$dir/huge.ini"
: >"$dir/empty.ini"
# One reader serves every command; run and simulate show that they ask it.
refuses 2 "no such model, preset or file: \"nayak-fig1\"; did you mean nayak-fig" scene nayak-fig1
refuses 2 "no such model, preset or file: \"$dir/nosuch.ini\"" scene "$dir/nosuch.ini"
refuses 2 "cannot read .*folder.ini" scene "$dir/folder.ini"
refuses 2 "binary.ini: larger than 65536 bytes" scene "$dir/binary.ini"
refuses 2 "huge.ini: larger than 65536 bytes" scene "$dir/huge.ini"
refuses 2 "empty.ini: no model" scene "$dir/empty.ini"
refuses 2 "null.ini:2: byte 0x00" scene "$dir/null.ini"
refuses 2 "key.ini:3: mas: no such key in .plant. of hertz_rig; did you mean mass" scene "$dir/key.ini"
refuses 2 "unit.ini:3: mass: the unit .s. does not fit; give kg" scene "$dir/unit.ini"
refuses 2 "range.ini:3: mass: 0 kg is out of range; give 1e-09 to 1e+06 kg" scene "$dir/range.ini"
refuses 2 "twice.ini:4: mass: set in line 3 already" scene "$dir/twice.ini"
refuses 2 "method.ini:3: method: exact is for piecewise linear" scene "$dir/method.ini"
refuses 2 "case.ini:2: Model: .*did you mean model" scene "$dir/case.ini"
refuses 2 "alone.ini:1: .*a section stands alone in its line" scene "$dir/alone.ini"
refuses 2 "sharp.ini:4: tolerance: taylor: tolerance outside" scene "$dir/sharp.ini"
refuses 2 "fast.ini:5: frequency: .*4096 substeps, the most, do up to 0.341 times" scene "$dir/fast.ini"
refuses 2 "seed.ini:4: noise_seed: -1 is out of range; give 0 to 4294967295" scene "$dir/seed.ini"
refuses 2 "digits.ini:3: mass: .* has more than 40 digits" scene "$dir/digits.ini"
runs 0 "a byte order mark" scene "$dir/mark.ini"
refuses 2 "late.ini:4: cost: 64 steps of 1000 us take longer than the frame" scene "$dir/late.ini"
for command in run simulate; do
    refuses 2 "no such model, preset or file: \"nayak-fig1\"; did you mean nayak-fig" $command nayak-fig1
    refuses 2 "key.ini:3: mas: no such key in .plant. of hertz_rig; did you mean mass" $command "$dir/key.ini"
    refuses 2 "late.ini:4: cost: 64 steps of 1000 us take longer than the frame" $command "$dir/late.ini"
done
refuses 2 "exact is for piecewise linear" run rig --method exact
refuses 2 "exact is for piecewise linear" simulate rig --method exact
echo kept >"$dir/kept.csv"
refuses 2 "exact is for piecewise linear" simulate "$dir/rig.ini" --method exact --out "$dir/kept.csv"
is "a refused run leaves its files alone" "$(cat "$dir/kept.csv")" kept
refuses 2 "is the scene itself" simulate "$dir/rig.ini" --out "$dir/rig.ini"
refuses 2 "mass_kg is given twice" simulate rig --set mass_kg=1 --set mass_kg=2
refuses 2 "choose two files" simulate rig --out "$dir/kept.csv" --events "$dir/kept.csv"
refuses 2 "choose two files" simulate rig --out "$dir/kept.csv" --events "$dir/./kept.csv"
is "two outputs in one file leave it alone" "$(cat "$dir/kept.csv")" kept
refuses 2 "choose two files" choose rig --out "$dir/kept.csv" --json "$dir/kept.csv"
refuses 2 "choose two files" choose rig --out "$dir/neither.x" --json "$dir/./neither.x"
refuses 2 "choose two files" choose rig --out neither.x --json ./neither.x
refuses 2 "out of range" simulate tapping --set quality=0.1
refuses 2 "is no AFM lever" approach rig
refuses 2 "not below the scene" approach soft --to 1e-3
refuses 2 "give a --speed" approach soft --speed 1e-12
refuses 2 "cannot write --out" approach soft --out "$dir/no/such.csv"
refuses 2 "choose two files" approach soft --out "$dir/x.csv" --tab "$dir/x.csv"
"$program" approach soft --points 100 --set temperature="0 K" --set height="60 nm" --speed 1e-7 --out "$dir/curve.csv" \
    --svg "$dir/curve.svg" --tab "$dir/curve.tab" >"$dir/err"
is "approach, status" $? 0
is "approach: rows" "$(wc -l <"$dir/curve.csv")" 201
has "approach: a picture" "$dir/curve.svg" "retract"
has "approach: snap-in within 2 % of 1.5326 nm" "$dir/err" "begins with the base at 1\\.5[0-5]"
cat >"$dir/tab.py" <<'EOF'
import json, sys
lines = open(sys.argv[1]).read().splitlines()
begin, end = lines.index("# BEGIN METADATA"), lines.index("# END METADATA")
meta = json.loads("\n".join(line.strip("#").strip() for line in lines[begin + 1:end]))
header = [line for line in lines if line.startswith("#")][-1].strip("#").strip().split("\t")
rows = [dict(zip(header, line.split("\t"))) for line in lines if not line.startswith("#")]
known = ["force", "height (measured)", "height (piezo)", "index", "segment", "time", "tip position"]
assert header == known and len(rows) == meta["point count"] == 200, (header, len(rows))
assert meta["imaging mode"] == "force-distance" and meta["spring constant"] == 0.2, meta
assert [row["segment"] for row in rows] == 100 * ["False"] + 100 * ["True"]
away = [abs(float(r["tip position"]) - float(r["height (measured)"]) - float(r["force"]) / 0.2) for r in rows]
assert max(away) < 1e-15, max(away)
assert abs(float(rows[-1]["time"]) * 200 / 199.5 - meta["duration"]) < 1e-6 * meta["duration"]
print(min(float(r["force"]) for r in rows) * 1e9)
EOF
near "approach: .tab read back, pull-off force, nN" "$(/usr/bin/python3 "$dir/tab.py" "$dir/curve.tab")" -3.9 0.3
has "approach: pull-off within 1 % of 19.755 nm" "$dir/err" "ends with the base at 19\\.[67]"
refuses 2 "cannot write --tab" approach soft --points 10 --tab "$dir/no/such.tab" --out "$dir/curve.csv"
echo "--- the microscope"
refuses 2 "is no AFM lever" scan rig
refuses 2 "is no AFM lever" thermal rig
refuses 2 "ki: " scan --set ki=many
refuses 2 "out of range" scan --set pixels=0
refuses 2 "pixles: no such number in this scene; did you mean pixels?" scan --set pixles=12
refuses 2 "foo: no such number in this scene; contactplant list microscope shows them" scan --set foo=7
refuses 2 "setpoint_m is not below the free amplitude" scan --set setpoint="30 nm"
refuses 2 "drive_m the lock-in would listen to a silent tone" scan --set drive=0
refuses 2 "ki is 0" scan --set ki=0
refuses 2 "z_min_m is nearer than the surface" scan --set z_min="-10 nm"
refuses 2 "inside the surface at the start" scan --set surface=2 --set surface_height="900 nm"
refuses 2 "surface is from a file, and there is none" scan --set surface=5
refuses 2 "give 0 to 4; contactplant scan alone takes a file" run microscope --set surface=5
refuses 2 "ramp_speed: the unit is missing; it is m/s" \
    send --model microscope set ramp_speed=1e-6
refuses 2 "cannot read --surface" scan --surface "$dir/none.gsf"
refuses 2 "is no file of Gwyddion" scan --surface "$dir/rig.ini"
# Heights of 1e-8 m with the high byte first are 8e33 m.
{ printf 'Gwyddion Simple Field 1.0\nXRes = 2\nYRes = 2\n\0\0\0\0' && printf '\062\053\314\167\062\053\314\167\062\053\314\167\062\053\314\167'; } >"$dir/big.gsf"
refuses 2 "as float32 with the low byte first" scan --surface "$dir/big.gsf" --out "$dir/scan"
touch "$dir/no"
refuses 2 "choose another folder" scan --out "$dir/no/such"
refuses 1 "cannot make the directory" scan --out /proc/no/such
refuses 1 "has not found the surface" scan --set z_loop=2 --set drive=0 --set setpoint="-30 nm" --out "$dir/scan"
refuses 2 "at 0 K" thermal --set temperature="0 K"
refuses 2 "fewer than two segments" thermal --seconds 0.001
refuses 2 "cannot write --out" thermal --seconds 0.25 --out "$dir/no/such.csv"
cat >"$dir/stage.ini" <<'EOF'
[plant]
model = hertz_rig
[drive force]
amplitude = 5 N
frequency = 200 Hz
noise = 1 N
[stage force]
gain = 0.5
EOF
for command in sweep basin stability random choose; do
    refuses 2 "it has a \[stage\], which works in run, simulate, test, scan and thermal" $command "$dir/stage.ini"
done
sed -i '/^noise/d' "$dir/stage.ini"
{ cat "$dir/stage.ini"; printf '[stage velocity]\ngain = 3\n'; } >"$dir/sensor.ini"
printf '[plant]\nmodel = afm_lever\n[stage z]\nlag = 5 kHz\n' >"$dir/slow.ini"
refuses 2 "it has a \[stage\]" approach "$dir/slow.ini"
refuses 2 "it has a sensor, whose reading is on the bus alone" fmu "$dir/sensor.ini" --out "$dir/no.fmu"
refuses 2 "a stage goes from step to step" simulate "$dir/stage.ini" --at 0.00012345
"$program" simulate "$dir/sensor.ini" --until 0.05 >"$dir/out" 2>"$dir/err"
# the force at the begin of the last tick, 1/64000 s ago; the sensor has the velocity's truth times 3
sed 1d "$dir/out" | awk -F, '
    { wanted = 2.5 * cos(2 * 3.14159265358979 * 200 * ($1 - 1 / 64000)); off = $5 - wanted; seen = $6 - 3 * $3 }
    NR > 1 && (off * off > 1e-16 || seen * seen > 1e-24) { bad++ } END { exit bad > 0 || NR != 51 }'
verdict "simulate: actuator and sensor of a scene" $? "$(head -3 "$dir/out")"
is "simulate: columns of stages" "$(head -1 "$dir/out")" "t,position,velocity,penetration,stage_force,stage_velocity"
"$program" scan --set pixels=2 --set lines=1 --out "$dir/not/yet/scan" 2>"$dir/err"
has "scan: warns with the number" "$dir/err" "warning: a pixel of 1 ms is shorter than the lever's ring time 2 Q/w0 = 1.82 ms"
"$program" scan --set surface=2 --set surface_height="50 nm" --set height="100 nm" --set ki=3000 --set pixels=32 --set lines=1 --set crash="50 nN" --out "$dir/scan" >"$dir/out" 2>"$dir/err"
has "scan: a crash has its peak force and its place" "$dir/out" "[1-9] crashes above 50 nN.*the last crash had [0-9.]* nN, at x [0-9.]* nm"
grating="--set surface=2 --set pixels=32 --set lines=6 --set pixel_s=3e-3"
runs 0 "scan, status" scan $grating --set surface_height="4 nm" --out "$dir/scan"
has "scan: verdict" "$dir/out" "largest force .* nN, 0 crashes"
is "scan: files" "$(cd "$dir/scan" && echo *)" "$(for i in amplitude error height peak_force phase; do echo $i.gsf $i.png ${i}_back.gsf ${i}_back.png; done | xargs)"
range="$(tail -c 768 "$dir/scan/height.gsf" | od -An -v -tf4 -w4 | sort -g | awk 'NR == 1 { a = $1 } { b = $1 } END { printf "black is %.4g m, white is %.4g m", a, b }')"
is "scan: a picture tells the range of its field" "$(grep -ao 'Description.black is .* m, white is [^ ]* m' "$dir/scan/height.png" | tail -c +13)" "$range"
has "scan: and so does the output" "$dir/out" "^height.png: $range$"
is "scan: 32 x 6 values of a square micrometre are 32 x 32 square dots" "$(od -An -tu1 -j16 -N8 "$dir/scan/height.png" | xargs)" "0 0 0 32 0 0 0 32"
"$program" scan $grating --set surface_height="4 nm" --out "$dir/again" 2>/dev/null
diff -r "$dir/scan" "$dir/again" >"$dir/out"
verdict "scan: the same seed gives the same bytes" $? "$(cat "$dir/out")"
cat >"$dir/piezo.ini" <<'EOF'
[plant]
model = afm_lever
height = 14 nm
temperature = 295 K
[stage z]
resonance = 5 kHz
creep_per_decade = 0.015
[stage deflection]
noise_density = 100 fm/sqrt(Hz)
EOF
refuses 2 "is below the noise of a cycle: the sensor alone reads up to" scan "$dir/piezo.ini" --set peak_force=5nN --set ticks=2
refuses 2 "is below the noise of a cycle: the sensor alone reads up to" run microscope --substeps 2400 \
    --set peak_force=5nN --set ticks=2 --set stage_0_at=5 --set stage_0_noise_density=1e-13
cut="scan $dir/piezo.ini --set surface=2 --set pixels=48 --set lines=12 --set pixel_s=2e-3"
"$program" $cut --out "$dir/whole" 2>/dev/null &
uncut=$!
"$program" $cut --out "$dir/cut" 2>/dev/null &
scanning=$!
children="$children $uncut $scanning"
for i in $(seq 400); do [ -e "$dir/cut/scan.part" ] && break; sleep 0.05; done
runs 1 "scan: another one in its directory, status" $cut --out "$dir/cut"
has "scan: and the reason" "$dir/err" "another scan is writing there"
kill -9 $scanning
wait $scanning $uncut
is "scan: cut off by SIGKILL, there is no image yet" "$(ls "$dir/cut")" "scan.part"
cp "$dir/cut/scan.part" "$dir/part"
refuses 1 "belongs to a scan of other numbers, and is left as it is" $cut --set ki=274 --out "$dir/cut"
{ head -c 5000 "$dir/part"; printf '\377'; tail -c +5002 "$dir/part"; } >"$dir/cut/scan.part"
refuses 1 "is damaged: its check does not fit" $cut --out "$dir/cut"
head -c 5000 "$dir/part" >"$dir/cut/scan.part"
refuses 1 "is damaged: bytes are missing" $cut --out "$dir/cut"
echo hello >"$dir/cut/scan.part"
refuses 1 "is no scan" $cut --out "$dir/cut"
cp "$dir/part" "$dir/cut/scan.part"
runs 0 "scan: the same command goes on, status" $cut --out "$dir/cut"
has "scan: and says where" "$dir/err" "goes on in line [0-9]* of 12"
diff -r "$dir/whole" "$dir/cut" >"$dir/out"
verdict "scan: cut off and taken up, equal bytes and nothing left over" $? "$(cat "$dir/out")"
"$program" scan --surface "$dir/scan/height.gsf" --set pixels=8 --set lines=2 --set pixel="2 ms" --set pll=1 --out "$dir/from" 2>"$dir/err"
is "scan of a surface from a file, status" $? 0
is "scan with a PLL: frequency, too" "$(ls "$dir/from" | grep -c frequency)" 4
cat >"$dir/read.py" <<'EOF'
import struct, sys
data = open(sys.argv[1], "rb").read()
n = data.index(b"\0") // 4 * 4 + 4
line = sorted(struct.unpack("<192f", data[n:])[64:96])
print((line[24] - line[7]) * 1e9)
EOF
near "python reads the height of the lines, nm" "$(/usr/bin/python3 "$dir/read.py" "$dir/scan/height.gsf")" 4 0.6
cp "$dir/scan/height.gsf" "$dir/nan.gsf"
printf '\000\000\300\177' | dd of="$dir/nan.gsf" bs=1 seek=$(($(stat -c %s "$dir/nan.gsf") - 4)) conv=notrunc 2>/dev/null
refuses 2 "no number, in row 6, column 32" scan --surface "$dir/nan.gsf"
printf 'x' >>"$dir/scan/height.gsf"
refuses 2 "wrong size" scan --surface "$dir/scan/height.gsf"
runs 0 "demo afm, status" demo afm --out "$dir/demo"
has "demo afm: verdicts" "$dir/out" "^scan: largest force [12].* nN, 0 crashes above 100 nN; off the surface in [1-4]\\.. %"
is "demo afm: three images and their grey scales in the picture" "$(grep -c 'data:image/png;base64' "$dir/demo/afm.svg")" 6
has "demo afm: parachuting is shaded" "$dir/demo/afm.svg" 'fill="#d55e00" fill-opacity=".13"'
refuses 2 "write afm" demo fma
"$program" thermal --seconds 1 --out "$dir/heat.csv" --svg "$dir/heat.svg" >"$dir/err"
is "thermal, status" $? 0
"$program" thermal soft --seconds 3600 >"$dir/hot.out" 2>"$dir/hot.err" &
children="$children $!"
pid=$!
until_true grep -q "SigCgt:.*[2367abef]$" /proc/$pid/status # it catches SIGINT
kill -INT $pid
wait $pid
is "thermal and Ctrl-C, status" $? 1
has "thermal and Ctrl-C, said" "$dir/hot.err" "^contactplant thermal: interrupted$"
has "thermal: columns" "$dir/heat.csv" "^frequency_Hz,density_m2_per_Hz,fit_m2_per_Hz"
has "thermal: a picture" "$dir/heat.svg" "fitted oscillator"
near "thermal: stiffness, N/m" "$(sed -n 's/.*over it: \([0-9.]*\) N.*/\1/p' "$dir/err")" 2 0.34
# A sensor that reads double has a quarter of the stiffness; a piezo of half the gain is one of the whole with half of ki.
"$program" scene tapping >"$dir/lever.ini"
{ cat "$dir/lever.ini"; printf '[stage deflection]\ngain = 2\n'; } >"$dir/doubled.ini"
{ cat "$dir/lever.ini"; printf '[stage z]\ngain = 0.5\n'; } >"$dir/half.ini"
{ cat "$dir/lever.ini"; printf '[stage gap]\ngain = 2\n'; } >"$dir/gap.ini"
"$program" thermal "$dir/doubled.ini" --seconds 1 --out "$dir/heat2.csv" >"$dir/err2"
near "thermal with [stage deflection] gain 2: stiffness, N/m" "$(sed -n 's/.*over it: \([0-9.]*\) N.*/\1/p' "$dir/err2")" \
    "$(sed -n 's/.*over it: \([0-9.]*\) N.*/\1/p' "$dir/err" | awk '{print $1 / 4}')" 0.001
grating="--set surface=2 --set pixels=32 --set lines=2 --set pixel_s=3e-3 --set surface_height=4e-9"
"$program" scan "$dir/lever.ini" $grating --set ki=200 --out "$dir/whole" 2>/dev/null
"$program" scan "$dir/half.ini" $grating --set ki=400 --out "$dir/half" 2>/dev/null
diff -r "$dir/whole" "$dir/half" >"$dir/out"
verdict "scan with [stage z] gain 0.5 and twice ki: the same images" $? "$(cat "$dir/out")"
refuses 2 "its piezo, and \[stage deflection\], its sensor" scan "$dir/gap.ini"
refuses 2 "inside the surface" simulate soft --set height_m=-400e-9
refuses 2 "is the scene itself" run "$dir/rig.ini" --log "$dir/./rig.ini"
"$program" scene "$dir/rig.ini" >"$dir/again.ini"
sed 1d "$dir/rig.ini" >"$dir/rig.body"
sed 1d "$dir/again.ini" | cmp -s - "$dir/rig.body"
verdict "the scene is still there, and prints as it was" $?
refuses 2 "a scene has its own units" simulate rig --units si
refuses 2 "needs --units si" simulate kb-fig16 --drive force=1,1,0
refuses 2 "4 steps in a period" run rig --rate 400 --substeps 1
refuses 2 "no such number in this scene" simulate kb-fig16 --set mass_kg=1
plant scene $port rig --log "$dir/scene.log" $patient
speak 1 $port send start --model rig --hold 1.5 >"$dir/out" 2>&1
ends "$pid"
has "run takes a scene: its plant moved" "$dir/scene.out" "tick [1-9]"
has "and says whether a step kept to its cost" "$dir/scene.out" "^cost per step p99 .*asked 1 us"
"$program" replay "$dir/scene.log" rig $patient >"$dir/out" 2>&1
is "its log replays with the same scene, status" $? 0
refuses 1 "recorded.*replay sent" replay "$dir/scene.log" hertz_rig --method auto --tol 1e-4 $patient
printf '[plant]\nmodel = hertz_rig_linear\n[drive force]\namplitude = 30 N\nfrequency = 225 Hz\n[watch]\nbelow = 0 m\npromote = hertz_rig\n' >"$dir/watch.ini"
refuses 2 "the scene does not say when to climb; give it a .watch. with promote = hertz_rig" run hertz_rig_linear --promote
refuses 2 "an averaged model cannot climb" run hertz_rig_averaged --promote
refuses 2 "full model already" run rig --promote
refuses 2 "cannot run and climb to its full model: exact is for piecewise" run "$dir/watch.ini" --promote --method exact
plant watch $port "$dir/watch.ini" --log "$dir/watch.log" --promote $patient
listen "$dir/watch.seen" $port "$dir/watch.ini" --only WATCH,STATUS
speak 1 $port send start --model "$dir/watch.ini" --hold 1 >"$dir/out" 2>&1
until_true grep -q "STATUS.* WATCH=on" "$dir/watch.seen"
speak 1 $port send read mass_kg --model "$dir/watch.ini" >"$dir/out" 2>&1
has "after the climb the scene to give is still its own" "$dir/out" "^mass_kg = 6.5 kg$"

ends "$pid"
ends $listener
has "run says what tripped, and that it climbed" "$dir/watch.out" "^watch: penetration was -.* m at tick [0-9]*, outside its limits; the model is hertz_rig$"
has "and counts it" "$dir/watch.out" "^watch_trips  *1 "
has "monitor names the event" "$dir/watch.seen" "WATCH  *OBSERVABLE=penetration TICK=[0-9]* tick VALUE=-.* m$"
has "and the flag" "$dir/watch.seen" "STATUS.* WATCH=on"
replays watch "$dir/watch.log" "$dir/watch.ini" --promote $patient
refuses 1 "recorded.*replay sent" replay "$dir/watch.log" "$dir/watch.ini" $patient

echo "--- choose"
runs 0 "choose, status" choose rig --json "$dir/rig.json" --out "$dir/fast.ini"
has "says what it chose" "$dir/out" "^CHOSEN .* hertz_rig by "
has "why a reduced model was refused" "$dir/out" "hertz_rig_linear is refused: "
has "what it costs on a board" "$dir/out" "mps2-an500"
has "and what would void it" "$dir/out" "^VOID IF "
is "in lines that a terminal shows" "$(awk 'length > 100' "$dir/out" | wc -l)" 0
# a slow machine is told how far the search is
is "a sound scene gets no warning" "$(grep -vc '^contactplant choose: .* by .* substeps$' "$dir/err")" 0
/usr/bin/python3 - "$dir/rig.json" <<'END'
import json, sys
c = json.load(open(sys.argv[1]))
assert c["tolerance_met"] and c["deadline_met"] and c["choice"]["error"] <= c["asked"]["tolerance"]
assert c["candidates"][-1]["model"] == "hertz_rig" and not c["reduced"] and c["candidates"][0]["reduced"] and len(c["cost"]) == 5 and c["void_by"]
END
verdict "its JSON says the same" $?
"$program" simulate "$dir/fast.ini" --every 0.25 --out "$dir/fast.csv" 2>"$dir/err"
is "what it chose runs as a scene, status" $? 0
"$program" choose "$dir/fast.ini" >"$dir/out" 2>&1
is "and can be asked about again, status" $? 0
sed 's/^amplitude = 20 N/amplitude = 2 N/; s/^tolerance = 0.0001/tolerance = 0.02/' "$dir/rig.ini" >"$dir/small.ini"
"$program" choose "$dir/small.ini" --out "$dir/fast.ini" >"$dir/out" 2>&1
has "small motion is linear" "$dir/fast.ini" "^model = hertz_rig_linear"
has "under a watch that can climb" "$dir/fast.ini" "^promote = hertz_rig "
"$program" scene "$dir/fast.ini" >"$dir/out" 2>&1
is "and that is a sound scene, status" $? 0
printf '[plant]\nmodel = hertz_rig\n[drive force]\namplitude = 45 N\nfrequency = 150 Hz\nnoise = 5 N\nnoise_hold = 1 ms\n[ask]\nover = 0.5 s\ntolerance = 0.01\n' >"$dir/long.ini"
"$program" choose "$dir/long.ini" --out "$dir/step.ini" --json "$dir/step.json" >"$dir/out" 2>&1
has "a step may become too long" "$dir/step.json" '"when": "the eigenfrequency rises above [0-9.]* Hz, .*the step is too long", .*"guard": "watched"'
has "it is what voids the certificate first" "$dir/out" "^VOID IF *the eigenfrequency rises above [0-9.]* Hz, "
has "under a watch of it" "$dir/step.ini" "^observable = eigenfrequency "
is "that has nothing to climb to" "$(grep -c "^promote" "$dir/step.ini")" 0
/usr/bin/python3 - "$dir/step.json" <<'END'
import json, sys
watch = json.load(open(sys.argv[1]))["watch"]
assert watch["observable"] == "eigenfrequency" and watch["above"] > 231 and watch["below"] is None and "promote" not in watch
END
verdict "its JSON says so" $?
plant step $port "$dir/step.ini" --log "$dir/step.log" $patient
listen "$dir/step.seen" $port "$dir/step.ini" --only WATCH,STATUS
speak 1 $port send start --model "$dir/step.ini" --hold 0.5 >"$dir/out" 2>&1
is "with this mass it does not trip" "$(grep -c "WATCH=on" "$dir/step.seen")" 0
speak 1 $port send set mass_kg=1.625 --model "$dir/step.ini" --hold 0.5 >"$dir/out" 2>&1
until_true grep -q "STATUS.* WATCH=on" "$dir/step.seen"
ends "$pid"
ends $listener
twice=$(awk 'BEGIN { printf "%.2f", 2 * sqrt(1.5 * 3.4e9^(2 / 3) * 64^(1 / 3) / 6.5) / (8 * atan2(1, 1)) }')
has "a quarter of it trips: twice the eigenfrequency" "$dir/step.seen" "WATCH  *OBSERVABLE=eigenfrequency TICK=[0-9]* tick VALUE=$twice[0-9]* Hz$"
has "run says so" "$dir/step.out" "^watch: eigenfrequency was $twice[0-9]* Hz at tick [0-9]*, outside its limits; the model is hertz_rig$"
replays step "$dir/step.log" "$dir/step.ini" $patient
"$program" choose bbp-fig5-base-slow >"$dir/out" 2>"$dir/err"
has "a paper's range is warned of" "$dir/err" "^contactplant choose: warning: Bichri, Belhaq"
"$program" choose shaft --sweep force2=24,40,3 --tolerance 0.1 --json "$dir/swept.json" >"$dir/out" 2>"$dir/err"
is "frequencies of a sweep are warned of, once" "$(grep -c "warning: the shaft-bearing paper errs: .* 41.3 Hz" "$dir/err")" 1
has "in its JSON, too" "$dir/swept.json" '"warnings": ."the shaft-bearing paper errs: [^,]* 41.3 Hz, not 36 Hz".,'
"$program" choose kb-fig16 >"$dir/out" 2>"$dir/err"
has "a dimensionless scene is measured in the paper's units" "$dir/out" "An error of 1 is 0.6015 in the paper's"
runs 1 "a tolerance that nothing meets, status" choose kb-fig16 --tolerance 1e-15 --json "$dir/none.json"
has "the closest is shown" "$dir/out" "^CLOSEST"
has "and said to be no more than that" "$dir/out" "^REFUSED *Nothing meets the tolerance of 1e-15: the full model itself is known to "
/usr/bin/python3 -m json.tool "$dir/none.json" >/dev/null
verdict "its JSON is sound" $?
sed 's/^cost = [^#]*/cost = 1 ns /' "$dir/rig.ini" >"$dir/hurry.ini"
runs 1 "a deadline that nothing meets, status" choose "$dir/hurry.ini"
has "the fastest is shown" "$dir/out" "^REFUSED *Nothing meets the deadline on host: the fastest takes [0-9.]* µs per frame"
"$program" choose kb-fig16-cubic --on mps2-an386 >"$dir/out" 2>&1
has "an M4F's deadline is judged" "$dir/out" "^COST  *[0-9.]* µs per frame on mps2-an386, [0-9.]* % of the "
has "on a board with double in software the choice is another" "$dir/out" "^CHOSEN .* by rk4_float32"
"$program" choose bbp-fig2-force --tolerance 0.01 >"$dir/out" 2>&1
has "many contact switches under two drives, coarsely: without location" "$dir/out" "^CHOSEN *hertz_rig by rk4_unlocated"
runs 0 "a sweep there and back, status" choose rig --sweep force.frequency=100:240:10 --tolerance 0.01
runs 3 "a scene that escapes, status" choose kb-fig7
has "says when" "$dir/err" "the motion escapes in the full model after "
refuses 2 "no such model, preset or file" choose nowhere
refuses 2 "asks nothing" choose hertz_rig
refuses 2 "did you mean mps2-an500" choose rig --on mps2-an50
refuses 2 "no deadline can be judged" choose rig --on riscv-virt
refuses 2 "did you mean penetration" choose rig --observable penetratoin
refuses 2 "no input of hertz_rig that the scene drives; there is force;" choose rig --sweep base=1,2,3
refuses 2 "did you mean force.frequency?" choose rig --sweep force.freqency=1:2:3
refuses 2 "fewer than 4 steps" choose rig --sweep force.frequency=100:20kHz:3
refuses 2 "is the scene itself" choose "$dir/rig.ini" --out "$dir/rig.ini"
runs 2 "a file that cannot be written is no verdict, status" choose kb-fig16 --out "$dir/nowhere/x.ini"
has "it says which" "$dir/err" "cannot write --out $dir/nowhere/x.ini: .*; choose another"
"$program" scene tapping | sed 's/^over = 10 ms/over = 2 ms/' >"$dir/tapping.ini"
runs 0 "a lever, status" choose "$dir/tapping.ini" --out "$dir/lever.ini"
has "by its one method" "$dir/out" "^CHOSEN .* afm_lever by modal, "
has "it says that heat is off" "$dir/out" "without heat, as --heat was not given"
has "in the file as well" "$dir/lever.ini" "^temperature = 0 K"
"$program" choose nayak-fig3 --out "$dir/drift.ini" >"$dir/out" 2>&1
has "free and undamped, errors grow" "$dir/out" "^VOID IF *the time rises above [0-9.]*: errors that multiply "
has "until a time that is watched" "$dir/drift.ini" "^observable = time "
printf '[plant]\nmodel = shaft_bearing\ngap_stiffness1 = 20 kN/m\ngap_stiffness3 = 20 kN/m\n[drive force2]\namplitude = 3 N\nfrequency = 12 Hz\n[ask]\nobservable = displacement\nover = 1 s\ntolerance = 0.05\n[deadline]\nframe = 0.25 ms\nsubsteps = 4\n' >"$dir/soft.ini"
"$program" choose "$dir/soft.ini" --out "$dir/mode.ini" --json "$dir/mode.json" >"$dir/out" 2>&1
has "one mode does" "$dir/mode.ini" "^model = shaft_bearing_mode"
has "as far as it was compared" "$dir/out" "^VOID IF *position leaves +-[0-9.e-]* m: no run went farther"
has "what other forces do is farther" "$dir/mode.json" '"when": "an asymmetry, a force elsewhere .*"guard": "not watched"'
has "its watch climbs" "$dir/mode.ini" "^promote = shaft_bearing "
/usr/bin/python3 - "$dir/mode.json" <<'END'
import json, sys
watch = json.load(open(sys.argv[1]))["watch"]
assert watch["observable"] == "position" and watch["above"] == -watch["below"] and watch["promote"] == "shaft_bearing"
END
verdict "its JSON has the mode's own observable" $?
sed 's/amplitude = 3 N/amplitude = 0.1 N/' "$dir/soft.ini" >"$dir/softer.ini"
"$program" choose "$dir/softer.ini" --tolerance 5e-4 --out "$dir/any.ini" --json "$dir/any.json" >"$dir/out" 2>&1
has "where they are nearer any change is watched" "$dir/any.json" '"when": "an asymmetry, a force elsewhere .*; no signal shows this, so any change counts", .*"guard": "watched"'
has "none is allowed" "$dir/any.ini" "^above = 0 "
/usr/bin/python3 - "$dir/any.json" <<'END'
import json, sys
watch = json.load(open(sys.argv[1]))["watch"]
assert watch == {"observable": "changes", "below": None, "above": 0, "promote": "shaft_bearing"}
END
verdict "its JSON says so" $?
plant any $port "$dir/any.ini" --log "$dir/any.log" --promote $patient
listen "$dir/any.seen" $port "$dir/any.ini" --only WATCH,STATUS
speak 1 $port send start --model "$dir/any.ini" --hold 0.5 >"$dir/out" 2>&1
is "left alone it does not trip" "$(grep -c "WATCH=on" "$dir/any.seen")" 0
speak 1 $port send arm force1 amplitude=0.05 frequency=12 + fire --model "$dir/any.ini" --hold 0.5 >"$dir/out" 2>&1
until_true grep -q "STATUS.* WATCH=on" "$dir/any.seen"
ends "$pid"
ends $listener
has "a force elsewhere trips it" "$dir/any.seen" "WATCH  *OBSERVABLE=changes TICK=[0-9]* tick VALUE=1$"
has "and it climbs" "$dir/any.out" "^watch: changes was 1 at tick [0-9]*, outside its limits; the model is shaft_bearing$"
replays any "$dir/any.log" "$dir/any.ini" --promote $patient
printf '[plant]\nmodel = hertz_rig\n[drive force]\namplitude = 0.2 N\nfrequency = 100 Hz\n[drive stiffness]\namplitude = 0.001\nfrequency = 900 Hz\n[ask]\nobservable = displacement\nover = 0.6 s\ntolerance = 0.03\n' >"$dir/fast2.ini"
"$program" choose "$dir/fast2.ini" --out "$dir/slow.ini" >"$dir/out" 2>&1
has "an average does" "$dir/slow.ini" "^model = hertz_rig_averaged"
has "while the fast drive is fast" "$dir/out" "^VOID IF *the eigenfrequency rises above 300 Hz: the fast drive is not fast beside it"
sed 's/frequency = 100 Hz/frequency = 270 Hz/' "$dir/fast2.ini" >"$dir/fast3.ini"
"$program" choose "$dir/fast3.ini" --out "$dir/drive.ini" >"$dir/out" 2>&1
has "and a slow drive slow" "$dir/out" "^VOID IF *a slow drive goes above 300 Hz: the fast drive is not fast beside it"
has "by its own observable" "$dir/drive.ini" "^observable = drive_frequency "
refuses 2 "an averaged model cannot climb" run "$dir/slow.ini" --promote
refuses 2 "there is nothing to climb to" run "$dir/drift.ini" --promote

echo "--- list and dbc"
"$program" list >"$dir/out"
is "list, status" $? 0
has "list shows a parameter with its unit" "$dir/out" "preload_N  *N  "
has "list shows a setting" "$dir/out" "timeout_frames  *frames  *1  *10000  *100 "
has "list shows a message" "$dir/out" "0x14 MOTION"
is "dbc: messages of one plant" "$("$program" dbc --base-id=0x240 | grep -c '^BO_ \(5[7-9][0-9]\|6[0-3][0-9]\) ')" \
    "$("$program" list messages | grep -c '^  0x')"

echo "--- self-test"
"$program" selftest >"$dir/out"
is "selftest, status" $? 0
is "selftest: checks that are ok" "$(grep -c '^ok ' "$dir/out")" 15
has "selftest: last line" "$dir/out" "^15 checks, 0 failed$"

echo "--- two processes, open loop, Ctrl-C"
kept="--setting timeout_frames=5000 --setting age_limit_frames=10000"
plant open $port --log "$dir/open.log" $kept
open=$pid
listen "$dir/contact.csv" $port --only CONTACT --csv
speak 1 $port send start + arm force amplitude=6.4 frequency=10 ramp=0.1 + fire --in 1000 --hold 3.5 >"$dir/out" 2>&1
is "start, arm, fire: status" $? 0
is "start, arm, fire: answers" "$(tr '\n' ' ' <"$dir/out")" "CONTROL: ok FIRE: ok "
ends $listener
# far below the resonance the contact follows the force: 64 N + 6.4 N, 0.2 % of amplification at 10 of 230 Hz
near "largest contact force, N" "$(awk -F, '$5 == "FORCE" && $6 > m { m = $6 } END { print m }' "$dir/contact.csv")" 70.4 0.3
is "monitor --count" "$(speak 2 $port monitor --only STATUS --count 3 | grep -c STATE=)" 3
speak 1 $port send set preload_N=80 + read preload_N >"$dir/out" 2>&1
is "set and read" "$(tr '\n' ' ' <"$dir/out")" "PARAM_COMMIT: ok preload_N = 80 N "
"$program" send start --hold 600 --bus udp:$((port + 3)) --peer 127.0.0.1:$port >"$dir/holder" 2>&1 &
holder=$!
children="$children $holder"
until_true grep -q "CONTROL: ok" "$dir/holder"
sleep 6 # longer than the time-out
speak 1 $port send pause + start >"$dir/out" 2>&1
is "a second sender takes part in the session" "$(tr '\n' ' ' <"$dir/out")" "CONTROL: ok CONTROL: ok "
for amplitude in 1 2; do
    speak 1 $port send arm force amplitude=$amplitude + fire --in 500 >"$dir/out" 2>&1
    is "sender $((amplitude + 1)) arms and fires in it" "$(tr '\n' ' ' <"$dir/out")" "FIRE: ok "
done
for i in 1 2; do
    speak 1 $port send capture arm + capture trigger >"$dir/out" 2>&1
    is "and takes burst $i" "$(tr '\n' ' ' <"$dir/out")" "CAPTURE: ok CAPTURE: ok "
done
speak 1 $port send capture read >"$dir/burst.csv" 2>"$dir/err"
is "a burst read, status" $? 0
is "a head and 1000 samples of five outputs" "$(awk -F, 'NF == 6' "$dir/burst.csv" | wc -l)" 1001
speak 1 $port send capture read 998 2 >"$dir/out" 2>"$dir/err"
is "its last two" "$(tail -n 2 "$dir/out" | tr "\n" " ")" "$(tail -n 2 "$dir/burst.csv" | tr "\n" " ")"
speak 1 $port send set capture_samples=200 + capture arm + capture trigger + capture read + pause + start >"$dir/out" 2>"$dir/err"
is "a burst read while it fills: its samples and all answers" "$(grep -c '^[0-9]' "$dir/out") $(grep -c 'ok$' "$dir/out")" "200 5"
near "what the last one armed" "$(speak 2 $port monitor --only DRIVE_ECHO --csv --count 120 |
    awk -F, '$4 == "amplitude" && $5 == "CHANNEL" { input = $6 }
        $4 == "amplitude" && $5 == "VALUE" && input == "force" { m = $6 } END { print m }')" 2 0
kill -TERM $holder
wait $holder
is "and the first one has kept it" $? 0
speak 1 $port send step 1 >"$dir/out" 2>&1
is "a command that is refused, status" $? 1
has "a command that is refused, said" "$dir/out" "refused, state"
speak 1 $port send pause + stop + reset + start >"$dir/out" 2>&1
is "a stop ends the session, the chain goes on in the next one: status" $? 0
is "its answers" "$(tr '\n' ' ' <"$dir/out")" "CONTROL: ok CONTROL: ok CONTROL: ok CONTROL: ok "
speak 1 $port send stop >"$dir/out" 2>&1
is "a stop by itself: status" $? 0
kill -INT $open
wait $open
plant late $port --faults out.delay=1:400 $patient # longer than a try of send
speak 1 $port send start + reset >"$dir/out" 2>&1
is "answers to tries before are not taken for those to the next command, status" $? 1
is "start is taken, reset is not" "$(tr '\n' ' ' <"$dir/out")" "CONTROL: ok CONTROL: refused, state: not possible in this state "
ends "$pid"
is "Ctrl-C: status" $? 0
has "Ctrl-C: the report comes" "$dir/open.out" "hash"
is "Ctrl-C: the log ends with a whole line" "$(tail -c 1 "$dir/open.log" | od -An -c | tr -d ' ')" '\n'
has "self-test on the bus: the drive's check passed" "$dir/open.log" " 222#..000001"
replays open "$dir/open.log" $kept
refuses 1 "recorded.*replay sent.*plant tick.*had a SCENE, give it" replay "$dir/open.log" $kept --set damping_N_s_per_m=189

echo "--- run with the method left to choose"
plant auto $port --method auto --tol 1e-3 --substeps 32 $patient
speak 1 $port send start --substeps 32 --hold 1 + set mass_kg=2 >"$dir/out" 2>&1
ends "$pid"
has "the banner names the method" "$dir/auto.err" "hertz_rig by rk4 on"
has "the report names what parameters made of it" "$dir/auto.out" "method taylor, chosen by auto"

echo "--- a plant that is another one than the client assumes"
plant tip $port tip $patient
tip=$pid
dilation=$("$program" scene tip | sed -n 's/^dilation = \([0-9]*\).*/\1/p')
for client in "1 control --duration 1" "1 send start" "2 monitor --only LEDGER,MOTION --count 20"; do
    speak ${client%% *} $port ${client#* } >"$dir/out" 2>"$dir/err"
    is "$client: status" $? 1
    is "no scaled number is printed" "$(grep -c 'penetration\|DISPLACEMENT\|VALUE\|CONTROL' "$dir/out")" 0
    has "the model is named" "$dir/err" "model afm_tip, not hertz_rig;"
    has "and the dilation" "$dir/err" " dilation $dilation, not 1;"
    has "and the LSBs" "$dir/err" " lsb_displacement [0-9.]*e-1[0-9] m, not 5e-11;"
done
ends $tip
is "commands that reached it" "$(grep -c ^frames_received "$dir/tip.out")" 0
plant tip $port tip $patient
tip=$pid
speak 2 $port monitor --rate 500 tip --duration 20 --only MOTION >"$dir/out" 2>"$dir/err"
is "another rate, status" $? 1
has "is named alone" "$dir/err" "assumes: frame_rate_Hz 1000 Hz, not 500; give"
speak 2 $port monitor tip --setting lockin_output_0=1 --duration 20 >"$dir/out" 2>"$dir/err"
has "settings that give LOCKIN its meaning too" "$dir/err" "assumes: other --setting stream_linear_.*; give"
speak 2 $port monitor tip --setting timeout_frames=7 --only LEDGER --count 1 >"$dir/out" 2>"$dir/err"
is "not settings that change no meaning, status" $? 0
speak 1 $port control tip --duration 1 >"$dir/out" 2>&1
is "with the plant's scene, status" $? 0
ends $tip
# the scene says 260 fm; the drive, 1/20 of the preload below resonance, moves it by a few per cent
near "its penetration, m" "$(sed 's/.*penetration \([^ ]*\) m.*/\1/' "$dir/out")" 2.6e-13 2e-14

echo "--- the controller falls silent"
plant silent $port --setting timeout_frames=3000 --setting age_limit_frames=10000
speak 1 $port send start + arm force amplitude=3 frequency=50 + fire --in 1000 >"$dir/out" 2>&1
listen "$dir/seen" $port --only STATUS
until_true grep -q "REACTION=ramp" "$dir/seen"
ends $listener
ends "$pid"
has "time-out counted" "$dir/silent.out" "^timeouts  *1 times"

echo "--- the plant itself stands still for 2.5 s"
plant still $port --log "$dir/still.log" --setting timeout_frames=1000
still=$pid
speak 1 $port control --duration 100 >"$dir/out" 2>&1 &
controller=$!
children="$children $controller"
listen "$dir/seen" $port --only STATUS
until_true grep -q "STATE=running" "$dir/seen"
ends $listener
sleep 0.5 # by now the controller streams a force in answer to each frame: the last answer waits
kill -STOP $still
sleep 2.5
kill -CONT $still
wait $controller
is "the controller hears of it: status" $? 1
has "and says what" "$dir/out" "the plant ended the session: it heard no heartbeat"
kill -INT $still
wait $still
is "time-outs, by number" "$(sed -n 's/^timeouts  *\([0-9]*\) .*/\1/p' "$dir/still.out")" 1
[ "$(sed -n 's/^frames_missed  *\([0-9]*\) .*/\1/p' "$dir/still.out")" -ge 2400 ]
verdict "frames missed, 2400 or more" $? "$(grep ^frames_missed "$dir/still.out")"
has "what waited meanwhile is refused" "$dir/still.out" "^session  *[1-9]"
"$program" replay "$dir/still.log" --setting timeout_frames=1000 >"$dir/out" 2>&1
is "its log replays, status" $? 0

echo "--- somebody else stops"
plant stopped $port $patient
speak 1 $port control --duration 100 >"$dir/out" 2>&1 &
controller=$!
children="$children $controller"
listen "$dir/seen" $port --only STATUS
until_true grep -q "STATE=running" "$dir/seen"
ends $listener
speak 2 $port send stop >"$dir/stop" 2>&1
is "the stop is taken: status" $? 0
wait $controller
is "the controller hears of it: status" $? 1
has "and says what" "$dir/out" "the plant ended the session: somebody stopped it"
ends "$pid"

echo "--- the machine sleeps for 5 s"
cc -shared -fPIC -o "$dir/clock_shim.so" "${0%/*}/clock_shim.c" || verdict "the shim is built" 1
echo 0 >"$dir/asleep"
export CLOCK_SHIM="$dir/asleep"
export LD_PRELOAD="$dir/clock_shim.so"
plant asleep $port --log "$dir/asleep.log" --setting timeout_frames=2000 --setting age_limit_frames=10000
unset LD_PRELOAD
asleep=$pid
speak 1 $port send start >"$dir/out" 2>&1
is "start: status" $? 0
kill -STOP $asleep
speak 1 $port send enable >"$dir/out" 2>&1 & # an ENABLE of the session waits in the queue
sleep 0.2
echo 5 >"$dir/asleep"
kill -CONT $asleep
sleep 0.5
ends $asleep
[ "$(sed -n 's/^frames_missed  *\([0-9]*\) .*/\1/p' "$dir/asleep.out")" -ge 5000 ]
verdict "frames missed, 5000 or more" $? "$(grep ^frames_missed "$dir/asleep.out")"
is "time-outs, by number" "$(sed -n 's/^timeouts  *\([0-9]*\) .*/\1/p' "$dir/asleep.out")" 1
"$program" replay "$dir/asleep.log" --setting timeout_frames=2000 --setting age_limit_frames=10000 >"$dir/out" 2>&1
is "its log replays, status" $? 0
CLOCK_SHIM_OLD=1 LD_PRELOAD="$dir/clock_shim.so" "$program" run --duration 0.5 --bus udp:$port --peer 127.0.0.1:$((port + 1)) >"$dir/out" 2>&1
is "a kernel without that clock: status" $? 0
near "and half a second is half a second, frames and missed ones" "$(sed -n 's/^frames \([0-9]*\) .*missed \([0-9]*\),.*/\1 + \2/p' "$dir/out" | xargs expr)" 500 50

echo "--- closed loop in lockstep, alone and beside a CPU burner"
for load in idle burner; do
    burners=
    [ $load = idle ] || for i in 1 2; do
        (while :; do :; done) &
        burners="$burners $!"
        children="$children $!"
    done
    plant lock_$load $port $patient
    speak 1 $port control --lockstep --duration 1.5 >"$dir/lock_$load.txt" 2>&1
    is "lockstep, $load: status" $? 0
    kill -TERM "$pid"
    wait "$pid"
    for burner in $burners; do
        kill "$burner"
        wait "$burner" 2>/dev/null
    done
    grep -o "tick [0-9]*, hash [0-9a-f]*" "$dir/lock_$load.out" >"$dir/lock_$load.hash"
    has "lockstep, $load: 1.5 s of plant time" "$dir/lock_$load.hash" "tick 96000,"
done
is "same hash" "$(cat "$dir/lock_burner.hash")" "$(cat "$dir/lock_idle.hash")"
is "same force and penetration" "$(cut -d, -f1,2 "$dir/lock_burner.txt")" "$(cut -d, -f1,2 "$dir/lock_idle.txt")"

echo "--- step guard, escape, sides"
refuses 2 "step 0.125 would do" simulate hertz_rig --set a_stiff=1 --step 1 --at 5
"$program" simulate hertz_rig --set a_stiff=1 --step 0.25 --at 5 --force >"$dir/out" 2>&1
is "--force overrides" $? 0
has "and marks the output" "$dir/out" "^# forced against"
"$program" simulate afm_tip --set beta=0.8 --set sign=1 --set r=0.5 --set Omega=1 --set f=0.008 --set omega=0.44 \
    --until 200 --every 5 >"$dir/out" 2>"$dir/err"
is "an escape has a status of its own" $? 3
has "and its time" "$dir/err" "escapes at t = "
is "no NaN" "$(grep -ciE 'nan|inf' "$dir/out")" 0
"$program" simulate shaft_bearing --set p2=25 --set freq_hz=25 --until 0.2 --every 0.1 --events "$dir/sides.csv" >"$dir/out"
has "both sides of a bearing are hit" "$dir/sides.csv" "touchdown,.*,-1,"

echo "--- float32"
"$program" list methods >"$dir/methods"
has "list names it" "$dir/methods" "^ *rk4_float32 "
has "and the one without location" "$dir/methods" "^ *rk4_unlocated "
refuses 2 "this model has no contact" simulate hertz_rig_linear --method rk4_unlocated --at 1
refuses 2 "tolerance below 1e-5" simulate --method rk4_float32 --tol 1e-8 --at 1
set -- --set xi=0 --state 2,0.5 --at 20
near "free flights and landings, against taylor" "$("$program" simulate "$@" --method rk4_float32 | tail -n 1 | cut -d, -f2)" \
    "$("$program" simulate "$@" --method taylor | tail -n 1 | cut -d, -f2)" 1e-5
plant single $port --method rk4_float32 --log "$dir/single.log" $patient
single=$pid
listen "$dir/contact.csv" $port --only CONTACT --csv
speak 1 $port send start + arm force amplitude=6.4 frequency=10 ramp=0.1 + fire --in 1000 --hold 3 >"$dir/out" 2>&1
is "start, arm, fire: answers" "$(tr '\n' ' ' <"$dir/out")" "CONTROL: ok FIRE: ok "
ends $listener
near "largest contact force, N" "$(awk -F, '$5 == "FORCE" && $6 > m { m = $6 } END { print m }' "$dir/contact.csv")" 70.4 0.3
kill -INT $single
wait $single
"$program" replay "$dir/single.log" --method rk4_float32 $patient >"$dir/out" 2>&1
is "its log replays, status" $? 0

echo "--- two plants on one bus"
plant a $port $patient
a=$pid
plant b $((port + 4)) --base-id 0x240 --peer 127.0.0.1:$((port + 1)) $patient
b=$pid
timeout --foreground 300 "$program" send --bus udp:$((port + 1)) --peer 127.0.0.1:$port --peer 127.0.0.1:$((port + 4)) \
    --base-id 0x240 start --hold 0.5 >"$dir/out" 2>&1
has "the second one starts" "$dir/out" "CONTROL: ok"
ends $a
ends $b
has "the first one heard nothing for it" "$dir/a.out" "tick 0,.*state off"
has "the second one ran" "$dir/b.out" "tick [1-9]"
is "commands that reached the first" "$(grep -c ^frames_received "$dir/a.out")" 0

echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
