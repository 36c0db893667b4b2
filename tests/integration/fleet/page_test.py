#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""page_test.py UPLINK FLEET MADE_CELL BROKER_FILES WEB BITELINE ROOT PAGE NODE PICTURES: the page of all cells.

Real broker, database, centre, uplinks and web program; three cells with shoes, one of them away, eight made ones of which one
is odd, a release that nobody has.  The API is asked by hand here, the page is looked at in a browser (centre_test.mjs).
"""
import json
import os
import pathlib
import subprocess
import sys
import urllib.error
import urllib.request

from factory import CELLS, factory_of, put_odd_cells, skip
from programs import PATIENCE_S, Program, comes_true
from recordings import make_recording

WEB, BITELINE, ROOT, PAGE, NODE, PICTURES = sys.argv[5:11]
ADDRESS = "http://127.0.0.1:8090/"


def ask(method, path, token="", body=None):
    """Status and JSON."""
    request = urllib.request.Request(f"{ADDRESS}api/v1{path}", method=method, data=None if body is None else json.dumps(body).encode(),
                                     headers={"Content-Type": "application/json", **({"Authorization": f"Bearer {token}"} if token else {})})
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            return answer.status, json.loads(answer.read() or b"null")
    except urllib.error.HTTPError as error:
        return error.code, json.loads(error.read() or b"null")


def nobody_gets_in(paths):
    for path in paths:
        status, answer = ask("GET", path)
        assert status == 401, (path, status, answer)
    assert ask("POST", "/fleet/fetches", body={"cell": "cell-1", "scan": "scan-0001"})[0] == 401
    assert ask("POST", "/fleet/marks", body={"cell": "cell-1", "scan": "scan-0001", "marked": True})[0] == 401


def api_as_viewer(factory):
    """Who may what; what is counted; and no way to an arm."""
    token = ask("POST", "/sessions", body={"name": "vera", "password": "only looking"})[1]["token"]
    assert ask("POST", "/fleet/fetches", token, {"cell": "cell-2", "scan": "scan-0005"})[0] == 403
    assert ask("POST", "/fleet/marks", token, {"cell": "cell-2", "scan": "scan-0005", "marked": False})[0] == 403
    assert factory.sql("SELECT marked FROM fetches WHERE state = 'whole'") == [["t"]], "as the page left it"
    for path in ("/commands/stop", "/commands/laser-off", "/commands/start", "/scans/scan-0001/send", "/control"):
        status, answer = ask("POST", path, token, {})
        assert status == 404 and "commands no cell" in answer["error"]["message"], (path, status, answer)
    cells = {row["cell"]: row for row in ask("GET", "/fleet/cells", token)[1]["cells"]}
    assert (cells["cell-2"]["scans"], cells["cell-2"]["refused"], cells["cell-2"]["online"]) == (30, 6, True), cells
    # Page by page, each shoe once, newest first.
    seen, cursor = [], ""
    while cursor is not None:
        page = ask("GET", f"/fleet/scans?cell=cell-2&limit=7{cursor and '&cursor=' + cursor}", token)[1]
        seen += [row["id"] for row in page["scans"]]
        cursor = page["next"]
    assert seen == [f"scan-{number:04d}" for number in range(30, 0, -1)], seen
    refused = ask("GET", "/fleet/scans?cell=cell-2&verdict=refused", token)[1]["scans"]
    assert len(refused) == 6 and all(row["verdict"] == "refused" for row in refused), refused
    one = ask("GET", "/fleet/scans?cell=cell-2&part=A-2", token)[1]["scans"]
    assert [(row["id"], row["part"], row["foot"], row["size"]) for row in one] == [("scan-0002", "A-2", "left", "EU 42")], one
    assert one[0]["work"] is None and one[0]["follows"] is None, one
    worked = ask("GET", "/fleet/scans?cell=cell-2&part=A-6", token)[1]["scans"][0]["work"]
    assert worked == {"verdict": "faulty", "reworked": True, "missing_mm": 6.5, "narrow": 2, "wide": 0, "beside": 0, "doubled": 0}, worked
    begin = ask("GET", "/fleet/scans?cell=cell-2&part=A-2*", token)[1]["scans"]
    assert sorted(row["part"] for row in begin) == sorted(["A-2", *(f"A-{number}" for number in range(20, 30))]), begin
    trends = ask("GET", "/fleet/trends?cell=cell-2&bucket=week", token)[1]["buckets"]
    assert sum(one["scans"] for one in trends) == 30 and trends[0]["cycle_s"] == 12.5, trends
    groups = {(row["model"], row["cell"]): row for row in ask("GET", "/fleet/groups", token)[1]["groups"]}
    assert groups["boot", "cell-2"]["scans"] == groups["runner", "cell-2"]["scans"] == 15, groups
    # What works on with a shoe is no other one.  Answers are kept for some seconds.
    def shoes():
        trends = ask("GET", "/fleet/trends?cell=cell-2&bucket=week", token)[1]["buckets"]
        groups = {(row["model"], row["cell"]): row for row in ask("GET", "/fleet/groups", token)[1]["groups"]}
        cells = {row["cell"]: row for row in ask("GET", "/fleet/cells", token)[1]["cells"]}
        return sum(one["scans"] for one in trends), groups["boot", "cell-2"]["scans"], cells["cell-2"]["scans"]

    assert factory.sql("UPDATE shoes SET follows = 'scan-0027' WHERE cell = 'cell-2' AND scan = 'scan-0028'") is not None
    comes_true(lambda: shoes() == (29, 14, 29), "a scan that follows another one counts as no shoe")
    assert factory.sql("UPDATE shoes SET follows = '' WHERE cell = 'cell-2'") is not None
    comes_true(lambda: shoes() == (30, 15, 30), "each scan is a shoe again")
    for path in ("/fleet/trends?bucket=year", "/fleet/scans?limit=x"):
        assert ask("GET", path, token)[0] == 400, path
    factory.kill("database")
    assert comes_true(lambda: ask("GET", "/fleet/cells", token)[0] == 503, "a database that is away is told")
    assert ask("GET", "/state", token)[1]["database"] is False
    factory.start("database")
    comes_true(lambda: ask("GET", "/state", token)[1]["database"], "it is back without anybody's help")


def offer_a_release(factory):
    folder = factory.folder
    process = pathlib.Path(ROOT, "host/robot/path/processes/grind.yaml")
    sample = folder / "sample"
    subprocess.run([BITELINE, "extract", pathlib.Path(ROOT, "tests/golden/sample/cloud.ply"), "--out", sample], check=True, capture_output=True)
    subprocess.run([BITELINE, "model", "--library", folder / "library", "save", "boot", sample], check=True, capture_output=True)
    file = folder / "autumn.tar"
    subprocess.run([BITELINE, "model", "--library", folder / "library", "release", "autumn", "--out", file, "--process", process], check=True,
                   capture_output=True)
    subprocess.run(["openssl", "genpkey", "-algorithm", "ed25519", "-out", folder / "release.key"], check=True)
    subprocess.run(["openssl", "pkeyutl", "-sign", "-rawin", "-inkey", folder / "release.key", "-in", f"{file}.manifest", "-out",
                    f"{file}.manifest.sig"], check=True, capture_output=True)
    done = subprocess.run([factory.fleet, "--database", factory.database(), "--offer", file, "--cells", ",".join(CELLS)], capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr


def main():
    if not pathlib.Path(PAGE, "centre/app.js").exists():
        skip("the page was not built")
    with factory_of(sys.argv[1:5]) as factory:
        factory.fleet_options = ["--recordings", factory.folder / "recordings", "--control", "tcp://127.0.0.1:9119"]
        for cell in CELLS:
            assert factory.make_shoes(cell, 1, 30).wait(PATIENCE_S) == 0
        for name in ("broker", "database", "fleet", *CELLS):
            factory.start(name)
        for cell in CELLS:
            comes_true(lambda: factory.shoes_of(cell) == 30, f"the shoes of {cell}")
        make_recording(factory.folder / "cell-2", "scan-0005", 60_000, 5)
        put_odd_cells(factory, 1, 40, 0)
        put_odd_cells(factory, 41, 20, 0.3)
        offer_a_release(factory)
        factory.kill("cell-3")
        web = Program(WEB, "--listen", "127.0.0.1:8090", "--control", "tcp://127.0.0.1:9119", "--page", pathlib.Path(PAGE, "centre"),
                      "--exit-with-parent")
        factory.others.append(web)
        web.line_with("http://")
        comes_true(lambda: ask("GET", "/me")[0] == 401, "the centre behind the web program")
        nobody_gets_in(["/state", "/fleet/cells", "/fleet/scans", "/fleet/trends", "/fleet/groups", "/fleet/alarms", "/fleet/odd",
                        "/fleet/releases", "/fleet/fetches", "/users", "/log"])
        looked = subprocess.run([NODE, f"{ROOT}/tests/web/centre_test.mjs", ADDRESS, PICTURES], text=True, capture_output=True,
                                env={**os.environ, "BITELINE_WEB_SOURCE": f"{ROOT}/host/web"})
        print(looked.stdout, looked.stderr)
        if looked.returncode == 77:
            sys.exit(77)
        assert looked.returncode == 0
        api_as_viewer(factory)


main()
