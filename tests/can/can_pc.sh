#!/bin/sh
# can_pc.sh -- COMMAND ARGUMENT...
#
# Runs a command on an emulated PC with two CAN controllers: Debian's kernel in qemu-system-x86_64, two SJA1000 of Kvaser
# PCI cards on one bus under the kernel's own drivers, kvaser_pci and sja1000. can0 and can1 are down and without a bitrate,
# vcan0 is up. Two processors, 1 GB; the command sees this machine's files (9P) and may be built with sanitizers; TMPDIR is
# memory. Working directory, output and exit status are the command's; 125 means that there was no way to run it, and the
# reason is printed. CAN_VM_TIMEOUT (seconds, default 110) bounds the virtual machine. It boots in 5 to 10 seconds.
#
# The kernel is unpacked into build/linux, not installed: 70 MB are downloaded by apt-get once.
# Needs, on Debian 12: apt-get install qemu-system-x86 cpio iproute2 gcc
set -u
me=can_pc
here=$(cd "$(dirname "$0")" && pwd)
. "$here/can_vm_parts.sh"

[ "${1:-}" = -- ] && shift
[ $# -gt 0 ] || die "usage: can_pc.sh -- COMMAND ARGUMENT..."
for need in qemu-system-x86_64:qemu-system-x86 cpio:cpio ip:iproute2 dpkg-deb:dpkg; do
    command -v "${need%:*}" >/dev/null || die "${need%:*} is missing: apt-get install ${need#*:}"
done

# In the order of loading: 9P over virtio for this machine's files, then CAN.
modules="drivers/virtio/virtio_ring drivers/virtio/virtio drivers/virtio/virtio_pci_legacy_dev
    drivers/virtio/virtio_pci_modern_dev drivers/virtio/virtio_pci fs/netfs/netfs fs/fscache/fscache net/9p/9pnet
    net/9p/9pnet_virtio fs/9p/9p net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan
    drivers/net/can/sja1000/sja1000 drivers/net/can/sja1000/kvaser_pci net/sched/sch_plug"
kernel=${here%/tests/can}/build/linux

download() { # into the current directory: the package that linux-image-amd64 stands for
    package=$(apt-cache depends linux-image-amd64 2>/dev/null | sed -n 's/^ *Depends: //p' | head -n 1)
    [ -n "$package" ] && apt-get download -qq "$package" 2>"$room/apt"
}

# build/linux: the kernel's image and the modules above, flat. It appears whole or not at all.
fetch_kernel() {
    mkdir "$room/tree" && cd "$room" || exit 125
    download || { apt-get update -qq >"$room/apt" 2>&1 && download; } ||
        die "Debian's kernel (linux-image-amd64) cannot be downloaded: $(tail -n 1 "$room/apt")"
    # shellcheck disable=SC2046
    dpkg-deb --fsys-tarfile ./*.deb | tar -x -C tree --wildcards './boot/vmlinuz*' $(printf './lib/modules/*/kernel/%s.ko ' $modules) ||
        die "$package has not what is needed: see above"
    mkdir -p "${kernel%/*}" && rm -rf "$kernel" "$kernel.new" && mkdir "$kernel.new" &&
        find tree -type f -exec mv {} "$kernel.new" ';' && mv "$kernel.new"/vmlinuz* "$kernel.new/vmlinuz" &&
        mv "$kernel.new" "$kernel" || die "build/linux cannot be written"
}

make_room
[ -e "$kernel/vmlinuz" ] || (fetch_kernel) || exit 125

# The first root: tests/can/vm_init.c, the modules and where this machine's files will be.
mkdir -p "$room/root/host" "$room/root/proc"
compile -static -o "$room/root/init" "$here/vm_init.c"
for name in $modules; do
    cp "$kernel/${name##*/}.ko" "$room/root/" || die "build/linux is not whole: rm -r build/linux"
    echo "/${name##*/}.ko"
done >"$room/root/modules"
(cd "$room/root" && find . | cpio -o -H newc --quiet) >"$room/initrd" || die "cpio cannot write the first root"

write_job "ip link add dev vcan0 mtu 72 type vcan && ip link set vcan0 up" env TMPDIR=/run "$@"
timeout --foreground -k 2 "${CAN_VM_TIMEOUT:-110}" qemu-system-x86_64 -M pc -smp 2 -m 1024 -nodefaults -no-reboot \
    -display none -serial stdio -kernel "$kernel/vmlinuz" -initrd "$room/initrd" \
    -append "console=ttyS0 quiet panic=-1 mitigations=off CAN_VM_JOB=$room/job CAN_VM_MODULES=/modules CAN_VM_HOST=/host" \
    -virtfs local,path=/,mount_tag=host,security_model=none,multidevs=remap \
    -object can-bus,id=bus -device kvaser_pci,canbus=bus -device kvaser_pci,canbus=bus </dev/null >"$room/boot" 2>&1
finish
