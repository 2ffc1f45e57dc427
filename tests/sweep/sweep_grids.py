"""sweep_grids.py - the jumps of each preset by three grids: a place on one grid must be told by all.

    sweep_grids.py PROGRAM [PRESET ..]

tests/data/sweep_grids.txt names presets, ranges and grids. A jump with a place must have one on each other
grid, not further away than the width of both brackets. Or the other grid must say that it does not know what
is there: a row of another kind than point and jump, or a range up to the next point. Prints a table in
Markdown, then what fails; the status is 1 if something does.
"""

import csv
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

CASES = os.path.join(os.path.dirname(__file__), "..", "data", "sweep_grids.txt")
JUMPS = ("jump_from", "jump_to", "jump_unsettled", "jump_chance")


def read_cases():
    with open(CASES, encoding="utf-8") as f:
        return [line.split() for line in f if line.strip() and not line.startswith("#")]


def span(a, b):
    return (min(a, b), max(a, b))


def read_direction(rows, swept):
    """Places, and ranges where the sweep says that it does not know."""
    places, unknown = [], []
    jumps = [r for r in rows if r["kind"] in JUMPS]
    for first, second in zip(jumps[::2], jumps[1::2]):
        told = places if first["kind"] == "jump_from" else unknown
        told.append(span(float(first[swept]), float(second[swept])))
    points = [r for r in rows if r["kind"] not in JUMPS]
    for i, row in enumerate(points):
        if row["kind"] != "point":
            near = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
            unknown.append(span(float(near[0][swept]), float(near[1][swept])))
    return places, unknown


def run(program, preset, swept_range, points, folder):
    out = os.path.join(folder, f"{preset}.{points}.csv")
    command = [program, "sweep", preset, "--cores", "1", "--sweep", f"{swept_range}:{points}", "--out", out]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.stderr}")
    with open(out, encoding="utf-8") as f:
        rows = list(csv.DictReader(f))
    swept = list(rows[0])[4]
    result = {way: read_direction([r for r in rows if r["direction"] == way], swept) for way in ("up", "down")}
    told = any("not settled:" in line or "by chance:" in line for line in done.stderr.splitlines())
    result["silent"] = not told and any(unknown for _, unknown in (result["up"], result["down"])) and not any(
        r["kind"] == "escaped" for r in rows)
    return result


def overlap(a, b):
    return abs(sum(a) - sum(b)) <= (a[1] - a[0]) + (b[1] - b[0])


def known(place, other):
    """Does another grid tell this place, or that it does not know?"""
    width = place[1] - place[0]
    if any(overlap(place, p) for p in other[0]):
        return "place"
    return "unknown" if any(low - width <= place[1] and place[0] <= high + width for low, high in other[1]) else ""


def judge(preset, grids, results):
    """The cells of a table's row, and what is wrong."""
    agreed, unknown, wrong = {"up": [], "down": []}, 0, []
    for way, cells in agreed.items():
        for n in grids:
            for place in results[n][way][0]:
                kinds = [known(place, results[m][way]) for m in grids if m != n]
                unknown += kinds.count("unknown")
                if "" in kinds:
                    wrong.append(f"{preset} {way}: {place[0]:.9g} to {place[1]:.9g} with {n} points, not with all")
                if all(k == "place" for k in kinds) and n == grids[0]:
                    cells.append(f"{sum(place) / 2:.5g}")
    wrong += [f"{preset}: nothing on stderr with {n} points" for n in grids if results[n]["silent"]]
    return [" ".join(agreed["up"]), " ".join(agreed["down"]), str(unknown)], wrong


def compare(program, case, folder):
    preset, swept_range, grids = case[0], case[1], case[2].split(",")
    return judge(preset, grids, {n: run(program, preset, swept_range, n, folder) for n in grids})


def main():
    program, wanted = sys.argv[1], sys.argv[2:]
    cases = [c for c in read_cases() if not wanted or c[0] in wanted]
    failures = []
    print("| preset | range | points | up | down | one-sided |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(os.cpu_count()) as pool:
        for case, (cells, wrong) in zip(cases, pool.map(lambda c: compare(program, c, folder), cases)):
            print("| " + " | ".join([case[0], case[1], case[2].replace(",", ", ")] + cells) + " |", flush=True)
            failures += wrong
    for line in failures:
        print(f"FAIL  {line}")
    if not failures:
        print(f"ok    {len(cases)} presets: each place is told by three grids, or they say that they do not know")
    return bool(failures) or not cases


if __name__ == "__main__":
    sys.exit(main())
