#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""api_page.py OPENAPI OUT.md: the reference of a cell's API as one page, made of its document.

Each operation has its address, who may call it, what it takes and which statuses it answers."""

import pathlib
import sys

import yaml

METHODS = ("get", "post", "put", "patch", "delete")


def cell(text):
    return " ".join(str(text).split()).replace("|", "\\|")


class Reference:
    def __init__(self, document):
        self.document = document

    def resolve(self, node):
        """The node itself, or what its $ref names; a name that is not there ends with a KeyError."""
        while "$ref" in node:
            target = self.document
            for word in node["$ref"].removeprefix("#/").split("/"):
                target = target[word]
            node = target
        return node

    def name_of(self, schema):
        if "oneOf" in schema:
            return " or ".join(self.name_of(each) for each in schema["oneOf"])
        if schema.get("type") == "array":
            return f"list of {self.name_of(schema['items'])}"
        if "$ref" in schema:
            return f"`{schema['$ref'].split('/')[-1]}`"
        if "properties" in schema:
            required = set(schema.get("required", ()))
            return ", ".join(f"`{key}`" + ("" if key in required else " (optional)") for key in schema["properties"])
        return schema.get("type", "")

    def content(self, node):
        named = [f"{media}: {self.name_of(what.get('schema', {}))}".rstrip(": ")
                 for media, what in self.resolve(node).get("content", {}).items()]
        return "; ".join(named)

    def operation(self, path, method, operation, shared):
        yield f"### `{method.upper()} {path}`\n"
        yield operation["summary"].rstrip(".") + ".\n"
        if "description" in operation:
            yield operation["description"].strip() + "\n"
        role = operation.get("x-role")
        yield "Who: " + (f"role {role} or higher" if role else "anybody, without a login") + (
            ", in control" if operation.get("x-control") else "") + (
            "; the cell's own machine needs no session" if operation.get("x-local") else "") + ".\n"
        parameters = [self.resolve(each) for each in shared + operation.get("parameters", [])]
        if parameters:
            yield "| parameter | in | what |\n| --- | --- | --- |"
            for each in parameters:
                yield f"| `{each['name']}` | {each['in']} | {cell(each.get('description', ''))} |"
            yield ""
        if "requestBody" in operation:
            yield f"Takes {self.content(operation['requestBody'])}.\n"
        yield "| status | what | body |\n| --- | --- | --- |"
        for status, answer in operation["responses"].items():
            yield f"| {status} | {cell(self.resolve(answer).get('description', ''))} | {cell(self.content(answer))} |"
        yield ""

    def page(self):
        yield "# The API of a cell\n"
        yield f"Made of `host/web/openapi.yaml`. Addresses begin with `{self.document['servers'][0]['url']}` unless one says otherwise.\n"
        for tag in self.document["tags"]:
            yield f"## {tag['name'].capitalize()}\n\n{tag['description'].rstrip('.')}.\n"
            for path, item in self.document["paths"].items():
                for method in METHODS:
                    if method in item and tag["name"] in item[method]["tags"]:
                        server = item.get("servers", [{"url": ""}])[0]["url"].rstrip("/")
                        yield from self.operation(server + path, method, item[method], item.get("parameters", []))


def main():
    document = yaml.safe_load(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    out = pathlib.Path(sys.argv[2])
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n".join(Reference(document).page()), encoding="utf-8")


if __name__ == "__main__":
    main()
