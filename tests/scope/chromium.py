"""Chromium without a window, over its DevTools protocol: standard library only.

    with Chromium() as browser:
        tab = browser.open("http://127.0.0.1:8080/")
        tab.run("document.title")
"""
import base64
import json
import os
import socket
import struct
import subprocess
import tempfile
import time
import urllib.parse
import urllib.request

PATIENCE_S = 60.0


class WebSocket:
    """The client's side of RFC 6455, text messages only."""

    def __init__(self, url):
        at = urllib.parse.urlsplit(url)
        self.socket = socket.create_connection((at.hostname, at.port), PATIENCE_S)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET {at.path} HTTP/1.1\r\nHost: {at.netloc}\r\nUpgrade: websocket\r\n"
                             f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
                             "Sec-WebSocket-Version: 13\r\n\r\n").encode())
        self.file = self.socket.makefile("rb")
        if b" 101 " not in self.file.readline():
            raise OSError("no websocket at " + url)
        while self.file.readline().strip():
            pass

    def send(self, text):
        data = text.encode()
        if len(data) < 126:
            head = struct.pack("!BB", 0x81, 0x80 | len(data))
        elif len(data) < 65536:
            head = struct.pack("!BBH", 0x81, 0x80 | 126, len(data))
        else:
            head = struct.pack("!BBQ", 0x81, 0x80 | 127, len(data))
        self.socket.sendall(head + bytes(4) + data)  # a mask of zeros leaves the data as it is

    def receive(self):
        text = b""
        while True:
            first, size = self.file.read(2)
            size &= 0x7F
            if size == 126:
                size, = struct.unpack("!H", self.file.read(2))
            elif size == 127:
                size, = struct.unpack("!Q", self.file.read(8))
            data = self.file.read(size)
            if first & 0x0F in (0, 1):
                text += data
                if first & 0x80:
                    return text.decode()


class Tab:
    def __init__(self, browser, target):
        self.browser, self.target = browser, target
        self.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.errors = browser.errors.setdefault(self.session, [])
        for domain in ("Page", "Runtime", "Log"):
            self.call(domain + ".enable")

    def call(self, method, **params):
        return self.browser.call(method, self.session, **params)

    def go(self, url):
        self.call("Page.navigate", url=url)
        self.wait(f"location.href !== 'about:blank' && document.readyState === 'complete'")

    def run(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(str(answer["exceptionDetails"])[:2000])
        return answer["result"].get("value")

    def wait(self, expression, patience_s=PATIENCE_S):
        end = time.time() + patience_s
        while not self.run(expression):
            if time.time() > end:
                raise TimeoutError("never true: " + expression)
            time.sleep(0.05)

    def key(self, key, code=None, shift=False):
        """One key, as from the keyboard."""
        text = {"text": key} if len(key) == 1 else {}
        number = {" ": 32, "End": 35, "ArrowLeft": 37, "ArrowRight": 39, "Escape": 27, "Tab": 9, "Enter": 13}.get(key, 0)
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=code or "", modifiers=8 if shift else 0,
                      windowsVirtualKeyCode=number, **(text if kind == "keyDown" else {}))

    def size(self, width, height, ratio=1):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=ratio, mobile=False)

    def dark(self, on):
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if on else "light"}])

    def picture(self, path):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)


class Chromium:
    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen(
            ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--disable-extensions", "--hide-scrollbars",
             "--disable-backgrounding-occluded-windows", "--disable-renderer-backgrounding",
             "--disable-background-timer-throttling", "--user-data-dir=" + self.folder.name, "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        port_file, end = os.path.join(self.folder.name, "DevToolsActivePort"), time.time() + PATIENCE_S
        while not os.path.exists(port_file) or open(port_file).read().count("\n") < 1:
            if time.time() > end or self.process.poll() is not None:
                self.__exit__()
                raise OSError("chromium does not start; is the package chromium installed?")
            time.sleep(0.05)
        port, path = open(port_file).read().split()[:2]
        self.socket, self.n, self.errors = WebSocket(f"ws://127.0.0.1:{port}{path}"), 0, {}
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
        except (AttributeError, OSError, ValueError):
            pass
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, 9)
            self.process.wait()
        for _ in range(50):
            try:
                return self.folder.cleanup()
            except OSError:
                time.sleep(0.1)  # its children still write

    def call(self, method, session=None, **params):
        self.n += 1
        message = {"id": self.n, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        self.socket.send(json.dumps(message))
        while True:
            answer = json.loads(self.socket.receive())
            self.note(answer)
            if answer.get("id") == self.n:
                if "error" in answer:
                    raise RuntimeError(method + ": " + str(answer["error"]))
                return answer["result"]

    def note(self, event):
        """Keeps what a page complains about."""
        p, kind = event.get("params", {}), event.get("method")
        if kind == "Runtime.exceptionThrown":
            text = str(p["exceptionDetails"])
        elif kind == "Runtime.consoleAPICalled" and p["type"] in ("error", "warning", "assert"):
            text = str(p["args"])
        elif kind == "Log.entryAdded" and p["entry"]["level"] in ("error", "warning"):
            text = p["entry"]["text"] + " " + p["entry"].get("url", "")
        else:
            return
        self.errors.setdefault(event.get("sessionId"), []).append(text[:500])

    def open(self, url, width=1280, height=800, fresh_window=False, first=""):
        """A tab; the script `first` runs in it before the page's own."""
        target = self.call("Target.createTarget", url="about:blank", newWindow=fresh_window)["targetId"]
        tab = Tab(self, target)
        tab.size(width, height)
        if first:
            tab.call("Page.addScriptToEvaluateOnNewDocument", source=first)
        tab.go(url)
        return tab
