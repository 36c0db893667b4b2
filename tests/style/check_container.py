#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_container.py ROOT: the container file has known instructions, JSON where JSON stands, our packages and programs, no root.

No image is built: that needs a container program and a registry.
"""
import json
import pathlib
import re
import sys

KNOWN = {"FROM", "COPY", "RUN", "USER", "WORKDIR", "VOLUME", "STOPSIGNAL", "ENTRYPOINT", "CMD", "ENV", "EXPOSE", "LABEL"}


def instructions(text):
    joined = re.sub(r"\\\n", " ", "\n".join(line for line in text.splitlines() if not line.startswith("#")))
    for line in filter(str.strip, joined.splitlines()):
        name, _, rest = line.partition(" ")
        yield name, rest.strip()


def faults(root, text):
    packaging = (root / "toolchains/cmake/BitelineHostPackages.cmake").read_text(encoding="utf-8")
    components = re.findall(r"^biteline_daemon_package\((\w+) ", packaging, re.MULTILINE)
    found = list(instructions(text))
    if not found or found[0] != ("FROM", "debian:12-slim"):
        yield "its first line is not FROM debian:12-slim, for which the packages are built"
    user = "root"
    for name, rest in found:
        if name not in KNOWN:
            yield f"{name} is no instruction that is used here"
        if name == "COPY":
            for component in re.findall(r"biteline-(\w+)_", rest):
                if component not in components:
                    yield f"there is no package biteline-{component}"
        if name == "USER":
            user = rest
        if name in ("ENTRYPOINT", "CMD"):
            try:
                words = json.loads(rest)
            except ValueError:
                yield f"{name} is no JSON: {rest}"
                continue
            if name == "ENTRYPOINT" and words[0] not in {f"/usr/bin/biteline-{c}" for c in components}:
                yield f"no package brings {words[0]}"
    if user == "root":
        yield "it runs as root"


def main():
    root = pathlib.Path(sys.argv[1])
    text = (root / "toolchains/package/Containerfile").read_text(encoding="utf-8")
    found = list(faults(root, text))
    for seeded in (text.replace("FROM debian:12-slim", "FROM debian:11"), text.replace("biteline-web_", "biteline-none_"),
                   text.replace('"/usr/bin/biteline-host"]', '"/usr/bin/biteline-host"'), text.replace("USER biteline-container\n", ""),
                   text.replace("RUN useradd", "RNU useradd")):
        if seeded == text or not list(faults(root, seeded)):
            found.append("this check is green on a seeded fault: mend the check")
    for fault in found:
        print(f"toolchains/package/Containerfile: {fault}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
