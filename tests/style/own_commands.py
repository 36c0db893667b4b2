#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""own_commands.py [--units] compile_commands.json: the same commands as clang can read them.

One for each source, also where a build compiles several as one unit; with --units, one for each such unit.
Without the precompiled header, which is the compiler's own: clang refuses it, and reads nothing of the source then.
"""
import json
import re
import sys

units = sys.argv[1] == "--units"
own = []
with open(sys.argv[-1], encoding="utf-8") as file:
    commands = json.load(file)
for entry in commands:
    entry["command"] = re.sub(r" (-Winvalid-pch|-include \S*/cmake_pch\.hxx)(?= )", "", entry["command"])
    unit = entry["file"]
    if units or "/Unity/unity_" not in unit:
        own.append(entry)
        continue
    with open(unit, encoding="utf-8") as file:
        for source in re.findall(r'^#include "(.*)"$', file.read(), re.MULTILINE):
            own.append({**entry, "file": source, "command": entry["command"].replace(f"-c {unit}", f"-c {source}")})
json.dump(own, sys.stdout, indent=0)
