#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""live_record_test.py SENSOR CELL SERVICE TOOL daily|long [NODE WEB]: a live scan that is recorded gives the same bits when it is replayed.

Each trial runs the simulated cell and the sensor program with --record: profiles of the pictures' replay against the live
ones, from a folder and from an MCAP file that the sensor wrote by itself; the service's line against that of the pictures, and with thinned pictures against those of session, profiles and
MCAP file.  A scan that a busy machine ended, or whose poses came late, is tried again.  daily: the plain scan, what ends a recording, and thinned
pictures; long: the other ways to take a scan, the MCAP file that is written live, and all pictures.  Leaves with 77 (skipped) where the
camera's port is taken.
"""
import itertools
import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time

JUDGE = pathlib.Path(__file__).parents[1] / "integration" / "recording" / "judge_live.mjs"
CLIENT = pathlib.Path(__file__).with_name("stranger.py")
TRIALS = (["--laser-off-frames"], ["--second-exposure-us", "1200"], ["--follow-stripe"])
ATTEMPTS = 8
OVERRUN = 0x10  # late on that machine; says nothing of the points
SKIPPED = 77


def start(*command):
    """The program and what it says first; nothing when it ends instead."""
    program = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    line = program.stdout.readline()
    return program, json.loads(line) if line else None


def stop(program):
    program.terminate()
    return program.communicate(timeout=60)[1]


def scan_of(hello, *more):
    """Hello, profiles and end as the stranger's client reads them."""
    address = hello["endpoint"].removeprefix("tcp://").rsplit(":", 1)
    told = subprocess.run([sys.executable, CLIENT, *address, *more], stdout=subprocess.PIPE, text=True, timeout=120)
    rows = [json.loads(line) for line in told.stdout.splitlines()]
    for row in rows:
        row["flags"] = row.get("flags", 0) & ~OVERRUN
    return [row for row in rows if "sequence" in row], rows[-1].get("end") if rows else None


def facts_of(session):
    if session.suffix == ".mcap":
        # As it stands in the file; the last of two holds.
        text = session.read_bytes().rpartition(b"# A live scan as biteline-sensor recorded it.")[2].decode("latin1")
        lines = list(itertools.takewhile(lambda line: re.match(r"[a-z_]+: ", line), text.splitlines()[1:]))
    else:
        lines = (session / "recording.yaml").read_text().splitlines()
    return dict(line.split(": ", 1) for line in lines if ": " in line and not line.startswith("#"))


def scan_live(sensor, cell, folder, options, good, limit=(), ending=""):
    """A recording that is good() as its facts say, and the profiles that the host got."""
    told = ""
    for attempt in range(ATTEMPTS):
        session, out = folder / f"live-{attempt}{ending}", folder / f"cell-{attempt}"
        # Of an earlier trial that was tried again: the sensor would take another name beside it.
        shutil.rmtree(session, ignore_errors=True)
        session.unlink(missing_ok=True)
        serving, place = start(cell, "serve", "--speed-mm-s", 150, "--rate-hz", 25, "--out", out, "--exit-with-parent")
        if place is None:
            told = stop(serving)
            time.sleep(2)  # until another test gives the port back
            continue
        for rights in ("required", "ignore"):
            running, hello = start(*limit, sensor, "--source", "board:" + place["board"], "--sensor", place["sensor"], "--rt", rights,
                                   "--record", session, "--exit-with-parent", *options)
            if hello:
                break
        assert hello, stop(running)
        profiles, end = scan_of(hello, "--start")
        told = stop(running)
        stop(serving)
        facts = facts_of(session)
        if end == 0 and len(profiles) > 30 and facts["unrepeatable"] == "0":
            assert good(facts), facts
            return session, profiles
        told += f" end {end}, {len(profiles)} profiles, {facts}"
    if "3956" in told:
        sys.exit(SKIPPED)
    raise AssertionError(told)


def records_in(file):
    """Of the file's records, which are a length and a message each."""
    data, at, count = file.read_bytes(), 8, 0
    assert data[:8] == b"BTLNSCAN"
    while at < len(data):
        at += 4 + struct.unpack_from("<I", data, at)[0]
        count += 1
    assert at == len(data)
    return count


def check_full_disk(sensor, cell, folder):
    """A limit on files in place of a full disk: some twenty profiles fit, or a picture that is stored unpacked does not.
    The recording ends, the scan goes on."""
    limit = ("sh", "-c", "trap '' XFSZ; ulimit -f 600; exec \"$@\"", "sh")
    ended = lambda facts: facts["complete"] == "false" and "disk full" in facts.get("fault", "")
    session, live = scan_live(sensor, cell, folder, [], ended, limit)
    facts = facts_of(session)
    assert int(facts["pictures"]) > 0 and int(facts["pictures_left_out"]) > 0, facts
    assert len(list((session / "cam0" / "data").iterdir())) == int(facts["pictures"])
    kept = records_in(session / "scan.btln")
    assert 1 < kept < len(live) + 2
    print(f"full disk: {kept} of {len(live) + 2} messages and {facts['pictures']} pictures kept, the scan whole")


def check_live_file(sensor, cell, tool, folder, judge):
    """The same scan as one MCAP file, written live: whole, read by another's reader, and replayed to the same bits."""
    file, live = scan_live(sensor, cell, folder, [], lambda facts: facts["complete"] == "true", ending=".mcap")
    verdict = json.loads(run(tool, "record", "verify", file, "--json"))
    assert verdict["all_check_sums"] and not verdict["faults"], verdict
    back = folder / "back"
    run(tool, "record", "import", file, "--out", back)
    assert records_in(back / "scan.btln") == len(live) + 2
    assert facts_of(back) == facts_of(file)
    pictures = len(list((back / "cam0" / "data").iterdir()))
    assert pictures == int(facts_of(back)["pictures"]) >= len(live)
    running, hello = start(sensor, "--source", f"replay:{back}", "--exit-with-parent")
    assert hello, stop(running)
    replayed, end = scan_of(hello)
    running.wait(timeout=60)
    assert end == 0 and len(live) == len(replayed), (end, len(live), len(replayed))
    for once, again in zip(live, replayed):
        assert once == again, [key for key in once if once[key] != again[key]]
    judged = "nobody (no packages)"
    if judge:
        done = subprocess.run([judge[0], JUDGE, judge[1], file], capture_output=True, text=True, timeout=120)
        assert done.returncode in (0, SKIPPED), done.stderr
        if done.returncode == 0:
            found = json.loads(done.stdout)
            assert found["/cam0/image"] == pictures and found["/scan/message"] == len(live) + 2, found
            judged = "@mcap/core"
    print(f"one MCAP file: {pictures} pictures, {len(live)} profiles, the same bits; read by {judged}", flush=True)


def check_test_pattern(sensor, cell, service, folder):
    """A scan of made pictures is refused by name, and not recorded."""
    settings, session, out = folder / "pattern.yaml", folder / "pattern", folder / "pattern-service"
    settings.write_text("camera: {test_pattern: true}\n...\n")
    for _ in range(ATTEMPTS):
        serving, place = start(cell, "serve", "--speed-mm-s", 150, "--rate-hz", 25, "--out", folder / "pattern-cell", "--exit-with-parent")
        if place:
            break
        told = stop(serving)
        if "3956" in told:
            sys.exit(SKIPPED)
        time.sleep(2)
    for rights in ("required", "ignore"):
        running, hello = start(sensor, "--source", "board:" + place["board"], "--sensor", place["sensor"], "--rt", rights,
                               "--record", session, "--settings", settings, "--exit-with-parent")
        if hello:
            break
    assert hello, stop(running)
    working = subprocess.Popen([str(c) for c in (service, "--sensor", hello["endpoint"], "--out", out, "--once")],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    # The simulated arm waits for light, which never comes: the scan ends with the cell, longer than light may take.
    time.sleep(7)
    serving.terminate()
    lit = json.loads(serving.communicate(timeout=60)[0].splitlines()[-1])
    said = "".join(working.communicate(timeout=60))
    stop(running)
    report = json.loads((out / "scan-0001" / "report.json").read_text())
    assert working.returncode == 3 and report["reason_code"] == "test_pattern", (working.returncode, report, said)
    assert report["scan"]["profiles"] > 30 and lit["exposures_lit"] == 0, (report["scan"], lit)
    assert not session.exists()
    print(f"test pattern: {report['scan']['profiles']} profiles in the dark, refused: {report['reason']}", flush=True)


def check_kept(sensor, folder):
    """What waits gets its name when somebody asks, and nobody gets what does not wait."""
    series = folder / "kept"
    (folder / "kept-last").mkdir()
    (folder / "kept-last" / "recording.yaml").write_text("")
    told = run(sensor, "--record", series, "--keep", "last").strip()
    assert told == str(series) and (series / "recording.yaml").exists(), told
    none = subprocess.run([sensor, "--record", series, "--keep", "last"], capture_output=True, text=True, timeout=60)
    assert none.returncode == 2 and "no scan waits there" in none.stderr, none
    run(sensor, "--record", series, "--keep", "next")
    assert (folder / "kept.wanted").exists()
    shutil.rmtree(series)


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, (command, done.stderr)
    return done.stdout


def replay(tool, recording, out):
    run(tool, "replay", recording, "--out", out)


def line_of(folder):
    """Line and cloud as they were written."""
    return (folder / "line.csv").read_bytes(), (folder / "cloud.ply").read_bytes()


def scan_with_service(sensor, cell, service, folder, options, good):
    """The recording, with facts that are good, of a scan whose line the service found, and the service's result."""
    told = ""
    for attempt in range(ATTEMPTS):
        session, out = folder / f"line-{attempt}", folder / f"service-{attempt}"
        serving, place = start(cell, "serve", "--speed-mm-s", 100, "--rate-hz", 25, "--out", folder / f"place-{attempt}",
                               "--exit-with-parent")
        if place is None:
            told = stop(serving)
            time.sleep(2)
            continue
        for rights in ("required", "ignore"):
            running, hello = start(sensor, "--source", "board:" + place["board"], "--sensor", place["sensor"], "--rt", rights,
                                   "--record", session, "--exit-with-parent", *options)
            if hello:
                break
        assert hello, stop(running)
        done = subprocess.run([str(c) for c in (service, "--sensor", hello["endpoint"], "--out", out, "--once", "--keep-recording")],
                              capture_output=True, text=True, timeout=300)
        told = f"exit {done.returncode}: {done.stdout[-300:]} {done.stderr[-300:]} {stop(running)}"
        stop(serving)
        if done.returncode == 0 and good(facts_of(session)):
            return session, out / "scan-0001"
    if "3956" in told:
        sys.exit(SKIPPED)
    raise AssertionError(told)


def check_whole_line(sensor, cell, service, tool, folder):
    """Worked out again from the pictures, the line is that of the live scan."""
    session, live = scan_with_service(sensor, cell, service, folder, [], lambda facts: facts["complete"] == "true")
    replay(tool, session, folder / "again")
    assert "from_profiles" not in json.loads((folder / "again" / "report.json").read_text())
    # Not the cloud: a flag in it tells which profiles were late on the live machine.
    assert line_of(folder / "again")[0] == line_of(live)[0]
    print(f"all {facts_of(session)['pictures']} pictures: the live line, bit for bit, from the pictures", flush=True)


def check_thinned_line(sensor, cell, service, tool, folder):
    session, live = scan_with_service(sensor, cell, service, folder, ["--record-pictures", "3"],
                                      lambda facts: facts["unrepeatable"] == "0")
    facts = facts_of(session)
    pictures, left_out = int(facts["pictures"]), int(facts["pictures_left_out"])
    assert facts["complete"] == "false" and pictures == (pictures + left_out + 2) // 3, facts
    # Host and sensor kept the same messages.
    assert (session / "scan.btln").read_bytes() == (live / "scan.btln").read_bytes()

    file, back = folder / "live.mcap", folder / "back"
    run(tool, "record", "export", session, "--out", file)
    run(tool, "record", "verify", file)
    run(tool, "record", "import", file, "--out", back)
    assert (back / "scan.btln").read_bytes() == (session / "scan.btln").read_bytes()
    assert facts_of(back) == facts
    for name, recording in (("session", session), ("profiles", session / "scan.btln"), ("file", file)):
        replay(tool, recording, folder / name)
        report = json.loads((folder / name / "report.json").read_text())
        assert "from_profiles" in report, report
        assert line_of(folder / name) == line_of(live), name
        shutil.rmtree(folder / name)
    points = len((live / "line.csv").read_text().splitlines()) - 1
    print(f"thinned to {facts['pictures']} pictures: the live line of {points} points, bit for bit, from session, profiles and "
          "MCAP file", flush=True)


def check_same_bits(sensor, cell, folder, options):
    session, live = scan_live(sensor, cell, folder, options, lambda facts: facts["complete"] == "true")
    running, hello = start(sensor, "--source", f"replay:{session}", "--exit-with-parent")
    assert hello, stop(running)
    replayed, end = scan_of(hello)
    running.wait(timeout=60)
    assert end == 0
    counts = len(live), len(replayed), records_in(session / "scan.btln")
    assert counts == (len(live), len(live), len(live) + 2), (counts, facts_of(session))
    # Numbers in the client's lines are told with every digit.
    for once, again in zip(live, replayed):
        assert once == again, [key for key in once if once[key] != again[key]]
    points = sum(len(p["x"]) for p in live)
    print(f"{' '.join(options) or 'plain'}: {len(live)} profiles, {points} points, the same bits", flush=True)
    assert points > 1000
    shutil.rmtree(session)


def daily(sensor, cell, service, tool, folder):
    check_same_bits(sensor, cell, folder, [])
    check_full_disk(sensor, cell, folder)
    check_test_pattern(sensor, cell, service, folder)
    check_kept(sensor, folder)
    check_thinned_line(sensor, cell, service, tool, folder)


def long(sensor, cell, service, tool, folder, judge):
    for options in TRIALS:
        check_same_bits(sensor, cell, folder, options)
    check_live_file(sensor, cell, tool, folder, judge)
    check_whole_line(sensor, cell, service, tool, folder)


def main():
    programs, part, judge = sys.argv[1:5], sys.argv[5], sys.argv[6:8]
    with tempfile.TemporaryDirectory() as folder:
        if part == "daily":
            daily(*programs, pathlib.Path(folder))
        else:
            long(*programs, pathlib.Path(folder), judge)


main()
