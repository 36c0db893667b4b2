#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reader_test.py SENSOR SERVICE SESSION SCAN_TO_PLY READ_LIVE: host/records/reader makes of a service's scan.btln the service's own cloud.

The last two are its examples in C++.
"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "host" / "records" / "reader"))
sys.path.append(str(ROOT / "tests" / "support"))
import biteline_scan  # noqa: E402
import encoder_counts  # noqa: E402


def read_cloud(file):
    """Places by profile and column, of any binary PLY."""
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


def ros2_poses(tool, judge, session, folder):
    file = folder / "poses.mcap"
    subprocess.run([tool, "record", "export", session, "--ros2", "--out", file], check=True, capture_output=True)
    told = subprocess.run([*judge, file], capture_output=True, text=True)
    if told.returncode == 77:
        return
    assert told.returncode == 0, told.stderr
    rows = [line.split(",") for line in (pathlib.Path(session) / "pose0/data.csv").read_text().splitlines()[1:]]
    poses = json.loads(told.stdout)["/pose0/pose_stamped"]
    assert len(poses) == len(rows) > 10
    for message, row in zip(poses, rows):
        place, turn = message["pose"]["position"], message["pose"]["orientation"]
        known = list(map(float, row[1:]))
        assert max(abs(1000 * place[axis] - known[i]) for i, axis in enumerate("xyz")) < 1e-9
        assert [turn[axis] for axis in "wxyz"] == known[3:]


def ros2_messages(tool, judge, recording, cloud, folder):
    """The recording's ROS 2 messages, read by their own definitions in the file: the points are the cloud's."""
    file = folder / "ros2.mcap"
    subprocess.run([tool, "record", "export", recording, "--ros2", "--out", file], check=True, capture_output=True)
    told = subprocess.run([*judge, file], capture_output=True, text=True)
    if told.returncode == 77:
        print("ROS 2 messages not judged: no packages of the page")
        return
    assert told.returncode == 0, told.stderr
    points = {}
    for message in json.loads(told.stdout)["/scan/points"]:
        assert message["header"]["frame_id"] == "base" and message["height"] == 1 and message["point_step"] == 16
        assert [field["name"] for field in message["fields"]] == ["x", "y", "z", "intensity"]
        assert message["row_step"] == 16 * message["width"] and not message["is_bigendian"]
        points[message["header"]["stamp"]["sec"] * 10**9 + message["header"]["stamp"]["nanosec"]] = [
            place[:3] for place in struct.iter_unpack("<ffff", bytes(message["data"]))
        ]
    assert sum(map(len, points.values())) == len(cloud)
    in_order = [place for stamp in sorted(points) for place in points[stamp]]
    worst_mm = max(abs(1000 * a - b) for place, known in zip(in_order, cloud.values()) for a, b in zip(place, known))
    print(f"ROS 2: {len(in_order)} points of {len(points)} profiles, worst {worst_mm:.2e} mm")
    assert worst_mm < 1e-3
    subprocess.run([tool, "record", "import", file, "--out", folder / "back"], check=True, capture_output=True)
    assert (folder / "back" / "scan.btln").read_bytes() == recording.read_bytes()


def keep_scan(sensor, service, session, folder):
    """Takes a replay into the folder, as a service that keeps its recordings."""
    running = subprocess.Popen([sensor, "--source", "replay:" + str(session), "--exit-with-parent"], stdout=subprocess.PIPE)
    address = json.loads(running.stdout.readline())["endpoint"]
    # Part of a shoe: the line is refused, the cloud is there.
    kept = subprocess.run([service, "--sensor", address, "--out", folder, "--once", "--keep-recording"], capture_output=True)
    assert kept.returncode in (0, 3), kept.stderr
    running.wait(timeout=30)
    return folder / "scan-0001" / "scan.btln"


def check_counts(sensor, service, session, folder):
    """An encoder's counts, as the poses give them."""
    copy, counts = encoder_counts.counted(session, folder)
    scan = keep_scan(sensor, service, copy, folder / "with-counts")
    print(f"an encoder's count in {encoder_counts.check(copy, counts, list(biteline_scan.profiles(scan)))} profiles")


def main():
    sensor, service, session, scan_to_ply, read_live, tool = sys.argv[1:7]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scan = keep_scan(sensor, service, session, folder)
        cloud = read_cloud(folder / "scan-0001" / "cloud.ply")
        assert all(profile["encoder_ticks"] is None for profile in biteline_scan.profiles(scan))
        check_counts(sensor, service, session, folder)

        script = ROOT / "host" / "records" / "reader" / "biteline_scan.py"
        subprocess.run([sys.executable, script, scan, folder / "read.ply"], check=True)
        read = read_cloud(folder / "read.ply")
        assert read.keys() == cloud.keys() and len(read) > 1000
        worst_mm = max(abs(a - b) for key in cloud for a, b in zip(cloud[key], read[key]))
        print(f"worst {worst_mm:.2e} mm")
        # The clouds hold places of up to some metres in 32-bit floats.
        assert worst_mm < 1e-3

        if sys.argv[7:]:
            ros2_messages(tool, sys.argv[7:], scan, cloud, folder)
            ros2_poses(tool, sys.argv[7:], session, folder)
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
