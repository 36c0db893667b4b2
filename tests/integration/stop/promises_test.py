#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""promises_test.py HOST WEB SENSOR CELL PROCESSES: what docs/cockpit.md says comes next, comes next, whoever looks.

One person teaches.  At each step a second person and a page that was just loaded are told the same, and what is told is what happens
then: the scan is held, its process is the next scan's, a model gets it, a yes works it and starts nothing else, a stop ends it.
"""
import signal
import sys
import time

from onlookers import everybody_sees, put_process
from stop_cell import Cell, ControlEnd, Program, comes_true

def held_with(cell, scan, process):
    comes_true(lambda: (cell.state()["held"] or {}).get("scan") == scan and cell.row(scan)["process"] == process, "it waits with " + process)


def teach(cell):
    """A process for a scan that waits is the next scan's, also when the shoe is scanned again."""
    scan = cell.held()
    look = everybody_sees(cell, "held", phase="deciding", scan=scan, process_by=None)
    assert look["held"]["scan"] == scan and {"accept", "reject", "process", "look", "rescan"} <= set(look["offers"]), look
    assert "start" not in look["offers"] and cell.call("POST", "/commands/start", {}, cell.token)[0] == 409
    assert cell.call("POST", f"/scans/{scan}/process", {"process": "taught"}, cell.token)[0] == 202
    held_with(cell, scan, "taught")
    look = everybody_sees(cell, "another process", phase="deciding", process="taught", process_by="ada")
    teaching = look["teaching"]["id"]
    assert cell.call("POST", "/commands/rescan", {"why": "too old", "hold": True}, cell.token)[0] == 202
    comes_true(lambda: (cell.state()["held"] or {}).get("scan") not in (None, scan), "the next scan waits")
    again = cell.state()["held"]["scan"]
    held_with(cell, again, "taught")
    look = everybody_sees(cell, "scanned again", phase="deciding", process="taught", process_by="ada", scan=again)
    assert look["teaching"]["id"] == teaching and cell.row(scan)["decision"] == "rejected", look
    return again


def save(cell, scan):
    """The model gets the process that its scan was planned with, byte by byte; what was not run in the air needs a word."""
    status, body = cell.call("POST", "/models", {"name": "boot", "scan": scan}, cell.token)
    assert status == 409 and "run in the air" in body["error"]["message"], body
    status, body = cell.call("POST", "/models", {"name": "boot", "scan": scan, "not_run": True}, cell.token)
    assert status == 201, body
    model = cell.results.parent / "models/boot/process.yaml"
    assert model.read_bytes() == (cell.results / "processes/taught.yaml").read_bytes()
    everybody_sees(cell, "saved", phase="deciding", scan=scan)


def work(cell, scan):
    """A yes works the scan that was looked at, and starts nothing else."""
    begin = len(cell.host.lines)
    version = cell.state()["held"]["version"]
    assert cell.call("POST", f"/scans/{scan}/accept", {"version": version}, cell.token)[0] == 200
    status, body = cell.call("POST", f"/scans/{scan}/reject", {"why": "no"}, cell.token)
    assert status == 409 and "/commands/stop" in body["error"]["message"], body
    comes_true(lambda: cell.row(scan)["sent"], "it is sent")
    everybody_sees(cell, "worked", phase="waiting", held=None)
    row = cell.row(scan)
    assert row["followed"] and row["process"] == "taught" and row["decided_by"] == "ada", row
    time.sleep(2)
    assert not cell.said("asks for a scan", begin) and cell.state()["phase"] == "waiting", cell.host.lines[begin:]


def stop(cell):
    """It ends what waits, and only a start begins the next scan."""
    scan = cell.held()
    begin = len(cell.host.lines)
    assert cell.call("POST", "/commands/stop")[0] == 200
    # Once its row says so.
    comes_true(lambda: cell.row(scan)["reason_code"] == "stopped_by_a_person" and "start" in cell.state()["offers"], "it has ended")
    look = everybody_sees(cell, "stopped", phase="stopped", held=None)
    assert not {"accept", "reject"} & set(look["offers"]), look
    assert cell.call("POST", f"/scans/{scan}/accept", {}, cell.token)[0] == 409
    time.sleep(2)
    assert not cell.said("asks for a scan", begin), cell.host.lines[begin:]


def restart(cell):
    """A teaching and the process that a person took outlive the service."""
    scan = cell.held()
    assert cell.row(scan)["process"] == "taught"
    cell.host.end(signal.SIGKILL)
    host = Program(*cell.host.command)
    try:
        end = ControlEnd(host.line_with("doors come in at").split()[-1])
        token = end.ask("POST", "/sessions", {"name": "ada", "password": "a long password"})[1]["token"]

        def state():
            return end.ask("GET", "/state", token=token)[1]
        comes_true(lambda: state()["phase"] == "waiting", "it waits for a start")
        assert (state()["process"], state()["process_by"]) == ("taught", "ada"), state()
        assert state()["teaching"] is not None, state()
        print("restarted: the same process, by the same person", flush=True)
    finally:
        host.end()


def main():
    with Cell(*sys.argv[1:6]) as cell:
        put_process(cell, "taught")
        scan = teach(cell)
        save(cell, scan)
        work(cell, scan)
        stop(cell)
        restart(cell)


main()
