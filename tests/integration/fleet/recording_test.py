#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""recording_test.py UPLINK FLEET MADE_CELL BROKER_FILES: recordings fetched from their cells, over real daemons.

Uplink, broker and centre are killed while the bytes come; results go before; a cell at work is left alone; what is gone
is refused by name.
"""
import hashlib
import json
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import time

from factory import CELLS, Factory
from programs import PATIENCE_S, comes_true
from recordings import make_recording

LARGE, SMALL = 12_000_000, 60_000


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
    """While shoes are made, none waits for a recording."""
    expected = make_recording(factory.folder / "cell-2", "scan-0005", LARGE, 5)
    command = fetches.begin("cell-2/scan-0005")
    comes_true(lambda: fetches.row("cell-2/scan-0005")["have"] > 0, "bytes come")
    maker = factory.make_shoes("cell-2", 11, 40)
    assert maker.wait(PATIENCE_S) == 0
    comes_true(lambda: factory.shoes_of("cell-2") == 50, "the shoes that were made meanwhile")
    check_same(fetches.whole(command, "cell-2/scan-0005"), expected)


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


def main():
    with tempfile.TemporaryDirectory() as folder:
        factory = Factory(pathlib.Path(folder), *sys.argv[1:5])
        factory.fleet_options = ["--recordings", factory.folder / "recordings"]
        fetches = Fetches(factory)
        try:
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
        except BaseException:
            for program in [*factory.ended, *factory.running.values()]:
                print("---", *program.command[:3], *program.lines[-12:], sep="\n")
            raise
        finally:
            factory.end()
    print("recordings came whole, behind the results, and what is gone was told")


main()
