#!/usr/bin/env python3
"""test_files.py PROGRAM - no output of a command line destroys one of its inputs, or another output. The options that write come from the
help of all subcommands: FILE or DIR stands behind them. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import fcntl
import itertools
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1])
port = 31000 + os.getpid() % 800 * 10
REFUSED = re.compile(r"^contactplant [a-z]+: .*(itself|read by this command|read by it|golden log|controller's command|choose two files|, too)\b.*\n$")
# Options with FILE that read, and the placeholders of values that name no file.
READS = {("run", "plants"), ("scope", "open"), ("fit", "sweep"), ("fit", "ring"), ("fit", "series"), ("fit", "log"), ("fit", "thermal"), ("fit", "curve"), ("scan", "surface"), ("test", "requirements"), ("basin", "rows")}
NO_FILE = {"A,B,...", "ADDRESS:PORT", "BUS", "CH=A,HZ,RAD", "CH=SD,STEPS,SEED", "D", "DT", "E", "FRAMES", "FROM:TO", "H", "HOST:PORT", "HZ", "I/N", "ID",
           "LIST", "M", "M/S", "MACHINE", "MB", "N", "N,N/M,..", "NAME", "NAME,..", "NAME=FROM:TO", "NAME=FROM:TO:N",
           "NAME=VALUE", "OUTPUT", "PERIODS", "S", "SHARE", "SIGNAL=TOLERANCE", "T", "T1,T2,...", "TIME", "WHAT", "WHERE", "X", "model|si", "floquet|contact", "catch_up|skip|freeze|stop"}
# Each subcommand with its inputs, quick where it may run. What is read: every name in the line that is a file, and those behind it.
LINES = [
    (["run", "s.ini", "--duration", "0.02", "--bus", "udp:127.0.0.1:%d" % port], [], True),
    (["run", "--plants", "list.txt"], [], False),
    (["scope", "s.ini", "t.ini@0x100"], [], False),
    (["scope", "--open", "run.log"], [], False),
    (["demo"], [], False),
    (["test", "u.test", "v.test"], ["s.ini", "g.log", "ctl.sh"], False),
    (["test", "v.test"], ["s.ini"], True),
    (["simulate", "s.ini", "--until", "0.02", "--every", "0.005"], [], True),
    (["approach", "soft.ini", "--points", "10", "--speed", "1e-4"], [], True),
    (["scan", "lever.ini", "--surface", "h.gsf"], [], False),
    (["thermal", "lever.ini", "--seconds", "0.25"], [], True),
    (["choose", "s.ini"], [], True),
    (["fit", "s.ini", "--sweep", "c.csv", "--hold", "preload=64 N", "--force"], [], True),
    (["fit", "s.ini", "--log", "run.log"], [], False),
    (["sweep", "s.ini", "--sweep", "force.frequency=150:160:2", "--settle", "10"], [], True),
    (["basin", "s.ini", "--starts", "2"], [], True),
    (["basin", "s.ini", "--rows", "rows.csv"], [], False),
    (["stability", "s.ini", "--x", "stiffness.frequency=100:200:2", "--y", "stiffness.amplitude=0.1:0.2:2"], [], True),
    (["random", "noise.ini", "--seeds", "2", "--over", "150"], [], True),
    (["decode", "run.log", "s.ini"], [], True),
    (["export", "run.log"], [], True),
    (["fmu", "s.ini"], [], True),
]
SILENT = {"send", "monitor", "control", "replay", "compare", "selftest", "list", "help", "scene", "dbc", "dissector", "man", "completion", "version"}  # they write no file
WORDS = {"merge"}  # whose first word is written: tests/cli/test_merge.py


def run(*words, **more):
    more = {"stdout": subprocess.PIPE, **more}
    return subprocess.run([program, *words], stderr=subprocess.PIPE, text=True, timeout=60, **more)


def options_of(command):
    """[(name, placeholder)] of the options with a value."""
    return re.findall(r"^  --([a-z-]+) ([^ ]+) ", run(command, "--help").stdout, re.M)


def writers_of(line):
    command = line[0]
    return [(name, value) for name, value in options_of(command) if value in ("FILE", "DIR") and (command, name) not in READS and
            not (command == "basin" and "--rows" in line and name == "out")]


def give(pairs):
    return [word for name, path in pairs for word in ("--" + name, path)]


def content():
    return {name: open(name, "rb").read() for name in sorted(os.listdir(".")) if os.path.isfile(name)}


def prepare():
    for name, scene in (("s.ini", "rig"), ("t.ini", "rig"), ("lever.ini", "tapping"), ("soft.ini", "soft"), ("noise.ini", "nayak-random")):
        with open(name, "w") as f:
            f.write(run("scene", scene).stdout)
    case = "[case c]\nover = 0.05 s\nexpect penetration >= 0 m\n"
    texts = {"u.test": "[plant]\nscene = s.ini\n[controller]\ncommand = sh 'ctl.sh'\n" + case + "golden = g.log penetration 1 m\n",
             "v.test": "[plant]\nscene = s.ini\n[controller]\nbuiltin = keep\n" + case, "list.txt": "t.ini\n", "ctl.sh": "exit 0\n"}
    for name, text in texts.items():
        with open(name, "w") as f:
            f.write(text)
    shutil.copy(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/examples/fit/small.csv"), "c.csv")
    with open("h.gsf", "wb") as f:
        header = b"Gwyddion Simple Field 1.0\nXRes = 2\nYRes = 2\nXReal = 1e-6\nYReal = 1e-6\nZUnits = m\n"
        f.write(header + b"\0" * (4 - len(header) % 4 + 16))
    run("test", "v.test", "--log", "logs")
    os.replace("logs/v.c.log", "run.log")
    shutil.copy("run.log", "g.log")
    run("basin", "s.ini", "--starts", "2", "--out", "rows.csv")
    shutil.rmtree("logs")


def spellings(path):
    """The file by other names; what is made for them goes with the folder."""
    os.symlink(path, "soft.link")
    os.link(path, "hard.link")
    os.symlink("soft.link", "second.link")
    return [path, "./" + path, "../" + os.path.basename(os.getcwd()) + "/" + path, os.path.abspath(path), "soft.link", "second.link", "hard.link"]


def forget(names):
    for name in names:
        if os.path.lexists(name):
            os.unlink(name) if not os.path.isdir(name) or os.path.islink(name) else shutil.rmtree(name)


def refused(words, before, **more):
    r = run(*words, **more)
    return "" if r.returncode == 2 and REFUSED.match(r.stderr) and not r.stdout and content() == before else " ".join(words) + ": status %d: " % r.returncode + r.stderr + (
        "files changed: " + " ".join(sorted(k for k in set(content()) | set(before) if content().get(k) != before.get(k))))


def test_inputs(line, more):
    """Each output that writes a file is each input, by each name, while the other outputs are files of their own."""
    writers = [w for w in writers_of(line) if w[1] == "FILE"]
    for path in [word.split("@")[0] for word in line[1:] if os.path.isfile(word.split("@")[0])] + more:
        bad = []
        names = spellings(path)
        before = content()
        for name, spelling in itertools.product([w[0] for w in writers], names):
            bad.append(refused(line + give([(w[0], "new." + w[0]) for w in writers if w[0] != name] + [(name, spelling)]), before))
        verdict("%s: %s is no output, by %d names for each of %d options" % (" ".join(line[:3]), path, len(names), len(writers)), not any(bad), next(filter(None, bad), ""))
        forget(["soft.link", "hard.link", "second.link"])
        if "--plants" not in line:
            with open(path, "a") as f:
                why = refused(line + give([(w[0], "new." + w[0]) for w in writers]), content(), stdout=f)
            verdict("%s >>%s" % (" ".join(line[:3]), path), not why or line[0] == "scope", why)


def test_outputs(line):
    """Each output is each other one."""
    writers = [w[0] for w in writers_of(line)]
    bad = []
    with open("old", "w") as f:
        f.write("old\n")
    os.symlink("ahead", "ahead.link")  # to what is not there
    names = spellings("old")
    before = content()
    pairs = list(itertools.combinations(writers, 2))
    for (a, b), (x, y) in itertools.product(pairs, [("old", n) for n in names] + [("ahead", "./ahead"), ("ahead", "ahead.link"), ("ahead.link", os.path.abspath("ahead"))]):
        bad.append(refused(line + give([(a, x), (b, y)]), before))
    for name in [w[0] for w in writers_of(line) if w[1] == "FILE"]:
        with open("old", "a") as f:
            bad.append(refused(line + give([(name, "old")]), before, stdout=f))
    forget(["old", "ahead.link", "soft.link", "hard.link", "second.link"])
    verdict("%s: %d pairs of outputs are no two outputs" % (" ".join(line[:3]), len(pairs)), not any(bad), next(filter(None, bad), ""))


def read_pipe(path, got):
    with open(path, "rb") as f:
        got.append(f.read())


def companions(line, name):
    """What an option needs beside it."""
    others = [w[0] for w in writers_of(line)]
    need = {"report": "log" if line[0] == "run" else "out", "svg": "out"}.get(name)
    return [(need, "beside")] if need in others and line[0] in ("run", "sweep", "basin", "stability", "random") else []


def test_writers(line):
    """Pipes and links stay what they are; a full disk is told and leaves what it can; a file that is not there is made."""
    for name, kind in writers_of(line):
        rows = name == "out" and line[0] in ("sweep", "basin", "stability", "random")  # goes on from what stands there
        if kind == "DIR":
            continue
        os.mkfifo("pipe")
        got = []
        reader = threading.Thread(target=read_pipe, args=("pipe", got), daemon=True)
        if not rows:
            reader.start()
        r = run(*line, *give(companions(line, name) + [(name, "pipe")]))
        if not rows:
            reader.join(10)
        why = "" if rows and "no file on a disk" in r.stderr and r.returncode == 1 else "" if r.returncode in (0, 1) and got and got[0] and "cannot" not in r.stderr else r.stderr + "%d" % r.returncode
        verdict("%s --%s PIPE" % (line[0], name), not why and not os.path.isfile("pipe") and not os.path.lexists("pipe.part"), why)
        forget(["pipe", "beside"])
        os.symlink("target", "link")
        r = run(*line, *give(companions(line, name) + [(name, "link")]))
        verdict("%s --%s LINK" % (line[0], name), os.path.islink("link") and os.path.exists("target") and os.path.getsize("target") > 0, r.stderr)
        forget(["link", "target", "beside"])
        r = run(*line, *give(companions(line, name) + [(name, "/dev/full")]))
        verdict("%s --%s /dev/full: status %d" % (line[0], name, r.returncode), r.returncode in (1, 2) and "--" + name in r.stderr or "log: writing failed" in r.stderr, r.stderr)
        forget(["beside"])


def test_taken():
    """An output that another process writes, as the log of a running plant."""
    with open("old", "w") as f:
        f.write("of a running plant\n")
    os.symlink("old", "soft.link")
    before = content()
    with open("old") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        for line, _, _ in LINES:
            bad = []
            for (name, kind), path in itertools.product(writers_of(line), ("old", "soft.link")):
                r = run(*line, *give(companions(line, name) + [(name, path)])) if kind == "FILE" else None
                good = not r or (r.returncode == 2 and "another process writes it" in r.stderr and r.stderr.count("\n") == 1 and content() == before)
                bad.append("" if good else "--%s: %d %s" % (name, r.returncode, r.stderr))
            verdict("%s: no output goes into a file that another process writes" % " ".join(line[:3]), not any(bad), next(filter(None, bad), ""))
    with subprocess.Popen([program, "run", "s.ini", "--lockstep", "--bus", "memory:ring", "--log", "run2.log", "--patience", "60"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as p:
        p.stderr.readline()
        r = run("run", "s.ini", "--duration", "0.02", "--bus", "udp:127.0.0.1:%d" % port, "--log", "run2.log")
        p.terminate()
        p.communicate()
    verdict("run --log of a running plant", r.returncode == 2 and "another process writes it" in r.stderr, r.stderr)
    r = run("run", "s.ini", "--duration", "0.02", "--bus", "udp:127.0.0.1:%d" % port, "--log", "run2.log")
    verdict("  which is free when that has ended", r.returncode == 0, r.stderr)
    forget(["old", "soft.link", "run2.log"])


def test_room():
    """Outputs that are made at the end are whole or as they were."""
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))
    for line, name in ((["run", "s.ini", "--duration", "0.02", "--bus", "udp:127.0.0.1:%d" % port], "json"), (["fmu", "s.ini"], "out"), (["choose", "s.ini"], "json"),
                       (["simulate", "s.ini", "--until", "0.02", "--every", "0.005"], "report"), (["test", "v.test"], "junit"), (["decode", "run.log", "s.ini"], "svg"),
                       (["approach", "soft.ini", "--points", "10", "--speed", "1e-4"], "tab"), (["thermal", "lever.ini", "--seconds", "0.25"], "svg")):
        with open("old", "w") as f:
            f.write("old\n")
        r = run(*line, "--" + name, "old", preexec_fn=limit)
        with open("old") as f:
            verdict("%s --%s without room: the old one stays" % (line[0], name), r.returncode in (1, 2) and f.read() == "old\n", r.stderr)
        r = run(*line, "--" + name, "fresh", preexec_fn=limit)
        verdict("  and no piece of a new one", r.returncode in (1, 2) and not os.path.exists("fresh"), r.stderr)
        forget(["old", "fresh"])
    scan = ["scan", "lever.ini", *"--set pixels=4 --set lines=4 --set".split(), "pixel=1 ms"]
    swings = [*scan, "--set", "peak_force=5 nN", "--set", "ticks=2", "--every", "1"]
    for line, name in ((scan, "out"), (swings, "volume"), (["test", "v.test"], "log"), (["demo"], "out")):
        r = run(*line, "--" + name, "folder", *(["--out", "beside"] if name == "volume" else []), preexec_fn=limit)
        verdict("%s --%s without room: the reason" % (line[0], name), r.returncode in (1, 3) and "File too large" in r.stderr + r.stdout and "�" not in r.stderr, r.stderr)
        forget(["folder", "beside"])


def test_folders():
    """Files that a command makes in a folder."""
    os.mkdir("images")
    shutil.copy("h.gsf", "images/height.gsf")
    os.symlink("../h.gsf", "images/phase_back.gsf")
    before = open("images/height.gsf", "rb").read()
    golden = open("g.log", "rb").read()
    for surface in ("images/height.gsf", "h.gsf"):
        r = run("scan", "lever.ini", "--surface", surface, "--out", "images")
        verdict("scan --surface %s --out images" % surface, r.returncode == 2 and REFUSED.match(r.stderr) and open("images/height.gsf", "rb").read() == before and
                open("h.gsf", "rb").read() == before and len(os.listdir("images")) == 2, r.stderr)
    for name, words in (("u.c.log", []), ("v.c.controller.txt", []), ("u.c.log", ["--json", "logs/u.c.log"]), ("v.c.log", ["--report", "logs/v.c.log"])):
        os.mkdir("logs")
        if not words:
            os.link("g.log", "logs/" + name)
        r = run("test", "u.test", "v.test", "--log", "logs", *words)
        verdict("test --log: logs/%s is %s" % (name, words[0] if words else "the golden log"), r.returncode == 2 and REFUSED.match(r.stderr) and
                os.listdir("logs") == ([] if words else [name]) and open("g.log", "rb").read() == golden, r.stderr)
        forget(["logs"])
    for name in ("demo.svg", "demo.csv", "bus.log", "plant.txt"):
        r = run("demo", "--out", "shown", "--report", "shown/" + name)
        verdict("demo --report shown/%s" % name, r.returncode == 2 and REFUSED.match(r.stderr) and not os.path.exists("shown"), r.stderr)
    for name in ("scan.part", "scan.part.new"):
        forget(["images"])
        os.mkdir("images")
        with open("images/" + name, "w") as f:
            f.write("a list of parts to scan\n")
        r = run("scan", "lever.ini", "--out", "images")
        verdict("scan beside a %s of somebody's" % name, r.returncode == 1 and "is no scan, and is left as it is" in r.stderr and os.listdir("images") == [name] and
                os.path.getsize("images/" + name) == 24, r.stderr)
    forget(["images"])


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    prepare()
    commands = re.findall(r"^  ([a-z]+) ", run("--help").stdout.split("examples:")[0], re.M)
    verdict("each subcommand is here: %d" % len(commands), set(commands) == SILENT | WORDS | {line[0] for line, _, _ in LINES}, sorted(set(commands) ^ (SILENT | WORDS | {line[0] for line, _, _ in LINES})))
    values = {value for command in commands for _, value in options_of(command)}
    verdict("each placeholder of a value is known: FILE and DIR, or no file", values - {"FILE", "DIR"} <= NO_FILE, sorted(values - {"FILE", "DIR"} - NO_FILE))
    verdict("the others write no file", not any(writers_of([c]) for c in SILENT | WORDS))
    for line, more, runs in LINES:
        test_inputs(line, more)
        test_outputs(line)
        if runs:
            test_writers(line)
    test_taken()
    test_room()
    test_folders()
    os.chdir("/")
conclude()
