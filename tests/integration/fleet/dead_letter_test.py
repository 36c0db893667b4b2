#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""dead_letter_test.py UPLINK FLEET MADE_CELL BROKER_FILES: rows that the centre cannot read hold up nobody.

A memory of before there were bounds has poisoned rows; a cell of another make says what is no shoe.  The rows behind them come,
each bad one stands at the centre as a stub, and its cell is told why.  A flood of one cell's books and rows leaves the others theirs.
"""
import json
import socket
import sqlite3
import ssl
import struct
import subprocess
import sys
import time

from factory import factory_of  # and the way to the module below
from programs import PATIENCE_S, comes_true

SHOE = {"book": "ffff", "seq": 1, "after": 0, "scan": "scan-0001", "time_ms": 1, "model": "", "verdict": "ok", "reason_code": "", "reason": "",
        "process": "", "decision": "open", "sent": False, "followed": False, "places": None}


class Peer:
    """MQTT 3.1.1 by hand, with a cell's certificate."""

    def __init__(self, factory, cell):
        context = ssl.create_default_context(cafile=factory.folder / "ca.pem")
        context.load_cert_chain(factory.folder / f"{cell}.pem", factory.folder / f"{cell}.key")
        self.cell = cell
        self.link = context.wrap_socket(socket.create_connection(("127.0.0.1", 8883), timeout=PATIENCE_S), server_hostname="localhost")
        self.send(0x10, self.words(b"MQTT") + bytes([4, 2, 0, 60]) + self.words(b"foreign"))
        assert self.link.recv(4) == bytes([0x20, 2, 0, 0])

    @staticmethod
    def words(text):
        return struct.pack(">H", len(text)) + text

    def send(self, kind, body):
        length, packet = len(body), bytearray([kind])
        while True:
            packet.append(length % 128 | (128 if length > 127 else 0))
            length //= 128
            if not length:
                break
        self.link.sendall(bytes(packet) + body)

    def shoe(self, payload):
        """At least once is not waited for: one link keeps the order."""
        if not isinstance(payload, bytes):
            payload = json.dumps(payload).encode()
        self.send(0x30, self.words(f"biteline/1/cells/{self.cell}/shoes".encode()) + payload)


def poisoned_memory_goes_on(factory):
    """As a program of before wrote them: long, torn, with escapes, with numbers that are none."""
    cell = "cell-1"
    assert factory.make_shoes(cell, 1, 6).wait(PATIENCE_S) == 0
    with sqlite3.connect(factory.folder / cell / "memory.sqlite") as file:
        def change(number, column, value):
            file.execute(f"UPDATE scans SET {column} = ? WHERE name = ?", (value, f"scan-{number:04d}"))

        change(1, "process", "p" * 300)
        change(2, "process", "x" * 100_000)
        change(3, "process", "two\nlines\x1b[31m\x00</script>")
        file.execute("UPDATE scans SET model = CAST(x'ff00fe41' AS TEXT) WHERE name = 'scan-0004'")
        change(4, "length_mm", float("inf"))
        change(5, "verdict", "v" * 500)
        change(5, "time", -(1 << 62))
        file.execute("UPDATE scans SET name = ? WHERE name = 'scan-0006'", ("n" * 4000,))
    factory.start(cell)
    assert factory.make_shoes(cell, 11, 4).wait(PATIENCE_S) == 0
    comes_true(lambda: factory.shoes_of(cell) == 10, f"ten shoes of {cell}, not {factory.shoes_of(cell)}")
    rows = dict(factory.sql(f"SELECT scan, process FROM shoes WHERE cell = '{cell}' ORDER BY id"))
    # Cut with a mark, at the cell: nothing of it is a dead letter.
    assert rows["scan-0001"] == "p" * 197 + "..." and rows["scan-0002"] == "x" * 197 + "...", rows
    assert "scan-0014" in rows and factory.sql("SELECT count(*) FROM dead_letters") == [["0"]]


def foreign_words_are_stubs(factory):
    cell, book = "cell-2", "ffff"
    peer = Peer(factory, cell)
    bad = [{**SHOE, "process": "p" * 300}, {**SHOE, "model": "x" * 60_000}, {**SHOE, "length_mm": float("nan")}, {**SHOE, "places": [1e30] * 36},
           {key: value for key, value in SHOE.items() if key not in ("verdict", "process", "time_ms")}, {**SHOE, "scan": ""},
           {**SHOE, "time_ms": -1}, {**SHOE, "verdict": 7}]
    torn = [lambda text: text.replace(b'"ok"', b'"o\xffk"'), lambda text: text[:-9], lambda text: text.replace(b'"open"', b'"op\nen"'),
            lambda text: text.replace(b'"decision": "open"', b'"decision": "open", "deep": ' + b"[" * 4000)]
    seq = 0
    for one in [*bad, *torn]:
        for wrong in (True, False):
            head = {"book": book, "seq": seq + 1, "after": seq, "scan": f"scan-{seq + 1:04d}"}
            seq += 1
            if not wrong:
                peer.shoe({**SHOE, **head})
            elif callable(one):
                peer.shoe(one(json.dumps({**SHOE, **head}).encode()))
            else:
                peer.shoe({**{key: value for key, value in head.items() if key != "scan" or one.get("scan") != ""},
                           **{key: value for key, value in one.items() if key not in ("book", "seq", "after", "scan")}})
    comes_true(lambda: factory.shoes_of(cell) == seq, f"{seq} rows of {cell}, not {factory.shoes_of(cell)}")
    stubs = factory.sql(f"SELECT count(*), count(*) FILTER (WHERE stub) FROM shoes WHERE cell = '{cell}'")
    assert stubs == [[str(seq), str(seq // 2)]], stubs
    letters = factory.sql(f"SELECT seq, why FROM dead_letters WHERE cell = '{cell}' ORDER BY seq")
    assert [int(row[0]) for row in letters] == list(range(1, seq, 2)), letters
    assert "process" in letters[0][1] and "model" in letters[1][1], letters


def cell_is_told(factory):
    """What the centre took as a stub stands in the cell's folder of results, for its page and its log."""
    cell = "cell-3"
    assert factory.make_shoes(cell, 1, 3).wait(PATIENCE_S) == 0
    factory.start(cell)
    comes_true(lambda: factory.shoes_of(cell) == 3, "three shoes of cell-3")
    book = factory.sql(f"SELECT book FROM books WHERE cell = '{cell}'")[0][0]
    factory.sql(f"INSERT INTO dead_letters (cell, book, seq, scan, why) VALUES ('{cell}', '{book}', 2, 'scan-0002', 'model is out of bounds')")
    told = factory.folder / cell / "centre.json"
    comes_true(lambda: told.exists() and json.loads(told.read_text())["count"] == 1, "the cell is told of its dead letter")
    letter = json.loads(told.read_text())["letters"][0]
    assert (letter["scan"], letter["why"], letter["seq"]) == ("scan-0002", "model is out of bounds", 2), letter


def flood_leaves_the_others_theirs(factory):
    """20 000 rows of made-up books with one cell's certificate, in one go."""
    peer = Peer(factory, "cell-2")
    for number in range(20_000):
        peer.shoe({**SHOE, "book": f"made-{number}"})
    before = factory.shoes_of("cell-1")
    assert factory.make_shoes("cell-1", 21, 5).wait(PATIENCE_S) == 0
    comes_true(lambda: factory.shoes_of("cell-1") == before + 5, "cell-1's shoes come all the while")
    time.sleep(1)
    books = int(factory.sql("SELECT count(*) FROM books WHERE cell = 'cell-2'")[0][0])
    assert books <= 24, books
    peer.shoe({**SHOE, "book": "ffff", "seq": 25, "after": 24, "scan": "scan-0025"})
    print(books, "books of 20 000 that were made up")


def main():
    with factory_of(sys.argv[1:5]) as factory:
        for name in ("broker", "database", "fleet"):
            factory.start(name)
        comes_true(lambda: factory.sql("SELECT count(*) FROM shoes") == [["0"]], "the tables are there")
        poisoned_memory_goes_on(factory)
        foreign_words_are_stubs(factory)
        cell_is_told(factory)
        flood_leaves_the_others_theirs(factory)
        assert factory.running["fleet"].process.poll() is None
    reserved = subprocess.run([sys.argv[1], "--results", ".", "--cell", "fleet", "--broker", "mqtt://127.0.0.1:1"], capture_output=True, text=True)
    assert reserved.returncode == 2 and "fleet" in reserved.stderr, reserved
    print("no row stops a cell's line")


main()
