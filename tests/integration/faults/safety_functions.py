#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""safety_functions.py ROOT [--write]: counts how many dangerous failures of each safety function a test finds.

The failures that are made to happen stand in the two fault tables beside this file, those that nothing finds in
docs/safety-functions.md.  Without --write it fails where the document has other figures, where a row names no test, or a
test that is not there.
"""
import pathlib
import re
import sys

HERE = "tests/integration/faults"
DOCUMENT = "docs/safety-functions.md"
BEGIN, END = "<!-- counted by safety_functions.py -->\n", "<!-- end -->\n"
UNFOUND = "\n## What nothing finds\n"
NAMES = {
    "L": "the laser is dark within 100 ms",
    "A": "the arm stands when it is not where its path is",
    "T": "the tool is off when the arm is stopped or nobody watches it",
    "G": "nothing is sent that is not fresh, checked and allowed",
}


def rows_of(text, columns):
    """Rows of the text's tables that have so many columns, without rulers."""
    found = []
    for line in text.splitlines():
        if not line.startswith("|"):
            continue
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == columns and not set(line) <= set("|-: "):
            found.append(cells)
    return found


def function_of_sensor(row):
    """The laser's column says whether darkness is what saves: it goes off, or it must not come on."""
    return "L" if row[1].startswith(("off", "stays off")) else None


def function_of_robot(row):
    _, reason, noticed, _, tests = row
    if noticed in ("-", "the look"):
        return None  # goes on, rightly; a shoe that is not well worked hurts nobody
    if "before sending" in noticed or "start" in noticed:
        return "G"
    if "dead_man" in tests or "tool_on" in reason:
        return "T"
    return "A"


def names_of_tests(root):
    """Every name by which a fault table may call a test: its own, its group's, its file's."""
    names = set()
    for file in sorted((root / "tests").rglob("*")):
        if file.suffix in (".cpp", ".hpp"):
            text = file.read_text(encoding="utf-8")
            for group, name in re.findall(r"\b(?:[A-Z]+_)*TEST\(\s*(\w+),\s*(\w+)\)", text):
                names.update((group, name))
            names.update(re.findall(r"\bTEST_GROUP(?:_BASE)?\(\s*(\w+)", text))
        if file.suffix in (".cpp", ".py", ".sh"):
            names.update((file.name, file.stem))
        if file.name == "CMakeLists.txt":
            text = file.read_text(encoding="utf-8")
            names.update(re.findall(r"(?:add_test\(NAME\s+|biteline_add_(?:long_)?test\()(\w+)", text))
    return names


def named_tests(cell):
    return re.findall(r"`([^`]+)`", cell)


def is_there(name, names):
    if name.endswith("..."):
        return any(other.startswith(name[:-3]) for other in names)
    return name in names


def level_of(ratio):
    """ISO 13849-1:2015, table 5."""
    return "none" if ratio < 0.6 else "low" if ratio < 0.9 else "medium" if ratio < 0.99 else "high"


def count(root):
    names = names_of_tests(root)
    found = {function: 0 for function in NAMES}
    tests = {function: set() for function in NAMES}
    faults = []
    for file, function_of in (("README.md", function_of_sensor), ("ROBOT.md", function_of_robot)):
        rows = rows_of((root / HERE / file).read_text(encoding="utf-8"), 5)[1:]
        for row in rows:
            for name in named_tests(row[-1]):
                if not is_there(name, names):
                    faults.append(f"{HERE}/{file}: '{row[0][:60]}' names {name}, and there is no such test")
            function = function_of(row)
            if function is None:
                continue
            if not named_tests(row[-1]):
                faults.append(f"{HERE}/{file}: '{row[0][:60]}' names no test")
                continue
            found[function] += 1
            tests[function].update(named_tests(row[-1]))
    missed = {function: 0 for function in NAMES}
    unfound = (root / DOCUMENT).read_text(encoding="utf-8").split(UNFOUND)[1].split("\n## ")[0]
    for row in rows_of(unfound, 4):
        if row[0] in missed:
            missed[row[0]] += 1
    lines = [
        "| | the function | failures that tests make | tests | found by nothing | coverage | ISO 13849-1 |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for function, words in NAMES.items():
        if found[function] == 0 or missed[function] == 0:
            faults.append(f"{function} ({words}): {found[function]} found, {missed[function]} not: a table was not read")
            continue
        ratio = found[function] / (found[function] + missed[function])
        counts = f"{found[function]} | {len(tests[function])} | {missed[function]}"
        lines.append(f"| {function} | {words} | {counts} | {100 * ratio:.0f} % | {level_of(ratio)} |")
    return "\n".join(lines) + "\n", faults


def main():
    root = pathlib.Path(sys.argv[1])
    table, faults = count(root)
    document = root / DOCUMENT
    text = document.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    counted = before + BEGIN + table + END + after
    if "--write" in sys.argv[2:]:
        document.write_text(counted, encoding="utf-8")
    elif counted != text:
        faults.append(f"{DOCUMENT}: other figures are counted; run {HERE}/safety_functions.py . --write")
    print("\n".join(faults) if faults else table, end="" if not faults else "\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
