#!/bin/sh
# sizes.sh BOARD SIZE IMAGE [MORE] - prints an image's sizes and compares them with tests/data/board_limits.txt; MORE: bytes of ROM
# beyond that, of an image with the presets.
board=$1
more=${4:-0}
limits=$(grep "^$board " tests/data/board_limits.txt) || {
    echo "FAIL  $board has no line in tests/data/board_limits.txt"
    exit 1
}
set -- $(echo "$limits" | cut -d" " -f1-3) $("$2" "$3" | tail -n 1)
# board rom ram | text data bss
echo "      $board: text $4, data $5, bss $6 bytes"
status=0
limit() { # what, value, limit
    if [ "$2" -le "$3" ]; then
        echo "ok    $board $1: $2 bytes, at most $3"
    else
        echo "FAIL  $board $1: $2 bytes, above $3"
        status=1
    fi
}
limit "ROM (text and data)" $(($4 + $5)) $(($2 + more))
limit "RAM (data, bss and stack)" $(($5 + $6)) "$3"
exit $status
