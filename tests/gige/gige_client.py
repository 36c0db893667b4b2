# SPDX-License-Identifier: MIT
"""A GigE Vision client with Python's own library alone, written from the standard: commands, stream, resend.

The numbers are those of GigE Vision 2.0: command codes, bootstrap registers, and the packets of the stream.
"""
import random
import re
import socket
import struct

PORT = 3956
DISCOVERY, RESEND, READREG, WRITEREG, READMEM, WRITEMEM = 0x02, 0x40, 0x80, 0x82, 0x84, 0x86
PRIVILEGE, STREAM_PORT, PACKET_SIZE, STREAM_ADDRESS, FIRST_URL = 0xA00, 0xD00, 0xD04, 0xD18, 0x200
LEADER, TRAILER, DATA = 1, 2, 3


class Refused(Exception):
    """Status that the device answered with."""


class Client:
    def __init__(self, address, own="127.0.0.1", lost_ratio=0.0, seed=1):
        self.place = (address, PORT)
        self.own = own
        self.commands = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.commands.bind((own, 0))
        self.commands.settimeout(2)
        self.stream = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.stream.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        self.stream.bind((own, 0))
        self.id = 0
        self.random, self.lost_ratio = random.Random(seed), lost_ratio
        self.lost = self.asked_again = 0
        self.frames = {}  # block -> {packet number: bytes}, and "last": the trailer's number

    def send(self, code, body, flags=1):
        self.id = self.id % 0xFFFF + 1
        self.commands.sendto(struct.pack(">BBHHH", 0x42, flags, code, len(body), self.id) + body, self.place)

    def ask(self, code, body):
        self.send(code, body)
        while True:
            answer = self.commands.recv(1024)
            status, kind, size, number = struct.unpack_from(">HHHH", answer)
            if number == self.id:
                break
        assert kind == code + 1 and len(answer) == 8 + size, (hex(kind), size)
        if status:
            raise Refused(hex(status))
        return answer[8:]

    def read(self, *addresses):
        values = struct.unpack(">%dI" % len(addresses), self.ask(READREG, struct.pack(">%dI" % len(addresses), *addresses)))
        return values if len(values) > 1 else values[0]

    def write(self, address, value):
        assert self.ask(WRITEREG, struct.pack(">II", address, value)) == struct.pack(">HH", 0, 1)

    def write_memory(self, address, data):
        assert self.ask(WRITEMEM, struct.pack(">I", address) + data) == struct.pack(">HH", 0, len(data))

    def memory(self, address, size):
        data = b""
        while len(data) < size:
            part = min(512, size - len(data))
            data += self.ask(READMEM, struct.pack(">IHH", address + len(data), 0, part))[4:]
        return data

    def description(self):
        url = self.memory(FIRST_URL, 512).split(b"\0")[0].decode()
        address, size = re.fullmatch(r"Local:[^;]+;([0-9a-f]+);([0-9a-f]+)", url, re.I).groups()
        return self.memory(int(address, 16), int(size, 16)).decode()

    def take_control(self):
        self.write(PRIVILEGE, 2)

    def heartbeat(self):
        return self.read(PRIVILEGE)

    def aim_stream(self, packet_size):
        self.write(PACKET_SIZE, packet_size)
        self.write(STREAM_ADDRESS, struct.unpack(">I", socket.inet_aton(self.own))[0])
        self.write(STREAM_PORT, self.stream.getsockname()[1])

    def hear(self, timeout):
        """One packet of the stream; False: none came.  Of first sendings `lost_ratio` are thrown away."""
        self.stream.settimeout(timeout)
        try:
            packet = self.stream.recv(65536)
        except TimeoutError:
            return False
        status, block, number = struct.unpack_from(">HHI", packet)
        kind, number = number >> 24, number & 0xFFFFFF
        assert status == 0, hex(status)
        frame = self.frames.setdefault(block, {"seen": set()})
        if number not in frame["seen"] and self.random.random() < self.lost_ratio:
            frame["seen"].add(number)
            self.lost += 1
            return True
        frame["seen"].add(number)
        frame[number] = packet[8:]
        if kind == TRAILER:
            frame["last"] = number
        return True

    def whole(self, block):
        """The frame's leader and payload, once nothing of it is missing."""
        frame = self.frames.get(block, {})
        if "last" not in frame or any(n not in frame for n in range(frame["last"] + 1)):
            return None
        return frame[0], b"".join(frame[n] for n in range(1, frame["last"]))

    def ask_for_missing(self, block):
        """Of a frame that stays incomplete, its end included."""
        frame = self.frames.setdefault(block, {"seen": set()})
        last = frame.get("last", 0xFFFFFF)
        known = [n for n in range(min(last, max(frame["seen"], default=0)) + 1) if n not in frame]
        if "last" not in frame:
            known.append(max(frame["seen"], default=-1) + 1)
        for number in known:
            end = number if "last" in frame or number in frame["seen"] else 0xFFFFFF
            self.send(RESEND, struct.pack(">HHII", 0, block, number, end), flags=0)
            self.asked_again += 1


def read_leader(leader):
    kind, stamp, pixels, width, height = struct.unpack_from(">2xHQIII", leader)
    return {"type": kind, "stamp": stamp, "format": pixels, "width": width, "height": height}


def read_chunks(payload):
    """Chunks by their number, from the end."""
    chunks, end = {}, len(payload)
    while end > 0:
        number, size = struct.unpack_from(">II", payload, end - 8)
        chunks[number] = payload[end - 8 - size : end - 8]
        end -= 8 + size
    assert end == 0
    return chunks
