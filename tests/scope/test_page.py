#!/usr/bin/python3
"""The scope's page in Chromium: against a plant whose numbers are known in closed form (planted.py), then a real one.

    test_page.py PROGRAM [FOLDER]     pictures of what was seen go into FOLDER
"""
import json
import os
import re
import subprocess
import sys
import time

from access import access
from chromium import Chromium
from planted import AMPLITUDE_M, HZ, LIFTS, MEAN_M, Planted

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import check, conclude  # noqa: E402

program = sys.argv[1]
pictures = sys.argv[2] if len(sys.argv) > 2 else None


def look(tab, name):
    if pictures:
        os.makedirs(pictures, exist_ok=True)
        tab.picture(os.path.join(pictures, name + ".png"))


# Reads pixels of a panel back: the rows of column `x` (in px of the page) that are not empty.
PIXELS = """((panel, x) => {
  const canvas = document.querySelectorAll('#panels canvas')[panel], ratio = canvas.width / canvas.clientWidth;
  const copy = new OffscreenCanvas(1, canvas.height), c = copy.getContext('2d', {willReadFrequently: true}), rows = [];
  c.drawImage(canvas, -Math.floor(x * ratio), 0);
  const data = c.getImageData(0, 0, 1, canvas.height).data;
  for (let y = 0; y < canvas.height; y++) rows.push([data[4 * y], data[4 * y + 1], data[4 * y + 2]]);
  return rows;
})"""


def column(tab, panel, x):
    return tab.run(f"{PIXELS}({panel},{x})")


def colour(tab, name):
    text = tab.run(f"getComputedStyle(document.documentElement).getPropertyValue('--{name}').trim()")
    return [int(text[i:i + 2], 16) for i in (1, 3, 5)]


def near(a, b, by=24):
    return max(abs(p - q) for p, q in zip(a, b)) <= by


def settle(tab):
    """Two pictures more."""
    tab.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done))))")


def plot_of(tab, panel):
    return tab.run("(({left, top, bottom, x0, x1}, columns) => ({left, top, bottom, x0, x1, columns}))"
                   f"(scope.look().panels[{panel}].chart, scope.look().panels[{panel}].chart.columns())")


def panel_of(tab, key):
    return tab.run("scope.look().panels.map((l) => l.key)").index(key)


OFFERED = "window.offered = 0, (function frame() { offered++, requestAnimationFrame(frame); })()"


def counts(tab):
    return tab.run("(({shown, counted: c}) => ({rows: shown.received, pictures: c.pictures, frames: offered, "
                   "now: performance.now() / 1000}))(scope.look())")


def rates(before, now):
    """From the moment when a plant is shown: until then the browser offers pictures of nothing."""
    check("rows drawn of 10,000, twice as fast as they come", now["rows"] >= 9900, now["rows"])
    seconds = now["now"] - before["now"]
    frames, pictures = now["frames"] - before["frames"], now["pictures"] - before["pictures"]
    check("a picture for nine in ten that the browser offers, and 30 a second where it offers them",
          frames > 0 and pictures + 1 >= 0.9 * frames and (pictures + 1) / seconds >= min(30, 0.9 * frames / seconds),
          f"{pictures / seconds:.1f}/s of {frames / seconds:.1f}/s offered")  # one may be under way


def flat_envelope(tab):
    """Every pixel column of the bands has the same edges: 225 Hz at 1 kHz has no beats."""
    for span, key in ((10, "5"), (2, "4"), (0.5, "3")):
        tab.key(key)
        settle(tab)
        for panel, (name, low, high) in enumerate((("displacement", MEAN_M - AMPLITUDE_M, MEAN_M + AMPLITUDE_M),
                                                  ("velocity", -AMPLITUDE_M * 2 * 3.141592653589793 * HZ,
                                                   AMPLITUDE_M * 2 * 3.141592653589793 * HZ))):
            plot = plot_of(tab, panel)
            y = [tab.run(f"scope.look().panels[{panel}].chart.py({v})") for v in (low, high)]
            marker = tab.run(f"scope.pixelOf({LIFTS[0][0]!r}, {panel})")
            # the line at the burst's trigger and its name lie over some columns
            places = [x for x in range(plot["left"] + 4, plot["left"] + plot["columns"] - 4, 7) if not -2 < x - marker < 50]
            ink, edges = colour_of[panel], []
            for rows in tab.run(f"{json.dumps(places)}.map((x) => {PIXELS}({panel}, x).map((c) => "
                                f"Math.max(...c.map((v, i) => Math.abs(v - {ink}[i]))) <= 24))"):
                seen = [k for k, near_ink in enumerate(rows) if near_ink and plot["top"] < k < plot["bottom"]]
                edges.append((min(seen), max(seen)) if seen else (-99, -99))
            worst = max(max(abs(top - y[1]), abs(bottom - y[0])) for top, bottom in edges)
            check(f"envelope of {name} over {span} s is flat to 1 px and in its place", worst <= 1.0,
                  f"{worst:.2f} px in {len(edges)} columns, "
                  f"spread {max(e[0] for e in edges) - min(e[0] for e in edges)} px")


def planted_lift_off(tab):
    """The first lift-off of the story, in three windows: its pixel, and where the strip changes its colour."""
    panel = panel_of(tab, "contact")
    for zooms in range(3):
        for key in "g" + zooms * "+":
            tab.key(key)  # g puts the cursor on the trigger, and zooming keeps it in its place
        tab.key("Escape")
        settle(tab)
        plot = plot_of(tab, panel)
        lift, touch = LIFTS[0]
        if not plot["x0"] < lift < plot["x1"]:
            check("the trigger stays in view", False, plot)
            return
        width = tab.run(f"document.querySelectorAll('#panels canvas')[{panel}].clientWidth") - plot["left"] - 10
        exact = plot["left"] + (lift - plot["x0"]) / (plot["x1"] - plot["x0"]) * width
        told = tab.run(f"scope.pixelOf({lift!r}, {panel})")
        y = int(plot["top"]) + 6
        row = [column(tab, panel, x)[y] for x in range(int(exact) - 6, int(exact) + 7)]
        first = next((int(exact) - 6 + i for i, c in enumerate(row) if near(c, colour_of["orange"])), None)
        # the colour of a column counts from its left edge on
        check(f"a planted lift-off is drawn within 1 px of its time ({1e3 * (plot['x1'] - plot['x0']):.3g} ms window)",
              abs(told - exact) < 0.01 and first is not None and abs(first - exact) <= 1.0,
              f"at {first} px, its time at {exact:.2f} px")


def keyboard(tab):
    tab.key("End")
    settle(tab)
    tab.key(" ")
    before = plot_of(tab, 0)["x1"]
    time.sleep(0.3)
    check("space pauses", plot_of(tab, 0)["x1"] == before and tab.run("document.getElementById('pause').getAttribute('aria-pressed')") == "true")
    span = tab.run("scope.look().view.span")
    tab.key("+")
    check("plus zooms in", tab.run("scope.look().view.span") == span / 2)
    tab.key("-")
    check("minus zooms out", tab.run("scope.look().view.span") == span)
    tab.key("5")
    check("5 is the window of 10 s", tab.run("scope.look().view.span") == 10)
    tab.key(".")
    first = tab.run("scope.look().view.cursor")
    tab.key(">")
    check("the cursor moves by keys", tab.run("scope.look().view.cursor") > first)
    tab.wait(f"document.querySelector('#panels canvas').getAttribute('aria-label').includes('at ')")
    label = tab.run("document.querySelector('#panels canvas').getAttribute('aria-label')")
    check("its values are told in words", "µm" in label, label)
    tab.key("b")
    check("b goes to the burst", tab.run("document.activeElement.id") == "burst")
    tab.key("+")
    check("and zooms there", tab.run("scope.look().view.to - scope.look().view.from") < 0.0079 and
          tab.run("scope.look().view.span") == 10, tab.run("scope.look().view.to - scope.look().view.from"))
    tab.key("b")
    tab.key("Escape")
    tab.key(" ")
    check("space goes on", tab.run("scope.look().view.end") is None)
    tab.key("?")
    check("? shows the keys", not tab.run("document.getElementById('keys').hidden"))
    tab.key("Escape")
    check("esc closes their list", tab.run("document.getElementById('keys').hidden"))
    tab.key("n")
    check("n shows the other plant", tab.run("document.getElementById('plant').value") == "1")
    tab.key("n")


def focus(tab):
    """Every control is reached by the tab key, and one sees where it is."""
    tab.run("document.activeElement.blur()")
    seen = []
    for _ in range(12):
        tab.key("Tab")
        seen.append(tab.run("[document.activeElement.id, getComputedStyle(document.activeElement).outlineStyle]"))
    wanted = {"plant", "window", "pause", "theme", "help", "trigger", "take", "burst"}
    check("the tab key reaches each control", wanted <= {s[0] for s in seen}, sorted({s[0] for s in seen}))
    check("focus is seen", all(s[1] == "solid" for s in seen if s[0] in wanted))
    tab.run("document.activeElement.blur()")


def fits(tab, width, height):
    tab.size(width, height)
    settle(tab)
    wide = tab.run("document.documentElement.scrollWidth")
    check(f"fits {width} px", wide <= width, f"{wide} px")
    look(tab, f"page_{width}")


def many(browser, url):
    tabs = [browser.open(url, fresh_window=True) for _ in range(5)]
    time.sleep(1.0)
    for tab in tabs:
        tab.wait("(scope.look().shown?.received || 0) > 500")
    check("five tabs at once", all(t.run("(scope.look().shown?.received || 0)") > 500 for t in tabs) and not any(t.errors for t in tabs))
    for tab in tabs:
        tab.close()


def versions(browser):
    with Planted(100, contract=99) as url:
        tab = browser.open(url)
        tab.wait("!document.getElementById('alarm').hidden")
        check("a page of another version says so", "reload" in tab.run("document.getElementById('alarm').textContent"))
        tab.close()
    with Planted(400, speed=4) as url:
        tab = browser.open(url)
        tab.wait("(scope.look().shown?.received || 0) >= 300")
    tab.wait("!document.getElementById('alarm').hidden")
    check("a lost connection is said", "lost" in tab.run("document.getElementById('alarm').textContent"))
    rows = tab.run("(scope.look().shown?.received || 0)")
    with Planted(1000, speed=4, port=int(url.split(":")[2].strip("/"))):
        tab.wait("document.getElementById('alarm').hidden && (scope.look().shown?.received || 0) > %d" % rows)
        check("and it connects again by itself", True)
    tab.close()


def triggers(browser):
    """Three bursts: at a lift-off, at a touchdown, by a command with twice the force; which of them each trigger shows."""
    with Planted(3800, speed=8, more=True) as url:
        for mode, value, take, shown in (("each", 0, 0, 3), ("lift-off", 0, 0, 1), ("touchdown", 0, 0, 2), ("level", 100, 0, 3),
                                         ("level", 1000, 0, None), ("hand", 0, 0, None), ("hand", 0, 1, 1)):
            tab = browser.open(url, first=f"""addEventListener('DOMContentLoaded', () => {{
                find('trigger').value = '{mode}', find('level').value = {value};
                const timer = {take} && setInterval(() => scope.look().shown && (clearInterval(timer), find('take').click()), 1); }})""")
            tab.wait("scope.look().shown?.bursts.length === 3")  # they come behind the rows
            check(f"burst trigger {mode} {value or ''}{', taken' if take else ''}: shows number {shown}",
                  tab.run("scope.look().shown.burst?.number ?? null") == shown)
            if mode == "hand" and not take:
                tab.wait("document.getElementById('burst-text').textContent.startsWith('3 kept')")
                tab.key("]")
                check("and keys show it nevertheless", tab.run("scope.look().shown.burst?.number") == 1)
            if value == 100:
                look(tab, "page_level")
            tab.close()


def commands(browser):
    """The command line: only with --control and the token, with the words of send."""
    plant = subprocess.Popen([program, "run", "--scope", "--control", "--http", "127.0.0.1:18098", "--bus", "udp:23330", "--peer",
                              "127.0.0.1:23333", "--setting", "timeout_frames=10000", "--setting", "age_limit_frames=10000"],
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    url = re.search(r"open (http://\S+);", plant.stdout.readline() + plant.stdout.readline()).group(1)
    tab = browser.open(url.split("#")[0])
    tab.wait("scope.look().shown")
    check("control: no command line without the token", tab.run("document.getElementById('command') === null") and
          "only listens" in tab.run("document.body.innerText"))
    tab.close()
    tab = browser.open(url)
    tab.wait("document.getElementById('command') !== null")

    def say(words):
        tab.run("document.getElementById('command').value = '', document.getElementById('command').focus()")
        tab.call("Input.insertText", text=words)
        tab.key("Enter")
    say("start + arm force amplitude=5 frequency=225 + fire --hold 60")
    tab.wait("scope.look().shown.drives.force?.last(1) === 5")
    check("control: a command line drives the plant", "FIRE: ok" in tab.run("document.querySelector('#side pre').textContent"))
    say("step 0")
    tab.wait("document.querySelector('#side pre').className === 'bad'")
    told = tab.run("document.querySelector('#side pre').textContent")
    check("control: a refusal is shown", "step 0: give a number of frames" in told and "exit 2" in told, " ".join(told.split())[:120])
    tab.key("Escape")
    tab.key("c")
    tab.wait("scope.look().shown.burst && Object.values(scope.look().shown.burst.value).every((y) => y.every(Number.isFinite))")
    tab.wait("scope.look().shown.burst.trigger_t")
    tab.wait("document.getElementById('said').textContent.includes('CAPTURE')")
    words = tab.run("document.getElementById('said').innerText")
    check("control: what is not available is not said", "65535" not in words and "REPLY message CAPTURE, cause ok" in words, " ".join(words.split())[:160])
    check("control: c takes a burst", tab.run("scope.look().shown.burst.number") == 1)
    access(tab, "with commands")
    fits(tab, 390, 844)
    tab.size(1280, 800)
    settle(tab)
    look(tab, "page_control")
    say("stop")
    tab.wait("scope.look().shown.status.state === 'stopped'")
    check("control: no complaint in the console", not tab.errors, tab.errors or "")
    tab.close()
    plant.terminate()
    plant.communicate()


def real(browser):
    """The program's own server and page: all rows of 3 s in lockstep at the speed of the clock, and a burst."""
    plant = subprocess.Popen([program, "run", "rig", "--scope", "--http", "127.0.0.1:18099", "--bus", "udp:23310", "--peer",
                              "127.0.0.1:23311", "--peer", "127.0.0.1:23312", "--wait", "127.0.0.1:23311", "--lockstep", "--speed",
                              "1"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    url = re.search(r"http://\S+", plant.stdout.readline()).group(0)
    tab = browser.open(url)
    tab.wait("scope.look().plants.size === 1")
    done = subprocess.run([program, "control", "rig", "--lockstep", "--bus", "udp:23311", "--peer", "127.0.0.1:23310",
                           "--duration", "3", "--force", "30", "--frequency", "200"], capture_output=True, text=True)
    check("real: the controller ends well", done.returncode == 0, done.stderr.strip()[-150:])
    tab.wait("scope.look().shown.status?.state === 'stopped'")
    plant.terminate()
    told = plant.communicate()[0]
    ran = round(float(re.search(r"plant time ([\d.]+) s", told).group(1)) * 1000)
    switches = int(re.search(r"switches +(\d+) ", told).group(1))
    got = tab.run("(({shown: p}) => ({rows: p.received, events: p.events.n, faults: p.status.fault_names, "
                  "loss: p.summary.last(2), drive: p.drives.force.last(1), streamed: Array.from(p.rows.column[6]).some((v) => v > 1)}))"
                  "(scope.look())")
    check("real: every row and every switch is on the page", abs(got["rows"] - ran) <= 1 and got["events"] == switches,
          f"{got['rows']} rows of {ran} frames, {got['events']} of {switches} switches")
    check("real: loss, drive and samples are shown", got["loss"] > 0.1 and got["streamed"], got)
    check("real: no complaint in the console", not [e for e in tab.errors if "ERR_CON" not in e and "ERR_INC" not in e
                                                    and "ERR_EMPTY" not in e], tab.errors or "")
    look(tab, "page_real")
    tab.close()


with Planted(10000, speed=2) as url, Chromium() as browser:
    size = sum(len(open(os.path.join(os.path.dirname(__file__), "../../host_sim/report/page", n), "rb").read())
               for n in ("scope.html", "scope.css", "scope.js", "draw.js", "keys.js"))
    check("the page has 60 KiB at most", size <= 61440, size)
    tab = browser.open(url)
    tab.wait("scope.look().shown !== null && scope.look().shown !== undefined", 30)
    tab.run(OFFERED)
    shown = counts(tab)
    tab.wait("scope.look().shown.received >= 9900", 30)
    rates(shown, counts(tab))
    check("the window is named", tab.run("document.getElementById('window').selectedOptions[0]?.text") == "10 s")
    colour_of = {0: colour(tab, "blue"), 1: colour(tab, "green"), "orange": colour(tab, "orange")}
    look(tab, "page_light")
    flat_envelope(tab)
    planted_lift_off(tab)
    keyboard(tab)
    tab.key("5")
    access(tab, "light")
    focus(tab)
    tab.dark(True)
    tab.run("dispatchEvent(new Event('resize'))")
    settle(tab)
    access(tab, "dark")
    look(tab, "page_dark")
    tab.dark(False)
    tab.key("?")
    fits(tab, 390, 844)
    tab.key("?")
    fits(tab, 390, 844)
    check("no complaint in the console", not tab.errors, tab.errors or "")
    many(browser, url)
    versions(browser)
    triggers(browser)
    commands(browser)
    real(browser)
conclude()
