# can_checks.sh - checks of programs that run side by side on a bus; to be sourced. $dir is a directory for the script's files,
# gone when it ends; $passed and $failed count.
for tool in candump cansend canplayer; do
    command -v $tool >/dev/null || { echo "FAIL  $tool is missing: apt-get install can-utils"; exit 1; }
done
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

verdict() { # NAME STATUS [WHY]: 0 is good
    if [ "$2" -eq 0 ]; then
        passed=$((passed + 1))
        echo "ok    $1"
    else
        failed=$((failed + 1))
        echo "FAIL  $1${3:+: $3}"
    fi
}
is() { # NAME GOT WANTED [FILE that tells more]
    [ "$2" = "$3" ]
    verdict "$1: $2" $? "wanted $3${4:+; $(tail -n 3 "$4")}"
}
above() { # NAME GOT LEAST
    [ "$2" -ge "$3" ] 2>/dev/null
    verdict "$1: $2, at least $3" $?
}
keep() { # the process just started is ended with this script
    children="$children $!"
}
until_true() { # SECONDS COMMAND..
    left=$(($1 * 5))
    shift
    while ! "$@" >/dev/null 2>&1; do
        left=$((left - 1))
        [ $left -gt 0 ] || return 1
        sleep 0.2 # a command a look: on the emulated machine that takes a tenth of a second
    done
}
bring_up_to_date() { # LOG INTERFACE: until candump has written what is on its way, told by a frame of nobody's
    cansend "$2" 7FF#00
    until_true 60 grep -q ' 7FF#00' "$1"
    verdict "candump has heard everything" $?
}
# LOG BASE, from before the session: how many of its commands the plant must refuse though their sender need not know better: those whose
# COUNTER is that of the one before, as when a second sender takes part, and those behind the session's end.
repeats_in() {
    awk -v base="$2" '{
        split($3, f, "#")
        if (f[1] !~ "^" base "[0-9A-F]$") next
        counter = substr(f[2], 4, 1)
        enable = f[1] == base "1"
        on = substr(f[2], 6, 1) == "1"
        if (f[1] == base "2" && substr(f[2], 6, 1) == "2") { open = 0; next } # a STOP is taken from anybody
        if (!open && enable && on) { open = 1; split("", last) }
        else if (!open) behind++
        else if (f[1] in last && last[f[1]] == counter) repeated++
        else { last[f[1]] = counter; if (enable && !on) open = 0 }
    } END { print repeated + 0, behind + 0 }' "$1"
}
hash_of() { sed -n 's/.*hash \([0-9a-f]*\).*/\1/p' "$1"; }
counter() { sed -n "s/^$2  *\([0-9]*\) .*/\1/p" "$1" | grep . || echo 0; }
