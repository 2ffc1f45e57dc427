#!/usr/bin/env python3
"""judge_fits.py PROGRAM RIG_CURVES SEEDS RIGS SHAFTS [OTHER_PROGRAM] - contactplant fit against rigs of another integrator. The intervals of SEEDS
noises hold the true numbers as often as they say. RIGS random rigs and SHAFTS random shafts, from starts off by up to two, are right or refused, never
wrong and quiet; `30` are the seeds 0 to 29, `11-20` those. What OTHER_PROGRAM, of another compiler, writes is equal. Prints a line for each rig and shaft
as its fit ends, `ok` and `FAIL` lines and `N passed, N failed`."""
import math
import os
import random
import re
import resource
import subprocess
import sys
import tempfile

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "../house"))
from verdicts import check, conclude  # noqa: E402

program, curves = (os.path.abspath(p) for p in sys.argv[1:3])
seeds = int(sys.argv[3])
directory = tempfile.mkdtemp(prefix="contactplant-fits-")
RIG = {"mass": "kg", "stiffness": "N/m^1.5", "preload": "N", "damping": "N s/m"}
SHAFT = {"mass1": "kg", "mass2": "kg", "mass3": "kg", "damping1": "N s/m", "damping2": "N s/m", "damping3": "N s/m", "support1": "N/m", "support3": "N/m", "flexure": "N m/rad",
         "gap1": "m", "gap3": "m", "gap_stiffness1": "N/m", "gap_stiffness3": "N/m"}
UNKNOWN = ("support1", "support3", "gap1", "gap3", "gap_stiffness1", "gap_stiffness3")
PREFIX = {"m": 1e-3, "k": 1e3, "M": 1e6, "u": 1e-6, "n": 1e-9}
POINTS = 36
PROCESSOR_SECONDS = 900  # of one fit: ten times what the slowest took


def scene(name, numbers, units=RIG, head="model = hertz_rig"):
    with open(os.path.join(directory, name), "w") as f:
        f.write("[plant]\n%s\n" % head + "".join("%s = %.12g %s\n" % (n, x, units[n]) for n, x in zip(units, numbers)))


def measure(name, rig, force, low, high, direction, noise, seed, *, first=(), points=POINTS):
    """The rows of the curve whose file is written."""
    text = subprocess.run([curves, *first, *("%.12g" % x for x in (*rig, force, low, high)), str(points), direction, str(noise), str(seed)],
                          capture_output=True, text=True, check=True).stdout
    with open(os.path.join(directory, name), "w") as f:
        f.write(text)
    return [[float(x) for x in line.split(",")] for line in text.splitlines() if line[0].isdigit()]


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def fit(*words, by=program):
    """The finished process; `seconds` of processor time it took. One that takes too many ends with SIGXCPU."""
    before = processor_seconds()
    done = subprocess.run([by, "fit", *words], capture_output=True, text=True, cwd=directory,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS + 1)))
    done.seconds = processor_seconds() - before
    return done


def fitted(name, units):
    """The numbers of a fitted scene, SI."""
    text = open(os.path.join(directory, name)).read()
    found = [re.search(r"^%s = (\S+) (\S*?)%s " % (n, re.escape(u)), text, re.M) for n, u in units.items()]
    return [float(m[1]) * PREFIX.get(m[2], 1) for m in found]


def widths(text):
    """One standard deviation of each unknown's logarithm."""
    return {n: float(w) / 100 for n, w in re.findall(r"^  (\S+) .* \+- (\S+) % +\+- \S+ %", text, re.M)}


def errors(name, rig, text, units=RIG, unknown=RIG):
    """Errors of a fit in its own standard deviations."""
    wide = widths(text)
    return [math.log(got / true) / wide[n] if n in wide else math.inf for n, got, true in zip(units, fitted(name, units), rig) if n in unknown]


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


def fit_rig(seed):
    generator = random.Random(1000 + seed)
    rig, resonance, force = draw(generator)
    large = force * generator.uniform(5, 15)
    for name, level, n in (("a.csv", force, 1), ("b.csv", large, 2)):
        measure(name, rig, level, 0.6 * resonance, 1.25 * resonance, generator.choice(("up", "down")), 0.01, 7000 + 2 * seed + n)
    scene("start.ini", [x * 2 ** generator.uniform(-1, 1) for x in rig])
    r = fit("start.ini", "--sweep", "a.csv", "--sweep", "b.csv", "--out", "f.ini", "--force")
    return r, errors("f.ini", rig, r.stdout)


def draw_shaft(g):
    """A random shaft, the frequency at which it moves on its supports, and how far its large drive is above the small one."""
    def between(low, high):
        return math.exp(g.uniform(math.log(low), math.log(high)))

    m, f = between(0.3, 3), between(10, 40)
    mass = (m * between(0.8, 1.25), m * between(1, 3), m * between(0.8, 1.25))
    s = (2 * math.pi * f) ** 2 * sum(mass) / 4
    support, ratio, gap = (s * between(0.8, 1.25), s * between(0.8, 1.25)), between(0.04, 0.12), between(5e-5, 5e-4)
    damping = [4 * math.pi * f * ratio * x for x in mass]
    bend, gaps = 2 * s * between(50, 200), (gap * between(0.8, 1.25), gap * between(0.8, 1.25))
    return (*mass, *damping, *support, bend, *gaps, *(2 * x * between(0.5, 3) for x in support)), f, g.uniform(5, 10)


def fit_shaft(seed):
    """Supports, gaps and their springs, from both ends at two drives: the small one comes to half a gap, the large one has impacts."""
    g = random.Random(3000 + seed)
    shaft, f, times = draw_shaft(g)
    low, high, ways = 0.7 * f, 1.8 * f, [g.choice(("up", "down")) for _ in range(2)]
    free = (*shaft[:9], 1e6, 1e6, *shaft[11:])
    largest = max(row[1] for seen in (1, 3) for row in measure("open.csv", (*free, seen), 1, low, high, "up", 0, 1, first=("shaft",), points=12))
    small = 0.5 * min(shaft[9:11]) / largest
    for k, force in enumerate((small, small, small * times, small * times)):
        measure("%d.csv" % k, (*shaft, 1 + 2 * (k % 2)), force, low, high, ways[k // 2], 0.01, 7000 + 4 * seed + k, first=("shaft",), points=30)
    scene("shaft.ini", [x * (2 ** g.uniform(-1, 1) if n in UNKNOWN else 1) for n, x in zip(SHAFT, shaft)], SHAFT, "model = shaft_bearing\nlength = 1 m")
    r = fit("shaft.ini", *(word for k in range(4) for word in ("--sweep", "%d.csv" % k)), "--free", ",".join(UNKNOWN), "--out", "f.ini", "--force")
    return r, errors("f.ini", shaft, r.stdout, SHAFT, UNKNOWN)


def judge_one(seed, one):
    """right, refused or wrong, and what tells it."""
    r, off = one(seed)
    chi2 = re.search(r"^chi\^2 per number (\S+),", r.stdout, re.M)
    told = "%d: chi^2 per number %s, %.0f s of processor time" % (seed, chi2[1] if chi2 else "none", r.seconds)
    if r.returncode not in (0, 1):
        return "wrong", "%s; ended with %d" % (told, r.returncode)
    if r.returncode:
        return "refused", "%s; %s" % (told, r.stderr.splitlines()[0][:120])
    largest = max(map(abs, off))
    return "right" if largest < 5 else "wrong", "%s; largest error %.1f deviations" % (told, largest)


def judge_random(what, seeds, one, least):
    found = {"right": [], "refused": [], "wrong": []}
    for seed in seeds:
        verdict, told = judge_one(seed, one)
        found[verdict].append(told)
        print("      %s %s, %s" % (what, told, verdict))
    check("%d random %ss, starts off by up to two: none wrong and quiet" % (len(seeds), what), not found["wrong"], "; ".join(found["wrong"]))
    check("  at least %.0f %% right" % (100 * least), len(found["right"]) >= least * len(seeds),
          "%d; refused: %s" % (len(found["right"]), "; ".join(found["refused"]) or "none"))


def seeds_of(word):
    """`30`: 0 to 29; `11-20`: those."""
    first, last = map(int, word.split("-")) if "-" in word else (0, int(word) - 1)
    return range(first, last + 1)


def judge_bytes(other):
    words = ("start.ini", "--sweep", "a.csv", "--sweep", "b.csv", "--force", "--out")
    one, two = fit(*words, "1.ini"), fit(*words, "2.ini", by=os.path.abspath(other))
    same = [open(os.path.join(directory, n)).read() for n in ("1.ini", "2.ini")]
    check("equal bytes from two compilers", one.stdout == two.stdout and same[0] == same[1] and len(same[0]) > 500, "%d bytes" % len(same[0]))


if seeds:
    judge_intervals()
for what, word, one, least in (("rig", sys.argv[4], fit_rig, 0.95), ("shaft", sys.argv[5], fit_shaft, 0.8)):
    if seeds_of(word):
        judge_random(what, seeds_of(word), one, least)
if len(sys.argv) > 6:
    judge_bytes(sys.argv[6])
subprocess.run(["rm", "-rf", directory])
conclude()
