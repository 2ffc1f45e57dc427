#!/bin/bash
# test_cmake.sh BUILD - find_package(contactplant) by projects in folders of their own: shared and static, in a tree that was moved, with
# blanks, versions that fit and that do not, a processor without an operating system. One line a check, then `N passed, N failed`.
set -u
build=$(realpath "$1")
unset MAKEFLAGS MFLAGS MAKELEVEL CMAKE_PREFIX_PATH CMAKE_GENERATOR
here=$(mktemp -d) || exit 1
tree=$PWD
trap 'rm -rf "$here"' EXIT
trap 'exit 1' INT TERM
. "$(dirname "$0")/../house/verdict.sh"

project() { # FOLDER FIND_PACKAGE'S ARGUMENTS: one that builds two examples, each against both libraries
    mkdir -p "$1"
    cp "$tree"/docs/examples/unit_test.c "$tree"/docs/examples/in_process.c "$1"
    cat >"$1/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.10)
project(mine LANGUAGES C CXX)
find_package(contactplant $2)
find_package(contactplant $2) # a second time, as a project's parts do
foreach(name unit_test in_process)
    add_executable(\${name}_shared \${name}.c)
    target_link_libraries(\${name}_shared contactplant::contactplant)
    add_executable(\${name}_static \${name}.c)
    target_link_libraries(\${name}_static contactplant::static)
endforeach()
END
}
configure() { # FOLDER CMAKE'S ARGUMENTS..: its status; what it says in $here/log
    local folder=$1
    shift
    cmake -S "$folder" -B "$folder/build" "$@" >"$here/log" 2>&1
}
why() { # what CMake said
    grep -A 3 -m 1 -E 'CMake Error|error:' "$here/log" | tr '\n' ' '
}

lib=lib/$(gcc -print-multiarch) # as Debian has it
echo "--- shared and static, in a tree that was moved"
make -s BUILD="$build" PREFIX=/opt/rig LIBDIR=/opt/rig/$lib DESTDIR="$here/stage" install >"$here/log" 2>&1
verdict $? "make install DESTDIR=.." "$(tail -n 3 "$here/log")"
equal "names of the build in the installed files" "$(grep -rlE "$here|$tree|/opt/rig" "$here/stage/opt/rig/$lib/cmake" | wc -l)" 0
moved="$here/my plant & co"
mv "$here/stage/opt/rig" "$moved"
project "$here/a project" "0.9 REQUIRED"
configure "$here/a project" -DCMAKE_PREFIX_PATH="$moved"
verdict $? "find_package(contactplant 0.9 REQUIRED) in a prefix with blanks" "$(why)"
why=$(cmake --build "$here/a project/build" 2>&1)
verdict $? "cmake --build" "$(echo "$why" | grep -m 1 -i error)"
for name in unit_test in_process; do
    for kind in shared static; do
        "$here/a project/build/${name}_$kind" >"$here/$name.$kind" 2>&1
        verdict $? "$name, $kind, runs without LD_LIBRARY_PATH" "$(tail -n 1 "$here/$name.$kind")"
    done
    cmp -s "$here/$name.shared" "$here/$name.static"
    verdict $? "$name says the same"
done
loaded() { # PROGRAM: the contactplant that it loads
    ldd "$here/a project/build/$1" | sed -n 's|.*libcontactplant.* => \(.*\) (0x.*|\1|p'
}
equal "the shared one loads" "$(loaded unit_test_shared)" "$moved/$lib/libcontactplant.so.1"
equal "the static one loads" "$(loaded unit_test_static)" ""
grep -q -- "-ffp-contract=off" "$here/a project/build/CMakeFiles/unit_test_static.dir/flags.make"
verdict $? "with the flag that the bits need"

echo "--- versions"
find_version() { # VERSION WHETHER IT FITS
    rm -rf "$here/v"
    mkdir "$here/v"
    printf 'cmake_minimum_required(VERSION 3.10)\nproject(v LANGUAGES C)\nfind_package(contactplant %s REQUIRED)\n' "$1" >"$here/v/CMakeLists.txt"
    configure "$here/v" -DCMAKE_PREFIX_PATH="$moved" && got=taken || got=refused
    equal "version $1" "$got" "$2"
}
version=$(sed -n 's/^#define CONTACTPLANT_VERSION *"\(.*\)"/\1/p' host_sim/library/contactplant.h)
series=${version%.*}
find_version "" taken
find_version "${version%%.*}" taken
find_version "$series" taken
find_version "$version EXACT" taken
find_version "$series.99" refused
find_version "${version%%.*}.$((${series#*.} - 1))" refused
find_version "$((${version%%.*} + 1))" refused
grep -q "version: $version" "$here/log"
verdict $? "a refusal names the version that is there" "$(why)"

echo "--- what is not there"
mkdir "$here/part"
cp -r "$moved/lib" "$moved/include" "$here/part"
rm "$here/part/$lib/libcontactplant.a"
rm -rf "$here/a project/build"
! configure "$here/a project" -DCMAKE_PREFIX_PATH="$here/part" && grep -q "has no libcontactplant.a" "$here/log"
verdict $? "without libcontactplant.a find_package says so" "$(why)"

echo "--- the build folder, and a processor without an operating system"
configure "$here/a project" -Dcontactplant_DIR="$build"
verdict $? "contactplant_DIR=build needs no installation" "$(why)"
m7="-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard"
make -s BUILD="$here/m7" CROSS=arm-none-eabi- LIB_FLAGS="$m7" lib >"$here/log" 2>&1
verdict $? "make lib CROSS=arm-none-eabi-" "$(grep -m 1 error "$here/log")"
mkdir "$here/firmware"
cat >"$here/firmware/cortex-m7.cmake" <<END
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_C_FLAGS_INIT "$m7")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
END
cat >"$here/firmware/main.c" <<'END'
#include <contactplant.h>
unsigned begin(void);
unsigned begin(void) { return (unsigned)contactplant_abi(); }
END
cat >"$here/firmware/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.13)
project(firmware LANGUAGES C)
find_package(contactplant 0.9 REQUIRED)
add_executable(firmware.elf main.c)
target_link_libraries(firmware.elf contactplant::static)
target_link_options(firmware.elf PRIVATE -nostdlib -Wl,--gc-sections -Wl,-e,begin)
if(TARGET contactplant::contactplant)
    message(FATAL_ERROR "there is no shared library for firmware")
endif()
END
configure "$here/firmware" -DCMAKE_TOOLCHAIN_FILE="$here/firmware/cortex-m7.cmake" -Dcontactplant_DIR="$here/m7/lib-arm-none-eabi"
verdict $? "firmware by a cross file" "$(why)"
why=$(cmake --build "$here/firmware/build" 2>&1)
verdict $? "firmware.elf is linked" "$(echo "$why" | grep -m 1 -iE 'error|undefined')"
arm-none-eabi-nm "$here/firmware/build/firmware.elf" 2>&1 | grep -q " T contactplant_abi"
verdict $? "with the library's code"
rm -rf "$here/a project/build"
! configure "$here/a project" -Dcontactplant_DIR="$here/m7/lib-arm-none-eabi" && grep -q "pointers of 4 bytes" "$here/log"
verdict $? "the library of another processor is refused by its pointers" "$(why)"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
