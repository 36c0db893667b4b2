#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""stranger_test.py SENSOR TOOL SESSION: what the stranger's client makes of the wire is the cloud of `biteline replay`."""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import encoder_counts  # noqa: E402

NOT_USABLE, NOT_SURFACE = 0x1A3, 0x322  # docs/protocol.md, the tables of flags
MOST_LINES = 150


def transform(T, p):
    return [sum(T[3 * row + k] * p[k] for k in range(3)) + T[9 + row] for row in range(3)]


def read_cloud(file):
    head, _, body = file.read_bytes().partition(b"end_header\n")
    lines = head.decode().split("\n")
    count = int(next(line for line in lines if line.startswith("element vertex")).split()[2])
    forms = {"float": "f", "ushort": "H", "ulong": "Q", "uint": "I", "int": "i", "uchar": "B", "double": "d"}
    properties = [line.split() for line in lines if line.startswith("property") and " list " not in line]
    form = struct.Struct("<" + "".join(forms[p[1]] for p in properties))
    names = [p[2] for p in properties]
    for i in range(count):
        yield dict(zip(names, form.unpack_from(body, i * form.size)))


def check_examples(source):
    """The document's bytes are those that the client makes and reads."""
    known = {"__name__": "stranger"}
    exec(source.split("def main")[0], known)  # without its last line, which runs it
    document = pathlib.Path(__file__).parents[2].joinpath("docs", "protocol.md").read_text().replace("\n", " ")
    assert known["message"](0, known["HOST_HELLO"], []).hex(" ") in document
    assert known["message"](0x1122334455667789, known["ACK"], [("Q", 5)]).hex(" ") in document
    assert known["crc32c"](b"123456789") == struct.pack("<I", 0xE3069283) and "0xE3069283" in document
    for packed, values, lengths, step in (
        ("0b 00 00 90 82 00 00 01 00", struct.unpack("<3I", struct.pack("<3f", 12.5, 12.53125, 12.53125)), "DENSE", 0),
        ("42 00 34 03 04", (410, 411, 412, 415, 416), "SPARSE", 1),
    ):
        assert packed in document
        assert known["unpack"](bytes.fromhex(packed), len(values), known[lengths], step) == list(values)


def take_scan(client, sensor, session):
    """What the client tells of a replay, line by line."""
    program = subprocess.Popen([sensor, "--source", "replay:" + str(session), "--exit-with-parent"], stdout=subprocess.PIPE)
    address = json.loads(program.stdout.readline())["endpoint"].removeprefix("tcp://").rsplit(":", 1)
    told = subprocess.run([sys.executable, client, *address], capture_output=True, check=True, text=True).stdout
    assert program.wait(timeout=30) == 0
    return [json.loads(line) for line in told.splitlines()]


def main():
    sensor, tool, session = sys.argv[1:4]
    client = pathlib.Path(__file__).with_name("stranger.py")
    assert len(client.read_text().splitlines()) <= MOST_LINES
    check_examples(client.read_text())
    with tempfile.TemporaryDirectory() as folder:
        # Part of a shoe: the line is refused, the cloud is there.
        replay = subprocess.run([tool, "--quiet", "replay", session, "--out", folder], capture_output=True)
        assert replay.returncode in (0, 3), replay.stderr
        cloud = {(p["profile"], p["column"]): (p["x"], p["y"], p["z"]) for p in read_cloud(pathlib.Path(folder, "cloud.ply"))}
    hello, *profiles, end = take_scan(client, sensor, session)
    assert end == {"end": 0}, end
    assert [p["sequence"] for p in profiles] == list(range(len(profiles)))
    worst_mm, points = 0, 0
    for p in profiles:
        if p["flags"] & NOT_USABLE:
            continue
        for x, y, z, column, flags in zip(p["x"], p["y"], p["z"], p["column"], p["point_flags"]):
            if flags & NOT_SURFACE:
                continue
            base = transform(p["T_base_flange"], transform(hello["T_flange_cam"], (x, y, z)))
            worst_mm = max(worst_mm, *(abs(a - b) for a, b in zip(base, cloud[p["sequence"], column])))
            points += 1
    print(f"{len(profiles)} profiles, {points} points, worst {worst_mm:.2e} mm")
    assert points == len(cloud) > 1000
    # The cloud holds places of up to some metres in 32-bit floats.
    assert worst_mm < 1e-3

    assert all(p["encoder_ticks"] is None for p in profiles)
    with tempfile.TemporaryDirectory() as folder:
        copy, counts = encoder_counts.counted(session, folder)
        having = encoder_counts.check(copy, counts, take_scan(client, sensor, copy)[1:-1])
    print(f"an encoder's count in {having} profiles")


main()
