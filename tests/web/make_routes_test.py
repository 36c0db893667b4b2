#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""make_routes_test.py MAKER OPENAPI BETWEEN: the tables of routes of the documents as they are, and of spoiled ones.

Exit 1: a table is not as expected, or a fault is not told in one line that names the operation.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

# What stands in OPENAPI, what it becomes, and what the one line must hold.
SPOILED = [
    ("operationId: read_me\n", "operationId: read_state\n", "GET /me: operationId read_state is that of openapi.yaml: GET /state"),
    ("      operationId: read_me\n", "", "GET /me: no operationId"),
    ("      summary: Who I am\n      x-role: viewer\n", "      summary: Who I am\n", "GET /me: x-role: one of viewer"),
    ("      summary: Who I am\n      x-role: viewer\n", "      summary: Who I am\n      x-role: guest\n", "GET /me: x-role: one of viewer"),
    ("      summary: Who I am\n", "      summary: Who I am\n      x-control: true\n      security: []\n", "GET /me: x-control"),
    ("x-biteline: {by: [web], web: openapi}", "x-biteline: {by: [web], wob: openapi}", "GET /openapi.yaml: x-biteline.wob"),
    ("x-biteline: {by: [web], web: openapi}", "x-biteline: {by: [page], web: openapi}", "GET /openapi.yaml: x-biteline.by"),
]


def make(maker, folder, openapi, between):
    return subprocess.run([sys.executable, maker, folder, openapi, between], capture_output=True, text=True)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    maker, openapi, between = (Path(argument) for argument in sys.argv[1:])
    bad = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        done = make(maker, folder, openapi, between)
        if done.returncode != 0:
            bad.append(done.stderr)
        else:
            routes = (folder / "service_routes.inc").read_text()
            accept = ('Row{{.method = "POST", .pattern = "/api/v1/scans/{id}/accept", .operation = "accept_scan", .role = accounts::Role::Operator, '
                      ".control = true, .local = false, .is_long = false, .changes = true}, &Api::accept_scan},")
            if accept not in routes.splitlines():
                bad.append(f"service_routes.inc has no line {accept}")
            for file, absent in (("service_routes.inc", "/fleet/"), ("centre_routes.inc", "/commands/"), ("web_routes.inc", "/exchange/")):
                if absent in (folder / file).read_text():
                    bad.append(f"{file} has {absent}, which another program answers")
        text = openapi.read_text(encoding="utf-8")
        for whole, spoilt, expected in SPOILED:
            if whole not in text:
                bad.append(f"no {whole!r} in {openapi}: mend the list in make_routes_test.py")
                continue
            (folder / "openapi.yaml").write_text(text.replace(whole, spoilt, 1), encoding="utf-8")
            done = make(maker, folder / "spoiled", folder / "openapi.yaml", between)
            if done.returncode == 0 or expected not in done.stderr or len(done.stderr.splitlines()) != 1:
                bad.append(f"{spoilt!r}: '{expected}' expected, found '{done.stderr.strip()}'")
    for line in bad:
        print(line)
    print(f"{len(SPOILED)} spoiled documents, {len(bad)} complaints")
    sys.exit(1 if bad else 0)


main()
