#!/bin/bash
# test_fmi.sh BUILD - FMUs as an importer meets them: the archive, both descriptions against a schema, the names of the binary, every
# preset and model through the tests' importer, the sources compiled alone and under sanitizers, bad command lines.
set -u
unset MAKEFLAGS MFLAGS MAKELEVEL
build=$(realpath "$1")
here=$(mktemp -d) || exit 1
. "$(dirname "$0")/../house/verdict.sh"
trap 'rm -rf "$here"' EXIT
trap 'exit 1' INT TERM

valid() { # SCHEMA XML: silent, or why not
    xmllint --noout --schema "tests/fmi/$1.xsd" "$2" >"$here/xml" 2>&1 || head -n 1 "$here/xml"
}
import() { # FOLDER SCENE [BINARY [IMPORTER [TESTS]]]: the last line of the importer; its log in $here/import
    FMU=$1 SCENE=$2 FMU_BINARY=${3:-$(echo "$1"/binaries/*/contactplant.so)} "${4:-$build/importer}" --jobs 1 ${5:-} >"$here/import" 2>&1 &&
        tail -n 1 "$here/import" && return
    grep -m 3 -E '^FAIL|ERROR|runtime error' "$here/import" || echo "FAIL  no tests were run"
}
is_whole() { # TEXT LINE OF THE IMPORTER
    [[ $2 =~ ^[1-9][0-9]*\ passed,\ 0\ failed$ ]]
    verdict $? "$1" "$2"
}

echo "--- the archive"
"$build/contactplant" fmu rig --out "$here/rig.fmu" 2>"$here/log"
verdict $? "contactplant fmu rig --out rig.fmu" "$(cat "$here/log")"
unzip -tq "$here/rig.fmu" >"$here/log" 2>&1
verdict $? "unzip finds no mistake" "$(head -n 3 "$here/log")"
/usr/bin/python3 -c 'import sys, zipfile; sys.exit(zipfile.ZipFile(sys.argv[1]).testzip() is not None)' "$here/rig.fmu"
verdict $? "neither does Python"
unzip -q "$here/rig.fmu" -d "$here/rig"
rig=$here/rig
"$build/contactplant" fmu rig --out "$here/again.fmu" && cmp -s "$here/rig.fmu" "$here/again.fmu"
verdict $? "written again: the same bytes"
equal "what lies at the top" "$(ls "$rig" | tr '\n' ' ')" "binaries documentation modelDescription.xml resources sources "
"$build/contactplant" scene rig | cmp -s - "$rig/resources/scene.ini"
verdict $? "resources/scene.ini is the scene"

echo "--- the descriptions"
equal "modelDescription.xml" "$(valid model_description "$rig/modelDescription.xml")" ""
equal "buildDescription.xml" "$(valid build_description "$rig/sources/buildDescription.xml")" ""
for mistake in 's/fmiVersion="3.0"/fmiVersion="2.0"/' 's/ valueReference="256"//' 's/valueReference="257"/valueReference="256"/' \
    's/name="fast_force"/name="force"/' 's/unit="N"/unit="lbf"/' '/<Output valueReference="512"/s/512/599/' 's/start="6.5"/start="heavy"/' \
    's/causality="input"/causality="inlet"/' 's/intervalVariability="triggered"/intervalVariability="now and then"/' 's/hasEventMode="true"/hasEventMode="yes"/' '/<CoSimulation/d' 's/ instantiationToken="[^"]*"//'; do
    sed "$mistake" "$rig/modelDescription.xml" >"$here/wrong.xml"
    [ -n "$(valid model_description "$here/wrong.xml")" ]
    verdict $? "the schema does not take $mistake"
done
description() { # XPATH: its value
    xmllint --xpath "string($1)" "$rig/modelDescription.xml"
}
number() { # of the scene: KEY OF A LINE
    sed -n "s/^$1 = \([-+.e0-9]*\).*/\1/p" "$rig/resources/scene.ini" | head -n 1
}
equal "start of mass_kg" "$(description '//Float64[@name="mass_kg"]/@start')" "$(number mass)"
equal "start of drive.force.amplitude" "$(description '//Float64[@name="drive.force.amplitude"]/@start')" "$(number amplitude)"
equal "start of drive.force.frequency" "$(description '//Float64[@name="drive.force.frequency"]/@start')" "$(number frequency)"
"$build/contactplant" list models | sed -n '/^model hertz_rig:/,/parameters of the paper/p' | awk '$1 == "mass_kg" {print $2, $3 + 0, $4 + 0}' >"$here/range"
equal "unit and range of mass_kg" "$(description '//Float64[@name="mass_kg"]/@unit') $(description 'number(//Float64[@name="mass_kg"]/@min)' | sed 's/0.000000001/1e-09/') $(description '//Float64[@name="mass_kg"]/@max')" "$(cat "$here/range")"

echo "--- the binary"
binary=$(echo "$rig"/binaries/*/contactplant.so)
equal "folder of the binary" "$(ls "$rig/binaries")" "$(uname -m)-linux"
nm -D --defined-only "$binary" | awk '{print $3}' | sort >"$here/names"
equal "names that it shows" "$(wc -l <"$here/names")" 75
equal "of these not the standard's" "$(grep -cv '^fmi3[A-Z]' "$here/names")" 0
equal "libraries that it needs" "$(objdump -p "$binary" | awk '$1 == "NEEDED" {print $2}' | sort | tr '\n' ' ')" "libc.so.6 libm.so.6 "
is_whole "the importer: rig" "$(import "$rig" rig)"
/usr/bin/python3 tests/fmi/import_rig.py "$rig" "$build/contactplant" >"$here/python" 2>&1
verdict $? "an importer in Python: $(grep -c ^ok "$here/python") checks" "$(grep -v ^ok "$here/python" | tail -n 2)"
grep 'rows of simulate' "$here/python" | sed 's/^ok /     /'

echo "--- every preset and model"
mkdir "$here/all"
for scene in $("$build/contactplant" list | sed -n '/^scenes /,/^settings/s/^    \([^ ]*\) .*/\1/p') $("$build/contactplant" list models | sed -n 's/^model \([a-z_0-9]*\):.*/\1/p'); do
    rm -rf "$here/one"
    if ! "$build/contactplant" fmu "$scene" --out "$here/one.fmu" >"$here/log" 2>&1; then
        "$build/contactplant" dbc "$scene" >"$here/dbc" 2>&1
        equal "$scene is refused as everywhere" "$(sed 's/^contactplant fmu//; s/; see .*//' "$here/log")" "$(sed 's/^contactplant dbc//; s/; see .*//' "$here/dbc")"
        continue
    fi
    unzip -q "$here/one.fmu" modelDescription.xml 'resources/*' -d "$here/one"
    cp "$here/one/modelDescription.xml" "$here/all/$scene.xml"
    is_whole "$scene: the plant's bits" "$(import "$here/one" "$scene" "$binary" "" scene_)"
done
# All in one process: most of the time is the schema's.
xmllint --noout --schema tests/fmi/model_description.xsd "$here"/all/*.xml >"$here/xml" 2>&1
equal "modelDescription.xml of $(ls "$here/all" | wc -l) scenes: valid" "$(grep -c ' validates$' "$here/xml") $(grep -m 1 -v ' validates$' "$here/xml")" "$(ls "$here/all" | wc -l) "

echo "--- the sources alone"
cd "$rig/sources" || exit 1
build_of() { # XPATH: its values, a line each
    xmllint --xpath "$1" buildDescription.xml | sed 's/^ *[A-Za-z]*="\(.*\)"$/\1/'
}
files=$(build_of '//SourceFile/@name')
flags="$(build_of '//@compilerOptions') $(build_of '//PreprocessorDefinition/@name' | sed 's/^/-D/') $(build_of '//IncludeDirectory/@name' | sed 's/^/-I/')"
libraries=$(build_of '//Library/@name' | sed 's/^/-l/')
sanitize="-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -g"
alone() { # BINARY COMPILER AND FLAGS: the shared library, as an importer compiles it
    local out=$1
    shift
    "$@" $flags -fPIC -shared -DFMI3_OVERRIDE_FUNCTION_PREFIX $files $libraries -o "$out" 2>"$here/log"
    verdict $? "$* $(echo "$files" | wc -l) files -shared" "$(head -n 3 "$here/log")"
}
alone "$here/gcc.so" gcc -Wall -Wextra -Werror
gcc $flags -c host_sim/fmu/fmu_refuse.c -o "$here/prefix.o"
equal "without the override names begin with" "$(nm -g --defined-only "$here/prefix.o" | awk '{print substr($3, 1, 17)}' | sort -u)" contactplant_fmi3
cd - >/dev/null || exit 1
# Under the sanitizers the same files from the build of all tests, but for the names that functions have in an FMU.
objects=$(make -s BUILD=build/asan fmu-objects)
make -s sanitized-targets TARGETS="$(echo $objects)" >"$here/log" 2>&1 && clang $sanitize -shared $objects $libraries -o "$here/sanitized.so" 2>"$here/log"
verdict $? "the same files, $(echo "$objects" | wc -w) objects, under the sanitizers" "$(tail -n 3 "$here/log")"
clang -O1 -std=c99 $sanitize -D_GNU_SOURCE -I. tests/fmi/*.c tests/unit/main.c tests/unit/check.c "$build/libcontactplant.a" -lm -o "$here/importer" 2>"$here/log"
verdict $? "the importer under the sanitizers" "$(head -n 3 "$here/log")"
for by in gcc sanitized; do
    is_whole "sources by $by: the plant's bits" "$(import "$rig" rig "$here/$by.so" "$([ $by = sanitized ] && echo "$here/importer")")"
done
for scene in tip shaft nayak-random; do
    "$build/contactplant" fmu $scene --out "$here/one.fmu" 2>"$here/log"
    rm -rf "$here/one"
    unzip -q "$here/one.fmu" modelDescription.xml 'resources/*' -d "$here/one"
    is_whole "any call with any value, sanitized: $scene" "$(import "$here/one" $scene "$here/sanitized.so" "$here/importer" rig_any)"
done

echo "--- installed"
make -s BUILD="$build" PREFIX="$here/usr" install >"$here/log" 2>&1
verdict $? "make install PREFIX=.." "$(tail -n 3 "$here/log")"
"$here/usr/bin/contactplant" fmu rig --out "$here/installed.fmu" 2>"$here/log" && cmp -s "$here/installed.fmu" "$here/rig.fmu"
verdict $? "the installed program writes the same FMU" "$(cat "$here/log")"
make -s BUILD="$build" PREFIX="$here/usr" uninstall >"$here/log" 2>&1
equal "what make uninstall leaves" "$(ls "$here/usr" 2>/dev/null)" ""

echo "--- the command line"
refuse() { # PART OF THE TEXT, ARGUMENTS..
    local part=$1 out
    shift
    out=$("$build/contactplant" fmu "$@" 2>&1)
    [ $? != 0 ] && [[ $out == *"$part"* ]]
    verdict $? "contactplant fmu $*: $out" "no error with \"$part\""
}
refuse "say where the FMU goes" rig
refuse "did you mean" rigg --out "$here/x.fmu"
refuse "cannot write --out /nowhere/x.fmu" rig --out /nowhere/x.fmu
cp "$rig/resources/scene.ini" "$here/own.ini"
refuse "is the scene itself" "$here/own.ini" --out "$here/own.ini"
echo "mass = heavy" >>"$here/own.ini"
refuse "own.ini:" "$here/own.ini" --out "$here/x.fmu"
odd=$(printf '%s/a&b<\001\351.ini' "$here")
cp "$rig/resources/scene.ini" "$odd"
"$build/contactplant" fmu "$odd" --out "$here/odd.fmu" >/dev/null 2>&1 && unzip -p "$here/odd.fmu" modelDescription.xml >"$here/odd.xml" &&
    xmllint --noout --schema tests/fmi/model_description.xsd "$here/odd.xml" >"$here/odd.why" 2>&1
verdict $? "a scene file with a name of any bytes" "$(head -n 2 "$here/odd.why")"
cp "$build/contactplant" "$here/contactplant"
out=$("$here/contactplant" fmu rig --out "$here/x.fmu" 2>&1)
[ $? = 1 ] && [[ $out == *"run make install"* ]]
verdict $? "a program without its parts: $out" "no error that says what to do"
[ -e "$here/x.fmu" ]
equal "files that a refusal leaves" $? 1
(ulimit -f 100; "$build/contactplant" fmu rig --out "$here/full.fmu" >"$here/log" 2>&1)
equal "no room: status" $? 1
equal "no room: what is left" "$(ls "$here" | grep -c full)" 0

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
