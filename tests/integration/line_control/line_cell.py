# SPDX-License-Identifier: MIT
"""A cell for tests of the line's doors: sensor, service and web program, all real but the sensor's devices."""
import json
import pathlib
import socket
import sys
import tempfile
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from programs import PATIENCE_S, Program, comes_true

NAMES = (
    "map heartbeat step ready busy done taken finished verdict job model sent followed refusal scan starts ok amber refused "
    "failed length_mm u95_um confidence review"
).split()
READY, STOPPED, AWAY = 1, 6, 0
PART_BYTES, PART_REGISTERS = 64, 32
JOBS = "jobs:\n  1: {}\n  2: {process: grind}\n  7: {model: not-there}\n  8: {foot: left, size: EU 42}\n"


class Cell:
    def __init__(self, host, web, sensor):
        self.folder = tempfile.TemporaryDirectory()
        jobs = pathlib.Path(self.folder.name, "jobs.yaml")
        jobs.write_text(JOBS)
        self.sensor = Program(sensor)
        endpoint = self.sensor.line_with("tcp://")
        self.host = Program(host, "--sensor", endpoint, "--out", self.folder.name + "/results", "--control", "tcp://127.0.0.1:0",
                            "--jobs", str(jobs), "--exit-with-parent")
        control = self.host.line_with("doors come in at").split()[-1]
        self.web = Program(web, "--listen", "127.0.0.1:0", "--control", control, "--modbus", "127.0.0.1:0", "--text", "127.0.0.1:0",
                           "--exit-with-parent")
        self.http = self.web.line_with("http://").split()[-1]
        self.text_port = int(self.web.line_with("text without login").split()[-1])
        self.modbus_port = int(self.web.line_with("Modbus TCP without login").split()[-1])

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        if kind:
            for one in (self.sensor, self.host, self.web):
                print("---", one.process.args[0], *one.lines[-20:], sep="\n")
        for one in (self.web, self.host, self.sensor):
            if one.process.poll() is None:
                one.end()
        self.folder.cleanup()

    def scans_asked(self):
        return sum(line.startswith("start ") for line in self.sensor.lines)

    def call(self, method, path, body=None, token=None):
        request = urllib.request.Request(self.http + "/api/v1" + path, method=method)
        if token:
            request.add_header("Authorization", "Bearer " + token)
        if body is not None:
            request.add_header("Content-Type", "application/json")
            request.data = json.dumps(body).encode()
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
                return answer.status, json.loads(answer.read() or b"null")
        except urllib.error.HTTPError as error:
            return error.code, json.loads(error.read() or b"null")

    def log_in(self):
        ada = {"name": "ada", "password": "a long password"}
        assert self.call("POST", "/users", {**ada, "role": "administrator"})[0] == 201
        return self.call("POST", "/sessions", ada)[1]["token"]


class TextPeer:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
        self.reader = self.socket.makefile("rb")

    def ask(self, line):
        self.socket.sendall(line.encode() + b"\n")
        answer = self.reader.readline()
        return [int(number) for number in answer.strip().strip(b"()").split(b",")] if answer else None

    def state(self):
        return dict(zip(NAMES, self.ask("STATE"), strict=True))

    def shoe(self):
        """The part number of the last scan."""
        self.socket.sendall(b"SHOE\n")
        return self.reader.readline().decode()

    def ended(self):
        """The door closed this connection."""
        try:
            return self.socket.recv(1) == b""
        except ConnectionError:
            return True
