#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_site.py SITE: each link of a built site leads to a file and heading in it, and no page loads anything from elsewhere.

Pages that Doxygen makes (SITE/headers) are read for what they load; their links are its own.
"""
import html.parser
import pathlib
import sys
import urllib.parse

LOADING = {"script": "src", "img": "src", "link": "href", "iframe": "src"}


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.names, self.links, self.loads = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        of = dict(attributes)
        self.names.update(of[key] for key in ("id", "name") if of.get(key))
        if tag == "a" and of.get("href"):
            self.links.append(of["href"])
        if of.get(LOADING.get(tag)):
            self.loads.append(of[LOADING[tag]])


def faults(site):
    pages = {path.resolve(): Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    for path, page in pages.items():
        where = path.relative_to(site)
        for link in page.loads:
            if urllib.parse.urlsplit(link).netloc:
                yield f"{where}: loads {link}: the site must work without a network"
        if where.parts[0] == "headers":
            continue
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = path if not parts.path else (path.parent / urllib.parse.unquote(parts.path)).resolve()
            if target.is_dir():
                target = target / "index.html"
            if not target.is_file():
                yield f"{where}: {link} leads nowhere"
            elif parts.fragment and target in pages and parts.fragment not in pages[target].names:
                yield f"{where}: {link}: no such heading"


def main():
    site = pathlib.Path(sys.argv[1]).resolve()
    found = list(faults(site)) if (site / "index.html").exists() else [f"{site}: no site: build it first"]
    for fault in found:
        print(f"docs: {fault}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
