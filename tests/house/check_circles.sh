#!/bin/sh
# check_circles.sh NM OBJECT... - no two source files need each other, directly or through others. The arrows are the
# symbols that an object needs and another one defines (nm); tsort names the objects of a circle.
nm=$1
shift
arrows=$(mktemp) || exit 1
trap 'rm -f "$arrows"' EXIT
$nm -A -g "$@" | awk '
    { split($1, part, ":"); object = part[1]; symbol = $NF; kind = $(NF - 1) }
    kind == "U" { n++; user[n] = object; used[n] = symbol; next }
    { home[symbol] = object }
    END { for (i = 1; i <= n; i++) if (used[i] in home && home[used[i]] != user[i]) print user[i], home[used[i]] }' |
    sort -u >"$arrows"
if circles=$(tsort "$arrows" 2>&1 >/dev/null); then
    echo "ok    no circle among $# objects"
    exit 0
fi
printf '%s\n' "$circles" | sed -n 's/^tsort: //p' | awk '
    /input contains a loop/ { if (circle != "") print circle; circle = "FAIL  these files need each other:"; next }
    { circle = circle " " $0 }
    END { print circle }'
exit 1
