#!/bin/sh
# clean_room.sh VERSION - inside a root of clean_root.py, with the tarball and the packages in /root: a user's first hour. One line a check.
version=$1
verdict() { # STATUS TEXT [WHY]
    if [ "$1" = 0 ]; then echo "ok    $2"; else echo "FAIL  $2${3:+: $3}"; fi
}
everything() { # all that stands here, but for what the loader, dpkg and man note down, and the user's own
    find / \( -path /proc -o -path /dev -o -path /tmp -o -path /root -o -path /var \) -prune -o -print | grep -v '^/etc/ld.so.cache' | LC_ALL=C sort
}
examples() { # HOW, FOLDER, COMPILER, C++ COMPILER: each one by both, shared and static, in a folder of the user's own
    rm -rf /tmp/mine
    mkdir /tmp/mine
    cp "$2"/*.[ch] /tmp/mine
    cd /tmp/mine || exit 1
    for source in *.c; do
        name=${source%.c}
        cp "$source" "$name.cpp"
        for compiler in "$3" "$4"; do
            case $compiler in *++) mine=$name.cpp ;; *) mine=$source ;; esac
            why=$($compiler -Wall -Wextra -Wpedantic -Werror "$mine" $(pkg-config --cflags --libs contactplant) -lm -o "$name.$compiler" 2>&1 &&
                $compiler -static "$mine" $(pkg-config --static --cflags --libs contactplant) -lm -o "$name.$compiler.static" 2>&1)
            verdict $? "$1: $name by $compiler, shared and static" "$why"
        done
    done
    for name in unit_test in_process; do
        ./$name.$3 >$name.out 2>&1
        verdict $? "$1: $name runs" "$(tail -n 2 $name.out)"
        same=0
        for program in $name.$3.static $name.$4 $name.$4.static; do
            ./$program 2>&1 | cmp -s - $name.out && same=$((same + 1))
        done
        [ $same = 3 ]
        verdict $? "$1: $name prints the same in each of four forms" "$((same + 1)) of 4"
    done
    man contactplant 2>/tmp/why | grep -q "SUBCOMMANDS"
    verdict $? "$1: man contactplant" "$(head -n 1 /tmp/why)"
    [ "$(contactplant --version | cut -d, -f1)" = "contactplant $version" ] && contactplant simulate rig --until 0.1 --every 0.1 >/dev/null 2>&1
    verdict $? "$1: contactplant runs"
    cd /root || exit 1
}

everything >/root/before
cd /root || exit 1
tar xzf "contactplant-$version.tar.gz" && cd "contactplant-$version" || exit 1
# Of the unit tests, whose code is that of the tree, those that read files, or write some, where they stand.
unit=$(echo tests/unit/main.c tests/unit/check.c tests/fixture/*.c tests/unit/library/*.c tests/unit/posix/test_log.c tests/unit/models/test_scenes.c)
for name in client identity replay scene_file; do unit="$unit tests/unit/host/test_$name.c"; done
why=$(make -s WERROR=-Werror UNIT_SRC="$unit" PAPER_SRC= all build/unit build/hash_print 2>&1 >/dev/null)
verdict $? "the tarball builds with make and gcc alone" "$why"
[ -z "$why" ]
verdict $? "without a warning" "$why"
build/hash_print | cmp -s - tests/data/hash.txt
verdict $? "its golden hashes are those of the tests"
build/unit --brief --jobs "$(nproc)" >/root/unit.out 2>&1
grep -q ' passed, 0 failed$' /root/unit.out
verdict $? "unit tests of library, scenes, clients and logs: $(tail -n 1 /root/unit.out)" "$(grep -m 3 FAIL /root/unit.out)"
why=$(make -s install 2>&1)
verdict $? "make install" "$why"
examples "make install" /usr/local/share/doc/contactplant/examples gcc g++
why=$(make -s -C "/root/contactplant-$version" uninstall 2>&1)
verdict $? "make uninstall" "$why"
everything | cmp -s /root/before -
verdict $? "nothing is left of it" "$(everything | diff /root/before - | head -n 3 | tr '\n' ' ')"

why=$(dpkg -i /root/*.deb 2>&1)
verdict $? "dpkg -i of the packages" "$why"
cp -r /usr/share/doc/libcontactplant-dev/examples /tmp
examples "packages" /tmp/examples clang clang++
why=$(dpkg -P contactplant libcontactplant-dev libcontactplant1 2>&1)
verdict $? "dpkg -P" "$why"
everything | cmp -s /root/before -
verdict $? "nothing is left of them" "$(everything | diff /root/before - | head -n 3 | tr '\n' ' ')"
