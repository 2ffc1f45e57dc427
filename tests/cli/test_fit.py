#!/usr/bin/env python3
"""test_fit.py PROGRAM [--all] - contactplant fit: numbers of a rig whose curves another integrator made (tests/fit/rig_curves.c), what the data give
only together, every refusal, and files. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import cmath
import math
import os
import random
import re
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
import zlib

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(here, "../house"), os.path.join(here, "../fit")]
from lever_data import LEVER, curve_text, heat_text  # noqa: E402
from lockstep_client import CRC  # noqa: E402
from verdicts import check, conclude, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1])
data = os.path.join(here, "../../docs/examples/fit")
TRUE = {"mass": 6.1, "stiffness": 3.9e9, "preload": 80.0, "damping": 150.0}  # of docs/examples/fit/*.csv
directory = tempfile.mkdtemp(prefix="contactplant-fit-")
PROCESSOR_SECONDS = 120  # of one command
small, large = (open(os.path.join(data, name)).read() for name in ("small.csv", "large.csv"))


def put(name, text):
    with open(os.path.join(directory, name), "w") as f:
        f.write(text)
    return name


def exists(name):
    return os.path.exists(os.path.join(directory, name))


def limit():
    """Of processor time: other work on the machine fails no test. One that takes more ends with SIGXCPU."""
    resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS + 1))


def run(*words):
    return subprocess.run([program, *words], capture_output=True, text=True, cwd=directory, preexec_fn=limit)


def fit(*words):
    return run("fit", "rig.ini", *words)


def table(text):
    """name: (value, half the 95 % interval), relative."""
    rows = re.findall(r"^  (\S+) +(\S+) ?(\S.*?)? +\+- (\S+) % +\+- (\S+) %", text, re.M)
    return {name: (float(value), float(wide) / 100) for name, value, _, _, wide in rows if value != "unknown"}


def off(text):
    """The largest error in half widths of its 95 % interval."""
    got = table(text)
    return max(abs(math.log(got[k][0] / TRUE[k])) / got[k][1] for k in got if k in TRUE)


def told(r):
    return (r.stdout + r.stderr)[-700:]


def test_numbers():
    r = fit("--sweep", "small.csv", "--sweep", "large.csv", "--out", "fitted.ini")
    got = table(r.stdout)
    verdict("two curves: status 0, nothing on stderr", r.returncode == 0 and not r.stderr, told(r))
    check("the rig's numbers lie within 1.5 half widths of 95 %", len(got) == 4 and off(r.stdout) < 1.5, "%.2f" % off(r.stdout))
    check("the intervals are below 1 %", max(w for _, w in got.values()) < 0.01, got)
    text = open(os.path.join(directory, "fitted.ini")).read()
    crc = "%08x" % zlib.crc32((small + large).encode())
    verdict("--out has the CRC-32 of both files", "command: " + crc in text, text[:400])
    verdict("  and the interval of each unknown", all(re.search(r"^# %s = .* 95 %% from .* to " % k, text, re.M) for k in TRUE), text[:600])
    verdict("  and is a scene", run("scene", "fitted.ini").returncode == 0 and "mass = 6.09" in text, text)
    again = run("fit", "fitted.ini", "--sweep", "small.csv", "--sweep", "large.csv")
    verdict("a fit from the fitted scene ends at the same numbers", table(again.stdout) == got, told(again))
    far = put("far.ini", "[plant]\nmodel = hertz_rig\nmass = 12 kg\nstiffness = 2e9 N/m^1.5\npreload = 150 N\ndamping = 80 N s/m\n")
    again = run("fit", far, "--sweep", "small.csv", "--sweep", "large.csv")
    verdict("and from one that is off by factors of two", table(again.stdout) == got and again.returncode == 0, told(again))


def test_together():
    r = fit("--sweep", "small.csv")
    words = re.search(r"these data give stiffness\^2 preload to (\S+) %; stiffness and preload apart only to (\S+) % and (\S+) %", r.stdout)
    verdict("one small curve: what it gives only together", words and float(words[1]) < 1 and float(words[2]) > 2 and float(words[3]) > 4, told(r))
    further = re.search(r"a further sweep at (.*), with the same noise, would give stiffness and preload to (\S+) % and (\S+) %", r.stdout)
    verdict("  and which sweep would part them", further and float(further[3]) < 0.3 * float(words[3]), told(r))
    r = fit("--sweep", "small.csv", "--hold", "preload=80 N")
    got = table(r.stdout)
    verdict("with the preload held it gives the stiffness", r.returncode == 0 and got["stiffness"][1] < 0.01 and off(r.stdout) < 1.5, told(r))
    r = fit("--sweep", "small.csv", "--sweep", "large.csv", "--free", "mass,stiffness,preload,damping,gain.force", "--out", "gain.ini")
    verdict("with a free gain of the force: unknown, status 1, no file",
            r.returncode == 1 and r.stdout.count("unknown ") >= 5 and "hold one of them" in r.stdout and "reaches the bound" in r.stderr and not exists("gain.ini"), told(r))
    r = fit("--sweep", "small.csv", "--sweep", "large.csv", "--free", "stiffness,preload,damping,gain.sensor,delay", "--hold", "mass=6.1 kg")
    verdict("with the mass held, gain of the sensor and delay are told", r.returncode == 0 and abs(table(r.stdout)["gain.sensor"][0] - 1) < 0.01 and off(r.stdout) < 1.5, told(r))


def rows_with(text, change):
    """Each row's cells through `change`."""
    lines = text.splitlines()
    head = [i for i, line in enumerate(lines) if line.startswith("frequency")][0]
    return "\n".join(lines[:head + 1] + [",".join(change(*map(float, line.split(",")))) for line in lines[head + 1:]]) + "\n"


def test_forms():
    wanted = table(fit("--sweep", "small.csv", "--hold", "preload=80 N").stdout)

    def same(name, text):
        put("form.csv", text)
        r = fit("--sweep", "form.csv", "--hold", "preload=80 N")
        got = table(r.stdout)
        verdict(name, r.returncode == 0 and all(abs(got[k][0] / wanted[k][0] - 1) < 2e-4 for k in wanted), told(r))

    same("degrees and micrometres that are said", rows_with(small.replace("frequency_Hz,amplitude_m,phase_rad", "frequency_Hz,amplitude_um,phase_deg"),
                                                            lambda f, a, p: ("%.9g" % f, "%.9g" % (a * 1e6), "%.9g" % math.degrees(p))))
    same("real and imaginary part over the drive", rows_with(small.replace("frequency_Hz,amplitude_m,phase_rad", "frequency_Hz,re_um_per_N,im_um_per_N"),
                                                             lambda f, a, p: ("%.9g" % f, "%.9g" % (a * 1e6 * math.cos(p) / 0.3), "%.9g" % (a * 1e6 * math.sin(p) / 0.3))))
    for n, (output, column) in enumerate((("velocity", "amplitude_m_per_s"), ("acceleration", "amplitude_m_per_s^2")), 1):
        same("a curve of the " + output, rows_with(small.replace("output = displacement", "output = " + output).replace("amplitude_m,", column + ","),
                                                   lambda f, a, p, n=n: ("%.9g" % f, "%.9g" % (a * (2 * math.pi * f) ** n), "%.9g" % (p + n * math.pi / 2))))
    same("sigma in a column", rows_with(small.replace("# noise = 1 %\n", "").replace("phase_rad", "phase_rad,sigma_nm"),
                                        lambda f, a, p: ("%.9g" % f, "%.9g" % a, "%.9g" % p, "%.9g" % (a * 1e7))))
    put("form.csv", small.replace("amplitude_m,", "amplitude_mm,"))
    r = fit("--sweep", "form.csv", "--hold", "preload=80 N")
    verdict("metres that say they are millimetres: asked", re.search(r"^note: mass is 9\d\d times that of the scene: are the units of the data right", r.stdout, re.M), told(r))
    put("form.csv", small.replace("\n", "\r\n").replace("# noise = 1 %\r\n", ""))
    r = fit("--sweep", "form.csv", "--hold", "preload=80 N")
    got = table(r.stdout)
    verdict("without its noise, which the residuals tell", "do not say their noise" in r.stdout and r.returncode == 0 and
            all(0.7 < got[k][1] / wanted[k][1] < 1.4 for k in wanted), told(r))
    plain = rows_with(small.replace(",phase_rad", ""), lambda f, a, p: ("%.9g" % f, "%.9g" % a))
    put("form.csv", plain)
    r = fit("--sweep", "form.csv", "--hold", "preload=80 N")
    verdict("amplitudes without phase", r.returncode == 0 and off(r.stdout) < 1.5, told(r))


def record(n, step, begin, force, frequency, noise, seed, rig=TRUE):
    """Rows time, displacement, force of the rig by the classical Runge-Kutta method, with Gaussian noise in metres."""
    m, k, load, c = rig["mass"], rig["stiffness"], rig["preload"], rig["damping"]
    z, v, parts, w, g = (load / k) ** (2 / 3) + begin, 0.0, 8, 2 * math.pi * frequency, random.Random(seed)
    h = step / parts

    def rate(z, v, t):
        return (load + force * math.cos(w * t) - c * v - (k * z * math.sqrt(z) if z > 0 else 0)) / m

    rows = []
    for i in range(n):
        rows.append((i * step, z + g.gauss(0, noise), force * math.cos(w * i * step)))
        for j in range(parts):
            t = (i * parts + j) * h
            v1, a1 = v, rate(z, v, t)
            v2, a2 = v + h / 2 * a1, rate(z + h / 2 * v1, v + h / 2 * a1, t + h / 2)
            v3, a3 = v + h / 2 * a2, rate(z + h / 2 * v2, v + h / 2 * a2, t + h / 2)
            v4, a4 = v + h * a3, rate(z + h * v3, v + h * a3, t + h)
            z, v = z + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return rows


def held_record(n, force, seed, size, rig=TRUE):
    """Displacements at frames of 1 ms, and the force that was held before each, by the classical Runge-Kutta method: random steps."""
    m, k, load, c = rig["mass"], rig["stiffness"], rig["preload"], rig["damping"]
    z, v, parts, g, rows, f = (load / k) ** (2 / 3), 0.0, 40, random.Random(seed), [], 0.0
    h = 1e-3 / parts
    for i in range(n):
        rows.append((z, f))
        f = force * (1 if g.random() < 0.5 else -1) * size
        for _ in range(parts):
            def rate(z, v):
                return (load + f - c * v - (k * z * math.sqrt(z) if z > 0 else 0)) / m
            v1, a1 = v, rate(z, v)
            v2, a2 = v + h / 2 * a1, rate(z + h / 2 * v1, v + h / 2 * a1)
            v3, a3 = v + h / 2 * a2, rate(z + h / 2 * v2, v + h / 2 * a2)
            v4, a4 = v + h * a3, rate(z + h * v3, v + h * a3)
            z, v = z + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return rows


STREAM, MOTION, SYNC = 0x204, 0x214, 0x216
COUNTERS = {}


def can(at, interface, identifier, high, payload):
    """A line of candump -L; payload: bytes 2 to 7."""
    n = COUNTERS[identifier] = (COUNTERS.get(identifier, -1) + 1) % 15
    body, crc = bytes([n | high << 4]) + payload, 0
    for byte in struct.pack("<H", identifier) + body:
        crc = CRC[crc ^ byte]
    return "(%.6f) %s %03X#%02X%s" % (1732735000 + at, interface, identifier, crc, body.hex().upper())


def candump(rows, lsb, interface="can0", streams=True):
    """What a rig with these rows says and hears: SYNC, MOTION and, before the frame in which it acts, STREAM."""
    COUNTERS.clear()
    lines = []
    for i, (z, _) in enumerate(rows):
        lines.append(can(1e-3 * i, interface, SYNC, 0, struct.pack("<HI", i & 0xFFFF, 64 * i)))
        lines.append(can(1e-3 * i + 1e-4, interface, MOTION, 1, struct.pack("<i", round(z / lsb))[:3] + bytes(3)))
        if streams and i + 1 < len(rows):
            lines.append(can(1e-3 * i + 2e-4, interface, STREAM, 1, struct.pack("<Hf", i & 0xFFFF, rows[i + 1][1])))
    return lines


def test_logs():
    lsb = float(re.search(r"DISPLACEMENT : 16\|24@1- \((\S+),0\)", run("dbc", "rig.ini").stdout)[1])
    rows = held_record(300, 2.0, 11, 1.0)
    lines = candump(rows, lsb)

    def fit_log(lines, *words, name="bench.log"):
        put(name, "\n".join(lines) + "\n")
        return fit("--log", name, "--hold", "mass=6.1 kg", *words)

    whole = fit_log(lines)
    verdict("a candump of a streamed force gives the contact", whole.returncode == 0 and off(whole.stdout) < 1.5 and max(w for _, w in table(whole.stdout).values()) < 0.01, told(whole))
    verdict("  its rows are told", "298 values of displacement, driven by force" in whole.stderr and "STREAM alone" in whole.stderr and "tells no identity" in whole.stderr, told(whole))
    motions = [i for i, line in enumerate(lines) if " 214#" in line]
    lost = set(motions[30:60]) | set(motions[200:290:3])
    r = fit_log([line for i, line in enumerate(lines) if i not in lost], "--svg", "gaps.svg")
    verdict("  missing frames are gaps", r.returncode == 0 and off(r.stdout) < 1.5 and "%d values" % (298 - len(lost)) in r.stderr and "of %d numbers" % (298 - len(lost)) in r.stdout, told(r))
    verdict("  in the picture, too", "nan" not in open(os.path.join(directory, "gaps.svg")).read().lower(), "")
    beyond = list(lines)
    for i in motions[100:105]:
        beyond[i] = can(1e-3 * 100, "can0", MOTION, 1, b"\0\0\x80" + bytes(3))
    COUNTERS.clear()
    for i in motions:
        number, payload = beyond[i].split("#")[0], bytes.fromhex(beyond[i].split("#")[1])[2:]
        beyond[i] = number + "#" + can(0, "can0", MOTION, 1, payload).split("#")[1]
    r = fit_log(beyond)
    verdict("  values beyond the bus's range are left out and counted", r.returncode == 0 and off(r.stdout) < 1.5 and "5 values of displacement beyond" in r.stderr and
            "293 values" in r.stderr, told(r))
    both = [line for pair in zip(lines, candump(rows, lsb, "can1")) for line in pair]
    r = fit_log(both)
    verdict("two interfaces: one is to be chosen", r.returncode == 2 and "can0 and can1" in r.stderr and "--interface can0" in r.stderr, told(r))
    r = fit_log(both, "--interface", "can1")
    verdict("  --interface can1", r.returncode == 0 and table(r.stdout) == table(whole.stdout), told(r))
    run("export", "bench.log", "--out", "no.pcapng")
    put("bench.log", "\n".join(lines) + "\n")
    exported = run("export", "bench.log", "--out", "bench.pcapng")
    r = fit("--log", "bench.pcapng", "--hold", "mass=6.1 kg")
    verdict("the log as pcapng: the same numbers", exported.returncode == 0 and r.returncode == 0 and table(r.stdout) == table(whole.stdout), told(exported) + told(r))
    tiny = held_record(300, 2.0, 12, 1e-2)
    r = fit_log(candump(tiny, lsb), "--free", "stiffness,damping", "--hold", "preload=80 N")
    chi2 = float(re.search(r"chi\^2 per number (\S+),", r.stdout)[1]) if r.returncode == 0 else 0
    verdict("a motion of few steps of the bus: their rounding is the noise", 0.5 < chi2 < 2 and off(r.stdout) < 2, told(r))
    for name, these, words, why in (
            ("no drive", candump(rows, lsb, streams=False), (), "the drive is not told"), ("few frames", lines[:60], (), "no part of 32 frames"),
            ("samples missing", [line for i, line in enumerate(lines) if i % 60 != 2], (), "samples of STREAM are missing"),
            ("other identifiers", lines, ("--base-id", "0x240"), "--base-id"), ("no multiple", lines, ("--base-id", "0x241"), "multiple of 0x40"),
            ("nothing of a plant", ["(1.000000) can0 123#00"], (), "no SYNC"), ("no log", ["1,2,3"], (), "candump -L")):
        r = fit_log(these, *words, "--out", "no.ini")
        last = r.stderr.splitlines()[-1] if r.stderr else ""
        verdict("bad log, %s: %s" % (name, why), r.returncode == 2 and why in last and not r.stdout and not exists("no.ini"), told(r))
    r = fit("--log", "none.log")
    verdict("bad log, none: one line", r.returncode == 2 and r.stderr.count("\n") == 1 and "none.log" in r.stderr, told(r))


def test_plant_logs():
    sounding = open(os.path.join(directory, "true.ini")).read()
    put("plant.test", "[plant]\nscene = true.ini\n[controller]\nbuiltin = keep\n[case a]\nover = 1.5 s\nexpect touchdowns >= 0\n[case b]\nrate = 2 kHz\nover = 0.2 s\nexpect touchdowns >= 0\n")
    verdict("true.ini drives its force", "amplitude = 3 N" in sounding, sounding)
    assert run("test", "plant.test", "--log", ".").returncode == 0
    r = fit("--log", "plant.a.log", "--out", "logged.ini")
    got = table(r.stdout)
    verdict("the log of a plant whose scene drives it gives all four", r.returncode == 0 and all(abs(got[k][0] / TRUE[k] - 1) < 1e-4 for k in TRUE), told(r))
    text = open(os.path.join(directory, "logged.ini")).read() if exists("logged.ini") else ""
    crc = "%08x" % zlib.crc32(open(os.path.join(directory, "plant.a.log"), "rb").read())
    verdict("  with the CRC-32 of the log", crc in text and "data: plant.a.log" in text, text[:500])
    r = fit("--log", "plant.b.log")
    verdict("the log of another rate is another plant's", r.returncode == 2 and "is of another plant" in r.stderr and r.stderr.count("\n") == 1, told(r))


def test_ended_logs():
    """The part before an end or a time-out is judged by the drive that acted in it, and ends where that was told last."""
    drawn = {"mass": 6.5, "stiffness": 3.4e9, "preload": 64, "damping": 188}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as a, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as b:
        a.bind(("127.0.0.1", 0))
        b.bind(("127.0.0.1", 0))
        own, other = ("127.0.0.1:%d" % s.getsockname()[1] for s in (a, b))
    plant = subprocess.Popen([program, "run", "rig.ini", "--lockstep", "--bus", "udp:" + own, "--peer", other, "--log", "ended.log"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=directory, preexec_fn=limit)
    run("control", "rig.ini", "--lockstep", "--bus", "udp:" + other, "--peer", own, "--duration", "6")
    plant.communicate()
    r = fit("--log", "ended.log")
    got = table(r.stdout)
    verdict("the log of a run that ended gives all four", r.returncode == 0 and all(abs(got[k][0] / drawn[k] - 1) < 1e-3 for k in drawn), told(r))
    lines = open(os.path.join(directory, "ended.log")).read().splitlines()
    last = max(i for i, line in enumerate(lines) if re.search(" 218#..0.0000", line))  # channel 0, amplitude
    COUNTERS[0x218] = (int(lines[last].split("#")[1][3], 16) - 1) % 15
    silent = lines[last].split("#")[0] + "#" + can(0, "udp", 0x218, 0, bytes(6)).split("#")[1]
    put("silent.log", "\n".join(lines[:last] + [silent]) + "\n")
    r = fit("--log", "silent.log")
    got = table(r.stdout)
    verdict("  and the part before an echo of amplitude 0 does", r.returncode == 0 and all(abs(got[k][0] / drawn[k] - 1) < 1e-3 for k in drawn), told(r))


def ring_text(rows, head="# noise = 20 nm\ntime_ms,displacement_um\n"):
    return head + "".join("%.9g,%.9g\n" % (t * 1e3, z * 1e6) for t, z, _ in rows)


def test_records():
    ring = record(500, 2e-4, 3e-6, 0, 0, 2e-8, 5)
    put("ring.csv", ring_text(ring))
    r = fit("--ring", "ring.csv", "--hold", "mass=6.1 kg")
    got = table(r.stdout)
    verdict("a ring-down with the mass held gives the contact", r.returncode == 0 and off(r.stdout) < 1.5 and got["preload"][1] < 2e-3 and got["damping"][1] < 0.01, told(r))
    r = fit("--ring", "ring.csv", "--free", "mass,stiffness,damping", "--hold", "preload=80 N")
    verdict("  with the preload held it gives the mass", r.returncode == 0 and off(r.stdout) < 1.5 and table(r.stdout)["mass"][1] < 2e-3, told(r))
    r = fit("--ring", "ring.csv")
    verdict("  with nothing held: all by a common factor", r.returncode == 1 and "common factor of mass^0.5, stiffness^0.5, preload^0.5, damping^0.5" in r.stdout, told(r))
    shifted = put("shifted.csv", ring_text([(t, z - 5e-6, 0) for t, z, _ in ring]))
    r = fit("--ring", shifted, "--hold", "mass=6.1 kg", "--free", "stiffness,preload,damping,offset")
    at = re.search(r"^  offset +(\S+) µm +\+- \S+ nm +\+- (\S+) nm", r.stdout, re.M)
    verdict("  from another zero: with its offset", r.returncode == 0 and off(r.stdout) < 1.5 and at and abs(float(at[1]) + 5) < 2e-3 * float(at[2]), told(r))
    bare = put("bare.csv", ring_text(ring, "time_ms,displacement_um\n"))
    r = fit("--ring", bare, "--hold", "mass=6.1 kg")
    verdict("  without its noise", r.returncode == 0 and all(0.7 < table(r.stdout)[k][1] / got[k][1] < 1.4 for k in got), told(r))
    r = fit("--sweep", "small.csv", "--ring", "ring.csv")
    verdict("a small curve and a ring-down give all four", r.returncode == 0 and off(r.stdout) < 1.5 and max(w for _, w in table(r.stdout).values()) < 0.01, told(r))
    driven = record(1200, 1e-4, 0, 2, 230, 2e-8, 6)
    put("driven.csv", "# noise = 20 nm\ntime_s,displacement_m,force_N\n" + "".join("%.9g,%.9g,%.9g\n" % row for row in driven))
    r = fit("--series", "driven.csv")
    verdict("a motion under a drive gives all four", r.returncode == 0 and off(r.stdout) < 1.5 and max(w for _, w in table(r.stdout).values()) < 0.03, told(r))
    head = "# noise = 1 %\ntime_s,displacement_m\n"
    rows = ["%.9g,%.9g\n" % row[:2] for row in ring[:40]]
    for name, text, place, words in (
            ("no time", "frequency_Hz,displacement_m\n1,2\n", "1:1", "no column time_s"), ("no motion", "time_s,volt\n1,2\n", "1:1", "no column with the motion"),
            ("times fall", head + rows[0] + rows[2] + rows[1], "5:1", "does not rise"), ("uneven times", head + "".join(rows[:5] + rows[6:]), "8:1", "equal steps"),
            ("few rows", head + "".join(rows[:9]), 11, "16 at least"), ("few turns", head + "".join(rows), 42, "fewer than 3 turns"),
            ("nothing moves", head + "".join("%d,1\n" % i for i in range(20)), 22, "nothing moves"), ("noise in another unit", head.replace("1 %", "1 N") + "".join(rows), 1, "noise"),
            ("a key of curves", "# direction = up\n" + head, 1, "no key")):
        put("bad.csv", text)
        r = fit("--ring", "bad.csv", "--out", "no.ini")
        verdict("bad record, %s: %s" % (name, words), r.returncode == 2 and r.stderr.count("\n") == 1 and "bad.csv:%s: " % place in r.stderr and words in r.stderr and not exists("no.ini"), told(r))
    r = fit("--series", "ring.csv")
    verdict("a series without its drive", r.returncode == 2 and "no column with the drive" in r.stderr, told(r))


def off_lever(text, lever=LEVER):
    got = table(text)
    for name, value, prefix in re.findall(r"^  (\w+) +(\S+) ([zakMG])(?:Hz|J)", text, re.M):
        got[name] = (float(value) * {"z": 1e-21, "a": 1e-18, "k": 1e3, "M": 1e6}[prefix], got[name][1])
    return max(abs(math.log(got[k][0] / lever[k])) / got[k][1] for k in got if k in lever)


def test_levers():
    put("heat.csv", heat_text(LEVER, 60, 3))
    put("curve.csv", curve_text(LEVER, 20e-12, 3e-9, 4))
    scene = run("scene", "tapping").stdout
    for name, value in (("f0", "70 kHz"), ("stiffness", "2 N/m"), ("quality", "400"), ("hamaker", "64 zJ"), ("hamaker_out", "64 zJ"), ("modulus", "1e+09 Pa")):
        factor = {"f0": "40 kHz", "stiffness": "3.9 N/m", "quality": "290", "hamaker": "1.2e-19 J", "hamaker_out": "1.2e-19 J", "modulus": "5.2e8 Pa"}[name]
        scene = re.sub(r"^%s = %s " % (name, re.escape(value)), "%s = %s " % (name, factor), scene, flags=re.M)
    put("lever.ini", scene)
    r = run("fit", "lever.ini", "--thermal", "heat.csv")
    got = table(r.stdout)
    verdict("a spectrum gives f0, stiffness and quality of a lever", r.returncode == 0 and off_lever(r.stdout) < 1.5 and got["stiffness"][1] < 0.08 and got["quality"][1] < 0.08, told(r))
    verdict("  and says what it does not", re.search(r"^not determined, as in the scene: temperature, modes, radius, hamaker, .*modulus", r.stdout, re.M), told(r))
    r = run("fit", "lever.ini", "--thermal", "heat.csv", "--curve", "curve.csv", "--out", "found.ini", "--svg", "found.svg")
    got, contact = table(r.stdout), re.search(r"^  contact +(\S+) nm +\+- \S+ pm +\+- (\S+) pm", r.stdout, re.M)
    verdict("with a force curve, all six", r.returncode == 0 and off_lever(r.stdout) < 1.5 and len(got) == 6 and max(w for _, w in got.values()) < 0.1, told(r))
    verdict("  where contact begins, too", contact and abs(float(contact[1]) - 3) < 1.5e-3 * float(contact[2]), told(r))
    text = open(os.path.join(directory, "found.ini")).read() if exists("found.ini") else ""
    crc = "%08x" % zlib.crc32((open(os.path.join(directory, "heat.csv")).read() + open(os.path.join(directory, "curve.csv")).read()).encode())
    verdict("  --out has the CRC-32 of both, and is a scene", crc in text and run("scene", "found.ini").returncode == 0, text[:600])
    verdict("  --svg draws both", exists("found.svg") and "density" in open(os.path.join(directory, "found.svg")).read() and "nan" not in open(os.path.join(directory, "found.svg")).read(), "")
    r = run("fit", "lever.ini", "--curve", "curve.csv", "--hold", "stiffness=2 N/m")
    verdict("a force curve alone, with the stiffness held", r.returncode == 0 and off_lever(r.stdout) < 1.5 and table(r.stdout)["modulus"][1] < 0.03, told(r))
    soft = {"f0": 20640, "stiffness": 0.1805, "quality": 30.2, "hamaker": 8.5e-20, "hamaker_out": 9.55e-20, "modulus": 5e8}
    put("soft.ini", "[plant]\nmodel = afm_lever\ntemperature = 295 K\nf0 = 20640 Hz\nstiffness = 0.1805 N/m\nquality = 30.2\nhamaker = 120 zJ\nhamaker_out = 120 zJ\nmodulus = 800 MPa\n")
    for seed in (0, 1, 10):
        put("soft.csv", curve_text(soft, 100e-12, 0, seed, top=50e-9))
        r = run("fit", "soft.ini", "--curve", "soft.csv", "--hold", "stiffness=0.1805 N/m")
        wider = re.search(r"no parabola beside contact: its interval comes from its profile, and is (\S+) times as wide", r.stdout)
        contact = re.search(r"^  contact +(\S+) pm +\+- \S+ pm +\+- (\S+) pm", r.stdout, re.M)
        verdict("chi^2 that is no parabola, noise %d: the interval comes from the profile and holds the truth" % seed, r.returncode == 0 and wider and float(wider[1]) > 1.4 and
                contact and abs(float(contact[1])) < float(contact[2]) and off_lever(r.stdout, soft) < 1.5, told(r))
    put("cone.csv", curve_text({**LEVER, "modulus": 1e8}, 5e-12, 3e-9, 5, power=2.0))
    r = run("fit", "lever.ini", "--curve", "cone.csv", "--hold", "stiffness=2 N/m")
    verdict("the force curve of a cone: told", "is not quite this plant" in r.stdout or r.returncode == 1, told(r))


def test_plant_levers():
    assert run("thermal", "soft", "--seconds", "5", "--out", "heat.csv").returncode == 0
    assert run("approach", "soft", "--tab", "curve.tab", "--out", "curve.csv").returncode == 0
    true = {"f0": 13e3, "stiffness": 0.2, "quality": 30.0, "hamaker": 6.4e-20, "hamaker_out": 6.4e-20, "modulus": 1e9}
    r = run("fit", "soft", "--thermal", "heat.csv", "--curve", "curve.tab")
    verdict("a lever from its plant's own thermal and approach: what was put in", r.returncode == 0 and off_lever(r.stdout, true) < 1.5 and len(table(r.stdout)) == 6, told(r))
    other = run("fit", "soft", "--thermal", "heat.csv", "--curve", "curve.csv")
    verdict("  .csv and .tab tell the same", all(abs(table(other.stdout)[k][0] / v - 1) < 1e-3 for k, (v, _) in table(r.stdout).items()), told(other))


def test_guide():
    """What the page says that its commands print: the lines that are indented by six, and what follows them."""
    printed = [run(*words.split()) for words in ("thermal soft --seconds 20 --out heat.csv", "approach soft --tab curve.tab --out curve.csv", "fit soft --thermal heat.csv --curve curve.tab",
                                                 "fit rig.ini --sweep small.csv", "fit rig.ini --plan")]
    lines = [" ".join(line.split()) for r in printed for line in r.stdout.splitlines()]
    with open(os.path.join(here, "../../docs/guide/fit.md")) as f:
        shown = re.findall(r"^ {6}.*|^    (?:rig.ini: |chi|\d of|these|a further).*", f.read(), re.M)
    differ = [line for line in shown if not any(text.startswith(" ".join(line.rstrip(".").split())) for text in lines)]
    verdict("the guide shows what its commands print: %d lines" % len(shown), len(shown) > 12 and not differ, differ)


def test_bad_levers():
    heat, curve, small_curve = heat_text(LEVER, 60, 3), curve_text(LEVER, 20e-12, 0, 4), "retract,base_m,deflection_m\n0,0,0\n0,1,0\n"
    for option, name, text, place, words in (
            ("--thermal", "no density", "frequency_Hz,volt\n1,2\n", "1:1", "density_m2_per_Hz"), ("--thermal", "no unit", heat.replace("density_m2_per_Hz", "density", 1), "1:14", "density_m2_per_Hz"),
            ("--thermal", "another unit", heat.replace("m2_per_Hz", "m_per_Hz", 1), "1:14", "write density"), ("--thermal", "density 0", heat + "1e9,0\n", "1201:5", "not above 0"),
            ("--thermal", "falls", heat + "1,1\n", "1201:1", "does not rise"), ("--thermal", "few rows", "\n".join(heat.splitlines()[:9]) + "\n", "9", "32 at least"),
            ("--thermal", "no resonance", "frequency_Hz,density_m2_per_Hz\n" + "".join("%d,1e-25\n" % i for i in range(1, 99)), None, "no resonance"),
            ("--curve", "no base", "x,y\n1,2\n", "1:1", "no column base_m"), ("--curve", "no unit", curve.replace("base_m", "base", 1), "1:9", "unit is missing"),
            ("--curve", "which way", curve.replace("\n0,", "\nno,", 1), "2:1", "write 1 on the way back"), ("--curve", "few rows", small_curve, "3", "32 at least"),
            ("--curve", "still", "base_m,deflection_m\n" + "1,1\n" * 40, None, "does not move"), ("--curve", "a .tab without them", "# a\tb\tc\n1\t2\t3\n", "1:3", "height (measured)"),
            ("--curve", "nothing", "", 1, "no header")):
        put("bad.csv", text)
        r = run("fit", "tapping", option, "bad.csv", "--out", "no.ini")
        at = "bad.csv:%s: " % place if place else "bad.csv: "
        verdict("bad %s, %s: %s" % (option, name, words), r.returncode == 2 and r.stderr.count("\n") == 1 and at in r.stderr and words in r.stderr and not r.stdout and not exists("no.ini"), told(r))
    put("heat.csv", heat)
    cold = put("cold.ini", run("scene", "tapping").stdout.replace("temperature = 295 K", "temperature = 0 K"))
    for words, why in ((("rig.ini", "--thermal", "heat.csv"), "is no AFM lever"), (("tapping", "--thermal", "heat.csv", "--sweep", "small.csv"), "of a rig"), ((cold, "--thermal", "heat.csv"), "0 K"),
                       (("tapping",), "--thermal FILE"), (("tapping", "--thermal", "heat.csv", "--free", "gain.sensor"), "no unknown of a lever"), (("tapping", "--thermal", "heat.csv", "--plan"), "--plan")):
        r = run("fit", *words)
        verdict("fit %s: %s" % (" ".join(words), why), r.returncode == 2 and r.stderr.count("\n") == 1 and why in r.stderr, told(r))


def invert(a):
    """The inverse of a small matrix, by Gauss and Jordan."""
    n = len(a)
    rows = [list(row) + [float(i == k) for k in range(n)] for i, row in enumerate(a)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k in range(n):
            if k != i:
                rows[k] = [x - rows[k][i] * y for x, y in zip(rows[k], rows[i])]
    return [row[n:] for row in rows]


def fisher(low, high, points):
    """Standard deviations of the logarithms of mass and damping from a curve of the linear rig with 1 % noise, by its closed form."""
    m, c = 6.5, 188.0
    k = 1.5 * 3.4e9 ** (2 / 3) * 64 ** (1 / 3)
    information = [[0.0] * 3 for _ in range(3)]
    for i in range(points):
        w = 2 * math.pi * (low + (high - low) * i / (points - 1))
        below = k - m * w * w + 1j * c * w
        slopes = [m * w * w / below, -1j * c * w / below, -k / below]  # of ln H over ln m, ln c, ln k
        for a in range(3):
            for b in range(3):
                information[a][b] += (slopes[a] * slopes[b].conjugate()).real / 0.01 ** 2
    spread = invert(information)
    return [100 * math.sqrt(spread[i][i]) for i in range(2)]


SHAFT = """[plant]
model = shaft_bearing
length = 1 m
mass1 = 0.414 kg
mass2 = 0.527 kg
mass3 = 0.414 kg
damping1 = 4.73 N s/m
damping2 = 6.01 N s/m
damping3 = 4.73 N s/m
support1 = 2330 N/m
support3 = 2640 N/m
flexure = 414e3 N m/rad
gap1 = 220 um
gap3 = 568 um
gap_stiffness1 = 3370 N/m
gap_stiffness3 = 2150 N/m
[ask]
observable = position1
"""


def test_plan():
    r = fit("--plan", "--free", "mass,stiffness,damping")
    ends = re.search(r"curves of (\d+) points, (\S+) to (\S+) Hz", r.stdout)
    first = re.search(r"^  \S+ mN +(\S+) % +\S+ % +(\S+) %", r.stdout, re.M)
    wanted = fisher(float(ends[2]), float(ends[3]), int(ends[1])) if ends else [0, 0]
    check("--plan: mass and damping from the smallest curve, as by the closed form of a linear rig",
          r.returncode == 0 and first and all(abs(float(got) / w - 1) < 0.03 for got, w in zip(first.groups(), wanted)), "%s, %.3g %.3g" % (first.groups(), *wanted))
    r = fit("--plan")
    rows = re.findall(r"^  (\S+ \S+)( and \S+ \S+)? +(\S+) % +(\S+) % +(\S+) % +(\S+) %", r.stdout, re.M)
    verdict("  stiffness and preload are parted by a second, larger drive", len(rows) == 9 and float(rows[0][4]) > 100 and float(rows[-1][4]) < 1, told(r))
    put("shaft.ini", SHAFT)
    r = run("fit", "shaft.ini", "--plan", "--free", "support1,support3,gap1,gap3")
    ends = re.search(r"curves of \d+ points, (\S+) to", r.stdout)
    inertia, coupling, sum_k, product_k = 0.414 + 0.527 / 4, 0.527 / 4, 2 * (2330 + 2640), 4 * 2330 * 2640  # of a shaft that does not bend
    determinant = inertia ** 2 - coupling ** 2
    root = math.sqrt((inertia * sum_k) ** 2 - 4 * determinant * product_k)
    modes = [math.sqrt((inertia * sum_k + sign * root) / (2 * determinant)) / (2 * math.pi) for sign in (-1, 1)]
    check("  a shaft's curves lie about a mode of its supports", ends and min(abs(float(ends[1]) / 0.6 / f - 1) for f in modes) < 0.02, "%s, %s" % (r.stdout[:80], modes))
    rows = re.findall(r"^  (\S+ \S+)(?: and \S+ \S+)? +(\S+) % +\S+ % +(?:> )?(\S+) %", r.stdout, re.M)
    verdict("  all rows tell the supports, the largest drive a gap", len(rows) == 9 and all(float(row[1]) < 1 for row in rows) and float(rows[0][2]) >= 1000 and float(rows[-1][2]) < 2, told(r))
    put("light.ini", open(os.path.join(directory, "rig.ini")).read().replace("188 N", "5 N"))
    r = run("fit", "light.ini", "--plan")
    rows = re.findall(r"^  \S+ \S+(?: and \S+ \S+)? +(\S+) % .* without (\d+) points", r.stdout, re.M)
    verdict("  points that find no motion are left out of a row, and told", r.returncode == 0 and len(rows) == 9 and all(float(mass) < 1 and 0 < int(n) < 90 for mass, n in rows), told(r))
    for words in (("--plan", "--sweep", "small.csv"), ("--plan", "--out", "no.ini")):
        r = fit(*words)
        verdict("fit %s: refused" % " ".join(words), r.returncode == 2 and "--plan" in r.stderr and not exists("no.ini"), told(r))


def test_pictures():
    put("ring.csv", ring_text(record(400, 2e-4, 3e-6, 0, 0, 2e-8, 5)))
    r = fit("--sweep", "large.csv", "--ring", "ring.csv", "--hold", "mass=6.1 kg", "--svg", "fit.svg", "--report", "fit.html")
    svg, page = (open(os.path.join(directory, name)).read() if exists(name) else "" for name in ("fit.svg", "fit.html"))
    texts = [t.text for t in xml.etree.ElementTree.fromstring(svg or "<x/>").iter() if t.text]
    for words in ("amplitude of displacement at 3 N, down", "residuals, standard deviations", "chi^2 above its least, over preload", "profile"):
        verdict("--svg and --report: " + words, any(words in t for t in texts) and words in page, told(r))
    got = table(r.stdout)["preload"]
    bounds = re.search(r'"preload"[^]]*?"([0-9.]+) N"[^]]*?"([0-9.]+) N","([0-9.]+) N"', page)
    verdict("  the profile's interval of the preload is that of the slopes, to a tenth", bounds and
            abs((float(bounds[3]) - float(bounds[2])) / (2 * got[0] * got[1]) - 1) < 0.1, re.findall(r'"preload".{100}', page)[:3])


def test_sweep():
    run("sweep", "true.ini", "--sweep", "force.frequency=200:290:31", "--out", "rows.csv")
    r = run("fit", "rig.ini", "--sweep", "rows.csv")
    verdict("rows of contactplant sweep, up and down: the scene's numbers", r.returncode == 0 and "2 curves" in r.stdout and
            all(abs(table(r.stdout)[k][0] / TRUE[k] - 1) < 2e-3 for k in TRUE), told(r))


def test_refused():
    loud = rows_with(small, lambda f, a, p: ("%.9g" % f, "%.9g" % (a * (1 + 0.2 * math.sin(40 * f))), "%.9g" % p))
    put("loud.csv", loud)
    r = fit("--sweep", "loud.csv", "--hold", "preload=80 N", "--out", "no.ini")
    verdict("noise above what is said: chi^2, status 1, no file", r.returncode == 1 and "chi^2 per number" in r.stderr and not exists("no.ini"), told(r))
    r = fit("--sweep", "loud.csv", "--hold", "preload=80 N", "--out", "forced.ini", "--force")
    text = open(os.path.join(directory, "forced.ini")).read() if exists("forced.ini") else ""
    verdict("--force writes it, with the reason", r.returncode == 1 and "# NOT TO BE BELIEVED: chi^2" in text, told(r))
    turned = put("turned.csv", large.replace("direction = down", "direction = up"))
    r = fit("--sweep", "small.csv", "--sweep", turned, "--out", "no.ini")
    verdict("a curve on the other side of its jump", r.returncode == 1 and "wrong side" in r.stderr and not exists("no.ini"), told(r))
    scaled = rows_with(small.replace("amplitude = 0.3 N", "amplitude = 3 N"), lambda f, a, p: ("%.9g" % f, "%.9g" % (10 * a), "%.9g" % p))
    put("scaled.csv", scaled)
    r = fit("--sweep", "small.csv", "--sweep", "scaled.csv")
    verdict("a rig that answers in proportion is told not to be this plant", "the rig is not quite this plant" in r.stdout, told(r))
    for name, force in (("l1.csv", 0.3), ("l2.csv", 3)):
        put(name, linear(force))
    r = fit("--sweep", "l1.csv", "--sweep", "l2.csv", "--out", "linear.ini")
    verdict("a linear rig: refused", r.returncode == 1 and not exists("linear.ini"), told(r))


def linear(force):
    """A rig with a linear spring: F/(k - m w^2 + i w c)."""
    rows = ["# amplitude = %g N\n# output = displacement\n# noise = 1 %%\nfrequency_Hz,amplitude_m,phase_rad" % force]
    for i in range(52):
        w = 2 * math.pi * (150 + i / 51 * 170)
        y = force / (1.6e7 - 6.1 * w * w + 150j * w) * (1 + 0.01 * math.sin(12.9 * i * i) + 0.01j * math.sin(7.7 * i * i + force))
        rows.append("%.9g,%.9g,%.9g" % (w / 2 / math.pi, abs(y), cmath.phase(y)))
    return "\n".join(rows) + "\n"


HEAD = "# amplitude = 3 N\n# noise = 1 %\nfrequency_Hz,amplitude_m,phase_rad\n"
BAD = (
    ("empty file", "", 1, "no header"),
    ("no rows", HEAD, 3, "no data"),
    ("unit missing", HEAD.replace("amplitude_m,", "amplitude,") + "1,1,1\n", "3:14", "unit is missing"),
    ("unit of frequency missing", HEAD.replace("frequency_Hz", "frequency") + "1,1,1\n", "3:1", "unit is missing"),
    ("unit of another thing", HEAD.replace("amplitude_m,", "amplitude_kg,") + "1,1,1\n", "3:14", "no output has this unit"),
    ("NaN", HEAD + "200,1e-6,0\n210,nan,0\n", "5:5", "not a finite number"),
    ("infinite", HEAD + "200,1e-6,inf\n", "4:10", "not a finite number"),
    ("no number", HEAD + "200, 1e-6x,0\n", "4:6", "not a finite number"),
    ("empty cell", HEAD + "200,,0\n", "4:5", "empty cell"),
    ("doubled frequency", HEAD + "200,1e-6,0\n200,1e-6,0\n", "5:1", "twice"),
    ("unsorted", HEAD + "200,1e-6,0\n210,1e-6,0\n205,1e-6,0\n", "6:1", "not in order"),
    ("degrees unsaid", HEAD + "200,1e-6,-90\n", "4:10", "looks like degrees"),
    ("no header", HEAD.replace("frequency_Hz,amplitude_m,phase_rad\n", "200,1e-6,0\n"), "3:1", "name the columns above it"),
    ("too few cells", HEAD + "200,1e-6\n", "4:5", "the header has 3"),
    ("too many cells", HEAD + "200,1e-6,0,7\n", "4:12", "the header has 3"),
    ("semicolons", HEAD.replace(",", ";") + "200;1e-6;0\n", 3, "write commas"),
    ("amplitude unknown", HEAD.replace("# amplitude = 3 N\n", "") + "200,1e-6,0\n", 2, "amplitude of the drive is not known"),
    ("amplitude without unit", HEAD.replace("3 N", "3") + "200,1e-6,0\n", 1, "unit is missing"),
    ("amplitude 0", HEAD.replace("3 N", "0 N") + "200,1e-6,0\n", 1, "not above 0"),
    ("response 0", HEAD + "200,0,0\n", "4:5", "not above 0"),
    ("a key twice", "# noise = 2 %\n" + HEAD, 3, "noise is there twice"),
    ("unknown key", "# ampltude = 3 N\n" + HEAD, 1, "did you mean amplitude"),
    ("unknown output", "# output = displacment\n" + HEAD, 1, "did you mean displacement"),
    ("unknown input", "# input = forse\n" + HEAD, 1, "did you mean force"),
    ("unknown direction", "# direction = left\n" + HEAD, 1, "up or down"),
    ("column twice", HEAD.replace("phase_rad", "amplitude_m") + "1,1,1\n", "3:26", "twice"),
    ("one part of two", HEAD.replace("amplitude_m,phase_rad", "re_m_per_N") + "1,1\n", "3:14", "go together"),
    ("fewer numbers than unknowns", HEAD + "200,1e-6,0\n210,1e-6,0\n", None, "4 numbers for 4 unknowns"),
    ("a motion of another world", HEAD + "200,1e15,0\n210,2e15,0\n220,1e15,0\n", None, "bad.csv: displacement is 2e+15 m at most"),
    ("a motion that is none", HEAD + "200,1e-27,0\n210,2e-27,0\n220,1e-27,0\n", None, "is the unit right?"),
    ("a drive of another world", HEAD.replace("3 N", "3e21 N") + "200,1e-6,0\n210,1e-6,0\n220,1e-6,0\n", None, "amplitude is 3e+21 N at most"),
    ("a byte 0", HEAD + "200,1e-6\0,0\n", 4, "byte 0"),
    ("a long line", HEAD + "2" * 9000 + ",1,1\n", 4, "more than"),
)


def test_bad_data():
    for name, text, place, words in BAD:
        put("bad.csv", text)
        r = fit("--sweep", "bad.csv", "--out", "no.ini")
        at = "bad.csv:%s: " % place if place else ""
        verdict("bad data, %s: %s" % (name, words), r.returncode == 2 and r.stderr.count("\n") == 1 and at in r.stderr and words in r.stderr and not r.stdout and not exists("no.ini"), told(r))


def interrupt(words, begun):
    """Status, stdout and terminal of a command that gets Ctrl-C when `begun` stands on its terminal."""
    terminal, slave = os.openpty()
    p = subprocess.Popen([program, "fit", *words], stdout=subprocess.PIPE, stderr=slave, text=True, cwd=directory, preexec_fn=limit)
    os.close(slave)
    err = ""
    while begun not in err:
        err += os.read(terminal, 4096).decode()
    p.send_signal(signal.SIGINT)
    out, _ = p.communicate()
    try:
        while True:
            err += os.read(terminal, 4096).decode()
    except OSError:
        os.close(terminal)  # all is read
    return p.returncode, out, err


def test_interrupted():
    """Ctrl-C in the search and in profiles: what is left out is told, and the rest is there."""
    rows = record(18000, 2e-4, 3e-6, 2, 230, 2e-8, 5)
    put("long.csv", "# noise = 20 nm\ntime_s,displacement_m,force_N\n" + "".join("%.9g,%.9g,%.9g\n" % row for row in rows))
    status, out, err = interrupt(("rig.ini", "--series", "long.csv"), "looks for starts ")
    verdict("Ctrl-C in a run, before a start has ended: one line, status 1", status == 1 and not out and err.count("\n") == 1 and "nothing is found" in err, (status, out, err))
    status, out, err = interrupt(("rig.ini", "--series", "long.csv", "--out", "no.ini"), "fits from start ")
    verdict("  behind one: what was found is told, status 1, no file", status == 1 and "mass" in out and "interrupted after" in err and not exists("no.ini"), (status, out + err))
    verdict("  and the line of progress is cleared", re.search(r"of \d+ +\r {60}\rcontactplant fit: ", err), repr(err))
    status, out, err = interrupt(("rig.ini", "--sweep", "small.csv", "--sweep", "large.csv", "--svg", "cut.svg", "--out", "whole.ini"), "profiles ")
    verdict("Ctrl-C in profiles: told, status 1, picture and scene", status == 1 and re.search(r"interrupted: \d of 4 profiles are not whole", err) and "mass" in out and exists("cut.svg") and exists("whole.ini"), (status, out, err))


def test_bad_lines():
    for words, why in ((("--hold", "preload"), "NAME=VALUE"), (("--free", "mas"), "did you mean mass"), (("--free", "zz"), "scene; contactplant scene shows them"), (("--free", "mass,"), "commas between"), (("--free", "mass,mass"), "twice"),
                       (("--free", "mass", "--hold", "mass=6 kg"), "both"), (("--free", "force.amplitude"), "belongs to a drive"), (("--hold", "mass=6 N"), "does not fit"),
                       (("--free", "gain.forse"), "did you mean gain.force"), (("--out", "small.csv"), "read by this command"),
                       (("--sweep", "large.csv", "--sweep", "./small.csv"), "./small.csv has the data of small.csv once more"), (("--ring", "decay.csv", "--ring", "decay.csv"), "once more")):
        r = fit("--sweep", "small.csv", *words)
        verdict("fit %s: %s" % (" ".join(words), why), r.returncode == 2 and r.stderr.count("\n") == 1 and why in r.stderr, told(r))
    for words, why in ((("rig.ini",), "no data"), ((), "missing"), (("bbp-fig2-force", "--sweep", "small.csv"), "paper"), (("tapping", "--sweep", "small.csv"), "--thermal FILE and --curve"),
                       (("shaft_bearing", "--sweep", "small.csv"), "--free"), (("rig.ini", "--sweep", "none.csv"), "none.csv"), (("rig.ini", "--sweep", "."), "."),
                       (("tip", "--plan"), "or --hold sign=-1"), (("shaft", "--plan", "--free", "mass1"), "small force1 does not move penetration; give another observable")):
        r = run("fit", *words)
        verdict("fit %s: %s" % (" ".join(words), why), r.returncode == 2 and r.stderr.count("\n") == 1 and why in r.stderr, told(r))


for name in ("rig.ini", "small.csv", "large.csv", "decay.csv"):
    put(name, open(os.path.join(data, name)).read())
put("true.ini", open(os.path.join(data, "rig.ini")).read().replace("6.5 kg", "6.1 kg").replace("3.4e9", "3.9e9").replace("64 N", "80 N").replace("188 N", "150 N"))
for part in (test_numbers, test_forms, test_records, test_logs, test_ended_logs, test_levers, test_plant_levers, test_guide, test_bad_levers, test_plan, test_pictures, test_sweep, test_bad_data, test_bad_lines):
    part()
for part in (test_together, test_plant_logs, test_refused, test_interrupted) if "--all" in sys.argv else ():  # a minute more
    part()
subprocess.run(["rm", "-rf", directory])
conclude()
