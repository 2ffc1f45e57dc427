#!/usr/bin/env python3
"""test_gwyddion.py CONTACTPLANT - every field that `scan` writes, opened by Gwyddion: its batch mode reads the files, and its
libraries give the statistics. They stand beside a reader of this file, the command's own line, and the list of curves.
Gwyddion has no command that prints statistics, and Debian has no pygwy. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import csv
import ctypes
import math
import os
import re
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1])
swing = "peak_force=5nN ticks=2 quality=20 surface=2 map=2 map_modulus=0.5GPa lines=8 pixels=32 pixel=2ms".split()
tone = "surface=2 lines=8 pixels=32 pll=1".split()
TONE, SWING = ["amplitude", "error", "frequency", "height", "peak_force", "phase"], [
    "adhesion", "deformation", "dissipation", "height", "modulus", "peak_force", "peak_force_error"]


def library(name):
    return ctypes.CDLL(name, mode=ctypes.RTLD_GLOBAL)


glib, gwy, process = library("libglib-2.0.so.0"), library("libgwyddion2.so.0"), library("libgwyprocess2.so.0")
pointer = ctypes.c_void_p
process.gwy_process_type_init()
gwy.gwy_serializable_deserialize.restype = gwy.gwy_container_get_object.restype = pointer
gwy.gwy_container_get_string.restype = ctypes.c_char_p


def fields_of(path):
    """Title: least, largest, mean, rms about the mean and number of the known values, of each field of a .gwy file."""
    with open(path, "rb") as f:
        data = f.read()[4:]
    all_of_it = pointer(gwy.gwy_serializable_deserialize(data, ctypes.c_size_t(len(data)), ctypes.byref(ctypes.c_size_t(0))))
    found = {}
    for i in range(100):
        field, title, mask = (glib.g_quark_from_string(b"/%d/%s" % (i, what)) for what in (b"data", b"data/title", b"mask"))
        if gwy.gwy_container_contains(all_of_it, field):
            found[gwy.gwy_container_get_string(all_of_it, title).decode()] = statistics_of(
                pointer(gwy.gwy_container_get_object(all_of_it, field)),
                pointer(gwy.gwy_container_get_object(all_of_it, mask) if gwy.gwy_container_contains(all_of_it, mask) else None))
    return found


def statistics_of(field, mask):
    """What is not known has Gwyddion's mask."""
    value = [ctypes.c_double() for _ in range(7)]
    at = [ctypes.byref(v) for v in value]
    nx, ny = process.gwy_data_field_get_xres(field), process.gwy_data_field_get_yres(field)
    process.gwy_data_field_area_get_min_max_mask(field, mask, 0, 0, 0, nx, ny, at[0], at[1])
    process.gwy_data_field_area_get_stats_mask(field, mask, 0, 0, 0, nx, ny, at[2], at[3], at[4], None, None)
    process.gwy_data_field_get_sum.restype = ctypes.c_double
    hidden = process.gwy_data_field_get_sum(mask) if mask else 0.0
    return [value[i].value for i in (0, 1, 2, 4)] + [nx * ny - hidden]


def read(path):
    """Title and values."""
    with open(path, "rb") as f:
        data = f.read()
    header = data[:data.index(b"\0")].decode() if b"\0" in data else ""
    begin = len(header) + 4 - len(header) % 4
    size = (len(data) - begin) // 4
    return re.search(r"Title = (.*)", header).group(1), struct.unpack("<%df" % size, data[begin:])


def own_statistics(values):
    known = [v for v in values if not math.isnan(v)]
    mean = math.fsum(known) / len(known)
    return [min(known), max(known), mean, math.sqrt(math.fsum((v - mean) ** 2 for v in known) / len(known)), len(known)]


def check(name, numbers, wanted, *more):
    out = os.path.join(directory, name)
    options = [x for n in numbers for x in ("--set", n)]
    r = subprocess.run([program, "scan", *options, "--out", out, *more], capture_output=True, text=True)
    files = sorted(f for f in os.listdir(out) if f.endswith(".gsf"))
    verdict("%s: scan writes %d fields, both ways" % (name, len(wanted)), r.returncode == 0 and files == sorted(
        w + way + ".gsf" for w in wanted for way in ("", "_back")), r.stderr + " ".join(files))
    whole = out + ".gwy"
    c = subprocess.run(["gwyddion", "--convert-to-gwy=" + whole] + [os.path.join(out, f) for f in files], capture_output=True, text=True)
    verdict("%s: Gwyddion merges them" % name, c.returncode == 0 and not c.stderr, c.stderr)
    theirs, ours = fields_of(whole), {}
    for f in files:
        title, values = read(os.path.join(out, f))
        ours[f[:-4]] = values
        a, b = theirs.get(title, [math.nan] * 5), own_statistics(values)
        verdict("%s, %s: least %.6g, largest %.6g, mean %.6g, rms %.6g of %d known values in Gwyddion" % (name, title, *a),
                a[:2] == b[:2] and a[4] == b[4] and all(abs(x - y) <= 1e-9 * max(abs(b[0]), abs(b[1])) for x, y in zip(a[2:4], b[2:4])), b)
    return r.stdout, theirs, ours


def both(theirs, title):
    return theirs[title], theirs[title + " (retrace)"]


def printed(pattern, text):
    return float(re.search(pattern, text).group(1))


def check_line(name, said, theirs, error):
    """The command's own line has three digits."""
    largest = max(f[1] for f in both(theirs, "Peak force")) * 1e9
    square = sum((f[2] ** 2 + f[3] ** 2) * f[4] for f in both(theirs, error)) / sum(f[4] for f in both(theirs, error))
    for what, pattern, got in (("largest force, nN", r"largest force (\S+) nN", largest), ("error rms", r"error (\S+) n[Nm] rms", math.sqrt(square) * 1e9)):
        verdict("%s: the command says %s %g, Gwyddion %.6g" % (name, what, printed(pattern, said), got), abs(got / printed(pattern, said) - 1.0) < 6e-3)


with tempfile.TemporaryDirectory() as directory:
    said, theirs, _ = check("tone", tone, TONE)
    check_line("tone", said, theirs, "Error")
    curves = os.path.join(directory, "curves")
    said, theirs, ours = check("swing", swing, SWING, "--volume", curves, "--every", "4")
    check_line("swing", said, theirs, "Peak force error")
    unknown = 100.0 * (1.0 - sum(f[4] for f in both(theirs, "DMT modulus")) / 512.0)
    verdict("swing: the command says no modulus in %g %%, Gwyddion %.6g" % (printed(r"no modulus in (\S+) %", said), unknown),
            abs(printed(r"no modulus in (\S+) %", said) - unknown) < 0.051, said)
    with open(os.path.join(curves, "volume.csv")) as f:
        rows = list(csv.DictReader(f))
    apart = [(row["file"], key) for row in rows for key in row if key not in ("file", "x_m", "y_m") for line, pixel in [map(int, row["file"][6:-4].split("_"))]
             for value in [ours[key.rsplit("_", 1)[0]][32 * line + pixel]]
             if not (math.isnan(value) if row[key] == "" else abs(float(row[key]) - value) <= 1e-6 * abs(value))]
    verdict("volume.csv: %d curves of every fourth pixel have the values of the fields" % len(rows), len(rows) == 16 and not apart, apart)
conclude()
