#!/usr/bin/env python3
"""lockstep_client.py PORT PLANT_PORT TURNS [STOP_AT] - a controller of plain sockets for contactplant run --lockstep.
It knows docs/reference/protocol.md and nothing of this repository's code: opens a session, starts the plant, streams
a force in each bus frame, stops. TURNS 0: it only says empty words. At turn STOP_AT it stops itself with SIGSTOP.
Prints its exchanges per second."""
import os
import signal
import socket
import struct
import sys
import time

ENABLE, CONTROL, STREAM, STATUS, CONTACT, SYNC = 0x01, 0x02, 0x04, 0x10, 0x15, 0x16
START, STOP, MORE = 1, 2, 1388  # a packet of so many bytes says that another one follows
CRC = [0] * 256
for i in range(256):
    CRC[i] = i
    for _ in range(8):
        CRC[i] = (CRC[i] << 1 ^ 0x1D if CRC[i] & 0x80 else CRC[i] << 1) & 0xFF


class Client:
    def __init__(self, port, plant, base=0x200):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        self.socket.connect(("127.0.0.1", plant))
        self.base, self.session, self.session_seen, self.state = base, 0, None, 0
        self.frame = self.tick = self.sequence = 0
        self.force = 0.0
        self.counter, self.commands = {}, []

    def send(self, kind, payload):
        """payload: bytes 2..7. It goes out with the next word."""
        n = self.counter[kind] = (self.counter.get(kind, -1) + 1) % 15
        body, crc = bytes([n | self.session << 4]) + payload, 0
        for byte in struct.pack("<H", self.base + kind) + body:
            crc = CRC[crc ^ byte]
        self.commands.append(struct.pack(">IBB", self.base + kind, 8, crc) + body)

    def turn(self):
        """Says the word, and hears the bus frame that it begins. A plant that is not up yet refuses the first one."""
        word = struct.pack(">BBBH", 2, 0, self.sequence & 255, len(self.commands)) + b"".join(self.commands)
        self.commands = []
        answer = None
        while answer is None or len(answer) >= MORE:
            try:
                if answer is None:
                    self.socket.send(word)
                answer = self.socket.recv(2048)
            except ConnectionRefusedError:
                if self.sequence:
                    raise
                time.sleep(0.01)
                continue
            for at in range(5, len(answer), 13):
                self.hear(struct.unpack_from(">I", answer, at)[0] - self.base, answer, at + 5)
        self.sequence += 1

    def hear(self, kind, packet, at):
        if kind == STATUS:
            self.session_seen, self.state = packet[at + 1] >> 4, packet[at + 2] & 15
            self.frame = struct.unpack_from("<I", packet, at + 4)[0]
        elif kind == SYNC:
            self.tick = struct.unpack_from("<I", packet, at + 4)[0]
        elif kind == CONTACT:
            self.force = struct.unpack_from("<h", packet, at + 4)[0]

    def enable(self):
        self.send(ENABLE, struct.pack("<BBI", 1, 0, self.frame))

    def control(self, operation):
        self.send(CONTROL, struct.pack("<BBI", operation, 255 - operation, self.frame))

    def open(self):
        """A session; again where the last one has to time out first."""
        while self.session_seen is None:
            self.turn()
        while self.session == 0 or self.session_seen != self.session or self.state == 0:
            self.session = self.session_seen % 15 + 1
            self.enable()
            self.turn()


def main():
    port, plant, turns, stop_at = [int(x) for x in (sys.argv[1:] + ["-1"])[:4]]
    client = Client(port, plant)
    client.open() if turns else client.turn()
    client.control(START) if turns else None
    begin, n = time.monotonic(), 0
    while n < turns or turns == 0:
        if n == stop_at:
            os.kill(os.getpid(), signal.SIGSTOP)
        if turns and n % 10 == 0:
            client.enable()
        if turns:
            client.send(STREAM, struct.pack("<Hf", client.tick // 64 & 0xFFFF, 1.0 + client.force % 7))
        client.turn()
        n += 1
    print("%d exchanges, %.0f/s" % (n, n / (time.monotonic() - begin)))
    client.control(STOP)
    client.turn()


if __name__ == "__main__":
    main()
