#!/usr/bin/env python3
"""test_lockstep.py PROGRAM - contactplant run --lockstep between processes: runs that are paced or not, stopped or not,
are equal to the byte; silence, death and strangers end as they should. Everything is judged by bytes, hashes and exit
statuses, nothing by time. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import json
import mmap
import os
import re
import signal
import socket
import struct
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
import lockstep_client  # noqa: E402
from processes import LONG, end, end_all, finish, free_ports, start, until  # noqa: E402
from verdicts import conclude, equal, verdict  # noqa: E402

program = sys.argv[1] if len(sys.argv) > 1 else "build/contactplant"
here = os.path.dirname(os.path.abspath(__file__))


def state_of(child):
    try:
        with open("/proc/%d/stat" % child.pid) as f:
            return f.read().rsplit(")", 1)[1].split()[0]
    except OSError:
        return "gone"


def plant(*arguments):
    peers = [x for i in (1, 2, 3) for x in ("--peer", "127.0.0.1:%d" % (port + i))]
    return start(program, "run", "--bus", "udp:%d" % port, *peers, *arguments)


def control(*arguments):
    return start(program, "control", "--lockstep", "--bus", "udp:%d" % (port + 1), "--peer", "127.0.0.1:%d" % port, *arguments)


def client(turns, stop_at=-1, offset=1):
    return start("/usr/bin/python3", here + "/lockstep_client.py", port + offset, port, turns, stop_at)


def read(name):
    with open(os.path.join(directory, name), "rb") as f:
        return f.read()


def log(name):
    return ("--log", os.path.join(directory, name))


def hash_of(p):
    return re.search(r"tick \d+, hash [0-9a-f]+", p.out).group()


def resume_when_stopped(child, seconds):
    """False when it never stopped."""
    stopped = until(lambda: child.poll() is not None or state_of(child) == "T") and child.poll() is None
    time.sleep(seconds)
    child.send_signal(signal.SIGCONT)
    return stopped


def test_equal_runs():
    print("--- paced and unpaced", flush=True)
    patient = ("--setting", "timeout_frames=10000", "--setting", "age_limit_frames=10000")
    seen = {}
    for name, options in (("in real time, by CONTROL step", ()), ("paced", ("--lockstep", "--speed", "4")),
                          ("unpaced", ("--lockstep", *log("a.log"))), ("unpaced again", ("--lockstep", *log("b.log")))):
        p = plant(*options, *patient)
        c = control("--duration", "1.5", *patient)
        equal(name + ": the controller's status", end(c), 0)
        equal(name + ": the plant's status", finish(p), 0)
        seen[name] = (hash_of(p), c.out)
    told = lambda name: (seen[name][0], seen[name][1].split(", contact loss")[0])
    for name in seen:
        equal(name + ": hash, force and penetration", told(name), told("unpaced"))
    for name in ("paced", "unpaced again"):  # in real time a summary may come before or after the last step
        equal(name + ": all that the controller prints", seen[name][1], seen["unpaced"][1])
    verdict("1.5 s of plant time", "tick 96000," in seen["unpaced"][0])
    verdict("logs of two unpaced runs are equal to the byte, %d bytes" % len(read("a.log")),
            len(read("a.log")) > 100000 and read("a.log") == read("b.log"))
    r = start(program, "replay", os.path.join(directory, "a.log"), *patient)
    equal("the log replays: status", end(r), 0)
    verdict("all of it", "equal: " in r.out and seen["unpaced"][0].split()[-1] in r.out, r.out + r.err)


def test_faults():
    print("--- a bad link", flush=True)
    faults = ("--faults", "drop=0.02,in.delay=0.1:30,out.delay=0.1:5,out.burst=200@0.8:1.2,flip=0.01")
    frames = []
    for name in ("fa.log", "fb.log"):
        p = plant("--lockstep", *faults, *log(name))
        c = client(1500)
        equal("the client's status", end(c), 0)
        equal("the plant's status", finish(p), 0)
        frames.append(re.search(r"frames (\d+) of", p.out).group(1))
    equal("frames of two runs", frames[0], frames[1])
    verdict("logs are equal to the byte, %d bytes" % len(read("fa.log")),
            len(read("fa.log")) > 10000 and read("fa.log") == read("fb.log"))
    verdict("frames were lost, late and damaged", all(k in p.out for k in (" drop ", " delay ", " burst ", " flip ")), p.out)


def run_client(name, turns, stop_at, seconds):
    """A run with a controller that stops itself for so long."""
    p = plant("--lockstep", "--setting", "timeout_frames=50", *log(name))
    c = client(turns, stop_at)
    if stop_at >= 0:
        verdict("the client was stopped", resume_when_stopped(c, seconds))
    equal("the client's status", end(c), 0)
    equal("the plant's status", finish(p), 0)
    return p


def test_stopped():
    print("--- stopped", flush=True)
    whole = run_client("whole.log", 1200, -1, 0)
    stopped = run_client("stopped.log", 1200, 400, 1)
    equal("hash with a client that stood for 1 s", hash_of(stopped), hash_of(whole))
    verdict("its log is equal to the byte, %d bytes" % len(read("whole.log")), read("stopped.log") == read("whole.log"))
    verdict("no time-out, no refusal", not re.search(r"^(timeouts|session|stale|late)\b", stopped.out, re.M), stopped.out)
    for who in ("controller", "plant"):
        p = plant("--lockstep", "--speed", "2", *log("once.log"))
        c = control("--duration", "1.5")
        until(lambda: os.path.exists(os.path.join(directory, "once.log")))
        victim = p if who == "plant" else c
        time.sleep(0.3)
        victim.send_signal(signal.SIGSTOP)
        resume_when_stopped(victim, 0.5)
        equal("a %s stopped from outside: the controller's status" % who, end(c), 0)
        equal("the plant's status", finish(p), 0)
        q = plant("--lockstep", *log("never.log"))
        end(control("--duration", "1.5"))
        equal("the plant's status, never stopped", finish(q), 0)
        verdict("its log is equal to the byte", read("once.log") == read("never.log"))


def test_words():
    print("--- words", flush=True)
    p = plant("--lockstep", "--duration", "0.05", *log("words.log"))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        s.bind(("127.0.0.1", port + 1))
        s.connect(("127.0.0.1", port))
        s.settimeout(LONG)
        until(lambda: os.path.exists(os.path.join(directory, "words.log")))
        answers = 0
        for _ in range(50):
            s.send(b"\2\0\0\0\0")
            answers += len(s.recv(2048)) >= 5
    equal("50 empty packets without a sequence number: the plant's status", end(p), 0)
    equal("answers", answers, 50)
    verdict("50 bus frames", "frames 50 of 1000 us in lockstep" in p.out, p.out)


def test_silence():
    print("--- silence, death, another version", flush=True)
    p = plant("--lockstep", "--patience", "0.5")
    equal("nobody speaks: status", end(p), 4)
    verdict("names the peer and its patience", "no word of 127.0.0.1:%d for 0.5 s" % (port + 1) in p.err, p.err)
    verdict("and reports", "frames 0 of 1000 us in lockstep" in p.out, p.out)
    p = plant("--lockstep", "--patience", "1", *log("dead.log"))
    c = client(1000, 300)
    until(lambda: state_of(c) == "T")
    c.kill()
    end(c)
    equal("a peer that dies: status", end(p), 4)
    verdict("names it", "no word of 127.0.0.1:%d " % (port + 1) in p.err, p.err)
    verdict("the report and the log are whole", "hash" in p.out and read("dead.log").endswith(b"\n"), p.out)
    r = start(program, "replay", os.path.join(directory, "dead.log"))
    equal("which replays: status", end(r), 0)
    p = plant("--lockstep", "--patience", "0", "--setting", "timeout_frames=50")
    c = client(1000, 300)
    until(lambda: state_of(c) == "T")
    c.kill()
    end(c)
    c = client(200)
    equal("the next one gets a session: status", end(c), 0)
    equal("the plant's status", finish(p), 0)
    verdict("after one time-out, in bus frames of its own", re.search(r"^timeouts +1 ", p.out, re.M), p.out)
    p = plant("--lockstep", "--patience", "1")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        s.bind(("127.0.0.1", port + 1))
        s.connect(("127.0.0.1", port))
        while p.poll() is None:
            try:
                s.send(b"\1\0\0\0\0")
            except ConnectionRefusedError:
                pass
            time.sleep(0.02)
    equal("cannelloni of another version: status", end(p), 4)
    verdict("says so, and says it once", p.err.count("127.0.0.1:%d sends what is refused" % (port + 1)) == 1, p.err)
    verdict("no bus frame", "frames 0 of" in p.out, p.out)
    p = plant("--lockstep")
    c = control("--substeps", "32")
    equal("a controller for another plant: status", end(c), 1)
    verdict("says which", "substeps 64, not 32" in c.err, c.err)
    finish(p)
    p = plant("--lockstep", "--duration", "0.5")
    c = control("--duration", "5", "--patience", "1")
    equal("the plant ends first: the controller's status", end(c), 1)
    verdict("says so", "did not confirm" in c.err or "no plant answers" in c.err, c.err)
    equal("the plant's status", end(p), 0)
    c = control("--duration", "1", "--patience", "0.5")
    equal("no plant at all: status", end(c), 1)
    verdict("says so", "no plant answers" in c.err, c.err)


def test_two_peers():
    print("--- two peers are waited for", flush=True)
    both = [x for i in (1, 2) for x in ("--wait", "127.0.0.1:%d" % (port + i))]
    for name, stop_at in (("two.log", -1), ("stood.log", 300)):
        p = plant("--lockstep", *both, "--duration", "1", *log(name))
        harness = client(0, stop_at, 2)
        c = client(100000)
        if stop_at >= 0:
            verdict("one stops", resume_when_stopped(harness, 0.5))
        equal("status", end(p), 0)
        verdict("1000 bus frames", "frames 1000 of" in p.out, p.out)
        for child in (harness, c):
            child.kill()
            end(child)
    verdict("the log is the same, whichever stands, %d bytes" % len(read("two.log")),
            len(read("two.log")) > 100000 and read("two.log") == read("stood.log"))
    p = plant("--lockstep", *both, "--patience", "1")
    harness, c = client(0, 300, 2), client(100000)
    until(lambda: state_of(harness) == "T")
    harness.kill()
    equal("one of them dies: status", end(p), 4)
    verdict("its name, and only its", "no word of 127.0.0.1:%d for" % (port + 2) in p.err, p.err)
    c.kill()
    end(harness), end(c)


def test_strangers():
    print("--- strangers", flush=True)
    p = plant("--lockstep", "--patience", "1")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        s.bind(("127.0.0.1", 0))
        while p.poll() is None:
            s.sendto(b"\2\0\0\0\0", ("127.0.0.1", port))
            time.sleep(0.02)
        at = "127.0.0.1:%d" % s.getsockname()[1]
    equal("a stranger's words are none: status", end(p), 4)
    verdict("and it is told while the plant waits", at + " sent packets that were dropped" in p.err, p.err)


def test_beside():
    """What a gateway may pack beside a command: identifier, length, for CAN FD flags, data."""
    print("--- frames of other kinds beside commands", flush=True)
    kinds = {"CAN FD": struct.pack(">IBB", 0x345, 0x80 | 12, 1) + bytes(12), "remote": struct.pack(">IB", 0x40000201, 8),
             "error": struct.pack(">IB", 0x20000080, 8) + bytes(8), "29 bits": struct.pack(">IB", 0x98FEF100, 8) + bytes(8),
             "length 9": struct.pack(">IB", 0x345, 9) + bytes(9)}
    for name, raw in kinds.items():
        p = plant("--lockstep", *log("beside.log"))
        c = lockstep_client.Client(("127.0.0.1", port + 1), ("127.0.0.1", port))
        c.turn()
        while c.session_seen is None:
            c.turn()
        c.commands, c.session = [raw], 1
        c.enable()
        c.commands.append(raw)
        c.turn()
        equal(name + " beside an ENABLE: the session", c.session_seen, 1)
        c.control(lockstep_client.START)
        c.turn()
        c.commands = [raw]
        c.control(lockstep_client.STOP)
        c.turn()
        equal("  beside a STOP: the state", c.state, 4)
        c.commands = [raw]
        c.turn()
        c.socket.close()
        equal("  a word of it alone is none that is missing: status", finish(p), 0)
        equal("  is told", "rx_foreign" in p.err, name != "29 bits")
        equal("  the log replays: status", end(start(program, "replay", os.path.join(directory, "beside.log"))), 0)


def test_memory():
    """Words and answers by the layout of docs/guide/lockstep.md."""
    print("--- memory", flush=True)
    ring, written, taken, slots = 192 + 32 * 2048, 0, 64, 192
    name = os.path.join(directory, "rig")
    p = start(program, "run", "--lockstep", "--bus", "memory:" + name, "--duration", "0.04", *log("memory.log"))
    until(lambda: os.path.exists(name) and os.path.getsize(name) == 2 * ring)
    answers = []
    with open(name, "r+b") as f, mmap.mmap(f.fileno(), 2 * ring) as m:
        count = lambda at: struct.unpack_from("<I", m, at)[0]
        for i in range(40):  # each waits for a look of the plant, which nobody wakes here
            word = b"\2\0\0\0\0"
            struct.pack_into("<I%ds" % len(word), m, slots + i % 32 * 2048, len(word), word)
            struct.pack_into("<I", m, written, i + 1)
            if not until(lambda: count(ring + written) > i):
                break
            n = count(ring + slots + i % 32 * 2048)
            answers.append(m[ring + slots + i % 32 * 2048 + 4:][:n])
            struct.pack_into("<I", m, ring + taken, i + 1)
        status = end(p)
        equal("the plant ends with a packet of no bytes", (count(ring + written), count(ring + slots + 40 % 32 * 2048)), (41, 0))
    equal("40 words, 40 bus frames: status", status, 0)
    equal("  answers", len(answers), 40)
    verdict("  packets of version 2 with their number", all(a[0] == 2 and a[2] == i for i, a in enumerate(answers)), answers[:2])
    verdict("  the memory is gone with the plant", not os.path.exists(name))
    equal("  its log replays", end(start(program, "replay", os.path.join(directory, "memory.log"))), 0)
    p = start(program, "run", "--lockstep", "--bus", "memory:" + name, "--patience", "0.3")
    equal("silence: status", end(p), 4)
    verdict("  is told", "no word of the controller for 0.3 s" in p.err, p.err)
    p = start(program, "run", "--lockstep", "--bus", "memory:" + name)
    until(lambda: os.path.exists(name))
    p.terminate()
    end(p)
    verdict("SIGTERM: the memory is gone, too", not os.path.exists(name))
    report = os.path.join(directory, "memory.json")
    p = start(program, "run", "--lockstep", "--bus", "memory:" + name, "--patience", "0.5", "--json", report, *log("cut.log"))
    until(lambda: os.path.exists(name))
    with open(name, "r+b") as f, mmap.mmap(f.fileno(), 2 * ring) as m:
        struct.pack_into("<I5s", m, slots, 5, b"\2\0\0\0\0")
        struct.pack_into("<I", m, written, 1)
        for cut in (lambda: os.truncate(name, 0), lambda: open(name, "wb"), lambda: f.truncate(1)):
            try:
                cut()
                verdict("a peer that makes the memory shorter", False, "it can")
            except OSError:
                pass
    equal("a peer that would make the memory shorter, then silence: status", end(p), 4)
    verdict("  a report, JSON, and no file left", "frames 1 of" in p.out and json.load(open(report))["model"] and not os.path.lexists(name), p.out + p.err)
    equal("  its log replays", end(start(program, "replay", os.path.join(directory, "cut.log"))), 0)
    os.symlink("/proc/999999999/fd/3", name)
    p = start(program, "run", "--lockstep", "--bus", "memory:" + name)
    verdict("what a killed plant left is told", end(p) == 1 and "exists; another plant has it, or remove it" in p.err and os.path.islink(name), p.err)
    os.unlink(name)
    open(name, "w").close()
    p = start(program, "run", "--lockstep", "--bus", "memory:" + name)
    verdict("a file that is there is left alone", end(p) == 1 and "exists; another plant has it" in p.err and os.path.exists(name), p.err)


def refused(pattern, *arguments):
    c = start(program, *arguments)
    status = end(c)
    verdict("refused: " + " ".join(arguments), status == 2 and pattern in c.err and c.err.count("\n") == 1 and not c.out,
            "status %d, %s" % (status, c.err))


def test_misuse():
    print("--- misuse", flush=True)
    refused("needs --bus udp:", "run", "--lockstep", "--bus", "can:can0")
    refused("needs --lockstep", "run", "--bus", "memory:/dev/shm/rig")
    refused("say memory:/dev/shm/rig", "run", "--lockstep", "--bus", "memory:")
    refused("--wait goes with --bus udp:", "run", "--lockstep", "--bus", "memory:/dev/shm/rig", "--wait", "127.0.0.1:20001")
    refused("--peer goes with --bus udp:", "run", "--lockstep", "--bus", "memory:/dev/shm/rig", "--peer", "127.0.0.1:20001")
    refused("its controller maps the file", "control", "--lockstep", "--bus", "memory:/dev/shm/rig")
    refused("--wait needs --lockstep", "run", "--wait", "127.0.0.1:20001")
    refused("--patience needs --lockstep", "run", "--patience", "1")
    refused("--speed needs --lockstep", "run", "--speed", "2")
    refused("out of range", "run", "--lockstep", "--speed", "0")
    refused("out of range", "run", "--lockstep", "--patience=-1")
    refused("is no peer; --peer 127.0.0.1:20009", "run", "--bus", "udp:0", "--lockstep", "--wait", "127.0.0.1:20009")
    refused("is no peer", "run", "--bus", "udp:0", "--lockstep", "--wait", "controller")
    refused("--patience needs --lockstep", "control", "--bus", "udp:0", "--patience", "1")


port = free_ports(4, 11000)
with tempfile.TemporaryDirectory() as directory:
    try:
        for test in (test_misuse, test_words, test_equal_runs, test_stopped, test_faults, test_two_peers, test_strangers, test_beside, test_silence, test_memory):
            test()
    finally:
        end_all()
conclude()
