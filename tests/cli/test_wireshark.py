#!/usr/bin/python3
"""test_wireshark.py PROGRAM - what export and dissector print, in the tools of others: tshark, capinfos, canmatrix (by the .dbc).

A reader of pcapng and a writer of frames stand here, too, independent of the program. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import csv
import io
import logging
import math
import os
import random
import struct
import subprocess
import sys
import tempfile

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "../house"))
sys.path.insert(0, os.path.join(here, "../../docs/examples"))
from verdicts import conclude, equal, verdict  # noqa: E402

logging.disable(logging.CRITICAL)  # canmatrix names the formats it was built without
import canmatrix.formats  # noqa: E402

program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build/contactplant")
BASE, MOTION, REPLY, STREAM = 0x200, 0x214, 0x211, 0x204
FUZZED = int(os.environ.get("FUZZED", 1000000))
CASE = """[plant]
scene = hertz_rig
stream_echo_every = 1
[controller]
builtin = keep
[case a]
over = 3 s
at 0.05 s arm force amplitude=60 N frequency=225 Hz
at 1 s set preload=70 N
expect touchdowns >= 1
"""


def run(*arguments, text=True):
    return subprocess.run([program, *arguments], capture_output=True, text=text, timeout=300)


def write(name, content):
    with open(name, "w" if isinstance(content, str) else "wb") as f:
        f.write(content)
    return name


def read(name):
    with open(name, "rb") as f:
        return f.read()


def tshark(name, *arguments, script="contactplant.lua"):
    r = subprocess.run(["tshark", "-n", "-X", "lua_script:" + script, "-r", name, *arguments], capture_output=True, text=True, timeout=900)
    verdict("  tshark %s: no error" % " ".join(a for a in arguments if len(a) < 40)[:70], r.returncode == 0 and "Lua" not in r.stderr + r.stdout[:2000], r.stderr)
    return r.stdout


# ---- frames, by the text of docs/reference/messages.md ----

def crc8(data):
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc


def sealed(identifier, counter, body):
    """A message of the plant: `body` is bytes 1 to 7, the low half of the first one free for the counter."""
    body = bytes([(body[0] & 0xF0) | counter]) + body[1:]
    return bytes([crc8(struct.pack("<H", identifier & 0xFFFF) + body)]) + body


def line(time, identifier, data, interface="can0", way=""):
    return "(%.6f) %s %s#%s%s" % (time, interface, "%03X" % identifier if identifier < 0x800 else "%08X" % identifier, data.hex().upper(), way)


# ---- pcapng, by its specification ----

def block(order, kind, body, options=b""):
    body += b"\0" * (-len(body) % 4) + options
    return struct.pack(order + "II", kind, len(body) + 12) + body + struct.pack(order + "I", len(body) + 12)


def option(order, code, value):
    return struct.pack(order + "HH", code, len(value)) + value + b"\0" * (-len(value) % 4)


def capture(packets, order="<", link=227, resolution=None, name=b"can0"):
    """A file of one interface: packets are (stamp in its units, bytes, flags)."""
    out = block(order, 0x0A0D0D0A, struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1))
    options = option(order, 2, name) + (option(order, 9, bytes([resolution])) if resolution is not None else b"") + option(order, 0, b"")
    out += block(order, 1, struct.pack(order + "HHI", link, 0, 0), options)
    for stamp, data, flags in packets:
        body = struct.pack(order + "IIIII", 0, stamp >> 32, stamp & 0xFFFFFFFF, len(data), len(data)) + data
        out += block(order, 6, body, option(order, 2, struct.pack(order + "I", flags)) + option(order, 0, b"") if flags else b"")
    return out


def packets_of(data):
    """Interfaces, and (interface, nanoseconds, identifier with its marks, length, flags of FD, bytes, way, comment) of each packet."""
    names, out, at = [], [], 0
    while at < len(data):
        kind, length = struct.unpack_from("<II", data, at)
        assert struct.unpack_from("<I", data, at + length - 4)[0] == length, "the length stands behind a block, too"
        body, options = data[at + 8:at + length - 4], {}
        head = {0x0A0D0D0A: 16, 1: 8, 6: 20}[kind]
        if kind == 6:
            i, high, low, captured, whole = struct.unpack_from("<IIIII", body)
            head += captured + -captured % 4
        k = head
        while k < len(body):
            code, n = struct.unpack_from("<HH", body, k)
            options[code] = body[k + 4:k + 4 + n]
            k += 4 + n + -n % 4
        if kind == 1:
            assert struct.unpack_from("<H", body)[0] == 227 and options[9] == b"\x09"
            names.append(options[2].decode())
        if kind == 6:
            can = body[20:20 + captured]
            identifier, n, fd = struct.unpack_from(">IBB", can)
            way = struct.unpack("<I", options[2])[0] & 3 if 2 in options else 0
            out.append((i, high << 32 | low, identifier, n, fd, can[8:8 + n] if not identifier & 0x40000000 else b"", way, options.get(1, b"").decode()))
        at += length
    return names, out


# ---- the tests ----

def every_value(matrix, log, exported):
    """Each signal of each frame: tshark beside canmatrix by the .dbc."""
    print("--- every value of a log, beside canmatrix by the .dbc", flush=True)
    names = {}
    for frame in matrix.frames:
        for signal in frame.signals:
            shared = signal.name in ("CHECKSUM", "COUNTER", "SESSION", "CAUSE")
            names[frame.name, signal.name] = "contactplant." + (signal.name if shared else frame.name + "." + signal.name).lower()
    columns = sorted(set(names.values()))
    table = tshark(exported, "-T", "fields", "-E", "separator=;", "-e", "contactplant.message", *(x for c in columns for x in ("-e", c)))
    rows = list(csv.reader(io.StringIO(table), delimiter=";"))
    _, packets = packets_of(read(exported))
    equal("packets", len(rows), len(packets))
    by_id = {f.arbitration_id.id: f for f in matrix.frames}
    values, absent, wrong = 0, 0, []
    for row, packet in zip(rows, packets):
        frame = by_id.get(packet[2])
        if frame is None:
            continue
        if row[0] != frame.name:
            wrong.append((row[0], frame.name))
        told = dict(zip(columns, row[1:]))
        for name, decoded in frame.decode(packet[5]).items():
            got, wanted = told[names[frame.name, name]], float(decoded.phys_value)
            raw = decoded.raw_value
            unknown = math.isnan(wanted) or (name in ("TICKS_LATE", "APPLY") and raw == 65535) or (decoded.signal.size == 24 and raw == -8388608)
            if unknown:
                absent += 1
                wrong += [(frame.name, name, got)] if got else []
                continue
            values += 1
            if not got or abs(float(got) - wanted) > 1e-12 * abs(wanted):
                wrong.append((frame.name, name, got, wanted))
    verdict("%d values of %d frames, %d not available" % (values, len(packets), absent), values > 60000 and absent > 10 and not wrong, wrong[:5])
    table = tshark(exported, "-Y", "contactplant.motion.displacement", "-T", "fields", "-e", "contactplant.motion.displacement", "-e", "contactplant.motion.velocity")
    rows = [x.split("\t") for x in table.splitlines()]
    decoded = [r for r in csv.DictReader(io.StringIO(run("decode", log).stdout)) if r["displacement [m]"]]
    same = sum("%.9g" % float(a) == d["displacement [m]"] and "%.9g" % float(b) == d["velocity [m/s]"] for (a, b), d in zip(rows, decoded))
    equal("displacement and velocity as decode prints them", (same, len(rows)), (len(decoded), len(decoded)))


def reading_back(log, exported):
    print("--- a pcapng is read like a log", flush=True)
    equal("decode: equal bytes", run("decode", exported).stdout == run("decode", log).stdout, True)
    r = run("compare", log, exported)
    equal("compare", (r.returncode, "rows agree" in r.stdout), (0, True))
    run("export", "quiet.a.log", "--out", "quiet.pcapng")
    equal("replay", (run("replay", "quiet.pcapng").stdout, run("replay", "quiet.pcapng").returncode), (run("replay", "quiet.a.log").stdout.replace(".a.log", ".pcapng"), 0))
    again = run("export", exported, "--out", "again.pcapng")
    equal("exported again: equal bytes", (again.returncode, read("again.pcapng") == read(exported)), (0, True))
    piped = subprocess.run("'%s' export '%s' | '%s' decode /dev/stdin" % (program, log, program), shell=True, capture_output=True, text=True)
    equal("out of a pipe: equal bytes", piped.stdout == run("decode", log).stdout, True)
    _, packets = packets_of(read(exported))
    for name, order, resolution, unit in (("big endian, microseconds", ">", None, 1000), ("2^-20 s", "<", 0x80 | 20, None)):
        stamps = [p[1] // unit if unit else ((p[1] << 20) + 999999999) // 1000000000 for p in packets]
        other = capture([(s, struct.pack(">IBBxx", p[2], p[3], 0) + p[5].ljust(8, b"\0"), p[6]) for s, p in zip(stamps, packets)], order, 227, resolution, b"udp")
        equal(name + ": equal rows", run("decode", write("other.pcapng", other)).stdout == run("decode", log).stdout, True)
    r = subprocess.run(["capinfos", "-c", "-E", "-M", exported], capture_output=True, text=True)
    equal("capinfos counts", "= %d" % len(packets) in r.stdout.replace(":", "=").replace("   ", " ").replace("  ", " ") or str(len(packets)) in r.stdout, True)


def lines_of_others():
    print("--- lines of others, as they stand", flush=True)
    text = ["(1732735000.000001) can0 345##1%s" % bytes(range(48)).hex().upper(), "(1732735000.000002) can0 123#R5", "(1732735000.000003) can0 18FEF100#0102030405060708 R",
            "(1732735000.000004) can0 20000080#0000000000000000", "(1732735000.000003) can0 345#01 T", "(1732735000.000005) can0 000#", "(1732735000.000006) can1 345#02", "damaged"]
    r = run("export", write("others.log", "\n".join(text) + "\n"), "--out", "others.pcapng")
    equal("status, and what was passed over", (r.returncode, "1 damaged line" in r.stderr, "backwards 1 time" in r.stderr), (0, True, True))
    names, packets = packets_of(read("others.pcapng"))
    got = [(p[2], p[3], p[4], p[5].hex(), p[6]) for p in packets][:6]
    equal("identifiers, lengths, bytes and ways", got, [(0x345, 48, 5, bytes(range(48)).hex(), 0), (0x40000123, 5, 0, "", 0), (0x98FEF100, 8, 0, "0102030405060708", 1),
                                                      (0x20000080, 8, 0, "00" * 8, 0), (0x345, 1, 0, "01", 2), (0, 0, 0, "", 0)])
    equal("nanoseconds", packets[0][1], 1732735000000001000)
    out = subprocess.run(["tshark", "-n", "-r", "others.pcapng"], capture_output=True, text=True)
    equal("tshark opens it", (out.returncode, out.stdout.count("\n")), (0, len(packets)))


def refusals_and_gaps():
    print("--- refusals, gaps, checksums, answers", flush=True)
    log, causes = [], ["ok", "range", "late", "stale", "session", "state", "full", "incomplete", "unknown", "self_test"]
    for i, cause in enumerate(causes):
        log.append(line(1 + i, STREAM, sealed(STREAM, i, bytes([0x10, i, 0]) + struct.pack("<f", i)), way=" R"))
        log.append(line(1 + i, REPLY, sealed(REPLY, i, bytes([0x10, 4, i, i, 0, 0xFF, 0xFF])), way=" T"))
    log.append(line(20, MOTION, sealed(MOTION, 3, bytes(7)), way=" T"))
    log.append(line(21, MOTION, sealed(MOTION, 7, bytes(7)), way=" T"))
    log.append(line(22, MOTION, b"\x01" + sealed(MOTION, 8, bytes(7))[1:], way=" T"))
    log.append(line(23, MOTION, b"\x01\x02", way=" T"))
    r = run("export", write("refused.log", "\n".join(log) + "\n"), "--out", "refused.pcapng")
    unknown = "contactplant export: refused.log tells no identity (INFO); see that it is of this scene\n"
    equal("export", (r.returncode, r.stderr), (0, unknown))
    _, packets = packets_of(read("refused.pcapng"))
    told = [p[7].split(",")[0] for p in packets if p[7]]
    equal("comments", told, ["refuses STREAM_0: " + c for c in causes[1:]])
    rows = tshark("refused.pcapng", "-Y", "contactplant.cause != 0", "-T", "fields", "-e", "frame.number", "-e", "contactplant.cause", "-e", "contactplant.answers").split()
    equal("the filter finds all refusals, each with its command", rows, [str(x) for i in range(1, 10) for x in (2 * i + 2, i, 2 * i + 1)])
    equal("a second pass knows the answer of a command", tshark("refused.pcapng", "-2", "-Y", "contactplant.stream_0.sample == 3", "-T", "fields", "-e", "contactplant.answered").strip(), "8")
    equal("missing frames", tshark("refused.pcapng", "-Y", "contactplant.missing", "-T", "fields", "-e", "frame.number", "-e", "contactplant.missing").split(), ["22", "3"])
    equal("a wrong checksum", tshark("refused.pcapng", "-Y", "contactplant.bad_checksum", "-T", "fields", "-e", "frame.number").split(), ["23"])
    equal("a message of two bytes", tshark("refused.pcapng", "-Y", "contactplant.bad_length", "-T", "fields", "-e", "frame.number").split(), ["24"])


def cannelloni():
    print("--- packets of cannelloni", flush=True)
    frames = [(MOTION, sealed(MOTION, 1, bytes([0x10]) + struct.pack("<i", 5)[:3] + struct.pack("<i", -7)[:3])), (0x345, b"\1\2"), (REPLY, sealed(REPLY, 2, bytes([0x10, 4, 3, 0, 0, 0, 0])))]
    body = struct.pack(">BBBH", 2, 0, 9, len(frames) + 1) + b"".join(struct.pack(">IB", i, len(d)) + d for i, d in frames) + struct.pack(">IBB", 0x123, 0x80 | 12, 1) + bytes(12)

    def ethernet(payload, port=20001):
        udp = struct.pack(">HHHH", 40000, port, 8 + len(payload), 0) + payload
        return bytes(12) + b"\x08\x00" + struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), 1, 0, 64, 17, 0, b"\x7f\0\0\1", b"\x7f\0\0\1") + udp
    write("udp.pcapng", capture([(1, ethernet(body), 0), (2, ethernet(body[:-1]), 0), (3, ethernet(b"\2\0"), 0)], link=1))
    rows = tshark("udp.pcapng", "-T", "fields", "-e", "contactplant.message", "-e", "can.id", "-e", "contactplant.motion.velocity", "-e", "contactplant.cause").splitlines()
    equal("messages, identifiers and values of the first packet", rows[0].split("\t")[0:2] + rows[0].split("\t")[3:], ["MOTION,REPLY", "532,837,529", "3"])
    lsb = next(s for f in matrix.frames if f.name == "MOTION" for s in f.signals if s.name == "VELOCITY").factor
    equal("a velocity of -7 units", abs(float(rows[0].split("\t")[2]) + 7 * float(lsb)) < 1e-15, True)
    equal("one that is cut off", tshark("udp.pcapng", "-Y", "contactplant_cannelloni.malformed", "-T", "fields", "-e", "frame.number").split(), ["2"])
    r = run("decode", "udp.pcapng")
    equal("decode takes no Ethernet", (r.returncode, r.stderr.count("\n"), "no packet of it is one of CAN" in r.stderr), (1, 1, True))


def two_logs(log):
    print("--- two logs", flush=True)
    r = run("export", log, "refused.log", "--out", "two.pcapng")
    names, packets = packets_of(read("two.pcapng"))
    stamps = [p[1] for p in packets]
    equal("interfaces, order of time", (r.returncode, names, stamps == sorted(stamps)), (0, ["udp", "can0"], True))
    run("export", log, log, "--out", "twice.pcapng")
    names, packets = packets_of(read("twice.pcapng"))
    equal("one log twice", (names, len(packets) % 2), (["udp", "udp-2"], 0))
    equal("  decode asks which", (run("decode", "twice.pcapng").returncode, run("decode", "twice.pcapng", "--interface", "udp-2").stdout == run("decode", log).stdout), (1, True))
    gaps = tshark("twice.pcapng", "-Y", "contactplant.missing", "-T", "fields", "-e", "frame.number")
    equal("  counters go on by interface", gaps, "")


def damaged(exported):
    print("--- damaged files", flush=True)
    whole = read(exported)
    rows = run("decode", exported).stdout.count("\n")
    r = run("decode", write("cut.pcapng", whole[:-9]))
    equal("cut off", (r.returncode, rows - r.stdout.count("\n") in (0, 1), "cut off" in r.stderr), (0, True, True))
    at = 0
    while at < len(whole) // 2:
        at += struct.unpack_from("<I", whole, at + 4)[0]
    r = run("decode", write("broken.pcapng", whole[:at + 4] + b"\xff" * 4 + whole[at + 8:]))
    equal("a block without a length: status, and told", (r.returncode, "1 damaged line; the first damaged one is packet" in r.stderr), (0, True))
    rng, ends = random.Random(7), set()
    for _ in range(300):
        bad = bytearray(whole[:4000])
        for _ in range(rng.randint(1, 9)):
            bad[rng.randrange(len(bad))] = rng.randrange(256)
        ends.add(run("decode", write("bad.pcapng", bytes(bad)), text=False).returncode)
    equal("300 damaged files end with", ends <= {0, 1}, True)
    r = subprocess.run("script -qec \"'%s' export '%s'\" /dev/null </dev/null" % (program, exported), shell=True, capture_output=True, text=True)
    equal("no packets on a terminal", "give --out FILE, or a pipe" in r.stdout, True)
    r = run("export", exported, "--out", exported)
    equal("an output that is its input", (r.returncode, read(exported) == whole), (2, True))
    r = run("export", write("rig.log", "x\n"))
    equal("no log", (r.returncode, r.stdout, r.stderr.count("\n")), (1, "", 1))


def fuzz():
    print("--- %d frames of random bytes under the plant's identifiers" % FUZZED, flush=True)
    rng = random.Random(1)
    part = 100000
    lua = 0
    for _ in range(FUZZED // part):
        data = bytearray(capture([]))
        for i in range(part):
            n = 8 if rng.random() < 0.9 else rng.randrange(9)
            body, identifier = rng.randbytes(n), BASE + rng.randrange(64)
            if n == 8 and rng.random() < 0.5:
                body = sealed(identifier, body[1] % 15, body[1:])
            can = struct.pack(">IBBxx", identifier, n, 0) + body.ljust(8, b"\0")
            data += block("<", 6, struct.pack("<IIIII", 0, 0, i, 16, 16) + can)
        r = subprocess.run(["tshark", "-n", "-V", "-X", "lua_script:contactplant.lua", "-r", write("fuzz.pcapng", bytes(data))], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=900)
        lua += r.stdout.count(b"Lua Error") + (r.returncode != 0)
        verdict("  frames dissected", r.stdout.count(b"contactplant ") >= part // 3 and b"[Malformed Packet" not in r.stdout, r.stdout[-300:])
    equal("errors of Lua", lua, 0)


folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)
write("t.test", CASE)
write("quiet.test", "\n".join(x for x in CASE.splitlines() if x[:3] not in ("at ", "str", "exp")) + "\nexpect touchdowns == 0\n")
assert run("test", "t.test", "--log", ".").returncode == 0
assert run("test", "quiet.test", "--log", ".").returncode == 0
dbc = run("dbc").stdout
matrix = canmatrix.formats.loadp_flat(write("plant.dbc", dbc))
write("contactplant.lua", run("dissector").stdout)
equal("export", (run("export", "t.a.log", "--out", "t.pcapng").returncode, len(packets_of(read("t.pcapng"))[1]) > 20000), (0, True))
every_value(matrix, "t.a.log", "t.pcapng")
reading_back("t.a.log", "t.pcapng")
lines_of_others()
refusals_and_gaps()
cannelloni()
two_logs("t.a.log")
damaged("t.pcapng")
print("--- a plant with 29-bit identifiers", flush=True)
write("x.lua", run("dissector", "--extended", "--base-id", "0x12340").stdout)
write("x.log", line(1, 0x12340 + 0x14, sealed(0x12340 + 0x14, 1, bytes(7))) + "\n")
run("export", "x.log", "--out", "x.pcapng", "--extended", "--base-id", "0x12340")
equal("its messages", tshark("x.pcapng", "-T", "fields", "-e", "contactplant.message", script="x.lua").split(), ["MOTION"])
for scene in ("microscope", "shaft46", "smooth_base"):
    write("x.lua", run("dissector", scene).stdout)
    tshark("refused.pcapng", script="x.lua")
fuzz()
conclude()
