#!/bin/sh
# The format of every C file, as .clang-format says; clang-format 14 is what Debian 12 has.
if ! command -v clang-format >/dev/null; then
    echo "FAIL  clang-format is not installed (apt-get install clang-format)"
    exit 1
fi
set -- $(find models firmware hal host_sim linker tests docs/examples -name '*.[ch]' -o -name '*.cpp' | sort)
if text=$(clang-format --dry-run --Werror "$@" 2>&1); then
    echo "ok    format of $# files"
    exit 0
fi
bad=$(printf '%s\n' "$text" | sed -n 's/^\([^: ]*\):[0-9]*:[0-9]*: error: .*/\1/p' | sort -u)
for f in ${bad:-"$(printf '%s\n' "$text" | head -n 1)"}; do
    echo "FAIL  format of $f: run clang-format -i $f"
done
exit 1
