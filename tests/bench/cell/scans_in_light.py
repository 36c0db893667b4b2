#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scans_in_light.py BUILD OUT WHAT [--scans N] [--from INDEX] [--seed S] [--lap]: tables of scans with pictures, in the light that the
simulated cell has unless told otherwise (true speckle). A row for each scan goes to OUT/WHAT.jsonl; the table is printed at the end.

  scans    before a UR10e in the real world, classes, sizes, speeds and the arm's unseen share in turn: points within U95, moved_mm
  dark     the same shoes without a table in view, on the same arm; give OUT of `scans`: what those tell of the arm is stated, too
  moved    scans as the demo makes them but with a check lap, and the same as if the shoe had moved meanwhile: moved_mm
  pictures the check of pictures, as they are and spoilt: its statistic over its limit
  uppers   a sample and two uppers for each class, scanned as the demo does it, through the service: their errors and U95
"""
import argparse
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
from collections import Counter, defaultdict

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from programs import Program

CLASSES = ["deep", "shallow", "step", "filled", "faded", "decorated", "stitched", "glossy", "mixed", "cupsole", "vulcanised", "midsole",
           "welted", "boot", "pump", "wedge"]
SPEEDS = [(100, 100), (250, 200), (400, 200)]
SHARES = [0.15, 0.3, 0.6]
UPPERS_OF = ["deep", "shallow", "step", "decorated", "stitched", "cupsole", "midsole", "boot"]
SPOILS = [("mirrored", 0), ("upside_down", 0), ("turned", 0), ("rows", 8), ("rows", 20), ("rows", 50)]
LAPS = {"lap, no arm": ["--check-lap", 50],
        "lap, arm": ["--check-lap", 50, "--arm", "ur10e", "--world", "real", "--speed-mm-s", 250, "--rate-hz", 200],
        "lap, 400 mm/s": ["--check-lap", 50, "--arm", "ur10e", "--world", "real", "--speed-mm-s", 400, "--rate-hz", 200],
        "lap, softest arm": ["--check-lap", 50, "--arm", "ur10e", "--world", "real", "--speed-mm-s", 250, "--rate-hz", 200,
                             "--elastic-hz", 8, "--unseen-ratio", 1],
        "no lap, arm": ["--arm", "ur10e", "--world", "real", "--speed-mm-s", 250, "--rate-hz", 200],
        "no lap, no arm": []}
CHECK = ["status", "words", "places", "statistic", "limit", "moved_statistic", "moved_limit", "tells_rows", "tells_columns",
         "table_profiles"]
DEMO = ["--arm", "ur10e", "--world", "real", "--speed-mm-s", 400, "--rate-hz", 200, "--scan-begin", 0.25, "--scan-clockwise"]


def run(*command):
    return subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)


def points_of(file, begin=0, count=3):
    rows = [line.split(",") for line in file.read_text().splitlines() if not line.startswith("#")]
    return [tuple(float(word) for word in row[begin:begin + count]) for row in rows]


def distances(line, truth):
    """Of each point to the closed polyline, mm."""
    off = []
    for point in line:
        near = min(range(len(truth)), key=lambda i: math.dist(point, truth[i]))
        off.append(min(from_edge(point, truth[k - 1], truth[k % len(truth)]) for k in (near, near + 1)))
    return off


def from_edge(point, a, b):
    along = [y - x for x, y in zip(a, b)]
    share = sum((q - x) * v for q, x, v in zip(point, a, along)) / max(sum(v * v for v in along), 1e-12)
    return math.dist(point, [x + max(0.0, min(1.0, share)) * v for x, v in zip(a, along)])


class Cell:
    """Records and replays; sessions are gone once they are looked at."""

    def __init__(self, build, out):
        self.build, self.out = build, out
        out.mkdir(parents=True, exist_ok=True)

    def record(self, *options, folder="session"):
        session = self.out / folder
        shutil.rmtree(session, ignore_errors=True)
        made = run(self.build / "bin/biteline-cell", "record", *options, "--out", session)
        if made.returncode:
            print("not made:", made.stderr.strip(), flush=True)
        return None if made.returncode else session

    def replay(self, session, *options):
        result = self.out / "result"
        shutil.rmtree(result, ignore_errors=True)
        run(self.build / "bin/biteline", "replay", session, "--quiet", "--out", result, *options)
        return looked_at(result, session / "truth/groove.csv")

    def moved_mm(self):
        """Of the last replay's cloud: a scan whose pictures contradict themselves is refused before it is asked whether it closes."""
        result = self.out / "extracted"
        run(self.build / "bin/biteline", "extract", self.out / "result/cloud.ply", "--quiet", "--out", result)
        return json.loads((result / "report.json").read_text()).get("moved_mm")

    def serve(self, session, *options):
        """The finished scan's folder of a service that takes this recording in."""
        served = self.out / "served"
        shutil.rmtree(served, ignore_errors=True)
        sensor = Program(self.build / "bin/biteline-sensor", "--source", f"replay:{session}", "--rt", "ignore")
        address = re.search(r"tcp://[0-9.:]+", sensor.line_with("tcp://")).group()
        run(self.build / "bin/biteline-host", "--sensor", address, "--once", "--out", served, *options)
        sensor.end()
        return served / "scan-0001"


def looked_at(result, truth_file):
    """What a finished scan's folder says, and how far its line is off."""
    report = json.loads((result / "report.json").read_text())
    check, u95 = report.get("picture_check", {}), report.get("u95", {})
    row = {"status": report["status"], "reason": report.get("reason_code"), "moved_mm": report.get("moved_mm"),
           "contrast": report.get("scan", {}).get("speckle_contrast", {}).get("median"),
           "arm_from": u95.get("arm_from"), "give": u95.get("arm_give_mm_per_m_s2"),
           "check": {key: check.get(key) for key in CHECK}}
    if (result / "line.csv").exists():
        row["off_mm"] = distances(points_of(result / "line.csv"), points_of(truth_file))
        row["u95_mm"] = [point[0] for point in points_of(result / "line.csv", 10, 1)]
    return row


def shoe_of(index, seed):
    return ["--shoe", CLASSES[index % len(CLASSES)], "--seed", seed + index, "--head", seed + index, "--size", 37 + 7 * index % 10]


def arm_of(index):
    speed, rate = SPEEDS[index % 3]
    way = ["--arm", "ur10e", "--speed-mm-s", speed, "--rate-hz", rate, "--scan-begin", 0.25, "--scan-clockwise", "--check-lap", 50]
    return way, SHARES[index // 3 % 3]


class Rows:
    """Each is kept as soon as it is there; those of earlier runs are read again."""

    def __init__(self, file):
        self.file = file
        self.rows = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []

    def add(self, row, **more):
        self.rows.append({**more, **row})
        with self.file.open("a") as file:
            file.write(json.dumps(self.rows[-1]) + "\n")
        told = {key: value for key, value in self.rows[-1].items() if key not in ("off_mm", "u95_mm", "check")}
        print({**told, **held([self.rows[-1]]), "check": row["check"]["status"], "over": over_limit(row)}, flush=True)


def held(rows):
    """Over all points of these scans together."""
    off = [mm for row in rows for mm in row.get("off_mm", [])]
    u95 = [mm for row in rows for mm in row.get("u95_mm", [])]
    if not off:
        return {}
    p95 = sorted(off)[int(0.95 * len(off))]
    return {"mean_mm": round(sum(off) / len(off), 4), "p95_mm": round(p95, 4), "max_mm": round(max(off), 3),
            "within": round(sum(a <= b for a, b in zip(off, u95)) / len(off), 4), "u95_over_p95": round(sum(u95) / len(u95) / p95, 2)}


def over_limit(row):
    check = row["check"]
    ratios = [check[a] / check[b] for a, b in (("statistic", "limit"), ("moved_statistic", "moved_limit")) if check.get(a) is not None]
    return round(max(ratios), 3) if ratios else None


def scans(cell, rows, args):
    for index in range(args.first, args.first + args.scans):
        way, share = arm_of(index)
        session = cell.record(*shoe_of(index, args.seed), *way, "--world", "real", "--unseen-ratio", share)
        if session:
            rows.add(cell.replay(session), shoe=CLASSES[index % len(CLASSES)], index=index, speed=SPEEDS[index % 3][0], share=share)
    tell_u95(rows.rows)


def tell_u95(rows):
    for source in ("table", "assumed", "stated"):
        for share in (None, *SHARES):
            these = [row for row in rows if row["arm_from"] == source and row["status"] == "ok" and share in (None, row["share"])]
            if these:
                print(source, "all" if share is None else share, len(these), "scans", held(these))
    print("not ok:", [(row["index"], row["shoe"], row["status"], row["reason"]) for row in rows if row["status"] != "ok"])
    moved = sorted(row["moved_mm"] for row in rows if row["moved_mm"] is not None)
    print("moved_mm", len(moved), moved[0], moved[-1], "contrast", sorted(row["contrast"] for row in rows)[len(rows) // 2])


def dark(cell, rows, args):
    """Without blur and lamps, too: the real world has a table."""
    gives = defaultdict(list)
    for row in Rows(cell.out / "scans.jsonl").rows:
        if row["arm_from"] == "table":
            gives[row["share"]].append(row["give"])
    for index in range(args.first, args.first + args.scans):
        way, share = arm_of(index)
        soft = ["--elastic-hz", 8, "--following-ms", 10, "--latency-ms", 4, "--unseen-ratio", share]
        session = cell.record(*shoe_of(index, args.seed), *way, *soft)
        if not session:
            continue
        about = {"shoe": CLASSES[index % len(CLASSES)], "index": index, "speed": SPEEDS[index % 3][0], "share": share}
        rows.add(cell.replay(session), **about)
        known = sorted(gives[share])
        file = cell.out / "uncertainty.yaml"
        file.write_text(exact_head(known[math.ceil(0.9 * len(known)) - 1]))
        rows.add(cell.replay(session, "--uncertainty", file), **about)
    tell_u95(rows.rows)


def exact_head(give=None, pose_sigma_mm=0, pose_sigma_rad=0):
    """An uncertainty.yaml of the arm alone."""
    nothing = "\n".join("  - [" + ", ".join(["0"] * 19) + "]" for _ in range(19))
    return (f"plane_middle_cam: [0, 0, 0]\nplane_axes:\n  - [1, 0]\n  - [0, 1]\n  - [0, 0]\ncovariance:\n{nothing}\n"
            f"pose_sigma_mm: {pose_sigma_mm}\npose_sigma_rad: {pose_sigma_rad}\n" +
            (f"arm_give_mm_per_m_s2: {give}\n" if give is not None else ""))


def moved(cell, rows, args):
    for index in range(args.first, args.first + args.scans):
        session = cell.record(*shoe_of(index, args.seed), *DEMO, "--check-lap", 50)
        if not session:
            continue
        poses = [[float(word) for word in line.split(",")] for line in (session / "pose0/data.csv").read_text().splitlines()[1:]]
        stamps = [line.split(",")[0] for line in (session / "pose0/data.csv").read_text().splitlines()[1:]]
        truth = points_of(session / "truth/groove.csv")
        middle = [sum(point[k] for point in truth) / len(truth) for k in range(2)]
        along = seam_direction(poses)
        across = (-along[1], along[0])
        moves = {"as it is": still, "slides 1 along": slides(along, 1), "slides 1 across": slides(across, 1),
                 "slides 2 along": slides(along, 2), "pushed 1 along": pushed(along, 1), "turns 0.25": turns(middle, 0.25),
                 "turns 1": turns(middle, 1)}
        for name, move in moves.items():
            write_moved(session / "pose0/data.csv", stamps, poses, move)
            row = cell.replay(session)
            row["moved_mm"] = row["moved_mm"] if row["moved_mm"] is not None else cell.moved_mm()
            rows.add(row, shoe=CLASSES[index % len(CLASSES)], index=index, move=name)
    for name in dict.fromkeys(row["move"] for row in rows.rows):
        of_these = [row for row in rows.rows if row["move"] == name]
        read = sorted(round(row["moved_mm"], 3) for row in of_these if row["moved_mm"] is not None)
        print(name, len(of_these), "scans, refused", dict(Counter(row["reason"] for row in of_these)), read)


def seam_direction(poses):
    """The arm's way while the scan begins, past its ramp: level."""
    begin, end = poses[len(poses) // 20], poses[len(poses) // 10]
    way = (end[1] - begin[1], end[2] - begin[2])
    return tuple(v / math.hypot(*way) for v in way)


# A move tells shift and turn (about the upright through base's origin) at a share of the scan's time.
def still(_share):
    return 0, 0, 0


def slides(way, mm):
    return lambda share: (way[0] * mm * share, way[1] * mm * share, 0)


def pushed(way, mm):
    return lambda share: (way[0] * mm * (share > 0.5), way[1] * mm * (share > 0.5), 0)


def turns(middle, degrees):
    def move(share):
        angle = math.radians(degrees) * share
        c, s = math.cos(angle), math.sin(angle)
        return middle[0] - c * middle[0] + s * middle[1], middle[1] - s * middle[0] - c * middle[1], angle
    return move


def write_moved(file, stamps, poses, move):
    """A shoe that moves by M before the told poses P is one at rest before the poses inv(M) P: so P are the recorded ones, moved by M."""
    lines = ["#timestamp [ns],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z []"]
    for i, (stamp, pose) in enumerate(zip(stamps, poses)):
        x, y, z, w, a, b, d = pose[1:]
        dx, dy, angle = move(i / (len(poses) - 1))
        c, s, ch, sh = math.cos(angle), math.sin(angle), math.cos(angle / 2), math.sin(angle / 2)
        place = (c * x - s * y + dx, s * x + c * y + dy, z)
        turn = (ch * w - sh * d, ch * a - sh * b, ch * b + sh * a, ch * d + sh * w)
        lines.append(stamp + "".join(f",{v:.9f}" for v in place + turn))
    file.write_text("\n".join(lines) + "\n")


def pictures(cell, rows, args):
    for kind, (lap, options) in enumerate(LAPS.items()):
        for index in range(args.first, args.first + args.scans):
            session = cell.record(*shoe_of(3 * index + kind, args.seed), *options)
            if not session:
                continue
            about = {"lap": lap, "index": index, "shoe": CLASSES[(3 * index + kind) % len(CLASSES)]}
            rows.add(cell.replay(session), spoil="as it is", **about)
            for spoil, amount in SPOILS:
                run(cell.build / "tests/bench_spoilt_session", session, cell.out / "spoilt", spoil, amount)
                rows.add(cell.replay(cell.out / "spoilt"), spoil=f"{spoil} {amount}" if amount else spoil, **about)
    table = defaultdict(list)
    for row in rows.rows:
        table[row["lap"], row["spoil"]].append((row["check"]["status"], over_limit(row)))
    for (lap, spoil), told in table.items():
        print(lap, "|", spoil, "|", told)


def uppers(cell, rows, args):
    file = cell.out / "uncertainty.yaml"
    file.write_text(exact_head(pose_sigma_mm=0.01, pose_sigma_rad=5.2e-5))
    for index in range(args.first, args.first + args.scans):
        shoe = UPPERS_OF[index % len(UPPERS_OF)]
        options = ["--shoe", shoe, "--seed", args.seed + index, "--size", 38 + index % 9, *DEMO,
                   *(["--check-lap", 50] if args.lap else [])]
        for what in ("sample", "upper 1", "upper 2"):
            upper = [] if what == "sample" else ["--upper", "--place", args.seed + index + int(what[-1])]
            session = cell.record(*options, *upper)
            if not session:
                break
            if what == "sample":
                rows.add(cell.replay(session, "--uncertainty", file), shoe=shoe, index=index, what=what)
                shutil.rmtree(cell.out / "sample", ignore_errors=True)
                (cell.out / "result").rename(cell.out / "sample")
            else:
                served = cell.serve(session, "--sample", cell.out / "sample", "--uncertainty", file)
                rows.add(looked_at(served, session / "truth/groove.csv"), shoe=shoe, index=index, what=what)
    for what, these in (("samples", [row for row in rows.rows if row["what"] == "sample"]),
                        ("uppers", [row for row in rows.rows if row["what"] != "sample"])):
        moved_mm = sorted(row["moved_mm"] for row in these if row["moved_mm"] is not None)
        right = [row for row in these if row["status"] == "ok"]
        print(what, len(these), "ok", len(right), held(right), "moved_mm", moved_mm[:1], moved_mm[-1:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    tables = {"scans": scans, "dark": dark, "moved": moved, "pictures": pictures, "uppers": uppers}
    parser.add_argument("what", choices=tables)
    parser.add_argument("--scans", type=int, default=8)
    parser.add_argument("--from", dest="first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=30117000)
    parser.add_argument("--lap", action="store_true", help="uppers: each scan with a check lap")
    args = parser.parse_args()
    cell = Cell(args.build, args.out)
    tables[args.what](cell, Rows(args.out / (args.what + ".jsonl")), args)


if __name__ == "__main__":
    main()
