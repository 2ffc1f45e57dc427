#!/bin/sh
# An include never runs upwards: models <- firmware <- host_sim, firmware/main.c, tests; models and hal.h <- hal. No file but the table of instances
# asks which model it has by its address. Prints each breach; 0 when there is none.
bad=0
forbid() { # room, pattern of includes that it must not have
    if find "$1" -name '*.[ch]' ! -path firmware/main.c | xargs grep -nE "#include [<\"]($2)"; then
        echo "FAIL  $1/ includes what stands above it or outside the core"
        bad=1
    else
        echo "ok    $1/ includes nothing of: $2"
    fi
}
os='stdio|stdlib|unistd|time\.h|sys/|pthread|errno|signal|assert|linux/|net'
forbid models "firmware/|hal/|host_sim/|tests/|$os"
forbid firmware "hal/[a-gi-z]|host_sim/|tests/|$os"
forbid hal "firmware/|host_sim/|tests/"
forbid host_sim "tests/"
# A model is `const struct model NAME = {` in models/.
names=$(sed -n 's/^const struct model \([a-z_0-9]*\) = {.*/\1/p' $(find models -name '*.c') | paste -s -d'|')
if grep -nE "[=!]= *&($names)\b|&($names) *[=!]=" $(find models firmware hal host_sim -name '*.[ch]') | grep -v '^firmware/method/instances\.h'; then
    echo "FAIL  a model is compared by its address outside firmware/method/instances.h: use a property of it, or a row of a table"
    bad=1
else
    echo "ok    no model is compared by its address outside firmware/method/instances.h"
fi
if grep -n 'struct app \*' firmware/app/telemetry*.[ch] | grep -v 'const struct app \*'; then
    echo "FAIL  telemetry reads the app and changes only its own state: const struct app *"
    bad=1
else
    echo "ok    telemetry takes a const struct app"
fi
# A plant is set up by its configuration; host_sim replaces none of its functions and none of its ledger's parts.
if find host_sim -name '*.[ch]' | xargs grep -nE '\<(pl|plant|begin|lead)(\.|->)(step|method|ledger\.(model|piece)) = [^=]'; then
    echo "FAIL  host_sim changes a plant's step or ledger: say it in struct plant_config, or by a method of its own"
    bad=1
else
    echo "ok    host_sim leaves a plant's step and ledger alone"
fi
# JSON and XML are written by host_sim/out alone, so that any name survives in them.
if grep -rnE '&(amp|lt|gt|quot);|<[?]xml|\\"[a-zA-Z_]+\\" *:|(printf|fputs)\(.*/>' host_sim --include='*.[ch]' | grep -v '^host_sim/out/'; then
    echo "FAIL  host_sim writes JSON or XML outside host_sim/out: use json_put or xml_put"
    bad=1
else
    echo "ok    JSON and XML are written by host_sim/out alone"
fi
if find models firmware hal host_sim -name '*_parts.h' | grep .; then
    echo "FAIL  a _parts.h: each declaration stands in the header of the file that defines it"
    bad=1
fi
# Every source says what it is before anything else.
silent=$(find models firmware hal host_sim linker tests docs/examples -name '*.c' \( -empty -print -o -exec awk 'FNR == 1 {
    name = FILENAME; sub(".*/", "", name)
    if (index($0, "/* " name " ") != 1 && index($0, "/* " name ",") != 1) print FILENAME }' {} + \))
if [ -n "$silent" ]; then
    echo "FAIL  begin with a line \"/* NAME - what it is\": "$silent
    bad=1
else
    echo "ok    each source begins with its name and what it is"
fi
# What is written keeps what is read: outputs are opened in one place, which knows both.
if find host_sim -name '*.c' ! -path host_sim/cli/files.c | xargs grep -nE 'fopen\([^"]*"[wa]|"r\+|O_CREAT|\<(creat|freopen|truncate|mkstemp)\('; then
    echo "FAIL  a file is opened to write outside host_sim/cli/files.c: use files_create or files_compose"
    bad=1
else
    echo "ok    host_sim opens files to write in host_sim/cli/files.c alone"
fi
# A room that one can look over.
full=$(find models firmware hal host_sim tests -name '*.c' | sed 's|/[^/]*$||' | sort | uniq -c | awk '$1 > 15 {print $2 " (" $1 ")"}')
if [ -n "$full" ]; then
    echo "FAIL  more than 15 sources in one folder:" $full
    bad=1
else
    echo "ok    at most 15 sources in a folder"
fi
exit $bad
