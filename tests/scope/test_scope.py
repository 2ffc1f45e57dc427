#!/usr/bin/env python3
"""test_scope.py PROGRAM - contactplant scope and run --scope as a plain client sees them: every row, the numbers of the log,
bad requests, slow and rude browsers, and a plant that never notices. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import csv
import json
import os
import re
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from processes import children, end, end_all, finish, free_ports, start, until  # noqa: E402
from verdicts import conclude, equal, verdict  # noqa: E402

program = sys.argv[1] if len(sys.argv) > 1 else "build/contactplant"
LONG = 60  # s, for what only a broken program takes
ROWS = 10000
PATIENT = ("--setting", "timeout_frames=10000", "--setting", "age_limit_frames=10000")  # a loaded machine is no lost session


def at(offset):
    return "127.0.0.1:%d" % (port + offset)


def plant(first, *arguments):
    peers = [x for i in (1, 2, 3) for x in ("--peer", at(first + i))]
    return start(program, "run", "--bus", "udp:%d" % (port + first), *peers, *arguments)


def control(first, *arguments):
    return start(program, "control", "--bus", "udp:%d" % (port + first + 1), "--peer", at(first), *arguments)


def path(name):
    return os.path.join(directory, name)


def connect(http, room=0):
    """A connection, once somebody listens; with a small receive buffer where it is to be slow."""
    def tried():
        s = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        if room:
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, room)
        s.settimeout(LONG)
        try:
            s.connect(("127.0.0.1", http))
            found.append(s)
        except OSError:
            s.close()
        return bool(found)
    found = []
    if not until(tried):
        sys.exit("FAIL  nobody listens at %d" % http)
    return found[0]


def rest_of(s):
    """Everything until the server hangs up."""
    data = b""
    try:
        while True:
            more = s.recv(65536)
            if not more:
                break
            data += more
    except ConnectionResetError:
        pass
    return data


def ask(http, data, half_close=False):
    s = connect(http)
    try:
        s.sendall(data)
        if half_close:
            s.shutdown(socket.SHUT_WR)
    except (BrokenPipeError, ConnectionResetError):
        pass
    answer = rest_of(s)
    s.close()
    return answer


def request(target="/", host=None, method="GET", more=""):
    host = at(9) if host is None else host
    return ("%s %s HTTP/1.1\r\nHost: %s\r\n%s\r\n" % (method, target, host, more)).encode()


class Browser(threading.Thread):
    """Reads /events and keeps them, by name."""

    def __init__(self, http, room=0, target="/events"):
        super().__init__(daemon=True)
        self.s = connect(http, room)
        self.s.sendall(("GET %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nAccept: text/event-stream\r\n\r\n" % (target, http)).encode())
        self.events = {}
        self.order = []
        self.broken = ""
        self.head = b""
        self.bytes = 0
        self.start()

    def take(self, block):
        lines = block.decode().split("\n")
        if len(lines) != 2 or not lines[0].startswith("event: ") or not lines[1].startswith("data: "):
            self.broken = self.broken or block[:200].decode()
            return
        name = lines[0][7:]
        self.order.append(name)
        self.events.setdefault(name, []).append(json.loads(lines[1][6:], parse_constant=float))

    def run(self):
        data = b""
        try:
            while True:
                more = self.s.recv(1 << 20)
                if not more:
                    break
                self.bytes += len(more)
                data += more
                if not self.head and b"\r\n\r\nretry: 1000\n\n" in data:
                    self.head, data = data.split(b"\r\n\r\nretry: 1000\n\n", 1)
                if self.head:
                    *blocks, data = data.split(b"\n\n")
                    for block in blocks:
                        self.take(block)
        except OSError:
            pass

    def all(self, name, plant=0):
        return [e for e in self.events.get(name, []) if e.get("plant", 0) == plant]

    def list(self, name, key, plant=0):
        return [x for e in self.all(name, plant) for x in e[key]]

    def hello(self, plant=0):
        return self.events["hello"][-1]["plants"][plant]


def http_of(child, err):
    """The port that a program with --http 127.0.0.1:0 has told on its stderr, which is a file."""
    def told():
        with open(err) as f:
            found.extend(re.findall(r"the scope is at http://127\.0\.0\.1:(\d+)/", f.read()))
        return found or child.poll() is not None
    found = []
    until(told)
    return int(found[0])


# ---- a run of ten seconds: every row, the numbers of the log, rude browsers ----

def number(text):
    return None if text in ("", "nan") else float(text)


def compare_rows(browser, name):
    """Rows of the browser and of the log by bus frame, as numbers that are equal."""
    end(start(program, "decode", path(name), "--out", path("rows.csv"), "--events", path("events.csv")))
    with open(path("rows.csv")) as f:
        table = list(csv.DictReader(f))
    logged = {int(r["frame"]): r for r in table}
    columns = browser.hello()["columns"]
    names = list(table[0])
    outputs = [next(n for n in names if n.startswith(c)) for c in columns[3:7]]
    differ = 0
    rows = browser.list("rows", "rows")
    for row in rows:
        r = logged.get(row[0], {})
        wanted = [number(r.get(n, "")) for n in outputs]
        differ += [float("%.6g" % x) if x is not None else None for x in row[3:7]] != \
            [float("%.6g" % x) if x is not None else None for x in wanted] or abs(float(r["t_s"]) - row[1]) > 1e-9
    equal("rows that differ from the log's", differ, 0)
    return rows, logged


def begin_ten_seconds():
    print("--- ten seconds with five browsers, one slow, one torn away: they begin", flush=True)
    p = plant(0, "--scope", "--http", at(9), "--log", path("ten.log"), "--duration", "300", *PATIENT)
    browsers = [Browser(port + 9) for _ in range(5)]
    equal("the stream's status and type", (browsers[0].head or until(lambda: browsers[0].head) and browsers[0].head).split(b"\r\n")[:2],
          [b"HTTP/1.1 200 OK", b"Content-Type: text/event-stream"])
    with open(path("monitor.csv"), "w") as out:
        monitor = subprocess.Popen([program, "monitor", "--bus", "udp:%d" % (port + 2), "--peer", at(0), "--only", "MOTION", "--csv",
                                    "--duration", "6"], stdout=out)
    children.append(monitor)
    c = control(0, "--force", "3", "--frequency", "225", "--duration", "10.5", *PATIENT)
    until(lambda: browsers[0].list("rows", "rows"))
    torn = Browser(port + 9)
    until(lambda: torn.events.get("rows"))
    torn.s.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    torn.s.close()
    slow = connect(port + 9, 4096)
    slow.sendall(request("/events"))
    return p, c, monitor, browsers, slow


def end_ten_seconds(p, c, monitor, browsers, slow):
    print("--- the ten seconds are over", flush=True)
    equal("the controller's status", end(c), 0)
    until(lambda: any(e["dropped"] for e in browsers[0].all("link")), 20)
    late = Browser(port + 9, target="/events?past")
    until(lambda: late.all("link") and late.all("link")[-1]["t"] == browsers[0].all("link")[-1]["t"])
    equal("the plant's status", finish(p), 0)
    for b in [late, *browsers]:
        b.join(LONG)
    first = browsers[0].list("rows", "rows")[0]
    rows = [r for r in browsers[0].list("rows", "rows") if r[1] <= first[1] + 10.0]
    verdict("rows of 10 s: %d of %d" % (len(rows), ROWS), len(rows) >= 0.99 * ROWS)
    monitor.wait(LONG)
    whole = late.list("rows", "rows")
    equal("a late one has the past: its rows are those of the first one, too", whole[whole.index(first):] == browsers[0].list("rows", "rows"), True)
    equal("  in order, and what is no event", (sorted(whole, key=lambda r: r[1]) == whole, late.broken), (True, ""))
    verdict("one slow browser was dropped", browsers[0].all("link")[-1]["dropped"] == 1, browsers[0].all("link")[-1])
    slow.close()
    equal("what is no event", browsers[0].broken, "")
    for i, b in enumerate(browsers[1:]):
        verdict("browser %d has the same rows" % (i + 2), b.list("rows", "rows")[-5000:] == browsers[0].list("rows", "rows")[-5000:])
    equal("the last event", browsers[0].order[-1], "bye")
    rows, logged = compare_rows(browsers[0], "ten.log")
    check_monitor({r[0]: r for r in rows})
    check_events(browsers[0])
    check_slow_news(browsers[0])


def check_monitor(rows):
    """The digits of monitor --csv are those of the rows."""
    same = differ = 0
    with open(path("monitor.csv")) as f:
        lines = f.read().splitlines()[1:]
    for line in lines:
        frame, tick, message, _, field, value, _ = line.split(",")
        row = rows.get(int(frame))
        if row and message == "MOTION" and field in ("DISPLACEMENT", "VELOCITY"):
            good = row[3 + (field == "VELOCITY")] == float(value) and abs(row[1] - int(tick) * 1e-3 / 64) < 1e-12
            same += good
            differ += not good
    verdict("%d numbers as monitor --csv prints them, %d others" % (same, differ), same > 5000 and not differ)


def check_events(browser):
    with open(path("events.csv")) as f:
        logged = list(csv.DictReader(f))
    heard = browser.list("contact", "events")
    names = list(logged[0]) if logged else []
    offset = len(logged) - len(heard)
    differ = sum(abs(float(w[names[0]]) - e[0]) > 1e-9 or abs(float(w[names[3]]) - e[3]) > 1e-6 * abs(e[3])
                 for w, e in zip(logged[offset:], heard)) if offset >= 0 else -1
    verdict("%d contact events, the log's last ones: %d differ" % (len(heard), differ), len(heard) > 100 and differ == 0)


def check_slow_news(browser):
    values = browser.all("values")
    health, drives = {}, {}
    for v in values:
        health.update(v.get("health", {}))
        for name, fields in v.get("drives", {}).items():
            drives.setdefault(name, {}).update(fields)
    verdict("counters and drives by name", health.get("fire_applied", 0) >= 1 and drives["force"]["frequency"] == 225, (health, drives))
    equal("states", [s for i, s in enumerate(states(browser)) if not i or states(browser)[i - 1] != s][-2:], ["running", "stopped"])
    said = browser.list("said", "said")
    verdict("commands and answers", {"FIRE", "REPLY", "CONTROL", "ARM_0"} <= {s[2] for s in said}, {s[2] for s in said})
    lockin = browser.list("lockin", "lockin")
    verdict("lock-in windows", len(lockin) > 50 and browser.all("lockin")[0]["slots"][0]["output"] == "displacement")
    timing = browser.all("timing")[-1]
    verdict("histograms count the frames", sum(timing["compute_us"]) > 9000 and sum(timing["lateness_us"]) > 5000, timing)
    verdict("sampled commands are in the rows", any(r[7] for r in browser.list("rows", "rows")))


def states(browser):
    return [s["state"] for s in browser.all("status")]


# ---- requests ----

def answers(http, name, data, status, *texts, **how):
    answer = ask(http, data, **how)
    lines = answer.split(b"\r\n")
    body = answer.split(b"\r\n\r\n", 1)[-1].decode(errors="replace")
    good = lines[0].startswith(b"HTTP/1.1 %d " % status) and answer.count(b"HTTP/1.1 ") == 1 and b"Connection: close" in lines
    if status >= 400:
        good = good and body.startswith("%d " % status) and body.count("\n") == 1
    verdict("%s: %d" % (name, status), good and all(t in answer.decode(errors="replace") for t in texts), answer[:300])
    return answer


def test_requests(http):
    print("--- requests", flush=True)
    page = answers(http, "the page", request("/"), 200, "text/html", "no-store", "nosniff",
                   "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:")
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    size = 0
    parts = re.findall(r'(?:src|href)="([a-z.]+)"', page.decode())
    verdict("the page has style and script: " + " ".join(parts), {"scope.css", "scope.js"} <= set(parts))
    for name, target in [("scope.html", "/")] + [(part, "/" + part) for part in parts]:
        with open(os.path.join(root, "host_sim/report/page", name), "rb") as f:
            wanted = f.read()
        size += len(wanted)
        got = ask(http, request(target + "?x=1")).split(b"\r\n\r\n", 1)[1]
        verdict("%s is as committed" % name, got == wanted, "%d bytes, wanted %d" % (len(got), len(wanted)))
    verdict("the page has %d bytes of at most 61440" % size, size <= 61440)
    verdict("HEAD has no body", answers(http, "HEAD", request("/", method="HEAD"), 200, "Content-Length: ").endswith(b"\r\n\r\n"))
    verdict("HEAD of the stream ends", answers(http, "HEAD of /events", request("/events", method="HEAD"), 200).endswith(b"\r\n\r\n"))
    for host in ("127.0.0.1", "localhost:%d" % http, "[::1]:1", "LOCALHOST"):
        answers(http, "Host: " + host, request(host=host), 200)
    for host in ("evil.example:%d" % http, "127.0.0.1.evil.example", "192.0.2.1"):
        answers(http, "Host: " + host, request(host=host), 421, "names another machine; open http://127.0.0.1:%d/" % http)
        answers(http, "Host: %s, the stream" % host, request("/events", host=host), 421)
    answers(http, "an unknown path", request("/../etc/passwd"), 404, "there is / and /events")
    for method in ("POST", "PUT", "OPTIONS", "DELETE", "BREW"):
        answers(http, method, request(method=method), 405, "Allow: GET, HEAD", "only GET and HEAD")
    answers(http, "the command line's script", request("/control.js"), 404)
    answers(http, "a command", post("start"), 405, "Allow: GET, HEAD", "looks and never commands")
    answers(http, "10,000 headers", request(more="A: b\r\n" * 10000), 431, "headers")
    answers(http, "a header of 1 MB", request(more="A: " + "b" * 1000000 + "\r\n"), 431)
    answers(http, "a target of 1 MB", request("/" + "a" * 1000000), 414)
    answers(http, "no Host", b"GET / HTTP/1.1\r\n\r\n", 400, "Host is missing")
    answers(http, "HTTP/2", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505)
    answers(http, "TLS", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 400)
    answers(http, "lines without CR", b"GET / HTTP/1.1\nHost: localhost\n\n", 400, "CR LF")
    answers(http, "half a request, then its end", b"GET / HTTP/1.1\r\nHo", 400, "ends before", half_close=True)
    answers(http, "an end at once", b"", 400, half_close=True)
    answers(http, "half a request, and silence", b"GET / HTTP/1.1\r\nHo", 408, "within 5 s")
    test_thousand(http)


def test_thousand(http):
    """All at once: each gets the page or hears that there is no room."""
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(4096, resource.getrlimit(resource.RLIMIT_NOFILE)[1]),) * 2)
    crowd, full, served, late = [], 0, 0, 0
    for _ in range(1000):
        s = connect(http)
        crowd.append(s)
    for s in crowd:
        try:
            s.sendall(request())
        except OSError:
            pass
    for s in crowd:
        answer = rest_of(s)
        full += answer.startswith(b"HTTP/1.1 503 ") and b"every connection of the scope is taken" in answer
        served += answer.startswith(b"HTTP/1.1 200 ")
        late += answer.startswith(b"HTTP/1.1 408 ")
        s.close()
    verdict("1000 connections: %d served, %d told that there is no room, %d that they came late" % (served, full, late),
            served + full + late == 1000 and served > 0)
    answers(http, "and afterwards", request(), 200)


def crowded(http, stop):
    """80 connections that say nothing and come again, until `stop`."""
    crowd = []
    while not stop.is_set():
        try:
            s = socket.create_connection(("127.0.0.1", http), LONG)
            crowd.append(s)
        except OSError:
            pass
        if len(crowd) >= 80:
            crowd.pop(0).close()
    for s in crowd:
        s.close()


def test_crowd(http, token):
    """Whoever keeps all places for himself denies nobody a page or a command, and gets no more than his streams."""
    streams = [connect(http) for _ in range(60)]
    for s in streams:
        s.sendall(request("/events"))
    told = [s.recv(4096) for s in streams]
    given = sum(t.startswith(b"HTTP/1.1 200 ") for t in told)
    full = sum(b"this address has all streams that one may have" in t for t in told)
    verdict("60 streams of one address: %d given, %d told why not" % (given, full), given in (23, 24) and given + full == 60)
    stop = threading.Event()
    crowd = threading.Thread(target=crowded, args=(http, stop))
    crowd.start()
    pages = sum(ask(http, request()).startswith(b"HTTP/1.1 200 ") for _ in range(100))
    commands = sum(body_of(ask(http, post("read mass_kg", token))).endswith("exit 0\n") for _ in range(5))
    stop.set()
    crowd.join()
    verdict("beside 80 connections that come again and again: %d of 100 pages, %d of 5 commands" % (pages, commands), pages == 100 and commands == 5)
    for s in streams:
        s.close()


# ---- the plant does not notice ----

def hash_of(child):
    return re.search(r"tick \d+, hash [0-9a-f]+", child.out).group()


def lockstep_run(name, *options):
    p = plant(10, "--lockstep", "--log", path(name + ".log"), *options)
    watch = Browser(port + 19) if options else None
    if watch:
        verdict("the browser has its answer", until(lambda: watch.head))
    c = control(10, "--lockstep", "--force", "3", "--frequency", "225", "--duration", "3")
    equal(name + ": the controller's status", end(c), 0)
    equal(name + ": the plant's status", finish(p), 0)
    with open(path(name + ".log"), "rb") as f:
        return hash_of(p), f.read(), watch


def test_hash():
    print("--- lockstep with and without the scope", flush=True)
    without = lockstep_run("without")
    # The plant waits for no browser: on a busy machine a run faster than real time may be over before the scope has read it.
    for _ in range(6):
        seen = lockstep_run("with", "--scope", "--http", at(19))
        equal("hash with and without", seen[0], without[0])
        verdict("the log is equal to the byte, %d bytes" % len(seen[1]), seen[1] == without[1])
        seen[2].join(LONG)
        frames = [r[0] for r in seen[2].list("rows", "rows")]
        whole = len(frames) >= 2990 and frames == list(range(frames[0], frames[0] + len(frames)))
        if whole:
            break
    verdict("at %d rows in a run faster than real time none is lost but the last" % len(frames), whole)


def children_of(parent):
    found = []
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open("/proc/%s/stat" % entry) as f:
                if int(f.read().rsplit(")", 1)[1].split()[1]) == parent:
                    found.append(int(entry))
        except OSError:
            pass
    return found


def test_ends():
    print("--- ends", flush=True)
    p = plant(10, "--scope", "--http", at(19))
    watch = Browser(port + 19)
    until(lambda: watch.events.get("hello"))
    other = start(program, "run", "--bus", "udp:0", "--scope", "--http", at(19))
    equal("a port that is taken: status", end(other), 1)
    verdict("in one line", re.fullmatch(r"contactplant run: --http 127\.0\.0\.1:\d+: this port is in use; choose another one\n", other.err),
            other.err)
    with open(path("kept.log"), "w") as f:
        f.write("kept")
    other = start(program, "scope", "--bus", "udp:0", "--http", at(19), "--log", path("kept.log"))
    equal("the same for scope: status", end(other), 1)
    with open(path("kept.log")) as f:
        equal("a log of before stays as it was", f.read(), "kept")
    verdict("in one line, too", other.err.count("\n") == 1 and "this port is in use" in other.err, other.err)
    other = start(program, "demo", "--out", path("demo"), "--scope", "--http", at(19))
    equal("and for the demo: status", end(other), 1)
    verdict("which tells the plant's words", "this port is in use; choose another one" in other.err, other.err)
    equal("processes of the scope", len(children_of(p.pid)), 1)
    os.kill(children_of(p.pid)[0], signal.SIGKILL)
    watch.join(LONG)
    verdict("a scope that dies leaves the plant running", p.poll() is None)
    equal("to its end: status", finish(p), 0)
    p = plant(10, "--scope", "--http", at(19))
    watch = Browser(port + 19)
    until(lambda: watch.events.get("hello"))
    p.kill()
    end(p)
    watch.join(LONG)
    equal("a plant that is killed takes the scope along: last event", watch.order[-1], "bye")
    test_open_to_all()
    with open(path("kept.ini"), "w") as f:
        f.write("[plant]\nmodel = hertz_rig\n")
    for words, text in ((("run", "--http", at(19)), "--http and --control need --scope"),
                        (("run", "--control"), "--http and --control need --scope"), (("scope", "--http", "8080x"), "write ADDRESS:PORT"),
                        (("scope", "rig", "rig"), "write rig@0x240"), (("scope", "rig@0x241"), "multiple of 0x40"),
                        (("scope", "nosuch"), "nosuch"), (("scope", path("kept.ini"), "--log", path("kept.ini")), "is the scene itself"), (("scope", "--control", "--peer", "nosuch"), "a peer is HOST:PORT"),
                        (("scope", "--control", "--bus", "nosuch"), "a bus is udp:PORT")):
        c = start(program, *words)
        status = end(c)
        verdict("refused: " + " ".join(words), status in (1, 2) and text in c.err and c.err.count("\n") == 1, (status, c.err))


def test_open_to_all():
    c = start(program, "scope", "--bus", "udp:0", "--http", "0.0.0.0:%d" % (port + 19), "--duration", "1")
    until(lambda: ask_at("127.0.0.2", "127.0.0.2"))
    for host, status in (("127.0.0.2", b"200"), ("127.0.0.1", b"200"), ("127.0.0.3", b"421"), ("0.0.0.0", b"200")):
        verdict("open to all, by 127.0.0.2 with Host %s: %s" % (host, status.decode()), ask_at("127.0.0.2", host).startswith(b"HTTP/1.1 " + status))
    equal("which heard no plant: status", end(c), 1)
    verdict("it says what it opens", "whoever reaches this machine at port %d can watch" % (port + 19) in c.err and "heard nothing" in c.err, c.err)


def ask_at(address, host):
    try:
        with socket.create_connection((address, port + 19), LONG) as s:
            s.sendall(request(host=host))
            return rest_of(s)
    except OSError:
        return b""


# ---- commands from the page ----

def post(text, token=None, target="/send/0", host=None, more=""):
    data = text if isinstance(text, bytes) else text.encode()
    lines = "Content-Length: %d\r\n%s" % (len(data), more) + ("Authorization: Bearer %s\r\n" % token if token else "")
    return request(target, host, "POST", lines) + data


def body_of(answer):
    return answer.decode(errors="replace").split("\r\n\r\n", 1)[-1]


def said_by_send(first, *words):
    """What contactplant send prints, with its last line as the scope tells it."""
    c = start(program, "send", *words, "--bus", "udp:%d" % (port + first + 3), "--peer", at(first))
    status = end(c)
    return c.out + c.err + "exit %d\n" % status


def test_control():
    print("--- commands from the page", flush=True)
    p = start_told("run", "--bus", "udp:%d" % (port + 10), "--peer", at(11), "--peer", at(12), "--peer", at(13), "--scope", "--control",
                   "--http", at(19), *PATIENT)
    http, token = port + 19, re.search(r"open http://127\.0\.0\.1:%d/#([0-9a-f]{32});" % (port + 19), told(p)).group(1)
    watch = Browser(http)
    verdict("the page is told that it may command", until(lambda: watch.events.get("hello")) and watch.events["hello"][0]["control"] is True)
    refusals(http, token)
    for words in (("step", "0"), ("read", "mass_kg"), ("read", "mass"), ("arm", "forc", "amplitude=1"), ("frie",), ("step", "5"),
                  ("start", "+", "step", "5")):
        answer, wanted = body_of(ask(http, post(" ".join(words), token))), said_by_send(10, *words)
        verdict("%s: as contactplant send says: %.60s" % (" ".join(words), " ".join(answer.split())), answer == wanted, (answer, wanted))
    holder = connect(http)
    holder.sendall(post("start + arm force amplitude=3 frequency=225 + fire --hold 60", token))
    verdict("a command holds its session", until(lambda: "running" in states(watch)[-1:] and len(senders(p)) == 1))
    verdict("and drives the plant", until(lambda: any(v.get("drives", {}).get("force", {}).get("amplitude") == 3 for v in watch.all("values"))))
    answer = body_of(ask(http, post("pause", token, more="Origin: http://%s\r\n" % at(9))))
    verdict("a later one, from the page's own address", answer == "CONTROL: ok\nexit 0\n", answer)
    verdict("ends the one before", b"ended by a later command" in rest_of(holder))
    first, second = connect(http), connect(http)
    first.sendall(post("enable --hold 60", token))
    until(lambda: len(senders(p)) == 1)
    stubborn = senders(p)[0]
    os.kill(stubborn, signal.SIGSTOP)  # a process that is stopped ignores SIGTERM
    second.sendall(post("enable --hold 61", token))
    later = []

    def another():  # looked at once: between the two there is a moment without any
        later[:] = [c for c in senders(p) if c != stubborn]
        return later
    verdict("a command that ignores its end is killed", until(another) and not os.path.exists("/proc/%d" % stubborn))
    first.close()
    time.sleep(0.3)
    verdict("the end of the first one's connection leaves the later one at work", senders(p) == later, (senders(p), later))
    second.close()
    until(lambda: not senders(p))
    answer = body_of(ask(http, post("read mass_kg", token), half_close=True)).strip("\n")
    verdict("a client that ends its side gets its answer", answer.endswith("exit 0"), answer)
    holder = connect(http)
    holder.sendall(post("enable --hold 60", token))
    until(lambda: len(senders(p)) == 1)
    holder.recv(65536)
    holder.close()
    verdict("a command ends with its browser, which had read all", until(lambda: not senders(p)))
    test_crowd(http, token)
    holder = connect(http)
    holder.sendall(post("enable --hold 60", token))
    verdict("one more", until(lambda: len(senders(p)) == 1))
    holder.close()
    verdict("ends with its browser", until(lambda: not senders(p)))
    verdict("the command line's script is served", ask(http, request("/control.js")).startswith(b"HTTP/1.1 200"))
    verdict("nobody is told the token", token not in json.dumps(watch.events) and token.encode() not in ask(http, request("/")))
    holder = connect(http)
    holder.sendall(post("enable --hold 60", token))
    until(lambda: len(senders(p)) == 1)
    last = senders(p)
    equal("the plant's status", finish(p), 0)
    verdict("which takes its commands along", until(lambda: not os.path.exists("/proc/%d/exe" % last[0])))
    control_beside()


def refusals(http, token):
    other = ("0" if token[-1] != "0" else "1")
    for name, data, status, text in (
            ("no token", post("start"), 403, "needs the token"), ("a wrong token", post("start", token[:-1] + other), 403, "needs the token"),
            ("half a token", post("start", token[:16]), 403, "needs the token"),
            ("a token with more behind", post("start", token + "0"), 403, "needs the token"),
            ("another site", post("start", token, more="Origin: http://evil.example\r\n"), 403, "another site"),
            ("a page without origin", post("start", token, more="Origin: null\r\n"), 403, "another site"),
            ("another port of this machine", post("start", token, more="Origin: http://%s\r\n" % at(8)), 403, "another site"),
            ("a name that points here", post("start", token, host="evil.example"), 421, "names another machine"),
            ("too long a command", post("read " + 1020 * "x", token), 413, "1024 bytes"),
            ("81 words", post("read" + 80 * " x", token), 400, "80 words"), ("two lines", post("start\nstop", token), 400, "one line"),
            ("no command", post(" ", token), 400, "contactplant send"), ("a plant that is not there", post("start", token, "/send/1"), 404, "number"),
            ("no number of a plant", post("start", token, "/send/nan"), 404, "number"),
            ("somebody's bus", post("start --bus can:can0", token), 400, "the scope knows"),
            ("help", post("start --help", token), 400, "the scope knows"),
            ("chunks", post("", token, more="Transfer-Encoding: chunked\r\n"), 411, "one piece"),
            ("a page", post("start", token, "/"), 405, "only GET and HEAD"),
            ("a question before", request("/send/0", None, "OPTIONS", "Origin: http://evil.example\r\n"), 405, "only GET and HEAD")):
        answers(http, name, data, status, text)


def senders(p):
    """Processes of send below the scope's."""
    found = [c for scope in children_of(p.pid) for c in children_of(scope)]
    return [c for c in found if os.path.exists("/proc/%d/cmdline" % c) and b"\0send\0" in open("/proc/%d/cmdline" % c, "rb").read()]


def start_told(*words):
    """A program whose stderr is a file, that can be read while it runs."""
    with open(path("told.err"), "w") as err:
        child = subprocess.Popen([program, *words], stdout=subprocess.DEVNULL, stderr=err)
    children.append(child)
    return child


def told(child):
    until(lambda: "to command the plant" in open(path("told.err")).read() or child.poll() is not None)
    return open(path("told.err")).read()


def control_beside():
    """The scope as a process of its own commands the plant that is its peer, from the port of send."""
    p = plant(10, "--setting", "timeout_frames=10000")
    s = start_told("scope", "--bus", "udp:%d" % (port + 12), "--peer", at(10), "--setting", "timeout_frames=10000", "--control", "--http", at(19))
    token = re.search(r"#([0-9a-f]{32});", told(s)).group(1)
    answer = body_of(ask(port + 19, post("start", token)))
    verdict("beside a plant: start", answer == "CONTROL: ok\nexit 0\n", answer)
    equal("the scope's status", finish(s), 0)
    equal("the plant's status", finish(p), 0)


# ---- two plants of one bus, a third without a scene, and a burst ----

def test_bus():
    print("--- plants of a bus, told apart", flush=True)
    plants = [start(program, "run", scene, "--bus", "udp:%d" % (port + first), "--peer", at(22), "--peer", at(first + 1), "--base-id", base)
              for scene, first, base in (("hertz_rig", 20, "0x200"), ("tip", 23, "0x240"), ("hertz_rig", 26, "0x280"))]
    with open(path("scope.err"), "w") as err:
        scope = subprocess.Popen([program, "scope", "hertz_rig", "tip@0x240", "--bus", "udp:%d" % (port + 22), "--peer", at(20), "--peer",
                                  at(23), "--peer", at(26), "--http", "127.0.0.1:0", "--log", path("bus.log")], stderr=err)
    children.append(scope)
    http = http_of(scope, path("scope.err"))
    watch = Browser(http)
    controls = [start(program, "send", "start", "+", "capture", "arm", "+", "capture", "trigger", "--model", scene, "--base-id", base,
                      "--bus", "udp:%d" % (port + first + 1), "--peer", at(first), "--hold", "1")
                for scene, first, base in (("hertz_rig", 20, "0x200"), ("tip", 23, "0x240"))]
    verdict("rows of both", until(lambda: len(watch.list("rows", "rows")) > 300 and len(watch.list("rows", "rows", 1)) > 300))
    equal("models", [watch.hello(i)["model"] for i in (0, 1)], ["hertz_rig", "afm_tip"])
    equal("identities", [watch.hello(i)["identity"] for i in (0, 1)], ["same", "same"])
    verdict("the third plant is listed by its identifiers", until(lambda: any(o["base_id"] == 0x280 and o["messages"] > 100 for e in
                                                                              watch.all("link") for o in e["others"])))
    for c in controls:
        status = end(c)
        verdict("send: status: %d" % status, status == 0, c.err)
    test_burst(watch)
    equal("scope: status", (scope.send_signal(signal.SIGINT), scope.wait(LONG))[1], 0)
    for p in plants:
        finish(p)
    verdict("its log decodes", end(start(program, "decode", path("bus.log"), "--out", path("bus.csv"))) == 0 and
            os.path.getsize(path("bus.csv")) > 10000)


def test_burst(watch):
    c = start(program, "send", "capture", "read", "--bus", "udp:%d" % (port + 21), "--peer", at(20))
    equal("capture read: status", end(c), 0)
    lines = [line for line in c.out.splitlines() if re.match(r"[-0-9]", line)]
    until(lambda: len(watch.list("burst", "data")) >= len(lines) and watch.all("burst")[-1]["trigger_t"])
    data, head = watch.list("burst", "data"), watch.all("burst")[-1]
    heard = {}
    for signal_, sample, value in data:
        heard.setdefault(sample, {})[signal_] = value
    differ = 0
    for line in lines:
        sample, *values = line.split(",")
        got = heard.get(int(sample), {})
        differ += [got.get(i) for i in range(len(values))] != [float(v) for v in values]
    verdict("a burst of %d samples as send prints it: %d differ" % (len(lines), differ), len(lines) == 1000 and not differ,
            (lines[:2], data[:6]))
    verdict("its trigger is dated", head["burst"] == 1 and head["sample_s"] == 1.5625e-05 and head["trigger_t"] > 0 and
            head["pretrigger"] is not None, {k: head[k] for k in head if k != "data"})


def test_another_plant():
    print("--- a scene that is not the plant's", flush=True)
    p = plant(10, "--set", "preload_N=100", "--duration", "3.6")
    scope = start(program, "scope", "--substeps", "32", "--bus", "udp:%d" % (port + 12), "--peer", at(10), "--http", at(19), "--duration", "3.2")
    watch = Browser(port + 19)
    c = control(10, "--set", "preload_N=100", "--duration", "1.5")
    end(c), end(scope), end(p)
    watch.join(LONG)
    equal("identity", watch.hello()["identity"], "other")
    verdict("why", "substeps 64, not 32" in watch.hello()["why"], watch.hello()["why"])
    verdict("no row, no value of it", not watch.events.get("rows") and not watch.events.get("values") and watch.all("link")[-1]["withheld"] > 1000)
    verdict("and on the terminal, once", scope.err.count("substeps 64, not 32") == 1, scope.err)


port = free_ports(10, 32000, (socket.SOCK_DGRAM, socket.SOCK_STREAM)) // 10 * 10
with tempfile.TemporaryDirectory() as directory:
    try:
        ten_seconds = begin_ten_seconds()
        test_requests(port + 9)
        for test in (test_hash, test_ends, test_control, test_bus, test_another_plant):
            test()
        end_ten_seconds(*ten_seconds)
    finally:
        end_all()
conclude()
