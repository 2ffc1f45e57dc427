#!/usr/bin/env python3
"""can_peer.py INTERFACE BASE - a controller on python-can that knows docs/reference/protocol.md and nothing of this repository's
code: opens a session, starts, arms and fires a drive, streams samples, stops, opens the next one, ends. Prints
`ok`/`FAIL` lines."""
import struct
import sys
import time
import zlib

import can

FIRE, ENABLE, CONTROL, STREAM, ARM = 0x00, 0x01, 0x02, 0x04, 0x08
STATUS, REPLY, SYNC, INFO = 0x10, 0x11, 0x16, 0x21
START, STOP = 1, 2
SUBSTEPS = 64
IDENTITY, PARTS = 7, (0, 1, 2, 4, 8, 9, 10, 11, 12, 13)  # items of INFO
failed = 0


def verdict(name, good):
    global failed
    failed += not good
    print(("ok    " if good else "FAIL  ") + "python-can: " + name, flush=True)


def checksum(identifier, data):
    crc = 0
    for byte in bytes([identifier & 0xFF, identifier >> 8 & 0xFF]) + data[1:]:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc


class Peer:
    def __init__(self, interface, base):
        self.base = base
        self.bus = can.Bus(interface="socketcan", channel=interface,
                           can_filters=[{"can_id": base, "can_mask": 0x7C0, "extended": False}])
        self.counter = {}
        self.session = self.session_seen = self.state = self.frame = self.tick = None
        self.replies = []
        self.info = {}
        self.n_frames = self.n_bad = 0

    def send(self, kind, payload):
        """payload: bytes 2..7."""
        n = self.counter[kind] = (self.counter.get(kind, -1) + 1) % 15
        data = bytes([0, n | self.session << 4]) + payload
        identifier = self.base + kind
        data = bytes([checksum(identifier, data)]) + data[1:]
        self.bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))

    def hear(self, seconds):
        """Takes what arrives in this time."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            m = self.bus.recv(left)
            if m is None:
                return
            self.take(m.arbitration_id, bytes(m.data))

    def take(self, identifier, data):
        kind = identifier - self.base
        self.n_frames += 1
        if data[0] != checksum(identifier, data):
            self.n_bad += 1
        elif kind == STATUS:
            self.session_seen, self.state = data[1] >> 4, data[2] & 15
            self.frame = struct.unpack_from("<I", data, 4)[0]
        elif kind == SYNC:
            self.tick = struct.unpack_from("<I", data, 4)[0]
        elif kind == REPLY:
            self.replies.append((data[2], data[3], data[4] & 15))
        elif kind == INFO:
            self.info[data[2]] = struct.unpack_from("<f", data, 4)[0]

    def next_session(self):
        self.session = self.session_seen % 15 + 1
        self.enable(True)

    def enable(self, on):
        self.send(ENABLE, struct.pack("<BBI", on, 0, self.frame))

    def control(self, operation, argument):
        self.send(CONTROL, struct.pack("<BBI", operation, 255 - operation, argument))

    def arm(self, field, value):
        self.send(ARM, struct.pack("<BBf", field, 0, value))

    def identify(self, seconds=60.0):
        """True for a hertz_rig of our substeps whose identity is the check of the items that it tells."""
        end = time.monotonic() + seconds
        while not all(i in self.info for i in PARTS + (IDENTITY,)) and time.monotonic() < end:
            self.hear(0.05)
        told = b"".join(struct.pack("<Bf", i, self.info.get(i, 0.0)) for i in PARTS)
        return (self.info.get(IDENTITY) == zlib.crc32(told) & 0xFFFFFF and self.info[2] == SUBSTEPS
                and self.info[8] == zlib.crc32(b"hertz_rig") & 0xFFFFFF)

    def answered(self, kind, seconds=60.0):
        """The cause of the REPLY to the last command of this kind; None when none came."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for message, cause, counter in self.replies:
                if message == kind and counter == self.counter[kind]:
                    return cause
            self.hear(0.01)
        return None


def main():
    peer = Peer(sys.argv[1], int(sys.argv[2], 0))
    end = time.monotonic() + 60.0
    while (peer.frame is None or peer.tick is None) and time.monotonic() < end:
        peer.hear(0.05)
    verdict("the plant is heard, STATUS frame %s" % peer.frame, peer.frame is not None)
    if peer.frame is None:
        return 1
    peer.next_session()
    verdict("ENABLE opens session %d" % peer.session, peer.answered(ENABLE) == 0)
    known = peer.identify()
    verdict("INFO: the plant is a hertz_rig of %d substeps" % SUBSTEPS, known)
    if not known:
        return 1
    peer.control(START, peer.frame)
    verdict("CONTROL start", peer.answered(CONTROL) == 0)
    for field, value in enumerate((10.0, 200.0, 0.0, 0.05)):
        peer.arm(field, value)
    peer.hear(0.02)
    fired = peer.tick + 400 * SUBSTEPS
    peer.send(FIRE, struct.pack("<BBI", 1, 128, fired))
    verdict("FIRE 400 frames ahead", peer.answered(FIRE) == 0)
    for _ in range(20):
        peer.enable(True)
        peer.send(STREAM, struct.pack("<Hf", (peer.tick // SUBSTEPS + 50) & 0xFFFF, 1.5))
        peer.hear(0.02)
    end = time.monotonic() + 60.0
    while peer.tick <= fired and time.monotonic() < end:
        peer.hear(0.05)
    verdict("STATUS: session %s, state %s (RUNNING is 2)" % (peer.session_seen, peer.state),
            (peer.session_seen, peer.state) == (peer.session, 2))
    peer.send(FIRE, struct.pack("<BBI", 1, 0, peer.tick - 64))
    verdict("a FIRE for a tick that has passed is refused, nothing armed or late",
            peer.answered(FIRE) not in (0, None))
    peer.control(STOP, 0)
    verdict("CONTROL stop", peer.answered(CONTROL) == 0)
    stopped = peer.frame
    peer.control(START, stopped)
    verdict("CONTROL start of the session that stop has ended", peer.answered(CONTROL) == 4)
    end = time.monotonic() + 60.0
    while (peer.state != 4 or peer.frame <= stopped + 10) and time.monotonic() < end:
        peer.hear(0.05)
    peer.next_session()
    verdict("ENABLE opens session %d" % peer.session, peer.answered(ENABLE) == 0)
    peer.enable(False)
    verdict("ENABLE off", peer.answered(ENABLE) == 0)
    verdict("%d frames heard, %d with a bad checksum" % (peer.n_frames, peer.n_bad), peer.n_bad == 0)
    peer.bus.shutdown()
    return failed != 0


sys.exit(main())
