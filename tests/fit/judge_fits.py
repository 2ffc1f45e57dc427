#!/usr/bin/env python3
"""judge_fits.py PROGRAM RIG_CURVES SEEDS RIGS [OTHER_PROGRAM] - contactplant fit against rigs of another integrator. The intervals of SEEDS noises
hold the true numbers as often as they say. RIGS random rigs, from starts off by up to two, are right or refused, never wrong and quiet. What
OTHER_PROGRAM, of another compiler, writes is equal. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import math
import os
import random
import re
import subprocess
import sys
import tempfile

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "../house"))
from verdicts import check, conclude  # noqa: E402

program, curves = (os.path.abspath(p) for p in sys.argv[1:3])
seeds, rigs = int(sys.argv[3]), int(sys.argv[4])
directory = tempfile.mkdtemp(prefix="contactplant-fits-")
NAMES = ("mass", "stiffness", "preload", "damping")
UNITS = ("kg", "N/m^1.5", "N", "N s/m")
PREFIX = {"m": 1e-3, "k": 1e3, "M": 1e6, "u": 1e-6, "n": 1e-9}
POINTS = 36


def scene(name, numbers):
    with open(os.path.join(directory, name), "w") as f:
        f.write("[plant]\nmodel = hertz_rig\n" + "".join("%s = %.12g %s\n" % row for row in zip(NAMES, numbers, UNITS)))


def measure(name, rig, force, low, high, direction, noise, seed):
    with open(os.path.join(directory, name), "w") as f:
        f.write(subprocess.run([curves, *("%.12g" % x for x in (*rig, force, low, high)), str(POINTS), direction, str(noise), str(seed)],
                               capture_output=True, text=True, check=True).stdout)


def fit(*words, by=program):
    return subprocess.run([by, "fit", *words], capture_output=True, text=True, cwd=directory, timeout=300)


def fitted(name):
    """The numbers of a fitted scene, SI."""
    text = open(os.path.join(directory, name)).read()
    found = [re.search(r"^%s = (\S+) (\S*?)%s " % (n, re.escape(u)), text, re.M) for n, u in zip(NAMES, UNITS)]
    return [float(m[1]) * PREFIX.get(m[2], 1) for m in found]


def widths(text):
    """One standard deviation of each unknown's logarithm."""
    return {n: float(w) / 100 for n, w in re.findall(r"^  (\S+) .* \+- (\S+) % +\+- \S+ %", text, re.M)}


def errors(name, rig, text):
    """Errors of a fit in its own standard deviations."""
    wide = widths(text)
    return [math.log(got / true) / wide[n] if n in wide else math.inf for n, got, true in zip(NAMES, fitted(name), rig)]


def judge_intervals():
    rig = (6.1, 3.9e9, 80.0, 150.0)
    scene("start.ini", (6.5, 3.4e9, 64.0, 188.0))
    inside, refused, squares = [0] * 4, 0, 0.0
    for seed in range(seeds):
        measure("a.csv", rig, 0.3, 150, 320, "up", 0.01, 2 * seed + 1)
        measure("b.csv", rig, 3, 150, 320, "up", 0.01, 2 * seed + 2)
        r = fit("start.ini", "--sweep", "a.csv", "--sweep", "b.csv", "--out", "f.ini", "--force")
        off = errors("f.ini", rig, r.stdout)
        inside = [n + (abs(x) < 1.96) for n, x in zip(inside, off)]
        squares += sum(x * x for x in off)
        refused += r.returncode != 0
    share = sum(inside) / (4 * seeds)
    slack = 0.0 if seeds >= 200 else 0.05
    check("%d noises: intervals of 95 %% hold the true numbers in 92 to 98 %%" % seeds, 0.92 - slack <= share <= 0.98 + slack,
          "%.1f %%; each %s; error over its deviation %.2f; %d refused" % (100 * share, inside, math.sqrt(squares / (4 * seeds)), refused))


def draw(generator):
    """A random rig: numbers, resonance and the force that moves it by a tenth of its compression."""
    mass, preload = math.exp(generator.uniform(math.log(0.3), math.log(30))), math.exp(generator.uniform(math.log(5), math.log(500)))
    compression = math.exp(generator.uniform(math.log(1e-6), math.log(3e-5)))
    omega, ratio = math.sqrt(1.5 * preload / (mass * compression)), math.exp(generator.uniform(math.log(0.005), math.log(0.03)))
    rig = (mass, preload / compression ** 1.5, preload, 2 * mass * omega * ratio)
    return rig, omega / (2 * math.pi), 0.1 * compression * mass * omega ** 2 * 2 * ratio


def judge_rigs():
    right, refused, wrong = 0, [], []
    for seed in range(rigs):
        generator = random.Random(1000 + seed)
        rig, resonance, force = draw(generator)
        large = force * generator.uniform(5, 15)
        for name, level, n in (("a.csv", force, 1), ("b.csv", large, 2)):
            measure(name, rig, level, 0.6 * resonance, 1.25 * resonance, generator.choice(("up", "down")), 0.01, 7000 + 2 * seed + n)
        scene("start.ini", [x * 2 ** generator.uniform(-1, 1) for x in rig])
        r = fit("start.ini", "--sweep", "a.csv", "--sweep", "b.csv", "--out", "f.ini", "--force")
        off = max(map(abs, errors("f.ini", rig, r.stdout)))
        if r.returncode:
            refused.append("rig %d: %s" % (seed, r.stderr.splitlines()[0][:120]))
        elif off < 5:
            right += 1
        else:
            wrong.append("rig %d: %.1f deviations" % (seed, off))
    check("%d random rigs, starts off by up to two: none wrong and quiet" % rigs, not wrong, "; ".join(wrong))
    check("  at least 95 % right", right >= 0.95 * rigs, "%d; refused: %s" % (right, "; ".join(refused) or "none"))


def judge_bytes(other):
    words = ("start.ini", "--sweep", "a.csv", "--sweep", "b.csv", "--force", "--out")
    one, two = fit(*words, "1.ini"), fit(*words, "2.ini", by=os.path.abspath(other))
    same = [open(os.path.join(directory, n)).read() for n in ("1.ini", "2.ini")]
    check("equal bytes from two compilers", one.stdout == two.stdout and same[0] == same[1] and len(same[0]) > 500, "%d bytes" % len(same[0]))


judge_intervals()
judge_rigs()
if len(sys.argv) > 5:
    judge_bytes(sys.argv[5])
subprocess.run(["rm", "-rf", directory])
conclude()
