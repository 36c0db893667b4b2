#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reads scan.btln, the profiles that a service keeps (biteline-host --keep-recording), with Python's own library alone.

    biteline_scan.py scan.btln cloud.ply      the surface's points in base, mm

    import biteline_scan
    for profile in biteline_scan.profiles("scan.btln"):
        profile["x"], profile["point_flags"], profile["T_base_flange"], biteline_scan.points_base(profile)

The format: docs/protocol.md.  A cut or damaged file gives what stands before the damage.
"""
import struct
import sys

NOT_USABLE = 0x1A3  # profiles with one of these flags stay out of a cloud
NOT_SURFACE = 0x322  # points
FLOATS = ("x", "y", "z", "sigma_mm", "row_px", "sigma_row_px", "amplitude", "width_px")
INTEGERS = (("column", 1), ("point_flags", 0), ("peak_count", 0))
_SENSOR_HELLO, _PROFILE = 2, 3
_DENSE, _SPARSE = (1, 2, 3, 4), (0, 1, 2, 4)


def _crc_table():
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ (0x82F63B78 & -(byte & 1))
        yield byte


_CRC = tuple(_crc_table())


def _crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = crc >> 8 ^ _CRC[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


class _Table:
    """A FlatBuffers table; slots as in protocol.fbs."""

    def __init__(self, data, at):
        self.data, self.at = data, at
        self.vtable = at - struct.unpack_from("<i", data, at)[0]

    def place(self, slot):
        (size,) = struct.unpack_from("<H", self.data, self.vtable)
        offset = struct.unpack_from("<H", self.data, self.vtable + 4 + 2 * slot)[0] if 4 + 2 * slot < size else 0
        return self.at + offset if offset else None

    def number(self, slot, form):
        return struct.unpack_from("<" + form, self.data, self.place(slot))[0] if self.place(slot) else 0

    def motion(self, slot):
        return struct.unpack_from("<12d", self.data, self.place(slot))

    def follow(self, slot):
        return self.place(slot) + struct.unpack_from("<I", self.data, self.place(slot))[0]

    def bytes(self, slot):
        at = self.follow(slot)
        return self.data[at + 4 : at + 4 + struct.unpack_from("<I", self.data, at)[0]]


def _unpack(packed, count, lengths, step):
    at, predicted, values = (count + 3) // 4, 0, []
    for i in range(count):
        size = lengths[packed[i // 4] >> 2 * (i % 4) & 3]
        coded = int.from_bytes(packed[at : at + size], "little")
        at += size
        values.append((predicted + (coded >> 1 ^ -(coded & 1))) & 0xFFFFFFFF)
        predicted = values[-1] + step
    return values


def _messages(file):
    with open(file, "rb") as stream:
        if stream.read(8) != b"BTLNSCAN":
            raise ValueError(f"{file}: not a recorded scan")
        while len(head := stream.read(4)) == 4:
            data = stream.read(struct.unpack("<I", head)[0])
            if len(data) < struct.unpack("<I", head)[0] or len(data) < 12 or data[4:8] != b"BTLN":
                return
            if struct.pack("<I", _crc32c(data[:-4])) != data[-4:]:
                return
            yield _Table(data, struct.unpack_from("<I", data)[0])


def profiles(file):
    """Each profile as a dictionary: its numbers, and a list for each column; flags and units as in docs/protocol.md."""
    T_flange_cam = None
    for envelope in _messages(file):
        body = _Table(envelope.data, envelope.follow(4))
        if envelope.number(3, "B") == _SENSOR_HELLO:
            T_flange_cam = _Table(body.data, body.follow(9)).motion(11)
        if envelope.number(3, "B") != _PROFILE:
            continue
        count = body.number(6, "I")
        profile = {
            "sequence": body.number(0, "Q"),
            "frame_sequence": body.number(1, "Q"),
            "exposure_mid_ns": body.number(2, "q"),
            "T_base_flange": body.motion(3),
            "T_flange_cam": T_flange_cam,
            "flags": body.number(5, "I"),
            "encoder_ticks": body.number(18, "q") if body.place(18) else None,
            "speckle_contrast": body.number(19, "f") if body.place(19) else None,
        }
        for i, name in enumerate(FLOATS):
            bits = _unpack(body.bytes(7 + i), count, _DENSE, 0)
            profile[name] = struct.unpack(f"<{count}f", struct.pack(f"<{count}I", *bits))
        for i, (name, step) in enumerate(INTEGERS):
            profile[name] = _unpack(body.bytes(15 + i), count, _SPARSE, step)
        yield profile


def _apply(T, p):
    return tuple(sum(T[3 * row + k] * p[k] for k in range(3)) + T[9 + row] for row in range(3))


def points_base(profile):
    """The surface's points of a usable profile as (x, y, z, column) in base, mm."""
    if profile["flags"] & NOT_USABLE:
        return
    rows = zip(profile["x"], profile["y"], profile["z"], profile["column"], profile["point_flags"])
    for x, y, z, column, flags in rows:
        if not flags & NOT_SURFACE:
            yield (*_apply(profile["T_base_flange"], _apply(profile["T_flange_cam"], (x, y, z))), column)


def main():
    if len(sys.argv) != 3:
        sys.exit("biteline_scan.py scan.btln cloud.ply")
    points = [
        (*point[:3], profile["sequence"] & 0xFFFF, point[3])
        for profile in profiles(sys.argv[1])
        for point in points_base(profile)
    ]
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz") + "property ushort profile\nproperty ushort column\n"
    with open(sys.argv[2], "wb") as stream:
        stream.write((head + "end_header\n").encode())
        for point in points:
            stream.write(struct.pack("<3f2H", *point))
    print(f"{len(points)} points")


if __name__ == "__main__":
    main()
