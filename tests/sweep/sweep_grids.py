"""sweep_grids.py - the jumps of each preset by three grids: a place on one grid must be told by all.

    sweep_grids.py PROGRAM FOLDER PAGE [PRESET ..]

tests/data/sweep_grids.txt names presets, ranges and grids. A jump with a place must have one on each other
grid, not further away than the width of both brackets. Or the other grid must say that it does not know what
is there: a row of another kind than point and jump, or a range up to the next point, also of a point that
another motion could have had (its column motions). It must say so on standard error too, with the place.
Prints a table in Markdown, then what fails; the status is 1 if something does. Without presets it writes the
table into PAGE.

Sweeps stay in FOLDER with the program's hash, so that a run that was ended goes on where it was. A sweep by
another program begins anew.
"""

import csv
import hashlib
import os
import re
import subprocess
import sys
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
    places, unknown, escaped = [], [], []
    jumps = [r for r in rows if r["kind"] in JUMPS]
    for first, second in zip(jumps[::2], jumps[1::2]):
        told = places if first["kind"] == "jump_from" else unknown
        told.append(span(float(first[swept]), float(second[swept])))
    points = [r for r in rows if r["kind"] not in JUMPS]
    for i, row in enumerate(points):
        if row["kind"] != "point" or float(row["motions"]) > 1.5:
            near = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
            where = escaped if row["kind"] == "escaped" else unknown
            where.append(span(float(near[0][swept]), float(near[1][swept])))
    return places, unknown, escaped


def read_told(lines):
    """The ranges on standard error."""
    found = [re.search(r"(?:not settled|by chance): .* between \S+ = (\S+) and ([^\s;,]+)", line) for line in lines]
    return [span(float(m[1]), float(m[2])) for m in found if m]


def inside(a, b):
    rounding = 1e-8 * max(map(abs, a))
    return b[0] - rounding <= a[0] and a[1] <= b[1] + rounding


def run(program, preset, swept_range, points, folder):
    """The sweep's rows, and its lines on standard error. Both files are complete where the key is."""
    out, err, key = (os.path.join(folder, f"{preset}.{points}.{end}") for end in ("csv", "err", "key"))
    arguments = ["sweep", preset, "--cores", "1", "--sweep", f"{swept_range}:{points}"]
    command = [program, *arguments, "--out", out]
    with open(program, "rb") as f:
        now = f"{hashlib.sha256(f.read()).hexdigest()} {' '.join(arguments)}"
    if not os.path.exists(key) or open(key, encoding="utf-8").read() != now:
        for path in (out, err, key):
            if os.path.exists(path):
                os.remove(path)
        with open(err, "w", encoding="utf-8") as f:
            if subprocess.run(command, stderr=f, check=False).returncode:
                sys.exit(f"{' '.join(command)}: {open(err, encoding='utf-8').read()}")
        with open(key, "w", encoding="utf-8") as f:
            f.write(now)
    with open(out, encoding="utf-8") as f, open(err, encoding="utf-8") as lines:
        return list(csv.DictReader(f)), read_told(lines)


def read_run(rows, told):
    """Per direction: places, and ranges that the grid does not know; and those of which standard error is silent."""
    swept = list(rows[0])[4]
    result = {"silent": []}
    for way in ("up", "down"):
        places, unknown, escaped = read_direction([r for r in rows if r["direction"] == way], swept)
        result["silent"] += [u for u in unknown if not any(inside(u, t) for t in told)]
        result[way] = places, unknown + escaped
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
    wrong += [f"{preset}: standard error is silent of {low:.9g} to {high:.9g} with {n} points"
              for n in grids for low, high in results[n]["silent"]]
    return [" ".join(agreed["up"]), " ".join(agreed["down"]), str(unknown)], wrong


def compare(program, case, folder):
    preset, swept_range, grids = case[0], case[1], case[2].split(",")
    return judge(preset, grids, {n: read_run(*run(program, preset, swept_range, n, folder)) for n in grids})


NO_PLACE = "|  |  | 0 |"


def write_page(page, table):
    """The table in the page becomes this one; presets without a place share its last row."""
    without = [row.split(" ")[1] for row in table if row.endswith(NO_PLACE)]
    table = [row for row in table if not row.endswith(NO_PLACE)]
    if without:
        table.append(f"| {', '.join(without)} | as tested |  {NO_PLACE}")
    with open(page, encoding="utf-8") as f:
        lines = f.read().splitlines()
    begin = lines.index(table[0])
    end = next((i for i in range(begin, len(lines)) if not lines[i].startswith("|")), len(lines))
    with open(page, "w", encoding="utf-8") as f:
        f.write("\n".join(lines[:begin] + table + lines[end:]) + "\n")


def main():
    program, folder, page, wanted = sys.argv[1], sys.argv[2], sys.argv[3], sys.argv[4:]
    cases = [c for c in read_cases() if not wanted or c[0] in wanted]
    table, failures = ["| preset | range | points | up | down | one-sided |", "|---|---|---|---|---|---|"], []
    print("\n".join(table))
    os.makedirs(folder, exist_ok=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for case, (cells, wrong) in zip(cases, pool.map(lambda c: compare(program, c, folder), cases)):
            table.append("| " + " | ".join([case[0], case[1], case[2].replace(",", ", ")] + cells) + " |")
            print(table[-1], flush=True)
            failures += wrong
    for line in failures:
        print(f"FAIL  {line}")
    if not failures:
        print(f"ok    {len(cases)} presets: each place is told by three grids, or they say that they do not know")
    if not wanted:
        write_page(page, table)
    return bool(failures) or not cases


if __name__ == "__main__":
    sys.exit(main())
