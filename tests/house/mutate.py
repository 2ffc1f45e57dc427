#!/usr/bin/env python3
"""Mutation: do the tests notice when the code is wrong?  usage: mutate.py [--count N] [--seed S] [--list] [FILE...]

Each mutant changes one token of a source file: a comparison or its boundary, an arithmetic or logical operator, a
negation, a constant. It is compiled, linked with the objects of build/mutate and run against the unit tests that concern the file; a
failed or hanging test kills it. Without --count every mutant of the files is tried, else a seeded sample. Those that
survive and are known to change nothing that can be seen stand in tests/data/mutants_equivalent.txt with the reason. Ends with
the share that was killed, which must reach 95 % in each file; files can be run one by one. `make mutation` builds what it needs."""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

TESTS = {  # file: names of unit tests (parts of them) in the order in which they are tried: quick ones first
    "firmware/bus/wire.c": ["wire", "app_bad_frames", "stm32_fdcan", "app_report", "loopback"],
    "firmware/bus/mailbox.c": ["mailbox", "app_fire", "app_"],
    "firmware/plant/drive.c": ["drive_change", "drive_ramp", "drive_samples", "drive_start", "drive_book", "drive",
                         "segment", "selftest", "plant_", "app_fire"],
    "firmware/plant/plant.c": ["selftest", "plant_b", "plant_f", "plant_u", "plant_e", "plant_set", "plant_p", "plant",
                         "noise", "ledger", "switch", "watch", "app_", "energy"],
    "firmware/plant/plant_beside.c": ["beside", "app_beside"],
    "firmware/plant/plant_change.c": ["plant_b", "plant_change", "plant", "selftest", "ledger", "watch", "app_"],
    "firmware/method/switch.c": ["switch", "selftest", "plant", "chatter", "exact_", "taylor_", "reference"],
    "firmware/method/segment.c": ["segment", "selftest", "plant", "noise"],
    "firmware/plant/ledger.c": ["ledger", "app_told", "energy", "watch"],
    "firmware/observe/lockin.c": ["lockin", "app_lockin"],
    "firmware/observe/lockin_fit.c": ["lockin_fit", "app_lockin"],
    "firmware/observe/lockin_slots.c": ["app_lockin", "stages_lockin"],
    "firmware/observe/capture.c": ["capture", "app_capture"],
    "firmware/plant/noise.c": ["noise"],
    "firmware/plant/plant_report.c": ["plant", "ledger", "selftest", "app_"],
    "firmware/app/plant_scene.c": ["scenes", "plant", "rig"],
    "firmware/app/selftest.c": ["selftest"],
    "firmware/bus/wire_table.c": ["wire", "app_"],
    "firmware/method/method.c": ["auto", "scenes", "models"],
    "firmware/method/modal.c": ["quiet_", "afm_ring_down", "afm_static", "afm_pinned", "afm_heat_kick", "afm_snap_in",
                         "lever_changes_sample", "afm_tapping_orbits", "afm_modal_against_rk4", "afm_"],
    "firmware/afm/afm_plant.c": ["afm_plant"],
    "firmware/stage/stage.c": ["stage_", "stages_"],
    "firmware/stage/stages.c": ["stages_", "afm_plant_stage_of_z", "quiet_stages"],
    "firmware/observe/sensor.c": ["sensor", "app_report"],
    "firmware/observe/watch.c": ["watch_"],
    "firmware/observe/timing.c": ["timing", "app_time"],
}
APP = ["app_told", "app_", "capture", "mailbox", "sensor", "settings", "watch", "faults_nth",
       "faults_stalled", "faults_thousand", "special", "soak", "timing", "identity", "diag", "selftest_report"]
METHOD = ["selftest", "order", "reference", "plant", "energy"]
for rest in sorted(pathlib.Path("firmware").rglob("*.c")):  # every other file but the boards' main
    name = rest.stem.split("_")[0]
    own = {"exact": "exact", "taylor": "taylor", "rk4": "rk4", "auto": "auto"}.get(name)
    if rest.parent.name == "afm":
        first = [f"afm_{name}"] if name in ("codes", "loop", "raster", "surface") else []
        TESTS.setdefault(str(rest), [*first, "afm_station", "afm_change", "afm_plant"])
    if rest.name != "main.c":
        TESTS.setdefault(str(rest), [own, *METHOD] if own else APP)
BUILD = pathlib.Path("build/mutate")
TRAPS = ["-fsanitize=undefined", "-fsanitize-undefined-trap-on-error"]  # a step out of bounds is a wrong step
SWAPS = [
    ("<=", ["<", ">"]), (">=", [">", "<"]), ("==", ["!="]), ("!=", ["=="]), ("&&", ["||"]), ("||", ["&&"]),
    ("<", ["<=", ">"]), (">", [">=", "<"]), ("+=", ["-="]), ("-=", ["+="]), ("++", ["--"]),
    ("+", ["-"]), ("-", ["+"]), ("*", ["/"]), ("/", ["*"]), ("!", [""]),
    ("true", ["false"]), ("false", ["true"]),
]
TOKEN = re.compile(
    r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'|->|<<=?|>>=?|\+\+|--|[-+*/<>=!&|^%]=|&&|\|\||'
    r"0[xX][0-9a-fA-F]+[uUlL]*|\d+\.\d*(?:[eE][-+]?\d+)?|\d+[uUlL]*|\w+|\S")


def blank(match):
    return re.sub(r"[^\n]", " ", match.group(0))


def mutants(path):
    """(offset, old, new) of every change, in the order of the text."""
    text = pathlib.Path(path).read_text()
    code = re.sub(r"/\*.*?\*/|//[^\n]*", blank, text, flags=re.S)
    code = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", blank, code, flags=re.M)
    code = re.sub(r"^(?:static )?const struct[^=;]*=\s*\{.*?^\};", blank, code, flags=re.S | re.M)  # tables
    code = re.sub(r"^enum .*?\};", blank, code, flags=re.S | re.M)
    swaps = dict(SWAPS)
    before = ""
    depth = 0
    for m in TOKEN.finditer(code):
        token = m.group(0)
        depth += (token == "{") - (token == "}")
        if depth > 0:
            unary = before in ("", "(", ",", "=", "return", "[", "{", ";", "&&", "||", "!", "?", ":", "==", "<", ">", "+", "-", "*", "/")
            pointer = token == "*" and (unary or re.fullmatch(r"struct|const|void|char|\w+_t|double|unsigned|int", before)
                                        or re.search(r"struct \w+\s*$", code[:m.start()]))
            if token in swaps and not pointer and not (token in "+-" and unary):
                for new in swaps[token]:
                    yield m.start(), token, new
            elif re.fullmatch(r"\d+[uUlL]*", token) and before not in ("x",):
                digits = re.match(r"\d+", token).group(0)
                yield m.start(), token, str(int(digits) + 1) + token[len(digits):]
            elif re.fullmatch(r"\d+\.\d*", token):
                yield m.start(), token, repr(float(token) + 1.0)
            if token == "if" or token == "while":
                yield m.end(), "", " !"
        before = token
    return


def apply(text, change):
    offset, old, new = change
    if new == " !":  # if (x) -> if (!(x)): the parenthesis that follows gets another around it
        start = text.index("(", offset)
        depth, end = 0, start
        while True:
            depth += (text[end] == "(") - (text[end] == ")")
            if depth == 0:
                break
            end += 1
        return text[:start] + "(!" + text[start:end + 1] + ")" + text[end + 1:]
    return text[:offset] + new + text[offset + len(old):]


def describe(path, text, change):
    line = text.count("\n", 0, change[0]) + 1
    shown = text.split("\n")[line - 1].strip()
    what = "negated" if change[2] == " !" else f"{change[1]} -> {change[2] or 'nothing'}"
    return f"{path}:{line}: {what}: {shown}"


def known(path, text, change, equivalent):
    """Is the change listed: of this token, inside the part of the line that the entry names?"""
    start = text.rfind("\n", 0, change[0]) + 1
    line, column = text[start:].split("\n")[0], change[0] - start
    return any(e[0] == path and e[2] == f"{change[1]}>{change[2].strip()}" and
               any(m.start() <= column < m.end() for m in re.finditer(re.escape(e[1]), line)) for e in equivalent)


def passes(unit, name, room):
    """Do the tests of this name exist and pass? A mutant may run or print without end: bounded are seconds and blocks."""
    with open(pathlib.Path(room, "printed"), "w+b") as printed:
        try:
            ran = subprocess.run(["sh", "-c", 'ulimit -t 60; ulimit -f 100000; exec "$0" "$1"', str(unit), name], stdout=printed,
                                 stderr=subprocess.DEVNULL, timeout=120)
        except subprocess.TimeoutExpired:
            return False
        printed.seek(max(0, printed.seek(0, os.SEEK_END) - 100))
        return ran.returncode == 0 and re.search(rb"[1-9]\d* passed, 0 failed\s*$", printed.read()) is not None


def try_one(job):
    path, change, flags, objects = job
    text = pathlib.Path(path).read_text()
    with tempfile.TemporaryDirectory() as room:
        source = pathlib.Path(room, pathlib.Path(path).name)
        source.write_text(apply(text, change))
        made = subprocess.run([*flags, *TRAPS, "-c", str(source), "-o", room + "/m.o"], capture_output=True)
        if made.returncode:
            return "stillborn"
        own = str(BUILD / path).replace(".c", ".o")
        link = [flags[0], *[o for o in objects if o != own], room + "/m.o", "-lm", "-o", room + "/unit"]
        if subprocess.run(link, capture_output=True).returncode:
            return "stillborn"
        passed = all(passes(room + "/unit", name, room) for name in TESTS[path])
    return "survived" if passed else "killed"


def verdict(path, count):
    killed, alive = count[path, "killed"], count[path, "killed"] + count[path, "survived"]
    share = killed / alive if alive else 1.0
    print(f"{'ok  ' if share >= 0.95 else 'FAIL'}  {path}: mutants killed: {killed} of {alive}, {100 * share:.1f} % (wanted 95 %);"
          f" {count[path, 'stillborn']} did not compile")
    return share >= 0.95


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="*", default=list(TESTS))
    parser.add_argument("--count", type=int, default=0, help="a sample of so many mutants (all)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--list", action="store_true", help="print the mutants and stop")
    a = parser.parse_args()
    equivalent = [line.rstrip("\n").split(" | ") for line in open("tests/data/mutants_equivalent.txt")
                  if line.strip() and not line.startswith("#")]
    jobs = [(path, c) for path in a.file for c in mutants(path)]
    texts = {path: pathlib.Path(path).read_text() for path in a.file}
    stale = [" | ".join(e) for e in equivalent if e[0] in a.file and
             not any(known(p, texts[p], c, [e]) for p, c in jobs)]
    if stale:
        print("FAIL  tests/data/mutants_equivalent.txt lists what is no mutant:", *stale, sep="\n      ")
        return 1
    jobs = [j for j in jobs if not known(j[0], texts[j[0]], j[1], equivalent)]
    if a.count and a.count < len(jobs):
        jobs = sorted(random.Random(a.seed).sample(jobs, a.count))
    if a.list:
        print("\n".join(describe(p, texts[p], c) for p, c in jobs))
        return 0
    flags = subprocess.run(["make", "-s", "OPT=-O1", f"BUILD={BUILD}", "mutation-compiler"], capture_output=True,
                           text=True, check=True).stdout.split()
    objects = subprocess.run(["make", "-s", "OPT=-O1", f"BUILD={BUILD}", "mutation-objects"], capture_output=True,
                             text=True, check=True).stdout.split()
    with tempfile.TemporaryDirectory() as room:
        broken = [name for name in sorted({name for path in a.file for name in TESTS[path]})
                  if not passes(BUILD / "unit", name, room)]
    if broken:
        print("FAIL  tests that are not there, or fail without any mutant:", *broken)
        return 1
    count = collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = pool.map(try_one, [(p, c, flags, objects) for p, c in jobs])
        for n, ((path, change), result) in enumerate(zip(jobs, results), 1):
            count[path, result] += 1
            if result == "survived":
                print("note  survived:", describe(path, texts[path], change), flush=True)
            if sys.stderr.isatty():
                print(f"{n} of {len(jobs)}", end="\r", file=sys.stderr)
    return 0 if all([verdict(path, count) for path in a.file]) else 1


if __name__ == "__main__":
    sys.exit(main())
