"""Ports and processes of a test: none is left when it is over."""
import os
import signal
import socket
import subprocess
import sys
import time

children = []
LONG = 300  # s, for what only a broken program takes


def free_ports(n, begin, kinds=(socket.SOCK_DGRAM,)):
    """The first of n in a row that nobody has; begin: where this test looks first."""
    for first in range(begin + os.getpid() % 800 * 10, begin + 20000, 10):
        try:
            for i in range(n):
                for kind in kinds:
                    with socket.socket(socket.AF_INET, kind) as s:
                        s.bind(("127.0.0.1", first + i))
            return first
        except OSError:
            continue
    sys.exit("FAIL  no free ports")


def start(*arguments):
    child = subprocess.Popen([str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    children.append(child)
    return child


def end(child):
    """Its status, and what it printed in child.out and child.err; it must end by itself or by a signal that was sent."""
    child.out, child.err = child.communicate(timeout=LONG)
    return child.returncode


def end_all():
    for child in children:
        if child.poll() is None:
            child.kill()
            child.wait()


def finish(child):
    """Ctrl-C; its status, as end."""
    child.send_signal(signal.SIGINT)
    return end(child)


def until(condition, seconds=LONG):
    """Waits for it; False when it does not come true."""
    for _ in range(int(50 * seconds)):
        if condition():
            return True
        time.sleep(0.02)
    return False


def running(wanted):
    """The processes whose command line is wanted(line): (number, line)."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open("/proc/%s/cmdline" % pid, "rb") as f:
                line = f.read()
        except OSError:
            continue
        if wanted(line):
            found.append((pid, line))
    return found
