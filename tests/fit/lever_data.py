"""lever_data.py - thermal spectra and force curves of AFM levers from formulas of their own, for tests of fits."""
import math
import random

LEVER = {"f0": 70e3, "stiffness": 2.0, "quality": 150.0, "hamaker": 6.4e-20, "hamaker_out": 9e-20, "modulus": 1e9}
RADIUS, A0, KT = 10e-9, 0.165e-9, 1.380649e-23 * 295


def heat_text(lever, segments, seed):
    """A spectrum by the fluctuation-dissipation theorem, each bin a mean of so many periodograms; 0.3 fm^2/Hz of white noise."""
    g, rows = random.Random(seed), []
    f0, k, q = lever["f0"], lever["stiffness"], lever["quality"]
    for i in range(1, 1200):
        f = 0.5 * f0 * (1 + i / 1200)
        f += 0.1 * f0
        density = 2 * KT / (math.pi * k * f0 * q) / ((1 - (f / f0) ** 2) ** 2 + (f / f0 / q) ** 2) + 1e-27
        rows.append("%.9g,%.6g\n" % (f, g.gammavariate(segments, density / segments)))
    return "frequency_Hz,density_m2_per_Hz\n" + "".join(rows)


def root(f, low, high):
    """By bisection."""
    if not f(low) * f(high) <= 0:
        return None
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (low, middle) if f(low) * f(middle) <= 0 else (middle, high)
    return low


def rest(lever, base, out, touching, power):
    """Gap of the lever at rest, on this side; None where there is none."""
    pull = lever["hamaker_out" if out else "hamaker"] * RADIUS / 6
    hertz = 4 / 3 * lever["modulus"] * math.sqrt(RADIUS) * (1e-9) ** (1.5 - power)

    def balance(d):
        force = -pull / d ** 2 if d > A0 else hertz * (A0 - d) ** power - pull / A0 ** 2
        return lever["stiffness"] * (d - base) - force

    return root(balance, base - 2e-6, A0) if touching else root(balance, max(2 / 3 * base, A0), base) if base > A0 else None


def curve_text(lever, noise, contact, seed, power=1.5, top=25e-9):
    """From `top` down to -top/5 and back; the base counts from `contact`."""
    g, touching, rows, n = random.Random(seed), False, [], 240
    for i in range(2 * n):
        base = top * (1 - 1.2 * (i if i < n else 2 * n - 1 - i) / (n - 1))
        gap = rest(lever, base, i >= n, touching, power)
        if gap is None:
            touching = not touching
            gap = rest(lever, base, i >= n, touching, power)
        rows.append("%d,%.9g,%.9g\n" % (i >= n, base + contact, gap - base + g.gauss(0, noise)))
    return "retract,base_m,deflection_m\n" + "".join(rows)
