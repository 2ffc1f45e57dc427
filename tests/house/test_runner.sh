#!/bin/sh
# test_runner.sh PROGRAM - what the runner and the checks print of tests that fail: PROGRAM is build/runner_cases. Ends with
# `N passed, N failed`.
set -u
program=$1
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
. tests/house/verdict.sh

has() { # text that must be in the output, as it stands
    grep -qF -e "$1" "$out/text"
    verdict $? "prints: $1"
}

lacks() { # text that must not be in the output
    ! grep -qF -e "$1" "$out/text"
    verdict $? "does not print: $1"
}

run() { # wanted exit status, options
    wanted=$1
    shift
    "$program" "$@" >"$out/text" 2>&1
    got=$?
    [ "$got" = "$wanted" ]
    verdict $? "runner $*: exit status $got, expected $wanted"
}

place() { # name of a check, the line that its text stands in: file:line of the source
    grep -nF -e "$1" tests/house/runner_cases.c | head -n 1 | cut -d: -f1
}

run 1 --jobs 2
has "ok    seven: 7, expected 7"
has "ok    a double: 0.1 < 0.2"
has "noise on stderr"
has "FAIL  a condition"
has "      tests/house/runner_cases.c:$(place '"a condition"'): check_true(\"a condition\", p.pair[0] == p.pair[1])"
has "FAIL  force, N: 1.5, expected 1, off by 0.5 (allowed 0.25)"
has "      tests/house/runner_cases.c:$(place '"force, N"'): check_near(\"force, N\", 1.5, 1.0, 0.25)"
has "FAIL  not a number: nan, expected 1, off by nan (allowed 1)"
has "FAIL  at most: 2, at most 1"
has "FAIL  at least: 1, at least 2"
has "FAIL  2^53 and one more: 9007199254740993 is not == 9007199254740992"
has "      tests/house/runner_cases.c:$(place '"2^53'): check_is(\"2^53 and one more\", (1ll << 53) + 1, ==, 1ll << 53)"
has "FAIL  equal doubles: 0.10000000000000000555 is not > 0.10000000000000000555"
has "FAIL  a NaN is less than nothing: nan is not < 1"
has "FAIL  a number: 3, expected nan"
has "FAIL  integers: 2, expected 3"
has "check_near(\"not a number\", (double)NAN, 1.0, 1.0)"
has "(int[]){1, 2}[1], 3)"
has "FAIL  words: 00000000000000ff, expected 00000000000000fe"
has "FAIL  memory: byte 2 of 3 is 0x63, expected 0x64"
has 'FAIL  strings: "one", expected "two"'
has 'FAIL  a part: "a long text", expected to contain "short"'
has 'FAIL  a part of no text: "(null)", expected to contain "short"'
has 'FAIL  taken: "mass must be positive", expected no error'
has "FAIL  refused: no error, expected one"
has "FAIL  a long text: 2999 bytes of text, expected 2999"
has 'the first line that differs: "this line"'
has 'expected: "thus line"'
lacks "xxxx"
has "ok    before it"
has "FAIL  the test ended with signal 11"
has "FAIL  the test ended its process with exit status 0"
has "FAIL  the test ended its process with exit status 3"
has "ok    goes on"
has "      failed: values, long_text, crash, leaves, leaves_with_status"
has "4 passed, 21 failed"

run 1 --jobs 3 --brief
lacks "seven"
lacks "noise on stderr"
lacks "before it"
has "      tests/house/runner_cases.c: 7 tests, 25 checks, 21 failed"
has "FAIL  force, N: 1.5, expected 1"
has "4 passed, 21 failed"
run 0 --jobs 1 --brief after passing
has "ok    tests/house/runner_cases.c: 2 tests, 3 checks, 0 failed"
has "3 passed, 0 failed"
run 0 passing
has "--- passing"
has "2 passed, 0 failed"
run 0 --list leaves
has "leaves_with_status"
lacks "passing"
run 0 --list --except leaves leaves
has "leaves_with_status"
lacks "leaves "
run 2 --except
run 2 --except no_such_name
has "no test is called no_such_name"
run 2 $(yes -- --except leaves | head -n 129)
has "at most 128 times"
run 2 no_such_name
has "no test has no_such_name in its name"
run 2 --brief
run 2 --jobs 0
run 2 --jobs
run 2 --job
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
