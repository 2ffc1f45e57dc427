#!/bin/sh
# install.sh install|uninstall BUILD - by the Makefile, with PREFIX, LIBDIR, DESTDIR, ABI, VERSION and POINTER. One list for both: what is
# installed is what is removed, and then the folders that are nobody else's.
set -eu
action=$1
build=$2
share=$PREFIX/share
doc=$share/doc/contactplant
cmake=$LIBDIR/cmake/contactplant

put() { # MODE FOLDER FILE..
    mode=$1
    folder=$DESTDIR$2
    shift 2
    case $action in
    install) install -D -m "$mode" -t "$folder" "$@" ;;
    uninstall) [ ! -d "$folder" ] || basename -a "$@" | (cd "$folder" && xargs rm -f) ;;
    esac
}
link() { # TARGET PLACE
    case $action in
    install) ln -sf "$1" "$DESTDIR$2" ;;
    uninstall) rm -f "$DESTDIR$2" ;;
    esac
}

scenes() {
    for list in scenes papers; do "$build/contactplant" list $list; done | sed -n 's/^    \([^ ]*\) .*/\1/p'
}

plain() { # TEXT, for the right side of a sed command
    printf '%s' "$1" | sed 's/[\\&|]/\\&/g'
}

# What the program prints of itself.
prints=$build/share
if [ "$action" = install ]; then
    rm -rf "$prints"
    mkdir -p "$prints/scenes" "$prints/completions"
    "$build/contactplant" completion >"$prints/completions/contactplant"
    "$build/contactplant" dbc >"$prints/contactplant.dbc"
    for scene in $(scenes); do
        "$build/contactplant" scene "$scene" >"$prints/scenes/$scene.ini" 2>"$prints/warnings"
    done
    sed -e "s|@PREFIX@|$(plain "$PREFIX")|" -e "s|@LIBDIR@|$(plain "$LIBDIR")|" -e "s|@VERSION@|$VERSION|" host_sim/library/contactplant.pc.in \
        >"$prints/contactplant.pc"
    host_sim/library/cmake.sh "$prints/cmake" "$cmake" "$LIBDIR" "$PREFIX/include"
fi

put 755 "$PREFIX/bin" "$build/contactplant"
put 644 "$LIBDIR" "$build/libcontactplant.a" "$build/libcontactplant.so.$ABI"
link "libcontactplant.so.$ABI" "$LIBDIR/libcontactplant.so"
put 644 "$LIBDIR/pkgconfig" "$prints/contactplant.pc"
put 644 "$cmake" "$prints/cmake/contactplant-config.cmake" "$prints/cmake/contactplant-config-version.cmake"
put 644 "$PREFIX/include" host_sim/library/contactplant.h
put 644 "$share/bash-completion/completions" "$prints/completions/contactplant"
put 644 "$share/contactplant" "$prints/contactplant.dbc"
put 644 "$share/contactplant/scenes" $(scenes | sed "s|.*|$prints/scenes/&.ini|")
put 644 "$share/contactplant/python" host_sim/python/contactplant.py
fmu=$PREFIX/lib/contactplant/fmu
put 644 "$fmu" "$build/fmu/files"
sed 's|/[^/]*$||' "$build/fmu/files" | sort -u | while read -r room; do
    put 644 "$fmu/$room" $(grep -x "$room/[^/]*" "$build/fmu/files" | sed "s|^|$build/fmu/|")
done
# The pages lie as in the source: what README, the pages and --help name is there.
put 644 "$doc" README.md CHANGELOG.md CONTRIBUTING.md LICENSE
pages=$(find docs -type d)
for folder in $pages; do
    put 644 "$doc/$folder" $(find "$folder" -maxdepth 1 -type f)
done
linked=$(grep -ohE '\]\((\.\./\.\./)?(hal|host_sim|tests)/[A-Za-z0-9_/.-]*' README.md $(find docs -name '*.md') | sed 's|^](||; s|^\.\./\.\./||' | sort -u)
for file in $linked; do
    put 644 "$doc/${file%/*}" "$file"
done
link docs/examples "$doc/examples"

# Manual pages: of the subcommands, and of each guide by the program that is installed now, beside its pages.
day=$(sed -n "s/^## $VERSION - //p" CHANGELOG.md)
guides=$(basename -s .md docs/guide/*.md)
if [ "$action" = install ]; then
    mkdir -p "$prints/man"
    "$build/contactplant" man | sed "1s/\"\"/\"$day\"/" >"$prints/man/contactplant.1"
    for guide in $guides; do
        "$DESTDIR$PREFIX/bin/contactplant" man "guide/$guide" | sed "1s/\"\"/\"$day\"/" >"$prints/man/contactplant-$guide.7"
        [ -s "$prints/man/contactplant-$guide.7" ]
    done
fi
put 644 "$share/man/man1" "$prints/man/contactplant.1"
put 644 "$share/man/man7" $(echo "$guides" | sed "s|.*|$prints/man/contactplant-&.7|")

# The loader's list of libraries: a program that links this one finds it, or a line says how it will.
if [ -z "$DESTDIR" ]; then
    PATH=$PATH:/usr/sbin:/sbin
    known() { ldconfig -p 2>/dev/null | grep -q "=> $LIBDIR/libcontactplant.so.$ABI\$"; }
    ldconfig 2>/dev/null || true
    [ "$action" = uninstall ] || known || echo "the loader does not look into $LIBDIR: run programs with LD_LIBRARY_PATH='$LIBDIR'"
fi

case $action$PREFIX in
install*[[:space:]]*) echo 'PREFIX has a blank: compile with eval "cc my.c $(pkg-config --cflags --libs contactplant)"' ;;
esac

# Empty now, and nobody else's: folders from the inside out; those above PREFIX are not ours.
if [ "$action" = uninstall ]; then
    [ ! -d "$DESTDIR$PREFIX/lib/contactplant" ] || find "$DESTDIR$PREFIX/lib/contactplant" -depth -type d -empty -delete
    rm -f "$DESTDIR$share/contactplant/python/__pycache__/contactplant."*.pyc
    for folder in "$share/contactplant/python/__pycache__" "$share/contactplant/python" "$share/contactplant/scenes" \
        "$share/contactplant" $(echo "$pages" | LC_ALL=C sort -r | sed "s|^|$doc/|") $(echo "$linked" | sed "s|/[^/]*$||; p; s|/.*||" | LC_ALL=C sort -ru | sed "s|^|$doc/|") "$doc" "$LIBDIR/pkgconfig" "$cmake" "$LIBDIR/cmake" "$LIBDIR" \
        "$share/man/man1" "$share/man/man7" "$share/man" "$share/bash-completion/completions" "$share/bash-completion" "$share/doc" "$share" \
        "$PREFIX/lib" "$PREFIX/bin" "$PREFIX/include"; do
        rmdir "$DESTDIR$folder" 2>/dev/null || true
    done
fi
