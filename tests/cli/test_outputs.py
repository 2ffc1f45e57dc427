#!/usr/bin/env python3
"""test_outputs.py PROGRAM - what every subcommand prints and writes, at several settings: no internal value (nan, inf, -0, the count -1,
largest numbers) reaches a person or a program. The subcommands and the options that name a file are those of the program's own help, so
that a new one is missed here by name. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import zipfile

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "../house"))
from verdicts import conclude, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1])
host = "127.75.%d.%d:" % (os.getpid() >> 8 & 255, os.getpid() & 255)

WORD = r"(?<![\w.%%/'\"-])%s(?![\w(])"
BAD = [re.compile(WORD % w, re.I) for w in (r"[-+]?nan", r"[-+]?inf", r"[-+]?infinity", r"-0(\.0*)?(?![.\d])")] + \
    [re.compile(w) for w in (r"-1 (periods|frames|points|starts|steps|realisations)", r"\d[eE]\+?30[78]\b", r"\b18446744073709551615\b",
                             r"\b4294967295\b", r"-2147483648\b", r"-9223372036854775808\b", r"\(null\)", r"%[dsg]\b")]
# documented: the protocol's field that may be NaN; the range of a 32-bit field
TRUE = {"list": "NaN: nothing to measure", "dbc": "4294967295", "dissector": "NaN: nothing to measure"}
INPUTS = {"test": {"requirements"}, "basin": {"rows"}, "scan": {"surface"}, "run": {"plants"}, "scope": {"open"}, "fit": {"log", "thermal", "curve"}}
KINDS = ("FILE", "DIR", "WHERE")


def text_of(path):
    """What a person reads of a file: the data of a page, the texts of a picture, everything of a table."""
    with open(path, "rb") as f:
        raw = f.read()
    if raw[:2] == b"PK":
        with zipfile.ZipFile(path) as z:
            return z.read("modelDescription.xml").decode()
    if raw[:4] == b"\x89PNG" or raw[:8] == b"Gwyddion" or raw[:4] == b"\n\r\r\n":
        return ""
    text = raw.decode("utf-8", "replace")
    if path.endswith(".log"):
        return ""  # frames in hex digits
    if "<svg" in text[:400]:
        numbers = " ".join(re.findall(r'="([^"]*)"', text))
        return " ".join(re.findall(r">([^<]*)</t", text)) + ("\n" + "nan" if re.search(r"\b(nan|inf)\b", numbers) else "")
    data = re.search(r'id="data">(.*?)</script>', text, re.S)
    if data:
        json.loads(data.group(1))
        return data.group(1)
    if path.endswith(".json"):
        json.loads(text)
    return text


def findings(text):
    return ["%s in ..%s.." % (b.pattern, text[max(0, m.start() - 50):m.end() + 30].replace("\n", "|"))
            for b in BAD for m in [b.search(text)] if m]


def run(words, folder, statuses=(0, 1, 3)):
    r = subprocess.run([program, *words], capture_output=True, text=True, cwd=folder, timeout=300)
    files = sorted(os.path.join(d, f) for d, _, names in os.walk(folder) for f in names)
    wrong = findings(r.stdout.replace(TRUE.get(words[0], "\0"), "")) + ["stderr: " + f for f in findings(r.stderr)]
    for path in files:
        wrong += [os.path.relpath(path, folder) + ": " + f for f in findings(text_of(path))]
    if r.returncode not in statuses:
        wrong.append("status %d: %s" % (r.returncode, r.stderr[-200:]))
    verdict("%s (%d files)" % (shlex.join(words), len(files)), not wrong, "; ".join(wrong))
    return r


def listed():
    """The subcommands, and the options of each that name a file to write."""
    names = re.findall(r"^  ([a-z]+) +\S", run(["--help"], folder_of("help")).stdout.split("subcommands:")[1].split("\n\n")[0], re.M)
    options = {}
    for name in names:
        told = subprocess.run([program, name, "--help"], capture_output=True, text=True).stdout
        options[name] = {o for o, kind in re.findall(r"^  --([a-z-]+) +([A-Z]+)\b", told, re.M) if kind in KINDS} - INPUTS.get(name, set())
    return names, options


def folder_of(name):
    path = os.path.join(top, name)
    os.makedirs(path, exist_ok=True)
    return path


def cases():
    """Name of a subcommand and its words. {file} of an option is in the case's own folder."""
    rough = ["--set", "force.amplitude=60 N"]
    yield from (("simulate", w.split()) for w in (
        "rig --until 0.2 --every 0.001 --out r.csv --events e.csv --report r.html",
        "rig --until 0 --every 0.001 --out r.csv --events e.csv --report r.html",
        "rig --until 0.05",
        "kb-fig4 --until 2000 --set r=0.9 --every 1 --out r.csv --report r.html",
        "tip --until 1e-4 --every 1e-5 --report t.html --out t.csv",
        "nayak-random --until 20 --every 0.5 --out n.csv --report n.html"))
    yield from (("approach", w.split()) for w in (
        "tapping --set temperature=0K --to 4e-9 --points 40 --out a.csv --svg a.svg --tab a.tab",
        "soft --points 20 --to 10e-9 --out a.csv --svg a.svg --tab a.tab",
        "soft --points 20 --speed 1e-5"))
    yield "scan", "--set pixels=16 --set lines=4 --out images".split()
    yield "scan", "--set pixels=16 --set lines=4 --set peak_force=5e-9 --set ticks=2 --out images --volume curves".split()
    yield "scan", "--set pixels=16 --set lines=4 --set surface=2 --set ki=3000 --out images".split()
    yield "thermal", "--seconds 0.3 --out t.csv --svg t.svg".split()
    yield "thermal", "soft --seconds 0.2 --set modes=4 --out t.csv --svg t.svg".split()
    yield "thermal", "soft --seconds 0.2".split()
    yield "choose", "rig --json c.json --out c.ini --report c.html".split()
    yield "choose", "rig --tolerance 1e-9".split()
    yield "choose", "shaft --tolerance 0.05 --json c.json --report c.html --out c.ini".split()
    sweep = "--sweep=force.frequency=150:260:6"
    yield "sweep", ["rig", sweep, *rough, "--out", "s.csv", "--svg", "s.svg", "--report", "s.html"]
    yield "sweep", ["rig", sweep, "--settle", "0", "--out", "s.csv", "--svg", "s.svg", "--report", "s.html"]
    yield "sweep", ["rig", "--sweep=force.amplitude=0:2:3", "--family=force.frequency=180:240:2", "--out", "s.csv", "--svg", "s.svg", "--report", "s.html"]
    yield "sweep", ["rig", "--sweep=force.frequency=150:260:3:log"]
    yield "sweep", "kb-fig4 --sweep omega=0.3:0.6:5 --out s.csv --svg s.svg --report s.html".split()
    basin = "basin rig --starts 5 --out b.csv --svg b.svg --report b.html".split()[1:]
    yield "basin", basin
    yield "basin", "shaft-fig16-705 --starts 6 --out b.csv --svg b.svg --report b.html".split()
    yield "basin", "rig --starts 3 --periods 2 --out b.csv --svg b.svg --report b.html".split()
    yield "basin", "rig --starts 3".split()
    yield "stability", "hertz_rig --method rk4 --x stiffness.frequency=100:400:6 --y stiffness.amplitude=0:3e9:4 --out m.csv --svg m.svg --report m.html".split()
    yield "stability", "rig --map contact --method rk4 --x step=1e-4:2e-3:4 --y stiffness=1e9:1e10:3:log --periods 5 --out m.csv --svg m.svg --report m.html".split()
    yield "stability", "hertz_rig --x stiffness.frequency=100:400:3 --y stiffness.amplitude=1e9:3e9:2".split()
    yield "random", "nayak-random --seeds 4 --over 100 --out n.csv --svg n.svg --report n.html --statistics s.csv".split()
    yield "random", "nayak-random --seeds 2 --over 40 --range 5:6 --out n.csv --svg n.svg --report n.html --statistics s.csv".split()
    yield "random", "nayak-random --seeds 2 --over 40".split()
    yield "selftest", []
    for word in ("", "models", "scenes", "settings", "microscope", "methods", "messages", "counters", "metrics"):
        yield "list", word.split()
    yield from (("help", w.split()) for w in ("--errors", "--errors late", "--search early return"))
    for scene in ("rig", "shaft", "tip", "tapping", "kb-fig4", "nayak-random"):
        yield "scene", [scene]
    yield "dbc", ["rig"]
    yield "dissector", ["rig"]
    curve = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/examples/fit/small.csv")
    yield "fit", ["rig", "--sweep", curve, "--out", "fitted.ini", "--svg", "f.svg", "--report", "f.html"]
    yield "fit", ["rig", "--plan"]
    decay = curve.replace("small", "decay")
    yield from (("fit", ["rig", kind, decay, "--hold", "mass=6.1 kg", "--svg", "f.svg"]) for kind in ("--ring", "--series"))
    yield "fit", ["rig", "--sweep", curve, "--free", "mass,stiffness,damping,gain.sensor", "--out", "fitted.ini", "--force"]
    yield "fmu", "rig --out rig.fmu".split()
    yield "fmu", "nayak-random --out n.fmu".split()
    yield "man", []
    yield "completion", []
    yield "version", []
    yield "demo", "afm --out d".split()
    yield "test", ["damped.test", "--log", ".", "--junit", "t.xml", "--json", "t.json", "--report", "t.html"]
    yield "test", ["away.test", "--log", ".", "--junit", "t.xml", "--json", "t.json", "--report", "t.html"]
    yield "test", ["away.test", "--junit", "t.xml", "--json", "t.json", "--report", "t.html"]


CASES_OF_TEST = """[plant]
scene = rig
[controller]
command = /usr/bin/python3 %s/../trial/controller.py {plant} {me} %s
[case one]
over = 0.6 s
at 0.1 s  arm force amplitude=%s frequency=60 Hz ramp=0.1 s
target = penetration 7 um within 1 um
lockin = 60 Hz
expect    peak_force <= 1 N
expect    settling <= 10 ms
expect    overshoot <= 1 %%
expect    penetration.amplitude <= 1 nm
expect    penetration.phase <= 1 deg
expect    stopped <= 0.1 s
expect    last_loss <= 0.1 s
expect    hash == 0123456789abcdef
"""


def put_tests(folder):
    for name, bug, size in (("damped", "none", "1 N"), ("away", "idle", "9000 N")):
        with open(os.path.join(folder, name + ".test"), "w") as f:
            f.write(CASES_OF_TEST % (here, bug, size))


def on_a_bus(folder, *extra):
    """A plant, its controller and a listener: the subcommands that speak. Gives what each said."""
    bus = ["--bus", "udp:" + host + "20000"]
    plant = subprocess.Popen([program, "run", "rig", *bus, *[w for p in (1, 2, 3) for w in ("--peer", "%s2000%d" % (host, p))], "--log", "run.log", "--report",
                              "run.html", "--json", "run.json", "--duration", "4", "--status", "--setting", "timeout_frames=1000", *extra], cwd=folder,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    peer = ["--peer", host + "20000", "--setting", "timeout_frames=1000", *extra]
    listen = [subprocess.Popen([program, *w], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for w in (
        ["control", "rig", "--bus", "udp:" + host + "20001", *peer, "--duration", "1.5"],
        ["monitor", "--model", "rig", "--bus", "udp:" + host + "20002", *peer, "--count", "300"])]
    told = [p.communicate(timeout=60) for p in listen]
    for words in (["--wide"], ["--json", "-"], ["--csv"]):
        r = subprocess.run([program, "monitor", "--model", "rig", "--bus", "udp:" + host + "20002", *peer, "--count", "40", *words], cwd=folder, capture_output=True, text=True, timeout=60)
        told.append((r.stdout, r.stderr))
    r = subprocess.run([program, "send", "--model", "rig", "--bus", "udp:" + host + "20003", *peer, "read", "mass_kg"], cwd=folder, capture_output=True, text=True, timeout=60)
    told += [(r.stdout, r.stderr), plant.communicate(timeout=60)]
    wrong = [f for pair in told for text in pair for f in findings(text)]
    for name in sorted(os.listdir(folder)):
        wrong += [name + ": " + f for f in findings(text_of(os.path.join(folder, name)))]
    verdict("run, control, monitor, send %s" % shlex.join(extra), not wrong and os.path.exists(os.path.join(folder, "run.html")), "; ".join(wrong) or told[-1])


SPEAKING = {"run": {"log", "report", "json"}, "control": set(), "monitor": {"json"}, "send": set(), "scope": {"log"}}  # scope: tests/scope
used = {name: set(options) for name, options in SPEAKING.items()}
with tempfile.TemporaryDirectory() as top:
    names, options = listed()
    verdict("the help lists subcommands", len(names) > 20, names)
    for i, (name, words) in enumerate(cases()):
        folder = folder_of("case%d" % i)
        if name == "test":
            put_tests(folder)
        run([name, *words], folder)
        used.setdefault(name, set()).update(w[2:].split("=")[0] for w in words if w.startswith("--"))
    for i, extra in enumerate(([], ["--setting", "displacement_delay_frames=20"])):
        on_a_bus(folder_of("bus%d" % i), *extra)
    folder = folder_of("bus0")
    for words in ("decode run.log rig --out d.csv --events e.csv --svg d.svg --report d.html", "decode run.log rig", "export run.log --out e.pcapng", "replay run.log rig", "compare run.log run.log --model rig",
                  "thermal soft --seconds 0.5 --out h.csv", "approach soft --tab c.tab --out c.csv", "fit soft --thermal h.csv --curve c.tab --out l.ini --report l.html"):
        run(words.split(), folder)
        used.setdefault(words.split()[0], set()).update(w[2:] for w in words.split() if w.startswith("--"))
    away = next(os.path.join(d, f) for d, _, fs in os.walk(top) for f in fs if f.startswith("away") and f.endswith(".log"))
    run(["decode", away, "rig", *"--out d.csv --events e.csv --svg d.svg --report d.html".split()], folder_of("away"))
    folder = folder_of("merged")
    for i in "12":
        run(["random", "nayak-random", *"--seeds 2 --over 40 --shard".split(), i + "/2", "--out", "p%s.csv" % i], folder)
    run("merge m.csv p1.csv p2.csv".split(), folder)
    used.setdefault("merge", set())
    used.setdefault("demo", set()).add("report")  # of the demonstration in real time: tests/scope/test_report.py
    for name in names:
        missing = options[name] - used.get(name, set())
        verdict("each file that %s writes is looked at" % name, name in used and not missing, "no case here for %s" % (missing or name))
conclude()
