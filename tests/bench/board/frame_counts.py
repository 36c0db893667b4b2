#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""frame_counts.py FRAME_WORK PLUGIN [--check DOCUMENT]: what one picture costs a board's processor.

FRAME_WORK (of an arm64 build) runs under QEMU's user emulation, once with N and once with 2 N pictures; PLUGIN
counts blocks of instructions and bytes.  The difference over N is one picture: start-up and the drawing of the
pictures cancel.  llvm-mca then says from the processors' own tables how many cycles each block takes when it runs
again and again, all data in the first cache and each branch foreseen.

Prints a row of JSON for each size, as the other benches do, then the document's table.  --check: compares with the
table of that document instead; exit status 3 where a figure is off by more than a tenth.
Exit status 77 and the reason where a tool is missing."""

import argparse
import collections
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

SIZES = [(1626, 1236), (1626, 320), (1626, 128)]
PICTURES = 4
# As boards/ names them.  mca: the name of the processor's table in LLVM (it has none of its own for the A72, and
# takes the A57's, whose pipelines are the same).  hz: the board's data sheet.
PROCESSORS = [("Cortex-A72", "cortex-a72", 1.5e9), ("Cortex-A53", "cortex-a53", 1.6e9)]
# What the tables leave out (misses of the caches, wrong branches, the kernel): cycles of a cautious reading over
# those of the table.  A judgement, no measurement.
CAUTION = 3
TOLERANCE = 0.1
HEAD = "| picture | instructions | loaded, stored |"


def leave(reason):
    print("skipped: " + reason)
    sys.exit(77)


def tool(*names):
    for name in names:
        found = shutil.which(name)
        if found:
            return found
    leave("no " + names[0])


def sysroot():
    """Where the libraries of arm64 are."""
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../toolchains/arm64_sysroot.sh")
    made = subprocess.run([script], check=False, stdout=subprocess.PIPE, text=True)
    if made.returncode == 77:
        leave("no sysroot of arm64")
    made.check_returncode()
    return made.stdout.strip()


def counted(options, emulator, size, pictures):
    """Blocks by their code, with how often each ran, and the bytes."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "counts.json")
        told = subprocess.run([*emulator, "-plugin", f"{options.plugin},out={out}",
                               options.frame_work, *map(str, size), str(pictures)],
                              check=True, stdout=subprocess.PIPE, text=True).stdout
        with open(out, encoding="utf-8") as file:
            counts = json.load(file)
    blocks = collections.Counter()
    for executed, code in counts["blocks"]:
        blocks[code] += executed
    return blocks, counts["loaded_bytes"], counts["stored_bytes"], json.loads(told)


def one_picture(options, emulator, size):
    few = counted(options, emulator, size, PICTURES)
    many = counted(options, emulator, size, 2 * PICTURES)
    blocks = {code: (executed - few[0][code]) / PICTURES for code, executed in many[0].items()
              if executed > few[0][code]}
    return {"blocks": blocks,
            "instructions": sum(len(code) // 8 * times for code, times in blocks.items()),
            "loaded_bytes": (many[1] - few[1]) / PICTURES,
            "stored_bytes": (many[2] - few[2]) / PICTURES,
            "points": (many[3]["points"] - few[3]["points"]) / PICTURES,
            "message_bytes": many[3]["message_bytes"]}


def assembly(codes, llvm_mc):
    """Each block's code as text."""
    lines = []
    for code in codes:
        for word in range(0, len(code), 8):
            octets = bytes.fromhex(code[word:word + 8])[::-1]
            lines.append(" ".join(f"0x{octet:02x}" for octet in octets))
    text = subprocess.run([llvm_mc, "-triple=aarch64", "-mattr=+v8.2a", "-disassemble"], check=True,
                          input="\n".join(lines), stdout=subprocess.PIPE, text=True).stdout
    instructions = [line for line in text.splitlines() if line.strip() and not line.strip().startswith(".")]
    if len(instructions) != len(lines):
        sys.exit(f"frame_counts: {len(lines)} instructions expected, llvm-mc knows {len(instructions)}")
    result = []
    for code in codes:
        count = len(code) // 8
        result.append("\n".join(instructions[:count]))
        del instructions[:count]
    return result


def cycles(blocks, processor, llvm_mc, llvm_mca):
    """Of one picture: each block's cycles for one of many turns, times how often it ran."""
    codes = list(blocks)
    regions = [f"# LLVM-MCA-BEGIN b{i}\n{text}\n# LLVM-MCA-END b{i}"
               for i, text in enumerate(assembly(codes, llvm_mc))]
    told = subprocess.run([llvm_mca, "-mtriple=aarch64", "-mcpu=" + processor, "-iterations=100",
                           "-resource-pressure=false", "-instruction-info=false"],
                          check=True, input="\n".join(regions) + "\n", stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True).stdout
    seen = dict(re.findall(r"Code Region - b(\d+)\s.*?Total Cycles:\s+(\d+)", told, re.DOTALL))
    if len(seen) != len(codes):
        sys.exit(f"frame_counts: {len(codes)} blocks expected, llvm-mca tells of {len(seen)}")
    return sum(int(seen[str(i)]) / 100 * blocks[code] for i, code in enumerate(codes))


def estimates(options):
    # Debian's qemu-user; its static sister takes no plugin.
    qemu = tool("qemu-aarch64")
    llvm_mc, llvm_mca = tool("llvm-mc-14", "llvm-mc"), tool("llvm-mca-14", "llvm-mca")
    for program in (options.frame_work, options.plugin):
        if not os.path.exists(program):
            leave("no " + program)
    emulator = [qemu, "-L", sysroot()]
    for size in SIZES:
        picture = one_picture(options, emulator, size)
        row = {"bench": "board.frame", "what": f"{size[0]} x {size[1]}",
               "instructions": picture["instructions"], "loaded_bytes": picture["loaded_bytes"],
               "stored_bytes": picture["stored_bytes"], "points": picture["points"],
               "message_bytes": picture["message_bytes"]}
        for name, mca, hertz in PROCESSORS:
            taken = cycles(picture["blocks"], mca, llvm_mc, llvm_mca)
            row[name] = {"cycles": taken, "rate_hz": [hertz / taken / CAUTION, hertz / taken]}
        yield row


def megas(value):
    return f"{value / 1e6:.1f}"


def table(rows):
    heads = [f"{name} cycles | a second" for name, _, _ in PROCESSORS]
    yield f"{HEAD} {' | '.join(heads)} |"
    yield "| --- | --- | --- |" + " --- | --- |" * len(PROCESSORS)
    for row in rows:
        cells = [row["what"], megas(row["instructions"]) + " M",
                 f"{megas(row['loaded_bytes'])}, {megas(row['stored_bytes'])} MB"]
        for name, _, _ in PROCESSORS:
            low, high = row[name]["rate_hz"]
            cells += [megas(row[name]["cycles"]) + " M", f"{float(f'{low:.2g}'):.0f} to {float(f'{high:.2g}'):.0f}"]
        yield "| " + " | ".join(cells) + " |"


def numbers(line):
    """Of a row, behind its size."""
    return [float(number) for number in re.findall(r"[\d.]+", line.split("|", 2)[2])]


def check(lines, document):
    """The document's figures against these."""
    with open(document, encoding="utf-8") as file:
        told = [line.strip() for line in file]
    if lines[0] not in told:
        sys.exit(f"{document}: no table that begins with '{lines[0]}'")
    begin = told.index(lines[0])
    wrong = 0
    for line, found in zip(lines[2:], told[begin + 2:begin + len(lines)]):
        same = (line.split("|")[1] == found.split("|")[1] and len(numbers(line)) == len(numbers(found)) and
                all(abs(a - b) <= TOLERANCE * max(a, b) + 0.11 for a, b in zip(numbers(line), numbers(found))))
        if not same:
            print(f"{document}: '{found}' is now '{line}'")
            wrong += 1
    return 3 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frame_work")
    parser.add_argument("plugin")
    parser.add_argument("--check")
    options = parser.parse_args()
    rows = list(estimates(options))
    for row in rows:
        print(json.dumps(row))
    lines = list(table(rows))
    print("\n".join(lines))
    return check(lines, options.check) if options.check else 0


if __name__ == "__main__":
    sys.exit(main())
