#!/usr/bin/env python3
"""test_numbers.py PROGRAM - numbers that one command writes and another one takes, times off a step by rounding, and tolerances. Prints `ok`
and `FAIL` lines and `N passed, N failed`."""
import csv
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import check, conclude, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1])


def run(*arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, cwd=directory, timeout=120)


def rows_of(text):
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def simulate(scene, *arguments):
    """The states of the rows: the columns between the time and the observable, which is the last."""
    said = run("simulate", scene, *arguments)
    return [[float(x) for x in line.split(",")[1:-1]] for line in said.stdout.splitlines()[1:] if line[0] != "#"] if said.returncode == 0 else [[math.nan]] * 2


def miss(a, b):
    return max(abs(x - y) for x, y in zip(a, b)) / max(map(abs, a))


def ends(row):
    return [float(v) for k, v in row.items() if k.startswith("end_") and k != "end_phases"]


def names(row, before):
    return [k[len(before):] for k in row if k.startswith(before) and k != "end_phases"]


def state(values):
    return "--state=" + ",".join("%.17g" % x for x in values)


# A scene of each paper and each of its models, with its forcing period in the scene's units; and scenes in SI.
SCENES = [("bbp-fig3", 2 * math.pi / 0.95), ("kb-fig3", None), ("nayak-fig7", 2 * math.pi / 0.8), ("nayak-fig13", None), ("shaft-fig16-705", 1 / 705),
          ("kb-fig16-slow", None), ("rig", 1 / 150), ("tapping", None)]


def number(scene, key):
    for line in run("scene", scene).stdout.splitlines():
        if line.split("=")[0].strip() == key:
            return float(line.split("=")[1].split()[0])
    return math.nan


def test_resume():
    for scene, period in SCENES:
        said = run("basin", scene, "--starts", "2", "--cores", "1")
        settled = [r for r in rows_of(said.stdout) if r["outcome"] == "settled"]
        omega = number(scene, "omega") if period is None else 0.0
        omega = number(scene, "Omega") if omega != omega else omega
        period = period or (2 * math.pi / omega if omega == omega else 1 / number(scene, "frequency"))
        if not settled:
            verdict(scene + ": a start settles", False, said.stderr + said.stdout)
            continue
        row = settled[0]
        begin, end = simulate(scene, state(ends(row)), "--at", "0,%.17g" % (period * int(row["period"])))
        check("%s: an end of basin is periodic in simulate" % scene, miss(begin, end) < 1e-4, "period %s, off by %.1e of itself" % (row["period"], miss(begin, end)))
        own = run("simulate", scene, "--at", "0").stdout.split("\n")[0].split(",")[1:-1]
        verdict(scene + ": its columns have simulate's names, and units", all(n == o or n.startswith(o + "_") for n, o in zip(names(row, "end_"), own)), names(row, "end_"))
        box = run("basin", scene, "--starts", "1", "--periods", "1", *[x for n, v in zip(own, ends(row)) for x in ("--box", "%s=%.17g%s:%.17g%s" % (n, v, unit(row, n), v, unit(row, n)))])
        start = [float(v) for k, v in (rows_of(box.stdout) or [{}])[0].items() if any(k == n or k.startswith(n + "_m") for n in own)]
        verdict(scene + ": --box takes them", start and miss(ends(row), start) < 1e-12, box.stderr + str(start))


def unit(row, name):
    for k in row:
        if k.startswith("end_" + name):
            return {"_m": "m", "_m_per_s": "m/s"}.get(k[len("end_" + name):], "")
    return ""


def test_sweep_end():
    for scene, key, value, phase in (("nayak-fig7", "Omega", 0.8, "phi"), ("bbp-fig3", "omega", 0.95, "phi")):
        row = [r for r in rows_of(run("sweep", scene, "--sweep", "%s=%g:%g:2" % (key, value, 1.01 * value), "--cores", "1").stdout) if r["direction"] == "up"][0]
        turns = [int(x, 16) / 2.0 ** 64 for x in row["end_phases"].split(":")]
        sounds = max(turns) * 2 * math.pi  # the one drive that sounds
        begin, end = simulate(scene, "--set", "%s=%.17g rad" % (phase, sounds), state(ends(row)), "--at", "0,%.17g" % (2 * math.pi / value))
        check("%s: an end of sweep is periodic in simulate" % scene, miss(begin, end) < 1e-5, "off by %.1e of itself" % miss(begin, end))


def test_times():
    """A row that misses a step by 1e-14 s and more is where a row at the step is, and a rate times the way further."""
    for scene, step, options in (("rig", 1e-5, ()), ("tapping", 1e-7, ()), ("seed", 1e-7, ()), ("tip", 1e-8, ())):
        at = 32 * step
        for way in (1e-16, 1e-14, 3e-13, 2e-12):
            base = simulate(scene, "--step", repr(step), "--at", "%.17g,%.17g" % (step, at), *options)[1]
            near = simulate(scene, "--step", repr(step), "--at", "%.17g,%.17g" % (step, at + way), *options)[1]
            if way <= 1e-9 * step:
                verdict("%s: a row %g s behind a step is at it" % (scene, way), near == base, (base, near))
                continue
            half = len(base) // 2
            gone = [(near[i] - base[i]) - base[half + i] * way for i in range(half)]
            far = max(abs(base[half + i]) * way for i in range(half)) + 1e-15 * max(map(abs, base[:half]))
            verdict("%s: a row %g s behind a step" % (scene, way), max(map(abs, gone)) <= 1e-2 * far + 4e-16 * max(map(abs, base[:half])), (base, near))
    for digits in (9, 11, 12):
        times = ["%.*g" % (digits, i * 100 / 3 / 70e3 / 1000) for i in range(1, 301)]
        said = run("simulate", "tapping", "--at", ",".join(times))
        check("tapping: 300 even rows with %d digits" % digits, said.returncode == 0 and len(said.stdout.splitlines()) == 301, said.stderr[-80:].strip())


def test_loose():
    text = run("scene", "rig").stdout
    for tolerance in ("0.011", "0.05", "0.1"):
        with open(os.path.join(directory, "loose.ini"), "w") as f:
            f.writelines("tolerance = %s\n" % tolerance if x.startswith("tolerance") else "substeps = 2\n" if x.startswith("substeps") else x + "\n" for x in text.splitlines())
        for words in (("simulate", "loose.ini", "--until", "0.01"), ("choose", "loose.ini"), ("choose", "loose.ini", "--tolerance", "0.005"), ("run", "loose.ini", "--bus", "udp:127.76.%d.%d:20000" % (os.getpid() >> 8 & 255, os.getpid() & 255), "--duration", "0.01")):
            said = run(*words)
            check("tolerance %s: %s" % (tolerance, " ".join(words[:1] + words[2:4])), said.returncode == 0, said.stderr[-80:].strip() if said.returncode else "")
    with open(os.path.join(directory, "coarse.ini"), "w") as f:
        f.writelines("method = rk4\n" if x.startswith("method") else "substeps = 2\n" if x.startswith("substeps") else x + "\n" for x in text.splitlines())
    said = run("simulate", "coarse.ini", "--until", "0.01")
    verdict("a step too coarse for the file's method is refused with its line", said.returncode == 2 and "coarse.ini:5: method: step too coarse for rk4" in said.stderr, said.stderr)
    for option in (("--method", "taylor"), ("--step", "1e-5")):
        said = run("simulate", "coarse.ini", "--until", "0.01", *option)
        verdict("and %s comes before that judgement" % option[0], said.returncode == 0, said.stderr)


def test_no_tolerance():
    for words, says in ((("afm_lever",), "method modal has no tolerance"), (("tapping",), "method modal has no tolerance"), (("rig", "--method", "rk4"), "method rk4 has no tolerance"), (("rig",), ""), (("rig", "--method", "taylor"), "")):
        said = run("simulate", *words, "--at", "0,1e-5", "--tol", "1e-9")
        verdict("simulate %s --tol: says %s" % (" ".join(words), says or "nothing"), said.returncode == 0 and (says in said.stderr if says else "tolerance" not in said.stderr), said.stderr)
        verdict("and nothing without --tol", "tolerance" not in run("simulate", *words, "--at", "0,1e-5").stderr)


with tempfile.TemporaryDirectory() as directory:
    test_resume()
    test_sweep_end()
    test_times()
    test_loose()
    test_no_tolerance()
conclude()
