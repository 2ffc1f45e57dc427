"""A scope of its own: speaks the page's contract and tells of a plant whose every number is known in closed form.

The mass swings at 225 Hz, the rows come at 1 kHz. Contact is lost once in each of 40 periods from t = 3 s on, at instants
that are chosen here. The page is served from the folder of the sources."""
import json
import math
import os
import random
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

PAGE = os.path.join(os.path.dirname(__file__), "../../host_sim/report/page")
TYPES = {"html": "text/html; charset=utf-8", "css": "text/css", "js": "text/javascript"}
CSP = ("default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; base-uri 'none'; "
       "form-action 'none'; frame-ancestors 'none'")
HZ, AMPLITUDE_M, MEAN_M, TICK_S, RATE = 225.0, 4e-6, 5e-6, 1e-3 / 64, 1000
OMEGA = 2 * math.pi * HZ
STIFFNESS = 8e6  # of the force that is drawn, N/m


def lift_offs():
    """Pairs of lift-off and touchdown, s."""
    chance, found = random.Random(7), []
    for k in range(40):
        t = 3.0 + k * 4 / HZ + chance.random() * 1e-3
        found.append((t, t + 0.3 / HZ + chance.random() * 1e-4))
    return found


LIFTS = lift_offs()


def x_of(t):
    return MEAN_M + AMPLITUDE_M * math.sin(OMEGA * t)


def v_of(t):
    return AMPLITUDE_M * OMEGA * math.cos(OMEGA * t)


def is_open(t):
    return any(a <= t < b for a, b in LIFTS) if 3 <= t < 4 else False


def row_of(frame):
    t = frame / RATE
    x, away = x_of(t), is_open(t)
    force = 0.0 if away else STIFFNESS * x
    return [frame, round(t, 15), 0 if away else 1, x, v_of(t), max(x, 0.0), force, 0.5 * (frame // 400 % 3), None, None]


SIGNALS = [("displacement", "m"), ("velocity", "m/s"), ("penetration", "m"), ("contact_force", "N")]


def hello(contract=1):
    inputs = [("force", "N"), ("fast_force", "N"), ("base", "m")]
    plants = [{"plant": i, "name": name, "model": "hertz_rig", "summary": "planted", "bus": "udp:20002", "base_id": 512 + 64 * i,
               "extended": False, "identity": "same", "why": "", "tick_s": TICK_S, "substeps": 64, "frame_s": 1e-3,
               "frame_rate_Hz": RATE, "dilation": 4, "f0_Hz": 225.6,
               "columns": ["frame", "t", "closed", "displacement", "velocity", "penetration", "contact_force", "stream_0",
                           "stream_1", "stream_2"],
               "outputs": [{"name": n, "unit": u, "meaning": ""} for n, u in SIGNALS] + [{"name": "in_contact", "unit": "1"}],
               "inputs": [{"name": n, "unit": u, "meaning": ""} for n, u in inputs], "parameters": [], "contacts": 1,
               "counters": [{"name": n, "unit": u, "meaning": ""} for n, u in
                            (("frames_received", "frames"), ("late", "commands"), ("switches", "switches"))],
               "faults": ["not_finite", "budget", "ledger", "overrun", "bus", "timeout", "assert", "self_test"],
               "timing": True, "commands": True} for i, name in enumerate(("planted", "second"))]
    return {"contract": contract, "version": "0.9.0", "control": False, "batch_s": 0.033, "plants": plants}


def values(t):
    return {"plant": 0, "t": t, "health": {"frames_received": 2400, "command_age_frames": 3, "late": 2, "switches": 80,
                                           "lateness_max_us": 180, "compute_max_us": 42},
            "ledger": {"stored": 0.12, "damping": 1.2, "residual": 1e-12, "change": 0, "work_0": 1.3},
            "info": {"f0_bus_Hz": 225.6, "promoted": 0}, "parameters": {"motion_every": 1, "capture_trigger": 2},
            "drives": {"force": {"amplitude": 10 if t > 1 else 4, "frequency": HZ, "phase": 0, "ramp": 0.2, "noise": 0}}}


def burst(number=1, trigger_t=LIFTS[0][0], stiffness=STIFFNESS):
    samples, before = 1000, 100
    data = []
    for k in range(samples):
        t = trigger_t + (k - before) * TICK_S
        away = is_open(t)
        data += [[0, k, x_of(t)], [1, k, v_of(t)], [3, k, 0.0 if away else stiffness * x_of(t)]]
    return {"plant": 0, "burst": number, "sample_s": TICK_S, "trigger_t": trigger_t, "pretrigger": before, "samples": samples,
            "first": 0, "signals": [{"signal": i, "name": SIGNALS[i][0], "unit": SIGNALS[i][1]} for i in (0, 1, 3)],
            "data": data}


class Story:
    """What one browser is told; with `more`: a burst at a touchdown and one of twice the force."""

    def __init__(self, send, more):
        self.send, self.frame, self.more = send, 0, more
        self.events = sorted([(t, 0, -0.004 - 0.001 * (i % 5)) for i, (t, _) in enumerate(LIFTS)] +
                             [(t, 1, 0.005 + 0.001 * (i % 7)) for i, (_, t) in enumerate(LIFTS)])
        self.told = 0

    def begin(self, contract):
        self.send("hello", hello(contract))
        self.send("values", values(0.0))
        self.send("status", {"plant": 0, "t": 0, "frame": 0, "state": "running", "session": 1, "reaction": "none", "watch": 0,
                             "faults": 32, "fault_names": ["timeout"]})
        self.send("timing", {"plant": 0, "lateness_us": [0, 0, 3, 40, 900, 5000, 2500, 300, 12] + [0] * 7,
                             "compute_us": [0, 0, 9, 4000, 4300, 80, 2] + [0] * 9})
        self.send("said", {"plant": 0, "said": [[1.0, 1000, "FIRE", {"SESSION": 1, "CHANNELS": 1, "TICK": 64000}],
                                                [1.001, 1001, "REPLY", {"SESSION": 1, "MESSAGE": "FIRE", "CAUSE": "ok"}],
                                                [1.4, 1400, "REPLY", {"MESSAGE": "STREAM_0", "CAUSE": "late", "TICKS_LATE": 12}]]})

    def batch(self, until):
        if until <= self.frame:
            return
        self.send("rows", {"plant": 0, "rows": [row_of(f) for f in range(self.frame, until)]})
        end = (until - 1) / RATE
        events = []
        while self.told < len(self.events) and self.events[self.told][0] <= end:
            t, touch, speed = self.events[self.told]
            events.append([t, 0, touch, speed, 0 if touch else 60.0])
            self.told += 1
        if events:
            self.send("contact", {"plant": 0, "events": events})
        for f in range(self.frame, until):
            self.every_so_often(f)
        self.frame = until

    def every_so_often(self, f):
        t = f / RATE
        if f % 100 == 0:
            self.send("summary", {"plant": 0, "summary": [[t, 4, 0.07 if 3 < t < 4 else 0.0, 0]]})
        if f % 40 == 0:
            self.send("lockin", {"plant": 0, "window_s": 0.04, "slots": [
                {"slot": 0, "input": "force", "output": "displacement", "unit": "m", "harmonic": 1},
                {"slot": 1, "input": "force", "output": "displacement", "unit": "m", "harmonic": 2}],
                "lockin": [[t, 0, AMPLITUDE_M, -1.5708], [t, 1, 0.1 * AMPLITUDE_M, 0.3]]})
        if f == 1010:
            self.send("values", values(t))
        if f == 3500:
            self.send("burst", burst())
        if self.more and f == 3600:
            self.send("burst", burst(2, LIFTS[0][1]))
        if self.more and f == 3700:
            self.send("burst", burst(3, 2.0, 2 * STIFFNESS))
        if f % 1000 == 0:
            self.send("link", {"plant": 0, "t": t, "frame": f, "heard": True, "silent_s": 0, "bad": 0, "withheld": 0, "lost": 0,
                               "browsers": 1, "dropped": 0, "others": []})


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def head(self, kind, size=None):
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Security-Policy", CSP)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cache-Control", "no-store")
        if size is not None:
            self.send_header("Content-Length", str(size))
        self.end_headers()

    def do_GET(self):
        path = self.path.split("?")[0]
        if path == "/events":
            return self.events()
        name = "scope.html" if path == "/" else path[1:]
        if name not in ("scope.html", "scope.css", "scope.js", "draw.js", "keys.js"):
            return self.send_error(404)
        with open(os.path.join(PAGE, name), "rb") as file:
            data = file.read()
        self.head(TYPES[name.rsplit(".", 1)[1]], len(data))
        self.wfile.write(data)

    def events(self):
        self.head("text/event-stream")
        server = self.server
        tell = Story(lambda kind, d: self.wfile.write(f"event: {kind}\ndata: {json.dumps(d)}\n\n".encode()), server.more)
        try:
            self.wfile.write(b"retry: 500\n\n")
            tell.begin(server.contract)
            began = time.monotonic()
            while not server.over and tell.frame < server.frames:
                due = min(server.frames, int((time.monotonic() - began) * RATE * server.speed))
                tell.batch(min(due, tell.frame + 500))
                self.wfile.flush()
                if due - tell.frame < 34:
                    time.sleep(0.033)
            while not server.over:
                time.sleep(0.05)
        except OSError:
            pass  # the tab was closed
        self.close_connection = True


class Planted:
    """with Planted(frames=10000) as url: ..."""

    def __init__(self, frames=10000, speed=1, contract=1, port=0, more=False):
        self.server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self.server.daemon_threads = True
        self.server.frames, self.server.speed, self.server.contract, self.server.over = frames, speed, contract, False
        self.server.more = more
        self.url = f"http://127.0.0.1:{self.server.server_port}/"

    def __enter__(self):
        threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        return self.url

    def __exit__(self, *_):
        self.server.over = True
        self.server.shutdown()
        self.server.server_close()
