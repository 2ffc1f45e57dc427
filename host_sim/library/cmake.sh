#!/bin/sh
# cmake.sh FOLDER CONFIG LIB INCLUDE - contactplant-config.cmake and its version file into FOLDER, for a library in LIB and a header in
# INCLUDE once they lie in CONFIG. By the Makefile, with ABI, VERSION and POINTER, the bytes of a pointer.
set -eu
seen() { # PATH from CONFIG, for the right side of a sed command
    realpath -m --relative-to="$1" "$2" | sed 's/[\\&|]/\\&/g'
}
mkdir -p "$1"
for file in contactplant-config contactplant-config-version; do
    sed -e "s|@LIB@|$(seen "$2" "$3")|" -e "s|@INCLUDE@|$(seen "$2" "$4")|" -e "s|@ABI@|$ABI|" -e "s|@VERSION@|$VERSION|" \
        -e "s|@POINTER@|$POINTER|" "host_sim/library/$file.cmake.in" >"$1/$file.cmake"
done
