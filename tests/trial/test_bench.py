#!/usr/bin/env python3
"""test_bench.py BUILD - contactplant test outlives its controllers: those that kill, stop or flood it, shell lines as commands, names of
records, golden logs, the command for a case again. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import json
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from processes import running  # noqa: E402
from verdicts import conclude, equal, verdict  # noqa: E402

build = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build")
root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
program = os.path.join(build, "contactplant")
KEEP = "{contactplant} control {options} --force 0 --duration 1e6"
CASE = "over = 0.2 s\nexpect contact_loss <= 1 %\n"
MARK = "sleep 1003"  # processes that a controller leaves


def path(name):
    return os.path.join(directory, name)


def write(name, text):
    os.makedirs(os.path.dirname(path(name)), exist_ok=True)
    with open(path(name), "w") as f:
        f.write(text)
    return name


def read(name):
    with open(path(name), "rb") as f:
        return f.read()


def file_of(command, cases="[case c]\n" + CASE, name="t.test"):
    return write(name, "[plant]\nscene = hertz_rig\n[controller]\n%s\n%s" % ("command = " + command if command else "builtin = keep", cases))


def test(*arguments, **more):
    r = subprocess.run([program, "test", *arguments], capture_output=True, text=True, cwd=directory, timeout=120, **more)
    r.verdicts = [line.split()[0] for line in r.stdout.splitlines() if re.match(r"(ok|FAIL|untested|error) ", line)]
    return r


def left():
    """Processes that a controller left, by their command line."""
    return running(lambda line: line == MARK.replace(" ", "\0").encode() + b"\0")


# ---- a bus that cannot be had ----


def test_no_bus():
    """In real time the case has the reason that monitor prints, and its controller is not blamed."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as held:
        held.bind(("127.0.0.1", 0))
        buses = ("can:none0", "udp:1.2.3.4:5", "udp:99999", "udp:127.0.0.1:%d" % held.getsockname()[1])
        for command in (None, KEEP):
            name = file_of(command)
            for bus in buses:
                m = subprocess.run([program, "monitor", "--bus", bus, "--duration", "0.1"], capture_output=True, text=True)
                r = test(name, "--realtime", "--bus", bus, "--junit", path("j.xml"))
                why = m.stderr.split(": ", 1)[1].split("; see")[0].strip()
                wanted = 2 if m.returncode == 2 else 3
                verdict("%s --realtime --bus %s: %s" % (command or "builtin", bus, why), r.returncode == wanted and why in r.stdout + r.stderr and "signal" not in r.stdout, (r.returncode, r.stdout, r.stderr, m.stderr))
    name = file_of("false")
    equal("a case in error with --junit: status", test(name, "--junit", path("j.xml")).returncode, 3)
    equal("  and where that cannot be written", test(name, "--junit", "/dev/full").returncode, 1)


# ---- controllers that harm the bench ----

# a process that hides in the bench's own group
LEAVES = "/usr/bin/python3 -c \"import os; os.fork() or (os.setpgid(0, os.getpgid($PPID)), os.execvp('sleep', ['sleep', '1003']))\"; sleep 0.3"
HARM = {  # what the controller does first, and what the case's error says; None: nothing comes of it
    "kill -9 $PPID": "ended by signal 9 (Killed); a controller must not signal its parent",
    "kill -TERM $PPID; sleep 20": "ended by signal 15", "kill -SEGV $PPID; sleep 20": "ended by signal 11", "kill -BUS $PPID; sleep 20": "ended by signal 7",
    "kill -9 0": "the controller ended before plant time ran: it ended by signal 9",
    "setsid sh -c 'kill -9 '$PPID'; exec %s'; sleep 20" % MARK: "ended by signal 9", "%s & kill -9 $PPID" % MARK: "ended by signal 9",
    LEAVES: "the controller left 1 processes behind, which were ended", LEAVES + "; kill -9 $PPID": "ended by signal 9 (Killed)",
    "kill -STOP $PPID": None, "truncate -s 0 $1": None, "true > $1": None, "exec 0<&- 2>&-": None,
    "yes | head -c 30000000": None, "head -c 30000000 /dev/zero": None, "exec yes": "no word of the controller for 1 s; --patience 0 waits for ever; it printed ",
}


def test_harm():
    cases = "[case a]\n%s[case b]\nlike = a\nseeds = 1..2\n[case c]\nlike = a\n" % CASE
    write("keep.c", open(os.path.join(root, "docs/examples/keep.c")).read())
    shutil.copy(os.path.join(root, "docs/examples/word.h"), directory)
    c = subprocess.run([os.environ.get("CC", "cc"), "-O2", "keep.c", "-I" + root + "/host_sim/library", build + "/libcontactplant.a", "-lm", "-o", "keep"],
                       cwd=directory, capture_output=True, text=True)
    verdict("keep.c compiles", c.returncode == 0, c.stderr)
    for harm, wanted in HARM.items():  # the second case, by its rate
        write("harm.sh", "#!/bin/sh\ncase $4 in 2000*) %s ;; esac\nexec ./keep $2 $3 $4 $5 $1\n" % harm)
        os.chmod(path("harm.sh"), 0o755)
        name = file_of("./harm.sh {memory} {plant} {me} {rate} {substeps}", cases.replace("seeds", "rate = 2 kHz\nseeds"))
        for f in ("j.xml", "j.json", "r.html"):
            if os.path.exists(path(f)):
                os.unlink(path(f))
        r = test(name, "--cores", "1", "--patience", "1", "--junit", "j.xml", "--json", "j.json", "--report", "r.html")
        shown = re.sub(r"\s+", " ", harm)[:40]
        good = r.returncode == (3 if wanted else 0) and r.verdicts == ["ok", "error" if wanted else "ok", "ok"] and (wanted or "ok") in r.stdout
        verdict("%s: %s, and the cases beside it run" % (shown, wanted or "no harm"), good, r.stdout + r.stderr)
        found = json.loads(read("j.json"))["cases"]
        xml_errors = [len(c.findall("error")) > 0 for c in xml.etree.ElementTree.parse(path("j.xml")).getroot().iter("testcase")]
        verdict("  JSON, JUnit and page have all three", [x["verdict"] for x in found] == r.verdicts and xml_errors == [False, bool(wanted), False] and
                b"</html>" in read("r.html") and (not wanted or found[1]["bad_runs"] == 2), (found, xml_errors))
        for _ in range(50):
            if left():
                time.sleep(0.1)
        verdict("  no process is left", not left(), left())


def test_before():
    """What the shell had started before it became the bench is no controller's."""
    file_of(None)
    c = subprocess.run("setsid sleep 60 >/dev/null 2>&1 & echo $!; exec %s test t.test" % program, shell=True, cwd=directory, capture_output=True, text=True)
    pid = int(c.stdout.split()[0])
    try:
        os.kill(pid, signal.SIGTERM)
        lives = True
    except ProcessLookupError:
        lives = False
    verdict("a process that was there before the bench goes on", c.returncode == 0 and lives, c.stdout + c.stderr)


def test_ends():
    """Reports are written whatever ends the run."""
    write("wait.test", "[plant]\nscene = hertz_rig\n[controller]\ncommand = cd . && %s\n[case a]\nover = 0.05 s\nexpect refused == 0\n[case b]\nlike = a\nover = 100000 s\n[case c]\nlike = b\n" % KEEP)
    with subprocess.Popen([program, "test", "wait.test", "--cores", "1", "--junit", "w.xml", "--json", "w.json"], cwd=directory, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True) as p:
        line = p.stdout.readline()
        p.send_signal(signal.SIGTERM)
        out, err = p.communicate(timeout=60)
    found = json.loads(read("w.json"))["cases"]
    verdict("SIGTERM: what did not run to its end is an error in every report", p.returncode == 3 and line.startswith("ok ") and "interrupted" in err and
            [c["verdict"] for c in found] == ["ok", "error", "error"] and all("interrupted" in c["error"] for c in found[1:]) and read("w.xml").count(b"<error") == 2, out + err)
    r = subprocess.run("%s test wait.test --case a --junit full.xml --json w2.json | head -c 1" % program, shell=True, cwd=directory, capture_output=True, text=True)
    verdict("a reader that leaves: JUnit and JSON are complete", json.loads(read("w2.json"))["cases"][0]["verdict"] == "ok" and b"</testsuites>" in read("full.xml"), r.stderr)
    r = test("wait.test", "--case", "a", "--junit", "/dev/full", "--json", "w3.json")
    verdict("JUnit that cannot be written: JSON is, status 1", r.returncode == 1 and "--junit /dev/full" in r.stderr and json.loads(read("w3.json"))["cases"], r.stderr)


# ---- shell lines ----

LINES = {  # a command, and a line that its shell prints
    "FOO='a b' sh -c 'echo \"[$FOO]\"; exec %s'" % KEEP: "[a b]", "cd sub && pwd && exec %s" % KEEP: "/sub", "export X=7 && echo x$X && %s" % KEEP: "x7",
    "echo 'one; two # three' && %s  # a comment, it's here" % KEEP: "one; two # three", "echo \"a;b\" \\; \\# && %s ; a comment" % KEEP: "a;b ; #",
    "%s | cat" % KEEP: None, "cat /dev/null | %s" % KEEP: None, "if true && false || true && %s" % KEEP: "unexpected", "exec %s" % KEEP: None,
    "(%s)" % KEEP: None, "'{contactplant}' control {options} --force 0 --duration 1e6": None, "\"{contactplant}\" control {options} --force 0 --duration 1e6": None,
    "sh -c '{contactplant} control {options} --force 0 --duration 1e6'": None,
}


def test_lines():
    os.makedirs(path("sub"), exist_ok=True)
    for command, line in LINES.items():
        r = test(file_of(command), "--log", "lines", "--patience", "5")
        printed = read("lines/t.c.controller.txt").decode()
        wrong = line == "unexpected"
        good = (r.returncode == 3 and "syntax" in printed.lower()) if wrong else r.returncode == 0 and (line or "streamed force" if "|" not in command else "") in printed
        verdict("command = %s" % command[:60], good, r.stdout + r.stderr + printed)
    for command, mark in (("echo 'a; b", "'"), ('echo "a # b', '"'), ("echo 'it'\\''s", "'")):
        r = test(file_of(command))
        verdict("command = %s: refused" % command, r.returncode == 2 and "t.test:4: command: the quote %s does not end" % mark in r.stderr and not r.stdout, r.stderr)
    write("says.sh", "echo hello; exit 3\n")
    r = test(file_of(". ./says.sh"))
    verdict("command = . ./says.sh is a line of the shell", r.returncode == 3 and "it ended with status 3; its last line: hello" in r.stdout, r.stdout)
    r = test(file_of("cd . && sh -c 'kill -SEGV $$'"))
    verdict("a line that ends early is told", r.returncode == 3 and "it ended with status 139" in r.stdout, r.stdout)
    r = test(file_of("sh -c 'kill -SEGV $$'"))
    verdict("a program that ends by a signal, too", r.returncode == 3 and "it ended by signal 11" in r.stdout, r.stdout)
    scene = "it's; \"my\" $HOME scene.ini"
    os.makedirs(path("a b"), exist_ok=True)
    shutil.copy(program, path("a b/contact'plant"))
    write(scene, subprocess.run([program, "scene", "rig"], capture_output=True, text=True).stdout)
    own = write("own.test", "[plant]\nscene = own.ini\n[controller]\nbuiltin = keep\n[case c]\n" + CASE)
    os.replace(path(scene), path("own.ini"))
    r = subprocess.run([path("a b/contact'plant"), "test", own], capture_output=True, text=True, cwd=directory)
    verdict("a program whose path has a blank and a '", r.returncode == 0, r.stdout + r.stderr)


# ---- names of records ----

def test_names():
    keep = lambda force, *names: "".join("[case %s]\nover = 0.05 s\nat 0.01 s arm force amplitude=%d N frequency=225 Hz\nexpect contact_loss <= 100 %%\n" % (n, force + i) for i, n in enumerate(names))
    first = file_of(None, keep(1, "a b", "a/b", "A b", "a_b", "a_b-2", "x.1", "b.x") + "[case x]\nlike = x.1\nseeds = 1..2\n[case v]\nlike = x.1\nvary = mass 5 kg .. 5.0000001 kg in 3\n", "one/t.test")
    second = file_of(None, keep(20, "a b", "x"), "two/t.test")
    third = file_of(None, keep(30, "x"), "two/t.b.test")
    r = test(first, second, third, "--log", "logs", "--json", "n.json", "--junit", "n.xml", "--report", "n.html", "--cores", "2")
    logs = [f for f in os.listdir(path("logs")) if f.endswith(".log")]
    runs = 7 + 2 + 3 + 2 + 1
    verdict("%d runs, %d logs that differ by more than capitals" % (runs, len(logs)), r.returncode == 0 and len({x.lower() for x in logs}) == runs, (r.stdout + r.stderr, sorted(logs)))
    contents = {read("logs/" + x) for x in logs if not x.startswith(("t.v", "t.x-2"))}
    verdict("  each is that of its run", len(contents) == len([x for x in logs if not x.startswith(("t.v", "t.x-2"))]), sorted(logs))
    named = [c["log"] for c in json.loads(read("n.json"))["cases"]]
    verdict("  JSON and JUnit name them", len(set(named)) == 12 and all(os.path.exists(path(x)) for x in named) and
            [p.get("value") for p in xml.etree.ElementTree.parse(path("n.xml")).getroot().iter("property") if p.get("name") == "log"] == named and all(x.encode() in read("n.html") for x in named), named)
    alone = json.loads(read("n.json"))["cases"][2]
    test(first, "--case", alone["case"], "--log", "again", "--json", "n2.json")
    verdict("  a case alone has the name that it has among others", os.path.basename(json.loads(read("n2.json"))["cases"][0]["log"]) == os.path.basename(alone["log"]), alone["log"])
    verdict("  and the same bytes", read("again/" + os.path.basename(alone["log"])) == read(alone["log"]))


# ---- JUnit ----

def test_junit():
    r = test(file_of(None, "[case a]\n" + CASE, "one/j.test"), file_of(None, "[case b]\n" + CASE + "[case c]\n" + CASE + "expect touchdowns == 5\n", "two/j.test"), "--junit", "s.xml")
    suites = list(xml.etree.ElementTree.parse(path("s.xml")).getroot())
    verdict("a suite for each file, with its counts", [(s.get("name"), s.get("file"), s.get("tests"), s.get("failures"), s.get("errors")) for s in suites] ==
            [("one/j.test", "one/j.test", "1", "0", "0"), ("two/j.test", "two/j.test", "2", "1", "0")], r.stdout)
    age = [time.time() - time.mktime(time.strptime(s.get("timestamp") + " UTC", "%Y-%m-%dT%H:%M:%S %Z")) + time.timezone for s in suites]
    verdict("  timestamp and hostname", all(-2 < a < 120 for a in age) and all(s.get("hostname") == os.uname().nodename for s in suites), age)
    verdict("  file and line of each case", [(c.get("file"), c.get("line")) for s in suites for c in s] == [("one/j.test", "5"), ("two/j.test", "5"), ("two/j.test", "8")])


# ---- again ----

def again(r):
    return re.search(r"again: (contactplant .*)", r.stdout).group(1)


def test_again():
    """The command that a FAIL prints, pasted into a shell, runs that case alone."""
    shell = dict(os.environ, PATH=build + ":" + os.environ["PATH"])
    for name, case in (("my tests/a.test", "it's bad"), ("$HOME `x`.test", "a \"b\" $c `d`"), ("-x.test", "-y"), ("plain.test", "plain"), ("it's/ü.test", "*")):
        file_of(None, "[case other]\n%s[case %s]\n%sexpect touchdowns == 5\n" % (CASE, case, CASE), name)
        r = test("--", name)
        c = subprocess.run(again(r), shell=True, cwd=directory, env=shell, capture_output=True, text=True)
        lines = [x[10:34].strip() for x in c.stdout.splitlines() if re.match("(ok|FAIL) ", x)]
        verdict("again: %s" % again(r), lines == [case] and c.returncode == 1, c.stdout + c.stderr)
    shutil.rmtree(path("again"), ignore_errors=True)
    r = test(file_of(None, "[case s]\nlink = in.drop=0.5\nseeds = 1..3\n%sexpect touchdowns == 5\n" % CASE), "--seed", "3", "--patience", "7")
    verdict("with the seed and the options of the command line", shlex.split(again(r))[3:] == ["--case", "s", "--seed", "3", "--patience", "7", "--log", "again"], again(r))
    folders = ["fresh/one/x.test", "fresh/two/X.test"]
    for i, name in enumerate(folders):
        file_of(None, "[case x]\nover = 0.05 s\nat 0.01 s arm force amplitude=%d N frequency=225 Hz\nexpect touchdowns == 5\n" % (i + 1), name)
    write("fresh/again", "a file of somebody\n")
    here = dict(env=shell, cwd=path("fresh"), capture_output=True, text=True)
    for turn in range(2):
        r = subprocess.run([program, "test", *(f.partition("/")[2] for f in folders)], **here)
        for line in re.findall("again: (contactplant .*)", r.stdout):
            subprocess.run(line, shell=True, **here)
    logs = sorted(os.path.join(d, f) for d, _, files in os.walk(path("fresh")) for f in files if f.endswith(".log"))
    verdict("the commands of two files of one name, twice: no record is written over, nor a file of that name", len(logs) == 4 and read("fresh/again") == b"a file of somebody\n" and
            len({open(x, "rb").read() for x in logs}) == 2, logs)
    page = "it's $(touch page.was.here)"
    test("plain.test", "--case", "plain", "--report", page)
    command = json.loads(re.search(rb'id="data">\s*(\{.*\})\s*</script>', read(page), re.S).group(1))["command"]
    os.unlink(path(page))
    subprocess.run(command, shell=True, cwd=directory, env=shell, capture_output=True)
    verdict("the command of a page, too: %s" % command, os.path.exists(path(page)) and not os.path.exists(path("page.was.here")))


def test_golden():
    """No record goes over the golden log, by any name."""
    case = "[case shaken]\nover = 0.3 s\n%sat 0.1 s arm force amplitude=%d N frequency=225 Hz ramp=0.1 s\nexpect contact_loss <= 100 %%\n"
    test(file_of(None, case % ("", 3), "g/g.test"), "--log", "g")
    golden = read("g/g.shaken.log")
    file_of(None, case % ("golden = g.shaken.log\n", 6), "g/g.test")
    os.makedirs(path("hard"), exist_ok=True)
    os.makedirs(path("soft"), exist_ok=True)
    os.link(path("g/g.shaken.log"), path("hard/g.shaken.log"))
    os.symlink("../g/g.shaken.log", path("soft/g.shaken.log"))
    for folder in ("g", "./g", "hard", "soft", path("g")):
        r = test("g/g.test", "--log", folder)
        verdict("--log %s: refused before anything runs" % os.path.relpath(path(folder), directory), r.returncode == 2 and not r.stdout and r.stderr.count("\n") == 1, r.stdout + r.stderr)
    r = test("g/g.test")
    verdict("a changed run is a FAIL", r.returncode == 1, r.stdout)
    c = subprocess.run(again(r).replace("contactplant", shlex.quote(program), 1), shell=True, cwd=directory, capture_output=True, text=True)
    verdict("  and stays one by the command that it advises", c.returncode == 1 and "FAIL" in c.stdout and os.path.exists(path("again/g.shaken.log")), c.stdout + c.stderr)
    verdict("  the golden log is as it was", read("g/g.shaken.log") == golden)
    os.unlink(path("g/g.shaken.log"))
    os.makedirs(path("new"), exist_ok=True)
    file_of(None, (case % ("golden = ../new/w.shaken.log\n", 6)) + (case % ("", 3)).replace("shaken", "other"), "new/w.test")
    for arguments in (("g/g.test", "--log", "g"), ("new/w.test", "--log", "new"), ("new/w.test", "--log", "new", "--case", "other", "--json", "new/w.other.log")):
        r = test(*arguments)
        verdict("a missing golden log or another output: %s is refused, and nothing is made" % " ".join(arguments), r.returncode == 2 and r.stderr.count("\n") == 1 and
                not os.path.exists(path("g/g.shaken.log")) and os.listdir(path("new")) == ["w.test"], r.stdout + r.stderr)
    r = test("g/g.test", env=dict(os.environ, TMPDIR="/no/such/folder"))
    verdict("no folder for what is compared with a golden log: TMPDIR is named", r.returncode == 3 and "TMPDIR: cannot write /no/such/folder/" in r.stdout, r.stdout)
    r = test("g/g.test", "--log", "no/such/folder")
    verdict("a folder in no folder: refused", r.returncode == 2 and not r.stdout, r.stderr)
    file_of(None, case % ("golden = made/m.shaken.log\n", 3), "m.test")
    r = test("m.test", "--log", "./made")
    verdict("a missing golden log in a folder that --log makes: an error, by no name a comparison with itself", r.returncode in (2, 3) and "ok " not in r.stdout, r.stdout + r.stderr)
    write("g/g.shaken.log", golden.decode())
    os.makedirs(path("here/again"), exist_ok=True)
    shutil.copy(path("g/g.test"), path("here/g.test"))
    shutil.copy(path("g/g.shaken.log"), path("here/again/g.shaken.log"))
    text = read("here/g.test").decode().replace("golden = ", "golden = again/")
    r = subprocess.run([program, "test", os.path.basename(write("here/g.test", text))], cwd=path("here"), capture_output=True, text=True)
    verdict("  a golden log in the folder of that name: another one is advised", again(r).endswith("--log again-2"), again(r))


with tempfile.TemporaryDirectory() as directory:
    for part in (test_no_bus, test_harm, test_before, test_ends, test_lines, test_names, test_junit, test_again, test_golden):
        part()
conclude()
