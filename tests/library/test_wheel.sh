#!/bin/bash
# test_wheel.sh BUILD - the wheel of make wheel, by pip into a virtual environment without a network: its tag, import, a run, other
# libraries on the way, uninstalled. One line a check, then `N passed, N failed`.
set -u
build=$1
unset MAKEFLAGS MFLAGS MAKELEVEL LD_LIBRARY_PATH PYTHONPATH CONTACTPLANT_LIBRARY
export PIP_NO_INDEX=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1
here=$(mktemp -d) || exit 1
trap 'rm -rf "$here"' EXIT
trap 'exit 1' INT TERM
. "$(dirname "$0")/../house/verdict.sh"

wheel=$(make -s BUILD="$build" wheel 2>"$here/log")
verdict $? "make wheel: $wheel" "$(tail -n 1 "$here/log")"
sum=$(sha256sum <"$wheel")
make -s BUILD="$build" wheel >"$here/log" 2>&1
equal "a second time: bytes" "$(sha256sum <"$wheel")" "$sum"
/usr/bin/python3 -m zipfile -t "$wheel" >"$here/log" 2>&1
verdict $? "the archive" "$(cat "$here/log")"
/usr/bin/python3 -m venv "$here/my env" >"$here/log" 2>&1
verdict $? "python3 -m venv" "$(tail -n 1 "$here/log")"
python="$here/my env/bin/python"
"$python" -m pip install "$wheel" >"$here/log" 2>&1
verdict $? "pip install takes it" "$(grep -m 1 ERROR "$here/log")"
"$python" -m pip check >"$here/log" 2>&1
verdict $? "pip check" "$(tail -n 1 "$here/log")"
version=$(sed -n 's/^#define CONTACTPLANT_VERSION *"\(.*\)"/\1/p' host_sim/library/contactplant.h)
equal "its version by pip" "$("$python" -m pip show contactplant 2>/dev/null | sed -n 's/^Version: //p')" "$version"

echo "--- its tag"
tag=${wheel##*-}
tag=${tag%.whl}
installed=$(ls "$here/my env"/lib/python3*/site-packages/contactplant.libs/libcontactplant.so.*)
newest=$(readelf -W -V "$installed" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
needs=$(readelf -W -d "$installed" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | sort | tr '\n' ' ')
equal "libraries that it needs" "$needs" "libc.so.6 libm.so.6 "
[[ $tag == manylinux_2_*_$(uname -m) ]] && minor=${tag#manylinux_2_} && minor=${minor%%_*} && [ "$minor" -ge "${newest#GLIBC_2.}" ]
verdict $? "tag $tag: the newest symbol is $newest" "not so"
for flag in -march=native -mavx2; do
    other=$(/usr/bin/python3 host_sim/python/wheel.py "$build" gcc -O2 $flag)
    [[ $other == *-linux_$(uname -m).whl ]]
    verdict $? "built by $flag: ${other##*/}" "not for linux alone"
done
make -s BUILD="$build" wheel >"$here/log" 2>&1

echo "--- a run, outside of the tree"
cat >"$here/run.py" <<'END'
import contactplant
rig = contactplant.Plant("hertz_rig")
rig.drive("force", 3.0, 225.0, ramp_s=0.1)
rig.advance_to(0.5)
print(f"{rig.hash:016x}", rig.counter("switches"), contactplant.library().path)
END
said=$(cd "$here" && "$python" run.py 2>&1)
equal "the library that it loads" "$(echo "$said" | cut -d' ' -f3-)" "$installed"
wanted=$(PYTHONPATH=host_sim/python CONTACTPLANT_LIBRARY=$build/libcontactplant.so /usr/bin/python3 "$here/run.py" | cut -d' ' -f1,2)
equal "hash and switches, as from the build" "$(echo "$said" | cut -d' ' -f1,2)" "$wanted"
cp "$installed" "$here/my env/lib/" && printf 'no library' >"$here/my env/lib/${installed##*/}"
equal "with another library in the environment's lib" "$(cd "$here" && "$python" run.py 2>&1)" "$said"
rm "$here/my env/lib/${installed##*/}"
"$python" -m pip uninstall -y contactplant >"$here/log" 2>&1
equal "what pip uninstall leaves" "$(find "$here/my env" -iname '*contactplant*' | wc -l)" 0

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
