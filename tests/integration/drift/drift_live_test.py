#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A head slips by 0.1 mm while the cell works: the real service tells it within five shoes, and names the mounting."""
import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from programs import Program, comes_true

SOUND, BAR = 18, 5


def check_of(results, number):
    file = results / f"scan-{number:04d}" / "report.json"
    try:
        return json.loads(file.read_text()).get("calibration_check")
    except (OSError, ValueError):
        return None


def main(host_program, sensor_program):
    with tempfile.TemporaryDirectory() as folder:
        results = pathlib.Path(folder, "results")
        sensor = Program(sensor_program, str(SOUND))
        host = Program(host_program, "--sensor", sensor.line_with("tcp://"), "--out", str(results), "--on-drift", "stop",
                       "--exit-with-parent")
        try:
            told = None
            for number in range(1, SOUND + BAR + 1):
                check = comes_true(lambda at=number: check_of(results, at), f"calibration_check of scan {number}")
                print(number, check["status"], check["words"])
                assert check["table_profiles"] > 100, check
                if number <= SOUND:
                    assert check["status"] == ("learning" if number < 15 else "sound"), check
                elif check["status"] == "drifted":
                    told = check
                    break
            assert told, "nothing was told within five shoes"
            assert max(told["parts"], key=told["parts"].get) == "mounting", told
            assert "mounting drifted" in told["words"] or "mounting or" in told["words"], told
            assert told["on_drift"] == "stop" and told["reason_code"] == "calibration_drifted", told
            assert any("the calibration has drifted: mounting" in line for line in host.lines), host.lines[-10:]
        except BaseException:
            for one in (sensor, host):
                print("---", one.process.args[0], *one.lines[-20:], sep="\n")
            raise
        finally:
            for one in (host, sensor):
                if one.process.poll() is None:
                    one.end()


if __name__ == "__main__":
    main(*sys.argv[1:])
