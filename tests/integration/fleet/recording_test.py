#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""recording_test.py UPLINK FLEET MADE_CELL BROKER_FILES: recordings fetched from their cells, over real daemons.

Uplink, broker and centre are killed while the bytes come; results go before; a cell at work is left alone; what is gone
is refused by name; at the centre they go by space and age, but for marked ones.
"""
import hashlib
import json
import pathlib
import subprocess
import sys
import tarfile
import time

from factory import CELLS, factory_of
from programs import PATIENCE_S, comes_true
from recordings import make_recording

LARGE, MIDDLE, SMALL = 12_000_000, 6_000_000, 60_000


class Fetches:
    def __init__(self, factory):
        self.factory, self.folder = factory, factory.folder

    def order(self, *words):
        return [self.factory.fleet, "--database", self.factory.database(), *map(str, words)]

    def begin(self, what):
        return subprocess.Popen(self.order("--fetch", what), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def row(self, what):
        rows = json.loads(subprocess.run(self.order("--fetches", "--json"), capture_output=True, text=True, check=True).stdout)["fetches"]
        cell, scan = what.split("/")
        return next((row for row in rows if (row["cell"], row["scan"]) == (cell, scan)), {"have": 0, "state": ""})

    def whole(self, command, what):
        told = command.communicate(timeout=PATIENCE_S)[0]
        assert command.returncode == 0, told
        file = pathlib.Path(told.splitlines()[-1].split("whole: ")[1])
        cell, scan = what.split("/")
        assert file.is_relative_to(self.folder / "recordings" / cell) and file.name == f"{scan}.tar", told
        return file


def check_same(file, expected):
    with tarfile.open(file) as tar:
        got = {member.name: hashlib.sha256(tar.extractfile(member).read()).hexdigest() for member in tar.getmembers()}
    assert got == expected, got


def killed_in_the_middle(fetches, factory):
    expected = make_recording(factory.folder / "cell-1", "scan-0003", LARGE, 3)
    what = "cell-1/scan-0003"
    command = fetches.begin(what)
    for victim in ("cell-1", "fleet", "broker"):
        before = fetches.row(what)["have"] if victim != "cell-1" else 0
        comes_true(lambda: fetches.row(what)["have"] > before, f"bytes of {what} come")
        assert fetches.row(what)["state"] == "coming", fetches.row(what)
        factory.kill(victim)
        factory.start(victim)
    check_same(fetches.whole(command, what), expected)
    # What had come was kept: the recording went over the line once, and what was on its way when somebody was killed.
    row = fetches.row(what)
    assert row["have"] == row["total"] > LARGE, row


def results_go_before(fetches, factory):
    """A cell that was cut off tells its shoes first: while one is missing at the centre, the recording stands still."""
    expected = make_recording(factory.folder / "cell-2", "scan-0005", LARGE, 5)
    what = "cell-2/scan-0005"
    command = fetches.begin(what)
    comes_true(lambda: fetches.row(what)["have"] > 0, "bytes come")
    factory.kill("cell-2")
    before, now = -1, fetches.row(what)["have"]
    while now != before:  # until what was on its way has come, and is in the database
        time.sleep(3)
        before, now = now, fetches.row(what)["have"]
    assert before < LARGE, "the whole recording came before the cell was cut off"
    assert factory.make_shoes("cell-2", 11, 40).wait(PATIENCE_S) == 0
    factory.start("cell-2")

    def seen():
        """Bytes and shoes at one moment."""
        rows = factory.sql("SELECT (SELECT max(have) FROM fetches WHERE cell = 'cell-2' AND scan = 'scan-0005'), "
                           "(SELECT count(*) FROM shoes WHERE cell = 'cell-2')")
        return [int(number) for number in rows[0]] if rows else [before, 50]

    moments = [seen()]
    while moments[-1][1] < 50:
        moments.append(seen())
        assert len(moments) < 20_000, moments[-1]
    early = [moment for moment in moments if moment[0] > before and moment[1] < 50]
    assert not early, (before, early[:3])
    check_same(fetches.whole(command, what), expected)
    print(f"results first: {len(moments)} looks, {before} bytes stood still until the last of 40 shoes was there", flush=True)


def cell_at_work_is_left_alone(fetches, factory):
    expected = make_recording(factory.folder / "cell-3", "scan-0002", SMALL, 2)
    (factory.folder / "cell-3/scan-0011").mkdir()  # a scan that comes in: no report yet
    command = fetches.begin("cell-3/scan-0002")
    time.sleep(3)
    assert fetches.row("cell-3/scan-0002")["have"] == 0 and command.poll() is None
    (factory.folder / "cell-3/scan-0011/report.json").write_text("{}\n")
    check_same(fetches.whole(command, "cell-3/scan-0002"), expected)


def what_cannot_be_had_is_told(fetches, factory):
    def refused(what, status, words):
        done = subprocess.run(fetches.order("--fetch", what), capture_output=True, text=True, timeout=PATIENCE_S)
        assert done.returncode == status and words in done.stdout + done.stderr, done

    refused("cell-1/scan-0004", 3, "scan-0004 is gone: the cell has removed its folder")
    refused("cell-1/scan-9000", 2, "the centre knows no such shoe")
    refused("cell-1/../../etc", 2, "CELL/SCAN expected")
    # A cell that lies about its memory's name gets no file out of the centre's folder.
    assert factory.sql("INSERT INTO books VALUES ('cell-1', '../../../up', 1)") is not None
    assert factory.sql("INSERT INTO shoes (cell, book, scan, first_seq, last_seq, time, model, verdict, reason_code, reason, process, decision, "
                       "sent, followed) VALUES ('cell-1', '../../../up', 'scan-0077', 1, 1, now(), '', 'ok', '', '', '', 'open', false, false)"
                       ) is not None
    refused("cell-1/scan-0077", 2, "no name for a folder")


def cell_that_is_away_is_waited_for(fetches, factory):
    expected = make_recording(factory.folder / "cell-1", "scan-0006", SMALL, 6)
    factory.kill("cell-1")
    comes_true(lambda: factory.sql("SELECT online FROM cells WHERE cell = 'cell-1'") == [["f"]], "cell-1 is away")
    command = fetches.begin("cell-1/scan-0006")
    time.sleep(1)
    assert command.poll() is None
    factory.start("cell-1")
    check_same(fetches.whole(command, "cell-1/scan-0006"), expected)


def old_ones_go_but_marked_ones_stay(fetches, factory):
    """By space, then by age; the rows stay, and who marks one that is gone is told."""
    def order(*words):
        return subprocess.run(fetches.order(*words), capture_output=True, text=True, timeout=PATIENCE_S)

    scans = [f"cell-2/scan-{number:04}" for number in (6, 7, 8)]
    files = []
    for number, what in enumerate(scans):
        cell, scan = what.split("/")
        make_recording(factory.folder / cell, scan, MIDDLE, 60 + number)
        files.append(fetches.whole(fetches.begin(what), what))
    others = [row for row in factory.sql("SELECT cell, scan FROM fetches WHERE state = 'whole'") if "/".join(row) not in scans]
    assert order("--mark", scans[0]).returncode == 0 and fetches.row(scans[0])["marked"]
    factory.kill("fleet")
    factory.fleet_options += ["--keep-gb", "0.01", "--keep-days", "30"]
    factory.start("fleet")
    comes_true(lambda: fetches.row(scans[1])["state"] == "removed", "there is no room for the second")
    assert fetches.row(scans[1])["words"] == "newer ones needed its room" and not files[1].exists()
    # The marked one and the newest alone are beyond the limit: they stay, and all others have gone.
    assert files[0].exists() and files[2].exists()
    for cell, scan in others:
        assert fetches.row(f"{cell}/{scan}")["state"] == "removed", (cell, scan)
    done = order("--mark", scans[1])
    assert done.returncode == 2 and "no such recording is here" in done.stderr, done
    assert factory.sql("UPDATE fetches SET ended = now() - interval '31 days' WHERE state = 'whole'") is not None
    comes_true(lambda: fetches.row(scans[2])["state"] == "removed", "the newest is too old")
    assert fetches.row(scans[2])["words"] == "it was too old" and not files[2].exists()
    assert files[0].exists() and fetches.row(scans[0])["state"] == "whole"
    assert order("--unmark", scans[0]).returncode == 0
    comes_true(lambda: not files[0].exists(), "the one that is marked no more goes")
    # It can be had again.
    comes_true(lambda: fetches.row(scans[0])["state"] == "removed", "the row says so")
    assert fetches.whole(fetches.begin(scans[0]), scans[0]).exists()


def main():
    with factory_of(sys.argv[1:5]) as factory:
        factory.fleet_options = ["--recordings", factory.folder / "recordings"]
        fetches = Fetches(factory)
        for cell in CELLS:
            assert factory.make_shoes(cell, 1, 10).wait(PATIENCE_S) == 0
        for name in ("broker", "database", "fleet", *CELLS):
            factory.start(name)
        for cell in CELLS:
            comes_true(lambda: factory.shoes_of(cell) == 10, f"the shoes of {cell}")
        killed_in_the_middle(fetches, factory)
        results_go_before(fetches, factory)
        cell_at_work_is_left_alone(fetches, factory)
        what_cannot_be_had_is_told(fetches, factory)
        cell_that_is_away_is_waited_for(fetches, factory)
        old_ones_go_but_marked_ones_stay(fetches, factory)
    print("recordings came whole, behind the results, and what is gone was told")


main()
