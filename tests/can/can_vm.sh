#!/bin/sh
# can_vm.sh [-n BUSES] -- COMMAND ARGUMENT...
#
# Runs a command where SocketCAN exists, with vcan0 .. vcan(BUSES-1) up (default 1): on this machine's own kernel when
# it knows AF_CAN and lets us make interfaces, else in user-mode-linux, a real kernel that boots in about two seconds
# and sees this machine's files. Working directory, output and exit status are the command's; 125 means that there was
# no way to run it, and the reason is printed. CAN_VM=uml skips the machine's own kernel; CAN_VM_TIMEOUT (seconds,
# default 300) bounds the virtual machine. Sanitizers: undefined works inside, address and thread do not.
# Needs for the virtual machine, on Debian 12: apt-get install user-mode-linux iproute2 gcc
set -u
me=can_vm
here=$(cd "$(dirname "$0")" && pwd)
. "$here/can_vm_parts.sh"

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

modules=/usr/lib/uml/modules/$(linux.uml --version)/kernel
make_room
compile -shared -fPIC -o "$room/uml_shim.so" "$here/uml_shim.c"
compile -o "$room/vm_init" "$here/vm_init.c"
for name in net/can/can net/can/can-raw net/can/can-bcm drivers/net/can/dev/can-dev drivers/net/can/vcan net/sched/sch_plug; do
    echo "$modules/$name.ko"
done >"$room/modules"
write_job "$make_buses" env CAN_VM=inside "$@"

LD_BIND_NOW=1 LD_PRELOAD="$room/uml_shim.so" timeout --foreground -k 2 "${CAN_VM_TIMEOUT:-300}" linux.uml mem=128M \
    umid="can_vm$$" uml_dir="$room/" root=/dev/root rootfstype=hostfs rootflags=/ rw init="$room/vm_init" \
    CAN_VM_JOB="$room/job" CAN_VM_MODULES="$room/modules" con=null con0=null,fd:1 quiet </dev/null >"$room/boot" 2>&1
finish
