#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fleet_test.py UPLINK FLEET MADE_CELL BROKER_FILES HOST SENSOR ROOT: four cells, a real broker with TLS and a real database.

Three cells are made, in one a real service works on a real sensor that replays a recorded scan.

Each program is killed in turn and all at once; one cell is cut off for an hour of made time (180 shoes).  Rows must equal
shoes, none double, in each cell's order.
"""
import json
import pathlib
import socket
import sqlite3
import ssl
import struct
import subprocess
import sys
import time
import urllib.request

from factory import CELLS, REAL_CELL, factory_of, put_odd_cells  # and the way to the module below
from programs import PATIENCE_S, comes_true
from real_cell import RealCell

SHOES, HOUR = 150, 180
REAL_SCANS = 5


def each_is_killed_in_turn(factory, real):
    makers = [factory.make_shoes(cell, 1, SHOES) for cell in CELLS]
    real.begin(REAL_SCANS)
    for victim in ("broker", "fleet", "cell-2", "database"):
        time.sleep(1.5)
        factory.kill(victim)
        time.sleep(0.8)
        factory.start(victim)
    real.kill_in_a_scan()
    everything = ["broker", "database", "fleet", *CELLS, REAL_CELL]
    for name in everything:
        factory.kill(name)
    real.kill_in_a_scan()
    time.sleep(0.5)
    for name in everything:
        factory.start(name)
    longest_ms = []
    for maker in makers:
        longest_ms.append(float(maker.communicate(timeout=PATIENCE_S)[0]))
        assert maker.returncode == 0
    print("longest writing of a shoe while others were killed:", max(longest_ms), "ms")
    for cell in CELLS:
        comes_true(lambda: factory.shoes_of(cell) == SHOES, f"{SHOES} shoes of {cell}, not {factory.shoes_of(cell)}")


def real_service_loses_nothing(factory, real):
    """What its own memory has is at the centre, once and in order, though it was killed within a scan itself."""
    real.finish()
    remembered = real.memory()
    assert real.killed > 0 and len(remembered) >= REAL_SCANS - real.killed, (real.killed, remembered)
    rows = lambda: factory.sql(f"SELECT scan, verdict, reason_code FROM shoes WHERE cell = '{REAL_CELL}' ORDER BY id")
    comes_true(lambda: rows() == remembered, f"{remembered} at the centre, not {rows()}")
    print(f"{len(remembered)} scans of a real service that was killed {real.killed} times:", ", ".join(verdict for _, verdict, _ in remembered))


def cut_log_is_found(factory, real):
    """The end of the cell's log is cut, and the count set back: the file alone fits, what the centre kept does not."""
    tool = pathlib.Path(real.host).parent / "biteline"

    def verify(folder, *more):
        return subprocess.run([tool, "history", folder, "--verify-log", "--json", *more], capture_output=True, text=True, check=False)

    def newest():
        return json.loads(verify(real.out).stdout)["log"]["last_link"]

    kept = factory.folder / "cell.links"

    def is_told():
        told = subprocess.run([factory.fleet, "--database", factory.database(), "--log-links", REAL_CELL], capture_output=True, text=True, check=False)
        kept.write_text(told.stdout)
        return [told.stdout.split()[-4:-2]] == [[str(newest()["row"]), newest()["sha256"]]]

    comes_true(is_told, "the centre keeps the newest link of the real cell's log")
    whole = verify(real.out, "--kept-links", kept)
    assert whole.returncode == 0, whole.stdout + whole.stderr
    cut = factory.folder / "cut"
    cut.mkdir()
    with sqlite3.connect(f"file:{real.out}/memory.sqlite?mode=ro", uri=True) as source, sqlite3.connect(cut / "memory.sqlite") as file:
        source.backup(file)
        for (name,) in file.execute("SELECT name FROM sqlite_master WHERE type = 'trigger' AND tbl_name = 'log'").fetchall():
            file.execute(f"DROP TRIGGER {name}")
        file.execute("DELETE FROM log WHERE id = (SELECT max(id) FROM log)")
        file.execute("UPDATE sqlite_sequence SET seq = (SELECT max(id) FROM log) WHERE name = 'log'")
    alone = verify(cut)
    assert alone.returncode == 0, alone.stdout + alone.stderr
    found = verify(cut, "--kept-links", kept)
    assert found.returncode == 3 and json.loads(found.stdout)["log"]["faults"][0]["reason_code"] == "log_cut", found.stdout + found.stderr
    strange = subprocess.run([factory.fleet, "--database", factory.database(), "--log-links", "cell-77"], capture_output=True, text=True, check=False)
    assert strange.returncode == 2 and "cell-77" in strange.stderr, strange


def one_is_cut_off_for_an_hour(factory):
    """180 shoes at one in 20 s; the others go on."""
    factory.kill("cell-3")
    comes_true(lambda: factory.sql("SELECT online FROM cells WHERE cell = 'cell-3'") == [["f"]], "the centre sees that cell-3 is away")
    assert factory.sql("SELECT count(*) FROM cells WHERE online") == [["3"]]
    makers = [factory.make_shoes(cell, SHOES + 1, HOUR if cell == "cell-3" else 20) for cell in CELLS]
    for maker in makers:
        assert maker.wait(PATIENCE_S) == 0
    assert factory.shoes_of("cell-3") == SHOES
    factory.start("cell-3")
    for cell in CELLS:
        expected = SHOES + (HOUR if cell == "cell-3" else 20)
        comes_true(lambda: factory.shoes_of(cell) == expected, f"{expected} shoes of {cell}, not {factory.shoes_of(cell)}")


def rows_are_the_shoes(factory):
    for cell in CELLS:
        comes_true(lambda: factory.sql("SELECT b.seq >= max(s.last_seq) AND count(*) = count(DISTINCT s.scan) FROM books b JOIN shoes s "
                                       f"USING (cell, book) WHERE cell = '{cell}' GROUP BY b.seq") == [["t"]], "all committed")
        rows = factory.sql("SELECT scan, verdict, round(length_mm::numeric, 2), extract(epoch FROM time)::bigint, places[36], decision, "
                           f"first_seq FROM shoes WHERE cell = '{cell}' ORDER BY id")
        last_seq = 0
        for number, (scan, verdict, length, when, place, decision, seq) in enumerate(rows, 1):
            assert scan == f"scan-{number:04d}", (cell, number, scan)
            assert verdict == ("refused" if number % 5 == 0 else "ok") and abs(float(length) - 800 - 0.01 * number) < 0.006, rows[number - 1]
            assert int(when) == 1_795_000_000 + 20 * number and abs(float(place) - 0.001 * number) < 1e-5, rows[number - 1]
            # What was decided later has come, too, and made no second row.
            assert decision == ("accepted" if number % 7 == 0 else "open"), rows[number - 1]
            assert int(seq) > last_seq
            last_seq = int(seq)
    assert factory.sql("SELECT count(*) FROM (SELECT 1 FROM shoes GROUP BY cell, scan HAVING count(*) > 1) AS twice") == [["0"]]
    told = subprocess.run([factory.fleet, "--database", factory.database(), "--list", "--json"], capture_output=True, text=True, check=True)
    cells = json.loads(told.stdout)["cells"]
    assert [(cell["cell"], cell["shoes"], cell["online"]) for cell in cells if cell["cell"] != REAL_CELL] == [
        ("cell-1", SHOES + 20, True), ("cell-2", SHOES + 20, True), ("cell-3", SHOES + HOUR, True)], cells
    trends = factory.sql(f"SELECT sum(shoes), sum(ok), sum(refused) FROM trends WHERE cell <> '{REAL_CELL}'")
    total = 3 * SHOES + 40 + HOUR
    assert trends == [[str(total), str(total - total // 5), str(total // 5)]], (trends, total)


def view_counts_by_the_factorys_day(factory):
    """Two shoes of one morning in Shanghai are of one day, one before the first shift is of the day before."""
    factory.sql("INSERT INTO books (cell, book, seq) VALUES ('cell-day', 'b', 4)")
    for number, (time_utc, verdict, code) in enumerate((("2026-11-26 23:30Z", "ok", ""), ("2026-11-27 00:30Z", "review", "rivalled"),
                                                        ("2026-11-26 21:30Z", "refused", "no_crease"),
                                                        ("2026-11-27 00:40Z", "refused", "stopped_by_a_person"))):
        factory.sql("INSERT INTO shoes (cell, book, scan, first_seq, last_seq, time, model, verdict, reason_code, reason, process, decision, "
                    f"sent, followed) VALUES ('cell-day', 'b', 'scan-{number}', {number}, {number}, '{time_utc}', '', '{verdict}', '{code}', '', "
                    "'', 'open', false, false)")
    days = ("SELECT to_char(day AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), shoes, ok, review, refused FROM trends WHERE cell = 'cell-day' "
            "ORDER BY day")

    def started_with(*options):
        factory.kill("fleet")
        factory.fleet_options = options
        factory.start("fleet")

    started_with("--time-zone", "Asia/Shanghai", "--day-begin", "06:00")
    expected = [["2026-11-25 22:00", "1", "0", "0", "1"], ["2026-11-26 22:00", "2", "1", "1", "0"]]
    comes_true(lambda: factory.sql(days) == expected, f"days of the factory: {factory.sql(days)}")
    started_with("--time-zone", "UTC")
    expected = [["2026-11-26 00:00", "2", "1", "0", "1"], ["2026-11-27 00:00", "1", "0", "1", "0"]]
    comes_true(lambda: factory.sql(days) == expected, f"days of UTC: {factory.sql(days)}")
    started_with()
    factory.sql("DELETE FROM shoes WHERE cell = 'cell-day'; DELETE FROM books WHERE cell = 'cell-day'")


def strangers_are_kept_out(factory):
    """A cell writes only its own; nobody comes in without a certificate; garbage is told and costs nothing."""
    before = factory.sql("SELECT count(*) FROM shoes")

    def publish(end, topic, text):
        """MQTT 3.1.1 by hand: connect, publish once with an answer.  False: the broker let nobody in."""
        context = ssl.create_default_context(cafile=factory.folder / "ca.pem")
        if end:
            context.load_cert_chain(factory.folder / f"{end}.pem", factory.folder / f"{end}.key")

        def packet(kind, body):
            length, bytes_ = len(body), bytearray([kind])
            while True:
                bytes_.append(length % 128 | (128 if length > 127 else 0))
                length //= 128
                if not length:
                    return bytes(bytes_) + body

        def words(text):
            return struct.pack(">H", len(text)) + text

        try:
            with socket.create_connection(("127.0.0.1", 8883), timeout=PATIENCE_S) as plain:
                with context.wrap_socket(plain, server_hostname="localhost") as link:
                    link.sendall(packet(0x10, words(b"MQTT") + bytes([4, 2, 0, 60]) + words(b"stranger")))
                    if link.recv(4) != bytes([0x20, 2, 0, 0]):
                        return False
                    link.sendall(packet(0x32, words(topic.encode()) + b"\0\1" + text.encode()))
                    return link.recv(4)[:1] == b"\x40"
        except OSError:
            return False

    shoe = {"book": "ffff", "seq": 1, "after": 0, "scan": "scan-9999", "time_ms": 1, "model": "", "verdict": "ok", "reason_code": "",
            "reason": "", "process": "", "decision": "open", "sent": False, "followed": False, "places": None}
    assert not publish(None, "biteline/1/cells/cell-1/shoes", "{}")
    publish("cell-2", "biteline/1/cells/cell-1/shoes", json.dumps(shoe))
    for garbage in ("", "{", "[]", json.dumps({**shoe, "seq": -1}), json.dumps({**shoe, "after": 5, "seq": 6}), "x" * 60000):
        publish("cell-1", "biteline/1/cells/cell-1/shoes", garbage)
    time.sleep(2)
    assert factory.sql("SELECT count(*) FROM shoes") == before
    assert factory.running["fleet"].process.poll() is None
    # Its own it may.
    assert publish("cell-1", "biteline/1/cells/cell-1/shoes", json.dumps(shoe))
    comes_true(lambda: factory.sql("SELECT cell FROM shoes WHERE scan = 'scan-9999'") == [["cell-1"]], "a cell's own shoe")


def odd_cell_is_named(factory):
    """Eight made cells, one of them 0.3 mm off, put into the database as shoes of a model of their own."""
    def odd():
        told = subprocess.run([factory.fleet, "--database", factory.database(), "--odd", "--json"], capture_output=True, text=True)
        return told.returncode, json.loads(told.stdout)["odd"]

    put_odd_cells(factory, 1, 40, 0)
    assert odd() == (0, []), odd()
    put_odd_cells(factory, 41, 20, 0.3)
    status, cells = odd()
    assert status == 3 and [(one["cell"], one["model"]) for one in cells] == [("odd-4", "loafer")], cells
    assert 0.2 < cells[0]["mm"] < 0.4 and cells[0]["difference"] == "wider or narrower all round", cells
    assert 35 <= int(cells[0]["since"][5:]) <= 43, cells


def metrics_tell_it(factory):
    token_file = factory.folder / "metrics.token"
    subprocess.run([factory.fleet, "--accounts", factory.folder / "accounts", "--metrics-token", token_file], check=True)
    request = urllib.request.Request("http://127.0.0.1:9118/metrics", headers={"Authorization": f"Bearer {token_file.read_text().strip()}"})

    def metrics():
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            return answer.read().decode()

    comes_true(lambda: f'biteline_fleet_shoes_total{{cell="cell-3",verdict="ok"}} {(SHOES + HOUR) * 4 // 5}' in metrics(), "the metrics of cell-3")
    for line in ("biteline_fleet_database_up 1", "biteline_fleet_broker_up 1", 'biteline_fleet_cell_online{cell="cell-2"} 1'):
        assert line in metrics(), line
    factory.kill("database")
    comes_true(lambda: "biteline_fleet_database_up 0" in metrics(), "the database is told as away")
    factory.start("database")
    comes_true(lambda: "biteline_fleet_database_up 1" in metrics(), "the database is back")


def main():
    with factory_of(sys.argv[1:5]) as factory:
        for name in ("broker", "database", "fleet", *CELLS, REAL_CELL):
            factory.start(name)
        real = RealCell(factory.folder / REAL_CELL, *sys.argv[5:8])
        each_is_killed_in_turn(factory, real)
        real_service_loses_nothing(factory, real)
        cut_log_is_found(factory, real)
        one_is_cut_off_for_an_hour(factory)
        rows_are_the_shoes(factory)
        view_counts_by_the_factorys_day(factory)
        strangers_are_kept_out(factory)
        odd_cell_is_named(factory)
        metrics_tell_it(factory)
    print("rows are the shoes of all cells, once and in order")


main()
