#!/bin/sh
# deb.sh BUILD - Debian packages of this build, by the Makefile with ABI, VERSION and POINTER: what make install installs, split into
# program, library and header. DEBFULLNAME and DEBEMAIL say who packs; without them it is nobody who can be written to.
set -eu
umask 022
build=$1
for tool in dpkg-deb dpkg-architecture dpkg-shlibdeps; do
    command -v $tool >/dev/null || { echo "make deb: $tool is missing; install dpkg-dev" >&2; exit 1; }
done
maintainer="${DEBFULLNAME:-contactplant authors} <${DEBEMAIL:-authors@contactplant.invalid}>"
libdir=/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
architecture=$(dpkg-architecture -qDEB_HOST_ARCH)
day=$(sed -n "s/^## $VERSION - //p" CHANGELOG.md)
SOURCE_DATE_EPOCH=$(date -u -d "$day" +%s)
export SOURCE_DATE_EPOCH
deb=$build/deb
program=$deb/debian/contactplant
library=$deb/debian/libcontactplant$ABI
header=$deb/debian/libcontactplant-dev
rm -rf "$deb"
mkdir -p "$program/DEBIAN" "$library/DEBIAN" "$header/DEBIAN"
PREFIX=/usr LIBDIR=$libdir DESTDIR=$program host_sim/library/install.sh install "$build"

move() { # FROM PACKAGE, from the program's
    mkdir -p "$2$(dirname "$1")"
    mv "$program$1" "$2$1"
}
move "$libdir/libcontactplant.so.$ABI" "$library"
move "$libdir/libcontactplant.so" "$header"
move "$libdir/libcontactplant.a" "$header"
move "$libdir/pkgconfig" "$header"
move "$libdir/cmake" "$header"
move /usr/include "$header"
move /usr/share/contactplant/python "$header"
mkdir -p "$header/usr/share/doc/libcontactplant-dev"
cp -r "$program/usr/share/doc/contactplant/docs/examples" "$header/usr/share/doc/libcontactplant-dev/examples"
rmdir "$program$libdir" # usr/lib keeps what an FMU is made of
rm "$program/usr/share/doc/contactplant/LICENSE" "$program/usr/share/doc/contactplant/CHANGELOG.md"
gzip -9n "$program"/usr/share/man/man[17]/*
mkdir -p "$program/usr/share/doc-base"
cat >"$program/usr/share/doc-base/contactplant" <<'EOF'
Document: contactplant
Title: contactplant: guides, reference, reasons
Author: contactplant authors
Abstract: How to put a plant in the place of a vibrating rig, what each message
 and number means, and why it is built that way.
Section: Science/Engineering

Format: text
Files: /usr/share/doc/contactplant/README.md /usr/share/doc/contactplant/docs/*/*.md
EOF
strip --strip-unneeded -R .comment -R .note "$program"/usr/lib/contactplant/fmu/binaries/*/*.so 2>/dev/null || true
strip --strip-unneeded -R .comment -R .note "$program/usr/bin/contactplant" "$library$libdir/libcontactplant.so.$ABI"
strip --strip-debug -R .comment -R .note "$header$libdir/libcontactplant.a"

# dpkg-shlibdeps reads the packages from here.
printf 'Source: contactplant\n\nPackage: contactplant\nArchitecture: any\n' >"$deb/debian/control"
needs() { # FILE: the packages of the libraries that it links
    (cd "$deb" && dpkg-shlibdeps -O "${1#"$deb"/}") | sed -n 's/^shlibs:Depends=//p'
}

pack() { # ROOT SECTION DEPENDS TITLE, and the description
    name=${1##*/}
    doc=$1/usr/share/doc/$name
    mkdir -p "$doc"
    gzip -9nc CHANGELOG.md >"$doc/changelog.gz"
    printf 'contactplant (%s-1) unstable; urgency=medium\n\n  * Version %s.\n\n -- %s  %s\n' "$VERSION" "$VERSION" \
        "$maintainer" "$(LC_ALL=C date -u -R -d "$day")" | gzip -9nc >"$doc/changelog.Debian.gz"
    cp LICENSE "$doc/copyright"
    {
        printf 'Package: %s\nVersion: %s-1\nArchitecture: %s\n' "$name" "$VERSION" "$architecture"
        printf 'Maintainer: %s\nInstalled-Size: %s\n' "$maintainer" "$(du -sk "$1/usr" | cut -f 1)"
        printf 'Depends: %s\nSection: %s\nPriority: optional\nDescription: %s\n' "$3" "$2" "$4"
        sed 's/^/ /'
    } >"$1/DEBIAN/control"
    (cd "$1" && find usr -type f | LC_ALL=C sort | xargs md5sum) >"$1/DEBIAN/md5sums"
    chmod 644 "$1/DEBIAN/"*
    dpkg-deb --root-owner-group --build "$1" "$deb" >/dev/null
    echo "$deb/${name}_$VERSION-1_$architecture.deb"
}

pack "$program" science "$(needs "$program/usr/bin/contactplant")" "real-time plant for controllers under test" <<'EOF'
This program takes the place of a vibrating test rig. It computes in real
time how mechanical contacts make and break, and speaks with a controller
over CAN or UDP. It also finds response curves, basins of attraction and the
cheapest model that will do.
EOF
echo "libcontactplant $ABI libcontactplant$ABI (>= $VERSION)" >"$library/DEBIAN/shlibs"
echo "activate-noawait ldconfig" >"$library/DEBIAN/triggers"
pack "$library" libs "$(needs "$library$libdir/libcontactplant.so.$ABI")" "real-time plant as a library" <<'EOF'
Programs with libcontactplant run a mechanical plant whose contact makes and
breaks: alone, on a bus in memory, or as the controller at its other end.
All state is in memory of the caller.
EOF
pack "$header" libdevel "libcontactplant$ABI (= $VERSION-1)" "real-time plant as a library: header and examples" <<'EOF'
contactplant.h, the library to link statically, the flags for pkg-config and
CMake, contactplant.py for Python, and examples of a page each: a unit test,
a controller, both ends in one program, and a test suite in Python.
EOF
