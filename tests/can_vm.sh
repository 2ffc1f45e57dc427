#!/bin/sh
# can_vm.sh [-n BUSES] -- COMMAND ARGUMENT...
#
# Runs a command where SocketCAN exists, with vcan0 .. vcan(BUSES-1) up (default 1): on this machine's own kernel when
# it knows AF_CAN and lets us make interfaces, else in user-mode-linux, a real kernel that boots in about two seconds
# and sees this machine's files. Working directory, output and exit status are the command's; 125 means that there was
# no way to run it, and the reason is printed. CAN_VM=uml skips the machine's own kernel; CAN_VM_TIMEOUT (seconds,
# default 60) bounds the virtual machine. Sanitizers: undefined works inside, address and thread do not.
# Needs for the virtual machine, on Debian 12: apt-get install user-mode-linux iproute2 gcc
set -u

die() {
    echo "can_vm: $*" >&2
    exit 125
}

buses=1
while [ $# -gt 0 ]; do
    case $1 in
    -n)
        [ $# -ge 2 ] || die "-n needs a number of buses"
        buses=$2
        shift 2
        ;;
    --)
        shift
        break
        ;;
    *) break ;;
    esac
done
[ $# -gt 0 ] || die "usage: can_vm.sh [-n BUSES] -- COMMAND ARGUMENT..."
case $buses in '' | *[!0-9]*) die "-n $buses: not a number" ;; esac

# Makes what is missing of vcan0.. ; MTU 72 lets CAN FD frames through for the tests that send them.
make_buses="i=0
while [ \$i -lt $buses ]; do
    [ -d /sys/class/net/vcan\$i ] || ip link add dev vcan\$i mtu 72 type vcan || exit 1
    ip link set vcan\$i up || exit 1
    i=\$((i + 1))
done"

if [ "${CAN_VM:-}" != uml ] && [ -e /proc/net/can ] && sh -c "$make_buses" 2>/dev/null; then
    exec "$@"
fi

command -v linux.uml >/dev/null || die "this kernel has no SocketCAN and user-mode-linux is not installed:" \
    "apt-get install user-mode-linux"
command -v ip >/dev/null || die "the ip command is missing: apt-get install iproute2"

here=$(cd "$(dirname "$0")" && pwd)
room=$(mktemp -d "${TMPDIR:-/tmp}/can_vm.XXXXXX") || die "cannot make a temporary directory"
trap 'rm -rf "$room"' EXIT
trap 'exit 130' INT TERM
compile() {
    "${CC:-gcc}" -std=gnu99 -O2 -D_GNU_SOURCE "$@" || die "cannot compile the helpers of the virtual machine"
}
compile -shared -fPIC -o "$room/uml_shim.so" "$here/uml_shim.c"
compile -o "$room/uml_init" "$here/uml_init.c"

quoted() {
    for word; do
        printf " '%s'" "$(printf %s "$word" | sed "s/'/'\\\\''/g")"
    done
}
cat >"$room/job" <<EOF
exec </dev/null >'$room/out' 2>&1
ip link set lo up
( $make_buses )
cd $(quoted "$PWD")
$(quoted "$@")
echo \$? >'$room/status'
EOF

LD_BIND_NOW=1 LD_PRELOAD="$room/uml_shim.so" timeout --foreground -k 2 "${CAN_VM_TIMEOUT:-60}" linux.uml mem=128M \
    umid="can_vm$$" uml_dir="$room/" root=/dev/root rootfstype=hostfs rootflags=/ rw init="$room/uml_init" \
    CAN_VM_JOB="$room/job" con=null con0=null,fd:1 quiet </dev/null >"$room/boot" 2>&1

[ -f "$room/out" ] && cat "$room/out"
[ -s "$room/status" ] && exit "$(cat "$room/status")"
echo "can_vm: the virtual machine did not finish; its console follows" >&2
cat "$room/boot" >&2
exit 125
