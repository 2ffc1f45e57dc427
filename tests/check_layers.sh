#!/bin/sh
# An include never runs upwards: models <- firmware <- hal <- host_sim, firmware/main.c, tests. Prints each breach; 0 when there is none.
bad=0
forbid() { # room, pattern of includes that it must not have
    if ls "$1"/*.[ch] | grep -v '^firmware/main\.c$' | xargs grep -nE "#include [<\"]($2)"; then
        echo "FAIL  $1/ includes what stands above it or outside the core"
        bad=1
    else
        echo "ok    $1/ includes nothing of: $2"
    fi
}
os='stdio|stdlib|unistd|time\.h|sys/|pthread|errno|signal|assert|linux/|net'
forbid models "firmware/|hal/|host_sim/|tests/|$os"
forbid firmware "hal/[a-gi-z]|host_sim/|tests/|$os"
forbid hal "host_sim/|tests/"
forbid host_sim "tests/"
exit $bad
