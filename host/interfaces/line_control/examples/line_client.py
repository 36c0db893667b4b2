#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""line_client.py ADDRESS PORT JOB [PART]: one scan through biteline-web --text, with Python's own library.

PART is the part number of the shoe that stands there.
Prints the cell's state as JSON.  Exit status: 0 ok, 3 refused, 4 failed or not taken, 5 a person
must settle the line.
"""
import json
import socket
import sys
import time

NAMES = (
    "map heartbeat step ready busy done taken finished verdict job model sent followed refusal scan starts ok amber refused "
    "failed length_mm u95_um confidence review"
).split()
VERDICTS = ("none", "ok", "amber", "refused", "failed", "review")


def main():
    address, port, job = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    part = sys.argv[4] if len(sys.argv) > 4 else ""
    with socket.create_connection((address, port), timeout=10) as link:
        answers = link.makefile("r")

        def ask(line):
            link.sendall(line.encode() + b"\n")
            return [int(number) for number in answers.readline().strip("()\n").split(",")]

        def state():
            return dict(zip(NAMES, ask("STATE")))

        # Another number than the last one: the same number would not start a second scan.
        request = state()["taken"] % 65535 + 1
        for line in (f"JOB {job}", f"PART {part}", f"START {request}"):
            refusal = ask(line)[0]
            if refusal:
                print(f"{line}: refused with {refusal}", file=sys.stderr)
                return 4
        while True:
            now = state()
            if now["done"] and now["finished"] == request:
                break
            if now["step"] == 0:
                print("the service does not answer", file=sys.stderr)
                return 4
            time.sleep(0.1)
        now["verdict"] = VERDICTS[now["verdict"]]
        print(json.dumps(now))
        return {"ok": 0, "amber": 0, "refused": 3, "review": 5}.get(now["verdict"], 4)


sys.exit(main())
