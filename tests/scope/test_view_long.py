#!/usr/bin/python3
"""test_view_long.py PROGRAM [GB] - a long log in contactplant scope --open: memory, and values that are decode's, are judged; times
are printed and are no verdict. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import os
import random
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
import planted_log  # noqa: E402
from processes import end_all  # noqa: E402
from verdicts import check, conclude  # noqa: E402
from view_client import Viewer  # noqa: E402

program = os.path.abspath(sys.argv[1])
ROWS = int(float(sys.argv[2] if len(sys.argv) > 2 else 1.0) * 1e9 / 138)  # bytes of three lines
HOLE = (ROWS // 2, ROWS // 2 + 5000)
EVERY, RANGES, SHARE = 997, 60, 0.05


def told_by_decode(log):
    """Every 997th row: time, tick, four outputs; and how many there are."""
    rows, n = [], -1
    with subprocess.Popen([program, "decode", log], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as p:
        for n, line in enumerate(p.stdout, -1):
            if n >= 0 and n % EVERY == 0:
                cell = line.split(",")
                rows.append((float(cell[0]), int(cell[2]), *(float(c) if c else None for c in cell[5:9])))
    return rows, n + 1


def is_inside(range_, rows):
    """No row lies outside the band of its pixel."""
    a, b, n = range_["from"], range_["to"], range_["columns"]
    for t, _, *values in rows:
        if not a < t < b:
            continue
        i = int((t - a) / (b - a) * n)
        near = [j for j in (i - 1, i, i + 1) if 0 <= j < n and range_["bands"]["0"][0][j] is not None]
        if not any(range_["bands"][str(k)][0][j] <= values[k] <= range_["bands"][str(k)][1][j] for k in range(4) for j in near):
            return (t, values)
    return True


folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)
try:
    planted_log.write("long.log", ROWS, [HOLE])
    size = os.path.getsize("long.log")
    with Viewer(program, "--open", "long.log") as v:
        check("opened: time, s (no verdict)", True, f"{v.took_s:.1f} for {size / 1e9:.2f} GB, {ROWS / 3.6e6:.2f} h at 1 kHz")
        share = v.kib() * 1024 / size
        check("memory below 5 % of the log", share < SHARE or size < 5e8, f"{100 * share:.2f} %")
        chance, took, end = random.Random(3), [], (ROWS - 1) / 1000
        for k in range(RANGES):
            span = end * 10 ** chance.uniform(-6, 0)
            a = chance.uniform(0, end - span)
            began = time.time()
            v.range(a, a + span, 1200)
            took.append(time.time() - began)
        check("a range of 1200 pixels: least, median, greatest time, ms (no verdict)", True,
              ", ".join(f"{1e3 * x:.0f}" for x in (min(took), sorted(took)[len(took) // 2], max(took))))
        check("memory after that", v.kib() * 1024 / size < SHARE or size < 5e8, f"{1e5 * v.kib() * 1024 / size / 1e3:.2f} %")
        rows, n = told_by_decode("long.log")
        check("decode has as many rows", v.ask("log")["logs"][0]["rows"] == n == ROWS - HOLE[1] + HOLE[0], n)
        wrong = []
        for row in rows[::max(1, len(rows) // 300)]:
            got = v.row(row[0] + 1e-4)
            if (got[0], got[2], *got[6:10]) != row:
                wrong.append((got, row))
        check("rows at a cursor are decode's", not wrong, wrong[:1])
        whole = v.range(0.0, end, 1200)
        check("each row is within the band of its pixel", is_inside(whole, rows) is True, is_inside(whole, rows))
        numbers = [planted_log.motion_of(p)[0] for p in range(planted_log.PHASES)]
        lows = {x for x in whole["bands"]["0"][0] if x is not None}
        check("the bands are what was written", lows == {float(f"{min(numbers) * 5e-11:.9g}")}, lows)
        close = v.range(HOLE[0] / 1000 - 1, HOLE[1] / 1000 + 1, 700)
        check("a hole of 5 s is a gap", close["bands"]["0"][0].count(None) > 480 and
              v.next(HOLE[0] / 1000, kinds=32)["t"] == HOLE[1] / 1000, close["bands"]["0"][0].count(None))
finally:
    end_all()
conclude()
