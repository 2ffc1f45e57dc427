#!/usr/bin/env python3
"""controller.py PLANT ME BUG - a controller for tests of contactplant test. It damps the rig by velocity feedback in the frame
of the sample, and stops the plant when the contact force leaves its limit. BUG `none` is correct; each other one is a mistake
that a test must find. It knows the protocol by tests/cli/lockstep_client.py and the .dbc alone."""
import os
import re
import signal
import struct
import subprocess
import sys
import time

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "cli"))
from lockstep_client import CONTROL, START, STOP, STREAM, Client  # noqa: E402

MOTION, CONTACT, FAST_FORCE = 0x14, 0x15, 1
GAIN, LIMIT, FORCE_MAX = 800.0, 30.0, 200.0  # N s/m, N, N
BUGGY_FROM = 500  # frames, after which a bug begins
plant, me, bug = (sys.argv[1:] + ["none"])[:3]


def unit_of(signal_name):
    """The scale of a signal in the .dbc."""
    with open(os.path.join(here, "..", "..", "docs", "reference", "contactplant.dbc")) as f:
        return float(re.search(r" SG_ %s :[^(]*\(([^,]+)," % signal_name, f.read()).group(1))


def address(text):
    host, port = text.rsplit(":", 1)
    return host, int(port)


class Controller(Client):
    velocity = contact_force = late_force = sum_force = 0.0
    velocity_unit, force_unit = unit_of("VELOCITY"), unit_of("FORCE")

    def hear(self, kind, packet, at):
        super().hear(kind, packet, at)
        value = int.from_bytes(packet[at + 5:at + 8], "little", signed=True) if kind in (MOTION, CONTACT) else 0
        if kind == MOTION:
            self.velocity = value * self.velocity_unit
        if kind == CONTACT:
            self.contact_force = value * self.force_unit

    def command(self, n):
        """The force of this frame; a bug in it begins after BUGGY_FROM."""
        if bug == "idle":
            return 0.0
        force = max(-LIMIT, min(LIMIT, -GAIN * self.velocity))
        late, self.late_force = self.late_force, force
        self.sum_force += abs(force)
        if n < BUGGY_FROM:
            return force
        if bug == "sign":
            return -force
        if bug == "wrong-unit":
            return max(-LIMIT, min(LIMIT, -GAIN * self.velocity * 1e3))
        if bug == "one-frame-late":
            return late
        if bug == "wind-up":
            return force + 0.2 * self.sum_force
        if bug == "nan":
            return float("nan")
        if bug == "stuck-value":
            return 0.0
        return force

    def frame_of(self, n):
        return (self.tick // 64 - (3 if bug == "late-stream" and n >= BUGGY_FROM else 0)) & 0xFFFF

    def spoil(self, n):
        """What a bug does beside the command."""
        if n < BUGGY_FROM:
            return
        if bug == "stuck-counter":
            self.counter[STREAM + FAST_FORCE] = 3
        if bug == "wrong-session":
            self.session = self.session % 15 + 1 if n == BUGGY_FROM else self.session
        if bug == "crash":
            raise RuntimeError("as it was to be")
        if bug == "exit":
            sys.exit(0)
        if bug == "silent":
            time.sleep(1000)
        if bug == "sleepy" and n == BUGGY_FROM:
            os.kill(os.getpid(), signal.SIGSTOP)
        if bug == "slow":
            time.sleep(0.001)
        if bug == "garbage":
            self.socket.send(b"\x02\x00garbage" + bytes([n & 255]) * 100)
        if bug == "flood":
            for _ in range(200):
                self.socket.send(struct.pack(">BBBH", 2, 0, 0, 0))
        if bug == "chatty":
            print("x" * 2000, flush=True)

    def run(self):
        self.open()
        self.control(START)
        n = 0
        while True:
            if n % 10 == 0 and not (bug == "no-heartbeat" and n >= BUGGY_FROM):
                self.enable()
            self.send(STREAM + FAST_FORCE, struct.pack("<Hf", self.frame_of(n), self.command(n)))
            self.spoil(n)
            if abs(self.contact_force) > FORCE_MAX and bug not in ("no-stop", "idle"):
                self.control(STOP)
                self.turn()
                self.turn()
                return
            self.turn()
            n += 1


if bug == "exit-at-once":
    sys.exit(0)
if bug in ("children", "daemon"):  # in its group, or in a session of their own
    for _ in range(3):
        subprocess.Popen(["sleep", "1001"], start_new_session=bug == "daemon", preexec_fn=lambda: signal.signal(signal.SIGTERM, signal.SIG_IGN))
if bug == "deaf":  # to SIGTERM
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
if bug == "mute":
    time.sleep(1000)
Controller(address(me), address(plant)).run()
