#!/usr/bin/python3
"""An independent reader (canmatrix) decodes what the plant encodes, with nothing but the .dbc.

    test_dbc.py VECTORS_PROGRAM COMMITTED_DBC PAGE...

VECTORS_PROGRAM is build/dbc_vectors. The first page has frames to send; the others together hold the tables of the code
and no other row. Last line: `N passed, N failed`.
"""
import logging
import math
import re
import struct
import subprocess
import sys
import tempfile
import zlib

logging.disable(logging.CRITICAL)  # canmatrix names the formats it was built without
import canmatrix.formats  # noqa: E402

TELEMETRY = 0x10  # kinds from here on are sent by the plant
count = {True: 0, False: 0}


def check(name, good, detail=""):
    count[bool(good)] += 1
    print("%s  %s%s" % ("ok  " if good else "FAIL", name, ": " + detail if detail else ""))


def load(text):
    with tempfile.NamedTemporaryFile("w", suffix=".dbc") as f:
        f.write(text)
        f.flush()
        return canmatrix.formats.loadp_flat(f.name)


def same(got, expected):
    """A .dbc holds decimal scales: equal to a few units in the last place of a double."""
    if math.isnan(expected):
        return math.isnan(got)
    return math.isclose(float(got), expected, rel_tol=1e-14, abs_tol=0.0)


def check_vectors(scene, db, lines):
    """Every value of every frame, one line per message."""
    wrong, total, covered, cache = {}, {}, set(), {}
    for line in lines:
        ident, extended, data, message, signal, value = line.split()
        key = (ident, extended, data)
        if key not in cache:
            frame = db.frame_by_id(canmatrix.ArbitrationId(int(ident, 16), extended=extended == "1"))
            cache[key] = (frame.name, frame.decode(bytes.fromhex(data))) if frame else ("no such identifier", {})
        name, decoded = cache[key]
        total[message] = total.get(message, 0) + 1
        covered.add((message, signal))
        got = decoded[signal].phys_value if name == message and signal in decoded else None
        if got is None or not same(got, float(value)):
            wrong.setdefault(message, []).append("%s %s: %s, expected %s" % (data, signal, got, value))
    for message in total:
        bad = wrong.get(message, [])
        check("%s %s decodes to the values encoded" % (scene, message), not bad,
              "%d values%s" % (total[message], "".join("; " + b for b in bad[:3])))
    all_signals = {(f.name, s.name) for f in db.frames for s in f.signals} - \
                  {(f.name, n) for f in db.frames for n in ("CHECKSUM", "COUNTER")}
    check("%s every signal was tried" % scene, covered == all_signals,
          "%d of %d" % (len(covered & all_signals), len(all_signals)))


def bits_of(signal):
    return set(range(signal.start_bit, signal.start_bit + signal.size))


def overlap(frame):
    """Two signals that may be present together share a bit, or one leaves the frame."""
    for a in frame.signals:
        if max(bits_of(a)) > 63:
            return a.name
        for b in frame.signals:
            together = a.mux_val is None or b.mux_val is None or a.mux_val == b.mux_val
            if a is not b and together and bits_of(a) & bits_of(b):
                return a.name + " and " + b.name
    return ""


def check_structure(scene, db, text, base, extended):
    frames = db.frames
    kinds = [f.arbitration_id.id - base for f in frames]
    check("%s identifiers" % scene, len(set(kinds)) == len(kinds) and all(0 <= k < 64 for k in kinds)
          and all(f.arbitration_id.extended == extended for f in frames), "%d messages" % len(frames))
    check("%s bit 31 of identifiers" % scene,
          all((int(i) >> 31 == 1) == extended for i in re.findall(r"^BO_ (\d+)", text, re.M)))
    check("%s all messages have 8 bytes" % scene, all(f.size == 8 for f in frames))
    bad = [f.name + ": " + overlap(f) for f in frames if overlap(f)]
    check("%s no two signals overlap" % scene, not bad, ", ".join(bad))
    check("%s CHECKSUM and COUNTER" % scene, all(
        (f.signal_by_name("CHECKSUM").start_bit, f.signal_by_name("CHECKSUM").size) == (0, 8) and
        (f.signal_by_name("COUNTER").start_bit, f.signal_by_name("COUNTER").size) == (8, 4) and
        f.signal_by_name("COUNTER").max == 14 for f in frames))
    check("%s senders" % scene, all(
        f.transmitters == ["PLANT" if f.arbitration_id.id - base >= TELEMETRY else "CONTROLLER"] for f in frames))
    check("%s every message and signal has a comment" % scene,
          all(f.comment and all(s.comment for s in f.signals) for f in frames))
    names = [f.name for f in frames] + [s.name for f in frames for s in f.signals]
    check("%s names are plain and at most 32 characters" % scene,
          all(re.fullmatch("[A-Za-z_][A-Za-z0-9_]{0,31}", n) for n in names), "%d names" % len(names))
    check("%s signals of a message differ in more than case" % scene,
          all(len({s.name.lower() for s in f.signals}) == len(f.signals) for f in frames))
    floats = re.findall(r"^SIG_VALTYPE_ (\d+) (\w+) : 1;$", text, re.M)
    check("%s float32 signals" % scene,
          {(int(i) & 0x7FFFFFFF, n) for i, n in floats} ==
          {(f.arbitration_id.id, s.name) for f in frames for s in f.signals if s.is_float},
          "%d" % len(floats))
    check("%s little endian" % scene, all(s.is_little_endian for f in frames for s in f.signals))


def raw(db, name, data):
    return db.frame_by_name(name).decode(data)


def check_details(db, slow):
    """Properties that a user of the default rig's file counts on, from the protocol's description."""
    state = db.frame_by_name("STATUS").signal_by_name("STATE").values
    check("states by name", list(state.values()) ==
          ["off", "ready", "running", "paused", "stopped", "frozen", "fault"], str(list(state.values())))
    arm = db.frame_by_name("ARM_2").signal_by_name("amplitude")
    check("ARM_2.amplitude in m", arm.unit == "m" and arm.is_float and arm.mux_val == 0, arm.unit)
    mass = db.frame_by_name("PARAM_WRITE").signal_by_name("mass_kg")
    check("PARAM_WRITE.mass_kg is float32 in kg", mass.unit == "kg" and mass.is_float, mass.unit)
    unit = db.frame_by_name("MOTION").signal_by_name("VELOCITY").unit
    check("velocity unit without dilation", unit == "m/s", unit)
    unit = slow.frame_by_name("MOTION").signal_by_name("VELOCITY").unit
    check("velocity unit with dilation", unit == "m/s(bus)", unit)
    unit = slow.frame_by_name("ARM_0").signal_by_name("frequency").unit
    check("frequency unit with dilation", unit == "Hz(bus)", unit)
    unit = slow.frame_by_name("INFO").signal_by_name("f0_real_Hz").unit
    check("real f0 with dilation", unit == "Hz", unit)
    cycle = {f.name: f.cycle_time for f in db.frames}
    check("cycle times", (cycle["MOTION"], cycle["STATUS"], cycle["HASH"], cycle["FIRE"]) == (1, 10, 1000, 0),
          "%s ms" % [cycle[n] for n in ("MOTION", "STATUS", "HASH", "FIRE")])
    # bytes made here: STREAM_0, session 5, counter 3, frame 0x1234, sample -2.5
    stream = raw(db, "STREAM_0", bytes([0, 0x53]) + struct.pack("<Hf", 0x1234, -2.5))
    check("hand-made STREAM_0", [stream[n].raw_value for n in ("SESSION", "COUNTER", "FRAME", "SAMPLE")] ==
          [5, 3, 0x1234, -2.5])
    motion = raw(db, "MOTION", bytes([0, 0x10, 0, 0, 0x80, 0xFF, 0xFF, 0xFF]))
    names = db.frame_by_name("MOTION").signal_by_name("DISPLACEMENT").values
    check("not available has a name", names.get(motion["DISPLACEMENT"].raw_value) == "not_available", str(names))
    check("-1 is one unit below 0", motion["VELOCITY"].raw_value == -1)


def entry(index, value):
    return struct.pack("<Bf", index, value)


def check_identity(scene, db, frame_rate, substeps, dilation, settings):
    """The number that a file carries is the check of what the file itself says, by zlib."""
    lsb = [(db.frame_by_name(m).signal_by_name(s).factor) for m, s in
           (("MOTION", "DISPLACEMENT"), ("MOTION", "VELOCITY"), ("CONTACT", "PENETRATION"), ("CONTACT", "FORCE"))]
    version = float(open(sys.argv[2]).readline().split('"')[1])
    model = zlib.crc32(b"hertz_rig") & 0xFFFFFF
    part = {0: version, 1: frame_rate, 2: substeps, 4: dilation, 8: model, 13: settings}
    part.update({9 + i: float(x) for i, x in enumerate(lsb)})
    expected = zlib.crc32(b"".join(entry(i, part[i]) for i in sorted(part))) & 0xFFFFFF
    got = int(db.attribute("PlantIdentity"))
    check("%s PlantIdentity is the check of model, LSBs, dilation, rate, substeps and settings" % scene, got == expected,
          "%d" % got)
    check("%s INFO has the item" % scene, db.frame_by_name("INFO").signal_by_name("identity").is_float)


def settings_check(rows):
    """Of the defaults of settings 81 to 98, as docs/reference/settings.md lists them."""
    crc, n = 0, 0
    for index, default in re.findall(r"^\| (\d+) \| \w+ \| \w* \| \S+ \| \S+ \| (\S+) \|", "\n".join(rows), re.M):
        if 81 <= int(index) <= 98:
            crc, n = zlib.crc32(entry(int(index), float(default)), crc), n + 1
    check("settings 81 to 98 in the tables", n == 18, str(n))
    return crc & 0xFFFFFF


def crc8(data):
    """Polynomial 0x11D, start value 0, no final xor."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x11D if crc & 0x80 else crc << 1) & 0xFF
    return crc


def check_pages(pages, db, rows):
    texts = []
    for page in pages:
        with open(page) as f:
            texts.append(f.read())
    examples = [(int(i, 16), bytes.fromhex(d))
                for i, d in re.findall(r"^    can0  ([0-9A-F]{3})#([0-9A-F]{16})", texts[0], re.M)]
    bad = ["%03X" % i for i, d in examples if crc8(bytes([i & 0xFF, i >> 8]) + d[1:]) != d[0]]
    check(pages[0] + " examples have the right CRC", examples and not bad,
          "%d frames %s" % (len(examples), " ".join(bad)))
    sessions = {db.frame_by_id(canmatrix.ArbitrationId(i)).decode(d)["SESSION"].raw_value for i, d in examples}
    check(pages[0] + " examples are of session 5", sessions == {5}, str(sessions))
    lines = [line for text in texts[1:] for line in text.splitlines()]
    missing = [r for r in rows if r not in lines]
    check("the pages hold the tables of the code", not missing,
          "%d rows%s" % (len(rows), "".join("; missing: " + m for m in missing[:5])))
    extra = [line for line in lines if line.startswith("|") and line not in rows]
    check("and no other row", not extra, "".join("; " + e for e in extra[:5]))


def main():
    program, committed, *pages = sys.argv[1:]

    def run(what, scene):
        return subprocess.run([program, what, str(scene)], check=True, stdout=subprocess.PIPE).stdout.decode()

    with open(committed) as f:
        text = f.read()
    check(committed + " is what the program prints", text == run("dbc", 0))
    slow_text = run("dbc", 1)
    db, slow = load(text), load(slow_text)
    check_structure("11 bits", db, text, 0x200, False)
    check_structure("29 bits", slow, slow_text, 0x18FF0040, True)
    check_vectors("11 bits", db, run("vectors", 0).splitlines())
    check_vectors("29 bits", slow, run("vectors", 1).splitlines())
    check_details(db, slow)
    rows = run("tables", 0).splitlines()
    settings = settings_check(rows)
    check_identity("11 bits", db, 1000.0, 64, 1.0, settings)
    check_identity("29 bits", slow, 1000.0, 64, 100.0, settings)
    for scene, file in (("11 bits", text), ("29 bits", slow_text)):
        numbers = set(re.findall(r'INFO identity is (\d+)|^BA_ "PlantIdentity" (\d+);', file, re.M))
        check("%s comment and attribute say the same" % scene, len({a or b for a, b in numbers}) == 1, str(numbers))
    check_pages(pages, db, rows)
    print("%d passed, %d failed" % (count[True], count[False]))
    return count[False] != 0


sys.exit(main())
