# can_vm_parts.sh - what the virtual machines of can_vm.sh and can_pc.sh share; to be sourced. The script's name in its messages is $me.

die() {
    echo "$me: $*" >&2
    exit 125
}

# A room for one run's files, gone when the script ends.
make_room() {
    room=$(mktemp -d "${TMPDIR:-/tmp}/$me.XXXXXX") || die "cannot make a temporary directory"
    trap 'rm -rf "$room"' EXIT
    trap 'exit 130' INT TERM
}

compile() {
    "${CC:-gcc}" -std=gnu99 -O2 -D_GNU_SOURCE "$@" || die "cannot compile the helpers of the virtual machine"
}

quoted() {
    for word; do
        printf " '%s'" "$(printf %s "$word" | sed "s/'/'\\\\''/g")"
    done
}

# What tests/can/vm_init.c runs: SETUP, then COMMAND ARGUMENT.. in the caller's directory; output and status stay in the room.
write_job() { # SETUP COMMAND ARGUMENT..
    setup=$1
    shift
    cat >"$room/job" <<EOF
exec </dev/null >'$room/out' 2>&1
ip link set lo up
( $setup )
cd $(quoted "$PWD")
$(quoted "$@")
echo \$? >'$room/status'
EOF
}

# Ends the script as the job ended: its output, its status.
finish() {
    [ -f "$room/out" ] && cat "$room/out"
    [ -s "$room/status" ] && exit "$(cat "$room/status")"
    echo "$me: the virtual machine did not finish; its console follows" >&2
    cat "$room/boot" >&2
    exit 125
}
