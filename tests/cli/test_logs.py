#!/usr/bin/env python3
"""test_logs.py PROGRAM - logs of the world outside: lines that no plant sends, several interfaces, another plant's, frames that are
missing; and logs of ours in the tools of others. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import csv
import io
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from lockstep_client import CRC  # noqa: E402
from processes import end, end_all, free_ports, start  # noqa: E402
from verdicts import conclude, equal, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build/contactplant")
MOTION, CONTACT, SYNC = 0x214, 0x215, 0x216
CASE = "[plant]\nscene = hertz_rig\n%s\n[controller]\nbuiltin = keep\n[case a]\nover = 0.3 s\nat 0.05 s arm force amplitude=3 N frequency=225 Hz\nexpect touchdowns >= 0\n"


def run(*arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=120)


def write(name, text):
    with open(name, "w") as f:
        f.write(text)
    return name


def read(name):
    with open(name) as f:
        return f.read()


def identifier(line):
    return int(line.split(" ")[2].split("#")[0], 16)


def on_bus(lines, interface="can0"):
    """As candump -L has them: wall-clock stamps, and no words of the recorder."""
    return ["(1732735%s %s %s" % (x[8:19], interface, x.split(" ")[2]) for x in lines if identifier(x) < 0x800]


def decode(lines, *arguments):
    """Rows, lines on stderr, status."""
    r = run("decode", write("x.log", "\n".join(lines) + "\n"), *arguments)
    return list(csv.DictReader(io.StringIO(r.stdout))), r.stderr, r.returncode


def recorded(case, *settings):
    """Lines of a log of a run of the rig."""
    write("t.test", CASE % case)
    assert run("test", "t.test", "--log", ".").returncode == 0
    return read("t.a.log").splitlines()


OTHERS = {
    "CAN FD": ("345##1112233445566778899AABBCC", "passed over 1 CAN FD frame\n"),
    "CAN FD under an identifier of the plant": ("214##11122334455667788", "passed over 1 CAN FD frame\n"),
    "remote": ("214#R", "passed over 1 remote frame\n"),
    "remote with its length": ("123#R8", "passed over 1 remote frame\n"),
    "error": ("20000080#0000000000000000", "passed over 1 error frame\n"),
    "error, passive": ("20000004#0010000000000000", None),
    "others, 11 bits": ("345#0102", "passed over 1 frame of others\n"),
    "others, 29 bits": ("18FEF100#0102030405060708", "passed over 1 frame of others\n"),
    "an identifier of the plant, 29 bits": ("00000214#0102030405060708", "passed over 1 frame of others\n"),
    "a wrong checksum": ("214#0102030405060708", "passed over 1 frame that fails its check\n"),
    "damaged": ("214#01020", "passed over 1 damaged line; the first damaged one is line 1001, column 3"),
}


def test_others(lines):
    print("--- lines that no plant sends", flush=True)
    plain, told, status = decode(lines)
    equal("candump's log of one bus: status and rows", (status, len(plain), told), (0, 304, ""))
    before = lines[999].split(" ")[0] + " can0 "
    for name, (text, words) in OTHERS.items():
        rows, told, status = decode(lines[:1000] + [before + text] + lines[1000:])
        equal(name + ": the same rows", (status, rows == plain), (0, True))
        equal("  is told", words in told if words else not told, True)
        compared = run("compare", "x.log", write("y.log", "\n".join(lines) + "\n"))
        equal("  compare", (compared.returncode, compared.stdout), (0, "300 rows agree\n"))
    rows, told, status = decode(["# by hand", ""] + [x + "\r" for x in lines[:1000]] + ["", "#", "nonsense"] + lines[1000:])
    equal("comments, blank lines, CR LF and nonsense: the same rows", (status, rows == plain), (0, True))
    with open("x.log", "rb+") as f:
        f.seek(-5, os.SEEK_END)
        f.truncate()
    r = run("decode", "x.log")
    equal("cut off in its last line", (r.returncode, "1 line that is cut off" in r.stderr), (0, True))
    shown = ["  can0  %s   [8]  %s" % (i, " ".join(d[k:k + 2] for k in range(0, 16, 2))) for i, d in (x.split(" ")[2].split("#") for x in lines)]
    equal("as candump shows it without -L: the same rows", decode(shown)[0] == plain, True)
    with open(write("y.log", "\n".join(lines) + "\n")) as f:
        piped = subprocess.run("cat | '%s' decode /dev/stdin" % program, shell=True, stdin=f, capture_output=True, text=True)
    equal("out of a pipe", (piped.returncode, list(csv.DictReader(io.StringIO(piped.stdout))) == plain), (0, True))
    for text in ("t_s,frame\n0.1,3\n", "", "\0\1\2\n" * 9):
        r = run("decode", write("x.log", text))
        equal("no log at all", (r.returncode, r.stderr.count("\n"), "no line of it is one of candump -L" in r.stderr, r.stdout), (1, 1, True, ""))


def test_interfaces(lines):
    print("--- several interfaces", flush=True)
    other = on_bus(recorded("preload = 200 N"), "can1")
    plain = decode(lines)[0]
    both = [x for pair in zip(lines, other) for x in pair]
    rows, told, status = decode(both)
    equal("frames of two plants: status, rows", (status, rows), (1, []))
    verdict("  both are named", "can0 and can1" in told and "--interface can0" in told and told.count("\n") == 1, told)
    rows, told, status = decode(both, "--interface", "can0")
    n = min(len(lines), len(other))
    equal("--interface can0", (status, rows == decode(lines[:n])[0], "%d lines of other interfaces" % n in told), (0, True, True))
    equal("--interface can1 is another plant", "is of another plant" in decode(both, "--interface", "can1")[1], True)
    rows, told, status = decode(both, "--interface", "can7")
    equal("an interface without it", (status, "no frame of this plant on can7, but on can0 and can1" in told), (1, True))
    for command, more in (("replay", ()), ("compare", ("x.log",))):
        r = run(command, "x.log", *more)
        equal("  %s asks, too" % command, (r.returncode, "choose one" in r.stderr, r.stdout), (1, True, ""))
    foreign = [x.split(" ")[0] + " can1 345#0011" for x in lines]
    rows, told, status = decode([x for pair in zip(lines, foreign) for x in pair])
    equal("the other interface has frames of others alone: nothing is asked", (status, rows == plain), (0, True))
    r = run("compare", write("a.log", "\n".join(both) + "\n"), write("b.log", "\n".join(lines[:n]) + "\n"), "--interface", "can0")
    equal("compare --interface", (r.returncode, "rows agree" in r.stdout), (0, True))


def test_identity(lines, own):
    print("--- another plant's log", flush=True)
    another = ("--set", "preload_N=200")
    words = "is of another plant: another scene, rate or substeps; record it anew, or name its scene"
    write("x.log", "\n".join(lines) + "\n")
    shutil.copy(own, "own.log")
    for arguments in (("decode", "x.log"), ("decode", "own.log", "--report", "x.html"), ("decode", "own.log", "--out", "x.csv"), ("replay", "x.log"),
                      ("replay", "own.log"), ("compare", "x.log", "x.log")):
        r = run(*arguments, *another)
        equal(" ".join(arguments), (r.returncode, words in r.stderr, r.stderr.count("\n"), r.stdout), (1, True, 1, ""))
    verdict("  nothing is written", not os.path.exists("x.html") and not os.path.exists("x.csv"))
    write("g.test", CASE % "preload = 200 N" + "golden = x.log\n")
    r = run("test", "g.test")
    equal("test with such a golden log", (r.returncode, words in r.stdout + r.stderr), (3, True))
    silent = [x for x in lines if identifier(x) != 0x221]
    for arguments in (("decode", "x.log", "--out", "x.csv"), ("compare", "x.log", "x.log")):
        write("x.log", "\n".join(silent) + "\n")
        r = run(*arguments)
        equal("no identity, %s: a warning" % arguments[0], (r.returncode, "tells no identity" in r.stderr), (0, True))


def without(lines, kind, first, n):
    """Without the frames number first .. first + n - 1 of a kind."""
    seen, out = 0, []
    for x in lines:
        seen += identifier(x) == kind
        if not (identifier(x) == kind and first < seen <= first + n):
            out.append(x)
    return out


def missing(told):
    found = re.search(r"(\d+) frames? of the plant (is|are) missing", told)
    return int(found.group(1)) if found else 0


PLACES = ("displacement [m]", "velocity [m/s]", "penetration [m]", "contact_force [N]")


def test_missing(lines):
    print("--- frames that are missing", flush=True)
    whole = {r["tick"]: r for r in decode(lines)[0]}

    def judge(name, lost, n, blank, without_row):
        """Rows that have a cell less, and the rows that are not there; any other cell is that of the whole log."""
        rows, told, status = decode(lost)
        equal(name + ": status, missing", (status, missing(told)), (0, n))
        running = [r for r in rows if r["tick"] != "0"]
        wrong = [(r, k) for r in running for k in PLACES + ("in_contact",) if r[k] not in ("", whole[r["tick"]][k])]
        less = sum(any(not r[k] and whole[r["tick"]][k] for k in PLACES) for r in running)
        equal("  cells of another tick, rows with a cell less, rows less", (wrong[:1], less, len(whole) - len({r["tick"] for r in rows})), ([], blank, without_row))

    judge("six MOTION", without(lines, MOTION, 200, 6), 6, 6, 0)
    judge("twenty MOTION", without(lines, MOTION, 200, 20), 20, 20, 0)
    judge("fifteen CONTACT", without(lines, CONTACT, 100, 15), 15, 15, 0)
    judge("one SYNC", without(lines, SYNC, 150, 1), 1, 0, 1)
    judge("thirty SYNC", without(lines, SYNC, 150, 30), 30, 0, 30)
    for first in range(140, 150):  # whichever row the lost MOTION belongs to, beside a lost SYNC
        lost = without(without(lines, SYNC, 150, 1), MOTION, first, 1)
        rows, told, _ = decode(lost)
        wrong = [r["tick"] for r in rows if r["tick"] != "0" and any(r[k] not in ("", whole[r["tick"]][k]) for k in PLACES)]
        equal("SYNC 150 and MOTION %d: cells of another tick, missing" % first, (wrong, missing(told)), ([], 2))
    rows = decode(lines)[0]
    early = [r for r in rows if not r["displacement [m]"]]
    equal("rows before the first MOTION have no in_contact", (len(early) > 0, [r["in_contact"] for r in early if r["in_contact"]]), (True, []))
    equal("  and before the first STATUS no state", rows[0]["state"], "off")
    twice = [y for x in lines for y in ([x, x] if identifier(x) in (MOTION, SYNC) else [x])]
    judge("each MOTION and SYNC twice", twice, 0, 0, 0)
    seldom, told, _ = decode(on_bus(recorded("motion_every = 3")))
    moving = [r for r in seldom if r["tick"] != "0"]
    told_rows = [r for r in moving if r["displacement [m]"]]
    equal("motion_every = 3: a third of the rows, none missing", (abs(len(moving) - 3 * len(told_rows)) <= 3, missing(told)), (True, 0))
    equal("  the others have what CONTACT says", [r for r in moving if not (r["in_contact"] and r["penetration [m]"])], [])
    rows, told, _ = decode([x for x in on_bus(recorded("motion_every = 3")) if identifier(x) != CONTACT])
    equal("  and without CONTACT nothing", [r for r in rows if bool(r["in_contact"]) != bool(r["displacement [m]"])], [])
    lost = without(on_bus(recorded("motion_every = 3")), SYNC, 150, 1)
    known = {r["tick"]: r for r in seldom}
    rows = decode(lost)[0]
    equal("  a SYNC less: cells of another tick", [r["tick"] for r in rows if r["tick"] != "0" and any(r[k] not in ("", known[r["tick"]][k]) for k in PLACES)], [])


def test_anew(lines):
    print("--- plant time that begins anew", flush=True)
    twice = lines + lines
    plain = decode(lines)[0]
    rows, told, status = decode(twice)
    equal("two runs in one log: status, rows, the first one's", (status, len(rows), rows[:len(plain)] == plain), (0, 2 * len(plain), True))
    equal("  is told", ("plant time begins anew 1 time;" in told, missing(told)), (True, 0))
    write("y.log", "\n".join(lines) + "\n")
    write("z.log", "\n".join(twice) + "\n")
    for pair, status in ((("y.log", "z.log"), 1), (("z.log", "y.log"), 1), (("z.log", "z.log"), 0)):
        r = run("compare", *pair)
        equal("compare %s %s" % pair, (r.returncode, r.stdout.strip()), (status, "y.log ends first, after 300 rows" if status else "600 rows agree"))
    write("g.test", CASE % "" + "golden = z.log\n")
    r = run("test", "g.test")
    equal("a golden log of two runs is a FAIL", (r.returncode, "this run ends first" in r.stdout), (1, True))
    lost = [x for x in lines if identifier(x) != MOTION]
    r = run("compare", "y.log", write("z.log", "\n".join(lost) + "\n"))
    equal("a value that one alone has", (r.returncode, "nan" in r.stdout, "m in y.log alone, not known in z.log" in r.stdout), (1, False, True))
    r = run("decode", write("z.log", "\n".join(twice) + "\n"), "--report", "z.html", "--out", "z.csv")
    equal("a report says so", (r.returncode, "Plant time begins anew 1 time in them" in read("z.html")), (0, True))


def test_replay(own):
    print("--- replay", flush=True)
    port = free_ports(2, 31000)
    plant = start(program, "run", "--lockstep", "--bus", "udp:%d" % port, "--peer", "127.0.0.1:%d" % (port + 1), "--log", own)
    here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "lockstep_client.py")
    client = start("/usr/bin/python3", here, port + 1, port, 400)
    end(client)
    plant.terminate()
    end(plant)
    wanted = run("replay", own)
    equal("our own log replays", (wanted.returncode, wanted.stderr), (0, ""))
    lines = read(own).splitlines()
    equal("no line says its way", [x for x in lines if len(x.split(" ")) != 3], [])
    plain = [x for x in lines if identifier(x) < 0x800]
    earlier = [x + (" R" if identifier(x) % 64 < 16 else " T") for x in plain]
    r = run("replay", write("x.log", "\n".join(earlier) + "\n"))
    equal("a log of before, with R and T, replays to the same", (r.returncode, r.stdout), (0, wanted.stdout))
    foreign = [y for x in lines for y in (x, x.split(" ")[0] + " udp 345##1112233", x.split(" ")[0] + " udp 123#R", "nonsense")]
    r = run("replay", write("x.log", "\n".join(foreign) + "\n"))
    equal("with foreign lines, too", (r.returncode, r.stdout, "CAN FD frames" in r.stderr and "damaged lines" in r.stderr), (0, wanted.stdout, True))
    r = run("replay", write("x.log", "\n".join(lines)[:-3]))
    equal("cut off: equal to the last whole frame", (r.returncode, "1 line that is cut off" in r.stderr), (0, True))
    r = run("replay", write("x.log", "\n".join(on_bus(plain)) + "\n"))
    equal("candump's replays", (r.returncode, "taken on the bus" in r.stdout), (0, True))
    return lines


def test_neighbours():
    """Frames of others under a plant's identifiers, in packets of cannelloni: told once, with what they are."""
    print("--- neighbours on a bus", flush=True)
    telemetry = bytes([0x10]) + bytes(6)
    crc = 0
    for byte in b"\x16\x02" + telemetry:
        crc = CRC[crc ^ byte]
    for name, frames, wanted in (("another plant", [(0x216, bytes([crc]) + telemetry)], (True, False, False)),
                                 ("a PDO of CANopen", [(0x201, b"\1\2\3"), (0x202, bytes(8))], (False, True, True)),
                                 ("beside its identifiers", [(0x181, bytes(8)), (0x241, bytes(8)), (0x5FF, b"")], None)):
        port = free_ports(2, 33000)
        plant = start(program, "run", "--bus", "udp:%d" % port, "--peer", "127.0.0.1:%d" % (port + 1), "--duration", "1")
        packet = struct.pack(">BBBH", 2, 0, 0, len(frames)) + b"".join(struct.pack(">IB", i, len(d)) + d for i, d in frames)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
            s.bind(("127.0.0.1", port + 1))
            s.recv(2048)  # it runs
            for _ in range(5):
                s.sendto(packet, ("127.0.0.1", port))
        end(plant)
        equal(name + ": lines", (plant.returncode, plant.err.count("others use identifiers of this plant, 0x200 to 0x23F")), (0, 1 if wanted else 0))
        if wanted:
            kinds = re.findall(r": (\d+) frames that only a plant sends, (\d+) with a wrong length, (\d+) with", plant.err)[0]
            equal("  their kinds", tuple(k != "0" for k in kinds), wanted)


def test_tools(own, lines):
    print("--- the tools of others", flush=True)
    frames = [x.split(" ")[2] for x in lines if identifier(x) < 0x800]
    if shutil.which("tshark"):
        r = subprocess.run(["tshark", "-r", own, "-T", "fields", "-e", "can.id", "-e", "data.data"], capture_output=True, text=True)
        got = ["%03X#%s" % (int(i), d.upper()) for i, d in (x.split("\t") for x in r.stdout.splitlines()) if d]
        equal("tshark: frames that are as they were", (got == frames, len(got)), (True, len(frames)))
    if shutil.which("log2asc"):
        r = subprocess.run(["log2asc", "-I", own, "udp"], capture_output=True, text=True)
        got = ["%s#%s" % (x[2], "".join(x[6:])) for x in (y.split() for y in r.stdout.splitlines()) if len(x) == 14 and x[3] == "Rx"]
        equal("log2asc: frames that are as they were", (got == frames, len(got)), (True, len(frames)))
    try:
        import can
    except ImportError:
        return
    got = ["%03X#%s" % (m.arbitration_id, m.data.hex().upper()) for m in can.LogReader(own) if not m.is_error_frame and m.arbitration_id < 0x800 and not m.is_extended_id]
    equal("python-can: frames that are as they were", (got == frames, len(got)), (True, len(frames)))
    with can.CanutilsLogWriter("p.log") as f:
        for m in can.LogReader(own):
            f.on_message_received(m)
    equal("a log that python-can wrote is decoded", decode(read("p.log").splitlines())[0] == decode(lines)[0], True)


folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)
try:
    log = on_bus(recorded(""))
    test_others(log)
    test_interfaces(log)
    test_missing(log)
    test_anew(log)
    ours = test_replay("run.log")
    test_identity(log, "run.log")
    test_tools("run.log", ours)
    test_neighbours()
finally:
    end_all()
    os.chdir("/")
    folder.cleanup()
conclude()
