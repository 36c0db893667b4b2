#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sbom.py: what is in a package, as CycloneDX 1.5 JSON.  Nothing is listed by hand:

  shared libraries       what ldd names for the programs, by the Debian packages that own the files
  compiled-in libraries  what the compiler read of /usr/include for the programs' objects (ninja's own records), and static
                         archives, by their packages; not where a shared library of the same source is linked
  the page               what esbuild took from node_modules (its metafile), by the page's package-lock.json

The notices are the licences' own words: of each library that is compiled in, and of each part of the page.
The same inputs give the same bytes.
"""
import argparse
import base64
import gzip
import json
import pathlib
import re
import struct
import subprocess
import sys
import urllib.parse
import uuid

# The kernel's interface: numbers and structs, no code.
NO_CODE = {"linux"}


class Unknown(Exception):
    """One line: what, where, what next."""


def ninja_records(file):
    """Output -> inputs, as the compiler told them.  Format: ninja's deps_log.h, version 4."""
    try:
        data = file.read_bytes()
    except OSError as error:
        raise Unknown(f"{file}: {error.strerror}; build with ninja first") from error
    magic = b"# ninjadeps\n"
    if not data.startswith(magic) or struct.unpack_from("<I", data, len(magic))[0] != 4:
        raise Unknown(f"{file}: a log of ninja's, version 4, expected")
    at, paths, records = len(magic) + 4, [], {}
    while at + 4 <= len(data):
        size = struct.unpack_from("<I", data, at)[0]
        at += 4
        is_deps, size = size >> 31, size & 0x7FFFFFFF
        if at + size > len(data):
            break  # cut by a kill: ninja reads it so, too
        if is_deps:
            numbers = struct.unpack_from(f"<{size // 4}I", data, at)
            records[paths[numbers[0]]] = [paths[number] for number in numbers[3:]]
        else:
            paths.append(data[at : at + size - 4].rstrip(b"\0").decode())
        at += size
    return records


def built_from(build, program):
    """Every file that ninja makes the program of, as it names them."""
    name = str(program.relative_to(build))
    done = subprocess.run(["ninja", "-C", build, "-t", "inputs", name], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Unknown(f"{program}: ninja -t inputs: {done.stderr.strip() or done.stdout.strip()}")
    return [line for line in done.stdout.splitlines() if not line.startswith("ninja: ")]


def headers_and_archives(build, programs):
    records = ninja_records(build / ".ninja_deps")
    used = set()
    for program in programs:
        for name in built_from(build, program):
            used.update(path for path in records.get(name, ()) if path.startswith("/usr/include/"))
            if name.startswith("/usr/") and name.endswith(".a"):
                used.add(name)
    return used


def shared_libraries(build, program):
    """Files that the loader takes for it, but for those of this build."""
    done = subprocess.run(["ldd", program], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Unknown(f"{program}: ldd: {done.stderr.strip() or done.stdout.strip()}")
    found = set()
    for line in done.stdout.splitlines():
        if "not found" in line:
            raise Unknown(f"{program}: {line.strip()}; install the library")
        match = re.search(r"(/\S+) \(0x", line)
        if match and not pathlib.Path(match[1]).resolve().is_relative_to(build.resolve()):
            found.add(match[1])
    return found


def names_of(path):
    """As dpkg may know the file: with and without the merged /usr, and behind its links."""
    real = str(pathlib.Path(path).resolve())
    for name in (path, real):
        yield name
        yield name.removeprefix("/usr") if name.startswith("/usr/lib") else "/usr" + name


def owners_of(paths):
    """Path -> Debian package, of dpkg's own lists."""
    wanted = {name: path for path in paths for name in names_of(path)}
    owners = {}
    for file in sorted(pathlib.Path("/var/lib/dpkg/info").glob("*.list")):
        package = file.name.removesuffix(".list").split(":")[0]
        for line in file.read_text(encoding="utf-8").splitlines():
            if line in wanted:
                owners.setdefault(wanted[line], package)
    for path in paths:
        if path not in owners:
            raise Unknown(f"{path}: of no Debian package; install the library as one")
    return owners


def facts_of(packages):
    """Package -> version, architecture and source."""
    if not packages:
        return {}
    form = "${Package}\t${Version}\t${Architecture}\t${source:Package}\t${source:Version}\n"
    said = subprocess.run(["dpkg-query", "-W", "-f", form, *sorted(packages)], capture_output=True, text=True, check=True).stdout
    facts = {}
    for line in said.splitlines():
        name, version, architecture, source, source_version = line.split("\t")
        facts[name] = {"version": version, "architecture": architecture, "source": source, "source_version": source_version}
    return facts


def licenses_of(package):
    """The short names of its machine-readable copyright file; none where it has another form."""
    file = pathlib.Path("/usr/share/doc") / package / "copyright"
    try:
        text = file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return []
    if not text.startswith("Format:"):
        return []
    return sorted({name.strip() for name in re.findall(r"^License:[ \t]*(\S.*)$", text, re.MULTILINE)})


def debian_component(package, facts, use):
    fact = facts[package]
    version = urllib.parse.quote(fact["version"], safe=":~")
    purl = f"pkg:deb/debian/{urllib.parse.quote(package)}@{version}?arch={fact['architecture']}"
    component = {
        "type": "library",
        "bom-ref": purl,
        "name": package,
        "version": fact["version"],
        "purl": purl,
        "properties": [
            {"name": "biteline:use", "value": use},
            {"name": "debian:source", "value": f"{fact['source']} {fact['source_version']}"},
        ],
    }
    licenses = licenses_of(package)
    if licenses:
        component["licenses"] = [{"license": {"name": name}} for name in licenses]
    return component


def debian_components(build, programs):
    shared = owners_of(set().union(*(shared_libraries(build, program) for program in programs)))
    compiled = owners_of(headers_and_archives(build, programs))
    facts = facts_of(set(shared.values()) | set(compiled.values()))
    sources = {facts[package]["source"] for package in shared.values()} | NO_CODE
    only_compiled = {package for package in compiled.values() if facts[package]["source"] not in sources}
    return [debian_component(package, facts, "shared") for package in sorted(set(shared.values()))] + [
        debian_component(package, facts, "compiled-in") for package in sorted(only_compiled)
    ]


def npm_components(metafile, lock_file):
    """The packages whose files esbuild put into the bundle."""
    inputs = json.loads(metafile.read_text(encoding="utf-8"))["inputs"]
    lock = json.loads(lock_file.read_text(encoding="utf-8"))["packages"]
    found = set()
    for name in inputs:
        match = re.match(r"(?:.*/)?(node_modules/(?:@[^/]+/)?[^/]+)/", name)
        if match:
            found.add(match[1])
    components = []
    for place in sorted(found):
        if place not in lock:
            raise Unknown(f"{lock_file}: lacks {place}, which is in the page; run npm install")
        fact, name = lock[place], place.removeprefix("node_modules/")
        purl = f"pkg:npm/{name.replace('@', '%40')}@{fact['version']}"
        component = {
            "type": "library",
            "bom-ref": purl,
            "name": name,
            "version": fact["version"],
            "purl": purl,
            "properties": [{"name": "biteline:use", "value": "page"}],
        }
        if "license" in fact:
            component["licenses"] = [{"expression": fact["license"]}]
        kind, _, digest = fact.get("integrity", "").partition("-")
        if kind == "sha512":
            component["hashes"] = [{"alg": "SHA-512", "content": base64.b64decode(digest).hex()}]
        components.append(component)
    return components


def notices(components, page_folder):
    """What must go with the package's own files: the licence texts of what is inside of them.

    A shared library comes as a package of its own, with its own."""
    texts = []
    for component in components:
        use = component["properties"][0]["value"]
        if use == "shared":
            continue
        if use == "page":
            files = sorted((page_folder / "node_modules" / component["name"]).glob("LICEN[CS]E*"))
        else:
            files = [pathlib.Path("/usr/share/doc") / component["name"] / "copyright"]
        if not files or not files[0].is_file():
            raise Unknown(f"{component['name']}: no licence text where its package keeps it; reinstall the package")
        texts.append(f"== {component['name']} {component['version']}\n\n{files[0].read_text(encoding='utf-8', errors='replace').strip()}\n")
    return "\n".join(["This package's own licence stands in the file copyright. Parts of others are inside of its files:\n", *texts])


def bill(name, version, components):
    reference = f"pkg:deb/biteline/{name}@{version}"
    text = {
        "$schema": "http://cyclonedx.org/schema/bom-1.5.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": reference,
                "name": name,
                "version": version,
                "purl": reference,
                "licenses": [{"license": {"id": "MIT"}}],
            }
        },
        "components": components,
        "dependencies": [{"ref": reference, "dependsOn": sorted(component["bom-ref"] for component in components)}],
    }
    text["serialNumber"] = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps(text, sort_keys=True)).urn
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--name", required=True, help="of the package")
    parser.add_argument("--version", required=True)
    parser.add_argument("--build", required=True, type=pathlib.Path, help="the build folder")
    parser.add_argument("--program", action="append", default=[], type=pathlib.Path)
    parser.add_argument("--page", action="append", default=[], type=pathlib.Path, help="esbuild's metafile of a bundle")
    parser.add_argument("--lock", type=pathlib.Path, help="package-lock.json of the page")
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--notices", type=pathlib.Path, help="licence texts of what is inside, packed by gzip")
    options = parser.parse_args()
    try:
        components = debian_components(options.build.resolve(), [program.resolve() for program in options.program])
        pages = {}
        for page in options.page:
            pages.update((component["bom-ref"], component) for component in npm_components(page, options.lock))
        components += [pages[reference] for reference in sorted(pages)]
        texts = notices(components, options.lock.parent if options.lock else None) if options.notices else None
    except Unknown as unknown:
        print(f"sbom.py: {unknown}", file=sys.stderr)
        return 2
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(bill(options.name, options.version, components), indent=2) + "\n", encoding="utf-8")
    if texts is not None:
        options.notices.write_bytes(gzip.compress(texts.encode(), mtime=0))
    return 0


if __name__ == "__main__":
    sys.exit(main())
