# SPDX-License-Identifier: MIT
"""A factory for tests: a broker with TLS, a database, a centre and three cells, all real programs.

Leaves with 77 (skipped) where the daemons are not installed or this is not root.
"""
import contextlib
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from programs import Program

CELLS = ("cell-1", "cell-2", "cell-3")
REAL_CELL = "cell-4"  # of tests in which a real service works
POSTGRES = pathlib.Path("/usr/lib/postgresql/15/bin")
GROUP = "plant-1"
EACH_MS = 60


def skip(why):
    print("skipped:", why)
    sys.exit(77)


if not shutil.which("mosquitto", path="/usr/sbin:/usr/bin") or not (POSTGRES / "postgres").exists():
    skip("mosquitto and postgresql-15 are needed")
if os.geteuid() != 0:
    skip("the daemons' users need root")


class Factory:
    def __init__(self, folder, uplink, fleet, made_cell, broker_files):
        self.folder, self.uplink, self.fleet, self.made_cell = folder, uplink, fleet, made_cell
        self.running = {}
        self.others = []  # programs beside the factory's own, that end before it
        self.uplink_options = lambda cell: []
        self.fleet_options = []
        self.ended = []
        folder.chmod(0o755)
        self.make_certificates()
        self.make_broker_files(pathlib.Path(broker_files))
        self.make_database()
        for cell in (*CELLS, REAL_CELL):
            (folder / cell).mkdir()

    def make_certificates(self):
        def openssl(*words):
            subprocess.run(["openssl", *words], check=True, capture_output=True, cwd=self.folder)

        openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", "ca.key", "-out", "ca.pem",
                "-subj", "/CN=factory", "-days", "2")
        self.folder.joinpath("names").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
        for name in ("broker", "fleet", "host", *CELLS, REAL_CELL):
            openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", name + ".key", "-out", name + ".csr",
                    "-subj", "/CN=" + name)
            openssl("x509", "-req", "-in", name + ".csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-out", name + ".pem",
                    "-days", "2", "-extfile", "names")
        self.folder.joinpath("broker.key").chmod(0o644)

    def make_broker_files(self, shipped):
        """The shipped files, with this test's paths."""
        text = shipped.joinpath("mosquitto.conf").read_text().replace("/etc/biteline/fleet/", f"{self.folder}/")
        (self.folder / "persistence").mkdir()
        shutil.chown(self.folder / "persistence", "mosquitto")
        text = text.replace("/var/lib/mosquitto/", f"{self.folder}/persistence/")
        self.folder.joinpath("mosquitto.conf").write_text(text)
        shutil.copy(shipped / "acl", self.folder / "acl")

    def make_database(self):
        data = self.folder / "data"
        data.mkdir()
        shutil.chown(data, "postgres", "postgres")
        subprocess.run([POSTGRES / "initdb", "-D", data, "-A", "trust", "-E", "UTF8", "--locale=C"], check=True, capture_output=True,
                       user="postgres", cwd="/")

    def database(self):
        return "host=127.0.0.1 port=5432 user=postgres dbname=postgres connect_timeout=3"

    def sql(self, statement):
        done = subprocess.run(["psql", "-X", "-A", "-t", "-F", "\t", "-d", self.database(), "-c", statement], capture_output=True, text=True)
        return [line.split("\t") for line in done.stdout.splitlines()] if done.returncode == 0 else None

    def start(self, name):
        def tls(end):
            return ["--broker", "mqtts://127.0.0.1:8883", "--ca", self.folder / "ca.pem", "--certificate", self.folder / f"{end}.pem",
                    "--key", self.folder / f"{end}.key", "--exit-with-parent"]

        if name == "broker":
            self.running[name] = Program("/usr/sbin/mosquitto", "-c", self.folder / "mosquitto.conf")
        elif name == "database":
            # Killed as a whole: its children end with it, and nothing is left that would hold its memory.
            self.running[name] = Program(POSTGRES / "postgres", "-D", self.folder / "data", "-c", "listen_addresses=127.0.0.1",
                                         "-c", "unix_socket_directories=", "-c", "max_wal_size=64MB", user="postgres", cwd="/")
        elif name == "fleet":
            self.running[name] = Program(self.fleet, "--database", self.database(), "--metrics", "9118",
                                         "--accounts", self.folder / "accounts", *self.fleet_options, *tls("fleet"))
        else:
            self.running[name] = Program(self.uplink, "--results", self.folder / name, "--cell", name,
                                         "--sparkplug", GROUP, *self.uplink_options(name), *tls(name))

    def kill(self, name):
        program = self.running.pop(name)
        if name == "database":
            # SIGQUIT is the database's immediate end, without a checkpoint, with all its processes.
            program.end(signal.SIGQUIT)
        else:
            program.end(signal.SIGKILL)
        self.ended.append(program)

    def make_shoes(self, cell, first, count, *more):
        return subprocess.Popen([self.made_cell, self.folder / cell, str(first), str(count), str(EACH_MS), *more], stdout=subprocess.PIPE,
                                text=True)

    def shoes_of(self, cell):
        rows = self.sql(f"SELECT count(*) FROM shoes WHERE cell = '{cell}'")
        return int(rows[0][0]) if rows else -1

    def end(self):
        for program in self.others:
            program.end()
        for program in self.running.values():
            program.end(signal.SIGQUIT if "postgres" in program.command[0] else signal.SIGTERM)


@contextlib.contextmanager
def factory_of(arguments):
    """A factory for the body, in a folder of its own; where the body fails, its programs' last words are told."""
    with tempfile.TemporaryDirectory() as folder:
        factory = Factory(pathlib.Path(folder), *arguments)
        try:
            yield factory
        except BaseException:
            for program in [*factory.ended, *factory.running.values(), *factory.others]:
                print("---", *program.command[:3], *program.lines[-12:], sep="\n")
            raise
        finally:
            factory.end()


def put_odd_cells(factory, first, count, off_mm):
    """Shoes of eight cells that nobody has seen, straight into the database; the lines of odd-4 are wider by off_mm."""
    rng = random.Random(first)
    rows = []
    for number in range(first, first + count):
        for cell in range(8):
            wide = rng.gauss(0, 0.05) + (off_mm if cell == 4 else 0)
            places = ",".join(f"{wide + rng.gauss(0, 0.1):.4f}" for _ in range(36))
            rows.append(f"('odd-{cell}','b','scan-{number:04d}',{number},{number},now(),'loafer','ok','','','','open',false,false,'{{{places}}}')")
    assert factory.sql("INSERT INTO books SELECT 'odd-' || n, 'b', 0 FROM generate_series(0, 7) AS n ON CONFLICT DO NOTHING") is not None
    assert factory.sql("INSERT INTO shoes (cell, book, scan, first_seq, last_seq, time, model, verdict, reason_code, reason, process, "
                       "decision, sent, followed, places) VALUES " + ",".join(rows)) is not None
