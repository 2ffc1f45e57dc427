"""A log whose every number is chosen here: rows at 1 kHz as candump writes them, of any length, with holes, values beyond the bus's
range, refusals, overruns and faults at places that are told."""
import math
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../cli"))
from lockstep_client import CRC  # noqa: E402

SUBSTEPS, TICK_S, COUNTERS = 64, 1e-3 / 64, 15
STATUS, REPLY, EVENT_TIME, EVENT_DATA, MOTION, CONTACT, SYNC, OVERRUN = range(0x210, 0x218)
PHASES = 1000  # rows of a period of the motion
BEYOND = -1 << 23
CASE = """[plant]
scene = hertz_rig
[controller]
builtin = keep
[case a]
over = 1.5 s
at 0.05 s arm force amplitude=30 N frequency=225 Hz
at 0.06 s fire force
expect touchdowns >= 0
"""


def word(ident, counter, high, body):
    """16 hex digits: CRC, COUNTER with four bits above it, six bytes."""
    rest = bytes([counter | high << 4]) + body
    crc = 0
    for byte in bytes([ident & 255, ident >> 8]) + rest:
        crc = CRC[crc ^ byte]
    return "%03X#%02X%s" % (ident, crc, rest.hex().upper())


def pair(ident, counter, closed, a, b):
    return word(ident, counter, closed, (a & 0xFFFFFF).to_bytes(3, "little") + (b & 0xFFFFFF).to_bytes(3, "little"))


def motion_of(frame):
    """Displacement and velocity in units of the bus: a swing that grows slowly."""
    phase = 2 * math.pi * (frame % PHASES) / PHASES * 225
    return round(20000 + 9000 * math.sin(phase)), round(9000 * math.cos(phase))


def table(ident, numbers):
    """Lines by counter and phase: what comes again and again is made once."""
    return [[pair(ident, c, 1, *numbers(p)) for p in range(PHASES)] for c in range(COUNTERS)]


def write(path, rows, holes=(), beyond=()):
    """Rows 0 .. rows - 1; those in holes [a, b) are left out, and so is their displacement's value in beyond."""
    motion = table(MOTION, motion_of)
    contact = table(CONTACT, lambda p: (max(motion_of(p)[0], 0), max(motion_of(p)[0], 0) // 4))
    lost = [r for a, b in holes for r in (a, b)]
    with open(path, "w", buffering=1 << 20) as f:
        out = []
        for n in range(rows):
            if lost and any(a <= n < b for a, b in holes):
                continue
            c = n % COUNTERS
            stamp = "(%010d.%06d) can0 " % (1732735000 + n // 1000, n % 1000 * 1000)
            tick = n * SUBSTEPS
            rest = bytes((c, n & 255, n >> 8 & 255, tick & 255, tick >> 8 & 255, tick >> 16 & 255, tick >> 24 & 255))
            crc = CRC[CRC[SYNC & 255] ^ SYNC >> 8]
            for byte in rest:
                crc = CRC[crc ^ byte]
            m = motion[c][n % PHASES]
            if beyond and any(a <= n < b for a, b in beyond):
                m = pair(MOTION, c, 1, BEYOND, motion_of(n)[1])
            out.append("%s216#%02X%s\n%s%s\n%s%s\n" % (stamp, crc, rest.hex().upper(), stamp, m, stamp, contact[c][n % PHASES]))
            if len(out) == 4096:
                f.write("".join(out))
                out = []
        f.write("".join(out))


def record(program, name="t", force=30):
    """A log of a run of the rig, NAME.a.log: it loses contact, and a session begins and ends."""
    with open(name + ".test", "w") as f:
        f.write(CASE.replace("amplitude=30", f"amplitude={force}"))
    subprocess.run([program, "test", name + ".test", "--log", "."], check=True, capture_output=True)
