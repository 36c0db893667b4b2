#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A stranger's client: takes one scan from a Biteline sensor, with Python's own library and docs/protocol.md alone.

    stranger.py HOST PORT [--start]        one line of JSON for each profile, then one for the scan's end

Loopback without keys only: keys need CurveZMQ, which python3-zmq has.
"""
import json
import socket
import struct
import sys

FLOATS = ["x", "y", "z", "sigma_mm", "row_px", "sigma_row_px", "amplitude", "width_px"]
DENSE, SPARSE = (1, 2, 3, 4), (0, 1, 2, 4)
HOST_HELLO, SENSOR_HELLO, PROFILE, HEALTH, END, ACK, CONTROL, REPLY, GAP, BYE = range(1, 11)

# --- ZMTP 3.0, the NULL mechanism: greeting, READY, then frames -------------------------------------------------
class Peer:
    def __init__(self, host, port):
        self.tcp = socket.create_connection((host, port), timeout=10)
        self.tcp.sendall(b"\xff" + bytes(8) + b"\x7f\x03\x00" + b"NULL".ljust(20, b"\0") + bytes(32))
        assert self.take(64)[9:11] == b"\x7f\x03", "no ZeroMQ 3 there"
        self.send(b"\x05READY\x0bSocket-Type" + struct.pack(">I", 6) + b"DEALER", flags=4)

    def take(self, size):
        data = b""
        while len(data) < size:
            data += self.tcp.recv(size - len(data)) or sys.exit("the sensor hung up")
        return data

    def send(self, body, flags=0):
        head = bytes([flags, len(body)]) if len(body) < 256 else struct.pack(">BQ", flags | 2, len(body))
        self.tcp.sendall(head + body)

    def receive(self):
        while True:
            flags = self.take(1)[0]
            body = self.take(struct.unpack(">Q", self.take(8))[0] if flags & 2 else self.take(1)[0])
            if not flags & 4:
                return body
            if body[:5] == b"\x04PING":
                self.send(b"\x04PONG" + body[7:], flags=4)

def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 & -(crc & 1))
    return struct.pack("<I", crc ^ 0xFFFFFFFF)

# --- FlatBuffers by hand ------------------------------------------------------------------------------------------
class Table:
    def __init__(self, data, at):
        self.data, self.at = data, at
        self.vtable = at - self.read("i", at)

    def read(self, form, at):
        return struct.unpack_from("<" + form, self.data, at)[0]

    def place(self, slot):  # of a field; 0: absent
        inside = 4 + 2 * slot < self.read("H", self.vtable)
        offset = self.read("H", self.vtable + 4 + 2 * slot) if inside else 0
        return self.at + offset if offset else 0

    def number(self, slot, form, default=0):
        return self.read(form, self.place(slot)) if self.place(slot) else default
    def motion(self, slot):  # rotation row by row, then translation in mm
        return struct.unpack_from("<12d", self.data, self.place(slot))

    def follow(self, slot):
        return self.place(slot) + self.read("I", self.place(slot))
    def table(self, slot):
        return Table(self.data, self.follow(slot))

    def bytes(self, slot):
        return self.data[self.follow(slot) + 4 :][: self.read("I", self.follow(slot))]

def layout(at, fields):
    """A table of numbers at `at`; a field is its struct form and value, form "R": the place of another table."""
    head, body = [], b""
    for form, value in fields:
        size = struct.calcsize("<" + form.replace("R", "I"))
        body += bytes(-(4 + len(body)) % size)
        head.append(4 + len(body))
        body += struct.pack("<" + form.replace("R", "I"), value)
    vtable = struct.pack("<%dH" % (2 + len(head)), 4 + 2 * len(head), 4 + len(body), *head)
    vtable += bytes(-len(vtable) % 8)
    body = bytearray(body)
    for (form, value), offset in zip(fields, head):
        if form == "R":
            struct.pack_into("<I", body, offset - 4, value - (at + len(vtable) + offset) & 0xFFFFFFFF)
    return vtable + struct.pack("<i", len(vtable)) + body + bytes(-(4 + len(body)) % 8), at + len(vtable)

def message(scan_id, kind, fields):
    for body_at in (0, 8 + len(layout(8, [("H", 1), ("Q", 0), ("Q", 0), ("B", 0), ("R", 8)])[0])):
        body, table = layout(body_at, fields)
        envelope, root = layout(8, [("H", 1), ("Q", scan_id), ("Q", 0), ("B", kind), ("R", table)])
    data = struct.pack("<I4s", root, b"BTLN") + envelope + body
    return data + crc32c(data)

def unpack(packed, count, lengths, step):
    at, predicted, values = (count + 3) // 4, 0, []
    for i in range(count):
        size = lengths[packed[i // 4] >> 2 * (i % 4) & 3]
        coded = int.from_bytes(packed[at : at + size], "little")
        at += size
        values.append((predicted + (coded >> 1 ^ -(coded & 1))) & 0xFFFFFFFF)
        predicted = values[-1] + step
    assert at == len(packed)
    return values

def read_profile(table):
    read, count = table.number, table.number(6, "I")
    profile = {"sequence": read(0, "Q"), "frame_sequence": read(1, "Q"), "exposure_mid_ns": read(2, "q"), "flags": read(5, "I"),
               "T_base_flange": table.motion(3), "encoder_ticks": read(18, "q", None), "speckle_contrast": read(19, "f", None)}
    for i, name in enumerate(FLOATS):
        bits = unpack(table.bytes(7 + i), count, DENSE, 0)
        profile[name] = struct.unpack("<%df" % count, struct.pack("<%dI" % count, *bits))
    for slot, name, step in ((15, "column", 1), (16, "point_flags", 0), (17, "peak_count", 0)):
        profile[name] = unpack(table.bytes(slot), count, SPARSE, step)
    return profile

def main():
    peer = Peer(sys.argv[1], int(sys.argv[2]))
    peer.send(message(0, HOST_HELLO, []))
    scan_id, expected = None, 0
    while True:
        data = peer.receive()
        assert data[4:8] == b"BTLN" and crc32c(data[:-4]) == data[-4:]
        envelope = Table(data, struct.unpack_from("<I", data)[0])
        kind, sequence = envelope.number(3, "B"), envelope.number(2, "Q")
        body = envelope.table(4)
        if kind == SENSOR_HELLO and envelope.number(1, "Q") != scan_id:
            if scan_id is None and "--start" in sys.argv:
                peer.send(message(0, CONTROL, [("I", 1), ("B", 0)]))
            scan_id, expected = envelope.number(1, "Q"), 0
            print(json.dumps({"T_flange_cam": body.table(9).motion(11)}))
        if envelope.number(1, "Q") == scan_id and kind in (PROFILE, END) and sequence == expected:
            expected += 1
            print(json.dumps(read_profile(body) if kind == PROFILE else {"end": body.number(0, "H")}))
        peer.send(message(scan_id or 0, ACK, [("Q", expected)]))
        if kind == END and expected == sequence + 1:
            peer.tcp.shutdown(socket.SHUT_WR)  # what came meanwhile is read, or the last Ack is lost with it
            while peer.tcp.recv(65536):
                pass
            return

main()
