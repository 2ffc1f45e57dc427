#!/usr/bin/env python3
"""other_fits.py PROGRAM DATA - contactplant fit beside scipy's least_squares and lmfit's conf_interval on the same files of DATA
(docs/examples/fit): values and intervals agree. The rig is integrated by scipy's DOP853. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import math
import os
import re
import subprocess
import sys
import tempfile

import lmfit
import numpy
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "../house"))
from lever_data import KT, LEVER, heat_text  # noqa: E402
from verdicts import check, conclude  # noqa: E402

program, data = (os.path.abspath(p) for p in sys.argv[1:3])
directory = tempfile.mkdtemp(prefix="contactplant-other-")
PREFIX = {"": 1, "z": 1e-21, "a": 1e-18, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
START = {"mass": (6.5, "kg"), "stiffness": (3.4e9, "N/m^1.5"), "preload": (64.0, "N"), "damping": (188.0, "N s/m")}


def rows_of(path):
    with open(path) as f:
        lines = [line for line in f if not line.startswith("#")]
    return numpy.array([[float(x) for x in line.split(",")] for line in lines[1:]])


def fit(model, units, *words):
    """Values of the fitted scene and standard deviations of their logarithms."""
    with open(os.path.join(directory, "start.ini"), "w") as f:
        f.write("[plant]\nmodel = %s\n" % model + "".join("%s = %.12g %s\n" % (n, v, u) for n, (v, u) in START.items()))
    scene = "start.ini" if model.startswith("hertz") else model
    r = subprocess.run([program, "fit", scene, *words, "--out", "f.ini", "--force"], capture_output=True, text=True, cwd=directory, timeout=300)
    with open(os.path.join(directory, "f.ini")) as f:
        text = f.read()
    found = {n: re.search(r"^%s = (\S+) ?([zamkMG]?)%s " % (n, re.escape(u)), text, re.M) for n, u in units.items()}
    widths = {n: float(w) / 100 for n, w in re.findall(r"^  (\S+) .* \+- (\S+) % +\+- \S+ %", r.stdout, re.M)}
    return {n: float(m[1]) * PREFIX[m[2]] for n, m in found.items()}, widths, r


def deviations(s):
    """From scipy's Jacobian."""
    return numpy.sqrt(numpy.diag(numpy.linalg.inv(s.jac.T @ s.jac)))


def compare(name, ours, widths, theirs, sd, names, share):
    off = max(abs(math.log(ours[n] / t)) / d for n, t, d in zip(names, theirs, sd))
    check("%s: values" % name, off < share, "%.3f standard deviations apart" % off)
    wide = max(abs(widths[n] / d - 1) for n, d in zip(names, sd))
    check("  and their standard deviations", wide < share, "%.3f; ours %s, theirs %s" % (wide, [widths[n] for n in names], list(sd)))


def linear_residuals(u, f, measured, preload, force):
    mass, stiffness, damping = numpy.exp(u)
    w = 2 * math.pi * f
    k = 1.5 * stiffness ** (2 / 3) * preload ** (1 / 3)
    off = (force / (k - mass * w ** 2 + 1j * damping * w) - measured) / (0.01 * abs(measured))
    return numpy.concatenate([off.real, off.imag])


def test_linear():
    """A small curve and the rig that is linear about its rest: closed form."""
    rows = rows_of(os.path.join(data, "small.csv"))
    arguments = (rows[:, 0], rows[:, 1] * numpy.exp(1j * rows[:, 2]), 80.0, 0.3)
    names = ("mass", "stiffness", "damping")
    ours, widths, _ = fit("hertz_rig_linear", {n: START[n][1] for n in names}, "--sweep", os.path.join(data, "small.csv"), "--hold", "preload=80 N")
    s = least_squares(linear_residuals, [math.log(START[n][0]) for n in names], args=arguments, x_scale="jac", xtol=1e-14, ftol=1e-14)
    compare("least_squares of a linear rig", ours, widths, numpy.exp(s.x), deviations(s), names, 0.02)
    parameters = lmfit.Parameters()
    for n, x in zip(names, s.x):
        parameters.add(n, value=x)
    problem = lmfit.Minimizer(lambda p, *a: linear_residuals([p[n].value for n in names], *a), parameters, fcn_args=arguments, scale_covar=False)
    result = problem.minimize()
    intervals = lmfit.conf_interval(problem, result, sigmas=[0.95])
    for n in names:
        low, high = (intervals[n][i][1] for i in (0, 2))
        reach = 1.98 * widths[n] * math.sqrt(result.redchi)  # lmfit takes the noise from chi^2 itself
        check("conf_interval of lmfit, %s: 95 %%" % n, abs((high - low) / (2 * reach) - 1) < 0.03 and low < math.log(ours[n]) < high,
              "%.5g to %.5g, ours +- %.4g about %.5g" % (low, high, reach, math.log(ours[n])))


def ring_residuals(u, t, y, noise):
    stiffness, preload, damping = numpy.exp(u[:3])
    z0, v0 = u[3] * 1e-6, u[4] * 1e-3

    def rate(_, x):
        return [x[1], (preload - damping * x[1] - (stiffness * x[0] ** 1.5 if x[0] > 0 else 0.0)) / 6.1]

    s = solve_ivp(rate, (t[0], t[-1]), [z0, v0], "DOP853", t_eval=t, rtol=1e-9, atol=1e-14)
    return (s.y[0] - y) / noise


def test_ring():
    """A free motion with large swings, against an integrator of scipy."""
    rows = rows_of(os.path.join(data, "decay.csv"))
    names = ("stiffness", "preload", "damping")
    ours, widths, _ = fit("hertz_rig", {n: START[n][1] for n in names}, "--ring", os.path.join(data, "decay.csv"), "--hold", "mass=6.1 kg")
    start = [math.log(ours[n] * x) for n, x in zip(names, (1.01, 0.99, 1.02))] + [rows[0, 1], 0.0]
    s = least_squares(ring_residuals, start, args=(rows[:, 0] * 1e-3, rows[:, 1] * 1e-6, 20e-9), x_scale="jac", diff_step=1e-6)
    compare("least_squares of a ring-down", ours, widths, numpy.exp(s.x[:3]), deviations(s)[:3], names, 0.05)


def test_heat():
    """A thermal spectrum: scipy's least squares of the deviances; the noise is that of the segments."""
    with open(os.path.join(directory, "heat.csv"), "w") as f:
        f.write(heat_text(LEVER, 60, 3))
    rows, names = rows_of(os.path.join(directory, "heat.csv")), ("f0", "stiffness", "quality")
    ours, widths, _ = fit("tapping", {"f0": "Hz", "stiffness": "N/m", "quality": ""}, "--thermal", "heat.csv")
    near = abs(rows[:, 0] - ours["f0"]) < 20 * ours["f0"] / ours["quality"]
    f, y = rows[near, 0], rows[near, 1]

    def residuals(u):
        f0, k, q = numpy.exp(u[:3])
        x = y / (2 * KT / (math.pi * k * f0 * q) / ((1 - (f / f0) ** 2) ** 2 + (f / f0 / q) ** 2) + u[3] * 1e-27)
        return numpy.sign(x - 1) * numpy.sqrt(2 * 60 * numpy.maximum(x - 1 - numpy.log(x), 0))

    s = least_squares(residuals, [math.log(LEVER[n]) for n in names] + [1.0], x_scale="jac", bounds=([-100] * 3 + [0], 100))
    compare("least_squares of a thermal spectrum", ours, widths, numpy.exp(s.x[:3]), deviations(s)[:3], names, 0.15)


test_linear()
test_ring()
test_heat()
subprocess.run(["rm", "-rf", directory], check=True)
conclude()
