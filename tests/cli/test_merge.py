#!/usr/bin/env python3
"""test_merge.py PROGRAM - contactplant merge: shares of every map and of a test's reports are what one run writes, in any order; what is
missing or cut is named, and the lines that it prints compute it; parts that do not belong together are refused, and OUT stays as it was.
Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import fcntl
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, equal, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build/contactplant")
MAPS = {
    "basin": "rig.ini --starts 40".split(),
    "sweep": "rig --sweep force.frequency=150:200:2 --settle 10 --family force.amplitude=1:5:5".split(),
    "stability": "hertz_rig --method rk4 --x stiffness.frequency=100:400:5 --y stiffness.amplitude=1e9:3e9:3".split(),
    "random": "nayak-random --seeds 5 --over 100".split(),
}
HEAD = "[plant]\nscene = hertz_rig\n[controller]\nbuiltin = keep\n"
CASE = "[case %s]\nrequirement = %s\nover = 0.05 s\nexpect %s\n"
GOOD, BAD = "faults == 0", "penetration >= 1 m"


def run(*words, **more):
    environment = {**os.environ, "PATH": os.path.dirname(program) + ":" + os.environ["PATH"]}
    return subprocess.run([program, *words], capture_output=True, text=True, timeout=300, env=environment, **more)


def read(path):
    with open(path, "rb") as f:
        return f.read()


def write(path, text):
    with open(path, "w") as f:
        f.write(text)
    return path


def clear():
    for name in os.listdir("."):
        if name.endswith(".csv"):
            os.unlink(name)


def shares(command, n, name, *options):
    """The files of n shares of this command, whose outputs have {} in their names."""
    paths = [name.format(i) for i in range(1, n + 1)]
    for i in range(1, n + 1):
        r = run(*command, "--shard", "%d/%d" % (i, n), *[o.format(i) for o in options])
        if r.returncode not in (0, 1):
            verdict("share %d of %s" % (i, command), False, r.stderr)
    return paths


def refused(name, *words, told, status=2):
    """One line, and OUT is as it was."""
    write("kept", "old\n")
    r = run("merge", "kept", *words)
    good = r.returncode == status and r.stderr.count("\n") == 1 and re.search(told, r.stderr) and read("kept") == b"old\n"
    verdict("%s: %s" % (name, told), good, (r.returncode, r.stderr))
    return r


def maps():
    print("--- maps", flush=True)
    for name, words in MAPS.items():
        command = [name, *words]
        clear()
        equal("%s: status" % name, run(*command, "--out", "one.csv").returncode, 0)
        parts = shares(command, 3, "p{}.csv", "--out", "p{}.csv")
        r = run("merge", "all.csv", parts[1], parts[2], parts[0])
        equal("%s: three shares in any order are one run, %d bytes" % (name, len(read("one.csv"))), (r.returncode, read("all.csv") == read("one.csv")), (0, True))
        equal("  and told", r.stdout.startswith("3 parts: ") and "%d rows" % (read("one.csv").count(b"\n") - 1) in r.stdout, True)
    command = ["random", *MAPS["random"]]
    clear()
    run(*command, "--out", "one.csv")
    more = shares(command, 8, "m{}.csv", "--out", "m{}.csv")  # three have no job
    equal("eight shares of five jobs", (run("merge", "all.csv", *more).returncode, read("all.csv") == read("one.csv")), (0, True))
    with open("redirected.csv", "wb") as f:
        f.write(run(*command, "--shard", "2/8").stdout.encode())
    equal("rows on standard output tell their share, too", read("redirected.csv").split(b"\n")[1:], read("m2.csv").split(b"\n")[1:])


def lost():
    print("--- missing and cut", flush=True)
    command = ["random", *MAPS["random"]]
    clear()
    parts = shares(command, 5, "l{}.csv", "--out", "l{}.csv")
    whole = {p: read(p) for p in parts}
    run(*command, "--out", "one.csv")
    lines = whole["l3.csv"].splitlines(True)
    for name, text in (("inside a row", b"".join(lines[:2])[:-9]), ("behind a row", b"".join(lines[:-1])), ("before the first row", lines[0]), ("inside the last line", whole["l3.csv"][:-3])):
        with open("l3.csv", "wb") as f:
            f.write(text)
        refused("cut " + name, *parts, told=r"of 5 shares cut: 3 \(l3.csv\); kept is not written", status=1)
    r = refused("missing and cut", "l2.csv", "l5.csv", "l3.csv", told=r"of 5 shares missing: 1, 4; cut: 3 \(l3.csv\); kept is not written", status=1)
    slurm, here = r.stdout.splitlines()
    for path in ("l1.csv", "l4.csv"):
        os.unlink(path)
    script = re.fullmatch(r"sbatch --array=1,3,4 --wrap '(.*)'", slurm)
    equal("the line for Slurm", script and script[1], "i=$SLURM_ARRAY_TASK_ID; contactplant random nayak-random --seeds 5 --over 100 --out l$i.csv --shard $i/5")
    environment = {**os.environ, "PATH": os.path.dirname(program) + ":" + os.environ["PATH"]}
    r = subprocess.run(["sh", "-c", here], capture_output=True, text=True, env=environment)
    equal("the line for this machine: status", (r.returncode, r.stderr.count("\n") <= 3), (0, True))
    equal("  computes what was lost", {p: read(p) for p in parts} == whole, True)
    equal("  and all is one run", (run("merge", "all.csv", *parts).returncode, read("all.csv") == read("one.csv")), (0, True))
    for given, wanted in (("it's 2.csv", r"""'it'\''s '$i.csv"""), ("a002b.csv", "a$(printf %03d $i)b.csv"), ("2/x2_y.csv", "2/x${i}_y.csv"), ("x.csv", "x.csv"), ("ü2.csv", "'ü'$i.csv")):
        os.makedirs("2", exist_ok=True)
        run(*command, "--shard", "2/5", "--out", given)
        told = read(given).decode().splitlines()[0]
        equal("the command of a share in %s" % given, re.search(r"--out (.*) --shard", told)[1], wanted)
        r = subprocess.run(["sh", "-c", "i=2; echo %s" % wanted], capture_output=True, text=True)
        equal("  is that file", r.stdout, given + "\n")
    shutil.copy("l2.csv", "é ü.csv")
    refused("a name in UTF-8", "é ü.csv", "l2.csv", told="é ü.csv and l2.csv are both share 2/5|l2.csv and é ü.csv are both share 2/5")


def strangers():
    print("--- what does not belong together", flush=True)
    command = ["random", *MAPS["random"]]
    run(*command, "--shard", "1/4", "--out", "n4.csv")
    run("random", "nayak-random", "--seeds", "5", "--over", "101", "--shard", "1/5", "--out", "other.csv")
    text = read("l2.csv").decode()
    write("old.csv", text.replace("contactplant 0", "contactplant 1", 1))
    rows = text.splitlines(True)
    write("changed.csv", text.replace(rows[1], rows[1].replace("0.", "1.", 1)))
    write("fewer.csv", "".join(rows[:1] + rows[2:]))
    write("more.csv", text + rows[1])
    write("before.csv", "".join(rows[1:-1]))
    write("begun.csv", text[:20])
    write("empty", "")
    write("binary", "\0\1\2\n")
    refused("other options", "l1.csv", "other.csv", told="l1.csv and other.csv are of different commands")
    refused("another number of shares", "l2.csv", "n4.csv", told="l2.csv is one of 5 shares, and n4.csv one of 4")
    refused("another version", "l1.csv", "old.csv", told="l1.csv is of version [^ ]*, and old.csv of 1")
    refused("a part twice", "l1.csv", "l2.csv", "l1.csv", told="l1.csv and l1.csv are both share 1/5")
    refused("a whole run", "one.csv", told="one.csv: rows that do not tell their share")
    refused("of an earlier version", "l1.csv", "before.csv", told="before.csv: rows that do not tell their share")
    refused("a changed row", "changed.csv", "l1.csv", told=r"changed.csv:\d+: a row was changed or lost here, or before; remove the file and compute this share again")
    refused("a lost row", "fewer.csv", told=r"fewer.csv:\d+: a row was changed or lost")
    write("mark.csv", "\uFEFF" + read("l2.csv").decode())
    write("ends.csv", read("l2.csv").decode().replace("\n", "\r\n"))
    write("none.csv", rows[0] + "# complete: 0 rows\n")
    run("sweep", *MAPS["sweep"], "--shard", "2/2", "--out", "curves.csv")
    curves = read("curves.csv").decode().splitlines(True)
    write("shorter.csv", "".join(curves[:-2] + curves[-1:]))  # all jobs have rows
    refused("a last row lost", "shorter.csv", told=r"shorter.csv:\d+: a row was changed or lost")
    refused("a job without its row", "none.csv", told=r"none.csv:\d+: a row was changed or lost")
    refused("a row behind the end", "more.csv", told=r"more.csv:\d+: a row was changed or lost")
    for name, told in (("empty", "it is empty"), ("begun.csv", "its first line is cut"), ("binary", "no map of shares"), ("mark.csv", "an editor has changed it"), ("ends.csv", "an editor has changed it"), ("nosuch", "No such file"), (".", "Is a directory")):
        refused(name, "l1.csv", name, told=told)
    equal("no part", (run("merge", "kept").returncode, run("merge").returncode), (2, 2))
    before = read("l1.csv")
    os.symlink("l1.csv", "link.csv")
    for out in ("l1.csv", "./l1.csv", "link.csv"):
        r = run("merge", out, "l1.csv", "l2.csv")
        equal("OUT is the part %s" % out, (r.returncode, "read by this command" in r.stderr, read("l1.csv") == before), (2, True, True))
    with open("kept") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        refused("OUT of a running plant", "l1.csv", told="another process writes it")
    with open("l1.csv", "a") as f:
        r = subprocess.run([program, "merge", "all.csv", "l1.csv"], stdout=f, stderr=subprocess.PIPE, text=True)
    equal("a part on standard output", (r.returncode, r.stderr.count("\n"), read("l1.csv") == before), (2, 1, True))
    for out in ("nosuch/all.csv", ".", "/dev/full"):
        r = run("merge", out, *["l%d.csv" % i for i in range(1, 6)])
        equal("OUT is %s" % out, (r.returncode, r.stderr.count("\n"), "cannot write " + out in r.stderr), (1 if "full" in out else 2, 1, True))


def untimed(path):
    return re.sub(rb' (time|timestamp)="[^"]*"', b"", read(path))


def reports():
    print("--- reports of tests", flush=True)
    cases = [CASE % ("c%d" % i, "A-%d" % (i % 4), BAD if i in (2, 5) else GOOD) for i in range(6)]
    write("s<&> ü.test", HEAD + "".join(cases))
    write("t.test", HEAD + "".join(CASE % ("d%d" % i, "B-1", GOOD) for i in range(3)))
    write("list.csv", "".join("%s\n" % i for i in ("A-0", "A-1", "A-2", "A-3", "B-1", "Z-9")))
    command = ["test", "s<&> ü.test", "t.test", "--requirements", "list.csv", "--seed", "3"]
    equal("one run has two failures", run(*command, "--junit", "one.xml", "--json", "one.json").returncode, 1)
    shares(command, 4, "", "--junit", "j{}.xml", "--json", "j{}.json")
    for kind in ("xml", "json"):
        parts = ["j%d.%s" % (i, kind) for i in (3, 1, 4, 2)]
        r = run("merge", "all." + kind, *parts)
        equal("%s: four shares are one run" % kind, (r.returncode, r.stderr, untimed("all." + kind) == untimed("one." + kind)), (0, "", True))
        r = refused("a share of %s missing" % kind, *[p for p in parts if p != "j3." + kind], told="of 4 shares missing: 3; kept is not written", status=1)
        for path in ("j3.xml", "j3.json"):
            os.rename(path, "away." + path)
        environment = {**os.environ, "PATH": os.path.dirname(program) + ":" + os.environ["PATH"]}
        subprocess.run(["sh", "-c", r.stdout.splitlines()[1]], capture_output=True, env=environment)
        equal("  is computed by the line", untimed("j3." + kind), untimed("away.j3." + kind))
        refused("a part of %s twice" % kind, "j1." + kind, "j2." + kind, "j1." + kind, told="are both share 1/4")
        text = read("j3." + kind).decode()
        write("cut." + kind, text[:-20])
        refused("a cut share of %s" % kind, "j1." + kind, "j2." + kind, "j4." + kind, "cut." + kind, told=r"cut: 3 \(cut.%s\)" % kind, status=1)
        mark = {"xml": "<?contactplant complete: 2 cases?>\n", "json": ', "complete": "complete: 2 cases"'}[kind]
        write("unmarked." + kind, text.replace(mark, ""))
        refused("a share of %s without its mark" % kind, "j1." + kind, "j2." + kind, "j4." + kind, "unmarked." + kind, told=r"cut: 3 \(unmarked.%s\)" % kind, status=1)
        write("other." + kind, text.replace("complete: 2", "complete: 3"))
        refused("a share of %s with another number of cases" % kind, "other." + kind, told="other.%s:\\d+: not as contactplant test" % kind)
        write("odd." + kind, text.replace("case", "cafe"))
        refused("%s of somebody" % kind, "odd." + kind, told="odd.%s" % kind)
    root = xml.parse("all.xml").getroot()
    suites = [(s.get("name"), *[int(s.get(k)) for k in ("tests", "failures", "errors")]) for s in root.iter("testsuite")]
    equal("one suite for each test file, sums right", suites, [("s<&> ü.test", 6, 2, 0), ("t.test", 3, 0, 0)])
    equal("  and of all", [int(root.get(k)) for k in ("tests", "failures", "errors")], [9, 2, 0])
    equal("  and times", abs(sum(float(c.get("time")) for c in root.iter("testcase")) - float(root.get("time"))) < 0.006, True)
    told = json.loads(read("all.json"))
    equal("the matrix: requirements of each case", {c["case"]: c["requirements"] for c in told["cases"]}, {**{"c%d" % i: ["A-%d" % (i % 4)] for i in range(6)}, **{"d%d" % i: ["B-1"] for i in range(3)}})
    equal("  and those of no case", told["untraced"], ["Z-9"])
    equal("a part tells its share", json.loads(read("j2.json"))["share"].split(":")[0].split(",")[0], "share 2/4 of 9 cases")

    print("--- a share that is stopped", flush=True)
    cases = [CASE % (c, "A-1", GOOD) for c in ("short", "long", "c", "d")]
    write("long.test", HEAD + "".join(cases).replace("[case long]\nrequirement = A-1\nover = ", "[case long]\nover = 86400 s # "))
    for shard in ("1/2", "1/1"):
        with subprocess.Popen([program, "test", "long.test", "--cores", "1", "--shard", shard, "--junit", "stop1.xml", "--json", "stop1.json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as p:
            p.stdout.readline()  # of the short case
            p.terminate()
            p.communicate()
        equal("its cases are in the report", [c["verdict"] for c in json.loads(read("stop1.json"))["cases"]][:2], ["ok", "error"])
        for kind in ("xml", "json"):
            if shard == "1/2":
                refused("  which is not complete", "stop1." + kind, told=r"of 2 shares missing: 2; cut: 1 \(stop1.%s\); kept is not written" % kind, status=1)
            else:
                refused("  and that of a whole command", "stop1." + kind, told="stop1.%s: its end is missing; run its command again" % kind)

    print("--- reports of whole commands", flush=True)
    for name in ("s<&> ü", "t"):
        run("test", name + ".test", "--requirements", "list.csv", "--junit", name[0] + ".xml", "--json", name[0] + ".json")
    one = ["A-0", "A-1", "A-2", "A-3", "B-1", "Z-9"]
    equal("two files alone: untraced", [json.loads(read(f))["untraced"] for f in ("s.json", "t.json")], [one[4:], one[:4] + one[5:]])
    equal("two reports of two files", [run("merge", "all." + k, "s." + k, "t." + k).returncode for k in ("xml", "json")], [0, 0])
    equal("  JUnit: suites", [s.get("name") for s in xml.parse("all.xml").getroot().iter("testsuite")], ["s<&> ü.test", "t.test"])
    equal("  JSON: what no case names", json.loads(read("all.json"))["untraced"], ["Z-9"])
    shutil.copy("t.xml", "again.xml")
    shutil.copy("t.json", "again.json")
    for kind in ("xml", "json"):
        refused("a case twice in %s" % kind, "t." + kind, "s." + kind, "again." + kind, told="t.%s and again.%s have the same case: .*t.test.*d0" % (kind, kind))
        refused("a share beside a whole %s" % kind, "j1." + kind, "t." + kind, told="j1.%s is a share, and t.%s is none" % (kind, kind))
        write("cut." + kind, read("t." + kind).decode()[:-20])
        refused("a cut %s" % kind, "cut." + kind, told="cut.%s: its end is missing" % kind)
    refused("two kinds", "t.xml", "t.json", told="t.xml is JUnit, and t.json is JSON")
    refused("a map and JUnit", "l1.csv", "j1.xml", told="l1.csv is a map, and j1.xml is JUnit")
    run("test", "t.test", "--shard", "1/4", "--junit", "k1.xml")
    refused("shares of two commands", "k1.xml", "j2.xml", told="k1.xml and j2.xml are of different commands")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    write("rig.ini", re.sub(r"damping *= *[\d.]+", "damping = 2000", run("scene", "rig").stdout))
    maps()
    lost()
    strangers()
    reports()
    os.chdir("/")
conclude()
