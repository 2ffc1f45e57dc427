#!/usr/bin/env python3
"""bench_scope.py PROGRAM SECONDS [PIECE] - frames of run with and without --scope, in turn, for so many seconds of each, with and
without --realtime. Three browsers read all of it. Prints what run reports: numbers, not pass/fail. An `ok` line says that both did
all their frames."""
import re
import socket
import subprocess
import sys
import threading
import time

program, seconds = sys.argv[1], float(sys.argv[2])
piece = float(sys.argv[3]) if len(sys.argv) > 3 else 10.0
FORM = re.compile(r"frames (\d+) of 1000 us, missed (\d+), later than half a period (\d+)\n"
                  r"wake-up lateness p50 ([\d.]+) us, p99 ([\d.]+) us, max ([\d.]+) us\n"
                  r"compute per frame p50 ([\d.]+) us, p99 ([\d.]+) us, max ([\d.]+) us")


def free(kind):
    with socket.socket(socket.AF_INET, kind) as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def browse(http, heard):
    for _ in range(100):
        try:
            with socket.create_connection(("127.0.0.1", http)) as s:
                s.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
                while True:
                    data = s.recv(1 << 16)
                    heard[0] += len(data)
                    if not data:
                        return
        except OSError:
            time.sleep(0.05)


def one(options, scope):
    """A plant with its controller for one piece; the numbers of its report, and the bytes that browsers read."""
    plant, me, http, heard = free(socket.SOCK_DGRAM), free(socket.SOCK_DGRAM), free(socket.SOCK_STREAM), [0]
    more = ["--scope", "--http", "127.0.0.1:%d" % http] if scope else []
    run = subprocess.Popen([program, "run", "--bus", "udp:%d" % plant, "--peer", "127.0.0.1:%d" % me, "--duration", "%g" % piece, *options, *more],
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    control = subprocess.Popen([program, "control", "--bus", "udp:%d" % me, "--peer", "127.0.0.1:%d" % plant, "--force", "3", "--frequency", "225",
                                "--duration", "%g" % (piece + 5)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for _ in range(3 * scope):
        threading.Thread(target=browse, args=(http, heard), daemon=True).start()
    out = run.communicate()[0]
    control.kill()
    control.wait()
    return [float(x) for x in FORM.search(out).groups()], heard[0]


print("%-26s %8s %7s %7s  %s" % ("", "frames", "missed", "late", "lateness p50, p99, max, compute p50, p99, max; us"))
for options in ([], ["--realtime"]):
    sums, heard = {False: [], True: []}, 0
    for _ in range(max(1, round(seconds / piece))):
        for scope in (False, True):
            numbers, n = one(options, scope)
            sums[scope].append(numbers)
            heard += n
    for scope, rows in sums.items():
        columns = list(zip(*rows))
        median = [sorted(c)[len(c) // 2] for c in columns]
        print("%-26s %8d %7d %7d  %.1f %.1f %.1f  %.1f %.1f %.1f" % (" ".join(["run", *options, *["--scope"] * scope]), *map(sum, columns[:3]),
              median[3], median[4], max(columns[5]), median[6], median[7], max(columns[8])), flush=True)
    whole = all(sum(r[0] for r in rows) > 0 for rows in sums.values())
    print("%s  %s: browsers read %.1f MB" % ("ok  " if whole and heard else "FAIL", " ".join(["run", *options]), heard / 1e6), flush=True)
