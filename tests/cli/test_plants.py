#!/usr/bin/env python3
"""test_plants.py PROGRAM - contactplant run --plants: each plant of a list has its own client, and to the bit the life of
a plant that is alone. Runs are in lockstep, so nothing is judged by time. Prints `ok` and `FAIL` lines and
`N passed, N failed`."""
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile

from lockstep_client import MORE, START, STOP, STREAM, Client

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, verdict  # noqa: E402

program = sys.argv[1] if len(sys.argv) > 1 else "build/contactplant"
BASE, BLOCK, TURNS = 0x200, 0x40, 300
SCENES = ["rig", "hertz_rig", "tip", "rig", "rig", "shaft", "rig", "hertz_rig"]
STOPPED, STOP_AT, SILENT, SILENT_AT = 3, 150, 4, 100  # one is told to stop, one loses its client
TIMEOUT = 32  # the bit of FAULTS


class Member(Client):
    """A client whose commands go out with those of others. It answers what its plant says: a frame that went astray
    would change all that follows."""

    def __init__(self, i):
        self.base, self.session, self.session_seen, self.state = BASE + BLOCK * i, 0, None, 0
        self.frame = self.tick = self.force = 0
        self.counter, self.commands = {}, []
        self.life = self.live(i)

    def live(self, i):
        while self.session_seen is None:
            yield
        self.session = self.session_seen % 15 + 1
        while self.session_seen != self.session:
            self.enable()
            yield
        self.control(START)
        for n in range(TURNS):
            if i == SILENT and n == SILENT_AT:
                return
            if n % 10 == 0:
                self.enable()
            self.send(STREAM, struct.pack("<Hf", self.tick // 64 & 0xFFFF, 1.0 + (self.force + i) % 7))
            if i == STOPPED and n == STOP_AT:
                self.control(STOP)
                return
            yield


def talk(link, members):
    """Words that carry the commands of all members."""
    for sequence in range(TURNS + 10):
        for m in members:
            next(m.life, None)
        commands = [c for m in members for c in m.commands]
        word = struct.pack(">BBBH", 2, 0, sequence & 255, len(commands)) + b"".join(commands)
        for m in members:
            m.commands = []
        link.send(word)
        answer = b" " * MORE
        while len(answer) >= MORE:
            answer = link.recv(2048)
            for at in range(5, len(answer), 13):
                identifier = struct.unpack_from(">I", answer, at)[0]
                for m in members:
                    if 0 <= identifier - m.base < BLOCK:
                        m.hear(identifier - m.base, answer, at + 5)


def run(numbers, *arguments):
    """A run beside these members: what it printed and its status."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind(("127.0.0.1", 0))
        link.settimeout(300)
        p = subprocess.Popen([program, "run", "--lockstep", "--bus", "udp:0", "--peer", "127.0.0.1:%d" % link.getsockname()[1],
                              "--setting", "timeout_frames=50", *arguments], stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, text=True)
        banner = p.stderr.readline()
        link.connect(("127.0.0.1", int(re.search(r"on udp:(\d+)", banner).group(1))))
        talk(link, [Member(i) for i in numbers])
        p.send_signal(signal.SIGINT)
        out = p.communicate(timeout=300)[0]
        return out, p.returncode


def life_of(text):
    found = re.search(r"plant time ([0-9.]+) s.*hash ([0-9a-f]+)", text)
    return found.groups() if found else text


def test_together():
    print("--- eight plants on a bus", flush=True)
    path = os.path.join(directory, "farm.txt")
    with open(path, "w") as f:
        f.write("\ufeff# the plants of this test\n\n" + "\n".join("  %s  # plant" % s for s in SCENES) + "\n")
    out, status = run(range(len(SCENES)), "--plants", path)
    verdict("the run's status: %d" % status, status == 0)
    lines = [line for line in out.splitlines() if line.startswith("0x")]
    verdict("a line for each plant", len(lines) == len(SCENES), out)
    states = [re.search(r": ([a-z]+),", line).group(1) for line in lines]
    wanted = ["running"] * len(SCENES)
    wanted[STOPPED] = "stopped"
    verdict("one was stopped: " + " ".join(states), states == wanted)
    faults = [int(re.search(r"faults (\d+)", line).group(1)) for line in lines]
    verdict("one lost its client: faults " + " ".join(map(str, faults)),
            faults == [TIMEOUT if i == SILENT else 0 for i in range(len(SCENES))])
    for i, scene in enumerate(SCENES):
        name = "0x%X %s" % (BASE + BLOCK * i, scene)
        verdict(name + " is reported", lines[i].startswith(name + ":"), lines[i])
        alone, status = run([i], scene, "--base-id", "0x%X" % (BASE + BLOCK * i))
        same_length = abs(float(life_of(alone)[0]) - float(life_of(lines[i])[0])) < 1e-9
        verdict("%s: hash %s as alone" % (name, life_of(lines[i])[1]),
                life_of(alone) == life_of(lines[i]) and same_length, alone)


def refuses(why, text, *arguments):
    path = os.path.join(directory, "bad.txt")
    with open(path, "w") as f:
        f.write(text)
    p = subprocess.run([program, "run", "--bus", "udp:0", "--duration", "0.1", "--plants", path, *arguments],
                       capture_output=True, text=True, timeout=300)
    one_line = p.stderr.count("\n") == 1
    verdict("refused: %s" % why, p.returncode == 2 and one_line and why in p.stderr, p.stderr)


def test_refusals():
    print("--- lists that cannot run", flush=True)
    refuses("bad.txt:3: rigg", "rig\nrig\nrigg\n")
    refuses("did you mean rig", "rig\nrigg\n")
    refuses("bad.txt:25: rig: identifiers are left for 24 plants only", "rig\n" * 25)
    refuses("names 0 scenes", "# none\n")
    refuses("names 513 scenes", "rig\n" * 513, "--extended")
    refuses("--log is for one plant", "rig\nrig\n", "--log", os.path.join(directory, "a.log"))
    refuses("--scope is for one plant", "rig\nrig\n", "--scope")
    refuses("take hertz_rig away", "rig\n", "hertz_rig")
    slow = os.path.join(directory, "slow.ini")
    with open(slow, "w") as f:
        scene = subprocess.run([program, "scene", "rig"], capture_output=True, text=True).stdout
        f.write(scene.replace("frame = 1 ms", "frame = 2 ms"))
    refuses("it has 500 frames a second and the first plant 1000", "rig\n%s\n" % slow)
    p = subprocess.run([program, "run", "--plants", os.path.join(directory, "none.txt")], capture_output=True, text=True)
    verdict("refused: a list that is not there", p.returncode == 2 and "cannot read" in p.stderr, p.stderr)


def memory_of(n):
    """The memory of n plants that wait for their first word, KiB: what is allocated, touched or not."""
    path = os.path.join(directory, "many.txt")
    with open(path, "w") as f:
        f.write("rig\n" * n)
    with subprocess.Popen([program, "run", "--lockstep", "--bus", "udp:0", "--extended", "--plants", path], stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True) as p:
        p.stderr.readline()
        with open("/proc/%d/status" % p.pid) as f:
            kib = int(re.search(r"VmData:\s*(\d+) kB", f.read()).group(1))
        p.send_signal(signal.SIGINT)
    return kib


def test_memory():
    print("--- memory", flush=True)
    few, many = memory_of(2), memory_of(102)
    verdict("a plant takes %.1f KiB, 64 at most" % ((many - few) / 100), 10 < (many - few) / 100 <= 64, (few, many))


with tempfile.TemporaryDirectory() as directory:
    test_together()
    test_refusals()
    test_memory()
conclude()
