#!/usr/bin/env python3
"""test_trial.py BUILD [SEEDS] - contactplant test: planted mistakes of controllers are found and a correct one is not accused,
metrics agree with simulate and with closed forms, runs are equal to the byte, and nothing is left behind. Prints `ok` and
`FAIL` lines and `N passed, N failed`."""
import cmath
import csv
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from processes import running  # noqa: E402
from verdicts import conclude, verdict  # noqa: E402

build = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build")
seeds = int(sys.argv[2]) if len(sys.argv) > 2 else 10
root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
program = os.path.join(build, "contactplant")
controller = os.path.join(root, "tests/trial/controller.py")
MASS, STIFFNESS, PRELOAD, DAMPING = 6.5, 3.4e9, 64.0, 188.0  # of hertz_rig


def near(name, got, wanted, relative):
    good = got is not None and abs(got - wanted) <= relative * max(abs(wanted), 1e-300)
    verdict("%s: %.10g" % (name, float("nan") if got is None else got), good, "wanted %.17g within %g of it" % (wanted, relative))


def path(name):
    return os.path.join(directory, name)


def write(name, text):
    with open(path(name), "w") as f:
        f.write(text)
    return path(name)


def read(name):
    with open(path(name), "rb") as f:
        return f.read()


def test(*arguments, cwd=None, prefix=()):
    r = subprocess.run([*prefix, program, "test", *arguments], capture_output=True, text=True, cwd=cwd or directory, timeout=300)
    r.lines = r.stdout.splitlines()
    r.verdicts = {line[10:34].strip(): line.split()[0] for line in r.lines if re.match(r"(ok|FAIL|untested|error) ", line)}
    return r


def values(*arguments):
    """Of each expectation by its text, and when it happened."""
    r = test(*arguments, "--json", path("values.json"))
    if r.returncode not in (0, 1):
        verdict("a file of this test is read", False, r.stderr + r.stdout)
    found = json.loads(read("values.json"))["cases"]
    return {o["expect"].split(" ")[0]: o for c in found for o in c["expects"]}, found


def file_of(bug, cases, scene="hertz_rig", name="t.test"):
    head = "[plant]\nscene = %s\n[controller]\ncommand = /usr/bin/python3 %s {plant} {me} %s\n" % (scene, controller, bug)
    return write(name, head + cases)


def damped(bug):
    with open(os.path.join(root, "tests/trial/damped.test")) as f:
        return write(bug + ".test", f.read().replace("CONTROLLER", controller).replace("BUG", bug))


def left():
    """Processes of these tests that still run."""
    return running(lambda line: controller.encode() in line or b"sleep\x001001" in line)


# ---- mistakes of controllers ----

BUGS = {  # what the verdict of at least one case must be
    "sign": "error", "wind-up": "FAIL", "one-frame-late": "error", "no-heartbeat": "FAIL", "wrong-unit": "FAIL", "nan": "FAIL",
    "stuck-value": "FAIL", "stuck-counter": "FAIL", "late-stream": "FAIL", "wrong-session": "FAIL", "no-stop": "FAIL", "crash": "error",
    # beyond the twelve
    "exit": "error", "exit-at-once": "error", "silent": "error", "mute": "error", "garbage": "FAIL", "flood": "FAIL",
    "children": "error", "daemon": "error",
}
REASONS = {"crash": "last line: RuntimeError: as it was to be", "exit-at-once": "before plant time ran: it ended with status 0",
           "silent": "no word of 127.", "garbage": "malformed == 0", "children": "left 3 processes behind", "daemon": "left 3 processes",
           "late-stream": "late)", "stuck-counter": "repeated)", "wrong-session": "session)", "nan": "range)", "no-heartbeat": "timeouts == 0"}


def test_bugs():
    for bug in ("none", "slow", "chatty", "deaf"):
        r = test(damped(bug))
        verdict("%s: both cases ok, status 0" % bug, r.returncode == 0 and r.verdicts == {"damped": "ok", "overload": "ok"}, r.stdout + r.stderr)
    for bug, wanted in BUGS.items():
        r = test(damped(bug), "--patience", "2")
        status = 3 if "error" in r.verdicts.values() else 1
        good = wanted in r.verdicts.values() and r.returncode == status and REASONS.get(bug, "") in r.stdout and len(r.verdicts) == 2
        verdict("%s: %s, status %d" % (bug, wanted, status), good, r.stdout + r.stderr)
    verdict("no process is left", not left(), left())


def test_seeds():
    r = test(file_of("none", "[case bad link]\nover = 0.5 s\nlink = in.delay=0.05:3,out.delay=0.05:3,duplicate=0.02\nseeds = 1..%d\n"
                     "at 0.1 s arm force amplitude=1 N frequency=225 Hz ramp=0.2 s\nexpect refused <= 200\nexpect contact_loss == 0 %%\n"
                     % seeds))
    verdict("a correct controller on a bad link, %d seeds: no false alarm" % seeds, r.returncode == 0, r.stdout)


def test_examples():
    examples = {"keep": 4, "damp": 2, "track": 3, "detune": 2, "avoid": 2}  # and their cases
    for name in ["word.h", "keep_faults.test"] + [x + end for x in examples for end in (".c", ".test")]:
        shutil.copy(os.path.join(root, "docs/examples", name), directory)
    with open(path("avoid.c")) as f:  # one that never turns back
        write("naive.c", f.read().replace("smallest_m > 0.5 * rest_m", "smallest_m > -9.0 * rest_m"))
    for name in [*examples, "naive"]:
        c = subprocess.run([os.environ.get("CC", "cc"), "-O2", name + ".c", "-I" + root + "/host_sim/library", build + "/libcontactplant.a", "-lm", "-o", name],
                           cwd=directory, capture_output=True, text=True)
        verdict(name + ".c compiles", c.returncode == 0, c.stderr)
    for name, n in (*examples.items(), ("keep_faults", 2)):
        r = test(name + ".test")
        if name != "damp":
            verdict("%s.test: %d cases ok" % (name, n), r.returncode == 0 and len(r.verdicts) == n, r.stdout + r.stderr)
    for name, case in (("track", "finds it"), ("damp", "fast enough"), ("detune", "disturbed")):
        with open(path(name + ".test")) as f:  # where the link takes the first MOTIONs away, the plant's CONTACTs come alone
            late = f.read() + "\n[case late motion]\nlike = %s\nmotion_every = 50\nat 0.02 s set motion_every=1\n" % case
        r = test(write("late.test", late), "--case", "late motion", "--log", path("late_" + name))
        streams = re.findall(rb" 20[4-7]#\w{8}(\w{8})\n", read("late_%s/late.late_motion.log" % name))
        verdict("%s: no MOTION before 0.02 s, and no sample that is no number" % name,
                r.returncode == 0 and not [x for x in streams if math.isnan(struct.unpack("<f", bytes.fromhex(x.decode()))[0])], r.stdout + r.stderr)
    shutil.copy(path("naive"), path("avoid"))
    r = test("avoid.test")
    verdict("a sweep that never turns back loses contact: FAIL", r.returncode == 1 and r.stdout.count("expect contact_loss == 0 %: it was") == 2, r.stdout)
    r = test("damp.test")
    verdict("damp.test: ok at 4 kHz, FAIL at 1 kHz", r.returncode == 1 and r.verdicts == {"fast enough": "ok", "too slow": "FAIL"}, r.stdout)
    cases = "[case swing]\nover = 10 s\nat 0.1 s arm force amplitude=3 N frequency=225 Hz ramp=1 s\nexpect command_force.change <= 0.05 N from 7 s\nexpect contact_loss == 0 % from 2 s\n"
    r = test(write("control.test", "[plant]\nscene = hertz_rig\n[controller]\ncommand = {contactplant} control --lockstep --bus udp:{me} --peer {plant} --duration 1000 --force 0\n" + cases))
    verdict("control settles at 3 N and 225 Hz", r.returncode == 0, r.stdout + r.stderr)


def test_controllers():
    """One that the program has, and one that connects by itself; both keep contact as keep.c does."""
    with open(path("keep.test")) as f:
        keep = f.read()
    hashes = lambda r: [line[-16:] for line in r.lines if line.startswith("ok ")]
    quiet, both = hashes(test("keep.test", "--case", "quiet")), ("--case", "quiet", "--case", "shaken")
    r = test(write("builtin.test", re.sub("command = .*", "builtin = keep", keep)), *both, "--case", "light mass")
    verdict("builtin = keep: ok", r.returncode == 0 and len(r.verdicts) == 3, r.stdout + r.stderr)
    verdict("  where neither presses, both leave the same plant", hashes(r)[:1] == quiet, (quiet, r.stdout))
    write("changed.test", re.sub("command = .*", "builtin = keep", keep).replace("[controller]", "mass = 6 kg\nrate = 2 kHz\nsubsteps = 32\n[controller]"))
    r = test("changed.test", "--case", "quiet")
    verdict("  it hears of the values of [plant]", r.returncode == 0, r.stdout + r.stderr)
    here = "127.71.%d.%d" % (os.getpid() >> 8 & 255, os.getpid() & 255)
    where = ("--bus", "udp:%s:20000" % here, "--controller", here + ":20001")
    write("attach.test", re.sub("command = .*", "attach", keep))
    with subprocess.Popen([program, "test", "attach.test", *both, "--patience", "20", *where], cwd=directory, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as p:
        while p.poll() is None:
            with subprocess.Popen(["./keep", here + ":20000", here + ":20001", "1000", "64"], cwd=directory, stderr=subprocess.DEVNULL) as keeper:
                while keeper.poll() is None and p.poll() is None:
                    time.sleep(0.01)
                keeper.kill()  # one that came after the last case waits for a plant
        out, told = p.communicate()
    verdict("attach: a controller that connects anew for each case", p.returncode == 0 and out.count("ok  ") == 2 and quiet[0] in out, out + told)
    verdict("  is told where", told.count(here + ":20001") == 2, told)
    r = test("attach.test", "--case", "quiet", "--patience", "0.3", *where)
    verdict("  and one that does not come is an error", r.returncode == 3 and "no word of %s:20001" % here in r.stdout, r.stdout)
    r = test("keep.test", "--controller", "127.0.0.1:20001")
    verdict("  addresses need it", r.returncode == 2 and "attach in [controller]" in r.stderr, r.stderr)


# ---- equal to the byte ----

def test_bytes():
    name = damped("none")
    logs = []
    for i, more in enumerate((["--cores", "1"], ["--cores", "2"])):
        test(name, "--log", path("log%d" % i), *more)
        logs.append(read("log%d/none.damped.log" % i) + read("log%d/none.overload.log" % i))
    verdict("two runs, one core and two: equal logs", len(logs[0]) > 100000 and logs[0] == logs[1])
    sleepy = damped("sleepy")
    with subprocess.Popen([program, "test", sleepy, "--log", path("log2"), "--patience", "0"], cwd=directory, stdout=subprocess.PIPE, text=True) as p:
        woken = 0
        while p.poll() is None:
            for pid, line in left():
                try:
                    with open("/proc/%s/stat" % pid) as f:
                        stopped = f.read().rsplit(")", 1)[1].split()[0] == "T"
                except OSError:
                    continue
                if stopped and b"python3" in line:
                    time.sleep(1.0)
                    os.kill(int(pid), signal.SIGCONT)
                    woken += 1
            time.sleep(0.05)
    same = read("log2/sleepy.damped.log") == read("log0/none.damped.log")
    verdict("a controller that was stopped for a second: the same log", woken >= 1 and same, woken)
    hashes = [re.findall(r"hash (\w+)", test(name).stdout) for _ in range(2)]
    verdict("equal hashes", hashes[0] == hashes[1] and len(hashes[0]) == 2, hashes)
    r = test(file_of("none", "[case a]\nover = 0.2 s\nexpect hash == 0123456789abcdef\n"))
    found = re.search(r"it was (\w{16})", r.stdout).group(1)
    r = test(file_of("none", "[case a]\nover = 0.2 s\nexpect hash == %s\n" % found))
    verdict("a hash that is expected", r.returncode == 0, r.stdout)


# ---- metrics against simulate, another way through the code, and sums of its rows in Python ----

def trapezoid(t, y):
    return sum((t[i + 1] - t[i]) * (y[i] + y[i + 1]) / 2 for i in range(len(t) - 1))


def rows_of(name):
    with open(path(name)) as f:
        return list(csv.DictReader(f))


def inside_loss(at, tick):
    """The end of a tick about in the middle of the loss of contact after `at`: a window that begins or ends there cuts it."""
    events = [float(r["t"]) for r in rows_of("events.csv")]
    lifted = next(i for i in range(0, len(events), 2) if events[i] > at)
    return round((events[lifted] + events[lifted + 1]) / 2 / tick) * tick


def test_simulated():
    tick = 1e-3 / 64
    scene = write("loss.ini", "[plant]\nmodel = hertz_rig\nmethod = rk4\n[drive force]\namplitude = 20 N\nfrequency = 225 Hz\n"
                  "[ask]\nover = 0.5 s\n[deadline]\nframe = 1 ms\nsubsteps = 64\n")
    subprocess.run([program, "simulate", scene, "--out", path("rows.csv"), "--events", path("events.csv"), "--every", repr(tick), "--step", repr(tick)], check=True)
    start, end = [inside_loss(at, tick) for at in (0.1, 0.45)]
    window = "from %r s to %r s" % (start, end)
    rows = [r for r in rows_of("rows.csv") if start - tick / 4 <= float(r["t"]) <= end + tick / 4]
    t, z, v = [[float(r[k]) for r in rows] for k in ("t", "penetration", "velocity")]
    statistics = ["min", "max", "mean", "rms", "change", "effort"]
    lines = ["expect %s.%s >= 0 %s %s" % (s, m, u + (" s" if m == "effort" else ""), window)
             for s, u in (("penetration", "m"), ("velocity", "m/s")) for m in statistics]
    units = {"contact_loss": "%", "lift_offs": "", "touchdowns": "", "last_loss": "s", "longest_loss": "s", "peak_force": "N", "impact_speed": "m/s"}
    lines += ["expect %s >= 0 %s %s" % (*x, window) for x in units.items()]
    lines += ["target = penetration 5 um within 1 um"]
    lines += ["expect %s >= 0 %s %s" % (*x, window) for x in (("iae", "m s"), ("ise", "m^2 s"), ("itae", "m s^2"), ("steady_error", "m"), ("overshoot", "%"))]
    found, _ = values(file_of("idle", "[case a]\nover = 0.5 s\n" + "\n".join(lines) + "\n", scene="loss.ini"))
    length = t[-1] - t[0]
    for s, x in (("penetration", z), ("velocity", v)):
        wanted = {"min": min(x), "max": max(x), "mean": trapezoid(t, x) / length, "rms": math.sqrt(trapezoid(t, [a * a for a in x]) / length),
                  "change": max(x) - min(x), "effort": trapezoid(t, [abs(a) for a in x])}
        for m in statistics:
            near("%s.%s against rows of simulate" % (s, m), found[s + "." + m]["value"], wanted[m], 1e-9)
    e = [a - 5e-6 for a in z]
    tail = [i for i in range(len(t)) if t[i] >= t[0] + 0.9 * length - tick / 4]
    near("iae", found["iae"]["value"], trapezoid(t, [abs(a) for a in e]), 1e-9)
    near("ise", found["ise"]["value"], trapezoid(t, [a * a for a in e]), 1e-9)
    near("itae", found["itae"]["value"], trapezoid(t, [(t[i] - t[0]) * abs(e[i]) for i in range(len(t))]), 1e-9)
    near("steady_error", found["steady_error"]["value"], abs(trapezoid([t[i] for i in tail], [e[i] for i in tail]) / (t[tail[-1]] - t[tail[0]])), 1e-9)
    way = 5e-6 - z[0]
    near("overshoot", found["overshoot"]["value"], 100 * max(0.0, max((a - 5e-6) / way for a in z)), 1e-9)
    check_events(found, start, end)
    landed = [float(r["t"]) for r in rows_of("events.csv") if r["kind"] == "touchdown"]
    lifted = [float(r["t"]) for r in rows_of("events.csv") if r["kind"] == "liftoff" and start <= float(r["t"]) <= end]
    first = max([x for x in landed if x < lifted[0]])
    peak = max(float(r["penetration"]) for r in rows_of("rows.csv") if first <= float(r["t"]) <= lifted[-1])
    near("peak_force: stiffness z^1.5 of the rows", found["peak_force"]["value"], STIFFNESS * peak ** 1.5, 1e-3)


def check_events(found, start, end):
    events = [(float(r["t"]), r["kind"] == "touchdown", abs(float(r["velocity"]))) for r in rows_of("events.csv")]
    inside = [x for x in events if start <= x[0] <= end]
    losses, opened = [], None
    for at, touch, _ in events + [(end, True, 0.0)]:
        if not touch:
            opened = at
        elif opened is not None:
            losses.append((max(opened, start), min(at, end)))
            opened = None
    losses = [x for x in losses if x[1] > x[0]]
    verdict("contact is lost often: %d times" % len(losses), len(losses) > 20)
    near("contact_loss by events", found["contact_loss"]["value"], 100 * sum(b - a for a, b in losses) / (end - start), 1e-9)
    near("longest_loss", found["longest_loss"]["value"], max(b - a for a, b in losses), 1e-9)
    near("last_loss", found["last_loss"]["value"], losses[-1][1], 1e-9)
    near("touchdowns", found["touchdowns"]["value"], sum(x[1] for x in inside), 0)
    near("lift_offs", found["lift_offs"]["value"], sum(not x[1] for x in inside), 0)
    near("impact_speed", found["impact_speed"]["value"], max(x[2] for x in inside if x[1]), 1e-9)
    near("  when", found["impact_speed"]["at_s"], max((x[2], x[0]) for x in inside if x[1])[1], 1e-12)


# ---- metrics against closed forms: the linear rig ----

REST = (PRELOAD / STIFFNESS) ** (2 / 3)
SPRING = 1.5 * PRELOAD / REST
NATURAL = math.sqrt(SPRING / MASS)
RATIO = DAMPING / (2 * MASS * NATURAL)


def test_step():
    """A force step of 5 N at 0.1 s; the textbook's second-order system."""
    way, band = 5.0 / SPRING, 0.02
    target = REST + way
    cases = ("[case step]\nover = 1.5 s\nat 0.1 s arm force amplitude=5 N frequency=0 Hz\ntarget = displacement %.17g m within %.17g m\n"
             % (target, band * way) + "".join("expect %s >= 0 %s from 0.1 s\n" % x for x in (
                 ("overshoot", "%"), ("settling", "s"), ("ise", "m^2 s"), ("steady_error", "m"), ("iae", "m s"), ("itae", "m s^2"))))
    found, _ = values(file_of("idle", cases, scene="hertz_rig_linear"))
    root_ = math.sqrt(1 - RATIO ** 2)
    damped_rate = NATURAL * root_
    near("overshoot of a linear rig: 100 exp(-pi zeta / sqrt(1 - zeta^2)) %", found["overshoot"]["value"], 100 * math.exp(-math.pi * RATIO / root_), 1e-3)
    near("ise: way^2 (1 + 4 zeta^2) / (4 zeta omega)", found["ise"]["value"], way ** 2 * (1 + 4 * RATIO ** 2) / (4 * RATIO * NATURAL), 1e-3)
    dt = 1e-6
    error = [math.exp(-RATIO * NATURAL * i * dt) * (math.cos(damped_rate * i * dt) + RATIO / root_ * math.sin(damped_rate * i * dt)) for i in range(1400000)]
    near("settling: the closed form's last leaving of the band", found["settling"]["value"], max(i for i, e in enumerate(error) if abs(e) > band) * dt, 1e-3)
    near("iae: sum of the closed form", found["iae"]["value"], way * dt * sum(abs(e) for e in error), 1e-3)
    near("itae", found["itae"]["value"], way * dt * sum(i * dt * abs(e) for i, e in enumerate(error)), 1e-3)
    verdict("steady_error: none", found["steady_error"]["value"] < 1e-6 * way, found["steady_error"])


def ramp_response(t):
    """Of the linear rig at rest to a force of 1 N per second from t = 0 on, in metres."""
    if t <= 0.0:
        return 0.0
    s = complex(-RATIO * NATURAL, NATURAL * math.sqrt(1 - RATIO ** 2))  # a pole; the other one is its conjugate
    return t / SPRING - DAMPING / SPRING ** 2 + 2 * (cmath.exp(s * t) / (MASS * s ** 2 * (s - s.conjugate()))).real


def onset(force_N, at, found_m):
    """When a force that rises within a tick must have begun for this displacement at `at`, by bisection of the closed form."""
    tick, early, late = 1e-3 / 64, at - 3e-3, at
    for _ in range(60):
        t = 0.5 * (early + late)
        x = force_N / tick * (ramp_response(at - t) - ramp_response(at - t - tick))
        early, late = (t, late) if x > found_m else (early, t)
    return 0.5 * (early + late)


def test_fire():
    """arm and fire: a force step begins at its very instant, by the displacement a frame later."""
    tick = 1e-3 / 64
    for name, ticks in (("at a frame's begin", 19200), ("at a tick", 19217), ("inside a tick", 19217 + 0.37), ("late in a frame's last tick", 19263 + 0.996),
                        ("at time 0", 0), ("inside the first tick", 0.5)):
        begin, seen = ticks * tick, (math.ceil(ticks) + 64) * tick
        cases = ("[case a]\nover = 0.5 s\nat 0 s arm force amplitude=7 N\nat 0 s arm force amplitude=5 N frequency=0 Hz\nat %.12g s fire force\n"
                 "expect displacement.max >= 0 m from %.12g s to %.12g s\nexpect displacement.change >= 0 m to %.12g s\n"
                 % (begin, seen - tick, seen, max(begin, tick)))
        found, _ = values(file_of("idle", cases, scene="hertz_rig_linear"))
        got = onset(5.0, seen, found["displacement.max"]["value"] - REST)
        verdict("fire %s: the force begins there to a 256th of a tick: %.4f of %.4f" % (name, got / tick, ticks), abs(got - begin) <= tick / 256, (got / tick, ticks))
        verdict("  and not before", ticks < 1 or found["displacement.change"]["value"] < 1e-15, found["displacement.change"])
    cases = ("[case a]\nover = 0.5 s\nat 0.1 s arm force amplitude=5 N frequency=0 Hz\nat 0.3003 s fire force\nat 0.1 s arm base amplitude=1 um frequency=0 Hz\n"
             "at 0.3005 s fire base\nat 0.35 s arm force amplitude=0\nat 0.4 s fire force\nexpect drive_frequency.max <= 0 Hz\nexpect displacement.max >= 0 m to 0.29 s\n"
             "expect displacement.mean >= 0 m from 0.39 s to 0.4 s\n[case twice]\nlike = a\nat 0.45 s arm force amplitude=9 N\nat 0.46 s fire force\n")
    r = test(file_of("idle", cases, scene="hertz_rig_linear"), "--json", path("f.json"))
    verdict("two inputs in one frame, twice, and by like", r.returncode == 0 and len(r.verdicts) == 2, r.stdout + r.stderr)
    cases = ("[case a]\nover = 0.5 s\nat 0.1 s arm fast_force amplitude=%s N frequency=100 Hz\nat 0.3003 s fire fast_force\nexpect penetration >= 0 um\n")
    hashes = [re.findall(r"hash (\w+)", test(file_of("none", cases % x)).stdout) for x in ("5", "5", "6")]
    verdict("fire beside a controller that streams: equal hashes", hashes[0] == hashes[1] != hashes[2] and len(hashes[0]) == 1, hashes)
    case = ("[case a]\nover = 1 s\nreaction = 0\nat 0.1 s arm force amplitude=5 N frequency=0 Hz\nat %.12g s fire force\n"
            "expect timeouts == 1\nexpect displacement.change <= 0.01 um to %.12g s\nexpect displacement.change >= 0.2 um from %.12g s\nexpect refused >= 0\n")
    lapse = lambda at: test(file_of("no-heartbeat", case % (at, at, at)), "--json", path("l.json"))
    r = lapse(0.9)
    verdict("fire after a time-out that lets plant time run on", r.returncode == 0, r.stdout + r.stderr)
    end = json.loads(read("l.json"))["cases"][0]["expects"][0]["at_s"]
    r = lapse(end - 10.5 * tick)
    verdict("  in the frame of it: forgotten, which is an error", r.returncode == 3 and "forgot it" in r.stdout, (end, r.stdout))
    cases = "[case a]\nover = 0.4 s\n" + "".join("at 0.1 s arm %s amplitude=%s frequency=20 Hz\nat 0.3002 s fire %s\nat 0.3003 s arm %s amplitude=%s\nat 0.3004 s fire %s\n" % ((i, a, i) * 2)
                                               for i, a in (("force", "1 N"), ("fast_force", "1 N"), ("base", "1 nm"))) + "expect refused == 0\n"
    r = test(file_of("idle", cases))
    verdict("more fires in a frame than FIRE has room for: an error", r.returncode == 3 and "4 fires waiting" in r.stdout, r.stdout + r.stderr)


def test_response():
    """Steady state at 200 Hz: amplitude and phase of the transfer function."""
    omega = 2 * math.pi * 200
    h = 2.0 / complex(SPRING - MASS * omega ** 2, DAMPING * omega)
    cases = "[case a]\nover = 2.5 s\nat 0 s arm force amplitude=2 N frequency=200 Hz phase=0.3\nlockin = 200 Hz\n" + "".join(
        "expect %s >= 0 %s from 2 s\n" % x for x in (("displacement.amplitude", "m"), ("displacement.phase", "deg"), ("velocity.amplitude", "m/s"), ("displacement.mean", "m")))
    cases += "expect eigenfrequency.mean >= 0 Hz\nexpect drive_frequency.mean >= 0 Hz from 1 s\n"
    found, _ = values(file_of("idle", cases, scene="hertz_rig_linear"))
    near("eigenfrequency", found["eigenfrequency.mean"]["value"], NATURAL / (2 * math.pi), 1e-9)
    near("drive_frequency", found["drive_frequency.mean"]["value"], 200, 1e-9)
    near("amplitude at 200 Hz: transfer function", found["displacement.amplitude"]["value"], abs(h), 1e-4)
    near("phase", found["displacement.phase"]["value"], math.degrees(math.atan2(h.imag, h.real) + 0.3), 1e-3)
    near("amplitude of the velocity", found["velocity.amplitude"]["value"], abs(h) * omega, 1e-4)
    near("mean: at rest", found["displacement.mean"]["value"], REST, 1e-6)


def test_response_beside():
    """The response to one drive beside another one that is twenty times as strong, in a window of 1.7 beats; it is
    not told in one of half a beat."""
    omega = 2 * math.pi * 43.7
    h = 2.0 / complex(SPRING - MASS * omega ** 2, DAMPING * omega)
    cases = ("[case a]\nover = 2.6 s\nat 0 s arm force amplitude=2 N frequency=43.7 Hz\nat 0.1 s arm fast_force amplitude=40 N frequency=51 Hz\n"
             "lockin = 43.7 Hz\nexpect displacement.amplitude >= 0 m from 2.3 s to 2.54 s\nexpect displacement.phase >= -180 deg from 2.3 s to 2.54 s\n")
    found, _ = values(file_of("idle", cases, scene="hertz_rig_linear"))
    near("amplitude: transfer function", found["displacement.amplitude"]["value"], abs(h), 1e-4)
    near("phase, deg", found["displacement.phase"]["value"] + 360, math.degrees(math.atan2(h.imag, h.real)) + 360, 1e-5)
    found, case = values(file_of("idle", cases.replace("2.54 s", "2.37 s"), scene="hertz_rig_linear"))
    verdict("half a beat tells nothing", case[0]["verdict"] == "untested" and found["displacement.amplitude"]["value"] is None, case)
    found, case = values(file_of("idle", cases.replace("lockin = 43.7 Hz", "lockin = 63956.3 Hz"), scene="hertz_rig_linear"))
    verdict("nor does a frequency whose samples at the ticks are those of another", case[0]["verdict"] == "untested" and "half the rate" in found["displacement.amplitude"]["found"], case)


def test_counters():
    """Those of the controller: this many frames from its bug on."""
    cases = "[case a]\nover = 1 s\nat 0.1 s arm force amplitude=1 N frequency=200 Hz\n" + "".join("expect %s >= 0\n" % x for x in ("refused", "late", "missed", "lost", "malformed", "timeouts", "faults", "watch"))
    cases += "expect silence >= 0 s\nexpect residual <= 1 mJ\nexpect late >= 0 from 0.6 s\n"
    _, found = values(file_of("late-stream", cases))
    late = [o["value"] for o in found[0]["expects"] if o["metric"] == "late"]
    verdict("late: 500 of the last 0.5 s, 400 of the last 0.4 s", late == [500, 400], late)
    by = {o["metric"]: o["value"] for o in found[0]["expects"]}
    verdict("missed: those too", by["missed"] == 500 and by["refused"] == 500, by)
    near("silence: a heartbeat each 10 frames", by["silence"], 9e-3, 0.12)
    verdict("residual: small, not 0", 0 < by["residual"] < 1e-3, by)


def test_counts():
    """The other counters, against the log and against what the bug does, frame by frame."""
    value = lambda bug, lines, scene="hertz_rig": {o["metric"]: o for o in values(file_of(bug, "[case a]\nover = 1 s\n" + lines, scene=scene), "--log", path("counts"))[1][0]["expects"]}
    lines = "expect lost >= 0\nexpect missed >= 0\nexpect refused >= 0\nexpect timeouts >= 0\n"
    lost = value("none", "at 0.2 s faults in.drop=0.1\n" + lines)["lost"]["value"]
    counter, gaps = {}, 0
    for kind, data in re.findall(rb" 2(0[0-9A-F])#(\w+)\n", read("counts/t.a.log")):
        seen = int(data[3:4], 16)  # COUNTER: bits 8 to 11
        gaps += (seen - counter.get(kind, seen - 1) - 1) % 15  # it runs from 0 to 14
        counter[kind] = seen
    verdict("lost: the gaps of COUNTER in the log, %d" % gaps, lost == gaps and gaps > 50, lost)
    found = value("garbage", lines + "expect malformed >= 0\n")
    verdict("malformed: a datagram in each of the last 500 frames", abs(found["malformed"]["value"] - 500) <= 1, found["malformed"])
    found = value("no-heartbeat", lines)
    stamps = lambda kind: [float(x) for x in re.findall(rb"\((\d+\.\d+)\) udp 2%s#\w+\n" % kind, read("counts/t.a.log"))]
    due = stamps(b"01")[-1] - stamps(b"02")[0] + 0.102  # 100 frames without one, the frame of the heartbeat, and that of the reaction
    verdict("timeouts: one, 100 frames after the last heartbeat of the log", found["timeouts"]["value"] == 1 and abs(found["timeouts"]["at_s"] - due) < 1e-6, (due, found["timeouts"]))
    found = value("none", "at 0.5 s arm force amplitude=100 N frequency=225 Hz ramp=0.2 s\nexpect stopped >= 0 s\nexpect refused >= 0\n")
    r = subprocess.run([program, "decode", path("counts/t.a.log")], capture_output=True, text=True)
    forces = [(float(x["t_s"]), float(x["contact_force [N]"] or 0.0)) for x in csv.DictReader(r.stdout.splitlines())]
    above = next((at for at, f in forces if abs(f) > 200.0), -1.0)
    verdict("stopped: as soon as a CONTACT of the log has more than 200 N", 0.0 <= found["stopped"]["value"] - above <= 1.1e-3, (found["stopped"], above))
    head = "[plant]\nmodel = hertz_rig\nmethod = rk4\n[drive force]\namplitude = 5 N\nfrequency = 100 Hz\n"
    scene = write("watched.ini", head + "[watch]\nobservable = displacement\nabove = 7.4 um\n[ask]\nover = 1 s\n[deadline]\nframe = 1 ms\nsubsteps = 64\n")
    tick = 1e-3 / 64
    subprocess.run([program, "simulate", scene, "--out", path("rows.csv"), "--every", repr(tick), "--step", repr(tick)], check=True)
    x = [float(row["position"]) for row in rows_of("rows.csv")]
    left_it = sum(a < 7.4e-6 <= b for a, b in zip(x, x[1:]))
    found = value("idle", "expect watch >= 0\n", scene="watched.ini")
    verdict("watch: each way out of the limits, %d in the rows of simulate" % left_it, found["watch"]["value"] == left_it and left_it > 20, found["watch"])
    found = value("idle", "at 0.5 s set ledger_alarm=1e-9\nat 0.5 s arm force amplitude=20 N frequency=225 Hz\nexpect faults >= 0\n")
    verdict("faults: an energy alarm that no run can keep is one", found["faults"]["value"] == 1 and found["faults"]["at_s"] > 0.5, found["faults"])


def test_stream_and_faults():
    """A sample that stays: the linear rig's static answer. A link that is dead for 40 frames: so many samples are missing."""
    cases = ("[case a]\nover = 2 s\nat 0.2 s stream force 5 N\nexpect displacement.mean >= 0 m from 1.9 s\nexpect command_force.min >= 5 N from 0.21 s\n"
             "expect command_force.max <= 0 N to 0.19 s\n")
    r = test(file_of("idle", cases, scene="hertz_rig_linear"), "--json", path("s.json"))
    verdict("stream: the sample holds from its time on", r.returncode == 0, r.stdout + r.stderr)
    near("  displacement: force / stiffness", json.loads(read("s.json"))["cases"][0]["expects"][0]["value"], REST + 5.0 / SPRING, 1e-6)
    cases = "[case a]\nover = 0.4 s\nat 0.2 s faults in.drop=1\nat 0.24 s faults none\nexpect missed == 40 from 0.2 s\nexpect missed == 0 to 0.2 s\nexpect late <= 1\n"
    r = test(file_of("none", cases))
    verdict("faults: the link is dead for 40 frames, and well again", r.returncode == 0, r.stdout + r.stderr)
    r = test(file_of("none", cases.replace("at 0.24 s faults none", "at 0.24 s faults in.drop=0")), "--case", "a")
    verdict("  a list replaces the one before", r.returncode == 0, r.stdout + r.stderr)


def test_lost_for_good():
    """Pulled off with 200 N against the preload of 64 N: contact is lost once and stays lost until the run ends."""
    cases = "[case a]\nover = 0.1 s\nat 0.05 s arm force amplitude=-200 N frequency=0 Hz\n" + "".join(
        "expect %s >= 0 %s\n" % x for x in (("contact_loss", "%"), ("last_loss", "s"), ("longest_loss", "s"), ("lift_offs", ""), ("touchdowns", "")))
    found, _ = values(file_of("idle", cases))
    value = {k: o["value"] for k, o in found.items()}
    near("lost for good: the last loss ends with the run", value["last_loss"], 0.1, 1e-12)
    near("  and is the longest", value["longest_loss"], value["contact_loss"] * 1e-3, 1e-9)
    verdict("  one lift-off, no touchdown", (value["lift_offs"], value["touchdowns"]) == (1, 0) and 0.04 < value["longest_loss"] < 0.05, value)


# ---- files, reports, statuses ----

HEAD = "[plant]\nscene = hertz_rig\n[controller]\ncommand = true\n[case a]\nover = 1 s\n"
MISTAKES = [
    ("[plnt]", 1, "did you mean plant?"), ("scene = x", 1, "begin with [plant]"), ("[plant]\nscene = hertz_rg", 2, "did you mean hertz_rig?"),
    ("[plant]\nscene = hertz_rig\nmas = 5 kg", 3, "did you mean mass?"), ("[plant]\nscene = hertz_rig\nmass = 5", 3, "the unit is missing"),
    ("[plant]\nscene = hertz_rig\n[case a]", 3, "no controller"), ("[plant]\nscene = hertz_rig\n[controller]\ncomand = x", 4, "did you mean command?"),
    ("[plant]\nscene = hertz_rig\n[controller]\nbuiltin = kep", 4, "did you mean keep?"), ("[plant]\nscene = hertz_rig\n[controller]\nbuiltin = zzz", 4, "there is keep"), ("[plant]\nscene = hertz_rig\n[controller]\ncommand = x\nattach", 5, "one line"),
    ("[plant]\nscene = hertz_rig\n[controller]\nattach\n[controller]", 5, "stands once"),
    (HEAD, 5, "nothing is expected"), (HEAD + "expect contact_los == 0 %", 7, "did you mean contact_loss?"),
    (HEAD + "at 1 s Arm force amplitude=1", 7, "did you mean arm?"), (HEAD + "expct penetration >= 1 um", 7, "did you mean expect?"),
    (HEAD + "expect penetration >= 1 UM", 7, "did you mean um?"), (HEAD + "at 1 s arm force amplitude=1,5 N", 7, "decimal comma"),
    (HEAD + "expect penetration.mx <= 1 um", 7, "did you mean max?"), (HEAD + "expect penetration == 1 um", 7, "add .min"),
    (HEAD + "expect penetration <= 1 kg", 7, "does not fit"), (HEAD + "expect refused = 0", 7, "where an operator belongs"),
    (HEAD + "expect iae <= 1 um s", 7, "write target ="), (HEAD + "expect velocity.phase <= 1 deg", 7, "write lockin ="),
    (HEAD + "target = penetration 1 um within 1 um\nexpect ise <= 1 um^2 s", 8, "without a prefix"),
    (HEAD + "expect refused == 0 from 2 s", 7, "its window leaves"), (HEAD + "expect refused == 0 from 0.5 s to 0.2 s", 7, "no window"),
    (HEAD + "expect refused == 0\nat 0.1 s arm force amplitude=-7e10 N", 5, "force takes at most 6.4e+10 N"),
    (HEAD + "expect refused == 0\nat 0.1 s stream force 7e10 N", 5, "force takes at most 6.4e+10 N"),
    (HEAD + "at 0.1 s arm forc amplitude=1", 7, "did you mean force?"), (HEAD + "at 0.1 s arm force amplitud=1", 7, "did you mean amplitude?"),
    (HEAD + "at 0.1 arm force amplitude=1", 7, "the unit is missing"), (HEAD + "at 0.1 s set mas=1", 7, "did you mean mass?"),
    (HEAD + "at 2 s set mass=1 kg\nexpect refused == 0", 5, "after its end"), (HEAD + "at 0.1 s jump", 7, "at TIME arm"),
    (HEAD + "at 0.1 s fire", 7, "write fire INPUT"), (HEAD + "at 0.1 s fire forc", 7, "did you mean force?"),
    (HEAD + "at 0.1 s fire force base", 7, "a line for each input"), (HEAD + "at 0.1 s fire force\nexpect refused == 0", 5, "fire force at 0.1 s finds nothing armed"),
    (HEAD + "at 0.2 s arm force amplitude=1 N\nat 0.1 s fire force\nexpect refused == 0", 5, "finds nothing armed"),
    (HEAD + "at 0.1 s arm force amplitude=1 N\nat 0.2 s fire force\nat 0.3 s fire force\nexpect refused == 0", 5, "fire force at 0.3 s finds nothing armed"),
    (HEAD + "at 0.1 s arm force amplitude=1 N\nat 0.2 s fire force\nat 0.3 s arm force phase=1\nexpect refused == 0", 5, "waits for a fire that does not come"),
    (HEAD + "at 0.1 s stream forc 1 N", 7, "did you mean force?"), (HEAD + "at 0.1 s stream force 1 m", 7, "does not fit"),
    (HEAD + "at 0.1 s stream force", 7, "stream INPUT VALUE"), (HEAD + "at 0.1 s faults dro=1\nexpect refused == 0", 5, "did you mean drop?"),
    (HEAD + "vary = mass 1 kg .. 2 kg\nexpect refused == 0", 7, "write NAME=FROM:TO:N"), (HEAD + "link = dro=0.1\nexpect refused == 0", 5, "did you mean drop?"),
    (HEAD + "like = b", 7, "there is no case before"), (HEAD + "over = 2 s", 7, "already"), (HEAD + "exspect refused == 0", 7, ""),
    (HEAD + "golden = x.log penetraton 1 um", 7, "penetraton is no signal of the bus"), (HEAD + "golden = x.log penetration 1 kg", 7, "does not fit"),
    (HEAD + "golden = x.log penetration", 7, ""),
    (HEAD + "at 0.1 s arm force frequency=1e5\nexpect refused == 0", 5, "fewer than 4 steps"), (HEAD + "\xb5", 7, "text in UTF-8"), (HEAD + "like = 'a", 7, "the quote ' does not end"),
]


def test_mistakes():
    for text, line, what in MISTAKES:
        with open(path("m.test"), "w", encoding="latin-1") as f:
            f.write(text + "\n")
        r = test("m.test")
        good = r.returncode == 2 and r.stderr.count("\n") == 1 and "m.test:%d: " % line in r.stderr and what in r.stderr and not r.stdout
        verdict("%s" % r.stderr.strip()[19:110], good, "wanted line %d, \"%s\"; got %d: %s" % (line, what, r.returncode, r.stderr))
    r = test("nothing.test")
    verdict("a file that is not there", r.returncode == 2 and "nothing.test" in r.stderr, r.stderr)
    for words, what in ((("--report", "./m.test"), "is read by this command"), (("--junit", "m.test"), "is read by this command"),
                        (("--json", "one", "--report", "./one"), "choose two files")):
        r = test("m.test", *words)
        with open(path("m.test"), encoding="latin-1") as f:
            verdict("%s: %s" % (" ".join(words), what), r.returncode == 2 and what in r.stderr and f.read() == text + "\n", r.stderr)


def test_reports():
    cases = ("[case good]\nover = 0.2 s\nexpect refused == 0\n[case bad <&\">]\nlike = good\nexpect velocity.max <= -1 m/s\n"
             "[case moves never]\nlike = good\ntarget = penetration 7.07 um within 10 %\nexpect settling <= 1 s\n"
             "[case varied]\nlike = good\nvary = mass 5 kg .. 8 kg in 4\nseeds = 3..4\n")
    name = file_of("none", cases)
    r = test(name, "--junit", path("j.xml"), "--json", path("j.json"))
    wanted = {"good": "ok", "bad <&\">": "FAIL", "moves never": "untested", "varied": "ok"}
    verdict("verdicts, status 1", r.returncode == 1 and r.verdicts == wanted, r.stdout)
    suite = xml.etree.ElementTree.parse(path("j.xml")).getroot()[0]
    found = {c.get("name"): [x.tag + " " + x.get("type", "") for x in c if x.tag != "properties"] for c in suite}
    verdict("JUnit XML is read back", found == {"good": [], "bad <&\">": ["failure FAIL"], "moves never": ["failure untested"], "varied": []} and
            (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("4", "2", "0"), found)
    x = subprocess.run(["xmllint", "--noout", path("j.xml")], capture_output=True, text=True)
    verdict("  and accepted by xmllint", x.returncode == 0, x.stderr)
    data = json.loads(read("j.json"))["cases"]
    verdict("JSON is read back", [c["verdict"] for c in data] == ["ok", "FAIL", "untested", "ok"] and data[3]["runs"] == 8, data)
    again = re.search(r"again: contactplant (.*)", r.stdout).group(1)
    r = subprocess.run("%s %s" % (program, again), shell=True, cwd=directory, capture_output=True, text=True)
    verdict("the command for a case alone: " + again[-60:], r.returncode == 1 and r.stdout.count("FAIL") == 1 and os.path.exists(path("again/t.bad_<&\">.log")), r.stdout + r.stderr)
    shares = [test(name, "--shard", "%d/3" % i).verdicts for i in (1, 2, 3)]
    verdict("three shares are the cases, each once", {k: v for s in shares for k, v in s.items()} == wanted and sum(map(len, shares)) == 4 and max(map(len, shares)) == 2, shares)
    r = test(name, "--case", "good", "--shard", "1/2")
    verdict("an empty share: nothing to do, status 0", r.returncode == 0 and r.stdout.startswith("0 ok, 0 failed"), r.stdout + r.stderr)
    verdict("a share that is none", all(test(name, "--shard", x).returncode == 2 for x in ("0/3", "4/3", "1/0", "x", "1/2x")))
    r = test(name, "--case", "god")
    verdict("a case that is not there", r.returncode == 2 and "did you mean good?" in r.stderr, r.stderr)
    r = test(name, "--case", "good", "--log", "/dev/null/x")
    verdict("a folder that cannot be made", r.returncode == 2 and "--log" in r.stderr, r.stderr)


def test_asked():
    """Names in quotes and in UTF-8; each answer in the unit of its question."""
    write("ü #1.ini", "\ufeff# µ\n[plant]\nmodel = hertz_rig\nmass = 6.5 kg  # ü\n")
    asked = [("penetration.max", 1e-9, "nm"), ("penetration.max", 1e-6, "µm"), ("penetration.max", 1e-6, "μm"), ("penetration.max", 1.0, "m"), ("penetration.rms", 1e-3, "mm"), ("velocity.max", 1e-3, "mm/s"),
             ("velocity.phase", math.pi / 180, "rad"), ("penetration.effort", 1e-6, "um s"), ("last_loss", 1 / 60, "min"), ("contact_loss", 1.0, "%"), ("touchdowns", 1.0, ""), ("impact_speed", 1e3, "km/s")]
    asked = [(m, 180 / math.pi if u == "rad" else 60.0 if u == "min" else x, u) for m, x, u in asked]
    case = "over = 0.5 s\nlockin = 225 Hz\nat 0.05 s arm force amplitude=60 N frequency=225 Hz\n"
    own = {"penetration.max": "m", "penetration.rms": "m", "velocity.max": "m/s", "velocity.phase": "deg", "penetration.effort": "m s", "last_loss": "s", "contact_loss": "%", "touchdowns": "", "impact_speed": "m/s"}
    name = file_of("idle", "[case 'ü µ']\n" + case + "".join("expect %s == -4e9 %s\n" % (m, u) for m, _, u in asked) +
                   "[case si]\nlike = \"ü µ\"\n" + "".join("expect %s == -4e9 %s\n" % x for x in own.items()), scene='"ü #1.ini"')
    r = test(name, "--json", path("u.json"), "--junit", path("u.xml"), "--report", path("u.html"))
    verdict("two cases", (r.returncode, r.verdicts) == (1, {"ü µ": "FAIL", "si": "FAIL"}), r.stdout + r.stderr)
    told = json.loads(read("u.json"))["cases"]
    base = {x["metric"] + x["expect"].split(" ")[0]: x["value"] for x in told[1]["expects"]}
    for (metric, one, unit), x in zip(asked, told[0]["expects"]):
        wanted = base[x["metric"] + metric] / one
        found = re.match(r"it was (-?[\d.e+-]+) ?(.*) at [\d.]+ s$", x["found"])
        good = found and found[2] == unit == x["unit"] and abs(float(found[1]) / wanted - 1) < 1e-3 and abs(x["value"] / wanted - 1) < 1e-12
        verdict("%s in %s: %s" % (metric, unit, x["found"]), good and all(x["found"].encode() in t for t in (r.stdout.encode(), read("u.xml"), read("u.html"))), (wanted, x))


def test_decoded():
    """The log as a table, against rows and events of simulate; and where two logs part."""
    run = lambda *a: subprocess.run([program, *a], cwd=directory, capture_output=True, text=True)
    tick = 1e-3 / 64
    write("loss.ini", "[plant]\nmodel = hertz_rig\nmethod = rk4\n[drive force]\namplitude = 20 N\nfrequency = 225 Hz\n"
          "[ask]\nover = 0.5 s\n[deadline]\nframe = 1 ms\nsubsteps = 64\n")
    test(file_of("idle", "[case a]\nover = 0.4 s\nexpect refused == 0\n", scene="loss.ini"), "--log", ".")
    r = run("decode", "t.a.log", "loss.ini", "--out", "log.csv", "--events", "log_events.csv")
    verdict("decode, status 0", r.returncode == 0 and not r.stdout, r.stderr)
    run("simulate", "loss.ini", "--out", "same.csv", "--events", "same_events.csv", "--until", "0.4", "--every", "0.001", "--step", repr(tick))
    wanted = {round(1e3 * float(x["t"])): x for x in rows_of("same.csv")}
    off = [abs(float(x["displacement [m]"]) - float(wanted[round(1e3 * float(x["t_s"]))]["position"])) for x in rows_of("log.csv") if float(x["t_s"]) > 0]
    verdict("%d rows agree with simulate to the bus's unit, %.3g m" % (len(off), max(off)), len(off) == 400 and max(off) <= 2.6e-11, max(off))
    got, all_ = rows_of("log_events.csv"), rows_of("same_events.csv")
    off = [abs(float(x["t_s"]) - float(y["t"])) for x, y in zip(got, all_)]
    verdict("%d events agree with simulate to a 65536th of a tick" % len(got), len(got) == len(all_) and max(off) <= tick / 65536 and
            [x["kind"] for x in got] == [x["kind"] for x in all_], (len(got), len(all_), max(off)))
    r = run("replay", "t.a.log", "loss.ini")
    verdict("the log replays", r.returncode == 0 and "equal: 402 frames" in r.stdout, r.stdout + r.stderr)
    test(file_of("idle", "[case b]\nover = 0.4 s\nat 0.2 s set mass=6.6 kg\nexpect refused == 0\n", scene="loss.ini"), "--log", ".")
    r = run("compare", "t.a.log", "t.a.log", "--model", "loss.ini")
    verdict("compare: a log with itself", r.returncode == 0 and "400 rows agree" in r.stdout, r.stdout + r.stderr)
    r = run("compare", "t.a.log", "t.b.log", "--model", "loss.ini")
    verdict("compare: they part where the mass changes", r.returncode == 1 and "they part at 0.201 s" in r.stdout, r.stdout + r.stderr)
    told = [re.search(r"is (\S+) and (\S+) (\S+), apart by (\S+), (\S+) allowed", run("compare", "t.a.log", "t.b.log", "velocity=1 " + unit, "--model", "loss.ini").stdout) for unit in ("pm/s", "fm/s")]
    verdict("compare: an answer has the unit of its question", all(told) and [t[3] for t in told] == ["pm/s", "fm/s"] and told[0][5] == told[1][5] == "1" and
            all(abs(float(told[1][k]) / float(told[0][k]) - 1000.0) < 1e-6 for k in (1, 2, 4)), told)
    r = run("compare", "t.a.log", "t.b.log", "penetration=1 mm", "--model", "loss.ini")
    verdict("compare: not by a millimetre", r.returncode == 0, r.stdout + r.stderr)
    for words, status, what in ((("compare", "t.a.log", "t.b.log", "penetratoin=1 um"), 2, "did you mean penetration?"), (("decode", "none.log"), 1, "none.log"),
                                (("compare", "t.a.log", "t.b.log", "penetration=1 um", "penetration=1 m"), 2, "is given already"),
                                (("compare", "t.a.log", "t.b.log", "penetration=1 N"), 2, "does not fit"), (("decode", "t.a.log", "--base-id", "0x240"), 1, "--base-id"),
                                (("decode", "loss.ini"), 1, "loss.ini: no line of it is one of candump -L"), (("decode", "t.a.log", "--out", "/dev/full"), 1, "make room")):
        r = run(*words)
        verdict("%s: %s" % (" ".join(words), what), r.returncode == status and what in r.stderr, r.stdout[:100] + r.stderr)


def test_golden():
    """A log of an earlier run as the expectation."""
    case = "[case a]\nover = 0.4 s\nat 0.1 s arm force amplitude=5 N frequency=225 Hz\n"
    test(file_of("none", case + "expect refused == 0\n"), "--log", path("golden"))
    golden = lambda words, extra="", scene="hertz_rig": test(file_of("none", case + extra + "golden = golden/t.a.log %s\n" % words, scene=scene), "--json", path("g.json"))
    r = golden("")
    verdict("golden: an equal run, every value", r.returncode == 0, r.stdout + r.stderr)
    r = golden("", "at 0.2 s set mass=6.6 kg\n")
    verdict("golden: another run parts where the mass changes", r.returncode == 1 and "as golden = golden/t.a.log: they part at 0.201 s" in r.stdout, r.stdout + r.stderr)
    verdict("  is in the JSON", json.loads(read("g.json"))["cases"][0]["expects"][-1]["metric"] == "golden")
    r = golden("penetration 10 um command_fast_force 100 N", "at 0.2 s set mass=6.6 kg\n")
    verdict("golden: within tolerances", r.returncode == 0, r.stdout + r.stderr)
    r = golden("penetration 1 pm", "at 0.2 s set mass=6.6 kg\n")
    verdict("golden: and not within them", r.returncode == 1 and "penetration is" in r.stdout and " pm, apart by " in r.stdout and " 1 allowed" in r.stdout, r.stdout)
    r = golden("penetration 1 pm penetration 1 m")
    verdict("golden: a signal twice", r.returncode == 2 and "penetration stands twice" in r.stderr, r.stderr)
    r = test(file_of("none", case.replace("0.4 s", "0.5 s") + "golden = golden/t.a.log penetration 0 m\n"))
    verdict("golden: a log that is too short", r.returncode == 1 and "golden/t.a.log ends first, after 400 rows" in r.stdout, r.stdout)
    r = golden("", scene="hertz_rig_linear")
    verdict("golden: a log of another scene is an error, with the reason", r.returncode == 3 and "is of another plant" in r.stdout, r.stdout)
    r = test(file_of("none", case + "golden = none.log\n"))
    verdict("golden: no log is an error", r.returncode == 3 and "none.log" in r.stdout, r.stdout)
    os.makedirs(path("temporary"), exist_ok=True)
    name = file_of("none", case.replace("0.4 s", "0.5 s") + "golden = golden/t.a.log\n[case killed]\nlike = a\n")
    with open(name) as f:
        write("t.test", f.read().replace("command = ", "command = [ {seed} = 1 ] || kill -9 $PPID && ").replace("[case killed]\nlike = a\n", "[case killed]\nlike = a\nseeds = 2..3\n"))
    r = subprocess.run([program, "test", name], capture_output=True, text=True, cwd=directory, env=dict(os.environ, TMPDIR=path("temporary")))
    verdict("  leaves no log of its own behind, also where the bench is killed", "ended by signal 9" in r.stdout and "1 failed" in r.stdout and not os.listdir(path("temporary")), r.stdout)


def test_trouble():
    name = file_of("none", "[case long]\nover = 2 s\nexpect refused == 0\n[case short]\nover = 0.02 s\nexpect refused == 0\n")
    r = test(name, "--log", path("full"), prefix=("sh", "-c", "ulimit -f 300; exec \"$@\"", "sh"))
    verdict("a disk that fills: an error with its reason, the other case runs", r.returncode == 3 and r.verdicts == {"long": "error", "short": "ok"} and "--log" in r.stdout, r.stdout)
    name = file_of("none", "[case a]\nover = 86400 s\nexpect refused == 0\n[case b]\nlike = a\n")
    p = subprocess.Popen([program, "test", name], cwd=directory, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    while len(left()) < 2 and p.poll() is None:
        time.sleep(0.1)
    p.send_signal(signal.SIGINT)
    p.communicate(timeout=60)
    for _ in range(50):
        if left():
            time.sleep(0.1)
    verdict("Ctrl-C ends the controllers, too", p.returncode == 3 and not left(), (p.returncode, left()))


with tempfile.TemporaryDirectory() as directory:
    for part in (test_mistakes, test_bugs, test_seeds, test_examples, test_controllers, test_bytes, test_simulated, test_step, test_fire, test_response, test_response_beside, test_counters, test_counts, test_stream_and_faults, test_lost_for_good, test_reports, test_asked, test_decoded, test_golden, test_trouble):
        part()
conclude()
