# verdict.sh - lines of checks for shell tests, to be sourced: `ok` and `FAIL`, and how many of each.
passed=0
failed=0

verdict() { # STATUS TEXT [WHY]
    if [ "$1" = 0 ]; then
        passed=$((passed + 1))
        echo "ok    $2"
    else
        failed=$((failed + 1))
        echo "FAIL  $2${3:+: $3}"
    fi
}
equal() { # TEXT GOT WANTED
    [ "$2" = "$3" ]
    verdict $? "$1: $2" "wanted $3"
}
