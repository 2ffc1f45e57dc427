#!/bin/sh
# test_make.sh - what the Makefile promises: other flags build anew, warnings are errors only where it is asked for, and help
# names every target. Run from the project's top folder; ends with `N passed, N failed`.
set -u
unset MAKEFLAGS MFLAGS MAKELEVEL WERROR
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
object=$out/models/models.o
. tests/house/verdict.sh

built() { # how many times the object is compiled: 0 or 1; what it is, variables
    wanted=$1
    text=$2
    shift 2
    got=$(make BUILD="$out" "$@" "$object" 2>&1 | grep -c ' models/models\.c$')
    [ "$got" = "$wanted" ]
    verdict $? "make $* ($text): compiled $got times, expected $wanted"
}

built 1 "the first time"
built 0 "again"
built 1 "another level" OPT=-O0
built 0 "again" OPT=-O0
built 1 "another compiler" OPT=-O0 CC=clang
built 1 "an addition with quotes" "EXTRA=-DA='\"a b\"'"
built 0 "again" "EXTRA=-DA='\"a b\"'"
built 1 "back"
built 1 "warnings are errors" WERROR=-Werror
built 0 "as before: what was built with -Werror does"

make -s BUILD="$out" "$out/runner_cases" >/dev/null 2>&1
rm "$out/tests/unit/check.o"
make -s BUILD="$out" "$out/runner_cases" >/dev/null 2>&1 && [ -e "$out/tests/unit/check.o" ]
verdict $? "an object that is missing is made again, though what needs it is there"

rm "$object"
make BUILD="$out" EXTRA=-Wpadded "$object" >"$out/text" 2>&1 && grep -q 'warning:' "$out/text"
verdict $? "a warning does not end a user's build"
rm -f "$object"
! make BUILD="$out" EXTRA=-Wpadded WERROR=-Werror "$object" >"$out/text" 2>&1
verdict $? "a warning ends the build with WERROR=-Werror"
make -n check 2>/dev/null | grep -q -e -Werror
verdict $? "make check asks for it"

make -s help >"$out/help"
verdict $? "make help: $(wc -l <"$out/help") lines"
for target in $(sed -n 's/^\.PHONY://p' Makefile host_sim/*/*.mk linker/*.mk tests/*/*.mk); do
    case $target in
    *[!a-z-]* | FORCE | programs | *-targets | *-corpus | *-compiler | *-objects | *-sources | *-flags | *-check | charts-* | bench-peers | stack-depth | board*) ;;
    cross-compiler) ;; # made by other targets and scripts
    *)
        grep -q "^make $target " "$out/help"
        verdict $? "make help names $target"
        ;;
    esac
done
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
