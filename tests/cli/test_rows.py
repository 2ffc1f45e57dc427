#!/usr/bin/env python3
"""test_rows.py PROGRAM - rows of a plant: contactplant monitor --wide and --json against decode of the plant's own log; run --json and
--fail-on. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import csv
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1])
host = "127.74.%d.%d:" % (os.getpid() >> 8 & 255, os.getpid() & 255)


def run(*arguments, **more):
    return subprocess.run([program, *arguments], capture_output=True, text=True, cwd=directory, timeout=60, **more)


def start(*arguments):
    return subprocess.Popen([program, "run", "--bus", "udp:" + host + "20000", "--peer", host + "20001", "--peer", host + "20002", "--peer", host + "20003",
                             "--rate", "200", "--substeps", "320", *arguments], cwd=directory, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def monitor(*arguments):
    return run("monitor", "--bus", "udp:" + host + "20002", "--peer", host + "20000", "--rate", "200", "--substeps", "320", *arguments)


def send(*arguments):
    return run("send", "--bus", "udp:" + host + "20003", "--peer", host + "20000", "--rate", "200", "--substeps", "320", *arguments)


def values(row):
    return {k.split(" ")[0]: float(v) for k, v in row.items() if v and k not in ("state", "frame", "tick")}


def test_monitor():
    plant = start("--duration", "20", "--log", "run.log", "--setting", "timeout_frames=10000")
    sent = send("start", "+", "arm", "force", "amplitude=20", "frequency=225", "+", "fire")
    wide = monitor("--wide", "--count", "150")
    here = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    here.bind((host[:-1], 0))
    told = monitor("--json", "udp:%s%d" % (host, here.getsockname()[1]), "--count", "100")
    packets = [json.loads(here.recv(65536)) for _ in range(4)]
    bare = monitor("--json", "-", "--batch", "1", "--count", "5")
    head = subprocess.run("'%s' monitor --wide --bus udp:%s20002 --peer %s20000 --rate 200 --substeps 320 | head -2; echo ${PIPESTATUS[0]}" % (program, host, host),
                          shell=True, executable="/bin/bash", capture_output=True, text=True)
    plant.terminate()
    plant.communicate()
    run("decode", "run.log", "--rate", "200", "--substeps", "320", "--out", "all.csv", "--svg", "run.svg", "--events", "events.csv")
    with open(os.path.join(directory, "all.csv")) as f:
        known = {line.split(",")[2]: line.rstrip("\n") for line in f}
    rows = wide.stdout.splitlines()
    moving = [x for x in rows if x.split(",")[2] in known and x.split(",")[2] != "0"]
    verdict("monitor --wide: the rows of decode, byte for byte", wide.returncode == 0 and len(rows) == 151 and len(moving) > 50 and all(known[x.split(",")[2]] == x for x in moving[2:]),
            sent.stdout + sent.stderr + wide.stderr + "\n".join(rows[:2]))
    table = {round(float(r["t_s"]), 9): values(r) for r in csv.DictReader(known.values())}
    objects = [x for p in packets for x in p]
    verdict("monitor --json: arrays of 33 rows and the rest", [len(p) for p in packets] == [33, 33, 33, 1] and told.returncode == 0, [len(p) for p in packets])
    apart = [x for x in objects if any(table[round(x["timestamp"], 9)].get(k) != v for k, v in x.items() if k != "timestamp")]
    verdict("  with the numbers of decode, and plant seconds", len(objects) == 100 and not apart, apart[:1])
    lines = [json.loads(x) for x in bare.stdout.splitlines()]
    verdict("  --batch 1: bare objects, here as lines", len(lines) == 5 and all("penetration" in x for x in lines), bare.stdout + bare.stderr)
    verdict("monitor | head ends quietly with status 0", head.stdout.splitlines()[-1:] == ["0"] and not head.stderr, head.stdout[-100:] + head.stderr)
    picture = xml.etree.ElementTree.parse(os.path.join(directory, "run.svg")).getroot()
    texts = [t.text for t in picture.iter() if t.text and t.tag.endswith("text")]
    verdict("decode --svg: a picture with the signals by name", any("penetration" in t for t in texts) and any("plant time" in t for t in texts), texts)
    for words, what in ((("--json", "tcp:1"), "give udp:"), (("--json", "udp:127.0.0.1:0"), "give udp:"), (("--wide", "--csv"), "one of them"), (("--wide", "--only", "SYNC"), "picks messages")):
        r = monitor(*words)
        verdict("monitor %s: %s" % (" ".join(words), what), r.returncode == 2 and what in r.stderr and r.stderr.count("\n") == 1, r.stderr)
    size = os.path.getsize(os.path.join(directory, "run.log"))
    for words, what in ((("--out", "./run.log"), "is read by this command"), (("--report", "run.log"), "is read by this command"),
                        (("--out", "one", "--events", "./one"), "choose two files"), (("--svg", "one", "--report", "one"), "choose two files")):
        r = run("decode", "run.log", "--rate", "200", "--substeps", "320", *words)
        verdict("decode %s: %s" % (" ".join(words), what), r.returncode == 2 and what in r.stderr and not os.path.exists(os.path.join(directory, "one")), r.stderr)
    verdict("  and the log is as it was", os.path.getsize(os.path.join(directory, "run.log")) == size)


def test_fault():
    """A plant that was held up under the policy stop: its controller says which fault it has."""
    plant = start("--duration", "20", "--overrun", "stop")
    send("start")
    plant.send_signal(signal.SIGSTOP)
    time.sleep(0.3)
    plant.send_signal(signal.SIGCONT)
    r = run("control", "--bus", "udp:" + host + "20001", "--peer", host + "20000", "--rate", "200", "--substeps", "320", "--duration", "1")
    plant.terminate()
    out, _ = plant.communicate()
    verdict("control and run name the fault of a plant: %s" % r.stderr.strip(), r.returncode == 1 and "in its state fault (overrun" in r.stderr and "state fault (overrun" in out, out + r.stdout)


def test_outcome():
    plant = start("--duration", "0.5", "--json", "a.json", "--fail-on", "fault,late")
    out, told = plant.communicate()
    with open(os.path.join(directory, "a.json")) as f:
        data = json.load(f)
    hashed = [x for x in out.splitlines() if data["hash"] in x]
    verdict("run --json: the report's numbers", plant.returncode == 0 and data["frames"] + data["missed"] == 100 and data["state"] == "off" and hashed and data["counters"]["timeouts"] == 0, out + told)
    plant = start("--duration", "2", "--json", "b.json", "--fail-on", "fault")
    send("start")  # and no heartbeat afterwards
    heard = monitor("--only", "STATUS", "--duration", "0.8")
    out, told = plant.communicate()
    with open(os.path.join(directory, "b.json")) as f:
        data = json.load(f)
    verdict("run --fail-on fault: status 1 after a time-out", plant.returncode == 1 and "--fail-on fault: 32 (timeout)" in told and data["faults"] == 32 and data["counters"]["timeouts"] == 1, told)
    verdict("  its report and monitor name the fault", re.search("hash [0-9a-f]{16}, state [a-z]+ .timeout.$", out, re.M) and "FAULTS=32 (timeout) " in heard.stdout, out + heard.stdout[-300:] + heard.stderr)
    r = run("run", "--bus", "udp:" + host + "20000", "--rate", "20000", "--duration", "0.3", "--fail-on", "missed,late", "--json", "c.json")
    with open(os.path.join(directory, "c.json")) as f:
        missed = json.load(f)["missed"]
    verdict("run --fail-on missed: status 1 where frames were missed, here %d" % missed, (r.returncode == 1) == (missed > 0), r.stderr)
    for words, status, what in ((("--fail-on", "mised"), 2, "did you mean missed?"), (("--fail-on", "late,"), 2, "there are missed, late, fault"), (("--duration", "0.01", "--json", "/dev/full/x"), 2, "cannot write --json")):
        r = run("run", "--bus", "udp:" + host + "20000", *words)
        verdict("run %s: %s" % (" ".join(words), what), r.returncode == status and what in r.stderr, r.stderr)


with tempfile.TemporaryDirectory() as directory:
    test_monitor()
    test_fault()
    test_outcome()
conclude()
