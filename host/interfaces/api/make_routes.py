#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""make_routes.py FOLDER OPENAPI BETWEEN: the tables of routes and the handlers' declarations, as C++ to be included.

OPENAPI describes what biteline-web serves, BETWEEN what its programs ask each other beside it.  Written into FOLDER:

    service_handlers.inc  service_routes.inc   functions of Api, and its table (host/interfaces/api)
    centre_handlers.inc   centre_routes.inc    likewise of PageApi (host/apps/biteline-fleet)
    web_routes.inc                             what biteline-web does with each (host/apps/biteline-web)

A handler is the member function of the operation's operationId: one too few or too many does not compile.
Who may is `x-role`, `x-control`, `x-local`.  `x-biteline` of an operation holds what else a table needs:

    by       who answers: service, centre, or web alone; [service] where nothing is said
    web      what biteline-web does with it, an enumerator of web::Handling; forward where nothing is said
    open     the handler itself sees who may
    long     it takes seconds, for which no other request waits
    changes  false: it changes nothing though it is no GET, so no event `log` follows
"""
import sys
from pathlib import Path

try:
    import yaml
except ImportError:
    sys.exit("make_routes.py: Python has no yaml: install python3-yaml (./run does), then build again")

METHODS = ("get", "post", "put", "patch", "delete")
PROGRAMS = ("service", "centre", "web")
ROLES = ("viewer", "operator", "engineer", "administrator")
EXTRA = {"by": list, "web": str, "open": bool, "long": bool, "changes": bool}


class Operation:
    def __init__(self, document, path, method, item, text):
        self.where = f"{document}: {method.upper()} {path}"
        self.name = text.get("operationId") or self.fail("no operationId")
        extra = text.get("x-biteline", {})
        for key, value in extra.items():
            if key not in EXTRA or not isinstance(value, EXTRA[key]):
                self.fail(f"x-biteline.{key}: {value!r} is not known; see make_routes.py")
        self.by = extra.get("by", ["service"])
        if not self.by or set(self.by) - set(PROGRAMS):
            self.fail(f"x-biteline.by: {self.by}: some of {', '.join(PROGRAMS)} expected")
        self.web = extra.get("web", "forward")
        role = text.get("x-role")
        free = text.get("security") == [] or extra.get("open", False)
        if role not in ROLES and not (free and role is None):
            self.fail(f"x-role: one of {', '.join(ROLES)} expected, found {role}")
        control = text.get("x-control", False)
        if control and free:
            self.fail("x-control, and nobody need be logged in")
        self.pattern = ("" if "servers" in item else "/api/v1") + path
        words = {True: "true", False: "false"}
        self.route = ", ".join([
            f'.method = "{method.upper()}"',
            f'.pattern = "{self.pattern}"',
            f'.operation = "{self.name}"',
            f".role = {'std::nullopt' if free else 'accounts::Role::' + role.capitalize()}",
            f".control = {words[control]}",
            f".local = {words[text.get('x-local', False)]}",
            f".is_long = {words[extra.get('long', False)]}",
            f".changes = {words[extra.get('changes', method != 'get')]}",
        ])

    def fail(self, words):
        sys.exit(f"{self.where}: {words}")


def operations_of(file):
    document = yaml.safe_load(Path(file).read_text(encoding="utf-8"))
    return [Operation(Path(file).name, path, method, item, item[method])
            for path, item in document["paths"].items() for method in METHODS if method in item]


def write(file, lines):
    file.write_text("".join(f"{line}\n" for line in ["// Made by host/interfaces/api/make_routes.py.", *lines]), encoding="utf-8")


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    public, between = operations_of(sys.argv[2]), operations_of(sys.argv[3])
    named = {}
    for one in public + between:
        if one.name in named:
            one.fail(f"operationId {one.name} is that of {named[one.name].where}, too")
        named[one.name] = one
    for program, owner in (("service", "Api"), ("centre", "PageApi")):
        own = [one for one in public + between if program in one.by]
        write(folder / f"{program}_handlers.inc",
              [f"[[nodiscard]] control::Answer {one.name}(const Call& call);" for one in own])
        write(folder / f"{program}_routes.inc", [f"Row{{{{{one.route}}}, &{owner}::{one.name}}}," for one in own])
    write(folder / "web_routes.inc",
          [f"Route{{{{{one.route}}}, Handling::{''.join(part.capitalize() for part in one.web.split('_'))}}}," for one in public])


main()
