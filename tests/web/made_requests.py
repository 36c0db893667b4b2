# SPDX-License-Identifier: MIT
"""Requests made of an OpenAPI document: mostly such as it describes, some of them spoiled."""
import copy
import json
import random
import string
from dataclasses import dataclass, field
from urllib.parse import quote, urlencode

JUNK = [None, True, 0, -1, 1e300, 2**63, "", " ", "x" * 5000, "../../etc/passwd", "\u00fc\u4e2d", "a\nb", "'; DROP TABLE scans; --",
        [], {}, [[[]]], {"a": {"b": []}}, "NaN", "scan-99999999999", "%00"]
JUNK_SHARE = 0.06
KINDS = {"string": str, "integer": int, "number": (int, float), "boolean": bool, "object": dict, "array": list, "null": type(None)}
# What `security` says where nobody need be logged in.
ANYBODY = [[], [{}]]


def is_of(schema, value):
    """Whether a word of the same name can be meant here: a text where a text is expected."""
    kind = schema.get("type", "string")
    return any(isinstance(value, KINDS[one]) for one in (kind if isinstance(kind, list) else [kind]))


@dataclass
class Made:
    operation: str
    method: str
    path: str  # after the server's address, with the query
    described: str
    body: bytes = b""
    headers: dict = field(default_factory=dict)


class Maker:
    """`known`: words that mean something to the server, by the name of the field or parameter."""

    def __init__(self, document, seed, known):
        self.text, self.seed, self.known = document, seed, known
        self.random = random.Random(seed)

    def operations(self):
        for path, item in self.text["paths"].items():
            for method in ("get", "post", "put", "patch", "delete"):
                if method in item:
                    yield path, method, item, item[method]

    def seen_through(self, node):
        while "$ref" in node:
            rest = {key: value for key, value in node.items() if key != "$ref"}
            target = self.text
            for name in node["$ref"].removeprefix("#/").split("/"):
                target = target[name]
            node = {**target, **rest}
        return node

    def chance(self, share):
        return self.random.random() < share

    def word(self, schema):
        least, most = schema.get("minLength", 0), min(schema.get("maxLength", 20), 40)
        if "pattern" in schema:
            if "scan-" in schema["pattern"]:
                return f"scan-{self.random.randrange(10000):04}"
            least = 1
        if schema.get("format") == "date-time":
            return "2026-11-27T08:00:00Z"
        return "".join(self.random.choice(string.ascii_letters + string.digits) for _ in range(self.random.randint(least, max(least, most))))

    def value(self, schema, name=""):
        """One that the schema allows, as far as this test's document needs it."""
        schema = self.seen_through(schema)
        known = [one for one in self.known.get(name, []) if is_of(schema, one)]
        if known and self.chance(0.8):
            return copy.deepcopy(self.random.choice(known))
        for several in ("oneOf", "anyOf"):
            if several in schema:
                return self.value(self.random.choice(schema[several]), name)
        if "allOf" in schema:
            return self.value(schema["allOf"][0], name)
        if "const" in schema:
            return schema["const"]
        if "enum" in schema:
            return self.random.choice(schema["enum"])
        kind = schema.get("type", "string")
        if isinstance(kind, list):
            kind = self.random.choice(kind)
        if kind == "object":
            return self.thing(schema)
        if kind == "array":
            number = self.random.randint(schema.get("minItems", 0), min(schema.get("maxItems", 3), schema.get("minItems", 0) + 3))
            return [self.value(schema.get("items", {}), name) for _ in range(number)]
        if kind in ("integer", "number"):
            least, most = schema.get("minimum", -1000), schema.get("maximum", 1000)
            return self.random.randint(int(least), int(most)) if kind == "integer" else self.random.uniform(least, most)
        return {"boolean": self.chance(0.5), "null": None}.get(kind, self.word(schema) if kind == "string" else None)

    def thing(self, schema):
        required = schema.get("required", [])
        out = {name: self.value(one, name) for name, one in schema.get("properties", {}).items() if name in required or self.chance(0.5)}
        if isinstance(schema.get("additionalProperties"), dict):
            out |= {self.word({"minLength": 1}): self.value(schema["additionalProperties"]) for _ in range(schema.get("minProperties", 0))}
        return out

    def spoil(self, body):
        """Each field may become junk, go, or get company."""
        for name in list(body):
            if self.chance(JUNK_SHARE):
                body[name] = copy.deepcopy(self.random.choice(JUNK))
            elif self.chance(JUNK_SHARE):
                del body[name]
        if self.chance(JUNK_SHARE):
            body[self.random.choice(["no_such_field", "", "name ", "__proto__"])] = self.random.choice(JUNK)

    def turn_to(self, operation, turn):
        """From here on the same happens, whatever else the document holds."""
        self.random.seed(f"{self.seed} {operation['operationId']} {turn}")

    def make(self, path, method, item, operation):
        made = Made(operation["operationId"], method.upper(), "", path)
        address, query = path, {}
        for parameter in [self.seen_through(one) for one in item.get("parameters", []) + operation.get("parameters", [])]:
            name, place = parameter["name"], parameter["in"]
            value = self.random.choice(JUNK) if self.chance(JUNK_SHARE) else self.value(parameter["schema"], name)
            text = value if isinstance(value, str) else json.dumps(value)
            if place == "path":
                safe = "/" if name == "path" else ""
                address = address.replace(f"{{{name}}}", quote(text, safe=safe) or "_")
            elif place == "query" and self.chance(0.5):
                query[name] = text
            elif place == "header" and self.chance(0.5):
                made.headers[name] = "".join(letter for letter in text if " " <= letter <= "~")[:500]
        root = item.get("servers", self.text["servers"])[0]["url"].rstrip("/")
        made.path = root + address + (f"?{urlencode(query)}" if query else "")
        if "requestBody" in operation:
            self.put_body(made, self.seen_through(operation["requestBody"]))
        return made

    def put_body(self, made, described):
        content = described["content"]
        if not described.get("required") and self.chance(0.3):
            return
        kind = next(iter(content))
        made.headers["Content-Type"] = kind
        if kind != "application/json":
            made.body = self.random.randbytes(self.random.choice([0, 10, 3000]))
            return
        # A whole body may be known, too, by its operation.
        body = self.value(content[kind]["schema"], made.operation)
        self.spoil(body)
        made.body = json.dumps(body).encode()
        if self.chance(0.03):
            made.body = self.random.choice([b"{", b"[]", b"null", b"\xff\xfe", b'{"a":' * 60, b""])
        elif self.chance(0.03):
            made.headers["Content-Type"] = "text/plain"
