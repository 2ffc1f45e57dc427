#!/bin/sh
# clean_room.sh VERSION - inside a root of clean_root.py, with the tarball and the packages in /root: a user's first hour. One line a check.
version=$1
verdict() { # STATUS TEXT [WHY]
    if [ "$1" = 0 ]; then echo "ok    $2"; else echo "FAIL  $2${3:+: $3}"; fi
}
everything() { # all that stands here, but for what the loader, dpkg and man note down, and the user's own
    find / \( -path /proc -o -path /dev -o -path /tmp -o -path /root -o -path /var \) -prune -o -print | grep -v '^/etc/ld.so.cache' | LC_ALL=C sort
}
examples() { # HOW, FOLDER, COMPILER: each one, shared and static, in a folder of the user's own
    rm -rf /tmp/mine
    mkdir /tmp/mine
    cp "$2"/*.[ch] /tmp/mine
    cd /tmp/mine || exit 1
    for source in *.c; do
        name=${source%.c}
        case $3 in *++) mv "$source" "$name.cpp" && source=$name.cpp ;; esac
        why=$($3 -Wall -Wextra -Wpedantic -Werror "$source" $(pkg-config --cflags --libs contactplant) -lm -o "$name" 2>&1 &&
            $3 -static "$source" $(pkg-config --static --cflags --libs contactplant) -lm -o "$name.static" 2>&1)
        verdict $? "$1: $name by $3, shared and static" "$why"
    done
    for name in unit_test in_process; do
        ./$name >$name.out 2>&1
        verdict $? "$1: $name runs" "$(tail -n 2 $name.out)"
        ./$name.static 2>&1 | cmp -s - $name.out
        verdict $? "$1: $name prints the same when it is static"
    done
    man contactplant 2>/tmp/why | grep -q "SUBCOMMANDS"
    verdict $? "$1: man contactplant" "$(head -n 1 /tmp/why)"
    man contactplant-fmi 2>/tmp/why | grep -q "DESCRIPTION" && contactplant help fmi 2>/tmp/why | grep -q "^# "
    verdict $? "$1: man contactplant-fmi, contactplant help fmi" "$(head -n 1 /tmp/why)"
    [ "$(contactplant --version | cut -d, -f1)" = "contactplant $version" ] && contactplant simulate rig --until 0.1 --every 0.1 >/dev/null 2>&1
    verdict $? "$1: contactplant runs"
    cd /root || exit 1
}

everything >/root/before
cd /root || exit 1
tar xzf "contactplant-$version.tar.gz" && cd "contactplant-$version" || exit 1
# Of the unit tests, whose code is that of the tree, those that read files, or write some, where they stand.
unit=$(echo tests/unit/main.c tests/unit/check.c tests/fixture/*.c tests/unit/library/*.c tests/unit/posix/test_log.c tests/unit/models/test_scenes.c)
for name in live/test_client host/test_identity host/test_replay host/test_scene_file; do unit="$unit tests/unit/$name.c"; done
# Without optimisation: half the time, and a level of which the bits are asked, too.
why=$(make -s WERROR=-Werror OPT=-O0 UNIT_SRC="$unit" PAPER_SRC= all build/unit build/hash_print 2>&1 >/dev/null)
verdict $? "the tarball builds with make and gcc alone" "$why"
[ -z "$why" ]
verdict $? "without a warning" "$why"
build/hash_print | cmp -s - tests/data/hash.txt
verdict $? "its golden hashes, by gcc -O0, are those of the tests"
build/unit --brief --jobs "$(nproc)" >/root/unit.out 2>&1
grep -q ' passed, 0 failed$' /root/unit.out
verdict $? "unit tests of library, scenes, clients and logs: $(tail -n 1 /root/unit.out)" "$(grep -m 3 FAIL /root/unit.out)"
why=$(make -s OPT=-O0 install 2>&1)
verdict $? "make install" "$why"
examples "make install" /usr/local/share/doc/contactplant/examples gcc
why=$(make -s -C "/root/contactplant-$version" OPT=-O0 uninstall 2>&1)
verdict $? "make uninstall" "$why"
everything | cmp -s /root/before -
verdict $? "nothing is left of it" "$(everything | diff /root/before - | head -n 3 | tr '\n' ' ')"

why=$(dpkg -i /root/*.deb 2>&1)
verdict $? "dpkg -i of the packages" "$why"
cp -r /usr/share/doc/libcontactplant-dev/examples /tmp
examples "packages" /tmp/examples g++
why=$(dpkg -P contactplant libcontactplant-dev libcontactplant1 2>&1)
verdict $? "dpkg -P" "$why"
everything | cmp -s /root/before -
verdict $? "nothing is left of them" "$(everything | diff /root/before - | head -n 3 | tr '\n' ' ')"
