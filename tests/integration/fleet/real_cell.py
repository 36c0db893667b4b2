# SPDX-License-Identifier: MIT
"""A cell whose service and sensor are the real programs; what the sensor sees is a recorded scan."""
import json
import signal
import sqlite3
import subprocess
import threading

from programs import PATIENCE_S, Program, comes_true


class RealCell:
    """Scans one after the other on a thread of its own; the service can be killed at any moment."""

    def __init__(self, out, host, sensor, root):
        self.out, self.host, self.sensor, self.root = out, host, sensor, root
        self.service = None
        self.killed = 0
        self.fault = None
        self.thread = None
        self.enough = threading.Event()

    def begin(self, scans):
        """At least so many, and on until finish(): how many that are is the machine's affair."""
        self.thread = threading.Thread(target=self.run, args=(scans,), daemon=True)
        self.thread.start()

    def run(self, scans):
        try:
            while scans > 0 or not self.enough.is_set():
                self.scan()
                scans -= 1
        except BaseException as error:  # told by finish(), on the test's own thread
            self.fault = error

    def scan(self):
        sensor = Program(self.sensor, "--source", f"replay:{self.root}/tests/golden/part", "--exit-with-parent")
        try:
            endpoint = json.loads(sensor.line_with("endpoint"))["endpoint"]
            self.service = subprocess.Popen([self.host, "--sensor", endpoint, "--out", self.out, "--once"], stdout=subprocess.PIPE,
                                            stderr=subprocess.STDOUT, text=True)
            told = self.service.communicate(timeout=PATIENCE_S)[0]
            # A recorded part of a shoe is refused (3), and that is a result like any other.
            assert self.service.returncode in (0, 3, -signal.SIGKILL), (self.service.returncode, told)
        finally:
            sensor.end()

    def kill_in_a_scan(self):
        """While a scan comes in or is worked out: its folder has no report yet."""
        def in_work():
            return self.service and self.service.poll() is None and any(
                not (folder / "report.json").exists() for folder in self.out.glob("scan-*"))

        comes_true(lambda: in_work() or not self.thread.is_alive(), "the real service is at work")
        if self.thread.is_alive():
            self.service.send_signal(signal.SIGKILL)
            self.killed += 1

    def finish(self):
        self.enough.set()
        self.thread.join(10 * PATIENCE_S)
        assert not self.thread.is_alive(), "the real service does not come to an end"
        if self.fault:
            raise self.fault

    def memory(self):
        """What the service itself remembers, in the order of its own file."""
        with sqlite3.connect(f"file:{self.out}/memory.sqlite?mode=ro", uri=True) as file:
            return [list(row) for row in file.execute("SELECT name, verdict, reason_code FROM scans ORDER BY id")]
