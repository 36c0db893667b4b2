#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reader_test.py SENSOR SERVICE SESSION SCAN_TO_PLY READ_LIVE: host/records/reader makes of a service's scan.btln the service's own cloud.

The last two are its examples in C++.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "host" / "records" / "reader"))
import biteline_scan  # noqa: E402


def read_cloud(file):
    """Places by profile and column, of any binary PLY."""
    import struct

    head, _, body = file.read_bytes().partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    count = next(int(words[2]) for words in lines if words[:2] == ["element", "vertex"])
    if b"format ascii" in head:
        names = [words[2] for words in lines if words[0] == "property"]
        rows = (dict(zip(names, map(float, line.split()))) for line in body.decode().splitlines())
        return {(row["profile"], row["column"]): (row["x"], row["y"], row["z"]) for row in rows}
    forms = {"float": "f", "double": "d", "ushort": "H", "uchar": "B", "uint": "I", "int": "i"}
    properties = [words for words in lines if words[0] == "property"]
    form, names = struct.Struct("<" + "".join(forms[words[1]] for words in properties)), [words[2] for words in properties]
    rows = (dict(zip(names, form.unpack_from(body, i * form.size))) for i in range(count))
    return {(row["profile"], row["column"]): (row["x"], row["y"], row["z"]) for row in rows}


def exact(scan):
    """Places by profile and column, in double precision."""
    points = ((profile["sequence"], point) for profile in biteline_scan.profiles(scan) for point in biteline_scan.points_base(profile))
    return {(sequence, point[3]): point[:3] for sequence, point in points}


def six_digits(number):
    return float(f"{number:.6g}")


def main():
    sensor, service, session, scan_to_ply, read_live = sys.argv[1:6]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        running = subprocess.Popen([sensor, "--source", "replay:" + session, "--exit-with-parent"], stdout=subprocess.PIPE)
        address = json.loads(running.stdout.readline())["endpoint"]
        # Part of a shoe: the line is refused, the cloud is there.
        kept = subprocess.run([service, "--sensor", address, "--out", folder, "--once", "--keep-recording"], capture_output=True)
        assert kept.returncode in (0, 3), kept.stderr
        running.wait(timeout=30)
        scan, cloud = folder / "scan-0001" / "scan.btln", read_cloud(folder / "scan-0001" / "cloud.ply")

        script = ROOT / "host" / "records" / "reader" / "biteline_scan.py"
        subprocess.run([sys.executable, script, scan, folder / "read.ply"], check=True)
        read = read_cloud(folder / "read.ply")
        assert read.keys() == cloud.keys() and len(read) > 1000
        worst_mm = max(abs(a - b) for key in cloud for a, b in zip(cloud[key], read[key]))
        print(f"worst {worst_mm:.2e} mm")
        # The clouds hold places of up to some metres in 32-bit floats.
        assert worst_mm < 1e-3

        told = subprocess.run([scan_to_ply, scan, folder / "read_by_cpp.ply"], check=True, capture_output=True, text=True).stdout
        assert read_cloud(folder / "read_by_cpp.ply") == {key: tuple(map(six_digits, place)) for key, place in exact(scan).items()}
        whole = len(list(biteline_scan.profiles(scan)))
        assert told == f"{whole} profiles, {len(cloud)} points, whole\n", told
        running = subprocess.Popen([sensor, "--source", "replay:" + session, "--exit-with-parent"], stdout=subprocess.PIPE)
        address = json.loads(running.stdout.readline())["endpoint"]
        told = subprocess.run([read_live, address], check=True, capture_output=True, text=True).stdout.splitlines()
        running.wait(timeout=30)
        assert told == [
            f"profile {p['sequence']}: {len(p['x'])} points, {len(list(biteline_scan.points_base(p)))} of them surface"
            for p in biteline_scan.profiles(scan)
        ] + ["end 0"], told

        # Cut in the last message, spoiled in the second profile: what stands before is there.
        data = scan.read_bytes()
        scan.write_bytes(data[:-1])
        assert len(list(biteline_scan.profiles(scan))) == whole  # the last message is the scan's end
        first = 8 + 4 + int.from_bytes(data[8:12], "little")
        second = first + 4 + int.from_bytes(data[first : first + 4], "little")
        spoiled = bytearray(data)
        spoiled[second + 300] ^= 0x10
        scan.write_bytes(spoiled)
        assert len(list(biteline_scan.profiles(scan))) == 1
        told = subprocess.run([scan_to_ply, scan, folder / "one.ply"], check=True, capture_output=True, text=True).stdout
        assert told.startswith("1 profiles, ") and told.endswith("cut\n"), told
        assert subprocess.run([scan_to_ply, session, folder / "none.ply"], capture_output=True).returncode == 2


main()
