"""The answers of contactplant scope --open, as a plain client gets them."""
import json
import os
import re
import select
import subprocess
import sys
import time
import urllib.error
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from processes import children  # noqa: E402


class Viewer:
    """with Viewer(program, "run.log", "rig") as v: v.range(0, 1)"""

    def __init__(self, program, *arguments):
        self.process = subprocess.Popen([program, "scope", "--http", "127.0.0.1:0", *arguments], stderr=subprocess.PIPE, text=True)
        children.append(self.process)
        self.told, self.url = "", None

    def __enter__(self):
        began = time.time()
        for line in self.process.stderr:
            self.told += line
            found = re.search(r"the scope is at (\S+)", line)
            if found:
                self.url = found.group(1)
                break
        self.took_s = time.time() - began
        if not self.url:
            raise OSError(self.told)
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.told += self.process.communicate()[1]

    def more(self, seconds):
        """A line that it says later."""
        ready, _, _ = select.select([self.process.stderr], [], [], seconds)
        return self.process.stderr.readline() if ready else ""

    def ask(self, target, **query):
        text = "&".join(f"{k}={v!r}" if isinstance(v, float) else f"{k}={v}" for k, v in query.items())
        with urllib.request.urlopen(self.url + target + ("?" + text if text else "")) as answer:
            return json.load(answer)

    def status(self, target, method="GET", **headers):
        request = urllib.request.Request(self.url + target, method=method, headers=headers)
        try:
            with urllib.request.urlopen(request) as answer:
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as e:
            return e.code, e.read().decode()

    def range(self, a, b, pixels=1000, log=0, run=0):
        return self.ask("range", log=log, run=run, **{"from": float(a), "to": float(b)}, pixels=pixels)

    def row(self, at, log=0, run=0):
        return self.ask("row", log=log, run=run, at=float(at))

    def next(self, at, back=0, kinds=255, log=0, run=0):
        return self.ask("next", log=log, run=run, at=float(at), back=back, kinds=kinds)

    def kib(self):
        """Memory that it has in use, at most so far."""
        with open(f"/proc/{self.process.pid}/status") as f:
            return int(re.search(r"VmHWM:\s+(\d+)", f.read()).group(1))
