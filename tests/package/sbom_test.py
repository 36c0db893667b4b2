#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sbom_test.py BUILD SOURCE: the bills of materials against ldd, the compiler and the page's lock file, each asked here anew."""
import copy
import importlib.util
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

build, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
maker = source / "toolchains/package/sbom.py"
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)


def say(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False)


def bill_of(folder, name, programs, pages=()):
    out = folder / f"{name}.cdx.json"
    command = [maker, "--name", f"biteline-{name}", "--version", "0.1.0", "--build", build, "--out", out]
    for program in programs:
        command += ["--program", build / "bin" / program]
    for page in pages:
        command += ["--page", build / "share/biteline/web.made" / f"{page}.json"]
    done = say(*command, "--lock", source / "host/web/package-lock.json")
    if done.returncode != 0:
        sys.exit(f"{name}: {done.stderr}")
    return json.loads(out.read_text(encoding="utf-8")), out.read_bytes()


def used(bill, use):
    return {part["name"] for part in bill["components"] if {"name": "biteline:use", "value": use} in part["properties"]}


def names_of(file):
    """With and without the merged /usr, and behind its links."""
    for name in (file, str(pathlib.Path(file).resolve())):
        yield from (name, "/usr" + name, name.removeprefix("/usr"))


owners = {}


def packages_of(files):
    """By dpkg's own word."""
    unknown = [name for file in files if file not in owners for name in names_of(file)]
    told = dict(line.split(": ", 1)[::-1] for line in say("dpkg-query", "-S", *unknown).stdout.splitlines()) if unknown else {}
    for file in files:
        owner = next((told[name] for name in names_of(file) if name in told), None)
        if file not in owners and owner is None:
            failures.append(f"{file}: of no package")
        owners.setdefault(file, (owner or "nobody").split(":")[0].split(",")[0])
    return {owners[file] for file in files}


def linked(program):
    return packages_of(set(re.findall(r"(/\S+) \(0x", say("ldd", build / "bin" / program).stdout)))


def differences(bill, programs):
    """Packages that ldd names and the bill does not, or the other way round."""
    return used(bill, "shared") ^ set().union(*(linked(program) for program in programs))


def read_by_compiler(file):
    """Packages whose headers one source reads, by the compiler itself."""
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    for entry in commands:
        unit = entry["file"]
        if unit.endswith(file) or ("/Unity/" in unit and file in pathlib.Path(unit).read_text(encoding="utf-8")):
            # Without the precompiled header, which hides what it is made of.
            command = re.sub(r" (-Winvalid-pch|-include \S*/cmake_pch\.hxx)(?= )", "", entry["command"])
            words = [word for word in shlex.split(command) if not word.endswith("ccache")]
            words[words.index("-o") + 1] = "/dev/null"
            words += ["-M", "-MF", "/dev/stdout"]
            done = subprocess.run(words, cwd=entry["directory"], capture_output=True, text=True, check=False)
            return packages_of({name for name in done.stdout.split() if name.startswith("/usr/include/")})
    return set()


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    paged = (build / "share/biteline/web.made/app.json").exists()
    parts = {
        "firmware": (["biteline-sensor"], []),
        "host": (["biteline", "biteline-host"], ["viewer"] if paged else []),
        "web": (["biteline-web"], ["app"] if paged else []),
        "gige": (["biteline-gige"], []),
        "uplink": (["biteline-uplink"], []),
        "fleet": (["biteline-fleet"], []),
    }
    bills = {}
    for part, (programs, pages) in parts.items():
        if not all((build / "bin" / program).exists() for program in programs):
            continue
        bills[part], text = bill_of(folder, part, programs, pages)
        other = differences(bills[part], programs)
        check(not other, f"{part}: ldd and the bill disagree: {', '.join(sorted(other))}")
        refs = [component["bom-ref"] for component in bills[part]["components"]]
        check(len(refs) == len(set(refs)), f"{part}: a part is there twice")
        check(bills[part]["dependencies"][0]["dependsOn"] == sorted(refs), f"{part}: what it needs is not what it names")
        check(all(re.match(r"pkg:(deb/debian|npm)/[^@]+@[^@]+$", ref) for ref in refs), f"{part}: no name or version")
        check(re.match(r"urn:uuid:[0-9a-f-]{36}$", bills[part]["serialNumber"]), f"{part}: no serial number")
    if not bills:
        print("skipped: no program is built")
        sys.exit(77)
    part = next(iter(bills))
    before = (folder / f"{part}.cdx.json").read_bytes()
    check(bill_of(folder, part, *parts[part])[1] == before, "the same build gives other bytes")

    # Each comparison can fail: a part that is missing, and one that nobody links.
    spoilt = copy.deepcopy(bills[part])
    gone = next(component for component in spoilt["components"] if component["name"] == "libstdc++6")
    spoilt["components"].remove(gone)
    check(differences(spoilt, parts[part][0]) == {"libstdc++6"}, "a library that is left out is not missed")
    spoilt["components"] += [gone, {**gone, "name": "libnobody1"}]
    check(differences(spoilt, parts[part][0]) == {"libnobody1"}, "a library that nobody links is not seen")

    if "host" in bills:
        compiled = used(bills["host"], "compiled-in")
        read = read_by_compiler("host/records/memory/history.cpp")
        check("nlohmann-json3-dev" in read, "the compiler was not asked")
        shared = used(bills["host"], "shared")
        form = "${Package} ${source:Package}\n"
        sources = dict(line.split() for line in say("dpkg-query", "-W", "-f", form, *sorted(read | shared)).stdout.splitlines())
        # The kernel's headers are numbers and structs, no code.
        known = {sources[package] for package in shared} | {"linux"}
        missed = {package for package in read - compiled if sources[package] not in known}
        check(not missed, f"host: the compiler reads what the bill does not name: {', '.join(sorted(missed))}")

    if paged and "web" in bills:
        lock = json.loads((source / "host/web/package-lock.json").read_text(encoding="utf-8"))["packages"]
        wanted = {
            (place.removeprefix("node_modules/"), fact["version"])
            for place, fact in lock.items()
            if place and not fact.get("dev") and not fact.get("optional")
        }
        parts_of_page = [item for bill in bills.values() for item in bill["components"] if item["purl"].startswith("pkg:npm/")]
        listed = {(item["name"], item["version"]) for item in parts_of_page}
        check(listed == wanted, f"the page's lock and the bills disagree: {listed ^ wanted}")
        check(all(len(item["hashes"][0]["content"]) == 128 for item in parts_of_page), "an npm package without its sum")

    # Fixes that are not in: of apt's words, made here.
    spec = importlib.util.spec_from_file_location("known_fixes", source / "toolchains/package/known_fixes.py")
    fixes = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(fixes)
    policy = """libone:
  Installed: 1.0-1
  Candidate: 1.0-1+deb12u2
  Version table:
     1.0-1+deb12u2 500
        500 http://deb.debian.org/debian-security bookworm-security/main amd64 Packages
 *** 1.0-1 100
        100 /var/lib/dpkg/status
libtwo:
  Installed: 2.0-1
  Candidate: 2.1-1
  Version table:
     2.1-1 500
        500 http://deb.debian.org/debian bookworm/main amd64 Packages
 *** 2.0-1 500
        500 http://deb.debian.org/debian-security bookworm-security/main amd64 Packages
"""
    one, two = {"name": "libone", "version": "1.0-1"}, {"name": "libtwo", "version": "2.0-1"}
    check(fixes.missing_fixes([one, two], policy) == [(one, "1.0-1+deb12u2")], "a fix that waits is not told, or one that is in")
    check(fixes.missing_fixes([{"name": "libone", "version": "1.0-1+deb12u2"}], policy) == [], "a fix that is in is told")

for failure in failures:
    print(failure)
print(f"{len(bills)} bills, {sum(len(bill['components']) for bill in bills.values())} parts")
sys.exit(1 if failures else 0)
