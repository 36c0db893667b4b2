#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""api_property_test.py BIN SOURCE [SEED]: requests made of openapi.yaml, to the real programs of a cell and of a centre.

Each operation is asked many times by each role and by nobody, with and without control.  For each answer:
  - the document describes its status at this operation, and its body;
  - it is no 500, and no program ends;
  - who has too low a role is told 403, who is not logged in 401, who has no control 409.
The cell has one finished scan, and neither sensor nor arm; the centre has neither broker nor database.  SEED repeats a run.
Exit 1: a disagreement; 77: this machine lacks what the test needs.
"""
import json
import pathlib
import socket
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from asked_api import PASSWORD, AskedApi
from check_api_answers import Api
from made_requests import Maker
from programs import Program, comes_true

CELL_ROUNDS, CENTRE_ROUNDS = 60, 20
# Without arm, sensor and a waiting scan no request makes these succeed at the cell.  Each other one must, at least once:
# else the requests here are not such as the document means.
NEVER_GOOD = {"accept_scan", "change_settings", "choose_model", "choose_process", "hold_scan", "import_model", "keep_recording", "look_again",
              "mend_scan", "reject_scan", "run_in_air", "see_dry_run", "send_scan"}
# It must name the one teaching that is open just then: tests/unit/host/interfaces/api looks at it.
SELDOM_GOOD = {"give_up_teaching"}
KNOWN = {
    # Of scans; the numbers are those of teachings.
    "id": ["scan-0001", "scan-0001", "scan-0001", "scan-0002", *range(1, 9)],
    "scan": ["scan-0001", "scan-0001", "scan-0001", "scan-0002"],
    "path": ["line.csv", "report.json", "cloud.ply", "stages", "no/such.png"],
    "name": ["derby", "rough", "cement", "guest"],
    "model": ["derby", "no-such-model"],
    "process": ["rough", "cement", "no-such-process"],
    "user": ["guest", "derby", "rough"],
    "to": ["the-engineer", "guest"],
    "from": ["2026-11-27", "2026-11-27T08:00:00Z"],
    "cursor": ["5"],
    "limit": [1, 10],
    "cell": ["cell-1"],
    "Range": ["bytes=0-9", "bytes=5-", "bytes=999999999-"],
    "keep_mounted": [{"kg": 1.5, "centre_mm": [0, 0, 60]}],
    "log_in": [{"name": "the-viewer", "password": PASSWORD}],
    "settings": [{"camera.exposure_us": 250}, {"model": "derby"}, {"method": "default"}],
}


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class World:
    def __init__(self, binaries, source, folder):
        self.binaries, self.source, self.folder = binaries, source, folder
        self.running = []

    def start(self, name, *arguments, says):
        self.running.append(Program(self.binaries / name, *arguments, "--exit-with-parent"))
        self.running[-1].line_with(says)
        return self.running[-1]

    def start_web(self, control):
        port = free_port()
        self.start("biteline-web", "--listen", f"127.0.0.1:{port}", "--control", control, says="http://")
        return port

    def start_cell(self):
        results = self.folder / "results"
        sample = self.source / "tests/golden/sample/cloud.ply"
        subprocess.run([self.binaries / "biteline", "extract", sample, "--out", results / "scan-0001"], check=True, capture_output=True)
        control = f"tcp://127.0.0.1:{free_port()}"
        rough = self.source / "host/robot/path/processes/rough.yaml"
        nobody = [f"127.0.0.1:{free_port()}" for _ in range(3)]
        arguments = ["--out", results, "--library", self.folder / "models", "--control", control, "--sensor", f"tcp://{nobody[0]}", "--robot", "ur5e",
                     "--process", rough, "--table-z", "0", "--rtde", nobody[1], "--script", nobody[2]]
        self.start("biteline-host", *arguments, says="doors come in at")
        return self.start_web(control)

    def start_centre(self):
        control = f"tcp://127.0.0.1:{free_port()}"
        self.start("biteline-fleet", "--database", "host=127.0.0.1 port=1 connect_timeout=1", "--broker", "mqtt://127.0.0.1:1", "--control", control,
                   "--accounts", self.folder / "accounts", says=control)
        return self.start_web(control)

    def alive(self):
        ended = [one.command[0] for one in self.running if one.process.poll() is not None]
        assert not ended, f"{', '.join(ended)} ended"

    def end(self):
        for one in reversed(self.running):
            one.end()


def ask(world, port, api, at_centre, seed):
    asked = AskedApi(port, api, has_control=not at_centre)
    comes_true(lambda: asked.ask("GET", "/api/v1/state")[0] == 401, "the service is found")
    asked.make_accounts()
    known = KNOWN
    if not at_centre:
        asked.call("POST", "/models", {"name": "derby", "scan": "scan-0001"}, "administrator")
        process = json.loads(asked.ask("GET", "/api/v1/processes/rough", b"", asked.session("administrator"))[2])["process"]
        known = KNOWN | {"process": [*KNOWN["process"], process], "write_process": [process]}
    asked.ask_everything(CENTRE_ROUNDS if at_centre else CELL_ROUNDS, seed, known, world.alive)
    asked.log_everybody_out()
    print(asked.table())
    if not at_centre:
        public = {one["operationId"] for path, _, _, one in Maker(api.text, 0, {}).operations() if not path.startswith("/fleet/")}
        asked.faults += [f"{name}: none of its requests succeeded" for name in sorted(public - asked.good - NEVER_GOOD - SELDOM_GOOD)]
    for fault in asked.faults[:60]:
        print(fault)
    print(f"{'centre' if at_centre else 'cell'}: {asked.asked()} requests to {len(asked.statuses)} operations, {len(asked.faults)} faults")
    return len(asked.faults)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    binaries, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 58
    for name in ("biteline", "biteline-host", "biteline-web", "biteline-fleet"):
        if not (binaries / name).exists():
            print(f"skipped: {name} was not built")
            sys.exit(77)
    began = time.monotonic()
    api = Api(source / "host/web/openapi.yaml")
    faults = 0
    with tempfile.TemporaryDirectory() as work:
        for at_centre in (False, True):
            world = World(binaries, source, pathlib.Path(work))
            try:
                faults += ask(world, world.start_centre() if at_centre else world.start_cell(), api, at_centre, seed)
            except BaseException:
                for one in world.running:
                    print(" ".join(one.command), *one.lines[-12:], sep="\n  ")
                raise
            finally:
                world.end()
    print(f"seed {seed}, {time.monotonic() - began:.0f} s")
    sys.exit(1 if faults else 0)


main()
