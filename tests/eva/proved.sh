#!/bin/sh
# proved.sh keep|check NAME FLAGS FILE.. - of which code Eva has proved that NAME raises no alarm: a line in tests/eva/proved.txt.
#
# The code is the C files, the project's headers that they include, and Eva's flags; comments and blanks do not count. `keep` writes the
# line after a proof, `check` compares it with the code of today.
record=tests/eva/proved.txt
what=$1
name=$2
shift 2
flags=$1
shift
code=$({
    echo "$flags"
    gcc -std=c99 -I. -MM -MG "$@" | tr ' \\' '\n\n' | grep "/.*\.[ch]$" | LC_ALL=C sort -u | xargs perl -0777 -pe 's{/\*.*?\*/}{}gs; s/\s+//g'
} | sha256sum | cut -d' ' -f1)
if [ "$what" = keep ]; then
    flock "$record" sed -i "s/^$name .*/$name $code/" "$record"
elif grep -qx "$name $code" "$record"; then
    echo "ok    eva $name: the code is that of its last proof"
else
    echo "FAIL  eva $name: the code is no longer that of its last proof: run make eva-$name, and commit $record"
    exit 1
fi
