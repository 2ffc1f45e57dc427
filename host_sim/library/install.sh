#!/bin/sh
# install.sh install|uninstall BUILD - by the Makefile, with PREFIX, LIBDIR, DESTDIR, ABI and VERSION. One list for both: what is
# installed is what is removed, and then the folders that are nobody else's.
set -eu
action=$1
build=$2
share=$PREFIX/share
doc=$share/doc/contactplant

put() { # MODE FILE PLACE
    case $action in
    install) install -D -m "$1" "$2" "$DESTDIR$3" ;;
    uninstall) rm -f "$DESTDIR$3" ;;
    esac
}
link() { # TARGET PLACE
    case $action in
    install) ln -sf "$1" "$DESTDIR$2" ;;
    uninstall) rm -f "$DESTDIR$2" ;;
    esac
}

# What the program prints of itself.
prints=$build/share
if [ "$action" = install ]; then
    rm -rf "$prints"
    mkdir -p "$prints/scenes"
    "$build/contactplant" man >"$prints/contactplant.1"
    "$build/contactplant" completion >"$prints/completion"
    "$build/contactplant" dbc >"$prints/contactplant.dbc"
    for scene in $("$build/contactplant" list scenes | awk 'NR > 1 {print $1}'); do
        "$build/contactplant" scene "$scene" >"$prints/scenes/$scene.ini" 2>"$prints/warnings"
    done
    sed -e "s|@PREFIX@|$PREFIX|" -e "s|@LIBDIR@|$LIBDIR|" -e "s|@VERSION@|$VERSION|" host_sim/library/contactplant.pc.in \
        >"$prints/contactplant.pc"
fi

put 755 "$build/contactplant" "$PREFIX/bin/contactplant"
put 644 "$build/libcontactplant.a" "$LIBDIR/libcontactplant.a"
put 644 "$build/libcontactplant.so.$ABI" "$LIBDIR/libcontactplant.so.$ABI"
link "libcontactplant.so.$ABI" "$LIBDIR/libcontactplant.so"
put 644 "$prints/contactplant.pc" "$LIBDIR/pkgconfig/contactplant.pc"
put 644 host_sim/library/contactplant.h "$PREFIX/include/contactplant.h"
put 644 "$prints/contactplant.1" "$share/man/man1/contactplant.1"
put 644 "$prints/completion" "$share/bash-completion/completions/contactplant"
put 644 "$prints/contactplant.dbc" "$share/contactplant/contactplant.dbc"
for scene in $("$build/contactplant" list scenes | awk 'NR > 1 {print $1}'); do
    put 644 "$prints/scenes/$scene.ini" "$share/contactplant/scenes/$scene.ini"
done
put 644 host_sim/python/contactplant.py "$share/contactplant/python/contactplant.py"
for part in files $(cat "$build/fmu/files"); do put 644 "$build/fmu/$part" "$PREFIX/lib/contactplant/fmu/$part"; done
for text in README.md CHANGELOG.md LICENSE; do put 644 $text "$doc/$text"; done
for example in docs/examples/*.[ch] docs/examples/*.py docs/examples/*.test; do put 644 "$example" "$doc/examples/${example##*/}"; done

# The loader's list of libraries: a program that links this one finds it, or a line says how it will.
if [ -z "$DESTDIR" ]; then
    PATH=$PATH:/usr/sbin:/sbin
    known() { ldconfig -p 2>/dev/null | grep -q "=> $LIBDIR/libcontactplant.so.$ABI\$"; }
    ldconfig 2>/dev/null || true
    [ "$action" = uninstall ] || known || echo "the loader does not look into $LIBDIR: run programs with LD_LIBRARY_PATH=$LIBDIR"
fi

# Empty now, and nobody else's: folders from the inside out; those above PREFIX are not ours.
if [ "$action" = uninstall ]; then
    [ ! -d "$DESTDIR$PREFIX/lib/contactplant" ] || find "$DESTDIR$PREFIX/lib/contactplant" -depth -type d -empty -delete
    rm -f "$DESTDIR$share/contactplant/python/__pycache__/contactplant."*.pyc
    for folder in "$share/contactplant/python/__pycache__" "$share/contactplant/python" "$share/contactplant/scenes" \
        "$share/contactplant" "$doc/examples" "$doc" "$LIBDIR/pkgconfig" "$LIBDIR" \
        "$share/man/man1" "$share/man" "$share/bash-completion/completions" "$share/bash-completion" "$share/doc" "$share" \
        "$PREFIX/lib" "$PREFIX/bin" "$PREFIX/include"; do
        rmdir "$DESTDIR$folder" 2>/dev/null || true
    done
fi
