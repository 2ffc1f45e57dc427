#!/usr/bin/env python3
"""test_blocks.py PROGRAM - blocks of converter codes over real UDP, by a board of plain sockets that knows
docs/reference/protocol.md alone. Prints `ok` and `FAIL` lines and `N passed, N failed`.

test_blocks.py PROGRAM --realtime compares a closed loop in real time with the one in lockstep.
test_blocks.py PROGRAM --throughput [BLOCKS] prints the samples a second of a board in Python, in lockstep."""
import math
import os
import re
import signal
import struct
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from lockstep_client import START, STOP, SYNC, Client  # noqa: E402
from processes import free_ports  # noqa: E402
from verdicts import conclude, equal, verdict  # noqa: E402

DAC, REPLY, ADC = 0x0F, 0x11, 0x24
LATE, FULL = 2, 6
program = sys.argv[1] if len(sys.argv) > 1 else "build/contactplant"


class Board(Client):
    """Hears its blocks as self.block, a list of (tick, deflection, z), and causes of refusals as self.causes."""

    def __init__(self, port, lockstep):
        super().__init__(("127.0.0.1", port + 1), ("127.0.0.1", port))
        self.socket.settimeout(60)
        self.lockstep, self.block, self.causes, self.syncs = lockstep, [], [], 0

    def hear(self, kind, packet, at):
        super().hear(kind, packet, at)
        self.syncs += kind == SYNC
        if kind == ADC:
            self.block.append(struct.unpack_from("<Hhh", packet, at + 2))
        if kind == REPLY and packet[at + 2] == DAC:
            self.causes.append(packet[at + 3])

    def dac(self, tick, dither, z):
        self.send(DAC, struct.pack("<Hhh", tick & 0xFFFF, dither, z))

    def turn(self):
        """Says its word and hears a bus frame; in real time the next one that comes."""
        self.block = []
        if self.lockstep:
            return super().turn()
        self.socket.send(struct.pack(">BBBH", 2, 0, self.sequence & 255, len(self.commands)) + b"".join(self.commands))
        self.commands, before = [], self.syncs
        self.sequence += 1
        while self.syncs == before:
            packet = self.socket.recv(2048)
            for at in range(5, len(packet), 13):
                self.hear(struct.unpack_from(">I", packet, at)[0] - self.base, packet, at + 5)


def start(port, lockstep, rate, n, *options):
    """A plant whose samples are 1/36 of a period of its lever, n in a bus frame."""
    child = subprocess.Popen([program, "run", "microscope", "--rate", str(rate), "--substeps", str(n), "--dilation",
                              str(36 * 70e3 / (rate * n)), "--set", "z_loop=0", "--set", "drive_m=0", "--set",
                              "temperature_K=295", "--bus", "udp:%d" % port, "--peer", "127.0.0.1:%d" % (port + 1)] +
                             (["--lockstep"] if lockstep else []) + list(options),
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if not lockstep:  # a datagram to nobody is refused
        time.sleep(1.0)
    return child


def exchange(lockstep, rate, n, blocks, law, *options):
    """A session of so many blocks. law(tick, heard): the codes for a tick; heard: what was read in it a block before.
    Returns the codes that were read, the causes of refusals, and what the plant prints."""
    port = free_ports(2, 12000)
    child = start(port, lockstep, rate, n, *options)
    board, read, first = Board(port, lockstep), [], 0
    try:
        board.open()
        board.control(START)
        heard = [(0, 0, 0)] * n
        for b in range(blocks):
            if b % 10 == 0:
                board.enable()
            for k in range(n):
                board.dac(b * n + k, *law(b * n + k, heard[k % len(heard)]))
            begin = time.monotonic() if b == 0 else begin
            board.turn()
            heard = board.block or heard
            read += board.block
        board.seconds = time.monotonic() - begin
        board.control(STOP)
        board.turn()
    finally:
        board.socket.close()
        child.send_signal(signal.SIGINT)
        out = child.communicate(timeout=60)
    verdict("the plant ends well", child.returncode == 0, out[1])
    return read, board, out[0]


def hash_of(out):
    return re.search(r"tick \d+, hash [0-9a-f]+", out).group()


def open_loop(tick, heard):
    return tick * 373 % 2001 - 1000, tick * 7 % 901 - 450


def test_delay():
    print("--- what a board sends back what it hears comes again a block later", flush=True)
    n, sine = 16, lambda k: round(2000 * math.sin(2 * math.pi * k / 16))
    read, board, _ = exchange(True, 1000, n, 30, lambda t, heard: (0, sine(t) if t < n else heard[2]))
    equal("samples", len(read), 30 * n)
    equal("their ticks are all of them", [r[0] for r in read], list(range(30 * n)))
    equal("the sine, block for block", [r[2] for r in read], [sine(t) for t in range(30 * n)])
    equal("refusals", board.causes, [])


def test_bits():
    print("--- equal bits", flush=True)
    blocks = exchange(True, 1000, 5, 60, open_loop)
    single = exchange(True, 5000, 1, 300, open_loop)
    equal("hash of 60 blocks of 5, and of 300 frames of one", hash_of(blocks[2]), hash_of(single[2]))
    verdict("and all codes", blocks[0] == single[0] and len(blocks[0]) == 300)
    law = lambda t, heard: (1500 if t % 36 < 18 else -1500, (heard[2] + heard[1] // 16 - 3) % 4001 - 2000)
    unpaced = exchange(True, 20, 5, 40, law)
    verdict("  the lever moves", max(abs(r[1]) for r in unpaced[0]) > 50)
    return law, unpaced


def test_realtime():
    """Needs a machine that keeps up."""
    law, unpaced = test_bits()
    live = exchange(False, 20, 5, 40, law)
    equal("refusals in real time", live[1].causes, [])
    verdict("a closed loop in real time: the codes of lockstep", live[0] == unpaced[0] and len(live[0]) == 200)


def test_refusals():
    print("--- what does not fit", flush=True)
    read, board, _ = exchange(True, 1000, 33, 1, open_loop)
    equal("33 samples in a frame: causes", sorted(set(board.causes)), [FULL])
    equal("  codes read", read, [])
    read, board, out = exchange(True, 1000, 5, 3, lambda t, heard: (0, 100 + t), "--set", "z_m_per_V=50e-9")
    equal("another gain of z: codes", [r[2] for r in read], [100 + t for t in range(15)])
    port = free_ports(2, 12000)
    child, board = start(port, True, 1000, 5), Board(port, True)
    board.open()
    board.control(START)
    for t in range(5):
        board.dac(t, 0, 10 * t)
    board.turn()
    board.turn()
    equal("no block: z holds", [r[2] for r in board.block], [40] * 5)
    board.dac(3, 0, 7)
    board.turn()
    equal("a late one", board.causes, [LATE])
    equal("  does nothing", [r[2] for r in board.block], [40] * 5)
    board.control(STOP)
    board.turn()
    equal("a stop ends the exchange", board.block, [])
    board.socket.close()
    child.send_signal(signal.SIGINT)
    out = child.communicate(timeout=60)[0]
    equal("  missed samples are counted", re.search(r"^stream_missed +(\d+)", out, re.M).group(1), "10")


def throughput(blocks):
    for n in (1, 5, 16, 32):
        read, board, _ = exchange(True, 1000, n, blocks, lambda t, heard: (100, 200))
        print("blocks of %2d: %6.0f samples/s, %5.0f exchanges/s" % (n, len(read) / board.seconds, blocks / board.seconds))


if "--throughput" in sys.argv:
    throughput(int((sys.argv + ["2000"])[3]))
    sys.exit(0)
if "--realtime" in sys.argv:
    test_realtime()
    conclude()
test_delay()
test_bits()
test_refusals()
conclude()
