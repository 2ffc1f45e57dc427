#!/bin/bash
# test_library.sh BUILD - the library as a user meets it: installed into an empty folder, the examples built elsewhere against nothing but
# that, shared and static, C and C++, gcc and clang; what is visible; a client of before with a library that has grown; uninstalled.
# Prints one line a check and `N passed, N failed` at the end. Speaks on loopback only.
set -u
build=$1
unset MAKEFLAGS MFLAGS MAKELEVEL
here=$(mktemp -d) || exit 1
tree=$PWD
. "$(dirname "$0")/../house/verdict.sh"
children=
trap 'for pid in $children; do kill "$pid" 2>/dev/null; done; rm -rf "$here"' EXIT
trap 'exit 1' INT TERM

echo "--- what is visible"
equal "names of libcontactplant.a without the prefix" "$(nm -g --defined-only "$build/libcontactplant.a" | awk 'NF == 3 && $3 !~ /^contactplant_/' | wc -l)" 0
equal "names of libcontactplant.so without the prefix" "$(nm -D --defined-only "$build/libcontactplant.so" | awk '$3 !~ /^contactplant_/' | wc -l)" 0
declared=$(sed -n '/CONTACTPLANT_API/,/;/p' host_sim/library/contactplant.h | grep -o 'contactplant_[a-z_]*(' | tr -d '(' | sort -u)
for library in "-g $build/libcontactplant.a" "-D $build/libcontactplant.so"; do
    defined=$(nm --defined-only $library | awk 'NF == 3 {print $3}' | sort -u)
    [ "$defined" = "$declared" ]
    verdict $? "nm $library: the $(echo "$declared" | wc -l) functions of the header" "$(diff <(echo "$defined") <(echo "$declared") | tr '\n' ' ')"
done
abi=$(sed -n 's/^#define CONTACTPLANT_ABI *\([0-9]*\).*/\1/p' host_sim/library/contactplant.h)
version=$(sed -n 's/^#define CONTACTPLANT_VERSION *"\(.*\)"/\1/p' host_sim/library/contactplant.h)
numbers=$(sed -n 's/^#define CONTACTPLANT_VERSION_[MP][A-Z]* *\([0-9]*\)$/\1/p' host_sim/library/contactplant.h | paste -sd .)
equal "version by its three numbers" "$numbers" "$version"
equal "newest version of CHANGELOG.md" "$(sed -n 's/^## \([0-9.]*\) - 20..-..-..$/\1/p' CHANGELOG.md | head -n 1)" "$version"
protocol=$(sed -n 's/^#define CONTACTPLANT_PROTOCOL *\([0-9]*\).*/\1/p' host_sim/library/contactplant.h)
equal "contactplant version" "$("$build/contactplant" version)" "contactplant $version, protocol $protocol, ABI $abi"
equal "soname" "$(objdump -p "$build/libcontactplant.so" | awk '$1 == "SONAME" {print $2}')" "libcontactplant.so.$abi"
writable=$(size -A "$build/libcontactplant.a" | awk '$1 ~ /^\.(data|bss)(\.|$)/ && $1 !~ /rel\.ro/ {n += $2} END {print n + 0}')
equal "writable data of the library, bytes" "$writable" 0

echo "--- the header"
printf '#include "contactplant.h"\n' >"$here/header.c"
cp "$here/header.c" "$here/header.cpp"
for compiler in "gcc -std=c99" "gcc -std=c11" "clang -std=c99" "clang -std=c11" "g++ -std=c++17" "clang++ -std=c++17"; do
    case $compiler in *++*) source=header.cpp ;; *) source=header.c ;; esac
    why=$($compiler -Wall -Wextra -Wpedantic -Wconversion -Werror -Ihost_sim/library -c "$here/$source" -o "$here/header.o" 2>&1)
    verdict $? "contactplant.h by $compiler" "$why"
done

echo "--- install"
prefix=$here/usr
make -s BUILD="$build" PREFIX="$prefix" install >"$here/log" 2>&1
verdict $? "make install PREFIX=.." "$(tail -n 3 "$here/log")"
make -s BUILD="$build" PREFIX=/opt/rig LIBDIR=/opt/rig/lib64 DESTDIR="$here/stage" install >"$here/log" 2>&1
verdict $? "make install DESTDIR=.." "$(tail -n 3 "$here/log")"
equal "nothing stands outside DESTDIR's PREFIX" "$(find "$here/stage" -type f ! -path "$here/stage/opt/rig/*" | wc -l)" 0
export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
make -s BUILD="$build" PREFIX="/opt/my plant & co" DESTDIR="$here/blank" install >"$here/log" 2>&1
grep -q '^PREFIX has a blank: compile with eval "cc my.c ' "$here/log"
verdict $? "make install tells how to compile then" "$(tail -n 3 "$here/log")"
blank=$here/blank/opt/my\ plant\ \&\ co
equal "a prefix with blanks, as a shell reads it" "$(eval "printf '<%s>' $(PKG_CONFIG_PATH=$blank/lib/pkgconfig pkg-config --cflags --libs-only-L contactplant)")" \
    "<-I/opt/my plant & co/include><-ffp-contract=off><-L/opt/my plant & co/lib>"
equal "and as a variable" "$(PKG_CONFIG_PATH=$blank/lib/pkgconfig pkg-config --variable=prefix contactplant)" "/opt/my plant & co"
for part in -ffast-math -Ofast -ffinite-math-only; do
    for compiler in gcc clang; do
        ! why=$($compiler -std=c99 -I. $part -include models/check.h -c -x c /dev/null -o "$here/fast.o" 2>&1) && echo "$why" | grep -q "change the bits of a plant"
        verdict $? "$compiler $part is refused in words" "$why"
    done
done
for part in -fassociative-math -fsingle-precision-constant; do
    ! why=$(make -s -n EXTRA=$part 2>&1) && echo "$why" | grep -q -- "$part changes the bits"
    verdict $? "make EXTRA=$part is refused in words" "$why"
done
for part in "-mfpmath=387 x87.keeps.more" "-mfpmath=both x87.keeps.more" "-fsingle-precision-constant constants_are_doubles"; do
    ! why=$(gcc -std=c99 -I. ${part% *} -include models/check.h -c -x c /dev/null -o "$here/fast.o" 2>&1) && echo "$why" | grep -q "${part#* }"
    verdict $? "gcc ${part% *} is refused, beside make, too" "$why"
done
equal "version by pkg-config" "$(pkg-config --modversion contactplant)" "$version"
equal "prefix by pkg-config" "$(PKG_CONFIG_PATH=$here/stage/opt/rig/lib64/pkgconfig pkg-config --variable=prefix contactplant)" /opt/rig
equal "contactplant --version" "$("$prefix/bin/contactplant" --version | cut -d, -f1)" "contactplant $version"
equal "presets" "$(ls "$prefix/share/contactplant/scenes" | wc -l)" 64
for scene in "$prefix"/share/contactplant/scenes/*.ini; do
    "$prefix/bin/contactplant" scene "$scene" >/dev/null 2>"$here/log" || verdict 1 "$scene" "$(cat "$here/log")"
done
cmp -s "$prefix/share/contactplant/contactplant.dbc" docs/reference/contactplant.dbc
verdict $? "the .dbc is the one of the docs"
missing=
for command in $("$build/contactplant" --help | awk '/^subcommands:/ {on = 1; next} /^$/ {on = 0} on && /^  / {print $1}'); do
    grep -q "^.SS contactplant $command" "$prefix/share/man/man1/contactplant.1" || missing="$missing $command"
done
equal "subcommands without a section in the manual page" "$missing" ""
guides=$(ls docs/guide/*.md | wc -l)
equal "manual pages of the guides" "$(ls "$prefix"/share/man/man7/contactplant-*.7 | wc -l)" "$guides"
for lint in "groff -k -man -Tutf8 -ww -z" "mandoc -T lint -W warning"; do
    command -v ${lint%% *} >/dev/null || continue
    equal "warnings of $lint about all manual pages" "$(for page in "$prefix"/share/man/man[17]/*; do $lint "$page" 2>&1; done | head -n 3)" ""
done
for word in $("$prefix/bin/contactplant" fit --help | grep -o 'docs/[a-z]*/[a-z_-]*\.md') protocol; do
    (cd / && "$prefix/bin/contactplant" help "$word") >"$here/page" 2>"$here/log" && grep -q "^# " "$here/page"
    verdict $? "the installed program prints $word" "$(cat "$here/log")"
done
doc=$prefix/share/doc/contactplant
missing=
for name in $(for command in $("$build/contactplant" --help | sed -n '/^subcommands/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
    "$prefix/bin/contactplant" "$command" --help; done | grep -oE 'docs/[A-Za-z0-9_/.-]*[a-z]' | sort -u); do
    [ -e "$doc/$name" ] || missing="$missing $name"
done
equal "pages that a subcommand's --help names and that are not installed" "$missing" ""
missing=
for name in $({ cat "$doc/README.md"; cat "$prefix/share/man/man1/contactplant.1"; } | tr -d '\\' | grep -oE '(docs|host_sim)/[A-Za-z0-9_/.-]*\.(md|dbc|c|h|svg|png)' | sort -u); do
    [ -e "$doc/$name" ] || missing="$missing $name"
done
equal "pages that README or the manual page name and that are not installed" "$missing" ""
missing=
for page in $(find "$doc" -name '*.md'); do
    for name in $(grep -oE '\]\([A-Za-z0-9_/.-]*' "$page" | cut -c 3-); do
        [ -e "$(dirname "$page")/$name" ] || missing="$missing $name"
    done
done
equal "links of installed pages that lead nowhere" "$missing" ""
words() { # WORDS OF A COMMAND LINE..: what bash offers for the last one
    bash -c '. "$1"; shift; COMP_WORDS=("$0" "$@"); COMP_CWORD=$#; _contactplant; echo "${COMPREPLY[*]}"' "$prefix/bin/contactplant" \
        "$prefix/share/bash-completion/completions/contactplant" "$@"
}
equal "completion of: si" "$(words si)" simulate
equal "completion of: run --dur" "$(words run --dur)" --duration
equal "completion of: run shaft-fig18-2" "$(words run shaft-fig18-2)" "shaft-fig18-25 shaft-fig18-25p"
equal "completion of: run --method rk4_" "$(words run --method rk4_)" "rk4_float32 rk4_unlocated"
equal "completion of: run --set mass_" "$(words run --set mass_)" "mass_kg="
equal "completion of: run --setting timeout" "$(words run --setting timeout)" "timeout_frames="
equal "completion of: run shaft --set mass, by the model of the scene" "$(words run shaft --set mass)" "mass1_kg= mass2_kg= mass3_kg="
equal "completion of: run --overrun f" "$(words run --overrun f)" freeze
equal "completion of: simulate --units" "$(words simulate --units "")" "model si"
equal "completion of: stability --map c" "$(words stability --map c)" contact
equal "completion of: random rig --observable pen" "$(words random rig --observable pen)" penetration
equal "completion of: run --drive stiff" "$(words run --drive stiff)" "stiffness="
equal "completion of: help --errors sta" "$(words help --errors sta)" "stale state"
equal "completion of: help fm" "$(words help fm)" fmi
equal "completion of: list mod" "$(words list mod)" models
equal "completion of: send --model rig" "$(words send --model rig)" rig

echo "--- examples, outside of the tree"
mine=$here/mine
mkdir "$mine"
cp "$prefix"/share/doc/contactplant/examples/*.[ch] "$mine"
export LD_LIBRARY_PATH=$prefix/lib
cd "$mine" || exit 1
# Of those whose output is compared each form; clean_room.sh builds all of them by gcc and g++, so the others by clang and clang++.
wanted() { # FORM of the example $name
    case $name.$1 in unit_test.* | in_process.* | afm_loop.* | *.clang | *.clang++.static) return 0 ;; *) return 1 ;; esac
}
for source in *.c; do
    name=${source%.c}
    [ "$(wc -l <"$source")" -lt 100 ]
    verdict $? "$source has $(wc -l <"$source") lines" "100 or more"
    cp "$source" "$name.cpp"
    for compiler in gcc clang g++ clang++; do
        case $compiler in *++) language="-std=c++17 $name.cpp" ;; *) language=$source ;; esac
        if wanted $compiler; then
            why=$($compiler -Wall -Wextra -Wpedantic -Werror $language $(pkg-config --cflags --libs contactplant) -lm -o "$name.$compiler" 2>&1)
            verdict $? "$name by $compiler, shared" "$why"
        fi
        if wanted $compiler.static; then
            why=$($compiler -static $language $(pkg-config --static --cflags --libs contactplant) -lm -o "$name.$compiler.static" 2>&1)
            verdict $? "$name by $compiler, static" "$why"
        fi
    done
done
for name in unit_test in_process afm_loop; do
    ./$name.gcc >$name.out 2>&1
    verdict $? "$name runs" "$(tail -n 2 $name.out)"
    for program in $name.*++ $name.clang $name.*.static; do
        ./"$program" 2>&1 | cmp -s - $name.out
        verdict $? "$program prints the same"
    done
done
cmp -s afm_loop.out "$tree/tests/library/afm_loop.txt"
verdict $? "afm_loop prints what it did" "$(diff afm_loop.out "$tree/tests/library/afm_loop.txt" | tr '\n' ' ')"
# What the README shows.
(echo '#include <contactplant.h>'; echo 'int main(void) { struct contactplant_error error; int lost;'
    sed -n '/^```c$/,/^```$/p' "$tree/README.md" | grep -v '^```'; echo 'return !lost; }') >readme.c
why=$(gcc -Wall -Wextra -Werror readme.c $(pkg-config --cflags --libs contactplant) -o readme 2>&1 && ./readme)
verdict $? "the README's $(wc -l <readme.c) lines: contact is lost" "$why"
# The user's own names are the user's.
cat >own.c <<'EOF'
#include <contactplant.h>
double exponential(double x);
double exponential(double x) { return x; }
int exact = 3, client_open = 4, taylor = 5;
int main(void) { return exponential(contactplant_abi()) + exact + client_open + taylor != 13.0; }
EOF
for how in "" "--static"; do
    gcc own.c ${how:+-static} $(pkg-config $how --cflags --libs contactplant) -o own 2>log && ./own
    verdict $? "names of the user that the library has inside, too${how:+, static}" "$(head -n 1 log)"
done

# Four ports in a row that nobody has.
port=$((20100 + $$ % 900 * 10))
while cat /proc/net/udp /proc/net/udp6 2>/dev/null | awk -v first=$port '{ split($2, at, ":"); used = used " " toupper(at[2]) " " }
        END { for (i = 0; i < 4; i++) if (index(used, sprintf(" %04X ", first + i))) exit 0; exit 1 }'; do
    port=$((port + 10))
done
"$prefix/bin/contactplant" run --bus udp:$port --peer 127.0.0.1:$((port + 1)) --duration 120 --setting timeout_frames=10000 \
    --setting age_limit_frames=10000 >run.out 2>run.err &
plant=$!
children="$children $plant"
for _ in $(seq 600); do grep -q "Ctrl-C ends it" run.err && break; sleep 0.1; done
for program in controller_udp.clang controller_udp.clang++.static; do
    why=$(timeout 60 ./$program $port $((port + 1)) 2>&1)
    verdict $? "$program: $why" "$(tail -n 2 run.err)"
done
kill -INT $plant
wait $plant
verdict $? "the plant ends" "$(tail -n 2 run.err)"
for program in controller_udp.clang controller_udp.clang++.static; do # no clock: bus frames begin with its words
    rm run.err
    "$prefix/bin/contactplant" run --lockstep --log $program.log --bus udp:$port --peer 127.0.0.1:$((port + 1)) >run.out 2>run.err &
    plant=$!
    children="$children $plant"
    for _ in $(seq 600); do grep -qs "in lockstep" run.err && break; sleep 0.1; done
    why=$(timeout 60 ./$program $port $((port + 1)) 2>&1)
    verdict $? "$program in lockstep: $why" "$(tail -n 2 run.err)"
    kill -INT $plant
    wait $plant
    verdict $? "$(sed -n 's/^frames //p' run.out)" "$(tail -n 2 run.err)"
done
cmp controller_udp.clang.log controller_udp.clang++.static.log
verdict $? "logs of the two are equal to the byte"

echo "--- a client of before, a library that has grown"
cd - >/dev/null || exit 1
mkdir "$here/grown"
cp -r models firmware hal host_sim "$here/grown"
grow() { # STRUCT FILE
    sed -i "s/^struct $1 {/&\n    double grown_$1[123];/" "$here/grown/$2"
    grep -q "grown_$1" "$here/grown/$2" || verdict 1 "$2 has no struct $1 to grow"
}
grow plant firmware/plant/plant.h
grow app firmware/app/app.h
grow client host_sim/live/client.h
grow scene_app host_sim/scene/scene_app.h
grow contactplant host_sim/library/library.h
grow contactplant_client host_sim/library/library.h
grow contactplant_afm host_sim/library/library_afm.h
sources=$(make -s lib-sources)
flags=$(make -s lib-flags)
(cd "$here/grown" && gcc -O0 $flags -w -shared -Wl,-soname,libcontactplant.so."$abi" $sources -lm -o libcontactplant.so."$abi") 2>"$here/log"
verdict $? "a library with larger structs" "$(head -n 2 "$here/log")"
cat >"$here/size.c" <<'EOF'
#include <contactplant.h>
#include <stdio.h>
int main(void) { return printf("%zu %zu\n", contactplant_size(), contactplant_client_size()) < 0; }
EOF
gcc "$here/size.c" $(pkg-config --cflags --libs contactplant) -o "$here/size"
before=$("$here/size")
after=$(LD_LIBRARY_PATH=$here/grown "$here/size")
[ -n "$after" ] && [ "$before" != "$after" ]
verdict $? "sizes of plant and client: $before, grown: $after" "they are the same"
for name in unit_test in_process afm_loop; do
    LD_LIBRARY_PATH=$here/grown "$mine/$name.gcc" 2>&1 | cmp -s - "$mine/$name.out"
    verdict $? "$name of before prints the same with it"
done

# Another ABI is another file name: the loader refuses, and says which library is missing.
(mkdir "$here/other" && cp "$here/grown/libcontactplant.so.$abi" "$here/other/libcontactplant.so.$((abi + 1))")
why=$(LD_LIBRARY_PATH=$here/other "$mine/unit_test.gcc" 2>&1)
[ $? = 127 ] && echo "$why" | grep -q "libcontactplant.so.$abi: cannot open"
verdict $? "a library of another ABI is not taken: $(echo "$why" | sed 's/.*: error/error/')"

echo "--- a locale whose numbers have a comma"
mkdir "$here/locale"
localedef -i de_DE -f UTF-8 "$here/locale/de_DE.UTF-8" 2>"$here/log"
cat >"$here/locale.c" <<'EOF'
#include <contactplant.h>
#include <locale.h>
#include <stdio.h>
#include <string.h>
static union contactplant_memory memory;
int main(int argc, char **argv)
{
    struct contactplant_error error;
    if (argc > 1 && (!setlocale(LC_ALL, argv[1]) || strcmp(localeconv()->decimal_point, ",")))
        return puts("no comma"), 1;
    struct contactplant *rig = contactplant_open(&memory, sizeof memory, "[plant]\nmodel = hertz_rig\nmass = 5.25 kg\n"
        "preload = 0.0615 kN\n[drive force]\namplitude = 1.5e-3 kN\nfrequency = 225.5 Hz\n", &error);
    if (!rig)
        return puts(error.text), 1;
    contactplant_advance(rig, 6400);
    printf("%016llx\n", (unsigned long long)contactplant_hash(rig));
    contactplant_set_parameter(rig, contactplant_find(rig, CONTACTPLANT_PARAMETER, "mass_kg"), -0.5);
    puts(contactplant_error(rig));
    contactplant_open(&memory, sizeof memory, "[plant]\nmodel = hertz_rig\nmass = 5,25 kg\n", &error);
    puts(error.text);
    contactplant_open(&memory, sizeof memory, "[plant]\nmodel = hertz_rig\nmass = 5.5e9 kg\n", &error);
    puts(error.text);
    return 0;
}
EOF
gcc "$here/locale.c" $(pkg-config --cflags --libs contactplant) -o "$here/locale.out" 2>"$here/log"
verdict $? "a program with a locale" "$(head -n 1 "$here/log")"
plain=$("$here/locale.out")
verdict $? "in C's: $(echo "$plain" | tr '\n' ' ')" "it fails"
equal "in de_DE's, the last bit and each text" "$(LOCPATH=$here/locale "$here/locale.out" de_DE.UTF-8 | tr '\n' ' ')" "$(echo "$plain" | tr '\n' ' ')"

echo "--- firmware"
m7="-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard"
make -s BUILD="$here/m7" CROSS=arm-none-eabi- LIB_FLAGS="$m7" WERROR=-Werror lib >"$here/log" 2>&1
verdict $? "make lib CROSS=arm-none-eabi- for a Cortex-M7" "$(grep -m 1 error "$here/log")"
arm=$here/m7/lib-arm-none-eabi/libcontactplant.a
equal "its names without the prefix" "$(arm-none-eabi-nm -g --defined-only "$arm" | awk 'NF == 3 && $3 !~ /^contactplant_/' | wc -l)" 0
# From outside: C99's text and memory functions, the compiler's own, and check_failed.
equal "what it takes from the firmware beside C99" "$(arm-none-eabi-nm -u "$arm" | awk '$1 == "U" {print $2}' |
    grep -vE '^(__aeabi_.*|mem(cpy|move|set|cmp|chr)|str(chr|cmp|cspn|len|ncmp|pbrk|str|tod)|tolower|atoi|f(mod|min|max)|is(alnum|space|digit)|v?snprintf)$' | tr '\n' ' ')" "check_failed "

echo "--- uninstall"
make -s BUILD="$build" PREFIX="$prefix" uninstall >"$here/log" 2>&1
verdict $? "make uninstall PREFIX=.." "$(tail -n 3 "$here/log")"
make -s BUILD="$build" PREFIX=/opt/rig LIBDIR=/opt/rig/lib64 DESTDIR="$here/stage" uninstall >"$here/log" 2>&1
verdict $? "make uninstall DESTDIR=.." "$(tail -n 3 "$here/log")"
equal "what is left" "$(find "$prefix" "$here/stage" ! -type d 2>/dev/null | wc -l) files, $(find "$prefix" "$here/stage" -mindepth 1 ! -path "$here/stage/opt" ! -path "$here/stage/opt/rig" 2>/dev/null | wc -l) folders" "0 files, 0 folders"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
