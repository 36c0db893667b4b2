#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sparkplug_test.py UPLINK FLEET MADE_CELL BROKER_FILES WEB: a cell as a host of Sparkplug B sees it, over a real broker.

Payloads are read and written by npm's sparkplug-payload, the line is mosquitto's own client.
"""
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import time

from factory import GROUP, factory_of, skip
from programs import PATIENCE_S, Program, comes_true

JUDGE = pathlib.Path(__file__).with_name("sparkplug_judge.mjs")
CELL = "cell-1"
SHOES = 12


def judge(web, task, text=""):
    done = subprocess.run(["node", JUDGE, web, task], input=text, capture_output=True, text=True)
    if done.returncode == 77:
        skip("sparkplug-payload is needed: npm ci in host/web")
    assert done.returncode == 0, done.stderr
    return done.stdout


class Host:
    """Hears all that cells tell."""

    def __init__(self, factory, web):
        self.web = web
        self.tls = ["-h", "127.0.0.1", "-p", "8883", "--cafile", factory.folder / "ca.pem", "--cert", factory.folder / "host.pem",
                    "--key", factory.folder / "host.key", "-V", "5"]
        self.ear = Program("mosquitto_sub", *self.tls, "-t", "spBv1.0/#", "-F", "%t %x")

    def heard(self):
        return [json.loads(line) for line in judge(self.web, "read", "\n".join(list(self.ear.lines))).splitlines()]

    def of(self, kind):
        return [one for one in self.heard() if one["topic"] == f"spBv1.0/{GROUP}/{kind}/{CELL}"]

    def ask_rebirth(self, folder):
        file = folder / "command"
        file.write_bytes(bytes.fromhex(judge(self.web, "rebirth")))
        subprocess.run(["mosquitto_pub", *map(str, self.tls), "-t", f"spBv1.0/{GROUP}/NCMD/{CELL}", "-f", file], check=True)


def value(message, name):
    return message["metrics"][name]["value"]


def check_order(heard):
    """A birth begins with seq 0, data count on, and a death has the number of its birth."""
    line, seq = None, None
    for message in heard:
        kind = message["topic"].split("/")[2]
        if kind == "NBIRTH":
            assert message["seq"] == 0, message
            line, seq = value(message, "bdSeq"), 0
        elif kind == "NDATA":
            assert message["seq"] == (seq + 1) % 256, (message, seq)
            seq = message["seq"]
        elif kind == "NDEATH":
            assert value(message, "bdSeq") == line and message["seq"] is None, (message, line)


def main():
    web = sys.argv[5]
    if not shutil.which("mosquitto_sub") or not shutil.which("node"):
        skip("mosquitto-clients and node are needed")
    judge(web, "rebirth")
    with factory_of(sys.argv[1:5]) as factory:
        factory.start("broker")
        comes_true(lambda: any("running" in line for line in factory.running["broker"].lines), "the broker runs")
        host = Host(factory, web)
        factory.others.append(host.ear)
        time.sleep(0.5)
        factory.start(CELL)
        birth = comes_true(lambda: host.of("NBIRTH"), "a birth")[0]
        assert birth["metrics"]["Last shoe/Length mm"] == {"type": "Double", "value": None}, birth
        assert birth["metrics"]["Last shoe/Time"]["type"] == "DateTime", birth

        def told_shoes():
            return [value(one, "Last shoe/Scan") for one in host.of("NDATA") if "Last shoe/Scan" in one["metrics"]]

        # The first look at a memory tells of its last shoe; from there on each is told.
        last = f"scan-{SHOES:04d}"
        assert factory.make_shoes(CELL, 1, 1).wait(PATIENCE_S) == 0
        comes_true(told_shoes, "the first shoe")
        assert factory.make_shoes(CELL, 2, SHOES - 1).wait(PATIENCE_S) == 0
        comes_true(lambda: last in told_shoes(), "the last shoe")
        told = told_shoes()
        assert [name for at, name in enumerate(told) if name not in told[:at]] == [f"scan-{n:04d}" for n in range(1, SHOES + 1)], told

        host.ask_rebirth(factory.folder)
        again = comes_true(lambda: host.of("NBIRTH")[1:], "the birth again")[0]
        assert value(again, "bdSeq") == value(birth, "bdSeq")
        assert value(again, "Last shoe/Scan") == last and abs(value(again, "Last shoe/Length mm") - 800 - 0.01 * SHOES) < 1e-9, again
        assert value(again, "Last shoe/Time") == 1_795_000_000_000 + 20_000 * SHOES, again

        factory.kill(CELL)  # the broker tells it
        assert comes_true(lambda: host.of("NDEATH"), "a death by the broker")
        factory.start(CELL)
        later = comes_true(lambda: host.of("NBIRTH")[2:], "the birth of the next line")[0]
        # A death of the line before that comes late is never this line's.
        assert value(later, "bdSeq") == (value(birth, "bdSeq") + 1) % 256, (birth, later)
        factory.running.pop(CELL).end(signal.SIGTERM)  # in order: it tells it itself
        comes_true(lambda: host.of("NDEATH")[1:], "a death in order")
        check_order(host.heard())
    print("births, data and deaths as the standard asks")


main()
