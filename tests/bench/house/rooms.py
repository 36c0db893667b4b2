#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""rooms.py [REVISION...]: the size of each room at each revision of git (HEAD by default), as tables in Markdown.

files, lines: C++ and TypeScript, blank lines and comments left out.  numbers: literals in C++ and TypeScript that are not
0, 1 or 2 (written in any way), outside of comments and texts.  upwards: includes of a host algorithm that name intake,
the arm's link, interfaces, records, fleet or programs.  programs, libraries: what the CMake lists add by name, tests
and benches among the programs.  repeated pairs: pairs of C++ or TypeScript files that have RUN code lines in a row in common, told by
whole lines without indentation; includes, and lines of a bracket alone, do not count.  Nothing is built."""

import collections
import itertools
import re
import subprocess
import sys

SOURCE = (".cpp", ".hpp", ".h", ".c", ".ts", ".tsx")
# As tests/layering/check_layers.sh has them; the old names of a room stand beside the new one.
ALGORITHMS = re.compile(
    r"host/(geometry|cloud|bite_line|calibration|transfer|second_look|study|robot/kinematics|robot/path|report)/")
ABOVE = re.compile(
    r'^\s*#\s*include "host/(intake|robot/link|interfaces|doors|records|fleet|apps)/', re.MULTILINE)
COMMENT_OR_TEXT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'", re.DOTALL)
NUMBER = re.compile(
    r"(?<![\w.])(?:0[xX][0-9a-fA-F']+|(?:\d[\d']*\.?[\d']*|\.\d+)(?:[eE][+-]?\d+)?)[a-zA-Z]*\b")
RUN = 6
NO_CODE_OF_ITS_OWN = re.compile(r"^(?:#.*|import .*|[\s{}()\[\];,]*)$")
ADDS_PROGRAM = re.compile(r"^\s*biteline_add_(?:program|test|bench)\(", re.MULTILINE)
ADDS_LIBRARY = re.compile(r"^\s*biteline_add_library\(", re.MULTILINE)


def git(*words, data=None):
    return subprocess.run(["git", *words], input=data, stdout=subprocess.PIPE, check=True).stdout


def files_of(revision):
    """Yields (path, text) of each source file and CMake list of a revision."""
    paths = [path for path in git("ls-tree", "-r", "--name-only", "--full-tree", revision).decode().splitlines()
             if path.endswith(SOURCE) or path.endswith("CMakeLists.txt")]
    asked = "".join(f"{revision}:{path}\n" for path in paths).encode()
    answer, at = git("cat-file", "--batch", data=asked), 0
    for path in paths:
        end = answer.index(b"\n", at)
        size = int(answer[at:end].split()[2])
        yield path, answer[end + 1:end + 1 + size].decode(errors="replace")
        at = end + 1 + size + 1


def bare(text):
    """The text without comments, each string or character as a pair of quotes; lines are kept."""
    def kept(match):
        return "\n" * match.group().count("\n") if match.group().startswith("/") else '""'
    return COMMENT_OR_TEXT.sub(kept, text)


def is_trivial(literal):
    digits = literal.replace("'", "").rstrip("uUlLfFzZn") if not literal.lower().startswith("0x") else literal
    try:
        return float(digits) in (0, 1, 2)
    except ValueError:
        return False


def runs_of(code):
    """Each run of RUN lines, as a hash."""
    lines = [line for line in (line.strip() for line in code.splitlines()) if not NO_CODE_OF_ITS_OWN.match(line)]
    return {hash(tuple(lines[at:at + RUN])) for at in range(len(lines) - RUN + 1)}


def room_of(path):
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] in ("host", "hal", "tests") and len(parts) > 2 else parts[0]


def measure(revision):
    """Counter of each room, and one of the whole tree."""
    rooms, whole = collections.defaultdict(collections.Counter), collections.Counter()
    places = collections.defaultdict(set)
    for path, text in files_of(revision):
        if path.endswith("CMakeLists.txt"):
            whole.update(programs=len(ADDS_PROGRAM.findall(text)), libraries=len(ADDS_LIBRARY.findall(text)))
            continue
        code = bare(text)
        for run in runs_of(COMMENT_OR_TEXT.sub(lambda match: "" if match.group().startswith("/") else match.group(), text)):
            places[run].add(path)
        counts = collections.Counter(
            files=1, lines=sum(1 for line in code.splitlines() if line.strip()),
            numbers=sum(1 for literal in NUMBER.findall(code) if not is_trivial(literal)),
            upwards=len(ABOVE.findall(text)) if ALGORITHMS.match(path) else 0)
        rooms[room_of(path)].update(counts)
        whole.update(counts)
    pairs = {pair for paths in places.values() if len(paths) > 1 for pair in itertools.combinations(sorted(paths), 2)}
    whole["repeated pairs"] = len(pairs)
    whole["repeated pairs without tests"] = sum(1 for pair in pairs if not any(path.startswith("tests/") for path in pair))
    return rooms, whole


def main(revisions):
    names = [git("rev-parse", "--short", revision).decode().strip() for revision in revisions]
    measured = [measure(revision) for revision in revisions]
    columns = ("files", "lines", "numbers", "upwards")
    head = [f"{column} {name}" for column in columns for name in names]
    print("| room | " + " | ".join(head) + " |\n| --- |" + " ---: |" * len(head))
    for room in sorted({room for rooms, _ in measured for room in rooms}):
        print(f"| {room} | " + " | ".join(str(rooms[room][column]) for column in columns for rooms, _ in measured) + " |")
    print("\n| whole tree | " + " | ".join(names) + " |\n| --- |" + " ---: |" * len(names))
    for column in columns + ("programs", "libraries", "repeated pairs", "repeated pairs without tests"):
        print(f"| {column} | " + " | ".join(str(whole[column]) for _, whole in measured) + " |")


if __name__ == "__main__":
    main(sys.argv[1:] or ["HEAD"])
