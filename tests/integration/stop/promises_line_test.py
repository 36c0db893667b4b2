#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""promises_line_test.py HOST WEB SENSOR CELL PROCESSES: what docs/cockpit.md says of lines, first runs and models, comes so.

As promises_test.py: at each step a second person and a page that was just loaded are told the same.
"""
import math
import sys
import time

from onlookers import everybody_reads, everybody_sees, put_process
from stop_cell import Cell, comes_true

SPINDLE = 1  # its bit among the outputs


def accepted(cell, scan):
    """A yes works what was looked at, and starts nothing else."""
    begin = len(cell.host.lines)
    version = cell.state()["held"]["version"]
    assert cell.call("POST", f"/scans/{scan}/accept", {"version": version}, cell.token)[0] == 200
    comes_true(lambda: cell.row(scan)["sent"], "it is sent")
    everybody_sees(cell, "worked", phase="waiting", held=None)
    row = everybody_reads(cell, f"/scans/{scan}")
    assert row["followed"] and row["decision"] == "accepted" and row["decided_by"] == "ada", row
    assert not cell.said("asks for a scan", begin), cell.host.lines[begin:]
    return row


def mended(cell, scan, steps, why):
    version = cell.row(scan)["line_version"]
    status, body = cell.call("POST", f"/scans/{scan}/mend", {"line_version": version, "steps": steps, "why": why}, cell.token)
    assert status == 200, body
    comes_true(lambda: (cell.state()["held"] or {}).get("scan") == scan and "mend" in cell.state()["offers"], "it waits again")
    row = everybody_reads(cell, f"/scans/{scan}")
    assert row["line_version"] == version + 1 and row["versions"][-1]["who"] == "ada" and row["versions"][-1]["why"] == why, row
    return row


def as_found(from_mm, to_mm):
    return {"step": "candidate", "candidate": 1, "from_mm": from_mm, "to_mm": to_mm}


def line_of(cell, scan):
    rows = (cell.results / scan / "line.csv").read_text().splitlines()[1:]
    return [tuple(map(float, row.split(",")[:3])) for row in rows]


def part_with_all(stretches, length_mm):
    """Where it begins and how long it is: all of the closed line but the longest piece that nobody doubts."""
    rows = sorted(stretches, key=lambda one: one["from_mm"])
    free = [((after["from_mm"] - one["to_mm"]) % length_mm, after["from_mm"]) for one, after in zip(rows, rows[1:] + rows[:1])]
    longest, begin = max(free)
    return begin, length_mm - longest


def led_along(row, doubtful, sure):
    """One stretch over all that must be settled, led every 15 mm through the line that a better look gave."""
    begin, long = part_with_all(row["stretches"], row["length_mm"])
    spacing_mm = row["length_mm"] / len(doubtful)
    # A little beyond both ends.
    begin, long = begin - 5, long + 10
    places = [doubtful[round((begin + at) / spacing_mm) % len(doubtful)] for at in range(10, int(long) - 5, 15)]
    points = [min(sure, key=lambda point: math.dist(point, here)) for here in places]
    return {"step": "through", "from_mm": begin % row["length_mm"], "to_mm": (begin + long) % row["length_mm"], "points": points}


def line_for_review(programs):
    """It is held without a path, whatever was asked for; what a person settles is planned."""
    with Cell(*programs, changed="shining") as cell:
        first = cell.held()
        sure = line_of(cell, first)
        assert cell.call("POST", f"/scans/{first}/reject", {"why": "only its line"}, cell.token)[0] == 200
        cell.change()
        cell.start()
        comes_true(lambda: cell.state()["phase"] == "deciding" and cell.newest() != first, "it waits for a person")
        scan = cell.state()["held"]["scan"]
        look = everybody_sees(cell, "for review", phase="deciding", scan=scan)
        row = everybody_reads(cell, f"/scans/{scan}")
        assert row["verdict"] == "review" and row["decision"] == "held" and row["stretches"], row
        assert look["held"]["waits_for"] == "path" and "mend" in look["offers"] and not {"accept", "air"} & set(look["offers"]), look
        for word in ("accept", "air"):
            assert cell.call("POST", f"/scans/{scan}/{word}", None if word == "air" else {}, cell.token)[0] == 409
        settled = mended(cell, scan, [led_along(row, line_of(cell, scan), sure)], "led along the crease")
        assert settled["verdict"] != "review" and not settled["sent"], settled
        # What it snaps to is jagged here, so there may be no path along it: the state says which, to all.
        look = everybody_sees(cell, "settled", phase="deciding", scan=scan)
        assert ("accept" in look["offers"]) == (look["held"]["waits_for"] == "word") and look["held"]["waits_for"] != "model", look
        rerun(cell, scan)
        assert cell.call("POST", f"/scans/{scan}/reject", {"why": "no path"}, cell.token)[0] == 200
        look = everybody_sees(cell, "rejected", phase="waiting", held=None)
        assert "start" in look["offers"], look


def rerun(cell, scan):
    """The outcome stands beside the result, which stays as it is, and nothing is sent."""
    begin, before = len(cell.host.lines), everybody_reads(cell, f"/scans/{scan}")
    status, body = cell.call("POST", f"/scans/{scan}/rerun", {"settings": {"method": "published"}, "why": "to compare"}, cell.token)
    assert status == 202 and body["rerun"] == 1, body
    comes_true(lambda: cell.row(scan)["reruns"][0]["state"] == "done", "it is worked out again")
    after = everybody_reads(cell, f"/scans/{scan}")
    assert after["reruns"][0]["who"] == "ada" and (cell.results / scan / "rerun-1").is_dir(), after
    kept = ("verdict", "decision", "line_version", "process", "sent", "length_mm", "confidence")
    assert all(after[key] == before[key] for key in kept), (before, after)
    assert not cell.said("sends the path", begin) and not cell.said("asks for a scan", begin)


def planned_with(cell, scan, process):
    """This scan, with this process; what it waits for now."""
    assert cell.call("POST", f"/scans/{scan}/process", {"process": process}, cell.token)[0] == 202
    comes_true(lambda: cell.state()["phase"] == "deciding" and cell.row(scan)["process"] == process, "it is planned")
    return cell.state()["held"]["waits_for"]


def planned(cell, process):
    """A held scan of no known model that has a path with this process; the made rays are far apart, so now and then there is none."""
    for _ in range(8):
        before = cell.newest()
        cell.start(hold=True)
        comes_true(lambda: cell.state()["phase"] == "deciding" and cell.newest() != before, "it waits for a person")
        scan = cell.state()["held"]["scan"]
        look = everybody_sees(cell, "of no known model", phase="deciding", scan=scan)
        assert look["held"]["waits_for"] == "model" and not {"accept", "air"} & set(look["offers"]), look
        if planned_with(cell, scan, process) == "word":
            return scan
        assert cell.call("POST", f"/scans/{scan}/reject", {"why": "no path"}, cell.token)[0] == 200
    raise AssertionError("no scan of eight has a path")


def steps_of(teaching):
    return {one["step"]: (one["state"], one["why"]) for one in teaching["steps"]}


def see_dry_run(cell, teaching):
    open_now = everybody_reads(cell, teaching)
    seen = {key: open_now[key] for key in ("scan", "line_version", "process_sha256")}
    assert cell.call("POST", teaching + "/dry-run", seen, cell.token)[0] == 200
    assert steps_of(everybody_reads(cell, teaching))["dry_run"][0] == "done"


def run_in_air(cell, scan, teaching):
    """A mend opens what was seen again.  It runs with the tool off all the way; it waits on, and nothing else begins."""
    see_dry_run(cell, teaching)
    mended(cell, scan, [as_found(100, 120)], "to see it better")
    assert steps_of(everybody_reads(cell, teaching))["dry_run"][1] == "line_changed"
    see_dry_run(cell, teaching)
    begin, since = len(cell.host.lines), time.monotonic()
    # Where the machine is too busy the dead man ends it, which is right; then it is run again.
    for _ in range(5):
        assert cell.call("POST", f"/scans/{scan}/air", None, cell.token)[0] == 202
        comes_true(lambda: cell.state()["phase"] == "deciding" and (cell.row(scan)["air"] or {"state": "begun"})["state"] != "begun", "it has ended", 300)
        if cell.row(scan)["air"]["state"] == "followed":
            break
    row = everybody_reads(cell, f"/scans/{scan}")
    assert row["air"]["state"] == "followed" and row["decision"] == "held" and not row["sent"], row
    states = [one for one in list(cell.arm.states) if one[0] >= since]
    assert cell.arm.moved_after(since) and not any(one[2] & SPINDLE for one in states), "the tool was on in the air"
    assert not cell.said("asks for a scan", begin)
    everybody_sees(cell, "run in the air", phase="deciding", scan=scan)
    assert steps_of(everybody_reads(cell, teaching))["air"][0] == "done"


def save_what_was_run(cell, scan, teaching):
    """Another process opens the run in the air again; with the one that was run it is saved without a further word."""
    planned_with(cell, scan, "other")
    open_again = steps_of(everybody_reads(cell, teaching))
    assert all(open_again[step][0] != "done" and open_again[step][1] == "process_changed" for step in ("dry_run", "air")), open_again
    status, body = cell.call("POST", "/models", {"name": "boot", "scan": scan}, cell.token)
    assert status == 409 and "run in the air" in body["error"]["message"], body
    planned_with(cell, scan, "taught")
    status, body = cell.call("POST", "/models", {"name": "boot", "scan": scan}, cell.token)
    assert status == 201, (body, everybody_reads(cell, teaching))
    ended = everybody_reads(cell, teaching)
    assert ended["ended_how"] == "saved" and ended["model"] == "boot", ended
    everybody_sees(cell, "saved", phase="deciding", scan=scan)


def keeps_its_line(cell, scan):
    """What was worked is not mended any more."""
    row = everybody_reads(cell, f"/scans/{scan}")
    late = {"line_version": row["line_version"], "steps": [as_found(100, 120)], "why": "late"}
    assert cell.call("POST", f"/scans/{scan}/mend", late, cell.token)[0] == 409
    assert everybody_reads(cell, f"/scans/{scan}")["line_version"] == row["line_version"]


def worked_by_itself(cell, process, begin_with):
    """The next shoe that has a path, started so; nobody says a word about it."""
    for _ in range(8):
        before = cell.newest()
        comes_true(lambda: cell.call("POST", "/commands/start", begin_with, cell.token)[0] == 202, "a start is taken")
        comes_true(lambda: cell.newest() != before and cell.state()["phase"] in ("waiting", "deciding"), "the shoe's end", 300)
        row = everybody_reads(cell, "/scans/" + cell.newest())
        assert row["model"] == "boot" and row["process"] == process, row
        if row["sent"]:
            assert row["followed"] and row["decision"] == "automatic", row
            return
    raise AssertionError("no scan of eight has a path")


def choice_for_a_shoe_of_the_model(cell):
    """A recognised shoe is worked as its model says, then as a person took it for such a shoe, until a start ends that."""
    worked_by_itself(cell, "taught", {})
    everybody_sees(cell, "worked by itself", phase="waiting", process_by=None)
    scan = cell.held()
    planned_with(cell, scan, "other")
    everybody_sees(cell, "another process", phase="deciding", process="other", process_by="ada")
    assert cell.call("POST", f"/scans/{scan}/reject", {"why": "seen"}, cell.token)[0] == 200
    worked_by_itself(cell, "other", {})
    everybody_sees(cell, "worked as taken", phase="waiting", process="other", process_by="ada")
    worked_by_itself(cell, "taught", {"process": ""})
    everybody_sees(cell, "worked as the model says", phase="waiting", process_by=None)


def other_process(cell):
    """What a person took for a shoe of no known model, and what its model says, differ: a person says which."""
    assert cell.call("DELETE", "/models/boot", None, cell.token)[0] in (200, 204)
    scan = planned(cell, "taught")
    saved = {"name": "shoe", "scan": scan, "process": "other", "other_process": True, "not_run": True}
    assert cell.call("POST", "/models", saved, cell.token)[0] == 201
    assert cell.call("POST", f"/scans/{scan}/reject", {"why": "taught"}, cell.token)[0] == 200
    cell.start()
    comes_true(lambda: cell.state()["phase"] == "deciding" and cell.newest() != scan, "it waits for a person")
    scan = cell.state()["held"]["scan"]
    begin = len(cell.host.lines)
    row = everybody_reads(cell, f"/scans/{scan}")
    assert row["model"] == "shoe" and row["reason_code"] == "other_process" and "ada took taught" in row["reason"], row
    waits = planned_with(cell, scan, "other")
    everybody_sees(cell, "the model's process", phase="deciding", process="other", scan=scan)
    assert cell.row(scan)["reason_code"] != "other_process" and not cell.said("sends the path", begin)
    if waits == "word":
        assert accepted(cell, scan)["process"] == "other"


def teach_to_model(programs):
    with Cell(*programs, gate="  scan_age_s: 900\n", more=("--models",)) as cell:
        put_process(cell, "taught", speed_mm_s=200)
        put_process(cell, "other", speed_mm_s=80)
        scan = planned(cell, "taught")
        teaching = f"/teachings/{cell.state()['teaching']['id']}"
        run_in_air(cell, scan, teaching)
        save_what_was_run(cell, scan, teaching)
        accepted(cell, scan)
        keeps_its_line(cell, scan)
        choice_for_a_shoe_of_the_model(cell)
        other_process(cell)


def main():
    line_for_review(sys.argv[1:6])
    teach_to_model(sys.argv[1:6])


main()
