#!/usr/bin/python3
"""The page of recorded logs in Chromium: a log whose every number is chosen (planted_log.py), then one of a run.

    test_view_page.py PROGRAM [FOLDER]     pictures of what was seen go into FOLDER
"""
import os
import sys
import tempfile

from access import access
from chromium import Chromium
import planted_log
from view_client import Viewer

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from processes import end_all  # noqa: E402
from verdicts import check, conclude  # noqa: E402

program = os.path.abspath(sys.argv[1])
pictures = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else None
ROWS, HOLE, BEYOND = 60000, (30000, 36000), (6000, 9000)
# Pixels of a column of a panel that have this colour, between its top and bottom.
INK = """((key, t, name) => {
  const panel = scope.look().panels.find((p) => p.key === key), {canvas, chart} = panel, ratio = canvas.width / canvas.clientWidth;
  const ink = getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
  const wanted = [1, 3, 5].map((i) => parseInt(ink.slice(i, i + 2), 16)), copy = new OffscreenCanvas(1, canvas.height);
  const c = copy.getContext('2d', {willReadFrequently: true});
  c.drawImage(canvas, -Math.floor(chart.px(t) * ratio), 0);
  const data = c.getImageData(0, 0, 1, canvas.height).data, rows = [];
  for (let y = Math.ceil(chart.top) + 1; y < chart.bottom - 1; y++)
    if (wanted.every((v, i) => Math.abs(v - data[4 * y + i]) <= 24)) rows.push(y);
  return rows;
})"""


def look(tab, name):
    if pictures:
        os.makedirs(pictures, exist_ok=True)
        tab.picture(os.path.join(pictures, name + ".png"))


def ink(tab, key, t, name="blue"):
    return tab.run(f"{INK}({key!r}, {t}, {name!r})")


def settle(tab):
    """Until the range that is in view is there, and drawn."""
    tab.wait("(({view, shown}) => shown.range && Math.abs(shown.range.from - view.from) < 1e-9 && Math.abs(shown.range.to - view.to) < 1e-9)(scope.look())")
    tab.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done))))")


def view(tab):
    return tab.run("(({view}) => [view.from, view.to, view.cursor])(scope.look())")


def show(tab, a, b):
    """By dragging over the time."""
    place = tab.run("(({panels: [, p]}) => { const box = p.canvas.getBoundingClientRect(); "
                    f"return [box.left + p.chart.px({a}), box.left + p.chart.px({b}), box.top + 40]; }})(scope.look())")
    for kind, x in (("mousePressed", place[0]), ("mouseMoved", (place[0] + place[1]) / 2), ("mouseMoved", place[1]), ("mouseReleased", place[1])):
        tab.call("Input.dispatchMouseEvent", type=kind, x=x, y=place[2], button="left", buttons=1, clickCount=1)
    settle(tab)


def words(tab, name):
    return tab.run(f"document.getElementById('{name}').textContent")


def bands(tab):
    """The pixels of a band against the numbers that were written."""
    low, high = (tab.run(f"scope.look().shown.range.bands['0'][{i}][100]") for i in (0, 1))
    numbers = [planted_log.motion_of(n)[0] for n in range(planted_log.PHASES)]
    lsb = high / max(numbers)
    check("the band is what was written", abs(low / lsb - min(numbers)) < 1e-6 and abs(lsb / 5e-11 - 1) < 1e-6, (low, high, lsb))
    top, bottom = (tab.run(f"scope.look().panels.find((p) => p.key === '0').chart.py({v!r})") for v in (high, low))
    rows = ink(tab, "0", 15.0)
    check("its edges are in their pixels", rows and abs(min(rows) - top) <= 1 and abs(max(rows) - bottom) <= 1, (rows[:1], rows[-1:], top, bottom))
    check("nothing is drawn where frames are missing", [ink(tab, "0", t) for t in (31.0, 33.0, 35.0)] == [[], [], []])
    check("nor beyond the range", ink(tab, "0", 7.0) == [] and ink(tab, "1", 7.0, "green") != [])
    check("and both are said", "beyond" in words_of(tab, "0") or tab.run("scope.look().shown.range.beyond.some((b) => b)"))


def words_of(tab, key):
    return tab.run(f"scope.look().panels.find((p) => p.key === {key!r}).canvas.ariaLabel")


def hands(tab):
    show(tab, 29.0, 37.0)
    a, b, _ = view(tab)
    check("dragging shows that time", abs(a - 29.0) < 0.15 and abs(b - 37.0) < 0.15, (a, b))
    tab.key("Backspace")
    settle(tab)
    check("backspace: the view before", view(tab)[:2] == [0, (ROWS - 1) / 1000], view(tab))
    tab.key("Escape")
    tab.key("N")
    tab.wait("scope.look().view.cursor > 0")
    check("N goes to the hole", abs(view(tab)[2] - HOLE[1] / 1000) < 1e-9, view(tab))
    for _ in range(12):
        tab.key("+")
    settle(tab)
    a, b, at = view(tab)
    check("plus zooms in around the cursor", a < at < b and b - a < 0.02, (a, b, at))
    check("the view has its rows", tab.run("scope.look().shown.range.size") == 1 and tab.run("scope.look().shown.range.row.length") > 3)
    tab.key("ArrowLeft")
    settle(tab)
    check("left: earlier", view(tab)[0] < a, view(tab))
    tab.key("m")
    tab.key(">")
    tab.key("m")
    settle(tab)
    check("marks and their distance", "later" in words(tab, "table-marks"), words(tab, "table-marks"))
    tab.key("0")
    settle(tab)
    check("0: the whole run", view(tab)[:2] == [0, (ROWS - 1) / 1000], view(tab))
    tab.key("?")
    check("? shows the keys", not tab.run("document.getElementById('keys').hidden"))
    tab.key("Escape")
    check("esc closes their list", tab.run("document.getElementById('keys').hidden"))


def cursor(tab, v):
    """Every value at the cursor, to the last digit."""
    tab.run("document.activeElement.blur()")
    show(tab, 10.0, 10.2)
    for _ in range(3):
        tab.key(".")
    tab.wait("scope.look().shown.row && Math.abs(scope.look().shown.row[0] - scope.look().view.cursor) < 0.0011")
    row, at = tab.run("scope.look().shown.row"), view(tab)[2]
    check("the row at the cursor", row == v.row(at), (row, v.row(at)))
    micro = f"{row[6] * 1e6:.9g} µm"
    check("its values are told to the last digit", micro in words(tab, "table-row"), (micro, words(tab, "table-row")))
    check("to screen readers, too", "at the cursor" in words_of(tab, "0") and micro in words_of(tab, "0"), words_of(tab, "0"))


def focus(tab):
    tab.run("document.activeElement.blur()")
    seen = []
    for _ in range(12):
        tab.key("Tab")
        seen.append(tab.run("[document.activeElement.id, getComputedStyle(document.activeElement).outlineStyle]"))
    wanted = {"whole", "back", "out", "in", "earlier", "later", "previous", "next", "theme", "help"}
    check("the tab key reaches each control, and one sees where", wanted <= {s[0] for s in seen if s[1] == "solid"}, seen)
    tab.run("document.activeElement.blur()")


def real(browser):
    planted_log.record(program)
    with Viewer(program, "--open", "t.a.log") as v:
        tab = browser.open(v.url)
        tab.wait("window.scope && scope.look().shown.asks > 0")
        settle(tab)
        look(tab, "view_run")
        found, at = [], -1.0
        tab.key("Escape")
        for _ in range(5):
            tab.key("n")
            tab.wait(f"scope.look().view.cursor > {at!r}")
            at = view(tab)[2]
            found.append(at)
        wanted, at = [], 0.0
        for _ in range(5):
            at = v.next(at, kinds=15)["t"]
            wanted.append(at)
        check("n goes from one contact change to the next", found == wanted, (found, wanted))
        check("and says what it is", "contact 0" in words(tab, "news"), words(tab, "news"))
        tab.key("p")
        tab.wait(f"scope.look().view.cursor < {at!r}")
        check("p goes back", view(tab)[2] == wanted[-2])
        for _ in range(7):
            tab.key("+")
        settle(tab)
        lift = next(m for m in v.range(*view(tab)[:2])["marks"] if m["kind"] == "liftoff")
        check("contact is open from the located event on", tab.run(f"scope.look().panels[0].chart.px({lift['t']!r})") > 0 and
              ink(tab, "lanes", lift["t"] + 2e-4, "orange") != [] and ink(tab, "lanes", lift["t"] - 2e-4, "orange") == [])
        look(tab, "view_close")
        check("no complaint in the console", not tab.errors, tab.errors or "")
        tab.close()


def two(browser):
    """A second log that differs in one row, and a log that grows."""
    planted_log.write("a.log", 3000)
    planted_log.write("b.log", 3000, beyond=[(2000, 2001)])
    with Viewer(program, "--open", "a.log", "--open", "b.log") as v:
        tab = browser.open(v.url)
        tab.wait("window.scope && scope.look().shown.asks > 0")
        settle(tab)
        check("where two logs part is said", "part at 2 s" in words(tab, "news"), words(tab, "news"))
        tab.key("d")
        tab.wait("scope.look().view.cursor === 2")
        settle(tab)
        check("d goes there", ink(tab, "0", 1.999, "red") != [] and ink(tab, "apart 0", 2.001, "purple") != [], view(tab))
        check("and the difference is told", "0 m to 0 m" in words_of(tab, "apart 0"), words_of(tab, "apart 0"))
        look(tab, "view_two")
        check("no complaint in the console", not tab.errors, tab.errors or "")
        tab.close()
    with open("a.log") as f:
        lines = f.readlines()
    with open("g.log", "w") as f:
        f.writelines(lines[:3000])
    with Viewer(program, "--open", "g.log", "--follow") as v:
        tab = browser.open(v.url)
        tab.wait("window.scope && scope.look().shown.asks > 0")
        with open("g.log", "a") as f:
            f.writelines(lines[3000:])
        tab.wait("scope.look().view.to > 2.99")
        settle(tab)
        check("a log that grows is followed", ink(tab, "0", 2.5) != [], view(tab))
        os.replace("b.log", "g.log")
        tab.wait("document.getElementById('alarm').textContent.includes('replaced')")
        check("a file that was replaced is told", True)
        tab.close()


folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)
try:
    planted_log.write("p.log", ROWS, [HOLE], [BEYOND])
    with Viewer(program, "--open", "p.log") as v, Chromium() as browser:
        tab = browser.open(v.url, 1280, 900)
        tab.wait("window.scope && scope.look().shown.asks > 0")
        settle(tab)
        look(tab, "view_light")
        bands(tab)
        hands(tab)
        access(tab, "light")
        cursor(tab, v)
        focus(tab)
        tab.dark(True)
        settle(tab)
        access(tab, "dark")
        look(tab, "view_dark")
        for keys in (False, True):
            tab.size(390, 844)
            settle(tab)
            wide = tab.run("document.documentElement.scrollWidth")
            check("fits 390 px" + (" with its keys" if keys else ""), wide <= 390, f"{wide} px")
            apart = tab.run("[...document.querySelectorAll('#keys kbd')].every((k) => k.getBoundingClientRect().right <= "
                            "k.parentElement.nextElementSibling.getBoundingClientRect().left)")
            check("  no key stands over its words", apart or not keys)
            look(tab, "view_390")
            tab.key("?")
        check("no complaint in the console", not tab.errors, tab.errors or "")
        tab.close()
        real(browser)
        two(browser)
finally:
    end_all()
conclude()
