#!/bin/sh
# The format of every C file, as .clang-format says; clang-format 14 is what Debian 12 has.
if ! command -v clang-format >/dev/null; then
    echo "FAIL  clang-format is not installed (apt-get install clang-format)"
    exit 1
fi
n=0
bad=0
for f in */*.c */*.h tests/bench/*.[ch]* tests/papers/*.[ch]; do
    n=$((n + 1))
    if ! clang-format --dry-run --Werror "$f" 2>/dev/null; then
        echo "FAIL  format of $f: run clang-format -i $f"
        bad=$((bad + 1))
    fi
done
[ $bad -eq 0 ] && echo "ok    format of $n files"
[ $bad -eq 0 ]
