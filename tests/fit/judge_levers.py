#!/usr/bin/env python3
"""judge_levers.py PROGRAM LEVERS - contactplant fit on LEVERS random AFM levers, whose spectra and force curves come from lever_data.py, from
scenes that are off by up to two: each is right or refused, never wrong and quiet. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import math
import os
import random
import re
import subprocess
import sys
import tempfile

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "../house"))
from lever_data import A0, RADIUS, curve_text, heat_text  # noqa: E402
from verdicts import check, conclude  # noqa: E402

program, levers = os.path.abspath(sys.argv[1]), int(sys.argv[2])
directory = tempfile.mkdtemp(prefix="contactplant-levers-")
UNITS = {"f0": "Hz", "stiffness": "N/m", "quality": "", "hamaker": "J", "hamaker_out": "J", "modulus": "Pa"}
PREFIX = {"": 1, "z": 1e-21, "a": 1e-18, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}


def put(name, text):
    with open(os.path.join(directory, name), "w") as f:
        f.write(text)


def run(*words):
    return subprocess.run([program, *words], capture_output=True, text=True, cwd=directory, timeout=300)


def draw(g):
    def between(low, high):
        return math.exp(g.uniform(math.log(low), math.log(high)))

    lever = {"f0": between(1e4, 4e5), "stiffness": between(0.1, 20), "quality": between(30, 500), "hamaker": between(2e-20, 2e-19), "modulus": between(2e8, 1e10)}
    return {**lever, "hamaker_out": lever["hamaker"] * g.uniform(1, 1.6)}


def fitted():
    """Numbers of the fitted scene, SI."""
    with open(os.path.join(directory, "f.ini")) as f:
        text = f.read()
    found = {n: re.search(r"^%s = (\S+) ?([zamkMG]?)%s " % (n, re.escape(u)), text, re.M) for n, u in UNITS.items()}
    return {n: float(m[1]) * PREFIX[m[2]] for n, m in found.items()}


def judge():
    right, refused, wrong, inside, numbers = 0, [], [], 0, 0
    for seed in range(levers):
        g = random.Random(300 + seed)
        lever = draw(g)
        adhesion = lever["hamaker_out"] * RADIUS / (6 * A0 ** 2) / lever["stiffness"]
        put("heat.csv", heat_text(lever, g.choice((20, 60, 200)), seed))
        put("curve.csv", curve_text(lever, 0.005 * (adhesion + 1e-9), g.uniform(-5e-9, 5e-9), seed, top=max(15e-9, 1.5 * adhesion)))
        put("start.ini", "[plant]\nmodel = afm_lever\ntemperature = 295 K\n" + "".join("%s = %.12g %s\n" % (n, lever[n] * 2 ** g.uniform(-1, 1), u) for n, u in UNITS.items() if n != "hamaker_out") +
            "hamaker_out = 4e-19 J\n")
        r = run("fit", "start.ini", "--thermal", "heat.csv", "--curve", "curve.csv", "--out", "f.ini", "--force")
        widths = {n: float(w) / 100 for n, w in re.findall(r"^  (\S+) .* \+- (\S+) % +\+- \S+ %", r.stdout, re.M)}
        if r.returncode:
            refused.append("lever %d: %s" % (seed, r.stderr.splitlines()[0][:120]))
            continue
        off = {n: math.log(v / lever[n]) / widths[n] for n, v in fitted().items()}
        inside += sum(abs(x) < 1.96 for x in off.values())
        numbers += len(off)
        worst = max(off, key=lambda n: abs(off[n]))
        if abs(off[worst]) < 5:
            right += 1
        else:
            wrong.append("lever %d: %s by %.1f deviations, of %.2g %%" % (seed, worst, off[worst], 100 * widths[worst]))
    check("%d random levers, starts off by up to two: none wrong and quiet" % levers, not wrong, "; ".join(wrong))
    check("  at least 80 % right", right >= 0.8 * levers, "%d; refused: %s" % (right, "; ".join(refused) or "none"))
    check("  intervals of 95 % hold the true numbers in 90 % at least", inside >= 0.9 * numbers, "%d of %d" % (inside, numbers))


judge()
subprocess.run(["rm", "-rf", directory], check=True)
conclude()
