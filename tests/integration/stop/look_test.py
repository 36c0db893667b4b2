#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""look_test.py HOST WEB SENSOR CELL PROCESSES [HELD_S [WHICH]]: a held scan that is too old, and a look at the shoe.

The shoe stands as it stood, was nudged by 0.3 mm, or is another one: worked, told, told.  A look is light and no motion of a path.
With HELD_S each is held for so long first, and the process keeps its own limit of age.  WHICH is the one that is run: else all.
"""
import json
import resource
import signal
import sys
import time

from stop_cell import Cell, comes_true

# Longer than a busy machine takes from a look to its words.
AGE_S = 20


def waits_again(state, scan):
    return (state["held"] or {}).get("scan") == scan and state["now"].startswith(f"{scan} waits for a person")


def look(cell, scan):
    """What came of it, as the folder tells it."""
    begin = len(cell.host.lines)
    assert cell.call("POST", f"/scans/{scan}/look", {}, cell.token)[0] == 202
    # Nobody decides about what is being looked at, and nothing else begins.
    status, _ = cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)
    assert status == 409, status
    comes_true(lambda: cell.said(f"{scan}: ", begin), "the look's words")
    # Beside the words the report is written and the row told; then it waits again.
    comes_true(lambda: waits_again(cell.state(), scan), "it waits again")
    assert not cell.said("takes in scan", begin) and not cell.said("sends the path", begin), cell.host.lines[begin:]
    return json.loads((cell.results / scan / "look/report.json").read_text())["moved"]


def look_that_cannot_be_written(cell, scan):
    """What was seen counts all the same: the report's own place is taken."""
    begin = len(cell.host.lines)
    assert cell.call("POST", f"/scans/{scan}/look", {}, cell.token)[0] == 202
    comes_true(lambda: cell.said("looks again at", begin), "the look begins")
    (cell.results / scan / "look/report.json").mkdir()
    comes_true(lambda: waits_again(cell.state(), scan) and not cell.state()["held"]["sendable"], "what was seen counts")
    assert (cell.results / scan / "look/report.json").is_dir() and cell.said("look/report.json", begin), cell.host.lines[begin:]
    return cell.state()["held"]


def gate_of(held_s):
    return "" if held_s else f"  scan_age_s: {AGE_S}\n"


def too_old(cell, held_s):
    scan = cell.held()
    time.sleep(held_s)
    comes_true(lambda: not cell.state()["held"]["sendable"], "it grows too old")
    held = cell.state()["held"]
    assert held["reason_code"] == "scan_too_old" and "look" in cell.state()["offers"], held
    assert "accept" not in cell.state()["offers"]
    status, body = cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)
    assert status == 409 and ("too old" in body["error"]["message"] or "age" in body["error"]["message"]), body
    return scan


def untouched_is_worked(programs, held_s):
    with Cell(*programs, gate=gate_of(held_s)) as cell:
        scan = too_old(cell, held_s)
        moved = look(cell, scan)
        assert moved["verdict"] == "unmoved" and moved["shift_mm"] + moved["u95_mm"] <= moved["limit_mm"], moved
        held = cell.state()["held"]
        assert held["sendable"] and held["fresh_s"] > 0, held
        # A look holds no longer than a scan does.
        comes_true(lambda: not cell.state()["held"]["sendable"], "the look grows too old", 300)
        assert look(cell, scan)["verdict"] == "unmoved"
        assert cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)[0] == 200
        comes_true(lambda: cell.row(scan)["sent"], "it is worked")
        gate = json.loads((cell.results / scan / "gate.json").read_text())
        age = next(row for row in gate["rows"] if row["name"] == "scan's age")
        assert gate["permitted"] and "looked at again" in age["value"], age
        print(f"untouched: {moved['words']}; the gate: {age['value']}", flush=True)
        cell.call("POST", "/commands/stop")
        cell.stands(time.monotonic())


def what_changed_is_told(programs, held_s, changed, verdict, reason):
    with Cell(*programs, changed=changed, gate=gate_of(held_s)) as cell:
        scan = cell.held()
        time.sleep(held_s)
        cell.change()
        assert look_that_cannot_be_written(cell, scan)["reason_code"] in reason
        moved = look(cell, scan)
        assert moved["verdict"] in verdict, moved
        state = cell.state()
        held = state["held"]
        assert not held["sendable"] and held["reason_code"] in reason, held
        assert not {"accept", "air"} & set(state["offers"]) and moved["words"] in state["now"], state
        begin = len(cell.host.lines)
        assert cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)[0] == 409
        assert cell.call("POST", f"/scans/{scan}/reject", {"why": "moved"}, cell.token)[0] == 200
        assert not cell.said("sends the path", begin)
        print(f"{changed}: {moved['words']}", flush=True)


def a_stop_ends_a_look(programs):
    with Cell(*programs) as cell:
        scan = cell.held()
        assert cell.call("POST", f"/scans/{scan}/look", {}, cell.token)[0] == 202
        comes_true(lambda: cell.said("looks again at"), "the look begins")
        since, lines = time.monotonic(), len(cell.host.lines)
        assert cell.call("POST", "/commands/stop")[0] == 200
        cell.is_stopped()
        comes_true(lambda: cell.row(scan)["reason_code"] == "stopped_by_a_person", "the row says so")
        assert cell.state()["held"] is None and cell.arm.moved_after(since) is None
        assert not cell.said("asks for a scan", lines)
        # And the cell goes on with the next shoe.
        following = cell.held()
        assert following != scan
        sensor_that_goes_away_shows_nothing(cell, following)


def sensor_that_goes_away_shows_nothing(cell, scan):
    """In mid-look: neither that the shoe was moved nor that it was not.  Its sensor may come back, and a stop ends the wait."""
    begin = len(cell.host.lines)
    assert cell.call("POST", f"/scans/{scan}/look", {}, cell.token)[0] == 202
    comes_true(lambda: cell.said("looks again at", begin), "the look begins")
    cell.sensor.end(signal.SIGKILL)
    comes_true(lambda: cell.said("cannot connect", begin), "the sensor is missed")
    assert cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)[0] == 409
    assert cell.call("POST", "/commands/stop")[0] == 200
    cell.is_stopped()
    comes_true(lambda: cell.row(scan)["reason_code"] == "stopped_by_a_person", "the row says so")
    assert not (cell.results / scan / "look/report.json").exists(), "a look that was not finished tells something"
    assert not cell.said("sends the path", begin) and cell.arm.moved_after(time.monotonic() - 1) is None


def full_disk_is_told(programs):
    """In mid-look: said once, shown all the time, and no yes counts.  With room again the look goes on."""
    with Cell(*programs) as cell:
        scan = cell.held()
        begin = len(cell.host.lines)
        assert cell.call("POST", f"/scans/{scan}/look", {}, cell.token)[0] == 202
        comes_true(lambda: cell.said("looks again at", begin), "the look begins")
        cell.limit_files(1)
        comes_true(lambda: "disk full" in cell.state()["now"], "the page shows it")
        assert cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)[0] == 409
        time.sleep(5)  # five tries
        state = cell.state()
        assert "disk full" in state["now"] and "stop ends it" in state["next"], state
        assert len([line for line in cell.host.lines[begin:] if "goes on with" in line]) <= 2, cell.host.lines[begin:]
        cell.limit_files(resource.RLIM_INFINITY)
        comes_true(lambda: waits_again(cell.state(), scan), "the look goes on")
        assert json.loads((cell.results / scan / "look/report.json").read_text())["moved"]["verdict"] == "unmoved"
        assert cell.state()["held"]["sendable"] and not cell.said("sends the path"), cell.state()


def main():
    programs, held_s = sys.argv[1:6], float(sys.argv[6]) if len(sys.argv) > 6 else 0
    which = sys.argv[7] if len(sys.argv) > 7 else "all"
    if which in ("untouched", "all"):
        untouched_is_worked(programs, held_s)
    if which in ("nudged", "all"):
        what_changed_is_told(programs, held_s, "nudged", {"moved"}, {"shoe_moved"})
    if which in ("exchanged", "all"):
        what_changed_is_told(programs, held_s, "exchanged", {"other_shoe", "moved"}, {"other_shoe", "shoe_moved"})
    if which in ("stop", "all"):
        a_stop_ends_a_look(programs)
    if which in ("disk", "all"):
        full_disk_is_told(programs)


main()
