#!/usr/bin/python3
"""Reports in Chromium: each opens from its file without a complaint, and its numbers are those of the CSV.

    test_report.py PROGRAM [FOLDER]     pictures and PDFs of what was seen go into FOLDER
"""
import base64
import csv
import json
import os
import re
import subprocess
import sys
import tempfile
import time

from access import access
from chromium import Chromium

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "../house"))
from verdicts import check, conclude  # noqa: E402

program = os.path.abspath(sys.argv[1])
pictures = sys.argv[2] if len(sys.argv) > 2 else None


def run(*words, status=0):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if status is not None and done.returncode != status:
        check("contactplant " + " ".join(words), False, f"status {done.returncode}, {done.stderr}")
    return done


def table(path):
    with open(path) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def data_of(path):
    """What the file holds, read without a browser."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S).group(1))


def charts(data):
    return {s["title"]: s for s in data["sections"] if s["kind"] == "chart"}


def number(text):
    value = float(text or "nan")
    return None if value != value else value


def looks(browser, path, name, words):
    """Opened from the file: no complaint, nothing loaded, every chart has ink, and it prints on A4."""
    tab = browser.open("file://" + path, 1000, 800)
    tab.wait("document.querySelectorAll('main .card').length > 0")
    inked = tab.run("""[...document.querySelectorAll('canvas')].map((canvas) => {
        const copy = new OffscreenCanvas(canvas.width, canvas.height), c = copy.getContext('2d', {willReadFrequently: true});
        c.drawImage(canvas, 0, 0);
        return c.getImageData(0, 0, canvas.width, canvas.height).data.some((v, i) => i % 4 === 3 && v > 0) && canvas.ariaLabel;
    })""")
    n = sum(s["kind"] == "chart" for s in data_of(path)["sections"])
    check(f"{name}: {n} charts are drawn and named", n > 0 and len(inked) == n and all(inked), inked[:2])
    text = tab.run("document.body.innerText")
    check(f"{name}: it says what it is", all(w in text for w in words), [w for w in words if w not in text] or words)
    check(f"{name}: nothing else was loaded", tab.run("performance.getEntriesByType('resource').length") == 0)
    fits = tab.run("document.documentElement.scrollWidth")
    check(f"{name}: fits", fits <= 1000, f"{fits} px")
    tab.size(688, 970)  # the width between the margins of A4
    tab.call("Emulation.setEmulatedMedia", media="print")
    fits = tab.run("document.documentElement.scrollWidth")
    check(f"{name}: fits the paper", fits <= 688, f"{fits} px")
    tab.call("Emulation.setEmulatedMedia", media="")
    tab.size(390, 844)
    fits = tab.run("document.documentElement.scrollWidth")
    check(f"{name}: fits a phone", fits <= 390, f"{fits} px")
    for dark in (True, False):
        tab.dark(dark)
        tab.wait(f"(document.documentElement.dataset.theme === 'dark') === {str(dark).lower()}")
        access(tab, f"{name}, {'dark' if dark else 'light'}")
        inks = tab.run("[...document.querySelectorAll('.key span[aria-hidden]')].map((e) => getComputedStyle(e).color)")
        check(f"{name}: each colour of a key is its own, and not the text's", tab.run("getComputedStyle(document.body).color") not in inks, inks)
        if pictures:
            time.sleep(0.3)
            tab.picture(os.path.join(pictures, f"{name}_390{'_dark' if dark else ''}.png"))
    tab.size(1000, 800)
    pdf = base64.b64decode(tab.call("Page.printToPDF", preferCSSPageSize=True, printBackground=True)["data"])
    boxes = set(re.findall(rb"/MediaBox\s*\[\s*0 0 ([\d.]+) ([\d.]+)", pdf))
    check(f"{name}: prints on A4", boxes and all(abs(float(w) - 595) < 2 and abs(float(h) - 842) < 2 for w, h in boxes), boxes)
    if pictures:
        os.makedirs(pictures, exist_ok=True)
        tab.size(1000, min(5000, tab.run("document.documentElement.scrollHeight")))
        time.sleep(0.3)
        tab.picture(os.path.join(pictures, name + ".png"))
        with open(os.path.join(pictures, name + ".pdf"), "wb") as file:
            file.write(pdf)
    check(f"{name}: no complaint in the console", not tab.errors, tab.errors or "")
    check(f"{name}: less than 1 MB", os.path.getsize(path) < 1e6, os.path.getsize(path))
    tab.close()


def close(a, b, digits=9):
    """Equal in the digits that the CSV has; with 17 of them to the bit."""
    return a == b or digits < 17 and a is not None and b is not None and abs(a - b) <= 5.1 * 10.0**-digits * abs(b)


def banded(layer, rows, x_name, y_name, digits=9):
    """A band's bins against all rows: the least and the greatest of each, and no row in none. Rows that are wrong."""
    per, bad = -(-len(rows) // len(layer["x"])), 0
    per = 1 << (per - 1).bit_length()
    for i, x in enumerate(layer["x"]):
        part = [number(r[y_name]) for r in rows[i * per:(i + 1) * per]]
        part = [v for v in part if v is not None] or [None]
        bad += abs(x - number(rows[i * per][x_name])) > 1e-9 or not close(layer["low"][i], min(part), digits)
        bad += not close(layer["high"][i], max(part), digits)
    return bad + (abs(layer["end"][0] - number(rows[-1][x_name])) > 1e-9) + (len(layer["x"]) * per < len(rows))


def simulate(browser, folder):
    out, events, page = (os.path.join(folder, n) for n in ("run.csv", "events.csv", "run.html"))
    run("simulate", "hertz_rig", "--drive", "force=40,200,0", "--until", "10", "--every", "0.001", "--out", out, "--events", events,
        "--report", page)
    rows, switches, data = table(out), table(events), data_of(page)
    for name in ("position", "velocity"):
        bad = banded(charts(data)[name]["layers"][0], rows, "t", name, 17)
        check(f"simulate: the band of {name} has the numbers of the CSV", bad == 0, f"{bad} of {len(rows)} rows are not")
    words = " ".join(s["text"] for s in data["sections"] if s["kind"] == "words")
    kinds = [s["kind"] for s in switches]
    check("simulate: contacts are counted as in the CSV",
          f"made {kinds.count('touchdown')} times and lost {kinds.count('liftoff')} times" in words, words[:120])
    listed = next(s for s in data["sections"] if s["kind"] == "table" and s["title"].startswith("Contact switches"))
    check("simulate: their time has a unit", listed["columns"].startswith("time (s),"), listed["columns"])
    check("simulate: the first switches are those of the CSV", [c["cells"][1] for c in listed["rows"]] == kinds[:20] and
          all(abs(float(c["cells"][0]) - float(s["t"])) <= 1e-11 for c, s in zip(listed["rows"], switches)))
    share, open_s, since = charts(data)["contact"]["layers"][0]["share"], 0.0, None
    for s in switches:
        if s["kind"] == "liftoff":
            since = float(s["t"])
        elif since is not None:
            open_s, since = open_s + float(s["t"]) - since, None
    open_s += 10.0 - since if since is not None else 0.0
    check("simulate: the open time is that between the CSV's switches", abs(sum(share) / len(share) * 10.0 - open_s) < 1e-9,
          f"{open_s:.6f} s")
    looks(browser, page, "simulate", ["hertz_rig", "--drive force=40,200,0", "hash of the state", "stiffness"])
    # few rows: each is there, and no line joins what is too fast for them
    run("simulate", "hertz_rig", "--until", "0.5", "--every", "0.01", "--drive", "force=3,200,0", "--out", out, "--report", page)
    layer = charts(data_of(page))["position"]["layers"][0]
    check("simulate: fast motion in few rows is drawn as points", layer["kind"] == "points" and
          layer["y"] == [number(r["position"]) for r in table(out)])
    run("simulate", "hertz_rig", "--until", "0.05", "--every", "0.0002", "--drive", "force=3,200,0", "--out", out, "--report", page)
    check("simulate: ten rows to a period are joined", charts(data_of(page))["position"]["layers"][0]["kind"] == "line")


def sweep(browser, folder):
    out, page = os.path.join(folder, "sweep.csv"), os.path.join(folder, "sweep.html")
    run("sweep", "rig", "--sweep", "force.frequency=150 Hz:260 Hz:24", "--set", "force.amplitude=10 N", "--out", out, "--report", page)
    rows, data = table(out), data_of(page)
    for title, column in (("amplitude of penetration, harmonic 1", "amplitude_1_m"), ("its phase to the drive", "phase_1_rad"),
                          ("peak contact force", "peak_force_N")):
        bad = 0
        for layer in charts(data)[title]["layers"]:
            if layer["kind"] == "line":
                own = [r for r in rows if r["direction"] == layer["name"]]
                bad += layer["x"] != [number(r["force.frequency_Hz"]) for r in own]
                bad += layer["y"] != [number(r[column]) for r in own]
        check(f"sweep: {title} has the numbers of the CSV", bad == 0)
    jumps = [r for r in rows if r["kind"] == "jump_to"]
    told = [s for s in data["sections"] if s["kind"] == "table" and s["title"] == "Jumps"]
    check("sweep: each jump is in its table, and has a chart", jumps and len(told[0]["rows"]) == len(jumps) and
          sum(t.startswith("around the jump") for t in charts(data)) == len(jumps), f"{len(jumps)} jumps")
    looks(browser, page, "sweep", ["1 jump located by bisection:", "force.frequency", "[drive force]"])


def basin(browser, folder):
    """Starts and attractors against the rows, which are sorted here by period and peak."""
    out, page = os.path.join(folder, "basin.csv"), os.path.join(folder, "basin.html")
    told = run("basin", "shaft-fig16-705", "--starts", "200", "--out", out, "--report", page).stdout
    rows, data, groups = table(out), data_of(page), {}
    for r in rows:
        groups.setdefault((r["period"], f"{float(r['peak_position1_m']):.2g}"), []).append(r)
    groups = sorted(groups.values(), key=len, reverse=True)
    shown = [s for s in data["sections"] if s["kind"] == "chart"]
    for i, chart in enumerate(shown, 1):
        wanted = [[(float(r[f"x{i}_m"]), float(r[f"v{i}_m_per_s"])) for r in g] for g in groups]
        check(f"basin: {chart['title']} has the starts of the CSV, by attractor",
              [list(zip(layer["x"], layer["y"])) for layer in chart["layers"] if layer["kind"] == "points"] == wanted, [len(w) for w in wanted])
    cells = [r["cells"] for s in data["sections"] if s.get("title") == "Attractors" for r in s["rows"]]
    check("basin: counts and shares", [(int(c[1]), float(c[2])) for c in cells] ==
          [(len(g), 100 * len(g) / len(rows)) for g in groups] and len(shown) == 3 and len(groups) > 1, cells)
    check("basin: the table is the one that it prints", all(re.search(rf"^{c[0]} +{c[1]} +{c[2]} % +{c[3].replace(' to ', ' .. ')}", told, re.M)
                                                            for c in cells))
    looks(browser, page, "basin", ["200 starts lead to 2 attractors", rows[0]["run"], "contactplant basin", "gap1"])
    again = os.path.join(folder, "again.html")
    run("basin", "shaft-fig16-705", "--starts", "200", "--rows", out, "--report", again)
    check("basin: again from the rows", data_of(again)["sections"] == data["sections"])


def stability(browser, folder):
    """The cells of a kind have the area of the rows of this kind, and the words count them."""
    out, page = os.path.join(folder, "cells.csv"), os.path.join(folder, "cells.html")
    run("stability", "rig", "--map", "contact", "--method", "rk4", "--set", "force.amplitude=50 N", "--set", "force.frequency=180 Hz", "--periods", "10",
        "--x", "step=0.1 ms:2 ms:9", "--y", "stiffness=1 GN/m^1.5:10 GN/m^1.5:5:log", "--out", out, "--report", page)
    rows, data = table(out), data_of(page)
    layers = {layer["name"]: layer for chart in charts(data).values() for layer in chart["layers"] if layer["kind"] == "cells"}
    lost = [r for r in rows if float(r["energy_ratio"]) < 0.95]
    missed = [r for r in rows if float(r["method_switches"]) < float(r["switches"])]
    for name, own in (("energy lost, 5 % and more", lost), ("contact switches missed", missed)):
        area = sum(b - a for a, b in zip(layers[name]["x"], layers[name]["to"])) / ((2e-3 - 1e-4) / 8)
        check("stability: the cells are those of the CSV: " + name, own and abs(area - len(own)) < 1e-6, (area, len(own)))
    words = [s["text"] for s in data["sections"] if s["kind"] == "words"]
    check("stability: the words count them", f"energy lost, 5 % and more: {len(lost)} of 45 cells, {100 * len(lost) / 45:.3g} %" in words, words)
    looks(browser, page, "stability", ["contact switches that are none", "contactplant stability", "[drive force]"])


def random(browser, folder):
    """Density and crossing rates are those of the statistics, two errors to each side."""
    out, sums, page = (os.path.join(folder, "random" + end) for end in (".csv", ".statistics", ".html"))
    run("random", "nayak-random", "--observable", "displacement", "--range=-1:3", "--bins", "20", "--seeds", "6", "--over", "200", "--out", out,
        "--statistics", sums, "--report", page)
    own = [r for r in table(sums) if r["kind"] == "density"]
    band, form = charts(data_of(page))["log10 of density"]["layers"]
    ends = [(float(r["value"]) - 2 * float(r["standard_error"]), float(r["value"]) + 2 * float(r["standard_error"])) for r in own]
    check("random: the band is two errors wide", len(own) == 20 and all(low is None if a <= 0 else abs(10**low - a) < 0.02 * b and abs(10**high - b) < 0.02 * b
          for low, high, (a, b) in zip(band["low"], band["high"], ends)), ends[10])
    check("random: the closed form is beside it", all(abs(10**y - float(r["closed_form"])) < 1e-4 * float(r["closed_form"]) for y, r in zip(form["y"], own)))
    looks(browser, page, "random", ["closed form", "6 realisations over 200", "contactplant random"])


def choose(browser, folder):
    told, page = os.path.join(folder, "choose.json"), os.path.join(folder, "choose.html")
    words = run("choose", "shaft", "--tolerance", "0.05", "--json", told, "--report", page).stdout
    data, c = data_of(page), json.load(open(told))
    wanted = {}
    for candidate in c["candidates"]:
        for m in candidate["methods"]:
            if m["error"] is not None:
                wanted.setdefault(candidate["candidate"], []).append((m["instructions_a_frame"], m["error"]))
    layers = charts(data)["error"]["layers"]
    got = {layer["name"]: list(zip(layer["x"], layer["y"])) for layer in layers if layer["kind"] == "points"}
    check("choose: costs and errors are those of --json", got == wanted and got, {k: len(v) for k, v in got.items()})
    line, marker = layers[-2:]
    check("choose: tolerance and choice are marked", set(line["y"]) == {c["asked"]["tolerance"]} and
          marker["x"] == [c["choice"]["instructions_a_frame"]] and marker["name"] == "chosen")
    text = [s["text"] for s in data["sections"] if s.get("title") == "Certificate"]
    check("choose: the certificate is the one that it prints", text == [words])
    rows = [r["cells"] for s in data["sections"] if s.get("title") == "Candidates" for r in s["rows"]]
    check("choose: each candidate is in the table", [(r[0], r[1]) for r in rows] ==
          [(g["candidate"], m["method"]) for g in c["candidates"] for m in g["methods"] or [{"method": "any"}]], len(rows))
    looks(browser, page, "choose", ["Tolerance and deadline are met", "VOID IF", "tolerance", "contactplant choose shaft"])


def log(browser, folder):
    """A run with its log, and the same log decoded."""
    recording, page, again = (os.path.join(folder, n) for n in ("run.log", "log.html", "decoded.html"))
    out, events = os.path.join(folder, "log.csv"), os.path.join(folder, "log_events.csv")
    scene = ["rig", "--bus"]
    plant = subprocess.Popen([program, "run", *scene, "udp:23210", "--peer", "127.0.0.1:23211", "--lockstep", "--patience", "10",
                              "--duration", "5", "--log", recording, "--report", page], stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True)
    time.sleep(0.3)
    run("control", *scene, "udp:23211", "--peer", "127.0.0.1:23210", "--lockstep", "--duration", "10", "--force", "30",
        "--frequency", "200", status=None)
    told = plant.communicate(timeout=60)[0]
    check("run: it ends well", plant.returncode == 0, told[-200:] if plant.returncode else "")
    run("decode", recording, "rig", "--out", out, "--events", events, "--report", again)
    rows, switches, data = table(out), table(events), data_of(page)
    hash_ = re.search(r"hash ([0-9a-f]{16})", told).group(1)
    cells = [c for s in data["sections"] if s["kind"] == "table" for row in s["rows"] for c in row["cells"]]
    check("run: the hash in it is the one that was printed", hash_ in cells, hash_)
    for which, where in (("run", data), ("decode", data_of(again))):
        for name, column in (("displacement", "displacement [m]"), ("contact_force", "contact_force [N]"),
                             ("samples to force", "command_force [N]")):
            bad = banded(charts(where)[name]["layers"][0], rows, "t_s", column)
            check(f"{which}: the band of {name} has the numbers of the CSV", bad == 0, f"{bad} of {len(rows)} rows are not")
        speeds = [abs(float(s["speed [m/s]"])) for s in switches if s["kind"] == "touchdown"]
        layer = charts(where)["impact speed"]["layers"][0]
        own = layer.get("y") or layer["high"]
        check(f"{which}: impact speeds are those of the CSV", close(max(own), max(speeds)) and
              (len(own) < len(speeds) or all(close(a, b) for a, b in zip(own, speeds))),
              f"{len(speeds)} touchdowns, up to {max(speeds)} m/s")
    looks(browser, page, "run", ["contactplant run rig", "frames_received", hash_])
    looks(browser, again, "decode", ["contactplant decode", "touchdowns"])


def begin_demo(folder):
    """Ten seconds by the clock, while the other tests run."""
    return subprocess.Popen([program, "demo", "--out", folder, "--report", os.path.join(folder, "demo.html")],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def demo(browser, folder, child):
    told, page = child.communicate()[0], os.path.join(folder, "demo.html")
    busy = "by a busy machine" in told  # its files are written then, too
    check("demo: it ends well, or tells that the machine is too busy for it", child.returncode == 0 or busy, told[-150:] if busy else "")
    rows, shown = table(os.path.join(folder, "demo.csv")), charts(data_of(page))
    band, line = shown["displacement"]["layers"][0], shown["slow force drive, amplitude"]["layers"][0]
    bad = sum(not close(low, number(r["displacement_min_m"]), 7) or not close(high, number(r["displacement_max_m"]), 7) or
              abs(y - number(r["slow_drive_amplitude_N"])) > 5.1e-6
              for low, high, y, r in zip(band["low"], band["high"], line["y"], rows))
    check("demo: band and line have the numbers of the CSV, in its digits", bad == 0 and len(band["low"]) == len(rows),
          f"{bad} of {len(rows)} rows are not")
    looks(browser, page, "demo", ["contactplant demo", "preload"])


LOST = """[plant]
scene = rig
[controller]
command = {contactplant} control rig --lockstep --bus udp:{me} --peer {plant} --force 30 --frequency 200 --duration 3
[case all of it]
over = 2 s
expect      contact_loss == 0 %
expect      peak_force <= 1 kN
[case at a time]
over = 2 s
expect      penetration.max <= 20 um
[case good]
over = 0.5 s
expect      peak_force <= 1 kN
"""


def trial(browser, folder):
    """Verdicts against --json, and the charts around failures against the decoded logs."""
    file, page, told = (os.path.join(folder, n) for n in ("lost.test", "test.html", "test.json"))
    with open(file, "w") as f:
        f.write(LOST)
    run("test", file, "--log", folder, "--json", told, "--report", page, status=1)
    data, judged = data_of(page), json.load(open(told))["cases"]
    tables = {s["title"]: s["rows"] for s in data["sections"] if s["kind"] == "table"}
    check("test: verdicts and hashes are those of --json", [(c["case"], c["verdict"], c["hash"]) for c in judged] ==
          [(r["cells"][0], r["cells"][1], r["cells"][5]) for r in tables["Verdicts"]], [c["verdict"] for c in judged])
    same = all([(e["expect"], e["verdict"], e["found"]) for e in c["expects"]] ==
               [(r["cells"][1], r["cells"][2], r["cells"][3]) for r in tables[c["case"] + ": " + c["verdict"]]] for c in judged)
    check("test: expectations are those of --json", same)
    shown = [s for s in data["sections"] if s["kind"] == "chart" and s["title"] == "penetration"]
    failed_at = [next(e["at_s"] for e in c["expects"] if e["verdict"] == "FAIL") for c in judged if c["verdict"] == "FAIL"]
    check("test: each failed case has charts, marked where it failed", [c["layers"][-1]["x"][0] for c in shown] == failed_at,
          failed_at)
    for chart, c in zip(shown, judged):
        out = os.path.join(folder, "part.csv")
        run("decode", c["log"], "rig", "--out", out)
        t0, t1 = chart["layers"][0]["x"][0], chart["layers"][0]["end"][0]
        rows = [r for r in table(out) if t0 - 1e-9 <= float(r["t_s"]) <= t1 + 1e-9]
        bad = banded(chart["layers"][0], rows, "t_s", "penetration [m]")
        check(f"test: the chart of {c['case']} has the numbers of its log", bad == 0, f"{len(rows)} rows from {t0} to {t1} s")
    looks(browser, page, "test", ["Verdicts", "contact_loss == 0 %", "failed at"])


def runaway(browser, folder):
    """A drive beyond the bus's range: what the report says against the rows, the events and the metric."""
    test, page, again = (os.path.join(folder, n) for n in ("away.test", "away.html", "away_log.html"))
    with open(test, "w") as file:
        file.write(f"""[plant]
scene = rig
[controller]
command = /usr/bin/python3 {here}/../trial/controller.py {{plant}} {{me}} idle
[case away]
over = 2 s
at 1 s    arm force amplitude=3000 N frequency=60 Hz ramp=0.2 s
expect    peak_force <= 1 N
""")
    told = run("test", test, "--log", folder, "--report", page, status=1).stdout
    words = [s["text"] for s in data_of(page)["sections"] if s["kind"] == "words"]
    peak = float(re.search(r"peak_force <= 1 N: it was (\S+) N", told).group(1))
    own = [float(m.group(1)) * 1e3 for m in (re.search(r"Largest force of the run, by the plant itself: (\S+) kN", w) for w in words) if m]
    check("away: the report has the plant's own peak", len(own) == 1 and abs(own[0] - peak) <= 1e-3 * peak, (own, peak))
    out, events, log = (os.path.join(folder, n) for n in ("away.csv", "away_events.csv", "away.away.log"))
    run("decode", log, "rig", "--out", out, "--events", events, "--report", again, "--svg", os.path.join(folder, "away.svg"))
    rows, data = table(out), data_of(again)
    words = [s["text"] for s in data["sections"] if s["kind"] == "words"]
    peaks = [e["peak_force [N]"] for e in table(events) if e["kind"] == "liftoff"]
    wanted = f"The largest force was at least 4194 N: {peaks.count('')} of {len(peaks)} peaks were beyond the bus's range."
    check("away: peaks beyond the range are counted", wanted in words and 0 < peaks.count("") < len(peaks), wanted)
    empty = sum(not r["displacement [m]"] and r["in_contact"] != "" for r in rows)
    wanted = f"{empty} of {len(rows)} rows have no displacement: it was beyond the bus's range of 419 µm."
    check("away: rows beyond the range are counted", wanted in words and empty > 100, wanted)
    spans = [layer["ends"] for layer in charts(data)["displacement"]["layers"] if layer["kind"] == "span"]
    marked = [any(a <= float(r["t_s"]) <= b for a, b in spans) for r in rows]
    check("away: what has no displacement is marked", all(m or r["displacement [m]"] or not r["in_contact"] for m, r in zip(marked, rows)) and not all(marked), len(spans))
    check("away: the headline says that nothing else went wrong", any("nothing was refused" in w for w in words), words[0])
    looks(browser, again, "away", ["beyond the bus's range", "beyond the range"])


def refused(folder):
    out, scene = os.path.join(folder, "x.csv"), os.path.join(folder, "x.ini")
    with open(scene, "w") as file:
        file.write(run("scene", "rig").stdout)
    for words, why in ((("simulate", "--out", out, "--report", out), "choose two files"),
                       (("simulate", scene, "--report", scene), "is the scene itself"),
                       (("sweep", "rig", "--report", out), "give --out"),
                       (("sweep", "rig", "--out", out, "--report", out), "choose two files"),
                       (("basin", "rig", "--report", out), "give --out"),
                       (("basin", "rig", "--out", out, "--report", out), "choose two files"),
                       (("choose", "rig", "--json", out, "--report", out), "choose two files"),
                       (("choose", scene, "--report", scene), "is the scene itself")):
        done = run(*words, status=2)
        check("refused: " + why, why in done.stderr and done.stderr.count("\n") == 1, done.stderr.strip()[:90])
    for words in (("simulate", "--until", "1", "--report", "/dev/full"),
                  ("basin", "shaft-fig16-705", "--starts", "50", "--out", out, "--report", "/dev/full")):
        done = run(*words, status=1)
        check("a full disk is told: " + words[0], "report" in done.stderr, done.stderr.strip()[-90:])


with tempfile.TemporaryDirectory() as folder, Chromium() as browser:
    child = begin_demo(folder)
    simulate(browser, folder)
    sweep(browser, folder)
    basin(browser, folder)
    stability(browser, folder)
    random(browser, folder)
    choose(browser, folder)
    log(browser, folder)
    trial(browser, folder)
    runaway(browser, folder)
    demo(browser, folder, child)
    refused(folder)
conclude()
