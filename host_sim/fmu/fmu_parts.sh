#!/bin/sh
# fmu_parts.sh BUILD BINARY PLATFORM SOURCES.. - by the Makefile, with FLAGS, DEFINITIONS and the lists of dependencies in DEPENDENCIES:
# what every FMU has, in BUILD/fmu as it lies in the FMU: the binary, the sources with buildDescription.xml, the licence; and a
# list of it all.
set -eu
folder=$1/fmu
binary=$2
platform=$3
shift 3
rm -rf "$folder"
mkdir -p "$folder/binaries/$platform" "$folder/sources" "$folder/documentation/licenses"
cp "$binary" "$folder/binaries/$platform/contactplant.so"
cp LICENSE "$folder/documentation/licenses/license.txt"
# The sources and every header that the compiler has read for them.
cp --parents $(cat $DEPENDENCIES | tr ' \\' '\n\n' | grep -E '^[^/].*\.[ch]$' | sort -u) "$folder/sources"
{
    echo '<?xml version="1.0" encoding="UTF-8"?>'
    echo '<fmiBuildDescription fmiVersion="3.0">'
    echo '  <BuildConfiguration modelIdentifier="contactplant" description="C99 and its library, nothing else">'
    echo "    <SourceFileSet language=\"C99\" compiler=\"gcc\" compilerOptions=\"$FLAGS\">"
    for source; do echo "      <SourceFile name=\"$source\"/>"; done
    for name in $DEFINITIONS; do echo "      <PreprocessorDefinition name=\"$name\"/>"; done
    echo '      <IncludeDirectory name="."/>'
    echo '    </SourceFileSet>'
    echo '    <Library name="m" external="true"/>'
    echo '  </BuildConfiguration>'
    echo '</fmiBuildDescription>'
} >"$folder/sources/buildDescription.xml"
(cd "$folder" && find . -type f | sed "s|^./||" | LC_ALL=C sort) >"$folder.files"
mv "$folder.files" "$folder/files"
