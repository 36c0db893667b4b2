#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""stage.py ROOT OUT: every document of the tree, and what documents link to, at its own path in OUT.

A browser on files shows no folder, so a link to a folder becomes one to the folder's README.md.
"""
import os
import pathlib
import re
import shutil
import sys

LINK = re.compile(r"(\]\()([^)\s#]+)((?:#[^)\s]*)?\))")
SKIPPED = {"node_modules", ".git"}


def documents(root):
    for folder, names, files in os.walk(root):
        names[:] = sorted(n for n in names if n not in SKIPPED and not n.startswith("build"))
        yield from (pathlib.Path(folder, name) for name in sorted(files) if name.endswith(".md"))


class Stage:
    def __init__(self, root, out):
        self.root, self.out, self.faults = root, out, []

    def take(self, document):
        """Writes the document, and copies the files that it links to."""
        place = self.out / document.relative_to(self.root)
        place.parent.mkdir(parents=True, exist_ok=True)

        def follow(match):
            target = match[2]
            if re.match(r"[a-z]+:", target):
                return match[0]
            linked = pathlib.Path(os.path.normpath(document.parent / target))
            if linked.is_dir():
                if not (linked / "README.md").is_file():
                    self.faults.append(f"{document.relative_to(self.root)}: link to {target}, a folder without README.md: link to a file")
                    return match[0]
                return f"{match[1]}{target.rstrip('/')}/README.md{match[3]}"
            if linked.is_file() and linked.suffix != ".md":
                copy = self.out / linked.relative_to(self.root)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(linked, copy)
            return match[0]

        place.write_text(LINK.sub(follow, document.read_text(encoding="utf-8")), encoding="utf-8")


def main():
    root, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    stage = Stage(root, out)
    for document in documents(root):
        stage.take(document)
    for fault in stage.faults:
        print(f"docs: {fault}", file=sys.stderr)
    return 1 if stage.faults else 0


if __name__ == "__main__":
    sys.exit(main())
