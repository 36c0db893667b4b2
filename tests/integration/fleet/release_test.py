#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""release_test.py UPLINK FLEET MADE_CELL BROKER_FILES BITELINE HOST SENSOR ROOT switch|orders: a release to three cells, over
real daemons.

switch: fetched and checked everywhere first, then switched at one time by a signed order while shoes are made; programs are
killed in the middle, a cell is away.  No shoe may have parts of two releases.
orders: a signature is wrong, a byte is flipped, an order is forged, cut or an old one.  Nothing is switched by them.
"""
import json
import pathlib
import re
import signal
import statistics
import subprocess
import sys
import time

from factory import CELLS, factory_of, skip
from programs import PATIENCE_S, Program, comes_true

BITELINE, HOST, SENSOR, ROOT, PART = sys.argv[5:10]
SHOES, EACH = 400, 5
# Loops of a loaded machine, not clocks: all cells here have one clock, and the time of the switch is in the plan.
PADDING = 2_000_000


class Releases:
    def __init__(self, factory):
        self.factory, self.folder, self.orders = factory, factory.folder, 0
        for end in ("release", "stranger"):
            subprocess.run(["openssl", "genpkey", "-algorithm", "ed25519", "-out", self.folder / f"{end}.key"], check=True)
            subprocess.run(["openssl", "pkey", "-in", self.folder / f"{end}.key", "-pubout", "-out", self.folder / f"{end}.pem"], check=True)
        factory.uplink_options = lambda cell: ["--releases", self.of(cell), "--release-key", self.folder / "release.pem"]

    def of(self, cell):
        return self.folder / f"{cell}-releases"

    def make(self, name, key="release"):
        """A release whose model and process both begin with its name; its SHA-256."""
        process = pathlib.Path(ROOT, "host/robot/path/processes/rough.yaml").read_text()
        # Noise in a comment: several rounds of parts, and nothing that packs well.
        noise = "".join(f"# {number * 2654435761 % 2**32:08x}\n" for number in range(PADDING // 11))
        (self.folder / "grind.yaml").write_text(f"# {name}\n{process}{noise}")
        library = self.folder / f"library-{name}"
        sample = self.folder / f"sample-{name}"
        subprocess.run([BITELINE, "extract", pathlib.Path(ROOT, "tests/golden/sample/cloud.ply"), "--out", sample], check=True, capture_output=True)
        subprocess.run([BITELINE, "model", "--library", library, "save", "boot", sample, "--process", self.folder / "grind.yaml"], check=True,
                       capture_output=True)
        file = self.folder / f"{name}.tar"
        subprocess.run([BITELINE, "model", "--library", library, "release", name, "--out", file, "--process", self.folder / "grind.yaml"],
                       check=True, capture_output=True)
        self.sign(f"{file}.manifest", key)
        return file.with_name(file.name + ".manifest").read_text().split("sha256 ")[1].split()[0]

    def sign(self, file, key):
        subprocess.run(["openssl", "pkeyutl", "-sign", "-rawin", "-inkey", self.folder / f"{key}.key", "-in", file, "-out", f"{file}.sig"],
                       check=True, capture_output=True)

    def order(self, *words):
        return subprocess.run([self.factory.fleet, "--database", self.factory.database(), *map(str, words)], capture_output=True, text=True)

    def offer(self, name):
        done = self.order("--offer", self.folder / f"{name}.tar", "--cells", ",".join(CELLS))
        assert done.returncode == 0, done.stderr
        return int(done.stdout.split()[1])

    def cells(self, number):
        # The database may be late on a busy machine; then it is asked again.
        told = comes_true(lambda: (lambda done: done.stdout if done.returncode == 0 else "")(self.order("--releases", "--json")), "the releases are told")
        rows = json.loads(told)["releases"]
        return {one["cell"]: one for row in rows if row["number"] == number for one in row["cells"]}

    def ready(self, number, cells=CELLS):
        comes_true(lambda: all(self.cells(number)[cell]["ready"] for cell in cells), f"release {number} is ready everywhere")

    def signed_order(self, number, in_s=15, key="release", after=0):
        """The order of a switch to this release, as its maker signs it."""
        self.orders += 1
        file = self.folder / f"switch-{self.orders}"
        done = self.order("--order", number, "--out", file, "--in", in_s, "--after", after)
        assert done.returncode == 0, done
        self.sign(file, key)
        return file

    def switch(self, number):
        """Once all are ready a loaded machine may still miss the time: then nobody has switched, and it is asked again."""
        for _ in range(5):
            done = self.order("--switch", self.signed_order(number))
            if done.returncode == 0:
                return
            told = done.stdout + done.stderr
            assert "all keep what they have" in told or "is not switched" in told or "write and sign a new one" in told, done
            time.sleep(6)
        raise AssertionError(done)

    def in_force(self, number):
        comes_true(lambda: all(cell["in_force"] for cell in self.cells(number).values()), f"release {number} is in force everywhere")

    def brought_into_force(self, name):
        self.make(name)
        number = self.offer(name)
        self.ready(number)
        self.switch(number)
        self.in_force(number)
        return number


def fetched_while_killed(releases, factory):
    """Uplink and fleet are killed while the bytes come; what is there in the end is whole."""
    releases.make("one")
    first = releases.offer("one")
    for victim in ("cell-1", "fleet", "cell-2"):
        time.sleep(0.3)
        factory.kill(victim)
        factory.start(victim)
    releases.ready(first)
    assert not any(cell["in_force"] for cell in releases.cells(first).values())
    return first


def away_is_named(releases, factory, first):
    factory.kill("cell-3")
    comes_true(lambda: not releases.cells(first)["cell-3"]["ready"], "cell-3 is seen to be away")
    done = releases.order("--switch", releases.signed_order(first))
    assert done.returncode != 0 and "cell-3: it is away" in done.stderr, done
    factory.start("cell-3")
    releases.ready(first)


def silent_cell_stops_it(releases, factory, first):
    """A cell that ends between the look and the word: nobody switches."""
    command = subprocess.Popen([factory.fleet, "--database", factory.database(), "--switch", releases.signed_order(first)],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    # Stopped, not killed: its line still stands, so it counts as heard.
    stopped = factory.running["cell-2"].process
    stopped.send_signal(signal.SIGSTOP)
    told = command.communicate(timeout=PATIENCE_S)[0]
    stopped.send_signal(signal.SIGCONT)
    if command.returncode == 0:
        # It had answered before it was stopped: that switch is good.
        releases.in_force(first)
        return False
    assert command.returncode == 3 and "all keep what they have" in told and "cell-2" in told, told
    time.sleep(6)  # beyond the order's time
    assert not any(cell["in_force"] for cell in releases.cells(first).values()), releases.cells(first)
    releases.ready(first)
    return True


def spoiled_ones_are_refused(releases, factory):
    """Another's signature; a byte flipped where it is kept; a file that is not the manifest's."""
    releases.make("forged", "stranger")
    forged = releases.offer("forged")
    comes_true(lambda: all("not signed by" in cell["why"] for cell in releases.cells(forged).values()), "all refuse the signature")
    for cell in CELLS:
        assert not [file for file in releases.of(cell).iterdir() if file.name.endswith(".part")], "bytes of a stranger"

    flipped_hash = releases.make("flipped")
    factory.kill("fleet")  # else a quick cell has the bytes before one is flipped
    flipped = releases.offer("flipped")
    assert factory.sql("UPDATE release_parts SET bytes = set_byte(bytes, 700, get_byte(bytes, 700) # 1) WHERE release = "
                       f"{flipped} AND at = 0") is not None
    factory.start("fleet")
    comes_true(lambda: all("SHA-256" in cell["why"] for cell in releases.cells(flipped).values()), "all refuse the flipped byte")
    assert not any((releases.of(cell) / flipped_hash).exists() for cell in CELLS)

    releases.make("changed")
    with open(releases.folder / "changed.tar", "r+b") as file:
        file.seek(1000)
        file.write(b"?")
    done = releases.order("--offer", releases.folder / "changed.tar", "--cells", "cell-1")
    assert done.returncode == 2 and "not the file that was signed" in done.stderr, done


def forged_and_cut_orders_are_refused(releases, factory, first):
    """A stranger's signature; a text that was changed behind its signature; half a text."""
    before = releases.cells(first)
    done = releases.order("--switch", releases.signed_order(first, key="stranger"))
    assert done.returncode == 3 and "is not signed by" in done.stdout and "all keep what they have" in done.stdout, done
    # Its time is not waited for: the next order is taken while the stranger's would still be open.
    stranger = releases.signed_order(first, in_s=3600, key="stranger")
    done = releases.order("--switch", stranger)
    assert done.returncode == 3 and "is not signed by" in done.stdout, done
    assert factory.sql("SELECT count(*) FROM switches WHERE state = 'planned' OR (at > now() AND state = 'sure')") == [["0"]]
    # Nor do numbers end: neither a stranger's order nor one cell's word makes the next one too large.
    huge = releases.signed_order(first)
    huge.write_text(re.sub("number [0-9]+", "number 2147483647", huge.read_text()))
    releases.sign(huge, "stranger")
    done = releases.order("--switch", huge)
    assert done.returncode != 0 and "so many cannot have been between" in done.stderr, done
    assert factory.sql("UPDATE cell_releases SET newest = 2147483647 WHERE cell = 'cell-1'") is not None
    newest = int(factory.sql("SELECT max(number) FROM switches")[0][0])
    assert f"number {newest + 1}\n" in releases.signed_order(first).read_text()
    assert "number 4001\n" in releases.signed_order(first, after=4000).read_text()
    assert releases.order("--switch", releases.signed_order(first, after=4000, key="stranger"), "--after", 4000).returncode == 3
    assert factory.sql("DELETE FROM switches WHERE number = 4001") is not None
    changed = releases.signed_order(first)
    changed.write_text(changed.read_text().replace("at_ms 1", "at_ms 2"))
    done = releases.order("--switch", changed)
    assert done.returncode != 0 and "write and sign a new one" in done.stderr, done
    cut = releases.signed_order(first)
    cut.write_bytes(cut.read_bytes()[:-9])
    done = releases.order("--switch", cut)
    assert done.returncode != 0 and ("not as expected" in done.stderr or "other cells" in done.stderr), done
    assert {cell: one["in_force"] for cell, one in releases.cells(first).items()} == {cell: one["in_force"] for cell, one in before.items()}


def old_order_is_refused(releases, factory, first, second):
    """A centre that tells of the order that brought the first release into force once more: signed, but old."""
    old = f"FROM switches WHERE release = {first} AND state = 'sure' ORDER BY number LIMIT 1"
    assert factory.sql("INSERT INTO switches (number, release, at, state, order_text, order_signature) SELECT 1000000, release, at, state, "
                       f"order_text, order_signature {old}") is not None
    assert factory.sql("INSERT INTO switch_cells SELECT 1000000, cell FROM release_cells WHERE release = " + str(second)) is not None
    comes_true(lambda: all("a newer or another one is known here" in row[0] for row in factory.sql("SELECT fault FROM cell_releases")),
               "all cells refuse the old order")
    assert all(cell["in_force"] for cell in releases.cells(second).values())
    assert factory.sql("DELETE FROM switches WHERE number = 1000000") is not None
    comes_true(lambda: not any(row[0] for row in factory.sql("SELECT fault FROM cell_releases")), "nothing is wrong any more")


def switched_under_load(releases, factory, first):
    """From the first release to the second while each cell makes shoes, and both programs are killed around its time."""
    second_hash = releases.make("two")
    first_hash = factory.sql(f"SELECT sha256 FROM releases WHERE number = {first}")[0][0]
    second = releases.offer("two")
    releases.ready(second)
    makers = [factory.make_shoes(cell, 1, SHOES, releases.of(cell)) for cell in CELLS]
    releases.switch(second)
    at_ms = int(factory.sql("SELECT (extract(epoch FROM at) * 1000)::bigint FROM switches WHERE state = 'sure' ORDER BY number DESC LIMIT 1")[0][0])
    # All have heard that it is sure: whoever is dead at its time, it happens.
    comes_true(lambda: all("sure 1" in (releases.of(cell) / "plan").read_text() for cell in CELLS) or time.time() * 1000 > at_ms, "all are sure")
    if time.time() * 1000 >= at_ms:
        skip("this machine is too slow to tell three cells before the switch's time")
    for victim in ("cell-1", "fleet"):
        factory.kill(victim)
    time.sleep(max(0, at_ms / 1000 - time.time()) + 1)
    for victim in ("cell-1", "fleet"):
        factory.start(victim)
    for maker in makers:
        maker.communicate(timeout=PATIENCE_S)
        assert maker.returncode == 0
    for cell in CELLS:
        comes_true(lambda: factory.shoes_of(cell) == SHOES, f"{SHOES} shoes of {cell}, not {factory.shoes_of(cell)}")
        rows = factory.sql(f"SELECT release, process, reason FROM shoes WHERE cell = '{cell}' ORDER BY id")
        for hash_, process, began_ms in rows:
            expected = (second_hash, "# two/# two") if int(began_ms) >= at_ms else (first_hash, "# one/# one")
            assert (hash_, process) == expected, (cell, hash_, process, int(began_ms) - at_ms)
        if int(rows[-1][2]) < at_ms:
            skip("this machine is too slow: the shoes were made before the switch's time")
        assert {process for _, process, _ in rows} == {"# one/# one", "# two/# two"}, "shoes before and behind the switch"
    releases.in_force(second)
    # The way back is there.
    for cell in CELLS:
        assert (releases.of(cell) / first_hash).is_dir()
    return second, second_hash


def scan(out, library, folder_of_releases):
    """One scan of a real service from a real sensor's replay: its report, and how long it took."""
    sensor = Program(SENSOR, "--source", f"replay:{ROOT}/tests/golden/part", "--exit-with-parent")
    endpoint = json.loads(sensor.line_with("endpoint"))["endpoint"]
    begin = time.monotonic()
    told = subprocess.run([HOST, "--sensor", endpoint, "--out", out, "--library", library, "--models", "--once", "--releases", folder_of_releases],
                          capture_output=True, text=True, timeout=PATIENCE_S)
    took = time.monotonic() - begin
    sensor.end()
    reports = sorted(out.glob("scan-*/report.json"))
    assert reports, told
    return json.loads(reports[-1].read_text()), took


def service_works_with_it(releases, factory, release_hash):
    """A real service in the place of a cell's: report and row name the release; its times do not know of the network."""
    out, empty = releases.folder / "cell-1", releases.folder / "no-models"

    def scans(count):
        took = []
        for _ in range(count):
            report, seconds = scan(out, empty, releases.of("cell-1"))
            assert report["release"] == release_hash, report
            took.append(seconds)
        return statistics.median(took)

    alone = scans(EACH)
    for name in ("broker", "fleet", "cell-1"):
        factory.kill(name)
    without = scans(EACH)
    for name in ("broker", "fleet", "cell-1"):
        factory.start(name)
    print(f"a real service's scan, start included, median of {EACH}: {alone:.2f} s; with broker, centre and uplink dead: {without:.2f} s")
    comes_true(lambda: factory.shoes_of("cell-1") == SHOES + 2 * EACH, "the service's shoes")
    rows = factory.sql(f"SELECT release, verdict FROM shoes WHERE cell = 'cell-1' ORDER BY id DESC LIMIT {2 * EACH}")
    assert rows == [[release_hash, "refused"]] * (2 * EACH), rows


def forgotten_when_nobody_has_it(releases, factory, first, second):
    """Not the one in force; the one before goes, with its bytes."""
    done = releases.order("--forget", second)
    assert done.returncode != 0 and "is in force in cell-1, cell-2, cell-3" in done.stderr, done
    done = releases.order("--forget", first)
    assert done.returncode == 0, done
    assert factory.sql(f"SELECT (SELECT count(*) FROM releases WHERE number = {first}), (SELECT count(*) FROM release_parts WHERE release = "
                       f"{first})") == [["0", "0"]]
    done = releases.order("--forget", first)
    assert done.returncode == 2 and "there is none" in done.stderr, done


def switch_part(releases, factory):
    first = fetched_while_killed(releases, factory)
    away_is_named(releases, factory, first)
    if silent_cell_stops_it(releases, factory, first):
        releases.switch(first)
    releases.in_force(first)
    second, second_hash = switched_under_load(releases, factory, first)
    service_works_with_it(releases, factory, second_hash)
    forgotten_when_nobody_has_it(releases, factory, first, second)
    print("fetched and checked everywhere, switched at one time, no shoe of two releases")


def orders_part(releases, factory):
    first = releases.brought_into_force("one")
    spoiled_ones_are_refused(releases, factory)
    forged_and_cut_orders_are_refused(releases, factory, first)
    second = releases.brought_into_force("two")
    old_order_is_refused(releases, factory, first, second)
    print("what is forged, spoiled, cut or old is refused by every cell and by the centre")


def main():
    with factory_of(sys.argv[1:5]) as factory:
        releases = Releases(factory)
        for name in ("broker", "database", "fleet", *CELLS):
            factory.start(name)
        comes_true(lambda: factory.sql("SELECT 1 FROM releases") is not None, "the tables")
        for cell in CELLS:
            assert factory.make_shoes(cell, 1, 0).wait(PATIENCE_S) == 0  # a memory, so that the cell speaks
        {"switch": switch_part, "orders": orders_part}[PART](releases, factory)


main()
