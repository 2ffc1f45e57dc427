#!/usr/bin/python3
"""test_view.py PROGRAM - contactplant scope --open as a plain client sees it: every number is decode's, gaps are gaps, events are all
found, bad input and bad requests are refused. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import bisect
import csv
import io
import os
import random
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
import planted_log  # noqa: E402
from processes import end_all  # noqa: E402
from verdicts import conclude, equal, verdict  # noqa: E402
from view_client import Viewer  # noqa: E402

program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build/contactplant")
FIRST = 6  # columns of a row of JSON before its signals


def run(*arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=120)


def write(name, text):
    with open(name, "w", newline="") as f:
        f.write(text)
    return name


def read(name):
    with open(name) as f:
        return f.read()


def number(text):
    return float(text) if text else None


def decoded(log, *arguments):
    """Rows of decode as lists: time, signals; and its events."""
    r = run("decode", log, *arguments, "--events", "events.csv")
    rows = list(csv.reader(io.StringIO(r.stdout)))[1:]
    events = list(csv.reader(io.StringIO(read("events.csv"))))[1:]
    return [[float(x[0]), int(x[1]), int(x[2]), x[3] or None, number(x[4])] + [number(v) for v in x[5:]] for x in rows], events


def in_pixel(rows, times, k, a, b):
    values = [r[5 + k] for r in rows[bisect.bisect_left(times, a):bisect.bisect_left(times, b)] if r[5 + k] is not None]
    return (min(values), max(values)) if values else (None, None)


def same_rows(v, rows, a, b):
    """Each row of a close view, and the bands of a wide one, against those of decode."""
    got = v.range(a, b)
    wanted = [r for r in rows if a <= r[0] <= b]
    told = [r[:5] + r[FIRST:] for r in got["row"] if a <= r[0] <= b]
    equal(f"rows from {a} to {b} s are decode's", [(x, y) for x, y in zip(told, wanted) if x != y][:1] or len(told), len(wanted))


def same_bands(v, rows, a, b, pixels, log=0):
    """A pixel's band has the rows in it, and at most those of a bin on either side."""
    got, step = v.range(a, b, pixels, log), (b - a) / pixels
    least = {64: 0.064, 512: 0.512, 4096: 4.096}.get(got["size"], 0.0)
    wrong, n, times = [], 0, [r[0] for r in rows]
    for k, (low, high) in ((int(k), v) for k, v in got["bands"].items() if k != "speed" and int(k) < len(rows[0]) - 5):
        for i in range(pixels):
            own = in_pixel(rows, times, k, a + i * step + 1e-9, a + (i + 1) * step - 1e-9)
            wide = in_pixel(rows, times, k, a + i * step - least - 2e-3, a + (i + 1) * step + least + 2e-3)
            n += 1
            if own[0] is not None and not (low[i] is not None and wide[0] <= low[i] <= own[0] and own[1] <= high[i] <= wide[1]) or \
                    wide[0] is None and low[i] is not None:
                wrong.append((k, i, low[i], high[i], own, wide))
    equal(f"{n} bands of {pixels} pixels from {a} to {b} s, of bins of {got['size']}: wrong", wrong[:1], [])


def test_values(log):
    print("--- values of a run", flush=True)
    rows, events = decoded(log)
    with Viewer(program, "--open", log) as v:
        about = v.ask("log")
        equal("rows", about["logs"][0]["rows"], len(rows))
        end = rows[-1][0]
        for a, b in ((0.1, 0.6), (0.9, 0.913), (end - 0.2, end)):
            same_rows(v, rows, a, b)
        same_bands(v, rows, 0.0, end, 100)
        same_bands(v, rows, 0.0, end, 600)
        same_bands(v, rows, 0.5, 1.4, 10)
        for r in rows[5::97]:
            got = v.row(r[0] + 2e-4)
            if got[:5] + got[FIRST:] != r:
                break
        equal("the row at a cursor is decode's", got[:5] + got[FIRST:], r)
        found, at, kinds = [], -1.0, 3
        while len(found) <= len(events) and (m := v.next(at, kinds=kinds)):
            found.append([m["t"], m["kind"], m["contact"], m["speed"], m["peak"]])
            at = m["t"]
        wanted = [[float(e[0]), e[1], int(e[2]), number(e[3]), number(e[4])] for e in events]
        same = all(abs(x[0] - y[0]) < 1e-11 and x[1:] == y[1:] for x, y in zip(found, wanted))
        equal("n finds every contact change of decode, in order", (len(found), same), (len(wanted), True))
        back = 0
        while back <= len(events) and (m := v.next(at, back=1, kinds=kinds)):
            back, at = back + 1, m["t"]
        equal("and p all but the last", back, len(wanted) - 1)
        marks = [m for m in v.range(0.5, 1.0)["marks"] if m["kind"] in ("touchdown", "liftoff")]
        equal("the events in view", len(marks), len([e for e in events if 0.5 <= float(e[0]) <= 1.0]))
        equal("states and sessions are told", {"state", "session"} <= {m["kind"] for m in v.range(0, 0.2)["marks"]}, True)
        equal("no state before the first is a gap", v.range(0, 0.1)["state"].count(None) > 0, True)


def test_gaps():
    print("--- what is missing, and what is beyond the range", flush=True)
    holes, beyond = [(2000, 2300), (4000, 4003), (30000, 36000)], [(6000, 6200)]
    planted_log.write("p.log", 60000, holes, beyond)
    rows, _ = decoded("p.log")
    with Viewer(program, "--open", "p.log") as v:
        equal("frames missing are counted", v.ask("log")["logs"][0]["missing"] > 0, True)
        for a, b, pixels in ((0, 60, 1000), (0, 60, 60), (1.9, 2.4, 500), (28, 38, 1000), (0, 10, 100), (3.99, 4.01, 200), (5.9, 6.3, 200)):
            same_bands(v, rows, float(a), float(b), pixels)
        r = v.range(28.0, 38.0, 1000)
        inside = [i for i in range(1000) if 30.1 < 28 + i / 100 < 35.9]
        equal("nothing is drawn in a hole", [r["bands"]["0"][0][i] for i in inside if r["bands"]["0"][0][i] is not None], [])
        equal("nor are there rows", sum(r["rows"][i] for i in inside), 0)
        r = v.range(5.9, 6.3, 200)
        inside = [i for i in range(200) if 6.001 < 5.9 + i * 0.002 < 6.196]
        equal("beyond the range is a gap", [r["bands"]["0"][0][i] for i in inside if r["bands"]["0"][0][i] is not None], [])
        equal("which is said", {r["beyond"][i] for i in inside}, {1})
        equal("and other outputs go on", None in [r["bands"]["1"][0][i] for i in inside], False)
        m = v.next(3.0, kinds=1 << 5)
        equal("the next hole", (m["kind"], round(m["t"], 6)), ("missing", 4.003))


def test_logs(log):
    print("--- logs of the world outside", flush=True)
    text = read(log)
    lines = [x for x in text.splitlines() if int(x.split(" ")[2].split("#")[0], 16) < 0x800]
    can0 = "\n".join(x.replace(" udp ", " can0 ").replace(" lockstep ", " can0 ") for x in lines) + "\n"
    with Viewer(program, "--open", log) as v:
        whole = v.range(0.0, 3.0)
    interface = lines[0].split(" ")[1]

    def judge(name, content, words, rows=True, *more):
        with Viewer(program, "--open", write("x.log", content), *more) as v:
            got = v.range(0.0, 3.0)
        verdict(name, all(w in v.told for w in words) and (not rows or got["bands"] == whole["bands"]), v.told)

    judge("line ends of Windows", text.replace("\n", "\r\n"), [])
    judge("cut off in its last line", text[:-7], ["1 line that is cut off"], False)
    extra = lines[500].split(" ")[0] + " " + interface + " "
    judge("FD and remote lines are counted and named", text + extra + "345##1112233\n" + extra + "123#R\n", ["1 CAN FD frame", "1 remote frame"])
    twice = "".join(a + "\n" + a.replace(" " + interface + " ", " can1 ") + "\n" for a in lines)
    for name, content, words in (
            ("two interfaces: asks which", twice, "choose one, as by --interface"),
            ("an empty log", "", "no line of it is one of candump -L"),
            ("no log at all", "t,x\n1,2\n", "no line of it is one of candump -L"),
            ("a log of another plant's identifiers", can0.replace("can0 2", "can0 6"), "has no SYNC of this plant")):
        r = run("scope", "--open", write("x.log", content), "--http", "127.0.0.1:0")
        verdict(name, r.returncode == 1 and words in r.stderr and r.stderr.count("\n") == 1, (r.returncode, r.stderr))
    judge("--interface chooses", twice, ["lines of other interfaces"], True, "--interface", interface)
    r = run("scope", "--open", log, "--set", "preload_N=200", "--http", "127.0.0.1:0")
    verdict("another plant's log is refused", r.returncode == 1 and "is of another plant" in r.stderr and r.stderr.count("\n") == 1, r.stderr)
    for arguments in (("--open", log, "--open", log, "--open", log), ("--open", log, "--bus", "can:can0"), ("--open", log, "--control"),
                      ("--open", log, "--log", "y.log"), ("--open", log, "hertz_rig", "shaft_bearing"), ("--open", "none.log")):
        r = run("scope", *arguments, "--http", "127.0.0.1:0")
        verdict(" ".join(arguments[-2:]) + ": one line", r.returncode in (1, 2) and r.stderr.count("\n") == 1, r.stderr)
    subprocess.run([program, "export", log, "--out", "x.pcapng"], check=True, capture_output=True)
    with Viewer(program, "--open", "x.pcapng") as v:
        equal("pcapng: the same bands", v.range(0.0, 3.0)["bands"] == whole["bands"], True)
        equal("  and the same rows", v.range(1.0, 1.1)["row"][0][:3], v.row(v.range(1.0, 1.1)["row"][0][0])[:3])
    write("two.log", text + text)
    with Viewer(program, "--open", "two.log") as v:
        runs = v.ask("log")["logs"][0]["runs"]
        equal("plant time that begins anew: two runs", len(runs), 2)
        a, b = (v.range(0.5, 1.0, run=i)["bands"] for i in (0, 1))
        equal("  which are alike", [a[k] == b[k] for k in "0123"], [True] * 4)


def until(condition):
    for _ in range(600):
        if condition():
            return True
        time.sleep(0.05)
    return False


def test_two(log):
    print("--- two logs", flush=True)
    planted_log.write("a.log", 5000)
    planted_log.write("b.log", 5000, beyond=[(3000, 3001)])
    with Viewer(program, "--open", "a.log", "--open", "b.log") as v:
        about = v.ask("log")
        r = run("compare", "a.log", "b.log")
        equal("they part where compare says", (about["compared"], about["part"]), (r.stdout.strip(), 3.0))
        equal("  where nothing may differ", about["allowed"], [0] * len(about["signals"]))
        equal("the second one has its own ranges", [v.range(2.9, 3.1, log=i)["beyond"].count(1) for i in (0, 1)], [0, 1])
    with Viewer(program, "--open", log, "--open", log) as v:
        about = v.ask("log")
        bands = v.range(0.0, 1.5, 9, 2)["bands"]
        equal("  their differences", {x for k in "0123" for edge in bands[k] for x in edge}, {0.0})
        equal("equal logs", ("rows agree" in about["compared"], about["part"]), (True, None))


def test_difference(log):
    """The difference of outputs in rows of one tick, in bins."""
    planted_log.record(program, "w", 29)
    other = {r[2]: r for r in decoded("w.a.log")[0]}
    rows = [r[:5] + [None if x is None or y is None else float(f"{x - y:.9g}") for x, y in zip(r[5:9], other[r[2]][5:9])] for r in decoded(log)[0]]
    with Viewer(program, "--open", log, "--open", "w.a.log") as v:
        for a, b, pixels in ((0.0, 1.5, 10), (0.0, 1.5, 2)):
            same_bands(v, rows, a, b, pixels, 2)
        equal("a row of the differences", v.status("row?log=2&run=0&at=1")[0], 400)


def test_tolerance(log):
    print("--- a tolerance", flush=True)
    for words in (["velocity=1 um/s", "displacement=5 um"], ["displacement=1 m"], ["penetration=1 nm"]):
        r = run("compare", log, "w.a.log", *words)
        with Viewer(program, "--open", log, "--open", "w.a.log", *(x for w in words for x in ("--tolerance", w))) as v:
            about = v.ask("log")
        where = re.search(r"part at (\S+) s", r.stdout)
        equal(", ".join(words) + ": as compare says", (about["compared"], about["part"]), (r.stdout.strip(), where and float(where.group(1))))
    equal("and it is told", about["allowed"][:4], [None, None, 1e-9, None])
    for arguments, words in (((log, "--tolerance", "velocity=1 um/s"), "give --open twice"), ((log, "--open", log, "--tolerance", "heat=1 K"), "no such signal"),
                             ((log, "--open", log, "--tolerance", "velocity"), "write SIGNAL=TOLERANCE")):
        r = run("scope", "--open", *arguments, "--http", "127.0.0.1:0")
        verdict(words, r.returncode == 2 and words in r.stderr and r.stderr.count("\n") == 1, r.stderr)


def test_follow_two():
    """The difference of two logs that grow by pieces of any length, against that of the whole ones."""
    chance = random.Random(5)
    planted_log.write("a.log", 9000)
    planted_log.write("b.log", 9000, [(5000, 5003)], [(3000, 3001)])
    with Viewer(program, "--open", "a.log", "--open", "b.log", "--tolerance", "displacement=0 m") as v:
        whole, wanted, once = v.ask("log"), v.range(0.0, 9.0, 9, 2), v.range(0.0, 9.0, 1, 2)["rows"]
    text = {"a": read("a.log"), "b": read("b.log")}
    done = {name: write(name + ".grows.log", text[name][:200000]) and 200000 for name in text}
    with Viewer(program, "--open", "a.grows.log", "--open", "b.grows.log", "--follow", "--tolerance", "displacement=0 m") as v:
        while any(done[name] < len(text[name]) for name in text):
            for name in text:
                end = done[name] + chance.choice((0, 1, 5000, 150000))
                with open(name + ".grows.log", "a") as f:
                    f.write(text[name][done[name]:end])
                done[name] = min(end, len(text[name]))
            time.sleep(0.2)
        verdict("two that grow have all rows", until(lambda: [x["rows"] for x in v.ask("log")["logs"]] == [x["rows"] for x in whole["logs"]]))
        equal("  and part where the whole ones do", v.ask("log")["part"], whole["part"])
        got = v.range(0.0, 9.0, 9, 2)
        equal("  and have their differences, to the last row but one", [got["bands"][k] == wanted["bands"][k] for k in "0123"], [True] * 4)
        equal("  each once", v.range(0.0, 9.0, 1, 2)["rows"], [n - 1 for n in once])


def test_follow(log):
    print("--- a log that grows", flush=True)
    lines = read(log).splitlines(keepends=True)
    half = len(lines) // 2
    write("g.log", "".join(lines[:half]) + lines[half][:20])
    with Viewer(program, "--open", log) as v:
        rows, whole = v.ask("log")["logs"][0]["rows"], v.range(0.0, 1.5)
    with Viewer(program, "--open", "g.log", "--follow") as v:
        first = v.ask("log")["logs"][0]["rows"]
        with open("g.log", "a") as f:
            f.write(lines[half][20:])
            f.write("".join(lines[half + 1:]))
        verdict("it has all rows at last", until(lambda: v.ask("log")["logs"][0]["rows"] == rows), (first, rows, v.ask("log")))
        got = v.range(0.0, 1.5)
        equal("and shows what a whole log shows", [got[k] == whole[k] for k in ("bands", "rows", "closed", "state", "counts")], [True] * 5)
        write("n.log", "".join(lines[:100]))
        os.replace("n.log", "g.log")
        verdict("a file that was replaced is told", until(lambda: "replaced" in v.ask("log")["logs"][0]["lost"]))
    verdict("on the terminal, too, once", v.told.count("was replaced") == 1, v.told)
    write("g.log", "".join(lines[:half]))
    write("h.log", "".join(lines[:half]))
    with Viewer(program, "--open", "g.log", "--open", "h.log", "--follow") as v:
        before = v.ask("log")["compared"]
        write("g.log", lines[0])
        verdict("one of two that begins anew in its place is told", until(lambda: "replaced" in v.ask("log")["logs"][0]["lost"]))
        write("g.log", "".join(lines[:10] * half))
        write("h.log", "".join(lines))
        verdict("the other one goes on", until(lambda: v.ask("log")["logs"][1]["rows"] == rows))
        equal("but nothing is compared with what is not its log", v.ask("log")["compared"], before)


def test_requests(log):
    print("--- requests", flush=True)
    with Viewer(program, "--open", log) as v:
        for target in ("range", "range?log=0&run=0&from=0&to=1", "range?log=1&run=0&from=0&to=1&pixels=9", "range?log=0&run=7&from=0&to=1&pixels=9",
                       "range?log=0&run=0&from=1&to=0&pixels=9", "range?log=0&run=0&from=0&to=nan&pixels=9", "range?log=0&run=0&from=0&to=1e999&pixels=9",
                       "range?log=0&run=0&from=0&to=1&pixels=1537", "range?log=0&run=0&from=0&to=1&pixels=0", "range?log=-1&run=0&from=0&to=1&pixels=9",
                       "row?log=0&run=0", "next?log=0&run=0&at=0&back=2&kinds=1", "next?log=0&run=0&at=0&back=0&kinds=999"):
            status, words = v.status(target)
            verdict(target, status == 400 and words.count("\n") == 1, (status, words))
        equal("from=0&to=1e300", v.status("range?log=0&run=0&from=0&to=1e300&pixels=9")[0], 200)
        equal("from=-1e300&to=1e-300", v.status("range?log=0&run=0&from=-1e300&to=1e-300&pixels=9")[0], 200)
        equal("there are no streams", v.status("events")[0], 404)
        equal("a file elsewhere", v.status("../../etc/passwd")[0], 404)
        equal("POST", v.status("range", "POST")[0], 405)
        equal("another Host", v.status("log", Host="evil.example")[0], 421)
        equal("a long query", v.status("log?" + "x" * 2000)[0], 414)
        equal("HEAD has no body", v.status("log", "HEAD"), (200, ""))


folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)
try:
    planted_log.record(program)
    test_values("t.a.log")
    test_gaps()
    test_logs("t.a.log")
    test_two("t.a.log")
    test_difference("t.a.log")
    test_tolerance("t.a.log")
    test_follow("t.a.log")
    test_follow_two()
    test_requests("t.a.log")
finally:
    end_all()
conclude()
