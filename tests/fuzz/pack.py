#!/usr/bin/env python3
"""A fuzz corpus as one file: an input a line, in hexadecimal, short ones first.
usage: pack.py pack FOLDER FILE      writes the inputs of a folder to the file
       pack.py unpack FILE FOLDER    writes each input to a file of its own, named by its SHA-1 as libFuzzer does"""
import hashlib
import pathlib
import sys


def pack(folder, packed):
    inputs = {path.read_bytes() for path in folder.iterdir()}
    packed.write_text("".join(data.hex() + "\n" for data in sorted(inputs, key=lambda data: (len(data), data))))


def unpack(packed, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for line in packed.read_text().splitlines():
        data = bytes.fromhex(line)
        (folder / hashlib.sha1(data).hexdigest()).write_bytes(data)


if len(sys.argv) != 4 or sys.argv[1] not in ("pack", "unpack"):
    sys.exit(__doc__)
{"pack": pack, "unpack": unpack}[sys.argv[1]](pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]))
