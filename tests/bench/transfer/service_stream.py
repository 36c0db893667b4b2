#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""service_stream.py BUILD [SEED] [MODELS] [SHOES]: a stream of uppers through the service itself.

Models, sizes and feet come in any order, each start with a part number; every second one says model, foot and size, too, and of
those every tenth a wrong one.  The scans are made (bench_stream_sensor), service and library are the real ones.
"""
import collections
import json
import math
import pathlib
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "integration/stop"))
from programs import Program, comes_true
from stop_cell import ControlEnd


def points_of(file, begin=0):
    rows = []
    for line in file.read_text().splitlines():
        words = line.replace(",", " ").split()
        try:
            rows.append(tuple(float(word) for word in words[begin:begin + 3]))
        except ValueError:
            continue  # the head of a table
    return rows


def distances(line, truth):
    """Of each point to the closed polyline, mm."""
    segments = list(zip(truth, truth[1:] + truth[:1]))
    far = []
    for p in line:
        near = min(range(len(truth)), key=lambda i: sum((a - b) ** 2 for a, b in zip(p, truth[i])))
        best = math.inf
        for k in (near - 2, near - 1, near, near + 1):
            a, b = segments[k % len(segments)]
            along = [y - x for x, y in zip(a, b)]
            length = sum(v * v for v in along) or 1
            t = max(0.0, min(1.0, sum((q - x) * v for q, x, v in zip(p, a, along)) / length))
            best = min(best, math.dist(p, [x + t * v for x, v in zip(a, along)]))
        far.append(best)
    return far


def main():
    build = pathlib.Path(sys.argv[1])
    seed, models, shoes = (int(word) for word in (sys.argv[2:] + ["29112900", "5", "200"][len(sys.argv) - 2:])[:3])
    with tempfile.TemporaryDirectory() as name:
        out = pathlib.Path(name)
        truth = out / "truth"
        truth.mkdir()
        (out / "jobs.yaml").write_text("jobs:\n  1: {}\n")
        sensor = Program(build / "tests/bench_stream_sensor", seed, models, out / "models", truth)
        address = sensor.line_with("tcp://")
        host = Program(build / "bin/biteline-host", "--sensor", address, "--out", out / "results", "--models", "--library", out / "models",
                       "--control", "tcp://127.0.0.1:0", "--jobs", out / "jobs.yaml", "--exit-with-parent")
        end = ControlEnd(host.line_with("doors come in at").split()[-1])
        try:
            run(end, out, truth, shoes, seed)
        finally:
            for one in (host, sensor):
                one.end()


def run(end, out, truth, shoes, seed):
    token = (out / "results/.first.token").read_text().strip()
    ada = {"name": "ada", "password": "a long password"}
    assert end.ask("POST", "/users", {**ada, "role": "administrator"}, token)[0] == 201
    token = end.ask("POST", "/sessions", ada)[1]["token"]
    assert end.ask("POST", "/control", {"action": "take"}, token)[0] == 200
    tally = collections.Counter()
    errors, by_size, begin = [], collections.defaultdict(list), time.monotonic()
    for number in range(1, shoes + 1):
        told = truth / f"shoe-{number}.json"
        comes_true(told.exists, "the shoe is drawn")
        shoe = json.loads(told.read_text())
        job = {"part": f"P-{number}", **{key: value for key, value in shoe["order"].items() if value}}
        comes_true(lambda: end.ask("POST", "/commands/start", job, token)[0] == 202, "the start is taken")
        scan = f"scan-{number:04}"

        def row():
            status, body = end.ask("GET", "/scans/" + scan, token=token)
            state = end.ask("GET", "/state", token=token)[1]
            return body if status == 200 and state["phase"] in ("waiting", "deciding") else None
        found = comes_true(row, scan + " has a row")
        held = found["decision"] == "held"
        if held:
            assert end.ask("POST", f"/scans/{scan}/reject", {"why": "nobody is here"}, token)[0] == 200
        assert found["part"] == job["part"], found
        kind = "another one ordered" if shoe["order_is_wrong"] else "ordered" if len(job) > 1 else "without an order"
        tally[kind] += 1
        works = not held and found["verdict"] in ("ok", "amber")
        named = all(found[key] == shoe[key] for key in ("model", "foot", "size"))
        words = f"{scan} {shoe['model']} {shoe['foot']} {shoe['size']} {kind}: {found['verdict']} {found['reason_code'] or ''}"
        if not works:
            tally[kind, "a person asked"] += 1
        elif not named or shoe["order_is_wrong"]:
            tally[kind, "wrong"] += 1
            words += f" WRONG: {found['model']} {found['foot']} {found['size']}"
        else:
            far = distances(points_of(out / "results" / scan / "line.csv"), points_of(truth / f"shoe-{number}.csv"))
            bound = json.loads((out / "results" / scan / "report.json").read_text()).get("bound_mm")
            mean = sum(far) / len(far)
            errors.append(mean)
            by_size[shoe["size"]].append(mean)
            if bound is None:
                tally["without a bound"] += 1
            elif sum(value <= bound for value in far) < 0.95 * len(far):
                tally["bound broken"] += 1
            words += f" mean {mean:.3f} bound {bound}"
        print(words, file=sys.stderr, flush=True)
    for kind in ("without an order", "ordered", "another one ordered"):
        print(json.dumps({"bench": "transfer.service_stream", "seed": seed, "what": kind, "shoes": tally[kind],
                          "wrong": tally[kind, "wrong"], "a_person_asked": tally[kind, "a person asked"]}))
    print(json.dumps({"bench": "transfer.service_stream", "lines": len(errors), "mean_mm": round(sum(errors) / max(1, len(errors)), 3),
                      "worst_size_mm": round(max((sum(v) / len(v) for v in by_size.values()), default=0), 3),
                      "bound_broken": tally["bound broken"], "without_a_bound": tally["without a bound"],
                      "s_per_shoe": round((time.monotonic() - begin) / shoes, 2)}))


main()
