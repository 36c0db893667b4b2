#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_api_answers.py OPENAPI ANSWERS [--every]: each noted answer against its schema in openapi.yaml.

ANSWERS holds one JSON object a line: method, path (after /api/v1), status, type, body; or event, the text of a
WebSocket message.  --every: each call of the API with a JSON answer must be among them.
Exit 1: a disagreement; 77: no validator on this machine.
"""
import json
import re
import sys
from datetime import datetime

try:
    import yaml
    from jsonschema import Draft202012Validator, FormatChecker
except ImportError as missing:
    print(f"skipped: {missing.name} is missing; ./run test installs it")
    sys.exit(77)

# biteline-web answers these by itself; its own tests look at them.
BY_WEB = {"/openapi.yaml", "/model-files", "/scans/{id}/files", "/scans/{id}/files/{path}", "/events", "/live", "/metrics", "/foxglove"}
# And the centre answers what begins so (fleet_page).
BY_CENTRE = "/fleet/"
# Refused before it is known what is asked: these alone may have no words of their own at an operation.
UNREAD = {405, 408, 413, 421, 431, 501}
EVENT_DATA = {
    "state": "State",
    "scan": "ScanRow",
    "log": "LogEntry",
    "control": "Control",
    "model": "Model",
    "teaching": "Teaching",
    "health": "Sensor",
}

formats = FormatChecker()


@formats.checks("date-time", raises=ValueError)
def is_time(text):
    """RFC 3339 in UTC."""
    return not isinstance(text, str) or (text.endswith("Z") and bool(datetime.fromisoformat(text[:-1])))


class Api:
    def __init__(self, file):
        with open(file, encoding="utf-8") as stream:
            self.text = yaml.safe_load(stream)

    def torn(self, node=None, where=""):
        """Words that an unquoted comma tore off their description: a key with a blank in it, or one that says nothing."""
        node = self.text if node is None else node
        if isinstance(node, list):
            return [fault for number, one in enumerate(node) if one is not None
                    for fault in self.torn(one, f"{where}/{number}")]
        if not isinstance(node, dict):
            return []
        own = [f"{where}: '{key}' is no key; quote the description" for key, value in node.items()
               if value is None and "example" not in where and key not in ("example", "default")]
        return own + [fault for key, value in node.items() if value is not None for fault in self.torn(value, f"{where}/{key}")]

    def at(self, reference):
        node = self.text
        for name in reference.removeprefix("#/").split("/"):
            node = node[name]
        return node

    def closed(self, schema, part=False):
        """Without references; no object says more than is described.  `part`: of an allOf, whose whole is closed."""
        if "$ref" in schema:
            return self.closed(self.at(schema["$ref"]), part)
        out = {}
        for key, value in schema.items():
            if key in ("allOf", "oneOf", "anyOf"):
                value = [self.closed(one, key == "allOf") for one in value]
            elif key == "properties":
                value = {name: self.closed(one) for name, one in value.items()}
            elif key in ("items", "additionalProperties") and isinstance(value, dict):
                value = self.closed(value)
            out[key] = value
        if ("properties" in out or "allOf" in out) and not part:
            out["unevaluatedProperties"] = False
        return out

    def path_of(self, path):
        """The described path that `path` is, the one with the fewest braces first."""
        for described in sorted(self.text["paths"], key=lambda name: name.count("{")):
            pattern = re.sub(r"\\{path\\}", ".+", re.escape(described))
            if re.fullmatch(re.sub(r"\\{\w+\\}", "[^/]+", pattern), path):
                return described
        return None

    def schema_of(self, method, path, status):
        """The schema of a JSON answer; None: it has no body, {}: a file of any type.  KeyError: no such answer is described."""
        answers = self.text["paths"][path][method.lower()]["responses"]
        answer = answers.get(str(status)) or (answers["default"] if status in UNREAD else None)
        if answer is None:
            raise KeyError(status)
        if "$ref" in answer:
            answer = self.at(answer["$ref"])
        content = answer.get("content", {})
        if "*/*" in content:
            return {}
        return self.closed(content["application/json"]["schema"]) if "application/json" in content else None


def faults(schema, body):
    found = sorted(Draft202012Validator(schema, format_checker=formats).iter_errors(body), key=lambda e: list(e.path))
    return [f"{'.'.join(str(part) for part in one.path) or 'body'}: {one.message[:300]}" for one in found]


def faults_of_answer(api, noted, seen):
    error = api.closed(api.at("#/components/schemas/Error"))
    if "event" in noted:
        event = json.loads(noted["event"])
        out = faults(api.closed(api.at("#/components/schemas/Event")) | {"unevaluatedProperties": True}, event)
        kind = EVENT_DATA.get(event.get("event"))
        return out + (faults(api.closed(api.at(f"#/components/schemas/{kind}")), event["data"]) if kind else [])
    status, body = noted["status"], noted["body"]
    described = api.path_of(noted["path"]) if noted["path"] else None
    known = described and noted["method"].lower() in api.text["paths"][described]
    if not known:
        # A path or method that is none gets an error of the described shape, and nothing else.
        return faults(error, body) if status >= 400 else ["an answer that openapi.yaml does not describe"]
    try:
        schema = api.schema_of(noted["method"], described, status)
    except KeyError:
        return [f"status {status} is not described"]
    if status < 400:
        seen.add((noted["method"], described))
    if schema is None:
        is_empty = body is None or noted["type"] != "application/json"
        return [] if is_empty else ["a body where none is described"]
    return faults(schema, body)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    api = Api(sys.argv[1])
    seen, told, count = set(), set(api.torn()), 0
    with open(sys.argv[2], encoding="utf-8") as stream:
        for line in stream:
            noted = json.loads(line)
            count += 1
            name = "event" if "event" in noted else f"{noted['method']} {noted['path']} {noted['status']}"
            told |= {f"{name}: {fault}" for fault in faults_of_answer(api, noted, seen)}
    for line in sorted(told):
        print(line)
    missing = set()
    if "--every" in sys.argv:
        for path, item in api.text["paths"].items():
            missing |= {(method.upper(), path) for method in item if method in ("get", "post", "put", "patch", "delete")}
        missing = {(method, path) for method, path in missing - seen if path not in BY_WEB and not path.startswith(BY_CENTRE)}
        for method, path in sorted(missing):
            print(f"{method} {path}: no good answer was seen")
    print(f"{count} answers, {len(seen)} calls")
    if count == 0:
        print("no answer at all was noted")
    sys.exit(1 if told or missing or count == 0 else 0)


if __name__ == "__main__":
    main()
