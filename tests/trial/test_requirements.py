#!/usr/bin/env python3
"""test_requirements.py PROGRAM - requirements that cases name: in JUnit, JSON and page, against a list; and shares that a scheduler tells.
Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import json
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, equal  # noqa: E402

program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build/contactplant")
HEAD = "[plant]\nscene = hertz_rig\n[controller]\nbuiltin = keep\n"
LIST = '\ufeffid,text\nHIL-017,"keeps ""contact"", always"\r\nPRÜF-18 , no overload\n\nHIL-020,never tested\nPRÜF-21,\n'
CASES = """[case kept]
requirement = HIL-017, PRÜF-18
over = 0.1 s
expect contact_loss == 0 %
[case deep]
like = kept
requirement = PRÜF-18
expect penetration >= 1 m
[case same]
like = kept
[case free]
over = 0.1 s
expect faults == 0
"""


def test(*arguments, environment=None):
    return subprocess.run([program, "test", *arguments], capture_output=True, text=True, timeout=120, env={**os.environ, **(environment or {})})


def write(name, text):
    with open(name, "w", newline="") as f:
        f.write(text)
    return name


def reports():
    print("--- JUnit, JSON and page", flush=True)
    r = test("t.test", "--requirements", "list.csv", "--junit", "j.xml", "--json", "j.json", "--report", "r.html")
    equal("status: one failed", r.returncode, 1)
    equal("those without a case are told", "untraced: HIL-020, PRÜF-21; no case names them\n" in r.stdout, True)
    cases = {c.get("name"): c for c in xml.parse("j.xml").getroot().iter("testcase")}
    named = {n: [p.get("value") for p in c.iter("property") if p.get("name") == "requirement"] for n, c in cases.items()}
    wanted = {"kept": ["HIL-017", "PRÜF-18"], "deep": ["PRÜF-18"], "same": ["HIL-017", "PRÜF-18"], "free": []}
    equal("JUnit: properties of each case", named, wanted)
    others = {p.get("name"): p.get("value") for p in cases["free"].iter("property")}
    version = subprocess.run([program, "version"], capture_output=True, text=True).stdout.split()[1].strip(",")
    hash_told = re.search(r"free .*hash ([0-9a-f]{16})", r.stdout)[1]
    equal("  scene, version, seed, hash", others, {"scene": "hertz_rig", "version": version, "seed": "1", "hash": hash_told})
    with open("j.json") as f:
        told = json.load(f)
    equal("JSON: of each case", {c["case"]: c["requirements"] for c in told["cases"]}, wanted)
    equal("  untraced", told["untraced"], ["HIL-020", "PRÜF-21"])
    with open("r.html") as f:
        data = json.loads(re.search(r'id="data">(.*?)</script>', f.read(), re.S)[1])
    rows = next(s for s in data["sections"] if s.get("title") == "Requirements")["rows"]
    got = [(x["cells"][0], x["cells"][1], x["cells"][2], x["cells"][3], x["bad"]) for x in rows]
    equal("page: requirement by case", got, [("HIL-017", 'keeps "contact", always', "kept", "ok", False), ("HIL-017", 'keeps "contact", always', "same", "ok", False),
                                             ("PRÜF-18", "no overload", "kept", "ok", False), ("PRÜF-18", "no overload", "deep", "FAIL", True),
                                             ("PRÜF-18", "no overload", "same", "ok", False), ("HIL-020", "never tested", "no case names it", "", True),
                                             ("PRÜF-21", "", "no case names it", "", True)])
    equal("  and what decided", [x["cells"][5] for x in rows if x["cells"][2] == "deep"], ["penetration >= 1 m"])
    equal("one case alone: others are traced by the file", test("t.test", "--case", "free", "--requirements", "list.csv", "--fail-on", "untraced").returncode, 1)
    write("short.csv", "HIL-017\nPRÜF-18\n")
    equal("all traced", test("t.test", "--case", "free", "--requirements", "short.csv", "--fail-on", "untraced").returncode, 0)
    equal("no list: no table of the untraced", "untraced" in test("t.test").stdout, False)


def refusals():
    print("--- mistakes", flush=True)
    for text, wanted in (("requirement = HIL 17", 't.test:6: requirement: "HIL 17": write ID, ID'), ("requirement = A,,B", 'requirement: "": write ID, ID'),
                         ("requirement = A,", "an ID is missing behind the last comma"), ("requirement = A, A", "A stands twice"),
                         ("requirement = " + ", ".join("A%d" % i for i in range(17)), "more than 16"), ("requirement = " + "A" * 48, "at most 47"),
                         ("requirement = A\nrequirement = B", "it stands in this section already"), ("mass = 5 kg\nmass = 6 kg", "t.test:7: mass: it stands in this section already"),
                         ("requirement = PRÜF-8", "PRÜF-8 is not in ../list.csv; did you mean PRÜF-18?")):
        write("m/t.test", HEAD + "[case a]\n" + text + "\nover = 0.1 s\nexpect faults == 0\n")
        r = subprocess.run([program, "test", "t.test", "--requirements", "../list.csv", "--junit", "j.xml"], capture_output=True, text=True, cwd="m")
        equal("%.40s" % text.replace("\n", " "), (r.returncode, r.stderr.count("\n"), wanted in r.stderr, os.path.exists("m/j.xml")), (2, 1, True, False))
    for text, wanted in (("", "has no requirement"), ("id,text\n", "has no requirement"), ("A,b\nA,c\n", "l.csv:2: this identifier stands in the list already"),
                         ("A,b\nx y,c\n", "l.csv:2: an identifier of letters"), (",c\n", "l.csv:1: an identifier")):
        r = test("t.test", "--requirements", write("l.csv", text))
        equal("list %r" % text, (r.returncode, r.stderr.count("\n"), wanted in r.stderr), (2, 1, True))
    for words in (["--requirements", "nosuch.csv"], ["--fail-on", "untraced"], ["--requirements", "list.csv", "--fail-on", "faults"], ["--requirements", "list.csv", "--junit", "list.csv"]):
        r = test("t.test", *words)
        equal(" ".join(words), (r.returncode, r.stderr.count("\n")), (2, 1))
    with open("list.csv", newline="") as f:
        equal("the list is as it was", f.read() == LIST, True)


def shares():
    print("--- shares", flush=True)
    slurm = {"SLURM_ARRAY_TASK_ID": "2", "SLURM_ARRAY_TASK_MIN": "1", "SLURM_ARRAY_TASK_MAX": "4", "SLURM_ARRAY_TASK_COUNT": "4"}
    again = {**slurm, "SLURM_ARRAY_TASK_COUNT": "2", "SLURM_ARRAY_TASK_MIN": "2"}
    for shard, told, case in (("auto", slurm, "deep"), ("auto/4", again, "deep"), ("auto/4", {"PARALLEL_SEQ": "3"}, "same"), ("4/4", {}, "free"),
                              ("auto", again, None), ("auto", {"PARALLEL_SEQ": "1"}, None), ("auto/4", {}, None), ("auto/1", slurm, None), ("auto/", slurm, None),
                              ("auto4", slurm, None), ("1", {}, None), ("0/4", {}, None), ("1/4x", {}, None), ("auto/4", {"PARALLEL_SEQ": "1x"}, None)):
        r = test("t.test", "--shard", shard, environment=told)
        got = re.findall(r"^(?:ok|FAIL) +(\w+)", r.stdout, re.M)
        equal("--shard %s %s" % (shard, " ".join(told.values())), got if case else (r.returncode, got, r.stderr.count("\n")), [case] if case else (2, [], 1))


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.mkdir("m")
    write("list.csv", LIST)
    write("t.test", HEAD + CASES)
    reports()
    refusals()
    shares()
    os.chdir("/")
conclude()
