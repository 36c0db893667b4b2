# SPDX-License-Identifier: MIT
"""A cell whose stops are watched from outside: the real service and web program, made scans, the simulated arm.

The arm is read over its real-time port by a client of this test's own, so that nobody's word but the controller's counts.
"""
import json
import pathlib
import queue
import resource
import signal
import socket
import sqlite3
import struct
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from programs import PATIENCE_S, Program, comes_true

RATE_HZ = 125
MOVED_RAD, MOVED_STATES = 5e-4, 5  # 0.7 degrees/s; less is the encoders' noise
KEPT_STATES = 60 * RATE_HZ


def uncertainty_text():
    """A head that is known exactly, but for its poses."""
    def rows(count, width):
        return "".join("  - [" + ", ".join(["0"] * width) + "]\n" for _ in range(count))
    return ("plane_middle_cam: [0, 0, 0]\nplane_axes:\n" + rows(3, 2) + "covariance:\n" + rows(19, 19)
            + "pose_sigma_mm: 0.01\npose_sigma_rad: 5.2e-05\n")


class Arm:
    """What the controller says of itself, each state with the time at which it came."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=PATIENCE_S)
        self.states = []  # (time, six joints, output bits, program runs)
        self.say("V", struct.pack(">H", 2))
        self.hear("V")
        self.say("O", struct.pack(">d", RATE_HZ) + b"actual_q,actual_digital_output_bits,runtime_state")
        self.hear("O")
        self.say("S", b"")
        self.hear("S")
        threading.Thread(target=self.read, daemon=True).start()

    def say(self, kind, body):
        self.socket.sendall(struct.pack(">HB", 3 + len(body), ord(kind)) + body)

    def exact(self, count):
        data = b""
        while len(data) < count:
            got = self.socket.recv(count - len(data))
            if not got:
                raise ConnectionError("the controller is gone")
            data += got
        return data

    def package(self):
        size, kind = struct.unpack(">HB", self.exact(3))
        return chr(kind), self.exact(size - 3)

    def hear(self, kind):
        while True:
            got, body = self.package()
            if got == kind:
                return body

    def read(self):
        try:
            while True:
                kind, body = self.package()
                if kind != "U":
                    continue
                values = struct.unpack(">6dQI", body[1:])
                self.states.append((time.monotonic(), values[:6], values[6], values[7] != 1))
                if len(self.states) > 2 * KEPT_STATES:
                    self.states = self.states[-KEPT_STATES:]
        except OSError:
            pass

    def moved_after(self, since):
        """The time of the last state that differs from one 40 ms before it; nothing: it stood all along."""
        last = None
        states = [state for state in list(self.states) if state[0] >= since]
        for before, after in zip(states, states[MOVED_STATES:]):
            if max(abs(a - b) for a, b in zip(before[1], after[1])) > MOVED_RAD:
                last = after[0]
        return last

    def now(self):
        return self.states[-1]


class ControlEnd:
    """As much of ZMTP 3.0 (NULL) as says JSON to the service without anything between."""

    def __init__(self, endpoint):
        host, port = endpoint.replace("tcp://", "").rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=PATIENCE_S)
        self.socket.sendall(b"\xff" + bytes(8) + b"\x7f\x03\x00" + b"NULL".ljust(20, b"\0") + bytes(32))
        self.exact(64)
        ready = b"\x05READY\x0bSocket-Type" + struct.pack(">I", 6) + b"DEALER\x08Identity" + struct.pack(">I", 0)
        self.socket.sendall(bytes([4, len(ready)]) + ready)
        self.frame()
        self.id = 0
        self.sending = threading.Lock()
        self.answers = queue.Queue()
        self.socket.settimeout(None)
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        try:
            while True:
                flags, data = self.frame()
                if flags & 4 and data.startswith(b"\x04PING"):
                    pong = b"\x04PONG" + data[7:]
                    with self.sending:
                        self.socket.sendall(bytes([4, len(pong)]) + pong)
                elif not flags & 4:
                    self.answers.put(json.loads(data))
        except (OSError, ValueError):
            pass

    def exact(self, count):
        data = b""
        while len(data) < count:
            got = self.socket.recv(count - len(data))
            if not got:
                raise ConnectionError("the control end is gone")
            data += got
        return data

    def frame(self):
        flags = self.exact(1)[0]
        size = struct.unpack(">Q", self.exact(8))[0] if flags & 2 else self.exact(1)[0]
        return flags, self.exact(size)

    def say(self, method, path, body=None, token=""):
        self.id += 1
        text = json.dumps({"id": self.id, "token": token, "local": True, "door": "web", "method": method, "path": "/api/v1" + path,
                           "query": {}, "body": body}).encode()
        head = b"\x00" + bytes([len(text)]) if len(text) < 256 else b"\x02" + struct.pack(">Q", len(text))
        with self.sending:
            self.socket.sendall(head + text)
        return self.id

    def ask(self, method, path, body=None, token=""):
        asked = self.say(method, path, body, token)
        while True:
            answer = self.answers.get(timeout=PATIENCE_S)
            if answer.get("id") == asked and "status" in answer:
                return answer["status"], answer.get("body")


class Cell:
    def __init__(self, host, web, sensor, cell, processes, changed="slipped", gate="", more=()):
        """`changed`: what the sensor sees after change(); `gate`: more keys of the process's gate; `more`: options of the service."""
        self.folder = tempfile.TemporaryDirectory()
        out = pathlib.Path(self.folder.name)
        self.results = out / "results"
        (out / "uncertainty.yaml").write_text(uncertainty_text())
        (out / "jobs.yaml").write_text("jobs:\n  1: {}\n")
        process = (pathlib.Path(processes) / "grind.yaml").read_text().replace("tolerance_mm: 1 ", "tolerance_mm: 20 ") + gate
        (out / "grind.yaml").write_text(process)
        self.world = Program(cell, "serve", "--out", str(out / "cell"), "--arm", "ur10e", "--exit-with-parent")
        self.sensor = Program(sensor, "1000000", changed)
        at = json.loads(self.world.line_with('"rtde"'))
        # A limit on its files stands for a full disk, and is no signal then.
        self.host = Program("/bin/sh", "-c", "trap '' XFSZ; exec \"$@\"", "sh", host, "--sensor", self.sensor.line_with("tcp://"), "--out", str(self.results), "--uncertainty",
                            str(out / "uncertainty.yaml"), "--robot", "ur10e", "--process", str(out / "grind.yaml"), "--table-z",
                            str(at["table_z_mm"]), "--rtde", at["rtde"], "--script", at["primary"], "--dashboard", at["dashboard"],
                            "--send", "--library", str(out / "models"), "--control", "tcp://127.0.0.1:0", "--jobs", str(out / "jobs.yaml"), *more, "--exit-with-parent")
        self.control = self.host.line_with("doors come in at").split()[-1]
        self.web = Program(web, "--listen", "127.0.0.1:0", "--control", self.control, "--text", "127.0.0.1:0", "--modbus", "127.0.0.1:0",
                           "--exit-with-parent")
        self.http = self.web.line_with("http://").split()[-1]
        self.text_port = int(self.web.line_with("text without login").split()[-1])
        self.modbus_port = int(self.web.line_with("Modbus TCP without login").split()[-1])
        self.arm = Arm(at["rtde"])
        ada = {"name": "ada", "password": "a long password"}
        assert self.call("POST", "/users", {**ada, "role": "administrator"})[0] == 201
        self.token = self.call("POST", "/sessions", ada)[1]["token"]
        assert self.call("POST", "/users", {"name": "vic", "role": "viewer", "password": "a long password"}, self.token)[0] == 201
        self.viewer = self.call("POST", "/sessions", {"name": "vic", "password": "a long password"})[1]["token"]
        assert self.call("POST", "/control", {"action": "take"}, self.token)[0] == 200

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        programs = (self.web, self.host, self.sensor, self.world)
        if kind:
            for one in programs:
                print("---", one.process.args[0], *one.lines[-25:], sep="\n")
        for one in programs:
            if one.process.poll() is None:
                one.end()
        self.folder.cleanup()

    def call(self, method, path, body=None, token=None, patience_s=PATIENCE_S):
        request = urllib.request.Request(self.http + "/api/v1" + path, method=method)
        if token:
            request.add_header("Authorization", "Bearer " + token)
        if body is not None:
            request.add_header("Content-Type", "application/json")
            request.data = json.dumps(body).encode()
        try:
            with urllib.request.urlopen(request, timeout=patience_s) as answer:
                data = answer.read()
                return answer.status, json.loads(data) if "json" in answer.headers.get("Content-Type", "") and data else None
        except urllib.error.HTTPError as error:
            return error.code, json.loads(error.read() or b"null")

    def told(self, path):
        """What the service says, once it says anything: behind a full queue a page is told to ask again."""
        return comes_true(lambda: (lambda status, body: body if status == 200 else None)(*self.call("GET", path, token=self.token)),
                          "an answer to " + path)

    def state(self):
        return self.told("/state")

    def said(self, words, since=0):
        """Lines of the service from line `since` on that have the words."""
        return [line for line in self.host.lines[since:] if words in line]

    def start(self, hold=False):
        """A start, once the cell takes one; the number of lines that the service had said before it."""
        begin = len(self.host.lines)

        def taken():
            lines = len(self.host.lines)
            status, body = self.call("POST", "/commands/start", {"hold": hold}, self.token)
            # An answer that came too late on a busy machine: the start itself may have been heard.
            if status == 202 or (status == 504 and self.said("started by", begin)):
                return lines + 1
            assert status in (409, 503, 504), (status, body)
            return None
        return comes_true(taken, "a start is taken") - 1

    def newest(self):
        """The last scan that has a row: its name."""
        scans = self.told("/scans?limit=1")["scans"]
        return scans[0]["id"] if scans else ""

    def held(self):
        """A scan that waits for a word, started for it; the made scan's rays are far apart, so now and then there is no path."""
        for _ in range(8):
            before = self.newest()
            self.start(hold=True)

            # A row may be there before the path is planned, and that of an older scan may come late.
            def decided():
                state = self.state()
                return state["held"] or (state["phase"] == "waiting" and self.newest() != before)

            comes_true(decided, "the scan's result")
            scan = self.state()["held"]
            if scan is None:
                continue
            if scan["waits_for"] == "word":
                comes_true(lambda: self.state()["phase"] == "deciding", "it is decided")
                return scan["scan"]
            assert self.call("POST", f"/scans/{scan['scan']}/reject", {"why": "no path"}, self.token)[0] == 200
        raise AssertionError("no scan of eight has a path")

    def change(self):
        self.sensor.process.send_signal(signal.SIGUSR1)

    def limit_files(self, most_bytes):
        """No file of the service grows beyond that from now on, as on a full disk."""
        resource.prlimit(self.host.process.pid, resource.RLIMIT_FSIZE, (most_bytes, resource.RLIM_INFINITY))

    def row(self, scan):
        return self.told("/scans/" + scan)

    def is_stopped(self):
        comes_true(lambda: self.state()["phase"] == "stopped", "the phase is stopped")

    def stands(self, since, patience_s=20):
        """Until the arm has stood for a second with its tool off and no program; when it moved last."""
        def rests():
            moved = self.arm.moved_after(since)
            _, _, outputs, runs = self.arm.now()
            return time.monotonic() - max(moved or 0, since) > 1 and outputs == 0 and not runs
        comes_true(rests, "the arm stands, its tool is off", patience_s)
        return self.arm.moved_after(since)


class Doors:
    """A stop through each of the cell's doors; each has its connection open, as a page or a PLC has."""
    NAMES = ("page", "session", "text", "modbus", "control")

    def __init__(self, cell):
        self.cell = cell
        self.text = socket.create_connection(("127.0.0.1", cell.text_port), timeout=PATIENCE_S)
        self.modbus = socket.create_connection(("127.0.0.1", cell.modbus_port), timeout=PATIENCE_S)
        self.end = ControlEnd(cell.control)

    def stop(self, door):
        if door == "page":
            assert self.cell.call("POST", "/commands/stop")[0] == 200
        elif door == "session":
            assert self.cell.call("POST", "/commands/stop", token=self.cell.token)[0] == 200
        elif door == "text":
            self.text = self.kept(self.text, self.cell.text_port)
            self.text.sendall(b"STOP\n")
            assert self.text.recv(100) == b"(0)\n"
        elif door == "modbus":
            self.modbus = self.kept(self.modbus, self.cell.modbus_port)
            frame = struct.pack(">HHHBBHH", 1, 0, 6, 1, 6, 2, 1)
            self.modbus.sendall(frame)
            assert self.modbus.recv(100) == frame
        else:
            assert self.end.ask("POST", "/commands/stop")[0] == 200

    def kept(self, peer, port):
        """A door ends who asks nothing for 60 s."""
        peer.setblocking(False)
        try:
            ended = peer.recv(1) == b""
        except BlockingIOError:
            ended = False
        except OSError:
            ended = True
        peer.settimeout(PATIENCE_S)
        return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) if ended else peer


class Load:
    """What may hold a stop up, for as long as it is entered."""
    NAMES = ("none", "passwords", "memory lock", "histories", "full queue")

    def __init__(self, cell, name):
        self.cell, self.name, self.over = cell, name, threading.Event()
        self.threads = []

    def again(self, work):
        def run():
            while not self.over.is_set():
                try:
                    work()
                except (OSError, ValueError, queue.Empty):
                    time.sleep(0.05)
        self.threads.append(threading.Thread(target=run, daemon=True))

    def lock_memory(self):
        """As another program that writes, or a backup by hand; 1.5 s at a time, so that the service gets on."""
        memory = sqlite3.connect(self.cell.results / "memory.sqlite", isolation_level=None, timeout=10)
        memory.execute("BEGIN IMMEDIATE")
        self.over.wait(1.5)
        memory.execute("ROLLBACK")
        memory.close()
        time.sleep(0.05)

    def __enter__(self):
        call, viewer = self.cell.call, self.cell.viewer
        if self.name == "passwords":
            for _ in range(24):
                self.again(lambda: call("PATCH", "/users/vic", {"password": "x" * 12, "old_password": "wrong wrong"}, viewer))
        elif self.name == "memory lock":
            self.again(self.lock_memory)
            for _ in range(3):
                self.again(lambda: call("POST", "/sessions", {"name": "vic", "password": "a long password"}))
        elif self.name == "histories":
            for path in ("/history/trends?bucket=hour", "/history.csv", "/scans?limit=1000", "/history/trends?bucket=day"):
                self.again(lambda path=path: call("GET", path, token=viewer))
        elif self.name == "full queue":
            for _ in range(5):
                door = ControlEnd(self.cell.control)
                self.again(lambda door=door: [door.say("PATCH", "/users/vic", {"password": "x" * 12, "old_password": "w"}, viewer)
                                              for _ in range(31)] and door.ask("GET", "/state", token=viewer))
        for one in self.threads:
            one.start()
        if self.threads:
            time.sleep(0.3)
        return self

    def __exit__(self, *_):
        self.over.set()
        for one in self.threads:
            one.join(PATIENCE_S)
