#!/usr/bin/env python3
"""test_afm.py BUILD - contactplant test on a microscope: the examples' verdicts, their values beside closed forms, seeds, runs
equal to the byte, and one line for each mistake. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, verdict  # noqa: E402

build = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build")
root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
program = os.path.join(build, "contactplant")
F0, K, Q, K_B, RADIUS, HAMAKER, A0 = 70e3, 2.0, 400.0, 1.380649e-23, 10e-9, 6.4e-20, 0.165e-9  # of tapping


def near(name, got, wanted, absolute):
    verdict("%s: %.8g, reference %.8g" % (name, got, wanted), abs(got - wanted) <= absolute, "within %g" % absolute)


def test(*arguments):
    return subprocess.run([program, "test", *arguments], capture_output=True, text=True, cwd=directory, timeout=300)


def write(text, name="t.test"):
    with open(os.path.join(directory, name), "w") as f:
        f.write(text)
    return name


def values(name, case):
    """Of each expectation of a case by its metric, in SI."""
    test(name, "--case", case, "--json", "values.json")
    with open(os.path.join(directory, "values.json")) as f:
        found = json.load(f)["cases"][0]
    return {o["expect"].split(" ")[0]: o["value"] * {"ms": 1e-3, "kHz": 1e3}.get(o["unit"], 1.0) for o in found["expects"]}, found


def example(name):
    return os.path.join(root, "docs/examples", name + ".test")


def test_examples():
    wanted = {"afm_z": "ok FAIL ok", "afm_pll": "ok ok FAIL", "afm_dart": "ok FAIL", "afm_hop": "ok FAIL", "afm_peak": "ok FAIL ok"}
    for name, verdicts in wanted.items():
        r = test(example(name))
        found = re.findall(r"^(ok|FAIL|untested|error)  ", r.stdout, re.M)
        verdict("%s.test: %s" % (name, verdicts), r.returncode == 1 and found == verdicts.split(), r.stdout + r.stderr)


def test_z():
    tau = Q / (math.pi * F0)
    found, _ = values(example("afm_z"), "step down")
    near("parachuting: 2 Q/w0 + 44 nm/(ki 6 nm), s", found["longest_loss"], tau + 44e-9 / (275.0 * 6e-9), 0.03 * 28.49e-3)


def test_pll():
    found, _ = values(example("afm_pll"), "heat")
    density = F0 * K_B * 295.0 / (math.pi * K * 1e-16 * Q)
    rate, pole = 2.0 * Q / F0 * 50e3, 2.0 * math.pi * 2e3
    # noise bandwidth of L = a/(s (1 + s T)^2): a/(4 (1 - a T/2))
    expected = 0.25 * density * rate / (1.0 - 0.5 * rate / pole)
    near("heat: square of the frequency's noise in 1 s, Hz^2 s", found["ise"], expected, 4.0 * expected * math.sqrt(2.0 / rate))


def scan(folder, *more):
    swing = "--set peak_force=5e-9 --set ticks=2 --set quality=20 --set temperature=0 --set surface=0 --set lines=16 --set pixels=16".split()
    return subprocess.Popen([program, "scan", *swing, "--out", folder + "/images", "--volume", folder + "/curves", "--every", "4", *more],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=directory)


def contents(folder):
    found = {}
    for place, _, names in os.walk(os.path.join(directory, folder)):
        for name in names:
            with open(os.path.join(place, name), "rb") as f:
                found[os.path.relpath(os.path.join(place, name), os.path.join(directory, folder))] = f.read()
    return found


def test_volume():
    """A force volume: its list and a curve beside the law of the tip; a scan that is cut off goes on to the same bytes."""
    for folder in ("whole", "cut"):
        os.mkdir(os.path.join(directory, folder))
    whole = scan("whole")
    whole.wait(timeout=300)
    cut = scan("cut")
    while cut.poll() is None and not os.path.exists(os.path.join(directory, "cut/curves/curve_00004_00000.tab")):
        time.sleep(0.01)
    cut.send_signal(signal.SIGINT)
    cut.wait(timeout=300)
    again = scan("cut")
    _, told = again.communicate(timeout=300)
    verdict("a scan with curves that is cut off goes on", cut.returncode == 1 and again.returncode == 0 and "goes on in line" in told, told)
    verdict("  to the same bytes", contents("whole") == contents("cut") and len(contents("whole")) > 16, sorted(contents("whole")))
    rows = [r.split(",") for r in contents("whole")["curves/volume.csv"].decode().splitlines()]
    verdict("volume.csv: 16 curves", len(rows) == 17, rows[0])
    middle = dict(zip(rows[0], rows[10]))
    near("modulus, Pa", float(middle["modulus_Pa"]), 1e9, 2e7)
    near("adhesion H R/(6 a0^2), N", float(middle["adhesion_N"]), HAMAKER * RADIUS / (6 * A0 * A0), 0.01 * 3.918e-9)
    points = [line.split("\t") for line in contents("whole")["curves/" + middle["file"]].decode().splitlines() if not line.startswith("#")]
    forces = [float(p[0]) for p in points]
    near("a curve: points in a cycle of 2 kHz", len(points), 70e3 * 32 / 2e3, 0)
    near("a curve: half of it retracts", sum(p[4] == "True" for p in points), len(points) / 2, 0)
    depth = (0.75 * (float(middle["peak_force_N"]) + HAMAKER * RADIUS / (6.0 * A0 * A0)) / (1e9 * math.sqrt(RADIUS))) ** (2.0 / 3.0)
    near("a curve: deepest tip, a0 - indentation of the peak, m", min(float(p[6]) for p in points), A0 - depth, 0.02e-9)
    far = sum(forces[:100]) / 100
    near("a curve: far from the sample, N", far, 0.0, 0.3e-9)


def contact_resonance(modulus):
    """One mode, pressed with 20 nm k and the adhesion."""
    force = 20e-9 * K + HAMAKER * RADIUS / (6.0 * A0 * A0)
    depth = (0.75 * force / (modulus * math.sqrt(RADIUS))) ** (2.0 / 3.0)
    return F0 * math.sqrt(1.0 + 2.0 * modulus * math.sqrt(RADIUS * depth) / K)


def test_dart():
    found, _ = values(example("afm_dart"), "step of stiffness")
    near("DART: resonance on the first material, Hz", found["drive_frequency.max"], contact_resonance(1e9), 2e-4 * 197e3)
    near("  on the second one, off the target, Hz", found["steady_error"], abs(contact_resonance(1.2e9) - 207640.0), 2e-4 * 207e3)


def test_hop():
    """Without dissipation sin(lag) = A/A0: Cleveland et al. 1998."""
    with open(example("afm_hop")) as f:
        text = f.read()
    windows = "expect %s.mean >= 0 %s from 70 ms to 80 ms\n"
    text += windows % ("phase", "deg") + windows % ("amplitude", "m")
    before, _ = values(write(text), "hop")
    after, _ = values(write(text.replace("70 ms to 80 ms", "130 ms to 150 ms")), "hop")
    lag = lambda v: math.degrees(math.asin(v["amplitude.mean"] / 20e-9))
    near("hop: phase on the attractive branch, degrees", before["phase.mean"], lag(before) - 180.0, 0.3)
    near("  on the repulsive one", after["phase.mean"], -lag(after), 0.3)


PLANT = "[plant]\nmicroscope = tapping\n[controller]\nbuiltin = loops\n"


def test_runs():
    heat = "[plant]\nmicroscope = tapping\nz_loop = 0\n[controller]\nbuiltin = loops\n[case a]\nover = 5 ms\nexpect amplitude <= 1 um\n"
    hashes = [values(write(heat), "a")[1]["hash"] for _ in range(2)]
    verdict("equal runs, equal hash", hashes[0] == hashes[1] and hashes[0] != "0" * 16, hashes)
    other = values(write(heat + "seeds = 2..2\n"), "a")[1]["hash"]
    own = values(write(heat + "heat_seed = 1\n"), "a")[1]["hash"]
    verdict("seed 2 is the next sequence of the heat", other == own != hashes[0], (other, own))
    r = test(write(heat.replace("1 um", "1 nm") + "vary = drive 10 nm .. 0.5 nm in 3\n"))
    verdict("vary: the worst of 3 is judged", "2 of 3 runs" in r.stdout, r.stdout)
    logged = [test(write(heat), "--log", "logs") and open(os.path.join(directory, "logs/t.a.csv")).read() for _ in range(2)]
    header = logged[0].splitlines()[0]
    verdict("--log: rows with names, equal to the byte", logged[0] == logged[1] and header.startswith("time_s,amplitude_m,phase_deg,") and len(logged[0].splitlines()) == 352, header)
    r = test(write(PLANT + "[case a]\nover = 20 ms\nheight = 0 nm\nexpect contact_loss <= 100 %\nexpect z.min <= 0 nm\nat 1 ms set setpoint=10 nm\nat 5 ms set z_loop=0\nat 6 ms stream z 5 nm\nexpect z.change <= 0.1 pm from 7 ms\n"))
    verdict("set and stream on the way: a loop goes off, z is the stream's", r.returncode == 0, r.stdout + r.stderr)


STEADY_METRICS = ("amplitude.mean", "z.mean", "phase.mean")
STEADY = "hamaker = 0 J\nhamaker_out = 0 J\nexpect amplitude.mean <= 1 m from 30 ms\nexpect z.mean <= 1 m from 30 ms\nexpect phase.mean <= 360 deg from 30 ms\n"
MISTAKES = {  # what stands in the file, and what the line says
    "is no AFM lever": PLANT.replace("tapping", "hertz_rig") + "[case a]\n",
    "those of a microscope": PLANT.replace("microscope = tapping", "scene = hertz_rig") + "[case a]\n",
    "in the place of scene": "[plant]\nscene = hertz_rig\nmicroscope = tapping\n",
    "did you mean setpoint": PLANT + "[case a]\nsetpont = 3 nm\n",
    "did you mean amplitude": PLANT + "[case a]\nover = 1 ms\nexpect amplitud <= 1 nm\n",
    "no metric \"eigenfrequency\"": PLANT + "[case a]\nover = 1 ms\nexpect eigenfrequency <= 1 Hz\n",
    "out of range": PLANT + "[case a]\nki = -1\n",
    "is not below the free amplitude": PLANT + "[case a]\nover = 1 ms\nsetpoint = 30 nm\nexpect z <= 1 nm\n",
    "the sensor alone reads up to": PLANT.replace("tapping", "loud.ini") + "[case a]\nover = 1 ms\npeak_force = 5 nN\nticks = 2\nexpect z <= 1 nm\n",
    "rate and substeps are a bus's": PLANT + "[case a]\nover = 1 ms\nrate = 1 kHz\nexpect z <= 1 nm\n",
    "link and golden are a bus's": PLANT + "[case a]\nover = 1 ms\nlink = drop=0.1\nexpect z <= 1 nm\n",
    "has no arm and no faults": PLANT + "[case a]\nover = 1 ms\nat 0 s arm force amplitude=1 nN\nexpect z <= 1 nm\n",
    "builtin = loops has none": PLANT + "[case a]\nover = 1 ms\nexpect refused == 0\n",
    "the lever stays as it is": PLANT + "[case a]\nover = 1 ms\nat 0 s set quality=50\nexpect z <= 1 nm\n",
    "ticks cannot change": PLANT + "[case a]\nover = 1 ms\nat 0 s set ticks=8\nexpect z <= 1 nm\n",
    "must be a whole number": PLANT + "[case a]\nover = 1 ms\nsurface = 1.5\nexpect z <= 1 nm\n",
}


def test_mistakes():
    write("[plant]\nmodel = afm_lever\n[stage deflection]\npreset = photodiode\n", "loud.ini")
    for line, text in MISTAKES.items():
        r = test(write(text))
        verdict("a mistake: .. %s ..: one line, status 2" % line, r.returncode == 2 and r.stderr.count("\n") <= 2 and line in r.stderr, r.stderr + r.stdout)
    r = test(write(PLANT + "[case a]\nover = 1 ms\nexpect z <= 1 nm\n"), "--realtime")
    verdict("--realtime is refused", r.returncode == 2 and "a microscope is tested in lockstep" in r.stderr, r.stderr)
    r = test(write(PLANT + "[case a]\nover = 1 ms\nexpect impact_speed <= 1 m/s\n"))
    verdict("impact_speed is refused", r.returncode == 2 and "impact_speed" in r.stderr, r.stderr)


BUS = "[plant]\nmicroscope = tapping\n[controller]\ncommand = ./afm_height {plant} {me} {rate} {substeps}\n[case a]\nover = 10 ms\nexpect z <= 1 um\n"
COMMAND = BUS.split("\n")[3]
BUS_MISTAKES = {
    "1 to 4096 are allowed": BUS + "rate = 100 Hz\n",
    "setpoint_m is not below the free amplitude": BUS.replace("tapping", "tapping\nsetpoint = 30 nm"),
    "do not fit: setpoint_m is not below": BUS + "setpoint = 30 nm\n",
    "fewer than 4 samples": BUS + "substeps = 100\n",
    "scan must be 0 or 1": BUS.replace("tapping", "tapping\nscan = 0.5"),
    "silent tone": BUS.replace("tapping", "tapping\ndrive = 0 m"),
    "the lever stays as it is": BUS + "at 1 ms set quality=50\n",
    "no impact_speed, watch or residual": BUS + "expect residual <= 1 J\n",
    "scan, ramp_speed, ramp_dwell and settings": BUS.replace(COMMAND, "builtin = loops") + "at 1 ms set scan=1\n",
}


def test_bus():
    """A user's own z loop over the bus, the reference loops through it, a log that replays, and mistakes."""
    for name in ("word.h", "afm_height.c", "afm_height.test"):
        shutil.copy(os.path.join(root, "docs/examples", name), directory)
    c = subprocess.run([os.environ.get("CC", "cc"), "-O2", "afm_height.c", "-I" + root + "/host_sim/library", build + "/libcontactplant.a", "-lm", "-o", "afm_height"],
                       cwd=directory, capture_output=True, text=True)
    verdict("afm_height.c compiles", c.returncode == 0, c.stderr)
    r = test("afm_height.test")
    found = re.findall(r"^(ok|FAIL|untested|error)  ", r.stdout, re.M)
    verdict("afm_height.test: ok ok FAIL", r.returncode == 1 and found == "ok ok FAIL".split(), r.stdout + r.stderr)
    hashes = [values("afm_height.test", "step up")[1]["hash"] for _ in range(2)]
    verdict("equal runs over the bus, equal hash", hashes[0] == hashes[1], hashes)
    free = "[plant]\nmicroscope = tapping\nz_loop = 0\n[controller]\ncommand = ./afm_height {plant} {me} {rate} {substeps}\n[case a]\nover = 60 ms\nexpect amplitude.mean <= 14.2 nm from 55 ms\n"
    r = test(write(free), "--log", "bus")
    verdict("the loop finds the sample with the whole force", r.returncode == 0, r.stdout + r.stderr)
    own = [x for o in ("temperature_K=295", "height_m=14e-9", "z_loop=0") for x in ("--set", o)]
    r = subprocess.run([program, "replay", "bus/t.a.log", "microscope", "--substeps", "1120", *own], capture_output=True, text=True, cwd=directory)
    verdict("its log replays", r.returncode == 0 and "equal: " in r.stdout, r.stdout + r.stderr)
    loops, over = (values(write(text), "a")[0] for text in (BUS.replace(COMMAND, "builtin = loops").replace("10 ms", "40 ms") + STEADY, BUS.replace("10 ms", "40 ms") + STEADY))
    for what in STEADY_METRICS:
        near("reference loop over the bus and without: " + what, over[what], loops[what], 1e-6 * abs(loops[what]))
    for line, text in BUS_MISTAKES.items():
        r = test(write(text))
        verdict("a mistake: .. %s ..: one line, status 2" % line, r.returncode == 2 and r.stderr.count("\n") <= 2 and line in r.stderr, r.stderr + r.stdout)


def test_stages():
    """A scene's actuator is in the plant of a test, and its piezo in the microscope."""
    write("[plant]\nmodel = hertz_rig\n[stage force]\ngain = 0.5\n", "half.ini")
    case = "[controller]\nbuiltin = keep\n[case a]\nover = 1 s\nat 0.1 s arm force amplitude=%s N frequency=225 Hz ramp=0.1 s\nexpect displacement.rms <= 1 m from 0.5 s\n"
    full, _ = values(write("[plant]\nscene = hertz_rig\n" + case % 0.5), "a")
    half, _ = values(write("[plant]\nscene = half.ini\n" + case % 1), "a")
    near("half of 1 N by a stage moves as 0.5 N, m", half["displacement.rms"], full["displacement.rms"], 1e-3 * full["displacement.rms"])
    write("[plant]\nmodel = afm_lever\n[stage z]\nlag = 100 Hz\n", "slow.ini")
    text = "[plant]\nmicroscope = slow.ini\nz_loop = 0\nheight = 1 um\n[controller]\nbuiltin = loops\n[case a]\nover = 20 ms\nat 0 s stream z 10 nm\ntarget = z 10 nm within 5 %\nexpect settling <= 1 s\n"
    found, _ = values(write(text), "a")
    near("a piezo that lags: ln(20)/(2 pi 100 Hz), s", found["settling"], math.log(20.0) / (200.0 * math.pi), 1e-5)


with tempfile.TemporaryDirectory() as directory:
    for part in (test_examples, test_stages, test_z, test_pll, test_dart, test_volume, test_hop, test_runs, test_bus, test_mistakes):
        part()
conclude()
