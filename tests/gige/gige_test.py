#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""gige_test.py FACE SENSOR SESSION: the sensor as a GigE Vision device, by a client written from the standard.

The frames of the face, and the chunk with each, against the profiles that the native client takes from the same recording:
the same bits, also where one packet in a hundred is lost.  Then who may look, command and connect.
"""
import json
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import time
import xml.dom.minidom

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import encoder_counts
from gige_client import PRIVILEGE, STREAM_ADDRESS, Client, Refused, read_chunks, read_leader

STRANGER = pathlib.Path(__file__).parents[1] / "stranger" / "stranger.py"
ABC32F, AC16, C16 = 0x026000C0, 0x022000BB, 0x011000B8
LINES_CHUNK = 0x4C4E0001
NOT_SURFACE = 0x322  # docs/protocol.md
NO_DEPTH = 65535
ADDRESS = "127.0.0.1"


def start_sensor(sensor, session):
    program = subprocess.Popen([sensor, "--source", "replay:" + session, "--exit-with-parent"], stdout=subprocess.PIPE)
    return program, json.loads(program.stdout.readline())["endpoint"]


def native_profiles(sensor, session):
    program, endpoint = start_sensor(sensor, session)
    address = endpoint.removeprefix("tcp://").rsplit(":", 1)
    told = subprocess.run([sys.executable, STRANGER, *address], capture_output=True, check=True, text=True).stdout
    program.wait(timeout=30)
    return [row for row in map(json.loads, told.splitlines()) if "sequence" in row]


def start_face(face, endpoint, *options):
    program = subprocess.Popen([face, "--sensor", endpoint, "--interface", ADDRESS, "--exit-with-parent", *options],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    line = program.stdout.readline()
    if not line:
        told = program.communicate()[1]
        if "port 3956" in told:
            print("skipped: " + told)
            sys.exit(77)
        raise AssertionError(told)
    return program


def stop(program):
    program.terminate()
    out, err = program.communicate(timeout=30)
    assert program.returncode == 0, err
    return out


def register_of(description, name):
    """Where a feature's register lies."""
    found = re.search(r'Name="%s(?:Register)?"[^>]*><Address>(0x[0-9a-f]+)' % name, description)
    return int(found.group(1), 16)


def float_of(bits):
    return struct.unpack(">f", struct.pack(">I", bits))[0]


def surface_of(profile):
    """The brightest point of each column that is surface."""
    best = {}
    for i, (column, flags, amplitude) in enumerate(zip(profile["column"], profile["point_flags"], profile["amplitude"])):
        if not flags & NOT_SURFACE and (column not in best or amplitude > profile["amplitude"][best[column]]):
            best[column] = i
    return {column: tuple(profile[axis][i] for axis in "xyz") for column, i in best.items()}


def wait_for_head(client, width):
    """The face asks the sensor for it as soon as both run."""
    for _ in range(200):
        if client.read(width) > 0:
            return client.read(width)
        time.sleep(0.05)
    raise AssertionError("no head")


def acquire(client, profiles, lines):
    """Leaders and payloads of one scan's frames."""
    frames = math.ceil(len(profiles) / lines)
    client.write(client.start, 1)
    got = {}
    for _ in range(20_000):
        quiet = not client.hear(0.05)
        for block in range(1, frames + 1):
            if block not in got and client.whole(block):
                got[block] = client.whole(block)
            elif block not in got and quiet and (block == 1 or client.frames):
                client.ask_for_missing(block)
        if quiet:
            client.heartbeat()
        if len(got) == frames:
            break
    assert sorted(got) == list(range(1, frames + 1)), (sorted(got), frames)
    return [got[block] for block in sorted(got)]


def check_line(form, line, profile, scale, offset, columns, across):
    truth = surface_of(profile)
    assert truth
    for column in range(columns):
        if form == ABC32F:
            values = struct.unpack_from("<3f", line, 12 * column)
            want = truth.get(column)
            assert values == want if want else all(map(math.isnan, values)), (column, values, want)
        elif form == AC16:
            x, z = struct.unpack_from("<2H", line, 4 * column)
            if column not in truth:
                assert (x, z) == (NO_DEPTH, NO_DEPTH), (column, x, z)
            else:
                assert abs(across[1] + across[0] * x - truth[column][0]) <= 0.5001 * across[0], (column, x, truth[column])
                assert abs(offset + scale * z - truth[column][2]) <= 0.5001 * scale, (column, z, truth[column])
        else:
            value = struct.unpack_from("<H", line, 2 * column)[0]
            if column not in truth:
                assert value == NO_DEPTH, (column, value)
            else:
                assert abs(offset + scale * value - truth[column][2]) <= 0.5001 * scale, (column, value, truth[column])
    return len(truth)


def exposure_of(session):
    """In us, as the recording's head has it."""
    text = pathlib.Path(session, "cam0", "sensor.yaml").read_text()
    return int(re.search(r"^exposure_ns: (\d+)$", text, re.M).group(1)) / 1000


def check_scan(face, sensor, session, profiles, form, lines, chunks, lost_ratio):
    running, endpoint = start_sensor(sensor, session)
    device = start_face(face, endpoint, "--allow-control")
    client = Client(ADDRESS, lost_ratio=lost_ratio)
    description = client.description()
    xml.dom.minidom.parseString(description)
    place = {name: register_of(description, name) for name in (
        "Width", "Height", "PixelFormat", "PayloadSize", "ChunkModeActive", "AcquisitionStart",
        "Scan3dCoordinateScale", "Scan3dCoordinateOffset", "Scan3dInvalidDataValue")}
    columns = wait_for_head(client, place["Width"])
    client.start = place["AcquisitionStart"]
    client.take_control()
    client.aim_stream(1400)
    client.write(place["PixelFormat"], form)
    client.write(place["Height"], lines)
    client.write(place["ChunkModeActive"], chunks)
    scale = float_of(client.read(place["Scan3dCoordinateScale"] + 8))
    offset = float_of(client.read(place["Scan3dCoordinateOffset"] + 8))
    across = tuple(float_of(client.read(place["Scan3dCoordinate" + name])) for name in ("Scale", "Offset"))
    invalid = float_of(client.read(place["Scan3dInvalidDataValue"]))
    assert math.isnan(invalid) if form == ABC32F else invalid == NO_DEPTH
    size = client.read(place["PayloadSize"])
    frames = acquire(client, profiles, lines)
    exposure_us = exposure_of(session)
    line_bytes = columns * {ABC32F: 12, AC16: 4, C16: 2}[form]
    points = 0
    for i, (leader, payload) in enumerate(frames):
        assert len(payload) == size
        facts = read_leader(leader)
        assert (facts["format"], facts["width"], facts["height"]) == (form, columns, lines), facts
        assert facts["type"] == (0x4001 if chunks else 0x0001)
        records = read_chunks(payload)[LINES_CHUNK] if chunks else b""
        for row in range(lines):
            line = payload[row * line_bytes :][:line_bytes]
            number = i * lines + row
            record = struct.unpack_from(">QQQII12ddQqI4x", records, 160 * row) if chunks else None
            if number >= len(profiles):
                assert not chunks or record[4] == 0
                continue
            profile = profiles[number]
            points += check_line(form, line, profile, scale, offset, columns, across)
            if chunks:
                assert record[2:5] == (profile["sequence"], profile["flags"], 1), record
                assert list(record[5:17]) == profile["T_base_flange"]
                assert record[17] == exposure_us and record[18] == profile["frame_sequence"], record
                assert (record[19] if record[20] else None) == profile["encoder_ticks"], record
                assert row or record[0] == facts["stamp"]
    told = stop(device)
    running.terminate()
    running.wait()
    assert (client.lost > 0) == (lost_ratio > 0)
    print(f"{form:#x}, {lines} lines a frame, chunks {chunks}: {len(frames)} frames, {points} points the same; "
          f"{client.lost} packets lost; {told.strip()}", flush=True)


def refused(status, ask, *arguments):
    try:
        ask(*arguments)
    except Refused as refusal:
        assert str(refusal) == hex(status), refusal
        return
    raise AssertionError(f"taken: {arguments}")


def check_rights(face, sensor, session):
    running, endpoint = start_sensor(sensor, session)
    device = start_face(face, endpoint)  # looks on: no --allow-control
    first, second = Client(ADDRESS), Client(ADDRESS)
    description = first.description()
    width, height, start = (register_of(description, n) for n in ("Width", "Height", "AcquisitionStart"))
    wait_for_head(first, width)
    found = first.ask(0x02, b"")
    assert len(found) == 248 and found[0x48:0x50] == b"Biteline" and found[0x24:0x28] == b"\x7f\0\0\1", found
    first.take_control()
    assert second.read(height) == 1  # everybody may read
    refused(0x8006, second.write, height, 2)
    refused(0x8006, second.write, PRIVILEGE, 2)
    refused(0x8002, first.write, height, 0)
    refused(0x8002, first.write, start, 1)  # no stream yet
    refused(0x8004, first.write, width, 1)
    refused(0x8003, first.read, 0xA800)
    refused(0x8005, first.read, 0xA001)
    refused(0x8001, first.ask, 0x00C0, b"")
    refused(0x8006, first.write, STREAM_ADDRESS, 0x7F000009)  # nobody is sent what he did not ask for
    first.write_memory(height, struct.pack(">I", 3))
    assert first.read(height, width)[0] == 3
    first.aim_stream(1400)
    first.write(0xD04, 0x80000000 | 2000)  # a test packet
    first.stream.settimeout(2)
    assert len(first.stream.recv(65536)) == 2000 - 28
    first.write(start, 1)
    refused(0x8004, first.write, height, 2)  # stands while frames come
    first.write(0x938, 500)  # heartbeat; then silence
    for _ in range(100):
        if second.read(PRIVILEGE) == 0:
            break
        time.sleep(0.05)
    second.take_control()
    assert second.read(start) == 0 and second.read(0xD00) == 0
    stop(device)
    running.terminate()
    running.wait()
    print("rights: one controls, all read, silence gives it back")


def check_interfaces(face):
    def told(*options, status=2):
        done = subprocess.run([face, "--sensor", "tcp://127.0.0.1:9", *options], capture_output=True, text=True, timeout=30)
        assert done.returncode == status, done
        return done.stderr

    assert "--interface is required" in told()
    assert "no interface nowhere" in told("--interface", "nowhere", status=4)  # its service tries again
    assert "reaches the camera at 127.0.0.1" in told("--interface", "lo", "--camera", "127.0.0.1")
    assert "'camera' is no IPv4 address" in told("--interface", "lo", "--camera", "camera")


def main():
    face, sensor, session = sys.argv[1:4]
    check_interfaces(face)
    profiles = native_profiles(sensor, session)
    trials = ((ABC32F, 1, 1, 0), (ABC32F, 3, 1, 0.02), (C16, 1, 0, 0.2), (C16, 3, 1, 0.1), (AC16, 2, 1, 0.02), (ABC32F, 64, 0, 0.02))
    for form, lines, chunks, lost_ratio in trials:
        check_scan(face, sensor, session, profiles, form, lines, chunks, lost_ratio)
    with tempfile.TemporaryDirectory() as folder:
        copy, counts = encoder_counts.counted(session, folder)
        profiles = native_profiles(sensor, str(copy))
        encoder_counts.check(copy, counts, profiles)
        check_scan(face, sensor, str(copy), profiles, ABC32F, 2, 1, 0.02)
    check_rights(face, sensor, session)


if __name__ == "__main__":
    main()
