#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""rate_test.py SENSOR CELL: a rate that the camera has is told as reached, and one that it has not as missed; the laser stays dark.

Leaves with 77 (skipped) where the camera's port is taken.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

SKIPPED = 77


def check(sensor, place, head):
    done = subprocess.run([sensor, "--check-rate", "--source", "board:" + place["board"], "--sensor", head, "--rt", "ignore"],
                          capture_output=True, text=True, timeout=120)
    print(done.stdout.strip(), done.stderr.strip(), flush=True)
    return done


def main():
    sensor, cell = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        serving = subprocess.Popen([cell, "serve", "--rate-hz", "10", "--speed-mm-s", "100", "--out", folder / "cell",
                                    "--exit-with-parent"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = serving.stdout.readline()
        if not line:
            told = serving.communicate()[1]
            assert "3956" in told, told
            sys.exit(SKIPPED)
        place = json.loads(line)
        reached = check(sensor, place, place["sensor"])
        assert reached.stdout.startswith("ready\trate\t"), reached
        assert reached.returncode == 0, reached
        # A head that says it takes so many cannot be served by a camera that takes ten.
        text = pathlib.Path(place["sensor"]).read_text()
        rate = re.search(r"^rate_hz: *([0-9.]+)", text, re.M)
        assert rate and float(rate.group(1)) == 10, text
        other = folder / "sensor.yaml"
        other.write_text(text.replace(rate.group(0), "rate_hz: 5000"))
        missed = check(sensor, place, other)
        assert missed.returncode != 0, missed
        # Without the head there is no rate.
        bare = subprocess.run([sensor, "--check-rate", "--source", "board:" + place["board"]], capture_output=True, text=True, timeout=60)
        assert bare.returncode == 2 and "--sensor is needed" in bare.stderr, bare
        serving.terminate()
        counts = json.loads(serving.communicate(timeout=60)[0].splitlines()[-1])
        assert counts["exposures"] > 0 and counts["exposures_lit"] == 0, counts


main()
