#!/usr/bin/env python3
"""test_seeds.py BUILD SANITIZED_BUILD SEEDS STOP_S - the example controllers: no false alarm on a bad link with so many seeds, equal logs by
gcc and by clang with its sanitizers, and by a controller that was stopped for STOP_S seconds. `make trial-seeds` runs 1000 seeds and
20 s. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import mmap
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, verdict  # noqa: E402

build, sanitized_build, seeds, stop_s = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
EXAMPLES = ("keep", "damp", "track", "avoid", "detune")
TEST_FILES = (*EXAMPLES, "keep_faults")
BAD = "drop=0.02,in.delay=0.05:5"
LINKS = {  # a case that is ok on a good link, and the bad link that its controller is to stand
    "keep": ("quiet", BAD), "damp": ("fast enough", BAD), "track": ("finds it", "drop=0.01,in.delay=0.05:5"),
    "avoid": ("sweep", BAD), "detune": ("disturbed", BAD),
}


def path(name):
    return os.path.join(directory, name)


def read(name):
    with open(path(name), "rb") as f:
        return f.read()


def compile_all(compiler, library, folder, *flags):
    os.makedirs(path(folder), exist_ok=True)
    for name in ("word.h", *(x + ".c" for x in EXAMPLES), *(x + ".test" for x in TEST_FILES)):
        shutil.copy(os.path.join(root, "docs/examples", name), path(folder))
    for name in EXAMPLES:
        c = subprocess.run([compiler, "-O2", *flags, name + ".c", "-I" + root + "/host_sim/library", library + "/libcontactplant.a", "-lm", "-o", name], cwd=path(folder), capture_output=True, text=True)
        verdict("%s compiles with %s" % (name, compiler), c.returncode == 0, c.stderr)


def case_of(folder, name, case, more):
    """A file with this case alone."""
    with open(path("%s/%s.test" % (folder, name))) as f:
        head, *cases = re.split(r"(?m)^(?=\[case )", f.read())
    body = next(c for c in cases if c.startswith("[case %s]" % case))
    with open(path("%s/one.test" % folder), "w") as f:
        f.write(head + body.rstrip() + "\n" + more)


def test_seeds():
    for name, (case, link) in LINKS.items():
        case_of("gcc", name, case, "link = %s\nseeds = 1..%d\nexpect refused <= 1000000\n" % (link, seeds))
        r = subprocess.run([build + "/contactplant", "test", "one.test"], cwd=path("gcc"), capture_output=True, text=True)
        verdict("%s on a bad link, %d seeds: no false alarm" % (name, seeds), r.returncode == 0, r.stdout + r.stderr)


def speak_udp(file):
    """The same file with a command that does not take the memory."""
    with open(file) as f:
        text = f.read()
    with open(file, "w") as f:
        f.write(text.replace(" {memory}", ""))


def test_compilers():
    for name in TEST_FILES:
        speak_udp(path("clang/%s.test" % name))
    for folder, program in (("gcc", build), ("clang", sanitized_build)):
        for name in TEST_FILES:
            subprocess.run([program + "/contactplant", "test", name + ".test", "--log", "logs"], cwd=path(folder), capture_output=True)
    logs = sorted(x for x in os.listdir(path("gcc/logs")) if x.endswith(".log"))
    apart = [x for x in logs if not os.path.exists(path("clang/logs/" + x)) or read("gcc/logs/" + x) != read("clang/logs/" + x)]
    verdict("%d logs by gcc through memory and by clang over UDP, plant and controller: equal to the byte" % len(logs), len(logs) == 19 and not apart, (len(logs), apart))


def controllers():
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if os.readlink("/proc/%s/exe" % pid) == path("gcc/keep"):
                found.append(int(pid))
        except OSError:
            continue
    return found


def test_stop():
    case_of("gcc", "keep", "quiet", "")
    with open(path("gcc/one.test")) as f:
        text = f.read().replace("over = 3 s", "over = 36 s")
    with open(path("gcc/one.test"), "w") as f:
        f.write(text)
    for folder in ("as_it_is", "stopped", "udp"):
        if folder == "udp":
            speak_udp(path("gcc/one.test"))
        p = subprocess.Popen([build + "/contactplant", "test", "one.test", "--log", folder, "--patience", "0"], cwd=path("gcc"), stdout=subprocess.PIPE, text=True)
        pid = []
        while folder != "as_it_is" and p.poll() is None and not pid:
            pid = controllers()
        begin = time.time()
        for x in pid:  # several times: what a stop interrupts differs
            for length_s in (0.02, 0.02, 0.02, stop_s):
                time.sleep(0.02)
                os.kill(x, signal.SIGSTOP)
                time.sleep(length_s)
                os.kill(x, signal.SIGCONT)
        text = p.communicate()[0]
        verdict("keep for 36 s%s" % {"as_it_is": "", "stopped": ", stopped 3 times and then for %g s" % stop_s, "udp": ", stopped so over UDP"}[folder], p.returncode == 0 and (folder == "as_it_is" or time.time() - begin > stop_s), text)
    for folder in ("stopped", "udp"):
        verdict("  %s: the log is equal to the byte" % ("through memory" if folder == "stopped" else "over UDP"), read("gcc/as_it_is/one.quiet.log") == read("gcc/%s/one.quiet.log" % folder) and len(read("gcc/as_it_is/one.quiet.log")) > 1e6)


RING = 192 + 32 * 2048  # bytes of a ring of the memory, docs/guide/lockstep.md
WRITTEN, PROCESSOR, TAKEN, SLOT = 0, 4, 64, 192


def count(memory, at):
    return struct.unpack_from("<I", memory, at)[0]


def until(condition, seconds=30):
    end = time.time() + seconds
    while not condition() and time.time() < end:
        time.sleep(0.005)
    return condition()


def keep_on(memory):
    return subprocess.Popen(["./patient", "127.0.0.1:1", "127.0.0.1:2", "1000", "64", memory], cwd=path("gcc"), stderr=subprocess.PIPE, text=True)


def test_memory():
    """Controllers that die, plants that end, and files that are no plant's memory."""
    rig = path("rig")
    with open(path("gcc/word.h")) as f:  # so that patience does not end what should end at once
        text = f.read().replace("WORD_PATIENCE_S = 10", "WORD_PATIENCE_S = 1000")
    os.makedirs(path("patient"))
    with open(path("patient/word.h"), "w") as f:
        f.write(text)
    shutil.copy(path("gcc/keep.c"), path("patient"))
    c = subprocess.run(["gcc", "-O2", "patient/keep.c", "-I" + root + "/host_sim/library", build + "/libcontactplant.a", "-lm", "-o", "gcc/patient"], cwd=directory, capture_output=True, text=True)
    verdict("a patient keep compiles", c.returncode == 0, c.stderr)
    plant = subprocess.Popen([build + "/contactplant", "run", "--lockstep", "--bus", "memory:" + rig, "--patience", "0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    until(lambda: os.path.exists(rig) and os.path.getsize(rig) == 2 * RING)
    with open(rig, "r+b") as f, mmap.mmap(f.fileno(), 2 * RING) as m:
        unread = lambda: count(m, RING + WRITTEN) - count(m, RING + TAKEN)
        for i in range(4):
            before = count(m, WRITTEN)
            me = keep_on(rig)
            told = until(lambda: count(m, WRITTEN) > before + 100)
            if i < 3:
                me.kill()
                me.wait()
                until(lambda: count(m, TAKEN) == count(m, WRITTEN) and unread() > 0, 1)
            else:
                os.kill(me.pid, signal.SIGSTOP)
                until(lambda: count(m, TAKEN) == count(m, WRITTEN))
                verdict("memory: the controller after three that died takes each answer", told and unread() <= 1, unread())
                one = min(os.sched_getaffinity(0))
                for process in (plant.pid, me.pid):
                    os.sched_setaffinity(process, {one})
                before = count(m, WRITTEN)
                os.kill(me.pid, signal.SIGCONT)
                told = until(lambda: count(m, WRITTEN) > before + 100) and [count(m, PROCESSOR), count(m, RING + PROCESSOR)]
                verdict("memory: both sides tell their processor, plus 1", told == [one + 1, one + 1], told)
        plant.send_signal(signal.SIGINT)
        plant.communicate()
        try:
            verdict("memory: a controller ends when its plant does", me.wait(60) == 1)
        except subprocess.TimeoutExpired:
            verdict("memory: a controller ends when its plant does", False, "it waits")
            me.kill()
    for name, size in (("an empty file", 0), ("a file that is too long", 2 * RING + 1)):
        with open(rig, "wb") as f:
            f.truncate(size)
        c = keep_on(rig)
        why = c.communicate()[1]
        verdict("memory: %s is refused" % name, c.returncode == 1 and "cannot be opened" in why, (c.returncode, why))
    with open(rig, "wb") as f:
        f.truncate(2 * RING)
    me = keep_on(rig)
    with open(rig, "r+b") as f, mmap.mmap(f.fileno(), 2 * RING) as m:
        until(lambda: count(m, WRITTEN) == 1)
        struct.pack_into("<I", m, RING + SLOT, 0xFFFFFFFF)
        struct.pack_into("<I", m, RING + WRITTEN, 1)
        for wake in (signal.SIGSTOP, signal.SIGCONT):  # there is no futex call in Python: a stop wakes it, too
            me.send_signal(wake)
        me.communicate()
    verdict("memory: an answer of four billion bytes ends it", me.returncode == 1, me.returncode)


with tempfile.TemporaryDirectory() as directory:
    compile_all("gcc", build, "gcc")
    compile_all("clang", sanitized_build, "clang", "-fsanitize=address,undefined")
    for part in (test_memory, test_compilers, test_stop, test_seeds):
        part()
conclude()
