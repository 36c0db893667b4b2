#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""known_fixes.py SBOM...: for which parts of a package Debian has a security fix that is not in.

Asks the package lists that apt has fetched, and no network.  A shared library: the fix comes by apt on the machine that runs
it.  A compiled-in one: only a new build brings it.  The page's npm packages are named and not judged: their advisories are in
no package list.  Exit status: 0 no fix is missing, 1 one is, 2 it could not be asked.
"""
import json
import pathlib
import re
import subprocess
import sys


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False)


def newer(version, than):
    return run("dpkg", "--compare-versions", version, "gt", than).returncode == 0


def security_versions(policy):
    """Package -> versions of a suite for security, of `apt-cache policy`'s words."""
    versions, package, version = {}, None, None
    for line in policy.splitlines():
        if match := re.match(r"(\S+):$", line):
            package = match[1]
        elif match := re.match(r" (?:\*\*\*|   ) (\S+) ", line):
            version = match[1]
        elif package and version and re.search(r"^\s+\d+ \S+ \S*-security[/ ]", line):
            versions.setdefault(package, []).append(version)
    return versions


def missing_fixes(components, policy):
    """Components that have an older version than a suite for security."""
    security = security_versions(policy)
    missing = []
    for component in components:
        fixed = [version for version in security.get(component["name"], []) if newer(version, component["version"])]
        if fixed:
            missing.append((component, fixed[0]))
    return missing


def main():
    files = [pathlib.Path(name) for name in sys.argv[1:]]
    if not files or sys.argv[1].startswith("-"):
        print(__doc__.strip())
        return 2
    try:
        components = {part["purl"]: part for file in files for part in json.loads(file.read_text(encoding="utf-8"))["components"]}
    except (OSError, ValueError, KeyError) as error:
        print(f"known_fixes.py: {error}: a CycloneDX file of a package expected", file=sys.stderr)
        return 2
    debian = [part for purl, part in sorted(components.items()) if purl.startswith("pkg:deb/debian/")]
    policy = run("apt-cache", "policy", *sorted(part["name"] for part in debian)).stdout
    if "-security" not in policy:
        print("known_fixes.py: apt knows no suite for security; add it to its sources, then apt-get update", file=sys.stderr)
        return 2
    missing = missing_fixes(debian, policy)
    for part, fixed in missing:
        use = next(item["value"] for item in part["properties"] if item["name"] == "biteline:use")
        step = "apt-get upgrade" if use == "shared" else "build the package anew"
        print(f"{part['name']} {part['version']}: fixed in {fixed}; {step}")
    others = [purl for purl in components if not purl.startswith("pkg:deb/")]
    print(f"{len(debian)} Debian packages asked, {len(missing)} have a fix that is not in", end="")
    print(f"; not judged: {', '.join(sorted(others))}" if others else "")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
