#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reader_test.py SENSOR SERVICE SESSION: host/reader makes of a service's scan.btln the service's own cloud."""
import json
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "host" / "reader"))
import biteline_scan  # noqa: E402


def read_cloud(file):
    """Places by profile and column, of any binary PLY."""
    import struct

    head, _, body = file.read_bytes().partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    count = next(int(words[2]) for words in lines if words[:2] == ["element", "vertex"])
    forms = {"float": "f", "double": "d", "ushort": "H", "uchar": "B", "uint": "I", "int": "i"}
    properties = [words for words in lines if words[0] == "property"]
    form, names = struct.Struct("<" + "".join(forms[words[1]] for words in properties)), [words[2] for words in properties]
    rows = (dict(zip(names, form.unpack_from(body, i * form.size))) for i in range(count))
    return {(row["profile"], row["column"]): (row["x"], row["y"], row["z"]) for row in rows}


def main():
    sensor, service, session = sys.argv[1:4]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        running = subprocess.Popen([sensor, "--source", "replay:" + session, "--exit-with-parent"], stdout=subprocess.PIPE)
        address = json.loads(running.stdout.readline())["endpoint"]
        # Part of a shoe: the line is refused, the cloud is there.
        kept = subprocess.run([service, "--sensor", address, "--out", folder, "--once", "--keep-recording"], capture_output=True)
        assert kept.returncode in (0, 3), kept.stderr
        running.wait(timeout=30)
        scan, cloud = folder / "scan-0001" / "scan.btln", read_cloud(folder / "scan-0001" / "cloud.ply")

        script = ROOT / "host" / "reader" / "biteline_scan.py"
        subprocess.run([sys.executable, script, scan, folder / "read.ply"], check=True)
        read = read_cloud(folder / "read.ply")
        assert read.keys() == cloud.keys() and len(read) > 1000
        worst_mm = max(abs(a - b) for key in cloud for a, b in zip(cloud[key], read[key]))
        print(f"worst {worst_mm:.2e} mm")
        # The clouds hold places of up to some metres in 32-bit floats.
        assert worst_mm < 1e-3

        # Cut in the last message, spoiled in the second profile: what stands before is there.
        data = scan.read_bytes()
        whole = len(list(biteline_scan.profiles(scan)))
        scan.write_bytes(data[:-1])
        assert len(list(biteline_scan.profiles(scan))) == whole  # the last message is the scan's end
        first = 8 + 4 + int.from_bytes(data[8:12], "little")
        second = first + 4 + int.from_bytes(data[first : first + 4], "little")
        spoiled = bytearray(data)
        spoiled[second + 300] ^= 0x10
        scan.write_bytes(spoiled)
        assert len(list(biteline_scan.profiles(scan))) == 1


main()
