#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""recording_test.py BITELINE CELL GOLDEN: a session as an MCAP file gives the same line, and no damage stays unseen."""
import json
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import encoder_counts  # noqa: E402

PICTURES = "cam0/data"


def run(*command, status=0):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=600)
    assert done.returncode == status, (command, done.returncode, done.stdout, done.stderr)
    return done


def verdict(tool, file, status=0, *more):
    return json.loads(run(tool, "record", "verify", file, "--json", *more, status=status).stdout)


def rows(file):
    return [[float(field) for field in line.split(",")] for line in file.read_text().splitlines() if not line.startswith("#")]


def check_same_session(once, again):
    names = lambda session: sorted(p.name for p in (session / PICTURES).iterdir())
    assert names(once) == names(again) and names(once)
    for name in names(once):
        assert (once / PICTURES / name).read_bytes() == (again / PICTURES / name).read_bytes()
    for name in ("cam0/sensor.yaml", "cam0/data.csv"):
        assert (once / name).read_bytes() == (again / name).read_bytes(), name
    # Poses have other digits and the same numbers.
    assert rows(once / "pose0/data.csv") == rows(again / "pose0/data.csv")


def check_same_line(tool, session, file, folder):
    run(tool, "replay", session, "--out", folder / "from-session")
    run(tool, "replay", file, "--out", folder / "from-file")
    for name in ("cloud.ply", "line.csv"):
        assert (folder / "from-session" / name).read_bytes() == (folder / "from-file" / name).read_bytes(), name
    assert not (folder / "from-file" / "unpacked").exists()
    points = len((folder / "from-file" / "line.csv").read_text().splitlines()) - 1
    print(f"replayed from the file: the same cloud and the same line of {points} points", flush=True)


def check_counts(tool, session, folder):
    """An encoder's counts go into the file and come out again, row by row; nothing else is another."""
    copy, _ = encoder_counts.counted(session, folder)
    file, back = folder / "counted.mcap", folder / "counted-back"
    run(tool, "record", "export", copy, "--out", file)
    run(tool, "record", "import", file, "--out", back)
    assert (back / "pose0/encoder.csv").read_bytes() == (copy / "pose0/encoder.csv").read_bytes()
    check_same_session(copy, back)
    assert not (folder / "back" / "pose0/encoder.csv").exists()
    (copy / "pose0/encoder.csv").write_text("5,5\n")
    said = run(tool, "record", "export", copy, "--out", folder / "none.mcap", status=2).stderr
    assert "pose0/encoder.csv row 1, field 1" in said and said.count("\n") == 1, said


def check_damage(tool, file, folder):
    whole = file.read_bytes()
    spoiled = folder / "spoiled.mcap"
    at = whole.index(b"\x89PNG", len(whole) // 2) + 500
    spoiled.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
    told = verdict(tool, spoiled, 3)
    first = told["faults"][0]
    assert told["reason_code"] == "recording_damaged" and first["what"].startswith("chunk "), told
    assert first["at_byte"] <= at < first["at_byte"] + (64 << 20), told
    said = run(tool, "record", "verify", spoiled, status=3).stderr
    assert said.count("\n") == 1 and first["what"] in said, said
    print("a flipped byte:", said.strip().split(": ", 1)[1])

    pictures = whole.count(b"\x89PNG")
    seen = []
    for share in (0.3, 0.6, 0.95):
        cut = folder / f"cut-{share}.mcap"
        cut.write_bytes(whole[: int(len(whole) * share)])
        assert verdict(tool, cut, 3)["faults"]
        done = run(tool, "record", "import", cut, "--out", folder / f"cut-{share}", "--json")
        told = json.loads(done.stdout)
        assert "cut or damaged" in done.stderr and 0 < told["pictures"] < pictures, told
        # What came out is a session again: all its pictures have poses.
        run(tool, "record", "export", folder / f"cut-{share}", "--out", folder / f"again-{share}.mcap")
        assert told["pictures"] > share * pictures - pictures / 5 - 2, (told, pictures)
        seen.append(told["pictures"])
    assert seen == sorted(set(seen)), seen
    print(f"cut at 30, 60 and 95 %: {seen} of {pictures} pictures")


def check_refusals(tool, file, session, folder):
    def refused(what, *command, status=2):
        said = run(tool, *command, status=status).stderr
        assert what in said and said.count("\n") == 1, said

    refused("nothing is overwritten", "record", "export", session, "--out", file)
    refused("nothing is overwritten", "record", "import", file, "--out", session)
    refused("not an MCAP file", "record", "verify", session / "cam0/sensor.yaml")
    refused("not an MCAP file", "record", "import", session / "cam0/sensor.yaml", "--out", folder / "none")
    refused("not found", "record", "export", folder / "nowhere", "--out", folder / "none.mcap")
    assert not (folder / "none").exists() and not (folder / "none.mcap").exists()
    assert not list(folder.glob("*.new"))
    refused("its last link is", "record", "verify", file, "--last-link", "0" * 64, status=3)


def check_golden(tool, golden, folder):
    """The kept file still reads, and holds what the session holds.  `biteline record export tests/golden/part --out` made it."""
    kept = verdict(tool, pathlib.Path(__file__).with_name("part.mcap"))
    run(tool, "record", "export", golden / "part", "--out", folder / "part.mcap")
    assert kept["topics"] == verdict(tool, folder / "part.mcap")["topics"]


def main():
    tool, cell, golden = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_golden(tool, golden, folder)
        session, file = folder / "session", folder / "session.mcap"
        run(cell, "record", "--seed", 5, "--rate-hz", 40, "--speed-mm-s", 200, "--out", session)
        told = json.loads(run(tool, "record", "export", session, "--out", file, "--stored", "--json").stdout)
        checked = verdict(tool, file, 0, "--last-link", told["last_link"])
        assert checked["last_link"] == told["last_link"] and checked["all_check_sums"] and not checked["faults"]
        run(tool, "record", "import", file, "--out", folder / "back")
        check_same_session(session, folder / "back")
        check_counts(tool, golden / "part", folder)
        check_same_line(tool, session, file, folder)
        run(tool, "record", "export", session, "--out", folder / "packed.mcap", "--results", folder / "from-file")
        packed = verdict(tool, folder / "packed.mcap")
        assert packed["topics"] == checked["topics"] and packed["attachments"] == checked["attachments"] + 2
        check_damage(tool, file, folder)
        check_refusals(tool, file, session, folder)


main()
